//! Laws of bodies of simulators whose means are far from the nominal values beside them.

use super::{HEAD, Options, SimulatorScenario, folder, fs, scenario};
use crate::OffNominal;

const BODY: &str = r#"
[[bodies]]
name = "NAME"
mass_kg = 500.0
mass_centre_m = [3.1, 0.0, 1.4]
inertia_kg_m2 = [[110.0, 0.0, 0.0], [0.0, 80.0, 0.0], [0.0, 0.0, 90.0]]
"#;

/// A mass in a dispersion, and what is told of it.
const MASSES: [(&str, &[&str]); 6] = [
    ("", &[]),
    ("mass_kg = 50.0", &[]),
    (
        "mass_kg = { law = \"uniform\", low = 475, high = 525 }",
        &[
            "the nominal value of NAME_mass_kg is 500, and its law, which is of the change from that, has a mean of 500, so that what is \
           drawn has a mean of 1000. If the value itself is meant, write bodies[PLACE].dispersion.mass_kg = { law = \"uniform\", low = -25.0, \
           high = 25.0 }",
        ],
    ),
    (
        "mass_percent = { mean = 102.5, sigma = 3, sigmas = 3 }",
        &[
            "the nominal value of NAME_mass_kg is 500, and its law, which is of the change from that, has a mean of 512.5, so that what is \
           drawn has a mean of 1012. If the value itself is meant, write bodies[PLACE].dispersion.mass_percent = { law = \"normal\", \
           sigma = 3.0, sigmas = 3.0, mean = 2.5 }",
        ],
    ),
    (
        "mass_kg = { law = \"uniform\", low = 4750, high = 5250 }",
        &["the nominal value of NAME_mass_kg is 500, and the mean of its law is 5500."],
    ),
    ("mass_kg = { mean = 300.0, sigma = 1.0 }", &[]),
];

/// A mass centre likewise: components, and what is told of the centre.
const CENTRES: [(&str, &[&str]); 4] = [
    ("", &[]),
    ("mass_centre_m = 0.02", &[]),
    (
        "mass_centre_m = [{ mean = 3.1, sigma = 0.01 }, 0.01, { mean = 1.4, sigma = 0.01 }]",
        &[
            "the nominal value of NAME_mass_centre_1_m is 3.1, and its law",
            "the nominal value of NAME_mass_centre_3_m is 1.4, and its law",
            "the mean of the law of the mass centre of the NAME is (3.1, 0, 1.4) m away from the nominal one",
        ],
    ),
    (
        "mass_centre_m = [0.01, { mean = -0.5, sigma = 0.1 }, 0.0]",
        &[
            "the mean of the law of the mass centre of the NAME is (0, -0.5, 0) m away from the nominal one",
        ],
    ),
];

/// A body with all of that as a whole law, whose numbers are those of the quantities themselves.
fn whole(mass: f64, centre: [f64; 3]) -> String {
    let [x, y, z] = centre.map(|x| format!("{{ mean = {x:?}, sigma = 0.01 }}"));
    format!(
        "{BODY}[bodies.law]\nmass_kg = {{ mean = {mass:?}, sigma = 5.0 }}\nmass_centre_m = [{x}, {y}, {z}]\n\
         [bodies.law.inertia.of.roots]\nlaws = [{{ mean = 5.48, sigma = 0.1 }}, {{ mean = 7.75, sigma = 0.1 }}, {{ mean = 7.07, sigma = 0.1 }}]\n\
         axes = {{ law = \"fixed\", attitude = [0.0, 0.0, 0.0, 1.0] }}\n"
    )
}

/// All pairs of laws of masses and mass centres, and whole laws near and far, of one body beside another: those are told that are far, in
/// the report too.
#[test]
fn campaigns_tell_laws_that_are_far_from_nominal_values() {
    let folder = folder();
    let mut bodies: Vec<(String, Vec<&str>)> = Vec::new();
    for (mass, of_mass) in MASSES {
        for (centre, of_centre) in CENTRES {
            let text = format!(
                "{BODY}[bodies.dispersion]\n{mass}\n{centre}\nroot_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]\naxes = \"fixed\"\n"
            );
            // Numbers are told before mass centres.
            bodies.push((text, [of_mass, of_centre].concat()));
        }
    }
    bodies.push((whole(510.0, [3.1, 0.01, 1.4]), vec![]));
    bodies.push((
        whole(5100.0, [3.1, 0.01, 1.4]),
        vec!["the nominal value of NAME_mass_kg is 500, and the mean of its law is 5100."],
    ));
    // The value itself, which is twice the nominal one on purpose.
    bodies.push((whole(1000.0, [3.1, 0.01, 1.4]), vec![]));
    bodies.push((
        whole(510.0, [0.1, 0.0, 1.4]),
        vec![
            "the nominal value of NAME_mass_centre_1_m",
            "the mean of the law of the mass centre of the NAME is (-3, 0, 0) m away from the nominal one, along body axes. Both are told",
        ],
    ));
    for (place, (text, expected)) in bodies.iter().enumerate() {
        let (other, of_other) = &bodies[(7 * place + 3) % bodies.len()];
        let named = |text: &str, place: usize| {
            text.replace("NAME", ["a", "b"][place]).replace("PLACE", &(place + 1).to_string())
        };
        let text = HEAD.to_owned() + &named(text, 0) + &named(other, 1);
        let read = scenario(&text, folder.path()).with_runs(2).unwrap();
        let told: Vec<String> = read.off_nominal().iter().map(ToString::to_string).collect();
        let wanted: Vec<String> = expected
            .iter()
            .map(|text| named(text, 0))
            .chain(of_other.iter().map(|text| named(text, 1)))
            .collect();
        assert_eq!(told.len(), wanted.len(), "{told:#?} {wanted:#?}\n{text}");
        for text in &wanted {
            assert!(told.iter().any(|told| told.starts_with(text)), "{told:#?} {text}");
        }
        if place % 5 == 2 {
            of_study(&read, place, folder.path());
        }
    }
}

/// The summary of a campaign has what the scenario tells, and its page says it.
fn of_study(scenario: &SimulatorScenario, place: usize, folder: &std::path::Path) {
    let options = Options::to(folder.join(place.to_string()));
    let study = scenario.study(&options, &|_| {}, &|_| {}).unwrap();
    let written = fs::read_to_string(study.folder().join("summary.json")).unwrap();
    let written: serde_json::Value = serde_json::from_str(&written).unwrap();
    let alerts = written["alerts"].as_array().cloned().unwrap_or_default();
    let of_laws = alerts.into_iter().filter(|alert| alert["alert"] == "off_nominal");
    let read: Vec<OffNominal> =
        of_laws.map(|alert| serde_json::from_value(alert).unwrap()).collect();
    assert_eq!(read, scenario.off_nominal());
    let page = fs::read_to_string(study.folder().join("report.md")).unwrap();
    let titles = ["may be meant of the value itself", "is far from the nominal"];
    let count: usize = titles.iter().map(|title| page.matches(title).count()).sum();
    assert_eq!(count, read.len(), "{page}");
}
