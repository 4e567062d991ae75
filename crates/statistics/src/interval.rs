//! Confidence levels and the intervals that carry them.

use std::fmt;

use crate::{StatisticsError, law};

/// A confidence level, strictly between 0 and 1; 0.95 by default.
///
/// The share of samples whose interval covers the true value, not a probability about the one
/// interval at hand.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "f64", into = "f64"))]
pub struct Confidence(f64);

impl Confidence {
    /// A level strictly between 0 and 1.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Confidence`] for any other number.
    pub fn new(level: f64) -> Result<Self, StatisticsError> {
        if level > 0.0 && level < 1.0 {
            Ok(Self(level))
        } else {
            Err(StatisticsError::Confidence { value: level })
        }
    }

    /// The level.
    pub fn level(self) -> f64 {
        self.0
    }

    /// How many standard errors an interval reaches to either side where the error is found from as many degrees of freedom
    /// (Student's t): NaN if these are not positive.
    pub fn errors(self, degrees_of_freedom: f64) -> f64 {
        if degrees_of_freedom > 0.0 {
            law::students_t(self.tail(), degrees_of_freedom)
        } else {
            f64::NAN
        }
    }

    /// The probability left to either side, `(1 − level)/2`.
    pub(crate) fn tail(self) -> f64 {
        (1.0 - self.0) / 2.0
    }
}

impl Default for Confidence {
    fn default() -> Self {
        Self(0.95)
    }
}

impl TryFrom<f64> for Confidence {
    type Error = StatisticsError;

    fn try_from(level: f64) -> Result<Self, StatisticsError> {
        Self::new(level)
    }
}

impl From<Confidence> for f64 {
    fn from(confidence: Confidence) -> f64 {
        confidence.0
    }
}

/// A two-sided confidence interval, both bounds included.
///
/// A bound is infinite where the sample is too small to give one, or where the bound is beyond
/// `f64`; a lower bound above the largest number is that number. JSON knows no infinity: `serde_json` writes `null`, which is read as no bound.
#[derive(Debug, Clone, Copy, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
#[getset(get_copy = "pub")]
pub struct Interval {
    /// The lower bound.
    lower: f64,
    /// The upper bound.
    upper: f64,
    /// The nominal confidence level.
    confidence: Confidence,
}

impl Interval {
    /// The interval from `lower` to `upper`.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Bounds`] unless `lower ≤ upper`, with a lower bound that is not `∞` and an upper one that is not
    /// `−∞`: no number lies beyond these.
    pub fn new(lower: f64, upper: f64, confidence: Confidence) -> Result<Self, StatisticsError> {
        if lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY {
            Ok(Self { lower, upper, confidence })
        } else {
            Err(StatisticsError::Bounds { lower, upper })
        }
    }

    /// Bounds known to be in order, but for rounding. What is above the largest `f64` is above its lower bound, and what is
    /// below the least, below its upper; a bound that is NaN is unknown.
    pub(crate) fn ordered(lower: f64, upper: f64, confidence: Confidence) -> Self {
        let lower = if lower.is_nan() { f64::NEG_INFINITY } else { lower };
        let upper = if upper.is_nan() { f64::INFINITY } else { upper };
        let (lower, upper) = if lower > upper { (upper, lower) } else { (lower, upper) };
        let (lower, upper) = (f64::MAX.min(lower), f64::MIN.max(upper));
        Self { lower, upper, confidence }
    }

    /// `centre ± half_width`; where both are infinite the bound between them is unknown.
    pub(crate) fn around(centre: f64, half_width: f64, confidence: Confidence) -> Self {
        Self::ordered(centre - half_width, centre + half_width, confidence)
    }

    /// `exp(ln(centre) ± half_width)`.
    pub(crate) fn around_log(centre: f64, half_width: f64, confidence: Confidence) -> Self {
        // Bounded, so that a centre beyond `f64` is never divided by infinity.
        let factor = half_width.exp().min(f64::MAX);
        Self::ordered(centre / factor, centre * factor, confidence)
    }

    /// The upper bound less the lower.
    pub fn width(&self) -> f64 {
        self.upper - self.lower
    }

    /// Whether `value` lies between the bounds or on one.
    pub fn contains(&self, value: f64) -> bool {
        (self.lower..=self.upper).contains(&value)
    }
}

/// `[lower, upper]`, with the precision asked for.
impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("[")?;
        self.lower.fmt(f)?;
        f.write_str(", ")?;
        self.upper.fmt(f)?;
        f.write_str("]")
    }
}

/// What is read before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Unchecked {
    lower: Option<f64>,
    upper: Option<f64>,
    confidence: Confidence,
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for Interval {
    type Error = StatisticsError;

    fn try_from(raw: Unchecked) -> Result<Self, StatisticsError> {
        let lower = raw.lower.unwrap_or(f64::NEG_INFINITY);
        Self::new(lower, raw.upper.unwrap_or(f64::INFINITY), raw.confidence)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn levels_outside_the_open_unit_interval_are_refused() {
        for level in [0.0, 1.0, -0.1, 95.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Confidence::new(level), Err(StatisticsError::Confidence { .. })));
        }
        assert_eq!(Confidence::default(), Confidence::new(0.95).unwrap());
        assert_eq!(f64::from(Confidence::try_from(0.5).unwrap()), 0.5);
    }

    /// Table of Student's t, NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2.
    #[test]
    fn errors_are_those_of_students_t() {
        for (freedom, expected) in [(1.0, 12.706), (2.0, 4.303), (11.0, 2.201), (100.0, 1.984)] {
            let errors = Confidence::default().errors(freedom);
            assert!((errors - expected).abs() < 5e-4, "{freedom}: {errors}");
        }
        // From 1e6 on the next term of the expansion in one over the degrees of freedom is below 1e-11.
        for level in [0.5, 0.9, 0.95, 0.999] {
            let confidence = Confidence::new(level).unwrap();
            let z = law::normal(confidence.tail());
            for exponent in 6..=308 {
                let freedom = 10_f64.powi(exponent);
                let expected = z + (z * z * z + z) / (4.0 * freedom);
                let found = confidence.errors(freedom);
                assert!(
                    (found / expected - 1.0).abs() < 1e-9,
                    "{level} {freedom:e}: {found} {expected}"
                );
            }
            assert_eq!(confidence.errors(f64::INFINITY), z);
        }
        for freedom in [0.0, -1.0, f64::NAN] {
            assert!(Confidence::default().errors(freedom).is_nan());
        }
    }

    #[test]
    fn display_follows_the_precision() {
        let interval = Interval::new(1.0, 2.5, Confidence::default()).unwrap();
        assert_eq!(format!("{interval:.2}"), "[1.00, 2.50]");
    }

    #[test]
    fn infinite_centre_and_width_leave_the_bound_open() {
        let interval = Interval::around(f64::INFINITY, f64::INFINITY, Confidence::default());
        assert_eq!((interval.lower(), interval.upper()), (f64::NEG_INFINITY, f64::INFINITY));
    }

    proptest! {
        #[test]
        fn an_interval_is_in_order_or_refused(
            lower in prop::num::f64::ANY,
            upper in prop::num::f64::ANY,
        ) {
            match Interval::new(lower, upper, Confidence::default()) {
                Ok(interval) => {
                    prop_assert!(lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY);
                    prop_assert!(interval.contains(lower) && interval.contains(upper));
                }
                Err(_) => prop_assert!(
                    !(lower <= upper) || lower == f64::INFINITY || upper == f64::NEG_INFINITY
                ),
            }
        }

        /// Whatever two bounds are computed, an interval of them is one that its constructor takes.
        #[test]
        fn what_is_computed_is_an_interval(lower in prop::num::f64::ANY, upper in prop::num::f64::ANY) {
            let confidence = Confidence::default();
            for [lower, upper] in [[lower, upper], [f64::NAN, upper], [lower, f64::NAN], [f64::NAN; 2]] {
                let made = Interval::ordered(lower, upper, confidence);
                prop_assert_eq!(Interval::new(made.lower(), made.upper(), confidence), Ok(made));
            }
        }

        /// Whatever a sample and the confidence, also where that is so low that both bounds are one number.
        #[test]
        fn intervals_are_in_order_at_any_confidence(
            sample in prop::collection::vec(prop_oneof![-9.0..9.0_f64, prop::num::f64::NORMAL], 5..40),
            other in prop::collection::vec(prop_oneof![-9.0..9.0_f64, prop::num::f64::NORMAL], 5..40),
            power in -300.0..0.0_f64,
            p in 0.0..=1.0_f64,
        ) {
            use crate::{Deviation, Moments, Proportion, SortedSample};
            let (n, m) = (sample.len() as u64, other.len() as u64);
            let moments = [&sample, &other].map(|x| Moments::new(x).ok());
            let deviations = [&sample, &other].map(|x| Deviation::new(x).ok());
            let low = 10_f64.powf(power);
            for level in [low, 1e-16, 5e-17, 5e-324, 0.5, 1.0 - low, 1.0 - 1e-16] {
                let Ok(confidence) = Confidence::new(level) else { continue };
                let mut intervals = vec![
                    SortedSample::new(&sample).unwrap().quantile_interval(p, confidence).unwrap(),
                    Proportion::new(n.min(m), n.max(m)).unwrap().interval(confidence),
                ];
                if let [Some(x), Some(y)] = &moments {
                    intervals.extend([x.mean_interval(confidence), x.normal_deviation_interval(confidence)]);
                    intervals.push(x.mean_difference_interval(y, confidence));
                    intervals.extend(x.normal_ratio_interval(y, confidence));
                }
                if let [Some(x), Some(y)] = &deviations {
                    intervals.extend(x.interval(confidence));
                    intervals.extend(x.ratio_interval(y, confidence));
                    intervals.extend(x.pooled_ratio_interval(y, confidence));
                }
                for interval in intervals {
                    let again = Interval::new(interval.lower(), interval.upper(), confidence);
                    prop_assert_eq!(again, Ok(interval), "{}", level);
                }
            }
        }
    }

    #[cfg(feature = "serde")]
    mod serde {
        use super::*;

        #[test]
        fn json_round_trips_and_is_checked() {
            let interval = Interval::new(1.0, 2.5, Confidence::default()).unwrap();
            let text = serde_json::to_string(&interval).unwrap();
            assert_eq!(text, r#"{"lower":1.0,"upper":2.5,"confidence":0.95}"#);
            assert_eq!(serde_json::from_str::<Interval>(&text).unwrap(), interval);
            // JSON knows no infinity.
            let open = (f64::NEG_INFINITY, f64::INFINITY);
            for (lower, upper) in [(1.0, f64::INFINITY), (f64::NEG_INFINITY, 1.0), open] {
                let interval = Interval::new(lower, upper, Confidence::default()).unwrap();
                let text = serde_json::to_string(&interval).unwrap();
                assert_eq!(serde_json::from_str::<Interval>(&text).unwrap(), interval);
            }
            for bad in [
                r#"{"lower":3.0,"upper":2.5,"confidence":0.95}"#,
                r#"{"lower":1.0,"upper":2.5,"confidence":95.0}"#,
            ] {
                assert!(serde_json::from_str::<Interval>(bad).is_err());
            }
        }
    }
}
