//! Shares of the runs, and counts of what there is.

use gyradius_statistics::{Confidence, Interval, Proportion, StatisticsError};
use serde::{Deserialize, Serialize};

/// A share of the runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// How many there are.
    pub count: u64,
    /// Of how many.
    pub of: u64,
    /// The one over the other.
    pub share: f64,
    /// Where the true share lies.
    pub interval: Interval,
}

impl Share {
    /// A share of runs that are not independent, with the interval that so many of so many independent runs give.
    ///
    /// # Errors
    /// There are more than runs, or no runs.
    pub fn of_dependent(
        count: u64,
        of: u64,
        independent: (u64, u64),
        confidence: Confidence,
    ) -> Result<Self, StatisticsError> {
        let share = Self::new(count, of, confidence)?;
        let interval = match independent {
            // Nothing is known.
            (_, 0) => Interval::new(0.0, 1.0, confidence)?,
            (count, of) => Proportion::new(count, of)?.interval(confidence),
        };
        Ok(Self { interval, ..share })
    }

    /// So many of so many runs.
    ///
    /// # Errors
    /// There are more than runs, or no runs.
    pub fn new(count: u64, of: u64, confidence: Confidence) -> Result<Self, StatisticsError> {
        let proportion = Proportion::new(count, of)?;
        let interval = proportion.interval(confidence);
        Ok(Self { count, of, share: proportion.value(), interval })
    }
}

/// What there is, each with how often, in the order in which it comes first.
#[must_use]
pub fn counted<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<(T, u64)> {
    let mut counts: Vec<(T, u64)> = Vec::new();
    for one in all {
        match counts.iter_mut().find(|(other, _)| *other == one) {
            Some((_, count)) => *count += 1,
            None => counts.push((one, 1)),
        }
    }
    counts
}
