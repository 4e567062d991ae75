//! Every change that is made on the disk. None of them writes through a link, nor replaces anything.
//! Tests see every step, and do not wait for the disk.

use std::{
    fs::{self, File, OpenOptions},
    io,
    path::Path,
};
use tempfile::TempPath;

/// How the name of a file ends that is being written; also of a program that was killed.
pub(super) const PART: &str = ".part";

/// Makes a folder; fails if anything of that name is there.
pub(super) fn create_folder(path: &Path) -> io::Result<()> {
    step("create folder", path)?;
    fs::create_dir(path)
}

/// Makes a file, open for reading and writing; fails if anything of that name is there.
pub(super) fn create_file(path: &Path) -> io::Result<File> {
    step("create file", path)?;
    OpenOptions::new().read(true).write(true).create_new(true).open(path)
}

/// Makes a file with a text, which is there whole and synced, or not at all; fails if anything of that name is there.
pub(super) fn create_whole(path: &Path, text: &str) -> io::Result<()> {
    use io::Write;
    // Most often somebody has made it before: then nothing is written.
    if !is_free(path) {
        return Err(io::ErrorKind::AlreadyExists.into());
    }
    step("create file", path)?;
    let name = path.file_name().unwrap_or_default();
    // A name of its own: others may be making the same file at this moment.
    let mut part = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Those of any new file, and not of one that nobody else may read.
        part.permissions(fs::Permissions::from_mode(0o666));
    }
    let part = part.prefix(name).suffix(PART).tempfile_in(super::folder_of(path))?;
    part.as_file().write_all(text.as_bytes())?;
    sync_file(part.path())?;
    let part = part.into_temp_path();
    // If that fails, it is removed as temporary files are.
    move_file(&part, path)?;
    let _ = part.keep();
    Ok(())
}

/// The content of a file, unless it is a pipe or something else that may never end.
pub(super) fn read(path: &Path) -> io::Result<Vec<u8>> {
    if !fs::metadata(path)?.is_file() {
        let problem = format!("{} is not a regular file", path.display());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
    }
    fs::read(path)
}

/// Moves a file; fails if anything is there.
pub(super) fn move_file(from: &Path, to: &Path) -> io::Result<()> {
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
pub(super) fn replace_file(from: &Path, to: &Path) -> io::Result<()> {
    step("replace", to)?;
    fs::rename(from, to)
}

/// Gives a file a second name, or copies it where that cannot be; fails if anything is there.
pub(super) fn link(from: &Path, to: &Path) -> io::Result<()> {
    step("link", to)?;
    match fs::hard_link(from, to) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists && is_free(to) => {
            io::copy(&mut File::open(from)?, &mut create_file(to)?).map(|_| ())
        }
        other => other,
    }
}

pub(super) fn is_free(path: &Path) -> bool {
    fs::symlink_metadata(path).is_err_and(|error| error.kind() == io::ErrorKind::NotFound)
}

/// Removes a file that may be gone already.
pub(super) fn remove_file(path: &Path) -> io::Result<()> {
    step("remove", path)?;
    match fs::remove_file(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

/// Removes a folder that is empty; one that is not, or is gone already, stays so.
pub(super) fn remove_folder(path: &Path) -> io::Result<()> {
    use io::ErrorKind::{DirectoryNotEmpty, NotADirectory, NotFound};
    step("remove folder", path)?;
    match fs::remove_dir(path) {
        Err(error) if matches!(error.kind(), DirectoryNotEmpty | NotADirectory | NotFound) => {
            Ok(())
        }
        other => other,
    }
}

/// Appends to an open file and brings it to the disk.
pub(super) fn append(mut file: &File, path: &Path, line: &str) -> io::Result<()> {
    use io::Write;
    step("append", path)?;
    file.write_all(line.as_bytes())?;
    if cfg!(test) { Ok(()) } else { file.sync_all() }
}

/// Brings the content of a file to the disk.
pub(super) fn sync_file(path: &Path) -> io::Result<()> {
    step("sync", path)?;
    let file = OpenOptions::new().read(true).write(true).open(path)?;
    if cfg!(test) { Ok(()) } else { file.sync_all() }
}

/// Brings the names in a folder to the disk.
pub(super) fn sync_folder(path: &Path) -> io::Result<()> {
    step("sync folder", path)?;
    // Elsewhere than on Unix, folders cannot be opened, and their changes are in the system's journal.
    if cfg!(unix) && !cfg!(test) { File::open(path)?.sync_all() } else { Ok(()) }
}

/// A test may stop the program here.
#[cfg(test)]
fn step(what: &str, path: &Path) -> io::Result<()> {
    super::tests::fuse::step(what, path)
}

#[cfg(not(test))]
#[allow(clippy::unnecessary_wraps, reason = "what tests put in its place can fail")]
fn step(_what: &str, _path: &Path) -> io::Result<()> {
    Ok(())
}
