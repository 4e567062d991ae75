//! How large the stack of a thread is that calls a function of the user's own.

use std::env;

/// Bytes of stack that the main thread of a program usually has.
const USUAL: usize = 8 << 20;
/// What says how large stacks of threads in Rust are at least, in bytes.
const LEAST: &str = "RUST_MIN_STACK";

/// Bytes of stack for a thread that calls a function of the user's own, which works in the main thread: 8 MiB as a main thread has, or
/// more if the limit of the process (`ulimit -s`) or `RUST_MIN_STACK` says more. Both are asked for anew each time.
#[must_use]
pub fn stack_size() -> usize {
    let said = env::var(LEAST).ok().and_then(|said| said.parse().ok());
    [limit(), said].into_iter().flatten().fold(USUAL, usize::max)
}

/// What the process allows its main thread; none if that has no limit.
#[cfg(unix)]
fn limit() -> Option<usize> {
    let limit = rustix::process::getrlimit(rustix::process::Resource::Stack);
    limit.current.and_then(|bytes| usize::try_from(bytes).ok())
}

/// What the process allows its main thread; it is not known here.
#[cfg(not(unix))]
fn limit() -> Option<usize> {
    None
}
