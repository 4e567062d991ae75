//! Laws of two lobes that share the sample as a mixture of two clusters does: where a search starts.

use nalgebra::{Matrix3, Matrix3x4, Matrix4, Vector3, Vector4};
use std::array;

use super::{
    blocks::{Block, Squares, Sum, add, add_squares, blocks, product, symmetric, total},
    centered::turn_of_last_axis,
    likelihood::Sample,
    point::Point,
    rounding::{sign, whole},
};
use crate::{jacobi, vector};

/// Rounds of expectation and maximisation after which equal lobes are told apart, and further ones.
const FIRST_ROUNDS: usize = 4;
const ROUNDS: usize = 6;
/// The share of the light lobe that every seed begins with.
const FIRST_SHARE: f64 = 0.02;
/// Attitudes that belong to the light lobe with less than e^−9 do not count.
const NOTHING: f64 = -9.0;
/// Attitudes that belong to the light lobe with e^700 belong to it alone.
const EVERYTHING: f64 = 700.0;

/// The chord of a law of two lobes meets the sphere at m and at m′. Of the light lobe the attitudes
/// show the axis ±m′ only, so that two laws have their lobes where the sample has them.
///
/// The local maxima of |Σ ±u| do not find light lobes: as a Gaussian, a lobe of one attitude in a
/// thousand hardly moves the mean, and the variance along the chord is underestimated by orders of
/// magnitude. A mixture of two clusters with one covariance has its light cluster where the law has
/// its light lobe, down to a single attitude.
pub(super) fn starts(sample: &Sample) -> Vec<Point> {
    let mut first = Vec::new();
    for seed in outermost(sample) {
        keep_new(&mut first, Lobes::around(sample, &seed).settled(sample, FIRST_ROUNDS));
    }
    let mut settled = Vec::new();
    for lobes in first {
        keep_new(&mut settled, lobes.settled(sample, ROUNDS));
    }
    settled.iter().flat_map(|lobes| lobes.laws(sample)).collect()
}

fn keep_new(known: &mut Vec<Lobes>, found: Option<Lobes>) {
    known.extend(found.filter(|lobes| !known.iter().any(|other| other.is(lobes))));
}

/// The attitudes that lie farthest out along 13 lines, either way, in units of the sample's spread.
fn outermost(sample: &Sample) -> Vec<Vector4<f64>> {
    // Through the centre of a cube and its corners, edges and faces.
    let lines: [Vector3<f64>; 13] = array::from_fn(|code| {
        let entry = |place: usize| ((code + 14) / place % 3) as f64 - 1.0;
        Vector3::new(entry(9), entry(3), entry(1)).normalize()
    });
    let mut ends = [(0.0, None); 26];
    for (index, u) in sample.points().enumerate() {
        let across = u.fixed_rows::<3>(0) * 1.0_f64.copysign(u[3]);
        for (line, pair) in lines.iter().zip(ends.chunks_exact_mut(2)) {
            let reach = line.dot(&across);
            let end = &mut pair[usize::from(sign(reach) > 0.0)];
            // The first of those that lie as far out but for rounding.
            if whole(reach.abs()) > whole(end.0) {
                *end = (reach.abs(), Some(index));
            }
        }
    }
    let mut seeds: Vec<usize> = ends.iter().filter_map(|end| end.1).collect();
    seeds.sort_unstable();
    seeds.dedup();
    seeds.into_iter().map(|index| sample.point(index)).collect()
}

/// Two clusters of axes, of unit length, and the scatter about them, in scaled coordinates u: there
/// narrow clusters keep their digits.
#[derive(Clone, Debug)]
struct Lobes {
    /// Across the heavy axis h lie the coordinates t_i = u_i − (h_i/h₄) u₄, i < 4.
    heavy: Vector4<f64>,
    /// Less than a right angle from the heavy axis.
    light: Vector4<f64>,
    /// Of t in the heavy cluster.
    precision: Matrix3<f64>,
    share: f64,
}

impl Lobes {
    /// The whole sample is the heavy cluster, and one attitude stands for the light one.
    fn around(sample: &Sample, seed: &Vector4<f64>) -> Self {
        Self {
            heavy: Vector4::w() / sample.scale[3],
            light: seed * sign(seed[3]),
            precision: Matrix3::identity(),
            share: FIRST_SHARE,
        }
    }

    fn settled(mut self, sample: &Sample, rounds: usize) -> Option<Self> {
        for _ in 0..rounds {
            let next = self.next(sample)?;
            let change = next.share - self.share;
            self = next;
            if change.abs() < 0.01 * self.share {
                break;
            }
        }
        Some(self)
    }

    /// One round of expectation and maximisation; none where the lobes are one.
    fn next(&self, sample: &Sample) -> Option<Self> {
        let offset = self.across(&self.light);
        let weights = self.precision * offset;
        let normal = self.across_map().tr_mul(&weights);
        let odds = libm::log((1.0 - self.share) / self.share);
        let threshold = 0.5 * weights.dot(&offset) + odds;
        // An axis has the sign with which it is nearer to both.
        let scale = Vector4::from(sample.scale);
        let side = (self.heavy + self.light).component_mul(&scale).component_mul(&scale);
        let (light, count) = pulp::Arch::new().dispatch(Membership {
            sample,
            normal: normal.into(),
            side: side.into(),
            threshold,
        });
        let n = sample.len();
        if !(0.5..=0.5 * n).contains(&count) {
            return None;
        }
        let heavy = Matrix4::identity() * n - light;
        let [heavy_axis, mut light_axis] = [heavy, light].map(|m| {
            let unscaled = Matrix4::from_fn(|i, j| m[(i, j)] * scale[i] * scale[j]);
            largest_axis(&unscaled)
        });
        light_axis *= sign(heavy_axis.dot(&light_axis));
        let mut next = Self {
            heavy: heavy_axis.component_div(&scale),
            light: light_axis.component_div(&scale),
            precision: Matrix3::zeros(),
            share: count / n,
        };
        let across = next.across_map();
        let spread = across * heavy * across.transpose() / (n - count);
        next.precision = spread.cholesky()?.inverse();
        Some(next)
    }

    /// u ↦ t.
    fn across_map(&self) -> Matrix3x4<f64> {
        let mut map = Matrix3x4::identity();
        for i in 0..3 {
            map[(i, 3)] = -self.heavy[i] / self.heavy[3];
        }
        map
    }

    fn across(&self, u: &Vector4<f64>) -> Vector3<f64> {
        self.across_map() * u
    }

    /// Whether these are the same lobes, to a third of their width.
    fn is(&self, other: &Self) -> bool {
        let [own, there] = [self, other].map(|lobes| self.across(&lobes.light));
        let gap = if own.dot(&there) < 0.0 { own + there } else { own - there };
        (0.8..1.25).contains(&(self.share / other.share)) && gap.dot(&(self.precision * gap)) < 0.1
    }

    fn laws(&self, sample: &Sample) -> [Point; 2] {
        let scale = Vector4::from(sample.scale);
        let axis = self.heavy.component_mul(&scale);
        let sign = 1.0_f64.copysign(axis[3]);
        let frame = turn_of_last_axis(&(axis * sign));
        let tangents = frame.fixed_columns::<3>(0).into_owned();
        let to_t = self.across_map() * Matrix4::from_diagonal(&scale.map(|s| 1.0 / s)) * tangents;
        let precision = to_t.tr_mul(&(self.precision * to_t));
        let light = frame.tr_mul(&(self.light.component_mul(&scale) * sign));
        let odds = libm::log((1.0 - self.share) / self.share);
        [light, -light].map(|light| {
            let fall = light[3] - 1.0;
            Point {
                frame,
                precision: (precision + precision.transpose()) * 0.5,
                slope: light.fixed_rows::<3>(0) / fall,
                tau: 2.0 * odds / (fall * fall),
            }
        })
    }
}

/// Sums u uᵀ and 1 over the light lobe, each attitude with the share that belongs to it.
struct Membership<'a> {
    sample: &'a Sample,
    /// By how much ln of the odds grows with u.
    normal: [f64; 4],
    /// Tells the sign of u.
    side: [f64; 4],
    threshold: f64,
}

impl pulp::WithSimd for Membership<'_> {
    type Output = (Matrix4<f64>, f64);

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> (Matrix4<f64>, f64) {
        let (mut second, mut count): (Squares, Sum) = Default::default();
        for (u, len) in blocks(self.sample.columns()) {
            let (along, side) = (product(&self.normal, &u), product(&self.side, &u));
            let ahead: Block =
                array::from_fn(|i| along[i] * 1.0_f64.copysign(side[i]) - self.threshold);
            if ahead[..len].iter().all(|ahead| *ahead <= NOTHING) {
                continue;
            }
            let member: Block = array::from_fn(|i| {
                let odds = vector::exp(-ahead[i].abs().min(EVERYTHING));
                let share = if ahead[i] < 0.0 { odds } else { 1.0 } / (1.0 + odds);
                if ahead[i] > NOTHING && i < len { share } else { 0.0 }
            });
            add(&mut count, &member);
            add_squares(&mut second, &u, &member);
        }
        (symmetric(&second), total(&count))
    }
}

fn largest_axis(m: &Matrix4<f64>) -> Vector4<f64> {
    let (values, axes) = jacobi::eigen(m);
    let largest = (0..4).fold(0, |l, j| if values[j] > values[l] { j } else { l });
    axes.column(largest).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Quaternion, UnitQuaternion};
    use proptest::prelude::*;
    use pulp::Simd;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Of samples of any size, whether all, some or none belong to the lobe; and the same bits on any vector unit.
        #[test]
        fn shares_are_those_of_a_plain_loop(
            seeds in prop::collection::vec(prop::array::uniform4(-1.0..1.0_f64), 5..700),
            normal in prop::array::uniform4(-1.0..1.0_f64),
            side in prop::array::uniform4(-1.0..1.0_f64),
            steep in -2.0..10.0_f64,
            threshold in -1.0..1.0_f64,
        ) {
            let attitudes: Vec<_> = seeds
                .into_iter()
                .map(|[x, y, z, w]| UnitQuaternion::from_quaternion(Quaternion::new(1.5 + w, x, y, z)))
                .collect();
            let sample = Sample::new(&attitudes);
            let normal = normal.map(|x| x * steep.exp2());
            let lobe = || Membership { sample: &sample, normal, side, threshold: threshold * steep.exp2() };
            let (mut second, mut count) = (Matrix4::zeros(), 0.0);
            for u in sample.points() {
                let sign = 1.0_f64.copysign(Vector4::from(side).dot(&u));
                let ahead = Vector4::from(normal).dot(&u) * sign - lobe().threshold;
                if ahead > NOTHING {
                    let member = 1.0 / (1.0 + libm::exp(-ahead));
                    second += u * u.transpose() * member;
                    count += member;
                }
            }
            let found = pulp::Arch::new().dispatch(lobe());
            prop_assert!((found.1 - count).abs() <= 1e-12 * count, "{} {count}", found.1);
            prop_assert!((found.0 - second).amax() <= 1e-12 * second.trace());
            for other in [
                pulp::Scalar::new().vectorize(lobe()),
                pulp::Scalar256b.vectorize(lobe()),
                pulp::Scalar512b.vectorize(lobe()),
            ] {
                prop_assert_eq!(other, found);
            }
        }
    }
}
