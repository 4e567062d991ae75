//! Six jointly Gaussian entries.

use gyradius_inertia::{Inertia, InertiaMatrix};
use nalgebra::{SMatrix, SVector};
use rand::Rng;
use rand_distr::Distribution;

use crate::named_model::{NamedModel, NoMatch, inertia_law};
use crate::realizable_only::Conditionable;
use crate::semidefinite::{Covariance, CovarianceError, of_rows};
use crate::{EntryMoments, KnownMoments, ModelParameterError, ModelParameters};

/// What files call the covariance.
const KEY: &str = "covariance_kg2_m4";

/// Largest variance, so that draws within forty deviations stay in range.
const MAX_VARIANCE: f64 = 1e300;

/// Six jointly Gaussian entries of the inertia matrix: the covariance that a measurement or a
/// CAD sweep reports, taken at its word.
///
/// # Definition
/// (I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃) ~ N(Ī, C), C positive semidefinite. With a diagonal C it is
/// [`EntrywiseGaussian`](crate::EntrywiseGaussian), but for the bits.
///
/// # Realizability
/// None: the mean and the covariance may be those of real bodies, yet Gaussian tails know no
/// boundary. Draws are [`InertiaMatrix`]: ask [`InertiaMatrix::is_realizable`].
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
pub struct CorrelatedEntries {
    /// Means of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃, kg·m².
    #[getset(get_copy = "pub")]
    mean: [f64; 6],
    covariance: Covariance<6>,
}

impl CorrelatedEntries {
    /// Mean matrix and the covariance of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in (kg·m²)², which may be singular.
    ///
    /// # Errors
    /// The covariance is not finite, symmetric and positive semidefinite, or draws could overflow.
    pub fn new(
        mean: impl Into<InertiaMatrix>,
        covariance: SMatrix<f64, 6, 6>,
    ) -> Result<Self, CovarianceError> {
        let covariance = Covariance::new(covariance, MAX_VARIANCE)?;
        Ok(Self { mean: mean.into().entries(), covariance })
    }

    /// Their covariance, (kg·m²)².
    #[must_use]
    pub fn covariance(&self) -> &SMatrix<f64, 6, 6> {
        self.covariance.matrix()
    }

    /// The logarithm of the density of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m², of matrices that no body has too. None where
    /// the covariance is singular.
    #[must_use]
    pub fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        let gap = SVector::from(inertia.entries()) - SVector::from(self.mean);
        self.covariance.ln_density(&gap)
    }
}

impl KnownMoments for CorrelatedEntries {
    fn entry_moments(&self) -> EntryMoments {
        EntryMoments::unchecked(self.mean, *self.covariance.matrix())
    }
}

impl Distribution<InertiaMatrix> for CorrelatedEntries {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> InertiaMatrix {
        loop {
            let z = self.covariance.sample(rng);
            let [i11, i22, i33, i12, i13, i23] = std::array::from_fn(|i| self.mean[i] + z[i]);
            // Refused only where the mean lies at the edge of the floating-point range.
            if let Ok(matrix) = InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23]) {
                return matrix;
            }
        }
    }
}

inertia_law!(CorrelatedEntries, draws InertiaMatrix);

impl NamedModel for CorrelatedEntries {
    const NAME: &'static str = "correlated-entries";
    const DESCRIPTION: &'static str = "six jointly Gaussian entries";
    const IS_REALIZABLE: bool = false;
    const NEEDS: &'static [&'static str] = &[KEY];

    fn about(nominal: &Inertia, given: &ModelParameters) -> Result<Self, ModelParameterError> {
        let rows = given.covariance_kg2_m4.ok_or(ModelParameterError::missing(KEY))?;
        Self::new(*nominal, of_rows(rows)).map_err(|e| ModelParameterError::new(KEY, &e))
    }

    fn matched(
        mean: InertiaMatrix,
        moments: &EntryMoments,
    ) -> Result<(Self, &'static str), NoMatch> {
        const WHAT: &str = "mean and covariance of the six entries";
        Ok((Self::new(mean, *moments.covariance())?, WHAT))
    }
}

impl Conditionable for CorrelatedEntries {
    const CONDITIONED_NAME: &'static str = "realizable-correlated-entries";
    const CONDITIONED_DESCRIPTION: &'static str =
        "six jointly Gaussian entries, impossible draws rejected";
    const BEFORE_REJECTION: &'static str =
        "mean and covariance of the six entries before rejection";
}

crate::written!(
    CorrelatedEntries,
    |law| {
        mean_kg_m2: [[f64; 3]; 3] = crate::entry_moments::rows(law.mean),
        covariance_kg2_m4: [[f64; 6]; 6] = law.covariance.rows(),
    },
    CorrelatedEntries::new(InertiaMatrix::try_from(mean_kg_m2)?, of_rows(covariance_kg2_m4))?
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entry_moments::tests::check_entries;
    use gyradius_inertia::MAX_ENTRY;

    fn mean() -> InertiaMatrix {
        InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.2, 0.1, -0.5]).unwrap()
    }

    fn full() -> SMatrix<f64, 6, 6> {
        let f = SMatrix::<f64, 6, 6>::from_fn(|i, j| 0.1 * ((3 * i + 5 * j) as f64).sin());
        f * f.transpose()
    }

    #[test]
    fn draws_have_the_moments() {
        let law = CorrelatedEntries::new(mean(), full()).unwrap();
        check_entries::<InertiaMatrix>("full", &law.entry_moments(), &law, 81);
        // Of rank one, and nothing at all.
        let one = SMatrix::<f64, 6, 6>::from_fn(|i, j| ((i + 1) * (j + 1)) as f64 * 0.01);
        let law = CorrelatedEntries::new(mean(), one).unwrap();
        check_entries::<InertiaMatrix>("rank one", &law.entry_moments(), &law, 82);
        let law = CorrelatedEntries::new(mean(), SMatrix::zeros()).unwrap();
        check_entries::<InertiaMatrix>("fixed", &law.entry_moments(), &law, 83);
    }

    #[test]
    fn bad_covariances_are_named() {
        let mut bad = full();
        bad[(4, 4)] = f64::NAN;
        let error = CorrelatedEntries::new(mean(), bad).unwrap_err().to_string();
        assert!(error.contains("(5, 5) = NaN"), "{error}");
        let error = CorrelatedEntries::new(mean(), -full()).unwrap_err().to_string();
        assert!(error.contains("(1, 1)"), "{error}");
        let huge = SMatrix::<f64, 6, 6>::identity() * (MAX_ENTRY * 0.5);
        assert!(CorrelatedEntries::new(mean(), huge).is_err());
    }
}
