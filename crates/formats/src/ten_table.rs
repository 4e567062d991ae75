//! Tables of mass, mass centre and inertia: ten numbers a row.

use crate::{
    BodyError, MAX_BODIES, Products,
    body::Number,
    parts::heading::{Column, Heading, VALUES},
    products_comment::stated_products,
    rows::{Field, Rows},
    text::Text,
    units::squeezed,
};

/// A table with columns of mass, mass centre (or first moments) and inertia.
///
/// ```
/// use gyradius_formats::{Products, TenTable};
///
/// let table = "mass_kg,cx_mm,cy_mm,cz_mm,ixx,iyy,izz\n2,0,0,100,0.1,0.1,0.1\n";
/// let table = TenTable::read(table.as_bytes(), Products::TensorEntries).unwrap();
/// assert_eq!(table.rows()[0].values().unwrap()[3], 0.1);
/// assert!(TenTable::read(b"ixx,iyy,izz\n1,1,1\n", Products::TensorEntries).is_none());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TenTable {
    rows: Vec<TenRow>,
    has_first_moments: bool,
}

/// A row of such a table.
#[derive(Clone, Debug, PartialEq)]
pub struct TenRow {
    line: usize,
    values: Result<[f64; 10], BodyError>,
}

impl TenTable {
    /// The table, if the first row is a header with mass, the three of the mass centre or of the first moments, and the three moments of
    /// inertia, and if it can be read as one; none of any other file.
    #[must_use]
    pub fn read(bytes: &[u8], products: Products) -> Option<Self> {
        let text = Text::new(bytes, true).ok()?;
        let mut rows = Rows::new(text.as_str());
        let first = rows.next()?.ok()?;
        let cell = |field: &Field| field.of(text.as_str());
        let headings: Vec<Heading> = first.iter().map(|field| Heading::of(cell(field))).collect();
        let bad_units = headings.iter().filter_map(|heading| heading.bad_unit(&headings));
        if bad_units.into_iter().any(|(field, _)| VALUES.contains(&field))
            || headings.iter().any(|heading| heading.is_lost_product(&headings))
        {
            return None;
        }
        let pairs = first.iter().zip(&headings);
        let columns: Vec<Option<(usize, f64, bool)>> =
            pairs.map(|(field, heading)| column(cell(field), heading)).collect();
        let place = |value: usize| columns.iter().position(|c| c.is_some_and(|c| c.0 == value));
        let places: [Option<usize>; 10] = std::array::from_fn(place);
        let twice =
            (0..10).any(|i| columns.iter().flatten().filter(|(value, ..)| *value == i).count() > 1);
        if twice || places[..7].contains(&None) {
            return None;
        }
        let has_first_moments = columns.iter().flatten().any(|(.., first_moment)| *first_moment);
        let start = first.first().map_or(0, |field| field.start);
        let sign = stated_products(&text, start).ok()?.unwrap_or(products).sign();
        let mut found = Vec::new();
        while let Some(fields) = rows.next() {
            let fields = fields.ok()?;
            if found.len() == MAX_BODIES {
                return None;
            }
            let value = |i: usize| -> Result<f64, BodyError> {
                let Some(place) = places[i] else { return Ok(0.0) };
                let field = fields.get(place).ok_or(BodyError::Missing { field: VALUES[i] })?;
                let unit = columns[place].map_or(1.0, |(_, unit, _)| unit);
                let sign = if i < 7 { 1.0 } else { sign };
                Ok(Number::parse(VALUES[i], cell(field), None)?.value * unit * sign)
            };
            let mut values = [0.0; 10];
            let read = (0..10).try_for_each(|i| {
                values[i] = value(i)?;
                Ok(())
            });
            let line = text.line(fields.first().map_or(0, |field| field.start));
            found.push(TenRow { line, values: read.map(|()| values) });
        }
        // Below a header whose units are in a row of their own nothing is read as in SI.
        let is_unit = |row: &TenRow| matches!(row.values, Err(BodyError::NotANumber { .. }));
        if found.len() > 1 && is_unit(&found[0]) && found[1..].iter().any(|row| row.values.is_ok())
        {
            return None;
        }
        Some(Self { rows: found, has_first_moments })
    }

    /// The rows, in the order of the file.
    #[must_use]
    pub fn rows(&self) -> &[TenRow] {
        &self.rows
    }

    /// Whether the header says m c in place of the mass centre.
    #[must_use]
    pub fn has_first_moments(&self) -> bool {
        self.has_first_moments
    }
}

impl TenRow {
    /// Line, from 1.
    #[must_use]
    pub fn line(&self) -> usize {
        self.line
    }

    /// Mass, mass centre or first moments, I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in SI, products as tensor entries.
    ///
    /// # Errors
    /// A cell holds no number.
    pub fn values(&self) -> Result<&[f64; 10], &BodyError> {
        self.values.as_ref()
    }
}

/// Which of the ten, its unit in SI, and whether it is a first moment.
fn column(text: &str, heading: &Heading) -> Option<(usize, f64, bool)> {
    match heading {
        Heading::Column(Column::Value(value, unit)) => Some((*value, *unit, false)),
        Heading::Column(_)
        | Heading::Size(_)
        | Heading::Unit(..)
        | Heading::Product
        | Heading::NoDeviation
        | Heading::Other => first_moment(&squeezed(text)).map(|value| (value, 1.0, true)),
    }
}

/// m c in kg·m: `first_moment_1_kg_m`, `mcx`, `hx`.
fn first_moment(plain: &str) -> Option<usize> {
    let plain = plain.strip_suffix("kgm").unwrap_or(plain);
    let axis = ["firstmoment", "mc", "h"].iter().find_map(|name| plain.strip_prefix(name))?;
    match axis {
        "x" | "1" => Some(1),
        "y" | "2" => Some(2),
        "z" | "3" => Some(3),
        _ => None,
    }
}
