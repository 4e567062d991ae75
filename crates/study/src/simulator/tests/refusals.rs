//! Scenarios of simulators that are refused, and at which key.

use super::{
    BODY, HEAD, MODELS, SimulatorScenario, correlated, folder, quantity, scenario, uniform,
};
use crate::{Options, scenario::tests::cases};

/// What cannot be, at its key.
#[test]
fn refusals_name_their_key() {
    let folder = folder();
    let body = "\n[[bodies]]\nname = \"hub\"".to_owned() + BODY;
    let with = |d: &str| HEAD.to_owned() + &body.replace("DISPERSION", d) + MODELS;
    let refused = |text: &str, key: &str| {
        let refused = SimulatorScenario::from_toml(text, folder.path()).unwrap_err().to_string();
        assert!(refused.contains(key), "{key}: {refused}");
    };
    let tied = uniform() + &correlated();
    for [from, to, key] in cases(
        r#"
        timeout_s = 60.0 | timeout_s = 0.0 | simulation.timeout_s
        ["sh", "answer.sh"] | [] | simulation.command
        ["sh", "answer.sh"] | "sh answer.sh" | simulation.command: invalid type: string "sh answer.sh", expected a list of the program and its arguments, such as ["python3", "simulator.py"]
        ["sh", "answer.sh"] | ["sh", 3] | simulation.command[2]: invalid type: integer `3`, expected a string
        timeout_s = 60.0 | folder = "/no/such" | simulation.folder
        timeout_s = 60.0 | folder = "/etc/passwd" | simulation.folder: the folder of the command, /etc/passwd, is a file: it must be a folder
        name = "y" | name = "x" | simulation.outputs[1].name: "x": the name is taken, by quantities[1].name
        name = "y" | name = "run" | simulation.outputs[1].name: "run": the name is taken, by a column that every run table has
        name = "y" | name = "y 1" | simulation.outputs[1].name
        shell | a/b | name
        [[correlations]] | [payload]\nmass_kg = 1.0\n[[correlations]] | payload
        name = "x" | name = "1x" | quantities[1].name
        low = 0.1 | low = 1.1 | quantities[1].law
        sigma = 0.1 | sigma = -0.1 | quantities[2].law.sigma
        "x", | | correlations[1].between
        "x", | "y", | correlations[1].between
        -0.8 | -1.8 | correlations[1].coefficient
        sigma = 0.1 | sigma = 0.0 | correlations[1].between: "z" does not vary: all values of quantities[2].law are the same, as with a sigma of zero. Give it another law, or leave
        "#,
    ) {
        assert!(tied.contains(&from), "{from}");
        refused(&tied.replace(&from, &to), &key);
    }
    let normal = "{ law = \"normal\", mean = 1.0, sigma = 1.0 }";
    for (name, by) in [
        ("x", "quantities[1].name"),
        ("run", "a column that every run table has"),
        ("status_kind", "a column that every run table has"),
    ] {
        let key = format!("quantities[2].name: {name:?}: the name is taken, by {by}");
        refused(&(uniform() + &quantity(name, normal)), &key);
    }
    // A quantity is one number, which has no covariance; a velocity has three, if they have a law in common.
    let message =
        |text: &str| SimulatorScenario::from_toml(text, folder.path()).unwrap_err().to_string();
    let scalar = message(&(uniform() + &quantity("z", "{ law = \"normal\", mean = 1.0 }")));
    assert!(scalar.ends_with("law = \"normal\" needs sigma or variance"), "{scalar}");
    for [dispersion, key] in cases(
        r#"
        mass_centre_m = 0.1 | bodies[1].dispersion.mass_centre_m
        inertia_follows_mass = true | bodies[1].dispersion.inertia_follows_mass
        mass_kg = 1.0\nmass_percent = 1.0 | bodies[1].dispersion.mass_percent
        velocity_m_per_s = 0.1 | bodies[1].dispersion.velocity_m_per_s
        "#,
    ) {
        refused(&with(&dispersion), &key);
    }
    for [from, to, key] in cases(
        r#"
        mass_kg = 120.0 | mass_kg = -1.0 | bodies[1].mass_kg
        mass_kg = 120.0 | mass_kg = 1e13 | bodies[1].mass_kg: 10000000000000.0: it must be at most 1e12
        mass_kg = 120.0 | mass_kg = 120.0\nmass_centre_m = [0.0, inf, 0.0] | bodies[1].mass_centre_m
        axes = "whole-sphere" | | models[1].axes
        axes = "whole-sphere" | axes = "mean-half" | models[1].axes
        matched_to = "proposed" | | models[2].hub_deviation_kg_m2
        matched_to = "proposed" | matched_to = "naive" | models[2].matched_to
        "naive" | "Proposed" | models[2].name
        "#,
    ) {
        refused(&with("").replace(&from, &to), &key);
    }
    refused(
        &(HEAD.to_owned() + &(body.clone() + &body).replace("DISPERSION", "")),
        "bodies[2].name",
    );
    let absent = uniform().replace("\"sh\"", "\"gyradius-no-such-program\"");
    let absent = scenario(&absent, folder.path());
    let options = Options::to(folder.path().join("absent"));
    let refused = absent.study(&options, &|_| {}, &|_| {}).unwrap_err();
    assert!(refused.to_string().contains("cannot be started"), "{refused}");
    assert!(!folder.path().join("absent").exists());
}
