//! Units that a title or a comment of a table states for all columns, of which none is read.

use crate::{
    FileProblem,
    body::shortened,
    error::Refusal,
    rows::titles,
    text::Text,
    unit_words::{Kind, Run, is_certain, is_name, is_si, parts, runs},
};

/// Bytes of the longest line that is judged, and most lines that are: longer ones are no titles.
const LONGEST: usize = 2000;
const LINES: usize = 1000;

/// What parts a line into clauses, as cells and brackets are.
const ENDS: [char; 10] = [',', ';', '\t', '|', '(', ')', '[', ']', '{', '}'];

/// Units that are something else beside the name of what is measured: the `inertia of the foot`, `Ixy = -∫xy dm`.
const DOUBTFUL: [&str; 4] = ["foot", "feet", "dm", "um"];

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
    let line = line.replace('²', "2").replace('³', "3").replace("U.S.", "US");
    let runs = runs(&line);
    let lower: Vec<String> = runs.iter().map(|run| run.text.to_lowercase()).collect();
    let mut words: Vec<Word<'_>> = Vec::with_capacity(runs.len());
    for clause in runs.chunk_by(|_, next| !next.gap.contains(ENDS)) {
        let has_two = clause.iter().any(|run| run.text == "2");
        let lower = lower[words.len()..].iter().map(String::as_str);
        let of = |(run, lower)| Word { run, parts: parts(lower, has_two).unwrap_or_default() };
        words.extend(clause.iter().zip(lower).map(of));
    }
    let said = Said {
        has_units: words.iter().any(|word| word.is_of(Kind::Units)),
        of_several: words.iter().any(Word::is_of_several),
        is_capital: runs.iter().all(|run| run.is_capital),
    };
    let mut clauses = words.chunk_by(|_, next| !next.run.gap.contains(ENDS));
    clauses.any(|clause| {
        let value = clause.iter().rposition(|word| word.run.gap.contains([':', '=']));
        let value = value.filter(|at| *at > 0);
        said.is_of_others(clause) || value.is_some_and(|at| said.is_of_others(&clause[at..]))
    }) || is_unknown(&words)
}

/// What a line says as a whole.
struct Said {
    /// Whether it has a word for units, which may be things: unit FM-1 of a series.
    has_units: bool,
    /// Whether it has one that things are seldom called.
    of_several: bool,
    /// Whether it has no small letters, so that capitals mean nothing.
    is_capital: bool,
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
            let is_inch = is_whole && at + 1 == phrase.len() || word.run.is_squared;
            word.parts.iter().any(|(kind, part)| match kind {
                _ if is_si(part) || is_name(part) => false,
                Kind::Amount | Kind::Length if !is_clear => false,
                Kind::Length if word.is_in() => is_inch,
                Kind::Amount | Kind::Length => is_stated || !is_beside || !DOUBTFUL.contains(part),
                Kind::System => self.has_units,
                Kind::Time | Kind::Units | Kind::Measured | Kind::Beside => false,
            })
        };
        (is_whole || is_sure) && phrase.iter().enumerate().any(counts)
    }
}

/// A word or a number.
struct Word<'a> {
    run: &'a Run<'a>,
    /// What it is, if it is a unit or stands beside units.
    parts: Vec<(Kind, &'a str)>,
}

impl Word<'_> {
    fn is_of(&self, kind: Kind) -> bool {
        self.parts.iter().any(|(of, _)| *of == kind)
    }

    /// Whether it is one for units that is no thing: a `unit` is one, too.
    fn is_of_several(&self) -> bool {
        const ONE: [&str; 4] = ["unit", "einheit", "unité", "unidad"];
        self.parts.iter().any(|(kind, word)| *kind == Kind::Units && !ONE.contains(word))
    }

    fn is_measure(&self) -> bool {
        self.is_of(Kind::Amount) || self.is_of(Kind::Length)
    }

    fn is_in(&self) -> bool {
        self.run.text.eq_ignore_ascii_case("in")
    }

    fn is_other(&self) -> bool {
        self.parts.iter().any(|(_, part)| !is_si(part))
    }
}

/// Which words of a clause are units or stand beside units, and neither say how much something is, as in `300 mg` and `0.3 g/cm3`, nor are
/// names, as the FT-2.
fn are_units(words: &[Word<'_>]) -> Vec<bool> {
    let mut has_amount = false;
    let is_power = |at: usize, has_amount: bool| {
        let before = at.checked_sub(1).and_then(|before| words.get(before));
        words.get(at).is_some_and(|word| word.run.text == "2")
            && before.is_some_and(|before| {
                let is_unit = before.is_measure() && (!before.run.is_capital || has_amount);
                before.run.is_squared || is_unit
            })
    };
    // Whether a number that is no power stands before a word, and whether that belongs to the word.
    let (mut is_behind_number, mut is_quantity) = (false, false);
    let one = |(at, word): (usize, &Word<'_>)| {
        let gap = word.run.gap;
        if word.run.is_number() {
            let is_power = is_power(at, has_amount);
            is_behind_number = !is_power;
            return is_power && !is_quantity;
        }
        let next = words.get(at + 1);
        // As in `rev 3 in mm`.
        let is_between = word.is_in() && next.is_some_and(Word::is_measure);
        is_quantity = if std::mem::take(&mut is_behind_number) {
            gap.chars().all(|c| c.is_whitespace() || "-_".contains(c)) && !is_between
        } else {
            is_quantity && !gap.contains(char::is_whitespace)
        };
        let is_short = word.run.is_capital || word.run.text.chars().count() == 1;
        let has_number = next.is_some_and(|next| next.run.is_number());
        let is_thing = is_short && has_number && !is_power(at + 1, has_amount);
        has_amount |= word.is_of(Kind::Amount) && !is_thing;
        !word.parts.is_empty() && !is_quantity && !is_thing
    };
    words.iter().enumerate().map(one).collect()
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
        ] {
            assert!(!speaks_of_others(line), "{line}");
        }
    }
}
