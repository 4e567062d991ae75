//! Sampling with two Gaussian coordinates and a tabulated circle: serves every law.
//!
//! Split the four coordinates into a pair (k, l) and a pair (m, n), and write the second as
//! √w (cos B, sin B) with w = 1 − y_k² − y_l²; surface measure is exactly dy_k dy_l dB. With
//! b = λc and a multiple μ of |y|² = 1 moved between the pairs, exp(−½ Σ λ_j(y_j − c_j)²) becomes
//! a Gaussian in (y_k, y_l), precisions λ − μ, times
//!
//! t(w, B) = exp(−½[λ_m(√w cos B − c_m)² + λ_n(√w sin B − c_n)² − μ w]).
//!
//! t is bounded on cells of (w, B) by interval arithmetic. A draw proposes (y_k, y_l), keeps it with
//! the share of its row of cells, picks a cell of the row by the alias method (Walker 1977,
//! doi:10.1145/355744.355749), and accepts against the bound.

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{LN_2, PI, TAU};

use crate::chart::golden_section;

/// Rows over the values of w that occur; beyond them rows double in width.
const CORE_ROWS: usize = 48;
const MAX_ARCS: usize = 256;
/// Arcs are split until bounding wastes less than this.
const WASTE: f64 = 0.04;

#[derive(Clone, Debug)]
pub(crate) struct Circle {
    gaussian: [usize; 2],
    circle: [usize; 2],
    location: [f64; 2],
    scale: [f64; 2],
    target: Target,
    /// Edges of the rows in w, from 0 to 1.
    rows: Vec<f64>,
    /// Edges of the arcs in B, from −π to π.
    arcs: Vec<f64>,
    /// The share of proposals that each row keeps.
    keep: Vec<f64>,
    /// Row by row.
    cells: Vec<Cell>,
    acceptance: f64,
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    ln_bound: f64,
    threshold: f64,
    alias: u16,
}

/// ln t.
#[derive(Clone, Copy, Debug)]
struct Target {
    lambda: [f64; 2],
    center: [f64; 2],
    mu: f64,
}

impl Circle {
    /// The best split for exp(−½ Σ λ_j(y_j − c_j)²), whose integral over S³ is exp(ln_integral) and
    /// whose second moments are E[y_j²] = `squares`.
    pub(crate) fn new(
        lambda: [f64; 4],
        center: [f64; 4],
        squares: [f64; 4],
        ln_integral: f64,
    ) -> Self {
        const SPLITS: [([usize; 2], [usize; 2]); 6] = [
            ([0, 1], [2, 3]),
            ([0, 2], [1, 3]),
            ([0, 3], [1, 2]),
            ([1, 2], [0, 3]),
            ([1, 3], [0, 2]),
            ([2, 3], [0, 1]),
        ];
        let mut plans = SPLITS.map(|(gaussian, circle)| {
            Plan::new(lambda, center, squares, ln_integral, gaussian, circle)
        });
        // A forecast above one came of too coarse a ladder and is worth nothing.
        let forecast = |p: &Plan| {
            if p.ln_acceptance > 0.01 { f64::MIN } else { p.ln_acceptance }
        };
        plans.sort_by(|a, b| forecast(b).total_cmp(&forecast(a)));
        let [first, rest @ ..] = plans;
        let mut best = first.build();
        for plan in rest {
            // Tables never beat their forecast by much.
            if libm::exp(forecast(&plan)) < best.acceptance {
                break;
            }
            let next = plan.build();
            if next.acceptance > best.acceptance {
                best = next;
            }
        }
        best
    }

    /// The share of proposals that are accepted.
    pub(crate) fn acceptance(&self) -> f64 {
        self.acceptance
    }

    pub(crate) fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> [f64; 4] {
        let arcs = self.arcs.len() - 1;
        loop {
            let u: [f64; 2] = std::array::from_fn(|j| {
                let z: f64 = StandardNormal.sample(rng);
                self.location[j] + self.scale[j] * z
            });
            let w = 1.0 - (u[0] * u[0] + u[1] * u[1]);
            if !(w > 0.0) {
                continue;
            }
            let row = self.rows.partition_point(|&edge| edge <= w).clamp(1, self.keep.len()) - 1;
            if rng.random::<f64>() >= self.keep[row] {
                continue;
            }
            let cells = &self.cells[row * arcs..(row + 1) * arcs];
            let place = rng.random::<f64>() * arcs as f64;
            let mut arc = (place as usize).min(arcs - 1);
            if place - arc as f64 >= cells[arc].threshold {
                arc = usize::from(cells[arc].alias);
            }
            let (start, end) = (self.arcs[arc], self.arcs[arc + 1]);
            let angle = start + (end - start) * rng.random::<f64>();
            let (sin, cos) = libm::sincos(angle);
            let radius = w.sqrt();
            let point = [radius * cos, radius * sin];
            if rng.random::<f64>() < libm::exp(self.target.ln_at(w, point) - cells[arc].ln_bound) {
                let mut y = [0.0; 4];
                for j in 0..2 {
                    y[self.gaussian[j]] = u[j];
                    y[self.circle[j]] = point[j];
                }
                return y;
            }
        }
    }
}

impl Target {
    fn ln_at(&self, w: f64, point: [f64; 2]) -> f64 {
        let d = [point[0] - self.center[0], point[1] - self.center[1]];
        -0.5 * (self.lambda[0] * d[0] * d[0] + self.lambda[1] * d[1] * d[1] - self.mu * w)
    }

    fn ln_polar(&self, w: f64, angle: f64) -> f64 {
        let (sin, cos) = libm::sincos(angle);
        self.ln_at(w, [w.sqrt() * cos, w.sqrt() * sin])
    }

    /// An upper bound of ln t over [w₀, w₁] × [B₀, B₁]: the smaller of two, one sharp where the
    /// squares are, one where the linear and the quadratic part are.
    fn ln_bound(&self, w: (f64, f64), angle: (f64, f64)) -> f64 {
        let r = (w.0.sqrt(), w.1.sqrt());
        let cos = cosine_range(angle, 0.0);
        let sin = cosine_range(angle, 0.5 * PI);
        let gap = |factor: (f64, f64), c: f64| {
            let low = if factor.0 < 0.0 { r.1 * factor.0 } else { r.0 * factor.0 };
            let high = if factor.1 > 0.0 { r.1 * factor.1 } else { r.0 * factor.1 };
            (low - c).max(c - high).max(0.0)
        };
        let (dx, dz) = (gap(cos, self.center[0]), gap(sin, self.center[1]));
        let squares = -0.5 * (self.lambda[0] * dx * dx + self.lambda[1] * dz * dz);

        let linear = [self.lambda[0] * self.center[0], self.lambda[1] * self.center[1]];
        let strength = libm::hypot(linear[0], linear[1]);
        let toward = cosine_range(angle, libm::atan2(linear[1], linear[0])).1;
        let push = strength * toward * if toward > 0.0 { r.1 } else { r.0 };
        let constant = linear[0] * self.center[0] + linear[1] * self.center[1];
        let cos_square = if cos.0 <= 0.0 && cos.1 >= 0.0 {
            (0.0, (cos.0 * cos.0).max(cos.1 * cos.1))
        } else {
            ((cos.0 * cos.0).min(cos.1 * cos.1), (cos.0 * cos.0).max(cos.1 * cos.1))
        };
        // λ_m w cos² + λ_n w sin², least where cos² leans to the smaller λ.
        let share = if self.lambda[0] < self.lambda[1] { cos_square.1 } else { cos_square.0 };
        let quadratic = w.0 * (self.lambda[0] * share + self.lambda[1] * (1.0 - share));
        let parts = push - 0.5 * (quadratic + constant);
        // Rounding of the terms that cancel in `parts`.
        let rounding = 8.0 * f64::EPSILON * (push.abs() + quadratic + constant);

        squares.min(parts + rounding) + (0.5 * self.mu * w.0).max(0.5 * self.mu * w.1) + 1e-12
    }
}

/// Range of cos(B − B*) over an arc no longer than 2π.
fn cosine_range(arc: (f64, f64), toward: f64) -> (f64, f64) {
    let (a, b) = (libm::cos(arc.0 - toward), libm::cos(arc.1 - toward));
    let contains = |angle: f64| {
        let start = (arc.0 - angle).rem_euclid(TAU);
        start == 0.0 || start + (arc.1 - arc.0) >= TAU
    };
    let slack = 2.0 * f64::EPSILON;
    (
        if contains(toward + PI) { -1.0 } else { (a.min(b) - slack).max(-1.0) },
        if contains(toward) { 1.0 } else { (a.max(b) + slack).min(1.0) },
    )
}

/// A split with its rows, arcs and μ chosen, before the table is filled.
struct Plan {
    gaussian: [usize; 2],
    circle: [usize; 2],
    proposals: Proposals,
    target: Target,
    rows: Vec<f64>,
    arcs: Vec<f64>,
    /// −½ Σ λc² + ½ Σ b²/p − ½ μ over the Gaussian pair, − ln C.
    front: f64,
    ln_acceptance: f64,
}

impl Plan {
    fn new(
        lambda: [f64; 4],
        center: [f64; 4],
        squares: [f64; 4],
        ln_integral: f64,
        gaussian: [usize; 2],
        circle: [usize; 2],
    ) -> Self {
        let free = Target {
            lambda: circle.map(|j| lambda[j]),
            center: circle.map(|j| center[j]),
            mu: 0.0,
        };
        let linear = gaussian.map(|j| lambda[j] * center[j]);
        let floor = lambda[gaussian[0]].min(lambda[gaussian[1]]);
        let typical = (squares[circle[0]] + squares[circle[1]]).clamp(1e-12, 1.0);
        let arcs = free.split_arcs(typical);

        // ln ∫ t dB at μ = 0 on a ladder of w; μ only adds ½ μ w.
        let spread = gaussian.map(|j| 1.0 / lambda[j].sqrt());
        let reach = 2.0 * (spread[0].min(1.0) + spread[1].min(1.0)).min(0.5);
        let ladder: Vec<(f64, f64)> = row_edges(typical - reach, typical + reach)
            .into_iter()
            .map(|w| (w, free.ln_circle_integral(w, &arcs)))
            .collect();
        let choice = |smallest: f64| {
            let mu = floor - smallest;
            let precision = gaussian.map(|j| (lambda[j] - floor) + smallest);
            let mut front = -0.5 * mu - ln_integral;
            for (j, index) in gaussian.into_iter().enumerate() {
                front += 0.5 * linear[j] * linear[j] / precision[j];
                front -= 0.5 * linear[j] * center[index];
            }
            let peak = ladder.iter().map(|(w, h)| h + 0.5 * mu * w).fold(f64::MIN, f64::max);
            let volume = libm::log(TAU) - 0.5 * libm::log(precision[0] * precision[1]);
            (mu, precision, front, -(front + volume + peak))
        };
        // Convex in μ, so a single search over its whole range finds the best.
        let top = libm::log(4.0 * lambda.into_iter().fold(0.0, f64::max) + 100.0);
        let smallest = golden_section(|t| choice(libm::exp(t)).3, libm::log(0.1), top);
        let (mu, precision, front, ln_acceptance) = choice(libm::exp(smallest));

        let proposals = Proposals::new(linear, precision);
        let location = proposals.location;
        let (near, far) = (0..2).fold((0.0, 0.0), |(near, far), j| {
            let reach = 5.0 / precision[j].sqrt();
            let (low, high) = ((location[j].abs() - reach).max(0.0), location[j].abs() + reach);
            (near + low * low, far + high * high)
        });
        let rows = row_edges(1.0 - far, 1.0 - near);
        let target = Target { mu, ..free };
        Self { gaussian, circle, proposals, target, rows, arcs, front, ln_acceptance }
    }

    fn build(self) -> Circle {
        let arcs = self.arcs.len() - 1;
        let mut cells = Vec::with_capacity((self.rows.len() - 1) * arcs);
        let mut totals = Vec::with_capacity(self.rows.len() - 1);
        for row in self.rows.windows(2) {
            let bounds: Vec<f64> = self
                .arcs
                .windows(2)
                .map(|arc| self.target.ln_bound((row[0], row[1]), (arc[0], arc[1])))
                .collect();
            let peak = bounds.iter().copied().fold(f64::MIN, f64::max);
            let masses: Vec<f64> = bounds
                .iter()
                .zip(self.arcs.windows(2))
                .map(|(bound, arc)| libm::exp(bound - peak) * (arc[1] - arc[0]))
                .collect();
            totals.push(peak + libm::log(masses.iter().sum()));
            let table = alias_table(&masses);
            cells.extend(
                bounds.into_iter().zip(table).map(|(ln_bound, (threshold, alias))| Cell {
                    ln_bound,
                    threshold,
                    alias,
                }),
            );
        }
        let used: Vec<bool> = self
            .rows
            .windows(2)
            .zip(&totals)
            .map(|(row, total)| !self.proposals.never(row[0], row[1], self.front + total))
            .collect();
        let peak =
            totals.iter().zip(&used).filter(|(_, u)| **u).map(|(t, _)| *t).fold(f64::MIN, f64::max);
        let keep = |(total, used): (&f64, &bool)| if *used { libm::exp(total - peak) } else { 0.0 };
        Circle {
            gaussian: self.gaussian,
            circle: self.circle,
            location: self.proposals.location,
            scale: self.proposals.precision.map(|p| 1.0 / p.sqrt()),
            target: self.target,
            keep: totals.iter().zip(&used).map(keep).collect(),
            rows: self.rows,
            arcs: self.arcs,
            cells,
            acceptance: libm::exp(-(self.front + self.proposals.ln_volume + peak)).min(1.0),
        }
    }
}

/// The Gaussian of (y_k, y_l).
struct Proposals {
    location: [f64; 2],
    precision: [f64; 2],
    ln_volume: f64,
}

impl Proposals {
    fn new(linear: [f64; 2], precision: [f64; 2]) -> Self {
        let ln_volume = libm::log(TAU) - 0.5 * libm::log(precision[0] * precision[1]);
        let location = std::array::from_fn(|j| linear[j] / precision[j]);
        Self { location, precision, ln_volume }
    }

    /// Whether a row w₀..w₁ of weight e^ln may be left out, because it is so far from the location
    /// that all such rows together hold less than 2⁻⁶⁴ of the law.
    fn never(&self, w0: f64, w1: f64, ln: f64) -> bool {
        // Room for the number of rows.
        const LN_NEGLIGIBLE: f64 = -64.0 * LN_2 - 7.0;
        let center = libm::hypot(self.location[0], self.location[1]);
        let gap = ((1.0 - w1).sqrt() - center).max(center - (1.0 - w0).sqrt()).max(0.0);
        let tightest = self.precision[0].min(self.precision[1]);
        // A Gaussian in the plane is at least d standard deviations away with at most e^{−d²/2}.
        self.ln_volume + ln - 0.5 * tightest * gap * gap < LN_NEGLIGIBLE
    }
}

impl Target {
    /// Splits the circle where bounding t by a constant wastes most, at one w.
    fn split_arcs(&self, w: f64) -> Vec<f64> {
        struct Arc {
            start: f64,
            end: f64,
            ln_bound: f64,
            ln_inside: f64,
        }
        let arc = |start: f64, end: f64| Arc {
            start,
            end,
            ln_bound: self.ln_bound((w, w), (start, end)),
            ln_inside: self.ln_polar(w, 0.5 * (start + end)),
        };
        let mut arcs: Vec<Arc> = (0..32)
            .map(|i| f64::from(i) * TAU / 32.0 - PI)
            .map(|start| arc(start, start + TAU / 32.0))
            .collect();
        loop {
            let peak = arcs.iter().map(|a| a.ln_bound).fold(f64::MIN, f64::max);
            let mass = |a: &Arc, ln: f64| (a.end - a.start) * libm::exp(ln - peak);
            let total: f64 = arcs.iter().map(|a| mass(a, a.ln_bound)).sum();
            let waste = |a: &Arc| mass(a, a.ln_bound) - mass(a, a.ln_inside);
            let wasted: f64 = arcs.iter().map(waste).sum();
            if wasted < WASTE * total || arcs.len() >= MAX_ARCS {
                break;
            }
            // All arcs that waste more than their even share, in one sweep.
            let share = wasted / arcs.len() as f64;
            let mut next = Vec::with_capacity(2 * arcs.len());
            for a in arcs {
                if waste(&a) > share {
                    let middle = 0.5 * (a.start + a.end);
                    next.push(arc(a.start, middle));
                    next.push(arc(middle, a.end));
                } else {
                    next.push(a);
                }
            }
            arcs = next;
        }
        let mut edges: Vec<f64> = arcs.iter().map(|a| a.start).collect();
        // The exact end of the last arc: halving never moved it.
        edges.push(PI);
        edges
    }

    /// ln ∫ t(w, B) dB by the midpoint rule on the arcs: enough to choose μ.
    fn ln_circle_integral(&self, w: f64, arcs: &[f64]) -> f64 {
        let values: Vec<(f64, f64)> =
            arcs.windows(2).map(|a| (a[1] - a[0], self.ln_polar(w, 0.5 * (a[0] + a[1])))).collect();
        let peak = values.iter().map(|v| v.1).fold(f64::MIN, f64::max);
        peak + libm::log(values.iter().map(|(d, v)| d * libm::exp(v - peak)).sum())
    }
}

/// Edges from 0 to 1: even over [low, high], widths doubling outside.
fn row_edges(low: f64, high: f64) -> Vec<f64> {
    let low = low.clamp(0.0, 1.0 - 1e-9);
    let high = high.clamp(low + 1e-9, 1.0);
    let width = (high - low) / CORE_ROWS as f64;
    let doubling = |start: f64, direction: f64| {
        let mut step = width;
        let mut edge = start;
        std::iter::from_fn(move || {
            edge += direction * step;
            step *= 2.0;
            (edge > 0.0 && edge < 1.0).then_some(edge)
        })
    };
    let mut edges = vec![0.0, 1.0];
    edges.extend((0..=CORE_ROWS).map(|i| low + width * i as f64).filter(|e| *e > 0.0 && *e < 1.0));
    edges.extend(doubling(low, -1.0));
    edges.extend(doubling(high, 1.0));
    edges.sort_by(f64::total_cmp);
    edges.dedup();
    edges
}

/// Thresholds and aliases for drawing an index with probability ∝ mass (Vose's construction,
/// doi:10.1109/32.92917).
fn alias_table(masses: &[f64]) -> Vec<(f64, u16)> {
    let n = masses.len();
    let total: f64 = masses.iter().sum();
    let mut share: Vec<f64> = masses.iter().map(|m| m * n as f64 / total).collect();
    let mut table: Vec<(f64, u16)> = (0..n).map(|i| (1.0, i as u16)).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| share[i] < 1.0);
    while let (Some(s), Some(&l)) = (small.pop(), large.last()) {
        table[s] = (share[s], l as u16);
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

    proptest! {
        #[test]
        fn bounds_bound(
            exponents in prop::array::uniform2(-3.0..7.0f64),
            center in prop::array::uniform2(-0.7..0.7f64),
            mu in -1e3..1e3f64,
            w in prop::array::uniform2(0.0..1.0f64),
            angle in prop::array::uniform2(-PI..PI),
            inside in prop::array::uniform2(0.0..1.0f64),
        ) {
            let target = Target { lambda: exponents.map(|e| 10f64.powf(e)), center, mu };
            let w = (w[0].min(w[1]), w[0].max(w[1]));
            let b = (angle[0].min(angle[1]), angle[0].max(angle[1]));
            let value = target.ln_polar(
                w.0 + inside[0] * (w.1 - w.0),
                b.0 + inside[1] * (b.1 - b.0),
            );
            let bound = target.ln_bound(w, b);
            prop_assert!(value <= bound + 1e-9 * (1.0 + bound.abs()), "{value} {bound}");
        }

        #[test]
        fn cosine_ranges_hold(start in -PI..PI, length in 0.0..TAU, toward in -9.0..9.0f64, t in 0.0..1.0f64) {
            let (low, high) = cosine_range((start, start + length), toward);
            let value = (start + t * length - toward).cos();
            prop_assert!(value >= low - 1e-15 && value <= high + 1e-15);
        }

        #[test]
        fn alias_tables_keep_the_masses(masses in prop::collection::vec(0.0..1.0f64, 1..60)) {
            prop_assume!(masses.iter().sum::<f64>() > 1e-3);
            let table = alias_table(&masses);
            let mut found = vec![0.0; masses.len()];
            for (i, (threshold, alias)) in table.iter().enumerate() {
                found[i] += threshold;
                found[usize::from(*alias)] += 1.0 - threshold;
            }
            let total: f64 = masses.iter().sum();
            for (f, m) in found.iter().zip(&masses) {
                prop_assert!((f / masses.len() as f64 - m / total).abs() < 1e-12);
            }
        }

        #[test]
        fn rows_cover(low in -0.5..1.5f64, width in 0.0..1.0f64) {
            let edges = row_edges(low, low + width);
            prop_assert!(edges[0] == 0.0 && edges[edges.len() - 1] == 1.0);
            prop_assert!(edges.windows(2).all(|e| e[0] < e[1]));
        }
    }
}
