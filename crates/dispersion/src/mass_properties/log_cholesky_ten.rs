//! A Gaussian in the ten log-Cholesky coordinates: a rival of the joint law.

use gyradius_inertia::{LogCholesky, LogCholeskyError, MassProperties};
use nalgebra::{SMatrix, SVector};
use rand::Rng;
use rand_distr::Distribution;
use std::f64::consts::LN_2;

use super::model::draws_bodies;
use super::{MassPropertiesModel, TenMoments};
use crate::entry_moments::ENTRIES;
use crate::gaussian_monomials::{GaussianMonomial, log_cholesky_entries, moments};
use crate::second_moment_matrix::inertia_map;
use crate::semidefinite::{Covariance, CovarianceError};

/// Draws farther out than this many deviations have probability 1e-349.
const FAR: f64 = 40.0;
/// Places of coordinates.
const ALPHA: usize = 0;
const CENTRE: usize = 7;
/// What exponents and lengths of draws may come to.
const MAX_EXPONENT: f64 = 100.0;
const MAX_COORDINATE: f64 = 1e40;

/// A Gaussian in the ten coordinates of Rucker & Wensing (2022, doi:10.1109/LRA.2022.3144517): α = ½ ln m, the factor V of
/// Σ_c/m = V Vᵀ with exp(d) on its diagonal and s above, and the mass centre.
///
/// # Realizability
/// By construction: m > 0 and V Vᵀ is positive definite.
///
/// # Limits
/// Not invariant under rotation; the mean of the coordinates is not the mean body; rods, plates and points lie at
/// infinity.
///
/// ```
/// use gyradius_dispersion::{LogCholeskyTen, MassPropertiesModel};
/// use gyradius_inertia::Shape;
/// use nalgebra::SMatrix;
///
/// let body = Shape::solid_box([1.0, 2.0, 3.0])?.of_mass(5.0)?;
/// let law = LogCholeskyTen::about(&body, SMatrix::identity() * 0.01)?;
/// assert!(law.ln_density(&body).is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LogCholeskyTen {
    mean: SVector<f64, 10>,
    covariance: Covariance<10>,
}

impl LogCholeskyTen {
    /// Mean and covariance of α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃ as of [`LogCholesky`]: s and t in m.
    ///
    /// # Errors
    /// The covariance is not finite, symmetric and positive semidefinite, or draws could leave the range of floats.
    pub fn new(
        mean: LogCholesky,
        covariance: SMatrix<f64, 10, 10>,
    ) -> Result<Self, LogCholeskyTenError> {
        let covariance = Covariance::new(covariance, MAX_COORDINATE * MAX_COORDINATE)?;
        let mean = SVector::from(mean.values());
        for i in 0..10 {
            let deviation = covariance.matrix()[(i, i)].sqrt();
            let most = if i < 4 { MAX_EXPONENT } else { MAX_COORDINATE };
            if !(mean[i].abs() + FAR * deviation <= most) {
                let (coordinate, mean) = (i + 1, mean[i]);
                return Err(LogCholeskyTenError::Coordinate { coordinate, mean, deviation, most });
            }
        }
        Ok(Self { mean, covariance })
    }

    /// About the coordinates of a body, which are then the medians of those of the draws.
    ///
    /// # Errors
    /// The body is a rod, a plate or a point, or as [`new`](Self::new).
    pub fn about(
        body: &MassProperties,
        covariance: SMatrix<f64, 10, 10>,
    ) -> Result<Self, LogCholeskyTenError> {
        Self::new(LogCholesky::of(body)?, covariance)
    }

    /// The mean of the coordinates.
    #[must_use]
    pub fn mean(&self) -> [f64; 10] {
        self.mean.into()
    }

    /// Their covariance.
    #[must_use]
    pub fn covariance(&self) -> &SMatrix<f64, 10, 10> {
        self.covariance.matrix()
    }

    /// The logarithm of the density with respect to dm d³c dI₁₁ dI₂₂ dI₃₃ dI₁₂ dI₁₃ dI₂₃. None where the covariance is
    /// singular.
    ///
    /// With V and its diagonal v = exp(d): dm = 2m dα; Σ_c/m moves by 8 v₁² v₂³ v₃⁴ per unit of d and s; Σ_c by m⁶ of
    /// that, and I by twice.
    #[must_use]
    pub fn ln_density(&self, body: &MassProperties) -> Option<f64> {
        let own = self.covariance.ln_density(&SVector::zeros())?;
        let Ok(coordinates) = LogCholesky::of(body) else { return Some(f64::NEG_INFINITY) };
        let x = SVector::from(coordinates.values());
        let [alpha, d1, d2, d3] = [x[0], x[1], x[2], x[3]];
        // ln of 2m · m⁶ · 8 v₁² v₂³ v₃⁴ · 2, m = exp(2α).
        let jacobian = 5.0 * LN_2 + 14.0 * alpha + 2.0 * d1 + 3.0 * d2 + 4.0 * d3;
        let density = self.covariance.ln_density(&(x - self.mean)).unwrap_or(own);
        Some(density - jacobian)
    }
}

crate::written!(
    LogCholeskyTen,
    |law| {
        mean: [f64; 10] = law.mean.into(),
        covariance: [[f64; 10]; 10] = law.covariance.rows(),
    },
    LogCholeskyTen::new(LogCholesky::new(mean)?, crate::semidefinite::of_rows(covariance))?
);

impl Distribution<MassProperties> for LogCholeskyTen {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> MassProperties {
        loop {
            let coordinates = self.mean + self.covariance.sample(rng);
            // Never refused within forty deviations.
            if let Ok(coordinates) = LogCholesky::new(coordinates.into())
                && let Ok(body) = coordinates.mass_properties()
            {
                return body;
            }
        }
    }
}

impl MassPropertiesModel for LogCholeskyTen {
    draws_bodies!("log-cholesky-ten");

    fn ln_density(&self, body: &MassProperties) -> Option<f64> {
        self.ln_density(body)
    }

    /// In closed form: the ten are sums of products of exponentials and coordinates.
    fn moments(&self) -> Option<TenMoments> {
        let centre = |i: usize| vec![GaussianMonomial::new(&[], &[CENTRE + i])];
        let own = log_cholesky_entries::<10>(Some(ALPHA), ALPHA + 1);
        Some(self.moments_of([centre(0), centre(1), centre(2)], own))
    }

    /// In closed form, too: m c and Σ + m c cᵀ are such sums.
    fn linear_moments(&self) -> Option<TenMoments> {
        let of = |centre: &[usize]| GaussianMonomial::new(&[(ALPHA, 2.0)], centre);
        let first = |i: usize| vec![of(&[CENTRE + i])];
        let mut second = log_cholesky_entries::<10>(Some(ALPHA), ALPHA + 1);
        for (entry, (i, j)) in second.iter_mut().zip(ENTRIES) {
            entry.push(of(&[CENTRE + i, CENTRE + j]));
        }
        Some(self.moments_of([first(0), first(1), first(2)], second))
    }
}

impl LogCholeskyTen {
    /// Mean and covariance of the mass, of three sums, and of the inertia of these six second moments.
    fn moments_of(
        &self,
        [x, y, z]: [Vec<GaussianMonomial<10>>; 3],
        [s11, s22, s33, s12, s13, s23]: [Vec<GaussianMonomial<10>>; 6],
    ) -> TenMoments {
        let mass = vec![GaussianMonomial::new(&[(ALPHA, 2.0)], &[])];
        let parts = [mass, x, y, z, s11, s22, s33, s12, s13, s23];
        let (mean, covariance) = moments(&parts, &self.mean, self.covariance.matrix());
        // From Σ to I.
        let mut map = SMatrix::<f64, 10, 10>::identity();
        map.fixed_view_mut::<6, 6>(4, 4).copy_from(&inertia_map());
        let covariance = map * covariance * map.transpose();
        TenMoments::unchecked(map * mean, (covariance + covariance.transpose()) * 0.5)
    }
}

/// Why coordinates and a covariance are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LogCholeskyTenError {
    /// The matrix is no covariance.
    #[error(transparent)]
    Covariance(#[from] CovarianceError),
    /// The mean body has no coordinates.
    #[error(transparent)]
    Mean(#[from] LogCholeskyError),
    /// Draws would leave the range.
    #[error(
        "coordinate {coordinate} of mean {mean:?} and deviation {deviation:?}: within forty deviations it must be at most \
         {most:e} in magnitude"
    )]
    Coordinate {
        /// Which, from 1.
        coordinate: usize,
        /// Its mean.
        mean: f64,
        /// Its deviation.
        deviation: f64,
        /// What is allowed.
        most: f64,
    },
}
