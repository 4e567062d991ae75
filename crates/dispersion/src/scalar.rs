//! Laws of one number.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::truncated_normal::MAX_DISTANCE;
use form::Declaration;
use laws::DECLARATIONS;
pub(crate) use laws::NEVER;

/// The enumeration of the laws, and what every one is asked. `laws.rs` calls it with their names.
macro_rules! laws {
    ($($law:ident),*) => {
        #[derive(Clone, Debug, PartialEq)]
        pub(crate) enum Kind {
            $($law($law),)*
        }

        $(impl From<$law> for Kind {
            fn from(law: $law) -> Self {
                Self::$law(law)
            }
        })*

        /// What is declared of each, the default first.
        pub(super) static DECLARATIONS: &[super::form::Declaration] = &[$(
            super::form::Declaration {
                name: $law::NAME,
                keys: $law::KEYS,
                quantity: $law::QUANTITY,
                read: $law::read,
            },
        )*];

        /// Laws of every kind, and the draws of each that are pinned.
        #[cfg(test)]
        pub(super) fn examples() -> Vec<(ScalarLaw, [f64; 4])> {
            [$($law::examples(),)*].concat()
        }

        impl Kind {
            pub(super) fn name(&self) -> &'static str {
                match self { $(Self::$law(_) => $law::NAME,)* }
            }

            pub(super) fn values(&self) -> Vec<(&'static str, Value)> {
                match self { $(Self::$law(law) => law.values(),)* }
            }

            pub(super) fn at_score(&self, z: f64) -> f64 {
                match self { $(Self::$law(law) => law.at_score(z),)* }
            }

            pub(super) fn cdf(&self, x: f64) -> f64 {
                match self { $(Self::$law(law) => law.cdf(x),)* }
            }

            pub(super) fn share_above(&self, x: f64) -> f64 {
                match self { $(Self::$law(law) => law.share_above(x),)* }
            }

            pub(super) fn quantile(&self, p: f64) -> f64 {
                match self { $(Self::$law(law) => law.quantile(p),)* }
            }

            pub(super) fn ln_density(&self, x: f64) -> Option<f64> {
                match self { $(Self::$law(law) => law.ln_density(x),)* }
            }

            pub(super) fn mean(&self) -> f64 {
                match self { $(Self::$law(law) => law.mean(),)* }
            }

            pub(super) fn deviation(&self) -> f64 {
                match self { $(Self::$law(law) => law.deviation(),)* }
            }

            pub(super) fn square_moments(&self) -> (f64, f64) {
                match self { $(Self::$law(law) => law.square_moments(),)* }
            }

            pub(super) fn reach(&self, far: f64) -> f64 {
                match self { $(Self::$law(law) => law.reach(far),)* }
            }

            pub(super) fn atoms(&self) -> Option<Vec<(f64, f64)>> {
                match self { $(Self::$law(law) => law.atoms(),)* }
            }

            #[inline]
            pub(super) fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
                match self { $(Self::$law(law) => law.draw(rng),)* }
            }
        }
    };
}

mod form;
mod laws;
mod parameters;

pub use form::{LawUnit, ScalarLawForm, ScalarLawFormError};
use laws::Kind;

/// Largest magnitude of what a law may be given.
const MAX: f64 = 1e100;
/// Scores beyond it are not looked for.
const END: f64 = 38.0;

/// A law of one number: of a mass, a stiffness, a coordinate.
///
/// # Definition
/// Every law is the image of a standard normal score z under a function that does not fall,
/// F⁻¹(Φ(z)), so that laws of any kind can be drawn jointly from scores that are jointly normal (a
/// Gaussian copula; [`Correlation`](crate::Correlation)). The constructors say which function that is.
///
/// [`sample`](Distribution::sample) draws a score. [`ScalarRoots`](crate::ScalarRoots) draw the same laws in quicker
/// ways, which give other values.
///
/// What is asked of a NaN is NaN, whatever the law.
///
/// With the feature `serde` it is read and written as a [`ScalarLawForm`].
///
/// # Limits
/// The mean of a truncated normal law may be at most 6σ outside of its bounds.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "ScalarLawForm", into = "ScalarLawForm"))]
pub struct ScalarLaw(Kind);

impl ScalarLaw {
    fn of(law: impl Into<Kind>) -> Self {
        Self(law.into())
    }

    /// The value at a standard normal score. It does not fall where the score rises, but for rounding: by 1e-14 of the largest
    /// magnitude that it has at this score and at scores of ±9. Near a bound that is small beside that, a truncated normal law has
    /// the digits of the value itself, to 1e-13.
    #[must_use]
    pub fn at_score(&self, z: f64) -> f64 {
        let x = if z.is_nan() { z } else { self.0.at_score(z) };
        // Of a law without width that is infinitely far out of nothing.
        if x.is_nan() && !z.is_nan() { self.0.at_score(0.0) } else { x }
    }

    /// The standard normal score of a value, by bisection where it has no formula: the least one at which
    /// [`at_score`](Self::at_score) is not below the value, within ±38.
    #[must_use]
    pub fn score(&self, x: f64) -> f64 {
        if x.is_nan() {
            return x;
        }
        if let Some([mean, variance]) = self.as_normal()
            && variance > 0.0
        {
            return ((x - mean) / variance.sqrt()).clamp(-END, END);
        }
        let (mut low, mut high) = (-END, END);
        loop {
            let middle = 0.5 * (low + high);
            if middle == low || middle == high {
                return high;
            }
            *(if self.at_score(middle) < x { &mut low } else { &mut high }) = middle;
        }
    }

    /// The probability of a value of at most x.
    #[must_use]
    pub fn cdf(&self, x: f64) -> f64 {
        if x.is_nan() { x } else { self.0.cdf(x) }
    }

    /// The probability of a value above x: 1 − F(x), without cancellation where it is small.
    #[must_use]
    pub fn share_above(&self, x: f64) -> f64 {
        if x.is_nan() { x } else { self.0.share_above(x) }
    }

    /// The smallest value that is not exceeded with a probability of at least p: the inverse of [`cdf`](Self::cdf), with the bounds of
    /// the law at 0 and 1. NaN where p is no probability.
    #[must_use]
    pub fn quantile(&self, p: f64) -> f64 {
        if !(0.0..=1.0).contains(&p) {
            return f64::NAN;
        }
        let x = self.0.quantile(p);
        // As of an infinite score.
        if x.is_nan() { self.at_score(0.0) } else { x }
    }

    /// The probability of a value below zero; a value that is always zero is not.
    #[must_use]
    pub fn share_below_zero(&self) -> f64 {
        self.cdf(-f64::MIN_POSITIVE)
    }

    /// The logarithm of the density at x, −∞ outside of the support. None if the law has no density: it has no
    /// width, or it is of samples or of an event.
    ///
    /// The density of a beta law with a shape below one, and of a Weibull law with a shape below one, is infinite at a
    /// bound.
    ///
    /// ```
    /// use gyradius_dispersion::ScalarLaw;
    ///
    /// let mass = ScalarLaw::uniform(10.0, 12.0)?;
    /// assert_eq!(mass.ln_density(11.0), Some(0.5_f64.ln()));
    /// assert_eq!(mass.ln_density(13.0), Some(f64::NEG_INFINITY));
    /// assert_eq!(ScalarLaw::normal(11.0, 0.0)?.ln_density(11.0), None);
    /// # Ok::<(), gyradius_dispersion::ScalarLawError>(())
    /// ```
    #[must_use]
    pub fn ln_density(&self, x: f64) -> Option<f64> {
        if x.is_finite() {
            self.0.ln_density(x)
        } else {
            self.0.ln_density(0.0).map(|_| if x.is_nan() { x } else { f64::NEG_INFINITY })
        }
    }

    /// The mean.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.0.mean()
    }

    /// The standard deviation.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        self.0.deviation()
    }

    /// What it is called in files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.0.name()
    }

    /// What every law is called in files, and the keys that it takes there, in this order.
    pub fn names() -> impl Iterator<Item = (&'static str, Vec<&'static str>)> {
        let keys = |law: &Declaration| law.keys.iter().map(|key| key.name).collect();
        DECLARATIONS.iter().map(move |law| (law.name, keys(law)))
    }

    /// Which of its keys are of the change from the nominal value where it is read about one, in words.
    #[must_use]
    pub fn changes(&self) -> String {
        self.declaration().changes()
    }

    fn declaration(&self) -> &'static Declaration {
        let own = DECLARATIONS.iter().find(|law| law.name == self.name());
        own.unwrap_or(&DECLARATIONS[0])
    }
}

/// What a law of roots needs.
impl ScalarLaw {
    /// A draw in the quickest way. A law without width draws nothing where it is lognormal or truncated.
    #[inline]
    pub(crate) fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.0.draw(rng)
    }

    /// Mean and variance of the square.
    pub(crate) fn square_moments(&self) -> (f64, f64) {
        self.0.square_moments()
    }

    /// What no draw exceeds in magnitude, `far` standard deviations of what is normal in it taken for all.
    pub(crate) fn reach(&self, far: f64) -> f64 {
        self.0.reach(far)
    }

    /// All values in rising order with their probabilities, of a law of single values, or of one that does not vary.
    pub(crate) fn atoms(&self) -> Option<Vec<(f64, f64)>> {
        let still = || (self.deviation() == 0.0).then(|| vec![(self.at_score(0.0), 1.0)]);
        self.0.atoms().or_else(still)
    }
}

impl Distribution<f64> for ScalarLaw {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.at_score(StandardNormal.sample(rng))
    }
}

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
    /// A variance is negative, NaN or too large, or stands beside a standard deviation.
    #[error(
        "variance = {value:?}: it must not be negative, and stands in place of sigma, not beside it"
    )]
    Variance {
        /// The variance.
        value: f64,
    },
    /// A number without unit, or a scale, is out of range.
    #[error("{field} = {value:?}: it must be {}", allowed(*low, *high))]
    Shape {
        /// Which.
        field: &'static str,
        /// The value.
        value: f64,
        /// The smallest that is allowed.
        low: f64,
        /// The largest that is allowed.
        high: f64,
    },
    /// The likeliest value lies outside the bounds.
    #[error("mode = {mode:?}: it must lie between the bounds, which are {low:?} and {high:?}")]
    Mode {
        /// The smaller bound.
        low: f64,
        /// The likeliest value.
        mode: f64,
        /// The larger bound.
        high: f64,
    },
    /// There are no samples, or too many.
    #[error("{count} samples: there must be between 1 and {most}")]
    Samples {
        /// How many were given.
        count: usize,
        /// The largest number that is allowed.
        most: usize,
    },
    /// A parameter is not given.
    #[error("missing: law = {law:?} needs {key}")]
    Missing {
        /// The name of the law.
        law: &'static str,
        /// The key.
        key: &'static str,
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

impl ScalarLawError {
    /// The key of a file that is wrong, if it is one alone.
    pub(crate) fn key(&self) -> Option<&'static str> {
        match self {
            Self::Number { .. } | Self::Distance { .. } => None,
            Self::Deviation { .. } => Some("sigma"),
            Self::Variance { .. } => Some("variance"),
            Self::Bounds { .. } => Some("high"),
            Self::NotPositive { .. } => Some("mean"),
            Self::Mode { .. } => Some("mode"),
            Self::Samples { .. } => Some("samples"),
            Self::Probability { .. } => Some("probability"),
            Self::Missing { key: field, .. } | Self::Shape { field, .. } => Some(field),
        }
    }
}

/// What a number must be that has to lie from one bound to another, either of which may be infinite.
fn allowed(low: f64, high: f64) -> String {
    match (low.is_finite(), high.is_finite()) {
        (true, true) => format!("between {low:?} and {high:?}"),
        (true, false) => format!("a finite number of at least {low:?}"),
        (false, true) => format!("a finite number of at most {high:?}"),
        (false, false) => "a finite number".to_owned(),
    }
}

#[cfg(test)]
mod tests;
