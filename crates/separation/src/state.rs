//! A state that is integrated, and what its entries say.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::{
    BodyState,
    layout::{ATTITUDE, OFFSET, PAYLOAD_RATE, RELATIVE, STAGE_RATE, STATE, VELOCITY, part},
};

pub(crate) type State = [f64; STATE];

pub(crate) fn vector(state: &State, at: usize) -> Vector3<f64> {
    part::<_, 3>(state, at).into()
}

pub(crate) fn quaternion(state: &State, at: usize) -> UnitQuaternion<f64> {
    let [x, y, z, w] = part(state, at);
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))
}

pub(crate) fn put(state: &mut State, at: usize, values: &[f64]) {
    state[at..at + values.len()].copy_from_slice(values);
}

/// Brings the quaternions back to unit norm.
pub(crate) fn normalize(state: &mut State) {
    for at in [RELATIVE, ATTITUDE] {
        let [x, y, z, w] = part(state, at);
        let scale = 1.0 / (x * x + y * y + z * z + w * w).sqrt();
        put(state, at, &[x * scale, y * scale, z * scale, w * scale]);
    }
}

/// Payload and stage with respect to the stage's mass centre, in payload axes: position and velocity (of
/// components that turn with the payload), attitude, and angular velocity in body axes.
pub(crate) fn relative(state: &State) -> [BodyState; 2] {
    let payload = BodyState {
        position: vector(state, OFFSET),
        velocity: vector(state, VELOCITY),
        attitude: UnitQuaternion::identity(),
        angular_velocity: vector(state, PAYLOAD_RATE),
    };
    let stage = BodyState {
        attitude: quaternion(state, RELATIVE),
        angular_velocity: vector(state, STAGE_RATE),
        ..BodyState::default()
    };
    [payload, stage]
}
