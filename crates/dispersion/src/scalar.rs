//! Laws of one number.

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use crate::normal::below;
use crate::truncated_draw::Truncated;
use crate::truncated_normal::{MAX_DISTANCE, WindowError};

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
    /// A variance is not the square of the standard deviation.
    #[error("variance = {value:?}: it must be the square of sigma, which is {sigma:?}")]
    Variance {
        /// The variance.
        value: f64,
        /// The standard deviation.
        sigma: f64,
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
/// [`sample`](Distribution::sample) draws a score. [`ScalarRoots`](crate::ScalarRoots) draw the same laws in quicker
/// ways, which give other values.
///
/// # Limits
/// The mean of a truncated normal law may be at most 6σ outside of its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Parameters", into = "Parameters")
)]
pub struct ScalarLaw(pub(crate) Kind);

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    Normal { mean: f64, deviation: f64, variance: f64 },
    Uniform { low: f64, high: f64 },
    Truncated(Truncated),
    Lognormal { mean: f64, deviation: f64, variance: f64, log_median: f64, log_deviation: f64 },
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
        Self::normal_of(mean, sigma, sigma * sigma)
    }

    /// The same with the variance, which would lose its last digit as a root.
    pub(crate) fn normal_of(mean: f64, sigma: f64, variance: f64) -> Result<Self, ScalarLawError> {
        let (mean, deviation) = (number("mean", mean)?, deviation(sigma)?);
        Ok(Self(Kind::Normal { mean, deviation, variance }))
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
        match Truncated::new(mean, deviation, [low, high]) {
            Ok(law) => Ok(Self(Kind::Truncated(law))),
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
        Self::lognormal_of(mean, sigma, sigma * sigma)
    }

    /// The same with the variance, which would lose its last digit as a root.
    pub(crate) fn lognormal_of(
        mean: f64,
        sigma: f64,
        variance: f64,
    ) -> Result<Self, ScalarLawError> {
        let (mean, deviation) = (number("mean", mean)?, deviation(sigma)?);
        if !(mean > 0.0) {
            return Err(ScalarLawError::NotPositive { value: mean });
        }
        let ratio = deviation / mean;
        let square = libm::log1p(ratio * ratio);
        if !square.is_finite() {
            return Err(ScalarLawError::Deviation { value: sigma });
        }
        Ok(Self(Kind::Lognormal {
            mean,
            deviation,
            variance,
            log_median: libm::log(mean) - 0.5 * square,
            log_deviation: square.sqrt(),
        }))
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
            Kind::Normal { mean, deviation, .. } => mean + deviation * z,
            Kind::Uniform { low, high } => (low + (high - low) * below(z)).clamp(low, high),
            Kind::Truncated(law) => law.window.at_score(z),
            Kind::Lognormal { mean, log_deviation: s, .. } => mean * libm::exp(s * (z - 0.5 * s)),
            Kind::Bernoulli { probability } => f64::from(u8::from(below(-z) < probability)),
        }
    }

    /// The probability of a value of at most x.
    #[must_use]
    pub fn cdf(&self, x: f64) -> f64 {
        let step = |at: f64| f64::from(u8::from(x >= at));
        match self.0 {
            Kind::Normal { mean, deviation: 0.0, .. } => step(mean),
            Kind::Normal { mean, deviation, .. } => below((x - mean) / deviation),
            Kind::Uniform { low, high } if low == high => step(low),
            Kind::Uniform { low, high } => ((x - low) / (high - low)).clamp(0.0, 1.0),
            Kind::Truncated(law) => law.window.cdf(x),
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
            Kind::Truncated(law) => law.window.moments().mean,
            Kind::Bernoulli { probability } => probability,
        }
    }

    /// The standard deviation.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        match self.0 {
            Kind::Normal { deviation, .. } | Kind::Lognormal { deviation, .. } => deviation,
            Kind::Uniform { low, high } => (0.5 * high - 0.5 * low) / 3.0_f64.sqrt(),
            Kind::Truncated(law) => law.window.moments().variance.sqrt(),
            Kind::Bernoulli { probability: p } => (p * (1.0 - p)).sqrt(),
        }
    }

    /// Mean and variance, if it is normal.
    #[must_use]
    pub fn as_normal(&self) -> Option<[f64; 2]> {
        match self.0 {
            Kind::Normal { mean, variance, .. } => Some([mean, variance]),
            Kind::Uniform { .. }
            | Kind::Truncated(_)
            | Kind::Lognormal { .. }
            | Kind::Bernoulli { .. } => None,
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

/// What a law of roots needs.
impl ScalarLaw {
    /// A draw in the quickest way. A law without width draws nothing where it is lognormal or truncated.
    #[inline]
    pub(crate) fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        let mut score = || -> f64 { StandardNormal.sample(rng) };
        match self.0 {
            Kind::Normal { .. } | Kind::Bernoulli { .. } => self.at_score(score()),
            Kind::Uniform { low, high } => {
                let u: f64 = rng.random();
                (low + u * (high - low)).clamp(low, high)
            }
            Kind::Truncated(law) => law.sample(rng),
            Kind::Lognormal { mean, log_deviation: 0.0, .. } => mean,
            Kind::Lognormal { log_median, log_deviation, .. } => {
                libm::exp(log_median + log_deviation * score())
            }
        }
    }

    /// Mean and variance of the square.
    pub(crate) fn square_moments(&self) -> (f64, f64) {
        match self.0 {
            Kind::Normal { mean: m, variance: v, .. } => (m * m + v, 2.0 * v * (2.0 * m * m + v)),
            Kind::Uniform { low, high } => {
                let (c, h) = (0.5 * (low + high), 0.5 * (high - low));
                (c * c + h * h / 3.0, 4.0 * h * h * (c * c / 3.0 + h * h / 45.0))
            }
            Kind::Truncated(law) => {
                let moments = law.window.moments();
                (moments.square_mean, moments.square_variance)
            }
            // Lognormal too, of twice the deviation of the logarithm.
            Kind::Lognormal { mean, variance, log_deviation: s, .. } => {
                let square = mean * mean + variance;
                (square, square * square * libm::expm1(4.0 * s * s))
            }
            Kind::Bernoulli { probability: p } => (p, p * (1.0 - p)),
        }
    }

    /// What no draw exceeds in magnitude, `far` standard deviations of what is normal in it taken for all.
    pub(crate) fn reach(&self, far: f64) -> f64 {
        match self.0 {
            Kind::Normal { mean, deviation, .. } => mean.abs() + far * deviation,
            Kind::Uniform { low, high } => low.abs().max(high.abs()),
            Kind::Truncated(law) => law.mean.abs() + far * law.window.deviation(),
            Kind::Lognormal { log_median, log_deviation, .. } => {
                libm::exp(log_median + far * log_deviation)
            }
            Kind::Bernoulli { .. } => 1.0,
        }
    }
}

impl Distribution<f64> for ScalarLaw {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.at_score(StandardNormal.sample(rng))
    }
}

/// The variance where the square of the standard deviation has other bits.
#[cfg(feature = "serde")]
fn more(sigma: f64, variance: f64) -> Option<f64> {
    (sigma * sigma != variance).then_some(variance)
}

/// The variance, which the square of the standard deviation is without its last bits.
#[cfg(feature = "serde")]
fn whole(sigma: f64, variance: Option<f64>) -> Result<f64, ScalarLawError> {
    match variance {
        Some(value) if value.sqrt() != sigma => Err(ScalarLawError::Variance { value, sigma }),
        given => Ok(given.unwrap_or(sigma * sigma)),
    }
}

/// The serialized form; bounds that are infinite are left out.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
enum Parameters {
    Normal {
        mean: f64,
        sigma: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        variance: Option<f64>,
    },
    Uniform {
        low: f64,
        high: f64,
    },
    TruncatedNormal {
        mean: f64,
        sigma: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        low: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        high: Option<f64>,
    },
    Lognormal {
        mean: f64,
        sigma: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        variance: Option<f64>,
    },
    Bernoulli {
        probability: f64,
    },
}

#[cfg(feature = "serde")]
impl TryFrom<Parameters> for ScalarLaw {
    type Error = ScalarLawError;

    fn try_from(p: Parameters) -> Result<Self, Self::Error> {
        match p {
            Parameters::Normal { mean, sigma, variance } => {
                Self::normal_of(mean, sigma, whole(sigma, variance)?)
            }
            Parameters::Uniform { low, high } => Self::uniform(low, high),
            Parameters::TruncatedNormal { mean, sigma, low, high } => Self::truncated_normal(
                mean,
                sigma,
                low.unwrap_or(f64::NEG_INFINITY),
                high.unwrap_or(f64::INFINITY),
            ),
            Parameters::Lognormal { mean, sigma, variance } => {
                Self::lognormal_of(mean, sigma, whole(sigma, variance)?)
            }
            Parameters::Bernoulli { probability } => Self::bernoulli(probability),
        }
    }
}

#[cfg(feature = "serde")]
impl From<ScalarLaw> for Parameters {
    fn from(law: ScalarLaw) -> Self {
        match law.0 {
            Kind::Normal { mean, deviation: sigma, variance } => {
                Self::Normal { mean, sigma, variance: more(sigma, variance) }
            }
            Kind::Uniform { low, high } => Self::Uniform { low, high },
            Kind::Truncated(law) => {
                let [low, high] = law.window.bounds().map(|x| x.is_finite().then_some(x));
                let sigma = law.window.deviation();
                Self::TruncatedNormal { mean: law.mean, sigma, low, high }
            }
            Kind::Lognormal { mean, deviation: sigma, variance, .. } => {
                Self::Lognormal { mean, sigma, variance: more(sigma, variance) }
            }
            Kind::Bernoulli { probability } => Self::Bernoulli { probability },
        }
    }
}

#[cfg(test)]
mod tests;
