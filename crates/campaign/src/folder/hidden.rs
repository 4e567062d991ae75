//! The hidden folder `.gyradius` in a folder: lock, records, journal, draft, and what is put aside.

use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io,
    path::{Path, PathBuf},
};

use super::{
    Problem, disk,
    name::{HIDDEN, Name, said},
    record::Record,
    refusal::Refusal,
};
use crate::hash::sha256;

/// The hidden folder, held by a lock until it is dropped; the system gives the lock back if the program
/// dies.
#[derive(Debug)]
pub(super) struct Hidden {
    /// The folder that it is in.
    place: PathBuf,
    /// Held, never written.
    lock: File,
    /// Whether it did not exist before.
    made: bool,
    /// Whether its lock did not.
    made_lock: bool,
}

impl Hidden {
    /// Whether a folder has something of that name, whatever it is.
    pub(super) fn is_in(place: &Path) -> Result<bool, Refusal> {
        Ok(disk::found(&place.join(HIDDEN))?.is_some())
    }

    /// Makes it if need be and locks it. The lock is a file that is empty for ever: it is made if there
    /// is none, and else opened without a change.
    pub(super) fn lock(place: &Path) -> Result<Self, Problem> {
        Self::locked_by(place, File::try_lock)
    }

    /// The same, with others who share it.
    pub(super) fn share(place: &Path) -> Result<Self, Problem> {
        Self::locked_by(place, File::try_lock_shared)
    }

    fn locked_by(
        place: &Path,
        take: fn(&File) -> Result<(), TryLockError>,
    ) -> Result<Self, Problem> {
        match Self::taken_by(place, take) {
            // Who held it has just removed it with the folder.
            Err(Problem::Refused(error)) if error.kind() == io::ErrorKind::NotFound => {
                Err(Problem::Busy)
            }
            other => other,
        }
    }

    fn taken_by(
        place: &Path,
        take: fn(&File) -> Result<(), TryLockError>,
    ) -> Result<Self, Problem> {
        // The folder that is meant now stays meant, whatever becomes of links on the way to it.
        let place = fs::canonicalize(place).map_err(Refusal::read(place))?;
        let made = match disk::create_folder(&place.join(HIDDEN)) {
            Ok(()) => true,
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => false,
            Err(error) => return Err(error.into()),
        };
        real_folder(&place.join(HIDDEN), || HIDDEN.to_owned())?;
        let path = place.join(HIDDEN).join("lock");
        let (lock, made_lock) = match disk::create_file(&path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                (open_lock(&path)?, false)
            }
            other => (other?, true),
        };
        match take(&lock) {
            Ok(()) if is_at(&lock, &path)? => Ok(Self { place, lock, made, made_lock }),
            // Who held it has just removed it with the folder.
            Ok(()) | Err(TryLockError::WouldBlock) => Err(Problem::Busy),
            Err(TryLockError::Error(error)) => Err(Refusal::write(&path)(error).into()),
        }
    }

    /// The folder that it is in.
    pub(super) fn place(&self) -> &Path {
        &self.place
    }

    /// A file or folder in it.
    pub(super) fn join(&self, name: &str) -> PathBuf {
        self.place.join(HIDDEN).join(name)
    }

    /// The name of a record from the folder that the hidden one is in.
    pub(super) fn record_name(what: &str) -> Name {
        Name::record(what)
    }

    /// What was written of this kind and the hash of its record, which is none if nothing was.
    pub(super) fn record(&self, what: &str) -> Result<(Record, Option<String>), Problem> {
        Self::record_of(&self.place, what)
    }

    /// The same of a folder that is not locked, for those who only read.
    pub(super) fn record_of(place: &Path, what: &str) -> Result<(Record, Option<String>), Problem> {
        let name = Self::record_name(what);
        let path = name.below(place);
        let unknown = |problem: String| Problem::Unknown { name: name.to_string(), problem };
        match disk::found(&path)? {
            None => return Ok((Record::default(), None)),
            Some(found) if found.is_file() => {}
            Some(found) => return Err(unknown(format!("a {}", said(found.file_type())))),
        }
        let Some(text) = disk::read_if_there(&path)? else {
            return Ok((Record::default(), None));
        };
        let record = serde_json::from_slice(&text).map_err(|error| unknown(error.to_string()))?;
        Ok((record, Some(sha256(&text))))
    }

    /// Lets others have it.
    pub(super) fn unlock(&self) {
        // Closing is not enough while a child process that has just been started holds the same file.
        let _ = self.lock.unlock();
    }

    /// The same, as what was made for this.
    pub(super) fn made_anew(mut self) -> Self {
        (self.made, self.made_lock) = (true, true);
        self
    }

    /// Takes it away again if it was made for nothing.
    pub(super) fn remove_if_new(&self) {
        // What stays is hidden and harms nothing.
        if self.made_lock {
            let _ = disk::remove_file(&self.join("lock"));
        }
        if self.made {
            // Goes only if it is empty.
            let _ = disk::remove_folder(&self.place.join(HIDDEN));
        }
    }
}

impl Drop for Hidden {
    fn drop(&mut self) {
        self.unlock();
    }
}

/// Opens a lock that is there.
fn open_lock(path: &Path) -> Result<File, Problem> {
    let metadata = fs::symlink_metadata(path).map_err(Refusal::read(path))?;
    if !metadata.is_file() || metadata.len() > 0 {
        let name = format!("{HIDDEN}/lock");
        let problem = "it should be an empty file".to_owned();
        return Err(Problem::Unknown { name, problem });
    }
    // Some network file systems lock only what is open for writing. Nothing is written.
    Ok(OpenOptions::new().read(true).write(true).open(path).map_err(Refusal::write(path))?)
}

/// Whether a file is still the one at its path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> Result<bool, Refusal> {
    use std::os::unix::fs::MetadataExt;
    let file = file.metadata().map_err(Refusal::read(path))?;
    let there = disk::found(path)?;
    Ok(there.is_some_and(|there| (file.dev(), file.ino()) == (there.dev(), there.ino())))
}

/// Whether a file is still the one at its path: elsewhere than on Unix, an open file stays.
#[cfg(not(unix))]
fn is_at(_file: &File, path: &Path) -> Result<bool, Refusal> {
    Ok(disk::found(path)?.is_some())
}

/// Makes a folder, unless one is there. A link to one is none: nothing is written through it.
pub(super) fn be_folder(path: &Path, name: impl FnOnce() -> String) -> Result<(), Problem> {
    if disk::is_free(path) {
        match disk::create_folder(path) {
            // Another shard has made it.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            made => return Ok(made?),
        }
    }
    real_folder(path, name)
}

/// That nothing but a folder is there, if anything is: what stands behind a link is not the program's.
pub(super) fn real_folder(path: &Path, name: impl FnOnce() -> String) -> Result<(), Problem> {
    match disk::found(path)? {
        Some(found) if !found.is_dir() => {
            let is = said(found.file_type());
            Err(Problem::Kind { name: name(), is, should: "folder" })
        }
        Some(_) | None => Ok(()),
    }
}
