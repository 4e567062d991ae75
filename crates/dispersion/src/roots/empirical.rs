//! Roots of the second mass moments as they were observed.

use gyradius_inertia::RootSecondMoments;
use nalgebra::{Matrix3, Vector3};
use rand::{Rng, RngExt};
use rand_distr::Distribution;
use std::sync::Arc;

use super::MAX_ROOT;
use crate::{RootMoments, SecondMomentStatistics};

/// Why samples are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EmpiricalRootsError {
    /// There are none.
    #[error("no samples: there must be at least one")]
    Empty,
    /// A root is NaN or too large.
    #[error("sample {row}, k_{axis} = {value:?} √kg·m: it must lie within ±{MAX_ROOT:e}")]
    Root {
        /// Sample, from 1.
        row: usize,
        /// Axis, from 1.
        axis: usize,
        /// The root, √kg·m.
        value: f64,
    },
}

/// Roots k = (√K₁, √K₂, √K₃) as they were observed, all equally likely.
///
/// # Definition
/// The empirical law: one of n triples, each with probability 1/n. Triples stay together, so that
/// whatever correlation they have is kept. Means and covariances of K are those of the n squares
/// (divided by n, not n − 1).
///
/// # Limits
/// Nothing is drawn that was not observed: no tails, no value in between. Copies share the samples.
#[derive(Clone, Debug, PartialEq)]
pub struct EmpiricalRoots {
    samples: Arc<[RootSecondMoments]>,
}

impl EmpiricalRoots {
    /// From observed triples, √kg·m.
    ///
    /// # Errors
    /// There are none, or a root is NaN or beyond 1e75 √kg·m.
    pub fn new(samples: &[RootSecondMoments]) -> Result<Self, EmpiricalRootsError> {
        let samples: Vec<[f64; 3]> = samples.iter().map(RootSecondMoments::values).collect();
        Self::from_values(&samples)
    }

    /// From observed triples as plain numbers, √kg·m.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_values(samples: &[[f64; 3]]) -> Result<Self, EmpiricalRootsError> {
        if samples.is_empty() {
            return Err(EmpiricalRootsError::Empty);
        }
        let checked = |(row, k): (usize, &[f64; 3])| {
            let refused =
                |i: usize| EmpiricalRootsError::Root { row: row + 1, axis: i + 1, value: k[i] };
            match k.iter().position(|k| !(k.abs() <= MAX_ROOT)) {
                Some(i) => Err(refused(i)),
                None => RootSecondMoments::new(*k).map_err(|_| refused(0)),
            }
        };
        let samples = samples.iter().enumerate().map(checked).collect::<Result<Arc<[_]>, _>>()?;
        Ok(Self { samples })
    }

    /// The samples.
    #[must_use]
    pub fn samples(&self) -> &[RootSecondMoments] {
        &self.samples
    }
}

impl RootMoments for EmpiricalRoots {
    fn second_moment_statistics(&self) -> SecondMomentStatistics {
        let n = self.samples.len() as f64;
        let squares = || self.samples.iter().map(|k| Vector3::from(k.squared().values()));
        let mean = squares().fold(Vector3::zeros(), |sum, k| sum + k / n);
        let covariance = squares().fold(Matrix3::zeros(), |sum: Matrix3<f64>, k| {
            let gap = k - mean;
            sum + gap * gap.transpose() / n
        });
        SecondMomentStatistics::joint(mean.into(), covariance)
    }
}

impl Distribution<RootSecondMoments> for EmpiricalRoots {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> RootSecondMoments {
        self.samples[rng.random_range(0..self.samples.len())]
    }
}

crate::written!(
    EmpiricalRoots,
    |law| {
        samples_sqrt_kg_m: Vec<[f64; 3]> =
            law.samples.iter().map(RootSecondMoments::values).collect(),
    },
    EmpiricalRoots::from_values(&samples_sqrt_kg_m)?
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::root_moments::tests::check_moments;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    #[test]
    fn squares_have_their_moments() {
        let samples = [[1.0, 2.0, 3.0], [1.1, 2.5, 2.9], [-0.7, 2.2, 3.3], [1.0, 1.9, 3.1]];
        check_moments(&EmpiricalRoots::from_values(&samples).unwrap(), 41);
    }

    #[test]
    fn every_sample_is_equally_likely() {
        let samples: Vec<[f64; 3]> = (0..5).map(|i| [f64::from(i), 0.0, 1.0]).collect();
        let law = EmpiricalRoots::from_values(&samples).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(42);
        let mut counts = [0; 5];
        for _ in 0..50_000 {
            counts[law.sample(&mut rng).values()[0] as usize] += 1;
        }
        let chi_squared: f64 = counts.iter().map(|c| (f64::from(*c) - 1e4).powi(2) / 1e4).sum();
        // Four degrees of freedom: exceeded once in ten thousand.
        assert!(chi_squared < 23.5, "{counts:?}");
    }

    #[test]
    fn bad_samples_are_named() {
        assert_eq!(EmpiricalRoots::new(&[]), Err(EmpiricalRootsError::Empty));
        for bad in [f64::NAN, f64::INFINITY, -1e76] {
            let error = EmpiricalRoots::from_values(&[[1.0; 3], [1.0, 1.0, bad]]).unwrap_err();
            assert!(error.to_string().contains("sample 2, k_3"), "{error}");
        }
    }
}
