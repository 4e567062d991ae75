//! Rows of a list of parts that sum up others: counted as parts, they would be counted twice.

use super::row::{PartNumbers, PartRow};
use gyradius_statistics::{SummaryNames, least_summed};

/// How far the numbers of a total may be from those of its parts, as they are rounded.
const ROUNDED: f64 = 1e-3;

/// Mass and first moments.
type Moments = [f64; 4];

fn moments(numbers: &PartNumbers) -> Moments {
    let mass = numbers.mass_kg();
    let [x, y, z] = numbers.mass_centre_m().map(|x| x * mass);
    [mass, x, y, z]
}

/// The first row with numbers whose name says that it sums up others, or speaks of a sum and has that of rows above it.
pub(super) fn named(rows: &[PartRow]) -> Option<&PartRow> {
    let size = size(rows);
    let (mut parts, mut only_grow): (Vec<Moments>, bool) = (Vec::new(), true);
    let mut names = SummaryNames::default();
    for (row, numbers) in rows.iter().filter_map(|row| Some((row, row.numbers()?))) {
        let found = moments(numbers);
        let is_sum = |least| is_sum(&parts, least, found, size, only_grow);
        if names.sums_up(row.name()) || least_summed(row.name()).is_some_and(is_sum) {
            return Some(row);
        }
        only_grow &= found[0] >= 0.0;
        parts.push(found);
    }
    None
}

/// Rows that have mass and mass centre of all rows above them together, but for such rows, or, the first one, of all below it.
pub(super) fn like_totals(rows: &[PartRow]) -> Vec<&PartRow> {
    let size = size(rows);
    let all: Vec<(&PartRow, Moments)> =
        rows.iter().filter_map(|row| Some((row, moments(row.numbers()?)))).collect();
    let mut found = Vec::new();
    let mut above: (Moments, usize) = ([0.0; 4], 0);
    for (at, (row, own)) in all.iter().enumerate() {
        let rest =
            |of: &[(&PartRow, Moments)]| of.iter().fold([0.0; 4], |sum, (_, one)| plus(sum, *one));
        let of_all = at == 0 && all.len() > 2 && is_same(rest(&all[1..]), *own, size);
        if of_all || above.1 >= 2 && is_same(above.0, *own, size) {
            found.push(*row);
        } else {
            above = (plus(above.0, *own), above.1 + 1);
        }
    }
    found
}

/// Whether it is the sum of so many or more of the last ones. `only_grow` says that no mass is negative: nothing above rows that weigh
/// more already makes the sum less, and lists of 60,000 parts whose names speak of a mass are not summed up once for each part.
fn is_sum(parts: &[Moments], least: usize, of: Moments, size: f64, only_grow: bool) -> bool {
    let mut sum = [0.0; 4];
    let sums = parts.iter().rev().zip(1..).map(|(one, count)| {
        sum = plus(sum, *one);
        (sum, count)
    });
    let is_heavier = |sum: &Moments| only_grow && sum[0] > (1.0 + 2.0 * ROUNDED) * of[0];
    sums.take_while(|(sum, _)| !is_heavier(sum))
        .any(|(sum, count)| count >= least && is_same(sum, of, size))
}

fn plus(a: Moments, b: Moments) -> Moments {
    std::array::from_fn(|i| a[i] + b[i])
}

/// To rounding: of the mass, and of the mass at the greatest distance.
fn is_same(sum: Moments, total: Moments, size: f64) -> bool {
    let near = |i: usize, of: f64| (sum[i] - total[i]).abs() <= ROUNDED * of;
    total[0] > 0.0 && near(0, total[0]) && (1..4).all(|i| near(i, total[0] * size))
}

/// The greatest coordinate of a mass centre, m.
fn size(rows: &[PartRow]) -> f64 {
    let numbers = rows.iter().filter_map(PartRow::numbers);
    numbers.flat_map(PartNumbers::mass_centre_m).fold(0.0, |size: f64, x| size.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// That sums of masses that only grow are given up where they are heavier changes no answer: half of these rows are sums.
        #[test]
        fn what_is_heavier_is_no_sum(
            parts in prop::collection::vec((0.0..3.0f64, prop::array::uniform3(-1.0..1.0f64)), 1..12),
            (summed, least, of_some, off) in (1..12_usize, 1..4_usize, any::<bool>(), 0.998..1.002f64),
        ) {
            let parts: Vec<Moments> =
                parts.into_iter().map(|(mass, [x, y, z])| [mass, mass * x, mass * y, mass * z]).collect();
            let last = parts.iter().rev().take(summed);
            let of = if of_some { last.fold([0.0; 4], |sum, one| plus(sum, *one)) } else { parts[0] };
            let of = of.map(|x| x * off);
            prop_assert_eq!(is_sum(&parts, least, of, 1.0, true), is_sum(&parts, least, of, 1.0, false));
        }
    }
}
