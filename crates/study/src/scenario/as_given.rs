//! What another crate reads and checks, kept as it stands in a scenario file.

use gyradius_dispersion::MassPropertiesLaw;
use gyradius_inertia::Region;
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{DeserializeOwned, Error},
};
use toml::Table;

use super::{parse::unknown, placed::Placed};

/// A table as given, and what it says: what is written again need not have the same bits.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AsGiven<T> {
    given: Table,
    said: T,
}

/// What can be said by a table.
pub(crate) trait Said: DeserializeOwned {
    /// What is wrong with the keys of the table, where the type would not name it.
    fn wrong_keys(given: &Table) -> Option<String>;
}

impl<T> AsGiven<T> {
    /// What it says.
    pub(crate) fn said(&self) -> &T {
        &self.said
    }
}

impl<T> Serialize for AsGiven<T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.given.serialize(to)
    }
}

impl<'de, T: Said> Deserialize<'de> for AsGiven<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let given = Table::deserialize(from)?;
        if let Some(problem) = T::wrong_keys(&given) {
            return Err(D::Error::custom(problem));
        }
        let said = T::deserialize(Placed(given.clone().into())).map_err(|error| {
            let path = error.said();
            D::Error::custom(if path.is_empty() {
                error.reason
            } else {
                format!("{path}: {}", error.reason)
            })
        })?;
        Ok(Self { given, said })
    }
}

impl Said for MassPropertiesLaw {
    fn wrong_keys(_: &Table) -> Option<String> {
        None
    }
}

/// A region is one of three, which its type would not say.
impl Said for Region {
    fn wrong_keys(given: &Table) -> Option<String> {
        const KINDS: [&str; 3] = ["ellipsoid", "box", "hull"];
        let wrong = given.keys().find(|key| !KINDS.contains(&key.as_str()));
        match wrong {
            Some(key) => Some(unknown(key, KINDS)),
            None if given.len() == 1 => None,
            None => Some("there must be exactly one of `ellipsoid`, `box`, `hull`".to_owned()),
        }
    }
}
