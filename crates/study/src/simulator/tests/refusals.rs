//! Scenarios of simulators that are refused, and at which key.

use super::{
    BODY, HEAD, MODELS, SimulatorScenario, correlated, folder, quantity, scenario, uniform,
};
use crate::Options;

/// What cannot be, at its key.
#[test]
fn refusals_name_their_key() {
    let folder = folder();
    let body = "\n[[bodies]]\nname = \"hub\"".to_owned() + BODY;
    let with = |d: &str| HEAD.to_owned() + &body.replace("DISPERSION", d) + MODELS;
    let normal = "{ law = \"normal\", mean = 1.0, sigma = 1.0 }";
    let cases = [
        (uniform().replace("timeout_s = 60.0", "timeout_s = 0.0"), "simulation.timeout_s"),
        (uniform().replace("[\"sh\", \"answer.sh\"]", "[]"), "simulation.command"),
        (uniform().replace("timeout_s = 60.0", "folder = \"/no/such\""), "simulation.folder"),
        (uniform().replace("name = \"y\"", "name = \"x\""), "simulation.outputs"),
        (uniform().replace("name = \"y\"", "name = \"run\""), "simulation.outputs"),
        (uniform().replace("name = \"y\"", "name = \"y 1\""), "simulation.outputs[1].name"),
        (uniform().replace("shell", "a/b"), "name"),
        (uniform() + "\n[payload]\nmass_kg = 1.0\n", "payload"),
        (HEAD.to_owned() + &quantity("1x", normal), "quantities[1].name"),
        (
            HEAD.to_owned() + &quantity("x", &normal.replace("sigma = 1.0", "sigma = -1.0")),
            "quantities[1].law.sigma",
        ),
        (with("mass_centre_m = 0.1"), "bodies[1].dispersion.mass_centre_m"),
        (with("inertia_follows_mass = true"), "bodies[1].dispersion.inertia_follows_mass"),
        (with("mass_kg = 1.0\nmass_percent = 1.0"), "bodies[1].dispersion.mass_percent"),
        (with("").replace("mass_kg = 120.0", "mass_kg = -1.0"), "bodies[1].mass_kg"),
        (
            with("").replace("mass_kg = 120.0", "mass_kg = 120.0\nmass_centre_m = [0.0, inf, 0.0]"),
            "bodies[1].mass_centre_m",
        ),
        (with("velocity_m_per_s = 0.1"), "bodies[1].dispersion.velocity_m_per_s"),
        (uniform() + &correlated().replace("\"x\", ", ""), "correlations[1].between"),
        (uniform() + &correlated().replace("\"x\", ", "\"y\", "), "correlations[1].between"),
        (uniform() + &correlated().replace("-0.8", "-1.8"), "correlations[1].coefficient"),
        (with("").replace("axes = \"whole-sphere\"", ""), "models[1].axes"),
        (with("").replace("axes = \"whole-sphere\"", "axes = \"mean-half\""), "models[1].axes"),
        (with("").replace("matched_to = \"proposed\"", ""), "models[2].hub_deviation_kg_m2"),
        (HEAD.to_owned() + &(body.clone() + &body).replace("DISPERSION", ""), "bodies[2].name"),
        (
            with("").replace("matched_to = \"proposed\"", "matched_to = \"naive\""),
            "models[2].matched_to",
        ),
        (with("").replace("\"naive\"", "\"Proposed\""), "models[2].name"),
    ];
    for (text, key) in cases {
        let refused = SimulatorScenario::from_toml(&text, folder.path()).unwrap_err().to_string();
        assert!(
            refused.starts_with(&format!("{key}:")) || refused.contains(key),
            "{key}: {refused}"
        );
    }
    let absent = uniform().replace("\"sh\"", "\"gyradius-no-such-program\"");
    let absent = scenario(&absent, folder.path());
    let options = Options { out: Some(folder.path().join("absent")), ..Options::default() };
    let refused = absent.study(&options, &|_| {}, &|_| {}).unwrap_err();
    assert!(refused.to_string().contains("cannot be started"), "{refused}");
    assert!(!folder.path().join("absent").exists());
}
