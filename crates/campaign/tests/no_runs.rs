//! Rows of tables that are no runs.

use gyradius_campaign::{ForeignTable, Judgement, Requirement};
use parquet::{
    basic::{Repetition, Type as Physical},
    column::writer::ColumnWriter,
    data_type::ByteArray,
    file::{metadata::KeyValue, properties::WriterProperties, writer::SerializedFileWriter},
    schema::types::Type,
};
use proptest::prelude::*;
use std::{fs::File, path::Path, sync::Arc};

use crate::scratch::scratch;

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
        "99.73 percentile",
        "99.73th",
        "P99.73",
        "95% CI",
        "Mean (n=50)",
        "Average (50 runs)",
        "Mean over runs",
        "Ave.",
        "STDEV.S",
        "Stdabw",
        "µ+3σ",
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

    /// Of numbered runs each has a whole number: a row without one, as an average of numbers has none, was a run, and all runs had the numbers of
    /// their rows. Where none has a whole number, they are names.
    #[test]
    fn a_row_without_a_number_is_no_run_among_numbered_ones(
        runs in prop::collection::vec(prop::sample::select(vec!["7", "8.0", "", "NA", "nominal", "r1", "424.5", "-1"]), 2..12),
        beside in any::<bool>(),
    ) {
        let row = |(at, run): (usize, &&str)| if beside { format!("{at},{run},0\n") } else { format!("{run},0\n") };
        let head = if beside { "id,run,x\n" } else { "run,x\n" };
        let text = format!("{head}{}", runs.iter().enumerate().map(row).collect::<String>());
        let is_numbered = runs.iter().any(|run| ["7", "8.0"].contains(run));
        let without = runs.iter().position(|run| !["7", "8.0", "-1"].contains(run));
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

    /// Where all other rows have whole numbers in the first column, a row with a text there is no run, whatever it says and wherever it stands below
    /// the first row; a first run may have a name, and so may runs among fractions, among other names, and by a number and a letter.
    #[test]
    fn a_text_among_numbers_of_rows_is_no_run(
        numbers in prop::collection::btree_set(-50..50_i32, 3..30),
        shuffled in any::<bool>(),
        word in prop::sample::select(vec!["Mean (x)", "Average of 21", "mean (deg/s)", "N=30", "CV", "Q1", "Worst", "summary", "平均", "Среднее", "---"]),
        place in any::<prop::sample::Index>(),
        heading in prop::sample::select(vec!["id", "sample", "case", ""]),
    ) {
        let mut labels: Vec<String> = numbers.iter().map(i32::to_string).collect();
        if shuffled {
            labels.reverse();
        }
        let count = labels.len() as u64;
        let table = |labels: &[String]| {
            let rows: String = labels.iter().map(|label| format!("{label},0.5\n")).collect();
            format!("{heading},x\n{rows}")
        };
        let with = |place: usize, label: &str| {
            let mut labels = labels.clone();
            labels.insert(place, label.to_owned());
            labels
        };
        let place = 1 + place.index(labels.len());
        let refused = judged(&table(&with(place, word))).unwrap_err();
        let said = format!("it: line {}, column {heading:?}: ", place + 2);
        prop_assert!(refused.starts_with(&said) && refused.contains(&format!("{word:?}")), "{}", refused);
        let all_names = with(place, "run a").into_iter().flat_map(|label| [label, "run b".to_owned()]).collect();
        for valid in [with(0, "nominal"), with(place, "2a"), [with(place, "nominal"), vec!["0.5".to_owned()]].concat(), all_names] {
            prop_assert_eq!(judged(&table(&valid)), Ok([valid.len() as u64, 0]), "{:?} {}", valid, count);
        }
    }

    /// A statistic of a column, in brackets or behind `of`, sums up others, and a case with other words does not.
    #[test]
    fn a_statistic_of_a_column_is_no_run(
        word in prop::sample::select(vec!["Mean", "MEAN", "average", "Std. dev."]),
        form in prop::sample::select(vec![" (?)", "(?)", " [?]", " of ?"]),
        of in prop::sample::select(vec!["x", "X", "rate", "deg/s", "rate [deg/s]"]),
    ) {
        let table = |name: &str| format!("case,x,rate [deg/s]\na,0,1\nb,1,1\n{name},0.5,1\n");
        let said = judged(&table(&format!("{word}{}", form.replace('?', of)))).unwrap_err();
        prop_assert!(said.contains("one that sums up others is no run"), "{}", said);
        for other in ["hot", "night", "y"] {
            let name = format!("{word}{}", form.replace('?', other));
            prop_assert_eq!(judged(&table(&name)), Ok([3, 0]), "{}", name);
        }
    }

    /// A first run whose only number is 1 has a name above whole numbers, and a row of units has none.
    #[test]
    fn a_named_first_run_of_flags_is_a_run(
        flags in prop::collection::vec(any::<bool>(), 2..20),
        name in prop::sample::select(vec!["baseline", "nominal", "as built", "reference-1", "as_flown"]),
        unit in prop::sample::select(vec!["s", "deg", "[-]", "kg*m^2", "rad/s", "%"]),
    ) {
        let rows: String = flags.iter().enumerate().map(|(at, x)| format!("{at},{}\n", u8::from(*x))).collect();
        let runs = flags.len() as u64 + 1;
        prop_assert_eq!(judged(&format!("case,x\n{name},1\n{rows}")), Ok([runs, 0]));
        let refused = judged(&format!("case,x\n{unit},1\n{rows}")).unwrap_err();
        prop_assert!(refused.contains("none but 1, which may be a unit"), "{}", refused);
    }

    /// A row of units has no number, though `-` may stand for one that is missing, and `1` for a unit: it stands above numbers, and a run that failed
    /// has a name among names, or a number.
    #[test]
    fn a_row_of_units_is_no_run(
        runs in prop::collection::vec((-3..3_i32, any::<bool>()), 1..20),
        (unit, none) in prop::sample::select(vec![("s", "-"), ("[s]", "1"), ("time (s)", ""), ("deg", "NA")]),
        names in prop::sample::select(vec!["", "case "]),
    ) {
        let x = |(x, failed): (i32, bool)| if failed { "NA".to_owned() } else { x.to_string() };
        let rows: String = runs.iter().enumerate().map(|(at, run)| format!("{names}{at},,{}\n", x(*run))).collect();
        let failures = runs.iter().filter(|(x, failed)| *failed || *x > 1).count() as u64;
        prop_assert_eq!(judged(&format!("t,note,x\n{rows}")), Ok([runs.len() as u64, failures]));
        let text = format!("t,note,x\n{unit},,{none}\n{rows}");
        match judged(&text) {
            Err(refused) if names.is_empty() => {
                let said = format!("it: line 2, column \"t\": {unit:?} stands above numbers");
                prop_assert!(refused.starts_with(&said), "{}", refused);
            }
            found => {
                let failed = u64::from(none != "1");
                prop_assert_eq!(found, Ok([runs.len() as u64 + 1, failures + failed]), "{}", text);
            }
        }
    }

    /// A row with the number of a run is a run, whatever the number and wherever the row stands: one that failed may have a text where others have
    /// numbers.
    #[test]
    fn a_run_with_a_number_is_no_row_of_units(
        (first, others) in (0..4_u64, 1..9_u64),
        place in any::<prop::sample::Index>(),
        heading in prop::sample::select(vec!["run", "RUN"]),
        text in prop::sample::select(vec!["timeout", "[s]", "m"]),
    ) {
        let mut rows: Vec<String> = (1..=others).map(|at| format!("{},0.5,0\n", first + at)).collect();
        rows.insert(place.index(rows.len() + 1), format!("{first},,{text}\n"));
        let text = format!("{heading},x,error\n{}", rows.concat());
        prop_assert_eq!(judged(&text), Ok([others + 1, 1]), "{}", text);
    }
}

/// Pandas writes the names of the rows behind all other columns, and says so beside the table. Without that, the first column of names has them,
/// and without a column `run` only: texts beside numbers of runs may say anything.
#[test]
fn names_of_rows_are_found_in_parquet() {
    let scratch = scratch();
    let path = scratch.path().join("it.parquet");
    for word in ["mean", "99.73 percentile", "case 3"] {
        let cells = ["case 0", "case 1", word];
        for (index, others) in [
            ("__index_level_0__", &["x"][..]),
            ("case", &["x", "corner"]),
            ("case", &["x", "run"]),
            ("", &["x"]),
            ("", &["x", "run"]),
        ] {
            let names = if index.is_empty() { "note" } else { index };
            write_parquet(&path, others, (names, &cells), index);
            let requirement: Requirement = "x <= 1 in 60 % at 80 %".parse().unwrap();
            let found = Judgement::of_table(&[requirement], &ForeignTable::open(&path).unwrap());
            let may_be_anything = index.is_empty() && others.contains(&"run");
            if word == "case 3" || may_be_anything {
                assert_eq!(found.unwrap()[0].runs(), 3, "{index} {others:?}");
            } else {
                let said = format!("row 2 (from 0), column {names:?}: the row says {word:?}");
                let refused = found.unwrap_err().to_string();
                assert!(refused.contains(&said), "{refused}");
            }
        }
    }
}

/// Columns of the numbers 0, 1, 2, but for `corner`, which is of texts, and names behind them, which are the index that pandas tells if it is called so.
fn write_parquet(path: &Path, others: &[&str], (names, cells): (&str, &[&str]), index: &str) {
    let field = |name: &&str, physical| {
        let field = Type::primitive_type_builder(name, physical);
        Arc::new(field.with_repetition(Repetition::REQUIRED).build().unwrap())
    };
    let kind = |name: &&str| match *name {
        "corner" => Physical::BYTE_ARRAY,
        _ => Physical::DOUBLE,
    };
    let mut fields: Vec<_> = others.iter().map(|name| field(name, kind(name))).collect();
    fields.push(field(&names, Physical::BYTE_ARRAY));
    let schema = Type::group_type_builder("it").with_fields(fields).build().unwrap();
    let told = format!("{{\"index_columns\": [{index:?}], \"columns\": []}}");
    let note = KeyValue::new("pandas".to_owned(), told);
    let properties = WriterProperties::builder().set_key_value_metadata(Some(vec![note])).build();
    let file = File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema.into(), properties.into()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    while let Some(mut column) = group.next_column().unwrap() {
        match column.untyped() {
            ColumnWriter::DoubleColumnWriter(w) => {
                w.write_batch(&[0.0, 1.0, 2.0], None, None).unwrap()
            }
            ColumnWriter::ByteArrayColumnWriter(w) => {
                let is_corner = w.get_descriptor().name() == "corner";
                let cells = if is_corner { &["hot", "cold", "hot"] } else { cells };
                let cells: Vec<ByteArray> =
                    cells.iter().map(|cell| ByteArray::from(*cell)).collect();
                w.write_batch(&cells, None, None).unwrap()
            }
            _ => panic!("no test writes this"),
        };
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
}
