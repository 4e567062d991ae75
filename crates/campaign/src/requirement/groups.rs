//! How many vehicles keep a requirement: groups of runs, counted block by block.

use std::collections::BTreeMap;

/// Groups of so many consecutive runs each, and how many of them keep a requirement: in at least a share of their runs.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    size: u64,
    /// Runs of a group that may fail.
    may_fail: u64,
    /// Groups all runs of which were seen, and those of them that keep the requirement.
    pub(super) whole: u64,
    pub(super) keeping: u64,
    /// Runs that were seen of the other groups, and those of them that fail.
    parts: BTreeMap<u64, (u64, u64)>,
}

impl Groups {
    /// Groups of so many runs, of which the share `probability` must keep the requirement.
    pub(super) fn new(size: u64, probability: f64) -> Self {
        // The least number of runs that is not less than the share, whatever the product is rounded to.
        let keep = (probability * size as f64 * (1.0 - 1e-12)).ceil() as u64;
        let may_fail = size.saturating_sub(keep);
        Self { size, may_fail, whole: 0, keeping: 0, parts: BTreeMap::new() }
    }

    /// Adds runs that come one after the other, and whether each keeps the requirement.
    pub(super) fn add(&mut self, first: u64, runs: impl Iterator<Item = bool>) {
        let mut now: Option<(u64, (u64, u64))> = None;
        for (run, keeps) in (first..).zip(runs) {
            let group = run / self.size;
            let (seen, failing) = match now {
                Some((own, counts)) if own == group => counts,
                Some((other, counts)) => {
                    self.take(other, counts);
                    (0, 0)
                }
                None => (0, 0),
            };
            now = Some((group, (seen + 1, failing + u64::from(!keeps))));
        }
        if let Some((group, counts)) = now {
            self.take(group, counts);
        }
    }

    /// Takes in groups that were counted elsewhere.
    pub(super) fn merge(&mut self, other: Self) {
        self.whole += other.whole;
        self.keeping += other.keeping;
        other.parts.into_iter().for_each(|(group, counts)| self.take(group, counts));
    }

    fn take(&mut self, group: u64, (seen, failing): (u64, u64)) {
        let (before, failing_before) = self.parts.remove(&group).unwrap_or_default();
        let (seen, failing) = (seen + before, failing + failing_before);
        if seen < self.size {
            self.parts.insert(group, (seen, failing));
            return;
        }
        self.whole += 1;
        self.keeping += u64::from(failing <= self.may_fail);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Blocks of any size, in any order, some of them counted together: as if all runs were looked at once.
        #[test]
        fn blocks_in_any_order_are_counted(
            runs in prop::collection::vec(prop::bool::weighted(0.8), 0..300),
            size in 1_u64..12,
            block in 1_usize..40,
            probability in prop_oneof![0.01..0.999, Just(0.5), Just(0.75), Just(0.9)],
            order in prop::collection::vec(any::<u16>(), 300),
        ) {
            let mut blocks: Vec<(usize, &[bool])> = runs.chunks(block).enumerate().collect();
            blocks.sort_by_key(|(i, _)| order[*i]);
            let mut parts = [Groups::new(size, probability), Groups::new(size, probability)];
            for (n, (i, runs)) in blocks.into_iter().enumerate() {
                parts[n % 2].add((i * block) as u64, runs.iter().copied());
            }
            let [mut whole, other] = parts;
            whole.merge(other);
            let groups = runs.chunks_exact(size as usize);
            prop_assert_eq!(whole.whole, groups.len() as u64);
            let keeps = |group: &&[bool]| {
                group.iter().filter(|keeps| **keeps).count() as f64 / size as f64 >= probability
            };
            prop_assert_eq!(whole.keeping, groups.filter(keeps).count() as u64);
        }
    }
}
