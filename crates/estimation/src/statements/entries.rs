//! The six entries as the axes move them: moments of the forms that multiply the second moments.

use gyradius_dispersion::SecondMomentStatistics;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

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

    /// About axes given by nodes and weights, near this attitude or not: what is summed is what the forms are more than
    /// there, so that small covariances keep their digits.
    pub(super) fn over(near: &UnitQuaternion<f64>, nodes: &[(f64, UnitQuaternion<f64>)]) -> Self {
        let first = forms(near);
        let mut total = 0.0;
        let mut sums = [[0.0; 3]; 6];
        let mut squares = [[0.0; 6]; 6];
        for (weight, q) in nodes {
            let forms = forms(q);
            total += weight;
            for e in 0..6 {
                let off = forms[e] - first[e];
                let [x, y, z] = [off.x * weight, off.y * weight, off.z * weight];
                sums[e][0] += x;
                sums[e][1] += y;
                sums[e][2] += z;
                squares[e][0] += x * off.x;
                squares[e][1] += y * off.y;
                squares[e][2] += z * off.z;
                squares[e][3] += x * off.y;
                squares[e][4] += x * off.z;
                squares[e][5] += y * off.z;
            }
        }
        let off = sums.map(|sum| Vector3::from(sum) / total);
        let covariance = std::array::from_fn(|e| {
            let [xx, yy, zz, xy, xz, yz] = squares[e].map(|sum| sum / total);
            Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) - off[e] * off[e].transpose()
        });
        Self { mean: std::array::from_fn(|e| first[e] + off[e]), covariance }
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
    let r = q.to_rotation_matrix();
    let [x, y, z] = [0, 1, 2].map(|a| r.matrix().column(a).into_owned());
    let one = Vector3::from_element(1.0);
    [
        one - x.component_mul(&x),
        one - y.component_mul(&y),
        one - z.component_mul(&z),
        -x.component_mul(&y),
        -x.component_mul(&z),
        -y.component_mul(&z),
    ]
}
