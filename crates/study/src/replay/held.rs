//! Holding the row of a run that was done again against that of the study, bit by bit.

use gyradius_campaign::{
    Block, Cell, Column, FolderError, Identity, Kept, MANIFEST, Manifest, Row, Rows, RunsError,
    Table, read_run, replacing,
};
use parquet::errors::ParquetError;
use std::{
    collections::BTreeSet,
    fmt, fs, io,
    path::{Path, PathBuf},
};

use super::error::ReplayError;
use crate::ResultsError;

/// Of a folder that tells of no runs.
const NO_RUNS: &str = "there is no such file, which tells of the run tables of a study that is put together, nor a folder \
                       .gyradius/campaign beside it, which has the runs of one that is not: the row of the study is not \
                       there to hold the run against";

/// What a run that was done again was held against.
#[derive(Clone, Debug)]
pub(crate) enum Held {
    /// Nothing: there is no study.
    Nowhere,
    /// Nothing: the study has not done the run, of which shards may be missing.
    NotDone,
    /// Nothing: the study did not keep the row.
    NotKept,
    /// What was kept of the row in a table: all of its columns, or some.
    To { table: PathBuf, whole: bool },
}

impl Held {
    /// Holds the one row of a table against that of the same model and run in the folder of a study. `causes` says what may
    /// have happened where they differ.
    ///
    /// # Errors
    /// What the study tells of its tables cannot be read, nor the table, or the table says otherwise.
    pub(crate) fn against(
        folder: &Path,
        own: &Table,
        causes: &'static str,
    ) -> Result<Self, ReplayError> {
        let manifest = Manifest::read(folder);
        let (model, run) = (own.model(), own.first());
        // Until a study is put together, its blocks are elsewhere, also those that take the place of blocks that failed.
        let begun = || {
            let goes_on = Identity::begun(folder)?.is_some() && replacing(folder)?.is_none();
            Ok((goes_on, if goes_on { Block::begun(folder, model, run)? } else { None }))
        };
        let (goes_on, begun) = begun().map_err(|error: FolderError| ResultsError::from(error))?;
        if let Some((block, path)) = begun
            && let done = manifest.as_ref().ok().and_then(|all| all.find(model, run))
            && done.is_none_or(|done| done.again() < block.again())
        {
            Comparison { own, path: &path, causes }.compare_row(&Kept::default())?;
            return Ok(Self::To { table: path, whole: true });
        }
        let manifest = match manifest {
            Ok(manifest) => manifest,
            Err(_) if goes_on => return Ok(Self::NotDone),
            Err(error) => {
                let problem = match error.kind() {
                    io::ErrorKind::NotFound => NO_RUNS.to_owned(),
                    _ => error.to_string(),
                };
                return Err(ReplayError::Manifest { path: folder.join(MANIFEST), problem });
            }
        };
        let Some(block) = manifest.find(model, run) else { return Ok(Self::NotDone) };
        let kept = manifest.kept();
        let path = folder.join(block.name());
        let comparison = Comparison { own, path: &path, causes };
        let is_the_same = match kept.rows() {
            Rows::None => false,
            Rows::All => comparison.compare_row(kept).map(|()| true)?,
            Rows::Failed => {
                // Without failures among its runs, the block has no file.
                let found = if block.has_file() { comparison.found()? } else { None };
                match (found, own.failures().next()) {
                    (Some(found), _) => comparison.compare(kept, found).map(|()| true)?,
                    (None, None) => false,
                    (None, Some((_, failure))) => {
                        let found = "not kept, for the run did not fail".to_owned();
                        return Err(comparison.differs("the row", found, failure.to_string()));
                    }
                }
            }
        };
        let whole = kept.kept_columns(own).len() == own.columns().len();
        Ok(if is_the_same { Self::To { table: path, whole } } else { Self::NotKept })
    }
}

impl fmt::Display for Held {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::To { table, whole } => {
                let columns = if *whole { "" } else { " in the columns that were kept," };
                write!(f, "the same, bit for bit,{columns} as in {}", table.display())
            }
            Self::NotDone => f.write_str(
                "the study has not done this run yet: there is nothing to hold it against",
            ),
            Self::NotKept => f.write_str(
                "the study did not keep the row of this run: there is nothing to hold it against",
            ),
            Self::Nowhere => f.write_str("there is no run table to hold it against"),
        }
    }
}

/// The row of a run that was done again, and the table that has, or had, that of the study.
struct Comparison<'a> {
    own: &'a Table,
    path: &'a Path,
    causes: &'static str,
}

impl Comparison<'_> {
    /// What the table has of the run, if it has the run.
    fn found(&self) -> Result<Option<Vec<(String, Cell<'static>)>>, ReplayError> {
        if fs::symlink_metadata(self.path).is_ok_and(|found| !found.is_file()) {
            return Err(
                self.unreadable("it is a link, a pipe or a device, where the study wrote a file")
            );
        }
        let found = read_run(self.path, (self.own.model(), self.own.first()));
        found.map_err(|problem| ReplayError::Table { problem })
    }

    fn unreadable(&self, problem: &str) -> ReplayError {
        let (path, problem) = (self.path.to_owned(), ParquetError::General(problem.to_owned()));
        ReplayError::Table { problem: RunsError::Block { path, problem } }
    }

    fn differs(&self, column: &str, table: String, replayed: String) -> ReplayError {
        let (path, column) = (self.path.to_owned(), column.to_owned());
        ReplayError::Differs { path, column, table, replayed, causes: self.causes }
    }

    /// Compares what was kept of the row, which the table must have.
    fn compare_row(&self, kept: &Kept) -> Result<(), ReplayError> {
        match self.found()? {
            Some(found) => self.compare(kept, found),
            None => Err(self.unreadable("it has no such run")),
        }
    }

    /// Compares what was kept of the row, bit by bit.
    fn compare(&self, kept: &Kept, found: Vec<(String, Cell<'static>)>) -> Result<(), ReplayError> {
        let columns: BTreeSet<_> =
            kept.kept_columns(self.own).into_iter().map(Column::name).collect();
        if columns.len() != found.len() {
            let count = |n: usize| format!("{n} columns");
            let [found, own] = [found.len(), columns.len()].map(count);
            return Err(self.differs("the number of columns", found, own));
        }
        let row = self.own.rows().next();
        let own = row.iter().flat_map(Row::cells);
        let own = own.filter(|(column, _)| columns.contains(column.name()));
        for ((column, own), (name, cell)) in own.zip(found) {
            if column.name() != name {
                let own = column.name().to_owned();
                return Err(self.differs("the name of a column", name, own));
            }
            if own != cell {
                return Err(self.differs(&name, cell.to_string(), own.to_string()));
            }
        }
        Ok(())
    }
}
