//! Campaigns of vehicles and flights: they go on, are put together of shards, and tell what is independent.

use gyradius_statistics::{Confidence, Moments, Proportion};
use std::thread;

use super::{
    AnyScenario, Options, Shard, SimulatorReplay, SimulatorScenario, Status, files, folder, fs,
    put_together, scenario, vehicles::text,
};
use crate::{Draw, DrawOptions, Which};

/// Answers with a quantity and where the run belongs, and fails if the quantity is above 0.9.
const SCRIPT: &str = r#"
while read -r line; do
    x=${line##*'"x":'}; x=${x%%[,\}]*}
    v=${line#*'"vehicle":'}; v=${v%%,*}
    f=${line#*'"flight":'}; f=${f%%,*}
    case $x in
        0.9*) echo "{\"error\":\"too large: $x\"}" ;;
        *) echo "{\"outputs\":{\"y\":$x,\"v\":$v,\"f\":$f}}" ;;
    esac
done
"#;

/// A quantity that is drawn for vehicles, and one for flights, of one body.
fn study_text(size: &str) -> String {
    let given = [(0, 0), (1, 0), (6, 0), (7, 0)].into_iter().collect();
    text(size, &given, Some(1.0), |at| [0, 6].contains(&at).then_some("vehicle"))
}

fn script() -> tempfile::TempDir {
    let folder = folder();
    fs::write(folder.path().join("answer.sh"), SCRIPT).unwrap();
    folder
}

/// More vehicles leave the rows that are there; fewer, or another number of flights, are refused. What is told of means and
/// failures is of vehicles; a flight is replayed to the bit, and is drawn alone as it was sent.
#[test]
fn campaigns_of_vehicles_go_on() {
    let folder = script();
    let make = |vehicles: u64, flights: u64| {
        let size = format!("vehicles = {vehicles}\nflights = {flights}");
        scenario(&study_text(&size), folder.path())
    };
    let options = |place: &str, threads| Options {
        threads: Some(threads),
        ..Options::to(folder.path().join(place))
    };
    let run = |scenario: &SimulatorScenario, place: &str, threads| {
        scenario.study(&options(place, threads), &|_| {}, &|_| {})
    };
    let before = run(&make(12, 5), "a", 1).unwrap().rows();
    let large = run(&make(30, 5), "a", 2).unwrap();
    let after = large.rows();
    assert_eq!((before.len(), after.len()), (120, 300));
    assert!(before[..60] == after[..60] && before[60..] == after[150..210]);
    assert!(run(&make(30, 5), "b", 1).unwrap().rows() == after);
    for (other, told) in [
        (make(30, 6), "flights is 5 there and 6 here"),
        (make(29, 5), "vehicles is 30 there and 29 here"),
    ] {
        let error = run(&other, "a", 2).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }

    let table = large.runs()[0].table().unwrap();
    let numbers = |name: &str| -> Vec<Option<f64>> {
        let numbers = table.numbers(name).unwrap();
        (0..150).map(|run| numbers.get(run)).collect()
    };
    for (run, (v, f)) in numbers("v").into_iter().zip(numbers("f")).enumerate() {
        let place = [run / 5, run % 5].map(|index| index as f64);
        assert!(
            [v, f]
                .into_iter()
                .zip(place)
                .all(|(told, index)| told.is_none_or(|told| told == index))
        );
        let row = table.row(run).unwrap();
        let own: Vec<String> = row.cells().take(5).map(|(_, cell)| cell.to_string()).collect();
        assert_eq!(own[1..2], [run.to_string()]);
        assert_eq!(own[3..], place.map(|index| format!("{index}")));
    }

    let summary = serde_json::to_value(large.summary()).unwrap();
    assert_eq!(summary["independent_runs_per_model"], 30);
    for column in ["x", "p", "hub_i11"] {
        let values: Vec<f64> = numbers(column).into_iter().flatten().collect();
        let means: Vec<f64> = values.chunks(5).map(|g| g.iter().sum::<f64>() / 5.0).collect();
        assert_eq!(means.len(), 30);
        let expected = Moments::new(&means).unwrap().mean_interval(Confidence::default());
        let (_, _, samples) =
            large.summary().overview.quantities().find(|(name, ..)| *name == column).unwrap();
        let interval = samples[0].mean_interval.unwrap();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * a.abs();
        assert!(near(interval.lower(), expected.lower()), "{column}: {interval} {expected}");
        assert!(near(interval.upper(), expected.upper()), "{column}: {interval} {expected}");
    }
    let failed: Vec<bool> = table.rows().map(|row| row.failure().is_some()).collect();
    let first = failed.iter().step_by(5).filter(|failed| **failed).count() as u64;
    let count = failed.iter().filter(|failed| **failed).count() as u64;
    assert!(first > 0 && count == 5 * first);
    let share = &summary["overview"]["models"][0]["failed"];
    assert_eq!((share["count"].as_u64(), share["of"].as_u64()), (Some(count), Some(150)));
    let expected = Proportion::new(first, 30).unwrap().interval(Confidence::default());
    assert_eq!(share["interval"], serde_json::to_value(expected).unwrap());

    let there = SimulatorScenario::read(large.folder()).unwrap();
    for (vehicle, flight) in [(0, 0), (9, 2), (29, 4)] {
        let replay = SimulatorReplay::new(&there, None, Which::Flight { vehicle, flight }).unwrap();
        let run = (5 * vehicle + flight) as usize;
        let sent = replay.told().request.clone().unwrap();
        let place = format!("{{\"run\":{run},\"vehicle\":{vehicle},\"flight\":{flight},\"model\":");
        assert!(sent.starts_with(&place), "{sent}");
        let told = format!("proposed, run {run} (vehicle {vehicle}, flight {flight})");
        assert!(replay.to_string().starts_with(&told), "{replay}");
        let outputs = replay.told().outputs.as_ref();
        assert_eq!(outputs.err(), table.row(run).unwrap().failure());
        assert_eq!(outputs.ok().map(|all| all[0].to_bits()), numbers("y")[run].map(f64::to_bits));
    }
    for (vehicle, flight) in [(30, 0), (0, 5), (u64::MAX, u64::MAX)] {
        let error = SimulatorReplay::new(&there, None, Which::Flight { vehicle, flight });
        let error = error.unwrap_err().to_string();
        assert!(error.contains("30 vehicles of 5 flights each"), "{error}");
    }
    let report = fs::read_to_string(large.folder().join("report.md")).unwrap();
    assert!(report.contains("30 vehicles of 5 flights each"), "{report}");
    assert!(report.contains("runs are not independent"), "{report}");

    let mut written = Vec::new();
    Draw::of_simulator(&there, &DrawOptions::default())
        .unwrap()
        .write(&mut written, &|_| {})
        .unwrap();
    let written = String::from_utf8(written).unwrap();
    let lines: Vec<Vec<&str>> = written.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(lines[0][..5], ["model", "run", "status", "vehicle", "flight"]);
    let x = lines[0].iter().position(|name| *name == "x").unwrap();
    for (run, value) in numbers("x").into_iter().enumerate() {
        let line = &lines[run + 1];
        let place = [run / 5, run % 5].map(|index| index.to_string());
        assert_eq!(line[3..5], place);
        assert_eq!(line[x].parse::<f64>().ok(), value);
    }
}

/// Shards with any number of threads make the bytes of one process.
#[test]
fn shards_of_vehicles_are_one_study() {
    let folder = script();
    // Eight blocks, which end within vehicles.
    let scenario = scenario(&study_text("vehicles = 63\nflights = 30"), folder.path());
    let any = AnyScenario::Simulator(Box::new(scenario.clone()));
    let out = |name: &str| folder.path().join(name);
    let options =
        |name: &str, threads| Options { threads: Some(threads), ..Options::to(out(name)) };
    scenario.study(&options("whole", 2), &|_| {}, &|_| {}).unwrap();
    let written = |name: &str| {
        let mut all = files(&out(name));
        all.retain(|name, _| !name.starts_with(".gyradius"));
        all
    };
    let whole = written("whole");
    assert!(whole.len() > 8, "{:?}", whole.keys());
    // At the same time: most of it waits for the script.
    thread::scope(|scope| {
        for (of, threads) in [(1, 1), (1, 3), (4, 1), (4, 3), (7, 1), (7, 3)] {
            let (any, out, options, written, whole) = (&any, &out, &options, &written, &whole);
            scope.spawn(move || {
                let name = format!("{of}-{threads}");
                for i in (1..=of).rev() {
                    let shard: Shard = format!("{i}/{of}").parse().unwrap();
                    any.run_shard(&options(&name, threads), shard, &|_| {}, &|_| {}).unwrap();
                }
                let models = Status::read(&out(&name)).unwrap().models;
                let done: u64 = models.iter().map(|model| model.finished).sum();
                assert_eq!(done, 2 * 63 * 30);
                put_together(&out(&name), &Options::default(), &|_| {}).unwrap();
                let own = written(&name);
                assert!(own.keys().eq(whole.keys()), "{:?} {:?}", own.keys(), whole.keys());
                for (file, bytes) in &own {
                    assert!(*bytes == whole[file], "{name}: {file}");
                }
            });
        }
    });
}
