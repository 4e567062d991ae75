//! Types that are written as arrays of numbers.

/// Makes a type of an array, where its constructor allows it, and an array of the type.
macro_rules! array_form {
    ($type:ident as $array:ty, refused by $error:ty, |$values:ident| $read:expr, |$own:ident| $write:expr) => {
        impl TryFrom<$array> for $type {
            type Error = $error;

            fn try_from($values: $array) -> Result<Self, Self::Error> {
                $read
            }
        }

        impl From<$type> for $array {
            fn from($own: $type) -> Self {
                $write
            }
        }
    };
}
pub(crate) use array_form;
