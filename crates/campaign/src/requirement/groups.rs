//! How many vehicles keep a requirement: groups of runs, counted block by block.

use std::collections::BTreeMap;

/// Groups of so many consecutive runs each, and how many of them keep a requirement: in at least a share of their runs that
/// count.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    size: u64,
    /// The share of a group's runs that must keep the requirement.
    probability: f64,
    /// Groups all runs of which were seen, and of which one counts at least, and those of them that keep the requirement.
    pub(super) whole: u64,
    pub(super) keeping: u64,
    /// Of the other groups, each of a model, if that is known.
    parts: BTreeMap<Group, Seen>,
}

/// A group of a model, which may be one of several in a table: the model's number, and that of the group among those of the model.
type Group = (Option<u64>, u64);

/// Runs of a group that were seen, those of them that count, and those that fail.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    runs: u64,
    counted: u64,
    failing: u64,
}

impl Seen {
    fn add(&mut self, other: Self) {
        self.runs += other.runs;
        self.counted += other.counted;
        self.failing += other.failing;
    }
}

impl Groups {
    /// Groups of so many runs, of which the share `probability` must keep the requirement.
    pub(super) fn new(size: u64, probability: f64) -> Self {
        Self { size, probability, whole: 0, keeping: 0, parts: BTreeMap::new() }
    }

    /// Adds runs of a model that come one after the other, and whether each fails the requirement; none of those that do not count.
    pub(super) fn add(
        &mut self,
        model: Option<u64>,
        first: u64,
        runs: impl Iterator<Item = Option<bool>>,
    ) {
        let mut now: Option<(Group, Seen)> = None;
        for (run, fails) in (first..).zip(runs) {
            let group = (model, run / self.size);
            let mut seen = match now {
                Some((own, seen)) if own == group => seen,
                Some((other, seen)) => {
                    self.take(other, seen);
                    Seen::default()
                }
                None => Seen::default(),
            };
            let [counted, failing] = [fails.is_some(), fails == Some(true)].map(u64::from);
            seen.add(Seen { runs: 1, counted, failing });
            now = Some((group, seen));
        }
        if let Some((group, seen)) = now {
            self.take(group, seen);
        }
    }

    /// Takes in groups that were counted elsewhere.
    pub(super) fn merge(&mut self, other: Self) {
        self.whole += other.whole;
        self.keeping += other.keeping;
        other.parts.into_iter().for_each(|(group, seen)| self.take(group, seen));
    }

    fn take(&mut self, group: Group, mut seen: Seen) {
        seen.add(self.parts.remove(&group).unwrap_or_default());
        if seen.runs < self.size {
            self.parts.insert(group, seen);
        } else if seen.counted > 0 {
            // The least number of runs that is not less than the share, whatever the product is rounded to.
            let keep = (self.probability * seen.counted as f64 * (1.0 - 1e-12)).ceil() as u64;
            self.whole += 1;
            self.keeping += u64::from(seen.counted - seen.failing >= keep);
        }
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
            runs in prop::collection::vec(prop::option::weighted(0.8, prop::bool::weighted(0.2)), 0..300),
            size in 1_u64..12,
            block in 1_usize..40,
            probability in prop_oneof![0.01..0.999, Just(0.5), Just(0.75), Just(0.9)],
            order in prop::collection::vec(any::<u16>(), 300),
        ) {
            let mut blocks: Vec<(usize, &[Option<bool>])> = runs.chunks(block).enumerate().collect();
            blocks.sort_by_key(|(i, _)| order[*i]);
            let mut parts = [Groups::new(size, probability), Groups::new(size, probability)];
            for (n, (i, runs)) in blocks.into_iter().enumerate() {
                parts[n % 2].add(None, (i * block) as u64, runs.iter().copied());
            }
            let [mut whole, other] = parts;
            whole.merge(other);
            let counted = runs.chunks_exact(size as usize).map(|group| group.iter().flatten().collect::<Vec<_>>());
            let groups: Vec<Vec<&bool>> = counted.filter(|group| !group.is_empty()).collect();
            prop_assert_eq!(whole.whole, groups.len() as u64);
            let keeps = |group: &&Vec<&bool>| {
                group.iter().filter(|fails| !***fails).count() as f64 / group.len() as f64 >= probability
            };
            prop_assert_eq!(whole.keeping, groups.iter().filter(keeps).count() as u64);
        }
    }
}
