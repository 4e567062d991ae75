use gyradius_inertia::RootSecondMoments;
use rand::{Rng, RngExt};
use rand_distr::Distribution;

use super::MAX_ROOT;
use crate::{RootMoments, SecondMomentStatistics};

/// Why intervals are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UniformRootsError {
    /// A bound is NaN or too large, or the second is below the first.
    #[error(
        "k_{axis} from {low:?} to {high:?} √kg·m: bounds must lie within ±{MAX_ROOT:e}, the second \
         not below the first"
    )]
    Bounds {
        /// Axis, from 1.
        axis: usize,
        /// The smaller bound, √kg·m.
        low: f64,
        /// The larger bound, √kg·m.
        high: f64,
    },
    /// A variance is negative, NaN or too large.
    #[error("variance of k_{axis} = {value:?} kg·m²: it must lie in [0, 1e149]")]
    Variance {
        /// Axis, from 1.
        axis: usize,
        /// The variance, kg·m².
        value: f64,
    },
}

/// Independent roots k_k = √K_k, each uniform between two bounds.
///
/// # Definition
/// k_k uniform on [a_k, b_k]; with middle c and half width h, E K = c² + h²/3 and
/// Var K = 4c²h²/3 + 4h⁴/45. An interval that holds zero gives roots of either sign, whose squares do
/// not care.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Parameters", into = "Parameters")
)]
pub struct UniformRoots {
    bounds: [[f64; 2]; 3],
}

impl UniformRoots {
    /// Roots between bounds [low, high], √kg·m; equal ones keep a root fixed.
    ///
    /// # Errors
    /// A bound is NaN or beyond 1e75 √kg·m, or the second is below the first.
    pub fn new(bounds: [[f64; 2]; 3]) -> Result<Self, UniformRootsError> {
        for (i, [low, high]) in bounds.into_iter().enumerate() {
            if !(-MAX_ROOT <= low && low <= high && high <= MAX_ROOT) {
                return Err(UniformRootsError::Bounds { axis: i + 1, low, high });
            }
        }
        Ok(Self { bounds })
    }

    /// Roots of the given mean, √kg·m, and variances, kg·m²: k̄ ± √3 σ.
    ///
    /// # Errors
    /// A variance is negative, NaN or too large, or a bound is beyond 1e75 √kg·m.
    pub fn from_variances(
        mean: RootSecondMoments,
        variances: [f64; 3],
    ) -> Result<Self, UniformRootsError> {
        if let Some(i) = variances.iter().position(|v| !(0.0..=1e149).contains(v)) {
            return Err(UniformRootsError::Variance { axis: i + 1, value: variances[i] });
        }
        let mean = mean.values();
        Self::new(std::array::from_fn(|i| {
            let half = (3.0 * variances[i]).sqrt();
            [mean[i] - half, mean[i] + half]
        }))
    }

    /// The bounds, √kg·m.
    #[must_use]
    pub fn bounds(&self) -> [[f64; 2]; 3] {
        self.bounds
    }
}

impl RootMoments for UniformRoots {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        let parts = self.bounds.map(|[a, b]| (0.5 * (a + b), 0.5 * (b - a)));
        SecondMomentStatistics::independent(
            parts.map(|(c, h)| c * c + h * h / 3.0),
            parts.map(|(c, h)| 4.0 * h * h * (c * c / 3.0 + h * h / 45.0)),
        )
    }
}

impl Distribution<RootSecondMoments> for UniformRoots {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> RootSecondMoments {
        loop {
            let draw = self.bounds.map(|[a, b]| {
                let u: f64 = rng.random();
                (a + u * (b - a)).clamp(a, b)
            });
            // Never refused: bounds are in range.
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
    bounds_sqrt_kg_m: [[f64; 2]; 3],
}

#[cfg(feature = "serde")]
impl TryFrom<Parameters> for UniformRoots {
    type Error = UniformRootsError;

    fn try_from(p: Parameters) -> Result<Self, Self::Error> {
        Self::new(p.bounds_sqrt_kg_m)
    }
}

#[cfg(feature = "serde")]
impl From<UniformRoots> for Parameters {
    fn from(law: UniformRoots) -> Self {
        Self { bounds_sqrt_kg_m: law.bounds }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::root_moments::tests::check_moments;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    #[test]
    fn squares_have_their_moments() {
        check_moments(&UniformRoots::new([[3.0, 4.0], [-1.0, 2.0], [-2.0, -2.0]]).unwrap(), 17);
        let mean = RootSecondMoments::new([30.0, 20.0, 0.5]).unwrap();
        check_moments(&UniformRoots::from_variances(mean, [1.0, 0.2, 3.0]).unwrap(), 18);
    }

    /// Kolmogorov and Smirnov's distance from the straight line, below the 1e-4 point.
    #[test]
    fn roots_fill_their_intervals_evenly() {
        const N: usize = 50_000;
        let law = UniformRoots::new([[3.0, 4.0], [-1.0, 2.0], [0.0, 1e70]]).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(19);
        let draws: Vec<[f64; 3]> = (0..N).map(|_| law.sample(&mut rng).values()).collect();
        for i in 0..3 {
            let [a, b] = law.bounds()[i];
            let mut shares: Vec<f64> = draws.iter().map(|k| (k[i] - a) / (b - a)).collect();
            shares.sort_by(f64::total_cmp);
            let gap = shares
                .iter()
                .enumerate()
                .fold(0.0, |gap: f64, (j, u)| gap.max((u - (j as f64 + 0.5) / N as f64).abs()));
            assert!(gap * (N as f64).sqrt() < 2.23, "{i}: {gap}");
        }
    }

    #[test]
    fn bad_parameters_are_named() {
        for bad in [[2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::INFINITY], [-1e80, 0.0]] {
            let error = UniformRoots::new([[0.0, 1.0], bad, [0.0, 1.0]]).unwrap_err();
            assert!(error.to_string().contains("k_2"), "{error}");
        }
        let mean = RootSecondMoments::new([1.0; 3]).unwrap();
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            let error = UniformRoots::from_variances(mean, [0.1, 0.1, bad]).unwrap_err();
            assert!(error.to_string().contains("k_3"), "{error}");
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let law = UniformRoots::new([[3.0, 4.0], [-1.0, 2.0], [-2.0, -2.0]]).unwrap();
        let json = serde_json::to_string(&law).unwrap();
        assert_eq!(serde_json::from_str::<UniformRoots>(&json).unwrap(), law);
        assert!(serde_json::from_str::<UniformRoots>(&json.replace("4.0", "2.0")).is_err());
    }
}
