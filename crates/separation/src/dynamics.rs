use nalgebra::{Matrix3, Vector3};

use crate::{BodyState, MovingBody, Separation, Spring};

/// Length of the state: relative position and velocity of the mass centres (inertial axes), then
/// quaternion and angular velocity (body axes) of the payload and of the stage. The mass centre of
/// the whole moves uniformly and is not integrated.
pub(crate) const N: usize = 20;
pub(crate) type State = [f64; N];

const POSITION: usize = 0;
const VELOCITY: usize = 3;
const PAYLOAD: usize = 6;
const STAGE: usize = 13;

/// The equations of motion (Peck 2003, Eq. 28-29, with forces that act in opposite directions on
/// the two bodies) with the springs that still push.
pub(crate) struct Dynamics {
    active: Vec<ActiveSpring>,
    payload: Rotor,
    stage: Rotor,
    inverse_reduced_mass: f64,
}

struct ActiveSpring {
    index: usize,
    stiffness: f64,
    free_length: f64,
    payload_point: Vector3<f64>,
    stage_point: Vector3<f64>,
}

struct Rotor {
    inertia: Matrix3<f64>,
    inverse: Matrix3<f64>,
}

/// How far a spring is beyond its free length, m, and the first two derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap {
    pub(crate) value: f64,
    pub(crate) rate: f64,
    pub(crate) acceleration: f64,
}

impl Dynamics {
    pub(crate) fn new(separation: &Separation) -> Self {
        let rotor = |body: &MovingBody| Rotor {
            inertia: *body.body().inertia().matrix(),
            inverse: *body.body().inverse_inertia(),
        };
        let springs = separation.springs().iter().zip(separation.free_lengths()).enumerate();
        Self {
            active: springs
                .map(|(index, (spring, &free_length))| ActiveSpring {
                    index,
                    stiffness: spring.stiffness_n_per_m(),
                    free_length,
                    payload_point: spring.payload_point_m(),
                    stage_point: spring.stage_point_m(),
                })
                .collect(),
            payload: rotor(separation.payload()),
            stage: rotor(separation.stage()),
            inverse_reduced_mass: 1.0 / separation.payload().body().mass_kg()
                + 1.0 / separation.stage().body().mass_kg(),
        }
    }

    pub(crate) fn all_released(&self) -> bool {
        self.active.is_empty()
    }

    /// The springs that still push, from 1.
    pub(crate) fn active_numbers(&self) -> Vec<usize> {
        self.active.iter().map(|s| s.index + 1).collect()
    }

    /// Lets go of the spring that is longest for its free length, and of those that are as long to
    /// rounding: in a state where the first of them reaches it.
    pub(crate) fn release_longest(
        &mut self,
        state: &State,
        slope: &State,
        mut released: impl FnMut(usize),
    ) {
        let motion = Motion::of(state, slope);
        let longest = self.active.iter().map(|s| motion.gap(s).value).fold(f64::MIN, f64::max);
        self.active.retain(|spring| {
            // A gap is the difference of coordinates and no more accurate than they are.
            let reach =
                motion.offset.norm() + spring.payload_point.norm() + spring.stage_point.norm();
            let free = motion.gap(spring).value >= longest - 4.0 * f64::EPSILON * reach;
            if free {
                released(spring.index);
            }
            !free
        });
    }

    /// The gaps of the springs that still push.
    pub(crate) fn gaps(&self, state: &State, slope: &State) -> impl Iterator<Item = Gap> {
        let motion = Motion::of(state, slope);
        self.active.iter().map(move |spring| motion.gap(spring))
    }

    /// Time derivative of the state.
    #[inline]
    pub(crate) fn derivative(&self, y: &State) -> State {
        let offset = vector(y, POSITION);
        let (rp, rl) = (rotation(y, PAYLOAD), rotation(y, STAGE));
        let (mut force, mut torque_p, mut torque_l) =
            (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        for spring in &self.active {
            let (p, l) = (rp * spring.payload_point, rl * spring.stage_point);
            let line = offset + p - l;
            let length = line.norm();
            let push = line * (spring.stiffness * (spring.free_length - length) / length);
            force += push;
            torque_p += p.cross(&push);
            torque_l -= l.cross(&push);
        }

        let mut dy = [0.0; N];
        dy[POSITION..VELOCITY].copy_from_slice(&y[VELOCITY..PAYLOAD]);
        put(&mut dy, VELOCITY, &(force * self.inverse_reduced_mass));
        turn(&mut dy, y, PAYLOAD, &self.payload, &rp.tr_mul(&torque_p));
        turn(&mut dy, y, STAGE, &self.stage, &rl.tr_mul(&torque_l));
        dy
    }
}

/// Kinematics and Euler's equations of one body, the torque in body axes.
#[inline]
fn turn(dy: &mut State, y: &State, at: usize, rotor: &Rotor, torque: &Vector3<f64>) {
    let (v, w) = (vector(y, at), y[at + 3]);
    let omega = vector(y, at + 4);
    put(dy, at, &((omega * w + v.cross(&omega)) * 0.5));
    dy[at + 3] = -0.5 * v.dot(&omega);
    let gyroscopic = omega.cross(&(rotor.inertia * omega));
    put(dy, at + 4, &(rotor.inverse * (torque - gyroscopic)));
}

#[inline]
fn vector(y: &State, at: usize) -> Vector3<f64> {
    Vector3::new(y[at], y[at + 1], y[at + 2])
}

#[inline]
fn put(y: &mut State, at: usize, v: &Vector3<f64>) {
    y[at..at + 3].copy_from_slice(v.as_slice());
}

/// The rotation of a quaternion of any norm.
#[inline]
fn rotation(y: &State, at: usize) -> Matrix3<f64> {
    let (a, b, c, d) = (y[at], y[at + 1], y[at + 2], y[at + 3]);
    let s = 2.0 / (a * a + b * b + c * c + d * d);
    Matrix3::new(
        1.0 - s * (b * b + c * c),
        s * (a * b - c * d),
        s * (a * c + b * d),
        s * (a * b + c * d),
        1.0 - s * (a * a + c * c),
        s * (b * c - a * d),
        s * (a * c - b * d),
        s * (b * c + a * d),
        1.0 - s * (a * a + b * b),
    )
}

/// Motion of the spring points in a state.
struct Motion {
    offset: Vector3<f64>,
    velocity: Vector3<f64>,
    acceleration: Vector3<f64>,
    payload: Turning,
    stage: Turning,
}

struct Turning {
    rotation: Matrix3<f64>,
    rate: Vector3<f64>,
    acceleration: Vector3<f64>,
}

impl Turning {
    fn of(state: &State, slope: &State, at: usize) -> Self {
        Self {
            rotation: rotation(state, at),
            rate: vector(state, at + 4),
            acceleration: vector(slope, at + 4),
        }
    }

    /// Position, velocity and acceleration of a body point relative to the mass centre, inertial.
    fn point(&self, p: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let velocity = self.rate.cross(p);
        let acceleration = self.acceleration.cross(p) + self.rate.cross(&velocity);
        [*p, velocity, acceleration].map(|x| self.rotation * x)
    }
}

impl Motion {
    fn of(state: &State, slope: &State) -> Self {
        Self {
            offset: vector(state, POSITION),
            velocity: vector(state, VELOCITY),
            acceleration: vector(slope, VELOCITY),
            payload: Turning::of(state, slope, PAYLOAD),
            stage: Turning::of(state, slope, STAGE),
        }
    }

    fn gap(&self, spring: &ActiveSpring) -> Gap {
        let p = self.payload.point(&spring.payload_point);
        let l = self.stage.point(&spring.stage_point);
        let line = self.offset + p[0] - l[0];
        let velocity = self.velocity + p[1] - l[1];
        let acceleration = self.acceleration + p[2] - l[2];
        let length = line.norm();
        let rate = line.dot(&velocity) / length;
        Gap {
            value: length - spring.free_length,
            rate,
            acceleration: (velocity.norm_squared() + line.dot(&acceleration) - rate * rate)
                / length,
        }
    }
}

/// The state to integrate from.
pub(crate) fn initial_state(separation: &Separation) -> State {
    let (payload, stage) = (separation.payload().state(), separation.stage().state());
    let mut y = [0.0; N];
    put(&mut y, POSITION, &(payload.position - stage.position));
    put(&mut y, VELOCITY, &(payload.velocity - stage.velocity));
    for (at, body) in [(PAYLOAD, payload), (STAGE, stage)] {
        y[at..at + 4].copy_from_slice(body.attitude.coords.as_slice());
        put(&mut y, at + 4, &body.angular_velocity);
    }
    y
}

/// Brings the quaternions back to unit norm.
pub(crate) fn normalize(y: &mut State) {
    for at in [PAYLOAD, STAGE] {
        let norm = y[at..at + 4].iter().map(|x| x * x).sum::<f64>().sqrt();
        for x in &mut y[at..at + 4] {
            *x /= norm;
        }
    }
}

/// The two bodies in a state reached after `time`: the mass centre of the whole has moved
/// uniformly.
pub(crate) fn bodies(separation: &Separation, y: &State, time: f64) -> (MovingBody, MovingBody) {
    let (payload, stage) = (separation.payload(), separation.stage());
    let (mp, ml) = (payload.body().mass_kg(), stage.body().mass_kg());
    let (fp, fl) = (mp / (mp + ml), ml / (mp + ml));
    let velocity = payload.state().velocity * fp + stage.state().velocity * fl;
    let position = payload.state().position * fp + stage.state().position * fl + velocity * time;
    let state = |at: usize, share: f64| BodyState {
        position: position + vector(y, POSITION) * share,
        velocity: velocity + vector(y, VELOCITY) * share,
        attitude: nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(
            y[at + 3],
            y[at],
            y[at + 1],
            y[at + 2],
        )),
        angular_velocity: vector(y, at + 4),
    };
    (payload.body().moving(state(PAYLOAD, fl)), stage.body().moving(state(STAGE, -fp)))
}

/// The error that a step may make in each entry of the state: `tolerance` of what the springs can
/// bring about, but no less than the rounding of the coordinates.
pub(crate) fn tolerances(separation: &Separation, tolerance: f64) -> State {
    let mut allowed = scales(separation).map(|s| s * tolerance);
    let reach: f64 = separation.free_lengths().iter().copied().fold(0.0, f64::max)
        + (separation.payload().state().position - separation.stage().state().position).norm();
    for x in &mut allowed[POSITION..VELOCITY] {
        *x = x.max(f64::EPSILON * reach);
    }
    for at in [PAYLOAD, STAGE] {
        for x in &mut allowed[at..at + 4] {
            *x = x.max(f64::EPSILON);
        }
    }
    allowed
}

/// The size of each entry of the state that the springs can bring about.
fn scales(separation: &Separation) -> State {
    let springs = separation.springs();
    let length = springs.iter().map(Spring::stroke_m).fold(0.0, f64::max);
    let reduced = 1.0
        / (1.0 / separation.payload().body().mass_kg() + 1.0 / separation.stage().body().mass_kg());
    let speed = (2.0 * separation.stored_energy() / reduced).sqrt();
    let arm = springs
        .iter()
        .flat_map(|s| [s.payload_point_m().norm(), s.stage_point_m().norm()])
        .fold(length, f64::max);
    let mut scale = [length; N];
    scale[VELOCITY..PAYLOAD].fill(speed);
    for at in [PAYLOAD, STAGE] {
        scale[at..at + 4].fill(length / arm);
        scale[at + 4..at + 7].fill(speed / arm);
    }
    scale
}

/// A time in which the springs move the bodies a good part of the stroke, s.
pub(crate) fn time_scale(separation: &Separation) -> f64 {
    let scale = scales(separation);
    scale[POSITION] / scale[VELOCITY]
}
