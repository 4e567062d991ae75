//! A simulation of one's own: a small satellite with an uncertain inertia tumbles in the Earth's magnetic field,
//! whose torque on the residual dipole turns it. Run table, results and report, and one run done again.
//!
//! ```sh
//! cargo run -p gyradius-report --example magnetic_tumbling
//! ```

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_campaign::{Column, Failure, Simulation, Streams, Table, TableError, run, threads};
use gyradius_dispersion::{PrincipalDispersion, ScalarRoots};
use gyradius_inertia::{Inertia, InertiaMatrix};
use gyradius_report::Overview;
use nalgebra::{Matrix3, Matrix4, UnitQuaternion, Vector3, Vector4};
use rand_distr::Distribution;
use std::{error::Error, fs, ops::Range, path::Path};

/// Residual dipole, body axes, A·m², and the field of the Earth in a low orbit, inertial axes, T.
const DIPOLE: Vector3<f64> = Vector3::new(0.02, -0.01, 0.05);
const FIELD: Vector3<f64> = Vector3::new(1.2e-5, -0.6e-5, 2.4e-5);
/// Seconds that are followed, and the step.
const SPAN: f64 = 600.0;
const STEP: f64 = 1.0;
/// A faster satellite is not caught by its magnetorquers, rad/s.
const LIMIT: f64 = 0.05;

struct MagneticTumbling {
    inertias: PrincipalDispersion<ScalarRoots, RadiallyConstrainedGaussian>,
    draws: Streams,
}

/// Attitude (body to inertial) and angular velocity, body axes.
type State = (UnitQuaternion<f64>, Vector3<f64>);

impl MagneticTumbling {
    fn new(seed: u64, model: &str, spread_of_axes: f64) -> Result<Self, Box<dyn Error>> {
        let nominal = InertiaMatrix::from_entries([0.041, 0.038, 0.011], [4e-4, -2e-4, 1e-4])?;
        let nominal = Inertia::try_from(nominal)?;
        let roots = nominal.second_moments().roots();
        let roots = ScalarRoots::normal(roots, roots.values().map(|root| (0.03 * root).powi(2)))?;
        let spread = Vector4::new(spread_of_axes, spread_of_axes, spread_of_axes, 0.05);
        let axes = RadiallyConstrainedGaussian::new(
            nominal.principal_axes().attitude(),
            Matrix4::from_diagonal(&spread),
        )?;
        let draws = Streams::new(seed, model, "inertia");
        Ok(Self { inertias: PrincipalDispersion::new(roots, axes), draws })
    }

    fn follow(inertia: Matrix3<f64>, inverse: Matrix3<f64>) -> impl Iterator<Item = State> {
        let rate = move |(attitude, omega): &State| {
            let torque = DIPOLE.cross(&(attitude.inverse() * FIELD));
            inverse * (torque - omega.cross(&(inertia * omega)))
        };
        let ahead = move |(attitude, omega): &State, slope: Vector3<f64>, step: f64| {
            let after = omega + slope * step;
            let turn = (omega + after) / 2.0 * step;
            (attitude * UnitQuaternion::from_scaled_axis(turn), after)
        };
        let start = (UnitQuaternion::identity(), Vector3::new(0.002, -0.001, 0.01));
        // Heun's method is enough for an example.
        let next = move |state: &State| {
            let slope = rate(state);
            let slope = (slope + rate(&ahead(state, slope, STEP))) / 2.0;
            Some(ahead(state, slope, STEP))
        };
        std::iter::successors(Some(start), next).take((SPAN / STEP) as usize)
    }
}

impl Simulation for MagneticTumbling {
    type Worker = ();

    fn columns(&self) -> Vec<Column> {
        vec![
            Column::number(
                "smallest_moment_kg_m2",
                "kg·m²",
                "Smallest principal moment, as drawn.",
            ),
            Column::number(
                "largest_rate_rad_per_s",
                "rad/s",
                "Largest angular speed in ten minutes.",
            ),
            Column::number("final_rate_rad_per_s", "rad/s", "Angular speed after ten minutes."),
        ]
    }

    fn worker(&self) {}

    fn run(&self, runs: Range<u64>, (): &mut (), rows: &mut Table) -> Result<(), TableError> {
        for run in runs {
            let inertia: Inertia = self.inertias.sample(&mut self.draws.run(run));
            let smallest = inertia.principal_axes().moments().into_iter().fold(f64::MAX, f64::min);
            let matrix = *inertia.matrix();
            let Some(inverse) = matrix.try_inverse() else {
                let failure = Failure::new("no inverse", "the inertia has no inverse");
                rows.push(Some(failure), [Some(smallest), None, None].map(Into::into))?;
                continue;
            };
            let speeds = Self::follow(matrix, inverse).map(|(_, omega)| omega.norm());
            let (largest, last) = speeds.fold((0.0, 0.0), |(most, _), s| (f64::max(most, s), s));
            let failure = (largest > LIMIT)
                .then(|| Failure::new("too fast", format!("{largest} rad/s, more than {LIMIT}")));
            rows.push(failure, [smallest, largest, last].map(Into::into))?;
        }
        Ok(())
    }
}

/// The study, its folder, and the report made from what is in the folder.
fn study(folder: &Path, runs: u64) -> Result<(), Box<dyn Error>> {
    let pool = threads(None)?;
    let mut tables = Vec::new();
    for (model, spread) in [("axes known", 1e-8), ("axes uncertain", 0.01)] {
        let simulation = MagneticTumbling::new(7, model, spread)?;
        let table = run(&simulation, model, runs, &pool, &|_done| {})?;
        // Any run again, alone.
        let again = runs / 2;
        let mut alone = Table::new(model, again, simulation.columns())?;
        simulation.run(again..again + 1, &mut (), &mut alone)?;
        assert!(alone.rows().eq(table.rows().skip(again as usize).take(1)), "the same bits");
        tables.push(table);
    }
    fs::create_dir_all(folder.join("figures"))?;
    for (table, name) in tables.iter().zip(["known", "uncertain"]) {
        table.write_parquet(fs::File::create(folder.join(format!("{name}.parquet")))?)?;
    }
    let overview = Overview::new("A small satellite in the Earth's magnetic field", &tables)?;
    fs::write(folder.join("summary.json"), serde_json::to_string_pretty(&overview)?)?;
    // Later, or on another machine:
    let read: Overview = serde_json::from_str(&fs::read_to_string(folder.join("summary.json"))?)?;
    for (name, content) in read.document().files("report") {
        fs::write(folder.join(name), content)?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new("target/study/magnetic-tumbling");
    study(folder, 2000)?;
    println!("{}", folder.join("report.html").display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without the dipole's torque the angular momentum is conserved; here the field does work on the dipole
    /// alone: kinetic energy less m·B stays the same, as far as the method goes.
    #[test]
    fn energy_is_conserved() {
        let simulation = MagneticTumbling::new(1, "test", 0.01).unwrap();
        for run in 0..20 {
            let inertia: Inertia = simulation.inertias.sample(&mut simulation.draws.run(run));
            let matrix = *inertia.matrix();
            let energy = |(attitude, omega): State| {
                omega.dot(&(matrix * omega)) / 2.0 - DIPOLE.dot(&(attitude.inverse() * FIELD))
            };
            let energies: Vec<f64> =
                MagneticTumbling::follow(matrix, matrix.try_inverse().unwrap())
                    .map(energy)
                    .collect();
            let scale = DIPOLE.norm() * FIELD.norm();
            let drift = energies.iter().map(|e| (e - energies[0]).abs()).fold(0.0, f64::max);
            assert!(drift < 0.02 * scale, "{drift} of {scale}");
        }
    }

    #[test]
    fn the_folder_holds_run_tables_and_report() {
        let scratch =
            std::env::temp_dir().join(format!("gyradius-tumbling-{}", std::process::id()));
        study(&scratch, 60).unwrap();
        let page = fs::read_to_string(scratch.join("report.html")).unwrap();
        assert!(page.contains("axes uncertain") && page.contains("largest_rate_rad_per_s (rad/s)"));
        let text = fs::read_to_string(scratch.join("report.md")).unwrap();
        assert!(text.contains("axes uncertain") && text.contains("(figures/quantities.svg)"));
        assert!(scratch.join("known.parquet").is_file());
        fs::remove_dir_all(&scratch).unwrap();
    }
}
