use gyradius_attitude::{FisherBingham, FisherBinghamError, RadiallyConstrainedGaussian};
use nalgebra::{Matrix4, UnitQuaternion, Vector4};
use rand::{Rng, RngExt};
use rand_distr::Distribution;

/// The law of attitudes behind Table 2 of Peck (2003): the half sphere around the mean, with the
/// Jacobian of the hyperspherical angles counted twice.
///
/// # Definition
/// Density ∝ exp(−½(x − m)ᵀΣ⁻¹(x − m)) · sin²θ₁ sin θ₂ where x·m ≥ 0, with respect to surface
/// measure on S³, which already holds that Jacobian once (Eq. 25); in coordinates, the second
/// factor is |v|·√(x₁² + x₂²), v = (x₁, x₂, x₃). It vanishes at the mean of a small attitude, which
/// is how a Gaussian comes to have two peaks. It is here to reproduce the paper and for no other
/// purpose.
///
/// # Algorithm
/// Exact rejection. Since t ≤ e^{t−1}, |v|² ≤ a·exp(|v|²/a − 1) for any a, and the same for
/// x₁² + x₂²: both bounds are Gaussian factors, so the envelope is a Fisher-Bingham law with a
/// changed quadratic form. The best a is the envelope's own E[|v|²].
#[derive(Clone, Debug)]
pub struct JacobianTwice {
    law: RadiallyConstrainedGaussian,
    envelope: FisherBingham,
    /// a for |v|² and for x₁² + x₂².
    sizes: [f64; 2],
}

impl JacobianTwice {
    /// From the law with the Jacobian counted once.
    ///
    /// # Errors
    /// The covariance is so concentrated (eigenvalues below 1e-13) that the envelope's parameters
    /// are out of range.
    pub fn new(law: RadiallyConstrainedGaussian) -> Result<Self, FisherBinghamError> {
        const ITERATIONS: usize = 12;
        let precision = law.precision();
        let linear = precision * law.mean().coords;
        let squares = |second: &Matrix4<f64>| {
            let planar = second[(0, 0)] + second[(1, 1)];
            [planar + second[(2, 2)], planar]
        };
        let envelope = |[all, planar]: [f64; 2]| {
            let both = 1.0 / all + 1.0 / planar;
            let loosened = Matrix4::from_diagonal(&Vector4::new(both, both, 1.0 / all, 0.0));
            FisherBingham::new(precision - loosened, linear)
        };
        let mut sizes = squares(&law.second_moment());
        for _ in 0..ITERATIONS {
            let next = squares(&envelope(sizes)?.second_moment());
            // The geometric mean damps the iteration, which overshoots.
            sizes = std::array::from_fn(|i| (sizes[i] * next[i]).sqrt());
        }
        Ok(Self { envelope: envelope(sizes)?, law, sizes })
    }

    /// The law with the Jacobian counted once.
    #[must_use]
    pub fn once(&self) -> &RadiallyConstrainedGaussian {
        &self.law
    }
}

impl Distribution<UnitQuaternion<f64>> for JacobianTwice {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        loop {
            let q = self.envelope.sample(rng);
            let planar = q.i * q.i + q.j * q.j;
            let (s, t) = ((planar + q.k * q.k) / self.sizes[0], planar / self.sizes[1]);
            // (t e^{1−t}) is at most one; the square root is in the density.
            let u: f64 = rng.random();
            if u * u < s * t * libm::exp(2.0 - s - t) && self.law.in_mean_half(&q) {
                return q;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    fn law() -> RadiallyConstrainedGaussian {
        let mean = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
            0.9996, 0.0249, 0.0005, -0.0100,
        ));
        let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
        RadiallyConstrainedGaussian::new(mean, covariance).unwrap()
    }

    /// Against the definition, by weighting draws of the plain law: another path to every moment.
    #[test]
    fn agrees_with_weighted_draws_of_the_plain_law() {
        const N: usize = 400_000;
        let plain = law();
        let twice = JacobianTwice::new(plain.clone()).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(21);
        let measure = |q: &UnitQuaternion<f64>| [q.i, q.j, q.k, q.i * q.i, q.j * q.j, q.k * q.k];
        let direct: Vec<[f64; 6]> = (0..N).map(|_| measure(&twice.sample(&mut rng))).collect();
        let weighted: Vec<(f64, [f64; 6])> = (0..N)
            .map(|_| plain.sample(&mut rng))
            .filter(|q| plain.in_mean_half(q))
            .map(|q| {
                let planar = q.i * q.i + q.j * q.j;
                (((planar + q.k * q.k) * planar).sqrt(), measure(&q))
            })
            .collect();
        let total: f64 = weighted.iter().map(|w| w.0).sum();
        for k in 0..6 {
            let a = direct.iter().map(|x| x[k]).sum::<f64>() / N as f64;
            let va = direct.iter().map(|x| (x[k] - a).powi(2)).sum::<f64>() / (N * N) as f64;
            let b = weighted.iter().map(|(w, x)| w * x[k]).sum::<f64>() / total;
            let vb = weighted.iter().map(|(w, x)| (w * (x[k] - b)).powi(2)).sum::<f64>()
                / (total * total);
            let z = (a - b) / (va + vb).sqrt();
            assert!(z.abs() < 4.0, "moment {k}: {a} {b}, z = {z}");
            // Negative control: the plain law itself is far off in the squares.
            if k >= 4 {
                let plain = plain.second_moment()[(k - 3, k - 3)];
                assert!((a - plain).abs() > 20.0 * (va + vb).sqrt());
            }
        }
    }

    #[test]
    fn the_envelope_is_useful() {
        // Count uniforms through a wrapper: acceptance is draws over proposals.
        let twice = JacobianTwice::new(law()).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let (mut proposals, mut kept) = (0, 0);
        while kept < 10_000 {
            let q = twice.envelope.sample(&mut rng);
            let planar = q.i * q.i + q.j * q.j;
            let (s, t) = ((planar + q.k * q.k) / twice.sizes[0], planar / twice.sizes[1]);
            proposals += 1;
            kept += usize::from(
                rng.random::<f64>().powi(2) < s * t * libm::exp(2.0 - s - t)
                    && twice.law.in_mean_half(&q),
            );
        }
        assert!(proposals < 30_000, "{kept} of {proposals}");
    }
}
