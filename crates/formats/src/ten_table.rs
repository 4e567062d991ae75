//! Tables of mass, mass centre and inertia: ten numbers a row.

use crate::{
    BodyError, FileProblem, Products, UnitError,
    body::{ENTRIES, Number, shortened},
    csv,
    error::Refusal,
    parts::heading::VALUES,
    rows::Field,
    table_header::{Header, MASS, find_header, one_unit, unit_below},
    ten_heading::{TenCentre, TenHeading},
    text::Text,
    units::{BadUnit, SharedUnit, Unit},
};

/// A table with columns of mass, mass centre (or first moments) and inertia.
///
/// ```
/// use gyradius_formats::{Products, TenCentre, TenTable};
///
/// let table = "mass_kg,cx_mm,cy_mm,cz_mm,ixx,iyy,izz,time\n2,0,0,100,0.1,0.1,0.1,7\n";
/// let table = TenTable::read(table.as_bytes(), Products::TensorEntries)?;
/// assert_eq!(table.centre(), Some(TenCentre::MassCentre));
/// assert_eq!(table.rows()[0].values().unwrap()[3], 0.1);
/// assert_eq!(table.unused(), ["time"]);
/// # Ok::<(), gyradius_formats::TenTableError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TenTable {
    rows: Vec<TenRow>,
    centre: Option<TenCentre>,
    unused: Vec<String>,
}

/// A row of such a table.
#[derive(Clone, Debug, PartialEq)]
pub struct TenRow {
    line: usize,
    values: Result<[f64; 10], BodyError>,
}

/// Why a table is not read as one of ten numbers.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TenTableError {
    /// It is no table of inertias.
    #[error(transparent)]
    File(FileProblem),
    /// A column of a number whose unit is not read.
    #[error(transparent)]
    Unit(#[from] Box<UnitError>),
    /// Two columns for one number.
    #[error("columns {first:?} and {second:?} both hold {field}: there must be one of them")]
    Twice {
        /// The number.
        field: &'static str,
        /// One heading.
        first: String,
        /// The other.
        second: String,
    },
    /// The mass centre in some columns and first moments in others.
    #[error(
        "column {centre:?} holds the mass centre and column {moment:?} a first moment: the three must be of one kind"
    )]
    Mixed {
        /// One heading.
        centre: String,
        /// The other.
        moment: String,
    },
    /// Some of the columns are there and others are not.
    #[error("there is column {found:?} and no column of {missing}: the header must name both")]
    Missing {
        /// A column that is there.
        found: String,
        /// The number that is not.
        missing: &'static str,
    },
}

impl From<Refusal> for TenTableError {
    fn from(refusal: Refusal) -> Self {
        Self::File(refusal.problem)
    }
}

/// The columns of the mass centre or of the first moments, and their unit in SI.
struct Centre {
    kind: TenCentre,
    places: [usize; 3],
    unit: f64,
}

impl TenTable {
    /// The ten of every row, mass and inertia as [`InertiaFile`](crate::InertiaFile) reads them. A table of inertias without a mass centre, or
    /// without a mass beside it, has no rows here.
    ///
    /// # Errors
    /// It is no table of inertias; or it has some columns of a mass centre or of first moments and not all, two for one number, both kinds,
    /// one in a unit that is not read, or first moments and no mass.
    pub fn read(bytes: &[u8], products: Products) -> Result<Self, TenTableError> {
        let text = Text::new(bytes, true)?;
        let bodies = csv::read(&text, products)?;
        let (header, mut rows) = find_header(&text)?;
        let centre = Centre::of(&text, &header)?;
        let unused = |(at, field): (usize, &Field)| {
            let place = header.columns.iter().position(|column| *column == Some(at));
            let is_used = match &centre {
                Some(centre) => place.is_some() || centre.places.contains(&at),
                None => place.is_some_and(|place| place != MASS),
            };
            let name = field.of(text.as_str()).trim();
            (!is_used && !name.is_empty()).then(|| shortened(name))
        };
        let unused = header.row.iter().enumerate().filter_map(unused).collect();
        let Some(Centre { kind, places, unit }) = centre else {
            return Ok(Self { rows: Vec::new(), centre: None, unused });
        };
        let mut found = Vec::with_capacity(bodies.len());
        for body in &bodies {
            // The rows of the bodies, in their order.
            let Some(Ok(row)) = rows.next() else { break };
            let ten = || -> Result<[f64; 10], BodyError> {
                let inertia = body.inertia()?;
                let mut ten = [0.0; 10];
                ten[0] = body.mass_kg().ok_or(BodyError::Missing { field: VALUES[0] })?;
                let fields = kind.fields().into_iter().zip(places);
                for (value, (name, at)) in ten[1..4].iter_mut().zip(fields) {
                    let field = row.get(at).ok_or(BodyError::Missing { field: name })?;
                    *value = Number::parse(name, field.of(text.as_str()), None)?.value * unit;
                }
                for (value, entry) in ten[4..].iter_mut().zip(ENTRIES) {
                    *value = inertia[entry];
                }
                Ok(ten)
            };
            found.push(TenRow { line: body.line(), values: ten() });
        }
        Ok(Self { rows: found, centre: Some(kind), unused })
    }

    /// The rows, in the order of the file.
    #[must_use]
    pub fn rows(&self) -> &[TenRow] {
        &self.rows
    }

    /// What the rows have beside mass and inertia; nothing if the table has inertias alone.
    #[must_use]
    pub fn centre(&self) -> Option<TenCentre> {
        self.centre
    }

    /// The headings of columns of which nothing was taken.
    #[must_use]
    pub fn unused(&self) -> &[String] {
        &self.unused
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

impl Centre {
    fn of(text: &Text, header: &Header) -> Result<Option<Self>, TenTableError> {
        let name = |at: usize| header.row[at].of(text.as_str());
        let of_another = |at: usize| header.columns.contains(&Some(at));
        let mut found: Vec<(usize, TenCentre, TenHeading)> = Vec::new();
        for at in (0..header.row.len()).filter(|at| !of_another(*at)) {
            let heading = TenHeading::of(name(at));
            found.extend(heading.and_then(|heading| Some((at, heading.centre?, heading))));
        }
        // Beside a column of a number, its name with other words is another column.
        let whole: Vec<usize> =
            found.iter().filter(|(.., h)| h.unit.is_ok()).map(|(.., h)| h.place).collect();
        found.retain(|(.., heading)| match &heading.unit {
            Err(bad) => bad.is_certain || !whole.contains(&heading.place),
            Ok(_) => true,
        });
        let Some(&(first, kind, _)) = found.first() else { return Ok(None) };
        if header.columns[MASS].is_none() {
            return match kind {
                // The inertia is about the mass centre, wherever that is.
                TenCentre::MassCentre => Ok(None),
                TenCentre::FirstMoments => Err(TenTableError::missing(name(first), VALUES[0])),
            };
        }
        let mut places: [Option<usize>; 3] = [None; 3];
        let mut shared = SharedUnit::default();
        for (at, of, heading) in found {
            if of != kind {
                let (first, other) = (shortened(name(first)), shortened(name(at)));
                let (centre, moment) = match kind {
                    TenCentre::MassCentre => (first, other),
                    TenCentre::FirstMoments => (other, first),
                };
                return Err(TenTableError::Mixed { centre, moment });
            }
            let field = heading.field();
            let bad = |bad: BadUnit| Box::new(bad.of(name(at), field));
            let below = header.units.as_ref().and_then(|units| units.get(at));
            let below =
                below.map_or(Ok(Unit::none()), |cell| unit_below(text, cell, kind.dimension()));
            let unit = one_unit(heading.unit.map_err(bad)?, below.map_err(bad)?);
            let malformed = |message| TenTableError::File(FileProblem::Malformed { message });
            shared.with(field, unit.map_err(malformed)?).map_err(malformed)?;
            if let Some(before) = places[heading.place - 1].replace(at) {
                let (first, second) = (shortened(name(before)), shortened(name(at)));
                return Err(TenTableError::Twice { field, first, second });
            }
        }
        match places {
            [Some(a), Some(b), Some(c)] => {
                Ok(Some(Self { kind, places: [a, b, c], unit: shared.si() }))
            }
            _ => {
                let lost = places.iter().position(Option::is_none).unwrap_or(0);
                Err(TenTableError::missing(name(first), kind.fields()[lost]))
            }
        }
    }
}

impl TenTableError {
    fn missing(found: &str, missing: &'static str) -> Self {
        Self::Missing { found: shortened(found), missing }
    }
}
