//! Weighted estimates against known probabilities, and against plain counts.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Exp1, StandardNormal};

use super::*;
use crate::tail;

fn estimate(
    seed: u64,
    runs: usize,
    mut run: impl FnMut(&mut ChaCha8Rng) -> (f64, bool),
) -> ImportanceEstimate {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut sums = ImportanceSampling::new();
    for _ in 0..runs {
        let (log_weight, hit) = run(&mut rng);
        sums.push(log_weight, hit).unwrap();
    }
    sums.finish(Confidence::default()).unwrap()
}

/// The share of repetitions whose interval covers the truth, and the mean of the estimates over the truth.
fn coverage(truth: f64, runs: usize, run: impl Fn(&mut ChaCha8Rng) -> (f64, bool)) -> (f64, f64) {
    let repetitions = 500;
    let (mut covered, mut sum) = (0.0, 0.0);
    for seed in 0..repetitions {
        let estimate = estimate(seed, runs, &run);
        covered += f64::from(u8::from(estimate.interval().contains(truth)));
        sum += estimate.probability() / truth;
    }
    (covered / repetitions as f64, sum / repetitions as f64)
}

/// A normal law moved by so much, and divided by a spread.
fn moved(by: f64, spread: f64, limit: f64) -> impl Fn(&mut ChaCha8Rng) -> (f64, bool) {
    move |rng| {
        let z: f64 = StandardNormal.sample(rng);
        let x = by + spread * z;
        (0.5 * (z * z - x * x) + spread.ln(), x > limit)
    }
}

/// Events that are anything but rare, drawn from their own law, from one that is moved away from them, and from one that is moved on.
#[test]
fn probabilities_near_one_are_covered() {
    for limit in [-0.5, -1.0, -2.5, -3.7] {
        for (by, spread) in [(0.0, 1.0), (0.3, 1.2), (-0.5, 1.1), (-1.0, 1.3)] {
            for runs in [50, 500, 3000] {
                let truth = tail::normal(limit);
                let (covered, mean) = coverage(truth, runs, moved(by, spread, limit));
                assert!(
                    covered > 0.92 && (mean - 1.0).abs() < 0.05,
                    "{limit} {by} {runs}: {covered} {mean}"
                );
            }
        }
    }
}

proptest! {
    /// Weights of 1 are none: the interval is that of counted runs where the event is not rare, never beyond 0 and 1, and never
    /// without a width.
    #[test]
    fn weights_of_one_are_counts(runs in 2..3000_u64, share in 0.0..=1.0_f64, some in 0.0..=3.0_f64) {
        let hits = ((share * runs as f64) as u64).max(runs.saturating_sub((some * 2.0) as u64));
        let mut sums = ImportanceSampling::new();
        for run in 0..runs {
            sums.push(0.0, run < hits).unwrap();
        }
        let found = sums.finish(Confidence::default()).unwrap();
        let exact = crate::Proportion::new(hits, runs).unwrap();
        let interval = found.interval();
        prop_assert!((found.probability() - exact.value()).abs() < 1e-12 && found.probability() <= 1.0);
        prop_assert!(interval.contains(found.probability()) && interval.lower() < interval.upper());
        prop_assert!(interval.lower() >= 0.0 && interval.upper() <= 1.0);
        if exact.value() > 0.5 + 1e-9 {
            let exact = exact.interval(Confidence::default());
            prop_assert!((interval.lower() - exact.lower()).abs() < 1e-9, "{interval} {exact}");
            prop_assert!((interval.upper() - exact.upper()).abs() < 1e-9, "{interval} {exact}");
        }
    }
}

proptest! {
    /// Weights near the largest that is allowed have estimates that are numbers, and in proportion to those of small ones.
    #[test]
    fn no_estimate_overflows(
        runs in prop::collection::vec((0.0..30.0_f64, prop::bool::weighted(0.7)), 2..400),
        repeat in 1..30_usize,
    ) {
        let of = |shift: f64| {
            let mut sums = ImportanceSampling::new();
            for (log_weight, hit) in std::iter::repeat_n(&runs, repeat).flatten() {
                sums.push(log_weight - 30.0 + shift, *hit).unwrap();
            }
            sums.finish(Confidence::default()).unwrap()
        };
        let (large, small) = (of(LARGEST), of(0.0));
        let factor = libm::exp(LARGEST);
        for (found, expected) in [
            (large.probability(), small.probability() * factor),
            (large.mean_weight(), small.mean_weight() * factor),
        ] {
            prop_assert!(found.is_finite() && (found - expected).abs() <= 1e-10 * expected, "{} {}", found, expected);
        }
        prop_assert!(large.interval().lower() <= large.interval().upper() && large.interval().upper().is_finite());
    }
}

#[test]
fn known_probabilities_are_covered() {
    // A half space: up to 1e-15.
    for limit in [1.0, 3.0, 5.2, 7.9] {
        let (covered, mean) = coverage(tail::normal(limit), 300, moved(limit, 1.0, limit));
        println!("half space {limit}: {covered} {mean}");
        assert!(covered > 0.92 && (mean - 1.0).abs() < 0.03, "{covered} {mean}");
    }
    // The sum of five exponentials above 30: e⁻ˢ Σ sᵏ/k!, 3.6e-9. Each drawn with a mean of 6.
    let truth = (-30_f64).exp() * (1.0 + 30.0 + 450.0 + 4500.0 + 33_750.0);
    let (covered, mean) = coverage(truth, 500, |rng| {
        let sum: f64 = (0..5).map(|_| 6.0 * Distribution::<f64>::sample(&Exp1, rng)).sum();
        (-sum + sum / 6.0 + 5.0 * 6_f64.ln(), sum > 30.0)
    });
    println!("exponentials: {covered} {mean}");
    assert!(covered > 0.92 && (mean - 1.0).abs() < 0.03, "{covered} {mean}");
    // Either of two normal numbers, by a mixture of both moves and the law itself.
    let either = 1.0 - (1.0 - tail::normal(4.5)).powi(2);
    let (covered, mean) = coverage(either, 1000, |rng| {
        let mut x: [f64; 2] = [StandardNormal.sample(rng), StandardNormal.sample(rng)];
        match rng.random_range(0..10) {
            0 | 1 => {}
            part => x[part % 2] += 4.5,
        }
        let ratio = |x: f64| (4.5 * x - 0.5 * 4.5 * 4.5).exp();
        let log = -(0.2 + 0.4 * ratio(x[0]) + 0.4 * ratio(x[1])).ln();
        (log, x[0].max(x[1]) > 4.5)
    });
    println!("either: {covered} {mean}");
    assert!(covered > 0.92 && (mean - 1.0).abs() < 0.03, "{covered} {mean}");
}

/// A law with lighter tails than its own has weights without a variance: intervals do not cover, and most runs say so.
#[test]
fn a_law_that_hardly_reaches_the_event_is_told_of() {
    let limit = 3.0;
    let narrow = moved(0.0, 0.7, limit);
    let (mut covered, mut told) = (0, 0);
    for seed in 0..200 {
        let estimate = estimate(seed, 2000, &narrow);
        covered +=
            u32::from(estimate.interval().contains(tail::normal(limit)) && estimate.hits() > 0);
        told += u32::from(!estimate.warnings().is_empty());
    }
    println!("{covered} {told}");
    assert!(told == 200, "{told}");
}

/// Half of an event that is out of sight: nothing shows it but the mean weight, as the documentation says.
#[test]
fn what_was_not_seen_is_not_told_of() {
    let truth = 2.0 * tail::normal(5.0);
    let estimate = estimate(1, 2000, |rng| {
        let x = 5.0 + Distribution::<f64>::sample(&StandardNormal, rng);
        (12.5 - 5.0 * x, x.abs() > 5.0)
    });
    assert!(estimate.warnings().is_empty() && estimate.interval().upper() < truth * 0.6);
    assert!(estimate.mean_weight() < 0.5, "{estimate:?}");
}

#[test]
fn what_cannot_be_answered_is_refused() {
    let mut sums = ImportanceSampling::default();
    for value in [f64::NAN, f64::INFINITY, 701.0] {
        assert!(matches!(sums.push(value, true), Err(StatisticsError::LogWeight { .. })));
    }
    let finish = |sums: &ImportanceSampling| sums.finish(Confidence::default());
    sums.push(0.0, true).unwrap();
    assert_eq!(finish(&sums), Err(StatisticsError::TooFew { n: 1, required: 2 }));
    let mut none = ImportanceSampling::new();
    (0..9).for_each(|_| none.push(f64::NEG_INFINITY, true).unwrap());
    let none = finish(&none).unwrap();
    assert_eq!((none.probability(), none.coefficient_of_variation()), (0.0, None));
    assert_eq!((none.interval().upper(), none.warnings()), (1.0, &[WeightWarning::NoHit][..]));
    // Weights of e in the place of 1.
    let mut wrong = ImportanceSampling::new();
    (0..99).for_each(|i| wrong.push(1.0, i % 2 == 0).unwrap());
    let wrong = finish(&wrong).unwrap();
    assert!(matches!(wrong.warnings(), [WeightWarning::MeanWeightAboveOne { .. }]), "{wrong:?}");
}

proptest! {
    /// Runs of weight 1 are a plain count, with its standard error; another unit of all weights moves the estimate alone.
    #[test]
    fn equal_weights_are_a_count(hits in prop::collection::vec(any::<bool>(), 2..200), unit in -600.0..600.0_f64) {
        let of = |unit: f64| {
            let mut sums = ImportanceSampling::new();
            hits.iter().for_each(|hit| sums.push(unit, *hit).unwrap());
            sums.finish(Confidence::default()).unwrap()
        };
        let (plain, moved) = (of(0.0), of(unit));
        let (n, k) = (hits.len() as f64, hits.iter().filter(|hit| **hit).count() as f64);
        prop_assert!((plain.probability() - k / n).abs() < 1e-12);
        prop_assert!((plain.effective_hits() - k).abs() < 1e-9 * n && (plain.effective_runs() - n).abs() < 1e-9 * n);
        if let Some(coefficient) = plain.coefficient_of_variation() {
            let p = k / n;
            prop_assert!((coefficient * p - (p * (1.0 - p) / (n - 1.0)).sqrt()).abs() < 1e-9);
        }
        prop_assert_eq!(plain.coefficient_of_variation(), moved.coefficient_of_variation());
        prop_assert!((moved.probability() / plain.probability().max(1e-300)).ln().abs() < 601.0 || k == 0.0);
    }

    /// Against sums of the weights themselves, in whatever order they grow.
    #[test]
    fn sums_are_those_of_the_weights(runs in prop::collection::vec((-9.0..9.0_f64, any::<bool>()), 2..40)) {
        let mut sums = ImportanceSampling::new();
        runs.iter().for_each(|(log, hit)| sums.push(*log, *hit).unwrap());
        let estimate = sums.finish(Confidence::default()).unwrap();
        let n = runs.len() as f64;
        let hits: Vec<f64> = runs.iter().map(|(log, hit)| if *hit { log.exp() } else { 0.0 }).collect();
        let all: Vec<f64> = runs.iter().map(|(log, _)| log.exp()).collect();
        let near = |found: f64, expected: f64| (found - expected).abs() <= 1e-9 * expected.abs();
        let effective = |weights: &[f64]| {
            weights.iter().sum::<f64>().powi(2) / weights.iter().map(|w| w * w).sum::<f64>()
        };
        prop_assert!(near(estimate.mean_weight(), all.iter().sum::<f64>() / n));
        prop_assert!(near(estimate.effective_runs(), effective(&all)));
        let p = hits.iter().sum::<f64>() / n;
        prop_assert!(near(estimate.probability(), p));
        if p > 0.0 {
            prop_assert!(near(estimate.effective_hits(), effective(&hits)));
            prop_assert!(near(estimate.largest_share(), hits.iter().copied().fold(0.0, f64::max) / (p * n)));
            let variance = hits.iter().map(|z| (z - p).powi(2)).sum::<f64>() / (n - 1.0) / n;
            let found = estimate.coefficient_of_variation().unwrap();
            prop_assert!((found - variance.sqrt() / p).abs() < 1e-6, "{} {}", found, variance.sqrt() / p);
        }
    }

    #[test]
    fn every_weight_gives_numbers(runs in prop::collection::vec((any::<f64>(), any::<bool>()), 0..20)) {
        let mut sums = ImportanceSampling::new();
        for (weight, hit) in runs {
            let _ = sums.push(weight, hit);
            let _ = sums.push(weight % 700.0, hit);
        }
        if let Ok(estimate) = sums.finish(Confidence::default()) {
            prop_assert!(estimate.probability() >= 0.0 && estimate.interval().contains(estimate.probability()));
            prop_assert!((0.0..=1.0).contains(&estimate.largest_share()));
        }
    }
}
