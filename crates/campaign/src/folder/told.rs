//! What the files of a folder tell of a campaign, for those who only read: others may be at work there.

use std::{
    cmp::Reverse,
    fs,
    io::ErrorKind,
    iter,
    ops::Range,
    path::{Path, PathBuf},
};

use super::{
    Contents, FolderError, Problem,
    area::Area,
    hidden::Hidden,
    manifest::{Block, MANIFEST, Manifest},
    name::{Found, HIDDEN, Name, look},
    record::Record,
};
use crate::{
    identity::{Difference, Identity},
    kept::Kept,
    runs::Runs,
    table::Table,
};

/// The text from which the unfinished campaign in a folder was begun, if there is one.
#[must_use]
pub fn begun(place: &Path) -> Option<String> {
    let area = Area::of(place);
    area.identity().ok()??;
    area.mark()
}

/// What the unfinished campaign in a folder has otherwise than the complete one that it is to replace, and that is the one of the
/// folder until then, if there are two.
#[must_use]
pub fn replacing(place: &Path) -> Option<Difference> {
    let unfinished = Identity::begun(place)?;
    Manifest::read(place).ok()?.identity().difference(&unfinished)
}

impl Identity {
    /// That of the unfinished campaign in a folder, if there is one.
    #[must_use]
    pub fn begun(place: &Path) -> Option<Self> {
        Area::of(place).identity().ok()?
    }
}

impl Block {
    /// The finished block of the unfinished campaign in a folder that has a run of a model, the last that was done if some of
    /// its runs were done again, and its file, which has the length that it should.
    ///
    /// # Errors
    /// The records of the blocks cannot be read.
    pub fn begun(
        place: &Path,
        model: &str,
        run: u64,
    ) -> Result<Option<(Self, PathBuf)>, FolderError> {
        let area = Area::of(place);
        let recorded = area.recorded();
        let recorded =
            recorded.map_err(|problem| FolderError { path: place.to_owned(), problem })?;
        let own = |block: &Self| block.model == model && block.range().contains(&run);
        let files = recorded.into_iter().filter(own).map(|block| {
            let (root, name) = area.place_of(&block, place);
            let path = root.join(name);
            (block, path)
        });
        Ok(files.filter(|(block, path)| is_whole(path, block)).max_by_key(|(block, _)| block.again))
    }
}

/// Whether a file is there with the length of a block.
fn is_whole(path: &Path, block: &Block) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| found.is_file() && found.len() == block.bytes)
}

/// The blocks in a folder, as its files tell of them: those of a complete campaign, and those of one that is not. Nothing
/// is read but what tells of them, and their files have the length that they should.
///
/// # Errors
/// The files that tell of them cannot be read.
pub fn told(
    place: &Path,
    contents: &Contents<'_>,
    identity: &Identity,
) -> Result<Vec<Block>, FolderError> {
    let failed = |problem: Problem| FolderError { path: place.to_owned(), problem };
    let (record, _) = Hidden::record_of(place, contents.what).map_err(failed)?;
    let mut blocks = published(place, &record, identity).1;
    let area = Area::of(place);
    if area.identity().map_err(failed)?.is_some_and(|there| identity.difference(&there).is_none()) {
        blocks.extend(area.recorded().map_err(failed)?);
    }
    blocks.retain(|block| {
        let (root, name) = area.place_of(block, place);
        !block.has_file() || is_whole(&root.join(name), block)
    });
    let order = |b: &Block| (b.first_run, Reverse(b.again), !b.published);
    blocks.sort_by(|a, b| a.model.cmp(&b.model).then_with(|| order(a).cmp(&order(b))));
    blocks.dedup_by(|a, b| (&a.model, a.first_run) == (&b.model, b.first_run));
    Ok(blocks)
}

/// The runs of a model in blocks of a complete campaign in a folder, where they are read from; `empty` is a table of the model and its
/// columns.
#[must_use]
pub fn told_runs(place: &Path, blocks: &[Block], empty: &Table) -> Runs {
    let own = blocks.iter().filter(|block| block.model == empty.model());
    Runs::new(
        empty,
        own.map(|block| (block.range(), place.join(block.name()))).collect(),
        Vec::new(),
    )
}

/// The first of these files in a folder that is not as this program wrote it, and what became of it, in words. Nothing is known of a copy
/// without the hidden folder, of one that others may not read, and of a file that was not written.
///
/// # Errors
/// The file that tells what was written there cannot be read.
pub fn changed(place: &Path, what: &str, names: &[&str]) -> Result<Option<String>, FolderError> {
    let failed = |problem: Problem| FolderError { path: place.to_owned(), problem };
    let record = match Hidden::record_of(place, what) {
        Ok((record, _)) => record,
        Err(Problem::Io(error))
            if matches!(error.kind(), ErrorKind::PermissionDenied | ErrorKind::NotADirectory) =>
        {
            return Ok(None);
        }
        Err(problem) => return Err(failed(problem)),
    };
    let became = |name: &&str| {
        let own = Name::new(name).ok()?;
        let written = record.hash(&own)?;
        match look(place, &own) {
            Ok(Found::File { hash }) if hash == written => None,
            Ok(Found::File { .. } | Found::Other { .. }) => {
                Some(format!("{name} in it was changed after it was written"))
            }
            Ok(Found::Nothing) => Some(format!("{name} in it is not there any more")),
            Err(error) => Some(format!("{name} in it cannot be read: {error}")),
        }
    };
    Ok(names.iter().find_map(became))
}

/// Why nothing is known of the complete campaign of this identity in a folder, if nothing is.
///
/// # Errors
/// The file that tells what was written there cannot be read.
pub fn why_unknown(
    place: &Path,
    contents: &Contents<'_>,
    identity: &Identity,
) -> Result<Option<String>, FolderError> {
    let what = contents.what;
    if !place.join(MANIFEST).exists() {
        return Ok(Some(format!("it holds no runs of a {what}")));
    }
    if !place.join(HIDDEN).exists() {
        return Ok(Some(format!(
            "it is a copy without the folder {HIDDEN}, which tells what its files are: copy that too"
        )));
    }
    let found = Hidden::record_of(place, what);
    let (record, hash) =
        found.map_err(|problem| FolderError { path: place.to_owned(), problem })?;
    if hash.is_none() {
        let name = Hidden::record_name(what);
        return Ok(Some(format!("{name}, which tells what its files are, is not there")));
    }
    let problem = || format!("{MANIFEST} is not as it was written, so that nobody knows its runs");
    Ok(manifest(place, &record, identity).is_none().then(problem))
}

/// The runs from 0 to below a number that are in none of these ranges, which are in order: in parts that no block of so
/// many runs reaches beyond.
#[must_use]
pub fn missing_runs(
    finished: impl IntoIterator<Item = Range<u64>>,
    runs: u64,
    block_runs: u64,
) -> Vec<Range<u64>> {
    let block_runs = block_runs.max(1);
    let mut missing = Vec::new();
    let mut next = 0;
    for done in finished.into_iter().chain(iter::once(runs..runs)) {
        while next < done.start.min(runs) {
            let end = (next / block_runs).saturating_add(1).saturating_mul(block_runs);
            let end = end.min(done.start).min(runs);
            missing.push(next..end);
            next = end;
        }
        next = next.max(done.end);
    }
    missing
}

/// What is kept of the complete campaign of this identity, and its blocks, if the folder has one.
pub(super) fn published(place: &Path, record: &Record, identity: &Identity) -> (Kept, Vec<Block>) {
    let known =
        |name: &str, sha: &str| Name::new(name).is_ok_and(|name| record.hash(&name) == Some(sha));
    let manifest = manifest(place, record, identity);
    let kept = manifest.as_ref().map(|manifest| manifest.kept().clone()).unwrap_or_default();
    let is_known = |block: &Block| !block.has_file() || known(&block.name(), &block.sha256);
    let blocks = manifest.into_iter().flat_map(Manifest::into_blocks);
    (kept, blocks.filter(|block| block.is_sound() && is_known(block)).collect())
}

/// What tells of the complete campaign of this identity, if the folder has one and it is as it was written.
pub(super) fn manifest(place: &Path, record: &Record, identity: &Identity) -> Option<Manifest> {
    let unchanged = Name::new(MANIFEST).is_ok_and(|name| {
        matches!(look(place, &name), Ok(Found::File { hash }) if record.hash(&name) == Some(&hash))
    });
    let manifest = Manifest::read(place).ok().filter(|_| unchanged);
    manifest.filter(|manifest| manifest.identity().difference(identity).is_none())
}
