//! The journal of a folder: what is being drafted, and which files are to replace which.
//!
//! A line is appended and synced before what it tells of is done, so that the next command knows what a
//! killed one was about. Before the line `replace`, the old files are in place and whole; after it, the
//! new ones are put in place, or the old ones back, however often that is broken off; after the line
//! `settled`, all that remains is to be removed.

use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{File, OpenOptions},
    path::{Path, PathBuf},
};

use super::{
    Problem, disk,
    hidden::{Hidden, be_folder},
    name::{Found, HIDDEN, Name, look, said},
    record::Record,
    refusal::Refusal,
};
use crate::hash::sha256;

const JOURNAL: &str = "journal";
const DRAFT: &str = "draft";
const ASIDE: &str = "aside";
/// How every journal begins: what does not is not this program's.
const BEGINNING: &str = "\n{\"draft\":\"";

/// The journal, open for appending.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    /// Files of the draft.
    drafts: Vec<Name>,
    /// Hashes of those that were whole before.
    hashes: BTreeMap<Name, String>,
    replacement: Option<Replacement>,
    settled: bool,
}

/// A line of the journal.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    Draft(Name),
    Replace(Replacement),
    Settled,
}

/// Files with their hashes, and folders that are made with them, before and after.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Replacement {
    /// The file without which a folder is not whole.
    mark: Name,
    old: Record,
    new: Record,
}

impl Replacement {
    /// The records themselves are files that are replaced with the others.
    pub(super) fn new(
        mark: Name,
        record: &Name,
        (old, old_hash): (&Record, Option<String>),
        (new, new_text): (&Record, &str),
    ) -> Self {
        let with = |known: &Record, hash: Option<String>| {
            let mut files = known.files().clone();
            files.extend(hash.map(|hash| (record.clone(), hash)));
            Record::new(files, known.folders().clone())
        };
        Self { mark, old: with(old, old_hash), new: with(new, Some(sha256(new_text))) }
    }

    /// The old files, the mark first: a folder without one is not whole.
    fn old(&self) -> impl Iterator<Item = &Name> {
        let mark = self.old.names().filter(|name| **name == self.mark);
        mark.chain(self.old.names().filter(|name| **name != self.mark))
    }

    /// The new files, the mark last: a folder with one is whole.
    fn new_files(&self) -> impl Iterator<Item = &Name> {
        let mark = self.new.names().filter(|name| **name == self.mark);
        self.new.names().filter(|name| **name != self.mark).chain(mark)
    }
}

impl Journal {
    fn of(path: PathBuf, file: File) -> Self {
        let (drafts, hashes) = (Vec::new(), BTreeMap::new());
        Self { path, file, drafts, hashes, replacement: None, settled: false }
    }

    /// Begins a draft.
    pub(super) fn start(hidden: &Hidden) -> Result<Self, Problem> {
        for name in [DRAFT, ASIDE] {
            if disk::found(&hidden.join(name))?.is_some() {
                let name = format!("{HIDDEN}/{name}");
                let problem = "no journal tells of it".to_owned();
                return Err(Problem::Unknown { name, problem });
            }
        }
        let path = hidden.join(JOURNAL);
        let file = disk::create_file(&path)?;
        let journal = Self::of(path, file);
        disk::sync_folder(&hidden.join(""))?;
        disk::sync_folder(hidden.place())?;
        disk::create_folder(&hidden.join(DRAFT))?;
        Ok(journal)
    }

    /// The journal that a killed command left, if there is one.
    fn left(hidden: &Hidden) -> Result<Option<Self>, Problem> {
        let Some(lines) = read(hidden.place())? else { return Ok(None) };
        let path = hidden.join(JOURNAL);
        let file = OpenOptions::new().append(true).open(&path).map_err(Refusal::write(&path))?;
        let mut journal = Self::of(path, file);
        for line in lines {
            match line {
                Line::Draft(name) => journal.drafts.push(name),
                Line::Replace(replacement) => journal.replacement = Some(replacement),
                Line::Settled => journal.settled = true,
            }
        }
        Ok(Some(journal))
    }

    fn append(&self, line: &Line) -> Result<(), Problem> {
        // The line break is in front as well: what was broken off is a line of its own.
        let text = format!("\n{}\n", serde_json::to_string(line)?);
        Ok(disk::append(&self.file, &self.path, &text)?)
    }

    /// Makes a file in the draft.
    pub(super) fn create(&mut self, hidden: &Hidden, name: Name) -> Result<File, Problem> {
        Ok(disk::create_file(&self.announce(hidden, name)?)?)
    }

    /// Writes a file of the draft.
    pub(super) fn write(
        &mut self,
        hidden: &Hidden,
        name: Name,
        content: impl AsRef<[u8]>,
    ) -> Result<(), Problem> {
        Ok(disk::write_new(&self.announce(hidden, name)?, content)?)
    }

    /// Links a file that is whole, and has a hash, into the draft; copies it where files cannot be linked.
    pub(super) fn link(
        &mut self,
        hidden: &Hidden,
        name: Name,
        from: &Path,
        hash: &str,
    ) -> Result<(), Problem> {
        let to = self.announce(hidden, name.clone())?;
        disk::link(from, &to)?;
        self.hashes.insert(name, hash.to_owned());
        Ok(())
    }

    /// Tells of a file before it is made in the draft, and where that will be.
    fn announce(&mut self, hidden: &Hidden, name: Name) -> Result<PathBuf, Problem> {
        self.append(&Line::Draft(name.clone()))?;
        let draft = hidden.join(DRAFT);
        make_folders(&draft, &name)?;
        let path = name.below(&draft);
        self.drafts.push(name);
        Ok(path)
    }

    /// The files of the draft, and the folders that have to be made for them.
    pub(super) fn written(&self, hidden: &Hidden, old: &Record) -> Result<Record, Problem> {
        let (mut files, mut folders) = (BTreeMap::new(), BTreeSet::new());
        for name in &self.drafts {
            let hash = match self.hashes.get(name) {
                Some(known) => known.clone(),
                None => disk::hash(&name.below(&hidden.join(DRAFT)))?,
            };
            files.insert(name.clone(), hash);
            for above in name.folders() {
                let there = disk::found(&above.below(hidden.place()))?;
                if there.is_none() || old.folders().contains(&above) {
                    folders.insert(above);
                }
            }
        }
        Ok(Record::new(files, folders))
    }

    /// Puts the draft, synced, in place of the old files.
    pub(super) fn replace(
        &mut self,
        hidden: &Hidden,
        replacement: Replacement,
    ) -> Result<(), Problem> {
        let draft = hidden.join(DRAFT);
        for name in &self.drafts {
            disk::sync_file(&name.below(&draft))?;
        }
        sync_folders(&draft, self.drafts.iter())?;
        disk::sync_folder(&hidden.join(""))?;
        let begun = self.append(&Line::Replace(replacement.clone()));
        // Whatever the disk has of that line, the draft stays until the next one is there.
        self.replacement = Some(replacement);
        if let Err(problem) = begun {
            self.append(&Line::Settled)?;
            self.settled = true;
            return Err(problem);
        }
        match self.settle(hidden)? {
            None => self.tidy(hidden),
            Some(problem) => {
                self.tidy(hidden)?;
                Err(problem)
            }
        }
    }

    /// Puts the new files in place, or the old ones back and says why.
    fn settle(&mut self, hidden: &Hidden) -> Result<Option<Problem>, Problem> {
        let Some(replacement) = self.replacement.as_ref().filter(|_| !self.settled) else {
            return Ok(None);
        };
        let result = match forward(hidden, replacement) {
            Ok(()) => None,
            Err(problem) => match backward(hidden, replacement) {
                Ok(()) => Some(problem),
                Err(_) => return Err(Problem::Stuck { problem: Box::new(problem) }),
            },
        };
        self.append(&Line::Settled)?;
        self.settled = true;
        Ok(result)
    }

    /// Removes what is left of the draft and of the old files, and the journal.
    fn tidy(&self, hidden: &Hidden) -> Result<(), Problem> {
        let old = self.replacement.iter().flat_map(|r| r.old.names());
        empty(&hidden.join(DRAFT), self.drafts.iter())?;
        empty(&hidden.join(ASIDE), old)?;
        disk::sync_folder(&hidden.join(""))?;
        disk::remove_file(&self.path)?;
        Ok(disk::sync_folder(&hidden.join(""))?)
    }

    /// Removes the draft if nothing was to be replaced by it yet.
    pub(super) fn abandon(&self, hidden: &Hidden) {
        if self.replacement.is_none() || self.settled {
            // The next command removes what stays.
            let _ = self.tidy(hidden);
        }
    }
}

/// Finishes what a killed command left. The folder is whole then.
pub(super) fn settle_left(hidden: &Hidden) -> Result<(), Problem> {
    match Journal::left(hidden)? {
        None => Ok(()),
        Some(mut journal) => {
            // Whether the new files or the old ones are in place, they are whole.
            journal.settle(hidden)?;
            journal.tidy(hidden)
        }
    }
}

/// What a command left that was killed, or that is still at work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Left {
    /// Files that nobody sees; the folder is whole.
    Draft,
    /// The folder is not whole until the journal is settled.
    Replacement,
}

/// What a journal tells of, if there is one.
pub(super) fn left(place: &Path) -> Result<Option<Left>, Problem> {
    let Some(lines) = read(place)? else { return Ok(None) };
    let replaces = lines.iter().any(|line| matches!(line, Line::Replace(_)));
    let settled = lines.iter().any(|line| matches!(line, Line::Settled));
    Ok(Some(if replaces && !settled { Left::Replacement } else { Left::Draft }))
}

/// The lines of a journal; the last one is not there if it was broken off.
fn read(place: &Path) -> Result<Option<Vec<Line>>, Problem> {
    let name = format!("{HIDDEN}/{JOURNAL}");
    let unknown = |problem: String| Problem::Unknown { name: name.clone(), problem };
    let path = place.join(&name);
    match disk::found(&path)? {
        None => return Ok(None),
        Some(found) if found.is_file() => {}
        Some(found) => return Err(unknown(format!("a {}", said(found.file_type())))),
    }
    let Some(bytes) = disk::read_if_there(&path)? else { return Ok(None) };
    let shared = bytes.len().min(BEGINNING.len());
    if bytes[..shared] != BEGINNING.as_bytes()[..shared] {
        return Err(unknown("it is no journal".to_owned()));
    }
    let mut lines = Vec::new();
    let mut texts = bytes.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()).peekable();
    while let Some(text) = texts.next() {
        match serde_json::from_slice(text) {
            Ok(line) => lines.push(line),
            // Broken off in the middle of a line, after which a power failure leaves anything.
            Err(error) if error.is_eof() || texts.peek().is_none() => {}
            Err(error) => return Err(unknown(error.to_string())),
        }
    }
    Ok(Some(lines))
}

/// Puts old files aside and new ones in place. May be done again after it was broken off.
fn forward(hidden: &Hidden, replacement: &Replacement) -> Result<(), Problem> {
    let (place, draft, aside) = (hidden.place(), hidden.join(DRAFT), hidden.join(ASIDE));
    be_folder(&aside, || format!("{HIDDEN}/{ASIDE}"))?;
    for name in replacement.old() {
        let installed = replacement.new.has(name) && disk::found(&name.below(&draft))?.is_none();
        if installed || disk::found(&name.below(&aside))?.is_some() {
            continue;
        }
        match look(place, name)? {
            Found::File { hash } if Some(hash.as_str()) == replacement.old.hash(name) => {
                make_folders(&aside, name)?;
                disk::move_away(&name.below(place), &name.below(&aside))?;
            }
            // Gone, or the user's by now: it is left alone unless a new file is to stand there.
            Found::Nothing | Found::File { .. } | Found::Other { .. } => {}
        }
    }
    for name in replacement.new_files() {
        if disk::found(&name.below(&draft))?.is_some() {
            install(&draft, place, name)?;
        }
    }
    remove_folders(place, replacement.old.folders(), replacement.new.folders())?;
    sync_replaced(hidden, replacement)
}

/// Puts new files back into the draft and old ones in place. May be done again after it was broken
/// off, also half-way forward.
fn backward(hidden: &Hidden, replacement: &Replacement) -> Result<(), Problem> {
    let (place, draft, aside) = (hidden.place(), hidden.join(DRAFT), hidden.join(ASIDE));
    for name in replacement.new_files() {
        if disk::found(&name.below(&draft))?.is_some() {
            continue;
        }
        match look(place, name)? {
            Found::File { hash } if Some(hash.as_str()) == replacement.new.hash(name) => {
                disk::move_away(&name.below(place), &name.below(&draft))?;
            }
            Found::Nothing | Found::File { .. } | Found::Other { .. } => {}
        }
    }
    for name in replacement.old() {
        if disk::found(&name.below(&aside))?.is_some() {
            install(&aside, place, name)?;
        }
    }
    remove_folders(place, replacement.new.folders(), replacement.old.folders())?;
    sync_replaced(hidden, replacement)
}

/// Moves a file into place, where nothing may be.
fn install(from: &Path, place: &Path, name: &Name) -> Result<(), Problem> {
    match look(place, name)? {
        Found::Nothing => {
            make_folders(place, name)?;
            Ok(disk::move_file(&name.below(from), &name.below(place))?)
        }
        Found::File { .. } => Err(Problem::Foreign { name: name.clone() }),
        Found::Other { name, is, should } => Err(Problem::Kind { name, is, should }),
    }
}

fn sync_replaced(hidden: &Hidden, replacement: &Replacement) -> Result<(), Problem> {
    let names = replacement.old.names().chain(replacement.new.names());
    sync_folders(hidden.place(), names)?;
    Ok(disk::sync_folder(&hidden.join(ASIDE))?)
}

/// Removes these files, the folders above them and the folder itself, where all that empties it.
fn empty<'n>(folder: &Path, names: impl Iterator<Item = &'n Name>) -> Result<(), Problem> {
    if disk::found(folder)?.is_none() {
        return Ok(());
    }
    let mut folders = BTreeSet::new();
    for name in names {
        // Never through a link, nor what is no file.
        if let Found::File { .. } = look(folder, name)? {
            disk::remove_file(&name.below(folder))?;
        }
        folders.extend(name.folders());
    }
    remove_folders(folder, &folders, &BTreeSet::new())?;
    disk::remove_folder(folder)?;
    if disk::found(folder)?.is_none() {
        return Ok(());
    }
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    let name = format!("{HIDDEN}/{name}");
    Err(Problem::Unknown { name, problem: "it holds files that no journal tells of".to_owned() })
}

/// Removes folders that are empty and not to be kept, the innermost first.
fn remove_folders(
    place: &Path,
    names: &BTreeSet<Name>,
    kept: &BTreeSet<Name>,
) -> Result<(), Problem> {
    for name in names.iter().rev().filter(|name| !kept.contains(name)) {
        if disk::found(&name.below(place))?.is_some_and(|found| found.is_dir()) {
            disk::remove_folder(&name.below(place))?;
        }
    }
    Ok(())
}

fn make_folders(root: &Path, name: &Name) -> Result<(), Problem> {
    name.folders().try_for_each(|above| be_folder(&above.below(root), || above.to_string()))
}

/// The folder and those in it that these files are in.
fn sync_folders<'n>(root: &Path, names: impl Iterator<Item = &'n Name>) -> Result<(), Problem> {
    let folders: BTreeSet<Name> = names.flat_map(Name::folders).collect();
    for folder in folders.iter().rev().map(|name| name.below(root)).filter(|f| f.is_dir()) {
        disk::sync_folder(&folder)?;
    }
    Ok(disk::sync_folder(root)?)
}
