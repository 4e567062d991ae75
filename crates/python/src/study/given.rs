//! Scenarios as dictionaries, with the keys of the files.

use gyradius_study::{AnyScenario, ScenarioError, parse_toml, scenario_text};
use pyo3::{
    Bound, PyAny, PyErr, PyResult,
    types::{
        PyAnyMethods, PyBool, PyFloat, PyInt, PyMapping, PyMappingMethods, PyString, PyTypeMethods,
    },
};
use std::path::Path;
use toml::{Table, Value};

use crate::{
    error::{refused, unreadable},
    words::in_python,
};

/// Deepest nesting of a scenario.
const DEEPEST: usize = 32;
/// What the table of the simulation is called.
const SIMULATION: &str = "simulation";

/// What stands in a scenario file.
pub(super) fn read(path: &Path) -> PyResult<Table> {
    parse(&scenario_text(path).map_err(unread)?, path)
}

/// Why a scenario file cannot be read, or is refused.
pub(super) fn unread(error: ScenarioError) -> PyErr {
    match error {
        ScenarioError::Read { path, problem } => unreadable(&path, &problem),
        other => refused(other),
    }
}

/// What stands in a text that is from a file, or from the folder of a study.
pub(super) fn parse(text: &str, path: &Path) -> PyResult<Table> {
    parse_toml(text).map_err(|error| refused(format_args!("{}: {error}", path.display())))
}

/// A dictionary as the table of a file.
pub(super) fn table(given: &Bound<'_, PyAny>) -> PyResult<Table> {
    match value(given, "scenario", 0)? {
        Value::Table(table) => Ok(table),
        Value::String(_)
        | Value::Integer(_)
        | Value::Float(_)
        | Value::Boolean(_)
        | Value::Datetime(_)
        | Value::Array(_) => Err(refused("scenario: it must be a dictionary")),
    }
}

/// The scenario of a table in a folder; `function` and `outputs`, if given, stand in its table `simulation`.
pub(super) fn scenario(
    mut table: Table,
    folder: &Path,
    function: Option<String>,
    outputs: Option<&Bound<'_, PyAny>>,
) -> PyResult<AnyScenario> {
    if function.is_some() || outputs.is_some() {
        let simulation = table.entry(SIMULATION).or_insert_with(|| Table::new().into());
        let simulation = simulation
            .as_table_mut()
            .ok_or_else(|| refused(format_args!("{SIMULATION}: it must be a dictionary")))?;
        // A command is refused where the function is given.
        if let Some(function) = function.filter(|_| !simulation.contains_key("command")) {
            simulation.entry("function").or_insert_with(|| function.into());
        }
        if let Some(outputs) = outputs {
            simulation.insert("outputs".to_owned(), value(outputs, "outputs", 0)?);
        }
    }
    let text = toml::to_string(&table).map_err(refused)?;
    AnyScenario::from_toml(&text, folder).map_err(|error| match error {
        ScenarioError::Parse { message, .. } => refused(in_python(without_line(&message))),
        other => refused(other),
    })
}

/// A value of a dictionary, where `None` is as good as nothing.
fn value(given: &Bound<'_, PyAny>, path: &str, depth: usize) -> PyResult<Value> {
    if depth > DEEPEST {
        return Err(refused(format_args!("{path}: it must be nested less deep")));
    }
    // Flags are whole numbers in Python, and a scalar of NumPy may be a float: the narrower type first.
    if given.is_instance_of::<PyBool>() {
        return Ok(Value::Boolean(given.extract()?));
    }
    if given.is_instance_of::<PyInt>() {
        let whole = given.extract().map_err(|_| {
            refused(format_args!("{path}: a whole number must lie between -2⁶³ and 2⁶³ - 1"))
        })?;
        return Ok(Value::Integer(whole));
    }
    if given.is_instance_of::<PyFloat>() {
        return Ok(Value::Float(given.extract()?));
    }
    if given.is_instance_of::<PyString>() {
        return Ok(Value::String(given.extract()?));
    }
    if is_law_of_quantity(path)
        && let Some(kind) = given.getattr_opt("_kind")?
        && kind.extract::<&str>().is_ok_and(|kind| kind != "Scalar")
    {
        let law = given.repr()?;
        return Err(refused(format_args!("{path} = {law}: it must be a ScalarLaw")));
    }
    // Laws and regions have the form that they have in files.
    for what in ["form", "tolist", "__fspath__"] {
        if let Some(form) = given.getattr_opt(what)? {
            let form = if form.is_callable() { form.call0()? } else { form };
            return value(&form, path, depth + 1);
        }
    }
    if let Ok(mapping) = given.cast::<PyMapping>() {
        let mut table = Table::new();
        for item in mapping.items()?.try_iter()? {
            let (key, item): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item?.extract()?;
            let key: String = key
                .extract()
                .map_err(|_| refused(format_args!("{path}: its keys must be texts")))?;
            let path = if depth == 0 { key.clone() } else { format!("{path}.{key}") };
            if !item.is_none() {
                table.insert(key, value(&item, &path, depth + 1)?);
            }
        }
        return Ok(Value::Table(table));
    }
    let name = given.get_type().qualname()?;
    let problem = || {
        refused(format_args!(
            "{path}: {name}: it must be a number, a text, a flag, a list, a dictionary, an array or a law"
        ))
    };
    let entries = given.try_iter().map_err(|_| problem())?.enumerate();
    let entries =
        entries.map(|(i, entry)| value(&entry?, &format!("{path}[{}]", i + 1), depth + 1));
    Ok(Value::Array(entries.collect::<PyResult<_>>()?))
}

/// Whether the law of one of the quantities stands there, as in `quantities[1].law`.
fn is_law_of_quantity(path: &str) -> bool {
    let place = path.strip_prefix("quantities[").and_then(|rest| rest.strip_suffix("].law"));
    place.is_some_and(|place| place.bytes().all(|digit| digit.is_ascii_digit()))
}

/// A message without the place in a text that no user has written.
fn without_line(message: &str) -> &str {
    message.rsplit_once(" (line ").map_or(message, |(message, _)| message)
}
