//! Run tables in Parquet: written, read back whole, and one row of them.

use parquet::{
    basic::{Compression, LogicalType, Repetition, Type as Physical},
    column::reader::{ColumnReader, ColumnReaderImpl},
    data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type},
    errors::ParquetError,
    file::{
        properties::{EnabledStatistics, WriterProperties},
        reader::{FileReader, SerializedFileReader},
        writer::{SerializedFileWriter, SerializedRowGroupWriter},
    },
    schema::types::{ColumnPath, Type},
};
use std::{collections::BTreeMap, fs::File, io::Write, path::Path, sync::Arc};

use crate::{
    cell::Cell,
    column::{Column, Kind},
    failure::{Failure, OK},
    kept::Kept,
    runs_error::RunsError,
    table::{Source, Table, Values},
};

impl Table {
    /// Writes the table as Parquet. Numbers are stored as they are, bit for bit.
    ///
    /// # Errors
    /// Writing fails.
    pub fn write_parquet(&self, output: impl Write + Send) -> Result<(), ParquetError> {
        let mut writer = ParquetWriter::new(self, output)?;
        writer.write(self)?;
        writer.finish()
    }

    /// What is kept of the table, as the content of a Parquet file; none if no row is.
    pub(crate) fn kept_parquet(&self, kept: &Kept) -> Result<Option<Vec<u8>>, ParquetError> {
        let (columns, places) = (kept.columns_of(self), kept.places_of(self));
        if places.is_empty() {
            return Ok(None);
        }
        let mut content = Vec::new();
        let mut writer =
            ParquetWriter::of(columns.iter().map(|(column, _)| *column), &mut content)?;
        writer.write_places(self, &columns, &places)?;
        writer.finish()?;
        Ok(Some(content))
    }

    fn write_column<W: Write + Send>(
        &self,
        group: &mut SerializedRowGroupWriter<'_, W>,
        (column, source): (&Column, Source),
        places: &[usize],
    ) -> Result<(), ParquetError> {
        let each = || places.iter().copied();
        let texts = |text: &dyn Fn(usize) -> Option<ByteArray>| each().map(text).collect();
        let of_failures = |text: fn(&Failure) -> &str| {
            texts(&|place| Some(self.failures.get(&place).map_or(OK, text).into()))
        };
        match source {
            Source::Model => {
                let model = ByteArray::from(self.model());
                write::<ByteArrayType, _>(group, column, texts(&|_| Some(model.clone())))
            }
            Source::Run => {
                // There are fewer runs than 2⁶³.
                let runs = each().map(|place| Some((self.first() + place as u64) as i64));
                write::<Int64Type, _>(group, column, runs.collect())
            }
            Source::Status => {
                write::<ByteArrayType, _>(group, column, of_failures(Failure::message))
            }
            Source::StatusKind => {
                write::<ByteArrayType, _>(group, column, of_failures(Failure::kind))
            }
            Source::Kind(place) => {
                let Values::Texts(kinds) = &self.values[place] else { return Ok(()) };
                let kinds = texts(&|run| Some(kinds.get(run)?.1.into()));
                write::<ByteArrayType, _>(group, column, kinds)
            }
            Source::Value(place) => match &self.values[place] {
                Values::Numbers(numbers) => match numbers.all() {
                    Some(values) if places.len() == self.len() => {
                        write_all::<DoubleType, _>(group, column, values)
                    }
                    Some(_) | None => {
                        let values = each().map(|place| numbers.get(place)).collect();
                        write::<DoubleType, _>(group, column, values)
                    }
                },
                Values::Integers(integers) => {
                    let values = each().map(|place| integers.get(place).copied().flatten());
                    write::<Int64Type, _>(group, column, values.collect())
                }
                Values::Texts(values) => {
                    let values = texts(&|run| Some(values.get(run)?.0.into()));
                    write::<ByteArrayType, _>(group, column, values)
                }
                Values::Flags(flags) => {
                    let values = each().map(|place| flags.get(place).copied().flatten());
                    write::<BoolType, _>(group, column, values.collect())
                }
            },
        }
    }

    /// Reads a table that was written, of the same model and columns as this one.
    ///
    /// # Errors
    /// The file cannot be read, or is not of these columns; the error names it.
    pub fn read_parquet(&self, path: &Path) -> Result<Self, RunsError> {
        self.read_block(path).map_err(|problem| RunsError::of(path, problem))
    }

    /// The same, where another error names the file.
    pub(crate) fn read_block(&self, path: &Path) -> Result<Self, ParquetError> {
        let reader = open(path)?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let places: BTreeMap<&str, usize> =
            schema.columns().iter().enumerate().map(|(i, column)| (column.name(), i)).collect();
        let wrong = |problem: String| ParquetError::General(problem);
        let mut texts: BTreeMap<&str, Vec<Option<ByteArray>>> = BTreeMap::new();
        let mut runs = Vec::new();
        let mut whole = self.from_run(0);
        for group in 0..reader.num_row_groups() {
            let group = reader.get_row_group(group)?;
            let rows = usize::try_from(group.metadata().num_rows())
                .map_err(|_| wrong("a row group of no size".to_owned()))?;
            for (column, source) in self.sources() {
                let name = column.name();
                let place = places.get(name).ok_or_else(|| wrong(format!("no column {name:?}")))?;
                let other = || wrong(format!("column {name:?} is of another type"));
                match (group.get_column_reader(*place)?, source) {
                    (ColumnReader::Int64ColumnReader(reader), Source::Run) => {
                        runs.extend(read(reader, rows)?.into_iter().flatten());
                    }
                    (ColumnReader::ByteArrayColumnReader(reader), _)
                        if column.kind() == Kind::Text =>
                    {
                        texts.entry(name).or_default().extend(read(reader, rows)?);
                    }
                    (reader, Source::Value(place)) => match (reader, &mut whole.values[place]) {
                        (ColumnReader::DoubleColumnReader(reader), Values::Numbers(numbers)) => {
                            read(reader, rows)?.into_iter().for_each(|x| numbers.push(x));
                        }
                        (ColumnReader::Int64ColumnReader(reader), Values::Integers(integers)) => {
                            integers.extend(read(reader, rows)?);
                        }
                        (ColumnReader::BoolColumnReader(reader), Values::Flags(flags)) => {
                            flags.extend(read(reader, rows)?);
                        }
                        _ => return Err(other()),
                    },
                    _ => return Err(other()),
                }
            }
        }
        let first = runs.first().copied().unwrap_or_default();
        let in_order = runs.iter().zip(first..).all(|(run, expected)| *run == expected);
        let first = u64::try_from(first).ok().filter(|_| in_order);
        let first = first.ok_or_else(|| wrong("its runs are not in order".to_owned()))?;
        let text = |name: &str, run: usize| -> Option<String> {
            let bytes = texts.get(name)?.get(run)?.as_ref()?;
            Some(String::from_utf8_lossy(bytes.data()).into_owned())
        };
        if (0..runs.len()).any(|run| text("model", run).as_deref() != Some(self.model())) {
            return Err(wrong(format!("it is not of the model {:?}", self.model())));
        }
        let [_, _, status] = Column::first();
        for run in 0..runs.len() {
            let kind = text(Column::status_kind().name(), run).unwrap_or_default();
            if kind != OK {
                let message = text(status.name(), run).unwrap_or_default();
                whole.failures.insert(run, Failure::new(kind, message));
            }
        }
        for (place, column) in self.of_simulation().iter().enumerate() {
            if let Values::Texts(values) = &mut whole.values[place] {
                let kinds = column.has_kinds().then(|| column.kinds().name().to_owned());
                for run in 0..runs.len() {
                    let value = text(column.name(), run);
                    let kind = kinds.as_ref().and_then(|name| text(name, run));
                    values
                        .push(value.as_deref().map(|text| (text, kind.as_deref().unwrap_or(text))));
                }
            }
        }
        whole.begin(first, runs.len());
        Ok(whole)
    }
}

/// Writes tables of the same columns as Parquet, each as a row group.
pub(crate) struct ParquetWriter<W: Write + Send> {
    writer: SerializedFileWriter<W>,
}

impl<W: Write + Send> ParquetWriter<W> {
    /// A writer of tables with the columns of this one, whose runs are not written.
    pub(crate) fn new(table: &Table, output: W) -> Result<Self, ParquetError> {
        Self::of(table.columns(), output)
    }

    fn of<'c>(
        columns: impl IntoIterator<Item = &'c Column>,
        output: W,
    ) -> Result<Self, ParquetError> {
        let columns: Vec<&Column> = columns.into_iter().collect();
        let fields = columns.iter().map(|column| Ok(Arc::new(field(column)?)));
        let fields = fields.collect::<Result<_, ParquetError>>()?;
        let schema = Type::group_type_builder("run").with_fields(fields).build()?;
        // Numbers that were drawn are all different: no dictionary serves them, and compression saves less than a fifth (docs/run-table.md).
        let mut properties = WriterProperties::builder()
            .set_compression(Compression::UNCOMPRESSED)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_dictionary_enabled(false);
        for column in columns.iter().filter(|column| column.kind() == Kind::Text) {
            let path = ColumnPath::from(column.name());
            properties = properties.set_column_dictionary_enabled(path, true);
        }
        let properties = Arc::new(properties.build());
        let writer = SerializedFileWriter::new(output, Arc::new(schema), properties)?;
        Ok(Self { writer })
    }

    /// Writes the runs of a table.
    pub(crate) fn write(&mut self, table: &Table) -> Result<(), ParquetError> {
        let columns: Vec<_> = table.sources().collect();
        self.write_places(table, &columns, &(0..table.len()).collect::<Vec<_>>())
    }

    /// Writes the runs in some places of a table, in some of its columns.
    fn write_places(
        &mut self,
        table: &Table,
        columns: &[(&Column, Source)],
        places: &[usize],
    ) -> Result<(), ParquetError> {
        if !places.is_empty() {
            let mut group = self.writer.next_row_group()?;
            for column in columns {
                table.write_column(&mut group, *column, places)?;
            }
            group.close()?;
        }
        Ok(())
    }

    /// Writes what stands after the last run.
    pub(crate) fn finish(self) -> Result<(), ParquetError> {
        self.writer.close()?;
        Ok(())
    }
}

/// The column in Parquet.
fn field(column: &Column) -> Result<Type, ParquetError> {
    let (physical, logical) = match column.kind() {
        Kind::Integer => (Physical::INT64, None),
        Kind::Number => (Physical::DOUBLE, None),
        Kind::Flag => (Physical::BOOLEAN, None),
        Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
    };
    let repetition = if column.is_optional() { Repetition::OPTIONAL } else { Repetition::REQUIRED };
    Type::primitive_type_builder(column.name(), physical)
        .with_repetition(repetition)
        .with_logical_type(logical)
        .build()
}

fn write<T: DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    column: &Column,
    values: Vec<Option<T::T>>,
) -> Result<(), ParquetError> {
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let values: Vec<T::T> = values.into_iter().flatten().collect();
    write_levels::<T, W>(group, column, &values, &levels)
}

/// Values that every run has.
fn write_all<T: DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    column: &Column,
    values: &[T::T],
) -> Result<(), ParquetError> {
    write_levels::<T, W>(group, column, values, &vec![1; values.len()])
}

fn write_levels<T: DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    column: &Column,
    values: &[T::T],
    levels: &[i16],
) -> Result<(), ParquetError> {
    if let Some(mut writer) = group.next_column()? {
        let levels = column.is_optional().then_some(levels);
        writer.typed::<T>().write_batch(values, levels, None)?;
        writer.close()?;
    }
    Ok(())
}

pub(crate) fn open(path: &Path) -> Result<SerializedFileReader<File>, ParquetError> {
    SerializedFileReader::new(File::open(path).map_err(|e| ParquetError::External(e.into()))?)
}

/// All values of a column of so many rows.
pub(crate) fn read<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
) -> Result<Vec<Option<T::T>>, ParquetError> {
    let (mut levels, mut values) = (Vec::with_capacity(rows), Vec::with_capacity(rows));
    let mut read = 0;
    while read < rows {
        let (more, ..) = reader.read_records(rows - read, Some(&mut levels), None, &mut values)?;
        if more == 0 {
            return Err(ParquetError::General("a column has fewer values than rows".to_owned()));
        }
        read += more;
    }
    // Of a column that every run has something in, there are no levels.
    if levels.is_empty() {
        return Ok(values.into_iter().map(Some).collect());
    }
    // A value stands at the deepest level, which is beyond 1 in groups that may be missing themselves. Without any value, no level is it.
    let deepest = levels.iter().copied().max();
    let mut values = values.into_iter();
    let value = |level| if Some(level) == deepest { values.next() } else { None };
    Ok(levels.into_iter().map(value).collect())
}

/// The cells of a run of a model in a table that was written, by the names of their columns; none if the table does not have
/// the run.
///
/// # Errors
/// The table cannot be read, or is not of this kind; the error names it.
pub fn read_run(
    path: &Path,
    run: (&str, u64),
) -> Result<Option<Vec<(String, Cell<'static>)>>, RunsError> {
    let (model, run) = run;
    let found = found_run(path, |row| row.model == model && row.run == run);
    Ok(found.map_err(|problem| RunsError::of(path, problem))?.map(|(_, cells)| cells))
}

/// The number and the cells of the first run of a model in a table that was written that did not fail, or that may have.
///
/// # Errors
/// As [`read_run`].
pub(crate) fn first_run(
    path: &Path,
    model: &str,
    may_fail: bool,
) -> Result<Option<FoundRun>, RunsError> {
    let found = found_run(path, |row| row.model == model && (may_fail || row.status_kind == OK));
    found.map_err(|problem| RunsError::of(path, problem))
}

/// What says which run a row is, and how it ended.
struct Said<'a> {
    model: &'a str,
    run: u64,
    status_kind: &'a str,
}

/// The number of a run, and its cells by the names of their columns.
type FoundRun = (u64, Vec<(String, Cell<'static>)>);

fn found_run(
    path: &Path,
    is_it: impl Fn(Said<'_>) -> bool,
) -> Result<Option<FoundRun>, ParquetError> {
    let reader = open(path)?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let wrong = || ParquetError::General("it is no run table".to_owned());
    let place = |own: &Column| schema.columns().iter().position(|c| c.name() == own.name());
    let [model, run, _] = Column::first();
    let [Some(models), Some(runs), Some(kinds)] = [&model, &run, &Column::status_kind()].map(place)
    else {
        return Err(wrong());
    };
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group)?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        let texts = |place: usize| match group.get_column_reader(place)? {
            ColumnReader::ByteArrayColumnReader(texts) => read(texts, rows),
            _ => Err(wrong()),
        };
        let ColumnReader::Int64ColumnReader(runs) = group.get_column_reader(runs)? else {
            return Err(wrong());
        };
        let said = texts(models)?.into_iter().zip(texts(kinds)?).zip(read(runs, rows)?);
        let found = said.enumerate().find_map(|(place, ((model, kind), run))| {
            let (model, kind, run) = (model?, kind?, u64::try_from(run?).ok()?);
            let text = |text| std::str::from_utf8(text).ok();
            let row = Said { model: text(model.data())?, run, status_kind: text(kind.data())? };
            is_it(row).then_some((place, run))
        });
        let Some((place, run)) = found else { continue };
        let cell = |i: usize| {
            let name = schema.column(i).name().to_owned();
            Ok((name, cell(group.get_column_reader(i)?, place)?))
        };
        let cells = (0..schema.num_columns()).map(cell).collect::<Result<_, ParquetError>>()?;
        return Ok(Some((run, cells)));
    }
    Ok(None)
}

/// The cell of a column in the place given.
fn cell(reader: ColumnReader, place: usize) -> Result<Cell<'static>, ParquetError> {
    macro_rules! one {
        ($reader:expr, $cell:expr) => {{
            let mut reader = $reader;
            reader.skip_records(place)?;
            let (mut levels, mut values) = (Vec::new(), Vec::new());
            reader.read_records(1, Some(&mut levels), None, &mut values)?;
            values.pop().map_or(Cell::Null, $cell)
        }};
    }
    Ok(match reader {
        ColumnReader::BoolColumnReader(r) => one!(r, Cell::Flag),
        ColumnReader::Int64ColumnReader(r) => one!(r, Cell::Integer),
        ColumnReader::DoubleColumnReader(r) => one!(r, Cell::Number),
        ColumnReader::ByteArrayColumnReader(r) => {
            let text = |bytes: ByteArray| {
                Cell::Text(String::from_utf8_lossy(bytes.data()).into_owned().into())
            };
            one!(r, text)
        }
        _ => return Err(of_no_run_table()),
    })
}

pub(crate) fn of_no_run_table() -> ParquetError {
    ParquetError::General("a column of a type that no run table has".to_owned())
}
