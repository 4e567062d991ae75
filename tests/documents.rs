//! Tables in the documents are what the program finds.

use gyradius_dispersion::{ModelKind, ScalarLaw};
use gyradius_study::{CompareOptions, ModelComparison, Reference, Scenario};
use serde_json::Value;

const PAGE: &str = include_str!("../docs/compare.md");

/// The rows of the table after some words: cells without blanks and stars, its head first.
fn table(after: &str) -> Vec<Vec<&'static str>> {
    let text = &PAGE[PAGE.find(after).unwrap()..];
    let lines = text.lines().skip_while(|line| !line.starts_with('|'));
    let lines = lines.take_while(|line| line.starts_with('|')).filter(|line| !line.contains("---"));
    lines.map(|line| line.trim_matches('|').split('|').map(str::trim).collect()).collect()
}

fn compare(reference: Reference, models: Vec<ModelKind>) -> Value {
    let options = CompareOptions { reference, models, separations: 0, ..CompareOptions::default() };
    let comparison = ModelComparison::run(&options, &|_| {}).unwrap();
    serde_json::from_str(&comparison.to_json().unwrap()).unwrap()
}

/// The results of a model about a body at a level.
fn cell<'a>(comparison: &'a Value, body: &str, percent: &str, model: &str) -> Option<&'a Value> {
    let named = |list: &'a Value, key: &str, name: &str| {
        let list = list.as_array().unwrap();
        list.iter().find(|x| x[key].as_str() == Some(name)).unwrap()
    };
    let percent: f64 = percent.trim_end_matches(" %").parse().unwrap();
    let levels = named(&comparison["bodies"], "name", body)["levels"].as_array().unwrap();
    let level = levels.iter().find(|l| l["level_percent"].as_f64() == Some(percent)).unwrap();
    if level["models"].as_array().unwrap().is_empty() {
        return None;
    }
    let results = &named(&level["models"], "model", model)["results"];
    (!results.is_null()).then_some(results)
}

/// That three significant digits are those of a value.
#[track_caller]
fn same(written: &str, found: Option<f64>, of: &str) {
    let found = found.unwrap_or_else(|| panic!("{of}: there is no {written}"));
    let written: f64 = written.parse().unwrap();
    // Below that it is none.
    let last = if found < 1e-5 { 1e-5 } else { 10_f64.powf(found.log10().floor() - 2.0) };
    assert!((written - found).abs() <= 0.5001 * last, "{of}: {written} is {found}");
}

fn shares(comparison: &Value, after: &str, rows: usize) {
    let table = table(after);
    assert_eq!(table.len(), 1 + rows);
    for row in &table[1..] {
        for (percent, written) in table[0][2..].iter().zip(&row[2..]) {
            let of = format!("{} {} at {percent}", row[0], row[1]);
            let results = cell(comparison, row[0], percent, row[1]);
            let share = results.map(|r| 100.0 * r["unrealizable"]["share"].as_f64().unwrap());
            match *written {
                "–" => assert_eq!(share, None, "{of}"),
                "<0.04" => assert_eq!(share, Some(0.0), "{of}"),
                written => same(written, share, &of),
            }
        }
    }
}

/// A table of a number for each model, body and level. Numbers in brackets are of laws whose covariance is
/// off by more than 100 %.
fn numbers(comparison: &Value, after: &str, number: impl Fn(&Value) -> Option<f64>) {
    let table = table(after);
    assert_eq!((table.len(), table[0].len()), (9, 13));
    for row in &table[1..] {
        for (head, written) in table[0][1..].iter().zip(&row[1..]) {
            let (body, percent) = head.split_once(' ').unwrap();
            let of = format!("{} about {head}", row[0]);
            let results = cell(comparison, body, percent, row[0]).unwrap();
            let off = results["fit"]["covariance_off"].as_f64().unwrap();
            assert_eq!(written.starts_with('('), off > 1.0, "{of}");
            same(written.trim_matches(['(', ')']), number(results), &of);
        }
    }
}

fn spread(results: &Value, measure: &str, value: impl Fn(&Value) -> Option<f64>) -> Option<f64> {
    let spreads = results["spreads"].as_array().unwrap();
    value(spreads.iter().find(|s| s["measure"] == measure).unwrap())
}

#[test]
fn the_models_compare_as_the_page_says() {
    let found = compare(Reference::Principal, ModelKind::ALL.to_vec());
    shares(&found, "`gyradius compare` (seed 2003", 12);
    numbers(&found, "Width of the middle 90 % of the inertia ratio", |r| {
        spread(r, "inertia_ratio", |s| Some(s["p95"].as_f64()? - s["p05"].as_f64()?))
    });
    numbers(&found, "95th percentile of the wobble", |r| {
        spread(r, "wobble", |s| s["p95"].as_f64())
    });
    numbers(&found, "Covariance off the reference", |r| {
        Some(100.0 * r["fit"]["covariance_off"].as_f64()?)
    });
    // The other five draw none.
    for body in found["bodies"].as_array().unwrap() {
        for cell in
            body["levels"].as_array().unwrap().iter().flat_map(|l| l["models"].as_array().unwrap())
        {
            let gaussian = ["entrywise", "correlated-entries", "basilisk"];
            if !gaussian.contains(&cell["model"].as_str().unwrap()) && !cell["results"].is_null() {
                assert_eq!(cell["results"]["unrealizable"]["count"], 0);
            }
        }
    }
    let kinds = vec![ModelKind::ENTRYWISE, ModelKind::Basilisk];
    let found = compare(Reference::Entries, kinds);
    shares(&found, "`gyradius compare --reference entries`:", 8);
}

/// Every scalar law and each of its keys stand in the documents, and a scenario takes what they say.
#[test]
fn scalar_laws_are_written_as_the_page_says() {
    let page = include_str!("../docs/scenario.md");
    let laws = &page[page.find("A law is of the change from the nominal value").unwrap()..];
    let table = laws.lines().skip_while(|line| !line.starts_with('|'));
    let rows: Vec<&str> = table
        .take_while(|line| line.starts_with('|'))
        .filter_map(|line| line.split('`').nth(1))
        .collect();
    let scenario = Scenario::peck_2003().unwrap().to_toml();
    let place = "[payload.dispersion]";
    for row in &rows {
        let text = scenario.replacen(place, &format!("{place}\nmass_kg = {row}"), 1);
        Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{row}: {error}"));
    }
    let definitions = include_str!("../docs/models/dispersions.md").to_lowercase();
    for (name, keys) in ScalarLaw::names() {
        assert!(definitions.contains(&format!("\n| {}", name.replace('-', " "))), "{name}");
        // What is not given by name: the default, and the law of late and failed springs.
        if name != "normal" && name != "bernoulli" {
            let named = |row: &&str| row.contains(&format!("law = {name:?}"));
            assert!(rows.iter().any(named), "{name}");
            assert!(keys.iter().all(|key| laws.contains(*key)), "{name}: {keys:?}");
        }
    }
}
