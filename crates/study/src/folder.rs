//! The folder of a study: written in full in a draft inside it, then put in place.

use std::{
    fs::{self, File, TryLockError},
    io,
    path::{Path, PathBuf},
};

use crate::{scenario::Scenario, study::StudyError};

const SCENARIO: &str = "scenario.toml";
const DRAFT: &str = ".draft-";
const LOCK: &str = ".lock";
/// Folders and files that a study writes, and whether they are folders.
const ENTRIES: [(&str, bool); 5] = [
    ("runs", true),
    ("figures", true),
    ("summary.json", false),
    ("report.html", false),
    (SCENARIO, false),
];

/// A folder being prepared. Dropped before it is published, it leaves no trace.
#[derive(Debug)]
pub(crate) struct Folder {
    place: PathBuf,
    draft: PathBuf,
    /// Held until the end, and given back by the system if the program dies.
    lock: File,
    /// Whether the place did not exist before.
    made: bool,
}

impl Folder {
    /// Checks that the study may go to `place` and can be written there, before anything is
    /// computed, and keeps other studies out.
    pub(crate) fn prepare(
        place: &Path,
        scenario: &Scenario,
        force: bool,
    ) -> Result<Self, StudyError> {
        let problem = |problem: String| StudyError::Folder { path: place.to_owned(), problem };
        let unwritable = |e: io::Error| problem(format!("it cannot be written: {e}"));
        let made = !place.exists();
        if !made && !place.is_dir() {
            return Err(problem("it is not a folder".to_owned()));
        }
        fs::create_dir_all(place).map_err(unwritable)?;
        let lock = File::create(place.join(LOCK)).map_err(unwritable)?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(problem("another study is being written there".to_owned()));
            }
            Err(TryLockError::Error(e)) => return Err(unwritable(e)),
        }
        let draft = place.join(format!("{DRAFT}{}", std::process::id()));
        let folder = Self { place: place.to_owned(), draft, lock, made };
        folder.check(scenario, force).map_err(problem)?;
        folder.clear_drafts().map_err(unwritable)?;
        for name in ["new", "old"] {
            fs::create_dir_all(folder.draft.join(name)).map_err(unwritable)?;
        }
        Ok(folder)
    }

    /// What is in the way of this study, if anything is.
    fn check(&self, scenario: &Scenario, force: bool) -> Result<(), String> {
        let mut occupied = false;
        for entry in fs::read_dir(&self.place).map_err(|e| e.to_string())? {
            let name = entry.map_err(|e| e.to_string())?.file_name();
            let name = name.to_string_lossy();
            occupied |= !name.starts_with(DRAFT) && name != LOCK;
        }
        let same = fs::read_to_string(self.place.join(SCENARIO))
            .is_ok_and(|text| text == scenario.to_toml());
        if occupied && !same && !force {
            return Err(
                "it already holds another study or other files; choose another folder with \
                        --out, or pass --force to replace what a study writes there"
                    .to_owned(),
            );
        }
        for (name, is_folder) in ENTRIES {
            let path = self.place.join(name);
            if path.exists() && path.is_dir() != is_folder {
                let (is, should) = if is_folder { ("file", "folder") } else { ("folder", "file") };
                return Err(format!("{name} in it is a {is} where a study has a {should}"));
            }
        }
        Ok(())
    }

    /// Drafts of studies that were broken off: nobody is writing them, or the lock would be held.
    fn clear_drafts(&self) -> io::Result<()> {
        for entry in fs::read_dir(&self.place)? {
            let entry = entry?;
            if entry.file_name().to_string_lossy().starts_with(DRAFT) {
                fs::remove_dir_all(entry.path())?;
            }
        }
        Ok(())
    }

    /// Writes a file of the draft, making the folders above it.
    pub(crate) fn write(&self, name: &str, content: &str) -> Result<(), StudyError> {
        use io::Write;
        let mut file = self.create(name)?;
        file.write_all(content.as_bytes())
            .map_err(|source| StudyError::Write { path: self.place.join(name), source })
    }

    /// Opens a file of the draft for writing, making the folders above it.
    pub(crate) fn create(&self, name: &str) -> Result<File, StudyError> {
        let path = self.draft.join("new").join(name);
        let create = || {
            if let Some(parent) = path.parent() {
                fs::create_dir_all(parent)?;
            }
            File::create(&path)
        };
        create().map_err(|source| StudyError::Write { path: self.place.join(name), source })
    }

    /// Puts the draft in place of the files of the study that was there, and of nothing else. If
    /// that fails half-way, what was there is put back.
    pub(crate) fn publish(self) -> Result<PathBuf, StudyError> {
        let (new, old) = (self.draft.join("new"), self.draft.join("old"));
        let mut moves: Vec<(PathBuf, PathBuf)> = Vec::new();
        let mut put = || -> io::Result<()> {
            for file in written_by_a_study(&self.place)? {
                moved(&self.place.join(&file), &old.join(&file), &mut moves)?;
            }
            // The scenario goes last: a folder with one is whole.
            let mut files = files_below(&new, Path::new(""))?;
            files.sort_by_key(|file| (file == Path::new(SCENARIO), file.clone()));
            for file in files {
                moved(&new.join(&file), &self.place.join(&file), &mut moves)?;
            }
            remove_empty_folders(&self.place)
        };
        if let Err(source) = put() {
            for (from, to) in moves.iter().rev() {
                // Nothing better can be done about a failure to undo.
                let _ = fs::rename(to, from);
            }
            return Err(StudyError::Write { path: self.place.clone(), source });
        }
        Ok(self.place.clone())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Failures here leave hidden files behind and harm nothing.
        let _ = fs::remove_dir_all(&self.draft);
        let _ = fs::remove_file(self.place.join(LOCK));
        let _ = self.lock.unlock();
        if self.made {
            // Goes only if empty: the study failed.
            let _ = fs::remove_dir(&self.place);
        }
    }
}

fn moved(from: &Path, to: &Path, moves: &mut Vec<(PathBuf, PathBuf)>) -> io::Result<()> {
    if let Some(parent) = to.parent() {
        fs::create_dir_all(parent)?;
    }
    fs::rename(from, to)?;
    moves.push((from.to_owned(), to.to_owned()));
    Ok(())
}

/// The files of a study in a folder, by their paths in it.
fn written_by_a_study(place: &Path) -> io::Result<Vec<PathBuf>> {
    let ours = |file: &PathBuf| {
        let name = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        match file.components().next().map(|c| c.as_os_str().to_string_lossy().into_owned()) {
            Some(top) if top == "runs" => name == "runs.parquet",
            Some(top) if top == "figures" => name.starts_with("figure-") && name.ends_with(".svg"),
            Some(top) => ENTRIES.iter().any(|(entry, is_folder)| !is_folder && *entry == top),
            None => false,
        }
    };
    let mut files = Vec::new();
    for (entry, is_folder) in ENTRIES {
        let path = place.join(entry);
        if is_folder && path.is_dir() {
            files.extend(files_below(&path, Path::new(entry))?);
        } else if path.exists() {
            files.push(PathBuf::from(entry));
        }
    }
    files.retain(ours);
    // The scenario goes first: a folder without one is not whole.
    files.sort_by_key(|file| file != Path::new(SCENARIO));
    Ok(files)
}

/// Every file below a folder, as paths from `prefix`.
fn files_below(folder: &Path, prefix: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = prefix.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            files.extend(files_below(&entry.path(), &name)?);
        } else {
            files.push(name);
        }
    }
    Ok(files)
}

/// Folders of models that are no longer there.
fn remove_empty_folders(place: &Path) -> io::Result<()> {
    for entry in fs::read_dir(place.join("runs"))? {
        // Only empty folders can be removed so.
        let _ = fs::remove_dir(entry?.path());
    }
    Ok(())
}
