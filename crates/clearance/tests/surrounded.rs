//! Hulls that leave a ring around them, spinning about its axis or nearly so.

use gyradius_clearance::{Clearance, ClearanceSettings, Coast, FreeBody, RigidState};
use nalgebra::{Matrix3, UnitQuaternion};
use proptest::prelude::*;

use crate::{
    brute::check,
    forms::{Form, V, vector},
};

/// Corners on two circles.
fn prism(sides: u32, radius: f64) -> Form {
    let corner = |k: u32, z: f64| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(sides);
        V::new(radius * angle.cos(), radius * angle.sin(), z)
    };
    Form::Hull((0..sides).flat_map(|k| [corner(k, -1.9), corner(k, 0.0)]).collect())
}

fn body(velocity: V, rate: V, moments: [f64; 3]) -> FreeBody {
    let state = RigidState { velocity, angular_velocity: rate, ..RigidState::default() };
    FreeBody::new(state, Matrix3::from_diagonal(&moments.into())).unwrap()
}

/// The distance of a prism that spins about the axis of the ring, and leaves along it, is the same until it is out: that is proven
/// without following each corner along the ring, which took up to two million looks.
#[test]
fn spinning_about_the_axis_costs_little() {
    let settings = ClearanceSettings::default();
    for (sides, spin, speed) in [
        (24, 0.0, 0.3),
        (24, 0.5, 0.3),
        (24, 5.0, 0.3),
        (24, 0.5, 0.05),
        (24, 0.1, 0.3),
        (8, 0.5, 0.3),
        (4, 1.0, 0.3),
        (3, 1.0, 0.3),
    ] {
        for of_ring in [0.0, spin, -0.3] {
            let payload = body(V::z() * speed, V::z() * spin, [20.0, 20.0, 22.0]);
            let stage = body(V::zeros(), V::z() * of_ring, [20.0, 21.0, 22.0]);
            let mut coast = Coast::new(&payload, &stage, 0.0);
            let outlines = [prism(sides, 0.5), Form::Ring(V::zeros(), V::z(), 0.6)];
            let [hull, ring] = outlines.map(|form| form.outline());
            let c = Clearance::new(&hull, &ring, &mut coast, 0.0, 60.0, &settings).unwrap();
            let closest = c.closest().unwrap();
            assert!((closest.distance_m() - 0.1).abs() < 1e-8, "{closest:?}");
            assert!(
                c.looks() < 40_000 && !c.is_stopped(),
                "{sides} {spin} {of_ring}: {}",
                c.looks()
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    /// Nearly so: drifting aside, turning away, off the axis.
    #[test]
    fn leaving_a_ring_agrees_with_brute_force(
        sides in 3..9_u32,
        gap in prop_oneof![0.001..0.02f64, 0.02..0.3f64],
        spins in prop::array::uniform2(-3.0..3.0f64),
        speed in 0.05..0.5f64,
        size in prop::sample::select(vec![1e-3, 0.03]),
        (drift, rates, turn, place) in (vector(1.0), prop::array::uniform2(vector(1.0)), vector(0.3), vector(0.3)),
        moments in prop::array::uniform2(prop::array::uniform3(2.0..3.9f64)),
    ) {
        let payload = {
            let free = body(V::z() * speed + drift * size, V::z() * spins[0] + rates[0] * size, moments[0]);
            let attitude = UnitQuaternion::from_scaled_axis(turn * size);
            let state = RigidState { attitude, position: place * size, ..free.state };
            FreeBody::new(state, free.inertia).unwrap()
        };
        let stage = body(V::zeros(), V::z() * spins[1] + rates[1] * size, moments[1]);
        let mut coast = Coast::new(&payload, &stage, 0.0);
        let forms = [prism(sides, 0.5), Form::Ring(V::zeros(), V::z(), 0.5 + gap)];
        let settings = ClearanceSettings::new(1e-6, 1e-4, 1e-1).unwrap();
        check([&forms[0], &forms[1]], &mut coast, 3.0 / speed, 80, &settings, 1.0)?;
    }
}
