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

use crate::row::{Body, Quantity, Row};

/// Rows of one row group: enough to compress well, little enough to read in part.
const ROWS_PER_GROUP: usize = 131_072;

/// The runs of one model, in run order.
#[derive(Clone, Debug, PartialEq)]
pub struct RunTable {
    model: String,
    rows: Vec<Row>,
}

impl RunTable {
    pub(crate) fn new(model: &str, rows: Vec<Row>) -> Self {
        Self { model: model.to_owned(), rows }
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
    /// Columns in the order of the rows' fields: `model`, `run`, `status`, the numbers of
    /// [`Quantity::ALL`] (null where a run has none), `realizable`, and the attitudes of the
    /// principal axes as drawn, scalar last (null for entrywise models). Floats are stored as they
    /// are, bit for bit.
    ///
    /// # Errors
    /// Writing fails.
    pub fn write_parquet(&self, output: impl Write + Send) -> Result<(), ParquetError> {
        let schema = Arc::new(parse_message_type(&schema())?);
        let properties =
            WriterProperties::builder().set_compression(Compression::UNCOMPRESSED).build();
        let mut writer = SerializedFileWriter::new(output, schema, Arc::new(properties))?;
        for rows in self.rows.chunks(ROWS_PER_GROUP) {
            let mut group = writer.next_row_group()?;
            self.write_group(&mut group, rows)?;
            group.close()?;
        }
        writer.close()?;
        Ok(())
    }

    fn write_group<W: Write + Send>(
        &self,
        group: &mut SerializedRowGroupWriter<'_, W>,
        rows: &[Row],
    ) -> Result<(), ParquetError> {
        let model = ByteArray::from(self.model.as_str());
        write::<ByteArrayType, _>(group, &vec![model; rows.len()], None)?;
        let runs: Vec<i64> = rows.iter().map(|r| r.run as i64).collect();
        write::<Int64Type, _>(group, &runs, None)?;
        let status: Vec<ByteArray> = rows.iter().map(|r| ByteArray::from(r.status())).collect();
        write::<ByteArrayType, _>(group, &status, None)?;
        for quantity in Quantity::ALL {
            write_optional(group, rows.iter().map(|r| r.value(quantity)))?;
        }
        let realizable: Vec<bool> = rows.iter().map(|r| r.realizable).collect();
        write::<BoolType, _>(group, &realizable, None)?;
        for body in Body::BOTH {
            for i in 0..4 {
                write_optional(group, rows.iter().map(|r| body.axes(r).map(|q| q.coords[i])))?;
            }
        }
        Ok(())
    }
}

/// The columns, as Parquet's message type.
fn schema() -> String {
    let mut fields = vec![
        "required binary model (string)".to_owned(),
        "required int64 run".to_owned(),
        "required binary status (string)".to_owned(),
    ];
    fields.extend(Quantity::ALL.map(|q| format!("optional double {}", q.column())));
    fields.push("required boolean realizable".to_owned());
    for body in Body::BOTH {
        fields.extend((1..=4).map(|i| format!("optional double {}_q{i}", body.name())));
    }
    format!("message run {{ {}; }}", fields.join("; "))
}

fn write_optional<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: impl Iterator<Item = Option<f64>> + Clone,
) -> Result<(), ParquetError> {
    let levels: Vec<i16> = values.clone().map(|v| i16::from(v.is_some())).collect();
    let present: Vec<f64> = values.flatten().collect();
    write::<DoubleType, _>(group, &present, Some(&levels))
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
    use crate::row::{Failure, Outcome};
    use parquet::{
        file::reader::{FileReader, SerializedFileReader},
        record::Field,
    };

    /// A good run with numbers that do not survive careless printing, and a failed one.
    fn table() -> RunTable {
        let outcome = Outcome {
            release_time_s: 0.1 + 0.2,
            relative_speed_m_per_s: f64::MIN_POSITIVE / 8.0,
            payload_rate_rad_per_s: [1e300, -0.0, 1.0 / 3.0],
            spin_rate_rad_per_s: 1e-17 + 1e-33,
            wobble_deg: 2_f64.sqrt(),
            nutation_deg: Some(3.0),
            nutation_2_deg: None,
            nutation_3_deg: Some(4.0),
            cone_deg: Some(5.0),
            inertia_ratio: 1.5,
        };
        let good = Row {
            run: 0,
            payload: [5e3, 4e3, 3e3, 20.0, 2.0, -50.0],
            stage: [1.0 / 7.0; 6],
            realizable: true,
            payload_axes: Some(nalgebra::UnitQuaternion::identity()),
            stage_axes: None,
            outcome: Ok(outcome),
        };
        let failed = Row {
            run: 1,
            realizable: false,
            outcome: Err(Failure {
                kind: "late".to_owned(),
                reason: "springs [1] late".to_owned(),
            }),
            ..good.clone()
        };
        RunTable::new("naive", vec![good, failed])
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
        assert_eq!(names.len(), 36);

        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        for (row, original) in rows.iter().zip(table.rows()) {
            let field = |name: &str| {
                row.get_column_iter().find(|(n, _)| *n == name).map(|(_, f)| f.clone()).unwrap()
            };
            assert_eq!(field("model"), Field::Str("naive".to_owned()));
            assert_eq!(field("run"), Field::Long(original.run() as i64));
            assert_eq!(field("status"), Field::Str(original.status().to_owned()));
            assert_eq!(field("realizable"), Field::Bool(original.realizable()));
            for quantity in Quantity::ALL {
                match (field(quantity.column()), original.value(quantity)) {
                    (Field::Double(found), Some(value)) => {
                        assert_eq!(found.to_bits(), value.to_bits(), "{quantity:?}");
                    }
                    (found, value) => assert_eq!((found, value), (Field::Null, None)),
                }
            }
            assert_eq!(field("payload_q4"), Field::Double(1.0));
            assert_eq!(field("stage_q1"), Field::Null);
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
