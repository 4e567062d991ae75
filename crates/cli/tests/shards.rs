//! Studies done in shards by several processes, asked for their status, and put together.

use std::{fs, process::Stdio};

use crate::scratch::{Scratch, content, done, files, one_model};

/// Three processes, one of which is killed: what is there is told at every time, a report is made of part of the runs, and
/// the study is the same to the byte as that of one process.
#[test]
fn processes_share_a_study() {
    let scratch = Scratch::new();
    // Two blocks of each of four models.
    let study = |out: &str, more: &[&str]| {
        let arguments = [&["study", "--runs", "17000", "--out", out], more].concat();
        scratch.command(&arguments)
    };
    done(study("whole", &[]), 0);

    let status = |code| done(scratch.command(&["status", "shared"]), code);
    let report = |code| done(scratch.command(&["report", "shared"]), code);
    assert!(status(2).contains("it holds no study"));
    let mut first = study("shared", &["--shard", "1/3"]).stdout(Stdio::null()).spawn().unwrap();
    let mut third = study("shared", &["--shard", "3/3"]).stdout(Stdio::null()).spawn().unwrap();
    third.kill().unwrap();
    third.wait().unwrap();
    assert!(first.wait().unwrap().success());

    let json = done(scratch.command(&["status", "shared", "--json"]), 1);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let sum = |list: &str, field: &str| {
        json[list]
            .as_array()
            .unwrap()
            .iter()
            .map(|model| model[field].as_u64().unwrap())
            .sum::<u64>()
    };
    assert_eq!(json["complete"], false);
    assert_eq!(sum("models", "finished") + sum("missing", "runs"), 4 * 17000);
    assert!(sum("models", "finished") >= 16384 * 2 + 616, "{json}");
    assert!(status(1).contains("These runs are missing:"));

    // Shard 1 has blocks 0, 3 and 6, of proposed, published and naive-matched, and 3 was killed before it had any.
    let refused = report(2);
    assert!(refused.contains("there are no runs of the model \"naive\" yet"), "{refused}");
    done(study("shared", &["--shard", "3/3"]), 0);
    let told = report(1);
    assert!(told.contains("missing: 616 of proposed (16384 to 16999)"), "{told}");
    let page = fs::read_to_string(scratch.path("shared/report.html")).unwrap();
    assert!(page.contains("Not all runs are done."), "the page says so");
    assert!(!scratch.path("shared/runs").exists(), "part of a study is not taken for all of it");

    // Whoever asks for something else is refused, and nothing is lost.
    assert!(done(study("shared", &["--seed", "5"]), 2).contains("seed is"));
    assert!(done(study("shared", &["--seed", "5", "--shard", "2/3"]), 2).contains("seed is"));
    for shard in ["0/3", "4/3", "1", "a/b"] {
        assert!(done(study("shared", &["--shard", shard]), 2).contains("is no shard"));
    }
    done(study("shared", &["--shard", "2/3", "--force"]), 2);

    done(study("shared", &["--shard", "2/3", "--threads", "1"]), 0);
    assert!(status(1).contains("All runs are done."));
    report(0);
    assert!(status(0).contains("put together"));
    assert!(content(&scratch.path("shared")) == content(&scratch.path("whole")));

    // Looking at it again changes nothing, and does nothing.
    let before = fs::metadata(scratch.path("shared/summary.json")).unwrap();
    done(study("shared", &[]), 0);
    done(study("shared", &["--shard", "1/3"]), 0);
    done(study("shared", &[]), 0);
    let after = fs::metadata(scratch.path("shared/summary.json")).unwrap();
    assert_eq!(before.modified().unwrap(), after.modified().unwrap());
    assert!(content(&scratch.path("shared")) == content(&scratch.path("whole")));
    // What is gone is made again.
    fs::remove_file(scratch.path("shared/report.html")).unwrap();
    done(study("shared", &[]), 0);
    assert!(content(&scratch.path("shared")) == content(&scratch.path("whole")));
}

/// The scenario of a half study that is damaged was told without its file.
#[test]
fn the_scenario_of_a_study_that_was_begun_is_named_if_it_is_damaged() {
    let scratch = Scratch::new();
    let study = ["study", "--runs", "20", "--out", "here", "--shard"];
    let done = |arguments: &[&str], code: i32| done(scratch.command(arguments), code);
    done(&[&study[..], &["1/2"]].concat(), 0);
    for text in ["", "name = 3", "runs"] {
        fs::write(scratch.path("here/.gyradius/campaign/mark"), text).unwrap();
        for verb in ["status", "report"] {
            let said = done(&[verb, "here"], 2);
            assert!(said.contains("here: the scenario that its study was begun with"), "{said}");
        }
    }
    done(&study[..study.len() - 1], 0);
    done(&["status", "here"], 0);
}

/// A complete study that is extended in shards, and reported on before all of them are done, keeps its runs.
#[test]
fn a_report_of_part_of_an_extension_keeps_what_is_complete() {
    let scratch = Scratch::new();
    let done = |arguments: &[&str], code: i32| done(scratch.command(arguments), code);
    done(&["study", "--runs", "300", "--out", "here"], 0);
    let complete = content(&scratch.path("here"));
    done(&["study", "--runs", "400", "--out", "here", "--shard", "1/2"], 0);
    for _ in 0..2 {
        assert!(done(&["report", "here"], 1).contains("missing: 100 of published (300 to 399)"));
        let now = content(&scratch.path("here"));
        for (path, bytes) in complete
            .iter()
            .filter(|(path, _)| path.starts_with("runs/") || *path == "campaign.json")
        {
            assert!(now.get(path) == Some(bytes), "{path}");
        }
        let status = done(&["status", "here", "--json"], 1);
        let status: serde_json::Value = serde_json::from_str(&status).unwrap();
        let finished =
            status["models"].as_array().unwrap().iter().map(|m| m["finished"].as_u64().unwrap());
        assert_eq!(finished.collect::<Vec<_>>(), [400, 300, 400, 300]);
    }
    let told = done(&["study", "--runs", "400", "--out", "here"], 0);
    assert!(told.contains("1400 of 1600 runs are finished already"), "{told}");
    done(&["study", "--runs", "300", "--out", "alone"], 0);
    done(&["study", "--runs", "400", "--out", "alone"], 0);
    assert!(content(&scratch.path("here")) == content(&scratch.path("alone")));
}

/// The last shard would decide for all: what is other is told, and what it is there and here.
#[test]
fn shards_keep_and_require_the_same() {
    let scratch = Scratch::new();
    let requirement = |limit: &str| {
        let of = "quantity = \"nutation_deg\"\nprobability = 0.9\nconfidence = 0.9";
        format!("{}\n[[requirements]]\nname = \"it\"\nat_most = {limit}\n{of}\n", one_model())
    };
    let shard = |text: String, shard: &str, more: &[&str], code| {
        fs::write(scratch.path("s.toml"), text).unwrap();
        let own = ["study", "--scenario", "s.toml", "--out", "here", "--shard", shard];
        let runs = if more.contains(&"--runs") { &[][..] } else { &["--runs", "600"] };
        scratch.done(&[&own[..], runs, more].concat(), code)
    };
    shard(requirement("3.0"), "1/2", &[], 0);
    for (text, more, expected) in [
        (requirement("2.0"), &[][..], "requirements[1].at_most is 3.0 there and 2.0 here"),
        (one_model(), &[], "is 3.0 there and not given here"),
        (requirement("3.0"), &["--rows", "failed"], "rows is not given there and \"failed\" here"),
        (requirement("3.0"), &["--columns", "nutation_deg"], "columns"),
        (requirement("3.0"), &["--runs", "700"], "runs is 600 there and 700 here"),
        (requirement("3.0"), &["--runs", "500"], "runs is 600 there and 500 here"),
    ] {
        let told = shard(text, "2/2", more, 2);
        assert!(told.contains(expected) && told.contains("all shards"), "{told}");
    }
    shard(requirement("3.0"), "2/2", &[], 0);
}

/// Files of the user beside a study that is not complete are in nobody's way, and stay as they are.
#[test]
fn files_of_the_user_stay_beside_a_study_that_is_begun() {
    let scratch = Scratch::new();
    fs::write(scratch.path("s.toml"), one_model()).unwrap();
    let study = |out: &str, more: &[&str], code| {
        let own = ["study", "--scenario", "s.toml", "--runs", "600", "--out", out];
        scratch.done(&[&own[..], more].concat(), code)
    };
    study("here", &["--shard", "1/2"], 0);
    let notes = scratch.path("here/notes.txt");
    fs::write(&notes, "mine").unwrap();
    study("here", &["--shard", "2/2"], 0);
    let told = study("here", &["--seed", "9"], 2);
    assert!(told.contains("already holds another study: seed is"), "{told}");
    study("here", &[], 0);
    assert_eq!(fs::read_to_string(&notes).unwrap(), "mine");
    fs::remove_file(&notes).unwrap();
    study("alone", &[], 0);
    assert!(content(&scratch.path("here")) == content(&scratch.path("alone")));
    // Where no study was begun, they are.
    fs::create_dir(scratch.path("other")).unwrap();
    fs::write(scratch.path("other/notes.txt"), "mine").unwrap();
    study("other", &["--shard", "1/2"], 2);
}

/// Runs that are in no folder `runs` yet are replayed and held against their blocks, whether nothing is put together, a part of the runs
/// or a smaller study; other runs are replayed alone. Another study that was begun beside one that is complete is not taken for it.
#[test]
fn runs_of_an_unfinished_study_are_replayed() {
    let scratch = Scratch::new();
    let done = |arguments: &[&str], code| scratch.done(arguments, code);
    let study = |runs: &str, more: &[&str]| {
        done(&[&["study", "--runs", runs, "--out", "it", "-q"], more].concat(), 0);
    };
    let replay = |run: &str, model: &str, code| {
        let arguments = ["replay", "it", "--run", run, "--model", model, "--out", "r", "--force"];
        done(&arguments, code)
    };
    let unfinished =
        "bit for bit, as in it/.gyradius/campaign/proposed/000000000-000000029.parquet";
    study("30", &["--shard", "1/2"]);
    assert!(replay("3", "proposed", 0).contains(unfinished));
    assert!(replay("3", "published", 0).contains("has not done this run yet"));
    assert!(replay("30", "proposed", 2).contains("from 0 to 29"));
    // A row that is changed is found.
    let block = scratch.path("it/.gyradius/campaign/proposed/000000000-000000029.parquet");
    let content = fs::read(&block).unwrap();
    let mut changed = content.clone();
    changed[2000..3000].iter_mut().for_each(|byte| *byte ^= 1);
    fs::write(&block, changed).unwrap();
    assert!(replay("3", "proposed", 2).contains("000000000-000000029.parquet"));
    fs::write(&block, content).unwrap();

    study("30", &[]);
    assert!(replay("3", "published", 0).contains("as in it/runs/published/"));
    study("40", &["--shard", "1/2"]);
    for _ in 0..2 {
        assert!(replay("3", "published", 0).contains("as in it/runs/published/"));
        let told = replay("35", "proposed", 0);
        assert!(told.contains("campaign/proposed/000000030-000000039.parquet"), "{told}");
        assert!(replay("35", "published", 0).contains("has not done this run yet"));
        // The second time, those that are there are put together.
        done(&["report", "it"], 1);
    }

    // Another study that was begun in its place, such as with --force.
    study("40", &[]);
    done(&["study", "--runs", "40", "--seed", "9", "--out", "other", "--shard", "1/2"], 0);
    let campaign = |of: &str| scratch.path(&format!("{of}/.gyradius/campaign"));
    fs::rename(campaign("other"), campaign("it")).unwrap();
    assert!(replay("35", "proposed", 0).contains("as in it/runs/proposed/"));
    fs::remove_file(scratch.path("it/scenario.toml")).unwrap();
    replay("35", "proposed", 2);
}

/// A shard that is refused, or has no runs, leaves a folder as it was: of a finished study, empty, or none.
#[test]
fn what_a_shard_does_not_do_binds_nobody() {
    let scratch = Scratch::new();
    scratch.done(&["study", "--runs", "40", "--out", "done", "-q"], 0);
    let before = files(&scratch.path("done"));
    let too_many = ["study", "--runs", "1e12", "--shard", "1/2", "-q", "--out", "done"];
    let told = scratch.run(&too_many);
    assert_eq!(told.status.code(), Some(2), "{told:?}");
    assert_eq!(files(&scratch.path("done")), before);
    scratch.done(&["status", "done"], 0);
    let simulator = "name = \"none\"\nruns = 600\n[simulation]\ncommand = [\"no-such-program\"]\n[[simulation.outputs]]\nname = \"x\"\n\
                     [[quantities]]\nname = \"q\"\nlaw = { law = \"normal\", mean = 0.0, sigma = 1.0 }\n";
    fs::write(scratch.path("none.toml"), simulator).unwrap();
    fs::create_dir(scratch.path("empty")).unwrap();
    for out in ["empty", "new"] {
        let share = ["study", "--scenario", "none.toml", "--shard", "1/2", "-q", "--out", out];
        let told = scratch.run(&share);
        assert_eq!(told.status.code(), Some(2), "{told:?}");
        assert_eq!(scratch.path(out).exists(), out == "empty");
    }
    assert_eq!(fs::read_dir(scratch.path("empty")).unwrap().count(), 0);
    scratch.done(&["study", "--runs", "40", "--shard", "90/100", "--out", "new", "-q"], 0);
    scratch
        .done(&["study", "--runs", "40", "--seed", "5", "--shard", "1/1", "--out", "new", "-q"], 0);
}

/// Shards that were done into two folders are one study once the files of both are in one, if they are of the same study: runs of
/// another one are missing, and are done again.
#[test]
fn blocks_that_were_copied_count_if_they_are_of_the_same_study() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), one_model()).unwrap();
    let study = |out: &str, more: &[&str]| {
        let all =
            [&["study", "--scenario", "it.toml", "--runs", "17000", "-q", "--out", out], more]
                .concat();
        assert_eq!(scratch.run(&all).status.code(), Some(0), "{all:?}");
    };
    study("whole", &[]);
    for (seed, code) in [("2003", 0), ("6", 1)] {
        let (here, there) = (format!("here-{seed}"), format!("there-{seed}"));
        study(&here, &["--shard", "1/2"]);
        study(&there, &["--shard", "2/2", "--seed", seed]);
        let area = |of: &str| scratch.path(&format!("{of}/.gyradius/campaign"));
        for (name, bytes) in files(&area(&there)) {
            let place = area(&here).join(name);
            if !place.exists() {
                fs::create_dir_all(place.parent().unwrap()).unwrap();
                fs::write(place, bytes).unwrap();
            }
        }
        let told = scratch.done(&["report", &here], code);
        assert_eq!(told.contains("missing"), code == 1, "{told}");
        study(&here, &[]);
        assert_eq!(content(&scratch.path(&here)), content(&scratch.path("whole")), "{seed}");
    }
}
