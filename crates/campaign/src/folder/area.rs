//! Where a campaign that is not complete is: what it is, its blocks, and the records that tell of them.

use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeSet,
    fs::{self, File, OpenOptions, TryLockError},
    io,
    path::{Path, PathBuf},
};

use super::{
    Problem,
    disk::{self, PART},
    hidden::Hidden,
    manifest::{AGAIN, Block},
    name::{HIDDEN, said},
    refusal::Refusal,
};
use crate::{identity::Identity, shard::Shard};

const CAMPAIGN: &str = "campaign";
const IDENTITY: &str = "identity.json";
const RECORD: &str = "record";
/// A text that tells those who go on how the campaign was begun.
const MARK: &str = "mark";
/// Tells that a rule looks at the runs while they are done, whoever goes on with them.
const LOOKED: &str = "looked";

/// A line of a record: a block, and of which campaign it is. Records that somebody copied into the folder of another campaign
/// tell of none of its blocks.
#[derive(Debug, Serialize, Deserialize)]
struct Line<C, B> {
    campaign: C,
    block: B,
}

/// The line of a record that tells of a block of the campaign with this word.
pub(super) fn line(campaign: &str, block: &Block) -> Result<String, Problem> {
    Ok(serde_json::to_string(&Line { campaign, block })?)
}

/// The folder of an unfinished campaign.
#[derive(Clone, Debug)]
pub(super) struct Area(PathBuf);

impl Area {
    /// That in a folder.
    pub(super) fn of(place: &Path) -> Self {
        Self::called(place, CAMPAIGN)
    }

    /// One beside it, of runs that are put nowhere.
    pub(super) fn called(place: &Path, name: &str) -> Self {
        Self(place.join(HIDDEN).join(name))
    }

    /// What it is called from the folder on.
    pub(super) fn name(&self) -> String {
        let name = self.0.file_name().unwrap_or_default().to_string_lossy();
        format!("{HIDDEN}/{name}")
    }

    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    /// Where a block is: in the folder of the complete campaign, or here; and its name from there on.
    pub(super) fn place_of<'a>(&'a self, block: &Block, complete: &'a Path) -> (&'a Path, String) {
        if block.published {
            (complete, block.name())
        } else {
            (&self.0, format!("{}/{}", block.model, block.file_before()))
        }
    }

    /// What the campaign is, if one was begun.
    pub(super) fn identity(&self) -> Result<Option<Identity>, Problem> {
        match disk::found(&self.0)? {
            None => return Ok(None),
            Some(found) if found.is_dir() => {}
            Some(found) => {
                let (name, is) = (self.name(), said(found.file_type()));
                return Err(Problem::Kind { name, is, should: "folder" });
            }
        }
        let name = format!("{}/{IDENTITY}", self.name());
        let unknown = |problem: String| Problem::Unknown { name, problem };
        let Some(text) = disk::read_if_there(&self.0.join(IDENTITY))? else { return Ok(None) };
        serde_json::from_slice(&text).map(Some).map_err(|error| unknown(error.to_string()))
    }

    /// Makes the folder, if it is not there, and tells in it what the campaign is, unless that is told already: of several who
    /// begin at the same time, with campaigns that may differ, one alone tells it, and the others are refused.
    pub(super) fn begin(&self, hidden: &Hidden, identity: &Identity) -> Result<(), Problem> {
        match disk::create_folder(&self.0) {
            Ok(()) => disk::sync_folder(&hidden.join(""))?,
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error.into()),
        }
        self.tell_first(IDENTITY, &serde_json::to_string_pretty(identity)?)?;
        match self.identity()?.and_then(|there| identity.difference(&there)) {
            Some(difference) => Err(Problem::Unfinished { difference }),
            None => Ok(()),
        }
    }

    /// Tells those who go on how the campaign was begun, once it is certain that it goes on so. What one shard tells holds for
    /// all of them.
    pub(super) fn tell(&self, mark: &str, shard: Option<Shard>) -> Result<(), Problem> {
        if shard.is_some() {
            return self.tell_first(MARK, mark);
        }
        match disk::read(&self.0.join(MARK)) {
            Ok(there) if there == mark.as_bytes() => return Ok(()),
            Err(error) if error.kind() == io::ErrorKind::InvalidInput => return Err(error.into()),
            Ok(_) | Err(_) => {}
        }
        self.replace(MARK, mark)?;
        Ok(disk::sync_folder(&self.0)?)
    }

    /// Makes a file with a text, unless there is one of that name.
    fn tell_first(&self, name: &str, text: &str) -> Result<(), Problem> {
        match disk::create_whole(&self.0.join(name), text) {
            Ok(()) => Ok(disk::sync_folder(&self.0)?),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Puts a text, synced, in the place of a file. Who does that has the folder alone.
    fn replace(&self, name: &str, text: &str) -> Result<(), Problem> {
        let part = self.0.join(format!("{name}{PART}"));
        disk::remove_file(&part)?;
        disk::write_new(&part, text)?;
        disk::sync_file(&part)?;
        Ok(disk::replace_file(&part, &self.0.join(name))?)
    }

    /// The text that tells how the campaign was begun, if it was.
    pub(super) fn mark(&self) -> Result<Option<String>, Refusal> {
        let path = self.0.join(MARK);
        if !disk::found(&path)?.is_some_and(|found| found.is_file()) {
            return Ok(None);
        }
        Ok(disk::read_if_there(&path)?.and_then(|text| String::from_utf8(text).ok()))
    }

    /// Tells that a rule looks at the runs.
    pub(super) fn tell_looked(&self) -> Result<(), Problem> {
        self.tell_first(LOOKED, "A rule looks at these runs while they are done.\n")
    }

    /// Whether a rule looked at the runs, or may have.
    pub(super) fn is_looked_at(&self) -> bool {
        fs::symlink_metadata(self.0.join(LOOKED)).is_ok()
    }

    /// The record of those who do all blocks, or of a shard, which only one process at a time holds.
    pub(super) fn record(&self, shard: Option<Shard>) -> Result<(PathBuf, File), Problem> {
        let name = shard.map_or_else(|| RECORD.to_owned(), |s| format!("{RECORD}-{}", s.name()));
        let path = self.0.join(&name);
        if let Some(found) = disk::found(&path)?
            && !found.is_file()
        {
            let (name, is) = (format!("{}/{name}", self.name()), said(found.file_type()));
            return Err(Problem::Kind { name, is, should: "file" });
        }
        let record = OpenOptions::new().append(true).create(true).open(&path);
        let record = record.map_err(Refusal::write(&path))?;
        if shard.is_some() {
            match record.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(Problem::Busy),
                Err(TryLockError::Error(error)) => return Err(Refusal::write(&path)(error).into()),
            }
        }
        Ok((path, record))
    }

    /// The names of all records.
    fn records(&self) -> Result<Vec<PathBuf>, Refusal> {
        let mut records = Vec::new();
        for entry in disk::entries(&self.0)? {
            if is_record(&entry.file_name().to_string_lossy()) && disk::kind(&entry)?.is_file() {
                records.push(entry.path());
            }
        }
        records.sort();
        Ok(records)
    }

    /// The blocks that the records tell of, each once; a line that was broken off tells of none, and none is known where nothing
    /// tells what the campaign is.
    pub(super) fn recorded(&self) -> Result<Vec<Block>, Problem> {
        let Some(campaign) = self.identity()?.map(|identity| identity.word()) else {
            return Ok(Vec::new());
        };
        let records = self.records()?;
        let texts = records.iter().map(|path| disk::read(path)).collect::<Result<Vec<_>, _>>()?;
        let mut seen = BTreeSet::new();
        let lines = texts.iter().flat_map(|text| text.split(|byte| *byte == b'\n'));
        let lines = lines.filter(|line| !line.is_empty() && seen.insert(*line));
        let lines =
            lines.filter_map(|line| serde_json::from_slice::<Line<String, Block>>(line).ok());
        let own = lines.filter(|line| line.campaign == campaign).map(|line| line.block);
        Ok(own.filter(Block::is_sound).collect())
    }

    /// Whether shards have left records.
    pub(super) fn has_shards(&self) -> Result<bool, Refusal> {
        Ok(self.records()?.iter().any(|path| !path.ends_with(RECORD)))
    }

    /// One record of these blocks in place of all.
    pub(super) fn rewrite(&self, identity: &Identity, blocks: &[&Block]) -> Result<File, Problem> {
        let campaign = identity.word();
        let lines =
            blocks.iter().map(|block| line(&campaign, block)).collect::<Result<Vec<_>, _>>()?;
        let path = self.0.join(RECORD);
        self.replace(RECORD, &(lines.join("\n") + "\n"))?;
        for record in self.records()?.iter().filter(|record| **record != path) {
            disk::remove_file(record)?;
        }
        disk::sync_folder(&self.0)?;
        Ok(OpenOptions::new().append(true).open(&path).map_err(Refusal::write(&path))?)
    }

    /// Removes this program's files of the campaign, and the folders if nothing else is in them.
    pub(super) fn clear(&self) -> Result<(), Refusal> {
        let folder = &self.0;
        let own = |name: &str| {
            let (stem, end) = name.split_once('.').unwrap_or((name, ""));
            let numbers = stem.split_once('-').is_some_and(|(first, last)| {
                [first, last].iter().all(|part| part.bytes().all(|byte| byte.is_ascii_digit()))
            });
            let again = end.starts_with(AGAIN) && end.ends_with(".parquet");
            numbers && (again || matches!(end, "parquet" | "part") || end.ends_with(PART))
        };
        let mut files = Vec::new();
        for entry in disk::entries(folder)? {
            if disk::kind(&entry)?.is_dir() {
                for block in disk::entries(&entry.path())? {
                    if own(&block.file_name().to_string_lossy()) && disk::kind(&block)?.is_file() {
                        disk::remove_file(&block.path())?;
                    }
                }
                disk::remove_folder(&entry.path())?;
            } else {
                let name = entry.file_name().to_string_lossy().into_owned();
                let is_own = [MARK, LOOKED, IDENTITY].contains(&name.as_str());
                if is_own || is_record(&name) || name.ends_with(PART) {
                    files.push(entry.path());
                }
            }
        }
        // The identity goes last: without it, nothing is known to be a block.
        files.sort_by_key(|path| path.ends_with(IDENTITY));
        for path in files {
            disk::remove_file(&path)?;
        }
        disk::remove_folder(folder)
    }
}

/// Whether a file of this name is the record of all, or of a shard.
fn is_record(name: &str) -> bool {
    let shard = name.strip_prefix(RECORD).and_then(|rest| rest.strip_prefix('-'));
    let numbers = shard.and_then(|shard| shard.split_once("-of-"));
    name == RECORD || numbers.is_some_and(|(i, n)| format!("{i}/{n}").parse::<Shard>().is_ok())
}
