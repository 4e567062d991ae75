//! Threads beside those that do runs, for functions of the user's own to be called in.
//!
//! A thread of rayon that waits for a loop of rayon does other work meanwhile, which here is another run. A function that computes
//! with rayon would so be called again in the middle of its run, on the same stack, as often as there are runs. A thread that is
//! not one of rayon's only waits.

use std::{
    io,
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{Receiver, Sender, channel},
    },
    thread,
};

use super::{
    function::{Answer, Run, answer_of},
    inputs::OwnedInputs,
};

/// Such threads, which are kept for the runs to come.
#[derive(Debug, Default)]
pub(super) struct Beside(Mutex<Vec<Helper>>);

/// A thread that waits for a run. It ends when this is dropped.
#[derive(Debug)]
struct Helper {
    runs: Sender<(Arc<Run>, OwnedInputs)>,
    answers: Receiver<Answer>,
}

impl Beside {
    /// Calls a function in such a thread, and waits for it.
    ///
    /// # Errors
    /// There can be no such thread.
    pub(super) fn call(&self, function: &Arc<Run>, inputs: OwnedInputs) -> io::Result<Answer> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let helper = kept.map_or_else(Helper::begin, Ok)?;
        // What a function does is caught: no thread ends before its helper is dropped.
        let gone = || io::Error::other("the thread of the function has ended");
        helper.runs.send((Arc::clone(function), inputs)).map_err(|_| gone())?;
        let answer = helper.answers.recv().map_err(|_| gone())?;
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(helper);
        Ok(answer)
    }
}

impl Helper {
    fn begin() -> io::Result<Self> {
        let (runs, asked) = channel::<(Arc<Run>, OwnedInputs)>();
        let (answered, answers) = channel();
        thread::Builder::new().name("function".to_owned()).spawn(move || {
            for (function, inputs) in asked {
                let answer = answer_of(&*function, &inputs.borrowed());
                // Whoever asked may drop the last of it then.
                drop(function);
                if answered.send(answer).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self { runs, answers })
    }
}
