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
