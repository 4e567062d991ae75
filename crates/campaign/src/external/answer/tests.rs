//! Answers of any form: what is read, what is told of them, and that nothing infinite is lost.

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
        match read(answer.as_bytes(), 3, false, &columns) {
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

    /// Whatever is wrong with an answer beside, in any number and order, before it and behind it: the outputs that are declared and infinite stay,
    /// unless it may be the answer to another run, and something that is wrong is told.
    #[test]
    fn infinite_outputs_stay_whatever_is_wrong(
        values in prop::collection::vec(prop::sample::select(VALUES.to_vec()), 3),
        there in prop::collection::vec(prop::bool::weighted(0.9), 3),
        (in_outputs, beside) in (prop::sample::subsequence(OUTPUTS.to_vec(), 0..=2), prop::sample::subsequence(BESIDE.to_vec(), 0..=3)),
        order: bool,
        (mark, end) in (prop::sample::select(vec!["", "", "\u{feff}"]), prop::sample::select(vec!["}", "}", "", "} # diverged", "};", "}}", "}\n{\"run\": 4}", "} inf"])),
        (other, is_own) in (prop::bool::weighted(0.2), any::<bool>()),
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
        if other {
            fields.insert(0, "\"run\": 4".to_owned());
        }
        let is_json = mark.is_empty() && end == "}";
        let answer = format!("{mark}{{{}{end}", fields.join(","));
        let of = |place: usize| values[place].1.filter(|x| x.is_infinite() && there[place]);
        // One that stands twice is the first that is infinite.
        let again = in_outputs.iter().any(|(text, _)| text.starts_with("\"a\"")).then_some(f64::NEG_INFINITY);
        let infinite = if other && !is_own { [None; 3] } else { [of(0).or(again), of(1), of(2)] };
        let all = (0..3).all(|place| there[place]);
        let finite = (0..3).all(|place| values[place].1.is_some_and(f64::is_finite));
        match read(answer.as_bytes(), 3, is_own, &columns) {
            Ok(_) => prop_assert!(is_json && !other && in_outputs.is_empty() && beside.is_empty() && all && finite, "{}", answer),
            Err(trouble) => {
                let of = infinite.iter().any(Option::is_some).then_some(infinite);
                prop_assert_eq!(trouble.infinite().to_vec(), of.into_iter().flatten().collect::<Vec<_>>(), "{}", answer);
                let told = trouble.failure().message().to_owned();
                // What is wrong with the object comes before what is wrong with its outputs.
                let mut reasons: Vec<&str> = beside.iter().map(|(_, told)| *told).collect();
                if reasons.is_empty() {
                    reasons = in_outputs.iter().map(|(_, told)| *told).collect();
                }
                if !is_json || other {
                    return Ok(());
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
        let found = read(answer(&written).as_bytes(), run, false, &columns);
        match found {
            Ok(_) => prop_assert_eq!(answered, run),
            Err(Trouble::OutOfTurn { answered: told, .. }) => prop_assert!(told == answered && told != run),
            Err(trouble) => prop_assert!(false, "{written}: {trouble:?}"),
        }
        for none in [format!("{answered}.5"), format!("-{answered}.5"), format!("\"{written}\""), "1e999".into()] {
            let refused = read(answer(&none).as_bytes(), run, false, &columns).unwrap_err().failure();
            prop_assert!(refused.message().contains("its `run` must be a whole number"), "{none}: {}", refused.message());
        }
    }

    /// An answer of any bytes is read, and so is one that is cut off.
    #[test]
    fn no_answer_is_too_strange(mut bytes in prop::collection::vec(prop::sample::select(b"{}[]\":,\\ Nainf-I1e.ty".to_vec()), 0..60)) {
        let columns = [Column::number("y", "1", "A number.")];
        let _ = read(&bytes, 3, false, &columns);
        bytes.splice(0..0, *b"{\"outputs\":{\"y\":");
        let _ = read(&bytes, 3, false, &columns);
    }
}

/// A byte order mark is invisible where the answer is shown, so that it is told.
#[test]
fn byte_order_marks_are_told() {
    let columns = [Column::number("y", "1", "A number.")];
    let answer = br#"{"outputs": {"y": 1}}"#;
    assert!(read(answer, 3, false, &columns).is_ok());
    for (mark, told) in [
        (&b"\xef\xbb\xbf"[..], "a byte order mark of UTF-8 (EF BB BF)"),
        (b"\xff\xfe", "a byte order mark of UTF-16 (FF FE)"),
        (b"\xfe\xff", "a byte order mark of UTF-16 (FE FF)"),
    ] {
        let refused = read(&[mark, answer].concat(), 3, false, &columns).unwrap_err();
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
        let told = read(answer.as_bytes(), 3, false, &columns).unwrap_err();
        let Trouble::NotFinite { output: None, value } = told else { panic!("{answer}: {told:?}") };
        assert!(value == "NaN", "{answer}");
    }
}
