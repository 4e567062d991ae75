//! A requirement that is written in a line: `abs(x) <= 1 in 99.73 % at 90 %`.

use std::fmt;

use super::{
    Bound, Measured, Requirement, RequirementError, deciding, possible,
    words::{LEAST_PERCENT, Words},
};
use crate::number::{of_percent, plain};

/// What a sign begins with.
const SIGNS: [char; 4] = ['<', '>', '≤', '≥'];

/// Reads a requirement from a line. Its name is the line as it is written, so that lines which say the same are the same.
pub(super) fn parse(text: &str) -> Result<Requirement, RequirementError> {
    let mut words = Words::new(text);
    let (measured, bound) = bounded(&mut words)?;
    words.expect("in")?;
    let probability = words.required_share(|share| possible(share).is_ok())?;
    words.expect("at")?;
    let confidence = words.required_share(|share| deciding(share).is_ok())?;
    words.end()?;
    let requirement = Requirement::new("", measured, bound, probability, confidence)?;
    Ok(Requirement { name: requirement.to_string(), ..requirement })
}

/// Reads what is bounded, and how.
pub(super) fn bounded(words: &mut Words<'_>) -> Result<(Measured, Bound), RequirementError> {
    let before = words.clone();
    let first = match words.number() {
        // A name may begin as a number does.
        Some(number) if words.begins_with(&SIGNS) => Some((number, words.comparison()?)),
        Some(_) | None => {
            *words = before;
            None
        }
    };
    let measured = Measured::parse(words)?;
    let bound = match first {
        None => {
            let at_most = words.comparison()?;
            let limit = words.number().ok_or_else(|| words.wrong("there must be a number"))?;
            if at_most { Bound::AtMost(limit) } else { Bound::AtLeast(limit) }
        }
        // `1 <= x` alone says that x is at least 1.
        Some((limit, at_least)) if !words.begins_with(&SIGNS) => {
            if at_least {
                Bound::AtLeast(limit)
            } else {
                Bound::AtMost(limit)
            }
        }
        Some((limit, rising)) => {
            if words.comparison()? != rising {
                return Err(words.wrong("both signs must point the same way"));
            }
            let other = words.number().ok_or_else(|| words.wrong("there must be a number"))?;
            if rising { Bound::Between(limit, other) } else { Bound::Between(other, limit) }
        }
    };
    Ok((measured, bound))
}

/// Writes what is bounded, and how.
pub(super) fn write_bounded(
    f: &mut fmt::Formatter<'_>,
    quantity: &Measured,
    bound: Bound,
) -> fmt::Result {
    match bound {
        Bound::AtMost(limit) => write!(f, "{quantity} <= {}", plain(limit)),
        Bound::AtLeast(limit) => write!(f, "{quantity} >= {}", plain(limit)),
        Bound::Between(lower, upper) => {
            write!(f, "{} <= {quantity} <= {}", plain(lower), plain(upper))
        }
    }
}

/// A share in percent, as it stands in a line, or as it is where percent would not be read, or not back to the bit.
pub(super) fn share(share: f64) -> String {
    // By the digits, as it is read.
    let percent = format!("{share}e2").parse::<f64>().unwrap_or_default();
    let reads_back = percent > LEAST_PERCENT && of_percent(percent) == share;
    if reads_back { format!("{} %", plain(percent)) } else { plain(share) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn limit() -> impl Strategy<Value = f64> {
        let any = any::<f64>().prop_filter("finite", |x| x.is_finite());
        prop_oneof![any, -1e6..1e6_f64, prop::sample::select(vec![0.0, 1e16, 5e-324, f64::MAX])]
    }

    fn a_share(from: f64) -> impl Strategy<Value = f64> {
        let near = prop::sample::select(vec![0.5, 0.9, 0.9973, 0.99, 0.999_999, 1.0 - 1e-9]);
        let digits = (1..10_000_u32).prop_map(|x| f64::from(x) / 1e4);
        let any = prop_oneof![near, digits, from..1.0_f64, (1e-9..1.0_f64).prop_map(|x| x * x)];
        any.prop_filter("in range", move |x| (from.max(1e-9)..=1.0 - 1e-9).contains(x))
    }

    proptest! {
        /// A requirement is its line: read again, it is the same to the bit, but for a name of its own.
        #[test]
        fn lines_read_back(
            columns in prop::collection::vec("[a-z_]{1,9}|norm|abs|1e3|.{0,6}", 1..4),
            absolute: bool,
            kind in 0..3_u8,
            (x, y) in (limit(), limit()),
            (probability, confidence) in (a_share(1e-9), a_share(0.5)),
        ) {
            let names: Vec<String> = columns.iter().map(|name| Words::quoted(name)).collect();
            let quantity: Measured = match (absolute, &columns[..]) {
                (true, _) => format!("abs({})", names[0]).parse().unwrap(),
                (false, [one]) => Measured::column(one),
                (false, _) => format!("norm({})", names.join(", ")).parse().unwrap(),
            };
            let bound = match kind {
                0 => Bound::AtMost(x),
                1 => Bound::AtLeast(x),
                _ => Bound::Between(x.min(y), x.max(y)),
            };
            let requirement =
                Requirement::new("", quantity, bound, probability, confidence).unwrap();
            let line = requirement.to_string();
            let again: Requirement = line.parse().unwrap();
            prop_assert_eq!(&again, &Requirement { name: line.clone(), ..requirement }, "{}", line);
            prop_assert_eq!(again.to_string(), line);
        }
    }

    proptest! {
        /// A line says the same with other spaces, other signs, its sides changed, and its shares in another form.
        #[test]
        fn lines_that_say_the_same_are_the_same(
            kind in 0..4_u8,
            limit in -1000..1000_i32,
            shares in (2..99_u32, 50..99_u32),
            spaces in prop::collection::vec(0..3_usize, 12),
            signs: [bool; 2],
        ) {
            let quantity = ["x", "abs(x)", "norm(x,y)", "\"a,b\""][usize::from(kind)];
            let (low, high) = (f64::from(limit) / 8.0, f64::from(limit) / 8.0 + 3.5);
            let plainly = [
                format!("{low} <= {quantity} <= {high}"), format!("{quantity} >= {low}"), format!("{quantity} <= {high}"),
            ];
            let [at_least, at_most] = [if signs[0] { "≥" } else { ">=" }, if signs[1] { "≤" } else { "<=" }];
            let otherwise = [
                format!("{high:e} {at_least} {quantity} {at_least} {low}"),
                format!("{low:e} {at_most} {quantity}"),
                format!("{high} {at_least} {quantity}"),
            ];
            for (plainly, otherwise) in plainly.into_iter().zip(otherwise) {
                let plainly = format!("{plainly} in {} % at {} %", shares.0, shares.1);
                let other = format!("{otherwise} in 0.{:02} at {}%", shares.0, shares.1);
                let mut spaces = spaces.iter();
                let mut widened = String::new();
                for c in other.chars() {
                    widened.push(c);
                    if c == ' ' {
                        widened.push_str(&" ".repeat(*spaces.next().unwrap_or(&0)));
                    }
                }
                let [plainly, other, widened] =
                    [plainly, other, widened].map(|line| line.parse::<Requirement>().unwrap());
                prop_assert_eq!(&plainly, &other);
                prop_assert_eq!(&plainly, &widened);
                prop_assert_eq!(plainly.name(), plainly.to_string());
                prop_assert_eq!(&plainly.to_string().parse::<Requirement>().unwrap(), &plainly);
            }
        }
    }

    proptest! {
        /// A share that is written as a fraction with the sign of per cent is no share: it was a hundredth of what was meant.
        #[test]
        fn a_fraction_in_percent_is_refused(
            percent in prop_oneof![1e-6..3.0_f64, prop::sample::select(vec![0.99, 0.9973, 1.0, 1.01, 0.5])],
            of_confidence: bool,
        ) {
            let text = plain(percent);
            let line = if of_confidence { format!("x <= 1 in 99 % at {text} %") } else { format!("x <= 1 in {text} % at 90 %") };
            let found = line.parse::<Requirement>().map(|made| made.probability());
            if percent > 1.0 && !of_confidence {
                prop_assert!((found.unwrap() - percent / 100.0).abs() < 1e-15);
            } else {
                let refused = found.unwrap_err().to_string();
                // What is offered in its place is allowed there, and nothing that is allowed is kept back.
                for share in [percent, of_percent(percent)] {
                    let share = plain(share);
                    let other = line.replace(&format!(" {text} %"), &format!(" {share}"));
                    let is_offered = refused.contains(&format!(" {share} if "));
                    prop_assert_eq!(is_offered, percent <= 1.0 && other.parse::<Requirement>().is_ok(), "{}", refused);
                }
            }
        }

        /// Shares up to both ends and beyond: what is refused is named, with its value, and all else is a requirement.
        #[test]
        fn shares_out_of_range_are_named(
            probability in share_or_none(&[0.0, 1e-10, 1e-9, 1.0 - 1e-9, 1.0 - 1e-10, 1.0, f64::NAN]),
            confidence in share_or_none(&[0.0, 0.5_f64.next_down(), 0.5, 1.0_f64.next_down(), 1.0, f64::INFINITY, f64::NAN]),
        ) {
            let bound = Bound::AtMost(1.0);
            let made = Requirement::new("it", Measured::column("x"), bound, probability, confidence);
            let told = made.map(|_| ()).map_err(|error| error.to_string());
            if !(0.5..1.0).contains(&confidence) {
                let said = format!("confidence = {confidence}: it must be at least 0.5 and below 1, as 0.9, or as 90 % in a line");
                prop_assert_eq!(told, Err(said));
            } else if !(1e-9..=1.0 - 1e-9).contains(&probability) {
                let told = told.unwrap_err();
                prop_assert!(told.starts_with("probability = ") && told.contains(": it must lie between 1e-9 and 1 - 1e-9"), "{}", told);
            } else {
                prop_assert_eq!(told, Ok(()));
            }
        }
    }

    /// A share, one of these numbers, or any number.
    fn share_or_none(some: &[f64]) -> impl Strategy<Value = f64> {
        prop_oneof![0.0..1.0_f64, prop::sample::select(some.to_vec()), -10.0..10.0_f64]
    }

    #[test]
    fn lines_without_spaces_are_those_with_them() {
        let narrow: Requirement = "x<=1 in 99% at 90%".parse().unwrap();
        assert_eq!(narrow, "x <= 1 in 99 % at 90 %".parse().unwrap());
        assert_eq!(narrow.name(), "x <= 1 in 99 % at 90 %");
    }

    #[test]
    fn shares_are_in_percent() {
        let line = "abs(x) <= 1 in 99.73 % at 90 %";
        assert_eq!(line.parse::<Requirement>().unwrap().to_string(), line);
        assert_eq!([0.29, 0.57, 0.999_999, 0.5].map(share), ["29 %", "57 %", "99.9999 %", "50 %"]);
    }
}
