//! Campaigns of simulators in scripts: what is drawn, that they go on, that one run is done again.

mod again;
mod failing;
mod fleets;
mod function;
mod goes_on;
mod interrupted;
mod joint;
mod judged;
mod kept;
mod models;
mod off_nominal;
mod refusals;
mod told;
mod vehicles;

use gyradius_campaign::{Inputs, Simulation, Table};
use proptest::prelude::*;
use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use super::{SimulatorDraws, SimulatorReplay, SimulatorScenario};
use crate::{
    AnyScenario, CampaignError, ModelKind, Options, Scenario, Shard, Status, StudyError, is_begun,
    model::{self, Separations},
    put_together, write_report,
};

/// Answers with a quantity, and fails if it is above 0.9.
const SCRIPT: &str = r#"
while read -r line; do
    run=${line#*'"run":'}; run=${run%%,*}
    x=${line##*'"x":'}; x=${x%%[,\}]*}
    case $x in
        0.9*) echo "{\"run\":$run,\"error\":\"too large: $x\"}" ;;
        *) echo "{\"run\":$run,\"outputs\":{\"y\":$x}}" ;;
    esac
done
"#;

const HEAD: &str = r#"
name = "shell"
runs = 300
seed = 5

[simulation]
command = ["sh", "answer.sh"]
timeout_s = 60.0

[[simulation.outputs]]
name = "y"
unit = "m"
meaning = "x again."
"#;

const BODY: &str = r#"
mass_kg = 120.0
inertia_kg_m2 = [[21.0, 0.2, -0.1], [0.2, 19.0, 0.3], [-0.1, 0.3, 26.0]]

[bodies.dispersion]
DISPERSION
root_second_moment_variance_kg_m2 = [0.001, 0.001, 0.001]
axes = "fixed"
"#;

const MODELS: &str = r#"
[[models]]
name = "proposed"
law = "principal"
axes = "whole-sphere"

[[models]]
name = "naive"
law = "entrywise"
matched_to = "proposed"
"#;

/// All files below a folder, by their paths from there.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for path in fs::read_dir(next).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                all.insert(name, fs::read(path).unwrap());
            }
        }
    }
    all
}

fn quantity(name: &str, law: &str) -> String {
    format!("\n[[quantities]]\nname = \"{name}\"\nunit = \"m\"\nlaw = {law}\n")
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("answer.sh"), SCRIPT).unwrap();
    folder
}

fn scenario(text: &str, folder: &Path) -> SimulatorScenario {
    let scenario = SimulatorScenario::from_toml(text, folder).unwrap();
    // What is resolved is the same scenario, from anywhere.
    let again = SimulatorScenario::from_toml(&scenario.to_toml(), Path::new("/")).unwrap();
    assert_eq!(again.to_toml(), scenario.to_toml());
    scenario
}

/// Payload and stage of a separation, as bodies of a simulator.
fn bodies_of(separation: &toml::Table) -> toml::Value {
    let body = |name: &str| {
        let given = separation[name].as_table().unwrap();
        let keys = ["mass_kg", "inertia_kg_m2", "dispersion"];
        let mut body: toml::Table =
            keys.iter().map(|key| ((*key).to_owned(), given[*key].clone())).collect();
        body.insert("name".to_owned(), name.into());
        toml::Value::Table(body)
    };
    vec![body("payload"), body("stage")].into()
}

/// A second quantity, which goes against the first.
fn correlated() -> String {
    quantity("z", "{ law = \"normal\", mean = 1.0, sigma = 0.1 }")
        + "\n[[correlations]]\nbetween = [\"x\", \"z\"]\ncoefficient = -0.8\n"
}

fn uniform() -> String {
    HEAD.to_owned() + &quantity("x", "{ law = \"uniform\", low = 0.1, high = 0.95 }")
}

/// What a model draws for some runs, column by column.
fn drawn(scenario: &SimulatorScenario, model: usize) -> Vec<(String, Vec<Option<u64>>)> {
    let model = SimulatorDraws::new(scenario, model).unwrap();
    let mut columns: Vec<(String, Vec<_>)> = Inputs::columns(&model)
        .iter()
        .map(|column| (column.name().to_owned(), Vec::new()))
        .collect();
    for run in 0..30 {
        let mut numbers = Vec::new();
        model.draw(run, &mut numbers).unwrap();
        assert_eq!(numbers.len(), columns.len());
        for ((_, values), number) in columns.iter_mut().zip(numbers) {
            values.push(number.map(f64::to_bits));
        }
    }
    columns
}

const LAWS: [&str; 9] = [
    "{ law = \"normal\", mean = 2.0, sigma = 0.1 }",
    "{ law = \"uniform\", low = -1.0, high = 3.0 }",
    "{ law = \"lognormal\", mean = 2.0, sigma = 0.5 }",
    "{ law = \"truncated-normal\", mean = 0.0, sigma = 1.0, low = -1.0, high = 2.0 }",
    "{ law = \"triangular\", low = -1.0, mode = 0.5, high = 3.0 }",
    "{ law = \"beta\", alpha = 2.0, beta = 3.0, low = 1.0, high = 4.0 }",
    "{ law = \"weibull\", low = 0.0, shape = 1.5, scale = 2.0 }",
    "{ law = \"samples\", samples = [1.0, 2.0, 4.0, 8.0] }",
    "{ law = \"bernoulli\", probability = 0.5 }",
];
/// What is dispersed of a body besides its inertia, and whether mass and mass centre are.
const DISPERSIONS: [(&str, bool, bool); 7] = [
    ("", false, false),
    ("mass_kg = 2.0", true, false),
    ("mass_percent = 1.0", true, false),
    ("mass_kg = 2.0\ninertia_follows_mass = 0.5", true, false),
    ("mass_centre_m = 0.01", false, true),
    (
        "mass_percent = 1.0\nmass_centre_m = [0.01, 0.02, { law = \"uniform\", low = -0.1, high = 0.1 }]",
        true,
        true,
    ),
    (
        "mass_centre_m = { covariance = [[1e-4, 5e-5, 0.0], [5e-5, 1e-4, 0.0], [0.0, 0.0, 1e-6]] }",
        false,
        true,
    ),
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Any bodies and quantities: what is declared to scatter does, what is not does not, and taking any of them away
    /// changes no other to the bit.
    #[test]
    fn every_dispersion_moves_its_column_and_no_other(
        bodies in prop::collection::vec(0..DISPERSIONS.len(), 0..3),
        quantities in prop::collection::vec(0..LAWS.len(), 0..4),
        model in 0_usize..2,
        left_out in any::<prop::sample::Index>(),
    ) {
        let text = |without: Option<usize>| {
            let body = |(i, d): (usize, &usize)| {
                let (dispersed, _, centre) = DISPERSIONS[*d];
                let centre = if centre { "\nmass_centre_m = [0.1, -0.2, 0.0]" } else { "" };
                let body = BODY.replace("DISPERSION", dispersed);
                format!("\n[[bodies]]\nname = \"b{i}\"{centre}{body}")
            };
            let parts = bodies.iter().enumerate().map(body);
            let others = quantities.iter().enumerate();
            let parts = parts.chain(others.map(|(i, law)| quantity(&format!("q{i}"), LAWS[*law])));
            let kept = parts.enumerate().filter(|(i, _)| Some(*i) != without).map(|(_, part)| part);
            HEAD.to_owned() + &kept.collect::<String>() + MODELS
        };
        let folder = folder();
        let whole = scenario(&text(None), folder.path());
        // Without a body, models have nothing to match.
        let model = if bodies.is_empty() { 0 } else { model };
        let columns = drawn(&whole, model);
        for (name, values) in &columns {
            let differ = values.iter().any(|value| *value != values[0]);
            let moves = match name.split_once('_') {
                Some((body, "mass_kg")) => DISPERSIONS[bodies[body[1..].parse::<usize>().unwrap()]].1,
                Some((_, axes)) if axes.starts_with('q') => false,
                Some(_) | None => true,
            };
            prop_assert_eq!(differ, moves, "{}", name);
            let axes = name.contains("_q");
            prop_assert_eq!(values[0].is_some(), !(axes && model == 1), "{}", name);
        }
        let count = bodies.len() + quantities.len();
        if count > 0 {
            let without = left_out.index(count);
            let less = scenario(&text(Some(without)), folder.path());
            if !(less.inputs().next().is_none() || bodies.len() == 1 && without == 0 && model == 1) {
                for (name, values) in drawn(&less, model) {
                    let (_, same) = columns.iter().find(|(other, _)| *other == name).unwrap();
                    prop_assert_eq!(&values, same, "{}", name);
                }
            }
        }
    }
}

/// Bodies of a separation draw the same bits as its payload and stage, under the same models.
#[test]
fn bodies_draw_what_payload_and_stage_do() {
    let separation = Scenario::peck_2003().unwrap();
    // Of each kind one with parameters of its own, and one that is matched.
    let mut text = separation.to_toml();
    for kind in ModelKind::ALL.into_iter().filter(|kind| *kind != ModelKind::Principal) {
        let own: String = ["stage", "payload"].map(|body| models::parameters(kind, body)).concat();
        for (name, fields) in [("own", own.as_str()), ("like", "matched_to = \"proposed\"")] {
            text +=
                &format!("\n[[models]]\nname = \"{name}-{kind}\"\nlaw = \"{kind}\"\n{fields}\n");
        }
    }
    let separation = Scenario::from_toml(&text).unwrap();
    let models = model::Model::all(&separation).unwrap();
    let table: toml::Table = toml::from_str(&text).unwrap();
    let mut own: toml::Table = toml::from_str(&uniform()).unwrap();
    own["seed"] = table["seed"].clone();
    own.insert("bodies".to_owned(), bodies_of(&table));
    let given = table["models"].as_array().unwrap();
    let names: Vec<String> =
        given.iter().map(|model| model["name"].as_str().unwrap().to_owned()).collect();
    own.insert("models".to_owned(), given.clone().into());
    let folder = folder();
    let scenario = scenario(&toml::to_string(&own).unwrap(), folder.path());
    for (place, name) in names.iter().enumerate() {
        let separations = Separations::new(&separation, &models[place]);
        let mut rows = Table::new(name, 0, separations.columns()).unwrap();
        separations.run(0..30, &mut separations.worker(), &mut rows).unwrap();
        let mut compared = 0;
        for (column, values) in drawn(&scenario, place) {
            if let Some(numbers) = rows.numbers(&column) {
                let expected: Vec<_> =
                    (0..30).map(|run| numbers.get(run).map(f64::to_bits)).collect();
                assert_eq!(values, expected, "{name}: {column}");
                compared += 1;
            }
        }
        assert_eq!(compared, 20, "six entries and four components of two bodies");
    }
}

/// A relative folder is one of the scenario's, wherever the command is typed.
#[test]
fn a_folder_is_beside_the_scenario() {
    let folder = folder();
    let sub = folder.path().join("sub");
    fs::create_dir(&sub).unwrap();
    fs::write(sub.join("answer.sh"), SCRIPT.replace(":$x}}", ":7}}")).unwrap();
    let here = std::env::current_dir().unwrap();
    assert_ne!(here, folder.path());
    let absolute = sub.to_str().unwrap();
    for (place, given) in
        [None, Some("."), Some("sub"), Some("./sub/../sub"), Some(absolute)].into_iter().enumerate()
    {
        let stated = given.map_or(String::new(), |given| format!("folder = {given:?}\n"));
        let text = uniform().replace("[simulation]\n", &format!("[simulation]\n{stated}"));
        let scenario = scenario(&text, folder.path()).with_runs(20).unwrap();
        let options = Options::to(folder.path().join(place.to_string()));
        let rows = scenario.study(&options, &|_| {}, &|_| {}).unwrap().rows();
        let in_sub = given.is_some_and(|given| given.contains("sub"));
        let seven = format!("{:x}", 7.0_f64.to_bits());
        assert!(rows.iter().any(|row| row.contains(&seven)) == in_sub, "{given:?}: {rows:?}");
        assert_eq!(rows.len(), 20);
    }
}

/// A campaign that is stopped anywhere goes on to the same rows, can be extended, and is not mixed with runs of another
/// simulator; its report is made again to the byte, and any run says the same alone.
#[test]
fn campaigns_go_on() {
    let folder = folder();
    let text = uniform();
    let scenario = scenario(&text, folder.path()).with_runs(700).unwrap();
    let options = |name: &str, threads: usize| Options {
        threads: Some(threads),
        ..Options::to(folder.path().join(name))
    };
    let run =
        |scenario: &SimulatorScenario, options: &Options| scenario.study(options, &|_| {}, &|_| {});
    let whole = run(&scenario, &options("whole", 2)).unwrap();
    let expected = whole.rows();
    assert_eq!(expected.len(), 700);

    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Options { stop: Some(Arc::clone(&stop)), ..options("stopped", 1) };
    let short = scenario.clone().with_runs(600).unwrap();
    let most = AtomicU64::new(0);
    let progress = |done| {
        most.fetch_max(done, Ordering::Relaxed);
        stop.store(done > 300, Ordering::Relaxed);
    };
    let ended = short.study(&stopped, &progress, &|_| {});
    assert!(matches!(ended, Err(StudyError::Campaign(CampaignError::Stopped))), "{ended:?}");
    // It stops within a block.
    assert!((301..310).contains(&most.into_inner()));
    run(&short, &options("stopped", 3)).unwrap();
    let extended = run(&scenario, &options("stopped", 2)).unwrap();
    assert_eq!(extended.rows(), expected);
    for name in ["summary.json", "report.html", "report.md"] {
        let [a, b] = [&whole, &extended].map(|study| fs::read(study.folder().join(name)).unwrap());
        assert!(a == b, "{name}");
    }

    // Failures are counted together, whatever their numbers.
    let failures: Vec<_> = whole.summary().overview.failures().collect();
    let [(_, [(kind, count)])] = failures[..] else { panic!("{failures:?}") };
    assert_eq!(kind, "simulator: too large: #");
    assert!((20..80).contains(count), "{count}");
    assert!(whole.summary().to_string().contains(&format!("700 runs, {count} failed")));

    let page = fs::read(whole.folder().join("report.html")).unwrap();
    fs::remove_file(whole.folder().join("report.html")).unwrap();
    write_report(whole.folder(), None, false).unwrap();
    assert!(fs::read(whole.folder().join("report.html")).unwrap() == page);

    let there = SimulatorScenario::read(whole.folder()).unwrap();
    let table = whole.runs()[0].table().unwrap();
    for run in [0, 255, 256, 699] {
        let replay = SimulatorReplay::new(&there, None, run).unwrap();
        let row = table.row(run as usize).unwrap();
        let outputs = replay.told().outputs.as_ref();
        assert_eq!(outputs.err(), row.failure());
        let y = table.numbers("y").unwrap().get(run as usize);
        assert_eq!(outputs.ok().map(|outputs| outputs[0].to_bits()), y.map(f64::to_bits));
        assert!(replay.to_string().contains("sent: {\"run\":"));
    }
    let beyond = SimulatorReplay::new(&there, None, 700).unwrap_err();
    assert!(beyond.to_string().contains("from 0 to 699"));

    fs::write(folder.path().join("answer.sh"), format!("{SCRIPT}\n# changed\n")).unwrap();
    let changed = SimulatorScenario::from_toml(&text, folder.path()).unwrap();
    let refused = run(&changed.with_runs(800).unwrap(), &options("whole", 1)).unwrap_err();
    let expected = "simulation.files_sha256.answer.sh is \"";
    assert!(refused.to_string().contains(expected), "{refused}");
    let file = whole.folder().join("scenario.toml");
    let begun = |text: &str| {
        let scenario = SimulatorScenario::from_toml(text, folder.path()).unwrap();
        SimulatorReplay::new(&scenario, None, 0).unwrap_err().to_string()
    };
    let resolved = fs::read_to_string(&file).unwrap();
    let refused = begun(&resolved);
    assert!(refused.contains("the file \"answer.sh\"") && refused.contains("changed"), "{refused}");
    let sha = resolved.lines().find(|line| line.starts_with("\"answer.sh\" =")).unwrap();
    let refused = begun(&resolved.replace(sha, ""));
    assert!(refused.contains("is there now"), "{refused}");
    fs::remove_file(folder.path().join("answer.sh")).unwrap();
    let refused = begun(&resolved);
    assert!(refused.contains("is not there any more"), "{refused}");
    // A file whose scenario was read is named with what is found wrong later.
    let refused = SimulatorReplay::new(&there, None, 0).unwrap_err().to_string();
    assert!(refused.starts_with(&file.display().to_string()), "{refused}");
}

/// Shards with any number of threads make the bytes of one process; a folder of shards is put together where the simulator is
/// not, and what is missing of it is told.
#[test]
fn shards_are_put_together_without_the_simulator() {
    let folder = folder();
    let scenario = scenario(&(uniform() + &correlated()), folder.path()).with_runs(1000).unwrap();
    let any = AnyScenario::Simulator(Box::new(scenario.clone()));
    let out = |name: &str| folder.path().join(name);
    let options = |name: &str| Options::to(out(name));
    let whole = scenario.study(&options("whole"), &|_| {}, &|_| {}).unwrap();
    let shard = |i: u64, of: u64| -> Shard { format!("{i}/{of}").parse().unwrap() };
    for (i, threads) in [(2, 1), (1, 3)] {
        let options = Options { threads: Some(threads), ..options("shards") };
        any.run_shard(&options, shard(i, 3), &|_| {}, &|_| {}).unwrap();
    }
    let status = Status::read(&out("shards")).unwrap();
    let done: u64 = status.models.iter().map(|model| model.finished).sum();
    assert_eq!(done, any.planned_runs(Some(shard(1, 3))) + any.planned_runs(Some(shard(2, 3))));
    assert!(!status.complete && is_begun(&out("shards")).unwrap());
    let part = put_together(&out("shards"), &Options::default(), &|_| {}).unwrap();
    assert_eq!(
        part.missing().iter().map(|m| m.range().end - m.range().start).sum::<u64>(),
        1000 - done
    );
    let page = fs::read_to_string(out("shards").join("report.html")).unwrap();
    assert!(page.contains("Not all runs are done"));

    any.run_shard(&options("shards"), shard(3, 3), &|_| {}, &|_| {}).unwrap();
    fs::remove_file(folder.path().join("answer.sh")).unwrap();
    let together = put_together(&out("shards"), &Options::default(), &|_| {}).unwrap();
    assert!(together.missing().is_empty() && !is_begun(&out("shards")).unwrap());
    assert!(Status::read(&out("shards")).unwrap().complete);
    for name in ["scenario.toml", "summary.json", "report.html", "report.md"] {
        let [a, b] =
            [whole.folder(), together.folder()].map(|place| fs::read(place.join(name)).unwrap());
        assert!(a == b, "{name}");
    }
    // What is complete is looked at without the simulator, and is not extended without it.
    let again = Options { force: false, ..options("shards") };
    scenario.study(&again, &|_| {}, &|_| {}).unwrap();
    let more = scenario.with_runs(1200).unwrap();
    let refused = more.study(&again, &|_| {}, &|_| {}).unwrap_err().to_string();
    assert!(refused.contains("simulation."), "{refused}");
    assert!(Status::read(&out("shards")).unwrap().complete);
}

/// Scores of what is correlated have the coefficient, and the marginal laws stay.
#[test]
fn quantities_are_correlated() {
    let folder = folder();
    let scenario = scenario(&(uniform() + &correlated()), folder.path());
    let draws = SimulatorDraws::new(&scenario, 0).unwrap();
    let (mut x, mut z) = (Vec::new(), Vec::new());
    for run in 0..4000 {
        let mut numbers = Vec::new();
        draws.draw(run, &mut numbers).unwrap();
        x.push(numbers[0].unwrap());
        z.push(numbers[1].unwrap());
    }
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, mz) = (mean(&x), mean(&z));
    let covariance = |a: &[f64], ma: f64, b: &[f64], mb: f64| {
        a.iter().zip(b).map(|(a, b)| (a - ma) * (b - mb)).sum::<f64>() / a.len() as f64
    };
    // A uniform and a normal number whose scores have the coefficient c are correlated by c √(3/π).
    let expected = -0.8 * (3.0 / std::f64::consts::PI).sqrt();
    let found = covariance(&x, mx, &z, mz)
        / (covariance(&x, mx, &x, mx) * covariance(&z, mz, &z, mz)).sqrt();
    assert!((found - expected).abs() < 0.03, "{found} {expected}");
    assert!((mx - 0.525).abs() < 0.02 && (mz - 1.0).abs() < 0.01);
}
