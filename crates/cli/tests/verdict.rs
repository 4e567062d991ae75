//! The verb `verdict` on run tables of studies, which it judges as the studies do.

use serde_json::Value;
use std::fs;

use crate::scratch::{Scratch, judged, one_model, summary};

/// The requirement of all studies, in a line.
const REQUIRE: &str = "nutation_deg <= 10 in 97 % at 90 %";

/// The built-in study under one model, with this at its head and the requirement.
fn scenario(head: &str) -> String {
    let text = one_model();
    let runs = text.lines().filter(|line| !line.starts_with("runs ="));
    let text = runs.collect::<Vec<_>>().join("\n");
    format!(
        "{head}\n{text}\n[[requirements]]\nquantity = \"nutation_deg\"\nat_most = 10.0\nprobability = 0.97\nconfidence = 0.9\n"
    )
}

/// What the verb says of a table as JSON, with the same verdict as the study in a folder.
fn same_as_study(scratch: &Scratch, table: &str, folder: &str, code: i32) -> Value {
    let said = scratch.done(&["verdict", table, "--json", "--require", REQUIRE], code);
    let said: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(judged(&said), judged(&summary(&scratch.path(folder))), "{table}");
    said
}

/// Runs that a rule could end are judged as runs that were looked at, by the verb and by each later study in the folder.
#[test]
fn runs_that_a_rule_looked_at_stay_looked_at() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario("")).unwrap();
    let study = |out: &str, more: &[&str]| {
        let study = ["study", "--scenario", "it.toml", "--out", out];
        scratch.command(&[&study[..], more].concat()).output().unwrap();
    };
    let looks = |folder: &str| summary(&scratch.path(folder))["requirements"][0]["looks"].clone();
    // Of a vehicle that so many runs decide, and that a rule leaves open.
    study("once", &["--runs", "400"]);
    study("it", &["--runs", "400", "--until", "share within 0.01 %"]);
    assert_eq!((looks("once"), looks("it")), (Value::Null, "often".into()));
    same_as_study(&scratch, "once/runs/proposed", "once", 0);
    let block = "runs/proposed/000000000-000000399.parquet";
    for table in ["it/runs/proposed", &format!("it/{block}")] {
        same_as_study(&scratch, table, "it", 1);
    }
    let said = scratch.done(&["verdict", "it/runs/proposed", "--require", REQUIRE], 1);
    let looked = "looked at them while they were done, says it/campaign.json";
    assert!(said.contains(looked) && said.contains("NOT DECIDED"), "{said}");
    let said = scratch.done(&["verdict", "once/runs/proposed", "--require", REQUIRE], 0);
    assert!(!said.contains("looked at"), "{said}");

    // Nobody forgets that, whether the runs are as many or more.
    for runs in ["400", "410"] {
        study("it", &["--runs", runs]);
        assert_eq!((looks("it"), looks("once")), ("often".into(), Value::Null));
        same_as_study(&scratch, "it/runs/proposed", "it", 1);
        let report = fs::read_to_string(scratch.path("it/report.md")).unwrap();
        assert!(report.contains("looked at them before, in this folder"), "{report}");
    }
    // The runs of another seed are other runs.
    study("it", &["--runs", "400", "--seed", "7", "--force"]);
    assert_eq!(looks("it"), Value::Null);

    // A table alone tells nothing; what tells of it must be whole.
    fs::copy(scratch.path("it").join(block), scratch.path("alone.parquet")).unwrap();
    same_as_study(&scratch, "alone.parquet", "it", 0);
    fs::write(scratch.path("it/campaign.json"), "{}").unwrap();
    let said = scratch.done(&["verdict", "it/runs/proposed", "--require", REQUIRE], 2);
    assert!(said.contains("it/campaign.json, which says how its runs are judged: "), "{said}");
}

/// Of flights of a vehicle that have something in common the verb judges the first, as the study does, whatever columns are kept; of a
/// table alone it cannot know whether they have.
#[test]
fn of_vehicles_the_first_flights_are_judged() {
    let scratch = Scratch::new();
    let fleet = scenario("vehicles = 90\nflights = 5");
    let mass = |law: &str| {
        fleet
            .replace("[payload.dispersion]", &format!("[payload.dispersion]\nmass_percent = {law}"))
    };
    for (name, law, counted) in
        [("shared", "{ sigma = 3, drawn = \"vehicle\" }", 90), ("apart", "{ sigma = 3 }", 450)]
    {
        fs::write(scratch.path("it.toml"), mass(law)).unwrap();
        for (out, columns) in
            [(name.to_owned(), &[][..]), (format!("{name}-some"), &["--columns", "nutation_deg"])]
        {
            let study = ["study", "--scenario", "it.toml", "--out", &out];
            let code = scratch.run(&[&study[..], columns].concat()).status.code().unwrap();
            let table = format!("{out}/runs/proposed");
            let said = same_as_study(&scratch, &table, &out, code);
            assert_eq!(said["requirements"][0]["counted"], counted, "{out}");
            let said = scratch.done(&["verdict", &table, "--require", REQUIRE], code);
            let of_fleet = counted == 90;
            for words in [
                "Of each vehicle the first of 5 flights is judged",
                "90 first flights",
                "of the first flights keep it",
            ] {
                assert_eq!(said.contains(words), of_fleet, "{said}");
            }
            assert_eq!(said.contains("450 runs"), !of_fleet, "{said}");
            let few = &["verdict", &table, "--require", "nutation_deg <= 90 in 99 % at 90 %"][..];
            let said = scratch.run(few).stdout;
            let said = String::from_utf8(said).unwrap();
            // Of 90 vehicles 230 were enough.
            let more = "  more         140 more vehicles would show that it is met";
            assert_eq!(said.contains(more), of_fleet, "{said}");
            assert!(!said.contains("more runs"), "{said}");
            // A copy elsewhere tells which flights are the first, whatever columns are kept.
            let copy = format!("copy-{out}");
            fs::create_dir(scratch.path(&copy)).unwrap();
            for block in fs::read_dir(scratch.path(&table)).unwrap() {
                let block = block.unwrap();
                fs::copy(block.path(), scratch.path(&copy).join(block.file_name())).unwrap();
            }
            let said = scratch.run(&["verdict", &copy, "--require", REQUIRE]);
            let (said, warned) = (String::from_utf8(said.stdout), String::from_utf8(said.stderr));
            let (said, warned) = (said.unwrap(), warned.unwrap());
            assert!(said.contains("90 first flights") && warned.is_empty(), "{said}{warned}");
        }
        // In any letters, but not if two columns are called so.
        let rows: String =
            (0..450).map(|run| format!("{run},{},{},1.0,ok,{run},a\n", run / 5, run % 5)).collect();
        for (names, first) in [
            (["run", "vehicle", "flight"], true),
            (["RUN", "VEHICLE", "FLIGHT"], true),
            (["Run", " vehicle", "Flight "], true),
            (["run", "vehicle", "sortie"], false),
            (["run", "craft", "flight"], false),
            (["shot", "Vehicle", "flight"], false),
        ] {
            for other in ["other", "VEHICLE"] {
                let names = names.join(",");
                fs::write(
                    scratch.path("letters.csv"),
                    format!("{names},y,status,{other},model\n{rows}"),
                )
                .unwrap();
                let said =
                    scratch.run(&["verdict", "letters.csv", "--require", "y <= 5 in 90 % at 90 %"]);
                let (said, warned) =
                    (String::from_utf8(said.stdout), String::from_utf8(said.stderr));
                let (said, warned) = (said.unwrap(), warned.unwrap());
                // One that is spelled as in a study is that one.
                let spelled = names.contains("vehicle");
                let first = first && (other == "other" || spelled);
                if ["RUN,VEHICLE,FLIGHT", "run,craft,flight"].contains(&&*names)
                    && other == "VEHICLE"
                {
                    continue;
                }
                assert_eq!(
                    said.contains("90 first flights"),
                    first,
                    "{names} {other}: {said}{warned}"
                );
                assert_eq!(
                    warned.contains("not all three columns"),
                    !first,
                    "{names} {other}: {said}{warned}"
                );
            }
        }
        // Some rows of the table, in which no vehicle is whole, tell nothing of whole vehicles.
        let all = |of: u32| (0..450).filter(move |run| of == 1 || run % of != 2);
        for (of, told) in [(1, true), (5, false)] {
            let rows: String =
                all(of).map(|run| format!("{run},{},{},1.0\n", run / 5, run % 5)).collect();
            fs::write(scratch.path("part.csv"), format!("run,vehicle,flight,y\n{rows}")).unwrap();
            let part = scratch.run(&["verdict", "part.csv", "--require", "y <= 5 in 90 % at 90 %"]);
            let said = String::from_utf8(part.stdout).unwrap();
            assert_eq!(said.contains("\n  vehicles     90 of 90 keep it"), told, "{said}");
            assert_eq!(said.contains("\n  vehicles "), told, "{said}");
        }
        // A vehicle of which the first flight is missing is left out, with a word.
        let rows = "run,vehicle,flight,y\n1,0,1,0.1\n3,1,0,0.2\n7,2,1,0.3\n9,3,0,0.3\n";
        fs::write(scratch.path("begun.csv"), rows).unwrap();
        let begun = scratch.run(&["verdict", "begun.csv", "--require", "y <= 5 in 50 % at 50 %"]);
        assert!(String::from_utf8(begun.stdout).unwrap().contains("2 first flights"));
        let warned = String::from_utf8(begun.stderr).unwrap();
        assert!(warned.contains("flight 0, of 2 of 4 vehicles is not in the table"), "{warned}");
        // A table of these columns that lost the run.
        let rows: String = (0..450).map(|run| format!("{},{},1.0\n", run / 5, run % 5)).collect();
        fs::write(scratch.path("lost.csv"), format!("vehicle,flight,nutation_deg\n{rows}"))
            .unwrap();
        let lost =
            scratch.run(&["verdict", "lost.csv", "--require", "nutation_deg <= 5 in 90 % at 90 %"]);
        assert!(String::from_utf8(lost.stdout).unwrap().contains("450 runs"));
        let warned = String::from_utf8(lost.stderr).unwrap();
        assert!(
            warned.contains("not all three columns run, vehicle and flight")
                && warned.starts_with("warning: "),
            "{warned}"
        );
        // Or the flight, under names of its own.
        let rows: String = (0..450).map(|run| format!("{run},{},1.0\n", run / 5)).collect();
        fs::write(scratch.path("lost.csv"), format!("run,Vehicle,y\n{rows}")).unwrap();
        let lost = scratch.run(&["verdict", "lost.csv", "--require", "y <= 5 in 90 % at 90 %"]);
        let warned = String::from_utf8(lost.stderr).unwrap();
        assert!(warned.contains("has the column Vehicle, but not all three columns"), "{warned}");
        // Or one in which they do not belong together: vehicles from 1, and a cell that is blank.
        let from_1 = |run: u32| format!("{run},{},{},1.0\n", run / 5 + 1, run % 5 + 1);
        let blank = |run: u32| match run {
            37 => "37,,2,1.0\n".to_owned(),
            _ => format!("{run},{},{},1.0\n", run / 5, run % 5),
        };
        for row in [&from_1 as &dyn Fn(u32) -> String, &blank] {
            let rows: String = (0..450).map(row).collect();
            fs::write(scratch.path("odd.csv"), format!("run,vehicle,flight,y\n{rows}")).unwrap();
            let odd = scratch.run(&["verdict", "odd.csv", "--require", "y <= 5 in 90 % at 90 %"]);
            assert!(String::from_utf8(odd.stdout).unwrap().contains("450 runs"));
            let warned = String::from_utf8(odd.stderr).unwrap();
            assert!(
                warned.starts_with("warning: ") && warned.contains("do not belong together"),
                "{warned}"
            );
        }
        let block = format!("{name}/runs/proposed/000000000-000000449.parquet");
        fs::copy(scratch.path(&block), scratch.path("alone.parquet")).unwrap();
        let said =
            scratch.run(&["verdict", "alone.parquet", "--json", "--require", REQUIRE]).stdout;
        let said: Value = serde_json::from_slice(&said).unwrap();
        let judged = &said["requirements"][0];
        assert_eq!(judged["counted"], 90, "{name}");
        for worst in judged["worst"].as_array().unwrap() {
            assert_eq!(worst["run"].as_u64().unwrap() % 5, 0);
        }
    }
}

/// The rows of failed runs are not those of all runs; fewer columns are.
#[test]
fn rows_of_failed_runs_alone_are_refused() {
    let scratch = Scratch::new();
    let text = scenario("runs = 300");
    let text = text.replace("[payload.dispersion]", "[payload.dispersion]\nmass_percent = 60");
    fs::write(scratch.path("it.toml"), text).unwrap();
    for (out, flags) in [
        ("all", &[][..]),
        ("failed", &["--rows", "failed"]),
        ("some", &["--rows", "failed", "--columns", "nutation_deg"]),
    ] {
        scratch.run(&[&["study", "--scenario", "it.toml", "--out", out], flags].concat());
        let folder = format!("{out}/runs/proposed");
        for table in [folder.clone(), format!("{folder}/000000000-000000299.parquet")] {
            if out == "all" {
                same_as_study(&scratch, &table, out, 1);
                continue;
            }
            let said = scratch.done(&["verdict", &table, "--require", REQUIRE], 2);
            let start = format!(
                "error: {table}: {out}/campaign.json says that the study kept rows = \"failed\""
            );
            assert!(said.starts_with(&start) && said.contains("summary.json"), "{said}");
        }
    }
    // Without any, no file is there to say so.
    scratch.run(&["study", "--scenario", "it.toml", "--out", "none", "--rows", "none"]);
    for table in ["none", "none/runs", "none/runs/proposed"] {
        let said = scratch.done(&["verdict", table, "--require", REQUIRE], 2);
        assert!(
            said.contains("the study in none kept rows = \"none\"")
                && said.contains("summary.json"),
            "{said}"
        );
    }
}

/// A table of a study whose files are not those that were written says nothing of all runs, and one file of it nothing of
/// itself if it is another.
#[test]
fn tables_with_lost_or_damaged_runs_are_refused() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario("runs = 17000")).unwrap();
    scratch.run(&["study", "--scenario", "it.toml", "--out", "it"]);
    let folder = "it/runs/proposed";
    let block = format!("{folder}/000016384-000016999.parquet");
    same_as_study(&scratch, folder, "it", 0);
    let whole = fs::read(scratch.path(&block)).unwrap();
    let refused = |tables: &[&str], word: &str| {
        for table in tables {
            let said = scratch.done(&["verdict", table, "--require", REQUIRE], 2);
            assert!(said.contains("it/campaign.json says that") && said.contains(word), "{said}");
        }
    };
    fs::remove_file(scratch.path(&block)).unwrap();
    refused(&[folder], "1 of its 2 files is gone or not as it was written");
    // A bit in a page of data, which is not where a reader of Parquet would notice.
    let mut damaged = whole.clone();
    damaged[whole.len() / 3] ^= 1;
    fs::write(scratch.path(&block), damaged).unwrap();
    refused(&[folder, &block], "is gone or not as it was written");
    fs::write(scratch.path(&block), &whole).unwrap();
    fs::write(scratch.path(&format!("{folder}/more.parquet")), &whole).unwrap();
    let said = scratch.done(&["verdict", folder, "--require", REQUIRE], 2);
    assert!(said.contains("more.parquet"), "{said}");
    fs::remove_file(scratch.path(&format!("{folder}/more.parquet"))).unwrap();
    same_as_study(&scratch, folder, "it", 0);
}

/// A run that stands twice in a folder is refused with both files, whatever the copy is called.
#[test]
fn copies_of_runs_are_refused() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario("runs = 100")).unwrap();
    scratch.run(&["study", "--scenario", "it.toml", "--out", "it"]);
    let folder = "it/runs/proposed";
    let block = format!("{folder}/000000000-000000099.parquet");
    for copy in ["copy.parquet", "000000000-000000099 (1).parquet", "100-199.parquet"] {
        let copy = format!("{folder}/{copy}");
        fs::copy(scratch.path(&block), scratch.path(&copy)).unwrap();
        let said = scratch.done(&["verdict", folder, "--require", REQUIRE], 2);
        let both = "both have the run 0 of the model \"proposed\"";
        assert!(said.contains(both) && said.contains(&block) && said.contains(&copy), "{said}");
        fs::remove_file(scratch.path(&copy)).unwrap();
    }
    same_as_study(&scratch, folder, "it", 0);
}

/// The other forms in which draws are written are refused by name.
#[test]
fn tables_in_other_forms_are_named() {
    let scratch = Scratch::new();
    for (extension, form) in [("jsonl", "it is JSON"), ("npy", "it is an array of NumPy")] {
        let file = format!("draws.{extension}");
        scratch.done(&["draw", "-n", "3", "-o", &file], 0);
        let said = scratch.done(&["verdict", &file, "--require", "i11 <= 5 in 90 % at 90 %"], 2);
        assert!(said.contains(&format!("{file}: {form}, and CSV and Parquet are read")), "{said}");
    }
    for (start, form) in
        [(&b"PK\x03\x04\x14\0"[..], ".xlsx"), (b"\x1f\x8b\x08\0", "compressed (gzip)")]
    {
        fs::write(scratch.path("runs.csv"), start).unwrap();
        let said = scratch.done(&["verdict", "runs.csv", "--require", "y <= 5 in 90 % at 90 %"], 2);
        assert!(said.contains(form) && said.contains("CSV and Parquet are read"), "{said}");
    }
}

/// The page names every key of the JSON.
#[test]
fn keys_stand_on_the_page() {
    let page = include_str!("../../../docs/requirements.md");
    let scratch = Scratch::new();
    fs::write(scratch.path("y.csv"), "y\n1\n2\n3\n").unwrap();
    let requires = ["y <= 9 in 50 % at 50 %", "y <= 0 in 90 % at 90 %", "y <= 9 in 90 % at 90 %"];
    let each = requires.into_iter().flat_map(|require| ["--require", require]);
    let said = scratch
        .done(&["verdict", "y.csv", "--json"].into_iter().chain(each).collect::<Vec<_>>(), 1);
    let said: Value = serde_json::from_str(&said).unwrap();
    let judged = said["requirements"].as_array().unwrap();
    let verdicts: Vec<String> = judged
        .iter()
        .map(|judged| match &judged["verdict"] {
            Value::Object(decided) => decided.keys().next().unwrap().clone(),
            verdict => verdict.as_str().unwrap().to_owned(),
        })
        .collect();
    assert_eq!(verdicts, ["met", "not_met", "undecided"]);
    let keys = said.as_object().unwrap().keys().chain(judged[0].as_object().unwrap().keys());
    for key in keys.chain(&verdicts) {
        assert!(page.contains(&format!("`{key}`")), "{key}");
    }
}
