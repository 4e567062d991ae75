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
    #[cfg_attr(feature = "serde", serde(deserialize_with = "read_attitude"))]
    pub attitude: UnitQuaternion<f64>,
    /// Angular velocity, body axes, rad/s.
    #[cfg_attr(feature = "serde", serde(rename = "angular_velocity_rad_per_s"))]
    pub angular_velocity: Vector3<f64>,
}

/// An attitude of norm 1 to 1e-9, as it is: any other makes a body larger or smaller, and proofs of its clearance wrong.
#[cfg(feature = "serde")]
fn read_attitude<'de, D>(from: D) -> Result<UnitQuaternion<f64>, D::Error>
where
    D: serde::Deserializer<'de>,
{
    let read = <UnitQuaternion<f64> as serde::Deserialize>::deserialize(from)?;
    let norm = read.norm();
    if !((norm - 1.0).abs() < 1e-9) {
        return Err(serde::de::Error::custom(format!(
            "attitude quaternion of norm {norm:?}: it must have norm 1"
        )));
    }
    Ok(read)
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use super::*;
    use nalgebra::{Quaternion, Vector4};
    use proptest::prelude::*;

    proptest! {
        /// An attitude of any length but one is refused; any other comes back as it was.
        #[test]
        fn attitudes_that_are_read_are_of_norm_one(
            q in prop::array::uniform4(-1.0..1.0f64),
            off in prop_oneof![-8.5..3.0f64, Just(f64::NEG_INFINITY)],
        ) {
            let q = Quaternion::from(Vector4::from(q));
            prop_assume!(q.norm() > 0.1);
            let unit = UnitQuaternion::new_normalize(q);
            let scale = 1.0 + 10f64.powf(off);
            for scale in [scale, scale.recip()] {
                let attitude = UnitQuaternion::new_unchecked(unit.into_inner() * scale);
                let state = RigidState { attitude, ..RigidState::default() };
                let read = serde_json::from_str::<RigidState>(&serde_json::to_string(&state).unwrap());
                if scale == 1.0 {
                    prop_assert_eq!(read.unwrap(), state);
                } else {
                    let error = read.unwrap_err().to_string();
                    prop_assert!(error.starts_with("attitude quaternion of norm "), "{error}");
                }
            }
        }
    }
}
