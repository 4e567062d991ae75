//! A process of a simulator in a group of its own, with pipes that are never waited for beyond a deadline.

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    io::{Errno, ioctl_fionbio},
    process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid},
};
use std::{
    io::{self, ErrorKind, Read, Write},
    os::{fd::AsFd, unix::process::CommandExt},
    path::Path,
    process::{Child as Process, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio},
    time::{Duration, Instant},
};

use super::{LIMIT, patience::Patience, program::Program, tail::Tail, trouble::Trouble};

/// How long a process that has closed its pipes may take to end, so that its status is told.
const ENDING: Duration = Duration::from_secs(1);
/// Shortest and longest time between two looks at whether a process has ended.
const LOOKS: [Duration; 2] = [Duration::from_micros(200), Duration::from_millis(2)];

/// A process of a simulator. When it is dropped, it and everything in its group is killed.
#[derive(Debug)]
pub(super) struct Child {
    process: Process,
    input: Option<ChildStdin>,
    output: Option<ChildStdout>,
    errors: Option<ChildStderr>,
    /// Set once its status has been taken: its number may be another process's from then on.
    taken: bool,
    /// When it was first seen that it has ended.
    ended: Option<Instant>,
    tail: Tail,
    /// What came of standard output: lines that are not taken yet.
    arrived: Vec<u8>,
    /// Bytes are read into here.
    buffer: Box<[u8]>,
}

/// What came of a pipe that is read without waiting.
enum Arrived {
    Bytes,
    Nothing,
    End,
}

impl Child {
    /// Starts a process that is asked line by line.
    pub(super) fn start(program: &Program) -> io::Result<Self> {
        Self::begin(program, program.folder(), Stdio::piped, Stdio::piped)
    }

    /// Starts a process in a folder that reads and writes files there.
    pub(super) fn start_in(program: &Program, folder: &Path) -> io::Result<Self> {
        Self::begin(program, folder, Stdio::null, Stdio::null)
    }

    fn begin(
        program: &Program,
        folder: &Path,
        input: fn() -> Stdio,
        output: fn() -> Stdio,
    ) -> io::Result<Self> {
        let [first, others @ ..] = program.words() else {
            return Err(ErrorKind::InvalidInput.into());
        };
        let mut command = Command::new(first);
        command.args(others).current_dir(folder).process_group(0);
        command.stdin(input()).stdout(output()).stderr(Stdio::piped());
        let mut process = command.spawn()?;
        let child = Self {
            input: process.stdin.take(),
            output: process.stdout.take(),
            errors: process.stderr.take(),
            process,
            taken: false,
            ended: None,
            tail: Tail::default(),
            arrived: Vec::new(),
            buffer: vec![0; 64 << 10].into(),
        };
        // Ours are other descriptions than those of the process, which does not see this.
        child.input.as_ref().map_or(Ok(()), |pipe| ioctl_fionbio(pipe, true))?;
        child.output.as_ref().map_or(Ok(()), |pipe| ioctl_fionbio(pipe, true))?;
        child.errors.as_ref().map_or(Ok(()), |pipe| ioctl_fionbio(pipe, true))?;
        Ok(child)
    }

    /// Whether it has its pipes open and has written nothing that was not asked for.
    pub(super) fn is_quiet(&mut self) -> bool {
        self.arrived.is_empty() && matches!(self.read_output(), Ok(Arrived::Nothing))
    }

    /// What it has written that was not asked for, as far as it was read.
    pub(super) fn unasked(&self) -> &[u8] {
        &self.arrived
    }

    /// Sends a line, without its end, and takes the line that is the answer. What comes after that was not asked for,
    /// whether it comes at once or later.
    pub(super) fn ask(&mut self, line: &[u8], patience: Patience<'_>) -> Result<Vec<u8>, Trouble> {
        let mut left = line;
        // Lines that have no end yet are searched once.
        let mut searched = 0;
        loop {
            if !left.is_empty() {
                match self.input.as_mut().map(|input| input.write(left)) {
                    Some(Ok(written)) => left = &left[written..],
                    Some(Err(e)) if waits(&e) => {}
                    Some(Err(_)) | None => return Err(self.gone()),
                }
            }
            let Some([reads, complains]) = self.wait(!left.is_empty(), patience) else {
                let (_, last_line) = self.kill();
                return Err(patience.over(last_line));
            };
            if complains {
                self.read_errors();
            }
            if !reads {
                // What it started may hold its pipes open, and answers to nobody.
                if self.has_ended_for(ENDING) {
                    return Err(self.gone());
                }
                continue;
            }
            match self.read_output() {
                Ok(Arrived::Bytes) => {}
                Ok(Arrived::Nothing) => continue,
                Ok(Arrived::End) | Err(_) => return Err(self.gone()),
            }
            let end = self.arrived[searched..].iter().position(|byte| *byte == b'\n');
            let length = end.map_or(self.arrived.len(), |end| searched + end);
            if length > LIMIT {
                return Err(Trouble::TooLong { limit: LIMIT });
            }
            searched = length;
            if end.is_some() {
                if !left.is_empty() {
                    return Err(Trouble::Early { text: std::mem::take(&mut self.arrived) });
                }
                let rest = self.arrived.split_off(length + 1);
                self.arrived.truncate(length);
                return Ok(std::mem::replace(&mut self.arrived, rest));
            }
        }
    }

    /// Waits until it has ended by itself, well.
    pub(super) fn finish(&mut self, patience: Patience<'_>) -> Result<(), Trouble> {
        let ended = self.ends_within(patience);
        match self.kill() {
            (_, last_line) if !ended => Err(patience.over(last_line)),
            (Some(status), last_line) if !status.success() => {
                Err(Trouble::Status { status, last_line })
            }
            (Some(_) | None, _) => Ok(()),
        }
    }

    /// Closes its standard input, upon which it should end.
    pub(super) fn close(&mut self) {
        self.input = None;
    }

    /// Waits until it has ended or until the deadline, whatever it writes.
    pub(super) fn ends_by(&mut self, deadline: Instant) -> bool {
        let left = deadline.saturating_duration_since(Instant::now());
        self.ends_within(Patience::new(left, None))
    }

    fn ends_within(&mut self, patience: Patience<'_>) -> bool {
        let [mut pause, longest] = LOOKS;
        loop {
            self.read_errors();
            if self.output.is_some() && !matches!(self.read_output(), Ok(Arrived::Nothing)) {
                self.arrived.clear();
            }
            // Asked before: what has ended by then has ended in time.
            let wait = patience.next_wait();
            if self.has_ended() {
                return true;
            }
            let Some(wait) = wait else { return false };
            std::thread::sleep(pause.min(wait));
            pause = (2 * pause).min(longest);
        }
    }

    /// Why it does not take or give lines any more.
    fn gone(&mut self) -> Trouble {
        let ended = self.ends_by(Instant::now() + ENDING);
        match self.kill() {
            (Some(status), last_line) if ended => Trouble::Ended { status, last_line },
            (_, last_line) => Trouble::Closed { last_line },
        }
    }

    /// Kills it with everything in its group; returns its status and its last line on standard error.
    fn kill(&mut self) -> (Option<ExitStatus>, Option<String>) {
        let mut status = None;
        if !self.taken {
            // Its number is not given to another process or group as long as its status has not been taken.
            if let Some(group) = Pid::from_raw(self.process.id().cast_signed()) {
                // There may be nothing left of it.
                kill_process_group(group, Signal::KILL).ok();
            }
            // A killed process goes at once, unless the system holds it.
            let deadline = Instant::now() + ENDING;
            while !self.has_ended() && Instant::now() < deadline {
                std::thread::sleep(LOOKS[0]);
            }
            if self.has_ended() {
                self.taken = true;
                status = self.process.wait().ok();
            }
        }
        self.read_errors();
        (status, self.tail.last_line())
    }

    /// Whether it has ended. It stays for its status to be taken, and its number with it.
    fn has_ended(&self) -> bool {
        let Some(process) = Pid::from_raw(self.process.id().cast_signed()) else { return true };
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        match waitid(WaitId::Pid(process), options) {
            Ok(status) => status.is_some(),
            // It has been waited for.
            Err(error) => error != Errno::INTR,
        }
    }

    /// Whether it has been seen for so long that it has ended.
    fn has_ended_for(&mut self, time: Duration) -> bool {
        self.has_ended() && self.ended.get_or_insert_with(Instant::now).elapsed() >= time
    }

    /// Waits a while until there is something to read on standard output or standard error, which it tells apart, or room to
    /// write; none if there is nothing in time.
    fn wait(&self, writes: bool, patience: Patience<'_>) -> Option<[bool; 2]> {
        loop {
            let left = patience.next_wait().unwrap_or_default();
            let timeout = Timespec {
                tv_sec: left.as_secs().try_into().ok()?,
                tv_nsec: left.subsec_nanos().into(),
            };
            let mut pipes = Vec::with_capacity(3);
            let output = self.output.as_ref().map(AsFd::as_fd);
            let errors = self.errors.as_ref().map(AsFd::as_fd);
            let input = self.input.as_ref().map(AsFd::as_fd).filter(|_| writes);
            pipes.extend(output.map(|pipe| PollFd::from_borrowed_fd(pipe, PollFlags::IN)));
            pipes.extend(errors.map(|pipe| PollFd::from_borrowed_fd(pipe, PollFlags::IN)));
            pipes.extend(input.map(|pipe| PollFd::from_borrowed_fd(pipe, PollFlags::OUT)));
            match poll(&mut pipes, Some(&timeout)) {
                Ok(0) if left.is_zero() => return None,
                Ok(0) => return Some([false; 2]),
                Ok(_) => {
                    let mut ready = pipes.iter().map(|pipe| !pipe.revents().is_empty());
                    let mut next = |there: bool| there && ready.next().unwrap_or(false);
                    return Some([next(output.is_some()), next(errors.is_some())]);
                }
                Err(Errno::INTR) => {}
                Err(_) => return None,
            }
        }
    }

    fn read_output(&mut self) -> io::Result<Arrived> {
        let Some(output) = &mut self.output else { return Ok(Arrived::End) };
        match output.read(&mut self.buffer) {
            Ok(0) => Ok(Arrived::End),
            Ok(length) => {
                self.arrived.extend_from_slice(&self.buffer[..length]);
                Ok(Arrived::Bytes)
            }
            Err(e) if waits(&e) => Ok(Arrived::Nothing),
            Err(e) => Err(e),
        }
    }

    /// Takes what there is on standard error, but not for ever.
    fn read_errors(&mut self) {
        for _ in 0..64 {
            let Some(errors) = &mut self.errors else { return };
            match errors.read(&mut self.buffer) {
                Ok(0) => self.errors = None,
                Ok(length) => self.tail.push(&self.buffer[..length]),
                Err(e) if waits(&e) => return,
                Err(_) => self.errors = None,
            }
        }
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Whether a pipe has nothing now.
fn waits(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}
