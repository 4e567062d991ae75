//! Laws in the form that they have in files, from and to JSON.

use pyo3::PyResult;
use serde::{Serialize, de::DeserializeOwned};

use crate::{error::refused, words::in_python};

/// Reads a law, or anything else that has a form in files. Errors say at which key.
pub(crate) fn read<T: DeserializeOwned>(json: &str) -> PyResult<T> {
    serde_path_to_error::deserialize(&mut serde_json::Deserializer::from_str(json)).map_err(
        |error| {
            let path = error.path().to_string();
            let text = error.inner().to_string();
            // The place in a text that no user has written says nothing.
            let message =
                text.rsplit_once(" at line ").map_or(text.as_str(), |(message, _)| message);
            let message = in_python(message);
            // Some messages begin with the key themselves.
            let says_it = path == "." || message.starts_with(&format!("{path}:"));
            if says_it { refused(message) } else { refused(format_args!("{path}: {message}")) }
        },
    )
}

/// Writes it.
pub(crate) fn write(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(refused)
}
