//! `gyradius check` as a user meets it: what it lists, what it writes, and how it ends.

use serde_json::Value;
use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};
use tempfile::TempDir;

struct Shell(TempDir);

impl Shell {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_gyradius"))
            .current_dir(self.0.path())
            .arg("check")
            .args(arguments)
            .output()
            .unwrap()
    }

    /// Exit code, standard output, standard error.
    fn check(&self, arguments: &[&str]) -> (i32, String, String) {
        let output = self.run(arguments);
        let out = String::from_utf8(output.stdout).unwrap();
        let messages = String::from_utf8(output.stderr).unwrap();
        assert!(!messages.contains("panicked"), "{messages}");
        (output.status.code().unwrap(), out, messages)
    }

    fn json(&self, arguments: &[&str]) -> (i32, Value) {
        let (code, out, messages) = self.check(&[arguments, &["--format", "json"]].concat());
        assert!(messages.is_empty(), "{messages}");
        (code, serde_json::from_str(&out).unwrap())
    }
}

fn link(name: &str, mass: &str, moments: [&str; 3], products: [&str; 3]) -> String {
    let ([x, y, z], [xy, xz, yz]) = (moments, products);
    format!(
        "  <link name=\"{name}\">\n    <inertial><mass value=\"{mass}\"/>\n      <inertia ixx=\"{x}\" \
         iyy=\"{y}\" izz=\"{z}\" ixy=\"{xy}\" ixz=\"{xz}\" iyz=\"{yz}\"/></inertial>\n  </link>\n"
    )
}

fn robot(links: &[String]) -> String {
    format!("<robot name=\"r\"> <!-- kept -->\n{}</robot>\n", links.concat())
}

const NONE: [&str; 3] = ["0", "0", "0"];

fn good() -> String {
    link("good", "1", ["1", "1", "1"], NONE)
}

fn bad() -> String {
    link("bad", "1", ["1", "1", "3"], NONE)
}

#[test]
fn the_worst_comes_first_with_shortfall_reason_and_place() {
    let shell = Shell::new();
    let worse = link("worse", "1", ["1", "-2", "1"], NONE);
    shell
        .write("r.urdf", robot(&[good(), bad(), worse, link("dummy", "0", ["1", "1", "1"], NONE)]));
    let (code, out, messages) = shell.check(&["r.urdf"]);
    assert_eq!(code, 1, "{out}{messages}");
    let lines: Vec<&str> = out.lines().collect();
    assert!(lines[1].contains("negative  worse") && lines[1].contains("-2, 1, 1"), "{out}");
    assert!(lines[2].contains("50.0 %  bad") && lines[2].contains("3 > 1 + 1"), "{out}");
    assert!(lines[2].ends_with("r.urdf:8"), "{out}");
    assert!(lines[3].contains("no mass  dummy") && lines[3].contains("on a mass of 0 kg"), "{out}");
    assert!(lines.iter().all(|line| line.chars().count() <= 90), "{out}");
    assert!(out.contains("1 file, 4 bodies: 2 impossible, 1 with no mass"), "{out}");
    assert!(!out.contains("good"), "{out}");
    assert!(shell.check(&["r.urdf", "--all"]).1.contains("ok  good"), "with --all");
}

#[test]
fn exit_codes_tell_findings_from_failures() {
    let shell = Shell::new();
    shell.write("good.urdf", robot(&[good()]));
    shell.write("bad.urdf", robot(&[bad()]));
    shell.write("broken.urdf", "<robot>\n<link>\n</robot>");
    shell.write("half.urdf", robot(&[good(), link("x", "1", ["1", "${m}", "1"], NONE), bad()]));
    let (code, out, _) = shell.check(&["good.urdf"]);
    assert_eq!((code, out.lines().count()), (0, 1), "{out}");
    assert_eq!(shell.check(&["good.urdf", "bad.urdf"]).0, 1);
    let (code, out, messages) = shell.check(&["broken.urdf", "bad.urdf"]);
    assert_eq!(code, 1, "what is found is not hidden by what is not read: {messages}");
    assert_eq!(shell.check(&["broken.urdf", "good.urdf"]).0, 2);
    assert!(messages.starts_with("error: broken.urdf:3: malformed"), "{messages}");
    assert!(
        out.contains("50.0 %") && out.contains("1 file unreadable"),
        "the others are done: {out}"
    );
    let (code, out, _) = shell.check(&["half.urdf"]);
    assert_eq!(code, 1);
    assert!(out.contains("iyy = \"${m}\" is not a number but an expression"), "{out}");
    assert!(out.contains("1 impossible, 1 unread"), "{out}");
    assert_eq!(shell.check(&["nowhere.urdf"]).0, 2);
    assert_eq!(shell.check(&[]).0, 2);
    for tolerance in ["-1", "nan", "1", "x"] {
        assert_eq!(shell.check(&["good.urdf", "--tolerance", tolerance]).0, 2, "{tolerance}");
    }
}

#[test]
fn every_unreadable_file_has_its_own_message() {
    let shell = Shell::new();
    for (name, bytes, words) in [
        ("empty.urdf", &b""[..], "it is empty"),
        ("binary.urdf", b"\x7fELF\x02\x01\x00\x00", "binary"),
        ("utf16.urdf", b"\xff\xfe<\0r\0", "UTF-16"),
        ("latin.urdf", b"<robot name='\xe9'/>", "not UTF-8"),
        ("twice.urdf", b"<robot>\n\n<link a='1' a='2'/></robot>", "twice.urdf:3: malformed: dup"),
        ("open.urdf", b"<robot>\n<link>", "open.urdf:2: malformed: <link> is not closed"),
        ("notes.txt", b"words", "its extension is none of"),
        ("package.xml", b"<package/>", "its root element is <package>"),
        ("other.json", b"{}", "no table in it has a key inertia_kg_m2"),
        ("other.csv", b"a,b\n1,2", "columns ixx, iyy and izz"),
        ("bad.toml", b"a = 1\nb = = 2", "bad.toml:2: malformed"),
    ] {
        shell.write(name, bytes);
        let (code, _, messages) = shell.check(&[name]);
        assert_eq!(code, 2, "{name}");
        assert!(messages.contains(words), "{name}: {messages}");
    }
    let deep = format!("<robot>{}{}</robot>", "<a>".repeat(300), "</a>".repeat(300));
    shell.write("deep.urdf", deep);
    assert!(shell.check(&["deep.urdf"]).2.contains("deeper than 256 levels"));
    // In a folder, those that are not ours are passed over.
    let (code, out, messages) = shell.check(&["."]);
    assert_eq!(code, 2);
    assert_eq!(messages.lines().count(), 7, "{messages}");
    for name in ["notes.txt", "package.xml", "other.json", "other.csv", "bad.toml"] {
        assert!(!messages.contains(name) && !out.contains(name), "{name}: {messages}");
    }
}

#[test]
fn a_repaired_copy_differs_in_its_numbers_only() {
    let shell = Shell::new();
    shell.write("r.urdf", robot(&[good(), bad()]).replace('\n', "\r\n"));
    let before = shell.read("r.urdf");
    let (code, out, messages) = shell.check(&["r.urdf", "--repair"]);
    assert_eq!(code, 1, "what was found was found: {messages}");
    assert!(out.contains("wrote r.repaired.urdf (1 body repaired)"), "{out}");
    assert_eq!(shell.read("r.urdf"), before, "the original is as it was");
    let after = shell.read("r.repaired.urdf");
    let changed: Vec<_> =
        before.split('\n').zip(after.split('\n')).filter(|(a, b)| a != b).collect();
    assert_eq!(changed.len(), 1, "{changed:?}");
    assert!(changed[0].1.contains("ixy=\"0\"") && changed[0].1.ends_with("/></inertial>\r"));
    assert_eq!(shell.check(&["r.repaired.urdf", "--tolerance", "0"]).0, 0, "{after}");
    // Again: the same copy is there. Another one is not replaced without --force.
    assert!(shell.check(&["r.urdf", "--repair"]).1.contains("unchanged: r.repaired.urdf"));
    shell.write("r.repaired.urdf", "precious");
    let (code, _, messages) = shell.check(&["r.urdf", "--repair"]);
    assert_eq!(code, 2);
    assert!(messages.contains("r.repaired.urdf exists: --force replaces it"), "{messages}");
    assert_eq!(shell.read("r.repaired.urdf"), "precious");
    assert_eq!(shell.check(&["r.urdf", "--repair", "--force"]).0, 1);
    assert_eq!(shell.read("r.repaired.urdf"), after);
    // Nothing to repair: nothing is written.
    shell.write("g.urdf", robot(&[good()]));
    assert_eq!(shell.check(&["g.urdf", "--repair"]).0, 0);
    assert!(!shell.path("g.repaired.urdf").exists());
}

/// An entity in one body kept its neighbours from being repaired.
#[test]
fn a_body_that_cannot_be_repaired_does_not_hold_up_the_others() {
    let shell = Shell::new();
    let entity = link("entity", "1", ["1", "1", "&#51;"], NONE);
    shell.write("r.urdf", robot(&[bad(), entity.clone()]));
    let (code, out, messages) = shell.check(&["r.urdf", "--repair"]);
    assert_eq!(code, 2);
    assert!(messages.contains("not repaired: line 8: \"entity\""), "{messages}");
    assert!(out.contains("wrote r.repaired.urdf (1 body repaired)"), "{out}");
    assert!(shell.read("r.repaired.urdf").contains(&entity), "as it was");
    assert!(shell.check(&["r.repaired.urdf"]).1.contains("1 impossible"));
}

/// They were said to be infinitely short.
#[test]
fn lopsided_and_huge_matrices_are_called_so() {
    let shell = Shell::new();
    let json = r#"[{"name": "skew", "inertia_kg_m2": [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]},
        {"name": "huge", "inertia_kg_m2": [[1e308, 0, 0], [0, 1e308, 0], [0, 0, 1e308]]},
        {"name": "ones", "inertia_kg_m2": [[1e-6, 1e-6, 1e-6], [1e-6, 1e-6, 1e-6], [1e-6, 1e-6, 1e-6]]},
        {"name": "line", "inertia_kg_m2": [[0, 0, 0], [0, 0, 0], [0, 0, 3]]}]"#;
    shell.write("a.json", json);
    let (code, out, _) = shell.check(&["a.json"]);
    assert_eq!(code, 1);
    let lines: Vec<&str> = out.lines().skip(1).collect();
    assert!(lines[0].contains("too large  huge  entry I11 = 1e308 kg·m²: it must be"), "{out}");
    assert!(lines[1].contains("infinite  ones  3e-6 > 0 + 0"), "rounding is zero: {out}");
    assert!(lines[2].contains("infinite  line  3 > 0 + 0"), "{out}");
    assert!(lines[3].contains("asymmetric  skew") && lines[3].contains("10.00 %"), "{out}");
}

#[test]
fn a_checked_file_is_never_written_over() {
    let shell = Shell::new();
    shell.write("r.urdf", robot(&[bad()]));
    shell.write("r.repaired.urdf", robot(&[bad()]));
    let both = ["r.urdf", "r.repaired.urdf", "--repair", "--force"];
    let (code, _, messages) = shell.check(&both);
    assert_eq!(code, 2);
    assert!(messages.contains("originals are never written over"), "{messages}");
    assert_eq!(shell.read("r.repaired.urdf"), robot(&[bad()]));
}

#[test]
fn json_is_complete_and_alone_on_standard_output() {
    let shell = Shell::new();
    shell.write("r.urdf", robot(&[good(), bad(), link("x", "1", ["", "1", "1"], NONE)]));
    shell.write("broken.urdf", "<robot>");
    let (code, json) = shell.json(&["."]);
    assert_eq!(code, 1);
    assert_eq!(json["schema"], 1);
    assert_eq!(json["tolerance"], 1e-6);
    let summary = serde_json::json!(
        {"files": 1, "bodies": 3, "impossible": 1, "possible_with_flipped_products": 0,
         "no_mass": 0, "unread": 1, "errors": 1, "passed_over": 0, "without_inertia": 0}
    );
    assert_eq!(json["summary"], summary);
    let body = &json["bodies"][0];
    for (key, value) in [
        ("name", Value::from("bad")),
        ("line", 8.into()),
        ("format", "URDF".into()),
        ("status", "impossible".into()),
        ("mass_kg", 1.0.into()),
        ("inertia_kg_m2", serde_json::json!([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 3.0]])),
        ("principal_moments_kg_m2", serde_json::json!([1.0, 1.0, 3.0])),
        ("second_moments_kg_m2", serde_json::json!([1.5, 1.5, -0.5])),
        ("shortfall_percent", 50.0.into()),
    ] {
        assert_eq!(body[key], value, "{key}");
    }
    assert!(body["reasons"][0].as_str().unwrap().contains("exceeds the sum"), "{body}");
    assert_eq!(json["bodies"][1]["status"], "unread");
    assert_eq!(json["bodies"].as_array().unwrap().len(), 2);
    assert_eq!(json["errors"][0]["line"], 1);
    assert!(json["errors"][0]["file"].as_str().unwrap().ends_with("broken.urdf"));
    assert_eq!(shell.json(&["r.urdf", "--all"]).1["bodies"].as_array().unwrap().len(), 3);
    let (_, json) = shell.json(&["r.urdf", "--repair"]);
    assert_eq!(json["repairs"][0]["copy"], "r.repaired.urdf");
    assert_eq!(json["repairs"][0]["written"], true);
}

#[test]
fn the_sign_of_products_can_be_flipped_and_is_guessed() {
    let shell = Shell::new();
    shell.write("r.urdf", robot(&[link("strut", "1", ["2", "2", "2"], ["1", "1", "1"])]));
    let (code, out, _) = shell.check(&["r.urdf"]);
    assert_eq!(code, 1);
    assert!(out.contains("with the signs of its products flipped, the commonest slip"), "{out}");
    assert!(out.contains("1 impossible, 1 of them possible with flipped products"), "{out}");
    assert_eq!(shell.check(&["r.urdf", "--flip-products"]).0, 0);
}

#[test]
fn the_tolerance_decides_about_rounded_plates() {
    let shell = Shell::new();
    shell.write("r.urdf", robot(&[link("plate", "1", ["0.333333", "0.666666", "1"], NONE)]));
    assert_eq!(shell.check(&["r.urdf"]).0, 0);
    let (code, out, _) = shell.check(&["r.urdf", "--tolerance", "1e-9"]);
    assert_eq!(code, 1);
    assert!(out.contains("1e-4 %"), "{out}");
}

/// Tolerances above and below what the computation rounds by: all that is written says the one that decides.
#[test]
fn the_tolerance_that_is_told_is_the_one_that_decides() {
    let shell = Shell::new();
    let least = 64.0 * f64::EPSILON;
    for exponent in -17..=-2 {
        for (given, outside) in
            [(10_f64.powi(exponent), 0.9), (10_f64.powi(exponent), 1.1), (0.0, 0.9), (0.0, 1.1)]
        {
            let told = given.max(least);
            // min K = −outside · told · tr(I), in a body of which doubles hold the moments exactly.
            let moment = |x: f64| format!("{x:?}");
            let far = 4.0 * outside * told;
            shell.write(
                "r.urdf",
                robot(&[link("plate", "1", [&moment(0.5 - far), "0.5", "1"], NONE)]),
            );
            let tolerance = moment(given);
            let arguments = ["r.urdf", "--tolerance", &tolerance];
            let (code, out, _) = shell.check(&arguments);
            assert_eq!(code, i32::from(outside > 1.0), "{given} {outside}: {out}");
            assert!(out.contains(&format!("(tolerance {told:?})")), "{out}");
            assert_eq!(shell.json(&arguments).1["tolerance"], told);
        }
    }
}

#[test]
fn folders_are_walked_in_order_and_files_read_once() {
    let shell = Shell::new();
    for name in ["b/1.urdf", "a/2.urdf", "a/1.urdf", ".hidden/1.urdf", "a/1.repaired.urdf"] {
        shell.write(name, robot(&[bad()]));
    }
    let (_, out, _) = shell.check(&[".", "a/1.urdf", "b"]);
    let place = |name| out.find(name).unwrap();
    assert!(place("a/1.urdf:4") < place("a/2.urdf:4") && place("a/2.urdf:4") < place("b/1.urdf:4"));
    assert!(out.contains("3 files, 3 bodies: 3 impossible"), "{out}");
    assert_eq!(out, shell.check(&[".", "a/1.urdf", "b"]).1, "the same every time");
    assert!(shell.check(&["a/1.repaired.urdf"]).1.contains("1 impossible"), "by name it is read");
}

#[test]
fn names_from_files_do_not_command_the_terminal() {
    let shell = Shell::new();
    shell.write("r.csv", "name,ixx,iyy,izz\n\u{1b}[2Jx,1,1,3\ny,\u{1b}[2J,1,1\n");
    let (_, out, _) = shell.check(&["r.csv"]);
    assert!(!out.contains('\u{1b}'), "{out:?}");
}

/// What a file in a folder makes of the exit code and where it is named: every kind, in every
/// company.
#[test]
fn every_file_of_every_mixture_is_accounted_for() {
    const IMPOSSIBLE: u8 = 1;
    const REFUSED: u8 = 2;
    let macros = "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:arm m='1'/>\
                  <link name='a'><inertial><mass value='${m}'/></inertial></link></robot>";
    let entity = "<!DOCTYPE robot [<!ENTITY arm \"<link/>\">]><robot>&arm;</robot>";
    // Name, content, what it does to the exit code, bodies, and the list that names it.
    let kinds: [(&str, String, u8, usize, &str); 8] = [
        ("good.urdf", robot(&[good()]), 0, 1, "bodies"),
        ("bad.urdf", robot(&[bad()]), IMPOSSIBLE, 1, "bodies"),
        ("dummy.urdf", robot(&[link("d", "0", ["1", "1", "1"], NONE)]), IMPOSSIBLE, 1, "bodies"),
        ("unread.urdf", robot(&[link("u", "1", ["x", "1", "1"], NONE)]), REFUSED, 1, "bodies"),
        ("broken.urdf", "<robot>".to_owned(), REFUSED, 0, "errors"),
        ("entity.urdf", entity.to_owned(), REFUSED, 0, "errors"),
        ("macros.xacro", macros.to_owned(), 0, 0, "passed_over"),
        ("arm.usd", "PXR-USDC".to_owned(), 0, 0, "passed_over"),
    ];
    for mixture in 0_usize..1 << kinds.len() {
        let shell = Shell::new();
        let there: Vec<_> = kinds
            .iter()
            .enumerate()
            .filter(|(i, _)| mixture >> i & 1 == 1)
            .map(|(_, k)| k)
            .collect();
        for (name, text, ..) in &there {
            shell.write(&format!("in/{name}"), text);
        }
        shell.write("in/package.xml", "<package/>");
        let (code, json) = shell.json(&["in", "--all"]);
        let has = |effect| there.iter().any(|kind| kind.2 == effect);
        let bodies: usize = there.iter().map(|kind| kind.3).sum();
        let expected = match (has(IMPOSSIBLE), has(REFUSED) || bodies == 0) {
            (true, _) => 1,
            (false, true) => 2,
            (false, false) => 0,
        };
        assert_eq!(code, expected, "{json:#}");
        assert_eq!(json["summary"]["bodies"], bodies, "{json:#}");
        for (name, _, _, _, list) in there {
            let named = json[*list].as_array().unwrap().iter().any(|entry| {
                entry["file"].as_str().unwrap().ends_with(name) && entry["may_hold_bodies"] != false
            });
            assert!(named, "{name} in {list}: {json:#}");
        }
        assert_eq!(json["summary"]["without_inertia"], 1, "{json:#}");
    }
}

#[test]
fn an_empty_folder_and_a_file_without_bodies_are_errors() {
    let shell = Shell::new();
    fs::create_dir(shell.path("empty")).unwrap();
    shell.write("good.urdf", robot(&[good()]));
    shell.write("frames.urdf", "<robot><link name='a'/></robot>");
    for (arguments, words) in [
        (&["empty"][..], "empty: no file in it has an extension that is read"),
        (&["empty", "good.urdf"], "empty: no file in it has"),
        (&["frames.urdf"], "frames.urdf: no inertia of a body was found"),
    ] {
        let (code, _, messages) = shell.check(arguments);
        assert!(code == 2 && messages.contains(words), "{arguments:?}: {messages}");
    }
    assert_eq!(shell.check(&["frames.urdf", "good.urdf"]).0, 0);
}

#[test]
fn what_is_passed_over_is_named_and_what_is_included_and_checked_is_not() {
    let shell = Shell::new();
    let body = "<body name='b'><inertial mass='1' diaginertia='1 1 3'/></body>";
    shell.write("m/scene.xml", "<mujoco>\n<include file='parts/arm.xml'/></mujoco>");
    shell.write("m/parts/arm.xml", format!("<arm>{body}</arm>"));
    shell.write("m/arm.mjb", "x");
    shell.write("m/notes.json", "{\"inertia\": 3}");
    let (code, out, _) = shell.check(&["m"]);
    assert_eq!(code, 1, "a root of any name is read: {out}");
    assert!(out.contains("passed over:\n") && out.contains("arm.mjb: MuJoCo's binary"), "{out}");
    assert!(out.contains("notes.json: not a format") && !out.contains("scene.xml"), "{out}");
    assert!(out.contains("1 impossible, 2 files passed over, 1 file without inertias"), "{out}");
    assert!(shell.check(&["m", "--all"]).1.contains("scene.xml: there is no inertia in it"));
    let (code, out, messages) = shell.check(&["m/scene.xml"]);
    assert_eq!(code, 2, "{messages}");
    assert!(out.contains("scene.xml:2: 1 included file is not followed: parts/arm.xml"), "{out}");
}

/// Models are included by the names of their folders, from wherever Gazebo finds them.
#[test]
fn an_included_model_that_is_checked_is_not_passed_over() {
    let model = |inside: &str| format!("<sdf version='1.9'><model name='m'>{inside}</model></sdf>");
    let body = model("<link name='l'><inertial><mass>1</mass></inertial></link>");
    for name in ["model.sdf", "other.sdf"] {
        for (uri, leads_to) in [
            ("model://base", "model.sdf"),
            ("model://base/", "model.sdf"),
            ("model://base/model.sdf", "model.sdf"),
            ("model://base/other.sdf", "other.sdf"),
            ("../base", "model.sdf"),
            ("../base/other.sdf", "other.sdf"),
            ("file://../base", "model.sdf"),
            ("model://gone", ""),
            ("https://example.org/base", ""),
            ("", ""),
        ] {
            let shell = Shell::new();
            shell.write(&format!("models/base/{name}"), &body);
            let include = format!("<include><uri>{uri}</uri></include>");
            shell.write("models/arm/model.sdf", model(&include));
            let passed = |arguments: &[&str]| shell.check(arguments).1.contains("not followed");
            // A folder has the file that stands for it, or none does.
            assert_eq!(passed(&["models"]), leads_to != name, "{uri} {name}");
            assert_eq!(passed(&[&format!("models/base/{name}"), "models/arm"]), leads_to != name);
            assert!(
                shell.json(&["models/arm/model.sdf"]).1["passed_over"][0]["reason"].is_string()
            );
        }
    }
}

impl Shell {
    fn pipe(&self, input: &[u8], arguments: &[&str]) -> (i32, String, String) {
        let mut child = Command::new(env!("CARGO_BIN_EXE_gyradius"))
            .current_dir(self.0.path())
            .arg("check")
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // It may stop reading before all is written.
        let _ = child.stdin.take().unwrap().write_all(input);
        let output = child.wait_with_output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
    }
}

#[test]
fn standard_input_is_read_in_every_format_and_limited() {
    let shell = Shell::new();
    let inertia = "inertia_kg_m2 = [[1, 0, 0], [0, 1, 0], [0, 0, 3]]";
    let json = "{\"name\": \"bad\", \"inertia_kg_m2\": [[1, 0, 0], [0, 1, 0], [0, 0, 3]]}";
    for text in [
        robot(&[bad()]),
        "<mujoco><body name='bad'><inertial mass='1' diaginertia='1 1 3'/></body></mujoco>".into(),
        "name,ixx,iyy,izz\nbad,1,1,3\n".into(),
        format!("[bad]\n{inertia}\n"),
        format!("[[bodies]]\nname = 'bad'\n{inertia}\n"),
        json.into(),
        format!("[{json}]"),
    ] {
        let (code, out, messages) = shell.pipe(text.as_bytes(), &["-"]);
        assert_eq!(code, 1, "{text}: {messages}");
        assert!(out.contains("50.0 %  bad") && out.contains("-:"), "{text}: {out}");
    }
    for (input, words) in [
        (&b""[..], "-: it is empty"),
        (b"words", "a table must have the columns"),
        (b"<robot/>", "no inertia of a body was found"),
        (b"{\"a\": ", "-:1: malformed"),
        (&vec![b' '; (64 << 20) + 1], "larger than 64 MiB"),
    ] {
        let (code, _, messages) = shell.pipe(input, &["-", "-"]);
        assert!(code == 2 && messages.contains(words), "{words}: {messages}");
    }
    let (code, _, messages) = shell.pipe(robot(&[bad()]).as_bytes(), &["-", "--repair"]);
    assert!(code == 2 && messages.contains("--repair writes beside a file"), "{messages}");
    assert_eq!(fs::read_dir(shell.path(".")).unwrap().count(), 0);
}

#[test]
fn a_repair_says_what_it_changes_and_by_how_much() {
    let shell = Shell::new();
    let strut = link("strut", "1", ["2", "2", "2"], ["1", "1", "1"]);
    shell.write("r.urdf", robot(&[bad(), good(), strut]));
    let (code, out, _) = shell.check(&["r.urdf", "--repair"]);
    assert_eq!(code, 1);
    // A third of what is missing for each moment: 1/√3 in all, of √11.
    assert!(out.contains("ixx 1 -> 1.333, iyy 1 -> 1.333, izz 3 -> 2.667 (moved by 0.5774 kg·m²"));
    assert!(out.contains("17.41 %)"), "{out}");
    let first = out.find("ixy 1 -> -1, ixz 1 -> -1, iyz 1 -> -1 (products flipped, moved by 4.899");
    let then = out.find("written, the nearest:");
    assert!(first.is_some() && first < then, "{out}");
    let (_, json) = shell.json(&["r.urdf", "--repair"]);
    let changes = json["repairs"][0]["changes"].as_array().unwrap();
    assert_eq!(changes.len(), 2);
    assert_eq!(changes[0]["name"], "bad");
    assert_eq!(changes[0]["before_kg_m2"][2][2], 3.0);
    assert!((changes[0]["after_kg_m2"][2][2].as_f64().unwrap() - 8.0 / 3.0).abs() < 1e-7);
    assert!(changes[0]["proposal"].is_null());
    assert_eq!(changes[1]["remedy"], "nearest");
    assert_eq!(changes[1]["proposal"]["remedy"], "flip");
    assert_eq!(changes[1]["proposal"]["after_kg_m2"][0], serde_json::json!([2.0, -1.0, -1.0]));
    // And so it is written where it is asked for, the others as before.
    assert_eq!(shell.check(&["r.urdf", "--repair=flip", "--force"]).0, 1);
    let copy = shell.read("r.repaired.urdf");
    assert!(copy.contains("izz=\"2\" ixy=\"-1.0\" ixz=\"-1.0\" iyz=\"-1.0\""), "{copy}");
    assert!(copy.contains("ixx=\"1.33333"), "{copy}");
    assert_eq!(shell.check(&["r.repaired.urdf", "--tolerance", "0"]).0, 0);
    // Nothing is no repair.
    shell.write("n.urdf", robot(&[link("less", "1", ["-1", "-1", "-1"], NONE)]));
    let (code, _, messages) = shell.check(&["n.urdf", "--repair"]);
    assert!(code == 2 && messages.contains("0, 0, 0, which is none"), "{messages}");
    assert!(!shell.path("n.repaired.urdf").exists());
}

/// What nobody else may read is not copied for all to read.
#[cfg(unix)]
#[test]
fn a_copy_may_be_read_by_whom_the_original_may() {
    use std::os::unix::fs::PermissionsExt;
    for mode in [0o600, 0o640, 0o644, 0o444, 0o400, 0o664, 0o755] {
        let shell = Shell::new();
        shell.write("r.urdf", robot(&[bad()]));
        fs::set_permissions(shell.path("r.urdf"), fs::Permissions::from_mode(mode)).unwrap();
        for arguments in [&["r.urdf", "--repair"][..], &["r.urdf", "--repair", "--force"]] {
            assert_eq!(shell.check(arguments).0, 1);
            let copied = fs::metadata(shell.path("r.repaired.urdf")).unwrap().permissions().mode();
            assert_eq!(copied & 0o777, mode, "{copied:o}");
        }
    }
}

#[test]
fn help_has_examples() {
    let shell = Shell::new();
    let (code, help, _) = shell.check(&["--help"]);
    assert_eq!(code, 0);
    for words in ["Examples:", "Exit code:", "--repair", "--tolerance", "--flip-products", "--all"]
    {
        assert!(help.contains(words), "{words}: {help}");
    }
}

#[cfg(unix)]
#[test]
fn pipes_and_loops_do_not_hang_it() {
    let shell = Shell::new();
    shell.write("a/r.urdf", robot(&[bad()]));
    std::os::unix::fs::symlink(shell.path("."), shell.path("a/loop")).unwrap();
    std::os::unix::fs::symlink("itself.urdf", shell.path("itself.urdf")).unwrap();
    let (code, out, messages) = shell.check(&["."]);
    assert_eq!(code, 1, "a link to itself cannot be read, which hides nothing");
    assert!(out.contains("1 file, 1 body: 1 impossible"), "{out}");
    assert_eq!(messages.lines().count(), 1, "{messages}");
    assert!(shell.check(&["/dev/zero"]).2.contains("not a regular file"));
    assert!(Path::new("/dev/zero").exists());
}

/// Who pipes into `head` gets no panic.
#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_error() {
    let shell = Shell::new();
    let rows: String = (0..20_000).map(|i| format!("body-{i},1,1,3\n")).collect();
    shell.write("r.csv", format!("name,ixx,iyy,izz\n{rows}"));
    let script = format!("{} check r.csv | head -n 1", env!("CARGO_BIN_EXE_gyradius"));
    let output =
        Command::new("sh").current_dir(shell.path(".")).args(["-c", &script]).output().unwrap();
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// What a table holds and is not judged is named: a column of weights was passed over, and its bodies were possible.
#[test]
fn columns_that_are_not_read_are_named() {
    let shell = Shell::new();
    shell.write("w.csv", "name,Weight (lb),ixx,iyy,izz,note\na,-1,1,1,1,\n");
    let (code, out, _) = shell.check(&["w.csv"]);
    let note =
        "note: w.csv:1: 2 columns are not read: Weight (lb), note; no column of masses is read";
    assert!(code == 0 && out.lines().any(|line| line == note), "{out}");
    shell.write("m.csv", "name,mass,ixx,iyy,izz\na,1,1,1,1\n");
    assert!(!shell.check(&["m.csv"]).1.contains("not read"));
}
