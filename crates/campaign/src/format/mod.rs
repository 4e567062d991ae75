//! Forms in which run tables are written for other programs, block by block.

mod csv;
mod json_lines;
mod npy;
mod parquet;

use ::parquet::errors::ParquetError;
use rayon::prelude::*;
use std::{
    io::{self, Write},
    path::Path,
};

use crate::table::{Row, Table};
pub use npy::Extent;

/// A form of a run table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TableFormat {
    /// Columns of values in binary, which pandas, polars and DuckDB open.
    Parquet,
    /// A line of text a run, after a line with the names of the columns.
    #[default]
    Csv,
    /// An object a run, each on a line of its own.
    JsonLines,
    /// A structured array of NumPy.
    Npy,
}

struct Declaration {
    name: &'static str,
    /// Of files, the first one being the usual one.
    extensions: &'static [&'static str],
    is_text: bool,
    /// Whether the length of the table and of its texts stands before the first row.
    needs_extent: bool,
    meaning: &'static str,
}

/// Writes a run table in a form, block by block.
///
/// The blocks have the same columns, and come in the order of their runs.
pub trait TableWriter: Send {
    /// Writes the runs that come next.
    ///
    /// # Errors
    /// Writing fails, or the runs are not what the head of the file says.
    fn write(&mut self, runs: &Table) -> Result<(), FormatError>;

    /// Writes what stands after the last run.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    fn finish(self: Box<Self>) -> Result<(), FormatError>;
}

impl TableFormat {
    /// All forms.
    pub const ALL: [Self; 4] = [Self::Parquet, Self::Csv, Self::JsonLines, Self::Npy];

    fn declaration(self) -> &'static Declaration {
        match self {
            Self::Parquet => &Declaration {
                name: "parquet",
                extensions: &["parquet", "pq"],
                is_text: false,
                needs_extent: false,
                meaning: "Columns in binary, for pandas, polars and DuckDB",
            },
            Self::Csv => &Declaration {
                name: "csv",
                extensions: &["csv"],
                is_text: true,
                needs_extent: false,
                meaning: "A line of text for each run, after a line with the names of the columns",
            },
            Self::JsonLines => &Declaration {
                name: "jsonl",
                extensions: &["jsonl", "ndjson"],
                is_text: true,
                needs_extent: false,
                meaning: "A JSON object for each run, on a line of its own",
            },
            Self::Npy => &Declaration {
                name: "npy",
                extensions: &["npy"],
                is_text: false,
                needs_extent: true,
                meaning: "A structured array of NumPy, one record for each run",
            },
        }
    }

    /// What it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.declaration().name
    }

    /// What it is, in a few words.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        self.declaration().meaning
    }

    /// The form of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name() == name)
    }

    /// The form that the extension of a file says, in small or capital letters.
    #[must_use]
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL.into_iter().find(|format| format.extensions().contains(&extension.as_str()))
    }

    /// Extensions of its files, the usual one first.
    #[must_use]
    pub fn extensions(self) -> &'static [&'static str] {
        self.declaration().extensions
    }

    /// Whether it can be read by people, on a terminal say.
    #[must_use]
    pub fn is_text(self) -> bool {
        self.declaration().is_text
    }

    /// Whether a writer must know the [`Extent`] of the whole table before the first run.
    #[must_use]
    pub fn needs_extent(self) -> bool {
        self.declaration().needs_extent
    }

    /// A writer of tables with the columns of this one, whose runs are not written. `extent` is that of all runs that
    /// will be written, if the form [needs it](Self::needs_extent).
    ///
    /// # Errors
    /// Writing fails.
    pub fn writer<'a>(
        self,
        columns: &Table,
        extent: &Extent,
        output: impl Write + Send + 'a,
    ) -> Result<Box<dyn TableWriter + 'a>, FormatError> {
        Ok(match self {
            Self::Parquet => Box::new(parquet::Writer::new(columns, output)?),
            Self::Csv => Box::new(csv::Writer::new(columns, output)?),
            Self::JsonLines => Box::new(json_lines::Writer::new(output)),
            Self::Npy => Box::new(npy::Writer::new(columns, extent, output)?),
        })
    }
}

/// Rows that a thread writes at a time.
const TOGETHER: usize = 1024;

/// Writes what `part` makes of some runs after the other, in their order, made on the threads that this is called in.
fn write_rows(
    runs: &Table,
    mut output: impl Write,
    part: impl Fn(&mut dyn Iterator<Item = Row<'_>>) -> Result<Vec<u8>, FormatError> + Sync,
) -> Result<(), FormatError> {
    let some = |first: usize| {
        let places = first..(first + TOGETHER).min(runs.len());
        part(&mut places.filter_map(|place| runs.row(place)))
    };
    let parts = (0..runs.len()).into_par_iter().step_by(TOGETHER).map(some);
    let parts: Vec<Vec<u8>> = parts.collect::<Result<_, FormatError>>()?;
    Ok(parts.iter().try_for_each(|part| output.write_all(part))?)
}

/// Why a table cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The system refuses.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The library that writes Parquet refuses.
    #[error(transparent)]
    Parquet(ParquetError),
    /// The library that writes JSON refuses.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// The runs do not fit what stands in the head of the file.
    #[error("{what}: {found}, and the head of the file says {said}")]
    Extent {
        /// What does not fit.
        what: String,
        /// How many there are.
        found: u64,
        /// How many there should be.
        said: u64,
    },
}

impl From<ParquetError> for FormatError {
    fn from(error: ParquetError) -> Self {
        match error {
            ParquetError::External(cause) => match cause.downcast::<io::Error>() {
                Ok(error) => Self::Io(*error),
                Err(cause) => Self::Parquet(ParquetError::External(cause)),
            },
            other => Self::Parquet(other),
        }
    }
}

impl From<::csv::Error> for FormatError {
    fn from(error: ::csv::Error) -> Self {
        Self::Io(error.into())
    }
}
