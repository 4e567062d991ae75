//! Expectations of e^{aᵀx} Π x_i under a Gaussian, in closed form: E[e^{aᵀx} p(x)] = e^{aᵀx̄ + ½aᵀCa} E[p(x + Ca)].

use nalgebra::{SMatrix, SVector};

/// e^{aᵀx} times up to two of the coordinates.
pub(crate) struct GaussianMonomial<const N: usize> {
    exponents: [f64; N],
    factors: Vec<usize>,
}

impl<const N: usize> GaussianMonomial<N> {
    /// Exponents by coordinate, those that are not named being zero, and factors.
    pub(crate) fn new(exponents: &[(usize, f64)], factors: &[usize]) -> Self {
        let mut all = [0.0; N];
        for &(coordinate, exponent) in exponents {
            all[coordinate] += exponent;
        }
        Self { exponents: all, factors: factors.to_vec() }
    }
}

/// A monomial under N(mean, c): e^{aᵀx̄ + ½aᵀCa} E[p(x + Ca)].
struct Expected<'a, const N: usize> {
    monomial: &'a GaussianMonomial<N>,
    /// Ca.
    tilt: SVector<f64, N>,
    exponential: f64,
}

impl<'a, const N: usize> Expected<'a, N> {
    fn new(
        monomial: &'a GaussianMonomial<N>,
        mean: &SVector<f64, N>,
        c: &SMatrix<f64, N, N>,
    ) -> Self {
        let a = &monomial.exponents;
        let mut tilt = SVector::<f64, N>::zeros();
        for (column, &exponent) in c.column_iter().zip(a).filter(|(_, exponent)| **exponent != 0.0)
        {
            tilt += column * exponent;
        }
        let exponent: f64 = (0..N).map(|i| a[i] * (mean[i] + 0.5 * tilt[i])).sum();
        Self { monomial, tilt, exponential: libm::exp(exponent) }
    }

    fn mean(&self, mean: &SVector<f64, N>, c: &SMatrix<f64, N, N>) -> f64 {
        let factors: Vec<Factor> = self.factors(true, mean, &SVector::zeros()).collect();
        self.exponential * Product::of(&factors, c).all
    }

    /// Its factors, of which another monomial shifts the means.
    fn factors(
        &self,
        of_first: bool,
        mean: &SVector<f64, N>,
        shift: &SVector<f64, N>,
    ) -> impl Iterator<Item = Factor> {
        self.monomial.factors.iter().map(move |&place| Factor {
            place,
            mean: mean[place] + self.tilt[place],
            shift: shift[place],
            of_first,
        })
    }

    /// The covariance with another: e^{…a} e^{…b} (e^{aᵀCb} E[p q] − E[p] E[q]), each expectation about its own mean. What cancels
    /// is never added, so that the covariances of narrow laws keep their digits.
    fn covariance(&self, other: &Self, mean: &SVector<f64, N>, c: &SMatrix<f64, N, N>) -> f64 {
        let tie: f64 = (0..N).map(|i| self.monomial.exponents[i] * other.tilt[i]).sum();
        let own = self.factors(true, mean, &other.tilt);
        let factors: Vec<Factor> = own.chain(other.factors(false, mean, &self.tilt)).collect();
        let product = Product::of(&factors, c);
        let more = if tie == 0.0 { 0.0 } else { libm::expm1(tie) * product.all };
        self.exponential * other.exponential * (more + product.tied)
    }
}

/// A coordinate among the factors of p q.
#[derive(Clone, Copy)]
struct Factor {
    place: usize,
    /// Under the law by which the expectation of its own monomial is taken.
    mean: f64,
    /// What the other monomial adds to it in the expectation of both.
    shift: f64,
    /// It is one of p.
    of_first: bool,
}

/// E[p q] (Isserlis 1918, doi:10.1093/biomet/12.1-2.134).
struct Product {
    all: f64,
    /// The terms of it that tie p to q, by a shift or by a covariance across: E[p q] − E[p] E[q].
    tied: f64,
}

impl Product {
    /// Of four factors at most.
    fn of<const N: usize>(factors: &[Factor], c: &SMatrix<f64, N, N>) -> Self {
        let Some((first, rest)) = factors.split_first() else {
            return Self { all: 1.0, tied: 0.0 };
        };
        let others = Self::of(rest, c);
        let mut all = (first.mean + first.shift) * others.all;
        let mut tied = first.mean * others.tied + first.shift * others.all;
        for (i, other) in rest.iter().enumerate() {
            let mut left = [*first; 3];
            left[..i].copy_from_slice(&rest[..i]);
            left[i..rest.len() - 1].copy_from_slice(&rest[i + 1..]);
            let others = Self::of(&left[..rest.len() - 1], c);
            let covariance = c[(first.place, other.place)];
            all += covariance * others.all;
            let is_across = first.of_first != other.of_first;
            tied += covariance * if is_across { others.all } else { others.tied };
        }
        Self { all, tied }
    }
}

/// Mean and covariance of sums of monomials under N(mean, c).
pub(crate) fn moments<const N: usize, const M: usize>(
    sums: &[Vec<GaussianMonomial<N>>; M],
    mean: &SVector<f64, N>,
    c: &SMatrix<f64, N, N>,
) -> (SVector<f64, M>, SMatrix<f64, M, M>) {
    let expected = sums
        .each_ref()
        .map(|sum| sum.iter().map(|monomial| Expected::new(monomial, mean, c)).collect::<Vec<_>>());
    let means = SVector::from_fn(|e, _| expected[e].iter().map(|it| it.mean(mean, c)).sum());
    let mut covariance = SMatrix::<f64, M, M>::zeros();
    for e in 0..M {
        for f in 0..=e {
            let mut sum = 0.0;
            for a in &expected[e] {
                for b in &expected[f] {
                    sum += a.covariance(b, mean, c);
                }
            }
            covariance[(e, f)] = sum;
            covariance[(f, e)] = sum;
        }
    }
    (means, covariance)
}

/// Σ₁₁, Σ₂₂, Σ₃₃, Σ₁₂, Σ₁₃, Σ₂₃ of Σ = e^{2α} V Vᵀ, V upper triangular with exp(d₁), exp(d₂), exp(d₃) on its diagonal and
/// s₁₂, s₂₃, s₁₃ above, as sums of monomials: from the place of α, where there is one, and of d₁, from where the six
/// follow each other.
pub(crate) fn log_cholesky_entries<const N: usize>(
    alpha: Option<usize>,
    d: usize,
) -> [Vec<GaussianMonomial<N>>; 6] {
    let [s12, s23, s13] = [d + 3, d + 4, d + 5];
    let of = |own: [f64; 3], factors: &[usize]| {
        let size = alpha.map(|alpha| (alpha, 2.0));
        let each = own.into_iter().enumerate().map(|(i, exponent)| (d + i, exponent));
        let exponents: Vec<(usize, f64)> = size.into_iter().chain(each).collect();
        GaussianMonomial::new(&exponents, factors)
    };
    let none = [0.0; 3];
    [
        vec![of([2.0, 0.0, 0.0], &[]), of(none, &[s12, s12]), of(none, &[s13, s13])],
        vec![of([0.0, 2.0, 0.0], &[]), of(none, &[s23, s23])],
        vec![of([0.0, 0.0, 2.0], &[])],
        vec![of([0.0, 1.0, 0.0], &[s12]), of(none, &[s13, s23])],
        vec![of([0.0, 0.0, 1.0], &[s13])],
        vec![of([0.0, 0.0, 1.0], &[s23])],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix4, Vector4};
    use proptest::prelude::*;

    /// E[e^{aᵀx} Π x_i] by quadrature along the columns of a root of the covariance.
    fn by_quadrature(of: &GaussianMonomial<4>, mean: &Vector4<f64>, root: &Matrix4<f64>) -> f64 {
        // The nodes are the eigenvalues of the recursion's matrix (Golub & Welsch 1969, doi:10.1090/S0025-5718-69-99647-1).
        const NODES: usize = 12;
        let recursion = SMatrix::<f64, NODES, NODES>::from_fn(|i, j| {
            if i.abs_diff(j) == 1 { (i.max(j) as f64).sqrt() } else { 0.0 }
        });
        let eigen = recursion.symmetric_eigen();
        let node = |i: usize| (eigen.eigenvectors[(0, i)].powi(2), eigen.eigenvalues[i]);
        let mut sum = 0.0;
        for n in 0..NODES.pow(4) {
            let each: [(f64, f64); 4] =
                std::array::from_fn(|k| node(n / NODES.pow(k as u32) % NODES));
            let x = mean + root * Vector4::from(each.map(|(_, z)| z));
            let exponent: f64 = (0..4).map(|i| of.exponents[i] * x[i]).sum();
            let factors: f64 = of.factors.iter().map(|i| x[*i]).product();
            sum += each.map(|(w, _)| w).iter().product::<f64>() * exponent.exp() * factors;
        }
        sum
    }

    /// An exponent and the factors of each of two monomials.
    fn parts() -> impl Strategy<Value = (Vec<(usize, f64)>, Vec<Vec<usize>>)> {
        let exponent = (0..4_usize, prop::sample::select(vec![0.0, 1.0, 2.0]));
        let factors = prop::collection::vec(0..4_usize, 0..=2);
        (prop::collection::vec(exponent, 2), prop::collection::vec(factors, 2))
    }

    fn monomials(exponents: &[(usize, f64)], factors: &[Vec<usize>]) -> [GaussianMonomial<4>; 2] {
        std::array::from_fn(|k| GaussianMonomial::new(&exponents[k..=k], &factors[k]))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Means and covariances, of wide laws and narrow ones, of monomials with and without exponents and factors.
        #[test]
        fn moments_are_those_of_quadrature(
            mean in prop::array::uniform4(-1.0..1.0_f64),
            root in prop::array::uniform16(-0.4..0.4_f64),
            narrow in 0.0..4.0_f64,
            (exponents, factors) in parts(),
        ) {
            let root = Matrix4::from_row_slice(&root) * 10_f64.powf(-narrow);
            let (mean, c) = (Vector4::from(mean), root * root.transpose());
            let all = monomials(&exponents, &factors);
            let first = all.each_ref().map(|one| by_quadrature(one, &mean, &root));
            let (means, covariance) = moments(&all.map(|one| vec![one]), &mean, &c);
            let size = first[0].abs().max(1e-3) * first[1].abs().max(1e-3);
            for i in 0..2 {
                prop_assert!((means[i] - first[i]).abs() < 1e-9 * first[i].abs().max(1.0), "{i}");
                for j in 0..2 {
                    let exponents = [exponents[i], exponents[j]];
                    let of_both = GaussianMonomial::new(&exponents, &[&factors[i][..], &factors[j]].concat());
                    let both = by_quadrature(&of_both, &mean, &root);
                    let gap = covariance[(i, j)] - (both - first[i] * first[j]);
                    prop_assert!(gap.abs() < 1e-8 * both.abs().max(size).max(1e-3), "{i} {j}: {gap:e}");
                }
            }
        }
    }

    proptest! {
        /// Those of the derivatives, in the limit. The difference of two expectations would have no digit left.
        #[test]
        fn covariances_of_narrow_laws_keep_their_digits(
            mean in prop::array::uniform4(0.1..1.0_f64),
            root in prop::array::uniform16(-0.4..0.4_f64),
            narrow in 9.0..100.0_f64,
            (exponents, factors) in parts(),
        ) {
            let root = Matrix4::from_row_slice(&root) * 10_f64.powf(-narrow);
            let (mean, c) = (Vector4::from(mean), root * root.transpose());
            let all = monomials(&exponents, &factors);
            let derivatives = all.each_ref().map(|one| {
                let exponent: f64 = (0..4).map(|i| one.exponents[i] * mean[i]).sum();
                let value = exponent.exp() * one.factors.iter().map(|i| mean[*i]).product::<f64>();
                Vector4::from_fn(|i, _| {
                    let power = one.factors.iter().filter(|factor| **factor == i).count() as f64;
                    value * (one.exponents[i] + power / mean[i])
                })
            });
            let (_, covariance) = moments(&all.map(|one| vec![one]), &mean, &c);
            for i in 0..2 {
                for j in 0..2 {
                    let parts = (root.transpose() * derivatives[i]).norm() * (root.transpose() * derivatives[j]).norm();
                    let gap = covariance[(i, j)] - (derivatives[i].transpose() * c * derivatives[j])[0];
                    prop_assert!(gap.abs() <= 1e-12 * parts, "{i} {j}: {gap:e} of {parts:e}");
                }
            }
        }
    }
}
