//! `gyradius draw` of files with laws alone, as `gyradius model` and `gyradius fit` write them.

use std::{collections::BTreeMap, fs};

use crate::scratch::Scratch;

/// A scenario of separations around a payload whose tables are those of a file of laws.
const AROUND: &str = "
name = \"around\"
runs = 40
seed = 9
[stage]
mass_kg = 2000.0
inertia_kg_m2 = [[3000.0, 0.0, 0.0], [0.0, 3000.0, 0.0], [0.0, 0.0, 900.0]]
position_m = [0.0, 0.0, -1.0]
dispersion = { root_second_moment_variance_kg_m2 = [0.0, 0.0, 0.0], axes = \"fixed\" }
[[springs]]
stiffness_n_per_m = 2e4
stroke_m = 0.1
payload_point_m = [0.0, 0.1, -0.9]
stage_point_m = [0.0, 0.1, 0.9]
[[models]]
name = \"principal\"
law = \"principal\"
axes = \"whole-sphere\"
";

/// A campaign of a simulator with the body of a file of laws.
const CAMPAIGN: &str = "name = \"campaign\"\nruns = 40\nseed = 9\n[simulation]\ncommand = [\"cat\"]\n\
                        [[simulation.outputs]]\nname = \"y\"\n";

const NOMINALS: [&str; 3] = [
    "inertia_kg_m2 = [[110.0, 2.0, 1.0], [2.0, 80.0, -3.0], [1.0, -3.0, 90.0]]",
    "mass_kg = 500.0\ninertia_kg_m2 = [[110.0, 2.0, 1.0], [2.0, 80.0, -3.0], [1.0, -3.0, 90.0]]",
    "mass_kg = 500.0\nmass_centre_m = [0.1, 0.0, 0.2]\nradii_of_gyration_m = [0.5, 0.4, 0.45]",
];
/// What may be stated, and whether it needs a nominal mass.
const STATEMENTS: [(&str, bool); 7] = [
    ("[moments]\npercent = 10\nsigmas = 3", false),
    ("[axes]\ndeg = 2\nsigmas = 1", false),
    ("[products]\nkg_m2 = 3.0\nsigmas = 2", false),
    ("[mass]\npercent = 5\nsigmas = 3", true),
    ("[mass]\npercent = 40\nsigmas = 1", true),
    ("[centre]\nmm = [20, 10, 5]\nsigmas = 3", true),
    ("[inside]\nellipsoid = { middle_m = [0.1, 0.0, 0.2], semi_axes_m = [1.6, 1.6, 1.6] }", true),
];

/// A table as texts, by its columns.
fn columns(csv: &str) -> BTreeMap<String, Vec<String>> {
    let mut lines = csv.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut all: BTreeMap<String, Vec<String>> =
        names.iter().map(|name| ((*name).to_owned(), Vec::new())).collect();
    for line in lines {
        for (name, cell) in names.iter().zip(line.split(',')) {
            all.get_mut(*name).unwrap().push(cell.to_owned());
        }
    }
    all
}

/// The table of the body in a file of laws.
fn body(laws: &str) -> (String, toml::Table) {
    let table: toml::Table = laws.parse().unwrap();
    let (name, body) = table.into_iter().next().unwrap();
    (name, body.as_table().unwrap().clone())
}

/// A body as one of a simulator: with a mass centre, which is told from the nominal one, and a mass.
fn campaign(laws: &str) -> String {
    let (name, mut body) = body(laws);
    body.entry("mass_kg").or_insert(1.0.into());
    let dispersion = body.get("dispersion").and_then(toml::Value::as_table);
    if dispersion.is_some_and(|dispersion| dispersion.contains_key("mass_centre_m")) {
        body.entry("mass_centre_m").or_insert(vec![0.0; 3].into());
    }
    body.insert("name".to_owned(), name.into());
    let bodies =
        toml::Table::from_iter([("bodies".to_owned(), vec![toml::Value::from(body)].into())]);
    CAMPAIGN.to_owned() + &bodies.to_string()
}

/// A body as the payload of a separation.
fn separation(laws: &str) -> String {
    let (_, mut body) = body(laws);
    body.entry("mass_kg").or_insert(1.0.into());
    body.insert("position_m".to_owned(), vec![0.0, 0.0, 1.0].into());
    let payload = toml::Table::from_iter([("payload".to_owned(), body.into())]);
    AROUND.to_owned() + &payload.to_string()
}

/// TOML has no word for what is not there.
fn without_nulls(value: &serde_json::Value) -> serde_json::Value {
    match (value.as_object(), value.as_array()) {
        (Some(object), _) => {
            let there = object.iter().filter(|(_, value)| !value.is_null());
            there.map(|(key, value)| (key.clone(), without_nulls(value))).collect()
        }
        (_, Some(list)) => list.iter().map(without_nulls).collect(),
        (None, None) => value.clone(),
    }
}

impl Scratch {
    /// What a file draws from a seed, as CSV.
    #[track_caller]
    fn drawn(&self, file: &str, more: &[&str]) -> String {
        self.done(&[&["draw", file, "-n", "40", "--seed", "9"], more].concat(), 0)
    }

    /// That a file of laws draws what scenarios with its bodies do, which have all columns of that body.
    #[track_caller]
    fn draws_as_scenarios(&self, file: &str) {
        let laws = fs::read_to_string(self.path(file)).unwrap();
        let (name, of_file) = body(&laws);
        let drawn = columns(&self.drawn(file, &[]));
        assert_eq!(drawn["run"].len(), 40);
        fs::write(self.path("campaign.toml"), campaign(&laws)).unwrap();
        let mut expected = columns(&self.drawn("campaign.toml", &[]));
        if !of_file.contains_key("mass_kg") {
            expected.remove(&format!("{name}_mass_kg"));
        }
        assert_eq!(drawn, expected, "{laws}");
        if name != "payload" {
            return;
        }
        fs::write(self.path("separation.toml"), separation(&laws)).unwrap();
        let found = columns(&self.drawn("separation.toml", &[]));
        let of_body = |column: &&String| column.starts_with("payload_");
        assert!(found.keys().filter(of_body).count() >= 10);
        for column in found.keys().filter(of_body) {
            assert_eq!(drawn[column], found[column], "{column}: {laws}");
        }
    }
}

/// Whatever `model` makes of statements: what it writes can be drawn as it is, and is drawn as in a scenario, its fragment and its JSON too.
#[test]
fn laws_of_statements_are_drawn_as_in_scenarios() {
    let shell = Scratch::new();
    let (mut seen, mut mass_seen) = (0, 0);
    for bits in 0_usize..1 << STATEMENTS.len() {
        let given: Vec<(&str, bool)> =
            (0..STATEMENTS.len()).filter(|i| bits >> i & 1 == 1).map(|i| STATEMENTS[i]).collect();
        // A file states something, and one mass; not all of the others.
        if bits & 63 == 0 || bits >> 3 & 3 == 3 || bits % 3 != 1 {
            continue;
        }
        let nominal = NOMINALS[bits % NOMINALS.len().max(1)];
        let nominal =
            if given.iter().any(|(_, mass)| *mass) { NOMINALS[1 + bits / 3 % 2] } else { nominal };
        let stated: Vec<&str> = given.iter().map(|(text, _)| *text).collect();
        let text = format!("[nominal]\n{nominal}\n{}\n", stated.join("\n"));
        fs::write(shell.path("body.toml"), &text).unwrap();
        let side = ["payload", "stage"][bits / 5 % 2];
        shell.done(&["model", "body.toml", "--body", side, "-o", "law.toml", "--force"], 0);
        shell.draws_as_scenarios("law.toml");
        seen += 1;
        let law = fs::read_to_string(shell.path("law.toml")).unwrap();
        let json = shell.done(&["model", "body.toml", "--format", "json", "--body", side], 0);
        fs::write(shell.path("law.json"), &json).unwrap();
        let document: serde_json::Value = serde_json::from_str(&json).unwrap();
        if document["law"].is_null() {
            assert_eq!(shell.drawn("law.json", &[]), shell.drawn("law.toml", &[]), "{law}");
            continue;
        }
        // The joint law, about the mass centre itself.
        let whole = &document["law"]["mass_properties_law"];
        let table = toml::Value::try_from(without_nulls(whole)).unwrap();
        let nominal = &document["fragment"];
        let mut of_body = toml::Table::from_iter([("law".to_owned(), table)]);
        let mean = |law: &serde_json::Value| law["mean"].as_f64();
        let mass = mean(&whole["mass_kg"]);
        let centre = [0, 1, 2].map(|i| mean(&whole["mass_centre_m"][i]));
        if let (Some(mass), [Some(x), Some(y), Some(z)]) = (mass, centre) {
            let inertia = toml::Value::try_from(&nominal["inertia_kg_m2"]).unwrap();
            of_body.insert("mass_kg".to_owned(), mass.into());
            of_body.insert("mass_centre_m".to_owned(), vec![x, y, z].into());
            of_body.insert("inertia_kg_m2".to_owned(), inertia);
            let named = toml::Table::from_iter([(side.to_owned(), of_body.into())]).to_string();
            fs::write(shell.path("campaign.toml"), campaign(&named)).unwrap();
            let found = columns(&shell.drawn("campaign.toml", &[]));
            assert_eq!(columns(&shell.drawn("law.json", &[])), found, "{named}");
            mass_seen += 1;
        }
        // And the law alone, which is of a payload.
        fs::write(shell.path("alone.json"), whole.to_string()).unwrap();
        let alone = shell.drawn("alone.json", &[]);
        assert!(
            alone.starts_with("model,run,status,payload_mass_kg,payload_mass_centre_1_m"),
            "{alone}"
        );
        if side == "payload" {
            assert_eq!(alone, shell.drawn("law.json", &[]));
        }
    }
    assert!(seen > 15 && mass_seen > 5, "{seen} {mass_seen}");
}

/// What `fit` writes of a table with mass and without, of any body, and from any seed and run on in any form.
#[test]
fn fitted_laws_are_drawn_as_in_scenarios() {
    let shell = Scratch::new();
    let statements = "[nominal]\nmass_kg = 500.0\nmass_centre_m = [0.1, 0.0, 0.2]\n\
        inertia_kg_m2 = [[110.0, 2.0, 1.0], [2.0, 80.0, -3.0], [1.0, -3.0, 90.0]]\n\
        [moments]\npercent = 4\nsigmas = 1\n[axes]\ndeg = 2\nsigmas = 1\n[mass]\npercent = 3\nsigmas = 1\n\
        [centre]\nmm = 5\nsigmas = 1\n";
    fs::write(shell.path("body.toml"), statements).unwrap();
    shell.done(&["model", "body.toml", "-o", "law.toml"], 0);
    let samples = shell.done(&["draw", "law.toml", "-n", "300"], 0);
    // The columns of a body alone, as tables of samples have them.
    let bare: Vec<String> = samples
        .lines()
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            cells[3..13].join(",").replace("payload_", "")
        })
        .collect();
    fs::write(shell.path("samples.csv"), bare.join("\n") + "\n").unwrap();
    for (side, file) in [("payload", "fitted.toml"), ("stage", "other.toml")] {
        let output = shell.run(&["fit", "samples.csv", "--body", side, "-o", file]);
        assert!(output.status.code().is_some_and(|code| code < 2), "{output:?}");
        shell.draws_as_scenarios(file);
        let json = shell.run(&["fit", "samples.csv", "--body", side, "--format", "json"]).stdout;
        let document: serde_json::Value = serde_json::from_slice(&json).unwrap();
        fs::write(shell.path("joint.json"), &json).unwrap();
        let joint = columns(&shell.drawn("joint.json", &[]));
        assert!(
            !document["joint"]["law"].is_null()
                && joint.contains_key(&format!("{side}_mass_centre_3_m"))
        );
        fs::write(shell.path("alone.json"), document["joint"]["law"].to_string()).unwrap();
        let alone = columns(&shell.drawn("alone.json", &[]));
        assert_eq!(alone["payload_i11"].len(), joint[&format!("{side}_i11")].len());
    }
    // Another name, and two bodies in one file, each as alone.
    let law = fs::read_to_string(shell.path("law.toml")).unwrap();
    let fitted = fs::read_to_string(shell.path("other.toml")).unwrap();
    fs::write(shell.path("bus.toml"), law.replace("[payload", "[bus")).unwrap();
    shell.draws_as_scenarios("bus.toml");
    fs::write(shell.path("two.toml"), format!("{}\n{fitted}", law.replace("[payload", "[bus")))
        .unwrap();
    let two = columns(&shell.drawn("two.toml", &[]));
    for file in ["bus.toml", "other.toml"] {
        for (name, cells) in columns(&shell.drawn(file, &[])) {
            assert_eq!(two[&name], cells, "{name}");
        }
    }
    // Some runs are those of more, in any form, and a seed changes them.
    let all = shell.drawn("bus.toml", &[]);
    let later = shell.done(&["draw", "bus.toml", "-n", "7", "--first", "33", "--seed", "9"], 0);
    assert!(all.ends_with(later.split_once('\n').unwrap().1));
    let other = shell.done(&["draw", "bus.toml", "-n", "40", "--seed", "10"], 0);
    assert_ne!(other, all);
    for form in ["jsonl", "parquet", "npy"] {
        let file = format!("drawn.{form}");
        shell.done(&["draw", "bus.toml", "-n", "40", "--seed", "9", "-o", &file], 0);
        assert!(fs::metadata(shell.path(&file)).unwrap().len() > 1000);
    }
}

/// What cannot be drawn names the key, and what to do.
#[test]
fn refusals_say_what_to_do() {
    let shell = Scratch::new();
    let inertia = "inertia_kg_m2 = [[110.0, 0.0, 0.0], [0.0, 80.0, 0.0], [0.0, 0.0, 90.0]]";
    let roots = "root_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]\naxes = \"fixed\"";
    for (text, expected) in [
        (
            format!("[nominal]\n{inertia}\n[centre]\nmm = 2\n"),
            "body.toml: nominal: the file states what is known of a body, and no law has been made of it: `gyradius model body.toml -o law.toml`",
        ),
        (
            format!("[bus]\n{inertia}\n[bus.dispersion]\nmass_percent = 2\n{roots}\n"),
            "body.toml: bus.mass_kg: missing: bus.dispersion.mass_percent needs it",
        ),
        (
            format!("[bus]\n[bus.dispersion]\n{roots}\n"),
            "body.toml: bus.inertia_kg_m2: missing: a law of the inertia needs it",
        ),
        (
            format!("[bus]\n{inertia}\n[bus.dispersion]\n{roots}\nmass_center_m = 0.1\n"),
            "bus.dispersion.mass_center_m: unknown field `mass_center_m`: did you mean `mass_centre_m`?",
        ),
        (
            format!("[bus]\n{inertia}\n[bus.dispersion]\naxes = \"fixed\"\n"),
            "bus.dispersion.root_second_moment_variance_kg_m2: missing",
        ),
        (format!("[bus]\nmass_kg = -1\n{inertia}\n[bus.dispersion]\n{roots}\n"), "bus.mass_kg: "),
        (
            format!("[\"my bus\"]\n{inertia}\n[\"my bus\".dispersion]\n{roots}\n"),
            "my bus.name: \"my bus\": it must be",
        ),
        ("{ \"a\": 1 }".to_owned(), "it holds no law"),
    ] {
        fs::write(shell.path("body.toml"), &text).unwrap();
        let output = shell.run(&["draw", "body.toml", "-n", "3"]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && output.stdout.is_empty(), "{message}");
        assert!(message.contains(expected), "{message}\n{text}");
    }
    // A law of a change that is one of the value itself is told in the words of the file.
    let slip = format!(
        "[bus]\nmass_kg = 500.0\n{inertia}\n[bus.dispersion]\nmass_kg = {{ law = \"uniform\", low = 475, high = 525 }}\n{roots}\n"
    );
    fs::write(shell.path("slip.toml"), slip).unwrap();
    let output = shell.run(&["draw", "slip.toml", "-n", "3"]);
    let message = String::from_utf8(output.stderr).unwrap();
    let expected = "warning: the nominal value of bus_mass_kg is 500, and its law, which is of the change from that, has a mean of 500, so that \
                    what is drawn has a mean of 1000. If the value itself is meant, write bus.dispersion.mass_kg = { law = \"uniform\", \
                    low = -25.0, high = 25.0 }\n";
    assert!(output.status.success() && message == expected, "{message}");
    let refused = shell.run(&["draw", "slip.toml", "-n", "3", "--model", "x"]);
    assert_eq!(refused.status.code(), Some(2));
}

/// Verbs that draw tell of a law of a change that is one of the value itself, unless they are to be quiet.
#[test]
fn studies_tell_what_there_is_to_doubt() {
    let shell = Scratch::new();
    let payload = "[payload]\nmass_kg = 500.0\ninertia_kg_m2 = [[110.0, 0.0, 0.0], [0.0, 80.0, 0.0], [0.0, 0.0, 90.0]]\n\
                   [payload.dispersion]\nmass_percent = LAW\nroot_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]\naxes = \"fixed\"\n";
    for (law, told) in [
        ("5.0", None),
        ("{ law = \"uniform\", low = 95, high = 105 }", Some("low = -5.0, high = 5.0")),
    ] {
        fs::write(shell.path("s.toml"), separation(&payload.replace("LAW", law))).unwrap();
        for arguments in [
            &["study", "--scenario", "s.toml", "--runs", "20", "--out", "a", "--force"][..],
            &["study", "--scenario", "s.toml", "--runs", "20", "--out", "b", "--force", "--quiet"],
            &["draw", "s.toml", "-n", "2"],
            &["rare", "payload_mass_kg >= 400", "--scenario", "s.toml", "--per-level", "100"],
        ] {
            let output = shell.run(arguments);
            let message = String::from_utf8(output.stderr).unwrap();
            let expected = told.filter(|_| !arguments.contains(&"--quiet"));
            let found = message.lines().filter(|line| line.starts_with("warning: "));
            let found: Vec<&str> = found.filter(|line| line.contains("payload_mass_kg")).collect();
            assert_eq!(found.len(), usize::from(expected.is_some()), "{arguments:?}: {message}");
            assert!(
                found.iter().all(|line| expected.is_some_and(|told| line.contains(told))),
                "{message}"
            );
        }
    }
}

/// A mass that nobody said is no part of a body's size, in which distances of mass centres are told: whatever else is 1 kg, and in JSON with a byte
/// order mark and without.
#[test]
fn a_mass_that_nobody_said_makes_no_size() {
    let shell = Scratch::new();
    for mass in ["", "mass_kg = 1.0", "mass_kg = 500.0"] {
        for mean in [0.02, 0.3, 3.0] {
            let body = format!(
                "[payload]\n{mass}\ninertia_kg_m2 = [[110.0, 0.0, 0.0], [0.0, 80.0, 0.0], [0.0, 0.0, 90.0]]\n[payload.dispersion]\n\
                 mass_centre_m = [{{ mean = {mean:?}, sigma = 0.001 }}, 0.001, 0.001]\n\
                 root_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]\naxes = \"fixed\"\n"
            );
            let size_m = match mass {
                "" => None,
                "mass_kg = 1.0" => Some(140_f64.sqrt()),
                _ => Some((140.0 / 500.0_f64).sqrt()),
            };
            let json = serde_json::json!({ "fragment": { "toml": body } }).to_string();
            for (name, text) in [
                ("law.toml", body.clone()),
                ("marked.toml", format!("\u{feff}{body}")),
                ("law.json", json.clone()),
                ("marked.json", format!("\u{feff}{json}")),
            ] {
                fs::write(shell.path(name), text).unwrap();
                let output = shell.run(&["draw", name, "-n", "2"]);
                let message = String::from_utf8(output.stderr).unwrap();
                assert!(output.status.success(), "{name}: {message}");
                let is_told = message.contains("the mean of the law of the mass centre");
                assert_eq!(
                    is_told,
                    size_m.is_some_and(|size| mean > 0.1 * size),
                    "{name} {mass}: {message}"
                );
            }
        }
    }
}
