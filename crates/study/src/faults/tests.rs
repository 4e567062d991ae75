//! What happens given each fault, held against counting in the run table.

use super::*;
use crate::{
    model::Model,
    study::{all_runs, judged},
};
use gyradius_statistics::Survey;
use proptest::prelude::*;
use std::fmt::Write;

/// The built-in study with faults of these probabilities of its springs, none where there is none, each drawn for a vehicle or not. Vehicles
/// of several flights have a mass of their own.
fn scenario(
    [vehicles, flights]: [u64; 2],
    faults: &[[Option<f64>; 2]],
    of_vehicles: [bool; 2],
    start: &str,
    requirements: &str,
) -> Scenario {
    let paper = Scenario::peck_2003().unwrap().to_toml();
    let fleet = flights > 1;
    let size = if fleet {
        format!("vehicles = {vehicles}\nflights = {flights}")
    } else {
        format!("runs = {vehicles}")
    };
    let mass = "mass_kg = { sigma = 500.0, drawn = \"vehicle\" }\n";
    let paper = paper.replacen("runs = 2000", &size, 1).replacen(
        "[payload.dispersion]\n",
        &format!("[payload.dispersion]\n{}", if fleet { mass } else { "" }),
        1,
    );
    let mut parts = paper.split("[[springs]]");
    let mut text = parts.next().unwrap().to_owned();
    for (part, [fails, late]) in parts.zip(faults) {
        let mut dispersion = "\n[springs.dispersion]\n".to_owned();
        for ((key, p), of_vehicle) in
            [("failure", fails), ("late", late)].into_iter().zip(of_vehicles)
        {
            if let Some(p) = p {
                let drawn = if fleet && of_vehicle { ", drawn = \"vehicle\"" } else { "" };
                writeln!(dispersion, "{key}_probability = {{ probability = {p:?}{drawn} }}")
                    .unwrap();
            }
        }
        if late.is_some() {
            writeln!(dispersion, "start_s = {start}").unwrap();
        }
        let (own, rest) = part.split_once("\n\n").unwrap_or((part, ""));
        let dispersion = if fails.is_some() || late.is_some() { dispersion } else { String::new() };
        write!(text, "[[springs]]{own}\n{dispersion}\n{rest}").unwrap();
    }
    let text = text.replacen("[[comparisons]]", &format!("{requirements}\n[[comparisons]]"), 1);
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

const REQUIREMENTS: &str = "[[requirements]]\nname = \"slow\"\nquantity = \"nutation_deg\"\nat_most = 7.0\n\
    probability = 0.9\nconfidence = 0.9\n[[requirements]]\nname = \"fast\"\nquantity = \"relative_speed_m_per_s\"\n\
    at_least = 0.9\nprobability = 0.9\nconfidence = 0.9\nmodel = \"naive\"\n";

/// Of the values of some runs, of which so many in a row are the flights of a vehicle.
fn of_vehicles_of(flights: u64, values: &[(u64, f64)]) -> SampleSummary {
    let confidence = Confidence::default();
    let survey = Survey::new(1 << 10).quantiles([0.05, 0.5, 0.95]);
    let mut survey = survey.quantile_interval_at(0.95, confidence).in_groups_of(flights);
    while let Some(mut pass) = survey.pass() {
        pass.extend(values.iter().copied());
        survey.advance(pass);
    }
    SampleSummary::of(&survey, confidence)
}

fn probability() -> impl Strategy<Value = Option<f64>> {
    prop_oneof![Just(None), (0.0..0.7).prop_map(Some), Just(Some(0.0)), Just(Some(1.0))]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Any subset of faults, of any probabilities, with vehicles of several flights or without: runs, failures, outcomes and requirements are
    /// those of counting in the table, and intervals take account of what the flights of a vehicle have in common.
    #[test]
    fn given_faults_are_those_of_counting(
        faults in prop::collection::vec([probability(), probability()], 4),
        of_vehicles in [any::<bool>(), any::<bool>()],
        runs in 20..120_u64,
        flights in 1..6_u64,
        start in prop_oneof![
            Just("{ law = \"uniform\", low = 0.0, high = 0.02 }"),
            Just("{ sigma = 0, mean = 0.2 }"),
            Just("{ sigma = 1e-6, mean = 50.0 }"),
        ],
    ) {
        let scenario = scenario([runs / flights, flights], &faults, of_vehicles, start, REQUIREMENTS);
        let models = Model::all(&scenario).unwrap();
        let summary = judged(&scenario, &models);
        let possible = faults.iter().flatten().flatten().count();
        for (model, runs) in summary.models.iter().zip(all_runs(&scenario, &models)) {
            if possible == 0 {
                prop_assert!(model.faults.is_empty());
                continue;
            }
            prop_assert_eq!(model.faults.len(), possible + 1);
            let table = runs.table().unwrap();
            for dispersed in &model.dispersed {
                let spring = dispersed.quantity.strip_suffix("_start_s");
                let late = spring.and_then(|spring| table.numbers(&format!("{spring}_late")));
                prop_assert_eq!(dispersed.late.is_some(), late.is_some());
                let Some((found, late)) = dispersed.late.zip(late) else { continue };
                let starts = table.numbers(&dispersed.quantity).unwrap();
                let of_late: Vec<f64> = (0..table.len())
                    .filter(|place| late.get(*place) == Some(1.0))
                    .filter_map(|place| starts.get(place))
                    .collect();
                let n = of_late.len() as f64;
                prop_assert_eq!(found.runs, of_late.len() as u64);
                let mean = of_late.iter().sum::<f64>() / n;
                let squares: f64 = of_late.iter().map(|x| (x - mean).powi(2)).sum();
                prop_assert_eq!((found.mean.is_some(), found.deviation.is_some()), (n > 0.0, n > 1.0));
                prop_assert!(found.mean.is_none_or(|x| (x - mean).abs() < 1e-12));
                let deviation = (squares / (n - 1.0)).sqrt();
                // What the runs in time have in common is no part of it.
                let rounding = 1e-14 * mean.abs() + 1e-12 * deviation;
                prop_assert!(found.deviation.is_none_or(|x| (x - deviation).abs() <= rounding), "{found:?} {deviation}");
            }
            let columns: Vec<String> = (1..=4)
                .flat_map(|spring| ["late", "failure"].map(|what| format!("spring_{spring}_{what}")))
                .filter(|column| table.numbers(column).is_some())
                .collect();
            for (place, given) in model.faults.iter().enumerate() {
                let there = |row: &gyradius_campaign::Row<'_>, column: &str| row.number(column) == Some(1.0);
                let mut rows: Vec<_> = table.rows().collect();
                rows.retain(|row| match place.checked_sub(1) {
                    Some(fault) => there(row, &columns[fault]),
                    None => columns.iter().all(|column| !there(row, column)),
                });
                match place.checked_sub(1).map(|fault| columns[fault].split('_').collect::<Vec<_>>()) {
                    Some(words) => {
                        let what = if words[2] == "late" { "is late" } else { "fails" };
                        prop_assert_eq!(given.fault.clone(), Some(format!("spring {} {what}", words[1])));
                    }
                    None => prop_assert_eq!(&given.fault, &None),
                }
                prop_assert_eq!(given.runs, rows.len() as u64);
                prop_assert_eq!(given.failed, rows.iter().filter(|row| row.failure().is_some()).count() as u64);
                for quantity in OUTCOMES {
                    let values = rows.iter().filter_map(|row| Some((row.run(), quantity.in_row(row)?)));
                    let expected = of_vehicles_of(flights, &values.collect::<Vec<_>>());
                    prop_assert_eq!(given.outcome(quantity).unwrap(), &expected);
                }
                let own: &[_] = if model.name == "naive" { &["slow", "fast"] } else { &["slow"] };
                let names: Vec<&str> = given.requirements.iter().map(|f| f.requirement.as_str()).collect();
                prop_assert_eq!(names, own);
                for failing in &given.requirements {
                    let keeps = |row: &&gyradius_campaign::Row<'_>| match failing.requirement.as_str() {
                        "slow" => row.number("nutation_deg").is_some_and(|x| x <= 7.0),
                        _ => row.number("relative_speed_m_per_s").is_some_and(|x| x >= 0.9),
                    };
                    prop_assert_eq!(failing.counted, rows.len() as u64);
                    prop_assert_eq!(failing.failures, (rows.len() - rows.iter().filter(keeps).count()) as u64);
                }
            }
        }
        let models: Vec<_> = summary.models.iter().map(|m| (m.name.as_str(), m.faults.as_slice())).collect();
        prop_assert_eq!(section(&models).is_some(), possible > 0);
        let written = serde_json::to_string(&summary).unwrap();
        let read: crate::Summary = serde_json::from_str(&written).unwrap();
        prop_assert!(read.models.iter().zip(&summary.models).all(|(a, b)| a.faults.len() == b.faults.len()));
    }
}
