//! Which key was meant where one is not known.

use strsim::levenshtein;

/// What is said of an unknown key begins so, and goes on with a list of those that are known.
const UNKNOWN: &str = "unknown field `";

/// A reason that names an unknown key, with the known key that is nearly the same, if there is one.
pub(super) fn with_meant(reason: &str) -> Option<String> {
    let (key, rest) = reason.strip_prefix(UNKNOWN)?.split_once('`')?;
    let known = rest.split('`').skip(1).step_by(2);
    // A third of its letters: `center` for `centre` are two of six.
    let most = key.chars().count() / 3;
    let apart = known.map(|known| (levenshtein(key, known), known));
    let (apart, meant) = apart.min_by_key(|(letters, _)| *letters)?;
    let list = rest.strip_prefix(", ").map_or(String::new(), |list| format!(" ({list})"));
    (apart <= most).then(|| format!("{UNKNOWN}{key}`: did you mean `{meant}`?{list}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KNOWN: [&str; 6] = ["moments", "products", "axes", "mass", "centre", "inside"];

    fn reason(key: &str) -> String {
        let known: Vec<String> = KNOWN.iter().map(|key| format!("`{key}`")).collect();
        format!("unknown field `{key}`, expected one of {}", known.join(", "))
    }

    #[test]
    fn spellings_are_told() {
        for (key, meant) in [
            ("center", Some("centre")),
            ("moment", Some("moments")),
            ("axis", Some("axes")),
            ("masses", Some("mass")),
            ("colour", None),
            ("x", None),
            ("", None),
        ] {
            let found = with_meant(&reason(key));
            assert_eq!(found.is_some(), meant.is_some(), "{key}: {found:?}");
            if let (Some(found), Some(meant)) = (found, meant) {
                assert!(found.contains(&format!("`{key}`: did you mean `{meant}`?")), "{found}");
                assert!(found.ends_with("`inside`)"), "{found}");
            }
        }
        let single = with_meant("unknown field `masss`, expected `mass`").unwrap();
        assert_eq!(single, "unknown field `masss`: did you mean `mass`? (expected `mass`)");
        assert_eq!(with_meant("missing field `mass`"), None);
    }

    proptest! {
        /// The number of changes is a distance, and a letter changed is one of them.
        #[test]
        fn changes_are_a_distance(a in "[a-c]{0,8}", b in "[a-c]{0,8}", c in "[a-c]{0,8}", place in 0..8_usize) {
            prop_assert_eq!(levenshtein(&a, &b), levenshtein(&b, &a));
            prop_assert_eq!(levenshtein(&a, &b) == 0, a == b);
            prop_assert!(levenshtein(&a, &c) <= levenshtein(&a, &b) + levenshtein(&b, &c));
            let mut other = a.clone();
            other.insert(place.min(a.len()), 'z');
            prop_assert_eq!(levenshtein(&a, &other), 1);
        }
    }
}
