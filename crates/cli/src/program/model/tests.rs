//! Files of statements with every key made wrong in every way.

use super::*;
use toml::{Table, Value};

const COMPLETE: &str = include_str!("../../../tests/tables/payload.toml");

/// Files that say everything there is, in every unit, and each statement alone.
fn files() -> Vec<Table> {
    let everything: Table = COMPLETE.parse().unwrap();
    let mut other = everything.clone();
    let tables = [
        ("moments", "kg_m2 = [500.0, 400.0, 300.0]\nsigmas = 3"),
        ("products", "kg_m2 = [20.0, 30.0, 40.0]\nsigmas = 2.5"),
        ("axes", "deg = [1.0, 2.0, 3.0]\nsigmas = 3\nof = \"each-axis\""),
        ("mass", "kg = 50.0\nsigmas = 1"),
        ("centre", "mm = [1.0, 2.0, 3.0]\nsigmas = 3\narm_m = [0.0, 0.1, 1.0]"),
    ];
    for (name, table) in tables {
        let table = table.parse::<Table>().unwrap();
        other.insert(name.to_owned(), table.into());
    }
    let mut total = everything.clone();
    total["axes"].as_table_mut().unwrap().insert("of".to_owned(), "total".into());
    let mut all = vec![everything, other.clone(), total];
    for (name, _) in tables {
        let alone = other.iter().filter(|(k, _)| *k == name || *k == "nominal");
        all.push(alone.map(|(k, v)| (k.clone(), v.clone())).collect());
    }
    all
}

/// What a place may become; none for it to go.
fn wrong() -> Vec<Option<Value>> {
    let list = |x: f64, n: usize| Value::Array(vec![Value::Float(x); n]);
    let mut all = vec![
        None,
        Some(true.into()),
        Some("ten".into()),
        Some(Value::Array(Vec::new())),
        Some(list(1.0, 2)),
        Some(list(1.0, 4)),
        Some(list(f64::NAN, 3)),
        Some(list(-1.0, 3)),
        Some(Table::new().into()),
        Some(Value::Integer(-1)),
        Some(Value::Integer(i64::MAX)),
    ];
    let floats = [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -1e300, 1e19, -0.5];
    all.extend(floats.map(|x| Some(Value::Float(x))));
    all
}

fn refused(file: &Table, key: &str) -> Option<String> {
    let text = toml::to_string(file).unwrap();
    let message = stated(&text).err()?;
    let digits = message.split(|c: char| !c.is_ascii_digit()).map(str::len).max();
    assert!(digits < Some(25) && message.len() < 600, "{key}: {message}");
    Some(message)
}

/// What has a default may be left out, and so may a mass that nothing needs; an arm points anywhere, and
/// the nominal mass may be huge.
fn may_be(key: &str, change: Option<&Value>) -> bool {
    match (key, change) {
        ("of" | "arm_m" | "mass_kg", None) => true,
        ("arm_m", Some(Value::Array(arm))) => arm[0].as_float() == Some(-1.0),
        ("mass_kg", Some(mass)) => {
            mass.as_float().or(mass.as_integer().map(|m| m as f64)) > Some(1e18)
        }
        _ => false,
    }
}

/// Every key with every wrong value, in every kind of file: refused, by the name of the key, with the
/// value and what is allowed.
#[test]
fn whatever_is_wrong_is_refused_by_its_key() {
    let mut count = 0;
    for file in files() {
        for (name, table) in &file {
            for key in table.as_table().unwrap().keys() {
                for change in wrong() {
                    let mut changed = file.clone();
                    let table = changed[name].as_table_mut().unwrap();
                    match &change {
                        Some(new) => drop(table.insert(key.clone(), new.clone())),
                        None => drop(table.remove(key)),
                    }
                    let told = format!("{name}.{key} = {change:?}");
                    let Some(message) = refused(&changed, &told) else {
                        assert!(may_be(key, change.as_ref()), "{told}");
                        continue;
                    };
                    count += 1;
                    let told = format!("{told}: {message}");
                    // An amount that is missing may be given in another unit.
                    let missing = change.is_none() && message.starts_with(name.as_str());
                    let named = message.starts_with(&format!("{name}.{key}"));
                    assert!(named || missing && message.contains(key.as_str()), "{told}");
                    let value = match &change {
                        Some(Value::Float(x)) => {
                            // What cannot be for this body is said as a standard deviation.
                            vec![
                                format!("{x:?}"),
                                format!("`{x:.1}`"),
                                "a standard deviation of".into(),
                            ]
                        }
                        Some(Value::String(text)) => vec![text.clone()],
                        _ => vec![String::new()],
                    };
                    assert!(value.iter().any(|value| message.contains(value)), "{told}");
                    let allowed = ["must", "expected", "missing", "needs"];
                    assert!(allowed.iter().any(|word| message.contains(word)), "{told}");
                }
            }
            let mut unknown = file.clone();
            unknown[name].as_table_mut().unwrap().insert("percents".to_owned(), 1.0.into());
            let message = refused(&unknown, name).unwrap();
            assert!(
                message.starts_with(name.as_str()) && message.contains("`percents`"),
                "{message}"
            );
            let mut twice = file.clone();
            twice.insert(name.clone(), 3.0.into());
            let message = refused(&twice, name).unwrap();
            assert!(message.starts_with(&format!("{name}: ")), "{message}");
        }
    }
    assert!(count > 1000, "{count}");
}

/// A file that states nothing, and tables that are not known.
#[test]
fn nothing_is_refused_with_what_may_be_stated() {
    for mut file in files() {
        let statements: Vec<_> = file.keys().filter(|k| *k != "nominal").cloned().collect();
        for name in statements {
            file.remove(&name);
        }
        let message = refused(&file, "nothing").unwrap();
        assert!(message.starts_with("nothing is stated") && message.contains("[products]"));
        file.insert("moment".to_owned(), Table::new().into());
        let message = refused(&file, "moment").unwrap();
        assert!(message.contains("`moment`") && message.contains("`moments`"), "{message}");
    }
}

/// Every kind of file gives one joint law of ten numbers, with the deviations that are stated of mass and mass centre and
/// those that the report gives of the inertia; and the law reads back from JSON.
#[test]
fn every_file_gives_the_joint_law() {
    for file in files() {
        let mut file = file;
        let nominal = file["nominal"].as_table_mut().unwrap();
        nominal.insert("mass_kg".to_owned(), 10000.0.into());
        let at = Value::Array([0.1, -0.2, 1.5].map(Value::Float).to_vec());
        nominal.insert("mass_centre_m".to_owned(), at);
        let text = toml::to_string(&file).unwrap();
        let told = stated(&text).unwrap();
        let body = told.body.as_ref().unwrap();
        let document: serde_json::Value = serde_json::to_value(law_json(body).unwrap()).unwrap();
        let law = &document["mass_properties_law"];
        let back: MassPropertiesLaw = serde_json::from_value(law.clone()).unwrap();
        assert_eq!(back.moments(), body.law().moments());
        let moments = body.law().moments().unwrap();
        let deviations = moments.deviations();
        let relative = told.model.mass().map_or(0.0, |mass| mass.relative_deviation());
        assert!((deviations[0] - 1e4 * relative).abs() < 1e-9 * 1e4);
        let centre = told.model.centre_deviations().unwrap_or_default();
        for i in 0..3 {
            assert!((deviations[1 + i] - centre[i]).abs() < 1e-12);
            assert!((moments.mean()[1 + i] - [0.1, -0.2, 1.5][i]).abs() < 1e-12);
        }
        let implied = told.model.implied().deviations();
        // Still axes turn by 2e-6 rad in the law of the inertia alone, which must have a density, and not in the joint law.
        let turned = if told.model.turns() == [0.0; 3] { 2e-6 * 5000.0 } else { 0.0 };
        for e in 0..6 {
            let allowed = 1e-6 * (1.0 + implied[e]) + turned;
            assert!((deviations[4 + e] - implied[e]).abs() < allowed, "{text}");
        }
        // In a region, and outside of every region.
        let inside =
            "\n[inside.box]\nmiddle_m = [0.1, -0.2, 1.5]\nhalf_sides_m = [1.0, 1.0, 1.2]\n";
        let kept = stated(&(text.clone() + inside)).unwrap();
        let (share, _) = kept.body.as_ref().unwrap().law().acceptance();
        assert!(share > 0.9, "{share}");
        // Estimates with errors where there is a region, and exact ones without.
        assert!(document["mean_error"].is_null() && document["deviation_error"].is_null());
        let kept: serde_json::Value =
            serde_json::to_value(law_json(kept.body.as_ref().unwrap()).unwrap()).unwrap();
        for i in 0..10 {
            let number = |key: &str| kept[key][i].as_f64().unwrap();
            let (sigma, error) = (number("deviation"), number("deviation_error"));
            assert!(sigma <= 1.05 * deviations[i] + 6.0 * error, "{i}: {sigma} {error} {text}");
            assert!(
                (kept["covariance"][i][i].as_f64().unwrap() - sigma * sigma).abs()
                    <= 1e-9 * sigma * sigma
            );
            assert!(
                (number("mean") - moments.mean()[i]).abs()
                    <= deviations[i] + 6.0 * number("mean_error") + 1e-9
            );
        }
        let far = inside.replace("1.5]", "9.0]");
        let error = stated(&(text.clone() + &far)).unwrap_err();
        assert!(error.starts_with("inside: "), "{error}");
        let error = stated(&(text.replace("mass_kg", "# mass_kg") + inside)).unwrap_err();
        assert!(error.contains("mass_kg"), "{error}");
    }
}

/// Radii of gyration are another way to say an inertia without products, and one way must be taken.
#[test]
fn radii_of_gyration_are_moments() {
    let rest = "[mass]\npercent = 5.0\nsigmas = 1\n";
    let told = |nominal: &str| stated(&format!("[nominal]\n{nominal}\n{rest}"));
    let radii = told("mass_kg = 10.0\nradii_of_gyration_m = [0.5, 0.6, 0.7]").unwrap();
    let rows = "inertia_kg_m2 = [[2.5, 0.0, 0.0], [0.0, 3.5999999999999996, 0.0], [0.0, 0.0, 4.8999999999999995]]";
    let moments = told(&format!("mass_kg = 10.0\n{rows}")).unwrap();
    assert_eq!(radii.model.implied().deviations(), moments.model.implied().deviations());
    for (nominal, why) in [
        ("radii_of_gyration_m = [0.5, 0.6, 0.7]", "it needs nominal.mass_kg"),
        ("mass_kg = 10.0", "must have inertia_kg_m2, or mass_kg and radii_of_gyration_m"),
        (
            "mass_kg = 10.0\nradii_of_gyration_m = [0.5, 0.6, 2.0]",
            "nominal.radii_of_gyration_m: no body has this inertia",
        ),
        ("mass_kg = 10.0\nradii_of_gyration_m = [0.5, -0.6, 0.7]", "-0.6: it must be"),
        ("mass_kg = -10.0\nradii_of_gyration_m = [0.5, 0.6, 0.7]", "nominal.mass_kg: -10.0"),
        (&format!("mass_kg = 10.0\nradii_of_gyration_m = [0.5, 0.6, 0.7]\n{rows}"), "and not both"),
    ] {
        let message = told(nominal).unwrap_err();
        assert!(message.contains(why), "{nominal}: {message}");
    }
}

/// Whatever is said has an effect on what is told, or is refused: of all files that say some of these things and not the others, each
/// differs from the same one without one of them.
#[test]
fn nothing_is_said_without_an_effect() {
    /// What is said, in a table, and what it stands beside.
    const SAID: [(&str, &str, Option<usize>); 10] = [
        ("nominal", "mass_kg = 10000.0", None),
        ("nominal", "mass_centre_m = [0.1, -0.2, 1.5]", None),
        ("moments", "percent = 10.0\nsigmas = 3", None),
        ("products", "kg_m2 = 50.0\nsigmas = 3", None),
        ("axes", "deg = 2.0\nsigmas = 3", None),
        ("axes", "of = \"total\"", Some(4)),
        ("mass", "percent = 1.0\nsigmas = 3", None),
        ("centre", "mm = 30.0\nsigmas = 3", None),
        ("centre", "arm_m = [0.0, 0.1, 1.0]", Some(7)),
        ("inside", "box = { middle_m = [0.0, 0.0, 1.5], half_sides_m = [1.0, 1.0, 1.2] }", None),
    ];
    let has = |said: usize, i: usize| said >> i & 1 == 1;
    let told = |said: usize| {
        let mut text = "[nominal]\ninertia_kg_m2 = [[5000.0, 20.0, 2.0], [20.0, 4000.0, -50.0], [2.0, -50.0, 3000.0]]\n".to_owned();
        let mut table = "nominal";
        for (_, (name, keys, _)) in SAID.iter().enumerate().filter(|(i, _)| has(said, *i)) {
            if *name != table {
                text += &format!("[{name}]\n");
                table = name;
            }
            text += &format!("{keys}\n");
        }
        let told = stated(&text)?;
        let fragment = fragment(FragmentBody::Payload, &told).map_err(|error| error.to_string())?;
        Ok::<_, String>(json(&told, FragmentBody::Payload, &fragment).unwrap())
    };
    let is_file = |said: &usize| {
        let stands = |(i, (.., beside)): (usize, &(_, _, Option<usize>))| {
            beside.is_none_or(|beside| !has(*said, i) || has(*said, beside))
        };
        // A region takes many draws, and is beside few others.
        SAID.iter().enumerate().all(stands) && (!has(*said, 9) || said.count_ones() <= 4)
    };
    let files = (0..1 << SAID.len()).filter(is_file);
    let outcomes: std::collections::BTreeMap<usize, _> =
        files.map(|said| (said, told(said))).collect();
    let mut count = 0;
    for (said, outcome) in outcomes.iter().filter(|(_, outcome)| outcome.is_ok()) {
        for i in (0..SAID.len()).filter(|i| has(*said, *i)) {
            let Some(without) = outcomes.get(&(said & !(1 << i))) else { continue };
            count += 1;
            let named: Vec<&str> =
                SAID.iter().enumerate().filter(|(i, _)| has(*said, *i)).map(|(_, s)| s.1).collect();
            assert!(without != outcome, "{:?} has no effect in {named:?}", SAID[i].1);
        }
    }
    assert!(count > 300, "{count}");
}
