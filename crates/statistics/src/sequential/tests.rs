//! The risk summed over all paths, and the evidence by its definition.

use proptest::prelude::*;

use super::*;
use crate::binomial_sums::{masses, one_more};
use crate::{Confidence, Verdict};

fn rule(probability: f64, level: f64) -> SequentialAcceptance {
    let confidence = Confidence::new(level).unwrap();
    SequentialAcceptance::new(Acceptance::new(probability, confidence).unwrap())
}

/// The probabilities that it is met, and that it is not, when every run is looked at up to so many.
fn decided(rule: &SequentialAcceptance, share: f64, runs: u64) -> [f64; 2] {
    let (mut open, mut ends) = (vec![1.0], [0.0; 2]);
    for run in 1..=runs {
        one_more(&mut open, share, 1.0 - share);
        let (allowed, refused) = (rule.allowed_failures(run), rule.refused_failures(run));
        for (failures, mass) in (0..).zip(&mut open) {
            if allowed.is_some_and(|allowed| failures <= allowed) {
                ends[0] += std::mem::take(mass);
            } else if refused.is_some_and(|refused| refused <= failures) {
                ends[1] += std::mem::take(mass);
            }
        }
    }
    ends
}

/// References: mpmath 1.3 with 50 digits, of the floats.
#[test]
fn evidence_has_its_digits_up_to_a_billion_runs() {
    for (probability, failures, runs, below, above) in [
        (0.9973, 0_u64, 1068_u64, 2.30309988450555, -1.60668812156035),
        (0.9973, 7, 1000, -2.61003934840717, 1.71939224730706),
        (0.9973, 2_692_729, 1_000_000_000, 2.30520247115766, -9.2117971906246),
        (0.9973, 2_706_990, 1_000_000_000, -9.93887777060913, 2.30499453638682),
        (0.95, 60, 1000, -3.60889811886515, -0.543814473975159),
        (0.5, 499_921_907, 1_000_000_000, 2.30275586423053, -12.447844093927),
        (0.999999, 894, 1_000_000_000, 2.30809380063983, -5.00974171120604),
        (0.999999999, 5, 1_000_000_000, -2.48999575926073, 2.9473745004366),
        (0.01, 980, 1000, 2.89884210538934, -3.42135324496422),
    ] {
        let mixture = Mixture::about(1.0 - probability);
        let (failures, runs) = (failures as f64, runs as f64);
        let found = [mixture.below(failures, runs), mixture.above(failures, runs)];
        let off = [found[0] - below, found[1] - above];
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{probability} {failures}: {off:?}");
    }
}

/// The integral over the shares below the limit, by the midpoint rule after u = ε v², which takes the root away.
#[test]
fn evidence_is_its_integral() {
    for (probability, failures, runs) in [(0.9, 2, 60), (0.9973, 0, 1000), (0.6, 30, 100)] {
        let (limit, mixture) = (1.0_f64 - probability, Mixture::about(1.0 - probability));
        let b = 0.5 * probability / limit;
        let (mut with, mut without) = (0.0_f64, 0.0);
        for i in 0..200_000 {
            let v = (f64::from(i) + 0.5) / 200_000.0;
            let u = limit * v * v;
            let weight = (1.0 - u).powf(b - 1.0);
            let odds = (u / limit).powi(failures) * ((1.0 - u) / probability).powi(runs - failures);
            with += weight * odds;
            without += weight;
        }
        let found = mixture.below(f64::from(failures), f64::from(runs));
        assert!((found - (with / without).ln()).abs() < 1e-7, "{probability}: {found}");
    }
}

#[test]
fn an_interval_beyond_the_limit_is_a_verdict() {
    for (probability, level) in [(0.9973, 0.9), (0.9, 0.5), (0.3, 0.99)] {
        let rule = rule(probability, level);
        for runs in [0, 1, 10, 100, 1000, 20_000] {
            for failures in (0..=runs).step_by((runs / 500 + 1) as usize) {
                let interval = rule.interval(failures, runs).unwrap();
                let verdict = rule.verdict(failures, runs).unwrap();
                let limit = 1.0 - probability;
                assert!(interval.upper() >= limit || verdict == Verdict::Met);
                assert!(interval.lower() <= limit || verdict == Verdict::NotMet);
            }
        }
    }
}

#[test]
fn looking_costs_runs() {
    let rule = rule(0.9973, 0.9);
    assert_eq!(rule.least_runs(0), Some(1068));
    for failures in 0..100 {
        assert!(rule.least_runs(failures) > rule.requirement().least_runs(failures));
    }
    assert_eq!(rule.least_runs(u64::MAX), None);
    let refused = StatisticsError::Failures { failures: 2, runs: 1 };
    assert_eq!(rule.verdict(2, 1), Err(refused.clone()));
    assert_eq!(rule.interval(2, 1), Err(refused));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Of all paths of so many runs, at the limit and beyond it, where the verdict is wrong.
    #[test]
    fn the_risk_is_kept_under_looks_at_every_run(
        probability in 0.05..0.99f64,
        level in 0.5..0.99f64,
        beyond in 0.0..1.0f64,
        runs in 50..400u64,
    ) {
        let rule = rule(probability, level);
        let (limit, risk) = (1.0 - probability, 1.0 - level + 1e-9);
        let at_limit = decided(&rule, limit, runs);
        prop_assert!(at_limit[0] <= risk && at_limit[1] <= risk, "{at_limit:?}");
        let worse = decided(&rule, limit + beyond * probability, runs)[0];
        prop_assert!(worse <= at_limit[0] + 1e-12, "{worse} met though worse");
        let better = decided(&rule, limit * beyond, runs)[1];
        prop_assert!(better <= at_limit[1] + 1e-12, "{better} not met though better");
    }

    /// The mean of the evidence is 1 at the limit after any number of runs, and at most 1 where there is none.
    #[test]
    fn evidence_is_a_martingale(
        probability in 0.05..0.95f64,
        beyond in 0.0..1.0f64,
        runs in 1..100u64,
    ) {
        let mixture = Mixture::about(1.0 - probability);
        let mean = |share: f64, evidence: &dyn Fn(f64, f64) -> f64| -> f64 {
            let masses = masses(runs, share, 1.0 - share);
            (0..).zip(&masses).map(|(k, mass)| mass * evidence(f64::from(k), runs as f64).exp()).sum()
        };
        let limit = 1.0 - probability;
        let (below, above) = (|k, n| mixture.below(k, n), |k, n| mixture.above(k, n));
        prop_assert!((mean(limit, &below) - 1.0).abs() < 1e-9);
        prop_assert!((mean(limit, &above) - 1.0).abs() < 1e-9);
        let other = 0.001 + 0.998 * beyond;
        let against = |k, n| mixture.against([other, 1.0 - other], k, n);
        prop_assert!((mean(other, &against) - 1.0).abs() < 1e-9);
        prop_assert!(other < limit || mean(other, &below) <= 1.0 + 1e-9);
        prop_assert!(other > limit || mean(other, &above) <= 1.0 + 1e-9);
    }

    #[test]
    fn any_question_has_an_answer(
        exponent in -9.0..0.0f64,
        good in any::<bool>(),
        level in prop_oneof![0.5..1.0f64, Just(0.5), Just(1.0 - f64::EPSILON)],
        runs in 0..=1_000_000_000u64,
        share in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0f64],
    ) {
        let small = 10f64.powf(exponent);
        let rule = rule(if good { 1.0 - small } else { small }, level);
        let limit = rule.requirement().failure_share();
        for share in [share, limit * share, limit] {
            let failures = (share * runs as f64) as u64;
            let verdict = rule.verdict(failures, runs).unwrap();
            let allowed = rule.allowed_failures(runs).is_some_and(|allowed| failures <= allowed);
            let refused = rule.refused_failures(runs).is_some_and(|refused| refused <= failures);
            prop_assert_eq!((verdict == Verdict::Met, verdict == Verdict::NotMet), (allowed, refused));
            prop_assert!(!(allowed && refused));
            let interval = rule.interval(failures, runs).unwrap();
            let seen = if runs == 0 { 0.5 } else { failures as f64 / runs as f64 };
            prop_assert!(interval.contains(seen), "{interval} {seen}");
            prop_assert!(interval.lower() >= 0.0 && interval.upper() <= 1.0);
        }
    }
}
