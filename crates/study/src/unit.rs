//! Units of what requirements are about, where names do not tell them.

use gyradius_campaign::Measured;

use crate::subject::Subject;

/// The unit of a quantity, where the names of its columns do not tell it: that of all of them.
pub(crate) fn unit_of(scenario: &impl Subject, quantity: &Measured) -> Option<String> {
    let mut units = quantity.columns().iter().map(|column| scenario.unit(column));
    let first = units.next()??;
    units.all(|unit| unit.as_ref() == Some(&first)).then_some(first)
}

/// A number, or several, with a unit if there is one.
pub(crate) fn in_unit(told: String, unit: Option<&str>) -> String {
    match unit {
        Some(unit) => format!("{told} {unit}"),
        None => told,
    }
}
