//! Cubature over the half sphere around the mean of a radially constrained Gaussian.
//!
//! Gnomonic coordinates g = v/x·m, v the part of x across m, map the half sphere to ℝ³ with
//! dS = dg/(1 + |g|²)². With g = S w, S Sᵀ = (P_tt + 4·1)⁻¹ the law is near a standard Gaussian in w at its
//! mode w = 0, whatever its shape; w is taken in spherical coordinates with the radius t/(1 − t). Boxes
//! in (t, cos θ, φ) are halved until the embedded rules of degree 7 and 5 of Genz & Malik (1980,
//! doi:10.1016/0771-050X(80)90039-X) agree.

use gyradius_attitude::RadiallyConstrainedGaussian;
use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector3, Vector4};
use std::f64::consts::TAU;

/// Disagreement of the two rules, a share of each integral, at which no box is halved any more.
const TOLERANCE: f64 = 1e-5;
const MAX_BOXES: usize = 100_000;
const NODES: usize = 33;
/// 1, and the squares of the three scaled coordinates: the widths of the law. Last, 1 without the weight.
const INTEGRALS: usize = 5;
/// How far the share of the half may be from what the law knows of it, if no part of the law was missed.
const MISSED: f64 = 1e-6;

/// A cubature fitted to one law with a weight.
pub(super) struct HalfSphere<W> {
    chart: Chart,
    weight: W,
    boxes: Vec<Cell>,
}

#[derive(Clone, Copy)]
struct Chart {
    /// Columns: three directions across the mean, and the mean.
    frame: Matrix4<f64>,
    /// The precision in that frame.
    precision: Matrix4<f64>,
    /// S.
    scale: Matrix3<f64>,
}

#[derive(Clone, Copy)]
struct Cell {
    centre: [f64; 3],
    half: [f64; 3],
    values: [f64; INTEGRALS],
    errors: [f64; INTEGRALS],
    split: usize,
}

impl<W: Fn(&[f64; 4]) -> f64> HalfSphere<W> {
    /// For the density of the law times a weight of x, with respect to surface measure.
    pub(super) fn new(law: &RadiallyConstrainedGaussian, weight: W) -> Self {
        let chart = Chart::new(law);
        let mut found = Self { chart, weight, boxes: Vec::new() };
        // Thirds and quarters: no box is centred on a symmetry of the law, which would mislead it.
        let mut fresh: Vec<([f64; 3], [f64; 3])> = Vec::new();
        for i in 0..3 {
            for j in 0..2 {
                for k in 0..4 {
                    let (i, j, k) = (f64::from(i), f64::from(j), f64::from(k));
                    let centre = [(i + 0.5) / 3.0, j - 0.5, TAU * (k + 0.5) / 4.0];
                    fresh.push((centre, [1.0 / 6.0, 0.5, TAU / 8.0]));
                }
            }
        }
        loop {
            for (centre, half) in fresh.drain(..) {
                let cell = found.integrate(centre, half);
                found.boxes.push(cell);
            }
            let mut totals = [0.0; INTEGRALS];
            for cell in &found.boxes {
                for (total, value) in totals.iter_mut().zip(cell.values) {
                    *total += value;
                }
            }
            let allowed = TOLERANCE / found.boxes.len() as f64;
            // The worst share of any integral.
            let rough = |cell: &Cell| {
                (0..INTEGRALS)
                    .fold(0.0, |worst: f64, n| worst.max(cell.errors[n] / totals[n].abs()))
            };
            let (mut split, kept): (Vec<Cell>, Vec<Cell>) =
                found.boxes.drain(..).partition(|cell| rough(cell) > allowed);
            found.boxes = kept;
            let room = MAX_BOXES.saturating_sub(found.boxes.len() + split.len());
            if split.len() > room {
                split.sort_by(|a, b| rough(b).total_cmp(&rough(a)));
                found.boxes.extend(split.drain(room..));
            }
            if split.is_empty() {
                return found;
            }
            for cell in split {
                let mut half = cell.half;
                half[cell.split] *= 0.5;
                for side in [-1.0, 1.0] {
                    let mut centre = cell.centre;
                    centre[cell.split] += side * half[cell.split];
                    fresh.push((centre, half));
                }
            }
        }
    }

    /// The mean of the weight under the law, where it is zero in the far half.
    pub(super) fn mean_of_weight(&self, law: &RadiallyConstrainedGaussian) -> f64 {
        self.integral(law, 0)
    }

    /// Whether the whole of the law in the half was found: a thin ridge that winds to the edge can escape the boxes.
    pub(super) fn is_whole(&self, law: &RadiallyConstrainedGaussian) -> bool {
        (self.integral(law, INTEGRALS - 1) - (1.0 - law.far_half_share())).abs() < MISSED
    }

    /// One of the integrals, over that of the law on the whole sphere.
    fn integral(&self, law: &RadiallyConstrainedGaussian, which: usize) -> f64 {
        let total: f64 = self.boxes.iter().map(|cell| cell.values[which]).sum();
        libm::exp(libm::log(total * self.chart.scale.determinant().abs()) - law.ln_normaliser())
    }

    /// Nodes with weights that include the density, up to a factor.
    pub(super) fn nodes(&self) -> impl Iterator<Item = (f64, UnitQuaternion<f64>)> + Clone + '_ {
        self.boxes.iter().flat_map(move |cell| {
            let volume: f64 = cell.half.iter().product();
            rule().into_iter().map(move |node| {
                let (share, x, _) = self.chart.node(cell, &node.at);
                let q = UnitQuaternion::new_unchecked(Quaternion::from(Vector4::from(x)));
                (node.fine * volume * share * (self.weight)(&x), q)
            })
        })
    }

    fn integrate(&self, centre: [f64; 3], half: [f64; 3]) -> Cell {
        let nothing = [0.0; INTEGRALS];
        let mut cell = Cell { centre, half, values: nothing, errors: nothing, split: 0 };
        let mut coarse = nothing;
        let mut densities = [0.0; NODES];
        let volume: f64 = half.iter().product();
        for (n, node) in rule().iter().enumerate() {
            let (share, x, w) = self.chart.node(&cell, &node.at);
            let weight = (self.weight)(&x);
            let plain = volume * share;
            densities[n] = plain * weight;
            let square = 1.0 + w.norm_squared();
            let widths = [w.x, w.y, w.z].map(|w| weight * w * w / square);
            let functions = [weight, widths[0], widths[1], widths[2], 1.0];
            for (i, function) in functions.iter().enumerate() {
                cell.values[i] += node.fine * plain * function;
                coarse[i] += node.coarse * plain * function;
            }
        }
        cell.errors = std::array::from_fn(|i| (cell.values[i] - coarse[i]).abs());
        // The axis along which the density is least like a parabola.
        let ratio = (9.0 / 70.0) / (9.0 / 10.0);
        let bend = |axis: usize| {
            let second = |n: usize| densities[n] + densities[n + 1] - 2.0 * densities[0];
            (second(1 + 2 * axis) - ratio * second(7 + 2 * axis)).abs()
        };
        cell.split = (1..3).fold(0, |best, axis| if bend(axis) > bend(best) { axis } else { best });
        cell
    }
}

impl Chart {
    fn new(law: &RadiallyConstrainedGaussian) -> Self {
        let m = law.mean();
        let (x, y, z, w) = (m.i, m.j, m.k, m.w);
        // y ↦ m ⊗ y, scalar last.
        #[rustfmt::skip]
        let frame = Matrix4::new(
             w, -z,  y, x,
             z,  w, -x, y,
            -y,  x,  w, z,
            -x, -y, -z, w,
        );
        let precision = frame.tr_mul(&law.precision()) * frame;
        let across = precision.fixed_view::<3, 3>(0, 0) + Matrix3::from_diagonal_element(4.0);
        // S = L⁻ᵀ of the Cholesky factor: S Sᵀ = (L Lᵀ)⁻¹. Definite by construction.
        let scale = across
            .cholesky()
            .and_then(|c| c.l().try_inverse())
            .map_or_else(|| Matrix3::from_diagonal_element(0.5), |inverse| inverse.transpose());
        Self { frame, precision, scale }
    }

    /// The density at a place of a box, each from −1 to 1, with respect to the box's coordinates; x, and w.
    fn node(&self, cell: &Cell, at: &[f64; 3]) -> (f64, [f64; 4], Vector3<f64>) {
        let [t, c, phi] = std::array::from_fn(|i| cell.centre[i] + cell.half[i] * at[i]);
        let rest = 1.0 - t;
        let radius = t / rest;
        let across = ((1.0 - c) * (1.0 + c)).max(0.0).sqrt();
        let direction = Vector3::new(across * libm::cos(phi), across * libm::sin(phi), c);
        let w = direction * radius;
        let g = self.scale * w;
        let square = 1.0 + g.norm_squared();
        let s = square.sqrt();
        // y − e₄, whose last component is 1/s − 1 without its cancellation.
        let last = -g.norm_squared() / (s * (s + 1.0));
        let gap = Vector4::new(g.x / s, g.y / s, g.z / s, last);
        let exponent = -0.5 * gap.dot(&(self.precision * gap));
        let x = self.frame * Vector4::new(gap.x, gap.y, gap.z, 1.0 / s);
        let jacobian = radius * radius / (rest * rest) / (square * square);
        (libm::exp(exponent) * jacobian, x.into(), w)
    }
}

/// A node in [−1, 1]³ with the weights of both rules, for a mean over the box times its volume.
#[derive(Clone, Copy)]
struct Node {
    at: [f64; 3],
    fine: f64,
    coarse: f64,
}

/// Genz and Malik's rules in three dimensions: the centre, two pairs on each axis (first all pairs at
/// √(9/70), then at √(9/10)), twelve on the edges, eight in the corners.
fn rule() -> [Node; NODES] {
    // Volume of [−1, 1]³, of which the published weights are shares.
    const VOLUME: f64 = 8.0;
    let (l2, l4, l5) = ((9.0_f64 / 70.0).sqrt(), 0.9_f64.sqrt(), (9.0_f64 / 19.0).sqrt());
    let node =
        |at, fine: f64, coarse: f64| Node { at, fine: VOLUME * fine, coarse: VOLUME * coarse };
    let mut nodes = [node([0.0; 3], -10_936.0 / 19_683.0, -1671.0 / 729.0); NODES];
    let mut next = 1;
    let mut put = |at: [f64; 3], fine: f64, coarse: f64| {
        nodes[next] = node(at, fine, coarse);
        next += 1;
    };
    for (length, fine, coarse) in
        [(l2, 980.0 / 6561.0, 245.0 / 486.0), (l4, 620.0 / 19_683.0, -35.0 / 1458.0)]
    {
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let mut at = [0.0; 3];
                at[axis] = sign * length;
                put(at, fine, coarse);
            }
        }
    }
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        for (a, b) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let mut at = [0.0; 3];
            (at[i], at[j]) = (a * l4, b * l4);
            put(at, 200.0 / 19_683.0, 25.0 / 729.0);
        }
    }
    for corner in 0..8 {
        let sign = |bit: usize| if corner >> bit & 1 == 0 { -l5 } else { l5 };
        put([sign(0), sign(1), sign(2)], 6859.0 / 19_683.0 / VOLUME, 0.0);
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ x^a y^b z^c over [−1, 1]³.
    fn exact(powers: [i32; 3]) -> f64 {
        powers.iter().map(|p| if p % 2 == 0 { 2.0 / f64::from(p + 1) } else { 0.0 }).product()
    }

    #[test]
    fn the_rules_have_their_degrees() {
        for powers in (0..8)
            .flat_map(|a| (0..8 - a).flat_map(move |b| (0..8 - a - b).map(move |c| [a, b, c])))
        {
            let degree: i32 = powers.iter().sum();
            let f = |at: &[f64; 3]| (0..3).map(|i| at[i].powi(powers[i])).product::<f64>();
            let (fine, coarse) = rule().iter().fold((0.0, 0.0), |(fine, coarse), node| {
                (fine + node.fine * f(&node.at), coarse + node.coarse * f(&node.at))
            });
            assert!((fine - exact(powers)).abs() < 1e-13, "{powers:?}: {fine}");
            if degree <= 5 {
                assert!((coarse - exact(powers)).abs() < 1e-13, "{powers:?}: {coarse}");
            }
        }
    }

    /// The share of the law in the half, which the law itself knows.
    #[test]
    fn agrees_with_the_law() {
        let mean = UnitQuaternion::from_euler_angles(0.5, 0.2, -0.3);
        for variances in [
            [0.1, 0.2, 0.3, 5.0],
            [1.0, 1.0, 1.0, 1.0],
            [1e4, 1e4, 1e4, 1e4],
            [2e-5, 6e-4, 6e-4, 0.6],
            [0.01, 0.01, 0.6, 0.1],
        ] {
            let covariance = Matrix4::from_diagonal(&Vector4::from(variances));
            let law = RadiallyConstrainedGaussian::new(mean, covariance).unwrap();
            let half = HalfSphere::new(&law, |_| 1.0);
            let (share, expected) = (half.mean_of_weight(&law), 1.0 - law.far_half_share());
            assert!(half.is_whole(&law));
            assert!((share - expected).abs() < 2e-8, "{variances:?}: {share} {expected}");
            assert!(half.nodes().all(|(_, q)| law.in_mean_half(&q)));
        }
    }
}
