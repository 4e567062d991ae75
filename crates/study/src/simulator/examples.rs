//! The examples in Python, where it is there, with what they import; the first of them as a function, too.

use gyradius_campaign::{Outputs, RunInputs, SimulatorFunction};
use nalgebra::{Matrix3, Vector3};
use std::{fs, path::Path};

use super::{SimulatorScenario, SimulatorSummary};
use crate::{Options, Study};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/simulators");

/// Runs an example in Python; none where Python or one of the modules that it imports is not there.
fn example(name: &str, modules: &str) -> Option<(tempfile::TempDir, Study<SimulatorSummary>)> {
    done(&Path::new(FOLDER).join(name), modules)
}

/// The same of a scenario elsewhere.
fn done(file: &Path, modules: &str) -> Option<(tempfile::TempDir, Study<SimulatorSummary>)> {
    let import = format!("import {modules}");
    let there = std::process::Command::new("python3").args(["-c", &import]).output();
    if !there.is_ok_and(|output| output.status.success()) {
        return None;
    }
    let scenario = SimulatorScenario::read(file).unwrap().with_runs(30).unwrap();
    let out = tempfile::tempdir().unwrap();
    let options = Options::to(out.path().join("out"));
    let study = scenario.study(&options, &|_| {}, &|_| {}).unwrap();
    for runs in study.runs() {
        let table = runs.table().unwrap();
        let failed = table.failures().next().map(|(_, failure)| failure.to_string());
        assert_eq!(failed, None, "{}", file.display());
    }
    Some((out, study))
}

/// The scenario that the documentation shows first is one of this script.
#[test]
fn the_documented_scenario_runs() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/simulators.md");
    let page = fs::read_to_string(page).unwrap();
    let (_, block) = page.split_once("```toml\n").unwrap();
    let (block, _) = block.split_once("```\n").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let script = Path::new(FOLDER).join("spin_up.py");
    fs::copy(script, folder.path().join("spin_up.py")).unwrap();
    fs::write(folder.path().join("spin_up.toml"), block).unwrap();
    done(&folder.path().join("spin_up.toml"), "json");
}

/// The satellite spins as the motor's impulse says, and in Basilisk as in the script without packages.
#[test]
fn the_satellite_spins_up() {
    let Some((_folder, study)) = example("spin_up.toml", "json") else { return };
    for runs in study.runs() {
        let table = runs.table().unwrap();
        let column = |name: &str| table.values(name).unwrap();
        assert_eq!(column("mass_again_kg"), column("hub_mass_kg"));
        let spins = column("spin_rad_per_s").into_iter().zip(column("hub_i33"));
        let impulses = column("torque_n_m").into_iter().zip(column("burn_s"));
        for ((spin, i33), (torque, burn)) in spins.zip(impulses) {
            let expected = torque * burn / i33;
            assert!((spin / expected - 1.0).abs() < 0.02, "{spin} {expected}");
        }
    }
    let Some((_folder, basilisk)) = example("spin_up_basilisk.toml", "Basilisk") else { return };
    for (own, other) in study.runs().iter().zip(basilisk.runs()) {
        for column in ["hub_i11", "torque_n_m", "spin_rad_per_s", "nutation_deg"] {
            let [own, other] =
                [own, other].map(|runs| runs.table().unwrap().values(column).unwrap());
            // Basilisk's steps are whole nanoseconds.
            assert!(own.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-6), "{column}");
        }
    }
}

/// What `spin_up.py` computes, in its operations and their order.
fn spin_up(run: &RunInputs<'_>) -> Result<Outputs, String> {
    const STEPS: u32 = 200;
    let given = |name: &str| run.input(name).ok_or(format!("no {name}"));
    let i = |place: &str| given(&format!("hub_i{place}"));
    let inertia = [
        Vector3::new(i("11")?, i("12")?, i("13")?),
        Vector3::new(i("12")?, i("22")?, i("23")?),
        Vector3::new(i("13")?, i("23")?, i("33")?),
    ];
    let torque = Vector3::new(0.0, 0.0, given("torque_n_m")?);
    let dot = |a: &Vector3<f64>, b: &Vector3<f64>| a.x * b.x + a.y * b.y + a.z * b.z;
    let momentum = |w: &Vector3<f64>| Vector3::from(inertia.map(|row| dot(&row, w)));
    let rows = [(1, 2), (2, 0), (0, 1)].map(|(j, k)| inertia[j].cross(&inertia[k]));
    let determinant = dot(&inertia[0], &rows[0]);
    let adjugate = Matrix3::from_columns(&rows);
    let rate = |w: &Vector3<f64>| {
        let load = torque - w.cross(&momentum(w));
        let row = |j: usize| adjugate.row(j).transpose();
        Vector3::from([0, 1, 2].map(|j| dot(&row(j), &load) / determinant))
    };
    let (mut w, step) = (Vector3::zeros(), given("burn_s")? / f64::from(STEPS));
    for _ in 0..STEPS {
        let a = rate(&w);
        let b = rate(&(w + step / 2.0 * a));
        let c = rate(&(w + step / 2.0 * b));
        let d = rate(&(w + step * c));
        w += step / 6.0 * (a + 2.0 * b + 2.0 * c + d);
    }
    let h = momentum(&w);
    let nutation = (h.z / dot(&h, &h).sqrt()).acos().to_degrees();
    let outputs = [
        ("spin_rad_per_s", dot(&w, &w).sqrt()),
        ("nutation_deg", nutation),
        ("mass_again_kg", given("hub_mass_kg")?),
    ];
    Ok(outputs.map(|(name, number)| (name.to_owned(), number)).into())
}

/// The same computed by a function of the program leaves the same run tables, to the byte.
#[test]
fn a_function_leaves_what_the_script_does() {
    let Some((_folder, study)) = example("spin_up.toml", "json") else { return };
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/simulators/spin_up.toml"));
    let text = fs::read_to_string(file).unwrap();
    let command = "command = [\"python3\", \"spin_up.py\"]\ntimeout_s = 20.0\n";
    assert!(text.contains(command));
    let text = text.replace(command, "function = \"spin_up.py, in Rust\"\n");
    let scenario = SimulatorScenario::from_toml(&text, Path::new("/")).unwrap();
    let scenario = scenario.with_runs(30).unwrap();
    let scenario = scenario.with_function(SimulatorFunction::new(spin_up)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let options = Options::to(folder.path().join("out"));
    let own = scenario.study(&options, &|_| {}, &|_| {}).unwrap();
    for model in scenario.model_names() {
        let [own, other] = [&own, &study].map(|study| {
            fs::read(study.folder().join(format!("runs/{model}/000000000-000000029.parquet")))
                .unwrap()
        });
        assert_eq!(own, other, "{model}");
    }
}

/// A heavier tool, farther out, keeps the arm farther below its target.
#[test]
fn the_arm_swings() {
    let Some((_folder, study)) = example("arm_mujoco.toml", "mujoco") else { return };
    let table = study.runs()[0].table().unwrap();
    let column = |name: &str| table.values(name).unwrap();
    let tools = column("tool_mass_kg").into_iter().zip(column("tool_mass_centre_1_m"));
    let angles = column("error_at_end_deg").into_iter().zip(column("tool_mass_centre_3_m"));
    for ((mass, x), (error, z)) in tools.zip(angles) {
        let angle = (60.0 + error).to_radians();
        // At rest the servo, 400 N·m/rad, holds the weight of arm and tool.
        let weight = 4.0 * 0.3 * angle.cos() + mass * ((0.6 + x) * angle.cos() - z * angle.sin());
        let held = 400.0 * (60.0_f64.to_radians() - angle);
        assert!((held / (9.81 * weight) - 1.0).abs() < 1e-3, "{held} {weight}");
    }
}
