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
use std::{io::Write, sync::Arc};

use crate::{
    column::{Cell, Column},
    quantity::Quantity,
    row::Row,
};

/// Rows of one row group: enough to compress well, little enough to read in part.
const ROWS_PER_GROUP: usize = 131_072;

/// The runs of one model, in run order.
#[derive(Clone, Debug, PartialEq)]
pub struct RunTable {
    model: String,
    springs: usize,
    rows: Vec<Row>,
    drawn: Vec<String>,
}

impl RunTable {
    pub(crate) fn new(model: &str, springs: usize, rows: Vec<Row>) -> Self {
        Self { model: model.to_owned(), springs, rows, drawn: Vec::new() }
    }

    /// The same with names for what else the rows have drawn.
    pub(crate) fn with_drawn(self, columns: Vec<String>) -> Self {
        Self { drawn: columns, ..self }
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
        Some(self.rows.iter().filter_map(|row| row.drawn.get(i).copied()).collect())
    }

    /// Name of the model.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// Its runs.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The values of a quantity, in run order, of the runs that have one.
    #[must_use]
    pub fn values(&self, quantity: Quantity) -> Vec<f64> {
        self.rows.iter().filter_map(|row| row.value(quantity)).collect()
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
        let columns = Column::of(self.springs, &self.drawn);
        let fields: Vec<_> = columns.iter().map(|column| column.field()).collect();
        let schema = format!("message run {{ {}; }}", fields.join("; "));
        let schema = Arc::new(parse_message_type(&schema)?);
        let properties =
            WriterProperties::builder().set_compression(Compression::UNCOMPRESSED).build();
        let mut writer = SerializedFileWriter::new(output, schema, Arc::new(properties))?;
        for rows in self.rows.chunks(ROWS_PER_GROUP) {
            let mut group = writer.next_row_group()?;
            for column in &columns {
                self.write_column(&mut group, *column, rows)?;
            }
            group.close()?;
        }
        writer.close()?;
        Ok(())
    }

    fn write_column<W: Write + Send>(
        &self,
        group: &mut SerializedRowGroupWriter<'_, W>,
        column: Column<'_>,
        rows: &[Row],
    ) -> Result<(), ParquetError> {
        let (mut texts, mut integers) = (Vec::<ByteArray>::new(), Vec::new());
        let (mut numbers, mut flags) = (Vec::new(), Vec::new());
        let mut levels = Vec::with_capacity(rows.len());
        for row in rows {
            let cell = column.cell(&self.model, row);
            levels.push(i16::from(cell != Cell::Null));
            match cell {
                Cell::Text(text) => texts.push(text.as_str().into()),
                Cell::Integer(integer) => integers.push(integer),
                Cell::Number(number) => numbers.push(number),
                Cell::Flag(flag) => flags.push(flag),
                Cell::Null => {}
            }
        }
        let levels = column.is_optional().then_some(&levels[..]);
        match column {
            Column::Run => write::<Int64Type, _>(group, &integers, levels),
            Column::Realizable => write::<BoolType, _>(group, &flags, levels),
            Column::Number(_) | Column::Axes(..) | Column::Drawn(..) => {
                write::<DoubleType, _>(group, &numbers, levels)
            }
            Column::Model
            | Column::Status
            | Column::ReleaseOrder
            | Column::Recompressed
            | Column::ClearanceNote => write::<ByteArrayType, _>(group, &texts, levels),
        }
    }
}

fn write<T: parquet::data_type::DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> Result<(), ParquetError> {
    if let Some(mut column) = group.next_column()? {
        column.typed::<T>().write_batch(values, levels, None)?;
        column.close()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::{ClearanceNote, Failure, Outcome};
    use gyradius_inertia::InertiaMatrix;
    use gyradius_separation::{RunError, SpinMetrics};
    use nalgebra::Vector3;
    use parquet::{
        file::reader::{FileReader, SerializedFileReader},
        record::Field,
    };

    /// A good run with numbers that do not survive careless printing, and a failed one.
    fn table() -> RunTable {
        let inertia = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]).unwrap();
        let axis = Vector3::x_axis();
        let spin = |w: f64| SpinMetrics::new(&inertia, &Vector3::new(w, 0.1 * w, 0.03 * w), &axis);
        let outcome = Outcome {
            release_time_s: 0.1 + 0.2,
            relative_speed_m_per_s: f64::MIN_POSITIVE / 8.0,
            payload_rate_rad_per_s: [1e300, -0.0, 1.0 / 3.0],
            spin: spin(1.0 / 3.0),
            spin_before: spin(0.0),
            relative_velocity_m_per_s: [1e-17 + 1e-33, -0.0, 0.7],
            direction_error_deg: None,
            payload_tip_off_deg_per_s: [2_f64.sqrt(), 0.0, -1e-300],
            stage_tip_off_deg_per_s: [0.1; 3],
            momentum_kg_m2_per_s: [1e5, 2e5, -3e5],
            momentum_error_deg: Some(5.0),
            energies_j: [1300.0, 0.1, 0.2, 0.3, 0.7],
            releases_s: vec![Some(0.3), Some(0.1 + 0.2)],
            release_order: "1 2".to_owned(),
            recompressed: vec![2],
            clearance: Some([0.125, 0.1 + 0.2]),
            recontact_s: None,
            clearance_note: Some(ClearanceNote::Partial { until: 0.1 + 0.2 }),
        };
        let good = Row {
            run: 0,
            payload: [5e3, 4e3, 3e3, 20.0, 2.0, -50.0],
            stage: [1.0 / 7.0; 6],
            realizable: true,
            payload_axes: Some(nalgebra::UnitQuaternion::identity()),
            stage_axes: None,
            outcome: Ok(outcome),
            drawn: Box::new([9_999.5, -0.0]),
        };
        let failed = Row {
            run: 1,
            realizable: false,
            outcome: Err(Failure::Broken(RunError::NotFinite { time: 0.1 + 0.2 })),
            ..good.clone()
        };
        let columns = ["payload_mass_kg", "spring_1_friction_n"].map(str::to_owned);
        RunTable::new("naive", 2, vec![good, failed]).with_drawn(columns.into())
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
