//! A requirement that is written in a line: `abs(x) <= 1 in 99.73 % at 90 %`.

use super::{Bound, Measured, Requirement, RequirementError, words::Words};

/// What a sign begins with.
const SIGNS: [char; 4] = ['<', '>', '≤', '≥'];

/// Reads a requirement from a line, which is its name too.
pub(super) fn parse(text: &str) -> Result<Requirement, RequirementError> {
    let mut words = Words::new(text);
    let (measured, bound) = bounded(&mut words)?;
    words.expect("in")?;
    let probability = words.share()?;
    words.expect("at")?;
    let confidence = words.share()?;
    words.end()?;
    Requirement::new(text.trim(), measured, bound, probability, confidence)
}

/// Reads what is bounded, and how.
pub(super) fn bounded(words: &mut Words<'_>) -> Result<(Measured, Bound), RequirementError> {
    let before = words.clone();
    let first = match words.number() {
        // A name may begin as a number does.
        Some(number) if words.begins_with(&SIGNS) => Some((number, words.comparison()?)),
        Some(_) | None => {
            *words = before;
            None
        }
    };
    let measured = Measured::parse(words)?;
    let bound = match first {
        None => {
            let at_most = words.comparison()?;
            let limit = words.number().ok_or_else(|| words.wrong("there must be a number"))?;
            if at_most { Bound::AtMost(limit) } else { Bound::AtLeast(limit) }
        }
        // `1 <= x` alone says that x is at least 1.
        Some((limit, at_least)) if !words.begins_with(&SIGNS) => {
            if at_least {
                Bound::AtLeast(limit)
            } else {
                Bound::AtMost(limit)
            }
        }
        Some((limit, rising)) => {
            if words.comparison()? != rising {
                return Err(words.wrong("both signs must point the same way"));
            }
            let other = words.number().ok_or_else(|| words.wrong("there must be a number"))?;
            if rising { Bound::Between(limit, other) } else { Bound::Between(other, limit) }
        }
    };
    Ok((measured, bound))
}
