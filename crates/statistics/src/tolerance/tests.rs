//! Bounds against verdicts, against intervals of quantiles and against what they hold.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::binomial_sums::masses;
use crate::{Confidence, Verdict};

fn rule(probability: f64, level: f64) -> Acceptance {
    Acceptance::new(probability, Confidence::new(level).unwrap()).unwrap()
}

const SIDES: [ToleranceSide; 3] =
    [ToleranceSide::AtMost, ToleranceSide::AtLeast, ToleranceSide::Between];

#[test]
fn known_numbers_of_runs() {
    let rule = rule(0.95, 0.95);
    for (side, runs) in SIDES.into_iter().zip([59, 59, 93]) {
        assert!(matches!(rule.tolerance(side, runs, 0), Tolerance::Ranks { .. }));
        let none = Tolerance::TooFewRuns { needed: Some(runs) };
        for fewer in [0, 1, runs - 1] {
            assert_eq!(rule.tolerance(side, fewer, 0), none);
        }
    }
    let ranks = |side, values, failed| match rule.tolerance(side, values, failed) {
        Tolerance::Ranks { lower, upper, .. } => (lower, upper),
        Tolerance::TooFewRuns { .. } => (None, None),
    };
    // 153 runs allow 3 failures: four are counted off.
    assert_eq!(ranks(ToleranceSide::AtMost, 153, 0), (None, Some(150)));
    assert_eq!(ranks(ToleranceSide::AtLeast, 153, 0), (Some(4), None));
    assert_eq!(ranks(ToleranceSide::Between, 153, 0), (Some(2), Some(152)));
    assert_eq!(ranks(ToleranceSide::AtMost, 151, 2), (None, Some(150)));
    assert_eq!(ranks(ToleranceSide::AtLeast, 151, 2), (Some(2), None));
    assert_eq!(ranks(ToleranceSide::Between, 151, 2), (Some(1), Some(151)));
    let none = Tolerance::TooFewRuns { needed: rule.least_runs(4) };
    assert_eq!(rule.tolerance(ToleranceSide::Between, 150, 3), none);
    for side in SIDES {
        assert_eq!(
            rule.tolerance(side, u64::MAX, u64::MAX),
            Tolerance::TooFewRuns { needed: None }
        );
        assert_eq!(
            rule.tolerance(side, 0, 9_999),
            Tolerance::TooFewRuns {
                needed: rule.least_runs(9_999 + u64::from(side == ToleranceSide::Between))
            }
        );
    }
}

#[test]
fn bounds_are_values_or_none() {
    let sample = SortedSample::new(&[1.0, 2.0, 3.0]).unwrap();
    let bounds = |lower, upper| Tolerance::Ranks { lower, upper, confidence: 0.9 }.bounds(&sample);
    assert_eq!(bounds(Some(1), Some(3)), Some((1.0, 3.0)));
    assert_eq!(bounds(None, Some(2)), Some((f64::NEG_INFINITY, 2.0)));
    assert_eq!(bounds(Some(3), None), Some((3.0, f64::INFINITY)));
    for rank in [0, 4, u64::MAX] {
        assert_eq!(bounds(Some(rank), None), None);
    }
    assert_eq!(Tolerance::TooFewRuns { needed: None }.bounds(&sample), None);
}

/// Draws of a law with steps, some of which have no value, hold the share at least as often as they say.
#[test]
fn bounds_hold_their_share_of_laws_with_steps_and_failures() {
    use rand::{RngExt, SeedableRng};
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (rule, runs, trials) = (rule(0.9, 0.9), 180_usize, 4000);
    for (steps, failing) in [(0.0, 0.0), (0.0, 0.03), (50.0, 0.02), (3.0, 0.04), (0.0, 0.1)] {
        // Up to where the law of a value lies: whole multiples of a step.
        let value = |u: f64| if steps > 0.0 { (u * steps).floor() / steps } else { u };
        let below = |x: f64| if steps > 0.0 { (x * steps).ceil() / steps } else { x };
        let up_to = |x: f64| if steps > 0.0 { ((x * steps).floor() + 1.0) / steps } else { x };
        for side in SIDES {
            let (mut held, mut none) = (0, 0);
            for _ in 0..trials {
                let values: Vec<f64> = (0..runs)
                    .filter_map(|_| {
                        let (fails, u) = (rng.random::<f64>() < failing, rng.random::<f64>());
                        (!fails).then(|| value(u))
                    })
                    .collect();
                let sample = SortedSample::new(&values).unwrap();
                let failed = runs - values.len();
                let tolerance = rule.tolerance(side, values.len() as u64, failed as u64);
                let Some((lower, upper)) = tolerance.bounds(&sample) else {
                    none += 1;
                    continue;
                };
                let share = up_to(upper.min(1.0)).min(1.0) - below(lower.max(0.0));
                held += usize::from((1.0 - failing) * share >= 0.9);
            }
            // A sample without bounds claims nothing, and so is not wrong.
            let right = (held + none) as f64 / trials as f64;
            assert!(right > 0.9 - 4.0 * (0.09 / trials as f64).sqrt(), "{side:?} {steps}: {right}");
            if steps == 0.0 && failing < 0.1 {
                assert!(right < 0.96, "{side:?}: {right} is more than was asked for");
            }
        }
    }
}

proptest! {
    #[test]
    fn a_bound_keeps_the_limit_if_the_requirement_is_met(
        values in prop::collection::vec(-1.0..1.0f64, 1..300),
        failed in 0..5u64,
        limit in -1.0..1.0f64,
        probability in 0.1..0.99f64,
        level in 0.5..0.99f64,
    ) {
        let (rule, runs) = (rule(probability, level), values.len() as u64 + failed);
        let (n, sample) = (values.len() as u64, SortedSample::new(&values).unwrap());
        let count = |hit: &dyn Fn(f64) -> bool| values.iter().filter(|x| hit(**x)).count() as u64;
        let met = |failures| rule.verdict(failures + failed, runs) == Ok(Verdict::Met);
        let at_most = rule.tolerance(ToleranceSide::AtMost, n, failed).bounds(&sample);
        prop_assert_eq!(at_most.is_some_and(|(_, upper)| upper <= limit), met(count(&|x| x > limit)));
        let at_least = rule.tolerance(ToleranceSide::AtLeast, n, failed).bounds(&sample);
        prop_assert_eq!(at_least.is_some_and(|(lower, _)| lower >= limit), met(count(&|x| x < limit)));
        let between = rule.tolerance(ToleranceSide::Between, n, failed).bounds(&sample);
        if between.is_some_and(|(lower, upper)| -limit.abs() <= lower && upper <= limit.abs()) {
            prop_assert!(met(count(&|x| x.abs() > limit.abs())));
        }
    }

    /// Of n draws of a law without steps, the share between the values l and u is at least p with the probability that
    /// fewer than u − l of n fall into a share p.
    #[test]
    fn coverage_is_the_sum_and_ranks_are_the_least(
        values in 1..300u64,
        probability in 0.05..0.98f64,
        level in 0.5..0.99f64,
    ) {
        let rule = rule(probability, level);
        let masses = masses(values, probability, rule.failure_share());
        for side in SIDES {
            let Tolerance::Ranks { lower, upper, confidence } = rule.tolerance(side, values, 0) else {
                continue;
            };
            let blocks = (upper.unwrap_or(values + 1) - lower.unwrap_or(0)) as usize;
            let sum = |blocks: usize| masses[..blocks].iter().sum::<f64>();
            prop_assert!((sum(blocks) - confidence).abs() < 1e-11, "{side:?}");
            prop_assert!(confidence >= level && sum(blocks - 1) < level + 1e-9);
        }
    }

    /// A bound from above at confidence c is the upper end of the interval of that quantile at 2c − 1.
    #[test]
    fn a_bound_is_one_end_of_the_interval_of_a_quantile(
        runs in 1..2000u32,
        probability in 0.01..0.999f64,
        level in 0.51..0.999f64,
    ) {
        let sample = SortedSample::new(&(1..=runs).map(f64::from).collect::<Vec<_>>()).unwrap();
        let (rule, n) = (rule(probability, level), u64::from(runs));
        let confidence = Confidence::new(2.0 * level - 1.0).unwrap();
        let interval = |p| sample.quantile_interval(p, confidence).unwrap();
        let above = rule.tolerance(ToleranceSide::AtMost, n, 0).bounds(&sample);
        let upper = interval(probability).upper();
        prop_assert_eq!(above.map_or(f64::INFINITY, |bounds| bounds.1), upper);
        let below = rule.tolerance(ToleranceSide::AtLeast, n, 0).bounds(&sample);
        let lower = interval(rule.failure_share()).lower();
        prop_assert_eq!(below.map_or(f64::NEG_INFINITY, |bounds| bounds.0), lower);
    }
}

/// Looked at after each 50 runs, the bounds of all looks hold together with the confidence; those of one look do not.
#[test]
fn bounds_of_all_looks_hold_together() {
    let confidence = Confidence::new(0.9).unwrap();
    let once = Acceptance::new(0.95, confidence).unwrap();
    let often = SequentialAcceptance::new(once);
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let campaigns = 1000;
    let mut broken = [0, 0];
    for _ in 0..campaigns {
        // Of a uniform law, the bound of the share 0.95 is 0.95.
        let mut values: Vec<f64> = Vec::new();
        let mut ever = [false, false];
        for _ in 0..40 {
            values.extend((0..50).map(|_| rng.random::<f64>()));
            values.sort_by(f64::total_cmp);
            let n = values.len() as u64;
            let side = ToleranceSide::AtMost;
            let tolerances = [once.tolerance(side, n, 0), often.tolerance(side, n, 0)];
            for (ever, tolerance) in ever.iter_mut().zip(tolerances) {
                if let Tolerance::Ranks { upper: Some(rank), .. } = tolerance {
                    *ever |= values[rank as usize - 1] < 0.95;
                }
            }
        }
        broken.iter_mut().zip(ever).for_each(|(count, ever)| *count += i32::from(ever));
    }
    assert!(broken[0] > 250, "one look at a time: {broken:?}");
    assert!((10..=100).contains(&broken[1]), "{broken:?}");
}
