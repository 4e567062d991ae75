//! Units that a title or a comment of a table states for all columns, of which none is read.

use crate::{
    FileProblem,
    body::shortened,
    error::Refusal,
    rows::titles,
    text::Text,
    title_factors::is_scaled,
    title_words::{Word, are_units, clauses, plain, words},
    unit_words::{Kind, is_certain, is_name, is_si, runs},
    units::Dimension,
};

/// Bytes of the longest line that is judged, and most lines that are: longer ones are no titles.
const LONGEST: usize = 2000;
const LINES: usize = 1000;

/// Systems of units that alone are names of something else.
const NAMES: [&str; 3] = ["us", "british", "mgs"];

/// Words beside which English is a language.
const LANGUAGES: [&str; 9] = [
    "language",
    "sprache",
    "langue",
    "german",
    "deutsch",
    "french",
    "français",
    "español",
    "italiano",
];

/// Units that are something else beside the name of what is measured: the `inertia of the foot`, `Ixy = -∫xy dm`, `dyn. moments`.
const DOUBTFUL: [&str; 5] = ["foot", "feet", "dm", "um", "dyn"];

/// Why a table is refused that has columns without units, if a line above its header, or a comment below it, says that units are others
/// than those of SI.
pub(crate) fn refused(text: &Text, header: usize, some_lack: bool) -> Result<(), Refusal> {
    if !some_lack {
        return Ok(());
    }
    let mut titles = titles(text.as_str(), header).take(LINES);
    match titles.find(|(_, line)| speaks_of_others(line)) {
        Some((at, line)) => {
            let said = shortened(line.trim());
            Err(text.refuse(at, FileProblem::TitleUnits { said }))
        }
        None => Ok(()),
    }
}

/// Whether a line speaks of units that are not those of SI, or says of its units nothing that is known.
fn speaks_of_others(line: &str) -> bool {
    if line.len() > LONGEST {
        return false;
    }
    let line = plain(line);
    let runs = runs(&line);
    let lower: Vec<String> = runs.iter().map(|run| run.text.to_lowercase()).collect();
    let words = words(&runs, &lower);
    let said = Said {
        has_units: words.iter().any(|word| word.is_of(Kind::Units)),
        of_several: words.iter().any(Word::is_of_several),
        is_capital: runs.iter().all(|run| run.is_capital),
        of_languages: lower.iter().any(|word| LANGUAGES.contains(&word.as_str())),
    };
    clauses(&words).any(|clause| {
        let value = clause.iter().rposition(|word| word.run.gap.contains([':', '=']));
        let value = value.filter(|at| *at > 0);
        is_scaled(clause)
            || said.is_of_others(clause)
            || value.is_some_and(|at| said.is_of_others(&clause[at..]))
    }) || is_unknown(&words)
        || are_weights(&words)
}

/// Whether masses are in newtons, which are units of SI, but not those of a mass: `Mass [N]`, `weights in newtons`.
fn are_weights(words: &[Word<'_>]) -> bool {
    let is_newton = |word: &Word<'_>| word.parts.iter().any(|(_, part)| part.starts_with('n'));
    words.windows(2).enumerate().any(|(at, pair)| {
        let is_between = pair[1].run.gap.contains(['[', '(', '{', '=', ':']);
        let before = if pair[0].is_in() {
            at.checked_sub(1).and_then(|at| words.get(at))
        } else {
            pair.first().filter(|_| is_between)
        };
        pair[1].is_of(Kind::Amount)
            && is_newton(&pair[1])
            && before.is_some_and(|word| word.measures(Dimension::Mass))
    })
}

/// What a line says as a whole.
struct Said {
    /// Whether it has a word for units, which may be things: unit FM-1 of a series.
    has_units: bool,
    /// Whether it has one that things are seldom called.
    of_several: bool,
    /// Whether it has no small letters, so that capitals mean nothing.
    is_capital: bool,
    /// Whether it has a word for a language.
    of_languages: bool,
}

impl Said {
    /// Whether a clause states units that are not those of SI: by having no other words than those of units, by a unit beside
    /// what it measures or another unit, or by one that is certain in a line on units.
    fn is_of_others(&self, clause: &[Word<'_>]) -> bool {
        let are_units = are_units(clause);
        let is_whole = are_units.iter().all(|is_unit| *is_unit);
        let words = clause.iter().zip(are_units).map(|(word, is_unit)| is_unit.then_some(word));
        let words: Vec<Option<&Word<'_>>> = words.collect();
        let is_certain = |word: &&Word<'_>| is_certain(word.run) && word.is_other();
        let mut phrases = words.split(Option::is_none);
        self.has_units && words.iter().flatten().any(is_certain)
            || phrases.any(|phrase| {
                self.has_others(&phrase.iter().flatten().copied().collect::<Vec<_>>(), is_whole)
            })
    }

    /// The same of words in a row that all are units or stand beside units.
    fn has_others(&self, phrase: &[&Word<'_>], is_whole: bool) -> bool {
        let has = |kind: Kind| phrase.iter().any(|word| word.is_of(kind));
        // `mass in lb`, but `12 in`.
        let is_in = |pair: &[&Word<'_>]| pair[0].is_in() && pair[1].is_measure();
        let is_stated = has(Kind::Units) || phrase.windows(2).any(is_in);
        let is_beside = is_stated || has(Kind::Measured);
        let is_sure = is_beside || has(Kind::Amount) && has(Kind::Length);
        let counts = |(at, word): (usize, &&Word<'_>)| {
            let letters = word.run.text.chars().count();
            let is_clear = !word.run.is_capital
                || self.of_several
                || letters > 1 && (letters > 2 || is_sure || self.is_capital || self.has_units);
            // Elsewhere it is a word between others.
            let is_last = at + 1 == phrase.len();
            let is_behind_in = at.checked_sub(1).is_some_and(|before| phrase[before].is_in());
            let is_inch = is_last && (is_whole || is_behind_in) || word.run.is_squared;
            word.parts.iter().any(|(kind, part)| match kind {
                _ if is_si(part) || is_name(part) => false,
                Kind::Amount | Kind::Length if !is_clear => false,
                Kind::Length if word.is_in() => is_inch,
                Kind::Amount | Kind::Length => is_stated || !is_beside || !DOUBTFUL.contains(part),
                Kind::System if self.of_languages && *part == "english" => false,
                Kind::System => self.has_units || is_whole && !NAMES.contains(part),
                Kind::Time | Kind::Units | Kind::Measured | Kind::Beside => false,
            })
        };
        (is_whole || is_sure) && phrase.iter().enumerate().any(counts)
    }
}

/// Whether a line says what its units are in words of which none is a unit: `Units: see the drawing`. With a digit these are things.
fn is_unknown(words: &[Word<'_>]) -> bool {
    let Some(at) = words.iter().position(|word| word.is_of(Kind::Units)) else { return false };
    let is_system = |word: &&Word<'_>| word.run.text.eq_ignore_ascii_case("system");
    let behind = words.get(at + 1..).unwrap_or_default();
    let system = behind.first().filter(is_system);
    let value = behind.get(usize::from(system.is_some())..).unwrap_or_default();
    let is_known = |word: &Word<'_>| word.is_measure() || word.is_of(Kind::System);
    (system.is_some() || words[at].is_of_several())
        && value.first().is_some_and(|word| word.run.gap.trim_start().starts_with([':', '=']))
        && !value.iter().any(|word| word.run.is_number() || is_known(word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{prelude::*, sample::select};

    /// Words that tell a unit which is not of SI.
    const OTHERS: [&str; 30] = [
        "lb",
        "lbs",
        "lbm",
        "lbf",
        "slug",
        "slugs",
        "inch",
        "inches",
        "ft",
        "feet",
        "mm",
        "cm",
        "mg",
        "oz",
        "pounds",
        "imperial",
        "grams",
        "millimeters",
        "tonne",
        "pound",
        "foot",
        "g",
        "t",
        "in",
        "Gramm",
        "kN",
        "IPS",
        "MMGS",
        "U.S. customary",
        "English",
    ];

    #[test]
    fn lines_on_other_units_are_told_from_titles() {
        for unit in OTHERS {
            for line in [
                format!("All units: {unit}, in, lb-in2"),
                format!("# Units = {unit}"),
                format!("Einheiten: kg, {unit}, kg {unit}²"),
                format!("\"Mass properties (units {}2)\"", unit.to_uppercase()),
            ] {
                assert!(speaks_of_others(&line), "{line}");
            }
            assert!(!speaks_of_others(&format!("Panel {unit}")));
        }
        for line in ["All units in SI", "units: kg, m, kg m2", "Unit FM-1", ""] {
            assert!(!speaks_of_others(line), "{line}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        /// Wherever units stand: behind words for units, in brackets, behind `in`, or alone in a row.
        #[test]
        fn units_are_found_where_titles_state_them(
            units in prop::collection::vec(select(&[
                ("kg", true), ("m", true), ("kg m2", true), ("kg·m²", true), ("kilogram", true), ("metre", true), ("meters", true),
                ("g", false), ("t", false), ("lb", false), ("lbm", false), ("pounds", false), ("slug", false), ("tonne", false),
                ("grams", false), ("mm", false), ("millimetres", false), ("inches", false), ("ft", false), ("feet", false),
                ("kg mm2", false), ("g·mm²", false), ("lb-in^2", false), ("slug ft2", false), ("lbf in s2", false),
            ][..]), 1..5),
            between in select(&[", ", ",", "; ", " and ", " / ", "\t"][..]),
            (before, after) in select(&[
                ("Units: ", ""), ("# All units: ", ""), ("UNITS = ", ""), ("Unit: ", ""), ("Einheit: ", ""), ("UOM: ", ""),
                ("# units of measure: ", " (CAD)"), ("Mass properties (", ")"), ("# [", "] of the bus"), ("# ", ""), (",", ",,"),
                ("# Mass in ", ""), ("All dimensions are in ", ""), ("# All values in ", ", rev 3"), ("Bus, all units ", ""),
            ][..]),
            in_capitals in any::<bool>(),
        ) {
            let stated = units.iter().map(|(unit, _)| *unit).collect::<Vec<_>>().join(between);
            let line = format!("{before}{stated}{after}\n");
            let is_si = units.iter().all(|(_, is_si)| *is_si);
            prop_assert_eq!(speaks_of_others(&line), !is_si, "{}", line);
            // One or two capitals may be a name.
            let is_long = units.iter().any(|(unit, is_si)| !is_si && unit.len() > 2);
            let line = if in_capitals { line.to_uppercase() } else { line };
            prop_assert!(!is_long || speaks_of_others(&line), "{}", line);
        }

        /// A factor makes another unit of that of SI, and a number behind another word is a quantity.
        #[test]
        fn factors_are_told_from_quantities(
            measured in select(&["Mass", "Masses", "Inertia", "Lengths", "All units", "Moments of inertia", "CG"][..]),
            unit in select(&["kg", "m", "kg m2", "kg·m²", "kg m^2"][..]),
            (factor, is_power) in select(&[
                ("10^-3", true), ("10⁻³", true), ("1e-6", true), ("1.0E-6", true), ("10**3", true), ("10^6", true), ("1E3", true), ("10^(-3)", true),
                ("1000", false), ("0.001", false), ("100", false),
            ][..]),
            between in select(&[" ", " x ", "·", " × ", " * ", "*", "×"][..]),
            quantity in select(&["of", "at", "below", "rounded to", "within"][..]),
            mark in select(&["", "# ", ",,"][..]),
        ) {
            let scaled = format!("{factor}{between}{unit}");
            for line in [format!("{measured} in {scaled}"), format!("Table 3, {measured} [{scaled}], rev 2"), format!("{measured} [{unit}/{factor}]")] {
                prop_assert!(speaks_of_others(&format!("{mark}{line}")), "{}", line);
            }
            let behind = format!("{mark}{measured} [{unit}{between}{factor}]");
            prop_assert!(!is_power || speaks_of_others(&behind), "{}", behind);
            let line = format!("{mark}{measured} {quantity} {factor} {unit}");
            prop_assert!(!speaks_of_others(&line), "{}", line);
        }

        /// A line that says what one unit is speaks of another, unless that is one of SI.
        #[test]
        fn units_are_defined(
            before in select(&["# ", "scale: ", "Drawing 3, ", ""][..]),
            name in select(&["unit", "length unit", "mass unit"][..]),
            value in select(&["1", "25.4", "0.001", "1000", "2", "1e-3"][..]),
            (unit, is_si) in select(&[("m", true), ("kg", true), ("mm", false), ("in", false), ("lb", false), ("g", false)][..]),
        ) {
            let line = format!("{before}1 {name} = {value} {unit}");
            prop_assert_eq!(speaks_of_others(&line), !is_si || value != "1", "{}", line);
        }

        /// What is measured, a density, and units that the table has not are none of its units.
        #[test]
        fn units_of_something_else_are_none(
            before in select(&["# Mass in kg, ", "Units: kg, m, kg m2; ", "", "Bus ("][..]),
            of_another in select(&[
                "CM in m", "t in s", "CM frame", "inertia about CM in kg m2", "density in {unit}/m3", "areal mass {unit}/m2", "density: {unit}/cm^3",
                "converted from {unit}", "not {unit} and mm", "converted from {unit}, in", "MLI of {unit}/cm²",
                "volume in mm3", "stress in N/mm2", "stiffness [kN/mm]", "inertia w.r.t. CG", "mass t.b.d.", "originally in {unit} and mm", "drawn by G. Foot",
                "inertia per MIL-STD", "dyn. moments",
            ][..]),
            unit in select(&["g", "lb", "slug", "oz", "mg", "t"][..]),
            after in select(&["", ", kg", "; inertia in kg m2"][..]),
        ) {
            let line = format!("{before}{}{after}", of_another.replace("{unit}", unit));
            prop_assert!(!speaks_of_others(&line), "{}", line);
            let line = format!("{line}, mass in {unit}");
            prop_assert!(speaks_of_others(&line), "{}", line);
        }

        /// Names of things and quantities are no units.
        #[test]
        fn things_and_quantities_are_none(
            before in select(&["# Unit ", "Unit ", "# Flight unit ", "# ", "Table 3: unit ", "# The units "][..]),
            name in select(&[
                "FT-2", "CM-2", "CM-1", "FM-1", "MM-3", "IN-7", "G-2", "T 1", "T1", "SN 12", "LB-3", "OZ 4", "weighing 300 mg",
                "flown at 300 mg", "of 12.3 lb", "2 mm thick", "20 in long", "of 0.3 g/cm3", "at 5 lb/ft3",
            ][..]),
            after in select(&["", " of the series", ", weighed 2024-05-01", " (rev 3)", " and FT-3", ", units: kg, m"][..]),
        ) {
            let line = format!("{before}{name}{after}");
            prop_assert!(!speaks_of_others(&line), "{}", line);
        }
    }

    #[test]
    fn titles_are_judged_by_what_they_state() {
        for line in [
            "# Inertia w.r.t. CG in g mm2",
            "# Mass: t.b.d., lengths in mm",
            "# Language: English. Units: English, lb",
            "# Volume in mm3, mass in g",
            "# Stress in N/mm2; lengths in mm",
            "# Author: G. Foot, units: foot",
            "# Mass per MIL-STD in lb",
            "# Masses in t.",
            "# U.S. units",
            "# Unit system: MMGS",
            "All units: g, m",
            "Units: tonne, m",
            "Unit: kilogram; millimeter",
            "# Mass in lb, lengths in inches",
            "All dimensions are in millimeters and grams",
            ",Mass [kg],Centre of gravity [mm],,,Moments of inertia [kg·mm²],,",
            ",kg,mm,mm,mm,kg mm2,kg mm2,kg mm2",
            "Part,LB,IN,IN,IN,LB IN2",
            "# units,kg,mm,mm",
            "Inertia tensor of tank lb in2",
            "# Mass properties rev 3 in mm",
            "# Drawn in mm",
            "# imperial units",
            "# Lengths: mm",
            "Units: Zoll",
            "# Units: see the drawing",
            "# Units: SI. Drawn in mm, converted",
            "# Inertia in 1e-6 kg m2",
            "Inertia in 10^-3 kg·m²",
            "Inertia in 10⁻³ kg·m²",
            "Inertia [kg·m² × 10⁻³]",
            "Inertia [kg·m²/1000]",
            "Mass in 1000 kg",
            "Mass [1000 kg]",
            ",Mass [kg],CG [m],,,Inertia [10^-3 kg·m²],,",
            "# Masses in N",
            "weights in newtons",
            "Part,Weight (N),CG (m)",
            "# Imperial",
            "Mass properties (English)",
            "cgs",
            "Creo mmNs",
            "mmNs units",
            "CG in mils",
            "CG in decimeters",
            "# thou",
            "STA in in",
            "Mass in kips",
            "Mass in short tons",
            "# 1 unit = 1 mm",
            "# scale: 1 unit = 1 mm",
            "# 1 length unit = 25.4 mm",
            "# 1 unit = 0.001 m",
            "# Masses are not kg, lb",
            "# Masses from CAD in lb",
            "Inertia in g/mm^2",
            "Inertia [g/mm²]",
            "Units: kg, lb/in2",
            "Units: lb/in/lb-in2",
        ] {
            assert!(speaks_of_others(line), "{line}");
        }
        for line in [
            "# Mass in kg, cg in m, inertia in kg m^2",
            "Part,Mass (kg),CG (m),,,Inertia (kg·m²),,",
            "# Units: SI (kg, m, s)",
            "# Units: 4 of 12",
            "# Units: FM-1 and FM-2",
            "Units: metric, kg",
            "# Newtons: N, m, s",
            "# Inertia of the foot",
            "# Foot inertia",
            "# Inertia w.r.t. CG",
            ",Mass,Moments of inertia w.r.t. CG,,",
            "# MOI w.r.t. c.g. of each part",
            "# Mass: t.b.d.",
            "# Inertia t.b.d., mass in kg",
            "# inertia per MIL-STD",
            "# dyn. moments",
            "# Mass (English), Masse (Deutsch)",
            "# Language: English",
            "# Volume in mm3",
            "# Young's modulus: GPa, N/mm2",
            "# stiffness: N/mm",
            "# Originally in mm and g; converted to SI",
            "# Author: G. Foot",
            "# Ixy = -∫xy dm",
            "# products are tensor entries (I12 = -∫xy dm)",
            "# state at t = 0, about the mass centre",
            "# In orbit, with US bus",
            "# Mars Global Surveyor (MGS)",
            "# Drawn by CM, checked by MM",
            "# In work",
            "Tank, left foot",
            "# Written in English",
            "# g = 9.81",
            "Jones, Dan",
            "Part,m,Cx,Cy,Cz",
            "# Inertia about CM in kg m^2",
            ",Mass,CGs,,,Inertia,,",
            "# CGs in m, all units SI",
            "# mass kg, CM in m, inertia about CM in kg m2",
            "Inertia in CM frame",
            "# Mass in kg, positions in m, t in s",
            "# Units: kg, m, kg m2; density: g/cm3",
            "Density in kg/dm3",
            "MLI areal mass in g/m2",
            "# Masses in kg, not g and mm",
            "units: kg, m (converted from lb, in)",
            "# Inertia rounded to 1e-6 kg m2",
            "# Total mass (1000 kg)",
            "# Total mass: 1000 kg",
            "# Tank of 10 kg",
            "# 1 unit = 1 m",
            "# Force in N, mass in kg",
            "# Payload of 10^3 kg",
        ] {
            assert!(!speaks_of_others(line), "{line}");
        }
    }
}
