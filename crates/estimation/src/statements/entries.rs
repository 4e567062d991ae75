//! The six entries as the axes move them: moments of the forms that multiply the second moments.

use gyradius_dispersion::SecondMomentStatistics;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use pulp::{Simd, WithSimd};

/// Room for the six entries that vector units of any length fill.
const LANES: usize = 8;
/// Nodes that are added at a time: few enough for the first-level cache.
const TOGETHER: usize = 64;

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
        let mut sums = Sums::default();
        let mut offs = Vec::with_capacity(TOGETHER);
        for nodes in nodes.chunks(TOGETHER) {
            offs.clear();
            offs.extend(nodes.iter().map(|(weight, q)| {
                let forms = forms(q);
                let mut off = Off { weight: *weight, axes: [[0.0; LANES]; 3] };
                for e in 0..6 {
                    for k in 0..3 {
                        off.axes[k][e] = forms[e][k] - first[e][k];
                    }
                }
                off
            }));
            pulp::Arch::new().dispatch(Add { offs: &offs, sums: &mut sums });
        }
        let Sums { total, firsts, squares } = sums;
        let off: [Vector3<f64>; 6] =
            std::array::from_fn(|e| Vector3::from(firsts.map(|sum| sum[e])) / total);
        let covariance = std::array::from_fn(|e| {
            let [xx, yy, zz, xy, xz, yz] = squares.map(|sum| sum[e] / total);
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

/// What the forms of the entries at a node are more than about the first axes, one component after the other.
struct Off {
    weight: f64,
    axes: [[f64; LANES]; 3],
}

/// Weights, and what they multiply: forms, and their products xx, yy, zz, xy, xz and yz, in the lane of each entry.
#[derive(Default)]
struct Sums {
    total: f64,
    firsts: [[f64; LANES]; 3],
    squares: [[f64; LANES]; 6],
}

/// Adds nodes one after the other, all entries at once, by the machine's vector units.
struct Add<'a> {
    offs: &'a [Off],
    sums: &'a mut Sums,
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Sums { mut total, mut firsts, mut squares } = *self.sums;
        for Off { weight, axes: [x, y, z] } in self.offs {
            total += weight;
            for e in 0..LANES {
                let [wx, wy, wz] = [x[e] * weight, y[e] * weight, z[e] * weight];
                firsts[0][e] += wx;
                firsts[1][e] += wy;
                firsts[2][e] += wz;
                squares[0][e] += wx * x[e];
                squares[1][e] += wy * y[e];
                squares[2][e] += wz * z[e];
                squares[3][e] += wx * y[e];
                squares[4][e] += wx * z[e];
                squares[5][e] += wy * z[e];
            }
        }
        *self.sums = Sums { total, firsts, squares };
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Every vector unit that this machine has, and none.
        #[test]
        fn vectors_of_any_length_make_the_same_sums(
            numbers in prop::collection::vec(prop::array::uniform32(-1.0..1.0f64), 0..20),
        ) {
            let offs: Vec<Off> = numbers
                .iter()
                .map(|of| Off {
                    weight: of[0],
                    axes: [0, 8, 16].map(|from| std::array::from_fn(|e| of[from + e])),
                })
                .collect();
            let summed = |add: &dyn Fn(Add<'_>)| {
                let mut sums = Sums::default();
                add(Add { offs: &offs, sums: &mut sums });
                let Sums { total, firsts, squares } = sums;
                [&[total], firsts.as_flattened(), squares.as_flattened()].concat()
            };
            let expected = summed(&|add| pulp::Scalar::new().vectorize(add));
            #[cfg(target_arch = "x86_64")]
            if let Some(simd) = pulp::x86::V3::try_new() {
                prop_assert_eq!(summed(&|add| Simd::vectorize(simd, add)), expected.clone());
            }
            prop_assert_eq!(summed(&|add| pulp::Arch::new().dispatch(add)), expected);
        }
    }
}
