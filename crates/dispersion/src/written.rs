//! How values are written and read: each key is declared once, and what is read goes through a constructor.

/// Declares the keys of a type with what is written of a value, and how a value is made of what was read, where `?` refuses.
#[doc(hidden)]
#[macro_export]
macro_rules! written {
    ($of:ident, |$value:ident| { $($(#[$key_meta:meta])* $key:ident: $type:ty = $write:expr,)+ }, $read:expr) => {
        #[cfg(feature = "serde")]
        const _: () = {
            #[derive(serde::Serialize, serde::Deserialize)]
            #[serde(deny_unknown_fields)]
            struct Keys {
                $($(#[$key_meta])* $key: $type,)+
            }

            impl Keys {
                fn read(self) -> Result<$of, Box<dyn std::error::Error>> {
                    let Self { $($key,)+ } = self;
                    Ok($read)
                }
            }

            impl serde::Serialize for $of {
                fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                    let $value = self;
                    serde::Serialize::serialize(&Keys { $($key: $write,)+ }, to)
                }
            }

            impl<'de> serde::Deserialize<'de> for $of {
                fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                    let keys: Keys = serde::Deserialize::deserialize(from)?;
                    keys.read().map_err(serde::de::Error::custom)
                }
            }
        };
    };
}
