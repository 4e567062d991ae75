//! A study: a scenario, run and reported into a folder.

#[cfg(test)]
use crate::{
    Scenario,
    model::{Model, Separations},
};
use gyradius_campaign::{
    Blocks, CampaignError, Counting, Doing, FinishedRuns, Folder, Kept, MANIFEST, Plan, Progress,
    Reduced, Runs, RunsError, Simulation, Table, disk_left, go_on, memory_left, run_again,
    run_changed, run_missing, threads, told,
};
#[cfg(test)]
use gyradius_campaign::{Cell, Row, run};
use gyradius_report::visible_json;
use rayon::ThreadPool;
use std::{
    collections::BTreeSet,
    fs,
    ops::Range,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use crate::{
    Notice, Options, StudyError, Summary,
    contents::{contents, identity},
    decisions,
    drivers::Finding,
    ended::Ended,
    head::Missing,
    report,
    subject::{LookAt, Subject, Summarized},
};

/// A study carried out and written: of separations, unless it is said that its summary is another.
#[derive(Debug)]
pub struct Study<S = Summary> {
    folder: PathBuf,
    runs: Vec<Runs>,
    summary: S,
}

impl<S> Study<S> {
    pub(crate) fn of(folder: PathBuf, runs: Vec<Runs>, summary: S) -> Self {
        Self { folder, runs, summary }
    }

    /// Where it is.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The runs, model by model.
    #[must_use]
    pub fn runs(&self) -> &[Runs] {
        &self.runs
    }

    /// The run tables, model by model.
    ///
    /// # Errors
    /// A block of them cannot be read.
    pub fn tables(&self) -> Result<Vec<Table>, RunsError> {
        self.runs.iter().map(Runs::table).collect()
    }

    /// What they amount to.
    #[must_use]
    pub fn summary(&self) -> &S {
        &self.summary
    }
}

/// Does the runs that are to be done, and puts together what is there then: the study, if nothing is missing, and else
/// summary and report of the runs that are there, which say what is missing.
pub(crate) fn do_what_is_left<C: Subject>(
    scenario: &C,
    options: &Options,
    (doing, ended): (Doing, Option<Ended>),
    progress: Progress<'_>,
    say: &dyn Fn(Notice),
) -> Result<Study<C::Summary>, StudyError> {
    let threads = threads(options.threads)?;
    let place = options.place(scenario.name());
    let models = scenario.prepare(options.stop.as_ref())?;
    let simulations = scenario.simulations(&models)?;
    let kept = kept(scenario, doing);
    let in_place = OnceLock::<BTreeSet<String>>::new();
    let contents =
        contents(scenario).keeping(|name| in_place.get().is_some_and(|all| all.contains(name)));
    let folder = Folder::prepare(&place, &contents, options.force)?;
    let text = scenario.to_toml();
    decisions::check_columns(scenario)?;
    let begun = (&identity(scenario), text.as_str());
    if let Some(there) = folder.reduced(begun.0)?
        && !options.force
    {
        return reduced(scenario, &there, (&folder, &text), options, &simulations, &threads);
    }
    let counting = decisions::counting(scenario, folder.counting(begun.0)?);
    let blocks = folder.blocks(begun, scenario.runs(), options.force, &threads)?;
    let plan = plan(scenario, options, doing);
    let left = to_be_done(&simulations, plan, (&folder, &blocks), say)?;
    let missing = gaps(&blocks, scenario);
    let first_missing = missing.iter().map(|missing| missing.range().start).min();
    let ended = ended.map(|ended| ended.with_first_runs(first_missing.unwrap_or(scenario.runs())));
    // What a rule ended was held against its runs, and retried, before the rule was asked.
    let is_interrupted = ended.as_ref().is_some_and(Ended::is_interrupted);
    let is_ended = ended.is_some() && !is_interrupted;
    if !is_ended {
        same_as_before(scenario, &simulations, (&place, &blocks.finished_runs()), &threads)
            .inspect_err(|_| blocks.abandon())?;
    }
    let retries = options.retry_failed && !is_ended;
    let again = retries && doing == Doing::All && blocks.any_failed();
    if again || left > 0 && doing == Doing::All {
        scenario.begin(&models).inspect_err(|_| blocks.abandon())?;
    }
    if again {
        let stop = options.stop.as_deref();
        let done = threads.install(|| run_again(&simulations, &blocks, stop));
        say(Notice::Again(done.inspect_err(|_| blocks.abandon())?));
    }
    // A complete study that is being extended stays one until all of the runs are there: its blocks and what tells of them.
    let incomplete = doing == Doing::Nothing && (left > 0 || is_interrupted);
    let manifest = incomplete.then(|| MANIFEST.to_owned());
    let published = blocks.published().into_iter().chain(manifest);
    // What is not all kept is written anew.
    let _ = in_place.set(published.filter(|_| incomplete || kept.is_all()).collect());
    let of = scenario.runs() * simulations.len() as u64;
    // Who puts together what others did does no runs.
    let asked = scenario.drivers().is_some() && doing == Doing::All;
    let asked = asked.then_some(retries);
    if left == 0
        && let Some(study) = finished::<C>(&folder, &text, &simulations, &blocks, asked)?
    {
        if options.force {
            say(Notice::Finished);
        }
        if doing == Doing::Nothing && lacks_drivers(scenario, &study.summary) {
            say(Notice::DriversLeft);
        }
        return Ok(study);
    }
    if left > 0 && doing == Doing::All {
        let told = foretell(scenario, &simulations, [left, of], options, &threads, say);
        told.inspect_err(|_| blocks.abandon())?;
    }
    let done = threads.install(|| {
        let looks = looks(scenario, &simulations)?;
        let judging = decisions::judging(scenario, counting, ended.as_ref());
        let look = |place: usize, block: &Table| {
            looks[place].look(block);
            judging[place].look(block);
        };
        let runs = run_missing(&simulations, &blocks, plan, progress, Some(&look))?;
        if let Some(none) = runs.iter().find(|runs| runs.end() == 0) {
            let problem = format!("there are no runs of the model {:?} yet", none.model());
            return Err(StudyError::Absent { path: place.clone(), problem });
        }
        let mut summary = scenario.judge(&models, looks, &runs)?;
        let head = summary.head_mut();
        (head.missing, head.done_again) = (gaps(&blocks, scenario), blocks.again());
        head.ended = ended;
        decisions::judged(scenario, &mut summary, judging, &runs)?;
        Ok((runs, summary))
    });
    let (runs, mut summary) = done.inspect_err(|_| blocks.abandon())?;
    scenario.unasked(&models).into_iter().for_each(|unasked| say(Notice::Unasked(unasked)));

    let complete = summary.head().is_complete();
    if complete && doing == Doing::Nothing && scenario.drivers().is_some() {
        say(Notice::DriversLeft);
    }
    let mut beside = None;
    if doing == Doing::All {
        let before = || whole_summary::<C>(&place);
        let (folder, threads, identity) = (&folder, &threads, begun.0);
        let finding = Finding { scenario, models: &models, options, folder, identity, threads };
        let found = finding.find(before, &|runs| progress(of + runs));
        let (drivers, blocks) = found.inspect_err(|_| blocks.abandon())?;
        (summary.head_mut().drivers, beside) = (drivers, blocks);
    }
    let keeping = (&kept, counting);
    let written =
        write(scenario, &simulations, &blocks, (folder, keeping), &summary, options, &threads);
    let (folder, summary) = written.inspect_err(|_| blocks.abandon())?;
    if complete {
        blocks.settle()?;
    }
    beside.map_or(Ok(()), |beside: Blocks| beside.settle())?;
    let runs = match kept.is_all() || !complete {
        true => runs.into_iter().map(|runs| blocks.in_place(runs)).collect(),
        false => empty_tables(&simulations)?.into_iter().map(Runs::from).collect(),
    };
    Ok(Study { folder, runs, summary })
}

/// Makes certain that what does the runs now is what did those that are finished, where it may be another one.
pub(crate) fn same_as_before<C: Subject>(
    scenario: &C,
    simulations: &[(&str, C::Simulation<'_>)],
    (place, finished): (&Path, &FinishedRuns),
    threads: &ThreadPool,
) -> Result<(), StudyError> {
    if !scenario.may_change() {
        return Ok(());
    }
    match threads.install(|| run_changed(simulations, finished))? {
        None => Ok(()),
        Some(changed) => {
            Err(StudyError::Changed { path: place.to_owned(), changed: Box::new(changed) })
        }
    }
}

/// Tells which blocks are damaged, and checks that nothing is in the places of runs that are missing; returns how many they are.
pub(crate) fn to_be_done<S: Simulation>(
    simulations: &[(&str, S)],
    plan: Plan<'_>,
    (folder, blocks): (&Folder<'_>, &Blocks),
    say: &dyn Fn(Notice),
) -> Result<u64, StudyError> {
    let again = plan.doing == Doing::All;
    blocks.damaged().iter().for_each(|block| say(Notice::Damaged { block: block.clone(), again }));
    let all = Plan { doing: Doing::All, ..plan };
    let mut left = 0;
    for (at, (model, _)) in simulations.iter().enumerate() {
        let missing = all.missing(blocks, at, model);
        folder.check_places(model, &missing).inspect_err(|_| blocks.abandon())?;
        left += count(&missing);
    }
    Ok(left)
}

/// What is kept of the runs. Who puts together what shards did finds no drivers, and what finds them afterwards needs the runs: until
/// then, all is kept.
fn kept(scenario: &impl Subject, doing: Doing) -> Kept {
    match doing {
        Doing::Nothing if scenario.drivers().is_some() => Kept::default(),
        Doing::Nothing | Doing::All | Doing::Shard(_) => scenario.kept(),
    }
}

/// Writes a study and puts it in place; returns where that is, and the summary as it was written.
fn write<C: Subject>(
    scenario: &C,
    simulations: &[(&str, C::Simulation<'_>)],
    blocks: &Blocks,
    (mut folder, keeping): (Folder<'_>, (&Kept, Counting)),
    summary: &C::Summary,
    options: &Options,
    threads: &ThreadPool,
) -> Result<(PathBuf, C::Summary), StudyError> {
    if summary.head().is_complete() {
        let empty = empty_tables(simulations)?;
        folder.adopt(blocks, &empty, keeping, threads, options.stop.as_deref())?;
    }
    folder.write("scenario.toml", &scenario.to_toml())?;
    let written = visible_json(&serde_json::to_string_pretty(summary)?) + "\n";
    folder.write("summary.json", &written)?;
    // The report is made from what a reader of the folder has.
    let summary: C::Summary = serde_json::from_str(&written)?;
    let report = threads.install(|| scenario.report(&summary));
    for (name, content) in report.files(report::NAME) {
        folder.write(&name, &content)?;
    }
    go_on(options.stop.as_deref())?;
    Ok((folder.publish()?, summary))
}

/// A table of each model, without runs.
pub(crate) fn empty_tables<S: Simulation>(
    simulations: &[(&str, S)],
) -> Result<Vec<Table>, CampaignError> {
    let table = |(model, simulation): &(&str, S)| Table::new(model, 0, simulation.columns());
    Ok(simulations.iter().map(table).collect::<Result<_, _>>()?)
}

/// The study in a folder, not everything of which was kept, which must be this one and as it was written.
fn reduced<C: Subject>(
    scenario: &C,
    there: &Reduced,
    (folder, text): (&Folder<'_>, &str),
    options: &Options,
    simulations: &[(&str, C::Simulation<'_>)],
    threads: &ThreadPool,
) -> Result<Study<C::Summary>, StudyError> {
    let damaged = threads.install(|| there.damaged())?;
    let same = there.runs() == scenario.runs() && *there.kept() == scenario.kept();
    let whole = same && !options.retry_failed && damaged.is_empty() && folder.is_whole(text)?;
    let place = folder.place().to_owned();
    match whole.then(|| whole_summary::<C>(&place)).flatten() {
        Some(summary) => {
            same_as_before(scenario, simulations, (&place, &there.finished_runs()), threads)?;
            there.settle(&identity(scenario))?;
            let runs = empty_tables(simulations)?.into_iter().map(Runs::from).collect();
            Ok(Study { folder: place, runs, summary })
        }
        None => Err(StudyError::Reduced {
            path: place,
            kept: there.kept().clone(),
            damaged: damaged.into_iter().next(),
        }),
    }
}

/// The summary of a complete study in a folder, if it is there.
pub(crate) fn whole_summary<C: Subject>(place: &Path) -> Option<C::Summary> {
    let read = fs::read_to_string(place.join("summary.json")).ok()?;
    let summary = serde_json::from_str::<C::Summary>(&read).ok()?;
    summary.head().is_complete().then_some(summary)
}

/// Puts together what is there of a study whose runs are not all done, in its folder, which holds this scenario.
pub(crate) fn put_together<C: Subject>(
    scenario: &C,
    folder: &Path,
    options: &Options,
    say: &dyn Fn(Notice),
) -> Result<Study<C::Summary>, StudyError> {
    let options = Options { out: Some(folder.to_owned()), ..options.clone() };
    let Some(until) = scenario.until() else {
        return do_what_is_left(scenario, &options, (Doing::Nothing, None), &|_| {}, say);
    };
    // Of runs that a rule is to end, the last one that is there is the last that there is to be so far, of whole vehicles.
    let blocks = told(folder, &contents(scenario), &identity(scenario))?;
    let end = blocks.iter().map(|block| block.range().end).max().unwrap_or(scenario.runs());
    let end = scenario.whole_vehicles(end).min(until.most_runs());
    let so_far = Ended::not_yet(until);
    let scenario = scenario.ended_after(end, until)?;
    do_what_is_left(&scenario, &options, (Doing::Nothing, Some(so_far)), &|_| {}, say)
}

/// Says how many of the runs are done already, and what the others will take; refuses what the disk or the memory has no
/// room for.
pub(crate) fn foretell<C: Subject>(
    scenario: &C,
    simulations: &[(&str, C::Simulation<'_>)],
    [left, of]: [u64; 2],
    options: &Options,
    threads: &ThreadPool,
    say: &dyn Fn(Notice),
) -> Result<(), StudyError> {
    if left < of {
        say(Notice::GoesOn { done: of - left, of });
    }
    let columns = simulations.first().map_or(0, |(_, simulation)| simulation.columns().len());
    let forecast = scenario.forecast(simulations, left, threads)?;
    let forecast = forecast.in_blocks_of(C::BLOCK_RUNS, columns);
    say(Notice::Forecast(forecast));
    let path = options.place(scenario.name());
    let lacks = |needed: u64, left: Option<u64>| left.filter(|left| needed > *left);
    if options.even_if_full {
        return Ok(());
    }
    if let Some(left) = lacks(forecast.disk(), disk_left(&path)) {
        return Err(StudyError::Room { path, needed: forecast.disk(), left });
    }
    let needed = forecast.memory().unwrap_or(0);
    match lacks(needed, memory_left()) {
        Some(left) => Err(StudyError::Memory { needed, left }),
        None => Ok(()),
    }
}

/// Whether it is asked what drives the outcome, and not found.
pub(crate) fn lacks_drivers<C: Subject>(scenario: &C, summary: &C::Summary) -> bool {
    scenario.drivers().is_some() && summary.head().drivers.is_empty()
}

/// The study in a folder, if all of it is there as it was written, what drives its outcome too if that is asked: then whether it
/// is found again where runs for it failed.
fn finished<C: Subject>(
    folder: &Folder<'_>,
    text: &str,
    simulations: &[(&str, C::Simulation<'_>)],
    blocks: &Blocks,
    drivers: Option<bool>,
) -> Result<Option<Study<C::Summary>>, StudyError> {
    if !(blocks.all_in_place() && folder.is_whole(text)?) {
        return Ok(None);
    }
    let place = folder.place().to_owned();
    let Some(summary) = whole_summary::<C>(&place) else { return Ok(None) };
    let there = &summary.head().drivers;
    if drivers.is_some_and(|again| there.is_empty() || there.iter().any(|one| one.is_stale(again)))
    {
        return Ok(None);
    }
    let empty = empty_tables(simulations)?;
    let runs = empty.iter().map(|empty| blocks.runs(empty, Vec::new())).collect();
    blocks.settle()?;
    Ok(Some(Study { folder: place, runs, summary }))
}

/// Puts whole what commands that were killed left of studies and comparisons: in a folder and all those
/// below it, or in the folder that a file is in. For programs that read such folders; nothing else is
/// touched.
///
/// # Errors
/// Neither the old nor the new files can be put in place.
pub fn restore_studies(path: &Path) -> Result<(), StudyError> {
    Ok(gyradius_campaign::restore_all(path)?)
}

/// How the runs of a scenario are done.
pub(crate) fn plan<'a, C: Subject>(scenario: &C, options: &'a Options, doing: Doing) -> Plan<'a> {
    let (runs, stop) = (scenario.runs(), options.stop.as_ref());
    Plan { runs, block_runs: C::BLOCK_RUNS, doing, stop }
}

/// How many runs there are in some ranges.
pub(crate) fn count(ranges: &[Range<u64>]) -> u64 {
    ranges.iter().map(|runs| runs.end - runs.start).sum()
}

/// The runs of each model that are missing, where any are.
fn gaps(blocks: &Blocks, scenario: &impl Subject) -> Vec<Missing> {
    let of_model = |model: &str| {
        let ranges = blocks.missing(model, scenario.runs(), u64::MAX);
        ranges.into_iter().map(|runs| Missing::new(model, runs)).collect::<Vec<_>>()
    };
    scenario.model_names().flat_map(of_model).collect()
}

/// A look at the runs of each model.
fn looks<'a, C: Subject>(
    scenario: &'a C,
    simulations: &[(&str, C::Simulation<'_>)],
) -> Result<Vec<C::Look<'a>>, CampaignError> {
    let look = |(model, simulation): &(&str, C::Simulation<'_>)| {
        let table = Table::new(model, 0, simulation.columns())?;
        Ok(scenario.look(model, table.columns()))
    };
    simulations.iter().map(look).collect()
}

#[cfg(test)]
impl<S> Study<S> {
    /// The cells of all runs, model by model, numbers by their bits.
    pub(crate) fn rows(&self) -> Vec<Vec<String>> {
        let cell = |cell: Cell<'_>| match cell {
            Cell::Number(x) => format!("{:x}", x.to_bits()),
            other => other.to_string(),
        };
        let row = |row: Row<'_>| row.cells().map(|(_, own)| cell(own)).collect::<Vec<_>>();
        let tables = self.tables().unwrap();
        tables.iter().flat_map(|table| table.rows().map(row).collect::<Vec<_>>()).collect()
    }
}

/// What the runs of a scenario amount to, made in memory.
#[cfg(test)]
pub(crate) fn judged(scenario: &Scenario, models: &Vec<Model>) -> Summary {
    let simulations = scenario.simulations(models).unwrap();
    let (looks, runs) = (looks(scenario, &simulations).unwrap(), all_runs(scenario, models));
    looks.iter().zip(&runs).for_each(|(look, runs)| runs.scan(|block| look.look(block)).unwrap());
    scenario.judge(models, looks, &runs).unwrap()
}

/// Runs every model of a scenario, in memory.
#[cfg(test)]
pub(crate) fn all_runs(scenario: &Scenario, models: &[Model]) -> Vec<Runs> {
    let threads = threads(Some(1)).unwrap();
    let table = |(model, name): (&Model, &str)| {
        let simulation = Separations::new(scenario, model);
        run(&simulation, name, scenario.runs(), &threads, &|_| {}).unwrap()
    };
    models.iter().zip(scenario.model_names()).map(|model| Runs::from(table(model))).collect()
}
