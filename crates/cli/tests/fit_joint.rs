//! `gyradius fit` on tables with mass and mass centre, and on estimates of the ten parameters.

use gyradius::dispersion::{
    MassPropertiesLaw, ScalarLaw, TenParameters, TensorLaw, rand_distr::Distribution,
};
use gyradius::inertia::MassProperties;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use serde_json::Value;
use std::{fmt::Write, fs, process::Command};
use tempfile::TempDir;

/// Exit code, standard output, standard error.
fn run(folder: &TempDir, arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_gyradius"))
        .current_dir(folder.path())
        .args(arguments)
        .output()
        .unwrap();
    let messages = String::from_utf8(output.stderr).unwrap();
    assert!(!messages.contains("panicked"), "{messages}");
    (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap(), messages)
}

fn bodies() -> Vec<MassProperties> {
    let normal = |mean: f64, deviation: f64| ScalarLaw::normal(mean, deviation).unwrap();
    let lengths = [normal(0.2, 0.004), normal(0.3, 0.004), normal(0.5, 0.005)];
    let axes = gyradius::attitude::RadiallyConstrainedGaussian::from_rotation_covariance(
        nalgebra::UnitQuaternion::from_euler_angles(0.1, -0.2, 0.3),
        nalgebra::Matrix3::identity() * 4e-4,
        0.01,
    );
    let law = MassPropertiesLaw::new(
        normal(12.0, 0.5),
        [normal(0.01, 0.003), normal(0.0, 0.003), normal(0.4, 0.005)],
        TensorLaw::gyration_lengths(lengths, axes.unwrap()),
    );
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let law = law.unwrap();
    (0..200).map(|_| law.sample(&mut rng)).collect()
}

fn table(header: &str, rows: impl Iterator<Item = Vec<f64>>) -> String {
    let mut text = header.to_owned() + "\n";
    for row in rows {
        let cells: Vec<String> = row.iter().map(f64::to_string).collect();
        writeln!(text, "{}", cells.join(",")).unwrap();
    }
    text
}

fn natural(bodies: &[MassProperties]) -> String {
    let rows = bodies.iter().map(|body| TenParameters::from(*body).values().to_vec());
    table(&TenParameters::COLUMNS.join(","), rows)
}

fn json(folder: &TempDir, arguments: &[&str]) -> Value {
    let (_, out, messages) = run(folder, &[arguments, &["--format", "json"]].concat());
    assert!(messages.is_empty(), "{messages}");
    serde_json::from_str(&out).unwrap()
}

#[test]
fn the_joint_law_stands_beside_the_fit_of_today() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let bodies = bodies();
    write("ten.csv", &natural(&bodies));
    let alone = bodies.iter().map(|body| body.inertia().entries().to_vec());
    fs::create_dir(folder.path().join("alone")).unwrap();
    write("alone/ten.csv", &table("i11,i22,i33,i12,i13,i23", alone));
    let rows = bodies.iter().map(|body| TenParameters::from(*body).linear().as_slice().to_vec());
    let header = "mass_kg,first_moment_1_kg_m,first_moment_2_kg_m,first_moment_3_kg_m,ixx,iyy,izz,ixy,ixz,iyz";
    write("linear.csv", &table(header, rows));
    // In other units and other words.
    let other = bodies.iter().map(|body| {
        let mut row = TenParameters::from(*body).values().to_vec();
        row[0] *= 1e3;
        row[1..4].iter_mut().for_each(|x| *x *= 1e3);
        row
    });
    write(
        "units.csv",
        &table("Mass [g],Cx (mm),Cy (mm),Cz (mm),ixx_kg_m2,iyy,izz,ixy,ixz,iyz", other),
    );

    let (code, text, _) = run(&folder, &["fit", "ten.csv"]);
    let (known, today, _) = run(&folder, &["fit", "alone/ten.csv"]);
    assert_eq!(code, known);
    // What is said of the inertia alone is the same to the byte, and so is the fragment.
    let (report, fragment) = today.split_once("\n\n[payload]").unwrap();
    assert!(text.starts_with(report) && text.ends_with(fragment), "{text}");
    assert!(!today.contains("joint") && text.contains("# joint law of mass"), "{text}");
    assert!(text.contains("verdict on the joint law: nothing speaks against it"), "{text}");

    let found = json(&folder, &["fit", "ten.csv"]);
    assert!(json(&folder, &["fit", "alone/ten.csv"]).get("joint").is_none());
    let law: MassPropertiesLaw = serde_json::from_value(found["joint"]["law"].clone()).unwrap();
    assert!((law.mass().mean() - 12.0).abs() < 0.15, "{law:?}");
    let power = &found["joint"]["inertia_power_of_mass"];
    assert!(power["low"].as_f64() < Some(1.0) && power["high"].as_f64() > Some(1.0), "{power}");
    for same in [&["fit", "linear.csv", "--parameters", "linear"][..], &["fit", "units.csv"]] {
        let other = json(&folder, same);
        let mean =
            |v: &Value, i: usize| v["joint"]["gyration_lengths_m"][i]["mean"].as_f64().unwrap();
        for i in 0..3 {
            assert!((mean(&other, i) / mean(&found, i) - 1.0).abs() < 1e-6, "{same:?}");
        }
        let mass = |v: &Value| v["joint"]["mass_kg"]["deviation"].as_f64().unwrap();
        assert!((mass(&other) / mass(&found) - 1.0).abs() < 1e-6, "{same:?}");
    }
    // The one is not taken for the other, and what is not taken at all is named.
    for (wrong, said) in [
        (&["fit", "linear.csv"][..], "--parameters linear must say"),
        (&["fit", "ten.csv", "--parameters", "linear"], "its columns are those of a mass centre"),
        (&["fit", "half.csv"], "no column of centre_z"),
    ] {
        write("half.csv", &natural(&bodies).replacen("mass_centre_3_m", "height", 1));
        let (code, out, message) = run(&folder, wrong);
        assert!(code == 2 && out.is_empty() && message.contains(said), "{wrong:?}: {message}");
    }
    write("other.csv", &natural(&bodies).replace("mass_centre", "place"));
    let (_, text, _) = run(&folder, &["fit", "other.csv"]);
    let said = "# nothing was taken from the columns mass_kg, place_1_m, place_2_m, place_3_m";
    assert!(text.contains(said) && !text.contains("joint"), "{text}");
}

#[test]
fn rows_of_no_body_are_refused_or_counted() {
    let folder = tempfile::tempdir().unwrap();
    let text = natural(&bodies()[..30]);
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let rest = lines[4].split_once(',').unwrap().1.to_owned();
    for mass in ["0", "-1"] {
        lines[4] = format!("{mass},{rest}");
        fs::write(folder.path().join("ten.csv"), lines.join("\n")).unwrap();
        let (code, _, message) = run(&folder, &["fit", "ten.csv"]);
        assert_eq!(code, 2);
        let said = format!("ten.csv:5: no body has these mass properties: mass = {mass} kg");
        assert!(message.contains(&said), "{message}");
    }
    let found = json(&folder, &["fit", "ten.csv", "--skip-impossible"]);
    assert_eq!((found["set_aside"].as_u64(), found["samples"].as_u64()), (Some(1), Some(29)));
    lines[4] = format!("heavy,{rest}");
    fs::write(folder.path().join("ten.csv"), lines.join("\n")).unwrap();
    let (code, _, message) = run(&folder, &["fit", "ten.csv"]);
    assert!(code == 2 && message.contains("ten.csv:5") && message.contains("heavy"), "{message}");
    let (code, _, message) = run(&folder, &["fit", "ten.csv", "--parameters", "linear"]);
    assert!(code == 2, "{message}");
}

const MEAN: [f64; 10] = [2.0, 0.02, 0.0, 0.2, 0.30, 0.32, 0.09, 0.004, 0.0, -0.003];
const DEVIATIONS: [f64; 10] = [0.02, 0.002, 0.002, 0.002, 0.004, 0.004, 0.003, 0.001, 0.001, 0.001];

#[test]
fn an_estimate_has_its_laws() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "phi.json",
        &format!(r#"{{"parameters": "linear", "mean": {MEAN:?}, "deviations": {DEVIATIONS:?}}}"#),
    );
    write(
        "phi.toml",
        &format!("parameters = \"linear\"\nmean = {MEAN:?}\ndeviations = {DEVIATIONS:?}\n"),
    );
    let square = |i: usize| {
        (0..10).map(|j| if i == j { DEVIATIONS[i] * DEVIATIONS[i] } else { 0.0 }).collect()
    };
    let rows = std::iter::once(MEAN.to_vec()).chain((0..10).map(square));
    write("phi.csv", &table("m,first_moment_1_kg_m,h2,h3,i11,i22,i33,i12,i13,i23", rows));
    let (code, text, messages) = run(&folder, &["fit", "--estimate", "phi.json"]);
    assert_eq!(code, 0, "{text}{messages}");
    assert!(
        text.contains("log-Cholesky law: mean and covariance are those of the estimate"),
        "{text}"
    );
    let found = json(&folder, &["fit", "--estimate", "phi.json"]);
    assert_eq!(found["log_cholesky"]["exact"], true);
    assert_eq!(found["moved"], 0.0);
    let law: MassPropertiesLaw = serde_json::from_value(found["joint"]["law"].clone()).unwrap();
    assert!((law.mass().mean() - 2.0).abs() < 1e-3);
    for same in ["phi.toml", "phi.csv"] {
        let other = json(&folder, &["fit", "--estimate", same]);
        let mass = |v: &Value| v["log_cholesky"]["law"]["mean"][0].as_f64().unwrap();
        assert!((mass(&other) - mass(&found)).abs() < 1e-9, "{same}");
    }
    let (code, _, _) = run(&folder, &["fit", "--estimate", "phi.json", "-o", "law.json"]);
    assert_eq!(code, 0);
    let written: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("law.json")).unwrap()).unwrap();
    assert_eq!(written, found);

    // Of no body: it is moved, and the exit code says so.
    let mut flat = MEAN;
    flat[6] = 0.7;
    write(
        "flat.json",
        &format!(r#"{{"parameters": "linear", "mean": {flat:?}, "deviations": {DEVIATIONS:?}}}"#),
    );
    let (code, text, _) = run(&folder, &["fit", "--estimate", "flat.json"]);
    assert_eq!(code, 1);
    assert!(text.contains("the mean belongs to no body"), "{text}");
}

#[test]
fn what_is_no_estimate_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text, expected) in [
        (
            "a.json",
            format!(r#"{{"mean": {MEAN:?}, "deviations": {DEVIATIONS:?}}}"#),
            "--parameters",
        ),
        (
            "b.json",
            format!(r#"{{"parameters": "linear", "mean": {MEAN:?}}}"#),
            "covariance or deviations",
        ),
        (
            "c.json",
            format!(r#"{{"parameters": "odd", "mean": {MEAN:?}, "deviations": {DEVIATIONS:?}}}"#),
            "odd",
        ),
        ("d.csv", "1,2,3\n".to_owned(), "ten numbers"),
        ("e.txt", String::new(), "extension"),
        ("f.toml", "mean = 3\n".to_owned(), "f.toml"),
        (
            "h.json",
            format!(r#"{{"mean": [1.0, 2.0], "deviations": {DEVIATIONS:?}}}"#),
            "mean has a length of 2: it must be 10",
        ),
        (
            "i.json",
            format!(r#"{{"mean": {MEAN:?}, "covariance": [[1.0]]}}"#),
            "row 1 of covariance has a length of 1: it must be 10",
        ),
        (
            "j.json",
            format!(r#"{{"mean": {MEAN:?}, "covariance": []}}"#),
            "covariance has a length of 0: it must be 10",
        ),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        let (code, out, message) = run(&folder, &["fit", "--estimate", name]);
        assert_eq!((code, out.as_str()), (2, ""), "{name}");
        assert!(message.contains(expected), "{name}: {message}");
    }
    let linear =
        format!(r#"{{"parameters": "linear", "mean": {MEAN:?}, "deviations": {DEVIATIONS:?}}}"#);
    fs::write(folder.path().join("g.json"), linear).unwrap();
    let (code, _, message) =
        run(&folder, &["fit", "--estimate", "g.json", "--parameters", "natural"]);
    let both = "--parameters natural, and the file says parameters = \"linear\"";
    assert!(code == 2 && message.contains(both), "{message}");
    let (code, _, message) = run(&folder, &["fit"]);
    assert!(code == 2 && message.contains("FILE"), "{message}");
}

/// Masses of which nothing is taken are named in every form: as a column of a CSV, and as a key of the others.
#[test]
fn masses_that_are_not_fitted_are_named() {
    let folder = TempDir::new().unwrap();
    for masses in [0..0, 0..30, 7..8, 29..30] {
        let bodies: Vec<(Option<f64>, [f64; 3])> = (0..30)
            .map(|i| {
                let x = f64::from(i);
                let mass = masses.contains(&i).then_some(10.0 + x);
                (mass, [5.0 + 0.03 * (x % 7.0), 4.0 + 0.02 * (x % 5.0), 3.0 + 0.01 * (x % 3.0)])
            })
            .collect();
        let json = bodies.iter().map(|(mass, [a, b, c])| {
            let mass = mass.map_or(String::new(), |mass| format!("\"mass_kg\": {mass}, "));
            format!("{{{mass}\"inertia_kg_m2\": [[{a}, 0, 0], [0, {b}, 0], [0, 0, {c}]]}}")
        });
        let json = json.collect::<Vec<_>>().join(",\n");
        let toml: String = bodies
            .iter()
            .map(|(mass, [a, b, c])| {
                let mass = mass.map_or(String::new(), |mass| format!("mass_kg = {mass}\n"));
                format!("[[body]]\n{mass}inertia_kg_m2 = [[{a:?}, 0.0, 0.0], [0.0, {b:?}, 0.0], [0.0, 0.0, {c:?}]]\n")
            })
            .collect();
        for (name, text) in [("it.json", format!("[{json}]")), ("it.toml", toml)] {
            fs::write(folder.path().join(name), &text).unwrap();
            let (_, json, _) = run(&folder, &["fit", name, "--format", "json"]);
            let found: Value = serde_json::from_str(&json).unwrap();
            let unread: Vec<&str> = found["unread"]
                .as_array()
                .unwrap()
                .iter()
                .map(|told| told.as_str().unwrap())
                .collect();
            assert_eq!(found["samples"], 30, "{name}");
            assert_eq!(unread.len(), usize::from(!masses.is_empty()), "{name}: {unread:?}");
            let (_, report, _) = run(&folder, &["fit", name]);
            assert_eq!(
                report.contains("nothing was taken from mass_kg"),
                !masses.is_empty(),
                "{report}"
            );
            if let [told] = unread.as_slice() {
                // A body stands in the line of its inertia.
                let mut lines =
                    (1..).zip(text.lines()).skip_while(|(_, line)| !line.contains("mass_kg"));
                let (line, _) = lines.find(|(_, line)| line.contains("inertia_kg_m2")).unwrap();
                assert!(told.starts_with(&format!("line {line}: ")), "{told}");
            }
        }
    }
}
