//! How far the drawn inertia goes with the drawn mass, as it stands in a scenario file.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error, de::Visitor};
use std::fmt;

use super::parse::whole_numbers;

/// The share of the mass's relative change that the inertia takes: `true` is all of it, `false` none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Follows(f64);

impl Follows {
    pub(crate) fn share(self) -> f64 {
        self.0
    }

    /// Whether it does not follow, as is so if nothing is said.
    pub(crate) fn not_at_all(given: &Option<Self>) -> bool {
        given.is_none_or(|follows| follows.0 == 0.0)
    }
}

impl Serialize for Follows {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0 == 0.0 || self.0 == 1.0 {
            serializer.serialize_bool(self.0 == 1.0)
        } else {
            serializer.serialize_f64(self.0)
        }
    }
}

impl<'de> Deserialize<'de> for Follows {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FollowsVisitor)
    }
}

struct FollowsVisitor;

impl Visitor<'_> for FollowsVisitor {
    type Value = Follows;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "true, false, or the share of the mass's relative change that the inertia takes, between 0 \
             and 1",
        )
    }

    fn visit_bool<E>(self, whole: bool) -> Result<Follows, E> {
        Ok(Follows(f64::from(u8::from(whole))))
    }

    fn visit_f64<E: Error>(self, share: f64) -> Result<Follows, E> {
        if (0.0..=1.0).contains(&share) {
            Ok(Follows(share))
        } else {
            Err(E::invalid_value(serde::de::Unexpected::Float(share), &self))
        }
    }

    whole_numbers!();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bools_and_shares() {
        let read = |text: &str| serde_json::from_str::<Follows>(text).map(Follows::share);
        for (text, share) in [("true", 1.0), ("false", 0.0), ("0.25", 0.25), ("1", 1.0), ("0", 0.0)]
        {
            assert_eq!(read(text).unwrap(), share);
        }
        for text in ["-0.1", "1.5", "2", "\"yes\"", "1e300", "[1]"] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains("between 0 and 1"), "{error}");
        }
        for text in ["true", "false", "0.25"] {
            let value: Follows = serde_json::from_str(text).unwrap();
            assert_eq!(serde_json::to_string(&value).unwrap(), text);
        }
    }
}
