//! Laws of samples and of estimates.

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_dispersion::{AxesLaw, DispersionModel};
use gyradius_estimation::{
    EstimateDistance, EstimatedBody, MassChoice, MassPropertiesFit, PrincipalFit, TenEstimate,
    TenForm,
};
use gyradius_inertia::Inertia;
use nalgebra::{SMatrix, SVector};
use numpy::PyReadonlyArray2;
use pyo3::{PyResult, Python, pyfunction};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use serde::Serialize;
use std::fmt::Display;

use crate::{
    bodies::{body, ten},
    error::{refused, refused_row},
    json,
    rows::{attitude, matrix, rows},
    tensors::{SKEW, nearly_symmetric},
};

/// What was fitted: the law, what was found, whether nothing speaks against the law, how likely that is, and notes.
type Fitted = (String, String, bool, f64, Vec<String>);

/// Each row as a sample.
fn samples_of<const N: usize, T, E: Display>(
    samples: &PyReadonlyArray2<'_, f64>,
    sample: impl Fn(&[f64; N]) -> Result<T, E>,
) -> PyResult<Vec<T>> {
    let all = rows::<N>(samples)?;
    let one = |(i, row)| sample(row).map_err(|error| refused_row(i, all.len(), error));
    all.iter().enumerate().map(one).collect()
}

/// Fits a law of inertias.
#[pyfunction]
pub(crate) fn fit_inertias(py: Python<'_>, samples: PyReadonlyArray2<'_, f64>) -> PyResult<Fitted> {
    let samples = samples_of(&samples, |row| {
        let matrix = nearly_symmetric(&matrix(row), SKEW).map_err(|error| error.to_string())?;
        Inertia::try_from(matrix).map_err(|error| error.to_string())
    })?;
    py.detach(|| {
        let fit = PrincipalFit::new(&samples).map_err(refused)?;
        let assessment = fit.assess(&mut verdict());
        let notes = fit.notes().iter().map(ToString::to_string).collect();
        let law = json::write(&DispersionModel::from(fit.law().clone()))?;
        Ok((law, json::write(&fit)?, assessment.fits(), assessment.p_value(), notes))
    })
}

/// Fits a joint law of bodies.
#[pyfunction]
pub(crate) fn fit_bodies(py: Python<'_>, samples: PyReadonlyArray2<'_, f64>) -> PyResult<Fitted> {
    let samples = samples_of(&samples, body)?;
    py.detach(|| {
        let fit = MassPropertiesFit::new(&samples, MassChoice::default()).map_err(refused)?;
        let assessment = fit.assess(&mut verdict());
        let notes = fit.lengths().notes().iter().map(ToString::to_string).collect();
        let law = json::write(fit.law())?;
        Ok((law, json::write(&fit)?, assessment.fits(), assessment.p_value(), notes))
    })
}

/// Fits a radially constrained Gaussian to attitudes.
#[pyfunction]
pub(crate) fn fit_attitudes(
    py: Python<'_>,
    samples: PyReadonlyArray2<'_, f64>,
) -> PyResult<(String, String)> {
    let all = rows::<4>(&samples)?;
    py.detach(|| {
        let samples: Vec<_> = all.iter().map(|row| attitude(*row)).collect();
        let fit = RadiallyConstrainedGaussian::fit(&samples).map_err(refused)?;
        Ok((json::write(&AxesLaw::from(fit.law().clone()))?, json::write(&fit)?))
    })
}

/// The random numbers behind verdicts, those of the program: the same samples have the same verdict.
fn verdict() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(2003)
}

/// A law of an estimate and how far its moments are from those of the estimate.
#[derive(Serialize)]
struct Near {
    #[serde(flatten)]
    distance: EstimateDistance,
    is_exact: bool,
}

/// The nearest body and how far it is; the joint law and the Gaussian in log-Cholesky coordinates, each with its distance.
type Estimated = ([f64; 10], f64, Option<(String, String)>, Option<([f64; 10], Vec<f64>, String)>);

/// The laws of bodies whose moments are as nearly as can be those of an estimate.
#[pyfunction]
pub(crate) fn from_estimate(
    py: Python<'_>,
    mean: [f64; 10],
    covariance: PyReadonlyArray2<'_, f64>,
    linear: bool,
) -> PyResult<Estimated> {
    let covariance = rows::<10>(&covariance)?;
    if covariance.len() != 10 {
        return Err(refused("covariance: it must be of shape (10, 10)"));
    }
    let covariance = SMatrix::from_fn(|i, j| covariance[i][j]);
    let form = if linear { TenForm::Linear } else { TenForm::Natural };
    let estimate = TenEstimate::new(form, SVector::from(mean), covariance).map_err(refused)?;
    py.detach(|| {
        let found = EstimatedBody::new(&estimate).map_err(refused)?;
        let near = |distance: &EstimateDistance| {
            json::write(&Near { distance: *distance, is_exact: distance.is_exact() })
        };
        let joint = found
            .joint()
            .map(|(law, distance)| Ok::<_, pyo3::PyErr>((json::write(law)?, near(distance)?)));
        let log_cholesky = found.log_cholesky().map(|(law, distance)| {
            let covariance = law.covariance().as_slice().to_vec();
            Ok::<_, pyo3::PyErr>((law.mean(), covariance, near(distance)?))
        });
        Ok((ten(*found.nearest()), found.moved(), joint.transpose()?, log_cholesky.transpose()?))
    })
}
