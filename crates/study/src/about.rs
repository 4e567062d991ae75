//! What a scenario says of itself: of which vehicle it is, who asks what, and when.

use gyradius_report::{Section, Text};
use serde::{Deserialize, Serialize};

use crate::ScenarioError;

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

    /// That what is said is a text that can be shown.
    pub(crate) fn check(&self) -> Result<(), ScenarioError> {
        for (key, text) in self.said() {
            let problem = if text.trim().is_empty() {
                "it must have a letter, or be left out".to_owned()
            } else if text.len() > LONGEST {
                format!("{} bytes: at most {LONGEST} are allowed", text.len())
            } else {
                continue;
            };
            return Err(ScenarioError::field(key, problem));
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
mod tests {
    use super::*;
    use crate::{Scenario, study::identity};
    use proptest::prelude::*;

    /// The keys, with a text for each that has one.
    fn scenario(texts: &[Option<String>]) -> Result<Scenario, ScenarioError> {
        let paper = Scenario::peck_2003().unwrap().to_toml();
        let keys = About::KEYS.iter().zip(texts);
        let keys: String = keys
            .filter_map(|(key, text)| {
                Some(format!("{key} = {}\n", toml::Value::from(text.clone()?)))
            })
            .collect();
        Scenario::from_toml(&format!("{keys}{paper}"))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        /// Any of the keys with any words: they stand in the resolved scenario and read back, no run depends on them, and the others
        /// leave everything as it is.
        #[test]
        fn words_change_no_runs(texts in prop::collection::vec(prop::option::of("[a-zA-Zé<>&|*\"']\\PC{0,30}"), 4)) {
            let plain = Scenario::peck_2003().unwrap();
            let scenario = scenario(&texts).unwrap();
            prop_assert!(identity(&plain).difference(&identity(&scenario)).is_none());
            let again = Scenario::from_toml(&scenario.to_toml()).unwrap();
            prop_assert_eq!(again.about(), scenario.about());
            let said: Vec<&str> = scenario.about().all().into_iter().filter(|(_, t)| t.is_some()).map(|(key, _)| key).collect();
            let expected = About::KEYS.iter().zip(&texts).filter(|(_, text)| text.is_some()).map(|(key, _)| *key);
            prop_assert_eq!(said, expected.collect::<Vec<_>>());
            let nothing = texts.iter().all(Option::is_none);
            prop_assert_eq!(scenario.fingerprint() == plain.fingerprint(), nothing);
            prop_assert_eq!(scenario.about().section().is_none(), nothing);
            prop_assert_eq!(scenario.about().is_empty(), nothing);
            let written = serde_json::to_string(&scenario.about()).unwrap();
            prop_assert_eq!(serde_json::from_str::<About>(&written).unwrap(), scenario.about());
        }
    }

    #[test]
    fn what_is_no_text_is_refused() {
        for (place, key) in About::KEYS.iter().enumerate() {
            for wrong in [String::new(), " \n".to_owned(), "x".repeat(LONGEST + 1)] {
                let mut texts = vec![None; 4];
                texts[place] = Some(wrong);
                let error = scenario(&texts).unwrap_err().to_string();
                assert!(error.starts_with(key), "{error}");
            }
        }
    }
}
