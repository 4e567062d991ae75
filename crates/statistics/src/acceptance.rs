//! How many failures a number of runs allows, and what that means for whom.

use crate::error::{probability, share};
use crate::verdict::{MAX_PLANNED, Rule, judged};
use crate::{Confidence, StatisticsError, law};

/// A requirement that at least a share p of the flights succeed, with confidence c, which a number of runs that was
/// chosen **beforehand** decides: acceptance sampling by attributes.
///
/// With runs that succeed independently with the same probability, failures are binomial. The requirement is
/// *met* by k failures in n runs if `P(B(n, 1 − p) ≤ k) ≤ 1 − c`: a vehicle that is just not good enough passes with
/// a probability of 1 − c at most, the **consumer's risk**. It is *not met* if `P(B(n, 1 − p) ≥ k) ≤ 1 − c`: a vehicle
/// that is just good enough is refused with a probability of 1 − c at most. These are the one-sided tests whose
/// inversion is the interval of Clopper & Pearson (1934, doi:10.1093/biomet/26.4.404), and for no failures the
/// number of runs is that of Wilks (1941, doi:10.1214/aoms/1177731788). Between the two, neither is known.
///
/// A good vehicle too can see more failures than allowed: the [`producers_risk`](Self::producers_risk).
///
/// The verdict keeps its risk only if runs are counted once. Who looks again and again, and stops at the first
/// success, uses [`SequentialAcceptance`](crate::SequentialAcceptance).
///
/// Runs of one vehicle are not independent. Where vehicles fly several times each, count one run of each, or count
/// vehicles.
///
/// Tails of the binomial law are incomplete beta functions, with a relative error of some 1e-11 up to 10⁹ runs. A tail that is
/// larger than 1 − c by a part in 10¹² or less counts as equal, so that 0.1 is one in ten. Of p = 1 − 10⁻⁹ a float knows
/// 1 − p to a part in 10⁷. More than 10¹⁵ runs are taken for 10¹⁵.
///
/// ```
/// use gyradius_statistics::{Acceptance, Confidence};
///
/// let rule = Acceptance::new(0.9973, Confidence::new(0.9)?)?;
/// assert_eq!([0, 1, 2, 3].map(|k| rule.least_runs(k)), [852, 1440, 1970, 2473].map(Some));
/// assert_eq!(rule.allowed_failures(2000), Some(2));
/// // A vehicle that succeeds in 99.85 % of its flights does not pass 2,000 runs 58 % of the time …
/// assert!((rule.producers_risk(2000, 0.9985)? - 0.58).abs() < 0.005);
/// // … and one that passes nine times in ten succeeds in 99.945 %.
/// assert!((rule.success_to_pass(2000, 0.9)?.unwrap() - 0.99945).abs() < 5e-6);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, getset::CopyGetters)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, remote = "Self")
)]
#[getset(get_copy = "pub")]
pub struct Acceptance {
    /// The share of flights that must succeed, p.
    probability: f64,
    /// The confidence, c.
    confidence: Confidence,
}

crate::checked::checked!(Acceptance, |read| Acceptance::new(read.probability, read.confidence)
    .map(drop));

impl Acceptance {
    /// At least a share `probability` of the flights succeeds, with this confidence.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Share`] unless the probability is between 1e-9 and 1 − 1e-9,
    /// [`StatisticsError::DecidingConfidence`] if the confidence is below one half, with which a requirement could be met
    /// and not met at once.
    pub fn new(probability: f64, confidence: Confidence) -> Result<Self, StatisticsError> {
        let probability = share(probability)?;
        if confidence.level() < 0.5 {
            return Err(StatisticsError::DecidingConfidence { value: confidence.level() });
        }
        Ok(Self { probability, confidence })
    }

    /// The share of flights that may fail, 1 − p.
    pub fn failure_share(&self) -> f64 {
        1.0 - self.probability
    }

    /// The probability that a vehicle which succeeds in a share `success` of its flights fails to pass `runs` runs:
    /// that it sees more failures than allowed. 1 if there are too few runs.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Probability`] unless `0 ≤ success ≤ 1`.
    pub fn producers_risk(&self, runs: u64, success: f64) -> Result<f64, StatisticsError> {
        let (success, runs) = (probability(success)?, runs.min(MAX_PLANNED));
        Ok(self.allowed(runs).map_or(1.0, |allowed| {
            if success == 1.0 {
                return 0.0;
            }
            law::at_least(allowed + 1, runs, 1.0 - success, success)
        }))
    }

    /// The probability that a vehicle which is just not good enough passes `runs` runs, at most 1 − c; 0 if there are
    /// too few runs.
    pub fn consumers_risk(&self, runs: u64) -> f64 {
        let runs = runs.min(MAX_PLANNED);
        self.allowed(runs).map_or(0.0, |allowed| self.at_most(allowed, runs))
    }

    /// The share of its flights in which a vehicle must succeed to pass `runs` runs with the probability `power`, as 0.9
    /// for nine times in ten; none if there are too few runs.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Probability`] unless `0 ≤ power ≤ 1`.
    pub fn success_to_pass(&self, runs: u64, power: f64) -> Result<Option<f64>, StatisticsError> {
        let (power, runs) = (probability(power)?, runs.min(MAX_PLANNED));
        Ok(self.allowed(runs).map(|allowed| {
            if power == 0.0 {
                return 0.0;
            }
            if power == 1.0 {
                return 1.0;
            }
            let (a, b) = ((allowed + 1) as f64, (runs - allowed) as f64);
            1.0 - law::beta_lower(1.0 - power, a, b)
        }))
    }

    /// The probability of so many failures or fewer, if the vehicle is just not good enough.
    fn at_most(&self, failures: u64, runs: u64) -> f64 {
        law::at_least(runs - failures, runs, self.probability, self.failure_share())
    }

    /// 1 − c, and what rounding may add to it.
    pub(crate) fn risk(&self) -> f64 {
        (1.0 - self.confidence.level()) * (1.0 + law::ROUNDING)
    }
}

judged!(Acceptance);

impl Rule for Acceptance {
    fn failure_share(&self) -> f64 {
        self.failure_share()
    }

    fn met(&self, failures: u64, runs: u64) -> bool {
        self.at_most(failures, runs) <= self.risk()
    }

    fn not_met(&self, failures: u64, runs: u64) -> bool {
        law::at_least(failures, runs, self.failure_share(), self.probability) <= self.risk()
    }
}

#[cfg(test)]
mod tests;
