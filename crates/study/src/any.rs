//! A scenario of either kind, and what becomes of it: for programs that are given a file or a folder.

use gyradius_campaign::{
    Event, FolderError, Forecast, Kept, Progress, Shard, SimulatorFunction, StoppingRule, Until,
    begun, folder_of,
};
use serde::Serialize;
use std::{
    fmt,
    path::{Path, PathBuf},
};

use crate::{
    Fleet, FoldedRoot, Notice, OffNominal, Options, Rare, RareOptions, ResultsError, Scenario,
    ScenarioError, SimulatorScenario, Status, Study, StudyError, UnmatchedLaw,
    carry_out::carry_out,
    decisions, drivers,
    head::{Head, Judged, Missing},
    rare, results,
    scenario::{scenario_file, scenario_text},
    shards,
    subject::{Subject, Summarized},
    unfinished::begun_study,
    what_is_left,
};

/// A scenario of separations, or of a simulator of the user's own, which has a table `[simulation]`.
#[derive(Clone, Debug)]
pub enum AnyScenario {
    /// Of separations.
    Separation(Box<Scenario>),
    /// Of a simulator.
    Simulator(Box<SimulatorScenario>),
}

/// Does the same with a scenario of either kind.
macro_rules! of_either {
    ($any:expr, $scenario:ident => $done:expr) => {
        match $any {
            AnyScenario::Separation($scenario) => $done,
            AnyScenario::Simulator($scenario) => $done,
        }
    };
}

/// Makes another scenario of a scenario of either kind, which it stays.
macro_rules! either_again {
    ($any:expr, $scenario:ident => $again:expr) => {
        match $any {
            AnyScenario::Separation($scenario) => AnyScenario::Separation(Box::new($again)),
            AnyScenario::Simulator($scenario) => AnyScenario::Simulator(Box::new($again)),
        }
    };
}

impl AnyScenario {
    /// Reads a scenario file. What it keeps of the run tables and what it requires must be columns of them; of a function that
    /// tells its outputs by its first answers, a study asks that before its first run.
    ///
    /// # Errors
    /// The file cannot be read, is not TOML, has an unknown key, or a value that is not allowed.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let scenario = Self::from_toml(&scenario_text(path)?, folder_of(path));
        let checked = scenario.and_then(|scenario| {
            match &scenario {
                Self::Separation(separations) => decisions::check_columns(&**separations)?,
                Self::Simulator(simulator) if simulator.outputs().is_empty() => {}
                Self::Simulator(simulator) => decisions::check_columns(&**simulator)?,
            }
            Ok(scenario)
        });
        let scenario = checked.map_err(|error| error.in_file(path))?;
        Ok(either_again!(scenario, own => own.read_from(path)))
    }

    /// Reads a scenario from the text of a file that is in a folder.
    ///
    /// # Errors
    /// It is not TOML, has an unknown key, or a value that is not allowed.
    pub fn from_toml(text: &str, folder: &Path) -> Result<Self, ScenarioError> {
        if is_of_simulator(text) {
            let scenario = SimulatorScenario::from_toml(text, folder)?;
            return Ok(Self::Simulator(Box::new(scenario)));
        }
        Ok(Self::Separation(Box::new(Scenario::from_toml(text)?)))
    }

    /// Of the study in a folder, whose files say so.
    fn of_study(text: &str, folder: &Path) -> Result<Self, StudyError> {
        Self::from_toml(text, folder).map_err(|error| StudyError::Absent {
            path: folder.to_owned(),
            problem: format!(
                "the scenario that its study was begun with cannot be read: {error}. If the study is not finished, its command, without --shard, goes on all the same"
            ),
        })
    }

    /// The same scenario, whose simulation is a function of the program: [`SimulatorScenario::with_function`].
    ///
    /// # Errors
    /// As there; the scenario is of separations.
    pub fn with_function(self, function: SimulatorFunction) -> Result<Self, ScenarioError> {
        match self {
            Self::Simulator(scenario) => {
                Ok(Self::Simulator(Box::new(scenario.with_function(function)?)))
            }
            Self::Separation(_) => {
                let problem = "missing: a scenario of separations takes no function, for gyradius simulates them itself";
                Err(ScenarioError::field("simulation", problem))
            }
        }
    }

    /// The same scenario with another number of runs for each model.
    ///
    /// # Errors
    /// The number is out of range.
    pub fn with_runs(self, runs: u64) -> Result<Self, ScenarioError> {
        Ok(either_again!(self, scenario => scenario.with_runs(runs)?))
    }

    /// The same scenario with another number of vehicles, each with as many flights.
    ///
    /// # Errors
    /// The number is out of range, or the scenario has no vehicles.
    pub fn with_vehicles(self, vehicles: u64) -> Result<Self, ScenarioError> {
        Ok(either_again!(self, scenario => scenario.with_vehicles(vehicles)?))
    }

    /// The same scenario, which keeps so much of its run tables.
    #[must_use]
    pub fn with_kept(self, kept: &Kept) -> Self {
        either_again!(self, scenario => scenario.with_kept(kept))
    }

    /// What is kept of its run tables once all runs are done.
    #[must_use]
    pub fn kept(&self) -> Kept {
        of_either!(self, scenario => scenario.kept())
    }

    /// Lengths and roots of its bodies whose laws lie below zero by more than 2.28 %.
    #[must_use]
    pub fn folded(&self) -> Vec<FoldedRoot> {
        of_either!(self, scenario => scenario.folded())
    }

    /// Laws whose means are far from the nominal values beside them.
    #[must_use]
    pub fn off_nominal(&self) -> Vec<OffNominal> {
        of_either!(self, scenario => scenario.off_nominal())
    }

    /// Laws of its bodies that have not the moments to which they were to be matched.
    #[must_use]
    pub fn unmatched(&self) -> Vec<UnmatchedLaw> {
        of_either!(self, scenario => scenario.unmatched())
    }

    /// The same scenario from another seed.
    ///
    /// # Errors
    /// The seed does not fit into a TOML integer.
    pub fn with_seed(self, seed: u64) -> Result<Self, ScenarioError> {
        Ok(either_again!(self, scenario => scenario.with_seed(seed)?))
    }

    /// As [`Scenario::with_until`].
    ///
    /// # Errors
    /// As there.
    pub fn with_until(
        self,
        rule: Option<StoppingRule>,
        look_every: Option<u64>,
    ) -> Result<Self, ScenarioError> {
        Ok(either_again!(self, scenario => scenario.with_until(rule, look_every)?))
    }

    /// As [`Scenario::with_drivers`].
    ///
    /// # Errors
    /// As there.
    pub fn with_drivers(self, base_runs: u64) -> Result<Self, ScenarioError> {
        Ok(either_again!(self, scenario => scenario.with_drivers(base_runs)?))
    }

    /// How many runs it takes to find what drives the outcome, of all models; 0 if that is not asked.
    ///
    /// # Errors
    /// A model cannot be made.
    pub fn driver_runs(&self) -> Result<u64, StudyError> {
        of_either!(self, scenario => drivers::runs(&**scenario))
    }

    /// Until when its runs go on, if not to their number.
    #[must_use]
    pub fn until(&self) -> Option<&Until> {
        of_either!(self, scenario => scenario.until())
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        of_either!(self, scenario => scenario.name())
    }

    /// Runs of each model.
    #[must_use]
    pub fn runs(&self) -> u64 {
        of_either!(self, scenario => scenario.runs())
    }

    /// The vehicles whose flights the runs are, if there are vehicles.
    #[must_use]
    pub fn fleet(&self) -> Option<Fleet> {
        of_either!(self, scenario => scenario.fleet())
    }

    /// How many models there are.
    #[must_use]
    pub fn models(&self) -> usize {
        of_either!(self, scenario => scenario.model_names().count())
    }

    /// How many runs a process is to do if none is there: those of a shard, or of all models.
    #[must_use]
    pub fn planned_runs(&self, shard: Option<Shard>) -> u64 {
        of_either!(self, scenario => shards::planned_runs(&**scenario, shard))
    }

    /// How many runs each of so many shards is to do if none is there, by their numbers. A shard without any is one too many:
    /// runs are done in blocks.
    #[must_use]
    pub fn planned_shares(&self, shards: u32) -> Vec<u64> {
        of_either!(self, scenario => shards::planned_shares(&**scenario, shards))
    }

    /// That processes which have nothing but its file can share its runs out as shards. Returns why runs cannot be done on
    /// this machine, if they cannot: another one may have the simulator.
    ///
    /// # Errors
    /// A rule ends the runs, so that their number follows from all of them; a law or a function is a program's own, which no file
    /// holds; a model cannot be made.
    pub fn check_shards(&self) -> Result<Option<ScenarioError>, ScenarioError> {
        of_either!(self, scenario => shards::check_alone(&**scenario))
    }

    /// What all runs would take in one process, by the time of a few of them; without the time where trying one may cost
    /// much.
    ///
    /// # Errors
    /// A model cannot be made, or there cannot be as many threads as the options say.
    pub fn forecast(&self, options: &Options) -> Result<Forecast, StudyError> {
        of_either!(self, scenario => shards::forecast_study(&**scenario, options))
    }

    /// Runs the scenario and writes its folder: the resolved scenario, run tables, summary, figures and report. Says what
    /// there is to say before it begins.
    ///
    /// # Errors
    /// The folder holds another study and `force` is not set; the command of a simulator cannot be started; something cannot
    /// be written. What was there stays as it was.
    pub fn run(
        &self,
        options: &Options,
        progress: Progress<'_>,
        say: &dyn Fn(Notice),
    ) -> Result<StudyOutcome, StudyError> {
        of_either!(self, scenario =>
            carry_out(&**scenario, options, progress, say).map(|study| StudyOutcome::of(&study)))
    }

    /// Finds how often a rare event happens: by subset simulation (Au & Beck 2001) that draws one group of inputs anew at a time, see
    /// [`SubsetSimulation`](gyradius_statistics::SubsetSimulation), or by importance sampling of what is drawn by normal scores, see
    /// [`SteeredSampling`](gyradius_statistics::SteeredSampling). Nothing is written. It says what a simulator wrote beyond its answers.
    ///
    /// # Errors
    /// There is no such model or column, or the numbers of runs are out of range; a simulator cannot be started; it was stopped. For importance
    /// sampling: nothing that is drawn can be steered by a normal score.
    pub fn rare(
        &self,
        event: &Event,
        options: &RareOptions,
        progress: Progress<'_>,
        say: &dyn Fn(Notice),
    ) -> Result<Rare, StudyError> {
        of_either!(self, scenario => rare::find(&**scenario, event, options, progress, say))
    }

    /// Does a share of the runs of a study, of those that are in no finished block, into its folder. Other processes may do
    /// other shares at the same time, also on other machines that have the folder in common. Nothing is put together:
    /// [`put_together`] does that, or [`run`](Self::run).
    ///
    /// # Errors
    /// The folder holds another study, or somebody has it alone, or another process does the same share; something cannot be
    /// written. Blocks that were finished stay.
    pub fn run_shard(
        &self,
        options: &Options,
        shard: Shard,
        progress: Progress<'_>,
        say: &dyn Fn(Notice),
    ) -> Result<(), StudyError> {
        of_either!(self, scenario => shards::run_shard(&**scenario, options, shard, progress, say))
    }
}

impl Status {
    /// Of the study in a folder, as its files tell, which are neither read nor locked: others may be at work.
    ///
    /// # Errors
    /// The folder holds no study, or its files cannot be read.
    pub fn read(folder: &Path) -> Result<Self, StudyError> {
        let text = shards::text(folder)?;
        let scenario = AnyScenario::of_study(&text, folder)?;
        of_either!(&scenario, scenario => Self::of(&**scenario, folder))
    }
}

/// Whether a study was begun in a folder whose runs are not all done, or not put together.
///
/// # Errors
/// Whether one was cannot be read.
pub fn is_begun(folder: &Path) -> Result<bool, FolderError> {
    Ok(begun_study(folder)?.is_some())
}

/// Puts together what is there of a study whose runs are not all done, in its folder: the study, if nothing is
/// missing, and else summary and report of the runs that are there, which say what is missing.
///
/// # Errors
/// Nothing was begun in the folder, or there are models without any run; a shard is at work.
pub fn put_together(
    folder: &Path,
    options: &Options,
    say: &dyn Fn(Notice),
) -> Result<StudyOutcome, StudyError> {
    let text = begun_study(folder)?.ok_or_else(|| StudyError::Absent {
        path: folder.to_owned(),
        problem: "it holds no study that was begun".to_owned(),
    })?;
    let scenario = AnyScenario::of_study(&text, folder)?;
    of_either!(&scenario, scenario =>
        what_is_left::put_together(&**scenario, folder, options, say).map(|study| StudyOutcome::of(&study)))
}

/// Makes the figures and the report of the study in a folder again, there or in another folder; returns the folder.
///
/// # Errors
/// As [`Results::read`](crate::Results::read) and [`Results::write_report`](crate::Results::write_report).
pub fn write_report(
    folder: &Path,
    out: Option<&Path>,
    force: bool,
) -> Result<PathBuf, ResultsError> {
    if SimulatorScenario::is_in(folder) {
        return results::write::<SimulatorScenario>(&results::read(folder)?, out, force);
    }
    results::write::<Scenario>(&results::read(folder)?, out, force)
}

impl SimulatorScenario {
    /// Whether the scenario in a file, or in the folder of a study, is of a simulator, right or wrong. A study that is not put
    /// together yet may have it in no file.
    #[must_use]
    pub fn is_in(path: &Path) -> bool {
        let text = scenario_text(&scenario_file(path)).ok().or_else(|| begun(path).ok()?);
        text.is_some_and(|text| is_of_simulator(&text))
    }
}

/// Whether the text of a scenario is of a simulator, right or wrong.
fn is_of_simulator(text: &str) -> bool {
    toml::from_str::<toml::Table>(text).is_ok_and(|table| table.contains_key("simulation"))
}

/// What became of a study: where it is, and what there is to say of it. Serialized, it is what other programs want to know;
/// every number is in `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct StudyOutcome {
    folder: PathBuf,
    #[serde(flatten)]
    head: Head,
    complete: bool,
    models: Vec<ModelOutcome>,
    #[serde(skip)]
    table: String,
}

/// What became of the runs of a model.
#[derive(Clone, Debug, Serialize)]
struct ModelOutcome {
    model: String,
    runs: u64,
    failed: u64,
}

impl StudyOutcome {
    fn of<S: Summarized>(study: &Study<S>) -> Self {
        Self::of_summary(study.folder(), study.summary())
    }

    fn of_summary<S: Summarized>(folder: &Path, summary: &S) -> Self {
        Self {
            folder: folder.to_owned(),
            head: summary.head().clone(),
            complete: summary.head().is_complete(),
            models: summary
                .failed()
                .into_iter()
                .map(|(model, failed, runs)| ModelOutcome { model, runs, failed })
                .collect(),
            table: summary.to_string(),
        }
    }

    /// Of the study in a folder, and its scenario, as the files there tell: nothing is done, nothing written, and nobody kept out.
    ///
    /// # Errors
    /// As [`Results::read`](crate::Results::read).
    pub fn read(folder: &Path) -> Result<(AnyScenario, Self), ResultsError> {
        fn of<C: Subject>(folder: &Path) -> Result<(C, StudyOutcome), ResultsError> {
            let (scenario, summary) = results::read::<C>(folder)?.into_parts();
            Ok((scenario, StudyOutcome::of_summary(folder, &summary)))
        }
        if SimulatorScenario::is_in(folder) {
            let (scenario, outcome) = of(folder)?;
            return Ok((AnyScenario::Simulator(Box::new(scenario)), outcome));
        }
        let (scenario, outcome) = of(folder)?;
        Ok((AnyScenario::Separation(Box::new(scenario)), outcome))
    }

    /// Where it is.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Each model with how many of its runs failed, and how many there are.
    pub fn failed(&self) -> impl Iterator<Item = (&str, u64, u64)> {
        self.models.iter().map(|model| (model.model.as_str(), model.failed, model.runs))
    }

    /// What the runs say of the requirements, model by model.
    #[must_use]
    pub fn requirements(&self) -> &[Judged] {
        &self.head.requirements
    }

    /// Whether all runs are done: to their number, or until a rule ended them.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.head.is_complete()
    }

    /// The runs that are not done; none of a complete study.
    #[must_use]
    pub fn missing(&self) -> &[Missing] {
        &self.head.missing
    }
}

/// What there is to say on a terminal.
impl fmt::Display for StudyOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (head, report) = (&self.head, self.folder.join("report.html"));
        let (name, runs, seed) = (&head.scenario, head.runs_per_model, head.seed);
        let vehicles = head.fleet.map_or_else(String::new, |fleet| format!("{fleet}, "));
        let s = if runs == 1 { "" } else { "s" };
        writeln!(f, "{name}: {vehicles}{runs} run{s} a model, seed {seed}\n")?;
        if let Some(ended) = &head.ended {
            writeln!(f, "{ended}\n")?;
        }
        for judged in &head.requirements {
            let requirement = judged.judgement().requirement().name();
            writeln!(f, "requirement {requirement}, {}\n{}", judged.model(), judged.judgement())?;
        }
        for drivers in &head.drivers {
            for driven in drivers.outputs.iter().filter(|driven| driven.unit.is_none()) {
                let ranked = driven.ranked(&drivers.groups).into_iter().take(3);
                let shares = ranked.filter_map(|(group, index)| {
                    Some(format!("{group} {}", drivers::told(index.total()?)))
                });
                let shares = shares.collect::<Vec<_>>().join(", ");
                let (output, model) = (&driven.output, &drivers.model);
                let few = if driven.indices.is_of_few() { "; too few runs count" } else { "" };
                writeln!(
                    f,
                    "what fails {output}, {model}, by total Sobol' indices: {shares}{few}\n"
                )?;
            }
        }
        writeln!(f, "{}", self.table)?;
        head.missing.iter().try_for_each(|runs| writeln!(f, "missing: {runs}"))?;
        writeln!(f, "report: {}", report.display())
    }
}
