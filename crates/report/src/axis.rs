//! Axes: units in which a range is readable, ticks at round numbers.

use serde::{Deserialize, Serialize};

use crate::text::{decimal, significant, superscript, width};

/// A change of units, `u = (x − base)·10^(−exponent)`, that brings values to a readable size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Units {
    base: f64,
    /// Significant digits that write the base in full.
    digits: usize,
    pub(crate) exponent: i32,
}

impl Units {
    /// Units for values between `lower ≤ upper`: as they are where that reads well.
    pub(crate) fn for_range(lower: f64, upper: f64) -> Self {
        let largest = f64::max(lower.abs(), upper.abs());
        // Halves, as the range may be beyond f64.
        let half = upper / 2.0 - lower / 2.0;
        let (mut base, mut digits) = (0.0, 1);
        if half > 0.0 && half / largest < 1e-5 {
            let order = i64::from(order(largest)) - i64::from(order(half));
            digits = usize::try_from(order).unwrap_or(0).clamp(1, 17);
            let middle = lower + half;
            base = format!("{middle:.*e}", digits - 1).parse().unwrap_or(0.0);
        }
        let largest = f64::max((lower - base).abs(), (upper - base).abs());
        let units = Self { base, digits, ..Self::with_factor(largest) };
        if (-3..6).contains(&order(largest)) { Self { exponent: 0, ..units } } else { units }
    }

    /// Units in which `largest` lies between 1 and 1000.
    pub(crate) fn with_factor(largest: f64) -> Self {
        Self { base: 0.0, digits: 1, exponent: order(largest).div_euclid(3) * 3 }
    }

    /// `x` in these units.
    pub(crate) fn of(self, x: f64) -> f64 {
        let (x, k) = (x - self.base, self.exponent);
        // 10^324, for the smallest of floats, is beyond f64.
        if k < -300 { x * 1e300 * power(-k - 300) } else { shift(x, -k) }
    }

    /// The difference of two values that are `u` apart in these units.
    pub(crate) fn length(self, u: f64) -> f64 {
        shift(u, self.exponent)
    }

    /// The value that is `u` in these units, to a thousandth of `step`, which is in them too.
    pub(crate) fn back(self, u: f64, step: f64) -> f64 {
        let x = self.base + shift(u, self.exponent);
        let decimals = 3 - i64::from(order(step)) - i64::from(self.exponent);
        match usize::try_from(decimals) {
            Ok(decimals) if decimals < 300 => format!("{x:.decimals$}").parse().unwrap_or(x),
            _ => x,
        }
    }

    /// What to write beside an axis labelled in these units.
    pub(crate) fn note(self) -> String {
        let exponent = times(self.exponent);
        if self.base == 0.0 {
            return exponent;
        }
        let sign = if self.base < 0.0 { "−" } else { "+" };
        let base = significant(self.base.abs(), self.digits);
        format!("{exponent} {sign} {base}").trim_start().to_owned()
    }
}

/// The factor `10^exponent` as text, empty for 1.
pub(crate) fn times(exponent: i32) -> String {
    if exponent == 0 { String::new() } else { format!("×10{}", superscript(exponent)) }
}

/// The decimal order of magnitude, `⌊log₁₀|x|⌋`; 0 for 0. By way of text: exact, and the same on
/// every platform.
fn order(x: f64) -> i32 {
    let text = format!("{x:e}");
    text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

/// The power of ten that is nearest: from a table where it is exact, for the values of samples pass here one by one.
fn power(exponent: i32) -> f64 {
    const EXACT: [f64; 23] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
        1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
    ];
    let exact = usize::try_from(exponent).ok().and_then(|exponent| EXACT.get(exponent));
    exact.copied().unwrap_or_else(|| format!("1e{exponent}").parse().unwrap_or(f64::NAN))
}

/// `x·10^k`, correctly rounded for small `k` of either sign.
fn shift(x: f64, k: i32) -> f64 {
    if k < 0 { x / power(-k) } else { x * power(k) }
}

/// A labelled position on an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub(crate) at: f64,
    pub(crate) label: String,
}

/// How densely an axis may be labelled.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spacing {
    /// Length of the axis in pixels.
    pub(crate) length: f64,
    /// The most ticks.
    pub(crate) most: usize,
    /// Font size if labels stand side by side and must not touch.
    pub(crate) side_by_side: Option<f64>,
    /// Whether only whole numbers make sense.
    pub(crate) whole: bool,
}

/// Ticks at multiples of 1, 2 or 5 times a power of ten between `lower` and `upper`: the finest
/// that the spacing allows. For ranges that [`Units`] made.
pub(crate) fn ticks(lower: f64, upper: f64, spacing: Spacing) -> Vec<Tick> {
    let range = upper - lower;
    if !range.is_finite() || !(range > 0.0) {
        return Vec::new();
    }
    let first = order(range / spacing.most.max(1) as f64);
    let first = if spacing.whole { first.max(0) } else { first };
    let steps = (first..first + 4).flat_map(|k| [1, 2, 5].map(|m| (m, k)));
    let mut coarse = Vec::new();
    for (m, k) in steps {
        let found = multiples(lower, upper, m, k);
        if found.len() < 2 && !coarse.is_empty() {
            break;
        }
        let step = shift(f64::from(m), k) / range * spacing.length;
        let widest = |size| found.iter().map(|t| width(&t.label, size)).fold(0.0, f64::max);
        let fits = spacing.side_by_side.is_none_or(|size| widest(size) + 0.9 * size <= step);
        if found.len() <= spacing.most {
            coarse = found;
            if fits {
                break;
            }
        }
    }
    coarse
}

fn multiples(lower: f64, upper: f64, m: i32, k: i32) -> Vec<Tick> {
    let step = shift(f64::from(m), k);
    // A hair of slack, for bounds that are multiples but for rounding.
    let (first, last) = ((lower / step - 1e-9).ceil(), (upper / step + 1e-9).floor());
    if !(last - first < 1000.0) {
        return Vec::new();
    }
    let decimals = usize::try_from(-k).unwrap_or(0);
    (0..=(last - first) as i64)
        .map(|i| shift((first + i as f64) * f64::from(m), k))
        .map(|at| Tick { at, label: decimal(at, decimals) })
        .collect()
}

/// Ticks of a logarithmic axis between two common logarithms: decades, and 2 and 5 between them if there are few.
pub(crate) fn decades([low, high]: [f64; 2]) -> Vec<Tick> {
    let few = high - low < 2.5;
    let mut ticks = Vec::new();
    for decade in low.floor() as i32..=high.ceil() as i32 {
        for m in [1.0_f64, 2.0, 5.0] {
            let at = f64::from(decade) + m.log10();
            if at < low - 1e-9 || at > high + 1e-9 || (m > 1.0 && !few) {
                continue;
            }
            let label = if (-3..5).contains(&decade) {
                significant(m * 10_f64.powi(decade), 1)
            } else if m > 1.0 {
                String::new()
            } else {
                format!("10{}", superscript(decade))
            };
            ticks.push(Tick { at, label });
        }
    }
    ticks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(lower: f64, upper: f64, length: f64, whole: bool) -> Vec<String> {
        let spacing = Spacing { length, most: 6, side_by_side: Some(11.0), whole };
        ticks(lower, upper, spacing).into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn powers_are_the_nearest_floats() {
        for exponent in -330..=310 {
            assert_eq!(
                power(exponent),
                format!("1e{exponent}").parse::<f64>().unwrap(),
                "{exponent}"
            );
        }
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(labels(0.0, 10.0, 400.0, false), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(-0.11, 0.12, 400.0, false), ["−0.10", "−0.05", "0", "0.05", "0.10"]);
        assert_eq!(labels(0.0, 1.06, 400.0, true), ["0", "1"]);
        assert_eq!(
            labels(-150_000.0, -99_000.0, 160.0, false),
            ["−140\u{2009}000", "−120\u{2009}000", "−100\u{2009}000"]
        );
        assert!(labels(1.0, 1.0, 400.0, false).is_empty());
        assert!(labels(f64::NAN, 1.0, 400.0, false).is_empty());
    }

    #[test]
    fn every_range_has_at_least_two_ticks_that_do_not_touch() {
        for i in 0..2000 {
            let lower = f64::from(i * 37 % 1999) * 0.37 - 300.0;
            let upper = lower + 0.01 * 1.01f64.powi(i);
            let spacing =
                Spacing { length: 232.0, most: 6, side_by_side: Some(11.0), whole: false };
            let units = Units::for_range(lower, upper);
            let (lower, upper) = (units.of(lower), units.of(upper));
            let found = ticks(lower, upper, spacing);
            assert!((2..=6).contains(&found.len()), "{lower} {upper} {found:?}");
            for pair in found.windows(2) {
                let apart = (pair[1].at - pair[0].at) / (upper - lower) * 232.0;
                let wide = width(&pair[0].label, 11.0) / 2.0 + width(&pair[1].label, 11.0) / 2.0;
                assert!(wide < apart, "{lower} {upper} {found:?}");
            }
        }
    }

    #[test]
    fn units_bring_any_range_to_a_readable_size() {
        let cases = [
            (0.0, 0.0, ""),
            (-3.0, 200_000.0, ""),
            (0.001, 0.002, ""),
            (0.0, 3e-7, "×10⁻⁹"),
            (-1e300, 2e300, "×10³⁰⁰"),
            (f64::MIN, f64::MAX, "×10³⁰⁶"),
            (0.0, 5e-324, "×10⁻³²⁴"),
            (1234.5678, 1234.56784, "×10⁻⁶ + 1234.5678"),
            (-7.000_001, -7.000_002, "×10⁻⁶ − 7.000001"),
        ];
        for (a, b, note) in cases {
            let (lower, upper) = (f64::min(a, b), f64::max(a, b));
            let units = Units::for_range(lower, upper);
            assert_eq!(units.note(), note);
            for x in [lower, upper] {
                assert!(units.of(x).abs() < 1e6, "{x}");
                // To a thousandth of a step, and of rounding.
                let near = 1e-5 * (upper / 2.0 - lower / 2.0) + 1e-15 * x.abs();
                let back = units.back(units.of(x), units.of(upper) - units.of(lower));
                assert!((back / 2.0 - x / 2.0).abs() <= near.max(1e-300), "{x}: {back}");
            }
        }
    }

    /// Found in a figure: ticks below an axis that starts at 2, and none at its foot.
    #[test]
    fn decades_lie_on_the_axis() {
        let labels = |low: f64, high: f64| -> Vec<String> {
            decades([low.log10(), high.log10()]).into_iter().map(|t| t.label).collect()
        };
        assert_eq!(labels(0.002, 0.1), ["0.002", "0.005", "0.01", "0.02", "0.05", "0.1"]);
        assert_eq!(labels(20.0, 200.0), ["20", "50", "100", "200"]);
        assert_eq!(labels(0.01, 100.0), ["0.01", "0.1", "1", "10", "100"]);
    }
}
