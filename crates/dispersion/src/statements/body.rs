//! The nominal body as the equations see it: how scatter of the second moments and of the axes moves
//! the six entries, to first order.

use gyradius_inertia::Inertia;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::entry_moments::ENTRIES;

/// Moments that differ by less than this share of the trace are equal.
const EQUAL: f64 = 1e-9;

/// Covariance of the second moments K₁, K₂, K₃ in (kg·m²)², and mixing of small rotations about the
/// principal axes: the covariance of sin 2φ_j/2, which is that of φ_j where the angles are small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scatter {
    pub(super) moments: Matrix3<f64>,
    pub(super) mixing: Matrix3<f64>,
}

impl Scatter {
    /// A share of the way to another, on which every covariance is one.
    pub(super) fn towards(&self, other: &Self, share: f64) -> Self {
        Self {
            moments: self.moments + (other.moments - self.moments) * share,
            mixing: self.mixing + (other.mixing - self.mixing) * share,
        }
    }
}

/// What moves the entries of a nominal body.
pub(super) struct Body {
    pub(super) attitude: UnitQuaternion<f64>,
    /// K₁, K₂, K₃.
    pub(super) second_moments: [f64; 3],
    /// ∂I_ab/∂K_k = δ_ab − r_ka r_kb, for each entry.
    growth: [Vector3<f64>; 6],
    /// Of each entry and rotation j, what an entry of a_m a_nᵀ + a_n a_mᵀ is: times the gap of the two
    /// moments it is ∂I_ab/∂φ_j.
    swing: [Vector3<f64>; 6],
    /// I_m − I_n of each rotation, zero if that is rounding.
    gaps: Vector3<f64>,
}

impl Body {
    pub(super) fn new(nominal: &Inertia) -> Self {
        let axes = nominal.principal_axes();
        let attitude = axes.attitude();
        let r: Matrix3<f64> = *attitude.to_rotation_matrix().matrix();
        let moments = axes.moments();
        let trace = nominal.matrix().trace();
        let growth = ENTRIES.map(|(a, b)| {
            let delta = if a == b { 1.0 } else { 0.0 };
            Vector3::from_fn(|k, _| delta - r[(k, a)] * r[(k, b)])
        });
        let swing = ENTRIES.map(|(a, b)| {
            Vector3::from_fn(|j, _| {
                let (m, n) = others(j);
                r[(m, a)] * r[(n, b)] + r[(n, a)] * r[(m, b)]
            })
        });
        let gaps = Vector3::from_fn(|j, _| {
            let (m, n) = others(j);
            let gap = moments[m] - moments[n];
            if gap.abs() > EQUAL * trace { gap } else { 0.0 }
        });
        let second_moments = nominal.second_moments().values();
        Self { attitude, second_moments, growth, swing, gaps }
    }

    /// A with Var I_e = tr(A C), C the covariance of the second moments.
    pub(super) fn growth(&self, entry: usize) -> Matrix3<f64> {
        self.growth[entry] * self.growth[entry].transpose()
    }

    /// E[ΔI_j ΔI_l] of the differences of moments that rotations about axes j and l mix, in
    /// (kg·m²)²: K_n − K_m are what they differ by, and that scatters.
    pub(super) fn gaps(&self, moments: &Matrix3<f64>) -> Matrix3<f64> {
        let difference = |j: usize| {
            let (m, n) = others(j);
            Vector3::ith(n, 1.0) - Vector3::ith(m, 1.0)
        };
        Matrix3::from_fn(|j, l| {
            self.gaps[j] * self.gaps[l] + difference(j).dot(&(moments * difference(l)))
        })
    }

    /// A with Var I_e = tr(A U), U the mixing.
    pub(super) fn swing(&self, entry: usize, gaps: &Matrix3<f64>) -> Matrix3<f64> {
        let d = &self.swing[entry];
        gaps.component_mul(&(d * d.transpose()))
    }

    /// The variances of the six entries, (kg·m²)².
    pub(super) fn variances(&self, scatter: &Scatter) -> [f64; 6] {
        let gaps = self.gaps(&scatter.moments);
        std::array::from_fn(|e| {
            (self.growth(e) * scatter.moments).trace()
                + (self.swing(e, &gaps) * scatter.mixing).trace()
        })
    }
}

/// The two axes that a rotation about a third one mixes.
fn others(axis: usize) -> (usize, usize) {
    ((axis + 1) % 3, (axis + 2) % 3)
}

/// E[sin² 2φ]/4 of a Gaussian angle φ of the given variance.
pub(super) fn mixing_of(variance: f64) -> f64 {
    -0.125 * libm::expm1(-8.0 * variance)
}

/// The most that mixing can be: that of a uniform angle.
pub(super) const MOST_MIXING: f64 = 0.125;

/// The variance of a Gaussian angle with E[sin² 2φ]/4 = u; infinite where that is all but 1/8.
pub(super) fn variance_of(mixing: f64) -> f64 {
    if mixing < MOST_MIXING * (1.0 - 1e-4) {
        -0.125 * libm::log1p(-8.0 * mixing)
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The derivatives, against the body that has changed by a little.
        #[test]
        fn entries_move_as_claimed(
            k in prop::array::uniform3(0.1..100.0f64),
            turn in prop::array::uniform3(-3.0..3.0f64),
            rotation in prop::array::uniform3(-1.0..1.0f64),
            growth in prop::array::uniform3(-0.05..0.05f64),
        ) {
            let build = |k: [f64; 3], q: &UnitQuaternion<f64>| {
                let k = gyradius_inertia::SecondMoments::new(k).unwrap();
                Inertia::from_second_moments(k, q).unwrap()
            };
            let q = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            let nominal = build(k, &q);
            let body = Body::new(&nominal);
            // The body's own order and signs of the axes.
            let (k, q) = (body.second_moments, body.attitude);
            const STEP: f64 = 1e-5;
            let grown = build(std::array::from_fn(|i| k[i] + growth[i]), &q);
            let about = Vector3::from(rotation) * STEP;
            let turned = build(k, &(UnitQuaternion::from_scaled_axis(-about) * q));
            for (e, &(a, b)) in ENTRIES.iter().enumerate() {
                let grew = grown.matrix()[(a, b)] - nominal.matrix()[(a, b)];
                prop_assert!((grew - body.growth[e].dot(&Vector3::from(growth))).abs() < 1e-11);
                let moved = (turned.matrix()[(a, b)] - nominal.matrix()[(a, b)]) / STEP;
                let claimed = body.swing[e].component_mul(&body.gaps).dot(&Vector3::from(rotation));
                let scale = k.iter().sum::<f64>();
                prop_assert!((moved - claimed).abs() < 1e-3 * scale, "{moved} {claimed}");
            }
        }
    }

    #[test]
    fn mixing_and_back() {
        for variance in [0.0, 1e-12, 1e-3, 0.1, 0.5] {
            let again = variance_of(mixing_of(variance));
            assert!((again - variance).abs() <= 1e-12 * variance, "{variance}");
        }
        assert_eq!(variance_of(mixing_of(f64::INFINITY)), f64::INFINITY);
        assert_eq!(variance_of(0.125), f64::INFINITY);
    }
}
