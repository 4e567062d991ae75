//! A complete study in a folder that cannot be written, or in which another study is to replace it: nothing is to be done, and it is read.

use gyradius_campaign::{FinishedRuns, Runs, threads, told, told_runs};

use crate::{
    Options, Status, Study, StudyError,
    contents::{contents, identity},
    results,
    study::{empty_tables, same_as_before},
    subject::{Subject, Summarized},
};

/// The complete study of a scenario in a folder, which is not to be written, if it is there. What drives the outcome is there too,
/// if that was asked.
pub(crate) fn complete_study<C: Subject>(
    scenario: &C,
    options: &Options,
) -> Result<Option<Study<C::Summary>>, StudyError> {
    let place = options.place(scenario.name());
    // Whatever is wrong with what is there, the folder is not to be written first of all.
    let Ok(there) = results::read::<C>(&place) else { return Ok(None) };
    let (there, summary) = there.into_parts();
    let is_it = there.to_toml() == scenario.to_toml()
        && Status::of(scenario, &place).is_ok_and(|status| status.complete);
    let drivers = &summary.head().drivers;
    let is_stale = drivers.is_empty() || drivers.iter().any(|one| one.is_stale(false));
    if !is_it || (scenario.drivers().is_some() && is_stale) {
        return Ok(None);
    }
    let models = scenario.prepare(None)?;
    let simulations = scenario.simulations(&models)?;
    let empty = empty_tables(&simulations)?;
    let kept = scenario.kept();
    let blocks = told(&place, &contents(scenario), &identity(scenario))?;
    let finished = FinishedRuns::in_place(&place, &blocks, &kept);
    same_as_before(scenario, &simulations, (&place, &finished), &threads(options.threads)?)?;
    let runs = |empty| match kept.is_all() {
        true => told_runs(&place, &blocks, &empty),
        false => Runs::from(empty),
    };
    let runs = empty.into_iter().map(runs).collect();
    Ok(Some(Study::of(place, runs, summary)))
}
