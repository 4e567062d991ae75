//! Rules against what they are written as, looks against their rise, and evidence against counting.

use proptest::prelude::*;

use gyradius_statistics::ConfidenceSequence;

use super::*;
use crate::{Bound, Cell, Column, FailedRuns, Failure, Requirement, Table};

fn rules() -> impl Strategy<Value = StoppingRule> {
    let name = "[a-z][a-z_]{0,8}|[ -~]{1,6}";
    prop_oneof![
        Just(StoppingRule::Decided),
        (1e-9..0.4999).prop_map(StoppingRule::Share),
        (name, -300..300_i32, 1.0..10.0).prop_map(|(name, exponent, x): (String, i32, f64)| {
            StoppingRule::Mean(Measured::column(&name), x * 10_f64.powi(exponent))
        }),
    ]
}

proptest! {
    /// What is written reads back, as a line and in a table.
    #[test]
    fn rules_read_back(
        rule in rules(),
        look_every in 1..u64::MAX >> 1,
        most_runs in 1..u64::MAX >> 1,
        first_look in prop::option::of(1..u64::MAX >> 1),
    ) {
        prop_assert_eq!(rule.to_string().parse::<StoppingRule>().unwrap(), rule.clone());
        let until = Until::new(rule, look_every, most_runs).unwrap();
        let until = until.with_first_look(first_look).unwrap();
        let text = serde_json::to_string(&until).unwrap();
        prop_assert_eq!(serde_json::from_str::<Until>(&text).unwrap(), until);
    }

    /// Any text is read or refused.
    #[test]
    fn any_text_is_read_or_refused(text in ".{0,40}|(decided|share|mean)[ ()%.0-9a-z]{0,20}") {
        if let Ok(rule) = text.parse::<StoppingRule>() {
            prop_assert_eq!(rule.to_string().parse::<StoppingRule>().unwrap(), rule);
        }
    }

    /// Looks rise by a tenth, or by a whole look, to the greatest number, and any look follows from the one before alone.
    #[test]
    fn looks_rise_to_the_end(look_every in 1..5000_u64, most_runs in 1..2_000_000_u64, there in 0..3_000_000_u64) {
        let until = Until::new(StoppingRule::Decided, look_every, most_runs).unwrap();
        let looks: Vec<u64> = until.looks().collect();
        prop_assert_eq!(looks[0], look_every.min(most_runs));
        prop_assert_eq!(*looks.last().unwrap(), most_runs);
        for pair in looks.windows(2) {
            let more = pair[1] - pair[0];
            prop_assert!(more > 0 && more <= look_every.max(pair[0] / 10));
            prop_assert!(pair[1] == most_runs || more % look_every == 0);
        }
        // Later, if there were runs before, and after the greatest number at the latest, whichever is said first.
        let late = until.clone().with_first_look(Some(there));
        prop_assert_eq!(late.is_ok(), there > 0);
        if let Ok(late) = late {
            let fewer = Until::new(StoppingRule::Decided, look_every, 3_000_000).unwrap();
            let fewer = fewer.with_first_look(Some(there)).unwrap().with_most_runs(most_runs);
            prop_assert_eq!(&fewer, &late);
            let looks: Vec<u64> = late.looks().collect();
            prop_assert_eq!(late.first_look(), Some(looks[0]));
            prop_assert_eq!(looks[0], there.min(most_runs));
            prop_assert_eq!(*looks.last().unwrap(), most_runs);
        }
    }
}

#[test]
fn other_rules_are_refused() {
    for text in [
        "",
        "decide",
        "decided now",
        "share",
        "share within",
        "share within 0 %",
        "share within 50 %",
        "share within -0.1",
        "mean(x)",
        "mean within 1",
        "mean(x) within 0",
        "mean(x) within -1",
        "mean(x within 1",
        "mean(x) within 1 %",
        "mean() within 1",
        "mean(x) within nan",
    ] {
        let refused = text.parse::<StoppingRule>().unwrap_err();
        assert!(refused.to_string().contains("within 0.02"), "{text}: {refused}");
    }
    assert!(Until::new(StoppingRule::Decided, 0, 1).is_err());
    assert!(Until::new(StoppingRule::Decided, 1, 0).is_err());
    for none in ["look_every", "most_runs", "first_look"] {
        let table = r#"{"rule": "decided", "first_look": 5, "look_every": 5, "most_runs": 5}"#;
        let table = table.replace(&format!("\"{none}\": 5"), &format!("\"{none}\": 0"));
        let refused = serde_json::from_str::<Until>(&table).unwrap_err().to_string();
        assert!(refused.contains(&format!("{none} = 0")), "{refused}");
    }
}

/// A table of numbers, none of which is a failed run.
fn table(first: u64, numbers: &[Option<f64>]) -> Table {
    let mut table = Table::new("a", first, vec![Column::number("x", "1", "a number")]).unwrap();
    for x in numbers {
        let failure = x.is_none().then(|| Failure::new("failed", "failed"));
        table.push(failure, [x.map_or(Cell::Null, Cell::Number)]).unwrap();
    }
    table
}

proptest! {
    /// In blocks of any size, the evidence is enough after the same runs as by counting and by the sums over all.
    #[test]
    fn evidence_is_counted(
        numbers in prop::collection::vec(prop::option::weighted(0.95, -1.0..1.0_f64), 100..700),
        sizes in prop::collection::vec(1..90_usize, 700),
        group in 1..4_u64,
        limit in 0.0..1.0_f64,
        left_out: bool,
        within in 0.01..0.2_f64,
    ) {
        let requirement = Requirement::new("r", Measured::column("x"), Bound::AtMost(limit), 0.9, 0.9).unwrap();
        let failed_runs = if left_out { FailedRuns::LeftOut } else { FailedRuns::Against };
        let requirement = requirement.with_failed_runs(failed_runs);
        let mean = StoppingRule::Mean(Measured::column("x"), within);
        for rule in [StoppingRule::Decided, StoppingRule::Share(within), mean] {
            let mut evidence = Evidence::new(rule.clone(), vec![vec![requirement.clone()]], group);
            let (mut first, mut sizes) = (0, sizes.iter());
            while first < numbers.len() {
                let end = (first + sizes.next().unwrap()).min(numbers.len());
                let block = table(first as u64, &numbers[first..end]);
                let middle = (first + (end - first) / 2) as u64;
                evidence.look(0, &block, 0..middle);
                evidence.look(0, &block, middle..u64::MAX);
                first = end;
                let judged = numbers[..end].iter().step_by(group as usize);
                let there: Vec<f64> = judged.clone().flatten().copied().collect();
                let beyond = there.iter().filter(|x| **x > limit).count() as u64;
                let without = judged.count() as u64 - there.len() as u64;
                let (failures, counted) = match failed_runs {
                    FailedRuns::Against => (beyond + without, there.len() as u64 + without),
                    FailedRuns::LeftOut => (beyond, there.len() as u64),
                };
                let sequential = requirement.sequential().unwrap();
                let expected = match &rule {
                    StoppingRule::Decided => {
                        sequential.allowed_failures(counted).is_some_and(|allowed| failures <= allowed)
                            || sequential.refused_failures(counted).is_some_and(|refused| failures >= refused)
                    }
                    StoppingRule::Share(within) => {
                        let sequence = ConfidenceSequence::new(requirement.confidence());
                        sequence.interval(failures, counted).unwrap().width() <= 2.0 * within
                    }
                    StoppingRule::Mean(_, within) => {
                        let rule = FixedWidth::new(*within, Confidence::default()).unwrap();
                        let n = there.len() as f64;
                        let mean = there.iter().sum::<f64>() / n;
                        let squares = there.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
                        let most = there.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                        let least = there.iter().copied().fold(f64::INFINITY, f64::min);
                        there.len() > 1
                            && rule.is_reached(there.len() as u64, squares / (n - 1.0), most - least)
                    }
                };
                prop_assert_eq!(evidence.is_enough().unwrap(), expected, "{} after {}", rule, end);
            }
        }
    }
}

/// With several models, the last of them decides when it is enough.
#[test]
fn all_models_must_be_decided() {
    let requirement: Requirement = "x <= 0.5 in 90 % at 90 %".parse().unwrap();
    let own = vec![vec![requirement.clone()], vec![requirement]];
    let mut evidence = Evidence::new(StoppingRule::Decided, own, 1);
    let good = table(0, &[Some(0.1); 400]);
    assert!(!evidence.is_enough().unwrap());
    evidence.look(0, &good, 0..400);
    assert!(!evidence.is_enough().unwrap());
    evidence.look(1, &good, 0..400);
    assert!(evidence.is_enough().unwrap());
}
