//! Why a list of parts could not be read.

use std::fmt;

use crate::{FileBodyError, FileProblem, UnitError, body::shortened, error::Refusal};

/// How many headings a message names.
const NAMED: usize = 6;

/// Which of the two tables of a list of parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartsFile {
    /// The one that holds the parts.
    Parts,
    /// The one that says what belongs to what.
    Edges,
}

/// Why a list of parts could not be read.
#[derive(Debug)]
pub struct PartsError {
    place: Box<Place>,
    problem: PartsProblem,
}

/// Where it could not be read.
#[derive(Debug)]
struct Place {
    file: PartsFile,
    line: Option<usize>,
    name: Option<String>,
    /// Headings that mean nothing here, one of which may be meant for what is missing.
    passed_over: Vec<String>,
}

impl PartsError {
    pub(super) fn new(line: usize, name: Option<&str>, problem: PartsProblem) -> Self {
        Self::at(Some(line), name, problem)
    }

    fn at(line: Option<usize>, name: Option<&str>, problem: PartsProblem) -> Self {
        let (file, name) = (PartsFile::Parts, name.map(str::to_owned));
        Self { place: Box::new(Place { file, line, name, passed_over: Vec::new() }), problem }
    }

    /// With the headings that mean nothing here, if something is missing.
    pub(super) fn beside(mut self, passed_over: &[String]) -> Self {
        if let PartsProblem::Number(FileBodyError::Missing { .. })
        | PartsProblem::NoInertia
        | PartsProblem::NoColumn { .. }
        | PartsProblem::Shape { .. } = self.problem
        {
            self.place.passed_over = passed_over.to_vec();
        }
        self
    }

    pub(super) fn in_edges(mut self) -> Self {
        self.place.file = PartsFile::Edges;
        self
    }

    /// The table in which it is.
    #[must_use]
    pub fn file(&self) -> PartsFile {
        self.place.file
    }

    /// Line, from 1, if the problem has one.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        self.place.line
    }

    /// What is wrong.
    #[must_use]
    pub fn problem(&self) -> &PartsProblem {
        &self.problem
    }
}

impl From<Refusal> for PartsError {
    fn from(Refusal { line, problem }: Refusal) -> Self {
        Self::at(line, None, PartsProblem::File(problem))
    }
}

impl fmt::Display for PartsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { file: _, line, name, passed_over } = &*self.place;
        if let Some(line) = line {
            write!(f, "line {line}: ")?;
        }
        if let Some(name) = name {
            write!(f, "{}: ", shortened(name))?;
        }
        write!(f, "{}", self.problem)?;
        match passed_over.as_slice() {
            [] => Ok(()),
            [one] => write!(f, "; nothing is read from the column {one:?}"),
            some => {
                let named = some.iter().take(NAMED).map(|heading| format!("{heading:?}"));
                let named = named.collect::<Vec<_>>().join(", ");
                write!(f, "; nothing is read from the columns {named}")?;
                match some.len().saturating_sub(NAMED) {
                    0 => Ok(()),
                    more => write!(f, " and {more} more"),
                }
            }
        }
    }
}

impl std::error::Error for PartsError {}

/// What is wrong with a list of parts.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartsProblem {
    /// It is no table.
    #[error(transparent)]
    File(FileProblem),
    /// A column is missing.
    #[error("no column is called {column}, and there must be one")]
    NoColumn {
        /// Its names.
        column: &'static str,
    },
    /// A header alone.
    #[error("no row stands below the header: each part must have one")]
    NoRows,
    /// Two columns for one thing.
    #[error("columns {first:?} and {second:?} say the same: there must be one of them")]
    Columns {
        /// One heading.
        first: String,
        /// The other.
        second: String,
    },
    /// A column that looks like a standard deviation and is none that is known.
    #[error(
        "column {heading:?} is no standard deviation that is known: it must be sigma_ or _percent of \
         mass, centre, centre_x, ixx, moments and so on, in a unit that is read"
    )]
    Deviation {
        /// The heading.
        heading: String,
    },
    /// A column that looks like a standard deviation of a size of a shape.
    #[error(
        "column {heading:?} speaks of how far a size may be off, and sizes have no standard deviation here: the column must be left \
         out, and what it means for the inertia can be stated as sigma_ or _percent of ixx, moments and so on"
    )]
    SizeDeviation {
        /// The heading.
        heading: String,
    },
    /// A cell that says it is not known, in a column where an empty one stands for a number.
    #[error(
        "column {heading:?} says \"NA\", and what is not known is no number: the cell must hold a number, or be empty, which stands \
         for none: for no deviation, a product of zero, axes that are not turned, or one part"
    )]
    NotKnown {
        /// The heading.
        heading: String,
    },
    /// A unit in the row below the header, of a column that cannot have it.
    #[error("column {heading:?} has the unit {unit:?} below it: it must be {allowed}")]
    UnitBelow {
        /// The heading.
        heading: String,
        /// The unit.
        unit: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A column of percentages that are no standard deviations.
    #[error(
        "column {heading:?} has the share of each part in the mass of all or of its assembly, which is no standard deviation: the column must be left out, or, if it is \
         one, be called sigma_mass_percent"
    )]
    Shares {
        /// The heading.
        heading: String,
    },
    /// A row with numbers below another one with numbers, to which it belongs.
    #[error(
        "column {heading:?} says that the row belongs to {above:?}, and both have numbers, which rollup would count twice: the row of an \
         assembly must be left out, or have no numbers, and then a column \"parent\" must say which rows belong to it; if {heading:?} says \
         something else, it must be written otherwise"
    )]
    Level {
        /// The heading.
        heading: String,
        /// The name of the row that it belongs to.
        above: String,
    },
    /// A row that sums up others.
    #[error(
        "the name is that of a row which sums up others, and rollup would count it as a part: it must be left out, or \
         have the name of a part"
    )]
    Summary,
    /// A column of a number whose unit is not read.
    #[error(transparent)]
    Unit(#[from] Box<UnitError>),
    /// A number is missing, none, or not finite, the row has too many or too few, or a cell that is not read would change them.
    #[error(transparent)]
    Number(#[from] FileBodyError),
    /// A shape that cannot be made.
    #[error("shape: {message}")]
    Shape {
        /// Why.
        message: String,
    },
    /// A size in a row that has no shape which has sizes.
    #[error(
        "column {heading:?} says {value:?}, which is a size of a shape, and {what}: the cell must be empty or 0, or the column \"shape\" \
         must name the shape"
    )]
    Size {
        /// The heading.
        heading: String,
        /// The cell.
        value: String,
        /// What the row is.
        what: &'static str,
    },
    /// Neither inertia nor shape.
    #[error(
        "there is no inertia: the row must have ixx, iyy and izz, the radii of gyration kx, ky and kz, a shape with its \
         sizes, or the shape \"point\""
    )]
    NoInertia,
    /// Both inertia and shape.
    #[error("both an inertia and the shape {shape:?} are given: there must be one of them")]
    InertiaAndShape {
        /// The shape.
        shape: String,
    },
    /// Two statements that contradict each other.
    #[error("{first} and {second} contradict each other: one of them must go, or say the same")]
    Contradiction {
        /// One of them.
        first: String,
        /// The other.
        second: String,
    },
    /// Nobody says which sign the products have.
    #[error(
        "{field} is not zero, and nothing says which sign products have: there must be a column \
         products that holds tensor (I12 = -∫xy dm) or integrals (+∫xy dm), a line \"# products = …\" \
         above the header, or the option --products"
    )]
    Sign {
        /// The product.
        field: &'static str,
    },
    /// Both an absolute deviation and one in percent, or one for all and one for each.
    #[error("{field} is given twice: there must be one number for it")]
    Twice {
        /// Of what.
        field: &'static str,
    },
    /// A number that must not be negative, or a rotation that is none.
    #[error("{field} = {value:?}: it must be {allowed}")]
    Value {
        /// The column.
        field: &'static str,
        /// The value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// An edge stands twice, as if the child were there twice.
    #[error(
        "{child:?} belongs to {parent:?} in line {first} already: a row is one part, and more of them must stand in the list \
         under names of their own, each with its own mass centre"
    )]
    EdgeTwice {
        /// The row.
        child: String,
        /// What it belongs to.
        parent: String,
        /// The line that says it first.
        first: usize,
    },
    /// An edge gives a second parent.
    #[error("{child:?} belongs to {first:?} and to {second:?}: it must belong to one of them")]
    Parents {
        /// The row.
        child: String,
        /// One that it belongs to.
        first: String,
        /// The other.
        second: String,
    },
}
