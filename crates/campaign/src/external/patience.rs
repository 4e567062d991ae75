//! How long a process is waited for: until a time, or until the campaign is stopped.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use super::trouble::Trouble;

/// Longest wait without a look at whether the campaign is stopped.
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
        if left.is_zero() || self.is_stopped() {
            return None;
        }
        Some(self.stop.map_or(left, |_| left.min(LOOK)))
    }

    /// Why it is over, of a process with this last line on standard error.
    pub(super) fn over(&self, last_line: Option<String>) -> Trouble {
        if self.is_stopped() {
            Trouble::Stopped
        } else {
            Trouble::Timeout { timeout: self.timeout, last_line }
        }
    }

    fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }
}
