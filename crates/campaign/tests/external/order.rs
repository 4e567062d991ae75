//! Requests that are long, or are read slowly, and who answers before they are read.

use gyradius_campaign::{Program, Simulator, run, threads};
use std::{collections::BTreeSet, path::Path};

use super::{assert_rows, simulation, simulator};

/// Requests that are longer than a pipe is deep arrive whole.
#[test]
fn long_requests_arrive() {
    let simulator = simulator("", false, 60.0);
    let simulation = simulation(&simulator, BTreeSet::new(), 10_000);
    let table = run(&simulation, "any", 3, &threads(Some(2)).unwrap(), &|_| {}).unwrap();
    assert_rows(&table, &BTreeSet::new(), "ok", "long");
    // Who answers before it has read them is not taken at its word.
    let early = r#"while :; do echo '{"outputs":{"y":1,"seed":2}}'; sleep 1000; done"#;
    let early = Program::new(&["sh".into(), "-c".into(), early.into()], Path::new("/")).unwrap();
    let early = Simulator::start(early).unwrap();
    let told = self::simulation(&early, BTreeSet::new(), 10_000).replay(0);
    assert_eq!(told.outputs.unwrap_err().kind(), "output before the run was read");
}

/// Who reads a request piece by piece is waited for as any other.
#[test]
fn slow_readers_are_waited_for() {
    const SLOW: &str = r#"
import os, time
line = b""
while True:
    piece = os.read(0, SIZE)
    if not piece:
        break
    line += piece
    time.sleep(PAUSE)
    if line.endswith(b"}\n"):
        time.sleep(PAUSE)
        os.write(1, b'{"outputs":{"y":1,"seed":2}}\n')
        line = b""
        time.sleep(PAUSE)
"#;
    let there = std::process::Command::new("python3").arg("--version").output();
    if !there.is_ok_and(|output| output.status.success()) {
        return;
    }
    for (size, pause, more) in [("40", "0.001", 0), ("100000", "0.0", 10_000), ("7", "0", 0)] {
        let script = SLOW.replace("SIZE", size).replace("PAUSE", pause);
        let words = ["python3", "-c", &script].map(str::to_owned);
        let simulator = Simulator::start(Program::new(&words, Path::new("/")).unwrap()).unwrap();
        let simulation = simulation(&simulator, BTreeSet::new(), more);
        let table = run(&simulation, "any", 5, &threads(Some(2)).unwrap(), &|_| {}).unwrap();
        assert_eq!(table.values("y"), Some(vec![1.0; 5]), "{size}");
    }
}
