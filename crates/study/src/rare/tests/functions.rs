//! Rare events of functions of which it is known how often they happen, and where runs fail.

use gyradius_campaign::{RunInputs, SimulatorFunction};
use gyradius_statistics::tail;
use serde_json::Value;
use std::path::Path;

use crate::{AnyScenario, Rare, RareFailures, RareMethod, RareOptions, RareWarning};

/// Ten normal inputs, and a uniform one by which runs can fail at random.
const INPUTS: usize = 10;
const METHODS: [RareMethod; 2] =
    [RareMethod::Subset { replicas: 10 }, RareMethod::Importance { sample: 3000 }];

/// What a run answers with, of its ten inputs and of the uniform one.
type Model = fn(&[f64], f64) -> Result<f64, ()>;

/// The sum of the inputs, which is standard normal.
fn sum(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / (INPUTS as f64).sqrt()
}

fn find(model: Model, event: &str, method: RareMethod, seed: u64) -> Rare {
    let options = RareOptions { method, per_level: 300, ..RareOptions::default() };
    let event = event.parse().unwrap();
    scenario(model, seed).rare(&event, &options, &|_| {}, &|_| {}).unwrap()
}

fn scenario(model: Model, seed: u64) -> AnyScenario {
    let input = |i| {
        format!(
            "[[quantities]]\nname = \"x{i}\"\nlaw = {{ law = \"normal\", mean = 0.0, sigma = 1.0 }}\n"
        )
    };
    let inputs: String = (0..INPUTS).map(input).collect();
    let text = format!(
        "name = \"failing\"\nruns = 100\nseed = {seed}\n[simulation]\nfunction = \"a model\"\noutputs = [{{ name = \"y\" }}]\n\
         {inputs}[[quantities]]\nname = \"u\"\nlaw = {{ law = \"uniform\", low = 0.0, high = 1.0 }}\n"
    );
    let function = SimulatorFunction::new(move |run: &RunInputs<'_>| {
        let x: Vec<f64> = (0..INPUTS).filter_map(|i| run.input(&format!("x{i}"))).collect();
        let u = run.input("u").ok_or("no u")?;
        let y = model(&x, u).map_err(|()| "diverged".to_owned())?;
        Ok(vec![("y".to_owned(), y)])
    });
    let scenario = AnyScenario::from_toml(&text, Path::new(".")).unwrap();
    scenario.with_function(function).unwrap()
}

fn failures(found: &Rare) -> Option<RareFailures> {
    found.warnings().iter().find_map(|warning| match warning {
        RareWarning::FailedRuns(failures) => Some(*failures),
        RareWarning::Subset(_) | RareWarning::Importance(_) => None,
    })
}

/// Where every run beyond some value fails, and the event lies behind it, no cause is named that is none, and no advice that does not
/// help; the share of these runs is told.
#[test]
fn what_lies_behind_failures_is_told() {
    let alone: Model = |x, _| if x[0] > 2.0 { Err(()) } else { Ok(x[0]) };
    let together: Model = |x, _| if sum(x) > 3.5 { Err(()) } else { Ok(sum(x)) };
    for (model, limit, event) in [(alone, 2.0, "y >= 3.2"), (together, 3.5, "y >= 4.5")] {
        for method in METHODS {
            for seed in 0..4 {
                let found = find(model, event, method, seed);
                let said = found.to_string();
                let failures = failures(&found).unwrap_or_else(|| panic!("{method:?}\n{said}"));
                println!("{event} {method:?}: {failures:?}");
                // The interval is of 95 %; this one is as wide as none in ten thousand.
                let truth = tail::normal(limit);
                let interval = failures.interval;
                assert!(interval.lower() / 2.0 < truth && truth < 2.0 * interval.upper(), "{said}");
                assert!(said.contains("if failed runs are not the event\n"), "{said}");
                assert!(
                    said.contains("failed and have no y, as where a simulation breaks down"),
                    "{said}"
                );
                for advice in ["take --method", "more runs of a level", "it cannot be", "--least"] {
                    assert!(!said.contains(advice), "{advice}: {said}");
                }
                let json = serde_json::to_value(&found).unwrap();
                let told = &json["warnings"][0]["failed_runs"];
                assert_eq!(told["share"].as_f64(), Some(failures.share), "{json}");
                assert_eq!(told["interval"]["upper"].as_f64(), Some(interval.upper()), "{json}");
            }
        }
    }
}

/// Failures that change nothing are not told of: at random and rarely beside an event that is not so rare, none at all, and far beyond the
/// event. A run whose number is infinite has a number.
#[test]
fn failures_that_change_nothing_are_no_warning() {
    let at_random: Model = |x, u| if u < 1e-3 { Err(()) } else { Ok(sum(x)) };
    let never: Model = |x, _| Ok(sum(x));
    let far: Model = |x, _| if sum(x) > 5.5 { Err(()) } else { Ok(sum(x)) };
    let infinite: Model = |x, _| Ok(if sum(x) > 3.0 { f64::INFINITY } else { sum(x) });
    for (model, event) in
        [(at_random, "y >= 2"), (never, "y >= 4.5"), (far, "y >= 4.5"), (infinite, "y >= 3.2")]
    {
        for method in METHODS {
            for seed in 0..4 {
                let found = find(model, event, method, seed);
                assert_eq!(failures(&found), None, "{event}: {found}");
                assert!(!found.to_string().contains("if failed runs"), "{found}");
            }
        }
    }
}

/// Of two ways to an event one fails, from below the event's limit on: the search turns away from it, the sample hardly sees it, and the
/// share of these runs is told all the same. Where the failures lie far beyond the limit, they are too few to matter, and none is told.
#[test]
fn a_way_that_fails_is_told_beside_one_that_does_not() {
    fn two_ways(x: &[f64], from: f64) -> Result<f64, ()> {
        if x[0] > from { Err(()) } else { Ok(x[0].max(x[1])) }
    }
    fn two_sides(x: &[f64], from: f64) -> Result<f64, ()> {
        if x[0] > from { Err(()) } else { Ok(x[0].abs()) }
    }
    let models: [(Model, f64); 6] = [
        (|x, _| two_ways(x, 4.0), 4.0),
        (|x, _| two_ways(x, 3.5), 3.5),
        (|x, _| two_ways(x, 5.5), 5.5),
        (|x, _| two_sides(x, 4.2), 4.2),
        (|x, _| two_sides(x, 3.5), 3.5),
        (|x, _| two_sides(x, 5.5), 5.5),
    ];
    for (model, from) in models {
        for seed in 0..6 {
            let found = find(model, "y >= 4.2", RareMethod::Importance { sample: 3000 }, seed);
            let told = failures(&found);
            assert_eq!(told.is_some(), from < 5.0, "{from} {seed}: {found}");
            let truth = tail::normal(from);
            let holds = |failures: RareFailures| {
                let interval = failures.interval;
                interval.lower() / 2.0 < truth && truth < 2.0 * interval.upper()
            };
            assert!(told.is_none_or(holds), "{from} {seed}: {found}");
        }
    }
}

/// Failures at random that are far more frequent than the event are told of by their share, and not as if they were near the event.
#[test]
fn failures_at_random_are_not_said_to_be_near_the_event() {
    let model: Model = |x, u| if u < 0.01 { Err(()) } else { Ok(sum(x)) };
    for method in METHODS {
        for seed in 0..4 {
            let found = find(model, "y >= 4.5", method, seed);
            let failures = failures(&found).unwrap_or_else(|| panic!("{method:?}: {found}"));
            println!("{method:?}: {failures:?}");
            assert_eq!(failures.nearer, None, "{found}");
            assert!(0.5e-2 < failures.share && failures.share < 2e-2, "{found}");
            let p = found.estimate().probability() / tail::normal(4.5);
            assert!(0.2 < p && p < 5.0, "{found}");
        }
    }
}

/// Where one input decides alone, chains hardly move: the interval is said to be too narrow, but not where it is as wide as can be, as that
/// of two repetitions.
#[test]
fn the_widest_interval_is_not_said_to_be_too_narrow() {
    let alone: Model = |x, _| Ok(x[0]);
    let mut said = [false; 2];
    for seed in 0..12 {
        for replicas in [2, 10] {
            let found = find(alone, "y >= 3.2", RareMethod::Subset { replicas }, seed);
            let words = found.warnings_in_words().join("\n");
            if words.contains("of the redrawn runs stayed") {
                let narrow = words.contains("the interval may be too narrow");
                assert_eq!(narrow, found.estimate().interval().upper() < 0.1, "{found}");
                said[usize::from(narrow)] = true;
            }
        }
    }
    assert_eq!(said, [true; 2], "both occur");
}

/// Every key that is written stands on the page of rare events.
#[test]
fn the_page_names_every_key() {
    let page = include_str!("../../../../../docs/rare-events.md");
    let model: Model = |x, u| if u < 0.01 { Err(()) } else { Ok(x[0].max(x[1])) };
    for method in METHODS {
        let found = serde_json::to_value(find(model, "y >= 3.5", method, 1)).unwrap();
        let object = |value: &Value| value.as_object().unwrap().keys().cloned().collect();
        let mut keys: Vec<String> = object(&found);
        keys.extend(object(&found["interval"]));
        let failures = &found["warnings"][0]["failed_runs"];
        keys.extend(object(failures));
        keys.push("failed_runs".to_owned());
        if found["method"] == "importance" {
            keys.extend(object(&found["weighted"]));
        }
        for key in keys {
            assert!(page.contains(&format!("`{key}`")), "{key}");
        }
    }
}
