//! Finished blocks of runs: on the disk as soon as they are done, and known again by the command that goes on.
//!
//! Until a campaign is complete its blocks are in `.gyradius/campaign`, so that nobody takes half a campaign for a
//! whole one. A block is written under another name, synced, and renamed; then a line of the record tells of it
//! with its checksum, and only then it counts. What was there when the program was killed is either a block of
//! the record or is done again.

use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::{
    collections::BTreeSet,
    fs::{self, File, OpenOptions},
    io::{self, BufWriter, Write},
    iter,
    ops::Range,
    path::{Path, PathBuf},
    sync::Mutex,
};

use super::{
    Folder, FolderError, Problem, disk,
    hidden::Hidden,
    manifest::{Block, MANIFEST, Manifest},
    name::{Found, HIDDEN, Name, hex, look, said},
    record::Record,
    unobstructed,
};
use crate::{
    column::Column,
    identity::{Difference, Identity},
    runs::Runs,
    stored,
    table::Table,
};

const CAMPAIGN: &str = "campaign";
const IDENTITY: &str = "identity.json";
const RECORD: &str = "record";
const DAMAGED: &str = "damaged";
/// The blocks of a campaign in its folder.
#[derive(Debug)]
pub struct Blocks {
    place: PathBuf,
    /// Where the blocks of an unfinished campaign are.
    folder: PathBuf,
    identity: Identity,
    state: Mutex<State>,
    damaged: Vec<String>,
}

#[derive(Debug)]
struct State {
    blocks: Vec<Block>,
    record: File,
}

impl Folder<'_> {
    /// The blocks of a campaign of so many runs a model that are finished, each of which was read and is as it was
    /// written; those that are not, are put aside. `force` drops the blocks of another campaign that was not
    /// completed, and those that go beyond the runs.
    ///
    /// # Errors
    /// There are blocks of another campaign, or they cannot be read or put aside.
    pub fn blocks(
        &self,
        identity: &Identity,
        runs: u64,
        force: bool,
        threads: &rayon::ThreadPool,
    ) -> Result<Blocks, FolderError> {
        let (record, _) =
            self.hidden.record(self.contents.what).map_err(|problem| self.failed(problem))?;
        Blocks::open(&self.hidden, &record, (identity, runs, force), threads)
            .map_err(|problem| self.failed(problem))
    }

    /// That nothing is in the places of blocks of a model that are to be done, but what may be replaced.
    ///
    /// # Errors
    /// Something is, which this program did not write.
    pub fn check_places(&self, model: &str, missing: &[Range<u64>]) -> Result<(), FolderError> {
        let check = || {
            let (record, _) = self.hidden.record(self.contents.what)?;
            let name = |runs: &Range<u64>| Name::new(&Block::of(model, runs).name());
            let names = missing.iter().map(name).collect::<Result<Vec<_>, _>>()?;
            unobstructed(self.hidden.place(), &record, &names)
        };
        check().map_err(|problem| self.failed(problem))
    }

    /// Puts the blocks that are not in their places there with the rest of the draft, and tells of all of them.
    ///
    /// # Errors
    /// They cannot be linked or copied.
    pub fn adopt(&mut self, blocks: &Blocks, columns: &[Column]) -> Result<(), FolderError> {
        for block in blocks.all().iter().filter(|block| !block.published) {
            let name = Name::new(&block.name()).map_err(|error| self.failed(error.into()))?;
            let path = blocks.path(block);
            self.journal
                .link(&self.hidden, name, &path, &block.sha256)
                .map_err(|problem| self.failed(problem))?;
        }
        let text =
            serde_json::to_string_pretty(&Manifest::new(&blocks.identity, columns, blocks.all()))
                .map_err(|error| self.failed(error.into()))?;
        self.write(MANIFEST, &(text + "\n"))
    }
}

impl Blocks {
    fn open(
        hidden: &Hidden,
        record: &Record,
        (identity, runs, force): (&Identity, u64, bool),
        threads: &rayon::ThreadPool,
    ) -> Result<Self, Problem> {
        let folder = hidden.join(CAMPAIGN);
        match fs::symlink_metadata(&folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(error.into()),
            Ok(metadata) if metadata.is_dir() => {
                if let Some(difference) =
                    unfinished(&folder)?.and_then(|there| identity.difference(&there))
                {
                    if !force {
                        return Err(Problem::Unfinished { difference });
                    }
                    clear(&folder)?;
                }
            }
            Ok(metadata) => {
                let (name, is) = (format!("{HIDDEN}/{CAMPAIGN}"), said(metadata.file_type()));
                return Err(Problem::Kind { name, is, should: "folder" });
            }
        }
        begin(hidden, &folder, identity)?;
        let path = folder.join(RECORD);
        let mut blocks = published(hidden.place(), record, identity);
        let unfinished = recorded(&path)?;
        blocks.extend(unfinished.clone());
        let record = OpenOptions::new().append(true).create(true).open(&path)?;
        let place = hidden.place().to_owned();
        let state = Mutex::new(State { blocks: Vec::new(), record });
        let identity = identity.clone();
        let mut opened = Self { place, folder, identity, state, damaged: Vec::new() };
        opened.verify(blocks, &hidden.join(DAMAGED), threads)?;
        opened.limit(runs, force)?;
        opened.tidy(&unfinished)?;
        Ok(opened)
    }

    /// Takes up the blocks that are as they were written, and puts others aside.
    fn verify(
        &mut self,
        blocks: Vec<Block>,
        damaged: &Path,
        threads: &rayon::ThreadPool,
    ) -> Result<(), Problem> {
        let states: Vec<io::Result<Option<String>>> =
            threads.install(|| blocks.par_iter().map(|block| self.fault(block)).collect());
        let mut sound = Vec::<Block>::new();
        for (block, fault) in blocks.into_iter().zip(states) {
            match fault? {
                Some(fault) => {
                    let path = self.path(&block);
                    if fs::symlink_metadata(&path).is_ok() {
                        put_aside(&path, damaged, &block)?;
                    }
                    self.damaged.push(format!("{} {fault}", block.name()));
                }
                // A block in its place counts, not the same one that was not removed in time.
                None => {
                    let overlaps = |other: &Block| {
                        other.model == block.model
                            && other.first_run < block.range().end
                            && block.first_run < other.range().end
                    };
                    if !sound.iter().any(overlaps) {
                        sound.push(block);
                    }
                }
            }
        }
        self.locked().blocks = sound;
        Ok(())
    }

    /// Leaves out the blocks that go beyond so many runs, which `force` allows.
    fn limit(&self, runs: u64, force: bool) -> Result<(), Problem> {
        let mut state = self.locked();
        let most = state.blocks.iter().map(|block| block.range().end).max().unwrap_or(0);
        if most > runs && !force {
            let said = |runs: u64| Some(runs.to_string());
            let field = "runs".to_owned();
            let difference = Difference { field, there: said(most), here: said(runs) };
            return Err(Problem::Unfinished { difference });
        }
        state.blocks.retain(|block| block.range().end <= runs);
        Ok(())
    }

    /// Removes what is recorded but not taken up: dropped, damaged, or in its place already.
    fn tidy(&self, recorded: &[Block]) -> Result<(), Problem> {
        let mut state = self.locked();
        let kept: Vec<&Block> = state.blocks.iter().filter(|block| !block.published).collect();
        let dropped: Vec<&Block> = recorded.iter().filter(|block| !kept.contains(block)).collect();
        if !dropped.is_empty() {
            // The record first: a file that it does not tell of is none of the blocks.
            let lines = kept.iter().map(serde_json::to_string).collect::<Result<Vec<_>, _>>()?;
            let (path, part) = (self.folder.join(RECORD), self.folder.join("record.part"));
            disk::remove_file(&part)?;
            let mut file = disk::create_file(&part)?;
            file.write_all((lines.join("\n") + "\n").as_bytes())?;
            disk::sync_file(&part)?;
            disk::replace_file(&part, &path)?;
            disk::sync_folder(&self.folder)?;
            let files: BTreeSet<PathBuf> = kept.iter().map(|block| self.path(block)).collect();
            for path in dropped.iter().map(|block| self.path(block)) {
                if !files.contains(&path) {
                    disk::remove_file(&path)?;
                }
            }
            state.record = OpenOptions::new().append(true).open(&path)?;
        }
        Ok(())
    }

    /// What is wrong with a block, if anything is.
    fn fault(&self, block: &Block) -> io::Result<Option<String>> {
        let (root, name) = if block.published {
            (&self.place, block.name())
        } else {
            (&self.folder, format!("{}/{}", block.model, block.file()))
        };
        let Ok(name) = Name::new(&name) else {
            return Ok(Some("has no name of a block".to_owned()));
        };
        Ok(match look(root, &name)? {
            Found::Nothing => Some("is gone".to_owned()),
            Found::File { hash } if hash == block.sha256 => None,
            Found::File { .. } => Some("is not as it was written".to_owned()),
            Found::Other { is, .. } => Some(format!("is a {is}")),
        })
    }

    /// What is wrong with blocks that were finished: they are done again.
    #[must_use]
    pub fn damaged(&self) -> &[String] {
        &self.damaged
    }

    /// All that are finished.
    fn all(&self) -> Vec<Block> {
        let mut blocks = self.locked().blocks.clone();
        blocks.sort_by(|a, b| (&a.model, a.first_run).cmp(&(&b.model, b.first_run)));
        blocks
    }

    /// The names of those that are in their places.
    #[must_use]
    pub fn published(&self) -> BTreeSet<String> {
        self.all().iter().filter(|block| block.published).map(Block::name).collect()
    }

    /// The runs of a model from 0 to below a number that are in no block: in parts that no block reaches beyond, of
    /// so many runs at most.
    #[must_use]
    pub fn missing(&self, model: &str, runs: u64, block_runs: u64) -> Vec<Range<u64>> {
        let block_runs = block_runs.max(1);
        let mut missing = Vec::new();
        let mut next = 0;
        let finished = self.all().into_iter().filter(|block| block.model == model);
        for done in finished.map(|block| block.range()).chain(iter::once(runs..runs)) {
            while next < done.start.min(runs) {
                let end = ((next / block_runs + 1) * block_runs).min(done.start).min(runs);
                missing.push(next..end);
                next = end;
            }
            next = next.max(done.end);
        }
        missing
    }

    /// Writes a block. When this returns it is on the disk, and counts.
    ///
    /// # Errors
    /// It cannot be written, as on a full disk. Blocks that were finished stay so.
    pub fn write(&self, table: &Table) -> Result<PathBuf, FolderError> {
        self.put(table).map_err(|problem| FolderError { path: self.place.clone(), problem })
    }

    fn put(&self, table: &Table) -> Result<PathBuf, Problem> {
        let runs = table.first()..table.first() + table.len() as u64;
        let mut block = Block::of(table.model(), &runs);
        let folder = self.folder.join(&block.model);
        match disk::create_folder(&folder) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            other => other?,
        }
        let path = self.path(&block);
        let part = path.with_extension("part");
        // Of a program that was killed; nobody else writes here.
        disk::remove_file(&part)?;
        let mut file = Hashed { to: disk::create_file(&part)?, sha: Sha256::new(), bytes: 0 };
        let written = table
            .write_parquet(BufWriter::new(&mut file))
            .map_err(|error| Problem::Block { name: block.name(), problem: stored::said(&error) })
            .and_then(|()| Ok(disk::sync_file(&part)?));
        if let Err(problem) = written {
            let _ = disk::remove_file(&part);
            return Err(problem);
        }
        (block.bytes, block.sha256) = (file.bytes, hex(file.sha));
        disk::remove_file(&path)?;
        disk::move_file(&part, &path)?;
        disk::sync_folder(&folder)?;
        disk::sync_folder(&self.folder)?;
        let mut state = self.locked();
        let line = format!("\n{}\n", serde_json::to_string(&block)?);
        disk::append(&state.record, &self.folder.join(RECORD), &line)?;
        state.blocks.push(block);
        Ok(path)
    }

    /// The runs of a model, which are read from its blocks.
    ///
    /// `empty` is a table of the model and its columns; `held` are blocks that are in memory.
    #[must_use]
    pub fn runs(&self, empty: &Table, held: Vec<Table>) -> Runs {
        let of_model = self.all().into_iter().filter(|block| block.model == empty.model());
        let files = of_model.map(|block| (block.range(), self.path(&block)));
        Runs::new(empty, files.collect(), held)
    }

    /// The same runs, read from the places where their blocks are now.
    #[must_use]
    pub fn in_place(&self, runs: &Runs) -> Runs {
        let (empty, held) = runs.clone().into_parts();
        self.runs(&empty, held)
    }

    /// Where a block is.
    fn path(&self, block: &Block) -> PathBuf {
        if block.published {
            self.place.join(block.name())
        } else {
            self.folder.join(&block.model).join(block.file())
        }
    }

    /// All blocks are in their places: removes what they were linked from.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn settle(&self) -> Result<(), FolderError> {
        for block in &mut self.locked().blocks {
            block.published = true;
        }
        clear(&self.folder)
            .map_err(|error| FolderError { path: self.place.clone(), problem: error.into() })
    }

    /// Removes the traces of a campaign of which no block was finished.
    pub fn abandon(&self) {
        if self.locked().blocks.iter().all(|block| block.published) {
            // What stays is hidden and harms nothing.
            let _ = clear(&self.folder);
        }
    }

    fn locked(&self) -> std::sync::MutexGuard<'_, State> {
        // Nothing is half done with the lock in hand.
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// The identity of the campaign that is unfinished in a folder, if it was begun.
fn unfinished(folder: &Path) -> Result<Option<Identity>, Problem> {
    let name = format!("{HIDDEN}/{CAMPAIGN}/{IDENTITY}");
    let unknown = |problem: String| Problem::Unknown { name, problem };
    match fs::read(folder.join(IDENTITY)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(unknown(error.to_string())),
        Ok(text) => serde_json::from_slice(&text).map(Some).map_err(|e| unknown(e.to_string())),
    }
}

/// Makes the folder of an unfinished campaign, if it is not there.
fn begin(hidden: &Hidden, folder: &Path, identity: &Identity) -> Result<(), Problem> {
    if folder.join(IDENTITY).is_file() {
        return Ok(());
    }
    if !folder.is_dir() {
        disk::create_folder(folder)?;
    }
    let part = folder.join("identity.part");
    disk::remove_file(&part)?;
    disk::create_file(&part)?.write_all(serde_json::to_string_pretty(identity)?.as_bytes())?;
    disk::sync_file(&part)?;
    disk::move_file(&part, &folder.join(IDENTITY))?;
    disk::sync_folder(folder)?;
    Ok(disk::sync_folder(&hidden.join(""))?)
}

/// The blocks that a record tells of; a line that was broken off tells of none.
fn recorded(path: &Path) -> Result<Vec<Block>, Problem> {
    let text = match fs::read(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        other => other?,
    };
    let lines = text.split(|byte| *byte == b'\n').filter(|line| !line.is_empty());
    let blocks = lines.filter_map(|line| serde_json::from_slice::<Block>(line).ok());
    Ok(blocks.filter(Block::is_sound).collect())
}

/// The blocks of a complete campaign of this identity, if the folder has one.
fn published(place: &Path, record: &Record, identity: &Identity) -> Vec<Block> {
    let known =
        |name: &str, sha: &str| Name::new(name).is_ok_and(|name| record.hash(&name) == Some(sha));
    let unchanged = Name::new(MANIFEST).is_ok_and(|name| {
        matches!(look(place, &name), Ok(Found::File { hash }) if record.hash(&name) == Some(&hash))
    });
    let manifest = Manifest::read(place).ok().filter(|_| unchanged);
    let manifest = manifest.filter(|manifest| manifest.identity().difference(identity).is_none());
    let blocks = manifest.into_iter().flat_map(Manifest::into_blocks);
    blocks.filter(|block| block.is_sound() && known(&block.name(), &block.sha256)).collect()
}

/// Moves a block that is not as it was written out of the way.
fn put_aside(path: &Path, damaged: &Path, block: &Block) -> io::Result<()> {
    if !damaged.is_dir() {
        disk::create_folder(damaged)?;
    }
    let name = |i: u32| damaged.join(format!("{}-{}.{i}", block.model, block.file()));
    let free = (1..).map(name).find(|name| fs::symlink_metadata(name).is_err());
    free.map_or(Ok(()), |free| disk::move_file(path, &free))
}

/// Removes the files of an unfinished campaign, and the folders if nothing else is in them.
fn clear(folder: &Path) -> io::Result<()> {
    let own = |name: &str| {
        let (stem, end) = name.split_once('.').unwrap_or((name, ""));
        let numbers = stem.split_once('-').is_some_and(|(first, last)| {
            [first, last].iter().all(|part| part.bytes().all(|byte| byte.is_ascii_digit()))
        });
        numbers && matches!(end, "parquet" | "part")
    };
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        other => other?,
    };
    for entry in entries {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            for block in fs::read_dir(entry.path())? {
                let block = block?;
                if own(&block.file_name().to_string_lossy()) && block.file_type()?.is_file() {
                    disk::remove_file(&block.path())?;
                }
            }
            disk::remove_folder(&entry.path())?;
        }
    }
    // The identity goes last: without it, nothing is known to be a block.
    for name in [RECORD, "record.part", "identity.part", IDENTITY] {
        disk::remove_file(&folder.join(name))?;
    }
    disk::remove_folder(folder)
}

/// Counts and hashes what is written.
struct Hashed {
    to: File,
    sha: Sha256,
    bytes: u64,
}

impl Write for Hashed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.to.write(bytes)?;
        self.sha.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}
