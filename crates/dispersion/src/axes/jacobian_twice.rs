//! The law of the principal axes behind Table 2 of Peck (2003).

use gyradius_attitude::{FisherBingham, FisherBinghamError, RadiallyConstrainedGaussian};
use nalgebra::{Matrix4, UnitQuaternion, Vector4};
use rand::{Rng, RngExt, SeedableRng, rngs::Xoshiro256PlusPlus};
use rand_distr::Distribution;
use std::sync::OnceLock;

use super::LN_PI_SQUARED;
use super::weighted_half::WeightedHalf;

/// Why a law cannot have its Jacobian counted twice.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JacobianTwiceError {
    /// The parameters of the envelope are out of range.
    #[error(transparent)]
    Envelope(#[from] FisherBinghamError),
    /// No proposal was accepted in a long trial.
    #[error(
        "the covariance of the axes is so shaped that the law with the Jacobian counted twice \
         cannot be drawn from: its scalar part must not be so strongly correlated with the rest"
    )]
    NoEnvelope,
}

/// The law of attitudes behind Table 2 of Peck (2003): the half sphere around the mean, with the
/// Jacobian of the hyperspherical angles counted twice.
///
/// # Definition
/// Density ∝ exp(−½(x − m)ᵀΣ⁻¹(x − m)) · sin²θ₁ sin θ₂ where x·m ≥ 0, with respect to surface
/// measure on S³, which already holds that Jacobian once (Eq. 25); in coordinates, the second
/// factor is |v|·√(x₁² + x₂²), v = (x₁, x₂, x₃). It vanishes at the mean of a small attitude, which
/// is how a Gaussian comes to have two peaks. It is here to reproduce the paper and for no other
/// purpose.
///
/// # Algorithm
/// Exact rejection. Since t ≤ e^{t−1}, |v|² ≤ a·exp(|v|²/a − 1) for any a, and the same for
/// x₁² + x₂²: both bounds are Gaussian factors, so the envelope is a Fisher-Bingham law with a
/// changed quadratic form. The best a is the envelope's own E[|v|²]. Where such an envelope is worse
/// than the law with the Jacobian counted once, that is the envelope.
///
/// # Limits
/// Laws of which not one proposal in fifty thousand is accepted are refused.
#[derive(Clone, Debug)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "RadiallyConstrainedGaussian", into = "RadiallyConstrainedGaussian")
)]
pub struct JacobianTwice {
    law: RadiallyConstrainedGaussian,
    envelope: FisherBingham,
    /// a for |v|² and for x₁² + x₂²; none where the envelope is the plain law.
    sizes: Option<[f64; 2]>,
    /// ln of the mean of the second Jacobian, zero in the far half, under the law with the Jacobian counted once: takes
    /// milliseconds, and is computed when it is asked for.
    ln_mean: OnceLock<f64>,
}

/// All else follows from it.
impl PartialEq for JacobianTwice {
    fn eq(&self, other: &Self) -> bool {
        self.law == other.law
    }
}

impl JacobianTwice {
    /// From the law with the Jacobian counted once.
    ///
    /// # Errors
    /// The covariance is so concentrated (eigenvalues below 1e-13) that the envelope's parameters
    /// are out of range, or so shaped that no envelope is of use.
    pub fn new(law: RadiallyConstrainedGaussian) -> Result<Self, JacobianTwiceError> {
        const ITERATIONS: usize = 12;
        const TRIALS: usize = 50_000;
        let precision = law.precision();
        let linear = precision * law.mean().coords;
        let squares = |second: &Matrix4<f64>| {
            let planar = second[(0, 0)] + second[(1, 1)];
            [planar + second[(2, 2)], planar]
        };
        let envelope = |[all, planar]: [f64; 2]| {
            let both = 1.0 / all + 1.0 / planar;
            let loosened = Matrix4::from_diagonal(&Vector4::new(both, both, 1.0 / all, 0.0));
            FisherBingham::new(precision - loosened, linear)
        };
        // How many times more proposals of the plain law would be needed than of an envelope.
        let plain = FisherBingham::new(precision, linear)?;
        let ln_gain = |[all, planar]: [f64; 2], envelope: &FisherBingham| {
            plain.ln_normaliser() + 1.0 - 0.5 * libm::log(all * planar) - envelope.ln_normaliser()
        };
        let mut sizes = squares(&law.second_moment());
        let mut best = (0.0, plain.clone(), None);
        for _ in 0..ITERATIONS {
            let next = envelope(sizes)?;
            let gain = ln_gain(sizes, &next);
            let own = squares(&next.second_moment());
            if gain > best.0 {
                best = (gain, next, Some(sizes));
            }
            // The geometric mean damps the iteration, which overshoots.
            sizes = std::array::from_fn(|i| (sizes[i] * own[i]).sqrt());
        }
        let found = Self { envelope: best.1, law, sizes: best.2, ln_mean: OnceLock::new() };
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(0);
        if (0..TRIALS).any(|_| found.propose(&mut rng).is_some()) {
            Ok(found)
        } else {
            Err(JacobianTwiceError::NoEnvelope)
        }
    }

    /// A draw of the envelope, if it is accepted.
    fn propose<R: Rng + ?Sized>(&self, rng: &mut R) -> Option<UnitQuaternion<f64>> {
        let q = self.envelope.sample(rng);
        let planar = q.i * q.i + q.j * q.j;
        let all = planar + q.k * q.k;
        // The square of the share to accept.
        let share = match self.sizes {
            Some([a, b]) => all / a * (planar / b) * libm::exp(2.0 - all / a - planar / b),
            None => all * planar,
        };
        let u: f64 = rng.random();
        (u * u < share && self.law.in_mean_half(&q)).then_some(q)
    }

    /// The logarithm of the density of the attitude, whichever of q and −q it is given as, with respect to Haar
    /// measure on SO(3), normalised to one. The normaliser is found when it is first asked for, by adaptive cubature, to 1e-5
    /// of itself; where a thin ridge of the law escapes the cubature, by quadrature over the angles, to better than 1e-2.
    #[must_use]
    pub fn ln_haar_density(&self, q: &UnitQuaternion<f64>) -> f64 {
        // One of q and −q lies in the half, and the second factor is the same for both.
        let near = if self.law.in_mean_half(q) {
            *q
        } else {
            UnitQuaternion::new_unchecked(-q.into_inner())
        };
        let second = second_jacobian(&q.coords.into());
        self.law.ln_density(&near) + libm::log(second) - self.ln_mean() + LN_PI_SQUARED
    }

    fn ln_mean(&self) -> f64 {
        *self.ln_mean.get_or_init(|| {
            libm::log(WeightedHalf::new(&self.law, second_jacobian).mean_of_weight())
        })
    }

    /// The law with the Jacobian counted once.
    #[must_use]
    pub fn once(&self) -> &RadiallyConstrainedGaussian {
        &self.law
    }
}

/// sin²θ₁ sin θ₂ of the hyperspherical angles of x.
pub(super) fn second_jacobian(x: &[f64; 4]) -> f64 {
    let planar = x[0] * x[0] + x[1] * x[1];
    ((planar + x[2] * x[2]) * planar).sqrt()
}

impl TryFrom<RadiallyConstrainedGaussian> for JacobianTwice {
    type Error = JacobianTwiceError;

    fn try_from(law: RadiallyConstrainedGaussian) -> Result<Self, Self::Error> {
        Self::new(law)
    }
}

impl From<JacobianTwice> for RadiallyConstrainedGaussian {
    fn from(twice: JacobianTwice) -> Self {
        twice.law
    }
}

impl Distribution<UnitQuaternion<f64>> for JacobianTwice {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        loop {
            if let Some(q) = self.propose(rng) {
                return q;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entry_moments::ENTRIES;
    use crate::{AttitudeMoments, SecondMomentStatistics};
    use gyradius_attitude::UniformAttitude;
    use nalgebra::{Matrix3, Vector3};
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    fn law() -> RadiallyConstrainedGaussian {
        let mean = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
            0.9996, 0.0249, 0.0005, -0.0100,
        ));
        let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
        RadiallyConstrainedGaussian::new(mean, covariance).unwrap()
    }

    /// Against the definition, by weighting draws of the plain law: another path to every moment.
    #[test]
    fn agrees_with_weighted_draws_of_the_plain_law() {
        const N: usize = 400_000;
        let plain = law();
        let twice = JacobianTwice::new(plain.clone()).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(21);
        let measure = |q: &UnitQuaternion<f64>| [q.i, q.j, q.k, q.i * q.i, q.j * q.j, q.k * q.k];
        let direct: Vec<[f64; 6]> = (0..N).map(|_| measure(&twice.sample(&mut rng))).collect();
        let weighted: Vec<(f64, [f64; 6])> = (0..N)
            .map(|_| plain.sample(&mut rng))
            .filter(|q| plain.in_mean_half(q))
            .map(|q| {
                let planar = q.i * q.i + q.j * q.j;
                (((planar + q.k * q.k) * planar).sqrt(), measure(&q))
            })
            .collect();
        let total: f64 = weighted.iter().map(|w| w.0).sum();
        for k in 0..6 {
            let a = direct.iter().map(|x| x[k]).sum::<f64>() / N as f64;
            let va = direct.iter().map(|x| (x[k] - a).powi(2)).sum::<f64>() / (N as f64).powi(2);
            let b = weighted.iter().map(|(w, x)| w * x[k]).sum::<f64>() / total;
            let vb = weighted.iter().map(|(w, x)| (w * (x[k] - b)).powi(2)).sum::<f64>()
                / (total * total);
            let z = (a - b) / (va + vb).sqrt();
            assert!(z.abs() < 4.0, "moment {k}: {a} {b}, z = {z}");
            // Negative control: the plain law itself is far off in the squares.
            if k >= 4 {
                let plain = plain.second_moment()[(k - 3, k - 3)];
                assert!((a - plain).abs() > 20.0 * (va + vb).sqrt());
            }
        }
    }

    #[test]
    fn the_envelope_is_useful() {
        let twice = JacobianTwice::new(law()).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let kept = (0..30_000).filter(|_| twice.propose(&mut rng).is_some()).count();
        assert!(kept > 10_000, "{kept} of 30000");
    }

    /// Correlation of the scalar part with the vector part once sent the envelope to a far lobe, and
    /// the sampler there for ever.
    #[test]
    fn correlated_covariances_are_served() {
        let (s, t) = (0.002575, 0.004286825748732972);
        let covariance = Matrix4::new(
            s, 0.0, 0.0, t, 0.0, 1e-4, 0.0, 0.0, 0.0, 0.0, 1e-4, 0.0, t, 0.0, 0.0, 0.007525,
        );
        let plain = RadiallyConstrainedGaussian::new(law().mean(), covariance).unwrap();
        let twice = JacobianTwice::new(plain.clone()).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..100 {
            assert!(plain.in_mean_half(&twice.sample(&mut rng)));
        }
    }

    /// Of laws of any shape, thin ridges that wind to the edge of the half among them: the mean of the second Jacobian, and the
    /// moments of the entries, against draws of the plain law and of this one.
    #[test]
    fn laws_of_any_shape_agree_with_draws() {
        const LAWS: u64 = 8;
        const N: usize = 4_000;
        let mut ways = [0; 2];
        let k = SecondMomentStatistics::joint([1.0, 4.0, 9.0], Matrix3::identity() * 0.01);
        let principal = Matrix3::from_diagonal(&Vector3::from(k.principal_mean()));
        for seed in 0..LAWS {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let turn = |rng: &mut ChaCha8Rng| UniformAttitude.sample(rng);
            let turned: [UnitQuaternion<f64>; 2] = [turn(&mut rng), turn(&mut rng)];
            // Any rotation of four dimensions, in every other law.
            let axes = Matrix4::from_fn(|i, j| {
                let mut one = Vector4::zeros();
                one[j] = 1.0;
                let product = turned[0].into_inner()
                    * nalgebra::Quaternion::from(one)
                    * turned[1].into_inner();
                if seed % 2 == 0 { one[i] } else { product.coords[i] }
            });
            let lengths = Vector4::from_fn(|_, _| 10_f64.powf(rng.random_range(-5.0..1.0)));
            let covariance = axes * Matrix4::from_diagonal(&lengths) * axes.transpose();
            let mean = turn(&mut rng);
            let plain =
                RadiallyConstrainedGaussian::new(mean, 0.5 * (covariance + covariance.transpose()))
                    .unwrap();
            let Ok(twice) = JacobianTwice::new(plain.clone()) else { continue };
            let weights: Vec<f64> =
                (0..N)
                    .map(|_| plain.sample(&mut rng))
                    .map(|q| {
                        if plain.in_mean_half(&q) { second_jacobian(&q.coords.into()) } else { 0.0 }
                    })
                    .collect();
            let moments = |of: &[f64]| {
                let mean = of.iter().sum::<f64>() / N as f64;
                (
                    mean,
                    (of.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (N as f64).powi(2))
                        .sqrt(),
                )
            };
            let ((drawn, error), found) = (moments(&weights), libm::exp(twice.ln_mean()));
            assert!((found - drawn).abs() < 4.0 * error, "{seed}: {found} {drawn} ± {error}");
            let half = WeightedHalf::new(&plain, second_jacobian);
            ways[usize::from(matches!(half, WeightedHalf::Cubature(..)))] += 1;
            let entries = twice.entry_moments(&k);
            let draws: Vec<Matrix3<f64>> = (0..N)
                .map(|_| {
                    let turn = twice.sample(&mut rng).to_rotation_matrix();
                    turn.matrix().tr_mul(&principal) * turn.matrix()
                })
                .collect();
            for (e, (i, j)) in ENTRIES.into_iter().enumerate() {
                let of: Vec<f64> = draws.iter().map(|inertia| inertia[(i, j)]).collect();
                let (drawn, error) = moments(&of);
                let found = entries.mean()[e];
                assert!(
                    (found - drawn).abs() < 4.0 * error,
                    "{seed}, {e}: {found} {drawn} ± {error}"
                );
                // A variance as well: of something that is not Gaussian, to a quarter.
                let deviation = entries.covariance()[(e, e)].sqrt() / (N as f64).sqrt();
                assert!((deviation / error - 1.0).abs() < 0.25, "{seed}, {e}: {deviation} {error}");
            }
        }
        // Both ways are taken.
        assert!(ways[0] >= 2 && ways[1] >= 2, "{ways:?}");
    }
}
