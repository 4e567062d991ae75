//! What holds for all rows of a table, which a cell may say again but not change.

use crate::{
    body::{entry_of, lower_of},
    units::{Dimension, Unit},
};

/// What the columns of a table say of all its rows.
#[derive(Debug, Default)]
pub(crate) struct TableTerms {
    units: Vec<(Dimension, f64)>,
    point: InertiaPoint,
}

/// The point that the inertia of a row is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum InertiaPoint {
    /// The mass centre of the row.
    #[default]
    MassCentre,
    /// The origin, as beside first moments.
    Origin,
}

impl TableTerms {
    /// With what each column of a number measures, and its unit in SI.
    pub(crate) fn new(
        units: impl IntoIterator<Item = (Dimension, f64)>,
        point: InertiaPoint,
    ) -> Self {
        Self { units: units.into_iter().collect(), point }
    }

    /// What the inertia is about.
    pub(crate) fn point(&self) -> InertiaPoint {
        self.point
    }

    /// Whether a cell names no units but those of the columns, and, if it stands in a column of the unit of one thing, none of
    /// another. A unit of what no column holds must be that of SI.
    pub(crate) fn are_units_in(&self, cell: &str, of: Option<Dimension>) -> bool {
        // Marks that divide units, and then those that may stand in one.
        const BETWEEN: [&[char]; 2] = [&[',', ';', '/', '&', '+'], &[' ']];
        if says_nothing(cell) {
            return true;
        }
        let cell = &cell.replace(" and ", ", ");
        if let Some((dimension, si)) = self.unit(cell) {
            return of.is_none_or(|of| of == dimension) && self.is_in(dimension, si);
        }
        match cell.trim().to_lowercase().as_str() {
            "si" => return self.units.iter().all(|(_, si)| is_same(*si, 1.0)),
            "ea" | "each" | "pc" | "pcs" => return true,
            _ => {}
        }
        let mut parted = BETWEEN.iter().filter(|marks| cell.contains(**marks));
        parted.next().is_some_and(|marks| cell.split(*marks).all(|one| self.are_units_in(one, of)))
    }

    /// The unit that a text is. Where no column holds a first moment, `kg m` are two.
    fn unit(&self, text: &str) -> Option<(Dimension, f64)> {
        Dimension::ALL.into_iter().find_map(|dimension| {
            let is_meant =
                dimension != Dimension::FirstMoment || self.columns_of(dimension).next().is_some();
            let unit = Unit::of(text, dimension).ok().filter(|_| is_meant)?;
            (!unit.text.is_empty()).then_some((dimension, unit.si))
        })
    }

    fn columns_of(&self, dimension: Dimension) -> impl Iterator<Item = f64> {
        self.units.iter().filter(move |(of, _)| *of == dimension).map(|(_, si)| *si)
    }

    /// Whether the columns of something are in a unit.
    fn is_in(&self, dimension: Dimension, si: f64) -> bool {
        let mut columns = self.columns_of(dimension).peekable();
        if columns.peek().is_none() {
            is_same(si, 1.0)
        } else {
            columns.all(|column| is_same(column, si))
        }
    }
}

/// Whether a text is none but dashes, brackets and marks that part units, or the factor 1. Any other number would be a factor, or a count.
fn says_nothing(text: &str) -> bool {
    let is_mark = |c: char| c.is_whitespace() || "-–—|·•()[]".contains(c);
    text.chars().all(is_mark) || text.trim().parse() == Ok(1.0)
}

/// Whether two units are one: `t mm2` and `g m2` are, to within the rounding of their products.
fn is_same(one: f64, other: f64) -> bool {
    (one / other - 1.0).abs() < 1e-12
}

/// What a word of a heading speaks of.
pub(crate) fn dimension_of(word: &str) -> Option<Dimension> {
    match word {
        "mass" | "masses" | "weight" | "weights" => Some(Dimension::Mass),
        "length" | "lengths" | "distance" | "distances" | "dimension" | "dimensions" | "size"
        | "sizes" | "centre" | "center" | "cg" | "cog" | "com" | "cx" | "cy" | "cz" => {
            Some(Dimension::Length)
        }
        "inertia" | "inertias" | "moment" | "moments" | "product" | "products" | "moi" | "mois"
        | "poi" | "pois" | "tensor" | "i" => Some(Dimension::Inertia),
        // `Ixx`, and what is left of `I_xx`.
        _ => {
            let names = [word, &format!("i{word}")];
            let is_entry = |name: &str| entry_of(name).or_else(|| lower_of(name)).is_some();
            names.into_iter().any(is_entry).then_some(Dimension::Inertia)
        }
    }
}
