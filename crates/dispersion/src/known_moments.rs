//! Laws of inertia whose moments are known, and the moments of the principal one.

use crate::{AttitudeMoments, EntryMoments, EntrywiseGaussian, PrincipalDispersion, RootMoments};
use nalgebra::SMatrix;

/// A law of inertia of which the mean and covariance of the six entries are known: in closed form or
/// by quadrature, never by sampling.
pub trait KnownMoments {
    /// Mean and covariance of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃.
    fn entry_moments(&self) -> EntryMoments;
}

impl EntryMoments {
    /// Of any roots with known moments about axes from any law with known moments, by quadrature.
    #[must_use]
    pub fn of<K: RootMoments, A: AttitudeMoments>(law: &PrincipalDispersion<K, A>) -> Self {
        law.axes().entry_moments(&law.roots().second_moment_statistics())
    }
}

impl<K: RootMoments, A: AttitudeMoments> KnownMoments for PrincipalDispersion<K, A> {
    fn entry_moments(&self) -> EntryMoments {
        EntryMoments::of(self)
    }
}

impl KnownMoments for EntrywiseGaussian {
    fn entry_moments(&self) -> EntryMoments {
        let variances = self.deviations().map(|d| d * d);
        EntryMoments::unchecked(self.mean(), SMatrix::<f64, 6, 6>::from_diagonal(&variances.into()))
    }
}
