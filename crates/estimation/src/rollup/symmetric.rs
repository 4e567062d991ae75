//! Symmetric 3×3 matrices as six entries 11, 22, 33, 12, 13, 23, and linear maps between them.

use nalgebra::{DMatrix, Matrix3, SMatrix, SVector};

pub(crate) type Six = SVector<f64, 6>;
pub(crate) type Matrix6 = SMatrix<f64, 6, 6>;

/// Row and column of the six entries.
pub(crate) const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

pub(crate) fn six(matrix: &Matrix3<f64>) -> Six {
    Six::from_fn(|e, _| matrix[ENTRIES[e]])
}

pub(crate) fn matrix(six: &Six) -> Matrix3<f64> {
    let [a, b, c, d, e, f] = (*six).into();
    Matrix3::new(a, d, e, d, b, f, e, f, c)
}

/// The 6×6 matrix of a linear map of symmetric matrices.
pub(crate) fn linear(map: impl Fn(&Matrix3<f64>) -> Matrix3<f64>) -> Matrix6 {
    let columns: [Six; 6] = std::array::from_fn(|e| {
        six(&map(&matrix(&Six::from_fn(|f, _| f64::from(u8::from(e == f))))))
    });
    Matrix6::from_columns(&columns)
}

/// Of X ↦ A X Aᵀ.
pub(crate) fn congruence(a: &Matrix3<f64>) -> Matrix6 {
    linear(|x| a * x * a.transpose())
}

/// Of Σ ↦ I = tr(Σ)·1 − Σ.
pub(crate) fn inertia_of_second_moments() -> Matrix6 {
    linear(|x| Matrix3::identity() * x.trace() - x)
}

/// Of I ↦ Σ = ½ tr(I)·1 − I.
pub(crate) fn second_moments_of_inertia() -> Matrix6 {
    linear(|x| Matrix3::identity() * (0.5 * x.trace()) - x)
}

/// M C Mᵀ, symmetric to the bit.
pub(crate) fn mapped(map: &Matrix6, covariance: &Matrix6) -> Matrix6 {
    let product = map * covariance * map.transpose();
    (product + product.transpose()) * 0.5
}

/// The symmetric matrix with the eigenvalues of another mapped by a function.
pub(crate) fn with_eigenvalues<const N: usize>(
    symmetric: &SMatrix<f64, N, N>,
    of: impl Fn(f64) -> f64,
) -> SMatrix<f64, N, N> {
    // Through the heap, for the decomposition of matrices of any fixed size asks for bounds on N.
    let eigen = DMatrix::from_fn(N, N, |i, j| symmetric[(i, j)]).symmetric_eigen();
    let (values, vectors) = (eigen.eigenvalues.map(of), eigen.eigenvectors);
    SMatrix::from_fn(|i, j| {
        let (i, j) = (i.min(j), i.max(j));
        (0..N).map(|k| vectors[(i, k)] * values[k] * vectors[(j, k)]).sum()
    })
}
