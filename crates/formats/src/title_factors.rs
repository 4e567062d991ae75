//! Factors beside the units of a title or a comment of a table: `Inertia in 10^-3 kg·m²`, `1 unit = 25.4 mm`.

use crate::{title_words::Word, unit_words::Kind};

/// Whether a clause has a factor beside a unit, which makes another unit of it, be that one of SI. A number behind another word is a quantity:
/// `of 1000 kg`, `rounded to 1e-6 kg m2`.
pub(crate) fn is_scaled(clause: &[Word<'_>]) -> bool {
    clause.iter().any(Word::is_measure)
        && (0..clause.len())
            .any(|at| Factor::at(clause, at).is_some_and(|factor| factor.scales(clause)))
}

/// A number in a clause.
struct Factor {
    /// Its words.
    start: usize,
    end: usize,
    /// Nothing of `10^-3`.
    value: Option<f64>,
    /// Whether it is written as a power of ten.
    is_power: bool,
}

impl Factor {
    /// The number whose first word is given; nothing within one.
    fn at(clause: &[Word<'_>], start: usize) -> Option<Self> {
        let is_within = |word: &&Word<'_>| {
            let (text, gap) = (word.run.text, word.run.gap);
            (word.run.is_number() || text.eq_ignore_ascii_case("e"))
                && gap.strip_prefix("**").unwrap_or(gap).chars().all(|c| ".^-−+{".contains(c))
        };
        let first = clause.get(start).filter(|word| word.run.is_number())?;
        let before = start.checked_sub(1).and_then(|before| clause.get(before));
        let has_begun = |before: &Word<'_>| is_of_number(before) && !is_cross(before);
        if before.is_some_and(has_begun) && is_within(&first) {
            return None;
        }
        let rest = clause.get(start + 1..).unwrap_or_default();
        let mut written = first.run.text.to_owned();
        let mut end = start + 1;
        for word in rest.iter().take_while(is_within) {
            written = written + word.run.gap + word.run.text;
            end += 1;
        }
        let written = written.to_lowercase().replace('−', "-");
        let value = written.parse::<f64>().ok();
        let is_power = written.starts_with("10^")
            || written.starts_with("10**")
            || value.is_some() && written.contains('e');
        Some(Self { start, end, value, is_power })
    }

    /// Whether it is a factor of the unit beside it.
    fn scales(&self, clause: &[Word<'_>]) -> bool {
        let before: &[Word<'_>] = clause.get(..self.start).unwrap_or_default();
        let gap = clause.get(self.start).map_or("", |word| word.run.gap);
        let behind = clause.get(self.end..).unwrap_or_default();
        let unit = behind.iter().find(|word| !is_cross(word)).filter(|unit| unit.is_measure());
        let Some(last) = before.iter().rfind(|word| !is_of_number(word)) else {
            let is_power = self.is_power || self.is_of_ten() && gap.contains('[');
            return is_power && unit.is_some();
        };
        if last.is_of(Kind::Units) && gap.contains('=') {
            return unit.is_some_and(|unit| unit.is_other() || self.value != Some(1.0));
        }
        let is_behind_unit = last.is_measure() && !last.is_in();
        if self.is_power {
            return is_behind_unit
                || unit.is_some() && (last.is_in() || last.is_of(Kind::Measured));
        }
        let is_divided = is_behind_unit && gap.trim().starts_with(['/', '×', '*', '·']);
        let of = before.iter().rev().nth(1).is_some_and(|word| !word.parts.is_empty());
        self.is_of_ten() && (is_divided || unit.is_some() && last.is_in() && of)
    }

    /// Whether it is a power of ten other than one.
    fn is_of_ten(&self) -> bool {
        self.value.is_some_and(|value| {
            let power = value.log10();
            power != 0.0 && power.is_finite() && (power - power.round()).abs() < 1e-9
        })
    }
}

/// Whether a word is a part of a number, or stands between it and a unit.
fn is_of_number(word: &Word<'_>) -> bool {
    word.run.is_number() || word.run.text.eq_ignore_ascii_case("e") || is_cross(word)
}

fn is_cross(word: &Word<'_>) -> bool {
    word.run.text.eq_ignore_ascii_case("x")
}
