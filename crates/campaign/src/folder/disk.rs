//! Every change that is made on the disk, and what is looked up there. No change writes through a link, nor replaces anything.
//! Tests see every step, and do not wait for the disk.

use std::{
    fs::{self, DirEntry, File, FileType, Metadata, OpenOptions},
    io,
    path::Path,
};
use tempfile::TempPath;

use super::refusal::Refusal;
use crate::hash::sha256_of_file;

/// How the name of a file ends that is being written; also of a program that was killed.
pub(super) const PART: &str = ".part";

/// Makes a folder; fails if anything of that name is there.
pub(super) fn create_folder(path: &Path) -> Result<(), Refusal> {
    step("create folder", path)?;
    fs::create_dir(path).map_err(Refusal::write(path))
}

/// Makes a file, open for reading and writing; fails if anything of that name is there.
pub(super) fn create_file(path: &Path) -> Result<File, Refusal> {
    step("create file", path)?;
    new_file(path).map_err(Refusal::write(path))
}

fn new_file(path: &Path) -> io::Result<File> {
    OpenOptions::new().read(true).write(true).create_new(true).open(path)
}

/// Makes a file with a text, which is not synced; fails if anything of that name is there.
pub(super) fn write_new(path: &Path, text: impl AsRef<[u8]>) -> Result<(), Refusal> {
    use io::Write;
    create_file(path)?.write_all(text.as_ref()).map_err(Refusal::write(path))
}

/// Makes a file with a text, which is there whole and synced, or not at all; fails if anything of that name is there.
pub(super) fn create_whole(path: &Path, text: &str) -> Result<(), Refusal> {
    use io::Write;
    // Most often somebody has made it before: then nothing is written.
    if !is_free(path) {
        return Err(Refusal::write(path)(io::ErrorKind::AlreadyExists.into()));
    }
    step("create file", path)?;
    // A name of its own: others may be making the same file at this moment.
    let mut part = tempfile::Builder::new();
    part.prefix(path.file_name().unwrap_or_default()).suffix(PART);
    let part = part.make_in(super::folder_of(path), new_file).map_err(Refusal::write(path))?;
    part.as_file().write_all(text.as_bytes()).map_err(Refusal::write(path))?;
    sync_file(part.path())?;
    let part = part.into_temp_path();
    // If that fails, it is removed as temporary files are.
    move_file(&part, path)?;
    let _ = part.keep();
    Ok(())
}

/// The content of a file, unless it is a pipe or something else that may never end.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, Refusal> {
    let read = || {
        if !fs::metadata(path)?.is_file() {
            let problem = "it is not a regular file";
            return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
        }
        fs::read(path)
    };
    read().map_err(Refusal::read(path))
}

/// The same; none if nothing is there, or not any more: others may be at work.
pub(super) fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>, Refusal> {
    if_there(read(path))
}

/// What was done with a file; none if it is not there.
pub(super) fn if_there<T>(done: Result<T, Refusal>) -> Result<Option<T>, Refusal> {
    match done {
        Err(refusal) if refusal.kind() == io::ErrorKind::NotFound => Ok(None),
        other => other.map(Some),
    }
}

/// The SHA-256 of a file in hexadecimal.
pub(super) fn hash(path: &Path) -> Result<String, Refusal> {
    sha256_of_file(path).map_err(Refusal::read(path))
}

/// What is at a path, and not what a link there leads to; none if nothing is.
pub(super) fn found(path: &Path) -> Result<Option<Metadata>, Refusal> {
    use io::ErrorKind::{NotADirectory, NotFound};
    match fs::symlink_metadata(path) {
        Ok(found) => Ok(Some(found)),
        Err(error) if matches!(error.kind(), NotFound | NotADirectory) => Ok(None),
        Err(error) => Err(Refusal::read(path)(error)),
    }
}

/// What is in a folder; nothing if there is none.
pub(super) fn entries(folder: &Path) -> Result<Vec<DirEntry>, Refusal> {
    match fs::read_dir(folder).and_then(Iterator::collect) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        read => read.map_err(Refusal::read(folder)),
    }
}

/// What an entry of a folder is, and not what it leads to.
pub(super) fn kind(entry: &DirEntry) -> Result<FileType, Refusal> {
    entry.file_type().map_err(Refusal::read(&entry.path()))
}

/// Moves a file; fails if anything is there.
pub(super) fn move_file(from: &Path, to: &Path) -> Result<(), Refusal> {
    moved(from, to).map_err(Refusal::write(to))
}

/// The same with a file of which the message is to tell, and not of its new place.
pub(super) fn move_away(from: &Path, to: &Path) -> Result<(), Refusal> {
    moved(from, to).map_err(Refusal::write(from))
}

fn moved(from: &Path, to: &Path) -> io::Result<()> {
    step("move", to)?;
    let moved = TempPath::try_from_path(from)?.persist_noclobber(to).map_err(|failed| {
        // Else the file would be removed, as temporary ones are.
        let _ = failed.path.keep();
        failed.error
    });
    match moved {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists && is_free(to) => {
            // Not every file system can move a file without the chance to replace another.
            fs::rename(from, to)
        }
        other => other,
    }
}

/// Moves a file to where an older one of the same is, in the folder that nobody else writes in.
pub(super) fn replace_file(from: &Path, to: &Path) -> Result<(), Refusal> {
    step("replace", to)?;
    fs::rename(from, to).map_err(Refusal::write(to))
}

/// Gives a file a second name, or copies it where that cannot be; fails if anything is there.
pub(super) fn link(from: &Path, to: &Path) -> Result<(), Refusal> {
    step("link", to)?;
    match fs::hard_link(from, to) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists && is_free(to) => {
            let mut from = File::open(from).map_err(Refusal::read(from))?;
            io::copy(&mut from, &mut create_file(to)?).map(drop).map_err(Refusal::write(to))
        }
        other => other.map_err(Refusal::write(to)),
    }
}

pub(super) fn is_free(path: &Path) -> bool {
    fs::symlink_metadata(path).is_err_and(|error| error.kind() == io::ErrorKind::NotFound)
}

/// Removes a file that may be gone already.
pub(super) fn remove_file(path: &Path) -> Result<(), Refusal> {
    step("remove", path)?;
    match fs::remove_file(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        other => other.map_err(Refusal::write(path)),
    }
}

/// Removes a folder that is empty; one that is not, or is gone already, stays so.
pub(super) fn remove_folder(path: &Path) -> Result<(), Refusal> {
    use io::ErrorKind::{DirectoryNotEmpty, NotADirectory, NotFound};
    step("remove folder", path)?;
    match fs::remove_dir(path) {
        Err(error) if matches!(error.kind(), DirectoryNotEmpty | NotADirectory | NotFound) => {
            Ok(())
        }
        other => other.map_err(Refusal::write(path)),
    }
}

/// Appends to an open file and brings it to the disk.
pub(super) fn append(mut file: &File, path: &Path, line: &str) -> Result<(), Refusal> {
    use io::Write;
    step("append", path)?;
    file.write_all(line.as_bytes()).and_then(|()| synced(file)).map_err(Refusal::write(path))
}

/// Brings the content of a file to the disk.
pub(super) fn sync_file(path: &Path) -> Result<(), Refusal> {
    step("sync", path)?;
    let file = OpenOptions::new().read(true).write(true).open(path);
    file.and_then(|file| synced(&file)).map_err(Refusal::write(path))
}

/// Brings the names in a folder to the disk.
pub(super) fn sync_folder(path: &Path) -> Result<(), Refusal> {
    step("sync folder", path)?;
    // Elsewhere than on Unix, folders cannot be opened, and their changes are in the system's journal.
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(path) {
        // One that may be written but not read: its names reach the disk without being waited for.
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => Ok(()),
        opened => opened.and_then(|folder| synced(&folder)).map_err(Refusal::write(path)),
    }
}

fn synced(file: &File) -> io::Result<()> {
    if cfg!(test) { Ok(()) } else { file.sync_all() }
}

/// A test may stop the program here.
#[cfg(test)]
fn step(what: &str, path: &Path) -> Result<(), Refusal> {
    super::tests::fuse::step(what, path).map_err(Refusal::write(path))
}

#[cfg(not(test))]
#[allow(clippy::unnecessary_wraps, reason = "what tests put in its place can fail")]
fn step(_what: &str, _path: &Path) -> Result<(), Refusal> {
    Ok(())
}
