//! Mean and covariance of second mass moments, and of the laws of roots that have them.

use gyradius_inertia::RootSecondMoments;
use nalgebra::Matrix3;

use crate::density_of_entries::in_orders;
use crate::semidefinite::{Covariance, CovarianceError};

/// Largest covariance of second moments, so that sums of them do not overflow.
const MAX: f64 = 1e304;

/// Why numbers are not the mean and covariance of second mass moments.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SecondMomentStatisticsError {
    /// A mean is negative, NaN or too large.
    #[error("mean of K_{axis} = {value:?} kg·m²: it must lie in [0, 1e152]")]
    Mean {
        /// Axis, from 1.
        axis: usize,
        /// The mean, kg·m².
        value: f64,
    },
    /// The covariance is none.
    #[error(transparent)]
    Covariance(#[from] CovarianceError),
}

/// Mean and covariance of random second mass moments K₁, K₂, K₃ (Peck 2003, Eq. 9), and of the
/// principal moments of inertia that are sums of two of them.
///
/// All that the mean and covariance of the entries of an inertia matrix depend on, as far as the law
/// of the roots goes: see [`EntryMoments`](crate::EntryMoments).
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
pub struct SecondMomentStatistics {
    /// E K₁, E K₂, E K₃, kg·m².
    #[getset(get_copy = "pub")]
    mean: [f64; 3],
    /// Cov K, (kg·m²)².
    #[getset(get = "pub")]
    covariance: Matrix3<f64>,
}

impl SecondMomentStatistics {
    /// Means in kg·m² and covariance in (kg·m²)².
    ///
    /// # Errors
    /// A mean is negative or above 1e152, or the covariance is not finite, symmetric and positive
    /// semidefinite.
    pub fn new(
        mean: [f64; 3],
        covariance: Matrix3<f64>,
    ) -> Result<Self, SecondMomentStatisticsError> {
        if let Some(i) = mean.iter().position(|k| !(0.0..=1e152).contains(k)) {
            return Err(SecondMomentStatisticsError::Mean { axis: i + 1, value: mean[i] });
        }
        let covariance = *Covariance::new(covariance, MAX)?.matrix();
        Ok(Self { mean, covariance })
    }

    /// Of independent second moments, from laws that keep their parameters in range.
    pub(crate) fn independent(mean: [f64; 3], variances: [f64; 3]) -> Self {
        Self { mean, covariance: Matrix3::from_diagonal(&variances.into()) }
    }

    /// Of second moments that covary, likewise.
    pub(crate) fn joint(mean: [f64; 3], covariance: Matrix3<f64>) -> Self {
        Self { mean, covariance }
    }

    /// Of the squares of jointly Gaussian roots with the mean k̄, √kg·m, and the covariance c, kg·m²:
    /// E K_i = k̄_i² + c_ii and Cov(K_i, K_j) = 4 k̄_i k̄_j c_ij + 2 c_ij². That c is a covariance is not
    /// checked, for searches that try many: [`CorrelatedRoots`](crate::CorrelatedRoots) checks it.
    #[must_use]
    pub fn of_gaussian_roots(mean: RootSecondMoments, covariance: &Matrix3<f64>) -> Self {
        let (k, c) = (mean.values(), covariance);
        Self::joint(
            std::array::from_fn(|i| k[i] * k[i] + c[(i, i)]),
            c.map_with_location(|i, j, c| 2.0 * c * (2.0 * k[i] * k[j] + c)),
        )
    }

    /// Var K₁, Var K₂, Var K₃, (kg·m²)².
    #[must_use]
    pub fn variances(&self) -> [f64; 3] {
        self.covariance.diagonal().into()
    }

    /// Means of the principal moments I₁ = K₂ + K₃, I₂ = K₁ + K₃, I₃ = K₁ + K₂ (Eq. 7), kg·m².
    #[must_use]
    pub fn principal_mean(&self) -> [f64; 3] {
        let [k1, k2, k3] = self.mean;
        [k2 + k3, k1 + k3, k1 + k2]
    }

    /// Covariance of the principal moments, (kg·m²)².
    #[must_use]
    pub fn principal_covariance(&self) -> Matrix3<f64> {
        let sum = Matrix3::new(0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0);
        sum * self.covariance * sum
    }
}

crate::written!(
    SecondMomentStatistics,
    |k| { mean: [f64; 3] = k.mean, covariance: Matrix3<f64> = k.covariance, },
    {
        SecondMomentStatistics::new(mean, Matrix3::zeros())?;
        SecondMomentStatistics { mean, covariance: crate::semidefinite::computed(covariance)? }
    }
);

/// A law of the roots k of which the mean and covariance of K = k² are known, and where it has one, the density of K.
///
/// Implemented by every law of roots here but [`IndependentRoots`](crate::IndependentRoots) of laws
/// that this crate knows nothing of: [`WithMoments`] attaches what is known to any law.
pub trait RootMoments {
    /// Mean and covariance of K.
    fn second_moment_statistics(&self) -> SecondMomentStatistics;

    /// The logarithm of the density of K₁, K₂, K₃ in kg·m², roots of either sign folded together; −∞ outside of the
    /// support. None where the law has no density, or none that is known: that is so unless a law says otherwise.
    fn ln_density_of_squares(&self, second_moments: [f64; 3]) -> Option<f64> {
        let _ = second_moments;
        None
    }

    /// The same of the second moments in each of the orders of
    /// [`PrincipalAxes::ORDERS`](gyradius_inertia::PrincipalAxes::ORDERS), which the density of the entries of an
    /// inertia needs together.
    fn ln_densities_in_orders(&self, second_moments: [f64; 3]) -> Option<[f64; 6]> {
        let mut known = true;
        let found = in_orders(second_moments, |k| {
            let density = self.ln_density_of_squares(k);
            known &= density.is_some();
            density.unwrap_or(f64::NEG_INFINITY)
        });
        known.then_some(found)
    }
}

impl<T: RootMoments + ?Sized> RootMoments for &T {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        (**self).second_moment_statistics()
    }

    fn ln_density_of_squares(&self, second_moments: [f64; 3]) -> Option<f64> {
        (**self).ln_density_of_squares(second_moments)
    }

    fn ln_densities_in_orders(&self, second_moments: [f64; 3]) -> Option<[f64; 6]> {
        (**self).ln_densities_in_orders(second_moments)
    }
}

/// Any law with the mean and covariance of K that its user knows.
///
/// ```
/// use gyradius_dispersion::{
///     EntryMoments, IndependentRoots, PrincipalDispersion, SecondMomentStatistics, WithMoments,
/// };
/// use gyradius_attitude::UniformAttitude;
/// use nalgebra::Matrix3;
/// use rand_distr::Exp;
///
/// // Exponential roots of rate 1: E k² = 2, E k⁴ = 24.
/// let roots = IndependentRoots::new([Exp::new(1.0)?; 3])?;
/// let statistics = SecondMomentStatistics::new([2.0; 3], Matrix3::identity() * 20.0)?;
/// let law = PrincipalDispersion::new(WithMoments::new(roots, statistics), UniformAttitude);
/// assert_eq!(EntryMoments::of(&law).mean()[0], 4.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::Getters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WithMoments<L> {
    /// The law.
    #[getset(get = "pub")]
    law: L,
    statistics: SecondMomentStatistics,
}

impl<L> WithMoments<L> {
    /// A law and the mean and covariance of the squares of what it draws. They are not checked
    /// against each other.
    pub fn new(law: L, statistics: SecondMomentStatistics) -> Self {
        Self { law, statistics }
    }
}

impl<L> RootMoments for WithMoments<L> {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        self.statistics
    }
}

impl<T, L: rand_distr::Distribution<T>> rand_distr::Distribution<T> for WithMoments<L> {
    #[inline]
    fn sample<R: rand::Rng + ?Sized>(&self, rng: &mut R) -> T {
        self.law.sample(rng)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use gyradius_inertia::RootSecondMoments;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    /// Mean and covariance of K and of the principal moments against draws, to |z| < 4.
    pub(crate) fn check_moments<L>(law: &L, seed: u64)
    where
        L: RootMoments + Distribution<RootSecondMoments>,
    {
        const N: usize = 200_000;
        let n = N as f64;
        let statistics = law.second_moment_statistics();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let draws: Vec<[f64; 3]> =
            (0..N).map(|_| law.sample(&mut rng).squared().values()).collect();
        let principal: Vec<[f64; 3]> =
            draws.iter().map(|[a, b, c]| [b + c, a + c, a + b]).collect();
        let of_k = (&draws, statistics.mean(), *statistics.covariance());
        let of_i = (&principal, statistics.principal_mean(), statistics.principal_covariance());
        for (what, (draws, mean, covariance)) in [("K", of_k), ("I", of_i)] {
            for i in 0..3 {
                let sample = draws.iter().map(|k| k[i]).sum::<f64>() / n;
                let error = (covariance[(i, i)] / n).sqrt();
                let z = (sample - mean[i]) / error;
                let rounding = 1e-12 * mean[i];
                assert!(
                    z.abs() < 4.0 || (sample - mean[i]).abs() <= rounding,
                    "{what}_{i}: z = {z}"
                );
                for j in 0..=i {
                    let product = |k: &[f64; 3]| (k[i] - mean[i]) * (k[j] - mean[j]);
                    let average = draws.iter().map(product).sum::<f64>() / n;
                    let spread =
                        draws.iter().map(|k| (product(k) - average).powi(2)).sum::<f64>() / n;
                    let gap = average - covariance[(i, j)];
                    let z = gap / (spread / n).sqrt();
                    let rounding = 1e-24 * mean[i] * mean[j];
                    assert!(z.abs() < 4.0 || gap.abs() <= rounding, "Cov {what}_{i}{j}: z = {z}");
                }
            }
        }
    }

    #[test]
    fn bad_statistics_are_named() {
        let error = SecondMomentStatistics::new([1.0, -1.0, 0.0], Matrix3::zeros()).unwrap_err();
        assert!(error.to_string().contains("K_2"), "{error}");
        let error = SecondMomentStatistics::new([1.0; 3], -Matrix3::identity()).unwrap_err();
        assert!(error.to_string().contains("(1, 1)"), "{error}");
    }

    #[test]
    fn principal_moments_are_sums_of_two() {
        let law = SecondMomentStatistics::independent([1.0, 2.0, 4.0], [1.0, 10.0, 100.0]);
        assert_eq!(law.principal_mean(), [6.0, 5.0, 3.0]);
        let covariance = law.principal_covariance();
        assert_eq!(covariance.diagonal().as_slice(), [110.0, 101.0, 11.0]);
        assert_eq!(
            [covariance[(0, 1)], covariance[(0, 2)], covariance[(1, 2)]],
            [100.0, 10.0, 1.0]
        );
    }
}
