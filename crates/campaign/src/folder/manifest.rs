//! What a complete campaign tells of itself: what it is, its columns, its blocks.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::{io, ops::Range, path::Path};

use super::{
    disk,
    name::{Found, Name, look},
    refusal::Refusal,
};
use crate::{
    column::{Column, ColumnSummary},
    identity::Identity,
    kept::Kept,
    requirement::Counting,
};

/// The folder in which each model has a folder of run tables.
pub(crate) const RUNS: &str = "runs";
/// The file that tells of the blocks of a complete campaign.
pub const MANIFEST: &str = "campaign.json";

/// What the files of blocks that were written again are called besides.
pub(super) const AGAIN: &str = "again-";

/// A block that is finished.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Block {
    pub(super) model: String,
    pub(super) first_run: u64,
    pub(super) runs: u64,
    /// How many of them failed.
    #[serde(default)]
    pub(super) failed: u64,
    /// How many runs of it were done again because they had failed; the more, the later it was written.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(super) again: u64,
    /// Length of its file; 0 of a block of which no row is kept, which has none.
    pub(super) bytes: u64,
    pub(super) sha256: String,
    /// Whether it is in its place.
    #[serde(skip)]
    pub(super) published: bool,
}

/// What `campaign.json` tells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    gyradius_version: String,
    /// What the runs depend on.
    identity: Identity,
    /// What is kept of the run tables, if not everything is.
    #[serde(default, skip_serializing_if = "Kept::is_all")]
    kept: Kept,
    /// How verdicts count the runs.
    #[serde(flatten)]
    counting: Counting,
    columns: Vec<ColumnSummary>,
    blocks: Vec<ManifestBlock>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ManifestBlock {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(flatten)]
    block: Block,
}

impl Block {
    /// Of some runs, before it is written.
    pub(super) fn of(model: &str, runs: &Range<u64>) -> Self {
        Self {
            model: model.to_owned(),
            first_run: runs.start,
            runs: runs.end - runs.start,
            failed: 0,
            again: 0,
            bytes: 0,
            sha256: String::new(),
            published: false,
        }
    }

    /// The model whose runs they are.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// Whether it is in its place in the folder of a complete campaign.
    #[must_use]
    pub fn is_in_place(&self) -> bool {
        self.published
    }

    /// How many of the runs failed.
    #[must_use]
    pub fn failed(&self) -> u64 {
        self.failed
    }

    /// How many runs were done again because they had failed, as often as that was.
    #[must_use]
    pub fn again(&self) -> u64 {
        self.again
    }

    /// The runs.
    #[must_use]
    pub fn range(&self) -> Range<u64> {
        self.first_run..self.first_run + self.runs
    }

    /// Whether a record that nobody has meddled with can tell of it.
    pub(super) fn is_sound(&self) -> bool {
        let end = self.first_run.checked_add(self.runs);
        let name = |end| format!("{RUNS}/{}/{:09}-{end:09}.parquet", self.model, self.first_run);
        self.runs > 0 && end.is_some_and(|end| Name::new(&name(end)).is_ok())
    }

    /// Its file: the first run and the last one.
    pub(super) fn file(&self) -> String {
        format!("{:09}-{:09}.parquet", self.first_run, self.range().end - 1)
    }

    /// Its file until it is in its place, beside those of which it takes the place.
    pub(super) fn file_before(&self) -> String {
        let file = self.file();
        match (self.again, file.split_once('.')) {
            (0, _) | (_, None) => file,
            (again, Some((runs, extension))) => format!("{runs}.{AGAIN}{again}.{extension}"),
        }
    }

    /// Its file in the folder of a complete campaign, from the folder on, if rows of it are kept.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{RUNS}/{}/{}", self.model, self.file())
    }

    /// Whether there is a file of it.
    #[must_use]
    pub fn has_file(&self) -> bool {
        self.bytes > 0
    }
}

impl Manifest {
    /// Of a campaign with these blocks, of which so much is kept, and whose runs are counted so.
    pub(super) fn new<'c>(
        identity: &Identity,
        (kept, counting): (&Kept, Counting),
        columns: impl IntoIterator<Item = &'c Column>,
        blocks: Vec<Block>,
    ) -> Self {
        let block =
            |block: Block| ManifestBlock { file: block.has_file().then(|| block.name()), block };
        Self {
            gyradius_version: env!("CARGO_PKG_VERSION").to_owned(),
            identity: identity.clone(),
            kept: kept.clone(),
            counting,
            columns: columns.into_iter().map(Column::summary).collect(),
            blocks: blocks.into_iter().map(block).collect(),
        }
    }

    /// The blocks, which are in their places.
    pub(super) fn into_blocks(self) -> impl Iterator<Item = Block> {
        self.blocks.into_iter().map(|entry| Block { published: true, ..entry.block })
    }

    /// Reads that of the campaign in a folder.
    ///
    /// # Errors
    /// There is none, or it is none.
    pub fn read(folder: &Path) -> io::Result<Self> {
        Ok(serde_json::from_slice(&disk::read(&folder.join(MANIFEST))?)?)
    }

    /// The block that has a run of a model.
    #[must_use]
    pub fn find(&self, model: &str, run: u64) -> Option<&Block> {
        let mut blocks = self.blocks.iter().map(|entry| &entry.block);
        blocks.find(|block| block.model == model && block.range().contains(&run))
    }

    /// The blocks of the runs of a model, in the order of their runs.
    #[must_use]
    pub fn blocks_of(&self, model: &str) -> Vec<&Block> {
        let all = self.blocks.iter().map(|entry| &entry.block);
        let mut own: Vec<&Block> = all.filter(|block| block.model == model).collect();
        own.sort_by_key(|block| block.first_run);
        own
    }

    /// The columns of the run tables, those that are not kept too.
    #[must_use]
    pub fn columns(&self) -> &[ColumnSummary] {
        &self.columns
    }

    /// What is kept of the run tables.
    #[must_use]
    pub fn kept(&self) -> &Kept {
        &self.kept
    }

    /// How verdicts count the runs.
    #[must_use]
    pub fn counting(&self) -> Counting {
        self.counting
    }

    /// What the runs depend on.
    #[must_use]
    pub fn identity(&self) -> &Identity {
        &self.identity
    }
}

/// The files of blocks of a folder that are gone or not as they were written; to be called in the threads that are to look.
pub(crate) fn damaged(place: &Path, blocks: &[Block]) -> Result<Vec<String>, Refusal> {
    let with_file = blocks.par_iter().filter(|block| block.has_file());
    let damaged = with_file.map(|block| {
        let Ok(name) = Name::new(&block.name()) else { return Ok(Some(block.name())) };
        let whole = matches!(look(place, &name)?, Found::File { hash } if hash == block.sha256);
        Ok((!whole).then(|| block.name()))
    });
    Ok(damaged.collect::<Result<Vec<Option<String>>, _>>()?.into_iter().flatten().collect())
}

pub(crate) fn is_zero(count: &u64) -> bool {
    *count == 0
}
