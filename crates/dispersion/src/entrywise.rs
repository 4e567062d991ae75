//! Six independent Gaussian entries.

use gyradius_inertia::{Inertia, InertiaMatrix, MAX_ENTRY};
use nalgebra::SMatrix;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use std::fmt::Display;

use crate::ln_sum::ln_product;
use crate::named_model::{NamedModel, NoMatch, inertia_law};
use crate::normal::LN_ROOT_TAU;
use crate::realizable_only::Conditionable;
use crate::{EntryMoments, KnownMoments, ModelParameterError, ModelParameters};

/// What files call the deviations.
const KEY: &str = "deviation_kg_m2";

/// Largest deviation, so that draws within forty of them stay in range.
const MAX_DEVIATION: f64 = MAX_ENTRY / 1e3;

/// Why deviations are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EntrywiseError {
    /// A deviation is negative, NaN or too large.
    #[error("deviation of {entry} = {value:?} kg·m²: it must lie in [0, {MAX_DEVIATION:.1e}]")]
    Deviation {
        /// Which entry: I11, I22, I33, I12, I13 or I23.
        entry: &'static str,
        /// The deviation, kg·m².
        value: f64,
    },
}

/// Six independent Gaussians, one for each entry of the inertia matrix: the common practice.
///
/// # Definition
/// I_ij ~ N(Ī_ij, σ_ij²), independent.
///
/// # Realizability
/// None: draws are whatever comes out, which is why they are [`InertiaMatrix`] and not
/// [`Inertia`](gyradius_inertia::Inertia). Ask [`InertiaMatrix::is_realizable`].
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[getset(get_copy = "pub")]
pub struct EntrywiseGaussian {
    /// Means of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃, kg·m².
    mean: [f64; 6],
    /// Deviations of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃, kg·m².
    deviations: [f64; 6],
}

impl EntrywiseGaussian {
    /// Mean matrix and the deviations of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m²; zero keeps an
    /// entry fixed.
    ///
    /// # Errors
    /// A deviation is negative or not finite, or draws could overflow.
    pub fn new(
        mean: impl Into<InertiaMatrix>,
        deviations: [f64; 6],
    ) -> Result<Self, EntrywiseError> {
        for (entry, value) in InertiaMatrix::ENTRY_NAMES.into_iter().zip(deviations) {
            if !(0.0..=MAX_DEVIATION).contains(&value) {
                return Err(EntrywiseError::Deviation { entry, value });
            }
        }
        Ok(Self { mean: mean.into().entries(), deviations })
    }

    /// The logarithm of the density of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m², of matrices that no body has too. None where
    /// a deviation is zero.
    #[must_use]
    pub fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        let (entries, mut square) = (inertia.entries(), 0.0);
        if self.deviations.contains(&0.0) {
            return None;
        }
        for ((entry, mean), deviation) in entries.iter().zip(self.mean).zip(self.deviations) {
            let z = (entry - mean) / deviation;
            square += z * z;
        }
        Some(-0.5 * square - 6.0 * LN_ROOT_TAU - ln_product(&self.deviations))
    }
}

impl Distribution<InertiaMatrix> for EntrywiseGaussian {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> InertiaMatrix {
        loop {
            let [i11, i22, i33, i12, i13, i23] = std::array::from_fn(|i| {
                let z: f64 = StandardNormal.sample(rng);
                self.mean[i] + self.deviations[i] * z
            });
            // Refused only where the mean lies at the edge of the floating-point range.
            if let Ok(matrix) = InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23]) {
                return matrix;
            }
        }
    }
}

impl KnownMoments for EntrywiseGaussian {
    fn entry_moments(&self) -> EntryMoments {
        let variances = self.deviations().map(|d| d * d);
        EntryMoments::unchecked(self.mean(), SMatrix::<f64, 6, 6>::from_diagonal(&variances.into()))
    }
}

inertia_law!(EntrywiseGaussian, draws InertiaMatrix);

impl NamedModel for EntrywiseGaussian {
    const NAME: &'static str = "entrywise";
    const DESCRIPTION: &'static str = "six independent Gaussian entries";
    const IS_REALIZABLE: bool = false;
    const NEEDS: &'static [&'static str] = &[KEY];

    fn about(nominal: &Inertia, given: &ModelParameters) -> Result<Self, ModelParameterError> {
        let rows = given.deviation_kg_m2.ok_or(ModelParameterError::missing(KEY))?;
        let refused = |problem: &dyn Display| ModelParameterError::new(KEY, problem);
        let deviations = symmetric(&rows).map_err(|e| refused(&e))?;
        Self::new(*nominal, deviations).map_err(|e| refused(&e))
    }

    fn matched(
        mean: InertiaMatrix,
        moments: &EntryMoments,
    ) -> Result<(Self, &'static str), NoMatch> {
        const WHAT: &str = "mean and deviations of the six entries, no correlation";
        Ok((Self::new(mean, moments.deviations())?, WHAT))
    }
}

impl Conditionable for EntrywiseGaussian {
    const CONDITIONED_NAME: &'static str = "realizable-entrywise";
    const CONDITIONED_DESCRIPTION: &'static str =
        "six independent Gaussian entries, impossible draws rejected";
    const BEFORE_REJECTION: &'static str =
        "mean and deviations of the six entries before rejection";
}

/// The six entries of a symmetric matrix of deviations.
fn symmetric(m: &[[f64; 3]; 3]) -> Result<[f64; 6], String> {
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let (upper, lower) = (m[i][j], m[j][i]);
        if upper != lower && !(upper.is_nan() && lower.is_nan()) {
            return Err(format!(
                "entries ({}, {}) = {upper:?} and ({}, {}) = {lower:?}: the matrix must be symmetric",
                i + 1,
                j + 1,
                j + 1,
                i + 1
            ));
        }
    }
    let entries = [m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]];
    match entries.iter().find(|d| !(**d >= 0.0 && d.is_finite())) {
        Some(bad) => Err(format!("{bad:?} kg·m²: deviations must be finite and not negative")),
        None => Ok(entries),
    }
}

crate::written!(
    EntrywiseGaussian,
    |law| {
        mean_kg_m2: [[f64; 3]; 3] = crate::entry_moments::rows(law.mean),
        deviation_kg_m2: [[f64; 3]; 3] = crate::entry_moments::rows(law.deviations),
    },
    EntrywiseGaussian::new(InertiaMatrix::try_from(mean_kg_m2)?, symmetric(&deviation_kg_m2)?)?
);

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    fn mean() -> InertiaMatrix {
        InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.2, 0.1, -0.5]).unwrap()
    }

    #[test]
    fn bad_deviations_are_named() {
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            let error = EntrywiseGaussian::new(mean(), [1.0, 1.0, 1.0, 1.0, bad, 1.0]).unwrap_err();
            assert!(error.to_string().contains("I13"), "{error}");
        }
    }

    #[test]
    fn entries_are_independent_gaussians() {
        const N: usize = 100_000;
        let law = EntrywiseGaussian::new(mean(), [0.5, 0.4, 0.3, 0.2, 0.1, 0.0]).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let draws: Vec<[f64; 6]> = (0..N).map(|_| law.sample(&mut rng).entries()).collect();
        let n = N as f64;
        let standard = |draw: &[f64; 6], i: usize| (draw[i] - law.mean[i]) / law.deviations[i];
        for i in 0..5 {
            for j in 0..=i {
                let product = draws.iter().map(|d| standard(d, i) * standard(d, j)).sum::<f64>();
                let (expected, spread) = if i == j { (1.0, 2.0_f64) } else { (0.0, 1.0) };
                let z = (product / n - expected) / (spread / n).sqrt();
                assert!(z.abs() < 4.0, "{i}{j}: {z}");
            }
        }
        assert!(draws.iter().all(|d| d[5] == -0.5));
    }

    #[test]
    fn wide_ones_leave_the_realizable_set() {
        let law = EntrywiseGaussian::new(mean(), [2.0; 6]).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let bad = (0..1000).filter(|_| !law.sample(&mut rng).is_realizable()).count();
        assert!(bad > 500, "{bad}");
    }
}
