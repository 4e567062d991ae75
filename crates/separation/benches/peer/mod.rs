//! The same separation through the crate `differential-equations`: DOP853 with events, in inertial
//! axes, as one would write it.

use differential_equations::prelude::*;
use gyradius_separation::Separation;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

type State = [f64; 20];

/// Relative position and velocity, then attitude and rate of payload and stage.
struct Problem<'a> {
    separation: &'a Separation,
    active: Vec<usize>,
}

fn vector(y: &State, at: usize) -> Vector3<f64> {
    Vector3::new(y[at], y[at + 1], y[at + 2])
}

fn rotation(y: &State, at: usize) -> Matrix3<f64> {
    let q = Quaternion::new(y[at + 3], y[at], y[at + 1], y[at + 2]);
    UnitQuaternion::new_normalize(q).to_rotation_matrix().into_inner()
}

impl Problem<'_> {
    fn line(&self, y: &State, spring: usize) -> [Vector3<f64>; 3] {
        let spring = self.separation.springs().nth(spring).unwrap();
        let (p, l) =
            (rotation(y, 6) * spring.payload_point_m(), rotation(y, 13) * spring.stage_point_m());
        [vector(y, 0) + p - l, p, l]
    }

    fn gap(&self, y: &State, spring: usize) -> f64 {
        self.line(y, spring)[0].norm() - self.separation.release_lengths().nth(spring).unwrap()
    }
}

impl ODE<f64, State> for Problem<'_> {
    fn diff(&self, _: f64, y: &State, dy: &mut State) {
        let (payload, stage) = (self.separation.payload().body(), self.separation.stage().body());
        let (rp, rl) = (rotation(y, 6), rotation(y, 13));
        let (mut force, mut tp, mut tl) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        for &i in &self.active {
            let spring = self.separation.springs().nth(i).unwrap();
            let (p, l) = (rp * spring.payload_point_m(), rl * spring.stage_point_m());
            let line = vector(y, 0) + p - l;
            let length = line.norm();
            let free = self.separation.release_lengths().nth(i).unwrap();
            let push = line * (spring.stiffness_n_per_m() * (free - length) / length);
            force += push;
            tp += p.cross(&push);
            tl -= l.cross(&push);
        }
        dy[..3].copy_from_slice(&y[3..6]);
        let acceleration = force * (1.0 / payload.mass_kg() + 1.0 / stage.mass_kg());
        dy[3..6].copy_from_slice(acceleration.as_slice());
        for (at, body, torque) in [(6, payload, rp.tr_mul(&tp)), (13, stage, rl.tr_mul(&tl))] {
            let (v, s, w) = (vector(y, at), y[at + 3], vector(y, at + 4));
            dy[at..at + 3].copy_from_slice(((w * s + v.cross(&w)) * 0.5).as_slice());
            dy[at + 3] = -0.5 * v.dot(&w);
            let gyroscopic = w.cross(&(body.inertia().matrix() * w));
            let turn = body.inverse_inertia() * (torque - gyroscopic);
            dy[at + 4..at + 7].copy_from_slice(turn.as_slice());
        }
    }
}

impl Event<f64, State> for Problem<'_> {
    fn config(&self) -> EventConfig {
        EventConfig::new(CrossingDirection::Positive, Some(1))
    }

    fn event(&self, _: f64, y: &State) -> f64 {
        self.active.iter().map(|i| self.gap(y, *i)).fold(f64::MIN, f64::max)
    }
}

/// The payload's angular velocity after the last release, and when that was.
pub(crate) fn separate(separation: &Separation, tolerance: f64) -> (Vector3<f64>, f64) {
    let (payload, stage) = (separation.payload().state(), separation.stage().state());
    let mut y = [0.0; 20];
    y[..3].copy_from_slice((payload.position - stage.position).as_slice());
    y[3..6].copy_from_slice((payload.velocity - stage.velocity).as_slice());
    for (at, body) in [(6, payload), (13, stage)] {
        y[at..at + 4].copy_from_slice(body.attitude.coords.as_slice());
        y[at + 4..at + 7].copy_from_slice(body.angular_velocity.as_slice());
    }
    let mut time = 0.0;
    let mut problem = Problem { separation, active: (0..separation.springs().len()).collect() };
    while !problem.active.is_empty() {
        let solution = IVP::ode(&problem, time, time + 60.0, y)
            .event(&problem)
            .method(ExplicitRungeKutta::dop853())
            .rtol(tolerance)
            .atol(tolerance)
            .solve();
        let Ok(solution) = solution else { break };
        (time, y) = (solution.t[solution.t.len() - 1], solution.y[solution.y.len() - 1]);
        let mut gaps = problem.active.iter().map(|i| (problem.gap(&y, *i), *i)).collect::<Vec<_>>();
        gaps.sort_by(|a, b| b.0.total_cmp(&a.0));
        problem.active.retain(|i| *i != gaps[0].1);
    }
    (vector(&y, 10), time)
}
