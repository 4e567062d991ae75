//! Runs that are handed on block by block, in memory that does not grow with their number.

use std::{ops::Range, sync::atomic::AtomicBool};

use crate::{
    simulation::{CampaignError, Simulation, go_on, run_range},
    table::Table,
};

/// Runs of a block: many for all threads to have work, few for the first of them to be there soon.
const BLOCK_RUNS: u64 = 1 << 14;

/// Does runs of a simulation on the threads that this is called in and hands them on, in run order, some ten thousand at
/// a time; `more` is told of runs that are done. None are done after `stop` is set.
///
/// # Errors
/// The columns are refused, or the simulation writes rows that do not fit them, or not one for each run; it was told to
/// stop; or `take` refuses a table.
pub fn stream<S: Simulation, E: From<CampaignError>>(
    simulation: &S,
    model: &str,
    runs: Range<u64>,
    stop: Option<&AtomicBool>,
    more: &(dyn Fn(u64) + Sync),
    mut take: impl FnMut(&Table) -> Result<(), E>,
) -> Result<(), E> {
    let empty = Table::new(model, runs.start, simulation.columns()).map_err(CampaignError::from)?;
    let more = |runs| {
        more(runs);
        go_on(stop)
    };
    let mut first = runs.start;
    while first < runs.end {
        go_on(stop)?;
        let last = runs.end.min(first.saturating_add(BLOCK_RUNS));
        take(&run_range(simulation, &empty, first..last, &more)?)?;
        first = last;
    }
    Ok(())
}
