//! Known numbers of runs, and the definitions by sums.

use proptest::prelude::*;

use super::*;
use crate::Verdict;
use crate::binomial_sums::masses;

fn rule(probability: f64, level: f64) -> Acceptance {
    Acceptance::new(probability, Confidence::new(level).unwrap()).unwrap()
}

#[test]
fn known_numbers_of_runs() {
    for (probability, level, runs) in [
        (0.9973, 0.9, [852, 1440, 1970, 2473]),
        (0.9973, 0.95, [1109, 1756, 2330, 2870]),
        (0.99865, 0.9, [1705, 2880, 3941, 4947]),
        (0.99, 0.9, [230, 388, 531, 667]),
        (0.95, 0.95, [59, 93, 124, 153]),
    ] {
        let rule = rule(probability, level);
        for (failures, runs) in (0..).zip(runs) {
            assert_eq!(rule.least_runs(failures), Some(runs), "{probability} {level}");
            assert_eq!(rule.allowed_failures(runs), Some(failures));
            assert_eq!(rule.allowed_failures(runs - 1), failures.checked_sub(1));
        }
    }
}

/// Beyond 10¹⁵ runs all that is asked of a rule is what it is there.
#[test]
fn more_runs_than_can_be_planned_are_as_many_as_can() {
    let most = 1_000_000_000_000_000;
    for (probability, level) in [(0.9973, 0.9), (0.5, 0.5), (1.0 - 1e-9, 0.999)] {
        let rule = rule(probability, level);
        for runs in [most + 1, 2 * most, 1 << 60, u64::MAX] {
            assert_eq!(rule.allowed_failures(runs), rule.allowed_failures(most));
            assert_eq!(rule.consumers_risk(runs), rule.consumers_risk(most));
            for share in [0.0, 0.3, 0.9, 0.9999, 1.0] {
                assert_eq!(rule.producers_risk(runs, share), rule.producers_risk(most, share));
                assert_eq!(rule.success_to_pass(runs, share), rule.success_to_pass(most, share));
            }
        }
    }
}

#[test]
fn known_risks_of_the_producer() {
    let rule = rule(0.9973, 0.9);
    for (success, risk) in [(0.9985, 0.58), (0.999, 0.32), (0.9995, 0.08)] {
        assert!((rule.producers_risk(2000, success).unwrap() - risk).abs() < 0.005, "{success}");
    }
    assert_eq!(rule.producers_risk(2000, 1.0), Ok(0.0));
    assert_eq!(rule.producers_risk(2000, 0.0), Ok(1.0));
    assert_eq!(rule.producers_risk(851, 1.0), Ok(1.0));
    assert_eq!(rule.success_to_pass(851, 0.5), Ok(None));
    assert_eq!(
        [0.0, 1.0].map(|power| rule.success_to_pass(852, power)),
        [0.0, 1.0].map(|q| Ok(Some(q)))
    );
    assert_eq!((rule.consumers_risk(0), rule.consumers_risk(851)), (0.0, 0.0));
}

/// Tails summed with 50 digits by mpmath 1.3: at the limits the one is at most 1 − c, and more with one failure more.
#[test]
fn a_billion_runs() {
    let n = 1_000_000_000;
    for (probability, level, failures, tail) in [
        (0.9973, 0.9, 2_697_896, 0.09993078435993133),
        (0.5, 0.9, 499_979_736, 0.09999566493331322),
        (0.999999, 0.9, 959, 0.09953426660444101),
        (0.999999999, 0.5, 0, 0.36787944117144),
    ] {
        let rule = rule(probability, level);
        assert_eq!(rule.allowed_failures(n), Some(failures));
        let found = rule.consumers_risk(n);
        // 1 − p is a float that stands for the decimal to a part in 10⁷ at most.
        let allowed = if probability > 0.99999 { 1e-7 } else { 1e-11 };
        assert!((found / tail - 1.0).abs() < allowed, "{probability}: {found}");
    }
    // ln(0.1)/ln(1 − 1e-9) is 2,302,585,091.84, of the float that is nearest to 1 − 1e-9 one part in 10⁷ of that else.
    let least = rule(1.0 - 1e-9, 0.9).least_runs(0).unwrap();
    assert!(least.abs_diff(2_302_585_092) < 300, "{least}");
}

#[test]
fn decimals_that_tie_count_as_reached() {
    // pⁿ is 1 − c exactly.
    for (probability, level, runs) in [
        (0.1, 0.9, 1),
        (0.3, 0.7, 1),
        (0.5, 0.75, 2),
        (0.1, 0.99, 2),
        (0.2, 0.992, 3),
        (0.5, 0.5, 1),
    ] {
        assert_eq!(rule(probability, level).least_runs(0), Some(runs), "{probability} {level}");
    }
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let confidence = Confidence::new(0.9).unwrap();
    for probability in [0.0, 1.0, 9e-10, 1.0 - 9e-10, 99.73, -0.5, f64::NAN, f64::INFINITY] {
        let refused = Acceptance::new(probability, confidence).unwrap_err().to_string();
        assert!(refused.contains("between 1e-9 and 1 - 1e-9"), "{refused}");
    }
    let low = Acceptance::new(0.9, Confidence::new(0.49).unwrap());
    assert_eq!(low, Err(StatisticsError::DecidingConfidence { value: 0.49 }));
    let rule = rule(0.9973, 0.9);
    for (failures, runs) in [(1, 0), (3, 2), (0, 1_000_000_001), (u64::MAX, u64::MAX)] {
        assert_eq!(rule.verdict(failures, runs), Err(StatisticsError::Failures { failures, runs }));
    }
    for value in [-0.1, 1.1, f64::INFINITY] {
        let refused = StatisticsError::Probability { value };
        assert_eq!(rule.producers_risk(9, value), Err(refused.clone()));
        assert_eq!(rule.success_to_pass(9, value), Err(refused));
    }
    assert_eq!(rule.least_runs(u64::MAX), None);
    assert_eq!(rule.allowed_failures(u64::MAX), rule.allowed_failures(1_000_000_000_000_000));
}

#[test]
fn forecasts_are_the_least_that_do() {
    for (probability, level) in [(0.9973, 0.9), (0.9, 0.8), (0.95, 0.95), (0.6, 0.9), (0.2, 0.99)] {
        let rule = rule(probability, level);
        for runs in [0, 1, 7, 50, 333, 1000] {
            for failures in 0..runs.min(40) {
                let Ok(Verdict::Undecided { if_no_more_fail, at_this_rate }) =
                    rule.verdict(failures, runs)
                else {
                    continue;
                };
                let more = if_no_more_fail.unwrap();
                assert_eq!(rule.verdict(failures, runs + more), Ok(Verdict::Met));
                assert!(rule.verdict(failures, runs + more - 1) != Ok(Verdict::Met));
                let possible = failures as f64 / (runs as f64) < rule.failure_share();
                assert_eq!(at_this_rate.is_some(), possible, "{failures}/{runs}");
                let Some(more) = at_this_rate.filter(|more| *more < 100_000) else { continue };
                let met = |runs_then: u64| {
                    let then = (runs_then * failures).div_ceil(runs);
                    rule.allowed_failures(runs_then).is_some_and(|allowed| then <= allowed)
                };
                assert!(met(runs + more), "{failures}/{runs} {more}");
                // Not the very least, as whole failures come in steps, but near it.
                let least = (0..).find(|&more| met(runs + more)).unwrap();
                assert!(least <= more && more <= least + least / 4 + 2, "{least} {more}");
            }
        }
    }
}

proptest! {
    #[test]
    fn limits_are_those_of_the_definition(
        runs in 1..400u64,
        probability in 0.001..0.999f64,
        level in 0.5..0.9999f64,
    ) {
        let rule = rule(probability, level);
        let (p, q) = (rule.failure_share(), probability);
        let masses = masses(runs, p, q);
        let sum = |part: &[f64]| part.iter().sum::<f64>();
        let (mut allowed, mut refused) = (None, None);
        for failures in 0..=runs {
            let (most, least) = (sum(&masses[..=failures as usize]), sum(&masses[failures as usize..]));
            // Floats cannot tell which.
            let risk = 1.0 - level;
            prop_assume!((most / risk - 1.0).abs() > 1e-9 && (least / risk - 1.0).abs() > 1e-9);
            if most <= risk {
                allowed = Some(failures);
            }
            if least <= risk && refused.is_none() {
                refused = Some(failures);
            }
            let verdict = rule.verdict(failures, runs).unwrap();
            prop_assert_eq!(verdict == Verdict::Met, most <= risk);
            prop_assert_eq!(verdict == Verdict::NotMet, least <= risk);
        }
        prop_assert_eq!(rule.allowed_failures(runs), allowed);
        prop_assert_eq!(rule.refused_failures(runs), refused);
        let passed = allowed.map_or(0.0, |allowed| sum(&masses[..=allowed as usize]));
        prop_assert!((rule.consumers_risk(runs) - passed).abs() <= 1e-11);
        if let Some(allowed) = allowed {
            let least = rule.least_runs(allowed).unwrap();
            prop_assert!(least <= runs && rule.least_runs(allowed + 1).unwrap() > runs);
        }
    }

    #[test]
    fn the_producers_risk_is_a_sum_and_has_an_inverse(
        failures in 0..8u64,
        more in 0..50u64,
        probability in 0.5..0.99f64,
        level in 0.5..0.99f64,
        success in 0.01..0.9999f64,
        power in 0.01..0.999f64,
    ) {
        let rule = rule(probability, level);
        let runs = rule.least_runs(failures).unwrap() + more;
        let allowed = rule.allowed_failures(runs).unwrap() as usize;
        let masses = masses(runs, 1.0 - success, success);
        let passes: f64 = masses[..=allowed].iter().sum();
        let risk = rule.producers_risk(runs, success).unwrap();
        prop_assert!((risk - (1.0 - passes)).abs() < 1e-11, "{risk} {passes}");
        let needed = rule.success_to_pass(runs, power).unwrap().unwrap();
        prop_assert!((rule.producers_risk(runs, needed).unwrap() - (1.0 - power)).abs() < 1e-10);
    }

    #[test]
    fn any_question_has_an_answer(
        ends in (0.0..=1.0f64, -9.0..0.0f64, any::<bool>()),
        level in prop_oneof![0.5..1.0f64, Just(0.5), Just(1.0 - f64::EPSILON)],
        runs in 0..=1_000_000_000u64,
        share in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0f64],
    ) {
        let small = 10f64.powf(ends.1);
        let rule = rule(if ends.2 { small } else { 1.0 - small }, level);
        let near = (ends.0 * 2.0 * rule.failure_share()).min(1.0);
        for failures in [(share * runs as f64) as u64, (near * runs as f64) as u64] {
            let verdict = rule.verdict(failures, runs).unwrap();
            prop_assert_eq!(
                verdict == Verdict::Met,
                rule.allowed_failures(runs).is_some_and(|allowed| failures <= allowed)
            );
            prop_assert_eq!(
                verdict == Verdict::NotMet,
                rule.refused_failures(runs).is_some_and(|refused| refused <= failures)
            );
        }
        for risk in [rule.consumers_risk(runs), rule.producers_risk(runs, share).unwrap()] {
            prop_assert!((0.0..=1.0).contains(&risk));
        }
        prop_assert!(rule.consumers_risk(runs) <= 1.0 - level + 1e-12);
    }
}
