//! Bodies of simulators whose mass, mass centre and inertia have one law.

use gyradius_inertia::{Containment, Inertia, InertiaMatrix, MassProperties, Region};
use nalgebra::Vector3;

use super::{
    MODELS, Options, SimulatorDraws, SimulatorScenario, drawn, folder, fs, scenario, uniform,
};

/// A body about a mass centre that is not the origin, kept to a region, and one with a whole law.
const BODIES: &str = r#"
[[bodies]]
name = "a"
mass_kg = 120.0
mass_centre_m = [1.0, 0.0, 0.5]
inertia_kg_m2 = [[21.0, 0.2, -0.1], [0.2, 19.0, 0.3], [-0.1, 0.3, 26.0]]

[bodies.dispersion]
gyration_lengths_m = [0.03, 0.02, 0.02]
axes = "uniform"
mass_percent = 5.0
mass_centre_m = 0.1
inside = { ellipsoid = { middle_m = [1.0, 0.0, 0.5], semi_axes_m = [0.6, 0.6, 0.6] } }

[[bodies]]
name = "b"
mass_kg = 100.0
mass_centre_m = [0.0, 0.0, 0.2]
inertia_kg_m2 = [[21.0, 0.2, -0.1], [0.2, 19.0, 0.3], [-0.1, 0.3, 26.0]]

[bodies.law]
mass_kg = { law = "uniform", low = 110.0, high = 130.0 }
mass_centre_m = [{ mean = 0.0, sigma = 0.0 }, { mean = 0.0, sigma = 0.0 }, { mean = 0.3, sigma = 0.01 }]
correlations = [["mass", "shape3", 1.0]]

[bodies.law.inertia.of.gyration-lengths]
laws = [{ mean = 0.3, sigma = 0.0 }, { mean = 0.3, sigma = 0.0 }, { law = "uniform", low = 0.2, high = 0.4 }]
axes = { law = "fixed", attitude = [0.0, 0.0, 0.0, 1.0] }

[[correlations]]
between = ["a_mass_kg", "a_gyration_length_1_m", "x"]
coefficient = 0.5
"#;

/// The drawn bodies of a name, of thirty runs.
fn bodies(scenario: &SimulatorScenario, name: &str) -> Vec<MassProperties> {
    bodies_of(&drawn(scenario, 0), name)
}

/// The bodies of a name in columns.
fn bodies_of(columns: &[(String, Vec<Option<u64>>)], name: &str) -> Vec<MassProperties> {
    let column = |of: &str| -> Vec<f64> {
        let wanted = format!("{name}_{of}");
        let (_, values) = columns.iter().find(|(column, _)| *column == wanted).unwrap();
        values.iter().map(|bits| f64::from_bits(bits.unwrap())).collect()
    };
    let mass = column("mass_kg");
    let centre = [1, 2, 3].map(|i| column(&format!("mass_centre_{i}_m")));
    let entries = ["11", "22", "33", "12", "13", "23"].map(|entry| column(&format!("i{entry}")));
    let body = |run: usize| {
        let [a, b, c, d, e, f] = entries.each_ref().map(|values| values[run]);
        let inertia = InertiaMatrix::from_entries([a, b, c], [d, e, f]).unwrap();
        let centre = Vector3::from(centre.each_ref().map(|values| values[run]));
        MassProperties::new(mass[run], centre, Inertia::try_from(inertia).unwrap()).unwrap()
    };
    (0..mass.len()).map(body).collect()
}

#[test]
fn bodies_have_joint_laws() {
    let folder = folder();
    let scenario = scenario(&(uniform() + BODIES), folder.path());
    let region = Region::ellipsoid([1.0, 0.0, 0.5], [0.6; 3]).unwrap();
    for body in bodies(&scenario, "a") {
        assert_eq!(region.containment(&body), Containment::Possible);
    }
    for body in bodies(&scenario, "b") {
        // The third length goes with the mass as one number does.
        let moments = body.inertia().as_inertia_matrix().entries();
        let third = 0.5 * (moments[0] + moments[1] - moments[2]) / body.mass_kg();
        let length = 0.2 + 0.2 * (body.mass_kg() - 110.0) / 20.0;
        assert!((third.sqrt() - length).abs() < 1e-9, "{body:?}");
        assert!((body.mass_centre_m().z - 0.3).abs() < 0.05);
    }
    let draws = SimulatorDraws::new(&scenario, 0).unwrap();
    let names = draws.groups().names();
    let expected = "a inertia, a mass, a mass centre and 2 more, correlated";
    assert!(names.contains(&expected.to_owned()), "{names:?}");
    assert!(names.contains(&"b axes".to_owned()), "{names:?}");
}

#[test]
fn what_a_body_cannot_have_is_named() {
    let folder = folder();
    let refused = |from: &str, to: &str| {
        let text = uniform() + BODIES;
        assert!(text.contains(from), "{from}");
        let read = SimulatorScenario::from_toml(&text.replacen(from, to, 1), folder.path());
        read.unwrap_err().to_string()
    };
    for (from, to, expected) in [
        ("mass_centre_m = [0.0, 0.0, 0.2]\n", "", "bodies[2].law: it says where"),
        (
            "semi_axes_m = [0.6, 0.6, 0.6]",
            "semi_axes_m = [0.1, 0.1, 0.1]",
            "bodies[1].dispersion.inside: region: 0 of",
        ),
        (
            "gyration_lengths_m = [0.03,",
            "gyration_lengths_m = [nan,",
            "bodies[1].dispersion.gyration_lengths_m[1]: NaN",
        ),
        (
            "[bodies.law]",
            "[bodies.dispersion]\nmass_kg = 1.0\n[bodies.law]",
            "bodies[2].dispersion.mass_kg: there is bodies[2].law",
        ),
    ] {
        let message = refused(from, to);
        assert!(message.starts_with(expected), "{message}\n{expected}");
    }
}

/// Summary and report tell the share of draws that a region keeps: that of the draws without it.
#[test]
fn what_a_region_keeps_is_told() {
    let folder = folder();
    let text = uniform() + BODIES + MODELS;
    let scenario_of = |text: &str| scenario(text, folder.path()).with_runs(40).unwrap();
    let study = |text: &str, name: &str| {
        let options = Options::to(folder.path().join(name));
        let study = scenario_of(text).study(&options, &|_| {}, &|_| {}).unwrap();
        let read = |file: &str| fs::read_to_string(study.folder().join(file)).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&read("summary.json")).unwrap();
        (summary, read("report.md"))
    };
    let (summary, report) = study(&text, "kept");
    let regions = summary["regions"].as_array().unwrap();
    // The other model draws the inertia by a law of its own.
    assert_eq!((regions.len(), &regions[0]["model"]), (1, &"proposed".into()), "{regions:?}");
    let bodies = regions[0]["regions"].as_array().unwrap();
    assert_eq!((bodies.len(), &bodies[0]["body"]), (1, &"a".into()), "{bodies:?}");
    let [share, error] =
        ["acceptance", "standard_error"].map(|key| bodies[0][key].as_f64().unwrap());

    let start = text.find("inside = ").unwrap();
    let line = text[start..].lines().next().unwrap();
    let open_text = text.replace(line, "");
    let open = scenario_of(&open_text);
    let draws = SimulatorDraws::new(&open, 0).unwrap();
    let (names, _) = (drawn(&open, 0), ());
    let mut columns: Vec<(String, Vec<Option<u64>>)> =
        names.into_iter().map(|(name, _)| (name, Vec::new())).collect();
    let n = 3000;
    for run in 0..n {
        let mut numbers = Vec::new();
        super::Inputs::draw(&draws, run, &mut numbers).unwrap();
        for ((_, values), number) in columns.iter_mut().zip(numbers) {
            values.push(number.map(f64::to_bits));
        }
    }
    let region = Region::ellipsoid([1.0, 0.0, 0.5], [0.6; 3]).unwrap();
    let held = bodies_of(&columns, "a").iter().filter(|body| region.room(body) >= 0.0).count();
    let expected = held as f64 / n as f64;
    let off =
        (share - expected).abs() / (error.powi(2) + expected * (1.0 - expected) / n as f64).sqrt();
    assert!(
        error > 0.0 && (0.05..0.95).contains(&share) && off < 4.5,
        "{share} {error} {expected}"
    );
    assert!(
        report.contains("Regions of matter") && report.contains("of the a's draws"),
        "{report}"
    );

    let (summary, report) = study(&open_text, "open");
    assert!(summary.get("regions").is_none() && !report.contains("Regions of matter"));
}

/// A length is told of if more than Φ(−2) of its law is below zero, in the order of bodies and axes, and a report tells it.
#[test]
fn lengths_that_are_folded_are_told() {
    let folder = folder();
    let start = BODIES.find("inside = ").unwrap();
    let open = BODIES.replace(BODIES[start..].lines().next().unwrap(), "");
    let entries = InertiaMatrix::from_entries([21.0, 19.0, 26.0], [0.2, -0.1, 0.3]).unwrap();
    let second = Inertia::try_from(entries).unwrap().second_moments().values();
    let lengths = second.map(|k| (k / 120.0).sqrt());
    for which in 0..8 {
        let sigmas: Vec<String> = (0..3)
            .map(|i| lengths[i] / if which >> i & 1 == 1 { 1.9 } else { 2.1 })
            .map(|sigma| sigma.to_string())
            .collect();
        let text = open.replace("[0.03, 0.02, 0.02]", &format!("[{}]", sigmas.join(", ")));
        let read = scenario(&(uniform() + &text), folder.path()).with_runs(3).unwrap();
        let found = read.folded();
        let names: Vec<&str> = found.iter().map(|root| root.quantity.as_str()).collect();
        let expected: Vec<String> = (1..4)
            .filter(|axis| which >> (axis - 1) & 1 == 1)
            .map(|axis| format!("gyration_length_{axis}"))
            .collect();
        assert_eq!(names, expected);
        for root in &found {
            // Φ(−1.9)
            assert!(root.body == "a" && (root.share - 0.028_716_56).abs() < 1e-6, "{root}");
        }
        if which == 5 {
            let out = Some(folder.path().join("folded"));
            let options = Options { out, ..Options::default() };
            let study = read.study(&options, &|_| {}, &|_| {}).unwrap();
            let page = fs::read_to_string(study.folder().join("report.md")).unwrap();
            for axis in [1, 3] {
                let said =
                    format!("a: 2.9 % of the law of gyration\\_length\\_{axis} lie below zero");
                let plain = said.replace('\\', "");
                assert!(page.contains(&said) || page.contains(&plain), "{page}");
            }
        }
    }
}
