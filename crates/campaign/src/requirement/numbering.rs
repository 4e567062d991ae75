//! Which run a row of a table is, where a row is a run.

use std::slice;

use crate::{column::Column, foreign::ForeignTable};

/// Which run a row of a table is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Numbering {
    /// It has the number of its row, from 0.
    Rows,
    /// It has the number in the column `run`, and rows stand in the order of their runs.
    InOrder,
    /// It has the number in the column `run`, in any order.
    AnyOrder,
}

impl Numbering {
    /// Of a table: by the column `run` if all of its cells are whole numbers.
    pub(super) fn of(table: &ForeignTable) -> Self {
        let Some(run) = table.spelled(Column::RUN) else { return Self::Rows };
        let (mut all_whole, mut rises, mut last) = (true, true, None);
        // As they are written: runs that failed are among them.
        let read = table.scan_beside(&[], slice::from_ref(run), |columns| {
            for cell in columns.first().into_iter().flatten() {
                let run = cell.and_then(Column::run_named);
                all_whole &= run.is_some();
                rises &= last < run;
                last = run;
            }
        });
        match (read.is_ok() && all_whole, rises) {
            (false, _) => Self::Rows,
            (true, true) => Self::InOrder,
            (true, false) => Self::AnyOrder,
        }
    }

    /// Whether the column `run` is to be read.
    pub(super) fn is_by_column(self) -> bool {
        match self {
            Self::Rows => false,
            Self::InOrder | Self::AnyOrder => true,
        }
    }
}
