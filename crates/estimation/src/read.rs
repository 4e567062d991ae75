//! What is checked of serialized values as they are read.

use serde::{Deserialize, Deserializer, de::Error};

/// A number from 0 to 1.
pub(crate) fn probability<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let read = f64::deserialize(from)?;
    if (0.0..=1.0).contains(&read) {
        return Ok(read);
    }
    Err(D::Error::custom(format!("a probability of {read:?}: it must lie between 0 and 1")))
}

/// Three numbers that may be infinite, which JSON writes as none.
pub(crate) fn or_infinite<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 3], D::Error> {
    Ok(<[Option<f64>; 3]>::deserialize(from)?.map(|x| x.unwrap_or(f64::INFINITY)))
}

/// Refuses deviations and standard errors that no fit has: none scatter, or all are positive.
pub(crate) fn scatter(deviation: f64, errors: Option<[f64; 2]>, still: bool) -> Result<(), String> {
    let positive = errors.iter().flatten().all(|error| *error > 0.0);
    belong(positive && (deviation > 0.0) != still && !(still && errors.is_some()), "fit")
}

/// Refuses what does not belong together.
pub(crate) fn belong(together: bool, what: &str) -> Result<(), String> {
    if together { Ok(()) } else { Err(format!("{what}: the numbers do not belong together")) }
}
