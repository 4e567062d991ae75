//! A study: a scenario, run and reported into a folder.

#[cfg(test)]
use crate::{
    Scenario,
    model::{Model, Separations},
    subject::LookAt,
};
use gyradius_campaign::{
    Blocks, CampaignError, Doing, FinishedRuns, Folder, Plan, Runs, RunsError, Simulation, Table,
    disk_left, memory_left, run_changed,
};
#[cfg(test)]
use gyradius_campaign::{Cell, Row, run, threads};
use rayon::ThreadPool;
use std::{
    fs,
    ops::Range,
    path::{Path, PathBuf},
};

use crate::{
    Notice, Options, StudyError, Summary,
    subject::{Subject, Summarized},
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

/// A table of each model, without runs.
pub(crate) fn empty_tables<S: Simulation>(
    simulations: &[(&str, S)],
) -> Result<Vec<Table>, CampaignError> {
    let table = |(model, simulation): &(&str, S)| Table::new(model, 0, simulation.columns());
    Ok(simulations.iter().map(table).collect::<Result<_, _>>()?)
}

/// The summary of a complete study in a folder, if it is there.
pub(crate) fn whole_summary<C: Subject>(place: &Path) -> Option<C::Summary> {
    let read = fs::read_to_string(place.join("summary.json")).ok()?;
    let summary = serde_json::from_str::<C::Summary>(&read).ok()?;
    summary.head().is_complete().then_some(summary)
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

/// A look at the runs of each model.
pub(crate) fn looks<'a, C: Subject>(
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
