//! Shares of the runs, and counts of what there is.

use gyradius_statistics::{Confidence, Interval, Proportion, StatisticsError};
use serde::{Deserialize, Serialize};

use gyradius_report::{below_hundred, significant};

/// A share of the runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Share {
    pub(crate) count: u64,
    pub(crate) of: u64,
    pub(crate) share: f64,
    pub(crate) interval: Interval,
}

impl Share {
    pub(crate) fn new(
        count: u64,
        of: u64,
        confidence: Confidence,
    ) -> Result<Self, StatisticsError> {
        let proportion = Proportion::new(count, of)?;
        let interval = proportion.interval(confidence);
        Ok(Self { count, of, share: proportion.value(), interval })
    }

    /// The share in percent with its interval; of none or all the bound on the other side.
    pub(crate) fn percent(&self) -> String {
        let [lower, upper] = [self.interval.lower(), self.interval.upper()].map(|x| 100.0 * x);
        if self.count == 0 {
            return format!("none (under {} %)", significant(upper, 2));
        }
        if self.count == self.of {
            return format!("all (over {} %)", below_hundred(lower));
        }
        // Digits that tell shares near all from all.
        let number = |x: f64| if x > 99.0 { below_hundred(x) } else { significant(x, 3) };
        format!("{} % [{}, {}]", number(100.0 * self.share), number(lower), number(upper))
    }
}

/// What there is, each with how often, in the order in which it comes first.
pub(crate) fn counted<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<(T, u64)> {
    let mut counts: Vec<(T, u64)> = Vec::new();
    for one in all {
        match counts.iter_mut().find(|(other, _)| *other == one) {
            Some((_, count)) => *count += 1,
            None => counts.push((one, 1)),
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in a text, in order.
    fn numbers(text: &str) -> Vec<f64> {
        let parts = text.split(|c: char| !(c.is_ascii_digit() || ".e-".contains(c)));
        parts.filter_map(|part| part.parse().ok()).collect()
    }

    /// Every count of samples of many sizes: none and all are bounds, and no interval is of zeros or of
    /// hundreds, nor without its share.
    #[test]
    fn shares_of_none_and_of_all_are_bounds() {
        let share = |count, of| Share::new(count, of, Confidence::default()).unwrap();
        assert_eq!(share(0, 100_000).percent(), "none (under 0.0037 %)");
        assert_eq!(share(100_000, 100_000).percent(), "all (over 99.9963 %)");
        for of in [1_u64, 2, 3, 10, 100, 3000, 100_000, 10_000_000] {
            let some = [0, 1, 2, of / 3, of / 2, of - of / 50, of.saturating_sub(2), of - 1, of];
            for count in some.into_iter().filter(|count| *count <= of) {
                let text = share(count, of).percent();
                let found = numbers(&text);
                if count == 0 || count == of {
                    let word = if count == 0 { "none (under " } else { "all (over " };
                    assert!(text.starts_with(word) && found.len() == 1, "{text}");
                    assert!(found[0] > 0.0 && found[0] < 100.0, "{count} of {of}: {text}");
                } else {
                    let [value, lower, upper] = found[..] else { panic!("{text}") };
                    assert!(lower > 0.0 && upper < 100.0, "{count} of {of}: {text}");
                    assert!(lower <= value && value <= upper, "{count} of {of}: {text}");
                }
            }
        }
    }
}
