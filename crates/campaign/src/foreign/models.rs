//! The models that rows of a table are of, which its column `model` names.

use std::collections::BTreeMap;

use super::only_place;
use crate::column::Column;

/// Models by their names, each with a number that stands for it, in all files of a table.
#[derive(Clone, Debug, Default)]
pub(super) struct Models {
    numbers: BTreeMap<String, u64>,
}

impl Models {
    /// Where a table names the model of a row, if it has one such column.
    pub(super) fn place(columns: &[String]) -> Option<usize> {
        let [model, ..] = Column::first();
        only_place(columns, &model)
    }

    /// The number of the model that a cell names; none if it names none.
    pub(super) fn number(&mut self, cell: &str) -> Option<u64> {
        if cell.trim().is_empty() {
            return None;
        }
        if let Some(number) = self.numbers.get(cell) {
            return Some(*number);
        }
        let next = self.numbers.len() as u64;
        self.numbers.insert(cell.to_owned(), next);
        Some(next)
    }
}
