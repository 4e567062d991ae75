//! The answer of a simulator to one run, as JSON.

use serde::{
    Deserialize, Deserializer,
    de::{MapAccess, Visitor},
};
use serde_json::value::RawValue;
use std::{borrow::Cow, fmt};

use super::{tail::shown, trouble::Trouble};
use crate::column::Column;

/// The byte order mark of UTF-8.
const UTF_8_MARK: &[u8] = b"\xef\xbb\xbf";

/// What a simulator may answer.
#[derive(Default)]
struct Answer<'a> {
    run: Option<u64>,
    outputs: Option<Object<'a>>,
    error: Option<Name<'a>>,
}

/// The values of an object by name, as written and in the order in which they are written.
struct Object<'a>(Vec<(Name<'a>, &'a RawValue)>);

/// The numbers of the declared outputs, in their order, in the answer to a run. `is_own` says that no other run can have written it, whatever number
/// stands in it.
pub(super) fn read(
    answer: &[u8],
    run: u64,
    is_own: bool,
    outputs: &[Column],
) -> Result<Vec<f64>, Trouble> {
    let not_json = |problem| Trouble::NotJson { problem, line: answer.to_vec() };
    if answer.trim_ascii_start().starts_with(b"[") {
        return Err(not_json("it is a list".to_owned()));
    }
    let marked = byte_order_mark(answer).map(not_json);
    let text = answer.strip_prefix(UTF_8_MARK).unwrap_or(answer);
    let (object, problem) = Object::read(text);
    let with_words = problem.as_ref().and_then(|_| with_words(text));
    let (object, broken) = match &with_words {
        Some((first, text)) => {
            let (object, problem) = Object::read(text);
            let not_finite = |_| Trouble::NotFinite { output: None, value: first.clone() };
            (object, problem.map(not_finite))
        }
        None => (object, problem.map(not_json)),
    };
    let (found, wrong) = Answer::of(object, with_words.is_some(), not_json);
    let other = found.run.filter(|answered| *answered != run);
    let out_of_turn = |answered| Trouble::OutOfTurn { answered, line: answer.to_vec() };
    let wrong = marked.or(broken).or_else(|| other.map(out_of_turn)).or(wrong);
    let numbers = found.outputs.filter(|_| other.is_none() || is_own).map(|found| {
        declared(found.0, outputs, number, |value| {
            let value = word(value).unwrap_or(value.get());
            shown(value.as_bytes(), 40)
        })
    });
    let (trouble, numbers) = match (wrong, numbers, found.error) {
        (None, Some(numbers), None) => return numbers,
        (None, None, Some(Name(text))) => {
            return Err(Trouble::Error { text: text.into_owned() });
        }
        (None, numbers, _) => (Trouble::OutputsOrError, numbers),
        (Some(wrong), numbers, _) => (wrong, numbers),
    };
    Err(trouble.with_infinite_of(numbers.and_then(Result::err)))
}

impl<'a> Answer<'a> {
    /// What an object has of it, and the first thing in the object that is not as agreed.
    fn of(
        object: Object<'a>,
        has_words: bool,
        not_json: impl Fn(String) -> Trouble,
    ) -> (Self, Option<Trouble>) {
        let (mut answer, mut wrong, mut seen) = (Self::default(), None, Vec::new());
        for (Name(key), value) in object.0 {
            let mut must = None;
            match &*key {
                "run" => match value.get() {
                    "null" => answer.run = None,
                    number => match whole(number) {
                        Some(run) => answer.run = Some(run),
                        None => must = Some("a whole number that is not negative"),
                    },
                },
                "outputs" => match serde_json::from_str::<Option<Object<'_>>>(value.get()) {
                    // Where there are several, none of them is lost.
                    Ok(Some(more)) => {
                        answer.outputs.get_or_insert(Object(Vec::new())).0.extend(more.0);
                    }
                    Ok(None) => {}
                    Err(_) => must = Some("an object of outputs by name"),
                },
                "error" => match serde_json::from_str(value.get()) {
                    Ok(error) => answer.error = error,
                    Err(_) => must = Some("a text"),
                },
                other => {
                    let other = shown(other.as_bytes(), 40);
                    let problem = format!(
                        "it has the key `{other}`, and `run`, `outputs` and `error` are all that it may have"
                    );
                    wrong.get_or_insert_with(|| not_json(problem));
                    continue;
                }
            }
            if let Some(must) = must {
                let problem = || not_json(format!("its `{key}` must be {must}"));
                let word = word(&value).filter(|_| has_words).map(str::to_owned);
                wrong.get_or_insert_with(|| match word {
                    Some(value) => Trouble::NotFinite { output: None, value },
                    None => problem(),
                });
            }
            if seen.contains(&key) {
                let problem = format!("it has the key `{key}` more than once");
                wrong.get_or_insert_with(|| not_json(problem));
            }
            seen.push(key);
        }
        (answer, wrong)
    }
}

/// What is wrong with an answer that begins with a byte order mark, which nobody sees: JSON begins with none (RFC 8259, section 8.1).
fn byte_order_mark(answer: &[u8]) -> Option<String> {
    let marks: [(&[u8], &str); 3] =
        [(UTF_8_MARK, "UTF-8"), (b"\xff\xfe", "UTF-16"), (b"\xfe\xff", "UTF-16")];
    let (mark, text) = marks.into_iter().find(|(mark, _)| answer.starts_with(mark))?;
    let mark: Vec<String> = mark.iter().map(|byte| format!("{byte:02X}")).collect();
    Some(format!(
        "it begins with a byte order mark of {text} ({}), which is invisible; it must be UTF-8 without one",
        mark.join(" ")
    ))
}

/// The number that a value is, NaN if it is none; a flag is 1 or 0. One that is infinite may stand in quotation marks, for JSON has none.
fn number(value: &&RawValue) -> f64 {
    let text = value.get();
    if let Ok(flag) = text.parse::<bool>() {
        return f64::from(u8::from(flag));
    }
    let word = text.trim_matches('"');
    let number = word.parse().ok().filter(|number: &f64| number.is_infinite() || word == text);
    number.unwrap_or(f64::NAN)
}

/// The whole number that is not negative which a value is, if it is one: JSON has one kind of numbers, in which 17, 17.0 and 1.7e1 are the same.
fn whole(value: &str) -> Option<u64> {
    // Rust writes any float that is whole as its digits.
    value.parse().ok().or_else(|| value.parse::<f64>().ok()?.to_string().parse().ok())
}

/// The word that stands in the place of a number, if it is one that programs write for a number that is not finite.
fn word<'a>(value: &&'a RawValue) -> Option<&'a str> {
    let word = value.get().trim_matches('"');
    in_json(word).map(|_| word)
}

/// The numbers of the declared outputs, in their order, among what was answered by name; what is no number is NaN, and told as it
/// is shown. Whatever else is wrong, those that are infinite are told.
pub(super) fn declared<N: AsRef<str>, V>(
    answered: impl IntoIterator<Item = (N, V)>,
    outputs: &[Column],
    number: impl Fn(&V) -> f64,
    shown: impl Fn(&V) -> String,
) -> Result<Vec<f64>, Trouble> {
    let mut numbers = vec![None; outputs.len()];
    let (mut wrong, mut not_finite) = (None, None);
    for (place, (name, value)) in answered.into_iter().enumerate() {
        let name = name.as_ref();
        // Most simulators write them in the order in which they are declared.
        let here = outputs.get(place).filter(|column| column.name() == name);
        let place =
            here.map(|_| place).or_else(|| outputs.iter().position(|column| column.name() == name));
        let Some(place) = place else {
            wrong.get_or_insert_with(|| Trouble::Unknown { output: name.to_owned() });
            continue;
        };
        let number = number(&value);
        if numbers[place].is_some() {
            wrong.get_or_insert_with(|| Trouble::Repeated { output: name.to_owned() });
        }
        if numbers[place].is_none_or(|other: f64| !other.is_infinite()) {
            numbers[place] = Some(number);
        }
        if !number.is_finite() {
            not_finite.get_or_insert_with(|| {
                let value = if number.is_nan() { shown(&value) } else { number.to_string() };
                Trouble::NotFinite { output: Some(name.to_owned()), value }
            });
        }
    }
    if let Some(trouble) = wrong.or(not_finite) {
        let infinite = |number: Option<f64>| number.filter(|x| x.is_infinite());
        return Err(trouble.beside(numbers.into_iter().map(infinite).collect()));
    }
    let named = outputs.iter().zip(numbers);
    let number = |(column, number): (&Column, Option<f64>)| {
        number.ok_or_else(|| Trouble::Missing { output: column.name().to_owned() })
    };
    named.map(number).collect()
}

/// What stands in JSON for a word that programs write for a number that is not finite, in small and large letters and with a sign: a
/// number beyond all others, or a text.
fn in_json(word: &str) -> Option<String> {
    let unsigned = word.strip_prefix(['-', '+']).unwrap_or(word).to_ascii_lowercase();
    let sign = if word.starts_with('-') { "-" } else { "" };
    match unsigned.as_str() {
        "inf" | "infinity" | "1.#inf" => Some(format!("{sign}1e999")),
        // C may write which NaN it is in brackets.
        other => {
            let is_nan = other == "nan" || other.starts_with("nan(");
            is_nan.then(|| format!("\"{word}\""))
        }
    }
}

/// Whether a byte may stand in such a word, or in a number.
fn is_of_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b"+-.#()".contains(&byte)
}

/// An answer in which all such words outside of texts are as JSON has them, and the first of them; none if there is none.
fn with_words(answer: &[u8]) -> Option<(String, Vec<u8>)> {
    let (mut first, mut text) = (None, Vec::with_capacity(answer.len()));
    let mut rest = answer;
    while let Some(&byte) = rest.first() {
        let length = match byte {
            b'"' => length_of_text(rest),
            _ => rest.iter().take_while(|byte| is_of_word(**byte)).count().max(1),
        };
        let (own, behind) = rest.split_at(length);
        let word = std::str::from_utf8(own).ok().and_then(|word| Some((word, in_json(word)?)));
        match word {
            Some((word, json)) => {
                first = first.or_else(|| Some(word.to_owned()));
                text.extend_from_slice(json.as_bytes());
            }
            None => text.extend_from_slice(own),
        }
        rest = behind;
    }
    Some((first?, text))
}

/// How many bytes the text has that begins with the first one, with its quotation marks.
fn length_of_text(bytes: &[u8]) -> usize {
    let mut place = 1;
    while let Some(&byte) = bytes.get(place) {
        place += match byte {
            b'"' => return place + 1,
            // What stands after a backslash ends no text.
            b'\\' => 2,
            _ => 1,
        };
    }
    bytes.len()
}

impl<'a> Object<'a> {
    /// What can be read of an object: the values up to where the text is no longer JSON, and why it is not, if it is not.
    fn read(text: &'a [u8]) -> (Self, Option<String>) {
        let mut pairs = Vec::new();
        let mut json = serde_json::Deserializer::from_slice(text);
        let read = json.deserialize_map(Pairs(&mut pairs)).and_then(|()| json.end());
        (Self(pairs), read.err().map(|error| error.to_string()))
    }
}

impl<'de: 'a, 'a> Deserialize<'de> for Object<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut pairs = Vec::new();
        deserializer.deserialize_map(Pairs(&mut pairs))?;
        Ok(Self(pairs))
    }
}

/// Takes the values of an object, and keeps them if what follows cannot be read.
struct Pairs<'p, 'a>(&'p mut Vec<(Name<'a>, &'a RawValue)>);

impl<'de: 'a, 'a> Visitor<'de> for Pairs<'_, 'a> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(pair) = map.next_entry()? {
            self.0.push(pair);
        }
        Ok(())
    }
}

/// A text that is borrowed where it can be.
#[derive(Deserialize)]
struct Name<'a>(#[serde(borrow)] Cow<'a, str>);

impl AsRef<str> for Name<'_> {
    fn as_ref(&self) -> &str {
        &self.0
    }
}

#[cfg(test)]
mod tests;
