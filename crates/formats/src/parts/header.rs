//! The header of a list of parts: the line that names the columns, and the row of units below it.

use super::{
    PartsError, PartsProblem,
    heading::{self, Column, Heading},
};
use crate::{
    body::shortened,
    rows::{Field, NOT_KNOWN, Rows, headers, without_marks},
    text::Text,
    units::Unit,
};

/// The header, which may stand below titles and have the units in a row below it.
pub(super) struct PartsHeader<'a> {
    /// Where it stands.
    pub(super) start: usize,
    /// With the units of the row below.
    pub(super) headings: Vec<String>,
    /// Line and cells of that row, if there is one.
    pub(super) units: Option<(usize, Vec<String>)>,
    /// The rows below both.
    pub(super) rows: Rows<'a>,
}

impl<'a> PartsHeader<'a> {
    /// That of a text, if it has a row. Where no line names parts and masses, the first one is the header.
    ///
    /// # Errors
    /// A row cannot be read, or a unit below a heading is none.
    pub(super) fn of(text: &'a Text) -> Result<Option<Self>, PartsError> {
        let cells = |row: &[Field]| row.iter().map(|field| cell(text, field)).collect::<Vec<_>>();
        let is_header = |cells: &[String]| {
            let columns: Vec<Heading> = cells.iter().map(|cell| Heading::of(cell)).collect();
            let has = |is: fn(&Heading) -> bool| columns.iter().any(is);
            let has_name = has(|heading| *heading == Heading::Column(Column::Name))
                || cells.iter().any(|cell| heading::rank_as_name(cell).is_some())
                || has(|heading| matches!(heading, Heading::Column(Column::Value(1..=3, _))));
            has_name && has(|heading| matches!(heading, Heading::Column(Column::Value(0, _))))
        };
        let at = |(at, line): (usize, &str)| {
            let mut rows = Rows::at(text.as_str(), at, line);
            match rows.row() {
                Ok(first) => is_header(&cells(&first)).then_some(Ok((first, rows))),
                Err(error) if without_marks(line).any(|cells| is_header(&cells)) => {
                    Some(Err(error.of(text)))
                }
                // In a title, a quotation mark is no more than that.
                Err(_) => None,
            }
        };
        let (first, mut rows) = match headers(text.as_str()).find_map(at) {
            Some(found) => found?,
            None => {
                let mut rows = Rows::new(text.as_str());
                let Some(first) = next(text, &mut rows)? else { return Ok(None) };
                (first, rows)
            }
        };
        let mut headings = cells(&first);
        let mut below = rows.clone();
        let mut units = None;
        if let Some(Ok(row)) = below.next() {
            let (line, row) = (line_of(text, &row), cells(&row));
            let with_units = with_units(&headings, &row);
            if let Some(with_units) = with_units.map_err(|p| PartsError::new(line, None, p))? {
                (headings, units, rows) = (with_units, Some((line, row)), below);
            }
        }
        let start = first.first().map_or(0, |field| field.start);
        Ok(Some(Self { start, headings, units, rows }))
    }
}

/// The headings with the units of the row below them, if it is a row of units: it has one for a number, and no number.
fn with_units(headings: &[String], below: &[String]) -> Result<Option<Vec<String>>, PartsProblem> {
    let mut some = false;
    let mut bad = None;
    let mut together = headings.to_vec();
    for (heading, unit) in together.iter_mut().zip(below) {
        let column = Heading::of(heading);
        let unit = unit.trim_start_matches(['[', '(']).trim_end_matches([']', ')']);
        if !column.is_number() || unit.is_empty() || unit == "-" {
            continue;
        }
        if unit.parse::<f64>().is_ok() {
            return Ok(None);
        }
        let Some((dimension, stated)) = column.dimension() else {
            let is_percent = column.is_percent();
            if !is_percent || !["%", "percent"].contains(&unit) {
                let allowed = if is_percent { "%, for one standard deviation" } else { "none" };
                bad = bad.or(Some((heading.clone(), unit.to_owned(), allowed)));
            }
            continue;
        };
        let si = Unit::of(unit, dimension).ok().map(|unit| unit.si);
        some |= si.is_some() || unit == "%";
        // Both may say the same.
        if si.is_none() || si != stated {
            *heading = format!("{heading} [{unit}]");
        }
    }
    if !some || headings.len() != below.len() {
        return Ok(None);
    }
    match bad {
        Some((heading, unit, allowed)) => {
            let (heading, unit) = (shortened(&heading), shortened(&unit));
            Err(PartsProblem::UnitBelow { heading, unit, allowed })
        }
        None => Ok(Some(together)),
    }
}

pub(super) fn next(text: &Text, rows: &mut Rows<'_>) -> Result<Option<Vec<Field>>, PartsError> {
    rows.next().transpose().map_err(|error| error.of(text).into())
}

pub(super) fn line_of(text: &Text, fields: &[Field]) -> usize {
    text.line(fields.first().map_or(0, |field| field.start))
}

/// What a field holds, without blanks around it.
pub(super) fn written(text: &Text, field: &Field) -> String {
    field.of(text.as_str()).trim().replace("\"\"", "\"")
}

/// How many blanks stand before what a field holds, outside of its quotation marks and within them.
pub(super) fn indentation(text: &Text, field: &Field) -> usize {
    let before = text.as_str().get(..field.start).unwrap_or_default();
    let outside = before.len() - before.trim_end_matches(' ').len();
    let held = field.of(text.as_str());
    outside + held.chars().take_while(|c| c.is_whitespace()).count()
}

/// The same of a heading, a unit or a name: nothing where R writes that nothing is there.
pub(super) fn cell(text: &Text, field: &Field) -> String {
    let plain = written(text, field);
    if plain == NOT_KNOWN { String::new() } else { plain }
}
