//! The radially constrained Gaussian: a Gaussian in four dimensions conditioned on unit length.

use nalgebra::{Complex, Matrix3, Matrix4, UnitQuaternion, Vector4};
use rand::Rng;
use rand_distr::Distribution;

use crate::{
    CentralMoments, FisherBingham, HypersphericalAngles, Method, far_half,
    fisher_bingham::symmetric_part, jacobi,
};

/// Range of the eigenvalues of Σ: beyond it the law is uniform, or a point, to rounding.
const EIGENVALUES: std::ops::RangeInclusive<f64> = 1e-14..=1e14;

/// Why a mean and a covariance are not the parameters of a [`RadiallyConstrainedGaussian`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RcgError {
    /// The mean is not a unit quaternion.
    #[error("mean quaternion of norm {norm:?}: it must have norm 1")]
    Mean {
        /// The norm.
        norm: f64,
    },
    /// An entry of the covariance is NaN or infinite.
    #[error("covariance entry ({row}, {column}) = {value:?}: it must be finite")]
    Entry {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The covariance is not symmetric.
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
    /// The covariance is not positive definite, or out of range.
    #[error(
        "covariance with eigenvalue {eigenvalue:e}: it must be positive definite, with eigenvalues \
         between 1e-14 and 1e14"
    )]
    Eigenvalue {
        /// The smallest eigenvalue, or whatever variance or eigenvalue is out of range.
        eigenvalue: f64,
    },
    /// The covariance of small turns is not positive definite, or out of range.
    #[error(
        "covariance of turns with eigenvalue {eigenvalue:e} rad²: it must be positive definite, with \
         eigenvalues between 4e-14 and 4e14 rad²"
    )]
    Turns {
        /// The smallest eigenvalue, or whatever variance or eigenvalue is out of range, in rad².
        eigenvalue: f64,
    },
    /// The radial variance is out of range.
    #[error("radial variance {value:?}: it must be between 1e-14 and 1e14, or infinite")]
    RadialVariance {
        /// The value.
        value: f64,
    },
    /// Principal axes are not orthonormal.
    #[error("principal axes that are off orthonormal by {deviation:e}: at most 1e-12 is allowed")]
    Axes {
        /// The largest entry of VᵀV − 1.
        deviation: f64,
    },
    /// Angles of the mean have no direction (Eq. 22).
    #[error(
        "sin θ₁ = {:e} and sin θ₂ = {:e} of the mean: both must be above zero for the angles to \
         have directions; give the covariance of small turns instead",
        .sines[0], .sines[1]
    )]
    Pole {
        /// sin θ₁ and sin θ₂.
        sines: [f64; 2],
    },
}

/// The radially constrained Gaussian (RCG) on unit quaternions.
///
/// # Definition
/// A Gaussian N(m, Σ) in ℝ⁴ (Peck 2003, Eq. 12), |m| = 1, conditioned on unit length (Eq. 18;
/// Nicewarner & Sanderson 1994, doi:10.1109/ROBOT.1994.351131; Peck 2003, Eq. 20-26):
///
/// f(x) = exp(−½ (x − m)ᵀ Σ⁻¹ (x − m)) / C, with respect to surface measure on S³,
///
/// x = (x₁, x₂, x₃, x₄) scalar last, C the normaliser that makes it integrate to one.
///
/// # Two lobes
/// q and −q are one attitude, and the law knows nothing of it. Where Σ is wide along m, a second
/// lobe of probability appears near the reflection of m: with the covariance of Peck (2003,
/// Eq. 30) it lies near (m₁, m₂, m₃, −m₄) and holds 3.46 % of the mass. As attitudes those draws lie
/// about the *inverse* of the mean. Use [`MeanHalf`](crate::MeanHalf) to keep to the half
/// sphere around the mean.
///
/// # Algorithm
/// See [`FisherBingham`].
///
/// # Limits
/// Eigenvalues of Σ between 1e-14 and 1e14, any ratio.
#[derive(Clone, Debug, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Parameters", into = "Parameters"))]
#[getset(get_copy = "pub")]
pub struct RadiallyConstrainedGaussian {
    /// The mean attitude m, about which the Gaussian in ℝ⁴ is centred.
    mean: UnitQuaternion<f64>,
    /// The covariance Σ of the Gaussian in ℝ⁴. Of a law that was not made by [`new`](Self::new) it is
    /// rounded: next to a variance of 1e14, those of a narrow law are lost off the coordinate axes, and
    /// Σ may be indefinite. The law itself keeps its principal axes and variances.
    covariance: Matrix4<f64>,
    /// Σ⁻¹.
    precision: Matrix4<f64>,
    /// Axes and variances, if the law was made of them.
    #[cfg(feature = "serde")]
    #[getset(skip)]
    principal: Option<Box<Principal>>,
    #[getset(skip)]
    law: FisherBingham,
}

/// Principal axes (columns) and variances of Σ.
#[cfg(feature = "serde")]
#[derive(Clone, Copy, Debug)]
struct Principal {
    axes: Matrix4<f64>,
    variances: [f64; 4],
}

/// Of the same mean, covariance and precision, from which all else follows.
impl PartialEq for RadiallyConstrainedGaussian {
    fn eq(&self, other: &Self) -> bool {
        let parts = |law: &Self| (law.mean, law.covariance, law.precision);
        parts(self) == parts(other)
    }
}

impl RadiallyConstrainedGaussian {
    /// The law with mean attitude m and covariance Σ, rows and columns in the order of
    /// x = (x₁, x₂, x₃, x₄), scalar last.
    ///
    /// A variance on the diagonal may be infinite where the rest of its row is zero; it is taken as
    /// 1e14, which is the same law to rounding. With an infinite variance along m it is Bingham's.
    ///
    /// # Errors
    /// The mean is not a unit quaternion, or Σ is not finite, symmetric and positive definite.
    pub fn new(mean: UnitQuaternion<f64>, covariance: Matrix4<f64>) -> Result<Self, RcgError> {
        let mean = checked_mean(mean)?;
        let covariance = checked_covariance(covariance)?;
        let (eigenvalues, axes) = jacobi::eigen(&covariance);
        check_eigenvalues(eigenvalues, &covariance)?;
        Ok(Self::from_eigenform(mean, covariance, eigenvalues, axes))
    }

    /// With the covariance T Σ̄ Tᵀ for an orthogonal T. Σ̄ is decomposed as it is given: turned, its
    /// small eigenvalues could be lost in the rounding of the large ones.
    pub(crate) fn turned(
        mean: UnitQuaternion<f64>,
        local: Matrix4<f64>,
        turn: &Matrix4<f64>,
    ) -> Result<Self, RcgError> {
        let local = checked_covariance(local)?;
        let (variances, axes) = jacobi::eigen(&local);
        check_eigenvalues(variances, &local)?;
        Self::from_principal(mean, turn * axes, variances)
    }

    fn from_eigenform(
        mean: UnitQuaternion<f64>,
        covariance: Matrix4<f64>,
        eigenvalues: [f64; 4],
        axes: Matrix4<f64>,
    ) -> Self {
        let lambda = eigenvalues.map(|s| 1.0 / s);
        let centre = axes.tr_mul(&mean.coords);
        let precision = axes * Matrix4::from_diagonal(&lambda.into()) * axes.transpose();
        let law = FisherBingham::centred(axes, lambda, centre.into(), 0.0, 0.0);
        Self {
            mean,
            covariance,
            precision,
            #[cfg(feature = "serde")]
            principal: None,
            law,
        }
    }

    /// From the principal axes (columns) and variances of Σ, where its entries cannot hold both the
    /// small variances and the large. Variances are clamped to the range of the law; 1e14 stands
    /// for infinity.
    ///
    /// # Errors
    /// The mean is not a unit quaternion, the axes are not orthonormal, or a variance is NaN or not
    /// positive.
    pub(crate) fn from_principal(
        mean: UnitQuaternion<f64>,
        axes: Matrix4<f64>,
        variances: [f64; 4],
    ) -> Result<Self, RcgError> {
        let mean = checked_mean(mean)?;
        let deviation = (axes.tr_mul(&axes) - Matrix4::identity()).abs();
        if let Some(&deviation) = deviation.iter().find(|d| !(**d < 1e-12)) {
            return Err(RcgError::Axes { deviation });
        }
        if let Some(&eigenvalue) = variances.iter().find(|s| !(**s > 0.0)) {
            return Err(RcgError::Eigenvalue { eigenvalue });
        }
        let variances = variances.map(|s| s.clamp(*EIGENVALUES.start(), *EIGENVALUES.end()));
        let covariance = axes * Matrix4::from_diagonal(&variances.into()) * axes.transpose();
        let covariance = (covariance + covariance.transpose()) * 0.5;
        Ok(Self {
            #[cfg(feature = "serde")]
            principal: Some(Box::new(Principal { axes, variances })),
            ..Self::from_eigenform(mean, covariance, variances, axes)
        })
    }

    /// ln C = ln ∫ exp(−½ (x − m)ᵀ Σ⁻¹ (x − m)) dS over S³; the c of Peck (2003, Eq. 21) is 1/C, and
    /// f_r(1) (Eq. 19), the density of the Gaussian's radius at 1, is C/((2π)² √|Σ|).
    #[must_use]
    pub fn ln_normaliser(&self) -> f64 {
        self.law.ln_centred_normaliser()
    }

    /// The logarithm of the density at q, with respect to surface measure on S³.
    #[must_use]
    pub fn ln_density(&self, q: &UnitQuaternion<f64>) -> f64 {
        self.law.ln_density(q)
    }

    /// The logarithm of the density of the *attitude*, at q and −q together, with respect to
    /// surface measure on the half of S³ that represents every attitude once (total π²).
    #[must_use]
    pub fn ln_attitude_density(&self, q: &UnitQuaternion<f64>) -> f64 {
        self.law.ln_attitude_density(q)
    }

    /// The logarithm of the density of the attitude with respect to Haar measure on SO(3),
    /// normalised to one: 0 everywhere for the uniform law.
    #[must_use]
    pub fn ln_haar_density(&self, q: &UnitQuaternion<f64>) -> f64 {
        self.law.ln_haar_density(q)
    }

    /// The logarithm of the density of Φ with respect to dθ₁ dθ₂ dθ₃ (Peck 2003, Eq. 26): that on
    /// S³ times the Jacobian determinant sin²θ₁ sin θ₂ (Eq. 17 and 20).
    #[must_use]
    pub fn ln_density_of_angles(&self, angles: &HypersphericalAngles) -> f64 {
        self.ln_density(&angles.quaternion()) + libm::log(angles.jacobian())
    }

    /// The mean E x of the four coordinates, a vector inside the unit ball.
    #[must_use]
    pub fn mean_vector(&self) -> Vector4<f64> {
        self.law.mean_vector()
    }

    /// The second moment E xxᵀ, of trace one.
    #[must_use]
    pub fn second_moment(&self) -> Matrix4<f64> {
        self.law.second_moment()
    }

    /// The mean attitude, q and −q counting alike: see [`FisherBingham::mean_attitude`]. It is not
    /// [`mean`](Self::mean), but near it where the law is concentrated.
    #[must_use]
    pub fn mean_attitude(&self) -> UnitQuaternion<f64> {
        self.law.mean_attitude()
    }

    /// The covariance of the attitude in body axes, rad²: see [`FisherBingham::rotation_covariance`].
    #[must_use]
    pub fn rotation_covariance(&self) -> Matrix3<f64> {
        self.law.rotation_covariance()
    }

    /// Expectations of polynomials in x: see [`FisherBingham::expect`].
    pub fn expect<const N: usize>(
        &self,
        polynomials: impl Fn(&[Complex<f64>; 4]) -> [Complex<f64>; N],
    ) -> [f64; N] {
        self.law.expect(polynomials)
    }

    /// Expectations of all monomials of x − E x: see [`FisherBingham::central_moments`].
    #[must_use]
    pub fn central_moments(&self) -> CentralMoments {
        self.law.central_moments()
    }

    pub(crate) fn law(&self) -> &FisherBingham {
        &self.law
    }

    /// The share of the law in the half sphere away from the mean, x·m < 0: the weight of the second
    /// lobe where there is one. To about 1e-12 of itself, however small; takes a few milliseconds.
    ///
    /// ```
    /// use gyradius_attitude::RadiallyConstrainedGaussian;
    /// use nalgebra::{Matrix4, UnitQuaternion};
    ///
    /// let identity = UnitQuaternion::identity();
    /// let law = |variance| {
    ///     RadiallyConstrainedGaussian::new(identity, Matrix4::from_diagonal_element(variance))
    /// };
    /// assert!(law(0.01)?.far_half_share() < 1e-40);
    /// assert!((law(1e9)?.far_half_share() - 0.5).abs() < 1e-8);
    /// # Ok::<(), gyradius_attitude::RcgError>(())
    /// ```
    #[must_use]
    pub fn far_half_share(&self) -> f64 {
        let (_, lambda, centre, _) = self.law.eigenform();
        let share = libm::exp(far_half::ln_integral(lambda, centre) - self.ln_normaliser());
        if share > 1.0 { 1.0 } else { share }
    }

    /// Whether q lies in the half sphere around the mean, x·m ≥ 0.
    #[must_use]
    pub fn in_mean_half(&self, q: &UnitQuaternion<f64>) -> bool {
        q.coords.dot(&self.mean.coords) >= 0.0
    }

    /// The share of proposals that the sampler accepts.
    #[must_use]
    pub fn acceptance(&self) -> f64 {
        self.law.acceptance()
    }

    /// Fills a slice with independent draws: see [`FisherBingham::sample_into`].
    pub fn sample_into<R: Rng + ?Sized>(&self, rng: &mut R, out: &mut [UnitQuaternion<f64>]) {
        self.law.sample_into(rng, out);
    }

    /// How the law is sampled.
    #[must_use]
    pub fn method(&self) -> Method {
        self.law.method()
    }
}

impl Distribution<UnitQuaternion<f64>> for RadiallyConstrainedGaussian {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        self.law.sample(rng)
    }
}

pub(crate) fn checked_mean(mean: UnitQuaternion<f64>) -> Result<UnitQuaternion<f64>, RcgError> {
    let norm = mean.norm();
    if !((norm - 1.0).abs() < 1e-9) {
        return Err(RcgError::Mean { norm });
    }
    // A mean that is unit to rounding is kept to the bit, so that a law read back is the same law.
    let exact = (mean.norm_squared() - 1.0).abs() <= 4.0 * f64::EPSILON;
    Ok(if exact { mean } else { UnitQuaternion::new_normalize(mean.into_inner()) })
}

/// Finite, symmetric, with variances in range.
pub(crate) fn checked_covariance(mut covariance: Matrix4<f64>) -> Result<Matrix4<f64>, RcgError> {
    for j in 0..4 {
        let alone =
            (0..4).all(|i| i == j || (covariance[(i, j)] == 0.0 && covariance[(j, i)] == 0.0));
        if covariance[(j, j)] == f64::INFINITY && alone {
            covariance[(j, j)] = *EIGENVALUES.end();
        }
    }
    for row in 0..4 {
        for column in 0..4 {
            let value = covariance[(row, column)];
            if !value.is_finite() {
                return Err(RcgError::Entry { row: row + 1, column: column + 1, value });
            }
        }
    }
    if let Some(&eigenvalue) = covariance.diagonal().iter().find(|s| !EIGENVALUES.contains(*s)) {
        return Err(RcgError::Eigenvalue { eigenvalue });
    }
    // An entry is as large as its two variances allow, so rounding is measured against them.
    let deviations = covariance.diagonal().map(f64::sqrt);
    symmetric_part(&covariance, |i, j| deviations[i] * deviations[j]).map_err(|[row, column]| {
        RcgError::NotSymmetric {
            row: row + 1,
            column: column + 1,
            upper: covariance[(row, column)],
            lower: covariance[(column, row)],
        }
    })
}

fn check_eigenvalues(eigenvalues: [f64; 4], covariance: &Matrix4<f64>) -> Result<(), RcgError> {
    let smallest = eigenvalues.into_iter().fold(f64::INFINITY, f64::min);
    let largest = eigenvalues.into_iter().fold(0.0, f64::max);
    if !EIGENVALUES.contains(&smallest) || !is_definite(covariance) {
        return Err(RcgError::Eigenvalue { eigenvalue: smallest });
    }
    if !EIGENVALUES.contains(&largest) {
        return Err(RcgError::Eigenvalue { eigenvalue: largest });
    }
    Ok(())
}

/// Definite with room for rounding, whatever the scales of the four coordinates.
fn is_definite(covariance: &Matrix4<f64>) -> bool {
    let d = covariance.diagonal().map(f64::sqrt);
    let correlation = Matrix4::from_fn(|i, j| covariance[(i, j)] / (d[i] * d[j]));
    (correlation - Matrix4::identity() * (16.0 * f64::EPSILON)).cholesky().is_some()
}

/// The serialized form: mean scalar last, and either Σ by rows or its principal axes, each a row, and
/// variances, whichever the law was made of: what is read back is the same law to the bit.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Parameters {
    mean: [f64; 4],
    #[serde(default)]
    covariance: Option<[[f64; 4]; 4]>,
    #[serde(default)]
    principal_axes: Option<[[f64; 4]; 4]>,
    #[serde(default)]
    principal_variances: Option<[f64; 4]>,
}

#[cfg(feature = "serde")]
impl TryFrom<Parameters> for RadiallyConstrainedGaussian {
    type Error = String;

    fn try_from(p: Parameters) -> Result<Self, String> {
        let mean = UnitQuaternion::new_unchecked(Vector4::from(p.mean).into());
        match (p.covariance, p.principal_axes, p.principal_variances) {
            (Some(rows), None, None) => Self::new(mean, Matrix4::from_fn(|i, j| rows[i][j])),
            (None, Some(axes), Some(variances)) => {
                Self::from_principal(mean, Matrix4::from(axes), variances)
            }
            _ => {
                return Err("either covariance, or principal_axes and principal_variances".into());
            }
        }
        .map_err(|error| error.to_string())
    }
}

#[cfg(feature = "serde")]
impl From<RadiallyConstrainedGaussian> for Parameters {
    fn from(law: RadiallyConstrainedGaussian) -> Self {
        let covariance = law.covariance.transpose().into();
        Self {
            mean: law.mean.coords.into(),
            covariance: law.principal.is_none().then_some(covariance),
            principal_axes: law.principal.as_ref().map(|p| p.axes.into()),
            principal_variances: law.principal.as_ref().map(|p| p.variances),
        }
    }
}

#[cfg(test)]
mod tests;
