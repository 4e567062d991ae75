//! Studies that keep only a part of their run tables.

use std::{collections::BTreeMap, fs, path::Path};

use crate::scratch::{Scratch, content, files, peck_2003};

/// The built-in study of light bodies, a few of which have no mass that is positive: their runs fail.
fn scenario() -> String {
    let text = peck_2003();
    let (head, rest) = text.split_once("[payload.dispersion]").unwrap();
    format!("{head}[payload.dispersion]\nmass_percent = 60\n{rest}")
}

/// Every file of a study but those of its runs and those that say what is kept of them.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = files(folder);
    files.retain(|name, _| name.starts_with("figures/") || name == "summary.json");
    let summary = files.get_mut("summary.json").unwrap();
    let mut told: serde_json::Value = serde_json::from_slice(summary).unwrap();
    // Of the scenario, which says what is kept.
    assert!(told.as_object_mut().unwrap().remove("fingerprint").is_some());
    *summary = told.to_string().into_bytes();
    files
}

fn runs(folder: &Path) -> Vec<String> {
    files(folder).into_keys().filter(|name| name.starts_with("runs/")).collect()
}

/// Whatever is kept, in one process or in shards: the results are those of the study that keeps all; the same command finds
/// it done; nobody goes on with it, and who begins anew by force has all.
#[test]
fn results_do_not_depend_on_what_is_kept() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario()).unwrap();
    let study = ["study", "--scenario", "it.toml", "--runs", "300"];
    let with = |more: &[&'static str]| [&study, more].concat();
    scratch.done(&with(&["--out", "whole"]), 0);
    let whole = results(&scratch.path("whole"));
    assert_eq!(runs(&scratch.path("whole")).len(), 4);

    for (i, flags) in [
        &["--rows", "none"][..],
        &["--rows", "failed"],
        &["--columns", "wobble_deg,payload_mass_kg"],
        &["--rows", "failed", "--columns", "payload_mass_kg"],
    ]
    .into_iter()
    .enumerate()
    {
        let part: &'static str = ["a", "b", "c", "d"][i];
        let place = scratch.path(part);
        let command = with(&[flags, &["--out", part]].concat());
        if i == 1 {
            // A study that kept all loses the rest.
            scratch.done(&with(&["--out", part]), 0);
        }
        if i == 3 {
            for shard in ["2/2", "1/2"] {
                scratch.done(&[&command[..], &["--shard", shard]].concat(), 0);
            }
            scratch.done(&["report", part], 0);
        }
        scratch.done(&command, 0);
        assert_eq!(results(&place), whole, "{flags:?}");
        assert_eq!(runs(&place).len(), if i == 0 { 0 } else { 4 }, "{flags:?}");
        let report = fs::read_to_string(place.join("report.md")).unwrap();
        assert!(report.contains("kept"), "{flags:?}");

        let before = files(&place);
        let same = |what: &str| assert_eq!(files(&place), before, "{flags:?} {what}");
        scratch.done(&command, 0);
        same("again");
        scratch.done(&[&command[..], &["--shard", "1/2"]].concat(), 0);
        same("a share of it");
        for more in [
            &["--runs", "301"][..],
            &["--rows", "all", "--columns", "status"],
            &["--runs", "301", "--shard", "1/3"],
            &["--retry-failed"],
        ] {
            let mut other = command.clone();
            if more[0] == "--runs" {
                other.retain(|word| !["--runs", "300"].contains(word));
            } else if more[0] == "--rows" {
                other = with(&["--out", part]);
            }
            let said = scratch.done(&[&other[..], more].concat(), 2);
            assert!(said.contains("was kept") && said.contains("--force"), "{said}");
            same("refused");
        }
        assert!(scratch.done(&["status", part], 0).contains("put together"), "{flags:?}");
        let replay = scratch.done(&["replay", part, "--run", "3", "--out", "r", "--force"], 0);
        let expected = if flags[0] == "--columns" {
            "bit for bit, in the columns that were kept, as in"
        } else {
            "did not keep the row"
        };
        assert!(replay.contains(expected), "{replay}");

        scratch.done(&with(&["--out", part, "--force"]), 0);
        assert_eq!(content(&place), content(&scratch.path("whole")), "{flags:?}");
    }
}

/// Of runs of which none failed, no file is kept, and a replay says so.
#[test]
fn nothing_is_kept_of_runs_that_did_not_fail() {
    let scratch = Scratch::new();
    scratch.done(&["study", "--runs", "20", "--rows", "failed", "--out", "it"], 0);
    assert_eq!(runs(&scratch.path("it")).len(), 0);
    let said = scratch.done(&["replay", "it", "--run", "3", "--out", "r"], 0);
    assert!(said.contains("did not keep the row"), "{said}");
    assert!(scratch.done(&["status", "it"], 0).contains("put together"));
}

/// A column that is not there is refused before the first run, and nothing is written.
#[test]
fn columns_that_are_not_there_are_refused() {
    let scratch = Scratch::new();
    let said = scratch.done(&["study", "--columns", "status,wobble", "--out", "it"], 2);
    assert!(said.contains("columns: \"wobble\"") && said.contains("wobble_deg"), "{said}");
    assert!(!scratch.path("it").exists());
    scratch.done(&["study", "--rows", "some"], 2);
}

/// Shards must keep the same, whoever begins; a damaged file of a study that was reduced is named; columns are the same in any order; a
/// finished study is not replaced by itself, and that is said.
#[test]
fn what_is_kept_is_agreed_upon() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), scenario()).unwrap();
    let study = ["study", "--scenario", "it.toml", "--runs", "60", "--out", "it"];
    let with = |more: &[&'static str]| [&study, more].concat();
    scratch.done(&with(&["--shard", "1/2", "--rows", "failed"]), 0);
    for other in [&["--shard", "2/2"][..], &["--shard", "2/2", "--rows", "none"]] {
        let said = scratch.done(&with(other), 2);
        assert!(said.contains("rows is \"failed\" there") && said.contains("all shards"), "{said}");
    }
    scratch.done(&with(&["--shard", "2/2", "--rows", "failed"]), 0);
    scratch.done(&["report", "it"], 0);
    assert!(fs::read_to_string(scratch.path("it/campaign.json")).unwrap().contains("\"failed\""));

    scratch.done(&with(&["--force", "--columns", "wobble_deg,status,cone_deg,wobble_deg"]), 0);
    let before = files(&scratch.path("it"));
    scratch.done(&with(&["--columns", "cone_deg,wobble_deg"]), 0);
    // A finished study is not reduced by a shard.
    scratch.done(&with(&["--shard", "1/2"]), 2);
    let said = scratch.done(&with(&["--columns", "cone_deg,wobble_deg", "--quiet"]), 0);
    assert_eq!(said, "");
    let file = runs(&scratch.path("it")).remove(0);
    let content = fs::read(scratch.path("it").join(&file)).unwrap();
    let mut other = content.clone();
    other[100] ^= 1;
    fs::write(scratch.path("it").join(&file), other).unwrap();
    for more in [&["--columns", "cone_deg,wobble_deg"][..], &["--force"]] {
        let said = scratch.done(&with(more), 2);
        assert!(said.contains(&file), "{said}");
    }
    fs::write(scratch.path("it").join(&file), content).unwrap();
    assert_eq!(files(&scratch.path("it")), before);

    scratch.done(&with(&["--force"]), 0);
    let before = files(&scratch.path("it"));
    let said = scratch.done(&with(&["--force"]), 0);
    assert!(said.contains("finished already"), "{said}");
    let said =
        scratch.done(&["study", "--scenario", "it.toml", "--runs", "70", "--out", "it", "-q"], 0);
    assert_eq!(said, "");
    assert_ne!(files(&scratch.path("it")), before);
}
