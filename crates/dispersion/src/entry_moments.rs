//! Mean and covariance of the six entries of a random inertia, by quadrature or contour integrals.

use gyradius_inertia::InertiaMatrix;
use nalgebra::{Complex, Matrix3, SMatrix, SVector, UnitQuaternion};

use crate::SecondMomentStatistics;
use crate::semidefinite::{Covariance, CovarianceError};

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
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
pub struct EntryMoments {
    /// E I₁₁, E I₂₂, E I₃₃, E I₁₂, E I₁₃, E I₂₃, kg·m².
    #[getset(get_copy = "pub")]
    mean: [f64; 6],
    /// Covariance of the six entries, (kg·m²)².
    #[getset(get = "pub")]
    covariance: SMatrix<f64, 6, 6>,
}

impl EntryMoments {
    /// A given mean in kg·m² and covariance in (kg·m²)².
    ///
    /// # Errors
    /// A mean is not finite or larger than 1e152 kg·m², or the covariance is not finite, symmetric and
    /// positive semidefinite.
    pub fn new(mean: [f64; 6], covariance: SMatrix<f64, 6, 6>) -> Result<Self, EntryMomentsError> {
        if let Some(i) = mean.iter().position(|x| !(x.abs() <= 1e152)) {
            return Err(EntryMomentsError::Mean {
                entry: InertiaMatrix::ENTRY_NAMES[i],
                value: mean[i],
            });
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
            let centred: [f64; 6] = std::array::from_fn(|e| entries[e] - mean[e]);
            let mut sums = [0.0; 21];
            for (n, (e, f)) in lower_triangle().enumerate() {
                let own = |k: usize| {
                    (0..3).map(|l| spread[(k, l)] * forms[l][f]).sum::<f64>() * forms[k][e]
                };
                sums[n] = centred[e] * centred[f] + own(0) + own(1) + own(2);
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
            let centred: [C64; 6] = std::array::from_fn(|e| entries[e] - fourth * mean[e]);
            let mut sums = [C64::new(0.0, 0.0); POLYNOMIALS];
            for (n, (e, f)) in lower_triangle().enumerate() {
                sums[2 * n] = centred[e] * centred[f];
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

    /// Of the same inertia multiplied by an independent random factor x of mean one and this variance, as
    /// where an uncertain mass scales the whole body: Cov(xI) = (1 + Var x) Cov I + Var x · E I E Iᵀ. A
    /// variance below zero counts as zero.
    #[must_use]
    pub fn times_factor(&self, variance: f64) -> Self {
        let variance = variance.max(0.0);
        let mean = SVector::<f64, 6>::from(self.mean);
        let covariance = self.covariance * (1.0 + variance) + mean * mean.transpose() * variance;
        Self { mean: self.mean, covariance }
    }

    /// Standard deviations of the six entries, kg·m².
    #[must_use]
    pub fn deviations(&self) -> [f64; 6] {
        // Rounding may leave a variance of zero a hair below it.
        let variances: SVector<f64, 6> = self.covariance.diagonal();
        std::array::from_fn(|e| variances[e].max(0.0).sqrt())
    }
}

crate::written!(
    EntryMoments,
    |moments| {
        mean: [f64; 6] = moments.mean,
        covariance: SMatrix<f64, 6, 6> = moments.covariance,
    },
    {
        let [i11, i22, i33, i12, i13, i23] = mean;
        InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23])?;
        EntryMoments { mean, covariance: crate::semidefinite::computed(covariance)? }
    }
);

/// The rows of a symmetric matrix of entries.
pub(crate) fn rows([i11, i22, i33, i12, i13, i23]: [f64; 6]) -> [[f64; 3]; 3] {
    [[i11, i12, i13], [i12, i22, i23], [i13, i23, i33]]
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

/// Their expectations, for each k.
pub(crate) fn expected_forms(law: &impl Polynomials) -> [[f64; 6]; 3] {
    let expected: [f64; FORMS] = law.expect(forms);
    std::array::from_fn(|k| std::array::from_fn(|e| expected[6 * k + e]))
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
pub(crate) mod tests;
