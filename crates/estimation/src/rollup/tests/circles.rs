//! Rows that belong to each other in a circle.

use super::*;

/// All ways in which five rows may belong to each other or to nothing: rows in a circle are named, and no others.
#[test]
fn circles_name_those_in_them() {
    const NAMES: [&str; 5] = ["c", "a", "e", "b", "d"];
    let (mut circles, part) = (0, sawe(WIDGET));
    for case in 0..6_usize.pow(5) {
        // None, or which row each belongs to.
        let up: [Option<usize>; 5] =
            std::array::from_fn(|i| (case / 6_usize.pow(i as u32) % 6).checked_sub(1));
        let rows = (0..5).map(|i| {
            let is_part = up.iter().all(|parent| *parent != Some(i));
            row(NAMES[i], up[i].map(|parent| NAMES[parent]), is_part.then(|| part.clone()))
        });
        let is_in_circle = |i: usize| {
            let mut at = up[i];
            for _ in 0..5 {
                if at == Some(i) {
                    return true;
                }
                at = at.and_then(|at| up[at]);
            }
            false
        };
        let roots = up.iter().filter(|parent| parent.is_none()).count();
        match Assembly::new(rows) {
            Ok(_) => assert!(roots == 1 && !(0..5).any(is_in_circle), "{up:?}"),
            Err(AssemblyError::Wholes { names }) => assert!(names.len() == roots, "{up:?}"),
            Err(error @ AssemblyError::Circle { .. }) => {
                circles += 1;
                let message = error.to_string();
                let AssemblyError::Circle { names } = error else { panic!() };
                let place = |name: &str| NAMES.iter().position(|n| *n == name).unwrap();
                for (at, name) in names.iter().enumerate() {
                    let next = &names[(at + 1) % names.len()];
                    assert_eq!(up[place(name)], Some(place(next)), "{up:?} {names:?}");
                    assert!(
                        message.contains(&format!("{name:?} belongs to {next:?}")),
                        "{message}"
                    );
                }
                assert!(roots < 2 && names.iter().min() == names.first(), "{up:?} {names:?}");
            }
            Err(error) => panic!("{up:?}: {error}"),
        }
    }
    assert!(circles > 1000, "{circles}");
}
