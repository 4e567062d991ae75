//! The processes of a program that simulates, of which each thread that does runs has one.

use rustix::io::Errno;
use std::{
    fmt, fs,
    io::{self, ErrorKind, Read},
    path::Path,
    sync::{Mutex, OnceLock, PoisonError},
    time::{Duration, Instant},
};

use super::{
    LIMIT,
    child::Child,
    named_file::NamedFile,
    program::{Program, ProgramError},
    tail::shown,
    trouble::Trouble,
};

/// How long processes that are not needed any more may take to end by themselves.
const PARTING: Duration = Duration::from_secs(1);
/// Characters that are told of what nobody asked for.
const TOLD: usize = 80;

/// The processes of a [`Program`].
///
/// Every thread that does runs has a process, which is kept. When they are dropped, their standard input is
/// closed, and what has not ended one second later is killed with everything in its process group.
#[derive(Debug)]
pub(super) struct Processes {
    program: Program,
    /// Processes that wait to be asked.
    idle: Mutex<Vec<Child>>,
    unasked: Mutex<Option<Unasked>>,
    /// The files that the command names, as they were when they were first looked at.
    files: OnceLock<Vec<NamedFile>>,
    /// What this machine could not do for a run, if there was something: start a process, or use a temporary folder.
    of_machine: OnceLock<String>,
}

/// What processes of a simulator wrote to standard output that nobody had asked for. Each was ended for it before its next run,
/// which was sent to a new one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unasked {
    processes: u64,
    text: String,
}

impl fmt::Display for Unasked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (processes, text) = (self.processes, &self.text);
        let many = if processes == 1 { "1 process" } else { &format!("{processes} processes") };
        write!(
            f,
            "the simulator wrote more to standard output than its answers, such as `{text}`, and {many} had to be started again \
             for it: messages belong on standard error"
        )
    }
}

impl Unasked {
    /// How many processes were ended.
    #[must_use]
    pub fn processes(&self) -> u64 {
        self.processes
    }

    /// What one of them wrote, shortened.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl Processes {
    /// Which are started when they are needed.
    pub(super) fn new(program: Program) -> Self {
        Self {
            program,
            idle: Mutex::default(),
            unasked: Mutex::default(),
            files: OnceLock::new(),
            of_machine: OnceLock::new(),
        }
    }

    /// The files that the command names: as they are if they are looked at for the first time, and from then on as they were.
    pub(super) fn files(&self) -> &[NamedFile] {
        self.files.get_or_init(|| self.program.named_files().collect())
    }

    /// Why runs that were done since then do not count: a file of the command has changed, or the machine could not start a process or use a
    /// temporary folder, for which no run is to blame.
    pub(super) fn fault(&self) -> Option<String> {
        if let Some(problem) = self.of_machine.get() {
            return Some(problem.clone());
        }
        let changed = self.files().iter().find(|file| !file.is_as_it_was())?;
        let word = self.program.words()[changed.place].to_string_lossy();
        Some(format!(
            "the file {word:?}, which the command of the simulator names, was changed while runs were done, and runs of both would not go \
             together (what the simulator writes itself must not stand in its command)"
        ))
    }

    /// Makes certain that the command can be started: starts the first process, or finds the program if it is to be started
    /// for each run.
    pub(super) fn check(&self) -> Result<(), ProgramError> {
        let program = &self.program;
        let first = if program.is_per_run() {
            // It is not started without a run: nobody knows what it does then.
            found(program).map(|()| None)
        } else {
            Child::start(program).map(Some)
        };
        let first = first.map_err(|error| ProgramError::Start {
            command: program.shown(),
            problem: error.to_string(),
        })?;
        self.keep(first);
        Ok(())
    }

    /// Their command.
    pub(super) fn program(&self) -> &Program {
        &self.program
    }

    /// Whether each run has a process and files of its own.
    pub(super) fn is_per_run(&self) -> bool {
        self.program.is_per_run()
    }

    /// A process that waits, if there is one.
    pub(super) fn take(&self) -> Option<Child> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop()
    }

    /// Keeps a process for runs to come.
    pub(super) fn keep(&self, child: Option<Child>) {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).extend(child);
    }

    /// Sends the request of a run and gives the answer to `read`. `kept` is the process to ask, which is none afterwards
    /// if it had to be killed.
    ///
    /// A process that has done runs before may be blamed for what is theirs. If it does not answer as agreed, the run is
    /// sent once more to a process that is started for it, and what that does counts.
    pub(super) fn ask<T>(
        &self,
        request: &[u8],
        kept: &mut Option<Child>,
        read: impl Fn(&[u8]) -> Result<T, Trouble>,
    ) -> Result<T, Trouble> {
        // The runs that are done now are dropped, and each may take an hour.
        if self.of_machine.get().is_some() {
            return Err(Trouble::Stopped);
        }
        if self.is_per_run() {
            return self.ask_with_files(request, read);
        }
        let ask = |mut child: Child, kept: &mut Option<Child>| {
            let result =
                child.ask(request, self.program.patience()).and_then(|answer| read(&answer));
            if result.as_ref().map_or_else(Trouble::is_an_answer, |_| true) {
                *kept = Some(child);
            }
            result
        };
        // What came in the place of the answer, which was there already or came late.
        let mut beside = None;
        if let Some(mut child) = kept.take() {
            if child.is_quiet() {
                let result = ask(child, kept);
                if kept.is_some() || matches!(result, Err(Trouble::Stopped)) {
                    return result;
                }
                beside = result.err().and_then(Trouble::into_unasked);
            } else if !child.unasked().is_empty() {
                self.note(child.unasked());
            }
        }
        let child = Child::start(&self.program).map_err(|error| self.not_started(error))?;
        let result = ask(child, kept);
        // Asked alone, it answers: that was no answer to this run.
        if let (Some(text), true) = (beside, kept.is_some()) {
            self.note(&text);
        }
        result
    }

    /// Notes that a process wrote what nobody had asked for.
    fn note(&self, text: &[u8]) {
        let mut unasked = self.unasked.lock().unwrap_or_else(PoisonError::into_inner);
        let first = || Unasked { processes: 0, text: shown(text, TOLD) };
        unasked.get_or_insert_with(first).processes += 1;
    }

    /// What processes wrote that nobody had asked for, if they did.
    pub(super) fn unasked(&self) -> Option<Unasked> {
        self.unasked.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Notes that a process cannot be started: the command is the same for every run, so that no run is to blame for it.
    fn not_started(&self, error: io::Error) -> Trouble {
        self.of_machine.get_or_init(|| {
            let scarce = [Errno::MFILE, Errno::NFILE, Errno::AGAIN, Errno::NOMEM];
            let is_scarce = Errno::from_io_error(&error).is_some_and(|own| scarce.contains(&own));
            let remedy = if is_scarce {
                " (each thread has a process of its own, which needs open files and memory: --threads asks for fewer)"
            } else {
                ""
            };
            format!("the command `{}` cannot be started: {error}{remedy}", self.program.shown())
        });
        Trouble::Start(error)
    }

    /// Notes that the temporary folder of a run cannot be used.
    fn no_folder(&self, error: io::Error) -> Trouble {
        let place = std::env::temp_dir();
        // Without the name of the folder, which is another one each time: tempfile writes it behind what the system says.
        let said = error.to_string();
        let said = said.split_once(" at path ").map_or(&*said, |(said, _)| said);
        self.of_machine.get_or_init(|| {
            format!("a temporary folder for a run cannot be used in {}: {said}", place.display())
        });
        Trouble::Files(error)
    }

    /// That the file with the answer cannot be read: what the simulator left may be gone or forbidden, and everything else is for the machine
    /// to answer.
    fn unreadable(&self, error: io::Error) -> Trouble {
        match error.kind() {
            ErrorKind::NotFound | ErrorKind::PermissionDenied => Trouble::Files(error),
            _ => self.no_folder(error),
        }
    }

    /// Starts a process for one run, which reads and writes files, and gives the answer to `read`.
    fn ask_with_files<T>(
        &self,
        request: &[u8],
        read: impl Fn(&[u8]) -> Result<T, Trouble>,
    ) -> Result<T, Trouble> {
        let folder = tempfile::Builder::new().prefix("gyradius-run-").tempdir();
        let folder = folder.map_err(|error| self.no_folder(error))?;
        let input = fs::write(folder.path().join("input.json"), request);
        input.map_err(|error| self.no_folder(error))?;
        let child = Child::start_in(&self.program, folder.path());
        let mut child = child.map_err(|error| self.not_started(error))?;
        let ended = child.finish(self.program.patience());
        let answer = || {
            let answer = self.left(&folder.path().join("output.json"))?;
            read(&answer).map_err(Trouble::in_a_file)
        };
        match ended {
            Ok(()) => answer(),
            // Nothing may leave out a run that came to an infinite number, whatever became of the process after that.
            Err(failed @ (Trouble::Status { .. } | Trouble::Timeout { .. })) => {
                Err(failed.with_infinite_of(answer().err()))
            }
            Err(other) => Err(other),
        }
    }

    /// The file that a process left.
    fn left(&self, file: &Path) -> Result<Vec<u8>, Trouble> {
        match fs::symlink_metadata(file) {
            Ok(found) if found.is_file() => {}
            // A pipe would be waited for.
            Ok(found) => return Err(Trouble::NotAFile { what: what(found.file_type()) }),
            Err(e) if e.kind() == ErrorKind::NotFound => return Err(Trouble::NoFile),
            Err(e) => return Err(self.unreadable(e)),
        }
        let read = || {
            let mut answer = Vec::new();
            fs::File::open(file)?.take(LIMIT as u64 + 1).read_to_end(&mut answer)?;
            Ok(answer)
        };
        let answer = read().map_err(|error| self.unreadable(error))?;
        if answer.len() > LIMIT { Err(Trouble::TooLong { limit: LIMIT }) } else { Ok(answer) }
    }
}

impl Drop for Processes {
    fn drop(&mut self) {
        let mut idle = std::mem::take(self.idle.get_mut().unwrap_or_else(PoisonError::into_inner));
        idle.iter_mut().for_each(Child::close);
        let deadline = Instant::now() + PARTING;
        for child in &mut idle {
            child.ends_by(deadline);
        }
    }
}

/// What is no regular file.
fn what(kind: fs::FileType) -> &'static str {
    if kind.is_dir() {
        return "a folder";
    }
    if kind.is_symlink() {
        return "a symbolic link";
    }
    #[cfg(unix)]
    if std::os::unix::fs::FileTypeExt::is_fifo(&kind) {
        return "a named pipe";
    }
    "something else, such as a socket or a device,"
}

/// Whether a program is there to be started.
fn found(program: &Program) -> io::Result<()> {
    let name = program.words().first().ok_or(ErrorKind::InvalidInput)?;
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let in_path = || std::env::split_paths(&paths).map(|folder| folder.join(name));
    let is_path = Path::new(name).components().count() > 1;
    let is_there =
        |file: &Path| fs::metadata(file).is_ok_and(|file| file.is_file() && can_start(&file));
    if is_path && is_there(&program.folder().join(name))
        || !is_path && in_path().any(|file| is_there(&file))
    {
        return Ok(());
    }
    Err(io::Error::new(ErrorKind::NotFound, "there is no such program, or it must not be started"))
}

#[cfg(unix)]
fn can_start(file: &fs::Metadata) -> bool {
    use std::os::unix::fs::PermissionsExt;
    file.permissions().mode() & 0o111 != 0
}

#[cfg(not(unix))]
fn can_start(_: &fs::Metadata) -> bool {
    true
}
