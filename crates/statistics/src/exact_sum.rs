//! Sums of numbers that are exact, and so the same in whatever order and parts they are added.

/// Bits of a limb that hold the sum; the rest take up carries.
const BITS: u32 = 32;
/// Limbs for every bit of a finite number, 2⁻¹⁰⁷⁴ to 2¹⁰²³, and for 2⁶⁴ of the largest.
const LIMBS: usize = 69;
/// Additions after which carries are passed on: each adds less than 2³³ to a limb of 64 bits.
const ADDITIONS: u32 = 1 << 29;
/// Digits below those of a sum that its mean is computed to before it is rounded.
const GUARD: usize = 2;
/// Bits of the significand of a number.
const SIGNIFICAND: usize = 53;

/// The exact sum of finite numbers.
///
/// A fixed-point number wide enough for every bit of every finite number, in the manner of Kulisch; limbs of 32
/// bits with room for carries are those of the small superaccumulator of Neal (2015, arXiv:1505.05571). Adding
/// is associative: parts may be summed on any number of threads or machines and merged in any order, to the
/// same bits. Up to 2⁶⁴ numbers.
///
/// ```
/// use gyradius_statistics::ExactSum;
///
/// let sum: ExactSum = [1e300, 1.0, -1e300, 1e-300].into_iter().collect();
/// assert_eq!(sum.value(), 1.0);
/// ```
#[derive(Clone, Debug)]
pub struct ExactSum {
    /// The first counts multiples of 2⁻¹⁰⁷⁴.
    limbs: [i64; LIMBS],
    /// Additions until carries must be passed on.
    room: u32,
}

impl ExactSum {
    /// The empty sum, 0.
    #[must_use]
    pub fn new() -> Self {
        Self { limbs: [0; LIMBS], room: ADDITIONS }
    }

    /// Adds a number. One that is not finite is not added.
    #[inline]
    pub fn add(&mut self, x: f64) {
        self.add_times(x, 1);
    }

    /// Adds a number so many times.
    #[inline]
    pub(crate) fn add_times(&mut self, x: f64, times: u32) {
        if !x.is_finite() {
            return;
        }
        let bits = x.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as u32;
        let fraction = bits & ((1 << 52) - 1);
        let significand = if exponent == 0 { fraction } else { fraction | 1 << 52 };
        let shift = exponent.max(1) - 1;
        let product = u128::from(significand) * u128::from(times);
        // Less than 2⁸⁵ · 2³¹.
        let shifted = product << (shift % BITS);
        let first = (shift / BITS) as usize;
        let digit = |i: u32| (shifted >> (i * BITS)) as u32;
        let negative = x.is_sign_negative();
        for (limb, i) in self.limbs[first..].iter_mut().zip(0..4) {
            let digit = i64::from(digit(i));
            *limb += if negative { -digit } else { digit };
        }
        self.spend(1);
    }

    /// Adds another sum.
    pub fn merge(&mut self, other: &Self) {
        for (limb, more) in self.limbs.iter_mut().zip(other.carried()) {
            *limb += more;
        }
        self.spend(1);
    }

    /// 2¹²⁸ times the sum, which must be below 2⁹⁰⁰.
    pub(crate) fn shifted(&self) -> Self {
        let mut limbs = self.carried();
        let sign = limbs[LIMBS - 1];
        limbs.rotate_right(4);
        limbs[..4].fill(0);
        limbs[LIMBS - 1] = sign;
        Self { limbs, room: ADDITIONS }
    }

    fn spend(&mut self, additions: u32) {
        self.room -= additions;
        if self.room == 0 {
            self.limbs = self.carried();
            self.room = ADDITIONS;
        }
    }

    /// The limbs with carries passed on: all but the last from 0 to 2³² − 1.
    fn carried(&self) -> [i64; LIMBS] {
        let mut limbs = self.limbs;
        let mut carry = 0;
        for limb in &mut limbs[..LIMBS - 1] {
            let sum = *limb + carry;
            *limb = sum & 0xffff_ffff;
            carry = sum >> BITS;
        }
        limbs[LIMBS - 1] += carry;
        limbs
    }

    /// The sum, rounded to the nearest number; infinite beyond the largest.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.over(1)
    }

    /// The sum over a number of values, rounded once to the nearest number; NaN over none.
    #[must_use]
    pub fn mean(&self, n: u64) -> f64 {
        if n == 0 { f64::NAN } else { self.over(n) }
    }

    /// The sum less `n` times a finite number, over `n`.
    pub(crate) fn mean_beyond(&self, x: f64, n: u64) -> f64 {
        let mut rest = self.clone();
        rest.add_times(-x, n as u32);
        // The upper half of n counts multiples of 2³², which are the limbs one further up.
        let mut upper = Self::new();
        upper.add_times(-x, (n >> BITS) as u32);
        for (limb, more) in rest.limbs[1..].iter_mut().zip(upper.limbs) {
            *limb += more;
        }
        rest.over(n)
    }

    /// The sum over `n`, which is not 0, rounded once.
    fn over(&self, n: u64) -> f64 {
        let limbs = self.carried();
        let negative = limbs[LIMBS - 1] < 0;
        let mut digits = [0_u32; GUARD + LIMBS];
        // Of the magnitude: if negative, all bits turned, and 1.
        let mut carry = u64::from(negative);
        for (digit, limb) in digits[GUARD..].iter_mut().zip(limbs) {
            let low = if negative { !(limb as u32) } else { limb as u32 };
            let sum = u64::from(low) + carry;
            (*digit, carry) = (sum as u32, sum >> BITS);
        }
        let mut rest = 0_u128;
        for digit in digits.iter_mut().rev() {
            let dividend = rest << BITS | u128::from(*digit);
            *digit = (dividend / u128::from(n)) as u32;
            rest = dividend % u128::from(n);
        }
        let magnitude = rounded(&digits, rest != 0);
        if negative { -magnitude } else { magnitude }
    }
}

/// The nearest number, ties to even, to digits of which the first counts multiples of 2⁻¹⁰⁷⁴⁻⁶⁴, and to a
/// little more if `more`.
fn rounded(digits: &[u32], more: bool) -> f64 {
    let bit = |place: usize| digits[place / 32] >> (place % 32) & 1 == 1;
    let Some(top) = (0..digits.len() * 32).rev().find(|place| bit(*place)) else { return 0.0 };
    // The last bit that is kept.
    let last = (top + 1).saturating_sub(SIGNIFICAND).max(GUARD * 32);
    let kept =
        (last..=top.max(last)).rev().fold(0_u64, |kept, place| kept << 1 | u64::from(bit(place)));
    let half = bit(last - 1);
    let below = more || (0..last - 1).any(bit);
    let up = half && (below || kept & 1 == 1);
    // Exact: at most 2⁵³.
    let significand = (kept + u64::from(up)) as f64;
    let exponent = last as i32 - (GUARD * 32) as i32 - 1074;
    // In two steps, each exact, for powers beyond the range of numbers.
    let half = exponent / 2;
    significand * power(half) * power(exponent - half)
}

/// 2ⁿ for −1022 ≤ n ≤ 1023.
fn power(n: i32) -> f64 {
    f64::from_bits(((n + 1023) as u64) << 52)
}

impl Default for ExactSum {
    fn default() -> Self {
        Self::new()
    }
}

impl Extend<f64> for ExactSum {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, numbers: I) {
        numbers.into_iter().for_each(|x| self.add(x));
    }
}

impl FromIterator<f64> for ExactSum {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        let mut sum = Self::new();
        sum.extend(numbers);
        sum
    }
}

/// Equal if the sums are, however they came about.
impl PartialEq for ExactSum {
    fn eq(&self, other: &Self) -> bool {
        self.carried() == other.carried()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn finite() -> impl Strategy<Value = f64> {
        prop_oneof![
            any::<f64>().prop_filter("finite", |x| x.is_finite()),
            -1e3..1e3f64,
            (-60..60_i32, -8..8_i32).prop_map(|(e, m)| f64::from(m) * 2f64.powi(e)),
            Just(f64::MAX),
            Just(f64::MIN),
            Just(5e-324),
            Just(f64::MIN_POSITIVE),
        ]
    }

    #[test]
    fn the_ends_of_the_range() {
        let sum: ExactSum = [f64::MAX, f64::MAX].into_iter().collect();
        assert_eq!(sum.value(), f64::INFINITY);
        assert_eq!(sum.mean(2), f64::MAX);
        let sum: ExactSum = [f64::MIN, f64::MIN, f64::MIN].into_iter().collect();
        assert_eq!((sum.mean(3), sum.value()), (f64::MIN, f64::NEG_INFINITY));
        let sum: ExactSum = [5e-324; 3].into_iter().collect();
        // Three halves of the smallest number are two of it, ties going to the even one.
        assert_eq!((sum.value(), sum.mean(2), sum.mean(7)), (15e-324, 10e-324, 0.0));
        assert_eq!(ExactSum::new().value().to_bits(), 0);
        assert!(ExactSum::new().mean(0).is_nan());
        let sum: ExactSum = [f64::NAN, f64::INFINITY, 1.0].into_iter().collect();
        assert_eq!(sum.value(), 1.0);
    }

    #[test]
    fn carries_are_passed_on_in_time() {
        let mut sum = ExactSum::new();
        sum.room = 2;
        let mut plain = ExactSum::new();
        for i in 0..100_000 {
            let x = f64::from(i) - 70_000.25;
            sum.room = sum.room.min(3);
            sum.add(x);
            plain.add(x);
        }
        assert_eq!(sum, plain);
        assert_eq!(sum.value(), (0..100_000).map(|i| f64::from(i) - 70_000.25).sum::<f64>());
    }

    proptest! {
        /// Against sums of whole multiples in 128 bits, where these hold them.
        #[test]
        fn sums_and_means_are_rounded_once(
            terms in prop::collection::vec(-(1_i64 << 53)..1 << 53, 1..60),
            exponent in -1074..900_i32,
            n in prop_oneof![1..100_u64, any::<u64>()],
        ) {
            prop_assume!(n > 0);
            let unit = |x: f64| {
                let half = exponent / 2;
                x * 2f64.powi(half) * 2f64.powi(exponent - half)
            };
            let sum: ExactSum = terms.iter().map(|i| unit(*i as f64)).collect();
            let exact: i128 = terms.iter().map(|i| i128::from(*i)).sum();
            // An integer of so many bits is rounded once by the conversion, and not again where normal.
            if exponent > -1074 + 53 || exact.unsigned_abs() < 1 << 53 {
                prop_assert_eq!(sum.value(), unit(exact as f64));
                if exact % i128::from(n) == 0 {
                    prop_assert_eq!(sum.mean(n), unit((exact / i128::from(n)) as f64));
                }
            }
            // No number is nearer to the sum than its mean times n.
            let mean = sum.mean(n);
            prop_assert!(sum.mean_beyond(mean, n).abs() <= (mean.abs().next_up() - mean.abs()) / 2.0);
        }

        /// Whatever the parts and their order.
        #[test]
        fn parts_in_any_order_give_the_same_bits(
            numbers in prop::collection::vec(finite(), 0..80),
            part in 1..20_usize,
            times in 1..1000_u64,
        ) {
            let whole: ExactSum = numbers.iter().copied().collect();
            let mut merged = ExactSum::new();
            for part in numbers.rchunks(part) {
                merged.merge(&part.iter().rev().copied().collect());
            }
            prop_assert_eq!(&merged, &whole);
            prop_assert_eq!(merged.value().to_bits(), whole.value().to_bits());
            // And taking every number away again leaves nothing.
            merged.extend(numbers.iter().map(|x| -x));
            prop_assert_eq!(merged.value(), 0.0);
            // So many of one number.
            if let Some(x) = numbers.first() {
                let many: ExactSum = (0..times).map(|_| *x).collect();
                prop_assert_eq!(many.mean(times), *x);
                prop_assert_eq!(many.mean_beyond(*x, times), 0.0);
                let n = times << 33 | times;
                prop_assert_eq!(ExactSum::new().mean_beyond(*x, n), -x);
            }
        }

        /// Adding two numbers is what the machine does.
        #[test]
        fn two_numbers(a in finite(), b in finite()) {
            let sum: ExactSum = [a, b].into_iter().collect();
            prop_assert_eq!(sum.value(), a + b);
        }
    }
}
