//! Tables of numbers in Parquet files of any writer.

use parquet::{
    basic::{Compression, LogicalType, Type as Physical},
    column::reader::ColumnReader,
    data_type::ByteArray,
    errors::ParquetError,
    file::reader::{FileReader, SerializedFileReader},
};
use std::{collections::HashMap, fs::File, path::Path};

use super::{Columns, ForeignError, places, status};
use crate::{
    failure::{Failure, OK},
    runs_error::said,
    stored::read,
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
    ForeignError { path: path.to_owned(), problem: said(error) }
}

pub(super) fn scan_parquet(
    path: &Path,
    (measured, written): (&[String], &[String]),
    look: &mut impl FnMut(&Columns),
) -> Result<(), ForeignError> {
    let failed = |error: ParquetError| unread(path, &error);
    let reader = open(path).map_err(failed)?;
    let there = names(&reader);
    let places = places(path, &there, measured.iter().chain(written))?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let durations = durations(&reader);
    for place in &places {
        let column = schema.column(*place);
        let wrong = |problem: &str| ForeignError {
            path: path.to_owned(),
            problem: format!("the column {:?} {problem}", column.path().string()),
        };
        if column.max_rep_level() > 0 {
            return Err(wrong("is of lists, and must be of numbers"));
        }
        if let Some(unit) = durations.get(&column.path().string()) {
            return Err(wrong(&format!(
                "is of durations ({unit}), and must be of numbers: in pandas write df[name].dt.total_seconds()"
            )));
        }
        match column.physical_type() {
            Physical::BOOLEAN
            | Physical::INT32
            | Physical::INT64
            | Physical::FLOAT
            | Physical::DOUBLE
                if column.logical_type_ref().is_none_or(is_plain) => {}
            Physical::BOOLEAN
            | Physical::INT32
            | Physical::INT64
            | Physical::INT96
            | Physical::FLOAT
            | Physical::DOUBLE
            | Physical::BYTE_ARRAY
            | Physical::FIXED_LEN_BYTE_ARRAY => {
                return Err(wrong(
                    "is of texts, dates or decimals, of numbers of 16 bits, or of no type, and must be of numbers of 32 or 64 bits, whole numbers or flags",
                ));
            }
        }
    }
    let status = status(&there);
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(failed)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        for place in places.iter().chain(&status) {
            if let Some(codec) = unread_codec(group.metadata().column(*place).compression()) {
                let problem = format!(
                    "the column {:?} is compressed with {codec}, which is not read: write the table with snappy, gzip, lz4 or no \
                     compression, in polars by df.write_parquet(path, compression=\"snappy\")",
                    there[*place]
                );
                return Err(ForeignError { path: path.to_owned(), problem });
            }
        }
        let column = |place: &usize| {
            let unsigned = schema.column(*place).logical_type_ref().is_some_and(is_unsigned);
            numbers(group.get_column_reader(*place)?, rows, unsigned)
        };
        let numbers = places.iter().map(column).collect::<Result<Vec<_>, ParquetError>>();
        let mut numbers = numbers.map_err(failed)?;
        if let Some(place) = status
            && let ColumnReader::ByteArrayColumnReader(texts) =
                group.get_column_reader(place).map_err(failed)?
        {
            let is_ok = |text: &Option<ByteArray>| {
                text.as_ref().is_some_and(|text| text.data() == OK.as_bytes())
            };
            let texts = read(texts, rows).map_err(failed)?;
            for (row, _) in texts.iter().enumerate().filter(|(_, text)| !is_ok(text)) {
                let numbers = numbers[..measured.len()].iter_mut().map(|numbers| &mut numbers[row]);
                numbers.for_each(|number| *number = number.filter(|x| Failure::has_number(*x)));
            }
        }
        look(&numbers);
    }
    Ok(())
}

/// The columns of durations with their types. Parquet has none: what writes them with pandas says so beside the table, and in it are whole
/// numbers of some unit.
fn durations(reader: &SerializedFileReader<File>) -> HashMap<String, String> {
    let notes = reader.metadata().file_metadata().key_value_metadata();
    let of_pandas = notes.into_iter().flatten().filter(|note| note.key == "pandas");
    let texts = of_pandas.filter_map(|note| serde_json::from_str(note.value.as_ref()?).ok());
    let columns = texts.flat_map(|told: serde_json::Value| {
        told["columns"].as_array().cloned().unwrap_or_default()
    });
    let type_of = |column: serde_json::Value| {
        let [name, kind] =
            ["name", "numpy_type"].map(|key| column[key].as_str().map(str::to_owned));
        name.zip(kind).filter(|(_, kind)| kind.starts_with("timedelta"))
    };
    columns.filter_map(type_of).collect()
}

/// How a column is compressed, if that is not read: what these need is in C, or large.
pub(super) fn unread_codec(compression: Compression) -> Option<&'static str> {
    match compression {
        Compression::UNCOMPRESSED
        | Compression::SNAPPY
        | Compression::GZIP(_)
        | Compression::LZ4
        | Compression::LZ4_RAW => None,
        Compression::LZO => Some("LZO"),
        Compression::BROTLI(_) => Some("Brotli"),
        Compression::ZSTD(_) => Some("zstd"),
    }
}

/// Whether a number means what it is.
fn is_plain(logical: &LogicalType) -> bool {
    matches!(logical, LogicalType::Integer(_))
}

/// Whether the highest bit of a whole number is no sign.
fn is_unsigned(logical: &LogicalType) -> bool {
    matches!(logical, LogicalType::Integer(whole) if !whole.is_signed)
}

pub(super) fn numbers(
    reader: ColumnReader,
    rows: usize,
    unsigned: bool,
) -> Result<Vec<Option<f64>>, ParquetError> {
    macro_rules! all {
        ($reader:expr, $number:expr) => {
            read($reader, rows)?.into_iter().map(|cell| cell.map($number)).collect()
        };
    }
    Ok(match reader {
        ColumnReader::BoolColumnReader(r) => all!(r, |flag| f64::from(u8::from(flag))),
        ColumnReader::Int32ColumnReader(r) if unsigned => {
            all!(r, |whole| f64::from(whole.cast_unsigned()))
        }
        ColumnReader::Int64ColumnReader(r) if unsigned => {
            all!(r, |whole| whole.cast_unsigned() as f64)
        }
        ColumnReader::Int32ColumnReader(r) => all!(r, f64::from),
        ColumnReader::Int64ColumnReader(r) => all!(r, |whole| whole as f64),
        ColumnReader::FloatColumnReader(r) => all!(r, f64::from),
        ColumnReader::DoubleColumnReader(r) => all!(r, |number| number),
        ColumnReader::Int96ColumnReader(_)
        | ColumnReader::ByteArrayColumnReader(_)
        | ColumnReader::FixedLenByteArrayColumnReader(_) => {
            return Err(ParquetError::General("a column of no numbers".to_owned()));
        }
    })
}
