//! Functions in the place of a command: the same study, to the byte; what is refused without them.

use gyradius_campaign::{Event, Outputs, RunInputs, SimulatorFunction};
use proptest::prelude::*;
use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use super::{
    BODY, HEAD, MODELS, SimulatorReplay, SimulatorScenario, files, folder, quantity, scenario,
    uniform,
};
use crate::{
    AnyScenario, CampaignError, Options, RareMethod, RareOptions, ReplayError, Scenario, Shard,
    Status, StudyError, put_together, write_report,
};

pub(super) const COMMAND: &str = "command = [\"sh\", \"answer.sh\"]\ntimeout_s = 60.0\n";
pub(super) const FUNCTION: &str = "function = \"as the script\"\n";

/// Answers as the script does.
pub(super) fn answer() -> SimulatorFunction {
    SimulatorFunction::new(|run: &RunInputs<'_>| {
        let x = run.input("x").ok_or("no x")?;
        if (0.9..1.0).contains(&x) {
            return Err(format!("too large: {x}"));
        }
        Ok(vec![("y".to_owned(), x)])
    })
}

/// What stands in the run tables below a folder, by name.
fn tables(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    files(&folder.join("runs"))
}

/// A summary, without what tells a command from a function.
fn summary(folder: &Path) -> serde_json::Value {
    let text = fs::read_to_string(folder.join("summary.json")).unwrap();
    let mut summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    let summary_of = summary.as_object_mut().unwrap();
    let there = ["command", "function", "fingerprint"].map(|key| summary_of.remove(key).is_some());
    assert!(there[0] != there[1] && there[2]);
    for drivers in
        summary_of.get_mut("drivers").and_then(|d| d.as_array_mut()).into_iter().flatten()
    {
        drivers.as_object_mut().unwrap().remove("identity");
    }
    summary
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Whatever a scenario asks for, on however many threads: a function leaves what a command leaves.
    #[test]
    fn a_function_leaves_what_a_command_does(
        body in any::<bool>(),
        vehicles in any::<bool>(),
        until in any::<bool>(),
        drivers in any::<bool>(),
        declared in any::<bool>(),
        threads in 1_usize..4,
        stopped in 0_u64..700,
    ) {
        let folder = folder();
        let mut text = uniform() + &quantity("z", "{ law = \"normal\", mean = 1.0, sigma = 0.1 }");
        if body {
            text += "\n[[bodies]]\nname = \"hub\"";
            text += &(BODY.replace("DISPERSION", "mass_percent = 1.0") + MODELS);
        }
        text = text.replace("runs = 300", if vehicles { "vehicles = 75\nflights = 8" } else { "runs = 600" });
        text += "\n[[requirements]]\nname = \"near\"\nquantity = \"y\"\nat_most = 0.8\nprobability = 0.5\nconfidence = 0.9\n";
        if until {
            text += "\n[until]\nrule = \"decided\"\n";
        }
        if drivers {
            text = format!("drivers = 100\n{text}");
        }
        let command = scenario(&text, folder.path());
        let mut text = text.replace(COMMAND, FUNCTION);
        if !declared {
            let outputs = "[[simulation.outputs]]\nname = \"y\"\nunit = \"m\"\nmeaning = \"x again.\"\n";
            prop_assert!(text.contains(outputs));
            text = text.replace(outputs, "");
        }
        let waiting = scenario(&text, folder.path());
        let function = waiting.with_function(answer()).unwrap();
        let options = |name: &str| Options { threads: Some(threads), ..Options::to(folder.path().join(name)) };
        command.study(&options("command"), &|_| {}, &|_| {}).unwrap();
        // Stopped on the way, it goes on.
        let stop = Arc::new(AtomicBool::new(false));
        let first = Options { stop: Some(Arc::clone(&stop)), ..options("function") };
        let progress = |done: u64| stop.store(done >= stopped, Ordering::Relaxed);
        let ended = function.study(&first, &progress, &|_| {});
        if let Err(error) = ended {
            prop_assert!(matches!(error, StudyError::Campaign(CampaignError::Stopped)), "{error}");
            function.study(&options("function"), &|_| {}, &|_| {}).unwrap();
        }
        let [own, other] = ["function", "command"].map(|name| folder.path().join(name));
        prop_assert_eq!(tables(&own), tables(&other));
        if declared {
            prop_assert_eq!(summary(&own), summary(&other));
        }
        // The page tells how to do its runs again, which no command does with a function.
        let page = fs::read_to_string(own.join("report.md")).unwrap();
        prop_assert!(page.contains("study.replay(") && page.contains("in the program that has the function"));
        prop_assert!(!page.contains("gyradius replay") && !page.contains("gyradius study --scenario"));
        let page = fs::read_to_string(other.join("report.md")).unwrap();
        prop_assert!(page.contains("gyradius replay . --model=") && page.contains("gyradius study --scenario"));
        // A run again is its row.
        let mut again = SimulatorReplay::new(&function, None, 17).unwrap();
        again.hold_against(&own).unwrap();
        // Reports need the folder alone.
        let page = fs::read(own.join("report.html")).unwrap();
        write_report(&own, None, false).unwrap();
        prop_assert_eq!(fs::read(own.join("report.html")).unwrap(), page);
    }
}

/// Answers as the script does but for a bit.
fn other_answer() -> SimulatorFunction {
    SimulatorFunction::new(|run: &RunInputs<'_>| {
        let x = run.input("x").ok_or("no x")?;
        if x >= 0.9 {
            return Err(format!("too large: {x}"));
        }
        Ok(vec![("y".to_owned(), x.next_up())])
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Whether a study was finished, stopped or done in shards, another function of the same name goes on with none of it, and
    /// nothing is touched.
    #[test]
    fn another_function_does_not_go_on(
        vehicles in any::<bool>(),
        until in any::<bool>(),
        in_shards in any::<bool>(),
        threads in 1_usize..4,
        stopped in 256_u64..900,
        force in any::<bool>(),
    ) {
        let folder = folder();
        let mut text = uniform().replace(COMMAND, FUNCTION);
        text = text.replace("runs = 300", if vehicles { "vehicles = 75\nflights = 8" } else { "runs = 600" });
        text += "\n[[requirements]]\nname = \"near\"\nquantity = \"y\"\nat_most = 0.8\nprobability = 0.5\nconfidence = 0.9\n";
        if until && !in_shards {
            text += "\n[until]\nrule = \"decided\"\n";
        }
        let waiting = AnyScenario::from_toml(&text, folder.path()).unwrap();
        let [one, other] = [answer(), other_answer()].map(|function| waiting.clone().with_function(function).unwrap());
        let out = folder.path().join("out");
        let options = Options { threads: Some(threads), ..Options::to(out.clone()) };
        let stop = Arc::new(AtomicBool::new(false));
        let first = Options { stop: Some(Arc::clone(&stop)), ..options.clone() };
        let progress = |done: u64| stop.store(done >= stopped, Ordering::Relaxed);
        let shards = [1, 2].map(|number| Shard::new(number, 2).unwrap());
        if in_shards {
            one.run_shard(&options, shards[0], &|_| {}, &|_| {}).unwrap();
        } else {
            let _ = one.run(&first, &progress, &|_| {});
        }
        // Of a study that is stopped before its first block is done, nothing is left.
        let before = if out.exists() { files(&out) } else { BTreeMap::new() };
        let any_block = before.keys().any(|name| name.ends_with(".parquet"));
        let again = Options { force, ..options.clone() };
        let refused = if in_shards {
            other.run_shard(&options, shards[1], &|_| {}, &|_| {}).err()
        } else {
            other.run(&again, &|_| {}, &|_| {}).err()
        };
        if any_block {
            let changed = matches!(refused, Some(StudyError::Changed { .. }));
            prop_assert!(changed, "{refused:?}");
            // A share has a lock and a record of its own.
            let after = files(&out);
            let lost: Vec<_> = before.iter().filter(|(name, bytes)| after.get(*name) != Some(*bytes)).map(|(name, _)| name).collect();
            prop_assert!(lost.is_empty(), "{lost:?}");
            prop_assert!(in_shards || after.len() == before.len());
            one.run(&options, &|_| {}, &|_| {}).unwrap();
        } else {
            prop_assert!(refused.is_none(), "{refused:?}");
        }
    }
}

/// What drives a rare event is found with a function too, and shards are put together without it.
#[test]
fn rare_events_and_shards_take_functions() {
    let folder = folder();
    let text = HEAD.to_owned() + &quantity("x", "{ law = \"normal\", mean = 0.3, sigma = 0.1 }");
    let command = AnyScenario::from_toml(&text, folder.path()).unwrap();
    let waiting = AnyScenario::from_toml(&text.replace(COMMAND, FUNCTION), folder.path()).unwrap();
    let function = waiting.clone().with_function(answer()).unwrap();
    let event: Event = "y >= 0.7".parse().unwrap();
    let options = RareOptions { per_level: 100, ..RareOptions::default() };
    let [own, other] = [&function, &command].map(|scenario| {
        serde_json::to_string(&scenario.rare(&event, &options, &|_| {}, &|_| {}).unwrap()).unwrap()
    });
    assert_eq!(own, other);
    assert!(
        waiting
            .rare(&event, &options, &|_| {}, &|_| {})
            .unwrap_err()
            .to_string()
            .contains("as the script")
    );

    let out = folder.path().join("shards");
    let options = Options::to(out.clone());
    for number in 1..=2 {
        let shard = Shard::new(number, 2).unwrap();
        let refused = waiting.run_shard(&options, shard, &|_| {}, &|_| {}).unwrap_err();
        assert!(refused.to_string().contains("simulation.function"), "{refused}");
        function.run_shard(&options, shard, &|_| {}, &|_| {}).unwrap();
    }
    assert!(!Status::read(&out).unwrap().complete);
    put_together(&out, &options, &|_| {}).unwrap();
    assert!(Status::read(&out).unwrap().complete);
    let whole = Options::to(folder.path().join("whole"));
    function.run(&whole, &|_| {}, &|_| {}).unwrap();
    assert_eq!(tables(&out), tables(&folder.path().join("whole")));
}

/// Told to stop in any run, the last ones too, a search for a rare event has no answer: runs that were stopped count for nothing.
#[test]
fn a_rare_event_that_was_stopped_has_no_answer() {
    let folder = folder();
    let text = HEAD.to_owned() + &quantity("x", "{ law = \"normal\", mean = 0.3, sigma = 0.1 }");
    let waiting = AnyScenario::from_toml(&text.replace(COMMAND, FUNCTION), folder.path()).unwrap();
    let event: Event = "y >= 0.6".parse().unwrap();
    let (stop, calls) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
    let last = Arc::new(AtomicU64::new(u64::MAX));
    let (own, counted, at) = (Arc::clone(&stop), Arc::clone(&calls), Arc::clone(&last));
    // As a process that is killed, a run that is stopped fails.
    let function = SimulatorFunction::new(move |run: &RunInputs<'_>| {
        let call = counted.fetch_add(1, Ordering::Relaxed) + 1;
        own.fetch_or(call >= at.load(Ordering::Relaxed), Ordering::Relaxed);
        if own.load(Ordering::Relaxed) { Err("stopped".to_owned()) } else { answer().run(run) }
    });
    let scenario = waiting.with_function(function).unwrap();
    for method in [RareMethod::Subset { replicas: 2 }, RareMethod::Importance { sample: 100 }] {
        let options = RareOptions {
            per_level: 100,
            method,
            stop: Some(Arc::clone(&stop)),
            threads: Some(1),
            ..RareOptions::default()
        };
        calls.store(0, Ordering::Relaxed);
        last.store(u64::MAX, Ordering::Relaxed);
        scenario.rare(&event, &options, &|_| {}, &|_| {}).unwrap();
        let all = calls.load(Ordering::Relaxed);
        for at in [1, 50, all / 2, all - 60, all] {
            calls.store(0, Ordering::Relaxed);
            last.store(at, Ordering::Relaxed);
            let found = scenario.rare(&event, &options, &|_| {}, &|_| {});
            let stopped = matches!(found, Err(StudyError::Campaign(CampaignError::Stopped)));
            assert!(stopped, "{method:?}, {at} of {all}: {found:?}");
            stop.store(false, Ordering::Relaxed);
        }
    }
}

/// Without the function, runs are refused and nothing is left; what is done already is shown.
#[test]
fn runs_need_the_function() {
    let folder = folder();
    let waiting = scenario(&uniform().replace(COMMAND, FUNCTION), folder.path());
    let out = folder.path().join("out");
    let options = Options::to(out.clone());
    let says =
        |error: &str| error.contains("simulation.function") && error.contains("with_function");
    let refused = waiting.study(&options, &|_| {}, &|_| {}).unwrap_err().to_string();
    assert!(says(&refused) && !out.exists(), "{refused}");
    let refused = SimulatorReplay::new(&waiting, None, 1).unwrap_err();
    assert!(
        matches!(&refused, ReplayError::Scenario(error) if says(&error.to_string())),
        "{refused}"
    );
    let calls = Arc::new(AtomicU64::new(0));
    let (counted, answer) = (Arc::clone(&calls), answer());
    let counting = SimulatorFunction::new(move |run| {
        counted.fetch_add(1, Ordering::Relaxed);
        answer.run(run)
    });
    let given = waiting.clone().with_function(counting).unwrap();
    given.study(&options, &|_| {}, &|_| {}).unwrap();
    assert_eq!(calls.load(Ordering::Relaxed), 300);
    // It is complete: one run is done again, by the function, if there is one.
    for scenario in [&given, &waiting, &SimulatorScenario::read(&out).unwrap()] {
        assert_eq!(scenario.study(&options, &|_| {}, &|_| {}).unwrap().folder(), out);
    }
    assert_eq!(calls.load(Ordering::Relaxed), 301);
    // Another version is another study.
    let text = uniform().replace(COMMAND, "function = \"another\"\n");
    let other = scenario(&text, folder.path()).with_function(self::answer()).unwrap();
    let refused = other.study(&options, &|_| {}, &|_| {}).unwrap_err().to_string();
    assert!(refused.contains("simulation.function"), "{refused}");
}

/// What cannot be, at its key.
#[test]
fn refusals_name_their_key() {
    let folder = folder();
    let function = uniform().replace(COMMAND, FUNCTION);
    let with = |more: &str| function.replace(FUNCTION, &format!("{FUNCTION}{more}\n"));
    let cases = [
        (with("command = [\"sh\"]"), "simulation.command"),
        (with("per_run = false"), "simulation.per_run"),
        (with("timeout_s = 1.0"), "simulation.timeout_s"),
        (with("folder = \"/\""), "simulation.folder"),
        (with("files_sha256 = {}"), "simulation.files_sha256"),
        (function.replace("as the script", " "), "simulation.function"),
        (function.replace("as the script", &"x".repeat(201)), "simulation.function"),
        (function.replace(FUNCTION, ""), "simulation.command"),
    ];
    for (text, key) in cases {
        let refused = SimulatorScenario::from_toml(&text, folder.path()).unwrap_err().to_string();
        assert!(refused.starts_with(&format!("{key}: ")), "{key}: {refused}");
    }
    let command = scenario(&uniform(), folder.path()).with_function(answer());
    assert!(command.unwrap_err().to_string().starts_with("simulation.command: "));
    let separations = AnyScenario::Separation(Box::new(Scenario::peck_2003().unwrap()));
    assert!(
        separations.with_function(answer()).unwrap_err().to_string().starts_with("simulation: ")
    );
    // Outputs that the first answers tell.
    let outputs = function.find("[[simulation.outputs]]").unwrap()
        ..function.find("\n[[quantities]]").unwrap();
    let mut silent = function.clone();
    silent.replace_range(outputs, "");
    let silent = scenario(&silent, folder.path());
    let tells = |answer: fn(&RunInputs<'_>) -> Result<Outputs, String>| {
        silent.clone().with_function(SimulatorFunction::new(answer))
    };
    let refused = |answer| tells(answer).unwrap_err().to_string();
    assert!(refused(|_| Err("no licence".into())).contains("no licence"));
    assert!(refused(|_| Ok(Vec::new())).starts_with("simulation.outputs: "));
    assert!(refused(|_| Ok(vec![("a b".into(), 1.0)])).starts_with("simulation.outputs[1].name: "));
    assert!(refused(|_| Ok(vec![("x".into(), 1.0)])).starts_with("simulation.outputs"));
    let infinite = refused(|_| Ok(vec![("y".into(), f64::INFINITY)]));
    assert!(infinite.contains("the output `y` is not a finite number: inf"), "{infinite}");
    let late = tells(|run| match run.run() {
        8 => Ok(vec![("c".into(), 1.0), ("a".into(), f64::NAN)]),
        9 => Ok(vec![("b".into(), 1.0), ("a".into(), 2.0)]),
        _ => Err("not yet".into()),
    });
    let named: Vec<_> = late.unwrap().outputs().iter().map(|c| c.name().to_owned()).collect();
    assert_eq!(named, ["b", "a"]);
    assert!(
        refused(|run| if run.run() < 10 {
            Err("never".into())
        } else {
            Ok(vec![("b".into(), 1.0)])
        })
        .contains("never")
    );
}

/// What a rule ended is read without the function once it is complete. More of it needs the function.
#[test]
fn a_study_that_a_rule_ended_is_read_without_the_function() {
    let folder = folder();
    let text = uniform().replace(COMMAND, FUNCTION);
    let until = |rule: &str| {
        let scenario = SimulatorScenario::from_toml(&text, folder.path()).unwrap();
        scenario.with_runs(3000).unwrap().with_until(Some(rule.parse().unwrap()), None).unwrap()
    };
    let options = Options { out: Some(folder.path().join("out")), ..Options::default() };
    let scenario = until("mean(y) within 0.5");
    let given = scenario.clone().with_function(answer()).unwrap();
    let done = given.study(&options, &|_| {}, &|_| {}).unwrap();
    let again = scenario.study(&options, &|_| {}, &|_| {}).unwrap();
    assert_eq!(again.runs()[0].end(), done.runs()[0].end());
    let more = until("mean(y) within 0.0001").study(&options, &|_| {}, &|_| {}).unwrap_err();
    assert!(more.to_string().contains("simulation.function"), "{more}");
}
