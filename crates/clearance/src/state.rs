//! Where a rigid body is and how it moves.

use nalgebra::{UnitQuaternion, Vector3};

/// Where a rigid body is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
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

impl Default for RigidState {
    /// At rest at the origin, axes along the inertial ones.
    fn default() -> Self {
        Self {
            position: Vector3::zeros(),
            velocity: Vector3::zeros(),
            attitude: UnitQuaternion::identity(),
            angular_velocity: Vector3::zeros(),
        }
    }
}
