//! Tables of numbers in Parquet files of any writer.

use parquet::{
    basic::{Compression, Type as Physical},
    column::reader::ColumnReader,
    errors::ParquetError,
    file::reader::{FileReader, RowGroupReader, SerializedFileReader},
    schema::types::ColumnDescriptor,
};
use std::{collections::HashMap, fmt, fs::File, path::Path};

use super::{
    Columns, ForeignError, OfModels,
    models::Models,
    parquet_cells::{Cells, has_numbers},
    places,
    reason::no_reason,
    status,
};
use crate::{
    failure::{Failure, OK},
    runs_error::said,
};

pub(super) fn parquet_columns(path: &Path) -> Result<Vec<String>, ForeignError> {
    open(path).map(|reader| names(&reader)).map_err(|error| unread(path, &error))
}

pub(super) fn names(reader: &SerializedFileReader<File>) -> Vec<String> {
    let schema = reader.metadata().file_metadata().schema_descr();
    schema.columns().iter().map(|column| column.path().string()).collect()
}

pub(super) fn open(path: &Path) -> Result<SerializedFileReader<File>, ParquetError> {
    SerializedFileReader::new(File::open(path)?)
}

pub(super) fn unread(path: &Path, error: &ParquetError) -> ForeignError {
    ForeignError::new(path, said(error))
}

pub(super) fn scan_parquet(
    path: &Path,
    (measured, written): (&[String], &[String]),
    of_study: bool,
    mut models: Option<&mut Models>,
    look: &mut impl FnMut(&Columns, &OfModels),
) -> Result<(), ForeignError> {
    let failed = |error: ParquetError| unread(path, &error);
    let reader = open(path).map_err(failed)?;
    let there = names(&reader);
    let places = places(path, &there, measured.iter().chain(written))?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let durations = durations(&reader);
    let wrong = |place: usize, problem: &str| ForeignError::of_column(path, &there[place], problem);
    for (place_of, place) in places.iter().enumerate() {
        let column = schema.column(*place);
        let wrong = |problem: &str| wrong(*place, problem);
        if column.max_rep_level() > 0 {
            return Err(wrong("is of lists, and must be of numbers"));
        }
        if let Some(unit) = durations.get(&column.path().string()) {
            return Err(wrong(&format!(
                "is of durations ({unit}), and must be of numbers: in pandas write df[name].dt.total_seconds()"
            )));
        }
        if place_of < measured.len() && !has_numbers(&column) {
            return Err(wrong(
                "is of texts, dates or decimals, of numbers of 16 bits, or of no type, and must be of numbers of 32 or 64 bits, whole numbers or flags",
            ));
        }
    }
    let status = status(&there);
    if let Some(place) = status {
        let column = schema.column(place);
        if column.physical_type() != Physical::BYTE_ARRAY || column.max_rep_level() > 0 {
            let problem = format!(
                "says of each run whether it ended, and must be of texts, {OK:?} or why the run failed; give it another name if it says something else"
            );
            return Err(wrong(place, &problem));
        }
    }
    let is_asked = |_: &usize| models.is_some();
    let of_model = Models::place(&there).filter(is_asked);
    let of_model = of_model.filter(|place| schema.column(*place).max_rep_level() == 0);
    let mut first = 0;
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(failed)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        let cells = |place: usize| cells(path, &*group, place);
        let numbers = places.iter().map(|place| cells(*place).map(Cells::numbers));
        let mut numbers = numbers.collect::<Result<Vec<_>, ForeignError>>()?;
        if let Some(place) = status {
            let texts = cells(place)?.texts();
            let is_ok = |text: &Option<String>| text.as_deref() == Some(OK);
            for (row, text) in texts.iter().enumerate().filter(|(_, text)| !is_ok(text)) {
                let problem = if of_study { None } else { no_reason(text.as_deref()) };
                if let Some(problem) = problem {
                    let at = row_in_file(first + row);
                    let problem = format!("{at}, column {:?}: {problem}", there[place]);
                    return Err(ForeignError::new(path, problem));
                }
                let numbers = numbers[..measured.len()].iter_mut().map(|numbers| &mut numbers[row]);
                numbers.for_each(|number| *number = number.filter(|x| Failure::has_number(*x)));
            }
        }
        let mut of_models = vec![None; if models.is_some() { rows } else { 0 }];
        if let (Some(place), Some(models)) = (of_model, &mut models) {
            let cells = cells(place)?.texts();
            of_models = cells.iter().map(|cell| models.number(cell.as_deref()?)).collect();
        }
        look(&numbers, &of_models);
        first += rows;
    }
    Ok(())
}

/// The cells of a column in a group of rows.
pub(super) fn cells(
    path: &Path,
    group: &dyn RowGroupReader,
    place: usize,
) -> Result<Cells, ForeignError> {
    read_by(Cells::read, path, group, place)
}

/// The same as they are written, whole numbers with all digits.
pub(super) fn texts(
    path: &Path,
    group: &dyn RowGroupReader,
    place: usize,
) -> Result<Vec<Option<String>>, ForeignError> {
    read_by(Cells::read_texts, path, group, place)
}

fn read_by<T>(
    read: fn(ColumnReader, &ColumnDescriptor, usize) -> Result<T, ParquetError>,
    path: &Path,
    group: &dyn RowGroupReader,
    place: usize,
) -> Result<T, ForeignError> {
    let chunk = group.metadata().column(place);
    if let Some(problem) = unread_codec(chunk.compression()) {
        return Err(ForeignError::of_column(path, &chunk.column_path().string(), &problem));
    }
    let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
    let cells = group.get_column_reader(place);
    let cells = cells.and_then(|cells| read(cells, chunk.column_descr(), rows));
    cells.map_err(|error| unread(path, &error))
}

/// How a row of a Parquet file is called, which is counted from 0, as libraries of tables count.
pub(super) fn row_in_file(row: impl fmt::Display) -> String {
    format!("row {row} (from 0)")
}

/// What pandas says of a table beside it, if it wrote the file.
fn notes_of_pandas(reader: &SerializedFileReader<File>) -> impl Iterator<Item = serde_json::Value> {
    let notes = reader.metadata().file_metadata().key_value_metadata();
    let of_pandas = notes.into_iter().flatten().filter(|note| note.key == "pandas");
    of_pandas.filter_map(|note| serde_json::from_str(note.value.as_ref()?).ok())
}

/// The columns of the index, which has the names of the rows and stands behind all others.
pub(super) fn index_of_pandas(reader: &SerializedFileReader<File>) -> Vec<String> {
    let columns = notes_of_pandas(reader)
        .flat_map(|told| told["index_columns"].as_array().cloned().unwrap_or_default());
    columns.filter_map(|column| column.as_str().map(str::to_owned)).collect()
}

/// The columns of durations with their types. Parquet has none: what writes them with pandas says so beside the table, and in it are whole
/// numbers of some unit.
fn durations(reader: &SerializedFileReader<File>) -> HashMap<String, String> {
    let columns = notes_of_pandas(reader)
        .flat_map(|told| told["columns"].as_array().cloned().unwrap_or_default());
    let type_of = |column: serde_json::Value| {
        let [name, kind] =
            ["name", "numpy_type"].map(|key| column[key].as_str().map(str::to_owned));
        name.zip(kind).filter(|(_, kind)| kind.starts_with("timedelta"))
    };
    columns.filter_map(type_of).collect()
}

/// Why a column is not read that is compressed so, if it is not: what these need is in C, or large.
fn unread_codec(compression: Compression) -> Option<String> {
    let codec = match compression {
        Compression::UNCOMPRESSED
        | Compression::SNAPPY
        | Compression::GZIP(_)
        | Compression::LZ4
        | Compression::LZ4_RAW => return None,
        Compression::LZO => "LZO",
        Compression::BROTLI(_) => "Brotli",
        Compression::ZSTD(_) => "zstd",
    };
    Some(format!(
        "is compressed with {codec}, which is not read: write the table with snappy, gzip, lz4 or no compression, in polars by \
         df.write_parquet(path, compression=\"snappy\")"
    ))
}
