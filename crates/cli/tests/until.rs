//! Studies that go on until their runs have shown enough.

use serde_json::Value;
use std::{fs, path::Path, process::Command, thread, time::Duration};

use crate::scratch::{Scratch, content, done, one_model, summary};

/// The built-in study under one model, with this at its head and one requirement.
fn scenario(head: &str, at_most: f64, probability: f64) -> String {
    let text = one_model();
    let runs = text.lines().filter(|line| !line.starts_with("runs ="));
    let text = runs.collect::<Vec<_>>().join("\n");
    format!(
        "{head}\n{text}\n[[requirements]]\nquantity = \"nutation_deg\"\nat_most = {at_most:?}\nprobability = {probability}\n\
         confidence = 0.9\n"
    )
}

fn runs(folder: &Path) -> u64 {
    summary(folder)["runs_per_model"].as_u64().unwrap()
}

/// For vehicles that are good, bad and in between: the runs end at the first look that decides, whatever was interrupted, extended
/// or done on how many threads, and the same again from the resolved scenario.
#[test]
fn runs_end_at_the_first_look_that_is_enough() {
    let scratch = Scratch::new();
    let mut ended = Vec::new();
    for (name, at_most, probability, code) in [
        ("good", 15.0, 0.97, 0),
        ("bad", 5.0, 0.9, 1),
        ("near", 10.0, 0.99, 0),
        ("even", 7.6, 0.95, 1),
    ] {
        let file = format!("{name}.toml");
        fs::write(scratch.path(&file), scenario("", at_most, probability)).unwrap();
        let until = |out: &str, most: u64, threads: &str, code: i32| {
            let (most, rule) = (most.to_string(), ["--until", "decided", "--look-every", "200"]);
            let study =
                ["study", "--scenario", &file, "--out", out, "--runs", &most, "--threads", threads];
            scratch.done(&[&study[..], &rule].concat(), code)
        };
        let said = until(name, 20_000, "2", code);
        let whole = content(&scratch.path(name));
        let found = runs(&scratch.path(name));
        let summary = summary(&scratch.path(name));
        let judged = &summary["requirements"][0];
        let enough = summary["ended"]["enough"].as_bool().unwrap();
        assert_eq!(judged["looks"], "often");
        assert_eq!(judged["verdict"].get("undecided").is_none(), enough, "{judged}");
        assert_eq!(found < 20_000, enough, "{said}");
        ended.push(found);
        let report = fs::read_to_string(scratch.path(name).join("report.md")).unwrap();
        assert!(
            report.contains("The rule “decided”") && report.contains("Robbins 1970"),
            "{report}"
        );

        // One look less is not enough, and what goes on from there is the same study.
        let next = |look: &u64| Some(look + (look / 2000).max(1) * 200);
        let before = std::iter::successors(Some(200), next).take_while(|look| *look < found).last();
        if let Some(before) = before {
            let said = until("again", before, "1", 1);
            assert!(said.contains("did not end the runs"), "{said}");
            until("again", 20_000, "1", code);
            assert_eq!(content(&scratch.path("again")), whole, "{name}");
            fs::remove_dir_all(scratch.path("again")).unwrap();
        }
        let resolved = format!("{name}/scenario.toml");
        scratch.done(&["study", "--scenario", &resolved, "--out", "again"], code);
        assert_eq!(content(&scratch.path("again")), whole, "{name}");
        fs::remove_dir_all(scratch.path("again")).unwrap();

        // The runs are those of a study of so many.
        let plain = ["study", "--scenario", &file, "--runs", &found.to_string(), "--out", "plain"];
        scratch.command(&plain).output().unwrap();
        let plain = crate::scratch::summary(&scratch.path("plain"));
        for key in ["models", "nominal"] {
            assert_eq!(plain[key], summary[key], "{name}: {key}");
        }
        fs::remove_dir_all(scratch.path("plain")).unwrap();
    }
    assert!(ended[0] < ended[2] && ended[1] < ended[3], "{ended:?}");
}

/// With the rows not kept, the same command again changes nothing; more runs than the rule asks for stay.
#[test]
fn what_is_there_stays() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario("rows = \"none\"", 15.0, 0.97)).unwrap();
    let study = ["study", "--scenario", "it.toml", "--runs", "9000", "--until", "decided", "--out"];
    scratch.done(&[&study[..], &["it"]].concat(), 0);
    let whole = content(&scratch.path("it"));
    scratch.done(&[&study[..], &["it"]].concat(), 0);
    assert_eq!(content(&scratch.path("it")), whole);
    assert_eq!(runs(&scratch.path("it")), 1000);

    fs::write(scratch.path("all.toml"), scenario("", 15.0, 0.97)).unwrap();
    scratch.done(&["study", "--scenario", "all.toml", "--runs", "1234", "--out", "more"], 0);
    scratch.done(
        &[
            "study",
            "--scenario",
            "all.toml",
            "--runs",
            "9000",
            "--until",
            "decided",
            "--out",
            "more",
        ],
        0,
    );
    assert_eq!(runs(&scratch.path("more")), 1234);
    // The rule would have ended them before, which the scenario tells, so that a fresh folder gives the same.
    let resolved = fs::read_to_string(scratch.path("more/scenario.toml")).unwrap();
    assert!(resolved.contains("first_look = 1234"), "{resolved}");
    let report = fs::read_to_string(scratch.path("more/report.md")).unwrap();
    assert!(
        report.contains(
            "The first look that counts is at 1234 runs of each model, as the scenario says"
        ),
        "{report}"
    );
    scratch.done(&["study", "--scenario", "more/scenario.toml", "--out", "fresh"], 0);
    let numbers = |folder: &str| summary(&scratch.path(folder))["models"].clone();
    assert_eq!(numbers("fresh"), numbers("more"));
    // The greatest number of runs is the last look, so that none is later.
    let fewer = ["study", "--scenario", "more/scenario.toml", "--out", "fewer", "--runs", "900"];
    let said = scratch.done(&fewer, 0);
    assert!(said.contains("The first look that counts is at 900 runs of each model"), "{said}");
    let few =
        ["study", "--scenario", "all.toml", "--runs", "900", "--until", "decided", "--out", "more"];
    let said = scratch.done(&few, 2);
    assert!(said.contains("runs is 1234 there and 900 here"), "{said}");
}

/// Kills a study in the folder `it` once so many of its blocks are there.
fn killed(study: &mut Command, scratch: &Scratch, blocks: usize) {
    let mut child = study.spawn().unwrap();
    let folder = scratch.path("it/.gyradius/campaign/proposed");
    let some = || fs::read_dir(&folder).is_ok_and(|files| files.count() >= blocks);
    while !some() && child.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

/// A report of a study that a rule is to end, made before it has, says so and keeps nobody from going on, whichever rows are to be kept
/// in the end.
#[test]
fn a_report_meanwhile_is_no_end() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario("", 10.0, 0.99)).unwrap();
    for rows in ["all", "none"] {
        let study = |out: &str| {
            let until = ["--until", "mean(nutation_deg) within 0.03", "--look-every", "200"];
            let most = ["--runs", "200000", "--threads", "1", "--rows", rows];
            let study = ["study", "--scenario", "it.toml", "--out", out];
            scratch.command(&[&study[..], &until, &most].concat())
        };
        done(study("whole"), 0);
        killed(&mut study("it"), &scratch, 4);
        assert!(scratch.path("it/.gyradius/campaign").exists());
        for _ in 0..2 {
            let said = scratch.done(&["report", "it"], 1);
            assert!(said.contains("The runs were interrupted: so far there are "), "{said}");
            let report = fs::read_to_string(scratch.path("it/report.md")).unwrap();
            assert!(report.contains("A rule has not ended the runs yet."), "{report}");
            assert!(runs(&scratch.path("it")) < runs(&scratch.path("whole")));
        }
        done(study("it"), 0);
        assert_eq!(content(&scratch.path("it")), content(&scratch.path("whole")));
        for out in ["it", "whole"] {
            fs::remove_dir_all(scratch.path(out)).unwrap();
        }
    }
}

/// Runs that a rule looked at until it was killed are judged as runs that were looked at, by whoever goes on without a rule.
#[test]
fn runs_of_a_rule_that_was_killed_stay_looked_at() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario("", 10.0, 0.99)).unwrap();
    let study = |more: &[&str]| {
        let study = ["study", "--scenario", "it.toml", "--out", "it", "--threads", "1"];
        scratch.command(&[&study[..], more].concat())
    };
    let rule = ["--until", "share within 0.0001 %", "--look-every", "200", "--runs", "1000000"];
    killed(&mut study(&rule), &scratch, 2);
    assert!(!scratch.path("it/summary.json").exists());
    let looks = || summary(&scratch.path("it"))["requirements"][0]["looks"].clone();
    for runs in ["40000", "40500"] {
        done(study(&["--runs", runs, "--force"]), 0);
        assert_eq!(looks(), "often");
    }
    // Of another seed nobody has looked at any.
    study(&["--runs", "1000", "--seed", "7", "--force"]).output().unwrap();
    assert_eq!(looks(), Value::Null);
}

/// Of vehicles, whole vehicles are looked at, and their first flights count.
#[test]
fn vehicles_are_looked_at_as_a_whole() {
    let scratch = Scratch::new();
    let text = scenario("vehicles = 900\nflights = 7", 15.0, 0.9);
    let text = text.replace(
        "[payload.dispersion]\n",
        "[payload.dispersion]\nmass_percent = { sigma = 1, drawn = \"vehicle\" }\n",
    );
    fs::write(scratch.path("it.toml"), &text).unwrap();
    let until =
        ["study", "--scenario", "it.toml", "--until", "decided", "--out", "it", "--look-every"];
    scratch.done(&[&until[..], &["70"]].concat(), 0);
    let found = summary(&scratch.path("it"));
    let vehicles = found["fleet"]["vehicles"].as_u64().unwrap();
    assert_eq!(found["runs_per_model"].as_u64(), Some(7 * vehicles));
    assert_eq!(found["requirements"][0]["counted"].as_u64(), Some(vehicles));
    assert!(vehicles > 20 && vehicles < 900);
    let said = scratch.done(&[&until[..], &["71"]].concat(), 2);
    assert!(said.contains("until.look_every: 71: "), "{said}");
}

/// What the width of an interval ends is as narrow as was asked, and one look before it was not.
#[test]
fn widths_are_reached() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario("", 8.0, 0.95)).unwrap();
    for (rule, code) in [("share within 1 %", 0), ("mean(abs(wobble_deg)) within 0.1", 0)] {
        let study =
            ["study", "--scenario", "it.toml", "--runs", "50000", "--until", rule, "--out", "it"];
        let said = scratch.command(&study).output().unwrap();
        assert!(said.status.code().is_some_and(|found| found <= 1 && code == 0));
        let found = summary(&scratch.path("it"));
        let width = |interval: &Value| {
            interval["upper"].as_f64().unwrap() - interval["lower"].as_f64().unwrap()
        };
        let share = width(&found["requirements"][0]["share_interval"]);
        let quantities = found["models"][0]["quantities"].as_array().unwrap();
        let wobble = quantities.iter().find(|q| q["quantity"] == "wobble_deg").unwrap();
        let mean = width(&wobble["mean_interval"]);
        let (reached, at) = if rule.starts_with("share") { (share, 0.02) } else { (mean, 0.2) };
        assert!(reached <= at && reached > 0.8 * at, "{rule}: {reached}");
        fs::remove_dir_all(scratch.path("it")).unwrap();
    }
}

#[test]
fn what_cannot_end_is_refused() {
    let scratch = Scratch::new();
    let write = |head: &str| {
        let text = scenario("", 15.0, 0.97);
        let (before, after) = text.split_once("[[models]]").unwrap();
        fs::write(scratch.path("it.toml"), format!("{before}[until]\n{head}\n[[models]]{after}"))
            .unwrap();
    };
    for (until, expected) in [
        ("rule = \"decide\"", "“decide”"),
        ("rule = \"decided\"\nlook_every = 0", "look_every = 0"),
        ("rule = \"decided\"\nmost_runs = 0", "runs: 0"),
        ("rule = \"decided\"\nmost_runs = -1", "most_runs"),
        ("rule = \"decided\"\nlooks = 3", "looks"),
        ("rule = \"mean(status) within 1\"", "until.rule: \"status\""),
        ("look_every = 3", "rule"),
    ] {
        write(until);
        let said = scratch.done(&["study", "--scenario", "it.toml", "--out", "it"], 2);
        assert!(said.contains(expected), "{until}: {said}");
    }
    write("rule = \"decided\"\nmost_runs = 500");
    let said =
        scratch.done(&["study", "--scenario", "it.toml", "--out", "it", "--shard", "1/2"], 2);
    assert!(said.contains("until: a share of the runs"), "{said}");
    let said = scratch.done(&["slurm", "--scenario", "it.toml", "--out", "it"], 2);
    assert!(said.contains("until: a share of the runs"), "{said}");
    let said = scratch.done(&["study", "--until", "decided", "--out", "it"], 2);
    assert!(said.contains("there must be requirements"), "{said}");
    let said = scratch.done(&["study", "--look-every", "5", "--out", "it"], 2);
    assert!(said.contains("--until"), "{said}");
    assert!(!scratch.path("it").exists());
    // The greatest number of runs may stand in the rule alone.
    let said = scratch.done(&["study", "--scenario", "it.toml", "--out", "it"], 0);
    assert!(
        said.contains("there might have been 500") && runs(&scratch.path("it")) <= 500,
        "{said}"
    );
    // How often it is looked may be said beside the rule of the scenario.
    let look = ["--look-every", "50", "--out", "often"];
    scratch.done(&[&["study", "--scenario", "it.toml"], &look[..]].concat(), 0);
    let often = fs::read_to_string(scratch.path("often/scenario.toml")).unwrap();
    assert!(often.contains("look_every = 50\n") && often.contains("rule = \"decided\""), "{often}");
}

/// Runs that failed are done again once, before the rule is asked.
#[test]
#[cfg(unix)]
fn failed_runs_are_retried_once() {
    let scratch = Scratch::new();
    let script = r#"while read -r line; do
    run=${line#*'"run":'}; run=${run%%,*}
    case $run in *7) echo '{"error":"no licence"}' ;; *) echo '{"outputs":{"y":1}}' ;; esac
done"#;
    fs::write(scratch.path("answer.sh"), script).unwrap();
    let text = r#"name = "it"
runs = 2000
[until]
rule = "decided"
[simulation]
command = ["sh", "answer.sh"]
[[simulation.outputs]]
name = "y"
[[quantities]]
name = "x"
law = { law = "uniform", low = 0.0, high = 1.0 }
[[requirements]]
quantity = "y"
at_most = 2.0
probability = 0.9
confidence = 0.9
failed_runs = "left-out"
"#;
    fs::write(scratch.path("it.toml"), text).unwrap();
    let study = ["study", "--scenario", "it.toml", "--out", "it"];
    scratch.done(&study, 0);
    let before = summary(&scratch.path("it"));
    assert_eq!((&before["runs_per_model"], before.get("done_again")), (&Value::from(256), None));
    let said = scratch.done(&[&study[..], &["--retry-failed"]].concat(), 0);
    assert!(said.contains("25 runs that had failed, done again: 25 failed again"), "{said}");
    assert_eq!(summary(&scratch.path("it"))["done_again"], 25);
}
