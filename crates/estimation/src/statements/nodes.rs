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

    /// Sines and cosines of evenly spaced angles up to the `end`, π/2 or π, for a rotation of this variance: of those that are not
    /// negative, and whether their inverse is another one.
    fn midpoints(self, variance: f64, end: f64) -> Vec<(f64, f64, bool)> {
        let deviation = 0.5 * variance.sqrt();
        let sine = self.reach * deviation;
        let (reach, count) = if sine < 1.0 {
            let reach = libm::asin(sine);
            (reach, (2.0 * reach / (self.apart * deviation)).ceil() as u32)
        } else {
            (end, if end < PI { self.round / 2 } else { self.round })
        };
        (0..count.div_ceil(2))
            .map(|step| {
                let from_middle = count - 1 - 2 * step;
                let (sin, cos) = libm::sincos(reach * f64::from(from_middle) / f64::from(count));
                (sin, cos, from_middle > 0)
            })
            .collect()
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

/// A node with parts of one sign, for all that differ from it by the signs of z: the law is the same there.
pub(super) struct Mirrored {
    /// Of one of them.
    pub(super) weight: f64,
    z: [f64; 3],
    w: f64,
    /// Whether z has a mirror image along each axis, and is not zero there.
    has_image: [bool; 3],
}

impl Mirrored {
    /// z², and the weight of all.
    pub(super) fn squares(&self) -> ([f64; 3], f64) {
        let images: f64 = self.has_image.map(|has| if has { 2.0 } else { 1.0 }).iter().product();
        (self.z.map(|z| z * z), self.weight * images)
    }

    /// Each z.
    fn images(&self) -> impl Iterator<Item = [f64; 3]> {
        let Self { z, has_image, .. } = *self;
        let is_one = move |signs: &u32| (0..3).all(|k| has_image[k] || signs >> k & 1 == 0);
        let signed =
            move |signs| std::array::from_fn(|k| if signs >> k & 1 == 0 { z[k] } else { -z[k] });
        (0..8).filter(is_one).map(signed)
    }
}

impl Turns {
    /// Calls a function with each node of a rule, once for all that are its mirror images.
    ///
    /// With (z_l, z_j, z_i, w) = (sin a, cos a sin b, cos a cos b sin c, cos a cos b cos c) and i the
    /// widest rotation, surface measure is cos²a cos b da db dc: midpoint rules along a, b and c.
    pub(super) fn each_mirrored(&self, rule: Rule, mut each: impl FnMut(&Mirrored)) {
        let v = self.variances;
        let i = (0..3).fold(0, |widest, i| if v[i] > v[widest] { i } else { widest });
        let (j, l) = ((i + 1) % 3, (i + 2) % 3);
        let [of_a, of_b, of_c] = [(l, FRAC_PI_2), (j, FRAC_PI_2), (i, PI)]
            .map(|(axis, end)| rule.midpoints(v[axis], end));
        for &(sin_a, cos_a, a_has_image) in &of_a {
            for &(sin_b, cos_b, b_has_image) in &of_b {
                for &(sin_c, cos_c, c_has_image) in &of_c {
                    let (zl, zj, r) = (sin_a, cos_a * sin_b, cos_a * cos_b);
                    let (zi, w) = (r * sin_c, r * cos_c);
                    let exponent = 4.0 * (zi * zi / v[i] + zj * zj / v[j] + zl * zl / v[l])
                        + (w - 1.0) * (w - 1.0) / self.radial_variance;
                    let weight = cos_a * r * libm::exp(-0.5 * exponent);
                    let (mut z, mut has_image) = ([0.0; 3], [false; 3]);
                    (z[i], z[j], z[l]) = (zi, zj, zl);
                    (has_image[i], has_image[j], has_image[l]) =
                        (c_has_image, b_has_image, a_has_image);
                    each(&Mirrored { weight, z, w, has_image });
                }
            }
        }
    }

    /// Weighted attitudes.
    pub(super) fn nodes(&self, rule: Rule) -> Vec<(f64, UnitQuaternion<f64>)> {
        let mut nodes = Vec::new();
        self.each_mirrored(rule, |node| {
            for z in node.images() {
                let v: Vector3<f64> = (0..3).map(|k| self.about[k] * z[k]).sum();
                let turn = UnitQuaternion::new_normalize(Quaternion::new(node.w, v.x, v.y, v.z));
                nodes.push((node.weight, self.mean * turn));
            }
        });
        nodes
    }
}
