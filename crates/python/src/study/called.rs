//! A function in Python that simulates runs.

use gyradius_campaign::{Outputs, RunInputs, SimulatorFunction};
use pyo3::{
    Bound, Py, PyAny, PyErr, PyResult, Python,
    exceptions::{PyException, PyOverflowError},
    types::{
        PyAnyMethods, PyDict, PyDictMethods, PyListMethods, PyMapping, PyMappingMethods,
        PyTypeMethods,
    },
};
use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicBool, Ordering},
};

/// A function in Python that simulates runs: it is called with a dictionary of the inputs, and one of what else there is to know of
/// the run, and returns a dictionary of the outputs. An exception is a failed run; what is no `Exception`, such as an interrupt,
/// stops the study.
#[derive(Clone)]
pub(super) struct Called {
    function: Arc<Py<PyAny>>,
    stop: Arc<AtomicBool>,
    interrupt: Arc<Mutex<Option<PyErr>>>,
}

impl Called {
    /// Which sets `stop` when it is interrupted, and is called no more once that is set.
    pub(super) fn new(function: Py<PyAny>, stop: Arc<AtomicBool>) -> Self {
        Self { function: Arc::new(function), stop, interrupt: Arc::default() }
    }

    /// As a simulator calls it.
    pub(super) fn function(&self) -> SimulatorFunction {
        let called = self.clone();
        SimulatorFunction::partly(move |inputs| {
            if called.stop.load(Ordering::Relaxed) {
                return (Outputs::new(), Some("stopped".to_owned()));
            }
            Python::attach(|py| {
                let mut outputs = Outputs::new();
                let failed = called.call(py, inputs, &mut outputs).err();
                (outputs, failed.map(|error| called.told(py, error)))
            })
        })
    }

    /// What interrupted it, if anything did, which is told once.
    pub(super) fn interrupt(&self) -> Option<PyErr> {
        self.interrupt.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Adds what is answered to the outputs; whatever else is wrong with the answer, those that are numbers.
    fn call(&self, py: Python<'_>, run: &RunInputs<'_>, outputs: &mut Outputs) -> PyResult<()> {
        let inputs = PyDict::new(py);
        run.inputs().try_for_each(|(name, number)| inputs.set_item(name, number))?;
        let about = PyDict::new(py);
        about.set_item("run", run.run())?;
        about.set_item("model", run.model())?;
        about.set_item("seed", run.seed())?;
        run.place().try_for_each(|(name, number)| about.set_item(name, number))?;
        let answer = self.function.bind(py).call1((inputs, about))?;
        let answer: &Bound<'_, PyMapping> = answer.cast().map_err(|_| {
            let found = type_name(&answer);
            wrong(format!(
                "the simulation returned {found}: it must return a dictionary of the outputs"
            ))
        })?;
        let mut wrong = None;
        for item in answer.items()?.iter() {
            match output(&item) {
                Ok(output) => outputs.push(output),
                Err(error) => {
                    wrong.get_or_insert(error);
                }
            }
        }
        wrong.map_or(Ok(()), Err)
    }

    /// Why a run failed, in the words of an exception.
    fn told(&self, py: Python<'_>, error: PyErr) -> String {
        let kind = error.get_type(py).qualname().map(|name| name.to_string());
        let kind = kind.unwrap_or_else(|_| "Exception".to_owned());
        let text = error.value(py).str().map(|text| text.to_string()).unwrap_or_default();
        if !error.is_instance_of::<PyException>(py) {
            self.stop.store(true, Ordering::Relaxed);
            *self.interrupt.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        }
        if text.trim().is_empty() { kind } else { format!("{kind}: {text}") }
    }
}

/// Whether a type of NumPy is one of real numbers: flags, whole numbers and floats; or is of another library, as the formats of 16 bits and
/// fewer that JAX has: NumPy takes these for raw bytes, whose letter they have not.
fn is_real(dtype: &Bound<'_, PyAny>) -> PyResult<bool> {
    let letter = |name| dtype.getattr(name)?.extract::<char>();
    let kind = letter("kind")?;
    Ok(['b', 'i', 'u', 'f'].contains(&kind) || (kind == 'V' && letter("char")? != kind))
}

/// An output with its name.
fn output(item: &Bound<'_, PyAny>) -> PyResult<(String, f64)> {
    let (name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
    let name: String = name.extract().map_err(|_| {
        wrong(format!("the name of an output is {}: it must be a text", type_name(&name)))
    })?;
    // NumPy makes numbers of complex ones, of texts and of bytes, too.
    let is_real = value.getattr("dtype").and_then(|dtype| is_real(&dtype)).unwrap_or(true);
    let number = if is_real { number(&value) } else { None };
    let number = number.ok_or_else(|| {
        wrong(format!("the output `{name}` is {}: it must be a number", type_name(&value)))
    })?;
    Ok((name, number))
}

/// The number that a value is. What no float can hold, as a long whole number, is infinite, as it is in the JSON of a command.
fn number(value: &Bound<'_, PyAny>) -> Option<f64> {
    value.extract().map_or_else(
        |error: PyErr| {
            let is_too_large = error.is_instance_of::<PyOverflowError>(value.py());
            let is_negative = is_too_large.then(|| value.lt(0).ok()).flatten()?;
            Some(if is_negative { f64::NEG_INFINITY } else { f64::INFINITY })
        },
        Some,
    )
}

fn type_name(value: &Bound<'_, PyAny>) -> String {
    let name = value.get_type().qualname();
    name.map_or_else(|_| "something else".to_owned(), |name| name.to_string())
}

fn wrong(problem: String) -> PyErr {
    pyo3::exceptions::PyTypeError::new_err(problem)
}
