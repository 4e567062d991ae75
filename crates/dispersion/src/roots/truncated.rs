use gyradius_inertia::RootSecondMoments;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

use super::{FAR, MAX_ROOT};
use crate::{RootMoments, SecondMomentStatistics};

/// Least share of the Gaussian that an interval must hold.
const MIN_SHARE: f64 = 1e-9;

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
        "k_{axis} from {low:?} to {high:?} √kg·m: bounds must be numbers, the second not below the \
         first; infinite ones are allowed"
    )]
    Bounds {
        /// Axis, from 1.
        axis: usize,
        /// The smaller bound, √kg·m.
        low: f64,
        /// The larger bound, √kg·m.
        high: f64,
    },
    /// Next to nothing of the Gaussian lies between the bounds.
    #[error(
        "k_{axis} from {low:?} to {high:?} √kg·m holds a share {share:.1e} of the Gaussian: it must \
         hold at least {MIN_SHARE:e}"
    )]
    Share {
        /// Axis, from 1.
        axis: usize,
        /// The smaller bound, √kg·m.
        low: f64,
        /// The larger bound, √kg·m.
        high: f64,
        /// Φ((b − k̄)/σ) − Φ((a − k̄)/σ).
        share: f64,
    },
}

/// Independent Gaussian roots k_k = √K_k, each kept between two bounds.
///
/// # Definition
/// The density of N(k̄_k, σ_k²) on [a_k, b_k] over its share of it. k̄ and σ² are those of the Gaussian
/// *before* it is truncated. With α = (a − k̄)/σ, β = (b − k̄)/σ and Z that share, t = (k − k̄)/σ has the
/// moments m₀ = 1, m₁ = (φ(α) − φ(β))/Z, mₙ = (n − 1)mₙ₋₂ + (αⁿ⁻¹φ(α) − βⁿ⁻¹φ(β))/Z, and
/// E K = k̄² + 2k̄σm₁ + σ²m₂, Var K = 4k̄²σ² Var t + 4k̄σ³ Cov(t, t²) + σ⁴ Var t².
///
/// # Algorithm
/// Rejection, from the Gaussian where the bounds hold a quarter of it, else from the uniform law on
/// the interval or from an exponential at its near end (Robert 1995, doi:10.1007/BF00143942).
///
/// # Limits
/// Bounds that hold less than 1e-9 of the Gaussian are refused. Var K loses digits where the interval
/// is much shorter than σ: 16 less two for every factor of ten.
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

/// A standard normal kept to [α, β].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Truncated {
    deviation: f64,
    alpha: f64,
    beta: f64,
    share: f64,
    proposal: Proposal,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Proposal {
    Fixed,
    Gaussian,
    Uniform,
    /// From the end nearer to zero, which is `sign` times a positive number.
    Exponential {
        sign: f64,
        near: f64,
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
    /// second is below the first, or they hold less than 1e-9 of the Gaussian.
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
        if let Some(i) = bounds.iter().position(|[low, high]| !(low <= high)) {
            let [low, high] = bounds[i];
            return Err(TruncatedRootsError::Bounds { axis: i + 1, low, high });
        }
        let bounds = bounds.map(|b| b.map(|x| x.clamp(-MAX_ROOT, MAX_ROOT)));
        let axes = std::array::from_fn(|i| Truncated::new(k[i], variances[i].sqrt(), bounds[i]));
        match axes.iter().position(|axis| !(axis.share >= MIN_SHARE)) {
            Some(i) => {
                let ([low, high], share) = (bounds[i], axes[i].share);
                Err(TruncatedRootsError::Share { axis: i + 1, low, high, share })
            }
            None => Ok(Self { mean, variances, bounds, axes }),
        }
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
        self.axes.map(|axis| axis.share)
    }
}

impl Truncated {
    fn new(mean: f64, deviation: f64, [low, high]: [f64; 2]) -> Self {
        if deviation == 0.0 {
            let share = if low <= mean && mean <= high { 1.0 } else { 0.0 };
            let proposal = Proposal::Fixed;
            return Self { deviation, alpha: 0.0, beta: 0.0, share, proposal };
        }
        let (alpha, beta) = ((low - mean) / deviation, (high - mean) / deviation);
        let share = share(alpha, beta);
        // Mirrored where the interval lies below zero.
        let (sign, near) = if beta < 0.0 { (-1.0, -beta) } else { (1.0, alpha) };
        let rate = 0.5 * (near + (near * near + 4.0).sqrt());
        let proposal = if share >= 0.25 {
            Proposal::Gaussian
        } else if near > 0.0 && (beta - alpha) * rate > 2.0 {
            Proposal::Exponential { sign, near, rate }
        } else {
            Proposal::Uniform
        };
        Self { deviation, alpha, beta, share, proposal }
    }

    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        let inside = |t: f64| self.alpha <= t && t <= self.beta;
        let nearest = if inside(0.0) { 0.0 } else { self.alpha.abs().min(self.beta.abs()) };
        loop {
            let (t, ln_accept) = match self.proposal {
                Proposal::Fixed => return 0.0,
                Proposal::Gaussian => (StandardNormal.sample(rng), 0.0),
                Proposal::Uniform => {
                    let t = self.alpha + rng.random::<f64>() * (self.beta - self.alpha);
                    (t, 0.5 * (nearest - t) * (nearest + t))
                }
                Proposal::Exponential { sign, near, rate } => {
                    let t = near - libm::log1p(-rng.random::<f64>()) / rate;
                    (sign * t, -0.5 * (t - rate) * (t - rate))
                }
            };
            if inside(t) && (ln_accept == 0.0 || rng.random::<f64>() < libm::exp(ln_accept)) {
                return t;
            }
        }
    }

    /// E t, …, E t⁴.
    fn moments(&self) -> [f64; 4] {
        if self.deviation == 0.0 {
            return [0.0; 4];
        }
        let edge = |t: f64, power: i32| {
            if t.abs() > FAR {
                return 0.0;
            }
            t.powi(power) * libm::exp(-0.5 * t * t) / (2.0 * PI).sqrt()
        };
        let edges = |n| (edge(self.alpha, n) - edge(self.beta, n)) / self.share;
        let m1 = edges(0);
        let m2 = 1.0 + edges(1);
        [m1, m2, 2.0 * m1 + edges(2), 3.0 * m2 + edges(3)]
    }
}

/// Φ(β) − Φ(α), without cancellation in the tails.
pub(crate) fn share(alpha: f64, beta: f64) -> f64 {
    let tail = |t: f64| 0.5 * libm::erfc(t * FRAC_1_SQRT_2);
    if alpha > 0.0 {
        tail(alpha) - tail(beta)
    } else if beta < 0.0 {
        tail(-beta) - tail(-alpha)
    } else {
        0.5 * (libm::erf(beta * FRAC_1_SQRT_2) - libm::erf(alpha * FRAC_1_SQRT_2))
    }
}

impl RootMoments for TruncatedRoots {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        let k = self.mean.values();
        let of = |i: usize| {
            let (k, s, [m1, m2, m3, m4]) = (k[i], self.axes[i].deviation, self.axes[i].moments());
            let mean = k * k + 2.0 * k * s * m1 + s * s * m2;
            let (linear, mixed, square) = (m2 - m1 * m1, m3 - m1 * m2, m4 - m2 * m2);
            let variance = s * s * (4.0 * k * (k * linear + s * mixed) + s * s * square);
            // Rounding may leave them a hair below zero.
            (mean.max(0.0), variance.max(0.0))
        };
        SecondMomentStatistics::independent(
            std::array::from_fn(|i| of(i).0),
            std::array::from_fn(|i| of(i).1),
        )
    }
}

impl Distribution<RootSecondMoments> for TruncatedRoots {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> RootSecondMoments {
        let mean = self.mean.values();
        loop {
            let draw = std::array::from_fn(|i| {
                let axis = &self.axes[i];
                let [low, high] = self.bounds[i];
                (mean[i] + axis.deviation * axis.sample(rng)).clamp(low, high)
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
        assert!(matches!(tails.axes[0].proposal, Proposal::Exponential { sign: 1.0, .. }));
        assert!(matches!(tails.axes[1].proposal, Proposal::Exponential { sign: -1.0, .. }));
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
        assert!(with(1.0, 0.01, [5.0, 6.0]).contains("share"));
        assert!(with(1.0, 0.1, [1.0, 1.0]).contains("share"));
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
