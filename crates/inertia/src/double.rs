//! A sum of two floats, which holds about 32 digits.

use std::ops::{Add, Mul, Sub};

/// `high + low`, where `low` is what rounding left out of `high`. Every operation is right to a few
/// units in 2⁻¹⁰⁴ of its terms (Dekker 1971, doi:10.1007/BF01397083), as long as no product leaves
/// the range from 1e-290 to 1e290.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Double {
    high: f64,
    low: f64,
}

impl Double {
    pub(crate) const ZERO: Self = Self { high: 0.0, low: 0.0 };

    /// The nearest float.
    pub(crate) fn value(self) -> f64 {
        self.high
    }

    /// The difference, exact.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        Self::sum(a, -b)
    }

    /// The quotient by a power of two, exact.
    pub(crate) fn over_power(self, power: f64) -> Self {
        Self { high: self.high / power, low: self.low / power }
    }

    /// The quotient, by one step of Newton's method from that of floats.
    pub(crate) fn over(self, divisor: Self) -> Self {
        let first = self.high / divisor.high;
        let rest = self - divisor * Self::from(first);
        let second = rest.high / divisor.high;
        Self::sum(first, second)
    }

    /// Exact (Knuth).
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let b_used = high - a;
        Self { high, low: (a - (high - b_used)) + (b - b_used) }
    }

    /// Exact: halves of 26 digits have products without rounding (Veltkamp).
    fn product(a: f64, b: f64) -> Self {
        let halves = |x: f64| {
            let shifted = 134_217_729.0 * x;
            let upper = shifted - (shifted - x);
            (upper, x - upper)
        };
        let ((a1, a2), (b1, b2)) = (halves(a), halves(b));
        let high = a * b;
        Self { high, low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2 }
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, low) = (Self::sum(self.high, other.high), Self::sum(self.low, other.low));
        let sum = Self::sum(high.high, high.low + low.high);
        Self::sum(sum.high, sum.low + low.low)
    }
}

impl Sub for Double {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + Self { high: -other.high, low: -other.low }
    }
}

impl Mul for Double {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        Self::sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A number of 60 bits as a sum of two floats, and as an integer.
    fn double(x: i64) -> Double {
        let high = x as f64;
        Double { high, low: (i128::from(x) - high as i128) as f64 }
    }

    /// The distance from an integer of up to 120 bits.
    fn off(x: Double, exact: i128) -> f64 {
        (exact - x.high as i128 - x.low as i128) as f64
    }

    proptest! {
        /// Against 128-bit integers, with terms that cancel to any degree.
        #[test]
        fn operations_keep_a_hundred_bits(
            a in -(1i64 << 60)..1i64 << 60,
            b in -(1i64 << 60)..1i64 << 60,
            shift in 0..60,
        ) {
            let near = a.wrapping_neg().wrapping_add(b >> shift);
            for (a, b) in [(a, b), (a, near), (a, b >> shift)] {
                let (x, y) = (double(a), double(b));
                let (i, j) = (i128::from(a), i128::from(b));
                prop_assert_eq!(off(x + y, i + j), 0.0);
                prop_assert_eq!(off(x - y, i - j), 0.0);
                let product = i * j;
                prop_assert!(off(x * y, product).abs() <= 2f64.powi(-102) * product.abs() as f64);
                prop_assume!(b != 0);
                let back = x.over(y) * y - x;
                prop_assert!(back.value().abs() <= 2f64.powi(-100) * x.value().abs());
            }
        }
    }
}
