//! The six entries as the axes move them: moments of the forms that multiply the second moments.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::{SecondMomentStatistics, entry_moments::real_forms};

/// An entry is Σ_k K_k M_k with forms M of the axes: the mean and the covariance of M for each entry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Forms {
    mean: [Vector3<f64>; 6],
    covariance: [Matrix3<f64>; 6],
}

impl Forms {
    /// About axes that stay where they are.
    pub(super) fn still(attitude: &UnitQuaternion<f64>) -> Self {
        Self { mean: forms(attitude), covariance: [Matrix3::zeros(); 6] }
    }

    /// About axes given by nodes and weights. They are gone through twice, so that small covariances
    /// keep their digits.
    pub(super) fn over(nodes: &[(f64, UnitQuaternion<f64>)]) -> Self {
        let mut total = 0.0;
        let mut mean = [Vector3::zeros(); 6];
        for (weight, q) in nodes {
            total += weight;
            for (sum, form) in mean.iter_mut().zip(forms(q)) {
                *sum += form * *weight;
            }
        }
        let mean = mean.map(|sum| sum / total);
        let mut covariance = [Matrix3::zeros(); 6];
        for (weight, q) in nodes {
            for ((sum, form), mean) in covariance.iter_mut().zip(forms(q)).zip(&mean) {
                let off = form - mean;
                *sum += (off * *weight) * off.transpose();
            }
        }
        Self { mean, covariance: covariance.map(|sum| sum / total) }
    }

    /// Means of the entries, kg·m².
    pub(super) fn means(&self, k: &SecondMomentStatistics) -> [f64; 6] {
        let mean = Vector3::from(k.mean());
        self.mean.map(|m| m.dot(&mean))
    }

    /// Variances of the entries, (kg·m²)².
    pub(super) fn variances(&self, k: &SecondMomentStatistics) -> [f64; 6] {
        let (mean, covariance) = (Vector3::from(k.mean()), k.covariance());
        let square = mean * mean.transpose() + covariance;
        std::array::from_fn(|e| {
            self.covariance[e].dot(&square) + self.mean[e].dot(&(covariance * self.mean[e]))
        })
    }
}

/// The forms of each entry.
fn forms(q: &UnitQuaternion<f64>) -> [Vector3<f64>; 6] {
    let forms = real_forms(q);
    std::array::from_fn(|e| Vector3::from_fn(|k, _| forms[k][e]))
}
