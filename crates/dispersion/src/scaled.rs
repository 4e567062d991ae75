//! Roots of sums of squares that are too small for numbers.

/// The root of a sum of squares of numbers of a size, in the unit that is given to who sums them: the same bits at any scale.
pub(crate) fn root_of_squares(size: f64, in_unit: impl Fn(f64) -> f64) -> f64 {
    let unit = power_of_two(size);
    unit * in_unit(unit).sqrt()
}

/// The largest power of two that is at most a positive number: a division by it does not round.
fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & f64::INFINITY.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn roots_do_not_depend_on_the_scale(size in 1.0..2.0_f64, factor in 0.0..9.0_f64, power in -1000..400) {
            let at = |size: f64| root_of_squares(size, |unit| (size / unit).powi(2) * factor);
            let scale = f64::powi(2.0, power);
            prop_assert_eq!(at(size), (size * size * factor).sqrt());
            prop_assert_eq!(at(size * scale), at(size) * scale);
            prop_assert_eq!(power_of_two(size * scale), scale);
        }
    }
}
