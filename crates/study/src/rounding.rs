//! Whether numbers differ by more than rounding.

/// A share of the numbers, below which a spread is rounding: of numbers that are found in as many steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rounding(f64);

impl Rounding {
    /// Of what comes of separations, which are integrated.
    pub(crate) const OF_SEPARATIONS: Self = Self(1e-11);
    /// Of what a simulator answers, or a law draws: some units in the last place. Beside an offset, such as a date in seconds, small
    /// differences may be all that matters, and nobody but the simulator knows.
    pub(crate) const OF_LAST_PLACES: Self = Self(16.0 * f64::EPSILON);

    /// Whether numbers from a smallest to a largest one differ by more than rounding changes numbers of their size, or of this scale,
    /// such as one degree of angles.
    pub(crate) fn is_exceeded(self, minimum: f64, maximum: f64, scale: f64) -> bool {
        let size = minimum.abs().max(maximum.abs()).max(scale);
        maximum / size - minimum / size > self.0
    }

    /// Whether a standard deviation is more than rounding of numbers of this size.
    pub(crate) fn is_exceeded_by(self, deviation: f64, size: f64) -> bool {
        deviation > self.0 * size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever the offset: what differs by more than some units in the last place varies, and what differs by one does not.
        #[test]
        fn offsets_hide_nothing_of_a_simulator(offset in -1e12..1e12_f64, spread in -8..8_i32) {
            let spread = 10_f64.powi(spread);
            let end = offset + spread;
            let units = (end - offset).abs() / (offset.abs().max(end.abs()) * f64::EPSILON);
            prop_assume!((units - 16.0).abs() > 2.0);
            prop_assert_eq!(Rounding::OF_LAST_PLACES.is_exceeded(offset, end, 0.0), units > 16.0);
            prop_assert!(!Rounding::OF_LAST_PLACES.is_exceeded(offset, offset.next_up(), 0.0));
        }
    }
}
