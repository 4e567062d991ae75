//! TOML to what a file holds, with the path of the key that is wrong.

use serde::{
    Deserializer,
    de::{self, DeserializeOwned},
};
use std::ops::Range;
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{
    meant::with_meant,
    placed::{Placed, Step, said},
};

/// Longest reason that is told.
const MOST_CHARACTERS: usize = 400;
/// What is said of a number that is too large begins so.
const WHOLE_NUMBER: &str = "a whole number must be";
/// Longest word of the file that is told.
const MOST_OF_A_WORD: usize = 40;

/// What is wrong with the text of a TOML file: the key, the reason and the line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct TomlError {
    message: String,
}

/// What stands in the text of a TOML file.
///
/// # Errors
/// The text is no TOML, or a key of it is missing, unknown or has a value that is not allowed.
pub fn parse_toml<T: DeserializeOwned>(text: &str) -> Result<T, TomlError> {
    parsed(text).map_err(|message| TomlError { message })
}

fn parsed<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    // From values, which know no lines: the line is looked up where something is wrong.
    let values: toml::Table = toml::from_str(text).map_err(|error| {
        let span = error.span();
        let reason = told(error.message());
        let twice = span.clone().filter(|_| reason == "duplicate key").and_then(|at| text.get(at));
        let reason =
            twice.map_or(reason, |key| format!("{}: the key stands there twice", told(key)));
        let reason = span.clone().and_then(|at| of_value(&reason, &at, text)).unwrap_or(reason);
        located(reason, span.map(|span| span.start), text)
    })?;
    T::deserialize(Placed(values.into())).map_err(|error| {
        let reason = with_meant(&error.reason).unwrap_or_else(|| error.reason.clone());
        let reason = told(&reason);
        let start = start_of(error.path(), reason.starts_with("unknown field"), text);
        let message = located(reason, start, text);
        let path = error.said();
        let missing = error.reason.strip_prefix("missing field `");
        let missing = missing.and_then(|rest| rest.split_once('`')).map(|(name, _)| name);
        let path = match (path.is_empty(), missing) {
            (true, Some(missing)) => missing.to_owned(),
            (false, Some(missing)) => format!("{path}.{missing}"),
            (_, None) => path,
        };
        if path.is_empty() || names(&message, &path) {
            message
        } else {
            format!("{path}: {message}")
        }
    })
}

/// What is wrong where the text is no TOML, if that is a value: with its key, and in our words if the value is a bare word.
fn of_value(reason: &str, at: &Range<usize>, text: &str) -> Option<String> {
    // What could be read of the text all the same has the keys.
    let (table, _) = DeTable::parse_recoverable(text);
    let (span, outwards) = value_at(&DeValue::Table(table.into_inner()), 0..text.len(), at)?;
    let key = said(outwards.iter().rev());
    let word = text.get(span.clone())?;
    if word.is_empty() {
        return Some(format!("{key}: there is no value after the sign `=`"));
    }
    let is_too_large = reason.starts_with(WHOLE_NUMBER);
    if span != *at || is_too_large || word.starts_with(['"', '\'']) {
        return Some(format!("{key}: {reason}"));
    }
    let mut short: String = word.chars().take(MOST_OF_A_WORD).collect();
    if short.len() < word.len() {
        short.push('…');
    }
    Some(format!(
        "{key}: `{short}` is neither a number, `true` nor `false`, and text must be in quotation marks"
    ))
}

/// A value that is neither a list nor a table: its span, and the steps to it, the last first.
type Found = (Range<usize>, Vec<Step>);

/// The value below this one in which something is wrong.
fn value_at(value: &DeValue<'_>, span: Range<usize>, at: &Range<usize>) -> Option<Found> {
    let below = |value: &Spanned<DeValue<'_>>, step: &dyn Fn() -> Step| {
        let (span, mut outwards) = value_at(value.get_ref(), value.span(), at)?;
        outwards.push(step());
        Some((span, outwards))
    };
    match value {
        DeValue::Table(table) => table
            .iter()
            .find_map(|(key, value)| below(value, &|| Step::Key(key.get_ref().to_string()))),
        DeValue::Array(list) => {
            list.iter().enumerate().find_map(|(i, value)| below(value, &|| Step::Entry(i)))
        }
        DeValue::String(_)
        | DeValue::Integer(_)
        | DeValue::Float(_)
        | DeValue::Boolean(_)
        | DeValue::Datetime(_) => {
            let is_in = span.start <= at.start && at.start <= span.end;
            // One that could not be read at all stands at the beginning of the text.
            (is_in && span.end > 0).then_some((span, Vec::new()))
        }
    }
}

/// Where the value at the end of some steps begins in a text, in bytes, or the last key.
fn start_of<'a>(steps: impl Iterator<Item = &'a Step>, at_key: bool, text: &str) -> Option<usize> {
    let mut value = DeValue::Table(DeTable::parse(text).ok()?.into_inner());
    let mut start = 0;
    for step in steps {
        let found = match (step, value) {
            (Step::Key(key), DeValue::Table(mut table)) => {
                table.remove_entry(key.as_str()).map(|(key, below)| (Some(key), below))
            }
            (Step::Entry(index), DeValue::Array(list)) => {
                list.into_iter().nth(*index).map(|below| (None, below))
            }
            (Step::Key(_) | Step::Entry(_), _) => None,
        };
        let Some((key, below)) = found else { break };
        start = match key {
            Some(key) if at_key => key.span().start,
            Some(_) | None => below.span().start,
        };
        value = below.into_inner();
    }
    Some(start)
}

/// Whether a message begins with a key, or with one below it.
fn names(message: &str, key: &str) -> bool {
    message.strip_prefix(key).is_some_and(|rest| rest.starts_with(['.', '[', ':', ' ']))
}

/// The reason in our words.
fn told(reason: &str) -> String {
    let mut message = reason.trim_end().to_owned();
    if let Some((reason, _)) = message.split_once("expected struct ") {
        message = format!("{reason}expected a table");
    }
    if let Some(reason) = message.strip_suffix("expected f64") {
        message = format!("{reason}expected a number");
    }
    if message == "u64 value was too large" || message.contains("` as i128") {
        message = format!("{WHOLE_NUMBER} from {} to {}", i64::MIN, i64::MAX);
    }
    let mut message = short_numbers(&message);
    if let Some((end, _)) = message.char_indices().nth(MOST_CHARACTERS) {
        message.truncate(end);
        message.push('…');
    }
    message
}

/// A reason with its line. Not the line itself, which may be of any length.
fn located(reason: String, start: Option<usize>, text: &str) -> String {
    let Some(before) = start.and_then(|start| text.get(..start)) else {
        return reason;
    };
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
    format!("{reason} (line {line}, column {column})")
}

/// Numbers that are written out in hundreds of digits, in a few.
fn short_numbers(text: &str) -> String {
    let number = |c: char| c.is_ascii_digit() || c == '.';
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(number) {
        let length = rest[start..].find(|c| !number(c)).unwrap_or(rest.len() - start);
        let digits = &rest[start..start + length];
        out.push_str(&rest[..start]);
        match digits.parse::<f64>() {
            Ok(value) if length > 25 => out.push_str(&format!("{value:?}")),
            _ => out.push_str(digits),
        }
        rest = &rest[start + length..];
    }
    out + rest
}

/// A whole number, which may be written as `1e6` as well.
pub(crate) fn whole<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    struct Whole;
    impl de::Visitor<'_> for Whole {
        type Value = u64;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str(
                "a whole number that is not negative, and of 9007199254740992 or more with all its digits",
            )
        }

        fn visit_i64<E: de::Error>(self, value: i64) -> Result<u64, E> {
            u64::try_from(value).map_err(|_| E::invalid_value(de::Unexpected::Signed(value), &self))
        }

        fn visit_u64<E>(self, value: u64) -> Result<u64, E> {
            Ok(value)
        }

        fn visit_f64<E: de::Error>(self, value: f64) -> Result<u64, E> {
            whole_number(value).ok_or_else(|| E::invalid_value(de::Unexpected::Float(value), &self))
        }
    }
    deserializer.deserialize_any(Whole)
}

/// The same where it may be left out.
pub(crate) fn some_whole<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<u64>, D::Error> {
    whole(deserializer).map(Some)
}

/// A whole number that is written as `1e6`: none if it is negative, has a fraction, or is so large
/// that its last digits are not certain.
#[must_use]
pub fn whole_number(value: f64) -> Option<u64> {
    // 2⁵³ is what 2⁵³ + 1 is read as, too.
    let certain = (0.0..2f64.powi(53)).contains(&value) && value.fract() == 0.0;
    certain.then_some(value as u64)
}

/// That a key is not known where others are.
pub(super) fn unknown(
    key: &str,
    known: impl IntoIterator<Item = impl std::fmt::Display>,
) -> String {
    let known: Vec<_> = known.into_iter().map(|key| format!("`{key}`")).collect();
    format!("unknown field `{key}`, expected one of {}", known.join(", "))
}

/// In a visitor that takes a number: whole ones too.
macro_rules! whole_numbers {
    () => {
        fn visit_i64<E: serde::de::Error>(self, number: i64) -> Result<Self::Value, E> {
            self.visit_f64(number as f64)
        }

        fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<Self::Value, E> {
            self.visit_f64(number as f64)
        }
    };
}
pub(super) use whole_numbers;
