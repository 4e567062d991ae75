//! Gaussian log-Cholesky coordinates.

use gyradius_inertia::{Inertia, InertiaMatrix, LogCholesky, LogCholeskyError, MassProperties};
use nalgebra::{Matrix3, SMatrix, SVector};
use rand::Rng;
use rand_distr::Distribution;

use crate::gaussian_monomials::{log_cholesky_entries, moments};
use crate::named_model::{NamedModel, NoMatch, inertia_law};
use crate::second_moment_matrix::{body, inertia_covariance, inertia_map};
use crate::semidefinite::{Covariance, CovarianceError, of_rows};
use crate::{EntryMoments, KnownMoments, ModelParameterError, ModelParameters};

mod closed;

/// Draws farther out than this many deviations have probability 1e-349.
const FAR: f64 = 40.0;
/// Exponents of draws, and roots of second moments.
const MAX_EXPONENT: f64 = 170.0;
const MAX_ROOT: f64 = 1e75;
/// Names of the coordinates, in order.
const NAMES: [&str; 6] = ["d1", "d2", "d3", "s12", "s23", "s13"];

/// Why coordinates and a covariance are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LogCholeskyGaussianError {
    /// The matrix is no covariance.
    #[error(transparent)]
    Covariance(#[from] CovarianceError),
    /// Draws would leave the range.
    #[error(
        "coordinate {name} of mean {mean:?} and deviation {deviation:?}: within forty deviations \
         |d| must be at most {MAX_EXPONENT} and |s| at most {MAX_ROOT:e} √kg·m"
    )]
    Coordinate {
        /// Its name.
        name: &'static str,
        /// Its mean.
        mean: f64,
        /// Its deviation.
        deviation: f64,
    },
    /// The mean body has no coordinates: it is a rod, a plate or a point.
    #[error(transparent)]
    Coordinates(#[from] LogCholeskyError),
    /// No law of this family was found with the moments that were asked for.
    #[error(
        "no Gaussian in log-Cholesky coordinates found with these moments of the entries: the spread \
         is too wide for them"
    )]
    NoMatch,
}

/// A Gaussian in log-Cholesky coordinates of the second moments.
///
/// # Definition
/// Σ = ½ tr(I)·1 − I = V Vᵀ about the mass centre, with
///
/// ```text
/// V = | exp(d₁)  s₁₂      s₁₃     |
///     | 0        exp(d₂)  s₂₃     |   √kg·m,
///     | 0        0        exp(d₃) |
/// ```
///
/// and (d₁, d₂, d₃, s₁₂, s₂₃, s₁₃) ~ N(x̄, C). These are the coordinates of Rucker & Wensing (2022,
/// doi:10.1109/LRA.2022.3144517) for the second moments alone. Their other four, mass and mass centre,
/// leave the inertia about the mass centre as it is: V is theirs times the root of the mass, which
/// adds α to each d and multiplies each s. So the six are taken for Σ itself and no mass is asked for;
/// a Gaussian in all ten has products e^α s that are not Gaussian, another law.
///
/// Mean and covariance of the entries are closed: entries are sums of products of e^d and s, and under
/// a Gaussian E[e^{aᵀx} p(x)] = e^{aᵀx̄ + ½aᵀCa} E[p(x + Ca)].
///
/// # Realizability
/// By construction: V Vᵀ is positive definite.
///
/// # Limits
/// Not invariant under rotation: axis 3 is factored first, and a Gaussian in one frame is none in
/// another. The mean of the coordinates is not the mean body: E e^{2d} > e^{2E d}.
/// [`matched`](Self::matched) solves for given moments of the entries. Rods, plates and points lie at
/// infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogCholeskyGaussian {
    mean: SVector<f64, 6>,
    covariance: Covariance<6>,
}

impl LogCholeskyGaussian {
    /// Mean and covariance of (d₁, d₂, d₃, s₁₂, s₂₃, s₁₃): exp(d) and s in √kg·m.
    ///
    /// # Errors
    /// The covariance is not finite, symmetric and positive semidefinite, or draws could leave the
    /// range.
    pub fn new(
        mean: [f64; 6],
        covariance: SMatrix<f64, 6, 6>,
    ) -> Result<Self, LogCholeskyGaussianError> {
        let covariance = Covariance::new(covariance, MAX_ROOT * MAX_ROOT)?;
        for (i, name) in NAMES.into_iter().enumerate() {
            let deviation = covariance.matrix()[(i, i)].sqrt();
            let reach = mean[i].abs() + FAR * deviation;
            if !(reach <= if i < 3 { MAX_EXPONENT } else { MAX_ROOT }) {
                let mean = mean[i];
                return Err(LogCholeskyGaussianError::Coordinate { name, mean, deviation });
            }
        }
        Ok(Self { mean: mean.into(), covariance })
    }

    /// About the coordinates of a body, which are then the medians of those of the draws.
    ///
    /// # Errors
    /// The body is a rod, a plate or a point, or as [`new`](Self::new).
    pub fn about(
        body: &Inertia,
        covariance: SMatrix<f64, 6, 6>,
    ) -> Result<Self, LogCholeskyGaussianError> {
        Self::new(coordinates(body)?, covariance)
    }

    /// The law with this mean and covariance of the six entries *to first order*: about the body of
    /// that mean, with the covariance that the linearised map takes to the one given.
    ///
    /// # Errors
    /// The mean is no body or one on the boundary, or as [`new`](Self::new).
    pub fn linearised(moments: &EntryMoments) -> Result<Self, LogCholeskyGaussianError> {
        let start = Start::new(moments)?;
        Self::new(start.mean.into(), start.covariance)
    }

    /// The law with this mean and covariance of the six entries, to 1e-9 of the largest of each. There is one at most.
    ///
    /// # Algorithm
    /// In closed form. What rounding leaves of it, in laws whose parts differ much in size, Newton's steps with the derivative of the
    /// linearised map take away.
    ///
    /// # Errors
    /// The mean is no body or one on the boundary, or no law has these moments, as is so of the widest spreads.
    pub fn matched(moments: &EntryMoments) -> Result<Self, LogCholeskyGaussianError> {
        const STEPS: usize = 20;
        let start = Start::new(moments)?;
        let target = SVector::<f64, 6>::from(moments.mean());
        let tolerances = (1e-9 * target.amax(), 1e-9 * moments.covariance().amax());
        let none = LogCholeskyGaussianError::NoMatch;
        let (mut mean, mut covariance) = closed::matched(moments).ok_or(none)?;
        for _ in 0..STEPS {
            let symmetric = (covariance + covariance.transpose()) * 0.5;
            let law = Self::new(mean.into(), symmetric).map_err(|_| none)?;
            let found = law.entry_moments();
            let gap = target - SVector::<f64, 6>::from(found.mean());
            let gaps = moments.covariance() - found.covariance();
            if gap.amax() <= tolerances.0 && gaps.amax() <= tolerances.1 {
                return Ok(law);
            }
            mean += start.inverse * gap;
            covariance += start.inverse * gaps * start.inverse.transpose();
        }
        Err(none)
    }

    /// Means of d₁, d₂, d₃, s₁₂, s₂₃, s₁₃.
    #[must_use]
    pub fn mean(&self) -> [f64; 6] {
        self.mean.into()
    }

    /// Their covariance.
    #[must_use]
    pub fn covariance(&self) -> &SMatrix<f64, 6, 6> {
        self.covariance.matrix()
    }

    /// The logarithm of the density of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m²: that of the coordinates over the
    /// determinant 16 e^{2d₁ + 3d₂ + 4d₃} of the derivative of the entries by them. −∞ for a rod, a plate, a point and a
    /// matrix that no body has. None where the covariance is singular.
    #[must_use]
    pub fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        const LN_16: f64 = 4.0 * std::f64::consts::LN_2;
        let x = Inertia::try_from(*inertia).ok().and_then(|body| coordinates(&body).ok());
        let Some(x) = x else {
            return self.covariance.ln_density(&SVector::zeros()).map(|_| f64::NEG_INFINITY);
        };
        let ln_density = self.covariance.ln_density(&(SVector::from(x) - self.mean))?;
        Some(ln_density - LN_16 - 2.0 * x[0] - 3.0 * x[1] - 4.0 * x[2])
    }
}

/// Where the search for a law of given moments starts.
struct Start {
    mean: SVector<f64, 6>,
    covariance: SMatrix<f64, 6, 6>,
    /// The derivative of the coordinates by the entries of I.
    inverse: SMatrix<f64, 6, 6>,
}

impl Start {
    fn new(moments: &EntryMoments) -> Result<Self, LogCholeskyGaussianError> {
        let none = LogCholeskyGaussianError::NoMatch;
        let [i11, i22, i33, i12, i13, i23] = moments.mean();
        let body =
            InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23]).map_err(|_| none)?;
        let mean = coordinates(&Inertia::try_from(body).map_err(|_| none)?)?;
        let [d1, d2, d3, s12, s23, s13] = mean;
        let [v1, v2, v3] = [d1, d2, d3].map(libm::exp);
        // Rows Σ₁₁, Σ₂₂, Σ₃₃, Σ₁₂, Σ₁₃, Σ₂₃; columns d₁, d₂, d₃, s₁₂, s₂₃, s₁₃.
        #[rustfmt::skip]
        let derivative = SMatrix::<f64, 6, 6>::from_row_slice(&[
            2.0 * v1 * v1, 0.0, 0.0, 2.0 * s12, 0.0, 2.0 * s13,
            0.0, 2.0 * v2 * v2, 0.0, 0.0, 2.0 * s23, 0.0,
            0.0, 0.0, 2.0 * v3 * v3, 0.0, 0.0, 0.0,
            0.0, s12 * v2, 0.0, v2, s13, s23,
            0.0, 0.0, s13 * v3, 0.0, 0.0, v3,
            0.0, 0.0, s23 * v3, 0.0, v3, 0.0,
        ]);
        let inverse = (inertia_map() * derivative).try_inverse().ok_or(none)?;
        let covariance = inverse * moments.covariance() * inverse.transpose();
        let covariance = (covariance + covariance.transpose()) * 0.5;
        Ok(Self { mean: mean.into(), covariance, inverse })
    }
}

/// d₁, d₂, d₃, s₁₂, s₂₃, s₁₃ of a body.
fn coordinates(body: &Inertia) -> Result<[f64; 6], LogCholeskyError> {
    // Of one kilogram at the origin, α and t are zero and lengths are in √kg·m.
    let unit = MassProperties::new(1.0, nalgebra::Vector3::zeros(), *body)?;
    let [_, d1, d2, d3, s12, s23, s13, ..] = LogCholesky::of(&unit)?.values();
    Ok([d1, d2, d3, s12, s23, s13])
}

/// Mean and covariance of the entries of I, of coordinates with these.
fn moments_of(mean: &SVector<f64, 6>, covariance: &SMatrix<f64, 6, 6>) -> EntryMoments {
    let (mean, covariance) = moments(&log_cholesky_entries::<6>(None, 0), mean, covariance);
    EntryMoments::unchecked((inertia_map() * mean).into(), inertia_covariance(&covariance))
}

impl KnownMoments for LogCholeskyGaussian {
    fn entry_moments(&self) -> EntryMoments {
        moments_of(&self.mean, self.covariance.matrix())
    }
}

impl Distribution<Inertia> for LogCholeskyGaussian {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Inertia {
        loop {
            let x = self.mean + self.covariance.sample(rng);
            let [v1, v2, v3] = [x[0], x[1], x[2]].map(libm::exp);
            let v = Matrix3::new(v1, x[3], x[5], 0.0, v2, x[4], 0.0, 0.0, v3);
            // Never refused within 40 deviations.
            if let Some(body) = body(&v) {
                return body;
            }
        }
    }
}

inertia_law!(LogCholeskyGaussian, draws Inertia);

impl NamedModel for LogCholeskyGaussian {
    const NAME: &'static str = "log-cholesky";
    const DESCRIPTION: &'static str = "Gaussian log-Cholesky coordinates of the second moments";
    const IS_REALIZABLE: bool = true;
    const NEEDS: &'static [&'static str] = &["log_cholesky_covariance"];

    fn about(nominal: &Inertia, given: &ModelParameters) -> Result<Self, ModelParameterError> {
        const KEY: &str = "log_cholesky_covariance";
        let rows = given.log_cholesky_covariance.ok_or(ModelParameterError::missing(KEY))?;
        Self::about(nominal, of_rows(rows)).map_err(|e| ModelParameterError::new(KEY, &e))
    }

    fn matched(
        mean: InertiaMatrix,
        moments: &EntryMoments,
    ) -> Result<(Self, &'static str), NoMatch> {
        if let Ok(law) = Self::matched(moments) {
            return Ok((law, "mean and covariance of the six entries"));
        }
        Inertia::try_from(mean)?;
        let law = Self::linearised(moments)?;
        Ok((law, "mean and covariance of the six entries, to first order"))
    }
}

crate::written!(
    LogCholeskyGaussian,
    |law| {
        log_cholesky_mean: [f64; 6] = law.mean.into(),
        log_cholesky_covariance: [[f64; 6]; 6] = law.covariance.rows(),
    },
    LogCholeskyGaussian::new(log_cholesky_mean, of_rows(log_cholesky_covariance))?
);

#[cfg(test)]
mod tests;
