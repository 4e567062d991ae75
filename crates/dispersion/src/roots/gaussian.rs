use gyradius_inertia::RootSecondMoments;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{FAR, MAX_ROOT};
use crate::{RootMoments, SecondMomentStatistics};

/// Why variances are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GaussianRootsError {
    /// A variance is negative or NaN, or roots so large that their fourth powers would overflow.
    #[error(
        "variance of k_{axis} = {value:?} kg·m²: it must not be negative, and no root may come out \
         beyond {MAX_ROOT:e} √kg·m"
    )]
    Variance {
        /// Axis, from 1.
        axis: usize,
        /// The variance, kg·m².
        value: f64,
    },
}

/// Independent Gaussian roots k_k = √K_k of the second mass moments (Peck 2003, Eq. 10).
///
/// # Definition
/// k_k ~ N(k̄_k, σ_k²), K_k = k_k². Then K_k/σ_k² is noncentral χ² with one degree of freedom, so
/// E K = k̄² + σ² and Var K = 4k̄²σ² + 2σ⁴. A root may come out negative; its square does not care.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Parameters", into = "Parameters")
)]
pub struct GaussianRoots {
    mean: RootSecondMoments,
    variances: [f64; 3],
    deviations: [f64; 3],
}

impl GaussianRoots {
    /// Mean roots k̄ in √kg·m and the variances of the roots in kg·m²; zero keeps a root fixed.
    ///
    /// # Errors
    /// A variance is negative or NaN, or roots could come out beyond 1e75 √kg·m.
    pub fn new(mean: RootSecondMoments, variances: [f64; 3]) -> Result<Self, GaussianRootsError> {
        for (i, (k, value)) in mean.values().into_iter().zip(variances).enumerate() {
            let reach = k.abs() + FAR * value.sqrt();
            if !(value >= 0.0 && reach <= MAX_ROOT) {
                return Err(GaussianRootsError::Variance { axis: i + 1, value });
            }
        }
        Ok(Self { mean, variances, deviations: variances.map(f64::sqrt) })
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

    /// Deviations of the roots, √kg·m.
    #[must_use]
    pub fn deviations(&self) -> [f64; 3] {
        self.deviations
    }

    /// E K_k = k̄² + σ², kg·m².
    #[must_use]
    pub fn second_moment_means(&self) -> [f64; 3] {
        let k = self.mean.values();
        std::array::from_fn(|i| k[i] * k[i] + self.variances[i])
    }

    /// Var K_k = 4k̄²σ² + 2σ⁴, (kg·m²)².
    #[must_use]
    pub fn second_moment_variances(&self) -> [f64; 3] {
        let k = self.mean.values();
        std::array::from_fn(|i| {
            let variance = self.variances[i];
            2.0 * variance * (2.0 * k[i] * k[i] + variance)
        })
    }
}

impl RootMoments for GaussianRoots {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        SecondMomentStatistics::independent(
            self.second_moment_means(),
            self.second_moment_variances(),
        )
    }
}

impl Distribution<RootSecondMoments> for GaussianRoots {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> RootSecondMoments {
        let mean = self.mean.values();
        loop {
            let draw = std::array::from_fn(|i| {
                let z: f64 = StandardNormal.sample(rng);
                mean[i] + self.deviations[i] * z
            });
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
impl TryFrom<Parameters> for GaussianRoots {
    type Error = GaussianRootsError;

    fn try_from(p: Parameters) -> Result<Self, Self::Error> {
        Self::new(p.mean_sqrt_kg_m, p.variance_kg_m2)
    }
}

#[cfg(feature = "serde")]
impl From<GaussianRoots> for Parameters {
    fn from(law: GaussianRoots) -> Self {
        Self { mean_sqrt_kg_m: law.mean, variance_kg_m2: law.variances }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roots(k: [f64; 3]) -> RootSecondMoments {
        RootSecondMoments::new(k).unwrap()
    }

    #[test]
    fn bad_variances_are_named() {
        for bad in [-1.0, f64::NAN, f64::INFINITY, 1e198] {
            let error = GaussianRoots::new(roots([1.0; 3]), [0.1, bad, 0.1]).unwrap_err();
            assert!(error.to_string().contains("k_2"), "{error}");
        }
        assert!(GaussianRoots::new(roots([0.0; 3]), [0.0; 3]).is_ok());
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let law = GaussianRoots::new(roots([1.0, 2.0, 3.0]), [0.1, 0.2, 0.3]).unwrap();
        let json = serde_json::to_string(&law).unwrap();
        assert_eq!(serde_json::from_str::<GaussianRoots>(&json).unwrap(), law);
        assert!(serde_json::from_str::<GaussianRoots>(&json.replace("0.2", "-0.2")).is_err());
    }

    /// K/σ² is noncentral χ².
    #[test]
    fn squares_have_their_moments() {
        let law = GaussianRoots::new(roots([30.0, 1.0, 0.0]), [0.1, 4.0, 2.0]).unwrap();
        crate::root_moments::tests::check_moments(&law, 5);
    }
}
