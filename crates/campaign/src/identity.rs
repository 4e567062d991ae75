//! What a campaign is: runs that were made of the same belong together, others do not.

use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fmt};

use crate::hash::sha256;

/// Everything that the runs of a campaign depend on, but how many there are: by field, as text.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Identity(BTreeMap<String, String>);

/// A field in which two campaigns differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The field.
    pub field: String,
    /// What is there; none if the field is not.
    pub there: Option<String>,
    /// What this one has.
    pub here: Option<String>,
}

impl Identity {
    /// Of these fields.
    #[must_use]
    pub fn new(fields: impl IntoIterator<Item = (String, String)>) -> Self {
        Self(fields.into_iter().collect())
    }

    /// A word for it: two campaigns that differ have different ones.
    pub(crate) fn word(&self) -> String {
        let fields = self.0.iter().flat_map(|(field, value)| [field, value]);
        // No field runs into the next one.
        let text: String = fields.map(|text| format!("{}:{text}", text.len())).collect();
        sha256(text)[..16].to_owned()
    }

    /// Where this campaign differs from one that is there.
    #[must_use]
    pub fn difference(&self, there: &Self) -> Option<Difference> {
        let fields = self.0.keys().chain(there.0.keys());
        let field = fields.filter(|field| self.0.get(*field) != there.0.get(*field)).min()?;
        Some(Difference {
            field: field.clone(),
            there: there.0.get(field).cloned(),
            here: self.0.get(field).cloned(),
        })
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let said = |value: &Option<String>| value.as_deref().map_or("not given".to_owned(), short);
        write!(f, "{} is {} there and {} here", self.field, said(&self.there), said(&self.here))
    }
}

/// The beginning of a value, in quotation marks if these are.
fn short(value: &str) -> String {
    const MOST: usize = 60;
    if value.chars().count() <= MOST {
        return value.to_owned();
    }
    let close = value.starts_with('"').then_some('"');
    value.chars().take(MOST).chain(['…']).chain(close).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// One field changed, added or taken away is told, whichever side it is on.
        #[test]
        fn a_difference_is_named(
            fields in prop::collection::btree_map("[a-d]{1,2}", "[0-9]{0,80}", 1..6),
            other in "[x-z]{0,80}",
            at in any::<prop::sample::Index>(),
        ) {
            let here = Identity(fields.clone());
            prop_assert_eq!(here.difference(&here), None);
            prop_assert_eq!(here.word(), here.clone().word());
            let name = fields.keys().nth(at.index(fields.len())).unwrap().clone();
            let mut changed = fields.clone();
            changed.insert(name.clone(), other.clone());
            let mut gone = fields;
            gone.remove(&name);
            for (there, expected) in [(changed, Some(other)), (gone, None)] {
                let there = Identity(there);
                prop_assert_ne!(here.word(), there.word());
                let difference = here.difference(&there).unwrap();
                prop_assert_eq!(&difference.field, &name);
                prop_assert_eq!(&difference.there, &expected);
                prop_assert_eq!(difference.here.as_ref(), here.0.get(&name));
                let said = difference.to_string();
                prop_assert!(said.contains(&name) && said.chars().count() < 160, "{}", said);
            }
        }
    }
}
