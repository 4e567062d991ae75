//! Runs that leave the wrong way, of stacks that are turned, alone and with the whole world.

use gyradius_campaign::Runs;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use proptest::prelude::*;

use crate::{
    Scenario,
    alerts::Alert,
    drawn,
    model::Model,
    quantity::Quantity,
    study::{all_runs, judged},
};

const RUNS: u64 = 40;

/// A payload on a stage, both in a world that is turned so, thrown at it by a speed with this deviation; what else is dispersed follows.
fn scenario(world: UnitQuaternion<f64>, velocity: [f64; 2], dispersions: &str) -> Scenario {
    let [speed, deviation] = velocity;
    let list = |v: Vector3<f64>| format!("{:?}", <[f64; 3]>::from(v));
    let body = |name: &str, mass: f64, z: f64, speed: f64| {
        let [position, velocity] = [z, speed].map(|x| list(world * Vector3::z() * x));
        let attitude = <[f64; 4]>::from(world.coords);
        format!(
            "[{name}]\nmass_kg = {mass:?}\ninertia_kg_m2 = [[900.0, 0.0, 0.0], [0.0, 850.0, 0.0], [0.0, 0.0, 800.0]]\n\
             position_m = {position}\nvelocity_m_per_s = {velocity}\nbody_to_inertial = {attitude:?}\n\
             [{name}.dispersion]\nroot_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]\naxes = \"fixed\"\n"
        )
    };
    // What the payload is thrown with goes along the axis of the stack by the strokes of the springs, which no turn changes.
    let springs = [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]].map(|[x, y]| {
        format!(
            "[[springs]]\nstiffness_n_per_m = 2e5\nstroke_m = 0.1\npayload_point_m = [{x:?}, {y:?}, -0.9]\n\
             stage_point_m = [{x:?}, {y:?}, 0.9]\ndispersion = {{ stroke_m = {deviation:?} }}\n"
        )
    });
    let text = format!(
        "name = \"turned\"\nruns = {RUNS}\n{}{}{}{dispersions}\n\
         [[models]]\nname = \"principal\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n",
        body("payload", 1000.0, 1.0, speed),
        body("stage", 2000.0, -1.0, 0.0),
        springs.concat(),
    );
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// What is told of runs that leave the wrong way: how many, and of how many.
fn told(scenario: &Scenario) -> Option<[u64; 2]> {
    let summary = judged(scenario, &Model::all(scenario).unwrap());
    summary.head.alerts.iter().find_map(|alert| match alert {
        Alert::Backwards { backwards, runs, .. } => Some([*backwards, *runs]),
        _ => None,
    })
}

/// The same of the rows, each of which is drawn again: the stage stands as the separation of the run begins with it.
fn expected(scenario: &Scenario, runs: &Runs) -> Option<[u64; 2]> {
    let table = runs.table().unwrap();
    let direction = scenario.separation_direction().unwrap().into_inner();
    let direction = scenario.stage().moving().state().attitude.inverse() * direction;
    let [payload, stage] =
        [scenario.payload(), scenario.stage()].map(|body| *body.nominal().as_inertia_matrix());
    let columns = scenario.dispersions().columns();
    let [mut backwards, mut parted] = [0, 0];
    for row in table.rows() {
        let number = |column: &str| row.number(column).unwrap();
        if Quantity::DirectionError.in_row(&row).is_none() {
            continue;
        }
        parted += 1;
        let values: Vec<f64> = columns.iter().map(|column| number(column)).collect();
        let start = drawn::separation(scenario, &values, payload, stage).unwrap();
        let velocity = Quantity::RELATIVE_VELOCITY.map(|q| q.in_row(&row).unwrap());
        let intended = start.stage().state().attitude * direction;
        backwards += u64::from(Vector3::from(velocity).angle(&intended).to_degrees() > 90.0);
    }
    (backwards > 0).then_some([backwards, parted])
}

fn attitude() -> impl Strategy<Value = UnitQuaternion<f64>> {
    prop::array::uniform4(-1.0..1.0_f64)
        .prop_filter("short", |q| q.iter().map(|x| x * x).sum::<f64>() > 0.01)
        .prop_map(|[x, y, z, w]| UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whichever way the stack is drawn to stand, as little as a degree or anywhere, and however the world is turned with it: the runs that
    /// leave the wrong way are those that do where nothing is turned.
    #[test]
    fn turns_of_the_whole_change_nothing(
        world in attitude(),
        speed in prop_oneof![Just(0.0), -6.0..1.0_f64],
        deviation in prop_oneof![Just(1e-6), 1e-3..0.02_f64],
        half in prop_oneof![Just(0.0), 1.0..180.0_f64],
        one in 0..3_usize,
    ) {
        let velocity = [speed, deviation];
        let still = scenario(UnitQuaternion::identity(), velocity, "");
        let law = |i: usize, half: f64| match i == one {
            true => "1.0".to_owned(),
            false => format!("{{ law = \"uniform\", low = {:?}, high = {half:?} }}", -half),
        };
        let stack = |half: f64| {
            let [a, b, c] = [0, 1, 2].map(|i| law(i, half));
            format!("[stack.dispersion]\nattitude_deg = [{a}, {b}, {c}]")
        };
        let turned = scenario(world, velocity, &if half > 0.0 { stack(half) } else { String::new() });
        // Runs on the edge may go either way by rounding.
        let runs = all_runs(&still, &Model::all(&still).unwrap());
        let errors = Quantity::DirectionError.in_table(&runs[0].table().unwrap());
        prop_assume!(errors.iter().all(|error| (error - 90.0).abs() > 1e-3));
        prop_assert_eq!(told(&turned), told(&still));
    }

    /// Where the stage is turned alone, too, and where it is not, the intended direction is that of the stage as the run begins.
    #[test]
    fn the_direction_goes_with_the_stage(
        world in attitude(),
        speed in -6.0..1.0_f64,
        turns in prop::array::uniform3(prop_oneof![Just(None), (0.1..60.0_f64).prop_map(Some)]),
    ) {
        let sections = ["payload", "stage", "stack"];
        let whole = sections.iter().zip(turns).filter_map(|(name, turn)| {
            let turn = turn?;
            Some(format!("{name}.dispersion.attitude_deg = {turn:?}\n"))
        });
        let base = scenario(world, [speed, 0.01], "");
        let mut table: toml::Table = base.to_toml().parse().unwrap();
        for line in whole {
            let addition: toml::Table = line.parse().unwrap();
            for (name, section) in addition {
                let own = table.entry(name).or_insert_with(|| toml::Table::new().into());
                let own = own.as_table_mut().unwrap().entry("dispersion");
                let own = own.or_insert_with(|| toml::Table::new().into());
                let section = section["dispersion"].as_table().unwrap().clone();
                own.as_table_mut().unwrap().extend(section);
            }
        }
        let scenario = Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap();
        let runs = all_runs(&scenario, &Model::all(&scenario).unwrap());
        prop_assert_eq!(told(&scenario), expected(&scenario, &runs[0]));
    }
}
