//! One run of a study again, bit for bit, with all that happens in it.

mod error;
mod film;
mod grid;
mod held;
mod history;
mod outlines;
pub(crate) mod page;
mod picture;
mod words;

use gyradius_campaign::{Row, Simulation, Table, folder_of, restore};
use gyradius_clearance::Clearance;
use gyradius_formats::{WriteError, must_write, write_file};
use gyradius_separation::{Separation, Step};
use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::{
    Results, ResultsError, Scenario,
    model::{Model, Separations},
    run::{Case, End},
    scenario::Framed,
    subject::Subject,
    unfinished::unfinished,
};
use error::MOST_COAST;
pub use error::ReplayError;
use film::Film;
pub(crate) use held::Held;
use history::History;

/// Why a row may be another than that of the study.
const CAUSES: &str = "the table was changed, or made by another build";

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
    film: Film,
    /// How near the bodies come, if that is watched and the run ends well.
    clearance: Option<Clearance>,
    /// Whether outlines may touch where no contact was found.
    given_up: bool,
    /// The table whose row it was held against.
    table: Held,
}

impl Replay {
    /// Replays a run of the study in a folder, and holds it against the run table there, also if the study is not put
    /// together yet; or of a scenario file, which has none. The model is the first of the scenario if not given. The history
    /// goes on for `coast_s` after the last release.
    ///
    /// # Errors
    /// The folder holds no study, or one by another version or from another scenario; there is no such
    /// model or run; the coast is not within 0 and 3600 s, or takes too many steps; the table says otherwise.
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
        let scenario = match unfinished(path)? {
            Some(scenario) => scenario,
            None => Results::read(path)?.into_parts().0,
        };
        Self::new(&scenario, model, run, coast_s)?.held_against(path)
    }

    /// Holds the row against that of the run table in the folder of a study, bit by bit, also if it is not put together yet:
    /// for a study with models of a program's own, which [`open`](Self::open) cannot draw.
    ///
    /// # Errors
    /// There is no such table, or it says otherwise.
    pub fn held_against(mut self, folder: &Path) -> Result<Self, ReplayError> {
        self.table = Held::against(folder, &self.own, CAUSES)?;
        Ok(self)
    }

    /// Replays a run of a scenario.
    ///
    /// # Errors
    /// There is no such model or run; the coast is not within 0 and 3600 s, or takes too many steps.
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
        let spec = &scenario.models()[scenario.place_of(model)?];
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
        let events = history.moments.iter().filter(|moment| !moment.event.is_empty());
        let film = case.separation.as_ref().map_or_else(
            |_| Film::default(),
            |separation| {
                let events = events.map(|moment| moment.now.time_s());
                Film::new(separation, &steps, history.pushing_s(), events)
            },
        );
        let simulation = Separations::new(scenario, &model);
        let mut own = Table::new(&spec.name, run, simulation.columns())?;
        let run = case.ended(scenario, result);
        simulation.push(&run, &mut own)?;
        let clearance = run.end().and_then(End::clearance).cloned();
        let given_up = run.end().is_some_and(End::is_given_up);
        Ok(Self {
            own,
            history,
            film,
            scenario: scenario.clone(),
            model: spec.name.clone(),
            case,
            clearance,
            given_up,
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
    /// `animation.html`; returns what it wrote. A file that is there with the same content is left alone; a
    /// link is neither followed nor replaced. If the run never began, or failed before its first
    /// step could be taken, there is nothing to write, and what is there of another run is removed.
    ///
    /// # Errors
    /// A file is there with other content and `force` is not set, or cannot be written or removed.
    pub fn write(&self, folder: &Path, force: bool) -> Result<Vec<PathBuf>, ReplayError> {
        let [table, figure, animation] =
            ["history.csv", "history.svg", "animation.html"].map(|name| folder.join(name));
        if self.history.moments.is_empty() {
            let mut old = [table, figure, animation].to_vec();
            old.retain(|path| fs::symlink_metadata(path).is_ok());
            // All are looked at before the first is removed; of an empty one, too, nobody knows whose it is.
            for path in &old {
                must_write(path, &[], force)?;
                if !force {
                    return Err(WriteError::Exists(path.clone()).into());
                }
            }
            for path in old {
                fs::remove_file(&path).map_err(|error| WriteError::Io { path, error })?;
            }
            return Ok(Vec::new());
        }
        let files = [
            (table, self.history.csv(self.scenario.spin_axis())),
            (figure, picture::svg(self)),
            (animation, page::html(self)),
        ];
        // All are looked at before the first is written.
        for (path, content) in &files {
            must_write(path, content.as_bytes(), force)?;
        }
        fs::create_dir_all(folder)
            .map_err(|error| WriteError::Io { path: folder.to_owned(), error })?;
        for (path, content) in &files {
            write_file(path, content.as_bytes(), force)?;
        }
        Ok(files.map(|(path, _)| path).into())
    }
}
