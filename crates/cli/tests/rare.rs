//! Rare events on the command line.

use serde_json::Value;
use std::fs;

use crate::scratch::{Scratch, one_model};

/// The built-in study under one model, with mass centres and springs that are dispersed.
fn scenario() -> String {
    let centres = "mass_centre_m = { sigma = 0.01 }";
    one_model()
        .replace("[payload.dispersion]\n", &format!("[payload.dispersion]\n{centres}\n"))
        .replace("[stage.dispersion]\n", &format!("[stage.dispersion]\n{centres}\n"))
        .replace("[[springs]]", "[[springs]]\ndispersion = { stiffness_percent = 5.0 }")
}

/// The length of two components of either mass centre is that of a normal vector in four dimensions: its tail is known. The same
/// from any number of threads.
#[test]
fn known_probabilities_are_found() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario()).unwrap();
    for (sigmas, exact) in [(3.0_f64, None), (5.5, None), (40.0, Some(0.0))] {
        let names = "payload_mass_centre_1_m, payload_mass_centre_2_m, stage_mass_centre_1_m, stage_mass_centre_2_m";
        let event = format!("norm({names}) >= {}", 0.01 * sigmas);
        let rare = |threads: &str| {
            let arguments = [
                "rare",
                &event,
                "--scenario",
                "it.toml",
                "--json",
                "--per-level",
                "1500",
                "--threads",
                threads,
            ];
            scratch.done(&arguments, 0)
        };
        let text = rare("2");
        if sigmas == 5.5 {
            assert_eq!(text, rare("1"));
        }
        let found: Value = serde_json::from_str(&text).unwrap();
        let probability = found["probability"].as_f64().unwrap();
        let half = 0.5 * sigmas * sigmas;
        let exact = exact.unwrap_or_else(|| (-half).exp() * (1.0 + half));
        if exact > 0.0 {
            let off = (probability / exact).ln().abs();
            assert!(off < 0.7, "{sigmas}: {probability} {exact}");
            let (lower, upper) = (&found["interval"]["lower"], &found["interval"]["upper"]);
            assert!(
                lower.as_f64().unwrap() < 1.2 * exact && 0.8 * exact < upper.as_f64().unwrap(),
                "{text}"
            );
        } else {
            assert!(
                probability == 0.0 && !found["warnings"].as_array().unwrap().is_empty(),
                "{text}"
            );
        }
    }
}

/// By importance sampling, with what was drawn from which law; the same from any number of threads.
#[test]
fn importance_sampling_says_what_it_steered() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario()).unwrap();
    let event = "payload_mass_centre_1_m >= 0.052";
    let common =
        ["rare", event, "--scenario", "it.toml", "--method", "importance", "--sample", "2000"];
    let with = |more: &[&str]| scratch.done(&[&common[..], more].concat(), 0);
    let text = with(&["--json", "--threads", "1"]);
    assert_eq!(text, with(&["--json", "--threads", "2"]));
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["method"], "importance");
    assert_eq!(found["steered"][0], "payload mass centre");
    assert_eq!(found["own_laws"][0], "payload roots");
    let (lower, upper) = (&found["interval"]["lower"], &found["interval"]["upper"]);
    // The tail of the normal law beyond 5.2.
    let exact = 9.964e-8;
    assert!(
        lower.as_f64().unwrap() < 1.05 * exact && 0.95 * exact < upper.as_f64().unwrap(),
        "{text}"
    );
    assert_eq!(found["warnings"], Value::Array(Vec::new()));
    let said = with(&[]);
    for line in [
        "  steered      payload mass centre; stage mass centre; ",
        "  own laws     payload roots; payload axes; ",
    ] {
        assert!(said.contains(line), "{said}");
    }
    assert!(!said.contains("warning"), "{said}");
    let far =
        ["rare", "payload_mass_centre_1_m >= 1", "--scenario", "it.toml", "--method", "importance"];
    let said = scratch.done(&far, 0);
    assert!(said.contains("no event was found; below") && said.contains("warning"), "{said}");
}

/// A simulator that answers twice has to be started again for it, of which both verbs warn.
#[test]
fn more_than_the_answers_is_told_as_by_a_study() {
    let scratch = Scratch::new();
    let script = "while read -r line; do\n    x=${line#*'\"x\":'}; x=${x%%[,\\}]*}\n    \
                  echo \"{\\\"outputs\\\":{\\\"y\\\":$x}}\"$MORE\ndone\n";
    let scenario = "name = \"twice\"\nruns = 20\n[simulation]\ncommand = [\"sh\", \"it.sh\"]\noutputs = [{ name = \"y\" }]\n\
                    [[quantities]]\nname = \"x\"\nlaw = { law = \"uniform\", low = 0.1, high = 0.9 }\n";
    fs::write(scratch.path("s.toml"), scenario).unwrap();
    for (more, warned) in [("", false), ("; echo more", true)] {
        fs::write(scratch.path("it.sh"), script.replace("$MORE", more)).unwrap();
        let out = format!("out-{warned}");
        for arguments in [
            &["study", "--scenario", "s.toml", "--out", &out][..],
            &["rare", "y >= 0.5", "--scenario", "s.toml", "--per-level", "100", "--replicas", "2"],
        ] {
            let output = scratch.run(&[arguments, &["--threads", "1"]].concat());
            assert!(output.status.success(), "{output:?}");
            let said = String::from_utf8(output.stderr).unwrap();
            let warning = "warning: the simulator wrote more to standard output than its answers, such as `more`, and ";
            assert_eq!(said.contains(warning), warned, "{arguments:?}: {said}");
        }
    }
}

/// An event that is not rare is as frequent as in a study.
#[test]
fn frequent_events_are_those_of_a_study() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario()).unwrap();
    let study = ["study", "--scenario", "it.toml", "--runs", "4000", "--out", "it"];
    scratch.done(&study, 0);
    let verdict =
        ["verdict", "it/runs/proposed", "--require", "cone_deg <= 5 in 50 % at 90 %", "--json"];
    let plain: Value = serde_json::from_slice(&scratch.run(&verdict).stdout).unwrap();
    let plain = 1.0 - plain["requirements"][0]["share"].as_f64().unwrap();
    let rare = scratch.done(&["rare", "cone_deg >= 5", "--scenario", "it.toml", "--json"], 0);
    let rare: Value = serde_json::from_str(&rare).unwrap();
    let found = rare["probability"].as_f64().unwrap();
    assert!((found / plain - 1.0).abs() < 0.2, "{found} {plain}");
}

#[test]
fn what_cannot_be_is_refused() {
    let scratch = Scratch::new();
    for (arguments, expected) in [
        (&["rare", "cone_deg"][..], "“cone_deg”"),
        (&["rare", "cone >= 5"], "event: \"cone\": the run table has no such column"),
        (
            &["rare", "cone_deg >= 5", "--model", "other"],
            "model: \"other\": the scenario has proposed",
        ),
        (
            &["rare", "cone_deg >= 5", "--per-level", "99"],
            "error: per-level: 99 runs of a level; there must be 100 or more\n",
        ),
        (
            &["rare", "cone_deg >= 5", "--replicas", "1"],
            "error: replicas: 1 replica; there must be 2 to 1000\n",
        ),
        (
            &["rare", "cone_deg >= 5", "--replicas", "1", "--per-level", "9"],
            "error: per-level, replicas: 9 runs of a level; there must be 100 or more, and 1 replica; there must be 2 to 1000\n",
        ),
        (
            &["rare", "cone_deg >= 5", "--replicas", "1000", "--per-level", "1e6"],
            "1000 replicas; their product may be 100000000 at most\n",
        ),
        (&["rare", "cone_deg >= 5", "--sample", "1e4"], "--method importance"),
        (
            &["rare", "cone_deg >= 5", "--method", "importance", "--replicas", "5"],
            "--method subset",
        ),
        (&["rare", "cone_deg >= 5", "--method", "importance"], "method \"subset\" serves any law"),
        (&["rare", "cone_deg >= 5", "--method", "other"], "importance"),
        (&["rare", "cone_deg >= 5", "--least", "0"], "0"),
        (&["rare", "cone_deg >= 5", "--least", "nan"], "NaN"),
        (&["rare", "cone_deg >= 5", "--scenario", "none.toml"], "none.toml"),
        (&["rare", "clearance_m <= 0"], "event: none of 1000 runs has a number of clearance_m"),
        (&["rare", "run >= 5"], "event: \"run\": the run table has no such column"),
        (&["rare", "cone_deg > 5"], "“abs(x) >= 1”"),
        (&["rare"], "EVENT"),
    ] {
        let said = scratch.done(arguments, 2);
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
    assert_eq!(fs::read_dir(scratch.folder()).unwrap().count(), 0, "nothing is written");
}
