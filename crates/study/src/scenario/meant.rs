//! Which key was meant where one is not known.

use strsim::levenshtein;

/// What is said of an unknown key begins so, and goes on with a list of those that are known.
const UNKNOWN: &str = "unknown field `";

/// The words that the units in keys are made of, but for powers.
const OF_UNITS: [&str; 10] = ["kg", "m", "s", "n", "j", "rad", "deg", "percent", "per", "sqrt"];

/// The words at the end of a key that tell its unit.
fn unit(key: &str) -> Vec<&str> {
    let is_of_a_unit =
        |word: &&str| OF_UNITS.contains(&word.trim_end_matches(|c: char| c.is_ascii_digit()));
    key.rsplit('_').take_while(is_of_a_unit).collect()
}

/// A reason that names an unknown key, with the known key that is nearly the same, if there is one. What tells another unit is no
/// slip of the pen: the number is in that unit.
pub(super) fn with_meant(reason: &str) -> Option<String> {
    let (key, rest) = reason.strip_prefix(UNKNOWN)?.split_once('`')?;
    let known = rest.split('`').skip(1).step_by(2);
    // A third of its letters: `center` for `centre` are two of six.
    let most = key.chars().count() / 3;
    let apart = known.map(|known| (levenshtein(key, known), known));
    let (apart, meant) = apart.min_by_key(|(letters, _)| *letters)?;
    let list = rest.strip_prefix(", ").map_or(String::new(), |list| format!(" ({list})"));
    let convert =
        if unit(key) == unit(meant) { "" } else { " Convert the number to the unit in that name." };
    (apart <= most).then(|| format!("{UNKNOWN}{key}`: did you mean `{meant}`?{convert}{list}"))
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

    /// Every key of the page that has a unit, as the page writes that unit.
    fn keys_and_units() -> Vec<(&'static str, String)> {
        let page = include_str!("../../../../docs/scenario.md");
        let mut found = Vec::new();
        for row in page.lines().filter(|line| line.starts_with('|')) {
            let cells: Vec<&str> = row.split('|').map(str::trim).collect();
            let [_, _, keys, unit, _, _, _] = cells[..] else { continue };
            let names = [("·", "_"), ("/", "_per_"), ("²", "2"), ("°", "deg"), ("N", "n")];
            let unit =
                names.iter().fold(unit.to_owned(), |unit, (sign, name)| unit.replace(sign, name));
            let is_told = unit.starts_with(|c: char| c.is_ascii_lowercase());
            found.extend(
                keys.split('`')
                    .skip(1)
                    .step_by(2)
                    .filter(|_| is_told)
                    .map(|key| (key, unit.clone())),
            );
        }
        found
    }

    /// Every key in every unit that it is not in: whatever is suggested for that, the number is to be converted.
    #[test]
    fn other_units_are_no_slips_of_the_pen() {
        let keys = keys_and_units();
        assert!(keys.len() > 12, "{keys:?}");
        let all = keys.iter().map(|(key, _)| format!("`{key}`")).collect::<Vec<_>>().join(", ");
        let others = [
            "mm",
            "cm",
            "in",
            "ft",
            "lb",
            "g",
            "t",
            "ms",
            "min",
            "rad",
            "deg",
            "kg",
            "m",
            "s",
            "kn",
            "m_per_s",
            "mm_per_s",
            "cm_per_s",
            "ft_per_s",
            "deg_per_s",
            "rad_per_s",
            "rad_per_ms",
            "n_per_mm",
            "n_per_cm",
            "kn_per_m",
            "kg_mm2",
            "g_m2",
            "lb_ft2",
            "kg_m",
            "kg_cm2",
        ];
        let mut told = 0;
        for (key, own) in &keys {
            let stem = key.strip_suffix(own.as_str()).unwrap_or_else(|| panic!("{key} in {own}"));
            assert_eq!(unit(key), own.rsplit('_').collect::<Vec<_>>(), "{key}");
            let mut slipped = (*key).to_owned();
            slipped.insert(2, 'x');
            let slip =
                with_meant(&format!("unknown field `{slipped}`, expected one of {all}")).unwrap();
            assert!(slip.contains(&format!("did you mean `{key}`? (expected")), "{slip}");
            for other in others.iter().filter(|other| **other != own.as_str()) {
                let wrong = format!("{stem}{other}");
                if keys.iter().any(|(key, _)| *key == wrong) {
                    continue;
                }
                let Some(found) =
                    with_meant(&format!("unknown field `{wrong}`, expected one of {all}"))
                else {
                    continue;
                };
                let same = keys.iter().any(|(key, unit)| {
                    unit == other && found.contains(&format!("did you mean `{key}`?"))
                });
                assert_eq!(
                    found.contains("Convert the number to the unit in that name."),
                    !same,
                    "{found}"
                );
                told += 1;
            }
        }
        assert!(told > keys.len() * 5, "{told}");
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
