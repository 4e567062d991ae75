//! The 24 right-handed ways to name and point the axes of one body.

use gyradius_inertia::PrincipalAxes;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use std::sync::OnceLock;

/// One of the 24 right-handed ways to name and point three axes: new axis k is old axis `order[k]`,
/// pointed this way or that. As attitudes q' = turn ⊗ q.
#[derive(Clone, Copy, Debug)]
pub(super) struct Relabeling {
    pub(super) order: [usize; 3],
    pub(super) turn: UnitQuaternion<f64>,
}

impl Relabeling {
    /// All 24; the first changes nothing.
    pub(super) fn all() -> &'static [Self; 24] {
        static ALL: OnceLock<[Relabeling; 24]> = OnceLock::new();
        ALL.get_or_init(|| {
            const SIGNS: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
            std::array::from_fn(|i| {
                let (order, parity) = PrincipalAxes::ORDERS[i / 4];
                let [a, b] = SIGNS[i % 4];
                let signs = [a, b, parity * a * b];
                let matrix = Matrix3::from_fn(
                    |row, column| {
                        if order[row] == column { signs[row] } else { 0.0 }
                    },
                );
                let rotation = Rotation3::from_matrix_unchecked(matrix);
                Relabeling { order, turn: UnitQuaternion::from_rotation_matrix(&rotation) }
            })
        })
    }
}

/// Roots of the second moments and the attitude of the axes they belong to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub(super) roots: [f64; 3],
    pub(super) attitude: UnitQuaternion<f64>,
}

gyradius_dispersion::written!(
    Sample,
    |sample| {
        roots_sqrt_kg_m: [f64; 3] = sample.roots,
        axes: gyradius_dispersion::FixedAttitude = sample.attitude.into(),
    },
    Sample { roots: roots_sqrt_kg_m, attitude: axes.attitude() }
);

impl Sample {
    pub(super) fn relabeled(&self, g: &Relabeling) -> Self {
        Self { roots: g.order.map(|i| self.roots[i]), attitude: g.turn * self.attitude }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_inertia::{Inertia, RootSecondMoments};

    #[test]
    fn all_24_are_the_same_body_and_no_two_are_the_same_turn() {
        let sample = Sample {
            roots: [1.0, 2.0, 3.0],
            attitude: UnitQuaternion::from_euler_angles(0.3, -0.4, 1.0),
        };
        let body = |s: &Sample| {
            let k = RootSecondMoments::new(s.roots).unwrap().squared();
            Inertia::from_second_moments(k, &s.attitude).unwrap()
        };
        let all = Relabeling::all();
        assert!(all[0].order == [0, 1, 2] && all[0].turn.angle() < 1e-15);
        for (i, g) in all.iter().enumerate() {
            assert!((body(&sample.relabeled(g)).matrix() - body(&sample).matrix()).amax() < 1e-13);
            for other in &all[..i] {
                assert!(g.turn.angle_to(&other.turn) > 1.0);
            }
        }
    }
}
