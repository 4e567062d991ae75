//! Laws in the form that they have in files, from and to JSON.

use pyo3::PyResult;
use serde::{Serialize, de::DeserializeOwned};

use crate::error::refused;

/// Reads a law, or anything else that has a form in files.
pub(crate) fn read<T: DeserializeOwned>(json: &str) -> PyResult<T> {
    serde_json::from_str(json).map_err(|error| {
        // The place in a text that no user has written says nothing.
        let text = error.to_string();
        let message = text.rsplit_once(" at line ").map_or(text.as_str(), |(message, _)| message);
        refused(message)
    })
}

/// Writes it.
pub(crate) fn write(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(refused)
}
