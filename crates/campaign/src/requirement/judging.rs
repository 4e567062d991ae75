//! Requirements judged by the runs of a campaign, block by block and in flat memory.

use rayon::prelude::*;
use std::{
    iter,
    sync::{Mutex, PoisonError},
};

use super::{
    Judgement, JudgementError, Requirement,
    deciding::Looks,
    gathering::{Gathering, Part},
    groups::Groups,
};
use crate::{runs::Runs, table::Table};

/// Requirements of which the runs of a model are looked at, while they are done.
#[derive(Debug)]
pub struct Judging {
    gatherings: Vec<Gathering>,
    /// Runs of a group, which have something in common: the first of each is independent of all others.
    group: u64,
    parts: Mutex<Vec<Option<Part>>>,
    /// How many groups keep each requirement; none without groups.
    groups: Mutex<Vec<Groups>>,
}

impl Judging {
    /// Of at most so many runs. If runs come in groups that have something in common, as flights of a vehicle, the first run of
    /// each group is judged: a verdict counts runs that are independent of each other. Without groups their size is 1.
    #[must_use]
    pub fn new(requirements: impl IntoIterator<Item = Requirement>, runs: u64, group: u64) -> Self {
        let group = group.max(1);
        let gathering = |requirement| Gathering::new(requirement, runs, group);
        let gatherings: Vec<Gathering> = requirements.into_iter().map(gathering).collect();
        let parts = Mutex::new(gatherings.iter().map(Gathering::part).collect());
        let groups =
            Mutex::new(if group > 1 { new_groups(&gatherings, group) } else { Vec::new() });
        Self { gatherings, group, parts, groups }
    }

    /// The same of runs that are looked at so often before a verdict.
    #[must_use]
    pub fn looked_at(mut self, looks: Looks) -> Self {
        let gatherings = std::mem::take(&mut self.gatherings).into_iter();
        self.gatherings = gatherings.map(|gathering| gathering.looked_at(looks)).collect();
        self
    }

    /// The same of runs that are looked at after so many, of which it is told how many count: the numbers rise.
    #[must_use]
    pub fn looked_after(mut self, runs: &[u64]) -> Self {
        let gatherings = std::mem::take(&mut self.gatherings).into_iter();
        self.gatherings = gatherings.map(|of| of.looked_after(runs.to_vec())).collect();
        self
    }

    /// Looks at a block, once at each and in any order.
    pub fn look(&self, block: &Table) {
        if self.gatherings.is_empty() {
            return;
        }
        let empty: Vec<Option<Part>> = self.gatherings.iter().map(Gathering::part).collect();
        let gathered = self.gather(empty, block);
        let mut parts = self.parts.lock().unwrap_or_else(PoisonError::into_inner);
        merge(&mut parts, gathered);
        drop(parts);
        if self.group > 1 {
            let counted = self.count_groups(block);
            let mut groups = self.groups.lock().unwrap_or_else(PoisonError::into_inner);
            groups.iter_mut().zip(counted).for_each(|(own, more)| own.merge(more));
        }
    }

    /// The groups of a block that keep each requirement.
    fn count_groups(&self, block: &Table) -> Vec<Groups> {
        let mut counted = new_groups(&self.gatherings, self.group);
        for (gathering, groups) in self.gatherings.iter().zip(&mut counted) {
            groups.add(None, block.first(), gathering.requirement.failing(block).into_iter());
        }
        counted
    }

    /// What the runs say whose blocks have all been looked at, which are read again if need be. None if there are no runs.
    ///
    /// # Errors
    /// A block cannot be read, or there are more runs than can be judged.
    pub fn finish(mut self, runs: &Runs) -> Result<Vec<Judgement>, JudgementError> {
        let parts = self.parts.get_mut().unwrap_or_else(PoisonError::into_inner);
        let mut parts = std::mem::take(parts);
        loop {
            for (gathering, part) in self.gatherings.iter_mut().zip(parts) {
                part.map_or(Ok(()), |part| gathering.advance(part))?;
            }
            let empty: Vec<Option<Part>> = self.gatherings.iter().map(Gathering::part).collect();
            if empty.iter().all(Option::is_none) {
                let groups = self.groups.into_inner().unwrap_or_else(PoisonError::into_inner);
                let groups = groups.iter().map(Some).chain(iter::repeat(None));
                let judged = self.gatherings.iter().zip(groups);
                let judged = judged.filter(|(gathering, _)| gathering.tally.runs > 0);
                return judged
                    .map(|(gathering, groups)| Judgement::of(gathering)?.of_groups(groups))
                    .collect();
            }
            let whole = Mutex::new(empty.clone());
            runs.scan(|block| {
                let gathered = self.gather(empty.clone(), block);
                merge(&mut whole.lock().unwrap_or_else(PoisonError::into_inner), gathered);
            })?;
            parts = whole.into_inner().unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Adds a block to what is gathered.
    fn gather(&self, mut parts: Vec<Option<Part>>, block: &Table) -> Vec<Option<Part>> {
        self.gatherings.par_iter().zip(&mut parts).for_each(|(gathering, part)| {
            let Some(part) = part else { return };
            let runs = (block.first()..).zip(gathering.requirement.quantity().numbers(block));
            let first = runs.filter(|(run, _)| run.is_multiple_of(self.group));
            gathering.gather(part, first.map(|(run, number)| (run, run / self.group, number)));
        });
        parts
    }
}

fn new_groups(gatherings: &[Gathering], size: u64) -> Vec<Groups> {
    let of = |gathering: &Gathering| Groups::new(size, gathering.requirement.probability());
    gatherings.iter().map(of).collect()
}

fn merge(whole: &mut [Option<Part>], parts: Vec<Option<Part>>) {
    for (whole, part) in whole.iter_mut().zip(parts) {
        if let (Some(whole), Some(part)) = (whole, part) {
            whole.merge(part);
        }
    }
}
