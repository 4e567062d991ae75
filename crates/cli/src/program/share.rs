//! A share of the runs, as a fraction or in percent.

use gyradius_campaign::of_percent;

/// The number that is nearest to what is written, as 0.05 or 5%.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    let value = match text.strip_suffix('%') {
        Some(percent) => percent.trim_end().parse().map(of_percent),
        None => text.parse(),
    };
    match value {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err("it must lie between 0 and 1, or between 0% and 100%".to_owned()),
    }
}

/// Whether the count is more than this share of all. Both sides are the numbers nearest to what they stand for, so that 29 of 100 are not more than 29 %.
pub(crate) fn exceeds(count: u64, all: u64, share: f64) -> bool {
    count as f64 / all.max(1) as f64 > share
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A share that is written in full is the count itself, and one more is more.
    #[test]
    fn a_count_is_not_more_than_its_own_share() {
        for (all, digits) in [(10_u64, 1), (100, 2), (200, 3), (400, 4), (1000, 3), (8000, 6)] {
            for count in 0..=all {
                let millionths = count * 1_000_000 / all;
                let fraction = format!("{}.{:06}", millionths / 1_000_000, millionths % 1_000_000);
                let percent = format!("{}.{:04}%", millionths / 10_000, millionths % 10_000);
                let exact = &fraction[..fraction.len() - (6 - digits)];
                for text in [exact, &fraction, &percent] {
                    let share = share(text).unwrap();
                    assert!(!exceeds(count, all, share), "{count} of {all}, {text}");
                    assert!(exceeds(count + 1, all, share), "{count} of {all}, {text}");
                }
            }
        }
    }

    #[test]
    fn other_forms_are_read() {
        assert_eq!(share("1e1%"), Ok(0.1));
        assert_eq!(share("5 %"), Ok(0.05));
        for bad in ["", "%", "inf", "nan%", "-1%", "101%", "1e3%"] {
            assert!(share(bad).is_err(), "{bad}");
        }
    }
}
