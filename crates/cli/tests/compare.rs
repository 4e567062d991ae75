//! `gyradius compare` as a user meets it.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};
use tempfile::TempDir;

const QUICK: [&str; 7] = ["compare", "--draws", "30", "--separations", "3", "--levels", "5,50"];

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gyradius"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn quick(folder: &Path, more: &[&str]) -> Output {
    run(folder, &[&QUICK[..], more].concat())
}

/// Runs what must be refused: exit code 2, nothing on standard output, nothing written, a message.
fn refused(folder: &Path, more: &[&str]) -> String {
    let before = fs::read_dir(folder).unwrap().count();
    let output = run(folder, &[&["compare"], more].concat());
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty() && !message.contains("panicked"), "{message}");
    assert_eq!(fs::read_dir(folder).unwrap().count(), before, "nothing is written");
    message
}

#[test]
fn it_tells_and_writes_nothing_unasked() {
    let scratch = tempfile::tempdir().unwrap();
    let output = quick(scratch.path(), &[]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && output.stderr.is_empty());
    for word in ["slender-stage", "panel", "bus", "wishart", "inertia ratio", "Matched"] {
        assert!(text.contains(word), "{word}");
    }
    assert_eq!(fs::read_dir(scratch.path()).unwrap().count(), 0);
    let help = run(scratch.path(), &["compare", "--help"]);
    assert!(String::from_utf8(help.stdout).unwrap().contains("Examples:"));
}

#[test]
fn bad_input_is_named() {
    let scratch = tempfile::tempdir().unwrap();
    for (more, words) in [
        (&["--body", "teapot"][..], "\"teapot\": it must be payload, slender-stage"),
        (&["--body", "1,1,9"], "no body has this inertia"),
        (&["--body", "-1,1,1"], "no body has this inertia"),
        (&["--body", "nan,1,1"], "NaN"),
        (&["--body", "1e300,1e300,1e300"], "largest moment"),
        (&["--levels", "0"], "levels: 0 %"),
        (&["--levels", "-5"], "levels: -5 %"),
        (&["--levels", "200"], "levels: 200 %"),
        (&["--levels", "200%"], "levels: 200 %"),
        (&["--levels", "ten"], "it must be a number, in percent of the largest moment"),
        (&["--levels", "1,,2"], "and a comma parts it from the next"),
        (&["--models", "naive"], "\"naive\": it must be one of principal, entrywise"),
        (&["--models", "wishart,wishart"], "there twice"),
        (&["--draws", "1"], "draws: 1"),
        (&["--draws", "100", "--separations", "101"], "separations: 101"),
        (&["--seed", "18446744073709551615"], "seed"),
        (&["--seed", "18446744073709551616"], "it must be at most 18446744073709551615"),
        (&["--seed", "-1"], "it must be a whole number and not negative"),
        (&["--threads", "0"], "threads: 0"),
        (&["--scenario", "nowhere.toml"], "cannot read nowhere.toml"),
        (&["--scenario", "nowhere.toml", "--out", "x"], "cannot read nowhere.toml"),
        (&["--body", "teapot", "--out", "x"], "teapot"),
        (&["--format", "xml"], "xml"),
        (&["--force"], "--out"),
    ] {
        let message = refused(scratch.path(), more);
        assert!(message.contains(words), "{more:?}: {message}");
    }
}

#[test]
fn the_folder_is_whole_and_others_are_left_alone() {
    let scratch: TempDir = tempfile::tempdir().unwrap();
    let here = scratch.path();
    let body = ["--body", "panel", "--out", "report"];
    let output = quick(here, &body);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8(output.stdout).unwrap().contains("page: report/compare.html"));
    let mut names: Vec<String> = fs::read_dir(here.join("report"))
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [".gyradius", "compare.csv", "compare.html", "compare.json", "compare.md", "figures"]
    );
    assert!(here.join("report/figures/compare-unrealizable.svg").is_file());
    let page = fs::read_to_string(here.join("report/compare.html")).unwrap();
    let own = |link: &str| link.starts_with('#') || link.starts_with("figures/");
    assert!(!page.contains("src=") && page.split("href=\"").skip(1).all(own), "self-contained");
    let text = fs::read_to_string(here.join("report/compare.md")).unwrap();
    assert!(text.contains("](figures/compare-wobble.svg)") && !text.contains('<'), "{text}");

    // The same again is welcome, another is not, and by force replaces no file of others.
    fs::write(here.join("report/notes.txt"), "mine").unwrap();
    fs::write(here.join("report/figures/mine.svg"), "mine").unwrap();
    let before = fs::read(here.join("report/compare.json")).unwrap();
    assert!(quick(here, &body).status.success());
    assert_eq!(fs::read(here.join("report/compare.json")).unwrap(), before);
    let other = [&body[..], &["--seed", "8"]].concat();
    let output = quick(here, &other);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("another comparison"));
    assert_eq!(fs::read(here.join("report/compare.json")).unwrap(), before);
    assert!(quick(here, &[&other[..], &["--force"]].concat()).status.success());
    assert_ne!(fs::read(here.join("report/compare.json")).unwrap(), before);
    for file in ["notes.txt", "figures/mine.svg"] {
        assert_eq!(fs::read_to_string(here.join("report").join(file)).unwrap(), "mine");
    }

    // Neither does it touch a study, nor a study it.
    assert!(run(here, &["study", "--runs", "5", "--out", "study"]).status.success());
    let report = fs::read(here.join("study/report.html")).unwrap();
    let into = ["--body", "panel", "--out", "study"];
    assert_eq!(quick(here, &into).status.code(), Some(2));
    assert!(quick(here, &[&into[..], &["--force"]].concat()).status.success());
    assert_eq!(fs::read(here.join("study/report.html")).unwrap(), report);
    assert!(here.join("study/figures/figure-models.svg").is_file());

    // A scenario that a study wrote is a source of bodies.
    let scenario = ["--scenario", "study/scenario.toml", "--body", "stage", "--format", "csv"];
    let output = quick(here, &scenario);
    let csv = String::from_utf8(output.stdout).unwrap();
    assert!(csv.starts_with("body,level_percent,") && csv.contains("\nstage,5,"), "{csv}");
    let json = quick(here, &["--body", "5,4,3", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["settings"]["draws"], 30);
}
