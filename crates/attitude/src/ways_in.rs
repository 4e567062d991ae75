//! Covariances of the radially constrained Gaussian from what people have.

use nalgebra::{Matrix3, Matrix4, UnitQuaternion};

use crate::{
    HypersphericalAngles, RadiallyConstrainedGaussian, RcgError,
    fisher_bingham::left_multiplication,
    rcg::{checked_covariance, checked_mean},
};

/// Sines below this leave a hyperspherical direction to rounding.
const UNDEFINED: f64 = 1e-8;

impl RadiallyConstrainedGaussian {
    /// From the covariance P of small turns of the body about the mean, in rad².
    ///
    /// An attitude near the mean is q = m ⊗ exp(δ/2) with the rotation vector δ in body axes; to
    /// first order x = m ⊗ (δ/2, 1), so that Σ = L(m) diag(P/4, s) L(m)ᵀ with L(m) the matrix of
    /// quaternion multiplication from the left. This way in is defined for every mean, the identity included.
    ///
    /// # Radial variance
    /// δ has the covariance P where its square is small beside 1 and beside √s. Since the sphere bends away from the plane,
    /// the variance Pᵢ about a principal axis of P is smaller by the share Pᵢ (tr P + 2Pᵢ)/(32 s), to first order: by 1 %
    /// where three equal deviations are 4° and s is 4e-4, or 9° and s is 0.01. Turns that s keeps narrower than P are of the
    /// size of s^¼, whatever P. Of larger s the sphere removes all but the second lobe: with s below about 0.1 there is
    /// none, and with an infinite s (Bingham's law) the second lobe weighs as much as the first and consists of the same
    /// attitudes.
    ///
    /// # Errors
    /// The mean is not a unit quaternion, P is not finite, symmetric and positive definite with
    /// eigenvalues between 4e-14 and 4e14 rad², or s is not between 1e-14 and 1e14 or infinite.
    ///
    /// ```
    /// use gyradius_attitude::RadiallyConstrainedGaussian;
    /// use nalgebra::{Matrix3, UnitQuaternion};
    ///
    /// // Axes known to one degree.
    /// let variance = 1_f64.to_radians().powi(2);
    /// let law = RadiallyConstrainedGaussian::from_rotation_covariance(
    ///     UnitQuaternion::identity(),
    ///     Matrix3::from_diagonal_element(variance),
    ///     0.01,
    /// )?;
    /// // Half-angles, squared: a quarter of the variance.
    /// assert!((law.second_moment()[(0, 0)] / (0.25 * variance) - 1.0).abs() < 1e-3);
    /// # Ok::<(), gyradius_attitude::RcgError>(())
    /// ```
    pub fn from_rotation_covariance(
        mean: UnitQuaternion<f64>,
        rotation_covariance_rad2: Matrix3<f64>,
        radial_variance: f64,
    ) -> Result<Self, RcgError> {
        Self::from_turns(mean, rotation_covariance_rad2, 1.0, radial_variance)
    }

    /// Of small turns about the mean, from their covariance P in rad² alone: as
    /// [`from_rotation_covariance`](Self::from_rotation_covariance) with a radial variance of 0.01, of which turns
    /// of a few degrees know nothing, and with which there is no second lobe.
    ///
    /// # Errors
    /// As for [`from_rotation_covariance`](Self::from_rotation_covariance).
    ///
    /// ```
    /// use gyradius_attitude::RadiallyConstrainedGaussian;
    /// use nalgebra::{Matrix3, UnitQuaternion};
    ///
    /// let covariance = Matrix3::from_diagonal_element(2_f64.to_radians().powi(2));
    /// let law = RadiallyConstrainedGaussian::of_small_rotations(UnitQuaternion::identity(), covariance)?;
    /// assert!((law.rotation_covariance() / covariance[0] - Matrix3::identity()).amax() < 2e-3);
    /// # Ok::<(), gyradius_attitude::RcgError>(())
    /// ```
    pub fn of_small_rotations(
        mean: UnitQuaternion<f64>,
        rotation_covariance_rad2: Matrix3<f64>,
    ) -> Result<Self, RcgError> {
        Self::from_rotation_covariance(mean, rotation_covariance_rad2, 0.01)
    }

    /// From a covariance whose unit is `unit` rad².
    fn from_turns(
        mean: UnitQuaternion<f64>,
        turns: Matrix3<f64>,
        unit: f64,
        radial_variance: f64,
    ) -> Result<Self, RcgError> {
        let mean = checked_mean(mean)?;
        let finite = 1e-14..=1e14;
        if !(finite.contains(&radial_variance) || radial_variance == f64::INFINITY) {
            return Err(RcgError::RadialVariance { value: radial_variance });
        }
        let mut local = Matrix4::identity();
        local.fixed_view_mut::<3, 3>(0, 0).copy_from(&turns);
        // As it was given, so that an error names the entries that the caller knows.
        let mut local = match checked_covariance(local) {
            Err(error @ (RcgError::Entry { .. } | RcgError::NotSymmetric { .. })) => {
                return Err(error);
            }
            Err(_) => local,
            Ok(symmetric) => symmetric,
        };
        local *= 0.25 * unit;
        local[(3, 3)] = radial_variance;
        let law = Self::turned(mean, local, &left_multiplication(&mean));
        law.map_err(|error| match error {
            RcgError::Eigenvalue { eigenvalue } => RcgError::Turns { eigenvalue: 4.0 * eigenvalue },
            other => other,
        })
    }

    /// The same from a covariance in deg².
    ///
    /// # Errors
    /// As for [`from_rotation_covariance`](Self::from_rotation_covariance); eigenvalues are named
    /// in rad².
    ///
    /// ```
    /// use gyradius_attitude::RadiallyConstrainedGaussian;
    /// use nalgebra::{Matrix3, UnitQuaternion};
    ///
    /// // Axes known to one degree, and no second lobe to speak of.
    /// let law = RadiallyConstrainedGaussian::from_rotation_covariance_deg2(
    ///     UnitQuaternion::identity(),
    ///     Matrix3::identity(),
    ///     0.01,
    /// )?;
    /// let deviation = law.rotation_covariance()[(0, 0)].sqrt();
    /// assert!((deviation.to_degrees() - 1.0).abs() < 1e-3);
    /// # Ok::<(), gyradius_attitude::RcgError>(())
    /// ```
    pub fn from_rotation_covariance_deg2(
        mean: UnitQuaternion<f64>,
        rotation_covariance_deg2: Matrix3<f64>,
        radial_variance: f64,
    ) -> Result<Self, RcgError> {
        let square = (std::f64::consts::PI / 180.0).powi(2);
        Self::from_turns(mean, rotation_covariance_deg2, square, radial_variance)
    }

    /// From the covariance Σ̄ of the hyperspherical angles and the radius, in the order
    /// (θ₁, θ₂, θ₃, r), lengths along the sphere: Σ = R_J Σ̄ R_Jᵀ (Peck 2003, Eq. 22-23), where the
    /// columns of R_J are the unit vectors along which the angles and the radius grow: those of the
    /// Jacobian matrix (Eq. 15), each divided by its length.
    ///
    /// # Errors
    /// sin θ₁ or sin θ₂ of the mean is zero, where some angle has no direction: the identity is such
    /// a mean. Or as for [`new`](Self::new).
    pub fn from_hyperspherical_covariance(
        mean: UnitQuaternion<f64>,
        covariance: Matrix4<f64>,
    ) -> Result<Self, RcgError> {
        let mean = checked_mean(mean)?;
        let turn = hyperspherical_axes(&mean)?;
        Self::turned(mean, covariance, &turn)
    }
}

/// R_J: unit vectors of ∂x/∂θ₁, ∂x/∂θ₂, ∂x/∂θ₃ and of x itself, as columns.
fn hyperspherical_axes(mean: &UnitQuaternion<f64>) -> Result<Matrix4<f64>, RcgError> {
    let [(s1, c1), (s2, c2), (s3, c3)] =
        HypersphericalAngles::from(mean).values().map(libm::sincos);
    if !(s1 > UNDEFINED && s2 > UNDEFINED) {
        return Err(RcgError::Pole { sines: [s1, s2] });
    }
    Ok(Matrix4::new(
        c1 * s2 * c3,
        c2 * c3,
        -s3,
        s1 * s2 * c3,
        c1 * s2 * s3,
        c2 * s3,
        c3,
        s1 * s2 * s3,
        c1 * c2,
        -s2,
        0.0,
        s1 * c2,
        -s1,
        0.0,
        0.0,
        c1,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Quaternion, Vector3, Vector4};
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    const P: [[f64; 3]; 3] = [[4e-4, 1e-4, 0.0], [1e-4, 1e-4, -2e-5], [0.0, -2e-5, 9e-4]];

    fn covariance_of_turns(
        law: &RadiallyConstrainedGaussian,
        mean: &UnitQuaternion<f64>,
        in_body: bool,
    ) -> Matrix3<f64> {
        const N: usize = 200_000;
        let mut rng = ChaCha8Rng::seed_from_u64(31);
        let mut sum = Matrix3::zeros();
        for _ in 0..N {
            let q = law.sample(&mut rng);
            let turn = if in_body { mean.inverse() * q } else { q * mean.inverse() };
            let v: Vector3<f64> = turn.scaled_axis();
            sum += v * v.transpose();
        }
        sum / N as f64
    }

    /// Turns have the covariance that was asked for, in body axes; in the frame that the attitude
    /// leads to they do not, and the same comparison sees it.
    #[test]
    fn turns_have_the_covariance_in_body_axes() {
        let p = Matrix3::from_fn(|i, j| P[i][j]);
        let mean = UnitQuaternion::from_euler_angles(0.7, -0.4, 1.9);
        let law = RadiallyConstrainedGaussian::from_rotation_covariance(mean, p, 0.01).unwrap();
        // Relative standard errors are √(2/N) = 0.3 %; second order adds as much.
        let found = covariance_of_turns(&law, &mean, true);
        assert!((found - p).amax() < 0.012 * p.amax(), "{found}");
        let elsewhere = covariance_of_turns(&law, &mean, false);
        assert!((elsewhere - p).amax() > 0.2 * p.amax(), "{elsewhere}");
    }

    proptest! {
        /// How much of P a small radial variance takes, to first order; nothing else depends on it.
        #[test]
        fn a_small_radial_variance_narrows_turns(
            p in prop::array::uniform3(1e-5..1e-2f64),
            share in 1e-3..0.05f64,
        ) {
            let trace: f64 = p.iter().sum();
            let lost = p.map(|p| p * (trace + 2.0 * p) / 32.0);
            // The largest share is this one.
            let s = lost.iter().copied().fold(0.0, f64::max) / share;
            let turns = |s: f64| {
                let mean = UnitQuaternion::from_euler_angles(0.7, -0.4, 1.9);
                let p = Matrix3::from_diagonal(&Vector3::from(p));
                let law = RadiallyConstrainedGaussian::from_rotation_covariance(mean, p, s).unwrap();
                law.rotation_covariance().diagonal()
            };
            let (narrow, wide) = (turns(s), turns(1e14));
            for i in 0..3 {
                let found = 1.0 - narrow[i] / wide[i];
                prop_assert!((found - lost[i] / s).abs() < 6.0 * share * share + 2.0 * trace * share, "{} {}", found, lost[i] / s);
                prop_assert!((wide[i] / p[i] - 1.0).abs() < trace);
            }
        }
    }

    /// The limit of a small radial variance: 4u² with the density exp(−u⁴/8s) of u in space, whose mean is
    /// 4√(8s) Γ(5/4)/Γ(3/4), a third of it about each axis.
    #[test]
    fn a_tiny_radial_variance_alone_tells_how_wide_turns_are() {
        let mean = UnitQuaternion::from_euler_angles(0.7, -0.4, 1.9);
        for (s, p) in [(1e-8, 1.0), (1e-6, 1.0), (1e-8, 100.0)] {
            let p = Matrix3::from_diagonal_element(p);
            let law = RadiallyConstrainedGaussian::from_rotation_covariance(mean, p, s).unwrap();
            let gammas = libm::tgamma(1.25) / libm::tgamma(0.75);
            let expected = 4.0 * (8.0 * s).sqrt() * gammas / 3.0;
            let found = law.rotation_covariance();
            assert!(
                (found[(1, 1)] / expected - 1.0).abs() < 6.0 * s.sqrt(),
                "{s:e}: {found} {expected}"
            );
        }
    }

    #[test]
    fn the_identity_is_a_pole_for_angles_and_not_for_turns() {
        let identity = UnitQuaternion::identity();
        let small = Matrix4::from_diagonal_element(1e-3);
        let error = RadiallyConstrainedGaussian::from_hyperspherical_covariance(identity, small);
        assert!(matches!(error, Err(RcgError::Pole { .. })));
        // θ₂ = 0: a turn about axis 3.
        let about_3 = UnitQuaternion::from_euler_angles(0.0, 0.0, 1.0);
        assert!(
            RadiallyConstrainedGaussian::from_hyperspherical_covariance(about_3, small).is_err()
        );
        let p = Matrix3::from_diagonal_element(1e-3);
        assert!(RadiallyConstrainedGaussian::from_rotation_covariance(identity, p, 0.6).is_ok());
    }

    #[test]
    fn bad_covariances_are_refused() {
        let mean = UnitQuaternion::from_euler_angles(0.7, -0.4, 1.9);
        let p = Matrix3::from_fn(|i, j| P[i][j]);
        for (p, s) in [(p, -1.0), (p, f64::NAN), (-p, 0.1), (p * f64::INFINITY, 0.1)] {
            assert!(RadiallyConstrainedGaussian::from_rotation_covariance(mean, p, s).is_err());
        }
    }

    #[test]
    fn errors_name_what_was_given() {
        let mean = UnitQuaternion::from_euler_angles(0.7, -0.4, 1.9);
        let deg2 = |p, s| {
            let law = RadiallyConstrainedGaussian::from_rotation_covariance_deg2(mean, p, s);
            law.unwrap_err().to_string()
        };
        let good = Matrix3::from_fn(|i, j| 1e4 * P[i][j]);
        let mut askew = good;
        askew[(0, 1)] = 2.0;
        let text = deg2(askew, 0.1);
        assert!(text.contains("(1, 2) = 2.0 and (2, 1) = 1.0"), "{text}");
        let mut nan = good;
        nan[(2, 2)] = f64::NAN;
        let text = deg2(nan, 0.1);
        assert!(text.contains("(3, 3) = NaN"), "{text}");
        let text = deg2(good, -1e300);
        assert!(text.starts_with("radial variance -1e300"), "{text}");
        let error = RadiallyConstrainedGaussian::from_rotation_covariance(mean, -good, 0.1);
        assert!(matches!(error, Err(RcgError::Turns { eigenvalue: -4.0 })), "{error:?}");
        let error = RadiallyConstrainedGaussian::from_rotation_covariance(
            mean,
            Matrix3::new(1.0, 2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0),
            0.1,
        );
        let Err(RcgError::Turns { eigenvalue }) = error else { panic!("{error:?}") };
        assert!((eigenvalue + 1.0).abs() < 1e-12, "{eigenvalue}");
        let long = UnitQuaternion::new_unchecked(mean.into_inner() * 2.0);
        let error =
            RadiallyConstrainedGaussian::from_hyperspherical_covariance(long, Matrix4::identity());
        assert!(matches!(error, Err(RcgError::Mean { .. })), "{error:?}");
    }

    proptest! {
        /// R_J is a rotation or reflection whose columns are the normalised derivatives.
        #[test]
        fn hyperspherical_axes_are_derivatives(t1 in 0.1..3.0f64, t2 in 0.1..3.0f64, t3 in 0.0..6.2f64) {
            let x = |t: [f64; 3]| HypersphericalAngles::new(t).map(|a| a.quaternion().coords);
            let q = HypersphericalAngles::new([t1, t2, t3]).unwrap().quaternion();
            let axes = hyperspherical_axes(&q).unwrap();
            prop_assert!((axes * axes.transpose() - Matrix4::identity()).amax() < 1e-14);
            for i in 0..3 {
                let (mut up, mut down) = ([t1, t2, t3], [t1, t2, t3]);
                up[i] += 1e-6;
                down[i] = (down[i] - 1e-6).max(0.0);
                let slope: Vector4<f64> = (x(up).unwrap() - x(down).unwrap()).normalize();
                prop_assert!((slope - axes.column(i)).amax() < 1e-5);
            }
            prop_assert!((axes.column(3) - q.coords).amax() < 1e-14);
        }

        /// Multiplication from the left is what nalgebra does.
        #[test]
        fn left_multiplication_is_the_product(a in prop::array::uniform4(-1.0..1.0f64), b in prop::array::uniform4(-1.0..1.0f64)) {
            let a = Vector4::from(a);
            prop_assume!(a.norm() > 0.1);
            let m = UnitQuaternion::from_quaternion(Quaternion::from(a));
            let b = Quaternion::from(Vector4::from(b));
            let product = (m.into_inner() * b).coords;
            prop_assert!((left_multiplication(&m) * b.coords - product).amax() < 1e-15);
        }
    }
}
