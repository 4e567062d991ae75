//! Scripts for Slurm, submitted to a stand-in for sbatch that does the jobs at once, and shards that a scheduler numbers.
//! `tests/slurm/run` does the same with Slurm itself.

use std::{
    fs,
    os::unix::fs::PermissionsExt,
    path::Path,
    process::{Command, Output},
};

use crate::scratch::{Scratch, content, files, text};

/// Writes down its arguments, and does what it is given: the tasks of an array one after the other, those of which a file
/// `skip-<number>` is there not at all.
const SBATCH: &str = r#"#!/bin/bash
set -eu
printf '%s\0' "$@" >> "$RECORD/arguments"
printf '\0' >> "$RECORD/arguments"
job=$(cat)
last=
for argument; do
    case $argument in
        --array=1-*) last=${argument#--array=1-} last=${last%%\%*} ;;
        --chdir=*) cd -- "${argument#--chdir=}" ;;
    esac
done
id=$(($(cat "$RECORD/id" 2> /dev/null || echo 7) + 1))
echo "$id" > "$RECORD/id"
code=0
if [ -n "$last" ]; then
    for task in $(seq "$last"); do
        if [ ! -e "$RECORD/skip-$task" ]; then
            SLURM_ARRAY_TASK_ID=$task bash <<< "$job" > "${id}_$task.log" 2>&1 || code=$?
            echo "$code" >> "$RECORD/codes"
        fi
    done
else
    bash <<< "$job" > "$id-report.log" 2>&1 || code=$?
    echo "$code" >> "$RECORD/codes"
fi
echo "$id;cluster"
"#;

/// A scenario of a simulator of the user's own.
const SIMULATED: &str = r#"
name = "o"
runs = 4
simulation.SIMULATION
simulation.outputs = [{ name = "x" }]
quantities = [{ name = "y", law = { law = "normal", mean = 2.0, sigma = 0.1 } }]
"#;

/// A folder with a stand-in for sbatch.
struct Cluster(Scratch);

impl Cluster {
    fn new() -> Self {
        let scratch = Scratch::new();
        fs::create_dir(scratch.path("bin")).unwrap();
        fs::write(scratch.path("bin/sbatch"), SBATCH).unwrap();
        let executable = fs::Permissions::from_mode(0o755);
        fs::set_permissions(scratch.path("bin/sbatch"), executable).unwrap();
        Self(scratch)
    }

    /// Submits a script, from another folder than that in which it was written.
    fn submit(&self, script: &Path) -> Output {
        let path = format!("{}:{}", self.0.path("bin").display(), std::env::var("PATH").unwrap());
        let mut bash = Command::new("bash");
        bash.arg(script).env("PATH", path).env("RECORD", self.0.folder()).current_dir("/");
        bash.output().unwrap()
    }

    /// The arguments of every submission.
    fn submissions(&self) -> Vec<Vec<String>> {
        let text = fs::read_to_string(self.0.path("arguments")).unwrap();
        let each = text.split("\0\0").filter(|text| !text.is_empty());
        each.map(|text| text.split('\0').map(str::to_owned).collect()).collect()
    }

    fn codes(&self) -> String {
        let codes = fs::read_to_string(self.0.path("codes")).unwrap();
        fs::remove_file(self.0.path("codes")).unwrap();
        codes.replace('\n', " ")
    }
}

/// In a folder whose name means much to a shell: an array of which a task never comes, and the same script again.
#[test]
fn a_script_does_a_study_and_then_what_is_missing() {
    let cluster = Cluster::new();
    let scratch = &cluster.0;
    let alone = scratch.run(&["study", "--runs", "100", "--seed", "5", "--out", "alone"]);
    assert!(alone.status.success(), "{}", text(&alone));

    let here = scratch.path("-it's $(touch oops) `touch oops` \"a\"\\\n; touch oops #*%j é");
    fs::create_dir(&here).unwrap();
    fs::copy(scratch.path("alone/scenario.toml"), here.join("-s.toml")).unwrap();
    let slurm = |more: &[&str]| {
        let given = ["slurm", "--scenario=-s.toml", "--runs=100", "--seed=5", "--out=-o"];
        let mut command = scratch.command(&[&given, more].concat());
        command.current_dir(&here).output().unwrap()
    };
    let written = slurm(&[
        "--shards=3",
        "--time=1:00",
        "--max-tasks=2",
        "--partition=p q",
        "--account=$(a)",
        "--mem=2G",
        "-ogo.sh",
    ]);
    assert!(written.status.success(), "{}", text(&written));
    let script = here.join("go.sh");

    fs::write(scratch.path("skip-2"), "").unwrap();
    let said = cluster.submit(&script);
    assert!(said.status.success(), "{}", text(&said));
    assert!(
        text(&said).starts_with("array job 8, then report job 9; logs in /"),
        "{}",
        text(&said)
    );
    // Shard 2 has all runs of the second of four models, and there is no report without any.
    assert_eq!(cluster.codes(), "0 0 2 ");
    let status = |code| {
        let output = scratch.command(&["status", "--", "-o"]).current_dir(&here).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", text(&output));
    };
    status(1);
    fs::remove_file(scratch.path("skip-2")).unwrap();
    let said = cluster.submit(&script);
    assert!(said.status.success(), "{}", text(&said));
    assert_eq!(cluster.codes(), "0 0 0 0 ");
    status(0);
    assert!(content(&here.join("-o")) == content(&scratch.path("alone")));
    let logs: Vec<String> = files(&here.join("-o-slurm")).into_keys().collect();
    let expected =
        ["10_1.log", "10_2.log", "10_3.log", "11-report.log", "8_1.log", "8_3.log", "9-report.log"];
    assert_eq!(logs, expected);
    assert!(files(scratch.folder()).keys().all(|name| !name.ends_with("oops")));

    let submissions = cluster.submissions();
    assert_eq!(submissions.len(), 4);
    for (at, arguments) in submissions.iter().enumerate() {
        let has = |argument: &str| {
            assert!(arguments.iter().any(|a| a == argument), "{argument}: {arguments:?}")
        };
        for argument in [
            "--parsable",
            "--requeue",
            "--partition=p q",
            "--account=$(a)",
            "--mem=2G",
            "--time=1:00",
            "--cpus-per-task=1",
        ] {
            has(argument);
        }
        has(match at {
            0 | 2 => "--array=1-3%2",
            1 => "--dependency=afterany:8",
            _ => "--dependency=afterany:10",
        });
    }

    // What a task cannot do is its exit code.
    fs::write(here.join("-s.toml"), "nonsense").unwrap();
    cluster.submit(&script);
    assert!(cluster.codes().starts_with("2 2 2 "));

    // An array whose report is refused, and an answer that is no number.
    for (refuses, answer, expected) in [
        ("dependency", "12;cluster", "array job 12 is submitted: the report is not submitted."),
        ("nothing", "", "sbatch printed \"\" in the place of the number of the array job"),
        ("nothing", "Submitted 12", "sbatch printed \"Submitted 12\" in the place"),
    ] {
        let sbatch = format!(
            "#!/bin/bash\ncat > /dev/null\nif [[ \"$*\" == *{refuses}* ]]; then exit 3; fi\necho '{answer}'\n"
        );
        fs::write(scratch.path("bin/sbatch"), sbatch).unwrap();
        let said = cluster.submit(&script);
        assert_eq!(said.status.code(), Some(1));
        assert!(said.stdout.is_empty() && text(&said).contains(expected), "{}", text(&said));
        // The command that it tells makes the report, wherever it is called.
        let command = text(&said).split_once(":\n  ").unwrap().1.to_owned();
        let report = Command::new("bash").args(["-c", &command]).current_dir("/").output().unwrap();
        assert!(report.status.success(), "{command}: {}", text(&report));
    }

    // Without sbatch, nothing is said to be submitted.
    let none = Command::new("/bin/bash").arg(&script).env("PATH", "/nowhere").output().unwrap();
    assert!(!none.status.success() && none.stdout.is_empty());
}

/// For every subset of flags, bash reads the script, and it is the same on standard output and in a file. Nothing is timed if
/// shards and time are given: then it is the same each time.
#[test]
fn every_script_is_read_by_bash() {
    let scratch = Scratch::new();
    let flags = [
        "--runs=1e6",
        "--seed=7",
        "--threads=3",
        "--partition=x y",
        "--account='",
        "--mem=4GB",
        "--max-tasks=5",
        "--logs=logs\n\u{1b}[1m",
    ];
    for subset in (0..1_usize << flags.len()).step_by(11) {
        let mut given = vec!["slurm", "--out=x", "--shards=4", "--time=7"];
        given.extend(
            flags.iter().enumerate().filter(|(i, _)| subset >> i & 1 == 1).map(|(_, flag)| *flag),
        );
        let printed = scratch.run(&given);
        assert!(
            printed.status.success() && printed.stderr.is_empty(),
            "{given:?}: {}",
            text(&printed)
        );
        assert!(printed.stdout.iter().all(|byte| byte.is_ascii_graphic() || b" \n".contains(byte)));
        given.extend(["-o", "go.sh", "--force"]);
        assert!(scratch.run(&given).status.success());
        assert!(fs::read(scratch.path("go.sh")).unwrap() == printed.stdout);
        let read = Command::new("bash").arg("-n").arg(scratch.path("go.sh")).output().unwrap();
        assert!(read.status.success() && read.stderr.is_empty(), "{given:?}: {}", text(&read));
        let script = String::from_utf8(printed.stdout).unwrap();
        for (flag, part) in
            [(0, "--runs=1000000 "), (1, "--seed=7 "), (2, "--threads=3 "), (6, "--array=1-4%5 ")]
        {
            assert_eq!(script.contains(part), subset >> flag & 1 == 1, "{part}");
        }
    }
}

#[test]
fn what_cannot_be_submitted_is_refused() {
    let scratch = Scratch::new();
    fs::write(scratch.path("there"), "mine").unwrap();
    for (name, simulation) in [
        ("simulator.toml", r#"command = ["/nowhere/simulator"]"#),
        ("function.toml", r#"function = "mine""#),
    ] {
        fs::write(scratch.path(name), SIMULATED.replace("SIMULATION", simulation)).unwrap();
    }
    assert!(scratch.run(&["study", "--runs=4", "--out=o"]).status.success());
    let outside = fs::read_to_string(scratch.path("o/scenario.toml")).unwrap()
        + "\n[[models]]\nname = \"own\"\nlaw = \"outside\"\n";
    fs::remove_dir_all(scratch.path("o")).unwrap();
    fs::write(scratch.path("outside.toml"), outside).unwrap();
    let refused = |arguments: &[&str]| {
        let output = scratch.run(&[&["slurm"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(output.stdout.is_empty());
        text(&output)
    };
    for (arguments, expected) in [
        (&[][..], "--out"),
        (&["--out", "x", "--shards", "0"], "0 is not in 1..=1000000"),
        (&["--out", "x", "--shards", "5"], "runs are done in blocks, and there are 4"),
        (&["--out", "x", "--shards", "5", "--time", "1", "--runs", "1"], "there are 4"),
        (&["--out", "x", "--threads", "0"], "0 is not in 1..=1024"),
        (&["--out", "x", "--max-tasks", "0"], "0 is not in 1.."),
        (&["--out", "x", "--partition", ""], "a value is required"),
        (&["--out", "x", "--time", "abc"], "it must be minutes, minutes:seconds"),
        (&["--out", "x", "--time", "1-2-3"], "it must be minutes"),
        (&["--out", "x", "--time", "1:2:3:4"], "it must be minutes"),
        (&["--out", "x", "--time", ""], "it must be minutes"),
        (&["--out", "x", "--mem", "2 G"], "it must be a whole number of megabytes"),
        (&["--out", "x", "--mem", "G"], "it must be a whole number of megabytes"),
        (&["--out", "x", "--runs", "0"], "runs: 0: it must be between 1"),
        (&["--out", ".."], "--logs must say where the logs go"),
        (
            &["--out", "x", "--logs", "x/logs"],
            "--logs x/logs: it is in the folder of the study, x,",
        ),
        (&["--out", "./x/", "--logs", "x"], "--logs x: it is in the folder"),
        (&["--out", "x", "--scenario", "nowhere.toml"], "cannot read nowhere.toml"),
        (&["--out", "x", "-o", "there"], "--force replaces it"),
        (&["--out", "x", "-o", "nowhere/go.sh"], "nowhere/go.sh"),
        (&["--out", "x", "--scenario", "there", "-o", "there", "--force"], "there"),
        (&["--out", "x", "--force"], "--output"),
        (&["--out", "there"], "/there: it is not a folder"),
        (&["--out", "there/deep/x"], "/there is not a folder"),
        (&["--out", "x", "--logs", "there"], "/there: it is not a folder"),
        (&["--out", "x", "--scenario", "simulator.toml", "--shards=1"], "--shards and --time"),
    ] {
        let message = refused(arguments);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    assert_eq!(fs::read_to_string(scratch.path("there")).unwrap(), "mine");
    assert_eq!(files(scratch.folder()).len(), 4);
    // What no task could do, with everything given that need not be timed.
    for (scenario, expected) in [
        ("outside.toml", "a program's own, which no file holds"),
        ("function.toml", "is a function of the program that made the study"),
    ] {
        let message = refused(&["--out=x", "--shards=1", "--time=9", "--scenario", scenario]);
        assert!(message.contains(expected), "{scenario}: {message}");
    }
    let mut redirected = scratch.command(&["slurm", "--out=x", "--scenario=/dev/stdin"]);
    redirected.stdin(fs::File::open(scratch.path("simulator.toml")).unwrap());
    let said = redirected.output().unwrap();
    assert_eq!(said.status.code(), Some(2));
    assert!(text(&said).contains("it is not a file that stays"), "{}", text(&said));
    // The nodes may have what this machine has not.
    let elsewhere =
        scratch.run(&["slurm", "--out=x", "--shards=1", "--time=9", "--scenario=simulator.toml"]);
    let said = text(&elsewhere);
    assert!(elsewhere.status.success() && said.contains("no run can be done on this machine"));
    assert!(said.contains("/nowhere/simulator"), "{said}");
    // Whatever the folder is called.
    std::os::unix::fs::symlink("to", scratch.path("link")).unwrap();
    fs::create_dir(scratch.path("to")).unwrap();
    assert!(refused(&["--out", "to", "--logs", "link/deep/logs"]).contains("in the folder"));
    for logs in ["link/../logs", "to-logs", "tox/to"] {
        let beside =
            scratch.run(&["slurm", "--out", "to", "--runs=9", "--shards=1", "--logs", logs]);
        assert!(beside.status.success(), "{logs}: {}", text(&beside));
    }
    // More tasks than an array has where nobody changed its size are not refused: this cluster's may be larger.
    let many = scratch.run(&["slurm", "--out=x", "--runs=1e7", "--shards=1200", "--time=9"]);
    assert!(many.status.success() && text(&many).contains("MaxArraySize"), "{}", text(&many));
}

/// The same command for every process, which the environment numbers.
#[test]
fn a_scheduler_numbers_the_shards() {
    let scratch = Scratch::new();
    let study = |environment: &[(&str, &str)]| {
        let mut command =
            scratch.command(&["study", "--runs", "50", "--out", "big", "--shard", "auto/2"]);
        for name in [
            "SLURM_ARRAY_TASK_ID",
            "JOB_COMPLETION_INDEX",
            "HQ_TASK_ID",
            "OMPI_COMM_WORLD_RANK",
            "PMI_RANK",
        ] {
            command.env_remove(name);
        }
        command.envs(environment.iter().copied()).output().unwrap()
    };
    let none = study(&[]);
    assert_eq!(none.status.code(), Some(2));
    assert!(text(&none).contains("no scheduler says which shard this is"), "{}", text(&none));
    assert!(!scratch.path("big").exists());
    let both = study(&[("PMI_RANK", "0"), ("JOB_COMPLETION_INDEX", "0")]);
    assert!(text(&both).contains("more than one scheduler"), "{}", text(&both));
    for (environment, shard) in [
        (&[("JOB_COMPLETION_INDEX", "0")][..], "shard 1/2"),
        (&[("OMPI_COMM_WORLD_RANK", "1"), ("OMPI_COMM_WORLD_SIZE", "2")], "shard 2/2"),
    ] {
        let done = study(environment);
        assert!(done.status.success() && text(&done).contains(shard), "{}", text(&done));
    }
    let report = scratch.run(&["report", "big"]);
    assert!(report.status.success(), "{}", text(&report));
}
