//! Why runs that were written cannot be read.

use parquet::errors::ParquetError;
use std::path::{Path, PathBuf};

/// Why a block of runs cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunsError {
    /// It cannot be read.
    #[error("{}: {}", path.display(), said(problem))]
    Block {
        /// Its file.
        path: PathBuf,
        /// Why.
        problem: ParquetError,
    },
    /// They are looked at no further.
    #[error("stopped")]
    Stopped,
}

impl RunsError {
    pub(crate) fn of(path: &Path, problem: ParquetError) -> Self {
        Self::Block { path: path.to_owned(), problem }
    }
}

/// What is wrong, without what only says that the library did not find it.
pub(crate) fn said(error: &ParquetError) -> String {
    match error {
        ParquetError::External(cause) => cause.to_string(),
        other => other.to_string(),
    }
}
