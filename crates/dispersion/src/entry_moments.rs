//! Mean and covariance of the six entries of a random inertia, by quadrature or from the moments of the axes.

use gyradius_attitude::CentralMoments;
use gyradius_inertia::InertiaMatrix;
use nalgebra::{SMatrix, SVector, UnitQuaternion, Vector4};

use crate::SecondMomentStatistics;
use crate::quartic::{Means, Products, Quadratic, Quartic};
use crate::semidefinite::{Covariance, CovarianceError};

/// The entries in the order I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃.
pub(crate) const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// What is left of sums that cancel, as a part of what is summed.
pub(crate) const OF_SUMS: f64 = 512.0 * f64::EPSILON;

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
/// moments of degree up to 8 of the quaternion.
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

    /// The variances that arithmetic may leave of entries that do not vary. Directions are rounded, which tells in all entries by parts of the largest. And
    /// sums cancel, of terms K_k n_ki n_kj: for the parts of a direction |n_i n_j| ≤ √((1 − n_i²)(1 − n_j²)), so that Σ_k K_k |n_ki n_kj| ≤ √(I_ii I_jj),
    /// and what is left is a part of that, times the largest relative deviation: next to nothing in the small moment of a thin body.
    pub(crate) fn rounding(&self) -> [f64; 6] {
        const OF_DIRECTIONS: f64 = 64.0 * f64::EPSILON;
        // Of moments below it, relative deviations are rounding themselves.
        const SEEN: f64 = 1e-9;
        let c = self.covariance.diagonal();
        let size = self.mean.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let everywhere = OF_DIRECTIONS.powi(2) * (size * size + c.max());
        let seen = (0..3).filter(|&e| self.mean[e].abs() > SEEN * size);
        let relative = seen.map(|e| c[e] / self.mean[e] / self.mean[e]).fold(0.0, f64::max);
        ENTRIES.map(|(i, j)| everywhere + OF_SUMS * relative * (self.mean[i] * self.mean[j]).abs())
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

    /// About axes whose law has these moments.
    pub(crate) fn by_moments(axes: &CentralMoments, k: &SecondMomentStatistics) -> Self {
        let (means, spread) = (k.mean(), k.covariance());
        let Forms { fourth, of: forms } = Forms::about(axes);
        let expected = Means::new(axes);
        let mean: [f64; 6] =
            std::array::from_fn(|e| (0..3).map(|k| means[k] * expected.of(&forms[k][e])).sum());
        // Cov = E[ΔG ΔG] + Σ_kl Cov(K_k, K_l) E[M_k M_l], G = Σ_k E[K_k] M_k and ΔG = G less its mean. The mean is taken from the
        // coefficients, and times |q|⁴: so nothing is left along q itself, where the moments of narrow laws are large.
        let centred: [Quartic; 6] = std::array::from_fn(|e| {
            let less_mean = Quartic::ZERO.plus(-mean[e], &fourth);
            (0..3).fold(less_mean, |sum, k| sum.plus(means[k], &forms[k][e]))
        });
        let products = Products::new(axes);
        let against = products.against(&centred);
        let forms_against = forms.each_ref().map(|forms| products.against(forms));
        let mut covariance = SMatrix::zeros();
        for (e, f) in lower_triangle() {
            let mut sum = centred[e].dot(&against[f]);
            for k in 0..3 {
                for l in 0..3 {
                    sum += spread[(k, l)] * forms[k][e].dot(&forms_against[l][f]);
                }
            }
            covariance[(e, f)] = sum;
            covariance[(f, e)] = sum;
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

fn lower_triangle() -> impl Iterator<Item = (usize, usize)> {
    (0..6).flat_map(|e| (0..=e).map(move |f| (e, f)))
}

/// |q|⁴, and δ_ab|q|⁴ − r_ka r_kb for each k and entry ab: R(q) and δ in forms that are homogeneous in q.
struct Forms {
    fourth: Quartic,
    of: [[Quartic; 6]; 3],
}

impl Forms {
    fn about(axes: &CentralMoments) -> Self {
        let square = Quadratic::about(axes, Vector4::dot);
        let fourth = square.times(&square);
        let r: [[Quadratic; 3]; 3] = std::array::from_fn(|k| {
            std::array::from_fn(|a| Quadratic::about(axes, |u, v| rotation(u, v)[k][a]))
        });
        let of = std::array::from_fn(|k| {
            ENTRIES.map(|(a, b)| {
                let delta = if a == b { 1.0 } else { 0.0 };
                Quartic::ZERO.plus(delta, &fourth).plus(-1.0, &r[k][a].times(&r[k][b]))
            })
        });
        Self { fourth, of }
    }
}

/// The polar form of R(q): R at u = v, bilinear and symmetric.
fn rotation(u: &Vector4<f64>, v: &Vector4<f64>) -> [[f64; 3]; 3] {
    let square = |i: usize| u[i] * v[i];
    let twice = |i: usize, j: usize| u[i] * v[j] + u[j] * v[i];
    let [xx, yy, zz, ww] = [square(0), square(1), square(2), square(3)];
    let [xy, xz, yz] = [twice(0, 1), twice(0, 2), twice(1, 2)];
    let [xw, yw, zw] = [twice(0, 3), twice(1, 3), twice(2, 3)];
    [
        [xx - yy - zz + ww, xy - zw, xz + yw],
        [xy + zw, -xx + yy - zz + ww, yz - xw],
        [xz - yw, yz + xw, -xx - yy + zz + ww],
    ]
}

/// The expectation of δ_ab − r_ka r_kb for each k and entry ab.
pub(crate) fn expected_forms(axes: &CentralMoments) -> [[f64; 6]; 3] {
    let expected = Means::new(axes);
    Forms::about(axes).of.map(|forms| forms.map(|form| expected.of(&form)))
}

/// δ_ab − r_ka r_kb at a unit quaternion.
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
