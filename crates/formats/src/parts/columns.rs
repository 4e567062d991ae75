//! The columns of a list of parts: what each heading means beside the others, and what they are together.

use super::{
    PartsProblem,
    heading::{self, Column, Heading},
    unread_kinds::Unread,
};
use crate::{
    FileProblem,
    body::shortened,
    table_terms::{InertiaPoint, TableTerms},
    units::squeezed,
};

/// What a column of names may be called.
const NAMES: &str = "name, id, part, body, link, component, item, element or description";

/// PartColumns, each with a heading and what it means.
pub(super) struct PartColumns {
    pub(super) headings: Vec<String>,
    pub(super) meanings: Vec<Heading>,
    /// Headings of those that mean nothing here.
    pub(super) passed_over: Vec<String>,
    /// Those that may say, beside the name, that a row is a total.
    pub(super) labels: Vec<usize>,
}

impl PartColumns {
    /// # Errors
    /// A heading cannot be read beside the others, or says the same as another.
    pub(super) fn of(headings: Vec<String>) -> Result<Self, PartsProblem> {
        let meanings = meanings(&headings);
        let mut passed_over = Vec::new();
        for at in 0..headings.len() {
            if !is_read(at, &meanings, &headings)? {
                passed_over.push(shortened(&headings[at]));
            }
        }
        let is_label = |at: &usize| {
            let heading = &headings[*at];
            let may_be = *at == 0 || is_id(heading) || heading::rank_as_name(heading).is_some();
            may_be && meanings[*at] == Heading::Other
        };
        let labels = (0..headings.len()).filter(is_label).collect();
        Ok(Self { headings, meanings, passed_over, labels })
    }

    /// Those of a table of edges: masses and the like are not read from there, whatever they say.
    pub(super) fn unread(headings: Vec<String>, passed_over: Vec<String>) -> Self {
        let column = |heading: &String| Unread::of(heading).map_or(Heading::Other, Heading::Unread);
        let meanings = headings.iter().map(column).collect();
        Self { headings, meanings, passed_over, labels: Vec::new() }
    }

    pub(super) fn has(&self, wanted: Column) -> bool {
        self.meanings.contains(&Heading::Column(wanted))
    }

    /// The meanings and headings with the cells of a row.
    pub(super) fn with<'a>(
        &'a self,
        cells: &'a [String],
    ) -> impl Iterator<Item = ((&'a Heading, &'a String), &'a String)> {
        self.meanings.iter().zip(&self.headings).zip(cells)
    }

    /// Whether some number has a dimension, but no unit.
    pub(super) fn some_lack_units(&self) -> bool {
        self.meanings.iter().any(|column| matches!(column.dimension(), Some((_, None))))
    }

    /// # Errors
    /// There are no names or no masses.
    pub(super) fn check_what_must_be(&self) -> Result<(), PartsProblem> {
        let is_mass = |column: &Heading| matches!(column, Heading::Column(Column::Value(0, _)));
        let has_mass = self.meanings.iter().any(is_mass);
        let each = [(self.has(Column::Name), NAMES), (has_mass, "mass or m")];
        match each.into_iter().find(|(there, _)| !there) {
            Some((_, column)) => Err(PartsProblem::NoColumn { column }),
            None => Ok(()),
        }
    }

    /// What holds for all rows.
    pub(super) fn terms(&self) -> TableTerms {
        let measured = self.meanings.iter().filter_map(Heading::dimension);
        let measured = measured.map(|(dimension, unit)| (dimension, unit.unwrap_or(1.0)));
        TableTerms::new(measured, InertiaPoint::MassCentre)
    }

    /// Checks a row of units for those of columns that are not read.
    ///
    /// # Errors
    /// One says that its column is something that must be read.
    pub(super) fn check_units(
        &self,
        cells: &[String],
        terms: &TableTerms,
    ) -> Result<(), PartsProblem> {
        for ((column, heading), cell) in self.with(cells) {
            if let Heading::Unread(what) = column
                && let Some(problem) = what.problem_in_units(heading, cell, terms)
            {
                return Err(problem.into());
            }
        }
        Ok(())
    }
}

fn is_id(heading: &str) -> bool {
    squeezed(heading) == "id"
}

/// What headings mean, each beside the others.
fn meanings(headings: &[String]) -> Vec<Heading> {
    let mut columns: Vec<Heading> = headings.iter().map(|heading| Heading::of(heading)).collect();
    if !columns.contains(&Heading::Column(Column::Shape)) {
        columns = columns.into_iter().map(Heading::without_shapes).collect();
    }
    columns = Heading::with_one_half(columns);
    let names = columns.iter().filter(|column| **column == Heading::Column(Column::Name)).count();
    // Beside names, numbers are no names.
    if names == 2
        && let Some(id) = headings.iter().position(|heading| is_id(heading))
    {
        columns[id] = Heading::Other;
    }
    // Words that may say something else are names where nothing else is.
    let rank = |at: usize| Some((heading::rank_as_name(&headings[at])?, at));
    if names == 0
        && let Some((_, at)) = (0..headings.len()).filter_map(rank).min()
    {
        columns[at] = Heading::Column(Column::Name);
    }
    columns
}

/// Whether a column means something here.
///
/// # Errors
/// It cannot be read beside the others.
fn is_read(at: usize, columns: &[Heading], headings: &[String]) -> Result<bool, PartsProblem> {
    let (column, heading) = (&columns[at], &headings[at]);
    if let Some((field, bad)) = column.bad_unit(columns) {
        return Err(Box::new(bad.clone().of(heading, field)).into());
    }
    let shown = shortened(heading);
    if column.is_lost_product(columns) {
        return Err(PartsProblem::File(FileProblem::Product { heading: shown }));
    }
    if let Some(other) = column.unit_it_lacks(columns) {
        let other = shortened(&headings[other]);
        return Err(PartsProblem::File(FileProblem::NoUnit { heading: shown, other }));
    }
    match column {
        Heading::Signed => Err(PartsProblem::File(FileProblem::Sign { heading: shown })),
        Heading::NoDeviation => Err(PartsProblem::Deviation { heading: shown }),
        Heading::SizeDeviation => Err(PartsProblem::SizeDeviation { heading: shown }),
        Heading::Unit(..)
        | Heading::SizeUnit(..)
        | Heading::Product
        | Heading::Unread(_)
        | Heading::Other => Ok(false),
        Heading::Column(_) | Heading::Size(..) => {
            match columns[..at].iter().position(|other| other.says_the_same(column)) {
                Some(first) => {
                    let first = shortened(&headings[first]);
                    Err(PartsProblem::Columns { first, second: shown })
                }
                None => Ok(true),
            }
        }
    }
}
