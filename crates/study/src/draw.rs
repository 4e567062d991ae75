//! What is drawn for the runs of a scenario, without any separation.

use gyradius_campaign::{
    CampaignError, Column as RunColumn, Extent, Failure, FormatError, Progress, Simulation, Table,
    TableError, TableFormat, stream, threads,
};
use std::{
    io::Write,
    ops::Range,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use crate::{
    LawFile, Scenario, ScenarioError, SimulatorScenario, column::Column, model::Model,
    simulator::SimulatorDraws, subject::Subject,
};

/// Which draws, and how they are written.
#[derive(Clone, Debug, Default)]
pub struct DrawOptions {
    /// Names of models; all of the scenario if there are none.
    pub models: Vec<String>,
    /// The first run, from 0.
    pub first: u64,
    /// Runs of each model; as many as the scenario has if not given.
    pub runs: Option<u64>,
    /// How many threads; as many as the machine has if not given.
    pub threads: Option<usize>,
    /// In which form.
    pub format: TableFormat,
    /// Set from elsewhere to stop.
    pub stop: Option<Arc<AtomicBool>>,
}

/// The draws of a scenario, ready to be written.
///
/// They are what the runs of a [`Study`](crate::Study) of this scenario have in the columns of the same names, to the bit.
///
/// ```
/// use gyradius_study::{Draw, DrawOptions, Scenario};
///
/// let scenario = Scenario::peck_2003()?;
/// let options = DrawOptions { models: vec!["naive".into()], runs: Some(3), ..DrawOptions::default() };
/// let mut table = Vec::new();
/// Draw::new(&scenario, &options)?.write(&mut table, &|_done| {})?;
/// assert!(table.starts_with(b"model,run,status,payload_i11,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Draw<'a> {
    models: Drawn<'a>,
    runs: Range<u64>,
    format: TableFormat,
    threads: Option<usize>,
    stop: Option<Arc<AtomicBool>>,
}

impl<'a> Draw<'a> {
    /// Checks what is asked for. Nothing is drawn yet.
    ///
    /// # Errors
    /// A model does not exist or cannot be made, or the runs are out of range.
    pub fn new(scenario: &'a Scenario, options: &DrawOptions) -> Result<Self, DrawError> {
        let columns: Vec<_> =
            Column::of(scenario).into_iter().filter(|column| column.is_drawn()).collect();
        let model = |place: usize| {
            let model = Model::new(&scenario.models()[place], scenario)?;
            Ok(SeparationDraws { scenario, model, columns: columns.clone() })
        };
        let models = chosen(scenario, options, model)?;
        Self::of(scenario, Drawn::Separation(models), options)
    }

    /// As [`new`](Self::new), of what is sent to a simulator.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_simulator(
        scenario: &'a SimulatorScenario,
        options: &DrawOptions,
    ) -> Result<Self, DrawError> {
        let models = chosen(scenario, options, |place| SimulatorDraws::new(scenario, place))?;
        Self::of(scenario, Drawn::Simulator(models), options)
    }

    /// As [`new`](Self::new), of bodies with laws and no scenario. A scenario of a simulator into which their tables are copied, with a model
    /// `principal` and the same seed, has the same values in the columns of the same names, to the bit; so has one of separations.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_laws(laws: &'a LawFile, options: &DrawOptions) -> Result<Self, DrawError> {
        let models = chosen(laws.scenario(), options, |place| laws.draws(place))?;
        Self::of(laws.scenario(), Drawn::Simulator(models), options)
    }

    fn of<C: Subject>(
        scenario: &C,
        models: Drawn<'a>,
        options: &DrawOptions,
    ) -> Result<Self, DrawError> {
        let (first, runs) = (options.first, options.runs.unwrap_or_else(|| scenario.runs()));
        let last = first.checked_add(runs).filter(|last| *last <= MOST);
        Ok(Self {
            models,
            runs: first..last.ok_or(DrawError::Runs { first, runs })?,
            format: options.format,
            threads: options.threads,
            stop: options.stop.clone(),
        })
    }

    /// How many runs [`write`](Self::write) draws, of all models, and twice if the form needs that.
    #[must_use]
    pub fn steps(&self) -> u64 {
        let runs = (self.runs.end - self.runs.start).saturating_mul(self.models.len());
        runs.saturating_mul(1 + u64::from(self.format.needs_extent()))
    }

    /// Draws and writes, model by model in the order of the scenario, in memory that does not grow with the runs. The
    /// same bytes on any number of threads. For a form that says first how long the table and its texts are, everything
    /// is drawn twice.
    ///
    /// # Errors
    /// The threads cannot be started, it was told to stop, or the output refuses.
    pub fn write(
        &self,
        output: impl Write + Send,
        progress: Progress<'_>,
    ) -> Result<(), DrawError> {
        let done = AtomicU64::new(0);
        let more = |runs| progress(done.fetch_add(runs, Ordering::Relaxed) + runs);
        threads(self.threads)?.install(|| {
            let mut extent = Extent::default();
            if self.format.needs_extent() {
                self.each(&more, |table| {
                    extent.add(table);
                    Ok(())
                })?;
            }
            let empty = Table::new("", 0, self.models.columns()).map_err(CampaignError::from)?;
            let mut writer = self.format.writer(&empty, &extent, output)?;
            self.each(&more, |table| Ok(writer.write(table)?))?;
            Ok(writer.finish()?)
        })
    }

    /// Draws all runs and hands them on.
    fn each(
        &self,
        more: &(dyn Fn(u64) + Sync),
        mut take: impl FnMut(&Table) -> Result<(), DrawError>,
    ) -> Result<(), DrawError> {
        match &self.models {
            Drawn::Separation(models) => self.each_of(models, more, &mut take),
            Drawn::Simulator(models) => self.each_of(models, more, &mut take),
        }
    }

    fn each_of<D: Simulation>(
        &self,
        models: &[(String, D)],
        more: &(dyn Fn(u64) + Sync),
        take: &mut impl FnMut(&Table) -> Result<(), DrawError>,
    ) -> Result<(), DrawError> {
        models.iter().try_for_each(|(name, draws)| {
            stream(draws, name, self.runs.clone(), self.stop.as_deref(), more, &mut *take)
        })
    }
}

/// The last run has a number that the column `run` can hold.
const MOST: u64 = i64::MAX as u64;

/// What models draw, by their names.
#[derive(Debug)]
enum Drawn<'a> {
    Separation(Vec<(String, SeparationDraws<'a>)>),
    Simulator(Vec<(String, SimulatorDraws<'a>)>),
}

impl Drawn<'_> {
    fn len(&self) -> u64 {
        match self {
            Self::Separation(models) => models.len() as u64,
            Self::Simulator(models) => models.len() as u64,
        }
    }

    fn columns(&self) -> Vec<RunColumn> {
        fn columns<D: Simulation>(models: &[(String, D)]) -> Vec<RunColumn> {
            models.first().map_or_else(Vec::new, |(_, draws)| draws.columns())
        }
        match self {
            Self::Separation(models) => columns(models),
            Self::Simulator(models) => columns(models),
        }
    }
}

/// The models that are asked for, each made from its place.
fn chosen<C: Subject, D>(
    scenario: &C,
    options: &DrawOptions,
    model: impl Fn(usize) -> Result<D, ScenarioError>,
) -> Result<Vec<(String, D)>, DrawError> {
    let asked = options.models.iter().map(|name| scenario.place_of(Some(name)));
    let asked: Vec<usize> = asked.collect::<Result<_, _>>()?;
    let all = scenario.model_names().enumerate();
    let asked = all.filter(|(place, _)| asked.is_empty() || asked.contains(place));
    asked.map(|(place, name)| Ok((name.to_owned(), model(place)?))).collect()
}

/// The bodies that a model draws, which are not separated.
#[derive(Debug)]
struct SeparationDraws<'a> {
    scenario: &'a Scenario,
    model: Model,
    columns: Vec<Column>,
}

impl Simulation for SeparationDraws<'_> {
    type Worker = ();

    fn columns(&self) -> Vec<RunColumn> {
        let drawn = self.scenario.dispersions().columns();
        self.columns.iter().map(|column| column.declaration(&drawn)).collect()
    }

    fn worker(&self) {}

    fn run(&self, runs: Range<u64>, _: &mut (), rows: &mut Table) -> Result<(), TableError> {
        for run in runs {
            let case = self.model.draw(self.scenario, run);
            let drawn = case.drawn();
            let cells = self.columns.iter().map(|column| column.cell(&drawn));
            rows.push(drawn.failure().map(Failure::from), cells)?;
        }
        Ok(())
    }
}

/// Why draws cannot be made or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// The last run would have a number that is too large.
    #[error("{runs} runs from run {first} on: the number of the last must be below {MOST}")]
    Runs {
        /// The first run.
        first: u64,
        /// How many.
        runs: u64,
    },
    /// A model cannot be made.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The threads cannot be started, or it was told to stop.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// The output refuses.
    #[error(transparent)]
    Output(#[from] FormatError),
}
