//! Studies that a rule ends in folders that hold runs already: however often they are interrupted, they end where they would have ended.

use gyradius_campaign::{RunInputs, SimulatorFunction};
use proptest::prelude::*;
use std::{fs, path::Path};

use super::{
    SimulatorScenario, files, folder,
    interrupted::{interrupted, waiting},
};
use crate::{AnyScenario, Ended, Options, Rows, put_together};

const FLIGHTS: u64 = 7;

/// How the runs came about that are in the folder before the rule is asked.
#[derive(Clone, Copy, Debug)]
enum Before {
    Nothing,
    Study,
    Interrupted,
    Shard,
}

/// Answers. The mean is known soon, and from run 400 on it is not any more.
fn answer() -> SimulatorFunction {
    SimulatorFunction::new(|run: &RunInputs<'_>| {
        let x = run.input("x").ok_or("no x")?;
        Ok(vec![("y".to_owned(), if run.run() < 400 { x } else { 4.0 * x })])
    })
}

fn ended(out: &Path) -> Ended {
    let summary = fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    serde_json::from_value(summary["ended"].clone()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn a_rule_ends_the_same_runs_however_often_it_is_interrupted(
        before in prop::sample::select(vec![Before::Nothing, Before::Study, Before::Interrupted, Before::Shard]),
        there in 1_u64..2000,
        models: bool,
        vehicles: bool,
        rows in prop::sample::select(Rows::ALL.to_vec()),
        within in prop::sample::select(vec![0.05, 0.06, 0.08]),
        stops in prop::collection::vec((1_u64..1500, any::<bool>()), 0..4),
    ) {
        let folder = folder();
        let flights = vehicles.then_some(FLIGHTS);
        let waiting = |runs: u64, keys: &str| waiting(folder.path(), models, (runs, flights), [keys, ""]);
        let interrupted = |scenario: &SimulatorScenario, out: &Path, after: u64| interrupted(scenario, answer(), out, after);
        let rule = format!("mean(y) within {within}").parse().unwrap();
        let asked = waiting(3500, &format!("rows = \"{}\"", rows.name())).with_until(Some(rule), None).unwrap();
        let prepare = |out: &Path| match before {
            Before::Nothing => {}
            Before::Study => assert!(!interrupted(&waiting(there, ""), out, u64::MAX)),
            Before::Interrupted => drop(interrupted(&waiting(3500, ""), out, there)),
            Before::Shard => {
                let shared = waiting(there, "").with_function(answer());
                let any = AnyScenario::Simulator(Box::new(shared.unwrap()));
                any.run_shard(&Options::to(out), "2/2".parse().unwrap(), &|_| {}, &|_| {}).unwrap();
            }
        };
        let [whole, cut] = ["whole", "cut"].map(|name| folder.path().join(name));
        prepare(&whole);
        interrupted(&asked, &whole, u64::MAX);
        let (all, end) = (files(&whole), ended(&whole));
        let first = end.until.first_look();
        // Runs that are there may be enough, but are not dropped.
        prop_assert!(first.is_none_or(|first| first <= there.next_multiple_of(FLIGHTS).max(256)), "{end}");
        // Nothing is made again of what is finished, also if it was not interrupted.
        interrupted(&asked, &whole, u64::MAX);
        prop_assert_eq!(&files(&whole), &all);

        prepare(&cut);
        for (after, report) in stops {
            let is_stopped = interrupted(&asked, &cut, after);
            if report && is_stopped && put_together(&cut, &Options::default(), &|_| {}).is_ok() {
                let so_far = ended(&cut);
                // What is missing among the first of the runs that are there is done before the rule is asked about all of them.
                if !matches!(before, Before::Shard) && so_far.runs > there.next_multiple_of(FLIGHTS) {
                    let looks: Vec<u64> = end.looks().into_iter().filter(|look| *look <= so_far.runs).collect();
                    prop_assert_eq!(so_far.looks(), looks);
                }
            }
        }
        interrupted(&asked, &cut, u64::MAX);
        prop_assert_eq!(ended(&cut), end);
        prop_assert_eq!(files(&cut), all);
    }
}
