//! Fields of serialized values that are checked as they are read.

use nalgebra::{Matrix3, Normed, Unit};
use serde::{Deserialize, Deserializer, de::Error};

/// A vector or a quaternion of length one to 1e-9, as it is.
pub(crate) fn unit<'de, D, T>(from: D) -> Result<Unit<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de> + Normed<Norm = f64>,
{
    let read = T::deserialize(from)?;
    let norm = read.norm();
    if !((norm - 1.0).abs() < 1e-9) {
        return Err(D::Error::custom(format!("a length of {norm:?}: it must be 1")));
    }
    Ok(Unit::new_unchecked(read))
}

/// A number that may be infinite, which JSON writes as none.
pub(crate) fn or_infinite<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
}

/// A symmetric matrix without negative variances, to rounding.
pub(crate) fn covariance<'de, D: Deserializer<'de>>(from: D) -> Result<Matrix3<f64>, D::Error> {
    let read = Matrix3::<f64>::deserialize(from)?;
    let rounding = 1e-9 * read.amax();
    if !((read - read.transpose()).amax() <= rounding && read.diagonal().min() >= -rounding) {
        return Err(D::Error::custom(
            "no covariance: it must be symmetric, with positive variances",
        ));
    }
    Ok(read)
}
