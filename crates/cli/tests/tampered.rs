//! Studies whose files are not as they were written: every verb names the file that was changed, and tells none of its numbers.

use std::{fs, path::Path};

use crate::{
    scratch::files,
    simulator::{SCENARIO, scratch},
};

fn copy(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() {
            copy(&from, &to);
        } else {
            fs::copy(from, to).unwrap();
        }
    }
}

#[test]
fn every_verb_names_the_file_that_was_changed() {
    let scratch = scratch();
    let separation = ["study", "--runs", "40", "-q", "--out"];
    let simulator = ["study", "s.toml", "--runs", "40", "-q", "--out"];
    for (study, law) in [(&separation[..], "stiffness"), (&simulator, "uniform")] {
        let study_in = |out: &'static str| [study, &[out]].concat();
        let whole = scratch.path("whole");
        scratch.done(&study_in("whole"), 0);
        let scenario = fs::read_to_string(whole.join("scenario.toml")).unwrap();
        let summary = fs::read_to_string(whole.join("summary.json")).unwrap();
        let mean = summary.find("\"mean\": ").unwrap() + 8;
        let another = format!("{}7{}", &summary[..mean], &summary[mean..]);
        let cut = scenario[..scenario.find(law).unwrap()].to_owned();
        let [scenario_file, summary_file] = ["scenario.toml", "summary.json"];
        for (file, content) in [
            (scenario_file, Some(scenario.clone() + "# a remark\n")),
            (scenario_file, Some(scenario.replacen("seed = ", "seed = 1", 1))),
            (scenario_file, Some(cut)),
            (scenario_file, None),
            (summary_file, Some(another)),
            (summary_file, None),
        ] {
            copy(&whole, &scratch.path("it"));
            let path = scratch.path("it").join(file);
            match &content {
                Some(content) => fs::write(&path, content).unwrap(),
                None => fs::remove_file(&path).unwrap(),
            }
            let before = files(&scratch.path("it"));
            for (verb, code) in [
                (&["report", "it"][..], 2),
                (&["report", "it", "--out", "elsewhere"], 2),
                (&["replay", "it", "--run", "3", "--out", "replayed"][..], 2),
                (&["status", "it"], if file == summary_file { 1 } else { 2 }),
                (&study_in("it"), 2),
            ] {
                let replays_simulator = verb[0] == "replay" && study == &simulator[..];
                let verb = if replays_simulator { &verb[..4] } else { verb };
                let is_mended = verb[0] == "study" && file == summary_file && content.is_none();
                let said = scratch.done(verb, if is_mended { 0 } else { code });
                assert!(is_mended || said.contains(file), "{verb:?}: {said}");
                assert!(is_mended || before == files(&scratch.path("it")), "{verb:?}");
                assert!(!scratch.path("elsewhere").exists() && !scratch.path("replayed").exists());
            }
            if file == summary_file && content.is_none() {
                assert_eq!(files(&whole), files(&scratch.path("it")));
            }
            fs::remove_dir_all(scratch.path("it")).unwrap();
        }
        fs::remove_dir_all(whole).unwrap();
    }
}

/// The runs of a study that keeps none, left by a command that was killed after it had put the study in place: the same command
/// removes them, and a study of which they are not leaves them alone.
#[test]
fn runs_that_are_not_kept_do_not_stay() {
    let scratch = scratch();
    let none = SCENARIO.replace("runs = 4000", "runs = 40\nrows = \"none\"");
    fs::write(scratch.path("none.toml"), &none).unwrap();
    fs::write(scratch.path("more.toml"), none.replace("seed = 5", "seed = 9")).unwrap();
    let study = |scenario, out| scratch.done(&["study", scenario, "-q", "--out", out], 0);
    study("none.toml", "it");
    let whole = files(&scratch.path("it"));
    for (scenario, out, are_its_own) in [("none.toml", "own", true), ("more.toml", "other", false)]
    {
        scratch.done(&["study", scenario, "-q", "--out", out, "--shard", "1/1"], 0);
        let left = Path::new(".gyradius/campaign");
        copy(&scratch.path(out).join(left), &scratch.path("it").join(left));
        study("none.toml", "it");
        assert_eq!(files(&scratch.path("it")) == whole, are_its_own, "{scenario}");
    }
}

/// A folder of the program's own that was moved away, with a link in its place.
#[cfg(unix)]
#[test]
fn nothing_is_written_through_links_in_the_folder() {
    let scratch = scratch();
    let study = ["study", "s.toml", "--runs", "600", "-q", "--out", "it"];
    let shard = |shard: &'static str| [&study[..], &["--shard", shard]].concat();
    let [blocks, elsewhere] = ["it/.gyradius/campaign/all", "elsewhere"].map(|at| scratch.path(at));
    scratch.done(&shard("1/2"), 0);
    fs::rename(&blocks, &elsewhere).unwrap();
    std::os::unix::fs::symlink(&elsewhere, &blocks).unwrap();
    let own = elsewhere.join("000000256-000000511.parquet");
    fs::write(&own, "my own").unwrap();
    let before = files(&elsewhere);
    for again in [shard("2/2"), study.to_vec()] {
        let said = scratch.done(&again, 2);
        assert!(said.contains(".gyradius/campaign/all in it is a link"), "{said}");
        assert!(files(&elsewhere) == before);
    }

    // Damaged blocks are not put elsewhere either.
    fs::remove_file(&own).unwrap();
    fs::remove_file(&blocks).unwrap();
    fs::rename(&elsewhere, &blocks).unwrap();
    fs::create_dir(&elsewhere).unwrap();
    let damaged = scratch.path("it/.gyradius/damaged");
    std::os::unix::fs::symlink(&elsewhere, &damaged).unwrap();
    let block = files(&blocks).into_keys().next().unwrap();
    fs::write(blocks.join(&block), "cut").unwrap();
    let said = scratch.done(&study, 2);
    assert!(said.contains(".gyradius/damaged in it is a link"), "{said}");
    assert_eq!(fs::read(blocks.join(&block)).unwrap(), b"cut");
    fs::remove_file(&damaged).unwrap();
    scratch.done(&study, 0);
    assert!(files(&elsewhere).is_empty());
}
