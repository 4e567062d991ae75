//! The run table: what runs leave, by columns.

use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    fmt, iter,
    sync::Arc,
};

use crate::{
    cell::Cell,
    column::{Column, Kind},
    failure::{Failure, OK},
    values::{Numbers, Texts},
};

/// The runs of one model, in run order.
///
/// The columns are `model`, `run` and `status`, and then those of the simulation. A run that failed is a row
/// with its reason in `status`. At the end are the kinds of texts that have kinds, `status_kind` first.
#[derive(Clone, Debug)]
pub struct Table {
    model: String,
    /// Number of the first run.
    first: u64,
    len: usize,
    /// `model`, `run`, `status`, those of the simulation, and kinds of texts.
    columns: Arc<[Column]>,
    /// How many columns stand before those of the simulation.
    own: usize,
    /// One of each column of the simulation.
    pub(crate) values: Vec<Values>,
    pub(crate) failures: BTreeMap<usize, Failure>,
}

#[derive(Clone, Debug)]
pub(crate) enum Values {
    Numbers(Numbers),
    Integers(Vec<Option<i64>>),
    Texts(Texts),
    Flags(Vec<Option<bool>>),
}

/// A run of a [`Table`].
#[derive(Clone, Copy)]
pub struct Row<'a> {
    table: &'a Table,
    place: usize,
}

/// Columns before those of the simulation, in a run table.
const OWN: usize = 3;

/// What a column of a table is filled from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    Model,
    Run,
    Status,
    /// A column of the simulation, by its place.
    Value(usize),
    StatusKind,
    /// The kinds of the texts in a column of the simulation.
    Kind(usize),
}

impl Table {
    /// A table for the runs of a model from the number `first` on, without any yet.
    ///
    /// # Errors
    /// Two columns have the same name, or one has a name that a table begins with, or none.
    pub fn new(model: &str, first: u64, columns: Vec<Column>) -> Result<Self, TableError> {
        let mut names = BTreeSet::new();
        let of_kinds = columns.iter().filter(|column| column.has_kinds()).map(Column::kinds);
        let last: Vec<Column> = iter::once(Column::status_kind()).chain(of_kinds).collect();
        let values = columns.iter().map(|column| Values::new(column.kind())).collect();
        let columns: Arc<[Column]> =
            Column::first().into_iter().chain(columns).chain(last).collect();
        for column in columns.iter() {
            if column.name().is_empty() || !names.insert(column.name()) {
                return Err(TableError::Name { column: column.name().to_owned() });
            }
        }
        let model = model.to_owned();
        Ok(Self { model, first, len: 0, columns, own: OWN, values, failures: BTreeMap::new() })
    }

    /// A table of draws that cannot fail, under names of its own in the place of `model` and `run`, and without `status`.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_draws(
        name: &str,
        heads: [Column; 2],
        columns: Vec<Column>,
    ) -> Result<Self, TableError> {
        let whole = Self::new(name, 0, columns)?;
        let columns: Arc<[Column]> =
            heads.into_iter().chain(whole.of_simulation().iter().cloned()).collect();
        Ok(Self { columns, own: OWN - 1, ..whole })
    }

    /// The same columns for the draws of another name from a number on, without any yet.
    #[must_use]
    pub fn from_draw(&self, name: &str, first: u64) -> Self {
        Self { model: name.to_owned(), ..self.from_run(first) }
    }

    /// A table of the same model and columns for runs from another number on.
    #[must_use]
    pub fn from_run(&self, first: u64) -> Self {
        Self {
            model: self.model.clone(),
            first,
            len: 0,
            columns: Arc::clone(&self.columns),
            own: self.own,
            values: self.of_simulation().iter().map(|c| Values::new(c.kind())).collect(),
            failures: BTreeMap::new(),
        }
    }

    /// The next run: why it failed, if it did, and what it has in each column of the simulation, in their
    /// order.
    ///
    /// # Errors
    /// There are more or fewer cells than columns, one does not go into its column, or the run has no number, because there are
    /// none after [`u64::MAX`]. The table is as it was.
    pub fn push<'c>(
        &mut self,
        failure: Option<Failure>,
        cells: impl IntoIterator<Item = Cell<'c>>,
    ) -> Result<(), TableError> {
        if self.first.checked_add(self.len as u64 + 1).is_none() {
            return Err(TableError::Runs { first: self.first });
        }
        let columns = self.values.len();
        let mut places = self.values.iter_mut().zip(&self.columns[self.own..]);
        // Not in a loop, which copies each cell out of the iterator and waits for what was just written.
        let filled = cells.into_iter().try_for_each(|cell| {
            let (values, column) = places.next().ok_or(TableError::Cells { columns })?;
            let may_be = column.is_optional() || !matches!(cell, Cell::Null);
            if values.push(&cell) && may_be {
                return Ok(());
            }
            let (column, cell) = (column.name().to_owned(), format!("{cell:?}"));
            Err(TableError::Cell { column, cell })
        });
        let missing = filled.is_ok() && places.next().is_some();
        let filled = if missing { Err(TableError::Cells { columns }) } else { filled };
        if filled.is_err() {
            self.values.iter_mut().for_each(|values| values.truncate(self.len));
        }
        filled?;
        self.failures.extend(failure.map(|failure| (self.len, failure)));
        self.len += 1;
        Ok(())
    }

    /// Says where it begins and how many runs there are, after all columns have been filled.
    pub(crate) fn begin(&mut self, first: u64, len: usize) {
        (self.first, self.len) = (first, len);
    }

    /// Appends the runs of another table of the same columns, that come next.
    pub(crate) fn append(&mut self, next: Self) {
        for (values, more) in self.values.iter_mut().zip(next.values) {
            values.append(more);
        }
        let failures = next.failures.into_iter();
        self.failures.extend(failures.map(|(place, failure)| (self.len + place, failure)));
        self.len += next.len;
    }

    /// Name of the model.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// The number of the first run.
    #[must_use]
    pub fn first(&self) -> u64 {
        self.first
    }

    /// How many runs it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether it has no runs.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// All columns, `model`, `run` and `status` first.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Those that the simulation fills.
    pub(crate) fn of_simulation(&self) -> &[Column] {
        &self.columns[self.own..self.own + self.values.len()]
    }

    /// What each column is filled from.
    pub(crate) fn sources(&self) -> impl Iterator<Item = (&Column, Source)> {
        let values = (0..self.values.len()).map(Source::Value);
        let of_kinds = self.of_simulation().iter().enumerate();
        let kinds = of_kinds.filter(|(_, c)| c.has_kinds()).map(|(place, _)| Source::Kind(place));
        let own = [Source::Model, Source::Run, Source::Status].into_iter().take(self.own);
        // A table of draws ends with those.
        let sources = own.chain(values).chain([Source::StatusKind]).chain(kinds);
        self.columns.iter().zip(sources)
    }

    /// The run in a place, from 0, of [`len`](Self::len).
    #[must_use]
    pub fn row(&self, place: usize) -> Option<Row<'_>> {
        (place < self.len).then_some(Row { table: self, place })
    }

    /// Its runs.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = Row<'_>> {
        (0..self.len).map(|place| Row { table: self, place })
    }

    /// The runs that failed, and why.
    pub fn failures(&self) -> impl ExactSizeIterator<Item = (u64, &Failure)> {
        self.failures.iter().map(|(place, failure)| (self.first + *place as u64, failure))
    }

    /// The numbers in a column, one for each run, if it has numbers.
    #[must_use]
    pub fn numbers(&self, column: &str) -> Option<&Numbers> {
        match self.column(column)? {
            Values::Numbers(numbers) => Some(numbers),
            Values::Integers(_) | Values::Texts(_) | Values::Flags(_) => None,
        }
    }

    /// The numbers in a column of the runs that have one, in run order; none if it has no numbers.
    #[must_use]
    pub fn values(&self, column: &str) -> Option<Vec<f64>> {
        Some(self.numbers(column)?.present().collect())
    }

    /// The flags in a column, one for each run; empty if it has no flags.
    #[must_use]
    pub fn flags(&self, column: &str) -> &[Option<bool>] {
        match self.column(column) {
            Some(Values::Flags(flags)) => flags,
            Some(Values::Numbers(_) | Values::Integers(_) | Values::Texts(_)) | None => &[],
        }
    }

    /// The texts in a column of the simulation with what kind they are, of the runs that have one, in run
    /// order.
    pub fn notes(&self, column: &str) -> impl Iterator<Item = (&str, &str)> {
        self.texts(column).into_iter().flat_map(Texts::present)
    }

    /// The kinds of the texts in a column of the simulation, each with the first run that has such a text and how many
    /// have.
    pub(crate) fn kinds(&self, column: &str, which: impl Fn(u64) -> bool) -> Vec<(&str, u64, u64)> {
        let run = |place: usize| self.first + place as u64;
        let counted = self.texts(column).map(|texts| texts.counted(|place| which(run(place))));
        let of_run = |(kind, place, count)| (kind, run(place), count);
        counted.into_iter().flatten().map(of_run).collect()
    }

    /// What runs have in a column, by their places: numbers, whole numbers, and flags as 1 and 0; nothing in a column of texts, and
    /// nothing of runs that failed, except for numbers that are infinite: that is what such a run came to.
    pub fn measured(&self, column: &str) -> impl Fn(usize) -> Option<f64> {
        let values = self.column(column);
        move |place| {
            let number = match values? {
                Values::Numbers(numbers) => numbers.get(place),
                Values::Integers(integers) => integers.get(place)?.map(|whole| whole as f64),
                Values::Flags(flags) => flags.get(place)?.map(|flag| f64::from(u8::from(flag))),
                Values::Texts(_) => None,
            };
            number.filter(|x| Failure::has_number(*x) || !self.failures.contains_key(&place))
        }
    }

    fn texts(&self, column: &str) -> Option<&Texts> {
        match self.column(column)? {
            Values::Texts(texts) => Some(texts),
            Values::Numbers(_) | Values::Integers(_) | Values::Flags(_) => None,
        }
    }

    fn column(&self, column: &str) -> Option<&Values> {
        let place = self.of_simulation().iter().position(|other| other.name() == column)?;
        self.values.get(place)
    }
}

impl Values {
    fn new(kind: Kind) -> Self {
        match kind {
            Kind::Number => Self::Numbers(Numbers::default()),
            Kind::Integer => Self::Integers(Vec::new()),
            Kind::Text => Self::Texts(Texts::default()),
            Kind::Flag => Self::Flags(Vec::new()),
        }
    }

    /// Adds a cell and says whether it goes there.
    #[inline]
    fn push(&mut self, cell: &Cell<'_>) -> bool {
        match (self, cell) {
            (Self::Numbers(numbers), Cell::Number(number)) => numbers.push(Some(*number)),
            (Self::Numbers(numbers), Cell::Null) => numbers.push(None),
            (Self::Integers(integers), Cell::Integer(integer)) => integers.push(Some(*integer)),
            (Self::Integers(integers), Cell::Null) => integers.push(None),
            (Self::Texts(texts), Cell::Text(text)) => texts.push(Some((text, text))),
            (Self::Texts(texts), Cell::Note { kind, text }) => texts.push(Some((text, kind))),
            (Self::Texts(texts), Cell::Null) => texts.push(None),
            (Self::Flags(flags), Cell::Flag(flag)) => flags.push(Some(*flag)),
            (Self::Flags(flags), Cell::Null) => flags.push(None),
            (Self::Numbers(_) | Self::Integers(_) | Self::Texts(_) | Self::Flags(_), _) => {
                return false;
            }
        }
        true
    }

    fn append(&mut self, next: Self) {
        match (self, next) {
            (Self::Numbers(numbers), Self::Numbers(more)) => numbers.append(&more),
            (Self::Integers(integers), Self::Integers(more)) => integers.extend(more),
            (Self::Texts(texts), Self::Texts(more)) => texts.append(&more),
            (Self::Flags(flags), Self::Flags(more)) => flags.extend(more),
            // Tables of the same columns have the same kinds.
            (Self::Numbers(_) | Self::Integers(_) | Self::Texts(_) | Self::Flags(_), _) => {}
        }
    }

    fn truncate(&mut self, len: usize) {
        match self {
            Self::Numbers(numbers) => numbers.truncate(len),
            Self::Integers(integers) => integers.truncate(len),
            Self::Texts(texts) => texts.truncate(len),
            Self::Flags(flags) => flags.truncate(len),
        }
    }

    fn cell(&self, place: usize) -> Cell<'_> {
        match self {
            Self::Numbers(numbers) => numbers.get(place).into(),
            Self::Integers(integers) => {
                integers.get(place).copied().flatten().map_or(Cell::Null, Cell::Integer)
            }
            Self::Texts(texts) => texts.get(place).map_or(Cell::Null, |(text, kind)| {
                if text == kind {
                    Cell::Text(text.into())
                } else {
                    Cell::Note { kind: kind.into(), text: text.into() }
                }
            }),
            Self::Flags(flags) => {
                flags.get(place).copied().flatten().map_or(Cell::Null, Cell::Flag)
            }
        }
    }
}

impl<'a> Row<'a> {
    /// Its number, from 0.
    #[must_use]
    pub fn run(&self) -> u64 {
        self.table.first + self.place as u64
    }

    /// `ok`, or why the run failed.
    #[must_use]
    pub fn status(&self) -> Cow<'a, str> {
        self.failure().map_or(OK.into(), |failure| failure.message().into())
    }

    /// Why the run failed, if it did.
    #[must_use]
    pub fn failure(&self) -> Option<&'a Failure> {
        self.table.failures.get(&self.place)
    }

    /// What stands in a column of the table; none if there is no such column.
    #[must_use]
    pub fn cell(&self, column: &str) -> Option<Cell<'a>> {
        let (_, source) = self.table.sources().find(|(other, _)| other.name() == column)?;
        Some(self.cell_from(source))
    }

    /// The number in a column; none if there is none.
    #[must_use]
    pub fn number(&self, column: &str) -> Option<f64> {
        self.table.numbers(column)?.get(self.place)
    }

    /// The text in a column of the simulation; none if there is none.
    #[must_use]
    pub fn text(&self, column: &str) -> Option<&'a str> {
        Some(self.table.texts(column)?.get(self.place)?.0)
    }

    /// The flag in a column; none if there is none.
    #[must_use]
    pub fn flag(&self, column: &str) -> Option<bool> {
        self.table.flags(column).get(self.place).copied().flatten()
    }

    /// What stands in each column of the table, in their order.
    pub fn cells(&self) -> impl Iterator<Item = (&'a Column, Cell<'a>)> {
        let row = *self;
        self.table.sources().map(move |(column, source)| (column, row.cell_from(source)))
    }

    /// What stands in the columns of the simulation, in their order.
    pub(crate) fn own_cells(&self) -> impl Iterator<Item = Cell<'a>> {
        let place = self.place;
        self.table.values.iter().map(move |values| values.cell(place))
    }

    pub(crate) fn cell_from(&self, source: Source) -> Cell<'a> {
        let failure = self.failure();
        match source {
            Source::Model => Cell::Text(self.table.model.as_str().into()),
            Source::Run => Cell::Integer(self.run() as i64),
            Source::Status => failure.map_or(Cell::Text(OK.into()), |failure| Cell::Note {
                kind: failure.kind().into(),
                text: failure.message().into(),
            }),
            Source::Value(column) => self.table.values[column].cell(self.place),
            Source::StatusKind => Cell::Text(failure.map_or(OK, Failure::kind).into()),
            Source::Kind(column) => match self.table.values[column].cell(self.place) {
                Cell::Note { kind, .. } => Cell::Text(kind),
                other => other,
            },
        }
    }
}

/// Rows are the same if all their cells are, to the bit.
impl PartialEq for Row<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cells().eq(other.cells())
    }
}

impl fmt::Debug for Row<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.cells().map(|(column, cell)| (column.name(), cell))).finish()
    }
}

/// Why a table or a row of it is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// Two columns have the same name, or one has none.
    #[error("column {column:?}: {}", if column.is_empty() { "it must have a name" } else { "another column of the table has this name" })]
    Name {
        /// The column.
        column: String,
    },
    /// A row has more or fewer cells than there are columns.
    #[error("a row must have {columns} cells, one for each column of the simulation")]
    Cells {
        /// How many there must be.
        columns: usize,
    },
    /// The runs are more than there are numbers for them.
    #[error("runs from {first} on: their numbers must be below {}", u64::MAX)]
    Runs {
        /// The number of the first.
        first: u64,
    },
    /// A cell does not go into its column.
    #[error("column {column:?}: {cell} does not go there")]
    Cell {
        /// The column.
        column: String,
        /// The cell.
        cell: String,
    },
}
