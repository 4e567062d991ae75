//! Copies of resolved scenarios in which something is changed.

use super::*;

/// Whoever changes the spin axis or a spring in a copy of a resolved scenario gets what follows from it, as in a copy of the file as
/// it was written. What is stated stays.
#[test]
fn what_follows_from_other_keys_is_not_frozen() {
    use toml::Table;
    let changes: [fn(&mut Table); 3] = [
        |_| (),
        |file| drop(file.insert("spin_axis".to_owned(), vec![0.0, 1.0, 0.0].into())),
        |file| {
            let spring = file["springs"].as_array_mut().unwrap()[0].as_table_mut().unwrap();
            spring.insert("stage_point_m".to_owned(), vec![0.4, 0.1, 0.8].into());
        },
    ];
    let directions = |text: &str| {
        let scenario = Scenario::from_toml(text).unwrap();
        let separation = scenario.separation_direction().copied();
        (separation, *scenario.momentum_direction(), scenario.to_toml())
    };
    let mut seen = Vec::new();
    for stated in ["", "separation_direction", "momentum_direction"] {
        let mut written: Table = PECK_2003.parse().unwrap();
        if !stated.is_empty() {
            written.insert(stated.to_owned(), vec![0.3, 0.2, 1.0].into());
        }
        let resolved = directions(&written.to_string()).2;
        for key in ["separation_direction", "momentum_direction"] {
            assert_eq!(resolved.contains(key), stated == key, "{key}");
        }
        for change in changes {
            let changed = |text: &str| {
                let mut file: Table = text.parse().unwrap();
                change(&mut file);
                directions(&file.to_string())
            };
            let found = changed(&resolved);
            assert_eq!(found, changed(&written.to_string()));
            seen.push(found);
        }
    }
    assert!(seen[1].1 != seen[0].1 && seen[2].0 != seen[0].0, "nothing followed");
    assert!(seen[7].1 == seen[6].1 && seen[5].0 == seen[3].0, "what is stated has moved");
}
