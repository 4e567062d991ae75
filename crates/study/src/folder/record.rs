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

    pub(super) fn to_json(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}
