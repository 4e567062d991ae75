//! The principal axes of a body as a spin sees them: the one nearest to the spin axis first.

use gyradius_inertia::{InertiaMatrix, RELATIVE_TOLERANCE};
use nalgebra::{Unit, Vector3};

/// Principal axes a₁, a₂ and a₃ in body components, and the moments about them. a₁ is the axis nearest to a
/// spin axis, pointing along it; a₂ and a₃ may point either way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpinAxes {
    pub(crate) axes: [Vector3<f64>; 3],
    pub(crate) moments: [f64; 3],
}

impl SpinAxes {
    /// Of a body and a spin axis.
    ///
    /// Moments that are equal but for rounding come out as the same number. Every axis in the plane of two equal
    /// moments is principal, so that the nearest one is the projection of the spin axis on the plane, and of a body
    /// with three equal moments it is the spin axis itself. What `PrincipalAxes` has there depends on the
    /// body axes, which mean nothing for the spin.
    pub(crate) fn new(inertia: &InertiaMatrix, spin_axis: &Unit<Vector3<f64>>) -> Self {
        let principal = inertia.principal_axes();
        let moments = principal.moments();
        let axes = *principal.axes().matrix();
        let along = axes.tr_mul(spin_axis.as_ref());
        // A principal axis that was found, and the others in cyclic order.
        let found = |number: usize| {
            let order = [number, (number + 1) % 3, (number + 2) % 3];
            let mut axes = order.map(|i| axes.column(i).into_owned());
            axes[0] *= 1.0_f64.copysign(along[number]);
            Self { axes, moments: order.map(|i| moments[i]) }
        };
        // The rounding up to which the axes are left free to turn.
        let largest = moments.iter().fold(0.0_f64, |largest, moment| largest.max(moment.abs()));
        let equal =
            |i: usize, j: usize| (moments[i] - moments[j]).abs() <= RELATIVE_TOLERANCE * largest;
        let odd = match (equal(1, 2), equal(2, 0), equal(0, 1)) {
            (false, false, false) => return found(along.iamax()),
            (true, false, false) => 0,
            (false, true, false) => 1,
            (false, false, true) => 2,
            (true, true, _) | (true, _, true) | (_, true, true) => {
                return Self::of_ball(moments[0], spin_axis);
            }
        };
        let (i, j) = ((odd + 1) % 3, (odd + 2) % 3);
        let pair = 0.5 * (moments[i] + moments[j]);
        let in_plane = libm::hypot(along[i], along[j]);
        if along[odd].abs() >= in_plane {
            return Self { moments: [moments[odd], pair, pair], ..found(odd) };
        }
        let nearest = (axes.column(i) * along[i] + axes.column(j) * along[j]) / in_plane;
        let last = axes.column(odd).into_owned();
        Self { axes: [nearest, last.cross(&nearest), last], moments: [pair, pair, moments[odd]] }
    }

    /// Of a body whose three moments are equal.
    fn of_ball(moment: f64, spin_axis: &Unit<Vector3<f64>>) -> Self {
        let first = spin_axis.into_inner();
        // Any axis across it, and the body axis that is the farthest from it leads to one.
        let second = first.cross(&Vector3::ith(first.iamin(), 1.0)).normalize();
        Self { axes: [first, second, first.cross(&second)], moments: [moment; 3] }
    }
}

#[cfg(test)]
mod tests {
    use crate::SpinMetrics;
    use gyradius_inertia::InertiaMatrix;
    use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
    use proptest::prelude::*;
    use std::f64::consts::PI;

    type V = Vector3<f64>;

    /// Off a number by units in the last place.
    fn off(x: f64, units: i32) -> f64 {
        x * (1.0 + f64::from(units) * f64::EPSILON)
    }

    proptest! {
        /// A body with two or three equal moments has the same measures in whatever axes it is written down: those that follow
        /// from the angles to its axis of symmetry and to the plane across it. A rod and a point are among the bodies.
        #[test]
        fn measures_of_symmetric_bodies_do_not_depend_on_the_body_axes(
            equal in prop_oneof![9 => 1.0..2.0_f64, 1 => Just(1.0)],
            odd in prop_oneof![4 => 0.05..0.9_f64, 4 => 1.1..1.9, 1 => Just(0.0), 2 => Just(1.0)],
            units in prop::array::uniform2(-2..3i32),
            size in -6..7i32,
            spin in prop::array::uniform3(-1.0..1.0_f64),
            rate in prop::array::uniform3(-1.0..1.0_f64),
            turns in prop::array::uniform2(prop::array::uniform3(-4.0..4.0_f64)),
            written in prop_oneof![Just(true), Just(false)],
        ) {
            let (spin, rate) = (V::from(spin), V::from(rate));
            prop_assume!(spin.norm() > 0.1 && rate.norm() > 0.1);
            let s = Unit::new_normalize(spin);
            let share = [s.z.abs(), s.x.hypot(s.y)];
            // Where the axis is as near as the plane, rounding decides.
            prop_assume!(odd == 1.0 || (share[0] - share[1]).abs() > 1e-6);
            let scale = equal * 10.0_f64.powi(size);
            let moments = [off(scale, units[0]), off(scale, units[1]), odd * scale];
            let of = |turn: [f64; 3]| {
                let turn = *Rotation3::new(V::from(turn)).matrix();
                let turned: Matrix3<f64> = turn * Matrix3::from_diagonal(&V::from(moments)) * turn.transpose();
                let inertia = InertiaMatrix::new((turned + turned.transpose()) * 0.5).unwrap();
                SpinMetrics::new(&inertia, &(turn * rate), &Unit::new_normalize(turn * spin))
            };
            let mut turns = turns;
            if written {
                // As it is written down most often.
                turns[0] = [0.0; 3];
            }
            let h = V::new(rate.x, rate.y, odd * rate.z);
            let about = |axis: V| axis.cross(&h).norm().atan2(axis.dot(&h));
            // Near a direction an angle is a root of what was rounded.
            let near = |x: f64, y: f64| (x - y).abs() < 1e-11 / odd.max(0.05) / (odd - 1.0).abs().clamp(0.05, 1.0);
            for metrics in turns.map(of) {
                let nutation = metrics.nutation().unwrap();
                let [least, greatest] = metrics.nutation_bounds().unwrap();
                let extremes = [metrics.nutation_2(), metrics.nutation_3()];
                let cone = metrics.cone().unwrap();
                prop_assert!(near(cone, about(s.into_inner())), "{metrics:?}");
                if odd == 1.0 {
                    prop_assert!(metrics.wobble() == 0.0 && nutation == cone, "{metrics:?}");
                    prop_assert!(near(least, cone) && near(greatest, cone), "{metrics:?}");
                    prop_assert_eq!((extremes, metrics.inertia_ratio()), ([None; 2], Some(1.0)));
                } else if share[0] > share[1] {
                    let axis = V::z() * s.z.signum();
                    prop_assert!(near(metrics.wobble(), share[1].atan2(share[0])), "{metrics:?}");
                    prop_assert!(near(nutation, about(axis)), "{metrics:?}");
                    for steady in [Some(least), Some(greatest)].into_iter().chain(extremes) {
                        prop_assert!(near(steady.unwrap(), nutation), "{metrics:?}");
                    }
                    prop_assert!(near(metrics.inertia_ratio().unwrap(), odd), "{metrics:?}");
                } else {
                    let plane = V::new(s.x, s.y, 0.0) / share[1];
                    prop_assert!(near(metrics.wobble(), share[0].atan2(share[1])), "{metrics:?}");
                    prop_assert!(near(nutation, about(plane)), "{metrics:?}");
                    // H circles the axis of symmetry, and the plane's axis passes it on both sides.
                    let turned = h.z.abs().atan2(h.x.hypot(h.y));
                    prop_assert!(near(least, turned) && near(greatest, PI - turned), "{metrics:?}");
                    let ratio = (odd > 0.0).then_some(1.0);
                    prop_assert_eq!((extremes, metrics.inertia_ratio()), ([None; 2], ratio));
                }
            }
        }
    }

    /// Moments that differ in the last places are equal: the body does not go through a range that rounding has made.
    #[test]
    fn moments_equal_but_for_rounding_are_equal() {
        let (h, x) = (V::new(0.7, -0.4, 1.1), V::x_axis());
        let bounds = |moments: [f64; 3]| {
            let rate = V::from_fn(|i, _| h[i] / moments[i]);
            let inertia = InertiaMatrix::from_entries(moments, [0.0; 3]).unwrap();
            SpinMetrics::new(&inertia, &rate, &x).nutation_bounds().unwrap()
        };
        for i in 0..125 {
            let of = |k: u32| off(1.0, i / 5_i32.pow(k) % 5 - 2);
            for scale in [1e-3, 1.0, 7e5] {
                let sphere = [of(0), of(1), of(2)].map(|x| x * scale);
                let [least, greatest] = bounds(sphere);
                assert!(greatest - least < 1e-14, "{sphere:?}: {least} {greatest}");
                let top = [2.0 * of(0), of(1), of(2)].map(|x| x * scale);
                let [least, greatest] = bounds(top);
                assert!(greatest - least < 1e-12, "{top:?}: {least} {greatest}");
            }
        }
        // What differs by more nutates, however slowly.
        let [least, greatest] = bounds([1.0, 1.0 + 1e-13, 1.0 + 3e-13]);
        assert!(greatest - least > 0.1, "{least} {greatest}");
    }
}
