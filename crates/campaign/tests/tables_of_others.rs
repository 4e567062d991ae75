//! Tables of others: folders of files, what numbers mean in Parquet, and runs that stand twice.

use gyradius_campaign::{Cell, Column, ForeignTable, Judgement, Requirement, Table};
use parquet::{
    basic::{ConvertedType, Repetition, Type as Physical},
    column::writer::ColumnWriter,
    data_type::ByteArray,
    file::writer::SerializedFileWriter,
    schema::types::Type,
};
use std::{
    fs::{self, File},
    path::Path,
    sync::Arc,
};

use crate::scratch::scratch;

/// A column of a Parquet file: its name, how it is stored, what its numbers are said to mean in the older of the two ways, and its cells.
type Stored<'a> = (&'a str, Physical, ConvertedType, &'a [&'a str]);

fn write(path: &Path, columns: &[Stored<'_>]) {
    let fields = columns.iter().map(|(name, physical, meaning, _)| {
        let field = Type::primitive_type_builder(name, *physical);
        let field = field.with_repetition(Repetition::REQUIRED).with_converted_type(*meaning);
        let field = if *meaning == ConvertedType::DECIMAL {
            field.with_precision(9).with_scale(2)
        } else if *physical == Physical::FIXED_LEN_BYTE_ARRAY {
            field.with_length(4)
        } else {
            field
        };
        Arc::new(field.build().unwrap())
    });
    let schema = Type::group_type_builder("it").with_fields(fields.collect()).build().unwrap();
    let file = File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema.into(), Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for (.., cells) in columns {
        macro_rules! write {
            ($writer:expr, $of:expr) => {{
                let cells: Vec<_> = cells.iter().map($of).collect();
                $writer.write_batch(&cells, None, None).unwrap()
            }};
        }
        let mut column = group.next_column().unwrap().unwrap();
        match column.untyped() {
            ColumnWriter::Int32ColumnWriter(w) => {
                write!(w, |cell| cell.parse::<i64>().unwrap() as i32)
            }
            ColumnWriter::Int64ColumnWriter(w) => {
                write!(w, |cell| cell.parse::<i128>().unwrap() as i64)
            }
            ColumnWriter::BoolColumnWriter(w) => write!(w, |cell| *cell == "true"),
            ColumnWriter::DoubleColumnWriter(w) => write!(w, |cell| cell.parse().unwrap()),
            ColumnWriter::ByteArrayColumnWriter(w) => write!(w, |cell| ByteArray::from(*cell)),
            ColumnWriter::FixedLenByteArrayColumnWriter(w) => {
                write!(w, |cell| ByteArray::from(*cell).into())
            }
            _ => panic!("no test writes this"),
        };
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
}

fn judged(path: &Path, requirement: &str) -> Result<[u64; 2], String> {
    let requirement: Requirement = requirement.parse().unwrap();
    let table = ForeignTable::open(path).map_err(|error| error.to_string())?;
    let judged = Judgement::of_table(&[requirement], &table).map_err(|error| error.to_string())?;
    Ok([judged[0].runs(), judged[0].failures()])
}

/// Of DuckDB's columns the older of the two ways to say what a number means stands alone: decimals were read as hundreds of what they
/// are, and large unsigned numbers as negative ones.
#[test]
fn numbers_mean_what_either_way_says() {
    let scratch = scratch();
    let path = scratch.path().join("it.parquet");
    for (physical, meaning, cell, is_large) in [
        (Physical::INT32, ConvertedType::DECIMAL, "5", None),
        (Physical::INT64, ConvertedType::DECIMAL, "5", None),
        (Physical::INT32, ConvertedType::DATE, "18262", None),
        (Physical::INT32, ConvertedType::TIME_MILLIS, "5", None),
        (Physical::INT64, ConvertedType::TIME_MICROS, "5", None),
        (Physical::INT64, ConvertedType::TIMESTAMP_MILLIS, "5", None),
        (Physical::INT64, ConvertedType::TIMESTAMP_MICROS, "5", None),
        (Physical::BYTE_ARRAY, ConvertedType::UTF8, "5", None),
        (Physical::INT32, ConvertedType::UINT_32, "4000000000", Some(true)),
        (Physical::INT64, ConvertedType::UINT_64, "18000000000000000000", Some(true)),
        (Physical::INT32, ConvertedType::UINT_8, "200", Some(true)),
        (Physical::INT32, ConvertedType::UINT_16, "60000", Some(true)),
        (Physical::INT32, ConvertedType::INT_8, "-3", Some(false)),
        (Physical::INT32, ConvertedType::INT_16, "-3", Some(false)),
        (Physical::INT32, ConvertedType::INT_32, "-3", Some(false)),
        (Physical::INT64, ConvertedType::INT_64, "-3", Some(false)),
        (Physical::INT32, ConvertedType::NONE, "-3", Some(false)),
    ] {
        write(&path, &[("x", physical, meaning, &[cell; 3])]);
        let found = judged(&path, "x <= 100 in 60 % at 80 %");
        match is_large {
            Some(is_large) => {
                assert_eq!(found, Ok([3, if is_large { 3 } else { 0 }]), "{physical} {meaning}");
            }
            None => {
                let refused = found.unwrap_err();
                assert!(refused.contains("dates or decimals"), "{physical} {meaning}: {refused}");
            }
        }
    }
}

/// A run that stands twice was counted twice where the columns that name it are of other types than those of a study.
#[test]
fn runs_that_stand_twice_are_seen_however_they_are_named() {
    const MODELS: [(Physical, ConvertedType, [&str; 2]); 5] = [
        (Physical::BYTE_ARRAY, ConvertedType::UTF8, ["a", "b"]),
        (Physical::FIXED_LEN_BYTE_ARRAY, ConvertedType::NONE, ["aaaa", "bbbb"]),
        (Physical::INT32, ConvertedType::NONE, ["1", "2"]),
        (Physical::INT64, ConvertedType::UINT_64, ["1", "2"]),
        (Physical::BOOLEAN, ConvertedType::NONE, ["true", "false"]),
    ];
    const RUNS: [(Physical, ConvertedType, [&str; 2]); 10] = [
        (Physical::INT64, ConvertedType::NONE, ["-1", "-2"]),
        (Physical::INT64, ConvertedType::NONE, ["1152921504606846976", "1152921504606846977"]),
        (Physical::INT64, ConvertedType::UINT_64, ["18000000000000000000", "18000000000000000001"]),
        (Physical::DOUBLE, ConvertedType::NONE, ["-1", "-2"]),
        (Physical::BYTE_ARRAY, ConvertedType::UTF8, ["case0", "case1"]),
        (Physical::INT64, ConvertedType::NONE, ["0", "1"]),
        (Physical::INT32, ConvertedType::UINT_32, ["3000000000", "3000000001"]),
        (Physical::INT64, ConvertedType::UINT_64, ["3000000000", "3000000001"]),
        (Physical::DOUBLE, ConvertedType::NONE, ["0", "1"]),
        (Physical::BYTE_ARRAY, ConvertedType::UTF8, ["0", " 1"]),
    ];
    let scratch = scratch();
    let path = scratch.path().join("it.parquet");
    for names in [["model", "run"], ["Model", "RUN "]] {
        for (of_model, model_meaning, [a, b]) in MODELS {
            for (of_run, run_meaning, [first, second]) in RUNS {
                for (models, runs, is_twice) in [
                    ([a, b], [first; 2], false),
                    ([a; 2], [first, second], false),
                    ([b; 2], [first; 2], true),
                ] {
                    write(
                        &path,
                        &[
                            (names[0], of_model, model_meaning, &models),
                            (names[1], of_run, run_meaning, &runs),
                            ("x", Physical::DOUBLE, ConvertedType::NONE, &["1", "2"]),
                        ],
                    );
                    let found = judged(&path, "x <= 3 in 60 % at 80 %");
                    let what = format!("{of_model} {of_run} {models:?} {runs:?}: {found:?}");
                    match found {
                        Ok(counts) => assert!(!is_twice && counts == [2, 0], "{what}"),
                        Err(refused) => {
                            assert!(is_twice && refused.contains("a run counts once"), "{what}")
                        }
                    }
                }
            }
        }
    }
}

/// Rows of failed runs counted as successes where the column that says so is of another type, or in other letters, or in some files alone.
#[test]
fn runs_that_failed_are_seen_or_the_table_is_refused() {
    let scratch = scratch();
    let folder = scratch.path();
    let table = |name: &str, run: &str, status: Option<Stored<'_>>| {
        let mut columns: Vec<Stored<'_>> = vec![
            ("model", Physical::BYTE_ARRAY, ConvertedType::UTF8, &["a"]),
            ("run", Physical::INT64, ConvertedType::NONE, std::slice::from_ref(&run)),
            ("x", Physical::DOUBLE, ConvertedType::NONE, &["1"]),
        ];
        columns.extend(status);
        write(&folder.join(name), &columns);
    };
    let text = |name| (name, Physical::BYTE_ARRAY, ConvertedType::UTF8, &["no contact"][..]);
    const REQUIREMENT: &str = "x <= 3 in 60 % at 80 %";
    for name in ["status", "Status", "STATUS "] {
        table("a.parquet", "0", Some(text(name)));
        assert_eq!(judged(&folder.join("a.parquet"), REQUIREMENT), Ok([1, 1]), "{name}");
    }
    for (physical, cell) in [
        (Physical::BOOLEAN, "false"),
        (Physical::INT32, "0"),
        (Physical::FIXED_LEN_BYTE_ARRAY, "ok  "),
    ] {
        table("a.parquet", "0", Some(("status", physical, ConvertedType::NONE, &[cell])));
        let refused = judged(&folder.join("a.parquet"), REQUIREMENT).unwrap_err();
        assert!(refused.contains("\"status\" says of each run whether it ended"), "{refused}");
    }
    for (first, second) in [(Some(text("status")), None), (None, Some(text("Status")))] {
        table("a.parquet", "0", first);
        table("b.parquet", "1", second);
        let refused = judged(folder, REQUIREMENT).unwrap_err();
        assert!(
            refused.contains("no column 4") && refused.contains("must have the same columns"),
            "{refused}"
        );
    }
}

/// A folder is all its Parquet files, however these end; one with more of them below is refused, for they would not be read.
#[test]
fn a_folder_is_all_its_files() {
    let scratch = scratch();
    let table = |from: u64| {
        let mut table = Table::new("m", from, vec![Column::number("x", "1", "a number")]).unwrap();
        (0..10).for_each(|_| table.push(None, [Cell::Number(from as f64)]).unwrap());
        table
    };
    let folder = scratch.path().join("runs");
    fs::create_dir_all(folder.join("figures")).unwrap();
    fs::write(folder.join("figures/it.svg"), "").unwrap();
    for (place, name) in ["a.parquet", "b.pq", "c.PARQUET", "d.Pq"].into_iter().enumerate() {
        table(10 * place as u64).write_parquet(File::create(folder.join(name)).unwrap()).unwrap();
    }
    fs::write(folder.join(".half.parquet"), "PAR1").unwrap();
    let requirement: [Requirement; 1] = ["x <= 15 in 60 % at 80 %".parse().unwrap()];
    let judged = Judgement::of_table(&requirement, &ForeignTable::open(&folder).unwrap()).unwrap();
    assert_eq!((judged[0].runs(), judged[0].failures()), (40, 20));
    let below = folder.join("part=1/more");
    fs::create_dir_all(&below).unwrap();
    assert!(ForeignTable::open(&folder).is_ok());
    table(40).write_parquet(File::create(below.join("e.parquet")).unwrap()).unwrap();
    let refused = ForeignTable::open(&folder).unwrap_err().to_string();
    assert!(
        refused.contains("beside its files it has the folder part=1 with Parquet files"),
        "{refused}"
    );
}

/// A table that cannot be reached was passed over, and the others were judged without a word.
#[cfg(unix)]
#[test]
fn what_cannot_be_reached_is_refused_and_never_passed_over() {
    use std::os::unix::fs::symlink;
    let scratch = scratch();
    let folder = scratch.path().join("runs");
    fs::create_dir(&folder).unwrap();
    let table = |path: &Path| {
        let mut table = Table::new("m", 0, vec![Column::number("x", "1", "a number")]).unwrap();
        table.push(None, [Cell::Number(1.0)]).unwrap();
        table.write_parquet(File::create(path).unwrap()).unwrap();
    };
    table(&folder.join("a.parquet"));
    let elsewhere = scratch.path().join("elsewhere.parquet");
    table(&elsewhere);
    let link = folder.join("b.parquet");
    symlink(&elsewhere, &link).unwrap();
    let rows = || {
        let mut rows = 0;
        let table = ForeignTable::open(&folder)?;
        table.scan(&["x".to_owned()], |columns| rows += columns[0].len()).map(|()| rows)
    };
    assert_eq!(rows().unwrap(), 2);
    fs::remove_file(&link).unwrap();
    // Of a link without the name of a table nobody knows whether it leads to a folder of tables.
    for (name, target) in [
        ("b.parquet", "nowhere.parquet"),
        ("b.parquet", "b.parquet"),
        ("more", "nowhere"),
        ("b.pq", "/dev/null"),
    ] {
        symlink(target, folder.join(name)).unwrap();
        let refused = rows().unwrap_err().to_string();
        assert!(refused.starts_with(&folder.join(name).display().to_string()), "{refused}");
        assert_eq!(
            refused.ends_with("it is not a regular file"),
            target == "/dev/null",
            "{refused}"
        );
        fs::remove_file(folder.join(name)).unwrap();
    }
    // What nobody takes for a table or a folder of tables keeps nobody from the tables.
    symlink("/dev/null", folder.join("log")).unwrap();
    symlink("nowhere", folder.join(".lock")).unwrap();
    assert_eq!(rows().unwrap(), 1);
    // A file that is reached twice would count twice.
    symlink("a.parquet", folder.join("latest.parquet")).unwrap();
    assert!(rows().unwrap_err().to_string().contains("again, and rows count once"));
    fs::remove_file(folder.join("latest.parquet")).unwrap();
    // Links to folders are folders, and one that leads back is looked at once.
    fs::create_dir(folder.join("other")).unwrap();
    symlink(".", folder.join("other/back")).unwrap();
    assert_eq!(rows().unwrap(), 1);
    let far = scratch.path().join("far");
    fs::create_dir(&far).unwrap();
    table(&far.join("c.parquet"));
    symlink(&far, folder.join("other/far")).unwrap();
    assert!(rows().unwrap_err().to_string().contains("it has the folder other with Parquet files"));
    fs::remove_dir_all(folder.join("other")).unwrap();
    fs::create_dir(folder.join("_delta_log")).unwrap();
    assert!(rows().unwrap_err().to_string().contains("it is a Delta table"));
    fs::remove_dir(folder.join("_delta_log")).unwrap();
    // A table below may be one that is away.
    fs::create_dir(folder.join("more")).unwrap();
    symlink("nowhere", folder.join("more/c.parquet")).unwrap();
    let refused = rows().unwrap_err().to_string();
    assert!(refused.starts_with(&folder.join("more/c.parquet").display().to_string()), "{refused}");
}

/// Rows in files of other names were passed over, and the others judged without a word.
#[test]
fn what_stands_beside_the_files_of_a_folder_is_refused_or_named() {
    let scratch = scratch();
    let folder = scratch.path().join("runs");
    fs::create_dir(&folder).unwrap();
    let mut table = Table::new("m", 0, vec![Column::number("x", "1", "a number")]).unwrap();
    table.push(None, [Cell::Number(1.0)]).unwrap();
    let mut parquet = Vec::new();
    table.write_parquet(&mut parquet).unwrap();
    fs::write(folder.join("a.parquet"), &parquet).unwrap();
    for (name, is_parquet, refused) in [
        ("b.parq", true, "called neither .parquet nor .pq"),
        ("b.PARQ", false, "called neither .parquet nor .pq"),
        ("b", true, "called neither .parquet nor .pq"),
        ("b.parquet.bak", true, "called neither .parquet nor .pq"),
        ("b.csv", true, "called neither .parquet nor .pq"),
        ("b.parquet.gz", false, "a compressed Parquet file"),
        ("b.pq.ZST", false, "a compressed Parquet file"),
        ("b.parq.zip", false, "a compressed Parquet file"),
        ("b.csv", false, ""),
        ("b.CSV.gz", false, ""),
        ("b.tsv", false, ""),
        ("b.jsonl", false, ""),
        ("b.npy", false, ""),
        ("b.feather", false, ""),
        ("b.xlsx", false, ""),
        ("b.h5", false, ""),
        ("_metadata", true, "-"),
        (".b.parq", true, "-"),
        (".b.csv", false, "-"),
        ("b.parquet.md5", false, "-"),
        ("README.txt", false, "-"),
        ("b.svg", false, "-"),
        ("b.txt.gz", false, "-"),
        ("b.json", false, "-"),
    ] {
        let path = folder.join(name);
        fs::write(&path, if is_parquet { &parquet[..] } else { b"run,x\n1,1\n" }).unwrap();
        let opened = ForeignTable::open(&folder);
        match refused {
            "" => assert_eq!(opened.unwrap().beside(), std::slice::from_ref(&path), "{name}"),
            "-" => assert!(opened.unwrap().beside().is_empty(), "{name}"),
            told => {
                let said = opened.unwrap_err().to_string();
                assert!(
                    said.starts_with(&path.display().to_string()) && said.contains(told),
                    "{said}"
                );
            }
        }
        fs::remove_file(path).unwrap();
    }
    fs::create_dir(folder.join("more")).unwrap();
    fs::write(folder.join("more/b.parquet.gz"), "").unwrap();
    let said = ForeignTable::open(&folder).unwrap_err().to_string();
    assert!(said.contains("it has the folder more with Parquet files"), "{said}");
}

/// What other programs write of a run that ended well was counted as a failure.
#[test]
fn a_status_is_ok_or_a_reason_or_refused() {
    const STATUSES: [(&str, Option<bool>); 16] = [
        ("ok", Some(true)),
        ("no contact", Some(false)),
        ("simulator: 404", Some(false)),
        ("failed", Some(false)),
        ("not ok", Some(false)),
        ("OK", None),
        ("Ok.", None),
        ("success", None),
        ("Converged", None),
        ("DONE", None),
        ("0", None),
        ("1", None),
        ("true", None),
        ("", None),
        ("nan", None),
        ("None", None),
    ];
    let scratch = scratch();
    let path = scratch.path().join("it.parquet");
    // Every pair of words, so that each stands in each row.
    for (first, of_first) in STATUSES {
        for (second, of_second) in STATUSES {
            let csv = format!("x,run,model,Status\n1,0,a,{first}\n1,1,a,\"{second}\"\n");
            write(
                &path,
                &[
                    ("model", Physical::BYTE_ARRAY, ConvertedType::UTF8, &["a"; 2]),
                    ("run", Physical::INT64, ConvertedType::NONE, &["0", "1"]),
                    ("x", Physical::DOUBLE, ConvertedType::NONE, &["1"; 2]),
                    ("Status", Physical::BYTE_ARRAY, ConvertedType::UTF8, &[first, second]),
                ],
            );
            let requirement: [Requirement; 1] = ["x <= 3 in 60 % at 80 %".parse().unwrap()];
            let of_csv = ForeignTable::read_csv("it.csv".as_ref(), csv.as_bytes()).unwrap();
            let of_file = ForeignTable::open(&path).unwrap();
            for (table, [one, other]) in [
                (of_csv, ["line 2,", "line 3,"]),
                (of_file, ["row 0 (from 0),", "row 1 (from 0),"]),
            ] {
                let judged = Judgement::of_table(&requirement, &table);
                match (judged, of_first, of_second) {
                    (Ok(judged), Some(first), Some(second)) => {
                        let failures = u64::from(!first) + u64::from(!second);
                        assert_eq!((judged[0].runs(), judged[0].failures()), (2, failures));
                    }
                    (Err(error), ..) => {
                        let said = error.to_string();
                        let (word, place) =
                            if of_first.is_none() { (first, one) } else { (second, other) };
                        assert!(of_first.is_none() || of_second.is_none(), "{said}");
                        let told = format!("{word:?}, which does not say whether the run ended");
                        assert!(
                            said.contains(&told)
                                && said.contains(place)
                                && said.contains("\"Status\"")
                                && said.contains("it must be \"ok\""),
                            "{said}"
                        );
                    }
                    (Ok(_), ..) => panic!("{first:?}, {second:?} were judged"),
                }
            }
        }
    }
}

/// The same rows are no runs in Parquet, however the texts are stored and wherever they stand; a first column that names models beside runs has any
/// names.
#[test]
fn rows_that_are_no_runs_are_seen() {
    let scratch = scratch();
    let path = scratch.path().join("it.parquet");
    const X: Stored<'_> = ("x", Physical::DOUBLE, ConvertedType::NONE, &["1", "2", "1.5"]);
    for (physical, cells) in [
        (Physical::BYTE_ARRAY, ["0", "1", "Mean"]),
        (Physical::FIXED_LEN_BYTE_ARRAY, ["0000", "0001", "Mean"]),
    ] {
        let text = (physical, ConvertedType::NONE, &cells);
        let found = |columns: &[Stored<'_>]| {
            write(&path, columns);
            judged(&path, "x <= 100 in 60 % at 80 %")
        };
        for (name, run_first) in [("run", true), ("Run", false), ("case", true), ("case", false)] {
            let named: Stored<'_> = (name, text.0, text.1, text.2);
            let found = found(&if run_first { [named, X] } else { [X, named] });
            let said = format!("row 2 (from 0), column {name:?}: the row says \"Mean\"");
            assert!(found.as_ref().is_err_and(|refused| refused.contains(&said)), "{found:?}");
        }
        let model: Stored<'_> = ("model", text.0, text.1, text.2);
        let run: Stored<'_> = ("run", Physical::INT32, ConvertedType::NONE, &["0", "1", "2"]);
        assert_eq!(found(&[model, run, X]), Ok([3, 0]));
        let run: Stored<'_> =
            ("run", Physical::BYTE_ARRAY, ConvertedType::UTF8, &["0", "1", "last"]);
        let refused = found(&[model, run, X]).unwrap_err();
        assert!(
            refused.contains("row 2 (from 0), column \"run\": \"last\" is not the number of a run"),
            "{refused}"
        );
    }
}

/// A cell with a comma says why it is none, and a folder of a study which tables it has.
#[test]
fn what_is_no_table_or_number_is_told_with_what_to_do() {
    for cell in ["0,53", "-1,5", "1,250", "1,250.5", "1.250,5", "12,5e3"] {
        let text = format!("run;x\n0;1\n1;{cell}\n");
        let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
        let requirement: Requirement = "x <= 1 in 60 % at 80 %".parse().unwrap();
        let refused = Judgement::of_table(&[requirement], &table).unwrap_err().to_string();
        let said = format!("line 3, column \"x\": {cell:?} is not a number: commas are not read");
        assert!(refused.contains(&said), "{refused}");
    }
    let scratch = scratch();
    let opened = || ForeignTable::open(scratch.path()).unwrap_err().to_string();
    assert!(opened().contains("in runs/ below its folder"), "{}", opened());
    for model in ["a", "b"] {
        fs::create_dir_all(scratch.path().join("runs").join(model)).unwrap();
        let named = scratch.path().join("runs").join(model).display().to_string();
        assert!(opened().contains("name ") && opened().contains(&named), "{}", opened());
    }
}
