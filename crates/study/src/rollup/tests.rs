//! Lists of parts, from their text to draws.

use gyradius_campaign::{Streams, TableFormat};
use gyradius_formats::PartsTable;
use gyradius_inertia::MassProperties;
use rand_distr::Distribution;

use super::*;

const LIST: &str = "\
name,parent,mass_kg,centre_x_m,centre_y_m,centre_z_m,shape,sides_m,radius_m,mass_percent,centre_sigma_mm,moments_percent
craft,,,,,,,,,,,
bus,craft,300,0,0,0,solid_box,1 1 2,,5,20,10
tanks,craft,,,,,,,,,,
left,tanks,100,-1,0,1.3,sphere,,0.3,2,5,5
right,tanks,100,1,0,1.3,sphere,,0.3,2,5,5
panel,craft,12,0,2,0,disc,,0.8,5,5,5
";

fn rollup(list: &str) -> Rollup {
    Rollup::new(&PartsTable::read(list.as_bytes(), None).unwrap()).unwrap()
}

fn table(rollup: &Rollup, format: TableFormat, threads: usize) -> Vec<u8> {
    let options = RollupOptions { draws: 300, threads: Some(threads), ..RollupOptions::default() };
    let mut out = Vec::new();
    rollup.draw_to(&options, format, &mut out, &|_| {}).unwrap();
    out
}

#[test]
fn drawing_agrees_with_first_order_where_deviations_are_small() {
    let found = rollup(LIST);
    let options = RollupOptions { draws: 40_000, ..RollupOptions::default() };
    let drawn = found.draw(&options, &|_| {}).unwrap();
    let (moments, first) = (&drawn.moments, found.assembly().first_order());
    assert_eq!((moments.draws, moments.failed, moments.impossible), (40_000, 0, 0));
    let spread = moments.spread.as_ref().unwrap();
    let correlations = first.correlations();
    for i in 0..10 {
        let off = (spread.deviation[i] - first.deviations()[i]) / spread.deviation_error[i];
        assert!(
            off.abs() < 6.0 || (spread.deviation[i] / first.deviations()[i] - 1.0).abs() < 0.02,
            "{i}: {off}"
        );
        // √(2n) times the relative error is 1 of a Gaussian, and more of what has longer tails.
        let tails = spread.deviation_error[i] * 283.0 / spread.deviation[i];
        assert!((0.8..1.6).contains(&tails), "{i}: {tails}");
        for j in 0..10 {
            assert!((spread.correlation[i][j] - correlations[(i, j)]).abs() < 0.03, "{i} {j}");
        }
    }
    // A disc with independent moments is never one.
    assert!(drawn.naive.parts[0].0 == "panel" && drawn.naive.any_part > drawn.naive.draws / 4);
}

/// Whether all draws of one are among those of the other.
fn before_and(before: &[(String, MassProperties)], after: &[(String, MassProperties)]) -> bool {
    before.iter().all(|part| after.contains(part))
}

/// A part's stream has its name alone: nothing that is added or moved changes it.
#[test]
fn other_parts_and_other_rows_change_no_draw() {
    let (first, seed) = (rollup(LIST), 7);
    let more = LIST.replace("panel,", "antenna,craft,3,0,0,2,point,,,9,9,\npanel,");
    let more = rollup(&more);
    let drawn = |rollup: &Rollup, run: u64| -> Vec<(String, MassProperties)> {
        let names: Vec<String> = rollup.assembly().parts().map(|(n, _)| n.to_owned()).collect();
        names.into_iter().zip(Draws::new(rollup.assembly(), seed).of(run)).collect()
    };
    for run in [0, 1, 99] {
        let (before, after) = (drawn(&first, run), drawn(&more, run));
        assert_eq!((before.len(), after.len()), (4, 5));
        assert!(before_and(&before, &after));
        assert_ne!(before[1].1.mass_kg(), before[2].1.mass_kg(), "equal parts draw apart");
    }
    // What a part without deviations is, is drawn once; others draw on as before.
    let still = rollup(&LIST.replace("panel,", "rock,craft,7,0,1,0,solid_box,1 2 3,,,,\npanel,"));
    let rock = |run| drawn(&still, run).into_iter().find(|(name, _)| name == "rock").unwrap();
    assert!(before_and(&drawn(&first, 99), &drawn(&still, 99)) && rock(0) == rock(99));
    let stated = still.assembly().parts().find(|(name, _)| *name == "rock").unwrap();
    assert!(!stated.1.varies());
    for run in [0, 1, 99] {
        let own = stated.1.sample(&mut Streams::new(seed, "rollup", "rock").run(run));
        assert_eq!(own, rock(0).1);
    }
    let mut lines: Vec<&str> = LIST.lines().collect();
    lines[1..].reverse();
    let csv = TableFormat::of_path("x.csv".as_ref()).unwrap();
    assert_eq!(table(&rollup(&lines.join("\n")), csv, 1), table(&first, csv, 3));
    assert_ne!(table(&more, csv, 1), table(&first, csv, 1));
}

#[test]
fn tables_have_a_row_for_each_draw_in_every_form() {
    let found = rollup(LIST);
    for format in TableFormat::ALL {
        assert!(table(&found, format, 1).len() > 1000, "{}", format.name());
    }
    let csv = String::from_utf8(table(&found, TableFormat::of_path("x.csv".as_ref()).unwrap(), 1))
        .unwrap();
    assert!(
        csv.starts_with(
            "model,run,status,mass_kg,mass_centre_1_m,mass_centre_2_m,mass_centre_3_m,i11,"
        ),
        "{csv:.100}"
    );
    assert_eq!(csv.lines().count(), 301);
}

#[test]
fn errors_name_the_line() {
    let error = |list: &str| {
        let table = PartsTable::read(list.as_bytes(), None).unwrap();
        Rollup::new(&table).unwrap_err().to_string()
    };
    assert!(
        error(&LIST.replace("left,tanks", "left,tonks"))
            .starts_with("line 5: \"left\" belongs to \"tonks\"")
    );
    assert!(
        error(&LIST.replace("right,", "left,")).starts_with("line 6: name \"left\" stands twice")
    );
    assert!(error(&LIST.replace("12,0,2,0", "1e31,0,2,0")).starts_with("line 7: panel: "));
    let message = error(&LIST.replace("tanks,craft", "tanks,tanks"));
    let expected = "line 4: \"tanks\" belongs to \"tanks\": no row may belong to itself";
    assert!(message.starts_with(expected), "{message}");
    assert!(
        error(&LIST.replace("tanks,craft", "tanks,"))
            .starts_with("line 4: 2 rows belong to nothing, \"craft\", \"tanks\"")
    );
    assert!(
        error(&LIST.replace("left,tanks", "left,bus"))
            .starts_with("line 3: \"bus\" has numbers of its own")
    );
    let long = RollupOptions { draws: u64::MAX, ..RollupOptions::default() };
    assert!(matches!(rollup(LIST).draw(&long, &|_| {}), Err(RollupError::Draws { .. })));
}

/// One draw has a mean and no spread, and none has neither.
#[test]
fn one_draw_has_no_deviation() {
    let found = rollup(LIST);
    for draws in 0..4 {
        let options = RollupOptions { draws, ..RollupOptions::default() };
        let moments = found.draw(&options, &|_| {}).unwrap().moments;
        assert_eq!((moments.draws, moments.mean.is_some()), (draws, draws > 0));
        assert_eq!(moments.spread.is_some(), draws > 1, "{draws}");
        assert!(moments.spread.is_none_or(|spread| spread.deviation.iter().all(|s| *s > 0.0)));
    }
}

/// What the refusal of an assembly with numbers advises can be done: each way gives the parts alone.
#[test]
fn the_advice_on_assemblies_with_numbers_can_be_followed() {
    for (heading, cells) in
        [("Level", ["1", "2", "2"]), ("WBS", ["1", "1.1", "1.2"]), ("Indent", ["", ">", ">"])]
    {
        let part = |at: usize, name: &str, parent: &str, mass: &str| {
            let numbers = if mass.is_empty() { ",,,,,," } else { ",0,0,0,1,1,1" };
            format!("{},{name}{parent},{mass}{numbers}\n", cells[at])
        };
        let head = |parent: &str| format!("{heading},name{parent},mass,Cx,Cy,Cz,Ixx,Iyy,Izz\n");
        let list = |mass: &str, of: [&str; 3]| {
            let rows =
                [part(0, "bus", of[1], mass), part(1, "a", of[2], "6"), part(2, "b", of[2], "4")];
            head(of[0]) + &rows.concat()
        };
        let said = |text: &str| {
            let table =
                PartsTable::read(text.as_bytes(), None).map_err(|error| error.to_string())?;
            Rollup::new(&table)
                .map(|found| found.assembly.first_order().nominal().mass_kg())
                .map_err(|e| e.to_string())
        };
        let advice = said(&list("10", ["", "", ""])).unwrap_err();
        assert!(
            advice.contains("must be left out, or have no numbers, and then a column \"parent\""),
            "{advice}"
        );
        let advice = said(&list("", ["", "", ""])).unwrap_err();
        assert!(advice.contains("or be left out, or be the parent of other rows"), "{advice}");
        assert_eq!(said(&list("", [",parent", ",", ",bus"])), Ok(10.0));
        let left_out = head("") + &part(1, "a", "", "6") + &part(2, "b", "", "4");
        assert_eq!(said(&left_out), Ok(10.0));
    }
}
