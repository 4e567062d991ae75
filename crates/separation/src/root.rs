//! Roots to a few digits.

use std::f64::consts::LN_2;

/// About x^(−1/n), to 1 %: a step need not be exact.
#[inline(always)]
pub(crate) fn inverse_root(x: f64, n: f64) -> f64 {
    const LEAST: f64 = 1e-290;
    // Added, it leaves the nearest integer in the lowest bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let x = if x < LEAST { LEAST } else { x };
    // The logarithm to base 2 is the exponent and, to ±0.043, the mantissa.
    let log = x.to_bits() as f64 / 4_503_599_627_370_496.0 - 1022.957;
    let y = -log / n;
    let whole = (y + ROUND) - ROUND;
    let f = y - whole;
    let power = f64::from_bits(((1023.0 + whole) as u64) << 52);
    // Infinity and NaN come out as NaN.
    power * (1.0 + f * (LN_2 + f * (0.2402 + f * 0.0555))) + x * 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn roots_are_about_right(e in -290.0..308.0f64, n in 4..20_u32) {
            let (x, n) = (libm::pow(10.0, e), f64::from(n));
            let exact = libm::pow(x, -1.0 / n);
            prop_assert!((inverse_root(x, n) / exact - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn roots_of_nothing_and_of_no_number() {
        assert!(inverse_root(0.0, 13.0) > 1e20);
        assert!(inverse_root(f64::NAN, 13.0).is_nan());
        assert!(!(inverse_root(f64::INFINITY, 13.0) > 0.0));
    }
}
