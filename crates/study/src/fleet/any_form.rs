//! The same table as CSV, as one Parquet file and as two in either order, with columns of any type: the answer is the same.

use gyradius_campaign::{ForeignTable, Judgement, Requirement};
use parquet::{
    column::writer::ColumnWriter,
    data_type::{ByteArray, FixedLenByteArray},
    file::{metadata::KeyValue, properties::WriterProperties, writer::SerializedFileWriter},
    schema::parser::parse_message_type,
};
use proptest::prelude::*;
use std::{
    error::Error,
    fmt::Write,
    fs::{self, File},
    path::Path,
    sync::Arc,
};

use super::Fleet;

/// How a column is stored in Parquet.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stored {
    Double,
    Long,
    Text,
    Decimal,
    LongDecimal,
    Half,
}

const OF_NUMBERS: [Stored; 6] = [
    Stored::Double,
    Stored::Long,
    Stored::Text,
    Stored::Decimal,
    Stored::LongDecimal,
    Stored::Half,
];

impl Stored {
    fn schema(self, name: &str) -> String {
        let (physical, meaning) = match self {
            Self::Double => ("double", ""),
            Self::Long => ("int64", ""),
            Self::Text => ("binary", "(UTF8)"),
            Self::Decimal => ("int64", "(DECIMAL(18,1))"),
            Self::LongDecimal => ("fixed_len_byte_array(9)", "(DECIMAL(20,1))"),
            Self::Half => ("fixed_len_byte_array(2)", "(FLOAT16)"),
        };
        format!("optional {physical} {name} {meaning};")
    }
}

#[derive(Clone, Debug)]
struct Held {
    name: &'static str,
    stored: Stored,
    cells: Vec<String>,
}

impl Held {
    /// What it is stored as in a file: one without a text has no type there, as pandas writes it.
    fn stored(&self, rows: &[usize]) -> Stored {
        let is_empty = rows.iter().all(|row| self.cells[*row].is_empty());
        let is_number =
            self.cells.iter().all(|cell| cell.is_empty() || cell.parse::<f64>().is_ok());
        let is_whole = self.cells.iter().all(|cell| cell.is_empty() || cell.parse::<i64>().is_ok());
        match self.stored {
            Stored::Text if is_empty && self.name != "status" => Stored::Long,
            Stored::Long if !is_whole && is_number => Stored::Double,
            _ if !is_number => Stored::Text,
            stored => stored,
        }
    }
}

fn csv(columns: &[&Held], rows: &[usize]) -> String {
    let line = |cells: Vec<&str>| cells.join(",") + "\n";
    let mut text = line(columns.iter().map(|column| column.name).collect());
    for row in rows {
        text += &line(columns.iter().map(|column| &*column.cells[*row]).collect());
    }
    text
}

/// The bits of a number of 16 bits that is not tiny.
fn half(x: f32) -> [u8; 2] {
    let bits = x.to_bits();
    let exponent = if x == 0.0 { 0 } else { ((bits >> 23 & 255) + 15 - 127) << 10 };
    ((bits >> 16 & 0x8000 | exponent | bits >> 13 & 1023) as u16).to_le_bytes()
}

fn parquet(path: &Path, columns: &[&Held], rows: &[usize]) {
    let stored: Vec<Stored> = columns.iter().map(|column| column.stored(rows)).collect();
    let fields: Vec<String> =
        columns.iter().zip(&stored).map(|(column, stored)| stored.schema(column.name)).collect();
    let schema =
        Arc::new(parse_message_type(&format!("message it {{ {} }}", fields.concat())).unwrap());
    let told = "{\"index_columns\": [\"case\"], \"columns\": []}".to_owned();
    let note = vec![KeyValue::new("pandas".to_owned(), told)];
    let properties = WriterProperties::builder().set_key_value_metadata(Some(note)).build();
    let mut writer =
        SerializedFileWriter::new(File::create(path).unwrap(), schema, properties.into()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for (column, stored) in columns.iter().zip(stored) {
        let cells = || rows.iter().map(|row| &*column.cells[*row]).filter(|cell| !cell.is_empty());
        let levels: Vec<i16> =
            rows.iter().map(|row| i16::from(!column.cells[*row].is_empty())).collect();
        let number = |cell: &str| cell.parse::<f64>().unwrap();
        let tenths = |cell: &str| (10.0 * number(cell)).round() as i64;
        let fixed = |bytes: &[u8]| FixedLenByteArray::from(bytes.to_vec());
        let mut of_column = group.next_column().unwrap().unwrap();
        macro_rules! write {
            ($writer:expr, $cell:expr) => {{
                let cells: Vec<_> = cells().map($cell).collect();
                $writer.write_batch(&cells, Some(&levels), None).unwrap();
            }};
        }
        match of_column.untyped() {
            ColumnWriter::DoubleColumnWriter(w) => write!(w, number),
            ColumnWriter::Int64ColumnWriter(w) if stored == Stored::Decimal => write!(w, tenths),
            ColumnWriter::Int64ColumnWriter(w) => write!(w, |cell| number(cell) as i64),
            ColumnWriter::ByteArrayColumnWriter(w) => write!(w, ByteArray::from),
            ColumnWriter::FixedLenByteArrayColumnWriter(w) if stored == Stored::Half => {
                write!(w, |cell| fixed(&half(number(cell) as f32)));
            }
            ColumnWriter::FixedLenByteArrayColumnWriter(w) => {
                write!(w, |cell| fixed(&i128::from(tenths(cell)).to_be_bytes()[7..]));
            }
            _ => panic!("no test writes this"),
        }
        of_column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
}

/// Parts of the reasons of a text among whole numbers.
const AMONG_WHOLES: [&str; 2] =
    ["stands where the other rows have whole numbers", "is not the number of a run"];

/// What is said of a table: its verdict and warning, and how many runs are judged and fail, or why it is refused, without where.
type Said = Result<(String, [u64; 2]), &'static str>;

fn said(path: &Path) -> Said {
    const REFUSED: [&str; 5] = [
        "a run counts once",
        "one that sums up others is no run",
        "do not belong together",
        "does not say whether the run ended",
        "no row that counts",
    ];
    let judged = || -> Result<_, Box<dyn Error>> {
        let (table, note) = Fleet::first_flights(ForeignTable::open(path)?)?;
        let requirement: Requirement = "x <= 1 in 60 % at 80 %".parse().unwrap();
        let judged = Judgement::of_table(&[requirement], &table)?.remove(0);
        let counts = [judged.runs(), judged.failures()];
        Ok((format!("{note:?} {}", serde_json::to_string(&judged).unwrap()), counts))
    };
    judged().map_err(|error| {
        let told = error.to_string();
        // Which of two such columns is named first is no matter.
        if AMONG_WHOLES.into_iter().any(|known| told.contains(known)) {
            return AMONG_WHOLES[0];
        }
        REFUSED.into_iter().find(|known| told.contains(known)).unwrap_or_else(|| panic!("{told}"))
    })
}

/// A column that may be there: its name, how it is stored, and its cells by what is drawn for each row.
fn held(
    names: Vec<&'static str>,
    stored: Vec<Stored>,
    cells: Vec<&'static str>,
) -> impl Strategy<Value = Held> {
    let cells = prop::collection::vec(prop::sample::select(cells), 8);
    (prop::sample::select(names), prop::sample::select(stored), cells).prop_map(
        |(name, stored, cells)| {
            let cells = cells.into_iter().map(str::to_owned).collect();
            Held { name, stored, cells }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(384))]

    /// Whatever columns there are, and whatever is wrong with the table.
    #[test]
    fn the_answer_is_the_same(
        (rows, first) in (2..8_usize, 0..8_usize),
        x in held(vec!["x"], vec![Stored::Double, Stored::Long], vec!["-1", "0", "1", "2", ""]),
        run in prop::option::of((held(vec!["run", "Run"], OF_NUMBERS.to_vec(), vec!["0", "1", "2", "3", "40"]), prop::bool::weighted(0.7), 0..3_usize)),
        odd in prop::option::weighted(0.2, (0..8_usize, prop::sample::select(vec!["", "0.5", "-1", "a", "-", "Mean"]))),
        model in prop::option::of(held(vec!["model", "Model"], vec![Stored::Text], vec!["a", "b", ""])),
        fleet in prop::option::of((
            held(vec!["vehicle"], OF_NUMBERS.to_vec(), vec!["0", "1", "2"]),
            prop::option::weighted(0.8, held(vec!["flight"], OF_NUMBERS.to_vec(), vec!["0", "1", "2", "", "a"])),
        )),
        is_fleet in prop::bool::weighted(0.6),
        status in prop::option::weighted(0.3, held(vec!["status"], vec![Stored::Text], ["ok", " ok", "no contact"].repeat(9).into_iter().chain(["done"]).collect())),
        labels in prop::collection::vec((
            held(vec!["label", "note"], vec![Stored::Text], vec!["", "", "1", "2.5", "-", "arm", "2026-01-01"]),
            prop::option::weighted(0.2, (0..8_usize, prop::sample::select(vec!["Mean", "3σ", "Std. Dev."]))),
        ), 0..3),
        case in prop::option::weighted(0.3, held(vec!["case"], vec![Stored::Text, Stored::Long], vec!["0", "1", "7", "r3", "mean"])),
        is_label_first: bool,
    ) {
        let t = Held { name: "t", stored: Stored::Double, cells: vec!["0.5".to_owned(); 8] };
        let mut numbers: Vec<Held> = Vec::new();
        let mut run = run.map(|(mut run, is_in_order, start)| {
            if is_in_order {
                run.cells = (start..start + 8).map(|run| run.to_string()).collect();
            }
            run
        });
        if let (Some(run), Some((row, odd))) = (&mut run, odd) {
            run.cells[row] = odd.to_owned();
        }
        if let Some((mut vehicle, flight)) = fleet {
            let flight = flight.map(|mut flight| {
                if let (true, Some(run)) = (is_fleet, &run) {
                    let place = |cell: &String| cell.parse().map_or((0, 0), |run| Fleet::new(9, 2).place(run));
                    vehicle.cells = run.cells.iter().map(|cell| place(cell).0.to_string()).collect();
                    flight.cells = run.cells.iter().map(|cell| place(cell).1.to_string()).collect();
                }
                flight
            });
            numbers.extend([vehicle].into_iter().chain(flight));
        }
        let mut labels: Vec<Held> = labels.into_iter().zip(["label", "note"]).map(|((mut label, summary), name)| {
            label.name = name;
            if let Some((row, word)) = summary {
                label.cells[row] = word.to_owned();
            }
            label
        }).collect();
        let behind = if is_label_first { Vec::new() } else { std::mem::take(&mut labels) };
        let others: Vec<Held> = labels
            .into_iter()
            .chain([t])
            .chain(run)
            .chain(model)
            .chain(numbers)
            .chain(status)
            .chain([x])
            .chain(behind)
            .collect();
        // Pandas writes the index before all other columns in CSV, and behind them in Parquet.
        let in_csv: Vec<&Held> = case.iter().chain(&others).collect();
        let in_parquet: Vec<&Held> = others.iter().chain(&case).collect();

        let scratch = tempfile::tempdir().unwrap();
        let path = |name: &str| scratch.path().join(name);
        let (rows, first) = ((0..rows).collect::<Vec<_>>(), first.min(rows));
        let (one, other) = rows.split_at(first);
        let mut told: Vec<(String, Said)> = Vec::new();
        for (at, parts) in [[one, other], [other, one]].into_iter().enumerate() {
            let rows = parts.concat();
            let text = csv(&in_csv, &rows);
            fs::write(path("it.csv"), &text).unwrap();
            let of_csv = said(&path("it.csv"));
            parquet(&path("it.parquet"), &in_parquet, &rows);
            let folder = path(&format!("folder{at}"));
            fs::create_dir(&folder).unwrap();
            for (file, rows) in parts.into_iter().enumerate() {
                parquet(&folder.join(format!("{file}.parquet")), &in_parquet, rows);
            }
            let stored: Vec<_> = in_parquet.iter().map(|column| column.stored(&rows)).collect();
            let mut all = String::new();
            writeln!(all, "{text}{stored:?}").unwrap();
            prop_assert_eq!(&said(&path("it.parquet")), &of_csv, "one file, {}", all);
            prop_assert_eq!(&said(&folder), &of_csv, "two files, {}", all);
            told.push((all, of_csv));
        }
        let of_order = |(_, said): &(String, Said)| said.as_ref().map(|(_, counts)| *counts).map_err(|why| *why);
        // A text among whole numbers is the name of a run in the first row, and in no other.
        let is_named = |(_, said): &(String, Said)| *said == Err(AMONG_WHOLES[0]);
        if !told.iter().any(is_named) {
            prop_assert_eq!(of_order(&told[0]), of_order(&told[1]), "{}", told[0].0);
        }
    }
}
