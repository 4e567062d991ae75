//! `gyradius check` as a user meets it: what it lists, what it writes, and how it ends.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
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
    assert_eq!(code, 2, "{messages}");
    assert!(messages.starts_with("error: broken.urdf:3: malformed"), "{messages}");
    assert!(
        out.contains("50.0 %") && out.contains("1 file unreadable"),
        "the others are done: {out}"
    );
    let (code, out, _) = shell.check(&["half.urdf"]);
    assert_eq!(code, 2);
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
    assert_eq!(code, 2);
    assert_eq!(json["schema"], 1);
    assert_eq!(json["tolerance"], 1e-6);
    let summary = serde_json::json!(
        {"files": 1, "bodies": 3, "impossible": 1, "no_mass": 0, "unread": 1, "errors": 1}
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
    assert!(out.contains("signs of its products flipped: see --flip-products"), "{out}");
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
    assert_eq!(code, 2, "a link to itself cannot be read");
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
