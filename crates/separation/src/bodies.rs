//! The two bodies of a separation as a state that is integrated, and back.

use nalgebra::UnitQuaternion;

use crate::{
    BodyState, MovingBody, Separation,
    layout::{ATTITUDE, OFFSET, PAYLOAD_RATE, RELATIVE, STAGE_RATE, STATE, VELOCITY},
    load::Seated,
    state::{State, put, quaternion, vector},
};

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

/// The two bodies in a state reached after `time`.
pub(crate) fn bodies(
    separation: &Separation,
    state: &State,
    time: f64,
) -> (MovingBody, MovingBody) {
    let [payload, stage] = states(separation, state, time);
    (separation.payload().body().moving(payload), separation.stage().body().moving(stage))
}

/// Payload and stage in a state reached after `time`: the mass centre of the whole has moved uniformly.
pub(crate) fn states(separation: &Separation, state: &State, time: f64) -> [BodyState; 2] {
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
    [payload_state, stage_state]
}

/// The size of each entry of the state that the loads can bring about.
pub(crate) fn scales(separation: &Separation) -> State {
    let sizes = || separation.seated().iter().map(Seated::size);
    let length = sizes().map(|size| size.stroke).fold(0.0, f64::max);
    let speed = (2.0 * separation.stored_energy() * separation.inverse_reduced_mass()).sqrt();
    let arm = sizes().flat_map(|size| size.arms).fold(length, f64::max);
    let mut scale = [length; STATE];
    scale[VELOCITY..RELATIVE].fill(speed);
    scale[RELATIVE..PAYLOAD_RATE].fill(length / arm);
    scale[PAYLOAD_RATE..].fill(speed / arm);
    scale
}

/// A time in which the loads move the bodies a good part of the stroke, s.
pub(crate) fn time_scale(scale: &State) -> f64 {
    scale[OFFSET] / scale[VELOCITY]
}
