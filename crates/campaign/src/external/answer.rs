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
            Some((key, value)) => {
                let output = key.filter(|key| outputs.iter().any(|column| column.name() == key));
                Trouble::NotFinite { output, value: value.to_owned() }
            }
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

/// The first of the words for numbers that are not finite that stands outside of texts, after the key that it is the value of.
fn not_a_number(answer: &[u8]) -> Option<(Option<String>, &'static str)> {
    let (mut in_text, mut place) = (false, 0);
    // The text before, and where what follows it begins.
    let (mut text, mut after) = (0..0, 0);
    while let Some(byte) = answer.get(place) {
        match byte {
            b'\\' if in_text => place += 1,
            b'"' => {
                in_text = !in_text;
                if in_text {
                    text.start = place;
                } else {
                    (text.end, after) = (place + 1, place + 1);
                }
            }
            _ if in_text => {}
            _ => {
                let words = ["NaN", "-Infinity", "Infinity", "nan", "-inf", "inf"];
                let found =
                    words.into_iter().find(|word| answer[place..].starts_with(word.as_bytes()));
                if let Some(word) = found {
                    let is_key = answer[after..place].trim_ascii() == b":";
                    let key = is_key.then(|| serde_json::from_slice(&answer[text]).ok());
                    return Some((key.flatten(), word));
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// What is no number is told of the output that it is of, whatever that is called and whatever stands around it.
        #[test]
        fn the_output_of_what_is_no_number_is_named(
            name in prop::sample::select(vec!["y", "spin_rad_per_s", "größe", "NaN", "a\\b"]),
            before in prop::sample::select(vec!["", "\"x\": 1.5, ", "\"NaN \\\" inf\": \"-Infinity\", ", "\"x\":[],"]),
            word in prop::sample::select(vec!["NaN", "Infinity", "-Infinity", "nan", "-inf", "inf"]),
            blank in prop::sample::select(vec!["", " ", " \t"]),
            declared in any::<bool>(),
        ) {
            let key = serde_json::to_string(name).unwrap();
            let answer = format!("{{\"run\": 3, \"outputs\": {{{before}{key}{blank}:{blank}{word}, \"z\": NaN}}}}");
            let columns = [if declared { name } else { "z" }, "x"];
            let columns = columns.map(|name| Column::number(name, "1", "A number."));
            let told = read(answer.as_bytes(), 3, &columns).unwrap_err();
            let Trouble::NotFinite { output, value } = told else { panic!("{answer}") };
            prop_assert_eq!(value, word, "{}", answer);
            prop_assert_eq!(output.as_deref(), declared.then_some(name), "{}", answer);
        }
    }

    /// A word that is the value of no output names none.
    #[test]
    fn what_is_of_no_output_names_none() {
        let columns = [Column::number("y", "1", "A number.")];
        for answer in [
            r#"{"run": NaN, "outputs": {"y": 1}}"#,
            r#"{"outputs": {"y": [1, NaN]}}"#,
            "NaN",
            r#"{"outputs": {"y", NaN}}"#,
        ] {
            let told = read(answer.as_bytes(), 3, &columns).unwrap_err();
            assert!(matches!(told, Trouble::NotFinite { output: None, .. }), "{answer}");
        }
    }
}
