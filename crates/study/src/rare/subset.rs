//! Subset simulation that draws one group of inputs anew at a time.

use gyradius_statistics::{
    Confidence, StatisticsError, SubsetEstimate, SubsetReplica, SubsetSimulation,
};
use std::sync::Arc;

use super::{failed::Failures, runs::EventRuns};
use crate::{ScenarioError, StudyError, groups::Drawing, subject::Subject};

/// With so many runs of a level and repetitions, down to this probability. Counts runs that fail.
pub(super) fn find<C: Subject>(
    runs: &EventRuns<'_, C>,
    (per_level, replicas, least): (usize, usize, f64),
    failures: &mut Failures,
) -> Result<SubsetEstimate, StudyError> {
    let refused = |field: &str, error: StatisticsError| ScenarioError::field(field, error);
    let plan = SubsetSimulation::new(runs.groups().names().len(), per_level, replicas)
        .map_err(|error| refused(wrong(per_level, replicas), error))?;
    let plan = plan.with_least(least).map_err(|error| refused("least", error))?;
    runs.begin()?;
    let mut simulate = |replica: &mut SubsetReplica| {
        while !replica.is_done() {
            let draws: Arc<[Vec<u64>]> = replica.asks().into();
            let count = draws.len() as u64;
            let outcomes = runs.outcomes(Drawing::Given(draws), count)?;
            let is_first = replica.evaluations() == 0;
            let level = if is_first { &mut failures.plain } else { &mut failures.nearer };
            level.add(&outcomes.failed);
            replica.tell(&outcomes.excesses)?;
        }
        Ok::<(), StudyError>(())
    };
    let mut pilot = plan.pilot();
    simulate(&mut pilot)?;
    let mut replicas = plan.replicas(&pilot)?;
    replicas.iter_mut().try_for_each(simulate)?;
    Ok(plan.finish(&pilot, &replicas, Confidence::default())?)
}

/// The number of a plan that is refused.
fn wrong(per_level: usize, replicas: usize) -> &'static str {
    let few = per_level < SubsetSimulation::FEWEST_PER_LEVEL;
    match (few, SubsetSimulation::REPLICAS.contains(&replicas)) {
        (true, true) => "per-level",
        (false, false) => "replicas",
        // Both, or their product.
        (true, false) | (false, true) => "per-level, replicas",
    }
}
