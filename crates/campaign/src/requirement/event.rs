//! An event: that a number of a run is beyond a limit.

use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

use super::{Bound, Measured, RequirementError, text, words::Words};
use crate::table::Table;

/// That a number of a run keeps a bound, which is rare.
///
/// A line of text is one, as the beginning of a [`Requirement`](super::Requirement): `cone_deg >= 5`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Event {
    quantity: Measured,
    bound: Bound,
}

impl Event {
    /// What it is about.
    #[must_use]
    pub fn quantity(&self) -> &Measured {
        &self.quantity
    }

    /// By how much the runs of a block are the event: 0 and more are. NaN of a run without a number, most often because
    /// it failed. A number that is infinite is the event, or infinitely far from it, as its sign says.
    #[must_use]
    pub fn excesses(&self, block: &Table) -> Vec<f64> {
        let numbers = self.quantity.numbers(block).into_iter();
        numbers.map(|x| x.map_or(f64::NAN, |x| 0.0 - self.bound.excess(x))).collect()
    }
}

impl FromStr for Event {
    type Err = RequirementError;

    fn from_str(text: &str) -> Result<Self, RequirementError> {
        let mut words = Words::new(text);
        let read = text::bounded(&mut words).and_then(|read| words.end().map(|()| read));
        let (quantity, bound) = read.map_err(RequirementError::of_event)?;
        bound.check()?;
        Ok(Self { quantity, bound })
    }
}

impl TryFrom<String> for Event {
    type Error = RequirementError;

    fn try_from(text: String) -> Result<Self, RequirementError> {
        text.parse()
    }
}

impl From<Event> for String {
    fn from(event: Event) -> Self {
        event.to_string()
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        text::write_bounded(f, &self.quantity, self.bound)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Column, Failure};
    use proptest::prelude::*;

    proptest! {
        /// What is written reads back, and a run is the event if its number keeps the bound.
        #[test]
        fn events_are_what_they_say(
            limit in -1e3..1e3_f64,
            kind in 0..3_u8,
            absolute: bool,
            numbers in prop::collection::vec(prop::option::of(prop_oneof![
                8 => -1e3..1e3_f64,
                1 => prop::sample::select(vec![f64::INFINITY, f64::NEG_INFINITY]),
            ]), 1..40),
        ) {
            let quantity = if absolute { "abs(x)" } else { "x" };
            let text = match kind {
                0 => format!("{quantity} >= {limit}"),
                1 => format!("{quantity} <= {limit}"),
                _ => format!("{limit} <= {quantity} <= {}", limit + 10.0),
            };
            let event: Event = text.parse().unwrap();
            prop_assert_eq!(event.to_string(), text);
            let mut table = Table::new("m", 0, vec![Column::number("x", "1", "a number")]).unwrap();
            for x in &numbers {
                let failed = !x.is_some_and(f64::is_finite);
                let failure = failed.then(|| Failure::new("failed", "failed"));
                table.push(failure, [x.map_or(Cell::Null, Cell::Number)]).unwrap();
            }
            for (excess, x) in event.excesses(&table).into_iter().zip(numbers) {
                let x = x.map(|x| if absolute { x.abs() } else { x });
                let expected = x.map(|x| match kind {
                    0 => x >= limit,
                    1 => x <= limit,
                    _ => limit <= x && x <= limit + 10.0,
                });
                prop_assert_eq!(excess.is_nan(), x.is_none());
                prop_assert_eq!(excess >= 0.0, expected == Some(true));
            }
        }
    }

    #[test]
    fn other_lines_are_refused() {
        for text in [
            "",
            "x",
            "x >= ",
            ">= 1",
            "x >= 1 in 99 % at 90 %",
            "x >= inf",
            "x >= 1 2",
            "2 <= x <= 1",
        ] {
            assert!(text.parse::<Event>().is_err(), "{text}");
        }
    }
}
