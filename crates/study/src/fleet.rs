//! Vehicles and their flights: which of them a run is.

use gyradius_campaign::{Column, Counting, ForeignError, ForeignTable, Kind};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Vehicles, each of which flies so many times.
///
/// Run `vehicle · flights + flight` is that flight of that vehicle, both from 0: more vehicles change no run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fleet {
    vehicles: u64,
    flights: u64,
}

impl Fleet {
    /// So many vehicles of so many flights each.
    pub(crate) fn new(vehicles: u64, flights: u64) -> Self {
        Self { vehicles, flights }
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
        // A scenario with more is refused.
        self.vehicles.saturating_mul(self.flights)
    }

    /// The vehicle and the flight of a run, all from 0.
    #[must_use]
    pub fn place(self, run: u64) -> (u64, u64) {
        let flights = self.flights.max(1);
        (run / flights, run % flights)
    }

    /// The columns of vehicle and flight.
    pub(crate) fn columns() -> [Column; 2] {
        [
            (
                "vehicle",
                "Which vehicle the run is a flight of, from 0; only in scenarios with `vehicles`.",
            ),
            (
                "flight",
                "Which of the vehicle's flights it is, from 0; only in scenarios with `vehicles`.",
            ),
        ]
        .map(|(name, meaning)| Column::new(name, Kind::Integer, meaning).required())
    }

    /// The table with the first flight of each vehicle counted, if it is a run table of vehicles and flights that a study wrote and nothing says
    /// whether the flights of a vehicle have something in common: first flights have not.
    ///
    /// # Errors
    /// The table cannot be read.
    pub fn first_flights(table: ForeignTable) -> Result<ForeignTable, ForeignError> {
        let [vehicle, flight] = Self::columns().map(|column| column.name().to_owned());
        let has = |name: &String| table.columns().contains(name);
        if table.campaign().is_some() || !table.is_run_table() || !has(&vehicle) || !has(&flight) {
            return Ok(table);
        }
        let mut last = 0.0;
        table.scan_beside(&[], &[flight], |columns| {
            last = columns.iter().flatten().flatten().copied().fold(last, f64::max);
        })?;
        let counting = Counting::new(table.counting().looks(), (last as u64).saturating_add(1));
        Ok(table.counted(counting))
    }

    /// What a run has in them.
    pub(crate) fn numbers(self, run: u64) -> [i64; 2] {
        let (vehicle, flight) = self.place(run);
        // Runs are numbered in such a column, too.
        [vehicle, flight].map(|number| i64::try_from(number).unwrap_or(i64::MAX))
    }

    /// What there is to say of a run: its vehicle and flight.
    pub(crate) fn told(self, run: u64) -> String {
        let (vehicle, flight) = self.place(run);
        format!("(vehicle {vehicle}, flight {flight})")
    }

    /// The run that is a flight of a vehicle, all from 0; none if there is no such vehicle or flight.
    #[must_use]
    pub fn run(self, vehicle: u64, flight: u64) -> Option<u64> {
        let there = vehicle < self.vehicles && flight < self.flights;
        there.then(|| vehicle * self.flights + flight)
    }
}

impl fmt::Display for Fleet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let many = |n: u64, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        let (vehicles, flights) = (many(self.vehicles, "vehicle"), many(self.flights, "flight"));
        write!(f, "{vehicles} of {flights} each")
    }
}
