//! Inertia matrices, many at a time: which belong to a body, how far they are from it, the nearest that does.

use gyradius_inertia::{
    InertiaMatrix, InertiaMatrixError, RELATIVE_TOLERANCE, RealizabilityReport, Repair,
    RepairMethod,
};
use nalgebra::Matrix3;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::{Bound, PyResult, Python, pyfunction};

use crate::{
    error::{refused, refused_row},
    rows::{answered, made, matrix, row_of, row_of_attitude, rows},
};

/// How far from symmetric a matrix may be beside its largest entry, as those in 32 bits and in files are.
pub(crate) const SKEW: f64 = 1e-6;

/// The means of what stands across the diagonal; none if that differs by more than so much of the largest entry. What is not finite
/// differs from nothing.
fn symmetric(matrix: &Matrix3<f64>, skew: f64) -> Option<Matrix3<f64>> {
    let across = matrix.transpose();
    let differs = (matrix - across).amax() > skew * matrix.amax();
    (!differs).then(|| (matrix + across) * 0.5)
}

/// A matrix that is symmetric but for so much of its largest entry.
pub(crate) fn nearly_symmetric(
    matrix: &Matrix3<f64>,
    skew: f64,
) -> Result<InertiaMatrix, InertiaMatrixError> {
    let found = InertiaMatrix::new(*matrix);
    match &found {
        Err(InertiaMatrixError::NotSymmetric { .. }) => {
            symmetric(matrix, skew).map_or(found, InertiaMatrix::new)
        }
        Ok(_) | Err(_) => found,
    }
}

/// Rows of ten numbers of masses, mass centres and inertia matrices, of a body or not.
#[pyfunction]
pub(crate) fn body_of_parts<'py>(
    py: Python<'py>,
    masses: PyReadonlyArray2<'py, f64>,
    centres: PyReadonlyArray2<'py, f64>,
    matrices: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (masses, centres) = (rows::<1>(&masses)?, rows::<3>(&centres)?);
    let matrices = rows::<9>(&matrices)?;
    made(py, matrices.len(), |i| {
        let m = symmetric(&matrix(&matrices[i]), SKEW).ok_or("inertia: it must be symmetric")?;
        let ([mass], [x, y, z]) = (masses[i], centres[i]);
        let (products, moments) = ([m[(0, 1)], m[(0, 2)], m[(1, 2)]], m.diagonal());
        let [a, b, c] = products;
        Ok::<_, &str>([mass, x, y, z, moments[0], moments[1], moments[2], a, b, c])
    })
}

/// Which of (n, 9) matrices belong to a body; not those with entries that are not finite or not symmetric.
#[pyfunction]
pub(crate) fn inertia_is_realizable<'py>(
    py: Python<'py>,
    matrices: PyReadonlyArray2<'py, f64>,
    tolerance: Option<f64>,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let all = rows::<9>(&matrices)?;
    // As `RealizabilityReport::within`, which also finds the reasons.
    let tolerance = tolerance.unwrap_or_default().max(RELATIVE_TOLERANCE);
    answered(py, all.len(), |i| {
        nearly_symmetric(&matrix(&all[i]), tolerance)
            .is_ok_and(|matrix| matrix.is_realizable_within(tolerance))
    })
}

/// The margins of (n, 9) matrices; NaN of what is no matrix of inertia.
#[pyfunction]
pub(crate) fn inertia_margin<'py>(
    py: Python<'py>,
    matrices: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let all = rows::<9>(&matrices)?;
    answered(py, all.len(), |i| {
        RealizabilityReport::of(&matrix(&all[i])).margin().unwrap_or(f64::NAN)
    })
}

/// The nearest inertias that belong to a body, and how far each is.
#[pyfunction]
pub(crate) fn inertia_nearest<'py>(
    py: Python<'py>,
    matrices: PyReadonlyArray2<'py, f64>,
    method: &str,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let all = rows::<9>(&matrices)?;
    let method = match method {
        "nearest" => RepairMethod::Nearest,
        "clip-second-moments" => RepairMethod::ClipSecondMoments,
        "shift-moments" => RepairMethod::ShiftMoments,
        other => {
            let allowed = "nearest, clip-second-moments or shift-moments";
            return Err(refused(format_args!("method = {other:?}: it must be {allowed}")));
        }
    };
    made(py, all.len(), |i| {
        let matrix = nearly_symmetric(&matrix(&all[i]), SKEW).map_err(|error| error.to_string())?;
        let repair = Repair::new(&matrix, method).map_err(|error| error.to_string())?;
        Ok::<_, String>(row_of(repair.inertia().matrix()))
    })
}

/// Principal moments, and the attitude that takes body components to principal components, scalar last.
#[pyfunction]
pub(crate) fn inertia_principal_axes<'py>(
    py: Python<'py>,
    matrices: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let all = rows::<9>(&matrices)?;
    made(py, all.len(), |i| {
        let axes = nearly_symmetric(&matrix(&all[i]), SKEW)?.principal_axes();
        let [a, b, c] = axes.moments();
        let [x, y, z, w] = row_of_attitude(&axes.attitude());
        Ok::<_, InertiaMatrixError>([a, b, c, x, y, z, w])
    })
}

/// Of one matrix: realizable, margin, excess in percent, principal moments, second moments, what is wrong.
type Report = (bool, Option<f64>, Option<f64>, Option<[f64; 3]>, Option<[f64; 3]>, Vec<String>);

/// What is wrong with each matrix.
#[pyfunction]
pub(crate) fn inertia_report(
    py: Python<'_>,
    matrices: PyReadonlyArray2<'_, f64>,
    tolerance: Option<f64>,
) -> PyResult<Vec<Report>> {
    let all = rows::<9>(&matrices)?;
    if tolerance.is_some_and(|tolerance| !(tolerance >= 0.0 && tolerance.is_finite())) {
        return Err(refused_row(
            0,
            1,
            format_args!("tolerance = {tolerance:?}: it must be zero or positive, and finite"),
        ));
    }
    let report = |row: &[f64; 9]| {
        let report = match tolerance {
            None => RealizabilityReport::of(&matrix(row)),
            Some(tolerance) => RealizabilityReport::within(&matrix(row), tolerance),
        };
        let faults = report.faults().iter().map(ToString::to_string).collect();
        let (margin, excess) = (report.margin(), report.excess_percent());
        let (principal, second) = (report.principal_moments(), report.second_moments());
        (report.is_realizable(), margin, excess, principal, second, faults)
    };
    Ok(py.detach(|| all.iter().map(report).collect()))
}
