//! The inertia of a rigid body that could be built.

use nalgebra::{Matrix3, UnitQuaternion};

use crate::{
    InertiaMatrix, InertiaMatrixError, PrincipalAxes, SecondMoments, SecondMomentsError,
    matrix::rotation_matrix, report::excess_percent,
};

/// How far principal moments may break the triangle inequality: by the rounding of decimal numbers.
const UNROUNDED: f64 = 8.0 * f64::EPSILON;

/// How the largest moment breaks the inequality.
fn excess(percent: f64) -> String {
    match percent {
        p if !p.is_finite() => "that sum is not positive beyond rounding".to_owned(),
        p if p < 0.001 => format!("it is {p:.1e} % more"),
        p => format!("it is {p:.3} % more"),
    }
}

/// Why a matrix is not the inertia of any body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RealizabilityError {
    /// Not even a finite symmetric matrix.
    #[error(transparent)]
    Matrix(#[from] InertiaMatrixError),
    /// A second mass moment is negative: the triangle inequality fails for that axis.
    #[error(
        "no body has this inertia: its principal moments are {:?}, {:?} and {:?} kg·m², and the largest \
         must be at most the sum of the other two ({})",
        .moments[0], .moments[1], .moments[2], excess(*.excess_percent)
    )]
    NotRealizable {
        /// Principal moments, kg·m².
        moments: [f64; 3],
        /// How far the largest exceeds the sum of the other two, in percent of that sum; infinite if that sum is not
        /// positive, or rounding beside the largest.
        excess_percent: f64,
    },
    /// Second moments out of range.
    #[error(transparent)]
    SecondMoments(#[from] SecondMomentsError),
}

/// The inertia of a rigid body that could be built: finite, symmetric, Σ = ½ tr(I)·1 − I ⪰ 0.
///
/// About the mass centre, in body axes, in kg·m²; products as tensor entries (I₁₂ = −∫ x₁x₂ dm).
/// The type cannot hold anything else: every way in checks, or builds from second mass moments
/// K_k ≥ 0, which is realizable by construction (Peck 2003, Eq. 7-11).
///
/// Boundary bodies are realizable: rods (two K_k zero), plates (one), points (all three). Whether
/// an inertia can be inverted is a separate question: [`Inertia::is_invertible`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[[f64; 3]; 3]", into = "[[f64; 3]; 3]"))]
pub struct Inertia(InertiaMatrix);

impl Inertia {
    /// Takes a full matrix.
    ///
    /// # Errors
    /// The matrix is not finite, not symmetric, or not realizable.
    pub fn new(matrix: Matrix3<f64>) -> Result<Self, RealizabilityError> {
        InertiaMatrix::new(matrix)?.try_into()
    }

    /// Builds I_B = R(q)ᵀ I_P R(q) from principal moments and the attitude that takes body
    /// components to principal components (Peck 2003, Eq. 5-6).
    ///
    /// # Errors
    /// The moments are not finite or break the triangle inequality, the attitude is not a unit
    /// quaternion, or the moments are subnormal and their rounding is no small share of them.
    pub fn from_principal_moments(
        moments: [f64; 3],
        attitude: &UnitQuaternion<f64>,
    ) -> Result<Self, RealizabilityError> {
        let principal = InertiaMatrix::from_entries(moments, [0.0; 3])?;
        // Judged before the turn rounds anything, and closely, so that the turned matrix passes too.
        if !principal.is_realizable_within(UNROUNDED) {
            return Err(RealizabilityError::of(&principal));
        }
        Self(principal.rotated(&attitude.inverse())?).kept()
    }

    /// Builds the inertia of second mass moments K (kg·m²) about principal axes at `attitude`,
    /// which takes body components to principal components: I_B = tr(K)·1 − R(q)ᵀ K R(q).
    /// Whatever the K_k ≥ 0, the result is realizable (Peck 2003, Eq. 7).
    ///
    /// # Errors
    /// The attitude is not a unit quaternion, or the moments are subnormal and their rounding is no small share of them.
    #[inline]
    pub fn from_second_moments(
        moments: SecondMoments,
        attitude: &UnitQuaternion<f64>,
    ) -> Result<Self, RealizabilityError> {
        let k = moments.values();
        let r = rotation_matrix(attitude)?;
        let sigma = |a: usize, b: usize| {
            k[0] * (r[(0, a)] * r[(0, b)])
                + k[1] * (r[(1, a)] * r[(1, b)])
                + k[2] * (r[(2, a)] * r[(2, b)])
        };
        let (s11, s22, s33) = (sigma(0, 0), sigma(1, 1), sigma(2, 2));
        let (i12, i13, i23) = (-sigma(0, 1), -sigma(0, 2), -sigma(1, 2));
        Self(InertiaMatrix::symmetrized(&Matrix3::new(
            s22 + s33,
            i12,
            i13,
            i12,
            s11 + s33,
            i23,
            i13,
            i23,
            s11 + s22,
        )))
        .kept()
    }

    /// What is realizable by construction, unless it is so small that rounding has made another matrix of it.
    #[inline]
    fn kept(self) -> Result<Self, RealizabilityError> {
        let size = self.matrix().diagonal().max();
        if size >= f64::MIN_POSITIVE || self.0.is_realizable() {
            return Ok(self);
        }
        let k = self.principal_axes().second_moments();
        Err(SecondMomentsError::Lost { value: k.into_iter().fold(0.0, f64::max) }.into())
    }

    /// The full matrix.
    #[must_use]
    pub fn matrix(&self) -> &Matrix3<f64> {
        self.0.matrix()
    }

    /// The six entries in the order I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃.
    #[must_use]
    pub fn entries(&self) -> [f64; 6] {
        self.0.entries()
    }

    /// The same inertia, its realizability forgotten.
    #[must_use]
    pub fn as_inertia_matrix(&self) -> &InertiaMatrix {
        &self.0
    }

    /// The same body in axes turned by `rotation`: R I Rᵀ, where R takes old components to new.
    ///
    /// # Errors
    /// The rotation is not a unit quaternion.
    pub fn rotated(&self, rotation: &UnitQuaternion<f64>) -> Result<Self, RealizabilityError> {
        let turned = self.0.rotated(rotation)?;
        if turned.is_realizable() {
            return Ok(Self(turned));
        }
        // A plate turned thousands of times in a row: rounding has added up, and is taken back.
        let axes = turned.principal_axes();
        Self::from_second_moments(SecondMoments::clamped(axes.second_moments()), &axes.attitude())
    }

    /// Principal moments and axes; see [`PrincipalAxes`] for their order and signs.
    #[must_use]
    pub fn principal_axes(&self) -> PrincipalAxes {
        self.0.principal_axes()
    }

    /// Second mass moments about the principal axes, in their order.
    #[must_use]
    pub fn second_moments(&self) -> SecondMoments {
        // What rounding left below zero is zero: the type promises no less.
        SecondMoments::clamped(self.principal_axes().second_moments())
    }

    /// Whether angular velocity follows from angular momentum: false for rods along their axis
    /// and for points.
    #[must_use]
    pub fn is_invertible(&self) -> bool {
        self.0.inverse().is_some()
    }
}

impl TryFrom<InertiaMatrix> for Inertia {
    type Error = RealizabilityError;

    fn try_from(matrix: InertiaMatrix) -> Result<Self, Self::Error> {
        if matrix.is_realizable() { Ok(Self(matrix)) } else { Err(RealizabilityError::of(&matrix)) }
    }
}

impl RealizabilityError {
    /// Of a matrix that is not realizable.
    pub(crate) fn of(matrix: &InertiaMatrix) -> Self {
        let axes = matrix.principal_axes();
        let size = matrix.matrix().amax();
        Self::NotRealizable {
            moments: axes.moments(),
            excess_percent: excess_percent(axes.moments().map(|moment| moment / size)),
        }
    }
}

crate::array_form::array_form!(
    Inertia as [[f64; 3]; 3], refused by RealizabilityError,
    |rows| InertiaMatrix::try_from(rows)?.try_into(),
    |inertia| inertia.0.into()
);

impl From<Inertia> for InertiaMatrix {
    fn from(inertia: Inertia) -> Self {
        inertia.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RootSecondMoments;
    use proptest::prelude::*;

    fn any_attitude() -> impl Strategy<Value = UnitQuaternion<f64>> {
        prop::array::uniform3(-3.0..3.0f64)
            .prop_map(|v| UnitQuaternion::from_scaled_axis(nalgebra::Vector3::from(v)))
    }

    #[test]
    fn the_message_says_what_is_wrong_and_what_is_allowed() {
        let message = |moments: [f64; 3]| {
            let [a, b, c] = moments;
            let error = Inertia::try_from([[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]);
            error.unwrap_err().to_string()
        };
        let said = message([1.0, 2.0, 6.0]);
        assert!(said.contains("at most the sum of the other two"), "{said}");
        assert!(said.contains("it is 100.000 % more"), "6 is 3 more than 1 + 2: {said}");
        let said = message([1.0, 2.0, 3.0 + 1e-6]);
        assert!(said.contains("it is 3.3e-5 % more"), "{said}");
        let said = message([-1.0, -2.0, 3.0]);
        assert!(said.contains("that sum is not positive"), "{said}");
    }

    #[test]
    fn moments_that_break_the_triangle_are_refused_at_any_attitude() {
        let q = UnitQuaternion::from_euler_angles(0.3, -0.2, 1.0);
        assert!(Inertia::from_principal_moments([1.0, 2.0, 3.1], &q).is_err());
        assert!(Inertia::from_principal_moments([1.0, 2.0, f64::NAN], &q).is_err());
        assert!(Inertia::from_principal_moments([1.0, 2.0, 3.0], &q).is_ok());
    }

    #[test]
    fn boundary_bodies_are_realizable_and_some_cannot_be_inverted() {
        let identity = UnitQuaternion::identity();
        let of =
            |k| Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &identity).unwrap();
        assert!(of([1.0, 1.0, 0.0]).is_invertible(), "plate");
        assert!(!of([1.0, 0.0, 0.0]).is_invertible(), "rod");
        assert!(!of([0.0, 0.0, 0.0]).is_invertible(), "point");
    }

    #[test]
    fn attitude_takes_body_to_principal_components() {
        // Principal axis 1 along body axis 2: R(q) e₂ = e₁, a turn of -90° about axis 3.
        let q = UnitQuaternion::from_axis_angle(
            &nalgebra::Vector3::z_axis(),
            -std::f64::consts::FRAC_PI_2,
        );
        let inertia = Inertia::from_principal_moments([5.0, 4.0, 3.0], &q).unwrap();
        let [i11, i22, i33, ..] = inertia.entries();
        assert!((i11 - 4.0).abs() < 1e-14 && (i22 - 5.0).abs() < 1e-14 && i33 == 3.0);
    }

    #[test]
    fn attitudes_that_are_none_are_refused() {
        use nalgebra::Quaternion;
        let k = SecondMoments::new([1.0, 2.0, 3.0]).unwrap();
        let ball = Inertia::from_principal_moments([1.0; 3], &UnitQuaternion::identity()).unwrap();
        let zero = UnitQuaternion::from_quaternion(Quaternion::new(0.0, 0.0, 0.0, 0.0));
        let long = UnitQuaternion::new_unchecked(Quaternion::new(2.0, 0.0, 0.0, 0.0));
        for bad in [zero, long] {
            assert!(Inertia::from_second_moments(k, &bad).is_err());
            assert!(Inertia::from_principal_moments([1.0; 3], &bad).is_err());
            assert!(ball.rotated(&bad).is_err());
        }
    }

    /// Accepted at the edge of the tolerance, turned, written and read back: still accepted.
    #[test]
    fn what_is_accepted_stays_accepted() {
        let q = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
            0.7388565738399132,
            0.5061742990449417,
            -0.11805553697799408,
            0.4288839382265837,
        ));
        for ulps in 0..64 {
            let third =
                (0.22682901826571544 + 0.5718627191729764) * (1.0 + f64::from(ulps) * f64::EPSILON);
            let moments = [0.22682901826571544, 0.5718627191729764, third];
            if let Ok(inertia) = Inertia::from_principal_moments(moments, &q) {
                assert!(Inertia::new(*inertia.matrix()).is_ok(), "{ulps}");
            } else {
                assert!(ulps > 4);
            }
        }
        let mut plate = Inertia::from_principal_moments([1.0, 2.0, 3.0], &q).unwrap();
        for _ in 0..20_000 {
            plate = plate.rotated(&q).unwrap();
        }
        assert!(plate.as_inertia_matrix().is_realizable());
    }

    proptest! {
        #[test]
        fn any_root_second_moments_make_a_body(
            k in prop::array::uniform3(-1e3..1e3f64),
            q in any_attitude(),
        ) {
            let moments = RootSecondMoments::new(k).unwrap().squared();
            let inertia = Inertia::from_second_moments(moments, &q).unwrap();
            prop_assert!(inertia.as_inertia_matrix().is_realizable());
            // The K_k come back, in some order.
            let mut expected = moments.values();
            let mut found = inertia.second_moments().values();
            expected.sort_by(f64::total_cmp);
            found.sort_by(f64::total_cmp);
            let size = expected[2].max(f64::MIN_POSITIVE);
            for (a, b) in expected.iter().zip(found) {
                prop_assert!((a - b).abs() <= 1e-13 * size, "{expected:?} {found:?}");
            }
        }

        #[test]
        fn both_constructions_agree(
            k in prop::array::uniform3(0.0..1e3f64),
            q in any_attitude(),
        ) {
            let moments = SecondMoments::new(k).unwrap();
            let a = Inertia::from_second_moments(moments, &q).unwrap();
            let b = Inertia::from_principal_moments(moments.principal_moments(), &q).unwrap();
            prop_assert!((a.matrix() - b.matrix()).amax() <= 1e-14 * a.matrix().amax());
        }

        #[test]
        fn rotation_keeps_the_trace_and_comes_back(
            k in prop::array::uniform3(0.1..1e3f64),
            q in any_attitude(),
            turn in any_attitude(),
        ) {
            let inertia = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
            let there = inertia.rotated(&turn).unwrap();
            let size = inertia.matrix().amax();
            prop_assert!((there.matrix().trace() - inertia.matrix().trace()).abs() < 1e-13 * size);
            let back = there.rotated(&turn.inverse()).unwrap();
            prop_assert!((back.matrix() - inertia.matrix()).amax() < 1e-13 * size);
        }
    }
}
