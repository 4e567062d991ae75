//! The uniform law, four ways to draw from it, and a grid.

mod alternatives;
mod spiral;

use nalgebra::{Quaternion, UnitQuaternion};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

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

    fn every_way() -> [(&'static str, Vec<UnitQuaternion<f64>>); 4] {
        [
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
        use rand::RngExt;
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
