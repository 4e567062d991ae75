//! Errors of the libraries as `ValueError`, with the same words, and those of the system as `OSError`.

use pyo3::{
    PyErr,
    exceptions::{PyOSError, PyValueError},
};
use std::{fmt::Display, io, path::Path};

/// The error of one thing.
pub(crate) fn refused(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// What the system does not hand out is the `OSError` that Python has for it, with path and number.
pub(crate) fn unreadable(path: &Path, problem: &io::Error) -> PyErr {
    let said = problem.to_string();
    let path = path.display().to_string();
    match problem.raw_os_error() {
        // Python makes the class of it of the number.
        Some(number) => {
            let said = said.split(" (os error").next().unwrap_or_default().to_owned();
            PyOSError::new_err((number, said, path))
        }
        None => PyOSError::new_err(format!("{path}: {said}")),
    }
}

/// The error of a row of an array; of an array of one row it is that of the row alone.
pub(crate) fn refused_row(row: usize, rows: usize, error: impl Display) -> PyErr {
    if rows == 1 { refused(error) } else { refused(format_args!("row {row} of {rows}: {error}")) }
}
