//! Which columns of a table may name its rows, so that a name such as `Mean` there tells a row that is no run.

use parquet::{errors::ParquetError, file::reader::FileReader};
use std::path::Path;

use super::{
    ForeignError, ForeignTable, Form,
    models::Models,
    of_csv::reader,
    of_parquet::{cells, index_of_pandas, open, unread},
    parquet_cells::{Cells, has_numbers},
    place_of,
    written::number,
};
use crate::column::Column;

/// What stands in a column.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    has_number: bool,
    /// A text that begins with a letter, as dates do not.
    has_name: bool,
}

impl Seen {
    fn add(&mut self, cell: &str) {
        match number(cell) {
            Some(number) => self.has_number |= number.is_some(),
            None => self.has_name |= cell.starts_with(char::is_alphabetic),
        }
    }
}

impl ForeignTable {
    /// The places of the columns that may name rows: the index of pandas, which stands before all others where pandas writes CSV and behind them in
    /// its Parquet files; without one, the first column; and, in a table without a column `run`, all others up to the first that has names and no
    /// numbers. Rows and files may be in any order.
    pub(super) fn labels(&self) -> Result<Vec<usize>, ForeignError> {
        let index = self.index()?;
        let others = (0..self.columns.len()).filter(|place| !index.contains(place));
        let mut places: Vec<usize> = index.iter().copied().chain(others).collect();
        let [_, run, _] = Column::first();
        let first = index.len().max(1);
        if place_of(&self.columns, &run).is_some() {
            places.truncate(first);
            // Models have any names.
            places.retain(|place| Models::place(&self.columns) != Some(*place));
            return Ok(places);
        }
        let seen = self.seen()?;
        let of_names = |place: &usize| seen[*place].has_name && !seen[*place].has_number;
        if let Some(last) = places.iter().position(of_names) {
            places.truncate(first.max(last + 1));
        }
        Ok(places)
    }

    /// The columns of the index of pandas in any of the files.
    fn index(&self) -> Result<Vec<usize>, ForeignError> {
        let mut index = Vec::new();
        if let Form::Parquet = self.form {
            for path in &self.files {
                let file = open(path).map_err(|error| unread(path, &error))?;
                index.extend(index_of_pandas(&file));
            }
        }
        let places = 0..self.columns.len();
        Ok(places.filter(|place| index.contains(&self.columns[*place])).collect())
    }

    /// What stands in each column.
    fn seen(&self) -> Result<Vec<Seen>, ForeignError> {
        let mut seen = vec![Seen::default(); self.columns.len()];
        match &self.form {
            Form::Csv { separator, text } => {
                for path in &self.files {
                    let mut reader = reader(path, text, (*separator, self.columns.len()))?;
                    let mut row = csv::StringRecord::new();
                    // What cannot be read is told of where the numbers are.
                    while matches!(reader.read_record(&mut row), Ok(true)) {
                        for (seen, cell) in seen.iter_mut().zip(&row) {
                            if !seen.has_number {
                                seen.add(cell);
                            }
                        }
                        // Most tables hold numbers alone, which the first row tells.
                        if seen.iter().all(|seen| seen.has_number) {
                            return Ok(seen);
                        }
                    }
                }
            }
            Form::Parquet => {
                // A column of names has no type in a file in which all of its cells are empty.
                let mut of_texts = vec![false; self.columns.len()];
                for path in &self.files {
                    let file = open(path).map_err(|error| unread(path, &error))?;
                    let columns = file.metadata().file_metadata().schema_descr().columns();
                    for (of_texts, column) in of_texts.iter_mut().zip(columns) {
                        *of_texts |= column.max_rep_level() == 0 && !has_numbers(column);
                    }
                }
                for path in &self.files {
                    look_parquet(path, &of_texts, &mut seen)?;
                }
            }
        }
        Ok(seen)
    }
}

fn look_parquet(path: &Path, of_texts: &[bool], seen: &mut [Seen]) -> Result<(), ForeignError> {
    let failed = |error: ParquetError| unread(path, &error);
    let file = open(path).map_err(failed)?;
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group).map_err(failed)?;
        for (place, seen) in seen.iter_mut().enumerate() {
            if !of_texts[place] || seen.has_number {
                continue;
            }
            match cells(path, &*group, place)? {
                Cells::Numbers(cells) => {
                    seen.has_number |= cells.iter().flatten().any(|number| !number.is_nan());
                }
                Cells::Texts(cells) => cells.iter().flatten().for_each(|cell| seen.add(cell)),
            }
        }
    }
    Ok(())
}
