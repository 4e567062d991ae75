//! What an outcome says, against closed forms.

use crate::common::{inertia, moved, paper, skewed, tumbling};
#[cfg(feature = "serde")]
use gyradius_separation::Outcome;
use gyradius_separation::{Batch, Body, BodyState, Separation, Settings, Spring};
use nalgebra::{Unit, UnitQuaternion, Vector3};

/// Every outcome of a batch has the start and the stored energy of its own separation.
#[test]
fn outcomes_keep_their_start() {
    let starts: Vec<Separation> = (0..13_u32)
        .map(|i| {
            let of = if i % 2 == 0 { paper() } else { skewed() };
            let by = Vector3::new(0.3, -0.1, 0.2) * f64::from(i);
            let springs: Vec<Spring> =
                of.springs().map(|s| s.with_friction(f64::from(i)).unwrap()).collect();
            let state = |s: BodyState| BodyState {
                velocity: s.velocity + by,
                angular_velocity: s.angular_velocity + by * 0.01,
                ..s
            };
            moved(&of, state, &springs)
        })
        .collect();
    let mut count = 0;
    Batch::new(Settings::default()).run(&starts, |i, outcome| {
        let (outcome, of) = (outcome.unwrap(), &starts[i]);
        assert_eq!(outcome.start(), [*of.payload(), *of.stage()]);
        assert_eq!(outcome.energy_split().stored_j(), of.stored_energy());
        count += 1;
    });
    assert_eq!(count, starts.len());
}

/// An outcome that is written and read again says the same, to the bit; what cannot be is refused.
#[cfg(feature = "serde")]
#[test]
fn outcomes_are_written_and_read_again() {
    for separation in [paper(), skewed()] {
        let outcome = separation.run(&Settings::default()).unwrap();
        let json = serde_json::to_string(&outcome).unwrap();
        let again: Outcome = serde_json::from_str(&json).unwrap();
        assert_eq!(again, outcome);
        assert_eq!(again.energy_split(), outcome.energy_split());
        let mass = format!("\"mass_kg\":{:?}", outcome.payload().body().mass_kg());
        assert!(json.contains(&mass), "{json}");
        let bad = json.replace(&mass, "\"mass_kg\":-1.0");
        assert!(serde_json::from_str::<Outcome>(&bad).is_err());
    }
}

/// The energy of the springs is all there, in translation and rotation of either body.
#[test]
fn energy_splits_without_a_rest() {
    for separation in [paper(), skewed()] {
        let outcome = separation.run(&Settings::default()).unwrap();
        let split = outcome.energy_split();
        let rest = split.total_j() / split.stored_j() - 1.0;
        assert!(rest.abs() < 1e-12, "{rest:e}");
        // The same relative to any observer.
        let boosted = moved(
            &separation,
            |s| BodyState { velocity: s.velocity + Vector3::new(8.0, -4.0, 2.0), ..s },
            &separation.springs().copied().collect::<Vec<_>>(),
        );
        let other = boosted.run(&Settings::default()).unwrap().energy_split();
        for (a, b) in [
            (split.payload_translation_j(), other.payload_translation_j()),
            (split.stage_translation_j(), other.stage_translation_j()),
            (split.payload_rotation_j(), other.payload_rotation_j()),
            (split.stage_rotation_j(), other.stage_rotation_j()),
        ] {
            assert!((a - b).abs() < 1e-12 * split.stored_j(), "{a} {b}");
        }
    }
    // The paper's is symmetric about the y-z plane: the payload turns about x alone but for its
    // products, and takes m_L/(m_P + m_L) of the translation.
    let separation = paper();
    let split = separation.run(&Settings::default()).unwrap().energy_split();
    let ratio = split.payload_translation_j() / split.stage_translation_j();
    assert!((ratio - 0.4).abs() < 1e-14, "{ratio}");
}

/// A coaxial spring along a slanted line parts the bodies along it.
#[test]
fn the_direction_of_separation_is_that_of_the_spring() {
    let line = Unit::new_normalize(Vector3::new(0.3, -0.2, 0.9));
    let body = Body::new(5.0, inertia([2.0, 2.5, 3.0], [0.0; 3])).unwrap();
    let spring = Spring::new(50.0, 0.1, *line * -0.5, *line * 0.5).unwrap();
    let separation = Separation::new(body.at(*line), body.at(-*line), &[spring]).unwrap();
    let outcome = separation.run(&Settings::default()).unwrap();
    assert!(outcome.direction_error(&line).unwrap() < 1e-15);
    let expected = Vector3::z_axis().angle(&line);
    assert!((outcome.direction_error(&Vector3::z_axis()).unwrap() - expected).abs() < 1e-15);
    // The same with both bodies and the intention turned, and moving across.
    let turn = UnitQuaternion::from_euler_angles(0.4, -1.1, 2.0);
    let turned = moved(
        &separation,
        |s| BodyState {
            position: turn * s.position,
            attitude: turn * s.attitude,
            velocity: Vector3::new(1.0, 2.0, 3.0),
            ..s
        },
        &[spring],
    );
    let outcome = turned.run(&Settings::default()).unwrap();
    assert!(outcome.direction_error(&(turn * line)).unwrap() < 1e-14);
}

/// A body that turned before has tipped by what came on top; one that a force through its mass centre
/// pushes has not tipped at all.
#[test]
fn tip_off_is_what_the_springs_did() {
    let sphere = Body::new(5.0, inertia([2.0; 3], [0.0; 3])).unwrap();
    let spin = Vector3::new(0.0, 0.0, 0.2);
    let start = BodyState { position: Vector3::z(), angular_velocity: spin, ..Default::default() };
    let arm = Vector3::z() * 0.5;
    let spring = Spring::new(50.0, 0.1, -arm, arm).unwrap();
    let separation =
        Separation::new(sphere.moving(start), sphere.at(-Vector3::z()), &[spring]).unwrap();
    let outcome = separation.run(&Settings::default()).unwrap();
    assert_eq!(outcome.payload().state().angular_velocity, spin);
    assert_eq!(outcome.tip_off(), [Vector3::zeros(); 2]);

    // From rest it is the rates themselves; by symmetry the paper's stage turns the other way.
    let separation = paper();
    let outcome = separation.run(&Settings::default()).unwrap();
    let [payload, stage] = outcome.tip_off();
    assert_eq!(payload, outcome.payload().state().angular_velocity);
    assert_eq!(stage, outcome.stage().state().angular_velocity);
    assert!(payload.x.to_degrees() > 0.1, "{payload}");
    // Torques about the fixed origin cancel: so do the momenta.
    let both = outcome.payload().angular_momentum() + outcome.stage().angular_momentum();
    assert!(both.norm() < 1e-12 * outcome.payload().angular_momentum().norm());
}

#[test]
fn releases_have_an_order_and_may_be_together() {
    let separation = paper();
    let outcome = separation.run(&Settings::default()).unwrap();
    assert_eq!(outcome.release_order(), [[0], [1], [2], [3]]);
    // Equal springs on mirrored arms let go at once; a longer one later.
    let spring = |stroke: f64, x: f64| {
        Spring::new(1e3, stroke, Vector3::new(x, 0.0, -0.5), Vector3::new(x, 0.0, 0.5)).unwrap()
    };
    let body = Body::new(50.0, inertia([20.0, 25.0, 30.0], [0.0; 3])).unwrap();
    let springs = [spring(0.1, 0.0), spring(0.05, 0.4), spring(0.05, -0.4)];
    let separation =
        Separation::new(body.at(Vector3::z()), body.at(-Vector3::z()), &springs).unwrap();
    let order = separation.run(&Settings::default()).unwrap().release_order();
    assert_eq!(order, [vec![1, 2], vec![0]]);
}

/// The momentum of a body that nothing turns stays where it points, whatever the body does.
#[test]
fn momentum_points_where_it_pointed() {
    let attitude = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.2);
    let state = BodyState {
        position: Vector3::z(),
        attitude,
        angular_velocity: Vector3::new(0.5, 3.0, 0.1),
        ..Default::default()
    };
    let separation = tumbling([1.0, 1.4, 2.0], state);
    let before = separation.payload();
    let intended = Unit::new_normalize(before.inertial_spin_angular_momentum());
    assert_eq!(before.momentum_error(&intended).map(|e| e < 1e-15), Some(true));
    let outcome = separation.run(&Settings::default()).unwrap();
    let turned = before.state().attitude.angle_to(&outcome.payload().state().attitude);
    assert!(turned > 0.1, "{turned}");
    assert!(outcome.payload().momentum_error(&intended).unwrap() < 1e-12);
    // Bounds of the nutation are of energy and momentum, which do not change.
    let axis = Vector3::x_axis();
    let [a, b] = [before.spin_metrics(&axis), outcome.spin_metrics(&axis)]
        .map(|m| m.nutation_bounds().unwrap());
    assert!((a[0] - b[0]).abs() < 1e-11 && (a[1] - b[1]).abs() < 1e-11, "{a:?} {b:?}");
}
