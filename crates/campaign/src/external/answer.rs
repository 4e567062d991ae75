//! The answer of a simulator to one run, as JSON.

use serde::{
    Deserialize, Deserializer,
    de::{MapAccess, Visitor},
};
use serde_json::value::RawValue;
use std::{borrow::Cow, fmt};

use super::{tail::shown, trouble::Trouble};
use crate::column::Column;

/// What a simulator may answer.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Answer<'a> {
    run: Option<u64>,
    #[serde(borrow)]
    outputs: Option<Outputs<'a>>,
    #[serde(borrow)]
    error: Option<Cow<'a, str>>,
}

/// Outputs by name, as written and in the order in which they are written.
struct Outputs<'a>(Vec<(Cow<'a, str>, &'a RawValue)>);

/// The numbers of the declared outputs, in their order, in the answer to a run.
pub(super) fn read(answer: &[u8], run: u64, outputs: &[Column]) -> Result<Vec<f64>, Trouble> {
    // Serde would take a list for the fields in their order.
    if answer.trim_ascii_start().starts_with(b"[") {
        let problem = "it is a list".to_owned();
        return Err(Trouble::NotJson { problem, line: answer.to_vec() });
    }
    let parsed: Answer<'_> = serde_json::from_slice(answer).map_err(|error| {
        match not_a_number(answer) {
            // Python writes these, which JSON does not know.
            Some(value) => Trouble::NotFinite { output: None, value: value.to_owned() },
            None => Trouble::NotJson { problem: error.to_string(), line: answer.to_vec() },
        }
    })?;
    if let Some(answered) = parsed.run.filter(|answered| *answered != run) {
        return Err(Trouble::OutOfTurn { answered });
    }
    let found = match (parsed.outputs, parsed.error) {
        (Some(found), None) => found.0,
        (None, Some(text)) => return Err(Trouble::Error { text: text.into_owned() }),
        (Some(_), Some(_)) | (None, None) => return Err(Trouble::OutputsOrError),
    };
    declared(found, outputs, |value| {
        let number = value.get().parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| shown(value.get().as_bytes(), 40))
    })
}

/// The numbers of the declared outputs, in their order, among what was answered by name; what is no finite number is told as it is
/// shown.
pub(super) fn declared<N: AsRef<str>, V>(
    answered: impl IntoIterator<Item = (N, V)>,
    outputs: &[Column],
    number: impl Fn(V) -> Result<f64, String>,
) -> Result<Vec<f64>, Trouble> {
    let mut numbers = vec![None; outputs.len()];
    for (place, (name, value)) in answered.into_iter().enumerate() {
        let name = name.as_ref();
        // Most simulators write them in the order in which they are declared.
        let here = outputs.get(place).filter(|column| column.name() == name);
        let place = here
            .map(|_| place)
            .or_else(|| outputs.iter().position(|column| column.name() == name))
            .ok_or_else(|| Trouble::Unknown { output: name.to_owned() })?;
        if numbers[place].is_some() {
            return Err(Trouble::Repeated { output: name.to_owned() });
        }
        numbers[place] = Some(
            number(value)
                .map_err(|value| Trouble::NotFinite { output: Some(name.to_owned()), value })?,
        );
    }
    let named = outputs.iter().zip(numbers);
    let number = |(column, number): (&Column, Option<f64>)| {
        number.ok_or_else(|| Trouble::Missing { output: column.name().to_owned() })
    };
    named.map(number).collect()
}

/// The first of the words for numbers that are not finite that stands outside of texts.
fn not_a_number(answer: &[u8]) -> Option<&'static str> {
    let (mut in_text, mut place) = (false, 0);
    while let Some(byte) = answer.get(place) {
        match byte {
            b'\\' if in_text => place += 1,
            b'"' => in_text = !in_text,
            _ if in_text => {}
            _ => {
                let words = ["NaN", "-Infinity", "Infinity", "nan", "-inf", "inf"];
                let found =
                    words.into_iter().find(|word| answer[place..].starts_with(word.as_bytes()));
                if found.is_some() {
                    return found;
                }
            }
        }
        place += 1;
    }
    None
}

impl<'de: 'a, 'a> Deserialize<'de> for Outputs<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Pairs;

        impl<'de> Visitor<'de> for Pairs {
            type Value = Outputs<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object of outputs by name")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut pairs = Vec::new();
                while let Some((name, value)) = map.next_entry::<Name<'de>, &'de RawValue>()? {
                    pairs.push((name.0, value));
                }
                Ok(Outputs(pairs))
            }
        }

        deserializer.deserialize_map(Pairs)
    }
}

/// A name that is borrowed where it can be.
#[derive(Deserialize)]
struct Name<'a>(#[serde(borrow)] Cow<'a, str>);
