//! What rounding must not decide: which of two numbers is the larger, or on which side of zero one is, where they are equal but for it.
//! The search goes by such orders, and attitudes that mirror one another have laws that are equally likely.

use nalgebra::Vector4;
use std::f64::consts::{E, LN_2, PI};

/// Numbers of the order of one that differ by less than this, 2⁻³⁰, are equal.
const EQUAL: f64 = 1.0 / (1_u64 << 30) as f64;
/// No vector that comes up is at right angles to this one but by rounding.
const ASKEW: Vector4<f64> = Vector4::new(PI, E, LN_2, 1.0);

/// A number of the order of one, for orders.
pub(super) fn whole(x: f64) -> i64 {
    (x / EQUAL).round() as i64
}

/// −1 of what is below zero by more than rounding, else 1.
pub(super) fn sign(x: f64) -> f64 {
    if x < -EQUAL { -1.0 } else { 1.0 }
}

/// Which of two opposite directions this is.
pub(super) fn end(direction: &Vector4<f64>) -> f64 {
    sign(ASKEW.dot(direction))
}
