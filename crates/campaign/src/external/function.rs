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

type Run = dyn Fn(&RunInputs<'_>) -> (Outputs, Option<String>) + Send + Sync;

impl SimulatorFunction {
    /// Of a function of the program.
    pub fn new(
        function: impl Fn(&RunInputs<'_>) -> Result<Outputs, String> + Send + Sync + 'static,
    ) -> Self {
        Self::partly(move |inputs| match function(inputs) {
            Ok(outputs) => (outputs, None),
            Err(text) => (Outputs::new(), Some(text)),
        })
    }

    /// Of a function of the program that returns outputs also of a run that failed, with the text that says why: those of them that
    /// are infinite stay in the row.
    pub fn partly(
        function: impl Fn(&RunInputs<'_>) -> (Outputs, Option<String>) + Send + Sync + 'static,
    ) -> Self {
        Self(Arc::new(function))
    }

    /// Does a run, whatever becomes of it.
    ///
    /// # Errors
    /// The text that says why the run failed.
    pub fn run(&self, inputs: &RunInputs<'_>) -> Result<Outputs, String> {
        match (self.0)(inputs) {
            (outputs, None) => Ok(outputs),
            (_, Some(text)) => Err(text),
        }
    }

    /// Does a run, and gives the declared outputs in their order; `told` is shown what the function returned.
    pub(super) fn ask(
        &self,
        inputs: &RunInputs<'_>,
        outputs: &[Column],
        told: impl FnOnce(&Outputs, Option<&str>),
    ) -> Result<Vec<f64>, Trouble> {
        // What a function leaves half done when it panics is its own.
        let (answered, failed) = catch_unwind(AssertUnwindSafe(|| (self.0)(inputs)))
            .map_err(|panic| Trouble::Panicked { text: text(&*panic) })?;
        told(&answered, failed.as_deref());
        let numbers = declared(answered, outputs, |number| *number, f64::to_string);
        let Some(text) = failed else { return numbers };
        Err(Trouble::Error { text }.with_infinite_of(numbers.err()))
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
