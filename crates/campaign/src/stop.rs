//! Whether a campaign was told to stop, from another thread.

use std::sync::atomic::{AtomicBool, Ordering};

/// Whether it was; nobody can if there is nothing that says so.
#[must_use]
pub fn is_stopped(stop: Option<&AtomicBool>) -> bool {
    stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
}
