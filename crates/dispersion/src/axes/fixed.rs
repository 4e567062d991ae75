//! Principal axes that are known.

use nalgebra::UnitQuaternion;
#[cfg(feature = "serde")]
use nalgebra::{Quaternion, Vector4};
use rand::Rng;
use rand_distr::Distribution;

/// The same attitude every time: principal axes that are known, or that do not matter.
///
/// Takes no random numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedAttitude(UnitQuaternion<f64>);

impl FixedAttitude {
    /// At an attitude, which takes body components to principal components. It is normalised; one
    /// without a length is taken for the identity.
    #[must_use]
    pub fn new(attitude: UnitQuaternion<f64>) -> Self {
        let norm = attitude.norm();
        let exact = (attitude.norm_squared() - 1.0).abs() <= 4.0 * f64::EPSILON;
        if exact {
            Self(attitude)
        } else if norm > 1e-150 && norm < 1e150 {
            Self(UnitQuaternion::new_normalize(attitude.into_inner()))
        } else {
            Self(UnitQuaternion::identity())
        }
    }

    /// The attitude.
    #[must_use]
    pub fn attitude(&self) -> UnitQuaternion<f64> {
        self.0
    }
}

impl From<UnitQuaternion<f64>> for FixedAttitude {
    fn from(attitude: UnitQuaternion<f64>) -> Self {
        Self::new(attitude)
    }
}

impl Distribution<UnitQuaternion<f64>> for FixedAttitude {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, _: &mut R) -> UnitQuaternion<f64> {
        self.0
    }
}

/// The attitude that was read, scalar last.
#[cfg(feature = "serde")]
pub(crate) fn unit(attitude: [f64; 4]) -> Result<UnitQuaternion<f64>, &'static str> {
    let x = Vector4::from(attitude);
    if !((x.norm() - 1.0).abs() < 1e-9) {
        return Err("attitude: it must be a unit quaternion, scalar last");
    }
    Ok(UnitQuaternion::new_unchecked(Quaternion::from(x)))
}

crate::written!(
    FixedAttitude,
    |law| { attitude: [f64; 4] = law.0.coords.into(), },
    FixedAttitude::new(unit(attitude)?)
);

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    #[test]
    fn it_is_always_the_same_unit_quaternion() {
        let q = UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        assert_eq!(FixedAttitude::new(q).sample(&mut rng), q);
        let long = UnitQuaternion::new_unchecked(q.into_inner() * 7.0);
        assert!((FixedAttitude::new(long).attitude().coords - q.coords).amax() < 1e-15);
        let none = UnitQuaternion::new_unchecked(q.into_inner() * f64::NAN);
        assert_eq!(FixedAttitude::new(none).attitude(), UnitQuaternion::identity());
    }
}
