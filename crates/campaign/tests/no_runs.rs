//! Rows of tables that are no runs.

use gyradius_campaign::{ForeignTable, Judgement, Requirement};
use proptest::prelude::*;

fn judged(text: &str) -> Result<[u64; 2], String> {
    let requirement: Requirement = "x <= 1 in 60 % at 80 %".parse().unwrap();
    let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
    let judged = Judgement::of_table(&[requirement], &table).map_err(|error| error.to_string())?;
    Ok([judged[0].runs(), judged[0].failures()])
}

/// What the first row that is no run is called in a column `run`, or in the first one.
fn summary() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        "Mean",
        "mean:",
        "Std",
        "Std. Dev.",
        "SD",
        "Standard deviation",
        "sigma",
        "3σ",
        "mean + 3 sigma",
        "Median",
        "RMS",
        "Min",
        "MAX",
        "Range",
        "Variance",
        "Count",
        "Total",
        "Moyenne",
        "Mittelwert",
        "5%",
        "95 %",
        "99.7th percentile",
    ]);
    (word, any::<bool>()).prop_map(
        |(word, quoted)| {
            if quoted { format!("\"{word}\"") } else { word.to_owned() }
        },
    )
}

proptest! {
    /// A row that sums up others is refused wherever it stands, whether its column is called `run` or is the first one, with blank lines before it.
    #[test]
    fn rows_that_sum_up_others_are_refused(
        runs in prop::collection::vec(-3..3_i32, 2..40),
        word in summary(),
        place in any::<prop::sample::Index>(),
        heading in prop::sample::select(vec!["run", "RUN", "sample", "case", ""]),
        separator in prop::sample::select(vec![",", ";", "\t"]),
        (is_last, is_named, is_blank) in any::<(bool, bool, bool)>(),
    ) {
        let is_run = heading.eq_ignore_ascii_case("run");
        // Of a column that is not called so, only the first tells.
        let is_last = is_last && is_run;
        let row = |name: &str, x: &str| {
            let [first, second] = if is_last { [x, name] } else { [name, x] };
            format!("{first}{separator}{second}\n")
        };
        let label = |at: usize| if is_named && !is_run { format!("case {at}") } else { at.to_string() };
        let mut rows: Vec<String> = runs.iter().enumerate().map(|(at, x)| row(&label(at), &x.to_string())).collect();
        let head = row(heading, "x");
        let plain = format!("{head}{}", rows.concat());
        let failures = runs.iter().filter(|x| **x > 1).count() as u64;
        prop_assert_eq!(judged(&plain), Ok([runs.len() as u64, failures]), "{}", plain);
        // Below the first row: a share in it is the name of any row.
        let place = 1 + place.index(rows.len());
        let blank = if is_blank { "\n" } else { "" };
        rows.insert(place, format!("{blank}{}", row(&word, "0.5")));
        let text = format!("{head}{}", rows.concat());
        let refused = judged(&text).unwrap_err();
        // A reader of CSV counts a blank line to the row below it.
        let line = place + 2;
        let word = word.trim_matches('"');
        let said = format!("it: line {line}, column {heading:?}: the row says {word:?}, and one that sums up others is no run");
        prop_assert!(refused.starts_with(&said), "{}{}", text, refused);
    }

    /// Of numbered runs each has a number: a row without one was a run, and all runs had the numbers of their rows. Where none has a whole
    /// number, they are names.
    #[test]
    fn a_row_without_a_number_is_no_run_among_numbered_ones(
        runs in prop::collection::vec(prop::sample::select(vec!["7", "8", "", "NA", "nominal", "r1", "0.5", "-1"]), 2..12),
        beside in any::<bool>(),
    ) {
        let row = |(at, run): (usize, &&str)| if beside { format!("{at},{run},0\n") } else { format!("{run},0\n") };
        let head = if beside { "id,run,x\n" } else { "run,x\n" };
        let text = format!("{head}{}", runs.iter().enumerate().map(row).collect::<String>());
        let is_numbered = runs.iter().any(|run| ["7", "8"].contains(run));
        let without = runs.iter().position(|run| ["", "NA", "nominal", "r1"].contains(run));
        match (without, judged(&text)) {
            (Some(at), Err(refused)) if is_numbered => {
                let said = format!("it: line {}, column \"run\": {:?} is not the number of a run", at + 2, runs[at]);
                prop_assert!(refused.starts_with(&said), "{}{}", text, refused);
            }
            (_, found) => {
                prop_assert!(without.is_none() || !is_numbered, "{}", text);
                prop_assert_eq!(found, Ok([runs.len() as u64, 0]), "{}", text);
            }
        }
    }
}
