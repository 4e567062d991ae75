//! Studies that are killed and stopped: while they run, and while they replace another.

use std::{
    fs,
    process::{Command, Stdio},
};

use crate::scratch::{Scratch, content, done};

/// Killed as soon as its journal says that files are being replaced: the next command, of whatever kind,
/// finds one whole study, and the user's files are as they were. (Every single step is tried in
/// `gyradius-study`, without processes.)
#[test]
fn one_whole_study_survives_a_kill() {
    let scratch = tempfile::tempdir().unwrap();
    let gyradius = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gyradius"));
        command.current_dir(scratch.path()).args(arguments);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command
    };
    let study = |runs: &str| {
        gyradius(&["study", "--out", "here", "--force", "--threads", "1", "--runs", runs])
    };
    assert!(study("5").status().unwrap().success());
    let here = scratch.path().join("here");
    let mine = ["figures/figure-mine.svg", ".lock", ".draft-1/new", "runs/notes.txt"];
    for name in mine {
        fs::create_dir_all(here.join(name).parent().unwrap()).unwrap();
        fs::write(here.join(name), "mine").unwrap();
    }
    let text = |name: &str| fs::read_to_string(here.join(name));
    for round in 0..6 {
        let runs = ["6", "5"][round % 2];
        let mut child = study(runs).spawn().unwrap();
        while child.try_wait().unwrap().is_none() {
            let journal = text(".gyradius/journal").unwrap_or_default();
            if journal.contains("\"replace\"") {
                // Later in each round.
                std::thread::sleep(std::time::Duration::from_micros(300 * round as u64));
                break;
            }
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let next = match round {
            0 => gyradius(&["replay", "here", "--run", "4", "--out", "replay", "--force"]),
            1 => study("5"),
            2 => gyradius(&[
                "replay",
                "here/scenario.toml",
                "--run",
                "4",
                "--out",
                "replay",
                "--force",
            ]),
            // A scenario holds bodies.
            3 => gyradius(&["check", "here/scenario.toml"]),
            4 => gyradius(&["check", "."]),
            _ => gyradius(&["study", "--scenario", "here/scenario.toml", "--out", "here"]),
        }
        .output()
        .unwrap();
        assert!(next.status.success(), "{round}: {}", String::from_utf8_lossy(&next.stderr));
        // The study that is there is the same as if it had never been otherwise.
        let runs = if text("scenario.toml").unwrap().contains("runs = 6") { "6" } else { "5" };
        let said: serde_json::Value = serde_json::from_str(&text("summary.json").unwrap()).unwrap();
        assert_eq!(said["runs_per_model"].to_string(), runs, "{round}");
        let again = gyradius(&["replay", "here", "--run", "0", "--out", "replay", "--force"]);
        assert!({ again }.status().unwrap().success(), "{round}");
        for name in mine {
            assert_eq!(text(name).unwrap(), "mine", "{round}: {name}");
        }
        assert!(!here.join(".gyradius/journal").exists(), "{round}");
    }
}

/// Killed, interrupted and terminated as soon as another block is finished: no block that was finished is done again,
/// and at the end there is what a study that nobody disturbed leaves, byte by byte.
#[test]
fn a_study_goes_on_where_it_stopped() {
    let scratch = tempfile::tempdir().unwrap();
    let study = |out: &str, runs: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gyradius"));
        command.current_dir(scratch.path()).args(["study", "--out", out, "--runs", runs]);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command
    };
    let record = || {
        let path = scratch.path().join("here/.gyradius/campaign/record");
        let text = fs::read_to_string(path).unwrap_or_default();
        text.lines().filter(|line| line.ends_with('}')).map(str::to_owned).collect::<Vec<_>>()
    };
    let mut known: Vec<String> = Vec::new();
    for (signal, code) in [("KILL", None), ("INT", Some(130)), ("TERM", Some(143))] {
        let mut child = study("here", "17000").spawn().unwrap();
        while record().len() <= known.len() {
            assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        let id = child.id().to_string();
        assert!(Command::new("kill").args([format!("-{signal}"), id]).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), code, "{signal}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(said.contains("the same command goes on"), code.is_some(), "{said}");
        let now = record();
        assert!(now.len() > known.len() && now.starts_with(&known), "{signal}");
        known = now;
    }
    // Another seed does not go on with them.
    let other = study("here", "17000").args(["--seed", "1"]).output().unwrap();
    let said = String::from_utf8(other.stderr).unwrap();
    assert!(
        other.status.code() == Some(2) && said.contains("seed is 2003 there and 1 here"),
        "{said}"
    );

    let last = study("here", "17000").output().unwrap();
    let said = String::from_utf8(last.stderr).unwrap();
    assert!(last.status.success() && said.contains("finished already; going on"), "{said}");
    assert!(study("there", "17000").status().unwrap().success());
    let (here, there) = (scratch.path().join("here"), scratch.path().join("there"));
    let blocks = ["000000000-000016383", "000016384-000016999"].map(|name| {
        ["proposed", "published", "naive", "naive-matched"]
            .map(|model| format!("runs/{model}/{name}.parquet"))
    });
    for name in ["summary.json", "campaign.json", "report.html"]
        .map(str::to_owned)
        .iter()
        .chain(blocks.as_flattened())
    {
        assert!(
            fs::read(here.join(name)).unwrap() == fs::read(there.join(name)).unwrap(),
            "{name}"
        );
    }

    // A block that is changed and one that is gone are named, put aside and done again; more runs are added to those that
    // are there.
    let [first, second] = [&blocks[0][0], &blocks[1][3]];
    let mut bytes = fs::read(here.join(first)).unwrap();
    bytes[1000] ^= 1;
    fs::write(here.join(first), &bytes).unwrap();
    fs::remove_file(here.join(second)).unwrap();
    let again = study("here", "17100").output().unwrap();
    let said = String::from_utf8(again.stderr).unwrap();
    assert!(
        again.status.success() && said.contains(&format!("{first} is not as it was written")),
        "{said}"
    );
    assert!(
        said.contains(&format!("{second} is gone")) && said.contains(" of 68400 runs"),
        "{said}"
    );
    assert!(fs::read(here.join(first)).unwrap() == fs::read(there.join(first)).unwrap());
    let aside = here.join(".gyradius/damaged/proposed-000000000-000016383.parquet.1");
    assert!(fs::read(aside).unwrap() == bytes);
    assert!(here.join("runs/naive/000017000-000017099.parquet").is_file());
}

/// A file that would grow beyond `ulimit -f` is told of as one that a full disk does not take is, by every verb that writes, and the
/// same command goes on.
#[test]
fn a_limit_of_the_size_of_files_is_told() {
    let scratch = Scratch::new();
    let limited = |arguments: &str| {
        let mut command = Command::new("sh");
        let line = format!("ulimit -f 60; exec \"$0\" {arguments}");
        command.current_dir(scratch.folder()).args(["-c", &line, env!("CARGO_BIN_EXE_gyradius")]);
        command
    };
    let told = done(limited("study --runs 400 --out here"), 2);
    assert!(told.contains("runs/") && told.contains("cannot be written"), "{told}");
    let told = done(limited("draw -n 1000 -o draws.csv"), 2);
    assert!(told.contains("draws.csv") && !scratch.path("draws.csv").exists(), "{told}");
    for out in ["here", "there"] {
        scratch.done(&["study", "--runs", "400", "--out", out], 0);
    }
    assert!(content(&scratch.path("here")) == content(&scratch.path("there")));
}

/// The study that is there stays the one of the folder until what is to replace it is done, and is told of, reported and replayed.
#[cfg(unix)]
#[test]
fn the_study_that_is_to_be_replaced_is_still_reported() {
    let scratch = crate::simulator::scratch();
    let study = ["study", "s.toml", "--runs", "4000", "-q", "--out", "it", "--seed"];
    scratch.done(&[&study[..], &["1"]].concat(), 0);
    let study_of = || {
        let mut files = content(&scratch.path("it"));
        files.retain(|name, _| !name.starts_with(".gyradius"));
        files
    };
    let before = study_of();
    let replace = [&study[..], &["2", "--force", "--threads", "1"]].concat();
    let mut child = scratch.command(&replace).stderr(Stdio::null()).spawn().unwrap();
    while !scratch.path("it/.gyradius/campaign/all").exists() {
        assert!(child.try_wait().unwrap().is_none());
    }
    child.kill().unwrap();
    child.wait().unwrap();
    for (verb, code) in [
        (&["status", "it"][..], 0),
        (&["report", "it"], 0),
        (&["report", "it", "--out", "elsewhere"], 0),
        (&["study", "s.toml", "--runs", "4000", "--out", "it", "--seed", "1"], 0),
        (&["replay", "it", "--run", "7", "--out", "replayed"], 0),
    ] {
        let said = scratch.done(verb, code);
        let is_told = said.contains("the folder also holds runs of another study");
        assert!(
            is_told && said.contains("seed is 2 there and 1 here") || verb[0] == "replay",
            "{said}"
        );
        assert!(study_of() == before, "{verb:?}");
    }
    scratch.done(&replace, 0);
    assert!(!scratch.done(&["status", "it"], 0).contains("another study"));
    scratch.done(&[&study[..], &["2"]].concat(), 0);
}
