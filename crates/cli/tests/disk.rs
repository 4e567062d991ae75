//! Studies on a disk that is full, or must not be written: nothing is lost, and the words are clear.

use std::{
    fs,
    process::{Command, Output},
};

use crate::scratch::{Scratch, content, files, one_model, text};

/// Does what a shell script says where file systems can be mounted, which no other program sees; none where they cannot.
fn with_mounts(scratch: &Scratch, script: &str) -> Option<Output> {
    let mut may = Command::new("unshare");
    may.args(["-rm", "sh", "-c", "mount -t tmpfs none /mnt"]);
    if !may.output().is_ok_and(|output| output.status.success()) {
        return None;
    }
    let mut command = Command::new("unshare");
    command.args(["-rm", "sh", "-c", script]).current_dir(scratch.folder());
    Some(command.env("GYRADIUS", env!("CARGO_BIN_EXE_gyradius")).output().unwrap())
}

/// A disk that is full at the first block, at later ones, and when the results are written, and grows each time: the command says so
/// with exit code 2, what was finished stays, a file of the user's is not touched, and at the end there is what a study leaves that had
/// room.
#[test]
fn a_study_survives_a_full_disk() {
    let scratch = Scratch::new();
    // A block of its runs has 7.6 MB.
    fs::write(scratch.path("it.toml"), one_model()).unwrap();
    let output =
        scratch.run(&["study", "--scenario", "it.toml", "--runs", "40000", "--out", "whole", "-q"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let script = r#"
        mkdir small && mount -t tmpfs -o size=1m none small || exit 99
        echo mine > small/notes.txt
        for size in 1m 9m 17m 18300k 100m; do
            mount -o remount,size=$size small || exit 99
            "$GYRADIUS" study --scenario it.toml --runs 40000 --out small/it -q --even-if-full
            echo "$size ends with $?" >&2
            "$GYRADIUS" status --json small/it | tr -d ' \n' | grep -o '"finished":[0-9]*' >&2
            [ "$(cat small/notes.txt)" = mine ] || exit 98
        done
        cp -r small/it it
        # No room to leave rows out: what was there stays, and nothing is begun.
        head -c $(( $(df --output=avail -B1 small | tail -1) - 1000000 )) /dev/zero > small/fill
        "$GYRADIUS" study --scenario it.toml --runs 40000 --out small/it -q --columns wobble_deg,cone_deg,nutation_deg,spin_rate_rad_per_s
        [ $? = 2 ] && cp -r small/it after || exit 97
    "#;
    let Some(output) = with_mounts(&scratch, script) else { return };
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let done = |size: &str| {
        let (before, after) = said.split_once(&format!("{size} ends with ")).unwrap();
        let error = before.lines().last().unwrap_or_default().to_owned();
        let status = after.lines().nth(1).unwrap();
        let finished = status.strip_prefix("\"finished\":").unwrap_or("0");
        (after[..1].to_owned(), error, finished.parse::<u64>().unwrap())
    };
    let mut before = 0;
    for size in ["1m", "9m", "17m", "18300k"] {
        let (code, error, finished) = done(size);
        assert_eq!(code, "2", "{said}");
        assert!(error.contains("small/it") && error.contains("No space left"), "{error}");
        assert!(error.contains("What was finished stays, and the same command goes on"), "{error}");
        assert!(finished >= before, "{said}");
        before = finished;
    }
    assert_eq!(before, 40_000, "{said}");
    assert_eq!(done("100m").0, "0", "{said}");
    assert_eq!(content(&scratch.path("it")), content(&scratch.path("whole")));
    assert_eq!(content(&scratch.path("after")), content(&scratch.path("whole")));
}

/// A folder that must not be written is refused before the first run, and what is in it can be read: status, replay, a report elsewhere.
#[test]
fn a_study_that_is_read_only_can_be_looked_at() {
    let scratch = Scratch::new();
    let script = r#"
        mkdir fixed && mount -t tmpfs none fixed || exit 99
        "$GYRADIUS" study --runs 40 --out fixed/it -q || exit 1
        "$GYRADIUS" study --runs 40 --out fixed/begun --shard 1/2 -q || exit 2
        mount -o remount,ro fixed || exit 99
        "$GYRADIUS" status fixed/it || exit 3
        "$GYRADIUS" replay fixed/it --run 7 --out replay | grep 'bit for bit' || exit 4
        "$GYRADIUS" report fixed/it --out report || exit 5
        "$GYRADIUS" status fixed/begun; [ $? = 1 ] || exit 6
        for command in 'study --runs 50 --out fixed/it' 'study --runs 50 --out fixed/new' 'report fixed/it' \
            'report fixed/begun' 'study --runs 40 --out fixed/begun --shard 2/2'; do
            "$GYRADIUS" $command 2> said
            [ $? = 2 ] || { echo "$command"; cat said; exit 7; } >&2
            grep -q 'fixed/.*Read-only file system' said || { echo "$command"; cat said; exit 8; } >&2
        done
    "#;
    let Some(output) = with_mounts(&scratch, script) else { return };
    assert!(output.status.success(), "{}: {}", output.status, text(&output));
}

/// A study under a limit of 512 MB of memory, which does not grow with the runs.
#[test]
fn half_a_gigabyte_is_enough() {
    let scratch = Scratch::new();
    let script =
        r#"ulimit -v 524288 && exec "$GYRADIUS" study --runs 50000 --out it --threads 2 -q"#;
    let mut command = Command::new("sh");
    command.args(["-c", script]).current_dir(scratch.folder());
    let output = command.env("GYRADIUS", env!("CARGO_BIN_EXE_gyradius")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(files(&scratch.path("it/runs")).len(), 16);
}

/// A pipe in the place of any file of a study is refused, and waited for by nobody.
#[test]
fn pipes_are_not_waited_for() {
    let scratch = Scratch::new();
    let run = |arguments: &[&str]| {
        let mut command = Command::new("timeout");
        command.args(["-s", "KILL", "60", env!("CARGO_BIN_EXE_gyradius")]).args(arguments);
        command.current_dir(scratch.folder()).output().unwrap()
    };
    let study =
        |out, more: &[&str]| run(&[&["study", "--runs", "20", "--out", out], more].concat());
    assert!(study("whole", &["-q"]).status.success());
    assert!(study("begun", &["-q", "--shard", "1/2"]).status.success());
    for (folder, file) in [
        ("whole", "scenario.toml"),
        ("whole", "summary.json"),
        ("whole", "campaign.json"),
        ("whole", "report.html"),
        ("whole", ".gyradius/study.json"),
        ("begun", ".gyradius/campaign/identity.json"),
        ("begun", ".gyradius/campaign/mark"),
        ("begun", ".gyradius/campaign/record"),
        ("begun", ".gyradius/campaign/record-1-of-2"),
        ("begun", ".gyradius/campaign/record-2-of-2"),
    ] {
        for (i, command) in [
            &["study", "--runs", "20", "-q", "--out"][..],
            &["study", "--runs", "20", "-q", "--shard", "2/2", "--out"],
            &["study", "--runs", "20", "-q", "--force", "--out"],
            &["status"],
            &["report"],
            &["replay", "--run", "1", "--out", "replay", "--force"],
        ]
        .into_iter()
        .enumerate()
        {
            let copy = format!("{folder}-{}-{i}", file.replace('/', "-"));
            let mut copied = Command::new("cp");
            copied.args(["-a", folder, &copy]).current_dir(scratch.folder());
            assert!(copied.status().unwrap().success());
            let path = scratch.path(&copy).join(file);
            let _ = fs::remove_file(&path);
            assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
            let output = run(&[command, &[&copy]].concat());
            // Killed commands have none.
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.code().is_some_and(|code| code <= 2), "{copy}: {said}");
        }
    }
}
