//! Requirements judged by the rows of a table, pass by pass and in flat memory.

use gyradius_statistics::Proportion;
use rayon::prelude::*;
use std::iter;

use super::{
    Judgement, JudgementError, Measured, Requirement,
    gathering::{Gathering, Part},
    groups::Groups,
    numbering::Numbering,
};
use crate::{
    column::Column,
    foreign::{Columns, ForeignTable, OfModels},
};

impl Judgement {
    /// Judges requirements by the runs of a table, of which a row is a run, as [`ForeignTable::counting`] says.
    /// Runs have the numbers in the column `run` if all of these are whole, whatever the order of the rows, and those of their rows, from 0, if there is
    /// no such column. All threads of the pool that this is called in are used.
    ///
    /// # Errors
    /// The table cannot be read, has no such column, has no or too many rows, has the same run twice by its columns `model` and `run`, has a
    /// row that sums up others, one of units, or, in the column `run`, one without a number or with a fraction beside others with whole numbers, or holds the
    /// rows of some runs only, as the folder of the campaign says that it is in.
    pub fn of_table(
        requirements: &[Requirement],
        table: &ForeignTable,
    ) -> Result<Vec<Self>, JudgementError> {
        table.check_rows()?;
        table.twice()?.map_or(Ok(()), Err)?;
        table.check_files()?;
        table.no_run()?.map_or(Ok(()), Err)?;
        let mut names: Vec<String> = Vec::new();
        for name in requirements.iter().flat_map(|requirement| requirement.quantity().columns()) {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        let counting = table.counting();
        let group = counting.group();
        let runs = Proportion::MAX_TRIALS.saturating_mul(group);
        let gathering =
            |r: &Requirement| Gathering::new(r.clone(), runs, group).looked_at(counting.looks());
        let mut gatherings: Vec<Gathering> = requirements.iter().map(gathering).collect();
        let of_groups = group > 1;
        let numbering = Numbering::of(table, group)?;
        let run_column: Vec<String> = numbering.column(table).into_iter().collect();
        let new_groups = |r: &Requirement| Groups::new(group, r.probability());
        let mut groups: Vec<Groups> =
            if of_groups { requirements.iter().map(new_groups).collect() } else { Vec::new() };
        let mut counted = false;
        loop {
            let mut parts: Vec<Option<Part>> = gatherings.iter().map(Gathering::part).collect();
            if parts.iter().all(Option::is_none) {
                if gatherings.iter().any(|gathering| gathering.tally.runs == 0) {
                    return Err(table.without_rows().into());
                }
                let groups = groups.iter().map(Some).chain(iter::repeat(None));
                let judged = gatherings.iter().zip(groups);
                return judged
                    .map(|(gathering, groups)| Self::of(gathering)?.of_groups(groups))
                    .collect();
            }
            let (mut first, mut all_known) = (0, true);
            let mut look = |numbers: &Columns, models: &OfModels| {
                let rows = numbers.first().map_or(0, Vec::len);
                let row = first;
                first += rows as u64;
                let runs: Vec<u64> = match numbers.get(names.len()) {
                    Some(runs) => {
                        runs.iter().filter_map(|run| run.and_then(Column::run_named)).collect()
                    }
                    None => (row..).take(rows).collect(),
                };
                all_known &= runs.len() == rows;
                if !all_known {
                    return;
                }
                let number = |gathering: &Gathering| {
                    of_rows(gathering.requirement.quantity(), &names, numbers)
                };
                gatherings.par_iter().zip(&mut parts).for_each(|(gathering, part)| {
                    let Some(part) = part else { return };
                    let of_runs = runs.iter().zip(number(gathering));
                    let first = of_runs.filter(|(run, _)| run.is_multiple_of(group));
                    let placed =
                        first.map(|(run, number)| (*run, numbering.place(run / group), number));
                    gathering.gather(part, placed);
                });
                for (gathering, groups) in gatherings.iter().zip(&mut groups) {
                    for ((run, model), x) in runs.iter().zip(models).zip(number(gathering)) {
                        groups.add(*model, *run, iter::once(gathering.requirement.fails(x)));
                    }
                }
            };
            // Groups are counted once: models are told in the first pass alone.
            if of_groups && !counted {
                table.scan_of_models(&names, &run_column, look)?;
            } else {
                table.scan_beside(&names, &run_column, |numbers| look(numbers, &[]))?;
            }
            if !all_known {
                return Err(table.without_run().into());
            }
            counted = true;
            for (gathering, part) in gatherings.iter_mut().zip(parts) {
                if let Some(part) = part {
                    gathering.advance(part)?;
                }
            }
        }
    }
}

/// What some rows of a table, which have the columns `names` first, have of a quantity.
fn of_rows(quantity: &Measured, names: &[String], numbers: &Columns) -> Vec<Option<f64>> {
    let columns = quantity.columns().iter();
    let columns: Vec<&Vec<Option<f64>>> = columns
        .filter_map(|name| numbers.get(names.iter().position(|other| other == name)?))
        .collect();
    let mut of_run = Vec::with_capacity(columns.len());
    let number = |row: usize| {
        of_run.clear();
        of_run.extend(columns.iter().map(|column| column.get(row).copied().flatten()));
        quantity.of(&of_run)
    };
    (0..numbers.first().map_or(0, Vec::len)).map(number).collect()
}
