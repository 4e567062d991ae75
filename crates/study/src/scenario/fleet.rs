//! The two loops of a campaign: vehicles, and flights of each.

use serde::{Deserialize, Serialize};

use super::{ScenarioError, each::Each, file::ScenarioFile, limits};

/// Vehicles, each of which flies so many times.
///
/// Run `vehicle · flights + flight` is that flight of that vehicle, both from 0: more vehicles change no run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fleet {
    vehicles: u64,
    flights: u64,
}

impl Fleet {
    /// The fleet of a file, if it has one.
    pub(super) fn new(file: &ScenarioFile) -> Result<Option<Self>, ScenarioError> {
        let missing = |field: &str, other: &str| {
            Err(ScenarioError::field(field, format!("missing: {other} needs it")))
        };
        let fleet = match (file.vehicles, file.flights) {
            (None, None) => return Ok(None),
            (Some(_), None) => return missing(FLIGHTS, VEHICLES),
            (None, Some(_)) => return missing(VEHICLES, FLIGHTS),
            (Some(vehicles), Some(flights)) => Self { vehicles, flights },
        };
        fleet.check()?;
        if let Some(runs) = file.runs.filter(|runs| *runs != fleet.runs()) {
            let problem = format!(
                "{runs}: the scenario has {fleet}, and its runs are their product, {}: leave it out",
                fleet.runs()
            );
            return Err(ScenarioError::field("runs", problem));
        }
        Ok(Some(fleet))
    }

    /// The same with another number of vehicles.
    pub(super) fn with_vehicles(self, vehicles: u64) -> Result<Self, ScenarioError> {
        let fleet = Self { vehicles, ..self };
        fleet.check()?;
        Ok(fleet)
    }

    fn check(self) -> Result<(), ScenarioError> {
        for (field, number) in [(VEHICLES, self.vehicles), (FLIGHTS, self.flights)] {
            if number == 0 {
                return Err(ScenarioError::field(field, "0: it must be at least 1"));
            }
        }
        let runs = self.vehicles.checked_mul(self.flights);
        if runs.is_some_and(|runs| runs <= limits::RUNS) {
            return Ok(());
        }
        let problem = format!(
            "{}: times flights = {} it must be at most {} runs",
            self.vehicles,
            self.flights,
            limits::RUNS
        );
        Err(ScenarioError::field(VEHICLES, problem))
    }

    /// How many vehicles there are.
    #[must_use]
    pub fn vehicles(self) -> u64 {
        self.vehicles
    }

    /// How many flights each of them makes.
    #[must_use]
    pub fn flights(self) -> u64 {
        self.flights
    }

    /// The flights of all vehicles.
    #[must_use]
    pub fn runs(self) -> u64 {
        // Checked; and a number in a file that is not is refused with it.
        self.vehicles.saturating_mul(self.flights)
    }

    /// The vehicle and the flight of a run, all from 0.
    #[must_use]
    pub fn place(self, run: u64) -> (u64, u64) {
        let flights = self.flights.max(1);
        (run / flights, run % flights)
    }

    /// The run that is a flight of a vehicle, all from 0; none if there is no such vehicle or flight.
    #[must_use]
    pub fn run(self, vehicle: u64, flight: u64) -> Option<u64> {
        let there = vehicle < self.vehicles && flight < self.flights;
        there.then(|| vehicle * self.flights + flight)
    }
}

impl std::fmt::Display for Fleet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let many = |n: u64, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        let (vehicles, flights) = (many(self.vehicles, "vehicle"), many(self.flights, "flight"));
        write!(f, "{vehicles} of {flights} each")
    }
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
