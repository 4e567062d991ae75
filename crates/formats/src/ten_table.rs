//! Tables of mass, mass centre and inertia: ten numbers a row.

use std::ops::Range;

use crate::{
    FileBodyError, FileProblem, Format, InertiaFile, UnitError,
    body::{ENTRIES, Number, shortened},
    error::Refusal,
    heading_sign::without_sign,
    parts::heading::VALUES,
    rows::Field,
    table_header::{Header, MASS, find_header, one_unit, unit_below},
    ten_heading::{TenCentre, TenHeading, field},
    text::Text,
    title_units,
    units::{BadUnit, SharedUnit, Unit},
};

/// A table with columns of mass, mass centre (or first moments) and inertia.
///
/// ```
/// use gyradius_formats::{InertiaFile, Products, TenCentre, TenTable};
///
/// let table = "mass_kg,cx_mm,cy_mm,cz_mm,ixx_kg_m2,iyy,izz,time\n2,0,0,100,0.1,0.1,0.1,7\n";
/// let file = InertiaFile::parse("bodies.csv".as_ref(), table.into(), Products::TensorEntries)?;
/// let table = TenTable::of(&file)?;
/// assert_eq!(table.centre(), Some(TenCentre::MassCentre));
/// assert_eq!(table.rows()[0].values().unwrap()[3], 0.1);
/// assert_eq!(table.unused(), ["time"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
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
    values: Result<[f64; 10], FileBodyError>,
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
    /// The ten of every row, mass and inertia as the file has them. A table of inertias without a mass centre, or without a mass beside it, and
    /// a file of another format, has no rows here.
    ///
    /// # Errors
    /// It has some columns of a mass centre or of first moments and not all, two for one number, both kinds, one in a unit that is not read, or
    /// first moments and no mass.
    pub fn of(file: &InertiaFile) -> Result<Self, TenTableError> {
        if file.format() != Format::Csv {
            return Ok(Self { rows: Vec::new(), centre: None, unused: Vec::new() });
        }
        let text = Text::new(&file.bytes, true)?;
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
        let mut found = Vec::with_capacity(file.bodies().len());
        for body in file.bodies() {
            // The rows of the bodies, in their order.
            let Some(Ok(row)) = rows.next() else { break };
            let ten = || -> Result<[f64; 10], FileBodyError> {
                let inertia = body.inertia()?;
                let mut ten = [0.0; 10];
                ten[0] = body.mass_kg().ok_or(FileBodyError::Missing { field: VALUES[0] })?;
                let fields = kind.fields().into_iter().zip(places);
                for (value, (name, at)) in ten[1..4].iter_mut().zip(fields) {
                    let field = row.get(at).ok_or(FileBodyError::Missing { field: name })?;
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
    pub fn values(&self) -> Result<&[f64; 10], &FileBodyError> {
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
                TenCentre::FirstMoments => {
                    let found = shortened(name(first));
                    Err(TenTableError::Missing { found, missing: VALUES[0] })
                }
            };
        }
        let mut columns = TenColumns::default();
        for (at, of, heading) in found {
            let below = header.units.as_ref().and_then(|units| units.get(at));
            let below =
                below.map_or(Ok(Unit::none()), |cell| unit_below(text, cell, of.dimension()));
            columns.add(at, name(at), heading, below)?;
        }
        let places = columns.places(1..4)?;
        columns.check_units(&[&header.mass, &header.inertia])?;
        let start = header.row.first().map_or(0, |field| field.start);
        title_units::refused(text, start, columns.units[1].is_lacking())?;
        Ok(Some(Self { kind, places: [places[0], places[1], places[2]], unit: columns.unit(1) }))
    }
}

/// Which columns of a header hold which of the ten.
#[derive(Default)]
pub(crate) struct TenColumns {
    /// The column of each, with its heading.
    found: [Option<(usize, String)>; 10],
    /// Of the mass, of the three that follow it, and of the inertia.
    units: [SharedUnit; 3],
    /// What the three are, by the first of them.
    centre: Option<(TenCentre, String)>,
}

impl TenColumns {
    /// With a column, its heading in words and as it is read, and what the row of units below it says.
    pub(crate) fn add(
        &mut self,
        at: usize,
        name: &str,
        heading: TenHeading,
        below: Result<Unit, BadUnit>,
    ) -> Result<(), TenTableError> {
        if without_sign(name).is_some() {
            let heading = shortened(name);
            return Err(TenTableError::File(FileProblem::Sign { heading }));
        }
        if let Some(centre) = heading.centre {
            let (kind, first) = self.centre.get_or_insert_with(|| (centre, shortened(name)));
            if *kind != centre {
                let (first, other) = (first.clone(), shortened(name));
                let (centre, moment) = match kind {
                    TenCentre::MassCentre => (first, other),
                    TenCentre::FirstMoments => (other, first),
                };
                return Err(TenTableError::Mixed { centre, moment });
            }
        }
        let (place, field) = (heading.place, heading.field());
        let bad = |bad: BadUnit| Box::new(bad.of(name, field));
        let unit = one_unit(heading.unit.map_err(bad)?, below.map_err(bad)?);
        let malformed = |message| TenTableError::File(FileProblem::Malformed { message });
        let shared = &mut self.units[which(place)];
        shared.with(field, name, unit.map_err(malformed)?).map_err(malformed)?;
        if let Some((_, first)) = self.found[place].replace((at, shortened(name))) {
            return Err(TenTableError::Twice { field, first, second: shortened(name) });
        }
        Ok(())
    }

    /// That none of its units is unknown beside those of other columns and its own.
    pub(crate) fn check_units(&self, beside: &[&SharedUnit]) -> Result<(), TenTableError> {
        let all: Vec<&SharedUnit> = beside.iter().copied().chain(&self.units).collect();
        match SharedUnit::lacking(&all) {
            Some((heading, other)) => {
                Err(TenTableError::File(FileProblem::NoUnit { heading, other }))
            }
            None => Ok(()),
        }
    }

    /// Whether there are columns of some kind of which none states a unit.
    pub(crate) fn some_lack(&self) -> bool {
        self.units.iter().any(SharedUnit::is_lacking)
    }

    /// What the three after the mass are; nothing if none of them is there.
    pub(crate) fn centre(&self) -> Option<TenCentre> {
        self.centre.as_ref().map(|(centre, _)| *centre)
    }

    /// The columns of some of the ten.
    pub(crate) fn places(&self, of: Range<usize>) -> Result<Vec<usize>, TenTableError> {
        let place = |i: usize| match &self.found[i] {
            Some((at, _)) => Ok(*at),
            None => {
                let found = self.found.iter().flatten().next();
                let found = found.map_or_else(String::new, |(_, name)| name.clone());
                Err(TenTableError::Missing { found, missing: field(i, self.centre()) })
            }
        };
        of.map(place).collect()
    }

    /// The unit of one of the ten in SI.
    pub(crate) fn unit(&self, place: usize) -> f64 {
        self.units[which(place)].si()
    }
}

/// Which of the three units one of the ten is in.
fn which(place: usize) -> usize {
    match place {
        0 => 0,
        1..=3 => 1,
        _ => 2,
    }
}
