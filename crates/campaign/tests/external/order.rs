//! What a simulator writes before it reads a run, or while it does, and what it reads slowly.

use gyradius_campaign::{Program, Simulator, run, threads};
use std::{collections::BTreeSet, path::Path};

use super::{assert_rows, simulation, simulator, table};

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

/// An answer that is written ahead, at once or long after the one before it, is never that of the next run; and of what is
/// written before the first run, it is told what it is.
#[test]
fn answers_written_ahead_do_not_count() {
    for pause in ["", "sleep 0.001;", "sleep 0.02;", "sleep 0.2;"] {
        for ahead in [r#""run":%s,"#, ""] {
            let number = if ahead.is_empty() { "" } else { "$((run + 1))" };
            let ahead = format!(r#"'{{{ahead}"outputs":{{"y":99,"seed":98}}}}\n' {number}"#);
            let simulator = simulator(&format!("answer $run; {pause} printf {ahead}"), false, 60.0);
            let places = BTreeSet::from([1, 4, 5, 8]);
            for _ in 0..5 {
                let table = table(&simulator, &places, 10, 1);
                for (place, row) in table.rows().enumerate() {
                    let number = |column| table.numbers(column).unwrap().get(place);
                    match row.failure() {
                        None => assert_eq!(number("y"), number("x"), "{pause} run {}", row.run()),
                        Some(failure) => {
                            assert_eq!(failure.kind(), "more than one answer", "{pause}");
                            assert!(places.contains(&row.run()), "{pause} run {}", row.run());
                        }
                    }
                }
            }
        }
    }
    let banner = "echo 'Welcome to sim 3.1'; while read -r line; do echo '{\"outputs\":{\"y\":1,\"seed\":2}}'; done";
    for pause in ["", "sleep 0.02;"] {
        let words = ["sh", "-c", &format!("{pause} {banner}")].map(str::to_owned);
        let simulator = Simulator::start(Program::new(&words, Path::new("/")).unwrap()).unwrap();
        let table = table(&simulator, &BTreeSet::new(), 3, 1);
        let failures: Vec<_> = table.failures().map(|(_, failure)| failure).collect();
        assert_eq!(failures.len(), 3);
        for failure in failures {
            assert_eq!(failure.kind(), "output before the run was read");
            assert!(
                failure.message().contains("`Welcome to sim 3.1`; messages belong"),
                "{failure:?}"
            );
        }
    }
}

/// Who reads a request piece by piece, or what stands before its end at once, is waited for as any other.
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
