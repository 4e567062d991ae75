//! The program `gyradius`, with the arguments of the command line.

use pyo3::{Python, pyfunction};
use std::{ffi::OsString, process::ExitCode};

/// Runs the program, which certain words call in a shell, and gives its exit code.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, called: Vec<OsString>, arguments: Vec<OsString>) -> u8 {
    let code = py.detach(|| gyradius::run_as(called, arguments));
    // An exit code does not tell its number, but whether it is that of a number.
    (0..=u8::MAX).find(|number| ExitCode::from(*number) == code).unwrap_or(2)
}
