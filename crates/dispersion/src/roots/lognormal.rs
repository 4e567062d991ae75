use gyradius_inertia::RootSecondMoments;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{FAR, MAX_ROOT};
use crate::{RootMoments, SecondMomentStatistics};

/// Why a mean and a variance are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LognormalRootsError {
    /// No lognormal law has this mean and variance, or its tail leaves the range.
    #[error(
        "k_{axis} of mean {mean:?} √kg·m and variance {variance:?} kg·m²: the mean must be positive, \
         or zero with a variance of zero, the variance not negative, and no root may come out beyond \
         {MAX_ROOT:e} √kg·m"
    )]
    Parameters {
        /// Axis, from 1.
        axis: usize,
        /// The mean, √kg·m.
        mean: f64,
        /// The variance, kg·m².
        variance: f64,
    },
}

/// Independent lognormal roots k_k = √K_k: factors of uncertainty, never below zero.
///
/// # Definition
/// ln k_k ~ N(μ, s²) with s² = ln(1 + σ²/k̄²) and μ = ln k̄ − s²/2, so that k has the mean k̄ and the
/// variance σ². K is lognormal too: E K = k̄² + σ² = e^{2μ+2s²}, Var K = (E K)² (e^{4s²} − 1).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Parameters", into = "Parameters")
)]
pub struct LognormalRoots {
    mean: RootSecondMoments,
    variances: [f64; 3],
    /// μ and s; −∞ and 0 where the mean is zero.
    ln: [(f64, f64); 3],
}

impl LognormalRoots {
    /// Mean roots k̄ in √kg·m and the variances of the roots in kg·m²; zero keeps a root fixed.
    ///
    /// # Errors
    /// A mean is not positive where its variance is, a variance is negative or NaN, or roots within
    /// forty deviations of ln k come out beyond 1e75 √kg·m.
    pub fn new(mean: RootSecondMoments, variances: [f64; 3]) -> Result<Self, LognormalRootsError> {
        let mut ln = [(f64::NEG_INFINITY, 0.0); 3];
        for (i, (k, variance)) in mean.values().into_iter().zip(variances).enumerate() {
            let refused = LognormalRootsError::Parameters { axis: i + 1, mean: k, variance };
            if !(k >= 0.0 && variance >= 0.0 && (k > 0.0 || variance == 0.0)) {
                return Err(refused);
            }
            if k > 0.0 {
                // Roots first, so that nothing over- or underflows on the way.
                let ratio = variance.sqrt() / k;
                let square = libm::log1p(ratio * ratio);
                ln[i] = (libm::log(k) - 0.5 * square, square.sqrt());
            }
            if !(ln[i].0 + FAR * ln[i].1 <= libm::log(MAX_ROOT)) {
                return Err(refused);
            }
        }
        Ok(Self { mean, variances, ln })
    }

    /// k̄, √kg·m.
    #[must_use]
    pub fn mean(&self) -> RootSecondMoments {
        self.mean
    }

    /// Variances of the roots, kg·m².
    #[must_use]
    pub fn variances(&self) -> [f64; 3] {
        self.variances
    }

    /// The medians e^μ, √kg·m.
    #[must_use]
    pub fn medians(&self) -> [f64; 3] {
        self.ln.map(|(mu, _)| libm::exp(mu))
    }

    /// The deviations s of ln k, 1.
    #[must_use]
    pub fn log_deviations(&self) -> [f64; 3] {
        self.ln.map(|(_, s)| s)
    }
}

impl RootMoments for LognormalRoots {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        let k = self.mean.values();
        let mean: [f64; 3] = std::array::from_fn(|i| k[i] * k[i] + self.variances[i]);
        SecondMomentStatistics::independent(
            mean,
            std::array::from_fn(|i| {
                let (_, s) = self.ln[i];
                mean[i] * mean[i] * libm::expm1(4.0 * s * s)
            }),
        )
    }
}

impl Distribution<RootSecondMoments> for LognormalRoots {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> RootSecondMoments {
        loop {
            let mut draw = self.mean.values();
            for (k, (mu, s)) in draw.iter_mut().zip(self.ln) {
                if s > 0.0 {
                    let z: f64 = StandardNormal.sample(rng);
                    *k = libm::exp(mu + s * z);
                }
            }
            // Never refused within 40 deviations.
            if let Ok(roots) = RootSecondMoments::new(draw) {
                return roots;
            }
        }
    }
}

/// The serialized form.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Parameters {
    mean_sqrt_kg_m: RootSecondMoments,
    variance_kg_m2: [f64; 3],
}

#[cfg(feature = "serde")]
impl TryFrom<Parameters> for LognormalRoots {
    type Error = LognormalRootsError;

    fn try_from(p: Parameters) -> Result<Self, Self::Error> {
        Self::new(p.mean_sqrt_kg_m, p.variance_kg_m2)
    }
}

#[cfg(feature = "serde")]
impl From<LognormalRoots> for Parameters {
    fn from(law: LognormalRoots) -> Self {
        Self { mean_sqrt_kg_m: law.mean, variance_kg_m2: law.variances }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::root_moments::tests::check_moments;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    fn law(mean: [f64; 3], variances: [f64; 3]) -> Result<LognormalRoots, LognormalRootsError> {
        LognormalRoots::new(RootSecondMoments::new(mean).unwrap(), variances)
    }

    #[test]
    fn squares_have_their_moments() {
        check_moments(&law([30.0, 1.0, 0.0], [4.0, 0.01, 0.0]).unwrap(), 21);
        check_moments(&law([1e-3, 2.0, 5.0], [1e-9, 0.0, 1.0]).unwrap(), 22);
    }

    #[test]
    fn roots_are_positive_and_half_lie_below_the_median() {
        const N: usize = 100_000;
        let law = law([1.0, 1.0, 3.0], [0.2, 9.0, 1.0]).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(23);
        let mut below = [0; 3];
        for _ in 0..N {
            let k = law.sample(&mut rng).values();
            assert!(k.iter().all(|k| *k > 0.0));
            for i in 0..3 {
                below[i] += usize::from(k[i] < law.medians()[i]);
            }
        }
        for count in below {
            let z = (count as f64 - 0.5 * N as f64) / (0.25 * N as f64).sqrt();
            assert!(z.abs() < 4.0, "{z}");
        }
    }

    #[test]
    fn bad_parameters_are_named() {
        for (mean, variance) in
            [(0.0, 1.0), (-1.0, 0.0), (1.0, -1.0), (1.0, f64::NAN), (1.0, f64::INFINITY)]
        {
            let error = law([1.0, mean, 1.0], [0.1, variance, 0.1]).unwrap_err();
            assert!(error.to_string().contains("k_2"), "{error}");
        }
        assert!(law([1e74; 3], [1e148; 3]).is_err());
        assert!(law([1e-150; 3], [1e-304; 3]).is_ok());
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let law = law([1.0, 2.0, 3.0], [0.1, 0.2, 0.3]).unwrap();
        let json = serde_json::to_string(&law).unwrap();
        assert_eq!(serde_json::from_str::<LognormalRoots>(&json).unwrap(), law);
        assert!(serde_json::from_str::<LognormalRoots>(&json.replace("0.2", "-0.2")).is_err());
    }
}
