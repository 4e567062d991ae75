//! The six entries as the axes move them: moments of the forms that multiply the second moments.

use gyradius_dispersion::SecondMomentStatistics;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{
    nodes::{Rule, Turns},
    square_moments::{Element, SquareMoments},
};
use crate::turns::FIXED;

/// The six entries, in their order.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// What a radian about each principal axis adds to the form of each entry, to first order.
pub(super) fn moved_by_turns(attitude: &UnitQuaternion<f64>) -> [[Vector3<f64>; 3]; 6] {
    let r = attitude.to_rotation_matrix();
    ENTRIES.map(|(a, b)| {
        [0, 1, 2].map(|j| {
            let (m, n) = ((j + 1) % 3, (j + 2) % 3);
            let moved = r[(m, a)] * r[(n, b)] + r[(n, a)] * r[(m, b)];
            Vector3::ith(m, moved) - Vector3::ith(n, moved)
        })
    })
}

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

    /// What axes that nothing moves add, since a law holds them no closer than [`FIXED`], to first order: no law has less.
    pub(super) fn held(attitude: &UnitQuaternion<f64>) -> Self {
        let of_entry = |moved: [Vector3<f64>; 3]| -> Matrix3<f64> {
            moved.map(|moved| FIXED * FIXED * moved * moved.transpose()).iter().sum()
        };
        Self { mean: [Vector3::zeros(); 6], covariance: moved_by_turns(attitude).map(of_entry) }
    }

    /// About axes that turn: what is summed is what the forms are more than about the mean, so that small covariances keep their
    /// digits.
    ///
    /// With half turns z about the axes a of a law, and w, an element of R(m ⊗ x) is Σ_pq b_p S_pq a_q, b being R(m) a and S the
    /// rotation matrix of x about the axes of the law. That is a quadratic form of x, and the forms M are quartic ones.
    pub(super) fn over(turns: &Turns, rule: Rule) -> Self {
        let moments = SquareMoments::of(turns, rule);
        let axes = turns.about.map(|axis| turns.mean * axis);
        // R_ka by k, and by a.
        let elements: [[Element; 3]; 3] = std::array::from_fn(|k| {
            let ends = axes.map(|axis| axis[k]);
            std::array::from_fn(|a| Element::of(ends, turns.about.map(|axis| axis[a])))
        });
        let first = forms(&turns.mean);
        let (mut mean, mut covariance) = (first, [Matrix3::zeros(); 6]);
        for (e, (a, b)) in ENTRIES.into_iter().enumerate() {
            let products = elements.each_ref().map(|of_k| of_k[a].times(&of_k[b]));
            let against = products.each_ref().map(|product| moments.against(product));
            mean[e] -= Vector3::from(products.each_ref().map(|product| moments.mean(product)));
            covariance[e] = Matrix3::from_fn(|k, l| products[k].dot(&against[l]));
        }
        Self { mean, covariance }
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
pub(super) fn forms(q: &UnitQuaternion<f64>) -> [Vector3<f64>; 6] {
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
    use gyradius_attitude::UniformAttitude;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::Distribution;

    proptest! {
        /// The sums over all nodes, of narrow laws and wide ones, with axes of either hand.
        #[test]
        fn forms_are_those_of_the_nodes(seed in any::<u64>(), fine in any::<bool>()) {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mean: UnitQuaternion<f64> = UniformAttitude.sample(&mut rng);
            let about: UnitQuaternion<f64> = UniformAttitude.sample(&mut rng);
            let hand = if rng.random() { 1.0 } else { -1.0 };
            let turns = Turns {
                mean,
                about: [Vector3::x(), Vector3::y(), Vector3::z() * hand].map(|axis| about * axis),
                variances: [0; 3].map(|_| libm::pow(10.0, rng.random_range(-6.0..2.0))),
                radial_variance: libm::pow(10.0, rng.random_range(-2.0..2.0)),
            };
            let rule = if fine { Rule::FINE } else { Rule::QUICK };
            let found = Forms::over(&turns, rule);
            let (nodes, first) = (turns.nodes(rule), forms(&mean));
            let total: f64 = nodes.iter().map(|(weight, _)| weight).sum();
            for (e, first) in first.into_iter().enumerate() {
                let offs = || nodes.iter().map(|(weight, q)| (weight / total, forms(q)[e] - first));
                let off: Vector3<f64> = offs().map(|(weight, off)| off * weight).sum();
                let square: Matrix3<f64> = offs().map(|(weight, off)| off * off.transpose() * weight).sum();
                let covariance = square - off * off.transpose();
                // The forms are 1 at most, and at the nodes have the rounding of that.
                let scale = square.amax();
                prop_assert!((found.mean[e] - first - off).amax() <= 1e-15 + 1e-13 * scale.sqrt());
                prop_assert!((found.covariance[e] - covariance).amax() <= 1e-11 * scale);
            }
        }
    }
}
