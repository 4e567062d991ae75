//! Six independent Gaussian entries.

use gyradius_inertia::{InertiaMatrix, MAX_ENTRY};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

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
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Parameters", into = "Parameters")
)]
pub struct EntrywiseGaussian {
    mean: [f64; 6],
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

    /// Means of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃, kg·m².
    #[must_use]
    pub fn mean(&self) -> [f64; 6] {
        self.mean
    }

    /// Deviations of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃, kg·m².
    #[must_use]
    pub fn deviations(&self) -> [f64; 6] {
        self.deviations
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

/// The serialized form.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Parameters {
    mean_kg_m2: [f64; 6],
    deviation_kg_m2: [f64; 6],
}

#[cfg(feature = "serde")]
impl TryFrom<Parameters> for EntrywiseGaussian {
    type Error = Box<dyn std::error::Error>;

    fn try_from(p: Parameters) -> Result<Self, Self::Error> {
        let [i11, i22, i33, i12, i13, i23] = p.mean_kg_m2;
        let mean = InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23])?;
        Ok(Self::new(mean, p.deviation_kg_m2)?)
    }
}

#[cfg(feature = "serde")]
impl From<EntrywiseGaussian> for Parameters {
    fn from(law: EntrywiseGaussian) -> Self {
        Self { mean_kg_m2: law.mean, deviation_kg_m2: law.deviations }
    }
}

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

    #[cfg(feature = "serde")]
    #[test]
    fn serde_goes_through_the_constructor() {
        let law = EntrywiseGaussian::new(mean(), [0.5; 6]).unwrap();
        let json = serde_json::to_string(&law).unwrap();
        assert_eq!(serde_json::from_str::<EntrywiseGaussian>(&json).unwrap(), law);
        let bad = json.replacen("0.5,0.5", "-0.5,0.5", 1);
        assert_ne!(bad, json);
        assert!(serde_json::from_str::<EntrywiseGaussian>(&bad).is_err());
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
