//! Words of headings that speak of how uncertain a number is.

use crate::units::squeezed;

/// What is written of standard deviations, wherever it stands, and in words of their own.
const MARKS: [&str; 5] = ["sigma", "percent", "%", "σ", "±"];
const WORDS: [&str; 63] = [
    "sd",
    "std",
    "stdev",
    "stddev",
    "stderr",
    "dev",
    "deviation",
    "var",
    "variance",
    "cov",
    "cv",
    "unc",
    "uncert",
    "uncertainty",
    "tol",
    "tolerance",
    "delta",
    "pm",
    "plusminus",
    "range",
    "scatter",
    "variation",
    "halfwidth",
    "noise",
    "rsd",
    "1s",
    "2s",
    "3s",
    "pct",
    "err",
    "error",
    "accuracy",
    "precision",
    "dispersion",
    "spread",
    "rms",
    "se",
    "sem",
    // Limits are no less.
    "min",
    "max",
    "minimum",
    "maximum",
    "lower",
    "upper",
    "low",
    "high",
    "lo",
    "hi",
    "95",
    "99",
    "p5",
    "p05",
    "p95",
    "p99",
    "toleranz",
    "tolérance",
    "unsicherheit",
    "streuung",
    "abweichung",
    "standardabweichung",
    "incertitude",
    "incertezza",
    "incertidumbre",
];

/// Whether a heading has a mark of uncertainty.
pub(crate) fn is_marked(heading: &str) -> bool {
    let plain = squeezed(heading);
    MARKS.iter().any(|mark| plain.contains(mark))
}

/// Whether it has the mark as it is typed, `mass +/-`, or a coverage factor, `mass (k=2)`.
pub(crate) fn has_typed_mark(heading: &str) -> bool {
    let plain: String = heading.chars().filter(|c| !c.is_whitespace()).collect();
    let is_factor = |(at, _): (usize, &str)| {
        let (before, after) = (&heading[..at], &heading[at + 1..]);
        !before.ends_with(char::is_alphanumeric) && after.trim_start().starts_with('=')
    };
    plain.contains("+/-") || plain.contains("+-") || heading.match_indices('k').any(is_factor)
}

/// Whether it speaks of standard deviations by their sign.
pub(crate) fn has_sigma(heading: &str) -> bool {
    let plain = squeezed(heading);
    ["sigma", "σ", "±"].iter().any(|mark| plain.contains(mark))
}

/// Whether it has a word for it, or two that are one: `half width`.
pub(crate) fn has_word(heading: &str) -> bool {
    let parted = parted(heading);
    let words: Vec<&str> = words(&parted).filter(|word| !word.is_empty()).collect();
    let is_known = |words: &[&str]| WORDS.contains(&words.concat().as_str());
    words.chunks(1).any(is_known) || words.windows(2).any(is_known)
}

/// In small letters, with a blank before each capital after a small letter, where a word begins: `massSD` becomes `mass sd`.
pub(crate) fn parted(heading: &str) -> String {
    let mut parted = String::with_capacity(heading.len() + 8);
    let mut was_small = false;
    for c in heading.chars() {
        if was_small && c.is_uppercase() {
            parted.push(' ');
        }
        was_small = c.is_lowercase();
        parted.extend(c.to_lowercase());
    }
    parted
}

/// What stands before or after a word for it in one word, in small letters: `mass` of `masssd` and of `sdmass`.
pub(crate) fn beside_word(word: &str) -> impl Iterator<Item = &str> {
    WORDS
        .iter()
        .flat_map(move |known| [word.strip_prefix(known), word.strip_suffix(known)])
        .flatten()
}

/// Whether it speaks of nothing else, so that nobody knows of which number: `uncertainty`, `tolerance [kg]`.
pub(crate) fn is_alone(heading: &str) -> bool {
    const SURE: [&str; 20] = [
        "uncertainty",
        "uncert",
        "unc",
        "tolerance",
        "tol",
        "sd",
        "std",
        "stdev",
        "stddev",
        "deviation",
        "variance",
        "error",
        "accuracy",
        "toleranz",
        "tolérance",
        "unsicherheit",
        "standardabweichung",
        "incertitude",
        "incertezza",
        "incertidumbre",
    ];
    const BESIDE: [&str; 9] = ["standard", "kg", "g", "lb", "m", "mm", "in", "1", "3"];
    let lower = heading.to_lowercase();
    let words = || words(&lower).filter(|word| !word.is_empty());
    words().any(|word| SURE.contains(&word))
        && words()
            .all(|word| SURE.contains(&word) || WORDS.contains(&word) || BESIDE.contains(&word))
}

/// The words of a heading.
pub(crate) fn words(heading: &str) -> impl Iterator<Item = &str> {
    heading.split(|c: char| !c.is_alphanumeric())
}
