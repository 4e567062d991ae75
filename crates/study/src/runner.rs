use gyradius_separation::Batch;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::{
    model::Model,
    scenario::{Scenario, ScenarioError},
    table::RunTable,
};

/// Runs that a thread takes at a time: many for the lanes of a batch, few for other threads to be idle
/// at the end.
const TOGETHER: u64 = 64;

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
    let part = |model: &Model, batch: &mut Batch, first: u64| {
        let runs = first..(first + TOGETHER).min(scenario.runs());
        let part = model.run(scenario, runs.clone(), batch);
        for _ in runs {
            progress(done.fetch_add(1, Ordering::Relaxed) + 1);
        }
        part
    };
    threads.install(|| {
        models
            .iter()
            .map(|model| {
                let groups = (0..scenario.runs().div_ceil(TOGETHER)).into_par_iter();
                let batch = || Batch::new(*scenario.settings());
                let parts: Vec<RunTable> = groups
                    .map_init(batch, |batch, group| part(model, batch, group * TOGETHER))
                    .collect();
                let mut whole = model.table(scenario, 0);
                for part in parts {
                    whole.append(part);
                }
                whole
            })
            .collect()
    })
}

/// The models of a scenario, ready to draw.
pub(crate) fn models(scenario: &Scenario) -> Result<Vec<Model>, ScenarioError> {
    scenario.models().iter().map(|spec| Model::new(spec, scenario)).collect()
}
