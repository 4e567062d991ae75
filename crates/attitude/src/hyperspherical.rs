//! Hyperspherical angles of an attitude.

use nalgebra::{Quaternion, UnitQuaternion};
use std::f64::consts::{PI, TAU};

/// Why three numbers are not hyperspherical angles.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HypersphericalError {
    /// θ₁ or θ₂ is outside [0, π].
    #[error("theta_{index} = {value} rad: it must lie in [0, π]")]
    Polar {
        /// 1 or 2.
        index: usize,
        /// The angle, rad.
        value: f64,
    },
    /// θ₃ is outside [0, 2π].
    #[error("theta_3 = {value} rad: it must lie in [0, 2π]")]
    Azimuth {
        /// The angle, rad.
        value: f64,
    },
}

/// Hyperspherical angles Φ = (θ₁, θ₂, θ₃) of a unit quaternion (Peck 2003, Eq. 24, which is Eq. 13 in four
/// dimensions):
///
/// x₁ = sin θ₁ sin θ₂ cos θ₃, x₂ = sin θ₁ sin θ₂ sin θ₃, x₃ = sin θ₁ cos θ₂, x₄ = cos θ₁,
///
/// with θ₁, θ₂ ∈ [0, π] and θ₃ ∈ [0, 2π). Surface measure on S³ is sin²θ₁ sin θ₂ dθ₁ dθ₂ dθ₃
/// (Eq. 25 at r = 1).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[f64; 3]", into = "[f64; 3]"))]
pub struct HypersphericalAngles([f64; 3]);

impl HypersphericalAngles {
    /// Takes θ₁, θ₂, θ₃ in rad, in the ranges of Peck (2003, Eq. 14), ends included.
    ///
    /// # Errors
    /// An angle is NaN or out of its range.
    pub fn new(theta: [f64; 3]) -> Result<Self, HypersphericalError> {
        for index in 1..=2 {
            let value = theta[index - 1];
            if !(0.0..=PI).contains(&value) {
                return Err(HypersphericalError::Polar { index, value });
            }
        }
        if !(0.0..=TAU).contains(&theta[2]) {
            return Err(HypersphericalError::Azimuth { value: theta[2] });
        }
        Ok(Self(theta))
    }

    /// θ₁, θ₂, θ₃ in rad.
    #[must_use]
    pub fn values(&self) -> [f64; 3] {
        self.0
    }

    /// The unit quaternion of these angles.
    #[must_use]
    pub fn quaternion(&self) -> UnitQuaternion<f64> {
        let [(s1, c1), (s2, c2), (s3, c3)] = self.0.map(libm::sincos);
        UnitQuaternion::from_quaternion(Quaternion::new(c1, s1 * s2 * c3, s1 * s2 * s3, s1 * c2))
    }

    /// The Jacobian determinant Δ = sin²θ₁ sin θ₂ between Φ and surface measure (Peck 2003, Eq. 25, r = 1;
    /// Eq. 16 in four dimensions).
    #[must_use]
    pub fn jacobian(&self) -> f64 {
        let (s1, s2) = (libm::sin(self.0[0]), libm::sin(self.0[1]));
        s1 * s1 * s2
    }
}

impl TryFrom<[f64; 3]> for HypersphericalAngles {
    type Error = HypersphericalError;

    fn try_from(theta: [f64; 3]) -> Result<Self, Self::Error> {
        Self::new(theta)
    }
}

impl From<HypersphericalAngles> for [f64; 3] {
    fn from(angles: HypersphericalAngles) -> Self {
        angles.0
    }
}

impl From<&UnitQuaternion<f64>> for HypersphericalAngles {
    /// The angles of a unit quaternion. At the poles, where angles are free, they are zero.
    fn from(q: &UnitQuaternion<f64>) -> Self {
        let [x1, x2, x3, x4] = [q.i, q.j, q.k, q.w];
        // atan2 of norms, not acos: accurate at the poles as well.
        let planar = libm::hypot(x1, x2);
        let azimuth = if planar == 0.0 { 0.0 } else { libm::atan2(x2, x1) };
        // Adding 2π to a hair below zero rounds to 2π, which is 0.
        let azimuth = if azimuth < 0.0 { (azimuth + TAU) % TAU } else { azimuth };
        let polar = if planar == 0.0 && x3 == 0.0 { 0.0 } else { libm::atan2(planar, x3) };
        Self([libm::atan2(libm::hypot(planar, x3), x4), polar, azimuth])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix4;
    use proptest::prelude::*;

    #[test]
    fn poles_and_out_of_range() {
        assert_eq!(HypersphericalAngles::from(&UnitQuaternion::identity()).values(), [0.0; 3]);
        let opposite = UnitQuaternion::new_unchecked(-*UnitQuaternion::identity());
        assert_eq!(HypersphericalAngles::from(&opposite).values(), [PI, 0.0, 0.0]);
        let hair = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 1.0, -1e-300, 0.0));
        assert_eq!(HypersphericalAngles::from(&hair).values()[2], 0.0);
        for bad in [[-0.1, 1.0, 1.0], [1.0, 3.2, 1.0], [1.0, 1.0, 6.3], [f64::NAN, 1.0, 1.0]] {
            assert!(HypersphericalAngles::new(bad).is_err());
        }
        let error = HypersphericalAngles::new([1.0, 4.0, 1.0]).unwrap_err().to_string();
        assert!(error.contains("theta_2 = 4"), "{error}");
    }

    proptest! {
        #[test]
        fn round_trips(x in prop::array::uniform4(-1.0..1.0f64)) {
            let x = nalgebra::Vector4::from(x);
            prop_assume!(x.norm() > 0.1);
            let q = UnitQuaternion::from_quaternion(Quaternion::from(x));
            let angles = HypersphericalAngles::from(&q);
            prop_assert!(HypersphericalAngles::new(angles.values()).is_ok());
            prop_assert!((angles.quaternion().coords - q.coords).amax() < 1e-15);
        }

        /// The determinant of ∂x/∂(Φ, r) by central differences is Δ.
        #[test]
        fn jacobian_matches_differences(
            t1 in 0.1..3.0f64, t2 in 0.1..3.0f64, t3 in 0.1..6.0f64,
        ) {
            let g = |t: [f64; 3]| HypersphericalAngles(t).quaternion().coords;
            let h = 1e-5;
            let mut m = Matrix4::zeros();
            for i in 0..3 {
                let (mut up, mut down) = ([t1, t2, t3], [t1, t2, t3]);
                up[i] += h;
                down[i] -= h;
                m.set_column(i, &((g(up) - g(down)) / (2.0 * h)));
            }
            m.set_column(3, &g([t1, t2, t3]));
            let angles = HypersphericalAngles([t1, t2, t3]);
            prop_assert!((m.determinant().abs() - angles.jacobian()).abs() < 1e-9);
        }
    }
}
