//! A radially constrained Gaussian with a weight, kept to the half sphere around its mean: by cubature over the half, or, where a
//! thin ridge of the law escapes that, by quadrature over the angles of the whole sphere.

use gyradius_attitude::RadiallyConstrainedGaussian;

use super::half_sphere::HalfSphere;
use super::whole_sphere::WholeSphere;
use crate::{EntryMoments, SecondMomentStatistics};

/// The way that finds all of the law.
pub(super) enum WeightedHalf<'a, W> {
    Cubature(HalfSphere<W>, &'a RadiallyConstrainedGaussian),
    Quadrature(WholeSphere<'a, W>),
}

impl<'a, W: Fn(&[f64; 4]) -> f64 + Copy> WeightedHalf<'a, W> {
    pub(super) fn new(law: &'a RadiallyConstrainedGaussian, weight: W) -> Self {
        let half = HalfSphere::new(law, weight);
        if half.is_whole(law) {
            Self::Cubature(half, law)
        } else {
            Self::Quadrature(WholeSphere::new(law, weight))
        }
    }

    /// The mean of the weight under the law, where it is zero in the far half.
    pub(super) fn mean_of_weight(&self) -> f64 {
        match self {
            Self::Cubature(half, law) => half.mean_of_weight(law),
            Self::Quadrature(whole) => whole.mean_of_weight(),
        }
    }

    /// The moments of the entries, with axes from the weighted law.
    pub(super) fn entry_moments(&self, k: &SecondMomentStatistics) -> EntryMoments {
        match self {
            Self::Cubature(half, _) => EntryMoments::by_quadrature(k, half.nodes()),
            Self::Quadrature(whole) => EntryMoments::by_expectation(k, whole),
        }
    }
}
