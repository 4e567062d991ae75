//! Expectations of e^{aᵀx} Π x_i under a Gaussian, in closed form: E[e^{aᵀx} p(x)] = e^{aᵀx̄ + ½aᵀCa} E[p(x + Ca)].

use nalgebra::{SMatrix, SVector};

/// e^{aᵀx} times up to four of the coordinates.
#[derive(Clone, Copy)]
pub(crate) struct GaussianMonomial<const N: usize> {
    exponents: [f64; N],
    factors: [usize; 4],
    length: usize,
}

impl<const N: usize> GaussianMonomial<N> {
    /// Exponents by coordinate, those that are not named being zero, and factors.
    pub(crate) fn new(exponents: &[(usize, f64)], of: &[usize]) -> Self {
        let mut factors = [0; 4];
        factors[..of.len()].copy_from_slice(of);
        let mut all = [0.0; N];
        for &(coordinate, exponent) in exponents {
            all[coordinate] += exponent;
        }
        Self { exponents: all, factors, length: of.len() }
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut product = *self;
        for (a, b) in product.exponents.iter_mut().zip(other.exponents) {
            *a += b;
        }
        for &factor in &other.factors[..other.length] {
            product.factors[product.length] = factor;
            product.length += 1;
        }
        product
    }

    fn factors(&self) -> &[usize] {
        &self.factors[..self.length]
    }
}

/// A monomial under N(mean, c): e^{aᵀx̄ + ½aᵀCa} E[p(x + Ca)].
struct Expected<'a, const N: usize> {
    monomial: &'a GaussianMonomial<N>,
    /// Ca.
    tilt: SVector<f64, N>,
    exponential: f64,
    product: f64,
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
        let product = gaussian_product(monomial.factors(), &(mean + tilt), c);
        Self { monomial, tilt, exponential: libm::exp(exponent), product }
    }

    fn mean(&self) -> f64 {
        self.exponential * self.product
    }

    /// The covariance with another: e^{…a} e^{…b} (e^{aᵀCb} E[p q] − E[p] E[q]), each expectation about its own mean. What is constant
    /// cancels, and of narrow laws the difference of the exponential from one keeps its digits.
    fn covariance(&self, other: &Self, mean: &SVector<f64, N>, c: &SMatrix<f64, N, N>) -> f64 {
        let tie: f64 = (0..N).map(|i| self.monomial.exponents[i] * other.tilt[i]).sum();
        let both = match [self.monomial.factors(), other.monomial.factors()] {
            [[], []] => 1.0,
            _ => {
                let both = self.monomial.times(other.monomial);
                gaussian_product(both.factors(), &(mean + self.tilt + other.tilt), c)
            }
        };
        let more = if tie == 0.0 { 0.0 } else { libm::expm1(tie) * both };
        self.exponential * other.exponential * (more + (both - self.product * other.product))
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
    let means = SVector::from_fn(|e, _| expected[e].iter().map(Expected::mean).sum());
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

/// E Π x_i over the listed coordinates, x ~ N(mean, c) (Isserlis 1918, doi:10.1093/biomet/12.1-2.134).
fn gaussian_product<const N: usize>(
    factors: &[usize],
    mean: &SVector<f64, N>,
    c: &SMatrix<f64, N, N>,
) -> f64 {
    let Some((&first, rest)) = factors.split_first() else {
        return 1.0;
    };
    let mut sum = mean[first] * gaussian_product(rest, mean, c);
    for (i, &other) in rest.iter().enumerate() {
        // All but this one; there are four factors at most.
        let mut left = [0; 3];
        for (left, factor) in left.iter_mut().zip(rest.iter().enumerate().filter(|(j, _)| *j != i))
        {
            *left = *factor.1;
        }
        sum += c[(first, other)] * gaussian_product(&left[..rest.len() - 1], mean, c);
    }
    sum
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
            let factors: f64 = of.factors().iter().map(|i| x[*i]).product();
            sum += each.map(|(w, _)| w).iter().product::<f64>() * exponent.exp() * factors;
        }
        sum
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Means and covariances, of wide laws and narrow ones, of monomials with and without exponents and factors.
        #[test]
        fn moments_are_those_of_quadrature(
            mean in prop::array::uniform4(-1.0..1.0_f64),
            root in prop::array::uniform16(-0.4..0.4_f64),
            narrow in 0.0..4.0_f64,
            exponents in prop::collection::vec((0..4_usize, prop::sample::select(vec![0.0, 1.0, 2.0])), 2),
            factors in prop::collection::vec(prop::collection::vec(0..4_usize, 0..=2), 2),
        ) {
            let root = Matrix4::from_row_slice(&root) * 10_f64.powf(-narrow);
            let (mean, c) = (Vector4::from(mean), root * root.transpose());
            let all: [GaussianMonomial<4>; 2] =
                std::array::from_fn(|k| GaussianMonomial::new(&exponents[k..=k], &factors[k]));
            let (means, covariance) = moments(&all.map(|one| vec![one]), &mean, &c);
            let first = all.map(|one| by_quadrature(&one, &mean, &root));
            let size = first[0].abs().max(1e-3) * first[1].abs().max(1e-3);
            for i in 0..2 {
                prop_assert!((means[i] - first[i]).abs() < 1e-9 * first[i].abs().max(1.0), "{i}");
                for j in 0..2 {
                    let both = by_quadrature(&all[i].times(&all[j]), &mean, &root);
                    let gap = covariance[(i, j)] - (both - first[i] * first[j]);
                    prop_assert!(gap.abs() < 1e-8 * both.abs().max(size).max(1e-3), "{i} {j}: {gap:e}");
                }
            }
        }
    }

    /// Deviations of a millionth: the difference of expectations would have four digits left.
    #[test]
    fn covariances_of_narrow_laws_keep_their_digits() {
        let (mean, c) = (Vector4::new(0.3, -0.2, 0.5, 0.1), Matrix4::identity() * 1e-16);
        let all = [
            vec![GaussianMonomial::new(&[(0, 2.0), (1, 1.0)], &[])],
            vec![GaussianMonomial::new(&[(0, 1.0)], &[])],
        ];
        let (means, covariance) = moments(&all, &mean, &c);
        let expected = means[0] * means[1] * 2e-16;
        assert!((covariance[(0, 1)] / expected - 1.0).abs() < 1e-12, "{covariance}");
    }
}
