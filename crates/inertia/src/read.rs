//! Fields of serialized values that are checked as they are read.

use nalgebra::{Quaternion, UnitQuaternion};
use serde::{Deserialize, Deserializer, de::Error};

/// Reads a type from its fields, and refuses those that do not belong together. The type derives both ways with
/// `serde(remote = "Self")`, which makes functions of them that these use.
macro_rules! belonging {
    ($of:ident) => {
        #[cfg(feature = "serde")]
        impl serde::Serialize for $of {
            fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                $of::serialize(self, to)
            }
        }

        #[cfg(feature = "serde")]
        impl<'de> serde::Deserialize<'de> for $of {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                let read = $of::deserialize(from)?;
                if !read.belongs_together() {
                    let problem = concat!(stringify!($of), ": its fields do not belong together");
                    return Err(serde::de::Error::custom(problem));
                }
                Ok(read)
            }
        }
    };
}
pub(crate) use belonging;

/// A quaternion of length one to 1e-9, as it is.
pub(crate) fn unit<'de, D: Deserializer<'de>>(from: D) -> Result<UnitQuaternion<f64>, D::Error> {
    let read = Quaternion::<f64>::deserialize(from)?;
    let norm = read.norm();
    if !((norm - 1.0).abs() < 1e-9) {
        return Err(D::Error::custom(format!(
            "attitude quaternion of norm {norm:?}: it must have norm 1"
        )));
    }
    Ok(UnitQuaternion::new_unchecked(read))
}

/// Principal moments, of any sign, that are not above what a matrix can have: three times its largest entry, and rounding.
pub(crate) fn principal_moments<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 3], D::Error> {
    const MOST: f64 = 4.0 * crate::MAX_ENTRY;
    let read = <[f64; 3]>::deserialize(from)?;
    if let Some(moment) = read.iter().find(|moment| !(moment.abs() <= MOST)) {
        return Err(D::Error::custom(format!(
            "principal moment = {moment:e} kg·m²: it must be finite and at most {MOST:.1e} in magnitude"
        )));
    }
    Ok(read)
}

/// A number that is finite and not negative.
pub(crate) fn size<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let read = f64::deserialize(from)?;
    if !(read >= 0.0 && read.is_finite()) {
        let problem = format!("{read:?}: it must be a finite number and not negative");
        return Err(D::Error::custom(problem));
    }
    Ok(read)
}

/// Any number, of which one that is not finite is a text: JSON has no such numbers.
pub(crate) mod any {
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    #[derive(Serialize, Deserialize)]
    #[serde(untagged)]
    enum Written {
        Number(f64),
        Text(String),
    }

    pub(crate) fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        let written = Some(*value).filter(|x| x.is_finite()).map(Written::Number);
        written.unwrap_or_else(|| Written::Text(value.to_string())).serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        match Written::deserialize(from)? {
            Written::Number(value) => Ok(value),
            Written::Text(text) => {
                let value = text.parse().ok().filter(|x: &f64| !x.is_finite());
                value.ok_or_else(|| {
                    D::Error::custom(format!("{text:?}: it must be a number, or inf, -inf or NaN"))
                })
            }
        }
    }
}
