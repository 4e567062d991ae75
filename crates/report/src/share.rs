//! Shares of the runs, for people.

use gyradius_campaign::{Share, percent_or_less, percent_or_more};

use crate::numbers::{below_hundred, significant};

/// The share in percent with its interval; of none or all the bound on the other side.
#[must_use]
pub fn percent(share: &Share) -> String {
    let interval = &share.interval;
    if share.count == 0 {
        return format!("none (under {})", percent_or_more(interval.upper()));
    }
    if share.count == share.of {
        return format!("all (over {})", percent_or_less(interval.lower()));
    }
    let [lower, upper] = [interval.lower(), interval.upper()].map(|x| 100.0 * x);
    // Digits that tell shares near all from all.
    let number = |x: f64| if x > 99.0 { below_hundred(x) } else { significant(x, 3) };
    format!("{} % [{}, {}]", number(100.0 * share.share), number(lower), number(upper))
}

/// Of how many runs a number is, where not all of the runs that did not fail have one: `of 8 of 5000 runs`.
#[must_use]
pub fn of_some(n: u64, runs: u64) -> Option<String> {
    (n < runs).then(|| format!("of {n} of {runs} runs"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_statistics::Confidence;

    /// Numbers in a text, in order.
    fn numbers(text: &str) -> Vec<f64> {
        let parts = text.split(|c: char| !(c.is_ascii_digit() || ".e-".contains(c)));
        parts.filter_map(|part| part.parse().ok()).collect()
    }

    /// Every count of samples of many sizes: none and all are bounds, and no interval is of zeros or of
    /// hundreds, nor without its share.
    #[test]
    fn shares_of_none_and_of_all_are_bounds() {
        let share = |count, of| percent(&Share::new(count, of, Confidence::default()).unwrap());
        assert_eq!(share(0, 100_000), "none (under 0.00369 %)");
        assert_eq!(share(100_000, 100_000), "all (over 99.99631 %)");
        for of in [1_u64, 2, 3, 10, 100, 3000, 100_000, 10_000_000] {
            let some = [0, 1, 2, of / 3, of / 2, of - of / 50, of.saturating_sub(2), of - 1, of];
            for count in some.into_iter().filter(|count| *count <= of) {
                let text = share(count, of);
                let found = numbers(&text);
                if count == 0 || count == of {
                    let word = if count == 0 { "none (under " } else { "all (over " };
                    assert!(text.starts_with(word) && found.len() == 1, "{text}");
                    assert!(found[0] > 0.0 && found[0] < 100.0, "{count} of {of}: {text}");
                    let interval = Share::new(count, of, Confidence::default()).unwrap().interval;
                    let told = found[0] / 100.0;
                    let is_true = if count == 0 {
                        told >= interval.upper()
                    } else {
                        told <= interval.lower()
                    };
                    assert!(is_true, "{count} of {of}: {text}");
                } else {
                    let [value, lower, upper] = found[..] else { panic!("{text}") };
                    assert!(lower > 0.0 && upper < 100.0, "{count} of {of}: {text}");
                    assert!(lower <= value && value <= upper, "{count} of {of}: {text}");
                }
            }
        }
    }
}
