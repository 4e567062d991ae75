//! Tables of the runs of several models that have something in common, as flights of a vehicle: which vehicles are whole, and keep a requirement.

use gyradius_campaign::{Counting, ForeignTable, Judgement, Looks, Requirement};
use parquet::{
    data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type},
    file::writer::SerializedFileWriter,
    schema::parser::parse_message_type,
};
use proptest::prelude::*;
use std::{
    collections::BTreeMap,
    fs::{self, File},
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::scratch::scratch;

/// A row: its model, its run and its number.
pub(crate) type Row = (&'static str, u64, i32);

pub(crate) fn write_parquet(path: &Path, [model, run]: [&str; 2], rows: &[Row]) {
    let schema = format!(
        "message it {{ required binary {model} (UTF8); required double x; required int64 {run}; }}"
    );
    let schema = Arc::new(parse_message_type(&schema).unwrap());
    let file = File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::default()).unwrap();
    // In two groups of rows.
    for rows in rows.chunks(rows.len().div_ceil(2).max(1)) {
        let mut group = writer.next_row_group().unwrap();
        macro_rules! column {
            ($type:ty, $cell:expr) => {{
                let cells: Vec<_> = rows.iter().map($cell).collect();
                let mut column = group.next_column().unwrap().unwrap();
                column.typed::<$type>().write_batch(&cells, None, None).unwrap();
                column.close().unwrap();
            }};
        }
        column!(ByteArrayType, |(model, ..)| ByteArray::from(*model));
        column!(DoubleType, |(_, _, x)| f64::from(*x));
        column!(Int64Type, |(_, run, _)| *run as i64);
        group.close().unwrap();
    }
    writer.close().unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Whatever the order of the rows and the files that they are in: vehicles are those of a model, and whole if all of their flights are there.
    /// What is told is the same of every order.
    #[test]
    fn vehicles_are_those_of_their_models(
        models in prop::sample::subsequence(vec!["a", "b", "B", "c d", ""], 1..5),
        (vehicles, flights) in (1..8_u64, 2..5_u64),
        cells in prop::collection::vec(prop::option::weighted(0.85, -2..3_i32), 4 * 8 * 5),
        order in prop::collection::vec(any::<u32>(), 4 * 8 * 5),
        heads in prop::sample::select(vec![["model", "run"], ["Model", "RUN"], ["MODEL", "run"]]),
        files in 1..4_usize,
    ) {
        let runs = vehicles * flights;
        let of_models = models.iter().flat_map(|model| (0..runs).map(move |run| (*model, run)));
        let rows: Vec<Row> =
            of_models.zip(&cells).filter_map(|((model, run), x)| Some((model, run, (*x)?))).collect();
        let firsts: Vec<&Row> = rows.iter().filter(|(_, run, _)| run % flights == 0).collect();
        prop_assume!(!firsts.is_empty());
        let fails = |row: &Row| row.2 > 0;
        let mut of_vehicles: BTreeMap<(&str, u64), [u64; 2]> = BTreeMap::new();
        for row in &rows {
            let [seen, failing] = of_vehicles.entry((row.0, row.1 / flights)).or_default();
            *seen += 1;
            *failing += u64::from(fails(row));
        }
        let whole: Vec<u64> = of_vehicles
            .into_values()
            .filter_map(|[seen, failing]| (seen == flights).then_some(seen - failing))
            .collect();
        let keeping = whole.iter().filter(|kept| **kept as f64 / flights as f64 >= 0.6).count() as u64;

        let mut shuffled: Vec<(u32, Row)> = order.into_iter().zip(rows.clone()).collect();
        shuffled.sort_by_key(|(place, _)| *place);
        let shuffled: Vec<Row> = shuffled.into_iter().map(|(_, row)| row).collect();
        let scratch = scratch();
        let in_file = |name: &str, rows: &[Row]| -> PathBuf {
            let path = scratch.path().join(name);
            let line = |(model, run, x): &Row| format!("{x},{run},{model}\n");
            let text = format!("x,{},{}\n{}", heads[1], heads[0], rows.iter().map(line).collect::<String>());
            fs::write(&path, text).unwrap();
            path
        };
        let in_folder = |name: &str, rows: &[Row]| -> PathBuf {
            let path = scratch.path().join(name);
            fs::create_dir(&path).unwrap();
            for (file, rows) in rows.chunks(rows.len().div_ceil(files).max(1)).enumerate() {
                write_parquet(&path.join(format!("{file}.parquet")), heads, rows);
            }
            path
        };
        let requirement: Requirement = "x <= 0 in 60 % at 80 %".parse().unwrap();
        let judged = |path: &Path| {
            let table = ForeignTable::open(path).unwrap().counted(Counting::new(Looks::Once, flights));
            Judgement::of_table(std::slice::from_ref(&requirement), &table).unwrap().remove(0)
        };
        let first = judged(&in_file("it.csv", &rows));
        let failures = firsts.iter().filter(|row| fails(row)).count() as u64;
        prop_assert_eq!([first.counted(), first.failures()], [firsts.len() as u64, failures]);
        let told = serde_json::to_value(&first).unwrap();
        prop_assert_eq!([&told["vehicles"]["vehicles"], &told["vehicles"]["keeping"]], [whole.len() as u64, keeping]);
        for other in [in_file("other.csv", &shuffled), in_folder("all", &rows), in_folder("others", &shuffled)] {
            prop_assert_eq!(&judged(&other), &first, "{}", other.display());
        }
    }
}
