//! How values are read: field by field, and then checked together.

/// Reads a type from its fields, and refuses values that its check refuses.
macro_rules! checked {
    ($(#[$meta:meta])* $of:ident { $($field:ident: $type:ty),+ $(,)? }, $check:expr) => {
        #[cfg(feature = "serde")]
        const _: () = {
            #[derive(serde::Deserialize)]
            $(#[$meta])*
            struct Read {
                $($field: $type,)+
            }

            impl<'de> serde::Deserialize<'de> for $of {
                fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                    let check: fn(&$of) -> Result<(), $crate::StatisticsError> = $check;
                    let Read { $($field,)+ } = serde::Deserialize::deserialize(from)?;
                    let read = $of { $($field),+ };
                    check(&read).map_err(serde::de::Error::custom)?;
                    Ok(read)
                }
            }
        };
    };
}
pub(crate) use checked;
