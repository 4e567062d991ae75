//! A scenario with every key, each made wrong in every way: what is refused is named.

use std::fmt::Write;
use toml::{Table, Value};

use super::*;

/// A scenario that says something under every key.
fn complete() -> Table {
    let mut text = PECK_2003.to_owned();
    for (before, more) in [
        (
            "[payload]",
            "[integration]\nrelative_tolerance = 1e-10\nhorizon_s = 60.0\n\
             [clearance]\ncoast_s = 30.0\n\
             payload = [{ hull_m = [[0.5, 0.0, -0.5], [0.0, 0.5, -0.5]] }, { points_m = [[0.0, 0.0, -0.6]] }]\n\
             stage = [{ ring = { centre_m = [0.0, 0.0, 0.4], axis = [0.0, 0.0, 1.0], radius_m = 0.3 } }]\n\
             [stack.dispersion]\nattitude_deg = 0.1\n\
             angular_velocity_rad_per_s = { covariance = [[1e-6, 0.0, 0.0], [0.0, 1e-6, 0.0], [0.0, 0.0, 4e-6]] }\n",
        ),
        (
            "[payload.dispersion]",
            "velocity_m_per_s = [0.0, 0.0, 0.0]\nbody_to_inertial = [0.0, 0.0, 0.0, 1.0]\n",
        ),
        (
            "spin_axis",
            "separation_direction = [0.0, 0.0, 1.0]\nmomentum_direction = [1.0, 0.0, 0.0]\n",
        ),
        (
            "root_second_moment_variance_kg_m2",
            "roots = \"gaussian\"\naxes = \"radially-constrained-gaussian\"\n\
             mass_percent = { sigma = 1.0, mean = 0.1 }\ninertia_follows_mass = true\ninertia_drawn = \"vehicle\"\n\
             mass_centre_m = [0.005, { sigma = 0.005, drawn = \"vehicle\" }, 0.02]\n\
             position_m = { law = \"uniform\", low = -0.01, high = 0.01, drawn = \"vehicle\" }\n\
             velocity_m_per_s = { law = \"truncated-normal\", sigma = 0.1, low = -0.2, high = 0.2 }\n\
             attitude_deg = 0.5\nangular_velocity_rad_per_s = 0.001\n",
        ),
        (
            "[[models]]",
            "friction_n = 10.0\nstart_s = 0.01\n[springs.dispersion]\nstiffness_percent = 1.0\nstroke_m = 0.001\n\
             friction_n = { law = \"uniform\", low = 0.0, high = 5.0 }\nline_of_action_deg = 0.1\n\
             payload_point_m = 0.001\nstage_point_m = [0.001, 0.001, { sigma = 0.001 }]\n\
             start_s = { law = \"lognormal\", mean = 0.01, sigma = 0.005 }\n\
             late_probability = 0.02\nfailure_probability = { probability = 0.001, drawn = \"vehicle\" }\n\
             [[correlations]]\nbetween = [\"payload_mass_kg\", \"spring_4_stroke_m\"]\ncoefficient = 0.5\n",
        ),
        (
            "[[comparisons]]",
            "[[models]]\nname = \"basilisk\"\nlaw = \"basilisk\"\n\
             payload_diagonal_deviation_kg_m2 = 50.0\npayload_angle_deviation_rad = 0.01\n\
             payload_diagonal_bounds_kg_m2 = [-100.0, 100.0]\nstage_diagonal_deviation_kg_m2 = 50.0\n\
             stage_angle_deviation_rad = 0.01\n[[models]]\nname = \"w\"\nlaw = \"wishart\"\n\
             payload_delta = 0.01\nstage_delta = 0.02\n",
        ),
    ] {
        let at = text.find(before).unwrap();
        text.insert_str(at, more);
    }
    text = text.replace("runs = 2000", "vehicles = 40\nflights = 50");
    let stage = "root_second_moment_variance_kg_m2 = [0.0067, 0.0067, 0.002]";
    let laws = "roots = \"independent\"\nroot_second_moment_laws_sqrt_kg_m = [\
                { law = \"triangular\", low = 31.0, mode = 31.6, high = 33.0 }, \
                { law = \"beta\", low = 31.0, high = 33.0, alpha = 2.0, beta = 3.0 }, \
                { law = \"samples\", samples = [75.4, 75.5, 75.7] }]\n\
                mass_kg = { law = \"weibull\", low = -10.0, scale = 20.0, shape = 2.0 }\n\
                position_m = [{ law = \"triangular\", low = -0.1, high = 0.2 }, { variance = 1e-4 }, \
                { law = \"samples\", samples = [-0.1, 0.2] }]";
    assert!(text.contains(stage));
    text = text.replace(stage, laws);
    Scenario::from_toml(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    toml::from_str(&text).unwrap()
}

#[derive(Clone, Debug)]
enum Step {
    Key(String),
    Index(usize),
}

/// Every place in a scenario.
fn places(value: &Value, here: &[Step], out: &mut Vec<Vec<Step>>) {
    let mut below = |step: Step, value: &Value| {
        let mut path = here.to_vec();
        path.push(step);
        out.push(path.clone());
        places(value, &path, out);
    };
    match value {
        Value::Table(table) => table.iter().for_each(|(k, v)| below(Step::Key(k.clone()), v)),
        Value::Array(all) => all.iter().enumerate().for_each(|(i, v)| below(Step::Index(i), v)),
        _ => {}
    }
}

fn at<'v>(value: &'v mut Value, path: &[Step]) -> &'v mut Value {
    path.iter().fold(value, |value, step| match step {
        Step::Key(key) => &mut value[key.as_str()],
        Step::Index(i) => &mut value[*i],
    })
}

/// As messages write it.
fn said(path: &[Step]) -> String {
    let mut out = String::new();
    for step in path {
        match step {
            Step::Index(k) => drop(write!(out, "[{}]", k + 1)),
            Step::Key(key) if out.is_empty() => out.push_str(key),
            Step::Key(key) => drop(write!(out, ".{key}")),
        }
    }
    out
}

/// What a place may become; none for it to go.
fn wrong(value: &Value) -> Vec<Option<Value>> {
    let mut all = vec![
        None,
        Some(Value::Boolean(true)),
        Some(Value::String("ten".to_owned())),
        Some(Value::String(String::new())),
        Some(Value::Array(Vec::new())),
        Some(Value::Array(vec![Value::Float(1.0); 7])),
        Some(Value::Table(Table::new())),
        Some(Value::Table([("wrong".to_owned(), Value::Integer(1))].into_iter().collect())),
        Some(Value::Integer(-1)),
        Some(Value::Integer(i64::MAX)),
    ];
    let floats = [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -1e300, 1e-300, 0.0, -0.5, 1e9];
    all.extend(floats.map(|x| Some(Value::Float(x))));
    if let Some(x) = value.as_float() {
        all.extend([-x, 1e3 * x, x + 0.123].map(|x| Some(Value::Float(x))));
    }
    if let Value::Array(items) = value {
        all.push(Some(Value::Array([&items[..], &items[..1]].concat())));
    }
    all
}

/// What is told of a scenario that is wrong at a place; none if it is taken.
fn refusal(changed: &Value, told: &str) -> Option<String> {
    let text = toml::to_string(changed).unwrap();
    let message = Scenario::from_toml(&text).err()?.to_string();
    // No number is told digit by digit.
    let digits = message.split(|c: char| !c.is_ascii_digit()).map(str::len).max();
    assert!(digits < Some(25) && message.len() < 1500, "{told}: {message}");
    Some(message)
}

/// Whether a message is about a place: its key stands in front, or that of what it is in and the last
/// key in the reason; or the key of what it makes wrong, and its own last key in the reason.
fn names(message: &str, path: &[Step]) -> bool {
    let (named, reason) = message.split_once(": ").unwrap_or(("", message));
    let last = path.iter().rev().find_map(|step| match step {
        Step::Key(key) => Some(key.as_str()),
        Step::Index(_) => None,
    });
    // An entry of a list of numbers is named with its list.
    let list = path.iter().rposition(|step| matches!(step, Step::Key(_))).unwrap_or(0);
    named.starts_with(&said(&path[..=list])) || last.is_some_and(|last| reason.contains(last))
}

#[test]
fn every_refusal_names_its_key() {
    let whole = Value::Table(complete());
    let (mut paths, mut refused, mut unnamed) = (Vec::new(), 0, Vec::new());
    places(&whole, &[], &mut paths);
    for path in &paths {
        let (last, above) = path.split_last().unwrap();
        let value = at(&mut whole.clone(), path).clone();
        for change in wrong(&value) {
            let mut changed = whole.clone();
            match (&change, last, at(&mut changed, above)) {
                (Some(new), ..) => *at(&mut changed, path) = new.clone(),
                (None, Step::Key(key), Value::Table(table)) => drop(table.remove(key)),
                (None, Step::Index(i), Value::Array(items)) => drop(items.remove(*i)),
                _ => unreachable!(),
            }
            let told = format!("{} = {change:?}", said(path));
            let Some(message) = refusal(&changed, &told) else { continue };
            refused += 1;
            if !names(&message, path) {
                unnamed.push(format!("{told}: {message}"));
            }
        }
    }
    assert!(refused > 2000, "{refused}");
    assert!(unnamed.is_empty(), "{} of {refused}:\n{}", unnamed.len(), unnamed.join("\n"));
}

/// The page tells every key, its whole scenario is one, and what is left out of that is what the page says.
#[test]
fn the_page_tells_every_key() {
    let page = include_str!("../../../../docs/scenario.md");
    let mut paths = Vec::new();
    places(&Value::Table(complete()), &[], &mut paths);
    for path in &paths {
        let Some(Step::Key(key)) = path.last() else { continue };
        let of_body = key.strip_prefix("payload_").or_else(|| key.strip_prefix("stage_"));
        let written =
            [format!("`{key}`"), format!("{key} = "), format!("[{key}]"), format!("[{key}.")];
        let of_model = of_body.map(|key| format!("`…_{key}`"));
        let mut written = written.into_iter().chain(of_model);
        assert!(written.any(|text| page.contains(&text)), "{}", said(path));
    }
    let section = &page[page.find("## The two bodies and the springs").unwrap()..];
    let example = section.split("```").nth(1).unwrap().strip_prefix("toml").unwrap();
    let whole = Scenario::from_toml(example).unwrap().to_toml();
    for (key, row) in [
        ("runs = 2000", "| 2000 |"),
        ("seed = 1", "| 1 |"),
        ("velocity_m_per_s = [0.0, 0.0, 0.0]", "| `[0, 0, 0]` |"),
        ("body_to_inertial = [0.0, 0.0, 0.0, 1.0]", "| `[0, 0, 0, 1]`:"),
        ("angular_velocity_rad_per_s = [0.0, 0.0, 0.0]", "| `[0, 0, 0]` |"),
        ("horizon_s = 60.0", "| 60 |"),
        ("relative_tolerance = 0.0000000000001", "| 1e-13 |"),
    ] {
        assert!(whole.contains(&format!("\n{key}\n")), "{key}\n{whole}");
        let name = key.split(' ').next().unwrap();
        let told = section.lines().find(|line| line.contains(&format!("`{name}`"))).unwrap();
        assert!(told.contains(row), "{told}");
    }
    // What is refused if it is left out is not in the example for nothing.
    for line in example.lines().filter(|line| line.contains(" = ") && !line.contains("dispersion"))
    {
        let less = example.replacen(line, "", 1);
        let key = line.split(' ').next().unwrap();
        let told = Scenario::from_toml(&less).unwrap_err().to_string();
        assert!(told.contains(key), "{key}: {told}");
    }
}

/// A key that is not known, beside those that are, in every table there is: refused by its name and
/// that of the table.
#[test]
fn every_unknown_key_is_named() {
    let whole = Value::Table(complete());
    let mut paths = vec![Vec::new()];
    places(&whole, &[], &mut paths);
    let mut tables = 0;
    for path in &paths {
        let mut changed = whole.clone();
        let Value::Table(table) = at(&mut changed, path) else { continue };
        tables += 1;
        table.insert("colour".to_owned(), Value::Integer(1));
        let told = format!("{}.colour", said(path));
        let message = refusal(&changed, &told).unwrap_or_else(|| panic!("{told} is taken"));
        assert!(message.starts_with(&said(path)), "{told}: {message}");
        assert!(message.contains("unknown field `colour`"), "{told}: {message}");
    }
    assert!(tables > 30, "{tables}");
}
