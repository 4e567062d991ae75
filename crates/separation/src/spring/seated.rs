//! A spring in its place between the bodies.

use nalgebra::{UnitQuaternion, Vector3};

use super::Spring;
use crate::{
    LoadState,
    load::{Gap, Seated, Size},
    state::{self, State},
};

/// Points nearer than this share of the stroke count as touching.
pub(crate) const TOUCHING: f64 = 1e-6;

/// A spring whose release length is known: the distance of its points at the start plus its stroke, less what
/// friction takes of that, where it ceases to push.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SeatedSpring {
    spring: Spring,
    release_length: f64,
}

impl SeatedSpring {
    /// A spring whose points are at a distance from each other at the start, m.
    pub(crate) fn new(spring: Spring, distance: f64) -> Self {
        // One that never pushes only has its place.
        let stroke = if spring.can_push() { spring.travel_m() } else { spring.stroke_m() };
        Self { spring, release_length: distance + stroke }
    }

    pub(crate) fn release_length_m(&self) -> f64 {
        self.release_length
    }

    /// From the stage point to the payload point, payload axes, m.
    fn line(&self, state: &State) -> Vector3<f64> {
        let [payload, stage] = state::relative(state);
        self.spring.line(&payload, &stage)
    }

    /// Of the payload point from the stage point, payload axes, m/s.
    fn velocity(&self, state: &State) -> Vector3<f64> {
        let [payload, stage] = state::relative(state);
        let (p, l) = (self.spring.payload_point_m(), self.spring.stage_point_m());
        payload.velocity + payload.angular_velocity.cross(&p)
            - stage.attitude * stage.angular_velocity.cross(&l)
    }
}

impl Seated for SeatedSpring {
    type Described = Spring;

    fn load(&self) -> &Spring {
        &self.spring
    }

    fn start_s(&self) -> Option<f64> {
        self.spring.start_s().filter(|_| self.spring.can_push())
    }

    fn can_start(&self, state: &State) -> bool {
        self.line(state).norm() > TOUCHING * self.spring.stroke_m()
    }

    fn gap(&self, state: &State) -> Gap {
        let line = self.line(state);
        let length = line.norm();
        Gap { value: length - self.release_length, rate: line.dot(&self.velocity(state)) / length }
    }

    fn speed(&self, state: &State) -> f64 {
        self.velocity(state).norm()
    }

    fn rounding(&self, state: &State) -> f64 {
        let [payload, _] = state::relative(state);
        let reach = payload.position.norm()
            + self.spring.payload_point_m().norm()
            + self.spring.stage_point_m().norm();
        4.0 * f64::EPSILON * reach
    }

    fn stored_energy(&self) -> f64 {
        self.spring.stored_energy()
    }

    fn size(&self) -> Size {
        let (spring, travel) = (&self.spring, self.spring.travel_m());
        Size {
            stroke: spring.stroke_m(),
            travel,
            force: spring.stiffness_n_per_m() * travel,
            arms: [spring.payload_point_m().norm(), spring.stage_point_m().norm()],
            distance: self.release_length - travel,
        }
    }

    fn seen(&self, state: &State, attitude: &UnitQuaternion<f64>, acts: bool) -> LoadState {
        // Not of the two positions, which may be large.
        let line = self.line(state);
        let length = line.norm();
        let compression = self.release_length - length;
        let stiffness = if acts { self.spring.stiffness_n_per_m() } else { 0.0 };
        LoadState {
            pushing: acts,
            length,
            compression,
            force: if acts {
                attitude * (line * (stiffness * compression / length))
            } else {
                Vector3::zeros()
            },
            energy: 0.5 * stiffness * compression * compression,
        }
    }
}
