use nalgebra::UnitQuaternion;
use rand::Rng;
use rand_distr::Distribution;

use crate::RadiallyConstrainedGaussian;

/// A radially constrained Gaussian kept to the half sphere around its mean, x·m ≥ 0.
///
/// # Definition
/// The density of [`RadiallyConstrainedGaussian`] where x·m ≥ 0, zero elsewhere. Every attitude
/// but a null set has exactly one quaternion in that half, so this is the law to use when the
/// second lobe, which as attitudes lies about the *inverse* of the mean, is not wanted.
///
/// # Algorithm
/// Draws of the whole law, those of the far half refused.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
pub struct MeanHalf(RadiallyConstrainedGaussian);

impl MeanHalf {
    /// Keeps `law` to the half sphere around its mean.
    #[must_use]
    pub fn new(law: RadiallyConstrainedGaussian) -> Self {
        Self(law)
    }

    /// The law on the whole sphere.
    #[must_use]
    pub fn whole(&self) -> &RadiallyConstrainedGaussian {
        &self.0
    }
}

impl Distribution<UnitQuaternion<f64>> for MeanHalf {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        loop {
            let q = self.0.sample(rng);
            // The mean is the mode, so its half is never empty and this ends.
            if self.0.in_mean_half(&q) {
                return q;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix4, Vector4};
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    #[test]
    fn never_leaves_its_half() {
        let covariance = Matrix4::from_diagonal(&Vector4::new(0.1, 0.2, 0.3, 5.0));
        let mean = UnitQuaternion::from_euler_angles(0.5, 0.2, -0.3);
        let whole = RadiallyConstrainedGaussian::new(mean, covariance).unwrap();
        let half = MeanHalf::new(whole.clone());
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let far = (0..1000).filter(|_| !whole.in_mean_half(&whole.sample(&mut rng))).count();
        assert!(far > 200, "the whole law has a far half to lose: {far}");
        assert!((0..1000).all(|_| whole.in_mean_half(&half.sample(&mut rng))));
    }
}
