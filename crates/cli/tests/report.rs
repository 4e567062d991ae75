//! `gyradius report`: the same bytes from the folder alone, and nothing touched that is not its own.

use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Command, Output},
};

use crate::scratch::{Scratch, files};

fn gyradius(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gyradius"));
    command.args(arguments).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A study with outlines, dispersed quantities, failures and a comparison; one that is all failures; one
/// run, of which hardly a number can be told.
fn studies(scratch: &Path) -> Vec<String> {
    let out = |name: &str| scratch.join(name).to_str().unwrap().to_owned();
    let paper = out("paper");
    assert!(gyradius(&["study", "--runs", "40", "--out", &paper], scratch).status.success());
    let text = fs::read_to_string(scratch.join("paper/scenario.toml")).unwrap();
    let full = text.replacen(
        "[payload]\n",
        "[clearance]\npayload = [{ points_m = [[0.0, 0.0, -0.6]] }]\n\
         stage = [{ points_m = [[0.0, 0.0, 0.6]] }]\n[payload]\n",
        1,
    );
    let second = full.match_indices("[[springs]]").nth(1).unwrap().0;
    let full = format!(
        "{}[springs.dispersion]\nfailure_probability = 0.3\n\n{}",
        &full[..second],
        &full[second..]
    );
    let failing = text.replace("horizon_s = 60.0", "horizon_s = 0.01");
    assert_ne!(failing, text);
    let mut folders = vec![paper];
    for (name, text, runs) in [("full", full, "30"), ("failing", failing, "5"), ("one", text, "1")]
    {
        let scenario = out(&format!("{name}.toml"));
        fs::write(&scenario, text).unwrap();
        let arguments = [
            "study",
            "--scenario",
            &scenario,
            "--runs",
            runs,
            "--out",
            &out(name),
            "--max-failed",
            "1",
        ];
        let study = gyradius(&arguments, scratch);
        assert!(study.status.success(), "{}", said(&study));
        folders.push(out(name));
    }
    folders
}

#[test]
fn a_report_is_made_again_to_the_byte() {
    let scratch = tempfile::tempdir().unwrap();
    for folder in studies(scratch.path()) {
        let place = Path::new(&folder);
        let before = files(place);
        assert!(gyradius(&["report", &folder], scratch.path()).status.success());
        assert_eq!(files(place), before, "{folder}");
        // Without what it makes, and without the run tables.
        for gone in ["figures", "runs"] {
            fs::remove_dir_all(place.join(gone)).unwrap();
        }
        for page in ["report.html", "report.md"] {
            fs::remove_file(place.join(page)).unwrap();
        }
        fs::write(place.join("notes.txt"), "mine").unwrap();
        let again = gyradius(&["report", &folder], scratch.path());
        assert!(again.status.success(), "{}", said(&again));
        let mut after = files(place);
        assert_eq!(after.remove("notes.txt").unwrap(), b"mine");
        let kept: BTreeMap<_, _> =
            before.into_iter().filter(|(name, _)| !name.starts_with("runs/")).collect();
        assert_eq!(after, kept, "{folder}");
        // Elsewhere, from the two files alone.
        let two = scratch.path().join("two");
        fs::create_dir_all(&two).unwrap();
        for name in ["scenario.toml", "summary.json"] {
            fs::copy(place.join(name), two.join(name)).unwrap();
        }
        let elsewhere = format!("{folder}-report");
        let arguments = ["report", two.to_str().unwrap(), "--out", &elsewhere];
        assert!(gyradius(&arguments, scratch.path()).status.success());
        assert!(Path::new(&elsewhere).join("report.md").is_file());
        for (name, content) in files(Path::new(&elsewhere)) {
            assert!(name.starts_with(".gyradius/") || after[&name] == content, "{folder}: {name}");
        }
    }
}

/// Whoever says where the report goes anyway gets it there, however the folder is written.
#[cfg(unix)]
#[test]
fn the_folder_of_the_study_can_be_named_for_its_report() {
    let scratch = tempfile::tempdir().unwrap();
    let gyradius = |arguments: &[&str]| gyradius(arguments, scratch.path());
    let study = ["study", "--runs", "20", "--out", "n"];
    assert!(gyradius(&study).status.success());
    std::os::unix::fs::symlink("n", scratch.path().join("link")).unwrap();
    let whole = scratch.path().join("n").to_str().unwrap().to_owned();
    let before = files(Path::new(&whole));
    for out in ["n", "./n/", "n/figures/..", "link", &whole] {
        for force in [&[][..], &["--force"]] {
            fs::remove_file(scratch.path().join("n/report.html")).unwrap();
            let report = gyradius(&[&["report", "n", "--out", out], force].concat());
            assert!(report.status.success(), "{out} {force:?}: {}", said(&report));
            assert_eq!(files(Path::new(&whole)), before, "{out} {force:?}");
        }
    }
    // One whose runs are not all there.
    let more = ["study", "--runs", "30", "--out", "n", "--shard", "1/2"];
    assert!(gyradius(&more).status.success());
    let report = gyradius(&["report", "n", "--out", "link"]);
    assert_eq!(report.status.code(), Some(1), "{}", said(&report));
    assert!(fs::read_to_string(scratch.path().join("n/report.md")).unwrap().contains("missing"));
}

#[test]
fn what_was_changed_is_not_replaced() {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("study");
    let name = folder.to_str().unwrap();
    assert!(gyradius(&["study", "--runs", "8", "--out", name], scratch.path()).status.success());
    let written: Vec<String> =
        files(&folder).into_keys().filter(|name| !name.starts_with(".gyradius/")).collect();
    assert!(written.len() > 5);
    for file in written {
        let path = folder.join(&file);
        let content = fs::read(&path).unwrap();
        fs::write(&path, "mine").unwrap();
        let before = files(&folder);
        let refused = gyradius(&["report", name], scratch.path());
        assert_eq!(refused.status.code(), Some(2), "{file}");
        assert!(said(&refused).contains(&file), "{file}: {}", said(&refused));
        assert_eq!(files(&folder), before, "{file}");
        fs::write(&path, content).unwrap();
    }
    // A file of the user's in the place of a figure that was deleted.
    let figure = folder.join("figures/figure-models.svg");
    fs::remove_file(&figure).unwrap();
    fs::create_dir(&figure).unwrap();
    let refused = gyradius(&["report", name], scratch.path());
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("figure-models.svg"), "{}", said(&refused));
    fs::remove_dir(&figure).unwrap();
    // A study that replaces the one whose report was made again knows all of its files.
    assert!(gyradius(&["report", name], scratch.path()).status.success());
    let arguments = ["study", "--runs", "9", "--out", name, "--force"];
    assert!(gyradius(&arguments, scratch.path()).status.success());
}

/// The short flags are those of `draw`.
#[test]
fn runs_and_folder_have_short_flags() {
    let scratch = Scratch::new();
    scratch.done(&["study", "-n", "6", "-o", "short", "-q"], 0);
    scratch.done(&["study", "--runs", "6", "--out", "long", "-q"], 0);
    scratch.done(&["report", "short", "-o", "again"], 0);
    let page = |folder: &str| fs::read(scratch.path(folder).join("report.html")).unwrap();
    assert_eq!(page("short"), page("long"));
    assert_eq!(page("short"), page("again"));
}

/// Of what is lost or changed, the truth is said: runs are missing, a file was changed, a file is no file any more.
#[test]
fn what_is_lost_or_changed_is_named() {
    let scratch = Scratch::new();
    let study = |name| scratch.done(&["study", "--runs", "20", "--out", name, "-q"], 0);
    study("lost");
    fs::remove_dir_all(scratch.path("lost/runs")).unwrap();
    assert!(scratch.done(&["status", "lost"], 1).contains("20 of proposed (0 to 19)"));
    study("lost");
    assert!(scratch.done(&["status", "lost"], 0).contains("put together"));
    fs::remove_file(scratch.path("lost/.gyradius/study.json")).unwrap();
    let said = scratch.done(&["status", "lost"], 2);
    assert!(
        said.contains(".gyradius/study.json, which tells what its files are, is not there"),
        "{said}"
    );

    study("changed");
    let summary = scratch.path("changed/summary.json");
    let mut text = fs::read_to_string(&summary).unwrap();
    text.push('\n');
    fs::write(&summary, text).unwrap();
    let said = scratch.done(&["report", "changed"], 2);
    assert!(said.contains("summary.json in it was changed after it was written"), "{said}");
}

/// What stands in the place of a block and is no file is not read: a link is not followed, and a pipe not waited for.
#[cfg(unix)]
#[test]
fn runs_are_not_held_against_links_and_pipes() {
    let scratch = Scratch::new();
    scratch.done(&["study", "--runs", "20", "--out", "linked", "-q"], 0);
    let block =
        fs::read_dir(scratch.path("linked/runs/naive")).unwrap().next().unwrap().unwrap().path();
    let moved = scratch.path("moved.parquet");
    fs::rename(&block, &moved).unwrap();
    std::os::unix::fs::symlink(&moved, &block).unwrap();
    let replay = ["replay", "linked", "--model", "naive", "--run", "3"];
    assert!(scratch.done(&replay, 2).contains("it is a link, a pipe or a device"));
    fs::remove_file(&block).unwrap();
    assert!(Command::new("mkfifo").arg(&block).status().unwrap().success());
    assert!(scratch.done(&replay, 2).contains("it is a link, a pipe or a device"));
}

#[test]
fn what_is_no_study_is_refused() {
    let scratch = tempfile::tempdir().unwrap();
    let empty = scratch.path().join("empty");
    fs::create_dir(&empty).unwrap();
    for (summary, problem) in [
        ("{}", "names no version"),
        ("", "is no summary"),
        ("[1, 2", "is no summary"),
        ("{\"gyradius_version\": \"0.0.1\", \"fingerprint\": \"\"}", "made by gyradius 0.0.1"),
    ] {
        fs::write(empty.join("scenario.toml"), "").unwrap();
        fs::write(empty.join("summary.json"), summary).unwrap();
        let refused = gyradius(&["report", "empty"], scratch.path());
        assert_eq!(refused.status.code(), Some(2));
        assert!(said(&refused).contains(problem), "{}", said(&refused));
    }
    for place in ["nowhere", "empty/scenario.toml"] {
        let refused = gyradius(&["report", place], scratch.path());
        assert_eq!(refused.status.code(), Some(2));
        assert!(said(&refused).contains("holds no study"), "{}", said(&refused));
    }
    assert_eq!(files(&empty).len(), 2);
}
