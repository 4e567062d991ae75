//! A campaign: the runs that are missing in a folder, done in blocks that are on the disk when they are done.

use rayon::prelude::*;
use std::{
    ops::Range,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use crate::{
    folder::Blocks,
    runs::Runs,
    shard::Shard,
    simulation::{CampaignError, Progress, Simulation, go_on, run_range},
    table::Table,
};

/// Numbers that are kept in memory, so that small campaigns are not read again: 64 MiB.
pub(crate) const HELD: u64 = 1 << 23;

/// How the runs of a campaign are done.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Runs of each model.
    pub runs: u64,
    /// Runs of a block; 0 is taken for 1.
    pub block_runs: u64,
    /// Which of the blocks that are missing.
    pub doing: Doing,
    /// Once it is true, blocks that are not finished are dropped.
    pub stop: Option<&'a Arc<AtomicBool>>,
}

/// Which of the missing blocks of a campaign are done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Doing {
    /// All.
    #[default]
    All,
    /// Those of a shard.
    Shard(Shard),
    /// None: what is there is looked at.
    Nothing,
}

impl Plan<'_> {
    /// The runs of the model in a place among all that are in no block, and are to be done.
    #[must_use]
    pub fn missing(&self, blocks: &Blocks, place: usize, model: &str) -> Vec<Range<u64>> {
        let mut missing = blocks.missing(model, self.runs, self.block_runs);
        missing.retain(|runs| self.doing.does(self.block(place, runs.start)));
        missing
    }

    /// The runs of so many models that are to be done if none is there.
    #[must_use]
    pub fn total(&self, models: usize) -> u64 {
        let blocks = (0..self.runs).step_by(usize::try_from(self.of_block()).unwrap_or(usize::MAX));
        let own = |place: usize| {
            let own =
                blocks.clone().filter(move |first| self.doing.does(self.block(place, *first)));
            own.map(|first| self.of_block().min(self.runs - first)).sum::<u64>()
        };
        (0..models).map(own).sum()
    }

    /// The runs of so many models that each of so many shards is to do if none is there, by their numbers.
    #[must_use]
    pub fn shares(&self, models: usize, shards: u32) -> Vec<u64> {
        let runs = self.of_block();
        let mut shares = vec![0; shards as usize];
        for place in 0..models {
            for at in 0..self.runs.div_ceil(runs) {
                let first = at * runs;
                let block = self.block(place, first);
                if let Some(share) = shares.get_mut((block % u64::from(shards.max(1))) as usize) {
                    *share += runs.min(self.runs - first);
                }
            }
        }
        shares
    }

    /// Runs of a block, at least one.
    fn of_block(&self) -> u64 {
        self.block_runs.max(1)
    }

    /// The place of a block among those of all models.
    fn block(&self, place: usize, first: u64) -> u64 {
        let runs = self.of_block();
        place as u64 * self.runs.div_ceil(runs) + first / runs
    }
}

impl Doing {
    fn does(self, block: u64) -> bool {
        match self {
            Self::All => true,
            Self::Shard(shard) => shard.has(block),
            Self::Nothing => false,
        }
    }
}

/// Looks at a block of the runs of a simulation, by its place among all.
pub type Look<'a> = &'a (dyn Fn(usize, &Table) + Sync);

/// Does the planned runs of some simulations that are in no block yet, each simulation being a model with a name. To be called
/// in the threads that are to do it; `progress` is told how many runs of all models are done. `look`, if there is one, sees every block
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
    look: Option<Look<'_>>,
) -> Result<Vec<Runs>, CampaignError> {
    let tables =
        simulations.iter().map(|(name, simulation)| Table::new(name, 0, simulation.columns()));
    let tables = tables.collect::<Result<Vec<_>, _>>()?;
    let missing: Vec<Vec<Range<u64>>> = simulations
        .iter()
        .enumerate()
        .map(|(place, (name, _))| plan.missing(blocks, place, name))
        .collect();
    let left: u64 = missing.iter().flatten().map(|runs| runs.end - runs.start).sum();
    let done = AtomicU64::new(plan.total(simulations.len()).saturating_sub(left));
    let more = |runs| progress(done.fetch_add(runs, Ordering::Relaxed) + runs);
    if left > 0 {
        more(0);
    }
    if let Some(look) = look {
        for (place, empty) in tables.iter().enumerate() {
            let there = blocks.runs(empty, Vec::new()).stopped_by(plan.stop.cloned());
            there.scan(|block| look(place, block))?;
        }
    }
    let room = AtomicU64::new(HELD);
    let held = Mutex::new(vec![Vec::new(); simulations.len()]);
    let of_model = |(place, missing): (usize, Vec<Range<u64>>)| {
        missing.into_par_iter().map(move |runs| (place, runs))
    };
    // Of all models, so that the threads that have no runs left to do in one begin with the next.
    missing.into_par_iter().enumerate().flat_map(of_model).try_for_each(|(place, runs)| {
        go_on(plan.stop.map(Arc::as_ref))?;
        let table = run_range(&simulations[place].1, &tables[place], runs, &|runs| {
            more(runs);
            go_on(plan.stop.map(Arc::as_ref))
        });
        let table = table.map_err(CampaignError::in_blocks)?;
        blocks.write(&table)?;
        if let Some(look) = look {
            look(place, &table);
        }
        let numbers = (table.len() * table.columns().len()) as u64;
        let fits = room
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |room| room.checked_sub(numbers))
            .is_ok();
        if let Ok(mut held) = held.lock()
            && fits
        {
            held[place].push(table);
        }
        Ok::<_, CampaignError>(())
    })?;
    let held = held.into_inner().unwrap_or_else(PoisonError::into_inner);
    let runs = tables.iter().zip(held).map(|(empty, held)| blocks.runs(empty, held));
    Ok(runs.map(|runs| runs.stopped_by(plan.stop.cloned())).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Each share is what the shard does.
        #[test]
        fn shares_are_those_of_shards(
            runs in 0..3000_u64,
            block_runs in 0..200_u64,
            models in 0..5_usize,
            shards in 0..40_u32,
        ) {
            let plan = |doing| Plan { runs, block_runs, doing, stop: None };
            let own = (1..=shards).map(|number| {
                plan(Doing::Shard(Shard::new(number, shards).unwrap())).total(models)
            });
            prop_assert_eq!(plan(Doing::All).shares(models, shards), own.collect::<Vec<_>>());
            prop_assert_eq!(plan(Doing::All).total(models), runs * models as u64);
            prop_assert_eq!(plan(Doing::Nothing).total(models), 0);
        }
    }
}
