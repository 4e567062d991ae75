//! The scalar laws: each is declared here, and nowhere else. A further one is a type with [`Law`], a constructor,
//! and its name in the list of [`laws!`].

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{LN_2, SQRT_2};
use std::sync::Arc;

use super::parameters::{Given, Key, Of, Value};
use super::{MAX, ScalarLaw, ScalarLawError};
use crate::incomplete_beta::IncompleteBeta;
use crate::normal::{LN_ROOT_TAU, above, below, score};
use crate::scaled::root_of_squares;
use crate::truncated_draw::Truncated;
use crate::truncated_normal::WindowError;

/// Up to this share of the mean, the deviation of a normal law makes a negative value as unlikely as [`NEVER`].
const SAFE_DEVIATION: f64 = 0.125;
/// What is not more likely than this is taken for impossible: Φ(−8), of a normal law what is eight deviations below its mean.
pub(crate) const NEVER: f64 = 6.221e-16;

laws!(Normal, Uniform, TruncatedNormal, Lognormal, Triangular, Beta, Weibull, Samples, Bernoulli);

/// A law of one number: everything that the rest of the crate, scenario files and JSON want to know of it.
pub(super) trait Law: Sized {
    /// What it is called in files.
    const NAME: &'static str;
    /// The keys that it takes in files, in the order in which they are written.
    const KEYS: &'static [Key];
    /// Whether it is of a quantity, not of an event: then it can be about a nominal value.
    const QUANTITY: bool = true;

    /// From the values of its keys.
    fn read(given: &Given) -> Result<ScalarLaw, ScalarLawError>;

    /// The values of its keys, which [`read`](Self::read) takes to the same law.
    fn values(&self) -> Vec<(&'static str, Value)>;

    /// The value at a standard normal score: it does not fall where the score rises.
    fn at_score(&self, z: f64) -> f64;

    /// The probability of a value of at most x.
    fn cdf(&self, x: f64) -> f64;

    /// The probability of a value above x, which keeps its digits where it is small.
    fn share_above(&self, x: f64) -> f64;

    /// The smallest x with a probability of at least p, which is one, of a value of at most x.
    fn quantile(&self, p: f64) -> f64 {
        self.at_score(score(p))
    }

    /// The logarithm of the density at a finite x; none if the law has no density.
    fn ln_density(&self, x: f64) -> Option<f64>;

    fn mean(&self) -> f64;

    /// The standard deviation.
    fn deviation(&self) -> f64;

    /// Mean and variance of the square.
    fn square_moments(&self) -> (f64, f64);

    /// What no draw exceeds in magnitude, `far` standard deviations of what is normal in it taken for all.
    fn reach(&self, far: f64) -> f64;

    /// All values in rising order with their probabilities, of a law of single values.
    fn atoms(&self) -> Option<Vec<(f64, f64)>> {
        None
    }

    /// A draw in the quickest way.
    #[inline]
    fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.at_score(StandardNormal.sample(rng))
    }

    /// Laws of every shape, and the first two draws of each in either way, pinned to the bit.
    #[cfg(test)]
    fn examples() -> Vec<(ScalarLaw, [f64; 4])>;
}

const SIGMA: Key = Key::new("sigma", Of::Size);
const SIGMAS: Key = Key::new("sigmas", Of::Sigmas);
const VARIANCE: Key = Key::new("variance", Of::Square);
const MEAN: Key = Key::new("mean", Of::Place);
const LOW: Key = Key::new("low", Of::Place);
const HIGH: Key = Key::new("high", Of::Place);
const MODE: Key = Key::new("mode", Of::Place);

fn number(field: &'static str, value: f64) -> Result<f64, ScalarLawError> {
    if value.abs() <= MAX { Ok(value) } else { Err(ScalarLawError::Number { field, value }) }
}

fn deviation(value: f64) -> Result<f64, ScalarLawError> {
    if (0.0..=MAX).contains(&value) { Ok(value) } else { Err(ScalarLawError::Deviation { value }) }
}

/// A number without unit.
fn within(field: &'static str, value: f64, [low, high]: [f64; 2]) -> Result<f64, ScalarLawError> {
    let allowed = (low..=high).contains(&value);
    if allowed { Ok(value) } else { Err(ScalarLawError::Shape { field, value, low, high }) }
}

fn bounds(low: f64, high: f64) -> Result<[f64; 2], ScalarLawError> {
    let (low, high) = (number("low", low)?, number("high", high)?);
    if low > high { Err(ScalarLawError::Bounds { low, high }) } else { Ok([low, high]) }
}

/// The distribution function of what is at one value alone.
fn step(at: f64, x: f64) -> f64 {
    f64::from(u8::from(x >= at))
}

/// ln φ(z), the density of the standard normal law.
fn ln_normal(z: f64) -> f64 {
    -0.5 * z * z - LN_ROOT_TAU
}

/// ln x^n, of x^0 = 1 at zero too.
fn ln_power(x: f64, n: f64) -> f64 {
    if n == 0.0 { 0.0 } else { n * libm::log(x) }
}

/// `sigma`, or `variance` where its square has other bits.
fn spread(sigma: f64, variance: f64) -> (&'static str, Value) {
    if sigma * sigma == variance { ("sigma", sigma.into()) } else { ("variance", variance.into()) }
}

/// Mean and variance of the square, from the mean and the central moments 2, 3, 4.
fn of_square(m: f64, [v, third, fourth]: [f64; 3]) -> (f64, f64) {
    (m * m + v, (4.0 * m * (m * v + third) + (fourth - v * v)).max(0.0))
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Normal {
    mean: f64,
    deviation: f64,
    variance: f64,
    ln_deviation: f64,
}

impl ScalarLaw {
    /// Gaussian, m + σ z, with mean and standard deviation.
    ///
    /// # Errors
    /// Either is not a number or too large, or the deviation negative.
    pub fn normal(mean: f64, sigma: f64) -> Result<Self, ScalarLawError> {
        Self::normal_of(mean, sigma, sigma * sigma)
    }

    /// The same with the variance, which would lose its last digit as a root.
    pub(crate) fn normal_of(mean: f64, sigma: f64, variance: f64) -> Result<Self, ScalarLawError> {
        let (mean, deviation) = (number("mean", mean)?, deviation(sigma)?);
        let ln_deviation = libm::log(deviation);
        Ok(Self::of(Normal { mean, deviation, variance, ln_deviation }))
    }

    /// Mean and variance, if it is normal and its variance not too small for a number.
    #[must_use]
    pub fn as_normal(&self) -> Option<[f64; 2]> {
        let Kind::Normal(Normal { mean, deviation, variance, .. }) = self.0 else { return None };
        (variance.is_normal() || deviation == 0.0).then_some([mean, variance])
    }
}

impl Law for Normal {
    const NAME: &'static str = "normal";
    const KEYS: &'static [Key] =
        &[SIGMA, SIGMAS, VARIANCE, MEAN, Key::new("covariance", Of::Matrix)];

    fn read(given: &Given) -> Result<ScalarLaw, ScalarLawError> {
        let [sigma, variance] = given.spread()?;
        ScalarLaw::normal_of(given.about("mean")?, sigma, variance)
    }

    fn values(&self) -> Vec<(&'static str, Value)> {
        vec![spread(self.deviation, self.variance), ("mean", self.mean.into())]
    }

    fn at_score(&self, z: f64) -> f64 {
        self.mean + self.deviation * z
    }

    fn cdf(&self, x: f64) -> f64 {
        if self.deviation == 0.0 {
            step(self.mean, x)
        } else {
            below((x - self.mean) / self.deviation)
        }
    }

    fn share_above(&self, x: f64) -> f64 {
        if self.deviation == 0.0 {
            1.0 - step(self.mean, x)
        } else {
            above((x - self.mean) / self.deviation)
        }
    }

    fn ln_density(&self, x: f64) -> Option<f64> {
        (self.deviation > 0.0)
            .then(|| ln_normal((x - self.mean) / self.deviation) - self.ln_deviation)
    }

    fn mean(&self) -> f64 {
        self.mean
    }

    fn deviation(&self) -> f64 {
        self.deviation
    }

    /// K/σ² is noncentral χ² with one degree of freedom.
    fn square_moments(&self) -> (f64, f64) {
        let (m, v) = (self.mean, self.variance);
        (m * m + v, 2.0 * v * (2.0 * m * m + v))
    }

    fn reach(&self, far: f64) -> f64 {
        self.mean.abs() + far * self.deviation
    }

    #[cfg(test)]
    fn examples() -> Vec<(ScalarLaw, [f64; 4])> {
        vec![
            (
                ScalarLaw::normal(3.0, 2.0).unwrap(),
                [1.6716924387343013, 4.158141325357163, 1.6716924387343013, 4.158141325357163],
            ),
            (
                ScalarLaw::normal_of(-1.0, 0.3_f64.sqrt(), 0.3).unwrap(),
                [-1.3637720073049493, -0.682829935661476, -1.3637720073049493, -0.682829935661476],
            ),
        ]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Uniform {
    low: f64,
    high: f64,
}

impl ScalarLaw {
    /// Uniform between two bounds, a + (b − a) Φ(z).
    ///
    /// # Errors
    /// A bound is not a number or too large, or the second is below the first.
    pub fn uniform(low: f64, high: f64) -> Result<Self, ScalarLawError> {
        let [low, high] = bounds(low, high)?;
        Ok(Self::of(Uniform { low, high }))
    }
}

impl Law for Uniform {
    const NAME: &'static str = "uniform";
    const KEYS: &'static [Key] = &[LOW, HIGH];

    fn read(given: &Given) -> Result<ScalarLaw, ScalarLawError> {
        ScalarLaw::uniform(given.number("low")?, given.number("high")?)
    }

    fn values(&self) -> Vec<(&'static str, Value)> {
        vec![("low", self.low.into()), ("high", self.high.into())]
    }

    fn at_score(&self, z: f64) -> f64 {
        (self.low + (self.high - self.low) * below(z)).clamp(self.low, self.high)
    }

    fn cdf(&self, x: f64) -> f64 {
        if self.low == self.high {
            step(self.low, x)
        } else {
            ((x - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
        }
    }

    fn share_above(&self, x: f64) -> f64 {
        if self.low == self.high {
            1.0 - step(self.low, x)
        } else {
            ((self.high - x) / (self.high - self.low)).clamp(0.0, 1.0)
        }
    }

    fn ln_density(&self, x: f64) -> Option<f64> {
        let inside = (self.low..=self.high).contains(&x);
        (self.low < self.high)
            .then(|| if inside { -libm::log(self.high - self.low) } else { f64::NEG_INFINITY })
    }

    fn mean(&self) -> f64 {
        0.5 * self.low + 0.5 * self.high
    }

    fn deviation(&self) -> f64 {
        (0.5 * self.high - 0.5 * self.low) / 3.0_f64.sqrt()
    }

    fn square_moments(&self) -> (f64, f64) {
        let (c, h) = (0.5 * (self.low + self.high), 0.5 * (self.high - self.low));
        (c * c + h * h / 3.0, 4.0 * h * h * (c * c / 3.0 + h * h / 45.0))
    }

    fn reach(&self, _: f64) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        let u: f64 = rng.random();
        (self.low + u * (self.high - self.low)).clamp(self.low, self.high)
    }

    #[cfg(test)]
    fn examples() -> Vec<(ScalarLaw, [f64; 4])> {
        vec![(
            ScalarLaw::uniform(-1.0, 4.0).unwrap(),
            [0.2664797295166743, 2.5936462638711353, 0.46470828362659855, 3.46325164616996],
        )]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TruncatedNormal(Truncated);

impl ScalarLaw {
    /// Gaussian kept between two bounds, which may be infinite; mean and standard deviation are those before
    /// truncation: m + σ Φ⁻¹(Φ(α) + (Φ(β) − Φ(α)) Φ(z)), α, β = (a, b − m)/σ.
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
            Ok(law) => Ok(Self::of(TruncatedNormal(law))),
            Err(WindowError::Bounds) => Err(ScalarLawError::Bounds { low, high }),
            Err(WindowError::Distance(distance)) => {
                Err(ScalarLawError::Distance { low, high, distance })
            }
        }
    }
}

impl Law for TruncatedNormal {
    const NAME: &'static str = "truncated-normal";
    const KEYS: &'static [Key] = &[SIGMA, SIGMAS, VARIANCE, MEAN, LOW, HIGH];

    fn read(given: &Given) -> Result<ScalarLaw, ScalarLawError> {
        ScalarLaw::truncated_normal(
            given.about("mean")?,
            given.spread()?[0],
            given.or("low", f64::NEG_INFINITY),
            given.or("high", f64::INFINITY),
        )
    }

    /// Bounds that are infinite are left out.
    fn values(&self) -> Vec<(&'static str, Value)> {
        let [low, high] = self.0.window.bounds();
        let bounds = [("low", low), ("high", high)].into_iter().filter(|bound| bound.1.is_finite());
        let own = [("sigma", self.0.window.deviation()), ("mean", self.0.mean)];
        own.into_iter().chain(bounds).map(|(key, value)| (key, value.into())).collect()
    }

    fn at_score(&self, z: f64) -> f64 {
        self.0.window.at_score(z)
    }

    fn cdf(&self, x: f64) -> f64 {
        self.0.window.cdf(x)
    }

    fn share_above(&self, x: f64) -> f64 {
        self.0.window.share_above(x)
    }

    fn ln_density(&self, x: f64) -> Option<f64> {
        self.0.window.ln_density_at(x)
    }

    fn mean(&self) -> f64 {
        self.0.window.moments().mean
    }

    fn deviation(&self) -> f64 {
        self.0.window.moments().deviation
    }

    fn square_moments(&self) -> (f64, f64) {
        let moments = self.0.window.moments();
        (moments.square_mean, moments.square_variance)
    }

    fn reach(&self, far: f64) -> f64 {
        self.0.mean.abs() + far * self.0.window.deviation()
    }

    /// By rejection; without a deviation nothing is drawn.
    fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.0.sample(rng)
    }

    #[cfg(test)]
    fn examples() -> Vec<(ScalarLaw, [f64; 4])> {
        vec![
            (
                ScalarLaw::truncated_normal(1.0, 2.0, 0.0, f64::INFINITY).unwrap(),
                [0.918171742641717, 2.722950574424301, 2.158141325357163, 3.251472013392186],
            ),
            (
                ScalarLaw::truncated_normal(0.0, 1.0, -2.0, 2.0).unwrap(),
                [-0.6294689489910743, 0.5498154334967786, -0.6641537806328494, 0.5790706626785816],
            ),
            (
                ScalarLaw::truncated_normal(0.0, 1.0, 5.0, f64::INFINITY).unwrap(),
                [5.056023867542575, 5.239223783259982, 5.0667571676744245, 5.348464577666834],
            ),
            (
                ScalarLaw::truncated_normal(0.0, 1.0, -7.0, -4.0).unwrap(),
                [-4.313838788503743, -4.077481777487896, -4.081831098088941, -4.4271487246829455],
            ),
            (
                ScalarLaw::truncated_normal(0.0, 1.0, 0.3, 0.31).unwrap(),
                [0.3025300843498565, 0.30718420089611903, 0.3029294165672532, 0.30836252723105884],
            ),
        ]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lognormal {
    mean: f64,
    deviation: f64,
    variance: f64,
    log_median: f64,
    log_deviation: f64,
}

impl ScalarLaw {
    /// Lognormal, with its own mean and standard deviation: m exp(s z − s²/2), s² = ln(1 + σ²/m²). Always
    /// positive.
    ///
    /// # Errors
    /// The mean is not positive or too large, or the deviation negative, NaN or too large.
    pub fn lognormal(mean: f64, sigma: f64) -> Result<Self, ScalarLawError> {
        Self::lognormal_of(mean, sigma, sigma * sigma)
    }

    /// Of something positive of which mean and standard deviation are all that is known, as a mass: normal up to a
    /// deviation of an eighth of the mean; lognormal beyond, where a normal law would come near zero. Both have the mean and
    /// the deviation given, which a normal law that is cut off at zero has not.
    ///
    /// ```
    /// use gyradius_dispersion::ScalarLaw;
    ///
    /// let laws = [ScalarLaw::positive(2.0, 0.1)?, ScalarLaw::positive(2.0, 1.0)?];
    /// assert_eq!(laws.each_ref().map(ScalarLaw::name), ["normal", "lognormal"]);
    /// assert_eq!((laws[1].mean(), laws[1].deviation()), (2.0, 1.0));
    /// # Ok::<(), gyradius_dispersion::ScalarLawError>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`lognormal`](Self::lognormal).
    pub fn positive(mean: f64, sigma: f64) -> Result<Self, ScalarLawError> {
        if mean > 0.0 && sigma <= SAFE_DEVIATION * mean {
            Self::normal(mean, sigma)
        } else {
            Self::lognormal(mean, sigma)
        }
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
        let log_median = libm::log(mean) - 0.5 * square;
        let log_deviation = square.sqrt();
        Ok(Self::of(Lognormal { mean, deviation, variance, log_median, log_deviation }))
    }
}

impl ScalarLaw {
    /// The mean, and the deviation of the logarithm, if it is lognormal.
    pub(crate) fn as_lognormal(&self) -> Option<[f64; 2]> {
        let Kind::Lognormal(Lognormal { mean, log_deviation, .. }) = self.0 else { return None };
        Some([mean, log_deviation])
    }
}

impl Lognormal {
    /// The score of a value, of a law with a deviation; of one that is not positive, −∞.
    fn score(&self, x: f64) -> f64 {
        let change = (x - self.mean) / self.mean;
        // Near the mean nothing cancels, and far from it nothing overflows.
        let ln_ratio = if change.abs() < 0.5 {
            libm::log1p(change)
        } else {
            libm::log(x.max(0.0)) - libm::log(self.mean)
        };
        ln_ratio / self.log_deviation + 0.5 * self.log_deviation
    }
}

impl Law for Lognormal {
    const NAME: &'static str = "lognormal";
    const KEYS: &'static [Key] = &[SIGMA, SIGMAS, VARIANCE, MEAN];

    fn read(given: &Given) -> Result<ScalarLaw, ScalarLawError> {
        let [sigma, variance] = given.spread()?;
        ScalarLaw::lognormal_of(given.about("mean")?, sigma, variance)
    }

    fn values(&self) -> Vec<(&'static str, Value)> {
        vec![spread(self.deviation, self.variance), ("mean", self.mean.into())]
    }

    fn at_score(&self, z: f64) -> f64 {
        let s = self.log_deviation;
        self.mean * libm::exp(s * (z - 0.5 * s))
    }

    fn cdf(&self, x: f64) -> f64 {
        if self.log_deviation == 0.0 { step(self.mean, x) } else { below(self.score(x)) }
    }

    fn share_above(&self, x: f64) -> f64 {
        if self.log_deviation == 0.0 { 1.0 - step(self.mean, x) } else { above(self.score(x)) }
    }

    fn ln_density(&self, x: f64) -> Option<f64> {
        let s = self.log_deviation;
        if s == 0.0 {
            return None;
        }
        if !(x > 0.0) {
            return Some(f64::NEG_INFINITY);
        }
        Some(ln_normal(self.score(x)) - libm::log(s) - libm::log(x))
    }

    fn mean(&self) -> f64 {
        self.mean
    }

    fn deviation(&self) -> f64 {
        self.deviation
    }

    /// The square is lognormal too, of twice the deviation of the logarithm.
    fn square_moments(&self) -> (f64, f64) {
        let square = self.mean * self.mean + self.variance;
        (square, square * square * libm::expm1(4.0 * self.log_deviation * self.log_deviation))
    }

    fn reach(&self, far: f64) -> f64 {
        libm::exp(self.log_median + far * self.log_deviation)
    }

    /// Without a deviation nothing is drawn.
    fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        if self.log_deviation == 0.0 {
            return self.mean;
        }
        let z: f64 = StandardNormal.sample(rng);
        libm::exp(self.log_median + self.log_deviation * z)
    }

    #[cfg(test)]
    fn examples() -> Vec<(ScalarLaw, [f64; 4])> {
        vec![
            (
                ScalarLaw::lognormal(5.0, 0.5).unwrap(),
                [4.65625982878324, 5.271030185289832, 4.65625982878324, 5.271030185289831],
            ),
            (
                ScalarLaw::lognormal(0.01, 0.05).unwrap(),
                [
                    0.0005913933528726503,
                    0.005577668431651719,
                    0.0005913933528726506,
                    0.0055776684316517205,
                ],
            ),
        ]
    }
}

/// Shares below it are computed from the end of a triangular law at which they are, though the mode be there.
const SMALL: f64 = 1e-4;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Triangular {
    low: f64,
    mode: f64,
    high: f64,
}

impl ScalarLaw {
    /// Triangular between two bounds, likeliest at the mode: with p = Φ(z), a + √(p (b − a)(c − a)) up to the mode
    /// c, b − √((1 − p)(b − a)(b − c)) beyond it.
    ///
    /// # Errors
    /// A number is none or too large, or they are not in this order.
    pub fn triangular(low: f64, mode: f64, high: f64) -> Result<Self, ScalarLawError> {
        let ([low, high], mode) = (bounds(low, high)?, number("mode", mode)?);
        if !(low..=high).contains(&mode) {
            return Err(ScalarLawError::Mode { low, mode, high });
        }
        Ok(Self::of(Triangular { low, mode, high }))
    }
}

impl Triangular {
    /// How far from an end a share lies, from which the mode is as far as the first, and from there the other end as far as
    /// the second.
    fn distance_from_end(&self, share: f64, [near, far]: [f64; 2]) -> f64 {
        let width = self.high - self.low;
        if share * width <= near {
            return width.sqrt() * (share * near).sqrt();
        }
        // 1 − √(1 − part), which does not cancel so.
        let part = (share * width - near) / far;
        near + far * (part / (1.0 + (1.0 - part).sqrt()))
    }

    /// The share between an end and a value: from how far it lies from that end, beyond the mode and from the other end,
    /// and how far the mode lies from that end and from the other.
    fn share_from_end(&self, [from, beyond, rest]: [f64; 3], [near, far]: [f64; 2]) -> f64 {
        let width = self.high - self.low;
        if rest <= 0.0 {
            1.0
        } else if from <= 0.0 {
            0.0
        } else if beyond <= 0.0 {
            from / width * (from / near)
        } else {
            let other = rest / width * (rest / far);
            // The share is small beyond the mode where that lies near the end.
            if other > 1.0 - SMALL {
                near / width + beyond / width * (2.0 - beyond / far)
            } else {
                1.0 - other
            }
        }
    }
}

impl Law for Triangular {
    const NAME: &'static str = "triangular";
    const KEYS: &'static [Key] = &[LOW, MODE, HIGH];

    fn read(given: &Given) -> Result<ScalarLaw, ScalarLawError> {
        ScalarLaw::triangular(given.number("low")?, given.about("mode")?, given.number("high")?)
    }

    fn values(&self) -> Vec<(&'static str, Value)> {
        let values = [("low", self.low), ("mode", self.mode), ("high", self.high)];
        values.map(|(key, value)| (key, value.into())).to_vec()
    }

    fn at_score(&self, z: f64) -> f64 {
        let (left, right) = (self.mode - self.low, self.high - self.mode);
        let (p, q) = (below(z), above(z));
        // From the end that is nearer, so that small shares keep their digits.
        let is_left =
            if p < SMALL { true } else { q >= SMALL && p * (self.high - self.low) <= left };
        let x = if is_left {
            self.low + self.distance_from_end(p, [left, right])
        } else {
            self.high - self.distance_from_end(q, [right, left])
        };
        x.clamp(self.low, self.high)
    }

    fn cdf(&self, x: f64) -> f64 {
        let Self { low, mode, high } = *self;
        if low == high {
            return step(low, x);
        }
        self.share_from_end([x - low, x - mode, high - x], [mode - low, high - mode])
    }

    fn share_above(&self, x: f64) -> f64 {
        let Self { low, mode, high } = *self;
        if low == high {
            return 1.0 - step(low, x);
        }
        self.share_from_end([high - x, mode - x, x - low], [high - mode, mode - low])
    }

    fn ln_density(&self, x: f64) -> Option<f64> {
        let Self { low, mode, high } = *self;
        (low < high).then(|| {
            // Of its largest value.
            let share = if x == mode {
                1.0
            } else if x < mode {
                ((x - low) / (mode - low)).max(0.0)
            } else {
                ((high - x) / (high - mode)).max(0.0)
            };
            LN_2 + libm::log(share) - libm::log(high - low)
        })
    }

    fn mean(&self) -> f64 {
        self.low / 3.0 + self.mode / 3.0 + self.high / 3.0
    }

    fn deviation(&self) -> f64 {
        let (p, q) = (self.mode - self.low, self.high - self.mode);
        // A sum of terms that are not negative.
        let root = root_of_squares(p.max(q), |unit| {
            let (p, q) = (p / unit, q / unit);
            p * p + p * q + q * q
        });
        root / (3.0 * SQRT_2)
    }

    fn square_moments(&self) -> (f64, f64) {
        let (p, q) = (self.mode - self.low, self.high - self.mode);
        let v = (p * p + p * q + q * q) / 18.0;
        let third = (q - p) * (2.0 * p + q) * (p + 2.0 * q) / 270.0;
        of_square(self.mean(), [v, third, 2.4 * v * v])
    }

    fn reach(&self, _: f64) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    #[cfg(test)]
    fn examples() -> Vec<(ScalarLaw, [f64; 4])> {
        vec![
            (
                ScalarLaw::triangular(-1.0, 0.5, 4.0).unwrap(),
                [0.3783031576090261, 1.781388254684694, 0.3783031576090261, 1.781388254684694],
            ),
            (
                ScalarLaw::triangular(9.0, 9.0, 9.5).unwrap(),
                [9.067939803355868, 9.234825176899383, 9.067939803355868, 9.234825176899383],
            ),
        ]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Beta {
    low: f64,
    high: f64,
    below: IncompleteBeta,
}

/// Shape parameters of a beta law.
const SHAPES: [f64; 2] = [0.1, 1e3];

impl ScalarLaw {
    /// Beta on an interval, of density (x − a)^{α−1} (b − x)^{β−1} up to a factor.
    ///
    /// # Errors
    /// A bound is not a number or too large, the second is below the first, or α or β is outside [0.1, 1000].
    pub fn beta(low: f64, high: f64, alpha: f64, beta: f64) -> Result<Self, ScalarLawError> {
        let [low, high] = bounds(low, high)?;
        let (alpha, beta) = (within("alpha", alpha, SHAPES)?, within("beta", beta, SHAPES)?);
        Ok(Self::of(Beta { low, high, below: IncompleteBeta::new(alpha, beta) }))
    }
}

impl Beta {
    /// Mean and central moments 2, 3, 4 on [0, 1].
    fn moments(&self) -> (f64, [f64; 3]) {
        let [a, b] = self.below.shapes();
        let s = a + b;
        let v = a * b / (s * s * (s + 1.0));
        let third = 2.0 * v * (b - a) / (s * (s + 2.0));
        let fourth = 3.0 * v * (a * b * (s - 6.0) + 2.0 * s * s) / (s * s * (s + 2.0) * (s + 3.0));
        (a / s, [v, third, fourth])
    }
}

impl Law for Beta {
    const NAME: &'static str = "beta";
    const KEYS: &'static [Key] =
        &[LOW, HIGH, Key::new("alpha", Of::Number), Key::new("beta", Of::Number)];

    fn read(given: &Given) -> Result<ScalarLaw, ScalarLawError> {
        let [alpha, beta] = [given.number("alpha")?, given.number("beta")?];
        ScalarLaw::beta(given.number("low")?, given.number("high")?, alpha, beta)
    }

    fn values(&self) -> Vec<(&'static str, Value)> {
        let [alpha, beta] = self.below.shapes();
        let values = [("low", self.low), ("high", self.high), ("alpha", alpha), ("beta", beta)];
        values.map(|(key, value)| (key, value.into())).to_vec()
    }

    fn at_score(&self, z: f64) -> f64 {
        let width = self.high - self.low;
        let x = if z < 0.0 {
            self.low + width * self.below.inverse(below(z))
        } else {
            self.high - width * self.below.swapped().inverse(above(z))
        };
        x.clamp(self.low, self.high)
    }

    fn cdf(&self, x: f64) -> f64 {
        if self.low == self.high {
            return step(self.low, x);
        }
        let width = self.high - self.low;
        self.below.share((x - self.low) / width, (self.high - x) / width)
    }

    fn share_above(&self, x: f64) -> f64 {
        if self.low == self.high {
            return 1.0 - step(self.low, x);
        }
        let width = self.high - self.low;
        self.below.swapped().share((self.high - x) / width, (x - self.low) / width)
    }

    fn ln_density(&self, x: f64) -> Option<f64> {
        let width = self.high - self.low;
        if width == 0.0 {
            return None;
        }
        if !(self.low..=self.high).contains(&x) {
            return Some(f64::NEG_INFINITY);
        }
        let [a, b] = self.below.shapes();
        let ends =
            ln_power((x - self.low) / width, a - 1.0) + ln_power((self.high - x) / width, b - 1.0);
        Some(ends - self.below.ln_beta() - libm::log(width))
    }

    fn mean(&self) -> f64 {
        let (m, _) = self.moments();
        self.low + (self.high - self.low) * m
    }

    fn deviation(&self) -> f64 {
        let (_, [v, ..]) = self.moments();
        (self.high - self.low) * v.sqrt()
    }

    fn square_moments(&self) -> (f64, f64) {
        let (w, (_, [v, third, fourth])) = (self.high - self.low, self.moments());
        of_square(self.mean(), [w * w * v, w * w * w * third, w * w * w * w * fourth])
    }

    fn reach(&self, _: f64) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    #[cfg(test)]
    fn examples() -> Vec<(ScalarLaw, [f64; 4])> {
        vec![
            (
                ScalarLaw::beta(-1.0, 3.0, 2.0, 5.0).unwrap(),
                [
                    -0.34984633851622626,
                    0.4836058065166329,
                    -0.34984633851622626,
                    0.4836058065166329,
                ],
            ),
            (
                ScalarLaw::beta(10.0, 11.0, 0.5, 0.7).unwrap(),
                [10.098676434064355, 10.673573111389599, 10.098676434064355, 10.673573111389599],
            ),
            (
                ScalarLaw::beta(0.0, 1.0, 300.0, 20.0).unwrap(),
                [0.929083527495417, 0.9458842313009597, 0.929083527495417, 0.9458842313009597],
            ),
        ]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weibull {
    low: f64,
    scale: f64,
    shape: f64,
    /// Γ(1 + n/shape), n from 1 to 4.
    gamma: [f64; 4],
}

impl ScalarLaw {
    /// Weibull from a smallest value on: a + λ (−ln(1 − Φ(z)))^{1/k}, with the scale λ and the shape k.
    ///
    /// # Errors
    /// The smallest value is not a number or too large, the scale is negative, NaN or too large, or the shape is
    /// outside [0.5, 50].
    pub fn weibull(low: f64, scale: f64, shape: f64) -> Result<Self, ScalarLawError> {
        let low = number("low", low)?;
        if !(0.0..=MAX).contains(&scale) {
            return Err(ScalarLawError::Shape {
                field: "scale",
                value: scale,
                low: 0.0,
                high: MAX,
            });
        }
        let shape = within("shape", shape, [0.5, 50.0])?;
        let gamma = [1.0, 2.0, 3.0, 4.0].map(|n| libm::tgamma(1.0 + n / shape));
        Ok(Self::of(Weibull { low, scale, shape, gamma }))
    }
}

impl Law for Weibull {
    const NAME: &'static str = "weibull";
    const KEYS: &'static [Key] = &[LOW, Key::new("scale", Of::Size), Key::new("shape", Of::Number)];

    fn read(given: &Given) -> Result<ScalarLaw, ScalarLawError> {
        ScalarLaw::weibull(given.about("low")?, given.number("scale")?, given.number("shape")?)
    }

    fn values(&self) -> Vec<(&'static str, Value)> {
        let values = [("low", self.low), ("scale", self.scale), ("shape", self.shape)];
        values.map(|(key, value)| (key, value.into())).to_vec()
    }

    fn at_score(&self, z: f64) -> f64 {
        // −ln(1 − p), of the smaller of p and 1 − p.
        let exponent = if z < 0.0 { -libm::log1p(-below(z)) } else { -libm::log(above(z)) };
        self.low + self.scale * libm::pow(exponent, 1.0 / self.shape)
    }

    fn cdf(&self, x: f64) -> f64 {
        if self.scale == 0.0 {
            step(self.low, x)
        } else {
            -libm::expm1(-libm::pow((x - self.low).max(0.0) / self.scale, self.shape))
        }
    }

    fn share_above(&self, x: f64) -> f64 {
        if self.scale == 0.0 {
            1.0 - step(self.low, x)
        } else {
            libm::exp(-libm::pow((x - self.low).max(0.0) / self.scale, self.shape))
        }
    }

    fn ln_density(&self, x: f64) -> Option<f64> {
        if self.scale == 0.0 {
            return None;
        }
        let ratio = (x - self.low) / self.scale;
        let exponent = libm::pow(ratio, self.shape);
        Some(if ratio < 0.0 || exponent == f64::INFINITY {
            f64::NEG_INFINITY
        } else {
            let ln_shape = libm::log(self.shape) - libm::log(self.scale);
            ln_shape + ln_power(ratio, self.shape - 1.0) - exponent
        })
    }

    fn mean(&self) -> f64 {
        self.low + self.scale * self.gamma[0]
    }

    fn deviation(&self) -> f64 {
        let [g1, g2, ..] = self.gamma;
        self.scale * (g2 - g1 * g1).sqrt()
    }

    fn square_moments(&self) -> (f64, f64) {
        let ([g1, g2, g3, g4], s) = (self.gamma, self.scale);
        if s == 0.0 {
            return (self.low * self.low, 0.0);
        }
        let (m, v) = (self.low / s, g2 - g1 * g1);
        // Of (m + w)², in units of the scale.
        let mean = (m + g1) * (m + g1) + v;
        let variance = 4.0 * m * (m * v + (g3 - g1 * g2)) + (g4 - g2 * g2);
        (s * s * mean, s * s * variance.max(0.0) * s * s)
    }

    fn reach(&self, far: f64) -> f64 {
        // Beyond `far` deviations lies less than e^{−far²/2}.
        self.low.abs() + self.scale * libm::pow(far * far, 1.0 / self.shape)
    }

    #[cfg(test)]
    fn examples() -> Vec<(ScalarLaw, [f64; 4])> {
        vec![
            (
                ScalarLaw::weibull(0.0, 2.0, 1.5).unwrap(),
                [0.8804489334481088, 2.343559898806145, 0.8804489334481088, 2.343559898806145],
            ),
            (
                ScalarLaw::weibull(-3.0, 0.5, 12.0).unwrap(),
                [-2.5487374675026384, -2.489993440167287, -2.5487374675026384, -2.489993440167287],
            ),
        ]
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Samples {
    /// In rising order.
    values: Arc<[f64]>,
}

/// Most samples of a law.
const MOST: usize = 100_000;

impl ScalarLaw {
    /// One of the given values, each as likely as the others.
    ///
    /// # Errors
    /// There is none, there are more than 100,000, or one is not a number or too large.
    pub fn samples(values: &[f64]) -> Result<Self, ScalarLawError> {
        if !(1..=MOST).contains(&values.len()) {
            return Err(ScalarLawError::Samples { count: values.len(), most: MOST });
        }
        let mut sorted = Vec::with_capacity(values.len());
        for value in values {
            sorted.push(number("samples", *value)?);
        }
        sorted.sort_by(f64::total_cmp);
        Ok(Self::of(Samples { values: sorted.into() }))
    }
}

/// Mean and variance of numbers.
fn mean_and_variance(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().map(|x| x / count).sum::<f64>();
    (mean, values.map(|x| (x - mean) * (x - mean) / count).sum())
}

impl Law for Samples {
    const NAME: &'static str = "samples";
    const KEYS: &'static [Key] = &[Key::new("samples", Of::Places)];

    fn read(given: &Given) -> Result<ScalarLaw, ScalarLawError> {
        ScalarLaw::samples(given.list("samples")?)
    }

    fn values(&self) -> Vec<(&'static str, Value)> {
        vec![("samples", Value::List(self.values.to_vec()))]
    }

    fn at_score(&self, z: f64) -> f64 {
        let count = self.values.len();
        // From the end that is nearer.
        let index = if z < 0.0 {
            (below(z) * count as f64) as usize
        } else {
            count - 1 - ((above(z) * count as f64) as usize).min(count - 1)
        };
        self.values[index.min(count - 1)]
    }

    fn cdf(&self, x: f64) -> f64 {
        self.values.partition_point(|v| *v <= x) as f64 / self.values.len() as f64
    }

    fn share_above(&self, x: f64) -> f64 {
        let below = self.values.partition_point(|v| *v <= x);
        (self.values.len() - below) as f64 / self.values.len() as f64
    }

    fn quantile(&self, p: f64) -> f64 {
        let count = self.values.len() as f64;
        // The shares that `cdf` has, however they were rounded.
        let enough = (p * count).ceil();
        let enough = if (enough - 1.0) / count >= p { enough - 1.0 } else { enough };
        self.values[(enough.max(1.0) as usize).min(self.values.len()) - 1]
    }

    fn ln_density(&self, _: f64) -> Option<f64> {
        None
    }

    fn mean(&self) -> f64 {
        mean_and_variance(self.values.iter().copied()).0
    }

    fn deviation(&self) -> f64 {
        let in_unit = |unit| mean_and_variance(self.values.iter().map(|x| x / unit)).1;
        root_of_squares(self.reach(0.0), in_unit)
    }

    fn square_moments(&self) -> (f64, f64) {
        mean_and_variance(self.values.iter().map(|x| x * x))
    }

    fn reach(&self, _: f64) -> f64 {
        self.values.iter().fold(0.0, |most, x| most.max(x.abs()))
    }

    fn atoms(&self) -> Option<Vec<(f64, f64)>> {
        let count = self.values.len() as f64;
        let equal = self.values.chunk_by(|a, b| a == b);
        Some(equal.map(|values| (values[0], values.len() as f64 / count)).collect())
    }

    #[cfg(test)]
    fn examples() -> Vec<(ScalarLaw, [f64; 4])> {
        vec![(
            ScalarLaw::samples(&[3.0, 1.0, 1.0, 2.5, -4.0, 7.0, 0.5]).unwrap(),
            [0.5, 3.0, 0.5, 3.0],
        )]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bernoulli {
    probability: f64,
}

impl ScalarLaw {
    /// One with a probability, 1 if Φ(−z) < p, else zero.
    ///
    /// # Errors
    /// The probability is outside [0, 1] or NaN.
    pub fn bernoulli(probability: f64) -> Result<Self, ScalarLawError> {
        if !(0.0..=1.0).contains(&probability) {
            return Err(ScalarLawError::Probability { value: probability });
        }
        Ok(Self::of(Bernoulli { probability }))
    }

    /// The probability, if it is of an event.
    #[must_use]
    pub fn as_bernoulli(&self) -> Option<f64> {
        if let Kind::Bernoulli(law) = &self.0 { Some(law.probability) } else { None }
    }
}

impl Law for Bernoulli {
    const NAME: &'static str = "bernoulli";
    const KEYS: &'static [Key] = &[Key::new("probability", Of::Number)];
    const QUANTITY: bool = false;

    fn read(given: &Given) -> Result<ScalarLaw, ScalarLawError> {
        ScalarLaw::bernoulli(given.number("probability")?)
    }

    fn values(&self) -> Vec<(&'static str, Value)> {
        vec![("probability", self.probability.into())]
    }

    fn at_score(&self, z: f64) -> f64 {
        // What is certain is so at every score, though the share is rounded to one there.
        f64::from(u8::from(self.probability == 1.0 || below(-z) < self.probability))
    }

    fn cdf(&self, x: f64) -> f64 {
        if x >= 1.0 { 1.0 } else { (1.0 - self.probability) * step(0.0, x) }
    }

    fn share_above(&self, x: f64) -> f64 {
        if x >= 1.0 {
            0.0
        } else if x >= 0.0 {
            self.probability
        } else {
            1.0
        }
    }

    fn quantile(&self, p: f64) -> f64 {
        let certain = self.probability == 1.0 || (p == 1.0 && self.probability > 0.0);
        let one = certain || p > 1.0 - self.probability;
        f64::from(u8::from(one))
    }

    fn ln_density(&self, _: f64) -> Option<f64> {
        None
    }

    fn mean(&self) -> f64 {
        self.probability
    }

    fn deviation(&self) -> f64 {
        (self.probability * (1.0 - self.probability)).sqrt()
    }

    fn square_moments(&self) -> (f64, f64) {
        (self.probability, self.probability * (1.0 - self.probability))
    }

    fn reach(&self, _: f64) -> f64 {
        1.0
    }

    fn atoms(&self) -> Option<Vec<(f64, f64)>> {
        Some(vec![(0.0, 1.0 - self.probability), (1.0, self.probability)])
    }

    #[cfg(test)]
    fn examples() -> Vec<(ScalarLaw, [f64; 4])> {
        vec![(ScalarLaw::bernoulli(0.3).unwrap(), [0.0, 1.0, 0.0, 1.0])]
    }
}
