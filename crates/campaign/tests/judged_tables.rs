//! Tables that say which run a row is, whether it has a number, and how the runs are to be counted.

use gyradius_campaign::{
    Bound, Cell, Column, Counting, FailedRuns, Failure, ForeignTable, Judgement, Judging, Looks,
    Measured, Requirement, Runs, Table, Verdict,
};
use gyradius_statistics::{Acceptance, Confidence};
use proptest::prelude::*;
use std::{fs, sync::Arc};

use crate::scratch::{scratch, written};

fn bound() -> impl Strategy<Value = Bound> {
    prop_oneof![
        (-3.0..3.0).prop_map(Bound::AtMost),
        (-3.0..3.0).prop_map(Bound::AtLeast),
        (-3.0..3.0, 0.0..4.0).prop_map(|(lower, width)| Bound::Between(lower, lower + width)),
    ]
}

proptest! {
    /// Names that hold marks which part columns elsewhere, quoted or not, are names, as the rows tell.
    #[test]
    fn marks_in_names_part_nothing(
        separator in prop::sample::select(vec![',', ';', '\t']),
        names in prop::collection::vec("[a-z]{1,3}([,;] [a-z]{1,3}){0,4}", 2..6),
        quoted: bool,
        rows in 1..5_usize,
    ) {
        let names: Vec<String> = names.iter().enumerate().map(|(i, name)| format!("{name} {i}")).collect();
        // A separator in a name must be in quotes, and a name of another table's may be.
        let quote = |name: &String| if quoted || name.contains(separator) { format!("\"{name}\"") } else { name.clone() };
        let header: Vec<String> = names.iter().map(quote).collect();
        let numbers: Vec<String> = (0..names.len()).map(|i| i.to_string()).collect();
        let [header, numbers] = [header, numbers].map(|cells| cells.join(&separator.to_string()));
        let text = format!("{header}\n{}", format!("{numbers}\n").repeat(rows));
        let table = ForeignTable::read_csv("it.csv".as_ref(), text.as_bytes()).unwrap();
        prop_assert_eq!(table.columns(), &names[..], "{}", text);
    }

    /// A column alone is judged as it is beside a second column, whatever an empty cell is written as, in a file and handed out.
    #[test]
    fn one_column_is_judged_as_beside_another(
        rows in prop::collection::vec(prop::option::weighted(0.7, -3..3_i32), 1..60),
        missing in prop::sample::select(vec!["", "\"\"", "  ", "NA"]),
        end in prop::sample::select(vec!["\n", "\r\n"]),
        left_out: bool,
    ) {
        let failed = if left_out { FailedRuns::LeftOut } else { FailedRuns::Against };
        let requirement = "x <= 1 in 60 % at 80 %".parse::<Requirement>().unwrap().with_failed_runs(failed);
        let table = |name: &str, more: &str| {
            let row = |x: &Option<i32>| x.map_or(missing.to_owned(), |x| x.to_string()) + more + end;
            format!("{name}{end}{}", rows.iter().map(row).collect::<String>())
        };
        let scratch = scratch();
        let path = scratch.path().join("it.csv");
        let judged = |text: &str| {
            fs::write(&path, text).unwrap();
            let handed = ForeignTable::read_csv(&path, text.as_bytes()).unwrap();
            let [of_file, of_handed] = [ForeignTable::open(&path).unwrap(), handed]
                .map(|table| Judgement::of_table(std::slice::from_ref(&requirement), &table).unwrap());
            assert_eq!(of_file, of_handed);
            of_file
        };
        let alone = judged(&table("x", ""));
        prop_assert_eq!(&alone, &judged(&table("x,y", ",1")));
        prop_assert_eq!(alone[0].runs(), rows.len() as u64);
        // Comments are no rows, and blank lines none of a table of several columns.
        prop_assert_eq!(&alone, &judged(&format!("{}# end", table("x", ""))));
        prop_assert_eq!(&alone, &judged(&format!("{}{end}{end}# end", table("x,y", ",1"))));
    }
}

/// A run that failed is one in every file of its table, whatever its failure says of itself.
#[test]
fn failures_are_none_of_success_in_any_file() {
    let requirement: Requirement = "x >= 0 in 90 % at 90 %".parse().unwrap();
    for (kind, message) in
        [("low", "ok"), ("ok", "ok"), ("", ""), (" ok", "ok "), ("low", " "), ("low", "x < 0")]
    {
        let mut table = Table::new("m", 0, vec![Column::number("x", "1", "a number")]).unwrap();
        for run in 0..200 {
            let failure = (run % 10 == 3).then(|| Failure::new(kind, message));
            table.push(failure, [Cell::Number(1.0)]).unwrap();
        }
        let scratch = tempfile::tempdir().unwrap();
        let judging = Judging::new([requirement.clone()], 200, 1);
        judging.look(&table);
        let judged = judging.finish(&Runs::from(table.clone())).unwrap();
        assert_eq!(judged[0].failures(), 20, "{kind:?} {message:?}");
        for name in ["it.csv", "it.parquet"] {
            let table = ForeignTable::open(&written(&table, scratch.path(), name)).unwrap();
            let of_file = Judgement::of_table(std::slice::from_ref(&requirement), &table).unwrap();
            assert_eq!(of_file[0].failures(), 20, "{kind:?} {message:?} {name}");
        }
    }
}

proptest! {
    /// A copy of a run table says the same, whatever order its columns have and whatever else stands among them: runs that failed count
    /// as those.
    #[test]
    fn a_copy_of_a_run_table_is_one(
        rows in prop::collection::vec((0..3_i32, prop::bool::weighted(0.2)), 1..50),
        order in Just(["model", "run", "status", "x", "", "other"]).prop_shuffle(),
    ) {
        let cell = |run: usize, column: &str| {
            let (x, failed) = rows[run];
            match column {
                "model" => "m".to_owned(),
                "status" => if failed { "diverged".to_owned() } else { "ok".to_owned() },
                "x" => x.to_string(),
                _ => run.to_string(),
            }
        };
        let row = |run| order.map(|column| cell(run, column)).join(",") + "\n";
        let text = order.join(",") + "\n" + &(0..rows.len()).map(row).collect::<String>();
        let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
        let requirement: Requirement = "x <= 1 in 60 % at 80 %".parse().unwrap();
        let judged = Judgement::of_table(&[requirement], &table).unwrap();
        let failing = rows.iter().filter(|(x, failed)| *failed || *x > 1).count() as u64;
        prop_assert_eq!((judged[0].failures(), judged[0].counted()), (failing, rows.len() as u64), "{}", text);
    }

    /// Numbers of a column in groups that may be missing themselves, at any depth, stand in their rows.
    #[test]
    fn nested_columns_are_in_their_rows(
        required in prop::collection::vec(any::<bool>(), 1..4),
        rows in prop::collection::vec((0..9_i16, -3..4_i32), 1..80),
        left_out: bool,
    ) {
        use parquet::{
            basic::{Repetition, Type as Physical},
            data_type::DoubleType,
            file::writer::SerializedFileWriter,
            schema::types::Type,
        };
        let of = |required: bool| if required { Repetition::REQUIRED } else { Repetition::OPTIONAL };
        let names = ["x", "a", "b", "c"];
        let deepest = required.iter().filter(|required| !**required).count() as i16;
        let mut field = Type::primitive_type_builder(names[required.len() - 1], Physical::DOUBLE)
            .with_repetition(of(required[required.len() - 1]))
            .build()
            .unwrap();
        for depth in (0..required.len() - 1).rev() {
            field = Type::group_type_builder(names[depth])
                .with_repetition(of(required[depth]))
                .with_fields(vec![field.into()])
                .build()
                .unwrap();
        }
        let schema = Type::group_type_builder("it").with_fields(vec![field.into()]).build().unwrap();
        let scratch = scratch();
        let path = scratch.path().join("it.parquet");
        let file = fs::File::create(&path).unwrap();
        let mut writer = SerializedFileWriter::new(file, schema.into(), Arc::default()).unwrap();
        let mut group = writer.next_row_group().unwrap();
        let levels: Vec<i16> = rows.iter().map(|(level, _)| (*level).min(deepest)).collect();
        let numbers: Vec<Option<f64>> =
            levels.iter().zip(&rows).map(|(level, (_, x))| (*level == deepest).then_some(f64::from(*x))).collect();
        let values: Vec<f64> = numbers.iter().flatten().copied().collect();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&values, Some(&levels), None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
        writer.close().unwrap();

        let table = ForeignTable::open(&path).unwrap();
        let name = names[..required.len()].join(".");
        let mut read = Vec::new();
        table.scan(std::slice::from_ref(&name), |columns| read.extend_from_slice(&columns[0])).unwrap();
        prop_assert_eq!(&read, &numbers);
        let requirement: Requirement = format!("{name} <= 1 in 60 % at 80 %").parse().unwrap();
        let requirement =
            requirement.with_failed_runs(if left_out { FailedRuns::LeftOut } else { FailedRuns::Against });
        let judged = Judgement::of_table(&[requirement], &table).unwrap();
        let failing = numbers.iter().filter(|x| x.map_or(!left_out, |x| x > 1.0)).count() as u64;
        prop_assert_eq!(judged[0].failures(), failing);
    }
}

/// Parquet has no durations: pandas writes them as whole numbers, and says so beside the table.
#[test]
fn durations_are_no_numbers() {
    use parquet::{
        basic::Type as Physical,
        data_type::Int64Type,
        file::{metadata::KeyValue, properties::WriterProperties, writer::SerializedFileWriter},
        schema::types::Type,
    };
    let column = |name: &str| Type::primitive_type_builder(name, Physical::INT64).build().unwrap();
    let fields = ["late", "n"].map(|name| column(name).into()).to_vec();
    let schema = Type::group_type_builder("it").with_fields(fields).build().unwrap();
    let told = r#"{"columns": [{"name": "late", "numpy_type": "timedelta64[ns]"}, {"name": "n", "numpy_type": "int64"}]}"#;
    let note = KeyValue::new("pandas".to_owned(), told.to_owned());
    let properties = WriterProperties::builder().set_key_value_metadata(Some(vec![note])).build();
    let scratch = scratch();
    let path = scratch.path().join("it.parquet");
    let file = fs::File::create(&path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema.into(), properties.into()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    while let Some(mut column) = group.next_column().unwrap() {
        column.typed::<Int64Type>().write_batch(&[1; 40], Some(&[1; 40]), None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
    let table = ForeignTable::open(&path).unwrap();
    let judged = |name: &str| {
        let requirement: Requirement = format!("{name} <= 1 in 60 % at 80 %").parse().unwrap();
        Judgement::of_table(&[requirement], &table)
    };
    assert_eq!(judged("n").unwrap()[0].failures(), 0);
    let refused = judged("late").unwrap_err().to_string();
    assert!(refused.contains("\"late\" is of durations (timedelta64[ns])"), "{refused}");
}

proptest! {
    /// Of runs in groups a table is judged as the campaign is, however often it is looked at and whatever the order of the rows.
    #[test]
    fn tables_of_groups_are_judged_as_campaigns(
        numbers in prop::collection::vec(prop::option::weighted(0.9, -4..4_i32), 1..200),
        group in 1..7_u64,
        bound in bound(),
        (left_out, often, reversed) in any::<(bool, bool, bool)>(),
    ) {
        let failed = if left_out { FailedRuns::LeftOut } else { FailedRuns::Against };
        let looks = if often { Looks::Often } else { Looks::Once };
        let requirement = Requirement::new("it", Measured::column("x"), bound, 0.6, 0.8).unwrap();
        let requirement = requirement.with_failed_runs(failed);
        let mut block = Table::new("model", 0, vec![Column::number("x", "1", "A number.")]).unwrap();
        let mut rows = Vec::new();
        for (run, x) in numbers.iter().enumerate() {
            block.push(None, [Cell::from(x.map(f64::from))]).unwrap();
            rows.push(format!("{run},{}\n", x.map_or_else(String::new, |x| x.to_string())));
        }
        let judging = Judging::new([requirement.clone()], numbers.len() as u64, group).looked_at(looks);
        judging.look(&block);
        let expected = judging.finish(&Runs::from(block)).unwrap();
        if reversed && group > 1 {
            rows.reverse();
        }
        let text = format!("run,x\n{}", rows.concat());
        let table = |text: &str| {
            let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
            table.counted(Counting::new(looks, group))
        };
        prop_assert_eq!(Judgement::of_table(std::slice::from_ref(&requirement), &table(&text)).unwrap(), expected);
        if group > 1 {
            let error = Judgement::of_table(&[requirement], &table(&text.replacen("run", "other", 1)));
            let error = error.unwrap_err().to_string();
            prop_assert!(error.contains("no column \"run\""), "{}", error);
        }
    }
}

/// Where runs have something in common, a row of which nobody knows which run it is cannot be counted.
#[test]
fn rows_of_groups_need_numbers() {
    for number in ["", "1.5", "-1", "1e300"] {
        let text = format!("run,x\n0,1\n{number},1\n");
        let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
        let table = table.counted(Counting::new(Looks::Once, 2));
        let requirement: Requirement = "x <= 1 in 90 % at 90 %".parse().unwrap();
        let error = Judgement::of_table(&[requirement], &table).unwrap_err().to_string();
        let said = if ["", "1.5"].contains(&number) {
            format!("{number:?} is not the number of a run")
        } else {
            "\"run\" must say which run each row is".to_owned()
        };
        assert!(error.contains(&said), "{error}");
    }
}

/// Rows of the same run are refused where the columns `model` and `run` say so, in any order; other rows are not.
#[test]
fn a_run_counts_once() {
    let requirement = ["x <= 1 in 90 % at 90 %".parse::<Requirement>().unwrap()];
    let twice = |text: &str| {
        let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
        Judgement::of_table(&requirement, &table).err().map(|error| error.to_string())
    };
    for text in [
        "model,run,x\na,0,1\na,1,1\na,0,1\n",
        "x,run,model\n1,0,a\n1,2,a\n1,1,a\n1,0,b\n1,1,b\n1,0,a\n",
        "model,run,status,x\na,0,broken,\na,0,ok,1\n",
    ] {
        let error = twice(text).unwrap();
        assert!(error.starts_with("it: two rows are of the run 0 of the model \"a\""), "{error}");
        for name in ["-7", "case0", "1152921504606846977", "a b"] {
            let error = twice(&text.replace(",0,", &format!(",{name},"))).unwrap();
            let said = format!("it: two rows are of the run {name} of the model \"a\"");
            assert!(error.starts_with(&said), "{error}");
        }
    }
    for text in [
        "run,x\n0,1\n0,1\n",
        "model,x\na,1\na,1\n",
        "model,run,x\na,0,1\nb,0,1\na,1,1\nb,1,1\n",
        "model,run,x\na,,1\na,,1\n",
        "model,run,x\na,first,1\na,second,1\n",
        "model,run,x\na,0.5,1\na,0.5,1\n",
        "model,model,run,x\na,a,0,1\na,a,0,1\n",
    ] {
        assert_eq!(twice(text), None, "{text}");
    }
}

/// The worst runs bear the numbers of a column `run`, in any letters and any order, if all of them are numbers of runs; the numbers of their rows if some
/// are other whole numbers; and words and fractions among them are refused.
#[test]
fn the_worst_runs_have_the_numbers_of_the_table() {
    let scratch = scratch();
    let path = scratch.path().join("it.csv");
    let requirement: Requirement = "x <= 0 in 90 % at 90 %".parse().unwrap();
    // Some more than are looked at together.
    let rows = 20_000_u64;
    let number = |row: u64| 1_000_000 - 7 * row;
    for (column, is_number) in [("run", true), ("other", false), ("run ", true), ("Run", true)] {
        for broken in ["", "1.5", "-1", "no number", "1e300"] {
            // Row 3 is the worst, and the last one the second.
            let text: String = (0..rows)
                .map(|row| {
                    let x = if row == 3 { rows } else { row };
                    let run = match row {
                        3 if !broken.is_empty() => broken.to_owned(),
                        _ => number(row).to_string(),
                    };
                    format!("{x},{run}\n")
                })
                .collect();
            fs::write(&path, format!("x,{column}\n{text}")).unwrap();
            let table = ForeignTable::open(&path).unwrap();
            let judged = Judgement::of_table(std::slice::from_ref(&requirement), &table);
            if is_number && ["no number", "1.5"].contains(&broken) {
                let refused = judged.unwrap_err().to_string();
                assert!(refused.contains("line 5, column"), "{refused}");
                continue;
            }
            let judged = judged.unwrap();
            let worst: Vec<u64> = judged[0].worst().iter().take(3).map(|run| run.run).collect();
            let of_rows = [3, rows - 1, rows - 2];
            let expected =
                if is_number && broken.is_empty() { of_rows.map(number) } else { of_rows };
            assert_eq!(worst, expected, "{column} {broken}");
        }
    }
}

/// Beside a limit so large that the excess is the same in all runs, the worst are still those of the largest or smallest numbers.
#[test]
fn the_worst_runs_are_those_beside_any_limit() {
    let rows = 20_000_u64;
    let x = |row: u64| row * 7919 % rows;
    let text: String = (0..rows).map(|row| format!("{}\n", x(row))).collect();
    let table = ForeignTable::read_csv("it".as_ref(), format!("x\n{text}").as_bytes()).unwrap();
    for limit in ["0", "1e4", "1e17", "1e300", "-1e20", "-1e300"] {
        for (bound, is_largest) in [("<=", true), (">=", false)] {
            let requirement: Requirement =
                format!("x {bound} {limit} in 90 % at 90 %").parse().unwrap();
            let judged = Judgement::of_table(&[requirement], &table).unwrap();
            let worst: Vec<u64> = judged[0].worst().iter().map(|run| x(run.run)).collect();
            let expected: Vec<u64> =
                (0..10).map(|i| if is_largest { rows - 1 - i } else { i }).collect();
            assert_eq!(worst, expected, "{bound} {limit}");
        }
    }
}

/// What stands beside a limit does not look like it, and a share that passes does.
#[test]
fn what_is_said_of_a_judgement_is_true() {
    let told = |line: &str, numbers: &str, n: usize| {
        let table = ForeignTable::read_csv(
            "it".as_ref(),
            format!("x\n{}{numbers}", "1\n".repeat(n)).as_bytes(),
        );
        let judged = Judgement::of_table(&[line.parse().unwrap()], &table.unwrap()).unwrap();
        judged[0].to_string()
    };
    let text = told("x <= 10 in 80 % at 90 %", "10.0000001\n", 0);
    assert!(text.contains("worst runs   0 (10.0000001)"), "{text}");
    let text = told("x <= 10 in 50 % at 50 %", "10.0000001\n", 0);
    assert!(text.contains("50 % of all runs are at most 10.0000001"), "{text}");
    let text = told("x <= 10 in 85.55 % at 92.5 %", "", 500);
    assert!(text.contains("85.55 % of all runs are at most 1, with 92.5 % confidence"), "{text}");
    // Rounded to 72.6 %, the share would be what is required.
    let text = told("x <= 10 in 72.61 % at 90 %", &"11\n".repeat(2738), 7262);
    assert!(text.contains("share        72.62 % of the runs keep it"), "{text}");
}

proptest! {
    /// So many further runs as are told suffice if the shares of all runs that fail and that are left out stay as they are, and no
    /// fewer do: by trying one after the other, of runs and of vehicles.
    #[test]
    fn further_runs_are_of_all_runs(
        (n, left_out) in (1..150_u64, 0.0..1.0_f64),
        (probability, confidence, failing) in (0.3..0.99_f64, 0.5..0.99_f64, 0.0..0.98_f64),
        (against, group) in (any::<bool>(), 1..4_u64),
    ) {
        let left_out = (left_out * n as f64) as u64;
        let counted = if against { n } else { n - left_out };
        let failures = (failing * (1.0 - probability) * counted as f64) as u64;
        let failed = if against { FailedRuns::Against } else { FailedRuns::LeftOut };
        let requirement = Requirement::new("it", Measured::column("x"), Bound::AtMost(1.0), probability, confidence);
        let requirement = [requirement.unwrap().with_failed_runs(failed)];
        let without = if against { failures.min(left_out) } else { left_out };
        let beyond = without + failures - if against { without } else { 0 };
        let row = |run: u64| match run / group {
            it if it < without => format!("{run},\n"),
            it if it < beyond => format!("{run},2\n"),
            _ => format!("{run},0\n"),
        };
        let text = format!("run,x\n{}", (0..n * group).map(row).collect::<String>());
        let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
        let judged = Judgement::of_table(&requirement, &table.counted(Counting::new(Looks::Once, group))).unwrap();
        prop_assert_eq!([judged[0].counted(), judged[0].failures()], [counted, failures]);
        let rule = Acceptance::new(probability, Confidence::new(confidence).unwrap()).unwrap();
        let met = |runs: u64| {
            let counting = runs * counted / n;
            rule.allowed_failures(counting).is_some_and(|may| (counting * failures).div_ceil(counted) <= may)
        };
        if let Verdict::Undecided { if_no_more_fail, at_this_rate } = judged[0].verdict() {
            prop_assert!(at_this_rate.is_none_or(|more| met(n + more)));
            let few = at_this_rate.filter(|more| *more < 2000);
            prop_assert_eq!(few.and_then(|more| (n..=n + more).find(|runs| met(*runs))), few.map(|more| n + more));
            let allow = |more: &u64| rule.allowed_failures(counted + more).is_some_and(|may| failures <= may);
            prop_assert_eq!((0..).find(allow), if_no_more_fail);
            let told = judged[0].to_string();
            let is_told = at_this_rate.is_some_and(|_| counted < n && at_this_rate != if_no_more_fail);
            prop_assert_eq!(told.contains("are left out stay as they are"), is_told, "{}", told);
        }
    }

    /// A vehicle that keeps it in the share that is said passes nine times in ten, and one that keeps it a little less often does not.
    #[test]
    fn the_share_to_pass_passes(n in 60..3000_usize, probability in 0.5..0.95_f64) {
        let text = format!("x <= 10 in {probability} at 90 %");
        let requirement: Requirement = text.parse().unwrap();
        let table = format!("x\n{}", "1\n".repeat(n));
        let table = ForeignTable::read_csv("it".as_ref(), table.as_bytes()).unwrap();
        let judged = Judgement::of_table(&[requirement], &table).unwrap();
        let said = judged[0].to_string();
        let line = said.lines().find(|line| line.contains("to pass"));
        prop_assume!(line.is_some());
        let percent: f64 = line.unwrap().split("keeps it in ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        let rule = Acceptance::new(probability, Confidence::new(0.9).unwrap()).unwrap();
        let passes = |share: f64| 1.0 - rule.producers_risk(n as u64, share.min(1.0)).unwrap();
        prop_assert!(passes(percent / 100.0) >= 0.9 - 1e-9, "{}", line.unwrap());
        prop_assert!(passes(percent / 100.0 - 0.001_01) <= 0.9, "{}", line.unwrap());
    }
}

/// Runs that failed with an infinite number are called by their numbers, as all others are, in any order of rows.
#[test]
fn infinite_runs_that_failed_have_their_numbers() {
    let scratch = scratch();
    let path = scratch.path().join("it.csv");
    let requirement: Requirement = "x <= 5 in 50 % at 50 %".parse().unwrap();
    let text = "model,run,status,x\na,10,ok,1\na,13,bad,inf\na,12,ok,7\na,11,bad,9\na,2,ok,6\n";
    fs::write(&path, text).unwrap();
    let table = ForeignTable::open(&path).unwrap();
    let judged = &Judgement::of_table(&[requirement], &table).unwrap()[0];
    let worst: Vec<u64> = judged.worst().iter().map(|run| run.run).collect();
    assert_eq!((judged.first_infinite(), &worst[..2]), (&[13][..], &[12, 2][..]));
}

proptest! {
    /// A quotation mark that nothing closes is refused with its line, wherever it is, and one that is closed is not.
    #[test]
    fn open_quotation_marks_are_refused(
        rows in 1..20_usize,
        at in 0..20_usize,
        is_closed: bool,
        number: bool,
        end in prop::sample::select(vec!["", "\n", "\r\n", "\n# the end", "\n\n", "\n#\n"]),
    ) {
        let at = at % rows;
        let row = |row: usize| {
            let close = if row != at { "" } else if is_closed { "\"" } else { " " };
            let open = if row == at { "\"" } else { "" };
            if number { format!("ok,{open}{row}{close}") } else { format!("{open}a word{close},{row}") }
        };
        let text = "note,x\n".to_owned() + &(0..rows).map(row).collect::<Vec<_>>().join("\n") + end;
        let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
        let judged = Judgement::of_table(&["x <= 5 in 50 % at 50 %".parse().unwrap()], &table);
        match judged {
            Ok(judged) => prop_assert_eq!((is_closed, judged[0].counted()), (true, rows as u64), "{}", text),
            Err(error) => {
                prop_assert!(!is_closed, "{text}: {error}");
                let line = format!("line {}: a quotation mark opens a cell", at + 2);
                prop_assert!(error.to_string().contains(&line), "{text}: {error}");
            }
        }
    }
}
