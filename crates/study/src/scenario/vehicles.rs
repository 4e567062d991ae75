//! The vehicles and flights of a scenario file, and what they allow.

use super::{ScenarioError, each::Each, file::ScenarioFile, limits};
use crate::fleet::Fleet;

/// The fleet of a file, if it has one.
pub(super) fn fleet(file: &ScenarioFile) -> Result<Option<Fleet>, ScenarioError> {
    let missing = |field: &str, other: &str| {
        Err(ScenarioError::field(field, format!("missing: {other} needs it")))
    };
    let fleet = match (file.vehicles, file.flights) {
        (None, None) => return Ok(None),
        (Some(_), None) => return missing(FLIGHTS, VEHICLES),
        (None, Some(_)) => return missing(VEHICLES, FLIGHTS),
        (Some(vehicles), Some(flights)) => Fleet::new(vehicles, flights),
    };
    check(fleet)?;
    if let Some(runs) = file.runs.filter(|runs| *runs != fleet.runs()) {
        let problem = format!(
            "{runs}: the scenario has {fleet}, and its runs are their product, {}: leave it out",
            fleet.runs()
        );
        return Err(ScenarioError::field("runs", problem));
    }
    Ok(Some(fleet))
}

/// That there are some, and not too many.
pub(super) fn check(fleet: Fleet) -> Result<(), ScenarioError> {
    for (field, number) in [(VEHICLES, fleet.vehicles()), (FLIGHTS, fleet.flights())] {
        if number == 0 {
            return Err(ScenarioError::field(field, "0: it must be at least 1"));
        }
    }
    let runs = fleet.vehicles().checked_mul(fleet.flights());
    if runs.is_some_and(|runs| runs <= limits::RUNS) {
        return Ok(());
    }
    let problem = format!(
        "{}: times flights = {} it must be at most {} runs",
        fleet.vehicles(),
        fleet.flights(),
        limits::RUNS
    );
    Err(ScenarioError::field(VEHICLES, problem))
}

const VEHICLES: &str = "vehicles";
const FLIGHTS: &str = "flights";

/// That only a scenario with vehicles draws for each of them; `field` is the key that says so.
pub(crate) fn possible(
    field: &str,
    each: Each,
    fleet: Option<Fleet>,
) -> Result<Each, ScenarioError> {
    if each == Each::Vehicle && fleet.is_none() {
        let problem = "\"vehicle\": the scenario has no vehicles: one of separations has them by vehicles and flights in the place of runs";
        return Err(ScenarioError::field(field, problem));
    }
    Ok(each)
}
