//! Laws of the inertia alone.

use gyradius_dispersion::{
    DispersionModel, EntryMoments, InertiaLaw, ModelDraw, ModelKind, ModelParameters,
};
use gyradius_inertia::{Inertia, InertiaMatrix};
use nalgebra::SMatrix;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::{Bound, PyResult, Python, pyclass, pymethods};
use rand_distr::Distribution;
use serde::{
    Deserialize, Deserializer,
    de::{Error, MapAccess, Visitor},
};
use std::fmt;

use crate::{
    error::refused,
    json,
    rows::{densities, density_of_nothing, drawn, matrix, row_of, rows},
    stream::Draws,
    tensors::{SKEW, nearly_symmetric},
};

/// A law of inertias about the mass centre.
#[pyclass(frozen, module = "gyradius._core")]
pub(crate) struct InertiaCore(DispersionModel);

/// The parameters of a model by their keys.
struct Parameters(ModelParameters);

impl<'de> Deserialize<'de> for Parameters {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Keys;
        impl<'de> Visitor<'de> for Keys {
            type Value = Parameters;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("parameters of a model")
            }

            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Parameters, M::Error> {
                let mut parameters = ModelParameters::default();
                while let Some(key) = map.next_key::<String>()? {
                    if !ModelParameters::KEYS.contains(&key.as_str()) {
                        return Err(M::Error::unknown_field(&key, ModelParameters::KEYS));
                    }
                    parameters.read(&key, &mut map)?;
                }
                Ok(Parameters(parameters))
            }
        }
        deserializer.deserialize_map(Keys)
    }
}

#[pymethods]
impl InertiaCore {
    /// A law in its form in files.
    #[staticmethod]
    fn of_form(form: &str) -> PyResult<Self> {
        Ok(Self(json::read(form)?))
    }

    /// A model by its name about a nominal inertia, with parameters in the form that they have in scenarios.
    #[staticmethod]
    fn about(kind: &str, nominal: [f64; 9], parameters: &str) -> PyResult<Self> {
        let kind: ModelKind = kind.parse().map_err(refused)?;
        let Parameters(given) = json::read(parameters)?;
        let nominal = nearly_symmetric(&matrix(&nominal), SKEW).map_err(refused)?;
        let nominal = Inertia::try_from(nominal).map_err(refused)?;
        DispersionModel::about(kind, &nominal, &given.or(&kind.defaults()))
            .map(Self)
            .map_err(refused)
    }

    /// The model of a kind with given mean and covariance of the entries, as far as the kind can.
    #[staticmethod]
    fn matched(
        kind: &str,
        mean: [f64; 6],
        covariance: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Self> {
        let kind: ModelKind = kind.parse().map_err(refused)?;
        let covariance = rows::<6>(&covariance)?;
        if covariance.len() != 6 {
            return Err(refused("covariance: it must be of shape (6, 6)"));
        }
        let covariance = SMatrix::from_fn(|i, j| covariance[i][j]);
        let moments = EntryMoments::new(mean, covariance).map_err(refused)?;
        let matched = DispersionModel::matched(kind, &moments).map_err(refused)?;
        Ok(Self(matched.into_model()))
    }

    /// The names of all models, and what each is.
    #[staticmethod]
    fn kinds() -> Vec<(&'static str, &'static str, bool, &'static [&'static str])> {
        let of = |kind: ModelKind| {
            (kind.name(), kind.description(), kind.is_realizable_by_construction(), kind.needs())
        };
        ModelKind::ALL.map(of).to_vec()
    }

    fn form(&self) -> PyResult<String> {
        json::write(&self.0)
    }

    fn name(&self) -> String {
        self.0.name().into_owned()
    }

    fn is_realizable_by_construction(&self) -> bool {
        self.0.is_realizable_by_construction()
    }

    /// Draws, as (n, 9), each from a stream of its own.
    fn draw<'py>(&self, py: Python<'py>, draws: &Draws) -> PyResult<Bound<'py, PyArray2<f64>>> {
        drawn(py, draws, 10, |rng| {
            let draw: ModelDraw = self.0.sample(rng);
            row_of(draw.inertia.matrix())
        })
    }

    /// ln of the density of (n, 9) matrices with respect to their six entries; none where the law has none.
    fn ln_density<'py>(
        &self,
        py: Python<'py>,
        matrices: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let all = rows::<9>(&matrices)?;
        let unit = InertiaMatrix::from_entries([1.0; 3], [0.0; 3]).map_err(refused)?;
        densities(py, all.len(), self.0.ln_density(&unit), |i| {
            match nearly_symmetric(&matrix(&all[i]), SKEW) {
                Ok(inertia) => self.0.ln_density(&inertia),
                Err(_) => density_of_nothing(&all[i]),
            }
        })
    }

    /// Mean and covariance of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃.
    fn moments(&self) -> Option<([f64; 6], Vec<f64>)> {
        let moments = self.0.expected_moments()?;
        Some((moments.mean(), moments.covariance().as_slice().to_vec()))
    }

    fn acceptance(&self) -> Option<f64> {
        InertiaLaw::acceptance(&self.0)
    }
}
