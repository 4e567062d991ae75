//! The standard normal law.

use std::f64::consts::FRAC_1_SQRT_2;

/// ln √(2π).
pub(crate) const LN_ROOT_TAU: f64 = 0.918_938_533_204_672_8;

/// The probability Φ(z) that a standard normal variable is at most z.
pub(crate) fn below(z: f64) -> f64 {
    above(-z)
}

/// The probability that a standard normal variable exceeds z, without cancellation far out.
pub(crate) fn above(z: f64) -> f64 {
    0.5 * libm::erfc(z * FRAC_1_SQRT_2)
}
