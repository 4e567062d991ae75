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

    /// Its expectation under N(mean, c).
    fn expect(&self, mean: &SVector<f64, N>, c: &SMatrix<f64, N, N>) -> f64 {
        let a = &self.exponents;
        let mut tilt = SVector::<f64, N>::zeros();
        for (column, &exponent) in c.column_iter().zip(a) {
            tilt += column * exponent;
        }
        let shifted = mean + tilt;
        let exponent: f64 = (0..N).map(|i| a[i] * (mean[i] + 0.5 * tilt[i])).sum();
        libm::exp(exponent) * gaussian_product(&self.factors[..self.length], &shifted, c)
    }
}

/// Mean and covariance of sums of monomials under N(mean, c).
pub(crate) fn moments<const N: usize, const M: usize>(
    sums: &[Vec<GaussianMonomial<N>>; M],
    mean: &SVector<f64, N>,
    c: &SMatrix<f64, N, N>,
) -> (SVector<f64, M>, SMatrix<f64, M, M>) {
    let expect = |monomial: &GaussianMonomial<N>| monomial.expect(mean, c);
    let means = SVector::from_fn(|e, _| sums[e].iter().map(expect).sum());
    let mut covariance = SMatrix::<f64, M, M>::zeros();
    for e in 0..M {
        for f in 0..=e {
            // Term by term, so that what is constant cancels to the bit.
            let mut sum = 0.0;
            for a in &sums[e] {
                for b in &sums[f] {
                    sum += expect(&a.times(b)) - expect(a) * expect(b);
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
        let left: Vec<usize> =
            rest.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, f)| *f).collect();
        sum += c[(first, other)] * gaussian_product(&left, mean, c);
    }
    sum
}
