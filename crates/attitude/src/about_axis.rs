//! Attitudes turned about a known axis by any angle.

use nalgebra::{Matrix4, Quaternion, Unit, UnitQuaternion, Vector3, Vector4};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Attitudes q = m ⊗ exp(φ a/2) with a known axis a and an angle φ of which nothing is known.
///
/// # Definition
/// φ is uniform on the circle: the uniform law on the great circle of S³ through m and m ⊗ (a, 0), which is one
/// attitude for each angle. It has no density on S³. A spinner whose spin axis is known and whose phase is not has
/// such a law, and so do the principal axes of a nearly symmetric body, of which only the axis of symmetry is known.
/// Every draw takes a to the same direction: R(q) a = R(m) a.
///
/// ```
/// use gyradius_attitude::AboutAxis;
/// use nalgebra::{UnitQuaternion, Vector3};
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
/// use rand_distr::Distribution;
///
/// let law = AboutAxis::new(UnitQuaternion::identity(), Vector3::z_axis());
/// let q = law.sample(&mut ChaCha8Rng::seed_from_u64(1));
/// assert!((q * Vector3::z() - Vector3::z()).norm() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[getset(get_copy = "pub")]
pub struct AboutAxis {
    /// The attitude at the angle zero.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::unit"))]
    attitude: UnitQuaternion<f64>,
    /// The axis, in body components.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::unit"))]
    axis: Unit<Vector3<f64>>,
}

impl AboutAxis {
    /// Turns about an axis in body components, from one attitude of the circle.
    #[must_use]
    pub fn new(attitude: UnitQuaternion<f64>, axis: Unit<Vector3<f64>>) -> Self {
        Self { attitude, axis }
    }

    /// The attitude at an angle in rad.
    #[must_use]
    pub fn at(&self, angle: f64) -> UnitQuaternion<f64> {
        self.on_circle(libm::cos(0.5 * angle), libm::sin(0.5 * angle))
    }

    /// E x xᵀ of the four coordinates, scalar last. Their mean is zero.
    #[must_use]
    pub fn second_moment(&self) -> Matrix4<f64> {
        let (m, n) = (self.attitude.coords, self.quarter());
        0.5 * (m * m.transpose() + n * n.transpose())
    }

    /// m ⊗ (a, 0), at right angles to m.
    fn quarter(&self) -> Vector4<f64> {
        (self.attitude.into_inner() * Quaternion::from_imag(self.axis.into_inner())).coords
    }

    fn on_circle(&self, cos: f64, sin: f64) -> UnitQuaternion<f64> {
        let coords = self.attitude.coords * cos + self.quarter() * sin;
        UnitQuaternion::new_normalize(Quaternion::from(coords))
    }
}

impl Distribution<UnitQuaternion<f64>> for AboutAxis {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        loop {
            // The direction of two normals is uniform on the circle.
            let (x, y): (f64, f64) = (StandardNormal.sample(rng), StandardNormal.sample(rng));
            let square = x * x + y * y;
            // Both this small has probability 1e-16; their norm would lose digits.
            if square > 1e-16 {
                let norm = square.sqrt();
                return self.on_circle(x / norm, y / norm);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use std::f64::consts::PI;

    fn vector() -> impl Strategy<Value = Vector3<f64>> {
        let number = || -1.0..1.0_f64;
        let vector = (number(), number(), number()).prop_map(|(x, y, z)| Vector3::new(x, y, z));
        vector.prop_filter("a direction", |v| v.norm() > 0.1)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        /// Any mean and axis: the axis stays, the angle is uniform (by the characteristic function), coordinates
        /// have the second moment that is told, and each draw is the attitude at its angle.
        #[test]
        fn the_axis_stays_and_the_angle_is_any(turn in vector(), axis in vector(), seed in any::<u64>()) {
            const N: usize = 4000;
            let mean = UnitQuaternion::from_scaled_axis(turn * 3.0);
            let axis = Unit::new_normalize(axis);
            let law = AboutAxis::new(mean, axis);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let (mut circle, mut moment) = ([0.0; 4], Matrix4::zeros());
            for _ in 0..N {
                let q = law.sample(&mut rng);
                prop_assert!((q.norm() - 1.0).abs() < 1e-14);
                prop_assert!((q * axis.into_inner() - mean * axis.into_inner()).norm() < 1e-14);
                let turn = (mean.inverse() * q).scaled_axis().dot(&axis);
                prop_assert!(law.at(turn).angle_to(&q) < 1e-7);
                for (sum, term) in circle.iter_mut().zip([turn.cos(), turn.sin(), (2.0 * turn).cos(), (2.0 * turn).sin()]) {
                    *sum += term / N as f64;
                }
                moment += q.coords * q.coords.transpose() / N as f64;
            }
            // Four standard errors and a half of means of cosines, of 480 of them.
            let error = 4.5 * (0.5 / N as f64).sqrt();
            prop_assert!(circle.iter().all(|mean| mean.abs() < error), "{circle:?}");
            prop_assert!((moment - law.second_moment()).amax() < error);
        }
    }

    #[test]
    fn the_angles_are_those_of_the_circle() {
        let law = AboutAxis::new(UnitQuaternion::identity(), Vector3::x_axis());
        for degrees in -360..=360 {
            let angle = f64::from(degrees) * PI / 180.0;
            let expected = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
            assert!(law.at(angle).angle_to(&expected) < 1e-7, "{degrees}");
        }
    }
}
