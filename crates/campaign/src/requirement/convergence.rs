//! How the estimate of a share comes to rest: the runs that fail a requirement among the first so many.

use gyradius_statistics::{Interval, Proportion, StatisticsError};
use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// Numbers of runs that are told of, at most.
const TOLD: usize = 40;

/// After so many runs is counted: nine times a decade, from ten on.
static ENDS: LazyLock<Vec<u64>> = LazyLock::new(|| {
    let ends = (9..).map(|i| libm::exp10(f64::from(i) / 9.0).round() as u64);
    ends.take_while(|end| *end < Proportion::MAX_TRIALS).collect()
});

/// The share of runs that fail a requirement, among the first so many.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConvergencePoint {
    /// Runs that count.
    pub runs: u64,
    /// Those of them that do not keep the requirement.
    pub failures: u64,
    /// The share of them.
    pub failing: f64,
    /// Where the true share lies, two-sided: Clopper and Pearson's interval, as if nobody had looked before, or that of a confidence
    /// sequence if the runs were looked at often.
    pub interval: Interval,
}

/// Runs in the order of their numbers, counted between numbers of runs.
#[derive(Clone, Debug, Default)]
pub(super) struct Prefixes {
    /// Runs that count, and failures, up to each end and after the last.
    counts: Vec<[u64; 2]>,
}

impl Prefixes {
    /// Adds a run, from 0, that counts.
    pub(super) fn add(&mut self, run: u64, fails: bool) {
        let place = ENDS.partition_point(|end| *end <= run);
        self.reach(place + 1);
        let [runs, failures] = &mut self.counts[place];
        *runs += 1;
        *failures += u64::from(fails);
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.reach(other.counts.len());
        for (own, more) in self.counts.iter_mut().zip(&other.counts) {
            *own = [own[0] + more[0], own[1] + more[1]];
        }
    }

    fn reach(&mut self, places: usize) {
        self.counts.resize(places.max(self.counts.len()), [0; 2]);
    }

    /// The estimates that so many runs give, the last of all of them, each with the interval of so many failures in so many runs.
    pub(super) fn estimates(
        &self,
        interval: impl Fn(u64, u64) -> Result<Interval, StatisticsError>,
    ) -> Result<Vec<ConvergencePoint>, StatisticsError> {
        let mut all = [0; 2];
        let mut counts: Vec<[u64; 2]> = Vec::new();
        for [runs, failures] in self.counts.iter().filter(|[runs, _]| *runs > 0) {
            all = [all[0] + runs, all[1] + failures];
            counts.push(all);
        }
        let apart = counts.len().div_ceil(TOLD).max(1);
        let mut told: Vec<[u64; 2]> = counts.into_iter().rev().step_by(apart).collect();
        told.reverse();
        let estimate = |[runs, failures]: [u64; 2]| {
            let (failing, interval) = (failures as f64 / runs as f64, interval(failures, runs)?);
            Ok(ConvergencePoint { runs, failures, failing, interval })
        };
        told.into_iter().map(estimate).collect()
    }
}

/// How many runs count among the first so many, of some numbers of runs.
#[derive(Clone, Debug, Default)]
pub(super) struct CountedAmong {
    /// Those between one number of runs and the next.
    counts: Vec<u64>,
}

impl CountedAmong {
    /// Adds a run, from 0, that counts; the numbers of runs rise.
    pub(super) fn add(&mut self, run: u64, numbers: &[u64]) {
        let place = numbers.partition_point(|number| *number <= run);
        self.reach(place + 1);
        self.counts[place] += 1;
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.reach(other.counts.len());
        self.counts.iter_mut().zip(&other.counts).for_each(|(own, more)| *own += more);
    }

    fn reach(&mut self, places: usize) {
        self.counts.resize(places.max(self.counts.len()), 0);
    }

    /// Among the first of each of these numbers of runs.
    pub(super) fn told(&self, numbers: &[u64]) -> Vec<u64> {
        let mut all = 0;
        let counts = self.counts.iter().copied().chain(std::iter::repeat(0));
        let told = counts.zip(numbers).map(|(more, _)| {
            all += more;
            all
        });
        told.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_statistics::Confidence;
    use proptest::prelude::*;

    proptest! {
        /// Runs in blocks of any size and order, some of them missing: as if all were counted from the first to each number.
        #[test]
        fn estimates_are_those_of_counting(
            runs in prop::collection::vec(prop::option::weighted(0.9, prop::bool::weighted(0.2)), 0..3000),
            block in 1_usize..500,
            order in prop::collection::vec(any::<u16>(), 3000),
        ) {
            let mut blocks: Vec<(usize, &[Option<bool>])> = runs.chunks(block).enumerate().collect();
            blocks.sort_by_key(|(i, _)| order[*i]);
            let mut whole = Prefixes::default();
            for (i, block_runs) in blocks {
                let mut part = Prefixes::default();
                for (run, fails) in ((i * block) as u64..).zip(block_runs) {
                    fails.iter().for_each(|fails| part.add(run, *fails));
                }
                whole.merge(&part);
            }
            let confidence = Confidence::new(0.9).unwrap();
            let interval = |failures, runs| Ok(Proportion::new(failures, runs)?.interval(confidence));
            let told = whole.estimates(interval).unwrap();
            let counted: Vec<bool> = runs.iter().copied().flatten().collect();
            prop_assert!(told.len() <= TOLD);
            prop_assert_eq!(told.last().map(|last| last.runs), (!counted.is_empty()).then_some(counted.len() as u64));
            prop_assert!(told.windows(2).all(|pair| pair[0].runs < pair[1].runs));
            for estimate in &told {
                let failures = counted[..estimate.runs as usize].iter().filter(|fails| **fails).count() as u64;
                prop_assert_eq!(estimate.failures, failures);
                prop_assert_eq!(estimate.failing, failures as f64 / estimate.runs as f64);
                prop_assert!(estimate.interval.contains(estimate.failing));
            }
        }
    }

    #[test]
    fn numbers_of_runs_are_even_on_a_logarithmic_axis() {
        assert_eq!(ENDS[..10], [10, 13, 17, 22, 28, 36, 46, 60, 77, 100]);
        for n in [11_u64, 2000, 1_000_000] {
            let mut all = Prefixes::default();
            (0..n).for_each(|run| all.add(run, false));
            let interval = |failures, runs| {
                Ok(Proportion::new(failures, runs)?.interval(Confidence::default()))
            };
            let told = all.estimates(interval).unwrap();
            assert_eq!(told.last().unwrap().runs, n);
            assert!(told.iter().all(|e| ENDS.contains(&e.runs) || e.runs == n), "{told:?}");
            assert!(n < 1000 || (20..=TOLD).contains(&told.len()), "{}", told.len());
        }
    }
}
