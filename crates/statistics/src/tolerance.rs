//! Which values of a sample bound a share of the law that it was drawn from.

use crate::{Acceptance, SequentialAcceptance, SortedSample, verdict::Rule};

/// On which side values are bounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum ToleranceSide {
    /// From above: a share of the law is at most the bound.
    AtMost,
    /// From below: a share of the law is at least the bound.
    AtLeast,
    /// From both sides: a share of the law is between the bounds.
    Between,
}

/// Which order statistics bound a share p of a law with confidence c, whatever the law.
///
/// If k failures are [allowed](Acceptance::allowed_failures) among n runs, the value k + 1 from the top is a bound
/// from above, the value k + 1 from the bottom one from below (Wilks 1941, doi:10.1214/aoms/1177731788; David &
/// Nagaraja 2003, *Order Statistics*, ch. 7, doi:10.1002/0471722162). A requirement is met by
/// [`verdict`](Acceptance::verdict) exactly if that bound keeps the limit. For a bound from both sides, k + 1 values are
/// counted off in all, from the top and from the bottom by turns: it is a little stricter than a count of failures, for
/// both bounds must stand inside, while failures may lie on either side.
///
/// A failed run has no value. It counts as one beyond any limit: as the greatest from above, as the least from below,
/// and from both sides as one of the k + 1 that are counted off first. What is counted off next may depend on what
/// has been (Fraser 1953, Ann. Math. Statist. 24, 44).
///
/// The law may have any form, with ties and steps too. It is one law, of independent runs.
///
/// ```
/// use gyradius_statistics::{Acceptance, Confidence, SortedSample, Tolerance, ToleranceSide};
///
/// let rule = Acceptance::new(0.95, Confidence::new(0.95)?)?;
/// let values: Vec<f64> = (1..=99).map(f64::from).collect();
/// // 100 runs, of which one failed: two failures are allowed from 124 on, one from 93 on. So the failed run is the
/// // one, and the greatest value is the bound.
/// let tolerance = rule.tolerance(ToleranceSide::AtMost, 99, 1);
/// let bounds = tolerance.bounds(&SortedSample::new(&values)?);
/// assert_eq!(bounds, Some((f64::NEG_INFINITY, 99.0)));
/// let none = rule.tolerance(ToleranceSide::AtMost, 98, 2);
/// assert_eq!(none, Tolerance::TooFewRuns { needed: Some(124) });
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", remote = "Self"))]
pub enum Tolerance {
    /// The bounds are these of the values in increasing order.
    Ranks {
        /// The rank of the lower bound, from 1; none if values are bounded from above alone.
        lower: Option<u64>,
        /// The rank of the upper bound, from 1; none if values are bounded from below alone.
        upper: Option<u64>,
        /// The probability that such bounds hold the share: exactly for a law without steps, else at least. It is
        /// the confidence asked for or more.
        confidence: f64,
    },
    /// There are too few runs for that many that failed: no value is a bound.
    TooFewRuns {
        /// The least runs in all that give a bound, if no further run fails; none if they are more than 10¹⁵.
        needed: Option<u64>,
    },
}

impl Tolerance {
    /// The bounds, infinite where there is none on that side; none without a bound, and if the sample has not so
    /// many values.
    pub fn bounds(&self, sample: &SortedSample) -> Option<(f64, f64)> {
        let at = |rank: Option<u64>, open: f64| match rank {
            Some(rank) => sample.values().get(usize::try_from(rank).ok()?.checked_sub(1)?).copied(),
            None => Some(open),
        };
        match *self {
            Self::Ranks { lower, upper, .. } => {
                Some((at(lower, f64::NEG_INFINITY)?, at(upper, f64::INFINITY)?))
            }
            Self::TooFewRuns { .. } => None,
        }
    }
}

impl Acceptance {
    /// Which of `values` values, besides `failed` runs without one, bound the share p with confidence c.
    pub fn tolerance(&self, side: ToleranceSide, values: u64, failed: u64) -> Tolerance {
        let runs = values.saturating_add(failed);
        let level = self.confidence().level();
        // What was allowed has a risk of 1 − c at most: only the difference from 1 rounds below c.
        ranks(self, side, [values, failed], || (1.0 - self.consumers_risk(runs)).max(level))
    }
}

impl SequentialAcceptance {
    /// Which of `values` values, besides `failed` runs without one, bound the share p with confidence c, however often it
    /// is asked: the bounds after all numbers of runs hold together.
    pub fn tolerance(&self, side: ToleranceSide, values: u64, failed: u64) -> Tolerance {
        ranks(self, side, [values, failed], || self.requirement().confidence().level())
    }
}

crate::checked::checked!(Tolerance, |read| {
    let together = match *read {
        Tolerance::Ranks { lower, upper, confidence } => {
            let rising = match (lower, upper) {
                (Some(lower), Some(upper)) => 1 <= lower && lower <= upper,
                (Some(rank), None) | (None, Some(rank)) => 1 <= rank,
                (None, None) => false,
            };
            rising && (0.0..=1.0).contains(&confidence)
        }
        Tolerance::TooFewRuns { needed } => needed != Some(0),
    };
    crate::error::belong(together, "tolerance")
});

/// The values that leave as many runs out as a rule allows to fail: they bound the share p whenever those that are beyond
/// the true bound would have met the requirement with a risk of 1 − c at most.
fn ranks(
    rule: &impl Rule,
    side: ToleranceSide,
    [values, failed]: [u64; 2],
    confidence: impl Fn() -> f64,
) -> Tolerance {
    let runs = values.saturating_add(failed);
    // One is counted off on each side that is bounded, at least.
    let spare = match side {
        ToleranceSide::AtMost | ToleranceSide::AtLeast => 0,
        ToleranceSide::Between => 1,
    };
    let left = |allowed: u64| allowed.checked_sub(failed).filter(|&left| left >= spare);
    let Some(left) = rule.allowed(runs).and_then(left) else {
        return Tolerance::TooFewRuns { needed: rule.least_runs(failed.saturating_add(spare)) };
    };
    let (lower, upper) = match side {
        ToleranceSide::AtMost => (None, Some(values - left)),
        ToleranceSide::AtLeast => (Some(left + 1), None),
        ToleranceSide::Between => {
            let lower = left.div_ceil(2);
            (Some(lower), Some(values - (left - lower)))
        }
    };
    Tolerance::Ranks { lower, upper, confidence: confidence() }
}

#[cfg(test)]
mod tests;
