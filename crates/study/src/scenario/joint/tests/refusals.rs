//! What of the joint law of a body is refused, by its key.

use super::*;
use crate::scenario::tests::cases;

#[test]
fn what_contradicts_itself_is_named() {
    let lengths = "gyration_lengths_m = [0.01, 0.01, 0.01]\n";
    let roots = "root_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]\n";
    let fixed = "axes = \"fixed\"\n";
    let small = "ellipsoid = { middle_m = [0.0, 0.0, 0.0], semi_axes_m = [0.1, 0.1, 0.1] }";
    for [dispersion, expected] in cases(
        r#"
        LENGTHS FIXED ROOTS | root_second_moment_variance_kg_m2: there is
        LENGTHS FIXED roots = "gaussian" | roots: there is payload.dispersion.gyr
        LENGTHS FIXED mass_kg = 1.0\ninertia_follows_mass = 0.5 | inertia_follows_mass: there
        LENGTHS FIXED mass_kg = 1.0\ninertia_follows_mass = false | inertia_follows_mass: there
        gyration_lengths_m = [-0.01, 0.01, 0.01]\nFIXED | gyration_lengths_m[1]: -0.01
        gyration_lengths_m = [{ law = "uniform", low = 1.0 }, 0.01, 0.01]\nFIXED | gyration_lengths_m[1].high
        gyration_lengths_m = [0.01, 0.01]\nFIXED | gyration_lengths_m
        LENGTHS FIXED inside = { SMALL } | inside: region: 0 of 20000 trial draws
        LENGTHS FIXED inside = { ellipsoid = { middle_m = [0.0, 0.0, 0.0], semi_axes_m = [0.1, 0.1, -0.1] } } | inside:
        LENGTHS FIXED inside = { sphere = { radius_m = 1.0 } } | inside: unknown field `sphere`
        LENGTHS FIXED inside = { SMALL, hull = { points_m = [] } } | inside: there must be exactly one
        LENGTHS FIXED inside = { hull = { points_m = [] } } | inside:
        LENGTHS FIXED inside = { box = { middle_m = [0.0, 0.0, 0.0], half_sides_m = [1.0, 1.0, 1.0], colour = 1 } } | inside: box.colour: unknown field `colour`
        "#,
    ) {
        let tokens = [("LENGTHS", lengths), ("FIXED", fixed), ("ROOTS", roots), ("SMALL", small)];
        let said = tokens.iter().fold(dispersion, |said, (token, text)| said.replace(token, text));
        let message = refusal(&format!("[payload.dispersion]\n{said}\n"), "");
        let expected = format!("payload.dispersion.{expected}");
        assert!(message.starts_with(&expected), "{message}\n{expected}");
    }
    // What names no number, or none of the body's own.
    let correlated =
        |names: &str| format!("[[correlations]]\nbetween = [{names}]\ncoefficient = 0.5\n");
    let message = refusal(
        &format!("[payload.dispersion]\n{lengths}{fixed}"),
        &correlated("\"payload_gyration_length_1_m\", \"payload_root_1_sqrt_kg_m\""),
    );
    assert!(message.contains("payload_gyration_length_3_m, stage_root_1_sqrt_kg_m"), "{message}");
    // Two bodies in regions that depend on each other, and draws for vehicles and flights.
    let wide =
        "inside = { ellipsoid = { middle_m = [0.0, 0.0, 0.0], semi_axes_m = [3.0, 3.0, 3.0] } }\n";
    let both = |rest: &str| {
        text(&format!("[payload.dispersion]\n{lengths}{fixed}{wide}mass_kg = 1.0\n"), rest)
            .replace("[stage.dispersion]\n", &format!("[stage.dispersion]\n{wide}"))
    };
    let names = correlated("\"payload_mass_kg\", \"stage_mass_kg\"");
    assert!(Scenario::from_toml(&both("")).is_ok());
    let message = Scenario::from_toml(&both(&names)).unwrap_err().to_string();
    assert!(message.starts_with("stage.dispersion.inside: "), "{message}");
    let fleet = |drawn: &str| {
        let payload = format!(
            "[payload.dispersion]\n{lengths}{fixed}{wide}inertia_drawn = \"vehicle\"\n\
             mass_kg = {{ sigma = 1.0, drawn = \"{drawn}\" }}\n"
        );
        text(&payload, "").replace("runs = 50", "vehicles = 5\nflights = 10")
    };
    let message = Scenario::from_toml(&fleet("flight")).unwrap_err().to_string();
    assert!(message.starts_with("payload.dispersion.inside: \"payload_mass_kg\""), "{message}");
    let scenario = Scenario::from_toml(&fleet("vehicle")).unwrap();
    let drawn = bodies(&scenario, 0, 50);
    assert!((0..50).all(|run| (drawn[run] == drawn[0]) == (run < 10)));
}

#[test]
fn a_whole_law_stands_alone() {
    let sizes = [0, 1, 2].map(|i| scalar(0, lengths()[i], 0.01));
    let centre = [0, 1, 2].map(|_| scalar(0, 0.0, 0.01));
    let law = TensorLaw::gyration_lengths(sizes, fixed_axes());
    let law = MassPropertiesLaw::new(scalar(0, MASS, 3.0), centre, law).unwrap();
    let resolved = with_law(&law, "").to_toml();
    let mut table: toml::Table = toml::from_str(&resolved).unwrap();
    for (key, value) in [
        ("roots", "\"gaussian\""),
        ("root_second_moment_variance_kg_m2", "[1.0, 1.0, 1.0]"),
        ("gyration_lengths_m", "[0.1, 0.1, 0.1]"),
        ("axes", "\"fixed\""),
        ("inside", "{ hull = { points_m = [[0.0, 0.0, 0.0]] } }"),
        ("mass_kg", "1.0"),
        ("mass_percent", "1.0"),
        ("inertia_follows_mass", "false"),
        ("mass_centre_m", "0.01"),
    ] {
        let mut table = table.clone();
        let own: toml::Table = toml::from_str(&format!("{key} = {value}")).unwrap();
        table["payload"]["dispersion"] = toml::Value::Table(own);
        let message =
            Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap_err().to_string();
        assert!(
            message.starts_with(&format!("payload.dispersion.{key}: there is payload.law")),
            "{message}"
        );
    }
    // What else is uncertain goes with it, and what is wrong in it is named.
    table["payload"]["dispersion"] =
        toml::from_str::<toml::Table>("velocity_m_per_s = 0.01").unwrap().into();
    assert!(Scenario::from_toml(&toml::to_string(&table).unwrap()).is_ok());
    table["payload"]["law"]["mass_kg"] =
        toml::from_str::<toml::Table>("sigma = 1.0\nmean = -5.0").unwrap().into();
    let message = Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap_err().to_string();
    assert!(message.starts_with("payload.law: mass with the mean -5.0"), "{message}");
    table["payload"]["law"]["mass_kg"] =
        toml::from_str::<toml::Table>("sigma = 1.0\nmeen = 5.0").unwrap().into();
    let message = Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap_err().to_string();
    assert!(message.starts_with("payload.law: mass_kg: ") && message.contains("meen"), "{message}");
}
