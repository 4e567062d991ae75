//! The first independent runs of a model, some columns of them at a time.

use gyradius_campaign::{Measured, Requirement, Runs, RunsError, Table};
use std::{
    collections::BTreeSet,
    sync::{Mutex, PoisonError},
};

/// Whether each run fails a requirement; none of runs that are not there or are left out.
type Fails = Vec<Option<bool>>;

/// The first runs of a model that are independent of each other, each with a place, in run order.
pub(super) struct FirstRuns<'a> {
    runs: &'a Runs,
    /// The first run of each group of so many is taken.
    group: u64,
    numbers: BTreeSet<u64>,
}

impl<'a> FirstRuns<'a> {
    /// At most so many.
    pub(super) fn new(runs: &'a Runs, group: u64, most: u64) -> Self {
        let group = group.max(1);
        let count = runs.end().div_ceil(group).min(most);
        Self { runs, group, numbers: (0..count).map(|place| place * group).collect() }
    }

    /// How many of them are there, and of each requirement whether each run fails it; none of runs that are not there or are
    /// left out.
    pub(super) fn failing(
        &self,
        requirements: &[Requirement],
    ) -> Result<(u64, Vec<Fails>), RunsError> {
        let fails = |block: &Table| {
            let of = |requirement: &Requirement| requirement.failing(block);
            let there = vec![Some(true); block.len()];
            [there].into_iter().chain(requirements.iter().map(of)).collect()
        };
        let mut all = self.gathered(1 + requirements.len(), None, fails)?.into_iter();
        let there = all.next().unwrap_or_default().iter().flatten().count();
        Ok((there as u64, all.collect()))
    }

    /// Some quantities, NaN where a run has none.
    pub(super) fn numbers(&self, quantities: &[Measured]) -> Result<Vec<Vec<f64>>, RunsError> {
        let of = |block: &Table, quantity: &Measured| -> Vec<f64> {
            quantity.numbers(block).into_iter().map(|x| x.unwrap_or(f64::NAN)).collect()
        };
        self.gathered(quantities.len(), f64::NAN, |block| {
            quantities.iter().map(|quantity| of(block, quantity)).collect()
        })
    }

    /// What was drawn in some columns, of runs that failed too; NaN where nothing was.
    pub(super) fn drawn(&self, columns: &[String]) -> Result<Vec<Vec<f64>>, RunsError> {
        let of = |block: &Table, column: &String| -> Vec<f64> {
            let numbers = block.numbers(column);
            let number = |place| numbers?.get(place);
            (0..block.len()).map(|place| number(place).unwrap_or(f64::NAN)).collect()
        };
        self.gathered(columns.len(), f64::NAN, |block| {
            columns.iter().map(|column| of(block, column)).collect()
        })
    }

    /// So many columns, made of each block, and something where there is no such run.
    fn gathered<T: Copy + Send>(
        &self,
        columns: usize,
        nothing: T,
        of: impl Fn(&Table) -> Vec<Vec<T>> + Sync,
    ) -> Result<Vec<Vec<T>>, RunsError> {
        let all = Mutex::new(vec![vec![nothing; self.numbers.len()]; columns]);
        if columns == 0 {
            return Ok(Vec::new());
        }
        self.runs.scan_those_with(&self.numbers, |block| {
            let read = of(block);
            let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
            for number in self.numbers.range(block.first()..block.first() + block.len() as u64) {
                let from = (number - block.first()) as usize;
                let to = (number / self.group) as usize;
                for (own, read) in all.iter_mut().zip(&read) {
                    own[to] = read[from];
                }
            }
        })?;
        Ok(all.into_inner().unwrap_or_else(PoisonError::into_inner))
    }
}
