//! A row of a list of parts: what it says of a part, or that it is an assembly.

use gyradius_inertia::{InertiaMatrix, Shape};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use std::iter;

use super::columns::PartColumns;
use super::error::{PartsError, PartsFile, PartsProblem};
use super::heading::{self, Column, GYRATION, Group, Heading, Scale, VALUES};
use super::last_place::half_of_last_place;
use super::unread_kinds::Unread;
use crate::{
    FileBodyError, Products,
    body::{Number, shortened},
    rows::{NOT_KNOWN, is_blank},
    table_terms::TableTerms,
};

/// What the columns of mass and mass centre may be called, in messages.
const SPELLINGS: [&str; 4] = [
    "mass or m",
    "centre_x, Cx, CG X or Xcg",
    "centre_y, Cy, CG Y or Ycg",
    "centre_z, Cz, CG Z or Zcg",
];

/// How far the four components of an attitude may be from a unit quaternion.
const UNIT: f64 = 1e-3;

/// A row of a list: a part with its numbers, or an assembly without.
#[derive(Clone, Debug, PartialEq)]
pub struct PartRow {
    name: String,
    /// What else may say that it is a total: `TOTAL` in a column of descriptions.
    other_labels: Vec<String>,
    parent: Option<String>,
    place: (PartsFile, usize),
    parent_place: (PartsFile, usize),
    numbers: Option<PartNumbers>,
}

impl PartRow {
    pub(super) fn assembly(name: &str, place: (PartsFile, usize)) -> Self {
        let (name, other_labels) = (name.to_owned(), Vec::new());
        Self { name, other_labels, parent: None, place, parent_place: place, numbers: None }
    }

    pub(super) fn set_parent(&mut self, parent: &str, place: (PartsFile, usize)) {
        self.parent = Some(parent.to_owned());
        self.parent_place = place;
    }

    /// Its name, which may be that of another.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its name, and what else may say that it is a total.
    pub(super) fn labels(&self) -> impl Iterator<Item = &str> {
        iter::once(self.name()).chain(self.other_labels.iter().map(String::as_str))
    }

    /// What it belongs to, if anything.
    #[must_use]
    pub fn parent(&self) -> Option<&str> {
        self.parent.as_deref()
    }

    /// Table and line, from 1, where it first stands.
    #[must_use]
    pub fn place(&self) -> (PartsFile, usize) {
        self.place
    }

    /// Table and line, from 1, that say what it belongs to.
    #[must_use]
    pub fn parent_place(&self) -> (PartsFile, usize) {
        self.parent_place
    }

    /// The numbers of a part; none of an assembly.
    #[must_use]
    pub fn numbers(&self) -> Option<&PartNumbers> {
        self.numbers.as_ref()
    }
}

/// What a row says of a part, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct PartNumbers {
    mass_kg: f64,
    mass_centre_m: [f64; 3],
    inertia: InertiaMatrix,
    attitude: UnitQuaternion<f64>,
    deviations: [f64; 10],
    inertia_follows_mass: bool,
    half_places: [f64; 4],
}

impl PartNumbers {
    /// Mass, kg; it may be no mass at all.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// Mass centre in the frame of the whole, m.
    #[must_use]
    pub fn mass_centre_m(&self) -> [f64; 3] {
        self.mass_centre_m
    }

    /// Inertia about the mass centre in the part's own axes, kg·m², products as tensor entries; it may be no body's.
    #[must_use]
    pub fn inertia(&self) -> &InertiaMatrix {
        &self.inertia
    }

    /// The rotation that takes the part's own axes to those of the whole.
    #[must_use]
    pub fn attitude(&self) -> UnitQuaternion<f64> {
        self.attitude
    }

    /// Standard deviations of mass (kg), mass centre (m), I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ (kg·m²); zero where nothing is said.
    #[must_use]
    pub fn deviations(&self) -> [f64; 10] {
        self.deviations
    }

    /// How far mass (kg) and mass centre (m) may be from what the list shows of them, if they were rounded to their digits.
    pub(super) fn half_places(&self) -> [f64; 4] {
        self.half_places
    }

    /// Whether the inertia is proportional to the mass: that of a shape or of radii of gyration is, unless the row says no.
    #[must_use]
    pub fn inertia_follows_mass(&self) -> bool {
        self.inertia_follows_mass
    }
}

/// The cells of a row under their headings.
pub(super) struct Cells<'a> {
    pub(super) columns: &'a PartColumns,
    pub(super) cells: &'a [String],
    /// What a line above the header says of the products.
    pub(super) stated: Option<Products>,
    /// What they are where the table does not say it.
    pub(super) products: Option<Products>,
    /// What holds for all rows.
    pub(super) terms: &'a TableTerms,
}

impl Cells<'_> {
    pub(super) fn row(&self, line: usize) -> Result<PartRow, PartsError> {
        let (found, allowed) = (self.cells.len(), self.columns.meanings.len());
        if found != allowed {
            let problem = FileBodyError::Count { field: "the row", found, allowed }.into();
            return Err(PartsError::new(line, None, problem));
        }
        let Some(name) = self.text(Column::Name).map(str::to_owned) else {
            let problem = FileBodyError::Missing { field: "name" }.into();
            return Err(PartsError::new(line, None, problem));
        };
        let parent = self.text(Column::Parent).map(str::to_owned);
        let refused = |problem| PartsError::new(line, Some(&name), problem);
        if let Some(problem) = self.unread() {
            return Err(refused(problem));
        }
        let numbers = self.numbers().map_err(refused)?;
        let place = (PartsFile::Parts, line);
        let other_labels = self.columns.labels.iter().filter_map(|at| self.cells.get(*at).cloned());
        let other_labels = other_labels.collect();
        Ok(PartRow { name, other_labels, parent, place, parent_place: place, numbers })
    }

    /// Cells that are not empty, under the columns of a kind.
    pub(super) fn given<T>(
        &self,
        of: impl Fn(&Heading) -> Option<T>,
    ) -> impl Iterator<Item = (T, &str)> {
        let pairs =
            self.columns.meanings.iter().zip(self.cells).filter(|(_, cell)| !is_blank(cell));
        pairs.filter_map(move |(heading, cell)| Some((of(heading)?, cell.as_str())))
    }

    /// The first cell that would change the numbers of the row, and is not read.
    pub(super) fn unread(&self) -> Option<PartsProblem> {
        let mut cells = self.columns.with(self.cells);
        let problem = |((column, heading), cell): ((&Heading, &String), &String)| match column {
            Heading::Unread(what) => what.problem(heading, cell, self.terms),
            _ => None,
        };
        cells.find_map(problem).map(PartsProblem::from)
    }

    /// The first cell of a part that is not known and would be read as a number: as zero, as the part's own axes, or as one part.
    pub(super) fn not_known(&self, is_point: bool, has_six: bool) -> Option<PartsProblem> {
        let is_number = |column: &Heading| match column {
            // What is said of the inertia of a point has no meaning.
            Heading::Column(Column::Deviation(Group(first, _), _)) => *first < 4 || !is_point,
            // Products that are empty are zero; beside a shape or radii, none of the six is read.
            Heading::Column(Column::Value(i, _)) => *i >= 7 && has_six,
            Heading::Column(Column::Attitude(_)) | Heading::Unread(Unread::Count) => true,
            Heading::Column(
                Column::Name
                | Column::Parent
                | Column::Products
                | Column::Point
                | Column::Shape
                | Column::Follows
                | Column::Below(..)
                | Column::Gyration(..),
            )
            | Heading::Size(..)
            | Heading::SizeUnit(..)
            | Heading::Unit(..)
            | Heading::Product
            | Heading::Signed
            | Heading::NoDeviation
            | Heading::SizeDeviation
            | Heading::Unread(
                Unread::Turn | Unread::Growth | Unread::Unit | Unread::Reference | Unread::Sign,
            )
            | Heading::Other => false,
        };
        let mut cells = self.columns.with(self.cells);
        let found = cells.find(|((column, _), cell)| *cell == NOT_KNOWN && is_number(column));
        found.map(|((_, heading), _)| PartsProblem::NotKnown { heading: shortened(heading) })
    }

    pub(super) fn text(&self, wanted: Column) -> Option<&str> {
        self.given(|h| (*h == Heading::Column(wanted)).then_some(())).next().map(|(_, cell)| cell)
    }

    /// The numbers of a part; none where no cell has any.
    fn numbers(&self) -> Result<Option<PartNumbers>, PartsProblem> {
        let says = |heading: &Heading| match heading {
            Heading::Column(
                Column::Value(..)
                | Column::Below(..)
                | Column::Gyration(..)
                | Column::Deviation(..)
                | Column::Shape
                | Column::Attitude(_)
                | Column::Follows,
            )
            | Heading::Size(..) => Some(()),
            Heading::Column(Column::Name | Column::Parent | Column::Products | Column::Point)
            | Heading::Unit(..)
            | Heading::SizeUnit(..)
            | Heading::Product
            | Heading::Signed
            | Heading::NoDeviation
            | Heading::Unread(_)
            | Heading::SizeDeviation
            | Heading::Other => None,
        };
        if self.given(says).next().is_none() {
            return Ok(None);
        }
        let sign = self.sign()?;
        let (mut values, mut half_places) = ([None; 10], [0.0; 4]);
        let of = |heading: &Heading| match heading {
            Heading::Column(Column::Value(i, unit)) => Some((*i, unit.unwrap_or(1.0))),
            _ => None,
        };
        for ((i, si), cell) in self.given(of) {
            if values[i].is_some() {
                return Err(PartsProblem::Twice { field: VALUES[i] });
            }
            values[i] = Some(Number::parse(VALUES[i], cell, None)?.value * si);
            if let Some(half) = half_places.get_mut(i) {
                *half = half_of_last_place(cell) * si;
            }
        }
        for i in 0..4 {
            if values[i].is_none() {
                let is_it =
                    |h: &Heading| matches!(h, Heading::Column(Column::Value(j, _)) if *j == i);
                return Err(if self.columns.meanings.iter().any(is_it) {
                    FileBodyError::Missing { field: VALUES[i] }.into()
                } else {
                    PartsProblem::NoColumn { column: SPELLINGS[i] }
                });
            }
        }
        self.agrees_below(std::array::from_fn(|e| values[7 + e].unwrap_or_default()))?;
        let [mass_kg, x, y, z] = std::array::from_fn(|i| values[i].unwrap_or_default());
        let shape = self.shape()?;
        let radii = self.gyration(mass_kg)?;
        let has_six = shape.is_none() && radii.is_none();
        if let Some(problem) = self.not_known(matches!(shape, Some(None)), has_six) {
            return Err(problem);
        }
        let six =
            self.inertia(shape, radii, mass_kg, std::array::from_fn(|e| values[4 + e]), sign)?;
        let [i11, i22, i33, i12, i13, i23] = six;
        let inertia = InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23])
            .map_err(|error| PartsProblem::Shape { message: error.to_string() })?;
        let nominal = [mass_kg, x, y, z, i11, i22, i33, i12, i13, i23];
        let inertia_follows_mass = match self.text(Column::Follows) {
            None => matches!(shape, Some(Some(_))) || radii.is_some(),
            Some(word) => boolean("inertia_follows_mass", word)?,
        };
        Ok(Some(PartNumbers {
            mass_kg,
            mass_centre_m: [x, y, z],
            inertia,
            attitude: self.attitude()?,
            deviations: self.deviations(&nominal)?,
            inertia_follows_mass,
            half_places,
        }))
    }

    /// What the products are, if anything says it.
    fn sign(&self) -> Result<Option<Products>, PartsProblem> {
        let Some(word) = self.text(Column::Products) else {
            return Ok(self.stated.or(self.products));
        };
        let own = Products::of_cell(word)?;
        if let Some(line) = self.stated.filter(|line| own.is_some_and(|own| own != *line)) {
            let second = format!("the line \"# products = {}\"", line.name());
            let first = format!("products = {:?}", shortened(word));
            return Err(PartsProblem::Contradiction { first, second });
        }
        Ok(own.or(self.stated).or(self.products))
    }

    /// Six entries of the tensor, in the part's axes; `radii` are the moments that radii of gyration say.
    fn inertia(
        &self,
        shape: Option<Option<Shape>>,
        radii: Option<[f64; 3]>,
        mass_kg: f64,
        given: [Option<f64>; 6],
        sign: Option<Products>,
    ) -> Result<[f64; 6], PartsProblem> {
        let any = given.iter().flatten().any(|entry| *entry != 0.0);
        if let Some([i11, i22, i33]) = radii {
            if any || shape.is_some() {
                return Err(PartsProblem::Twice { field: "the inertia" });
            }
            return Ok([i11, i22, i33, 0.0, 0.0, 0.0]);
        }
        match shape {
            Some(shape) if any => {
                let shape = if shape.is_some() { "shape" } else { "point" };
                let shape = self.text(Column::Shape).unwrap_or(shape).to_owned();
                return Err(PartsProblem::InertiaAndShape { shape });
            }
            Some(None) => return Ok([0.0; 6]),
            Some(Some(shape)) => {
                let body = shape.of_mass(mass_kg);
                let body = body.map_err(|e| PartsProblem::Shape { message: e.to_string() })?;
                return Ok(body.inertia().entries());
            }
            None => {}
        }
        if given[..3].iter().all(Option::is_none) {
            return Err(PartsProblem::NoInertia);
        }
        for e in 0..3 {
            if given[e].is_none() {
                return Err(FileBodyError::Missing { field: VALUES[4 + e] }.into());
            }
        }
        let mut six = given.map(Option::unwrap_or_default);
        let product = (3..6).find(|e| six[*e] != 0.0);
        match (sign, product) {
            (Some(sign), _) => six[3..].iter_mut().for_each(|entry| *entry *= sign.sign()),
            (None, Some(e)) => return Err(PartsProblem::Sign { field: VALUES[4 + e] }),
            (None, None) => {}
        }
        Ok(six)
    }

    /// The moments m k² of the radii of gyration, if there are any.
    fn gyration(&self, mass_kg: f64) -> Result<Option<[f64; 3]>, PartsProblem> {
        let mut found = [None; 3];
        let of = |heading: &Heading| match heading {
            Heading::Column(Column::Gyration(axis, unit)) => Some((*axis, unit.unwrap_or(1.0))),
            _ => None,
        };
        for ((axis, si), cell) in self.given(of) {
            let field = GYRATION[axis];
            if found[axis].is_some() {
                return Err(PartsProblem::Twice { field });
            }
            let value = Number::parse(field, cell, None)?.value * si;
            let moment = mass_kg * value * value;
            if !(value >= 0.0 && moment.is_finite()) {
                let allowed = "zero or more, and small enough for a moment of inertia";
                return Err(PartsProblem::Value { field, value, allowed });
            }
            found[axis] = Some(moment);
        }
        if found.iter().all(Option::is_none) {
            return Ok(None);
        }
        match found.iter().position(Option::is_none) {
            Some(axis) => Err(FileBodyError::Missing { field: GYRATION[axis] }.into()),
            None => Ok(Some(found.map(Option::unwrap_or_default))),
        }
    }

    /// Ten standard deviations in SI units.
    fn deviations(&self, nominal: &[f64; 10]) -> Result<[f64; 10], PartsProblem> {
        let mut found = [None; 10];
        let of = |heading: &Heading| match heading {
            Heading::Column(Column::Deviation(group, scale)) => Some((*group, *scale)),
            _ => None,
        };
        for ((Group(first, count), scale), cell) in self.given(of) {
            let field = heading::deviation(Group(first, count), scale);
            // In a column of percentages the sign may stand again.
            let cell =
                if scale == Scale::Percent { cell.trim_end_matches('%').trim_end() } else { cell };
            let value = Number::parse(field, cell, None)?.value;
            if !(value >= 0.0) {
                let allowed = "zero or more";
                return Err(PartsProblem::Value { field, value, allowed });
            }
            for i in first..first + count {
                // Of a product that is zero, a percentage says nothing, though somebody means something by it.
                let group = &nominal[first..first + count];
                if scale == Scale::Percent
                    && i >= 7
                    && value > 0.0
                    && group.iter().all(|x| *x == 0.0)
                {
                    let allowed = "empty or zero where the product is zero: a standard deviation in kg·m² stands in \
                                   the column sigma_ixy, sigma_ixz, sigma_iyz or sigma_products";
                    return Err(PartsProblem::Value { field, value, allowed });
                }
                let sigma = match scale {
                    Scale::Unit(unit) => value * unit.unwrap_or(1.0),
                    // Of a centre, a share of its distance from the origin means nothing.
                    Scale::Percent if (1..4).contains(&i) => {
                        let allowed = "a length, for a mass centre has no percent";
                        return Err(PartsProblem::Value { field, value, allowed });
                    }
                    Scale::Percent => 0.01 * value * nominal[i].abs(),
                };
                if found[i].replace(sigma).is_some() {
                    let field = heading::deviation(Group(i, 1), Scale::Unit(None));
                    return Err(PartsProblem::Twice { field });
                }
            }
        }
        Ok(found.map(Option::unwrap_or_default))
    }

    /// The rotation from the part's axes; none where there are no components.
    fn attitude(&self) -> Result<UnitQuaternion<f64>, PartsProblem> {
        const FIELDS: [&str; 4] = ["attitude_x", "attitude_y", "attitude_z", "attitude_w"];
        let mut found = [None; 4];
        let of = |heading: &Heading| match heading {
            Heading::Column(Column::Attitude(i)) => Some(*i),
            _ => None,
        };
        for (i, cell) in self.given(of) {
            found[i] = Some(Number::parse(FIELDS[i], cell, None)?.value);
        }
        if found.iter().all(Option::is_none) {
            return Ok(UnitQuaternion::identity());
        }
        for (i, field) in FIELDS.into_iter().enumerate() {
            if found[i].is_none() {
                return Err(FileBodyError::Missing { field }.into());
            }
        }
        let [x, y, z, w] = found.map(Option::unwrap_or_default);
        let quaternion = Quaternion::from_parts(w, Vector3::new(x, y, z));
        let value = quaternion.norm();
        if !((value - 1.0).abs() <= UNIT) {
            let allowed = "one, for the norm of a rotation's quaternion";
            return Err(PartsProblem::Value { field: "norm of the attitude", value, allowed });
        }
        Ok(UnitQuaternion::new_normalize(quaternion))
    }
}

pub(super) fn boolean(field: &'static str, word: &str) -> Result<bool, PartsProblem> {
    match word.to_lowercase().as_str() {
        "true" | "yes" | "1" | "t" => Ok(true),
        "false" | "no" | "0" | "f" => Ok(false),
        _ => {
            let (value, allowed) = (shortened(word), "yes or no");
            Err(FileBodyError::Word { field, value, allowed }.into())
        }
    }
}
