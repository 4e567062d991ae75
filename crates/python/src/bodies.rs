//! Mass, mass centre and inertia of many bodies: moved, turned, added, and in other coordinates.

use gyradius_dispersion::TenParameters;
use gyradius_inertia::{LogCholesky, MassProperties, PseudoInertia};
use gyradius_study::inset;
use nalgebra::{Isometry3, Matrix4, Translation3, Vector3};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::{Bound, PyResult, Python, pyfunction};

use crate::rows::{attitude, made, row_of, row_of_attitude, rows};

/// The body of ten numbers.
pub(crate) fn body(ten: &[f64; 10]) -> Result<MassProperties, String> {
    let ten = TenParameters::from_values(*ten).map_err(|error| error.to_string())?;
    MassProperties::try_from(ten).map_err(|error| error.to_string())
}

/// Its ten numbers.
pub(crate) fn ten(body: MassProperties) -> [f64; 10] {
    TenParameters::from(body).values()
}

/// Makes rows of rows of bodies.
fn of_each<'py, const N: usize>(
    py: Python<'py>,
    bodies: &PyReadonlyArray2<'py, f64>,
    make: impl Fn(usize, MassProperties) -> Result<[f64; N], String> + Sync,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let all = rows::<10>(bodies)?;
    made(py, all.len(), |i| make(i, body(&all[i])?))
}

/// The bodies turned and then moved: rows of a quaternion, scalar last, and a translation.
#[pyfunction]
pub(crate) fn body_transform<'py>(
    py: Python<'py>,
    bodies: PyReadonlyArray2<'py, f64>,
    poses: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let poses = rows::<7>(&poses)?;
    of_each(py, &bodies, |i, body| {
        let [x, y, z, w, a, b, c] = poses[i];
        let pose = Isometry3::from_parts(Translation3::new(a, b, c), attitude([x, y, z, w]));
        body.transformed(&pose).map(ten).map_err(|error| error.to_string())
    })
}

/// The bodies a little inside of what bodies can have, as robots are written.
#[pyfunction]
pub(crate) fn body_inset<'py>(
    py: Python<'py>,
    bodies: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    of_each(py, &bodies, |_, body| Ok(ten(inset(body))))
}

/// Two bodies, described in one frame, as one.
#[pyfunction]
pub(crate) fn body_add<'py>(
    py: Python<'py>,
    bodies: PyReadonlyArray2<'py, f64>,
    others: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let others = rows::<10>(&others)?;
    of_each(py, &bodies, |i, one| {
        MassProperties::combined([one, body(&others[i])?])
            .map(ten)
            .map_err(|error| error.to_string())
    })
}

/// What is left of bodies without a part.
#[pyfunction]
pub(crate) fn body_subtract<'py>(
    py: Python<'py>,
    bodies: PyReadonlyArray2<'py, f64>,
    parts: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let parts = rows::<10>(&parts)?;
    of_each(py, &bodies, |i, one| {
        one.without(&body(&parts[i])?).map(ten).map_err(|error| error.to_string())
    })
}

/// The inertia about other points, as (n, 9).
#[pyfunction]
pub(crate) fn body_inertia_about<'py>(
    py: Python<'py>,
    bodies: PyReadonlyArray2<'py, f64>,
    points: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let points = rows::<3>(&points)?;
    of_each(py, &bodies, |i, body| {
        let about =
            body.inertia_about(Vector3::from(points[i])).map_err(|error| error.to_string())?;
        Ok(row_of(about.matrix()))
    })
}

/// Pseudo-inertias, row by row as (n, 16).
#[pyfunction]
pub(crate) fn body_pseudo_inertia<'py>(
    py: Python<'py>,
    bodies: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    of_each(py, &bodies, |_, body| {
        let pseudo = PseudoInertia::of(&body).map_err(|error| error.to_string())?;
        Ok::<[f64; 16], _>(std::array::from_fn(|i| pseudo.matrix()[(i / 4, i % 4)]))
    })
}

/// The bodies of pseudo-inertias.
#[pyfunction]
pub(crate) fn body_from_pseudo_inertia<'py>(
    py: Python<'py>,
    pseudo_inertias: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let all = rows::<16>(&pseudo_inertias)?;
    made(py, all.len(), |i| {
        PseudoInertia::new(Matrix4::from_row_slice(&all[i]))
            .map(|pseudo| ten(pseudo.mass_properties()))
    })
}

/// Log-Cholesky coordinates.
#[pyfunction]
pub(crate) fn body_log_cholesky<'py>(
    py: Python<'py>,
    bodies: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    of_each(py, &bodies, |_, body| {
        LogCholesky::of(&body)
            .map(|coordinates| coordinates.values())
            .map_err(|error| error.to_string())
    })
}

/// The bodies of log-Cholesky coordinates.
#[pyfunction]
pub(crate) fn body_from_log_cholesky<'py>(
    py: Python<'py>,
    coordinates: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let all = rows::<10>(&coordinates)?;
    made(py, all.len(), |i| LogCholesky::new(all[i]).and_then(|c| c.mass_properties()).map(ten))
}

/// Mass, principal moments and the attitude of the principal frame in the frame of the body, scalar last, as (n, 8): what
/// simulators hold.
#[pyfunction]
pub(crate) fn body_to_principal<'py>(
    py: Python<'py>,
    bodies: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    of_each(py, &bodies, |_, body| {
        let axes = body.inertia().principal_axes();
        let [a, b, c] = axes.moments();
        let [x, y, z, w] = row_of_attitude(&axes.attitude().inverse());
        Ok([body.mass_kg(), a, b, c, x, y, z, w])
    })
}
