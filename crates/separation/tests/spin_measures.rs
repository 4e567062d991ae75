//! Nutation against dense histories of the motion, and directions that rounding alone has made.

use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{
    Body, BodyState, Separation, Settings, SpinMetrics, Spring, Stack, StackParameter,
};
use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;

type V = Vector3<f64>;

fn vector(range: f64) -> impl Strategy<Value = V> {
    prop::array::uniform3(-range..range).prop_map(V::from)
}

/// Euler's equations along principal axes by many small steps of Runge-Kutta.
fn history(moments: [f64; 3], rate: V, until: f64, steps: u32) -> Vec<V> {
    let slope = |h: V| {
        let w = V::from_fn(|i, _| h[i] / moments[i]);
        h.cross(&w)
    };
    let dt = until / f64::from(steps);
    let mut h = V::from_fn(|i, _| moments[i] * rate[i]);
    let mut all = vec![h];
    for _ in 0..steps {
        let k1 = slope(h);
        let k2 = slope(h + k1 * (0.5 * dt));
        let k3 = slope(h + k2 * (0.5 * dt));
        let k4 = slope(h + k3 * dt);
        h += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (dt / 6.0);
        all.push(h);
    }
    all
}

/// Where a component changes sign: the angles from the first axis.
fn angles_where_zero(history: &[V], component: usize, sign: f64) -> Vec<f64> {
    let crossing = |pair: &[V]| {
        let (a, b) = (pair[0][component], pair[1][component]);
        (a * b < 0.0).then(|| pair[0] + (pair[1] - pair[0]) * (a / (a - b)))
    };
    let angle = |h: V| h.y.hypot(h.z).atan2(sign * h.x);
    history.windows(2).filter_map(crossing).map(angle).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    /// Spin about every body axis and its opposite, forward, backward and across; a₁ of least,
    /// intermediate and largest moment.
    #[test]
    fn nutation_is_that_of_the_motion(
        moments in prop::array::uniform3(1.0..4.0f64),
        tilt in vector(0.15),
        lean in vector(0.15),
        axis in 0..3usize,
        backward in any::<bool>(),
        main in prop_oneof![3 => Just(1.0), 1 => Just(0.0)],
        reverse in prop_oneof![Just(1.0), Just(-1.0)],
        rest in vector(1.0),
        size in -12..=3i32,
    ) {
        let m = moments;
        let gaps = [(m[0] - m[1]).abs(), (m[1] - m[2]).abs(), (m[2] - m[0]).abs()];
        prop_assume!(gaps.iter().all(|g| *g > 0.1));
        // Columns: principal axes in body components, each near the body axis of its number.
        let axes = UnitQuaternion::from_scaled_axis(tilt).to_rotation_matrix().into_inner();
        let entries = axes * Matrix3::from_diagonal(&V::from(m)) * axes.transpose();
        let inertia = InertiaMatrix::new(entries).unwrap();
        let sign = if backward { -1.0 } else { 1.0 };
        let s = Unit::new_normalize(V::ith(axis, sign) + lean);
        // Along the principal axes.
        let rate = V::ith(axis, 2.0 * main * sign * reverse) + rest;
        let scale = 10.0_f64.powi(size);
        let found = SpinMetrics::new(&inertia, &(axes * rate * scale), &s);

        // The motion with the axes in the order a1, a2, a3; at the scale of one.
        let order = [axis, (axis + 1) % 3, (axis + 2) % 3];
        let (moments, rate) = (order.map(|i| m[i]), V::from(order.map(|i| rate[i])));
        let path = history(moments, rate, 400.0, 40_000);
        let angle = |h: &V| h.y.hypot(h.z).atan2(sign * h.x);
        let (least, greatest) = path.iter().map(angle).fold((4.0, 0.0), |(a, b): (f64, f64), x| {
            (a.min(x), b.max(x))
        });
        let now = found.nutation().unwrap();
        prop_assert!((now - angle(&path[0])).abs() < 1e-12);
        let bounds = found.nutation_bounds().unwrap();
        prop_assert!(bounds[0] <= now && now <= bounds[1]);
        // Near the separatrix the motion lingers, and has not been everywhere.
        prop_assert!(bounds[0] <= least + 1e-6 && bounds[1] >= greatest - 1e-6);
        let middle = { let mut all = moments; all.sort_by(f64::total_cmp); all[1] };
        let h = V::from_fn(|i, _| moments[i] * rate[i]);
        let apart = (rate.dot(&h) * middle / h.norm_squared() - 1.0).abs();
        if apart > 0.02 {
            prop_assert!((bounds[0] - least).abs() < 1e-3, "{:?} {}", bounds, least);
            prop_assert!((bounds[1] - greatest).abs() < 1e-3, "{:?} {}", bounds, greatest);
        }

        // H circles a1 if it never passes the plane across it.
        let extreme = moments[0] != middle;
        let circles = (rate.dot(&h) > h.norm_squared() / middle) == (moments[0] < middle);
        let [two, three] = [found.nutation_2(), found.nutation_3()];
        prop_assert_eq!((two.is_some(), three.is_some()), (extreme && circles, extreme && circles));
        for (value, component) in [(two, 2), (three, 1)] {
            let Some(value) = value else { continue };
            prop_assert!(bounds[0] <= value && value <= bounds[1]);
            prop_assert_eq!(value > std::f64::consts::FRAC_PI_2, now > std::f64::consts::FRAC_PI_2);
            for seen in angles_where_zero(&path, component, sign) {
                prop_assert!((value - seen).abs() < 1e-3, "{} {}", value, seen);
            }
        }
    }

    /// Springs whose lines go through the payload's mass centre, or that stand around it in a ring, do not
    /// turn it: what the run gives it is below the rounding that it states, and no direction is told, however far from the
    /// origin they are, and however the whole is turned. A rate from the start that is above it tells all.
    #[test]
    fn directions_of_rounding_are_not_told(
        moments in prop::array::uniform3(1.0..1.9f64),
        tilt in vector(3.0),
        turned in prop::array::uniform2(vector(3.0)),
        count in 1..7usize,
        ring in any::<bool>(),
        sizes in (-2..3i32, -1..5i32, 1..6i32, -3..0i32),
        rate in prop_oneof![Just(None), (-22.0..0.0f64).prop_map(Some)],
        tolerance in prop_oneof![Just(1e-13), Just(1e-14), Just(1e-9)],
        away in prop_oneof![Just(None), (vector(1.0), 0..9i32, vector(1.0), 0..5i32).prop_map(Some)],
        whole in prop_oneof![Just(V::zeros()), vector(100.0)],
    ) {
        let [place, speed] = away.map_or([V::zeros(); 2], |(place, far, speed, fast)| {
            [place * 10.0_f64.powi(far), speed * 10.0_f64.powi(fast)]
        });
        let (length, mass, stiffness, stroke) =
            (10.0_f64.powi(sizes.0), 10.0_f64.powi(sizes.1), 10.0_f64.powi(sizes.2), 10.0_f64.powi(sizes.3) * 0.7);
        let axes = UnitQuaternion::from_scaled_axis(tilt).to_rotation_matrix().into_inner();
        let inertia = |k: f64| {
            let diagonal = Matrix3::from_diagonal(&(V::from(moments) * (k * mass * length * length)));
            InertiaMatrix::new(if ring { diagonal } else { axes * diagonal * axes.transpose() }).unwrap()
        };
        // A ring of springs turns nothing only where the bodies stand straight and have the axis.
        let attitude = turned.map(|t| {
            if ring { UnitQuaternion::from_scaled_axis(V::z() * t.z) } else { UnitQuaternion::from_scaled_axis(t) }
        });
        let angular_velocity = rate.map_or(V::zeros(), |r| V::z() * 10.0_f64.powf(r));
        let payload = Body::new(mass, inertia(1.0)).unwrap().moving(BodyState {
            position: place + V::z() * (1.5 * length), velocity: speed, attitude: attitude[0], angular_velocity
        });
        let stage = Body::new(3.0 * mass, inertia(2.0)).unwrap().moving(BodyState {
            position: place - V::z() * length, velocity: speed, attitude: attitude[1], ..Default::default()
        });
        let turned = |separation: Separation| {
            let mut stack = Stack::from(&separation);
            (0..3).for_each(|i| stack.set_whole(StackParameter::Attitude, i, whole[i]));
            stack.separation().unwrap()
        };
        let springs: Vec<Spring> = (0..count.max(if ring { 3 } else { 1 })).map(|i| {
            let angle = std::f64::consts::TAU * i as f64 / count.max(3) as f64;
            let aside = if ring { V::new(angle.cos(), angle.sin(), 0.0) } else { V::zeros() };
            let up = if ring { 0.5 } else { 0.2 + 0.1 * i as f64 };
            // From the mass centres to points in the inertial frame.
            let p = (aside - V::z() * up) * length;
            let l = (aside + V::z() * (0.5 + 0.1 * up)) * length;
            Spring::new(stiffness, stroke * length, attitude[0].inverse() * p, attitude[1].inverse() * l).unwrap()
        }).collect();
        let separation = turned(Separation::new(payload, stage, &springs).unwrap());
        let Ok(outcome) = separation.run(&Settings::new(tolerance, 1e6).unwrap()) else { return Ok(()) };
        let momentum = outcome.payload().spin_angular_momentum().norm();
        let rounding = outcome.momentum_rounding();
        let before = payload.spin_angular_momentum().norm();
        let metrics = outcome.spin_metrics(&V::z_axis());
        let told = [metrics.nutation().is_some(), metrics.cone().is_some(), metrics.nutation_bounds().is_some(),
            outcome.momentum_error(&V::z_axis()).is_some()];
        if before == 0.0 {
            prop_assert!(momentum <= rounding, "{:e} above {:e}", momentum, rounding);
            prop_assert_eq!(told, [false; 4]);
            prop_assert_eq!((metrics.nutation_2(), metrics.nutation_3()), (None, None));
        } else {
            prop_assert_eq!(told, [momentum > rounding; 4]);
        }
        if away.is_some() {
            return Ok(());
        }
        // It hides nothing that the run knows: a turn that the springs give by their unequal arms is far above.
        let skew = Spring::new(stiffness, stroke * length, springs[0].payload_point_m() + attitude[0].inverse() * V::x() * length,
            springs[0].stage_point_m() + attitude[1].inverse() * V::x() * length).unwrap();
        let separation = turned(Separation::new(payload, stage, &[skew]).unwrap());
        let outcome = separation.run(&Settings::new(tolerance, 1e6).unwrap()).unwrap();
        prop_assert!(outcome.spin_metrics(&V::z_axis()).nutation().is_some());
        prop_assert!(outcome.payload().spin_angular_momentum().norm() > 1e6 * outcome.momentum_rounding() * (1e-13 / tolerance).min(1.0));
    }
}
