//! What a file says of a model of inertia beside the nominal body.

use crate::entry_moments::rows;

/// The keys of all models, each with its type: a model takes some of them.
macro_rules! parameters {
    ($($(#[$doc:meta])* $key:ident: $value:ty,)*) => {
        /// The parameters of a model of inertia beside the nominal body, by the keys that they have in scenario files.
        ///
        /// A [`ModelKind`](crate::ModelKind) needs some of them, and refuses the others.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct ModelParameters {
            $($(#[$doc])* pub $key: Option<$value>,)*
        }

        impl ModelParameters {
            /// The keys of all parameters, in the order of files.
            pub const KEYS: &'static [&'static str] = &[$(stringify!($key)),*];

            /// The keys of those that are given.
            pub fn given(&self) -> impl Iterator<Item = &'static str> {
                let there = [$(self.$key.is_some()),*];
                Self::KEYS.iter().zip(there).filter_map(|(key, there)| there.then_some(*key))
            }

            /// These, and where they are silent those of another.
            #[must_use]
            pub fn or(&self, other: &Self) -> Self {
                Self { $($key: self.$key.or(other.$key),)* }
            }

            /// Reads the value of a key that stands next in a map. A key that no model takes is passed over, and its
            /// value left in the map.
            ///
            /// # Errors
            /// The value is of another type than the key's, or the key has been read before.
            #[cfg(feature = "serde")]
            pub fn read<'de, M: serde::de::MapAccess<'de>>(
                &mut self,
                key: &str,
                map: &mut M,
            ) -> Result<(), M::Error> {
                match key {
                    $(stringify!($key) if self.$key.is_some() => {
                        Err(<M::Error as serde::de::Error>::duplicate_field(stringify!($key)))
                    })*
                    $(stringify!($key) => {
                        self.$key = Some(map.next_value()?);
                        Ok(())
                    })*
                    _ => Ok(()),
                }
            }

            /// Writes what is given into a map, with something before each key.
            ///
            /// # Errors
            /// Those of the map.
            #[cfg(feature = "serde")]
            pub fn write<M: serde::ser::SerializeMap>(
                &self,
                before: &str,
                map: &mut M,
            ) -> Result<(), M::Error> {
                $(if let Some(value) = &self.$key {
                    map.serialize_entry(&format!("{before}{}", stringify!($key)), value)?;
                })*
                Ok(())
            }
        }
    };
}
parameters! {
    /// Standard deviations of the entries, kg·m², symmetric.
    deviation_kg_m2: [[f64; 3]; 3],
    /// Covariance of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃, (kg·m²)².
    covariance_kg2_m4: [[f64; 6]; 6],
    /// Covariance of d₁, d₂, d₃, s₁₂, s₂₃, s₁₃.
    log_cholesky_covariance: [[f64; 6]; 6],
    /// Dispersion parameter δ.
    delta: f64,
    /// Standard deviation of what is added to the diagonal, kg·m².
    diagonal_deviation_kg_m2: f64,
    /// Bounds of what is added to the diagonal, kg·m².
    diagonal_bounds_kg_m2: [f64; 2],
    /// Standard deviation of the three angles, rad.
    angle_deviation_rad: f64,
}

impl ModelParameters {
    /// The standard deviations of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃, kg·m², and nothing else.
    #[must_use]
    pub fn of_deviations(deviations: [f64; 6]) -> Self {
        Self { deviation_kg_m2: Some(rows(deviations)), ..Self::default() }
    }
}

/// Why a model is not made of its parameters.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{key}: {problem}")]
pub struct ModelParameterError {
    /// The key that is wrong.
    pub key: &'static str,
    /// Its value and what is allowed.
    pub problem: String,
}

impl ModelParameterError {
    pub(crate) fn new(key: &'static str, problem: &dyn std::fmt::Display) -> Self {
        Self { key, problem: problem.to_string() }
    }

    /// A parameter that is needed and not there.
    pub(crate) fn missing(key: &'static str) -> Self {
        Self::new(key, &"missing")
    }
}
