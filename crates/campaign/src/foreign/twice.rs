//! Runs that stand twice in a table, where its columns `model` and `run` say which run a row is.

use parquet::{
    basic::Type as Physical, column::reader::ColumnReader, errors::ParquetError,
    file::reader::FileReader,
};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use super::{
    ForeignError, ForeignTable, Form,
    of_csv::{CsvText, broken, number, reader},
    of_parquet::{names, numbers, open, unread, unread_codec},
    places,
};
use crate::{column::Column, spans::Spans, stored::read};

/// A run that has two rows.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{} the run {run} of the model {model:?}: a run counts once. Take away the copy, or, if these are different runs, such as those \
     of another seed, give each a number of its own in the column \"run\", or leave the column out",
    told(files)
)]
pub struct TwiceError {
    model: String,
    run: u64,
    /// Where the two rows are; the same file twice if they are in one.
    files: [PathBuf; 2],
}

fn told([one, other]: &[PathBuf; 2]) -> String {
    if one == other {
        return format!("{}: two rows are of", one.display());
    }
    format!("{} and {} both have", one.display(), other.display())
}

impl ForeignTable {
    /// The first run that has two rows, if any has; none in a table that does not say by the columns `model` and `run` which run a row is. A row
    /// of which they do not say it is none of them.
    ///
    /// # Errors
    /// A file cannot be read.
    pub(crate) fn twice(&self) -> Result<Option<TwiceError>, ForeignError> {
        let [model, run, _] = Column::first();
        let own = [model, run].map(|column| column.name().to_owned());
        let mut seen: BTreeMap<String, Spans> = BTreeMap::new();
        let mut twice = None;
        for (file, path) in self.files.iter().enumerate() {
            let look = |model: &str, number: Option<f64>| {
                let run = number.and_then(Column::run_named);
                let Some(run) = run.filter(|_| !model.trim().is_empty()) else { return };
                if !seen.contains_key(model) {
                    seen.insert(model.to_owned(), Spans::default());
                }
                if let Some(Err(there)) = seen.get_mut(model).map(|seen| seen.add(run, file))
                    && twice.is_none()
                {
                    let files = [self.files[there].clone(), path.clone()];
                    twice = Some(TwiceError { model: model.to_owned(), run, files });
                }
            };
            match &self.form {
                Form::Parquet => look_parquet(path, &own, look)?,
                Form::Csv { separator, text } => {
                    let form = (*separator, self.columns.len());
                    look_csv(path, text, form, &own, look)?;
                }
            }
            if twice.is_some() {
                return Ok(twice);
            }
        }
        Ok(None)
    }
}

fn look_parquet(
    path: &Path,
    own: &[String],
    mut look: impl FnMut(&str, Option<f64>),
) -> Result<(), ForeignError> {
    let failed = |error: ParquetError| unread(path, &error);
    let file = open(path).map_err(failed)?;
    let Ok(places) = places(path, &names(&file), own.iter()) else { return Ok(()) };
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    let types = [places[0], places[1]].map(|place| schema.column(place).physical_type());
    let is_number =
        matches!(types[1], Physical::INT32 | Physical::INT64 | Physical::FLOAT | Physical::DOUBLE);
    let is_flat = places.iter().all(|place| schema.column(*place).max_rep_level() == 0);
    if types[0] != Physical::BYTE_ARRAY || !is_number || !is_flat {
        return Ok(());
    }
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group).map_err(failed)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        let codec = |place: &usize| unread_codec(group.metadata().column(*place).compression());
        if places.iter().any(|place| codec(place).is_some()) {
            return Ok(());
        }
        let models = group.get_column_reader(places[0]).map_err(failed)?;
        let ColumnReader::ByteArrayColumnReader(models) = models else { return Ok(()) };
        let models = read(models, rows).map_err(failed)?;
        let runs = group.get_column_reader(places[1]).map_err(failed)?;
        let runs = numbers(runs, rows, false).map_err(failed)?;
        for (model, run) in models.iter().zip(runs) {
            let model = model.as_ref().and_then(|text| text.as_utf8().ok());
            look(model.unwrap_or_default(), run);
        }
    }
    Ok(())
}

fn look_csv(
    path: &Path,
    text: &CsvText,
    form: (u8, usize),
    own: &[String],
    mut look: impl FnMut(&str, Option<f64>),
) -> Result<(), ForeignError> {
    let mut reader = reader(path, text, form)?;
    let headers = reader.headers().map_err(|error| broken(path, &error))?;
    let there: Vec<String> = headers.iter().map(str::to_owned).collect();
    let Ok(places) = places(path, &there, own.iter()) else { return Ok(()) };
    let mut row = csv::StringRecord::new();
    while reader.read_record(&mut row).map_err(|error| broken(path, &error))? {
        let cell = |place: usize| row.get(places[place]).unwrap_or_default();
        look(cell(0), number(cell(1)).flatten());
    }
    Ok(())
}
