//! The results of a study as plain data: read back from its folder, and the report that is made from them.

use gyradius_campaign::{Contents, Folder, FolderError, changed, restore, sha256};
use gyradius_formats::read_text;
use gyradius_report::Document;
use serde_json::Value;
use std::{
    fs, io,
    path::{Path, PathBuf},
};

use crate::{
    Scenario, ScenarioError, Summary, report,
    subject::{Subject, read_resolved},
};

/// Largest `summary.json` that is read, far beyond any that is written.
pub(crate) const BYTES: u64 = 1 << 30;

/// Why the results in a folder are not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// The scenario is refused.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// There are none.
    #[error("{}: {problem}", path.display())]
    Study {
        /// Where they were looked for.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// Another version made them, whose numbers need not be these.
    #[error(
        "{}: the study was made by gyradius {found}, and this is {}: run the study again, or use that \
         version", path.display(), env!("CARGO_PKG_VERSION")
    )]
    Version {
        /// The study's folder.
        path: PathBuf,
        /// The version in its summary.
        found: String,
    },
    /// The scenario in the folder is not the one that its runs are from.
    #[error(
        "{}: scenario.toml has the fingerprint {scenario}, and the runs are from a scenario with \
         {summary}: it was changed after the study; run the study again",
        path.display()
    )]
    Fingerprint {
        /// The study's folder.
        path: PathBuf,
        /// Fingerprint of the scenario.
        scenario: String,
        /// Fingerprint in the summary.
        summary: String,
    },
}

impl From<FolderError> for ResultsError {
    fn from(error: FolderError) -> Self {
        Self::Study { path: error.path().to_owned(), problem: error.problem() }
    }
}

/// A study's scenario and every number, judgement and figure that came of its runs.
///
/// The report is made from nothing else, so that it can be made again from the folder alone, to the byte.
#[derive(Clone, Debug)]
pub struct Results<C = Scenario, S = Summary> {
    folder: PathBuf,
    scenario: C,
    summary: S,
}

impl Results {
    /// Reads `scenario.toml` and `summary.json` of the study in a folder.
    ///
    /// # Errors
    /// The folder holds no study, or one by another version; the scenario is not the one that the runs are
    /// from.
    pub fn read(folder: &Path) -> Result<Self, ResultsError> {
        read(folder)
    }

    /// Makes the figures and the report, as HTML and as Markdown, again, in the study's folder or in another; returns the folder.
    ///
    /// In the study's folder only the report and the figures are written, and only over those that the
    /// study wrote. A study is replaced by none of this.
    ///
    /// # Errors
    /// Something in the study's folder was changed after the study, or the other folder holds something else
    /// and `force` is not set; something cannot be written. What was there stays as it was.
    pub fn write_report(&self, out: Option<&Path>, force: bool) -> Result<PathBuf, ResultsError> {
        write(self, out, force)
    }

    /// The report, a page of HTML that needs nothing but itself.
    #[must_use]
    pub fn report(&self) -> String {
        report::report(&self.scenario, &self.summary).html()
    }
}

impl<C, S> Results<C, S> {
    /// The scenario.
    #[must_use]
    pub fn scenario(&self) -> &C {
        &self.scenario
    }

    /// What the runs amount to.
    #[must_use]
    pub fn summary(&self) -> &S {
        &self.summary
    }

    /// The scenario, and what its runs amount to.
    pub(crate) fn into_parts(self) -> (C, S) {
        (self.scenario, self.summary)
    }
}

/// The results in a folder.
pub(crate) fn read<C: Subject>(folder: &Path) -> Result<Results<C, C::Summary>, ResultsError> {
    let problem = |problem: String| ResultsError::Study { path: folder.to_owned(), problem };
    // A study that was killed while it replaced this one is put right first.
    restore(folder)?;
    let (file, written) = (folder.join("scenario.toml"), folder.join("summary.json"));
    let changed = |names: &[&str]| changed(folder, "study", names);
    let is_there = |file: &Path| match fs::metadata(file) {
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
            let name = file.strip_prefix(folder).unwrap_or(file).display();
            Err(problem(format!("{name} in it cannot be read: {error}")))
        }
        found => Ok(found.is_ok_and(|found| found.is_file())),
    };
    if !is_there(&file)? {
        return Err(problem(changed(&["scenario.toml"])?.unwrap_or_else(|| no_study(folder))));
    }
    if !is_there(&written)? {
        let again = "the command that made the study puts its runs together again";
        let gone = changed(&["summary.json"])?.map(|gone| format!("{gone}: {again}"));
        return Err(problem(gone.unwrap_or_else(|| no_study(folder))));
    }
    let no_summary = |e: serde_json::Error| problem(format!("summary.json is no summary: {e}"));
    let text = read_text(&written, BYTES)
        .map_err(|e: io::Error| problem(format!("summary.json in it cannot be read: {e}")))?;
    let value: Value = serde_json::from_str(&text).map_err(no_summary)?;
    let said = |field: &str| value[field].as_str().map(str::to_owned);
    let (Some(version), Some(fingerprint)) = (said("gyradius_version"), said("fingerprint")) else {
        return Err(problem("summary.json names no version and no fingerprint".to_owned()));
    };
    // First: another version may read other scenarios.
    if version != env!("CARGO_PKG_VERSION") {
        return Err(ResultsError::Version { path: folder.to_owned(), found: version });
    }
    let scenario: C = read_resolved(&file)?;
    let there = sha256(scenario.to_toml());
    if there != fingerprint {
        return Err(ResultsError::Fingerprint {
            path: folder.to_owned(),
            scenario: there,
            summary: fingerprint,
        });
    }
    if let Some(changed) = changed(&["scenario.toml", "summary.json"])? {
        return Err(problem(changed));
    }
    let summary = serde_json::from_str(&text).map_err(no_summary)?;
    Ok(Results { folder: folder.to_owned(), scenario, summary })
}

/// What is wrong with a folder in which no study was ever written.
pub(crate) fn no_study(folder: &Path) -> String {
    let said = if folder.exists() {
        "it holds no study, which has a scenario.toml and a summary.json; name the folder of one"
    } else {
        "it holds no study, for there is no such folder; name the folder of one"
    };
    said.to_owned()
}

/// Whether two paths lead to the same folder.
fn is_same(a: &Path, b: &Path) -> bool {
    matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
}

/// Makes figures and report again.
pub(crate) fn write<C: Subject>(
    results: &Results<C, C::Summary>,
    out: Option<&Path>,
    force: bool,
) -> Result<PathBuf, ResultsError> {
    // The folder of the study, however it is written, is where the report goes anyway.
    let out = out.filter(|out| !is_same(out, &results.folder));
    let report = results.scenario.report(&results.summary);
    let (page, pages) = (report.html(), Document::pages(report::NAME));
    let certain = results.scenario.report_files();
    let contents = match out {
        Some(_) => Contents::new("report", "report.html", certain, |text, _| text == page),
        None => Contents::new("study", "summary.json", certain, |_, _| true)
            .keeping(|name| !name.starts_with("figures/") && !pages.iter().any(|p| p == name)),
    };
    let mut folder = Folder::prepare(out.unwrap_or(&results.folder), &contents, force)?;
    for (name, content) in report.files(report::NAME) {
        folder.write(&name, &content)?;
    }
    Ok(folder.publish()?)
}
