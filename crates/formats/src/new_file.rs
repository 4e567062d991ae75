//! A file that is written piece by piece and appears whole or not at all, never through a link, or over another file
//! unasked.

use std::{
    fs::{self, File, Metadata, Permissions},
    io::{self, Write},
    path::{Path, PathBuf},
};
use tempfile::NamedTempFile;

/// A file that is being written: under another name beside its place until [`finish`](Self::finish), and removed if it
/// is dropped before.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    file: NamedTempFile,
    replaces: bool,
}

impl NewFile {
    /// Begins a file. What is at its place is replaced with `force` only, and only if it is a regular file; the new
    /// one then has its permissions.
    ///
    /// # Errors
    /// Something else is there, or the system refuses.
    pub fn create(path: &Path, force: bool) -> Result<Self, WriteError> {
        Self::create_as(path, force, None)
    }

    /// The same with these permissions, if they are given, from before the first byte on.
    pub(crate) fn create_as(
        path: &Path,
        force: bool,
        permissions: Option<Permissions>,
    ) -> Result<Self, WriteError> {
        let replaced = there(path)?;
        if replaced.is_some() && !force {
            return Err(WriteError::Exists(path.to_owned()));
        }
        let permissions = permissions.or_else(|| replaced.as_ref().map(Metadata::permissions));
        let file = temporary(folder(path), permissions)
            .map_err(|error| WriteError::Io { path: path.to_owned(), error: bare(error) })?;
        Ok(Self { path: path.to_owned(), file, replaces: replaced.is_some() })
    }

    /// Brings it to the disk and moves it to its place.
    ///
    /// # Errors
    /// Another file has come to be there, or the system refuses.
    pub fn finish(self) -> Result<(), WriteError> {
        self.finish_with(&[])
    }

    /// The same after these bytes.
    pub(crate) fn finish_with(mut self, bytes: &[u8]) -> Result<(), WriteError> {
        let written = self.file.write_all(bytes);
        let Self { path, file, replaces } = self;
        written.and_then(|()| put(&path, file, replaces)).map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => WriteError::Exists(path),
            _ => WriteError::Io { path, error: bare(error) },
        })
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// The regular file that is at a path; none if nothing is.
///
/// # Errors
/// Something else is there, or the system refuses.
pub(crate) fn there(path: &Path) -> Result<Option<Metadata>, WriteError> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(WriteError::Io { path: path.to_owned(), error }),
        Ok(there) if there.is_file() => Ok(Some(there)),
        Ok(_) => Err(WriteError::NoFile(path.to_owned())),
    }
}

/// The folder of a name without one is the current folder.
fn folder(path: &Path) -> &Path {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// What the system says, without the name of the temporary file, which nobody knows.
fn bare(error: io::Error) -> io::Error {
    let text = error.to_string();
    match text.split_once(" at path \"") {
        Some((said, _)) => io::Error::new(error.kind(), said.to_owned()),
        None => error,
    }
}

/// Moves a temporary file to its place, over what is to be replaced only.
fn put(path: &Path, file: NamedTempFile, replaces: bool) -> io::Result<()> {
    file.as_file().sync_all()?;
    if replaces {
        file.persist(path)?;
    } else {
        file.persist_noclobber(path)?;
    }
    // Elsewhere than on Unix, folders cannot be opened, and their changes are in the system's journal.
    if cfg!(unix) { synced(File::open(folder(path))) } else { Ok(()) }
}

/// Brings the names in a folder to the disk. One that may be written but not read cannot be opened: its names reach the disk without being
/// waited for.
fn synced(folder: io::Result<File>) -> io::Result<()> {
    match folder {
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => Ok(()),
        opened => opened?.sync_all(),
    }
}

/// A file that is removed unless it is moved, with these permissions or those of any new file.
fn temporary(folder: &Path, permissions: Option<Permissions>) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".gyradius-");
    // One that is to have permissions is nobody else's until it has them.
    #[cfg(unix)]
    if permissions.is_none() {
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder)?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    Ok(file)
}

/// Why a file is not written. What was there is as it was.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// Another file is there.
    #[error("{} exists: --force replaces it", .0.display())]
    Exists(PathBuf),
    /// A folder, a link, a pipe or a device is there.
    #[error("{} is not a regular file, and is neither followed nor replaced", .0.display())]
    NoFile(PathBuf),
    /// The system refuses.
    #[error("cannot write {}: {error}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder that may be written but not read is none that cannot be written.
    #[test]
    fn a_folder_that_must_not_be_opened_is_no_error() {
        let said = |kind: io::ErrorKind| synced(Err(kind.into())).map_err(|error| error.kind());
        assert_eq!(said(io::ErrorKind::PermissionDenied), Ok(()));
        assert_eq!(said(io::ErrorKind::NotFound), Err(io::ErrorKind::NotFound));
    }

    /// The file that was asked for is named, and no other.
    #[test]
    fn a_folder_that_is_not_there_is_told_without_another_name() {
        let scratch = tempfile::tempdir().unwrap();
        let path = scratch.path().join("nowhere").join("x.csv");
        let refused = NewFile::create(&path, false).unwrap_err();
        let WriteError::Io { error, .. } = &refused else { panic!("{refused}") };
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
        let told = refused.to_string();
        assert!(told.contains("x.csv: ") && !told.contains(".gyradius-"), "{told}");
    }

    /// Whatever the pieces, the file is there at the end and not before, and one that comes to its place in between is
    /// not replaced unasked.
    #[test]
    fn a_file_of_pieces_appears_whole_or_not_at_all() {
        for (pieces, force, between) in (0..4)
            .flat_map(|n| [(n, false), (n, true)])
            .flat_map(|(n, force)| [(n, force, false), (n, force, true)])
        {
            let scratch = tempfile::tempdir().unwrap();
            let path = scratch.path().join("draws.csv");
            if force {
                fs::write(&path, "old").unwrap();
            }
            let mut file = NewFile::create(&path, force).unwrap();
            for piece in 0..pieces {
                writeln!(file, "{piece}").unwrap();
                assert_eq!(path.exists(), force);
            }
            if between {
                fs::write(&path, "other").unwrap();
            }
            let finished = file.finish();
            if between && !force {
                assert!(matches!(finished, Err(WriteError::Exists(at)) if at == path));
                assert_eq!(fs::read_to_string(&path).unwrap(), "other");
            } else {
                finished.unwrap();
                let expected: String = (0..pieces).map(|piece| format!("{piece}\n")).collect();
                assert_eq!(fs::read_to_string(&path).unwrap(), expected);
            }
            assert_eq!(fs::read_dir(scratch.path()).unwrap().count(), 1, "no drafts");
        }
    }
}
