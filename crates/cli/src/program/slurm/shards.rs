//! Into how many shards a study is divided.

use std::time::Duration;

/// The largest number of a task of an array, where nobody changed Slurm's `MaxArraySize` of 1001.
pub(super) const LARGEST_ARRAY: u32 = 1000;
/// A shard that takes so long is worth the seconds that a scheduler spends on it, and little is lost if its node fails.
const AIM: Duration = Duration::from_secs(600);
/// No shard takes less, if there is another.
const LEAST: Duration = Duration::from_secs(60);

/// How many shards a study has that takes so long in one process, and whose smallest shard, if there are so many, takes so long.
pub(super) fn choose(total: Duration, smallest: &dyn Fn(u32) -> Duration) -> u32 {
    let most = (total.as_secs_f64() / AIM.as_secs_f64()).round() as u32;
    (2..=most.min(LARGEST_ARRAY)).rev().find(|shards| smallest(*shards) >= LEAST).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_study::{AnyScenario, Scenario};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]

        /// For studies of any size and any speed: one shard, or shards of a minute or more, none without runs, ten minutes on
        /// average where the blocks and the size of arrays allow it.
        #[test]
        fn shards_are_neither_short_nor_many(
            exponent in 0.0..7.0_f64,
            seconds in -7.0..1.0_f64,
        ) {
            let runs = 10_f64.powf(exponent) as u64;
            let scenario = Scenario::peck_2003().unwrap().with_runs(runs).unwrap();
            let scenario = AnyScenario::Separation(Box::new(scenario));
            let each = 10_f64.powf(seconds);
            let time = |runs: u64| Duration::from_secs_f64(each * runs as f64);
            let total: u64 = scenario.planned_shares(1).iter().sum();
            prop_assert_eq!(total, 4 * runs);
            let least = |shards| time(scenario.planned_shares(shards).into_iter().min().unwrap());
            let shards = choose(time(total), &least);
            prop_assert!((1..=1000).contains(&shards));
            let shares = scenario.planned_shares(shards);
            prop_assert_eq!(shares.iter().sum::<u64>(), total);
            prop_assert!(shards == 1 || shares.iter().all(|runs| time(*runs) >= LEAST));
            let average = each * total as f64 / f64::from(shards);
            // Of fifteen minutes are made two shards.
            prop_assert!(shards == 1 || average >= 449.9);
            // Twenty full blocks and more a shard: they differ by little.
            let blocks_of_a_shard = 600.0 / (each * 16384.0);
            if (20.0..1e9).contains(&blocks_of_a_shard) && total > 16384 * 400 && shards < 1000 {
                prop_assert!(average < 901.0, "{} {}", shards, average);
            }
        }
    }

    #[test]
    fn shards_take_ten_minutes() {
        for (minutes, shards) in
            [(0, 1), (5, 1), (14, 1), (15, 2), (20, 2), (104, 10), (9_994, 999), (1_000_000, 1000)]
        {
            let total = Duration::from_secs(60 * minutes);
            assert_eq!(choose(total, &|shards| total / shards), shards, "{minutes} min");
        }
        assert_eq!(choose(Duration::MAX, &|_| Duration::ZERO), 1);
    }
}
