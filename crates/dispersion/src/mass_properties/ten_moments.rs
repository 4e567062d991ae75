//! Mean and covariance of ten numbers.

use nalgebra::{SMatrix, SVector};

#[cfg(feature = "serde")]
use crate::semidefinite::{computed, of_rows};

/// Mean and covariance of ten parameters.
#[derive(Clone, Debug, PartialEq, getset::Getters)]
#[getset(get = "pub")]
pub struct TenMoments {
    /// The means, in kg, m (or kg·m) and kg·m².
    mean: SVector<f64, 10>,
    /// The covariance.
    covariance: SMatrix<f64, 10, 10>,
}

impl TenMoments {
    pub(crate) fn unchecked(mean: SVector<f64, 10>, covariance: SMatrix<f64, 10, 10>) -> Self {
        Self { mean, covariance }
    }

    /// The standard deviations.
    #[must_use]
    pub fn deviations(&self) -> [f64; 10] {
        // Rounding may leave a variance of zero a hair below it.
        std::array::from_fn(|i| self.covariance[(i, i)].max(0.0).sqrt())
    }
}

crate::written!(
    TenMoments,
    |moments| {
        mean: [f64; 10] = moments.mean.into(),
        covariance: [[f64; 10]; 10] = moments.covariance.transpose().into(),
    },
    TenMoments { mean: mean.into(), covariance: computed(of_rows(covariance))? }
);
