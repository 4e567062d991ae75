//! The rule that decides a requirement: one look at the runs, or any number of them.

use gyradius_statistics::{
    Acceptance, ConfidenceSequence, Interval, Proportion, SequentialAcceptance, StatisticsError,
    Tolerance, ToleranceSide, Verdict,
};
use serde::{Deserialize, Serialize};

use super::Requirement;

/// Power for which it is told how good a vehicle must be.
const NINE_TIMES_IN_TEN: f64 = 0.9;

/// How often runs are looked at before a verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Looks {
    /// Once, after a number of runs that was stated before.
    #[default]
    Once,
    /// Any number of times, what is seen deciding whether to go on.
    Often,
}

/// The rule that decides a requirement.
#[derive(Clone, Copy, Debug)]
pub(super) enum Deciding {
    Once(Acceptance),
    Often(SequentialAcceptance),
}

/// Asks the same of either rule.
macro_rules! of_either {
    ($any:expr, $rule:ident => $asked:expr) => {
        match $any {
            Deciding::Once($rule) => $asked,
            Deciding::Often($rule) => $asked,
        }
    };
}

impl Looks {
    /// Whether it is one.
    pub(super) fn is_once(&self) -> bool {
        *self == Self::Once
    }
}

impl Deciding {
    pub(super) fn new(requirement: &Requirement, looks: Looks) -> Result<Self, StatisticsError> {
        Ok(match looks {
            Looks::Once => Self::Once(requirement.acceptance()?),
            Looks::Often => Self::Often(requirement.sequential()?),
        })
    }

    pub(super) fn verdict(self, failures: u64, runs: u64) -> Result<Verdict, StatisticsError> {
        of_either!(self, rule => rule.verdict(failures, runs))
    }

    pub(super) fn allowed_failures(self, runs: u64) -> Option<u64> {
        of_either!(self, rule => rule.allowed_failures(runs))
    }

    pub(super) fn tolerance(self, side: ToleranceSide, values: u64, failed: u64) -> Tolerance {
        of_either!(self, rule => rule.tolerance(side, values, failed))
    }

    /// In which share of its runs a vehicle must keep the requirement, to pass nine times in ten so many; none if it may be
    /// looked at often, so that nobody knows after how many runs.
    pub(super) fn success_to_pass(self, runs: u64) -> Result<Option<f64>, StatisticsError> {
        match self {
            Self::Once(rule) => rule.success_to_pass(runs, NINE_TIMES_IN_TEN),
            Self::Often(_) => Ok(None),
        }
    }

    /// Where the share of the runs lies that keep it; none if there are no runs.
    pub(super) fn kept(
        self,
        failures: u64,
        runs: u64,
    ) -> Result<Option<Interval>, StatisticsError> {
        (runs > 0).then(|| self.share(runs - failures, runs)).transpose()
    }

    /// Where the share of so many events lies.
    pub(super) fn share(self, events: u64, runs: u64) -> Result<Interval, StatisticsError> {
        match self {
            Self::Once(rule) => Ok(Proportion::new(events, runs)?.interval(rule.confidence())),
            Self::Often(rule) => {
                let confidence = rule.requirement().confidence();
                ConfidenceSequence::new(confidence).interval(events, runs)
            }
        }
    }
}
