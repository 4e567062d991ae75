//! What every verb prints, where it goes and what the exit code says.

use std::{
    fs::{self, File},
    path::Path,
    process::Command,
};

use crate::scratch::Scratch;

const ROBOT: &str = r#"<robot name="r"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial></link></robot>"#;

/// One model, which takes little time.
fn scenario() -> String {
    let text = gyradius_study::Scenario::peck_2003().unwrap().with_runs(5).unwrap().to_toml();
    let models = text.find("[[models]]").unwrap();
    let model = "[[models]]\nname = \"proposed\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n";
    text[..models].replace("comparisons = []\n", "") + model
}

/// A folder with a study, a table of samples, statements and a robot.
fn furnished() -> Scratch {
    let shell = Scratch::new();
    let tables = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tables");
    for name in ["variants.csv", "payload.toml"] {
        fs::copy(tables.join(name), shell.path(name)).unwrap();
    }
    fs::write(shell.path("robot.urdf"), ROBOT).unwrap();
    fs::write(shell.path("scenario.toml"), scenario()).unwrap();
    let output = shell.run(&["study", "--scenario", "scenario.toml", "--out", "here"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    shell
}

const VERBS: [&[&str]; 15] = [
    &["study", "--scenario", "scenario.toml", "--out", "here"],
    &["draw", "scenario.toml", "-n", "3"],
    &["draw", "scenario.toml", "-n", "3", "--format", "parquet"],
    &["replay", "here", "--run", "0", "--out", "replay"],
    &["check", "robot.urdf"],
    &["check", "--format", "json", "robot.urdf"],
    &["fit", "variants.csv"],
    &["fit", "variants.csv", "--format", "json"],
    &["model", "payload.toml"],
    &["model", "payload.toml", "--format", "json"],
    &["compare", "--models", "wishart", "--levels", "1", "--body", "bus", "--draws", "20"],
    &["--help"],
    &["study", "--help"],
    &["--version"],
    &["help"],
];

/// A reader that has gone is no error, a full disk is one, and nothing panics.
#[test]
fn every_verb_bears_a_closed_pipe_and_a_full_disk() {
    let shell = furnished();
    for arguments in VERBS {
        let usual = shell.run(arguments);
        assert!(!usual.stdout.is_empty(), "{arguments:?}");

        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let closed = shell.command(arguments).stdout(writer).output().unwrap();
        assert_eq!(closed.status.code(), usual.status.code(), "{arguments:?}");
        assert_eq!(closed.stderr, usual.stderr, "{arguments:?}");

        if let Ok(full) = File::options().write(true).open("/dev/full") {
            let full = shell.command(arguments).stdout(full).output().unwrap();
            let message = String::from_utf8(full.stderr).unwrap();
            assert_eq!(full.status.code(), Some(2), "{arguments:?}: {message}");
            assert!(message.contains("error: standard output: "), "{arguments:?}: {message}");
            assert!(!message.contains("panicked"), "{arguments:?}: {message}");
        }
        // Nor does anybody have to listen to messages.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let deaf = shell.command(arguments).stderr(writer).output().unwrap();
        assert_eq!(deaf.status.code(), usual.status.code(), "{arguments:?}");
    }
}

/// Characters that command a terminal, or the order of what is shown, in whatever a user may write.
#[test]
fn nothing_commands_the_terminal_or_a_page() {
    let shell = furnished();
    let nasty = "\u{1b}[31m\u{9b}2J\u{202e}\u{2066}\u{7}\u{200f}";
    let harmless = |text: &[u8], said: &str| {
        let text = String::from_utf8(text.to_vec()).unwrap();
        let bad = text.chars().find(|c| {
            (c.is_control() && !"\n\t".contains(*c))
                || matches!(*c, '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
        });
        assert_eq!(bad, None, "{said}: {text:?}");
    };
    let escaped: String = nasty.chars().map(|c| format!("\\u{:04x}", u32::from(c))).collect();
    let title = format!("[source]\ntitle = \"From {escaped}\"");
    let text = scenario();
    let start = text.find("[source]").unwrap();
    let end = start + text[start + 1..].find("\n[").unwrap();
    let titled = format!("{}{title}{}", &text[..start], &text[end..]);
    let compared = "[[models]]\nname = \"w\"\nlaw = \"wishart\"\nmatched_to = \"proposed\"\n\
                    [[comparisons]]\ntitle = \"";
    let titled =
        format!("{titled}\n{compared}{escaped}\"\nphysical = \"proposed\"\nnaive = \"w\"\n");
    fs::write(shell.path("titled.toml"), &titled).unwrap();
    let output = shell.run(&["study", "--scenario", "titled.toml", "--out", "titled"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    harmless(&output.stdout, "stdout of a study");
    let mut pages =
        ["html", "md"].map(|form| shell.path(&format!("titled/report.{form}"))).to_vec();
    let figures = fs::read_dir(shell.path("titled/figures")).unwrap();
    pages.extend(figures.map(|entry| entry.unwrap().path()));
    assert!(pages.len() > 3);
    for page in pages {
        harmless(&fs::read(&page).unwrap(), &page.display().to_string());
    }

    // Messages that quote what is in a file, or its name.
    for (from, to) in [
        ("runs = 5", format!("runs = 5 # {nasty}\n{nasty} = 1")),
        ("runs = 5", format!("runs = \"{nasty}\"")),
        ("runs = 5", format!("runs = 5\n\"{escaped}\" = 1")),
        ("name = \"proposed\"", format!("name = \"{escaped}\"")),
        ("name = \"proposed\"", format!("name = \"proposed\"\nmatched_to = \"{escaped}\"")),
    ] {
        let text = scenario().replacen(from, &to, 1);
        assert_ne!(text, scenario());
        let name = format!("{nasty}.toml");
        fs::write(shell.path(&name), text).unwrap();
        let output = shell.run(&["study", "--scenario", &name, "--out", "never"]);
        assert_eq!(output.status.code(), Some(2));
        harmless(&output.stderr, "refused scenario");
    }
    let file = format!("{nasty}.urdf");
    fs::write(shell.path(&file), ROBOT.replace("base", &format!("b{}", &nasty[4..]))).unwrap();
    let table = format!("{nasty}.csv");
    fs::copy(shell.path("variants.csv"), shell.path(&table)).unwrap();
    for arguments in [
        &["check", &file][..],
        &["check", "--all", "--format", "json", &file],
        &["fit", &table],
        &["fit", &table, "--format", "json"],
        &["fit", &file],
        &["model", &table],
        &["model", "payload.toml", "-o", &format!("{nasty}/x.toml")],
        &["study", "--scenario", &table],
        &["study", "--out", &file],
        &["replay", &file, "--run", "0"],
        &["compare", "--body", nasty],
        &["study", nasty],
        &[nasty],
    ] {
        let output = shell.run(arguments);
        harmless(&output.stdout, &format!("stdout of {arguments:?}"));
        harmless(&output.stderr, &format!("stderr of {arguments:?}"));
        if arguments.contains(&"json") {
            serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap();
        }
    }
}

/// The share of failed runs decides the exit code, and nothing else.
#[test]
fn too_many_failures_are_exit_code_1() {
    let shell = furnished();
    // A horizon at which some runs have ended and others have not.
    let table = |horizon: f64, limit: &[&str]| {
        let horizon = format!("horizon_s = {horizon:?}");
        let text =
            scenario().replace("horizon_s = 60.0", &horizon).replace("runs = 5", "runs = 40");
        assert!(text.contains(&horizon));
        fs::write(shell.path("changed.toml"), text).unwrap();
        let arguments =
            [&["study", "--scenario", "changed.toml", "--out", "out", "--force"], limit];
        let output = shell.run(&arguments.concat());
        let summary = fs::read_to_string(shell.path("out/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        let failed = summary["models"][0]["failed"].as_u64().unwrap();
        (output.status.code(), failed, String::from_utf8(output.stderr).unwrap())
    };
    let (mut low, mut high) = (0.001, 60.0);
    assert_eq!(table(low, &[]).1, 40);
    let mut partial = None;
    for _ in 0..40 {
        let middle = f64::sqrt(low * high);
        match table(middle, &[]).1 {
            0 => high = middle,
            40 => low = middle,
            failed => {
                partial = Some((middle, failed));
                break;
            }
        }
    }
    let mut cases = vec![(0.001, 40), (60.0, 0)];
    cases.extend(partial);
    assert_eq!(cases.len(), 3, "some runs fail and some do not");
    for (horizon, failed) in cases {
        for (limit, share) in
            [("", 0.5), ("0", 0.0), ("1", 1.0), ("100%", 1.0), ("0.25", 0.25), ("97.5%", 0.975)]
        {
            let limit = if limit.is_empty() { vec![] } else { vec!["--max-failed", limit] };
            let (code, counted, message) = table(horizon, &limit);
            assert_eq!(counted, failed);
            let too_many = failed as f64 > 40.0 * share;
            assert_eq!(code, Some(i32::from(too_many)), "{failed} {limit:?}");
            assert_eq!(message.contains(&format!("{failed} of 40 runs failed")), too_many);
        }
    }
    for bad in ["2", "-1", "nan", "101%", "half", "%", ""] {
        let output = shell.run(&["study", "--max-failed", bad]);
        assert_eq!(output.status.code(), Some(2), "{bad}");
    }
}

/// Whole numbers as people write them, with the same result.
#[test]
fn whole_numbers_have_many_forms() {
    let shell = furnished();
    let seed = |text: &str| {
        let arguments = ["study", "--scenario", "scenario.toml", "--out", "n", "--force", "--seed"];
        let output = shell.run(&[&arguments[..], &[text]].concat());
        assert!(output.status.success(), "{text}: {}", String::from_utf8_lossy(&output.stderr));
        fs::read_to_string(shell.path("n/scenario.toml")).unwrap()
    };
    for forms in [
        &["1000000", "1_000_000", "1e6", "1E6", "1.0e6", "1000000.0", "10e5"][..],
        &["0", "0.0", "0e5"],
        &["9007199254740992", "9_007_199_254_740_992"],
        &["9223372036854775807"],
    ] {
        let first = seed(forms[0]);
        assert!(forms.iter().all(|form| seed(form) == first), "{forms:?}");
        assert!(first.contains(&format!("seed = {}", forms[0])), "{first}");
    }
    for bad in [
        "1.5",
        "1e-3",
        "1e300",
        "inf",
        "nan",
        "1__0",
        "_1",
        "1_",
        "",
        "9.007199254740993e15",
        "1e16",
        "-1e6",
    ] {
        for option in ["--runs", "--seed"] {
            let output = shell.run(&["study", &format!("{option}={bad}")]);
            assert_eq!(output.status.code(), Some(2), "{option} {bad}");
        }
    }
}

/// What is no scenario is refused at once, whatever it is.
#[test]
fn only_regular_files_of_a_sensible_size_are_read() {
    let shell = furnished();
    assert!(Command::new("mkfifo").arg(shell.path("pipe")).status().unwrap().success());
    // A gigabyte that takes no room.
    File::create(shell.path("large.toml")).unwrap().set_len(1 << 30).unwrap();
    for (name, expected) in [
        ("pipe", "not a regular file"),
        ("/dev/zero", "not a regular file"),
        (".", "not a regular file"),
        ("large.toml", "larger than"),
    ] {
        for verb in [
            &["study", "--scenario", name][..],
            &["draw", name],
            &["compare", "--scenario", name],
            &["replay", name, "--run", "0"],
            &["model", name],
        ] {
            // The folder of a study is for a replay.
            if verb[0] == "replay" && name == "." {
                continue;
            }
            let output = shell.run(verb);
            let message = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(2), "{verb:?}: {message}");
            assert!(message.contains(expected), "{verb:?}: {message}");
        }
    }
}

/// Of a body that turns too far to be followed through the coast, nothing is said of the rest.
#[test]
fn a_replay_says_until_when_no_recontact_is_known() {
    let shell = Scratch::new();
    let body = |name: &str, mass: f64, place: f64, spin: f64| {
        format!(
            "[{name}.dispersion]\nroot_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]\naxes = \"fixed\"\n[{name}]\n\
             mass_kg = {mass:?}\ninertia_kg_m2 = [[120.0, 0, 0], [0, 110.0, 0], [0, 0, 90.0]]\n\
             position_m = [0, 0, {place:?}]\nangular_velocity_rad_per_s = [{spin:?}, 0, 0.2]\n"
        )
    };
    let springs = "[[springs]]\nstiffness_n_per_m = 20000.0\nstroke_m = 0.1\n\
                   payload_point_m = [0, 0.1, -0.9]\nstage_point_m = [0, 0.1, 0.9]\n";
    for (spin, told) in
        [(200.0, "none up to 3"), (0.0, "none up to 100000 s after the last release")]
    {
        let text = format!(
            "name = \"fast\"\nruns = 2\n{}{}{springs}[[models]]\nname = \"own\"\nlaw = \"principal\"\n\
             axes = \"whole-sphere\"\n[clearance]\ncoast_s = 1e5\npayload = [{{ points_m = [[0, 0, 3000.0]] }}]\n\
             stage = [{{ points_m = [[0, 3000.0, 0]] }}]\n",
            body("payload", 500.0, 1.0, spin),
            body("stage", 2000.0, -1.0, 0.1 * spin / 200.0),
        );
        fs::write(shell.path("fast.toml"), text).unwrap();
        let said = shell.done(&["replay", "fast.toml", "--run", "0", "--force"], 0);
        let line = said.lines().find(|line| line.trim_start().starts_with("recontact ")).unwrap();
        let after = line.trim_start().trim_start_matches("recontact").trim();
        assert!(after.starts_with(told), "{said}");
        assert_eq!(after.ends_with("and it is not known after"), spin > 0.0, "{said}");
    }
}
