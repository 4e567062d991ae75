//! The two loops of a simulator: what is drawn for a vehicle is the same in all of its flights, and nothing else is touched.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};
use std::collections::BTreeMap;

use super::{AnyScenario, Inputs, MODELS, SimulatorDraws, SimulatorScenario, folder, scenario};
use crate::Fleet;

const HEAD: &str = r#"
name = "two-loops"
SIZE
seed = 11

[simulation]
command = ["sh", "answer.sh"]

[[simulation.outputs]]
name = "y"
[[simulation.outputs]]
name = "v"
[[simulation.outputs]]
name = "f"
"#;

/// Laws of quantities and of masses and mass centres, in which DRAWN may say for what they are drawn.
const QUANTITIES: [&str; 4] = [
    "{ law = \"uniform\", low = 0.1, high = 0.95DRAWN }",
    "{ law = \"normal\", mean = 1.0, sigma = 0.1DRAWN }",
    "{ law = \"samples\", samples = [1.0, 2.0, 4.0, 8.0]DRAWN }",
    "{ law = \"bernoulli\", probability = 0.5DRAWN }",
];
const MASSES: [&str; 3] = [
    "mass_kg = { sigma = 2.0DRAWN }",
    "mass_percent = { variance = 1.0DRAWN }",
    "mass_kg = { law = \"uniform\", low = -5.0, high = 5.0DRAWN }",
];
const CENTRES: [&str; 3] = [
    "mass_centre_m = { sigma = 0.01DRAWN }",
    "mass_centre_m = [{ sigma = 0.01DRAWN }, { variance = 1e-4DRAWN }, { law = \"uniform\", low = -0.1, high = 0.1DRAWN }]",
    "mass_centre_m = { covariance = [[1e-4, 5e-5, 0.0], [5e-5, 1e-4, 0.0], [0.0, 0.0, 1e-6]]DRAWN }",
];

/// Where a law may stand: the inertia, mass and mass centre of two bodies, and four quantities.
const PLACES: usize = 10;

/// What the columns begin with that the law in a place draws.
fn prefix(place: usize) -> String {
    let body = ["hub_", "tank_"][usize::from(place % 6 > 2)];
    match place {
        0 | 3 => format!("{body}inertia"),
        1 | 4 => format!("{body}mass_kg"),
        2 | 5 => format!("{body}mass_centre"),
        _ => ["x", "p", "q", "z"][place - 6].to_owned(),
    }
}

/// The place of the law that draws a column.
fn place(column: &str) -> usize {
    let entry = column.split('_').nth(1).is_some_and(|rest| {
        rest.strip_prefix(['i', 'q'])
            .is_some_and(|digits| digits.bytes().all(|b| b.is_ascii_digit()))
    });
    let of = if entry {
        column.split('_').next().unwrap().to_owned() + "_inertia"
    } else {
        column.to_owned()
    };
    (0..PLACES).find(|place| of.starts_with(&prefix(*place))).unwrap()
}

/// Two bodies and quantities with the laws in these places, of these forms, each drawn for what `drawn` says.
pub(super) fn text(
    size: &str,
    given: &BTreeMap<usize, usize>,
    follows: Option<f64>,
    drawn: impl Fn(usize) -> Option<&'static str>,
) -> String {
    let law = |place: usize, laws: &[&str]| {
        let Some(form) = given.get(&place) else { return String::new() };
        let more = drawn(place).map_or_else(String::new, |drawn| format!(", drawn = \"{drawn}\""));
        laws[form % laws.len()].replace("DRAWN", &more)
    };
    let mut text = HEAD.replace("SIZE", size);
    for (i, name) in ["hub", "tank"].into_iter().enumerate() {
        let inertia = drawn(3 * i).map(|drawn| format!("inertia_drawn = \"{drawn}\"\n"));
        let inertia = inertia.filter(|_| given.contains_key(&(3 * i))).unwrap_or_default();
        let (mass, centre) = (law(3 * i + 1, &MASSES), law(3 * i + 2, &CENTRES));
        let follows = follows.filter(|_| !mass.is_empty());
        let follows =
            follows.map_or_else(String::new, |share| format!("inertia_follows_mass = {share}\n"));
        text += &format!(
            "\n[[bodies]]\nname = \"{name}\"\nmass_kg = 120.0\nmass_centre_m = [0.1, -0.2, 0.0]\n\
             inertia_kg_m2 = [[21.0, 0.2, -0.1], [0.2, 19.0, 0.3], [-0.1, 0.3, 26.0]]\n\n\
             [bodies.dispersion]\n{inertia}{mass}\n{centre}\n{follows}\
             root_second_moment_variance_kg_m2 = [0.001, 0.001, 0.001]\naxes = \"uniform\"\n"
        );
    }
    for place in 6..PLACES {
        if given.contains_key(&place) {
            let (name, law) = (prefix(place), law(place, &QUANTITIES[place - 6..=place - 6]));
            text += &format!("\n[[quantities]]\nname = \"{name}\"\nlaw = {law}\n");
        }
    }
    text + MODELS
}

/// What a model draws for some runs: of each its place, and its numbers by column.
type Drawn = Vec<(Vec<i64>, BTreeMap<String, Option<f64>>)>;

fn drawn(scenario: &SimulatorScenario, model: usize, runs: u64) -> Drawn {
    let draws = SimulatorDraws::new(scenario, model).unwrap();
    let columns = Inputs::columns(&draws);
    let run = |run| {
        let mut numbers = Vec::new();
        draws.draw(run, &mut numbers).unwrap();
        assert_eq!(numbers.len(), columns.len());
        let names = columns.iter().map(|column| column.name().to_owned());
        (draws.place(run), names.zip(numbers).collect())
    };
    (0..runs).map(run).collect()
}

/// Random laws, of which a random subset is drawn for each vehicle: what these draw is in every flight what the run with
/// the vehicle's number draws without vehicles, what the others draw is that of the same run, to the bit, and an inertia
/// that follows a mass follows that of the run. The scenario reads back the same.
#[test]
fn any_laws_may_be_drawn_for_vehicles() {
    let mut generator = ChaCha8Rng::seed_from_u64(15);
    let folder = folder();
    let mut differing = [0; 2];
    for _ in 0..40 {
        let (chosen, forms, of_vehicle, follows) = (
            generator.next_u64(),
            generator.next_u64(),
            generator.next_u64(),
            generator.next_u64(),
        );
        let (vehicles, flights) = (1 + generator.next_u64() % 5, 1 + generator.next_u64() % 6);
        let runs = vehicles * flights;
        let given: BTreeMap<usize, usize> = (0..PLACES)
            .filter(|at| chosen >> at & 1 == 1)
            .map(|at| (at, (forms >> (2 * at) & 3) as usize))
            .collect();
        let follows = [None, Some(0.25), Some(1.0)][(follows % 3) as usize];
        let is_of_vehicle = |at: usize| given.contains_key(&at) && of_vehicle >> at & 1 == 1;
        let any = (0..PLACES).any(is_of_vehicle);
        let plain =
            scenario(&text(&format!("runs = {runs}"), &given, None, |_| None), folder.path());
        let size = format!("vehicles = {vehicles}\nflights = {flights}");
        let two = text(&size, &given, follows, |at| {
            if is_of_vehicle(at) {
                Some("vehicle")
            } else {
                [None, Some("flight")][(forms >> 63) as usize]
            }
        });
        let two = scenario(&two, folder.path());
        assert_eq!((two.runs(), two.sharing().is_some()), (runs, flights > 1 && any));
        assert_eq!(two.to_toml().contains("drawn"), any);
        assert!(!two.to_toml().contains("\nruns = ") && two.to_toml().contains(&size));
        assert!(plain.fleet().is_none() && !plain.to_toml().contains("vehicles"));

        for model in 0..2 {
            let (plain, own) = (drawn(&plain, model, runs), drawn(&two, model, runs));
            for run in 0..runs {
                let (vehicle, flight) = (run / flights, run % flights);
                let (index, row) = &own[run as usize];
                assert_eq!(index[..], [vehicle as i64, flight as i64]);
                for (column, value) in row {
                    let source = |at: usize| if is_of_vehicle(at) { vehicle } else { run };
                    let at = place(column);
                    let mut expected = plain[source(at) as usize].1[column];
                    let (body, rest) = column.split_once('_').unwrap_or(("", column));
                    if let (Some(share), Some(entry), true) =
                        (follows, expected.as_mut(), rest.starts_with('i'))
                    {
                        let mass =
                            plain[source(at + 1) as usize].1[&format!("{body}_mass_kg")].unwrap();
                        let ratio = mass / 120.0;
                        *entry *= if share < 1.0 { 1.0 + share * (ratio - 1.0) } else { ratio };
                    }
                    assert_eq!(
                        value.map(f64::to_bits),
                        expected.map(f64::to_bits),
                        "{column} of run {run}"
                    );
                    // An inertia may follow a mass that another loop draws.
                    if is_of_vehicle(at) && vehicle > 0 {
                        differing[1] += u64::from(row[column] != own[0].1[column]);
                    } else if !is_of_vehicle(at) && flight > 0 {
                        differing[0] += u64::from(row[column] != own[run as usize - 1].1[column]);
                    }
                }
            }
        }
    }
    // Most of what could differ does; events, and attitudes of entrywise models, need not.
    assert!(differing.iter().all(|count| *count > 1500), "{differing:?}");
}

/// Every key at which a law can say so, without vehicles: refused by its name. Of numbers that contradict each other, too,
/// and of names that columns have.
#[test]
fn what_contradicts_itself_is_refused_at_its_key() {
    let folder = folder();
    let refused =
        |text: &str| SimulatorScenario::from_toml(text, folder.path()).unwrap_err().to_string();
    let two = "vehicles = 3\nflights = 2";
    for at in 0..PLACES {
        for form in 0..4 {
            let given = [(at, form)].into_iter().collect();
            let message = refused(&text("runs = 10", &given, None, |_| Some("vehicle")));
            let place = match at {
                0..=2 => "bodies[1].dispersion.",
                3..=5 => "bodies[2].dispersion.",
                _ => "quantities[1].law.drawn: ",
            };
            assert!(message.starts_with(place) && message.contains("no vehicles"), "{message}");
            let (named, _) = message.split_once(": ").unwrap();
            assert!(named.ends_with("drawn"), "{message}");
            scenario(&text("runs = 10", &given, None, |_| Some("flight")), folder.path());
            let message = refused(&text(two, &given, None, |_| Some("mission")));
            assert!(message.contains("drawn") && message.contains("vehicle"), "{message}");
        }
    }
    let none = BTreeMap::new();
    for (size, expected) in [
        ("vehicles = 3", "flights: missing"),
        ("runs = 10\nflights = 3", "vehicles: missing"),
        ("vehicles = 0\nflights = 3", "vehicles: 0: "),
        ("vehicles = 3\nflights = 0", "flights: 0: "),
        ("vehicles = 4_000_000_000\nflights = 4_000_000_000", "vehicles: 4000000000: "),
        ("runs = 7\nvehicles = 2\nflights = 3", "runs: 7: "),
        ("runs = 0", "runs: 0: "),
    ] {
        let message = refused(&text(size, &none, None, |_| None));
        assert!(message.starts_with(expected), "{message}");
    }
    let fleet = scenario(&text(&format!("runs = 6\n{two}"), &none, None, |_| None), folder.path());
    let message = fleet.clone().with_runs(4).unwrap_err().to_string();
    assert!(message.starts_with("runs: 4: ") && message.contains("3 vehicles of 2"), "{message}");
    assert!(
        fleet.clone().with_vehicles(0).is_err() && fleet.clone().with_vehicles(1 << 62).is_err()
    );
    let more = AnyScenario::Simulator(Box::new(fleet)).with_vehicles(5).unwrap();
    assert_eq!((more.runs(), more.fleet().map(Fleet::vehicles)), (10, Some(5)));
    let plain = scenario(&text("runs = 6", &none, None, |_| None), folder.path());
    let message = plain.with_vehicles(4).unwrap_err().to_string();
    assert!(message.starts_with("vehicles: 4: ") && message.contains("no vehicles"), "{message}");

    for (name, at) in [("vehicle", "quantities[1].name"), ("flight", "quantities[1].name")] {
        let quantity = super::quantity(name, "{ law = \"normal\", mean = 1.0, sigma = 0.1 }");
        let message = refused(&(text(two, &none, None, |_| None) + &quantity));
        assert!(message.starts_with(at), "{message}");
        scenario(&(text("runs = 6", &none, None, |_| None) + &quantity), folder.path());
        let output =
            text(two, &none, None, |_| None).replace("name = \"v\"", &format!("name = \"{name}\""));
        assert!(refused(&output).starts_with("simulation.outputs[2].name"), "{}", refused(&output));
    }
}

/// What is correlated must be drawn for the same.
#[test]
fn correlations_tie_what_is_drawn_equally_often() {
    let folder = folder();
    let given: BTreeMap<usize, usize> = [(1, 0), (2, 1), (6, 0), (7, 0)].into_iter().collect();
    let names = ["hub_mass_kg", "hub_mass_centre_2_m", "x", "p"];
    let places: Vec<usize> = given.keys().copied().collect();
    for subset in 0..1_u32 << places.len() {
        let is = |i: usize| subset >> i & 1 == 1;
        let drawn_for =
            |at| places.iter().position(|p| *p == at).filter(|i| is(*i)).map(|_| "vehicle");
        let text = text("vehicles = 4\nflights = 3", &given, None, drawn_for);
        for (a, b) in (0..4).flat_map(|b| (0..b).map(move |a| (a, b))) {
            for coefficient in [0.0, -0.7] {
                let tied = format!(
                    "{text}\n[[correlations]]\nbetween = [\"{}\", \"{}\"]\ncoefficient = {coefficient}\n",
                    names[a], names[b]
                );
                match SimulatorScenario::from_toml(&tied, folder.path()) {
                    Ok(scenario) => {
                        assert!(is(a) == is(b) || coefficient == 0.0);
                        let rows = drawn(&scenario, 0, 12);
                        for (run, i) in (0..12).flat_map(|run| [(run, a), (run, b)]) {
                            let shared = rows[run].1[names[i]] == rows[run / 3 * 3].1[names[i]];
                            assert_eq!(shared, is(i) || run % 3 == 0, "{}", names[i]);
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
