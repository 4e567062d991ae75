//! The folder of a study or a comparison: written in full in a draft inside it, then put in place.

use std::{
    fs::{self, File, TryLockError},
    io,
    path::{Path, PathBuf},
};

use crate::{scenario::Scenario, study::StudyError};

const SCENARIO: &str = "scenario.toml";
const COMPARISON: &str = "compare.json";
const DRAFT: &str = ".draft-";
const LOCK: &str = ".lock";

/// What is written to a folder, so that nothing else is touched.
pub(crate) struct Contents<'a> {
    /// What it is called.
    what: &'static str,
    /// Folders and files, and whether they are folders.
    entries: &'static [(&'static str, bool)],
    /// The file that tells one from another, without which a folder is not whole.
    mark: &'static str,
    /// How the names of its figures begin.
    figures: &'static str,
    /// Whether this text of the mark is that of the very same.
    same: Box<dyn Fn(&str) -> bool + 'a>,
}

impl<'a> Contents<'a> {
    pub(crate) fn of_study(scenario: &'a Scenario) -> Self {
        Self {
            what: "study",
            entries: &[
                ("runs", true),
                ("figures", true),
                ("summary.json", false),
                ("report.html", false),
                (SCENARIO, false),
            ],
            mark: SCENARIO,
            figures: "figure-",
            same: Box::new(|text| text == scenario.to_toml()),
        }
    }

    /// `same` tells whether a `compare.json` is of the same comparison.
    pub(crate) fn of_comparison(same: impl Fn(&str) -> bool + 'a) -> Self {
        Self {
            what: "comparison",
            entries: &[
                ("figures", true),
                ("compare.html", false),
                ("compare.csv", false),
                (COMPARISON, false),
            ],
            mark: COMPARISON,
            figures: "compare-",
            same: Box::new(same),
        }
    }

    fn wrote(&self, file: &Path) -> bool {
        let name = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        match file.components().next().map(|c| c.as_os_str().to_string_lossy().into_owned()) {
            Some(top) if top == "runs" => name == "runs.parquet",
            Some(top) if top == "figures" => {
                name.starts_with(self.figures) && name.ends_with(".svg")
            }
            Some(top) => self.entries.iter().any(|(entry, is_folder)| !is_folder && *entry == top),
            None => false,
        }
    }
}

/// A folder being prepared. Dropped before it is published, it leaves no trace.
pub(crate) struct Folder<'a> {
    contents: &'a Contents<'a>,
    place: PathBuf,
    draft: PathBuf,
    /// Held until the end, and given back by the system if the program dies.
    lock: File,
    /// Whether the place did not exist before.
    made: bool,
}

impl<'a> Folder<'a> {
    /// Checks that it may go to `place` and can be written there, before anything is
    /// computed, and keeps others out.
    pub(crate) fn prepare(
        place: &Path,
        contents: &'a Contents<'a>,
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
                return Err(problem("something else is being written there".to_owned()));
            }
            Err(TryLockError::Error(e)) => return Err(unwritable(e)),
        }
        let draft = place.join(format!("{DRAFT}{}", std::process::id()));
        let folder = Self { contents, place: place.to_owned(), draft, lock, made };
        folder.check(force).map_err(problem)?;
        folder.clear_drafts().map_err(unwritable)?;
        for name in ["new", "old"] {
            fs::create_dir_all(folder.draft.join(name)).map_err(unwritable)?;
        }
        Ok(folder)
    }

    /// What is in the way, if anything is.
    fn check(&self, force: bool) -> Result<(), String> {
        let mut occupied = false;
        for entry in fs::read_dir(&self.place).map_err(|e| e.to_string())? {
            let name = entry.map_err(|e| e.to_string())?.file_name();
            let name = name.to_string_lossy();
            occupied |= !name.starts_with(DRAFT) && name != LOCK;
        }
        let Contents { what, mark, .. } = self.contents;
        let same =
            fs::read_to_string(self.place.join(mark)).is_ok_and(|text| (self.contents.same)(&text));
        if occupied && !same && !force {
            return Err(format!(
                "it already holds another {what} or other files; choose another folder with \
                 --out, or pass --force to replace what a {what} writes there"
            ));
        }
        for &(name, is_folder) in self.contents.entries {
            let path = self.place.join(name);
            if path.exists() && path.is_dir() != is_folder {
                let (is, should) = if is_folder { ("file", "folder") } else { ("folder", "file") };
                return Err(format!("{name} in it is a {is} where a {what} has a {should}"));
            }
        }
        Ok(())
    }

    /// Drafts that were broken off: nobody is writing them, or the lock would be held.
    fn clear_drafts(&self) -> io::Result<()> {
        for entry in fs::read_dir(&self.place)? {
            let entry = entry?;
            if entry.file_name().to_string_lossy().starts_with(DRAFT) {
                fs::remove_dir_all(entry.path())?;
            }
        }
        Ok(())
    }

    /// The files that a run before wrote here, by their paths.
    fn written_before(&self) -> io::Result<Vec<PathBuf>> {
        let mut files = Vec::new();
        for &(entry, is_folder) in self.contents.entries {
            let path = self.place.join(entry);
            if is_folder && path.is_dir() {
                files.extend(files_below(&path, Path::new(entry))?);
            } else if path.exists() {
                files.push(PathBuf::from(entry));
            }
        }
        files.retain(|file| self.contents.wrote(file));
        // The mark goes first: a folder without one is not whole.
        files.sort_by_key(|file| file != Path::new(self.contents.mark));
        Ok(files)
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

    /// Puts the draft in place of the files of the one that was there, and of nothing else. If
    /// that fails half-way, what was there is put back.
    pub(crate) fn publish(self) -> Result<PathBuf, StudyError> {
        let (new, old) = (self.draft.join("new"), self.draft.join("old"));
        let mut moves: Vec<(PathBuf, PathBuf)> = Vec::new();
        let mut put = || -> io::Result<()> {
            for file in self.written_before()? {
                moved(&self.place.join(&file), &old.join(&file), &mut moves)?;
            }
            // The mark goes last: a folder with one is whole.
            let mut files = files_below(&new, Path::new(""))?;
            files.sort_by_key(|file| (file == Path::new(self.contents.mark), file.clone()));
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

impl Drop for Folder<'_> {
    fn drop(&mut self) {
        // Failures here leave hidden files behind and harm nothing.
        let _ = fs::remove_dir_all(&self.draft);
        let _ = fs::remove_file(self.place.join(LOCK));
        let _ = self.lock.unlock();
        if self.made {
            // Goes only if empty: nothing was published.
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
    let runs = place.join("runs");
    if !runs.is_dir() {
        return Ok(());
    }
    for entry in fs::read_dir(runs)? {
        // Only empty folders can be removed so.
        let _ = fs::remove_dir(entry?.path());
    }
    Ok(())
}
