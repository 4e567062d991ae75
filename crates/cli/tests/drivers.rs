//! What drives the outcome, on the command line.

use serde_json::Value;
use std::{
    fs,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use crate::scratch::{Scratch, content, one_model, summary};

fn drivers(folder: &Path) -> Value {
    summary(folder)["drivers"].clone()
}

/// Of an output, by the names of the groups: first-order and total index, and how many base runs were left out.
fn indices(drivers: &Value, output: &str) -> Vec<(String, f64, f64, u64)> {
    let of = drivers["outputs"].as_array().unwrap().iter().find(|o| o["output"] == output).unwrap();
    let groups = drivers["groups"].as_array().unwrap();
    let all = groups.iter().zip(of["indices"]["groups"].as_array().unwrap());
    let index = |(name, index): (&Value, &Value)| {
        let value = |of: &str| index[of]["value"].as_f64().unwrap();
        let name = name.as_str().unwrap().to_owned();
        (name, value("first"), value("total"), index["left_out"].as_u64().unwrap())
    };
    all.map(index).collect()
}

/// The wobble is the angle of a principal axis, so that the payload's axes drive all of it, whatever else is dispersed. The
/// runs, their tables and everything else of the study are those of the study without drivers.
#[test]
fn axes_drive_the_wobble_and_nothing_else_changes() {
    let scratch = Scratch::new();
    let require = "\n[[requirements]]\nquantity = \"wobble_deg\"\nat_most = 4.0\nprobability = 0.9\nconfidence = 0.9\n";
    let text = one_model() + require;
    fs::write(scratch.path("it.toml"), &text).unwrap();
    let study = ["study", "--scenario", "it.toml", "--runs", "300", "--out"];
    scratch.done(&[&study[..], &["plain"]].concat(), 1);
    scratch.done(&[&study[..], &["it", "--drivers", "400"]].concat(), 1);
    let found = drivers(&scratch.path("it"))[0].clone();
    assert_eq!(found["model"], "proposed");
    assert_eq!((found["base_runs"].as_u64(), found["runs"].as_u64()), (Some(400), Some(2400)));
    for output in ["wobble_deg", "wobble_deg at most 4"] {
        for (group, first, total, left_out) in indices(&found, output) {
            let expected = f64::from(u8::from(group == "payload axes"));
            assert!((first - expected).abs() < 0.02, "{output}, {group}: {first}");
            assert!((total - expected).abs() < 0.25, "{output}, {group}: {total}");
            assert!(group == "payload axes" || total.abs() < 1e-9, "{output}, {group}: {total}");
            assert_eq!(left_out, 0);
        }
    }
    let (plain, with) = (content(&scratch.path("plain")), content(&scratch.path("it")));
    for (name, bytes) in plain.iter().filter(|(name, _)| name.starts_with("runs/")) {
        assert_eq!(with.get(name), Some(bytes), "{name}");
    }
    let report = fs::read_to_string(scratch.path("it/report.md")).unwrap();
    assert!(report.contains("What drives the outcome") && report.contains("payload axes"));
    assert!(scratch.path("it/figures/drivers-proposed.svg").exists());
    scratch.done(&["report", "it", "--out", "again"], 0);
    for page in ["report.html", "report.md", "figures/drivers-proposed.svg"] {
        assert_eq!(fs::read(scratch.path("again").join(page)).unwrap(), with[page], "{page}");
    }

    // Nothing is done again of what is known: more runs, and the same command.
    let more =
        ["study", "--scenario", "it.toml", "--runs", "500", "--drivers", "400", "--out", "it"];
    scratch.done(&more, 1);
    assert_eq!(drivers(&scratch.path("it"))[0], found);
    let whole = content(&scratch.path("it"));
    scratch.done(&more, 1);
    assert_eq!(content(&scratch.path("it")), whole);

    // Another requirement is another output.
    fs::write(scratch.path("it.toml"), text.replace("at_most = 4.0", "at_most = 3.5")).unwrap();
    scratch.done(&more, 1);
    assert_eq!(indices(&drivers(&scratch.path("it"))[0], "wobble_deg at most 3.5").len(), 4);
    assert_eq!(
        indices(&drivers(&scratch.path("it"))[0], "wobble_deg"),
        indices(&found, "wobble_deg")
    );
}

/// A study that is asked for its drivers after it was done finds them, and one that is killed meanwhile goes on; on any number
/// of threads, and with more base runs after fewer.
#[test]
fn drivers_go_on_after_a_kill() {
    let scratch = Scratch::new();
    fs::write(scratch.path("it.toml"), one_model()).unwrap();
    let study = |out: &str, more: &[&'static str]| {
        let all = ["study", "--scenario", "it.toml", "--runs", "100", "--out", out];
        scratch.command(&[&all[..], more].concat())
    };
    let done = |out: &str, more: &[&'static str]| crate::scratch::done(study(out, more), 0);
    done("whole", &["--drivers", "9000", "--threads", "2"]);
    let whole = content(&scratch.path("whole"));
    done("it", &[]);
    let mut child = study("it", &["--drivers", "9000", "--threads", "1"]).spawn().unwrap();
    let (begun, blocks) = (Instant::now(), scratch.path("it/.gyradius/drivers/proposed"));
    let any = || fs::read_dir(&blocks).is_ok_and(|files| files.count() > 1);
    while !any() && begun.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none()
    {
        thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let left = content(&scratch.path("it/.gyradius/drivers"));
    assert!(!left.is_empty());
    done("it", &["--drivers", "9000", "--threads", "1"]);
    assert_eq!(content(&scratch.path("it")), whole);
    // As after a kill between the summary and the end.
    fs::create_dir_all(&blocks).unwrap();
    for (name, bytes) in left {
        fs::write(scratch.path("it/.gyradius/drivers").join(name), bytes).unwrap();
    }
    done("it", &["--drivers", "9000", "--threads", "1"]);
    assert_eq!(content(&scratch.path("it")), whole);
    assert!(!scratch.path("it/.gyradius/drivers").exists());
    done("less", &["--drivers", "100"]);
    done("less", &["--drivers", "9000"]);
    assert_eq!(content(&scratch.path("less")), whole);
    assert!(!scratch.path("less/.gyradius/drivers").exists());
}

/// Shards find no drivers: whoever puts them together is told, each time, and so is who asks what is there.
#[test]
fn drivers_that_shards_leave_are_told() {
    let scratch = Scratch::new();
    let text = format!("drivers = 100\n{}", one_model());
    fs::write(scratch.path("it.toml"), text).unwrap();
    let shard = ["study", "it.toml", "--runs", "100", "--out", "it", "--shard", "1/1"];
    scratch.done(&shard, 0);
    let left = "What drives the outcome is not found yet";
    for _ in 0..2 {
        let said = scratch.done(&["report", "it"], 0);
        assert!(said.contains(&left.to_lowercase()), "{said}");
        assert!(scratch.done(&["status", "it"], 0).contains(left));
    }
    scratch.done(&["study", "it.toml", "--runs", "100", "--out", "it"], 0);
    assert!(!scratch.done(&["report", "it"], 0).contains(&left.to_lowercase()));
    assert!(!scratch.done(&["status", "it"], 0).contains(left));
}

#[test]
fn too_few_base_runs_are_refused() {
    let scratch = Scratch::new();
    for (runs, expected) in
        [("99", "drivers: 99 base runs"), ("0", "drivers: 0"), ("1e9", "drivers: 1000000000")]
    {
        let said = scratch.done(&["study", "--drivers", runs, "--out", "it"], 2);
        assert!(said.contains(expected), "{said}");
    }
    let said = scratch.done(&["study", "--drivers", "100", "--shard", "1/2", "--out", "it"], 2);
    assert!(said.contains("cannot be used with"), "{said}");
    assert!(!scratch.path("it").exists());
}

/// Of a simulator that gives back one of its inputs, this one drives all, and the simulator's own random numbers nothing; runs
/// that fail are left out, and counted.
#[test]
#[cfg(unix)]
fn inputs_of_a_simulator_drive_its_outputs() {
    let scratch = Scratch::new();
    let script = r#"while read -r line; do
    x=${line#*'"x":'}; x=${x%%[,\}]*}
    seed=${line#*'"seed":'}; seed=${seed%%,*}
    case $x in
        0.9*) echo '{"error":"too large"}' ;;
        *) echo "{\"outputs\":{\"y\":$x,\"own\":$seed}}" ;;
    esac
done"#;
    fs::write(scratch.path("answer.sh"), script).unwrap();
    let text = r#"name = "it"
runs = 50
drivers = 100
[simulation]
command = ["sh", "answer.sh"]
[[simulation.outputs]]
name = "y"
[[simulation.outputs]]
name = "own"
[[quantities]]
name = "x"
law = { law = "uniform", low = 0.1, high = 0.99 }
[[quantities]]
name = "idle"
law = { law = "uniform", low = 0.1, high = 0.99 }
[[requirements]]
quantity = "y"
at_most = 0.5
probability = 0.5
confidence = 0.9
"#;
    fs::write(scratch.path("it.toml"), text).unwrap();
    scratch.done(&["study", "--scenario", "it.toml", "--out", "it"], 1);
    let found = drivers(&scratch.path("it"))[0].clone();
    let failed = found["failed"].as_u64().unwrap();
    assert!(failed > 10 && found["runs"].as_u64() == Some(500), "{failed}");
    let of = |output: &str, group: &str| {
        indices(&found, output).into_iter().find(|(name, ..)| name == group).unwrap()
    };
    let own = "the simulator's own random numbers";
    for (output, driver) in [("y", "x"), ("own", own), ("y at most 0.5", "x")] {
        for group in ["x", "idle", own] {
            let (_, first, total, left_out) = of(output, group);
            let expected = f64::from(u8::from(group == driver));
            assert!((first - expected).abs() < 0.1, "{output}, {group}: {first}");
            if group == driver {
                assert!((total - 1.0).abs() < 0.3, "{output}, {group}: {total}");
            } else {
                assert_eq!(total, 0.0, "{output}, {group}");
            }
            // A failed run counts against the requirement, and has no output.
            assert_eq!(left_out == 0, output.contains("most"), "{output}, {group}: {left_out}");
        }
    }
}

/// Shards find no drivers. Where not everything is kept of the runs, it is until the drivers are found, and then there is what one
/// process leaves.
#[test]
#[cfg(unix)]
fn drivers_are_found_after_shards_whatever_is_kept() {
    let scratch = crate::simulator::scratch();
    let scenario = crate::simulator::SCENARIO.replacen("runs = 4000", "runs = 300", 1);
    for kept in ["", "rows = \"none\"", "rows = \"failed\"", "columns = [\"y\"]"] {
        fs::write(scratch.path("k.toml"), format!("drivers = 100\n{kept}\n{scenario}")).unwrap();
        let study = |out| ["study", "k.toml", "-q", "--out", out];
        scratch.done(&study("one"), 0);
        scratch.done(&[&study("it")[..], &["--shard", "1/1"]].concat(), 0);
        let said = scratch.done(&["report", "it"], 0);
        assert!(said.contains("what drives the outcome is not found yet"), "{said}");
        assert!(summary(&scratch.path("it"))["drivers"].as_array().is_none_or(Vec::is_empty));
        scratch.done(&study("it"), 0);
        assert!(content(&scratch.path("it")) == content(&scratch.path("one")), "{kept}");
        assert!(!drivers(&scratch.path("it")).is_null());
        for out in ["one", "it"] {
            fs::remove_dir_all(scratch.path(out)).unwrap();
        }
    }
}
