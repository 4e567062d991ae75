//! Tables of numbers as CSV, with the names of the columns in the first line.

use std::{fs::File, io::Read, path::Path, sync::Arc};

use super::{
    Columns, ForeignError, OfModels,
    models::Models,
    places,
    reason::no_reason,
    status,
    written::{hint, number},
};
use crate::{
    csv_lines::CsvLines,
    failure::{Failure, OK},
};

/// Rows of a CSV file that are looked at together.
const TOGETHER: usize = 1 << 14;
/// What is read behind a table: a line end, for a comment that nothing ends would be a row, and a comment, which is a part of a row only if
/// a quotation mark is open.
const BEHIND: &[u8] = b"\n#\n";
/// Where the text of a CSV table is.
#[derive(Clone, Debug)]
pub(super) enum CsvText {
    InFile,
    /// In memory, for it could be read from its source once only.
    Held(Arc<Vec<u8>>),
}

pub(super) fn csv_columns(path: &Path, text: &CsvText) -> Result<(u8, Vec<String>), ForeignError> {
    // The names, and whether the first row has as many values, more than one.
    let head = |separator: u8| {
        let mut reader = reader(path, text, (separator, 0))?;
        let names = reader.headers().map_err(|e| broken(path, &e))?.clone();
        let agrees = names.len() > 1
            && reader
                .records()
                .next()
                .is_some_and(|row| row.is_ok_and(|row| row.len() == names.len()));
        Ok::<_, ForeignError>((agrees, names.iter().map(str::to_owned).collect::<Vec<_>>()))
    };
    let rank = |(agrees, names): &(bool, Vec<String>)| (*agrees, names.len());
    let mut best = (b',', head(b',')?);
    for separator in [b';', b'\t'] {
        let found = head(separator)?;
        if rank(&found) > rank(&best.1) {
            best = (separator, found);
        }
    }
    let (separator, (_, names)) = best;
    if names.iter().all(String::is_empty) {
        let problem = "it is empty: the first line must have the names of the columns".to_owned();
        return Err(ForeignError::new(path, problem));
    }
    Ok((separator, names))
}

/// What reads a table with this separator and so many columns.
pub(super) fn reader<'a>(
    path: &Path,
    text: &'a CsvText,
    (separator, columns): (u8, usize),
) -> Result<csv::Reader<Box<dyn Read + 'a>>, ForeignError> {
    let text: Box<dyn Read + 'a> = match text {
        CsvText::InFile => Box::new(File::open(path).map_err(|error| broken(path, &error.into()))?),
        CsvText::Held(bytes) => Box::new(bytes.as_slice()),
    };
    let text = CsvLines::new(text, separator, columns == 1);
    let text: Box<dyn Read + 'a> = Box::new(text.chain(BEHIND));
    let mut builder = csv::ReaderBuilder::new();
    builder.delimiter(separator).comment(Some(b'#')).trim(csv::Trim::All);
    Ok(builder.from_reader(text))
}

pub(super) fn broken(path: &Path, error: &csv::Error) -> ForeignError {
    let line = |at: &Option<csv::Position>| {
        at.as_ref().map_or_else(String::new, |at| format!("line {}: ", at.line()))
    };
    let problem = match error.kind() {
        csv::ErrorKind::Utf8 { pos, .. } => {
            format!("{}it is not UTF-8: save the table as UTF-8", line(pos))
        }
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            format!("{}the row has {len} values: there must be {expected_len}", line(pos))
        }
        _ => error.to_string(),
    };
    ForeignError::new(path, problem)
}

pub(super) fn scan_csv(
    path: &Path,
    text: &CsvText,
    form: (u8, usize),
    (measured, written): (&[String], &[String]),
    mut models: Option<&mut Models>,
    look: &mut impl FnMut(&Columns, &OfModels),
) -> Result<(), ForeignError> {
    let mut reader = reader(path, text, form)?;
    let names = reader.headers().map_err(|error| broken(path, &error))?;
    let there: Vec<String> = names.iter().map(str::to_owned).collect();
    let places = places(path, &there, measured.iter().chain(written))?;
    let status = status(&there);
    let mut some: Vec<Vec<Option<f64>>> = vec![Vec::new(); places.len()];
    let (place_of_model, mut of_models) = (Models::place(&there), Vec::new());
    let mut row = csv::StringRecord::new();
    let mut last = None;
    loop {
        let read = match reader.read_record(&mut row) {
            Ok(false) => break,
            // The text is refused or cannot be read: no row is to blame.
            Err(error) if error.is_io_error() => return Err(broken(path, &error)),
            read => read.map_err(|error| broken(path, &error)),
        };
        let line = row.position().map_or(0, csv::Position::line);
        last = Some((line, reader.position().byte()));
        let taken = read.and_then(|_| {
            let ended = status.is_none_or(|place| row.get(place) == Some(OK));
            if let Some(place) = status.filter(|_| !ended)
                && let Some(problem) = no_reason(row.get(place))
            {
                let problem = format!("line {line}, column {:?}: {problem}", there[place]);
                return Err(ForeignError::new(path, problem));
            }
            for (column, (place, numbers)) in places.iter().zip(&mut some).enumerate() {
                let cell = row.get(*place).unwrap_or_default();
                let is_measured = column < measured.len();
                let number = number(cell).or((!is_measured).then_some(None)).ok_or_else(|| {
                    let problem = format!(
                        "line {line}, column {:?}: {cell:?} is not a number{}",
                        there[*place],
                        hint(cell)
                    );
                    ForeignError::new(path, problem)
                })?;
                let is_taken = |x: &f64| ended || !is_measured || Failure::has_number(*x);
                numbers.push(number.filter(is_taken));
            }
            if let Some(models) = &mut models {
                let cell = place_of_model.and_then(|place| row.get(place));
                of_models.push(cell.and_then(|cell| models.number(cell)));
            }
            Ok(())
        });
        if let Err(error) = taken {
            return Err(open_quotation(path, &mut reader, last).unwrap_or(error));
        }
        if some.first().is_some_and(|numbers| numbers.len() == TOGETHER) {
            look(&some, &of_models);
            some.iter_mut().for_each(Vec::clear);
            of_models.clear();
        }
    }
    if let Some(open) = open_quotation(path, &mut reader, last) {
        return Err(open);
    }
    if some.first().is_some_and(|numbers| !numbers.is_empty()) {
        look(&some, &of_models);
    }
    Ok(())
}

/// What to say if the last row, from this line to this byte, ends where all does: [`BEHIND`] is in it, and a quotation mark open.
fn open_quotation(
    path: &Path,
    reader: &mut csv::Reader<impl Read>,
    last: Option<(u64, u64)>,
) -> Option<ForeignError> {
    let more = reader.read_record(&mut csv::StringRecord::new());
    let (line, end) = last.filter(|_| matches!(more, Ok(false)))?;
    let problem = || format!("line {line}: a quotation mark opens a cell, and none closes it");
    let is_open = reader.position().byte() == end;
    is_open.then(|| ForeignError::new(path, problem()))
}
