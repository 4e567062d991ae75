//! A share of a study's runs, and what of a study is there: for studies that many processes do.

use gyradius_campaign::{
    Block, Difference, Doing, Forecast, Plan, Progress, Shard, Shared, Until, begun, changed,
    missing_runs, run_missing, threads, told, why_unknown,
};
use serde::Serialize;
use std::{ops::Range, path::Path};

use crate::{
    Notice, Options, ScenarioError, StudyError,
    contents::{contents, identity, shared},
    decisions::check_columns,
    head::Missing,
    results::no_study,
    scenario::scenario_text,
    study::{count, foretell, lacks_drivers, plan, same_as_before, whole_summary},
    subject::Subject,
    unfinished::{begun_study, replacement},
};

/// That the runs of a scenario can be shared out: that their number does not follow from all of them.
pub(crate) fn check<C: Subject>(scenario: &C) -> Result<(), ScenarioError> {
    if scenario.until().is_none() {
        return Ok(());
    }
    let problem = "a share of the runs cannot tell when all of them are enough: give the shards a number of runs instead";
    Err(ScenarioError::field("until", problem))
}

/// That processes which have nothing but the file of a scenario can share its runs out. Returns why runs cannot be done on this
/// machine, if they cannot: others may have the command of a simulator.
pub(crate) fn check_alone<C: Subject>(
    scenario: &C,
) -> Result<Option<ScenarioError>, ScenarioError> {
    check(scenario)?;
    let models = scenario.prepare(None)?;
    match scenario.begin(&models) {
        Err(error) if scenario.function_name().is_none() => Ok(Some(error)),
        other => other.map(|()| None),
    }
}

/// How many runs a process is to do if none is there: those of a shard, or of all models.
pub(crate) fn planned_runs<C: Subject>(scenario: &C, shard: Option<Shard>) -> u64 {
    let doing = shard.map_or(Doing::All, Doing::Shard);
    let options = Options::default();
    let plan = plan(scenario, &options, doing);
    let runs = scenario.until().map_or(plan.runs, Until::most_runs);
    Plan { runs, ..plan }.total(scenario.model_names().count())
}

/// How many runs each of so many shards is to do if none is there, by their numbers. A shard without any is one too many:
/// runs are done in blocks.
pub(crate) fn planned_shares<C: Subject>(scenario: &C, shards: u32) -> Vec<u64> {
    let options = Options::default();
    plan(scenario, &options, Doing::All).shares(scenario.model_names().count(), shards)
}

/// What all runs of a scenario would take in one process.
pub(crate) fn forecast_study<C: Subject>(
    scenario: &C,
    options: &Options,
) -> Result<Forecast, StudyError> {
    let threads = threads(options.threads)?;
    let prepared = scenario.prepare(None)?;
    let simulations = scenario.simulations(&prepared)?;
    scenario.forecast(&simulations, planned_runs(scenario, None), &threads)
}

/// Does a share of the runs of a study, of those that are in no finished block, into its folder. Other processes may do
/// other shares at the same time, also on other machines that have the folder in common. Nothing is put together.
///
/// # Errors
/// The folder holds another study, or somebody has it alone, or another process does the same share; something cannot be
/// written. Blocks that were finished stay.
pub(crate) fn run_shard<C: Subject>(
    scenario: &C,
    options: &Options,
    shard: Shard,
    progress: Progress<'_>,
    say: &dyn Fn(Notice),
) -> Result<(), StudyError> {
    check(scenario)?;
    let threads = threads(options.threads)?;
    let models = scenario.prepare(options.stop.as_ref())?;
    let simulations = scenario.simulations(&models)?;
    let contents = contents(scenario);
    let folder = Shared::open(&options.place(scenario.name()), &contents)?;
    check_columns(scenario)?;
    let begun = (&identity(scenario), scenario.to_toml());
    let place = options.place(scenario.name());
    agree(scenario, &place)?;
    if let Some(there) = folder.reduced(begun.0)? {
        if scenario.runs() > there.runs() {
            let (kept, damaged) = (there.kept().clone(), None);
            return Err(StudyError::Reduced { path: place, kept, damaged });
        }
        // All is done, also what this share would have been.
        return same_as_before(scenario, &simulations, (&place, &there.finished_runs()), &threads);
    }
    let blocks = folder.blocks((begun.0, &begun.1), scenario.runs(), shard, &threads)?;
    // Asked again: of shards that begin at the same time, one has told by now what holds for all.
    agree(scenario, &place)?;
    let again = true;
    blocks.damaged().iter().for_each(|block| say(Notice::Damaged { block: block.clone(), again }));
    same_as_before(scenario, &simulations, (&place, &blocks.finished_runs()), &threads)?;
    let plan = plan(scenario, options, Doing::Shard(shard));
    let missing = |(place, (model, _)): (usize, &(&str, _))| plan.missing(&blocks, place, model);
    let left = simulations.iter().enumerate().map(|model| count(&missing(model))).sum::<u64>();
    if left > 0 {
        scenario.begin(&models)?;
        let of = plan.total(simulations.len());
        foretell(scenario, &simulations, [left, of], options, &threads, say)?;
    }
    threads.install(|| run_missing(&simulations, &blocks, plan, progress, None))?;
    scenario.unasked(&models).into_iter().for_each(|unasked| say(Notice::Unasked(unasked)));
    Ok(())
}

/// That the study which was begun or done in a folder keeps and requires the same, and that one which was begun has as many runs:
/// the last shard would decide for all.
fn agree<C: Subject>(scenario: &C, folder: &Path) -> Result<(), StudyError> {
    let there = |text: String| C::resolved(&text).ok();
    let (begun, done) = (begun(folder)?.and_then(there), || {
        scenario_text(&folder.join("scenario.toml")).ok().and_then(there)
    });
    let runs = begun.as_ref().map(C::runs).filter(|runs| *runs != scenario.runs());
    let runs = runs.map(|there| Difference {
        field: "runs".to_owned(),
        there: Some(there.to_string()),
        here: Some(scenario.runs().to_string()),
    });
    let there = begun.or_else(done);
    let other = || there.and_then(|there| shared(scenario).difference(&shared(&there)));
    match runs.or_else(other) {
        Some(difference) => Err(StudyError::Shards { path: folder.to_owned(), difference }),
        None => Ok(()),
    }
}

/// The text of the scenario of the study in a folder, as it was begun or done.
pub(crate) fn text(folder: &Path) -> Result<String, StudyError> {
    let absent = |problem: String| StudyError::Absent { path: folder.to_owned(), problem };
    if let Some(text) = begun_study(folder)? {
        return Ok(text);
    }
    // Another text may be another scenario, or none.
    if let Some(problem) = changed(folder, "study", &["scenario.toml"])? {
        return Err(absent(problem));
    }
    scenario_text(&folder.join("scenario.toml")).map_err(|_| absent(no_study(folder)))
}

/// What of a study is there.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Status {
    /// The name of the scenario.
    pub scenario: String,
    /// Whether all runs are done and put together.
    pub complete: bool,
    /// Whether it is asked what drives the outcome, and not found yet, although they are: shards do not.
    pub drivers_left: bool,
    /// Runs that each model is to have.
    pub runs_per_model: u64,
    /// What of each model is there.
    pub models: Vec<ModelStatus>,
    /// The runs that are not done.
    pub missing: Vec<Missing>,
    /// What became of a file without which the study is not complete, in words, if it is not as it was written.
    pub changed: Option<String>,
    /// Of another study that was begun to replace it, in words, if one was.
    pub replacement: Option<String>,
}

/// What of the runs of a model is there.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ModelStatus {
    /// Its name.
    pub model: String,
    /// Runs in finished blocks.
    pub finished: u64,
    /// How many of them failed.
    pub failed: u64,
}

impl Status {
    /// Of the study of a scenario in a folder, as its files tell.
    pub(crate) fn of<C: Subject>(scenario: &C, folder: &Path) -> Result<Self, StudyError> {
        let (contents, identity) = (contents(scenario), identity(scenario));
        let blocks = told(folder, &contents, &identity)?;
        // Of a complete study whose blocks are lost, all runs are missing.
        if blocks.is_empty()
            && begun_study(folder)?.is_none()
            && let Some(problem) = why_unknown(folder, &contents, &identity)?
        {
            return Err(StudyError::Absent { path: folder.to_owned(), problem });
        }
        let (mut models, mut missing) = (Vec::new(), Vec::new());
        for model in scenario.model_names() {
            let own = || blocks.iter().filter(|block| block.model() == model);
            let ranges: Vec<Range<u64>> = own().map(Block::range).collect();
            models.push(ModelStatus {
                model: model.to_owned(),
                finished: count(&ranges),
                failed: own().map(Block::failed).sum(),
            });
            let gaps = missing_runs(ranges, scenario.runs(), u64::MAX);
            missing.extend(gaps.into_iter().map(|runs| Missing::new(model, runs)));
        }
        let changed = match begun_study(folder)? {
            // The scenario is this one.
            None => changed(folder, "study", &["summary.json"])?,
            // It is written when all is put together.
            Some(_) => None,
        };
        let complete =
            missing.is_empty() && blocks.iter().all(Block::is_in_place) && changed.is_none();
        let lacks = |summary: C::Summary| lacks_drivers(scenario, &summary);
        Ok(Self {
            scenario: scenario.name().to_owned(),
            complete,
            drivers_left: complete && whole_summary::<C>(folder).is_some_and(lacks),
            changed,
            runs_per_model: scenario.runs(),
            models,
            missing,
            replacement: replacement(folder)?,
        })
    }
}
