//! Monte Carlo studies of spacecraft separation under inertia uncertainty, from a scenario file to
//! a report.
//!
//! Data flows one way: [`Scenario`] → draws → separations → [`Table`] → [`Summary`] → figures and
//! report, and [`Study::run`] takes it along. A row depends on (seed, model, run) alone, so results
//! are the same bits on any number of threads, and every run can be replayed.
//!
//! ```no_run
//! use gyradius_study::{Options, Scenario, Study};
//!
//! let scenario = Scenario::peck_2003()?.with_runs(500)?;
//! let study = Study::run(&scenario, &Options::default(), &|_done| {})?;
//! println!("{}{}", study.summary(), study.folder().display());
//! # Ok::<(), gyradius_study::StudyError>(())
//! ```

mod about;
mod alerts;
mod any;
mod backwards;
mod body;
mod carry_out;
mod claim;
mod claims;
mod column;
mod compare;
mod configuration;
mod contents;
mod csv;
mod decisions;
mod draw;
mod drawn;
mod driven;
mod drivers;
mod ended;
mod error;
mod failure;
mod far_lobe;
mod faults;
mod figures_of_study;
mod fleet;
mod folded;
mod fragment;
mod groups;
mod head;
mod law_file;
mod loads;
mod model;
mod off_nominal;
mod off_roots;
mod options;
mod quantity;
mod rare;
mod read_only;
mod regions;
mod releases;
mod replay;
mod report;
mod results;
mod robots;
mod rollup;
mod rounding;
mod run;
mod scenario;
mod seen;
mod separations;
mod shards;
mod simulator;
mod solid;
mod steering;
mod study;
mod subject;
mod summary;
mod text;
#[cfg(test)]
mod two_loops;
mod unfinished;
mod unit;
mod unmatched;
mod unusual;
mod what_is_left;
mod where_runs_fail;

pub use any::{AnyScenario, StudyOutcome, is_begun, put_together, write_report};
pub use body::Entry;
pub use compare::{CompareOptions, ModelComparison, Reference};
pub use draw::{Draw, DrawError, DrawOptions};
pub use driven::{Driven, Drivers};
pub use ended::Ended;
pub use error::StudyError;
pub use failure::RunFailure;
pub use fleet::Fleet;
pub use folded::FoldedRoot;
pub use fragment::{Fragment, FragmentBody, FragmentError};
pub use gyradius_campaign::{
    Again, Bound, CampaignError, Cell, Column, Event, FailedRuns, Forecast, ForeignError,
    ForeignTable, FormatError, Judgement, JudgementError, Kept, KeptColumn, KeptError, KeptRuns,
    KeptTexts, KeptValues, Looks, Outputs, Progress, Requirement, RequirementError, Row, Rows,
    RunInputs, Runs, RunsError, Shard, ShardError, SimulatorFunction, StoppingRule, Table,
    TableFormat, Until, UntilError, Verdict, rough_time,
};
pub use gyradius_dispersion::ModelKind;
pub use gyradius_report::{visible, visible_json};
pub use head::{Head, Judged, Missing};
pub use law_file::LawFile;
pub use off_nominal::OffNominal;
pub use options::{Notice, Options};
pub use quantity::Quantity;
pub use rare::{Rare, RareEstimate, RareFailures, RareMethod, RareOptions, RareWarning};
pub use replay::{Replay, ReplayError, Which};
pub use results::{Results, ResultsError};
pub use robots::{
    Inside, LeftBecause, LinkSummary, RobotDraw, RobotDrawError, RobotDrawOptions, RobotFolder,
    as_written, inset,
};
pub use rollup::{DrawnMoments, NaiveShares, Rollup, RollupDraws, RollupError, RollupOptions};
pub use scenario::{Scenario, ScenarioError, TomlError, parse_toml, scenario_text, whole_number};
pub use shards::{ModelStatus, Status};
pub use simulator::{SimulatorReplay, SimulatorScenario, SimulatorSummary};
pub use study::{Study, restore_studies};
pub use summary::Summary;
pub use unfinished::{begun_study, replacement};
pub use unmatched::UnmatchedLaw;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
