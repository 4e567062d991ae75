//! Why a run is not replayed.

use gyradius_campaign::{RunsError, TableError};
use gyradius_formats::WriteError;
use gyradius_separation::RunError;
use std::path::PathBuf;

use crate::{Fleet, ResultsError, ScenarioError};

/// Longest coast, s: what a history still shows.
pub(super) const MOST_COAST: f64 = 3600.0;

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
        "vehicle {vehicle}, flight {flight}: the scenario has {}",
        fleet.map_or_else(
            || "no vehicles: name the run by its number".to_owned(),
            |fleet| format!("{fleet}, all numbered from 0")
        )
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
    /// The simulator could not do the run, though the run is not to blame.
    #[error("{problem}; nothing is known of the run")]
    Fault {
        /// What is wrong.
        problem: String,
    },
    /// It was told to stop before the run had ended.
    #[error("stopped")]
    Stopped,
    /// The run table cannot be read.
    #[error("cannot read {problem}")]
    Table {
        /// Which, and why.
        problem: RunsError,
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
        "{}: {column} of the run is {table}, and the replay has {replayed}: {causes}", path.display()
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
        /// What may be the cause.
        causes: &'static str,
    },
    /// A file is there already, and another, or cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
