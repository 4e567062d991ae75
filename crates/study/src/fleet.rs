//! Vehicles and their flights: which of them a run is.

use gyradius_campaign::{Column, Counting, ForeignError, ForeignTable, Kind, RunNames, Spans};
use serde::{Deserialize, Serialize};
use std::{borrow::Cow, collections::BTreeMap, fmt, iter};

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

    /// The table with the first flight of each vehicle counted, if it is a run table of vehicles and flights that a study wrote, or a copy of
    /// some of its columns and rows, and nothing says whether the flights of a vehicle have something in common: first flights have not.
    /// With it, why all rows are counted all the same, where the table has vehicles and flights and does not tell which are the first,
    /// or how many vehicles are left out, for their first flight is not in it.
    ///
    /// # Errors
    /// The table cannot be read, its columns `run`, `vehicle` and `flight` are not those of a study, or a run that no column `model` names has two
    /// rows.
    pub fn first_flights(
        table: ForeignTable,
    ) -> Result<(ForeignTable, Option<Cow<'static, str>>), ForeignError> {
        const OTHER: &str = "the columns run, vehicle and flight do not belong together as in the run table of a study, where the run is \
                             the vehicle times the flights of each plus the flight, all from 0: all rows are judged as runs that are \
                             independent of each other, which flights of one vehicle need not be";
        if table.campaign().is_some() {
            return Ok((table, None));
        }
        again(&table)?;
        let [vehicle, flight] = Self::columns();
        let alike = |own: &Column| table.alike(own.name()).next();
        // A column of flights alone may be any program's.
        let flights = || alike(&flight).filter(|_| table.is_run_table());
        let Some(there) = alike(&vehicle).or_else(flights) else {
            return Ok((table, None));
        };
        let [Some(run), Some(vehicle), Some(flight)] =
            [Column::RUN, vehicle.name(), flight.name()].map(|own| table.spelled(own).cloned())
        else {
            let lost = format!(
                "the table has the column {there}, but not all three columns run, vehicle and flight of a study's run table, once each: all rows \
                 are judged as runs that are independent of each other, which flights of one vehicle need not be; with the three, the first \
                 flight of each vehicle is judged"
            );
            return Ok((table, Some(lost.into())));
        };
        let names = [run, vehicle, flight];
        let mut seen = SeenFlights::default();
        table.scan_of_models(&[], &names, |columns, models| {
            let [runs, vehicles, flights] = columns else { return };
            for (((run, vehicle), flight), model) in
                runs.iter().zip(vehicles).zip(flights).zip(models)
            {
                seen.add(*model, [*run, *vehicle, *flight]);
            }
        })?;
        match seen.each() {
            Some(each) => {
                let counting = Counting::new(table.counting().looks(), each);
                let left_out = (each > 1).then(|| seen.left_out()).flatten();
                Ok((table.counted(counting), left_out.map(Cow::Owned)))
            }
            None if table.is_run_table() => Err(table.refused(
                "its columns \"run\", \"vehicle\" and \"flight\" do not belong together as in the run table of a study, where the run \
                 is the vehicle times the flights of each plus the flight, all from 0: it is not known which flights are the first",
            )),
            // Columns of another program that have the same names.
            None => Ok((table, Some(OTHER.into()))),
        }
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

/// That no run stands twice among the rows that no column `model` says the model of: the number or text in the column `run` tells them apart, with the vehicle and the flight where
/// there are such columns. Of those with a model, judging tells.
fn again(table: &ForeignTable) -> Result<(), ForeignError> {
    // Of several columns of models nobody knows which says it.
    let (Some(run), None) = (table.spelled(Column::RUN), table.alike(Column::MODEL).nth(1)) else {
        return Ok(());
    };
    let of_fleet = Fleet::columns();
    let apart = of_fleet.iter().flat_map(|column| table.alike(column.name()));
    let names: Vec<String> = iter::once(run).chain(apart).cloned().collect();
    let model = table.alike(Column::MODEL);
    let columns: Vec<String> = names.iter().chain(model).cloned().collect();
    // The run of a row without a model, and what tells it from others of the same number.
    let each = |look: &mut dyn FnMut(u64, &str, &[String])| {
        let mut rows = 0..;
        table.scan_texts(&columns, |_, cells| {
            let row = rows.next().unwrap_or_default();
            let (cells, model) = cells.split_at(names.len());
            let [run, apart @ ..] = cells else { return };
            let run = RunNames::of(run).filter(|_| model.iter().all(|cell| cell.trim().is_empty()));
            if let Some(run) = run {
                look(row, &run, apart);
            }
        })
    };
    let whole = |cell: &String| RunNames::of(cell).map_or_else(String::new, Cow::into_owned);
    let twice = |is_apart: bool| {
        let (mut seen, mut twice) = (BTreeMap::<Vec<String>, RunNames>::new(), None);
        each(&mut |_, run, apart| {
            if twice.is_none() {
                let apart = if is_apart { apart.iter().map(whole).collect() } else { Vec::new() };
                let added = seen.entry(apart.clone()).or_default().add(run, 0);
                twice = added.is_err().then(|| (run.to_owned(), apart));
            }
        })?;
        Ok::<_, ForeignError>(twice)
    };
    // A run may stand for each of many vehicles: to tell these apart takes memory, and few tables need it.
    if twice(false)?.is_none() {
        return Ok(());
    }
    let Some((number, others)) = twice(true)? else { return Ok(()) };
    let mut rows = Vec::new();
    each(&mut |row, run, apart| {
        if rows.len() < 2 && *run == *number && apart.iter().map(whole).eq(others.iter().cloned()) {
            rows.push(row);
        }
    })?;
    let at: Vec<String> = rows.into_iter().map(|row| table.row_at(row)).collect();
    let named: Vec<String> = names
        .iter()
        .zip(iter::once(&number).chain(&others))
        .map(|(name, number)| format!("{} {number}", name.trim()))
        .collect();
    Err(table.refused(&format!(
        "{} are both of {}: a run counts once. If a run has many rows, as in a time history, keep the one with its worst value. If one row is a copy, \
         remove it. If each row is a run of its own, number the rows in the column {run:?}, or give that column another name. Judge \
         different models each in a file of its own",
        at.join(" and "),
        named.join(", ")
    )))
}

/// Vehicles of each model, each counted once, in flat memory where they are in order.
#[derive(Debug, Default)]
struct Counted {
    seen: BTreeMap<Option<u64>, Spans>,
    count: u64,
}

impl Counted {
    fn add(&mut self, model: Option<u64>, vehicle: u64) {
        let seen = self.seen.entry(model).or_default();
        self.count += u64::from(seen.add(vehicle, 0).is_ok());
    }
}

/// How many flights each vehicle makes, as the rows of a table say that may be some of all.
#[derive(Debug, Default)]
struct SeenFlights {
    /// As a vehicle behind the first says.
    each: Option<u64>,
    /// At least so many.
    least: u64,
    unclear: bool,
    vehicles: Counted,
    /// Those of them whose first flight there is.
    begun: Counted,
}

impl SeenFlights {
    /// Adds a row of a model: its run, vehicle and flight.
    fn add(&mut self, model: Option<u64>, row: [Option<f64>; 3]) {
        self.unclear |= self.added(model, row).is_none();
    }

    /// The same; none if the three do not belong together.
    fn added(&mut self, model: Option<u64>, row: [Option<f64>; 3]) -> Option<()> {
        let whole = |place: usize| Column::run_named(row[place]?);
        let (run, vehicle, flight) = (whole(0)?, whole(1)?, whole(2)?);
        self.least = self.least.max(flight.checked_add(1)?);
        self.vehicles.add(model, vehicle);
        if flight == 0 {
            self.begun.add(model, vehicle);
        }
        let before = run.checked_sub(flight)?;
        if vehicle == 0 {
            return (before == 0).then_some(());
        }
        let each = before / vehicle;
        let is_same = self.each.is_none_or(|known| known == each);
        self.each = Some(each);
        (before.is_multiple_of(vehicle) && is_same).then_some(())
    }

    /// The flights of each vehicle. Of the first vehicle alone, as many as there are; none if the rows contradict each other.
    fn each(&self) -> Option<u64> {
        let each = self.each.unwrap_or(self.least);
        (!self.unclear && self.least <= each).then_some(each)
    }

    /// That vehicles have no first flight here, if some have none.
    fn left_out(&self) -> Option<String> {
        let (all, begun) = (self.vehicles.count, self.begun.count);
        (begun < all).then(|| {
            format!(
                "the first flight, flight 0, of {} of {all} vehicles is not in the table: these vehicles are left out, for of each vehicle \
                 its first flight is judged",
                all - begun
            )
        })
    }
}

impl fmt::Display for Fleet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let many = |n: u64, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        let (vehicles, flights) = (many(self.vehicles, "vehicle"), many(self.flights, "flight"));
        write!(f, "{vehicles} of {flights} each")
    }
}

#[cfg(test)]
mod any_form;
#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        /// Any rows of any fleet, in any order, say how many flights each vehicle makes, those of the first vehicle alone at most as many;
        /// a row of another fleet contradicts them.
        #[test]
        fn rows_say_how_many_flights_there_are(
            vehicles in 1..60_u64,
            flights in 1..40_u64,
            chosen in prop::collection::vec(any::<prop::sample::Index>(), 1..50),
            other in 1..40_u64,
            wrong in prop::sample::select(vec![f64::NAN, -1.0, 0.5, 1e300]),
        ) {
            let row = |fleet: Fleet, run: u64| {
                let (vehicle, flight) = fleet.place(run);
                [run, vehicle, flight].map(|number| Some(number as f64))
            };
            let fleet = Fleet::new(vehicles, flights);
            let mut seen = SeenFlights::default();
            let runs: Vec<u64> = chosen.iter().map(|index| index.index((vehicles * flights) as usize) as u64).collect();
            runs.iter().for_each(|run| seen.add(None, row(fleet, *run)));
            let least = runs.iter().map(|run| run % flights + 1).max().unwrap();
            let is_known = runs.iter().any(|run| *run >= flights);
            prop_assert_eq!(seen.each(), Some(if is_known { flights } else { least }));
            let other = Fleet::new(vehicles + 1, other);
            seen.add(None, row(other, other.runs() - 1));
            if is_known && other.flights != flights {
                prop_assert_eq!(seen.each(), None);
            }
            for place in 0..3 {
                let mut seen = SeenFlights::default();
                let mut of_none = row(fleet, runs[0]);
                of_none[place] = Some(wrong).filter(|x| !x.is_nan());
                seen.add(None, of_none);
                prop_assert_eq!(seen.each(), None);
            }
        }
    }
    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        /// Rows without a model, of a fleet or of anything else: the table is refused if one run stands twice, by all columns that tell runs
        /// apart, and only then for that, with both of its rows, whatever the names of runs are and whatever else stands in a row.
        #[test]
        fn no_run_counts_twice(
            rows in prop::collection::vec((0..4_u8, 0..3_u8, 0..2_u8), 1..6),
            is_fleet in any::<bool>(),
            names in prop::sample::select(vec![["run", "vehicle", "flight"], ["Run", "VEHICLE", " flight"]]),
            apart in prop::sample::subsequence(vec![1_usize, 2], 0..=2),
            odd in prop::option::weighted(0.2, prop::sample::select(vec!["0.5", "-77", "", "a"])),
            (before_run, after) in prop::sample::select(vec![("", ""), ("-1", ""), ("115292150460684697", ""), ("case", ""), ("case 0", "b")]),
            (head, cell, has_model) in prop::sample::select(vec![
                ("", "", false),
                (",model", ",a", true),
                (",Model", ",a", true),
                // A cell that names no model, and columns of which nobody knows which names it.
                (",model", ",", false),
                (",model,model", ",a,a", true),
            ]),
        ) {
            let rows: Vec<[u8; 3]> = rows
                .into_iter()
                .map(|(run, vehicle, flight)| [if is_fleet { 2 * vehicle + flight } else { run }, vehicle, flight])
                .collect();
            let kept = |row: [String; 3]| -> String {
                apart.iter().fold(row[0].clone(), |line, place| format!("{line},{}", row[*place]))
            };
            let mut csv = format!("# a comment\nx,{}{head}\n", kept(names.map(str::to_owned)));
            let run = |row: &[u8; 3]| format!("{before_run}{}{after}", row[0]);
            for row in &rows {
                let [_, vehicle, flight] = row.map(|number| number.to_string());
                csv += &format!("1,{}{cell}\n", kept([run(row), vehicle, flight]));
            }
            if let Some(odd) = odd {
                csv += &format!("1,{}{cell}\n", kept([odd, "0", "0"].map(str::to_owned)));
            }
            let table = ForeignTable::read_csv("it.csv".as_ref(), csv.as_bytes()).unwrap();
            let key = |row: &[u8; 3]| (row[0], apart.iter().map(|place| row[*place]).collect::<Vec<_>>());
            let before = |at: usize| rows[..at].iter().position(|row| key(row) == key(&rows[at]));
            let twice = (0..rows.len()).find_map(|at| Some([before(at)? + 3, at + 3]));
            let twice = twice.filter(|_| !has_model);
            let refused = Fleet::first_flights(table).err().map(|error| error.to_string());
            let refused = refused.filter(|error| error.contains("a run counts once"));
            // Of a model and a run, judging tells.
            prop_assert_eq!(refused.is_some(), twice.is_some(), "{}", csv);
            if let (Some(refused), Some([one, other])) = (refused, twice) {
                let said = format!("it.csv: line {one} and line {other} are both of {} {}", names[0], run(&rows[other - 3]));
                prop_assert!(refused.starts_with(&said), "{}{}", csv, refused);
            }
        }

        /// Vehicles are those of a model: of each model it is known which have no first flight, in any order of the rows.
        #[test]
        fn vehicles_without_a_first_flight_are_those_of_a_model(
            (models, vehicles, flights) in (1..4_u64, 1..6_u64, 2..4_u64),
            left_out in prop::collection::vec(prop::bool::weighted(0.3), 3 * 5 * 3),
            order in prop::collection::vec(any::<u32>(), 3 * 5 * 3),
            heads in prop::sample::select(vec!["model,run,vehicle,flight", "Model,RUN,Vehicle, flight"]),
        ) {
            let fleet = Fleet::new(vehicles, flights);
            let rows = (0..models).flat_map(|model| (0..fleet.runs()).map(move |run| (model, run)));
            let rows = rows.zip(&left_out).filter(|(_, left_out)| !**left_out).map(|(row, _)| row);
            let mut rows: Vec<(u32, (u64, u64))> = order.into_iter().zip(rows).collect();
            rows.sort();
            let of = |first: bool| -> BTreeSet<(u64, u64)> {
                let rows = rows.iter().map(|(_, (model, run))| (*model, fleet.place(*run)));
                rows.filter(|(_, (_, flight))| !first || *flight == 0).map(|(model, (vehicle, _))| (model, vehicle)).collect()
            };
            let (all, begun) = (of(false).len(), of(true).len());
            // The flights of each are known, and are several.
            prop_assume!(rows.iter().any(|(_, (_, run))| *run >= flights));
            let line = |(_, (model, run)): &(u32, (u64, u64))| {
                let (vehicle, flight) = fleet.place(*run);
                format!("{model},{run},{vehicle},{flight},1\n")
            };
            let csv = format!("{heads},y\n{}", rows.iter().map(line).collect::<String>());
            let table = ForeignTable::read_csv("it.csv".as_ref(), csv.as_bytes()).unwrap();
            let (table, note) = Fleet::first_flights(table).unwrap();
            let said = format!("flight 0, of {} of {all} vehicles is not in the table", all - begun);
            prop_assert_eq!(note.as_ref().is_some_and(|note| note.contains(&said)), begun < all, "{}{:?}", csv, note);
            prop_assert_eq!(note.is_some(), begun < all);
            prop_assert_eq!(table.counting().group(), flights);
        }
    }
}
