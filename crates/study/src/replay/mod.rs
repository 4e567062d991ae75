//! One run of a study again, bit for bit, with all that happens in it.

mod history;
mod outlines;
pub(crate) mod page;
mod picture;
mod short;
mod words;

use gyradius_campaign::{
    Column, Kept, MANIFEST, Manifest, Row, Rows, Simulation, Table, TableError, folder_of,
    read_run, restore,
};
use gyradius_clearance::Clearance;
use gyradius_formats::{WriteError, must_write, write_file};
use gyradius_separation::{RunError, Separation, Step};
use parquet::errors::ParquetError;
use std::{
    collections::BTreeSet,
    fs, io,
    path::{Path, PathBuf},
};

use crate::{
    Fleet, Results, ResultsError, Scenario, ScenarioError,
    model::{Model, Separations},
    run::{Case, End},
    subject::Subject,
};
use history::History;

/// Longest coast, s: what a history still shows.
const MOST_COAST: f64 = 3600.0;

/// Why a run is not replayed. Nothing has been overwritten.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The scenario is refused.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The study cannot be read.
    #[error(transparent)]
    Study(#[from] ResultsError),
    /// The run leaves no row.
    #[error(transparent)]
    Row(#[from] TableError),
    /// The scenario has no such model.
    #[error("model {model:?}: the scenario has {}", known.join(", "))]
    Model {
        /// What was asked for.
        model: String,
        /// What there is.
        known: Vec<String>,
    },
    /// There is no such run.
    #[error("run {run}: the runs are numbered from 0 to {}", runs - 1)]
    Run {
        /// What was asked for.
        run: u64,
        /// How many there are.
        runs: u64,
    },
    /// There is no such vehicle or flight.
    #[error(
        "vehicle {vehicle}, flight {flight}: the scenario has {}, all numbered from 0",
        fleet.map_or_else(|| "no vehicles".to_owned(), |fleet| fleet.to_string())
    )]
    Flight {
        /// The vehicle that was asked for.
        vehicle: u64,
        /// Its flight.
        flight: u64,
        /// What there is.
        fleet: Option<Fleet>,
    },
    /// The coast is none.
    #[error("coast = {value:?} s: it must lie between 0 and {MOST_COAST}")]
    Coast {
        /// What was asked for, s.
        value: f64,
    },
    /// The coast cannot be followed to its end.
    #[error("the run ends well, but not its coast: {0}; ask for a shorter one")]
    Coasting(RunError),
    /// The run table cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Table {
        /// The table.
        path: PathBuf,
        /// Why.
        source: ParquetError,
    },
    /// What the study tells of its run tables cannot be read.
    #[error("{}: {problem}", path.display())]
    Manifest {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// The replay is not what the table says.
    #[error(
        "{}: {column} of the run is {table}, and the replay has {replayed}: the table was changed, or \
         made by another build", path.display()
    )]
    Differs {
        /// The table.
        path: PathBuf,
        /// The column.
        column: String,
        /// What stands in it.
        table: String,
        /// What the replay gives.
        replayed: String,
    },
    /// A file is there already, and another.
    #[error(
        "{} is there already; choose another folder with --out, or pass --force to replace it",
        path.display()
    )]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

impl From<WriteError> for ReplayError {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Exists(path) => Self::Exists { path },
            WriteError::Io { path, error } => Self::Write { path, source: error },
            WriteError::NoFile(path) => {
                let source = io::Error::other("it is not a regular file");
                Self::Write { path, source }
            }
            other => Self::Write { path: PathBuf::new(), source: io::Error::other(other) },
        }
    }
}

/// Which run is replayed; a number is that of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// By its number, from 0.
    Run(u64),
    /// By its vehicle and flight, both from 0.
    Flight {
        /// The vehicle.
        vehicle: u64,
        /// Its flight.
        flight: u64,
    },
}

impl From<u64> for Which {
    fn from(run: u64) -> Self {
        Self::Run(run)
    }
}

impl Which {
    /// The number of the run, if the scenario has it.
    pub(crate) fn run(self, scenario: &impl Subject) -> Result<u64, ReplayError> {
        match self {
            Self::Run(run) if run < scenario.runs() => Ok(run),
            Self::Run(run) => Err(ReplayError::Run { run, runs: scenario.runs() }),
            Self::Flight { vehicle, flight } => {
                let fleet = scenario.fleet();
                let run = fleet.and_then(|fleet| fleet.run(vehicle, flight));
                run.ok_or(ReplayError::Flight { vehicle, flight, fleet })
            }
        }
    }
}

/// A run of a study, done again and followed through.
///
/// Its row is that of the study, bit for bit. Printed, it is a page of what happened.
#[derive(Debug)]
pub struct Replay {
    scenario: Scenario,
    model: String,
    case: Case,
    /// The table of this run alone.
    own: Table,
    history: History,
    /// How near the bodies come, if that is watched and the run ends well.
    clearance: Option<Clearance>,
    /// The table whose row it was held against.
    table: Held,
}

/// What a replay was held against.
#[derive(Debug)]
enum Held {
    /// Nothing: there is no study.
    Nowhere,
    /// Nothing: the study did not keep the row.
    NotKept,
    /// What was kept of the row in a table.
    To(PathBuf),
}

impl Replay {
    /// Replays a run of the study in a folder, and holds it against the run table there; or of a
    /// scenario file, which has none. The model is the first of the scenario if not given. The history
    /// goes on for `coast_s` after the last release.
    ///
    /// # Errors
    /// The folder holds no study, or one by another version or from another scenario; there is no such
    /// model or run; the coast is not within 0 and 3600 s; the table says otherwise.
    pub fn open(
        path: &Path,
        model: Option<&str>,
        run: impl Into<Which>,
        coast_s: f64,
    ) -> Result<Self, ReplayError> {
        // A study that was killed while it replaced this one is put right first; its scenario may be away
        // until then.
        let folder = if path.is_dir() { path } else { folder_of(path) };
        restore(folder).map_err(ResultsError::from)?;
        if !path.is_dir() {
            if !path.exists() {
                let problem =
                    "there is no such study: run `gyradius study`, or name the folder of one \
                               or a scenario file"
                        .to_owned();
                return Err(ResultsError::Study { path: path.to_owned(), problem }.into());
            }
            return Self::new(&Scenario::read(path)?, model, run, coast_s);
        }
        let results = Results::read(path)?;
        Self::new(results.scenario(), model, run, coast_s)?.held_against(path)
    }

    /// Holds the row against that of the run table in the folder of a study, bit by bit: for a study with models of a
    /// program's own, which [`open`](Self::open) cannot draw.
    ///
    /// # Errors
    /// There is no such table, or it says otherwise.
    pub fn held_against(mut self, folder: &Path) -> Result<Self, ReplayError> {
        let run = self.row().run();
        let manifest = Manifest::read(folder).map_err(|error| ReplayError::Manifest {
            path: folder.join(MANIFEST),
            problem: error.to_string(),
        })?;
        let block = manifest.find(&self.model, run).ok_or_else(|| {
            let problem = format!("it tells of no run {run} of {:?}", self.model);
            ReplayError::Manifest { path: folder.join(MANIFEST), problem }
        })?;
        let kept = manifest.kept();
        let is_kept = match kept.rows() {
            Rows::All => true,
            Rows::Failed => self.row().failure().is_some(),
            Rows::None => false,
        };
        if !is_kept {
            self.table = Held::NotKept;
            return Ok(self);
        }
        let table = folder.join(block.name());
        self.compare(&table, kept)?;
        self.table = Held::To(table);
        Ok(self)
    }

    /// Replays a run of a scenario.
    ///
    /// # Errors
    /// There is no such model or run; the coast is not within 0 and 3600 s.
    pub fn new(
        scenario: &Scenario,
        model: Option<&str>,
        run: impl Into<Which>,
        coast_s: f64,
    ) -> Result<Self, ReplayError> {
        if !(0.0..=MOST_COAST).contains(&coast_s) {
            return Err(ReplayError::Coast { value: coast_s });
        }
        let run = run.into().run(scenario)?;
        let specs = scenario.models();
        let asked = specs.iter().find(|spec| model.is_none_or(|name| spec.name == name));
        let Some(spec) = asked else {
            let known = scenario.model_names().map(str::to_owned).collect();
            return Err(ReplayError::Model { model: model.unwrap_or_default().to_owned(), known });
        };
        let model = Model::new(spec, scenario)?;
        let case = model.draw(scenario, run);
        let (mut steps, mut result) = (Vec::<Step>::new(), None);
        if let Ok(separation) = &case.separation {
            let settings = scenario.settings();
            let outcome = separation.run(settings);
            let followed = separation.follow(settings, coast_s, |step| steps.push(step.clone()));
            if let (Ok(_), Err(error)) = (&outcome, followed) {
                return Err(ReplayError::Coasting(error));
            }
            result = Some(outcome);
        }
        let loads: Vec<_> = case.separation.iter().flat_map(Separation::loads).collect();
        let ended = result.as_ref().and_then(|result| result.as_ref().ok());
        let history = History::new(&steps, &loads, ended);
        let simulation = Separations::new(scenario, &model);
        let mut own = Table::new(&spec.name, run, simulation.columns())?;
        let run = case.ended(scenario, result);
        simulation.push(&run, &mut own)?;
        let clearance = run.end().and_then(End::clearance).cloned();
        Ok(Self {
            own,
            history,
            scenario: scenario.clone(),
            model: spec.name.clone(),
            case,
            clearance,
            table: Held::Nowhere,
        })
    }

    /// What came of it.
    #[must_use]
    pub fn row(&self) -> Row<'_> {
        self.own.rows().next().expect("the table of a replay has its run")
    }

    /// Name of the model.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// Where its files go if nothing else is said: `target/replay/<scenario>/<model>-<run>`.
    #[must_use]
    pub fn default_folder(&self) -> PathBuf {
        let name = format!("{}-{}", self.model, self.row().run());
        Path::new("target/replay").join(self.scenario.name()).join(name)
    }

    /// Writes the history as a table and as a figure, and the animation: `history.csv`, `history.svg`,
    /// `animation.html`; returns what it wrote, nothing if the run never began. A file that is there
    /// with the same content is left alone; a link is neither followed nor replaced.
    ///
    /// # Errors
    /// A file is there with other content and `force` is not set, or cannot be written.
    pub fn write(&self, folder: &Path, force: bool) -> Result<Vec<PathBuf>, ReplayError> {
        if self.history.moments.is_empty() {
            return Ok(Vec::new());
        }
        let files = [
            ("history.csv", self.history.csv(self.scenario.spin_axis())),
            ("history.svg", picture::svg(self)),
            ("animation.html", page::html(self)),
        ]
        .map(|(name, content)| (folder.join(name), content));
        // All are looked at before the first is written.
        for (path, content) in &files {
            must_write(path, content.as_bytes(), force)?;
        }
        fs::create_dir_all(folder)
            .map_err(|source| ReplayError::Write { path: folder.to_owned(), source })?;
        for (path, content) in &files {
            write_file(path, content.as_bytes(), force)?;
        }
        Ok(files.map(|(path, _)| path).into())
    }

    /// Holds the row against that of a run table, bit by bit.
    fn compare(&self, table: &Path, kept: &Kept) -> Result<(), ReplayError> {
        let unreadable = |source| ReplayError::Table { path: table.to_owned(), source };
        let differs = |column: &str, found: String, replayed: String| ReplayError::Differs {
            path: table.to_owned(),
            column: column.to_owned(),
            table: found,
            replayed,
        };
        let found = read_run(table, (&self.model, self.row().run())).map_err(unreadable)?;
        let found = found
            .ok_or_else(|| unreadable(ParquetError::General("it has no such run".to_owned())))?;
        let columns: BTreeSet<_> =
            kept.kept_columns(&self.own).into_iter().map(Column::name).collect();
        if columns.len() != found.len() {
            let count = |n: usize| format!("{n} columns");
            return Err(differs("the number of columns", count(found.len()), count(columns.len())));
        }
        let row = self.row();
        let own = row.cells().filter(|(column, _)| columns.contains(column.name()));
        for ((column, own), (name, cell)) in own.zip(found) {
            if column.name() != name {
                return Err(differs("the name of a column", name, column.name().to_owned()));
            }
            if own != cell {
                return Err(differs(&name, cell.to_string(), own.to_string()));
            }
        }
        Ok(())
    }
}
