//! Clearance against brute force: dense sampling in time, distances found in another way; and what happens
//! where the bounds on the motion, on which the proofs stand, are too small.

use gyradius_clearance::{
    Approach, Clearance, ClearanceSettings, Coast, Motion, MotionLimits, RigidState,
};
use nalgebra::UnitQuaternion;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, RngSeed, TestRunner};

use crate::forms::{Form, V, at_rest, body, distance, form, vector};

/// Holds a clearance against samples of the motion: points are on the shapes and as far apart as said, and
/// no sample, nor what it leads down to, is nearer than the bound.
pub(crate) fn check<M: Motion>(
    forms: [&Form; 2],
    motion: &mut M,
    until: f64,
    samples: u32,
    settings: &ClearanceSettings,
    scale: f64,
) -> Result<(), TestCaseError> {
    let outlines = forms.map(Form::outline);
    let c = Clearance::new(&outlines[0], &outlines[1], motion, 0.0, until, settings).unwrap();
    let pair = &c.shapes()[0];
    let round = 1e-9 * scale;
    let start = distance(forms, &motion.states(0.0).unwrap());
    prop_assert!(pair.is_mated() || start > settings.touch_m() - round, "{start}");
    prop_assert!(!pair.is_mated() || start < settings.touch_m() + round + 1e-6 * scale, "{start}");
    let Some(from) = pair.counts_from_s() else {
        let last = distance(forms, &motion.states(until).unwrap());
        prop_assert!(last < settings.parted_m() + round, "{last}");
        return Ok(());
    };
    let closest = pair.closest().unwrap();
    let points = [closest.payload_point_m(), closest.stage_point_m()];
    for (form, point) in forms.iter().zip(&points) {
        prop_assert!(form.off(point) < 1e-7 * scale, "{}", form.off(point));
    }
    let [p, s] = motion.states(closest.time_s()).unwrap();
    let gap = p.position + p.attitude * points[0] - s.position - s.attitude * points[1];
    let end = c.contact_s().unwrap_or(until);
    let least = if c.contact_s().is_some() {
        // What rounding leaves of the distance of large rings counts as touching.
        let radius = |form: &&Form| if let Form::Ring(_, _, radius) = form { *radius } else { 0.0 };
        let largest = forms.iter().map(radius).fold(0.0, f64::max);
        let touch = settings.touch_m().max((4e-7 * largest).min(0.4 * settings.parted_m()));
        prop_assert!(gap.norm() <= 1.01 * touch);
        settings.touch_m()
    } else {
        prop_assert!((gap.norm() - closest.distance_m()).abs() < 1e-12 * scale);
        let short = closest.distance_m() - closest.at_least_m();
        prop_assert!(short < settings.tolerance_m() + 1e-12 * scale, "{short}");
        closest.at_least_m()
    };
    let mut at = |t: f64| distance(forms, &motion.states(t).unwrap());
    let step = (end - from) / f64::from(samples);
    let mut best = (f64::INFINITY, from);
    for i in 0..samples {
        let t = from + step * f64::from(i);
        let d = at(t);
        if d < best.0 {
            best = (d, t);
        }
    }
    // Down from the lowest sample, up to just before the contact.
    let mut width = step;
    while width > 1e-7 * step {
        for t in [best.1 - width, best.1 + width] {
            if t >= from && t < end - 1e-3 * step {
                let d = at(t);
                if d < best.0 {
                    best = (d, t);
                }
            }
        }
        width *= 0.6;
    }
    prop_assert!(best.0 >= least - round, "{} at {}, {closest:?}", best.0, best.1);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]
    /// Passing, tumbling fast or not at all, at rest; from micrometres to a hundred kilometres.
    #[test]
    fn clearance_agrees_with_brute_force(
        forms in (form(), form()),
        moments in prop::array::uniform2(prop::array::uniform3(2.0..3.9f64)),
        start in vector(3.0),
        aim in vector(1.5),
        rates in prop::array::uniform2(vector(1.0)),
        spin in prop_oneof![Just(0.0), 0.0..2.0f64, 2.0..20.0f64],
        passing in prop_oneof![4 => Just(1.0), 1 => Just(0.0)],
        duration in prop_oneof![Just(1e-6), 0.1..10.0f64],
        exponent in -5..=5i32,
    ) {
        let scale = 10.0_f64.powi(exponent);
        let forms = [forms.0.scaled(scale), forms.1.scaled(scale)];
        let velocity = (aim - start) * (scale * passing / (0.5 * duration));
        let bodies = [
            body(moments[0], start * scale, velocity, rates[0] * spin),
            body(moments[1], V::zeros(), V::zeros(), rates[1] * spin),
        ];
        let tolerance = (1e-9 * scale).clamp(1e-12, 1e-2);
        let settings = ClearanceSettings::new(tolerance, 1e2 * tolerance, 1e5 * tolerance).unwrap();
        let mut coast = Coast::new(&bodies[0], &bodies[1], 0.0);
        check([&forms[0], &forms[1]], &mut coast, duration, 150, &settings, scale)?;
    }
}

/// To and fro, and turning to and fro: every limit is attained.
#[derive(Clone, Debug)]
struct Swing {
    base: V,
    way: V,
    pace: f64,
    axes: [V; 2],
    turn: f64,
    turning: f64,
    /// Factors on the limits: speed, acceleration, angular speed, angular acceleration.
    factors: [f64; 4],
}

impl Motion for Swing {
    fn states(&mut self, t: f64) -> Option<[RigidState; 2]> {
        let (s, c) = (self.pace * t).sin_cos();
        let (a, b) = (self.turning * t).sin_cos();
        let angle = self.turn * a;
        let state = |position, velocity, axis: V| RigidState {
            position,
            velocity,
            attitude: UnitQuaternion::from_scaled_axis(axis * angle),
            angular_velocity: axis * (self.turn * self.turning * b),
        };
        let payload = state(self.base + self.way * s, self.way * (self.pace * c), self.axes[0]);
        Some([payload, state(V::zeros(), V::zeros(), self.axes[1])])
    }

    fn limits(&mut self, _: f64, _: f64) -> MotionLimits {
        let [a, b, c, d] = self.factors;
        let way = self.way.norm();
        MotionLimits {
            speed: a * way * self.pace,
            acceleration: b * way * self.pace * self.pace,
            angular_speed: [c * self.turn * self.turning; 2],
            angular_acceleration: [d * self.turn * self.turning * self.turning; 2],
        }
    }
}

fn swing() -> impl Strategy<Value = Swing> {
    let axis = || vector(1.0).prop_filter("axis", |a| a.norm() > 0.1).prop_map(|a| a.normalize());
    (vector(2.5), vector(2.0), 0.1..4.0f64, [axis(), axis()], 0.0..3.0f64, 0.1..3.0f64).prop_map(
        |(base, way, pace, axes, turn, turning)| Swing {
            base,
            way,
            pace,
            axes,
            turn,
            turning,
            factors: [1.0; 4],
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn motion_of_any_kind_agrees_with_brute_force(
        forms in (form(), form()),
        mut swing in swing(),
        duration in 1.0..12.0f64,
    ) {
        let settings = ClearanceSettings::default();
        check([&forms.0, &forms.1], &mut swing, duration, 200, &settings, 1.0)?;
    }
}

/// The proofs stand on the limits: with true ones no dip is missed, and with a tenth of
/// any of them some are.
#[test]
fn limits_that_are_too_small_are_found_out() {
    let config = Config {
        rng_algorithm: RngAlgorithm::ChaCha,
        rng_seed: RngSeed::Fixed(2003),
        ..Config::default()
    };
    let mut runner = TestRunner::new(config);
    let settings = ClearanceSettings::default();
    // Motion in which one limit counts most, for less than a period: (to and fro, pace), (turn, turning).
    let kinds = [
        ("speed", [4.0, 0.3], [0.0, 1.0], 9.0),
        ("acceleration", [2.0, 4.0], [0.0, 1.0], 1.5),
        ("angular speed", [0.0, 1.0], [60.0, 0.1], 1.0),
        ("angular acceleration", [0.0, 1.0], [0.25, 8.0], 0.75),
    ];
    for (k, (name, [way, pace], [turn, turning], until)) in kinds.into_iter().enumerate() {
        let (mut missed, mut count) = (0, 0);
        for _ in 0..400 {
            let mut draw = |range: f64| vector(range).new_tree(&mut runner).unwrap().current();
            let (a, base) = (draw(2.0), draw(2.0));
            // Near each other in the middle of the swing.
            let b = base + a + draw(0.3);
            let mut swing = Swing {
                base,
                way: draw(1.0).normalize() * way,
                pace,
                axes: [draw(1.0).normalize(), draw(1.0).normalize()],
                turn,
                turning,
                factors: [1.0; 4],
            };
            let (a, b) = (Form::Points(vec![a]).outline(), Form::Points(vec![b]).outline());
            let mut run = |factors: [f64; 4]| {
                swing.factors = factors;
                let c = Clearance::new(&a, &b, &mut swing, 0.0, until, &settings).unwrap();
                let mated = c.shapes()[0].is_mated();
                c.closest().map(Approach::distance_m).filter(|_| !mated)
            };
            let Some(exact) = run([1.0; 4]) else { continue };
            // Limits above the true ones cost time alone.
            let wide = run([1.7; 4]).unwrap();
            assert!((wide - exact).abs() < 2e-9, "{name}: {wide} {exact}");
            let mut factors = [1.0; 4];
            factors[k] = 0.1;
            missed += u32::from(run(factors).unwrap() > exact + 1e-6);
            count += 1;
        }
        assert!(count > 300 && missed > 5, "{name}: {missed} of {count} dips missed");
    }
}

#[test]
fn bodies_that_do_not_move_keep_their_distance() {
    let ring = Form::Ring(V::new(0.1, 0.2, 1.9), V::new(0.2, 0.1, 1.0), 0.6);
    let hull = Form::Hull(vec![V::x(), -V::x(), V::y(), V::new(0.2, -1.0, 0.4), V::z()]);
    let post = Form::Points(vec![V::new(0.3, 0.4, 2.5), V::new(2.0, 0.0, 1.0)]);
    for (a, b) in [(&ring, &hull), (&hull, &ring), (&ring, &ring), (&post, &hull), (&post, &ring)] {
        let still = body([1.0, 2.0, 2.5], V::new(0.3, 0.1, 3.5), V::zeros(), V::zeros());
        let mut coast = Coast::new(&still, &at_rest(), 0.0);
        let exact = distance([a, b], &coast.states(0.0).unwrap());
        for horizon in [0.0, 1e-300, 1e-12, 60.0, 1e6, 1e15] {
            let settings = ClearanceSettings::default();
            let (a, b) = (a.outline(), b.outline());
            let c = Clearance::new(&a, &b, &mut coast, 0.0, horizon, &settings).unwrap();
            let closest = c.closest().unwrap();
            assert!(
                (closest.distance_m() - exact).abs() < 1e-9,
                "{} {exact}",
                closest.distance_m()
            );
            assert!(closest.distance_m() - closest.at_least_m() < 1.01e-9, "{closest:?}");
            assert!(c.looks() < 500, "{}", c.looks());
        }
    }
}

/// A long coast of a body that tumbles fast: the dip is between two of 20,000 samples, and found.
#[test]
fn a_long_fast_tumble() {
    let arm = Form::Points(vec![V::new(2.0, 0.0, 0.3)]);
    let plate = Form::Hull(vec![
        V::new(2.5, -1.0, -1.0),
        V::new(2.5, 1.0, -1.0),
        V::new(2.5, 0.0, 1.0),
        V::new(3.0, 0.0, 0.0),
    ]);
    let tumbling = body([2.0, 3.0, 3.9], V::zeros(), V::new(1e-4, 0.0, 0.0), V::new(0.3, 9.0, 0.1));
    let mut coast = Coast::new(&tumbling, &at_rest(), 0.0);
    let settings = ClearanceSettings::default();
    check([&arm, &plate], &mut coast, 600.0, 20_000, &settings, 1.0).unwrap();
}

/// A ring threaded through another, with room all round, until it is pulled against it.
#[test]
fn a_linked_ring_strikes_from_inside() {
    let ring = |axis: V| Form::Ring(V::zeros(), axis, 1.0);
    let moving = body([1.0; 3], V::x(), V::x() * 0.125, V::zeros());
    let mut coast = Coast::new(&moving, &at_rest(), 0.0);
    let (a, b) = (ring(V::y()).outline(), ring(V::z()).outline());
    let settings = ClearanceSettings::default();
    let c = Clearance::new(&a, &b, &mut coast, 0.0, 60.0, &settings).unwrap();
    assert!(!c.shapes()[0].is_mated());
    assert!((c.contact_s().unwrap() - 8.0).abs() < 1e-5, "{:?}", c.contact_s());
    let c = Clearance::new(&a, &b, &mut coast, 0.0, 6.0, &settings).unwrap();
    assert!((c.closest().unwrap().distance_m() - 0.25).abs() < 1e-9);
}

/// A hull that stands on a deck, lifts off, and as it tips strikes with its far tip: one pair of shapes,
/// mated, parted, and touching again.
#[test]
fn a_hull_lifts_off_and_strikes_again() {
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
    let mut hull: Vec<V> = corners.iter().map(|[x, y]| V::new(*x, *y, -1.0)).collect();
    hull.extend(corners.iter().map(|[x, y]| V::new(*x, *y, 1.0)));
    hull.push(V::new(5.0, 0.0, -0.5));
    let deck = corners.map(|[x, y]| V::new(50.0 * x, 50.0 * y, -1.0));
    let (speed, rate) = (0.3, 0.1);
    let moving = body([1.0; 3], V::zeros(), V::z() * speed, V::y() * rate);
    let height = |t: f64| {
        let (s, c) = (rate * t).sin_cos();
        let low = hull.iter().map(|p| p.z * c - p.x * s).fold(f64::INFINITY, f64::min);
        low + speed * t + 1.0
    };
    let root = |mut low: f64, mut high: f64, level: f64| {
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if (height(middle) > level) == (height(low) > level) {
                low = middle
            } else {
                high = middle
            }
        }
        low
    };
    let settings = ClearanceSettings::default();
    let (hull, deck) = (Form::Hull(hull.clone()).outline(), Form::Hull(deck.to_vec()).outline());
    let mut coast = Coast::new(&moving, &at_rest(), 0.0);
    let c = Clearance::new(&hull, &deck, &mut coast, 0.0, 60.0, &settings).unwrap();
    let pair = &c.shapes()[0];
    assert!(pair.is_mated());
    let parted = root(0.0, 1.0, settings.parted_m());
    assert!((pair.counts_from_s().unwrap() - parted).abs() < 1e-5);
    let strikes = root(1.0, 5.0, settings.touch_m());
    assert!((c.contact_s().unwrap() - strikes).abs() < 1e-6, "{:?} {strikes}", c.contact_s());
}

/// Outlines that hold each other at the start are followed until they part, without a step for every hair.
#[test]
fn deep_overlap_takes_few_looks() {
    let cube = |half: f64| {
        let sign = |i: i32, bit: i32| if i >> bit & 1 == 0 { -half } else { half };
        Form::Hull((0..8).map(|i| V::new(sign(i, 0), sign(i, 1), sign(i, 2))).collect())
    };
    let moving =
        body([1.0, 2.0, 2.5], V::new(0.1, 0.2, 0.0), V::z() * 0.4, V::new(0.02, 0.01, 0.1));
    let mut coast = Coast::new(&moving, &at_rest(), 0.0);
    let (a, b) = (cube(1.0).outline(), cube(0.9).outline());
    let c = Clearance::new(&a, &b, &mut coast, 0.0, 60.0, &ClearanceSettings::default()).unwrap();
    let pair = &c.shapes()[0];
    assert!(pair.is_mated() && c.contact_s().is_none());
    let parted = pair.counts_from_s().unwrap();
    let before = distance([&cube(1.0), &cube(0.9)], &coast.states(parted - 1e-3).unwrap());
    let after = distance([&cube(1.0), &cube(0.9)], &coast.states(parted).unwrap());
    assert!(before < 1e-3 && (after - 1e-3).abs() < 1e-6, "{before} {after}");
    assert!(c.looks() < 600, "{}", c.looks());
}
