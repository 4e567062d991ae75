//! Columns that would change the numbers of a row, and are not read.

use crate::{
    FileBodyError,
    body::shortened,
    rows::is_blank,
    spread::words,
    table_terms::{InertiaPoint, TableTerms, dimension_of},
    units::{Dimension, squeezed},
};

/// What would change the numbers of a row, and is not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unread {
    /// How many parts a row is.
    Count,
    /// An angle by which the part is turned, or another form of its attitude.
    Turn,
    /// A growth allowance of the mass.
    Growth,
    /// The unit of a row.
    Unit,
    /// The point that the inertia is about, or the frame that it is in.
    Reference,
    /// Which sign products have.
    Sign,
}

/// A kind: words that a heading of it has, one of each list and in this order, and words that may stand beside them. With any other
/// word, it is a heading of something else, as `pitch diameter`.
type Words = (Unread, &'static [&'static [&'static str]], &'static [&'static str]);

/// Names of the inertia as a whole.
const INERTIAS: [&str; 7] = ["inertia", "inertias", "moi", "mois", "moments", "poi", "products"];

/// Words for the point or the frame of an inertia, and what may stand beside them.
const REFERENCES: [&str; 7] = ["about", "at", "reference", "ref", "frame", "origin", "wrt"];
const BESIDE_REFERENCES: [&str; 7] = ["of", "taken", "the", "point", "and", "axis", "axes"];

const KINDS: [Words; 10] = [
    // Before counts: `units` alone are those of the row.
    (
        Unread::Unit,
        &[&["unit", "units", "uom"]],
        &["of", "for", "the", "and", "in", "used", "system", "measure", "measurement"],
    ),
    // A `part number` names a part, and a `number of parts` counts it.
    (Unread::Count, &[&["number", "num"]], &[]),
    (
        Unread::Count,
        &[
            &["no", "nr", "num", "number", "n"],
            &["parts", "items", "bodies", "components", "identical", "per", "of"],
        ],
        &["the", "in", "assembly", "assy", "set", "item", "total"],
    ),
    (
        Unread::Count,
        &[&[
            "qty",
            "quantity",
            "amount",
            "multiplier",
            "mult",
            "count",
            "pcs",
            "pieces",
            "multiplicity",
            "instances",
            "copies",
            "ea",
            "off",
            "units",
            "anzahl",
            "menge",
            "stk",
            "stück",
            "qté",
            "qte",
        ]],
        &[
            "no", "nr", "num", "number", "n", "of", "part", "parts", "total", "per", "assembly",
            "assy", "set", "item", "items", "the", "in", "unit",
        ],
    ),
    (
        Unread::Turn,
        &[&[
            "roll",
            "pitch",
            "yaw",
            "euler",
            "rpy",
            "rot",
            "rotx",
            "roty",
            "rotz",
            "rotation",
            "rx",
            "ry",
            "rz",
            "theta",
            "phi",
            "psi",
            "angle",
            "angles",
            "clocking",
            "tilt",
            "attitude",
            "azimuth",
            "elevation",
            "orientation",
            "quat",
            "quaternion",
            "dcm",
            "q0",
            "q1",
            "q2",
            "q3",
            "q4",
            "dcm11",
            "dcm12",
            "dcm13",
            "dcm21",
            "dcm22",
            "dcm23",
            "dcm31",
            "dcm32",
            "dcm33",
            "r11",
            "r12",
            "r13",
            "r21",
            "r22",
            "r23",
            "r31",
            "r32",
            "r33",
        ]],
        &[
            "deg", "degree", "degrees", "rad", "radians", "x", "y", "z", "w", "1", "2", "3",
            "about", "axis", "xyz", "zyx", "matrix",
        ],
    ),
    (
        Unread::Growth,
        &[&["mga", "growth", "contingency", "margin"]],
        &[
            "mass",
            "allowance",
            "percent",
            "pct",
            "kg",
            "g",
            "lb",
            "factor",
            "with",
            "incl",
            "including",
            "and",
        ],
    ),
    (Unread::Reference, &[&INERTIAS, &REFERENCES], &BESIDE_REFERENCES),
    (Unread::Reference, &[&["about"]], &["taken", "the", "point"]),
    (
        Unread::Sign,
        &[&["sign", "signs"]],
        &["of", "the", "products", "product", "poi", "pois", "inertia", "convention"],
    ),
    (
        Unread::Sign,
        &[
            &["products", "product", "poi", "pois", "inertia"],
            &["sign", "signs", "convention", "conv"],
        ],
        &["of", "the"],
    ),
];

/// Words and marks that say of an angle or an allowance that there is none.
const NONE: [&str; 9] = ["-", "--", "–", "—", "none", "nil", "zero", "n/a", "identity"];

impl Unread {
    /// What a heading holds of this kind.
    pub(crate) fn of(heading: &str) -> Option<Self> {
        // What is written with marks between its letters is one word.
        let lower = heading.to_lowercase().replace("u.o.m", "uom").replace("u/m", "uom");
        let all: Vec<&str> = words(&lower).filter(|word| !word.is_empty()).collect();
        let is_of = |(kind, lists, beside): &&Words| {
            let mut rest = all.iter();
            let is_key = |word: &&str| lists.iter().any(|keys| keys.contains(word));
            // Units may be those of anything.
            let is_measured = |word: &&str| *kind == Self::Unit && dimension_of(word).is_some();
            lists.iter().all(|keys| rest.any(|word| keys.contains(word)))
                && all.iter().all(|word| is_key(word) || is_measured(word) || beside.contains(word))
        };
        KINDS.iter().find(is_of).map(|(kind, ..)| *kind)
    }

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
            why: self.because(terms),
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
            Self::Unit | Self::Reference => {
                let says_something = cell.contains(char::is_alphabetic);
                says_something.then(|| self.problem(heading, cell, terms)).flatten()
            }
            Self::Count | Self::Turn | Self::Sign | Self::Growth => None,
        }
    }

    /// Why such a column must not say it, and what to do.
    fn because(self, terms: &TableTerms) -> &'static str {
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
                 or name the same units, each as a heading may name it"
            }
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
                cell.eq_ignore_ascii_case("one")
                    || of(cell.trim_matches(['x', 'X', '×', ' '])) == Some(1.0)
            }
            Self::Turn => {
                let words = cell.split([' ', ',', ';', '[', ']', '(', ')']);
                is_none || words.filter(|word| !word.is_empty()).all(|word| of(word) == Some(0.0))
            }
            Self::Growth => is_none || of(cell) == Some(0.0),
            // Signs alone say something here.
            Self::Sign => false,
            Self::Unit => {
                let heading = heading.to_lowercase();
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
                let rest = of_part.iter().find_map(|word| plain.strip_prefix(word));
                [rest.unwrap_or(&plain), &plain].iter().any(|word| known.contains(word))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_something_else_are_none() {
        for (heading, kind) in [
            ("Qty", Unread::Count),
            ("Total Qty", Unread::Count),
            ("No. of units", Unread::Count),
            ("# off", Unread::Count),
            ("Anzahl", Unread::Count),
            ("Rot X (deg)", Unread::Turn),
            ("theta_z", Unread::Turn),
            ("q1", Unread::Turn),
            ("clocking angle [deg]", Unread::Turn),
            ("Tilt (deg)", Unread::Turn),
            ("attitude", Unread::Turn),
            ("MGA %", Unread::Growth),
            ("mass with margin [kg]", Unread::Growth),
            ("unit", Unread::Unit),
            ("Units", Unread::Unit),
            ("length unit", Unread::Unit),
            ("inertia_units", Unread::Unit),
            ("unit of mass", Unread::Unit),
            ("Ixx units", Unread::Unit),
            ("ixx_unit", Unread::Unit),
            ("I_yz units", Unread::Unit),
            ("I unit", Unread::Unit),
            ("u.o.m.", Unread::Unit),
            ("U/M", Unread::Unit),
            ("MOI (UoM)", Unread::Unit),
            ("Unit of measure", Unread::Unit),
            ("system of units", Unread::Unit),
            ("Number of parts", Unread::Count),
            ("n_parts", Unread::Count),
            ("No. of items per assembly", Unread::Count),
            ("number", Unread::Count),
            ("Num.", Unread::Count),
            ("number of", Unread::Count),
            ("number per set", Unread::Count),
            ("multiplier", Unread::Count),
            ("mult", Unread::Count),
            ("Amount", Unread::Count),
            ("unit qty", Unread::Count),
            ("Qty per unit", Unread::Count),
            ("R11", Unread::Turn),
            ("rotation matrix", Unread::Turn),
            ("inertia about", Unread::Reference),
            ("MOI ref. point", Unread::Reference),
            ("moments about the point", Unread::Reference),
            ("about", Unread::Reference),
            ("about point", Unread::Reference),
            ("Inertia Ref", Unread::Reference),
            ("inertia reference", Unread::Reference),
            ("MOI reference", Unread::Reference),
            ("Inertia at", Unread::Reference),
            ("MOI at", Unread::Reference),
            ("inertia_frame", Unread::Reference),
            ("POI ref. axes", Unread::Reference),
            ("sign", Unread::Sign),
            ("POI sign", Unread::Sign),
            ("Sign of products", Unread::Sign),
            ("product convention", Unread::Sign),
        ] {
            assert_eq!(Unread::of(heading), Some(kind), "{heading}");
        }
        for heading in [
            "pitch diameter [mm]",
            "Roll number",
            "Rotation speed rpm",
            "yaw actuator id",
            "attitude sensor",
            "thermal margin",
            "growth rate",
            "margin notes",
            "Quantity unit price",
            "count verified by",
            "pieces drawing",
            "part number",
            "item number",
            "assembly no.",
            "parts number",
            "serial number",
            "No.",
            "n",
            "amount paid",
            "unit price",
            "R1",
            "R110",
            "inertia class",
            "about the supplier",
            "reference",
            "frame",
            "signed by",
            "moments",
            "material",
            "",
            "#",
            "x",
        ] {
            assert_eq!(Unread::of(heading), None, "{heading}");
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
        let is_neutral = |cell| Unread::Turn.is_neutral("", cell, &terms);
        assert!(is_neutral("[0, 0, 0]") && !is_neutral("[0, ninety, 0]"));
    }
}
