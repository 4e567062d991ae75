//! What takes long, in a thread of its own, while the thread that called looks for interrupts and tells of progress.

use gyradius_campaign::{CampaignError, stack_size};
use gyradius_study::StudyError;
use pyo3::{Py, PyAny, PyErr, PyResult, Python, exceptions::PySystemExit, pyfunction};
use std::{
    panic::resume_unwind,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering},
        mpsc::{self, RecvTimeoutError},
    },
    thread,
    time::{Duration, Instant},
};

use super::{called::Called, words::in_keywords};
use crate::error::refused;

/// How long the calling thread waits between looks.
const LOOK: Duration = Duration::from_millis(50);

/// How long the end of a program waits for the runs at hand.
const LAST_WAIT: Duration = Duration::from_secs(10);

/// Whether the program ends.
static ENDS: AtomicBool = AtomicBool::new(false);
/// How many are at work.
static AT_WORK: AtomicUsize = AtomicUsize::new(0);

/// One that is at work, until it is dropped.
struct AtWork;

impl AtWork {
    fn new() -> Self {
        AT_WORK.fetch_add(1, Ordering::SeqCst);
        Self
    }
}

impl Drop for AtWork {
    fn drop(&mut self) {
        AT_WORK.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Ends what is at work in daemon threads before the interpreter goes: a thread of ours that came back to it afterwards would abort the
/// program.
#[pyfunction]
pub(crate) fn end_all(py: Python<'_>) {
    ENDS.store(true, Ordering::SeqCst);
    let until = Instant::now() + LAST_WAIT;
    py.detach(|| {
        while AT_WORK.load(Ordering::SeqCst) > 0 && Instant::now() < until {
            thread::sleep(LOOK / 10);
        }
    });
}

/// Told how many runs are done, of how many.
type More<'a> = &'a (dyn Fn(u64, u64) + Sync);

/// What takes long, in a thread of its own. Signals, such as that of Ctrl-C, are looked for by the thread that called, which is the only
/// one that Python tells of them; so the function in Python may run in any thread.
pub(super) struct Watched {
    stop: Arc<AtomicBool>,
    progress: Option<Py<PyAny>>,
}

impl Watched {
    /// With a function in Python that is told how many runs are done, of how many, if there is one.
    pub(super) fn new(progress: Option<Py<PyAny>>) -> Self {
        Self { stop: Arc::default(), progress }
    }

    /// Set once it is to stop.
    pub(super) fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Does the work with the interpreter let go.
    ///
    /// # Errors
    /// What interrupted it, if anything did; what went wrong with the work or the function that is told of progress.
    pub(super) fn run<T: Send>(
        &self,
        py: Python<'_>,
        called: Option<&Called>,
        work: impl FnOnce(More<'_>) -> Result<T, StudyError> + Send,
    ) -> PyResult<T> {
        let _at_work = AtWork::new();
        let (done, total) = (AtomicU64::new(0), AtomicU64::new(0));
        let more = |runs: u64, of: u64| {
            total.store(of, Ordering::Relaxed);
            done.fetch_max(runs, Ordering::Relaxed);
        };
        let mut raised = None;
        let mut told = 0;
        let mut look = || {
            let runs = done.load(Ordering::Relaxed);
            let looked = Python::attach(|py| {
                py.check_signals()?;
                if ENDS.load(Ordering::SeqCst) {
                    // Which a thread does not tell of.
                    return Err(PySystemExit::new_err("the program ends"));
                }
                match &self.progress {
                    Some(progress) if runs > told => {
                        progress.call1(py, (runs, total.load(Ordering::Relaxed))).map(|_| ())
                    }
                    Some(_) | None => Ok(()),
                }
            });
            told = runs;
            looked
        };
        let result = py.detach(|| {
            thread::scope(|scope| {
                let (ended, end) = mpsc::channel::<()>();
                let more = &more;
                // The function in Python, which may tell its outputs first, is called in it too.
                let worker = thread::Builder::new().stack_size(stack_size());
                let worker = worker.spawn_scoped(scope, move || {
                    // It is dropped when the work has ended, or panics.
                    let _ended = ended;
                    work(more)
                });
                let worker =
                    worker.map_err(|e| CampaignError::Threads { problem: e.to_string() })?;
                while end.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                    if raised.is_none()
                        && let Err(error) = look()
                    {
                        self.stop.store(true, Ordering::Relaxed);
                        raised = Some(error);
                    }
                }
                worker.join().unwrap_or_else(|panic| resume_unwind(panic))
            })
        });
        let interrupt: Option<PyErr> = called.and_then(Called::interrupt);
        if let Some(error) = interrupt.or(raised) {
            return Err(error);
        }
        let result = result.map_err(|error| refused(in_keywords(&error)))?;
        look()?;
        Ok(result)
    }
}
