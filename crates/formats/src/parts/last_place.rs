//! How far a number may be from what its digits show, where it was rounded to them.

/// Half a unit of the last place of a number as it is written: of `0.72` 0.005, of `16` 0.5, of `1.5e3` 50.
pub(super) fn half_of_last_place(written: &str) -> f64 {
    let written = written.trim();
    let (digits, exponent) = written.split_once(['e', 'E']).unwrap_or((written, "0"));
    let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let exponent: f64 = exponent.parse().unwrap_or(0.0);
    0.5 * libm::pow(10.0, exponent - decimals as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever is rounded to some digits is at most that far from what they show.
        #[test]
        fn rounding_moves_a_number_no_further(
            x in prop_oneof![-1e6..1e6_f64, -1.0..1.0_f64],
            decimals in 0_usize..9,
            exponential: bool,
        ) {
            let written = if exponential { format!("{x:.decimals$e}") } else { format!("{x:.decimals$}") };
            let half = half_of_last_place(&written);
            let shown: f64 = written.parse().unwrap();
            prop_assert!((shown - x).abs() <= half * (1.0 + 1e-6), "{} {} {}", x, written, half);
            let last = if exponential { x.abs().log10().floor() - decimals as f64 } else { -(decimals as f64) };
            prop_assert!(half <= 5.0 * libm::pow(10.0, last) * (1.0 + 1e-12), "{} {}", written, half);
        }
    }
}
