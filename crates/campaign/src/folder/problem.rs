//! Why a folder cannot be used.

use std::path::{Path, PathBuf};

use super::{
    name::{HIDDEN, Name, NameError},
    refusal::Refusal,
};
use crate::identity::Difference;

/// Why a folder cannot be used. Nothing of the user's has been touched.
#[derive(Debug, thiserror::Error)]
#[error("output folder {}: {}", path.display(), self.problem())]
pub struct FolderError {
    /// As it was given.
    pub(crate) path: PathBuf,
    /// What is wrong with it.
    pub(crate) problem: Problem,
}

impl FolderError {
    /// The folder, as it was given.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether nothing is wrong but that it was told to stop.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        matches!(self.problem, Problem::Stopped)
    }

    /// Whether it cannot be written, and nothing else is known to be wrong.
    #[must_use]
    pub fn is_read_only(&self) -> bool {
        matches!(&self.problem, Problem::Refused(refusal) if refusal.is_read_only())
    }

    /// What is wrong with it.
    #[must_use]
    pub fn problem(&self) -> String {
        match &self.problem {
            Problem::Refused(refusal) => refusal.said_of(&self.path),
            other => other.to_string(),
        }
    }
}

/// What is wrong with a folder.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Problem {
    #[error("{0}")]
    Refused(Refusal),
    #[error("stopped")]
    Stopped,
    #[error("it is not a folder")]
    NoFolder,
    #[error("it is a link that leads nowhere")]
    Link,
    #[error("something else is being written there")]
    Busy,
    #[error(
        "it already holds another {what} or other files (a copy without the folder {} counts as other files); \
         choose another folder with --out, or pass --force to write beside other files, none of which is replaced",
        HIDDEN
    )]
    Occupied { what: &'static str },
    #[error(
        "it already holds another {what}: {difference}; choose another folder with --out, or pass \
         --force to replace what a {what} wrote there"
    )]
    Other { what: &'static str, difference: String },
    #[error(
        "it holds the finished runs of another campaign that was not completed: {difference}; choose another \
         folder with --out, or pass --force to drop those runs"
    )]
    Unfinished { difference: Difference },
    #[error(
        "{name} cannot be written: {problem}. What was finished stays, and the same command goes on"
    )]
    Block { name: String, problem: String },
    #[error(
        "{name} in it was changed after it was written, and is not replaced; move it elsewhere or \
         choose another folder with --out"
    )]
    Changed { name: Name },
    #[error(
        "{name} in it was not written by this program, and is not replaced; move it elsewhere or \
         choose another folder with --out"
    )]
    Foreign { name: Name },
    #[error(
        "{name} in it, which says what the folder holds, is not there any more: put it back, choose another folder with --out, or pass --force \
         to replace what a {what} wrote there"
    )]
    Gone { name: Name, what: &'static str },
    #[error("{name} in it is a {is} where this program has a {should}; move it elsewhere")]
    Kind { name: String, is: &'static str, should: &'static str },
    #[error("{name} in it is not as this program left it: {problem}; move it elsewhere")]
    Unknown { name: String, problem: String },
    #[error(
        "a command was killed while it replaced the files there, and neither the old nor the new ones \
         can be put in place: {problem}. All of them are kept in .gyradius; once the cause is mended, \
         the next command goes on"
    )]
    Stuck { problem: Box<Problem> },
    #[error(transparent)]
    Name(#[from] NameError),
    #[error("its record cannot be written: {0}")]
    Json(serde_json::Error),
}

impl From<serde_json::Error> for Problem {
    fn from(error: serde_json::Error) -> Self {
        Self::Json(error)
    }
}

impl From<Refusal> for Problem {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(refusal)
    }
}
