//! Subset simulation against known probabilities, where it works and where it does not.

use std::cell::RefCell;
use std::collections::BTreeSet;

use proptest::prelude::*;

use super::*;
use crate::law::at_least;
use crate::tail;

/// A uniform number of a group's draw: SplitMix64 of seed, group, draw and place.
fn uniform(seed: u64, group: usize, draw: u64, place: u64) -> f64 {
    let mut x = 0_u64;
    for part in [seed, group as u64, draw, place] {
        x = (x ^ part).wrapping_add(0x9e37_79b9_7f4a_7c15);
        x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^= x >> 31;
    }
    ((x >> 12) as f64 + 0.5) * 2_f64.powi(-52)
}

fn normal(seed: u64, group: usize, draw: u64, place: u64) -> f64 {
    law::normal(uniform(seed, group, draw, place))
}

/// The sum over groups of a number that each has.
fn sum(draws: &[u64], of: impl Fn(usize, u64) -> f64) -> f64 {
    draws.iter().enumerate().map(|(group, draw)| of(group, *draw)).sum()
}

/// A model with a seed.
type Model = fn(u64, &[u64]) -> f64;

fn estimate(groups: usize, model: Model, seed: u64) -> SubsetEstimate {
    let plan = SubsetSimulation::new(groups, 500, 10).unwrap();
    plan.run(&|draws: &[u64]| model(seed, draws), Confidence::default()).unwrap()
}

/// Asserts that intervals cover the truth in 95 % of the repetitions or nearly so, and that the mean estimate is near it.
fn assert_covers(what: &str, groups: usize, truth: f64, model: Model) {
    let (mut covered, mut mean, mut runs, mut warned, repetitions) = (0, 0.0, 0, 0, 40);
    for seed in 0..repetitions {
        let estimate = estimate(groups, model, seed);
        covered += u32::from(estimate.interval().contains(truth));
        mean += estimate.probability() / truth / repetitions as f64;
        runs += estimate.evaluations();
        warned += u32::from(!estimate.warnings().is_empty());
    }
    println!(
        "{what}: {truth:e} covered {covered}, mean {mean:.3} of it, {} runs, warned {warned}",
        runs / repetitions
    );
    assert!(covered >= 34 && (0.85..1.2).contains(&mean), "{what}: {covered} {mean}");
    assert!(warned <= 20, "{what}: {warned}");
}

#[test]
fn sums_of_normal_numbers_down_to_a_ten_millionth() {
    assert_covers("1e-3", 10, tail::normal(3.09), |seed, draws| {
        sum(draws, |group, draw| normal(seed, group, draw, 0)) / 10_f64.sqrt() - 3.09
    });
    assert_covers("1e-7", 10, tail::normal(5.2), |seed, draws| {
        sum(draws, |group, draw| normal(seed, group, draw, 0)) / 10_f64.sqrt() - 5.2
    });
}

#[test]
fn sums_of_exponential_numbers() {
    // e⁻ˢ Σ sᵏ/k! of eight terms.
    let mut term = (-26_f64).exp();
    let mut truth = term;
    for k in 1..8 {
        term *= 26.0 / f64::from(k);
        truth += term;
    }
    assert_covers("exponential", 8, truth, |seed, draws| {
        sum(draws, |group, draw| -uniform(seed, group, draw, 0).ln()) - 26.0
    });
}

/// Directions in space, each one group of three numbers: the heights of their points are uniform (Archimedes), and the
/// sum of six is within d of the largest with probability (d/2)⁶/6!, for d up to 2.
#[test]
fn directions_that_are_one_group_each() {
    let depth: f64 = 0.6;
    assert_covers("directions", 6, (depth / 2.0).powi(6) / 720.0, |seed, draws| {
        let height = |group, draw| {
            let v = [0, 1, 2].map(|place| normal(seed, group, draw, place));
            v[2] / v.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        sum(draws, height) - (6.0 - 0.6)
    });
}

/// Whole numbers: twelve of thirty that each happen one time in ten, 2e-5.
#[test]
fn counts() {
    assert_covers("counts", 30, at_least(12, 30, 0.1, 0.9), |seed, draws| {
        sum(draws, |group, draw| f64::from(u8::from(uniform(seed, group, draw, 0) < 0.1))) - 12.0
    });
}

/// An event of either of two kinds, of which one is reached by other runs than the other.
#[test]
fn either_of_two_sums() {
    assert_covers("either", 10, 2.0 * tail::normal(4.0), |seed, draws| {
        (sum(draws, |group, draw| normal(seed, group, draw, 0)) / 10_f64.sqrt()).abs() - 4.0
    });
}

/// Two values: plain runs. 5,000 of them with a share of one in a hundred.
#[test]
fn an_excess_of_two_values_is_counted() {
    assert_covers("two values", 3, 0.01, |seed, draws| {
        let hit = uniform(seed, 0, draws[0], 0) < 0.1 && uniform(seed, 2, draws[2], 0) < 0.1;
        if hit { 7.0 } else { -2.0 }
    });
    let one = estimate(
        3,
        |seed, draws| f64::from(u8::from(uniform(seed, 1, draws[1], 0) < 0.01)) - 1.0,
        1,
    );
    assert_eq!(one.evaluations(), 5500);
}

/// Events that are not rare, some of them nearly certain: the first runs decide, with the exact interval of all of them, whose coverage over many seeds
/// is what it says at least.
#[test]
fn what_is_not_rare_is_counted_exactly() {
    let plan = SubsetSimulation::new(4, 100, 10).unwrap();
    for truth in [0.15, 0.5, 0.9, 0.99, 0.999, 0.9999, 1.0] {
        // The sum of four normal numbers, which reach this limit so often: `law::normal` is the quantile of the upper tail.
        let limit = if truth == 1.0 { f64::NEG_INFINITY } else { 2.0 * law::normal(truth) };
        let (repetitions, mut covered, mut plain) = (400, 0, 0);
        for seed in 0..repetitions {
            let hits = RefCell::new(0_u64);
            let excess = |draws: &[u64]| {
                let sum = sum(draws, |group, draw| normal(seed, group, draw, 0));
                // The numbers of the pilot's draws are below those of the first replica.
                *hits.borrow_mut() += u64::from(sum >= limit && draws[0] >= 1 << 40);
                if limit.is_finite() { sum - limit } else { 1.0 }
            };
            let estimate = plan.run(&excess, Confidence::default()).unwrap();
            covered += u32::from(estimate.interval().contains(truth));
            if estimate.evaluations() == 1100 {
                plain += 1;
                let exact = Proportion::new(hits.into_inner(), 1000).unwrap();
                assert_eq!(estimate.interval(), exact.interval(Confidence::default()));
                assert_eq!(estimate.probability(), exact.value());
                assert_eq!(estimate.warnings(), []);
            }
        }
        println!("{truth}: covered {covered} of {repetitions}, {plain} of them by plain runs");
        // Of 400 at 95 % 364 or fewer in one of a thousand cases.
        assert!(
            covered >= 364 && (plain == repetitions || truth < 0.2),
            "{truth}: {covered} {plain}"
        );
    }
}

/// One group alone has to be as rare as the event. The mean stays right where the event is within reach of the first runs of all
/// replicas; far beyond, no replica finds it, and the interval and the warnings say so.
#[test]
fn the_largest_of_several_is_out_of_reach() {
    let largest = |limit: f64| {
        move |seed: u64, draws: &[u64]| {
            let each = draws.iter().enumerate().map(|(group, draw)| normal(seed, group, *draw, 0));
            each.fold(f64::NEG_INFINITY, f64::max) - limit
        }
    };
    let plan = SubsetSimulation::new(5, 500, 10).unwrap();
    for (limit, told, least) in
        [(3.0, 0, 36), (3.5, 0, 36), (4.0, 20, 36), (4.5, 38, 36), (5.0, 38, 36), (5.61, 40, 40)]
    {
        // 6.7e-3 to 5e-8; between, some of the replicas find it.
        let truth = 1.0 - (1.0 - tail::normal(limit)).powi(5);
        let (mut covered, mut warned) = (0, 0);
        for seed in 0..40 {
            let model = largest(limit);
            let estimate =
                plan.run(&|draws: &[u64]| model(seed, draws), Confidence::default()).unwrap();
            covered += u32::from(estimate.interval().contains(truth));
            warned += u32::from(!estimate.warnings().is_empty());
        }
        println!("largest above {limit}: {truth:e} covered {covered} warned {warned}");
        assert!(covered >= least && warned >= told, "{limit}: {covered} {warned}");
    }
}

#[test]
fn what_always_or_never_is() {
    let always = estimate(2, |_, _| 0.0, 1);
    assert_eq!((always.probability(), always.evaluations()), (1.0, 5500));
    // 5,000 runs without one that is not the event: (α/2)^(1/n).
    let least = 0.025_f64.powf(1.0 / 5000.0);
    assert!((always.interval().lower() - least).abs() < 1e-12, "{always:?}");
    assert_eq!(always.interval().upper(), 1.0);
    // Never, of a constant, of a bounded number, and of runs that all failed.
    let never: [Model; 4] = [
        |_, _| -1.0,
        |seed, draws| uniform(seed, 0, draws[0], 0) + uniform(seed, 1, draws[1], 0) - 2.0,
        |_, _| f64::NAN,
        |_, _| f64::NEG_INFINITY,
    ];
    for model in never {
        let estimate = estimate(2, model, 1);
        assert_eq!((estimate.probability(), estimate.coefficient_of_variation()), (0.0, None));
        assert!(estimate.interval().upper() < 0.01, "{estimate:?}");
        assert!(estimate.warnings().contains(&SubsetWarning::NotReached { replicas: 10 }));
        assert!(estimate.events().is_empty() && estimate.evaluations() < 60_000);
    }
    let early = SubsetSimulation::new(2, 500, 10).unwrap().with_least(1e-2).unwrap();
    let bounded = |draws: &[u64]| uniform(1, 0, draws[0], 0) + uniform(1, 1, draws[1], 0) - 2.0;
    let estimate = early.run(&bounded, Confidence::default()).unwrap();
    assert!(estimate.evaluations() < 20_000 && estimate.interval().upper() < 0.01);
}

/// A run that fails is no event; where failing is the event, infinity says so.
#[test]
fn failed_runs_are_counted() {
    // Half of all runs fail, whatever else happens in them.
    let truth = 0.5 * tail::normal(4.0);
    assert_covers("failed", 11, truth, |seed, draws| {
        if uniform(seed, 10, draws[10], 1) < 0.5 {
            return f64::NAN;
        }
        sum(&draws[..10], |group, draw| normal(seed, group, draw, 0)) / 10_f64.sqrt() - 4.0
    });
    let model: Model = |seed, draws| match uniform(seed, 0, draws[0], 0) {
        low if low < 0.25 => f64::NAN,
        high if high > 0.5 => f64::INFINITY,
        _ => -1.0,
    };
    let found = estimate(1, model, 3);
    assert!((found.without_excess() as f64 / found.evaluations() as f64 - 0.25).abs() < 0.03);
    assert!((found.probability() - 0.5).abs() < 0.04, "{found:?}");
}

/// Every run is asked for once, with draws that are new or those of the run it goes on from; the outcome is the event's.
#[test]
fn draws_are_never_given_twice() {
    let asked = RefCell::new(BTreeSet::new());
    let plan = SubsetSimulation::new(10, 200, 3).unwrap();
    let excess =
        |draws: &[u64]| sum(draws, |group, draw| normal(1, group, draw, 0)) / 10_f64.sqrt() - 4.0;
    let counted = |draws: &[u64]| {
        let newest = *draws.iter().max().unwrap();
        assert!(asked.borrow_mut().insert(newest), "{newest} twice");
        assert!(draws.iter().all(|draw| asked.borrow().contains(draw)), "{draws:?}");
        excess(draws)
    };
    let estimate = plan.run(&counted, Confidence::default()).unwrap();
    assert_eq!(asked.borrow().len() as u64, estimate.evaluations());
    assert!(!estimate.events().is_empty());
    assert!(estimate.events().iter().all(|draws| excess(draws) >= 0.0));
    // Replicas that are told in another order, and the whole again.
    let mut pilot = plan.pilot();
    while !pilot.is_done() {
        let excesses: Vec<f64> = pilot.asks().iter().map(|draws| excess(draws)).collect();
        pilot.tell(&excesses).unwrap();
    }
    let mut replicas = plan.replicas(&pilot).unwrap();
    while replicas.iter().any(|replica| !replica.is_done()) {
        for replica in replicas.iter_mut().rev() {
            let excesses: Vec<f64> =
                replica.asks().iter().rev().map(|draws| excess(draws)).collect();
            let excesses: Vec<f64> = excesses.into_iter().rev().collect();
            replica.tell(&excesses).unwrap();
        }
    }
    assert_eq!(plan.finish(&pilot, &replicas, Confidence::default()).unwrap(), estimate);
}

#[test]
fn what_cannot_be_done_is_refused() {
    for (groups, runs, replicas) in [
        (0, 100, 2),
        (1, 99, 2),
        (1, 100, 1),
        (1, usize::MAX, 2),
        (1, 100, 1001),
        (usize::MAX, 100, 2),
    ] {
        assert!(SubsetSimulation::new(groups, runs, replicas).is_err());
    }
    let plan = SubsetSimulation::new(1, 100, 2).unwrap();
    assert!(plan.with_least(0.0).is_err() && plan.with_least(f64::NAN).is_err());
    let mut pilot = plan.pilot();
    let refused = StatisticsError::Columns { first: 100, second: 1 };
    assert_eq!(pilot.tell(&[1.0]), Err(refused));
    assert!(plan.replicas(&pilot).is_err());
    pilot.tell(&[1.0; 100]).unwrap();
    assert!(pilot.is_done() && pilot.tell(&[]).is_ok());
    let refused = StatisticsError::TooFew { n: 0, required: 2 };
    let replicas = plan.replicas(&pilot).unwrap();
    assert_eq!(plan.finish(&pilot, &replicas, Confidence::default()), Err(refused));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any outcomes at all: it ends, counts what it did, and gives a probability.
    #[test]
    fn any_outcomes_end(
        groups in 1..5_usize, seed: u64, values in prop::collection::vec(any::<f64>(), 1..40), fine: bool,
    ) {
        let model = |draws: &[u64]| {
            let u = uniform(seed, draws.len(), draws.iter().fold(0, |sum, draw| sum ^ draw), 0);
            let value = values[(u * values.len() as f64) as usize];
            if fine { value - u } else { value }
        };
        let plan = SubsetSimulation::new(groups, 105, 2).unwrap();
        let estimate = plan.run(&model, Confidence::default()).unwrap();
        prop_assert!((0.0..=1.0).contains(&estimate.probability()));
        prop_assert!(estimate.interval().contains(estimate.probability()), "{:?}", estimate);
        prop_assert!(estimate.evaluations() >= 315 && estimate.without_excess() <= estimate.evaluations());
    }
}
