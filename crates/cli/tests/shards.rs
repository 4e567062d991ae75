//! Studies done in shards by several processes, asked for their status, and put together.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

fn gyradius(place: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gyradius"));
    command.current_dir(place).args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&[output.stdout.as_slice(), &output.stderr].concat()).into_owned()
}

/// Every file below a folder with its content, but for the lock.
fn content(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if !path.ends_with("lock") {
                found
                    .insert(path.strip_prefix(folder).unwrap().to_owned(), fs::read(path).unwrap());
            }
        }
    }
    found
}

/// Three processes, one of which is killed: what is there is told at every time, a report is made of part of the runs, and
/// the study is the same to the byte as that of one process.
#[test]
fn processes_share_a_study() {
    let scratch = tempfile::tempdir().unwrap();
    // Two blocks of each of four models.
    let study = |out: &str, more: &[&str]| {
        let arguments = [&["study", "--runs", "17000", "--out", out], more].concat();
        gyradius(scratch.path(), &arguments)
    };
    let done = |mut command: Command, code: i32| {
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", text(&output));
        text(&output)
    };
    done(study("whole", &[]), 0);

    let status = |code| done(gyradius(scratch.path(), &["status", "shared"]), code);
    let report = |code| done(gyradius(scratch.path(), &["report", "shared"]), code);
    assert!(status(2).contains("it holds no study"));
    let mut first = study("shared", &["--shard", "1/3"]).spawn().unwrap();
    let mut third = study("shared", &["--shard", "3/3"]).spawn().unwrap();
    third.kill().unwrap();
    third.wait().unwrap();
    assert!(first.wait().unwrap().success());

    let json = done(gyradius(scratch.path(), &["status", "shared", "--json"]), 1);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let sum = |list: &str, field: &str| {
        json[list]
            .as_array()
            .unwrap()
            .iter()
            .map(|model| model[field].as_u64().unwrap())
            .sum::<u64>()
    };
    assert_eq!(json["complete"], false);
    assert_eq!(sum("models", "finished") + sum("missing", "runs"), 4 * 17000);
    assert!(sum("models", "finished") >= 16384 * 2 + 616, "{json}");
    assert!(status(1).contains("These runs are missing:"));

    // Shard 1 has blocks 0, 3 and 6, of proposed, published and naive-matched, and 3 was killed before it had any.
    let refused = report(2);
    assert!(refused.contains("there are no runs of the model \"naive\" yet"), "{refused}");
    done(study("shared", &["--shard", "3/3"]), 0);
    let told = report(1);
    assert!(told.contains("missing: 616 of proposed (16384 to 16999)"), "{told}");
    let page = fs::read_to_string(scratch.path().join("shared/report.html")).unwrap();
    assert!(page.contains("Not all runs are done."), "the page says so");
    assert!(
        !scratch.path().join("shared/runs").exists(),
        "part of a study is not taken for all of it"
    );

    // Whoever asks for something else is refused, and nothing is lost.
    assert!(done(study("shared", &["--seed", "5"]), 2).contains("seed is"));
    assert!(done(study("shared", &["--seed", "5", "--shard", "2/3"]), 2).contains("seed is"));
    for shard in ["0/3", "4/3", "1", "a/b"] {
        assert!(done(study("shared", &["--shard", shard]), 2).contains("is no shard"));
    }
    done(study("shared", &["--shard", "2/3", "--force"]), 2);

    done(study("shared", &["--shard", "2/3", "--threads", "1"]), 0);
    assert!(status(1).contains("All runs are done."));
    report(0);
    assert!(status(0).contains("put together"));
    assert!(content(&scratch.path().join("shared")) == content(&scratch.path().join("whole")));

    // Looking at it again changes nothing, and does nothing.
    let before = fs::metadata(scratch.path().join("shared/summary.json")).unwrap();
    done(study("shared", &[]), 0);
    done(study("shared", &["--shard", "1/3"]), 0);
    done(study("shared", &[]), 0);
    let after = fs::metadata(scratch.path().join("shared/summary.json")).unwrap();
    assert_eq!(before.modified().unwrap(), after.modified().unwrap());
    assert!(content(&scratch.path().join("shared")) == content(&scratch.path().join("whole")));
    // What is gone is made again.
    fs::remove_file(scratch.path().join("shared/report.html")).unwrap();
    done(study("shared", &[]), 0);
    assert!(content(&scratch.path().join("shared")) == content(&scratch.path().join("whole")));
}

/// A complete study that is extended in shards, and reported on before all of them are done, keeps its runs.
#[test]
fn a_report_of_part_of_an_extension_keeps_what_is_complete() {
    let scratch = tempfile::tempdir().unwrap();
    let done = |arguments: &[&str], code: i32| {
        let output = gyradius(scratch.path(), arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", text(&output));
        text(&output)
    };
    done(&["study", "--runs", "300", "--out", "here"], 0);
    let complete = content(&scratch.path().join("here"));
    done(&["study", "--runs", "400", "--out", "here", "--shard", "1/2"], 0);
    for _ in 0..2 {
        assert!(done(&["report", "here"], 1).contains("missing: 100 of published (300 to 399)"));
        let now = content(&scratch.path().join("here"));
        for (path, bytes) in complete
            .iter()
            .filter(|(path, _)| path.starts_with("runs") || path.ends_with("campaign.json"))
        {
            assert!(now.get(path) == Some(bytes), "{}", path.display());
        }
        let status = done(&["status", "here", "--json"], 1);
        let status: serde_json::Value = serde_json::from_str(&status).unwrap();
        let finished =
            status["models"].as_array().unwrap().iter().map(|m| m["finished"].as_u64().unwrap());
        assert_eq!(finished.collect::<Vec<_>>(), [400, 300, 400, 300]);
    }
    let told = done(&["study", "--runs", "400", "--out", "here"], 0);
    assert!(told.contains("1400 of 1600 runs are finished already"), "{told}");
    done(&["study", "--runs", "300", "--out", "alone"], 0);
    done(&["study", "--runs", "400", "--out", "alone"], 0);
    assert!(content(&scratch.path().join("here")) == content(&scratch.path().join("alone")));
}
