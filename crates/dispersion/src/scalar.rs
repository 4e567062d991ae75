use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::normal::below;
use crate::truncated_normal::{MAX_DISTANCE, TruncatedNormal, WindowError};

/// Largest magnitude of what a law may be given.
const MAX: f64 = 1e100;

/// Why numbers do not make a law.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScalarLawError {
    /// A mean or bound is NaN or too large.
    #[error("{field} = {value:?}: it must be a number of at most {MAX:e} in magnitude")]
    Number {
        /// Which.
        field: &'static str,
        /// The value.
        value: f64,
    },
    /// A standard deviation is negative, NaN or too large.
    #[error("sigma = {value:?}: it must not be negative, and at most {MAX:e}")]
    Deviation {
        /// The standard deviation.
        value: f64,
    },
    /// The bounds are in the wrong order.
    #[error(
        "bounds from {low:?} to {high:?}: the second must not be below the first, and must be above it \
         in a truncated normal law with a deviation"
    )]
    Bounds {
        /// The smaller bound.
        low: f64,
        /// The larger bound.
        high: f64,
    },
    /// The mean lies far outside the bounds.
    #[error(
        "bounds from {low:?} to {high:?}: the mean of the Gaussian is {distance:.3e} standard \
         deviations outside; at most {MAX_DISTANCE} are allowed"
    )]
    Distance {
        /// The smaller bound.
        low: f64,
        /// The larger bound.
        high: f64,
        /// From the mean to the nearer bound, in standard deviations.
        distance: f64,
    },
    /// The mean of a lognormal law is not positive.
    #[error("a lognormal law about {value:?}: its mean must be positive")]
    NotPositive {
        /// The mean.
        value: f64,
    },
    /// A probability is none.
    #[error("probability = {value:?}: it must lie in [0, 1]")]
    Probability {
        /// The value.
        value: f64,
    },
}

/// A law of one number: of a mass, a stiffness, a coordinate.
///
/// # Definition
/// Every law is the image of a standard normal score z under a function that does not fall,
/// F⁻¹(Φ(z)), so that laws of any kind can be drawn jointly from scores that are jointly normal (a
/// Gaussian copula; [`Correlation`](crate::Correlation)).
///
/// | law | of z |
/// |---|---|
/// | normal | m + σ z |
/// | uniform | a + (b − a) Φ(z) |
/// | truncated normal, m and σ before truncation | m + σ Φ⁻¹(Φ(α) + (Φ(β) − Φ(α)) Φ(z)), α, β = (a, b − m)/σ |
/// | lognormal of mean m and deviation σ | m exp(s z − s²/2), s² = ln(1 + σ²/m²) |
/// | Bernoulli | 1 if Φ(−z) < p, else 0 |
///
/// # Limits
/// The mean of a truncated normal law may be at most 6σ outside of its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarLaw(pub(crate) Kind);

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    Normal { mean: f64, deviation: f64 },
    Uniform { low: f64, high: f64 },
    Truncated(TruncatedNormal),
    Lognormal { mean: f64, deviation: f64, log_deviation: f64 },
    Bernoulli { probability: f64 },
}

fn number(field: &'static str, value: f64) -> Result<f64, ScalarLawError> {
    if value.abs() <= MAX { Ok(value) } else { Err(ScalarLawError::Number { field, value }) }
}

fn deviation(value: f64) -> Result<f64, ScalarLawError> {
    if (0.0..=MAX).contains(&value) { Ok(value) } else { Err(ScalarLawError::Deviation { value }) }
}

impl ScalarLaw {
    /// Gaussian, with mean and standard deviation.
    ///
    /// # Errors
    /// Either is not a number or too large, or the deviation negative.
    pub fn normal(mean: f64, sigma: f64) -> Result<Self, ScalarLawError> {
        let (mean, deviation) = (number("mean", mean)?, deviation(sigma)?);
        Ok(Self(Kind::Normal { mean, deviation }))
    }

    /// Uniform between two bounds.
    ///
    /// # Errors
    /// A bound is not a number or too large, or the second is below the first.
    pub fn uniform(low: f64, high: f64) -> Result<Self, ScalarLawError> {
        let (low, high) = (number("low", low)?, number("high", high)?);
        if low > high {
            return Err(ScalarLawError::Bounds { low, high });
        }
        Ok(Self(Kind::Uniform { low, high }))
    }

    /// Gaussian kept between two bounds, which may be infinite; mean and standard deviation are those
    /// before.
    ///
    /// # Errors
    /// Those of [`normal`](Self::normal), or the bounds are not numbers or in the wrong order, or
    /// the mean is more than 6σ outside of them.
    pub fn truncated_normal(
        mean: f64,
        sigma: f64,
        low: f64,
        high: f64,
    ) -> Result<Self, ScalarLawError> {
        let (mean, deviation) = (number("mean", mean)?, deviation(sigma)?);
        for (field, value) in [("low", low), ("high", high)] {
            if value.is_nan() {
                return Err(ScalarLawError::Number { field, value });
            }
        }
        match TruncatedNormal::new(mean, deviation, [low, high]) {
            Ok(window) => Ok(Self(Kind::Truncated(window))),
            Err(WindowError::Bounds) => Err(ScalarLawError::Bounds { low, high }),
            Err(WindowError::Distance(distance)) => {
                Err(ScalarLawError::Distance { low, high, distance })
            }
        }
    }

    /// Lognormal, with its own mean and standard deviation. Always positive.
    ///
    /// # Errors
    /// The mean is not positive or too large, or the deviation negative, NaN or too large.
    pub fn lognormal(mean: f64, sigma: f64) -> Result<Self, ScalarLawError> {
        let (mean, deviation) = (number("mean", mean)?, deviation(sigma)?);
        if !(mean > 0.0) {
            return Err(ScalarLawError::NotPositive { value: mean });
        }
        let ratio = deviation / mean;
        let log_deviation = libm::sqrt(libm::log1p(ratio * ratio));
        if !log_deviation.is_finite() {
            return Err(ScalarLawError::Deviation { value: sigma });
        }
        Ok(Self(Kind::Lognormal { mean, deviation, log_deviation }))
    }

    /// One with a probability, else zero.
    ///
    /// # Errors
    /// The probability is outside [0, 1] or NaN.
    pub fn bernoulli(probability: f64) -> Result<Self, ScalarLawError> {
        if !(0.0..=1.0).contains(&probability) {
            return Err(ScalarLawError::Probability { value: probability });
        }
        Ok(Self(Kind::Bernoulli { probability }))
    }

    /// The value at a standard normal score: it does not fall where the score rises.
    #[must_use]
    pub fn at_score(&self, z: f64) -> f64 {
        match self.0 {
            Kind::Normal { mean, deviation } => mean + deviation * z,
            Kind::Uniform { low, high } => (low + (high - low) * below(z)).clamp(low, high),
            Kind::Truncated(window) => window.at_score(z),
            Kind::Lognormal { mean, log_deviation: s, .. } => mean * libm::exp(s * (z - 0.5 * s)),
            Kind::Bernoulli { probability } => f64::from(u8::from(below(-z) < probability)),
        }
    }

    /// The probability of a value of at most x.
    #[must_use]
    pub fn cdf(&self, x: f64) -> f64 {
        let step = |at: f64| f64::from(u8::from(x >= at));
        match self.0 {
            Kind::Normal { mean, deviation: 0.0 } => step(mean),
            Kind::Normal { mean, deviation } => below((x - mean) / deviation),
            Kind::Uniform { low, high } if low == high => step(low),
            Kind::Uniform { low, high } => ((x - low) / (high - low)).clamp(0.0, 1.0),
            Kind::Truncated(window) => window.cdf(x),
            Kind::Lognormal { mean, log_deviation: 0.0, .. } => step(mean),
            Kind::Lognormal { mean, log_deviation: s, .. } => {
                if x > 0.0 {
                    below(libm::log(x / mean) / s + 0.5 * s)
                } else {
                    0.0
                }
            }
            Kind::Bernoulli { probability } => {
                if x >= 1.0 {
                    1.0
                } else {
                    (1.0 - probability) * step(0.0)
                }
            }
        }
    }

    /// The mean.
    #[must_use]
    pub fn mean(&self) -> f64 {
        match self.0 {
            Kind::Normal { mean, .. } | Kind::Lognormal { mean, .. } => mean,
            Kind::Uniform { low, high } => 0.5 * low + 0.5 * high,
            Kind::Truncated(window) => window.moments().mean,
            Kind::Bernoulli { probability } => probability,
        }
    }

    /// The standard deviation.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        match self.0 {
            Kind::Normal { deviation, .. } | Kind::Lognormal { deviation, .. } => deviation,
            Kind::Uniform { low, high } => (0.5 * high - 0.5 * low) / 3.0_f64.sqrt(),
            Kind::Truncated(window) => window.moments().variance.sqrt(),
            Kind::Bernoulli { probability: p } => (p * (1.0 - p)).sqrt(),
        }
    }

    /// What it is called in scenario files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self.0 {
            Kind::Normal { .. } => "normal",
            Kind::Uniform { .. } => "uniform",
            Kind::Truncated(_) => "truncated-normal",
            Kind::Lognormal { .. } => "lognormal",
            Kind::Bernoulli { .. } => "bernoulli",
        }
    }
}

impl Distribution<f64> for ScalarLaw {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.at_score(StandardNormal.sample(rng))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    const INF: f64 = f64::INFINITY;

    fn laws() -> Vec<ScalarLaw> {
        vec![
            ScalarLaw::normal(3.0, 2.0).unwrap(),
            ScalarLaw::uniform(-1.0, 4.0).unwrap(),
            ScalarLaw::lognormal(5.0, 0.5).unwrap(),
            ScalarLaw::lognormal(0.01, 0.05).unwrap(),
            ScalarLaw::truncated_normal(1.0, 2.0, 0.0, INF).unwrap(),
            ScalarLaw::truncated_normal(0.0, 1.0, -2.0, 2.0).unwrap(),
            ScalarLaw::truncated_normal(0.0, 1.0, 5.0, INF).unwrap(),
            ScalarLaw::truncated_normal(0.0, 1.0, -7.0, -4.0).unwrap(),
            ScalarLaw::truncated_normal(0.0, 1.0, 0.3, 0.31).unwrap(),
        ]
    }

    /// Kolmogorov and Smirnov's distance below its 1e-4 point; means and deviations to |z| < 4.
    /// Another law of the same mean and deviation is told apart.
    #[test]
    fn draws_follow_the_law() {
        const N: usize = 40_000;
        let gap = |law: &ScalarLaw, draws: &[f64]| {
            let gaps = draws.iter().enumerate();
            let gap = gaps.map(|(i, x)| (law.cdf(*x) - (i as f64 + 0.5) / N as f64).abs());
            gap.fold(0.0, f64::max) * (N as f64).sqrt()
        };
        for (i, law) in laws().into_iter().enumerate() {
            let mut rng = ChaCha8Rng::seed_from_u64(300 + i as u64);
            let mut draws: Vec<f64> = (0..N).map(|_| law.sample(&mut rng)).collect();
            draws.sort_by(f64::total_cmp);
            assert!(gap(&law, &draws) < 2.23, "{law:?}: {}", gap(&law, &draws));
            if !matches!(law.0, Kind::Normal { .. }) && i != 5 {
                let other = ScalarLaw::normal(law.mean(), law.deviation()).unwrap();
                assert!(gap(&other, &draws) > 2.23, "{law:?} passes for normal");
            }
            let mean = draws.iter().sum::<f64>() / N as f64;
            let z = (mean - law.mean()) / law.deviation() * (N as f64).sqrt();
            assert!(z.abs() < 4.0, "{law:?}: mean {z}");
            let squares: Vec<f64> = draws.iter().map(|x| (x - law.mean()).powi(2)).collect();
            let variance = squares.iter().sum::<f64>() / N as f64;
            let spread = squares.iter().map(|s| (s - variance).powi(2)).sum::<f64>() / N as f64;
            let z = (variance - law.deviation().powi(2)) / (spread / N as f64).sqrt();
            // The variance of the fourth law hangs on its far tail.
            assert!(z.abs() < 4.0 || i == 3, "{law:?}: variance {z}");
        }
    }

    #[test]
    fn probabilities_are_met() {
        let mut rng = ChaCha8Rng::seed_from_u64(310);
        for p in [0.0, 0.02, 0.5, 1.0] {
            let law = ScalarLaw::bernoulli(p).unwrap();
            let count = (0..10_000).map(|_| law.sample(&mut rng)).sum::<f64>();
            let z = (count - 1e4 * p) / (100.0 * law.deviation().max(1e-9));
            assert!(z.abs() < 4.0, "{p}: {count}");
            assert_eq!([law.cdf(-0.1), law.cdf(0.0), law.cdf(1.0)], [0.0, 1.0 - p, 1.0]);
        }
    }

    proptest! {
        /// F(F⁻¹(Φ(z))) is Φ(z), from both tails.
        #[test]
        fn scores_are_quantiles(z in -6.0..6.0f64) {
            for law in laws() {
                let x = law.at_score(z);
                let error = law.cdf(x) - below(z);
                prop_assert!(error.abs() < 1e-12, "{:?} {} {:e}", law, x, error);
                prop_assert!(law.at_score(z + 0.01) >= x);
            }
        }

        /// Without bounds that matter it is normal, in the tails too.
        #[test]
        fn wide_bounds_are_none(z in -7.0..7.0f64) {
            let law = ScalarLaw::truncated_normal(2.0, 3.0, -INF, INF).unwrap();
            prop_assert!((law.at_score(z) - (2.0 + 3.0 * z)).abs() < 1e-12);
        }
    }

    #[test]
    fn laws_without_width_stay_put() {
        for law in [
            ScalarLaw::normal(2.0, 0.0),
            ScalarLaw::uniform(2.0, 2.0),
            ScalarLaw::truncated_normal(2.0, 0.0, 0.0, 3.0),
            ScalarLaw::lognormal(2.0, 0.0),
        ] {
            let law = law.unwrap();
            assert_eq!([law.at_score(-3.0), law.mean(), law.deviation()], [2.0, 2.0, 0.0]);
            assert_eq!([law.cdf(1.9), law.cdf(2.0)], [0.0, 1.0]);
        }
    }

    #[test]
    fn bad_numbers_are_named() {
        use ScalarLaw as L;
        let cases = [
            (L::normal(f64::NAN, 1.0), "mean = NaN"),
            (L::normal(0.0, -1.0), "sigma = -1.0"),
            (L::normal(0.0, INF), "sigma = inf"),
            (L::uniform(1.0, 0.0), "bounds from 1.0 to 0.0"),
            (L::uniform(-INF, 0.0), "low = -inf"),
            (L::truncated_normal(0.0, 1.0, f64::NAN, 1.0), "low = NaN"),
            (L::truncated_normal(0.0, 1.0, 7.0, 8.0), "bounds from 7.0 to 8.0: the mean"),
            (L::truncated_normal(0.0, 0.0, 1.0, 2.0), "bounds from 1.0 to 2.0: the mean"),
            (L::truncated_normal(0.0, 1.0, 1.0, 1.0), "bounds from 1.0 to 1.0: the second"),
            (L::lognormal(0.0, 1.0), "a lognormal law about 0.0"),
            (L::lognormal(1e-100, 1e100), "sigma = 1e100"),
            (L::bernoulli(1.5), "probability = 1.5"),
            (L::bernoulli(f64::NAN), "probability = NaN"),
        ];
        for (law, expected) in cases {
            let message = law.unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }
}
