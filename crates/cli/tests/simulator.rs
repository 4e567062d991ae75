//! Campaigns of a user's own simulator, a script in the shell: studied, killed, put together, drawn and replayed.

use serde_json::Value;
use std::{
    collections::BTreeSet,
    fs::{self, File},
    process::{Command, Output, Stdio},
    thread,
    time::{Duration, SystemTime},
};

use crate::scratch::{Scratch, content, one_model};

/// Answers with the quantity, and fails while there is a file and it is below 0.2.
const SCRIPT: &str = r#"
while read -r line; do
    x=${line#*'"x":'}; x=${x%%[,\}]*}
    case $x in
        0.1*) [ -e busy ] && echo '{"error":"no licence"}' || echo "{\"outputs\":{\"y\":$x}}" ;;
        *) echo "{\"outputs\":{\"y\":$x}}" ;;
    esac
done
"#;
pub(crate) const SCENARIO: &str = r#"
name = "shell"
runs = 4000
seed = 5

[simulation]
command = ["sh", "answer.sh"]

[[simulation.outputs]]
name = "y"

[[quantities]]
name = "x"
law = { law = "uniform", low = 0.1, high = 0.95 }
"#;

pub(crate) fn scratch() -> Scratch {
    let scratch = Scratch::new();
    fs::write(scratch.path("answer.sh"), SCRIPT).unwrap();
    fs::write(scratch.path("s.toml"), SCENARIO).unwrap();
    scratch
}

fn said(output: &Output) -> [String; 2] {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned())
}

/// Killed at fifty moments: what the record told of before is not done again, and at the end there is what a study leaves that nobody
/// disturbed, byte by byte.
#[test]
fn a_campaign_survives_fifty_kills() {
    let scratch = scratch();
    // So many runs that no machine has done them after a few kills.
    let runs = ["study", "--scenario", "s.toml", "--runs", "40000"];
    let study = |out: &str| {
        let mut command = scratch.command(&[&runs[..], &["--out", out]].concat());
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command
    };
    let record = || {
        let text = fs::read_to_string(scratch.path("here/.gyradius/campaign/record"));
        let text = text.unwrap_or_default();
        text.lines().filter(|line| line.ends_with('}')).map(str::to_owned).collect::<Vec<_>>()
    };
    let mut known: Vec<String> = Vec::new();
    let mut kills = 0;
    // At moments that are spread evenly over a tenth of a second, in no order.
    for moment in (0..50).map(|i| 500 + i * 61 % 50 * 1800) {
        let mut child = study("here").spawn().unwrap();
        thread::sleep(Duration::from_micros(moment));
        if child.try_wait().unwrap().is_some() {
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
        let now = record();
        assert!(now.starts_with(&known), "{now:?} {known:?}");
        known = now;
    }
    assert!(kills > 5, "{kills}");
    assert!(study("here").status().unwrap().success());
    assert!(study("there").status().unwrap().success());
    let [here, there] = ["here", "there"].map(|out| content(&scratch.path(out)));
    assert!(here.keys().eq(there.keys()), "{:?} {:?}", here.keys(), there.keys());
    for (name, content) in &here {
        assert!(*content == there[name], "{name}");
    }

    // Nobody asks what time it is: files of any age are what they are.
    for (i, name) in here.keys().enumerate() {
        let years = Duration::from_secs(86_400 * 365 * (i as u64 % 60));
        let time = SystemTime::UNIX_EPOCH + years;
        File::options()
            .append(true)
            .open(scratch.path("here").join(name))
            .unwrap()
            .set_modified(time)
            .unwrap();
    }
    assert!(study("here").status().unwrap().success());
    let status = scratch.run(&["status", "here"]);
    assert_eq!(status.status.code(), Some(0), "{:?}", said(&status));
    for (name, content) in &here {
        assert!(fs::read(scratch.path("here").join(name)).unwrap() == *content, "{name}");
    }
}

/// The everyday commands, in the order in which they are used.
#[test]
fn every_verb_knows_simulators() {
    let scratch = scratch();
    let study = |more: &[&str]| {
        let arguments = ["study", "--scenario", "s.toml", "--runs", "700", "--out", "o"];
        scratch.run(&[&arguments, more].concat())
    };
    fs::write(scratch.path("busy"), "").unwrap();
    let [out, err] = said(&study(&["--shard", "2/2", "--json"]));
    let json: Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out}{err}"));
    assert_eq!((&json["shard"], &json["runs"]), (&Value::from("2/2"), &Value::from(256)));
    let status = scratch.run(&["status", "o"]);
    assert_eq!(status.status.code(), Some(1));
    for (run, expected) in
        [("300", "as in o/.gyradius/campaign/all/"), ("0", "not done this run yet")]
    {
        let [told, _] = said(&scratch.run(&["replay", "o", "--run", run]));
        assert!(told.contains(expected), "{told}");
    }
    let report = scratch.run(&["report", "o"]);
    assert_eq!(report.status.code(), Some(1));
    assert!(said(&report)[0].contains("missing: 256 of all (0 to 255)"), "{:?}", said(&report));

    let json = study(&["--json"]);
    let json: Value = serde_json::from_slice(&json.stdout).unwrap();
    let failed = json["models"][0]["failed"].as_u64().unwrap();
    assert!(failed > 40 && json["complete"] == true && json["runs_per_model"] == 700, "{json}");
    assert_eq!(json["columns"].as_array().unwrap().len(), 6);

    fs::remove_file(scratch.path("busy")).unwrap();
    let again = study(&["--retry-failed"]);
    let [out, err] = said(&again);
    assert!(err.contains(&format!("{failed} runs that had failed, done again: 0 failed again")));
    assert!(again.status.success() && out.contains("all: 700 runs, 0 failed"), "{out}");
    let quiet = study(&["--quiet"]);
    assert!(quiet.status.success() && said(&quiet).concat().is_empty());

    let replay = scratch.run(&["replay", "o", "--run", "699"]);
    let [told, _] = said(&replay);
    let sent = told.lines().find_map(|line| line.strip_prefix("sent: ")).unwrap();
    let sent: Value = serde_json::from_str(sent).unwrap();
    let y = format!("y = {:?}", sent["inputs"]["x"].as_f64().unwrap());
    assert!(told.contains(&y) && told.contains("the same, bit for bit, as in o"), "{told}");
    let draw = scratch.run(&["draw", "s.toml", "-n", "700", "--format", "csv"]);
    let last = said(&draw)[0].lines().last().unwrap().to_owned();
    assert!(last.starts_with("all,699,ok,") && last.contains(&y[4..]), "{last}");

    let page = fs::read(scratch.path("o/report.html")).unwrap();
    fs::remove_file(scratch.path("o/report.html")).unwrap();
    assert!(scratch.run(&["report", "o"]).status.success());
    assert!(fs::read(scratch.path("o/report.html")).unwrap() == page);

    // Another simulator does not go on with these runs, nor does one that is not there.
    fs::write(scratch.path("answer.sh"), format!("{SCRIPT}\n")).unwrap();
    let other = scratch.run(&["study", "--scenario", "s.toml", "--runs", "800", "--out", "o"]);
    let [_, err] = said(&other);
    assert!(other.status.code() == Some(2) && err.contains("simulation.files_sha256"), "{err}");
    let absent = SCENARIO.replace("\"sh\"", "\"gyradius-no-such-program\"");
    fs::write(scratch.path("s.toml"), absent).unwrap();
    let refused = scratch.run(&["study", "--scenario", "s.toml", "--out", "absent"]);
    assert!(refused.status.code() == Some(2) && !scratch.path("absent").exists());
}

/// A scenario that is wrong is refused as one of a simulator by every verb, and what a command names is read if it is a
/// regular file.
#[test]
fn wrong_scenarios_and_endless_files_are_known() {
    let scratch = scratch();
    let wrong = SCENARIO.replace("command =", "timeout_s = -1.0\ncommand =");
    fs::write(scratch.path("wrong.toml"), wrong).unwrap();
    for verb in [
        &["study", "--scenario", "wrong.toml"][..],
        &["replay", "wrong.toml", "--run", "1"],
        &["draw", "wrong.toml"],
        &["slurm", "--scenario", "wrong.toml", "--out", "x"],
    ] {
        let output = scratch.run(verb);
        let [_, err] = said(&output);
        assert!(output.status.code() == Some(2) && err.contains("simulation.timeout_s"), "{err}");
    }
    // What is found when a model is made, or the command is started, is told with the file as well.
    for (name, from, to, expected) in [
        (
            "date.toml",
            "runs = 4000",
            "runs = 4\ndate = 2026-11-23",
            "date: 2026-11-23 is a date or a time",
        ),
        (
            "device.toml",
            "\"shell\"",
            "\"CON\"",
            "name: \"CON\": it names a folder, and Windows reserves",
        ),
        (
            "absent.toml",
            "\"sh\"",
            "\"gyradius-no-such-program\"",
            "simulation.command: the command",
        ),
    ] {
        fs::write(scratch.path(name), SCENARIO.replace(from, to)).unwrap();
        let told = scratch.done(&["study", "--scenario", name, "--out", "x"], 2);
        assert!(told.contains(&format!("{name}: {expected}")), "{told}");
    }
    let wide = one_model()
        + "\n[[models]]\nname = \"wide\"\nlaw = \"wishart\"\nmatched_to = \"proposed\"\n";
    let variance = "[0.125, 0.1, 0.075]";
    assert!(wide.contains(variance));
    fs::write(scratch.path("wide.toml"), wide.replace(variance, "[1e7, 1.0, 1.0]")).unwrap();
    for verb in [
        &["study", "--scenario", "wide.toml", "--out", "x"][..],
        &["draw", "wide.toml", "--model", "wide"],
        &["replay", "wide.toml", "--run", "1", "--model", "wide"],
    ] {
        let told = scratch.done(verb, 2);
        assert!(told.contains("wide.toml: models[2].matched_to: the payload: "), "{told}");
    }
    let endless = SCENARIO.replace("\"answer.sh\"", "\"answer.sh\", \"/dev/zero\"");
    fs::write(scratch.path("endless.toml"), endless).unwrap();
    let output =
        scratch.run(&["study", "--scenario", "endless.toml", "--runs", "3", "--out", "endless"]);
    assert!(output.status.success(), "{:?}", said(&output));
}

/// A study that the disk has no room for is refused before it begins, and begun if that is asked for.
#[test]
fn a_disk_that_is_too_small_is_found_before() {
    let scratch = scratch();
    let run = |more: &[&str]| {
        let arguments = ["study", "--scenario", "s.toml", "--runs", "3e8", "--out", "o"];
        let mut command: Command = scratch.command(&[&arguments, more].concat());
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command
    };
    let body = |i: u32| {
        format!(
            "\n[[bodies]]\nname = \"b{i}\"\nmass_kg = 1.0\n\
             inertia_kg_m2 = [[1.0, 0.0, 0.0], [0.0, 1.1, 0.0], [0.0, 0.0, 1.2]]\n\
             [bodies.dispersion]\nroot_second_moment_variance_kg_m2 = [1e-3, 1e-3, 1e-3]\naxes = \"fixed\"\n"
        )
    };
    let model = "\n[[models]]\nname = \"all\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n";
    let bodies: String = (0..120).map(body).collect();
    fs::write(scratch.path("s.toml"), format!("{SCENARIO}{bodies}{model}")).unwrap();
    let refused = run(&[]).output().unwrap();
    let [_, err] = said(&refused);
    // 11 numbers of each body and two more, of 8 bytes, three hundred million times: no test runs on such a disk.
    assert!(err.contains("the run tables will take about 3 TB"), "{err}");
    assert!(refused.status.code() == Some(2) && err.contains("--even-if-full"), "{err}");
    assert!(!scratch.path("o/report.html").exists());
    let mut begun = run(&["--even-if-full"]).spawn().unwrap();
    thread::sleep(Duration::from_millis(300));
    assert!(begun.try_wait().unwrap().is_none());
    begun.kill().unwrap();
    begun.wait().unwrap();
}

/// A signal does not wait for a run of the simulator: the runs at hand are dropped, their processes and what these started
/// are killed, and the same command goes on.
#[test]
fn a_signal_ends_runs_that_take_long() {
    // Tells who it is, and then takes its time, the first time.
    let slow = "if [ -e busy ]; then echo $$ > process; sleep 30; fi; ";
    let answers = [
        ("false", format!("read -r line; {slow}echo '{{\"outputs\":{{\"y\":1}}}}'; exec cat")),
        (
            "true",
            format!(
                "here=$PWD; cd \"$0\"; {slow}echo '{{\"outputs\":{{\"y\":1}}}}' > $here/output.json"
            ),
        ),
    ];
    for (per_run, answer) in answers {
        for (signal, code) in [("INT", 130), ("TERM", 143)] {
            let scratch = Scratch::new();
            let folder = scratch.folder().to_str().unwrap();
            let command = format!(
                "runs = 1\nsimulation.per_run = {per_run}\nsimulation.command = ['sh', '-c', '''cd {folder}; {answer}''', '{folder}']\n"
            );
            let rest = SCENARIO.replace("[simulation]\ncommand = [\"sh\", \"answer.sh\"]\n", "");
            let text = command + &rest.replace("runs = 4000\n", "");
            let text = if per_run == "true" {
                text.replace(&format!("cd {folder}; here"), "here")
            } else {
                text
            };
            fs::write(scratch.path("s.toml"), text).unwrap();
            fs::write(scratch.path("busy"), "").unwrap();
            fs::create_dir(scratch.path("tmp")).unwrap();
            let study = ["study", "--scenario", "s.toml", "--out", "it"];
            let rare = ["rare", "y >= 2", "--scenario", "s.toml"];
            for (words, told) in [
                (&study[..], "the same command goes on"),
                (&["replay", "s.toml", "--run", "0"], "the run had not ended"),
                (&rare, "nothing is kept of the runs"),
            ] {
                let mut child = scratch.command(words);
                child.env("TMPDIR", scratch.path("tmp"));
                let child = child.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
                let process = || fs::read_to_string(scratch.path("process")).unwrap_or_default();
                while !process().ends_with('\n') {
                    thread::sleep(Duration::from_millis(2));
                }
                let id = child.id().to_string();
                Command::new("kill").args([&format!("-{signal}"), &id]).status().unwrap();
                let output = child.wait_with_output().unwrap();
                assert_eq!(output.status.code(), Some(code), "{words:?}: {:?}", said(&output));
                assert!(said(&output)[1].contains(told), "{words:?}: {:?}", said(&output));
                let alive = Command::new("kill").args(["-0", process().trim()]).output().unwrap();
                assert!(!alive.status.success(), "{words:?} {per_run}");
                assert_eq!(fs::read_dir(scratch.path("tmp")).unwrap().count(), 0, "{words:?}");
                fs::remove_file(scratch.path("process")).unwrap();
            }
            fs::remove_file(scratch.path("busy")).unwrap();
            let output = scratch.run(&study);
            assert!(output.status.success(), "{:?}", said(&output));
            assert!(said(&output)[0].contains("1 run a model"), "{:?}", said(&output));
        }
    }
}

/// Where no temporary folder can be made, no run is to blame: nothing is kept, and the same command goes on.
#[test]
fn a_run_without_a_temporary_folder_is_no_failed_run() {
    let scratch = Scratch::new();
    let command = "runs = 3\nsimulation.per_run = true\nsimulation.command = ['sh', '-c', '''echo '{\"outputs\":{\"y\":1}}' > output.json''']\n";
    let rest = SCENARIO.replace("[simulation]\ncommand = [\"sh\", \"answer.sh\"]\n", "");
    fs::write(scratch.path("s.toml"), command.to_owned() + &rest.replace("runs = 4000\n", ""))
        .unwrap();
    let study = ["study", "--scenario", "s.toml", "--out", "it"];
    let rare = ["rare", "y >= 2", "--scenario", "s.toml"];
    let replay = ["replay", "s.toml", "--run", "0"];
    for words in [&study[..], &rare, &replay] {
        let output = scratch.command(words).env("TMPDIR", "/nonexistent").output().unwrap();
        let [_, err] = said(&output);
        let told = "a temporary folder for a run cannot be used in /nonexistent: No such file";
        assert!(output.status.code() == Some(2) && err.contains(told), "{words:?}: {err}");
        // Its name would be another one each time; and only a study keeps runs.
        assert!(!err.contains("gyradius-run-"), "{words:?}: {err}");
        assert_eq!(err.contains("are kept"), words == study, "{words:?}: {err}");
    }
    assert!(!scratch.path("it/report.html").exists());
    let output = scratch.run(&study);
    assert!(output.status.success(), "{:?}", said(&output));
}

/// Where the machine can start no more processes, no run is to blame, on any number of threads and with any number of open files: either
/// the study ends as it would have ended, or it keeps nothing that failed and the same command goes on.
#[test]
fn a_process_that_cannot_be_started_is_no_failed_run() {
    let scratch = Scratch::new();
    let script = SCRIPT.replace("x=${line", "sleep 0.002; x=${line");
    fs::write(scratch.path("answer.sh"), script).unwrap();
    let scenario = SCENARIO.replace("runs = 4000", "runs = 300");
    fs::write(scratch.path("lines.toml"), &scenario).unwrap();
    // It opens fewer files than the program had to open for it, so that it does not fail where it can be started.
    fs::write(scratch.path("answer.json"), r#"{"outputs":{"y":1}}"#).unwrap();
    let answer = scratch.path("answer.json");
    let per_run =
        format!("per_run = true\ncommand = ['cp', '{}', 'output.json']", answer.display());
    let per_run = scenario.replace("command = [\"sh\", \"answer.sh\"]", &per_run);
    fs::write(scratch.path("files.toml"), per_run).unwrap();
    let mut ends = BTreeSet::new();
    for scenario in ["lines.toml", "files.toml"] {
        scratch.done(&["study", "--scenario", scenario, "--out", "free", "--force"], 0);
        for (files, threads) in [(14, "1"), (20, "2"), (26, "8"), (34, "8"), (44, "8"), (1024, "8")]
        {
            let words = ["study", "--scenario", scenario, "--threads", threads, "--out", "it"];
            let mut limited = Command::new("sh");
            let limit = format!("ulimit -n {files}; exec \"$0\" \"$@\"");
            limited.args(["-c", &limit, env!("CARGO_BIN_EXE_gyradius")]).args(words);
            let output = limited.current_dir(scratch.folder()).output().unwrap();
            let (code, told) = (output.status.code(), said(&output));
            assert!(matches!(code, Some(0 | 2)), "{scenario} {files} {threads}: {told:?}");
            // Which file is the first one too many depends on the files that the tests were started with.
            assert!(code == Some(0) || told[1].contains("Too many open files"), "{told:?}");
            ends.insert((scenario, code));
            // What has failed is not kept, so that nothing is to be retried.
            scratch.done(&words, 0);
            assert!(content(&scratch.path("it")) == content(&scratch.path("free")), "{words:?}");
            fs::remove_dir_all(scratch.path("it")).unwrap();
        }
    }
    for scenario in ["lines.toml", "files.toml"] {
        assert!([0, 2].iter().all(|code| ends.contains(&(scenario, Some(*code)))), "{ends:?}");
    }
}
