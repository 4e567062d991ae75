//! An estimate of ten parameters with its covariance in a JSON, TOML or CSV file.

use serde::Deserialize;
use std::{io, path::Path};

use crate::{
    MAX_TOML_BYTES, Products, TenTableError,
    body::shortened,
    error::Refusal,
    products_comment::stated_products,
    read_text,
    rows::{Field, Rows, commented_headers},
    table_terms::InertiaPoint,
    ten_heading::{TenCentre, TenHeading},
    ten_table::TenColumns,
    text::Text,
    title_point, title_units,
    units::Unit,
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
    mean: Vec<f64>,
    #[serde(default)]
    covariance: Option<Vec<Vec<f64>>>,
    #[serde(default)]
    deviations: Option<Vec<f64>>,
}

impl TenMomentsFile {
    /// Reads `{"parameters": "linear", "mean": [10], "covariance": [[10] × 10]}` (or `"deviations": [10]` where nothing is correlated) as
    /// JSON, the same keys as TOML, or a CSV with the mean in its first row and the covariance in the ten below. A header may stand above them,
    /// which names the ten in any order and in any unit that is read and may be a comment, and a line `# products = integrals`.
    ///
    /// # Errors
    /// The file cannot be read, or does not hold these numbers; a heading is of none of the ten, or a deviation is negative.
    pub fn read(path: &Path) -> Result<Self, TenMomentsError> {
        let text = read_text(path, MAX_TOML_BYTES as u64)?;
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let fields = match extension.to_str().unwrap_or_default() {
            "csv" | "tsv" => return Self::from_csv(&text),
            "toml" => toml::from_str(&text).map_err(|e| malformed(e.message()))?,
            "json" => {
                serde_json::from_str::<Fields>(&text).map_err(|e| malformed(&e.to_string()))?
            }
            other => return Err(TenMomentsError::Extension { extension: other.to_owned() }),
        };
        let covariance = match (fields.covariance, fields.deviations) {
            (Some(covariance), None) => {
                let rows = covariance.into_iter().enumerate();
                let rows = rows.map(|(i, row)| ten(&format!("row {} of covariance", i + 1), row));
                ten("covariance", rows.collect::<Result<_, _>>()?)?
            }
            (None, Some(deviations)) => {
                let deviations: [f64; 10] = ten("deviations", deviations)?;
                if let Some(i) = deviations.iter().position(|d| *d < 0.0) {
                    let (n, value) = (i + 1, deviations[i]);
                    let message = format!("deviation {n} = {value:?}: it must be zero or more");
                    return Err(malformed(&message));
                }
                std::array::from_fn(|i| {
                    std::array::from_fn(
                        |j| if i == j { deviations[i] * deviations[i] } else { 0.0 },
                    )
                })
            }
            (Some(_), Some(_)) | (None, None) => {
                return Err(malformed("there must be either covariance or deviations"));
            }
        };
        Ok(Self { parameters: fields.parameters, mean: ten("mean", fields.mean)?, covariance })
    }

    fn from_csv(text: &str) -> Result<Self, TenMomentsError> {
        let text = Text::new(text.as_bytes(), true)?;
        let mut rows = Rows::new(text.as_str());
        let mut numbers: Vec<[f64; 10]> = Vec::new();
        let mut header: Option<Columns> = None;
        let mut top = None;
        while let Some(fields) = rows.next() {
            let fields = fields
                .map_err(|error| malformed(&format!("line {}: {error}", text.line(error.at()))))?;
            let cell = |at: &Field| at.of(text.as_str()).trim();
            top = top.or(fields.first().map(|field| field.start));
            let read: Vec<Option<f64>> = fields.iter().map(|f| cell(f).parse().ok()).collect();
            if numbers.is_empty() && header.is_none() && read.iter().all(Option::is_none) {
                header = Some(Columns::of(&fields.iter().map(cell).collect::<Vec<_>>())?);
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
        let (columns, top) = match header {
            Some(header) => (header, top.unwrap_or_default()),
            None => {
                Columns::of_comment(&text)?.unwrap_or((Columns::default(), top.unwrap_or_default()))
            }
        };
        let products = stated_products(&text, top)?.unwrap_or(Products::TensorEntries);
        title_units::refused(&text, top, columns.some_lack)?;
        if let Some(centre) = columns.centre {
            let point = match centre {
                TenCentre::MassCentre => InertiaPoint::MassCentre,
                TenCentre::FirstMoments => InertiaPoint::Origin,
            };
            title_point::refused(&text, top, point)?;
        }
        // In the order of the ten and in SI, products as tensor entries: the rows of the covariance as its columns.
        let of = |i: usize| {
            let (at, unit) = columns.places[i];
            (at, if i < 7 { unit } else { unit * products.sign() })
        };
        Ok(Self {
            parameters: columns.centre.map(|centre| centre.parameters().to_owned()),
            mean: std::array::from_fn(|i| mean[of(i).0] * of(i).1),
            covariance: std::array::from_fn(|i| {
                std::array::from_fn(|j| covariance[of(i).0][of(j).0] * of(i).1 * of(j).1)
            }),
        })
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

/// Where in a row each of the ten stands, and its unit in SI.
struct Columns {
    places: [(usize, f64); 10],
    centre: Option<TenCentre>,
    /// Whether there are some of which none states a unit.
    some_lack: bool,
}

/// Without a header they stand in their order, in SI.
impl Default for Columns {
    fn default() -> Self {
        Self { places: std::array::from_fn(|i| (i, 1.0)), centre: None, some_lack: true }
    }
}

impl Columns {
    fn of(headings: &[&str]) -> Result<Self, TenMomentsError> {
        let mut columns = TenColumns::default();
        for (at, text) in headings.iter().enumerate() {
            let heading = TenHeading::of(text).ok_or_else(|| {
                let heading = shortened(text);
                malformed(&format!(
                    "column {heading:?} is none of the ten: they are mass; mass_centre_1_m or first_moment_1_kg_m and so on; \
                     ixx, iyy, izz, ixy, ixz, iyz"
                ))
            })?;
            columns.add(at, text, heading, Ok(Unit::none()))?;
        }
        let places = columns.places(0..10)?;
        columns.check_units(&[])?;
        let place = |i: usize| (places[i], columns.unit(i));
        let (centre, some_lack) = (columns.centre(), columns.some_lack());
        Ok(Self { places: std::array::from_fn(place), centre, some_lack })
    }

    /// Those that a comment names, as programs write a header, and where it stands.
    fn of_comment(text: &Text) -> Result<Option<(Self, usize)>, TenMomentsError> {
        let named = |(at, line)| {
            let row = Rows::at(text.as_str(), at, line).row().ok()?;
            let cells: Vec<&str> = row.iter().map(|at| at.of(text.as_str()).trim()).collect();
            let known = cells.iter().filter(|cell| TenHeading::of(cell).is_some()).count();
            // A comment may name some of them.
            let is_header = cells.len() == 10 && known > 5;
            is_header.then(|| Ok((Self::of(&cells)?, at)))
        };
        commented_headers(text.as_str()).find_map(named).transpose()
    }
}

/// Ten of something, which messages call so.
fn ten<T>(field: &str, found: Vec<T>) -> Result<[T; 10], TenMomentsError> {
    <[T; 10]>::try_from(found).map_err(|found| {
        malformed(&format!("{field} has a length of {}: it must be 10", found.len()))
    })
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
    Io(io::Error),
    /// It is of no known kind.
    #[error("extension {extension:?}: an estimate is read from .json, .toml or .csv")]
    Extension {
        /// What it has.
        extension: String,
    },
    /// The columns that its header names are not those of ten numbers.
    #[error(transparent)]
    Columns(#[from] TenTableError),
    /// It does not hold the numbers.
    #[error("{message}")]
    Malformed {
        /// What is wrong.
        message: String,
    },
}

impl From<io::Error> for TenMomentsError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<Refusal> for TenMomentsError {
    fn from(refusal: Refusal) -> Self {
        malformed(&refusal.problem.to_string())
    }
}
