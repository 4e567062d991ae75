//! Tables: one body a row, under a header that names the six entries.
//!
//! Read by hand, because a copy that changes single numbers needs the place of each field.

use crate::{
    Body, BodyError, FileProblem, MAX_BODIES, Products,
    body::{NAMES, Number, Reading},
    text::{Refusal, Text},
};

/// Columns that are looked for: the six entries, the mass, the name.
const MASS: usize = 6;
const NAME: usize = 7;
const FIELDS: [&str; 7] = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz", "mass"];

/// Where a field stands, its quotes not counted.
#[derive(Clone, Copy, Debug)]
struct Field {
    start: usize,
    end: usize,
}

#[derive(Debug)]
struct Rows<'a> {
    text: &'a str,
    at: usize,
    separator: u8,
}

impl Rows<'_> {
    /// The fields of the next row that is neither blank nor a comment, or the offset of a quote
    /// that is never closed.
    fn next(&mut self) -> Option<Result<Vec<Field>, usize>> {
        loop {
            let rest = &self.text[self.at..];
            let line = rest.split('\n').next()?;
            if rest.is_empty() {
                return None;
            }
            if line.trim().is_empty() || line.starts_with('#') {
                self.at = (self.at + line.len() + 1).min(self.text.len());
                continue;
            }
            return Some(self.row());
        }
    }

    fn row(&mut self) -> Result<Vec<Field>, usize> {
        let bytes = self.text.as_bytes();
        let mut fields = Vec::new();
        loop {
            while bytes.get(self.at) == Some(&b' ') {
                self.at += 1;
            }
            let (start, end);
            if bytes.get(self.at) == Some(&b'"') {
                start = self.at + 1;
                let mut i = start;
                loop {
                    match (bytes.get(i), bytes.get(i + 1)) {
                        (Some(b'"'), Some(b'"')) => i += 2,
                        (Some(b'"'), _) => break,
                        (Some(_), _) => i += 1,
                        (None, _) => return Err(self.at),
                    }
                }
                end = i;
                self.at = i + 1;
                while !self.at_end_of_field() {
                    self.at += 1;
                }
            } else {
                start = self.at;
                while !self.at_end_of_field() {
                    self.at += 1;
                }
                end = self.at;
            }
            fields.push(Field { start, end });
            match bytes.get(self.at) {
                Some(b) if *b == self.separator => self.at += 1,
                Some(_) => {
                    self.at += 1;
                    return Ok(fields);
                }
                None => return Ok(fields),
            }
        }
    }

    fn at_end_of_field(&self) -> bool {
        self.text.as_bytes().get(self.at).is_none_or(|b| *b == b'\n' || *b == self.separator)
    }
}

/// Units of mass, and what they are in kg.
const MASSES: [(&str, f64); 7] = [
    ("kg", 1.0),
    ("g", 1e-3),
    ("mg", 1e-6),
    ("t", 1e3),
    ("lb", 0.453_592_37),
    ("lbm", 0.453_592_37),
    ("slug", 14.593_902_937_206_36),
];

/// Units of length, squared, and what their squares are in m².
const AREAS: [(&str, f64); 5] =
    [("m2", 1.0), ("cm2", 1e-4), ("mm2", 1e-6), ("in2", 6.4516e-4), ("ft2", 0.092_903_04)];

/// What a unit of mass is in kg; kg where none is stated.
fn mass_unit(unit: &str) -> Option<f64> {
    if unit.is_empty() {
        return Some(1.0);
    }
    MASSES.iter().find(|(name, _)| *name == unit).map(|(_, kg)| *kg)
}

/// What a unit of inertia is in kg·m²; kg·m² where none is stated.
fn inertia_unit(unit: &str) -> Option<f64> {
    if unit.is_empty() {
        return Some(1.0);
    }
    MASSES.iter().find_map(|(mass, kg)| {
        let rest = unit.strip_prefix(mass)?;
        let (_, m2) = AREAS.iter().find(|(area, _)| *area == rest)?;
        Some(kg * m2)
    })
}

/// What may stand between the letters of a name or a unit. The question mark is a square in an
/// encoding other than UTF-8.
fn is_between(c: char) -> bool {
    c.is_whitespace() || "_-*·⋅×^.()[]{}\"".contains(c)
}

/// A text without them: `Ixx [kg·m²]` becomes `ixxkgm2`.
fn squeezed(text: &str) -> String {
    let plain = text.to_lowercase().replace(['²', '?'], "2");
    plain.chars().filter(|c| !is_between(*c)).collect()
}

/// The column of a heading, and the unit that follows its name, after a bracket, a slash or nothing.
/// What is marked by nothing and is no unit makes another column of it: `ixx_sigma`.
fn heading(text: &str) -> Option<(usize, String)> {
    // Longer texts are none, and would be searched for names for long.
    if text.len() > 200 {
        return None;
    }
    if let Some(column) = column_of(&squeezed(text)) {
        return Some((column, String::new()));
    }
    // The longest name that may stand before a unit, which ends with its last letter.
    let ends = text.char_indices().rev().map(|(at, _)| at);
    let (column, rest) = ends.map(|at| text.split_at(at)).find_map(|(name, rest)| {
        let column = column_of(&squeezed(name)).filter(|column| *column != NAME)?;
        name.ends_with(char::is_alphanumeric).then_some(())?;
        // A letter that a word begins with is not the mass.
        let is_word =
            column == MASS && squeezed(name).len() == 1 && rest.starts_with(char::is_alphabetic);
        (!is_word).then_some((column, rest))
    })?;
    const MARKS: [char; 8] = ['[', '(', '{', '/', ',', ':', ';', '='];
    let rest = rest.trim_start_matches(|c| is_between(c) && !MARKS.contains(&c));
    let unit = squeezed(rest.trim_start_matches(MARKS));
    let unit = match unit.strip_prefix("in").filter(|unit| is_unit(column, unit)) {
        Some(unit) => unit.to_owned(),
        None => unit,
    };
    (rest.starts_with(MARKS) || is_unit(column, &unit)).then_some((column, unit))
}

fn is_unit(column: usize, unit: &str) -> bool {
    if column == MASS { mass_unit(unit).is_some() } else { inertia_unit(unit).is_some() }
}

/// The column of a heading.
pub(crate) fn entry_of(name: &str) -> Option<usize> {
    let plain = match name {
        "i11" => "ixx",
        "i22" => "iyy",
        "i33" => "izz",
        "i12" => "ixy",
        "i13" => "ixz",
        "i23" => "iyz",
        other => other,
    };
    NAMES.iter().position(|known| *known == plain)
}

fn column_of(name: &str) -> Option<usize> {
    match name {
        "mass" | "m" => Some(MASS),
        "name" | "body" | "link" | "part" | "component" => Some(NAME),
        _ => entry_of(name),
    }
}

fn unknown(message: &str) -> Refusal {
    FileProblem::Unknown { message: message.to_owned() }.into()
}

/// What a header says of the rows below it.
#[derive(Debug)]
struct Header {
    /// The column of each of the fields, and of the name.
    columns: [Option<usize>; 8],
    width: usize,
    mass_kg: f64,
    inertia_kg_m2: f64,
}

/// Reads a row as a header: nothing if it has not the columns of the three moments.
fn header(text: &Text, row: &[Field]) -> Result<Option<Header>, Refusal> {
    let written = |field: &Field| text.as_str().get(field.start..field.end).unwrap_or_default();
    let headings: Vec<_> = row.iter().map(|field| heading(written(field))).collect();
    let is_there = |column: usize| headings.iter().flatten().any(|(c, _)| *c == column);
    if !(0..3).all(is_there) {
        return Ok(None);
    }
    let mut columns = [None; 8];
    let mut unit: Option<(&str, String)> = None;
    let (mut mass_kg, mut inertia_kg_m2) = (1.0, 1.0);
    for (index, (field, found)) in row.iter().zip(headings).enumerate() {
        let Some((column, its_unit)) = found else { continue };
        let name = FIELDS.get(column).copied().unwrap_or("name");
        if columns[column].replace(index).is_some() && column != NAME {
            return Err(text.malformed(field.start, format!("two columns for {name}")));
        }
        if column == MASS {
            mass_kg = mass_unit(&its_unit).ok_or_else(|| {
                let known = MASSES.map(|(name, _)| name).join(", ");
                text.malformed(field.start, format!("mass is in {its_unit}: it must be in {known}"))
            })?;
        }
        if column < MASS && !its_unit.is_empty() {
            inertia_kg_m2 = inertia_unit(&its_unit).ok_or_else(|| {
                let masses = MASSES.map(|(name, _)| name).join(", ");
                let areas = AREAS.map(|(name, _)| name).join(", ");
                text.malformed(
                    field.start,
                    format!("{name} is in {its_unit}: it must be in {masses} times {areas}"),
                )
            })?;
            match &unit {
                Some((first, known)) if *known != its_unit => {
                    return Err(text.malformed(
                        field.start,
                        format!("{first} is in {known} but {name} in {its_unit}: one unit for all"),
                    ));
                }
                Some(_) => {}
                None => unit = Some((name, its_unit)),
            }
        }
    }
    let products = columns[3..6].iter().flatten().count();
    if products != 0 && products != 3 {
        let at = row.first().map_or(0, |field| field.start);
        return Err(text.malformed(at, "columns ixy, ixz, iyz: there must be all three or none"));
    }
    Ok(Some(Header { columns, width: row.len(), mass_kg, inertia_kg_m2 }))
}

fn is_comment(line: &str) -> bool {
    line.starts_with('#') || line.trim().is_empty()
}

/// What a comment above the header, which ends at `end`, says of the products: `# products = integrals`.
fn stated_products(source: &str, end: usize) -> Option<Products> {
    let comments = source.get(..end)?.lines().filter_map(|line| line.strip_prefix('#'));
    let stated = comments.filter_map(|comment| comment.trim_start().strip_prefix("products"));
    stated
        .filter_map(|rest| rest.split(['=', ' ', ',', '"', '\'']).find_map(Products::parse))
        .next_back()
}

/// What there is most of in a header; a comma where nothing is.
fn separator(header: &str) -> char {
    let count = |separator: char| header.matches(separator).count();
    [',', ';', '\t'].into_iter().max_by_key(|s| (count(*s), *s == ',')).unwrap_or(',')
}

/// Most lines above a header, titles and the like, that are looked through for it.
const TITLES: usize = 100;

/// Finds the header, below any titles: where it starts, what it says, and the rows below it.
fn find_header(text: &Text) -> Result<(usize, Header, Rows<'_>), Refusal> {
    let source = text.as_str();
    let mut at = 0;
    let lines = source.split_inclusive('\n').map(|line| {
        at += line.len();
        (at - line.len(), line)
    });
    for (at, line) in lines.filter(|(_, line)| !is_comment(line)).take(TITLES) {
        let mut rows = Rows { text: source, at, separator: separator(line) as u8 };
        // In a title, a quotation mark is no more than that.
        if let Ok(row) = rows.row()
            && let Some(header) = header(text, &row)?
        {
            return Ok((at, header, rows));
        }
    }
    Err(unknown("a table must have the columns ixx, iyy and izz"))
}

pub(crate) fn read(text: &Text, default: Products) -> Result<Vec<Body>, Refusal> {
    let source = text.as_str();
    let unclosed = |at| text.malformed(at, "a quotation mark is not closed");
    let (start, header, mut rows) = find_header(text)?;
    let products = stated_products(source, start).unwrap_or(default);

    let mut bodies = Vec::new();
    while let Some(row) = rows.next() {
        let row = row.map_err(unclosed)?;
        let line = text.line(row.first().map_or(0, |field| field.start));
        if bodies.len() == MAX_BODIES {
            return Err(Refusal { line: Some(line), problem: FileProblem::TooManyBodies });
        }
        let cell = |column: usize| {
            let field = row.get(header.columns[column]?)?;
            Some((source.get(field.start..field.end)?, field.start))
        };
        let name =
            cell(NAME).map_or_else(String::new, |(name, _)| name.trim().replace("\"\"", "\""));
        let reading = if row.len() == header.width {
            reading(cell, products)
                .map(|reading| reading.in_units(header.mass_kg, header.inertia_kg_m2))
        } else {
            let (found, allowed) = (row.len(), header.width);
            Err(BodyError::Count { field: "the row", found, allowed })
        };
        bodies.push(Body::new(name, line, reading));
    }
    Ok(bodies)
}

fn reading<'a>(
    cell: impl Fn(usize) -> Option<(&'a str, usize)>,
    products: Products,
) -> Result<Reading, BodyError> {
    let number = |column: usize| {
        let (raw, start) = cell(column)?;
        Some(Number::parse(FIELDS[column], raw, Some(start)))
    };
    // A table may know the mass of some bodies only.
    let mass = match cell(MASS) {
        Some((raw, _)) if raw.trim().is_empty() => None,
        _ => number(MASS).transpose()?,
    };
    let mut six = [Number::default(); 6];
    for (column, entry) in six.iter_mut().enumerate() {
        if let Some(found) = number(column) {
            *entry = found?;
        }
    }
    Ok(Reading::of_six(mass, &six, products))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::ENTRIES;

    fn try_read(csv: &str) -> Result<Vec<Body>, Refusal> {
        read(&Text::new(csv.as_bytes(), true).unwrap(), Products::TensorEntries)
    }

    fn six(body: &Body) -> [f64; 6] {
        ENTRIES.map(|entry| body.inertia().unwrap()[entry])
    }

    #[test]
    fn columns_may_stand_in_any_order_case_and_spelling() {
        let expected = [10.0, 11.0, 12.0, 0.1, 0.2, 0.3];
        for csv in [
            "name,mass,ixx,iyy,izz,ixy,ixz,iyz\narm,2,10,11,12,.1,.2,.3\n",
            "IZZ;Iyz;I_xx;Body;Mass [kg];Iyy;Ixy;Ixz\r\n12;.3;10;arm;2;11;.1;.2\r\n",
            "# a comment\n\ni11\ti22\ti33\ti12\ti13\ti23\tpart\tm\n10\t11\t12\t.1\t.2\t.3\tarm\t2",
            "\"name\",mass_kg,ixx_kg_m2,iyy_kg_m2,izz_kg_m2,ixy_kg_m2,ixz_kg_m2,iyz_kg_m2\n\
             \"arm\", \"2\",10,11,12,\".1\",.2,.3",
            "Part,Mass (kg),Ixx [kg m^2],Iyy [kg*m2],Izz [kg·m²],Ixy [kg m2],Ixz,Iyz,note\n\
             arm,2,10,11,12,.1,.2,.3,\"a, b\nc\"",
        ] {
            let bodies = try_read(csv).unwrap();
            assert_eq!(bodies.len(), 1, "{csv}");
            assert_eq!(six(&bodies[0]), expected, "{csv}");
            assert_eq!((bodies[0].name(), bodies[0].mass_kg()), ("arm", Some(2.0)), "{csv}");
        }
    }

    #[test]
    fn moments_alone_are_a_diagonal_and_a_comment_may_state_the_sign() {
        let bodies = try_read("ixx,iyy,izz\n1,2,3\n\n4,5,6").unwrap();
        assert_eq!(six(&bodies[1]), [4.0, 5.0, 6.0, 0.0, 0.0, 0.0]);
        assert_eq!((bodies[1].line(), bodies[1].name(), bodies[1].mass_kg()), (4, "", None));
        let csv =
            "# products = integrals, not tensor entries\nixx,iyy,izz,ixy,ixz,iyz\n1,2,3,.1,.2,.3";
        assert_eq!(six(&try_read(csv).unwrap()[0])[3..], [-0.1, -0.2, -0.3]);
    }

    /// They were called kg·m² whatever the header said.
    #[test]
    fn other_units_become_kilograms_and_metres() {
        for (heading, mass, inertia) in [
            ("mass [g],Ixx [g*mm^2],iyy,izz", 1e-3, 1e-9),
            ("mass (lb),Ixx (lb in²),Iyy (lb·in2),Izz (lb in^2)", 0.45359237, 2.926396534292e-4),
            ("mass,Ixx (slug ft2),iyy,izz", 1.0, 1.3558179483314),
            ("m [t],ixx [t cm2],iyy,izz", 1e3, 0.1),
        ] {
            let bodies = try_read(&format!("{heading}\n2,3,4,5")).unwrap();
            let found = six(&bodies[0])[0] / (3.0 * inertia) - 1.0;
            assert!(found.abs() < 1e-12, "{heading}: {found:e}");
            assert_eq!(bodies[0].mass_kg(), Some(2.0 * mass), "{heading}");
        }
        let latin = Text::new(b"ixx [kg m\xb2],iyy,izz\n1,2,3", true).unwrap();
        assert!(read(&latin, Products::TensorEntries).is_ok());
    }

    #[test]
    fn bad_tables_are_refused_and_bad_rows_named() {
        let message = |csv| try_read(csv).unwrap_err().problem.to_string();
        assert!(message("time,x\n1,2").contains("columns ixx"));
        assert!(message("ixx,iyy,izz,ixy\n1,2,3,4").contains("all three or none"));
        assert!(message("ixx,iyy,izz,Ixx\n1,2,3,4").contains("two columns for ixx"));
        let mixed = message("ixx [kg m2],iyy [g mm2],izz\n1,2,3");
        assert!(mixed.contains("ixx is in kgm2 but iyy in gmm2"), "{mixed}");
        let odd = message("ixx [kg m2/s],iyy,izz\n1,2,3");
        assert!(odd.contains("ixx is in kgm2/s: it must be in kg, g"), "{odd}");
        assert!(message("mass [N],ixx,iyy,izz\n1,1,2,3").contains("mass is in n: it must be in"));
        assert!(message("ixx,iyy,izz\n1,2,\"3").contains("not closed"));
        let bodies = try_read("name,ixx,iyy,izz\na,1,2\nb,1,x,3\nc,1,1,1").unwrap();
        let error = |i: usize| bodies[i].inertia().unwrap_err().to_string();
        assert_eq!(error(0), "the row has 3 values: there must be 4");
        assert_eq!(error(1), "iyy = \"x\" is not a number");
        assert!(bodies[2].inertia().is_ok());
    }
}
