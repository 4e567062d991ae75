//! When to stop: a verdict that may be asked for after every run.

use crate::mixture::Mixture;
use crate::verdict::{Rule, judged};
use crate::{Acceptance, ConfidenceSequence, Interval, StatisticsError};

/// A requirement that at least a share p of the flights succeed, with confidence c, decided by as many looks as one
/// likes.
///
/// Who looks at an [`Acceptance`] every 1,000 runs and stops at the first success accepts a vehicle that is just not
/// good enough in 25 % of the campaigns with 10 looks and in 45 % with 100, in the place of 10 % (p = 99.73 %, c = 90 %).
/// This rule keeps 1 − c for all looks together, whenever they are, however many, and whatever makes one stop or go on: blocks
/// of runs that are done, a study that is extended, an interval that is narrow enough. Rules that spend the risk
/// look by look need the looks and the greatest number of runs beforehand, and are not used for that reason.
///
/// The rule weighs the likelihood of all shares of failures u below ε = 1 − p, with the weights of a law π, against that of ε:
/// `∫ uᵏ(1−u)ⁿ⁻ᵏ dπ(u | u < ε) / (εᵏ(1−ε)ⁿ⁻ᵏ)`, after n runs with k failures. If the true share of failures is ε, this
/// evidence is a martingale of mean 1, if it is larger, a supermartingale: by Ville's inequality it ever reaches
/// 1/(1 − c) with a probability of 1 − c at most. There the requirement is *met*. The same of the shares above ε says when it
/// is *not met*, with a risk of 1 − c of its own, as with one look. (Tests of power one by mixtures: Robbins 1970,
/// doi:10.1214/aoms/1177696786; Robbins & Siegmund 1974, doi:10.1214/aos/1176342704; Howard, Ramdas, McAuliffe & Sekhon
/// 2021, doi:10.1214/20-AOS1991.) The law π is the beta law of mean ε whose lesser parameter is ½: Beta(½, ½ p/ε) for
/// p of one half and more. It was chosen for good vehicles, whose share of failures is a tenth to a half of ε.
///
/// The integrals are incomplete beta functions. The logarithm of the evidence has an error of 1e-9 at most up to 10⁹ runs.
///
/// Measured by 20,000 campaigns with p = 99.73 %, c = 90 % and the share of failures exactly at the limit: with 100
/// looks, one every 1,000 runs, 3.4 % are wrongly met and 3.0 % wrongly not met; with a look after each of the
/// 100,000 runs 9.2 % and 6.6 %.
///
/// | share of failures | one look that passes nine times in ten | this rule: mean | median | nine of ten campaigns |
/// |---|---|---|---|---|
/// | ε/16 | 1,440 runs | 1,280 runs | 1,068 | 2,111 |
/// | ε/4 | 2,473 runs | 2,371 runs | 2,111 | 4,935 |
///
/// At best 1,068 runs are enough, without failure, where one look needs 852. A vehicle whose share of failures is near the limit
/// may need any number of runs: exactly there, most campaigns never end. State a greatest number; a verdict
/// that is undecided then is no success.
///
/// ```
/// use gyradius_statistics::{Acceptance, Confidence, SequentialAcceptance, Verdict};
///
/// let rule = SequentialAcceptance::new(Acceptance::new(0.9973, Confidence::new(0.9)?)?);
/// // Failures so far, after 1,000, 2,000 and 3,000 runs.
/// let undecided = Verdict::Undecided { if_no_more_fail: Some(68), at_this_rate: Some(68) };
/// assert_eq!(rule.verdict(0, 1000)?, undecided);
/// assert!(matches!(rule.verdict(1, 2000)?, Verdict::Undecided { if_no_more_fail: Some(111), .. }));
/// assert_eq!(rule.verdict(1, 3000)?, Verdict::Met);
/// // From the first run on, the share of failures has been in each interval, with 90 % confidence for all of them.
/// assert!(rule.interval(1, 3000)?.upper() < 0.0027);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(transparent))]
pub struct SequentialAcceptance(Acceptance);

impl SequentialAcceptance {
    /// Of this requirement.
    pub fn new(requirement: Acceptance) -> Self {
        Self(requirement)
    }

    /// The requirement.
    pub fn requirement(&self) -> Acceptance {
        self.0
    }

    /// Where the share of failures lies after so many runs: an interval of the [`ConfidenceSequence`] about 1 − p.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Failures`] if there are more failures than runs, or more than 10⁹ runs.
    pub fn interval(&self, failures: u64, runs: u64) -> Result<Interval, StatisticsError> {
        let share = self.0.failure_share();
        ConfidenceSequence::about(share, self.0.confidence())?.interval(failures, runs)
    }

    /// Enough evidence, as a logarithm.
    fn enough(&self) -> f64 {
        -libm::log(self.0.risk())
    }
}

judged!(SequentialAcceptance);

impl Rule for SequentialAcceptance {
    fn failure_share(&self) -> f64 {
        self.0.failure_share()
    }

    fn met(&self, failures: u64, runs: u64) -> bool {
        let mixture = Mixture::about(self.0.failure_share());
        mixture.below(failures as f64, runs as f64) >= self.enough()
    }

    fn not_met(&self, failures: u64, runs: u64) -> bool {
        let mixture = Mixture::about(self.0.failure_share());
        mixture.above(failures as f64, runs as f64) >= self.enough()
    }
}

#[cfg(test)]
mod tests;
