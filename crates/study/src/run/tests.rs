//! Runs of scenarios with mated hulls and antennas, backward spins, late and failing springs.

use super::*;
use crate::{
    Cell, Quantity, Row, Table,
    column::{CLEARANCE_NOTE, Column},
    model::Model,
    study::all_runs,
};

/// When a spring lets go, springs from 0.
fn release(spring: usize) -> Quantity {
    Quantity::of_column(&format!("spring_{}_release_s", spring + 1)).unwrap()
}

/// The paper's bodies with solids that are in each other at the last release, other shapes as asked, and
/// all that is dispersed.
fn rows(payload_shape: &str, spin: &str, springs: &str, coast: &str) -> (Scenario, Vec<Table>) {
    let text = Scenario::peck_2003().unwrap().with_runs(120).unwrap().to_toml();
    let solid = |low: f64| {
        let corner = |i: i32| {
            let sign = |bit: i32| if i >> bit & 1 == 0 { -0.8 } else { 0.8 };
            let z = if i >> 2 & 1 == 0 { low } else { low + 0.3 };
            format!("[{:?}, {:?}, {z:?}]", sign(0), sign(1))
        };
        let corners: Vec<_> = (0..8).map(corner).collect();
        format!("{{ hull_m = [{}] }}", corners.join(", "))
    };
    let text = text
        .replacen("[payload.dispersion]\n", &format!("[payload.dispersion]\n{spin}\n"), 1)
        .replace("name = \"peck-2003\"", "name = \"solids\"");
    let second = text.match_indices("[[springs]]").nth(1).unwrap().0;
    let (head, tail) = text.split_at(second);
    let text = format!(
        "{head}[springs.dispersion]\n{springs}\n\n{tail}\n[clearance]\ncoast_s = {coast}\n\
         payload = [{}{payload_shape}]\nstage = [{}]\n",
        solid(-1.3),
        solid(0.7)
    );
    let scenario = Scenario::from_toml(&text).unwrap();
    let models = Model::all(&scenario).unwrap();
    let runs = all_runs(&scenario, &models[..1]);
    (scenario, runs.iter().map(|runs| runs.table().unwrap()).collect())
}

/// What must be true of every row, whatever was drawn.
fn check(row: &Row<'_>, drawn: impl Fn(&str) -> Option<f64>) {
    let value = |q: Quantity| q.in_row(row);
    let (clearance, recontact) = (value(Quantity::Clearance), value(Quantity::RecontactTime));
    if recontact.is_some() {
        assert_eq!((clearance, value(Quantity::ClearanceTime)), (Some(0.0), recontact));
    } else {
        assert!(clearance != Some(0.0), "no contact");
    }
    assert!(clearance.is_some() || row.text(CLEARANCE_NOTE).is_some(), "nothing says why");
    let within = |x: Option<f64>, least: Quantity, greatest: Quantity| {
        let Some(x) = x else { return };
        let (least, greatest) = (value(least).unwrap(), value(greatest).unwrap());
        assert!(least <= x && x <= greatest, "{x} in {least} to {greatest}");
    };
    for q in [Quantity::Nutation, Quantity::Nutation2, Quantity::Nutation3] {
        within(value(q), Quantity::NutationLeast, Quantity::NutationGreatest);
    }
    let before = (Quantity::NutationLeastBefore, Quantity::NutationGreatestBefore);
    within(value(Quantity::NutationBefore), before.0, before.1);
    // A spring has a release if and only if it pushed, which is after its start.
    let order = row.text("release_order").unwrap();
    for spring in 0..4 {
        let release = value(release(spring));
        let named = order.split([' ', '+']).any(|name| name == (spring + 1).to_string());
        assert_eq!(named, release.is_some(), "{order}");
        if spring == 0 {
            let start = drawn("spring_1_start_s").unwrap();
            assert!(release.is_none_or(|release| release > start));
            let failed = drawn("spring_1_failure") == Some(1.0);
            assert!(!failed || release.is_none());
            // Late by more than the others take: it never pushed.
            assert!(start < value(Quantity::ReleaseTime).unwrap() || release.is_none());
        }
    }
}

#[test]
fn every_row_agrees_with_itself() {
    let springs =
        "failure_probability = 0.1\nstart_s = { law = \"uniform\", low = 0.0, high = 0.6 }";
    let antenna = ", { points_m = [[0.0, 0.0, 3.4], [0.0, 2.0, 0.0]] }";
    let (mut touch, mut mated, mut backward, mut never) = (0, 0, 0, 0);
    for (shape, spin) in [
        (antenna, "angular_velocity_rad_per_s = 0.2"),
        (antenna, "angular_velocity_rad_per_s = [{ mean = -1.0, sigma = 0.2 }, 0.1, 0.1]"),
        ("", "angular_velocity_rad_per_s = 0.1"),
    ] {
        let (_, tables) = rows(shape, spin, springs, "40.0");
        for row in tables[0].rows().filter(|row| row.failure().is_none()) {
            let drawn = |name: &str| row.number(name);
            check(&row, drawn);
            touch += u32::from(Quantity::RecontactTime.in_row(&row).is_some());
            mated += u32::from(row.text(CLEARANCE_NOTE) == Some(&ClearanceNote::Mated.to_string()));
            backward += u32::from(Quantity::Nutation2.in_row(&row).is_some_and(|x| x > 90.0));
            let late = drawn("spring_1_failure") == Some(0.0);
            never += u32::from(late && release(0).in_row(&row).is_none());
        }
    }
    assert!(
        touch > 20 && mated > 20 && backward > 20 && never > 20,
        "{touch} {mated} {backward} {never}"
    );
}

/// Solids that are in each other to the end of a short coast: alone, and beside an antenna that has a clearance.
#[test]
fn outlines_that_do_not_part_are_told() {
    let antenna = ", { points_m = [[0.0, 0.0, 3.4], [0.0, 2.0, 0.0]] }";
    let spin = "angular_velocity_rad_per_s = 0.2";
    for (shape, note) in [(antenna, ClearanceNote::SomeTogether), ("", ClearanceNote::Together)] {
        let (_, tables) = rows(shape, spin, "stiffness_percent = 1.0", "0.001");
        for row in tables[0].rows() {
            let clearance = Quantity::Clearance.in_row(&row);
            assert_eq!(clearance.is_some(), !shape.is_empty(), "{clearance:?}");
            assert_eq!(row.text(CLEARANCE_NOTE), Some(note.to_string().as_str()));
        }
    }
}

/// Bodies that turn too far to be followed through the coast, that are nearer while the spring waits than afterwards, and of which some
/// outlines do not part: every note stands, whatever else is true.
#[test]
fn all_notes_of_a_clearance_are_told() {
    let mut seen = std::collections::BTreeSet::new();
    // To watch mated outlines through thousands of turns takes many seconds.
    for i in (0..8).filter(|i| i & 5 != 5) {
        let [turns, late, mated] = [1, 2, 4].map(|bit| i & bit != 0);
        let turning = if turns { 1.0 } else { f64::from(u8::from(late)) / 600.0 };
        let body = |name: &str, place: f64, inertia: &str, rate: [f64; 3]| {
            format!(
                "[{name}]\nmass_kg = 100.0\ninertia_kg_m2 = {inertia}\nposition_m = [0, 0, {place:?}]\n\
                 angular_velocity_rad_per_s = {:?}\n[{name}.dispersion]\n\
                 root_second_moment_variance_kg_m2 = [0.0, 0, 0]\naxes = \"fixed\"\n",
                rate.map(|rate| rate * turning)
            )
        };
        // All of the payload is in it, and stays there.
        let around = "[-4, -4, -4], [4, -4, -4], [-4, 4, -4], [4, 4, -4], [-4, -4, 4], [4, -4, 4], [-4, 4, 4], [4, 4, 4]";
        let text = format!(
            "name = \"notes\"\nruns = 1\n{}{}\
             [[springs]]\nstiffness_n_per_m = 0.002\nstroke_m = 0.05\nstart_s = {:?}\n\
             payload_point_m = [0, 0, 0]\nstage_point_m = [0, 0, 0.01]\n\
             [clearance]\ncoast_s = {:?}\n\
             payload = [{{ points_m = [[0.8, 0.3, 0.2], [-0.8, 0.5, 0.1], [0.1, -0.9, -0.2], [0.2, 0.1, 0.5]] }}]\n\
             stage = [{{ hull_m = [[0.8, 0.3, 0.1], [-0.7, 0.5, -0.2], [-0.1, -0.9, 0.2], [0.1, 0.1, -0.5]] }}{}]\n\
             [integration]\nhorizon_s = 5000.0\n[[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n",
            body("payload", 1.15, "[[30.0, 1, 0], [1, 25.0, 0], [0, 0, 20.0]]", [60.0, 18.0, 12.0]),
            body("stage", -1.2, "[[30.0, 0, 2], [0, 40.0, 0], [2, 0, 20.0]]", [-30.0, 6.0, -12.0]),
            if late { 20.0 } else { 0.0 },
            if turns { 600.0 } else { 60.0 },
            if mated { format!(", {{ hull_m = [{around}] }}") } else { String::new() },
        );
        let scenario = Scenario::from_toml(&text).unwrap();
        let case = Case::nominal(&scenario);
        let run = case.ended(&scenario, Some(scenario.separation().run(scenario.settings())));
        let (note, kind) = match Column::ClearanceNote.cell(&run) {
            Cell::Note { kind, text } => (text, kind),
            other => (other.to_string().into(), String::new().into()),
        };
        let starts = ["followed to ", "the outlines come nearer", "some outlines are mated"];
        let told =
            starts.map(|start| note.split("; ").filter(|one| one.starts_with(start)).count());
        let kinds = ["a body turns too far", "the outlines come nearer", "some outlines are mated"];
        assert_eq!(kinds.map(|one| kind.matches(one).count()), told, "{note} {kind}");
        // What is told of one thing does not depend on the others.
        let watched = run.end().unwrap().watched.as_ref().unwrap().as_ref().unwrap();
        let expected = [
            watched.clearance().undecided_from_s().is_some(),
            watched.nearer_before().is_some(),
            watched.clearance().shapes().iter().any(|shapes| shapes.counts_from_s().is_none()),
        ];
        assert_eq!(told, expected.map(usize::from), "{note}");
        assert_eq!((expected[0], expected[2]), (turns, mated), "{note}");
        seen.insert(expected);
    }
    let pairs = [[true, true, false], [false, true, true]];
    assert!(pairs.iter().all(|pair| seen.contains(pair)) && seen.len() >= 4, "{seen:?}");
}

/// A search that was given up is told, be it that before the last release, that over the coast, both, or the only one that there is.
#[test]
fn every_search_that_was_given_up_is_told() {
    let found = |looks: Option<usize>| -> Clearance {
        let (is_stopped, looks) = (looks.is_some(), looks.unwrap_or(7));
        let text = format!(
            r#"{{"shapes": [], "undecided_from_s": null, "is_stopped": {is_stopped}, "looks": {looks}}}"#
        );
        serde_json::from_str(&text).unwrap()
    };
    for pushed in [None, Some(11)] {
        for coast in [None, Some(None), Some(Some(13))] {
            let watched = Watched::of(found(pushed), coast.map(found));
            let is_given_up = pushed.is_some() || coast.flatten().is_some();
            assert_eq!(watched.is_given_up(), is_given_up, "{pushed:?} {coast:?}");
            let told = ClearanceNote::all(&Ok(watched));
            let told: Vec<_> =
                told.into_iter().filter(|note| *note != ClearanceNote::Mated).collect();
            let counts = coast.unwrap_or(pushed).map(|looks| ClearanceNote::NotProven { looks });
            let before = pushed.filter(|_| coast.is_some());
            let before = before.map(|looks| ClearanceNote::NotProvenBefore { looks });
            let expected: Vec<_> = counts.into_iter().chain(before).collect();
            assert_eq!(told, expected, "{pushed:?} {coast:?}");
        }
    }
}

/// 12 rad/s for 600 s: all but the clearance of the whole coast is known, and the row stays.
#[test]
fn fast_turning_fails_no_row() {
    let springs = "friction_n = { law = \"uniform\", low = 0.0, high = 1.0 }";
    let spin = "angular_velocity_rad_per_s = [{ mean = 12.0, sigma = 0.1 }, 0.0001, 0.0001]\n\
                velocity_m_per_s = [0.0001, 0.0001, { mean = -0.3, sigma = 0.05 }]";
    let (_, tables) = rows(", { points_m = [[0.0, 0.0, 3.4]] }", spin, springs, "900.0");
    let good = tables[0].rows().filter(|row| row.failure().is_none());
    let mut partial = 0;
    for row in good {
        assert_eq!(row.status(), "ok");
        assert!(Quantity::Nutation.in_row(&row).is_some());
        let note = row.text(CLEARANCE_NOTE);
        partial += u32::from(note.is_some_and(|note| note.starts_with("followed to ")));
    }
    println!("{partial} rows are followed in part");
}

/// How far a point is from a box about the mass centre of a body, m.
fn to_box(
    body: &gyradius_separation::BodyState,
    point: Vector3<f64>,
    [low, high]: [[f64; 3]; 2],
) -> f64 {
    let own = body.attitude.inverse() * (point - body.position);
    let beyond = |i: usize| (low[i] - own[i]).max(own[i] - high[i]).max(0.0);
    Vector3::new(beyond(0), beyond(1), beyond(2)).norm()
}

/// An antenna of the payload, which is thrown sideways, flies by a post of the stage or into it, while a long soft spring or one that
/// starts late has yet to let go: held against the distance at many times of the trajectory.
#[test]
fn bodies_that_touch_before_the_last_release_have_no_clearance() {
    let post = [[1.0, -0.3, 0.5], [1.1, 0.3, 3.0]];
    let corners: Vec<String> = (0..8)
        .map(|i: usize| {
            format!("[{:?}, {:?}, {:?}]", post[i & 1][0], post[i >> 1 & 1][1], post[i >> 2][2])
        })
        .collect();
    let soft = "[[springs]]\nstiffness_n_per_m = 50.0\nstroke_m = 6.0\npayload_point_m = [0.0, 0, -0.9]\nstage_point_m = [0.0, 0, 0.9]\n";
    let late = "[[springs]]\nstiffness_n_per_m = 2e3\nstroke_m = 3.0\nstart_s = 1.5\npayload_point_m = [0.0, 0, -0.9]\nstage_point_m = [0.0, 0, 0.9]\n";
    let [mut touched, mut nearer, mut neither] = [0; 3];
    for (sideways, along, other) in
        (0..8).flat_map(|i| (0..4).map(move |j| (i, j, (i + j) % 2 == 0)))
    {
        let text = format!(
            "name = \"post\"\nruns = 1\n\
             [payload]\nmass_kg = 500.0\ninertia_kg_m2 = [[120.0, 0, 0], [0, 110.0, 0], [0, 0, 90.0]]\nposition_m = [0.0, 0, 1.0]\n\
             velocity_m_per_s = [{:?}, {:?}, 0.0]\nangular_velocity_rad_per_s = [0.0, 0.1, 0.3]\n\
             [payload.dispersion]\nroot_second_moment_variance_kg_m2 = [0.0, 0, 0]\naxes = \"fixed\"\n\
             [stage]\nmass_kg = 2000.0\ninertia_kg_m2 = [[3000.0, 0, 0], [0, 3000.0, 0], [0, 0, 900.0]]\nposition_m = [0.0, 0, -1.0]\n\
             [stage.dispersion]\nroot_second_moment_variance_kg_m2 = [0.0, 0, 0]\naxes = \"fixed\"\n\
             [clearance]\ncoast_s = 20.0\npayload = [{{ points_m = [[0.5, 0.0, 0.0]] }}]\nstage = [{{ hull_m = [{}] }}]\n\
             [[springs]]\nstiffness_n_per_m = 2e4\nstroke_m = 0.1\npayload_point_m = [0.0, 0, -0.9]\nstage_point_m = [0.0, 0, 0.9]\n\
             {}[[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n",
            0.2 * f64::from(sideways),
            0.15 * f64::from(along),
            corners.join(", "),
            if other { soft } else { late }
        );
        let scenario = Scenario::from_toml(&text).unwrap();
        let table = all_runs(&scenario, &Model::all(&scenario).unwrap())[0].table().unwrap();
        let row = table.rows().next().unwrap();
        let Some(release) = Quantity::ReleaseTime.in_row(&row) else { continue };
        let trajectory = scenario.separation().trajectory(scenario.settings(), 20.0).unwrap();
        let least = |from: f64, to: f64| {
            let times = (0..=8_000).map(|i| from + (to - from) * f64::from(i) / 8_000.0);
            let seen = times.map(|time| {
                let now = trajectory.at(time.min(trajectory.end_s())).unwrap();
                let payload = now.payload().state();
                let tip = payload.position + payload.attitude * Vector3::new(0.5, 0.0, 0.0);
                (to_box(now.stage().state(), tip, post), time)
            });
            let first_or_least = |a: (f64, f64), b: (f64, f64)| if b.0 < a.0 { b } else { a };
            seen.reduce(first_or_least).unwrap()
        };
        let (before, after) = (least(0.0, release), least(release, release + 20.0));
        let (start, note) = (least(0.0, 0.0).0, row.text(CLEARANCE_NOTE));
        let clearance = Quantity::Clearance.in_row(&row).unwrap();
        if before.0 == 0.0 {
            touched += 1;
            let time = Quantity::RecontactTime.in_row(&row).unwrap();
            assert!(
                clearance == 0.0 && (time - before.1).abs() < 5e-4 * release,
                "{time} {before:?}\n{text}"
            );
            assert_eq!(note, None);
        } else {
            assert!((clearance - after.0).abs() < 1e-3, "{clearance} {after:?}\n{text}");
            if before.0 < 0.97 * start.min(after.0) {
                nearer += 1;
                let said = note.unwrap().split(": to ").nth(1).unwrap();
                let said: f64 = said.split(' ').next().unwrap().parse().unwrap();
                assert!((said / before.0 - 1.0).abs() < 0.02, "{said} {before:?}\n{text}");
            } else if before.0 > 0.99 * start.min(after.0) {
                neither += 1;
                assert_eq!(note, None, "{before:?} {after:?} {start}\n{text}");
            }
        }
    }
    assert!(touched > 4 && nearer > 4 && neither > 2, "{touched} {nearer} {neither}");
}
