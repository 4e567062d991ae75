//! From Σ = ∫ x xᵀ dm to I = tr(Σ)·1 − Σ.

use gyradius_inertia::{Inertia, InertiaMatrix, SecondMoments};
use nalgebra::{Matrix3, SMatrix};

/// The body with Σ = B Bᵀ; none if it overflows.
pub(crate) fn body(b: &Matrix3<f64>) -> Option<Inertia> {
    let entry =
        |i: usize, j: usize| b[(i, 0)] * b[(j, 0)] + b[(i, 1)] * b[(j, 1)] + b[(i, 2)] * b[(j, 2)];
    let (s11, s22, s33) = (entry(0, 0), entry(1, 1), entry(2, 2));
    let products = [-entry(0, 1), -entry(0, 2), -entry(1, 2)];
    let matrix = InertiaMatrix::from_entries([s22 + s33, s11 + s33, s11 + s22], products).ok()?;
    Inertia::try_from(matrix).ok().or_else(|| {
        // Rounding has pushed a plate or a rod over the edge.
        let axes = matrix.principal_axes();
        let moments = SecondMoments::new(axes.second_moments().map(|k| k.max(0.0))).ok()?;
        Inertia::from_second_moments(moments, &axes.attitude()).ok()
    })
}

/// Covariance of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ from that of Σ₁₁, Σ₂₂, Σ₃₃, Σ₁₂, Σ₁₃, Σ₂₃.
pub(crate) fn inertia_covariance(sigma: &SMatrix<f64, 6, 6>) -> SMatrix<f64, 6, 6> {
    let map = inertia_map();
    let covariance = map * sigma * map.transpose();
    (covariance + covariance.transpose()) * 0.5
}

/// The linear map from the entries of Σ to those of I.
pub(crate) fn inertia_map() -> SMatrix<f64, 6, 6> {
    #[rustfmt::skip]
    let map = SMatrix::<f64, 6, 6>::from_row_slice(&[
        0.0, 1.0, 1.0,  0.0,  0.0,  0.0,
        1.0, 0.0, 1.0,  0.0,  0.0,  0.0,
        1.0, 1.0, 0.0,  0.0,  0.0,  0.0,
        0.0, 0.0, 0.0, -1.0,  0.0,  0.0,
        0.0, 0.0, 0.0,  0.0, -1.0,  0.0,
        0.0, 0.0, 0.0,  0.0,  0.0, -1.0,
    ]);
    map
}
