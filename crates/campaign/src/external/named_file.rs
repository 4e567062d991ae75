//! A file that a command names, as it was when it was first looked at.

use std::{
    fs::{self, Metadata},
    path::{Path, PathBuf},
    time::SystemTime,
};

use crate::hash::sha256_of_file;

/// A file that a word of a command names.
#[derive(Debug)]
pub(super) struct NamedFile {
    /// The place of the word.
    pub(super) place: usize,
    path: PathBuf,
    stamp: Stamp,
    /// In hexadecimal.
    pub(super) sha256: String,
}

/// What the system says of a file, which tells most changes without reading it.
#[derive(Debug, PartialEq)]
struct Stamp {
    length: u64,
    modified: Option<SystemTime>,
    /// Another file in its place may have the same length and the same time.
    number: [u64; 2],
}

impl NamedFile {
    /// The file as it is; none if it is no regular file or cannot be read.
    pub(super) fn new(place: usize, path: &Path) -> Option<Self> {
        // Before it is read, so that a change meanwhile is seen.
        let stamp = Stamp::of(path)?;
        let sha256 = sha256_of_file(path).ok()?;
        Some(Self { place, path: path.to_owned(), stamp, sha256 })
    }

    /// Whether it has still the same content. It is read only if the system says anything else of it than before.
    pub(super) fn is_as_it_was(&self) -> bool {
        Stamp::of(&self.path).is_some_and(|now| {
            now == self.stamp || sha256_of_file(&self.path).is_ok_and(|now| now == self.sha256)
        })
    }
}

impl Stamp {
    fn of(path: &Path) -> Option<Self> {
        let found = fs::metadata(path).ok().filter(Metadata::is_file)?;
        Some(Self { length: found.len(), modified: found.modified().ok(), number: number(&found) })
    }
}

/// Its place on the disk, and when anything of it was last changed.
#[cfg(unix)]
fn number(found: &Metadata) -> [u64; 2] {
    use std::os::unix::fs::MetadataExt;
    [found.ino(), found.ctime_nsec().cast_unsigned()]
}

#[cfg(not(unix))]
fn number(_: &Metadata) -> [u64; 2] {
    [0; 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_seen_and_a_touch_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sim.py");
        assert!(NamedFile::new(0, &path).is_none() && NamedFile::new(0, folder.path()).is_none());
        fs::write(&path, "one").unwrap();
        let file = NamedFile::new(3, &path).unwrap();
        assert!(file.place == 3 && file.is_as_it_was());
        // The same content written again, and in another file of that name.
        fs::write(&path, "one").unwrap();
        assert!(file.is_as_it_was());
        fs::write(folder.path().join("new"), "one").unwrap();
        fs::rename(folder.path().join("new"), &path).unwrap();
        assert!(file.is_as_it_was());
        // Another one of the same length.
        fs::write(folder.path().join("new"), "two").unwrap();
        fs::rename(folder.path().join("new"), &path).unwrap();
        assert!(!file.is_as_it_was());
        fs::remove_file(&path).unwrap();
        assert!(!file.is_as_it_was());
    }
}
