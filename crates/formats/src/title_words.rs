//! Which words of a title or a comment of a table are units.

use crate::{
    table_terms::dimension_of,
    unit_words::{Kind, Run, is_si, parts},
    units::Dimension,
};

/// What parts a line into clauses, as cells and brackets are.
const ENDS: [char; 10] = [',', ';', '\t', '|', '(', ')', '[', ']', '{', '}'];

/// A line in one line of plain digits: `10⁻³ kg·m²` and `10^(-3) kg·m2` become `10^-3 kg·m2`.
pub(crate) fn plain(line: &str) -> String {
    const RAISED: [(char, char); 11] = [
        ('⁰', '0'),
        ('¹', '1'),
        ('²', '2'),
        ('³', '3'),
        ('⁴', '4'),
        ('⁵', '5'),
        ('⁶', '6'),
        ('⁷', '7'),
        ('⁸', '8'),
        ('⁹', '9'),
        ('⁻', '-'),
    ];
    let mut plain = String::with_capacity(line.len());
    let (mut is_behind_digit, mut is_raised) = (false, false);
    for c in line.chars() {
        let begins = "({".contains(c) && plain.ends_with('^');
        let ends = is_raised && ")}".contains(c);
        is_raised = begins || is_raised && !ends;
        if begins || ends {
            continue;
        }
        let raised = RAISED.iter().find(|(raised, _)| *raised == c).map(|(_, digit)| *digit);
        if raised.is_some() && is_behind_digit {
            plain.push('^');
        }
        plain.push(raised.unwrap_or(c));
        is_behind_digit = c.is_ascii_digit();
    }
    without_dots(&plain)
}

/// A line in which letters with dots between them are one word: `c.g.` becomes `cg`, `w.r.t.` wrt and `U.S.` US, but `g.m` stays.
pub(crate) fn without_dots(line: &str) -> String {
    let letters: Vec<char> = line.chars().collect();
    let is_dot = |at: usize| letters.get(at) == Some(&'.');
    let is_one = |at: usize| {
        let is_part = |at: usize| letters.get(at).is_some_and(|c| c.is_alphanumeric());
        letters.get(at).is_some_and(|c| c.is_alphabetic())
            && !is_part(at + 1)
            && !at.checked_sub(1).is_some_and(is_part)
    };
    let mut plain = String::with_capacity(line.len());
    let mut at = 0;
    while let Some(letter) = letters.get(at) {
        let mut end = at;
        while is_one(end) && is_dot(end + 1) {
            end += 2;
        }
        // Without a dot behind, it may be a product of two units.
        let is_open = is_one(end) && end > at;
        let is_sure = end - at >= 4 || letter.eq_ignore_ascii_case(&'c');
        if end - at >= 4 && !is_open || is_open && is_sure {
            plain.extend(
                letters
                    .iter()
                    .skip(at)
                    .take(end + usize::from(is_open) - at)
                    .filter(|c| **c != '.'),
            );
            at = end + usize::from(is_open);
        } else {
            plain.push(*letter);
            at += 1;
        }
    }
    plain
}

/// The words of a line, of which the runs and the same in small letters are given.
pub(crate) fn words<'a>(runs: &'a [Run<'a>], lower: &'a [String]) -> Vec<Word<'a>> {
    let mut words: Vec<Word<'_>> = Vec::with_capacity(runs.len());
    let mut is_denied = false;
    for clause in runs.chunk_by(|_, next| !next.gap.contains(ENDS)) {
        let has_two = clause.iter().any(|run| run.text == "2");
        for run in clause {
            let lower = lower.get(words.len()).map_or("", String::as_str);
            let word = Word { run, parts: parts(lower, has_two).unwrap_or_default() };
            // Units behind one of these are none of the table, up to the next word or unit of SI: `not g and mm`, `(converted from lb, in)`.
            let is_more = run.is_number() || lower == "and" || word.is_measure() && word.is_other();
            let denies = ["not", "from", "originally"].contains(&lower);
            is_denied = denies || is_denied && is_more;
            words.push(if is_denied { Word { run, parts: Vec::new() } } else { word });
        }
    }
    let are_names: Vec<bool> = (0..words.len()).map(|at| is_of_name(&words, at)).collect();
    for (word, _) in words.iter_mut().zip(are_names).filter(|(_, is_name)| *is_name) {
        word.parts.clear();
    }
    words
}

/// Whether a word belongs to a name: the capitals of `MIL-STD`, and `G. Foot`.
fn is_of_name(words: &[Word<'_>], at: usize) -> bool {
    let is_joined = |pair: &[Word<'_>]| {
        let [word, next] = pair else { return false };
        let is_of_another = next.parts.is_empty() && !next.run.is_number();
        word.run.is_capital && next.run.gap == "-" && is_of_another
    };
    let is_initial = |pair: &[Word<'_>]| {
        let [word, next] = pair else { return false };
        let begins = next.run.text.starts_with(char::is_uppercase) && !next.run.is_capital;
        let is_letter = word.run.is_capital && word.run.text.chars().count() == 1;
        is_letter && next.run.gap == ". " && begins
    };
    let pair = |at: usize| words.get(at..at + 2).unwrap_or_default();
    is_joined(pair(at))
        || is_initial(pair(at))
        || at.checked_sub(1).is_some_and(|before| is_initial(pair(before)))
}

/// The clauses of a line.
pub(crate) fn clauses<'w, 'a>(words: &'w [Word<'a>]) -> impl Iterator<Item = &'w [Word<'a>]> {
    words.chunk_by(|_, next| !next.run.gap.contains(ENDS))
}

/// A word or a number.
pub(crate) struct Word<'a> {
    pub(crate) run: &'a Run<'a>,
    /// What it is, if it is a unit or stands beside units.
    pub(crate) parts: Vec<(Kind, &'a str)>,
}

impl Word<'_> {
    pub(crate) fn is_of(&self, kind: Kind) -> bool {
        self.parts.iter().any(|(of, _)| *of == kind)
    }

    /// Whether it is one for units that is no thing: a `unit` is one, too.
    pub(crate) fn is_of_several(&self) -> bool {
        const ONE: [&str; 4] = ["unit", "einheit", "unité", "unidad"];
        self.parts.iter().any(|(kind, word)| *kind == Kind::Units && !ONE.contains(word))
    }

    pub(crate) fn is_measure(&self) -> bool {
        self.is_of(Kind::Amount) || self.is_of(Kind::Length)
    }

    /// Whether it is the name of something that has this dimension.
    pub(crate) fn measures(&self, dimension: Dimension) -> bool {
        self.parts.iter().any(|(_, word)| dimension_of(word) == Some(dimension))
    }

    pub(crate) fn is_in(&self) -> bool {
        self.run.text.eq_ignore_ascii_case("in")
    }

    pub(crate) fn is_other(&self) -> bool {
        self.parts.iter().any(|(_, part)| !is_si(part))
    }
}

/// Whether a word in a clause is the name of what is measured there, `t in s` and `CM in m`, or of a point, `CM frame`, or a part of the unit of
/// something else, as a density is: `g/cm3`, a volume or a stress.
fn is_of_another(words: &[Word<'_>], at: usize) -> bool {
    let word = |at: usize| words.get(at);
    let Some(one) = word(at) else { return false };
    let next = word(at + 1);
    let is_measured = next.is_some_and(Word::is_in)
        && word(at + 2).is_some_and(|unit| {
            unit.is_measure() && !unit.is_in()
                || unit.is_of(Kind::Time) && one.run.text.chars().count() == 1
        });
    let is_frame = |next: &Word<'_>| {
        ["frame", "axes"].iter().any(|name| next.run.text.eq_ignore_ascii_case(name))
    };
    // `CGs` are centres of gravity, and CGS is a system.
    let is_point = one.run.text == "CGs" || one.run.text == "CM" && next.is_some_and(is_frame);
    // `g/mm2` may be a slip for `g·mm2`, unless the clause names something else: `areal mass of the blanket in g/m2`.
    let names_another = || {
        let is_named = words.iter().any(|word| word.parts.is_empty() && !word.run.is_number());
        is_named && !words.iter().any(|word| word.measures(Dimension::Inertia))
    };
    let power = |at: usize| word(at + 1).filter(|power| ["", "^"].contains(&power.run.gap));
    let amount =
        |at: usize| at.checked_sub(1).and_then(word).filter(|unit| unit.is_of(Kind::Amount));
    let is_length = |at: usize| word(at).is_some_and(|unit| unit.is_of(Kind::Length));
    let is_volume =
        is_length(at) && amount(at).is_none() && power(at).is_some_and(|p| p.run.text == "3");
    let is_force = |unit: &Word<'_>| {
        unit.parts.iter().any(|(_, part)| ["n", "kn", "mn", "dan", "lbf", "kgf"].contains(part))
    };
    let is_divided = |at: usize| {
        is_length(at)
            && word(at).is_some_and(|unit| unit.run.gap == "/")
            && amount(at).is_some_and(|unit| {
                is_force(unit)
                    || power(at).is_some_and(|power| {
                        power.run.text == "3" || power.run.text == "2" && names_another()
                    })
            })
    };
    is_measured || is_point || is_volume || is_divided(at) || is_divided(at + 1)
}

/// Which words of a clause are units or stand beside units, and neither say how much something is, as in `300 mg` and `0.3 g/cm3`, nor are
/// names, as the FT-2.
pub(crate) fn are_units(words: &[Word<'_>]) -> Vec<bool> {
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
        if is_of_another(words, at) {
            return false;
        }
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
