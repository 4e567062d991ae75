use nalgebra::{Complex, Matrix3, SMatrix, SVector, UnitQuaternion};

use crate::semidefinite::{Covariance, CovarianceError};
use crate::{AttitudeMoments, PrincipalDispersion, RootMoments, SecondMomentStatistics};

type C64 = Complex<f64>;

/// The entries in the order I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃.
pub(crate) const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
/// An entry is Σ_k K_k M_k with eighteen quadratic forms M of the axes.
const FORMS: usize = 18;
/// Entries of a symmetric 6×6 matrix, each as two sums.
const POLYNOMIALS: usize = 2 * 21;

/// A law of attitudes that knows the expectations of polynomials in the quaternion, of degree up to 8.
pub(crate) trait Polynomials {
    /// The polynomials are evaluated at complex points that are not of unit length.
    fn expect<const N: usize>(&self, polynomials: impl Fn(&[C64; 4]) -> [C64; N]) -> [f64; N];
}

/// A law of attitudes that can take means of real functions.
pub(crate) trait Expectation {
    fn expect<const N: usize>(
        &self,
        functions: impl FnMut(&UnitQuaternion<f64>) -> [f64; N],
    ) -> [f64; N];
}

/// Nodes with weights.
struct Nodes<I>(I);

impl<I: IntoIterator<Item = (f64, UnitQuaternion<f64>)> + Clone> Expectation for Nodes<I> {
    fn expect<const N: usize>(
        &self,
        mut functions: impl FnMut(&UnitQuaternion<f64>) -> [f64; N],
    ) -> [f64; N] {
        let mut total = 0.0;
        let mut sums = [0.0; N];
        for (weight, q) in self.0.clone() {
            total += weight;
            for (sum, value) in sums.iter_mut().zip(functions(&q)) {
                *sum += weight * value;
            }
        }
        sums.map(|sum| sum / total)
    }
}

/// Mean and covariance of the six entries I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ of a random inertia.
///
/// An entry is I_ab = Σ_k K_k (δ_ab − r_ka r_kb) with r_k the k-th row of R(q). K and q being
/// independent, its moments need no more than the mean and covariance of K and, of the law of q,
/// expectations of degree 4 and 8 in the quaternion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct EntryMoments {
    mean: [f64; 6],
    covariance: SMatrix<f64, 6, 6>,
}

impl EntryMoments {
    /// Of any roots with known moments about axes from any law with known moments, by quadrature.
    #[must_use]
    pub fn of<K: RootMoments, A: AttitudeMoments>(law: &PrincipalDispersion<K, A>) -> Self {
        law.axes().entry_moments(&law.roots().second_moment_statistics())
    }

    /// A given mean in kg·m² and covariance in (kg·m²)².
    ///
    /// # Errors
    /// A mean is not finite or larger than 1e152 kg·m², or the covariance is not finite, symmetric and
    /// positive semidefinite.
    pub fn new(mean: [f64; 6], covariance: SMatrix<f64, 6, 6>) -> Result<Self, EntryMomentsError> {
        if let Some(i) = mean.iter().position(|x| !(x.abs() <= 1e152)) {
            return Err(EntryMomentsError::Mean { entry: NAMES[i], value: mean[i] });
        }
        Ok(Self { mean, covariance: *Covariance::new(covariance, 1e304)?.matrix() })
    }

    pub(crate) fn unchecked(mean: [f64; 6], covariance: SMatrix<f64, 6, 6>) -> Self {
        Self { mean, covariance }
    }

    /// Of second moments with the given mean and covariance, about axes from a law that is given by
    /// nodes and weights: a quadrature rule times the density, or weighted draws. Weights need not sum
    /// to one. The nodes are gone through twice, so that small covariances keep their digits.
    #[must_use]
    pub fn by_quadrature(
        k: &SecondMomentStatistics,
        nodes: impl IntoIterator<Item = (f64, UnitQuaternion<f64>)> + Clone,
    ) -> Self {
        Self::by_expectation(k, &Nodes(nodes))
    }

    pub(crate) fn by_expectation(k: &SecondMomentStatistics, law: &impl Expectation) -> Self {
        let means = k.mean();
        let spread = k.covariance();
        let entries = |forms: &[[f64; 6]; 3]| -> [f64; 6] {
            std::array::from_fn(|e| (0..3).map(|k| means[k] * forms[k][e]).sum())
        };
        let mean: [f64; 6] = law.expect(|q| entries(&real_forms(q)));
        let sums: [f64; 21] = law.expect(|q| {
            let forms = real_forms(q);
            let entries = entries(&forms);
            let centered: [f64; 6] = std::array::from_fn(|e| entries[e] - mean[e]);
            let mut sums = [0.0; 21];
            for (n, (e, f)) in lower_triangle().enumerate() {
                let own = |k: usize| {
                    (0..3).map(|l| spread[(k, l)] * forms[l][f]).sum::<f64>() * forms[k][e]
                };
                sums[n] = centered[e] * centered[f] + own(0) + own(1) + own(2);
            }
            sums
        });
        let mut covariance = SMatrix::zeros();
        for (n, (e, f)) in lower_triangle().enumerate() {
            covariance[(e, f)] = sums[n];
            covariance[(f, e)] = sums[n];
        }
        Self { mean, covariance }
    }

    pub(crate) fn by_polynomials(law: &impl Polynomials, k: &SecondMomentStatistics) -> Self {
        let means = k.mean();
        let variances = k.variances();
        let correlated = off_diagonal(k.covariance());
        // Σ_k E[K_k] M_k for each entry.
        let entries = |forms: &[C64; FORMS]| -> [C64; 6] {
            std::array::from_fn(|e| (0..3).map(|k| forms[6 * k + e] * means[k]).sum())
        };
        let mean: [f64; 6] = law.expect(|x| entries(&forms(x)));
        // Cov = E[ΔG ΔG] + Σ_kl Cov(K_k, K_l) E[M_k M_l], ΔG the entries above less their means. Taken
        // before the expectation and homogeneous in x, which is not of unit length where it is
        // evaluated: so narrow laws lose no digits.
        let sums: [f64; POLYNOMIALS] = law.expect(|x| {
            let forms = forms(x);
            let entries = entries(&forms);
            let fourth = norm_squared(x) * norm_squared(x);
            let centered: [C64; 6] = std::array::from_fn(|e| entries[e] - fourth * mean[e]);
            let mut sums = [C64::new(0.0, 0.0); POLYNOMIALS];
            for (n, (e, f)) in lower_triangle().enumerate() {
                sums[2 * n] = centered[e] * centered[f];
                sums[2 * n + 1] =
                    (0..3).map(|k| forms[6 * k + e] * forms[6 * k + f] * variances[k]).sum();
                for &(k, l, c) in correlated.iter().flatten() {
                    let (k, l) = (6 * k, 6 * l);
                    sums[2 * n + 1] +=
                        (forms[k + e] * forms[l + f] + forms[l + e] * forms[k + f]) * c;
                }
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

/// Why numbers are not a mean and a covariance of entries.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EntryMomentsError {
    /// A mean is not finite or too large.
    #[error("mean of {entry} = {value:?} kg·m²: it must be finite and at most 1e152 in magnitude")]
    Mean {
        /// Which entry: I11, I22, I33, I12, I13 or I23.
        entry: &'static str,
        /// The mean, kg·m².
        value: f64,
    },
    /// The covariance is none.
    #[error(transparent)]
    Covariance(#[from] CovarianceError),
}

/// Names of the entries, in order.
pub(crate) const NAMES: [&str; 6] = ["I11", "I22", "I33", "I12", "I13", "I23"];

/// The covariances that are not zero.
fn off_diagonal(c: &Matrix3<f64>) -> [Option<(usize, usize, f64)>; 3] {
    [(0, 1), (0, 2), (1, 2)].map(|(k, l)| (c[(k, l)] != 0.0).then_some((k, l, c[(k, l)])))
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

/// The same at a unit quaternion.
pub(crate) fn real_forms(q: &UnitQuaternion<f64>) -> [[f64; 6]; 3] {
    let r = q.to_rotation_matrix();
    let r = r.matrix();
    std::array::from_fn(|k| {
        ENTRIES.map(|(a, b)| {
            let delta = if a == b { 1.0 } else { 0.0 };
            delta - r[(k, a)] * r[(k, b)]
        })
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{
        AxesLaw, CorrelatedRoots, FixedAttitude, GaussianRoots, JacobianTwice, LognormalRoots,
        UniformRoots,
    };
    use gyradius_attitude::{
        FisherBingham, MeanHalf, RadiallyConstrainedGaussian, UniformAttitude,
    };
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

    /// Mean and covariance of the entries against draws, to |z| < 4.
    pub(crate) fn check_entries<T: Into<InertiaMatrix>>(
        what: &str,
        moments: &EntryMoments,
        law: &impl Distribution<T>,
        seed: u64,
    ) {
        const N: usize = 100_000;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let draws: Vec<[f64; 6]> = (0..N).map(|_| law.sample(&mut rng).into().entries()).collect();
        let n = N as f64;
        let size = moments.mean().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        for e in 0..6 {
            let mean = draws.iter().map(|d| d[e]).sum::<f64>() / n;
            let gap = mean - moments.mean()[e];
            let z = gap / (moments.covariance()[(e, e)].max(0.0) / n).sqrt();
            assert!(z.abs() < 4.0 || gap.abs() <= 1e-12 * size, "{what}: mean {e}: z = {z}");
            for f in 0..=e {
                let products: Vec<f64> = draws
                    .iter()
                    .map(|d| (d[e] - moments.mean()[e]) * (d[f] - moments.mean()[f]))
                    .collect();
                let mean = products.iter().sum::<f64>() / n;
                let variance = products.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / n;
                let gap = mean - moments.covariance()[(e, f)];
                let z = gap / (variance / n).sqrt();
                let small = gap.abs() <= 1e-14 * size * size;
                assert!(z.abs() < 4.0 || small, "{what}: covariance {e}{f}: z = {z}");
            }
        }
    }

    /// Every kind of roots about every kind of axes.
    #[test]
    fn draws_agree_for_every_combination() {
        let wide = law([5.0, 4.0, 3.0], [0.3, 0.2, -0.5], [0.3, 0.1, 0.05], [0.02, 0.1, 0.3, 0.8]);
        let k = wide.roots().mean();
        let spread = nalgebra::Vector3::new(0.3, 0.2, 0.1);
        let roots: [crate::RootLaw; 4] = [
            (*wide.roots()).into(),
            CorrelatedRoots::new(k, spread * spread.transpose()).unwrap().into(),
            UniformRoots::from_variances(k, [0.3, 0.1, 0.05]).unwrap().into(),
            LognormalRoots::new(k, [0.3, 0.1, 0.05]).unwrap().into(),
        ];
        let rcg = wide.axes();
        let axes: [AxesLaw; 5] = [
            rcg.clone().into(),
            MeanHalf::new(rcg.clone()).into(),
            JacobianTwice::new(rcg.clone()).unwrap().into(),
            UniformAttitude.into(),
            FixedAttitude::new(rcg.mean()).into(),
        ];
        for (i, roots) in roots.iter().enumerate() {
            for (j, axes) in axes.iter().enumerate() {
                let law = PrincipalDispersion::new(roots.clone(), axes.clone());
                let seed = 600 + (10 * i + j) as u64;
                check_entries::<Inertia>(&format!("{i} {j}"), &EntryMoments::of(&law), &law, seed);
            }
        }
    }

    /// Half spheres with much at their edge, and a ridge that only the second way finds.
    #[test]
    fn wide_halves() {
        for (i, axes) in [[1.0, 1.0, 1.0, 1.0], [0.01, 0.01, 0.6, 0.1], [1e-4, 1e-2, 1.0, 100.0]]
            .iter()
            .enumerate()
        {
            let whole = law([5.0, 4.0, 3.0], [0.3, 0.2, -0.5], [0.01; 3], *axes);
            let half = MeanHalf::new(whole.axes().clone());
            let law = PrincipalDispersion::new(*whole.roots(), half);
            let seed = 650 + i as u64;
            check_entries::<Inertia>("half", &EntryMoments::of(&law), &law, seed);
        }
    }

    /// A law that has no mean attitude, and its uniform limit.
    #[test]
    fn fisher_bingham_axes() {
        let roots = GaussianRoots::new(
            gyradius_inertia::RootSecondMoments::new([1.0, 1.2, 0.5]).unwrap(),
            [0.01, 0.02, 0.0],
        )
        .unwrap();
        let precision = Matrix4::from_diagonal(&Vector4::new(1.0, -3.0, 2.0, 0.5));
        let axes = FisherBingham::new(precision, Vector4::new(0.3, 0.1, -0.5, 1.0)).unwrap();
        let law = PrincipalDispersion::new(roots, axes);
        check_entries::<Inertia>("Fisher-Bingham", &EntryMoments::of(&law), &law, 71);

        let flat = FisherBingham::new(Matrix4::zeros(), Vector4::zeros()).unwrap();
        let flat = EntryMoments::of(&PrincipalDispersion::new(roots, flat));
        let uniform = EntryMoments::of(&PrincipalDispersion::new(roots, UniformAttitude));
        for e in 0..6 {
            assert!((flat.mean()[e] - uniform.mean()[e]).abs() < 1e-12);
        }
        assert!((flat.covariance() - uniform.covariance()).amax() < 1e-12);
    }

    /// The half by cubature and the whole by contour are the same where the other half is empty.
    #[test]
    fn half_and_whole_agree_where_they_are_the_same() {
        let narrow =
            law([5.0, 4.0, 3.0], [0.3, 0.2, -0.5], [0.3, 0.1, 0.05], [1e-3, 2e-3, 4e-3, 0.01]);
        let k = narrow.roots().second_moment_statistics();
        let whole = narrow.axes().entry_moments(&k);
        let nodes = super_nodes(narrow.axes());
        let half = EntryMoments::by_quadrature(&k, nodes.iter().copied());
        let error = (whole.covariance() - half.covariance()).amax() / whole.covariance().amax();
        assert!(error < 0.02, "{error:e}");
        // And the law's own choice is the contour, to the bit.
        assert_eq!(MeanHalf::new(narrow.axes().clone()).entry_moments(&k), whole);
    }

    /// Weighted draws: a crude quadrature of a user's own.
    fn super_nodes(law: &RadiallyConstrainedGaussian) -> Vec<(f64, UnitQuaternion<f64>)> {
        let mut rng = ChaCha8Rng::seed_from_u64(72);
        (0..100_000).map(|_| (2.0, law.sample(&mut rng))).collect()
    }

    #[test]
    fn bad_moments_are_named() {
        let zero = SMatrix::<f64, 6, 6>::zeros();
        let error = EntryMoments::new([1.0, 1.0, 1.0, f64::NAN, 0.0, 0.0], zero).unwrap_err();
        assert!(error.to_string().contains("I12"), "{error}");
        let mut bad = zero;
        bad[(4, 4)] = -1.0;
        let error = EntryMoments::new([1.0; 6], bad).unwrap_err();
        assert!(error.to_string().contains("(5, 5)"), "{error}");
        assert!(EntryMoments::new([1.0; 6], zero).is_ok());
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
