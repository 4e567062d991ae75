//! Averages over a sample under a law, which its likelihood and derivatives are made of: many attitudes at a time.

use nalgebra::{Matrix4, Vector4};
use std::array;

use super::{
    blocks::{
        Block, LANES, Squares, Sum, add, add_products, add_squares, blocks, map, product,
        symmetric, total,
    },
    centered::Centered,
};
use crate::vector;

/// Attitudes whose two signs differ by more than e^40 have one.
const CERTAIN: f64 = 20.0;
/// Products beyond this could overflow in the next block, which multiplies them by up to 2^8.
const LARGE: f64 = 1e300;

/// Averages over the sample, of each attitude the sign that the law prefers.
#[derive(Debug, Default)]
pub(super) struct Means {
    /// ln of the density of ±u, not normalised.
    pub(super) exponent: f64,
    /// w.
    pub(super) first: Vector4<f64>,
    /// w wᵀ.
    pub(super) second: Matrix4<f64>,
    /// v times the share of the other sign, and v vᵀ times the product of the shares.
    pub(super) other: Vector4<f64>,
    pub(super) doubt: Matrix4<f64>,
}

impl Means {
    /// Of a sample by its coordinates, which are turned and stretched into those of the law.
    pub(super) fn new(columns: &[Vec<f64>; 4], turn: Matrix4<f64>, law: &Centered) -> Self {
        pulp::Arch::new().dispatch(Sums { columns, turn, law })
    }
}

/// Sums over a sample: attitude i is added to lane i mod 8 of each, on any machine.
struct Sums<'a> {
    columns: &'a [Vec<f64>; 4],
    turn: Matrix4<f64>,
    law: &'a Centered,
}

impl pulp::WithSimd for Sums<'_> {
    type Output = Means;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Means {
        let Self { columns, turn, law } = self;
        let (roots, b, center) = (law.roots(), law.linear(), law.center);
        let [mut first, mut other]: [[Sum; 4]; 2] = Default::default();
        let [mut second, mut doubt]: [Squares; 2] = Default::default();
        // Of 1 + odds, whose logarithms sum to what the other sign adds.
        let mut odds_of_all = [1.0; LANES];
        let mut logarithms = 0.0;
        for (u, len) in blocks(columns) {
            let mut v = map(&turn, &u);
            let linear = product(&b, &v);
            // Of u and −u the one that the law prefers. The exponent is centred, as the plain one is
            // a difference of large terms.
            for v in &mut v {
                for (v, linear) in v.iter_mut().zip(&linear) {
                    *v *= 1.0_f64.copysign(*linear);
                }
            }
            let mut w: [Block; 4] =
                array::from_fn(|j| array::from_fn(|i| (v[j][i] - center[j]) * roots[j]));
            w.iter_mut().for_each(|w| w[len..].fill(0.0));
            for i in 0..4 {
                add(&mut first[i], &w[i]);
                for j in 0..=i {
                    add_products(&mut second[i][j], &w[i], &w[j]);
                }
            }
            if linear[..len].iter().all(|linear| linear.abs() >= CERTAIN) {
                continue;
            }
            let odds: Block = array::from_fn(|i| {
                let size = linear[i].abs();
                let odds = vector::exp(-2.0 * size.min(CERTAIN));
                if size < CERTAIN && i < len { odds } else { 0.0 }
            });
            let share: Block = array::from_fn(|i| odds[i] / (1.0 + odds[i]));
            for odds in odds.chunks_exact(LANES) {
                for (product, odds) in odds_of_all.iter_mut().zip(odds) {
                    *product *= 1.0 + odds;
                }
            }
            if odds_of_all.iter().any(|product| *product > LARGE) {
                logarithms += logarithm(&mut odds_of_all);
            }
            for i in 0..4 {
                add_products(&mut other[i], &v[i], &share);
            }
            let both: Block = array::from_fn(|i| share[i] * (1.0 - share[i]));
            add_squares(&mut doubt, &v, &both);
        }
        logarithms += logarithm(&mut odds_of_all);
        let n = columns[0].len() as f64;
        let mean = |sums: &[Sum; 4]| Vector4::from_fn(|i, _| total(&sums[i])) / n;
        let second = symmetric(&second) / n;
        Means {
            exponent: logarithms / n - 0.5 * second.trace(),
            first: mean(&first),
            second,
            other: mean(&other),
            doubt: symmetric(&doubt) / n,
        }
    }
}

/// The sum of the logarithms of numbers, which are 1 afterwards.
fn logarithm(product: &mut Sum) -> f64 {
    let sum = product.iter().map(|product| libm::log(*product)).sum();
    *product = [1.0; LANES];
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::likelihood::Sample;
    use nalgebra::{Quaternion, UnitQuaternion};
    use proptest::prelude::*;
    use pulp::Simd;

    /// One attitude after the other, with the size of what is summed of the exponent.
    fn plain(sample: &Sample, law: &Centered) -> (Means, f64) {
        let (turn, roots, b) = (sample.turn(law), Vector4::from(law.roots()), law.linear());
        let (center, b, n) = (Vector4::from(law.center), Vector4::from(b), sample.len());
        let (mut means, mut size) = (Means::default(), 0.0);
        for u in sample.points() {
            let v = turn * u;
            let linear = b.dot(&v);
            let v = v * 1.0_f64.copysign(linear);
            let w = (v - center).component_mul(&roots);
            let odds = if linear.abs() < CERTAIN { libm::exp(-2.0 * linear.abs()) } else { 0.0 };
            let share = odds / (1.0 + odds);
            means.exponent += (libm::log1p(odds) - 0.5 * w.norm_squared()) / n;
            size += (1.0 + w.norm_squared()) / n;
            means.first += w / n;
            means.second += w * w.transpose() / n;
            means.other += v * share / n;
            means.doubt += v * v.transpose() * (share * (1.0 - share)) / n;
        }
        (means, size)
    }

    fn bits(means: &Means) -> Vec<u64> {
        let Means { exponent, first, second, other, doubt } = means;
        let numbers = [*exponent].into_iter().chain(first.iter().chain(second).copied());
        numbers.chain(other.iter().chain(doubt).copied()).map(f64::to_bits).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Of samples of any size, wide and narrow, under laws with one lobe and with two; and the same bits on any
        /// vector unit.
        #[test]
        fn averages_are_those_of_a_plain_loop(
            seeds in prop::collection::vec(prop::array::uniform4(-1.0..1.0_f64), 1..700),
            width in -6.0..1.0_f64,
            p in prop::array::uniform16(-1.0..1.0_f64),
            b in prop::array::uniform4(-1.0..1.0_f64),
            steep in -2.0..4.0_f64,
            repeats in prop_oneof![9 => Just(1), 1 => Just(30)],
        ) {
            let width = width.exp2();
            let attitude = |x: [f64; 4]| {
                let [x, y, z, w] = x.map(|x| x * width);
                UnitQuaternion::from_quaternion(Quaternion::new(1.0 + w, x, y, z))
            };
            // All rest in one point without these.
            let apart = [[0.3, 0.0, 0.1, 0.0], [0.0, -0.4, 0.0, 0.0], [-0.1, 0.0, 0.5, 0.0], [0.2, 0.3, -0.4, -0.9]];
            let attitudes: Vec<_> = seeds.into_iter().chain(apart).map(attitude).collect();
            let attitudes = attitudes.repeat(repeats);
            let sample = Sample::new(&attitudes);
            let half = Matrix4::from_row_slice(&p);
            let steep = steep.exp2();
            let law = Centered::of(&(half * half.transpose() * steep / width), &(Vector4::from(b) * steep / width));
            let (expected, size) = plain(&sample, &law);
            let sums = || Sums { columns: sample.columns(), turn: sample.turn(&law), law: &law };
            let found = Means::new(sample.columns(), sample.turn(&law), &law);
            prop_assert!((found.exponent - expected.exponent).abs() <= 1e-13 * size);
            let root = size.sqrt();
            prop_assert!((found.first - expected.first).amax() <= 1e-13 * root);
            for i in 0..4 {
                for j in 0..=i {
                    prop_assert!((found.second[(i, j)] - expected.second[(i, j)]).abs() <= 1e-13 * size);
                }
            }
            prop_assert!((found.other - expected.other).amax() <= 1e-13);
            prop_assert!((found.doubt - expected.doubt).amax() <= 1e-13);
            for other in [
                pulp::Scalar::new().vectorize(sums()),
                pulp::Scalar256b.vectorize(sums()),
                pulp::Scalar512b.vectorize(sums()),
            ] {
                prop_assert_eq!(bits(&other), bits(&found));
            }
        }
    }
}
