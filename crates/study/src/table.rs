//! The run table: what the runs of one model leave, by columns.

use nalgebra::{Quaternion, UnitQuaternion};
use parquet::{
    basic::Compression,
    data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type},
    errors::ParquetError,
    file::{
        properties::WriterProperties,
        writer::{SerializedFileWriter, SerializedRowGroupWriter},
    },
    schema::parser::parse_message_type,
};
use std::{borrow::Cow, collections::BTreeMap, fmt, io::Write, ops::Range, sync::Arc};

use crate::{
    body::Body,
    column::{Cell, Column},
    failure::Failure,
    numbers::{Numbers, Texts},
    quantity::Quantity,
    run::{ClearanceNote, End, Run},
};

/// Rows of one row group: enough to compress well, little enough to read in part.
const ROWS_PER_GROUP: usize = 131_072;

/// The runs of one model, in run order.
#[derive(Clone, Debug)]
pub struct RunTable {
    model: String,
    /// Number of the first run.
    first: u64,
    /// Names of what else was drawn.
    drawn: Vec<String>,
    /// One of each quantity.
    quantities: Vec<(Quantity, Numbers)>,
    realizable: Vec<bool>,
    /// Components of the attitudes of the principal axes of payload and stage, scalar last.
    axes: [[Numbers; 4]; 2],
    release_orders: Texts,
    /// One of each name.
    values_drawn: Vec<Numbers>,
    /// What few runs have, by their place.
    failures: BTreeMap<usize, Failure>,
    recompressed: BTreeMap<usize, Vec<usize>>,
    clearance_notes: BTreeMap<usize, ClearanceNote>,
}

/// A run of a [`RunTable`].
#[derive(Clone, Copy)]
pub struct Row<'a> {
    table: &'a RunTable,
    place: usize,
}

impl RunTable {
    /// A table without runs, of a separation by so many springs in which that else is drawn.
    pub(crate) fn new(model: &str, first: u64, springs: usize, drawn: &[String]) -> Self {
        Self {
            model: model.to_owned(),
            first,
            drawn: drawn.to_vec(),
            quantities: Quantity::of(springs).map(|q| (q, Numbers::default())).collect(),
            realizable: Vec::new(),
            axes: Default::default(),
            release_orders: Texts::default(),
            values_drawn: vec![Numbers::default(); drawn.len()],
            failures: BTreeMap::new(),
            recompressed: BTreeMap::new(),
            clearance_notes: BTreeMap::new(),
        }
    }

    /// The next run.
    pub(crate) fn push(&mut self, run: &Run<'_>) {
        let place = self.len();
        for (quantity, numbers) in &mut self.quantities {
            numbers.push(quantity.value(run));
        }
        for (body, axes) in Body::BOTH.into_iter().zip(&mut self.axes) {
            let drawn = run.axes(body);
            for (i, numbers) in axes.iter_mut().enumerate() {
                numbers.push(drawn.map(|q| q.coords[i]));
            }
        }
        for (i, numbers) in self.values_drawn.iter_mut().enumerate() {
            numbers.push(run.case.drawn.get(i).copied());
        }
        let end = run.end();
        self.release_orders.push(end.map(End::release_order).as_deref());
        self.failures.extend(run.failure().map(|failure| (place, failure.clone())));
        let recompressed = end.map(End::recompressed).filter(|springs| !springs.is_empty());
        self.recompressed.extend(recompressed.map(|springs| (place, springs)));
        let note = end.and_then(End::clearance_note);
        self.clearance_notes.extend(note.map(|note| (place, note)));
        self.realizable.push(run.realizable());
    }

    /// The runs of another table of the same columns, that come next.
    pub(crate) fn append(&mut self, next: Self) {
        let place = self.len();
        for ((_, numbers), (_, more)) in self.quantities.iter_mut().zip(&next.quantities) {
            numbers.append(more);
        }
        for (numbers, more) in self.axes.iter_mut().flatten().zip(next.axes.iter().flatten()) {
            numbers.append(more);
        }
        for (numbers, more) in self.values_drawn.iter_mut().zip(&next.values_drawn) {
            numbers.append(more);
        }
        self.release_orders.append(&next.release_orders);
        self.failures.extend(next.failures.into_iter().map(|(i, it)| (place + i, it)));
        self.recompressed.extend(next.recompressed.into_iter().map(|(i, it)| (place + i, it)));
        let notes = next.clearance_notes.into_iter();
        self.clearance_notes.extend(notes.map(|(i, it)| (place + i, it)));
        self.realizable.extend(next.realizable);
    }

    /// Names of what else was drawn than inertias, in the order of their columns.
    #[must_use]
    pub fn drawn_columns(&self) -> &[String] {
        &self.drawn
    }

    /// The drawn values of a column of [`drawn_columns`](Self::drawn_columns), one for each run.
    #[must_use]
    pub fn drawn(&self, column: &str) -> Option<Vec<f64>> {
        let i = self.drawn.iter().position(|name| name == column)?;
        Some(self.values_drawn[i].present().collect())
    }

    /// Name of the model.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// How many runs it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.realizable.len()
    }

    /// Whether it has no runs.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.realizable.is_empty()
    }

    /// The run in a place, from 0, of [`len`](Self::len).
    #[must_use]
    pub fn row(&self, place: usize) -> Option<Row<'_>> {
        (place < self.len()).then_some(Row { table: self, place })
    }

    /// Its runs.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = Row<'_>> {
        (0..self.len()).map(|place| Row { table: self, place })
    }

    /// The runs that failed, and why.
    pub fn failures(&self) -> impl ExactSizeIterator<Item = (u64, &Failure)> {
        self.failures.iter().map(|(place, failure)| (self.first + *place as u64, failure))
    }

    /// The values of a quantity, in run order, of the runs that have one.
    #[must_use]
    pub fn values(&self, quantity: Quantity) -> Vec<f64> {
        self.numbers(quantity).into_iter().flat_map(Numbers::present).collect()
    }

    fn numbers(&self, quantity: Quantity) -> Option<&Numbers> {
        self.quantities.iter().find(|(q, _)| *q == quantity).map(|(_, numbers)| numbers)
    }

    /// Writes the table as Parquet.
    ///
    /// Columns: `model`, `run`, `status`, the first numbers of [`Quantity::ALL`] to `inertia_ratio` (null
    /// where a run has none), `realizable`, the attitudes of the principal axes as drawn, scalar last
    /// (null for entrywise models), the other numbers of [`Quantity::ALL`], releases spring by spring,
    /// `release_order` and `recompressed`, what else was drawn, and `clearance_note`. Floats are stored as
    /// they are, bit for bit.
    ///
    /// # Errors
    /// Writing fails.
    pub fn write_parquet(&self, output: impl Write + Send) -> Result<(), ParquetError> {
        let columns = self.columns();
        let fields: Vec<_> = columns.iter().map(|column| column.field()).collect();
        let schema = format!("message run {{ {}; }}", fields.join("; "));
        let schema = Arc::new(parse_message_type(&schema)?);
        let properties =
            WriterProperties::builder().set_compression(Compression::UNCOMPRESSED).build();
        let mut writer = SerializedFileWriter::new(output, schema, Arc::new(properties))?;
        for first in (0..self.len()).step_by(ROWS_PER_GROUP) {
            let places = first..(first + ROWS_PER_GROUP).min(self.len());
            let mut group = writer.next_row_group()?;
            for column in &columns {
                self.write_column(&mut group, *column, places.clone())?;
            }
            group.close()?;
        }
        writer.close()?;
        Ok(())
    }

    /// Its columns, in order.
    pub(crate) fn columns(&self) -> Vec<Column<'_>> {
        Column::of(self.quantities.iter().map(|(q, _)| *q), &self.drawn)
    }

    fn write_column<W: Write + Send>(
        &self,
        group: &mut SerializedRowGroupWriter<'_, W>,
        column: Column<'_>,
        places: Range<usize>,
    ) -> Result<(), ParquetError> {
        let numbers = |group: &mut _, of: Option<&Numbers>| {
            let values: Vec<_> = places.clone().map(|i| of.and_then(|of| of.get(i))).collect();
            write::<DoubleType, _>(group, column, values)
        };
        let texts = |group: &mut _, of: &dyn Fn(Row<'_>) -> Option<ByteArray>| {
            let rows = places.clone().map(|place| Row { table: self, place });
            write::<ByteArrayType, _>(group, column, rows.map(of).collect())
        };
        match column {
            Column::Run => {
                // There are fewer runs than 2⁶³.
                let runs = places.map(|place| Some((self.first + place as u64) as i64));
                write::<Int64Type, _>(group, column, runs.collect())
            }
            Column::Realizable => {
                let flags = self.realizable[places].iter().copied().map(Some);
                write::<BoolType, _>(group, column, flags.collect())
            }
            Column::Number(quantity) => numbers(group, self.numbers(quantity)),
            Column::Axes(body, i) => numbers(group, Some(&self.axes[body as usize][i])),
            Column::Drawn(i, _) => numbers(group, self.values_drawn.get(i)),
            Column::Model
            | Column::Status
            | Column::ReleaseOrder
            | Column::Recompressed
            | Column::ClearanceNote => texts(group, &|row| match row.cell(column) {
                Cell::Text(text) => Some(text.as_str().into()),
                Cell::Integer(_) | Cell::Number(_) | Cell::Flag(_) | Cell::Null => None,
            }),
        }
    }
}

fn write<T: parquet::data_type::DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    column: Column<'_>,
    values: Vec<Option<T::T>>,
) -> Result<(), ParquetError> {
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let values: Vec<T::T> = values.into_iter().flatten().collect();
    if let Some(mut writer) = group.next_column()? {
        let levels = column.is_optional().then_some(&levels[..]);
        writer.typed::<T>().write_batch(&values, levels, None)?;
        writer.close()?;
    }
    Ok(())
}

impl<'a> Row<'a> {
    /// The first of a table that has one.
    pub(crate) fn only(table: &'a RunTable) -> Self {
        Self { table, place: 0 }
    }

    /// Its number, from 0.
    #[must_use]
    pub fn run(&self) -> u64 {
        self.table.first + self.place as u64
    }

    /// `ok`, or why the run failed.
    #[must_use]
    pub fn status(&self) -> Cow<'static, str> {
        self.failure().map_or("ok".into(), |failure| failure.to_string().into())
    }

    /// Why the run failed, if it did.
    #[must_use]
    pub fn failure(&self) -> Option<&'a Failure> {
        self.table.failures.get(&self.place)
    }

    /// Springs from 1 in the order of their releases, `+` between those that let go together, without
    /// those that never push; none if the run failed.
    #[must_use]
    pub fn release_order(&self) -> Option<&'a str> {
        self.table.release_orders.get(self.place)
    }

    /// Springs from 1 that were pressed below their free length again after they had let go.
    #[must_use]
    pub fn recompressed(&self) -> &'a [usize] {
        self.table.recompressed.get(&self.place).map_or(&[], Vec::as_slice)
    }

    /// Why the run has no clearance, or not one of its whole coast; none if there is nothing to say.
    pub(crate) fn clearance_note(&self) -> Option<ClearanceNote> {
        self.table.clearance_notes.get(&self.place).copied()
    }

    /// Whether both drawn inertias are realizable.
    #[must_use]
    pub fn realizable(&self) -> bool {
        self.table.realizable[self.place]
    }

    /// The value of a quantity; none if the run failed or it has no meaning for this run.
    #[must_use]
    pub fn value(&self, quantity: Quantity) -> Option<f64> {
        self.table.numbers(quantity)?.get(self.place)
    }

    /// What else was drawn, in the order of [`RunTable::drawn_columns`].
    pub(crate) fn drawn(&self) -> impl Iterator<Item = Option<f64>> {
        self.table.values_drawn.iter().map(|numbers| numbers.get(self.place))
    }

    /// The attitude of the principal axes of a body, as drawn.
    pub(crate) fn axes(&self, body: Body) -> Option<UnitQuaternion<f64>> {
        let [x, y, z, w] = self.table.axes[body as usize].each_ref().map(|n| n.get(self.place));
        Some(UnitQuaternion::new_unchecked(Quaternion::new(w?, x?, y?, z?)))
    }

    /// What stands in a column.
    pub(crate) fn cell(&self, column: Column<'_>) -> Cell {
        let number = |x: Option<f64>| x.map_or(Cell::Null, Cell::Number);
        let text = |text: Option<String>| text.map_or(Cell::Null, Cell::Text);
        match column {
            Column::Model => Cell::Text(self.table.model.clone()),
            Column::Run => Cell::Integer(self.run() as i64),
            Column::Status => Cell::Text(self.status().into_owned()),
            Column::Number(quantity) => number(self.value(quantity)),
            Column::Realizable => Cell::Flag(self.realizable()),
            Column::Drawn(i, _) => number(self.drawn().nth(i).flatten()),
            Column::Axes(body, i) => number(self.table.axes[body as usize][i].get(self.place)),
            Column::ReleaseOrder => text(self.release_order().map(str::to_owned)),
            Column::Recompressed => {
                let springs: Vec<_> = self.recompressed().iter().map(ToString::to_string).collect();
                text(Some(springs.join(" ")).filter(|springs| !springs.is_empty()))
            }
            Column::ClearanceNote => text(self.clearance_note().map(|note| note.to_string())),
        }
    }
}

/// Rows are the same if all their cells are, to the bit.
impl PartialEq for Row<'_> {
    fn eq(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|row| row.table.columns());
        own.len() == others.len()
            && own
                .iter()
                .zip(&others)
                .all(|(a, b)| a.name() == b.name() && self.cell(*a) == other.cell(*b))
    }
}

impl fmt::Debug for Row<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.table.columns();
        let cells = columns.iter().map(|column| (column.name(), self.cell(*column)));
        f.debug_map().entries(cells).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_separation::RunError;
    use parquet::{
        file::reader::{FileReader, SerializedFileReader},
        record::Field,
    };

    /// Numbers that do not survive careless printing.
    const AWKWARD: [f64; 8] = [
        0.1 + 0.2,
        f64::MIN_POSITIVE / 8.0,
        1e300,
        -0.0,
        1.0 / 3.0,
        1e-17 + 1e-33,
        f64::INFINITY,
        -1e-300,
    ];

    /// A good run with awkward numbers, and a failed one.
    fn table() -> RunTable {
        let columns = ["payload_mass_kg", "spring_1_friction_n"].map(str::to_owned);
        let mut table = RunTable::new("naive", 7, 2, &columns);
        let inertia = Quantity::PAYLOAD_INERTIA;
        for ((quantity, numbers), x) in table.quantities.iter_mut().zip(AWKWARD.into_iter().cycle())
        {
            numbers.push(Some(x));
            numbers.push(inertia.contains(quantity).then_some(x));
        }
        table.quantities.last_mut().unwrap().1 = {
            let mut none = Numbers::default();
            none.push(None);
            none.push(None);
            none
        };
        for (i, numbers) in table.axes.iter_mut().flatten().enumerate() {
            let component = [0.0, 0.0, 0.0, 1.0].get(i).copied();
            numbers.push(component);
            numbers.push(component);
        }
        for (numbers, x) in table.values_drawn.iter_mut().zip([9_999.5, -0.0]) {
            numbers.push(Some(x));
            numbers.push(Some(x));
        }
        table.release_orders.push(Some("1 2"));
        table.release_orders.push(None);
        table.recompressed.insert(0, vec![2]);
        table.clearance_notes.insert(0, ClearanceNote::Partial { until: 0.1 + 0.2 });
        table.failures.insert(1, RunError::NotFinite { time: 0.1 + 0.2 }.into());
        table.realizable = vec![true, false];
        table
    }

    #[test]
    fn parquet_reads_back_bit_for_bit() {
        let table = table();
        let mut file = Vec::new();
        table.write_parquet(&mut file).unwrap();
        let reader = SerializedFileReader::new(bytes::Bytes::from(file)).unwrap();
        let columns = reader.metadata().file_metadata().schema_descr().columns();
        let names: Vec<&str> = columns.iter().map(|c| c.name()).collect();
        assert_eq!(&names[..5], ["model", "run", "status", "payload_i11", "payload_i22"]);
        assert_eq!(names[27], "realizable");
        assert_eq!(names[35], "stage_q4");
        assert_eq!(names[36], "relative_v1_m_per_s");
        assert_eq!(
            names[59..],
            [
                "stage_rotation_j",
                "clearance_m",
                "clearance_time_s",
                "recontact_s",
                "spring_1_release_s",
                "spring_2_release_s",
                "release_order",
                "recompressed",
                "payload_mass_kg",
                "spring_1_friction_n",
                "clearance_note"
            ]
        );

        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        for (row, original) in rows.iter().zip(table.rows()) {
            let field = |name: &str| {
                row.get_column_iter().find(|(n, _)| *n == name).map(|(_, f)| f.clone()).unwrap()
            };
            assert_eq!(field("model"), Field::Str("naive".to_owned()));
            assert_eq!(field("run"), Field::Long(original.run() as i64));
            assert_eq!(field("status"), Field::Str(original.status().into_owned()));
            assert_eq!(field("realizable"), Field::Bool(original.realizable()));
            for quantity in Quantity::of(2) {
                match (field(&quantity.column()), original.value(quantity)) {
                    (Field::Double(found), Some(value)) => {
                        assert_eq!(found.to_bits(), value.to_bits(), "{quantity:?}");
                    }
                    (found, value) => assert_eq!((found, value), (Field::Null, None)),
                }
            }
            assert_eq!(field("payload_q4"), Field::Double(1.0));
            assert_eq!(field("stage_q1"), Field::Null);
            let text = |text: Option<&str>| text.map_or(Field::Null, |t| Field::Str(t.to_owned()));
            let order = original.release_order();
            assert_eq!(field("release_order"), text(order));
            assert_eq!(field("recompressed"), text(order.map(|_| "2")));
            assert_eq!(field("payload_mass_kg"), Field::Double(9_999.5));
            let note = "followed to 0.30000000000000004 s only: a body turns by more than 7,000 rad in \
                        the coast";
            assert_eq!(field("clearance_note"), text(order.map(|_| note)));
        }
    }

    #[test]
    fn half_a_table_is_refused() {
        let mut file = Vec::new();
        table().write_parquet(&mut file).unwrap();
        file.truncate(file.len() / 2);
        assert!(SerializedFileReader::new(bytes::Bytes::from(file)).is_err());
    }
}
