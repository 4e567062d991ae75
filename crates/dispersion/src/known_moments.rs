//! Laws of inertia whose moments are known.

use crate::EntryMoments;

/// A law of inertia of which the mean and covariance of the six entries are known: in closed form or
/// by quadrature, never by sampling.
pub trait KnownMoments {
    /// Mean and covariance of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃.
    fn entry_moments(&self) -> EntryMoments;
}
