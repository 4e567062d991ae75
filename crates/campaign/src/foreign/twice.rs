//! Runs that stand twice in a table, where its columns `model` and `run` say which run a row is.

use std::{collections::BTreeMap, path::PathBuf};

use super::{ForeignError, ForeignTable, only_place, run_names::RunNames};
use crate::column::Column;

/// A run that has two rows.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{} the run {run} of the model {model:?}: a run counts once. Take away the copy, or, if these are different runs, such as those \
     of another seed, give each a number of its own in the column \"run\", or leave the column out",
    told(files)
)]
pub struct TwiceError {
    model: String,
    run: String,
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
        let Some(places) = own_places(&self.columns) else { return Ok(None) };
        let names = places.map(|place| self.columns[place].clone());
        let mut seen: BTreeMap<String, RunNames> = BTreeMap::new();
        let mut twice = None;
        self.scan_texts(&names, |file, cells| {
            let [model, run] = cells else { return };
            let Some(run) = RunNames::of(run).filter(|_| !model.trim().is_empty()) else { return };
            if !seen.contains_key(model) {
                seen.insert(model.clone(), RunNames::default());
            }
            if let Some(Err(there)) = seen.get_mut(model).map(|seen| seen.add(&run, file))
                && twice.is_none()
            {
                let files = [there, file].map(|file| self.files[file].clone());
                twice = Some(TwiceError { model: model.clone(), run: run.into_owned(), files });
            }
        })?;
        Ok(twice)
    }
}

/// Where a table says which run a row is, by the columns `model` and `run`, each of which it has once.
fn own_places(columns: &[String]) -> Option<[usize; 2]> {
    let [model, run, _] = Column::first();
    Some([only_place(columns, &model)?, only_place(columns, &run)?])
}
