//! Numbers for people, as they are and never in hundreds of digits, and as people write them.

/// A number in the fewest digits that read back as it: with a power of ten from 1e16 on, and below 1e-9.
#[must_use]
pub fn plain(x: f64) -> String {
    if x == 0.0 || !x.is_finite() || (1e-9..1e16).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// The share that is nearest to so many per cent, by the digits: a division by 100 would round twice, and 12.3 % might not be 123 of 1000.
#[must_use]
pub fn of_percent(percent: f64) -> f64 {
    format!("{percent}e-2").parse().unwrap_or(percent / 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bound, Cell, Column, Event, Judging, Measured, Requirement, Runs, Table};
    use proptest::prelude::*;

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            any::<f64>().prop_filter("finite", |x| x.is_finite()),
            -1e6..1e6_f64,
            prop::sample::select(vec![
                1e300,
                -1e300,
                f64::MAX,
                5e-324,
                0.0,
                1e16,
                1e-9,
                123_456_789.0
            ]),
        ]
    }

    proptest! {
        /// Whatever the numbers, what is said of them is short, and reads back where it is to be read.
        #[test]
        fn numbers_of_any_size_are_short(x in number(), y in number(), z in number(), at_most: bool) {
            for x in [x, y, z] {
                let text = plain(x);
                // A sign, "0.", eight zeros and 17 digits.
                prop_assert!(text.len() <= 28, "{text}");
                prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), x.to_bits());
                let is_common = x == 0.0 || (1e-9..1e16).contains(&x.abs());
                let as_before = format!("{x}");
                prop_assert!(!is_common || text == as_before);
            }
            let bounds = [
                if at_most { Bound::AtMost(x) } else { Bound::AtLeast(x) },
                Bound::Between(x.min(y), x.max(y)),
            ];
            let mut table = Table::new("m", 0, vec![Column::number("x", "1", "a number")]).unwrap();
            for x in [x, y, z] {
                table.push(None, [Cell::Number(x)]).unwrap();
            }
            let runs = Runs::from(table.clone());
            for bound in bounds {
                let name = format!("x {bound}");
                prop_assert!(name.len() <= 80, "{name}");
                let quantity = Measured::column("x");
                let requirement = Requirement::new(&name, quantity, bound, 0.5, 0.6).unwrap();
                let judging = Judging::new([requirement], 3, 1);
                judging.look(&table);
                let said = judging.finish(&runs).unwrap()[0].to_string();
                prop_assert!(said.lines().all(|line| line.len() <= 140), "{said}");
                let event = match bound {
                    Bound::AtMost(limit) => format!("x <= {limit:e}"),
                    Bound::AtLeast(limit) => format!("x >= {limit:e}"),
                    Bound::Between(lower, upper) => format!("{lower:e} <= x <= {upper:e}"),
                };
                let event: Event = event.parse().unwrap();
                let written = event.to_string();
                prop_assert!(written.len() <= 70, "{written}");
                prop_assert_eq!(written.parse::<Event>().unwrap(), event);
            }
        }
    }
}
