//! Links by their names, in which `*` and `?` stand for others.

use super::RobotDrawError;
use gyradius_formats::WithoutInertia;

/// Which of the links with inertia some names mean: all of them if there are no names.
pub(super) fn picked(
    links: &[&str],
    without: &[(String, WithoutInertia)],
    patterns: &[String],
) -> Result<Vec<bool>, RobotDrawError> {
    if patterns.is_empty() {
        return Ok(vec![true; links.len()]);
    }
    for pattern in patterns {
        if links.iter().any(|link| matches(pattern, link)) {
            continue;
        }
        let why = match without.iter().find(|(link, _)| matches(pattern, link)) {
            Some((link, why)) => format!("\"{link}\": {why}"),
            None => {
                let some: Vec<&str> = links.iter().take(20).copied().collect();
                let more = if links.len() > some.len() { ", …" } else { "" };
                format!("no link matches it; the links with inertia are {}{more}", some.join(", "))
            }
        };
        return Err(RobotDrawError::Pattern { pattern: pattern.clone(), why });
    }
    Ok(links.iter().map(|link| patterns.iter().any(|pattern| matches(pattern, link))).collect())
}

/// Whether a name is what a pattern says, in a time that grows with the product of their lengths at most.
fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) =
        (pattern.chars().collect(), name.chars().collect());
    let (mut at, mut done) = (0, 0);
    // The last star, and how much of the name it has taken.
    let mut star = None;
    while done < name.len() {
        match pattern.get(at) {
            Some('*') => {
                star = Some((at, done));
                at += 1;
            }
            Some(one) if *one == '?' || *one == name[done] => {
                at += 1;
                done += 1;
            }
            Some(_) | None => {
                let Some((place, taken)) = star else { return false };
                star = Some((place, taken + 1));
                (at, done) = (place + 1, taken + 1);
            }
        }
    }
    pattern[at..].iter().all(|one| *one == '*')
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// By trying everything.
    fn plainly(pattern: &[char], name: &[char]) -> bool {
        match pattern.split_first() {
            None => name.is_empty(),
            Some(('*', rest)) => (0..=name.len()).any(|taken| plainly(rest, &name[taken..])),
            Some((one, rest)) => name.split_first().is_some_and(|(first, after)| {
                (*one == '?' || one == first) && plainly(rest, after)
            }),
        }
    }

    proptest! {
        #[test]
        fn patterns_mean_what_they_say(pattern in "[ab*?é]{0,7}", name in "[abé]{0,7}") {
            let chars = |text: &str| text.chars().collect::<Vec<_>>();
            prop_assert_eq!(matches(&pattern, &name), plainly(&chars(&pattern), &chars(&name)));
        }
    }

    #[test]
    fn a_name_that_means_nothing_is_an_error() {
        let without = [WithoutInertia::NotStated, WithoutInertia::Computed];
        let without =
            ["frame", "shell"].map(str::to_owned).into_iter().zip(without).collect::<Vec<_>>();
        let pick = |patterns: &[&str]| {
            let patterns: Vec<String> = patterns.iter().map(|p| (*p).to_owned()).collect();
            picked(&["arm_1", "arm_2", "base"], &without, &patterns)
        };
        assert_eq!(pick(&[]).unwrap(), [true; 3]);
        assert_eq!(pick(&["arm*", "base"]).unwrap(), [true; 3]);
        assert_eq!(pick(&["*_2"]).unwrap(), [false, true, false]);
        let error = |patterns| pick(patterns).unwrap_err().to_string();
        assert_eq!(
            error(&["arm*", "leg"]),
            "--links leg: no link matches it; the links with inertia are arm_1, arm_2, base"
        );
        assert_eq!(error(&["fr*"]), "--links fr*: \"frame\": no inertia in the file");
        assert!(error(&["sh*"]).starts_with("--links sh*: \"shell\": its inertia is computed"));
    }
}
