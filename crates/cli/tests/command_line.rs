//! The program as a user meets it: exit codes, messages, and what it leaves alone.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};
use tempfile::TempDir;

struct Shell(TempDir);

impl Shell {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_gyradius"))
            .current_dir(self.path())
            .args(arguments)
            .output()
            .unwrap()
    }

    /// Runs what must be refused: exit code 2, nothing on standard output, a message.
    fn refused(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(output.stdout.is_empty(), "{:?}", output.stdout);
        assert!(!message.contains("panicked"), "{message}");
        message
    }

    /// A scenario file: that of a study, with a replacement.
    fn scenario(&self, from: &str, to: &str) -> String {
        let resolved = self.path().join("base/scenario.toml");
        if !resolved.exists() {
            let output = self.run(&["study", "--runs", "5", "--out", "base"]);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        }
        let text = fs::read_to_string(resolved).unwrap();
        assert!(text.contains(from), "nothing to replace: {from}\n{text}");
        fs::write(self.path().join("changed.toml"), text.replacen(from, to, 1)).unwrap();
        "changed.toml".to_owned()
    }
}

#[test]
fn a_study_leaves_its_folder_and_a_table() {
    let shell = Shell::new();
    let output = shell.run(&["study", "--runs", "20", "--threads", "1"]);
    let (table, messages) =
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(output.status.success(), "{messages}");
    assert!(messages.is_empty(), "no progress bar where there is no terminal: {messages}");
    for word in ["proposed", "published", "naive", "naive-matched", "wobble", "inertia ratio"] {
        assert!(table.contains(word), "{word} is missing:\n{table}");
    }
    let folder = shell.path().join("target/study/peck-2003");
    assert!(table.contains("target/study/peck-2003/report.html"), "{table}");
    for name in [
        "scenario.toml",
        "summary.json",
        "report.html",
        "report.md",
        "campaign.json",
        "runs/naive/000000000-000000019.parquet",
    ] {
        assert!(folder.join(name).is_file(), "{name} is missing");
    }
    let leftovers = fs::read_dir(&folder).unwrap().count();
    assert_eq!(leftovers, 8, "only what a study leaves behind");
}

#[test]
fn help_has_examples_and_is_no_error() {
    let shell = Shell::new();
    let output = shell.run(&["study", "--help"]);
    let help = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && help.contains("Examples:"), "{help}");
    for flag in ["--scenario", "--runs", "--seed", "--out", "--threads", "--force", "--max-failed"]
    {
        assert!(help.contains(flag), "{flag} is missing");
    }
    assert!(shell.run(&["--version"]).status.success());
}

/// Sentences under the options are broken where a line is full, and nowhere else.
#[test]
fn help_breaks_lines_where_they_are_full() {
    let shell = Shell::new();
    let top = String::from_utf8(shell.run(&["--help"]).stdout).unwrap();
    let commands = top.lines().skip_while(|line| *line != "Commands:").skip(1);
    let commands = commands.take_while(|line| !line.is_empty());
    let verbs = commands
        .filter(|line| !line.starts_with("   "))
        .filter_map(|l| l.split_whitespace().next());
    let verbs: Vec<&str> = verbs.filter(|verb| *verb != "help").chain([""]).collect();
    assert!(verbs.len() > 12, "{verbs:?}");
    for verb in verbs {
        let arguments: Vec<&str> =
            [verb, "--help"].into_iter().filter(|word| !word.is_empty()).collect();
        let help = String::from_utf8(shell.run(&arguments).stdout).unwrap();
        let lines: Vec<&str> = help.lines().collect();
        for pair in lines.windows(2) {
            let is_prose = |line: &str| line.starts_with(char::is_alphanumeric);
            let next = pair[1].split_whitespace().next().unwrap_or_default();
            let would_fit = pair[0].chars().count() + 1 + next.chars().count() <= 100;
            assert!(
                !(is_prose(pair[0]) && pair[1].starts_with(|c| c != ' ') && would_fit),
                "{verb}: {pair:?}"
            );
        }
    }
}

/// A scenario file may stand in its place or be named, and not both.
#[test]
fn a_scenario_stands_in_its_place() {
    let shell = Shell::new();
    let scenario = shell.scenario("name = \"peck-2003\"", "name = \"mine\"");
    for stated in [&[scenario.as_str()][..], &["--scenario", &scenario]] {
        let output = shell.run(&[&["study"], stated, &["--runs", "20", "--force"]].concat());
        assert!(output.status.success(), "{output:?}");
        assert!(shell.path().join("target/study/mine/report.html").exists());
        fs::remove_dir_all(shell.path().join("target")).unwrap();
    }
    let both = shell.refused(&["study", &scenario, "--scenario", &scenario]);
    assert!(both.contains("cannot be used with"), "{both}");
}

#[test]
fn bad_flags_are_refused() {
    let shell = Shell::new();
    assert!(shell.refused(&["study", "--runs", "0"]).contains("runs: 0: it must be between 1"));
    for (flag, value) in [
        ("--runs", "-3"),
        ("--runs", "many"),
        ("--seed", "-1"),
        ("--drivers", "-3"),
        ("--threads", "x"),
        ("--threads", "-2"),
    ] {
        let message = shell.refused(&["study", flag, value]);
        let named = message.contains(flag) && message.contains(&format!("'{value}'"));
        assert!(named && message.contains("it must be a whole number"), "{message}");
    }
    for value in ["1e16", "18446744073709551616"] {
        let message = shell.refused(&["draw", "-n", "1", "--first", value]);
        let told = match value {
            "1e16" => "one of 9007199254740992 or more must be written with all its digits",
            _ => "it must be at most 18446744073709551615",
        };
        assert!(message.contains(told), "{message}");
    }
    let message = shell.refused(&["study", "--max-failed", "-1"]);
    assert!(message.contains("'-1' for '--max-failed <SHARE>': it must lie between"), "{message}");
    assert!(shell.refused(&["study", "--threads", "0"]).contains("threads: 0: it must be between"));
    assert!(shell.refused(&["study", "--seed", "18446744073709551615"]).contains("seed: 184467"));
    assert!(shell.refused(&["study", "--wibble"]).contains("--wibble"));
    assert!(shell.refused(&["launch"]).contains("launch"));
    assert!(shell.refused(&[]).contains("Usage"));
    assert_eq!(fs::read_dir(shell.path()).unwrap().count(), 0, "nothing was written");
}

#[test]
fn bad_scenarios_name_field_value_and_what_is_allowed() {
    let shell = Shell::new();
    let missing = shell.refused(&["study", "--scenario", "nowhere.toml"]);
    assert!(missing.contains("cannot read nowhere.toml"), "{missing}");
    let folder = shell.refused(&["study", "--scenario", "."]);
    assert!(folder.contains("cannot read"), "{folder}");
    let cases = [
        (
            "mass_kg = 10000.0",
            "mass_kg = -3.0",
            "payload.mass_kg: mass = -3.0 kg: it must be positive",
        ),
        ("mass_kg = 10000.0", "mass_kg = inf", "payload.mass_kg: inf: it must be at most 1e12"),
        ("mass_kg = 10000.0", "mass = 10000.0", "unknown field `mass`"),
        ("mass_kg = 10000.0", "mass_kg = \"ten\"", "invalid type"),
        ("mass_kg = 10000.0", "mass_kg = ", "line"),
        ("5000.0", "9000.0", "payload.inertia_kg_m2: no body has this inertia"),
        ("0.00002", "-0.00002", "payload.dispersion.axes_covariance: covariance with eigenvalue"),
        ("0.00002", "0.0", "must be positive definite"),
        ("runs = 5", "runs = 0", "runs: 0: it must be between 1"),
        ("stroke_m = 0.1", "stroke_m = 0.0", "springs[1].stroke_m: stroke = 0.0 m"),
    ];
    for (from, to, expected) in cases {
        let file = shell.scenario(from, to);
        let message = shell.refused(&["study", "--scenario", &file, "--out", "never"]);
        assert!(message.contains(expected), "{from} -> {to}: {message}");
        assert!(message.contains("changed.toml"), "the file is named: {message}");
        assert!(!shell.path().join("never").exists(), "nothing was written");
    }
}

#[test]
fn touching_pads_are_refused() {
    let shell = Shell::new();
    shell.scenario("runs = 5", "runs = 5");
    let path = shell.path().join("changed.toml");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("-0.9", "-1.0").replace("0.9", "1.0")).unwrap();
    let message = shell.refused(&["study", "--scenario", "changed.toml", "--out", "never"]);
    assert!(
        message.contains("springs[1].payload_point_m: spring 1") && message.contains("touching"),
        "{message}"
    );
}

#[test]
fn empty_and_binary_scenarios_are_refused() {
    let shell = Shell::new();
    let (empty, binary) = (shell.path().join("empty.toml"), shell.path().join("binary.toml"));
    fs::write(&empty, "").unwrap();
    fs::write(&binary, [0_u8, 159, 146, 150]).unwrap();
    assert!(shell.refused(&["study", "--scenario", "empty.toml"]).contains("missing field"));
    assert!(shell.refused(&["study", "--scenario", "binary.toml"]).contains("cannot read"));
}

#[test]
fn another_study_is_not_overwritten_without_force() {
    let shell = Shell::new();
    assert!(shell.run(&["study", "--runs", "5", "--out", "here"]).status.success());
    let report = shell.path().join("here/report.html");
    let before = fs::read(&report).unwrap();

    for (flag, value, said) in [
        ("--runs", "4", "runs is 5 there and 4 here"),
        ("--seed", "7", "seed is 2003 there and 7 here"),
    ] {
        let message = shell.refused(&["study", "--out", "here", flag, value]);
        assert!(message.contains("another study") && message.contains("--force"), "{message}");
        assert!(message.contains(said), "{message}");
    }
    assert_eq!(fs::read(&report).unwrap(), before, "nothing was overwritten");

    // The same study may be run again, and another one by force.
    assert!(shell.run(&["study", "--runs", "5", "--out", "here"]).status.success());
    assert_eq!(fs::read(&report).unwrap(), before, "the same study has the same report");
    assert!(shell.run(&["study", "--runs", "4", "--out", "here", "--force"]).status.success());
    assert_ne!(fs::read(&report).unwrap(), before);
}

#[test]
fn folders_with_other_things_are_left_alone() {
    let shell = Shell::new();
    let folder = shell.path().join("thesis");
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("chapter-1.txt"), "precious").unwrap();
    shell.refused(&["study", "--runs", "5", "--out", "thesis"]);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    // Even by force, only what a study writes is replaced.
    assert!(shell.run(&["study", "--runs", "5", "--out", "thesis", "--force"]).status.success());
    assert_eq!(fs::read_to_string(folder.join("chapter-1.txt")).unwrap(), "precious");
}

#[test]
fn unwritable_places_are_refused_before_any_work() {
    let shell = Shell::new();
    fs::write(shell.path().join("file"), "not a folder").unwrap();
    let message = shell.refused(&["study", "--out", "file"]);
    assert!(message.contains("output folder file: it is not a folder"), "{message}");
    let message = shell.refused(&["study", "--out", "file/below"]);
    assert!(message.contains("output folder file/below: it cannot be written"), "{message}");
    assert_eq!(fs::read_to_string(shell.path().join("file")).unwrap(), "not a folder");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("nowhere", shell.path().join("link")).unwrap();
        let message = shell.refused(&["study", "--out", "link"]);
        assert!(
            message.contains("output folder link: it is a link that leads nowhere"),
            "{message}"
        );
    }
    // A copy without what tells the files of a study from others.
    assert!(shell.run(&["study", "--runs", "2", "--out", "whole"]).status.success());
    fs::create_dir(shell.path().join("copy")).unwrap();
    for name in ["campaign.json", "scenario.toml", "summary.json"] {
        let from = shell.path().join("whole").join(name);
        fs::copy(from, shell.path().join("copy").join(name)).unwrap();
    }
    for verb in [&["status", "copy"][..], &["study", "--runs", "2", "--out", "copy"]] {
        let message = shell.refused(verb);
        assert!(message.contains("a copy without the folder .gyradius"), "{message}");
    }
}

/// A user's own files in a study's folder survive the same study being run again.
#[test]
fn files_of_the_user_are_left_alone() {
    let shell = Shell::new();
    let study = ["study", "--runs", "5", "--out", "here"];
    assert!(shell.run(&study).status.success());
    let notes = ["here/runs/notes.txt", "here/figures/mine.svg", "here/readme.txt"];
    for note in notes {
        fs::write(shell.path().join(note), "mine").unwrap();
    }
    assert!(shell.run(&study).status.success());
    assert!(shell.run(&["study", "--runs", "6", "--out", "here", "--force"]).status.success());
    for note in notes {
        assert_eq!(fs::read_to_string(shell.path().join(note)).unwrap(), "mine", "{note}");
    }
}

/// Something in the way is found before anything is replaced.
#[test]
fn a_file_where_a_folder_should_be_costs_nothing() {
    let shell = Shell::new();
    let study = ["study", "--runs", "5", "--out", "here"];
    assert!(shell.run(&study).status.success());
    let figures = shell.path().join("here/figures");
    fs::remove_dir_all(&figures).unwrap();
    fs::write(&figures, "not a folder").unwrap();
    let message = shell.refused(&study);
    assert!(message.contains("figures in it is a file"), "{message}");
    for name in [
        "scenario.toml",
        "summary.json",
        "report.html",
        "report.md",
        "runs/naive/000000000-000000004.parquet",
    ] {
        assert!(shell.path().join("here").join(name).is_file(), "{name} is gone");
    }
}

/// Two studies into one folder: one of them, whole.
#[test]
fn studies_do_not_mix() {
    let shell = Shell::new();
    let folder = shell.path().join("here");
    let children: Vec<_> = ["1", "2", "3"]
        .map(|seed| {
            Command::new(env!("CARGO_BIN_EXE_gyradius"))
                .current_dir(shell.path())
                .args(["study", "--runs", "300", "--out", "here", "--seed", seed])
                .stdout(std::process::Stdio::null())
                .stderr(std::process::Stdio::null())
                .spawn()
                .unwrap()
        })
        .into_iter()
        .collect();
    let codes: Vec<_> =
        children.into_iter().map(|mut child| child.wait().unwrap().code()).collect();
    assert_eq!(codes.iter().filter(|c| **c == Some(0)).count(), 1, "{codes:?}");
    assert_eq!(codes.iter().filter(|c| **c == Some(2)).count(), 2, "{codes:?}");
    let hidden = fs::read_dir(folder.join(".gyradius")).unwrap();
    let mut hidden: Vec<_> = hidden.map(|entry| entry.unwrap().file_name()).collect();
    hidden.sort();
    assert_eq!(hidden, ["lock", "study.json"]);
}

#[test]
fn a_run_is_replayed_into_a_folder() {
    let shell = Shell::new();
    let missing = shell.refused(&["replay", "--run", "0"]);
    assert!(missing.contains("target/study/peck-2003: there is no such study"), "{missing}");
    assert!(shell.run(&["study", "--runs", "8"]).status.success());

    let output = shell.run(&["replay", "--run", "7", "--model", "naive"]);
    let page = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for word in ["peck-2003, model naive, run 7 of 8", "status: ok", "bit for bit", "lets go at"] {
        assert!(page.contains(word), "{word} is missing:\n{page}");
    }
    assert!(page.lines().count() < 50, "one page");
    let folder = shell.path().join("target/replay/peck-2003/naive-7");
    for name in ["history.csv", "history.svg", "animation.html"] {
        assert!(folder.join(name).is_file(), "{name} is missing");
    }

    assert!(shell.refused(&["replay", "--run", "8"]).contains("run 8: the runs are numbered"));
    assert!(shell.refused(&["replay", "--run", "-1"]).contains("-1"));
    assert!(shell.refused(&["replay"]).contains("--run"));
    let model = shell.refused(&["replay", "--run", "0", "--model", "naif"]);
    assert!(model.contains("model: \"naif\": the scenario has proposed"), "{model}");
    assert!(shell.refused(&["replay", "--run", "0", "--coast", "-1"]).contains("coast = -1.0 s"));
    let taken =
        shell.refused(&["replay", "--run", "1", "--out", "target/replay/peck-2003/naive-7"]);
    assert!(taken.contains("history.csv exists: --force replaces it"), "{taken}");

    // A run that never began leaves no history of another one behind, and removes it with --force only. With this
    // deviation, half of the first moments are negative.
    let wild = shell.scenario("42.8518", "42000.0");
    let into = ["--model", "naive", "--out", "target/replay/peck-2003/naive-7"];
    let replay = |run: &str, more: &[&str]| {
        let output = shell.run(&[&["replay", &wild, "--run", run], &into[..], more].concat());
        (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let never = (0..9).map(|run| run.to_string()).find(|run| {
        let other = shell.run(&["replay", &wild, "--run", run, "--model", "naive", "--out", run]);
        String::from_utf8_lossy(&other.stdout).contains("it never began")
    });
    let never = never.expect("a run with a negative moment");
    assert!(!shell.path().join(&never).exists(), "nothing to write");
    assert_eq!(replay(&never, &[]).0, Some(2));
    assert!(folder.join("history.csv").is_file());
    let (code, page) = replay(&never, &["--force"]);
    assert!(code == Some(0) && page.contains("no history"), "{page}");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
    // An empty file is somebody's too.
    fs::write(folder.join("history.csv"), "").unwrap();
    assert_eq!(replay(&never, &[]).0, Some(2));
    assert!(folder.join("history.csv").is_file());

    // A scenario file has no table.
    let file = shell.scenario("runs = 5", "runs = 9");
    let output = shell.run(&["replay", &file, "--run", "8", "--out", "again"]);
    let page = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && page.contains("no run table"), "{page}");
    let help = shell.run(&["replay", "--help"]).stdout;
    assert!(String::from_utf8(help).unwrap().contains("Examples:"));
}
