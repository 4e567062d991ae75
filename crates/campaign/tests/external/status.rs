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
