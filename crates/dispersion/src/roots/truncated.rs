use gyradius_inertia::RootSecondMoments;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use super::{FAR, MAX_ROOT};
use crate::truncated_normal::{MAX_DISTANCE, TruncatedNormal, WindowError, WindowMoments};
use crate::{RootMoments, SecondMomentStatistics};

/// Why a mean, a variance and bounds are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TruncatedRootsError {
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
    /// A bound is NaN, or the second is not above the first.
    #[error(
        "k_{axis} from {low:?} to {high:?} √kg·m: bounds must be numbers, the second above the first, \
         or equal to it where the variance is zero; infinite ones are allowed"
    )]
    Bounds {
        /// Axis, from 1.
        axis: usize,
        /// The smaller bound, √kg·m.
        low: f64,
        /// The larger bound, √kg·m.
        high: f64,
    },
    /// The mean lies far outside the bounds.
    #[error(
        "k_{axis} from {low:?} to {high:?} √kg·m: the mean of the Gaussian is {distance:.3e} standard \
         deviations outside; at most {MAX_DISTANCE} are allowed"
    )]
    Distance {
        /// Axis, from 1.
        axis: usize,
        /// The smaller bound, √kg·m.
        low: f64,
        /// The larger bound, √kg·m.
        high: f64,
        /// From the mean to the nearer bound, in standard deviations.
        distance: f64,
    },
}

/// Independent Gaussian roots k_k = √K_k, each kept between two bounds.
///
/// # Definition
/// The density of N(k̄_k, σ_k²) on [a_k, b_k] over its share of it. k̄ and σ² are those of the Gaussian
/// *before* it is truncated.
///
/// # Algorithm
/// Draws by rejection, from the Gaussian where the bounds hold a quarter of it, else from the uniform law
/// on the interval or from an exponential at its near end (Robert 1995, doi:10.1007/BF00143942).
/// Mean and variance of K by Gauss and Legendre's rule, to 1e-12 for an interval of any length.
///
/// # Limits
/// The mean may be at most 6σ outside of the bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Parameters", into = "Parameters")
)]
pub struct TruncatedRoots {
    mean: RootSecondMoments,
    variances: [f64; 3],
    bounds: [[f64; 2]; 3],
    axes: [Truncated; 3],
}

/// One root, and how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Truncated {
    window: TruncatedNormal,
    proposal: Proposal,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Proposal {
    Fixed,
    Gaussian,
    Uniform,
    /// From the end nearer to the mean.
    Exponential {
        rate: f64,
    },
}

impl TruncatedRoots {
    /// Mean k̄ in √kg·m and variances in kg·m² of the Gaussians, and bounds [low, high] in √kg·m, which
    /// may be infinite and are then kept as ±1e75. A variance of zero keeps a root at its mean, which
    /// must lie within the bounds.
    ///
    /// # Errors
    /// A variance is negative or NaN, roots could come out beyond 1e75 √kg·m, a bound is NaN, the
    /// second is not above the first, or the mean is more than 6σ outside of them.
    pub fn new(
        mean: RootSecondMoments,
        variances: [f64; 3],
        bounds: [[f64; 2]; 3],
    ) -> Result<Self, TruncatedRootsError> {
        let k = mean.values();
        for (i, value) in variances.into_iter().enumerate() {
            if !(value >= 0.0 && k[i].abs() + FAR * value.sqrt() <= MAX_ROOT) {
                return Err(TruncatedRootsError::Variance { axis: i + 1, value });
            }
        }
        let given = bounds;
        let bounds = bounds.map(|b| b.map(|x| x.clamp(-MAX_ROOT, MAX_ROOT)));
        let window = |i: usize| {
            TruncatedNormal::new(k[i], variances[i].sqrt(), bounds[i]).map_err(|error| {
                let (axis, [low, high]) = (i + 1, given[i]);
                match error {
                    WindowError::Bounds => TruncatedRootsError::Bounds { axis, low, high },
                    WindowError::Distance(distance) => {
                        TruncatedRootsError::Distance { axis, low, high, distance }
                    }
                }
            })
        };
        let axes = [window(0)?, window(1)?, window(2)?].map(Truncated::new);
        Ok(Self { mean, variances, bounds, axes })
    }

    /// Means of the Gaussians before truncation, √kg·m.
    #[must_use]
    pub fn mean(&self) -> RootSecondMoments {
        self.mean
    }

    /// Variances of the Gaussians before truncation, kg·m².
    #[must_use]
    pub fn variances(&self) -> [f64; 3] {
        self.variances
    }

    /// The bounds, √kg·m.
    #[must_use]
    pub fn bounds(&self) -> [[f64; 2]; 3] {
        self.bounds
    }

    /// The shares of the Gaussians that lie within the bounds.
    #[must_use]
    pub fn shares(&self) -> [f64; 3] {
        self.axes.map(|axis| axis.window.share())
    }
}

impl Truncated {
    fn new(window: TruncatedNormal) -> Self {
        let (near, [from, to]) = (window.offset(), window.ends());
        let rate = 0.5 * (near + (near * near + 4.0).sqrt());
        let proposal = if window.deviation() == 0.0 {
            Proposal::Fixed
        } else if window.share() >= 0.25 {
            Proposal::Gaussian
        } else if near > 0.0 && (to - from) * rate > 2.0 {
            Proposal::Exponential { rate }
        } else {
            Proposal::Uniform
        };
        Self { window, proposal }
    }

    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        let (near, [from, to]) = (self.window.offset(), self.window.ends());
        loop {
            let (v, ln_accept) = match self.proposal {
                Proposal::Fixed => return self.window.value(0.0),
                Proposal::Gaussian => {
                    let t: f64 = StandardNormal.sample(rng);
                    (self.window.sign() * t - near, 0.0)
                }
                Proposal::Uniform => {
                    let v = from + rng.random::<f64>() * (to - from);
                    (v, self.window.ln_density(v))
                }
                Proposal::Exponential { rate } => {
                    let v = -libm::log1p(-rng.random::<f64>()) / rate;
                    (v, -0.5 * (near + v - rate) * (near + v - rate))
                }
            };
            let inside = from <= v && v <= to;
            if inside && (ln_accept == 0.0 || rng.random::<f64>() < libm::exp(ln_accept)) {
                return self.window.value(v);
            }
        }
    }
}

impl RootMoments for TruncatedRoots {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        let moments: [WindowMoments; 3] = self.axes.map(|axis| axis.window.moments());
        SecondMomentStatistics::independent(
            moments.map(|m| m.square_mean),
            moments.map(|m| m.square_variance),
        )
    }
}

impl Distribution<RootSecondMoments> for TruncatedRoots {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> RootSecondMoments {
        loop {
            let draw = std::array::from_fn(|i| self.axes[i].sample(rng));
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
    bounds_sqrt_kg_m: [[f64; 2]; 3],
}

#[cfg(feature = "serde")]
impl TryFrom<Parameters> for TruncatedRoots {
    type Error = TruncatedRootsError;

    fn try_from(p: Parameters) -> Result<Self, Self::Error> {
        Self::new(p.mean_sqrt_kg_m, p.variance_kg_m2, p.bounds_sqrt_kg_m)
    }
}

#[cfg(feature = "serde")]
impl From<TruncatedRoots> for Parameters {
    fn from(law: TruncatedRoots) -> Self {
        Self {
            mean_sqrt_kg_m: law.mean,
            variance_kg_m2: law.variances,
            bounds_sqrt_kg_m: law.bounds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::root_moments::tests::check_moments;
    use crate::truncated_normal::share;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    const INF: f64 = f64::INFINITY;

    fn law(
        mean: [f64; 3],
        variances: [f64; 3],
        bounds: [[f64; 2]; 3],
    ) -> Result<TruncatedRoots, TruncatedRootsError> {
        TruncatedRoots::new(RootSecondMoments::new(mean).unwrap(), variances, bounds)
    }

    /// All four proposals, on either side.
    #[test]
    fn squares_have_their_moments() {
        let wide = law([30.0, 1.0, 0.0], [9.0, 4.0, 2.0], [[27.0, 33.0], [0.0, INF], [-INF, 1.0]]);
        check_moments(&wide.unwrap(), 31);
        let tails = law([0.0, 1.0, 0.0], [1.0; 3], [[3.0, INF], [-INF, -2.5], [4.0, 4.2]]).unwrap();
        assert!(matches!(tails.axes[0].proposal, Proposal::Exponential { .. }));
        assert!(matches!(tails.axes[1].proposal, Proposal::Exponential { .. }));
        assert!(matches!(tails.axes[2].proposal, Proposal::Uniform));
        check_moments(&tails, 32);
        let narrow = law([2.0, 5.0, 1.0], [1.0, 0.0, 4.0], [[1.9, 2.3], [4.0, 6.0], [-0.5, 0.2]]);
        check_moments(&narrow.unwrap(), 33);
    }

    /// Kolmogorov and Smirnov's distance from the distribution function, below the 1e-4 point.
    #[test]
    fn roots_have_the_distribution() {
        const N: usize = 50_000;
        for (low, high) in [(-1.0, 2.0), (1.5, INF), (-6.0, -2.0), (0.1, 0.4), (2.0, 2.1)] {
            let law = law([0.0; 3], [1.0; 3], [[low, high]; 3]).unwrap();
            let mut rng = ChaCha8Rng::seed_from_u64(34);
            let mut draws: Vec<f64> = (0..N).map(|_| law.sample(&mut rng).values()[0]).collect();
            draws.sort_by(f64::total_cmp);
            let total = share(low, high);
            let gap = draws.iter().enumerate().fold(0.0, |gap: f64, (j, t)| {
                gap.max((share(low, *t) / total - (j as f64 + 0.5) / N as f64).abs())
            });
            assert!(gap * (N as f64).sqrt() < 2.23, "{low} {high}: {gap}");
        }
    }

    #[test]
    fn without_bounds_it_is_gaussian() {
        let (mean, variances) = ([3.0, 1.0, 0.0], [0.1, 4.0, 2.0]);
        let law = law(mean, variances, [[-INF, INF]; 3]).unwrap();
        let plain =
            crate::GaussianRoots::new(RootSecondMoments::new(mean).unwrap(), variances).unwrap();
        let (a, b) = (law.second_moment_statistics(), plain.second_moment_statistics());
        for i in 0..3 {
            assert!((a.mean()[i] / b.mean()[i] - 1.0).abs() < 1e-14);
            assert!((a.variances()[i] / b.variances()[i] - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn bad_parameters_are_named() {
        let with = |mean: f64, variance: f64, bounds: [f64; 2]| {
            law([1.0, mean, 1.0], [0.1, variance, 0.1], [[0.0, 2.0], bounds, [0.0, 2.0]])
                .unwrap_err()
                .to_string()
        };
        for message in [
            with(1.0, -1.0, [0.0, 2.0]),
            with(1.0, f64::NAN, [0.0, 2.0]),
            with(1.0, 0.1, [2.0, 0.0]),
            with(1.0, 0.1, [f64::NAN, 2.0]),
            with(1.0, 0.0, [2.0, 3.0]),
        ] {
            assert!(message.contains("k_2"), "{message}");
        }
        assert!(with(1.0, 0.01, [5.0, 6.0]).contains("4.000e1 standard deviations outside"));
        assert!(with(1.0, 0.1, [1.0, 1.0]).contains("the second above the first"));
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let law = law([1.0, 2.0, 3.0], [0.1, 0.2, 0.3], [[0.0, INF]; 3]).unwrap();
        let json = serde_json::to_string(&law).unwrap();
        assert_eq!(serde_json::from_str::<TruncatedRoots>(&json).unwrap(), law);
        assert!(serde_json::from_str::<TruncatedRoots>(&json.replace("0.2", "-0.2")).is_err());
    }
}
