//! A campaign: the runs that are missing in a folder, done in blocks that are on the disk when they are done.

use rayon::prelude::*;
use std::{
    ops::Range,
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use crate::{
    folder::Blocks,
    runs::Runs,
    simulation::{CampaignError, Progress, Simulation, run_range},
    table::Table,
};

/// Numbers that are kept in memory, so that small campaigns are not read again: 64 MiB.
const HELD: u64 = 1 << 23;

/// How the runs of a campaign are done.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Runs of each model.
    pub runs: u64,
    /// Runs of a block.
    pub block_runs: u64,
    /// Once it is true, blocks that are not finished are dropped.
    pub stop: Option<&'a AtomicBool>,
}

/// Looks at a block of the runs of a simulation, by its place among all.
pub type Look<'a> = &'a (dyn Fn(usize, &Table) + Sync);

/// Does the runs of some simulations that are in no block yet, each simulation being a model with a name. To be called
/// in the threads that are to do it; `progress` is told how many runs of all models are done. `look` sees every block
/// once, in any order: those that are done as soon as they are on the disk, the others as they are read.
///
/// # Errors
/// A block that was there cannot be read; a simulation writes rows that do not fit its columns, or not one for each run; a block cannot be written; the
/// campaign is stopped. Blocks that were finished stay.
pub fn run_missing<S: Simulation>(
    simulations: &[(&str, S)],
    blocks: &Blocks,
    plan: Plan<'_>,
    progress: Progress<'_>,
    look: Look<'_>,
) -> Result<Vec<Runs>, CampaignError> {
    let stopped = || plan.stop.is_some_and(|stop| stop.load(Ordering::Relaxed));
    let tables =
        simulations.iter().map(|(name, simulation)| Table::new(name, 0, simulation.columns()));
    let tables = tables.collect::<Result<Vec<_>, _>>()?;
    let missing: Vec<Vec<Range<u64>>> = simulations
        .iter()
        .map(|(name, _)| blocks.missing(name, plan.runs, plan.block_runs))
        .collect();
    let left: u64 = missing.iter().flatten().map(|runs| runs.end - runs.start).sum();
    let done = AtomicU64::new(plan.runs * simulations.len() as u64 - left);
    let more = |runs| progress(done.fetch_add(runs, Ordering::Relaxed) + runs);
    if left > 0 {
        more(0);
    }
    let room = AtomicU64::new(HELD);
    let mut all = Vec::new();
    for (place, (((_, simulation), empty), missing)) in
        simulations.iter().zip(&tables).zip(missing).enumerate()
    {
        blocks.runs(empty, Vec::new()).scan(|block| look(place, block))?;
        let held = Mutex::new(Vec::new());
        missing.into_par_iter().try_for_each(|runs| {
            if stopped() {
                return Err(CampaignError::Stopped);
            }
            let table = run_range(simulation, empty, runs, &|runs| more(runs))?;
            if stopped() {
                return Err(CampaignError::Stopped);
            }
            blocks.write(&table)?;
            look(place, &table);
            let numbers = (table.len() * table.columns().len()) as u64;
            let fits = room
                .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |room| {
                    room.checked_sub(numbers)
                })
                .is_ok();
            if let Ok(mut held) = held.lock()
                && fits
            {
                held.push(table);
            }
            Ok(())
        })?;
        all.push(blocks.runs(empty, held.into_inner().unwrap_or_default()));
    }
    Ok(all)
}
