//! The cells of some columns as they are written, row by row.

use parquet::{errors::ParquetError, file::reader::FileReader};
use std::path::Path;

use super::{
    ForeignError, ForeignTable, Form,
    of_csv::{CsvText, broken, reader},
    of_parquet::{names, open, texts, unread},
};

impl ForeignTable {
    /// Looks at the cells of some columns as they are written, of numbers all digits: of each row with the number of its file. Cells without
    /// anything are empty. A file without one of the columns, or in which one is of lists, has no rows here.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn scan_texts(
        &self,
        columns: &[String],
        mut look: impl FnMut(usize, &[String]),
    ) -> Result<(), ForeignError> {
        for (file, path) in self.files.iter().enumerate() {
            let look = |cells: &[String]| look(file, cells);
            match &self.form {
                Form::Parquet => look_parquet(path, columns, look)?,
                Form::Csv { separator, text } => {
                    look_csv(path, text, (*separator, self.columns.len()), columns, look)?;
                }
            }
        }
        Ok(())
    }
}

/// Where all columns are, if they are.
fn places(there: &[String], columns: &[String]) -> Option<Vec<usize>> {
    columns.iter().map(|name| there.iter().position(|other| other == name)).collect()
}

fn look_parquet(
    path: &Path,
    columns: &[String],
    mut look: impl FnMut(&[String]),
) -> Result<(), ForeignError> {
    let failed = |error: ParquetError| unread(path, &error);
    let file = open(path).map_err(failed)?;
    let Some(places) = places(&names(&file), columns) else { return Ok(()) };
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    if places.iter().any(|place| schema.column(*place).max_rep_level() > 0) {
        return Ok(());
    }
    let mut row = Vec::with_capacity(places.len());
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group).map_err(failed)?;
        let cells = places.iter().map(|place| texts(path, &*group, *place));
        let mut cells = cells.collect::<Result<Vec<_>, ForeignError>>()?;
        for at in 0..cells.first().map_or(0, Vec::len) {
            row.clear();
            row.extend(cells.iter_mut().map(|column| column[at].take().unwrap_or_default()));
            look(&row);
        }
    }
    Ok(())
}

fn look_csv(
    path: &Path,
    text: &CsvText,
    form: (u8, usize),
    columns: &[String],
    mut look: impl FnMut(&[String]),
) -> Result<(), ForeignError> {
    let mut reader = reader(path, text, form)?;
    let headers = reader.headers().map_err(|error| broken(path, &error))?;
    let there: Vec<String> = headers.iter().map(str::to_owned).collect();
    let Some(places) = places(&there, columns) else { return Ok(()) };
    let mut record = csv::StringRecord::new();
    let mut row = vec![String::new(); places.len()];
    while reader.read_record(&mut record).map_err(|error| broken(path, &error))? {
        for (cell, place) in row.iter_mut().zip(&places) {
            cell.clear();
            cell.push_str(record.get(*place).unwrap_or_default());
        }
        look(&row);
    }
    Ok(())
}
