//! Simulations of every kind of column, held against plain lists; tables written and read back.

use bytes::Bytes;
use gyradius_campaign::{
    CampaignError, Cell, Column, Failure, Forecast, Kind, Simulation, Streams, Table, TableError,
    read_run, run, threads,
};
use parquet::{
    file::reader::{FileReader, SerializedFileReader},
    record::Field,
};
use proptest::prelude::*;
use rand::RngExt;
use std::{ops::Range, sync::Mutex};

use crate::scratch::scratch;

/// Columns of every kind, filled from the streams of a seed.
struct Everything {
    streams: Streams,
}

const KINDS: [Kind; 4] = [Kind::Number, Kind::Integer, Kind::Text, Kind::Flag];

/// Numbers that do not survive careless printing.
const AWKWARD: [f64; 8] =
    [0.1 + 0.2, f64::MIN_POSITIVE / 8.0, 1e300, -0.0, 1.0 / 3.0, f64::NAN, f64::INFINITY, -1e-300];

impl Everything {
    fn new(seed: u64) -> Self {
        Self { streams: Streams::new(seed, "everything", "all") }
    }

    fn row(&self, run: u64) -> (Option<Failure>, Vec<Cell<'static>>) {
        let mut rng = self.streams.run(run);
        let mut cell = |kind: Kind, optional: bool| {
            if optional && rng.random_bool(0.3) {
                return Cell::Null;
            }
            match kind {
                Kind::Number => Cell::Number(AWKWARD[rng.random_range(0..8)]),
                Kind::Integer => Cell::Integer(rng.random()),
                Kind::Text if rng.random_bool(0.5) => {
                    Cell::Text(rng.random_range(0..5).to_string().into())
                }
                Kind::Text => {
                    let length = rng.random::<f64>();
                    Cell::Note { kind: "long".into(), text: format!("long: {length}").into() }
                }
                Kind::Flag => Cell::Flag(rng.random()),
            }
        };
        let cells = KINDS.into_iter().flat_map(|kind| [(kind, true), (kind, false)]);
        let cells = cells.map(|(kind, optional)| cell(kind, optional)).collect();
        let failure =
            rng.random_bool(0.2).then(|| Failure::new("bad luck", format!("bad luck in {run}")));
        (failure, cells)
    }
}

impl Simulation for Everything {
    type Worker = u64;

    fn columns(&self) -> Vec<Column> {
        let columns = KINDS.into_iter().flat_map(|kind| {
            let column = |name: &str| {
                Column::new(format!("{name}_{kind:?}"), kind, "Something.").with_kinds()
            };
            [column("some"), column("all").required()]
        });
        columns.collect()
    }

    fn worker(&self) -> u64 {
        0
    }

    fn run(&self, runs: Range<u64>, worker: &mut u64, rows: &mut Table) -> Result<(), TableError> {
        for run in runs {
            *worker += 1;
            let (failure, cells) = self.row(run);
            rows.push(failure, cells)?;
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Any number of runs on any number of threads: the rows are those of each run alone, in order, and every
    /// one is told once.
    #[test]
    fn rows_are_those_of_each_run_alone(seed in any::<u64>(), runs in 0_u64..300, on in 1_usize..5) {
        let simulation = Everything::new(seed);
        let told = Mutex::new(Vec::new());
        let progress = |done| told.lock().unwrap().push(done);
        let table = run(&simulation, "any", runs, &threads(Some(on)).unwrap(), &progress).unwrap();
        prop_assert_eq!(table.len() as u64, runs);
        let mut told = told.into_inner().unwrap();
        told.sort_unstable();
        prop_assert_eq!(told.last().copied().unwrap_or(0), runs);
        prop_assert!(told.windows(2).all(|pair| pair[0] < pair[1]));
        let mut failed = 0;
        for (row, i) in table.rows().zip(0..) {
            let (failure, cells) = simulation.row(i);
            prop_assert_eq!(row.run(), i);
            prop_assert_eq!(row.failure(), failure.as_ref());
            failed += usize::from(failure.is_some());
            let found: Vec<_> = row.cells().skip(3).map(|(_, cell)| cell).collect();
            let kind = failure.as_ref().map_or("ok", Failure::kind).to_owned();
            let kinds = cells[4..6].iter().map(|cell| match cell {
                Cell::Note { kind, .. } => Cell::Text(kind.clone()),
                other => other.clone(),
            });
            let expected = cells.iter().cloned().chain([Cell::Text(kind.into())]).chain(kinds);
            prop_assert_eq!(found, expected.collect::<Vec<_>>());
        }
        prop_assert_eq!(table.failures().len(), failed);
    }

    /// Written and read back: every cell, to the bit, whole and one row at a time.
    #[test]
    fn parquet_reads_back_bit_for_bit(seed in any::<u64>(), runs in 1_u64..80) {
        let table = run(&Everything::new(seed), "any", runs, &threads(Some(1)).unwrap(), &|_| {}).unwrap();
        let mut file = Vec::new();
        table.write_parquet(&mut file).unwrap();
        let reader = SerializedFileReader::new(Bytes::from(file.clone())).unwrap();
        for (read, row) in reader.get_row_iter(None).unwrap().map(Result::unwrap).zip(table.rows()) {
            for ((name, field), (column, cell)) in read.get_column_iter().zip(row.cells()) {
                prop_assert_eq!(name.as_str(), column.name());
                match (field, cell) {
                    (Field::Double(found), Cell::Number(x)) => prop_assert_eq!(found.to_bits(), x.to_bits()),
                    (Field::Long(found), Cell::Integer(i)) => prop_assert_eq!(*found, i),
                    (Field::Bool(found), Cell::Flag(flag)) => prop_assert_eq!(*found, flag),
                    (Field::Str(found), Cell::Text(text) | Cell::Note { text, .. }) => {
                        prop_assert_eq!(found.as_str(), &*text);
                    }
                    (Field::Null, Cell::Null) => {}
                    (found, cell) => prop_assert!(false, "{}: {} for {:?}", name, found, cell),
                }
            }
        }
        let scratch = scratch();
        let path = scratch.path().join("runs.parquet");
        std::fs::write(&path, &file).unwrap();
        let whole = table.from_run(0).read_parquet(&path).unwrap();
        prop_assert!(whole.rows().eq(table.rows()));
        prop_assert!(whole.failures().eq(table.failures()));
        for row in table.rows() {
            let read = read_run(&path, ("any", row.run())).unwrap().unwrap();
            prop_assert!(read.iter().map(|(_, cell)| cell).eq(row.cells().map(|(_, cell)| cell).collect::<Vec<_>>().iter()));
        }
        prop_assert!(read_run(&path, ("any", runs)).unwrap().is_none());
        std::fs::write(&path, &file[..file.len() / 2]).unwrap();
        prop_assert!(read_run(&path, ("any", 0)).is_err());
        prop_assert!(table.from_run(0).read_parquet(&path).is_err());
    }

    /// A row that does not fit changes nothing: the rows after it are as if it had not been tried.
    #[test]
    fn a_row_that_does_not_fit_leaves_no_trace(seed in any::<u64>(), at in 0_usize..8, what in 0_usize..4) {
        let simulation = Everything::new(seed);
        let new = || Table::new("any", 0, simulation.columns()).unwrap();
        let (mut plain, mut tried) = (new(), new());
        for run in 0..70 {
            let (failure, cells) = simulation.row(run);
            let mut bad = cells.clone();
            match what {
                0 => bad.truncate(at),
                1 => bad.push(Cell::Null),
                2 => bad[at] = if at / 2 == 3 { Cell::Number(1.0) } else { Cell::Flag(true) },
                _ => bad[at | 1] = Cell::Null,
            }
            prop_assert!(tried.push(None, bad).is_err());
            prop_assert_eq!(tried.len() as u64, run);
            plain.push(failure.clone(), cells.clone()).unwrap();
            tried.push(failure, cells).unwrap();
        }
        prop_assert!(plain.rows().eq(tried.rows()));
    }
}

/// A simulation that forgets runs, or makes them up.
struct Wrong(i64);

impl Simulation for Wrong {
    type Worker = ();

    fn columns(&self) -> Vec<Column> {
        vec![Column::number("x", "1", "A number.")]
    }

    fn worker(&self) {}

    fn run(&self, runs: Range<u64>, (): &mut (), rows: &mut Table) -> Result<(), TableError> {
        let count = (runs.end - runs.start) as i64 + self.0;
        (0..count).try_for_each(|_| rows.push(None, [Cell::Number(0.0)]))
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let pool = threads(Some(2)).unwrap();
    for off in [-1, 1] {
        let error = run(&Wrong(off), "wrong", 100, &pool, &|_| {}).unwrap_err();
        assert!(matches!(error, CampaignError::Rows { .. }), "{error}");
    }
    assert!(run(&Wrong(0), "right", 100, &pool, &|_| {}).is_ok());
    for names in [["run", "x"], ["x", "x"], ["", "x"], ["x", "status"], ["model", "x"]] {
        let columns = names.map(|name| Column::number(name, "1", "")).to_vec();
        let error = Table::new("m", 0, columns).unwrap_err().to_string();
        let why = if names[0].is_empty() { "must have a name" } else { "another column" };
        assert!(error.contains(why), "{error}");
    }
    for count in [0, 1025, usize::MAX] {
        let error = threads(Some(count)).unwrap_err().to_string();
        assert!(error.contains(&count.to_string()) && error.contains("between 1 and 1024"));
    }
    let forecast = Forecast::of(&[Everything::new(1)], 1_000_000, 2).unwrap();
    assert_eq!(forecast.memory(), None);
    let text = forecast.to_string();
    assert!(text.contains("for 1000000 runs on 2 threads, and "), "{text}");
    // The memory grows with threads, columns and blocks, and with runs only as far as they fill a block.
    let of = |runs, threads, block, columns| {
        Forecast::untimed(runs, 1, threads).in_blocks_of(block, columns).memory().unwrap()
    };
    let usual = of(1 << 20, 2, 1 << 14, 60);
    assert_eq!(of(1 << 40, 2, 1 << 14, 60), usual);
    assert!(of(1 << 10, 2, 1 << 14, 60) < usual && of(1 << 20, 4, 1 << 14, 60) > usual);
    assert!(of(1 << 20, 2, 1 << 15, 60) > usual && of(1 << 20, 2, 1 << 14, 61) > usual);
    assert_eq!(of(u64::MAX, usize::MAX, u64::MAX, usize::MAX), u64::MAX);
}
