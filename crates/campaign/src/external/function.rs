//! A simulator that is a function of the program.

use std::{
    any::Any,
    fmt,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
};

use super::{answer::declared, inputs::RunInputs, trouble::Trouble};
use crate::column::Column;

/// What a function answers to a run: its outputs, each with its name, in any order.
pub type Outputs = Vec<(String, f64)>;

/// A function that simulates a run: it returns the outputs, or a text that says why the run failed.
///
/// It is called from several threads at the same time, and its answer should depend on the inputs and the seed alone.
/// Whatever it computes in parallel, its thread begins no other run before it has returned.
#[derive(Clone)]
pub struct SimulatorFunction(Arc<Run>);

type Run = dyn Fn(&RunInputs<'_>) -> Result<Outputs, String> + Send + Sync;

impl SimulatorFunction {
    /// Of a function of the program.
    pub fn new(
        function: impl Fn(&RunInputs<'_>) -> Result<Outputs, String> + Send + Sync + 'static,
    ) -> Self {
        Self(Arc::new(function))
    }

    /// Does a run, whatever becomes of it.
    ///
    /// # Errors
    /// The text that says why the run failed.
    pub fn run(&self, inputs: &RunInputs<'_>) -> Result<Outputs, String> {
        (self.0)(inputs)
    }

    /// Does a run, and gives the declared outputs in their order; `told` is shown what the function returned.
    pub(super) fn ask(
        &self,
        inputs: &RunInputs<'_>,
        outputs: &[Column],
        told: impl FnOnce(&Result<Outputs, String>),
    ) -> Result<Vec<f64>, Trouble> {
        // What a function leaves half done when it panics is its own.
        let answer = catch_unwind(AssertUnwindSafe(|| self.run(inputs)))
            .map_err(|panic| Trouble::Panicked { text: text(&*panic) })?;
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

/// What a panic says.
fn text(panic: &(dyn Any + Send)) -> Option<String> {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
}
