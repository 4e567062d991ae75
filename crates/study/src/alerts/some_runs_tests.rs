//! Statistics of outcomes that not all runs have, on the page and on the terminal.

use super::tests::{ordinary, study};
use crate::{Scenario, body::Body, quantity::Quantity, subject::Subject};

/// Payloads that turn in a random share of the runs: how many runs have an angle is said beside its statistics on the page and on the terminal,
/// and before them where these are less than half of the runs.
#[test]
fn statistics_of_some_runs_say_so() {
    let mut seen = [0; 3];
    for probability in [0.0, 0.005, 0.02, 0.1, 0.25, 0.5, 1.0] {
        for (runs, seed) in [(40, 1), (200, 2), (301, 3)] {
            let springs = format!("failure_probability = {probability:?}");
            let mut table: toml::Table =
                ordinary(runs, 0.01, &springs).with_seed(seed).unwrap().to_toml().parse().unwrap();
            for body in Body::BOTH {
                table[body.name()].as_table_mut().unwrap().remove("angular_velocity_rad_per_s");
            }
            // Straight springs about the mass centre: the payload turns only if one of them fails.
            for (spring, place) in table["springs"].as_array_mut().unwrap().iter_mut().zip([
                [0.5, 0.5],
                [-0.5, 0.5],
                [-0.5, -0.5],
                [0.5, -0.5],
            ]) {
                for (end, z) in [("payload_point_m", -0.9), ("stage_point_m", 0.9)] {
                    let point = toml::Value::from(vec![place[0], place[1], z]);
                    spring.as_table_mut().unwrap().insert(end.to_owned(), point);
                }
            }
            let scenario = Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap();
            let (summary, tables) = study(&scenario);
            let table = tables[0].table().unwrap();
            let succeeded = runs - table.failures().len() as u64;
            let n = Quantity::Nutation.in_table(&table).len() as u64;
            let is_some = n > 0 && n < succeeded;
            let text = format!("of {n} of {succeeded} runs");
            let page = scenario.report(&summary).markdown();
            assert_eq!(page.contains(&text), is_some, "{probability} {n} {page}");
            let terminal = summary.to_string();
            let row = terminal.lines().find(|line| line.trim_start().starts_with("runs "));
            let told = row.map(|row| row.split_whitespace().nth(2).unwrap().to_owned());
            let cones = Quantity::Cone.in_table(&table).len() as u64;
            assert_eq!(
                told,
                (n < succeeded || cones < succeeded).then(|| n.to_string()),
                "{terminal}"
            );
            let few = n > 0 && 2 * n < succeeded;
            assert_eq!(
                page.contains(&format!("nutation ({n} of {succeeded} runs)")),
                few,
                "{page}"
            );
            seen[usize::from(is_some) + usize::from(few)] += 1;
        }
    }
    assert!(seen.iter().all(|seen| *seen > 1), "{seen:?}");
}
