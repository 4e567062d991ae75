//! A symmetric matrix in the place of an inertia matrix.

use nalgebra::{Matrix3, UnitQuaternion};

use crate::{MAX_ENTRY, RELATIVE_TOLERANCE};

/// Why a matrix is not an [`InertiaMatrix`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InertiaMatrixError {
    /// An entry is NaN, infinite, or larger in magnitude than [`MAX_ENTRY`].
    #[error(
        "entry I{row}{column} = {value:e} kg·m²: it must be finite and at most {MAX_ENTRY:.1e}"
    )]
    Entry {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The entry, kg·m².
        value: f64,
    },
    /// Entries across the diagonal differ by more than rounding.
    #[error(
        "I{row}{column} = {upper:?} kg·m² but I{column}{row} = {lower:?} kg·m²: an inertia matrix is \
         symmetric"
    )]
    NotSymmetric {
        /// Row of the upper entry, from 1.
        row: usize,
        /// Column of the upper entry, from 1.
        column: usize,
        /// The entry above the diagonal, kg·m².
        upper: f64,
        /// The entry below the diagonal, kg·m².
        lower: f64,
    },
    /// An attitude is not a unit quaternion.
    #[error("attitude quaternion of norm {norm}: it must have norm 1")]
    Attitude {
        /// The norm.
        norm: f64,
    },
}

/// The matrix of a unit quaternion, which safe code can make of zero or NaN.
#[inline]
pub(crate) fn rotation_matrix(
    rotation: &UnitQuaternion<f64>,
) -> Result<Matrix3<f64>, InertiaMatrixError> {
    let (w, x, y, z) = (rotation.w, rotation.i, rotation.j, rotation.k);
    let square = w * w + x * x + y * y + z * z;
    // Rounding after a long chain of products is forgiven.
    if !((square - 1.0).abs() < 2e-9) {
        return Err(InertiaMatrixError::Attitude { norm: rotation.norm() });
    }
    // Divided by the square: a rotation, whatever the rounding of the norm, and without a root.
    let scale = 2.0 / square;
    let (sx, sy, sz) = (scale * x, scale * y, scale * z);
    let (xx, yy, zz) = (sx * x, sy * y, sz * z);
    let (xy, xz, yz) = (sx * y, sx * z, sy * z);
    let (wx, wy, wz) = (sx * w, sy * w, sz * w);
    Ok(Matrix3::new(
        1.0 - (yy + zz),
        xy - wz,
        xz + wy,
        xy + wz,
        1.0 - (xx + zz),
        yz - wx,
        xz - wy,
        yz + wx,
        1.0 - (xx + yy),
    ))
}

/// A finite, symmetric 3×3 matrix in the place of an inertia matrix (Peck 2003, Eq. 2), in kg·m².
///
/// It need not belong to any body: that is what [`Inertia`](crate::Inertia) adds. Keep this type
/// where matrices come from elsewhere and are yet to be judged, or where unphysical ones are kept
/// on purpose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[[f64; 3]; 3]", into = "[[f64; 3]; 3]"))]
pub struct InertiaMatrix(Matrix3<f64>);

impl InertiaMatrix {
    /// Takes a full matrix. Entries across the diagonal may differ by rounding
    /// ([`RELATIVE_TOLERANCE`] of the largest entry) and are replaced by their mean.
    ///
    /// # Errors
    /// An entry is not finite or too large, or the matrix is not symmetric.
    pub fn new(matrix: Matrix3<f64>) -> Result<Self, InertiaMatrixError> {
        for row in 0..3 {
            for column in 0..3 {
                let value = matrix[(row, column)];
                // Negated so that NaN is refused too.
                if !(value.abs() <= MAX_ENTRY) {
                    return Err(InertiaMatrixError::Entry {
                        row: row + 1,
                        column: column + 1,
                        value,
                    });
                }
            }
        }
        let allowed = RELATIVE_TOLERANCE * matrix.amax();
        for (row, column) in [(0, 1), (0, 2), (1, 2)] {
            let (upper, lower) = (matrix[(row, column)], matrix[(column, row)]);
            if (upper - lower).abs() > allowed {
                return Err(InertiaMatrixError::NotSymmetric {
                    row: row + 1,
                    column: column + 1,
                    upper,
                    lower,
                });
            }
        }
        Ok(Self::symmetrized(&matrix))
    }

    /// Takes the moments (I₁₁, I₂₂, I₃₃) and the products (I₁₂, I₁₃, I₂₃) of inertia, the products
    /// as tensor entries: I₁₂ = −∫ x₁x₂ dm, so that I = Σ I_ij b_i b_j (Peck 2003, Eq. 1).
    ///
    /// # Errors
    /// An entry is not finite or too large.
    pub fn from_entries(
        [i11, i22, i33]: [f64; 3],
        [i12, i13, i23]: [f64; 3],
    ) -> Result<Self, InertiaMatrixError> {
        Self::new(Matrix3::new(i11, i12, i13, i12, i22, i23, i13, i23, i33))
    }

    /// For matrices known to be finite, in range and symmetric up to rounding.
    pub(crate) fn symmetrized(m: &Matrix3<f64>) -> Self {
        let mean = |i, j| 0.5 * (m[(i, j)] + m[(j, i)]);
        let (i12, i13, i23) = (mean(0, 1), mean(0, 2), mean(1, 2));
        Self(Matrix3::new(m[(0, 0)], i12, i13, i12, m[(1, 1)], i23, i13, i23, m[(2, 2)]))
    }

    /// The full matrix.
    #[must_use]
    pub fn matrix(&self) -> &Matrix3<f64> {
        &self.0
    }

    /// Names of the six entries, in the order of [`entries`](Self::entries).
    pub const ENTRY_NAMES: [&'static str; 6] = ["I11", "I22", "I33", "I12", "I13", "I23"];

    /// The six entries in the order I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃.
    #[must_use]
    pub fn entries(&self) -> [f64; 6] {
        let m = &self.0;
        [m[(0, 0)], m[(1, 1)], m[(2, 2)], m[(0, 1)], m[(0, 2)], m[(1, 2)]]
    }

    /// The second-moment matrix Σ = ½ tr(I)·1 − I = ∫ x xᵀ dm, whose eigenvalues are the K_k.
    #[must_use]
    pub fn second_moment_matrix(&self) -> Matrix3<f64> {
        // ½ tr(I) − I_kk, without the cancellation of forming the trace first.
        let m = &self.0;
        let k = |a: usize, b: usize, c: usize| 0.5 * (m[(b, b)] + m[(c, c)] - m[(a, a)]);
        let mut sigma = -m;
        sigma[(0, 0)] = k(0, 1, 2);
        sigma[(1, 1)] = k(1, 2, 0);
        sigma[(2, 2)] = k(2, 0, 1);
        sigma
    }

    /// The same dyadic in axes turned by `rotation`: R I Rᵀ, where R takes old components to new.
    ///
    /// # Errors
    /// The rotation is not a unit quaternion, or the turned entries are too large.
    pub fn rotated(&self, rotation: &UnitQuaternion<f64>) -> Result<Self, InertiaMatrixError> {
        let r = rotation_matrix(rotation)?;
        // Symmetric, but for the rounding of subnormal numbers, which is no small share of them.
        Self::new(Self::symmetrized(&(r * self.0 * r.transpose())).0)
    }

    /// Whether some distribution of non-negative mass has this inertia: min K_k ≥
    /// −[`RELATIVE_TOLERANCE`]·tr I. Rods, plates and the point mass (zero matrix) are realizable. For
    /// the reasons see [`RealizabilityReport`](crate::RealizabilityReport).
    #[must_use]
    pub fn is_realizable(&self) -> bool {
        self.is_realizable_within(RELATIVE_TOLERANCE)
    }

    /// The same with another tolerance, as a share of tr I. NaN or a negative tolerance allow nothing.
    #[must_use]
    pub fn is_realizable_within(&self, tolerance: f64) -> bool {
        // Products of subnormal entries would be lost.
        let m = if self.0.amax() < 1e-290 { self.0 * 2_f64.powi(600) } else { self.0 };
        let sigma = Self(m).second_moment_matrix();
        // The trace is the same in every frame.
        is_positive_semidefinite(&sigma, (tolerance * m.trace()).max(0.0))
    }

    /// The inverse, if the matrix is positive definite (so that kinetic energy is positive) and
    /// its smallest principal moment is more than [`RELATIVE_TOLERANCE`] of its largest entry.
    #[must_use]
    pub fn inverse(&self) -> Option<Matrix3<f64>> {
        let size = self.0.amax();
        if size == 0.0 {
            return None;
        }
        let scaled = self.0.map(|x| x / size);
        let shifted = scaled - Matrix3::from_diagonal_element(RELATIVE_TOLERANCE);
        shifted.cholesky()?;
        let inverse = scaled.cholesky()?.inverse().map(|x| x / size);
        inverse.iter().all(|x| x.is_finite()).then_some(inverse)
    }
}

/// Whether s + shift·1 is positive semidefinite, by elimination with diagonal pivoting. That is
/// backward stable, so that the shift decides and not rounding: leading minors lose rank-one matrices.
fn is_positive_semidefinite(s: &Matrix3<f64>, shift: f64) -> bool {
    let (mut a, mut b, mut c) = (s[(0, 0)] + shift, s[(1, 1)] + shift, s[(2, 2)] + shift);
    let (mut ab, mut ac, mut bc) = (s[(0, 1)], s[(0, 2)], s[(1, 2)]);
    if b > a {
        (a, b, ac, bc) = (b, a, bc, ac);
    }
    if c > a {
        (a, c, ab, bc) = (c, a, bc, ab);
    }
    if a <= 0.0 {
        // Nothing but zeros.
        return a == 0.0 && b == 0.0 && c == 0.0 && ab == 0.0 && ac == 0.0 && bc == 0.0;
    }
    // Everything over the pivot, so that no product overflows.
    let inverse = 1.0 / a;
    let (x, y) = (ab * inverse, ac * inverse);
    b = b * inverse - x * x;
    c = c * inverse - y * y;
    bc = bc * inverse - x * y;
    b >= 0.0 && c >= 0.0 && bc * bc <= b * c
}

crate::array_form::array_form!(
    InertiaMatrix as [[f64; 3]; 3], refused by InertiaMatrixError,
    |rows| Self::new(Matrix3::from(rows).transpose()),
    |inertia| inertia.0.transpose().into()
);

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    fn diagonal(moments: [f64; 3]) -> InertiaMatrix {
        InertiaMatrix::from_entries(moments, [0.0; 3]).unwrap()
    }

    pub(crate) fn any_attitude() -> impl Strategy<Value = UnitQuaternion<f64>> {
        prop::array::uniform4(-1.0..1.0f64)
            .prop_filter("length", |q| q.iter().map(|x| x * x).sum::<f64>() > 1e-2)
            .prop_map(|[x, y, z, w]| {
                UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
            })
    }

    #[test]
    fn refuses_what_is_not_a_number_or_not_symmetric() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308] {
            let error = InertiaMatrix::from_entries([1.0, bad, 1.0], [0.0; 3]).unwrap_err();
            assert!(matches!(error, InertiaMatrixError::Entry { row: 2, column: 2, .. }));
        }
        let mut m = Matrix3::identity();
        m[(0, 2)] = 1e-12;
        let error = InertiaMatrix::new(m).unwrap_err();
        assert!(matches!(error, InertiaMatrixError::NotSymmetric { row: 1, column: 3, .. }));
        assert!(error.to_string().contains("I13"), "{error}");
    }

    #[test]
    fn decides_the_classic_shapes() {
        assert!(diagonal([0.0; 3]).is_realizable(), "point");
        assert!(diagonal([0.0, 1.0, 1.0]).is_realizable(), "rod");
        assert!(diagonal([1.0, 2.0, 3.0]).is_realizable(), "plate");
        assert!(diagonal([1.0, 1.0, 1.0]).is_realizable(), "ball");
        assert!(!diagonal([-1.0, 1.0, 1.0]).is_realizable(), "negative moment");
        assert!(!diagonal([-1.0, -1.0, -1.0]).is_realizable(), "negative ball");
        assert!(!diagonal([1.0, 2.0, 3.003]).is_realizable(), "triangle by 1e-3");
        assert!(!diagonal([1.0, 2.0, 3.0 + 3e-12]).is_realizable(), "triangle by 1e-12");
        let leaning =
            InertiaMatrix::from_entries([100.0, 200.0, 300.0], [5.0, 10.0, 20.0]).unwrap();
        assert!(!leaning.is_realizable(), "a plate pushed out by its products");
    }

    /// A flat plate and a rod in 100,000 frames, at three scales, and a violation of one part in a
    /// billion in the same frames.
    #[test]
    fn frames_do_not_matter() {
        let plate = [1.0, 2.0, 3.0];
        let rod = [0.0, 1.0, 1.0];
        let wrong = [1.0, 2.0, 3.0 * (1.0 + 1e-9)];
        // An even set of attitudes by three irrational turns (Kronecker's sequence), Shoemake's way.
        for i in 0..100_000_u32 {
            let turn = |step: f64| (f64::from(i) * step).fract();
            let (u, a, b) = (
                turn(0.819_172_513_396_164_4),
                std::f64::consts::TAU * turn(0.671_043_606_703_789_2),
                std::f64::consts::TAU * turn(0.549_700_477_901_933_5),
            );
            let (p, r) = ((1.0 - u).sqrt(), u.sqrt());
            let q = nalgebra::Quaternion::new(r * b.cos(), p * a.sin(), p * a.cos(), r * b.sin());
            let q = UnitQuaternion::from_quaternion(q);
            let scale = [1.0, 1e-300, 1e300][i as usize % 3];
            let turned = |m: [f64; 3]| diagonal(m.map(|x| x * scale)).rotated(&q).unwrap();
            assert!(turned(plate).is_realizable() && turned(rod).is_realizable(), "{q} {scale:e}");
            assert!(!turned(wrong).is_realizable(), "{q} {scale:e}");
        }
    }

    #[test]
    fn scale_does_not_matter() {
        for scale in [5e-324, 1e-310, 1e-300, 1e-150, 1.0, 1e150, 1e300] {
            assert!(diagonal([scale; 3]).is_realizable(), "{scale:e}");
            assert!(!diagonal([scale, scale, 3.0 * scale]).is_realizable(), "{scale:e}");
        }
        for scale in [1e-300, 1e300] {
            assert!(diagonal([scale, 2.0 * scale, 3.0 * scale]).is_realizable());
            let short = 3.0 * scale * (1.0 + 1e-9);
            assert!(!diagonal([scale, 2.0 * scale, short]).is_realizable());
        }
    }

    #[test]
    fn inverse_only_of_what_can_carry_energy() {
        assert!(diagonal([0.0, 1.0, 1.0]).inverse().is_none());
        assert!(diagonal([-1.0, 1.0, 1.0]).inverse().is_none());
        assert!(diagonal([0.0; 3]).inverse().is_none());
        assert!(diagonal([1e-310; 3]).inverse().is_none(), "its inverse overflows");
        let m = InertiaMatrix::from_entries([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0]).unwrap();
        let product = m.inverse().unwrap() * m.matrix();
        assert!((product - Matrix3::identity()).amax() < 1e-14);
    }

    proptest! {
        /// A rotation to rounding, and nalgebra's, also where the norm is off by what is forgiven.
        #[test]
        fn attitudes_become_rotations(q in any_attitude(), off in -9e-10..9e-10f64) {
            let rotation = rotation_matrix(&UnitQuaternion::new_unchecked(*q * (1.0 + off))).unwrap();
            prop_assert!((rotation * rotation.transpose() - Matrix3::identity()).amax() < 2e-15);
            prop_assert!((rotation - q.to_rotation_matrix().matrix()).amax() < 2e-15);
            let long = UnitQuaternion::new_unchecked(*q * 1.01);
            let Err(InertiaMatrixError::Attitude { norm }) = rotation_matrix(&long) else {
                return Err(TestCaseError::fail("a norm of 1.01"));
            };
            prop_assert!((norm - 1.01).abs() < 1e-12);
        }

        #[test]
        fn boundary_bodies_survive_any_frame(
            q in any_attitude(),
            a in 0.0..10.0f64,
            b in 0.0..10.0f64,
            exponent in -300..300i32,
        ) {
            let scale = 10f64.powi(exponent);
            let plate = diagonal([a * scale, b * scale, (a + b) * scale]);
            prop_assert!(plate.rotated(&q).unwrap().is_realizable());
            let rod = diagonal([0.0, a * scale, a * scale]);
            prop_assert!(rod.rotated(&q).unwrap().is_realizable());
        }

        #[test]
        fn a_violation_of_one_part_in_a_billion_is_refused_in_any_frame(
            q in any_attitude(),
            a in 0.1..10.0f64,
            b in 0.1..10.0f64,
        ) {
            let wrong = diagonal([a, b, (a + b) * (1.0 + 1e-9)]);
            prop_assert!(!wrong.rotated(&q).unwrap().is_realizable());
        }

        #[test]
        fn any_cloud_of_points_is_realizable(
            points in prop::collection::vec((prop::array::uniform3(-1e3..1e3f64), 0.0..1e3f64), 1..8)
        ) {
            let mut inertia = Matrix3::zeros();
            for (x, mass) in points {
                let x = nalgebra::Vector3::from(x);
                inertia += (Matrix3::identity() * x.norm_squared() - x * x.transpose()) * mass;
            }
            prop_assert!(InertiaMatrix::new(inertia).unwrap().is_realizable());
        }

        #[test]
        fn second_moments_are_what_the_definition_says(
            moments in prop::array::uniform3(0.0..10.0f64),
            products in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let m = InertiaMatrix::from_entries(moments, products).unwrap();
            let direct = Matrix3::identity() * (0.5 * m.matrix().trace()) - m.matrix();
            prop_assert!((m.second_moment_matrix() - direct).amax() < 1e-14);
        }

        #[test]
        fn no_input_panics(entries in prop::array::uniform6(prop::num::f64::ANY)) {
            let [a, b, c, d, e, f] = entries;
            if let Ok(m) = InertiaMatrix::from_entries([a, b, c], [d, e, f]) {
                let _ = (m.is_realizable(), m.inverse(), m.principal_axes());
            }
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let m = diagonal([1.0, 2.0, 3.0]);
        let json = serde_json::to_string(&m).unwrap();
        assert_eq!(json, "[[1.0,0.0,0.0],[0.0,2.0,0.0],[0.0,0.0,3.0]]");
        assert_eq!(serde_json::from_str::<InertiaMatrix>(&json).unwrap(), m);
        let lopsided = "[[1.0,0.5,0.0],[0.0,2.0,0.0],[0.0,0.0,3.0]]";
        assert!(serde_json::from_str::<InertiaMatrix>(lopsided).is_err());
    }
}
