//! Runs that stand twice in a table, where its columns `model` and `run` say which run a row is.

use parquet::{errors::ParquetError, file::reader::FileReader};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use super::{
    ForeignError, ForeignTable, Form,
    of_csv::{CsvText, broken, reader},
    of_parquet::{cells, names, open, unread},
    only_place,
    written::number,
};
use crate::{column::Column, spans::Spans};

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
        let mut seen: BTreeMap<String, Spans> = BTreeMap::new();
        let mut twice = None;
        for (file, path) in self.files.iter().enumerate() {
            let look = |model: &str, run: Option<f64>| {
                let run = run.and_then(Column::run_named);
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
                Form::Parquet => look_parquet(path, look)?,
                Form::Csv { separator, text } => {
                    let form = (*separator, self.columns.len());
                    look_csv(path, text, form, look)?;
                }
            }
            if twice.is_some() {
                return Ok(twice);
            }
        }
        Ok(None)
    }
}

/// Where a table says which run a row is, by the columns `model` and `run`, each of which it has once.
fn own_places(columns: &[String]) -> Option<[usize; 2]> {
    let [model, run, _] = Column::first();
    Some([only_place(columns, &model)?, only_place(columns, &run)?])
}

fn look_parquet(path: &Path, mut look: impl FnMut(&str, Option<f64>)) -> Result<(), ForeignError> {
    let failed = |error: ParquetError| unread(path, &error);
    let file = open(path).map_err(failed)?;
    let names = names(&file);
    let Some(places) = own_places(&names) else { return Ok(()) };
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    if places.iter().any(|place| schema.column(*place).max_rep_level() > 0) {
        return Ok(());
    }
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group).map_err(failed)?;
        let cells = |place: usize| cells(path, &*group, place);
        let (models, runs) = (cells(places[0])?.texts(), cells(places[1])?.numbers());
        for (model, run) in models.iter().zip(runs) {
            look(model.as_deref().unwrap_or_default(), run);
        }
    }
    Ok(())
}

fn look_csv(
    path: &Path,
    text: &CsvText,
    form: (u8, usize),
    mut look: impl FnMut(&str, Option<f64>),
) -> Result<(), ForeignError> {
    let mut reader = reader(path, text, form)?;
    let headers = reader.headers().map_err(|error| broken(path, &error))?;
    let there: Vec<String> = headers.iter().map(str::to_owned).collect();
    let Some(places) = own_places(&there) else { return Ok(()) };
    let mut row = csv::StringRecord::new();
    while reader.read_record(&mut row).map_err(|error| broken(path, &error))? {
        let cell = |place: usize| row.get(places[place]).unwrap_or_default();
        look(cell(0), number(cell(1)).flatten());
    }
    Ok(())
}
