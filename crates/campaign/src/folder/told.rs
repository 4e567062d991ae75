//! What the files of a folder tell of a campaign, for those who only read: others may be at work there.

use std::{
    cmp::Reverse,
    iter,
    ops::Range,
    path::{Path, PathBuf},
};

use super::{
    Contents, FolderError, Problem,
    area::Area,
    disk,
    hidden::Hidden,
    manifest::{Block, MANIFEST, Manifest},
    name::{Found, HIDDEN, Name, look},
    record::Record,
    refusal::Refusal,
};
use crate::{
    identity::{Difference, Identity},
    kept::Kept,
    runs::Runs,
    table::Table,
};

/// The text from which the unfinished campaign in a folder was begun, if there is one.
///
/// # Errors
/// Whether there is one cannot be read.
pub fn begun(place: &Path) -> Result<Option<String>, FolderError> {
    text_of_begun(place).map_err(|problem| FolderError { path: place.to_owned(), problem })
}

pub(super) fn text_of_begun(place: &Path) -> Result<Option<String>, Problem> {
    let area = Area::of(place);
    Ok(if area.identity()?.is_some() { area.mark()? } else { None })
}

/// What the unfinished campaign in a folder has otherwise than the complete one that it is to replace, and that is the one of the
/// folder until then, if there are two.
///
/// # Errors
/// Whether there are two cannot be read.
pub fn replacing(place: &Path) -> Result<Option<Difference>, FolderError> {
    let Some(unfinished) = Identity::begun(place)? else { return Ok(None) };
    let complete = Manifest::read(place).ok();
    Ok(complete.and_then(|complete| complete.identity().difference(&unfinished)))
}

impl Identity {
    /// That of the unfinished campaign in a folder, if there is one.
    ///
    /// # Errors
    /// Whether there is one cannot be read.
    pub fn begun(place: &Path) -> Result<Option<Self>, FolderError> {
        let there = Area::of(place).identity();
        there.map_err(|problem| FolderError { path: place.to_owned(), problem })
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
        let there = || {
            let area = Area::of(place);
            let mut there: Option<(Self, PathBuf)> = None;
            for block in area.recorded()? {
                let is_own = block.model == model && block.range().contains(&run);
                let is_later = there.as_ref().is_none_or(|(other, _)| other.again <= block.again);
                let (root, name) = area.place_of(&block, place);
                let path = root.join(name);
                if is_own && is_later && is_whole(&path, &block)? {
                    there = Some((block, path));
                }
            }
            Ok(there)
        };
        there().map_err(|problem: Problem| FolderError { path: place.to_owned(), problem })
    }
}

/// Whether a file is there with the length of a block.
pub(super) fn is_whole(path: &Path, block: &Block) -> Result<bool, Refusal> {
    Ok(disk::found(path)?.is_some_and(|found| found.is_file() && found.len() == block.bytes))
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
    let there = || {
        let (record, _) = Hidden::record_of(place, contents.what)?;
        let mut told = published(place, &record, identity)?.1;
        let area = Area::of(place);
        if area.identity()?.is_some_and(|there| identity.difference(&there).is_none()) {
            told.extend(area.recorded()?);
        }
        let mut blocks = Vec::new();
        for block in told {
            let (root, name) = area.place_of(&block, place);
            if !block.has_file() || is_whole(&root.join(name), &block)? {
                blocks.push(block);
            }
        }
        Ok(blocks)
    };
    let blocks = there();
    let mut blocks =
        blocks.map_err(|problem: Problem| FolderError { path: place.to_owned(), problem })?;
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
/// without the hidden folder, and of a file that was not written.
///
/// # Errors
/// The file that tells what was written there cannot be read, nor one of these.
pub fn changed(place: &Path, what: &str, names: &[&str]) -> Result<Option<String>, FolderError> {
    let became = |name: &str, record: &Record| {
        let own = Name::new(name)?;
        let Some(written) = record.hash(&own) else { return Ok(None) };
        Ok(match look(place, &own)? {
            Found::File { hash } if hash == written => None,
            Found::File { .. } | Found::Other { .. } => {
                Some(format!("{name} in it was changed after it was written"))
            }
            Found::Nothing => Some(format!("{name} in it is not there any more")),
        })
    };
    let first = || {
        let (record, _) = Hidden::record_of(place, what)?;
        names.iter().find_map(|name| became(name, &record).transpose()).transpose()
    };
    first().map_err(|problem: Problem| FolderError { path: place.to_owned(), problem })
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
    let why = || {
        let what = contents.what;
        if disk::found(&place.join(MANIFEST))?.is_none() {
            return Ok(Some(format!("it holds no runs of a {what}")));
        }
        if !Hidden::is_in(place)? {
            return Ok(Some(format!(
                "it is a copy without the folder {HIDDEN}, which tells what its files are: copy that too"
            )));
        }
        let (record, hash) = Hidden::record_of(place, what)?;
        if hash.is_none() {
            let name = Hidden::record_name(what);
            return Ok(Some(format!("{name}, which tells what its files are, is not there")));
        }
        let problem =
            || format!("{MANIFEST} is not as it was written, so that nobody knows its runs");
        Ok(manifest(place, &record, identity)?.is_none().then(problem))
    };
    why().map_err(|problem: Problem| FolderError { path: place.to_owned(), problem })
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
pub(super) fn published(
    place: &Path,
    record: &Record,
    identity: &Identity,
) -> Result<(Kept, Vec<Block>), Refusal> {
    let known =
        |name: &str, sha: &str| Name::new(name).is_ok_and(|name| record.hash(&name) == Some(sha));
    let manifest = manifest(place, record, identity)?;
    let kept = manifest.as_ref().map(|manifest| manifest.kept().clone()).unwrap_or_default();
    let is_known = |block: &Block| !block.has_file() || known(&block.name(), &block.sha256);
    let blocks = manifest.into_iter().flat_map(Manifest::into_blocks);
    Ok((kept, blocks.filter(|block| block.is_sound() && is_known(block)).collect()))
}

/// What tells of the complete campaign of this identity, if the folder has one and it is as it was written.
pub(super) fn manifest(
    place: &Path,
    record: &Record,
    identity: &Identity,
) -> Result<Option<Manifest>, Refusal> {
    let Ok(name) = Name::new(MANIFEST) else { return Ok(None) };
    let unchanged = matches!(
        look(place, &name)?, Found::File { hash } if record.hash(&name) == Some(&hash)
    );
    let manifest = Manifest::read(place).ok().filter(|_| unchanged);
    Ok(manifest.filter(|manifest| manifest.identity().difference(identity).is_none()))
}
