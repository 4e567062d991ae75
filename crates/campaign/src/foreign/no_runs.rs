//! Rows of a table that are no runs: those that sum up others, and those without a number among numbered runs.

use gyradius_statistics::SummaryNames;
use parquet::{basic::Type as Physical, errors::ParquetError, file::reader::FileReader};
use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use super::{
    ForeignError, ForeignTable, Form,
    models::Models,
    of_csv::{CsvText, reader},
    of_parquet::{Whole, names, numbers, open, texts, unread, unread_codec},
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
}

/// What the cells are that tell a row which is no run.
#[derive(Debug, Default)]
struct Cells {
    names: SummaryNames,
    /// Whether one is the number of a run, and the first that is no number at all.
    is_numbered: bool,
    without: Option<(PathBuf, String, String)>,
}

/// A column that is looked at.
#[derive(Debug)]
struct Looked {
    place: usize,
    name: String,
    is_run: bool,
    cells: Cells,
}

impl Looked {
    /// The columns that tell: `run`, and the first one, of which models have any names beside `run`.
    fn of(columns: &[String]) -> Vec<Self> {
        let [_, run, _] = Column::first();
        let run = place_of(columns, &run);
        let first = (!columns.is_empty() && run != Some(0)).then_some(0);
        let first = first.filter(|place| run.is_none() || Models::place(columns) != Some(*place));
        let looked = |place: usize| {
            let (name, cells) = (columns[place].clone(), Cells::default());
            Self { place, name, is_run: run == Some(place), cells }
        };
        run.into_iter().chain(first).map(looked).collect()
    }

    /// The next cell, as it is written, and where it is; ends with why its row is no run.
    fn add(&mut self, path: &Path, at: impl Fn() -> String, cell: &str) -> ControlFlow<NoRunError> {
        let cell = cell.trim();
        let found = number(cell);
        if self.cells.names.sums_up(cell) && found.is_none() {
            let (path, at, column) = (path.to_owned(), at(), self.name.clone());
            let problem = NoRun::Summary { word: cell.to_owned() };
            return ControlFlow::Break(NoRunError { path, at, column, problem });
        }
        self.add_number(path, at, found.flatten(), cell);
        ControlFlow::Continue(())
    }

    /// The same of a cell that says nothing but a number, if there is one.
    fn add_number(&mut self, path: &Path, at: impl Fn() -> String, run: Option<f64>, cell: &str) {
        match run {
            Some(run) => self.cells.is_numbered |= Column::run_named(run).is_some(),
            None if self.is_run && self.cells.without.is_none() => {
                self.cells.without = Some((path.to_owned(), at(), cell.to_owned()));
            }
            None => {}
        }
    }

    /// What is wrong after all cells.
    fn end(self) -> Option<NoRunError> {
        let Cells { is_numbered, without, .. } = self.cells;
        let (path, at, cell) = without.filter(|_| is_numbered)?;
        Some(NoRunError { path, at, column: self.name, problem: NoRun::NoNumber { cell } })
    }
}

impl ForeignTable {
    /// The first row that is no run: that sums up others, as its first cell or the one in the column `run` says, or has no number of a run where
    /// others have one. The tables of a study have none.
    ///
    /// # Errors
    /// A file cannot be read.
    pub(crate) fn no_run(&self) -> Result<Option<NoRunError>, ForeignError> {
        if self.origin.is_some() {
            return Ok(None);
        }
        let mut looked = Looked::of(&self.columns);
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

fn look_csv(
    path: &Path,
    text: &CsvText,
    form: (u8, usize),
    looked: &mut [Looked],
) -> Result<ControlFlow<NoRunError>, ForeignError> {
    let mut reader = reader(path, text, form)?;
    let mut row = csv::StringRecord::new();
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
    }
    Ok(ControlFlow::Continue(()))
}

fn look_parquet(
    path: &Path,
    looked: &mut [Looked],
) -> Result<ControlFlow<NoRunError>, ForeignError> {
    let failed = |error: ParquetError| unread(path, &error);
    let file = open(path).map_err(failed)?;
    let there = names(&file);
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    let mut first = 0;
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group).map_err(failed)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        for one in &mut *looked {
            // Another file of the folder may have its columns in another order.
            let Some(place) = there.iter().position(|name| *name == one.name) else { continue };
            let column = schema.column(place);
            let codec = unread_codec(group.metadata().column(place).compression());
            if column.max_rep_level() > 0 || codec.is_some() {
                continue;
            }
            let whole = Whole::of(&column).unwrap_or(Whole::Signed);
            let cells = group.get_column_reader(place).map_err(failed)?;
            let is_text = match column.physical_type() {
                Physical::BYTE_ARRAY | Physical::FIXED_LEN_BYTE_ARRAY => true,
                Physical::BOOLEAN
                | Physical::INT32
                | Physical::INT64
                | Physical::INT96
                | Physical::FLOAT
                | Physical::DOUBLE => false,
            };
            let at = |row: usize| format!("row {}", first + row + 1);
            if is_text {
                let cells = texts(cells, rows, whole).map_err(failed)?;
                for (row, cell) in cells.into_iter().enumerate() {
                    let found = one.add(path, || at(row), cell.as_deref().unwrap_or_default());
                    if found.is_break() {
                        return Ok(found);
                    }
                }
            } else if one.is_run && column.physical_type() != Physical::INT96 {
                let runs = numbers(cells, rows, whole).map_err(failed)?;
                for (row, run) in runs.into_iter().enumerate() {
                    one.add_number(path, || at(row), run.filter(|run| !run.is_nan()), "");
                }
            }
        }
        first += rows;
    }
    Ok(ControlFlow::Continue(()))
}
