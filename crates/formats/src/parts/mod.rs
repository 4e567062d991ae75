//! Lists of parts: mass, mass centre, inertia and their standard deviations, one part a row, and what belongs to what.

mod columns;
mod edges;
mod error;
mod header;
pub(crate) mod heading;
mod last_place;
mod levels;
mod nesting;
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
    FileProblem, MAX_BODIES, Products, error::Refusal, products_comment::stated_products,
    table_terms::InertiaPoint, text::Text, title_point, title_units,
};
use columns::PartColumns;
use edges::Edges;
use header::{PartsHeader, line_of, next, written};
use heading::Column;
use levels::Levels;
use nesting::Nesting;
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
        let Some(header) = PartsHeader::of(&text)? else {
            return Err(Refusal::from(FileProblem::Empty).into());
        };
        let PartsHeader { start, headings, units, mut rows } = header;
        let line = text.line(start);
        let in_header = |problem| PartsError::new(line, None, problem);
        let columns = PartColumns::of(headings).map_err(in_header)?;
        title_units::refused(&text, start, columns.some_lack_units())?;
        title_point::refused(&text, start, InertiaPoint::MassCentre)?;
        columns.check_what_must_be().map_err(|p| in_header(p).beside(&columns.passed_over))?;
        let stated = stated_products(&text, start)?;
        let terms = columns.terms();
        if let Some((line, cells)) = &units {
            let checked = columns.check_units(cells, &terms);
            checked.map_err(|problem| PartsError::new(*line, None, problem))?;
        }
        let mut shares = Shares::of(&columns);
        let has_parents = columns.has(Column::Parent);
        let mut levels = Levels::of(&columns.headings).filter(|_| !has_parents);
        let mut nesting = Nesting::of(&columns).filter(|_| !has_parents);
        let mut found = Vec::new();
        while let Some(fields) = next(&text, &mut rows)? {
            let line = line_of(&text, &fields);
            if found.len() == MAX_BODIES {
                let problem = FileProblem::TooManyBodies;
                return Err(Refusal { line: Some(line), problem }.into());
            }
            let cells: Vec<String> = fields.iter().map(|field| written(&text, field)).collect();
            let row = Cells { columns: &columns, cells: &cells, stated, products, terms: &terms };
            let row = row.row(line).map_err(|error| error.beside(&columns.passed_over))?;
            if let Some(shares) = &mut shares {
                shares.add(&row, &cells);
            }
            if let Some(levels) = &mut levels {
                levels.add(&row, &cells);
            }
            if let Some(nesting) = &mut nesting {
                nesting.add(&text, &fields, &cells);
            }
            found.push(row);
        }
        if found.is_empty() {
            return Err(in_header(PartsProblem::NoRows));
        }
        if let Some((line, name, problem)) = levels.as_ref().and_then(Levels::problem) {
            return Err(PartsError::new(line, Some(name), problem));
        }
        if let Some((row, label)) = totals::named(&found) {
            let (_, line) = row.place();
            return Err(PartsError::new(line, Some(label), PartsProblem::Summary));
        }
        if let Some((row, problem)) = nesting.and_then(|nesting| nesting.problem(&found)) {
            return Err(PartsError::new(row.place().1, Some(row.name()), problem));
        }
        if let Some(problem) = shares.and_then(Shares::problem) {
            return Err(in_header(problem));
        }
        Ok(Raw { rows: found, passed_over: columns.passed_over, has_parents })
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

#[cfg(test)]
mod contradictions;
#[cfg(test)]
mod spreadsheets;
#[cfg(test)]
mod stated_units;
#[cfg(test)]
mod tests;
