//! The names of runs in cells of a table, and which of them were seen.

use std::{borrow::Cow, collections::BTreeMap};

use super::written::number;
use crate::spans::Spans;

/// Digits at the end of a name that are a number, at most: it is less than 2^64.
const MOST_DIGITS: usize = 18;
/// From here on a number of 64 bits is no whole number of 128.
const TOO_LARGE: f64 = 1e38;

/// Names of runs that were seen, each with the file that had it. Names that end in numbers, and are otherwise the same, need no memory in
/// their order.
///
/// ```
/// use gyradius_campaign::RunNames;
///
/// let mut seen = RunNames::default();
/// let mut is_new = |cell: &str| RunNames::of(cell).map(|name| seen.add(&name, 0).is_ok());
/// assert_eq!(["-1", "1", "case1", "1.0", "NaN", "0.5"].map(&mut is_new), [Some(true), Some(true), Some(true), Some(false), None, None]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct RunNames(BTreeMap<String, Spans>);

impl RunNames {
    /// The run that a cell names: a whole number in any form by its digits, or a text. A fraction, an infinite number and an empty cell name none.
    #[must_use]
    pub fn of(cell: &str) -> Option<Cow<'_, str>> {
        let cell = cell.trim();
        let Some(number) = number(cell) else { return Some(cell.into()) };
        if let Ok(whole) = cell.parse::<i128>() {
            return Some(whole.to_string().into());
        }
        let whole = number.filter(|x| x.fract() == 0.0 && x.abs() < TOO_LARGE)?;
        Some((whole as i128).to_string().into())
    }

    /// Adds a name that a file has.
    ///
    /// # Errors
    /// It was seen before: the file that has had it.
    pub fn add(&mut self, name: &str, file: usize) -> Result<(), usize> {
        let (prefix, number) = parted(name);
        if let Some(seen) = self.0.get_mut(prefix) {
            return seen.add(number, file);
        }
        self.0.entry(prefix.to_owned()).or_default().add(number, file)
    }
}

/// A name as the number at its end, which does not begin with 0, and what stands before it; 0 if there is no such number. No two names have the
/// same.
fn parted(name: &str) -> (&str, u64) {
    let digits = name.bytes().rev().take_while(u8::is_ascii_digit).take(MOST_DIGITS).count();
    let (_, end) = name.split_at(name.len() - digits);
    let end = end.trim_start_matches('0');
    let (prefix, end) = name.split_at(name.len() - end.len());
    (prefix, end.parse().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashMap;

    proptest! {
        /// Names of any kind in any order: the first that was seen before is told, with the file that had it.
        #[test]
        fn what_was_seen_is_known(names in prop::collection::vec(("(-|a|case_|9{17}|)(0{0,2})[0-9]{0,3}", 0..3_usize), 0..80)) {
            let (mut seen, mut expected) = (RunNames::default(), HashMap::new());
            for (name, file) in &names {
                let there = expected.get(name).copied();
                prop_assert_eq!(seen.add(name, *file), there.map_or(Ok(()), Err));
                expected.entry(name).or_insert(*file);
            }
        }

        /// Any whole number in any form is one name, and any two differ.
        #[test]
        fn whole_numbers_are_told_apart(number: i64, shift in 0..63_u32, other: i64) {
            let number = number >> shift;
            let name = RunNames::of(&number.to_string()).unwrap().into_owned();
            let forms = [format!(" {number} "), format!("{number:+}"), format!("{number:022}")];
            for form in forms {
                prop_assert_eq!(RunNames::of(&form), Some(name.as_str().into()));
            }
            let as_number = number as f64;
            if as_number as i128 == i128::from(number) {
                let form = format!("{as_number:.1}");
                prop_assert_eq!(RunNames::of(&form), Some(name.as_str().into()));
            }
            prop_assert_eq!(RunNames::of(&other.to_string()).unwrap() == name, other == number);
            let fraction = format!("{}.5", number >> 16);
            prop_assert_eq!(RunNames::of(&fraction), None);
        }
    }

    #[test]
    fn names_in_their_order_need_no_memory() {
        for prefix in ["", "-", "case", "run 1152921504606", "a_0"] {
            let mut seen = RunNames::default();
            (1..5000).for_each(|i| seen.add(&format!("{prefix}{i}"), 0).unwrap());
            assert_eq!(seen.0.len(), 1, "{prefix}");
        }
    }
}
