//! Where a row of a table is said to be.

use gyradius_campaign::ForeignTable;
use proptest::prelude::*;
use std::fs;

use crate::{
    scratch::scratch,
    several_models::{Row, write_parquet},
};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Of any files, some of which may be empty, and of CSV below comments.
    #[test]
    fn every_row_is_found(sizes in prop::collection::vec(0..6_usize, 1..4), comments in 0..3_usize) {
        let scratch = scratch();
        let folder = scratch.path().join("folder");
        fs::create_dir(&folder).unwrap();
        let (mut places, mut csv) = (Vec::new(), format!("{}x,run\n", "# a comment\n".repeat(comments)));
        for (file, size) in sizes.iter().enumerate() {
            let name = format!("{file}.parquet");
            let rows: Vec<Row> = (0..*size).map(|row| ("a", row as u64, 0)).collect();
            write_parquet(&folder.join(&name), ["model", "run"], &rows);
            for row in 0..*size {
                csv += "1,2\n";
                places.push((format!("row {row} (from 0) of {name}"), format!("line {}", csv.lines().count())));
            }
        }
        let table = ForeignTable::read_csv("it".as_ref(), csv.as_bytes()).unwrap();
        let of_folder = ForeignTable::open(&folder).unwrap();
        for (row, (in_file, line)) in (0..).zip(places) {
            prop_assert_eq!([of_folder.row_at(row), table.row_at(row)], [in_file, line]);
        }
    }
}
