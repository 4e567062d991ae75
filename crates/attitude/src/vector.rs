//! What loops over arrays are made of that the compiler turns into vector instructions.
//!
//! `pulp` compiles a kernel (`pulp::WithSimd`) once for the baseline and once for each of the vector units
//! that a machine may have, and picks at run time. What a kernel calls must be inlined. The loops use sums, products, quotients, square roots and bits
//! only, each correctly rounded and never fused, so that every machine gets the same values.

use std::f64::consts::{FRAC_PI_2, LN_2, LOG2_E};

/// [1, 2) from the upper 52 bits.
#[inline(always)]
fn one_to_two(bits: u64) -> f64 {
    f64::from_bits((1023 << 52) | (bits >> 12))
}

/// [0, 1) from the upper 52 bits.
#[inline(always)]
pub(crate) fn unit(bits: u64) -> f64 {
    one_to_two(bits) - 1.0
}

/// A point of the circle of a radius, uniform on it: an eighth of a turn either way from the upper
/// 52 bits, the quarter from the two lowest.
#[inline(always)]
pub(crate) fn on_circle(bits: u64, radius: f64) -> (f64, f64) {
    // Quarters of a turn, |t| ≤ ½: sine and cosine by the minimax polynomials of fdlibm (Sun
    // Microsystems 1993), scaled by powers of π/2, summed in an order that leaves short chains.
    let t = one_to_two(bits) - 1.5;
    let z = t * t;
    let zz = z * z;
    let s01 = FRAC_PI_2 - z * 0.645_964_097_506_245;
    let s23 = 0.079_692_626_246_063_34 - z * 0.004_681_754_132_625_933_4;
    let s456 = 0.000_160_441_152_667_380_95
        + (z * -3.598_649_570_240_692e-6 + zz * 5.634_704_113_884_751e-8);
    let sin = t * (s01 + zz * (s23 + zz * s456));
    let c01 = 1.0 - z * 1.233_700_550_136_169_7;
    let c23 = 0.253_669_507_901_047_64 - z * 0.020_863_480_763_330_76;
    let c45 = 0.000_919_260_274_390_553_3 - z * 2.520_203_791_691_774e-5;
    let c67 = 4.710_641_505_803_502e-7 - z * 6.324_746_678_866_07e-9;
    let cos = c01 + zz * ((c23 + zz * c45) + (zz * zz) * c67);
    let radius = f64::from_bits(radius.to_bits() ^ ((bits & 2) << 62));
    let (y, x) = (radius * sin, radius * cos);
    if bits & 1 == 0 { (x, y) } else { (y, x) }
}

/// −2 ln of a number uniform on (0, 1].
#[inline(always)]
fn minus_two_ln(bits: u64) -> f64 {
    // 2⁵² and the bias of the exponent.
    const SHIFT: f64 = 4_503_599_627_370_496.0 + 1023.0;
    const SQRT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    let u = (2.0 - one_to_two(bits)).to_bits();
    // u = 2^k m with m in [√½, √2).
    let biased = (u + ((1023 << 52) - SQRT_HALF)) >> 52;
    let k = f64::from_bits((1075 << 52) | biased) - SHIFT;
    let m = f64::from_bits(u + (1023 << 52) - (biased << 52));
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    // ln((1 + s)/(1 − s)) = 2s + s·R, R the minimax polynomial of fdlibm.
    let zz = z * z;
    let odd = zz
        * (3.999_999_999_940_942e-1
            + zz * (2.222_219_843_214_978_4e-1 + zz * 1.531_383_769_920_937_3e-1));
    let l01 = 6.666_666_666_666_735e-1 + zz * 2.857_142_874_366_239e-1;
    let l23 = 1.818_357_216_161_805e-1 + zz * 1.479_819_860_511_658_6e-1;
    let r = z * (l01 + zz * zz * l23) + odd;
    let half = 0.5 * f * f;
    -2.0 * (k * LN_2 + (f - (half - s * (half + r))))
}

/// Standard normals, one for each number of random bits (Box & Muller 1958,
/// doi:10.1214/aoms/1177706645): the first halves of all pairs, then the second.
#[inline(always)]
pub(crate) fn normals(bits: &[u64], out: &mut [f64]) {
    let pairs = bits.len() / 2;
    let (lengths, angles) = bits.split_at(pairs);
    let (first, second) = out.split_at_mut(pairs);
    // Two short loops: several passes of each are under way at a time.
    for (x, bits) in first.iter_mut().zip(lengths) {
        *x = minus_two_ln(*bits);
    }
    for ((x, y), bits) in first.iter_mut().zip(second).zip(angles) {
        (*x, *y) = on_circle(*bits, x.sqrt());
    }
}

/// The nearest integer to a number from 0 to 2³¹, in the lowest bits.
#[inline(always)]
pub(crate) fn rounded(x: f64) -> u64 {
    (x + 4_503_599_627_370_496.0).to_bits()
}

/// e^x for x from −700 to 0.
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    // Numbers so far above 2⁵² are whole, with their lowest bits those of k.
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    // ln 2 in two parts, so that products of the first with k are exact; and R, as x = k ln 2 + r
    // and e^r = 1 + 2r/(R(r) − r), by the minimax polynomial of fdlibm (Sun Microsystems 1993).
    const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
    const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let shifted = x * LOG2_E + SHIFT;
    let k = shifted - SHIFT;
    let (high, low) = (x - k * LN_2_HIGH, k * LN_2_LOW);
    let r = high - low;
    let z = r * r;
    let r45 = -1.653_390_220_546_525e-6 + z * 4.138_136_797_057_238_5e-8;
    let r345 = 6.613_756_321_437_934e-5 + z * r45;
    let r2345 = -2.777_777_777_701_559_3e-3 + z * r345;
    let c = r - z * (1.666_666_666_666_660_2e-1 + z * r2345);
    let y = 1.0 + (r * c / (2.0 - c) - low + high);
    y * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn powers_are_right(x in prop_oneof![-700.0..=0.0_f64, -2.0..=0.0_f64, (-60.0..0.0_f64).prop_map(|p| -p.exp2())]) {
            let exact = libm::exp(x);
            prop_assert!((exp(x) - exact).abs() <= 2.3e-16 * exact, "{x}");
        }

        #[test]
        fn points_are_at_their_radius_and_angle(bits: u64, radius in 0.1..9.0f64) {
            let (x, y) = on_circle(bits, radius);
            let angle = (unit(bits) - 0.5) * FRAC_PI_2;
            let (s, c) = if bits & 1 == 0 { angle.sin_cos() } else { (angle.cos(), angle.sin()) };
            let sign = if bits & 2 == 0 { radius } else { -radius };
            let error = (y - sign * s).abs().max((x - sign * c).abs());
            prop_assert!(error < 4e-16 * radius, "{}", error / radius);
        }

        #[test]
        fn logarithms_are_right(bits: u64, zeros in 0..52_u32) {
            for bits in [bits, bits | (u64::MAX << (64 - zeros.max(1)))] {
                let u = 2.0 - one_to_two(bits);
                let exact = -2.0 * u.ln();
                prop_assert!((minus_two_ln(bits) - exact).abs() <= 4e-16 * exact, "{u}");
            }
        }
    }

    #[test]
    fn the_ends_are_finite() {
        assert_eq!(minus_two_ln(0), 0.0);
        assert!((minus_two_ln(u64::MAX) - 104.0 * LN_2).abs() < 1e-13);
    }
}
