//! Laws of one number, and regions.

use gyradius_dispersion::ScalarLaw;
use gyradius_inertia::{Containment, Region};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::{Bound, PyResult, Python, pyclass, pyfunction, pymethods};
use rand_distr::Distribution;

use crate::{
    bodies::body,
    error::refused,
    json,
    rows::{answered, densities, drawn_one, rows},
    stream::Draws,
};

/// A law of one number.
#[pyclass(frozen, module = "gyradius._core")]
pub(crate) struct ScalarCore(ScalarLaw);

#[pymethods]
impl ScalarCore {
    /// A law in its form in files.
    #[staticmethod]
    fn of_form(form: &str) -> PyResult<Self> {
        Ok(Self(json::read(form)?))
    }

    fn form(&self) -> PyResult<String> {
        json::write(&self.0)
    }

    fn mean(&self) -> f64 {
        self.0.mean()
    }

    fn deviation(&self) -> f64 {
        self.0.deviation()
    }

    fn draw<'py>(&self, py: Python<'py>, draws: &Draws) -> PyResult<Bound<'py, PyArray1<f64>>> {
        drawn_one(py, draws, 1, |rng| self.0.sample(rng))
    }

    /// ln of the density; none where the law has none.
    fn ln_density<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let all = values.as_slice().map_err(refused)?;
        let somewhere = self.0.ln_density(self.0.mean());
        densities(py, all.len(), somewhere, |i| self.0.ln_density(all[i]))
    }

    fn cdf<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.of_each(py, &values, ScalarLaw::cdf)
    }

    fn share_above<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.of_each(py, &values, ScalarLaw::share_above)
    }

    fn quantile<'py>(
        &self,
        py: Python<'py>,
        shares: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.of_each(py, &shares, ScalarLaw::quantile)
    }
}

impl ScalarCore {
    /// What the law says of each number; NaN of NaN.
    fn of_each<'py>(
        &self,
        py: Python<'py>,
        numbers: &PyReadonlyArray1<'py, f64>,
        of: fn(&ScalarLaw, f64) -> f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let all = numbers.as_slice().map_err(refused)?;
        let one = |x: f64| if x.is_nan() { x } else { of(&self.0, x) };
        answered(py, all.len(), |i| one(all[i]))
    }
}

/// A region in its form in files, checked and written again.
#[pyfunction]
pub(crate) fn checked_region(form: &str) -> PyResult<String> {
    json::write(&json::read::<Region>(form)?)
}

/// Whether matter in a region can have the numbers of (n, 10) bodies: 1, 0, and NaN where neither was shown.
#[pyfunction]
pub(crate) fn region_holds<'py>(
    py: Python<'py>,
    form: &str,
    bodies: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let region: Region = json::read(form)?;
    let all = rows::<10>(&bodies)?;
    answered(py, all.len(), |i| {
        // What is no body is possible nowhere.
        let Ok(body) = body(&all[i]) else { return 0.0 };
        match region.containment(&body) {
            Containment::Possible => 1.0,
            Containment::Impossible => 0.0,
            Containment::Undecided => f64::NAN,
        }
    })
}
