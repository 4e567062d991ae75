use gyradius_attitude::RadiallyConstrainedGaussian;
use nalgebra::{Complex, SMatrix, SVector};

use crate::{GaussianRoots, PrincipalDispersion};

type C64 = Complex<f64>;

/// The entries in the order I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
/// An entry is Σ_k K_k M_k with eighteen quadratic forms M of the axes.
const FORMS: usize = 18;
/// Entries of a symmetric 6×6 matrix, each as two sums.
const POLYNOMIALS: usize = 2 * 21;

/// Mean and covariance of the six entries I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ of a random inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct EntryMoments {
    mean: [f64; 6],
    covariance: SMatrix<f64, 6, 6>,
}

impl EntryMoments {
    /// Of Gaussian roots about axes from a radially constrained Gaussian, by quadrature.
    ///
    /// An entry is I_ab = Σ_k K_k(δ_ab − r_ka r_kb) with r_k the k-th row of R(q), so its second
    /// moments are polynomials of degree 8 in the quaternion, of which the attitude law knows the
    /// expectations to machine precision; those of K are in closed form.
    #[must_use]
    pub fn of(law: &PrincipalDispersion<GaussianRoots, RadiallyConstrainedGaussian>) -> Self {
        let means = law.roots().second_moment_means();
        let variances = law.roots().second_moment_variances();
        // Σ_k E[K_k] M_k for each entry.
        let entries = |forms: &[C64; FORMS]| -> [C64; 6] {
            std::array::from_fn(|e| (0..3).map(|k| forms[6 * k + e] * means[k]).sum())
        };
        let mean: [f64; 6] = law.axes().expect(|x| entries(&forms(x)));
        // Cov = E[ΔG ΔG] + Σ_k Var K_k E[M_k M_k], ΔG the entries above less their means. Taken
        // before the expectation and homogeneous in x, which is not of unit length where it is
        // evaluated: so narrow laws lose no digits.
        let sums: [f64; POLYNOMIALS] = law.axes().expect(|x| {
            let forms = forms(x);
            let entries = entries(&forms);
            let fourth = norm_squared(x) * norm_squared(x);
            let centered: [C64; 6] = std::array::from_fn(|e| entries[e] - fourth * mean[e]);
            let mut sums = [C64::new(0.0, 0.0); POLYNOMIALS];
            for (n, (e, f)) in lower_triangle().enumerate() {
                sums[2 * n] = centered[e] * centered[f];
                sums[2 * n + 1] =
                    (0..3).map(|k| forms[6 * k + e] * forms[6 * k + f] * variances[k]).sum();
            }
            sums
        });
        let mut covariance = SMatrix::zeros();
        for (n, (e, f)) in lower_triangle().enumerate() {
            covariance[(e, f)] = sums[2 * n] + sums[2 * n + 1];
            covariance[(f, e)] = covariance[(e, f)];
        }
        Self { mean, covariance }
    }

    /// E I₁₁, E I₂₂, E I₃₃, E I₁₂, E I₁₃, E I₂₃, kg·m².
    #[must_use]
    pub fn mean(&self) -> [f64; 6] {
        self.mean
    }

    /// Covariance of the six entries, (kg·m²)².
    #[must_use]
    pub fn covariance(&self) -> &SMatrix<f64, 6, 6> {
        &self.covariance
    }

    /// Standard deviations of the six entries, kg·m².
    #[must_use]
    pub fn deviations(&self) -> [f64; 6] {
        // Rounding may leave a variance of zero a hair below it.
        let variances: SVector<f64, 6> = self.covariance.diagonal();
        std::array::from_fn(|e| variances[e].max(0.0).sqrt())
    }
}

fn lower_triangle() -> impl Iterator<Item = (usize, usize)> {
    (0..6).flat_map(|e| (0..=e).map(move |f| (e, f)))
}

fn norm_squared(q: &[C64; 4]) -> C64 {
    q.iter().map(|x| x * x).sum()
}

/// δ_ab − r_ka r_kb for each k and entry ab, R(q) and δ in forms that are homogeneous in q.
fn forms(q: &[C64; 4]) -> [C64; FORMS] {
    let [x, y, z, w] = *q;
    let two = 2.0;
    let fourth = norm_squared(q) * norm_squared(q);
    let r = [
        [x * x - y * y - z * z + w * w, (x * y - z * w) * two, (x * z + y * w) * two],
        [(x * y + z * w) * two, -x * x + y * y - z * z + w * w, (y * z - x * w) * two],
        [(x * z - y * w) * two, (y * z + x * w) * two, -x * x - y * y + z * z + w * w],
    ];
    std::array::from_fn(|i| {
        let (k, (a, b)) = (i / 6, ENTRIES[i % 6]);
        let delta = if a == b { fourth } else { C64::new(0.0, 0.0) };
        delta - r[k][a] * r[k][b]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_inertia::{Inertia, InertiaMatrix};
    use nalgebra::{Matrix4, Vector4};
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    type Law = PrincipalDispersion<GaussianRoots, RadiallyConstrainedGaussian>;

    fn law(moments: [f64; 3], products: [f64; 3], roots: [f64; 3], axes: [f64; 4]) -> Law {
        let nominal =
            Inertia::try_from(InertiaMatrix::from_entries(moments, products).unwrap()).unwrap();
        PrincipalDispersion::new(
            GaussianRoots::new(nominal.second_moments().roots(), roots).unwrap(),
            RadiallyConstrainedGaussian::new(
                nominal.principal_axes().attitude(),
                Matrix4::from_diagonal(&Vector4::from(axes)),
            )
            .unwrap(),
        )
    }

    /// The law as derived for the paper's two bodies; deviations by an independent program (mpmath,
    /// contour integrals of the quaternion's moments to order 8).
    #[test]
    fn the_papers_bodies() {
        let axes = [2e-5, 6e-4, 6e-4, 0.6];
        let payload = law([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0], [0.125, 0.1, 0.075], axes);
        let stage =
            law([6700.0, 6700.0, 2000.0], [0.0, 20.0, -20.0], [0.0067, 0.0067, 0.002], axes);
        let expected = [
            (
                payload,
                [41.86007876, 37.54040342, 36.59555016, 49.29484652, 97.53376284, 20.7884269],
            ),
            (stage, [15.76387505, 8.23097277, 17.70178099, 7.19674534, 212.60515298, 96.33842351]),
        ];
        for (law, deviations) in expected {
            for (found, expected) in EntryMoments::of(&law).deviations().iter().zip(deviations) {
                assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
            }
        }
    }

    #[test]
    fn draws_agree() {
        const N: usize = 200_000;
        let law = law([5.0, 4.0, 3.0], [0.3, 0.2, -0.5], [0.3, 0.1, 0.05], [0.02, 0.1, 0.3, 0.8]);
        let moments = EntryMoments::of(&law);
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let draws: Vec<[f64; 6]> = (0..N)
            .map(|_| {
                let body: Inertia = law.sample(&mut rng);
                body.entries()
            })
            .collect();
        let n = N as f64;
        for e in 0..6 {
            let mean = draws.iter().map(|d| d[e]).sum::<f64>() / n;
            let z = (mean - moments.mean()[e]) / (moments.covariance()[(e, e)] / n).sqrt();
            assert!(z.abs() < 4.0, "mean {e}: z = {z}");
            for f in 0..=e {
                let products: Vec<f64> = draws
                    .iter()
                    .map(|d| (d[e] - moments.mean()[e]) * (d[f] - moments.mean()[f]))
                    .collect();
                let mean = products.iter().sum::<f64>() / n;
                let variance = products.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / n;
                let z = (mean - moments.covariance()[(e, f)]) / (variance / n).sqrt();
                assert!(z.abs() < 4.0, "covariance {e}{f}: z = {z}");
            }
        }
    }

    /// Narrow laws: to first order a small turn δ of the axes moves I by [δ×]I − I[δ×], so that
    /// the products vary by the differences of the moments and the moments hardly at all.
    #[test]
    fn narrow_laws_keep_their_digits() {
        for variance in [1e-4_f64, 1e-6, 1e-8, 1e-10] {
            let law = law([5.0, 4.0, 3.0], [0.0; 3], [0.0; 3], [variance, variance, variance, 1.0]);
            let deviations = EntryMoments::of(&law).deviations();
            // Body rotations are twice the quaternion's vector part.
            let turn = 2.0 * variance.sqrt();
            for (found, expected) in deviations[3..].iter().zip([1.0, 2.0, 1.0]) {
                let error = found / (turn * expected) - 1.0;
                assert!(error.abs() < 20.0 * variance + 1e-6, "{variance:e}: {error:e}");
            }
            // I11 loses δ₃² + 2 δ₂², of deviation √(2 + 8) times the variance of a turn.
            let error = deviations[0] / (10.0_f64.sqrt() * turn * turn) - 1.0;
            assert!(error.abs() < 20.0 * variance + 1e-6, "{variance:e}: {error:e}");
        }
    }

    /// Without any spread of the axes, only the moments vary.
    #[test]
    fn fixed_axes_leave_the_closed_form() {
        let law = law([5.0, 4.0, 3.0], [0.0; 3], [0.1, 0.2, 0.3], [1e-13; 4]);
        let moments = EntryMoments::of(&law);
        let [v1, v2, v3] = law.roots().second_moment_variances();
        let expected = [v2 + v3, v1 + v3, v1 + v2];
        for (found, expected) in moments.deviations().iter().zip(expected) {
            assert!((found * found - expected).abs() < 1e-9, "{found} {expected}");
        }
        assert!((moments.covariance()[(0, 1)] - v3).abs() < 1e-9);
    }
}
