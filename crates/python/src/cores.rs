//! The threads that fill rows, also in a process that was forked from one that had them.

use gyradius_campaign::threads;
use pyo3::{PyErr, PyResult, Python, exceptions::PyOSError};
use rayon::ThreadPool;
use std::{
    mem,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, RecvTimeoutError},
    },
    time::Duration,
};

/// How long the thread that called waits between looks for an interrupt.
const LOOK: Duration = Duration::from_millis(50);

/// The threads, and the process whose threads they are.
static CORES: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Does some work with all cores, or as many as `RAYON_NUM_THREADS` says, with the interpreter let go. The thread that called looks for
/// interrupts meanwhile: after one, `stop` is set, and the work is to end soon.
///
/// A fork, as by `multiprocessing` on Linux, leaves the threads behind: whoever waits for them waits for ever. So each
/// process has threads of its own.
///
/// # Errors
/// An interrupt; the threads cannot be started.
pub(crate) fn on_all<T: Send>(
    py: Python<'_>,
    stop: &AtomicBool,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    py.detach(|| {
        let cores = cores()?;
        let (ended, end) = mpsc::sync_channel(1);
        let mut interrupt = None;
        let done = cores.in_place_scope(|scope| {
            // The sender is dropped when the work has ended, or panics.
            scope.spawn(move |_| {
                // Nobody who waits for it goes away.
                let _ = ended.send(work());
            });
            loop {
                match end.recv_timeout(LOOK) {
                    Ok(done) => return Some(done),
                    Err(RecvTimeoutError::Disconnected) => return None,
                    Err(RecvTimeoutError::Timeout) if interrupt.is_none() => {
                        interrupt = look().err();
                        stop.store(interrupt.is_some(), Ordering::Relaxed);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                }
            }
        });
        match (interrupt, done) {
            (None, Some(done)) => Ok(done),
            (Some(interrupt), _) => Err(interrupt),
            // The scope panics where the work does.
            (None, None) => Err(PyOSError::new_err("the threads ended before their work")),
        }
    })
}

/// Looks for an interrupt, with the interpreter let go; there is none in a program that ends.
///
/// # Errors
/// An interrupt.
fn look() -> PyResult<()> {
    let looked = Python::try_attach(|py| {
        py.check_signals()?;
        Ok(())
    });
    looked.unwrap_or(Ok(()))
}

/// The threads of this process. Where another thread is just getting them, some for this call alone.
fn cores() -> PyResult<Arc<ThreadPool>> {
    // Whoever held this while another thread forked holds it for ever in the child.
    let Ok(mut known) = CORES.try_lock() else { return new() };
    let process = std::process::id();
    if let Some((whose, cores)) = &*known
        && *whose == process
    {
        return Ok(Arc::clone(cores));
    }
    let cores = new()?;
    // The threads of another process cannot be ended from here.
    mem::forget(known.replace((process, Arc::clone(&cores))));
    Ok(cores)
}

fn new() -> PyResult<Arc<ThreadPool>> {
    threads(None).map(Arc::new).map_err(|error| -> PyErr { PyOSError::new_err(error.to_string()) })
}
