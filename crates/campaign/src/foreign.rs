//! Tables of numbers that other programs wrote, a row for each run: Parquet, a folder of Parquet files, or CSV.

use parquet::{
    basic::{Compression, LogicalType, Type as Physical},
    column::reader::ColumnReader,
    data_type::ByteArray,
    errors::ParquetError,
    file::reader::{FileReader, SerializedFileReader},
};
use std::{
    fs::{self, File},
    io::{self, Read},
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::{
    blank_lines::BlankLines,
    column::Column,
    failure::OK,
    origin::Origin,
    requirement::Counting,
    stored::{read, said},
};

/// Rows of a CSV file that are looked at together.
const TOGETHER: usize = 1 << 14;
/// Bytes of a table that is held in memory, at most.
const MOST_HELD: u64 = 1 << 30;
/// What a Parquet file begins with.
const PARQUET: &[u8] = b"PAR1";
/// What stands in a cell that has no number, in small letters.
const MISSING: [&str; 7] = ["", "nan", "na", "n/a", "null", "none", "-"];

/// A table of numbers that another program wrote, a row for each run. It is read piece by piece, as often as it is scanned.
#[derive(Clone, Debug)]
pub struct ForeignTable {
    path: PathBuf,
    files: Vec<PathBuf>,
    form: Form,
    columns: Vec<String>,
    /// What the folder of the campaign that wrote it says of it, if it is in one.
    origin: Option<Origin>,
    counting: Counting,
}

#[derive(Clone, Debug)]
enum Form {
    Parquet,
    Csv {
        /// What stands between the cells.
        separator: u8,
        text: CsvText,
    },
}

/// Where the text of a CSV table is.
#[derive(Clone, Debug)]
enum CsvText {
    InFile,
    /// In memory, for it could be read from its source once only.
    Held(Arc<Vec<u8>>),
}

/// The numbers of some consecutive rows: of each column, one for each row, none where a cell is empty.
pub type Columns = [Vec<Option<f64>>];

impl ForeignTable {
    /// Opens a file, or a folder of Parquet files, which are taken in the order of their names. What begins as Parquet does is
    /// Parquet; all else is CSV, whose first line has the names of the columns, with `,`, `;` or a tab between them.
    ///
    /// # Errors
    /// There is no such file, it is no regular file, or its head cannot be read.
    pub fn open(path: &Path) -> Result<Self, ForeignError> {
        let failed = |problem: String| ForeignError { path: path.to_owned(), problem };
        let unread = |error: io::Error| failed(error.to_string());
        let found = fs::metadata(path).map_err(unread)?;
        let origin = || Origin::of(path).map_err(unread);
        if found.is_dir() {
            let mut files = Vec::new();
            for entry in fs::read_dir(path).map_err(unread)? {
                let file = entry.map_err(unread)?.path();
                if file.is_file() && file.extension().is_some_and(|end| end == "parquet") {
                    files.push(file);
                }
            }
            files.sort();
            let first =
                files.first().ok_or_else(|| failed("it has no .parquet file; the run tables of a study are in runs/ below its folder, a folder for each model".to_owned()))?;
            let columns = parquet_columns(first)?;
            return Ok(Self::new(path, files, (Form::Parquet, columns), origin()?));
        }
        if !found.is_file() {
            // A pipe has an end only once, and is scanned more often.
            return Err(failed("it is not a regular file".to_owned()));
        }
        let files = vec![path.to_owned()];
        let mut start = [0; PARQUET.len()];
        let is_parquet = File::open(path).map_err(unread)?.read_exact(&mut start);
        if is_parquet.is_ok() && start == PARQUET {
            let columns = parquet_columns(path)?;
            return Ok(Self::new(path, files, (Form::Parquet, columns), origin()?));
        }
        if path.extension().is_some_and(|end| end == "parquet" || end == "pq") {
            return Err(failed("it does not begin as a Parquet file does".to_owned()));
        }
        let text = CsvText::InFile;
        let (separator, columns) = csv_columns(path, &text)?;
        Ok(Self::new(path, files, (Form::Csv { separator, text }, columns), None))
    }

    /// Reads a CSV table that a source hands out once, such as standard input, and holds it in memory: up to 1 GiB. `name` is what it is
    /// called in messages.
    ///
    /// # Errors
    /// The source cannot be read, hands out more, or a Parquet file, or its first line cannot be read.
    pub fn read_csv(name: &Path, source: impl Read) -> Result<Self, ForeignError> {
        let failed = |problem: String| ForeignError { path: name.to_owned(), problem };
        let mut bytes = Vec::new();
        let read = source.take(MOST_HELD + 1).read_to_end(&mut bytes);
        read.map_err(|error| failed(error.to_string()))?;
        if bytes.len() as u64 > MOST_HELD {
            let problem = "it has more than 1 GiB, which is the most that is held in memory: write the table to a file, and name the file";
            return Err(failed(problem.to_owned()));
        }
        if bytes.starts_with(PARQUET) {
            let problem = "it is a Parquet file, and a table without a name must be CSV: write it to a file, and name the file";
            return Err(failed(problem.to_owned()));
        }
        let text = CsvText::Held(Arc::new(bytes));
        let (separator, columns) = csv_columns(name, &text)?;
        let files = vec![name.to_owned()];
        Ok(Self::new(name, files, (Form::Csv { separator, text }, columns), None))
    }

    fn new(
        path: &Path,
        files: Vec<PathBuf>,
        (form, columns): (Form, Vec<String>),
        origin: Option<Origin>,
    ) -> Self {
        let counting = origin.as_ref().map(|origin| origin.counting).unwrap_or_default();
        Self { path: path.to_owned(), files, form, columns, origin, counting }
    }

    /// Why nothing can be said of a table without rows.
    pub(crate) fn without_rows(&self) -> ForeignError {
        let problem = "it has no rows: a row must be a run".to_owned();
        ForeignError { path: self.path.clone(), problem }
    }

    /// How verdicts count its runs, as the folder of the campaign says that it is in; as independent runs that are looked at once, if it is in
    /// none and nothing else was said.
    #[must_use]
    pub fn counting(&self) -> Counting {
        self.counting
    }

    /// The same table, whose runs are counted so.
    #[must_use]
    pub fn counted(self, counting: Counting) -> Self {
        Self { counting, ..self }
    }

    /// Whether it is a run table of a campaign, which begins with `model`, `run` and `status`.
    #[must_use]
    pub fn is_run_table(&self) -> bool {
        status(&self.columns).is_some()
    }

    /// The file of the campaign's folder that it is in that says how verdicts count its runs, if it is in one.
    #[must_use]
    pub fn campaign(&self) -> Option<&Path> {
        self.origin.as_ref().map(|origin| origin.manifest.as_path())
    }

    /// Why a row of which nobody knows which run it is cannot be counted.
    pub(crate) fn without_run(&self) -> ForeignError {
        let problem = "runs have something in common here, so that the column \"run\" must say which run each row is, with whole numbers from 0";
        ForeignError { path: self.path.clone(), problem: problem.to_owned() }
    }

    /// The names of its columns.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Looks at the numbers in some columns, all rows in their order, some at a time. Flags are 1 and 0. In a run table of a study, which
    /// begins with `model`, `run` and `status`, runs that failed have no numbers, not even those that were drawn.
    ///
    /// # Errors
    /// It has no such column, a cell in it is no number, or a file cannot be read.
    pub fn scan(&self, columns: &[String], look: impl FnMut(&Columns)) -> Result<(), ForeignError> {
        self.scan_beside(columns, &[], look)
    }

    /// The same, and behind them some columns as they are written, also of runs that failed.
    ///
    /// # Errors
    /// As [`scan`](Self::scan).
    pub fn scan_beside(
        &self,
        measured: &[String],
        written: &[String],
        mut look: impl FnMut(&Columns),
    ) -> Result<(), ForeignError> {
        let columns = (measured, written);
        for file in &self.files {
            match &self.form {
                Form::Parquet => scan_parquet(file, columns, &mut look)?,
                Form::Csv { separator, text } => {
                    let form = (*separator, self.columns.len());
                    scan_csv(file, text, form, columns, &mut look)?;
                }
            }
        }
        Ok(())
    }
}

/// Where columns are among those that there are.
fn places<'a>(
    path: &Path,
    there: &[String],
    columns: impl Iterator<Item = &'a String>,
) -> Result<Vec<usize>, ForeignError> {
    let place = |name: &String| {
        let mut found = there.iter().enumerate().filter(|(_, other)| *other == name);
        match (found.next(), found.next()) {
            (Some((place, _)), None) => Ok(place),
            (Some(_), Some(_)) => Err(format!("two columns are called {name:?}")),
            (None, _) => {
                Err(format!("it has no column {name:?}; its columns are {}", there.join(", ")))
            }
        }
    };
    let places = columns.map(place).collect::<Result<_, String>>();
    places.map_err(|problem| ForeignError { path: path.to_owned(), problem })
}

fn parquet_columns(path: &Path) -> Result<Vec<String>, ForeignError> {
    open(path).map(|reader| names(&reader)).map_err(|error| unread(path, &error))
}

fn names(reader: &SerializedFileReader<File>) -> Vec<String> {
    let schema = reader.metadata().file_metadata().schema_descr();
    schema.columns().iter().map(|column| column.path().string()).collect()
}

fn open(path: &Path) -> Result<SerializedFileReader<File>, ParquetError> {
    SerializedFileReader::new(File::open(path)?)
}

fn unread(path: &Path, error: &ParquetError) -> ForeignError {
    ForeignError { path: path.to_owned(), problem: said(error) }
}

fn scan_parquet(
    path: &Path,
    (measured, written): (&[String], &[String]),
    look: &mut impl FnMut(&Columns),
) -> Result<(), ForeignError> {
    let failed = |error: ParquetError| unread(path, &error);
    let reader = open(path).map_err(failed)?;
    let there = names(&reader);
    let places = places(path, &there, measured.iter().chain(written))?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    for place in &places {
        let column = schema.column(*place);
        let wrong = |problem: &str| ForeignError {
            path: path.to_owned(),
            problem: format!("the column {:?} {problem}", column.path().string()),
        };
        if column.max_rep_level() > 0 {
            return Err(wrong("is of lists, and must be of numbers"));
        }
        match column.physical_type() {
            Physical::BOOLEAN
            | Physical::INT32
            | Physical::INT64
            | Physical::FLOAT
            | Physical::DOUBLE
                if column.logical_type_ref().is_none_or(is_plain) => {}
            Physical::BOOLEAN
            | Physical::INT32
            | Physical::INT64
            | Physical::INT96
            | Physical::FLOAT
            | Physical::DOUBLE
            | Physical::BYTE_ARRAY
            | Physical::FIXED_LEN_BYTE_ARRAY => {
                return Err(wrong("is of texts, dates or decimals, and must be of numbers"));
            }
        }
    }
    let status = status(&there);
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(failed)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        for place in places.iter().chain(&status) {
            if let Some(codec) = unread_codec(group.metadata().column(*place).compression()) {
                let problem = format!(
                    "the column {:?} is compressed with {codec}, which is not read: write the table with snappy, gzip, lz4 or no \
                     compression, in polars by df.write_parquet(path, compression=\"snappy\")",
                    there[*place]
                );
                return Err(ForeignError { path: path.to_owned(), problem });
            }
        }
        let column = |place: &usize| {
            let unsigned = schema.column(*place).logical_type_ref().is_some_and(is_unsigned);
            numbers(group.get_column_reader(*place)?, rows, unsigned)
        };
        let numbers = places.iter().map(column).collect::<Result<Vec<_>, ParquetError>>();
        let mut numbers = numbers.map_err(failed)?;
        if let Some(place) = status
            && let ColumnReader::ByteArrayColumnReader(texts) =
                group.get_column_reader(place).map_err(failed)?
        {
            let is_ok = |text: &Option<ByteArray>| {
                text.as_ref().is_some_and(|text| text.data() == OK.as_bytes())
            };
            let texts = read(texts, rows).map_err(failed)?;
            for (row, _) in texts.iter().enumerate().filter(|(_, text)| !is_ok(text)) {
                numbers[..measured.len()].iter_mut().for_each(|numbers| numbers[row] = None);
            }
        }
        look(&numbers);
    }
    Ok(())
}

/// Where the status of a run is, in the run table of a study.
fn status(columns: &[String]) -> Option<usize> {
    let own = Column::first();
    let is_own = columns.len() >= own.len() && own.iter().zip(columns).all(|(a, b)| a.name() == b);
    is_own.then_some(own.len() - 1)
}

/// How a column is compressed, if that is not read: what these need is in C, or large.
fn unread_codec(compression: Compression) -> Option<&'static str> {
    match compression {
        Compression::UNCOMPRESSED
        | Compression::SNAPPY
        | Compression::GZIP(_)
        | Compression::LZ4
        | Compression::LZ4_RAW => None,
        Compression::LZO => Some("LZO"),
        Compression::BROTLI(_) => Some("Brotli"),
        Compression::ZSTD(_) => Some("zstd"),
    }
}

/// Whether a number means what it is.
fn is_plain(logical: &LogicalType) -> bool {
    matches!(logical, LogicalType::Integer(_))
}

/// Whether the highest bit of a whole number is no sign.
fn is_unsigned(logical: &LogicalType) -> bool {
    matches!(logical, LogicalType::Integer(whole) if !whole.is_signed)
}

fn numbers(
    reader: ColumnReader,
    rows: usize,
    unsigned: bool,
) -> Result<Vec<Option<f64>>, ParquetError> {
    macro_rules! all {
        ($reader:expr, $number:expr) => {
            read($reader, rows)?.into_iter().map(|cell| cell.map($number)).collect()
        };
    }
    Ok(match reader {
        ColumnReader::BoolColumnReader(r) => all!(r, |flag| f64::from(u8::from(flag))),
        ColumnReader::Int32ColumnReader(r) if unsigned => {
            all!(r, |whole| f64::from(whole.cast_unsigned()))
        }
        ColumnReader::Int64ColumnReader(r) if unsigned => {
            all!(r, |whole| whole.cast_unsigned() as f64)
        }
        ColumnReader::Int32ColumnReader(r) => all!(r, f64::from),
        ColumnReader::Int64ColumnReader(r) => all!(r, |whole| whole as f64),
        ColumnReader::FloatColumnReader(r) => all!(r, f64::from),
        ColumnReader::DoubleColumnReader(r) => all!(r, |number| number),
        ColumnReader::Int96ColumnReader(_)
        | ColumnReader::ByteArrayColumnReader(_)
        | ColumnReader::FixedLenByteArrayColumnReader(_) => {
            return Err(ParquetError::General("a column of no numbers".to_owned()));
        }
    })
}

fn csv_columns(path: &Path, text: &CsvText) -> Result<(u8, Vec<String>), ForeignError> {
    let head = |separator: u8| {
        let names =
            reader(path, text, (separator, 0))?.headers().map_err(|e| broken(path, &e))?.clone();
        Ok::<_, ForeignError>(names.iter().map(str::to_owned).collect::<Vec<_>>())
    };
    let mut best = (b',', head(b',')?);
    for separator in [b';', b'\t'] {
        let names = head(separator)?;
        if names.len() > best.1.len() {
            best = (separator, names);
        }
    }
    if best.1.iter().all(String::is_empty) {
        let problem = "it is empty: the first line must have the names of the columns".to_owned();
        return Err(ForeignError { path: path.to_owned(), problem });
    }
    Ok(best)
}

/// What reads a table with this separator and so many columns.
fn reader<'a>(
    path: &Path,
    text: &'a CsvText,
    (separator, columns): (u8, usize),
) -> Result<csv::Reader<Box<dyn Read + 'a>>, ForeignError> {
    let text: Box<dyn Read + 'a> = match text {
        CsvText::InFile => Box::new(File::open(path).map_err(|error| broken(path, &error.into()))?),
        CsvText::Held(bytes) => Box::new(bytes.as_slice()),
    };
    // A blank line is skipped, and of one column it is an empty cell.
    let text: Box<dyn Read + 'a> =
        if columns == 1 { Box::new(BlankLines::new(text)) } else { text };
    // A comment that nothing ends would be a row.
    let text: Box<dyn Read + 'a> = Box::new(text.chain(&b"\n"[..]));
    let mut builder = csv::ReaderBuilder::new();
    builder.delimiter(separator).comment(Some(b'#')).trim(csv::Trim::All);
    Ok(builder.from_reader(text))
}

fn broken(path: &Path, error: &csv::Error) -> ForeignError {
    ForeignError { path: path.to_owned(), problem: error.to_string() }
}

fn scan_csv(
    path: &Path,
    text: &CsvText,
    form: (u8, usize),
    (measured, written): (&[String], &[String]),
    look: &mut impl FnMut(&Columns),
) -> Result<(), ForeignError> {
    let mut reader = reader(path, text, form)?;
    let names = reader.headers().map_err(|error| broken(path, &error))?;
    let there: Vec<String> = names.iter().map(str::to_owned).collect();
    let places = places(path, &there, measured.iter().chain(written))?;
    let status = status(&there);
    let mut some: Vec<Vec<Option<f64>>> = vec![Vec::new(); places.len()];
    let mut row = csv::StringRecord::new();
    while reader.read_record(&mut row).map_err(|error| broken(path, &error))? {
        let ended = status.is_none_or(|place| row.get(place) == Some(OK));
        for (column, (place, numbers)) in places.iter().zip(&mut some).enumerate() {
            let cell = row.get(*place).unwrap_or_default();
            let number = number(cell).ok_or_else(|| {
                let line = row.position().map_or(0, csv::Position::line);
                let problem =
                    format!("line {line}, column {:?}: {cell:?} is not a number", there[*place]);
                ForeignError { path: path.to_owned(), problem }
            })?;
            numbers.push(number.filter(|_| ended || column >= measured.len()));
        }
        if some.first().is_some_and(|numbers| numbers.len() == TOGETHER) {
            look(&some);
            some.iter_mut().for_each(Vec::clear);
        }
    }
    if some.first().is_some_and(|numbers| !numbers.is_empty()) {
        look(&some);
    }
    Ok(())
}

/// What stands in a cell: a number, or nothing; none if it is something else.
fn number(cell: &str) -> Option<Option<f64>> {
    if let Ok(number) = cell.parse::<f64>() {
        return Some(Some(number).filter(|x| !x.is_nan()));
    }
    let small = cell.to_ascii_lowercase();
    match small.as_str() {
        "true" => Some(Some(1.0)),
        "false" => Some(Some(0.0)),
        other => MISSING.contains(&other).then_some(None),
    }
}

/// Why a table cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct ForeignError {
    path: PathBuf,
    problem: String,
}
