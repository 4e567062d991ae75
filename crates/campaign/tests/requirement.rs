//! Requirements judged by tables of other programs, held against counting and sorting.

use gyradius_campaign::{
    Bound, Cell, Column, Distribution, FailedRuns, ForeignTable, Judgement, Judging, Measured,
    Requirement, Runs, Table, Verdict,
};
use parquet::{
    data_type::{BoolType, DoubleType, FloatType, Int32Type, Int64Type},
    file::{properties::WriterProperties, writer::SerializedFileWriter},
    schema::parser::parse_message_type,
};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::{fmt::Write, fs, path::Path, sync::Arc};

use crate::scratch::scratch;

/// Numbers of three columns, some of which are missing.
fn rows() -> impl Strategy<Value = Vec<[Option<f64>; 3]>> {
    let number = prop_oneof![
        6 => (-4.0..4.0).prop_map(Some),
        2 => prop::sample::select(vec![-1.0, -0.0, 0.0, 1.0, 2.0]).prop_map(Some),
        1 => Just(None),
        1 => prop::sample::select(vec![f64::INFINITY, f64::NEG_INFINITY]).prop_map(Some),
    ];
    prop::collection::vec([number.clone(), number.clone(), number], 1..400)
}

/// What a row has of a quantity.
type OfRow = fn(&[Option<f64>; 3]) -> Option<f64>;

fn quantity() -> impl Strategy<Value = (&'static str, OfRow)> {
    prop::sample::select(vec![
        ("x", (|row| row[0]) as OfRow),
        ("abs(\"y, as drawn\")", |row| row[1].map(f64::abs)),
        ("norm(x, \"y, as drawn\", z[1])", |row| {
            // No length is less than one of its parts.
            if row.contains(&Some(f64::INFINITY)) || row.contains(&Some(f64::NEG_INFINITY)) {
                return Some(f64::INFINITY);
            }
            let [x, y, z] = [row[0]?, row[1]?, row[2]?];
            Some(libm::hypot(libm::hypot(x.abs(), y), z))
        }),
    ])
}

fn bound() -> impl Strategy<Value = Bound> {
    prop_oneof![
        (-3.0..3.0).prop_map(Bound::AtMost),
        (-3.0..3.0).prop_map(Bound::AtLeast),
        Just(Bound::AtMost(1.0)),
        (-3.0..3.0, 0.0..4.0).prop_map(|(lower, width)| Bound::Between(lower, lower + width)),
    ]
}

/// Probability that of `n` runs, each of which fails with this probability, at most `k` do.
fn at_most(k: u64, n: u64, failing: f64) -> f64 {
    let mut ln = n as f64 * (-failing).ln_1p();
    let mut sum = ln.exp();
    for i in 0..k {
        ln += ((n - i) as f64).ln() - ((i + 1) as f64).ln() + failing.ln() - (-failing).ln_1p();
        sum += ln.exp();
    }
    sum
}

/// Failures that so many runs may have, by trying.
fn allowed(n: u64, probability: f64, confidence: f64) -> Option<u64> {
    (0..=n).take_while(|k| at_most(*k, n, 1.0 - probability) <= 1.0 - confidence).last()
}

fn csv(rows: &[[Option<f64>; 3]], separator: char, missing: &str) -> String {
    let cell = |x: &Option<f64>| x.map_or(missing.to_owned(), |x| x.to_string());
    let mut text = format!("run{separator}x{separator}\"y, as drawn\"{separator}z[1]\n");
    for (run, row) in rows.iter().enumerate() {
        let [x, y, z] = row.each_ref().map(cell);
        writeln!(text, "{run}{separator}{x}{separator}{y}{separator}{z}").unwrap();
    }
    text
}

/// That distribution and estimates of a judgement are those of sorting and counting the numbers of all runs.
fn told_of_all(judged: &Judgement, numbers: &[Option<f64>], left_out: bool) {
    let bound = judged.requirement().bound();
    let of_runs = numbers.iter().copied().flatten();
    let mut sorted: Vec<f64> = of_runs.filter(|x| x.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let counted = numbers.iter().filter(|x| x.is_some() || !left_out).count();
    let without = counted - sorted.len();
    let below = if matches!(bound, Bound::AtLeast(_)) { without } else { 0 };
    let n = (sorted.len() + without) as f64;
    let points = judged.distribution().map_or(&[][..], Distribution::points);
    // The least and the greatest are there, and all of few.
    assert_eq!(points.first().map(|p| p.value), sorted.first().copied());
    assert_eq!(points.last().map(|p| p.value), sorted.last().copied());
    assert!(points.len() == sorted.len() || points.len() < sorted.len() && points.len() >= 10);
    for point in points {
        assert_eq!(point.value, sorted[point.rank as usize - below - 1]);
        assert_eq!(point.share, (point.rank as f64 - 0.5) / n);
        assert!(0.0 <= point.lower && point.lower < point.share && point.share < point.upper);
    }
    assert!(points.windows(2).all(|p| p[0].lower <= p[1].lower && p[0].upper <= p[1].upper));
    let counted = numbers.iter().filter(|x| x.is_some() || !left_out);
    let fails: Vec<bool> = counted.map(|x| x.is_none_or(|x| !bound.is_kept(x))).collect();
    let told = judged.convergence();
    assert_eq!(
        told.last().map(|all| (all.runs, all.failures)),
        (!fails.is_empty()).then(|| (judged.counted(), judged.failures()))
    );
    for estimate in told {
        let failures = fails[..estimate.runs as usize].iter().filter(|fails| **fails).count();
        assert_eq!(estimate.failures, failures as u64);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Every number of a judgement is that of counting and sorting, whatever the quantity, bound, share and confidence.
    #[test]
    fn judgements_are_those_of_counting_and_sorting(
        rows in rows(),
        (name, value) in quantity(),
        bound in bound(),
        probability in prop_oneof![0.5..0.99, Just(0.9)],
        confidence in 0.5..0.99,
        left_out in any::<bool>(),
        separator in prop::sample::select(vec![',', ';', '\t']),
        missing in prop::sample::select(vec!["", "nan", "NaN", "NA"]),
    ) {
        let scratch = scratch();
        let path = scratch.path().join("runs.csv");
        let text = csv(&rows, separator, missing);
        fs::write(&path, &text).unwrap();
        let table = ForeignTable::open(&path).unwrap();
        let handed = ForeignTable::read_csv(&path, text.as_bytes()).unwrap();
        let failed = if left_out { FailedRuns::LeftOut } else { FailedRuns::Against };
        let quantity: Measured = name.parse().unwrap();
        let requirement = Requirement::new("it", quantity, bound, probability, confidence).unwrap();
        let requirement = requirement.with_failed_runs(failed);
        let requirement = [requirement];
        let judged = Judgement::of_table(&requirement, &table).unwrap();
        prop_assert_eq!(&Judgement::of_table(&requirement, &handed).unwrap(), &judged);
        let told = serde_json::to_value(&judged[0]).unwrap();

        let values: Vec<(u64, f64)> =
            (0..).zip(&rows).filter_map(|(run, row)| Some((run, value(row).filter(|x| x.is_finite())?))).collect();
        let without = rows.iter().filter(|row| value(row).is_none()).count() as u64;
        let infinite = rows.len() as u64 - values.len() as u64 - without;
        let beyond = values.iter().filter(|(_, x)| !bound.is_kept(*x)).count() as u64;
        // An infinite number is a failure, of either sign, and is not left out.
        let worse = infinite + if left_out { 0 } else { without };
        let (n, failures) = (values.len() as u64 + worse, beyond + worse);
        prop_assert_eq!(&told["runs"], rows.len());
        prop_assert_eq!(&told["runs_without_number"], without);
        prop_assert_eq!(judged[0].runs_infinite(), infinite);
        prop_assert_eq!((judged[0].counted(), judged[0].failures()), (n, failures));
        let may = (n > 0).then(|| allowed(n, probability, confidence)).flatten();
        prop_assert_eq!(judged[0].allowed_failures(), may);
        prop_assert_eq!(judged[0].verdict() == Verdict::Met, may.is_some_and(|may| failures <= may));
        // It is not met if the complement is shown as surely.
        let not = n > 0 && 1.0 - at_most(failures.saturating_sub(1), n, 1.0 - probability) <= 1.0 - confidence && failures > 0;
        prop_assert_eq!(judged[0].verdict() == Verdict::NotMet, not);

        let mut excess: Vec<(f64, u64)> =
            values.iter().map(|(run, x)| (bound.excess(*x), *run)).collect();
        excess.sort_by(|a, b| b.0.partial_cmp(&a.0).unwrap().then(a.1.cmp(&b.1)));
        let worst: Vec<u64> = excess.iter().take(10).map(|(_, run)| *run).collect();
        prop_assert_eq!(judged[0].worst().iter().map(|run| run.run).collect::<Vec<_>>(), worst);
        let place = may.and_then(|may| may.checked_sub(worse));
        let margin = place.and_then(|place| excess.get(place as usize)).map(|(excess, _)| 0.0 - excess);
        prop_assert_eq!(told["margin"].as_f64(), margin);
        // Met is the same as a margin that is not negative.
        if let Some(margin) = margin {
            prop_assert_eq!(judged[0].verdict() == Verdict::Met, margin >= 0.0);
        }
        let read: Judgement = serde_json::from_str(&told.to_string()).unwrap();
        prop_assert_eq!(&read, &judged[0]);
        let numbers: Vec<Option<f64>> = rows.iter().map(value).collect();
        told_of_all(&judged[0], &numbers, left_out);
    }

    /// Runs in blocks of any size, flights of vehicles or not, with ties and failures: the order statistics are those of sorting,
    /// and the estimates those of counting.
    #[test]
    fn blocks_of_any_size_tell_the_same_distribution(
        n in prop_oneof![1..300_usize, 33_000..90_000_usize],
        (ties, failing) in (prop::sample::select(vec![0.0, 7.0, 1e5]), prop::sample::select(vec![0.0, 1e-4, 0.3, 1.0])),
        bound in bound(),
        (group, block) in (1_usize..5, 1_usize..40),
        left_out in any::<bool>(),
        seed in any::<u64>(),
    ) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let numbers: Vec<Option<f64>> = (0..n)
            .map(|_| {
                let (u, v): (f64, f64) = (rng.random(), rng.random());
                let x = (2.0 * u - 1.0).powi(3) * 4.0;
                (v >= failing).then(|| if ties > 0.0 { (x * ties).round() / ties } else { x })
            })
            .collect();
        let failed = if left_out { FailedRuns::LeftOut } else { FailedRuns::Against };
        let requirement = Requirement::new("it", Measured::column("x"), bound, 0.9, 0.8).unwrap();
        let looks = [1, n / 3 + 1, n / 2 + 2, n + 7];
        let judging = Judging::new([requirement.with_failed_runs(failed)], n as u64, group as u64);
        let judging = judging.looked_after(&looks.map(|look| look as u64));
        let column = || vec![Column::number("x", "1", "A number.")];
        let mut whole = Table::new("model", 0, column()).unwrap();
        let size = n.div_ceil(block);
        for (i, block) in numbers.chunks(size).enumerate() {
            let mut table = Table::new("model", (i * size) as u64, column()).unwrap();
            for x in block {
                table.push(None, [Cell::from(*x)]).unwrap();
                whole.push(None, [Cell::from(*x)]).unwrap();
            }
            judging.look(&table);
        }
        let judged = judging.finish(&Runs::from(whole)).unwrap();
        let of_first: Vec<Option<f64>> = numbers.iter().copied().step_by(group).collect();
        told_of_all(&judged[0], &of_first, left_out);
        let at = |look: usize| of_first.iter().take(look.div_ceil(group)).filter(|x| x.is_some() || !left_out).count();
        prop_assert_eq!(judged[0].counted_at_looks(), looks.map(|look| at(look) as u64));
    }

    /// A requirement that is printed is read as the same; so is one in JSON. Shares of at most 1 % are refused in percent.
    #[test]
    fn requirements_read_back(
        (name, _) in quantity(),
        bound in bound(),
        probability in 1e-6..0.999_999_f64,
        confidence in 0.5..0.999_999_f64,
        percent in any::<bool>(),
    ) {
        let said = match bound {
            Bound::AtMost(limit) => format!("{name} <= {limit:?}"),
            Bound::AtLeast(limit) => format!("{name}≥{limit:?}"),
            Bound::Between(lower, upper) => format!("{lower:?}<= {name} <={upper:?}"),
        };
        let text = if percent && probability > 0.010_000_1 {
            format!("{said} in {} % at {}%", 100.0 * probability, 100.0 * confidence)
        } else {
            format!("  {said} in {probability} at {confidence} ")
        };
        let read: Requirement = text.parse().unwrap();
        prop_assert_eq!(read.bound(), bound);
        prop_assert_eq!(read.quantity().to_string(), name);
        prop_assert!((read.probability() - probability).abs() < 1e-15);
        prop_assert!((read.confidence().level() - confidence).abs() < 1e-15);
        let json = serde_json::to_string(&read).unwrap();
        prop_assert_eq!(serde_json::from_str::<Requirement>(&json).unwrap(), read);
    }

    /// No text makes the reader panic.
    #[test]
    fn any_text_is_read_or_refused(text in "[a-z0-9 <>=≤≥%().,\"\\\\_-]{0,40}|\\PC{0,30}") {
        if let Ok(requirement) = text.parse::<Requirement>() {
            prop_assert!(requirement.probability() > 0.0);
        }
        let _ = text.parse::<Measured>();
    }
}

#[test]
fn what_is_wrong_with_a_requirement_is_said() {
    for (text, expected) in [
        ("", "name of a column"),
        ("x < 1 in 99 % at 90 %", "“<=” or “>=”"),
        ("x <= one in 99 % at 90 %", "must be a number"),
        ("x <= 1", "“in”"),
        ("x <= 1 in 99 %", "“at”"),
        ("x <= 1 in 99.73 at 90 %", "probability = 99.73"),
        ("x <= 1 in 99 % at 100 %", "confidence = 1"),
        ("x <= inf in 99 % at 90 %", "must be a number"),
        ("2 <= x <= 1 in 99 % at 90 %", "the limits are 2 and 1"),
        ("1 <= x >= 0 in 99 % at 90 %", "same way"),
        ("abs(x, y) <= 1 in 99 % at 90 %", "abs is of one column"),
        ("norm(x <= 1 in 99 % at 90 %", "“)”"),
        ("\"x <= 1 in 99 % at 90 %", "quotation mark"),
        ("x <= 1 in 99 % at 90 % or so", "nothing may follow"),
    ] {
        let error = text.parse::<Requirement>().unwrap_err().to_string();
        assert!(error.contains(expected), "{text}: {error}");
    }
    for (json, expected) in [
        (r#"{"quantity":"x","probability":0.9,"confidence":0.9}"#, "one of at_most"),
        (
            r#"{"quantity":"x","at_most":1,"at_least":0,"probability":0.9,"confidence":0.9}"#,
            "one of",
        ),
        (r#"{"quantity":"x","at_most":1,"confidence":0.9}"#, "missing field `probability`"),
        (
            r#"{"quantity":"x","at_most":1,"probability":99.73,"confidence":0.9}"#,
            "probability = 99.73",
        ),
    ] {
        let error = serde_json::from_str::<Requirement>(json).unwrap_err().to_string();
        assert!(error.contains(expected), "{json}: {error}");
    }
}

/// Every kind of number that Parquet has, in several groups and files; texts, dates and lists are refused.
#[test]
fn parquet_of_any_writer_is_read() {
    let scratch = scratch();
    let schema = "message any {
        required boolean flag; optional int32 short; required int64 long (INTEGER(64, true)); optional float single;
        optional double number; required int32 day (DATE); required binary text (UTF8);
        optional group list { repeated double item; }
        required int32 byte (INTEGER(8, false)); required int64 most (INTEGER(64, false));
    }";
    let write = |name: &str, first: i64| {
        let file = fs::File::create(scratch.path().join(name)).unwrap();
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let properties = Arc::new(WriterProperties::builder().build());
        let mut writer = SerializedFileWriter::new(file, schema, properties).unwrap();
        for group in 0..2 {
            let mut rows = writer.next_row_group().unwrap();
            let long: Vec<i64> = (0..3).map(|i| first + 3 * group + i).collect();
            macro_rules! column {
                ($type:ty, $values:expr, $definitions:expr, $repetitions:expr) => {{
                    let mut column = rows.next_column().unwrap().unwrap();
                    column
                        .typed::<$type>()
                        .write_batch($values, $definitions, $repetitions)
                        .unwrap();
                    column.close().unwrap();
                }};
            }
            column!(BoolType, &[true, false, true], None, None);
            column!(Int32Type, &[7], Some(&[0, 1, 0]), None);
            column!(Int64Type, &long, None, None);
            column!(FloatType, &[0.5, -0.25], Some(&[1, 0, 1]), None);
            column!(DoubleType, &[1e300, f64::NAN], Some(&[1, 0, 1]), None);
            column!(Int32Type, &[1, 2, 3], None, None);
            let texts: Vec<parquet::data_type::ByteArray> =
                ["a", "b", "c"].map(Into::into).to_vec();
            column!(parquet::data_type::ByteArrayType, &texts, None, None);
            column!(DoubleType, &[1.0, 2.0], Some(&[2, 2, 0, 1]), Some(&[0, 1, 0, 0]));
            column!(Int32Type, &[0, 255, 1], None, None);
            column!(Int64Type, &[0, -1, 1], None, None);
            rows.close().unwrap();
        }
        writer.close().unwrap();
    };
    write("b.parquet", 6);
    write("a.parquet", 0);
    fs::write(scratch.path().join("notes.txt"), "mine").unwrap();
    let table = ForeignTable::open(scratch.path()).unwrap();
    let columns = ["flag", "short", "long", "single", "number", "byte", "most"].map(str::to_owned);
    let mut found = vec![Vec::new(); 7];
    table
        .scan(&columns, |some| {
            found.iter_mut().zip(some).for_each(|(all, some)| all.extend(some.clone()));
        })
        .unwrap();
    let four = |row: [Option<f64>; 3]| row.repeat(4);
    assert_eq!(found[0], four([Some(1.0), Some(0.0), Some(1.0)]));
    assert_eq!(found[1], four([None, Some(7.0), None]));
    assert_eq!(found[2], (0..12).map(|i| Some(f64::from(i))).collect::<Vec<_>>());
    assert_eq!(found[3], four([Some(0.5), None, Some(-0.25)]));
    assert_eq!(found[4].iter().map(|x| x.map(f64::to_bits)).collect::<Vec<_>>().len(), 12);
    assert_eq!(found[5], four([Some(0.0), Some(255.0), Some(1.0)]));
    assert_eq!(found[6], four([Some(0.0), Some(u64::MAX as f64), Some(1.0)]));
    for (column, expected) in [
        ("day", "texts, dates or decimals"),
        ("text", "texts, dates or decimals"),
        ("list.item", "lists"),
        ("other", "no column \"other\"; its columns are flag, short"),
    ] {
        let error = table.scan(&[column.to_owned()], |_| {}).unwrap_err().to_string();
        assert!(error.contains(expected), "{column}: {error}");
    }
}

#[test]
fn tables_that_other_programs_compressed_are_read_or_the_codec_is_named() {
    // Written by polars 2.1: 200 rows of (i mod 7) / 2, every fifth empty.
    let tables = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables");
    let expected: Vec<_> =
        (0..200_u8).map(|i| (i % 5 != 0).then(|| f64::from(i % 7) / 2.0)).collect();
    for codec in ["snappy", "gzip"] {
        let mut found = Vec::new();
        let table = ForeignTable::open(&tables.join(format!("polars-{codec}.parquet"))).unwrap();
        table.scan(&["x".to_owned()], |some| found.extend(some[0].clone())).unwrap();
        assert_eq!(found, expected, "{codec}");
    }
    let table = ForeignTable::open(&tables.join("polars-zstd.parquet")).unwrap();
    let error = table.scan(&["x".to_owned()], |_| {}).unwrap_err().to_string();
    assert!(error.contains("column \"x\" is compressed with zstd"), "{error}");
    assert!(error.contains("write the table with snappy"), "{error}");
    assert!(error.contains("df.write_parquet(path, compression=\"snappy\")"), "{error}");
}

#[test]
fn of_one_run_everything_is_said_that_is_known() {
    let requirement = ["x <= 2 in 90 % at 90 %".parse::<Requirement>().unwrap()];
    let told = |text: &str| {
        let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
        let judged = Judgement::of_table(&requirement, &table).unwrap();
        serde_json::to_value(&judged[0]).unwrap()
    };
    let one = told("x\n1.25\n");
    assert_eq!(one["mean"].as_f64(), Some(1.25));
    assert_eq!(one["share"].as_f64(), Some(1.0));
    // Clopper and Pearson's interval of one success in one, at 90 %.
    let lower = one["share_interval"]["lower"].as_f64().unwrap();
    assert!((lower - 0.05).abs() < 1e-12, "{lower}");
    assert_eq!(one["share_interval"]["upper"].as_f64(), Some(1.0));
    // One run has no standard deviation, and shows no bound.
    for unknown in ["standard_deviation", "margin", "margin_deviations", "tolerance"] {
        assert!(one[unknown].is_null(), "{unknown}");
    }
    // Beside a run without a number it is one number still.
    assert_eq!(told("x,y\n1.25,1\n,1\n")["mean"].as_f64(), Some(1.25));
    // The deviation of these is beyond all numbers, and their mean is not.
    assert_eq!(told("x\n1.7e308\n-1.7e308\n")["mean"].as_f64(), Some(0.0));
    assert!(told("x,y\n,1\n")["mean"].is_null());
}

#[test]
fn what_is_wrong_with_a_table_is_said() {
    let scratch = scratch();
    let path = scratch.path().join("it.csv");
    let requirement = ["x <= 1 in 90 % at 90 %".parse::<Requirement>().unwrap()];
    for (text, expected) in [
        ("", "empty"),
        ("\n\n", "empty"),
        ("y\n1\n", "no column \"x\"; its columns are y"),
        ("x,x\n1,2\n", "two columns are called \"x\""),
        ("x\n1\nabout 2\n", "line 3, column \"x\": \"about 2\" is not a number"),
        ("x,y\n1,2\n3\n", "line 3: the row has 1 values: there must be 2"),
        ("PAR1", "Parquet"),
        ("PAR1 and so on, which is no Parquet", "Parquet"),
        ("x\n", "no rows"),
    ] {
        fs::write(&path, text).unwrap();
        let judged = ForeignTable::open(&path)
            .map_err(|e| e.to_string())
            .and_then(|table| Judgement::of_table(&requirement, &table).map_err(|e| e.to_string()));
        let error = judged.unwrap_err();
        assert!(error.contains(expected) && error.contains("it.csv"), "{text:?}: {error}");
        let handed = ForeignTable::read_csv("handed".as_ref(), text.as_bytes())
            .map_err(|e| e.to_string())
            .and_then(|table| Judgement::of_table(&requirement, &table).map_err(|e| e.to_string()));
        let error = handed.unwrap_err();
        assert!(error.contains(expected) && error.starts_with("handed: "), "{text:?}: {error}");
    }
    for path in [scratch.path(), &scratch.path().join("none.csv")] {
        assert!(ForeignTable::open(path).is_err());
    }
    let other = scratch.path().join("cut.parquet");
    fs::write(&other, "x\n1\n").unwrap();
    assert!(ForeignTable::open(&other).unwrap_err().to_string().contains("as a Parquet file does"));
    #[cfg(unix)]
    assert!(ForeignTable::open("/dev/zero".as_ref()).unwrap_err().to_string().contains("regular"));
}

#[test]
fn one_run_is_told_as_one() {
    let scratch = scratch();
    let path = scratch.path().join("it.csv");
    fs::write(&path, "x\nnan\n").unwrap();
    let table = ForeignTable::open(&path).unwrap();
    for (left_out, expected) in [
        (
            FailedRuns::Against,
            ["1 of 1 run does not keep it", "1 run without a number counts against it"],
        ),
        (FailedRuns::LeftOut, ["0 of 0 runs do not keep it", "1 run without a number is left out"]),
    ] {
        let requirement: Requirement = "x <= 0 in 90 % at 90 %".parse().unwrap();
        let judged = Judgement::of_table(&[requirement.with_failed_runs(left_out)], &table);
        let text = judged.unwrap()[0].to_string();
        assert!(expected.iter().all(|words| text.contains(words)), "{text}");
    }
}

/// A judgement of numbers whose distances from the limit are beyond the largest float is told with numbers, and reads back.
#[test]
fn the_largest_numbers_are_judged() {
    let text = b"x\n1.7e308\n-1.7e308\n1.7e308\n1\n";
    let table = ForeignTable::read_csv("it.csv".as_ref(), &text[..]).unwrap();
    for (bound, failures) in [
        (Bound::AtMost(-1.7e308), 3),
        (Bound::AtMost(1.7e308), 0),
        (Bound::AtLeast(1.7e308), 2),
        (Bound::Between(-1.7e308, -1e307), 3),
        (Bound::Between(-1.0, 1.0), 3),
    ] {
        let requirement = Requirement::new("it", "x".parse().unwrap(), bound, 0.5, 0.5).unwrap();
        let judged = Judgement::of_table(&[requirement], &table).unwrap().remove(0);
        assert_eq!(judged.failures(), failures, "{bound:?}");
        let told = serde_json::to_string(&judged).unwrap();
        let worst = serde_json::to_value(&judged).unwrap()["worst"].clone();
        assert!(worst.as_array().unwrap().iter().all(|run| run["excess"].is_f64()), "{worst}");
        let read: Judgement = serde_json::from_str(&told).unwrap();
        assert_eq!(serde_json::to_string(&read).unwrap(), told);
    }
}
