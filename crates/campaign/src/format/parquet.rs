//! Run tables as Parquet, a row group for each block.

use std::io::Write;

use super::{FormatError, TableWriter};
use crate::{stored::ParquetWriter, table::Table};

pub(super) struct Writer<W: Write + Send>(ParquetWriter<W>);

impl<W: Write + Send> Writer<W> {
    pub(super) fn new(columns: &Table, output: W) -> Result<Self, FormatError> {
        Ok(Self(ParquetWriter::new(columns, output)?))
    }
}

impl<W: Write + Send> TableWriter for Writer<W> {
    fn write(&mut self, runs: &Table) -> Result<(), FormatError> {
        Ok(self.0.write(runs)?)
    }

    fn finish(self: Box<Self>) -> Result<(), FormatError> {
        Ok(self.0.finish()?)
    }
}
