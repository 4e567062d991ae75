//! Two bodies and their loads as they are mounted, off from their nominal places as one likes.

use gyradius_inertia::{InertiaMatrix, MassProperties};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use smallvec::SmallVec;

use crate::{
    AnyLoad, Body, BodyParameter, BodyState, LoadError, LoadId, LoadParameter, MovingBody, Role,
    Separation, SeparationError, StackParameter,
    layout::INLINE_LOADS,
    load::{Placing, Values, line},
};

/// Payload and stage as they sit on each other, and the loads mounted between points of their
/// structures: the builder of a [`Separation`] whose mass centres, attitudes, lines of action and the like
/// differ from the nominal ones.
///
/// Mass centres move in structures that stay where they are, and so do the points that loads are attached
/// to. A line of action turns about its stage point and keeps its length. The whole turns, and begins to turn,
/// about the common mass centre as one rigid body.
///
/// ```
/// use gyradius_inertia::Shape;
/// use gyradius_separation::{BodyState, Role, Spring, Stack};
/// use nalgebra::Vector3;
///
/// // Each body in a frame of its own, here with origin in the plane of separation.
/// let payload = Shape::solid_box([1.0, 1.0, 2.0])?.of_mass(500.0)?;
/// let payload = payload.translated(Vector3::new(0.01, 0.0, 1.0))?;
/// let stage = Shape::sphere(0.5)?.of_mass(900.0)?.translated(Vector3::z() * -1.5)?;
/// let up = |z| BodyState { position: Vector3::z() * z, ..BodyState::default() };
/// let mut stack = Stack::new((&payload, up(0.1)), (&stage, up(0.0)));
/// for (x, y) in [(0.4, 0.4), (-0.4, 0.4), (-0.4, -0.4), (0.4, -0.4)] {
///     let point = Vector3::new(x, y, 0.0);
///     stack = stack.with_load(Spring::new(2e4, 0.05, point, point)?);
/// }
/// let separation = stack.separation()?;
/// // Springs count their points from the mass centre, which is off the axis.
/// let first = separation.springs().next().ok_or("a spring")?;
/// assert!((first.payload_point_m().x - 0.39).abs() < 1e-12);
/// assert_eq!(Role::Payload.to_string(), "payload");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stack {
    /// Payload and stage.
    bodies: [Placed; 2],
    /// Rotation and angular velocity of the whole, stage axes, rad and rad/s.
    rotation: Vector3<f64>,
    rate: Vector3<f64>,
    loads: Vec<Mounted>,
}

/// A body in its place. Position and velocity are those of the origin of a frame in its structure.
#[derive(Clone, Copy, Debug)]
struct Placed {
    inertia: InertiaMatrix,
    mass: f64,
    /// From the origin of the frame to the mass centre, body axes, m.
    centre: Vector3<f64>,
    /// From the nominal attitude, body axes, rad.
    rotation: Vector3<f64>,
    state: BodyState,
    nominal: BodyState,
}

/// A load in its place, points from the origins of the bodies' frames.
#[derive(Clone, Debug)]
struct Mounted {
    /// From its stage point to its payload point where everything is in its nominal place, stage axes, m.
    nominal_line: Vector3<f64>,
    nominal: AnyLoad,
    values: Values,
    fails: bool,
}

impl Stack {
    /// Payload and stage, each in a frame of its own, and the states of those frames: where their origins
    /// are and how they move. Points of loads are given in these frames.
    #[must_use]
    pub fn new(payload: (&MassProperties, BodyState), stage: (&MassProperties, BodyState)) -> Self {
        let placed = |(properties, state): (&MassProperties, BodyState)| {
            let inertia = *properties.inertia().as_inertia_matrix();
            let centre = properties.mass_centre_m();
            Placed { centre, ..Placed::new(properties.mass_kg(), inertia, state) }
        };
        Self::of([placed(payload), placed(stage)])
    }

    fn of(bodies: [Placed; 2]) -> Self {
        Self { bodies, rotation: Vector3::zeros(), rate: Vector3::zeros(), loads: Vec::new() }
    }

    /// The same with another load, a spring say.
    #[must_use]
    pub fn with_load(mut self, load: impl Into<AnyLoad>) -> Self {
        let load = load.into();
        let [payload, stage] = self.bodies.each_ref().map(|body| &body.nominal);
        self.loads.push(Mounted {
            nominal_line: stage.attitude.inverse() * load.line(payload, stage),
            nominal: load,
            values: load.values(),
            fails: load.start_s().is_none(),
        });
        self
    }

    /// Gives a body another inertia about its mass centre, kg·m².
    pub fn set_inertia(&mut self, role: Role, inertia: impl Into<InertiaMatrix>) {
        self.bodies[role as usize].inertia = inertia.into();
    }

    /// Gives a component of a parameter of a body another value, in the parameter's unit. Components count
    /// from 0; one that there is not is left alone.
    pub fn set_body(&mut self, role: Role, parameter: BodyParameter, component: usize, value: f64) {
        let body = &mut self.bodies[role as usize];
        match parameter {
            BodyParameter::Mass if component == 0 => body.mass = value,
            BodyParameter::Mass => {}
            BodyParameter::MassCentre => put(&mut body.centre, component, value),
            BodyParameter::Position => put(&mut body.state.position, component, value),
            BodyParameter::Velocity => put(&mut body.state.velocity, component, value),
            BodyParameter::Attitude => put(&mut body.rotation, component, value.to_radians()),
            BodyParameter::AngularVelocity => {
                put(&mut body.state.angular_velocity, component, value);
            }
        }
    }

    /// The same of the whole.
    pub fn set_whole(&mut self, parameter: StackParameter, component: usize, value: f64) {
        match parameter {
            StackParameter::Attitude => put(&mut self.rotation, component, value.to_radians()),
            StackParameter::AngularVelocity => put(&mut self.rate, component, value),
        }
    }

    /// The same of a load, by its place among all, from 0. A parameter of another kind is left alone.
    pub fn set_load(
        &mut self,
        load: usize,
        parameter: impl Into<LoadParameter>,
        component: usize,
        value: f64,
    ) {
        let Some(load) = self.loads.get_mut(load) else { return };
        let place = load.nominal.place(parameter.into(), component);
        if let Some(entry) = place.and_then(|place| load.values.get_mut(place)) {
            *entry = value;
        }
    }

    /// Lets a load, by its place among all, from 0, fail: it never acts.
    pub fn fail_load(&mut self, load: usize) {
        if let Some(load) = self.loads.get_mut(load) {
            load.fails = true;
        }
    }

    /// How a body stands when the separation begins, from body to inertial axes.
    #[must_use]
    pub fn attitude(&self, role: Role) -> UnitQuaternion<f64> {
        let own = |role: Role| self.bodies[role as usize].attitude();
        self.turned(&own(Role::Stage)) * own(role)
    }

    /// The separation that begins so.
    ///
    /// # Errors
    /// A value makes no body or no load, or bodies and loads make no separation.
    pub fn separation(&self) -> Result<Separation, SeparationError> {
        let body = |role: Role| {
            let placed = &self.bodies[role as usize];
            Body::new(placed.mass, placed.inertia)
                .map_err(|problem| SeparationError::Body { body: role, problem })
        };
        let (payload, stage) = (body(Role::Payload)?, body(Role::Stage)?);
        let mut states = self.bodies.each_ref().map(Placed::state);
        let mut loads: SmallVec<[AnyLoad; INLINE_LOADS]> = SmallVec::new();
        for mounted in &self.loads {
            loads.push(self.load(mounted, &states).map_err(|problem| {
                let kind = mounted.nominal.kind();
                let number = loads.iter().filter(|load| load.kind() == kind).count();
                SeparationError::Load { load: LoadId { kind, number }, problem }
            })?);
        }
        self.move_whole(&mut states);
        let [payload_state, stage_state] = states;
        Separation::new(payload.moving(payload_state), stage.moving(stage_state), &loads)
    }

    /// A load with its line turned about its stage point: where it then meets the payload, at the
    /// same length, it pushes.
    fn load(
        &self,
        mounted: &Mounted,
        [payload, stage]: &[BodyState; 2],
    ) -> Result<AnyLoad, LoadError> {
        let Placing { points, line_of_action } = mounted.nominal.placing();
        let mut values = mounted.values.clone();
        let [payload_centre, stage_centre] = self.bodies.each_ref().map(|body| body.centre);
        let point = |at: usize| Vector3::from_fn(|i, _| mounted.values[at + i]);
        let stage_point = point(points[1]) - stage_centre;
        let mut point = point(points[0]) - payload_centre;
        let tilt =
            line_of_action.map_or([0.0; 2], |at| [mounted.values[at], mounted.values[at + 1]]);
        let tilt = tilt.map(f64::to_radians);
        if tilt != [0.0; 2] {
            let line = stage.attitude.inverse() * line([point, stage_point], payload, stage);
            // Of the next axis, what is perpendicular to the line.
            let axis = Vector3::ith((nearest_axis(&mounted.nominal_line) + 1) % 3, 1.0);
            let unit = normalized(&line);
            let first = normalized(&(axis - unit * unit.dot(&axis)));
            let second = unit.cross(&first);
            let tilt = rotation(&(first * tilt[0] + second * tilt[1]));
            let shift = stage.attitude * (tilt * line - line);
            point += payload.attitude.inverse() * shift;
        }
        for (at, point) in points.into_iter().zip([point, stage_point]) {
            values[at..at + 3].copy_from_slice(point.as_slice());
        }
        mounted.nominal.of_values(&values, mounted.fails)
    }

    /// How the whole is turned, of which the stage alone stands so.
    fn turned(&self, stage: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        rotation(&(stage * self.rotation))
    }

    /// Turns both bodies about their common mass centre and sets them turning, as one rigid body.
    fn move_whole(&self, states: &mut [BodyState; 2]) {
        let zero = Vector3::zeros();
        if self.rotation == zero && self.rate == zero {
            return;
        }
        let masses = self.bodies.each_ref().map(|body| body.mass);
        let total = masses[0] + masses[1];
        let mean = |of: fn(&BodyState) -> Vector3<f64>| {
            of(&states[0]) * (masses[0] / total) + of(&states[1]) * (masses[1] / total)
        };
        let (centre, velocity) = (mean(|s| s.position), mean(|s| s.velocity));
        let axes = states[1].attitude;
        let turned = self.turned(&axes);
        let rate = turned * (axes * self.rate);
        for state in states {
            let arm = turned * (state.position - centre);
            state.position = centre + arm;
            state.velocity = velocity + turned * (state.velocity - velocity) + rate.cross(&arm);
            state.attitude = turned * state.attitude;
            state.angular_velocity += state.attitude.inverse() * rate;
        }
    }
}

impl From<&Separation> for Stack {
    /// The frames of the bodies have their origins in the mass centres.
    fn from(nominal: &Separation) -> Self {
        let placed = |moving: &MovingBody| {
            let body = moving.body();
            Placed::new(body.mass_kg(), *body.inertia(), *moving.state())
        };
        let stack = Self::of([placed(nominal.payload()), placed(nominal.stage())]);
        nominal.loads().fold(stack, |stack, (_, load)| stack.with_load(load))
    }
}

impl Placed {
    fn new(mass: f64, inertia: InertiaMatrix, state: BodyState) -> Self {
        let zero = Vector3::zeros();
        Self { inertia, mass, centre: zero, rotation: zero, state, nominal: state }
    }

    /// The attitude, but for that of the whole.
    fn attitude(&self) -> UnitQuaternion<f64> {
        self.state.attitude * rotation(&self.rotation)
    }

    /// The state of the mass centre.
    fn state(&self) -> BodyState {
        BodyState { attitude: self.attitude(), ..self.state }.of_point(&self.centre)
    }
}

fn put(vector: &mut Vector3<f64>, component: usize, value: f64) {
    if let Some(entry) = vector.as_mut_slice().get_mut(component) {
        *entry = value;
    }
}

/// The axis that a direction is nearest to: of several that it is as near to, to a millionth, the last one. The rounding of how the
/// bodies stand must not choose.
fn nearest_axis(direction: &Vector3<f64>) -> usize {
    let nearest = direction.amax() * (1.0 - 1e-6);
    (0..3).rfind(|axis| direction[*axis].abs() >= nearest).unwrap_or(2)
}

fn normalized(v: &Vector3<f64>) -> Vector3<f64> {
    v.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
}

/// The rotation by a rotation vector, rad, of functions that are the same on every machine.
fn rotation(vector: &Vector3<f64>) -> UnitQuaternion<f64> {
    let half = 0.5 * vector.norm();
    let (sin, cos) = libm::sincos(half);
    let sinc = if half > 0.0 { sin / half } else { 1.0 };
    let v = vector * (0.5 * sinc);
    UnitQuaternion::new_normalize(Quaternion::new(cos, v.x, v.y, v.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Parameter, Settings, Spring, SpringParameter};
    use gyradius_inertia::Shape;
    use proptest::prelude::*;

    fn vector(range: f64) -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(-range..range).prop_map(Vector3::from)
    }

    fn near(a: &BodyState, b: &BodyState, shift: &Vector3<f64>) -> bool {
        (a.position - b.position - shift).norm() < 1e-11
            && (a.velocity - b.velocity).norm() < 1e-11
            && (a.angular_velocity - b.angular_velocity).norm() < 1e-11
            && a.attitude.angle_to(&b.attitude) < 1e-11
    }

    proptest! {
        /// Bodies stand as they do in the separation that begins so.
        #[test]
        fn attitudes_are_those_of_the_separation(
            turns in [vector(2.0), vector(2.0)],
            own in [vector(120.0), vector(120.0)],
            whole in vector(180.0),
            which in 0..8_u8,
        ) {
            let inertia = InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.0; 3]).unwrap();
            let body = |i: usize| {
                let attitude = UnitQuaternion::from_scaled_axis(turns[i]);
                let position = Vector3::z() * (1.0 - 2.0 * i as f64);
                let state = BodyState { position, attitude, ..BodyState::default() };
                Body::new(10.0, inertia).unwrap().moving(state)
            };
            let spring = Spring::new(4e4, 0.05, Vector3::x() * 1.1, Vector3::x()).unwrap();
            let nominal = Separation::new(body(0), body(1), &[spring]).unwrap();
            let mut stack = Stack::from(&nominal);
            for i in 0..3 {
                for role in [Role::Payload, Role::Stage] {
                    if which & 1 << role as u8 != 0 {
                        stack.set_body(role, BodyParameter::Attitude, i, own[role as usize][i]);
                    }
                }
                if which & 4 != 0 {
                    stack.set_whole(StackParameter::Attitude, i, whole[i]);
                }
            }
            let begun = stack.separation().unwrap();
            for (role, moving) in [(Role::Payload, begun.payload()), (Role::Stage, begun.stage())] {
                prop_assert!(stack.attitude(role).angle_to(&moving.state().attitude) < 1e-12);
            }
        }

        /// A separation does not know in which frames its bodies were described: wherever the origins of
        /// the frames lie in the structures, the same bodies part in the same way.
        #[test]
        fn frames_of_bodies_do_not_matter(
            origins in [vector(2.0), vector(2.0)],
            centres in [vector(0.3), vector(0.3)],
            rates in [vector(0.2), vector(0.2)],
            turns in [vector(0.3), vector(0.3)],
            sides in prop::collection::vec(vector(0.5), 1..5),
        ) {
            let outcome = |origins: [Vector3<f64>; 2]| {
                let bodies: Vec<_> = (0..2).map(|i| {
                    let shape = Shape::solid_box([1.0, 1.5, 2.0 + i as f64]).unwrap();
                    let body = shape.of_mass(300.0 + 200.0 * i as f64).unwrap();
                    let state = BodyState {
                        position: Vector3::z() * (2.0 - 2.2 * i as f64),
                        attitude: UnitQuaternion::from_scaled_axis(turns[i]),
                        angular_velocity: rates[i],
                        ..BodyState::default()
                    };
                    (body.translated(centres[i] - origins[i]).unwrap(), state.of_point(&origins[i]))
                }).collect();
                let mut stack = Stack::new((&bodies[0].0, bodies[0].1), (&bodies[1].0, bodies[1].1));
                for side in &sides {
                    let (low, high) = (Vector3::z() * -0.9, Vector3::z() * 1.0);
                    let points = [side + low - origins[0], side + high - origins[1]];
                    stack = stack.with_load(Spring::new(4e4, 0.05, points[0], points[1]).unwrap());
                }
                stack.separation().unwrap().run(&Settings::default()).unwrap()
            };
            let (own, moved) = (outcome([Vector3::zeros(); 2]), outcome(origins));
            prop_assert!((own.release_time() - moved.release_time()).abs() < 1e-11);
            let zero = Vector3::zeros();
            prop_assert!(near(own.payload().state(), moved.payload().state(), &zero));
            prop_assert!(near(own.stage().state(), moved.stage().state(), &zero));
        }

        /// A stack in its nominal place is the separation that it was made from, to the bit, whatever its
        /// springs; and every component of every parameter, set to its nominal value, leaves it there.
        #[test]
        fn nominal_values_change_nothing(
            sides in prop::collection::vec((vector(0.5), 0..3_u32), 1..5),
            place in vector(1.0),
        ) {
            let springs: Vec<_> = sides.iter().enumerate().map(|(i, (side, kind))| {
                let points = [side - Vector3::z() * 0.9, side + Vector3::z() * 0.9];
                let spring = Spring::new(3e4, 0.1, points[0], points[1]).unwrap();
                match kind {
                    1 => spring.with_friction(20.0).unwrap().starting_at(0.01).unwrap(),
                    2 if i > 0 => spring.never_pushing(),
                    _ => spring,
                }
            }).collect();
            let inertia = InertiaMatrix::from_entries([50.0, 40.0, 30.0], [1.0, -2.0, 0.5]).unwrap();
            let body = |mass| Body::new(mass, inertia).unwrap();
            let nominal = Separation::new(
                body(200.0).at(place + Vector3::z()),
                body(90.0).at(place - Vector3::z()),
                &springs,
            ).unwrap();
            let mut stack = Stack::from(&nominal);
            for role in Role::BOTH {
                let moving = if role == Role::Payload { nominal.payload() } else { nominal.stage() };
                for &parameter in BodyParameter::ALL {
                    for (i, value) in parameter.nominal(moving).into_iter().enumerate() {
                        stack.set_body(role, parameter, i, value);
                    }
                    for none in parameter.nominal(moving).len()..9 {
                        stack.set_body(role, parameter, none, 1e9);
                    }
                }
            }
            for &parameter in StackParameter::ALL {
                for (i, value) in parameter.nominal(&()).into_iter().enumerate() {
                    stack.set_whole(parameter, i, value);
                }
                stack.set_whole(parameter, 3, 1e9);
            }
            for (k, spring) in nominal.springs().enumerate() {
                for &parameter in SpringParameter::ALL {
                    for (i, value) in parameter.nominal(spring).into_iter().enumerate() {
                        stack.set_load(k, parameter, i, value);
                    }
                }
            }
            for found in [Stack::from(&nominal), stack] {
                let found = found.separation().unwrap();
                prop_assert!(found.springs().eq(nominal.springs()));
                prop_assert!(found.release_lengths().eq(nominal.release_lengths()));
                prop_assert_eq!((found.payload(), found.stage()), (nominal.payload(), nominal.stage()));
            }
        }
    }
}
