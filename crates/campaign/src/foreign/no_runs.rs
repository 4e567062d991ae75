//! Rows of a table that are no runs: those that sum up others, those without a number among numbered runs, and rows of units.

use gyradius_statistics::SummaryNames;
use parquet::{errors::ParquetError, file::reader::FileReader};
use std::{
    io::Read,
    mem,
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use super::{
    ForeignError, ForeignTable, Form,
    of_csv::{CsvText, reader},
    of_parquet::{cells, open, row_in_file, unread},
    parquet_cells::{Cells, has_numbers},
    place_of,
    written::number,
};
use crate::column::Column;

/// A row that is no run.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {at}, column {column:?}: {problem}", path.display())]
pub struct NoRunError {
    path: PathBuf,
    at: String,
    column: String,
    problem: NoRun,
}

/// Why it is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
enum NoRun {
    #[error(
        "the row says {word:?}, and one that sums up others is no run: it must be left out of the table, or, if it is a run, be called \
         otherwise"
    )]
    Summary { word: String },
    #[error(
        "{cell:?} is not the number of a run, and other rows have whole numbers there: each row must have one, a row that is no run must be \
         left out of the table, and the column must have another name if it says something else"
    )]
    NoNumber { cell: String },
    #[error(
        "{cell:?} stands above numbers, and no cell of its row is a number. A row of units or of more names is no run and must be left out of the \
         table; a run without a number must have NaN there"
    )]
    Units { cell: String },
}

/// What the cells are that tell a row which is no run.
#[derive(Debug, Default)]
struct Seen {
    names: SummaryNames,
    /// Whether one was there that is not empty.
    is_begun: bool,
    /// Whether one is the number of a run, and the first that is none.
    is_numbered: bool,
    without: Option<(PathBuf, String, String)>,
}

/// A column that is looked at.
#[derive(Debug)]
struct Looked {
    place: usize,
    name: String,
    is_run: bool,
    seen: Seen,
}

impl Looked {
    /// The columns that tell: `run`, and those that may name rows.
    fn of(columns: &[String], labels: Vec<usize>) -> Vec<Self> {
        let [_, run, _] = Column::first();
        let run = place_of(columns, &run);
        let mut places: Vec<usize> = run.into_iter().chain(labels).collect();
        places.sort_unstable();
        places.dedup();
        let looked = |place: usize| {
            let (name, seen) = (columns[place].clone(), Seen::default());
            Self { place, name, is_run: run == Some(place), seen }
        };
        places.into_iter().map(looked).collect()
    }

    /// The next cell, as it is written, and where it is; ends with why its row is no run.
    fn add(&mut self, path: &Path, at: impl Fn() -> String, cell: &str) -> ControlFlow<NoRunError> {
        let cell = cell.trim();
        let found = number(cell);
        // An empty cell is no name, and of numbers, of which there may be many, the first says as much as all.
        let is_first = found != Some(None) && !mem::replace(&mut self.seen.is_begun, true);
        if (found.is_none() || is_first) && self.seen.names.sums_up(cell) && found.is_none() {
            let (path, at, column) = (path.to_owned(), at(), self.name.clone());
            let problem = NoRun::Summary { word: cell.to_owned() };
            return ControlFlow::Break(NoRunError { path, at, column, problem });
        }
        self.add_number(path, at, found.flatten(), cell);
        ControlFlow::Continue(())
    }

    /// The same of a cell that says nothing but a number, if there is one.
    fn add_number(&mut self, path: &Path, at: impl Fn() -> String, run: Option<f64>, cell: &str) {
        if !self.is_run {
            return;
        }
        self.seen.is_numbered |= run.is_some_and(|run| Column::run_named(run).is_some());
        // An average of numbers has a fraction, most often.
        if self.seen.without.is_none() && run.is_none_or(|run| run.fract() != 0.0) {
            self.seen.without = Some((path.to_owned(), at(), cell.to_owned()));
        }
    }

    /// What is wrong after all cells.
    fn end(self) -> Option<NoRunError> {
        let Seen { is_numbered, without, .. } = self.seen;
        let (path, at, cell) = without.filter(|_| is_numbered)?;
        Some(NoRunError { path, at, column: self.name, problem: NoRun::NoNumber { cell } })
    }
}

impl ForeignTable {
    /// The first row that is no run: that sums up others, as a cell with its name says, has no number of a run where others have one, or has units. The
    /// tables of a study have none.
    ///
    /// # Errors
    /// A file cannot be read.
    pub(crate) fn no_run(&self) -> Result<Option<NoRunError>, ForeignError> {
        if self.origin.is_some() {
            return Ok(None);
        }
        let mut looked = Looked::of(&self.columns, self.labels()?);
        for path in &self.files {
            let found = match &self.form {
                Form::Parquet => look_parquet(path, &mut looked)?,
                Form::Csv { separator, text } => {
                    look_csv(path, text, (*separator, self.columns.len()), &mut looked)?
                }
            };
            if let ControlFlow::Break(found) = found {
                return Ok(Some(found));
            }
        }
        Ok(looked.into_iter().find_map(Looked::end))
    }
}

/// The texts of the first row of a table, of which no cell is a number, where all cells below them are numbers.
#[derive(Debug, Default)]
struct AboveNumbers {
    at: String,
    /// Place and text, and whether a number stands below.
    texts: Vec<(usize, String, bool)>,
}

impl AboveNumbers {
    /// Of the first row. A unit may be 1, and so may the number of a run be.
    fn of(row: &csv::StringRecord, run: Option<usize>, at: String) -> Self {
        let is_number = |(place, cell): (usize, &str)| {
            (cell != "1" || run == Some(place)) && number(cell).flatten().is_some()
        };
        if row.iter().enumerate().any(is_number) {
            return Self::default();
        }
        let texts = row.iter().enumerate().filter(|(_, cell)| number(cell).is_none());
        Self { at, texts: texts.map(|(place, cell)| (place, cell.to_owned(), false)).collect() }
    }

    fn add(&mut self, row: &csv::StringRecord) {
        self.texts.retain_mut(|(place, _, has_number)| {
            let cell = number(row.get(*place).unwrap_or_default());
            *has_number |= cell.flatten().is_some();
            cell.is_some()
        });
    }

    fn end(self, path: &Path, reader: &mut csv::Reader<impl Read>) -> Option<NoRunError> {
        let (place, cell, _) = self.texts.into_iter().find(|(_, _, has_number)| *has_number)?;
        let column = reader.headers().ok()?.get(place).unwrap_or_default().to_owned();
        Some(NoRunError {
            path: path.to_owned(),
            at: self.at,
            column,
            problem: NoRun::Units { cell },
        })
    }
}

fn look_csv(
    path: &Path,
    text: &CsvText,
    form: (u8, usize),
    looked: &mut [Looked],
) -> Result<ControlFlow<NoRunError>, ForeignError> {
    let mut reader = reader(path, text, form)?;
    let mut row = csv::StringRecord::new();
    let run = looked.iter().find(|one| one.is_run).map(|one| one.place);
    let mut above: Option<AboveNumbers> = None;
    // What cannot be read is told of where the numbers are.
    while matches!(reader.read_record(&mut row), Ok(true)) {
        let at = || format!("line {}", row.position().map_or(0, csv::Position::line));
        for one in &mut *looked {
            let cell = row.get(one.place).unwrap_or_default();
            let found = one.add(path, at, cell);
            if found.is_break() {
                return Ok(found);
            }
        }
        match &mut above {
            Some(above) => above.add(&row),
            None => above = Some(AboveNumbers::of(&row, run, at())),
        }
    }
    let found = above.and_then(|above| above.end(path, &mut reader));
    Ok(found.map_or(ControlFlow::Continue(()), ControlFlow::Break))
}

fn look_parquet(
    path: &Path,
    looked: &mut [Looked],
) -> Result<ControlFlow<NoRunError>, ForeignError> {
    let failed = |error: ParquetError| unread(path, &error);
    let file = open(path).map_err(failed)?;
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    let mut first = 0;
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group).map_err(failed)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        for one in &mut *looked {
            let column = schema.column(one.place);
            let may_tell = one.is_run || !has_numbers(&column);
            if column.max_rep_level() > 0 || !may_tell {
                continue;
            }
            let at = |row: usize| row_in_file(first + row);
            match cells(path, &*group, one.place)? {
                Cells::Texts(cells) => {
                    for (row, cell) in cells.into_iter().enumerate() {
                        let found = one.add(path, || at(row), cell.as_deref().unwrap_or_default());
                        if found.is_break() {
                            return Ok(found);
                        }
                    }
                }
                Cells::Numbers(cells) => {
                    for (row, cell) in cells.into_iter().enumerate() {
                        let number = cell.filter(|number| !number.is_nan());
                        let cell = number.map_or_else(String::new, |number| number.to_string());
                        one.add_number(path, || at(row), number, &cell);
                    }
                }
            }
        }
        first += rows;
    }
    Ok(ControlFlow::Continue(()))
}
