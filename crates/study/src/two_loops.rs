//! Tests of the two loops: what is drawn for a vehicle is the same in all of its flights, and nothing else is touched.

use gyradius_statistics::{Confidence, Moments};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};
use std::collections::BTreeMap;
use toml::{Table, Value};

use crate::{
    Options, Replay, Scenario, Study, Which,
    model::{Model, Separations},
    quantity::Quantity,
};

/// Where a law may stand, and what the columns that it draws begin with.
const LAWS: [(&str, &str, &str); 24] = [
    ("payload", "inertia_drawn", "payload_inertia"),
    ("payload", "mass_percent", "payload_mass_kg"),
    ("payload", "mass_centre_m", "payload_mass_centre_"),
    ("payload", "position_m", "payload_position_"),
    ("payload", "velocity_m_per_s", "payload_velocity_"),
    ("payload", "attitude_deg", "payload_attitude_"),
    ("payload", "angular_velocity_rad_per_s", "payload_angular_velocity_"),
    ("stage", "inertia_drawn", "stage_inertia"),
    ("stage", "mass_kg", "stage_mass_kg"),
    ("stage", "mass_centre_m", "stage_mass_centre_"),
    ("stage", "position_m", "stage_position_"),
    ("stage", "velocity_m_per_s", "stage_velocity_"),
    ("stage", "attitude_deg", "stage_attitude_"),
    ("stage", "angular_velocity_rad_per_s", "stage_angular_velocity_"),
    ("stack", "attitude_deg", "stack_attitude_"),
    ("stack", "angular_velocity_rad_per_s", "stack_angular_velocity_"),
    ("spring", "stiffness_percent", "spring_1_stiffness_"),
    ("spring", "stroke_m", "spring_1_stroke_m"),
    ("spring", "friction_n", "spring_1_friction_n"),
    ("spring", "line_of_action_deg", "spring_1_line_of_action_"),
    ("spring", "payload_point_m", "spring_1_payload_point_"),
    ("spring", "stage_point_m", "spring_1_stage_point_"),
    ("spring", "start_s", "spring_1_start_s"),
    ("spring", "failure_probability", "spring_1_failure"),
];

fn table<const N: usize>(entries: [(&str, Value); N]) -> Value {
    Value::Table(entries.map(|(key, value)| (key.to_owned(), value)).into_iter().collect())
}

/// A law for a key, with what says for what it is drawn, if anything does.
fn law(key: &str, form: u64, drawn: Option<&str>) -> Value {
    let number = |x: f64| Value::Float(x);
    let mut law = match (key, form % 4) {
        ("failure_probability", _) => table([("probability", number(0.3))]),
        ("friction_n" | "start_s", _) => {
            table([("law", "uniform".into()), ("low", number(0.0)), ("high", number(0.01))])
        }
        ("mass_percent" | "mass_kg" | "stiffness_percent" | "stroke_m", 0 | 1) => {
            table([("sigma", number(1e-3))])
        }
        ("mass_percent" | "mass_kg" | "stiffness_percent" | "stroke_m", _) => {
            table([("law", "uniform".into()), ("low", number(-0.01)), ("high", number(0.01))])
        }
        ("line_of_action_deg", 0) | (_, 0 | 1) => table([("sigma", number(1e-3))]),
        ("line_of_action_deg", _) | (_, 2) => {
            let one = table([("variance", number(1e-6))]);
            let count = if key == "line_of_action_deg" { 2 } else { 3 };
            let mut each = vec![one; count];
            for law in &mut each {
                if let (Some(drawn), Value::Table(law)) = (drawn, law) {
                    law.insert("drawn".to_owned(), drawn.into());
                }
            }
            return Value::Array(each);
        }
        _ => {
            let row = |i: usize| {
                Value::from(
                    vec![0.0; 3]
                        .into_iter()
                        .enumerate()
                        .map(|(j, _)| if i == j { 1e-6 } else { 2e-7 })
                        .collect::<Vec<f64>>(),
                )
            };
            table([("covariance", Value::Array((0..3).map(row).collect()))])
        }
    };
    if let (Some(drawn), Value::Table(law)) = (drawn, &mut law) {
        law.insert("drawn".to_owned(), drawn.into());
    }
    law
}

/// The paper's bodies under a model that draws attitudes and one that draws entries, in which the laws of these keys are
/// given, each as its form says; `drawn` says for what.
fn scenario(
    given: &BTreeMap<usize, u64>,
    size: &[(&str, u64)],
    drawn: impl Fn(usize) -> Option<&'static str>,
) -> Result<Scenario, String> {
    let mut file: Table = Scenario::peck_2003().unwrap().to_toml().parse().unwrap();
    file.remove("runs");
    file.insert("comparisons".to_owned(), Value::Array(Vec::new()));
    let models = file["models"].as_array_mut().unwrap();
    models.retain(|model| ["proposed", "naive-matched"].contains(&model["name"].as_str().unwrap()));
    for (key, number) in size {
        file.insert((*key).to_owned(), Value::Integer(*number as i64));
    }
    let mut put = |place: &str, key: &str, value: Value| {
        let of = match place {
            "spring" => file["springs"].as_array_mut().unwrap()[0].as_table_mut().unwrap(),
            _ => file
                .entry(place)
                .or_insert_with(|| Value::Table(Table::new()))
                .as_table_mut()
                .unwrap(),
        };
        let dispersion = of.entry("dispersion").or_insert_with(|| Value::Table(Table::new()));
        dispersion.as_table_mut().unwrap().insert(key.to_owned(), value);
    };
    for (place, (at, form)) in given.iter().enumerate() {
        let (section, key, _) = LAWS[*at];
        match (key, drawn(place)) {
            ("inertia_drawn", Some(drawn)) => put(section, key, drawn.into()),
            ("inertia_drawn", None) => {}
            (_, drawn) => put(section, key, law(key, *form, drawn)),
        }
    }
    Scenario::from_toml(&toml::to_string(&file).unwrap()).map_err(|error| error.to_string())
}

/// What a law is called whose column this is; none if it is of no law.
fn of_law(column: &str) -> Option<&'static str> {
    let inertia = |body: &str| {
        let rest = column.strip_prefix(body)?;
        let entry = rest.strip_prefix("_i").or_else(|| rest.strip_prefix("_q"))?;
        entry.chars().all(|c| c.is_ascii_digit()).then_some(())
    };
    match (inertia("payload"), inertia("stage")) {
        (Some(()), _) => Some("payload_inertia"),
        (_, Some(())) => Some("stage_inertia"),
        (None, None) => {
            LAWS.iter().map(|(.., prefix)| *prefix).find(|prefix| column.starts_with(prefix))
        }
    }
}

/// What every run of every model draws, by column.
fn draws(scenario: &Scenario, runs: u64) -> Vec<BTreeMap<String, String>> {
    let models = Model::all(scenario).unwrap();
    let mut all = Vec::new();
    for model in &models {
        let simulation = Separations::new(scenario, model);
        for run in 0..runs {
            all.push(simulation.drawn(run));
        }
    }
    all
}

/// Random laws, of which a random subset is drawn for each vehicle: what these draw is in every flight what the run with
/// the vehicle's number draws without vehicles, what the others draw is that of the same run, to the bit; indices are
/// as they should be, and the scenario reads back the same.
#[test]
fn any_laws_may_be_drawn_for_vehicles() {
    let mut generator = ChaCha8Rng::seed_from_u64(14);
    let mut differing = [0; 2];
    for _ in 0..30 {
        let (chosen, forms, of_vehicle) =
            (generator.next_u64(), generator.next_u64(), generator.next_u64());
        let (vehicles, flights) = (1 + generator.next_u64() % 5, 1 + generator.next_u64() % 6);
        let runs = vehicles * flights;
        let given: BTreeMap<usize, u64> = (0..LAWS.len())
            .filter(|at| chosen >> at & 1 == 1)
            .map(|at| (at, forms >> (2 * at)))
            .collect();
        let places: Vec<usize> = given.keys().copied().collect();
        let is_of_vehicle = |place: usize| of_vehicle >> places[place] & 1 == 1;
        let plain = scenario(&given, &[("runs", runs)], |_| None).unwrap();
        let size = [("vehicles", vehicles), ("flights", flights)];
        let two = scenario(&given, &size, |place| {
            if is_of_vehicle(place) {
                Some("vehicle")
            } else {
                [None, Some("flight")][(forms >> 63) as usize]
            }
        });
        let two = two.unwrap();
        assert_eq!(
            (two.runs(), two.sharing().is_some()),
            (runs, flights > 1 && { (0..places.len()).any(is_of_vehicle) })
        );

        let again = Scenario::from_toml(&two.to_toml()).unwrap();
        assert_eq!(again.to_toml(), two.to_toml());
        assert_eq!(again.to_toml().contains("drawn"), (0..places.len()).any(is_of_vehicle));
        assert!(!two.to_toml().contains("\nruns = "));

        let names: Vec<&str> = (0..places.len())
            .filter(|place| is_of_vehicle(*place))
            .map(|place| LAWS[places[place]].2)
            .collect();
        let (plain, own) = (draws(&plain, runs), draws(&again, runs));
        for model in 0..2 {
            let at = |run: u64| (model * runs + run) as usize;
            for run in 0..runs {
                let (vehicle, flight) = (run / flights, run % flights);
                let row = &own[at(run)];
                assert_eq!(row["vehicle"], vehicle.to_string());
                assert_eq!(row["flight"], flight.to_string());
                assert_eq!(row.len(), plain[at(run)].len() + 2);
                for (column, value) in &plain[at(run)] {
                    let law = of_law(column);
                    let of_vehicle = law.is_some_and(|law| names.contains(&law));
                    let source = if of_vehicle { &plain[at(vehicle)][column] } else { value };
                    // It tells of both bodies.
                    if column != "realizable" {
                        assert_eq!(&row[column], source, "{column} of run {run}");
                    }
                    if law.is_some() && vehicle > 0 && of_vehicle {
                        differing[1] += u64::from(*source != plain[at(0)][column]);
                    } else if law.is_some() && flight > 0 {
                        differing[0] += u64::from(*value != own[at(run - 1)][column]);
                    }
                }
            }
        }
    }
    // Most of what could differ does; events and entries without attitudes need not.
    assert!(differing.iter().all(|count| *count > 1500), "{differing:?}");
}

/// Every key at which a law can say so, without vehicles: refused by its name. Of numbers that contradict each other, too.
#[test]
fn what_contradicts_itself_is_refused_at_its_key() {
    for (at, (section, key, _)) in LAWS.into_iter().enumerate() {
        for form in 0..4 {
            let given = [(at, form)].into_iter().collect();
            let message = scenario(&given, &[("runs", 10)], |_| Some("vehicle")).unwrap_err();
            let section = if section == "spring" { "springs[1]" } else { section };
            let place = format!("{section}.dispersion.{key}");
            assert!(message.starts_with(&place) && message.contains("no vehicles"), "{message}");
            let (named, _) = message.split_once(": ").unwrap();
            assert!(named.ends_with("drawn"), "{message}");
            assert!(scenario(&given, &[("runs", 10)], |_| Some("flight")).is_ok());
            let size = [("vehicles", 3), ("flights", 2)];
            let message = scenario(&given, &size, |_| Some("mission")).unwrap_err();
            assert!(message.contains("drawn") && message.contains("vehicle"), "{message}");
        }
    }
    let cases: [(&[(&str, u64)], &str); 11] = [
        (&[("vehicles", 3)], "flights: missing"),
        (&[("flights", 3)], "vehicles: missing"),
        (&[("runs", 10), ("flights", 3)], "vehicles: missing"),
        (&[("vehicles", 0), ("flights", 3)], "vehicles: 0: "),
        (&[("vehicles", 3), ("flights", 0)], "flights: 0: "),
        (&[("vehicles", 1), ("flights", 1_000_000_001)], "vehicles: 1: times flights = 1000000001"),
        (&[("vehicles", 1_000_000_001), ("flights", 1)], "vehicles: 1000000001: "),
        (&[("vehicles", 1 << 33), ("flights", 1 << 33)], "vehicles: 8589934592: "),
        (&[("vehicles", 1 << 62), ("flights", 1 << 62)], "vehicles: 4611686018427387904: "),
        (&[("runs", 7), ("vehicles", 2), ("flights", 3)], "runs: 7: "),
        (&[("runs", 0)], "runs: 0: "),
    ];
    let none = BTreeMap::new();
    for (size, expected) in cases {
        let message = scenario(&none, size, |_| None).unwrap_err();
        assert!(message.starts_with(expected), "{message}");
    }
    let size = [("runs", 6), ("vehicles", 2), ("flights", 3)];
    let two = scenario(&none, &size, |_| None).unwrap();
    let message = two.clone().with_runs(4).unwrap_err().to_string();
    assert!(message.starts_with("runs: 4: ") && message.contains("2 vehicles of 3"), "{message}");
    assert!(two.clone().with_vehicles(0).is_err() && two.clone().with_vehicles(1 << 62).is_err());
    assert_eq!(two.with_vehicles(5).unwrap().runs(), 15);
    let message = Scenario::peck_2003().unwrap().with_vehicles(4).unwrap_err().to_string();
    assert!(message.starts_with("vehicles: 4: ") && message.contains("no vehicles"), "{message}");
}

/// Quantities that are correlated must be drawn for the same, whichever way round they stand; without a correlation
/// they need not.
#[test]
fn correlated_quantities_are_drawn_for_the_same() {
    let given: BTreeMap<usize, u64> = [(1, 0), (17, 0), (18, 0)].into_iter().collect();
    let names = ["payload_mass_kg", "spring_1_stroke_m", "spring_1_friction_n"];
    for of_vehicle in 0..8_u32 {
        for [a, b] in [[0, 1], [1, 0], [1, 2], [2, 0]] {
            for coefficient in [0.5, -1.0, 0.0] {
                let is = |place: usize| of_vehicle >> place & 1 == 1;
                let size = [("vehicles", 4), ("flights", 3)];
                let two = scenario(&given, &size, |place| is(place).then_some("vehicle")).unwrap();
                let pair = format!(
                    "{}\n[[correlations]]\nbetween = [{:?}, {:?}]\ncoefficient = {coefficient:?}\n",
                    two.to_toml(),
                    names[a],
                    names[b]
                );
                match Scenario::from_toml(&pair) {
                    Ok(scenario) => {
                        assert!(is(a) == is(b) || coefficient == 0.0);
                        let all = draws(&scenario, 12);
                        for run in 0..12 {
                            for (place, name) in names.iter().enumerate().filter(|(at, _)| is(*at))
                            {
                                assert_eq!(all[run][*name], all[run / 3 * 3][*name], "{place}");
                            }
                        }
                    }
                    Err(error) => {
                        let message = error.to_string();
                        assert!(is(a) != is(b) && coefficient != 0.0, "{message}");
                        assert!(message.starts_with("correlations[1].between: "), "{message}");
                    }
                }
            }
        }
    }
}

/// Of an inertia that is drawn for each vehicle and multiplied by a mass ratio 1 + σz that is drawn for each flight: the
/// variance within vehicles is the mean of I² over vehicles times σ², that of the vehicles' means is that of I, but for
/// what is left of the other.
#[test]
fn variance_splits_into_that_of_vehicles_and_of_flights() {
    const VEHICLES: u64 = 400;
    const FLIGHTS: u64 = 25;
    let mut text = Scenario::peck_2003().unwrap().to_toml();
    text = text.replace("runs = 2000", &format!("vehicles = {VEHICLES}\nflights = {FLIGHTS}"));
    text = text.replace(
        "[payload.dispersion]\n",
        "[payload.dispersion]\ninertia_drawn = \"vehicle\"\nmass_percent = 1.0\ninertia_follows_mass = true\n",
    );
    let scenario = Scenario::from_toml(&text).unwrap();
    let own = draws(&scenario, VEHICLES * FLIGHTS);
    let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
    let values: Vec<f64> =
        own[..(VEHICLES * FLIGHTS) as usize].iter().map(|row| number(row, "payload_i11")).collect();
    let ratio = |row: &BTreeMap<String, String>| number(row, "payload_mass_kg") / 1e4;
    let of_vehicles: Vec<f64> = own[..values.len()]
        .iter()
        .step_by(FLIGHTS as usize)
        .map(|r| number(r, "payload_i11") / ratio(r))
        .collect();
    let groups = values.chunks(FLIGHTS as usize);
    let within: f64 = groups.clone().map(|g| Moments::new(g).unwrap().variance()).sum();
    let within = within / VEHICLES as f64;
    let mean_square = of_vehicles.iter().map(|i| i * i).sum::<f64>() / VEHICLES as f64;
    // Of 9600 degrees of freedom: 5 standard deviations.
    let expected = mean_square * 1e-4;
    let bound = 5.0 * (2.0 / (VEHICLES * (FLIGHTS - 1)) as f64).sqrt();
    assert!((within / expected - 1.0).abs() < bound, "{within} {expected}");
    let means: Vec<f64> = groups.map(|g| Moments::new(g).unwrap().mean()).collect();
    let between = Moments::new(&means).unwrap().variance();
    let expected = Moments::new(&of_vehicles).unwrap().variance() + within / FLIGHTS as f64;
    // Means differ from those of the vehicles by √(within / 25): what is left is their product, over 400 vehicles.
    let bound = 5.0 * 2.0 * (within / FLIGHTS as f64 / expected / VEHICLES as f64).sqrt();
    assert!((between / expected - 1.0).abs() < bound, "{between} {expected} {bound}");
    assert!(bound < 0.5, "{bound}");
}

/// The same rows on any number of threads; more vehicles leave the rows that are there, and another number of flights is
/// another study. What is told of means is of vehicles, and a flight is replayed to the bit.
#[test]
fn studies_of_vehicles_go_on() {
    let given: BTreeMap<usize, u64> =
        [(0, 0), (1, 0), (3, 0), (16, 0), (23, 0)].into_iter().collect();
    let make = |vehicles: u64, flights: u64| {
        let size = [("vehicles", vehicles), ("flights", flights)];
        scenario(&given, &size, |place| (place != 2).then_some("vehicle")).unwrap()
    };
    let scratch = tempfile::tempdir().unwrap();
    let options = |place: &str, threads| Options {
        threads: Some(threads),
        ..Options::to(scratch.path().join(place))
    };
    let run = |scenario: &Scenario, place: &str, threads| {
        Study::run(scenario, &options(place, threads), &|_| {})
    };
    let small = run(&make(8, 5), "a", 1).unwrap();
    let before = small.rows();
    assert_eq!(run(&make(8, 5), "b", 2).unwrap().rows(), before);
    let large = run(&make(12, 5), "a", 2).unwrap();
    let after = large.rows();
    assert_eq!((before.len(), after.len()), (80, 120));
    assert!(before[..40] == after[..40] && before[40..] == after[60..100]);
    for other in [make(12, 6), make(30, 2)] {
        let error = run(&other, "a", 2).unwrap_err().to_string();
        assert!(error.contains("flights is 5 there and"), "{error}");
    }
    let error = run(&make(11, 5), "a", 2).unwrap_err().to_string();
    assert!(error.contains("vehicles is 12 there and 11 here"), "{error}");

    let table = &large.tables().unwrap()[0];
    let summary = large.summary();
    assert_eq!(summary.head.independent_runs_per_model, Some(12));
    for quantity in [Quantity::RelativeSpeed, Quantity::PayloadI11] {
        let column = quantity.column();
        let values: Vec<f64> = table.numbers(&column).unwrap().present().collect();
        let means: Vec<f64> =
            values.chunks(5).map(|group| group.iter().sum::<f64>() / group.len() as f64).collect();
        let found = &summary.models[0].quantity(quantity).unwrap().sample;
        if values.len() == 60 {
            let expected = Moments::new(&means).unwrap().mean_interval(Confidence::default());
            let interval = found.mean_interval.unwrap();
            let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * a.abs();
            assert!(near(interval.lower(), expected.lower()), "{interval} {expected}");
            assert!(near(interval.upper(), expected.upper()), "{interval} {expected}");
        }
    }
    let share = &summary.models[1].unrealizable;
    assert!(share.of == 60 && share.count % 5 == 0 || share.count < 60, "{share:?}");

    let folder = large.folder();
    let by_flight =
        Replay::open(folder, None, Which::Flight { vehicle: 9, flight: 2 }, 0.0).unwrap();
    assert_eq!(by_flight.row().run(), 47);
    assert!(by_flight.to_string().contains("run 47 of 60 (vehicle 9, flight 2)"), "{by_flight}");
    assert_eq!(Replay::open(folder, None, 47, 0.0).unwrap().row().run(), 47);
    for (vehicle, flight) in [(12, 0), (0, 5), (u64::MAX, u64::MAX)] {
        let error = Replay::open(folder, None, Which::Flight { vehicle, flight }, 0.0);
        let error = error.unwrap_err().to_string();
        assert!(error.contains("12 vehicles of 5 flights each"), "{error}");
    }
    let report = std::fs::read_to_string(folder.join("report.md")).unwrap();
    assert!(report.contains("12 vehicles of 5 flights each, 60 runs"), "{report}");
    assert!(report.contains("runs are not independent"), "{report}");
}
