//! Jointly Gaussian roots of the second mass moments.

use gyradius_inertia::RootSecondMoments;
use nalgebra::{Matrix3, Vector3};
use rand::Rng;
use rand_distr::Distribution;

use super::{FAR, MAX_ROOT, ln_of_squares};
use crate::ln_sum::ln_sum;
use crate::semidefinite::{Covariance, CovarianceError};
use crate::{RootMoments, SecondMomentStatistics};

/// Why a mean and a covariance are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CorrelatedRootsError {
    /// The matrix is no covariance.
    #[error(transparent)]
    Covariance(#[from] CovarianceError),
    /// Roots could come out so large that their fourth powers overflow.
    #[error("k_{axis} of mean {mean:e} √kg·m: no root may come out beyond {MAX_ROOT:e} √kg·m")]
    Mean {
        /// Axis, from 1.
        axis: usize,
        /// The mean, √kg·m.
        mean: f64,
    },
}

/// Jointly Gaussian roots k_k = √K_k of the second mass moments.
///
/// # Definition
/// k ~ N(k̄, C), C positive semidefinite; K_k = k_k². E K_i = k̄_i² + C_ii and
/// Cov(K_i, K_j) = 4 k̄_i k̄_j C_ij + 2 C_ij². With a diagonal C it is
/// [`ScalarRoots::normal`](crate::ScalarRoots::normal), but for the bits.
///
/// A common cause moves all three: propellant, say, or the density of a casting.
///
/// ```
/// use gyradius_dispersion::{CorrelatedRoots, RootMoments};
/// use gyradius_inertia::RootSecondMoments;
/// use nalgebra::{Matrix3, Vector3};
///
/// // All three roots known up to one common factor of 1 ± 2 %.
/// let mean = RootSecondMoments::new([10.0, 20.0, 30.0])?;
/// let spread = 0.02 * Vector3::from(mean.values());
/// let law = CorrelatedRoots::new(mean, spread * spread.transpose())?;
/// let k = law.second_moment_statistics();
/// assert!((k.covariance()[(0, 1)] / (k.variances()[0] * k.variances()[1]).sqrt() - 1.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
pub struct CorrelatedRoots {
    /// k̄, √kg·m.
    #[getset(get_copy = "pub")]
    mean: RootSecondMoments,
    covariance: Covariance<3>,
}

impl CorrelatedRoots {
    /// Mean roots k̄ in √kg·m and their covariance in kg·m², which may be singular.
    ///
    /// # Errors
    /// The covariance is not finite, symmetric and positive semidefinite, or roots could come out
    /// beyond 1e75 √kg·m.
    pub fn new(
        mean: RootSecondMoments,
        covariance: Matrix3<f64>,
    ) -> Result<Self, CorrelatedRootsError> {
        let covariance = Covariance::new(covariance, MAX_ROOT * MAX_ROOT)?;
        for (i, mean) in mean.values().into_iter().enumerate() {
            if !(mean.abs() + FAR * covariance.matrix()[(i, i)].sqrt() <= MAX_ROOT) {
                return Err(CorrelatedRootsError::Mean { axis: i + 1, mean });
            }
        }
        Ok(Self { mean, covariance })
    }

    /// Covariance of the roots, kg·m².
    #[must_use]
    pub fn covariance(&self) -> &Matrix3<f64> {
        self.covariance.matrix()
    }
}

impl RootMoments for CorrelatedRoots {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        SecondMomentStatistics::of_gaussian_roots(self.mean, self.covariance.matrix())
    }

    /// None where the covariance is singular. Else the sum over roots of eight choices of their signs.
    fn ln_density_of_squares(&self, second_moments: [f64; 3]) -> Option<f64> {
        let roots = second_moments.map(f64::sqrt);
        let mean = self.mean.values();
        let mut terms = [f64::NEG_INFINITY; 8];
        for (signs, term) in terms.iter_mut().enumerate() {
            let gap = Vector3::from_fn(|i, _| {
                if signs >> i & 1 == 0 { roots[i] - mean[i] } else { -roots[i] - mean[i] }
            });
            *term = self.covariance.ln_density(&gap)?;
        }
        let sum = ln_sum(&terms);
        Some(if sum == f64::NEG_INFINITY { sum } else { sum + ln_of_squares(roots) })
    }
}

impl Distribution<RootSecondMoments> for CorrelatedRoots {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> RootSecondMoments {
        let mean = Vector3::from(self.mean.values());
        loop {
            // Never refused within 40 deviations.
            if let Ok(roots) = RootSecondMoments::new((mean + self.covariance.sample(rng)).into()) {
                return roots;
            }
        }
    }
}

crate::written!(
    CorrelatedRoots,
    |law| {
        mean_sqrt_kg_m: RootSecondMoments = law.mean,
        covariance_kg_m2: [[f64; 3]; 3] = law.covariance.rows(),
    },
    CorrelatedRoots::new(mean_sqrt_kg_m, crate::semidefinite::of_rows(covariance_kg_m2))?
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::root_moments::tests::check_moments;

    fn law(covariance: Matrix3<f64>) -> Result<CorrelatedRoots, CorrelatedRootsError> {
        CorrelatedRoots::new(RootSecondMoments::new([3.0, -1.0, 0.0]).unwrap(), covariance)
    }

    #[test]
    fn squares_have_their_moments() {
        let full = Matrix3::new(0.4, 0.3, -0.1, 0.3, 2.0, 0.5, -0.1, 0.5, 1.0);
        check_moments(&law(full).unwrap(), 15);
        let spread = Vector3::new(0.5, 1.0, -0.7);
        check_moments(&law(spread * spread.transpose()).unwrap(), 16);
    }

    #[test]
    fn bad_parameters_are_named() {
        let error = law(Matrix3::from_diagonal_element(-1.0)).unwrap_err();
        assert!(error.to_string().contains("(1, 1)"), "{error}");
        let error = law(Matrix3::from_diagonal_element(1e148)).unwrap_err();
        assert!(law(Matrix3::from_diagonal_element(1e146)).is_ok(), "{error}");
        let error = law(Matrix3::from_diagonal_element(9e149)).unwrap_err();
        assert!(error.to_string().contains("k_1"), "{error}");
    }
}
