//! An estimate of ten parameters with its covariance in a JSON, TOML or CSV file.

use serde::Deserialize;
use std::{io, path::Path};

use crate::{
    MAX_TOML_BYTES, read_text,
    rows::{Field, Rows},
    units::squeezed,
};

/// Mean and covariance of ten parameters, as a file gives them.
#[derive(Clone, Debug, PartialEq)]
pub struct TenMomentsFile {
    parameters: Option<String>,
    mean: [f64; 10],
    covariance: [[f64; 10]; 10],
}

/// JSON and TOML.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    #[serde(default)]
    parameters: Option<String>,
    mean: [f64; 10],
    #[serde(default)]
    covariance: Option<[[f64; 10]; 10]>,
    #[serde(default)]
    deviations: Option<[f64; 10]>,
}

impl TenMomentsFile {
    /// Reads `{"parameters": "linear", "mean": [10], "covariance": [[10] × 10]}` (or `"deviations": [10]` where nothing is correlated) as
    /// JSON, the same keys as TOML, or a CSV with the mean in its first row and the covariance in the ten below, with or without a
    /// header.
    ///
    /// # Errors
    /// The file cannot be read, or does not hold these numbers.
    pub fn read(path: &Path) -> Result<Self, TenMomentsError> {
        let text = read_text(path, MAX_TOML_BYTES as u64)?;
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let fields = match extension.to_str().unwrap_or_default() {
            "csv" => return Self::from_csv(&text),
            "toml" => toml::from_str(&text).map_err(|e| malformed(e.message()))?,
            "json" => {
                serde_json::from_str::<Fields>(&text).map_err(|e| malformed(&e.to_string()))?
            }
            other => return Err(TenMomentsError::Extension { extension: other.to_owned() }),
        };
        let covariance = match (fields.covariance, fields.deviations) {
            (Some(covariance), None) => covariance,
            (None, Some(deviations)) => std::array::from_fn(|i| {
                std::array::from_fn(|j| if i == j { deviations[i] * deviations[i] } else { 0.0 })
            }),
            (Some(_), Some(_)) | (None, None) => {
                return Err(malformed("there must be either covariance or deviations"));
            }
        };
        Ok(Self { parameters: fields.parameters, mean: fields.mean, covariance })
    }

    fn from_csv(text: &str) -> Result<Self, TenMomentsError> {
        let mut rows = Rows::new(text);
        let mut numbers: Vec<[f64; 10]> = Vec::new();
        let mut parameters = None;
        let mut first = true;
        while let Some(fields) = rows.next() {
            let fields = fields.map_err(|_| malformed("a quotation mark is not closed"))?;
            let cell = |field: &Field| text.get(field.start..field.end).unwrap_or_default().trim();
            let read: Vec<Option<f64>> = fields.iter().map(|f| cell(f).parse().ok()).collect();
            let is_header = first && read.iter().all(Option::is_none);
            first = false;
            if is_header {
                let moments = |f: &Field| squeezed(cell(f)).contains("firstmoment");
                if fields.iter().any(moments) {
                    parameters = Some("linear".to_owned());
                }
                continue;
            }
            let row = read.into_iter().collect::<Option<Vec<f64>>>();
            let row = row.and_then(|row| <[f64; 10]>::try_from(row).ok());
            let place = numbers.len() + 1;
            numbers.push(
                row.ok_or_else(|| malformed(&format!("row {place}: there must be ten numbers")))?,
            );
        }
        let found = numbers.len();
        let wrong = || {
            malformed(&format!(
                "{found} rows of numbers: there must be 11, the mean and the covariance"
            ))
        };
        let (mean, rest) = numbers.split_first().ok_or_else(wrong)?;
        let covariance = <[[f64; 10]; 10]>::try_from(rest).map_err(|_| wrong())?;
        Ok(Self { parameters, mean: *mean, covariance })
    }

    /// What the file calls its ten, if it says.
    #[must_use]
    pub fn parameters(&self) -> Option<&str> {
        self.parameters.as_deref()
    }

    /// The mean.
    #[must_use]
    pub fn mean(&self) -> &[f64; 10] {
        &self.mean
    }

    /// The covariance.
    #[must_use]
    pub fn covariance(&self) -> &[[f64; 10]; 10] {
        &self.covariance
    }
}

fn malformed(message: &str) -> TenMomentsError {
    TenMomentsError::Malformed { message: message.trim_end().to_owned() }
}

/// Why an estimate could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TenMomentsError {
    /// The system refuses, or it is no text.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// It is of no known kind.
    #[error("extension {extension:?}: an estimate is read from .json, .toml or .csv")]
    Extension {
        /// What it has.
        extension: String,
    },
    /// It does not hold the numbers.
    #[error("{message}")]
    Malformed {
        /// What is wrong.
        message: String,
    },
}
