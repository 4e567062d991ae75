//! Sampling from a table of cells: serves every law.
//!
//! Split the four coordinates into a pair (k, l) and a pair (m, n) and write the second as
//! √w (cos B, sin B) with w = 1 − y_k² − y_l²: surface measure is exactly dy_k dy_l dB, so that a box
//! in (y_k, y_l, B) has a known area. Over a box every y_j lies in an interval, and −½ Σ λ_j(y_j − c_j)²
//! below the value for the distances of the c_j from those intervals. The box that wastes most is
//! halved, along the axis that helps most, until enough of what the bounds enclose is the law.
//!
//! A draw picks a box by the alias method (Walker 1977, doi:10.1145/355744.355749), a point in it
//! evenly, and accepts against the bound.

use rand::{Rng, RngExt};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::FRAC_PI_2;

/// Boxes are halved until this share of proposals is accepted.
const ENOUGH: f64 = 0.65;
/// Or until there are so many.
const MOST: usize = 1 << 14;
/// Every split of the coordinates is tried with so many boxes.
const TRIAL: usize = 400;

#[derive(Clone, Debug)]
pub(crate) struct Cells {
    /// The coordinates as y_k, y_l, y_m, y_n.
    order: [usize; 4],
    target: Target,
    cells: Vec<Cell>,
    acceptance: f64,
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    low: [f64; 3],
    size: [f64; 3],
    ln_bound: f64,
    /// Below it, of 2⁶⁴, the cell itself is meant, above it its alias.
    threshold: u64,
    alias: u32,
}

/// −½ Σ λ(y − c)², the coordinates in order.
#[derive(Clone, Copy, Debug)]
struct Target {
    lambda: [f64; 4],
    centre: [f64; 4],
}

impl Cells {
    /// For exp(−½ Σ λ_j(y_j − c_j)²), whose integral over S³ is exp(ln_integral).
    pub(crate) fn new(lambda: [f64; 4], centre: [f64; 4], ln_integral: f64) -> Self {
        const ORDERS: [[usize; 4]; 6] =
            [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]];
        let integral = libm::exp(ln_integral);
        let mut trials = ORDERS.map(|order| {
            let target =
                Target { lambda: order.map(|j| lambda[j]), centre: order.map(|j| centre[j]) };
            let mut cover = Cover::new(target);
            cover.refine(TRIAL, integral / ENOUGH);
            (order, cover)
        });
        trials.sort_by(|a, b| a.1.total.total_cmp(&b.1.total));
        let [(order, mut cover), ..] = trials;
        cover.refine(MOST, integral / ENOUGH);
        let target = cover.target;
        let (cells, total) = cover.into_cells();
        Self { order, target, cells, acceptance: (integral / total).min(1.0) }
    }

    /// The share of proposals that are accepted.
    pub(crate) fn acceptance(&self) -> f64 {
        self.acceptance
    }

    pub(crate) fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> [f64; 4] {
        loop {
            // The high half of a product with a 64-bit number is an index, the low half as good as new.
            let place = u128::from(rng.next_u64()) * self.cells.len() as u128;
            let mut cell = &self.cells[(place >> 64) as usize];
            if place as u64 >= cell.threshold {
                cell = &self.cells[cell.alias as usize];
            }
            let u = cell.low[0] + cell.size[0] * rng.random::<f64>();
            let v = cell.low[1] + cell.size[1] * rng.random::<f64>();
            let w = 1.0 - (u * u + v * v);
            if !(w > 0.0) {
                continue;
            }
            let (sin, cos) = libm::sincos(cell.low[2] + cell.size[2] * rng.random::<f64>());
            let radius = w.sqrt();
            let point = [u, v, radius * cos, radius * sin];
            if rng.random::<f64>() < libm::exp(self.target.ln_at(point) - cell.ln_bound) {
                let mut y = [0.0; 4];
                for (j, value) in self.order.into_iter().zip(point) {
                    y[j] = value;
                }
                return y;
            }
        }
    }
}

impl Target {
    fn ln_at(&self, y: [f64; 4]) -> f64 {
        let term = |j: usize| {
            let d = y[j] - self.centre[j];
            self.lambda[j] * d * d
        };
        -0.5 * (term(0) + term(1) + term(2) + term(3))
    }

    /// An upper bound over a box, by the intervals of its coordinates.
    fn ln_bound(&self, y: [(f64, f64); 4]) -> f64 {
        let term = |j: usize| {
            let d = (y[j].0 - self.centre[j]).max(self.centre[j] - y[j].1).max(0.0);
            self.lambda[j] * d * d
        };
        -0.5 * (term(0) + term(1) + term(2) + term(3))
    }
}

/// A box in (y_k, y_l, B), B within one quadrant.
#[derive(Clone, Copy, Debug)]
struct Block {
    low: [f64; 3],
    high: [f64; 3],
    /// (sin, cos) at the ends of B.
    arc: [(f64, f64); 2],
    /// Area × bound.
    mass: f64,
    ln_bound: f64,
    /// The part of the mass that is not the law's, by its value in the middle.
    waste: f64,
    /// What to halve.
    axis: usize,
}

impl PartialEq for Block {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Block {}
impl PartialOrd for Block {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Block {
    fn cmp(&self, other: &Self) -> Ordering {
        self.waste.total_cmp(&other.waste)
    }
}

/// Boxes that cover the sphere.
struct Cover {
    target: Target,
    blocks: BinaryHeap<Block>,
    total: f64,
}

impl Cover {
    fn new(target: Target) -> Self {
        let mut cover = Self { target, blocks: BinaryHeap::new(), total: 0.0 };
        // Eight deviations each side of the centre, as far as that is less than everything.
        let edges = |j: usize| {
            let reach = 8.0 / target.lambda[j].sqrt();
            let around = [target.centre[j] - reach, target.centre[j], target.centre[j] + reach];
            let mut edges = vec![-1.0, 1.0];
            edges.extend(around.into_iter().filter(|e| e.abs() < 1.0));
            edges.sort_by(f64::total_cmp);
            edges
        };
        let (u, v) = (edges(0), edges(1));
        for quadrant in -2..2 {
            let ends = [quadrant, quadrant + 1].map(|i| f64::from(i) * FRAC_PI_2);
            let arc = ends.map(libm::sincos);
            for u in u.windows(2) {
                for v in v.windows(2) {
                    let block = cover.block([u[0], v[0], ends[0]], [u[1], v[1], ends[1]], arc);
                    cover.push(cover.judge(block));
                }
            }
        }
        cover
    }

    fn push(&mut self, block: Block) {
        if block.mass > 0.0 {
            self.total += block.mass;
            self.blocks.push(block);
        }
    }

    fn block(&self, low: [f64; 3], high: [f64; 3], arc: [(f64, f64); 2]) -> Block {
        const SLACK: f64 = 4.0 * f64::EPSILON;
        let square = |j: usize| {
            let (a, b) = (low[j] * low[j], high[j] * high[j]);
            let least = if low[j] <= 0.0 && high[j] >= 0.0 { 0.0 } else { a.min(b) };
            (least, a.max(b))
        };
        let (u, v) = (square(0), square(1));
        let w = (1.0 - (u.1 + v.1) - SLACK, 1.0 - (u.0 + v.0) + SLACK);
        let r = (w.0.max(0.0).sqrt(), w.1.max(0.0).sqrt());
        let scaled = |a: f64, b: f64| {
            let (low, high) = (a.min(b), a.max(b));
            (
                low * if low < 0.0 { r.1 } else { r.0 } - SLACK,
                high * if high > 0.0 { r.1 } else { r.0 } + SLACK,
            )
        };
        let y = [
            (low[0], high[0]),
            (low[1], high[1]),
            scaled(arc[0].1, arc[1].1),
            scaled(arc[0].0, arc[1].0),
        ];
        let ln_bound = self.target.ln_bound(y) + 1e-12;
        let area = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
        let mass = if w.1 > 2.0 * SLACK { area * libm::exp(ln_bound) } else { 0.0 };
        Block { low, high, arc, mass, ln_bound, waste: mass, axis: 2 }
    }

    /// ln of the density at a point of a box, with the sine and cosine of B; next to nothing where
    /// there is no such point.
    fn ln_inside(&self, u: f64, v: f64, (sin, cos): (f64, f64)) -> f64 {
        let w = 1.0 - (u * u + v * v);
        if w > 0.0 { self.target.ln_at([u, v, w.sqrt() * cos, w.sqrt() * sin]) } else { -1e6 }
    }

    /// Mass that is not the law's, judged by the density in the middle, and the axis along which the
    /// density varies most through the middle.
    fn judge(&self, mut block: Block) -> Block {
        let [u, v, angle] = std::array::from_fn(|j| 0.5 * (block.low[j] + block.high[j]));
        let arc = libm::sincos(angle);
        let middle = self.ln_inside(u, v, arc);
        let range = |a: f64, b: f64| middle.max(a).max(b) - middle.min(a).min(b);
        let (low, high) = (block.low, block.high);
        let variation = [
            range(self.ln_inside(low[0], v, arc), self.ln_inside(high[0], v, arc)),
            range(self.ln_inside(u, low[1], arc), self.ln_inside(u, high[1], arc)),
            range(self.ln_inside(u, v, block.arc[0]), self.ln_inside(u, v, block.arc[1])),
        ];
        block.axis = if u * u + v * v >= 1.0 {
            // The side along which the edge of the sphere is met.
            usize::from(v.abs() * (high[1] - low[1]) > u.abs() * (high[0] - low[0]))
        } else if variation[2] >= variation[0].max(variation[1]) {
            2
        } else {
            usize::from(variation[1] > variation[0])
        };
        block.waste = block.mass * (1.0 - libm::exp(middle - block.ln_bound));
        block
    }

    fn halves(&self, block: &Block, axis: usize) -> [Block; 2] {
        let middle = 0.5 * (block.low[axis] + block.high[axis]);
        let (mut low, mut high) = (block.low, block.high);
        low[axis] = middle;
        high[axis] = middle;
        let (mut first, mut second) = (block.arc, block.arc);
        if axis == 2 {
            let cut = libm::sincos(middle);
            first[1] = cut;
            second[0] = cut;
        }
        [self.block(block.low, high, first), self.block(low, block.high, second)]
    }

    /// Halves boxes until they enclose no more than `enough`, or are `most`.
    fn refine(&mut self, most: usize, enough: f64) {
        while self.total > enough && self.blocks.len() < most {
            let Some(block) = self.blocks.pop() else { return };
            if block.waste <= 0.0 {
                self.blocks.push(block);
                return;
            }
            self.total -= block.mass;
            for half in self.halves(&block, block.axis) {
                let half = self.judge(half);
                self.push(half);
            }
        }
    }

    fn into_cells(self) -> (Vec<Cell>, f64) {
        let blocks = self.blocks.into_sorted_vec();
        let masses: Vec<f64> = blocks.iter().map(|b| b.mass).collect();
        let total = masses.iter().sum();
        let table = alias_table(&masses);
        let cells = blocks
            .into_iter()
            .zip(table)
            .map(|(b, (threshold, alias))| Cell {
                low: b.low,
                size: std::array::from_fn(|j| b.high[j] - b.low[j]),
                ln_bound: b.ln_bound,
                threshold,
                alias,
            })
            .collect();
        (cells, total)
    }
}

/// Thresholds and aliases for drawing an index with probability ∝ mass (Vose's construction,
/// doi:10.1109/32.92917).
fn alias_table(masses: &[f64]) -> Vec<(u64, u32)> {
    const WHOLE: f64 = 18_446_744_073_709_551_616.0;
    let n = masses.len();
    let total: f64 = masses.iter().sum();
    let mut share: Vec<f64> = masses.iter().map(|m| m * n as f64 / total).collect();
    let mut table: Vec<(u64, u32)> = (0..n).map(|i| (u64::MAX, i as u32)).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| share[i] < 1.0);
    while let (Some(s), Some(&l)) = (small.pop(), large.last()) {
        table[s] = ((share[s] * WHOLE) as u64, l as u32);
        share[l] -= 1.0 - share[s];
        if share[l] < 1.0 {
            large.pop();
            small.push(l);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn target(exponents: [f64; 4], centre: [f64; 4]) -> Target {
        let norm = centre.iter().map(|c| c * c).sum::<f64>().sqrt().max(1e-3);
        Target { lambda: exponents.map(|e| 10f64.powf(e)), centre: centre.map(|c| c / norm) }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        /// Every point of the sphere lies in one box, and its density below the bound of that box.
        #[test]
        fn boxes_cover_the_sphere_and_bound_the_density(
            exponents in prop::array::uniform4(-3.0..7.0f64),
            centre in prop::array::uniform4(-1.0..1.0f64),
            points in prop::collection::vec(prop::array::uniform4(-1.0..1.0f64), 50),
        ) {
            let target = target(exponents, centre);
            let mut cover = Cover::new(target);
            cover.refine(500, 0.0);
            let deviations = target.lambda.map(|l| 1.0 / l.sqrt());
            for (i, p) in points.into_iter().enumerate() {
                // Half of the points where the density is not negligible.
                let mut y: [f64; 4] = if i % 2 == 0 { p } else {
                    std::array::from_fn(|j| target.centre[j] + 3.0 * deviations[j] * p[j])
                };
                let norm = y.iter().map(|x| x * x).sum::<f64>().sqrt();
                prop_assume!(norm > 0.1);
                y = y.map(|x| x / norm);
                let place = [y[0], y[1], y[3].atan2(y[2])];
                let value = target.ln_at(y);
                let homes = cover.blocks.iter().filter(|b| {
                    (0..3).all(|j| b.low[j] - 1e-15 <= place[j] && place[j] <= b.high[j] + 1e-15)
                });
                let bounds: Vec<f64> = homes.map(|b| b.ln_bound).collect();
                // Boxes whose mass underflows are left out.
                prop_assert!(!bounds.is_empty() || value < -690.0, "{y:?} is nowhere");
                prop_assert!(bounds.iter().all(|b| value <= b + 1e-9 * (1.0 + value.abs())));
            }
        }

        #[test]
        fn alias_tables_keep_the_masses(masses in prop::collection::vec(0.0..1.0f64, 1..60)) {
            prop_assume!(masses.iter().sum::<f64>() > 1e-3);
            let table = alias_table(&masses);
            let mut found = vec![0.0; masses.len()];
            for (i, (threshold, alias)) in table.iter().enumerate() {
                let own = *threshold as f64 / 2f64.powi(64);
                found[i] += own;
                found[*alias as usize] += 1.0 - own;
            }
            let total: f64 = masses.iter().sum();
            for (f, m) in found.iter().zip(&masses) {
                prop_assert!((f / masses.len() as f64 - m / total).abs() < 1e-12);
            }
        }
    }

    /// With a flat density the mass of the boxes falls to the area of the sphere, 2π².
    #[test]
    fn boxes_close_in_on_the_sphere() {
        let mut cover = Cover::new(target([-9.0; 4], [0.0; 4]));
        let start = cover.total;
        assert!((start / (8.0 * PI) - 1.0).abs() < 1e-8, "a square times a circle: {start}");
        cover.refine(4000, 0.0);
        let over = cover.total / (2.0 * PI * PI) - 1.0;
        assert!((0.0..0.08).contains(&over), "{over}");
    }
}
