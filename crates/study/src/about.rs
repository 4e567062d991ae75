//! What a scenario says of itself: of which vehicle it is, who asks what, and when.

use gyradius_report::{Section, Text};
use serde::{Deserialize, Serialize};

/// The longest of these texts, in bytes.
const LONGEST: usize = 4000;

/// What a scenario says of itself, in words of the user. No run depends on it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct About {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) vehicle: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) question: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) author: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) date: Option<String>,
}

impl About {
    /// Its keys.
    pub(crate) const KEYS: [&str; 4] = ["vehicle", "question", "author", "date"];

    /// The keys, and what they say.
    fn all(&self) -> [(&'static str, &Option<String>); 4] {
        let Self { vehicle, question, author, date } = self;
        let [first, second, third, last] = Self::KEYS;
        [(first, vehicle), (second, question), (third, author), (last, date)]
    }

    /// The keys and what they say, of those that say something.
    fn said(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.all().into_iter().filter_map(|(key, text)| Some((key, text.as_deref()?)))
    }

    /// Whether nothing is said.
    pub(crate) fn is_empty(&self) -> bool {
        self.said().next().is_none()
    }

    /// That what is said are texts that can be shown; else the key, and what is wrong.
    pub(crate) fn check(&self) -> Result<(), (&'static str, String)> {
        for (key, text) in self.said() {
            if text.trim().is_empty() {
                return Err((key, format!("{text:?}: it must have a letter, or be left out")));
            }
            if text.len() > LONGEST {
                return Err((key, format!("{} bytes: at most {LONGEST} are allowed", text.len())));
            }
        }
        Ok(())
    }

    /// What stands first on a page, if anything is said.
    pub(crate) fn section(&self) -> Option<Section> {
        let items = self.said().map(|(key, text)| {
            let mut letters = key.chars();
            let name = letters.next().map(|c| c.to_uppercase().chain(letters).collect::<String>());
            Text::default().strong(name.unwrap_or_default()).plain(format!(": {text}"))
        });
        (!self.is_empty()).then(|| Section::new("What this is about").list(items))
    }
}

#[cfg(test)]
mod tests;
