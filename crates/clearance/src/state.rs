//! Where a rigid body is and how it moves.

use nalgebra::{UnitQuaternion, Vector3};

/// Where a rigid body is and how it moves; by default at rest at the origin, axes along the inertial ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct RigidState {
    /// Mass centre, inertial axes, m.
    #[cfg_attr(feature = "serde", serde(rename = "position_m"))]
    pub position: Vector3<f64>,
    /// Velocity of the mass centre, inertial axes, m/s.
    #[cfg_attr(feature = "serde", serde(rename = "velocity_m_per_s"))]
    pub velocity: Vector3<f64>,
    /// Takes body components to inertial components.
    pub attitude: UnitQuaternion<f64>,
    /// Angular velocity, body axes, rad/s.
    #[cfg_attr(feature = "serde", serde(rename = "angular_velocity_rad_per_s"))]
    pub angular_velocity: Vector3<f64>,
}
