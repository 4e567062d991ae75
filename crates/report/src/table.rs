//! Tables of a page: columns, each declared with what it says of a row.

use crate::inline::{Text, with_signs};

/// A table. Its first column names the rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageTable {
    pub(crate) columns: Vec<PageColumn>,
    pub(crate) rows: Vec<PageRow>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PageColumn {
    /// What it shares with its neighbours.
    pub(crate) group: Option<String>,
    pub(crate) label: PageCell,
    pub(crate) align: Align,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Right,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct PageRow {
    /// What it shares with its neighbours.
    pub(crate) group: Option<String>,
    pub(crate) quiet: bool,
    /// One for each column.
    pub(crate) cells: Vec<PageCell>,
}

/// What stands in a cell, in lines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageCell(Vec<Text>);

impl<T: Into<Text>> From<T> for PageCell {
    fn from(line: T) -> Self {
        Self(vec![line.into()])
    }
}

impl FromIterator<Text> for PageCell {
    fn from_iter<I: IntoIterator<Item = Text>>(lines: I) -> Self {
        Self(lines.into_iter().collect())
    }
}

impl PageCell {
    /// With another line.
    #[must_use]
    pub fn line(mut self, line: impl Into<Text>) -> Self {
        self.0.push(line.into());
        self
    }

    /// With a line that stands back, if there is one.
    #[must_use]
    pub fn noting(self, words: Option<String>) -> Self {
        words.into_iter().fold(self, |cell, words| cell.line(Text::default().quiet(words)))
    }

    pub(crate) fn lines(&self) -> &[Text] {
        &self.0
    }
}

impl PageTable {
    /// A table of things, a row each, to which columns are added.
    #[must_use]
    pub fn of<R>(things: &[R]) -> TableOf<'_, R> {
        let rows = things.iter().map(|_| PageRow::default()).collect();
        TableOf { things, table: Self { columns: Vec::new(), rows } }
    }
}

/// A table of things, to which columns are added.
#[derive(Debug)]
pub struct TableOf<'a, R> {
    things: &'a [R],
    table: PageTable,
}

impl<R> From<TableOf<'_, R>> for PageTable {
    fn from(of: TableOf<'_, R>) -> Self {
        of.table
    }
}

impl<'a, R> TableOf<'a, R> {
    /// With a column of words.
    #[must_use]
    pub fn words<C: Into<PageCell>>(
        self,
        label: impl Into<PageCell>,
        of: impl FnMut(&'a R) -> C,
    ) -> Self {
        self.column(PageColumn { group: None, label: label.into(), align: Align::Left }, of)
    }

    /// With a column of numbers.
    #[must_use]
    pub fn numbers<C: Into<PageCell>>(
        self,
        label: impl Into<PageCell>,
        of: impl FnMut(&'a R) -> C,
    ) -> Self {
        self.column(PageColumn { group: None, label: label.into(), align: Align::Right }, of)
    }

    /// With a column of numbers under a heading that it shares with its neighbours.
    #[must_use]
    pub fn numbers_of<C: Into<PageCell>>(
        self,
        group: &str,
        label: impl Into<PageCell>,
        of: impl FnMut(&'a R) -> C,
    ) -> Self {
        let group = Some(group.to_owned());
        self.column(PageColumn { group, label: label.into(), align: Align::Right }, of)
    }

    /// With a heading above all rows in a row that share it.
    #[must_use]
    pub fn groups(mut self, heading: impl Fn(&'a R) -> String) -> Self {
        for (row, thing) in self.table.rows.iter_mut().zip(self.things) {
            row.group = Some(with_signs(&heading(thing)));
        }
        self
    }

    /// With rows that stand back.
    #[must_use]
    pub fn quiet(mut self, stands_back: impl Fn(&'a R) -> bool) -> Self {
        for (row, thing) in self.table.rows.iter_mut().zip(self.things) {
            row.quiet = stands_back(thing);
        }
        self
    }

    fn column<C: Into<PageCell>>(mut self, column: PageColumn, of: impl FnMut(&'a R) -> C) -> Self {
        for (row, cell) in self.table.rows.iter_mut().zip(self.things.iter().map(of)) {
            let PageCell(lines) = cell.into();
            row.cells.push(lines.into_iter().map(Text::with_signs).collect());
        }
        self.table.columns.push(column);
        self
    }
}
