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
#[derive(Default)]
struct Answer<'a> {
    run: Option<u64>,
    outputs: Option<Object<'a>>,
    error: Option<Name<'a>>,
}

/// The values of an object by name, as written and in the order in which they are written.
struct Object<'a>(Vec<(Name<'a>, &'a RawValue)>);

/// The numbers of the declared outputs, in their order, in the answer to a run.
pub(super) fn read(answer: &[u8], run: u64, outputs: &[Column]) -> Result<Vec<f64>, Trouble> {
    let not_json = |problem| Trouble::NotJson { problem, line: answer.to_vec() };
    if answer.trim_ascii_start().starts_with(b"[") {
        return Err(not_json("it is a list".to_owned()));
    }
    if let Some(problem) = byte_order_mark(answer) {
        return Err(not_json(problem));
    }
    let with_words_in_json;
    let (object, has_words): (Object<'_>, _) = match serde_json::from_slice(answer) {
        Ok(object) => (object, false),
        Err(error) => {
            let (first, text) = with_words(answer).ok_or_else(|| not_json(error.to_string()))?;
            with_words_in_json = text;
            let not_finite = |_| Trouble::NotFinite { output: None, value: first };
            (serde_json::from_slice(&with_words_in_json).map_err(not_finite)?, true)
        }
    };
    let (found, wrong) = Answer::of(object, has_words, not_json);
    if let Some(answered) = found.run.filter(|answered| *answered != run) {
        return Err(Trouble::OutOfTurn { answered, line: answer.to_vec() });
    }
    let numbers = found.outputs.map(|found| {
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
        [(b"\xef\xbb\xbf", "UTF-8"), (b"\xff\xfe", "UTF-16"), (b"\xfe\xff", "UTF-16")];
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

impl<'de: 'a, 'a> Deserialize<'de> for Object<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Pairs;

        impl<'de> Visitor<'de> for Pairs {
            type Value = Object<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(Object(pairs))
            }
        }

        deserializer.deserialize_map(Pairs)
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
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// What may stand in the place of a number, which number that is, and how it is told.
    const VALUES: [(&str, Option<f64>, &str); 28] = [
        ("-1.5e3", Some(-1500.0), ""),
        ("0", Some(0.0), ""),
        ("1e-999", Some(0.0), ""),
        ("1e999", Some(f64::INFINITY), "inf"),
        ("-1e400", Some(f64::NEG_INFINITY), "-inf"),
        ("Infinity", Some(f64::INFINITY), "inf"),
        ("-Infinity", Some(f64::NEG_INFINITY), "-inf"),
        ("inf", Some(f64::INFINITY), "inf"),
        ("-inf", Some(f64::NEG_INFINITY), "-inf"),
        ("\"Infinity\"", Some(f64::INFINITY), "inf"),
        ("\"-inf\"", Some(f64::NEG_INFINITY), "-inf"),
        ("NaN", None, "NaN"),
        ("nan", None, "nan"),
        ("Inf", Some(f64::INFINITY), "inf"),
        ("-INF", Some(f64::NEG_INFINITY), "-inf"),
        ("+inf", Some(f64::INFINITY), "inf"),
        ("+Infinity", Some(f64::INFINITY), "inf"),
        ("-1.#INF", Some(f64::NEG_INFINITY), "-inf"),
        ("-nan", None, "-nan"),
        ("-nan(ind)", None, "-nan(ind)"),
        ("\"NaN\"", None, "NaN"),
        ("null", None, "null"),
        ("\"1.5\"", None, "\"1.5\""),
        ("\"an \\\"inf\"", None, "\"an \\\"inf\""),
        ("[1]", None, "[1]"),
        ("true", Some(1.0), ""),
        ("false", Some(0.0), ""),
        ("\"true\"", None, "\"true\""),
    ];

    /// What may be wrong among the outputs, and what is told of it.
    const OUTPUTS: [(&str, &str); 3] = [
        ("\"steps\": 3", "an output `steps`, which is not declared"),
        ("\"inf\": Infinity", "an output `inf`, which is not declared"),
        ("\"a\": -Infinity", ""),
    ];

    /// What may be wrong beside the outputs, and what is told of it.
    const BESIDE: [(&str, &str); 7] = [
        ("\"elapsed\": 1", "it has the key `elapsed`, and `run`, `outputs` and `error` are"),
        ("\"worst\": NaN", "it has the key `worst`, and"),
        ("\"error\": \"both\"", "either `outputs` or `error`"),
        ("\"error\": 7", "its `error` must be a text"),
        ("\"run\": \"three\"", "its `run` must be a whole number"),
        ("\"run\": -1", "its `run` must be a whole number"),
        ("\"outputs\": 1", "its `outputs` must be an object"),
    ];

    proptest! {
        /// Whatever stands in the places of numbers, in whatever order: all numbers if they are finite, and otherwise the first that is
        /// not, by its name, with those that are infinite.
        #[test]
        fn numbers_are_read_or_told(
            answered in Just(vec!["y", "größe", "NaN", "a\\b \"inf\": "]).prop_shuffle(),
            values in prop::collection::vec(prop::sample::select(VALUES.to_vec()), 4),
            blank in prop::sample::select(vec!["", " ", " \t"]),
        ) {
            let pairs = answered.iter().zip(&values).map(|(name, (text, ..))| {
                format!("{}{blank}:{blank}{text}", serde_json::to_string(name).unwrap())
            });
            let answer = format!("{{\"run\": 3, \"outputs\": {{{}}}}}", pairs.collect::<Vec<_>>().join(","));
            let columns = ["NaN", "y", "a\\b \"inf\": ", "größe"];
            let of = |name: &str| values[answered.iter().position(|other| *other == name).unwrap()].1;
            let expected = columns.map(of);
            let columns = columns.map(|name| Column::number(name, "1", "A number."));
            let is_finite = |x: &Option<f64>| x.is_some_and(f64::is_finite);
            match read(answer.as_bytes(), 3, &columns) {
                Ok(numbers) => prop_assert_eq!(numbers.into_iter().map(Some).collect::<Vec<_>>(), expected, "{}", answer),
                Err(trouble) => {
                    let infinite = trouble.infinite().to_vec();
                    let Trouble::NotFinite { output, value } = trouble.alone() else { panic!("{answer}") };
                    let first = values.iter().position(|(_, number, _)| !is_finite(number)).unwrap();
                    prop_assert_eq!(output.as_deref(), Some(answered[first]), "{}", answer);
                    prop_assert_eq!(value, values[first].2, "{}", answer);
                    let of = expected.map(|number| number.filter(|x| x.is_infinite()));
                    let of = of.iter().any(Option::is_some).then_some(of);
                    prop_assert_eq!(infinite, of.into_iter().flatten().collect::<Vec<_>>(), "{}", answer);
                }
            }
        }

        /// Whatever is wrong with an answer beside, in any number and order: the outputs that are declared and infinite stay, unless the
        /// answer is that of another run, and something that is wrong is told.
        #[test]
        fn infinite_outputs_stay_whatever_is_wrong(
            values in prop::collection::vec(prop::sample::select(VALUES.to_vec()), 3),
            there in prop::collection::vec(prop::bool::weighted(0.9), 3),
            (in_outputs, beside) in (prop::sample::subsequence(OUTPUTS.to_vec(), 0..=2), prop::sample::subsequence(BESIDE.to_vec(), 0..=3)),
            order: bool,
        ) {
            let names = ["a", "b", "c"];
            let columns = names.map(|name| Column::number(name, "1", "A number."));
            let pairs = names.iter().zip(&values).zip(&there).filter(|(_, there)| **there);
            let mut pairs: Vec<String> = pairs.map(|((name, (text, ..)), _)| format!("\"{name}\":{text}")).collect();
            pairs.extend(in_outputs.iter().map(|(text, _)| (*text).to_owned()));
            let mut fields = vec![format!("\"outputs\":{{{}}}", pairs.join(","))];
            fields.extend(beside.iter().map(|(text, _)| (*text).to_owned()));
            if order {
                fields.reverse();
            }
            let answer = format!("{{{}}}", fields.join(","));
            let of = |place: usize| values[place].1.filter(|x| x.is_infinite() && there[place]);
            // One that stands twice is the first that is infinite.
            let again = in_outputs.iter().any(|(text, _)| text.starts_with("\"a\"")).then_some(f64::NEG_INFINITY);
            let infinite = [of(0).or(again), of(1), of(2)];
            let all = (0..3).all(|place| there[place]);
            let finite = (0..3).all(|place| values[place].1.is_some_and(f64::is_finite));
            match read(answer.as_bytes(), 3, &columns) {
                Ok(_) => prop_assert!(in_outputs.is_empty() && beside.is_empty() && all && finite, "{}", answer),
                Err(trouble) => {
                    let of = infinite.iter().any(Option::is_some).then_some(infinite);
                    prop_assert_eq!(trouble.infinite().to_vec(), of.into_iter().flatten().collect::<Vec<_>>(), "{}", answer);
                    let told = trouble.failure().message().to_owned();
                    // What is wrong with the object comes before what is wrong with its outputs.
                    let mut reasons: Vec<&str> = beside.iter().map(|(_, told)| *told).collect();
                    if reasons.is_empty() {
                        reasons = in_outputs.iter().map(|(_, told)| *told).collect();
                    }
                    let is_told = reasons.iter().any(|reason| told.contains(reason));
                    prop_assert!(is_told || reasons.is_empty() && (told.contains("is not a finite number") || !all), "{answer}: {told}");
                }
            }
        }

        /// The number of a run is the number that is written, in whatever form, and only that one is taken.
        #[test]
        fn runs_are_numbers_in_any_form(
            run in prop_oneof![0..2000_u64, 0..1_000_000_000_u64],
            other in prop_oneof![Just(None), (0..2000_u64).prop_map(Some)],
            form in 0..5_u8,
        ) {
            let columns = [Column::number("y", "1", "A number.")];
            let answered = other.unwrap_or(run);
            let written = match form {
                0 => answered.to_string(),
                1 => format!("{answered}.0"),
                2 => format!("{answered}.000e0"),
                3 => format!("{:e}", answered as f64),
                _ => format!("{answered}00E-2"),
            };
            let answer = |run: &str| format!("{{\"run\": {run}, \"outputs\": {{\"y\": 1}}}}");
            let found = read(answer(&written).as_bytes(), run, &columns);
            match found {
                Ok(_) => prop_assert_eq!(answered, run),
                Err(Trouble::OutOfTurn { answered: told, .. }) => prop_assert!(told == answered && told != run),
                Err(trouble) => prop_assert!(false, "{written}: {trouble:?}"),
            }
            for none in [format!("{answered}.5"), format!("-{answered}.5"), format!("\"{written}\""), "1e999".into()] {
                let refused = read(answer(&none).as_bytes(), run, &columns).unwrap_err().failure();
                prop_assert!(refused.message().contains("its `run` must be a whole number"), "{none}: {}", refused.message());
            }
        }

        /// An answer of any bytes is read, and so is one that is cut off.
        #[test]
        fn no_answer_is_too_strange(mut bytes in prop::collection::vec(prop::sample::select(b"{}[]\":,\\ Nainf-I1e.ty".to_vec()), 0..60)) {
            let columns = [Column::number("y", "1", "A number.")];
            let _ = read(&bytes, 3, &columns);
            bytes.splice(0..0, *b"{\"outputs\":{\"y\":");
            let _ = read(&bytes, 3, &columns);
        }
    }

    /// A byte order mark is invisible where the answer is shown, so that it is told.
    #[test]
    fn byte_order_marks_are_told() {
        let columns = [Column::number("y", "1", "A number.")];
        let answer = br#"{"outputs": {"y": 1}}"#;
        assert!(read(answer, 3, &columns).is_ok());
        for (mark, told) in [
            (&b"\xef\xbb\xbf"[..], "a byte order mark of UTF-8 (EF BB BF)"),
            (b"\xff\xfe", "a byte order mark of UTF-16 (FF FE)"),
            (b"\xfe\xff", "a byte order mark of UTF-16 (FE FF)"),
        ] {
            let refused = read(&[mark, answer].concat(), 3, &columns).unwrap_err();
            let Trouble::NotJson { problem, .. } = refused else { panic!("{refused:?}") };
            assert!(problem.contains(told), "{problem}");
        }
    }

    /// A word that is the value of no output names none.
    #[test]
    fn what_is_of_no_output_names_none() {
        let columns = [Column::number("y", "1", "A number.")];
        for answer in [
            r#"{"run": NaN, "outputs": {"y": 1}}"#,
            "NaN",
            r#"{"outputs": {"y", NaN}}"#,
            r#"{"outputs": {"y": [NaN}}"#,
        ] {
            let told = read(answer.as_bytes(), 3, &columns).unwrap_err();
            let Trouble::NotFinite { output: None, value } = told else {
                panic!("{answer}: {told:?}")
            };
            assert!(value == "NaN", "{answer}");
        }
    }
}
