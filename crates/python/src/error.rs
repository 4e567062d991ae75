//! Errors of the libraries as `ValueError`, with the same words.

use pyo3::{PyErr, exceptions::PyValueError};
use std::fmt::Display;

/// The error of one thing.
pub(crate) fn refused(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The error of a row of an array; of an array of one row it is that of the row alone.
pub(crate) fn refused_row(row: usize, rows: usize, error: impl Display) -> PyErr {
    if rows == 1 { refused(error) } else { refused(format_args!("row {row} of {rows}: {error}")) }
}
