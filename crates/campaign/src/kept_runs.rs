//! What a complete campaign kept of the runs of a model, read from its folder, column by column.

use parquet::{
    column::reader::ColumnReader,
    data_type::ByteArray,
    errors::ParquetError,
    file::reader::{FileReader, SerializedFileReader},
};
use std::{collections::HashMap, fs::File, path::Path};

use crate::{
    column::ColumnSummary,
    folder::Manifest,
    stored::{of_no_run_table, open, read},
};

/// What a complete campaign kept of the runs of a model, column by column, in run order.
///
/// There are the columns that were [kept](crate::Kept), in the order of the run table, `model`, `run` and `status` first; none if no row
/// was kept.
#[derive(Clone, Debug)]
pub struct KeptRuns {
    model: String,
    len: usize,
    columns: Vec<KeptColumn>,
}

/// A column of what was kept, with its unit and its meaning.
#[derive(Clone, Debug)]
pub struct KeptColumn {
    said: ColumnSummary,
    values: KeptValues,
}

/// What stands in a column, run by run.
#[derive(Clone, Debug)]
pub enum KeptValues {
    /// Numbers, bit for bit; NaN where a run has none.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Integers(Vec<Option<i64>>),
    /// Texts.
    Texts(KeptTexts),
    /// Yes or no.
    Flags(Vec<Option<bool>>),
}

/// Texts of runs, each of them kept once.
#[derive(Clone, Debug, Default)]
pub struct KeptTexts {
    distinct: Vec<String>,
    of_run: Vec<Option<u32>>,
    places: HashMap<Box<[u8]>, u32>,
}

impl KeptRuns {
    /// Reads what the complete campaign in a folder kept of the runs of a model.
    ///
    /// # Errors
    /// There is no complete campaign, or what it tells, or a table of it, cannot be read.
    pub fn read(folder: &Path, model: &str) -> Result<Self, ParquetError> {
        let manifest =
            Manifest::read(folder).map_err(|error| ParquetError::External(error.into()))?;
        let mut runs = Self { model: model.to_owned(), len: 0, columns: Vec::new() };
        for block in manifest.blocks_of(model).into_iter().filter(|block| block.has_file()) {
            runs.append(&open(&folder.join(block.name()))?, manifest.columns())?;
        }
        Ok(runs)
    }

    /// Appends the runs of a table, which has the same columns as those before.
    fn append(
        &mut self,
        table: &SerializedFileReader<File>,
        said: &[ColumnSummary],
    ) -> Result<(), ParquetError> {
        let wrong = |problem: String| ParquetError::General(problem);
        let schema = table.metadata().file_metadata().schema_descr_ptr();
        for group in 0..table.num_row_groups() {
            let group = table.get_row_group(group)?;
            let rows = usize::try_from(group.metadata().num_rows())
                .map_err(|_| wrong("a row group of no size".to_owned()))?;
            for (place, column) in schema.columns().iter().enumerate() {
                let (name, reader) = (column.name(), group.get_column_reader(place)?);
                if self.columns.len() == place {
                    let said = said.iter().find(|said| said.column == name);
                    let said = said.ok_or_else(|| wrong(format!("an unknown column {name:?}")))?;
                    self.columns
                        .push(KeptColumn { said: said.clone(), values: KeptValues::of(&reader)? });
                }
                let own = self.columns.get_mut(place).filter(|own| own.said.column == name);
                let own = own.ok_or_else(|| wrong("other columns than before".to_owned()))?;
                own.values.append(reader, rows)?;
            }
            self.len += rows;
        }
        Ok(())
    }

    /// Name of the model.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// How many runs were kept.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether no run was kept.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The columns.
    #[must_use]
    pub fn columns(&self) -> &[KeptColumn] {
        &self.columns
    }

    /// The columns, each to be taken.
    #[must_use]
    pub fn into_columns(self) -> Vec<KeptColumn> {
        self.columns
    }
}

impl KeptColumn {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.said.column
    }

    /// Its unit, of numbers that have one.
    #[must_use]
    pub fn unit(&self) -> Option<&str> {
        self.said.unit.as_deref()
    }

    /// What it means, in a sentence.
    #[must_use]
    pub fn meaning(&self) -> &str {
        &self.said.meaning
    }

    /// What stands in it.
    #[must_use]
    pub fn values(&self) -> &KeptValues {
        &self.values
    }

    /// What stands in it, to be taken.
    #[must_use]
    pub fn into_values(self) -> KeptValues {
        self.values
    }
}

impl KeptValues {
    /// Nothing yet, of the type of a column that was written.
    fn of(reader: &ColumnReader) -> Result<Self, ParquetError> {
        Ok(match reader {
            ColumnReader::DoubleColumnReader(_) => Self::Numbers(Vec::new()),
            ColumnReader::Int64ColumnReader(_) => Self::Integers(Vec::new()),
            ColumnReader::ByteArrayColumnReader(_) => Self::Texts(KeptTexts::default()),
            ColumnReader::BoolColumnReader(_) => Self::Flags(Vec::new()),
            _ => return Err(of_no_run_table()),
        })
    }

    fn append(&mut self, reader: ColumnReader, rows: usize) -> Result<(), ParquetError> {
        match (self, reader) {
            (Self::Numbers(numbers), ColumnReader::DoubleColumnReader(reader)) => {
                numbers.extend(read(reader, rows)?.into_iter().map(|x| x.unwrap_or(f64::NAN)));
            }
            (Self::Integers(integers), ColumnReader::Int64ColumnReader(reader)) => {
                integers.extend(read(reader, rows)?);
            }
            (Self::Texts(texts), ColumnReader::ByteArrayColumnReader(reader)) => {
                read(reader, rows)?.into_iter().for_each(|text| texts.push(text));
            }
            (Self::Flags(flags), ColumnReader::BoolColumnReader(reader)) => {
                flags.extend(read(reader, rows)?);
            }
            (Self::Numbers(_) | Self::Integers(_) | Self::Texts(_) | Self::Flags(_), _) => {
                return Err(of_no_run_table());
            }
        }
        Ok(())
    }
}

impl KeptTexts {
    fn push(&mut self, text: Option<ByteArray>) {
        let place = text.map(|text| {
            if let Some(place) = self.places.get(text.data()) {
                return *place;
            }
            let place = self.distinct.len() as u32;
            self.distinct.push(String::from_utf8_lossy(text.data()).into_owned());
            self.places.insert(text.data().into(), place);
            place
        });
        self.of_run.push(place);
    }

    /// The texts that there are, each once, in the order in which runs first have them.
    #[must_use]
    pub fn distinct(&self) -> &[String] {
        &self.distinct
    }

    /// Which of them each run has, by its place among them, if it has one.
    #[must_use]
    pub fn of_run(&self) -> &[Option<u32>] {
        &self.of_run
    }

    /// The text of each run, if it has one.
    pub fn texts(&self) -> impl ExactSizeIterator<Item = Option<&str>> {
        self.of_run.iter().map(|place| place.map(|place| self.distinct[place as usize].as_str()))
    }
}
