//! A simulator that is a function of the program.

use std::{
    any::Any,
    fmt,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
};

use super::{answer::declared, beside::Beside, inputs::RunInputs, trouble::Trouble};
use crate::column::Column;

/// What a function answers to a run: its outputs, each with its name, in any order.
pub type Outputs = Vec<(String, f64)>;

/// A function that simulates a run: it returns the outputs, or a text that says why the run failed.
///
/// It is called from several threads at the same time, as many as do runs, and its answer should depend on the inputs and the seed alone.
/// Whatever it computes in parallel, no thread begins another run before it has returned.
#[derive(Clone)]
pub struct SimulatorFunction {
    run: Arc<Run>,
    beside: Arc<Beside>,
}

/// What became of a run: what the function returned, or what its panic says.
pub(super) type Answer = Result<Result<Outputs, String>, Option<String>>;

pub(super) type Run = dyn Fn(&RunInputs<'_>) -> Result<Outputs, String> + Send + Sync;

impl SimulatorFunction {
    /// Of a function of the program.
    pub fn new(
        function: impl Fn(&RunInputs<'_>) -> Result<Outputs, String> + Send + Sync + 'static,
    ) -> Self {
        Self { run: Arc::new(function), beside: Arc::default() }
    }

    /// Does a run, whatever becomes of it.
    ///
    /// # Errors
    /// The text that says why the run failed.
    pub fn run(&self, inputs: &RunInputs<'_>) -> Result<Outputs, String> {
        (self.run)(inputs)
    }

    /// Does a run, and gives the declared outputs in their order; `told` is shown what the function returned.
    pub(super) fn ask(
        &self,
        inputs: &RunInputs<'_>,
        outputs: &[Column],
        told: impl FnOnce(&Result<Outputs, String>),
    ) -> Result<Vec<f64>, Trouble> {
        let answer = match rayon::current_thread_index() {
            Some(_) => self.beside.call(&self.run, inputs.owned()).map_err(Trouble::Start)?,
            None => answer_of(&*self.run, inputs),
        };
        let answer = answer.map_err(|text| Trouble::Panicked { text })?;
        told(&answer);
        let answered = answer.map_err(|text| Trouble::Error { text })?;
        declared(answered, outputs, |number| *number, f64::to_string)
    }
}

impl fmt::Debug for SimulatorFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SimulatorFunction")
    }
}

/// Calls a function.
pub(super) fn answer_of(function: &Run, inputs: &RunInputs<'_>) -> Answer {
    // What a function leaves half done when it panics is its own.
    catch_unwind(AssertUnwindSafe(|| function(inputs))).map_err(|panic| text(&*panic))
}

/// What a panic says.
fn text(panic: &(dyn Any + Send)) -> Option<String> {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
}
