//! Plain statements, and the laws that they make about bodies.

use gyradius_dispersion::TenParameters;
use gyradius_estimation::{StatedAmount, StatedAmountError, StatedBody, Statements};
use gyradius_inertia::{MassProperties, Region};
use gyradius_study::as_written;
use pyo3::{PyResult, Python, pyclass, pymethods};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fmt::Display;

use crate::{bodies::body, error::refused, json, laws::BodyCore, words::in_python};

/// Reads what is said of a part: an amount with its unit, or the table of a file.
fn said<T: DeserializeOwned, E: Display>(
    part: &str,
    given: Option<&str>,
    read: fn(&str) -> Result<StatedAmount, StatedAmountError>,
    make: impl Fn(StatedAmount) -> Result<T, E>,
) -> PyResult<Option<T>> {
    let Some(given) = given else { return Ok(None) };
    let statement = match json::read(given)? {
        Value::String(text) => {
            let amount = read(&text).map_err(refused)?;
            make(amount).map_err(refused)?
        }
        table => serde_json::from_value(table).map_err(|error| {
            let message = in_python(&error.to_string());
            // Some messages begin with the part themselves.
            let says_it = message.starts_with(part);
            if says_it { refused(message) } else { refused(format_args!("{part}: {message}")) }
        })?,
    };
    Ok(Some(statement))
}

/// The nominal body that a file means by ten numbers, which rounding may have made impossible.
fn written(numbers: &[f64; 10]) -> Result<MassProperties, String> {
    body(numbers).or_else(|impossible| {
        let ten = TenParameters::from_values(*numbers).map_err(|error| error.to_string())?;
        let inertia = as_written(&ten.inertia).ok_or(impossible)?;
        MassProperties::new(ten.mass_kg, ten.mass_centre_m, inertia)
            .map_err(|error| error.to_string())
    })
}

/// What is stated, of one body or of all links of a robot.
#[pyclass(frozen, module = "gyradius._core")]
pub(crate) struct StatementsCore(Statements);

#[pymethods]
impl StatementsCore {
    /// Of texts with units, or of the tables of a file.
    #[new]
    fn new(
        mass: Option<&str>,
        centre: Option<&str>,
        moments: Option<&str>,
        products: Option<&str>,
        axes: Option<&str>,
        sigmas: f64,
    ) -> PyResult<Self> {
        Ok(Self(Statements {
            mass: said("mass", mass, StatedAmount::mass, |amount| amount.mass_statement(sigmas))?,
            centre: said("centre", centre, StatedAmount::centre, |amount| {
                amount.centre_statement(sigmas)
            })?,
            moments: said("moments", moments, StatedAmount::moments, |amount| {
                amount.moments_statement(sigmas)
            })?,
            products: said("products", products, StatedAmount::products, |amount| {
                amount.products_statement(sigmas)
            })?,
            axes: said("axes", axes, StatedAmount::axes, |amount| amount.axes_statement(sigmas))?,
        }))
    }

    /// The joint law that they make about a body, and the warnings.
    fn about(
        &self,
        py: Python<'_>,
        nominal: [f64; 10],
        inside: Option<&str>,
    ) -> PyResult<(BodyCore, Vec<String>)> {
        let region = inside.map(json::read::<Region>).transpose()?;
        let nominal = written(&nominal).map_err(refused)?;
        py.detach(|| {
            let mut stated = StatedBody::new(&self.0, &nominal).map_err(refused)?;
            if let Some(region) = region {
                stated = stated.inside(region).map_err(refused)?;
            }
            let warnings = stated.warnings().iter().map(ToString::to_string).collect();
            Ok((BodyCore::joint_law(stated.law().clone()), warnings))
        })
    }
}
