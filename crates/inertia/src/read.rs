//! Fields of serialized values that are checked as they are read.

use nalgebra::{Quaternion, UnitQuaternion};
use serde::{Deserialize, Deserializer, de::Error};

/// A quaternion of length one to 1e-9, as it is.
pub(crate) fn unit<'de, D: Deserializer<'de>>(from: D) -> Result<UnitQuaternion<f64>, D::Error> {
    let read = Quaternion::<f64>::deserialize(from)?;
    let norm = read.norm();
    if !((norm - 1.0).abs() < 1e-9) {
        return Err(D::Error::custom(format!(
            "a quaternion of norm {norm:?}: it must have norm 1"
        )));
    }
    Ok(UnitQuaternion::new_unchecked(read))
}

/// A number that may be none, which JSON writes as nothing.
pub(crate) fn or_nan<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}
