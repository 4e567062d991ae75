//! What the folder of a study holds, and what its runs depend on.

use gyradius_campaign::{Contents, Identity, MANIFEST};
use toml::{Table as Toml, Value};

use crate::{about::About, scenario::parse_toml, subject::Subject};

/// The keys of a scenario that all shards of a study share although its runs do not depend on them.
const SHARED: [&str; 3] = ["rows", "columns", "requirements"];

/// What a study writes, and the figures that it may write.
pub(crate) fn contents<C: Subject>(scenario: &C) -> Contents<'_> {
    let tables = scenario.model_names().map(|model| format!("runs/{model}/"));
    let others = ["scenario.toml", "summary.json", "runs/", MANIFEST].map(str::to_owned);
    // Fewer runs than a complete study has would take some away; the blocks of one that is not complete tell for themselves.
    let extends = |text: &str, complete: Option<u64>| {
        C::resolved(text).is_ok_and(|there| {
            complete.unwrap_or(there.runs()) <= scenario.runs()
                && identity(scenario).difference(&identity(&there)).is_none()
        })
    };
    let differs = |text: &str, complete: Option<u64>| {
        let there = C::resolved(text).ok()?;
        let difference = identity(scenario).difference(&identity(&there));
        let runs = complete.unwrap_or(there.runs());
        let fewer = || match (there.fleet(), scenario.fleet()) {
            (Some(there), Some(here)) => {
                format!("vehicles is {} there and {} here", runs / there.flights(), here.vehicles())
            }
            (Some(_) | None, _) => {
                format!("runs is {runs} there and {} here", scenario.runs())
            }
        };
        Some(difference.map_or_else(fewer, |difference| difference.to_string()))
    };
    let names: Vec<String> = tables.chain(scenario.report_files()).chain(others).collect();
    Contents::new("study", "scenario.toml", names, extends)
        .telling(differs)
        .trusting(|name| name.starts_with("runs/"))
}

/// What the runs of a scenario depend on.
pub(crate) fn identity<C: Subject>(scenario: &C) -> Identity {
    let mut fields = fields(scenario);
    let immaterial = || C::IMMATERIAL.iter().chain(&About::KEYS);
    fields.retain(|(field, _)| !immaterial().any(|key| is_of(field, key)));
    fields.push(("gyradius_version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()));
    fields.push(("block_runs".to_owned(), C::BLOCK_RUNS.to_string()));
    Identity::new(fields)
}

/// What shards must have in common beside that: what is kept of the runs, and what they are held against.
pub(crate) fn shared<C: Subject>(scenario: &C) -> Identity {
    let mut fields = fields(scenario);
    fields.retain(|(field, _)| SHARED.iter().any(|key| is_of(field, key)));
    Identity::new(fields)
}

/// Every value of a scenario by the path to it.
fn fields<C: Subject>(scenario: &C) -> Vec<(String, String)> {
    let mut fields = Vec::new();
    if let Ok(table) = parse_toml::<Toml>(&scenario.to_toml()) {
        flatten("", &Value::Table(table), &mut fields);
    }
    fields
}

/// Whether a field is a key of the scenario, or below it.
fn is_of(field: &str, key: &str) -> bool {
    field.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with(['[', '.']))
}

/// Every value in a table by the path to it.
fn flatten(path: &str, value: &Value, fields: &mut Vec<(String, String)>) {
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                flatten(&path, value, fields);
            }
        }
        Value::Array(values) if values.iter().any(Value::is_table) => {
            for (i, value) in values.iter().enumerate() {
                flatten(&format!("{path}[{}]", i + 1), value, fields);
            }
        }
        other => fields.push((path.to_owned(), other.to_string())),
    }
}
