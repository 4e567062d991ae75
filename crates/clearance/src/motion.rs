//! How two bodies move: where they are at a time, and bounds on how fast they can move.

use nalgebra::{Matrix3, Vector3};

use crate::state::RigidState;

/// How fast payload and stage may move over a span of time: upper bounds, which need not be sharp
/// but must hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionLimits {
    /// Speed of the payload's mass centre relative to the stage's, m/s.
    pub speed: f64,
    /// Acceleration of the payload's mass centre relative to the stage's, m/s².
    pub acceleration: f64,
    /// Angular speeds of payload and stage, rad/s.
    pub angular_speed: [f64; 2],
    /// Angular accelerations of payload and stage, in body or inertial axes (they have the same
    /// length), rad/s².
    pub angular_acceleration: [f64; 2],
}

impl MotionLimits {
    pub(crate) fn are_valid(&self) -> bool {
        let [w, v] = self.angular_speed;
        let [a, b] = self.angular_acceleration;
        [self.speed, self.acceleration, w, v, a, b].iter().all(|x| *x >= 0.0 && x.is_finite())
    }

    /// Bound on the rate of any distance between points within `radii` of the mass centres.
    pub(crate) fn rate(&self, radii: [f64; 2]) -> f64 {
        self.speed + self.angular_speed[0] * radii[0] + self.angular_speed[1] * radii[1]
    }

    /// Bound on the relative acceleration of such points.
    pub(crate) fn second(&self, radii: [f64; 2]) -> f64 {
        self.acceleration + self.turning(0) * radii[0] + self.turning(1) * radii[1]
    }

    /// Bound on the acceleration of a point of a body, per distance from its mass centre.
    pub(crate) fn turning(&self, body: usize) -> f64 {
        self.angular_acceleration[body] + self.angular_speed[body] * self.angular_speed[body]
    }
}

/// Where payload and stage are at any time of a span, and how fast they can move.
///
/// Both must be smooth enough for the limits to hold: velocities are the derivatives of positions,
/// and accelerations stay below their limits. A kink of a force is no harm. [`Coast`](crate::Coast)
/// is the motion after the last release.
///
/// `&mut self`, so that a motion may be computed as far as it is asked for.
pub trait Motion {
    /// Payload and stage at the time, s; none where the motion is not known.
    fn states(&mut self, time_s: f64) -> Option<[RigidState; 2]>;

    /// Payload's mass centre from the stage's, inertial axes, m. Asked more often than the states:
    /// override it where it is cheaper.
    fn offset(&mut self, time_s: f64) -> Option<Vector3<f64>> {
        self.states(time_s).map(|[payload, stage]| payload.position - stage.position)
    }

    /// No distance of the mass centres on [from, to] (s) is below this, m. Override it where more is
    /// known than a bound on the speed.
    fn least_offset(&mut self, from_s: f64, to_s: f64) -> Option<f64> {
        let speed = self.limits(from_s, to_s).speed;
        let middle = self.offset(0.5 * (from_s + to_s))?;
        Some(middle.norm() - speed * 0.5 * (to_s - from_s))
    }

    /// Until when the states are known, s. Mass centres and their bounds are to be known beyond.
    /// Override it where a motion ends.
    fn known_until_s(&mut self) -> f64 {
        f64::INFINITY
    }

    /// Bounds that hold at all times of [from, to], s.
    fn limits(&mut self, from_s: f64, to_s: f64) -> MotionLimits;
}

/// Positions and velocities at an instant, inertial axes; payload first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) offset: Vector3<f64>,
    pub(crate) velocity: Vector3<f64>,
    pub(crate) rotation: [Matrix3<f64>; 2],
    pub(crate) rate: [Vector3<f64>; 2],
}

impl Frame {
    pub(crate) fn new([payload, stage]: &[RigidState; 2]) -> Option<Self> {
        let of = |state: &RigidState| {
            let rotation = state.attitude.to_rotation_matrix().into_inner();
            (rotation, rotation * state.angular_velocity)
        };
        let ((r0, w0), (r1, w1)) = (of(payload), of(stage));
        let frame = Self {
            offset: payload.position - stage.position,
            velocity: payload.velocity - stage.velocity,
            rotation: [r0, r1],
            rate: [w0, w1],
        };
        let finite = |m: &[f64]| m.iter().all(|x| x.abs() < 1e100);
        (finite(frame.offset.as_slice())
            && finite(frame.velocity.as_slice())
            && frame.rotation.iter().all(|m| finite(m.as_slice()))
            && frame.rate.iter().all(|m| finite(m.as_slice())))
        .then_some(frame)
    }
}
