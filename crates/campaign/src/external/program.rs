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

    /// The places of its words that name files which are there, with the SHA-256 of each file, in hexadecimal: of regular files
    /// alone, for a pipe or a device has no end.
    pub fn files_sha256(&self) -> impl Iterator<Item = (usize, String)> {
        self.named_files().map(|file| (file.place, file.sha256))
    }

    /// The files that its words name.
    pub(super) fn named_files(&self) -> impl Iterator<Item = NamedFile> {
        let words = self.words.iter().map(Path::new).enumerate();
        let files = words.filter(|(_, word)| word.is_absolute() && word.is_file());
        files.filter_map(|(place, file)| NamedFile::new(place, file))
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
