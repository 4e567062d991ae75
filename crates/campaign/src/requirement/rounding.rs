//! Numbers and shares as text, rounded so that what is said of them stays true.

use super::Bound;
use crate::number::plain;

/// Decimals of a percentage, at most.
const MOST_DECIMALS: usize = 12;
/// Digits that tell any number from any other.
const ALL_DIGITS: usize = 17;

/// A share in percent, rounded to two digits of what it lacks to 0 or 100 %.
#[must_use]
pub fn share_in_percent(share: f64) -> String {
    text(&nearest(share, decimals(share).saturating_sub(1)))
}

/// A share that was stated, in percent: in all of its digits, but for the last few that arithmetic changes.
#[must_use]
pub fn stated_in_percent(share: f64) -> String {
    let stated = format!("{share:.11e}").parse().unwrap_or(share);
    let percent = format!("{stated}e2").parse().unwrap_or(100.0 * stated);
    format!("{percent} %")
}

/// A share in percent that is not above the share itself.
#[must_use]
pub fn percent_or_less(share: f64) -> String {
    let decimals = decimals(share);
    let percent = nearest(share, decimals);
    if of_percent(&percent) <= share {
        return text(&percent);
    }
    text(&format!("{:.decimals$}", (100.0 * share - unit(decimals)).max(0.0)))
}

/// A share in percent that is not below the share itself.
#[must_use]
pub fn percent_or_more(share: f64) -> String {
    let decimals = decimals(share);
    let percent = nearest(share, decimals);
    if of_percent(&percent) >= share {
        return text(&percent);
    }
    text(&format!("{:.decimals$}", (100.0 * share + unit(decimals)).min(100.0)))
}

/// A share in percent, with so many digits that it lies on the same side of the required one as the share itself.
#[must_use]
pub fn percent_beside(share: f64, required: f64) -> String {
    let is_beside = |percent: &String| {
        of_percent(percent).partial_cmp(&required) == share.partial_cmp(&required)
    };
    let all = (decimals(share)..=MOST_DECIMALS).map(|decimals| nearest(share, decimals));
    let percent = all.into_iter().find(is_beside);
    percent.map_or_else(|| stated_in_percent(share), |percent| text(&percent))
}

/// A number with one decimal, or one digit if that tells it from 0 only, or five if it is large.
#[must_use]
pub fn one_decimal(x: f64) -> String {
    match x.abs() {
        small if small < 0.05 => plain(rounded(x, 1)),
        large if large >= 1e6 => plain(rounded(x, 5)),
        _ => format!("{x:.1}"),
    }
}

impl Bound {
    /// With how many digits, at least so many, a number lies on the same sides of the limits as the number itself.
    #[must_use]
    pub fn digits_beside(self, x: f64, least: usize) -> usize {
        let is_beside = |digits: &usize| {
            let rounded = rounded(x, *digits);
            self.limits().all(|limit| rounded.partial_cmp(&limit) == x.partial_cmp(&limit))
        };
        (least..ALL_DIGITS).find(is_beside).unwrap_or(ALL_DIGITS)
    }

    /// A number in five digits, or in so many more that it lies on the same sides of the limits as the number itself.
    pub(super) fn rounded(self, x: f64) -> f64 {
        rounded(x, self.digits_beside(x, 5))
    }

    /// Its limits in at least so many digits, and in so many more that each lies on the same sides of the limits of
    /// another as the limit itself: rounded outwards, so that what keeps the bound keeps the rounded one.
    #[must_use]
    pub fn outwards(self, other: Self, least: usize) -> Self {
        let rounded = |x: f64, up: bool| {
            let lies_beside = |rounded: &f64| {
                other.limits().all(|limit| rounded.partial_cmp(&limit) == x.partial_cmp(&limit))
            };
            (other.digits_beside(x, least)..ALL_DIGITS)
                .map(|digits| rounded_to(x, digits, up))
                .find(lies_beside)
                .unwrap_or(x)
        };
        match self {
            Self::AtMost(limit) => Self::AtMost(rounded(limit, true)),
            Self::AtLeast(limit) => Self::AtLeast(rounded(limit, false)),
            Self::Between(lower, upper) => {
                Self::Between(rounded(lower, false), rounded(upper, true))
            }
        }
    }

    /// Its limits.
    pub fn limits(self) -> impl Iterator<Item = f64> {
        let (one, other) = match self {
            Self::AtMost(limit) | Self::AtLeast(limit) => (limit, None),
            Self::Between(lower, upper) => (lower, Some(upper)),
        };
        std::iter::once(one).chain(other)
    }
}

/// A number to so many digits, or itself if there is none of so many beside it, as beside the largest of all.
pub(super) fn rounded(x: f64, digits: usize) -> f64 {
    let nearest = format!("{x:.*e}", digits.saturating_sub(1)).parse().unwrap_or(x);
    if nearest.is_finite() { nearest } else { x }
}

/// A number to so many digits, that is not above the number itself.
#[must_use]
pub fn rounded_down(x: f64, digits: usize) -> f64 {
    rounded_to(x, digits, false)
}

/// A number to so many digits, that is not below it if it is to be rounded up, else not above.
fn rounded_to(x: f64, digits: usize, up: bool) -> f64 {
    let nearest = format!("{x:.*e}", digits.saturating_sub(1));
    let value: f64 = nearest.parse().unwrap_or(x);
    if !value.is_finite() {
        return x;
    }
    if x == value || (x < value) == up {
        return value;
    }
    // The next number of so many digits.
    let Some((digits, exponent)) = nearest.split_once('e') else { return x };
    let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i64);
    let (whole, exponent) = (digits.replace('.', "").parse::<i64>(), exponent.parse::<i64>());
    let (Ok(whole), Ok(exponent)) = (whole, exponent) else { return x };
    let next = whole + if up { 1 } else { -1 };
    let next = format!("{next}e{}", exponent - decimals).parse().unwrap_or(x);
    if next.is_finite() { next } else { x }
}

/// How many decimals a percentage has: three digits of what it lacks to 0 or 100 %.
fn decimals(share: f64) -> usize {
    let nearer = (1.0 - share).min(share);
    let is_told = |decimals: &usize| 100.0 * nearer >= 100.0 * unit(*decimals) || nearer == 0.0;
    (0..MOST_DECIMALS).find(is_told).unwrap_or(MOST_DECIMALS)
}

/// The unit of the last of so many decimals.
fn unit(decimals: usize) -> f64 {
    (0..decimals).fold(1.0, |unit, _| unit / 10.0)
}

fn nearest(share: f64, decimals: usize) -> String {
    format!("{:.decimals$}", 100.0 * share)
}

/// The share that a percentage says.
fn of_percent(percent: &str) -> f64 {
    format!("{percent}e-2").parse().unwrap_or(f64::NAN)
}

fn text(percent: &str) -> String {
    let has_point = percent.contains('.');
    let short =
        if has_point { percent.trim_end_matches('0').trim_end_matches('.') } else { percent };
    format!("{short} %")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn share() -> impl Strategy<Value = f64> {
        let near =
            (0.0..1.0_f64, 0..11_i32).prop_map(|(x, power): (f64, i32)| x * 10_f64.powi(-power));
        prop_oneof![
            4 => near.clone(),
            4 => near.prop_map(|x| 1.0 - x),
            1 => prop::sample::select(vec![0.0, 1.0, 0.5, 0.995, 0.9973, 0.8005]),
            1 => (0..=1000_u32).prop_map(|x| f64::from(x) / 1000.0),
        ]
    }

    fn read(percent: &str) -> f64 {
        of_percent(percent.strip_suffix(" %").unwrap())
    }

    proptest! {
        /// What is said of a share is true, and near.
        #[test]
        fn shares_are_true(share in share()) {
            let [less, more] = [percent_or_less(share), percent_or_more(share)].map(|text| read(&text));
            prop_assert!(less <= share && share <= more, "{less} {share} {more}");
            // By a hundredth of what it lacks to 0 or 1 at most.
            let most = 0.010_01 * share.min(1.0 - share) + 2e-14;
            prop_assert!(more - less <= most, "{less} {share} {more}");
        }

        /// A rounded share lies where the share itself does.
        #[test]
        fn shares_lie_beside(share in share(), required in share(), near in any::<bool>(), by in -1e-9..1e-9_f64) {
            let share = if near { (required + by).clamp(0.0, 1.0) } else { share };
            let told = read(&percent_beside(share, required));
            prop_assert!((told - share).abs() <= 0.010_01 * share.min(1.0 - share) + 2e-14);
            if (share - required).abs() > 1e-13 || share == required {
                prop_assert_eq!(told.partial_cmp(&required), share.partial_cmp(&required), "{} {}", told, share);
            }
        }

        /// A share that was stated is told in its digits.
        #[test]
        fn stated_shares_read_back(digits in 0..=1_000_000_000_u64) {
            let share = digits as f64 / 1e9;
            prop_assert_eq!(read(&stated_in_percent(share)), share);
            let left: f64 = read(&stated_in_percent(1.0 - share));
            prop_assert!((left - (1.0 - share)).abs() < 1e-15);
        }

        /// A rounded number lies on the same side of each limit as the number itself.
        #[test]
        fn numbers_lie_beside(
            limit in prop_oneof![-1e3..1e3_f64, Just(10.0), Just(0.0)],
            width in 0.0..10.0_f64,
            off in prop_oneof![-1.0..1.0_f64, -1e-6..1e-6_f64, -1e-12..1e-12_f64, Just(0.0)],
            kind in 0..3,
        ) {
            let bound = match kind {
                0 => Bound::AtMost(limit),
                1 => Bound::AtLeast(limit),
                _ => Bound::Between(limit, limit + width),
            };
            for x in [limit + off, limit + width + off] {
                let told = bound.rounded(x);
                prop_assert!((told - x).abs() <= 5.1e-5 * x.abs());
                let [up, down] = [Bound::AtMost(x), Bound::AtLeast(x)].map(|own| own.outwards(bound, 5));
                let [up, down] = [up, down].map(|own| own.limits().next().unwrap());
                prop_assert!(down <= x && x <= up && up - down <= 1.01e-4 * x.abs(), "{} {} {}", down, x, up);
                for limit in bound.limits() {
                    for told in [told, up, down] {
                        prop_assert_eq!(told.partial_cmp(&limit), x.partial_cmp(&limit), "{} {}", told, x);
                    }
                }
            }
        }
    }

    proptest! {
        /// A number rounded down is not above the number itself, and near.
        #[test]
        fn numbers_are_rounded_down(x in prop_oneof![-1e3..1e3_f64, -1e-300..1e-300_f64, -f64::MAX..f64::MAX], digits in 1..=17_usize) {
            prop_assert!(rounded(x, digits).is_finite());
            let down = rounded_down(x, digits);
            let unit = 1.01 * 10_f64.powi(1 - digits as i32) * x.abs();
            prop_assert!(down <= x && x - down <= unit.max(5e-324), "{} {}", down, x);
            prop_assert_eq!(rounded_down(down, digits), down);
        }
    }

    #[test]
    fn bounds_are_rounded_outwards() {
        let limits = Bound::AtMost(60.0);
        for (bound, told) in [
            (Bound::AtMost(59.92022), Bound::AtMost(59.921)),
            (Bound::AtMost(59.92), Bound::AtMost(59.92)),
            (Bound::AtMost(59.99999), Bound::AtMost(59.99999)),
            (Bound::AtMost(-59.92022), Bound::AtMost(-59.92)),
            (Bound::AtMost(99.9999), Bound::AtMost(100.0)),
            (Bound::AtMost(0.0), Bound::AtMost(0.0)),
            (Bound::AtMost(f64::MAX), Bound::AtMost(f64::MAX)),
            (Bound::AtMost(60.000_000_1), Bound::AtMost(60.000_000_1)),
            (Bound::AtMost(1e-300 / 3.0), Bound::AtMost(3.3334e-301)),
            (Bound::AtLeast(640.817_000_4), Bound::AtLeast(640.81)),
            (Bound::Between(-1.000_049, 1.000_049), Bound::Between(-1.0001, 1.0001)),
        ] {
            assert_eq!(bound.outwards(limits, 5), told);
        }
    }

    #[test]
    fn shares_and_numbers_are_short() {
        assert_eq!(
            [0.0, 0.8012, 0.99726, 1.0].map(share_in_percent),
            ["0 %", "80 %", "99.73 %", "100 %"]
        );
        assert_eq!(percent_or_more(0.8012), "80.2 %");
        assert_eq!(percent_or_less(0.8012), "80.1 %");
        assert_eq!(percent_or_more(0.9953), "99.53 %");
        assert_eq!(stated_in_percent(0.855), "85.5 %");
        assert_eq!(stated_in_percent(1.0 - 0.9973), "0.27 %");
        assert_eq!(percent_beside(0.99726, 0.9973), "99.726 %");
        assert_eq!(percent_beside(0.997_26, 0.9), "99.726 %");
        assert_eq!([0.0, -0.0312, 0.05, -12.34].map(one_decimal), ["0", "-0.03", "0.1", "-12.3"]);
        assert_eq!(Bound::AtMost(10.0).rounded(10.000_000_1), 10.000_000_1);
        assert_eq!(Bound::AtMost(10.0).rounded(11.308_409), 11.308);
    }
}
