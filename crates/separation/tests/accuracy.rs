//! What the default settings promise, symmetries of the problem, and what becomes of bad ones.

use crate::common::{differences, inertia, log_fit, moved, paper, relative, skewed};
use gyradius_separation::{
    Batch, Body, BodyState, Load, LoadId, MovingBody, Outcome, RunError, Separation, Settings,
    Spring, SpringParameter, Stack,
};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

fn run(separation: &Separation) -> Outcome {
    separation.run(&Settings::default()).unwrap()
}

fn with_tolerance(separation: &Separation, tolerance: f64) -> Outcome {
    separation.run(&Settings::new(tolerance, 60.0).unwrap()).unwrap()
}

#[test]
fn the_default_is_as_good_as_the_tightest() {
    for separation in [paper(), skewed()] {
        let (values, times) = differences(&run(&separation), &with_tolerance(&separation, 1e-14));
        assert!(values < 1e-11 && times < 1e-12, "{values:e} {times:e} s");
    }
}

/// The error is the tolerance's, over eight decades of it.
#[test]
fn errors_fall_with_the_tolerance() {
    for separation in [paper(), skewed()] {
        let exact = with_tolerance(&separation, 1e-14);
        let errors: Vec<_> = (5..=13)
            .map(|i| {
                let tolerance = 10.0_f64.powi(-i);
                let error = differences(&with_tolerance(&separation, tolerance), &exact).0;
                assert!(error < 100.0 * tolerance, "{tolerance:e}: {error:e}");
                (tolerance, error)
            })
            .collect();
        let (slope, correlation) = log_fit(&errors);
        assert!((0.85..1.15).contains(&slope) && correlation > 0.98, "{slope} {errors:?}");
    }
}

/// The number of times that the equations of motion are expanded. A change is one of the speed.
#[test]
fn steps_are_pinned() {
    for (separation, tolerance, steps) in
        [(paper(), 1e-13, 9), (paper(), 1e-14, 10), (paper(), 1e-6, 5), (skewed(), 1e-13, 6)]
    {
        assert_eq!(with_tolerance(&separation, tolerance).steps(), steps, "{tolerance:e}");
        let settings = Settings::new(tolerance, 60.0).unwrap();
        let mut shown = 0;
        separation.follow(&settings, 0.0, |_| shown += 1).unwrap();
        assert_eq!(shown, steps);
    }
}

/// Up to eight springs.
#[test]
fn runs_and_batches_do_not_allocate() {
    let settings = Settings::default();
    let inner = paper();
    let inner = inner.springs().map(|s| {
        let (p, l) = (s.payload_point_m(), s.stage_point_m());
        let halved = |v: Vector3<f64>| Vector3::new(0.5 * v.x, 0.5 * v.y, v.z);
        Spring::new(s.stiffness_n_per_m(), s.stroke_m(), halved(p), halved(l)).unwrap()
    });
    let springs: Vec<_> = paper().springs().copied().chain(inner).collect();
    for separation in [paper(), moved(&paper(), |s| s, &springs)] {
        let mut batch = Batch::new(settings);
        // Room for the springs, and what the machine can do.
        batch.run([&separation], |_, result| assert!(result.is_ok()));
        let counted = allocation_counter::measure(|| {
            assert!(separation.run(&settings).is_ok());
            let inertias =
                (*separation.payload().body().inertia(), *separation.stage().body().inertia());
            let again = separation.with_inertias(inertias.0, inertias.1).unwrap();
            batch.run(std::iter::repeat_n(&again, 10), |_, result| assert!(result.is_ok()));
        });
        assert_eq!(counted.count_total, 0, "{} springs", separation.springs().len());
    }
}

/// The paper's springs 1 and 2 let go 134 µs apart; at equal times equal springs go together.
#[test]
fn releases_that_are_near_are_told_apart() {
    let order = |separation: &Separation| {
        let trajectory = separation.trajectory(&Settings::default(), 0.0).unwrap();
        let released = trajectory.steps().iter().map(|step| step.released().to_vec());
        released.filter(|springs| !springs.is_empty()).collect::<Vec<_>>()
    };
    assert_eq!(order(&paper()), [[0], [1], [2], [3]]);
    let times: Vec<_> = run(&paper()).release_times().flatten().collect();
    assert!((times[1] - times[0] - 1.336_825_e-4).abs() < 1e-9, "{times:?}");

    // Springs that differ by less and less let go in their order, nearer and nearer in time.
    let mut last = f64::INFINITY;
    for exponent in 2..=11 {
        let difference = 10.0_f64.powi(-exponent);
        let spring = |stroke: f64, x: f64| {
            Spring::new(1e4, stroke, Vector3::new(x, 0.0, -0.5), Vector3::new(x, 0.0, 0.5)).unwrap()
        };
        let body = Body::new(50.0, inertia([20.0, 25.0, 30.0], [0.0; 3])).unwrap();
        let springs = [spring(0.1, 0.4), spring(0.1 * (1.0 - difference), -0.4)];
        let separation =
            Separation::new(body.at(Vector3::z()), body.at(-Vector3::z()), &springs).unwrap();
        assert_eq!(order(&separation), [[1], [0]], "{difference:e}");
        let times: Vec<_> = run(&separation).release_times().flatten().collect();
        assert!(times[0] > times[1] && times[0] - times[1] < 0.2 * last, "{difference:e}");
        last = times[0] - times[1];
    }
    let spring = |x: f64| {
        Spring::new(1e4, 0.1, Vector3::new(x, 0.0, -0.5), Vector3::new(x, 0.0, 0.5)).unwrap()
    };
    let body = Body::new(50.0, inertia([20.0, 25.0, 30.0], [0.0; 3])).unwrap();
    let bodies = (body.at(Vector3::z()), body.at(-Vector3::z()));
    let both = Separation::new(bodies.0, bodies.1, &[spring(0.4), spring(-0.4)]).unwrap();
    assert_eq!(order(&both), [[0, 1]]);
}

/// A weak spring with a short stroke lets go, and the bodies, which a strong one tips, press it
/// together again: it stays lost, and the outcome says so.
#[test]
fn a_spring_that_is_pressed_again_stays_lost() {
    let spring = |k: f64, stroke: f64, x: f64| {
        Spring::new(k, stroke, Vector3::new(x, 0.0, -0.1), Vector3::new(x, 0.0, 0.1)).unwrap()
    };
    let light = Body::new(10.0, inertia([0.1; 3], [0.0; 3])).unwrap();
    let heavy = Body::new(1e4, inertia([1e4; 3], [0.0; 3])).unwrap();
    // The payload comes up at first, and the strong spring at +x then turns its −x side down.
    let start = BodyState {
        position: Vector3::z() * 0.3,
        velocity: Vector3::z() * 3.0,
        ..BodyState::default()
    };
    let springs = [spring(1e3, 0.15, 0.5), spring(1.0, 0.001, -0.5)];
    let separation =
        Separation::new(light.moving(start), heavy.at(Vector3::zeros()), &springs).unwrap();
    let trajectory = separation.trajectory(&Settings::default(), 0.0).unwrap();
    let outcome = trajectory.outcome();
    let released: Vec<_> = outcome.release_times().flatten().collect();
    let [(number, time)] = outcome.recompressed().collect::<Vec<_>>()[..] else {
        panic!("{outcome:?}");
    };
    assert!(number == 1 && released[1] < time && time < released[0], "{released:?} {time}");
    let at = |time: f64| trajectory.at(time).unwrap().loads()[1];
    assert!(at(time - 1e-6).compression_m() < 0.0 && at(time + 1e-6).compression_m() > 0.0);
    let later = at(0.5 * (time + released[0]));
    assert!(!later.is_pushing() && later.force_n() == Vector3::zeros());
    assert_eq!(outcome, &run(&separation));
    assert_eq!(run(&paper()).recompressed().count(), 0);
}

proptest! {
    /// Steps tell which springs are pressed again, also those of a run that a horizon cuts short: as far as it goes, they are those
    /// that the outcome of the whole run names. In a coast, where nothing pushes any more, they tell of none.
    #[test]
    fn steps_tell_which_springs_are_pressed_again(
        speed in 1.0..5.0f64,
        arms in prop::array::uniform3(0.3..0.7f64),
        strokes in prop::array::uniform2(-4.0..-2.0f64),
        cut in 0.05..1.0f64,
    ) {
        let spring = |k: f64, stroke: f64, x: f64, y: f64| {
            Spring::new(k, stroke, Vector3::new(x, y, -0.1), Vector3::new(x, y, 0.1)).unwrap()
        };
        let light = Body::new(10.0, inertia([0.1; 3], [0.0; 3])).unwrap();
        let heavy = Body::new(1e4, inertia([1e4; 3], [0.0; 3])).unwrap();
        let start = BodyState {
            position: Vector3::z() * 0.3,
            velocity: Vector3::z() * speed,
            ..BodyState::default()
        };
        let [a, b] = strokes.map(|size| 10.0_f64.powf(size));
        let springs =
            [spring(1e3, 0.15, arms[0], 0.0), spring(1.0, a, -arms[1], 0.1), spring(1.0, b, -arms[2], -0.1)];
        let separation =
            Separation::new(light.moving(start), heavy.at(Vector3::zeros()), &springs).unwrap();
        let pressed = |settings: &Settings, coast: f64| {
            let mut all = vec![];
            let followed = separation.follow(settings, coast, |step| {
                let times = step.pressed_again().iter().map(|(_, time)| *time);
                assert!(times.clone().all(|time| step.start_s() <= time && time <= step.end_s()));
                all.extend_from_slice(step.pressed_again());
            });
            all.sort_by_key(|(spring, _)| *spring);
            (followed, all)
        };
        let (whole, all) = pressed(&Settings::default(), 5.0);
        let whole = whole.unwrap();
        prop_assert_eq!(&all, &whole.recompressed().collect::<Vec<_>>());
        let horizon = cut * whole.release_time();
        let (failed, seen) = pressed(&Settings::new(1e-13, horizon).unwrap(), 5.0);
        prop_assert!(matches!(failed, Err(RunError::NotReleased { .. })), "{failed:?}");
        let all: Vec<_> = all.into_iter().filter(|(_, time)| *time < horizon).collect();
        prop_assert_eq!(seen.len(), all.len());
        for (a, b) in seen.iter().zip(&all) {
            prop_assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-9, "{a:?} {b:?}");
        }
    }
}

/// Back from the middle of the motion to its start.
#[test]
fn time_can_be_reversed() {
    for separation in [paper(), skewed()] {
        let there = separation.trajectory(&Settings::default(), 0.0).unwrap();
        let half = 0.7 * there.outcome().release_times().flatten().fold(f64::INFINITY, f64::min);
        let middle = there.at(half).unwrap();
        let springs: Vec<_> = separation
            .springs()
            .zip(middle.loads())
            .map(|(s, now)| {
                let (p, l) = (s.payload_point_m(), s.stage_point_m());
                Spring::new(s.stiffness_n_per_m(), now.compression_m(), p, l).unwrap()
            })
            .collect();
        let reversed = |body: &MovingBody| {
            let mut state = *body.state();
            state.velocity = -state.velocity;
            state.angular_velocity = -state.angular_velocity;
            body.body().moving(state)
        };
        let (payload, stage) = (reversed(middle.payload()), reversed(middle.stage()));
        let back = Separation::new(payload, stage, &springs).unwrap();
        let back = back.trajectory(&Settings::default(), 0.0).unwrap().at(half).unwrap();
        for (found, start) in
            [(back.payload(), separation.payload()), (back.stage(), separation.stage())]
        {
            let (a, b) = (found.state(), start.state());
            assert!((a.position - b.position).norm() < 1e-12);
            assert!((a.velocity + b.velocity).norm() < 1e-12);
            assert!(a.attitude.angle_to(&b.attitude) < 1e-12);
            assert!((a.angular_velocity + b.angular_velocity).norm() < 1e-12);
        }
    }
}

#[test]
fn a_turned_and_a_moving_world_change_nothing() {
    let turn = UnitQuaternion::new(Vector3::new(0.4, -1.1, 2.0));
    let (shift, boost) = (Vector3::new(10.0, -20.0, 5.0), Vector3::new(7.0, 3.0, -4.0));
    for separation in [paper(), skewed()] {
        let plain = run(&separation);
        let turned = moved(
            &separation,
            |s| BodyState {
                position: turn * s.position,
                velocity: turn * s.velocity,
                attitude: turn * s.attitude,
                ..s
            },
            &separation.springs().copied().collect::<Vec<_>>(),
        );
        let boosted = moved(
            &separation,
            |s| BodyState { position: s.position + shift, velocity: s.velocity + boost, ..s },
            &separation.springs().copied().collect::<Vec<_>>(),
        );
        let (turned, boosted) = (run(&turned), run(&boosted));
        for (a, b) in turned.release_times().flatten().zip(plain.release_times().flatten()) {
            assert!((a - b).abs() < 1e-12);
        }
        let bodies = |o: &Outcome| [*o.payload().state(), *o.stage().state()];
        for (a, b) in bodies(&turned).iter().zip(bodies(&plain)) {
            assert!(relative(&a.angular_velocity, &b.angular_velocity) < 1e-11);
            assert!(relative(&a.velocity, &(turn * b.velocity)) < 1e-11);
            assert!(a.attitude.angle_to(&(turn * b.attitude)) < 1e-11);
        }
        let time = plain.release_time();
        for (a, b) in bodies(&boosted).iter().zip(bodies(&plain)) {
            assert!(relative(&a.angular_velocity, &b.angular_velocity) < 1e-11);
            assert!((a.velocity - b.velocity - boost).norm() < 1e-11);
            assert!((a.position - b.position - shift - boost * time).norm() < 1e-11);
        }
    }
}

proptest! {
    /// Lines of action that are as near to one axis of the stage as to another tilt in the same way however the world is turned.
    #[test]
    fn a_turned_world_tilts_no_line_otherwise(
        components in prop_oneof![Just([1.0, 0.0, 1.0]), Just([1.0, 1.0, 0.0]), Just([0.0, 1.0, 1.0]), Just([1.0; 3]),
            Just([1.0, 0.5, 1.0]), Just([0.0, 0.0, 1.0])],
        signs in prop::array::uniform3(prop_oneof![Just(1.0), Just(-1.0)]),
        stage_turn in prop::array::uniform3(-2.0..2.0f64),
        turn in prop::array::uniform3(-2.0..2.0f64),
        tilts in prop::array::uniform2(-20.0..20.0f64),
    ) {
        let line = Vector3::from_fn(|i, _| 0.1 * components[i] * signs[i]);
        let outcome = |turn: UnitQuaternion<f64>| {
            let attitude = turn * UnitQuaternion::from_scaled_axis(stage_turn.into());
            let body = |mass: f64, place: f64| {
                let body = Body::new(mass, inertia([50.0, 40.0, 30.0], [2.0, 1.0, -3.0])).unwrap();
                body.moving(BodyState { position: attitude * Vector3::z() * place, attitude, ..Default::default() })
            };
            let springs = [0.3, -0.2].map(|side| {
                let point = Vector3::new(side, 0.1, 0.9);
                Spring::new(2e4, 0.1, point + line - Vector3::z() * 2.0, point).unwrap()
            });
            let mut stack = Stack::from(&Separation::new(body(100.0, 1.0), body(300.0, -1.0), &springs).unwrap());
            (0..2).for_each(|i| stack.set_load(0, SpringParameter::LineOfAction, i, tilts[i]));
            run(&stack.separation().unwrap())
        };
        let turn = UnitQuaternion::from_scaled_axis(turn.into());
        let (plain, turned) = (outcome(UnitQuaternion::identity()), outcome(turn));
        let [a, b] = [&plain, &turned].map(|outcome| outcome.payload().state().angular_velocity);
        prop_assert!((a - b).norm() < 1e-11 * (1.0 + a.norm()), "{} {}", a, b);
        prop_assert!((turn * plain.relative_velocity() - turned.relative_velocity()).norm() < 1e-11);
    }
}

#[test]
fn bodies_can_be_swapped_and_springs_permuted() {
    for separation in [paper(), skewed()] {
        let plain = run(&separation);
        let swapped: Vec<_> = separation
            .springs()
            .map(|s| {
                let (p, l) = (s.payload_point_m(), s.stage_point_m());
                Spring::new(s.stiffness_n_per_m(), s.stroke_m(), l, p).unwrap()
            })
            .collect();
        let swapped = Separation::new(*separation.stage(), *separation.payload(), &swapped);
        let swapped = run(&swapped.unwrap());
        for (a, b) in [(swapped.payload(), plain.stage()), (swapped.stage(), plain.payload())] {
            assert!(relative(&a.state().angular_velocity, &b.state().angular_velocity) < 1e-11);
            assert!(relative(&a.state().velocity, &b.state().velocity) < 1e-11);
        }
        let mut springs = separation.springs().copied().collect::<Vec<_>>();
        springs.rotate_left(1);
        springs.swap(0, 1);
        let permuted = moved(&separation, |s| s, &springs);
        let permuted = run(&permuted);
        let mut times: Vec<_> = plain.release_times().flatten().collect();
        times.rotate_left(1);
        times.swap(0, 1);
        for (a, b) in permuted.release_times().flatten().zip(times) {
            assert!((a - b).abs() < 1e-12);
        }
        let [a, b] = [&permuted, &plain].map(|o| o.payload().state().angular_velocity);
        assert!(relative(&a, &b) < 1e-11);
    }
}

/// Lengths, masses and times in other units.
#[test]
fn units_do_not_matter() {
    for (length, mass, time) in [(3.28, 0.0685, 1.0), (1e-6, 1e9, 1e-3), (1e5, 1e-12, 60.0)] {
        for separation in [paper(), skewed()] {
            let body = |b: &MovingBody| {
                let factor = mass * length * length;
                let entries = b.body().inertia().matrix().map(|x| x * factor);
                let inertia = gyradius_inertia::InertiaMatrix::new(entries).unwrap();
                let state = BodyState {
                    position: b.state().position * length,
                    velocity: b.state().velocity * (length / time),
                    attitude: b.state().attitude,
                    angular_velocity: b.state().angular_velocity / time,
                };
                Body::new(b.body().mass_kg() * mass, inertia).unwrap().moving(state)
            };
            let springs: Vec<_> = separation
                .springs()
                .map(|s| {
                    let (p, l) = (s.payload_point_m() * length, s.stage_point_m() * length);
                    let stiffness = s.stiffness_n_per_m() * mass / (time * time);
                    Spring::new(stiffness, s.stroke_m() * length, p, l).unwrap()
                })
                .collect();
            let scaled =
                Separation::new(body(separation.payload()), body(separation.stage()), &springs);
            let (plain, scaled) = (run(&separation), run(&scaled.unwrap()));
            assert_eq!(plain.steps(), scaled.steps());
            for (a, b) in scaled.release_times().flatten().zip(plain.release_times().flatten()) {
                assert!((a / time - b).abs() < 1e-12);
            }
            for (a, b) in [(scaled.payload(), plain.payload()), (scaled.stage(), plain.stage())] {
                let rate = b.state().angular_velocity / time;
                assert!(relative(&a.state().angular_velocity, &rate) < 1e-11);
                assert!(a.state().attitude.angle_to(&b.state().attitude) < 1e-11);
            }
        }
    }
}

/// Pads that fly through each other, bodies that whirl, a spring that takes years, a coast to nowhere.
#[test]
fn what_cannot_be_followed_is_said_to_be_so() {
    let ball = Body::new(1.0, inertia([1.0; 3], [0.0; 3])).unwrap();
    let spring = Spring::new(10.0, 0.1, Vector3::z() * -0.9, Vector3::z() * 0.9).unwrap();
    let moving = |position: Vector3<f64>, velocity: Vector3<f64>, spin: f64| {
        let angular_velocity = Vector3::x() * spin;
        ball.moving(BodyState { position, velocity, angular_velocity, ..BodyState::default() })
    };
    let closing = Separation::new(
        moving(Vector3::z(), -Vector3::z() * 10.0, 0.0),
        ball.at(-Vector3::z()),
        &[spring],
    );
    let error = closing.unwrap().run(&Settings::default()).unwrap_err();
    let RunError::PadsMeet { load, time, speed } = error else { panic!("{error}") };
    assert_eq!(load, LoadId { kind: Spring::KIND, number: 0 });
    assert!((time - 0.02).abs() < 1e-4 && (speed - 10.0).abs() < 0.1, "{error}");

    let whirling = |rate: f64| {
        let payload = moving(Vector3::z(), Vector3::zeros(), rate);
        let spring = Spring::new(10.0, 0.1, Vector3::zeros(), Vector3::zeros()).unwrap();
        let separation = Separation::new(payload, ball.at(-Vector3::z()), &[spring]);
        separation.unwrap().run(&Settings::default()).unwrap_err()
    };
    let error = whirling(1e6);
    assert!(matches!(error, RunError::TooManySteps { .. }), "{error}");
    let error = whirling(1e16);
    assert!(matches!(error, RunError::StepUnderflow { .. }), "{error}");

    let weak = Spring::new(1e-9, 0.1, Vector3::z() * -0.9, Vector3::z() * 0.9).unwrap();
    let weak = Separation::new(ball.at(Vector3::z()), ball.at(-Vector3::z()), &[weak]).unwrap();
    let error = weak.run(&Settings::default()).unwrap_err();
    let RunError::NotReleased { loads, horizon, compression, rate, start } = &error else {
        panic!("{error}");
    };
    assert_eq!((loads.as_slice(), *horizon, *start), (&[load][..], 60.0, None));
    assert!(error.to_string().starts_with("springs [1] had not let go after 60.0 s: spring 1 is "));
    assert!(*compression > 0.09 && *compression < 0.1 && *rate > 0.0, "{error}");
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let error = paper().trajectory(&Settings::default(), bad).unwrap_err();
        assert!(matches!(error, RunError::Coast { .. }));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Numbers of any size make an outcome of numbers or an error, soon.
    #[test]
    fn nothing_panics(exponents in prop::collection::vec(-300.0..300.0f64, 8), few in 0.0..1.0f64) {
        // Most are tame, or nothing would get to run.
        let size = |i: usize| 10.0_f64.powf(if (i as f64 * 0.37 + few).fract() < 0.3 {
            exponents[i]
        } else {
            exponents[i] / 300.0
        });
        let bodies = [0, 1].map(|i| {
            let moments = [size(2 + i), size(2 + i) * 1.1, size(2 + i) * 0.9];
            Body::new(size(i), inertia(moments, [0.0; 3]))
        });
        let spring = Spring::new(size(4), size(5), Vector3::x() * size(6), Vector3::y() * size(6));
        let [Ok(payload), Ok(stage)] = bodies else { return Ok(()) };
        let Ok(spring) = spring else { return Ok(()) };
        let state = BodyState {
            position: Vector3::z() * size(6),
            angular_velocity: Vector3::new(0.1, 0.2, 0.3) * (size(7) - 1.0),
            ..BodyState::default()
        };
        let Ok(separation) = Separation::new(payload.moving(state), stage.at(Vector3::zeros()), &[spring])
        else {
            return Ok(());
        };
        if let Ok(outcome) = separation.run(&Settings::default()) {
            prop_assert!(outcome.relative_speed().is_finite());
            prop_assert!(outcome.release_times().flatten().all(f64::is_finite));
        }
    }
}
