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

use crate::{Scenario, ScenarioError, column::Column, model::Model, scenario::ModelSpec};

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
    scenario: &'a Scenario,
    models: Vec<Model>,
    columns: Vec<Column>,
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
        for name in &options.models {
            if !scenario.model_names().any(|model| model == name) {
                let models: Vec<&str> = scenario.model_names().collect();
                return Err(DrawError::Model { model: name.clone(), models: models.join(", ") });
            }
        }
        let asked =
            |spec: &&ModelSpec| options.models.is_empty() || options.models.contains(&spec.name);
        let models = scenario.models().iter().filter(asked);
        let models = models.map(|spec| Model::new(spec, scenario)).collect::<Result<_, _>>()?;
        let all = Column::all(scenario.separation(), scenario.dispersions().all.len());
        let (first, runs) = (options.first, options.runs.unwrap_or_else(|| scenario.runs()));
        let last = first.checked_add(runs).filter(|last| *last <= MOST);
        Ok(Self {
            scenario,
            models,
            columns: all.into_iter().filter(|column| column.is_drawn()).collect(),
            runs: first..last.ok_or(DrawError::Runs { first, runs })?,
            format: options.format,
            threads: options.threads,
            stop: options.stop.clone(),
        })
    }

    /// How many runs [`write`](Self::write) draws, of all models, and twice if the form needs that.
    #[must_use]
    pub fn steps(&self) -> u64 {
        let runs = (self.runs.end - self.runs.start).saturating_mul(self.models.len() as u64);
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
            let empty = Table::new("", 0, self.columns()).map_err(CampaignError::from)?;
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
        self.models.iter().try_for_each(|model| {
            let draws = Draws { draw: self, model };
            let stop = self.stop.as_deref();
            stream(&draws, model.name(), self.runs.clone(), stop, more, &mut take)
        })
    }

    fn columns(&self) -> Vec<RunColumn> {
        let drawn = self.scenario.dispersions().columns();
        self.columns.iter().map(|column| column.declaration(&drawn)).collect()
    }
}

/// The last run has a number that the column `run` can hold.
const MOST: u64 = i64::MAX as u64;

/// The bodies that a model draws, which are not separated.
struct Draws<'a> {
    draw: &'a Draw<'a>,
    model: &'a Model,
}

impl Simulation for Draws<'_> {
    type Worker = ();

    fn columns(&self) -> Vec<RunColumn> {
        self.draw.columns()
    }

    fn worker(&self) {}

    fn run(&self, runs: Range<u64>, _: &mut (), rows: &mut Table) -> Result<(), TableError> {
        for run in runs {
            let case = self.model.draw(self.draw.scenario, run);
            let drawn = case.drawn();
            let cells = self.draw.columns.iter().map(|column| column.cell(&drawn));
            rows.push(drawn.failure().map(Failure::from), cells)?;
        }
        Ok(())
    }
}

/// Why draws cannot be made or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// The scenario has no such model.
    #[error("model {model:?}: the scenario has the models {models}")]
    Model {
        /// The model.
        model: String,
        /// Those that it has.
        models: String,
    },
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
