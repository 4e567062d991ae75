//! One row of a run table, without reading the rest.

use parquet::{
    column::reader::ColumnReader,
    data_type::ByteArray,
    errors::ParquetError,
    file::reader::{FileReader, SerializedFileReader},
};
use std::{fs::File, path::Path};

use crate::cell::Cell;

/// The cells of a run in a table that was written, by the names of their columns; none if the table has no
/// such run.
///
/// # Errors
/// The table cannot be read, or is not of this kind.
pub fn read_row(
    path: &Path,
    run: u64,
) -> Result<Option<Vec<(String, Cell<'static>)>>, ParquetError> {
    let file = File::open(path).map_err(|e| ParquetError::External(e.into()))?;
    let reader = SerializedFileReader::new(file)?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    // Rows are in run order.
    let mut place = usize::try_from(run).unwrap_or(usize::MAX);
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        if place >= rows {
            place -= rows;
            continue;
        }
        let cell = |i: usize| {
            let name = schema.column(i).name().to_owned();
            Ok((name, cell(group.get_column_reader(i)?, place)?))
        };
        return (0..schema.num_columns()).map(cell).collect::<Result<_, ParquetError>>().map(Some);
    }
    Ok(None)
}

/// The cell of a column in the place given.
fn cell(reader: ColumnReader, place: usize) -> Result<Cell<'static>, ParquetError> {
    macro_rules! one {
        ($reader:expr, $cell:expr) => {{
            let mut reader = $reader;
            reader.skip_records(place)?;
            let (mut levels, mut values) = (Vec::new(), Vec::new());
            reader.read_records(1, Some(&mut levels), None, &mut values)?;
            values.pop().map_or(Cell::Null, $cell)
        }};
    }
    Ok(match reader {
        ColumnReader::BoolColumnReader(r) => one!(r, Cell::Flag),
        ColumnReader::Int64ColumnReader(r) => one!(r, Cell::Integer),
        ColumnReader::DoubleColumnReader(r) => one!(r, Cell::Number),
        ColumnReader::ByteArrayColumnReader(r) => {
            let text = |bytes: ByteArray| {
                Cell::Text(String::from_utf8_lossy(bytes.data()).into_owned().into())
            };
            one!(r, text)
        }
        _ => return Err(ParquetError::General("a column of a type that no run table has".into())),
    })
}
