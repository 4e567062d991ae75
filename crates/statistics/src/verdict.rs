//! What a number of failures among a number of runs decides, and how many more runs would decide it.

use crate::{StatisticsError, error, law};

/// The most runs that are planned for: as a float, each number of runs up to here is exact.
pub(crate) const MAX_PLANNED: u64 = 1_000_000_000_000_000;

/// How many failures before those that are enough from there on may be enough as well, at most.
const SHORTLY: f64 = 256.0;

/// Whether a requirement "at least a share p of the flights succeed, with confidence c" is met.
///
/// ```
/// use gyradius_statistics::{Acceptance, Confidence, Verdict};
///
/// let rule = Acceptance::new(0.9973, Confidence::new(0.9)?)?;
/// assert_eq!(rule.verdict(2, 2000)?, Verdict::Met);
/// assert_eq!(rule.verdict(12, 2000)?, Verdict::NotMet);
/// // 2,473 runs allow 3 failures, and 3,899 runs the 6 that will be seen if 3 fail in each 2,000.
/// let undecided = Verdict::Undecided { if_no_more_fail: Some(473), at_this_rate: Some(1899) };
/// assert_eq!(rule.verdict(3, 2000)?, undecided);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Verdict {
    /// The true share of successes is at least p, with confidence c: if it were less, so few failures would be seen
    /// with a probability of 1 − c at most.
    Met,
    /// The true share of successes is below p, with confidence c: if it were p or more, so many failures would be
    /// seen with a probability of 1 − c at most.
    NotMet,
    /// Neither can be said yet.
    Undecided {
        /// The least number of further runs after which the requirement is met, if none of them fails; none if they
        /// are more than 10¹⁵.
        if_no_more_fail: Option<u64>,
        /// The least number of further runs after which the requirement is met, if the share of failures stays as it is,
        /// counted up to whole failures. None if it is never met then, as the share of failures is 1 − p or more or
        /// so near to it that 10¹⁵ runs do not do, and if there are no runs yet. Nearer to it than by one percent of it, a
        /// number that is enough.
        at_this_rate: Option<u64>,
    },
}

/// When a requirement is met, and when it is not.
pub(crate) trait Rule {
    /// The largest share of failures with which the requirement is met.
    fn failure_share(&self) -> f64;

    /// Whether so many failures in so many runs show that it is met. Fewer failures or more runs do so too.
    fn met(&self, failures: u64, runs: u64) -> bool;

    /// Whether so many failures in so many runs show that it is not met. More failures or fewer runs do so too.
    fn not_met(&self, failures: u64, runs: u64) -> bool;

    /// The most failures with which it is met after so many runs; none if there are too few runs.
    fn allowed(&self, runs: u64) -> Option<u64> {
        let runs = runs.min(MAX_PLANNED);
        law::first(0, runs, |failures| !self.met(failures, runs)).checked_sub(1)
    }

    /// The least failures with which it is not met after so many runs; none if there are too few runs.
    fn refused(&self, runs: u64) -> Option<u64> {
        let runs = runs.min(MAX_PLANNED);
        let failures = law::first(1, runs, |failures| self.not_met(failures, runs));
        (failures <= runs).then_some(failures)
    }

    /// The least runs after which it is met with so many failures; none if they are more than can be planned.
    fn least_runs(&self, failures: u64) -> Option<u64> {
        if failures >= MAX_PLANNED {
            return None;
        }
        let runs = law::first(failures + 1, MAX_PLANNED, |runs| self.met(failures, runs));
        (runs <= MAX_PLANNED).then_some(runs)
    }

    /// What so many failures in so many runs decide.
    fn judge(&self, failures: u64, runs: u64) -> Result<Verdict, StatisticsError> {
        error::failures(failures, runs)?;
        if self.met(failures, runs) {
            return Ok(Verdict::Met);
        }
        if self.not_met(failures, runs) {
            return Ok(Verdict::NotMet);
        }
        let further = |least: Option<u64>| least.map(|least| least.saturating_sub(runs));
        Ok(Verdict::Undecided {
            if_no_more_fail: further(self.least_runs(failures)),
            at_this_rate: further(self.at_rate(failures, runs)),
        })
    }

    /// The runs after which it is met if failures go on at the rate of so many in so many runs.
    fn at_rate(&self, failures: u64, runs: u64) -> Option<u64> {
        if !((failures as f64) < self.failure_share() * runs as f64) {
            return None;
        }
        // Have no more failures than that been seen when so many are allowed? From some number on, for what is
        // allowed approaches 1 − p of the runs.
        let enough = |allowed: u64| {
            self.least_runs(allowed).is_none_or(|least| {
                u128::from(least) * u128::from(failures) <= u128::from(allowed) * u128::from(runs)
            })
        };
        let mut step = 1;
        while !enough(failures + step) {
            step *= 2;
        }
        // Whole failures make it true now and then shortly before, the longer the nearer the rate is to the share.
        let from_there = law::first(failures + step / 2, failures + step, enough);
        let rate = failures as f64 / (self.failure_share() * runs as f64);
        let shortly = (16.0 + 4.0 / (1.0 - rate)).min(SHORTLY) as u64;
        let mut before = from_there.saturating_sub(shortly).max(failures)..from_there;
        self.least_runs(before.find(|allowed| enough(*allowed)).unwrap_or(from_there))
    }
}

/// What a rule is asked for, with the name of the rule.
macro_rules! judged {
    ($rule:ident) => {
        impl $rule {
            /// The most failures with which the requirement is met after `runs` runs; none if there are too few runs.
            ///
            /// More than 10¹⁵ runs are taken for 10¹⁵.
            pub fn allowed_failures(&self, runs: u64) -> Option<u64> {
                self.allowed(runs)
            }

            /// The least failures with which the requirement is not met after `runs` runs; none if there are too few runs.
            ///
            /// More than 10¹⁵ runs are taken for 10¹⁵.
            pub fn refused_failures(&self, runs: u64) -> Option<u64> {
                self.refused(runs)
            }

            /// The least runs that allow so many failures; none if they are more than 10¹⁵.
            pub fn least_runs(&self, failures: u64) -> Option<u64> {
                Rule::least_runs(self, failures)
            }

            /// What so many failures in so many runs decide.
            ///
            /// # Errors
            ///
            /// [`StatisticsError::Failures`] if there are more failures than runs, or more than 10⁹ runs.
            pub fn verdict(
                &self,
                failures: u64,
                runs: u64,
            ) -> Result<$crate::Verdict, StatisticsError> {
                self.judge(failures, runs)
            }
        }
    };
}
pub(crate) use judged;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Acceptance, Confidence};

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        /// Counted one by one: the first number of runs that is met with the share of failures so far, rounded up.
        #[test]
        fn the_least_runs_at_this_rate_are_the_least(
            share in 0.3..0.99_f64,
            confidence in 0.5..0.99_f64,
            runs in 1..200_u64,
            failed in 0.0..0.99_f64,
        ) {
            let rule = Acceptance::new(share, Confidence::new(confidence).unwrap()).unwrap();
            let failures = (failed * (1.0 - share) * runs as f64) as u64;
            if let Verdict::Undecided { at_this_rate: Some(more), .. } = rule.verdict(failures, runs).unwrap() {
                let met = |total: u64| {
                    rule.met((total * failures).div_ceil(runs), total)
                };
                prop_assert!(met(runs + more));
                let least = (runs..runs + more).find(|total| met(*total));
                prop_assert_eq!(least, None);
            }
        }
    }
}
