//! Bodies of simulators whose mass, mass centre and inertia have one law.

use gyradius_inertia::{Containment, Inertia, InertiaMatrix, MassProperties, Region};
use nalgebra::Vector3;

use super::{SimulatorDraws, SimulatorScenario, drawn, folder, scenario, uniform};

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

/// The drawn bodies of a name.
fn bodies(scenario: &SimulatorScenario, name: &str) -> Vec<MassProperties> {
    let columns = drawn(scenario, 0);
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
