//! How long a process is waited for: until a time, or until the campaign is stopped.

use std::{
    sync::atomic::AtomicBool,
    time::{Duration, Instant},
};

use super::trouble::Trouble;
use crate::stop::is_stopped;

/// Longest wait without a look at whether the campaign is stopped, or the process has ended.
const LOOK: Duration = Duration::from_millis(50);

/// How long a process is waited for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience<'a> {
    timeout: Duration,
    deadline: Instant,
    stop: Option<&'a AtomicBool>,
}

impl<'a> Patience<'a> {
    /// So long from now on, unless `stop` becomes true before.
    pub(super) fn new(timeout: Duration, stop: Option<&'a AtomicBool>) -> Self {
        Self { timeout, deadline: Instant::now() + timeout, stop }
    }

    /// How long to wait before the next look; none if it is over.
    pub(super) fn next_wait(&self) -> Option<Duration> {
        let left = self.deadline.saturating_duration_since(Instant::now());
        if left.is_zero() || is_stopped(self.stop) {
            return None;
        }
        Some(left.min(LOOK))
    }

    /// Why it is over, of a process with this last line on standard error.
    pub(super) fn over(&self, last_line: Option<String>) -> Trouble {
        if is_stopped(self.stop) {
            Trouble::Stopped
        } else {
            Trouble::Timeout { timeout: self.timeout, last_line }
        }
    }
}
