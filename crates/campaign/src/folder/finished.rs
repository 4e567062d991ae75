//! Finished runs of a campaign, one of which is to be done again: where what was kept of them is.

use std::path::{Path, PathBuf};

use super::{Blocks, Reduced, manifest::Block};
use crate::{cell::Cell, kept::Kept, runs_error::RunsError, stored::first_run};

/// Where finished runs of a campaign are, or what was kept of them.
#[derive(Clone, Debug)]
pub struct FinishedRuns {
    /// Model and file, in the order of their runs.
    files: Vec<(String, PathBuf)>,
    /// Whether runs that failed count, where no other is there: nobody can do them again in their place.
    failures_stay: bool,
}

/// What was kept of a finished run.
#[derive(Debug)]
pub(crate) struct FinishedRun {
    pub(crate) model: String,
    pub(crate) run: u64,
    /// What stands in each column, by its name.
    pub(crate) cells: Vec<(String, Cell<'static>)>,
}

impl Blocks {
    /// Its finished runs.
    #[must_use]
    pub fn finished_runs(&self) -> FinishedRuns {
        FinishedRuns::of(self.all(), |block| self.path(block), false)
    }
}

impl Reduced {
    /// What was kept of its runs.
    #[must_use]
    pub fn finished_runs(&self) -> FinishedRuns {
        FinishedRuns::in_place(&self.place, &self.blocks, &self.kept)
    }
}

impl FinishedRuns {
    /// Those of blocks that are in their places, of which so much was kept.
    #[must_use]
    pub fn in_place(place: &Path, blocks: &[Block], kept: &Kept) -> Self {
        let blocks = blocks.iter().filter(|block| block.has_file()).cloned().collect();
        Self::of(blocks, |block| place.join(block.name()), !kept.is_all())
    }

    fn of(mut blocks: Vec<Block>, path: impl Fn(&Block) -> PathBuf, failures_stay: bool) -> Self {
        blocks.sort_by_key(|block| block.range().start);
        let files = blocks.iter().map(|block| (block.model().to_owned(), path(block)));
        Self { files: files.collect(), failures_stay }
    }

    /// The first run that did not fail, of the first of these models that has one; failing that, where failures stay, the first that
    /// failed.
    ///
    /// # Errors
    /// A file cannot be read.
    pub(crate) fn first(&self, models: &[&str]) -> Result<Option<FinishedRun>, RunsError> {
        for may_fail in [false, true].into_iter().filter(|may_fail| !may_fail || self.failures_stay)
        {
            for model in models {
                for (_, path) in self.files.iter().filter(|(own, _)| own == model) {
                    if let Some((run, cells)) = first_run(path, model, may_fail)? {
                        return Ok(Some(FinishedRun { model: (*model).to_owned(), run, cells }));
                    }
                }
            }
        }
        Ok(None)
    }
}
