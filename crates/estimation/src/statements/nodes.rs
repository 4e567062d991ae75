//! Quadrature over axes that scatter by turns: nodes on the sphere of quaternions.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// How many nodes there are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rule {
    /// Standard deviations that are reached, where the sphere does not end before.
    reach: f64,
    /// Standard deviations between two nodes: at h of them, 2 exp(−2π²/h²) is left of a Gaussian.
    apart: f64,
    /// Nodes round a circle, and twice those from pole to pole.
    round: u32,
}

impl Rule {
    /// To 1e-4 of narrow laws, and to a percent of wide ones.
    pub(super) const QUICK: Self = Self { reach: 4.6, apart: 1.3, round: 24 };
    /// To 1e-6, of laws that are wide along one angle at most.
    pub(super) const FINE: Self = Self { reach: 5.5, apart: 1.1, round: 40 };

    /// Sines and cosines of evenly spaced angles up to the `end`, π/2 or π, for a rotation of this variance.
    fn midpoints(self, variance: f64, end: f64) -> Vec<(f64, f64)> {
        let deviation = 0.5 * variance.sqrt();
        let sine = self.reach * deviation;
        let (reach, count) = if sine < 1.0 {
            let reach = libm::asin(sine);
            (reach, (2.0 * reach / (self.apart * deviation)).ceil() as u32)
        } else {
            (end, if end < PI { self.round / 2 } else { self.round })
        };
        let angle = |step: u32| reach * (f64::from(2 * step + 1) / f64::from(count) - 1.0);
        (0..count).map(|step| libm::sincos(angle(step))).collect()
    }
}

/// The law of x = (z, w) on the sphere, z being half a rotation vector, of attitudes m ⊗ x about the mean m:
/// its density is proportional to exp(−½(Σ 4 zᵢ²/vᵢ + (w − 1)²/R)).
#[derive(Clone, Copy, Debug)]
pub(super) struct Turns {
    pub(super) mean: UnitQuaternion<f64>,
    /// Unit axes of the independent rotations, body axes.
    pub(super) about: [Vector3<f64>; 3],
    /// v, rad².
    pub(super) variances: [f64; 3],
    /// R.
    pub(super) radial_variance: f64,
}

impl Turns {
    /// Weighted attitudes.
    ///
    /// With (z_l, z_j, z_i, w) = (sin a, cos a sin b, cos a cos b sin c, cos a cos b cos c) and i the
    /// widest rotation, surface measure is cos²a cos b da db dc: midpoint rules along a, b and c.
    pub(super) fn nodes(&self, rule: Rule) -> Vec<(f64, UnitQuaternion<f64>)> {
        let v = self.variances;
        let wide = (0..3).fold(0, |widest, i| if v[i] > v[widest] { i } else { widest });
        let (j, l) = ((wide + 1) % 3, (wide + 2) % 3);
        let of_a = rule.midpoints(v[l], FRAC_PI_2);
        let of_b = rule.midpoints(v[j], FRAC_PI_2);
        let of_c = rule.midpoints(v[wide], PI);
        // Angles of either sign weigh the same: one exponential serves eight nodes.
        let half = |angles: &[(f64, f64)]| angles.len().div_ceil(2);
        let (half_b, half_c) = (half(&of_b), half(&of_c));
        let mut weights = Vec::with_capacity(half(&of_a) * half_b * half_c);
        for &(sin_a, cos_a) in &of_a[..half(&of_a)] {
            for &(sin_b, cos_b) in &of_b[..half_b] {
                for &(sin_c, cos_c) in &of_c[..half_c] {
                    let (zl, zj, r) = (sin_a, cos_a * sin_b, cos_a * cos_b);
                    let (zi, w) = (r * sin_c, r * cos_c);
                    let exponent = 4.0 * (zi * zi / v[wide] + zj * zj / v[j] + zl * zl / v[l])
                        + (w - 1.0) * (w - 1.0) / self.radial_variance;
                    weights.push(cos_a * r * libm::exp(-0.5 * exponent));
                }
            }
        }
        let from_end = |place: usize, angles: &[(f64, f64)]| place.min(angles.len() - 1 - place);
        let mut nodes = Vec::with_capacity(of_a.len() * of_b.len() * of_c.len());
        for (a, &(sin_a, cos_a)) in of_a.iter().enumerate() {
            for (b, &(sin_b, cos_b)) in of_b.iter().enumerate() {
                let row = (from_end(a, &of_a) * half_b + from_end(b, &of_b)) * half_c;
                let (zl, zj, r) = (sin_a, cos_a * sin_b, cos_a * cos_b);
                let across = self.about[j] * zj + self.about[l] * zl;
                for (c, &(sin_c, cos_c)) in of_c.iter().enumerate() {
                    let z = across + self.about[wide] * (r * sin_c);
                    let turn =
                        UnitQuaternion::new_normalize(Quaternion::new(r * cos_c, z.x, z.y, z.z));
                    nodes.push((weights[row + from_end(c, &of_c)], self.mean * turn));
                }
            }
        }
        nodes
    }
}
