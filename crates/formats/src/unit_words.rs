//! Whether words speak of a unit of measurement, or are the name of a thing: `lbf in s2`, and `FM-1` of a series.

use crate::{
    table_terms::dimension_of,
    units::{LENGTHS, MASSES},
};

/// What a word is where units stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A unit of mass or force.
    Amount,
    Length,
    Time,
    /// A system of units.
    System,
    /// What says that units are meant: `unit`, `uom`.
    Units,
    /// What is measured: `mass`.
    Measured,
    /// What stands beside units, and is none.
    Beside,
}

/// Symbols beside those that are read, in small letters. Several of them may be one word, as `ozin`.
const SYMBOLS: [(Kind, &[&str]); 3] = [
    (
        Kind::Amount,
        &[
            "kgs", "gm", "gms", "gr", "lbf", "oz", "ozm", "ozf", "kgf", "tonf", "kp", "kn", "n",
            "mn", "cn", "dan", "slinch", "dyn", "pdl", "cwt",
        ],
    ),
    (Kind::Length, &["dm", "km", "um", "µm", "μm", "yd"]),
    (Kind::Time, &["s", "sec"]),
];

/// Whole words, in small letters and without the `s` of many.
const WORDS: [(Kind, &[&str]); 6] = [
    (
        Kind::Amount,
        &[
            "gram", "gramm", "gramme", "kilo", "pound", "ton", "tonne", "ounce", "newton", "dyne",
            "poundal", "kip",
        ],
    ),
    (
        Kind::Length,
        &["metre", "meter", "inch", "inche", "foot", "feet", "yard", "micron", "mil", "thou"],
    ),
    (Kind::Time, &["second"]),
    (
        Kind::System,
        &[
            "si",
            "mks",
            "mmks",
            "mmgs",
            "mgs",
            "cgs",
            "ips",
            "fps",
            "imperial",
            "english",
            "british",
            "metric",
            "us",
            "usc",
            "uscs",
            "customary",
        ],
    ),
    (Kind::Units, &["unit", "uom", "einheit", "einheiten", "unité", "unidad", "unidade"]),
    (
        Kind::Beside,
        &[
            "system", "per", "x", "square", "squared", "sq", "of", "and", "all", "are", "is",
            "the", "for", "used", "given", "force", "masse", "value", "short", "long",
        ],
    ),
];

/// The words and symbols of those that are units of SI, or of a system that has them.
const SI: [&str; 14] = [
    "kg",
    "kgs",
    "kilo",
    "kilogram",
    "kilogramm",
    "kilogramme",
    "m",
    "metre",
    "meter",
    "n",
    "newton",
    "si",
    "mks",
    "metric",
];

/// What may stand before a word for a unit.
const PREFIXES: [&str; 6] = ["kilo", "milli", "centi", "deci", "mega", "micro"];

/// Symbols that say in small letters that a unit is meant, whatever stands beside them.
const CERTAIN: [&str; 6] = ["oz", "lb", "mm", "cm", "slinch", "mg"];

/// The same in capitals too. Of two capital letters names are made: the `CM-1` is a thing.
const CERTAIN_IN_CAPITALS: [&str; 8] = ["kg", "kgs", "lbs", "lbm", "lbf", "kgf", "slug", "slugs"];

/// Letters that stand together, or digits.
pub(crate) struct Run<'a> {
    pub(crate) text: &'a str,
    /// What stands between it and the one before.
    pub(crate) gap: &'a str,
    pub(crate) is_capital: bool,
    /// Whether a 2 follows it without anything between.
    pub(crate) is_squared: bool,
}

impl Run<'_> {
    pub(crate) fn is_number(&self) -> bool {
        self.text.starts_with(char::is_numeric)
    }
}

/// Whether a text speaks of a unit: by a square behind letters, by a word that is sure to be a unit, or by having no other words
/// than those of units. A single capital letter is the name of a thing, as `in` is a word between others.
pub(crate) fn speaks_of_a_unit(text: &str) -> bool {
    // Longer texts are no units, and would be searched for long.
    if text.len() > 200 {
        return false;
    }
    let runs = runs(text);
    has_square(text) || runs.iter().any(is_certain) || are_units(&runs)
}

/// Whether letters stand before the mark of a square.
fn has_square(text: &str) -> bool {
    let ends_a_unit = |c: char| c.is_alphabetic() || ")]}".contains(c);
    let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    ["²", "^2", "^{2}", "**2"]
        .into_iter()
        .any(|mark| text.match_indices(mark).any(|(at, _)| text[..at].ends_with(ends_a_unit)))
}

/// The runs of letters and of digits.
pub(crate) fn runs(text: &str) -> Vec<Run<'_>> {
    let mut runs = Vec::new();
    let (mut rest, mut end_before) = (text, 0);
    while let Some(first) = rest.chars().next() {
        let is_of = |c: char| {
            if first.is_alphabetic() { c.is_alphabetic() } else { c.is_numeric() }
        };
        let end = rest.find(|c| !is_of(c)).unwrap_or(rest.len());
        let (run, after) = rest.split_at(end.max(first.len_utf8()));
        if end > 0 {
            let digits = after.len() - after.trim_start_matches(char::is_numeric).len();
            let is_capital = !run.contains(char::is_lowercase);
            let start = text.len() - rest.len();
            let gap = &text[end_before..start];
            runs.push(Run { text: run, gap, is_capital, is_squared: &after[..digits] == "2" });
            end_before = start + run.len();
        }
        rest = after;
    }
    runs
}

/// Whether a word is sure to be a unit, whatever stands beside it.
pub(crate) fn is_certain(run: &Run<'_>) -> bool {
    let word = run.text.to_lowercase();
    let is_symbol = |list: &[&str]| list.contains(&word.as_str());
    let is_length = || symbols(Kind::Length).any(|symbol| symbol == word);
    let is_area = || run.is_squared && (is_length() || joined(&word, true).is_some());
    is_symbol(&CERTAIN_IN_CAPITALS) || (!run.is_capital && (is_symbol(&CERTAIN) || is_area()))
}

/// Whether there is no other word than those of units, and one of them does not stand for a thing.
fn are_units(runs: &[Run<'_>]) -> bool {
    let has_two = runs.iter().any(|run| run.text == "2");
    let mut found: Vec<(Kind, bool)> = Vec::new();
    let mut before: Option<&Run<'_>> = None;
    let mut needs_amount = false;
    for run in runs {
        if run.is_number() {
            // A number is the power of what stands before it, or that of a thing.
            let is_power = matches!(found.last(), Some((Kind::Length | Kind::Time, _)));
            let Some(before) = before.take().filter(|_| is_power && run.text == "2") else {
                return false;
            };
            // The FT-2 is a thing, and KG FT2 is none.
            needs_amount |= before.is_capital;
            continue;
        }
        let word = run.text.to_lowercase();
        let Some(parts) = parts(&word, has_two) else { return false };
        // A capital letter is a name, or a part of one: `CM-T`.
        if run.is_capital && word.chars().count() == 1 && !has_two {
            return false;
        }
        let is_clear = |part: &str| !is_name(part) && (part.chars().count() > 1 || !run.is_capital);
        found.extend(parts.into_iter().map(|(kind, part)| (kind, is_clear(part))));
        before = Some(run);
    }
    let is_unit = |(kind, is_clear): &(Kind, bool)| match kind {
        Kind::Amount | Kind::Length | Kind::System => *is_clear,
        Kind::Time | Kind::Units | Kind::Measured | Kind::Beside => false,
    };
    let has_amount = found.iter().any(|(kind, _)| *kind == Kind::Amount);
    found.iter().any(is_unit) && (has_amount || !needs_amount)
}

/// What the parts of a word in small letters are, if it is a unit, or a word that stands beside one.
pub(crate) fn parts(word: &str, has_two: bool) -> Option<Vec<(Kind, &str)>> {
    whole(word).map(|kind| vec![(kind, word)]).or_else(|| joined(word, has_two))
}

/// Whether a unit or a system of units, in small letters, is one of SI.
pub(crate) fn is_si(word: &str) -> bool {
    [word, word.strip_suffix('s').unwrap_or(word)].iter().any(|one| SI.contains(one))
}

/// Whether a unit is a name as well, so that other units must stand beside it: Dan.
pub(crate) fn is_name(part: &str) -> bool {
    ["n", "mn", "cn", "dan"].contains(&part)
}

/// Whether a word in small letters says that units are meant, in any language: `einheit`.
pub(crate) fn is_for_units(word: &str) -> bool {
    whole(word) == Some(Kind::Units)
}

/// Every symbol of a kind.
fn symbols(kind: Kind) -> impl Iterator<Item = &'static str> {
    let read: &[(&str, f64)] = match kind {
        Kind::Amount => &MASSES,
        Kind::Length => &LENGTHS,
        Kind::Time | Kind::System | Kind::Units | Kind::Measured | Kind::Beside => &[],
    };
    let others = SYMBOLS.iter().filter(move |(of, _)| *of == kind);
    let others = others.flat_map(|(_, symbols)| symbols.iter().copied());
    read.iter().map(|(name, _)| *name).chain(others)
}

/// What a word in small letters is, if it is one symbol or one word.
fn whole(word: &str) -> Option<Kind> {
    let is_symbol = |kind: &Kind| symbols(*kind).any(|symbol| symbol == word);
    if let Some(kind) = [Kind::Amount, Kind::Length, Kind::Time].into_iter().find(is_symbol) {
        return Some(kind);
    }
    let one = word.strip_suffix('s').unwrap_or(word);
    let bare = PREFIXES.iter().find_map(|prefix| one.strip_prefix(prefix));
    let names = [Some(word), Some(one), bare];
    let is_name =
        |(_, list): &&(Kind, &[&str])| names.iter().flatten().any(|name| list.contains(name));
    let known = WORDS.iter().find(is_name).map(|(kind, _)| *kind);
    known.or_else(|| dimension_of(word).map(|_| Kind::Measured))
}

/// The symbols of a mass or a force, a length and perhaps a time that a word is made of, and an x between them: `ozin`, `lbfins`, `gxmm`,
/// `mmNs`. One letter is a mass there before a length and with a square alone: `tin` is a word, and the CMG a thing.
fn joined(word: &str, has_two: bool) -> Option<Vec<(Kind, &str)>> {
    let orders = [[Kind::Amount, Kind::Length], [Kind::Length, Kind::Amount]];
    orders.into_iter().find_map(|[first, second]| {
        // Of two readings, that with the longer first symbol: `mmNs` is mm·N·s.
        let read = symbols(first).filter_map(|one| {
            let rest = behind_cross(word.strip_prefix(one)?);
            symbols(second).find_map(|other| {
                let time = behind_cross(rest.strip_prefix(other)?);
                let is_time = time.is_empty() || symbols(Kind::Time).any(|symbol| symbol == time);
                let is_mass = if first == Kind::Amount {
                    has_two || one.len() > 1
                } else {
                    other.len() > 1 || other == "n" && !time.is_empty()
                };
                let parts = || vec![(first, &word[..one.len()]), (second, &rest[..other.len()])];
                (is_time && is_mass).then(parts)
            })
        });
        read.max_by_key(|parts| parts.first().map(|(_, symbol)| symbol.len()))
    })
}

/// What stands behind an x, if that parts it from what stands before.
fn behind_cross(rest: &str) -> &str {
    rest.strip_prefix('x').filter(|behind| !behind.is_empty()).unwrap_or(rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{prelude::*, sample::select};

    const AMOUNTS: [&str; 27] = [
        "mN", "daN", "cN", "kN", "tonf", "kg", "g", "mg", "Mg", "MG", "t", "lb", "lbm", "lbf",
        "slug", "slinch", "oz", "ozf", "gr", "gm", "ton", "tonne", "pound", "pounds", "N", "kgf",
        "grams",
    ];
    const LENGTHS: [&str; 8] = ["m", "cm", "mm", "in", "ft", "inch", "foot", "meter"];
    const BETWEEN: [&str; 9] = [" x ", " ", "·", "*", "-", "_", "⋅", ".", " * "];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        /// Of mass and length, or of force, length and time: whatever stands between and around them.
        #[test]
        fn units_of_inertia_are_units(
            amount in select(&AMOUNTS[..]),
            length in select(&LENGTHS[..]),
            time in any::<bool>(),
            between in select(&BETWEEN[..]),
            square in select(&["2", "²", "^2", "**2", "^{2}", " ^ 2"][..]),
            (before, after) in select(&[("", ""), ("[", "]"), ("(", ")"), ("unit: ", ""), ("in ", ""), ("", " system")][..]),
            is_upper in any::<bool>(),
        ) {
            let time = if time { format!("{between}s") } else { String::new() };
            let unit = format!("{amount}{between}{length}{time}{square}");
            let unit = if is_upper { unit.to_uppercase() } else { unit };
            let text = format!("{before}{unit}{after}");
            // The TM-2 is a thing.
            let is_name = is_upper && (amount.len() == 1 || is_name(&amount.to_lowercase())) && length.len() == 1 && square == "2" && before != "in ";
            prop_assert_eq!(speaks_of_a_unit(&text), !is_name, "{}", text);
        }

        /// The same without anything between, in small letters.
        #[test]
        fn symbols_in_one_word_are_units(
            amount in select(&["kg", "g", "mg", "t", "lb", "lbm", "lbf", "slug", "oz", "gm", "gr", "N"][..]),
            length in select(&["m", "cm", "mm", "in", "ft"][..]),
            time in select(&["", "s", " s", "-s", "sec"][..]),
            cross in select(&["", "x"][..]),
            is_turned in any::<bool>(),
            more in select(&["", " (CAD)", ", as drawn", " about CoM"][..]),
        ) {
            // Behind a length, a letter is no mass: the CMG.
            let is_turned = is_turned && (amount.len() > 1 || amount == "N" && time.starts_with('s'));
            let (first, second) = if is_turned { (length, amount) } else { (amount, length) };
            let before_time = if time.starts_with('s') { cross } else { "" };
            let unit = format!("{first}{cross}{second}{before_time}{time}2");
            prop_assert!(speaks_of_a_unit(&unit), "{}", unit);
            // Beside other words, a time is no unit of inertia.
            let is_sure = time.is_empty() || amount.len() > 1 && !time.contains([' ', '-']);
            let text = format!("{unit}{more}");
            prop_assert!(!is_sure || speaks_of_a_unit(&text), "{}", text);
        }

        /// A thing has a name, a letter or a number of its own.
        #[test]
        fn names_of_things_are_none(
            name in select(&[
                "FM", "EM", "QM", "PFM", "STM", "EQM", "SN", "s/n", "vehicle", "Unit", "unit", "no.", "#", "CM", "SM", "TM", "GM",
                "FT", "MM", "IN", "bus", "left foot", "Tank", "flight model", "G", "T", "M", "S", "N", "A",
            ][..]),
            between in select(&[" ", "-", "_", "", "."][..]),
            number in select(&["1", "2", "3", "007", "12", "22", "A", "B", "T", "G", "M",  " in orbit", " at rest"][..]),
        ) {
            let text = format!("{name}{between}{number}");
            // Together these may be others: `tinA`, `GMT`.
            let is_apart = !between.is_empty() || number.starts_with(|c: char| !c.is_alphabetic());
            prop_assert!(!is_apart || !speaks_of_a_unit(&text), "{}", text);
        }
    }

    #[test]
    fn words_and_systems_of_units_are_units() {
        for unit in [
            "inches",
            "inch",
            "pounds",
            "pound",
            "lbs",
            "grams",
            "kilograms",
            "milligram",
            "IPS",
            "MMGS",
            "CGS",
            "cgs",
            "SI",
            "imperial",
            "English",
            "US",
            "US customary",
            "metric units",
            "metric ton",
            "lb, in",
            "lb/in",
            "mass in g",
            "g",
            "t",
            "m",
            "mm",
            "in",
            "MG",
            "lbmm2",
            "kg-square mm",
            "kilogram square metres",
            "kg(mm)2",
            "see CAD, lb in2",
            "MG mm2",
            "pound-force inch second squared",
            "gmcm2",
            "Nmm s2",
            "gxmm2",
            "kgxmm2",
            "lbxin2",
            "kgxmm",
            "mmNs",
            "inlbfs",
            "mN m s2",
            "daN m s2",
            "tonf m s2",
            "kg mm?",
        ] {
            assert!(speaks_of_a_unit(unit), "{unit}");
        }
        for thing in [
            "",
            "-",
            "1",
            "G",
            "T",
            "M",
            "N",
            "T 1",
            "G-7",
            "FM in orbit",
            "no. 1 (t)",
            "EM-T",
            "SI-1",
            "US-2",
            "CGS 3",
            "tin",
            "tint",
            "int",
            "ing",
            "CMG",
            "cmg",
            "CMG 2",
            "Dan",
            "DAN",
            "MN",
            "X",
            "unit T",
            "GM T",
            "CM-T",
            "Unit 2",
            "n",
            "s",
            "foot 1",
            "A17",
        ] {
            assert!(!speaks_of_a_unit(thing), "{thing}");
        }
    }
}
