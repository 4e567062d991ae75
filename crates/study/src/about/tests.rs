//! Words of the user: read back, refused, and without effect on runs.

use super::*;
use crate::{Scenario, ScenarioError, contents::identity, scenario::Framed};
use proptest::prelude::*;

/// The keys, with a text for each that has one.
fn scenario(texts: &[Option<String>]) -> Result<Scenario, ScenarioError> {
    let paper = Scenario::peck_2003().unwrap().to_toml();
    let keys = About::KEYS.iter().zip(texts);
    let keys: String = keys
        .filter_map(|(key, text)| Some(format!("{key} = {}\n", toml::Value::from(text.clone()?))))
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
