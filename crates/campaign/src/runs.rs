//! The runs of a model, in blocks.

use rayon::prelude::*;

use crate::{column::Column, table::Table};

/// The runs of a model, in blocks of consecutive runs.
#[derive(Clone, Debug)]
pub struct Runs {
    blocks: Vec<Table>,
    empty: Table,
}

impl Runs {
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
        self.blocks.iter().map(|block| block.first() + block.len() as u64).max().unwrap_or(0)
    }

    /// All runs in one table.
    ///
    /// # Errors
    /// A block cannot be read.
    pub fn table(&self) -> Result<Table, RunsError> {
        let mut whole = self.empty.clone();
        self.blocks.iter().for_each(|block| whole.append(block.clone()));
        Ok(whole)
    }

    /// Looks at every block once, on all threads of the pool that this is called in, in any order.
    ///
    /// # Errors
    /// A block cannot be read.
    pub fn scan(&self, look: impl Fn(&Table) + Sync) -> Result<(), RunsError> {
        self.blocks.par_iter().for_each(|block| look(block));
        Ok(())
    }
}

/// A table as the one block.
impl From<Table> for Runs {
    fn from(table: Table) -> Self {
        Self { empty: table.from_run(0), blocks: vec![table] }
    }
}

/// Why blocks cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RunsError {}
