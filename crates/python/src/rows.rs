//! Rows of numbers: in from NumPy without a copy, out made by all cores with the interpreter let go.

use gyradius_campaign::{StreamRng, Streams};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::{Bound, PyErr, PyResult, Python};
use rayon::prelude::*;
use std::{
    convert::Infallible,
    fmt::Display,
    sync::atomic::{AtomicBool, Ordering},
};

use crate::{
    cores::on_all,
    error::{refused, refused_row},
    stream::Draws,
};

/// Rows that one core does at a time: fewer than this many are not worth a second core.
const GRAIN: usize = 1024;
/// Rows for which memory is got at a time.
const SLICE: usize = 1 << 18;

/// Rows of `N` numbers, as they are in the memory of NumPy.
pub(crate) fn rows<'a, const N: usize>(
    array: &'a PyReadonlyArray2<'_, f64>,
) -> PyResult<&'a [[f64; N]]> {
    if array.shape()[1] != N {
        return Err(refused(format_args!(
            "rows of {} numbers: there must be {N}",
            array.shape()[1]
        )));
    }
    let flat =
        array.as_slice().map_err(|_| refused("the array must be contiguous, in the order of C"))?;
    Ok(flat.as_chunks::<N>().0)
}

/// Makes rows of `N` numbers, each from its place alone, and looks for an interrupt between whiles.
///
/// # Errors
/// The first row, in the order of their places, that cannot be made; or an interrupt.
pub(crate) fn made<'py, const N: usize, E: Display>(
    py: Python<'py>,
    count: usize,
    make: impl Fn(usize) -> Result<[f64; N], E> + Sync,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let made = try_make(py, count, [0.0; N], make)?;
    PyArray1::from_vec(py, made.into_flattened()).reshape([count, N])
}

/// The same of rows of one number.
fn made_one<'py, T: numpy::Element + Copy + Default, E: Display>(
    py: Python<'py>,
    count: usize,
    make: impl Fn(usize) -> Result<T, E> + Sync,
) -> PyResult<Bound<'py, PyArray1<T>>> {
    Ok(PyArray1::from_vec(py, try_make(py, count, T::default(), make)?))
}

/// The same where each can be made.
pub(crate) fn answered<'py, T: numpy::Element + Copy + Default>(
    py: Python<'py>,
    count: usize,
    answer: impl Fn(usize) -> T + Sync,
) -> PyResult<Bound<'py, PyArray1<T>>> {
    made_one(py, count, |row| Ok::<_, Infallible>(answer(row)))
}

/// Logarithms of a density, none if `somewhere`, anywhere at all, it is not known: that does not depend on where it is asked.
pub(crate) fn densities<'py>(
    py: Python<'py>,
    count: usize,
    somewhere: Option<f64>,
    at: impl Fn(usize) -> Option<f64> + Sync,
) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
    let at = |row| at(row).unwrap_or(f64::NAN);
    somewhere.map(|_| answered(py, count, at)).transpose()
}

/// What the density is of a row that is nothing that could be drawn.
pub(crate) fn density_of_nothing(row: &[f64]) -> Option<f64> {
    Some(if row.iter().any(|x| x.is_nan()) { f64::NAN } else { f64::NEG_INFINITY })
}

/// Draws rows of `N` numbers, each from a stream of its own. Most draws take about as many `u64` as `words` says, which
/// changes none of them.
pub(crate) fn drawn<'py, const N: usize>(
    py: Python<'py>,
    draws: &Draws,
    words: usize,
    draw: impl Fn(&mut StreamRng) -> [f64; N] + Sync,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let drawn = try_draw(py, draws, [0.0; N], words, draw)?;
    PyArray1::from_vec(py, drawn.into_flattened()).reshape([draws.count(), N])
}

/// The same of rows of one number.
pub(crate) fn drawn_one<'py>(
    py: Python<'py>,
    draws: &Draws,
    words: usize,
    draw: impl Fn(&mut StreamRng) -> f64 + Sync,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    Ok(PyArray1::from_vec(py, try_draw(py, draws, 0.0, words, draw)?))
}

fn try_draw<T: Copy + Send + Sync>(
    py: Python<'_>,
    draws: &Draws,
    zero: T,
    words: usize,
    draw: impl Fn(&mut StreamRng) -> T + Sync,
) -> PyResult<Vec<T>> {
    fill(py, draws.count(), zero, &|first, out, stop| {
        let goes_on = |_: &usize| !stop.load(Ordering::Relaxed);
        let rows = (first..first + out.len()).take_while(goes_on);
        let mut out = out.iter_mut();
        Streams::each(rows.map(|row| draws.stream(row)), words, |rng| {
            if let Some(out) = out.next() {
                *out = draw(rng);
            }
        });
        Ok(())
    })
}

fn try_make<T: Copy + Send + Sync, E: Display>(
    py: Python<'_>,
    count: usize,
    zero: T,
    make: impl Fn(usize) -> Result<T, E> + Sync,
) -> PyResult<Vec<T>> {
    fill(py, count, zero, &|first, out, stop| {
        for (row, out) in (first..).zip(out) {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            *out = make(row).map_err(|error| (row, error.to_string()))?;
        }
        Ok(())
    })
}

/// Fills some rows, from one of them on, or says which one cannot be made and why. It ends before they are filled once it is to stop.
type Fill<'a, T> = dyn Fn(usize, &mut [T], &AtomicBool) -> Result<(), (usize, String)> + Sync + 'a;

/// Fills rows, some at a time. What fills them is an object, so that the work of several cores is compiled once for a
/// type of rows, and not for each law.
fn fill<T: Copy + Send + Sync>(
    py: Python<'_>,
    count: usize,
    zero: T,
    some: &Fill<'_, T>,
) -> PyResult<Vec<T>> {
    let mut out = Vec::new();
    out.try_reserve_exact(count).map_err(|_| no_memory(count))?;
    let stop = AtomicBool::new(false);
    let mut start = 0;
    while start < count {
        let end = count.min(start + SLICE);
        let failed = if end - start <= GRAIN {
            py.detach(|| {
                out.resize(end, zero);
                some(start, &mut out[start..], &stop).err()
            })
        } else {
            on_all(py, &stop, || {
                out.resize(end, zero);
                out[start..]
                    .par_chunks_mut(GRAIN)
                    .enumerate()
                    .map(|(place, out)| some(place * GRAIN + start, out, &stop))
                    .filter_map(Result::err)
                    .min_by_key(|failed| failed.0)
            })?
        };
        if let Some((row, error)) = failed {
            return Err(refused_row(row, count, error));
        }
        py.check_signals()?;
        start = end;
    }
    Ok(out)
}

fn no_memory(count: usize) -> PyErr {
    pyo3::exceptions::PyMemoryError::new_err(format!("no memory for {count} rows"))
}

/// The matrix of a row of nine numbers, row by row.
pub(crate) fn matrix(row: &[f64; 9]) -> Matrix3<f64> {
    Matrix3::from_row_slice(row)
}

/// The row of a matrix.
pub(crate) fn row_of(matrix: &Matrix3<f64>) -> [f64; 9] {
    std::array::from_fn(|i| matrix[(i / 3, i % 3)])
}

/// The attitude of a row of four numbers, scalar last. The Python part has made its norm one.
pub(crate) fn attitude([x, y, z, w]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

/// The row of an attitude, scalar last.
pub(crate) fn row_of_attitude(attitude: &UnitQuaternion<f64>) -> [f64; 4] {
    attitude.coords.into()
}
