//! `gyradius draw`: the draws of a study without its runs, in every form.

use gyradius_campaign::{Cell, Column, Kind, Row, Table};
use gyradius_study::{Options, Scenario, Study};
use std::{
    collections::{BTreeSet, HashMap},
    fmt::Write as _,
    fs,
    path::Path,
    process::{Command, Stdio},
    time::Duration,
};

use crate::scratch::Scratch;

impl Scratch {
    /// What a draw that is done leaves on standard output.
    #[track_caller]
    fn draw(&self, arguments: &[&str]) -> Vec<u8> {
        let output = self.run(&[&["draw"], arguments].concat());
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && message.is_empty(), "{arguments:?}: {message}");
        output.stdout
    }

    /// What is refused: exit code 2, nothing on standard output, a message.
    #[track_caller]
    fn refused(&self, arguments: &[&str]) -> String {
        let output = self.run(&[&["draw"], arguments].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty() && message.starts_with("error: "), "{message}");
        message
    }

    fn names(&self) -> BTreeSet<String> {
        let entries = fs::read_dir(self.folder()).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }
}

/// What may be dispersed: of the payload, the stage, the first spring and the rest. Some laws are so wide that draws are
/// refused.
const PAYLOAD: [&str; 6] = [
    "mass_kg = { law = \"lognormal\", sigma = 100.0 }\ninertia_follows_mass = 0.5",
    "mass_centre_m = [0.01, 0.01, { law = \"uniform\", low = -0.03, high = 0.03 }]",
    "position_m = 0.001",
    "velocity_m_per_s = { law = \"truncated-normal\", sigma = 0.001, low = -0.002, high = 0.002 }",
    "attitude_deg = 0.1",
    "angular_velocity_rad_per_s = { covariance = [[1e-6, 5e-7, 0.0], [5e-7, 1e-6, 0.0], [0.0, 0.0, 4e-6]] }",
];
/// The bit of the first of these.
const PAYLOAD_MASS: u64 = 1;
const STAGE: [&str; 2] = ["mass_percent = 60.0", "attitude_deg = 1.0"];
const SPRING: [&str; 8] = [
    "stiffness_percent = 80.0",
    "stroke_percent = { sigma = 1.0, mean = -0.5 }",
    "friction_n = { law = \"uniform\", low = 0.0, high = 200.0 }",
    "line_of_action_deg = 0.5",
    "payload_point_m = 0.002",
    "stage_point_m = 0.002",
    "start_s = { law = \"lognormal\", mean = 0.01, sigma = 0.005 }\nlate_probability = 0.3",
    "failure_probability = 0.2",
];
const STACK: [&str; 2] = ["attitude_deg = 1.0", "angular_velocity_rad_per_s = 0.002"];
/// Models beside the first: of entries, so wide that no body has some of them, and others by name.
const MODELS: [&str; 4] = [
    "law = \"entrywise\"\npayload_deviation_kg_m2 = [[3e3, 100.0, 100.0], [100.0, 3e3, 100.0], [100.0, 100.0, 3e3]]\n\
     stage_deviation_kg_m2 = [[10.0, 10.0, 10.0], [10.0, 10.0, 10.0], [10.0, 10.0, 10.0]]",
    "law = \"principal\"\naxes = \"jacobian-twice\"",
    "law = \"realizable-entrywise\"\nmatched_to = \"proposed\"",
    "law = \"wishart\"\nmatched_to = \"proposed\"",
];
const OUTLINES: &str = "[clearance]\npayload = [{ points_m = [[0.0, 0.0, -0.5]] }]\n\
                        stage = [{ points_m = [[0.0, 0.0, 0.3]] }]\n";

/// A scenario with those of all these things whose bits are set.
fn scenario(mut bits: u64) -> String {
    let mut some = |all: &[&str]| {
        let mut text = String::new();
        for one in all {
            if bits & 1 == 1 {
                let _ = writeln!(text, "{one}");
            }
            bits >>= 1;
        }
        text
    };
    let base = Scenario::peck_2003().unwrap().to_toml().replace("comparisons = []\n", "");
    let models = base.find("[[models]]").unwrap();
    let second = models + 1 + base[models + 1..].find("[[models]]").unwrap();
    let mut text = base[..second].to_owned();
    for (body, all) in [("payload", &PAYLOAD[..]), ("stage", &STAGE)] {
        let head = format!("[{body}.dispersion]\n");
        assert!(text.contains(&head));
        text = text.replace(&head, &format!("{head}{}\n", some(all)));
    }
    let spring = text.match_indices("[[springs]]").nth(1).unwrap().0;
    text.insert_str(spring, &format!("[springs.dispersion]\n{}\n", some(&SPRING)));
    let _ = writeln!(text, "[stack.dispersion]\n{}", some(&STACK));
    for (i, model) in MODELS.iter().enumerate() {
        let model = some(&[model]);
        if !model.is_empty() {
            let _ = writeln!(text, "[[models]]\nname = \"model-{i}\"\n{model}");
        }
    }
    text + &some(&[OUTLINES])
}

const THINGS: usize = PAYLOAD.len() + STAGE.len() + SPRING.len() + STACK.len() + MODELS.len() + 1;

/// Subsets: nothing, everything, and some at random.
fn subsets() -> impl Iterator<Item = u64> {
    let all = (1_u64 << THINGS) - 1;
    // Weyl's sequence, of which the upper bits are spread.
    let random = (1..9_u64).map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - THINGS));
    [0, all].into_iter().chain(random)
}

/// The columns of a table that are among these, as a simulation declares them.
fn empty_like(table: &Table, names: &[String]) -> Table {
    let own = ["model", "run", "status", "status_kind"];
    let columns = table.columns().iter().filter(|column| {
        names.iter().any(|name| name == column.name()) && !own.contains(&column.name())
    });
    Table::new(table.model(), 0, columns.cloned().collect()).unwrap()
}

fn is_text_of(text: &str, cell: &Cell<'_>) -> bool {
    match cell {
        Cell::Number(number) => text.parse::<f64>().unwrap().to_bits() == number.to_bits(),
        Cell::Null => text.is_empty(),
        other => text == other.to_string(),
    }
}

fn is_value_of(value: &serde_json::Value, cell: &Cell<'_>) -> bool {
    match cell {
        Cell::Number(number) => value.as_f64().map(f64::to_bits) == Some(number.to_bits()),
        Cell::Null => value.is_null(),
        Cell::Integer(integer) => value.as_i64() == Some(*integer),
        Cell::Flag(flag) => value.as_bool() == Some(*flag),
        Cell::Text(text) | Cell::Note { text, .. } => value.as_str() == Some(text),
    }
}

/// For any subset of dispersions and models: every drawn column is that of the run table of a study, bit for bit, and
/// what a run has that cannot be separated is all that is drawn.
#[test]
fn draws_are_what_the_runs_of_a_study_have() {
    const RUNS: &str = "70";
    let shell = Scratch::new();
    let (mut refused, mut sound) = (0, 0);
    for bits in subsets() {
        let text = scenario(bits);
        fs::write(shell.path("s.toml"), &text).unwrap();
        let scenario = Scenario::from_toml(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let options = Options { out: Some(shell.path("s")), force: true, ..Options::default() };
        let study = Study::run(&scenario.with_runs(70).unwrap(), &options, &|_| {}).unwrap();
        for table in study.tables().unwrap() {
            let draw = |format: &str| {
                shell.draw(&["s.toml", "-n", RUNS, "--model", table.model(), "--format", format])
            };
            let csv = draw("csv");
            let mut lines = csv::Reader::from_reader(&csv[..]);
            let names: Vec<String> = lines.headers().unwrap().iter().map(str::to_owned).collect();
            let lines: Vec<_> = lines.records().map(Result::unwrap).collect();
            fs::write(shell.path("d.parquet"), draw("parquet")).unwrap();
            let drawn = empty_like(&table, &names).read_parquet(&shell.path("d.parquet")).unwrap();
            let columns = drawn.columns().iter().map(Column::name);
            assert!(columns.eq(names.iter()), "in the order of the run table: {names:?}");
            let json = String::from_utf8(draw("jsonl")).unwrap();
            let objects: Vec<HashMap<String, serde_json::Value>> =
                json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
            assert_eq!((table.len(), drawn.len(), lines.len(), objects.len()), (70, 70, 70, 70));

            for (place, (run, row)) in table.rows().zip(drawn.rows()).enumerate() {
                if row.failure().is_some() {
                    refused += 1;
                    only_what_is_drawn(&run, &names);
                    assert_eq!(row.failure(), run.failure());
                } else {
                    sound += 1;
                }
                for (at, (column, cell)) in row.cells().enumerate() {
                    let name = column.name();
                    if !name.starts_with("status") {
                        assert_eq!(run.cell(name), Some(cell.clone()), "{name}\n{text}");
                    }
                    assert!(is_text_of(&lines[place][at], &cell), "{name}: {}", &lines[place][at]);
                    assert!(is_value_of(&objects[place][name], &cell), "{name}");
                }
                assert_eq!(objects[place].len(), names.len());
            }
        }
    }
    assert!(refused > 100 && sound > 1000, "{refused} {sound}");
}

/// A run that cannot be separated has all that is drawn, and nothing else.
fn only_what_is_drawn(run: &Row<'_>, names: &[String]) {
    for (column, cell) in run.cells() {
        let is_drawn = names.iter().any(|name| name == column.name());
        // Models of entries have no axes.
        let may_be_none = column.kind() == Kind::Number && column.name().contains("_q");
        assert!(is_drawn == (cell != Cell::Null) || (is_drawn && may_be_none), "{column:?}");
    }
}

/// The same bytes on any number of threads and beyond the end of a block; the runs from a number on are the last of all.
#[test]
fn neither_threads_nor_the_first_run_change_a_draw() {
    let shell = Scratch::new();
    fs::write(shell.path("s.toml"), scenario(PAYLOAD_MASS)).unwrap();
    fs::write(shell.path("all.toml"), scenario(u64::MAX)).unwrap();
    for format in ["csv", "jsonl", "npy", "parquet"] {
        let draw = |rest: &[&str]| shell.draw(&[rest, &["--format", format]].concat());
        let threads = |rest: &[&str]| {
            let [one, three] =
                ["1", "3"].map(|threads| draw(&[rest, &["--threads", threads]].concat()));
            assert!(one == three, "{format}");
            one
        };
        threads(&["all.toml", "-n", "300"]);
        let whole = threads(&["s.toml", "--model", "proposed", "-n", "17000"]);
        let tail = draw(&["s.toml", "--model", "proposed", "-n", "1000", "--first", "1.6e4"]);
        let head = match format {
            "csv" => tail.iter().position(|byte| *byte == b'\n').unwrap() + 1,
            "jsonl" => 0,
            // The head says how many there are, and ends with the line.
            "npy" => tail.iter().position(|byte| *byte == b'\n').unwrap() + 1,
            // The head is at the end.
            _ => continue,
        };
        assert!(tail.len() - head > 1000 * 20 * 8 && whole.ends_with(&tail[head..]), "{format}");
    }
    // Another seed draws others, and models stand one after the other.
    let csv =
        |rest: &[&str]| String::from_utf8(shell.draw(&[&["-n", "2"], rest].concat())).unwrap();
    let (all, other) = (csv(&[]), csv(&["--seed", "7"]));
    assert!(all.lines().count() == 9 && other.lines().count() == 9);
    assert!(all.lines().skip(1).zip(other.lines().skip(1)).all(|(a, b)| a != b));
    let two = csv(&["--model", "naive", "--model", "proposed"]);
    let of = |text: &str| -> Vec<String> { text.lines().map(str::to_owned).collect() };
    let expected: Vec<_> = [0, 1, 2, 5, 6].map(|line| of(&all)[line].clone()).into();
    assert_eq!(of(&two), expected);
    let from_study = shell.run(&["study", "--runs", "2", "--seed", "7", "--out", "seven"]);
    assert!(from_study.status.success());
    assert_eq!(csv(&["seven/scenario.toml"]), other);
}

/// NumPy reads what CSV says, where there is NumPy.
#[test]
fn numpy_opens_arrays() {
    let has = Command::new("python3").args(["-c", "import numpy"]).stderr(Stdio::null()).status();
    if !has.is_ok_and(|status| status.success()) {
        return;
    }
    let shell = Scratch::new();
    let script = "\
import csv, math, sys, numpy
array = numpy.load('d.npy', max_header_size=100000)
lines = list(csv.reader(open('d.csv', newline='')))
assert list(array.dtype.names) == lines[0] and len(array) == len(lines) - 1
for name, *texts in zip(*lines):
    for text, value in zip(texts, array[name]):
        if array.dtype[name].kind == 'f':
            same = math.isnan(value) if text == '' else float(text).hex() == float(value).hex()
        elif array.dtype[name].kind == 'b':
            same = text == str(value).lower()
        else:
            same = text == str(value)
        assert same, (name, text, value)
print('same', len(array), *array['status_kind'][:1])
";
    for (bits, runs) in [(0, "3"), (u64::MAX, "200"), (u64::MAX, "0")] {
        fs::write(shell.path("s.toml"), scenario(bits)).unwrap();
        for file in ["d.npy", "d.csv"] {
            shell.draw(&["s.toml", "-n", runs, "-o", file, "--force"]);
        }
        let mut python = Command::new("python3");
        let said = python.args(["-c", script]).current_dir(shell.folder()).output().unwrap();
        let message = String::from_utf8_lossy(&said.stderr);
        assert!(said.status.success() && said.stdout.starts_with(b"same"), "{message}");
    }
}

/// Files appear whole, by the format of their extension, and replace nothing unasked.
#[test]
fn files_are_whole_and_replace_nothing_unasked() {
    let shell = Scratch::new();
    fs::write(shell.path("s.toml"), scenario(0)).unwrap();
    for (file, format) in [
        ("a.csv", "csv"),
        ("a.ndjson", "jsonl"),
        ("a.JSONL", "jsonl"),
        ("a.npy", "npy"),
        ("a.pq", "parquet"),
    ] {
        shell.draw(&["s.toml", "-n", "5", "-o", file]);
        let streamed = shell.draw(&["s.toml", "-n", "5", "--format", format, "-o", "-"]);
        assert!(fs::read(shell.path(file)).unwrap() == streamed, "{file}");
        assert!(shell.refused(&["s.toml", "-n", "6", "-o", file]).contains("--force replaces it"));
        assert!(fs::read(shell.path(file)).unwrap() == streamed, "{file}");
        shell.draw(&["s.toml", "-n", "6", "-o", file, "--force"]);
        assert!(fs::read(shell.path(file)).unwrap() != streamed, "{file}");
    }
    shell.draw(&["s.toml", "-n", "5", "-o", "b.txt", "--format", "csv"]);
    let before = shell.names();
    for (arguments, expected) in [
        (
            &["s.toml", "-o", "c.txt"][..],
            "c.txt: the extension tells no format, as .parquet, .pq, .csv",
        ),
        (&["s.toml", "-o", "c"], "--format says it"),
        (&["s.toml", "-o", "s.toml", "--format", "csv", "--force"], "it is not written over"),
        (&["s.toml", "-o", "nowhere/c.csv"], "cannot write nowhere/c.csv"),
        (&["s.toml", "-o", ".", "--format", "csv", "--force"], "not a regular file"),
        (
            &["s.toml", "--model", "nemo", "-o", "c.csv"],
            "model: \"nemo\": the scenario has proposed",
        ),
        (&["s.toml", "--threads", "0", "-o", "c.csv"], "threads: 0: it must be between"),
        (&["--first", "9223372036854775807", "-n", "1"], "1 runs from run 9223372036854775807 on"),
        (&["nowhere.toml"], "cannot read nowhere.toml"),
        (&["--seed", "18446744073709551615"], "seed: 18446744073709551615"),
        (&["-n=-1"], "whole number"),
        (&["--first=-1"], "whole number"),
        (&["-n", "few"], "whole number"),
        (&["--format", "xlsx"], "parquet"),
        (&["--force"], "--output"),
    ] {
        let message = shell.refused(arguments);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    assert_eq!(shell.names(), before);
    let last = shell.draw(&["--first", "9223372036854775806", "-n", "1", "--model", "naive"]);
    assert!(String::from_utf8(last).unwrap().contains("\nnaive,9223372036854775806,ok,"));
    // No runs are the columns alone.
    let columns = shell.draw(&["s.toml", "-n", "0"]);
    assert!(columns.starts_with(b"model,run,status,") && columns.ends_with(b"status_kind\n"));
    assert!(shell.draw(&["s.toml", "-n", "0", "--format", "jsonl"]).is_empty());
    // As many as the scenario has, if nothing is said.
    let all = shell.draw(&["s.toml"]);
    assert_eq!(all.iter().filter(|byte| **byte == b'\n').count(), 2001);
}

/// A reader that has seen enough ends a draw of any length, quietly; a binary form is not for the screen.
#[cfg(unix)]
#[test]
fn readers_and_screens_get_what_they_can_read() {
    use std::io::{BufRead, BufReader};
    let shell = Scratch::new();
    for format in ["csv", "jsonl", "parquet"] {
        let mut child = shell
            .command(&["draw", "-n", "1e12", "--format", format])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut reader = BufReader::new(child.stdout.take().unwrap());
        assert!(reader.read_until(b'\n', &mut Vec::new()).unwrap() > 0);
        drop(reader);
        let ended = child.wait_with_output().unwrap();
        assert!(ended.status.success() && ended.stderr.is_empty(), "{format}: {ended:?}");
    }
    // `script` lends a terminal, where there is one.
    let program = env!("CARGO_BIN_EXE_gyradius");
    for (format, refused) in [("csv", false), ("npy", true), ("parquet", true)] {
        let line = format!("{program} draw -n 1 --model naive --format {format}");
        let arguments = ["-qec", &line, "/dev/null"];
        let Ok(output) = Command::new("script").args(arguments).stdin(Stdio::null()).output()
        else {
            return;
        };
        let said = String::from_utf8_lossy(&output.stdout);
        assert_eq!(said.contains("is not for the screen"), refused, "{said}");
        assert_eq!(said.contains("naive,0,ok"), !refused, "{said}");
    }
}

/// An interrupt leaves no half of a file, and what was there.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing() {
    let shell = Scratch::new();
    fs::write(shell.path("d.csv"), "mine").unwrap();
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let mut child = shell
            .command(&["draw", "-n", "1e12", "-o", "d.csv", "--force"])
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let begun = |entry: &Path| fs::metadata(entry).is_ok_and(|there| there.len() > 1000);
        while !shell.names().iter().any(|name| name != "d.csv" && begun(&shell.path(name))) {
            assert!(child.try_wait().unwrap().is_none());
            std::thread::sleep(Duration::from_millis(5));
        }
        let kill = Command::new("kill").args([signal, &child.id().to_string()]).status();
        assert!(kill.unwrap().success());
        let ended = child.wait_with_output().unwrap();
        assert_eq!(ended.status.code(), Some(code));
        assert_eq!(String::from_utf8_lossy(&ended.stderr), "error: stopped\n");
        assert_eq!(shell.names().into_iter().collect::<Vec<_>>(), ["d.csv"]);
        assert_eq!(fs::read_to_string(shell.path("d.csv")).unwrap(), "mine");
    }
}
