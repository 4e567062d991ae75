//! How values are read: field by field, as they are declared, and then checked together.

/// Reads a type from its fields, and refuses values that its check refuses. The type derives both ways with
/// `serde(remote = "Self")`, which makes functions of them that these use.
macro_rules! checked {
    ($of:ident, $check:expr $(,)?) => {
        #[cfg(feature = "serde")]
        impl serde::Serialize for $of {
            fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                $of::serialize(self, to)
            }
        }

        #[cfg(feature = "serde")]
        impl<'de> serde::Deserialize<'de> for $of {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                let check: fn(&$of) -> Result<(), $crate::StatisticsError> = $check;
                let read = $of::deserialize(from)?;
                check(&read).map_err(serde::de::Error::custom)?;
                Ok(read)
            }
        }
    };
}
pub(crate) use checked;
