//! The moments of a law on S³ about its mean: expectations of all monomials up to the eighth degree.

use nalgebra::{Complex, Matrix4, Vector4};

use crate::contour::Contour;

const DEGREE: usize = CentralMoments::DEGREE;
/// Monomials of four variables of degree up to 8: 12!/(8! 4!).
const LENGTH: usize = 495;
/// Where the monomials with these exponents of the first three variables begin; the last exponent counts on from there.
const BEGINS: [[[usize; DEGREE + 1]; DEGREE + 1]; DEGREE + 1] = {
    let mut begins = [[[0; DEGREE + 1]; DEGREE + 1]; DEGREE + 1];
    let (mut next, mut i) = (0, 0);
    while i <= DEGREE {
        let mut j = 0;
        while i + j <= DEGREE {
            let mut k = 0;
            while i + j + k <= DEGREE {
                begins[i][j][k] = next;
                next += DEGREE + 1 - (i + j + k);
                k += 1;
            }
            j += 1;
        }
        i += 1;
    }
    assert!(next == LENGTH);
    begins
};

/// The central moments E Π_j δ_j^{n_j}, Σ n_j ≤ 8, of a law on S³: x = V (m + δ), with orthogonal [axes](Self::axes) V and the
/// [mean](Self::mean) m = E Vᵀx.
///
/// They are what expectations of polynomials of x follow from, to machine precision: of quartic polynomials the covariances too.
/// About the mean, so that narrow laws keep their digits. To be had from
/// [`FisherBingham::central_moments`](crate::FisherBingham::central_moments).
///
/// ```
/// use gyradius_attitude::FisherBingham;
/// use nalgebra::{Matrix4, Vector4};
///
/// let law = FisherBingham::new(Matrix4::zeros(), Vector4::new(0.0, 0.0, 0.0, 2.0))?;
/// let moments = law.central_moments();
/// let variance: f64 = (0..4)
///     .map(|j| {
///         let mut twice = [0; 4];
///         twice[j] = 2;
///         moments.of(twice).unwrap()
///     })
///     .sum();
/// // |x| = 1: what the mean vector is short of one is the variance.
/// assert!((variance + moments.mean().norm_squared() - 1.0).abs() < 1e-14);
/// # Ok::<(), gyradius_attitude::FisherBinghamError>(())
/// ```
#[derive(Clone, Debug, PartialEq, getset::Getters)]
pub struct CentralMoments {
    /// V: its columns are the axes along which the exponent of the law is a sum, in the coordinates of x, scalar last.
    #[getset(get = "pub")]
    axes: Matrix4<f64>,
    /// m = Vᵀ E x, components along the axes.
    #[getset(get = "pub")]
    mean: Vector4<f64>,
    /// By exponents in ascending order, the last fastest.
    values: Box<[f64; LENGTH]>,
}

impl CentralMoments {
    /// The highest degree that is kept.
    pub const DEGREE: usize = 8;

    /// At every node the coordinates are independent Gaussian variables of complex mean g and variance v about m, whose
    /// moments follow one another by E δ^{n+1} = g E δ^n + n v E δ^{n−1}.
    pub(crate) fn new(axes: Matrix4<f64>, centre: [f64; 4], contour: &Contour) -> Self {
        let (mean, _) = contour.moments();
        let mut values = Box::new([0.0; LENGTH]);
        for (weight, offset, variance) in contour.nodes_about_centre() {
            let powers: [[Complex<f64>; DEGREE + 1]; 4] = std::array::from_fn(|j| {
                let g = offset[j] + (centre[j] - mean[j]);
                let mut powers = [Complex::new(1.0, 0.0); DEGREE + 1];
                powers[1] = g;
                for n in 1..DEGREE {
                    powers[n + 1] = g * powers[n] + variance[j] * powers[n - 1] * n as f64;
                }
                powers
            });
            let mut sums = values.iter_mut();
            for i in 0..=DEGREE {
                let first = weight * powers[0][i];
                for j in 0..=DEGREE - i {
                    let second = first * powers[1][j];
                    for k in 0..=DEGREE - i - j {
                        let third = second * powers[2][k];
                        for (last, sum) in powers[3][..=DEGREE - i - j - k].iter().zip(&mut sums) {
                            *sum += third.re * last.im + third.im * last.re;
                        }
                    }
                }
            }
        }
        Self { axes, mean, values }
    }

    /// E Π_j δ_j^{n_j} for the exponents n. None of a degree above [`DEGREE`](Self::DEGREE).
    #[must_use]
    pub fn of(&self, exponents: [usize; 4]) -> Option<f64> {
        let [i, j, k, last] = exponents;
        let degree = exponents.into_iter().try_fold(0_usize, usize::checked_add)?;
        (degree <= DEGREE).then(|| self.values[BEGINS[i][j][k] + last])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FisherBingham;
    use proptest::prelude::*;

    /// All exponents of degree up to the eighth, by counting.
    fn exponents() -> impl Iterator<Item = [usize; 4]> {
        let all = (0..9_usize.pow(4)).map(|n| [n / 729, n / 81 % 9, n / 9 % 9, n % 9]);
        all.filter(|n| n.iter().sum::<usize>() <= DEGREE)
    }

    #[test]
    fn every_monomial_has_a_place_of_its_own() {
        let places: Vec<usize> = exponents().map(|[i, j, k, l]| BEGINS[i][j][k] + l).collect();
        assert_eq!(places, (0..LENGTH).collect::<Vec<_>>());
        let law = FisherBingham::new(Matrix4::zeros(), Vector4::zeros()).unwrap();
        let moments = law.central_moments();
        assert!((moments.of([0; 4]).unwrap() - 1.0).abs() < 1e-14);
        // E y⁸ = 7!!/(4·6·8·10) on S³.
        assert!((moments.of([0, 8, 0, 0]).unwrap() - 105.0 / 1920.0).abs() < 1e-14);
        for n in [[0, 9, 0, 0], [3, 3, 3, 0], [usize::MAX, 1, 0, 0], [0, 0, 0, usize::MAX]] {
            assert_eq!(moments.of(n), None);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Moments of wide, narrow and uneven laws against the quadrature of `FisherBingham::expect`, which sees the same nodes
        /// and is else another way.
        #[test]
        fn moments_are_those_of_the_quadrature(
            sizes in prop::array::uniform4(-2.0..10.0_f64),
            turns in prop::array::uniform6(-3.0..3.0_f64),
            linear in prop::array::uniform4(-1.0..1.0_f64),
            strength in -1.0..10.0_f64,
            chosen in prop::array::uniform4(0..LENGTH),
        ) {
            let mut turned = Matrix4::<f64>::identity();
            let pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
            for ((i, j), turn) in pairs.into_iter().zip(turns) {
                let (sin, cos) = turn.sin_cos();
                let mut plane = Matrix4::<f64>::identity();
                (plane[(i, i)], plane[(j, j)]) = (cos, cos);
                (plane[(i, j)], plane[(j, i)]) = (-sin, sin);
                turned *= plane;
            }
            let sizes = Vector4::from(sizes.map(|e| 10f64.powf(e)));
            let precision = turned * Matrix4::from_diagonal(&sizes) * turned.transpose();
            let linear = Vector4::from(linear) * 10f64.powf(strength);
            let law = FisherBingham::new((precision + precision.transpose()) * 0.5, linear).unwrap();
            let moments = law.central_moments();
            let (axes, mean) = (*moments.axes(), *moments.mean());
            prop_assert!((axes.tr_mul(&law.mean_vector()) - mean).amax() < 1e-14);

            // How far the nodes lie from the mean: rounding is measured against it.
            let (_, _, centre, _) = law.eigenform();
            let mut reach = [0.0_f64; 4];
            for (_, offset, variance) in law.contour().nodes_about_centre() {
                for j in 0..4 {
                    let own = (offset[j] + (centre[j] - mean[j])).norm() + variance[j].norm().sqrt();
                    reach[j] = reach[j].max(own);
                }
            }
            let chosen = chosen.map(|n| exponents().nth(n).unwrap());
            let expected = law.expect(|x| chosen.map(|n| {
                let mut product = Complex::new(1.0, 0.0);
                for j in 0..4 {
                    let own: Complex<f64> = (0..4).map(|i| x[i] * axes[(i, j)]).sum();
                    for _ in 0..n[j] {
                        product *= own - mean[j];
                    }
                }
                product
            }));
            for (n, expected) in chosen.into_iter().zip(expected) {
                let size: f64 = (0..4).map(|j| reach[j].powi(n[j] as i32)).product();
                // The quadrature takes differences of numbers of size one, which are sums of four products.
                let blur: f64 = (0..4).map(|j| 1.0 + 5e-15 * n[j] as f64 / reach[j]).product();
                let error = moments.of(n).unwrap() - expected;
                prop_assert!(error.abs() < 1e-12 * size + (blur - 1.0) * size, "{n:?}: {error:e}, {size:e}");
            }
        }
    }
}
