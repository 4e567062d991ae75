//! Requirements of scenarios and of tables: judged twice, by studies and by the verb that reads their tables.

use serde_json::Value;
use std::{
    fs::{self, File},
    process::Stdio,
};

use crate::scratch::{Scratch, content, done, files, judged, one_model, summary};

/// The built-in study under one model, of which some runs fail, with these requirements.
fn scenario(head: &str, requirements: &str) -> String {
    let text = one_model();
    let (before, after) = text.split_once("[payload.dispersion]").unwrap();
    let before: Vec<&str> = before.lines().filter(|line| !line.starts_with("runs =")).collect();
    let before = before.join("\n");
    format!("{head}\n{before}\n[payload.dispersion]\nmass_percent = 60\n{after}\n{requirements}")
}

/// As TOML and in a line.
const REQUIREMENTS: [(&str, &str, &str); 4] = [
    ("nutation", "quantity = \"nutation_deg\"\nat_most = 5.0", "nutation_deg <= 5"),
    (
        "speed",
        "quantity = \"relative_speed_m_per_s\"\nbetween = [0.5, 2.0]",
        "0.5 <= relative_speed_m_per_s <= 2",
    ),
    (
        "tip-off",
        "quantity = \"norm(payload_tip_off_1_deg_per_s, payload_tip_off_2_deg_per_s)\"\nat_least = 1.0",
        "norm(payload_tip_off_1_deg_per_s, payload_tip_off_2_deg_per_s) >= 1",
    ),
    ("flag", "quantity = \"realizable\"\nat_least = 1.0", "realizable >= 1"),
];

fn tables(failed_runs: &str) -> String {
    let table = |(name, keys, _): &(&str, &str, &str)| {
        format!(
            "[[requirements]]\nname = \"{name}\"\n{keys}\nprobability = 0.9\nconfidence = 0.9\nfailed_runs = \"{failed_runs}\"\n"
        )
    };
    REQUIREMENTS.iter().map(table).collect()
}

/// A study and the verb say the same of its runs, whether failed runs count or not; in shards and after another requirement is asked
/// for too, for which no run is done again.
#[test]
fn studies_and_tables_are_judged_alike() {
    let scratch = Scratch::new();
    for (failed_runs, flag) in [("against", None), ("left-out", Some("--leave-out-failed"))] {
        fs::write(scratch.path("it.toml"), scenario("runs = 700", &tables(failed_runs))).unwrap();
        let study = ["study", "--scenario", "it.toml", "--out", failed_runs];
        let said = scratch.done(&study, 1);
        assert!(said.contains("requirement nutation, proposed"), "{said}");
        let lines = REQUIREMENTS.map(|(_, _, line)| format!("{line} in 90 % at 90 %"));
        let runs = format!("{failed_runs}/runs/proposed");
        let mut verdict = vec!["verdict", runs.as_str(), "--json"];
        lines.iter().for_each(|line| verdict.extend(["--require", line]));
        verdict.extend(flag);
        let table: Value = serde_json::from_str(&scratch.done(&verdict, 1)).unwrap();
        let summary = summary(&scratch.path(failed_runs));
        assert_eq!(judged(&summary), judged(&table));
        let failures = |i: usize| summary["requirements"][i]["failures"].as_u64().unwrap();
        let failed = summary["requirements"][0]["runs_without_number"].as_u64().unwrap();
        assert!(failed > 0 && (failed_runs == "against") == (failures(3) >= failed));

        let sharded = ["study", "--scenario", "it.toml", "--out", "sharded", "--shard"];
        for shard in ["2/2", "1/2"] {
            scratch.done(&[&sharded[..], &[shard]].concat(), 0);
        }
        scratch.done(&["report", "sharded"], 0);
        assert_eq!(content(&scratch.path("sharded")), content(&scratch.path(failed_runs)));
        fs::remove_dir_all(scratch.path("sharded")).unwrap();
    }

    // Another requirement, of the same runs.
    let blocks = |folder: &str| {
        let mut files = files(&scratch.path(folder));
        files.retain(|name, _| name.starts_with("runs/"));
        files
    };
    let before = blocks("against");
    let easy = "[[requirements]]\nquantity = \"nutation_deg\"\nat_most = 180.0\nprobability = 0.5\nconfidence = 0.5\n";
    fs::write(scratch.path("it.toml"), scenario("runs = 700", easy)).unwrap();
    let said = scratch.done(&["study", "--scenario", "it.toml", "--out", "against"], 0);
    assert!(said.contains("requirement nutation_deg at most 180, proposed\n  MET"), "{said}");
    assert_eq!(blocks("against"), before);
}

/// Flights of a vehicle that have something in common are not counted as if they were independent.
#[test]
fn of_vehicles_the_first_flights_are_judged() {
    let scratch = Scratch::new();
    let require = |failed| tables(failed);
    let text = scenario("vehicles = 40\nflights = 5", &require("against"));
    let text =
        text.replace("mass_percent = 60", "mass_percent = { sigma = 60, drawn = \"vehicle\" }");
    fs::write(scratch.path("it.toml"), text).unwrap();
    scratch.done(&["study", "--scenario", "it.toml", "--out", "it"], 1);
    let summary = summary(&scratch.path("it"));
    for judged in summary["requirements"].as_array().unwrap() {
        assert_eq!((judged["runs"].as_u64(), judged["counted"].as_u64()), (Some(40), Some(40)));
        let vehicles = &judged["vehicles"];
        assert_eq!(vehicles["vehicles"].as_u64(), Some(40));
        assert!(vehicles["keeping"].as_u64().unwrap() <= 40);
        for worst in judged["worst"].as_array().unwrap() {
            assert_eq!(worst["run"].as_u64().unwrap() % 5, 0);
        }
    }
    let report = fs::read_to_string(scratch.path("it/report.md")).unwrap();
    assert!(report.contains("first flight of each vehicle"));
}

/// What is wrong with a requirement is named by its key, before the first run.
#[test]
fn wrong_requirements_are_refused() {
    let scratch = Scratch::new();
    let one =
        |keys: &str| format!("[[requirements]]\n{keys}\nprobability = 0.9\nconfidence = 0.9\n");
    let named =
        |name: &str| one(&format!("name = \"{name}\"\nquantity = \"nutation_deg\"\nat_most = 1"));
    let of_model = |model: &str| named(&format!("it\"\nmodel = \"{model}"));
    let unnamed = one("quantity = \"nutation_deg\"\nat_most = 1");
    for (requirement, expected) in [
        (named(""), "requirements[1].name: \"\""),
        (named(" "), "requirements[1].name: \" \""),
        (named("tip\\noff"), "requirements[1].name: \"tip\\noff\": a name must be one line"),
        (named("tip\\u001boff"), "requirements[1].name: \"tip\\u{1b}off\": "),
        (named("tip\\u2028off"), "requirements[1].name: \"tip\\u{2028}off\": "),
        (named("other") + &named("it") + &named("it"), "requirements[3].name: \"it\": requirements[2] has this name, too"),
        (unnamed.repeat(2), "requirements[2].name: \"nutation_deg at most 1\": requirements[1] has"),
        (of_model("proposed") + &of_model("proposed"), "requirements[2].name: \"it\""),
        (of_model("proposed") + &named("it"), "requirements[2].name: \"it\""),
        (one("quantity = \"nutation\"\nat_most = 1"), "requirements[1].quantity: \"nutation\""),
        (one("quantity = \"status\"\nat_most = 1"), "requirements[1].quantity: \"status\""),
        (one("quantity = \"nutation_deg\""), "one of at_most"),
        (one("quantity = \"nutation_deg\"\nat_most = inf"), "finite"),
        (one("quantity = \"nutation_deg\"\nat_most = 1\nmodel = \"naive\""), "requirements[1].model: \"naive\""),
        (one("quantity = \"nutation_deg\"\nat_most = 1\nlimit = 2"), "limit"),
        ("[[requirements]]\nquantity = \"nutation_deg\"\nat_most = 1\n".to_owned(), "probability"),
        (
            "[[requirements]]\nquantity = \"nutation_deg\"\nat_most = 1\nprobability = 99.73\nconfidence = 0.9\n".to_owned(),
            "probability = 99.73",
        ),
    ] {
        fs::write(scratch.path("it.toml"), scenario("runs = 10", &requirement)).unwrap();
        let said = scratch.done(&["study", "--scenario", "it.toml", "--out", "it"], 2);
        assert!(said.contains(expected), "{requirement}: {said}");
        assert!(!scratch.path("it").exists());
    }
    fs::write(scratch.path("t.csv"), "x\n1\n").unwrap();
    scratch.done(&["verdict", "t.csv"], 2);
    let said = scratch.done(&["verdict", "t.csv", "--require", "x = 1"], 2);
    assert!(said.contains("“<=” or “>=”"), "{said}");
    let said = scratch.done(&["verdict", "t.csv", "--require", "y <= 1 in 90 % at 90 %"], 2);
    assert!(said.contains("t.csv") && said.contains("its columns are x"), "{said}");
    let said = scratch.done(&["verdict", "t.csv", "--require", "x <= 1 in 90 % at 90 %"], 1);
    scratch.done(&["verdict", "t.csv", "--require", "-1 <= x <= 1 in 90 % at 90 %"], 1);
    assert!(said.contains("NOT DECIDED") && said.contains("21 more"), "{said}");
}

/// A mistake in a requirement has the file in front of it, in a study and where the runs are only drawn, before anything is written.
#[test]
fn mistakes_in_requirements_begin_with_their_file() {
    let scratch = Scratch::new();
    let one = |keys: &str| {
        format!("[[requirements]]\n{keys}\nat_most = 1\nprobability = 0.9\nconfidence = 0.9\n")
    };
    let simulator = "[simulation]\ncommand = [\"true\"]\noutputs = [{ name = \"range_m\", unit = \"m\" }]\n[[quantities]]\nname = \"speed\"\n\
                     unit = \"m/s\"\nlaw = { law = \"normal\", mean = 10.0, sigma = 3.0 }\n";
    let of_simulator =
        |head: &str, tail: &str| format!("name = \"it\"\nruns = 10\n{head}\n{simulator}{tail}");
    for (text, expected) in [
        (
            scenario("runs = 10", &one("quantity = \"nutation\"")),
            "requirements[1].quantity: \"nutation\": the run table has no such column",
        ),
        (
            scenario("runs = 10", &one("quantity = \"status\"")),
            "requirements[1].quantity: \"status\": the run table",
        ),
        (
            scenario("runs = 10", &one("quantity = \"nutation_deg\"\nmodel = \"naive\"")),
            "requirements[1].model: \"naive\": ",
        ),
        (
            scenario("runs = 10", "[until]\nrule = \"mean(nutation) within 1\"\n"),
            "until.rule: \"nutation\": ",
        ),
        (scenario("runs = 10\ncolumns = [\"nutation\"]", ""), "columns: \"nutation\": "),
        (
            of_simulator("", &one("quantity = \"range\"")),
            "requirements[1].quantity: \"range\": the run table has no such column of numbers; it has speed, range_m",
        ),
        (of_simulator("columns = [\"range\"]", ""), "columns: \"range\": "),
    ] {
        fs::write(scratch.path("it.toml"), text).unwrap();
        let expected = format!("error: it.toml: {expected}");
        let studied = scratch.done(&["study", "--scenario", "it.toml", "--out", "it"], 2);
        assert!(studied.starts_with(&expected), "{expected}\n{studied}");
        assert_eq!(scratch.done(&["draw", "it.toml", "-n", "1", "-o", "it.csv"], 2), studied);
        assert!(!scratch.path("it").exists() && !scratch.path("it.csv").exists());
    }
    // What is asked for on the command line stands in no file.
    fs::write(scratch.path("it.toml"), scenario("runs = 10", "")).unwrap();
    let until = ["study", "--scenario", "it.toml", "--until", "mean(nutation) within 1"];
    let said = scratch.done(&until, 2);
    assert!(said.starts_with("error: until.rule: \"nutation\": "), "{said}");
}

/// A table that is piped in is judged as the file is, and must be CSV.
#[test]
fn a_table_is_read_from_standard_input() {
    let scratch = Scratch::new();
    let mut text = "x;y\n".to_owned();
    (0..300).for_each(|i| text.push_str(&format!("{};{i}\n", i % 7)));
    fs::write(scratch.path("t.csv"), text).unwrap();
    let requires =
        ["--require", "x <= 3 in 50 % at 90 %", "--require", "1 <= y <= 400 in 90 % at 90 %"];
    let piped = |from: &str, more: &[&str], code: i32| {
        let mut command = scratch.command(&[&["verdict", "-"], more].concat());
        command.stdin(Stdio::from(File::open(scratch.path(from)).unwrap()));
        done(command, code)
    };
    let of_file = scratch.done(&[&["verdict", "t.csv"], &requires[..]].concat(), 0);
    let said = piped("t.csv", &requires, 0);
    assert_eq!(said.strip_prefix("standard input: "), of_file.strip_prefix("t.csv: "));
    let json = |text: &str| serde_json::from_str::<Value>(text).unwrap();
    let requires = [&requires[..], &["--json"]].concat();
    let of_file = json(&scratch.done(&[&["verdict", "t.csv"], &requires[..]].concat(), 0));
    let said = json(&piped("t.csv", &requires, 0));
    assert_eq!(
        (&said["requirements"], said["table"].as_str()),
        (&of_file["requirements"], Some("-"))
    );

    let said = piped("t.csv", &["--require", "z <= 3 in 50 % at 90 %"], 2);
    assert!(said.starts_with("error: standard input: it has no column \"z\""), "{said}");
    fs::write(scratch.path("t.parquet"), "PAR1 and so on").unwrap();
    let said = piped("t.parquet", &requires, 2);
    assert!(said.starts_with("error: standard input: it is a Parquet file"), "{said}");
    fs::write(scratch.path("empty"), "").unwrap();
    assert!(piped("empty", &requires, 2).starts_with("error: standard input: it is empty"));
}

/// What the page shows is what the program says.
#[test]
fn the_page_shows_what_is_said() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/requirements.md");
    let page = fs::read_to_string(page).unwrap();
    let (_, shown) = page.split_once("```text\n").unwrap();
    let (shown, _) = shown.split_once("```").unwrap();
    let scratch = Scratch::new();
    scratch.done(&["study", "-q"], 0);
    let runs = "target/study/peck-2003/runs/proposed";
    let require = "nutation_deg <= 10 in 99 % at 90 %";
    assert!(page.contains(&format!("gyradius verdict {runs} --require \"{require}\"")));
    assert_eq!(scratch.done(&["verdict", runs, "--require", require], 0), shown);
}
