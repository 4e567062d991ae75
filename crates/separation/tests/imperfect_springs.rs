//! Springs with friction, late ones and those that fail, against closed forms and conservation laws.

use crate::common::{differences, inertia, moved, paper, relative, skewed};
use gyradius_separation::{Body, BodyState, RunError, Separation, Settings, Spring};
use nalgebra::Vector3;
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;

const MASSES: [f64; 2] = [7.0, 3.0];
const REDUCED: f64 = 2.1;

/// Springs on one line, between bodies that part at a given speed from the start.
fn coaxial(springs: &[Spring], speed: f64) -> Separation {
    let sphere = inertia([10.0, 12.0, 15.0], [1.0, 0.0, -0.5]);
    let body = |mass: f64, z: f64, v: f64| {
        let velocity = Vector3::z() * v;
        let state = BodyState { position: Vector3::z() * z, velocity, ..BodyState::default() };
        Body::new(mass, sphere).unwrap().moving(state)
    };
    let [a, b] = MASSES;
    let (up, down) = (speed * b / (a + b), -speed * a / (a + b));
    Separation::new(body(a, 1.0, up), body(b, -1.0, down), springs).unwrap()
}

fn spring(stiffness: f64, stroke: f64) -> Spring {
    Spring::new(stiffness, stroke, Vector3::z() * -0.6, Vector3::z() * 0.6).unwrap()
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "{found} for {expected}");
}

/// A constant friction f leaves an oscillator about the compression f/k: v = (δ − f/k)√(k/μ), after a
/// quarter of its period. What is lost is f times the way, and what stays in the spring.
#[test]
fn friction_shifts_the_end_of_the_stroke() {
    let (k, stroke) = (150.0, 0.2);
    for friction in [0.0, 1.0, 12.0, 29.0] {
        let spring = spring(k, stroke).with_friction(friction).unwrap();
        let separation = coaxial(&[spring], 0.0);
        let outcome = separation.run(&Settings::default()).unwrap();
        let travel = stroke - friction / k;
        near(outcome.relative_speed(), travel * (k / REDUCED).sqrt(), 1e-12);
        near(outcome.release_time(), FRAC_PI_2 * (REDUCED / k).sqrt(), 1e-12);
        let kinetic = 0.5 * REDUCED * outcome.relative_speed().powi(2);
        let lost = friction * travel + 0.5 * friction * friction / k;
        near(kinetic + lost, separation.stored_energy(), 1e-12);
        // On the way: the force is k x − f.
        let time = 0.2 * (REDUCED / k).sqrt();
        let trajectory = separation.trajectory(&Settings::default(), 0.0).unwrap();
        let found = trajectory.at(time).unwrap().loads()[0].force_n().z;
        near(found, k * (friction / k + travel * 0.2_f64.cos()) - friction, 1e-12);
    }
}

/// Two springs, the second late: one oscillator after another.
#[test]
fn a_late_spring_takes_up_what_stroke_is_left() {
    let (k1, k2, stroke) = (150.0, 90.0, 0.2);
    let (w1, w2) = ((k1 / REDUCED).sqrt(), ((k1 + k2) / REDUCED).sqrt());
    for phase in [1e-6, 0.3, 1.0, 1.5] {
        let start = phase / w1;
        let springs = [spring(k1, stroke), spring(k2, stroke).starting_at(start).unwrap()];
        let separation = coaxial(&springs, 0.0);
        let trajectory = separation.trajectory(&Settings::default(), 0.0).unwrap();
        let (x, v) = (stroke * phase.cos(), stroke * w1 * phase.sin());
        let outcome = trajectory.outcome();
        near(outcome.relative_speed(), x.hypot(v / w2) * w2, 1e-12);
        for time in outcome.release_times().flatten() {
            near(time, start + x.atan2(v / w2) / w2, 1e-12);
        }
        // No force up to the start, to the bit, and all of it from there.
        let forces = |time: f64| trajectory.at(time).unwrap().loads()[1];
        assert!(!forces(start * (1.0 - 1e-15)).is_pushing());
        assert_eq!(forces(0.5 * start).force_n(), Vector3::zeros());
        near(forces(start).force_n().z, k2 * x, 1e-12);
    }
}

/// A late spring alone: nothing moves before it starts, or all drifts.
#[test]
fn a_late_spring_alone_waits() {
    let (k, stroke, start) = (150.0, 0.2, 3.0);
    let late = spring(k, stroke).starting_at(start).unwrap();
    let w = (k / REDUCED).sqrt();
    let outcome = coaxial(&[late], 0.0).run(&Settings::default()).unwrap();
    near(outcome.relative_speed(), stroke * w, 1e-12);
    near(outcome.release_time(), start + FRAC_PI_2 / w, 1e-12);

    let (speed, left) = (0.05, stroke - 0.05 * start);
    let outcome = coaxial(&[late], speed).run(&Settings::default()).unwrap();
    near(outcome.relative_speed(), speed.hypot(left * w), 1e-12);
    near(outcome.release_time(), start + left.atan2(speed / w) / w, 1e-12);
    // Too late: the points are a release length apart after 2 s. It never lets go, for it never pushed.
    let outcome = coaxial(&[late], 0.1).run(&Settings::default()).unwrap();
    assert_eq!(outcome.release_times().collect::<Vec<_>>(), [None]);
    assert!(outcome.release_order().is_empty());
    near(outcome.relative_speed(), 0.1, 1e-14);
    near(outcome.release_time(), 2.0, 1e-12);
    // Beyond the horizon.
    for horizon in [0.5 * start, start, start.next_up(), start + 0.1 / w] {
        let settings = Settings::new(1e-13, horizon).unwrap();
        let error = coaxial(&[late], 0.0).run(&settings).unwrap_err();
        let RunError::NotReleased { start: waits, .. } = error else { panic!("{error}") };
        assert_eq!(waits, (start >= horizon).then_some(start));
        let told = format!("spring 1 starts at {start:?} s only, is ");
        assert_eq!(error.to_string().contains(&told), start >= horizon, "{error}");
    }
    // Points that come together while nothing pushes do not matter; later they do.
    let through = |start| {
        let late = spring(k, stroke).starting_at(start).unwrap();
        coaxial(&[late], -1.0).run(&Settings::default())
    };
    assert!(
        matches!(through(0.8), Err(RunError::PadsMeet { load, .. }) if load.number == 0),
        "{:?}",
        through(0.8)
    );
    assert!(through(0.9).is_ok(), "{:?}", through(0.9));
    // The motion is shown up to there: by the late spring alone, and beside one that pushes and loses its direction too.
    let late = spring(k, stroke).starting_at(0.8).unwrap();
    for springs in [&[late][..], &[late, spring(1e-9, 3.0)]] {
        let mut ends = vec![];
        let error = coaxial(springs, -1.0)
            .follow(&Settings::default(), 0.0, |step| ends.push(step.end_s()));
        let Err(RunError::PadsMeet { time, speed, .. }) = error else { panic!("{error:?}") };
        assert!((time - 0.8).abs() < 1e-5 && (speed - 1.0).abs() < 1e-5, "{time} {speed}");
        assert!((ends.last().unwrap() - time).abs() < 1e-15, "{ends:?}");
    }
}

proptest! {
    /// Bodies that fly at each other are slowed down by the spring between them, and meet with what speed the work of the spring
    /// has left them: v² = v₀² − (k/μ)((x + D)² − x²), with the travel x and the distance D of the points at the start. The
    /// speed does not depend on how the bodies turn about the line.
    #[test]
    fn points_meet_as_fast_as_the_spring_has_let_them(
        sizes in prop::array::uniform3(-2.0..3.0f64),
        shares in prop::array::uniform2(0.05..1.0f64),
        rubs in prop_oneof![Just(0.0), 0.0..0.9f64],
        spin in prop::array::uniform2(-3.0..3.0f64),
        left in 0.01..10.0f64,
        masses in prop::array::uniform2(1.0..1e3f64),
    ) {
        let [k, length, _] = sizes.map(|size| 10.0_f64.powf(size));
        let (stroke, distance) = (shares[0] * length, shares[1] * length);
        let point = |z: f64| Vector3::z() * z;
        let spring = Spring::new(k, stroke, point(-0.5 * length), point(0.5 * length)).unwrap();
        let spring = spring.with_friction(rubs * k * stroke).unwrap();
        let reduced = masses[0] * masses[1] / (masses[0] + masses[1]);
        let travel = stroke * (1.0 - rubs);
        let slowed = k / reduced * ((travel + distance).powi(2) - travel * travel);
        let (closing, expected) = (((1.0 + left) * slowed).sqrt(), (left * slowed).sqrt());
        let inertia = |mass: f64| inertia([mass * length * length; 3], [0.0; 3]);
        let moving = |mass: f64, z: f64, speed: f64, spin: f64| {
            Body::new(mass, inertia(mass)).unwrap().moving(BodyState {
                position: Vector3::z() * z,
                velocity: Vector3::z() * speed,
                angular_velocity: Vector3::z() * (spin * closing / distance),
                ..BodyState::default()
            })
        };
        let separation = Separation::new(
            moving(masses[0], length + distance, -closing, spin[0]),
            moving(masses[1], 0.0, 0.0, spin[1]),
            &[spring],
        ).unwrap();
        let settings = Settings::new(1e-13, 1e9).unwrap();
        let error = separation.run(&settings).unwrap_err();
        let RunError::PadsMeet { time, speed, .. } = error else { panic!("{error}") };
        prop_assert!((speed / expected - 1.0).abs() < 1e-4, "{speed} {expected}");
        let digits = error.to_string();
        let told = digits.split("closing at ").nth(1).unwrap().split(' ').next().unwrap();
        prop_assert!((told.parse::<f64>().unwrap() / expected - 1.0).abs() < 6e-3, "{digits}");
        prop_assert!(told.chars().filter(char::is_ascii_digit).count() < 8, "{digits}");

        // The motion is shown up to there.
        let mut steps = vec![];
        let followed = separation.follow(&settings, 1.0, |step| steps.push(step.clone()));
        prop_assert_eq!(followed.unwrap_err(), error);
        prop_assert!(steps.windows(2).all(|pair| pair[0].end_s() == pair[1].start_s()));
        let last = steps.last().unwrap();
        prop_assert!(steps[0].start_s() == 0.0 && (last.end_s() / time - 1.0).abs() < 1e-15);
        let apart = last.at(time).loads()[0].length_m();
        prop_assert!(apart < 1e-4 * distance, "{apart} of {distance}");
        prop_assert!(last.released().is_empty());
    }
}

/// A spring that fails, or is stuck, or comes too late, is as good as none.
#[test]
fn a_spring_that_never_pushes_is_none() {
    let nominal = skewed();
    let all: Vec<_> = nominal.springs().copied().collect();
    let with = |springs: &[Spring]| moved(&nominal, |s| s, springs);
    let without = with(&all[..2]).run(&Settings::default()).unwrap();
    let stuck = all[2].with_friction(1.01 * 2.5e3 * 0.15).unwrap();
    for (failed, at_once) in
        [(all[2].never_pushing(), true), (stuck, true), (all[2].starting_at(1.0).unwrap(), false)]
    {
        let outcome = with(&[failed, all[0], all[1]]).run(&Settings::default()).unwrap();
        let times: Vec<_> = outcome.release_times().collect();
        for (a, b) in times[1..].iter().zip(without.release_times()) {
            assert!((a.unwrap() - b.unwrap()).abs() < 1e-12, "{times:?}");
        }
        assert_eq!(times[0], None);
        assert_eq!(outcome.release_order(), [[1], [2]]);
        let payload = outcome.payload().state().angular_velocity;
        if at_once {
            assert!(relative(&payload, &without.payload().state().angular_velocity) < 1e-11);
        }
        let (a, b) = (outcome.relative_velocity(), without.relative_velocity());
        assert!(relative(&a, &b) < 1e-11);
    }
    // And one that could push does: this test can fail.
    let outcome = with(&[all[2], all[0], all[1]]).run(&Settings::default()).unwrap();
    assert!(relative(&outcome.relative_velocity(), &without.relative_velocity()) > 0.01);
}

fn imperfect(starts: [f64; 4], frictions: [f64; 4]) -> Separation {
    let nominal = paper();
    let springs: Vec<_> = nominal
        .springs()
        .zip(starts.into_iter().zip(frictions))
        .map(|(s, (start, f))| s.starting_at(start).unwrap().with_friction(f).unwrap())
        .collect();
    moved(&nominal, |s| s, &springs)
}

/// Momentum stays at every moment; energy too, but for what a spring has at its start.
#[test]
fn what_is_conserved_stays() {
    let starts = [0.0, 0.03, 0.05, 0.04];
    let separation = imperfect(starts, [100.0, 0.0, 50.0, 400.0]);
    let trajectory = separation.trajectory(&Settings::default(), 0.5).unwrap();
    let start = trajectory.at(0.0).unwrap();
    let scale = trajectory.outcome().payload().momentum().norm();
    for i in 1..=500 {
        let now = trajectory.at(trajectory.end_s() * f64::from(i) / 500.0).unwrap();
        let (linear, angular) = (now.momentum(), now.angular_momentum());
        assert!((linear - start.momentum()).norm() < 1e-12 * scale);
        assert!((angular - start.angular_momentum()).norm() < 1e-12 * scale);
        let mut energy = start.energy_j();
        for (i, late) in starts.iter().enumerate().filter(|(_, s)| **s > 0.0 && **s <= now.time_s())
        {
            energy += trajectory.at(*late).unwrap().loads()[i].energy_j();
        }
        near(now.energy_j(), energy, 1e-12);
    }
    for (i, late) in starts.iter().enumerate() {
        let step = trajectory.steps().iter().find(|s| s.start_s() == *late);
        assert!(step.is_some(), "no step starts where spring {} does", i + 1);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// As near to the tightest tolerance as with springs that start at once.
    #[test]
    fn accuracy_is_what_it_was(
        starts in prop::array::uniform4(0.0..0.3f64),
        frictions in prop::array::uniform4(0.0..2e3f64),
    ) {
        let separation = imperfect(starts, frictions);
        let tight = separation.run(&Settings::new(1e-14, 60.0).unwrap()).unwrap();
        let (outcome, times) = differences(&separation.run(&Settings::default()).unwrap(), &tight);
        prop_assert!(outcome < 1e-9 && times < 1e-11, "{:e} {:e}", outcome, times);
    }
}
