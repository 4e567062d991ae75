//! Numbers for people.

use gyradius_statistics::{Estimate, Interval};

/// To a number of significant digits, one at least, plain where that is short, scientific where it is not.
pub fn significant(x: f64, digits: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        // Without a sign of zero.
        return format!("{}", x + 0.0);
    }
    let digits = digits.max(1);
    let magnitude = x.abs().log10().floor();
    if !(-4.0..7.0).contains(&magnitude) {
        return format!("{x:.*e}", digits - 1);
    }
    // Within the range above the difference is small and fits.
    let decimals = (digits as f64 - 1.0 - magnitude).max(0.0) as usize;
    format!("{x:.decimals$}")
}

/// The same, or a dash.
pub fn optional(x: Option<f64>, digits: usize) -> String {
    x.map_or_else(|| "–".to_owned(), |x| significant(x, digits))
}

/// The same beside numbers that are so far apart: with two digits of that at least, so that it is told from them.
pub fn resolved(x: Option<f64>, apart: Option<f64>, digits: usize) -> String {
    optional(x, digits.max(digits_of(x.unwrap_or(0.0), apart.unwrap_or(0.0))))
}

/// How many digits a number must have for two of a difference to be seen; 17 tell all numbers apart.
pub(crate) fn digits_of(x: f64, apart: f64) -> usize {
    let places = [x.abs(), apart].map(|x| x.log10().floor());
    if apart > 0.0 && places.iter().all(|place| place.is_finite()) {
        (places[0] - places[1] + 2.0).clamp(1.0, 17.0) as usize
    } else {
        1
    }
}

/// `[lower, upper]`, with as many digits as tell them apart at least, or nothing.
pub fn interval(interval: Option<Interval>, digits: usize) -> String {
    interval.map_or_else(String::new, |i| {
        let width = Some(i.upper() - i.lower());
        let [lower, upper] = [i.lower(), i.upper()].map(|x| resolved(Some(x), width, digits));
        format!("[{lower}, {upper}]")
    })
}

/// An estimate with its interval, which it lies in as it is told: `0.42 [0.38, 0.47]`.
pub fn estimate(estimate: &Estimate, digits: usize) -> String {
    let own = estimate.interval();
    let value = resolved(Some(estimate.value()), Some(own.upper() - own.lower()), digits);
    format!("{value} {}", interval(Some(own), digits))
}

/// The entries of a direction, to a thousandth: `(0, 0.6, 0.8)`.
pub fn direction(entries: [f64; 3]) -> String {
    // Without a sign of zero.
    let [x, y, z] = entries.map(|x| (1e3 * x).round() / 1e3 + 0.0);
    format!("({x}, {y}, {z})")
}

/// A label with its unit, if it has one.
pub fn with_unit(label: &str, unit: &str) -> String {
    if unit == "1" { label.to_owned() } else { format!("{label} ({unit})") }
}

/// A percentage with two digits of what is missing to a hundred.
pub fn below_hundred(percent: f64) -> String {
    let missing = significant(100.0 - percent, 2);
    let decimals = missing.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    if missing.contains('e') { format!("{percent}") } else { format!("{percent:.decimals$}") }
}

/// The nearest of 1, 2 and 5 times a power of ten that is no larger, by way of text: the same on every platform. 1 of what is not
/// finite.
pub fn round_below(x: f64) -> f64 {
    let text = format!("{x:e}");
    let Some((digits, exponent)) = text.split_once('e') else { return 1.0 };
    let digit = match digits.parse::<f64>() {
        Ok(x) if x >= 5.0 => 5,
        Ok(x) if x >= 2.0 => 2,
        _ => 1,
    };
    let rounded = format!("{digit}e{exponent}").parse().unwrap_or(x);
    if rounded > 0.0 { rounded } else { f64::MIN_POSITIVE }
}

#[cfg(test)]
mod tests {
    use super::{resolved, round_below, significant};
    use proptest::prelude::*;

    #[test]
    fn lengths_are_round() {
        let cases = [(1.0, 1.0), (0.99, 0.5), (4.9, 2.0), (0.03, 0.02), (730.0, 500.0)];
        for (x, expected) in cases.into_iter().chain([(0.0026, 0.002), (7.3e-9, 5e-9), (1.99, 1.0)])
        {
            assert_eq!(round_below(x), expected);
        }
        assert!(round_below(0.0) > 0.0 && round_below(5e-324) > 0.0);
    }

    #[test]
    fn no_digits_are_one() {
        for x in [1e300, -1e300, 5e-324, f64::MAX, 0.012, 3.7, 1e6, 0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(significant(x, 0), significant(x, 1));
        }
    }

    proptest! {
        /// Numbers that differ by what they are apart are told apart, read back to a hundredth of it, and are not longer than asked for
        /// where they are far apart.
        #[test]
        fn digits_follow_what_is_apart(x in -1.0..1.0_f64, order in -290..290_i32, nearer in 0..14_i32, digits in 1..6_usize) {
            let x = x * 10_f64.powi(order);
            prop_assume!(x.abs() > 1e-300);
            let apart = x.abs() * 10_f64.powi(-nearer);
            let [one, other] = [x, x + apart].map(|x| resolved(Some(x), Some(apart), digits));
            prop_assert_ne!(&one, &other);
            let read: f64 = one.parse().unwrap();
            prop_assert!((read - x).abs() <= 0.06 * apart + 1e-15 * x.abs(), "{} {}", one, x);
            prop_assert_eq!(resolved(Some(x), Some(1e6 * x.abs()), digits), significant(x, digits));
            prop_assert_eq!(resolved(Some(x), None, digits), significant(x, digits));
        }
    }

    #[test]
    fn digits_are_significant() {
        let cases = [
            (0.159_310_165, "0.1593"),
            (5_000.400_34, "5000"),
            (-133.167_4, "-133.2"),
            (1.0, "1.000"),
            (99_999.6, "100000"),
            (1.234_56e-9, "1.235e-9"),
            (1.234_56e12, "1.235e12"),
            (0.0, "0"),
            (-0.0, "0"),
        ];
        for (x, expected) in cases {
            assert_eq!(significant(x, 4), expected);
        }
        assert_eq!(significant(f64::NAN, 4), "NaN");
        assert_eq!(significant(f64::MIN_POSITIVE, 3), "2.23e-308");
    }
}
