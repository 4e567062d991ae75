//! Cells of columns that would change the numbers of a row, and are not read.

use super::unread_kinds::Unread;
use crate::{
    FileBodyError,
    body::shortened,
    rows::is_blank,
    spread::{parted, words},
    table_terms::{InertiaPoint, TableTerms, dimension_of},
    units::{Dimension, squeezed},
};

/// Words and marks that say of an angle or an allowance that there is none.
const NONE: [&str; 9] = ["-", "--", "–", "—", "none", "nil", "zero", "n/a", "identity"];

/// The matrix of no rotation.
const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// Whether a heading is that of an entry on the diagonal of a rotation matrix: `R11`, `dcm22`.
fn is_on_diagonal(heading: &str) -> bool {
    let plain = squeezed(heading);
    let entry = ["r", "dcm"].iter().find_map(|word| plain.strip_prefix(word));
    entry.is_some_and(|entry| ["11", "22", "33"].contains(&entry))
}

impl Unread {
    /// Why a cell under a heading of this kind is refused, if it says something that would change the row of a table.
    pub(crate) fn problem(
        self,
        heading: &str,
        cell: &str,
        terms: &TableTerms,
    ) -> Option<FileBodyError> {
        let says_nothing = is_blank(cell) || self.is_neutral(heading, cell, terms);
        (!says_nothing).then(|| FileBodyError::Unread {
            heading: shortened(heading),
            value: shortened(cell),
            why: self.because(cell, terms),
        })
    }

    /// Why a cell in the row of units is refused, if it says something of all rows that would change them. What stands there under
    /// another heading is the unit of what is below.
    pub(crate) fn problem_in_units(
        self,
        heading: &str,
        cell: &str,
        terms: &TableTerms,
    ) -> Option<FileBodyError> {
        match self {
            Self::Unit => self.problem(heading, cell, terms),
            Self::Reference => {
                let says_something = cell.contains(char::is_alphabetic);
                says_something.then(|| self.problem(heading, cell, terms)).flatten()
            }
            Self::Count | Self::Turn | Self::Sign | Self::Growth => None,
        }
    }

    /// Why such a column must not say it, and what to do.
    fn because(self, cell: &str, terms: &TableTerms) -> &'static str {
        let is_number = cell.parse::<f64>().is_ok();
        match self {
            Self::Count => {
                "a row is one part, and must have mass, mass centre and inertia of all of them together, or stand as many times as \
                 there are parts, each with its own mass centre; the column must be empty, 1 or one"
            }
            Self::Turn => {
                "angles are not read, for their order is not known: a part that is turned must have the quaternion of its attitude in \
                 attitude_x, attitude_y, attitude_z and attitude_w; the column must be empty, 0 or none"
            }
            Self::Unit => {
                "units are those of a column, and must stand in its heading or in a row below the header: a cell in a row must be empty, \
                 or name the same units, each as a heading may name it, with no number, be it a factor or a count of parts"
            }
            Self::Reference if is_number => match terms.point() {
                InertiaPoint::MassCentre => {
                    "the heading speaks of the point that an inertia is about, and the inertia of a row is that about its own mass centre: it must be that, \
                     in columns ixx, iyy and izz, and this column must be left out"
                }
                InertiaPoint::Origin => {
                    "the heading speaks of the point that an inertia is about, and in a table with first moments, the inertia of a row is that about the \
                     origin: it must be that, in columns ixx, iyy and izz, and this column must be left out"
                }
            },
            Self::Reference => match terms.point() {
                InertiaPoint::MassCentre => {
                    "the inertia of a row is that about its own mass centre: the column must be empty, or say so, as \"cg\" or \
                     \"mass centre\""
                }
                InertiaPoint::Origin => {
                    "in a table with first moments, the inertia of a row is that about the origin: the column must be empty, or \
                     say \"origin\""
                }
            },
            Self::Sign => {
                "which sign products have must stand in a column products, as tensor (I12 = -∫xy dm) or integrals (+∫xy dm): the column \
                 must be called so, or be empty"
            }
            Self::Growth => {
                "no growth allowance is added: the mass and the inertia must have it in them; the column must be empty, 0 or none"
            }
        }
    }

    /// Whether a cell says nothing that would change the row.
    fn is_neutral(self, heading: &str, cell: &str, terms: &TableTerms) -> bool {
        let is_none = NONE.iter().any(|word| cell.eq_ignore_ascii_case(word));
        let of = |word: &str| word.trim_end_matches(['%', '°']).trim().parse::<f64>().ok();
        match self {
            // Any other word may be a number, here and below: `four`, `pair`, `½`, `ninety`.
            Self::Count => {
                let lower = cell.to_lowercase();
                let pieces = ["ea", "each", "pc", "pcs", "off"];
                let count = pieces.iter().find_map(|word| lower.strip_suffix(word));
                let count = count.unwrap_or(&lower).trim_matches(['x', '×', ' ']);
                count == "one" || of(count) == Some(1.0)
            }
            Self::Turn => {
                let words = cell.split([' ', ',', ';', '[', ']', '(', ')']);
                let numbers: Vec<_> = words.filter(|word| !word.is_empty()).map(of).collect();
                let are = |identity: &[f64]| {
                    let pairs = numbers.iter().zip(identity);
                    numbers.len() == identity.len()
                        && pairs.into_iter().all(|(a, b)| *a == Some(*b))
                };
                // A quaternion of three zeros and a one is none of these: in another order, it is half a turn.
                let is_diagonal = is_on_diagonal(heading) && are(&[1.0]);
                let is_zero = numbers.iter().all(|number| *number == Some(0.0));
                is_none || is_zero || is_diagonal || are(&IDENTITY)
            }
            Self::Growth => {
                let is_factor = words(&parted(heading)).any(|word| word == "factor");
                is_none || of(cell) == Some(0.0) || is_factor && of(cell) == Some(1.0)
            }
            // Signs alone say something here.
            Self::Sign => false,
            Self::Unit => {
                let heading = parted(heading);
                let mut named: Vec<Dimension> = words(&heading).filter_map(dimension_of).collect();
                named.dedup();
                let one = <[Dimension; 1]>::try_from(named).ok().map(|[one]| one);
                terms.are_units_in(cell, one)
            }
            Self::Reference => {
                let plain = squeezed(cell);
                let known: &[&str] = match terms.point() {
                    InertiaPoint::MassCentre => &[
                        "cg",
                        "cog",
                        "com",
                        "cm",
                        "masscentre",
                        "masscenter",
                        "centreofmass",
                        "centerofmass",
                        "centreofgravity",
                        "centerofgravity",
                        "own",
                    ],
                    InertiaPoint::Origin => &["origin", "frameorigin", "coordinateorigin"],
                };
                let of_part = ["own", "its", "the", "part", "parts"];
                let before = of_part.iter().find_map(|word| plain.strip_prefix(word));
                let behind = ["ofpart", "ofthepart"].iter().find_map(|end| plain.strip_suffix(end));
                [Some(plain.as_str()), before, behind]
                    .iter()
                    .flatten()
                    .any(|word| known.contains(word))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column of an inertia about another point holds numbers, and a point is none.
    #[test]
    fn an_inertia_about_another_point_is_told_so() {
        for (heading, kind) in [
            ("Ixx (origin)", Unread::Reference),
            ("Iyy at origin", Unread::Reference),
            ("MOI about", Unread::Reference),
        ] {
            assert_eq!(Unread::of(heading), Some(kind), "{heading}");
            for (cell, expected) in [
                ("10", "this column must be left out"),
                ("-1e-3", "this column must be left out"),
                ("datum", "the column must be empty, or say so"),
            ] {
                let problem = kind
                    .problem(heading, cell, &TableTerms::default())
                    .map(|found| found.to_string());
                assert!(
                    problem.as_ref().is_some_and(|said| said.contains(expected)),
                    "{heading} {cell} {problem:?}"
                );
            }
        }
    }

    /// Words that may be numbers were none in columns of angles and of growth.
    #[test]
    fn no_word_that_may_be_a_number_is_neutral() {
        let terms = TableTerms::default();
        for what in [Unread::Count, Unread::Turn, Unread::Growth] {
            for word in
                ["four", "ninety", "half", "½", "IV", "pair", "up", "?", "yes", "15%", "90", "1e-3"]
            {
                assert!(!what.is_neutral("", word, &terms), "{what:?} {word}");
            }
        }
        for what in [Unread::Turn, Unread::Growth] {
            for word in ["0", "0.0", "-0", "0 %", "0°", "-", "none", "N/A", "Zero"] {
                let is_of_other = what == Unread::Turn && word == "0 %";
                assert!(is_of_other || what.is_neutral("", word, &terms), "{what:?} {word}");
            }
        }
        for (what, heading, cell, expected) in [
            (Unread::Turn, "R11", "1", true),
            (Unread::Turn, "R12", "1", false),
            (Unread::Turn, "DCM33", "1.0", true),
            (Unread::Turn, "roll", "1", false),
            (Unread::Turn, "rotation matrix", "[1 0 0; 0 1 0; 0 0 1]", true),
            (Unread::Turn, "rotation matrix", "1 0 0; 0 0 1; 0 1 0", false),
            (Unread::Turn, "quaternion", "0 0 0 1", false),
            (Unread::Growth, "Growth factor", "1.00", true),
            (Unread::Growth, "growth factor", "1.1", false),
            (Unread::Growth, "growth", "1", false),
            (Unread::Count, "Qty", "1 ea", true),
            (Unread::Count, "Qty", "1 EA", true),
            (Unread::Count, "Qty", "1x", true),
            (Unread::Count, "Qty", "2 ea", false),
            (Unread::Count, "Qty", "ea", false),
            (Unread::Reference, "about", "CG of part", true),
            (Unread::Reference, "about", "centre of mass of the part", true),
            (Unread::Reference, "about", "origin of part", false),
        ] {
            assert_eq!(what.is_neutral(heading, cell, &terms), expected, "{heading} {cell}");
        }
        let is_neutral = |cell| Unread::Turn.is_neutral("", cell, &terms);
        assert!(is_neutral("[0, 0, 0]") && !is_neutral("[0, ninety, 0]"));
    }
}
