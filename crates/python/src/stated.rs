//! The law of plain statements about a body.

use gyradius_estimation::{StatedAmount, StatedBody, Statements};
use gyradius_inertia::Region;
use pyo3::{PyResult, Python, pyfunction};
use serde::Deserialize;

use crate::{bodies::body, error::refused, json, laws::BodyCore};

/// What is said of one part: an amount with its unit, or the table of a file.
#[derive(Deserialize)]
#[serde(untagged)]
enum Said<T> {
    Amount(String),
    Table(T),
}

impl<T> Said<T> {
    fn statement<E: std::fmt::Display>(
        self,
        part: &str,
        read: fn(&str) -> Result<StatedAmount, String>,
        make: impl Fn(StatedAmount) -> Result<T, E>,
    ) -> PyResult<T> {
        match self {
            Self::Table(table) => Ok(table),
            Self::Amount(text) => {
                let amount = read(&text)
                    .map_err(|error| refused(format_args!("{part} = {text:?}: {error}")))?;
                make(amount).map_err(refused)
            }
        }
    }
}

/// Reads what is said of a part.
fn said<T: serde::de::DeserializeOwned, E: std::fmt::Display>(
    part: &str,
    given: Option<&str>,
    read: fn(&str) -> Result<StatedAmount, String>,
    make: impl Fn(StatedAmount) -> Result<T, E>,
) -> PyResult<Option<T>> {
    let Some(given) = given else { return Ok(None) };
    let value: serde_json::Value = json::read(given)?;
    // Not as an untagged enum, which forgets what was wrong.
    let said = match value {
        serde_json::Value::String(text) => Said::Amount(text),
        table => Said::Table(
            serde_json::from_value(table)
                .map_err(|error| refused(format_args!("{part}: {error}")))?,
        ),
    };
    said.statement(part, read, make).map(Some)
}

/// The joint law that statements make about a body, and the warnings.
#[pyfunction]
#[pyo3(signature = (nominal, mass, centre, moments, products, axes, sigmas, inside))]
#[expect(clippy::too_many_arguments, reason = "one for each thing that can be said")]
pub(crate) fn stated_law(
    py: Python<'_>,
    nominal: [f64; 10],
    mass: Option<&str>,
    centre: Option<&str>,
    moments: Option<&str>,
    products: Option<&str>,
    axes: Option<&str>,
    sigmas: f64,
    inside: Option<&str>,
) -> PyResult<(BodyCore, Vec<String>)> {
    let statements = Statements {
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
    };
    let region = inside.map(json::read::<Region>).transpose()?;
    let nominal = body(&nominal).map_err(refused)?;
    py.detach(|| {
        let mut stated = StatedBody::new(&statements, &nominal).map_err(refused)?;
        if let Some(region) = region {
            stated = stated.inside(region).map_err(refused)?;
        }
        let warnings = stated.warnings().iter().map(ToString::to_string).collect();
        Ok((BodyCore::joint_law(stated.law().clone()), warnings))
    })
}
