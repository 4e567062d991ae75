//! Subset simulation that draws one group of inputs anew at a time.

use gyradius_statistics::{
    Confidence, StatisticsError, SubsetEstimate, SubsetReplica, SubsetSimulation,
};
use std::sync::Arc;

use super::runs::EventRuns;
use crate::{ScenarioError, StudyError, groups::Drawing, subject::Subject};

/// With so many runs of a level and repetitions, down to this probability.
pub(super) fn find<C: Subject>(
    runs: &EventRuns<'_, C>,
    (per_level, replicas, least): (usize, usize, f64),
) -> Result<SubsetEstimate, StudyError> {
    let refused = |field: &str, error: StatisticsError| ScenarioError::field(field, error);
    let plan = SubsetSimulation::new(runs.groups().names().len(), per_level, replicas)
        .map_err(|error| refused("per-level, replicas", error))?;
    let plan = plan.with_least(least).map_err(|error| refused("least", error))?;
    runs.begin()?;
    let simulate = |replica: &mut SubsetReplica| {
        while !replica.is_done() {
            let draws: Arc<[Vec<u64>]> = replica.asks().into();
            let count = draws.len() as u64;
            replica.tell(&runs.excesses(Drawing::Given(draws), count)?)?;
        }
        Ok::<(), StudyError>(())
    };
    let mut pilot = plan.pilot();
    simulate(&mut pilot)?;
    let mut replicas = plan.replicas(&pilot)?;
    replicas.iter_mut().try_for_each(simulate)?;
    Ok(plan.finish(&pilot, &replicas, Confidence::default())?)
}
