//! Run tables as Parquet, in groups of many rows: a writer keeps a note of every group until the end.

use std::io::Write;

use super::{FormatError, TableWriter};
use crate::{stored::ParquetWriter, table::Table};

/// Rows of a group, at least: a thousand million runs are some thousand groups.
const GROUP_ROWS: usize = 1 << 17;

pub(super) struct Writer<W: Write + Send> {
    writer: ParquetWriter<W>,
    /// Runs of one model that are not written yet.
    waiting: Table,
}

impl<W: Write + Send> Writer<W> {
    pub(super) fn new(columns: &Table, output: W) -> Result<Self, FormatError> {
        let writer = ParquetWriter::new(columns, output)?;
        Ok(Self { writer, waiting: columns.from_run(columns.first()) })
    }
}

impl<W: Write + Send> TableWriter for Writer<W> {
    fn write(&mut self, runs: &Table) -> Result<(), FormatError> {
        let next = self.waiting.first() + self.waiting.len() as u64;
        if self.waiting.model() == runs.model() && next == runs.first() {
            self.waiting.append(runs.clone());
        } else {
            self.writer.write(&self.waiting)?;
            self.waiting = runs.clone();
        }
        if self.waiting.len() >= GROUP_ROWS {
            self.writer.write(&self.waiting)?;
            self.waiting = runs.from_run(runs.first() + runs.len() as u64);
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<(), FormatError> {
        self.writer.write(&self.waiting)?;
        Ok(self.writer.finish()?)
    }
}
