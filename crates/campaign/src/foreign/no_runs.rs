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
        "{cell:?} stands where the other rows have whole numbers, as a row that sums up others does: a row that is no run must be left out of the \
         table, and a run must have a whole number there, too"
    )]
    Text { cell: String },
    #[error(
        "{cell:?} stands above numbers, and no cell of its row is a number, or none but 1, which may be a unit. A row of units or of more names is no run and must be left out of the \
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
    numbers: Numbers,
}

/// What the cells of a column without the name `run` are that may number its rows.
#[derive(Debug, Default)]
struct Numbers {
    cells: u64,
    wholes: u64,
    texts: u64,
    last: Option<f64>,
    /// Whether a number is no whole one, or not above the one before it.
    is_mixed: bool,
    is_unordered: bool,
    /// The first text below the first row that begins with no digit.
    text: Option<(PathBuf, String, String)>,
}

impl Numbers {
    fn add(&mut self, cell: &str, at: impl Fn() -> (PathBuf, String)) {
        let is_first = self.cells == 0;
        self.cells += 1;
        match number(cell) {
            Some(Some(number)) => {
                self.wholes += 1;
                self.is_mixed |= number.fract() != 0.0;
                self.is_unordered |= self.last.replace(number).is_some_and(|last| last >= number);
            }
            Some(None) => {}
            None => {
                self.texts += 1;
                // The first run may be a nominal one, and `2a` may follow 2.
                let may_name = is_first || cell.starts_with(|c: char| c.is_ascii_digit());
                if self.text.is_none() && !may_name {
                    let (path, at) = at();
                    self.text = Some((path, at, cell.to_owned()));
                }
            }
        }
    }

    /// The text, if whole numbers are all else in most rows, and in their order unless the column is the first to name rows.
    fn text(self, is_first: bool) -> Option<(PathBuf, String, String)> {
        let are_numbered = !self.is_mixed && self.wholes > self.texts;
        self.text.filter(|_| are_numbered && (is_first || !self.is_unordered))
    }
}

/// A column that is looked at.
#[derive(Debug)]
struct Looked {
    place: usize,
    name: String,
    is_run: bool,
    /// Whether it is the first that may name rows.
    is_first: bool,
    seen: Seen,
}

impl Looked {
    /// The columns that tell: `run`, and those that may name rows.
    fn of(columns: &[String], labels: Vec<usize>) -> Vec<Self> {
        let [_, run, _] = Column::first();
        let run = place_of(columns, &run);
        let first = labels.first().copied();
        let mut places: Vec<usize> = run.into_iter().chain(labels).collect();
        places.sort_unstable();
        places.dedup();
        let looked = |place: usize| {
            let (name, seen) = (columns[place].clone(), Seen::default());
            Self { place, name, is_run: run == Some(place), is_first: first == Some(place), seen }
        };
        places.into_iter().map(looked).collect()
    }

    /// The next cell, as it is written, and where it is; ends with why its row is no run.
    fn add(
        &mut self,
        path: &Path,
        at: impl Fn() -> String,
        cell: &str,
        columns: &[String],
    ) -> ControlFlow<NoRunError> {
        let cell = cell.trim();
        let found = number(cell);
        // An empty cell is no name, and of numbers, of which there may be many, the first says as much as all.
        let is_first = found != Some(None) && !mem::replace(&mut self.seen.is_begun, true);
        let may_name = found.is_none() || is_first;
        if may_name && self.seen.names.sums_up(of_column(cell, columns)) && found.is_none() {
            let (path, at, column) = (path.to_owned(), at(), self.name.clone());
            let problem = NoRun::Summary { word: cell.to_owned() };
            return ControlFlow::Break(NoRunError { path, at, column, problem });
        }
        if !self.is_run {
            self.seen.numbers.add(cell, || (path.to_owned(), at()));
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
        let Seen { is_numbered, without, numbers, .. } = self.seen;
        if let Some((path, at, cell)) = numbers.text(self.is_first) {
            let problem = NoRun::Text { cell };
            return Some(NoRunError { path, at, column: self.name, problem });
        }
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
                Form::Parquet => look_parquet(path, &self.columns, &mut looked)?,
                Form::Csv { separator, text } => {
                    look_csv(path, text, (*separator, &self.columns), &mut looked)?
                }
            };
            if let ControlFlow::Break(found) = found {
                return Ok(Some(found));
            }
        }
        Ok(looked.into_iter().find_map(Looked::end))
    }
}

/// A statistic without the column that it is of, `Mean` of `Mean (x)` and of `mean of x [deg]`; any other name as it is.
fn of_column<'a>(cell: &'a str, columns: &[String]) -> &'a str {
    let Some((word, of)) = cell.split_once(" of ").or_else(|| cell.split_once(['(', '['])) else {
        return cell;
    };
    let bare = |name: &str| name.trim_matches(|c: char| " ()[]".contains(c)).to_lowercase();
    let parts = |name: &str| -> Vec<String> { name.split(['(', '[']).map(bare).collect() };
    let of = bare(of);
    let is_column = |name: &String| bare(name) == of || parts(name).contains(&of);
    if !of.is_empty() && columns.iter().any(is_column) { word.trim() } else { cell }
}

/// The texts of the first row of a table, of which no cell is a number, where all cells below them are numbers.
#[derive(Debug, Default)]
struct AboveNumbers {
    at: String,
    /// Whether a cell is 1, which may be a unit.
    has_one: bool,
    texts: Vec<AboveNumber>,
}

/// A text of the first row.
#[derive(Debug)]
struct AboveNumber {
    place: usize,
    cell: String,
    /// Whether a number stands below, and whether one that is not whole does.
    has_number: bool,
    has_fraction: bool,
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
        let text = |(place, cell): (usize, &str)| AboveNumber {
            place,
            cell: cell.to_owned(),
            has_number: false,
            has_fraction: false,
        };
        Self { at, has_one: row.iter().any(|cell| cell == "1"), texts: texts.map(text).collect() }
    }

    fn add(&mut self, row: &csv::StringRecord) {
        self.texts.retain_mut(|text| {
            let cell = number(row.get(text.place).unwrap_or_default());
            text.has_number |= cell.flatten().is_some();
            text.has_fraction |= cell.flatten().is_some_and(|number| number.fract() != 0.0);
            cell.is_some()
        });
    }

    fn end(self, path: &Path, reader: &mut csv::Reader<impl Read>) -> Option<NoRunError> {
        let mut texts = self.texts.into_iter().filter(|text| text.has_number);
        let (text, is_alone) = (texts.next()?, texts.next().is_none());
        if self.has_one && is_alone && text.is_name() {
            return None;
        }
        let column = reader.headers().ok()?.get(text.place).unwrap_or_default().to_owned();
        let problem = NoRun::Units { cell: text.cell };
        Some(NoRunError { path: path.to_owned(), at: self.at, column, problem })
    }
}

impl AboveNumber {
    /// Whether it is the name of a run whose other cells are 1, as `baseline` above runs 0, 1 and 2, and no unit: these have few letters or signs.
    fn is_name(&self) -> bool {
        let letters = self.cell.chars().filter(|c| c.is_alphabetic()).count();
        let is_plain = self.cell.chars().all(|c| c.is_alphanumeric() || " _-".contains(c));
        self.place == 0 && !self.has_fraction && letters >= 4 && is_plain
    }
}

fn look_csv(
    path: &Path,
    text: &CsvText,
    (separator, columns): (u8, &[String]),
    looked: &mut [Looked],
) -> Result<ControlFlow<NoRunError>, ForeignError> {
    let mut reader = reader(path, text, (separator, columns.len()))?;
    let mut row = csv::StringRecord::new();
    let run = looked.iter().find(|one| one.is_run).map(|one| one.place);
    let mut above: Option<AboveNumbers> = None;
    // What cannot be read is told of where the numbers are.
    while matches!(reader.read_record(&mut row), Ok(true)) {
        let at = || format!("line {}", row.position().map_or(0, csv::Position::line));
        for one in &mut *looked {
            let cell = row.get(one.place).unwrap_or_default();
            let found = one.add(path, at, cell, columns);
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
    columns: &[String],
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
                        let found =
                            one.add(path, || at(row), cell.as_deref().unwrap_or_default(), columns);
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
