//! Failed runs of a simulator, done again.

use std::{
    fs,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use super::{SimulatorSummary, folder, scenario, uniform};
use crate::{CampaignError, Notice, Options, Status, Study, StudyError};

/// Runs that failed for a reason that is gone are done again, and no other: of a study that is complete, and of one that was
/// stopped. Until the new blocks are there, the old ones count.
#[test]
fn failed_runs_are_done_again() {
    // While there is a file, runs fail whose quantity is below 0.4. It counts what it is asked.
    const SOMETIMES: &str = r#"
while read -r line; do
    echo . >> asked
    x=${line#*'"x":'}; x=${x%%[,\}]*}
    case $x in
        0.[123]*) [ -e busy ] && echo '{"error":"no licence"}' || echo "{\"outputs\":{\"y\":$x}}" ;;
        *) echo "{\"outputs\":{\"y\":$x}}" ;;
    esac
done
"#;
    let folder = folder();
    fs::write(folder.path().join("answer.sh"), SOMETIMES).unwrap();
    let scenario = scenario(&uniform(), folder.path()).with_runs(700).unwrap();
    let options = |name: &str| Options {
        out: Some(folder.path().join(name)),
        threads: Some(2),
        ..Options::default()
    };
    let asked = || fs::read(folder.path().join("asked")).map_or(0, |asked| asked.len() / 2);
    let rows = |study: &Study<SimulatorSummary>| {
        let table = study.runs()[0].table().unwrap();
        table.rows().map(|row| format!("{row:?}")).collect::<Vec<_>>()
    };
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
        let failed = status.models()[0].failed();
        assert!(failed > 100, "{failed}");

        // It is stopped in the middle of what is done again: what was there still counts.
        stop.store(true, Ordering::Relaxed);
        let again = Options { retry_failed: true, ..first.clone() };
        let error = scenario.study(&again, &|_| {}, &|_| {}).unwrap_err();
        assert!(matches!(error, StudyError::Campaign(CampaignError::Stopped)), "{error}");
        let status = Status::read(&folder.path().join(&name)).unwrap();
        assert_eq!((status.models()[0].failed(), status.is_complete()), (failed, !stopped));

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
        let all = Status::read(&folder.path().join(&name)).unwrap().models()[0].failed();

        fs::remove_file(&busy).unwrap();
        let before = asked();
        let study = scenario.study(&again, &|_| {}, &say).unwrap();
        assert_eq!((asked() - before) as u64, all);
        assert_eq!(said.lock().unwrap()[1], (all, 0));
        assert_eq!(rows(&study), rows(&well));
        let page = fs::read_to_string(study.folder().join("report.html")).unwrap();
        let told = format!("{} runs that had failed were done again", failed + all);
        assert!(page.contains(&told), "{told}");
        // Nothing is left to be done again.
        scenario.study(&again, &|_| {}, &say).unwrap();
        assert_eq!(said.lock().unwrap().len(), 2);
        assert_eq!((asked() - before) as u64, all);
        let status = Status::read(study.folder()).unwrap();
        assert!(status.is_complete() && status.models()[0].failed() == 0);
        assert!(!study.folder().join(".gyradius/campaign").exists());
    }
}
