//! The header of a table of bodies: which columns hold the seven numbers, and in what units.

use std::collections::BTreeSet;

use crate::{
    FileBodyError, FileProblem,
    body::{entry_of, lower_of, shortened},
    error::Refusal,
    heading_sign::without_sign,
    parts::{Unread, heading::is_spread},
    product_heading::is_unread_product,
    rows::{Field, Rows, commented_headers, headers, is_blank, without_marks},
    spread,
    table_terms::{InertiaPoint, TableTerms},
    ten_heading::{TenCentre, TenHeading},
    text::Text,
    title_point, title_units,
    unit_words::speaks_of_a_unit,
    units::{BadUnit, Dimension, SharedUnit, Unit, UnitProblem, longest_name, squeezed},
};

/// Columns that are looked for: the six entries, the three below the diagonal, the mass, the name, and what the products are.
pub(crate) const BELOW: usize = 6;
pub(crate) const MASS: usize = 9;
pub(crate) const NAME: usize = 10;
pub(crate) const PRODUCTS: usize = 11;
pub(crate) const FIELDS: [&str; 12] =
    ["ixx", "iyy", "izz", "ixy", "ixz", "iyz", "iyx", "izx", "izy", "mass", "name", "products"];

/// The column of a heading, and the unit that follows its name, or why that is none. What follows and is no unit
/// may make another column of it: `ixx_sigma`. A sign is left out, for whoever reads the column to refuse.
fn heading(text: &str) -> Option<(usize, Result<Unit, BadUnit>)> {
    // Longer texts are none, and would be searched for names for long.
    if text.len() > 200 {
        return None;
    }
    if let Some(word) = column_of(&squeezed(text)).filter(|column| *column > MASS) {
        return Some((word, Ok(Unit::none())));
    }
    let unsigned = without_sign(text);
    let text = unsigned.as_deref().unwrap_or(text);
    // A mass centre is no mass.
    if TenHeading::of(text).is_some_and(|heading| heading.centre.is_some()) {
        return None;
    }
    let number = |name: &str| {
        let column = column_of(name).filter(|column| *column <= MASS)?;
        Some((column, name.len() == 1))
    };
    let ((column, is_letter), tail) = longest_name(text, number)?;
    match tail.unit(dimension(column))? {
        // A letter that a word begins with is not the mass.
        Ok(_) if is_letter && tail.text().starts_with(char::is_alphabetic) => None,
        Err(bad) if is_letter && !bad.is_certain => None,
        Err(_) if spread::is_marked(text) || spread::has_word(text) => None,
        unit => Some((column, unit)),
    }
}

/// What the column of one of the seven numbers is in.
fn dimension(column: usize) -> Dimension {
    if column == MASS { Dimension::Mass } else { Dimension::Inertia }
}

fn column_of(name: &str) -> Option<usize> {
    match name {
        "mass" | "m" => Some(MASS),
        "name" | "body" | "link" | "part" | "component" => Some(NAME),
        "products" | "poiconv" => Some(PRODUCTS),
        _ => entry_of(name).or_else(|| lower_of(name).map(|product| BELOW + product)),
    }
}

/// What a header says of the rows below it.
#[derive(Debug)]
pub(crate) struct Header {
    /// The headings.
    pub(crate) row: Vec<Field>,
    /// The column of each of [`FIELDS`].
    pub(crate) columns: [Option<usize>; FIELDS.len()],
    pub(crate) mass: SharedUnit,
    pub(crate) inertia: SharedUnit,
    /// The row of units below it, if there is one.
    pub(crate) units: Option<Vec<Field>>,
    /// Columns that would change the inertia of a row, and are not read.
    unread: Vec<(usize, Unread)>,
    /// What holds for all rows.
    terms: TableTerms,
}

impl Header {
    /// The headings of columns that no check reads, each once, and the numbers of those that have cells, as the ones given, and no heading.
    pub(crate) fn unread_columns(&self, text: &Text, have_cells: &BTreeSet<usize>) -> Vec<String> {
        let is_read = |at: usize| {
            self.columns.contains(&Some(at)) || self.unread.iter().any(|(other, _)| *other == at)
        };
        let others = self.row.iter().enumerate().filter(|(at, _)| !is_read(*at));
        let mut found: Vec<String> = Vec::new();
        for (at, field) in others {
            let heading = field.of(text.as_str()).trim().replace("\"\"", "\"");
            let named = match heading.as_str() {
                "" if have_cells.contains(&at) => format!("column {} (no heading)", at + 1),
                _ => heading,
            };
            if !named.is_empty() && !found.contains(&named) {
                found.push(named);
            }
        }
        found
    }

    /// Why a row is refused that says by a cell which is not read that its inertia is another one.
    pub(crate) fn unread(&self, text: &Text, row: &[Field]) -> Option<FileBodyError> {
        self.problem(text, row, Unread::problem).map(|(_, error)| error)
    }

    /// The first cell of a row that is refused by a judgement of those that are not read, and why.
    fn problem(
        &self,
        text: &Text,
        row: &[Field],
        judge: impl Fn(Unread, &str, &str, &TableTerms) -> Option<FileBodyError>,
    ) -> Option<(Field, FileBodyError)> {
        self.unread.iter().find_map(|(at, what)| {
            let field = row.get(*at)?;
            let (heading, cell) = (self.heading(text, *at)?, field.of(text.as_str()).trim());
            let error = if is_thing(*what, heading, cell) {
                None
            } else {
                judge(*what, heading, cell, &self.terms)
            };
            error.map(|error| (*field, error))
        })
    }

    /// What stands above a column.
    pub(crate) fn heading<'t>(&self, text: &'t Text, at: usize) -> Option<&'t str> {
        self.row.get(at).map(|field| field.of(text.as_str()).trim())
    }

    /// The columns of units in which a row names a thing.
    pub(crate) fn things(&self, text: &Text, row: &[Field]) -> impl Iterator<Item = usize> {
        self.unread.iter().filter_map(move |(at, what)| {
            let cell = row.get(*at)?.of(text.as_str()).trim();
            let names_one = cell.contains(char::is_alphanumeric) && !is_blank(cell);
            (names_one && is_thing(*what, self.heading(text, *at)?, cell)).then_some(*at)
        })
    }
}

/// Whether a cell is passed over: a unit may also be a thing that was made, unit FM-1 of a series.
fn is_thing(what: Unread, heading: &str, cell: &str) -> bool {
    what == Unread::Unit
        && ["unit", "units"].contains(&squeezed(heading).as_str())
        && !speaks_of_a_unit(cell)
}

/// What a column of a table of bodies would change, if it does: what else a list of parts must not have may be anything here, as the
/// number of a sample, or the angle at which it was measured.
fn would_change(heading: &str) -> Option<Unread> {
    match Unread::of(heading)? {
        what @ (Unread::Unit | Unread::Reference | Unread::Sign) => Some(what),
        Unread::Count | Unread::Turn | Unread::Growth => None,
    }
}

/// The unit of a column, as the heading and the row of units below say it; why there is none, if both do.
pub(crate) fn one_unit(heading: Unit, below: Unit) -> Result<Unit, String> {
    match (heading, below) {
        (a, b) if b.text.is_empty() => Ok(a),
        (a, b) if a.text.is_empty() || a.si == b.si => Ok(b),
        (a, b) => Err(format!("the header says {}, and the row below it {}", a.text, b.text)),
    }
}

/// The unit in a cell of a row of units.
pub(crate) fn unit_below(
    text: &Text,
    field: &Field,
    dimension: Dimension,
) -> Result<Unit, BadUnit> {
    let written = field.of(text.as_str());
    let bad = |problem| BadUnit { text: written.to_owned(), problem, is_certain: true };
    let unsigned = without_sign(written).and_then(|plain| Unit::of(&plain, dimension).ok());
    // A dash alone says that nothing is stated.
    if unsigned.is_some_and(|unit| !unit.text.is_empty()) {
        return Err(bad(UnitProblem::Sign));
    }
    Unit::of(written, dimension).map_err(bad)
}

/// The units in a row below a header, none where a field is empty: nothing if all of those that count are empty, or if one of them is no unit,
/// unless the row has no numbers and speaks of units, which may not be known.
fn units_below(
    text: &Text,
    columns: &[Option<usize>],
    row: &[Field],
) -> Option<Vec<Result<Unit, BadUnit>>> {
    let of_number = |column: &Option<usize>| column.filter(|column| *column <= MASS);
    let unit = |(column, field): (&Option<usize>, &Field)| {
        of_number(column)
            .map_or(Ok(Unit::none()), |column| unit_below(text, field, dimension(column)))
    };
    let units: Vec<_> = columns.iter().zip(row).map(unit).collect();
    let is_stated =
        |unit: &Result<Unit, BadUnit>| !matches!(unit, Ok(unit) if unit.text.is_empty());
    let is_known = |unit: &Result<Unit, BadUnit>| {
        !matches!(unit, Err(BadUnit { problem: UnitProblem::Unknown { .. }, .. }))
    };
    let cells = columns.iter().zip(row).filter(|(column, _)| of_number(column).is_some());
    let cells: Vec<&str> = cells.map(|(_, field)| field.of(text.as_str())).collect();
    let is_number = |cell: &&str| {
        let first = cell.split_whitespace().next();
        first.is_some_and(|first| first.parse::<f64>().is_ok())
    };
    let are_units = units.iter().all(is_known)
        || cells.iter().any(|cell| speaks_of_a_unit(cell)) && !cells.iter().any(is_number);
    (are_units && units.iter().any(is_stated)).then_some(units)
}

/// What the fields of a row are as headings.
fn headings(text: &Text, row: &[Field]) -> Vec<Option<(usize, Result<Unit, BadUnit>)>> {
    row.iter().map(|field| heading(field.of(text.as_str()))).collect()
}

/// Whether cells name the three moments, whatever follows the names.
fn has_moments(cells: &[String]) -> bool {
    let found: Vec<usize> = cells.iter().filter_map(|cell| Some(heading(cell)?.0)).collect();
    (0..3).all(|column| found.contains(&column))
}

/// Reads a row as a header, with the units in the row below it if that holds any: nothing if it has not
/// the columns of the three moments.
fn header(text: &Text, row: &[Field], below: Option<&[Field]>) -> Result<Option<Header>, Refusal> {
    let mut headings = headings(text, row);
    let is_certain = |unit: &Result<Unit, BadUnit>| !matches!(unit, Err(bad) if !bad.is_certain);
    let certain: Vec<usize> =
        headings.iter().flatten().filter(|(_, unit)| is_certain(unit)).map(|(c, _)| *c).collect();
    if !(0..3).all(|column| certain.contains(&column)) {
        return Ok(None);
    }
    // Beside a column of a number, its name with other words is another column.
    for found in &mut headings {
        found.take_if(|(column, unit)| !is_certain(unit) && certain.contains(column));
    }
    let of_fields: Vec<_> = headings.iter().map(|h| h.as_ref().map(|(c, _)| *c)).collect();
    let row_below = below;
    let below = below.and_then(|row| units_below(text, &of_fields, row));
    let mut columns = [None; FIELDS.len()];
    let (mut mass, mut inertia) = (SharedUnit::default(), SharedUnit::default());
    for (index, (field, found)) in row.iter().zip(headings).enumerate() {
        let Some((column, in_heading)) = found else { continue };
        let name = FIELDS[column];
        let refuse = |problem: String| text.malformed(field.start, problem);
        let heading = field.of(text.as_str());
        if column <= MASS && without_sign(heading).is_some() {
            let heading = shortened(heading);
            return Err(text.refuse(field.start, FileProblem::Sign { heading }));
        }
        let bad = |bad: BadUnit| refuse(bad.of(heading, name).to_string());
        let in_heading = in_heading.map_err(bad)?;
        let in_row = below.as_ref().and_then(|units| units.get(index).cloned());
        let in_row = in_row.unwrap_or(Ok(Unit::none())).map_err(bad)?;
        let its_unit = one_unit(in_heading, in_row).map_err(refuse)?;
        if columns[column].replace(index).is_some() && column != NAME {
            return Err(refuse(format!("two columns for {name}")));
        }
        let shared = match column {
            0..MASS => &mut inertia,
            MASS => &mut mass,
            NAME.. => continue,
        };
        shared.with(name, heading, its_unit).map_err(refuse)?;
    }
    let count = |of: std::ops::Range<usize>| columns[of].iter().flatten().count();
    let (above, below_diagonal) = (count(3..BELOW), count(BELOW..MASS));
    // The tensor is symmetric: each product may stand in either half.
    let is_there = |product: &usize| columns[*product].or(columns[*product + 3]).is_some();
    let products = (3..BELOW).filter(is_there).count();
    if above == 0 && products < 3 {
        let is_like = |field: &&Field| {
            let heading = field.of(text.as_str());
            !is_spread(heading) && would_change(heading).is_none() && is_unread_product(heading)
        };
        if let Some(field) = row.iter().find(is_like) {
            let heading = shortened(field.of(text.as_str()));
            return Err(text.refuse(field.start, FileProblem::Product { heading }));
        }
    }
    if products != 0 && products != 3 {
        let at = row.first().map_or(0, |field| field.start);
        return Err(text.malformed(at, "columns ixy, ixz, iyz: there must be all three or none"));
    }
    if ![products, 6].contains(&(above + below_diagonal)) {
        let at = row.first().map_or(0, |field| field.start);
        let message = "columns iyx, izx, izy: there must be all three or none beside ixy, ixz and iyz, or each product once";
        return Err(text.malformed(at, message));
    }
    if let Some((heading, other)) = SharedUnit::lacking(&[&mass, &inertia]) {
        let at = row.first().map_or(0, |field| field.start);
        return Err(text.refuse(at, FileProblem::NoUnit { heading, other }));
    }
    let units = below.and(row_below).map(<[Field]>::to_vec);
    let is_read = |at: usize| columns.contains(&Some(at));
    let others = row.iter().enumerate().filter(|(at, _)| !is_read(*at));
    let others: Vec<(usize, &str)> =
        others.map(|(at, field)| (at, field.of(text.as_str()))).collect();
    let unread = others.iter().filter_map(|(at, heading)| Some((*at, would_change(heading)?)));
    let unread = unread.collect();
    let below = |at: usize| Some(*units.as_ref()?.get(at)?);
    let centre = others.iter().filter_map(|(at, heading)| Some((*at, TenHeading::of(heading)?)));
    let centre = centre.filter_map(|(at, heading)| CentreColumn::of(text, heading, below(at)));
    let terms =
        terms(mass.si(), inertia.si(), columns[MASS].is_some(), &centre.collect::<Vec<_>>());
    let header = Header { row: row.to_vec(), columns, mass, inertia, units, unread, terms };
    let units = header.units.as_deref().unwrap_or_default();
    match header.problem(text, units, Unread::problem_in_units) {
        Some((field, error)) => Err(text.malformed(field.start, error)),
        None => Ok(Some(header)),
    }
}

/// A column of the mass centre or of first moments, and its unit.
struct CentreColumn {
    place: usize,
    kind: TenCentre,
    unit: Unit,
}

impl CentreColumn {
    /// By its heading and what stands in the row of units below; nothing of another column, or if its unit is not read.
    fn of(text: &Text, heading: TenHeading, below: Option<Field>) -> Option<Self> {
        let (place, kind) = (heading.place, heading.centre?);
        let below =
            below.map_or(Ok(Unit::none()), |cell| unit_below(text, &cell, kind.dimension()));
        let unit = one_unit(heading.unit.ok()?, below.ok()?).ok()?;
        Some(Self { place, kind, unit })
    }
}

/// What the columns say of all rows. By a mass, three first moments and no mass centre, the inertia is about the origin.
fn terms(mass_kg: f64, inertia_kg_m2: f64, has_mass: bool, centre: &[CentreColumn]) -> TableTerms {
    // A column that states no unit is in that of the others.
    let stated: Vec<&CentreColumn> =
        centre.iter().filter(|column| !column.unit.text.is_empty()).collect();
    let all: Vec<&CentreColumn> = if stated.is_empty() { centre.iter().collect() } else { stated };
    let centres = all.iter().map(|column| (column.kind.dimension(), column.unit.si));
    let units = [(Dimension::Mass, mass_kg), (Dimension::Inertia, inertia_kg_m2)].into_iter();
    let are_moments = centre.iter().all(|column| column.kind == TenCentre::FirstMoments);
    let is_there = |place: usize| centre.iter().any(|column| column.place == place);
    let point = if has_mass && are_moments && (1..=3).all(is_there) {
        InertiaPoint::Origin
    } else {
        InertiaPoint::MassCentre
    };
    TableTerms::new(units.chain(centres), point)
}

/// Why a row is no header, where it would be one if what follows the names of the moments were units.
fn nearly(text: &Text, row: &[Field]) -> Option<String> {
    let headings = headings(text, row);
    let is_there = |column: usize| headings.iter().flatten().any(|(c, _)| *c == column);
    (0..3).all(is_there).then_some(())?;
    let mut pairs = row.iter().zip(&headings);
    pairs.find_map(|(field, found)| match found {
        Some((column, Err(bad))) => {
            let name = FIELDS[*column];
            Some(bad.clone().of(field.of(text.as_str()), name).to_string())
        }
        Some((_, Ok(_))) | None => None,
    })
}

/// Finds the header, below any titles: what it says, and the rows below it. Where there is none, it may be a
/// comment, as many programs write it.
pub(crate) fn find_header(text: &Text) -> Result<(Header, Rows<'_>), Refusal> {
    let rows = || headers(text.as_str());
    for (at, line) in rows().chain(commented_headers(text.as_str())) {
        if let Some(found) = header_at(text, at, line)? {
            let some_lack = found.0.mass.is_lacking() || found.0.inertia.is_lacking();
            title_units::refused(text, at, some_lack)?;
            title_point::refused(text, at, found.0.terms.point())?;
            return Ok(found);
        }
    }
    let near =
        rows().find_map(|(at, line)| nearly(text, &Rows::at(text.as_str(), at, line).row().ok()?));
    let mut message = "a table must have the columns ixx, iyy and izz".to_owned();
    if let Some(near) = near {
        message = format!("{message}: {near}");
    }
    Err(FileProblem::Unknown { message }.into())
}

/// The header in a line that starts at an offset, and the rows below it, if it is one.
fn header_at<'t>(
    text: &'t Text,
    at: usize,
    line: &str,
) -> Result<Option<(Header, Rows<'t>)>, Refusal> {
    let mut rows = Rows::at(text.as_str(), at, line);
    let row = match rows.row() {
        Ok(row) => row,
        Err(error) if without_marks(line).any(|cells| has_moments(&cells)) => {
            return Err(error.of(text));
        }
        // In a title, a quotation mark is no more than that.
        Err(_) => return Ok(None),
    };
    let mut below = rows.clone();
    let next = below.next().and_then(Result::ok);
    let header = header(text, &row, next.as_deref())?;
    Ok(header.map(|header| if header.units.is_some() { (header, below) } else { (header, rows) }))
}
