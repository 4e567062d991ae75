//! Tests of scenario files: what they give, and what is refused.

use super::*;

/// The cases of a table, one a line, whose parts stand between bars; in them `\n` begins a line.
pub(crate) fn cases<const N: usize>(table: &str) -> impl Iterator<Item = [String; N]> {
    table.trim().lines().map(|line| {
        let parts = line.split('|').map(|part| part.trim().replace("\\n", "\n"));
        parts.collect::<Vec<_>>().try_into().unwrap_or_else(|_| panic!("{line}"))
    })
}

fn error(from: &str, to: &str) -> String {
    assert!(PECK_2003.contains(from), "nothing to replace: {from}");
    Scenario::from_toml(&PECK_2003.replacen(from, to, 1)).unwrap_err().to_string()
}

#[test]
fn the_built_in_scenario_is_the_papers() {
    let s = Scenario::peck_2003().unwrap();
    assert_eq!((s.name(), s.runs(), s.seed()), ("peck-2003", 2000, 2003));
    let names: Vec<&str> = s.model_names().collect();
    assert_eq!(names, ["proposed", "published", "naive", "naive-matched"]);
    assert!((s.separation().stored_energy() - 1300.0).abs() < 1e-9);
    assert!((s.separation().release_lengths().next().unwrap() - 0.3).abs() < 1e-15);
}

#[test]
fn directions_and_outlines_are_read_resolved_and_checked() {
    let outlines = "[clearance]\npayload = [{ hull_m = [[0.0, 0.0, -0.5], [0.5, 0.0, -0.5]] }]\n\
                        stage = [{ ring = { centre_m = [0.0, 0.0, 0.4], axis = [0.0, 1.0, 7.0], \
                        radius_m = 0.3 } }, { points_m = [[0.0, 0.0, 0.3]] }]\n";
    let text = PECK_2003.replacen("[payload]", &format!("{outlines}\n[payload]"), 1);
    let text = text.replacen(
            "spin_axis",
            "separation_direction = [0.1, 0.0, 3.0]\nmomentum_direction = [1e300, 1e299, 0.0]\nspin_axis",
            1,
        );
    let resolved = round_trip(&text);
    assert!(resolved.contains("coast_s = 60.0"), "{resolved}");
    assert!(Scenario::from_toml(&text).unwrap().outlines().is_some());
    let many = format!("{}]", "[0.0, 0.0, 0.3],".repeat(1001));
    let error = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        Scenario::from_toml(&text.replacen(from, to, 1)).unwrap_err().to_string()
    };
    for [from, to, expected] in cases(
        r#"
        [0.1, 0.0, 3.0] | [0.0, 0.0, 0.0] | separation_direction: [0.0, 0.0, 0.0]: it must
        [1e300, 1e299, 0.0] | [nan, 1.0, 0.0] | momentum_direction: [NaN, 1.0, 0.0]
        radius_m = 0.3 | radius_m = -0.3 | clearance.stage[1].ring.radius_m: 
        radius_m = 0.3 | radius_m = nan | clearance.stage[1].ring.radius_m: ring radius = NaN m: it must
        [0.0, 1.0, 7.0] | [0.0, 0.0, 0.0] | clearance.stage[1].ring.axis: ring axis of length 0.0: it
        [0.5, 0.0, -0.5] | [nan, 0.0, 0.0] | clearance.payload[1].hull_m: hull_m has coordinate NaN m
        [0.5, 0.0, -0.5] | [0.0, 1e300, 0.0] | clearance.payload[1].hull_m[2]: 1e300 m from the mass centre: it must be at most 10000.0 m
        points_m = [[0.0, 0.0, 0.3]] | points_m = [] | clearance.stage[2].points_m: points_m is empty
        [0.0, 0.0, 0.3]] | MANY | clearance.stage[2].points_m: 1001 points in an outline: at most
        payload = [{ hull_m = [[0.0, 0.0, -0.5], [0.5, 0.0, -0.5]] }] | payload = [] | clearance.payload: outline is empty
        [clearance]\n | [clearance]\ncoast_s = 0.0\n | clearance.coast_s: 0.0: it must
        [clearance]\n | [clearance]\ncoast_s = nan\n | clearance.coast_s: NaN
        "#,
    ) {
        let message = error(&from, &to.replace("MANY", &many));
        assert!(message.starts_with(&expected), "{message}");
    }
    // The paper's springs push along z, and its payload is to spin about inertial x.
    let paper = Scenario::peck_2003().unwrap();
    assert_eq!(paper.separation_direction(), Some(&Vector3::z_axis()));
    assert_eq!(paper.momentum_direction(), &Vector3::x_axis());
    assert!(paper.outlines().is_none());
}

/// Two springs in a V: alike they push straight up; friction takes from the force of one.
#[test]
fn springs_push_with_what_friction_leaves() {
    let at = PECK_2003.find("[[springs]]").unwrap();
    let models = PECK_2003.find("# The law as derived").unwrap();
    let spring = |x: f64, friction: f64| {
        format!(
            "[[springs]]\nstiffness_n_per_m = 1e4\nstroke_m = 0.1\nfriction_n = {friction:?}\n\
                 payload_point_m = [{x:?}, 0.0, -0.9]\nstage_point_m = [0.0, 0.0, 0.9]\n\n"
        )
    };
    let direction = |friction: f64| {
        let springs = spring(0.2, friction) + &spring(-0.2, 0.0);
        let text = format!("{}{springs}{}", &PECK_2003[..at], &PECK_2003[models..]);
        *Scenario::from_toml(&text).unwrap().separation_direction().unwrap().as_ref()
    };
    assert!((direction(0.0) - Vector3::z()).norm() < 1e-15);
    // Forces of 600 and 1000 N: (−400, 1600)/√2.
    let expected = Vector3::new(-1.0, 0.0, 4.0).normalize();
    assert!((direction(400.0) - expected).norm() < 1e-14, "{}", direction(400.0));
    // One that cannot overcome its friction does not push.
    let expected = Vector3::new(-1.0, 0.0, 1.0).normalize();
    assert!((direction(1e4) - expected).norm() < 1e-14, "{}", direction(1e4));
}

#[test]
fn a_spin_axis_of_any_length_is_a_direction() {
    for length in ["1e300", "1e-300", "7.0"] {
        let text = PECK_2003.replace("spin_axis = [1.0,", &format!("spin_axis = [{length},"));
        assert_eq!(Scenario::from_toml(&text).unwrap().spin_axis(), &Vector3::x_axis());
    }
}

#[test]
fn the_resolved_scenario_reads_back_the_same() {
    let s = Scenario::peck_2003().unwrap();
    let text = s.to_toml();
    for default in ["velocity_m_per_s", "body_to_inertial", "relative_tolerance", "horizon_s"] {
        assert!(text.contains(default), "{default} is not spelled out");
    }
    let again = Scenario::from_toml(&text).unwrap();
    assert_eq!(again.to_toml(), text);
    assert_eq!(again.fingerprint(), s.fingerprint());
    assert_ne!(s.clone().with_seed(7).unwrap().fingerprint(), s.fingerprint());
}

#[test]
fn bad_values_name_the_field_the_value_and_what_is_allowed() {
    for [from, to, expected] in cases(
        r#"
        runs = 2000 | runs = 0 | runs: 0: it must be between 1
        mass_kg = 10000.0 | mass_kg = 1.0\nmass_kg = 2.0 | mass_kg: the key stands there twice (line
        mass_kg = 10000.0 | mass_kg = -3.0 | payload.mass_kg: mass = -3.0 kg: it must be pos
        mass_kg = 10000.0 | mass_kg = nan | payload.mass_kg: mass = NaN kg
        [[5000.0, 20.0, 2.0] | [[9000.0, 20.0, 2.0] | payload.inertia_kg_m2: no body has
        [[5000.0, 20.0, 2.0] | [[5000.0, 21.0, 2.0] | payload.inertia_kg_m2: I12 = 21.0 kg
        [2e-5, 0.0, | [-2e-5, 0.0, | payload.dispersion.axes_covariance: covariance with
        [0.125, 0.1, | [0.125, -0.1, | root_second_moment_variance_kg_m2: variance of k_2
        stiffness_n_per_m = 1e5 | stiffness_n_per_m = 0.0 | springs[1].stiffness_n_per_m: stiffness = 0.0 N/m
        stroke_m = 0.1 | stroke_m = inf | springs[1].stroke_m: inf: it must be at most 1e3
        stage_point_m = [1.0, | stage_point_m = [nan, | springs[1].stage_point_m: stage attachment point has entry NaN
        stroke_m = 0.1 | stroke_m = 0.1\nstart_s = -1.0 | springs[1].start_s: start = -1.0 s
        spin_axis = [1.0, | spin_axis = [0.0, | spin_axis: [0.0, 0.0, 0.0]: it must be
        name = "peck-2003" | name = "../peck" | name: "../peck": it must be 1 to 64
        name = "published" | name = "proposed" | models[2].name: two are named "proposed"
        axes = "whole-sphere" |  | models[1].axes: missing: law "principal" needs axes
        axes = "whole-sphere" | axes = 1.5 | models[1].axes: invalid type: floating point `1.5`, expected one of "whole-sphere", "mean-half"
        seed = 2003 | seed = 2003\nrows = 2 | rows: invalid type: integer `2`, expected one of "all", "failed", "none"
        seed = 2003 | seed = 2003\nauthor = 12:30:00 | author: 12:30:00 is a date or a time
        seed = 2003 | seed = 12:30:00 | seed: 12:30:00 is a date or a time
        name = "peck-2003" | name = "Nul" | name: "Nul": it names a folder, and Windows reserves this name
        name = "peck-2003" | name = "lpt9" | name: "lpt9": it names a folder, and Windows reserves this name
        matched_to = "proposed" | matched_to = "naive" | models[4].matched_to
        physical = "published" | physical = "none" | comparisons[1].physical: "none"
        physical = "published" | physical = "naive" | comparisons[1].physical: "naive"
        naive = "naive" | naive = "proposed" | comparisons[1].naive: "proposed"
        name = "published" | name = "Proposed" | models[2].name: two are named "Proposed"
        [source] | [integration]\nhorizon_s = -1e300\n[source] | integration.horizon_s: horizon = -1e300 s: it must be positive and finite
        [source] | [integration]\nrelative_tolerance = nan\n[source] | integration.relative_tolerance: relative tolerance = NaN
        wobble_deg = 1.144 | wobble_deg = nan | source.wobble_deg: NaN
        spin_axis = [1.0, | spin_axis = [nan, | spin_axis: [NaN, 0.0, 0.0]
        "#,
    ) {
        let message = error(&from, &to);
        assert!(message.contains(&expected), "{message}");
    }
}

const VARIANCE: &str = "root_second_moment_variance_kg_m2 = [0.125, 0.1, 0.075]";

fn covariance(size: usize, variance: f64) -> String {
    let row = |i: usize| {
        let entry = |j: usize| if i == j { format!("{variance:e}") } else { "0.0".to_owned() };
        format!("[{}]", (0..size).map(entry).collect::<Vec<_>>().join(", "))
    };
    format!("[{}]", (0..size).map(row).collect::<Vec<_>>().join(", "))
}

/// The resolved scenario says the same again, and its models can be made.
fn round_trip(text: &str) -> String {
    let s = Scenario::from_toml(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let resolved = s.to_toml();
    let again = Scenario::from_toml(&resolved).unwrap_or_else(|e| panic!("{e}\n{resolved}"));
    assert_eq!(again.to_toml(), resolved);
    crate::model::Model::all(&s).unwrap_or_else(|e| panic!("{e}\n{text}"));
    resolved
}

#[test]
fn every_law_of_roots_and_axes_can_be_written() {
    let rcg = &PECK_2003[PECK_2003.find("axes_covariance").unwrap()..];
    let rcg = &rcg[..rcg.find("\n]\n").unwrap() + 3];
    let roots = [
        ("gaussian", VARIANCE.to_owned()),
        ("uniform", VARIANCE.to_owned()),
        ("lognormal", VARIANCE.to_owned()),
        (
            "correlated-gaussian",
            format!("root_second_moment_covariance_kg_m2 = {}", covariance(3, 0.1)),
        ),
        (
            "truncated-gaussian",
            format!(
                "{VARIANCE}\nroot_second_moment_bounds_sqrt_kg_m = [[30.0, 33.0], [0.0, inf], [-inf, inf]]"
            ),
        ),
        (
            "empirical",
            "root_second_moment_samples_sqrt_kg_m = [[31.0, 44.0, 54.0], [32.0, 45.0, 55.0]]"
                .to_owned(),
        ),
    ];
    for (law, fields) in &roots {
        for (axes, covariance) in
            [("radially-constrained-gaussian", rcg), ("uniform", ""), ("fixed", "")]
        {
            // The naive model is then matched to each.
            let text = PECK_2003
                .replacen(VARIANCE, &format!("roots = \"{law}\"\n{fields}\naxes = \"{axes}\""), 1)
                .replacen(rcg, covariance, 1);
            let text = if axes == "radially-constrained-gaussian" {
                text
            } else {
                text.replace("axes = \"jacobian-twice\"", "axes = \"whole-sphere\"")
            };
            let resolved = round_trip(&text);
            assert!(resolved.contains(&format!("roots = \"{law}\"")), "{resolved}");
            assert!(resolved.contains(&format!("axes = \"{axes}\"")), "{resolved}");
        }
    }
    // What is not said is spelled out.
    let resolved = round_trip(PECK_2003);
    assert!(resolved.contains("roots = \"gaussian\""), "{resolved}");
    assert!(resolved.contains("axes = \"radially-constrained-gaussian\""), "{resolved}");
}

/// A scenario with one more model.
fn with_model(law: &str, fields: &str) -> String {
    let at = PECK_2003.find("[[comparisons]]").unwrap();
    let (head, tail) = PECK_2003.split_at(at);
    format!("{head}[[models]]\nname = \"other\"\nlaw = \"{law}\"\n{fields}\n\n{tail}")
}

#[test]
fn every_model_can_be_written() {
    let both =
        |field: &str, value: &str| format!("payload_{field} = {value}\nstage_{field} = {value}");
    let deviations = both("deviation_kg_m2", &covariance(3, 10.0));
    let entries = both("covariance_kg2_m4", &covariance(6, 100.0));
    let basilisk =
        both("diagonal_deviation_kg_m2", "50.0") + "\n" + &both("angle_deviation_rad", "0.02");
    let bounded = basilisk.clone() + "\n" + &both("diagonal_bounds_kg_m2", "[-100.0, 100.0]");
    let cases = [
        ("principal", "axes = \"mean-half\"".to_owned()),
        ("entrywise", deviations.clone()),
        ("realizable-entrywise", deviations),
        ("correlated-entries", entries.clone()),
        ("realizable-correlated-entries", entries),
        ("log-cholesky", both("log_cholesky_covariance", &covariance(6, 1e-4))),
        ("wishart", both("delta", "0.05")),
        ("basilisk", basilisk),
        ("basilisk", bounded),
    ];
    for (law, fields) in cases {
        let resolved = round_trip(&with_model(law, &fields));
        if law == "basilisk" {
            assert!(resolved.contains("payload_diagonal_bounds_kg_m2"), "{resolved}");
        }
    }
    for kind in gyradius_dispersion::ModelKind::ALL.into_iter().skip(1) {
        // Making the published law takes a while: one model matched to it will do.
        let wishart = kind == gyradius_dispersion::ModelKind::Wishart;
        for to in if wishart { &["proposed", "published"][..] } else { &["proposed"] } {
            let matched = format!("matched_to = \"{to}\"");
            // The stage has two equal moments, which Basilisk's small turns need not reach.
            let text = with_model(kind.name(), &matched);
            let s = Scenario::from_toml(&text).unwrap();
            assert_eq!(Scenario::from_toml(&s.to_toml()).unwrap().to_toml(), s.to_toml());
            if let Err(error) = crate::model::Model::all(&s) {
                assert!(error.to_string().starts_with("models.other: basilisk:"), "{error}");
            }
        }
    }
}

/// Of every kind of model, with every subset of the parameters that there are for either body: a scenario takes it if the
/// subset has what the kind needs and nothing that it does not take, says again what it was given with the defaults
/// filled in, and else names a key that is missing or too much.
#[test]
fn a_model_takes_what_its_kind_takes() {
    use gyradius_dispersion::{ModelKind, ModelParameters};
    let value = |key: &str| match key {
        "deviation_kg_m2" => covariance(3, 10.0),
        "covariance_kg2_m4" => covariance(6, 100.0),
        "log_cholesky_covariance" => covariance(6, 1e-4),
        "diagonal_bounds_kg_m2" => "[-100.0, 100.0]".to_owned(),
        _ => "0.05".to_owned(),
    };
    let keys = ModelParameters::KEYS;
    for kind in ModelKind::ALL {
        let (needs, defaults) = (kind.needs(), kind.defaults());
        let takes = |key: &str| needs.contains(&key) || defaults.given().any(|k| k == key);
        for subset in 0..1_u32 << keys.len() {
            let chosen: Vec<&str> =
                (0..keys.len()).filter(|i| subset & (1 << i) != 0).map(|i| keys[i]).collect();
            // All of them for one body, and then for the other only what is needed.
            let lines = |body: &str, keys: &[&str]| -> String {
                keys.iter().map(|key| format!("{body}_{key} = {}\n", value(key))).collect()
            };
            let [payload, stage] =
                if subset % 2 == 0 { ["payload", "stage"] } else { ["stage", "payload"] };
            let fields = lines(payload, &chosen) + &lines(stage, needs);
            let axes = if kind == ModelKind::Principal { "axes = \"mean-half\"" } else { "" };
            let text = with_model(kind.name(), &format!("{fields}{axes}"));
            let fits = needs.iter().all(|k| chosen.contains(k)) && chosen.iter().all(|k| takes(k));
            match Scenario::from_toml(&text) {
                Ok(scenario) => {
                    assert!(fits, "{text}");
                    let resolved = scenario.to_toml();
                    let last = resolved.split("[[models]]").last().unwrap();
                    for body in [payload, stage] {
                        for key in keys {
                            let there = last.contains(&format!("{body}_{key} = "));
                            assert_eq!(there, takes(key), "{body}_{key} in {last}");
                        }
                    }
                    assert_eq!(Scenario::from_toml(&resolved).unwrap().to_toml(), resolved);
                }
                Err(error) => {
                    assert!(!fits, "{error}\n{text}");
                    let error = error.to_string();
                    let named = keys.iter().any(|key| {
                        let wrong = chosen.contains(key) != needs.contains(key);
                        wrong && error.starts_with(&format!("models[5].{payload}_{key}: "))
                    });
                    assert!(named, "{error}");
                }
            }
        }
    }
}

/// Laws with parameters of which one is wrong, and what is told of it if they are of the fifth model; a key that begins with a
/// star is of payload and stage.
pub(crate) fn wrong_parameters() -> impl Iterator<Item = [String; 3]> {
    let fields = |[law, fields, expected]: [String; 3]| {
        let mut text = String::new();
        for field in fields.split("; ") {
            for body in
                ["payload", "stage"].into_iter().take(1 + usize::from(field.starts_with('*')))
            {
                text += &(field.replacen('*', body, 1) + "\n");
            }
        }
        for (name, size, value) in
            [("NARROW", 3, 1.0), ("NONE", 3, -1.0), ("NO_ENTRIES", 6, -1.0), ("WIDE", 6, 100.0)]
        {
            text = text.replace(name, &covariance(size, value));
        }
        [law, text, expected]
    };
    let cases = cases(
        r#"
        wishart | *_delta = 1.5 | models[5].payload_delta: dispersion δ = 1.5
        wishart | *_delta = nan | models[5].payload_delta: dispersion δ = NaN
        wishart | *_delta = [1.0] | models[5].payload_delta: invalid type
        wishart | payload_delta = 0.1 | models[5].stage_delta: missing
        wishart | stage_delta = 0.1 | models[5].payload_delta: missing
        wishart | | models[5].payload_delta: missing
        wishart | *_deviation_kg_m2 = NARROW | models[5].payload_deviation_kg_m2: law "wishart" needs either payload_delta
        wishart | *_delta = 0.1; matched_to = "proposed" | models[5].payload_delta: law "wishart" needs either
        wishart | matched_to = "naive" | models[5].matched_to: "naive"
        wishart | axes = "mean-half" | models[5].axes: law "wishart"
        wishart | outside = { payload = "x" } | models[5].outside.stage: missing field
        correlated-entries | *_covariance_kg2_m4 = NO_ENTRIES | models[5].payload_covariance_kg2_m4: covariance entry (1, 1)
        realizable-entrywise | *_deviation_kg_m2 = NONE | models[5].payload_deviation_kg_m2: -1
        log-cholesky | *_log_cholesky_covariance = WIDE | models[5].payload_log_cholesky_covariance: coordinate d1
        basilisk | *_diagonal_deviation_kg_m2 = 1.0 | models[5].payload_angle_deviation_rad: missing
        basilisk | *_diagonal_deviation_kg_m2 = -1.0; *_angle_deviation_rad = 0.1 | models[5].payload_diagonal_deviation_kg_m2: diagonal deviation = -1.0
        basilisk | *_diagonal_deviation_kg_m2 = 1.0; *_diagonal_bounds_kg_m2 = [1.0, -1.0]; *_angle_deviation_rad = 0.1 | models[5].payload_diagonal_bounds_kg_m2: bounds from 1.0 to -1.0
        basilisk | *_diagonal_deviation_kg_m2 = 1.0; *_angle_deviation_rad = nan | models[5].payload_angle_deviation_rad: angle deviation = NaN
        principal | axes = "mean-half"; payload_delta = 0.1 | models[5].payload_delta: law "principal" takes axes
        principal | axes = "mean-half"; matched_to = "proposed" | models[5].matched_to: law "principal" takes axes
        principal | | models[5].axes: missing
        "#,
    );
    cases.map(fields)
}

#[test]
fn bad_parameters_of_models_are_named() {
    for [law, fields, expected] in wrong_parameters() {
        let message = Scenario::from_toml(&with_model(&law, &fields)).unwrap_err().to_string();
        assert!(message.starts_with(&expected), "{message}\nexpected {expected}");
    }
    let message = Scenario::from_toml(&with_model("naive", "")).unwrap_err().to_string();
    assert!(message.contains("naive") && message.contains("wishart"), "{message}");
}

#[test]
fn bad_dispersions_are_named() {
    for [to, expected] in cases(
        r#"
         | root_second_moment_variance_kg_m2: missing
        roots = "empirical" | root_second_moment_samples_sqrt_kg_m: missing
        roots = "empirical"\nroot_second_moment_samples_sqrt_kg_m = [[1.0, nan, 2.0]] | root_second_moment_samples_sqrt_kg_m: sample 1, k_2
        roots = "correlated-gaussian"\nVARIANCE | root_second_moment_variance_kg_m2: roots = "correlated-gaussian" does not take it
        roots = "truncated-gaussian"\nVARIANCE | root_second_moment_bounds_sqrt_kg_m: missing
        roots = "truncated-gaussian"\nVARIANCE\nroot_second_moment_bounds_sqrt_kg_m = [[0.0, 1.0], [0.0, 1.0], [0.0, 1.0]] | root_second_moment_bounds_sqrt_kg_m: k_1
        VARIANCE\naxes = "uniform" | axes_covariance: axes = "uniform"
        "#,
    ) {
        let message = error(VARIANCE, &to.replace("VARIANCE", VARIANCE));
        let expected = format!("payload.dispersion.{expected}");
        assert!(message.starts_with(&expected), "{message}\n{expected}");
    }
    let message = error(VARIANCE, &format!("{VARIANCE}\nroots = \"normal\""));
    assert!(message.contains("normal") && message.contains("lognormal"), "{message}");
    // No half of the sphere to keep to.
    let rcg = &PECK_2003[PECK_2003.find("axes_covariance").unwrap()..];
    let rcg = &rcg[..rcg.find("\n]\n").unwrap() + 3];
    let message = error(rcg, "axes = \"fixed\"\n");
    assert!(message.starts_with("models[2].axes: only \"whole-sphere\""), "{message}");
}

#[test]
fn touching_pads_are_refused_and_explained() {
    let text = PECK_2003.replace("-0.9]", "-1.0]").replace(", 0.9]", ", 1.0]");
    let message = Scenario::from_toml(&text).unwrap_err().to_string();
    assert!(
        message.starts_with("springs[1].payload_point_m: spring 1: its points are"),
        "{message}"
    );
    assert!(message.contains("apart"), "{message}");
}

#[test]
fn unknown_keys_and_bad_toml_are_refused_with_their_place() {
    let message = error("mass_kg = 10000.0", "mass_kg = 10000.0\nmas_kg = 1.0");
    assert!(message.contains("unknown field `mas_kg`") && message.contains("line"), "{message}");
    let message = error("runs = 2000", "runs = ");
    assert!(message.contains("line 3"), "{message}");
    assert!(error("runs = 2000", "runs = -5").contains("runs"));
    assert!(error("runs = 2000", "runs = \"many\"").contains("runs"));
    assert!(Scenario::from_toml("").unwrap_err().to_string().contains("name"));
}

#[test]
fn seeds_and_runs_are_checked_by_every_way_in() {
    let s = Scenario::peck_2003().unwrap();
    assert!(s.clone().with_runs(0).is_err());
    assert!(s.clone().with_runs(u64::MAX).is_err());
    assert!(s.with_seed(u64::MAX).is_err());
}

/// Just what is allowed is read, and a little more is refused, with the key and the limit.
#[test]
fn scenarios_have_limits() {
    let check = |text: &str, allowed: bool, expected: &str| match Scenario::from_toml(text) {
        Ok(_) => assert!(allowed, "{expected}"),
        Err(error) => {
            let message = error.to_string();
            assert!(!allowed && message.starts_with(expected), "{message}\n{expected}");
        }
    };
    let springs = PECK_2003.find("[[springs]]").unwrap();
    let models = PECK_2003.find("[[models]]").unwrap();
    let first = PECK_2003[springs..models].split("[[springs]]").nth(1).unwrap();
    for (count, allowed) in [(1, true), (299, true), (300, true), (301, false), (5000, false)] {
        let all = format!("[[springs]]{first}\n").repeat(count);
        let text = format!("{}{all}{}", &PECK_2003[..springs], &PECK_2003[models..]);
        check(&text, allowed, &format!("springs: {count} of them: at most 300"));
    }
    for (count, allowed) in [(1, true), (100, true), (101, false)] {
        let model = |i: usize| {
            format!("[[models]]\nname = \"m{i}\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n")
        };
        let text = PECK_2003[..models].to_owned() + &(0..count).map(model).collect::<String>();
        check(&text, allowed, &format!("models: {count} of them: at most 100"));
    }
    for axis in 0..3 {
        for (reach, allowed) in [(1e4, true), (-1e4, true), (10_000.5, false), (-1e6, false)] {
            let (mut point, mut centre) = ([0.0; 3], [0.0; 3]);
            point[axis] = reach;
            // A ring reaches farther than its centre.
            centre[axis] = reach - 0.25 * f64::signum(reach);
            let ring =
                format!("{{ centre_m = {centre:?}, axis = [0.0, 0.0, 1.0], radius_m = 0.25 }}");
            for (key, shape) in [
                ("points_m[1]", format!("points_m = [{point:?}]")),
                ("hull_m[2]", format!("hull_m = [[0.0, 0.0, 0.1], {point:?}]")),
                ("ring.centre_m", format!("ring = {ring}")),
            ] {
                let outlines = format!(
                    "[clearance]\npayload = [{{ points_m = [[0.0, 0.0, -0.1]] }}]\nstage = [{{ {shape} }}]\n"
                );
                let text = PECK_2003.replacen("[payload]", &format!("{outlines}\n[payload]"), 1);
                check(&text, allowed, &format!("clearance.stage[1].{key}: "));
            }
        }
    }
}
