//! Models of bodies with parameters of their own, and the model that is there if none is given.

use gyradius_dispersion::ModelParameters;
use proptest::prelude::*;
use toml::Table;

use super::{
    BODY, HEAD, ModelKind, SimulatorScenario, bodies_of, drawn, folder, scenario, uniform,
};
use crate::{Scenario, scenario::tests::wrong_parameters};

/// A square matrix with so much on its diagonal.
fn diagonal(size: usize, value: f64) -> String {
    let row = |i: usize| (0..size).map(move |j| if i == j { value } else { 0.0 });
    format!("{:?}", (0..size).map(|i| row(i).collect()).collect::<Vec<Vec<f64>>>())
}

/// A parameter of a body, which differs between bodies.
fn value(key: &str, body: &str) -> String {
    let factor = 1.0 + f64::from(body.bytes().map(u32::from).sum::<u32>() % 7) / 7.0;
    match key {
        "deviation_kg_m2" => diagonal(3, 0.1 * factor),
        "covariance_kg2_m4" => diagonal(6, 0.01 * factor),
        "log_cholesky_covariance" => diagonal(6, 1e-4 * factor),
        "diagonal_bounds_kg_m2" => format!("[-0.5, {}]", 0.5 * factor),
        _ => format!("{}", 0.05 * factor),
    }
}

/// All parameters that a kind needs, of a body.
pub(super) fn parameters(kind: ModelKind, body: &str) -> String {
    kind.needs().iter().map(|key| format!("{body}_{key} = {}\n", value(key, body))).collect()
}

fn model(kind: ModelKind, fields: &str) -> String {
    format!("\n[[models]]\nname = \"own\"\nlaw = \"{kind}\"\n{fields}\n")
}

fn body(name: &str) -> String {
    format!("\n[[bodies]]\nname = \"{name}\"{}", BODY.replace("DISPERSION", ""))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any bodies under any kind of model, any subset of whose parameters is given for one of them: taken if it is what the
    /// kind needs and takes, and else refused at a key of this body. What is resolved says all that the kind takes, for
    /// every body, and a body draws the same whichever others there are.
    #[test]
    fn bodies_have_parameters_of_their_own(
        names in prop::sample::subsequence(vec!["a", "b", "a_b", "delta", "stage", "x9_"], 1..5),
        kind in 1..ModelKind::ALL.len(),
        subset in prop::collection::vec(any::<bool>(), ModelParameters::KEYS.len()),
        as_needed in any::<bool>(),
        at in any::<prop::sample::Index>(),
    ) {
        let kind = ModelKind::ALL[kind];
        let (needs, defaults) = (kind.needs(), kind.defaults());
        let takes = |key: &str| needs.contains(&key) || defaults.given().any(|k| k == key);
        let chosen: Vec<&str> = ModelParameters::KEYS
            .iter()
            .zip(&subset)
            .filter(|(key, chosen)| if as_needed { needs.contains(key) } else { **chosen })
            .map(|(key, _)| *key)
            .collect();
        let odd = names[at.index(names.len())];
        let lines = |name: &&str| {
            if *name != odd {
                return parameters(kind, name);
            }
            chosen.iter().map(|key| format!("{name}_{key} = {}\n", value(key, name))).collect()
        };
        let bodies = |names: &[&str]| HEAD.to_owned() + &names.iter().map(|n| body(n)).collect::<String>();
        // In another order than the bodies.
        let fields: String = names.iter().rev().map(lines).collect();
        let text = bodies(&names) + &model(kind, &fields);
        let folder = folder();
        let fits = needs.iter().all(|k| chosen.contains(k)) && chosen.iter().all(|k| takes(k));
        match SimulatorScenario::from_toml(&text, folder.path()) {
            Ok(_) => {
                prop_assert!(fits, "{}", text);
                let whole = scenario(&text, folder.path());
                let resolved = whole.to_toml();
                let (_, last) = resolved.split_once("[[models]]").unwrap();
                for name in &names {
                    for key in ModelParameters::KEYS {
                        let there = last.lines().any(|l| l.starts_with(&format!("{name}_{key} = ")));
                        prop_assert_eq!(there, takes(key), "{}_{} in {}", name, key, last);
                    }
                }
                let alone = bodies(&[odd]) + &model(kind, &lines(&odd));
                let alone = drawn(&scenario(&alone, folder.path()), 0);
                let all = drawn(&whole, 0);
                for column in &alone {
                    prop_assert!(all.contains(column), "{}", column.0);
                }
                prop_assert!(alone.iter().any(|(_, values)| values[0] != values[1]));
            }
            Err(error) => {
                let error = error.to_string();
                prop_assert!(!fits, "{}\n{}", error, text);
                let named = ModelParameters::KEYS.iter().any(|key| {
                    let wrong = chosen.contains(key) != needs.contains(key);
                    wrong && error.starts_with(&format!("models[1].{odd}_{key}: "))
                });
                prop_assert!(named, "{}", error);
            }
        }
    }
}

/// Of payload and stage, whatever is wrong with the parameters of a model is told as separations tell it.
#[test]
fn messages_are_those_of_separations() {
    let separation = Scenario::peck_2003().unwrap().to_toml();
    let (head, _) = separation.split_once("[[models]]").unwrap();
    let table: Table = toml::from_str(&separation).unwrap();
    let mut simulator: Table = toml::from_str(&uniform()).unwrap();
    simulator.insert("bodies".to_owned(), bodies_of(&table));
    let folder = folder();
    let principal = "name = \"proposed\"\nlaw = \"principal\"\naxes = \"whole-sphere\"";
    for [law, fields, _] in wrong_parameters() {
        let models = format!(
            "[[models]]\n{principal}\n[[models]]\nname = \"naive\"\nlaw = \"{law}\"\n{fields}\n"
        );
        let of_separation = Scenario::from_toml(&format!("{head}{models}")).unwrap_err();
        let own = toml::to_string(&simulator).unwrap() + "\n" + &models;
        let refused = SimulatorScenario::from_toml(&own, folder.path()).unwrap_err().to_string();
        // Lines are others.
        let without_line = |message: String| message.split(" (line ").next().unwrap().to_owned();
        assert_eq!(without_line(refused), without_line(of_separation.to_string()), "{models}");
    }
    let with = |models: &str| {
        let text = HEAD.to_owned() + &body("hub") + models;
        SimulatorScenario::from_toml(&text, folder.path()).unwrap_err().to_string()
    };
    let nobody = with(&model(ModelKind::Wishart, "hubb_delta = 0.1"));
    assert_eq!(nobody, "models[1].hubb_delta: there is no body \"hubb\": the bodies are hub");
    let unknown = with(&model(ModelKind::Wishart, "hub_gamma = 0.1"));
    assert!(unknown.starts_with("models[1].hub_gamma: unknown field"), "{unknown}");
    assert!(unknown.contains("`<body>_delta`") && !unknown.contains("payload"), "{unknown}");
    let outside = with("\n[[models]]\nname = \"own\"\nlaw = \"outside\"\n");
    assert!(outside.starts_with("models[1].law: "), "{outside}");
}

/// Bodies without models are drawn by the principal law about the whole sphere, and what is resolved says so.
#[test]
fn bodies_have_a_model_if_none_is_given() {
    let folder = folder();
    let gaussian =
        body("b").replace("axes = \"fixed\"", &format!("axes_covariance = {}", diagonal(4, 1e-3)));
    let uniform = body("c").replace("fixed", "uniform");
    for bodies in [body("a"), gaussian.clone(), uniform.clone(), body("a") + &gaussian + &uniform] {
        let text = HEAD.to_owned() + &bodies;
        let bare = scenario(&text, folder.path());
        let said =
            "\n[[models]]\nname = \"principal\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n";
        assert!(bare.to_toml().ends_with(said), "{}", bare.to_toml());
        let told = scenario(&(text + said), folder.path());
        assert_eq!(bare.to_toml(), told.to_toml());
        assert_eq!(drawn(&bare, 0), drawn(&told, 0));
    }
}

/// How roots and axes scatter need be said only where a model draws them, which is then told of; what is left out changes no
/// draw, and stays out of what is resolved.
#[test]
fn only_principal_models_need_roots_and_axes() {
    let folder = folder();
    let bare = "mass_kg = 120.0\ninertia_kg_m2 = [[21.0, 0.2, -0.1], [0.2, 19.0, 0.3], [-0.1, 0.3, 26.0]]\n";
    let roots = "root_second_moment_variance_kg_m2 = [0.001, 0.001, 0.001]\n";
    let parts = ["", "mass_kg = 2.0\n", roots, "axes = \"fixed\"\n", "axes = \"uniform\"\n"];
    let with = |dispersion: &str, models: &str| {
        let table = if dispersion.is_empty() { "" } else { "\n[bodies.dispersion]\n" };
        format!("{HEAD}\n[[bodies]]\nname = \"b\"\n{bare}{table}{dispersion}{models}")
    };
    for kind in ModelKind::ALL {
        let fields = parameters(kind, "b");
        let axes = if kind == ModelKind::Principal { "axes = \"whole-sphere\"" } else { &fields };
        let alone = model(kind, axes);
        let principal =
            "\n[[models]]\nname = \"proposed\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n";
        let both = principal.to_owned() + &alone;
        for (i, dispersion) in parts.iter().enumerate() {
            let of_mass = drawn_inertias(&scenario(
                &with(&(roots.to_owned() + "axes = \"fixed\"\n"), &alone),
                folder.path(),
            ));
            let text = with(dispersion, &alone);
            if kind == ModelKind::Principal {
                let refused = SimulatorScenario::from_toml(&text, folder.path()).unwrap_err();
                let key =
                    if i == 2 { "axes_covariance" } else { "root_second_moment_variance_kg_m2" };
                assert!(
                    refused.to_string().contains(&format!("bodies[1].dispersion.{key}: missing")),
                    "{refused}"
                );
                continue;
            }
            let less = scenario(&text, folder.path());
            assert_eq!(less.to_toml().contains("variance_kg_m2"), i == 2, "{}", less.to_toml());
            assert_eq!(drawn_inertias(&less), of_mass, "{kind} {dispersion}");
            let refused = SimulatorScenario::from_toml(&with(dispersion, &both), folder.path());
            assert!(
                refused.unwrap_err().to_string().contains(": missing: "),
                "{kind} {dispersion}"
            );
        }
    }
    // What is said must be right all the same.
    let wishart = model(ModelKind::Wishart, "b_delta = 0.01");
    for (wrong, key) in [
        ("roots = \"uniform\"", "root_second_moment_variance_kg_m2"),
        (
            "root_second_moment_variance_kg_m2 = [-1.0, 0.0, 0.0]",
            "root_second_moment_variance_kg_m2",
        ),
        (
            "axes = \"fixed\"\naxes_covariance = [[0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]]",
            "axes_covariance",
        ),
    ] {
        let refused = SimulatorScenario::from_toml(&with(wrong, &wishart), folder.path());
        let refused = refused.unwrap_err().to_string();
        assert!(refused.contains(&format!("bodies[1].dispersion.{key}")), "{refused}");
    }
}

/// What the first model draws of inertias.
fn drawn_inertias(scenario: &SimulatorScenario) -> Vec<(String, Vec<Option<u64>>)> {
    drawn(scenario, 0).into_iter().filter(|(name, _)| name.contains("_i")).collect()
}
