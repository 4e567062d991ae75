//! The folder of a study: written in full beside its place, then put there.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use crate::{scenario::Scenario, study::StudyError};

const SCENARIO: &str = "scenario.toml";
const DRAFT: &str = ".draft-";
/// What a study leaves behind, and all that it ever replaces.
const ENTRIES: [&str; 5] = ["runs", "figures", "summary.json", "report.html", SCENARIO];

/// A folder being prepared. Dropped before it is published, it leaves no trace.
#[derive(Debug)]
pub(crate) struct Folder {
    place: PathBuf,
    draft: PathBuf,
    /// Whether the place did not exist before.
    made: bool,
}

impl Folder {
    /// Checks that the study may go to `place` and can be written there, before anything is
    /// computed.
    pub(crate) fn prepare(
        place: &Path,
        scenario: &Scenario,
        force: bool,
    ) -> Result<Self, StudyError> {
        let problem = |problem: String| StudyError::Folder { path: place.to_owned(), problem };
        if place.exists() {
            if !place.is_dir() {
                return Err(problem("it is not a folder".to_owned()));
            }
            // Drafts of other studies, running or broken off, are in nobody's way.
            let occupied = fs::read_dir(place).map_err(|e| problem(e.to_string()))?.any(|entry| {
                entry.is_ok_and(|e| !e.file_name().to_string_lossy().starts_with(DRAFT))
            });
            let same = fs::read_to_string(place.join(SCENARIO))
                .is_ok_and(|text| text == scenario.to_toml());
            if occupied && !same && !force {
                return Err(problem(
                    "it already holds another study or other files; choose another folder with \
                     --out, or pass --force to replace what a study writes there"
                        .to_owned(),
                ));
            }
        }
        let made = !place.exists();
        let draft = place.join(format!("{DRAFT}{}", std::process::id()));
        fs::create_dir_all(draft.join("runs"))
            .and_then(|()| fs::create_dir_all(draft.join("figures")))
            .map_err(|e| problem(format!("it cannot be written: {e}")))?;
        Ok(Self { place: place.to_owned(), draft, made })
    }

    /// Writes a file of the draft.
    pub(crate) fn write(&self, name: &str, content: &str) -> Result<(), StudyError> {
        let path = self.draft.join(name);
        fs::write(&path, content).map_err(|source| StudyError::Write { path, source })
    }

    /// Opens a file of the draft for writing, making the folders above it.
    pub(crate) fn create(&self, name: &str) -> Result<fs::File, StudyError> {
        let path = self.draft.join(name);
        let create = || {
            if let Some(parent) = path.parent() {
                fs::create_dir_all(parent)?;
            }
            fs::File::create(&path)
        };
        create().map_err(|source| StudyError::Write { path: path.clone(), source })
    }

    /// Puts the draft in place of what was there. The scenario goes last: a folder with one is
    /// whole.
    pub(crate) fn publish(self) -> Result<PathBuf, StudyError> {
        let put = || -> io::Result<()> {
            let old = self.place.join(SCENARIO);
            if old.exists() {
                fs::remove_file(old)?;
            }
            for entry in ENTRIES {
                let target = self.place.join(entry);
                if target.is_dir() {
                    fs::remove_dir_all(&target)?;
                }
                fs::rename(self.draft.join(entry), &target)?;
            }
            Ok(())
        };
        put().map_err(|source| StudyError::Write { path: self.place.clone(), source })?;
        Ok(self.place.clone())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // What is left of a draft is of no use, and a failure to remove it of no consequence.
        let _ = fs::remove_dir_all(&self.draft);
        if self.made {
            // Goes only if empty: the study failed.
            let _ = fs::remove_dir(&self.place);
        }
    }
}
