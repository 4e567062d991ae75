//! Lists of parts: mass, mass centre, inertia and their standard deviations, one part a row, and what belongs to what.

mod edges;
mod error;
pub(crate) mod heading;
mod last_place;
mod levels;
mod row;
mod row_below;
mod row_shape;
mod shares;
mod totals;
mod unread;
mod unread_kinds;

pub use error::{PartsError, PartsFile, PartsProblem};
pub use row::{PartNumbers, PartRow};
pub(crate) use unread_kinds::Unread;

use std::collections::BTreeMap;

use crate::{
    FileProblem, MAX_BODIES, Products,
    body::shortened,
    error::Refusal,
    products_comment::stated_products,
    rows::{Field, NOT_KNOWN, Rows, headers, without_marks},
    table_terms::{InertiaPoint, TableTerms},
    text::Text,
    title_point, title_units,
    units::{Unit, squeezed},
};
use edges::Edges;
use heading::{Column, Heading};
use levels::Levels;
use row::Cells;
use shares::Shares;

/// The assembly of a list without assemblies.
const WHOLE: &str = "whole";

/// A list of parts and assemblies.
///
/// ```
/// use gyradius_formats::PartsTable;
///
/// let table = "\
/// name,parent,mass_kg,centre_x_m,centre_y_m,centre_z_m,shape,sides_m,radius_m,mass_percent
/// craft,,,,,,,,,
/// bus,craft,300,0,0,0,solid_box,1 1 2,,5
/// tank,craft,100,0,0,1.3,sphere,,0.3,2
/// ";
/// let table = PartsTable::read(table.as_bytes(), None)?;
/// let bus = table.rows()[1].numbers().unwrap();
/// assert_eq!((bus.mass_kg(), bus.deviations()[0]), (300.0, 15.0));
/// assert!((bus.inertia().entries()[2] - 50.0).abs() < 1e-12);
/// # Ok::<(), gyradius_formats::PartsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PartsTable {
    rows: Vec<PartRow>,
    passed_over: Vec<String>,
}

impl PartsTable {
    /// Reads a table with a header; without a column `parent`, everything in it belongs to one assembly. `products` says which
    /// sign they have where the table does not.
    ///
    /// # Errors
    /// It is no table, a column is missing, or a row does not say what a part must; the error names line and field.
    pub fn read(bytes: &[u8], products: Option<Products>) -> Result<Self, PartsError> {
        let mut table = Self::rows_of(bytes, products)?;
        if !table.has_parents {
            let taken = table.rows.iter().any(|row| row.name() == WHOLE);
            let whole = if taken { format!("({WHOLE})") } else { WHOLE.to_owned() };
            table.rows.iter_mut().for_each(|row| row.set_parent(&whole, row.place()));
            table.rows.push(PartRow::assembly(&whole, (PartsFile::Parts, 1)));
        }
        Ok(table.finish())
    }

    /// The same with a second table, of the columns `child` and `parent`, that says what belongs to what. What stands in it
    /// alone is an assembly. Its other columns are among those that are [passed over](Self::passed_over).
    ///
    /// # Errors
    /// As [`read`](Self::read), or something belongs to two, or an edge stands twice.
    pub fn with_edges(
        bytes: &[u8],
        edges: &[u8],
        products: Option<Products>,
    ) -> Result<Self, PartsError> {
        let mut table = Self::rows_of(bytes, products)?;
        let Edges { edges, passed_over } = Edges::of(edges).map_err(PartsError::in_edges)?;
        for heading in passed_over {
            if !table.passed_over.contains(&heading) {
                table.passed_over.push(heading);
            }
        }
        let mut places: BTreeMap<String, usize> =
            table.rows.iter().enumerate().map(|(i, row)| (row.name().to_owned(), i)).collect();
        for (line, child, parent) in edges {
            let place = (PartsFile::Edges, line);
            for name in [&child, &parent] {
                if !places.contains_key(name) {
                    places.insert(name.clone(), table.rows.len());
                    table.rows.push(PartRow::assembly(name, place));
                }
            }
            let Some(row) = places.get(&child).and_then(|i| table.rows.get_mut(*i)) else {
                continue;
            };
            if let Some(first) = row.parent().filter(|first| *first != parent) {
                let first = first.to_owned();
                let problem = PartsProblem::Parents { child, first, second: parent };
                return Err(PartsError::new(line, None, problem).in_edges());
            }
            row.set_parent(&parent, place);
        }
        Ok(table.finish())
    }

    /// The parts and assemblies, in the order of the file.
    #[must_use]
    pub fn rows(&self) -> &[PartRow] {
        &self.rows
    }

    /// Parts that have mass and mass centre of those above them together, two or more, and may be their total: their names do not
    /// say so.
    #[must_use]
    pub fn like_totals(&self) -> Vec<&PartRow> {
        totals::like_totals(&self.rows)
    }

    /// Headings of columns that mean nothing here.
    #[must_use]
    pub fn passed_over(&self) -> &[String] {
        &self.passed_over
    }

    fn rows_of(bytes: &[u8], products: Option<Products>) -> Result<Raw, PartsError> {
        let text = Text::new(bytes, true)?;
        let Some(Header { start, headings, units, mut rows }) = header(&text)? else {
            return Err(Refusal::from(FileProblem::Empty).into());
        };
        let line = text.line(start);
        let columns = headings.iter().map(|heading| Heading::of(heading));
        let mut columns: Vec<Heading> = columns.collect();
        if !columns.contains(&Heading::Column(Column::Shape)) {
            columns = columns.into_iter().map(Heading::without_shapes).collect();
        }
        columns = Heading::with_one_half(columns);
        // Beside names, numbers are no names.
        let is_id = |heading: &String| squeezed(heading) == "id";
        let names =
            columns.iter().filter(|column| **column == Heading::Column(Column::Name)).count();
        if names == 2
            && let Some(id) = headings.iter().position(is_id)
        {
            columns[id] = Heading::Other;
        }
        // Words that may say something else are names where nothing else is.
        let other_name = || headings.iter().position(|heading| heading::may_be_name(heading));
        if names == 0
            && let Some(at) = other_name()
        {
            columns[at] = Heading::Column(Column::Name);
        }
        let mut passed_over = Vec::new();
        for (at, (column, heading)) in columns.iter().zip(&headings).enumerate() {
            let refuse = |problem: PartsProblem| Err(PartsError::new(line, None, problem));
            if let Some((field, bad)) = column.bad_unit(&columns) {
                return refuse(Box::new(bad.clone().of(heading, field)).into());
            }
            if column.is_lost_product(&columns) {
                let heading = shortened(heading);
                return refuse(PartsProblem::File(FileProblem::Product { heading }));
            }
            if let Some(other) = column.unit_it_lacks(&columns) {
                let (heading, other) = (shortened(heading), shortened(&headings[other]));
                return refuse(PartsProblem::File(FileProblem::NoUnit { heading, other }));
            }
            match column {
                Heading::Signed => {
                    let heading = shortened(heading);
                    return refuse(PartsProblem::File(FileProblem::Sign { heading }));
                }
                Heading::NoDeviation => {
                    return refuse(PartsProblem::Deviation { heading: shortened(heading) });
                }
                Heading::SizeDeviation => {
                    return refuse(PartsProblem::SizeDeviation { heading: shortened(heading) });
                }
                Heading::Unit(..)
                | Heading::SizeUnit(..)
                | Heading::Product
                | Heading::Unread(_)
                | Heading::Other => passed_over.push(shortened(heading)),
                Heading::Column(_) | Heading::Size(..) => {
                    if let Some(first) = columns[..at].iter().position(|c| c.says_the_same(column))
                    {
                        let (first, second) = (shortened(&headings[first]), shortened(heading));
                        return refuse(PartsProblem::Columns { first, second });
                    }
                }
            }
        }
        let lacks = |column: &Heading| matches!(column.dimension(), Some((_, None)));
        title_units::refused(&text, start, columns.iter().any(lacks))?;
        title_point::refused(&text, start, InertiaPoint::MassCentre)?;
        let has = |wanted: Column| columns.contains(&Heading::Column(wanted));
        let has_mass = columns.iter().any(|c| matches!(c, Heading::Column(Column::Value(0, _))));
        let names = "name, id, part, body, link, component, item, element or description";
        for (there, column) in [(has(Column::Name), names), (has_mass, "mass or m")] {
            if !there {
                let error = PartsError::new(line, None, PartsProblem::NoColumn { column });
                return Err(error.beside(&passed_over));
            }
        }
        let has_parents = has(Column::Parent);
        let stated = stated_products(&text, start)?;
        let measured = columns.iter().filter_map(Heading::dimension);
        let measured = measured.map(|(dimension, unit)| (dimension, unit.unwrap_or(1.0)));
        let terms = &TableTerms::new(measured, InertiaPoint::MassCentre);
        if let Some((line, cells)) = &units {
            let problem = |((column, heading), cell): ((&Heading, &String), &String)| match column {
                Heading::Unread(what) => what.problem_in_units(heading, cell, terms),
                _ => None,
            };
            if let Some(error) = columns.iter().zip(&headings).zip(cells).find_map(problem) {
                return Err(PartsError::new(*line, None, error.into()));
            }
        }
        // What else may say that a row is a total.
        let label = |at: &usize| {
            let is_first =
                *at == 0 || is_id(&headings[*at]) || heading::may_be_name(&headings[*at]);
            is_first && columns[*at] == Heading::Other
        };
        let labels: Vec<usize> = (0..columns.len()).filter(label).collect();
        let mut shares = Shares::of(&columns, &headings);
        let mut levels = Levels::of(&headings).filter(|_| !has_parents);
        let mut found = Vec::new();
        while let Some(fields) = next(&text, &mut rows)? {
            let line = line_of(&text, &fields);
            if found.len() == MAX_BODIES {
                return Err(
                    Refusal { line: Some(line), problem: FileProblem::TooManyBodies }.into()
                );
            }
            let cells: Vec<String> = fields.iter().map(|field| written(&text, field)).collect();
            let row = Cells {
                columns: &columns,
                headings: &headings,
                cells: &cells,
                stated,
                products,
                labels: &labels,
                terms,
            };
            let row = row.row(line).map_err(|error| error.beside(&passed_over))?;
            if let Some(shares) = &mut shares {
                shares.add(&row, &cells);
            }
            if let Some(levels) = &mut levels {
                levels.add(&row, &cells);
            }
            found.push(row);
        }
        if found.is_empty() {
            return Err(PartsError::new(line, None, PartsProblem::NoRows));
        }
        if let Some((line, name, problem)) = levels.as_ref().and_then(Levels::problem) {
            return Err(PartsError::new(line, Some(name), problem));
        }
        if let Some((row, label)) = totals::named(&found) {
            let (_, line) = row.place();
            return Err(PartsError::new(line, Some(label), PartsProblem::Summary));
        }
        if let Some(problem) = shares.and_then(Shares::problem) {
            return Err(PartsError::new(line, None, problem));
        }
        Ok(Raw { rows: found, passed_over, has_parents })
    }
}

/// A table as it stands.
struct Raw {
    rows: Vec<PartRow>,
    passed_over: Vec<String>,
    has_parents: bool,
}

impl Raw {
    fn finish(self) -> PartsTable {
        PartsTable { rows: self.rows, passed_over: self.passed_over }
    }
}

/// The header of a list of parts with its offset, and what stands below it.
struct Header<'a> {
    start: usize,
    /// With the units of the row below.
    headings: Vec<String>,
    /// Line and cells of that row, if there is one.
    units: Option<(usize, Vec<String>)>,
    /// The rows below both.
    rows: Rows<'a>,
}

/// The header, which may stand below titles and have the units in a row below it. Where no line names parts and masses, the first one is the
/// header.
fn header(text: &Text) -> Result<Option<Header<'_>>, PartsError> {
    let cells = |row: &[Field]| row.iter().map(|field| cell(text, field)).collect::<Vec<_>>();
    let is_header = |cells: &[String]| {
        let columns: Vec<Heading> = cells.iter().map(|cell| Heading::of(cell)).collect();
        let has = |is: fn(&Heading) -> bool| columns.iter().any(is);
        let has_name = has(|heading| *heading == Heading::Column(Column::Name))
            || cells.iter().any(|cell| heading::may_be_name(cell))
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
    Ok(Some(Header { start, headings, units, rows }))
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

fn next(text: &Text, rows: &mut Rows<'_>) -> Result<Option<Vec<Field>>, PartsError> {
    rows.next().transpose().map_err(|error| error.of(text).into())
}

fn line_of(text: &Text, fields: &[Field]) -> usize {
    text.line(fields.first().map_or(0, |field| field.start))
}

/// What a field holds, without blanks around it.
fn written(text: &Text, field: &Field) -> String {
    field.of(text.as_str()).trim().replace("\"\"", "\"")
}

/// The same of a heading, a unit or a name: nothing where R writes that nothing is there.
fn cell(text: &Text, field: &Field) -> String {
    let plain = written(text, field);
    if plain == NOT_KNOWN { String::new() } else { plain }
}

#[cfg(test)]
mod contradictions;
#[cfg(test)]
mod spreadsheets;
#[cfg(test)]
mod stated_units;
#[cfg(test)]
mod tests;
