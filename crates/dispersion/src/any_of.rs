//! Enumerations of laws, which are made of any of those that they hold.

/// Makes an enumeration of each of the types that its variants hold.
macro_rules! any_of {
    ($any:ident: $($variant:ident($law:ty)),+ $(,)?) => {$(
        impl From<$law> for $any {
            fn from(law: $law) -> Self {
                Self::$variant(law.into())
            }
        }
    )+};
}
pub(crate) use any_of;
