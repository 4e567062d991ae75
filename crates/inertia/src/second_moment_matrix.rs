//! Arithmetic of Σ = ∫ x xᵀ dm and I = tr(Σ)·1 − Σ between bodies.

use nalgebra::{Matrix3, Vector3};

use crate::{Inertia, InertiaMatrix, RELATIVE_TOLERANCE, RealizabilityError, SecondMoments};

/// m (|d|²·1 − d dᵀ), symmetric to the bit.
pub(crate) fn point_inertia(mass: f64, d: &Vector3<f64>) -> Matrix3<f64> {
    inertia_of(&outer(mass, d))
}

/// m d dᵀ, symmetric to the bit; mass times length first, which over- and underflows last.
pub(crate) fn outer(mass: f64, d: &Vector3<f64>) -> Matrix3<f64> {
    let p = |i: usize, j: usize| (mass * d[i]) * d[j];
    let (p12, p13, p23) = (p(0, 1), p(0, 2), p(1, 2));
    Matrix3::new(p(0, 0), p12, p13, p12, p(1, 1), p23, p13, p23, p(2, 2))
}

/// I = tr(Σ)·1 − Σ, without the cancellation of forming the trace first.
pub(crate) fn inertia_of(sigma: &Matrix3<f64>) -> Matrix3<f64> {
    let mut inertia = -sigma;
    inertia[(0, 0)] = sigma[(1, 1)] + sigma[(2, 2)];
    inertia[(1, 1)] = sigma[(0, 0)] + sigma[(2, 2)];
    inertia[(2, 2)] = sigma[(0, 0)] + sigma[(1, 1)];
    inertia
}

/// The inertia of a matrix known to be realizable but for rounding.
pub(crate) fn nearest(matrix: Matrix3<f64>) -> Result<Inertia, RealizabilityError> {
    let matrix = InertiaMatrix::new(matrix)?;
    Inertia::try_from(matrix).or_else(|_| {
        let axes = matrix.principal_axes();
        let moments = SecondMoments::new(axes.second_moments().map(|k| k.max(0.0)))?;
        Inertia::from_second_moments(moments, &axes.attitude())
    })
}

/// The inertia of a difference of matrices as large as `size`: what is negative by their rounding
/// is zero, what is more so is refused.
pub(crate) fn remainder(matrix: Matrix3<f64>, size: f64) -> Result<Inertia, RealizabilityError> {
    let judged = InertiaMatrix::new(matrix)?;
    Inertia::try_from(judged).or_else(|error| {
        let second_moments = judged.principal_axes().second_moments();
        if second_moments.iter().all(|&k| k >= -RELATIVE_TOLERANCE * size) {
            nearest(matrix)
        } else {
            Err(error)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plate(excess: f64) -> Matrix3<f64> {
        Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 3.0 + excess))
    }

    #[test]
    fn a_remainder_may_be_negative_by_the_rounding_of_what_it_was_taken_from() {
        assert!(remainder(plate(1e-9), 1.0).is_err());
        assert!(remainder(plate(1e-9), 1e4).is_err());
        let mended = remainder(plate(1e-9), 1e6).unwrap();
        assert!(mended.as_inertia_matrix().is_realizable());
        assert!((mended.matrix() - plate(0.0)).amax() < 2e-9);
        // What needs no mending is kept to the bit.
        assert_eq!(*remainder(plate(-1.0), 1e6).unwrap().matrix(), plate(-1.0));
        assert!(remainder(plate(f64::NAN), f64::NAN).is_err());
        assert!(remainder(plate(1.0), f64::NAN).is_err());
    }

    #[test]
    fn extreme_masses_and_distances_meet_in_the_middle() {
        let sigma = outer(1e-300, &Vector3::new(1e100, -1e99, 0.0));
        assert!((sigma[(0, 0)] * 1e100 - 1.0).abs() < 1e-15, "{sigma}");
        assert_eq!(sigma, sigma.transpose());
        assert!(outer(1e300, &Vector3::repeat(1e-200))[(0, 1)] > 0.99e-100);
    }
}
