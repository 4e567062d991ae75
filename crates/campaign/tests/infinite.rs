//! Infinite numbers in requirements: of simulators, in run tables and in tables of others.

use gyradius_campaign::{
    Column, ExternalSimulation, FailedRuns, Failure, ForeignTable, Inputs, Judgement, Judging,
    Program, Requirement, RunInputs, Runs, Simulator, SimulatorFunction, Surveys, run, threads,
};
use gyradius_statistics::Confidence;
use proptest::prelude::*;
use std::{fs, path::Path};

use crate::scratch::{scratch, written};

/// Runs without inputs.
struct Nothing;

impl Inputs for Nothing {
    fn columns(&self) -> Vec<Column> {
        Vec::new()
    }

    fn draw(&self, _run: u64, _numbers: &mut Vec<Option<f64>>) -> Result<(), Failure> {
        Ok(())
    }
}

proptest! {
    /// Whatever a simulator answers, a study counts what its own table says, in any file, and what a table that others wrote says: an
    /// infinite number against the requirement, and as one without a number whatever came to nothing.
    #[test]
    fn what_is_answered_is_judged_alike_everywhere(
        runs in prop::collection::vec(prop::option::weighted(0.9, [answered(), answered()]), 1..60),
        (quantity, place) in prop::sample::select(vec![("x", Some(0)), ("y", Some(1)), ("abs(y)", Some(1)), ("norm(x, y)", None)]),
        bound in prop::sample::select(vec![" <= 1", " >= 1", " >= -1 and <= 2"]),
        left_out: bool,
    ) {
        let requirement: Requirement = match bound {
            " >= -1 and <= 2" => format!("-1 <= {quantity} <= 2 in 60 % at 80 %"),
            _ => format!("{quantity}{bound} in 60 % at 80 %"),
        }.parse().unwrap();
        let requirement =
            requirement.with_failed_runs(if left_out { FailedRuns::LeftOut } else { FailedRuns::Against });
        let outcomes = runs.clone();
        let simulator = Simulator::function(SimulatorFunction::new(move |inputs: &RunInputs<'_>| {
            let [x, y] = outcomes[inputs.run() as usize].ok_or("it diverged")?;
            Ok(vec![("x".to_owned(), x), ("y".to_owned(), y)])
        }));
        let outputs = ["x", "y"].map(|name| Column::number(name, "1", "An output.")).to_vec();
        let simulation = ExternalSimulation::new(&simulator, 7, "any", Nothing, outputs);
        let table = run(&simulation, "any", runs.len() as u64, &threads(Some(2)).unwrap(), &|_| {}).unwrap();

        // By hand: failed, infinite, and without a number.
        let (mut beyond, mut infinite, mut without) = (0, 0, 0);
        for run in &runs {
            let of: Vec<f64> = run.iter().flat_map(|run| match place {
                Some(place) => vec![run[place]],
                None => run.to_vec(),
            }).collect();
            let has_all = run.is_some_and(|run| run.iter().all(|x| x.is_finite()));
            if of.iter().any(|x| x.is_infinite()) {
                infinite += 1;
            } else if !has_all {
                without += 1;
            } else {
                let number = match (quantity, &of[..]) {
                    ("abs(y)", [y]) => y.abs(),
                    (_, [number]) => *number,
                    (_, both) => both[0].hypot(both[1]),
                };
                let keeps = match bound {
                    " <= 1" => number <= 1.0,
                    " >= 1" => number >= 1.0,
                    _ => (-1.0..=2.0).contains(&number),
                };
                beyond += u64::from(!keeps);
            }
        }
        let judging = Judging::new([requirement.clone()], runs.len() as u64, 1);
        judging.look(&table);
        let judged = judging.finish(&Runs::from(table.clone())).unwrap().remove(0);
        prop_assert_eq!(judged.runs_infinite(), infinite);
        let is_infinite = |run: &&u64| {
            let [x, y] = runs[**run as usize].unwrap_or_default();
            place.map_or(x.is_infinite() || y.is_infinite(), |place| [x, y][place].is_infinite())
        };
        let all: Vec<u64> = (0..runs.len() as u64).collect();
        let first: Vec<u64> = all.iter().filter(is_infinite).copied().take(10).collect();
        prop_assert_eq!(judged.first_infinite(), first);
        prop_assert_eq!(judged.failures(), beyond + infinite + if left_out { 0 } else { without });
        prop_assert_eq!(judged.counted(), runs.len() as u64 - if left_out { without } else { 0 });

        let scratch = scratch();
        let of_file = |path: &Path| {
            let table = ForeignTable::open(path).unwrap();
            Judgement::of_table(std::slice::from_ref(&requirement), &table).unwrap().remove(0)
        };
        for name in ["it.csv", "it.parquet"] {
            prop_assert_eq!(&of_file(&written(&table, scratch.path(), name)), &judged, "{}", name);
        }
        let cells = |run: &Option<[f64; 2]>| match (run, place) {
            (None, _) => ",\n".to_owned(),
            // What a run without one of them has of the other is no number in a study.
            (Some(of), Some(place)) if of.iter().any(|x| !x.is_finite()) && of[place].is_finite() => ",\n".to_owned(),
            (Some([x, y]), _) => format!("{x},{y}\n"),
        };
        let path = scratch.path().join("others.csv");
        fs::write(&path, format!("x,y\n{}", runs.iter().map(cells).collect::<String>())).unwrap();
        prop_assert_eq!(&of_file(&path), &judged);

        // What is infinite is no number of the surveys, which are of the runs that ended well.
        let ended = |place: usize| {
            let ended = runs.iter().flatten().filter(|run| run.iter().all(|x| x.is_finite()));
            ended.filter(|run| run[place].is_finite()).count() as u64
        };
        let surveys = Surveys::new(&Runs::from(table), Confidence::default()).unwrap();
        for (place, name) in ["x", "y"].iter().enumerate() {
            let survey = surveys.column(name).unwrap();
            prop_assert_eq!(survey.n(), ended(place));
            prop_assert_eq!(survey.mean().is_some(), ended(place) > 0);
        }
    }
}

/// A number that a simulator answers: most are finite.
fn answered() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => (-3..4_i32).prop_map(f64::from),
        1 => prop::sample::select(vec![f64::INFINITY, f64::NEG_INFINITY, f64::NAN]),
    ]
}

/// An infinite number keeps no bound, of whatever sign, and is not left out: a study counts such a run as failed.
#[test]
fn infinite_numbers_are_failures() {
    let bounds = ["x <= 2", "x >= -2", "-2 <= x <= 2", "abs(x) <= 2", "norm(x, y) <= 2"];
    for (bound, cell) in
        bounds.iter().flat_map(|bound| ["inf", "-inf", "1e999"].map(|x| (bound, x)))
    {
        for left_out in [FailedRuns::Against, FailedRuns::LeftOut] {
            let text = format!("x,y\n{cell},1\n{}", "1,1\n".repeat(98));
            let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
            let requirement: Requirement = format!("{bound} in 95 % at 90 %").parse().unwrap();
            let judged =
                Judgement::of_table(&[requirement.with_failed_runs(left_out)], &table).unwrap();
            assert_eq!((judged[0].failures(), judged[0].counted()), (1, 99), "{bound} {cell}");
            let told = judged[0].to_string();
            assert!(
                told.contains("1 run whose number is infinite counts against it: 0\n"),
                "{told}"
            );
            assert!(!told.contains("without a number"), "{told}");
            let read: Judgement =
                serde_json::from_str(&serde_json::to_string(&judged[0]).unwrap()).unwrap();
            assert_eq!(read, judged[0]);
        }
    }
}

/// What a process that is started for one run left in its file is of this run, whatever else is in the file and however the process ended.
#[cfg(unix)]
#[test]
fn what_is_infinite_in_a_file_stays() {
    let outputs = vec![Column::number("y", "1", "An output.")];
    let runs = 2;
    for (cell, y) in [("1e999", f64::INFINITY), ("-Infinity", f64::NEG_INFINITY)] {
        for (run, behind, then) in [
            ("$run", "}", "exit 3"),
            ("$run", "}", "sleep 100"),
            ("$run", "} trailing", ""),
            ("$run", "", ""),
            ("$run", "", "sleep 100"),
            ("7", "}", ""),
            ("7", "};", "exit 3"),
        ] {
            let script = format!(
                "read -r line < input.json; run=${{line#*'\"run\":'}}; run=${{run%%,*}}; \
                 printf '%s' '{{\"run\":'\"{run}\"',\"outputs\":{{\"y\":{cell}}}{behind}' > output.json; {then}"
            );
            let program =
                Program::new(&["sh".into(), "-c".into(), script], Path::new("/")).unwrap();
            let program = program.with_timeout(1.0).unwrap().per_run();
            let simulator = Simulator::start(program).unwrap();
            let simulation =
                ExternalSimulation::new(&simulator, 7, "any", Nothing, outputs.clone());
            let table = gyradius_campaign::run(
                &simulation,
                "any",
                runs,
                &threads(Some(2)).unwrap(),
                &|_| {},
            )
            .unwrap();
            for (place, row) in table.rows().enumerate() {
                assert!(row.failure().is_some(), "{run} {behind} {then}");
                let found = table.numbers("y").unwrap().get(place);
                assert_eq!(found, Some(y), "{run} {behind} {then}: {:?}", row.failure());
            }
        }
    }
}
