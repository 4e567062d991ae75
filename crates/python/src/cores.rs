//! The threads that fill rows, also in a process that was forked from one that had them.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::{
    mem,
    sync::{Arc, Mutex},
};

/// The threads, and the process whose threads they are.
static CORES: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Does some work with all cores, or as many as `RAYON_NUM_THREADS` says.
///
/// A fork, as by `multiprocessing` on Linux, leaves the threads behind: whoever waits for them waits for ever. So each
/// process has threads of its own.
pub(crate) fn on_all<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match cores() {
        Some(cores) => cores.install(work),
        None => work(),
    }
}

/// None where threads cannot be had now, or another thread is just getting them: rayon's own do the work then.
fn cores() -> Option<Arc<ThreadPool>> {
    // Whoever held this while another thread forked holds it for ever in the child.
    let mut known = CORES.try_lock().ok()?;
    let process = std::process::id();
    if let Some((whose, cores)) = &*known
        && *whose == process
    {
        return Some(Arc::clone(cores));
    }
    let cores = Arc::new(ThreadPoolBuilder::new().build().ok()?);
    // The threads of another process cannot be ended from here.
    mem::forget(known.replace((process, Arc::clone(&cores))));
    Some(cores)
}
