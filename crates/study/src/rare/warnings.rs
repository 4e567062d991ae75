//! Why an answer should not be trusted, as a value and in words.

use gyradius_statistics::{SteeredWarning, SubsetWarning, WeightWarning};
use serde::Serialize;

use super::{Rare, RareFailures, in_digits};

/// An interval that reaches so far is as wide as can be: the pilot looks for levels only if fewer of its first runs are the event.
const NOT_RARE: f64 = 0.1;

/// Why an answer should not be trusted, as far as the runs can show it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RareWarning {
    /// Failed runs would change the answer if they were the event.
    FailedRuns(RareFailures),
    /// What a subset simulation shows.
    #[serde(untagged)]
    Subset(SubsetWarning),
    /// What importance sampling shows.
    #[serde(untagged)]
    Importance(SteeredWarning),
}

impl Rare {
    /// Why not to trust it, in words.
    #[must_use]
    pub fn warnings_in_words(&self) -> Vec<String> {
        let words = |warning: &RareWarning| match warning {
            RareWarning::FailedRuns(failed) => self.of_failed(failed),
            RareWarning::Subset(warning) => self.of_subset(warning),
            RareWarning::Importance(warning) => self.of_scores(warning),
        };
        self.warnings().iter().map(words).collect()
    }

    fn of_failed(&self, failed: &RareFailures) -> String {
        let RareFailures { share, interval, nearer } = failed;
        let (p, quantity) = (self.estimate().probability(), self.event().quantity());
        let percent = 100.0 * interval.confidence().level();
        let (lower, upper) = (in_digits(interval.lower(), 3), in_digits(interval.upper(), 3));
        let all = if *share > 0.0 {
            format!(
                "{} of all runs ({percent} % interval: {lower} to {upper})",
                in_digits(*share, 3)
            )
        } else {
            format!("less than {upper} of all runs, with {percent} % confidence,")
        };
        let nearer = nearer.map(|nearer| {
            format!(", and {:.1} % of the runs nearer to the event,", 100.0 * nearer)
        });
        format!(
            "{all}{} failed and have no {quantity}, as where a simulation breaks down beyond some {quantity}: they are not counted as the \
             event, and the interval holds only if they are not the event; if they were, the probability would be up to {} ({} at \
             most, with {percent} % confidence)",
            nearer.unwrap_or_default(),
            in_digits((p + share).min(1.0), 3),
            in_digits((p + interval.upper()).min(1.0), 3)
        )
    }

    fn of_subset(&self, warning: &SubsetWarning) -> String {
        match warning {
            SubsetWarning::NotReached { replicas } => {
                let replicas = if *replicas == 1 {
                    "1 repetition".to_owned()
                } else {
                    format!("{replicas} repetitions")
                };
                if self.failed_runs().is_some() {
                    return format!("{replicas} found no event among the runs that did not fail");
                }
                format!(
                    "{replicas} found no event: it cannot be, or is rarer than --least, or one group alone must be as rare as the \
                     event; take more runs of a level"
                )
            }
            SubsetWarning::ChainsHardlyMove { acceptance } => {
                let stayed = format!(
                    "only {:.1} % of the redrawn runs stayed beyond the last level",
                    100.0 * acceptance
                );
                let estimate = self.estimate();
                if estimate.probability() == 0.0 && self.failed_runs().is_some() {
                    // What lies beyond it failed, and no group need be to blame.
                    return stayed;
                }
                let is_wide = estimate.interval().upper() >= NOT_RARE;
                let narrow = if is_wide { "" } else { ", and the interval may be too narrow" };
                format!(
                    "{stayed}: one group decides nearly alone{narrow}; take more runs of a level"
                )
            }
            SubsetWarning::ReplicasDiffer { coefficient } => format!(
                "the repetitions differ by {coefficient:.1} times the estimate: take more runs of a level"
            ),
        }
    }

    fn of_scores(&self, warning: &SteeredWarning) -> String {
        match warning {
            SteeredWarning::NotReached { searches } if self.failed_runs().is_some() => format!(
                "{searches} searches did not come to the event among the runs that did not fail: neither estimate nor interval should \
                 be trusted"
            ),
            SteeredWarning::NotReached { searches } => format!(
                "{searches} searches did not come to the event: it cannot be, or is rarer than --least, or what is drawn from its own law \
                 decides; neither estimate nor interval should be trusted; take --method subset, or more runs of a level"
            ),
            SteeredWarning::MoreWays { searches } => format!(
                "{searches} searches left open whether there are more ways to the event than they found: take more runs of a level, or \
                 --method subset"
            ),
            SteeredWarning::Weights(warning) => of_weights(warning),
        }
    }

    /// What is told of failed runs, if it is.
    pub(super) fn failed_runs(&self) -> Option<&RareFailures> {
        self.warnings().iter().find_map(|warning| match warning {
            RareWarning::FailedRuns(failed) => Some(failed),
            RareWarning::Subset(_) | RareWarning::Importance(_) => None,
        })
    }
}

fn of_weights(warning: &WeightWarning) -> String {
    match warning {
        WeightWarning::NoHit => {
            "no run of the sample is the event: its probability is not known".to_owned()
        }
        WeightWarning::FewEffectiveHits { effective } => format!(
            "the runs that are the event are worth only {effective:.1} of equal weight: neither estimate nor interval should be \
             trusted; take a larger sample and more runs of a level, or --method subset"
        ),
        WeightWarning::OneHitDominates { share } => format!(
            "one run makes up {:.0} % of the estimate: another such run may change it by as much",
            100.0 * share
        ),
        WeightWarning::MeanWeightAboveOne { mean } => {
            format!("the mean of all weights is {mean:.2}, and should be 1: the weights are wrong")
        }
    }
}
