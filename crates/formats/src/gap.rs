//! Parts of a file that were not read though the rest of it was, and why.

use std::fmt;

use crate::body::shortened;

/// Why a part of a file was not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GapKind {
    /// Entities that the file declares itself: they may stand for bodies, numbers and names, and are not expanded.
    Entities,
    /// Macros of xacro, and inertias that are written with its expressions.
    Macros,
    /// Other files that this one includes.
    Included,
    /// Inertias that the simulator computes from shapes (`auto="true"` in SDF).
    Computed,
    /// Inertias where the format has none.
    Misplaced,
    /// Keys of bodies, and of the document around them, that mean nothing here, as files of other programs have.
    Keys,
    /// A column of units in a table that names things, as those of a series.
    Things,
    /// Columns of a table that mean nothing here.
    Columns {
        /// Whether another column holds the masses.
        has_masses: bool,
    },
}

/// Parts of one kind that were not read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gap {
    kind: GapKind,
    line: usize,
    count: usize,
    files: Vec<String>,
    keys: Vec<String>,
}

/// Keys that are named at most.
const KEYS: usize = 10;

impl Gap {
    /// Why they were not read.
    #[must_use]
    pub fn kind(&self) -> GapKind {
        self.kind
    }

    /// Line of the first, from 1.
    #[must_use]
    pub fn line(&self) -> usize {
        self.line
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The included files, as they are written.
    #[must_use]
    pub fn files(&self) -> &[String] {
        &self.files
    }

    /// The keys or columns that are not read, each once, in the order of the file.
    #[must_use]
    pub fn keys(&self) -> &[String] {
        &self.keys
    }

    /// Whether there may be bodies in what was not read.
    #[must_use]
    pub fn may_hold_bodies(&self) -> bool {
        match self.kind {
            GapKind::Entities
            | GapKind::Macros
            | GapKind::Included
            | GapKind::Computed
            | GapKind::Misplaced => true,
            GapKind::Keys | GapKind::Columns { .. } | GapKind::Things => false,
        }
    }

    /// Whether the file is broken for every reader that is like this one, and not only left out in
    /// part: that what it holds is not known is an error then.
    #[must_use]
    pub fn is_error(&self) -> bool {
        match self.kind {
            GapKind::Entities => true,
            GapKind::Macros
            | GapKind::Included
            | GapKind::Computed
            | GapKind::Misplaced
            | GapKind::Keys
            | GapKind::Columns { .. }
            | GapKind::Things => false,
        }
    }
}

impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let n = self.count;
        let count = |one: &str, many: &str| {
            if n == 1 { format!("1 {one}") } else { format!("{n} {many}") }
        };
        match self.kind {
            GapKind::Entities => write!(
                f,
                "{} not expanded: bodies, numbers or names may be missing here",
                count("reference to an entity of the file is", "references to entities are")
            ),
            GapKind::Macros => write!(
                f,
                "{}: expand the file first, with `xacro file.xacro > file.urdf`",
                count("macro or expression", "macros and expressions")
            ),
            GapKind::Included => {
                write!(f, "{} not followed", count("included file is", "included files are"))?;
                let first = self.files.first().map(|file| shortened(file));
                first.map_or(Ok(()), |first| write!(f, ": {first}"))?;
                f.write_str(if self.files.len() > 1 { " and others" } else { "" })
            }
            GapKind::Computed => write!(
                f,
                "{} computed from shapes by the simulator",
                count("inertia is", "inertias are")
            ),
            GapKind::Misplaced => write!(
                f,
                "{} where this format has none",
                count("inertia stands", "inertias stand")
            ),
            GapKind::Keys => self.name_keys(f, ["key", "keys"]),
            GapKind::Columns { has_masses } => {
                self.name_keys(f, ["column", "columns"])?;
                f.write_str(if has_masses { "" } else { "; no column of masses is read" })
            }
            GapKind::Things => {
                self.name_keys(f, ["column", "columns"])?;
                f.write_str("; the cells name things and no units")
            }
        }
    }
}

impl Gap {
    /// That the keys, which are called so, are not read.
    fn name_keys(&self, f: &mut fmt::Formatter<'_>, [one, many]: [&str; 2]) -> fmt::Result {
        let (named, rest) = self.keys.split_at(self.keys.len().min(KEYS));
        let named: Vec<String> = named.iter().map(|key| shortened(key)).collect();
        let are = if self.keys.len() == 1 { format!("{one} is") } else { format!("{many} are") };
        write!(f, "{} {are} not read: {}", self.keys.len(), named.join(", "))?;
        if rest.is_empty() { Ok(()) } else { write!(f, " and {} more", rest.len()) }
    }
}

/// The gaps of a file as they are found, those of one kind together.
#[derive(Debug, Default)]
pub(crate) struct Gaps(Vec<Gap>);

impl Gaps {
    pub(crate) fn add(&mut self, kind: GapKind, line: usize) {
        self.add_file(kind, line, None);
    }

    /// As [`add`](Self::add), of a part that is in another file, if it says which.
    pub(crate) fn add_file(&mut self, kind: GapKind, line: usize, file: Option<&str>) {
        let files = file.map(str::to_owned).into_iter();
        match self.0.iter_mut().find(|gap| gap.kind == kind) {
            Some(gap) => {
                gap.count += 1;
                gap.files.extend(files);
            }
            None => {
                let (files, keys) = (files.collect(), Vec::new());
                self.0.push(Gap { kind, line, count: 1, files, keys });
            }
        }
    }

    /// Adds keys or columns that are not read, each once, and the line of the first.
    pub(crate) fn add_keys(&mut self, kind: GapKind, line: usize, keys: Vec<String>) {
        let count = keys.len();
        self.0.push(Gap { kind, line, count, files: Vec::new(), keys });
    }

    /// In the order of their first lines.
    pub(crate) fn into_vec(mut self) -> Vec<Gap> {
        self.0.sort_by_key(|gap| gap.line);
        self.0
    }
}
