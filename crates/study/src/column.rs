//! The columns of the run table: one place for their names, their types and what stands in them.

use std::borrow::Cow;

use crate::{
    quantity::{Body, Quantity},
    row::Row,
};

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
    /// All columns, in order, of a separation by so many springs in which that else was drawn.
    pub(crate) fn of(springs: usize, drawn: &'a [String]) -> Vec<Self> {
        let mut columns = vec![Self::Model, Self::Run, Self::Status];
        let mut numbers = Quantity::of(springs).map(Self::Number);
        columns.extend(numbers.by_ref().take(Quantity::FIRST));
        columns.push(Self::Realizable);
        columns.extend(Body::BOTH.into_iter().flat_map(|b| (0..4).map(move |i| Self::Axes(b, i))));
        columns.extend(numbers);
        columns.extend([Self::ReleaseOrder, Self::Recompressed]);
        columns.extend(drawn.iter().enumerate().map(|(i, name)| Self::Drawn(i, name)));
        columns.push(Self::ClearanceNote);
        columns
    }

    pub(crate) fn name(self) -> Cow<'a, str> {
        match self {
            Self::Model => "model".into(),
            Self::Run => "run".into(),
            Self::Status => "status".into(),
            Self::Number(quantity) => quantity.column(),
            Self::Realizable => "realizable".into(),
            Self::Axes(body, i) => format!("{}_q{}", body.name(), i + 1).into(),
            Self::ReleaseOrder => "release_order".into(),
            Self::Recompressed => "recompressed".into(),
            Self::Drawn(_, name) => name.into(),
            Self::ClearanceNote => "clearance_note".into(),
        }
    }

    pub(crate) fn is_optional(self) -> bool {
        !matches!(self, Self::Model | Self::Run | Self::Status | Self::Realizable)
    }

    /// The column in Parquet's message type.
    pub(crate) fn field(self) -> String {
        let kind = match self {
            Self::Run => "int64",
            Self::Realizable => "boolean",
            Self::Number(_) | Self::Axes(..) | Self::Drawn(..) => "double",
            Self::Model
            | Self::Status
            | Self::ReleaseOrder
            | Self::Recompressed
            | Self::ClearanceNote => "binary",
        };
        let needed = if self.is_optional() { "optional" } else { "required" };
        let text = if kind == "binary" { " (string)" } else { "" };
        format!("{needed} {kind} {}{text}", self.name())
    }

    pub(crate) fn cell(self, model: &str, row: &Row) -> Cell {
        let number = |x: Option<f64>| x.map_or(Cell::Null, Cell::Number);
        match self {
            Self::Model => Cell::Text(model.to_owned()),
            // There are fewer runs than 2⁶³.
            Self::Run => Cell::Integer(row.run() as i64),
            Self::Status => Cell::Text(row.status().into_owned()),
            Self::Number(quantity) => number(row.value(quantity)),
            Self::Realizable => Cell::Flag(row.realizable()),
            Self::Drawn(i, _) => number(row.drawn.get(i).copied()),
            Self::Axes(body, i) => number(row.axes(body).map(|q| q.coords[i])),
            Self::ReleaseOrder => {
                row.release_order().map_or(Cell::Null, |order| Cell::Text(order.to_owned()))
            }
            Self::Recompressed => {
                let springs: Vec<_> = row.recompressed().iter().map(ToString::to_string).collect();
                if springs.is_empty() { Cell::Null } else { Cell::Text(springs.join(" ")) }
            }
            Self::ClearanceNote => {
                row.clearance_note().map_or(Cell::Null, |note| Cell::Text(note.to_string()))
            }
        }
    }
}
