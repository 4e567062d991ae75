//! Finished blocks of runs: on the disk as soon as they are done, and known again by the command that goes on.
//!
//! Until a campaign is complete its blocks are in `.gyradius/campaign`, so that nobody takes half a campaign for a
//! whole one. A block is written under another name, synced, and renamed; then a line of the record tells of it
//! with its checksum, and only then it counts. What was there when the program was killed is either a block of
//! the record or is done again.

use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::{
    cmp::Reverse,
    collections::{BTreeMap, BTreeSet},
    fs::File,
    io::{self, BufWriter, Write},
    ops::Range,
    path::{Path, PathBuf},
    sync::Mutex,
};

use super::{
    Folder, FolderError, Problem,
    area::{Area, line},
    disk,
    hidden::{Hidden, be_folder, real_folder},
    manifest::Block,
    name::{Found, HIDDEN, Name, look},
    refusal::Refusal,
    shared::Shared,
    told::{is_whole, missing_runs, published},
    unobstructed,
};
use crate::{
    hash::hex,
    identity::{Difference, Identity},
    runs::Runs,
    runs_error,
    shard::Shard,
    table::Table,
};

const DAMAGED: &str = "damaged";

/// The blocks of a campaign in its folder.
#[derive(Debug)]
pub struct Blocks {
    pub(super) place: PathBuf,
    /// Where the blocks of an unfinished campaign are.
    pub(super) area: Area,
    pub(super) identity: Identity,
    /// Which share this is of; others are done by other processes at the same time.
    shard: Option<Shard>,
    /// Where finished blocks are told of.
    record: PathBuf,
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
    /// completed, and those that go beyond the runs. `mark` is a text from which the campaign can be gone on with: see
    /// [`begun`](crate::begun).
    ///
    /// # Errors
    /// There are blocks of another campaign, or they cannot be read or put aside.
    pub fn blocks(
        &self,
        (identity, mark): (&Identity, &str),
        runs: u64,
        force: bool,
        threads: &rayon::ThreadPool,
    ) -> Result<Blocks, FolderError> {
        let folder = (&self.hidden, Some(self.contents.what));
        let area = Area::of(self.hidden.place());
        let opened = Blocks::open(folder, area, (identity, mark), None, (runs, force), threads);
        opened.map_err(|problem| self.failed(problem))
    }

    /// The finished blocks of another campaign of the same folder, which has a name and is put nowhere: only what comes of it
    /// is. [`clear_beside`](Self::clear_beside) removes them.
    ///
    /// # Errors
    /// As [`blocks`](Self::blocks).
    pub fn blocks_beside(
        &self,
        name: &str,
        (identity, mark): (&Identity, &str),
        runs: u64,
        force: bool,
        threads: &rayon::ThreadPool,
    ) -> Result<Blocks, FolderError> {
        let area = Area::called(self.hidden.place(), name);
        let opened = Blocks::open(
            (&self.hidden, None),
            area,
            (identity, mark),
            None,
            (runs, force),
            threads,
        );
        opened.map_err(|problem| self.failed(problem))
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
}

impl Shared {
    /// The blocks of a campaign of so many runs a model, for the process that does a share of those that are missing.
    /// Blocks that are there are taken for what they are if their length is right: who puts the campaign together reads
    /// them.
    ///
    /// # Errors
    /// There are blocks of another campaign, or another process does the same share.
    pub fn blocks(
        &self,
        (identity, mark): (&Identity, &str),
        runs: u64,
        shard: Shard,
        threads: &rayon::ThreadPool,
    ) -> Result<Blocks, FolderError> {
        let folder = (&self.hidden, Some(self.what));
        let area = Area::of(self.hidden.place());
        let opened =
            Blocks::open(folder, area, (identity, mark), Some(shard), (runs, false), threads);
        opened.map_err(|problem| FolderError { path: self.place.clone(), problem })
    }
}

impl Blocks {
    /// Takes up what was finished before, and tells how the campaign goes on.
    fn open(
        (hidden, what): (&Hidden, Option<&str>),
        area: Area,
        (identity, mark): (&Identity, &str),
        shard: Option<Shard>,
        (runs, force): (u64, bool),
        threads: &rayon::ThreadPool,
    ) -> Result<Self, Problem> {
        if let Some(difference) = area.identity()?.and_then(|there| identity.difference(&there)) {
            if !force {
                return Err(Problem::Unfinished { difference });
            }
            area.clear()?;
        }
        area.begin(hidden, identity)?;
        let (record, file) = area.record(shard)?;
        let state = Mutex::new(State { blocks: Vec::new(), record: file });
        let (place, identity) = (hidden.place().to_owned(), identity.clone());
        let mut opened = Self { place, area, identity, shard, record, state, damaged: Vec::new() };
        let mut blocks = Vec::new();
        if let Some(what) = what {
            let record = hidden.record(what)?.0;
            let (kept, there) = published(&opened.place, &record, &opened.identity)?;
            blocks = there;
            if !kept.is_all() {
                blocks.clear();
            }
        }
        let unfinished = opened.area.recorded()?;
        blocks.extend(unfinished.clone());
        // What was done again takes the place of what failed.
        blocks.sort_by_key(|block| Reverse(block.again));
        opened.verify(&blocks, &hidden.join(DAMAGED), threads)?;
        opened.limit(runs, force)?;
        if shard.is_none() {
            opened.tidy(&unfinished)?;
        }
        opened.area.tell(mark, shard)?;
        Ok(opened)
    }

    /// Takes up the blocks that are as they were written, and puts others aside.
    fn verify(
        &mut self,
        blocks: &[Block],
        aside: &Path,
        threads: &rayon::ThreadPool,
    ) -> Result<(), Problem> {
        // What stands behind a link is not the program's to put aside.
        let folder = |block: &Block| self.path(block).parent().map(Path::to_owned);
        for folder in blocks.iter().filter_map(folder).collect::<BTreeSet<_>>() {
            let name = || folder.strip_prefix(&self.place).unwrap_or(&folder).display().to_string();
            real_folder(&folder, name)?;
        }
        let states: Vec<Result<Option<String>, Refusal>> =
            threads.install(|| blocks.par_iter().map(|block| self.fault(block)).collect());
        let states = states.into_iter().collect::<Result<Vec<_>, _>>()?;
        let all = || blocks.iter().zip(&states);
        // Two shards may have done the same block, and one of their lines may tell of another content.
        let good: BTreeSet<PathBuf> =
            all().filter(|(_, fault)| fault.is_none()).map(|(block, _)| self.path(block)).collect();
        let mut damaged = Vec::new();
        for (block, fault) in all() {
            let path = self.path(block);
            if let Some(fault) = fault.as_ref().filter(|_| !good.contains(&path)) {
                // Other shards may be at it.
                if self.shard.is_none() && disk::found(&path)?.is_some() {
                    put_aside(&path, aside, block)?;
                }
                damaged.push((block, format!("{} {fault}", block.name())));
            }
        }
        // A block in its place counts, not the same one that was not removed in time.
        let mut ends = Ends::new();
        let mut sound = Vec::new();
        for (block, fault) in all() {
            let (model, runs) = (block.model(), block.range());
            if fault.is_none() && reach(&ends, model, runs.end) <= runs.start {
                ends.insert((model, runs.start), runs.end);
                sound.push(block.clone());
            }
        }
        // What was done again since is told no more.
        let again = |block: &Block| {
            reach(&ends, block.model(), block.first_run.saturating_add(1)) > block.first_run
        };
        damaged.retain(|(block, _)| !again(block));
        let told: BTreeSet<String> = damaged.into_iter().map(|(_, told)| told).collect();
        self.damaged.extend(told);
        self.locked().blocks = sound;
        Ok(())
    }

    /// Leaves out the blocks that go beyond so many runs, which `force` allows.
    fn limit(&self, runs: u64, force: bool) -> Result<(), Problem> {
        let most = self.end();
        if most > runs && !force {
            let said = |runs: u64| Some(runs.to_string());
            let field = "runs".to_owned();
            let difference = Difference { field, there: said(most), here: said(runs) };
            return Err(Problem::Unfinished { difference });
        }
        self.locked().blocks.retain(|block| block.range().end <= runs);
        Ok(())
    }

    /// Removes what is recorded but not taken up: dropped, damaged, or in its place already.
    fn tidy(&self, recorded: &[Block]) -> Result<(), Problem> {
        let mut state = self.locked();
        let kept: Vec<&Block> = state.blocks.iter().filter(|block| !block.published).collect();
        let known: BTreeSet<&Block> = kept.iter().copied().collect();
        let dropped: Vec<&Block> = recorded.iter().filter(|block| !known.contains(block)).collect();
        if !dropped.is_empty() || self.area.has_shards()? {
            // The record first: a file that it does not tell of is none of the blocks.
            let record = self.area.rewrite(&self.identity, &kept)?;
            let files: BTreeSet<PathBuf> = kept.iter().map(|block| self.path(block)).collect();
            for path in dropped.iter().map(|block| self.path(block)) {
                if !files.contains(&path) {
                    disk::remove_file(&path)?;
                }
            }
            state.record = record;
        }
        Ok(())
    }

    /// What is wrong with a block, if anything is.
    fn fault(&self, block: &Block) -> Result<Option<String>, Refusal> {
        let (root, name) = self.area.place_of(block, &self.place);
        let Ok(name) = Name::new(&name) else {
            return Ok(Some("has no name of a block".to_owned()));
        };
        if self.shard.is_some() {
            let whole = is_whole(&name.below(root), block)?;
            return Ok((!whole).then(|| "is gone or not of its length".to_owned()));
        }
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
    pub(super) fn all(&self) -> Vec<Block> {
        let mut blocks = self.locked().blocks.clone();
        blocks.sort_by(|a, b| (&a.model, a.first_run).cmp(&(&b.model, b.first_run)));
        blocks
    }

    /// Whether all are in their places.
    #[must_use]
    pub fn all_in_place(&self) -> bool {
        self.locked().blocks.iter().all(|block| block.published)
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
        let finished = self.all().into_iter().filter(|block| block.model == model);
        missing_runs(finished.map(|block| block.range()), runs, block_runs)
    }

    /// One more than the last run that is in a block, of any model; 0 if there is no block.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.locked().blocks.iter().map(|block| block.range().end).max().unwrap_or(0)
    }

    /// The runs of each of the blocks of a model that have at least so many failed runs.
    pub(crate) fn ranges(&self, model: &str, failed: u64) -> Vec<Range<u64>> {
        let is_one = |block: &Block| block.model == model && block.failed >= failed;
        self.all().iter().filter(|block| is_one(block)).map(Block::range).collect()
    }

    /// Whether any run of a finished block failed.
    #[must_use]
    pub fn any_failed(&self) -> bool {
        self.locked().blocks.iter().any(|block| block.failed > 0)
    }

    /// How many runs of a model failed.
    #[must_use]
    pub fn failed(&self, model: &str) -> u64 {
        let state = self.locked();
        state.blocks.iter().filter(|b| b.model == model).map(|block| block.failed).sum()
    }

    /// How many runs of all blocks were done again because they had failed.
    #[must_use]
    pub fn again(&self) -> u64 {
        self.locked().blocks.iter().map(|block| block.again).sum()
    }

    /// Writes a block. When this returns it is on the disk, and counts.
    ///
    /// # Errors
    /// It cannot be written, as on a full disk. Blocks that were finished stay so.
    pub fn write(&self, table: &Table) -> Result<PathBuf, FolderError> {
        self.write_again(table, 0)
    }

    /// Writes a block in the place of a finished one, so many runs of which were done again. The finished one counts until
    /// this one does.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub(crate) fn write_again(&self, table: &Table, again: u64) -> Result<PathBuf, FolderError> {
        self.put(table, again).map_err(|problem| FolderError { path: self.place.clone(), problem })
    }

    fn put(&self, table: &Table, again: u64) -> Result<PathBuf, Problem> {
        let runs = table.first()..table.first() + table.len() as u64;
        let mut block = Block::of(table.model(), &runs);
        let same = |b: &Block| b.model == block.model && b.first_run == block.first_run;
        let before = self.locked().blocks.iter().filter(|b| same(b)).map(|b| b.again).sum::<u64>();
        block.again = before + again;
        let folder = self.area.path().join(&block.model);
        be_folder(&folder, || format!("{}/{}", self.area.name(), block.model))?;
        let path = self.path(&block);
        let name = self.shard.map_or_else(|| "part".to_owned(), |s| format!("{}.part", s.name()));
        let part = path.with_extension(name);
        // Of a program that was killed; nobody else writes here.
        disk::remove_file(&part)?;
        let mut file = Hashed { to: disk::create_file(&part)?, sha: Sha256::new(), bytes: 0 };
        let written = table
            .write_parquet(BufWriter::new(&mut file))
            .map_err(|error| Problem::Block {
                name: block.name(),
                problem: runs_error::said(&error),
            })
            .and_then(|()| Ok(disk::sync_file(&part)?));
        if let Err(problem) = written {
            let _ = disk::remove_file(&part);
            return Err(problem);
        }
        block.failed = table.failures().len() as u64;
        (block.bytes, block.sha256) = (file.bytes, hex(file.sha));
        disk::replace_file(&part, &path)?;
        disk::sync_folder(&folder)?;
        disk::sync_folder(self.area.path())?;
        let mut state = self.locked();
        let line = format!("\n{}\n", line(&self.identity.word(), &block)?);
        disk::append(&state.record, &self.record, &line)?;
        state.blocks.retain(|b| !(b.model == block.model && b.first_run == block.first_run));
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
    pub fn in_place(&self, runs: Runs) -> Runs {
        let (empty, held) = runs.into_parts();
        self.runs(&empty, held)
    }

    /// Where a block is.
    pub(super) fn path(&self, block: &Block) -> PathBuf {
        let (root, name) = self.area.place_of(block, &self.place);
        root.join(name)
    }

    /// All blocks are in their places: removes what they were linked from.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn settle(&self) -> Result<(), FolderError> {
        for block in &mut self.locked().blocks {
            block.published = true;
        }
        self.area
            .clear()
            .map_err(|error| FolderError { path: self.place.clone(), problem: error.into() })
    }

    /// Removes the traces of a campaign of which no block was finished.
    pub fn abandon(&self) {
        let nothing = self.locked().blocks.iter().all(|block| block.published);
        if nothing && self.shard.is_none() {
            // What stays is hidden and harms nothing.
            let _ = self.area.clear();
        }
    }

    fn locked(&self) -> std::sync::MutexGuard<'_, State> {
        // Nothing is half done with the lock in hand.
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// One more than the last runs of blocks, by their models and first runs.
type Ends<'a> = BTreeMap<(&'a str, u64), u64>;

/// How far the blocks of a model reach that begin before a run. Blocks are apart, so that the last of them reaches furthest.
fn reach(ends: &Ends<'_>, model: &str, run: u64) -> u64 {
    ends.range((model, 0)..(model, run)).next_back().map_or(0, |(_, end)| *end)
}

/// Moves a block that is not as it was written out of the way.
fn put_aside(path: &Path, damaged: &Path, block: &Block) -> Result<(), Problem> {
    be_folder(damaged, || format!("{HIDDEN}/{DAMAGED}"))?;
    let name = |i: u32| damaged.join(format!("{}-{}.{i}", block.model, block.file()));
    let free = (1..).map(name).find(|name| disk::is_free(name));
    Ok(free.map_or(Ok(()), |free| disk::move_away(path, &free))?)
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
