//! A rigid body that nothing pushes or turns any more.

use nalgebra::Matrix3;

use crate::state::RigidState;

/// A rigid body that nothing pushes or turns any more: its state, and what its free rotation follows from.
///
/// The inertia need not be realizable, but has to be positive definite. Whoever has its inverse and its
/// principal moments already fills in the fields; [`FreeBody::new`] computes them. They have to belong
/// together: the proofs of a [`Clearance`](crate::Clearance) stand on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeBody {
    /// Where it is and how it moves.
    pub state: RigidState,
    /// Inertia matrix about the mass centre, body axes, products as tensor entries, kg·m².
    pub inertia: Matrix3<f64>,
    /// Its inverse, 1/(kg·m²).
    pub inverse_inertia: Matrix3<f64>,
    /// Its principal moments, in any order, kg·m².
    pub principal_moments: [f64; 3],
}

/// Entries may differ from their mirror images by this share of the largest.
const SYMMETRIC: f64 = 1e-12;

impl FreeBody {
    /// A body in the given state, with the inertia matrix about its mass centre, body axes, products as
    /// tensor entries, kg·m². Entries that differ from their mirror images by rounding are replaced by the mean of both.
    ///
    /// # Errors
    /// The matrix is not finite, not symmetric to 1e-12 of its largest entry or not positive definite.
    pub fn new(state: RigidState, inertia: Matrix3<f64>) -> Result<Self, FreeBodyError> {
        let refused = || FreeBodyError { inertia: inertia.transpose().into() };
        let off = (inertia - inertia.transpose()).amax();
        if !(inertia.iter().all(|x| x.is_finite()) && off <= SYMMETRIC * inertia.amax()) {
            return Err(refused());
        }
        let inertia = Matrix3::from_fn(|i, j| {
            let (above, below) = (inertia[(i.min(j), i.max(j))], inertia[(i.max(j), i.min(j))]);
            if above == below { above } else { above + 0.5 * (below - above) }
        });
        let inverse_inertia = inertia.cholesky().ok_or_else(refused)?.inverse();
        let principal_moments: [f64; 3] = inertia.symmetric_eigenvalues().into();
        let sound = inverse_inertia.iter().all(|x| x.is_finite())
            && principal_moments.iter().all(|x| *x > 0.0);
        if sound {
            Ok(Self { state, inertia, inverse_inertia, principal_moments })
        } else {
            Err(refused())
        }
    }
}

/// The inertia matrix of a body that cannot be followed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "inertia = {inertia:?} kg·m², by rows: it must be finite, symmetric and positive definite for the \
     body to turn"
)]
pub struct FreeBodyError {
    inertia: [[f64; 3]; 3],
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, Vector3};
    use proptest::prelude::*;

    proptest! {
        /// The inverse and the moments belong to the matrix, over all scales and axes.
        #[test]
        fn what_is_computed_belongs_together(
            moments in prop::array::uniform3(1e-3..1.0f64),
            turn in prop::array::uniform3(-2.0..2.0f64),
            exponent in -60..60i32,
        ) {
            let scale = 10.0_f64.powi(exponent);
            let axes = Rotation3::from_scaled_axis(Vector3::from(turn));
            let diagonal = Matrix3::from_diagonal(&Vector3::from(moments.map(|x| x * scale)));
            let turned = axes * diagonal * axes.inverse();
            let body = FreeBody::new(RigidState::default(), turned).unwrap();
            prop_assert_eq!(body.inertia, body.inertia.transpose());
            let one = body.inverse_inertia * body.inertia;
            prop_assert!((one - Matrix3::identity()).amax() < 1e-11, "{}", one);
            let mut expected = moments.map(|x| x * scale);
            let mut found = body.principal_moments;
            expected.sort_by(f64::total_cmp);
            found.sort_by(f64::total_cmp);
            for (a, b) in expected.iter().zip(&found) {
                prop_assert!((a - b).abs() < 1e-14 * scale, "{} {}", a, b);
            }
        }
    }

    #[test]
    fn bad_matrices_are_refused() {
        let diagonal = |moments: [f64; 3]| Matrix3::from_diagonal(&moments.into());
        let mut skewed = diagonal([1.0, 2.0, 2.5]);
        skewed[(0, 1)] = 0.1;
        for bad in [
            skewed,
            diagonal([0.0, 1.0, 1.0]),
            diagonal([-1.0, 1.0, 1.0]),
            diagonal([1.0, f64::NAN, 1.0]),
            diagonal([1.0, f64::INFINITY, 1.0]),
        ] {
            assert!(FreeBody::new(RigidState::default(), bad).is_err(), "{bad}");
        }
        let error = FreeBody::new(RigidState::default(), skewed).unwrap_err();
        assert!(error.to_string().starts_with("inertia = [[1.0, 0.1, 0.0], "), "{error}");
    }
}
