//! Signals. Being told to stop: what is at hand is ended in good order, and at the second time at once.

#[cfg(unix)]
use signal_hook::consts::SIGXFSZ;
use signal_hook::{
    consts::{SIGINT, SIGTERM},
    flag,
};
use std::{
    io,
    process::ExitCode,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
};

/// The signals that ask the program to stop: an interrupt from the keyboard, and termination.
const ASKING: [i32; 2] = [SIGINT, SIGTERM];

/// Watches for signals.
#[derive(Debug)]
pub(crate) struct Signals {
    stop: Arc<AtomicBool>,
    which: Arc<AtomicUsize>,
}

impl Signals {
    /// From now on.
    pub(crate) fn watch() -> io::Result<Self> {
        let (stop, which) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
        for signal in ASKING {
            // In this order: the first one sets what makes the second one end the program.
            flag::register_conditional_shutdown(signal, code(signal).into(), Arc::clone(&stop))?;
            flag::register_usize(signal, Arc::clone(&which), signal.unsigned_abs() as usize)?;
            flag::register(signal, Arc::clone(&stop))?;
        }
        Ok(Self { stop, which })
    }

    /// Becomes true when the program is to stop.
    pub(crate) fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// What a program that was stopped so returns: 130 after an interrupt, 143 after termination.
    pub(crate) fn code(&self) -> ExitCode {
        let which = self.which.load(Ordering::Relaxed);
        let signal = ASKING.into_iter().find(|signal| signal.unsigned_abs() as usize == which);
        ExitCode::from(code(signal.unwrap_or(SIGINT)))
    }
}

/// From now on, a file that would grow beyond the limit of its size (`ulimit -f`) is an error like a full disk, and does not end
/// the program without a word. What the program starts is not touched: a handler is not inherited.
#[cfg(unix)]
pub(crate) fn survive_large_files() -> io::Result<()> {
    flag::register(SIGXFSZ, Arc::default()).map(|_| ())
}

/// There is no such signal.
#[cfg(not(unix))]
pub(crate) fn survive_large_files() -> io::Result<()> {
    Ok(())
}

/// By the convention of shells.
fn code(signal: i32) -> u8 {
    128_u8.saturating_add(signal.unsigned_abs() as u8)
}
