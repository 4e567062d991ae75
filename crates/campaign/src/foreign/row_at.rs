//! Where a row of a table is, for messages.

use parquet::file::reader::FileReader;
use std::path::Path;

use super::{
    ForeignTable, Form,
    of_csv::{CsvText, reader},
    of_parquet::{open, row_in_file},
};

impl ForeignTable {
    /// Where a row is that is counted from 0 through all files: its line in CSV, its row in a Parquet file.
    #[must_use]
    pub fn row_at(&self, row: u64) -> String {
        let mut before = row;
        for path in &self.files {
            match &self.form {
                Form::Csv { separator, text } => {
                    let form = (*separator, self.columns.len());
                    if let Some(line) = line(path, text, form, before) {
                        return format!("line {line}");
                    }
                }
                Form::Parquet => {
                    let rows = open(path).map_or(0, |file| rows(&file));
                    match before.checked_sub(rows) {
                        Some(rest) => before = rest,
                        None => {
                            let name = path.file_name().unwrap_or_default().display();
                            return format!("{} of {name}", row_in_file(before));
                        }
                    }
                }
            }
        }
        // The files have changed since the row was seen.
        row_in_file(row)
    }
}

fn rows(file: &impl FileReader) -> u64 {
    u64::try_from(file.metadata().file_metadata().num_rows()).unwrap_or(0)
}

fn line(path: &Path, text: &CsvText, form: (u8, usize), row: u64) -> Option<u64> {
    let mut reader = reader(path, text, form).ok()?;
    let record = reader.records().nth(usize::try_from(row).ok()?)?.ok()?;
    record.position().map(csv::Position::line)
}
