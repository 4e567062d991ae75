//! Run tables as JSON Lines: an object a run, numbers with as many digits as read back bit for bit, null for what is not
//! there. JSON has no infinite numbers: they are null too.

use serde::{Serialize, Serializer};
use std::io::Write;

use super::{FormatError, TableWriter, write_rows};
use crate::{
    cell::Cell,
    table::{Row, Table},
};

pub(super) struct Writer<W> {
    output: W,
}

impl<W: Write> Writer<W> {
    pub(super) fn new(output: W) -> Self {
        Self { output }
    }
}

impl<W: Write + Send> TableWriter for Writer<W> {
    fn write(&mut self, runs: &Table) -> Result<(), FormatError> {
        write_rows(runs, &mut self.output, |rows| {
            let mut lines = Vec::new();
            for row in rows {
                serde_json::to_writer(&mut lines, &Object(row))?;
                lines.push(b'\n');
            }
            Ok(lines)
        })
    }

    fn finish(mut self: Box<Self>) -> Result<(), FormatError> {
        Ok(self.output.flush()?)
    }
}

/// What stands in a row, by the names of the columns.
struct Object<'a>(Row<'a>);

impl Serialize for Object<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.cells().map(|(column, cell)| (column.name(), Value(cell))))
    }
}

struct Value<'a>(Cell<'a>);

impl Serialize for Value<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0 {
            Cell::Number(number) => serializer.serialize_f64(*number),
            Cell::Integer(integer) => serializer.serialize_i64(*integer),
            Cell::Text(text) | Cell::Note { text, .. } => serializer.serialize_str(text),
            Cell::Flag(flag) => serializer.serialize_bool(*flag),
            Cell::Null => serializer.serialize_none(),
        }
    }
}
