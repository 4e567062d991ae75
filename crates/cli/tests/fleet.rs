//! Vehicles and flights on the command line.

use std::fs;

use crate::scratch::Scratch;

fn said(output: &std::process::Output) -> (Option<i32>, String) {
    let text = [&output.stdout[..], &output.stderr[..]].concat();
    (output.status.code(), String::from_utf8(text).unwrap())
}

/// More vehicles go on where a study ended; runs in their place, other flights and contradictory flags are refused by
/// name, and a flight is replayed by its vehicle.
#[test]
fn vehicles_take_the_place_of_runs() {
    let scratch = Scratch::new();
    let of = |arguments: &[&str]| said(&scratch.run(arguments));
    assert_eq!(of(&["study", "--runs", "2", "--out", "plain"]).0, Some(0));
    let plain = fs::read_to_string(scratch.path("plain/scenario.toml")).unwrap();
    let fleet = plain.replace("runs = 2\n", "vehicles = 3\nflights = 4\n");
    let fleet = fleet
        .replace("[payload.dispersion]\n", "[payload.dispersion]\ninertia_drawn = \"vehicle\"\n");
    fs::write(scratch.path("fleet.toml"), &fleet).unwrap();
    fs::write(scratch.path("other.toml"), fleet.replace("flights = 4", "flights = 2")).unwrap();
    let study =
        |more: &[&str]| of(&[&["study", "--scenario", "fleet.toml", "--out", "s"], more].concat());
    let (code, text) = study(&[]);
    assert!(code == Some(0) && text.contains("3 vehicles of 4 flights each, 12 runs"), "{text}");
    let (code, text) = study(&["--vehicles", "5"]);
    assert!(code == Some(0) && text.contains("5 vehicles of 4 flights each, 20 runs"), "{text}");
    for (more, expected) in [
        (&["--runs", "40"][..], "runs: 40: the scenario has 3 vehicles of 4 flights each"),
        (&["--vehicles", "0"], "vehicles: 0: "),
        (&["--vehicles", "1e9"], "vehicles: 1000000000: times flights = 4"),
        (&["--vehicles", "4"], "vehicles is 5 there and 4 here"),
        (&["--vehicles", "4", "--runs", "16"], "cannot be used with"),
    ] {
        let (code, text) = study(more);
        assert!(code == Some(2) && text.contains(expected), "{text}");
    }
    let (code, text) = of(&["study", "--scenario", "other.toml", "--vehicles", "50", "--out", "s"]);
    assert!(code == Some(2) && text.contains("flights is 4 there and 2 here"), "{text}");
    let (code, text) = of(&["study", "--vehicles", "5", "--out", "t"]);
    assert!(code == Some(2) && text.contains("the scenario has no vehicles"), "{text}");

    let (code, text) = of(&["replay", "s", "--vehicle", "4", "--flight", "3", "--coast", "0"]);
    assert!(code == Some(0) && text.contains("run 19 of 20 (vehicle 4, flight 3)"), "{text}");
    for (arguments, expected) in [
        (
            &["s", "--vehicle", "5", "--flight", "0"][..],
            "the scenario has 5 vehicles of 4 flights each",
        ),
        (&["plain", "--vehicle", "0", "--flight", "0"], "the scenario has no vehicles"),
        (&["s", "--vehicle", "0"], "--flight"),
        (&["s", "--flight", "0"], "--vehicle"),
        (&["s"], "--run"),
        (&["s", "--run", "1", "--vehicle", "0", "--flight", "0"], "cannot be used with"),
        (&["s", "--run", "1", "--flight", "0"], "cannot be used with"),
    ] {
        let (code, text) = of(&[&["replay"], arguments].concat());
        assert!(code == Some(2) && text.contains(expected), "{text}");
    }
    let (_, text) = of(&["draw", "fleet.toml", "-n", "6", "--model", "proposed"]);
    let column = |at: usize| -> Vec<&str> {
        text.lines().map(|line| line.split(',').nth(at).unwrap()).collect()
    };
    assert_eq!(column(3), ["vehicle", "0", "0", "0", "0", "1", "1"]);
    assert_eq!(column(4), ["flight", "0", "1", "2", "3", "0", "1"]);
    assert!(column(5)[1..5].iter().all(|x| *x == column(5)[1]) && column(5)[1] != column(5)[5]);
}

/// Each task of a job array does its share of the vehicles, as the script says it.
#[test]
fn a_script_for_slurm_tells_vehicles() {
    let scratch = Scratch::new();
    assert_eq!(said(&scratch.run(&["study", "--runs", "2", "--out", "plain"])).0, Some(0));
    let plain = fs::read_to_string(scratch.path("plain/scenario.toml")).unwrap();
    fs::write(scratch.path("f.toml"), plain.replace("runs = 2\n", "vehicles = 3\nflights = 4\n"))
        .unwrap();
    for (more, vehicles) in [(&[][..], "3"), (&["--vehicles", "5"], "5")] {
        let slurm = ["slurm", "--scenario", "f.toml", "--out", "o", "--shards", "2", "--time", "9"];
        let (code, script) = said(&scratch.run(&[&slurm, more].concat()));
        let line = script.lines().find(|line| line.starts_with("exec ")).unwrap();
        assert_eq!(code, Some(0), "{script}");
        let flag = format!("--vehicles={vehicles}");
        assert!(line.contains(&flag) && !line.contains("--runs"), "{line}");
        let out = format!("shard-{vehicles}");
        let shard = ["study", "--scenario", "f.toml", "--out", &out, "--shard", "1/2", &flag];
        let (code, text) = said(&scratch.run(&shard));
        assert_eq!(code, Some(0), "{text}");
    }
}

/// A fleet of a user's own simulator takes the same flags: more vehicles, a flight again, a script for Slurm.
#[test]
fn simulators_have_vehicles() {
    let scratch = Scratch::new();
    let of = |arguments: &[&str]| said(&scratch.run(arguments));
    let script = r#"
while read -r line; do
    v=${line#*'"vehicle":'}; v=${v%%,*}
    echo "{\"outputs\":{\"y\":$v}}"
done
"#;
    fs::write(scratch.path("answer.sh"), script).unwrap();
    let scenario = r#"
name = "shell"
vehicles = 3
flights = 4
[simulation]
command = ["sh", "answer.sh"]
[[simulation.outputs]]
name = "y"
[[quantities]]
name = "x"
law = { law = "normal", mean = 1.0, sigma = 0.1, drawn = "vehicle" }
"#;
    fs::write(scratch.path("s.toml"), scenario).unwrap();
    let study =
        |more: &[&str]| of(&[&["study", "--scenario", "s.toml", "--out", "s"], more].concat());
    let (code, text) = study(&[]);
    assert!(code == Some(0) && text.contains("3 vehicles of 4 flights each, 12 runs"), "{text}");
    let (code, text) = study(&["--vehicles", "5"]);
    assert!(code == Some(0) && text.contains("5 vehicles of 4 flights each, 20 runs"), "{text}");
    for (more, expected) in [
        (&["--runs", "40"][..], "runs: 40: the scenario has 3 vehicles of 4 flights each"),
        (&["--vehicles", "0"], "vehicles: 0: "),
        (&["--vehicles", "4"], "vehicles is 5 there and 4 here"),
    ] {
        let (code, text) = study(more);
        assert!(code == Some(2) && text.contains(expected), "{text}");
    }
    let (code, text) = of(&["replay", "s", "--vehicle", "4", "--flight", "3"]);
    assert!(code == Some(0) && text.contains("run 19 (vehicle 4, flight 3)"), "{text}");
    assert!(text.contains("{\"run\":19,\"vehicle\":4,\"flight\":3,"), "{text}");
    assert!(text.contains("y = 4.0"), "{text}");
    let (code, text) = of(&["replay", "s", "--vehicle", "5", "--flight", "0"]);
    assert!(code == Some(2) && text.contains("5 vehicles of 4 flights each"), "{text}");
    let (code, text) = of(&["draw", "s.toml", "--format", "csv"]);
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!((code, rows.len()), (Some(0), 13));
    assert_eq!(rows[0][3..6], ["vehicle", "flight", "x"]);
    assert!(rows[6][3..5] == ["1", "1"] && rows[6][5] == rows[5][5] && rows[6][5] != rows[4][5]);
    let slurm = ["slurm", "--scenario", "s.toml", "--vehicles", "200", "--out", "o"];
    let (code, script) = of(&[&slurm[..], &["--shards", "2", "--time", "9"]].concat());
    let line = script.lines().find(|line| line.starts_with("exec ")).unwrap_or_default();
    assert!(code == Some(0) && line.contains("--vehicles=200"), "{script}");
}
