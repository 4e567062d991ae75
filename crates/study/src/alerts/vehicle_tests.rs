//! What is told of dispersions that moved nothing where vehicles draw them once for all of their flights.

use std::fs;

use gyradius_campaign::{RunInputs, SimulatorFunction};

use super::{
    Alert,
    tests::{NORMAL, ordinary, study},
};
use crate::{Options, Scenario, SimulatorScenario, subject::Subject};

/// How many vehicles there are, and how often each flies; none of plain runs.
const SIZES: [Option<[i64; 2]>; 5] =
    [None, Some([1, 30]), Some([2, 15]), Some([4, 60]), Some([30, 1])];

/// Drawn for the vehicle of which there is one, a mass is the same in all flights: the alert says why.
#[test]
fn one_vehicle_is_told_to_be_why() {
    let base = ordinary(60, 0.01, NORMAL).to_toml();
    for (drawn, counts, is_same) in [
        ("vehicle", Some([1, 30]), true),
        ("vehicle", Some([2, 30]), false),
        ("flight", Some([1, 30]), false),
        ("flight", None, false),
    ] {
        let mut table: toml::Table = base.parse().unwrap();
        let mut mass = toml::Table::from_iter([("sigma".to_owned(), 30.0.into())]);
        if let Some([vehicles, flights]) = counts {
            mass.insert("drawn".to_owned(), drawn.into());
            table.remove("runs");
            table.insert("vehicles".to_owned(), vehicles.into());
            table.insert("flights".to_owned(), flights.into());
        }
        let dispersion =
            table["payload"].as_table_mut().unwrap()["dispersion"].as_table_mut().unwrap();
        dispersion.insert("mass_kg".to_owned(), mass.into());
        let scenario = Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap();
        let (summary, _) = study(&scenario);
        let told: Vec<(&str, Option<u64>)> = summary
            .head
            .alerts
            .iter()
            .filter_map(|alert| match alert {
                Alert::Unmoved { column, vehicles, .. } => Some((&**column, *vehicles)),
                _ => None,
            })
            .collect();
        let expected = if is_same { vec![("payload_mass_kg", Some(1))] } else { vec![] };
        assert_eq!(told, expected, "{drawn}, {counts:?}");
        let page = scenario.report(&summary).html();
        assert_eq!(page.contains("There is only one vehicle, so that"), is_same);
    }
}

/// The keys that state a size.
fn size(of: Option<[i64; 2]>) -> String {
    of.map_or("runs = 30\n".to_owned(), |[vehicles, flights]| {
        format!("vehicles = {vehicles}\nflights = {flights}\n")
    })
}

/// What must be said of an event that no draw, or every draw, has seen: drawn so often, by vehicles or by runs.
fn expected(of: Option<[i64; 2]>, by_vehicles: bool, probability: f64) -> String {
    let [vehicles, flights] = of.unwrap_or([30, 1]);
    let (draws, what) =
        if by_vehicles { (vehicles, "vehicle") } else { (vehicles * flights, "run") };
    let once = if by_vehicles { ", drawn once for each vehicle," } else { "" };
    let seen = if probability > 0.5 { "seen in each of" } else { "not seen in" };
    let plural = if draws == 1 { "" } else { "s" };
    format!("An event with a probability of {probability}{once} was {seen} {draws} {what}{plural}.")
}

/// Events that never or always happen, drawn for vehicles or for flights, of separations and of simulators: what is said is of how many
/// draws there were.
#[test]
fn events_are_told_of_so_many_draws() {
    let base = ordinary(30, 0.01, "failure_probability = 0.5").to_toml();
    for of in SIZES {
        let drawn = [None, Some("flight"), Some("vehicle")];
        for drawn in drawn.into_iter().filter(|drawn| drawn.is_none() || of.is_some()) {
            for probability in [1e-12, 1.0 - 1e-12] {
                let by_vehicles = drawn == Some("vehicle");
                let said = expected(of, by_vehicles, probability);
                let also = drawn.map_or_else(String::new, |drawn| format!(", drawn = \"{drawn}\""));
                let law = format!("probability = {probability:?}{also}");

                let mut table: toml::Table = base.parse().unwrap();
                table.remove("runs");
                table.extend(size(of).parse::<toml::Table>().unwrap());
                // Of one spring, so that others push.
                for (place, spring) in
                    table["springs"].as_array_mut().unwrap().iter_mut().enumerate()
                {
                    let spring = spring.as_table_mut().unwrap();
                    spring.remove("dispersion");
                    if place == 0 {
                        let law =
                            format!("failure_probability = {{ {law} }}").parse::<toml::Table>();
                        spring.insert("dispersion".to_owned(), law.unwrap().into());
                    }
                }
                let scenario = Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap();
                let (summary, _) = study(&scenario);
                let page = scenario.report(&summary).markdown();
                assert_eq!(page.matches("An event with").count(), 1, "{page}");
                assert!(page.contains(&said), "{said} {page}");
                let written = serde_json::to_value(&summary.head.alerts).unwrap();
                let unmoved =
                    written.as_array().unwrap().iter().find(|alert| alert["alert"] == "unmoved");
                let vehicles = unmoved.unwrap().get("vehicles").and_then(serde_json::Value::as_i64);
                assert_eq!(vehicles, of.filter(|_| by_vehicles).map(|[vehicles, _]| vehicles));

                let text = format!(
                    "name = \"events\"\nseed = 5\n{}[simulation]\nfunction = \"counts\"\n[[simulation.outputs]]\nname = \"y\"\n\
                     [[quantities]]\nname = \"x\"\nlaw = {{ law = \"bernoulli\", {law} }}\n",
                    size(of)
                );
                let folder = tempfile::tempdir().unwrap();
                let counts = SimulatorFunction::new(|run: &RunInputs<'_>| {
                    Ok(vec![("y".to_owned(), run.input("x").ok_or("no x")?)])
                });
                let scenario = SimulatorScenario::from_toml(&text, folder.path()).unwrap();
                let out = folder.path().join("out");
                let options = Options::to(out.clone());
                scenario.with_function(counts).unwrap().study(&options, &|_| {}, &|_| {}).unwrap();
                let page = fs::read_to_string(out.join("report.md")).unwrap();
                assert_eq!(page.matches("An event with").count(), 1, "{page}");
                assert!(page.contains(&said), "{said} {page}");
            }
        }
    }
}

/// A folder of a version that said nothing of how many vehicles there were is still read.
#[test]
fn alerts_without_the_number_of_vehicles_are_read() {
    let text = r#"{"alert": "unmoved", "model": "m", "column": "c", "value": 0.0, "runs": 5, "one_vehicle": true, "probability": 0.1}"#;
    let alert: Alert = serde_json::from_str(text).unwrap();
    assert!(matches!(alert, Alert::Unmoved { vehicles: None, runs: 5, .. }), "{alert:?}");
}
