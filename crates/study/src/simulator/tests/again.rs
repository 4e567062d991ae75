//! Runs of a simulator, done again: those that failed, and one that is held against its row.

use std::{
    fs,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use super::{SimulatorReplay, SimulatorScenario, folder, scenario, uniform};
use crate::{
    CampaignError, Kept, Notice, Options, ReplayError, Rows, Status, StudyError, Which,
    read_only::complete_study,
};

/// Runs that failed for a reason that is gone are done again, and no other: of a study that is complete, and of one that was
/// stopped. Until the new blocks are there, the old ones count.
#[test]
fn failed_runs_are_done_again() {
    // While there is a file, runs fail whose quantity is below 0.4. It counts what it is asked.
    const SOMETIMES: &str = r#"
while read -r line; do
    echo . >> asked
    x=${line##*'"x":'}; x=${x%%[,\}]*}
    case $x in
        0.[123]*) [ -e busy ] && echo '{"error":"no licence"}' || echo "{\"outputs\":{\"y\":$x}}" ;;
        *) echo "{\"outputs\":{\"y\":$x}}" ;;
    esac
done
"#;
    let folder = folder();
    fs::write(folder.path().join("answer.sh"), SOMETIMES).unwrap();
    let scenario = scenario(&uniform(), folder.path()).with_runs(700).unwrap();
    let options =
        |name: &str| Options { threads: Some(2), ..Options::to(folder.path().join(name)) };
    let asked = || fs::read(folder.path().join("asked")).map_or(0, |asked| asked.len() / 2);
    let well = scenario.study(&options("well"), &|_| {}, &|_| {}).unwrap();
    let busy = folder.path().join("busy");
    for stopped in [false, true] {
        let name = format!("stopped-{stopped}");
        fs::write(&busy, "").unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let first = Options { stop: Some(Arc::clone(&stop)), threads: Some(1), ..options(&name) };
        let progress = |done: u64| stop.store(stopped && done > 530, Ordering::Relaxed);
        let ended = scenario.study(&first, &progress, &|_| {});
        assert_eq!(ended.is_err(), stopped);
        let status = Status::read(&folder.path().join(&name)).unwrap();
        let failed = status.models[0].failed;
        assert!(failed > 100, "{failed}");

        // It is stopped in the middle of what is done again: what was there still counts.
        stop.store(true, Ordering::Relaxed);
        let again = Options { retry_failed: true, ..first.clone() };
        let error = scenario.study(&again, &|_| {}, &|_| {}).unwrap_err();
        assert!(matches!(error, StudyError::Campaign(CampaignError::Stopped)), "{error}");
        let status = Status::read(&folder.path().join(&name)).unwrap();
        assert_eq!((status.models[0].failed, status.complete), (failed, !stopped));

        // Still busy: they fail again, and are told so.
        let said = std::sync::Mutex::new(Vec::new());
        let say = |notice: Notice| {
            if let Notice::Again(again) = notice {
                said.lock().unwrap().push((again.runs, again.failed));
            }
        };
        let again = Options { retry_failed: true, ..options(&name) };
        scenario.study(&again, &|_| {}, &say).unwrap();
        assert_eq!(said.lock().unwrap()[..], [(failed, failed)]);
        let all = Status::read(&folder.path().join(&name)).unwrap().models[0].failed;

        fs::remove_file(&busy).unwrap();
        let before = asked();
        let study = scenario.study(&again, &|_| {}, &say).unwrap();
        assert_eq!((asked() - before) as u64, all);
        assert_eq!(said.lock().unwrap()[1], (all, 0));
        assert_eq!(study.rows(), well.rows());
        let page = fs::read_to_string(study.folder().join("report.html")).unwrap();
        let told = format!("{} runs that had failed were done again", failed + all);
        assert!(page.contains(&told), "{told}");
        // Nothing is left to be done again.
        scenario.study(&again, &|_| {}, &say).unwrap();
        assert_eq!(said.lock().unwrap().len(), 2);
        assert_eq!((asked() - before) as u64, all);
        let status = Status::read(study.folder()).unwrap();
        assert!(status.complete && status.models[0].failed == 0);
        assert!(!study.folder().join(".gyradius/campaign").exists());
    }
}

/// If all runs of the study went well and some that were done for the indices alone did not, those indices are found again.
#[test]
fn indices_with_failed_runs_are_found_again() {
    // While there is a file, runs fail after the 300th, which are those for the indices.
    const LATE: &str = r#"
while read -r line; do
    echo . >> asked
    x=${line##*'"x":'}; x=${x%%[,\}]*}
    if [ -e busy ] && [ $(($(wc -l < asked) % 7)) = 0 ] && [ $(wc -l < asked) -gt 320 ]; then
        echo '{"error":"no licence"}'
    else
        echo "{\"outputs\":{\"y\":$x}}"
    fi
done
"#;
    let folder = folder();
    fs::write(folder.path().join("answer.sh"), LATE).unwrap();
    fs::write(folder.path().join("asked"), "").unwrap();
    let text = format!("drivers = 100\n{}", uniform());
    let scenario = scenario(&text, folder.path()).with_runs(300).unwrap();
    let options = Options { threads: Some(1), ..Options::to(folder.path().join("out")) };
    let busy = folder.path().join("busy");
    fs::write(&busy, "").unwrap();
    let drivers = |options: &Options| {
        let study = scenario.study(options, &|_| {}, &|_| {}).unwrap();
        let failed = Status::read(study.folder()).unwrap().models[0].failed;
        assert_eq!(failed, 0);
        study.summary().head.drivers[0].clone()
    };
    let first = drivers(&options);
    assert!(first.failed > 5, "{}", first.failed);
    fs::remove_file(&busy).unwrap();
    // Not unless they are to be done again.
    assert_eq!(drivers(&options), first);
    let again = Options { retry_failed: true, ..options.clone() };
    let second = drivers(&again);
    assert_eq!(second.failed, 0);
    let asked = || fs::read(folder.path().join("asked")).unwrap().len();
    let before = asked();
    assert_eq!(drivers(&again), second);
    assert_eq!(asked(), before);
}

/// A run is held against what the study kept of its row, and an import that was changed is found wherever it shows.
#[test]
fn one_run_is_held_against_its_row() {
    // What it reads besides the file that the command names. Runs fail whose quantity is between 0.4 and 0.7.
    const IMPORTS: &str = r#"
. ./mod.sh
while read -r line; do
    x=${line##*'"x":'}; x=${x%%[,\}]*}
    case $x in
        0.[456]*) echo "{\"error\":\"$WORDS $x\"}" ;;
        $BAD) echo '{"error":"bad"}' ;;
        *) echo "{\"outputs\":{\"y\":$SIGN$x}}" ;;
    esac
done
"#;
    let folder = folder();
    let import = |sign: &str, words: &str, bad: &str| {
        let text = format!("SIGN='{sign}'\nWORDS='{words}'\nBAD='{bad}'\n");
        fs::write(folder.path().join("mod.sh"), text).unwrap();
    };
    import("", "too large:", "none");
    fs::write(folder.path().join("answer.sh"), IMPORTS).unwrap();
    let scenario = scenario(&uniform(), folder.path());
    let columns = |names: &[&str]| Some(names.iter().map(|name| (*name).to_owned()).collect());
    let studied = |rows: Rows, kept: Option<Vec<String>>, name: &str| {
        let scenario = scenario.clone().with_kept(&Kept::new(rows, kept));
        let out = folder.path().join(name);
        let options = Options { threads: Some(2), ..Options::to(out.clone()) };
        scenario.study(&options, &|_| {}, &|_| {}).unwrap();
        out
    };
    let all = studied(Rows::All, None, "all");
    let drawn = studied(Rows::All, columns(&["x", "status_kind"]), "drawn");
    let failed = studied(Rows::Failed, None, "failed");
    let none = studied(Rows::None, None, "none");
    let runs = [0, 1, 2, 3, 4, 5, 6, 7, 250, 255, 256, 257, 258, 299];
    let held = |folder: &std::path::Path, run: u64| {
        let mut replay = SimulatorReplay::new(&scenario, None, run).unwrap();
        let held = replay.hold_against(folder);
        (replay.told().outputs.clone(), held, replay.to_string())
    };
    const SAME: &str = "the same, bit for bit, as in ";
    const IN_KEPT: &str = "the same, bit for bit, in the columns that were kept, as in ";
    const NOT_KEPT: &str = "the study did not keep the row of this run";
    let mut failures = 0;
    for run in runs {
        for (folder, fails, well) in [
            (&all, SAME, SAME),
            (&drawn, IN_KEPT, IN_KEPT),
            (&failed, SAME, NOT_KEPT),
            (&none, NOT_KEPT, NOT_KEPT),
        ] {
            let (outputs, held, page) = held(folder, run);
            held.unwrap();
            failures += usize::from(outputs.is_err());
            let line = page.lines().nth(1).unwrap();
            let expected = if outputs.is_err() { fails } else { well };
            assert!(line.starts_with(expected), "{run}: {page}");
        }
    }
    assert!((4..52).contains(&failures), "{failures}");

    let differs = |folder: &std::path::Path, run: u64, found: [&str; 3]| {
        let (_, held, page) = held(folder, run);
        let error = held.unwrap_err();
        let ReplayError::Differs { column, table, replayed, .. } = &error else {
            panic!("{error}")
        };
        let [name, was, is] = found;
        assert!(column == name && table.contains(was) && replayed.contains(is), "{error}");
        assert!(error.to_string().contains("a file that it imports"), "{error}");
        assert!(page.contains("\nsent: {") && !page.contains(SAME), "{page}");
    };
    let is_failed = |run: u64| held(&none, run).0.is_err();
    let (fails, well): (Vec<u64>, Vec<u64>) = runs.into_iter().partition(|run| is_failed(*run));
    for run in &well {
        import("-", "too large:", "none");
        differs(&all, *run, ["y", "0.", "-0."]);
        // What is kept is the same.
        held(&drawn, *run).1.unwrap();
        held(&none, *run).1.unwrap();
        import("", "too large:", "0.*");
        differs(&all, *run, ["status", "ok", "bad"]);
        differs(&drawn, *run, ["status", "ok", "bad"]);
        differs(&failed, *run, ["the row", "did not fail", "bad"]);
    }
    for run in &fails {
        import("", "so large:", "none");
        differs(&all, *run, ["status", "too large: 0.", "so large: 0."]);
        differs(&failed, *run, ["status", "too large: 0.", "so large: 0."]);
        differs(&drawn, *run, ["status", "too large: 0.", "so large: 0."]);
    }

    // What was never done is held against nothing, and a folder without tables is told of.
    let other = scenario.clone().with_runs(301).unwrap();
    import("", "too large:", "none");
    let mut beyond = SimulatorReplay::new(&other, None, 300).unwrap();
    beyond.hold_against(&all).unwrap();
    assert!(beyond.to_string().contains("has not done this run yet"), "{beyond}");
    assert!(matches!(beyond.hold_against(folder.path()), Err(ReplayError::Manifest { .. })));

    // Without the file that the command names, it is that of which one is told, and not of the hash of nothing.
    fs::remove_file(folder.path().join("answer.sh")).unwrap();
    let gone = SimulatorReplay::new(&scenario, None, 0).unwrap_err().to_string();
    assert!(
        gone.contains("\"answer.sh\", which the command names, is not there any more"),
        "{gone}"
    );
    let without = SimulatorScenario::from_toml(&uniform(), folder.path()).unwrap();
    let options = Options::to(all);
    let refused = without.study(&options, &|_| {}, &|_| {}).unwrap_err().to_string();
    let expected = "simulation.files_sha256.answer.sh is \"";
    assert!(refused.contains(expected) && refused.contains("not given here"), "{refused}");
    // Nor are vehicles counted where there are none.
    let flight = Which::Flight { vehicle: 1, flight: 2 };
    let refused = SimulatorReplay::new(&without, None, flight).unwrap_err().to_string();
    let expected = "vehicle 1, flight 2: the scenario has no vehicles: name the run by its number";
    assert_eq!(refused, expected);
}

/// A file of the command that changes while runs are done ends the campaign: no run of another simulator is kept, the same study goes
/// on once the file is as it was, and to write the same again is no change.
#[test]
fn a_simulator_that_changes_meanwhile_ends_the_campaign() {
    const OTHER: &str =
        "while read -r line; do echo '{\"outputs\":{\"y\":-1}}'; done # much else\n";
    let folder = folder();
    let script = folder.path().join("answer.sh");
    let before = fs::read(&script).unwrap();
    let scenario = scenario(&uniform(), folder.path()).with_runs(900).unwrap();
    let options =
        |name: &str| Options { threads: Some(2), ..Options::to(folder.path().join(name)) };
    let one_at_a_time = std::sync::Mutex::new(());
    let put = |content: &[u8]| {
        let _one = one_at_a_time.lock().unwrap();
        fs::write(folder.path().join("new"), content).unwrap();
        fs::rename(folder.path().join("new"), &script).unwrap();
    };
    let well = scenario.study(&options("well"), &|_| put(&before), &|_| {}).unwrap();
    let changing = |done: u64| {
        if done > 300 {
            put(OTHER.as_bytes());
        }
    };
    let error = scenario.study(&options("changed"), &changing, &|_| {}).unwrap_err();
    assert!(matches!(error, StudyError::Campaign(CampaignError::Fault { .. })), "{error}");
    let said = error.to_string();
    assert!(
        said.contains("answer.sh\", which the command") && said.contains("was changed"),
        "{said}"
    );
    let status = Status::read(&folder.path().join("changed"));
    assert!(status.as_ref().map_or(true, |status| !status.complete), "{status:?}");
    // As it stands, it is not the simulator of these runs.
    let refused = scenario.study(&options("changed"), &|_| {}, &|_| {}).unwrap_err().to_string();
    assert!(refused.contains("was changed after"), "{refused}");
    put(&before);
    let after = scenario.study(&options("changed"), &|_| {}, &|_| {}).unwrap();
    assert_eq!(after.rows(), well.rows());
}

/// A complete study is read where nothing can be written: the same rows and the same numbers, unless something of it is not as it was.
#[test]
fn a_complete_study_is_read_without_writing() {
    let folder = folder();
    let scenario = scenario(&uniform(), folder.path()).with_runs(700).unwrap();
    for rows in [Rows::All, Rows::None] {
        let scenario = scenario.clone().with_kept(&Kept::new(rows, None));
        let options = Options::to(folder.path().join(format!("{rows:?}")));
        let read = || complete_study(&scenario, &options).unwrap();
        assert!(read().is_none());
        let study = scenario.study(&options, &|_| {}, &|_| {}).unwrap();
        let there = read().unwrap();
        assert_eq!(there.rows(), study.rows());
        assert_eq!(there.summary(), study.summary());
        let more = scenario.clone().with_runs(800).unwrap();
        assert!(complete_study(&more, &options).unwrap().is_none());
        let changed = study.folder().join(if rows == Rows::All {
            fs::read_dir(study.folder().join("runs/all")).unwrap().next().unwrap().unwrap().path()
        } else {
            study.folder().join("summary.json")
        });
        fs::write(&changed, "no more").unwrap();
        assert!(read().is_none());
    }
}
