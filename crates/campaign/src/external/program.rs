//! The command of a simulator: its words, where it runs, how it is spoken to, how long it may take.

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
    time::Duration,
};

use super::{named_file::NamedFile, patience::Patience};

/// Seconds that a run may take if nothing is said.
const TIMEOUT_S: f64 = 60.0;
/// Most seconds that may be asked for: twelve days.
const MAX_TIMEOUT_S: f64 = 1e6;

/// The command of a simulator in any language, which does one run at a time.
#[derive(Clone, Debug)]
pub struct Program {
    words: Vec<OsString>,
    folder: PathBuf,
    per_run: bool,
    timeout_s: f64,
    stop: Option<Arc<AtomicBool>>,
}

impl Program {
    /// A command, its words one by one as no shell is asked, that belongs to a folder: words that name files in that
    /// folder, as `spin.py`, become their full paths. The program itself is looked up in `PATH` unless its name has a
    /// separator, as `./spin`. A process is kept for many runs, works in the folder and has 60 s for each run.
    ///
    /// # Errors
    /// There are no words, the first one is empty, or the folder is not there, or is a file.
    pub fn new(command: &[String], folder: &Path) -> Result<Self, ProgramError> {
        if command.first().is_none_or(String::is_empty) {
            return Err(ProgramError::Empty);
        }
        let folder =
            std::path::absolute(folder).ok().filter(|path| path.is_dir()).ok_or_else(|| {
                let given = folder.to_owned();
                if folder.exists() {
                    ProgramError::NoFolder { path: given }
                } else {
                    ProgramError::Folder { folder: given }
                }
            })?;
        let word = |(place, word): (usize, &String)| {
            let file = folder.join(word);
            let is_path =
                place > 0 || Path::new(word).components().count() > 1 || word.starts_with("./");
            if is_path && !word.is_empty() && file.is_file() { file.into() } else { word.into() }
        };
        let words = command.iter().enumerate().map(word).collect();
        Ok(Self { words, folder, per_run: false, timeout_s: TIMEOUT_S, stop: None })
    }

    /// The same, started once for each run in a temporary folder of its own, where it finds `input.json` and leaves
    /// `output.json`.
    #[must_use]
    pub fn per_run(self) -> Self {
        Self { per_run: true, ..self }
    }

    /// The same, with so many seconds for each run, which include the start of a process that is started for it.
    ///
    /// # Errors
    /// They are not positive or more than a million.
    pub fn with_timeout(self, timeout_s: f64) -> Result<Self, ProgramError> {
        if timeout_s > 0.0 && timeout_s <= MAX_TIMEOUT_S {
            Ok(Self { timeout_s, ..self })
        } else {
            Err(ProgramError::Timeout { timeout_s })
        }
    }

    /// The same, whose processes are waited for no longer once `stop` is true: the runs that they are at fail, and a
    /// campaign that is stopped by the same drops them.
    #[must_use]
    pub fn stopped_by(self, stop: Arc<AtomicBool>) -> Self {
        Self { stop: Some(stop), ..self }
    }

    /// The words of the command.
    #[must_use]
    pub fn words(&self) -> &[OsString] {
        &self.words
    }

    /// Whether it is started for each run.
    #[must_use]
    pub fn is_per_run(&self) -> bool {
        self.per_run
    }

    /// Seconds that a run may take.
    #[must_use]
    pub fn timeout_s(&self) -> f64 {
        self.timeout_s
    }

    /// The places of its words that name files which are there, whole or behind a `=`, with the SHA-256 of each file, in hexadecimal: of regular files
    /// alone, for a pipe or a device has no end.
    pub fn files_sha256(&self) -> impl Iterator<Item = (usize, String)> {
        self.named_files().map(|file| (file.place, file.sha256))
    }

    /// The files that its words name, whole or behind a `=`, as in `--config=conf.json`.
    pub(super) fn named_files(&self) -> impl Iterator<Item = NamedFile> {
        self.words.iter().enumerate().filter_map(|(place, word)| {
            let whole = Path::new(word);
            if whole.is_absolute() && whole.is_file() {
                return NamedFile::new(place, whole);
            }
            let word = word.to_str()?;
            let behind = word.match_indices('=').map(|(at, _)| self.folder.join(&word[at + 1..]));
            behind.filter(|file| file.is_file()).find_map(|file| NamedFile::new(place, &file))
        })
    }

    /// How long a run that begins now is waited for.
    pub(super) fn patience(&self) -> Patience<'_> {
        Patience::new(Duration::from_secs_f64(self.timeout_s), self.stop.as_deref())
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// The command as one would type it.
    pub(super) fn shown(&self) -> String {
        let words = self.words.iter().map(|word| word.to_string_lossy());
        words.collect::<Vec<_>>().join(" ")
    }
}

/// Why a command cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramError {
    /// There is no program to start.
    #[error("the command is empty: its first word must be a program")]
    Empty,
    /// The folder that it belongs to is not there.
    #[error("the folder of the command, {}, is not there", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
    },
    /// What is given as the folder that it belongs to is something else.
    #[error("the folder of the command, {}, is a file: it must be a folder", path.display())]
    NoFolder {
        /// What is there.
        path: PathBuf,
    },
    /// The time for a run is out of range.
    #[error(
        "the timeout of a run is {timeout_s} s: it must be positive and at most {MAX_TIMEOUT_S} s"
    )]
    Timeout {
        /// In seconds.
        timeout_s: f64,
    },
    /// The command cannot be started.
    #[error("the command `{command}` cannot be started: {problem}")]
    Start {
        /// The command as one would type it.
        command: String,
        /// What the system says.
        problem: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::fs;

    proptest! {
        /// A file is watched wherever it stands in a word: alone, behind a `=` or the second one, by its name or its full path; and no
        /// folder, no file that is not there, and none whose name begins elsewhere.
        #[test]
        fn files_behind_equals_signs_are_named(
            words in prop::collection::vec((0..5_usize, 0..4_usize, any::<bool>()), 1..8),
        ) {
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("conf.json"), "{}").unwrap();
            fs::write(folder.path().join("b=c.json"), "{}").unwrap();
            fs::create_dir(folder.path().join("folder")).unwrap();
            let word = |(before, name, is_full): &(usize, usize, bool)| {
                let name = ["conf.json", "b=c.json", "folder", "absent.json"][*name];
                let name = if *is_full { folder.path().join(name).display().to_string() } else { name.to_owned() };
                format!("{}{name}", ["", "--config=", "-Dx=y=", "=", "-I"][*before])
            };
            let command: Vec<String> = ["sh".to_owned()].into_iter().chain(words.iter().map(word)).collect();
            let program = Program::new(&command, folder.path()).unwrap();
            let found: Vec<usize> = program.files_sha256().map(|(place, _)| place).collect();
            let is_named = |(before, name, _): &(usize, usize, bool)| *before < 4 && *name < 2;
            let named = words.iter().zip(1..).filter(|(word, _)| is_named(word)).map(|(_, place)| place);
            prop_assert_eq!(found, named.collect::<Vec<_>>(), "{:?}", command);
        }
    }
}
