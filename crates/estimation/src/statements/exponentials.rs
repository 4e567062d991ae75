//! Exponentials of many numbers at a time, with the bits of `libm::exp`.

use pulp::{Simd, WithSimd};

/// The upper halves of |x| without its sign from which k is not 0, and from which eˣ may leave the normal numbers: 708.
const ROUNDED_FROM: u32 = 0x3fd6_2e43;
const WIDE_FROM: u32 = 0x4086_2000;
/// The largest upper half of |x| for which eˣ is 1 + x.
const TINY_TO: u32 = 0x3e30_0000;

/// The exponential of each number.
pub(super) fn exponentials(x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; x.len()];
    pulp::Arch::new().dispatch(Exponentials { x, out: &mut out });
    for (x, out) in x.iter().zip(&mut out) {
        if upper_half(*x) >= WIDE_FROM {
            *out = libm::exp(*x);
        }
    }
    out
}

/// Exponentials of the numbers up to 708, either sign, and anything for others, by the machine's vector units.
struct Exponentials<'a> {
    x: &'a [f64],
    out: &'a mut [f64],
}

impl WithSimd for Exponentials<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (x, out) in self.x.iter().zip(self.out) {
            *out = exponential(*x);
        }
    }
}

/// The steps of `libm::exp`, which are those of fdlibm (Sun Microsystems 1993), without its branches: x = k ln 2 + r,
/// e^r by a minimax polynomial, times 2^k.
#[inline(always)]
fn exponential(x: f64) -> f64 {
    const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
    let upper = upper_half(x);
    let nearest = (std::f64::consts::LOG2_E * x + 0.5_f64.copysign(x)) as i32;
    let k = if upper >= ROUNDED_FROM { nearest } else { 0 };
    let (high, low) = (x - f64::from(k) * LN_2[0], f64::from(k) * LN_2[1]);
    let r = high - low;
    let square = r * r;
    let c = r - square
        * (1.666_666_666_666_660_2e-1
            + square
                * (-2.777_777_777_701_559_3e-3
                    + square
                        * (6.613_756_321_437_934e-5
                            + square
                                * (-1.653_390_220_546_525_2e-6
                                    + square * 4.138_136_797_057_238_5e-8))));
    let of_r = 1.0 + (r * c / (2.0 - c) - low + high);
    let power = f64::from_bits((i64::from(k).wrapping_add(1023) as u64) << 52);
    if upper > TINY_TO { of_r * power } else { 1.0 + x }
}

/// Exponent and first bits of the significand, by which fdlibm tells the ranges of a number.
#[inline(always)]
fn upper_half(x: f64) -> u32 {
    (x.abs().to_bits() >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn same(x: &[f64]) -> Result<(), TestCaseError> {
        let expected: Vec<u64> = x.iter().map(|x| libm::exp(*x).to_bits()).collect();
        let found = exponentials(x);
        let bits: Vec<u64> = found.iter().map(|y| y.to_bits()).collect();
        prop_assert!(bits == expected, "{x:?} {found:?}");
        // Without vector units, and with four lanes where the machine has eight.
        let mut plain = vec![0.0; x.len()];
        pulp::Scalar::new().vectorize(Exponentials { x, out: &mut plain });
        let mut four = plain.clone();
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            Simd::vectorize(simd, Exponentials { x, out: &mut four });
        }
        for (i, x) in x.iter().enumerate().filter(|(_, x)| upper_half(**x) < WIDE_FROM) {
            prop_assert!([plain[i], four[i]].map(f64::to_bits) == [expected[i]; 2], "{x}");
        }
        Ok(())
    }

    proptest! {
        /// The bits of `libm::exp`, of any numbers: of any size, of any bits, and beside where a range of it begins.
        #[test]
        fn bits_are_those_of_libm(
            near in prop::collection::vec(-60.0..60.0f64, 0..40),
            far in prop::collection::vec(-800.0..800.0f64, 0..20),
            any in prop::collection::vec(any::<u64>().prop_map(f64::from_bits), 0..20),
            small in prop::collection::vec((-1.0..1.0f64, -40..1i32).prop_map(|(x, e)| x * f64::from(e).exp2()), 0..40),
            edges in prop::collection::vec((0..8usize, -3..4i64, any::<bool>()), 0..40),
        ) {
            let edge = |(of, beside, negative): &(usize, i64, bool)| {
                let ranges = [ROUNDED_FROM, 0x3ff0_a2b2, WIDE_FROM, TINY_TO, TINY_TO + 1, 0x4086_232b];
                let exact = [0.5, 1.5].map(|share| share * std::f64::consts::LN_2);
                let bits = match ranges.get(*of) {
                    Some(upper) => u64::from(*upper) << 32,
                    None => exact[of - ranges.len()].to_bits(),
                };
                let x = f64::from_bits(bits.wrapping_add_signed(*beside));
                if *negative { -x } else { x }
            };
            let all: Vec<f64> =
                [near, far, any, small, edges.iter().map(edge).collect()].concat();
            same(&all)?;
        }
    }

    #[test]
    fn ends_are_those_of_libm() {
        same(&[0.0, -0.0, f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY]).unwrap();
        same(&[709.782_712_893_384, 709.782_712_893_385, -745.133_2, -745.2, f64::MAX]).unwrap();
        same(
            &(-2000..2000).map(|i| f64::from(i) * 0.5 * std::f64::consts::LN_2).collect::<Vec<_>>(),
        )
        .unwrap();
    }
}
