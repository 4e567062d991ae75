//! Where a rigid body is and how it moves.

use nalgebra::{UnitQuaternion, Vector3};

/// Where a rigid body is and how it moves; by default at rest at the origin, axes along the inertial ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigidState {
    /// Mass centre, inertial axes, m.
    pub position: Vector3<f64>,
    /// Velocity of the mass centre, inertial axes, m/s.
    pub velocity: Vector3<f64>,
    /// Takes body components to inertial components.
    pub attitude: UnitQuaternion<f64>,
    /// Angular velocity, body axes, rad/s.
    pub angular_velocity: Vector3<f64>,
}
