//! Solids that pictures draw: the uniform box of a body, and the ring of an outline.

use gyradius_separation::MovingBody;
use nalgebra::{UnitQuaternion, Vector3};

/// Sides and attitude of the uniform box with the mass and inertia of a body: sides √(12 K/m) along the principal axes, zero where K
/// is negative. The attitude takes components along the sides to body components.
pub(crate) fn uniform_box(body: &MovingBody) -> ([f64; 3], UnitQuaternion<f64>) {
    let principal = body.body().inertia().principal_axes();
    let sides =
        principal.second_moments().map(|k| (12.0 * k.max(0.0) / body.body().mass_kg()).sqrt());
    (sides, UnitQuaternion::from_rotation_matrix(&principal.axes()))
}

/// Two radii of a ring at right angles, about an axis of any length.
pub(crate) fn radii(axis: [f64; 3], radius: f64) -> [Vector3<f64>; 2] {
    let axis = Vector3::from(axis);
    let axis = axis / axis.amax();
    let mut across = Vector3::zeros();
    across[axis.iamin()] = 1.0;
    let across = axis.cross(&across).normalize() * radius;
    [across, axis.normalize().cross(&across)]
}
