//! A study that is killed while it replaces another.

use std::{
    fs,
    process::{Command, Stdio},
};

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
