//! A study: a scenario, run and reported into a folder.

use gyradius_campaign::{
    CampaignError, Contents, Folder, FolderError, Forecast, Progress, Runs, RunsError, Table, run,
    threads,
};
use gyradius_report::file_of;
use gyradius_statistics::Confidence;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

use crate::{
    Scenario, StudyError, Summary, claims,
    compare::Section,
    figures_of_study,
    model::{Model, Separations},
    results::Pages,
    seen::Seen,
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
        Self::run_with_forecast(scenario, options, progress, &|_| {})
    }

    /// As [`run`](Self::run), and says how long it will take before it begins.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_with_forecast(
        scenario: &Scenario,
        options: &Options,
        progress: Progress<'_>,
        say: &dyn Fn(Forecast),
    ) -> Result<Self, StudyError> {
        let threads = threads(options.threads)?;
        let default = || Path::new("target/study").join(scenario.name());
        let place = options.out.clone().unwrap_or_else(default);
        let models = Model::all(scenario)?;
        let contents = contents(scenario);
        let mut folder = Folder::prepare(&place, &contents, options.force)?;

        let simulations: Vec<_> =
            models.iter().map(|model| Separations::new(scenario, model)).collect();
        say(Forecast::of(&simulations, scenario.runs(), threads.current_num_threads())
            .map_err(CampaignError::from)?);
        let runs = all_runs(scenario, &models, &threads, progress)?;
        let summary = threads.install(|| judge(scenario, &models, &runs))?;

        let files = runs
            .iter()
            .map(|runs| Ok((runs, folder.create(&format!("runs/{}/runs.parquet", runs.model()))?)));
        let files = files.collect::<Result<Vec<_>, FolderError>>()?;
        threads.install(|| {
            files.into_par_iter().try_for_each(|(runs, file)| {
                runs.table()?.write_parquet(file).map_err(|source| StudyError::RunTable {
                    model: runs.model().to_owned(),
                    source,
                })
            })
        })?;
        folder.write("scenario.toml", &scenario.to_toml())?;
        let written = serde_json::to_string_pretty(&summary)? + "\n";
        folder.write("summary.json", &written)?;
        // The report is made from what a reader of the folder has.
        let summary: Summary = serde_json::from_str(&written)?;
        threads.install(|| Pages::new(scenario, &summary)).write(&mut folder)?;
        Ok(Self { folder: folder.publish()?, runs, summary })
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

/// What the runs of a scenario amount to: every number, judgement and figure, before any page is made.
pub(crate) fn judge(
    scenario: &Scenario,
    models: &[Model],
    runs: &[Runs],
) -> Result<Summary, StudyError> {
    let confidence = Confidence::default();
    let seen = runs.iter().map(|runs| Seen::new(scenario, runs, confidence));
    let seen = seen.collect::<Result<Vec<_>, _>>()?;
    let columns = runs.first().map_or(&[][..], Runs::columns);
    let mut summary = Summary::new(scenario, models, &seen, columns, Section::new(scenario)?)?;
    summary.claims = claims::judge(scenario, &summary, &seen);
    summary.figures = figures_of_study::of_study(scenario, &summary, &seen);
    Ok(summary)
}

/// What a study writes, and the figures that it may write.
fn contents(scenario: &Scenario) -> Contents<'_> {
    let tables = scenario.model_names().map(|model| format!("runs/{model}/runs.parquet"));
    let figures = figures_of_study::names(scenario).into_iter().map(|name| file_of(&name));
    let others = ["scenario.toml", "summary.json", "report.html", "figures/"].map(str::to_owned);
    let same = |text: &str| text == scenario.to_toml();
    Contents::new("study", "scenario.toml", tables.chain(figures).chain(others), same)
}

/// Runs every model of a scenario.
pub(crate) fn all_runs(
    scenario: &Scenario,
    models: &[Model],
    threads: &rayon::ThreadPool,
    progress: Progress<'_>,
) -> Result<Vec<Runs>, CampaignError> {
    let mut done = 0;
    let mut all = Vec::new();
    for model in models {
        let simulation = Separations::new(scenario, model);
        let progress = |runs| progress(done + runs);
        let table = run(&simulation, model.name(), scenario.runs(), threads, &progress)?;
        all.push(Runs::from(table));
        done += scenario.runs();
    }
    Ok(all)
}
