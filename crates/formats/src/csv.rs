//! Tables: one body a row, under a header that names the six entries.
//!
//! Read by hand, because a copy that changes single numbers needs the place of each field.

use crate::{
    Body, BodyError, FileProblem, MAX_BODIES, Products,
    body::{NAMES, Number, Reading},
    error::Refusal,
    products_comment::stated_products,
    text::Text,
};

/// Columns that are looked for: the six entries, the mass, the name.
const MASS: usize = 6;
const NAME: usize = 7;
const FIELDS: [&str; 7] = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz", "mass"];

/// Where a field stands, its quotes not counted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field {
    pub(crate) start: usize,
    pub(crate) end: usize,
}

#[derive(Debug)]
pub(crate) struct Rows<'a> {
    text: &'a str,
    at: usize,
    separator: u8,
}

impl<'a> Rows<'a> {
    /// The rows of a text from its beginning, where the first of them tells the separator.
    pub(crate) fn new(text: &'a str) -> Self {
        let first = text.lines().find(|line| !is_comment(line)).unwrap_or_default();
        Self { text, at: 0, separator: separator(first) as u8 }
    }
    /// The fields of the next row that is neither blank nor a comment, or the offset of a quote
    /// that is never closed.
    pub(crate) fn next(&mut self) -> Option<Result<Vec<Field>, usize>> {
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
pub(crate) fn mass_unit(unit: &str) -> Option<f64> {
    if unit.is_empty() {
        return Some(1.0);
    }
    MASSES.iter().find(|(name, _)| *name == unit).map(|(_, kg)| *kg)
}

/// What a unit of inertia is in kg·m²; kg·m² where none is stated.
pub(crate) fn inertia_unit(unit: &str) -> Option<f64> {
    if unit.is_empty() {
        return Some(1.0);
    }
    MASSES.iter().find_map(|(mass, kg)| {
        let rest = unit.strip_prefix(mass)?;
        let (_, m2) = AREAS.iter().find(|(area, _)| *area == rest)?;
        Some(kg * m2)
    })
}

/// What a unit of length is in m; m where none is stated.
pub(crate) fn length_unit(unit: &str) -> Option<f64> {
    if unit.is_empty() {
        return Some(1.0);
    }
    let area = AREAS.iter().find(|(area, _)| area.strip_suffix('2') == Some(unit));
    area.map(|(_, m2)| m2.sqrt())
}

/// What may stand between the letters of a name or a unit. The question mark is a square in an
/// encoding other than UTF-8.
fn is_between(c: char) -> bool {
    c.is_whitespace() || "_-*·⋅×^.()[]{}\"".contains(c)
}

/// A text without them: `Ixx [kg·m²]` becomes `ixxkgm2`.
pub(crate) fn squeezed(text: &str) -> String {
    // A capital M is a million: Mg is a tonne, and no milligram.
    let plain = text.replace("Mg", "t").to_lowercase().replace(['²', '?'], "2");
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

/// The units in a row below a header, none where a field is empty: nothing if one of the fields that count
/// is no unit, or all of them are empty.
fn units_below(text: &Text, columns: &[Option<usize>], row: &[Field]) -> Option<Vec<String>> {
    let units: Vec<_> = row
        .iter()
        .map(|field| squeezed(text.as_str().get(field.start..field.end).unwrap_or_default()))
        .collect();
    let counts = |(column, unit): (&Option<usize>, &String)| match column {
        Some(NAME) | None => None,
        Some(column) => Some(unit.is_empty() || is_unit(*column, unit)),
    };
    let some =
        columns.iter().zip(&units).any(|(c, u)| c.is_some_and(|c| c < MASS) && !u.is_empty());
    let all = columns.iter().zip(&units).filter_map(counts).all(|unit| unit);
    (row.len() == columns.len() && some && all).then_some(units)
}

/// Reads a row as a header, with the units in the row below it if that holds any: nothing if it has not
/// the columns of the three moments. Returns whether the row below belongs to it.
fn header(
    text: &Text,
    row: &[Field],
    below: Option<&[Field]>,
) -> Result<Option<(Header, bool)>, Refusal> {
    let written = |field: &Field| text.as_str().get(field.start..field.end).unwrap_or_default();
    let headings: Vec<_> = row.iter().map(|field| heading(written(field))).collect();
    let is_there = |column: usize| headings.iter().flatten().any(|(c, _)| *c == column);
    if !(0..3).all(is_there) {
        return Ok(None);
    }
    let of_fields: Vec<_> = headings.iter().map(|h| h.as_ref().map(|(c, _)| *c)).collect();
    let below = below.and_then(|row| units_below(text, &of_fields, row));
    let mut columns = [None; 8];
    let mut unit: Option<(&str, String)> = None;
    let (mut mass_kg, mut inertia_kg_m2) = (1.0, 1.0);
    for (index, (field, found)) in row.iter().zip(headings).enumerate() {
        let Some((column, in_heading)) = found else { continue };
        let in_row = below.as_ref().map_or("", |units| units[index].as_str());
        if !in_heading.is_empty() && !in_row.is_empty() && in_heading != in_row {
            let problem = format!("the header says {in_heading}, and the row below it {in_row}");
            return Err(text.malformed(field.start, problem));
        }
        let its_unit = if in_heading.is_empty() { in_row.to_owned() } else { in_heading };
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
    let header = Header { columns, width: row.len(), mass_kg, inertia_kg_m2 };
    Ok(Some((header, below.is_some())))
}

fn is_comment(line: &str) -> bool {
    line.starts_with('#') || line.trim().is_empty()
}

/// What there is most of in a header; a comma where nothing is.
fn separator(header: &str) -> char {
    let count = |separator: char| header.matches(separator).count();
    [',', ';', '\t'].into_iter().max_by_key(|s| (count(*s), *s == ',')).unwrap_or(',')
}

/// Most lines above a header, titles and the like, that are looked through for it.
const TITLES: usize = 100;

/// Finds the header, below any titles: where it starts, what it says, and the rows below it. Where there
/// is none, it may be a comment, as many programs write it.
fn find_header(text: &Text) -> Result<(usize, Header, Rows<'_>), Refusal> {
    let lines = || {
        let mut at = 0;
        text.as_str().split_inclusive('\n').map(move |line| {
            at += line.len();
            (at - line.len(), line)
        })
    };
    for (at, line) in lines().filter(|(_, line)| !is_comment(line)).take(TITLES) {
        if let Some((header, rows)) = header_at(text, at, line)? {
            return Ok((at, header, rows));
        }
    }
    for (at, line) in lines().filter(|(_, line)| line.starts_with('#')).take(TITLES) {
        let content = line.trim_start_matches(['#', ' ', '\t']);
        let start = at + line.len() - content.len();
        if let Some((header, rows)) = header_at(text, start, content)? {
            return Ok((at, header, rows));
        }
    }
    Err(unknown("a table must have the columns ixx, iyy and izz"))
}

/// The header in a line that starts at an offset, and the rows below it, if it is one.
fn header_at<'t>(
    text: &'t Text,
    at: usize,
    line: &str,
) -> Result<Option<(Header, Rows<'t>)>, Refusal> {
    let mut rows = Rows { text: text.as_str(), at, separator: separator(line) as u8 };
    // In a title, a quotation mark is no more than that.
    let Ok(row) = rows.row() else { return Ok(None) };
    let mut below = Rows { ..rows };
    let next = below.next().and_then(Result::ok);
    Ok(match header(text, &row, next.as_deref())? {
        Some((header, true)) => Some((header, below)),
        Some((header, false)) => Some((header, rows)),
        None => None,
    })
}

pub(crate) fn read(text: &Text, default: Products) -> Result<Vec<Body>, Refusal> {
    let source = text.as_str();
    let unclosed = |at| text.malformed(at, "a quotation mark is not closed");
    let (start, header, mut rows) = find_header(text)?;
    let products = stated_products(text, start)?.unwrap_or(default);

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

    /// Every separator, with the units in the header, in a row below it, or in both, and a header that is a
    /// comment: the same bodies, in the same places of the file.
    #[test]
    fn units_stand_below_and_headers_are_comments() {
        let units = [("", "", 1.0, 1.0), ("kg", "kg m^2", 1.0, 1.0), ("g", "g·mm²", 1e-3, 1e-9)];
        let mut count = 0;
        for (mass, inertia, kg, kg_m2) in units {
            for (separator, comment, bracket, place, title) in
                [",", ";", "\t"].iter().flat_map(|s| {
                    ["", "#", "# "].iter().flat_map(move |c| {
                        [("", ""), ("[", "]"), ("(", ")")].iter().flat_map(move |b| {
                            (0..3).flat_map(move |p| {
                                ["", "Table 3\n", "# made by hand\n"].map(|t| (s, c, b, p, t))
                            })
                        })
                    })
                })
            {
                let unit = |unit: &str, there: bool| {
                    let there = there && !unit.is_empty();
                    if there { format!("{}{unit}{}", bracket.0, bracket.1) } else { String::new() }
                };
                let row = |cells: [String; 6]| cells.join(separator) + "\n";
                let names = ["part", "mass", "ixx", "note", "iyy", "izz"];
                let of = |name: &str| match name {
                    "mass" => mass,
                    "part" | "note" => "",
                    _ => inertia,
                };
                let above = row(
                    names.map(|n| format!("{n} {}", unit(of(n), place != 1)).trim().to_owned())
                );
                let below = row(names.map(|n| unit(of(n), place != 0)));
                let below = if place == 0 || mass.is_empty() { String::new() } else { below };
                let data = ["arm", "2", "3", "x", "4", "5"].map(str::to_owned);
                let text = format!("{title}{comment}{above}{below}{}", row(data));
                let bodies = try_read(&text).unwrap_or_else(|e| panic!("{text}{e:?}"));
                assert_eq!(bodies.len(), 1, "{text}");
                assert_eq!(bodies[0].line(), text.lines().count(), "{text}");
                let found = six(&bodies[0]);
                assert!((found[0] / (3.0 * kg_m2) - 1.0).abs() < 1e-12, "{text}{found:?}");
                assert_eq!(
                    (bodies[0].name(), bodies[0].mass_kg()),
                    ("arm", Some(2.0 * kg)),
                    "{text}"
                );
                count += 1;
            }
        }
        assert_eq!(count, 3 * 243);
        // A row that is no units is a row; one that contradicts the header is refused.
        let bodies = try_read("ixx,iyy,izz\nkg m2,furlongs,kg m2\n1,2,3").unwrap();
        assert!(bodies.len() == 2 && bodies[0].inertia().is_err());
        let message = |csv| try_read(csv).unwrap_err().problem.to_string();
        let both = message("ixx [kg m2],iyy,izz\ng mm2,,\n1,2,3");
        assert!(both.contains("the header says kgm2, and the row below it gmm2"), "{both}");
        assert!(message("# ixx,iyy,izz,Ixx\n1,2,3,4").contains("two columns for ixx"));
        assert!(message("# ixx and iyy\n1,2,3").contains("columns ixx, iyy and izz"));
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
