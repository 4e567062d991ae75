//! Percentages in a column of masses that are shares of the total, and no standard deviations.

use std::collections::BTreeMap;

use super::columns::PartColumns;
use super::error::PartsProblem;
use super::heading::{Column, Group, Heading, Scale};
use super::last_place::half_of_last_place;
use super::row::PartRow;
use crate::{body::shortened, spread};

/// Beyond this, no percentage of all parts alike is a standard deviation.
const MOST_ALIKE: f64 = 20.0;

/// The percentages of the masses, and the masses.
#[derive(Debug)]
pub(super) struct Shares {
    place: usize,
    heading: String,
    rows: Vec<Row>,
}

#[derive(Debug)]
struct Row {
    /// As it is written, and as a number, if one is there.
    cell: String,
    percent: Option<f64>,
    mass: f64,
    parent: Option<String>,
}

impl Shares {
    /// The column of percentages, if there is one whose heading does not say that they are deviations.
    pub(super) fn of(columns: &PartColumns) -> Option<Self> {
        let of_mass = Heading::Column(Column::Deviation(Group(0, 1), Scale::Percent));
        let place = columns.meanings.iter().position(|column| *column == of_mass)?;
        let heading = &columns.headings[place];
        let says_it = spread::has_sigma(heading);
        (!says_it).then(|| Self { place, heading: shortened(heading), rows: Vec::new() })
    }

    pub(super) fn add(&mut self, row: &PartRow, cells: &[String]) {
        if let (Some(numbers), Some(cell)) = (row.numbers(), cells.get(self.place)) {
            let cell = cell.trim_end_matches('%').trim_end().to_owned();
            let (percent, mass) = (cell.parse().ok(), numbers.mass_kg());
            let parent = row.parent().map(str::to_owned);
            self.rows.push(Row { cell, percent, mass, parent });
        }
    }

    /// Why they are refused, if each is the share of its part in the mass of all of two or more, or of all of its assembly. Equal parts may have equal
    /// deviations.
    pub(super) fn problem(self) -> Option<PartsProblem> {
        let all: Vec<&Row> = self.rows.iter().collect();
        let mut assemblies: BTreeMap<Option<&str>, Vec<&Row>> = BTreeMap::new();
        all.iter().for_each(|row| assemblies.entry(row.parent.as_deref()).or_default().push(row));
        let given: Vec<f64> = all.iter().filter_map(|row| row.percent).collect();
        let first = *given.first()?;
        let are_alike = given.iter().all(|percent| *percent == first);
        // A few may be shares by chance.
        let are_enough = given.len() > 1 && 2 * given.len() >= all.len();
        let are_shares = are_shares(&all) || assemblies.values().all(|rows| are_shares(rows));
        (are_enough && are_shares && (!are_alike || first >= MOST_ALIKE))
            .then_some(PartsProblem::Shares { heading: self.heading })
    }
}

/// Whether the percentages of some parts, which some may lack, are their shares in the mass of all of them: rounded each, or cut to their digits, or
/// rounded so that they sum to 100.
fn are_shares(rows: &[&Row]) -> bool {
    let total: f64 = rows.iter().map(|row| row.mass).sum();
    let share = |row: &Row| 100.0 * row.mass / total;
    // By how many last places each is more than the share.
    let place = |row: &Row| 2.0 * half_of_last_place(&row.cell);
    let off = |row: &&&Row| Some((row.percent? - share(row)) / place(row));
    let places: Vec<f64> = rows.iter().filter_map(|row| off(&row)).collect();
    const ROUNDED: f64 = 1e-6;
    let are_within = |least: f64, most: f64| {
        places.iter().all(|off| (least - ROUNDED..=most + ROUNDED).contains(off))
    };
    let sum: f64 = rows.iter().map(|row| row.percent.unwrap_or_else(|| share(row))).sum();
    let last =
        rows.iter().filter(|row| row.percent.is_some()).map(|row| place(row)).fold(0.0, f64::max);
    let lacking = rows.len() - places.len();
    let is_whole = (sum - 100.0).abs() <= last * (lacking as f64 + ROUNDED) + 1e-9;
    are_within(-0.5, 0.5) || are_within(-1.0, 0.0) || is_whole && are_within(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::tests::read;
    use proptest::prelude::*;

    fn list(heading: &str, rows: &[(f64, String)]) -> String {
        let rows = rows
            .iter()
            .enumerate()
            .map(|(at, (mass, percent))| format!("part {at},{mass},0,0,0,1,1,1,{percent}\n"));
        format!("name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,{heading}\n{}", rows.collect::<String>())
    }

    proptest! {
        /// Shares of the whole are refused in whatever digits they are shown, unless the heading says that they are deviations; other percentages are read.
        #[test]
        fn shares_are_no_deviations(
            masses in prop::collection::vec(1.0..100.0_f64, 2..10),
            (decimals, sign) in (0_usize..6, prop::sample::select(vec!["", "%", " %"])),
            (at, off) in (any::<prop::sample::Index>(), prop::sample::select(vec![0.7, 1.4])),
            heading in prop::sample::select(vec!["Mass (%)", "mass_percent", "Mass [percent]"]),
        ) {
            let total: f64 = masses.iter().sum();
            let shares: Vec<f64> = masses.iter().map(|mass| 100.0 * mass / total).collect();
            let rows = |percents: &[f64]| -> Vec<(f64, String)> {
                masses.iter().zip(percents).map(|(mass, percent)| (*mass, format!("{percent:.decimals$}{sign}"))).collect()
            };
            let as_shares = rows(&shares);
            let are_alike = as_shares.iter().all(|(_, cell)| *cell == as_shares[0].1) && shares[0] < 20.5;
            let refused = read(&list(heading, &as_shares)).err().map(|error| error.to_string());
            prop_assert!(are_alike || refused.as_ref().is_some_and(|said| said.contains("share of each part in the mass of all")), "{:?}", refused);
            for heading in ["sigma_mass_percent", "sigma mass (%)"] {
                prop_assert!(read(&list(heading, &as_shares)).is_ok());
            }
            let mut others = shares.clone();
            let at = at.index(others.len());
            others[at] = off * others[at] + 1.01 + f64::powi(10.0, -(decimals as i32));
            prop_assume!((others[at] - shares[at]).abs() > 1.01);
            let table = read(&list(heading, &rows(&others)));
            prop_assert!(table.is_ok(), "{:?}", table);
        }
    }

    /// Shares that are cut to their digits, or rounded so that they sum to 100, of all or of an assembly, with cells that are empty.
    fn shown(shares: &[f64], decimals: i32, is_cut: bool) -> Vec<f64> {
        let scale = f64::powi(10.0, decimals);
        let mut shown: Vec<f64> = shares.iter().map(|share| (share * scale).floor()).collect();
        let lacking = 100.0 * scale - shown.iter().sum::<f64>();
        let mut by_rest: Vec<usize> = (0..shares.len()).collect();
        let rest = |at: &usize| (shares[*at] * scale).fract();
        by_rest.sort_by(|a, b| rest(b).total_cmp(&rest(a)));
        if !is_cut {
            by_rest.iter().take(lacking.round() as usize).for_each(|at| shown[*at] += 1.0);
        }
        shown.into_iter().map(|share| share / scale).collect()
    }

    proptest! {
        #[test]
        fn shares_in_whatever_digits_are_no_deviations(
            assemblies in prop::collection::vec(prop::collection::vec(1.0..100.0_f64, 2..6), 1..4),
            (decimals, is_cut, is_of_all) in (0_i32..4, any::<bool>(), any::<bool>()),
            (blank, scatter) in (prop::option::of(any::<prop::sample::Index>()), prop::collection::vec(0.5..3.0_f64, 20)),
        ) {
            let all: Vec<f64> = assemblies.concat();
            let of = |masses: &[f64]| {
                let total: f64 = masses.iter().sum();
                let shares: Vec<f64> = masses.iter().map(|mass| 100.0 * mass / total).collect();
                shown(&shares, decimals, is_cut)
            };
            let shares = if is_of_all { of(&all) } else { assemblies.iter().flat_map(|masses| of(masses)).collect() };
            prop_assume!(shares.iter().any(|share| *share != shares[0]) || shares[0] >= 20.0);
            let blank = blank.map(|at| at.index(all.len())).filter(|_| all.len() > 3);
            let list = |percents: &[f64]| {
                let mut text = "name,parent,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,Mass (%)\ncraft,,,,,,,,,\n".to_owned();
                let mut at = 0;
                for (i, masses) in assemblies.iter().enumerate() {
                    text += &format!("bus {i},craft,,,,,,,,\n");
                    for mass in masses {
                        let cell = if blank == Some(at) { String::new() } else { format!("{:.*}", decimals as usize, percents[at]) };
                        text += &format!("part {at},bus {i},{mass},0,0,0,1,1,1,{cell}\n");
                        at += 1;
                    }
                }
                text
            };
            let refused = read(&list(&shares)).err().map(|error| error.to_string());
            let said = refused.as_ref().is_some_and(|said| said.contains("the share of each part in the mass"));
            prop_assert!(said, "{}{:?}", list(&shares), refused);
            // Deviations of some percent of each part are none, whatever the masses.
            let deviations: Vec<f64> = all.iter().zip(&scatter).map(|(_, s)| *s).collect();
            prop_assert!(read(&list(&deviations)).is_ok(), "{}", list(&deviations));
        }
    }

    /// Equal parts may be known to equal percentages, which are then their shares by chance; a fifth and more of each is no deviation.
    #[test]
    fn equal_parts_may_have_equal_deviations() {
        for count in 2..60_usize {
            let rows = vec![(3.0, format!("{}", 100.0 / count as f64)); count];
            assert_eq!(read(&list("mass_percent", &rows)).is_ok(), count > 5, "{count}");
        }
    }
}
