//! Why runs cannot be judged.

use gyradius_statistics::StatisticsError;

use crate::{
    foreign::{ForeignError, NoRunError, RowsError, TwiceError},
    runs_error::RunsError,
};

/// Why runs cannot be judged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JudgementError {
    /// The table cannot be read.
    #[error(transparent)]
    Table(#[from] ForeignError),
    /// The table holds the rows of some runs only.
    #[error(transparent)]
    Rows(#[from] RowsError),
    /// A run stands twice in the table.
    #[error(transparent)]
    Twice(#[from] TwiceError),
    /// A row of the table is no run.
    #[error(transparent)]
    NoRun(#[from] NoRunError),
    /// The runs cannot be read.
    #[error(transparent)]
    Runs(#[from] RunsError),
    /// The shares or the number of runs are out of range.
    #[error(transparent)]
    Statistics(#[from] StatisticsError),
}
