//! Deviations from the mean, and sums of their powers that are the same in whatever order they are added.

use crate::ExactSum;

/// The map from a value to its deviation from the mean over the largest deviation: from −1 to 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Centred {
    /// Power of two that keeps differences finite and subnormal values exact.
    scale: f64,
    /// The mean, rounded, and scaled.
    anchor: f64,
    /// What rounding left out of it.
    residue: f64,
    /// Largest deviation, scaled.
    unit: f64,
}

impl Centred {
    /// For `n` finite values that are not all the same.
    pub(crate) fn new(sum: &ExactSum, n: u64, minimum: f64, maximum: f64) -> Self {
        let scale = match maximum.max(-minimum) {
            huge if huge > 2f64.powi(960) => 2f64.powi(-64),
            tiny if tiny < 2f64.powi(-900) => 2f64.powi(128),
            _ => 1.0,
        };
        // A mean near the smallest numbers has few digits, and many times 2¹²⁸.
        let (sum, to_scale) = if scale > 1.0 { (&sum.shifted(), 1.0) } else { (sum, scale) };
        let mean = sum.mean(n);
        let (anchor, residue) = (mean * to_scale, sum.mean_beyond(mean, n) * to_scale);
        let mut centred = Self { scale, anchor, residue, unit: 1.0 };
        centred.unit = centred.map(minimum).abs().max(centred.map(maximum).abs());
        centred
    }

    pub(crate) fn map(&self, x: f64) -> f64 {
        // Two subtractions: the first is exact where the mean dwarfs the spread.
        ((x * self.scale - self.anchor) - self.residue) / self.unit
    }

    /// A length that was measured in deviations.
    pub(crate) fn length(&self, deviations: f64) -> f64 {
        self.unit * deviations / self.scale
    }

    /// The standard deviation of values whose squared deviations have a sum.
    pub(crate) fn standard_deviation(&self, squares: f64, n: u64) -> f64 {
        self.unit * (squares / (n as f64 - 1.0)).sqrt() / self.scale
    }
}

/// Scale of both parts of a [`UnitSum`].
const ONE: f64 = (1_u64 << 60) as f64;

/// The sum of numbers from −1 to 1, each cut off below 2⁻¹²⁰: exact beyond that, and so independent of the
/// order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct UnitSum {
    /// Multiples of 2⁻⁶⁰.
    coarse: i128,
    /// Multiples of 2⁻¹²⁰.
    fine: i128,
}

impl UnitSum {
    #[inline]
    pub(crate) fn add(&mut self, x: f64) {
        self.add_times(x, 1);
    }

    #[inline]
    pub(crate) fn add_times(&mut self, x: f64, times: u64) {
        let scaled = x * ONE;
        let coarse = scaled as i64;
        // Exact: what is below the point of a number that has anything there.
        let fine = ((scaled - coarse as f64) * ONE) as i64;
        self.coarse += i128::from(coarse) * i128::from(times);
        self.fine += i128::from(fine) * i128::from(times);
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        self.coarse += other.coarse;
        self.fine += other.fine;
    }

    /// Takes away numbers that are among those added.
    pub(crate) fn subtract(&mut self, other: &Self) {
        self.coarse -= other.coarse;
        self.fine -= other.fine;
    }

    pub(crate) fn value(&self) -> f64 {
        // Whole multiples of 2⁻⁶⁰ go over to the first part, so that no digit is lost to the second rounding.
        let whole = self.coarse + (self.fine >> 60);
        let rest = self.fine & ((1 << 60) - 1);
        // Of the magnitude, so that −x has the sum of x turned round.
        let (whole, rest) = match (whole < 0, rest) {
            (false, rest) => (whole, rest),
            (true, 0) => (-whole, 0),
            (true, rest) => (-whole - 1, (1 << 60) - rest),
        };
        let magnitude = (whole as f64 + rest as f64 / ONE) / ONE;
        if self.coarse + (self.fine >> 60) < 0 { -magnitude } else { magnitude }
    }
}

/// The sums of the second, third and fourth powers of deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Powers {
    sums: [UnitSum; 3],
}

impl Powers {
    #[inline]
    pub(crate) fn add(&mut self, deviation: f64) {
        let square = deviation * deviation;
        for (sum, power) in self.sums.iter_mut().zip([square, square * deviation, square * square])
        {
            sum.add(power);
        }
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        for (sum, more) in self.sums.iter_mut().zip(&other.sums) {
            sum.merge(more);
        }
    }

    pub(crate) fn values(&self) -> [f64; 3] {
        self.sums.map(|sum| sum.value())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Against the exact sum, from the smallest to the largest powers.
        #[test]
        fn sums_of_powers_are_exact_to_their_last_digit(
            numbers in prop::collection::vec((-1.0..=1.0_f64, 0..40_i32), 1..50),
        ) {
            let mut powers = Powers::default();
            let (mut exact, mut parts) = ([(); 3].map(|()| ExactSum::new()), Powers::default());
            for (x, exponent) in numbers.iter().rev() {
                let u = x * 2f64.powi(-exponent);
                powers.add(u);
                let mut one = Powers::default();
                one.add(u);
                parts.merge(&one);
                for (sum, power) in exact.iter_mut().zip([u * u, u * u * u, u * u * (u * u)]) {
                    sum.add(power);
                }
            }
            prop_assert_eq!(powers, parts);
            for (found, exact) in powers.values().into_iter().zip(exact) {
                let exact = exact.value();
                let allowed = 2.0 * f64::EPSILON * exact.abs() + 50.0 * 2f64.powi(-120);
                prop_assert!((found - exact).abs() <= allowed, "{found:e} {exact:e}");
            }
        }
    }
}
