//! Pages to look at: of small studies that have all that a page can show.

use gyradius_study::{
    AnyScenario, CompareOptions, ModelComparison, Options, Replay, Scenario, Study,
};
use std::{fs, path::Path};

/// Answers with the numbers that it is sent, and fails now and then.
const ANSWER: &str = r#"
while read -r line; do
    run=${line#*'"run":'}; run=${run%%,*}
    x=${line#*'"x":'}; x=${x%%[,\}]*}
    case $run in
        *7) echo "{\"run\":$run,\"error\":\"<b>too large</b> & more\"}" ;;
        *) echo "{\"run\":$run,\"outputs\":{\"y\":$x,\"z\":$x}}" ;;
    esac
done
"#;

const SIMULATOR: &str = r#"
name = "shell"
runs = 60
seed = 5

[simulation]
command = ["sh", "answer.sh"]

[[simulation.outputs]]
name = "y"
unit = "m"
meaning = "x again."

[[simulation.outputs]]
name = "z"

[[quantities]]
name = "x"
unit = "m"
law = { law = "normal", mean = 2.0, sigma = 0.1 }

[[requirements]]
quantity = "y"
at_most = 2.3
probability = 0.9
confidence = 0.9
"#;

/// Springs that hardly turn the bodies: labels of small numbers are long.
const BALANCED: &str = r#"
name = "balanced"
runs = 2

[payload]
mass_kg = 500.0
inertia_kg_m2 = [[120.0, 2.0, 0.0], [2.0, 110.0, 1.0], [0.0, 1.0, 90.0]]
position_m = [0.0, 0.0, 1.0]

[payload.dispersion]
root_second_moment_variance_kg_m2 = [0.0, 0.0, 0.0]
axes = "fixed"

[stage]
mass_kg = 2000.0
inertia_kg_m2 = [[3000.0, 0.0, 0.0], [0.0, 3000.0, 0.0], [0.0, 0.0, 900.0]]
position_m = [0.0, 0.0, -1.0]

[stage.dispersion]
root_second_moment_variance_kg_m2 = [0.0, 0.0, 0.0]
axes = "fixed"

[[springs]]
stiffness_n_per_m = 20000.0000001
stroke_m = 0.1
payload_point_m = [0.5, 0.5, -0.9]
stage_point_m = [0.5, 0.5, 0.9]

[[springs]]
stiffness_n_per_m = 20000.0
stroke_m = 0.1
payload_point_m = [-0.5, -0.5, -0.9]
stage_point_m = [-0.5, -0.5, 0.9]

[[models]]
name = "own"
law = "principal"
axes = "whole-sphere"
"#;

/// Every page, by its name.
pub(super) fn all() -> Vec<(&'static str, String)> {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path();
    let paper = Scenario::peck_2003().unwrap();
    let many = Scenario::from_toml(&format!("{}{}", paper.to_toml(), many_models())).unwrap();
    // Titles that are markup.
    let full = full(&paper).replace("title = \"", "title = \"<b>&\\\"</i> ");
    let balanced = Scenario::from_toml(BALANCED).unwrap();
    let full = Scenario::from_toml(&full).unwrap();
    vec![
        ("report", report(&paper, 200, &folder.join("paper"))),
        ("report of many models", report(&many, 40, &folder.join("many"))),
        ("report with requirements", report(&full, 60, &folder.join("full"))),
        ("report of a simulator", simulator(folder)),
        ("comparison", comparison(folder)),
        ("replay", replay(&paper, 7, &folder.join("replay"))),
        ("replay of hardly any rates", replay(&balanced, 0, &folder.join("balanced"))),
        ("replay with outlines", replay(&full, 2, &folder.join("outlines"))),
    ]
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}

fn report(scenario: &Scenario, runs: u64, out: &Path) -> String {
    let scenario = scenario.clone().with_runs(runs).unwrap();
    Study::run(&scenario, &Options::to(out), &|_| {}).unwrap();
    read(&out.join("report.html"))
}

fn simulator(folder: &Path) -> String {
    fs::write(folder.join("answer.sh"), ANSWER).unwrap();
    let scenario = AnyScenario::from_toml(SIMULATOR, folder).unwrap();
    let out = folder.join("simulator");
    scenario.run(&Options::to(&out), &|_| {}, &|_| {}).unwrap();
    read(&out.join("report.html"))
}

fn comparison(folder: &Path) -> String {
    let out = folder.join("compare");
    let options = CompareOptions {
        draws: 200,
        separations: 10,
        out: Some(out.clone()),
        ..CompareOptions::default()
    };
    ModelComparison::run(&options, &|_| {}).unwrap();
    read(&out.join("compare.html"))
}

fn replay(scenario: &Scenario, run: u64, out: &Path) -> String {
    let replay = Replay::new(scenario, None, run, 5.0).unwrap();
    replay.write(out, false).unwrap();
    read(&out.join("animation.html"))
}

/// Tables that are wider than paper.
fn many_models() -> String {
    let model = |i| {
        format!(
            "\n[[models]]\nname = \"another-with-a-long-name-{i}\"\nlaw = \"entrywise\"\nmatched_to = \"proposed\"\n"
        )
    };
    (0..9).map(model).collect()
}

/// Springs that fail and that are late, outlines, requirements of which one is not met.
fn full(paper: &Scenario) -> String {
    let text = paper.to_toml();
    let second = text.match_indices("[[springs]]").nth(1).unwrap().0;
    let (head, tail) = text.split_at(second);
    format!(
        r#"{head}[springs.dispersion]
failure_probability = 0.5
start_s = {{ law = "uniform", low = 0.0, high = 0.1 }}
late_probability = 0.9

{tail}
[clearance]
coast_s = 20.0
payload = [{{ hull_m = [[1.1, 1.2, -0.9], [-1.1, 1.2, -0.9], [1.1, -1.2, -0.9], [-1.1, -1.2, 0.9]] }}]
stage = [{{ ring = {{ centre_m = [0.0, 0.0, 0.8], axis = [0.0, 0.0, 1.0], radius_m = 1.4 }} }}, {{ points_m = [[1.0, 1.0, 0.9]] }}]

[[requirements]]
quantity = "nutation_deg"
at_most = 10.0
probability = 0.95
confidence = 0.9

[[requirements]]
name = "never"
quantity = "norm(payload_tip_off_1_deg_per_s, payload_tip_off_2_deg_per_s)"
at_most = 0.1
probability = 0.99
confidence = 0.9
"#
    )
}
