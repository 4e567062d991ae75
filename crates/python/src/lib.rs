//! The compiled part of the Python package `gyradius`: arrays of NumPy in and out over the libraries.
//!
//! Arrays come in flat, of rows of 9, 10 or 4 numbers, of 64-bit floats, and go out likewise; shapes, types and keywords are
//! the business of the Python part. Everything that takes long is done with the interpreter let go and by all cores.

#![allow(clippy::needless_pass_by_value, reason = "PyO3 gives arguments by value")]

mod attitudes;
mod bodies;
mod cores;
mod error;
mod estimate;
mod inertias;
mod json;
mod laws;
mod program;
mod robots;
mod rows;
mod scalars;
mod stated;
mod stream;
mod study;
mod tensors;
mod words;

/// What `gyradius._core` has. It is not for users: the Python part is.
#[pyo3::pymodule(gil_used = false)]
mod _core {
    use pyo3::{
        Bound, PyResult,
        types::{PyModule, PyModuleMethods},
    };

    #[pymodule_export]
    use super::attitudes::AttitudeCore;
    #[pymodule_export]
    use super::bodies::{
        body_add, body_from_log_cholesky, body_from_pseudo_inertia, body_inertia_about, body_inset,
        body_log_cholesky, body_pseudo_inertia, body_subtract, body_to_principal, body_transform,
    };
    #[pymodule_export]
    use super::estimate::{fit_attitudes, fit_bodies, fit_inertias, from_estimate};
    #[pymodule_export]
    use super::inertias::InertiaCore;
    #[pymodule_export]
    use super::laws::BodyCore;
    #[pymodule_export]
    use super::program::run_program;
    #[pymodule_export]
    use super::robots::load_robot;
    #[pymodule_export]
    use super::scalars::{ScalarCore, checked_region, region_holds};
    #[pymodule_export]
    use super::stated::StatementsCore;
    #[pymodule_export]
    use super::stream::Draws;
    #[pymodule_export]
    use super::study::{ScenarioCore, StudyCore, end_all};
    #[pymodule_export]
    use super::tensors::{
        body_of_parts, inertia_is_realizable, inertia_margin, inertia_nearest,
        inertia_principal_axes, inertia_report,
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("COLUMNS", gyradius_dispersion::TenParameters::COLUMNS.to_vec())
    }
}
