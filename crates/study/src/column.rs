//! The columns of the run table: their names, their order and their types.

use std::borrow::Cow;

use crate::{body::Body, quantity::Quantity};

/// A column of the run table.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Column<'a> {
    Model,
    Run,
    Status,
    Number(Quantity),
    Realizable,
    /// A component of the attitude of a body's principal axes, scalar last.
    Axes(Body, usize),
    ReleaseOrder,
    Recompressed,
    /// What else was drawn, by its place and its name.
    Drawn(usize, &'a str),
    ClearanceNote,
}

/// What a column holds.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Text,
    Integer,
    Number,
    Flag,
}

struct Declaration<'a> {
    name: Cow<'a, str>,
    kind: Kind,
    /// Whether some runs have nothing there.
    optional: bool,
    unit: Option<&'static str>,
    meaning: &'a str,
}

/// What stands in a column for a run.
#[derive(Clone, Debug)]
pub(crate) enum Cell {
    Text(String),
    Integer(i64),
    Number(f64),
    Flag(bool),
    Null,
}

/// Numbers are the same if their bits are.
impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Text(a), Self::Text(b)) => a == b,
            (Self::Integer(a), Self::Integer(b)) => a == b,
            (Self::Number(a), Self::Number(b)) => a.to_bits() == b.to_bits(),
            (Self::Flag(a), Self::Flag(b)) => a == b,
            (Self::Null, Self::Null) => true,
            _ => false,
        }
    }
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Text(text) => write!(f, "{text}"),
            Self::Integer(integer) => write!(f, "{integer}"),
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Null => write!(f, "nothing"),
        }
    }
}

impl<'a> Column<'a> {
    /// All columns, in order, of these quantities and of what else was drawn.
    pub(crate) fn of(quantities: impl Iterator<Item = Quantity>, drawn: &'a [String]) -> Vec<Self> {
        let mut columns = vec![Self::Model, Self::Run, Self::Status];
        for quantity in quantities {
            columns.push(Self::Number(quantity));
            if quantity == Quantity::LAST_BEFORE_REALIZABLE {
                columns.push(Self::Realizable);
                let axes = |b: Body| (0..4).map(move |i| Self::Axes(b, i));
                columns.extend(Body::BOTH.into_iter().flat_map(axes));
            }
        }
        columns.extend([Self::ReleaseOrder, Self::Recompressed]);
        columns.extend(drawn.iter().enumerate().map(|(i, name)| Self::Drawn(i, name)));
        columns.push(Self::ClearanceNote);
        columns
    }

    fn declaration(self) -> Declaration<'a> {
        use Kind::{Flag, Integer, Number, Text};
        let (name, kind, optional, meaning): (Cow<'a, str>, _, _, &str) = match self {
            Self::Model => ("model".into(), Text, false, "Name of the model."),
            Self::Run => ("run".into(), Integer, false, "Number of the run, from 0."),
            Self::Status => {
                ("status".into(), Text, false, "`ok`, or the reason why the run failed.")
            }
            Self::Number(quantity) => (quantity.column(), Number, true, quantity.meaning()),
            Self::Realizable => {
                let meaning = "Whether the inertias of both bodies are realizable.";
                ("realizable".into(), Flag, false, meaning)
            }
            Self::Axes(body, i) => (
                format!("{}_q{}", body.name(), i + 1).into(),
                Number,
                true,
                "Component of the attitude of the body's principal axes as drawn, scalar last; none for \
                 entrywise models.",
            ),
            Self::ReleaseOrder => (
                "release_order".into(),
                Text,
                true,
                "Springs from 1 in the order of release, `+` between those that let go together, as in \
                 `1 2 3+4`; without those that never push.",
            ),
            Self::Recompressed => (
                "recompressed".into(),
                Text,
                true,
                "Springs from 1 that were pressed below their free length after their release, while \
                 others still pushed; none if there is no such spring.",
            ),
            Self::Drawn(_, name) => {
                (name.into(), Number, true, "What else is dispersed, as drawn.")
            }
            Self::ClearanceNote => (
                "clearance_note".into(),
                Text,
                true,
                "Why there is no clearance (all outlines are mated; the search failed), or not one of the \
                 whole coast (a body turns too far to be followed); none if there is nothing to say.",
            ),
        };
        let unit = if let Self::Number(quantity) = self { Some(quantity.unit()) } else { None };
        Declaration { name, kind, optional, unit, meaning }
    }

    pub(crate) fn name(self) -> Cow<'a, str> {
        self.declaration().name
    }

    /// Its unit, of numbers that have one.
    pub(crate) fn unit(self) -> Option<&'static str> {
        self.declaration().unit
    }

    /// What it means, in a sentence.
    pub(crate) fn meaning(self) -> &'a str {
        self.declaration().meaning
    }

    pub(crate) fn is_optional(self) -> bool {
        self.declaration().optional
    }

    /// The column in Parquet's message type.
    pub(crate) fn field(self) -> String {
        let Declaration { name, kind, optional, .. } = self.declaration();
        let needed = if optional { "optional" } else { "required" };
        match kind {
            Kind::Integer => format!("{needed} int64 {name}"),
            Kind::Flag => format!("{needed} boolean {name}"),
            Kind::Number => format!("{needed} double {name}"),
            Kind::Text => format!("{needed} binary {name} (string)"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    /// The page of the run table, from the declarations.
    fn page() -> String {
        let drawn = ["payload_mass_kg".to_owned()];
        let mut page = "# The run table\n\n\
            `runs/<model>/runs.parquet` holds one row a run, in run order. A half-written Parquet file is refused by readers; half a\n\
            CSV is read without a word. What a failed run has drawn is there, and its outcomes are null; so is every number that has no\n\
            meaning for a run. Numbers are stored bit for bit.\n\n\
            Each spring has a `spring_…_release_s`, springs from 1. In the place of `payload_mass_kg` stands what else is\n\
            [dispersed](scenario.md#what-else-is-uncertain), in that order; nothing if nothing is. The outcomes are explained in\n\
            [separation](models/separation.md), equation numbers are those of Peck (2003).\n\n\
            | column | unit | |\n|---|---|---|\n"
            .to_owned();
        for column in Column::of(Quantity::of(1), &drawn) {
            let unit = column.unit().unwrap_or_default();
            writeln!(page, "| `{}` | {unit} | {} |", column.name(), column.meaning()).unwrap();
        }
        page
    }

    /// Run with `WRITE_PAGE` set to write it anew.
    #[test]
    fn the_page_lists_every_column() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/run-table.md");
        if std::env::var_os("WRITE_PAGE").is_some() {
            std::fs::write(path, page()).unwrap();
        }
        assert_eq!(std::fs::read_to_string(path).unwrap(), page());
    }
}
