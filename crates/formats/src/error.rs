//! Why a file could not be read.

use std::{
    fmt, io,
    path::{Path, PathBuf},
};

use crate::{MAX_ATTRIBUTES, MAX_BODIES, MAX_DEPTH};

/// Why a file, as a whole, could not be read.
#[derive(Debug)]
pub struct FileError {
    path: PathBuf,
    line: Option<usize>,
    problem: FileProblem,
    bearing: Bearing,
}

/// What a file that was not read has to do with inertias, as far as can be told without reading it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bearing {
    /// It is there to hold them, or speaks of them where it breaks off.
    Holds,
    /// It speaks of them, or is of a kind that may hold them and is not read here.
    MayHold,
    /// Nothing in it speaks of them.
    Nothing,
}

impl FileError {
    pub(crate) fn new(path: &Path, refusal: Refusal, bearing: Bearing) -> Self {
        let Refusal { line, problem } = refusal;
        Self { path: path.to_owned(), line, problem, bearing }
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Line, from 1, if the problem has one.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        self.line
    }

    /// What is wrong.
    #[must_use]
    pub fn problem(&self) -> &FileProblem {
        &self.problem
    }

    /// What the file has to do with inertias. All but [`Bearing::Holds`] are to be passed over where
    /// nobody asked for this file by name: a configuration, a table of something else.
    #[must_use]
    pub fn bearing(&self) -> Bearing {
        self.bearing
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}", self.problem)
    }
}

impl std::error::Error for FileError {}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileProblem {
    /// The system does not hand it out.
    #[error("it cannot be read: {0}")]
    Io(io::Error),
    /// A folder, a pipe, a device.
    #[error("it is not a regular file")]
    NotAFile,
    /// Too many bytes.
    #[error("it is larger than {} MiB, the most that is read", .limit >> 20)]
    TooLarge {
        /// The most that is read, in bytes.
        limit: usize,
    },
    /// Elements, lists or tables nested too deeply.
    #[error("it is nested deeper than {MAX_DEPTH} levels, the most that is read")]
    TooDeep,
    /// Too many bodies.
    #[error("it holds more than {MAX_BODIES} bodies, the most that is read")]
    TooManyBodies,
    /// Too many attributes.
    #[error("an element has more than {MAX_ATTRIBUTES} attributes, the most that is read")]
    TooManyAttributes,
    /// Nothing in it.
    #[error("it is empty")]
    Empty,
    /// Sixteen bits a character.
    #[error("it is encoded in UTF-16: save it as UTF-8")]
    Utf16,
    /// A table in Parquet.
    #[error("it is a Parquet file, which is not read here: save the table as CSV")]
    Parquet,
    /// An archive, as a spreadsheet is.
    #[error("it is a ZIP archive, as spreadsheets (.xlsx, .ods) are: save the table as CSV")]
    Zip,
    /// Zero bytes in it.
    #[error("it is binary, not text")]
    Binary,
    /// Bytes that are not UTF-8.
    #[error(
        "it is not UTF-8, and declares no other encoding that is read (ISO-8859, Windows-125x)"
    )]
    NotUtf8,
    /// Lines of a table that no line feed ends.
    #[error(
        "its lines end in carriage returns (CR) alone, so that all of it is one line: save it with lines \
         that end in LF or CR LF"
    )]
    CarriageReturns,
    /// A format that may hold inertias and is not read.
    #[error("{format} files are not read here: convert it to URDF, MJCF or SDF")]
    NotRead {
        /// Its name.
        format: &'static str,
    },
    /// A compressed file, or an archive of files.
    #[error("it is compressed, or an archive of files: expand it first")]
    Compressed,
    /// A file from which a program makes one that could be read.
    #[error("it is a template: expand it first")]
    Template,
    /// Inertias in an XML file of which neither root nor form tells what they mean.
    #[error(
        "its root element is <{root}>, and its inertias are written as in none or several of URDF, \
         MJCF and SDF"
    )]
    Unclear {
        /// The root element.
        root: String,
    },
    /// A folder without any file that would be read.
    #[error("no file in it has an extension that is read")]
    EmptyFolder,
    /// A column that must be a product of inertia, of a name that does not tell its sign, where no other holds it.
    #[error(
        "column {heading:?} looks like a product of inertia and is not read: it must be called ixy, ixz or \
         iyz, and a line \"# products = tensor\" or \"# products = integrals\" above the header says \
         which sign it has"
    )]
    Product {
        /// The heading, shortened.
        heading: String,
    },
    /// A column of a number with a minus or a plus in its heading.
    #[error(
        "column {heading:?}: a heading must not have a sign; a line \"# products = integrals\" above the header, or \
         a column products, says which sign products have"
    )]
    Sign {
        /// The heading, shortened.
        heading: String,
    },
    /// A column of a number states no unit, and another states one that is not of SI.
    #[error(
        "column {heading:?} states no unit, and column {other:?} states one that is not of SI: both must state theirs, in the heading or in \
         a row below the header"
    )]
    NoUnit {
        /// The heading without a unit, shortened.
        heading: String,
        /// The heading with one, shortened.
        other: String,
    },
    /// A title, or a comment, states units that are not of SI, or may not be, and some column states none.
    #[error(
        "{said:?} speaks of units that are not, or may not be, those of SI: units are read from the headings of columns, or a row below \
         them, alone, and there each column of masses, lengths or inertias must state its own"
    )]
    TitleUnits {
        /// The line, shortened.
        said: String,
    },
    /// A title, or a comment, says that inertias are about a point other than that of the table.
    #[error(
        "{said:?} speaks of the point that inertias are about, and that point may not be {point}: the inertia of each row must be about that, and the line must say so, or \
         not speak of it"
    )]
    TitlePoint {
        /// The line, shortened.
        said: String,
        /// What inertias are about in such a table.
        point: String,
    },
    /// Its grammar is broken.
    #[error("malformed: {message}")]
    Malformed {
        /// What the grammar wants.
        message: String,
    },
    /// Well-formed, perhaps, but no format of ours.
    #[error("not a format that is read here: {message}")]
    Unknown {
        /// What was found, and what is read.
        message: String,
    },
}

impl From<io::Error> for FileProblem {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// A place in a text that refuses the whole file, and why.
#[derive(Debug)]
pub(crate) struct Refusal {
    /// Line, from 1.
    pub(crate) line: Option<usize>,
    pub(crate) problem: FileProblem,
}

impl From<FileProblem> for Refusal {
    fn from(problem: FileProblem) -> Self {
        Self { line: None, problem }
    }
}

/// What is said beside a number with a comma, or of another base.
fn hint(value: &str) -> &'static str {
    if value.contains(',') && value.replace([',', '.'], "").parse::<f64>().is_ok() {
        ": decimal commas are not read, and neither are commas between thousands: a point must stand before decimals, and nothing between \
         other digits"
    } else if ["0x", "0o", "0b"].iter().any(|prefix| value.starts_with(prefix)) {
        " that is read here: it must have decimal digits"
    } else {
        ""
    }
}

/// Why the inertia of one body could not be read; its neighbours can.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FileBodyError {
    /// A field is not there.
    #[error("{field} is missing")]
    Missing {
        /// The field.
        field: &'static str,
    },
    /// A field holds no number.
    #[error("{field} = \"{value}\" is not a number{}", hint(value))]
    NotANumber {
        /// The field.
        field: &'static str,
        /// What it holds, shortened.
        value: String,
    },
    /// A field holds more than plain text.
    #[error(
        "{field} = \"{value}\" is not a plain number: it must be written without comments, references \
         or elements in it"
    )]
    NotPlain {
        /// The field.
        field: &'static str,
        /// What it holds, shortened.
        value: String,
    },
    /// A field holds a xacro expression.
    #[error(
        "{field} = \"{value}\" is not a number but an expression: expand the file first, with \
         `xacro file.xacro > file.urdf`"
    )]
    Expression {
        /// The field.
        field: &'static str,
        /// What it holds, shortened.
        value: String,
    },
    /// NaN, infinite, or too large for double precision.
    #[error("{field} = \"{value}\": it must be finite")]
    NotFinite {
        /// The field.
        field: &'static str,
        /// What it holds, shortened.
        value: String,
    },
    /// Not as many numbers as there should be.
    #[error("{field} has {found} values: there must be {allowed}")]
    Count {
        /// The field.
        field: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        allowed: usize,
    },
    /// Something else than the schema asks for.
    #[error("{field}: there must be {allowed}")]
    Shape {
        /// The field.
        field: &'static str,
        /// What there must be.
        allowed: &'static str,
    },
    /// A word that is none of those known.
    #[error("{field} = {value:?}: it must be {allowed}")]
    Word {
        /// The field.
        field: &'static str,
        /// What it holds, shortened.
        value: String,
        /// What it may hold.
        allowed: &'static str,
    },
    /// A cell that would change the numbers of its row, in a column that is not read.
    #[error("column {heading:?} says {value:?}: {why}")]
    Unread {
        /// The heading, shortened.
        heading: String,
        /// What the cell holds, shortened.
        value: String,
        /// Why it must not say so, and what to do.
        why: &'static str,
    },
    /// A key that must be a slip for one of those that are known.
    #[error("the key {key:?} is not read here: the keys are {allowed}")]
    Key {
        /// The key, shortened.
        key: String,
        /// Those that are read.
        allowed: &'static str,
    },
    /// An attribute that stands for a number where readers look for an element.
    #[error(
        "{field} is an attribute, which SDFormat 1.0 has: readers of the version of this file take \
         no notice of it"
    )]
    Attribute {
        /// The field.
        field: &'static str,
    },
    /// An element that stands more than once where it may stand once.
    #[error("there is more than one <{element}>: there must be one")]
    Several {
        /// The element.
        element: &'static str,
    },
    /// Two fields that exclude each other.
    #[error("both {first} and {second} are given: there must be one of them")]
    Both {
        /// One field.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
}
