//! Blocks of a complete campaign put in their places: whole, or those rows and columns of them that are kept.

use rayon::prelude::*;
use std::{path::PathBuf, sync::atomic::AtomicBool};

use super::{
    Folder, FolderError, Problem,
    area::Area,
    blocks::Blocks,
    hidden::Hidden,
    manifest::{Block, MANIFEST, Manifest, damaged},
    name::Name,
    shared::Shared,
    told::published,
};
use crate::{
    hash::sha256, identity::Identity, kept::Kept, requirement::Counting, runs_error,
    stop::is_stopped, table::Table,
};

/// A complete campaign of which not all rows and columns were kept: nobody can go on with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reduced {
    pub(super) kept: Kept,
    pub(super) place: PathBuf,
    pub(super) blocks: Vec<Block>,
}

impl Folder<'_> {
    /// Puts the blocks that are not in their places there with the rest of the draft, and tells of all of them, and how verdicts count
    /// their runs. `empty` is a table of each model, by which its runs are read if not all of their rows and columns are kept.
    ///
    /// # Errors
    /// They cannot be read, linked or written, or `stop` is true: see [`FolderError::is_stopped`].
    pub fn adopt(
        &mut self,
        blocks: &Blocks,
        empty: &[Table],
        (kept, counting): (&Kept, Counting),
        threads: &rayon::ThreadPool,
        stop: Option<&AtomicBool>,
    ) -> Result<(), FolderError> {
        let adopted = if kept.is_all() {
            self.adopt_whole(blocks, stop)
        } else {
            self.adopt_reduced(blocks, empty, kept, threads, stop)
        };
        let adopted = adopted.map_err(|problem| self.failed(problem))?;
        let columns = empty.first().map(|table| kept.kept_columns(table)).unwrap_or_default();
        let manifest = Manifest::new(&blocks.identity, (kept, counting), columns, adopted);
        let text =
            serde_json::to_string_pretty(&manifest).map_err(|error| self.failed(error.into()))?;
        self.write(MANIFEST, &(text + "\n"))
    }

    fn adopt_whole(
        &mut self,
        blocks: &Blocks,
        stop: Option<&AtomicBool>,
    ) -> Result<Vec<Block>, Problem> {
        let all = blocks.all();
        for block in all.iter().filter(|block| !block.published) {
            go_on(stop)?;
            let name = Name::new(&block.name())?;
            self.journal.link(&self.hidden, name, &blocks.path(block), &block.sha256)?;
        }
        Ok(all)
    }

    fn adopt_reduced(
        &mut self,
        blocks: &Blocks,
        empty: &[Table],
        kept: &Kept,
        threads: &rayon::ThreadPool,
        stop: Option<&AtomicBool>,
    ) -> Result<Vec<Block>, Problem> {
        let mut all = blocks.all();
        // So many are in memory at the same time.
        for some in all.chunks_mut(threads.current_num_threads()) {
            go_on(stop)?;
            let content = |block: &Block| match empty.iter().find(|t| t.model() == block.model()) {
                None => Ok(None),
                Some(empty) => {
                    let table = empty.read_block(&blocks.path(block));
                    table.and_then(|table| table.kept_parquet(kept)).map_err(|error| {
                        Problem::Block { name: block.name(), problem: runs_error::said(&error) }
                    })
                }
            };
            let contents = threads
                .install(|| some.par_iter().map(content).collect::<Result<Vec<_>, Problem>>())?;
            for (block, content) in some.iter_mut().zip(contents) {
                let content = content.unwrap_or_default();
                (block.bytes, block.sha256) = (content.len() as u64, String::new());
                if block.has_file() {
                    block.sha256 = sha256(&content);
                    let name = Name::new(&block.name())?;
                    self.journal.write(&self.hidden, name, &content)?;
                }
            }
        }
        Ok(all)
    }

    /// The complete campaign of an identity that is in the folder, if not all of its rows and columns were kept.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn reduced(&self, identity: &Identity) -> Result<Option<Reduced>, FolderError> {
        let reduced = Reduced::find((&self.hidden, self.contents.what), identity);
        reduced.map_err(|problem| self.failed(problem))
    }
}

impl Shared {
    /// As [`Folder::reduced`].
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn reduced(&self, identity: &Identity) -> Result<Option<Reduced>, FolderError> {
        let reduced = Reduced::find((&self.hidden, self.what), identity);
        reduced.map_err(|problem| FolderError { path: self.place.clone(), problem })
    }
}

impl Reduced {
    fn find((hidden, what): (&Hidden, &str), identity: &Identity) -> Result<Option<Self>, Problem> {
        let place = hidden.place().to_owned();
        let (kept, blocks) = published(&place, &hidden.record(what)?.0, identity)?;
        Ok((!kept.is_all()).then_some(Self { kept, place, blocks }))
    }

    /// Removes the runs that a command left of this campaign, with this identity, which was killed after it had put in place what is
    /// kept of them.
    ///
    /// # Errors
    /// They cannot be removed.
    pub fn settle(&self, identity: &Identity) -> Result<(), FolderError> {
        let area = Area::of(&self.place);
        let settled = match area.identity() {
            Ok(Some(there)) if identity.difference(&there).is_none() => {
                area.clear().map_err(Problem::from)
            }
            Ok(_) => Ok(()),
            Err(problem) => Err(problem),
        };
        settled.map_err(|problem| FolderError { path: self.place.clone(), problem })
    }

    /// What was kept.
    #[must_use]
    pub fn kept(&self) -> &Kept {
        &self.kept
    }

    /// Runs of each model.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.blocks.iter().map(|block| block.range().end).max().unwrap_or(0)
    }

    /// The files of what was kept that are not as they were written; to be called in the threads that are to look.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn damaged(&self) -> Result<Vec<String>, FolderError> {
        damaged(&self.place, &self.blocks)
            .map_err(|e| FolderError { path: self.place.clone(), problem: e.into() })
    }
}

/// Whether it goes on, or was told to stop.
fn go_on(stop: Option<&AtomicBool>) -> Result<(), Problem> {
    if is_stopped(stop) { Err(Problem::Stopped) } else { Ok(()) }
}
