//! How a simulator ended that is started for each run.

use std::collections::BTreeSet;

use super::{simulator, table};

/// One that is started for each run fails a run by its status, whatever it has answered.
#[cfg(unix)]
#[test]
fn a_status_counts_whatever_was_answered() {
    let simulator = simulator("answer $run; exit 3", true, 20.0);
    let table = table(&simulator, &BTreeSet::from([1]), 3, 1);
    let failures: Vec<_> = table.failures().map(|(_, failure)| failure.to_string()).collect();
    assert_eq!(failures.len(), 1, "{failures:?}");
    assert!(failures[0].contains("the simulator ended with exit status: 3"), "{failures:?}");
    assert!(!failures[0].contains("before it answered"), "{failures:?}");
}

/// An infinite number stays in the row whatever becomes of the process after it was answered, one for each run as one for many runs.
#[cfg(unix)]
#[test]
fn infinite_numbers_stay_whatever_the_status() {
    for (code, per_run) in
        ["0", "1", "139"].into_iter().flat_map(|code| [false, true].map(|per_run| (code, per_run)))
    {
        for (answered, infinite) in [
            (r#"{"outputs":{"y":Infinity,"seed":2}}"#, Some(f64::INFINITY)),
            (r#"{"outputs":{"y":-1e999}}"#, Some(f64::NEG_INFINITY)),
            (r#"{"outputs":{"y":"inf","seed":null},"error":"diverged"}"#, Some(f64::INFINITY)),
            (r#"{"outputs":{"y":3,"seed":NaN}}"#, None),
            (r#"{"outputs":{"y":Infinity,"#, None),
            ("", None),
        ] {
            let simulator = simulator(&format!("echo '{answered}'; exit {code}"), per_run, 20.0);
            let table = table(&simulator, &BTreeSet::from([1]), 3, 1);
            let numbers = table.numbers("y").unwrap();
            assert_eq!(table.failures().map(|(run, _)| run).collect::<Vec<_>>(), [1]);
            assert_eq!(numbers.get(1), infinite, "{answered} {code} {per_run}");
        }
    }
}
