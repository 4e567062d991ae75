//! Monte Carlo of any simulation: random streams, runs on many threads, the run table, what it amounts to.
//!
//! A [`Simulation`] turns random draws into the columns of a [`Table`]. What a run writes depends on (seed,
//! model, run) alone, because its random numbers come from [`Streams`] that are keyed by these and by a purpose:
//! the same bits on any number of threads, and every run can be done again alone. A run that fails is a row
//! with its reason. This crate knows no physics.
//!
//! ```
//! use gyradius_campaign::{Cell, Column, Failure, Simulation, Streams, Table, TableError};
//! use gyradius_campaign::{SampleSummary, run, threads};
//! use rand_distr::{Distribution, Normal};
//!
//! /// How far a ball flies that is thrown with an uncertain velocity.
//! struct Throw {
//!     velocities: Streams,
//! }
//!
//! impl Simulation for Throw {
//!     type Worker = ();
//!
//!     fn columns(&self) -> Vec<Column> {
//!         vec![
//!             Column::number("velocity_m_per_s", "m/s", "Velocity, as drawn."),
//!             Column::number("range_m", "m", "Where the ball lands."),
//!         ]
//!     }
//!
//!     fn worker(&self) {}
//!
//!     fn run(
//!         &self,
//!         runs: std::ops::Range<u64>,
//!         _: &mut (),
//!         rows: &mut Table,
//!     ) -> Result<(), TableError> {
//!         let law = Normal::new(10.0, 3.0).expect("3 is a standard deviation");
//!         for run in runs {
//!             let velocity: f64 = law.sample(&mut self.velocities.run(run));
//!             let backward = || Failure::new("thrown backward", format!("thrown at {velocity} m/s"));
//!             if velocity > 0.0 {
//!                 rows.push(None, [velocity.into(), (velocity * velocity / 9.81).into()])?;
//!             } else {
//!                 rows.push(Some(backward()), [velocity.into(), Cell::Null])?;
//!             }
//!         }
//!         Ok(())
//!     }
//! }
//!
//! let throw = Throw { velocities: Streams::new(7, "throw", "velocity") };
//! let table = run(&throw, "throw", 1000, &threads(None)?, &|_done| {})?;
//! let ranges: Vec<f64> = table.numbers("range_m").into_iter().flat_map(|n| n.present()).collect();
//! let range = SampleSummary::new(&ranges, Default::default());
//! assert!((range.mean.unwrap() - (100.0 + 9.0) / 9.81).abs() < 1.0);
//! assert_eq!(table.len(), 1000);
//! # Ok::<(), gyradius_campaign::CampaignError>(())
//! ```

mod again;
mod campaign;
mod cell;
mod chacha8;
mod column;
mod csv_lines;
mod designs;
mod external;
mod failure;
mod folder;
mod forecast;
mod foreign;
mod format;
mod hash;
mod identity;
mod kept;
mod kept_runs;
mod memory;
mod number;
mod origin;
mod requirement;
mod room;
mod runs;
mod runs_error;
mod sample;
mod shard;
mod share;
mod simulation;
mod spans;
mod stack;
mod stop;
mod stored;
mod stream;
mod stream_rng;
mod streams;
mod subset;
mod surveys;
mod table;
mod until;
mod values;

pub use again::{Again, Changed, run_again, run_changed};
pub use campaign::{Doing, Look, Plan, run_missing};
pub use cell::Cell;
pub use column::{Column, ColumnSummary, Kind};
pub use designs::{Designs, DesignsError, Mix, Output};
pub use external::{
    ExternalSimulation, Inputs, Outputs, Program, ProgramError, RunInputs, Simulator,
    SimulatorFunction, Told, Unasked,
};
pub use failure::Failure;
pub use folder::{
    Block, Blocks, Contents, FinishedRuns, Folder, FolderError, HIDDEN, MANIFEST, Manifest,
    Reduced, Shared, begun, changed, folder_of, missing_runs, replacing, restore, restore_all,
    told, told_runs, why_unknown,
};
pub use forecast::{Forecast, rough_size, rough_time};
pub use foreign::{
    Columns, ForeignError, ForeignTable, NoRunError, OfModels, RowsError, RunNames, TwiceError,
};
pub use format::{Extent, FormatError, TableFormat, TableWriter};
pub use gyradius_statistics::Verdict;
pub use hash::sha256;
pub use identity::{Difference, Identity};
pub use kept::{Kept, KeptError, Rows};
pub use kept_runs::{KeptColumn, KeptRuns, KeptTexts, KeptValues};
pub use memory::memory_left;
pub use number::{of_percent, plain};
pub use requirement::{
    Bound, ConvergencePoint, Counting, Distribution, DistributionPoint, Event, FailedRuns,
    Judgement, JudgementError, Judging, Looks, Measured, Requirement, RequirementError, RunBeyond,
    VehiclesKeeping, one_decimal, percent_beside, percent_or_less, percent_or_more, rounded_down,
    share_in_percent, stated_in_percent,
};
pub use room::disk_left;
pub use runs::Runs;
pub use runs_error::RunsError;
pub use sample::{SampleSummary, bounded};
pub use shard::{Shard, ShardError};
pub use share::{Share, counted};
pub use simulation::{CampaignError, Progress, Simulation, go_on, run, threads};
pub use spans::Spans;
pub use stack::stack_size;
pub use stop::is_stopped;
pub use stored::read_run;
pub use stream::stream;
pub use stream_rng::StreamRng;
pub use streams::Streams;
pub use subset::Subset;
pub use surveys::{FirstLook, Surveys};
pub use table::{Row, Table, TableError};
pub use until::{End, Evidence, StoppingRule, Until, UntilError, run_until};
pub use values::Numbers;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
