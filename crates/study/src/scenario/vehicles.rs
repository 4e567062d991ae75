//! How many runs a scenario has: so many, or the flights of vehicles; and what vehicles allow.

use super::{ScenarioError, each::Each};
use crate::fleet::Fleet;

/// How many runs a scenario has of each model.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Size {
    /// So many, all on their own.
    Runs(u64),
    /// The flights of vehicles.
    Fleet(Fleet),
}

/// Most runs of a model: nine digits number them in the names of files, and weeks pass until they are done.
const RUNS_AT_MOST: u64 = 1_000_000_000;

/// Runs if neither they nor vehicles are given.
const DEFAULT_RUNS: u64 = 2000;

const RUNS: &str = "runs";
const VEHICLES: &str = "vehicles";
const FLIGHTS: &str = "flights";

impl Size {
    /// Of what a file says under `runs`, `vehicles` and `flights`.
    pub(crate) fn of(keys: [Option<u64>; 3]) -> Result<Self, ScenarioError> {
        let missing = |field: &str, other: &str| {
            Err(ScenarioError::field(field, format!("missing: {other} needs it")))
        };
        let [runs, vehicles, flights] = keys;
        let fleet = match (vehicles, flights) {
            (None, None) => return Self::of_runs(runs.unwrap_or(DEFAULT_RUNS)),
            (Some(_), None) => return missing(FLIGHTS, VEHICLES),
            (None, Some(_)) => return missing(VEHICLES, FLIGHTS),
            (Some(vehicles), Some(flights)) => Fleet::new(vehicles, flights),
        };
        check(fleet)?;
        if let Some(runs) = runs.filter(|runs| *runs != fleet.runs()) {
            let problem = format!(
                "{runs}: the scenario has {fleet}, and its runs are their product, {}: leave it out",
                fleet.runs()
            );
            return Err(ScenarioError::field(RUNS, problem));
        }
        Ok(Self::Fleet(fleet))
    }

    fn of_runs(runs: u64) -> Result<Self, ScenarioError> {
        if (1..=RUNS_AT_MOST).contains(&runs) {
            return Ok(Self::Runs(runs));
        }
        let problem = format!("{runs}: it must be between 1 and {RUNS_AT_MOST}");
        Err(ScenarioError::field(RUNS, problem))
    }

    /// What a resolved file says of it under `runs`, `vehicles` and `flights`: one of the two.
    pub(crate) fn keys(self) -> [Option<u64>; 3] {
        match self {
            Self::Runs(runs) => [Some(runs), None, None],
            Self::Fleet(fleet) => [None, Some(fleet.vehicles()), Some(fleet.flights())],
        }
    }

    /// With another number of runs, if there are no vehicles.
    pub(crate) fn with_runs(self, runs: u64) -> Result<Self, ScenarioError> {
        match self {
            Self::Runs(_) => Self::of_runs(runs),
            Self::Fleet(fleet) => {
                let problem = format!(
                    "{runs}: the scenario has {fleet}, and its runs are their product: say how many vehicles instead"
                );
                Err(ScenarioError::field(RUNS, problem))
            }
        }
    }

    /// With another number of vehicles, each with as many flights, if there are vehicles.
    pub(crate) fn with_vehicles(self, vehicles: u64) -> Result<Self, ScenarioError> {
        match self {
            Self::Runs(_) => {
                let problem = format!("{vehicles}: {NO_VEHICLES}");
                Err(ScenarioError::field(VEHICLES, problem))
            }
            Self::Fleet(fleet) => {
                let fleet = Fleet::new(vehicles, fleet.flights());
                check(fleet)?;
                Ok(Self::Fleet(fleet))
            }
        }
    }

    /// With so many runs: flights of as many vehicles as make them, if there are vehicles.
    pub(crate) fn of_all(self, runs: u64) -> Result<Self, ScenarioError> {
        match self.fleet() {
            None => self.with_runs(runs),
            Some(fleet) => self.with_vehicles(runs / fleet.flights().max(1)),
        }
    }

    /// Runs of each model: the flights of all vehicles, if there are vehicles.
    pub(crate) fn runs(self) -> u64 {
        match self {
            Self::Runs(runs) => runs,
            Self::Fleet(fleet) => fleet.runs(),
        }
    }

    /// The vehicles and how often each flies, if there are vehicles.
    pub(crate) fn fleet(self) -> Option<Fleet> {
        match self {
            Self::Runs(_) => None,
            Self::Fleet(fleet) => Some(fleet),
        }
    }

    /// The fleet, if any of what is drawn is that of a vehicle and vehicles fly more than once, so that runs are not
    /// independent.
    pub(crate) fn sharing(self, mut drawn: impl Iterator<Item = Each>) -> Option<Fleet> {
        let fleet = self.fleet().filter(|fleet| fleet.flights() > 1)?;
        drawn.any(|each| !each.is_flight()).then_some(fleet)
    }

    /// The number of the random stream that a run takes for what is drawn for each vehicle, or for each flight.
    pub(crate) fn stream(self, each: Each, run: u64) -> u64 {
        match (each, self) {
            (Each::Vehicle, Self::Fleet(fleet)) => fleet.place(run).0,
            (Each::Flight, _) | (Each::Vehicle, Self::Runs(_)) => run,
        }
    }
}

/// That there are some, and not too many.
fn check(fleet: Fleet) -> Result<(), ScenarioError> {
    for (field, number) in [(VEHICLES, fleet.vehicles()), (FLIGHTS, fleet.flights())] {
        if number == 0 {
            return Err(ScenarioError::field(field, "0: it must be at least 1"));
        }
    }
    let runs = fleet.vehicles().checked_mul(fleet.flights());
    if runs.is_some_and(|runs| runs <= RUNS_AT_MOST) {
        return Ok(());
    }
    let problem = format!(
        "{}: times flights = {} it must be at most {} runs",
        fleet.vehicles(),
        fleet.flights(),
        RUNS_AT_MOST
    );
    Err(ScenarioError::field(VEHICLES, problem))
}

const NO_VEHICLES: &str =
    "the scenario has no vehicles: it needs vehicles and flights in the place of runs";

/// That only a scenario with vehicles draws for each of them; `field` is the key that says so.
pub(super) fn possible(
    field: &str,
    each: Each,
    fleet: Option<Fleet>,
) -> Result<Each, ScenarioError> {
    if each == Each::Vehicle && fleet.is_none() {
        return Err(ScenarioError::field(field, format!("\"vehicle\": {NO_VEHICLES}")));
    }
    Ok(each)
}
