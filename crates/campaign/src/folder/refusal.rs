//! What the system refuses of a file or folder: which one, whether it was to be read or written, and why.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// Why the system does not let a file or folder be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{} {}", path.display(), self.said())]
pub(crate) struct Refusal {
    path: PathBuf,
    access: Access,
    error: io::Error,
}

/// What was to be done with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Access {
    Read,
    Write,
}

impl Refusal {
    /// What the system said when this was to be read.
    pub(crate) fn read(path: &Path) -> impl FnOnce(io::Error) -> Self {
        Self::of(path, Access::Read)
    }

    /// What the system said when this was to be written, made, moved or removed.
    pub(crate) fn write(path: &Path) -> impl FnOnce(io::Error) -> Self {
        Self::of(path, Access::Write)
    }

    fn of(path: &Path, access: Access) -> impl FnOnce(io::Error) -> Self {
        move |error| Self { path: closed(path, &error).to_owned(), access, error }
    }

    pub(super) fn kind(&self) -> io::ErrorKind {
        self.error.kind()
    }

    /// Whether it may only be read.
    pub(super) fn is_read_only(&self) -> bool {
        use io::ErrorKind::{PermissionDenied, ReadOnlyFilesystem};
        self.access == Access::Write && matches!(self.kind(), ReadOnlyFilesystem | PermissionDenied)
    }

    /// The same of a folder, in which it is told by its name from there on.
    pub(super) fn said_of(&self, folder: &Path) -> String {
        // Who holds the lock knows the folder by another path.
        let whole = fs::canonicalize(folder).ok();
        let mut paths = [Some(folder), whole.as_deref()].into_iter().flatten();
        let said = self.said();
        match paths.find_map(|folder| self.path.strip_prefix(folder).ok()) {
            Some(name) if name.as_os_str().is_empty() => format!("it {said}"),
            Some(name) => format!("{} in it {said}", name.display()),
            None => self.to_string(),
        }
    }

    fn said(&self) -> String {
        let to = match self.access {
            Access::Read => "read",
            Access::Write => "written",
        };
        format!("cannot be {to}: {}{}", self.error, how_on(&self.error))
    }
}

/// What has to be opened to somebody: the file that is there, or else the folder in which it can neither be seen nor made.
fn closed<'p>(path: &'p Path, error: &io::Error) -> &'p Path {
    let is_seen = |path: &&Path| fs::symlink_metadata(path).is_ok();
    let is_closed = error.kind() == io::ErrorKind::PermissionDenied;
    path.ancestors().find(is_seen).filter(|_| is_closed).unwrap_or(path)
}

/// What the system said, for those who know of what.
impl From<Refusal> for io::Error {
    fn from(refusal: Refusal) -> Self {
        refusal.error
    }
}

/// What there is to do about a full disk.
fn how_on(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            ". What was finished stays, and the same command goes on once there is room"
        }
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::folder::{FolderError, Problem};

    /// Every file that the system refuses is told from the folder that was asked for, with what was to be done and the reason.
    #[test]
    fn the_file_that_is_refused_is_named() {
        let scratch = tempfile::tempdir().unwrap();
        let place = scratch.path().join("out");
        fs::create_dir_all(place.join(".gyradius")).unwrap();
        fs::write(place.join(".gyradius/lock"), "").unwrap();
        std::os::unix::fs::symlink("out", scratch.path().join("link")).unwrap();
        let denied = || io::Error::from_raw_os_error(13);
        let elsewhere = scratch.path().join("other");
        fs::write(&elsewhere, "").unwrap();
        for place in [place, scratch.path().join("link")] {
            let whole = fs::canonicalize(&place).unwrap();
            for (path, name) in [
                (place.clone(), "it".to_owned()),
                (whole.clone(), "it".to_owned()),
                (place.join(".gyradius/lock"), ".gyradius/lock in it".to_owned()),
                (whole.join(".gyradius/lock"), ".gyradius/lock in it".to_owned()),
                (whole.join(".gyradius/draft/mark"), ".gyradius in it".to_owned()),
                (whole.join("runs/a"), "it".to_owned()),
                (elsewhere.clone(), elsewhere.display().to_string()),
            ] {
                let refused = [Refusal::read(&path)(denied()), Refusal::write(&path)(denied())];
                for (refusal, to) in refused.into_iter().zip(["read", "written"]) {
                    let error = FolderError { path: place.clone(), problem: refusal.into() };
                    let told = format!("{name} cannot be {to}: Permission denied (os error 13)");
                    assert_eq!(error.problem(), told);
                    let whole = format!("output folder {}: {told}", place.display());
                    assert_eq!(error.to_string(), whole);
                    assert_eq!(error.is_read_only(), to == "written");
                }
            }
        }
        // What is not there is told by its own name.
        let path = elsewhere.with_file_name("nowhere");
        let gone = Refusal::read(&path)(io::ErrorKind::NotFound.into());
        assert!(gone.to_string().starts_with(&path.display().to_string()), "{gone}");
        // Where nothing says of which folder, the whole path is told.
        let problem = Problem::from(Refusal::read(&elsewhere)(denied()));
        let stuck = Problem::Stuck { problem: Box::new(problem) }.to_string();
        assert!(stuck.contains(&format!("{} cannot be read: ", elsewhere.display())), "{stuck}");
    }
}
