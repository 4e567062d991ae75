//! Tables written in every form, and read back.

use gyradius_campaign::{
    Cell, Column, Extent, Failure, FormatError, Kind, Table, TableError, TableFormat, read_run,
};
use proptest::prelude::*;
use std::collections::HashMap;

use crate::scratch::scratch;

/// What a run has in the columns of a table, and why it failed if it did.
type Run = (Option<String>, Vec<Cell<'static>>);

fn texts() -> impl Strategy<Value = String> {
    // Commas, quotes and ends of lines, and more than ASCII.
    prop_oneof!["[a-z ,\"'\\\\\n\r]{0,8}", "[α-ω🚀x]{1,4}"]
}

fn columns() -> impl Strategy<Value = Vec<Column>> {
    let kinds =
        prop_oneof![Just(Kind::Number), Just(Kind::Integer), Just(Kind::Text), Just(Kind::Flag)];
    let column = ("[a-z' \\\\é]{1,10}", kinds, any::<bool>());
    prop::collection::vec(column, 0..8).prop_map(|columns| {
        let of = |(i, (name, kind, optional)): (usize, (String, Kind, bool))| {
            let column = Column::new(format!("{name}{i}"), kind, "");
            if optional { column } else { column.required() }
        };
        columns.into_iter().enumerate().map(of).collect()
    })
}

fn cell(column: &Column) -> BoxedStrategy<Cell<'static>> {
    let cell = match column.kind() {
        Kind::Number => any::<u64>().prop_map(|bits| Cell::Number(f64::from_bits(bits))).boxed(),
        Kind::Integer => any::<i64>().prop_map(Cell::Integer).boxed(),
        Kind::Text => texts().prop_map(|text| Cell::Text(text.into())).boxed(),
        Kind::Flag => any::<bool>().prop_map(Cell::Flag).boxed(),
    };
    if column.is_optional() { prop_oneof![2 => cell, 1 => Just(Cell::Null)].boxed() } else { cell }
}

/// A table in blocks of any sizes.
fn blocks() -> impl Strategy<Value = Vec<Table>> {
    columns().prop_flat_map(|columns| {
        let cells: Vec<_> = columns.iter().map(cell).collect();
        let run = (prop::option::of(texts()), cells);
        let runs = prop::collection::vec(prop::collection::vec(run, 0..30), 0..4);
        (runs, 0_u64..1000).prop_map(move |(runs, first)| tables(&columns, runs, first))
    })
}

fn tables(columns: &[Column], runs: Vec<Vec<Run>>, mut first: u64) -> Vec<Table> {
    let mut tables = Vec::new();
    for block in runs {
        let mut table = Table::new("model", first, columns.to_vec()).unwrap();
        first += block.len() as u64;
        for (failure, cells) in block {
            table.push(failure.map(|message| Failure::new("kind", message)), cells).unwrap();
        }
        tables.push(table);
    }
    if tables.is_empty() {
        tables.push(Table::new("model", first, columns.to_vec()).unwrap());
    }
    tables
}

fn written(format: TableFormat, tables: &[Table]) -> Vec<u8> {
    let mut extent = Extent::default();
    tables.iter().for_each(|table| extent.add(table));
    let mut bytes = Vec::new();
    let mut writer = format.writer(&tables[0], &extent, &mut bytes).unwrap();
    tables.iter().for_each(|table| writer.write(table).unwrap());
    writer.finish().unwrap();
    bytes
}

/// A number that another program reads.
fn same(read: f64, number: f64) -> bool {
    read.to_bits() == number.to_bits() || (read.is_nan() && number.is_nan())
}

fn is_written(text: &str, cell: &Cell<'_>) -> bool {
    match cell {
        Cell::Number(number) => same(text.parse().unwrap(), *number),
        other => text == if *other == Cell::Null { String::new() } else { other.to_string() },
    }
}

fn is_value(value: &serde_json::Value, cell: &Cell<'_>) -> bool {
    match cell {
        Cell::Number(number) if number.is_finite() => same(value.as_f64().unwrap(), *number),
        // JSON has no others.
        Cell::Number(_) | Cell::Null => value.is_null(),
        Cell::Integer(integer) => value.as_i64() == Some(*integer),
        Cell::Text(text) | Cell::Note { text, .. } => value.as_str() == Some(text),
        Cell::Flag(flag) => value.as_bool() == Some(*flag),
    }
}

/// The fields of a structured array with their types, how many records it has, and the records.
fn read_npy(bytes: &[u8]) -> (Vec<(String, String)>, usize, &[u8]) {
    assert_eq!(&bytes[..6], b"\x93NUMPY");
    let (start, length) = match bytes[6] {
        1 => (10, usize::from(u16::from_le_bytes([bytes[8], bytes[9]]))),
        _ => (12, u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize),
    };
    let (header, records) = bytes[start..].split_at(length);
    assert_eq!((start + length) % 64, 0);
    let header = std::str::from_utf8(header).unwrap();
    assert!(header.ends_with('\n') && (bytes[6] == 3) != header.is_ascii(), "{header}");
    let header = header.trim_end();
    let rest = header.strip_prefix("{'descr': [").unwrap();
    let (fields, rest) = rest.rsplit_once("], 'fortran_order': False, 'shape': (").unwrap();
    let count = rest.strip_suffix(",), }").unwrap().parse().unwrap();
    // Texts between quotes, two of them a field.
    let (mut texts, mut text, mut inside) = (Vec::new(), String::new(), false);
    let mut chars = fields.chars();
    while let Some(c) = chars.next() {
        match (c, inside) {
            ('\'', true) => texts.push(std::mem::take(&mut text)),
            ('\\', true) => text.push(chars.next().unwrap()),
            (c, true) => text.push(c),
            _ => {}
        }
        inside ^= c == '\'';
    }
    let fields = texts.chunks(2).map(|pair| (pair[0].clone(), pair[1].clone())).collect();
    (fields, count, records)
}

/// Takes a value from the records and holds it against a cell.
fn takes(records: &mut &[u8], dtype: &str, cell: &Cell<'_>) -> bool {
    let mut take = |count: usize| {
        let (taken, rest) = records.split_at(count);
        *records = rest;
        taken
    };
    match dtype {
        "<f8" => {
            let read = f64::from_le_bytes(take(8).try_into().unwrap());
            match cell {
                Cell::Number(number) => read.to_bits() == number.to_bits(),
                other => *other == Cell::Null && read.is_nan(),
            }
        }
        "<i8" => {
            let read = i64::from_le_bytes(take(8).try_into().unwrap());
            *cell == Cell::Integer(read) || (*cell == Cell::Null && read == i64::MIN)
        }
        "|b1" | "|i1" => match take(1)[0] as i8 {
            -1 => *cell == Cell::Null && dtype == "|i1",
            flag => *cell == Cell::Flag(flag == 1),
        },
        text => {
            let width: usize = text.strip_prefix("<U").unwrap().parse().unwrap();
            let points = take(4 * width).chunks(4);
            let text: String = points
                .map(|point| u32::from_le_bytes(point.try_into().unwrap()))
                .filter(|point| *point != 0)
                .map(|point| char::from_u32(point).unwrap())
                .collect();
            *cell == Cell::Text(text.clone().into()) || (*cell == Cell::Null && text.is_empty())
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Every cell of every table, whatever the blocks.
    #[test]
    fn every_form_holds_every_cell(tables in blocks()) {
        let names: Vec<&str> = tables[0].columns().iter().map(Column::name).collect();
        let rows: Vec<Vec<Cell<'_>>> = tables
            .iter()
            .flat_map(Table::rows)
            .map(|row| row.cells().map(|(_, cell)| cell).collect())
            .collect();

        let csv = written(TableFormat::Csv, &tables);
        let mut lines = csv::ReaderBuilder::new().from_reader(&csv[..]);
        prop_assert_eq!(lines.headers().unwrap().iter().collect::<Vec<_>>(), names.clone());
        let lines: Vec<csv::StringRecord> = lines.records().map(Result::unwrap).collect();
        prop_assert_eq!(lines.len(), rows.len());
        for (line, row) in lines.iter().zip(&rows) {
            prop_assert_eq!(line.len(), row.len());
            prop_assert!(line.iter().zip(row).all(|(text, cell)| is_written(text, cell)), "{:?}", row);
        }

        let json = String::from_utf8(written(TableFormat::JsonLines, &tables)).unwrap();
        prop_assert_eq!(json.lines().count(), rows.len());
        for (line, row) in json.lines().zip(&rows) {
            let object: HashMap<String, serde_json::Value> = serde_json::from_str(line).unwrap();
            prop_assert_eq!(object.len(), row.len());
            prop_assert!(names.iter().zip(row).all(|(name, cell)| is_value(&object[*name], cell)));
        }

        let npy = written(TableFormat::Npy, &tables);
        let (fields, count, mut records) = read_npy(&npy);
        prop_assert_eq!(fields.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), names);
        prop_assert_eq!(count, rows.len());
        for row in &rows {
            for ((name, dtype), cell) in fields.iter().zip(row) {
                prop_assert!(takes(&mut records, dtype, cell), "{} {} {:?}", name, dtype, cell);
            }
        }
        prop_assert!(records.is_empty());

        let parquet = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(parquet.path(), written(TableFormat::Parquet, &tables)).unwrap();
        if !rows.is_empty() {
            let read = tables[0].read_parquet(parquet.path()).unwrap();
            prop_assert_eq!(read.first(), tables[0].first());
            prop_assert!(read.rows().eq(tables.iter().flat_map(Table::rows)));
        }
    }

    /// A head that says something else than what comes is an error, never a broken array.
    #[test]
    fn arrays_are_as_long_as_they_say(said in 0_usize..4, found in 0_usize..4, wide in 0_usize..6) {
        let columns = vec![Column::new("note", Kind::Text, "")];
        let table = |runs: usize, text: &str| {
            let run: Run = (None, vec![Cell::Text(text.to_owned().into())]);
            tables(&columns, vec![vec![run; runs]], 0).remove(0)
        };
        let mut extent = Extent::default();
        extent.add(&table(said, "four"));
        let runs = table(found, &"x".repeat(wide));
        let mut bytes = Vec::new();
        let mut writer = TableFormat::Npy.writer(&runs, &extent, &mut bytes).unwrap();
        let result = writer.write(&runs).and_then(|()| writer.finish());
        let fits = said == found && (found == 0 || wide <= 4);
        match result {
            Ok(()) => prop_assert!(fits),
            Err(FormatError::Extent { .. }) => prop_assert!(!fits),
            Err(other) => prop_assert!(false, "{}", other),
        }
    }
}

/// Runs of several models, some of which do not follow each other, in more than one group of rows: in their order.
#[test]
fn long_tables_of_several_models_are_written_in_order() {
    let columns = vec![Column::number("x", "1", "").required()];
    let mut tables = Vec::new();
    for (model, first, runs) in [
        ("a", 0, 100_000),
        ("a", 100_000, 100_000),
        ("a", 200_000, 5),
        ("a", 250_000, 3),
        ("b", 10, 4),
    ] {
        let mut table = Table::new(model, first, columns.clone()).unwrap();
        (first..first + runs).for_each(|run| table.push(None, [(run as f64).into()]).unwrap());
        tables.push(table);
    }
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), written(TableFormat::Parquet, &tables)).unwrap();
    for table in &tables {
        for row in [0, table.len() / 2, table.len() - 1] {
            let expected = table.row(row).unwrap();
            let run = (table.model(), expected.run());
            let read = read_run(file.path(), run).unwrap().unwrap();
            assert!(
                read.iter()
                    .map(|(_, cell)| cell)
                    .cloned()
                    .eq(expected.cells().map(|(_, cell)| cell))
            );
        }
    }
    assert!(read_run(file.path(), ("a", 10)).unwrap().is_some());
    assert!(read_run(file.path(), ("b", 9)).unwrap().is_none());
    // What cannot be read is named, whether it is not there or no table.
    let scratch = scratch();
    let [missing, wrong] =
        ["missing.parquet", "wrong.parquet"].map(|name| scratch.path().join(name));
    std::fs::write(&wrong, "model,run\nm,1\n").unwrap();
    for path in [missing, wrong] {
        let place = format!("{}: ", path.display());
        let refused = read_run(&path, ("m", 1)).unwrap_err().to_string();
        assert!(refused.starts_with(&place) && !refused.contains("External"), "{refused}");
        let refused = tables[0].read_parquet(&path).unwrap_err().to_string();
        assert!(refused.starts_with(&place) && !refused.contains("External"), "{refused}");
    }
}

#[test]
fn forms_are_known_by_name_and_by_extension() {
    let mut extensions = Vec::new();
    for format in TableFormat::ALL {
        assert_eq!(TableFormat::named(format.name()), Some(format));
        for extension in format.extensions() {
            for path in [format!("a.{extension}"), format!("b/.c.{}", extension.to_uppercase())] {
                assert_eq!(TableFormat::of_path(path.as_ref()), Some(format), "{path}");
            }
            assert!(!extensions.contains(extension), "{extension}");
            extensions.push(extension);
        }
    }
    for path in ["csv", "a", "a.txt", "", "a.csv/", ".npy", "a.csv.gz"] {
        let found = TableFormat::of_path(path.as_ref());
        assert_eq!(found.is_some(), path == "a.csv/", "{path}");
    }
    assert_eq!(TableFormat::named("CSV"), None);
}

/// A run that would have a number beyond the last is refused by name, and the table is as it was.
#[test]
fn runs_have_numbers_that_there_are() {
    for room in 0..5_u64 {
        let first = u64::MAX - room;
        let mut table = Table::new("m", first, vec![Column::number("x", "1", "a number")]).unwrap();
        for _ in 0..room {
            table.push(None, [Cell::Number(1.0)]).unwrap();
        }
        for _ in 0..2 {
            let refused = table.push(None, [Cell::Number(1.0)]).unwrap_err();
            assert_eq!(refused, TableError::Runs { first });
            assert!(refused.to_string().contains(&first.to_string()), "{refused}");
        }
        let runs: Vec<u64> = table.rows().map(|row| row.run()).collect();
        assert_eq!(runs, (first..u64::MAX).collect::<Vec<_>>());
    }
}
