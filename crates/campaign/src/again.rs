//! Runs that failed, done again: for failures that are not of the run, such as a licence that was not free.

use rayon::prelude::*;
use std::sync::{Mutex, PoisonError, atomic::AtomicBool};

use crate::{
    cell::Cell,
    column::Column,
    folder::{Blocks, FinishedRuns},
    simulation::{CampaignError, Simulation, go_on, run_range},
    table::Table,
};

/// What became of runs that were done again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Again {
    /// Runs that had failed, and were done again.
    pub runs: u64,
    /// How many of them failed again.
    pub failed: u64,
}

/// Does the runs of finished blocks again that failed. A block is written anew, and takes the place of the old one when it
/// is on the disk; until then that one counts. To be called in the threads that are to do it.
///
/// # Errors
/// A block cannot be read or written; a simulation writes rows that do not fit its columns; the campaign is stopped.
pub fn run_again<S: Simulation>(
    simulations: &[(&str, S)],
    blocks: &Blocks,
    stop: Option<&AtomicBool>,
) -> Result<Again, CampaignError> {
    let mut all = Again::default();
    for (name, simulation) in simulations {
        let empty = Table::new(name, 0, simulation.columns())?;
        let with_failures = blocks.ranges(name, 1);
        let runs = blocks.runs(&empty, Vec::new());
        let each = with_failures.into_par_iter().map(|range| {
            go_on(stop)?;
            let Some(old) = runs.block(range.start)? else { return Ok(Again::default()) };
            let (new, again) = redone(simulation, &empty, &old, &|_| go_on(stop))?;
            blocks.write_again(&new, again.runs)?;
            Ok::<_, CampaignError>(again)
        });
        for again in each.collect::<Result<Vec<_>, _>>()? {
            all = Again { runs: all.runs + again.runs, failed: all.failed + again.failed };
        }
    }
    Ok(all)
}

/// What a finished run has otherwise when it is done again: then something else does the runs now.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "run {run} of the model {model} has {column} = {there} there, and {now} when it is done again"
)]
#[non_exhaustive]
pub struct Changed {
    /// The model.
    pub model: String,
    /// The run.
    pub run: u64,
    /// The column.
    pub column: String,
    /// What the finished run has in it.
    pub there: String,
    /// What it has now.
    pub now: String,
}

/// Does the first finished run again that did not fail, and says what of it is another now, bit by bit: nothing if all is the
/// same, or if there is no such run. Of what was not all kept, what was kept of it is compared, and of a run that failed if no other was
/// kept: of its reason the kind, for its words may hold what is another each time, such as an address in memory. It is written nowhere.
///
/// # Errors
/// A file cannot be read; the simulation writes rows that do not fit its columns.
pub fn run_changed<S: Simulation>(
    simulations: &[(&str, S)],
    finished: &FinishedRuns,
) -> Result<Option<Changed>, CampaignError> {
    let models: Vec<&str> = simulations.iter().map(|(name, _)| *name).collect();
    let Some(there) = finished.first(&models)? else { return Ok(None) };
    let mut simulations = simulations.iter().filter(|(name, _)| *name == there.model);
    let Some((name, simulation)) = simulations.next() else { return Ok(None) };
    let empty = Table::new(name, 0, simulation.columns())?;
    let run = there.run;
    let new = run_range(simulation, &empty, run..run.saturating_add(1), &|_| Ok(()));
    let new = new.map_err(CampaignError::in_blocks)?;
    let Some(again) = new.rows().next() else { return Ok(None) };
    let now = |column: &str| again.cell(column).unwrap_or(Cell::Null);
    let kind = Column::status_kind();
    let is_of_the_kind =
        |(column, there): &(String, Cell<'_>)| column == kind.name() && *there == now(kind.name());
    let is_same_kind = there.cells.iter().any(is_of_the_kind);
    let [_, _, status] = Column::first();
    let counts = |column: &str| !is_same_kind || column != status.name();
    let mut cells = there.cells.into_iter().map(|(column, there)| (now(&column), column, there));
    let other = cells.find(|(now, column, there)| counts(column) && there != now);
    Ok(other.map(|(now, column, there)| Changed {
        model: (*name).to_owned(),
        run,
        column,
        there: there.to_string(),
        now: now.to_string(),
    }))
}

/// A table in which the runs that failed are those of the simulation now.
fn redone<S: Simulation>(
    simulation: &S,
    empty: &Table,
    old: &Table,
    more: &(dyn Fn(u64) -> Result<(), CampaignError> + Sync),
) -> Result<(Table, Again), CampaignError> {
    let failed: Vec<u64> = old.failures().map(|(run, _)| run).collect();
    let rows = Mutex::new(Vec::new());
    failed.into_par_iter().try_for_each(|run| {
        let table = run_range(simulation, empty, run..run.saturating_add(1), more);
        let table = table.map_err(CampaignError::in_blocks)?;
        rows.lock().unwrap_or_else(PoisonError::into_inner).push(table);
        Ok::<_, CampaignError>(())
    })?;
    let mut rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
    rows.sort_by_key(Table::first);
    let again = Again {
        runs: rows.len() as u64,
        failed: rows.iter().map(|table| table.failures().len() as u64).sum(),
    };
    let mut new = empty.from_run(old.first());
    let mut rows = rows.into_iter();
    for row in old.rows() {
        match row.failure().and_then(|_| rows.next()) {
            Some(redone) => new.append(redone),
            None => new.push(row.failure().cloned(), row.own_cells())?,
        }
    }
    Ok((new, again))
}
