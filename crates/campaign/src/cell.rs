//! What stands in a column for a run.

use std::{borrow::Cow, fmt};

/// What stands in a column for a run.
#[derive(Clone, Debug)]
pub enum Cell<'a> {
    /// A number.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// A text.
    Text(Cow<'a, str>),
    /// A text, and what kind it is without its numbers, so that those of a kind can be counted.
    Note {
        /// What kind it is.
        kind: Cow<'a, str>,
        /// The text.
        text: Cow<'a, str>,
    },
    /// Yes or no.
    Flag(bool),
    /// Nothing.
    Null,
}

impl Cell<'_> {
    /// The same for as long as one likes.
    #[must_use]
    pub fn into_owned(self) -> Cell<'static> {
        let own = |text: Cow<'_, str>| Cow::Owned(text.into_owned());
        match self {
            Self::Number(number) => Cell::Number(number),
            Self::Integer(integer) => Cell::Integer(integer),
            Self::Text(text) => Cell::Text(own(text)),
            Self::Note { kind, text } => Cell::Note { kind: own(kind), text: own(text) },
            Self::Flag(flag) => Cell::Flag(flag),
            Self::Null => Cell::Null,
        }
    }
}

/// A number, or nothing.
impl From<Option<f64>> for Cell<'_> {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Self::Null, Self::Number)
    }
}

impl From<f64> for Cell<'_> {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<bool> for Cell<'_> {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

impl<'a> From<&'a str> for Cell<'a> {
    fn from(text: &'a str) -> Self {
        Self::Text(text.into())
    }
}

/// Cells are the same if they show the same and numbers have the same bits.
impl PartialEq for Cell<'_> {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::Text(a) | Self::Note { text: a, .. },
                Self::Text(b) | Self::Note { text: b, .. },
            ) => a == b,
            (Self::Integer(a), Self::Integer(b)) => a == b,
            (Self::Number(a), Self::Number(b)) => a.to_bits() == b.to_bits(),
            (Self::Flag(a), Self::Flag(b)) => a == b,
            (Self::Null, Self::Null) => true,
            (
                Self::Text(_)
                | Self::Note { .. }
                | Self::Integer(_)
                | Self::Number(_)
                | Self::Flag(_)
                | Self::Null,
                _,
            ) => false,
        }
    }
}

impl fmt::Display for Cell<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) | Self::Note { text, .. } => write!(f, "{text}"),
            Self::Integer(integer) => write!(f, "{integer}"),
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Null => write!(f, "nothing"),
        }
    }
}
