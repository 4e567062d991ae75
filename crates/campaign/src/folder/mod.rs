//! The folder of a study or a comparison: written in full beside what is there, then put in its place.
//!
//! Three promises hold at every moment, also if the program is killed or the machine loses power:
//!
//! * Nothing is replaced or removed but files that this program wrote and that still have the content
//!   that it wrote: [`record`] lists them. Nothing is followed through a link below the folder.
//! * One whole study is in place, or the next command that uses the folder puts it there: [`journal`].
//! * What is called done is on the disk: every file and folder is synced before.
//!
//! The record, the journal, the lock and the draft are in the hidden folder `.gyradius`.

mod adopt;
mod area;
mod blocks;
mod disk;
mod finished;
mod hidden;
mod journal;
mod looked;
mod manifest;
mod name;
mod problem;
mod record;
mod refusal;
mod shared;
#[cfg(test)]
mod tests;
mod told;

use std::{
    fmt, fs,
    fs::File,
    io,
    path::{Path, PathBuf},
};

pub use adopt::Reduced;
pub use blocks::Blocks;
pub use finished::FinishedRuns;
use hidden::{Hidden, real_folder};
use journal::{Journal, Left, Replacement};
pub use manifest::{Block, MANIFEST, Manifest};
pub(crate) use manifest::{RUNS, damaged, is_zero};
pub use name::HIDDEN;
use name::{Found, Name, look};
pub use problem::FolderError;
pub(crate) use problem::Problem;
use record::Record;
use refusal::Refusal;
pub use shared::Shared;
pub use told::{begun, changed, missing_runs, replacing, told, told_runs, why_unknown};

/// Whether a text of the mark is that of the very same.
type Same<'a> = Box<dyn Fn(&str, Option<u64>) -> bool + 'a>;
/// Says in what a text of the mark differs from another.
type Telling<'a> = Box<dyn Fn(&str, Option<u64>) -> Option<String> + 'a>;

/// What goes into a folder.
pub struct Contents<'a> {
    /// What it is called, and its record after it.
    what: &'static str,
    /// The file that tells one from another, without which a folder is not whole.
    mark: &'static str,
    /// Files that are certain to be written, and folders, which end in `/`.
    certain: Vec<String>,
    /// Whether this text of the mark is that of the very same.
    same: Same<'a>,
    /// Which files that were written before stay as they are.
    kept: Box<dyn Fn(&str) -> bool + 'a>,
    /// In what another text of the mark differs.
    differs: Telling<'a>,
    /// Files that are checked when they are used, if the very same is there.
    trusted: fn(&str) -> bool,
}

impl<'a> Contents<'a> {
    /// `certain` are files that will be written, and folders, which end in `/`, so that what is in their way is found before the work
    /// begins; `same` tells whether a text of the file `mark` is that of what will be written. Both this and [`telling`](Self::telling) are told
    /// how many runs a model the complete campaign in the folder has, 0 if there is none, as far as that is known: a report of one that is not
    /// complete writes the mark, too.
    pub fn new(
        what: &'static str,
        mark: &'static str,
        certain: impl IntoIterator<Item = String>,
        same: impl Fn(&str, Option<u64>) -> bool + 'a,
    ) -> Self {
        let certain = certain.into_iter().collect();
        Self {
            what,
            mark,
            certain,
            same: Box::new(same),
            kept: Box::new(|_| false),
            differs: Box::new(|_, _| None),
            trusted: |_| false,
        }
    }

    /// Tells in what another text of the mark differs, for the message that refuses it.
    pub fn telling(self, differs: impl Fn(&str, Option<u64>) -> Option<String> + 'a) -> Self {
        Self { differs: Box::new(differs), ..self }
    }

    /// Leaves the check of these files to those who use them, if the very same is there.
    pub fn trusting(self, trusted: fn(&str) -> bool) -> Self {
        Self { trusted, ..self }
    }

    /// The same as a part of what was written before, of which these files stay as they are.
    pub fn keeping(self, kept: impl Fn(&str) -> bool + 'a) -> Self {
        Self { kept: Box::new(kept), ..self }
    }
}

impl fmt::Debug for Contents<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Contents").field("what", &self.what).finish_non_exhaustive()
    }
}

/// A folder being prepared. Dropped before it is published, it leaves no trace but the blocks of runs that were
/// finished.
#[derive(Debug)]
pub struct Folder<'a> {
    contents: &'a Contents<'a>,
    /// As it was given.
    place: PathBuf,
    hidden: Hidden,
    journal: Journal,
    /// Whether the folder did not exist before.
    made: bool,
    /// Whether the folder and the hidden one stay, with or without a study.
    stays: bool,
}

impl<'a> Folder<'a> {
    /// Checks that it may go to `place` and can be written there, before anything is
    /// computed, keeps others out, and first settles what a command before it left unfinished.
    pub fn prepare(
        place: &Path,
        contents: &'a Contents<'a>,
        force: bool,
    ) -> Result<Self, FolderError> {
        let refused = |problem: Problem| FolderError { path: place.to_owned(), problem };
        // Asked once: another shard may take the folder away between two questions.
        let made = match fs::metadata(place) {
            Ok(there) if there.is_dir() => false,
            Ok(_) => return Err(refused(Problem::NoFolder)),
            Err(_) => true,
        };
        let is_new = || Ok(!made && !Hidden::is_in(place)?);
        if is_new().map_err(|refusal: Refusal| refused(refusal.into()))? {
            // Before the first file is made in a folder that is not this program's.
            check(place, contents, &Record::default(), force).map_err(refused)?;
        }
        make_folder(place).map_err(refused)?;
        let hidden = Hidden::lock(place).map_err(|problem| {
            if made {
                // Goes only if empty.
                let _ = fs::remove_dir(place);
            }
            refused(problem)
        })?;
        let journal = journal::settle_left(&hidden).and_then(|()| {
            let (record, _) = hidden.record(contents.what)?;
            check(hidden.place(), contents, &record, force)?;
            Journal::start(&hidden)
        });
        match journal {
            Ok(journal) => {
                let place = place.to_owned();
                Ok(Self { contents, place, hidden, journal, made, stays: false })
            }
            Err(problem) => {
                abandon(&hidden, made);
                Err(refused(problem))
            }
        }
    }

    /// Where it is.
    #[must_use]
    pub fn place(&self) -> &Path {
        &self.place
    }

    /// Writes a file, making the folders above it. It is in the draft until it is published.
    pub fn write(&mut self, name: &str, content: &str) -> Result<(), FolderError> {
        let written = Name::new(name)
            .map_err(Problem::Name)
            .and_then(|name| self.journal.write(&self.hidden, name, content));
        written.map_err(|problem| self.failed(problem))
    }

    /// Opens a new file for writing, making the folders above it. It is in the draft until it is
    /// published.
    pub fn create(&mut self, name: &str) -> Result<File, FolderError> {
        let name = Name::new(name).map_err(|error| self.failed(Problem::Name(error)))?;
        self.journal.create(&self.hidden, name).map_err(|problem| self.failed(problem))
    }

    fn failed(&self, problem: Problem) -> FolderError {
        FolderError { path: self.place.clone(), problem }
    }

    /// Whether every file that was written there is there as it was, the mark with this text; but for those whose check is
    /// left to those who use them.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn is_whole(&self, mark: &str) -> Result<bool, FolderError> {
        let whole = || {
            let (record, hash) = self.hidden.record(self.contents.what)?;
            let place = self.hidden.place();
            let is_mark = disk::read(&place.join(self.contents.mark))? == mark.as_bytes();
            for name in record.names().filter(|name| !(self.contents.trusted)(&name.to_string())) {
                match look(place, name)? {
                    Found::File { hash } if record.hash(name) == Some(&hash) => {}
                    Found::File { .. } | Found::Nothing | Found::Other { .. } => return Ok(false),
                }
            }
            Ok(is_mark && hash.is_some())
        };
        match whole() {
            Err(Problem::Refused(error)) if error.kind() == io::ErrorKind::NotFound => Ok(false),
            other => other.map_err(|problem: Problem| self.failed(problem)),
        }
    }

    /// Puts the draft in place of the files of the one that was there, and of nothing else. If
    /// that fails half-way, what was there is put back. Others are kept out until this is dropped.
    pub fn publish(&mut self) -> Result<PathBuf, FolderError> {
        self.put().map_err(|problem| self.failed(problem))?;
        self.stays = true;
        Ok(self.place.clone())
    }

    /// Removes the blocks of a campaign that is put nowhere, if some are left.
    ///
    /// # Errors
    /// One cannot be removed.
    pub fn clear_beside(&self, name: &str) -> Result<(), FolderError> {
        let cleared = area::Area::called(self.hidden.place(), name).clear();
        cleared.map_err(|error| self.failed(error.into()))
    }

    /// Lets go of an empty folder that others are about to fill: to take it away would take it from under them.
    fn leave(mut self) {
        self.journal.abandon(&self.hidden);
        self.stays = true;
    }

    fn put(&mut self) -> Result<(), Problem> {
        let Contents { what, mark, kept, .. } = self.contents;
        let (old, old_hash) = self.hidden.record(what)?;
        let new = self.journal.written(&self.hidden, &old)?;
        // Asked again, for hours may have passed.
        unobstructed(self.hidden.place(), &old, new.names())?;
        let (stays, old) = old.split(kept);
        let new = new.in_folders_of(&stays);
        let text = stays.and(&new).to_json()?;
        let name = Hidden::record_name(what);
        self.journal.write(&self.hidden, name.clone(), &text)?;
        let replacement =
            Replacement::new(Name::new(mark)?, &name, (&old, old_hash), (&new, &text));
        self.journal.replace(&self.hidden, replacement)
    }
}

impl Drop for Folder<'_> {
    fn drop(&mut self) {
        // What fails here leaves hidden files behind, which the next command removes.
        if !self.stays {
            self.journal.abandon(&self.hidden);
            abandon(&self.hidden, self.made);
        }
    }
}

/// Makes a folder and those above it, and brings their names to the disk.
fn make_folder(place: &Path) -> Result<(), Problem> {
    let missing: Vec<_> = place.ancestors().take_while(|above| !above.exists()).collect();
    fs::create_dir_all(place).map_err(|error| {
        let leads_nowhere = place.is_symlink() && !place.exists();
        if leads_nowhere { Problem::Link } else { Refusal::write(place)(error).into() }
    })?;
    for made in missing {
        disk::sync_folder(folder_of(made))?;
    }
    Ok(())
}

/// Leaves no trace in a folder in which nothing was published.
fn abandon(hidden: &Hidden, made: bool) {
    hidden.remove_if_new();
    if made {
        // Goes only if empty.
        let _ = disk::remove_folder(hidden.place());
    }
}

/// Puts one whole study in place if a command was killed while it replaced one by another, removes the
/// draft of one that was killed before, and touches nothing else. For commands that read a folder.
pub fn restore(place: &Path) -> Result<(), FolderError> {
    let refused = |problem: Problem| FolderError { path: place.to_owned(), problem };
    // Where that cannot be asked, nothing can be read either, and who reads tells it.
    if !matches!(Hidden::is_in(place), Ok(true)) {
        return Ok(());
    }
    let Some(left) = journal::left(place).map_err(refused)? else { return Ok(()) };
    let result = Hidden::lock(place).and_then(|hidden| journal::settle_left(&hidden));
    match (result, left) {
        (Ok(()), _) => Ok(()),
        // The one who holds the lock settles it.
        (Err(Problem::Busy), _) => Ok(()),
        // A draft harms nobody who only reads, perhaps in a folder that is not to be written.
        (Err(_), Left::Draft) => Ok(()),
        (Err(problem), Left::Replacement) => Err(refused(problem)),
    }
}

/// As [`restore`], for the folder that a file is in, or for a folder and all those below it, through no
/// link.
pub fn restore_all(path: &Path) -> Result<(), FolderError> {
    if !path.is_dir() {
        return restore(folder_of(path));
    }
    let mut folders = vec![path.to_owned()];
    while let Some(folder) = folders.pop() {
        restore(&folder)?;
        // What cannot be read holds nothing that could be mended.
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            let hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
            if !hidden && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                folders.push(entry.path());
            }
        }
    }
    Ok(())
}

/// The folder that a file is in.
pub fn folder_of(file: &Path) -> &Path {
    // The folder of a name without one is the current folder.
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// What is in the way, if anything is.
fn check(
    place: &Path,
    contents: &Contents<'_>,
    record: &Record,
    force: bool,
) -> Result<(), Problem> {
    let mut occupied = false;
    for entry in disk::entries(place)? {
        occupied |= entry.file_name() != HIDDEN;
    }
    let (folders, files): (Vec<_>, Vec<_>) =
        contents.certain.iter().partition(|name| name.ends_with('/'));
    for name in folders.iter().map(|name| name.trim_end_matches('/')) {
        real_folder(&place.join(name), || name.to_owned())?;
    }
    let files = files.iter().map(|name| Name::new(name)).collect::<Result<Vec<_>, _>>()?;
    let mark = Name::new(contents.mark)?;
    // Read only if it is the file that was written, and not a pipe, say.
    let in_the_way = match unobstructed(place, record, [&mark]) {
        // What it is is not known.
        Err(refused @ Problem::Refused(_)) => return Err(refused),
        other => other,
    };
    let known = in_the_way.is_ok() && record.has(&mark);
    let text = || fs::read_to_string(mark.below(place));
    let runs = complete_runs(place, record)?;
    let same = known && text().is_ok_and(|text| (contents.same)(&text, runs));
    // Of a campaign that is not complete, the mark is not there yet; other files may stand beside it.
    let begun = if known { None } else { told::text_of_begun(place)? };
    let goes_on = begun.as_deref().is_some_and(|text| (contents.same)(text, runs));
    if occupied && !same && !goes_on && !force {
        if let Err(changed @ Problem::Changed { .. }) = in_the_way {
            return Err(changed);
        }
        let difference = if known { text().ok() } else { begun };
        if !mark.below(place).exists() && difference.is_none() && record.has(&mark) {
            return Err(Problem::Gone { name: mark, what: contents.what });
        }
        let difference = difference.and_then(|text| (contents.differs)(&text, runs));
        return Err(match difference {
            Some(difference) => Problem::Other { what: contents.what, difference },
            None => Problem::Occupied { what: contents.what },
        });
    }
    let checked = record.names().filter(|name| !(same && (contents.trusted)(&name.to_string())));
    unobstructed(place, record, files.iter().chain(checked))
}

/// How many runs a model the complete campaign has that a record tells of, 0 if it tells of none; nothing if that cannot be read.
fn complete_runs(place: &Path, record: &Record) -> Result<Option<u64>, Problem> {
    if !record.has(&Name::new(MANIFEST)?) {
        return Ok(Some(0));
    }
    let blocks = Manifest::read(place).map(Manifest::into_blocks);
    Ok(blocks.ok().map(|blocks| blocks.map(|block| block.range().end).max().unwrap_or(0)))
}

/// That nothing is in the way of these files but what the record knows.
fn unobstructed<'n>(
    place: &Path,
    record: &Record,
    names: impl IntoIterator<Item = &'n Name>,
) -> Result<(), Problem> {
    for name in names {
        match (look(place, name)?, record.hash(name)) {
            (Found::Nothing, _) => {}
            (Found::File { hash }, Some(recorded)) if hash == recorded => {}
            (Found::File { .. }, Some(_)) => return Err(Problem::Changed { name: name.clone() }),
            (Found::File { .. }, None) => return Err(Problem::Foreign { name: name.clone() }),
            (Found::Other { name, is, should }, _) => {
                return Err(Problem::Kind { name, is, should });
            }
        }
    }
    Ok(())
}
