//! A text that is taken word by word: names of columns, numbers, shares, signs.

use super::RequirementError;
use crate::number::{of_percent, plain};

/// Shares up to this many per cent are written without the sign.
pub(super) const LEAST_PERCENT: f64 = 1.0;

/// A text that is taken word by word.
#[derive(Clone, Debug)]
pub(crate) struct Words<'a> {
    text: &'a str,
    rest: &'a str,
}

impl<'a> Words<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        Self { text, rest: text.trim() }
    }

    /// What is wrong at this place.
    pub(crate) fn wrong(&self, problem: &str) -> RequirementError {
        let mut rest: String = self.rest.chars().take(20).collect();
        if rest.len() < self.rest.len() {
            rest.push('…');
        }
        let at = if rest.is_empty() { "its end".to_owned() } else { format!("“{rest}”") };
        RequirementError::Text { text: self.text.to_owned(), at, problem: problem.to_owned() }
    }

    /// Whether one of these letters is next.
    pub(crate) fn begins_with(&self, letters: &[char]) -> bool {
        self.rest.starts_with(letters)
    }

    /// Takes these letters if they are next.
    pub(crate) fn take(&mut self, word: &str) -> bool {
        let Some(rest) = self.rest.strip_prefix(word) else { return false };
        self.rest = rest.trim_start();
        true
    }

    pub(crate) fn expect(&mut self, word: &str) -> Result<(), RequirementError> {
        if self.take(word) {
            Ok(())
        } else {
            Err(self.wrong(&format!("there must be “{word}”")))
        }
    }

    /// That nothing is left.
    pub(crate) fn end(&self) -> Result<(), RequirementError> {
        if self.rest.is_empty() { Ok(()) } else { Err(self.wrong("nothing may follow")) }
    }

    /// The name of a column.
    pub(crate) fn name(&mut self) -> Result<String, RequirementError> {
        if let Some(quoted) = self.rest.strip_prefix('"') {
            let mut name = String::new();
            let mut letters = quoted.char_indices();
            while let Some((place, letter)) = letters.next() {
                match letter {
                    '"' => {
                        self.rest = quoted[place + 1..].trim_start();
                        return Ok(name);
                    }
                    '\\' => name.extend(letters.next().map(|(_, letter)| letter)),
                    _ => name.push(letter),
                }
            }
            return Err(self.wrong("a quotation mark must end the name"));
        }
        let end = self.rest.find(|letter| !is_plain(letter)).unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(end);
        if name.is_empty() {
            return Err(self.wrong(
                "there must be the name of a column, in quotation marks if it has more than letters, digits and _.[]",
            ));
        }
        self.rest = rest.trim_start();
        Ok(name.to_owned())
    }

    /// A name as it is written.
    pub(crate) fn quoted(name: &str) -> String {
        if !name.is_empty() && name.chars().all(is_plain) && name.parse::<f64>().is_err() {
            return name.to_owned();
        }
        format!("\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""))
    }

    /// A finite number, if one is next.
    pub(crate) fn number(&mut self) -> Option<f64> {
        let digits = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '+' | '-');
        let end = self.rest.find(|c| !digits(c)).unwrap_or(self.rest.len());
        let (number, rest) = self.rest.split_at(end);
        let number = number.parse::<f64>().ok().filter(|x| x.is_finite())?;
        self.rest = rest.trim_start();
        Some(number)
    }

    /// A share, as `99.73 %` or `0.9973`.
    pub(crate) fn share(&mut self) -> Result<f64, RequirementError> {
        let (number, is_percent) = self.number_of_share()?;
        Ok(if is_percent { of_percent(number) } else { number })
    }

    /// The number of a share as it is written, and whether it is in percent.
    fn number_of_share(&mut self) -> Result<(f64, bool), RequirementError> {
        let number = self
            .number()
            .ok_or_else(|| self.wrong("there must be a share, as 99.73 % or 0.9973"))?;
        Ok((number, self.take("%")))
    }

    /// The share that a requirement asks for, where not all shares are allowed. One of at most [`LEAST_PERCENT`] in percent is refused, with
    /// those that are allowed of the two that may be meant: it is most often one that is meant without.
    pub(super) fn required_share(
        &mut self,
        is_allowed: impl Fn(f64) -> bool,
    ) -> Result<f64, RequirementError> {
        let before = self.clone();
        let (number, is_percent) = self.number_of_share()?;
        if !is_percent {
            return Ok(number);
        }
        let share = of_percent(number);
        if !(0.0 < number && number <= LEAST_PERCENT) {
            return Ok(share);
        }
        let itself = plain(number);
        let meant = [(number, "that".to_owned()), (share, format!("{itself} %"))];
        let meant: Vec<String> = meant
            .into_iter()
            .filter(|(share, _)| is_allowed(*share))
            .map(|(share, meant)| format!("{} if {meant} is the share", plain(share)))
            .collect();
        if meant.is_empty() {
            // Refused for itself.
            return Ok(share);
        }
        let meant = meant.join(", or ");
        Err(before.wrong(&format!(
            "a share of at most 1 % is written without the sign: it must be {meant}"
        )))
    }

    /// At most (true) or at least.
    pub(crate) fn comparison(&mut self) -> Result<bool, RequirementError> {
        if self.take("<=") || self.take("≤") {
            Ok(true)
        } else if self.take(">=") || self.take("≥") {
            Ok(false)
        } else {
            Err(self.wrong("there must be “<=” or “>=”"))
        }
    }
}

fn is_plain(letter: char) -> bool {
    letter.is_alphanumeric() || matches!(letter, '_' | '.' | '[' | ']')
}
