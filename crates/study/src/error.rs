//! Why a study could not be done.

use gyradius_campaign::{
    CampaignError, Changed, DesignsError, Difference, FolderError, JudgementError, Kept, RunsError,
    rough_size,
};
use gyradius_statistics::StatisticsError;
use std::path::PathBuf;

use crate::ScenarioError;

/// Why a study could not be done. Nothing has been overwritten.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The scenario is refused.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The output folder cannot be used.
    #[error("output folder {}: {problem}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The output folder cannot be written, though nothing in it is in the way.
    #[error("output folder {}: {problem}", path.display())]
    ReadOnly {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        problem: String,
    },
    /// What is asked for is not there.
    #[error("{}: {problem}", path.display())]
    Absent {
        /// The folder.
        path: PathBuf,
        /// What it lacks.
        problem: String,
    },
    /// The disk is too small for the run tables.
    #[error(
        "{}: the run tables will take about {}, and the disk has {} left: choose another folder with --out, or pass \
         --even-if-full to begin all the same", path.display(), rough_size(*needed), rough_size(*left)
    )]
    Room {
        /// Where they were to be.
        path: PathBuf,
        /// About how many bytes they take.
        needed: u64,
        /// How many there are.
        left: u64,
    },
    /// There is too little memory.
    #[error(
        "the study may need {} of memory, and there are {} left: take fewer threads with --threads, or pass --even-if-full to \
         begin all the same", rough_size(*needed), rough_size(*left)
    )]
    Memory {
        /// How many bytes are certainly enough.
        needed: u64,
        /// How many there are.
        left: u64,
    },
    /// Rows or columns of the complete study that is there were not kept.
    #[error(
        "{}: {}not everything of the run tables was kept there ({kept}), so that nobody can go on with it: choose another folder \
         with --out, or pass --force to do all runs again", path.display(), damaged.as_ref().map(|file| format!("{file} is not as it was written, and ")).unwrap_or_default()
    )]
    Reduced {
        /// The folder.
        path: PathBuf,
        /// What was kept.
        kept: Kept,
        /// A file of it that is not as it was written.
        damaged: Option<String>,
    },
    /// Other processes do another number of runs of the same study, keep other rows or columns, or have other requirements.
    #[error("{}: {difference}: all shards of a study must do the same number of runs, keep the same and require the same", path.display())]
    Shards {
        /// The folder.
        path: PathBuf,
        /// What is other there than here.
        difference: Difference,
    },
    /// The function that does the runs is not the one that did those that are finished.
    #[error(
        "{}: {changed}: the function is not the one that did the finished runs, or what it answers depends on more than its inputs and its \
         seed; choose another folder, or delete this one", path.display()
    )]
    Changed {
        /// The folder.
        path: PathBuf,
        /// What is other there than now.
        changed: Box<Changed>,
    },
    /// The runs cannot be made on so many threads, or leave no rows.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// Runs cannot be read.
    #[error(transparent)]
    Runs(RunsError),
    /// The runs cannot be summarised.
    #[error("cannot summarise the runs: {0}")]
    Statistics(StatisticsError),
    /// The runs cannot be judged.
    #[error("cannot judge the requirements: {0}")]
    Judgement(JudgementError),
    /// The summary cannot be put into JSON.
    #[error("cannot write the summary: {0}")]
    Json(serde_json::Error),
}

impl From<serde_json::Error> for StudyError {
    fn from(error: serde_json::Error) -> Self {
        Self::Json(error)
    }
}

impl From<StatisticsError> for StudyError {
    fn from(error: StatisticsError) -> Self {
        Self::Statistics(error)
    }
}

impl From<RunsError> for StudyError {
    fn from(error: RunsError) -> Self {
        match error {
            RunsError::Stopped => Self::Campaign(CampaignError::Stopped),
            other => Self::Runs(other),
        }
    }
}

impl From<DesignsError> for StudyError {
    fn from(error: DesignsError) -> Self {
        match error {
            DesignsError::Runs(error) => error.into(),
            DesignsError::Statistics(error) => error.into(),
        }
    }
}

impl From<JudgementError> for StudyError {
    fn from(error: JudgementError) -> Self {
        match error {
            JudgementError::Runs(runs) => runs.into(),
            other => Self::Judgement(other),
        }
    }
}

impl From<FolderError> for StudyError {
    fn from(error: FolderError) -> Self {
        if error.is_stopped() {
            return Self::Campaign(CampaignError::Stopped);
        }
        let (path, problem) = (error.path().to_owned(), error.problem());
        if error.is_read_only() {
            Self::ReadOnly { path, problem }
        } else {
            Self::Folder { path, problem }
        }
    }
}
