//! Run tables as structured arrays of NumPy: one record a run, little-endian, a field a column.
//!
//! The format is that of `numpy.lib.format`: a magic string, a version, the length of a header, the header, and the
//! records without anything between them. The header is a Python dictionary with the type of the records and how many
//! there are.

use std::{fmt::Write as _, io::Write};

use super::{FormatError, TableWriter, write_rows};
use crate::{
    cell::Cell,
    column::{Column, Kind},
    table::Table,
};

/// How many runs a table has, and how long the longest text in each column is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Extent {
    runs: u64,
    /// Characters of the longest text in each column, in the order of the columns.
    texts: Vec<usize>,
}

impl Extent {
    /// Adds runs, which have the same columns as those added before.
    pub fn add(&mut self, runs: &Table) {
        self.runs += runs.len() as u64;
        self.texts.resize(self.texts.len().max(runs.columns().len()), 0);
        let is_text = |column: &Column| column.kind() == Kind::Text;
        let texts: Vec<_> =
            runs.sources().enumerate().filter(|(_, (column, _))| is_text(column)).collect();
        for row in runs.rows() {
            for (place, (_, source)) in &texts {
                self.texts[*place] = self.texts[*place].max(characters(&row.cell_from(*source)));
            }
        }
    }
}

pub(super) struct Writer<W> {
    output: W,
    fields: Vec<Field>,
    /// Runs that are still to come.
    left: u64,
    runs: u64,
}

struct Field {
    name: String,
    kind: Kind,
    is_optional: bool,
    /// Characters, of texts.
    width: usize,
}

impl<W: Write> Writer<W> {
    pub(super) fn new(
        columns: &Table,
        extent: &Extent,
        mut output: W,
    ) -> Result<Self, FormatError> {
        let field = |(place, column): (usize, &Column)| Field {
            name: column.name().to_owned(),
            kind: column.kind(),
            is_optional: column.is_optional(),
            // NumPy has no texts of no characters.
            width: extent.texts.get(place).copied().unwrap_or_default().max(1),
        };
        let fields: Vec<Field> = columns.columns().iter().enumerate().map(field).collect();
        output.write_all(&header(&fields, extent.runs))?;
        Ok(Self { output, fields, left: extent.runs, runs: extent.runs })
    }
}

impl<W: Write + Send> TableWriter for Writer<W> {
    fn write(&mut self, runs: &Table) -> Result<(), FormatError> {
        let (more, said) = (runs.len() as u64, self.runs);
        let wrong = || FormatError::Extent {
            what: "runs".to_owned(),
            found: said - self.left + more,
            said,
        };
        self.left = self.left.checked_sub(more).ok_or_else(wrong)?;
        let fields = &self.fields;
        write_rows(runs, &mut self.output, |rows| {
            let mut records = Vec::new();
            for row in rows {
                for (field, (_, cell)) in fields.iter().zip(row.cells()) {
                    field.write(&cell, &mut records)?;
                }
            }
            Ok(records)
        })
    }

    fn finish(mut self: Box<Self>) -> Result<(), FormatError> {
        if self.left > 0 {
            let found = self.runs - self.left;
            return Err(FormatError::Extent { what: "runs".to_owned(), found, said: self.runs });
        }
        Ok(self.output.flush()?)
    }
}

impl Field {
    /// Its type, as NumPy writes it.
    fn dtype(&self) -> String {
        match self.kind {
            Kind::Number => "<f8".to_owned(),
            Kind::Integer => "<i8".to_owned(),
            // A flag that may be missing has a third value.
            Kind::Flag => if self.is_optional { "|i1" } else { "|b1" }.to_owned(),
            Kind::Text => format!("<U{}", self.width),
        }
    }

    /// Appends a value: NaN for a number that is missing, the least whole number, -1 for a flag, an empty text.
    fn write(&self, cell: &Cell<'_>, bytes: &mut Vec<u8>) -> Result<(), FormatError> {
        match self.kind {
            Kind::Number => {
                let number = if let Cell::Number(number) = cell { *number } else { f64::NAN };
                bytes.extend(number.to_le_bytes());
            }
            Kind::Integer => {
                let integer = if let Cell::Integer(integer) = cell { *integer } else { i64::MIN };
                bytes.extend(integer.to_le_bytes());
            }
            Kind::Flag => {
                let flag = if let Cell::Flag(flag) = cell { i8::from(*flag) } else { -1 };
                bytes.extend(flag.to_le_bytes());
            }
            Kind::Text => {
                let long = characters(cell);
                if long > self.width {
                    let what = format!("characters of {}", self.name);
                    let (found, said) = (long as u64, self.width as u64);
                    return Err(FormatError::Extent { what, found, said });
                }
                if let Cell::Text(text) | Cell::Note { text, .. } = cell {
                    bytes.extend(text.chars().flat_map(|c| u32::from(c).to_le_bytes()));
                }
                bytes.resize(bytes.len() + 4 * (self.width - long), 0);
            }
        }
        Ok(())
    }
}

fn characters(cell: &Cell<'_>) -> usize {
    if let Cell::Text(text) | Cell::Note { text, .. } = cell { text.chars().count() } else { 0 }
}

/// What stands before the records: aligned to 64 bytes, in the first version of the format that can hold it.
fn header(fields: &[Field], runs: u64) -> Vec<u8> {
    let mut text = "{'descr': [".to_owned();
    for (i, field) in fields.iter().enumerate() {
        let comma = if i > 0 { ", " } else { "" };
        // Writing into a text cannot fail.
        let _ = write!(text, "{comma}({}, '{}')", quoted(&field.name), field.dtype());
    }
    let _ = write!(text, "], 'fortran_order': False, 'shape': ({runs},), }}");
    // Magic string, version, and the length in two bytes or in four.
    let padded = |before: usize| (before + text.len() + 1).next_multiple_of(64) - before;
    let version: u8 = match (text.is_ascii(), u16::try_from(padded(10))) {
        (true, Ok(_)) => 1,
        (true, Err(_)) => 2,
        (false, _) => 3,
    };
    let before = if version == 1 { 10 } else { 12 };
    let length = padded(before);
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    bytes.extend(&(length as u32).to_le_bytes()[..before - 8]);
    bytes.extend(text.as_bytes());
    bytes.resize(before + length - 1, b' ');
    bytes.push(b'\n');
    bytes
}

/// A text as Python writes it.
fn quoted(text: &str) -> String {
    let mut quoted = "'".to_owned();
    for c in text.chars() {
        match c {
            '\'' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => {
                // Writing into a text cannot fail.
                let _ = write!(quoted, "\\U{:08x}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('\'');
    quoted
}
