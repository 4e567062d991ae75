//! The uniform law, four ways to draw from it, and a grid.

mod alternatives;
mod spiral;

use nalgebra::{Quaternion, UnitQuaternion};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use crate::vector;

/// Attitudes made at a time in a batch.
const CHUNK: usize = 64;
/// Chunks whose random bits are filled at a time: many enough for generators that fill long slices faster, few enough for the
/// first-level cache.
const FILLED: usize = 4;

pub use alternatives::{BoxUniform, MarsagliaUniform, ShoemakeUniform};
pub use spiral::super_fibonacci;

/// The uniform law: every attitude equally likely.
///
/// # Definition
/// Density 1/(2π²) with respect to surface measure on S³; on SO(3), Haar measure, the only law that
/// looks the same from every reference attitude.
///
/// # Algorithm
/// Four independent standard normals, divided by their norm (Muller 1959,
/// doi:10.1145/377939.377946).
///
/// ```
/// use gyradius_attitude::UniformAttitude;
/// use rand_chacha::rand_core::SeedableRng;
/// use rand_distr::Distribution;
///
/// let q = UniformAttitude.sample(&mut rand_chacha::ChaCha8Rng::seed_from_u64(1));
/// assert!((q.norm() - 1.0).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct UniformAttitude;

impl UniformAttitude {
    /// The logarithm of the density with respect to surface measure on S³: −ln 2π².
    pub const LN_DENSITY: f64 = -2.982_606_952_258_745_7;

    /// Fills a slice with independent draws, by the machine's vector units.
    ///
    /// Shoemake's two angles and squared radius, 52 bits each. The values are others than those of
    /// [`sample`](Distribution::sample), the same on every machine, and the first of a longer slice
    /// are those of a shorter one.
    ///
    /// ```
    /// use gyradius_attitude::UniformAttitude;
    /// use nalgebra::UnitQuaternion;
    /// use rand_chacha::rand_core::SeedableRng;
    ///
    /// let mut attitudes = vec![UnitQuaternion::identity(); 1000];
    /// let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    /// UniformAttitude.sample_into(&mut rng, &mut attitudes);
    /// assert!(attitudes.iter().all(|q| (q.norm() - 1.0).abs() < 1e-15));
    /// ```
    pub fn sample_into<R: Rng + ?Sized>(&self, rng: &mut R, out: &mut [UnitQuaternion<f64>]) {
        let mut bits = [[[0; CHUNK / 2]; 5]; FILLED];
        let mut x = [[0.0; CHUNK]; 4];
        for out in out.chunks_mut(FILLED * CHUNK) {
            let bits = &mut bits[..out.len().div_ceil(CHUNK)];
            rng.fill(bits.as_flattened_mut().as_flattened_mut());
            for (out, bits) in out.chunks_mut(CHUNK).zip(bits) {
                pulp::Arch::new().dispatch(Shoemake { bits, x: &mut x, out });
            }
        }
    }
}

/// Shoemake's construction from random bits.
struct Shoemake<'a> {
    bits: &'a [[u64; CHUNK / 2]; 5],
    x: &'a mut [[f64; CHUNK]; 4],
    out: &'a mut [UnitQuaternion<f64>],
}

impl pulp::WithSimd for Shoemake<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let [a, b, c, d, e] = self.bits;
        let [x, y, z, w] = self.x;
        for i in 0..CHUNK / 2 {
            let j = i + CHUNK / 2;
            // An angle takes 54 bits of its word: what two draws leave is one more number.
            let spare = |word: u64, place: u32| ((word >> 2) & 0x3ff) << place;
            let rest = spare(a[i], 12) | spare(b[i], 22) | spare(c[i], 32) | spare(d[i], 42);
            let (first, second) = (vector::unit(e[i]), vector::unit((rest | (e[i] & 0xfff)) << 12));
            (x[i], y[i]) = vector::on_circle(a[i], (1.0 - first).sqrt());
            (z[i], w[i]) = vector::on_circle(b[i], first.sqrt());
            (x[j], y[j]) = vector::on_circle(c[i], (1.0 - second).sqrt());
            (z[j], w[j]) = vector::on_circle(d[i], second.sqrt());
        }
        for (i, q) in self.out.iter_mut().enumerate() {
            *q = UnitQuaternion::new_unchecked(Quaternion::new(w[i], x[i], y[i], z[i]));
        }
    }
}

impl Distribution<UnitQuaternion<f64>> for UniformAttitude {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        loop {
            // One by one: an array would go through memory, and its reloading costs a third.
            let x: f64 = StandardNormal.sample(rng);
            let y: f64 = StandardNormal.sample(rng);
            let z: f64 = StandardNormal.sample(rng);
            let w: f64 = StandardNormal.sample(rng);
            let square = x * x + y * y + z * z + w * w;
            // Four normals all this small have probability 1e-33; their norm would lose digits.
            if square > 1e-16 {
                let scale = 1.0 / square.sqrt();
                return UnitQuaternion::new_unchecked(Quaternion::new(
                    w * scale,
                    x * scale,
                    y * scale,
                    z * scale,
                ));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    const N: usize = 100_000;

    fn draws<D: Distribution<UnitQuaternion<f64>>>(law: D) -> Vec<UnitQuaternion<f64>> {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        (0..N).map(|_| law.sample(&mut rng)).collect()
    }

    fn batch(n: usize) -> Vec<UnitQuaternion<f64>> {
        let mut attitudes = vec![UnitQuaternion::identity(); n];
        UniformAttitude.sample_into(&mut ChaCha8Rng::seed_from_u64(1), &mut attitudes);
        attitudes
    }

    fn every_way() -> [(&'static str, Vec<UnitQuaternion<f64>>); 5] {
        [
            ("batch", batch(N)),
            ("normals", draws(UniformAttitude)),
            ("Marsaglia", draws(MarsagliaUniform)),
            ("Shoemake", draws(ShoemakeUniform)),
            ("box", draws(BoxUniform)),
        ]
    }

    /// Largest distance between the empirical distribution of values and a distribution function,
    /// times √n: beyond 1.95 once in a thousand.
    fn kolmogorov(mut values: Vec<f64>, cdf: impl Fn(f64) -> f64) -> f64 {
        values.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        let distance = values.iter().enumerate().map(|(i, &x)| {
            let f = cdf(x);
            (f - i as f64 / n).max((i + 1) as f64 / n - f)
        });
        distance.fold(0.0, f64::max) * n.sqrt()
    }

    #[test]
    fn density_integrates_to_one() {
        let pi = std::f64::consts::PI;
        assert!((UniformAttitude::LN_DENSITY + (2.0 * pi * pi).ln()).abs() < 1e-15);
    }

    #[test]
    fn a_longer_batch_begins_like_a_shorter_one() {
        assert_eq!(batch(1000)[..333], batch(333)[..]);
    }

    /// The first draws of every way from a fixed seed: they change only on purpose.
    #[test]
    fn value_stability() {
        let first = every_way().map(|(_, attitudes)| <[f64; 4]>::from(attitudes[0].coords));
        assert_eq!(first, STABLE, "{first:?}");
    }

    const STABLE: [[f64; 4]; 5] = [
        [-0.13069512907203665, 0.8465561587087712, 0.4213502456278339, -0.2978681317268725],
        [-0.1268781974298096, -0.7622067223506189, 0.1799216582088404, -0.6087454577472179],
        [-0.19502867267030388, -0.8392325821404361, 0.16512809839964274, -0.4799845841579432],
        [0.37402303412422183, 0.6764769813376234, -0.3617220857027578, -0.5211936265724042],
        [-0.46834844580904955, 0.45600869387540394, -0.08425104442739313, -0.7520688571741215],
    ];

    /// Both halves of a batch chunk, the second of which is made of bits that the first leaves.
    #[test]
    fn draws_that_share_words_are_independent() {
        let attitudes = batch(64 * 2000);
        let pairs = attitudes.chunks(64).flat_map(|c| (0..32).map(|i| (c[i], c[i + 32])));
        let product: f64 = pairs.map(|(a, b)| a.coords.dot(&b.coords)).sum();
        // A product of two independent attitudes has mean 0 and variance ¼.
        let z = product / (0.25 * 64_000_f64).sqrt();
        assert!(z.abs() < 4.0, "{z}");
        let squares = attitudes.chunks(64).flat_map(|c| (0..32).map(|i| (c[i], c[i + 32])));
        let split = |q: &UnitQuaternion<f64>| q.i * q.i + q.j * q.j - 0.5;
        let sum: f64 = squares.map(|(a, b)| split(&a) * split(&b)).sum();
        // Uniform on [−½, ½] each.
        let z = sum / (64_000_f64 / 144.0).sqrt();
        assert!(z.abs() < 4.0, "{z}");
    }

    /// Under Haar measure the rotation angle has the distribution (θ − sin θ)/π.
    #[test]
    fn rotation_angle_is_haar() {
        for (name, attitudes) in every_way() {
            let angles = attitudes.iter().map(UnitQuaternion::angle).collect();
            let d = kolmogorov(angles, |t| (t - t.sin()) / std::f64::consts::PI);
            assert!(d < 1.95, "{name}: {d}");
            let off = |q: &UnitQuaternion<f64>| (q.norm() - 1.0).abs() > 4.0 * f64::EPSILON;
            assert!(!attitudes.iter().any(off), "{name}");
        }
    }

    /// Under Haar measure every entry of the rotation matrix is uniform on [-1, 1].
    #[test]
    fn every_matrix_entry_is_uniform() {
        for (name, attitudes) in every_way() {
            let matrices: Vec<_> =
                attitudes.into_iter().map(UnitQuaternion::to_rotation_matrix).collect();
            for i in 0..3 {
                for j in 0..3 {
                    let entry = matrices.iter().map(|m| m[(i, j)]).collect();
                    let d = kolmogorov(entry, |x| 0.5 * (x + 1.0));
                    assert!(d < 2.2, "{name}, entry {i}{j}: {d}");
                }
            }
        }
    }

    /// Negative control: uniform Euler angles are not uniform attitudes, and the entries show it.
    #[test]
    fn uniform_euler_angles_are_caught() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut angle = || rng.random_range(-std::f64::consts::PI..std::f64::consts::PI);
        let entry = (0..N)
            .map(|_| {
                let q = UnitQuaternion::from_euler_angles(angle(), angle(), angle());
                q.to_rotation_matrix()[(2, 0)]
            })
            .collect();
        assert!(kolmogorov(entry, |x| 0.5 * (x + 1.0)) > 10.0);
    }
}
