//! What a state that is integrated says of the two bodies.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::{
    BodyState, MovingBody, Separation, Spring,
    layout::{ATTITUDE, OFFSET, PAYLOAD_RATE, RELATIVE, STAGE_RATE, STATE, VELOCITY, part},
};

pub(crate) type State = [f64; STATE];

/// How far a spring is beyond its free length, m, and how fast it grows, m/s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap {
    pub(crate) value: f64,
    pub(crate) rate: f64,
}

fn vector(state: &State, at: usize) -> Vector3<f64> {
    part::<_, 3>(state, at).into()
}

fn quaternion(state: &State, at: usize) -> UnitQuaternion<f64> {
    let [x, y, z, w] = part(state, at);
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))
}

fn put(state: &mut State, at: usize, values: &[f64]) {
    state[at..at + values.len()].copy_from_slice(values);
}

/// The state to integrate from.
pub(crate) fn initial(separation: &Separation) -> State {
    let (payload, stage) = (separation.payload().state(), separation.stage().state());
    let turn = payload.attitude.inverse();
    let mut state = [0.0; STATE];
    put(&mut state, OFFSET, (turn * (payload.position - stage.position)).as_slice());
    put(&mut state, VELOCITY, (turn * (payload.velocity - stage.velocity)).as_slice());
    put(&mut state, RELATIVE, (turn * stage.attitude).coords.as_slice());
    put(&mut state, ATTITUDE, payload.attitude.coords.as_slice());
    put(&mut state, PAYLOAD_RATE, payload.angular_velocity.as_slice());
    put(&mut state, STAGE_RATE, stage.angular_velocity.as_slice());
    state
}

/// Brings the quaternions back to unit norm.
pub(crate) fn normalize(state: &mut State) {
    for at in [RELATIVE, ATTITUDE] {
        let [x, y, z, w] = part(state, at);
        let scale = 1.0 / (x * x + y * y + z * z + w * w).sqrt();
        put(state, at, &[x * scale, y * scale, z * scale, w * scale]);
    }
}

/// The two bodies in a state reached after `time`: the mass centre of the whole has moved
/// uniformly.
pub(crate) fn bodies(
    separation: &Separation,
    state: &State,
    time: f64,
) -> (MovingBody, MovingBody) {
    let (payload, stage) = (separation.payload(), separation.stage());
    let (mp, ml) = (payload.body().mass_kg(), stage.body().mass_kg());
    let (fp, fl) = (mp / (mp + ml), ml / (mp + ml));
    let velocity = payload.state().velocity * fp + stage.state().velocity * fl;
    let position = payload.state().position * fp + stage.state().position * fl + velocity * time;
    let attitude = quaternion(state, ATTITUDE);
    let (offset, relative) = (attitude * vector(state, OFFSET), attitude * vector(state, VELOCITY));
    let payload_state = BodyState {
        position: position + offset * fl,
        velocity: velocity + relative * fl,
        attitude,
        angular_velocity: vector(state, PAYLOAD_RATE),
    };
    let stage_state = BodyState {
        position: position - offset * fp,
        velocity: velocity - relative * fp,
        attitude: UnitQuaternion::new_normalize(
            (attitude * quaternion(state, RELATIVE)).into_inner(),
        ),
        angular_velocity: vector(state, STAGE_RATE),
    };
    (payload.body().moving(payload_state), stage.body().moving(stage_state))
}

/// From the stage point of a spring to its payload point, payload axes, m.
pub(crate) fn line(state: &State, spring: &Spring) -> Vector3<f64> {
    vector(state, OFFSET) + spring.payload_point_m()
        - quaternion(state, RELATIVE) * spring.stage_point_m()
}

/// The gap of a spring.
pub(crate) fn gap(separation: &Separation, state: &State, spring: usize) -> Gap {
    let (points, free) = (&separation.springs()[spring], separation.free_lengths()[spring]);
    let relative = quaternion(state, RELATIVE);
    let (payload_rate, stage_rate) = (vector(state, PAYLOAD_RATE), vector(state, STAGE_RATE));
    let (p, l) = (points.payload_point_m(), points.stage_point_m());
    let line = line(state, points);
    let velocity =
        vector(state, VELOCITY) + payload_rate.cross(&p) - relative * stage_rate.cross(&l);
    let length = line.norm();
    Gap { value: length - free, rate: line.dot(&velocity) / length }
}

/// What rounding of coordinates makes of a gap, m: it is a difference and no more accurate than they
/// are.
pub(crate) fn rounding(separation: &Separation, state: &State, spring: usize) -> f64 {
    let spring = &separation.springs()[spring];
    let reach = vector(state, OFFSET).norm()
        + spring.payload_point_m().norm()
        + spring.stage_point_m().norm();
    4.0 * f64::EPSILON * reach
}

/// The size of each entry of the state that the springs can bring about.
pub(crate) fn scales(separation: &Separation) -> State {
    let springs = separation.springs();
    let length = springs.iter().map(Spring::stroke_m).fold(0.0, f64::max);
    let speed = (2.0 * separation.stored_energy() * separation.inverse_reduced_mass()).sqrt();
    let arm = springs
        .iter()
        .flat_map(|s| [s.payload_point_m().norm(), s.stage_point_m().norm()])
        .fold(length, f64::max);
    let mut scale = [length; STATE];
    scale[VELOCITY..RELATIVE].fill(speed);
    scale[RELATIVE..PAYLOAD_RATE].fill(length / arm);
    scale[PAYLOAD_RATE..].fill(speed / arm);
    scale
}

/// A time in which the springs move the bodies a good part of the stroke, s.
pub(crate) fn time_scale(scale: &State) -> f64 {
    scale[OFFSET] / scale[VELOCITY]
}
