//! The examples in Python, where it is there, with what they import.

use std::path::Path;

use super::{SimulatorScenario, SimulatorSummary};
use crate::{Options, Study};

/// Runs an example in Python; none where Python or one of the modules that it imports is not there.
fn example(name: &str, modules: &str) -> Option<(tempfile::TempDir, Study<SimulatorSummary>)> {
    let import = format!("import {modules}");
    let there = std::process::Command::new("python3").args(["-c", &import]).output();
    if !there.is_ok_and(|output| output.status.success()) {
        return None;
    }
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/simulators"));
    let scenario = SimulatorScenario::read(&folder.join(name)).unwrap().with_runs(30).unwrap();
    let out = tempfile::tempdir().unwrap();
    let options = Options { out: Some(out.path().join("out")), ..Options::default() };
    let study = scenario.study(&options, &|_| {}, &|_| {}).unwrap();
    for runs in study.runs() {
        let table = runs.table().unwrap();
        let failed = table.failures().next().map(|(_, failure)| failure.to_string());
        assert_eq!(failed, None, "{name}");
    }
    Some((out, study))
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
