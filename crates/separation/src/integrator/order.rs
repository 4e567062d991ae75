//! The order of the integration, as the slope of errors over the step.

use super::*;
use crate::{Body, BodyState, Spring};
use gyradius_inertia::InertiaMatrix;
use nalgebra::Vector3;

/// Two bodies that turn, and two springs that let go apart.
pub(super) fn turning(springs: bool) -> Separation {
    let inertia = |a, b, c| InertiaMatrix::from_entries([a, b, c], [0.1, 0.05, -0.1]).unwrap();
    let state = |z: f64| BodyState {
        position: Vector3::z() * z,
        angular_velocity: Vector3::new(0.4, 2.0 * z, 1.0),
        ..BodyState::default()
    };
    let point = |x, z| Vector3::new(x, 0.2, z);
    // Springs of next to no stiffness leave the bodies to turn as they like.
    let stiffness = if springs { 30.0 } else { 1e-6 };
    let spring = |k: f64, x| Spring::new(k, 0.3, point(x, -0.5), point(x, 0.5)).unwrap();
    Separation::new(
        Body::new(3.0, inertia(2.0, 1.5, 1.0)).unwrap().moving(state(1.0)),
        Body::new(2.0, inertia(1.0, 1.2, 1.4)).unwrap().moving(state(-1.0)),
        &[spring(stiffness, 0.4), spring(0.5 * stiffness, -0.4)],
    )
    .unwrap()
}

/// Steps of a given length to a time. Springs let go where they do, or, `located` not, at the end
/// of the step in which they do.
fn fixed_steps(separation: &Separation, h: f64, until: f64, located: bool) -> State {
    let mut integrator = Integrator::<4>::new(Settings::default());
    let mut track = integrator.load(0, separation);
    // Whatever the error, a step is taken.
    integrator.expansion.stretch = [0.0, 0.0, 1e9];
    let mut n = 0.0;
    while track.time < until {
        integrator.expand();
        if track.time >= (n + 0.999) * h {
            n += 1.0;
        }
        let end = f64::min((n + 1.0) * h, until);
        if located {
            integrator.advance(0, separation, &mut track, end).unwrap();
            continue;
        }
        let mut next = integrator.at(0, end - track.time);
        state::normalize(&mut next);
        integrator.set_state(0, &next);
        track.time = end;
        for (i, fate) in track.loads.iter_mut().enumerate() {
            if fate.is_open() && separation.seated().get(i).gap(&next).value >= 0.0 {
                fate.end(end);
                integrator.expansion.loads.act(separation.seated().slot(i), 0, false);
            }
        }
    }
    integrator.state(0)
}

fn distance(a: &State, b: &State) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Slope and correlation of log error over log step.
fn fit(errors: &[(f64, f64)]) -> (f64, f64) {
    let points: Vec<_> = errors.iter().map(|(h, e)| (h.ln(), e.ln())).collect();
    let n = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let (sxy, sxx, syy) = points.iter().fold((0.0, 0.0, 0.0), |s, p| {
        let (x, y) = (p.0 - mx, p.1 - my);
        (s.0 + x * y, s.1 + x * x, s.2 + y * y)
    });
    (sxy / sxx, sxy / (sxx * syy).sqrt())
}

fn errors(separation: &Separation, steps: &[u32], until: f64, located: bool) -> Vec<(f64, f64)> {
    let exact = fixed_steps(separation, until / 100.0, until, true);
    let error = |n: &u32| {
        let h = until / f64::from(*n);
        (h, distance(&fixed_steps(separation, h, until, located), &exact))
    };
    steps.iter().map(error).collect()
}

/// One step from the same state, all that moves moving.
#[test]
fn a_step_errs_by_the_first_term_left_out() {
    let separation = turning(true);
    let one: Vec<_> = (0..12)
        .map(|i| {
            let h = 0.12 * 0.93_f64.powi(i);
            let exact = fixed_steps(&separation, h / 8.0, h, true);
            (h, distance(&fixed_steps(&separation, h, h, true), &exact))
        })
        .collect();
    let (slope, correlation) = fit(&one);
    assert!((slope - (ORDER + 1) as f64).abs() < 0.6, "{slope} {one:?}");
    assert!(correlation > 0.999, "{correlation} {one:?}");
}

/// Many steps over a given time: a sphere that turns evenly, seen from which all else turns.
#[test]
fn errors_fall_at_the_order_of_the_series() {
    let sphere = InertiaMatrix::from_entries([1.0; 3], [0.0; 3]).unwrap();
    let body = Body::new(2.0, sphere).unwrap();
    let state = BodyState {
        position: Vector3::z(),
        angular_velocity: Vector3::new(2.0, 4.0, 4.0),
        ..BodyState::default()
    };
    let spring = Spring::new(1e-6, 0.5, Vector3::zeros(), Vector3::zeros()).unwrap();
    let stage = body.at(-Vector3::z());
    let separation = Separation::new(body.moving(state), stage, &[spring]).unwrap();
    let found = errors(&separation, &[12, 14, 16, 18, 20, 22, 24, 26, 28], 6.0, true);
    let (slope, correlation) = fit(&found);
    assert!((slope - ORDER as f64).abs() < 0.6, "{slope} {found:?}");
    assert!(correlation > 0.999, "{correlation} {found:?}");
}

/// Releases at the ends of steps leave an integration of second order at best; found as events
/// they leave the order be.
#[test]
fn releases_must_be_located() {
    let separation = turning(true);
    let late = errors(&separation, &[14, 20, 28, 40, 57, 80, 113, 160, 226], 1.2, false);
    let (slope, _) = fit(&late);
    assert!((0.5..2.5).contains(&slope), "{slope} {late:?}");
    let found = errors(&separation, &[10, 11, 12, 13, 14, 15, 16, 18, 20], 1.2, true);
    let (slope, correlation) = fit(&found);
    assert!(slope > ORDER as f64 - 1.0 && correlation > 0.99, "{slope} {correlation} {found:?}");
}
