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

/// The score z with Φ(z) = p, infinite for 0 and 1.
pub(crate) fn score(p: f64) -> f64 {
    if p > 0.5 { -score_below(1.0 - p) } else { score_below(p) }
}

/// For p of at most one half: the rational function of Abramowitz & Stegun, 26.2.23, which is off by 4.5e-4 at most, and two steps of
/// Halley's method.
fn score_below(p: f64) -> f64 {
    if p == 0.0 || p == 0.5 {
        return if p == 0.0 { f64::NEG_INFINITY } else { 0.0 };
    }
    let ln_p = libm::log(p);
    let t = (-2.0 * ln_p).sqrt();
    let z = (2.515517 + t * (0.802853 + t * 0.010328))
        / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)))
        - t;
    (0..2).fold(z, |z, _| {
        // (Φ(z) − p)/φ(z), without leaving the range of floats.
        let off = (below(z) / p - 1.0) * libm::exp(ln_p + 0.5 * z * z + LN_ROOT_TAU);
        z - off / (1.0 + 0.5 * z * off)
    })
}
