//! The pseudo-inertia of a body, 4×4.

use nalgebra::{Matrix3, Matrix4, Vector3};

use crate::second_moment_matrix::{inertia_of, outer, remainder};
use crate::{MassProperties, MassPropertiesError, RELATIVE_TOLERANCE};

/// Why a matrix is not a pseudo-inertia.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PseudoInertiaError {
    /// An entry is NaN or infinite.
    #[error("entry J{row}{column} = {value:e}: it must be finite")]
    Entry {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// Entries across the diagonal differ by more than rounding.
    #[error(
        "J{row}{column} = {upper:?} but J{column}{row} = {lower:?}: a pseudo-inertia is symmetric"
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
    /// The mass is not positive, or Σ less m c cᵀ is not positive semidefinite.
    #[error(transparent)]
    MassProperties(#[from] MassPropertiesError),
}

/// The pseudo-inertia J = ∫ (x, 1)(x, 1)ᵀ dm, 4×4:
///
/// ```text
/// J = | Σ      m c |   Σ = ∫ x xᵀ dm about the origin of the reference frame, kg·m²
///     | m cᵀ   m   |   m c in kg·m, m in kg
/// ```
///
/// Linear in the mass distribution, so that it adds from body to body; with m > 0, J ⪰ 0 if and
/// only if some body has these mass properties (Wensing, Kim & Slotine 2018,
/// doi:10.1109/LRA.2017.2729659). A homogeneous transform T takes it to T J Tᵀ.
///
/// Σ is about the origin, so a body many times its size away from it has few digits left here:
/// [`MassProperties`] has no such limit.
///
/// ```
/// use gyradius_inertia::{PseudoInertia, Shape};
///
/// let body = Shape::cone(0.5, 1.0)?.of_mass(8.0)?;
/// let pseudo = PseudoInertia::of(&body)?;
/// assert_eq!(pseudo.matrix()[(3, 3)], 8.0);
/// assert_eq!(pseudo.matrix()[(2, 3)], 2.0);
/// let back = PseudoInertia::new(*pseudo.matrix())?.mass_properties();
/// assert!((back.inertia().matrix() - body.inertia().matrix()).amax() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::Getters, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[[f64; 4]; 4]", into = "[[f64; 4]; 4]"))]
pub struct PseudoInertia {
    /// The full matrix: kg·m² in the first three rows and columns, kg·m in the last, kg in the
    /// corner.
    #[getset(get = "pub")]
    matrix: Matrix4<f64>,
    /// Mass, mass centre and the inertia about it: Σ_c = Σ − m c cᵀ, I = tr(Σ_c)·1 − Σ_c.
    #[getset(get_copy = "pub")]
    mass_properties: MassProperties,
}

impl PseudoInertia {
    /// Takes a full matrix. Entries across the diagonal may differ by rounding, and are replaced by
    /// their mean; Σ − m c cᵀ may be negative by rounding beside Σ ([`RELATIVE_TOLERANCE`]).
    ///
    /// # Errors
    /// An entry is not finite, the matrix not symmetric, the mass not positive, or the matrix not
    /// positive semidefinite.
    pub fn new(matrix: Matrix4<f64>) -> Result<Self, PseudoInertiaError> {
        for row in 0..4 {
            for column in 0..4 {
                let value = matrix[(row, column)];
                if !value.is_finite() {
                    let (row, column) = (row + 1, column + 1);
                    return Err(PseudoInertiaError::Entry { row, column, value });
                }
            }
        }
        let mut symmetric = matrix;
        for (row, column) in [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)] {
            let (upper, lower) = (matrix[(row, column)], matrix[(column, row)]);
            // Entries have different units: what they are sums of is no larger than this.
            let size = matrix[(row, row)].abs().sqrt() * matrix[(column, column)].abs().sqrt();
            let size = size.max(upper.abs()).max(lower.abs());
            if (0.5 * upper - 0.5 * lower).abs() > 0.5 * RELATIVE_TOLERANCE * size {
                let (row, column) = (row + 1, column + 1);
                return Err(PseudoInertiaError::NotSymmetric { row, column, upper, lower });
            }
            let mean = lower + 0.5 * (upper - lower);
            (symmetric[(row, column)], symmetric[(column, row)]) = (mean, mean);
        }
        let mass = symmetric[(3, 3)];
        let sigma: Matrix3<f64> = symmetric.fixed_view::<3, 3>(0, 0).into();
        let centre: Vector3<f64> = symmetric.fixed_view::<3, 1>(0, 3) / mass;
        let point = MassProperties::point(mass, centre)?;
        let inertia = remainder(inertia_of(&(sigma - outer(mass, &centre))), sigma.amax())
            .map_err(MassPropertiesError::AboutMassCentre)?;
        let body = MassProperties::new(mass, point.mass_centre_m(), inertia)?;
        Ok(Self { matrix: symmetric, mass_properties: body })
    }

    /// The pseudo-inertia of a body about the origin of its reference frame.
    ///
    /// # Errors
    /// An entry is too large.
    pub fn of(body: &MassProperties) -> Result<Self, PseudoInertiaError> {
        let (mass, centre) = (body.mass_kg(), body.mass_centre_m());
        let own = body.inertia().as_inertia_matrix().second_moment_matrix();
        let mut matrix = Matrix4::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&(own + outer(mass, &centre)));
        let first = centre * mass;
        for i in 0..3 {
            (matrix[(i, 3)], matrix[(3, i)]) = (first[i], first[i]);
        }
        matrix[(3, 3)] = mass;
        Self::new(matrix)
    }
}

crate::array_form::array_form!(
    PseudoInertia as [[f64; 4]; 4], refused by PseudoInertiaError,
    |rows| Self::new(Matrix4::from(rows).transpose()),
    |pseudo| pseudo.matrix.transpose().into()
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass_properties::tests::{any_attitude, any_body, distance};
    use nalgebra::{Isometry3, SymmetricEigen};
    use proptest::prelude::*;

    #[test]
    fn matrices_of_no_body_are_refused() {
        let mut matrix = Matrix4::identity();
        matrix[(1, 2)] = f64::NAN;
        let error = PseudoInertia::new(matrix).unwrap_err();
        assert!(error.to_string().starts_with("entry J23"), "{error}");
        matrix[(1, 2)] = 1e-6;
        let error = PseudoInertia::new(matrix).unwrap_err();
        assert!(matches!(error, PseudoInertiaError::NotSymmetric { row: 2, column: 3, .. }));
        for mass in [0.0, -1.0] {
            let mut matrix = Matrix4::identity();
            matrix[(3, 3)] = mass;
            let error = PseudoInertia::new(matrix).unwrap_err();
            assert!(error.to_string().starts_with("mass ="), "{error}");
        }
        // A mass centre further out than the mass: m c² = 1.21 > Σ₁₁ = 1.
        let mut matrix = Matrix4::identity();
        (matrix[(0, 3)], matrix[(3, 0)]) = (1.1, 1.1);
        assert!(PseudoInertia::new(matrix).is_err());
        (matrix[(0, 3)], matrix[(3, 0)]) = (1.0, 1.0);
        assert!(PseudoInertia::new(matrix).is_ok(), "a plate");
        (matrix[(0, 3)], matrix[(3, 0)]) = (1.0 + 1e-12, 1.0 + 1e-12);
        assert!(PseudoInertia::new(matrix).is_err(), "by more than rounding");
    }

    proptest! {
        #[test]
        fn bodies_come_back(body in any_body()) {
            let pseudo = PseudoInertia::of(&body).unwrap();
            prop_assert!(distance(&pseudo.mass_properties(), &body) < 1e-12);
            let rows: [[f64; 4]; 4] = pseudo.into();
            prop_assert_eq!(PseudoInertia::try_from(rows).unwrap(), pseudo);
        }

        #[test]
        fn adds_and_transforms_as_a_matrix(
            (a, b) in (any_body(), any_body()),
            (q, t) in (any_attitude(), prop::array::uniform3(-9.0..9.0f64)),
        ) {
            let of = |body: &MassProperties| *PseudoInertia::of(body).unwrap().matrix();
            let sum = of(&MassProperties::combined([a, b]).unwrap());
            prop_assert!((of(&a) + of(&b) - sum).amax() < 1e-13 * sum.amax());
            let pose = Isometry3::from_parts(Vector3::from(t).into(), q);
            let moved = of(&a.transformed(&pose).unwrap());
            let t = pose.to_homogeneous();
            prop_assert!((t * of(&a) * t.transpose() - moved).amax() < 1e-12 * moved.amax());
        }

        /// Semidefiniteness of the 4×4 matrix, by nalgebra's eigen solver, says the same.
        #[test]
        fn accepted_means_positive_semidefinite(x in prop::array::uniform10(-1.0..1.0f64)) {
            let m = Matrix4::new(
                x[0].abs(), x[1], x[2], x[3],
                x[1], x[4].abs(), x[5], x[6],
                x[2], x[5], x[7].abs(), x[8],
                x[3], x[6], x[8], x[9].abs(),
            );
            // Most such matrices are indefinite; their squares never are.
            for matrix in [m, m * m + m * 0.3] {
                let smallest = SymmetricEigen::new(matrix).eigenvalues.min();
                prop_assume!(smallest.abs() > 1e-6);
                prop_assert_eq!(PseudoInertia::new(matrix).is_ok(), smallest > 0.0);
            }
        }

        #[test]
        fn no_input_panics(rows in prop::array::uniform4(prop::array::uniform4(prop::num::f64::ANY))) {
            let _ = PseudoInertia::try_from(rows);
            let matrix = Matrix4::from_fn(|i, j| rows[i.min(j)][i.max(j)].abs());
            let _ = PseudoInertia::new(matrix);
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let json = "[[1.0,0.0,0.0,0.5],[0.0,1.0,0.0,0.0],[0.0,0.0,1.0,0.0],[0.5,0.0,0.0,2.0]]";
        let pseudo: PseudoInertia = serde_json::from_str(json).unwrap();
        assert_eq!(pseudo.mass_properties().mass_centre_m().x, 0.25);
        assert_eq!(serde_json::to_string(&pseudo).unwrap(), json);
        assert!(serde_json::from_str::<PseudoInertia>(&json.replace("2.0", "0.0")).is_err());
    }
}
