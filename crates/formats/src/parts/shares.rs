//! Percentages in a column of masses that are shares of the total, and no standard deviations.

use super::columns::PartColumns;
use super::error::PartsProblem;
use super::heading::{Column, Group, Heading, Scale};
use super::last_place::half_of_last_place;
use super::row::PartRow;
use crate::{body::shortened, spread};

/// Beyond this, no percentage of all parts alike is a standard deviation.
const MOST_ALIKE: f64 = 20.0;

/// The percentages of the masses, as they are written, and the masses.
#[derive(Debug)]
pub(super) struct Shares {
    place: usize,
    heading: String,
    rows: Vec<(String, f64)>,
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
            self.rows.push((cell, numbers.mass_kg()));
        }
    }

    /// Why they are refused, if each is the share of its part in the mass of all of two or more, to its digits. Equal parts may have equal deviations.
    pub(super) fn problem(self) -> Option<PartsProblem> {
        let total: f64 = self.rows.iter().map(|(_, mass)| mass).sum();
        let is_share = |(cell, mass): &(String, f64)| {
            let percent = cell.parse::<f64>().ok();
            let off = half_of_last_place(cell) * (1.0 + 1e-9);
            percent.is_some_and(|percent| (percent - 100.0 * mass / total).abs() <= off)
        };
        let first = self.rows.first()?.0.parse().unwrap_or(0.0);
        let are_alike = self.rows.iter().all(|(cell, _)| cell.parse() == Ok(first));
        let are_shares = self.rows.len() > 1 && self.rows.iter().all(is_share);
        (are_shares && (!are_alike || first >= MOST_ALIKE))
            .then_some(PartsProblem::Shares { heading: self.heading })
    }
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

    /// Equal parts may be known to equal percentages, which are then their shares by chance; a fifth and more of each is no deviation.
    #[test]
    fn equal_parts_may_have_equal_deviations() {
        for count in 2..60_usize {
            let rows = vec![(3.0, format!("{}", 100.0 / count as f64)); count];
            assert_eq!(read(&list("mass_percent", &rows)).is_ok(), count > 5, "{count}");
        }
    }
}
