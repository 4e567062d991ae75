//! Some of the runs: those with an event, or without any of several.

use crate::table::Table;

/// Some of the runs, by columns of numbers that are 0 where an event is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Subset {
    /// Those with an event: the number of this column is there, and not 0.
    With(String),
    /// Those without any of these events.
    Without(Vec<String>),
}

impl Subset {
    /// Whether each run of a table is one of them.
    #[must_use]
    pub fn of(&self, table: &Table) -> Vec<bool> {
        let with = |column: &String, place: usize| {
            let number = table.numbers(column).and_then(|numbers| numbers.get(place));
            number.is_some_and(|x| x != 0.0)
        };
        let is_one = |place: usize| match self {
            Self::With(column) => with(column, place),
            Self::Without(columns) => !columns.iter().any(|column| with(column, place)),
        };
        (0..table.len()).map(is_one).collect()
    }
}
