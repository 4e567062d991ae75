//! Square roots of covariances, and draws from them.

use nalgebra::{SMatrix, SVector};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::normal::LN_ROOT_TAU;

/// Rounding that a correlation may carry: covariances come from files with so many digits.
const ROUNDING: f64 = 1e-9;
/// Pivots that differ by less, relative, are equal.
const TIE: f64 = 1e-6;

/// What is wrong with a matrix that is no covariance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CovarianceError {
    /// An entry is NaN or infinite, a variance negative, or either too large.
    #[error(
        "covariance entry ({row}, {column}) = {value:?}: it must be finite, at most {max:.1e}, and \
         not negative on the diagonal"
    )]
    Entry {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The entry.
        value: f64,
        /// What is allowed at most.
        max: f64,
    },
    /// The matrix is not symmetric.
    #[error(
        "covariance entries ({row}, {column}) = {upper:?} and ({column}, {row}) = {lower:?}: the \
         matrix must be symmetric"
    )]
    NotSymmetric {
        /// Row of the upper entry, from 1.
        row: usize,
        /// Column of the upper entry, from 1.
        column: usize,
        /// The entry above the diagonal.
        upper: f64,
        /// The entry below the diagonal.
        lower: f64,
    },
    /// Some combination of the coordinates would have a negative variance.
    #[error(
        "covariance with a negative eigenvalue (coordinate {coordinate} varies less than the others \
         make it vary): it must be positive semidefinite"
    )]
    Indefinite {
        /// A coordinate at which the elimination fails, from 1.
        coordinate: usize,
    },
}

/// A covariance with a square root F, A = F Fᵀ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Covariance<const N: usize> {
    matrix: SMatrix<f64, N, N>,
    root: SMatrix<f64, N, N>,
    /// What the density needs; none where A is singular.
    density: Option<Density<N>>,
}

/// What the density of N(0, A) is made of, beside the root.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Density<const N: usize> {
    /// The root with its rows in the order in which it is lower triangular: row, entries before the diagonal, and one
    /// over the diagonal.
    rows: [(usize, [f64; N], f64); N],
    /// ln of it at zero.
    ln_peak: f64,
}

impl<const N: usize> Covariance<N> {
    /// Checks a matrix whose entries are at most `max`. It may be singular.
    pub(crate) fn new(matrix: SMatrix<f64, N, N>, max: f64) -> Result<Self, CovarianceError> {
        for row in 0..N {
            for column in 0..N {
                let value = matrix[(row, column)];
                if !(value.abs() <= max) || (row == column && value < 0.0) {
                    let (row, column) = (row + 1, column + 1);
                    return Err(CovarianceError::Entry { row, column, value, max });
                }
            }
        }
        // An entry is as large as its two variances allow, so rounding is measured against them.
        let deviations = SVector::<f64, N>::from_fn(|i, _| matrix[(i, i)].sqrt());
        for row in 0..N {
            for column in row + 1..N {
                let (upper, lower) = (matrix[(row, column)], matrix[(column, row)]);
                if !((upper - lower).abs() <= ROUNDING * deviations[row] * deviations[column]) {
                    let (row, column) = (row + 1, column + 1);
                    return Err(CovarianceError::NotSymmetric { row, column, upper, lower });
                }
            }
        }
        // What does not vary covaries with nothing.
        if let Some(i) =
            (0..N).find(|&i| deviations[i] == 0.0 && matrix.row(i).iter().any(|c| *c != 0.0))
        {
            return Err(CovarianceError::Indefinite { coordinate: i + 1 });
        }
        let matrix = SMatrix::<f64, N, N>::from_fn(|i, j| {
            if i == j { matrix[(i, i)] } else { 0.5 * matrix[(i, j)] + 0.5 * matrix[(j, i)] }
        });
        let correlation = SMatrix::<f64, N, N>::from_fn(|i, j| {
            if !(deviations[i] > 0.0 && deviations[j] > 0.0) {
                0.0
            } else if i == j {
                1.0
            } else {
                matrix[(i, j)] / deviations[i] / deviations[j]
            }
        });
        let (unit, order) = root(correlation)
            .map_err(|coordinate| CovarianceError::Indefinite { coordinate: coordinate + 1 })?;
        let root = SMatrix::from_fn(|i, j| deviations[i] * unit[(i, j)]);
        Ok(Self { matrix, root, density: order.map(|order| Density::new(&root, order)) })
    }

    pub(crate) fn matrix(&self) -> &SMatrix<f64, N, N> {
        &self.matrix
    }

    /// Its rows, as they are written.
    #[cfg(feature = "serde")]
    pub(crate) fn rows(&self) -> [[f64; N]; N] {
        self.matrix.transpose().into()
    }

    /// The logarithm of the density of N(0, A); none where A is singular.
    pub(crate) fn ln_density(&self, x: &SVector<f64, N>) -> Option<f64> {
        let Density { rows, ln_peak } = self.density.as_ref()?;
        let (mut z, mut square) = ([0.0; N], 0.0);
        for (step, (row, before, inverse)) in rows.iter().enumerate() {
            let mut rest = x[*row];
            for j in 0..step {
                rest -= before[j] * z[j];
            }
            z[step] = rest * inverse;
            square += z[step] * z[step];
        }
        // Of what overflows, far out, nothing is left.
        Some(if square.is_finite() { ln_peak - 0.5 * square } else { f64::NEG_INFINITY })
    }

    /// A draw of N(0, A).
    #[inline]
    pub(crate) fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> SVector<f64, N> {
        let z = SVector::<f64, N>::from_fn(|_, _| StandardNormal.sample(rng));
        self.root * z
    }
}

impl<const N: usize> Density<N> {
    fn new(root: &SMatrix<f64, N, N>, order: [usize; N]) -> Self {
        let (mut rows, mut ln_peak) = ([(0, [0.0; N], 0.0); N], 0.0);
        for (step, row) in order.into_iter().enumerate() {
            let diagonal = root[(row, step)];
            rows[step] = (row, std::array::from_fn(|j| root[(row, j)]), 1.0 / diagonal);
            ln_peak -= libm::log(diagonal) + LN_ROOT_TAU;
        }
        Self { rows, ln_peak }
    }
}

/// The matrix of rows that were read.
pub(crate) fn of_rows<const N: usize>(rows: [[f64; N]; N]) -> SMatrix<f64, N, N> {
    SMatrix::<f64, N, N>::from(rows).transpose()
}

/// A covariance that was computed and is read back: unlike one that a user states, it may be off one by rounding.
#[cfg(feature = "serde")]
pub(crate) fn computed<const N: usize>(
    matrix: SMatrix<f64, N, N>,
) -> Result<SMatrix<f64, N, N>, CovarianceError> {
    let rounding = ROUNDING * matrix.amax();
    for row in 0..N {
        for column in 0..=row {
            let (lower, upper) = (matrix[(row, column)], matrix[(column, row)]);
            let most =
                matrix[(row, row)].max(0.0).sqrt() * matrix[(column, column)].max(0.0).sqrt();
            let max = most + rounding + ROUNDING * most;
            if !(lower.abs() <= max && lower.is_finite()) {
                let (row, column) = (row + 1, column + 1);
                return Err(CovarianceError::Entry { row, column, value: lower, max });
            }
            if !((lower - upper).abs() <= rounding) {
                let (row, column) = (column + 1, row + 1);
                return Err(CovarianceError::NotSymmetric { row, column, upper, lower });
            }
        }
    }
    Ok(matrix)
}

/// A root, and the order of its rows.
type Root<const N: usize> = (SMatrix<f64, N, N>, Option<[usize; N]>);

/// Cholesky's elimination with diagonal pivoting, which ends where nothing but rounding is left
/// (Higham 2002, Accuracy and Stability of Numerical Algorithms, §10.3). The diagonal of `a` is one or
/// zero. Of pivots that are equal but for rounding the first is taken, so that rounding does not choose the root, and draws
/// are continuous in the covariance. With it the rows in the order of the pivots, if there are N. Or the coordinate at which
/// a is found to be indefinite.
fn root<const N: usize>(mut a: SMatrix<f64, N, N>) -> Result<Root<N>, usize> {
    let mut f = SMatrix::<f64, N, N>::zeros();
    let mut order = [0; N];
    let mut left: [bool; N] = [true; N];
    for step in 0..N {
        let pivot = (0..N)
            .filter(|&i| left[i])
            .fold(None, |best, i| match best {
                Some(j) if a[(j, j)] * (1.0 + TIE) >= a[(i, i)] => Some(j),
                _ => Some(i),
            })
            .unwrap_or(0);
        if !(a[(pivot, pivot)] > ROUNDING) {
            break;
        }
        let scale = a[(pivot, pivot)].sqrt();
        left[pivot] = false;
        order[step] = pivot;
        f[(pivot, step)] = scale;
        for i in (0..N).filter(|&i| left[i]) {
            f[(i, step)] = a[(i, pivot)] / scale;
        }
        for i in (0..N).filter(|&i| left[i]) {
            for j in (0..N).filter(|&j| left[j]) {
                a[(i, j)] -= f[(i, step)] * f[(j, step)];
            }
        }
    }
    let bad = |i: usize| (0..N).any(|j| left[j] && !(a[(i, j)].abs() <= 4.0 * ROUNDING));
    match (0..N).find(|&i| left[i] && bad(i)) {
        Some(i) => Err(i),
        None => Ok((f, (!left.contains(&true)).then_some(order))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    proptest! {
        #[test]
        fn roots_reconstruct(
            x in prop::array::uniform9(-1.0..1.0f64),
            scales in prop::array::uniform3(-100.0..100.0f64),
            rank in 1..4usize,
        ) {
            let d = scales.map(|s| 10f64.powf(s));
            let f = Matrix3::from_fn(|i, j| if j < rank { d[i] * x[3 * i + j] } else { 0.0 });
            let a = f * f.transpose();
            let c = Covariance::new(a, 1e300).unwrap();
            let back = c.root * c.root.transpose();
            for i in 0..3 {
                for j in 0..3 {
                    let size = a[(i, i)].sqrt() * a[(j, j)].sqrt();
                    prop_assert!((back[(i, j)] - a[(i, j)]).abs() <= 1e-8 * size);
                }
            }
        }
    }

    proptest! {
        /// Of coordinates that are alike, as those of bodies without a preferred axis are: another rounding of the covariance is
        /// the same root but for rounding, so that the draws are too.
        #[test]
        fn rounding_does_not_choose_the_root(
            common in 0.0..0.95_f64,
            scales in prop::array::uniform4(-3.0..3.0_f64),
            noise in prop::array::uniform16(-1.0..1.0_f64),
        ) {
            let d = scales.map(|s| 10f64.powf(s));
            let a = SMatrix::<f64, 4, 4>::from_fn(|i, j| d[i] * d[j] * if i == j { 1.0 } else { common });
            let rounded = SMatrix::<f64, 4, 4>::from_fn(|i, j| {
                a[(i, j)] * (1.0 + 1e-13 * noise[4 * i.min(j) + i.max(j)])
            });
            let [one, other] = [a, rounded].map(|a| Covariance::new(a, 1e300).unwrap().root);
            for i in 0..4 {
                for j in 0..4 {
                    prop_assert!((one[(i, j)] - other[(i, j)]).abs() < 1e-11 * d[i], "{} {}", one, other);
                }
            }
        }

        /// Against the inverse and the determinant; a singular one has none.
        #[test]
        fn densities_are_gaussian(
            f in prop::array::uniform9(-1.0..1.0f64),
            x in prop::array::uniform3(-2.0..2.0f64),
            scales in prop::array::uniform3(-70.0..70.0f64),
        ) {
            let f = Matrix3::from_row_slice(&f) + Matrix3::identity();
            let unit = f * f.transpose();
            prop_assume!(unit.determinant() > 1e-3);
            let d = Matrix3::from_diagonal(&scales.map(|s| 10f64.powf(s)).into());
            let x = nalgebra::Vector3::from(x);
            let found = Covariance::new(d * unit * d, 1e300).unwrap().ln_density(&(d * x)).unwrap();
            let square = x.dot(&(unit.try_inverse().unwrap() * x));
            let ln_size = 10f64.ln() * scales.iter().sum::<f64>() + 0.5 * unit.determinant().ln();
            let expected = -0.5 * square - ln_size - 1.5 * std::f64::consts::TAU.ln();
            prop_assert!((found - expected).abs() < 1e-9 * (1.0 + square), "{} {}", found, expected);
            let flat = x * x.transpose();
            prop_assert_eq!(Covariance::new(flat, 1e300).unwrap().ln_density(&x), None);
        }
    }

    #[test]
    fn what_is_no_covariance_is_named() {
        let error = |m: [f64; 9]| {
            Covariance::<3>::new(Matrix3::from_row_slice(&m), 1e300).unwrap_err().to_string()
        };
        let e = error([1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0]);
        assert!(e.contains("(2, 2) = -1.0"), "{e}");
        let e = error([1.0, f64::NAN, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        assert!(e.contains("(1, 2) = NaN"), "{e}");
        let e = error([1.0, 0.5, 0.0, 0.4, 1.0, 0.0, 0.0, 0.0, 1.0]);
        assert!(e.contains("symmetric"), "{e}");
        let e = error([1.0, 1.1, 0.0, 1.1, 1.0, 0.0, 0.0, 0.0, 1.0]);
        assert!(e.contains("semidefinite"), "{e}");
        // Every pair is possible, the three together are not.
        let e = error([1.0, 0.9, 0.9, 0.9, 1.0, -0.9, 0.9, -0.9, 1.0]);
        assert!(e.contains("semidefinite"), "{e}");
        // A coordinate that does not vary covaries with nothing.
        let e = error([0.0, 0.1, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0, 1.0]);
        assert!(e.contains("semidefinite"), "{e}");
        let e = error([1e301, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        assert!(e.contains("1e301"), "{e}");
    }

    #[test]
    fn draws_have_the_covariance() {
        const N: usize = 200_000;
        let a = Matrix3::new(4.0, 1.0, 2.0, 1.0, 1.0, 0.5, 2.0, 0.5, 1.0);
        let c = Covariance::new(a, 1e300).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let sum = (0..N).fold(Matrix3::zeros(), |sum, _| {
            let x = c.sample(&mut rng);
            sum + x * x.transpose()
        });
        for i in 0..3 {
            for j in 0..3 {
                let variance = a[(i, i)] * a[(j, j)] + a[(i, j)].powi(2);
                let z = (sum[(i, j)] / N as f64 - a[(i, j)]) / (variance / N as f64).sqrt();
                assert!(z.abs() < 4.0, "{i}{j}: {z}");
            }
        }
    }
}
