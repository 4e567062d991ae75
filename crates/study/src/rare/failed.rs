//! Runs that failed while an event was looked for: nobody knows whether they would have been the event.

use gyradius_statistics::{Confidence, ImportanceSampling, Interval, Proportion, StatisticsError};
use serde::Serialize;

/// From this share on, failures among the runs nearer to an event that was found are told of.
const MANY: f64 = 0.05;

/// Runs that failed and have no number of the event's quantity, where they are many enough to change the answer if they were the event:
/// as where a simulation breaks down beyond some value of the quantity.
///
/// It is told if the estimate and the least share of them together are beyond the interval, or if runs nearer to the event fail surely more
/// often than others: any where no event was found, and for subset simulation a twentieth of them or more. Runs that have no number and did not fail, as of
/// bodies that do not meet, do not count: of these it is known that they are not the event.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RareFailures {
    /// The share of them among all runs.
    pub share: f64,
    /// Its interval.
    pub interval: Interval,
    /// Their share among the runs nearer to the event, if it is surely larger.
    pub nearer: Option<f64>,
}

/// Counts of runs, and of those among them that failed and have no number.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    runs: u64,
    failed: u64,
}

impl Counts {
    /// Counts runs, of each of which is told whether it failed and has no number.
    pub(super) fn add(&mut self, failed: &[bool]) {
        self.runs += failed.len() as u64;
        self.failed += failed.iter().filter(|failed| **failed).count() as u64;
    }

    /// The share that failed and its interval; none without a run.
    fn share(self) -> Result<Option<(f64, Interval)>, StatisticsError> {
        if self.runs == 0 {
            return Ok(None);
        }
        let share = Proportion::new(self.failed, self.runs)?;
        Ok(Some((share.value(), share.interval(Confidence::default()))))
    }
}

/// What is known of the failures.
#[derive(Clone, Debug, Default)]
pub(super) struct Failures {
    /// Of plain runs.
    pub(super) plain: Counts,
    /// Of runs nearer to the event: those of later levels, and of the sample.
    pub(super) nearer: Counts,
    /// The runs of each law that was steered to, those of the searches and of the sample, with their weights and those that failed as hits.
    pub(super) weighted: Vec<ImportanceSampling>,
}

impl Failures {
    /// What is to be told of them beside an estimate and its interval.
    pub(super) fn beside(
        self,
        probability: f64,
        interval: Interval,
    ) -> Result<Option<RareFailures>, StatisticsError> {
        let mut told = Vec::from_iter(self.plain.share()?);
        for runs in &self.weighted {
            let all = runs.finish(Confidence::default())?;
            told.extend((all.hits() > 0).then(|| (all.probability(), all.interval())));
        }
        // Plain runs know failures anywhere better, steered ones those that are rare and near the event. What was steered away from them, as
        // the sample is once runs that fail are no events, sees few of them, so that any of these counts that has seen enough.
        let matters = |(share, all): &(f64, Interval)| {
            *share > 0.0 && probability + all.lower() > interval.upper()
        };
        let order =
            |(share, all): &(f64, Interval)| (!matters(&(*share, *all)), all.upper() / all.lower());
        let told = told.into_iter().min_by(|a, b| {
            let (a, b) = (order(a), order(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        let Some((share, of_all)) = told else { return Ok(None) };
        let nearer = self.nearer.share()?;
        let nearer = nearer.filter(|(_, nearer)| nearer.lower() > of_all.upper());
        let nearer = nearer.map(|(share, _)| share);
        let more = nearer.is_some_and(|nearer| {
            // Weights tell how much failures near the event amount to, chains do not.
            probability == 0.0 || (self.weighted.is_empty() && nearer >= MANY)
        });
        let is_told = matters(&(share, of_all)) || more;
        Ok(is_told.then_some(RareFailures { share, interval: of_all, nearer }))
    }
}
