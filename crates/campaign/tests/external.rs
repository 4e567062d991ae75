//! Simulators in a shell script that misbehave in every way, in every place, in Python, and as functions: what they do to their own
//! runs, and that they do nothing to others.

mod function;
mod order;
mod status;

use gyradius_campaign::{
    Column, ExternalSimulation, Failure, Inputs, Kind, Program, ProgramError, Simulator, Streams,
    Table, run, threads,
};
use proptest::prelude::*;
use rand::{Rng, RngExt};
use std::{collections::BTreeSet, path::Path, thread, time::Duration};

const SEED: u64 = 2003;

/// Any finite number for each run, and whether the simulator is to misbehave in it.
struct Drawn {
    streams: Streams,
    mischief: BTreeSet<u64>,
    /// How many inputs are sent beside these.
    more: usize,
}

impl Inputs for Drawn {
    fn columns(&self) -> Vec<Column> {
        let column = |name: String| Column::number(name, "1", "An input.");
        let own = ["x", "mischief"].into_iter().map(str::to_owned);
        own.chain((0..self.more).map(|i| format!("more {i}"))).map(column).collect()
    }

    fn draw(&self, run: u64, numbers: &mut Vec<Option<f64>>) -> Result<(), Failure> {
        let mut rng = self.streams.run(run);
        let x = loop {
            let x = f64::from_bits(rng.next_u64());
            if x.is_finite() {
                break x;
            }
        };
        numbers.extend([Some(x), Some(f64::from(u8::from(self.mischief.contains(&run))))]);
        numbers.extend((0..self.more).map(|_| Some(rng.random::<f64>())));
        Ok(())
    }
}

/// Reads a run into `run`, `seed` and `x`, answers with the latter two, misbehaves if asked to.
const SCRIPT: &str = r#"
answer() { printf '{"run":%s,"outputs":{"y":%s,"seed":%s}}\n' "$1" "$x" "$seed"; }
mischief() {
    :
    MISCHIEF
}
one() {
    run=${line#*'"run":'}; run=${run%%,*}
    seed=${line#*'"seed":'}; seed=${seed%%,*}
    x=${line#*'"x":'}; x=${x%%,*}
    case $line in
        *'"mischief":1.0'*) mischief ;;
        *) answer "$run" ;;
    esac
}
"#;
const LINES: &str = "while read -r line; do one; done";
const FILES: &str = "read -r line < input.json; one > output.json";

fn simulator(mischief: &str, per_run: bool, timeout_s: f64) -> Simulator {
    let way = if per_run { FILES } else { LINES };
    let script = format!("{}{way}", SCRIPT.replace("MISCHIEF", mischief));
    let program = Program::new(&["sh".into(), "-c".into(), script], Path::new("/")).unwrap();
    let program = program.with_timeout(timeout_s).unwrap();
    Simulator::start(if per_run { program.per_run() } else { program }).unwrap()
}

fn outputs() -> Vec<Column> {
    vec![Column::number("y", "m", "x again."), Column::number("seed", "1", "The seed again.")]
}

fn simulation(
    simulator: &Simulator,
    mischief: BTreeSet<u64>,
    more: usize,
) -> ExternalSimulation<'_, Drawn> {
    let drawn = Drawn { streams: Streams::new(SEED, "any", "x"), mischief, more };
    ExternalSimulation::new(simulator, SEED, "any", drawn, outputs())
}

fn table(simulator: &Simulator, mischief: &BTreeSet<u64>, runs: u64, on: usize) -> Table {
    let simulation = simulation(simulator, mischief.clone(), 0);
    run(&simulation, "any", runs, &threads(Some(on)).unwrap(), &|_| {}).unwrap()
}

/// The runs of a table that failed are these, for this reason; all others have their own answer, bit for bit.
fn assert_rows(table: &Table, failed: &BTreeSet<u64>, kind: &str, what: &str) {
    let seeds = Streams::new(SEED, "any", "simulator seed");
    for (place, row) in table.rows().enumerate() {
        let number = |column| table.numbers(column).unwrap().get(place);
        let found = row.failure().map(Failure::kind);
        if failed.contains(&row.run()) {
            assert_eq!(found, Some(kind), "{what}: run {}: {:?}", row.run(), row.failure());
            let finite = |column| number(column).filter(|x| x.is_finite());
            assert_eq!((finite("y"), finite("seed")), (None, None), "{what}");
        } else {
            assert_eq!(found, None, "{what}: run {}: {:?}", row.run(), row.failure());
            assert_eq!(number("y").map(f64::to_bits), number("x").map(f64::to_bits), "{what}");
            let seed = seeds.run(row.run()).next_u64() >> 11;
            assert_eq!(number("seed"), Some(seed as f64), "{what}");
        }
    }
}

/// What a misbehaving simulator does, and the kind of the failure if it is asked line by line and if it is started for
/// each run; none if the run is all right.
const MISCHIEF: [(&str, Option<&str>, Option<&str>); 36] = [
    ("exit 3", Some("the simulator ended"), Some("the simulator ended")),
    ("answer $run; exit 3", None, Some("the simulator ended")),
    ("answer $run; exit 0", None, None),
    ("exit 0", Some("the simulator ended"), Some("the answer is not as agreed")),
    ("rm -f output.json; exit 0", Some("the simulator ended"), Some("no `output.json`")),
    ("kill -SEGV $$", Some("the simulator ended"), Some("the simulator ended")),
    (
        r#"printf '{"outputs":'; exit 0"#,
        Some("the simulator ended"),
        Some("the answer is not as agreed"),
    ),
    ("echo hello", NOT_AS_AGREED, NOT_AS_AGREED),
    ("echo", NOT_AS_AGREED, NOT_AS_AGREED),
    ("echo '[1, 2]'", NOT_AS_AGREED, NOT_AS_AGREED),
    (r"printf '\377\376\000\n'", NOT_AS_AGREED, NOT_AS_AGREED),
    (r#"echo '{"outputs":{"y":1,"seed":2},"time":3}'"#, NOT_AS_AGREED, NOT_AS_AGREED),
    (r#"echo '{"outputs":[1,2]}'"#, NOT_AS_AGREED, NOT_AS_AGREED),
    ("head -c 2000000 /dev/zero | tr '\\0' a; echo", TOO_LONG, TOO_LONG),
    ("yes | tr -d '\\n'", TOO_LONG, None),
    ("yes", NOT_AS_AGREED, None),
    // What comes after the answer fails no run, whenever it comes.
    ("answer $run; echo done", None, NOT_AS_AGREED),
    (AND_MORE, None, NOT_AS_AGREED),
    ("answer $run; answer $run", None, NOT_AS_AGREED),
    ("answer $run; sleep 0.002; echo done", None, NOT_AS_AGREED),
    ("answer $run; yes | head -n 100000", None, NOT_AS_AGREED),
    ("answer 9007199254740993", Some("an answer out of turn"), Some("an answer out of turn")),
    (r#"echo '{"outputs":{"y":1}}'"#, Some("an output is missing"), Some("an output is missing")),
    (
        r#"echo '{"outputs":{"y":1,"y":1,"seed":2}}'"#,
        Some("an output is repeated"),
        Some("an output is repeated"),
    ),
    (
        r#"echo '{"outputs":{"y":1,"seed":2,"z":3}}'"#,
        Some("an output is not declared"),
        Some("an output is not declared"),
    ),
    (r#"echo '{"outputs":{"y":NaN,"seed":2}}'"#, NOT_FINITE, NOT_FINITE),
    (r#"echo '{"outputs":{"y":1,"seed":-Infinity}}'"#, NOT_FINITE, NOT_FINITE),
    (r#"echo '{"outputs":{"y":1e999,"seed":2}}'"#, NOT_FINITE, NOT_FINITE),
    (r#"echo '{"outputs":{"y":null,"seed":2}}'"#, NOT_FINITE, NOT_FINITE),
    (r#"echo '{"outputs":{"y":"1","seed":2}}'"#, NOT_FINITE, NOT_FINITE),
    (
        r#"echo '{"outputs":{"y":1,"seed":2},"error":"both"}'"#,
        Some("neither outputs nor an error"),
        Some("neither outputs nor an error"),
    ),
    (
        r#"echo '{"error":" "}'"#,
        Some("simulator: it gives no reason"),
        Some("simulator: it gives no reason"),
    ),
    (
        r#"echo "{\"error\":\"diverged at $x s\"}""#,
        Some("simulator: diverged at # s"),
        Some("simulator: diverged at # s"),
    ),
    ("head -c 300000 /dev/zero | tr '\\0' e >&2; answer $run", None, None),
    // The next run is answered with this one's number, or not at all.
    ("answer $run; read -r line; answer $run", None, NOT_AS_AGREED),
    ("answer $run; read -r line; exit 1", None, Some("the simulator ended")),
];
const NOT_AS_AGREED: Option<&str> = Some("the answer is not as agreed");
const TOO_LONG: Option<&str> = Some("the answer is too long");
const NOT_FINITE: Option<&str> = Some("an output is not a finite number");

/// Every misbehaviour in no run, in the first, in any, in every one, on 1, 2 and 3 threads.
#[test]
fn misbehaviour_fails_its_own_runs_alone() {
    let mut rng = Streams::new(SEED, "places", "places").run(0);
    for (mischief, kind, _) in MISCHIEF {
        let simulator = simulator(mischief, false, 60.0);
        for on in 1..=3 {
            let share = [0.1, 0.4, 1.0][on - 1];
            let places: BTreeSet<u64> = (0..12).filter(|_| rng.random_bool(share)).collect();
            for places in [places, BTreeSet::from([0])] {
                let table = table(&simulator, &places, 12, on);
                let failed = if kind.is_some() { &places } else { &BTreeSet::new() };
                assert_rows(&table, failed, kind.unwrap_or("ok"), mischief);
            }
        }
    }
}

/// What a process started and left behind holds its pipes open, and is not waited for; an answer that it had given counts.
#[test]
fn what_an_ended_process_left_behind_is_not_waited_for() {
    let places = BTreeSet::from([1]);
    for (mischief, kind) in [
        ("sleep 500 & exit 3", Some("the simulator ended")),
        ("(exec 3<&0; sleep 500) & exit 3", Some("the simulator ended")),
        ("(while sleep 0.01; do echo busy >&2; done) & exit 3", Some("the simulator ended")),
        ("sleep 500 & answer $run; exit 0", None),
    ] {
        let simulator = simulator(mischief, false, 300.0);
        let table = table(&simulator, &places, 3, 1);
        let failed = if kind.is_some() { &places } else { &BTreeSet::new() };
        assert_rows(&table, failed, kind.unwrap_or("ok"), mischief);
    }
}

/// The answer and a line more in one write.
const AND_MORE: &str =
    r#"printf '{"run":%s,"outputs":{"y":%s,"seed":%s}}\nall done\n' "$run" "$x" "$seed""#;

#[test]
fn processes_that_write_unasked_are_counted() {
    let mut rng = Streams::new(SEED, "unasked", "places").run(0);
    for share in [0.0, 0.2, 0.5, 1.0] {
        let simulator = simulator(AND_MORE, false, 60.0);
        let places: BTreeSet<u64> = (0..20).filter(|_| rng.random_bool(share)).collect();
        let table = table(&simulator, &places, 20, 1);
        assert_rows(&table, &BTreeSet::new(), "ok", AND_MORE);
        // What the last run leaves is noticed by nobody.
        let ended = places.iter().filter(|run| **run < 19).count() as u64;
        let found = simulator.unasked();
        let told = found.as_ref().map(|found| (found.processes(), found.text()));
        assert_eq!(told, (ended > 0).then_some((ended, "all done")), "{places:?}");
    }
}

#[test]
fn misbehaviour_with_files_fails_its_own_runs_alone() {
    let mut rng = Streams::new(SEED, "files", "places").run(0);
    for (mischief, _, kind) in MISCHIEF {
        // It would fill the disk.
        if mischief.starts_with("yes") {
            continue;
        }
        let simulator = simulator(mischief, true, 60.0);
        let places: BTreeSet<u64> = (0..6).filter(|_| rng.random_bool(0.4)).collect();
        let failed = if kind.is_some() { &places } else { &BTreeSet::new() };
        assert_rows(&table(&simulator, &places, 6, 2), failed, kind.unwrap_or("ok"), mischief);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// Rows are the same, to the text of every reason, on any number of threads, in any order, with any runs before.
    #[test]
    fn runs_depend_on_their_inputs_alone(
        places in prop::collection::btree_set(0_u64..20, 0..20),
        which in prop::sample::select(MISCHIEF.to_vec()),
    ) {
        let simulator = simulator(which.0, false, 60.0);
        let all: Vec<String> = (1..4)
            .map(|on| {
                let table = table(&simulator, &places, 20, on);
                let row = |row: gyradius_campaign::Row<'_>| {
                    let cells: Vec<_> = row.cells().map(|(_, cell)| cell.to_string()).collect();
                    format!("{:?} {cells:?}\n", row.failure())
                };
                table.rows().map(row).collect()
            })
            .collect();
        prop_assert_eq!(&all[0], &all[1]);
        prop_assert_eq!(&all[0], &all[2]);
        // A run alone says the same.
        let simulation = simulation(&simulator, places, 0);
        for run in 0..4 {
            let told = simulation.replay(run);
            let line = all[0].lines().nth(run as usize).unwrap();
            let number = format!("\"run\":{run},");
            prop_assert!(told.request.unwrap().contains(&number), "{}", number);
            match told.outputs {
                Ok(outputs) => {
                    prop_assert!(line.starts_with("None"), "{}", line);
                    prop_assert_eq!(outputs.len(), 2);
                    prop_assert_eq!(told.answer.unwrap().chars().next(), Some('{'));
                }
                Err(failure) => prop_assert!(line.starts_with(&format!("{:?} ", Some(&failure))), "{}", line),
            }
        }
    }
}

/// What is left in the place of the file with the answer is called by its name.
#[cfg(unix)]
#[test]
fn what_is_no_file_is_told() {
    const GONE: &str = "rm -f output.json; ";
    for (mischief, told) in [
        ("", "left no file `output.json`"),
        ("mkdir output.json", "left a folder called `output.json`, which must be a regular file"),
        ("mkfifo output.json", "left a named pipe called `output.json`"),
        ("ln -s input.json output.json", "left a symbolic link called `output.json`"),
        ("ln -s nowhere output.json", "left a symbolic link called `output.json`"),
        ("touch output.json", "`output.json` is empty"),
        ("echo > output.json", "`output.json` is empty"),
        ("echo hi > output.json", "`output.json` does not hold a JSON object as agreed: "),
        ("echo '[0, {}, null]' > output.json", "as agreed: it is a list"),
    ] {
        let simulator = simulator(&format!("{GONE}{mischief}\nexit 0"), true, 60.0);
        let outputs = simulation(&simulator, BTreeSet::from([0]), 0).replay(0).outputs;
        let message = outputs.unwrap_err().message().to_owned();
        assert!(message.contains(told) && !message.contains("standard error"), "{message}");
    }
}

/// Whoever hangs is killed in time, in the first run and in any other, also if it does not read what is sent.
#[test]
fn hanging_is_no_answer_in_time() {
    // At the same time, as all that they do is wait.
    thread::scope(|scope| {
        for (place, per_run) in [(0, false), (2, false), (1, true)] {
            scope.spawn(move || {
                let simulator = simulator("echo 'step 7' >&2; sleep 1000", per_run, 1.5);
                let places = BTreeSet::from([place]);
                let table = table(&simulator, &places, 4, 1);
                assert_rows(&table, &places, "no answer in time", "hangs");
                let message = table.failures().next().unwrap().1.message().to_owned();
                assert_eq!(
                    message,
                    "no answer within 1.5 s; its last line on standard error: step 7"
                );
            });
        }
    });
    let deaf = Program::new(&["sleep".into(), "1000".into()], Path::new("/")).unwrap();
    let deaf = Simulator::start(deaf.with_timeout(0.2).unwrap()).unwrap();
    let told = simulation(&deaf, BTreeSet::new(), 10_000).replay(0);
    assert_eq!(told.outputs.unwrap_err().kind(), "no answer in time");
}

#[test]
fn closed_pipes_are_told() {
    let simulator = simulator("echo 'no more' >&2; exec <&- >&-; sleep 1000", false, 60.0);
    let places = BTreeSet::from([1]);
    let table = table(&simulator, &places, 3, 1);
    assert_rows(&table, &places, "the simulator closed its pipes", "closes");
    assert!(table.failures().next().unwrap().1.message().ends_with("standard error: no more"));
}

/// Numbers that are not finite, or that cannot be drawn, are not sent; the row has what there is.
#[test]
fn inputs_that_cannot_be_sent_fail() {
    struct Odd;

    impl Inputs for Odd {
        fn columns(&self) -> Vec<Column> {
            ["a", "b"].into_iter().map(|name| Column::number(name, "1", "Odd.")).collect()
        }

        fn place_columns(&self) -> Vec<Column> {
            vec![Column::new("ring", Kind::Integer, "Where it belongs.").required()]
        }

        fn place(&self, run: u64) -> Vec<i64> {
            vec![7 * run as i64 - 1]
        }

        fn draw(&self, run: u64, numbers: &mut Vec<Option<f64>>) -> Result<(), Failure> {
            if run == 3 {
                numbers.extend([None, Some(0.25)]);
                return Ok(());
            }
            numbers.push(Some(1.5));
            match run {
                0 => numbers.push(Some(f64::NAN)),
                1 => numbers.push(Some(f64::INFINITY)),
                _ => return Err(Failure::new("no body", "no body after 3 draws")),
            }
            Ok(())
        }
    }

    let simulator = simulator("", false, 60.0);
    let simulation = ExternalSimulation::new(&simulator, 1, "any", Odd, outputs());
    let table = run(&simulation, "any", 3, &threads(Some(1)).unwrap(), &|_| {}).unwrap();
    // What a run does not have is not sent.
    let told = simulation.replay(3);
    let sent = told.request.unwrap();
    assert!(sent.ends_with(r#""inputs":{"b":0.25}}"#));
    // Where a run belongs is sent and written, whatever becomes of the run.
    assert!(sent.starts_with(r#"{"run":3,"ring":20,"model":"any","seed":"#), "{sent}");
    let rows = table.rows().map(|row| row.cells().nth(3).unwrap().1.to_string());
    assert_eq!(rows.collect::<Vec<_>>(), ["-1", "6", "13"]);
    let kinds: Vec<_> = table.failures().map(|(_, failure)| failure.kind()).collect();
    assert_eq!(kinds, ["an input is not finite", "an input is not finite", "no body"]);
    assert_eq!(table.values("a"), Some(vec![1.5; 3]));
    assert_eq!(table.numbers("b").unwrap().get(2), None);
    assert!(simulation.replay(2).request.is_none());
}

#[test]
fn what_cannot_be_started_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("plain.txt"), "").unwrap();
    let here = folder.path();
    for words in [&["gyradius-no-such-program"][..], &["./no-such-file"], &["./plain.txt"], &["/"]]
    {
        let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
        let program = Program::new(&words, here).unwrap();
        for program in [program.clone(), program.per_run()] {
            let refused = Simulator::start(program).unwrap_err();
            assert!(matches!(refused, ProgramError::Start { .. }), "{refused}");
        }
    }
    for words in [vec![], vec![String::new()]] {
        assert!(matches!(Program::new(&words, here), Err(ProgramError::Empty)));
    }
    let absent = here.join("absent");
    assert!(matches!(Program::new(&["sh".into()], &absent), Err(ProgramError::Folder { .. })));
    let file = Program::new(&["sh".into()], &here.join("plain.txt")).unwrap_err();
    assert!(matches!(file, ProgramError::NoFolder { .. }), "{file}");
    assert!(file.to_string().ends_with("plain.txt, is a file: it must be a folder"), "{file}");
    let program = Program::new(&["sh".into()], here).unwrap();
    for timeout_s in [0.0, -1.0, f64::NAN, f64::INFINITY, 2e6] {
        let refused = program.clone().with_timeout(timeout_s);
        assert!(matches!(refused, Err(ProgramError::Timeout { .. })));
    }
}

/// Words that name files of the folder are found from anywhere; others stay as they are.
#[test]
fn files_of_the_folder_are_found() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("spin.sh"), "").unwrap();
    let words = ["sh", "spin.sh", "./spin.sh", "-x", "", "other.sh"].map(str::to_owned);
    let program = Program::new(&words, folder.path()).unwrap();
    let full: Vec<bool> =
        program.words().iter().map(|word| Path::new(word).is_absolute()).collect();
    assert_eq!(full, [false, true, true, false, false, false]);
    // The program itself is one of the system's, unless it is said to be here.
    let program = Program::new(&["spin.sh".into()], folder.path()).unwrap();
    assert_eq!(program.words(), ["spin.sh"]);
}

/// What a simulator starts goes with it, when it misbehaves and at the end; and so does one that does not end by itself.
#[cfg(target_os = "linux")]
#[test]
fn nothing_stays() {
    let folder = tempfile::tempdir().unwrap();
    let pids = folder.path().join("pids");
    let note = format!("sleep 1000 & echo $! >> '{}'", pids.display());
    for mischief in [
        format!("{note}; exit 1"),
        format!("{note}; answer $run; trap '' TERM; while :; do sleep 1000; done"),
        format!("{note}; yes | tr -d '\\n'"),
    ] {
        for per_run in [false, true] {
            // In files, the shell's wait is over when it has answered.
            let mischief = if per_run { format!("{note}; answer $run") } else { mischief.clone() };
            let simulator = simulator(&mischief, per_run, 1.0);
            table(&simulator, &BTreeSet::from([0, 2]), 3, 2);
        }
    }
    let pids = std::fs::read_to_string(&pids).unwrap();
    assert!(pids.lines().count() >= 12, "{pids}");
    for pid in pids.lines() {
        // A process that was killed may need a moment, and one that is gone may wait for its parent to look.
        let stat = || std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        let state = |stat: &str| stat.rsplit(") ").next().and_then(|rest| rest.chars().next());
        let is_gone = || matches!(state(&stat()), None | Some('Z' | 'X'));
        let gone = (0..1000).any(|_| {
            thread::sleep(Duration::from_millis(10));
            is_gone()
        });
        assert!(gone, "{pid} runs on: {}", stat());
    }
}

/// Python reads and writes the same numbers, where it is there.
#[test]
fn python_speaks_it_too() {
    const PYTHON: &str = r#"
import json, sys
for line in sys.stdin:
    asked = json.loads(line)
    outputs = {"y": asked["inputs"]["x"], "seed": asked["seed"]}
    if asked["inputs"]["mischief"]:
        outputs["y"] = float("nan")
    print(json.dumps({"run": asked["run"], "outputs": outputs}), flush=True)
"#;
    let words = ["python3", "-c", PYTHON].map(str::to_owned);
    let there = std::process::Command::new("python3").arg("--version").output();
    if !there.is_ok_and(|output| output.status.success()) {
        return;
    }
    let simulator = Simulator::start(Program::new(&words, Path::new("/")).unwrap()).unwrap();
    let places = BTreeSet::from([3, 50]);
    let table = table(&simulator, &places, 200, 2);
    assert_rows(&table, &places, "an output is not a finite number", "Python");
}
