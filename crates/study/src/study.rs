//! A study: a scenario, run and reported into a folder.

#[cfg(test)]
use gyradius_campaign::run;
use gyradius_campaign::{
    Blocks, CampaignError, Contents, Doing, Folder, Forecast, Identity, MANIFEST, Plan, Progress,
    Runs, RunsError, Simulation, Table, begun, run_missing, threads,
};
use rayon::ThreadPool;
use std::{
    collections::BTreeSet,
    fs,
    ops::Range,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock, atomic::AtomicBool},
};
use toml::{Table as Toml, Value};

use crate::{
    Scenario, StudyError, Summary, claims,
    compare::Section,
    figures_of_study,
    model::{Model, Separations},
    report,
    scenario::parse_toml,
    seen::Looking,
    summary::Missing,
};

/// How to carry out a study.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Where to; `target/study/<scenario name>` if not given.
    pub out: Option<PathBuf>,
    /// How many threads; as many as the machine has if not given.
    pub threads: Option<usize>,
    /// Replace another study in the folder.
    pub force: bool,
    /// Set from elsewhere to stop: blocks of runs that are finished stay, and the same study goes on.
    pub stop: Option<Arc<AtomicBool>>,
}

/// Runs of a block: some tenths of a second of separations.
pub(crate) const BLOCK_RUNS: u64 = 1 << 14;

/// What a study says before its runs.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Notice {
    /// How long the runs will take that are to be done.
    Forecast(Forecast),
    /// So many runs of all models are there already.
    GoesOn {
        /// Runs that are there.
        done: u64,
        /// Runs of all models.
        of: u64,
    },
    /// A block of runs is not as it was written, and is done again.
    Damaged(String),
}

/// A study carried out and written.
#[derive(Debug)]
pub struct Study {
    folder: PathBuf,
    runs: Vec<Runs>,
    summary: Summary,
}

impl Study {
    /// Runs a scenario and writes its folder: the resolved scenario, run tables, summary, figures
    /// and report.
    ///
    /// # Errors
    /// The folder holds another study and `force` is not set, or something cannot be written. What
    /// was there stays as it was.
    pub fn run(
        scenario: &Scenario,
        options: &Options,
        progress: Progress<'_>,
    ) -> Result<Self, StudyError> {
        Self::run_with_notices(scenario, options, progress, &|_| {})
    }

    /// As [`run`](Self::run), and says what there is to say before it begins.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_with_notices(
        scenario: &Scenario,
        options: &Options,
        progress: Progress<'_>,
        say: &dyn Fn(Notice),
    ) -> Result<Self, StudyError> {
        Self::carry_out(scenario, options, Doing::All, progress, say)
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
    ) -> Result<Self, StudyError> {
        let none = || StudyError::Absent {
            path: folder.to_owned(),
            problem: "it holds no study that was begun".to_owned(),
        };
        let scenario = Scenario::from_toml(&begun(folder).ok_or_else(none)?)?;
        let options = Options { out: Some(folder.to_owned()), ..options.clone() };
        Self::carry_out(&scenario, &options, Doing::Nothing, &|_| {}, say)
    }

    fn carry_out(
        scenario: &Scenario,
        options: &Options,
        doing: Doing,
        progress: Progress<'_>,
        say: &dyn Fn(Notice),
    ) -> Result<Self, StudyError> {
        let threads = threads(options.threads)?;
        let place = options.place(scenario);
        let models = Model::all(scenario)?;
        let simulations = simulations(scenario, &models);
        let in_place = OnceLock::<BTreeSet<String>>::new();
        let contents =
            contents(scenario).keeping(|name| in_place.get().is_some_and(|all| all.contains(name)));
        let mut folder = Folder::prepare(&place, &contents, options.force)?;
        let text = scenario.to_toml();
        let begun = (&identity(scenario), text.as_str());
        let blocks = folder.blocks(begun, scenario.runs(), options.force, &threads)?;
        blocks.damaged().iter().for_each(|damage| say(Notice::Damaged(damage.clone())));

        let plan = plan(scenario, options, doing);
        let all = Plan { doing: Doing::All, ..plan };
        let mut left = 0;
        for (at, model) in models.iter().enumerate() {
            let missing = all.missing(&blocks, at, model.name());
            folder.check_places(model.name(), &missing)?;
            left += count(&missing);
        }
        // A complete study that is being extended stays one until all of the runs are there: its blocks and what tells of them.
        let manifest = (doing == Doing::Nothing && left > 0).then(|| MANIFEST.to_owned());
        let _ = in_place.set(blocks.published().into_iter().chain(manifest).collect());
        let of = scenario.runs() * models.len() as u64;
        if left == 0
            && let Some(study) = Self::finished(&folder, &text, &simulations, &blocks)?
        {
            return Ok(study);
        }
        if left < of && doing == Doing::All {
            say(Notice::GoesOn { done: of - left, of });
        }
        if left > 0 && doing == Doing::All {
            say(Notice::Forecast(forecast(&simulations, left, &threads)?));
        }
        let done = threads.install(|| {
            let looks = looks(scenario, &simulations)?;
            let look = |place: usize, block: &Table| looks[place].look(block);
            let runs = run_missing(&simulations, &blocks, plan, progress, Some(&look))?;
            if let Some(none) = runs.iter().find(|runs| runs.end() == 0) {
                let problem = format!("there are no runs of the model {:?} yet", none.model());
                return Err(StudyError::Absent { path: place.clone(), problem });
            }
            let mut summary = judge(scenario, &models, looks, &runs)?;
            summary.missing = gaps(&blocks, scenario);
            Ok((runs, summary))
        });
        let (runs, summary) = done.inspect_err(|_| blocks.abandon())?;

        let complete = summary.missing.is_empty();
        if complete {
            folder.adopt(&blocks, runs.first().map_or(&[][..], Runs::columns))?;
        }
        folder.write("scenario.toml", &text)?;
        let written = serde_json::to_string_pretty(&summary)? + "\n";
        folder.write("summary.json", &written)?;
        // The report is made from what a reader of the folder has.
        let summary: Summary = serde_json::from_str(&written)?;
        let report = threads.install(|| report::report(scenario, &summary));
        for (name, content) in report.files(report::NAME) {
            folder.write(&name, &content)?;
        }
        let folder = folder.publish()?;
        if complete {
            blocks.settle()?;
        }
        let runs = runs.into_iter().map(|runs| blocks.in_place(&runs)).collect();
        Ok(Self { folder, runs, summary })
    }

    /// The study in a folder, if all of it is there as it was written.
    fn finished(
        folder: &Folder<'_>,
        text: &str,
        simulations: &[(&str, Separations<'_>)],
        blocks: &Blocks,
    ) -> Result<Option<Self>, StudyError> {
        if !(blocks.all_in_place() && folder.is_whole(text)?) {
            return Ok(None);
        }
        let place = folder.place().to_owned();
        let read = fs::read_to_string(place.join("summary.json")).ok();
        let summary = read.and_then(|text| serde_json::from_str::<Summary>(&text).ok());
        let Some(summary) = summary.filter(|summary| summary.missing.is_empty()) else {
            return Ok(None);
        };
        let runs = simulations.iter().map(|(model, simulation)| {
            let empty = Table::new(model, 0, simulation.columns())?;
            Ok(blocks.runs(&empty, Vec::new()))
        });
        let runs = runs.collect::<Result<_, CampaignError>>()?;
        blocks.settle()?;
        Ok(Some(Self { folder: place, runs, summary }))
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
    pub fn summary(&self) -> &Summary {
        &self.summary
    }
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

impl Options {
    /// The folder that a study of a scenario goes to.
    pub(crate) fn place(&self, scenario: &Scenario) -> PathBuf {
        let default = || Path::new("target/study").join(scenario.name());
        self.out.clone().unwrap_or_else(default)
    }
}

/// The separations of each model, by its name.
pub(crate) fn simulations<'a>(
    scenario: &'a Scenario,
    models: &'a [Model],
) -> Vec<(&'a str, Separations<'a>)> {
    models.iter().map(|model| (model.name(), Separations::new(scenario, model))).collect()
}

/// How the runs of a scenario are done.
pub(crate) fn plan<'a>(scenario: &Scenario, options: &'a Options, doing: Doing) -> Plan<'a> {
    Plan { runs: scenario.runs(), block_runs: BLOCK_RUNS, doing, stop: options.stop.as_deref() }
}

/// How many runs there are in some ranges.
pub(crate) fn count(ranges: &[Range<u64>]) -> u64 {
    ranges.iter().map(|runs| runs.end - runs.start).sum()
}

/// How long so many runs of all models will take.
pub(crate) fn forecast(
    simulations: &[(&str, Separations<'_>)],
    left: u64,
    threads: &ThreadPool,
) -> Result<Forecast, CampaignError> {
    let timed = simulations.iter().map(|(_, simulation)| simulation);
    let each = left.div_ceil(simulations.len() as u64);
    Ok(Forecast::of(timed, each, threads.current_num_threads())?)
}

/// The runs of each model that are missing, where any are.
fn gaps(blocks: &Blocks, scenario: &Scenario) -> Vec<Missing> {
    let of_model = |model: &str| {
        let ranges = blocks.missing(model, scenario.runs(), u64::MAX);
        ranges.into_iter().map(|runs| Missing::new(model, runs)).collect::<Vec<_>>()
    };
    scenario.model_names().flat_map(of_model).collect()
}

/// A look at the runs of each model.
fn looks<'a>(
    scenario: &'a Scenario,
    simulations: &[(&str, Separations<'_>)],
) -> Result<Vec<Looking<'a>>, CampaignError> {
    let look = |(model, simulation): &(&str, Separations<'_>)| {
        let table = Table::new(model, 0, simulation.columns())?;
        Ok(Looking::new(scenario, model, table.columns()))
    };
    simulations.iter().map(look).collect()
}

/// What the runs of a scenario amount to: every number, judgement and figure, before any page is made.
pub(crate) fn judge(
    scenario: &Scenario,
    models: &[Model],
    looks: Vec<Looking<'_>>,
    runs: &[Runs],
) -> Result<Summary, StudyError> {
    let seen = looks.into_iter().zip(runs).map(|(look, runs)| look.finish(runs));
    let seen = seen.collect::<Result<Vec<_>, _>>()?;
    let columns = runs.first().map_or(&[][..], Runs::columns);
    let mut summary = Summary::new(scenario, models, &seen, columns, Section::new(scenario)?)?;
    summary.claims = claims::judge(scenario, &summary, &seen);
    summary.figures = figures_of_study::of_study(scenario, &summary, &seen);
    Ok(summary)
}

/// What a study writes, and the figures that it may write.
pub(crate) fn contents(scenario: &Scenario) -> Contents<'_> {
    let tables = scenario.model_names().map(|model| format!("runs/{model}/"));
    let others = ["scenario.toml", "summary.json", "runs/", MANIFEST].map(str::to_owned);
    let extends = |text: &str| {
        // Fewer runs would take some away.
        Scenario::from_toml(text).is_ok_and(|there| {
            there.runs() <= scenario.runs()
                && identity(scenario).difference(&identity(&there)).is_none()
        })
    };
    let differs = |text: &str| {
        let there = Scenario::from_toml(text).ok()?;
        let difference = identity(scenario).difference(&identity(&there));
        let fewer = || format!("runs is {} there and {} here", there.runs(), scenario.runs());
        Some(difference.map_or_else(fewer, |difference| difference.to_string()))
    };
    Contents::new(
        "study",
        "scenario.toml",
        tables.chain(report::files(scenario)).chain(others),
        extends,
    )
    .telling(differs)
    .trusting(|name| name.starts_with("runs/"))
}

/// What the runs of a scenario depend on.
pub(crate) fn identity(scenario: &Scenario) -> Identity {
    let mut fields = Vec::new();
    if let Ok(table) = parse_toml::<Toml>(&scenario.to_toml()) {
        flatten("", &Value::Table(table), &mut fields);
    }
    fields.retain(|(field, _)| field != "runs");
    fields.push(("gyradius_version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()));
    fields.push(("block_runs".to_owned(), BLOCK_RUNS.to_string()));
    Identity::new(fields)
}

/// Every value in a table by the path to it.
fn flatten(path: &str, value: &Value, fields: &mut Vec<(String, String)>) {
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                flatten(&path, value, fields);
            }
        }
        Value::Array(values) if values.iter().any(Value::is_table) => {
            for (i, value) in values.iter().enumerate() {
                flatten(&format!("{path}[{}]", i + 1), value, fields);
            }
        }
        other => fields.push((path.to_owned(), other.to_string())),
    }
}

/// What the runs of a scenario amount to, made in memory.
#[cfg(test)]
pub(crate) fn judged(scenario: &Scenario, models: &[Model]) -> Summary {
    let simulations = simulations(scenario, models);
    let (looks, runs) = (looks(scenario, &simulations).unwrap(), all_runs(scenario, models));
    looks.iter().zip(&runs).for_each(|(look, runs)| runs.scan(|block| look.look(block)).unwrap());
    judge(scenario, models, looks, &runs).unwrap()
}

/// Runs every model of a scenario, in memory.
#[cfg(test)]
pub(crate) fn all_runs(scenario: &Scenario, models: &[Model]) -> Vec<Runs> {
    let threads = threads(Some(1)).unwrap();
    let table = |model: &Model| {
        let simulation = Separations::new(scenario, model);
        run(&simulation, model.name(), scenario.runs(), &threads, &|_| {}).unwrap()
    };
    models.iter().map(|model| Runs::from(table(model))).collect()
}
