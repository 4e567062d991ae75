//! What a study is of: a scenario of separations, or of a simulator of the user's own.

use gyradius_campaign::{Column, FirstLook, Forecast, Runs, Simulation, Table, Unasked, sha256};
use gyradius_report::Document;
use gyradius_statistics::Confidence;
use rayon::ThreadPool;
use serde::{Serialize, de::DeserializeOwned};
use std::{
    fmt::Display,
    path::Path,
    sync::{Arc, atomic::AtomicBool},
};

use crate::{
    ScenarioError, StudyError,
    groups::{Drawing, Groups},
    head::Head,
    rounding::Rounding,
    scenario::Framed,
    unusual::DrawnInput,
};

/// What a study is of: models whose runs are simulated, what they amount to, and the pages that show it.
pub(crate) trait Subject: Framed + Sync {
    /// Runs of a block: what is lost, at most, on each thread that is interrupted.
    const BLOCK_RUNS: u64;
    /// What each of the [main outcomes](Self::main_outcomes) is called on a page.
    const MAIN_OUTCOMES: &str;
    /// Keys of the resolved scenario, by their paths, that no run depends on.
    const IMMATERIAL: &[&str];

    /// What is made of the scenario before its runs.
    type Prepared: Sync;
    /// The runs of a model.
    type Simulation<'a>: Grouped
    where
        Self: 'a;
    /// What is seen of the runs of a model while they are done.
    type Look<'a>: LookAt
    where
        Self: 'a;
    /// What the runs amount to.
    type Summary: Summarized;

    /// Reads a scenario that was resolved, as the folder of a study has it.
    fn resolved(text: &str) -> Result<Self, ScenarioError>;
    /// Makes what draws and simulates, and lets go of runs at hand once `stop` is true, if they can take long.
    fn prepare(&self, stop: Option<&Arc<AtomicBool>>) -> Result<Self::Prepared, ScenarioError>;
    /// Makes certain, before the first run, that runs can be done.
    fn begin(&self, models: &Self::Prepared) -> Result<(), ScenarioError>;
    /// What so many runs will take, all models together; without the time where trying it may cost much.
    fn forecast(
        &self,
        simulations: &[(&str, Self::Simulation<'_>)],
        left: u64,
        threads: &ThreadPool,
    ) -> Result<Forecast, StudyError>;
    /// The runs of the model in a place that draw this of its groups of inputs.
    fn drawing<'a>(
        &'a self,
        models: &'a Self::Prepared,
        place: usize,
        drawing: Drawing,
    ) -> Result<Self::Simulation<'a>, ScenarioError>;
    /// The columns of the run tables after model, run and status, as far as they are known before the first run.
    fn run_columns(&self) -> Vec<Column>;
    /// The columns of numbers and flags that come of a run, and are not drawn for it.
    fn outcomes(&self) -> Vec<String>;
    /// The columns of numbers that are drawn for a run.
    fn drawn_columns(&self) -> Vec<String>;
    /// The columns of the entries of the inertia of each body, which are held against each other.
    fn inertias(&self) -> Vec<[String; 6]>;
    /// The columns of the outcomes that are told of first.
    fn main_outcomes(&self) -> Vec<String>;
    /// A look at the runs of a model, which have these columns.
    fn look(&self, model: &str, columns: &[Column]) -> Self::Look<'_>;
    /// The unit of a column, where its name does not tell it.
    fn unit(&self, _column: &str) -> Option<String> {
        None
    }
    /// The name of the function that does the runs, if one does: no file holds it, so that no command does them again.
    fn function_name(&self) -> Option<&str> {
        None
    }
    /// Whether what does the runs can be another one under the same name, as a function can.
    fn may_change(&self) -> bool {
        false
    }
    /// How much of the outcomes of runs is rounding.
    fn rounding(&self) -> Rounding;
    /// What a simulator wrote that nobody had asked for.
    fn unasked(&self, _: &Self::Prepared) -> Option<Unasked> {
        None
    }
    /// What the runs amount to: every number, judgement and figure, before any page is made.
    fn judge(
        &self,
        models: &Self::Prepared,
        looks: Vec<Self::Look<'_>>,
        runs: &[Runs],
    ) -> Result<Self::Summary, StudyError>;
    /// What runs of a model draw, with what it amounts to.
    fn drawn_inputs(&self, summary: &Self::Summary, model: &str) -> Vec<DrawnInput>;
    /// What may be written of the report, as files and folders.
    fn report_files(&self) -> Vec<String>;
    /// The report, from a summary that was read back.
    fn report(&self, summary: &Self::Summary) -> Document;

    /// The runs of each model, by its name.
    fn simulations<'a>(
        &'a self,
        models: &'a Self::Prepared,
    ) -> Result<Vec<(&'a str, Self::Simulation<'a>)>, ScenarioError> {
        let of = |(place, name): (usize, &'a str)| {
            Ok((name, self.drawing(models, place, Drawing::Plain)?))
        };
        self.model_names().enumerate().map(of).collect()
    }
}

/// Runs of a model of which it is known what they draw.
pub(crate) trait Grouped: Simulation {
    /// The groups of inputs that the model draws independently of each other.
    fn groups(&self) -> &Groups;
    /// The scores of so many of these runs; none unless they are steered.
    fn steered(&self, runs: u64) -> Vec<Vec<f64>>;
    /// The same, of whose columns only those of these names are wanted: its runs may leave out others.
    fn wanted(self, names: &[String]) -> Self;
}

/// What runs amount to, for a terminal, for a file and for a report.
pub(crate) trait Summarized: Display + Serialize + DeserializeOwned + Send + Sync {
    /// Of what it is.
    fn head(&self) -> &Head;
    /// Of what it is, to be completed.
    fn head_mut(&mut self) -> &mut Head;
    /// Each model with how many of its runs failed, and how many there are.
    fn failed(&self) -> Vec<(String, u64, u64)>;
}

/// What looks at blocks while runs are done: once at each, and in any order.
pub(crate) trait LookAt: Sync {
    /// Looks at one.
    fn look(&self, block: &Table);
}

impl LookAt for FirstLook {
    fn look(&self, block: &Table) {
        self.look(block);
    }
}

/// What a summary of all runs of a scenario says first; their tables have these columns.
pub(crate) fn head_of(scenario: &impl Subject, columns: &[Column]) -> Head {
    Head {
        gyradius_version: env!("CARGO_PKG_VERSION").into(),
        scenario: scenario.name().to_owned(),
        about: scenario.about(),
        fingerprint: sha256(scenario.to_toml()),
        seed: scenario.seed(),
        runs_per_model: scenario.runs(),
        fleet: scenario.fleet(),
        independent_runs_per_model: scenario.independent_runs(),
        missing: Vec::new(),
        done_again: 0,
        ended: None,
        drivers: Vec::new(),
        where_runs_fail: Vec::new(),
        alerts: Vec::new(),
        requirements: Vec::new(),
        confidence: Confidence::default().level(),
        columns: columns.iter().map(Column::summary).collect(),
    }
}

/// Reads the scenario in a file of a study, which says in which file what is wrong.
pub(crate) fn read_resolved<C: Subject>(file: &Path) -> Result<C, ScenarioError> {
    let text = crate::scenario::scenario_text(file)?;
    C::resolved(&text).map_err(|error| error.in_file(file))
}
