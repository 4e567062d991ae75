//! When to stop: a verdict that may be asked for after every run.

use crate::mixture::Mixture;
use crate::verdict::{Rule, Verdict};
use crate::{Acceptance, ConfidenceSequence, Interval, StatisticsError};

/// PLACEHOLDER
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

    /// The most failures with which the requirement is met if looked at after `runs` runs; none if there are too few runs.
    ///
    /// More than 10¹⁵ runs are taken for 10¹⁵.
    pub fn allowed_failures(&self, runs: u64) -> Option<u64> {
        self.allowed(runs)
    }

    /// The least failures with which the requirement is not met if looked at after `runs` runs; none if there are too few
    /// runs.
    ///
    /// More than 10¹⁵ runs are taken for 10¹⁵.
    pub fn refused_failures(&self, runs: u64) -> Option<u64> {
        self.refused(runs)
    }

    /// The least runs that allow so many failures; none if they are more than 10¹⁵.
    pub fn least_runs(&self, failures: u64) -> Option<u64> {
        Rule::least_runs(self, failures)
    }

    /// What so many failures in so many runs decide: stop, or go on.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Failures`] if there are more failures than runs, or more than 10⁹ runs.
    pub fn verdict(&self, failures: u64, runs: u64) -> Result<Verdict, StatisticsError> {
        self.judge(failures, runs)
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
