//! Run tables as CSV: numbers have as many digits as read back bit for bit, and what is not there is empty.

use std::{fmt::Write as _, io::Write};

use super::{FormatError, TableWriter, write_rows};
use crate::{cell::Cell, column::Column, table::Table};

pub(super) struct Writer<W> {
    output: W,
}

impl<W: Write> Writer<W> {
    /// Writes the names of the columns.
    pub(super) fn new(columns: &Table, mut output: W) -> Result<Self, FormatError> {
        let mut lines = csv::Writer::from_writer(Vec::new());
        lines.write_record(columns.columns().iter().map(Column::name))?;
        output.write_all(&written(lines)?)?;
        Ok(Self { output })
    }
}

impl<W: Write + Send> TableWriter for Writer<W> {
    fn write(&mut self, runs: &Table) -> Result<(), FormatError> {
        write_rows(runs, &mut self.output, |rows| {
            let mut lines = csv::Writer::from_writer(Vec::new());
            let mut field = String::new();
            for row in rows {
                for (_, cell) in row.cells() {
                    field.clear();
                    if cell != Cell::Null {
                        // Writing into a text cannot fail.
                        let _ = write!(field, "{cell}");
                    }
                    lines.write_field(&field)?;
                }
                lines.write_record(None::<&[u8]>)?;
            }
            written(lines)
        })
    }

    fn finish(mut self: Box<Self>) -> Result<(), FormatError> {
        Ok(self.output.flush()?)
    }
}

fn written(lines: csv::Writer<Vec<u8>>) -> Result<Vec<u8>, FormatError> {
    Ok(lines.into_inner().map_err(csv::IntoInnerError::into_error)?)
}
