//! Springs against closed forms and conservation laws.

use crate::common::{inertia, log_fit, paper, relative, skewed};
use gyradius_separation::{Body, Separation, Settings, Snapshot, Spring};
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

/// Springs on one line are a harmonic oscillator: v = δ√(ΣK/μ) at (π/2)√(μ/ΣK).
#[test]
fn coaxial_springs_are_an_oscillator() {
    let axis = Vector3::new(0.6, 0.0, 0.8);
    let sphere = inertia([10.0, 12.0, 15.0], [1.0, 0.0, -0.5]);
    for (m1, m2, stiffnesses) in [
        (7.0, 3.0, vec![100.0]),
        (7.0, 3.0, vec![100.0, 250.0]),
        (1e4, 4e3, vec![1e5, 1e5, 3e4, 3e4]),
        (1e-3, 1e3, vec![5.0; 11]),
    ] {
        let springs: Vec<_> = stiffnesses
            .iter()
            .map(|k| Spring::new(*k, 0.2, axis * -0.5, axis * 0.5).unwrap())
            .collect();
        let separation = Separation::new(
            Body::new(m1, sphere).unwrap().at(axis),
            Body::new(m2, sphere).unwrap().at(-axis),
            &springs,
        )
        .unwrap();
        let outcome = separation.run(&Settings::default()).unwrap();
        let rate = (stiffnesses.iter().sum::<f64>() * (m1 + m2) / (m1 * m2)).sqrt();
        assert!((outcome.relative_speed() / (0.2 * rate) - 1.0).abs() < 1e-13);
        assert_eq!(outcome.release_times().len(), stiffnesses.len());
        for time in outcome.release_times().flatten() {
            assert!((time * rate / FRAC_PI_2 - 1.0).abs() < 1e-13, "{time}");
        }
        // On the way: the force is k δ cos(rate·t).
        let trajectory = separation.trajectory(&Settings::default(), 1.0).unwrap();
        let time = 0.3 / rate;
        let spring = trajectory.at(time).unwrap().loads()[0];
        let expected = axis * (stiffnesses[0] * 0.2 * 0.3_f64.cos());
        assert!(relative(&spring.force_n(), &expected) < 1e-12);
    }
}

/// The shorter the stroke, the more a spring is a blow J along its line, with ½kδ² = ½J²/m for the
/// effective mass m of both bodies at their points (Goldsmith 1960, ch. II).
#[test]
fn short_strokes_are_blows() {
    let (m1, m2) = (12.0, 5.0);
    let (i1, i2) = (inertia([4.0, 3.0, 2.0], [0.2, 0.1, -0.3]), inertia([2.0, 1.5, 1.8], [0.0; 3]));
    let (p, l) = (Vector3::new(0.4, 0.3, -0.6), Vector3::new(0.5, 0.2, 0.6));
    let (up, down) = (Vector3::z() * 0.7, Vector3::z() * -0.7);
    let line = (up + p - down - l).normalize();
    let (body1, body2) = (Body::new(m1, i1).unwrap(), Body::new(m2, i2).unwrap());
    let turn = |body: &Body, r: &Vector3<f64>| body.inverse_inertia() * r.cross(&line);
    let (w1, w2) = (turn(&body1, &p), turn(&body2, &l));
    let inverse = 1.0 / m1 + 1.0 / m2 + line.dot(&w1.cross(&p)) + line.dot(&w2.cross(&l));
    let errors: Vec<_> = (0..10)
        .map(|i| {
            let stroke = 0.02 * 0.5_f64.powi(i);
            // The same energy over shorter and shorter strokes.
            let stiffness = 2.0 / (stroke * stroke);
            let spring = Spring::new(stiffness, stroke, p, l).unwrap();
            let separation = Separation::new(body1.at(up), body2.at(down), &[spring]).unwrap();
            let outcome = separation.run(&Settings::default()).unwrap();
            let blow = (2.0 / inverse).sqrt();
            let error = relative(&outcome.payload().state().angular_velocity, &(w1 * blow))
                + relative(&outcome.stage().state().angular_velocity, &(w2 * -blow))
                + relative(&outcome.relative_velocity(), &(line * (blow / m1 + blow / m2)));
            (stroke, error)
        })
        .collect();
    let (slope, correlation) = log_fit(&errors);
    assert!(errors[9].1 < 1e-3 && (0.95..1.05).contains(&slope), "{slope}, {errors:?}");
    assert!(correlation > 0.999, "{correlation}");
}

/// Linear momentum, angular momentum about a fixed point, and energy with that of the springs, at
/// every moment to the last release and beyond.
#[test]
fn what_is_conserved_stays() {
    for separation in [paper(), skewed()] {
        let trajectory = separation.trajectory(&Settings::default(), 1.0).unwrap();
        let start = trajectory.at(0.0).unwrap();
        let size = |s: &Snapshot| {
            let (p, l) = (s.payload(), s.stage());
            let linear = p.momentum().norm() + l.momentum().norm();
            (linear, p.angular_momentum().norm() + l.angular_momentum().norm())
        };
        for i in 1..=500 {
            let time = trajectory.end_s() * f64::from(i) / 500.0;
            let now = trajectory.at(time).unwrap();
            let (linear, angular) = size(&now);
            assert!((now.momentum() - start.momentum()).norm() <= 1e-12 * linear, "{time} s");
            let change = (now.angular_momentum() - start.angular_momentum()).norm();
            assert!(change <= 1e-12 * angular, "{time} s: {:e}", change / angular);
            let change = now.energy_j() / start.energy_j() - 1.0;
            assert!(change.abs() < 1e-12, "{time} s: {change:e}");
        }
    }
}
