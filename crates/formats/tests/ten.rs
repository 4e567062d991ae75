//! Tables of mass, mass centre and inertia, and estimates of the ten, in any order of columns and any unit.

use gyradius_formats::{InertiaFile, Products, TenCentre, TenMomentsFile, TenTable, TenTableError};
use proptest::prelude::*;
use proptest::sample::{Index, select};
use std::path::Path;

const MASSES: [(&str, f64); 4] = [("", 1.0), ("kg", 1.0), ("g", 1e-3), ("lb", 0.453_592_37)];
const LENGTHS: [(&str, f64); 4] = [("", 1.0), ("m", 1.0), ("mm", 1e-3), ("in", 0.0254)];
const MOMENTS: [(&str, f64); 4] =
    [("", 1.0), ("kg m", 1.0), ("g·mm", 1e-6), ("lb in", 0.453_592_37 * 0.0254)];
const INERTIAS: [(&str, f64); 4] =
    [("", 1.0), ("kg m2", 1.0), ("g*mm^2", 1e-9), ("lb·in²", 0.453_592_37 * 0.0254 * 0.0254)];

/// Names of the ten: of a mass centre, or of first moments.
fn spelled(place: usize, centre: TenCentre, spelling: usize) -> String {
    let axis = |names: [&str; 4]| {
        let letter = ["x", "y", "z"][place - 1];
        match spelling % 4 {
            0 => format!("{}{letter}", names[0]),
            1 => format!("{}_{letter}", names[1]),
            2 => format!("{} {}", names[2], letter.to_uppercase()),
            _ => format!("{}_{place}", names[3]),
        }
    };
    match (place, centre) {
        (0, _) => ["mass", "m", "Mass", "MASS"][spelling % 4].to_owned(),
        (1..=3, TenCentre::MassCentre) => axis(["c", "com", "Centre", "mass_centre"]),
        (1..=3, TenCentre::FirstMoments) => axis(["h", "mc", "First moment", "first_moment"]),
        _ => {
            let entry = ["xx", "yy", "zz", "xy", "xz", "yz"][place - 4];
            let digits = ["11", "22", "33", "12", "13", "23"][place - 4];
            match spelling % 4 {
                0 => format!("i{entry}"),
                1 => format!("I_{entry}"),
                2 => format!("I{digits}"),
                _ => format!("i{}", entry.to_uppercase()),
            }
        }
    }
}

/// The ten columns of a table in an order, with a unit for the mass, one for the next three and one for the inertia, which at least one
/// of them states.
#[derive(Clone, Debug)]
struct Columns {
    centre: TenCentre,
    order: Vec<usize>,
    spelling: [usize; 10],
    units: [usize; 3],
    silent: [bool; 10],
}

fn which(place: usize) -> usize {
    match place {
        0 => 0,
        1..=3 => 1,
        _ => 2,
    }
}

impl Columns {
    fn unit(&self, place: usize) -> (&'static str, f64) {
        let units = match (place, self.centre) {
            (0, _) => MASSES,
            (1..=3, TenCentre::MassCentre) => LENGTHS,
            (1..=3, TenCentre::FirstMoments) => MOMENTS,
            _ => INERTIAS,
        };
        units[self.units[which(place)]]
    }

    fn stated(&self, place: usize) -> &'static str {
        if self.silent[place] && ![0, 2, 6].contains(&place) { "" } else { self.unit(place).0 }
    }

    fn name(&self, place: usize) -> String {
        spelled(place, self.centre, self.spelling[place])
    }

    fn heading(&self, place: usize) -> String {
        match self.stated(place) {
            "" => self.name(place),
            unit => format!("{} [{unit}]", self.name(place)),
        }
    }

    fn row(&self, of: impl Fn(usize) -> String) -> Vec<String> {
        self.order.iter().map(|place| of(*place)).collect()
    }
}

fn columns() -> impl Strategy<Value = Columns> {
    (
        select(vec![TenCentre::MassCentre, TenCentre::FirstMoments]),
        Just((0..10).collect::<Vec<usize>>()).prop_shuffle(),
        prop::array::uniform10(0..4_usize),
        prop::array::uniform3(0..4_usize),
        prop::array::uniform10(any::<bool>()),
    )
        .prop_map(|(centre, order, spelling, mut units, silent)| {
            // Beside a unit, each kind states its own: beside one that is not of SI, it must.
            if units != [0; 3] {
                units = units.map(|unit| unit.max(1));
            }
            Columns { centre, order, spelling, units, silent }
        })
}

fn is_near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-12 * expected.abs()
}

fn checked(table: &str) -> InertiaFile {
    let bytes = table.as_bytes().to_vec();
    InertiaFile::parse(Path::new("t.csv"), bytes, Products::TensorEntries).unwrap()
}

fn joined(rows: &[Vec<String>]) -> String {
    rows.iter().map(|row| row.join(",") + "\n").collect()
}

proptest! {
    /// Any order, unit and spelling; units in the headings or in a row below; the sign of products in a line above or below the header, in a
    /// column, or in none. Mass and inertia are those that are read for a check, to the bit.
    #[test]
    fn tables_of_ten_are_read_in_any_order_and_unit(
        columns in columns(),
        bodies in prop::collection::vec(prop::array::uniform10(0.1..9.0_f64), 1..4),
        sign in 0..4_usize,
        has_row_of_units in any::<bool>(),
        extra in prop::collection::vec(select(vec!["time", "x", "mass_source", "Cx_sigma", "note"]), 0..3),
    ) {
        let mut rows = vec![columns.row(|p| if has_row_of_units { columns.name(p) } else { columns.heading(p) })];
        if has_row_of_units {
            rows.push(columns.row(|p| columns.stated(p).to_owned()));
        }
        // A row of units says that of an inertia.
        prop_assume!(!has_row_of_units || columns.units[2] > 0);
        let above = rows.len();
        rows.extend(bodies.iter().map(|body| columns.row(|place| body[place].to_string())));
        for name in &extra {
            for (at, row) in rows.iter_mut().enumerate() {
                row.push(match at {
                    0 => (*name).to_owned(),
                    _ if at < above => String::new(),
                    _ => "7".to_owned(),
                });
            }
        }
        if sign == 1 {
            for (at, row) in rows.iter_mut().enumerate() {
                row.push(if at == 0 { "products" } else if at < above { "" } else { "integrals" }.to_owned());
            }
        }
        let table = joined(&rows);
        let table = match sign {
            2 => format!("# products = integrals\n{table}"),
            3 => format!("{table}# products = integrals\n"),
            _ => table,
        };
        let file = checked(&table);
        let read = TenTable::of(&file).unwrap();
        prop_assert_eq!(read.centre(), Some(columns.centre));
        prop_assert_eq!(read.unused(), extra.as_slice());
        prop_assert_eq!(read.rows().len(), bodies.len());
        for ((row, body), one) in read.rows().iter().zip(&bodies).zip(file.bodies()) {
            prop_assert_eq!(row.line(), one.line());
            let values = row.values().unwrap();
            for place in 0..10 {
                let sign = if place >= 7 && sign > 0 { -1.0 } else { 1.0 };
                let expected = body[place] * columns.unit(place).1 * sign;
                prop_assert!(is_near(values[place], expected), "{table}{place}: {values:?}");
            }
            prop_assert_eq!(Some(values[0]), one.mass_kg());
            prop_assert_eq!(values[4], one.inertia().unwrap()[(0, 0)]);
            prop_assert_eq!(values[9], one.inertia().unwrap()[(1, 2)]);
        }
    }

    /// What is half there, there twice, in a unit that is not read, or of both kinds is refused by its name.
    #[test]
    fn columns_that_do_not_make_ten_are_refused(columns in columns(), at in 1..=3_usize, how in 0..5_usize) {
        let other = match columns.centre {
            TenCentre::MassCentre => TenCentre::FirstMoments,
            TenCentre::FirstMoments => TenCentre::MassCentre,
        };
        let mut row = columns.row(|place| columns.name(place));
        let place = columns.order.iter().position(|place| *place == at).unwrap();
        match how {
            0 => { row.remove(place); }
            1 => row.push(row[place].clone()),
            2 => row[place] += " [furlong]",
            3 => row[place] = spelled(at, other, columns.spelling[at]),
            _ => { row.remove(columns.order.iter().position(|place| *place == 0).unwrap()); }
        }
        let table = joined(&[row.clone(), vec!["1".to_owned(); row.len()]]);
        let read = TenTable::of(&checked(&table));
        // The inertia is about the mass centre, wherever that is.
        if how == 4 && columns.centre == TenCentre::MassCentre {
            prop_assert_eq!(read.unwrap().unused().len(), 3);
            return Ok(());
        }
        let error = read.unwrap_err();
        let is_so = match &error {
            TenTableError::Missing { missing, .. } => (how == 0) || (how == 4 && *missing == "mass"),
            TenTableError::Twice { .. } => how == 1,
            TenTableError::Unit(error) => how == 2 && error.unit() == "furlong",
            TenTableError::Mixed { .. } => how == 3,
            _ => false,
        };
        prop_assert!(is_so, "{table}{error}");
    }

    /// The same of an estimate, whose covariance follows its mean. Without a header they stand in their order, in SI.
    #[test]
    fn estimates_are_read_in_any_order_and_unit(
        columns in columns(),
        numbers in prop::collection::vec(prop::array::uniform10(-9.0..9.0_f64), 11),
        has_header in any::<bool>(),
        mark in select(&["", "# ", "#"][..]),
        integrals in 0..3_usize,
        lost in any::<Index>(),
        title in select(&["# All units: lb, in\n", "# Mass in g\n", "# FT-2\n"][..]),
        is_above in any::<bool>(),
    ) {
        let columns = if has_header {
            columns
        } else {
            Columns { order: (0..10).collect(), units: [0; 3], ..columns }
        };
        let heading = columns.row(|place| columns.heading(place));
        let mut rows = vec![columns.row(|place| numbers[0][place].to_string())];
        for from in &columns.order {
            rows.push(columns.row(|place| numbers[1 + from][place].to_string()));
        }
        let line = "# products = integrals\n";
        let head = if has_header { format!("{mark}{}", joined(std::slice::from_ref(&heading))) } else { String::new() };
        let text = match integrals {
            0 => format!("{head}{}", joined(&rows)),
            1 => format!("{line}{head}{}", joined(&rows)),
            _ => format!("{head}{}{line}", joined(&rows)),
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("estimate.csv");
        std::fs::write(&path, &text).unwrap();
        let read = TenMomentsFile::read(&path).unwrap();
        let said = match columns.centre {
            TenCentre::MassCentre => "natural",
            TenCentre::FirstMoments => "linear",
        };
        prop_assert_eq!(read.parameters(), has_header.then_some(said));
        let unit = |place: usize| {
            columns.unit(place).1 * if place >= 7 && integrals > 0 { -1.0 } else { 1.0 }
        };
        for i in 0..10 {
            prop_assert!(is_near(read.mean()[i], numbers[0][i] * unit(i)), "{text}{i}");
            for (j, number) in numbers[1 + i].iter().enumerate() {
                let expected = number * unit(i) * unit(j);
                prop_assert!(is_near(read.covariance()[i][j], expected), "{text}{i} {j}");
            }
        }
        // A title does not tell the units of the columns.
        std::fs::write(&path, if is_above { format!("{title}{text}") } else { format!("{text}{title}") }).unwrap();
        let is_told = (0..3).all(|kind| columns.units[kind] > 0) || title.contains("FT-2");
        match TenMomentsFile::read(&path) {
            Ok(again) => prop_assert!(is_told && again == read, "{}", text),
            Err(error) => {
                let error = error.to_string();
                prop_assert!(!is_told && error.contains("speaks of units that are not"), "{}{}", text, error);
            }
        }
        // A header that does not name all ten is refused.
        if has_header {
            let mut heading = heading;
            heading[lost.index(10)] = "time".to_owned();
            std::fs::write(&path, format!("{mark}{}", joined(&[vec![heading], rows].concat()))).unwrap();
            let error = TenMomentsFile::read(&path).unwrap_err().to_string();
            prop_assert!(error.contains("\"time\" is none of the ten"), "{error}");
        }
    }
}

/// A standard deviation below zero is none.
#[test]
fn negative_deviations_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("estimate.json");
    let text = |d: f64| {
        format!(
            "{{\"mean\": [1,0,0,0,1,1,1,0,0,0], \"deviations\": [0.1,{d},0.1,0.1,0.1,0.1,0.1,0.1,0.1,0.1]}}"
        )
    };
    std::fs::write(&path, text(0.1)).unwrap();
    assert_eq!(TenMomentsFile::read(&path).unwrap().covariance()[1][1], 0.1 * 0.1);
    std::fs::write(&path, text(-0.1)).unwrap();
    let error = TenMomentsFile::read(&path).unwrap_err().to_string();
    assert_eq!(error, "deviation 2 = -0.1: it must be zero or more");
}
