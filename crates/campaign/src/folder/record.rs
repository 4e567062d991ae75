//! What this program wrote into a folder: which files with which content, and which folders it made.

use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

use super::name::Name;

/// The record. A file is recognised by its name and its content, so that one which the user has
/// changed is the user's.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Record {
    /// SHA-256 in hexadecimal.
    files: BTreeMap<Name, String>,
    folders: BTreeSet<Name>,
}

impl Record {
    pub(super) fn new(files: BTreeMap<Name, String>, folders: BTreeSet<Name>) -> Self {
        Self { files, folders }
    }

    pub(super) fn has(&self, name: &Name) -> bool {
        self.files.contains_key(name)
    }

    pub(super) fn hash(&self, name: &Name) -> Option<&str> {
        self.files.get(name).map(String::as_str)
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &Name> {
        self.files.keys()
    }

    pub(super) fn files(&self) -> &BTreeMap<Name, String> {
        &self.files
    }

    /// The folders that were made, not found.
    pub(super) fn folders(&self) -> &BTreeSet<Name> {
        &self.folders
    }

    /// The files that are kept and those that are not, each with the folders if any file is kept.
    pub(super) fn split(self, kept: impl Fn(&str) -> bool) -> (Self, Self) {
        let (kept, rest): (BTreeMap<_, _>, _) =
            self.files.into_iter().partition(|(name, _)| kept(&name.to_string()));
        let folders = if kept.is_empty() { BTreeSet::new() } else { self.folders.clone() };
        (Self::new(kept, folders), Self::new(rest, self.folders))
    }

    /// The same files, in these folders too.
    pub(super) fn in_folders_of(mut self, other: &Self) -> Self {
        self.folders.extend(other.folders.iter().cloned());
        self
    }

    /// These files and others.
    pub(super) fn and(mut self, others: &Self) -> Self {
        self.files.extend(others.files.clone());
        self.in_folders_of(others)
    }

    pub(super) fn to_json(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}
