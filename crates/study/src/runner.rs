use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::{
    model::Model,
    scenario::{Scenario, ScenarioError},
    table::RunTable,
};

/// Told how many runs, of all models together, are done.
pub type Progress<'a> = &'a (dyn Fn(u64) + Sync);

/// Runs every model of a scenario.
///
/// Rows come in run order and depend on (seed, model, run) alone: the same bits for any number of
/// threads. A run that fails is a row with its reason.
pub(crate) fn run(
    scenario: &Scenario,
    models: &[Model],
    threads: &rayon::ThreadPool,
    progress: Progress<'_>,
) -> Vec<RunTable> {
    let done = AtomicU64::new(0);
    let row = |model: &Model, run| {
        let row = model.run(scenario, run);
        progress(done.fetch_add(1, Ordering::Relaxed) + 1);
        row
    };
    threads.install(|| {
        models
            .iter()
            .map(|model| {
                let runs = (0..scenario.runs()).into_par_iter();
                RunTable::new(model.name(), runs.map(|run| row(model, run)).collect())
            })
            .collect()
    })
}

/// The models of a scenario, ready to draw.
pub(crate) fn models(scenario: &Scenario) -> Result<Vec<Model>, ScenarioError> {
    scenario.models().iter().map(|spec| Model::new(spec, scenario)).collect()
}
