//! Names of files in a folder, and what is found under them.

use serde::{Deserialize, Serialize};
use std::{
    fmt,
    fs::FileType,
    path::{Path, PathBuf},
};

use super::{disk, refusal::Refusal};

/// The folder in a campaign's folder that tells which files are the campaign's own.
pub const HIDDEN: &str = ".gyradius";

/// A file below a folder: plain parts with `/` between them, none of which leads out of it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub(crate) struct Name(String);

impl Name {
    /// # Errors
    /// A part is empty, leads elsewhere, or is a name that only this module may use.
    pub(crate) fn new(text: &str) -> Result<Self, NameError> {
        let plain = |part: &str| {
            !matches!(part, "" | "." | "..") && !part.contains(['\\', ':', '\0', '\n'])
        };
        let mut parts = text.split('/');
        let own = parts.next() == Some(HIDDEN)
            && !(parts.next().is_some_and(|part| part.ends_with(".json"))
                && parts.next().is_none());
        if text.split('/').all(plain) && !own {
            Ok(Self(text.to_owned()))
        } else {
            Err(NameError { name: text.to_owned() })
        }
    }

    /// The name of a record.
    pub(super) fn record(what: &str) -> Self {
        Self(format!("{HIDDEN}/{what}.json"))
    }

    /// Where it is below a folder.
    pub(super) fn below(&self, folder: &Path) -> PathBuf {
        folder.join(&self.0)
    }

    /// The folders above it, the outermost first.
    pub(super) fn folders(&self) -> impl DoubleEndedIterator<Item = Self> {
        self.0.match_indices('/').map(|(end, _)| Self(self.0[..end].to_owned()))
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl TryFrom<String> for Name {
    type Error = NameError;

    fn try_from(text: String) -> Result<Self, NameError> {
        Self::new(&text)
    }
}

impl From<Name> for String {
    fn from(name: Name) -> Self {
        name.0
    }
}

/// What is found under a name.
#[derive(Debug)]
pub(super) enum Found {
    Nothing,
    /// SHA-256 in hexadecimal.
    File {
        hash: String,
    },
    /// Something that this program does not make, there or in its way.
    Other {
        name: String,
        is: &'static str,
        should: &'static str,
    },
}

/// Looks without following any link below the folder.
pub(super) fn look(folder: &Path, name: &Name) -> Result<Found, Refusal> {
    let kind = |name: &Name| Ok(disk::found(&name.below(folder))?.map(|found| found.file_type()));
    let other = |name: &Name, kind: FileType, should| {
        Ok(Found::Other { name: name.to_string(), is: said(kind), should })
    };
    for above in name.folders() {
        match kind(&above)? {
            None => return Ok(Found::Nothing),
            Some(kind) if kind.is_dir() => {}
            Some(kind) => return other(&above, kind, "folder"),
        }
    }
    match kind(name)? {
        None => Ok(Found::Nothing),
        Some(kind) if kind.is_file() => {
            let hash = disk::if_there(disk::hash(&name.below(folder)))?;
            Ok(hash.map_or(Found::Nothing, |hash| Found::File { hash }))
        }
        Some(kind) => other(name, kind, "file"),
    }
}

/// What it is, in a word.
pub(super) fn said(kind: FileType) -> &'static str {
    if kind.is_dir() {
        "folder"
    } else if kind.is_file() {
        "file"
    } else if kind.is_symlink() {
        "link"
    } else {
        "device or pipe"
    }
}

/// A name that no file of this program has.
#[derive(Debug, thiserror::Error)]
#[error("{name:?} is no name of a file in it")]
pub(crate) struct NameError {
    name: String,
}
