//! The radially constrained Gaussian kept to the half sphere around its mean.

use nalgebra::UnitQuaternion;
use rand::Rng;
use rand_distr::Distribution;
use std::sync::OnceLock;

use crate::{RadiallyConstrainedGaussian, fisher_bingham::LN_PI_SQUARED};

/// A radially constrained Gaussian kept to the half sphere around its mean, x·m ≥ 0.
///
/// # Definition
/// The density of [`RadiallyConstrainedGaussian`] over its share of that half where x·m ≥ 0, zero
/// elsewhere. Every attitude but a null set has exactly one quaternion in that half, so this is the
/// law to use when the second lobe, which as attitudes lies about the *inverse* of the mean, is not
/// wanted.
///
/// # Algorithm
/// Draws of the whole law, those of the far half refused.
///
/// ```
/// use gyradius_attitude::{MeanHalf, RadiallyConstrainedGaussian};
/// use nalgebra::{Matrix4, UnitQuaternion};
///
/// let wide = Matrix4::from_diagonal_element(1.0);
/// let half = MeanHalf::new(RadiallyConstrainedGaussian::new(UnitQuaternion::identity(), wide)?);
/// assert!((half.share() - 0.700_619_948_837).abs() < 1e-12);
/// # Ok::<(), gyradius_attitude::RcgError>(())
/// ```
#[derive(Clone, Debug, getset::Getters)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "RadiallyConstrainedGaussian", into = "RadiallyConstrainedGaussian")
)]
pub struct MeanHalf {
    /// The law on the whole sphere.
    #[getset(get = "pub")]
    whole: RadiallyConstrainedGaussian,
    /// Takes a thousand times as long as the rest: computed when it is asked for.
    far_share: OnceLock<f64>,
}

impl PartialEq for MeanHalf {
    fn eq(&self, other: &Self) -> bool {
        self.whole == other.whole
    }
}

impl MeanHalf {
    /// Keeps `law` to the half sphere around its mean.
    #[must_use]
    pub fn new(law: RadiallyConstrainedGaussian) -> Self {
        Self { whole: law, far_share: OnceLock::new() }
    }

    /// The share of the whole law that is kept: one less
    /// [`far_half_share`](RadiallyConstrainedGaussian::far_half_share).
    #[must_use]
    pub fn share(&self) -> f64 {
        1.0 - self.far_share()
    }

    fn far_share(&self) -> f64 {
        *self.far_share.get_or_init(|| self.whole.far_half_share())
    }

    /// The logarithm of the density at q with respect to surface measure on S³, −∞ in the far half.
    #[must_use]
    pub fn ln_density(&self, q: &UnitQuaternion<f64>) -> f64 {
        if self.whole.in_mean_half(q) {
            self.whole.ln_density(q) - libm::log1p(-self.far_share())
        } else {
            f64::NEG_INFINITY
        }
    }

    /// The logarithm of the density of the attitude, whichever of q and −q it is given as, with
    /// respect to Haar measure on SO(3), normalised to one.
    #[must_use]
    pub fn ln_haar_density(&self, q: &UnitQuaternion<f64>) -> f64 {
        let opposite = UnitQuaternion::new_unchecked(-q.into_inner());
        self.ln_density(q).max(self.ln_density(&opposite)) + LN_PI_SQUARED
    }

    /// Fills a slice with independent draws. Which ones depends on the length of the slice: those that are not in the half are drawn again
    /// when the others are there.
    pub fn sample_into<R: Rng + ?Sized>(&self, rng: &mut R, out: &mut [UnitQuaternion<f64>]) {
        let mut kept = 0;
        while kept < out.len() {
            self.whole.sample_into(rng, &mut out[kept..]);
            let drawn = kept..out.len();
            for i in drawn {
                if self.whole.in_mean_half(&out[i]) {
                    out.swap(kept, i);
                    kept += 1;
                }
            }
        }
    }
}

impl From<RadiallyConstrainedGaussian> for MeanHalf {
    fn from(law: RadiallyConstrainedGaussian) -> Self {
        Self::new(law)
    }
}

impl From<MeanHalf> for RadiallyConstrainedGaussian {
    fn from(half: MeanHalf) -> Self {
        half.whole
    }
}

impl Distribution<UnitQuaternion<f64>> for MeanHalf {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        loop {
            let q = self.whole.sample(rng);
            // The mean is the mode, so its half is never empty and this ends.
            if self.whole.in_mean_half(&q) {
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

    /// Batches and single draws have the same first moments.
    #[test]
    fn batches_are_of_the_same_law() {
        const N: usize = 100_000;
        let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
        let mean = UnitQuaternion::from_euler_angles(0.05, 0.0, -0.02);
        let half = MeanHalf::new(RadiallyConstrainedGaussian::new(mean, covariance).unwrap());
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut batch = vec![UnitQuaternion::identity(); N];
        half.sample_into(&mut rng, &mut batch);
        assert!(batch.iter().all(|q| half.whole().in_mean_half(q)));
        let single: Vec<_> = (0..N).map(|_| half.sample(&mut rng)).collect();
        for k in 0..4 {
            let moments = |draws: &[UnitQuaternion<f64>]| {
                let mean = draws.iter().map(|q| q.coords[k]).sum::<f64>() / N as f64;
                let square = draws.iter().map(|q| (q.coords[k] - mean).powi(2)).sum::<f64>();
                (mean, square / N as f64)
            };
            let ((a, v), (b, w)) = (moments(&batch), moments(&single));
            let z = (a - b) / ((v + w) / N as f64).sqrt();
            assert!(z.abs() < 4.0, "coordinate {k}: z = {z}");
            assert!((v / w - 1.0).abs() < 0.05, "coordinate {k}: {v} {w}");
        }
    }

    #[test]
    fn the_density_is_one_over_an_even_grid() {
        let covariance = Matrix4::from_diagonal(&Vector4::new(0.3, 0.4, 0.5, 0.8));
        let mean = UnitQuaternion::from_euler_angles(0.5, 0.2, -0.3);
        let half = MeanHalf::new(RadiallyConstrainedGaussian::new(mean, covariance).unwrap());
        let n = 20_000;
        let sum: f64 = crate::super_fibonacci(n).map(|q| half.ln_haar_density(&q).exp()).sum();
        assert!((sum / f64::from(n) - 1.0).abs() < 1e-3, "{}", sum / f64::from(n));
        let far = UnitQuaternion::new_unchecked(-mean.into_inner());
        assert_eq!(half.ln_density(&far), f64::NEG_INFINITY);
        assert_eq!(half.ln_haar_density(&far), half.ln_haar_density(&mean));
    }
}
