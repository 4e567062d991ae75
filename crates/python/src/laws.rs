//! Laws of mass, mass centre and inertia.

use gyradius_dispersion::{
    LogCholeskyTen, MassPropertiesLaw, MassPropertiesModel, MaximumEntropy, NaiveBody, NaiveRule,
    PseudoInertiaWishart, ScalarLaw, TenMoments,
};
use gyradius_inertia::{LogCholesky, Region};
use nalgebra::SMatrix;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::{Bound, PyResult, Python, pyclass, pymethods};
use std::sync::Arc;

use crate::{
    bodies::{body, ten},
    error::refused,
    json,
    rows::{densities, density_of_nothing, drawn, rows},
    stream::Draws,
};

/// A law of bodies.
#[pyclass(frozen, module = "gyradius._core")]
pub(crate) struct BodyCore(Law);

enum Law {
    Joint(Box<MassPropertiesLaw>),
    Other(Arc<dyn MassPropertiesModel>),
}

/// Mean and covariance of ten numbers.
pub(crate) type Moments = ([f64; 10], Vec<f64>);

impl BodyCore {
    pub(crate) fn joint_law(law: MassPropertiesLaw) -> Self {
        Self(Law::Joint(Box::new(law)))
    }

    fn other(law: impl MassPropertiesModel + 'static) -> Self {
        Self(Law::Other(Arc::new(law)))
    }

    fn law(&self) -> &dyn MassPropertiesModel {
        match &self.0 {
            Law::Joint(law) => &**law,
            Law::Other(law) => &**law,
        }
    }
}

#[pymethods]
impl BodyCore {
    /// The joint law in its form in files.
    #[staticmethod]
    fn joint(form: &str) -> PyResult<Self> {
        Ok(Self(Law::Joint(Box::new(json::read(form)?))))
    }

    /// From the mean of the coordinates.
    #[staticmethod]
    fn log_cholesky(mean: [f64; 10], covariance: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        let covariance = rows::<10>(&covariance)?;
        if covariance.len() != 10 {
            return Err(refused("covariance: it must be of shape (10, 10)"));
        }
        let covariance = SMatrix::from_fn(|i, j| covariance[i][j]);
        let mean = LogCholesky::new(mean).map_err(refused)?;
        LogCholeskyTen::new(mean, covariance).map(Self::other).map_err(refused)
    }

    #[staticmethod]
    fn maximum_entropy(
        mean: [f64; 10],
        mass_delta: f64,
        centre_deviations_m: [f64; 3],
        delta: f64,
        inside: Option<&str>,
    ) -> PyResult<Self> {
        let mean = body(&mean).map_err(refused)?;
        let law =
            MaximumEntropy::new(&mean, mass_delta, centre_deviations_m, delta).map_err(refused)?;
        let Some(region) = inside else { return Ok(Self::other(law)) };
        law.inside(json::read::<Region>(region)?).map(Self::other).map_err(refused)
    }

    #[staticmethod]
    fn pseudo_inertia_wishart(mean: [f64; 10], degrees_of_freedom: f64) -> PyResult<Self> {
        let mean = body(&mean).map_err(refused)?;
        PseudoInertiaWishart::new(&mean, degrees_of_freedom).map(Self::other).map_err(refused)
    }

    #[staticmethod]
    fn naive(
        nominal: [f64; 10],
        rule: &str,
        law: &str,
        mass_factor: Option<&str>,
        centre_offset_m: Option<&str>,
    ) -> PyResult<Self> {
        let names = NaiveRule::ALL.map(NaiveRule::name);
        let rule = NaiveRule::ALL.into_iter().find(|one| one.name() == rule).ok_or_else(|| {
            refused(format_args!("rule = {rule:?}: it must be one of {}", names.join(", ")))
        })?;
        let nominal = body(&nominal).map_err(refused)?;
        let mut made =
            NaiveBody::new(nominal, rule, json::read::<ScalarLaw>(law)?).map_err(refused)?;
        if let Some(law) = mass_factor {
            made = made.with_mass_factor(json::read(law)?).map_err(refused)?;
        }
        if let Some(law) = centre_offset_m {
            made = made.with_centre_offset_m(json::read(law)?).map_err(refused)?;
        }
        Ok(Self::other(made))
    }

    /// The form in files of the joint law; none of another.
    fn form(&self) -> PyResult<Option<String>> {
        match &self.0 {
            Law::Joint(law) => json::write(law).map(Some),
            Law::Other(_) => Ok(None),
        }
    }

    fn name(&self) -> String {
        self.law().name().into_owned()
    }

    fn is_realizable_by_construction(&self) -> bool {
        self.law().is_realizable_by_construction()
    }

    /// Draws, as (n, 10), each from a stream of its own.
    fn draw<'py>(&self, py: Python<'py>, draws: &Draws) -> PyResult<Bound<'py, PyArray2<f64>>> {
        match &self.0 {
            // Not through a generator behind a pointer.
            Law::Joint(law) => drawn(py, draws, 12, |rng| {
                use rand_distr::Distribution;
                ten(law.sample(rng))
            }),
            Law::Other(law) => drawn(py, draws, 12, |rng| law.draw(rng).values()),
        }
    }

    /// ln of the density of (n, 10) bodies, −∞ of what is none; none where the law has no density.
    fn ln_density<'py>(
        &self,
        py: Python<'py>,
        bodies: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let all = rows::<10>(&bodies)?;
        let law = self.law();
        let unit = body(&[1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).map_err(refused)?;
        densities(py, all.len(), law.ln_density(&unit), |i| match body(&all[i]) {
            Ok(body) => law.ln_density(&body),
            Err(_) => density_of_nothing(&all[i]),
        })
    }

    /// Mean and covariance of the ten.
    fn moments(&self) -> Option<Moments> {
        self.law().moments().map(|moments| moments_of(&moments))
    }

    /// Mean and covariance of the ten in which the equations of motion are linear.
    fn linear_moments(&self) -> Option<Moments> {
        self.law().linear_moments().map(|moments| moments_of(&moments))
    }

    /// The share of proposals that rejection keeps, where there is rejection.
    fn acceptance(&self) -> Option<f64> {
        self.law().acceptance()
    }
}

fn moments_of(moments: &TenMoments) -> Moments {
    // Symmetric: columns are rows.
    ((*moments.mean()).into(), moments.covariance().as_slice().to_vec())
}
