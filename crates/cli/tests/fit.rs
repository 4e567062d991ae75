//! `gyradius fit` and `gyradius model` as a user meets them: what they say, what they write, how they
//! end, and that a study runs with what they write.

use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};
use tempfile::TempDir;

const VARIANTS: &str = include_str!("tables/variants.csv");
const PAYLOAD: &str = include_str!("tables/payload.toml");

struct Shell(TempDir);

impl Shell {
    fn new() -> Self {
        let shell = Self(tempfile::tempdir().unwrap());
        shell.write("variants.csv", VARIANTS);
        shell.write("payload.toml", PAYLOAD);
        shell
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Exit code, standard output, standard error.
    fn run(&self, arguments: &[&str]) -> (i32, String, String) {
        let output = Command::new(env!("CARGO_BIN_EXE_gyradius"))
            .current_dir(self.0.path())
            .args(arguments)
            .output()
            .unwrap();
        let messages = String::from_utf8(output.stderr).unwrap();
        assert!(!messages.contains("panicked"), "{messages}");
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap(), messages)
    }

    /// What must be refused: exit code 2, nothing on standard output, a message.
    fn refused(&self, arguments: &[&str]) -> String {
        let (code, out, message) = self.run(arguments);
        assert_eq!((code, out.as_str()), (2, ""), "{message}");
        message
    }

    fn json(&self, arguments: &[&str]) -> (i32, Value) {
        let (code, out, messages) = self.run(&[arguments, &["--format", "json"]].concat());
        assert!(messages.is_empty(), "{messages}");
        (code, serde_json::from_str(&out).unwrap())
    }
}

/// The table without some of its columns, or with others.
fn rows(change: impl Fn(usize, &str) -> String) -> String {
    VARIANTS.lines().enumerate().map(|(i, line)| change(i, line) + "\n").collect()
}

/// The paper's scenario with the tables of one body replaced.
fn pasted(scenario: &str, body: &str, fragment: &str) -> String {
    let header = format!("[{body}]");
    let inner = format!("[{body}.");
    let mut keep = true;
    let mut text = String::new();
    let mut rest = String::new();
    for line in scenario.lines() {
        if line.starts_with('[') {
            keep = !(line == header || line.starts_with(&inner));
        }
        if keep {
            text.push_str(&(line.to_owned() + "\n"));
        } else if line.starts_with("position_m")
            || (line.starts_with("mass_kg") && !fragment.contains("\nmass_kg = "))
        {
            rest.push_str(&(line.to_owned() + "\n"));
        }
    }
    let fragment = fragment.replacen(&header, &format!("{header}\n{rest}"), 1);
    format!("{text}\n{fragment}")
}

#[test]
fn a_study_runs_with_what_fit_and_model_write() {
    let shell = Shell::new();
    let (code, _, messages) = shell.run(&["study", "--runs", "5", "--out", "base"]);
    assert_eq!(code, 0, "{messages}");
    let scenario = shell.read("base/scenario.toml");

    let (code, fitted, messages) = shell.run(&["fit", "variants.csv"]);
    assert_eq!((code, messages.as_str()), (0, ""));
    shell.write("fitted.toml", &pasted(&scenario, "payload", &fitted));
    let (code, table, messages) =
        shell.run(&["study", "--scenario", "fitted.toml", "--out", "fitted"]);
    assert_eq!(code, 0, "{messages}");
    assert!(table.contains("proposed"), "{table}");
    // The law of the samples, not that of the paper.
    assert!(shell.read("fitted/scenario.toml").contains("5001.72"));

    let (code, made, _) = shell.run(&["model", "payload.toml", "--body", "stage"]);
    assert_eq!(code, 0);
    shell.write("made.toml", &pasted(&scenario, "stage", &made));
    let (code, _, messages) = shell.run(&["study", "--scenario", "made.toml", "--out", "made"]);
    assert_eq!(code, 0, "{messages}");
}

/// The examples of the documentation are what the program prints.
#[test]
fn the_documentation_shows_what_is_printed() {
    let shell = Shell::new();
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    for (arguments, page) in
        [(["fit", "variants.csv"], "fit.md"), (["model", "payload.toml"], "statements.md")]
    {
        let (_, out, _) = shell.run(&arguments);
        let text = fs::read_to_string(docs.join(page)).unwrap();
        let report: String =
            out.lines().take_while(|l| l.starts_with('#')).collect::<Vec<_>>().join("\n");
        assert!(report.len() > 500 && text.contains(&report), "{page} should show\n{report}");
    }
}

#[test]
fn files_are_written_once_and_never_over() {
    let shell = Shell::new();
    let to_file = ["fit", "variants.csv", "-o", "out.toml"];
    let (code, report, _) = shell.run(&to_file);
    assert_eq!(code, 0);
    assert!(
        report.contains("verdict: nothing speaks against") && report.contains("wrote out.toml")
    );
    let written = shell.read("out.toml");
    assert_eq!(written, shell.run(&["fit", "variants.csv"]).1);
    // The same again changes nothing, another is refused.
    assert!(shell.run(&to_file).1.contains("unchanged: out.toml"));
    shell.write("out.toml", "mine");
    assert!(shell.refused(&to_file).contains("out.toml exists: --force replaces it"));
    assert_eq!(shell.read("out.toml"), "mine");
    assert_eq!(shell.run(&[&to_file[..], &["--force"]].concat()).0, 0);
    assert_eq!(shell.read("out.toml"), written);
    // Not even with --force over what was read.
    for input in ["variants.csv", "./variants.csv"] {
        let message = shell.refused(&["fit", "variants.csv", "-o", input, "--force"]);
        assert!(message.contains("is not written over"), "{message}");
    }
    let message = shell.refused(&["model", "payload.toml", "-o", "payload.toml", "--force"]);
    assert!(message.contains("is not written over"), "{message}");
    assert_eq!(
        (shell.read("variants.csv").as_str(), shell.read("payload.toml").as_str()),
        (VARIANTS, PAYLOAD)
    );
    assert!(shell.refused(&["fit", "variants.csv", "--force"]).contains("--output"));
    assert!(
        shell.refused(&["fit", "variants.csv", "-o", "no/where.toml"]).contains("no/where.toml")
    );
}

/// Links that are written with expressions were left out without a word.
#[test]
fn what_was_not_read_is_told() {
    let link = |i: usize, xx: &str| {
        format!(
            "<link name=\"l{i}\"><inertial><mass value=\"1\"/><inertia ixx=\"{xx}\" iyy=\"{}\" izz=\"{}\" \
             ixy=\"0.01\" ixz=\"0.02\" iyz=\"{}\"/></inertial></link>\n",
            2.0 + 0.03 * (i % 5) as f64,
            2.5 - 0.02 * (i % 7) as f64,
            0.001 * (i % 3) as f64
        )
    };
    let shell = Shell::new();
    for unread in [0, 5] {
        let all = (0..20).map(|i| {
            let xx =
                if i < unread { "${xx}".to_owned() } else { (1.0 + 0.01 * i as f64).to_string() };
            link(i, &xx)
        });
        shell.write(
            "it.urdf",
            &format!(
                "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">{}</robot>",
                all.collect::<String>()
            ),
        );
        let (code, report, said) = shell.run(&["fit", "it.urdf"]);
        assert!(code != 2, "{report}{said}");
        let (_, json) = shell.json(&["fit", "it.urdf"]);
        assert_eq!(json["samples"], 20 - unread);
        let told = json["unread"].as_array().unwrap();
        assert_eq!(told.len(), usize::from(unread > 0), "{told:?}");
        assert_eq!(report.contains("xacro"), unread > 0, "{report}");
    }
}

#[test]
fn json_has_what_the_report_has() {
    let shell = Shell::new();
    let (code, fit) = shell.json(&["fit", "variants.csv"]);
    assert_eq!(code, 0);
    assert_eq!((fit["schema"].as_u64(), fit["samples"].as_u64()), (Some(1), Some(150)));
    assert_eq!(fit["axes"]["finding"], "determined");
    assert_eq!(fit["fits"], true);
    // What the table was drawn from, within four standard errors.
    for (root, (mean, deviation)) in
        fit["roots"].as_array().unwrap().iter().zip([(31.62, 0.35), (44.72, 0.32), (54.77, 0.27)])
    {
        let get = |key: &str| root[key].as_f64().unwrap();
        let off = (get("mean_sqrt_kg_m") - mean).abs();
        assert!(off < 4.0 * get("mean_error_sqrt_kg_m"), "{root}");
        let off = (get("deviation_sqrt_kg_m") - deviation).abs();
        assert!(off < 4.0 * get("deviation_error_sqrt_kg_m"), "{root}");
    }
    let (code, model) = shell.json(&["model", "payload.toml"]);
    assert_eq!(code, 0);
    let implied = model["implied_deviation_kg_m2"][0].as_f64().unwrap();
    assert!((implied / 500.0 - 1.0).abs() < 0.01, "{implied}");
    assert!(model["fragment"]["toml"].as_str().unwrap().starts_with("[payload]"));
}

/// Spellings, signs and units are those of `gyradius check`.
#[test]
fn tables_may_be_spelled_in_any_known_way() {
    let shell = Shell::new();
    let (_, expected) = shell.json(&["fit", "variants.csv"]);
    let same = |shell: &Shell, arguments: &[&str]| {
        let (_, found) = shell.json(arguments);
        for k in 0..3 {
            let mean = |v: &Value| v["roots"][k]["mean_sqrt_kg_m"].as_f64().unwrap();
            assert!((mean(&found) / mean(&expected) - 1.0).abs() < 1e-9, "{arguments:?}");
        }
        let product = |v: &Value| v["nominal_inertia_kg_m2"][1][2].as_f64().unwrap();
        assert!((product(&found) / product(&expected) - 1.0).abs() < 1e-6, "{arguments:?}");
    };
    shell.write(
        "paper.csv",
        &rows(|i, line| match i {
            0 => "name;i11;i22;i33;i12;i13;i23".to_owned(),
            _ => line.replace(',', ";"),
        }),
    );
    same(&shell, &["fit", "paper.csv"]);
    let flipped = |line: &str| -> String {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        for field in &mut fields[4..] {
            *field = (-field.parse::<f64>().unwrap()).to_string();
        }
        fields.join(",")
    };
    shell.write("cad.csv", &rows(|i, line| if i == 0 { line.to_owned() } else { flipped(line) }));
    same(&shell, &["fit", "cad.csv", "--flip-products"]);
    shell.write(
        "units.csv",
        &rows(|i, line| match i {
            0 => {
                "name,Ixx [g mm^2],Iyy [g mm^2],Izz [g mm^2],Ixy [g mm^2],Ixz [g mm^2],Iyz [g mm^2]"
                    .to_owned()
            }
            _ => {
                let fields = line.split(',').enumerate().map(|(c, field)| match c {
                    0 => field.to_owned(),
                    _ => format!("{field}e9"),
                });
                fields.collect::<Vec<_>>().join(",")
            }
        }),
    );
    same(&shell, &["fit", "units.csv"]);
    let bodies: Vec<String> = VARIANTS
        .lines()
        .skip(1)
        .map(|line| {
            let f: Vec<&str> = line.split(',').skip(1).collect();
            let [a, b, c, d, e, g] = f[..] else { unreachable!() };
            format!("{{\"inertia_kg_m2\": [[{a}, {d}, {e}], [{d}, {b}, {g}], [{e}, {g}, {c}]]}}")
        })
        .collect();
    shell.write("samples.json", &format!("{{\"bodies\": [{}]}}", bodies.join(",\n")));
    same(&shell, &["fit", "samples.json"]);
}

#[test]
fn bad_tables_are_refused_with_their_row() {
    let shell = Shell::new();
    let bad = |at: usize, row: &str| {
        let row = row.to_owned();
        rows(move |i, line| if i == at { row.clone() } else { line.to_owned() })
    };
    shell.write("bad.csv", &bad(7, "v007,5000,4000,12000,0,0,0"));
    let message = shell.refused(&["fit", "bad.csv"]);
    assert!(message.contains("bad.csv:8: no body has this inertia"), "{message}");
    assert!(message.contains("sample 7") && message.contains("--skip-impossible"), "{message}");
    let (code, report, _) = shell.run(&["fit", "bad.csv", "--skip-impossible"]);
    assert_eq!(code, 0);
    assert!(report.contains("149 samples of bad.csv; 1 set aside, which no body has"), "{report}");

    shell.write("word.csv", &bad(3, "v003,5000,4000,x,0,0,0"));
    let message = shell.refused(&["fit", "word.csv", "--skip-impossible"]);
    assert!(message.contains("word.csv:4: izz = \"x\" is not a number"), "{message}");
    shell.write("nan.csv", &bad(3, "v003,5000,4000,nan,0,0,0"));
    assert!(shell.refused(&["fit", "nan.csv"]).contains("nan.csv:4:"));
    shell.write("unit.csv", &VARIANTS.replace("ixx", "ixx [furlong]"));
    assert!(shell.refused(&["fit", "unit.csv"]).contains("furlong"));
    shell.write("few.csv", &VARIANTS.lines().take(6).collect::<Vec<_>>().join("\n"));
    assert!(
        shell
            .refused(&["fit", "few.csv"])
            .contains("number of samples is 5: a fit needs at least 13")
    );
    shell.write("empty.csv", "");
    shell.refused(&["fit", "empty.csv"]);
    shell.write("header.csv", "ixx,iyy,izz\n");
    assert!(shell.refused(&["fit", "header.csv"]).contains("number of samples is 0"));
    assert!(shell.refused(&["fit", "nowhere.csv"]).contains("nowhere.csv"));
    assert!(shell.refused(&["fit", "."]).contains("not a regular file"));
    shell.write("zero.csv", &bad(5, "v005,0,0,0,0,0,0"));
    let message = shell.refused(&["fit", "zero.csv"]);
    assert!(message.contains("zero.csv:6: sample 5 is a point"), "{message}");
    for power in ["10", "300"] {
        let name = format!("large{power}.csv");
        let row = ["5e3", "4e3", "3e3"].map(|moment| {
            let (digit, own) = moment.split_once('e').unwrap_or_default();
            format!("{digit}e{}", own.parse::<i32>().unwrap() + power.parse::<i32>().unwrap())
        });
        shell.write(&name, &bad(9, &format!("v009,{},0,0,0", row.join(","))));
        let message = shell.refused(&["fit", &name]);
        let place = format!("{name}:10: sample 9: the sum of its moments");
        assert!(message.contains(&place) && message.contains("another unit"), "{message}");
    }
    shell.write("returns.csv", &VARIANTS.replace('\n', "\r"));
    let message = shell.refused(&["fit", "returns.csv"]);
    assert!(message.contains("returns.csv:1: its lines end in carriage returns"), "{message}");
    shell.write(
        "huge.csv",
        &rows(
            |i, line| if i == 0 { line.to_owned() } else { "x,1e160,1e160,1e160,0,0,0".to_owned() },
        ),
    );
    shell.refused(&["fit", "huge.csv"]);
}

/// A table of two kinds of bodies: written all the same, and said by the exit code.
#[test]
fn a_model_that_does_not_fit_is_said() {
    let shell = Shell::new();
    let mixed = rows(|i, line| {
        if i == 0 || i % 3 > 0 {
            return line.to_owned();
        }
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        fields[1] = (fields[1].parse::<f64>().unwrap() + 400.0).to_string();
        fields.join(",")
    });
    shell.write("mixed.csv", &mixed);
    let (code, out, messages) = shell.run(&["fit", "mixed.csv"]);
    assert_eq!((code, messages.as_str()), (1, ""), "{out}");
    assert!(out.contains("verdict: the model does not fit:"), "{out}");
    assert!(out.contains("[payload.dispersion]"), "{out}");
}

/// CAD variants without products; and all the same body.
#[test]
fn tables_without_scatter_of_some_kind_are_fitted() {
    let shell = Shell::new();
    let no_products = rows(|i, line| {
        let fields: Vec<&str> = line.split(',').collect();
        if i == 0 { line.to_owned() } else { format!("{},0,0,0", fields[..4].join(",")) }
    });
    shell.write("still.csv", &no_products);
    let (code, out, _) = shell.run(&["fit", "still.csv"]);
    assert!(code == 0 && out.contains("the principal axes do not scatter"), "{out}");
    let same = rows(|i, line| if i == 0 { line.to_owned() } else { "x,5,4,3,0.1,0,0".to_owned() });
    shell.write("same.csv", &same);
    let (code, out, _) = shell.run(&["fit", "same.csv"]);
    assert!(code == 0 && out.contains("nothing scatters"), "{out}");
    // A column of names could command the terminal; none of it is printed. A file name is.
    shell.write("still\u{1b}[2J.csv", &no_products);
    let (_, out, _) = shell.run(&["fit", "still\u{1b}[2J.csv"]);
    assert!(!out.contains('\u{1b}'));
}

#[test]
fn bad_statements_are_refused_by_name() {
    let shell = Shell::new();
    let refused = |from: &str, to: &str| {
        assert!(PAYLOAD.contains(from), "{from}");
        shell.write("changed.toml", &PAYLOAD.replacen(from, to, 1));
        shell.refused(&["model", "changed.toml"])
    };
    for (from, to, expected) in [
        ("percent = 10.0", "percent = -10.0", "changed.toml: moments.percent = -10.0: "),
        ("percent = 10.0", "percent = nan", "moments.percent = NaN: "),
        ("percent = 10.0", "percent = 10.0\nkg_m2 = 3.0", "exactly one of percent, kg_m2"),
        ("sigmas = 1", "sigma = 1", "unknown field"),
        ("sigmas = 3", "sigmas = 0", "products.sigmas = 0.0: "),
        ("deg = 2.0", "deg = 200.0", "axes.deg = 200.0: "),
        (
            "deg = 2.0",
            "deg = \"two\"",
            "axes.deg: invalid type: string \"two\", expected one number, or a list of three",
        ),
        ("mass_kg = 10000.0", "mass_kg = -1.0", "nominal.mass_kg = -1.0: "),
        ("mass_kg = 10000.0", "", "nominal.mass_kg is missing"),
        ("[[5000.0", "[[9000.0", "nominal.inertia_kg_m2: no body has this inertia"),
        ("[nominal]", "[nomina]", "unknown field `nomina`"),
    ] {
        let message = refused(from, to);
        assert!(message.contains(expected), "{message}");
        assert!(message.contains("changed.toml"), "{message}");
    }
    shell.write("empty.toml", "");
    assert!(shell.refused(&["model", "empty.toml"]).contains("nominal"));
    assert!(shell.refused(&["model", "nowhere.toml"]).contains("cannot read nowhere.toml"));
    assert!(shell.refused(&["model", "."]).contains("not a regular file"));
    shell.write("binary.toml", "\u{0}\u{1}");
    shell.refused(&["model", "binary.toml"]);
}

/// A row that sums up others, in a column of names or in one that is not read, is no sample.
#[test]
fn totals_and_averages_are_no_samples() {
    for (heading, word) in [("name", "Total"), ("id", "AVERAGE"), ("run", "std dev")] {
        let mut text = format!("{heading},ixx,iyy,izz\n");
        for i in 0..40 {
            text += &format!(
                "{i},{},{},{}\n",
                10.0 + f64::from(i % 7),
                12.0 + f64::from(i % 5),
                14.0 + f64::from(i % 3)
            );
        }
        let shell = Shell::new();
        shell.write("plain.csv", &text);
        shell.write("with.csv", &format!("{text}{word},13,14,15\n"));
        let (code, _, _) = shell.run(&["fit", "plain.csv"]);
        assert!(code < 2, "{heading}");
        let said = shell.refused(&["fit", "with.csv"]);
        assert!(said.contains("with.csv:42") && said.contains(word), "{said}");
    }
}

/// A table whose names say that its rows are samples of several bodies is no sample of one, whatever the order of the rows; names that stand
/// once each, and one name, are of samples.
#[test]
fn rows_of_several_bodies_are_no_sample_of_one() {
    let shell = Shell::new();
    let rows = 60;
    let table = |heading: &str, name: &dyn Fn(usize) -> String| {
        let row = |i: usize| {
            let x = ((i * 37) % 61) as f64 / 61.0;
            format!("{},{},{},{}\n", name(i), 4.0 + x, 5.0 + x * x, 6.0 - x * 0.5)
        };
        format!("{heading},ixx,iyy,izz\n{}", (0..rows).map(row).collect::<String>())
    };
    for heading in ["link", "Name", "body", "part"] {
        for several in [2, 3, 13] {
            for blocks in [false, true] {
                let name = |i: usize| {
                    format!("arm {}", if blocks { i * several / rows } else { i % several })
                };
                shell.write("links.csv", &table(heading, &name));
                let refused = shell.refused(&["fit", "links.csv"]);
                assert!(refused.contains(&format!("the rows name {several} bodies")), "{refused}");
                assert!(refused.contains("\"arm 0\" in "), "{refused}");
            }
        }
        for name in [
            &(|i: usize| format!("SN {i}")) as &dyn Fn(usize) -> String,
            &|_| "arm".to_owned(),
            &|i| format!("SN {}", i.max(1)),
        ] {
            shell.write("samples.csv", &table(heading, name));
            let (_, _, message) = shell.run(&["fit", "samples.csv"]);
            assert!(!message.contains("the rows name"), "{message}");
        }
    }
}
