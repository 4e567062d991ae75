//! Which run a row of a table is, where a row is a run.

use std::slice;

use crate::{
    column::Column,
    foreign::{ForeignError, ForeignTable},
};

/// Which run a row of a table is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Numbering {
    /// It has the number of its row, from 0.
    Rows,
    /// It has the number in the column `run`.
    ByColumn(Among),
}

/// The numbers that the runs of a table have which are counted: of groups of runs, those of the groups whose first run is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Among {
    first: u64,
    last: u64,
    count: u64,
}

impl Numbering {
    /// Of a table, whose runs come in groups of so many: by the column `run` if all of its cells are whole numbers.
    ///
    /// # Errors
    /// The column cannot be read, or runs have something in common, and it cannot be known which they are.
    pub(super) fn of(table: &ForeignTable, group: u64) -> Result<Self, ForeignError> {
        let name = match table.spelled(Column::RUN) {
            None if group == 1 => return Ok(Self::Rows),
            // Groups without such a column are refused by the name that it should have.
            name => name.cloned().unwrap_or_else(|| Column::RUN.to_owned()),
        };
        let mut among = Among { first: u64::MAX, last: 0, count: 0 };
        let mut all_whole = true;
        // As they are written: runs that failed are among them.
        table.scan_beside(&[], slice::from_ref(&name), |columns| {
            for cell in columns.first().into_iter().flatten() {
                match cell.and_then(Column::run_named) {
                    Some(run) if run.is_multiple_of(group) => among.add(run / group),
                    Some(_) => {}
                    None => all_whole = false,
                }
            }
        })?;
        match all_whole {
            true => Ok(Self::ByColumn(among)),
            false if group == 1 => Ok(Self::Rows),
            false => Err(table.without_run()),
        }
    }

    /// The column that is to be read, as the table calls it, if one is.
    pub(super) fn column(self, table: &ForeignTable) -> Option<String> {
        match self {
            Self::Rows => None,
            Self::ByColumn(_) => table.spelled(Column::RUN).cloned(),
        }
    }

    /// The place of a run, or of a group, among those that are counted, from 0: of a lower number it is not higher.
    pub(super) fn place(self, number: u64) -> u64 {
        match self {
            Self::Rows => number,
            Self::ByColumn(among) => among.place(number),
        }
    }
}

impl Among {
    fn add(&mut self, number: u64) {
        self.first = self.first.min(number);
        self.last = self.last.max(number);
        self.count += 1;
    }

    /// As if the numbers were spread evenly, which those without gaps are. How many are lower would need the memory of all, or their order.
    fn place(self, number: u64) -> u64 {
        let [before, span] = [number, self.last.saturating_add(1)]
            .map(|to| u128::from(to.saturating_sub(self.first)));
        let place = before * u128::from(self.count) / span.max(1);
        u64::try_from(place).unwrap_or(u64::MAX)
    }
}
