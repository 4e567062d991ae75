use nalgebra::{Complex, Matrix3, Matrix4, UnitQuaternion, Vector4};
use rand::Rng;
use rand_distr::Distribution;

use crate::{
    FisherBingham, HypersphericalAngles, Method, far_half, fisher_bingham::symmetric_part, jacobi,
};

/// Range of the eigenvalues of Σ: beyond it the law is uniform, or a point, to rounding.
const EIGENVALUES: std::ops::RangeInclusive<f64> = 1e-14..=1e14;

/// ln π², the measure of the attitudes on half of S³.
pub(crate) const LN_PI_SQUARED: f64 = 2.289_459_771_698_800_3;

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
/// A Gaussian N(m, Σ) in ℝ⁴, |m| = 1, conditioned on unit length (Nicewarner & Sanderson 1994,
/// doi:10.1109/ROBOT.1994.351131; Peck 2003, Eq. 20-26):
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
#[derive(Clone, Debug)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Parameters", into = "Parameters")
)]
pub struct RadiallyConstrainedGaussian {
    mean: UnitQuaternion<f64>,
    covariance: Matrix4<f64>,
    precision: Matrix4<f64>,
    /// Axes and variances, if the law was made of them.
    #[cfg(feature = "serde")]
    principal: Option<Box<Principal>>,
    law: FisherBingham,
}

/// Principal axes (columns) and variances of Σ.
#[cfg(feature = "serde")]
#[derive(Clone, Copy, Debug)]
struct Principal {
    axes: Matrix4<f64>,
    variances: [f64; 4],
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
        let center = axes.tr_mul(&mean.coords);
        let precision = axes * Matrix4::from_diagonal(&lambda.into()) * axes.transpose();
        let law = FisherBingham::centered(axes, lambda, center.into(), 0.0, 0.0);
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

    /// The mean attitude m, about which the Gaussian in ℝ⁴ is centred.
    #[must_use]
    pub fn mean(&self) -> UnitQuaternion<f64> {
        self.mean
    }

    /// The covariance Σ of the Gaussian in ℝ⁴. Of a law that was not made by [`new`](Self::new) it is
    /// rounded: next to a variance of 1e14, those of a narrow law are lost off the coordinate axes, and
    /// Σ may be indefinite. The law itself keeps its principal axes and variances.
    #[must_use]
    pub fn covariance(&self) -> Matrix4<f64> {
        self.covariance
    }

    /// Σ⁻¹.
    #[must_use]
    pub fn precision(&self) -> Matrix4<f64> {
        self.precision
    }

    /// ln C = ln ∫ exp(−½ (x − m)ᵀ Σ⁻¹ (x − m)) dS over S³; the c of Peck (2003, Eq. 21) is 1/C.
    #[must_use]
    pub fn ln_normaliser(&self) -> f64 {
        self.law.ln_centered_normaliser()
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
        let (a, b) = (self.ln_density(q), self.ln_density(&opposite(q)));
        a.max(b) + libm::log1p(libm::exp(-(a - b).abs()))
    }

    /// The logarithm of the density of the attitude with respect to Haar measure on SO(3),
    /// normalised to one: 0 everywhere for the uniform law.
    #[must_use]
    pub fn ln_haar_density(&self, q: &UnitQuaternion<f64>) -> f64 {
        self.ln_attitude_density(q) + LN_PI_SQUARED
    }

    /// The logarithm of the density of Φ with respect to dθ₁ dθ₂ dθ₃ (Peck 2003, Eq. 26): that on
    /// S³ times the Jacobian determinant sin²θ₁ sin θ₂.
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
        let (_, lambda, center, _) = self.law.eigenform();
        let share = libm::exp(far_half::ln_integral(lambda, center) - self.ln_normaliser());
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

fn opposite(q: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(-q.into_inner())
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
mod tests {
    use super::*;
    use nalgebra::Quaternion;
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    /// Reference values of a law with a diagonal covariance, from the contour integral in 200-bit
    /// arithmetic; the mean is normalised first.
    struct Case {
        name: &'static str,
        mean: [f64; 4],
        variances: [f64; 4],
        ln_normaliser: f64,
        mean_vector: [f64; 4],
        /// Lower triangle of E[x xᵀ] by rows.
        second_moment: [f64; 10],
    }

    fn reference() -> Vec<Case> {
        vec![
            Case {
                name: "paper",
                mean: [0.0249, 0.0005, -0.01, 0.9996],
                variances: [2e-05, 0.0006, 0.0006, 0.6],
                ln_normaliser: -10.035477697452611,
                mean_vector: [
                    0.02490154679418918,
                    0.0005003551755707711,
                    -0.010007103511415422,
                    0.9299096550480864,
                ],
                second_moment: [
                    0.0006400874794873405,
                    1.2459617942002008e-05,
                    0.0006006526746273734,
                    -0.00024919235884004017,
                    -5.007107534015433e-06,
                    0.0007005444699309814,
                    0.02315561389445006,
                    0.0004649380923373893,
                    -0.009298761846747786,
                    0.9980587153759543,
                ],
            },
            Case {
                name: "iso1",
                mean: [0.0, 0.0, 0.0, 1.0],
                variances: [1.0, 1.0, 1.0, 1.0],
                ln_normaliser: 2.1051061453278597,
                mean_vector: [0.0, 0.0, 0.0, 0.24019372387008975],
                second_moment: [
                    0.24019372387008975,
                    0.0,
                    0.24019372387008975,
                    0.0,
                    0.0,
                    0.24019372387008975,
                    0.0,
                    0.0,
                    0.0,
                    0.27941882838973076,
                ],
            },
            Case {
                name: "diag1234",
                mean: [1.0, 2.0, 3.0, 4.0],
                variances: [0.1, 0.2, 0.3, 0.4],
                ln_normaliser: 0.3458571649223226,
                mean_vector: [
                    0.1714838973168175,
                    0.29154448146123724,
                    0.36719867677087126,
                    0.41737777666940246,
                ],
                second_moment: [
                    0.12118547795454061,
                    0.04383992680209719,
                    0.22833220347508526,
                    0.05359869977206694,
                    0.08287501868197618,
                    0.30059362651557814,
                    0.05985849976616203,
                    0.09189564569429172,
                    0.10993689971892281,
                    0.349888692054796,
                ],
            },
            Case {
                name: "aniso",
                mean: [1.0, -1.0, 1.0, -1.0],
                variances: [1e-06, 0.0001, 0.01, 1.0],
                ln_normaliser: -9.770789315952086,
                mean_vector: [
                    0.5000027366843739,
                    -0.5002738853332012,
                    0.5291912302172037,
                    -0.10240548964626271,
                ],
                second_moment: [
                    0.25000373670080805,
                    -0.2501383121042209,
                    0.2503740495885614,
                    0.26459707467923554,
                    -0.2647416623049857,
                    0.2903539303625083,
                    -0.051202546024309036,
                    0.051182849413806075,
                    -0.04904726128489428,
                    0.20926828334812225,
                ],
            },
            Case {
                name: "bimodal_antipodal_s4",
                mean: [0.02, -0.01, 0.03, 0.999],
                variances: [0.0001, 0.0002, 0.0003, 100.0],
                ln_normaliser: -9.478599176362945,
                mean_vector: [
                    0.020008017720486052,
                    -0.010005021981804337,
                    0.030018107135323817,
                    0.00997265958500535,
                ],
                second_moment: [
                    0.000500330903257712,
                    -0.0002001806651573454,
                    0.0003001409734900034,
                    0.0006006028557529055,
                    -0.00030033185801688745,
                    0.0012011780729828984,
                    0.0001994931602752837,
                    -9.973668084019878e-05,
                    0.0002991803384889109,
                    0.9979983500502694,
                ],
            },
        ]
    }

    fn law(mean: [f64; 4], variances: [f64; 4]) -> RadiallyConstrainedGaussian {
        let mean = UnitQuaternion::from_quaternion(Quaternion::from(Vector4::from(mean)));
        RadiallyConstrainedGaussian::new(mean, Matrix4::from_diagonal(&variances.into())).unwrap()
    }

    fn paper() -> RadiallyConstrainedGaussian {
        law([0.0249, 0.0005, -0.0100, 0.9996], [2e-5, 6e-4, 6e-4, 0.6])
    }

    #[test]
    fn normaliser_and_moments_match_the_reference() {
        for case in reference() {
            let law = law(case.mean, case.variances);
            let error = law.ln_normaliser() - case.ln_normaliser;
            assert!(error.abs() < 1e-13, "{}: ln C off by {error:e}", case.name);
            let second = law.second_moment();
            let mut k = 0;
            for i in 0..4 {
                let error = law.mean_vector()[i] - case.mean_vector[i];
                assert!(error.abs() < 1e-13, "{}: E x{i} off by {error:e}", case.name);
                for j in 0..=i {
                    let error = second[(i, j)] - case.second_moment[k];
                    assert!(error.abs() < 1e-13, "{}: E x{i}x{j} off by {error:e}", case.name);
                    k += 1;
                }
            }
        }
    }

    #[test]
    fn acceptance_is_useful() {
        for case in reference() {
            let law = law(case.mean, case.variances);
            assert!(law.acceptance() > 0.6, "{}: {}", case.name, law.acceptance());
        }
        assert!(paper().acceptance() > 0.9999, "{}", paper().acceptance());
        assert_eq!(paper().method(), Method::Chart);
    }

    /// χ² of one coordinate in 40 bins against the marginal density by quadrature over the sphere.
    fn chi_squared(
        samples: impl Iterator<Item = UnitQuaternion<f64>>,
        law: &RadiallyConstrainedGaussian,
    ) -> f64 {
        // Marginal of x₄: integrate the density over the two-sphere of (x₁, x₂, x₃), Gauss-Legendre
        // being unnecessary where the integrand is periodic and smooth.
        const BINS: usize = 40;
        const POINTS: usize = 64;
        let pi = std::f64::consts::PI;
        let density = |x4: f64| {
            let r = (1.0 - x4 * x4).sqrt();
            let mut sum = 0.0;
            for i in 0..POINTS {
                let z = -1.0 + 2.0 * (i as f64 + 0.5) / POINTS as f64;
                for j in 0..POINTS {
                    let (s, c) = (2.0 * pi * j as f64 / POINTS as f64).sin_cos();
                    let rho = r * (1.0 - z * z).sqrt();
                    let q = Quaternion::new(x4, rho * c, rho * s, r * z);
                    sum += law.ln_density(&UnitQuaternion::new_unchecked(q)).exp();
                }
            }
            r * sum * 4.0 * pi / (POINTS * POINTS) as f64
        };
        let mut expected = [0.0; BINS];
        for (bin, mass) in expected.iter_mut().enumerate() {
            for k in 0..8 {
                let x = -1.0 + (bin as f64 + (k as f64 + 0.5) / 8.0) * 2.0 / BINS as f64;
                *mass += density(x) * 2.0 / (8 * BINS) as f64;
            }
        }
        assert!((expected.iter().sum::<f64>() - 1.0).abs() < 2e-3);
        let mut counts = [0.0; BINS];
        let mut n = 0.0;
        for q in samples {
            counts[(((q.w + 1.0) * 0.5 * BINS as f64) as usize).min(BINS - 1)] += 1.0;
            n += 1.0;
        }
        counts.iter().zip(expected).map(|(c, e)| (c - n * e) * (c - n * e) / (n * e)).sum()
    }

    /// Draws of a mild law follow its density; draws with the Jacobian counted twice, or with one
    /// lobe missing, do not, and the same test sees it at the same n.
    #[test]
    fn draws_follow_the_density_and_wrong_ones_do_not() {
        use rand::RngExt;
        const N: usize = 100_000;
        let law = law([0.2, -0.1, 0.3, 0.9], [0.3, 0.4, 0.5, 0.8]);
        let draws = || {
            let mut rng = ChaCha8Rng::seed_from_u64(11);
            let law = law.clone();
            std::iter::repeat_with(move || law.sample(&mut rng))
        };
        // 39 degrees of freedom: 72 is exceeded once in a thousand.
        let right = chi_squared(draws().take(N), &law);
        assert!(right < 72.0, "{right}");
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        let doubled =
            draws().filter(|q| rng.random::<f64>() < HypersphericalAngles::of(q).jacobian());
        assert!(chi_squared(doubled.take(N), &law) > 1000.0);
        let one_lobe = draws().filter(|q| law.in_mean_half(q));
        assert!(chi_squared(one_lobe.take(N), &law) > 1000.0);
    }

    /// The far half of the paper's example holds 3.46 % of the mass.
    #[test]
    fn the_far_lobe_is_there() {
        const N: usize = 400_000;
        let law = paper();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let far = (0..N).filter(|_| !law.in_mean_half(&law.sample(&mut rng))).count();
        let share = far as f64 / N as f64;
        let z = (share - FAR_SHARE) / (FAR_SHARE * (1.0 - FAR_SHARE) / N as f64).sqrt();
        assert!(z.abs() < 3.5, "share {share}, z = {z}");
    }

    /// The share of the far half against slices in 34 digits (mpmath), in the order of `reference`.
    #[test]
    fn the_far_half_is_known() {
        let shares = [
            FAR_SHARE,
            0.299_380_051_162_704_14,
            0.052_181_982_158_876_55,
            4.208_169_397_275_7e-19,
            0.495_008_673_263_920_45,
        ];
        for (case, share) in reference().into_iter().zip(shares) {
            let found = law(case.mean, case.variances).far_half_share();
            assert!((found / share - 1.0).abs() < 1e-12, "{}: {found:e} {share:e}", case.name);
        }
    }

    /// P(x·m < 0) for the paper's example: quadrature over slices of x·m, the normaliser of each
    /// slice by a contour integral (mpmath, 50 digits).
    const FAR_SHARE: f64 = 0.034_593_156_655_512_09;

    #[test]
    fn densities_are_consistent() {
        let law = paper();
        let q = UnitQuaternion::from_euler_angles(0.05, 0.01, -0.02);
        let angles = HypersphericalAngles::of(&q);
        let by_angles = law.ln_density_of_angles(&angles) - angles.jacobian().ln();
        assert!((by_angles - law.ln_density(&q)).abs() < 1e-9);
        let sum = law.ln_density(&q).exp() + law.ln_density(&opposite(&q)).exp();
        assert!((law.ln_attitude_density(&q) - sum.ln()).abs() < 1e-12);
        assert_eq!(law.ln_attitude_density(&q), law.ln_attitude_density(&opposite(&q)));
        // At the mean the exponent is zero.
        assert!((law.ln_density(&law.mean()) + law.ln_normaliser()).abs() < 1e-12);
    }

    #[test]
    fn the_haar_density_of_a_flat_law_is_one_and_integrates_to_one() {
        let flat = law([0.1, 0.2, 0.3, 0.9], [1e12; 4]);
        let q = UnitQuaternion::from_euler_angles(0.5, 0.1, -0.2);
        assert!(flat.ln_haar_density(&q).abs() < 1e-11);
        // The mean over an even grid of attitudes is the integral.
        let law = law([0.2, -0.1, 0.3, 0.9], [0.3, 0.4, 0.5, 0.8]);
        let n = 20_000;
        let sum: f64 = crate::super_fibonacci(n).map(|q| law.ln_haar_density(&q).exp()).sum();
        assert!((sum / f64::from(n) - 1.0).abs() < 1e-3, "{}", sum / f64::from(n));
    }

    #[test]
    fn bad_parameters_are_named() {
        let mean = UnitQuaternion::identity();
        let one = Matrix4::<f64>::identity();
        let with = |i, j, value| {
            let mut m = one;
            m[(i, j)] = value;
            m[(j, i)] = value;
            RadiallyConstrainedGaussian::new(mean, m)
        };
        assert!(matches!(with(1, 1, f64::NAN), Err(RcgError::Entry { row: 2, column: 2, .. })));
        assert!(matches!(with(1, 2, f64::INFINITY), Err(RcgError::Entry { .. })));
        for bad in [0.0, -1.0, 1e-300, 1e300, -0.0] {
            assert!(matches!(with(3, 3, bad), Err(RcgError::Eigenvalue { .. })), "{bad}");
        }
        assert!(matches!(with(0, 1, 1.0), Err(RcgError::Eigenvalue { .. })), "singular");
        assert!(matches!(with(0, 1, 1.1), Err(RcgError::Eigenvalue { .. })), "indefinite");
        let mut skew = one;
        skew[(2, 0)] = 0.3;
        assert!(matches!(
            RadiallyConstrainedGaussian::new(mean, skew),
            Err(RcgError::NotSymmetric { row: 1, column: 3, .. })
        ));
        for bad in [Quaternion::new(2.0, 0.0, 0.0, 0.0), Quaternion::new(f64::NAN, 0.0, 0.0, 0.0)] {
            let bad = UnitQuaternion::new_unchecked(bad);
            assert!(matches!(
                RadiallyConstrainedGaussian::new(bad, one),
                Err(RcgError::Mean { .. })
            ));
        }
    }

    /// L(q) Σ L(q)ᵀ is symmetric to rounding of its variances, not of its own small entries.
    #[test]
    fn covariances_symmetric_to_rounding_are_accepted() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let variances = Matrix4::from_diagonal(&Vector4::new(1e-4, 1e-4, 1e-4, 1e-2));
        for _ in 0..1000 {
            let m: UnitQuaternion<f64> = crate::UniformAttitude.sample(&mut rng);
            let (x, w) = (m.imag(), m.w);
            let left = Matrix4::new(
                w, -x.z, x.y, x.x, x.z, w, -x.x, x.y, -x.y, x.x, w, x.z, -x.x, -x.y, -x.z, w,
            );
            assert!(
                RadiallyConstrainedGaussian::new(m, left * variances * left.transpose()).is_ok()
            );
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let law = paper();
        let json = serde_json::to_string(&law).unwrap();
        let back: RadiallyConstrainedGaussian = serde_json::from_str(&json).unwrap();
        assert_eq!(back.covariance(), law.covariance());
        assert_eq!(back.mean(), law.mean());
        let read = |json: &str| serde_json::from_str::<RadiallyConstrainedGaussian>(json);
        assert!(read(&json.replace("0.6]", "-0.6]")).is_err());
        assert!(
            read(
                &json.replace("\"principal_variances\":null", "\"principal_variances\":[1,1,1,1]")
            )
            .is_err()
        );
        assert!(read(r#"{"mean":[0,0,0,1]}"#).is_err());
    }

    /// Σ cannot hold these: 20 decades of variances, off the coordinate axes.
    #[cfg(feature = "serde")]
    #[test]
    fn laws_of_narrow_turns_are_read_back_to_the_bit() {
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        for variance in [1e-12, 1e-6, 1.0] {
            for radial in [1e-3, 1.0, f64::INFINITY] {
                let mean: UnitQuaternion<f64> = crate::UniformAttitude.sample(&mut rng);
                let turns = Matrix3::new(2.0, 0.3, 0.1, 0.3, 1.0, -0.2, 0.1, -0.2, 3.0) * variance;
                let law =
                    RadiallyConstrainedGaussian::from_rotation_covariance(mean, turns, radial)
                        .unwrap();
                let json = serde_json::to_string(&law).unwrap();
                let back: RadiallyConstrainedGaussian = serde_json::from_str(&json).unwrap();
                assert_eq!(serde_json::to_string(&back).unwrap(), json);
                assert_eq!(back.covariance(), law.covariance());
                assert_eq!(back.ln_normaliser(), law.ln_normaliser());
                let mut two = [9, 9].map(ChaCha8Rng::seed_from_u64);
                assert_eq!(back.sample(&mut two[0]), law.sample(&mut two[1]));
                let bent = json.replace("\"principal_axes\":[[", "\"principal_axes\":[[1");
                assert!(serde_json::from_str::<RadiallyConstrainedGaussian>(&bent).is_err());
            }
        }
    }

    /// The first draws from a fixed seed, by every method: they change only on purpose.
    #[test]
    fn value_stability() {
        let chart = paper();
        let cells = law([1.0, 2.0, 3.0, 4.0], [0.1, 0.2, 0.3, 0.4]);
        let uniform = law([0.1, 0.2, 0.3, 0.9], [30.0, 40.0, 50.0, 60.0]);
        let methods = [&chart, &cells, &uniform].map(RadiallyConstrainedGaussian::method);
        assert_eq!(methods, [Method::Chart, Method::Cells, Method::Uniform]);
        let rng = || ChaCha8Rng::seed_from_u64(2003);
        let first = |law: &RadiallyConstrainedGaussian| -> [[f64; 4]; 2] {
            let mut rng = rng();
            std::array::from_fn(|_| law.sample(&mut rng).coords.into())
        };
        let mut batch = [UnitQuaternion::identity(); 2];
        chart.sample_into(&mut rng(), &mut batch);
        let batch = batch.map(|q| q.coords.into());
        let draws = [first(&chart), first(&cells), first(&uniform), batch];
        assert_eq!(draws, STABLE, "{draws:?}");
    }

    const STABLE: [[[f64; 4]; 2]; 4] = [
        [
            [0.021931335513137543, 0.028758680952151113, -0.022801111764040222, 0.9990856139965315],
            [0.01803179853973027, -0.023412739435957442, -0.013338272616791994, 0.9994742559751735],
        ],
        [
            [0.4781400671436293, 0.33720595561793343, 0.8074743528955786, 0.07522891135427],
            [0.05106772118743973, 0.37527717545126393, 0.9206337127346604, -0.09482982871669668],
        ],
        [
            [-0.36825331736519773, 0.3210772847171893, 0.624186793829993, 0.6096636104413626],
            [0.03501630558720559, -0.39485538788929203, -0.7197994827305837, 0.5698699725890143],
        ],
        [
            [
                0.021196543776986033,
                -0.04324901390506127,
                -0.025808891677750443,
                -0.9985059491252499,
            ],
            [0.01556455563597926, 0.03901980617150276, 0.023827323845572717, 0.9988330480979046],
        ],
    ];

    /// A batch is independent of its length, and of the same law.
    #[test]
    fn batches_are_draws_of_the_law() {
        const N: usize = 400_000;
        let law = paper();
        let mut batch = vec![UnitQuaternion::identity(); N];
        law.sample_into(&mut ChaCha8Rng::seed_from_u64(5), &mut batch);
        let mut short = vec![UnitQuaternion::identity(); 1001];
        law.sample_into(&mut ChaCha8Rng::seed_from_u64(5), &mut short);
        assert_eq!(short[..], batch[..1001]);
        let second = law.second_moment();
        for i in 0..4 {
            for j in 0..=i {
                let values = || batch.iter().map(|q| q.coords[i] * q.coords[j]);
                let mean = values().sum::<f64>() / N as f64;
                let square = values().map(|v| (v - mean) * (v - mean)).sum::<f64>() / N as f64;
                let z = (mean - second[(i, j)]) / (square / N as f64).sqrt();
                assert!(z.abs() < 4.0, "E x{i} x{j}: z = {z}");
            }
        }
        let far = batch.iter().filter(|q| !law.in_mean_half(q)).count() as f64;
        let z = (far / N as f64 - FAR_SHARE) / (FAR_SHARE * (1.0 - FAR_SHARE) / N as f64).sqrt();
        assert!(z.abs() < 4.0, "far half: z = {z}");
        assert!(batch.iter().all(|q| (q.norm() - 1.0).abs() <= 4.0 * f64::EPSILON));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]
        /// Any covariance is served, and well.
        #[test]
        fn any_covariance_is_served(
            x in prop::array::uniform16(-1.0..1.0f64),
            level in -8.0..0.0f64,
            spread in prop::array::uniform4(0.0..8.0f64),
            mean in prop::array::uniform4(-1.0..1.0f64),
            seed in 0..u64::MAX,
        ) {
            let turn = Matrix4::from_row_slice(&x).qr().q();
            let variances = spread.map(|s| 10f64.powf(level + s));
            let covariance = turn * Matrix4::from_diagonal(&variances.into()) * turn.transpose();
            let covariance = (covariance + covariance.transpose()) * 0.5;
            let mean = Vector4::from(mean);
            prop_assume!(mean.norm() > 0.1);
            let mean = UnitQuaternion::from_quaternion(Quaternion::from(mean));
            let law = match RadiallyConstrainedGaussian::new(mean, covariance) {
                Ok(law) => law,
                Err(error) => return Err(TestCaseError::fail(error.to_string())),
            };
            prop_assert!(law.acceptance() > 0.6, "{} {:?}", law.acceptance(), law.method());
            prop_assert!(law.ln_normaliser().is_finite() && law.ln_normaliser() < 3.0);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            for _ in 0..10 {
                let q = law.sample(&mut rng);
                prop_assert!((q.norm() - 1.0).abs() < 1e-15 && law.ln_density(&q).is_finite());
            }
        }
    }
}
