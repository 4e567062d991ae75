//! What `gyradius draw` and `gyradius check --repair` say of slips: in robots, in options.

use serde_json::Value;
use std::fs;

use crate::draw_robots::{draw, refused};
use crate::scratch::Scratch;

fn robot(mass: &str, izz: &str, origin: &str) -> String {
    format!(
        "<robot name='r'>\n<link name='a'><inertial>{origin}<mass value='{mass}'/><inertia ixx='.02' ixy='0' ixz='0' \
         iyy='.03' iyz='0' izz='{izz}'/></inertial></link>\n<link name='b'><inertial><mass value='1'/><inertia \
         ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>"
    )
}

/// A mass that is none was said to be mended by a repair, which touches inertias alone.
#[test]
fn only_what_a_repair_mends_is_said_to_be_mended() {
    let shell = Scratch::new();
    let stated = ["a.urdf", "-n", "1", "--mass", "10%", "-o", "out"];
    for (mass, izz, expected) in [
        ("-1", ".04", "\"a\": mass = -1 kg: it must not be negative: --links picks others"),
        ("-1", ".9", "\"a\": mass = -1 kg: it must not be negative: --links picks others"),
        ("1", ".9", "no body has the inertia of a: `gyradius check` says why, and with --repair"),
    ] {
        fs::write(shell.path("a.urdf"), robot(mass, izz, "")).unwrap();
        let message = refused(&shell, &stated);
        assert!(message.contains(expected), "{message}");
        // A repair mends it if and only if the message says so.
        let code = shell.run(&["check", "--repair", "--force", "a.urdf"]).status.code();
        let mended = expected.contains("--repair");
        assert_eq!(code, Some(if mended || izz == ".04" { 1 } else { 2 }));
        if mended {
            draw(&shell, &["a.repaired.urdf", "-n", "1", "--mass", "10%", "-o", "out"]);
            fs::remove_file(shell.path("a.repaired.urdf")).unwrap();
        }
        assert!(!shell.path("a.repaired.urdf").exists());
    }
}

/// In text and in JSON, with the line; what can be repaired beside it is.
#[test]
fn a_body_that_is_not_repaired_is_named_with_its_line() {
    let shell = Scratch::new();
    fs::write(shell.path("a.urdf"), robot("0", ".9", "").replace("izz='1'", "izz='3'")).unwrap();
    let output = shell.run(&["check", "--repair", "--format", "json", "a.urdf"]);
    assert_eq!(output.status.code(), Some(2));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let error = &found["errors"][0];
    assert_eq!(error["line"], 2, "{found}");
    let message = error["message"].as_str().unwrap();
    assert!(
        message.contains("not repaired: line 2: \"a\": inertia on a mass of 0 kg"),
        "{message}"
    );
    assert_eq!(found["repairs"][0]["changes"][0]["name"], "b", "{found}");
    let copy = fs::read_to_string(shell.path("a.repaired.urdf")).unwrap();
    assert!(copy.contains("izz='.9'") && !copy.contains("izz='3'"), "{copy}");
}

/// However a number of a link is malformed, the robot is refused, and --links picks others.
#[test]
fn malformed_numbers_are_refused_alike() {
    let shell = Scratch::new();
    for (xyz, why) in [
        ("1 2", "xyz has 2 values: there must be 3"),
        ("1 2 3 4", "xyz has 4 values: there must be 3"),
        ("1 2 nan", "xyz = \"nan\": it must be finite"),
        ("1 2 x", "xyz = \"x\" is not a number"),
    ] {
        fs::write(shell.path("a.urdf"), robot("1", ".04", &format!("<origin xyz='{xyz}'/>")))
            .unwrap();
        let all = ["a.urdf", "-n", "1", "--mass", "10%", "-o", "out"];
        let message = refused(&shell, &all);
        assert!(message.contains(&format!("\"a\": {why}")), "{message}");
        assert!(message.contains("--links picks others"), "{message}");
        draw(&shell, &[&all[..], &["--links", "b", "--force"]].concat());
    }
}

/// Options are called as they are written.
#[test]
fn amounts_that_are_refused_are_named_by_their_option() {
    let shell = Scratch::new();
    fs::write(shell.path("a.urdf"), robot("1", ".04", "")).unwrap();
    for (stated, expected) in [
        (&["--mass", "nan%"][..], "'--mass <AMOUNT>': it must be finite and not negative"),
        (&["--mass=-1kg"], "'--mass <AMOUNT>': it must be finite and not negative"),
        (&["--centre", "1mm,infm,1mm"], "'--centre <AMOUNT>': it must be finite"),
        (&["--moments", "inf%"], "'--moments <AMOUNT>': it must be finite"),
        (&["--axes", "nandeg"], "'--axes <AMOUNT>': it must be finite"),
        (&["--mass", "1%", "--sigmas", "0"], "error: --sigmas 0.0: it must be between 0.1 and"),
        (&["--axes", "1deg", "--sigmas", "nan"], "error: --sigmas NaN: it must be between 0.1 and"),
        (&["--mass", "1e9%"], "error: --mass: with sigmas = 1.0 this is a standard deviation"),
        (&["--centre", "1e30m"], "error: --centre: with sigmas = 1.0 this is a standard deviation"),
        (
            &["--moments", "1e9%"],
            "error: --moments: with sigmas = 1.0 this is a standard deviation",
        ),
        (&["--axes", "1e9deg"], "error: --axes: with sigmas = 1.0 this is a standard deviation"),
    ] {
        let output = shell.run(&[&["draw", "a.urdf", "-n", "1", "-o", "out"], stated].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{stated:?}: {message}");
        assert!(message.contains(expected), "{stated:?}: {message}");
        for key in [".percent", ".kg", ".sigmas", ".deg", ".m ", ".m["] {
            assert!(!message.contains(key), "{message}");
        }
    }
}

/// What is beyond a link is a slip in any unit, and all links are named of which it is one; a table is refused as robots are.
#[test]
fn amounts_that_are_beyond_a_link_are_refused_with_its_name() {
    let shell = Scratch::new();
    // Beside a link of 1 kg with moments of .02, .03 and .04 kg·m² one of 20 g.
    let finger = "<link name='finger'><inertial><mass value='.02'/><inertia ixx='2e-6' iyy='3e-6' izz='4e-6' \
                  ixy='0' ixz='0' iyz='0'/></inertial></link></robot>";
    let text = robot("1", ".04", "").replace("</robot>", finger);
    fs::write(shell.path("a.urdf"), text).unwrap();
    for (stated, finger, other) in [
        (&["--mass", "15g"][..], None, None),
        (&["--mass", "50g", "--sigmas", "3"], None, None),
        (&["--mass", "0.2kg"], Some("at most the nominal mass, which is 0.02 kg"), None),
        (&["--mass", "0.2kg", "--sigmas", "3"], Some("a standard deviation of 0.066667 kg"), None),
        (&["--mass", "5kg"], Some("which is 0.02 kg"), Some("which is 1.0 kg")),
        (&["--moments", "8e-6kgm2"], None, None),
        (&["--moments", "1e-4kgm2"], Some("10 times the trace"), None),
        (&["--moments", "1kgm2"], Some("which is 9e-6 kg·m²"), Some("which is 0.09 kg·m²")),
    ] {
        for out in [&["-o", "out/", "--force"][..], &[]] {
            let all = [&["draw", "a.urdf", "-n", "1"], stated, out].concat();
            let output = shell.run(&all);
            let message = String::from_utf8(output.stderr).unwrap();
            let is_refused = finger.is_some() || other.is_some();
            let code = if is_refused { 2 } else { 0 };
            assert_eq!(output.status.code(), Some(code), "{stated:?}: {message}");
            let of = |link: &str| message.split_once(&format!("\"{link}\": ")).map(|(_, why)| why);
            for (link, expected) in [("finger", finger), ("a", other)] {
                let why = of(link);
                assert_eq!(why.is_some(), expected.is_some(), "{stated:?}, {link}: {message}");
                assert!(
                    why.unwrap_or_default().contains(expected.unwrap_or_default()),
                    "{message}"
                );
            }
            assert!(!is_refused || message.contains("--links picks others"), "{message}");
        }
    }
    let rest = ["draw", "a.urdf", "-n", "1", "--mass", "0.2kg", "--links", "a,b"];
    assert!(shell.run(&rest).status.success());
}

/// What is stated of links makes a file no scenario: why it is not read as a robot is said.
#[test]
fn what_is_not_read_as_a_robot_says_why() {
    let shell = Scratch::new();
    for (name, expected) in [
        ("a.usda", "a.usda: USD files are not read here: convert it to URDF, MJCF or SDF"),
        ("a.mjb", "MuJoCo's binary files are not read here"),
        ("a.urdf.jinja", "it is a template: expand it first"),
        ("-", "-: a robot is not read from standard input: write it into a file first"),
        ("a.toml", "a scenario says itself what is uncertain"),
    ] {
        let text = if name == "a.urdf.jinja" { "<robot/>" } else { "#usda 1.0" };
        fs::write(shell.path(name), text).unwrap();
        let message = refused(&shell, &[name, "-n", "1", "--mass", "10%", "-o", "out"]);
        assert!(message.contains(expected), "{name}: {message}");
    }
    // Any name will do where the file itself tells.
    for name in ["a.txt", "a", "a.v2"] {
        fs::write(shell.path(name), robot("1", ".04", "")).unwrap();
        draw(&shell, &[name, "-n", "1", "--mass", "10%", "-o", "table.csv", "--force"]);
    }
}

/// Where nothing is said of the axes, or that they do not scatter, zero products stay as they are written, and so does what a file
/// says of principal moments.
#[test]
fn axes_that_do_not_scatter_leave_products_as_they_are_written() {
    let shell = Scratch::new();
    fs::write(shell.path("a.urdf"), robot("1", ".04", "")).unwrap();
    let mjcf = "<mujoco><worldbody><body name='a'><inertial pos='0 0 0' mass='1' diaginertia='.02 .03 .04'/>\
                </body></worldbody></mujoco>";
    fs::write(shell.path("a.xml"), mjcf).unwrap();
    let zero = "<sdf version='1.9'><model name='m'><link name='a'><inertial><inertia><ixx>.9</ixx></inertia></inertial>\
                </link></model></sdf>";
    fs::write(shell.path("a.sdf"), zero).unwrap();
    for stated in [
        &["--moments", "15%"][..],
        &["--moments", "15%", "--mass", "5%", "--centre", "1mm"],
        &["--moments", "15%", "--axes", "0deg"],
        &["--moments", "3%,5%,1%"],
        &["--moments", "0%"],
        &["--axes", "0rad"],
        &["--moments", "0%", "--axes", "0deg", "--mass", "0%"],
    ] {
        let moves = stated.iter().any(|word| ["15%", "3%,5%,1%"].contains(word));
        for (name, still) in [
            ("a.urdf", "ixy='0' ixz='0'"),
            ("a.xml", "diaginertia="),
            ("a.sdf", "</ixx></inertia>"),
        ] {
            let all = [&[name, "-n", "3", "-o", "out/", "--force"], stated].concat();
            draw(&shell, &all);
            let original = fs::read_to_string(shell.path(name)).unwrap();
            let (stem, extension) = name.split_once('.').unwrap();
            for number in 0..3 {
                let path = shell.path(&format!("out/{stem}-000{number}.{extension}"));
                let text = fs::read_to_string(path).unwrap();
                let is_still = text.contains(still) || (name == "a.sdf" && !text.contains("<ixy>"));
                assert!(is_still && !text.contains("fullinertia"), "{stated:?} {text}");
                assert_eq!(text != original, moves, "{stated:?} {text}");
            }
        }
        fs::remove_dir_all(shell.path("out")).unwrap();
    }
}

/// What is in the place of a folder is named, and so is the file that cannot be drawn, of which nothing is left behind.
#[cfg(unix)]
#[test]
fn outputs_that_cannot_be_written_are_named() {
    use std::process::Stdio;

    let shell = Scratch::new();
    fs::write(shell.path("a.urdf"), robot("1", ".04", "")).unwrap();
    std::os::unix::fs::symlink("nowhere", shell.path("lost")).unwrap();
    let with = |robot: &'static str, out: &'static str| {
        ["draw", robot, "-n", "2", "--mass", "5%", "--centre", "1mm", "-o", out]
    };
    for out in ["a.urdf/", "/dev/null", "lost"] {
        let output = shell.run(&with("a.urdf", out));
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains(&format!("{out} is there and is no folder")), "{message}");
    }
    let entity = robot("1", ".04", "<origin xyz='1 2 &#51;'/>");
    fs::write(shell.path("e.urdf"), entity).unwrap();
    let output = shell.run(&with("e.urdf", "out"));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("e.urdf: line 2: \"a\": its mass centre is not written"), "{message}");
    assert!(!shell.path("out").exists());
    let output = shell.run(&with("a.urdf", "nowhere/t.csv"));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("nowhere/t.csv") && !message.contains(".gyradius"), "{message}");
    if let Ok(full) = fs::File::create("/dev/full") {
        let mut command = shell.command(&["draw", "a.urdf", "-n", "99", "--mass", "5%"]);
        let output = command.stdout(Stdio::from(full)).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains("error: standard output: "), "{message}");
    }
}

/// What of a folder is not read is named: keys, compressed files, tables beside those that are judged.
#[test]
fn what_is_not_read_is_named_in_text_and_in_json() {
    let shell = Scratch::new();
    fs::create_dir(shell.path("f")).unwrap();
    let inertia = "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]";
    let body = format!("{{\"inertia_kg_m2\": {inertia}, \"colour\": 1, \"material\": \"steel\"}}");
    let bodies = format!("{{\"bodies\": {{\n\"a\": {body},\n\"b\": {body}}}}}");
    fs::write(shell.path("f/a.json"), bodies).unwrap();
    for name in ["f/b.urdf.gz", "f/c.zip"] {
        fs::write(shell.path(name), "").unwrap();
    }
    let table = "# samples\nunit,ixx,iyy,izz,Units\nFM-1,1,1,1,kg m2\nFM-2,1,1,1,kg m2\n";
    fs::write(shell.path("f/d.csv"), table).unwrap();
    let told = shell.done(&["check", "f"], 0);
    for note in [
        "note: f/a.json:2: 2 keys are not read: colour, material",
        "note: f/d.csv:2: 1 column is not read: unit; the cells name things and no units",
    ] {
        assert!(told.lines().any(|line| line == note), "{told}");
    }
    assert!(told.contains("f/b.urdf.gz: it is compressed") && told.contains("f/c.zip"), "{told}");
    assert!(told.contains("2 files passed over"), "{told}");
    let found: Value =
        serde_json::from_str(&shell.done(&["check", "f", "--format", "json"], 0)).unwrap();
    let keys = serde_json::json!([
        { "file": "f/a.json", "line": 2, "keys": ["colour", "material"] },
        { "file": "f/d.csv", "line": 2, "keys": ["unit"] },
    ]);
    assert_eq!(found["unread_keys"], keys, "{found}");
    assert_eq!(found["summary"]["passed_over"], 2, "{found}");

    shell.done(&["study", "--runs", "40", "--out", "s"], 0);
    fs::create_dir(shell.path("runs")).unwrap();
    let block = "000000000-000000039.parquet";
    fs::copy(shell.path(&format!("s/runs/proposed/{block}")), shell.path("runs/a.parquet"))
        .unwrap();
    let judge = ["verdict", "runs", "--require", "nutation_deg <= 90 in 50 % at 90 %"];
    assert!(!shell.done(&judge, 0).contains("Not judged"));
    fs::write(shell.path("runs/b.csv.gz"), "").unwrap();
    let told = shell.done(&judge, 0);
    assert!(told.contains("Not judged, though there may be runs in it: b.csv.gz."), "{told}");
    let found: Value =
        serde_json::from_str(&shell.done(&[&judge[..], &["--json"]].concat(), 0)).unwrap();
    assert_eq!(found["not_judged"], serde_json::json!(["runs/b.csv.gz"]), "{found}");
    fs::rename(shell.path("runs/b.csv.gz"), shell.path("runs/b.parquet.gz")).unwrap();
    let refused = shell.run(&judge);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(said.contains("runs/b.parquet.gz: it is a compressed Parquet file"), "{said}");
}
