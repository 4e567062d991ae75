//! Laws of attitudes.

use gyradius_attitude::{AboutAxis, FisherBingham, RadiallyConstrainedGaussian};
use gyradius_dispersion::{AttitudeMoments, AxesLaw};
use nalgebra::{Matrix3, Matrix4, Unit, UnitQuaternion, Vector3, Vector4};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::{Bound, PyResult, Python, pyclass, pymethods};
use rand_distr::Distribution;

use crate::{
    error::refused,
    json,
    rows::{attitude, densities, drawn, row_of_attitude, rows},
    stream::Draws,
};

/// A law of attitudes. Quaternions have the scalar last, and norm one.
#[pyclass(frozen, module = "gyradius._core")]
pub(crate) struct AttitudeCore(Box<AxesLaw>);

#[pymethods]
impl AttitudeCore {
    /// A law in its form in files.
    #[staticmethod]
    fn of_form(form: &str) -> PyResult<Self> {
        Ok(Self(Box::new(json::read(form)?)))
    }

    /// A radially constrained Gaussian with a covariance of the four coordinates.
    #[staticmethod]
    fn gaussian(mean: [f64; 4], covariance: [[f64; 4]; 4]) -> PyResult<Self> {
        let covariance = Matrix4::from_fn(|i, j| covariance[i][j]);
        let law = RadiallyConstrainedGaussian::new(attitude(mean), covariance).map_err(refused)?;
        Ok(Self(Box::new(law.into())))
    }

    /// One with a covariance of small rotations, rad².
    #[staticmethod]
    fn of_small_rotations(mean: [f64; 4], covariance: [[f64; 3]; 3]) -> PyResult<Self> {
        let covariance = Matrix3::from_fn(|i, j| covariance[i][j]);
        let law = RadiallyConstrainedGaussian::of_small_rotations(attitude(mean), covariance);
        Ok(Self(Box::new(law.map_err(refused)?.into())))
    }

    /// Fisher-Bingham's law ∝ exp(−½ xᵀPx + bᵀx).
    #[staticmethod]
    fn fisher_bingham(precision: [[f64; 4]; 4], linear: [f64; 4]) -> PyResult<Self> {
        let precision = Matrix4::from_fn(|i, j| precision[i][j]);
        let law = FisherBingham::new(precision, Vector4::from(linear)).map_err(refused)?;
        Ok(Self(Box::new(law.into())))
    }

    /// All turns about an axis in body components.
    #[staticmethod]
    fn about_axis(start: [f64; 4], axis: [f64; 3]) -> PyResult<Self> {
        let axis = Unit::try_new(Vector3::from(axis), 1e-150)
            .filter(|axis| axis.iter().all(|x| x.is_finite()))
            .ok_or_else(|| {
                refused(format_args!("axis = {axis:?}: it must be finite, and not zero"))
            })?;
        Ok(Self(Box::new(AboutAxis::new(attitude(start), axis).into())))
    }

    /// The form in files.
    fn form(&self) -> PyResult<String> {
        json::write(&*self.0)
    }

    /// Draws, as (n, 4), each from a stream of its own.
    fn draw<'py>(&self, py: Python<'py>, draws: &Draws) -> PyResult<Bound<'py, PyArray2<f64>>> {
        drawn(py, draws, 6, |rng| {
            let drawn: UnitQuaternion<f64> = self.0.sample(rng);
            row_of_attitude(&drawn)
        })
    }

    /// ln of the density of attitudes with respect to Haar measure, 0 for the uniform law; none where there is none.
    fn ln_density<'py>(
        &self,
        py: Python<'py>,
        attitudes: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let all = rows::<4>(&attitudes)?;
        let ln_density = |q: &UnitQuaternion<f64>| self.0.ln_density_of_attitude(q);
        let somewhere = ln_density(&UnitQuaternion::identity());
        densities(py, all.len(), somewhere, |i| ln_density(&attitude(all[i])))
    }

    /// The mean attitude and the covariance of small rotations about it in rad², where they are known.
    fn moments(&self) -> Option<([f64; 4], [[f64; 3]; 3])> {
        let (mean, covariance) = match &*self.0 {
            AxesLaw::WholeSphere(law) => (law.mean_attitude(), law.rotation_covariance()),
            AxesLaw::FisherBingham(law) => (law.mean_attitude(), law.rotation_covariance()),
            AxesLaw::Fixed(law) => (law.attitude(), Matrix3::zeros()),
            // Their moments are those of entries of an inertia alone. The enum may grow.
            _ => return None,
        };
        Some((row_of_attitude(&mean), covariance.transpose().into()))
    }
}
