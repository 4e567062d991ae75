//! The runs of a model, in blocks.

use rayon::prelude::*;
use std::{
    collections::BTreeSet,
    ops::Range,
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

use crate::{column::Column, runs_error::RunsError, stop::is_stopped, table::Table};

/// The runs of a model, in blocks of consecutive runs, some in memory and some on the disk.
#[derive(Clone, Debug)]
pub struct Runs {
    empty: Table,
    blocks: Vec<Block>,
    /// Once it is true, nothing more is read.
    stop: Option<Arc<AtomicBool>>,
}

#[derive(Clone, Debug)]
enum Block {
    Held(Table),
    Stored { runs: Range<u64>, path: PathBuf },
}

impl Runs {
    /// Of the model and columns of an empty table, with the runs of some files; those of them that are held need not
    /// be read.
    pub(crate) fn new(empty: &Table, files: Vec<(Range<u64>, PathBuf)>, held: Vec<Table>) -> Self {
        let has = |runs: &Range<u64>| held.iter().any(|table| table.first() == runs.start);
        let stored = files.into_iter().filter(|(runs, _)| !has(runs));
        let mut blocks: Vec<Block> =
            stored.map(|(runs, path)| Block::Stored { runs, path }).collect();
        blocks.extend(held.into_iter().map(Block::Held));
        blocks.sort_by_key(|block| block.range().start);
        Self { empty: empty.from_run(0), blocks, stop: None }
    }

    /// The same, which are looked at no further once `stop` is true.
    #[must_use]
    pub fn stopped_by(self, stop: Option<Arc<AtomicBool>>) -> Self {
        Self { stop, ..self }
    }

    /// An empty table of the model, and the blocks that are in memory.
    pub(crate) fn into_parts(self) -> (Table, Vec<Table>) {
        let held = self.blocks.into_iter().filter_map(|block| match block {
            Block::Held(table) => Some(table),
            Block::Stored { .. } => None,
        });
        (self.empty, held.collect())
    }

    /// Name of the model.
    #[must_use]
    pub fn model(&self) -> &str {
        self.empty.model()
    }

    /// All columns, `model`, `run` and `status` first.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        self.empty.columns()
    }

    /// One more than the number of the last run.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.blocks.iter().map(|block| block.range().end).max().unwrap_or(0)
    }

    /// All runs in one table.
    ///
    /// # Errors
    /// A block cannot be read.
    pub fn table(&self) -> Result<Table, RunsError> {
        let mut whole = self.empty.from_run(self.blocks.first().map_or(0, |b| b.range().start));
        for block in &self.blocks {
            match block {
                Block::Held(table) => whole.append(table.clone()),
                Block::Stored { path, .. } => whole.append(self.read(path)?),
            }
        }
        Ok(whole)
    }

    /// Looks at every block once, on all threads of the pool that this is called in, in any order.
    ///
    /// # Errors
    /// A block cannot be read, or they are [stopped](Self::stopped_by).
    pub fn scan(&self, look: impl Fn(&Table) + Sync) -> Result<(), RunsError> {
        self.scan_blocks(|_| true, look)
    }

    /// The same of the blocks alone that have one of these runs.
    ///
    /// # Errors
    /// A block cannot be read, or they are [stopped](Self::stopped_by).
    pub fn scan_those_with(
        &self,
        runs: &BTreeSet<u64>,
        look: impl Fn(&Table) + Sync,
    ) -> Result<(), RunsError> {
        self.scan_blocks(|range| runs.range(range).next().is_some(), look)
    }

    fn scan_blocks(
        &self,
        which: impl Fn(Range<u64>) -> bool + Sync,
        look: impl Fn(&Table) + Sync,
    ) -> Result<(), RunsError> {
        self.blocks.par_iter().filter(|block| which(block.range())).try_for_each(|block| {
            self.go_on()?;
            match block {
                Block::Held(table) => look(table),
                Block::Stored { path, .. } => look(&self.read(path)?),
            }
            Ok(())
        })
    }

    /// Whether it goes on, or they are [stopped](Self::stopped_by).
    ///
    /// # Errors
    /// They are.
    pub fn go_on(&self) -> Result<(), RunsError> {
        if is_stopped(self.stop.as_deref()) { Err(RunsError::Stopped) } else { Ok(()) }
    }

    /// Looks at every block that has some of these runs, one after the other, in their order.
    ///
    /// # Errors
    /// A block cannot be read, or they are [stopped](Self::stopped_by).
    pub(crate) fn in_order(
        &self,
        some: Range<u64>,
        mut look: impl FnMut(&Table),
    ) -> Result<(), RunsError> {
        let has = |block: &&Block| {
            let runs = block.range();
            runs.start < some.end && some.start < runs.end
        };
        for block in self.blocks.iter().filter(has) {
            self.go_on()?;
            match block {
                Block::Held(table) => look(table),
                Block::Stored { path, .. } => look(&self.read(path)?),
            }
        }
        Ok(())
    }

    /// The block that begins with a run; none if there is none.
    pub(crate) fn block(&self, first: u64) -> Result<Option<Table>, RunsError> {
        let found = self.blocks.iter().find(|block| block.range().start == first);
        match found {
            None => Ok(None),
            Some(Block::Held(table)) => Ok(Some(table.clone())),
            Some(Block::Stored { path, .. }) => self.read(path).map(Some),
        }
    }

    fn read(&self, path: &Path) -> Result<Table, RunsError> {
        self.empty.read_parquet(path)
    }
}

impl Block {
    fn range(&self) -> Range<u64> {
        match self {
            Self::Held(table) => table.first()..table.first() + table.len() as u64,
            Self::Stored { runs, .. } => runs.clone(),
        }
    }
}

/// A table as the one block.
impl From<Table> for Runs {
    fn from(table: Table) -> Self {
        Self::new(&table.from_run(0), Vec::new(), vec![table])
    }
}
