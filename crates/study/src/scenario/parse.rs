//! TOML to a scenario file, with the path of the key that is wrong.

use serde::{Deserializer, de};
use serde_path_to_error::{Path, Segment};

use super::file::ScenarioFile;

/// A scenario as it stands in the text, or what is wrong with it: key, line and reason.
pub(super) fn scenario(text: &str) -> Result<ScenarioFile, String> {
    let plain = |error: &toml::de::Error| error.to_string().trim_end().to_owned();
    let toml = toml::Deserializer::parse(text).map_err(|error| plain(&error))?;
    serde_path_to_error::deserialize(toml).map_err(|error| {
        let path = said(error.path());
        let missing = error.inner().message().strip_prefix("missing field `");
        let missing = missing.and_then(|rest| rest.split_once('`')).map(|(name, _)| name);
        let path = match (path.is_empty(), missing) {
            (true, Some(missing)) => missing.to_owned(),
            (false, Some(missing)) => format!("{path}.{missing}"),
            (_, None) => path,
        };
        let message = plain(error.inner());
        if path.is_empty() { message } else { format!("{path}: {message}") }
    })
}

/// As all messages write it: entries of lists are counted from 1.
fn said(path: &Path) -> String {
    let mut out = String::new();
    for segment in path {
        match segment {
            Segment::Seq { index } => out.push_str(&format!("[{}]", index + 1)),
            Segment::Map { key } | Segment::Enum { variant: key } => {
                if !out.is_empty() {
                    out.push('.');
                }
                out.push_str(key);
            }
            Segment::Unknown => {}
        }
    }
    out
}

/// A whole number, which may be written as `1e6` as well.
pub(super) fn whole<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    struct Whole;
    impl de::Visitor<'_> for Whole {
        type Value = u64;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("a whole number that is not negative")
        }

        fn visit_i64<E: de::Error>(self, value: i64) -> Result<u64, E> {
            u64::try_from(value).map_err(|_| E::invalid_value(de::Unexpected::Signed(value), &self))
        }

        fn visit_u64<E>(self, value: u64) -> Result<u64, E> {
            Ok(value)
        }

        fn visit_f64<E: de::Error>(self, value: f64) -> Result<u64, E> {
            whole_number(value).ok_or_else(|| E::invalid_value(de::Unexpected::Float(value), &self))
        }
    }
    deserializer.deserialize_any(Whole)
}

/// A whole number that is written as `1e6`: none if it is negative, has a fraction, or is so large
/// that its last digits are not certain.
#[must_use]
pub fn whole_number(value: f64) -> Option<u64> {
    let certain = (0.0..=2f64.powi(53)).contains(&value) && value.fract() == 0.0;
    certain.then_some(value as u64)
}
