//! An estimate with its interval.

use crate::Interval;

/// A number estimated from a sample, and the interval for what it estimates.
///
/// Nothing is clipped here: the estimate of an index that is 0 may be negative.
#[derive(Debug, Clone, Copy, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct Estimate {
    /// The estimate.
    value: f64,
    /// The interval.
    interval: Interval,
}

crate::checked::checked!(Estimate, |read| {
    crate::error::belong(read.interval.contains(read.value), "estimate")
});

impl Estimate {
    /// Of a value and an interval that holds it.
    pub(crate) fn new(value: f64, interval: Interval) -> Self {
        Self { value, interval }
    }

    /// The same with value and bounds moved into `lower` to `upper`, for figures and tables. If `lower` is not below
    /// `upper`, nothing is moved.
    #[must_use]
    pub fn clipped(&self, lower: f64, upper: f64) -> Self {
        if !(lower < upper) {
            return *self;
        }
        let (low, high) = (self.interval.lower(), self.interval.upper());
        let confidence = self.interval.confidence();
        let interval =
            Interval::ordered(low.clamp(lower, upper), high.clamp(lower, upper), confidence);
        Self { value: self.value.clamp(lower, upper), interval }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Confidence;

    #[test]
    fn clipping_moves_what_is_outside_and_nothing_else() {
        let interval = Interval::new(-0.2, 1.1, Confidence::default()).unwrap();
        let shown = Estimate::new(-0.1, interval).clipped(0.0, 1.0);
        assert_eq!(
            (shown.value(), shown.interval().lower(), shown.interval().upper()),
            (0.0, 0.0, 1.0)
        );
        let inside = Estimate::new(0.5, Interval::new(0.4, 0.6, Confidence::default()).unwrap());
        assert_eq!(inside.clipped(0.0, 1.0), inside);
        for (lower, upper) in [(1.0, 0.0), (f64::NAN, 1.0), (0.0, f64::NAN)] {
            assert_eq!(inside.clipped(lower, upper), inside);
        }
    }
}
