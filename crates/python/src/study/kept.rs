//! What a study kept of its runs, as arrays of NumPy, and the row of one run.

use gyradius_campaign::{Cell, KeptColumn, KeptRuns, KeptValues, Row};
use numpy::{IntoPyArray, PyArray1};
use pyo3::{
    Bound, IntoPyObject, PyAny, PyResult, Python,
    types::{PyDict, PyDictMethods, PyList},
};
use std::path::Path;

use crate::error::refused;

/// A column: name, unit of numbers that have one, meaning, and what stands in it.
pub(super) type Column<'py> = (String, Option<String>, String, Bound<'py, PyAny>);

/// The columns of the runs of a model that the study in a folder kept.
pub(super) fn columns<'py>(
    py: Python<'py>,
    folder: &Path,
    model: &str,
) -> PyResult<Vec<Column<'py>>> {
    let kept = py.detach(|| KeptRuns::read(folder, model).map_err(refused))?;
    let column = |column: KeptColumn| {
        let (name, unit) = (column.name().to_owned(), column.unit().map(str::to_owned));
        let meaning = column.meaning().to_owned();
        Ok((name, unit, meaning, values(py, column.into_values())?))
    };
    kept.into_columns().into_iter().map(column).collect()
}

/// Numbers as an array, NaN where there is none. Whole numbers and flags as an array, if every run has one, and otherwise as numbers, or as a
/// list with `None`. Texts as a list of those that there are, and an array of places in it, -1 where there is none.
fn values(py: Python<'_>, values: KeptValues) -> PyResult<Bound<'_, PyAny>> {
    Ok(match values {
        KeptValues::Numbers(numbers) => numbers.into_pyarray(py).into_any(),
        KeptValues::Integers(integers) => {
            match integers.iter().copied().collect::<Option<Vec<_>>>() {
                Some(all) => all.into_pyarray(py).into_any(),
                None => {
                    let number = |whole: Option<i64>| whole.map_or(f64::NAN, |whole| whole as f64);
                    PyArray1::from_iter(py, integers.into_iter().map(number)).into_any()
                }
            }
        }
        KeptValues::Flags(flags) => match flags.iter().copied().collect::<Option<Vec<_>>>() {
            Some(all) => all.into_pyarray(py).into_any(),
            None => PyList::new(py, flags)?.into_any(),
        },
        KeptValues::Texts(texts) => {
            let place = |place: &Option<u32>| place.map_or(-1, i64::from);
            let places = PyArray1::from_iter(py, texts.of_run().iter().map(place));
            (texts.distinct(), places).into_pyobject(py)?.into_any()
        }
    })
}

/// What stands in the columns of a row, for as long as one likes.
pub(super) fn cells(row: &Row<'_>) -> Vec<(String, Cell<'static>)> {
    row.cells().map(|(column, cell)| (column.name().to_owned(), cell.into_owned())).collect()
}

/// A row as a dictionary.
pub(super) fn row<'py>(
    py: Python<'py>,
    cells: Vec<(String, Cell<'static>)>,
) -> PyResult<Bound<'py, PyDict>> {
    let row = PyDict::new(py);
    for (name, cell) in cells {
        match cell {
            Cell::Number(number) => row.set_item(name, number)?,
            Cell::Integer(integer) => row.set_item(name, integer)?,
            Cell::Text(text) | Cell::Note { text, .. } => row.set_item(name, text)?,
            Cell::Flag(flag) => row.set_item(name, flag)?,
            Cell::Null => row.set_item(name, py.None())?,
        }
    }
    Ok(row)
}
