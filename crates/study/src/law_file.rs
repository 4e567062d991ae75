//! A file with the laws of bodies and no scenario, as `gyradius model` and `gyradius fit` write them, ready to be drawn.

use gyradius_dispersion::{MassPropertiesLaw, ScalarLaw};
use gyradius_inertia::MassProperties;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;
use serde::Deserialize;
use std::{collections::BTreeMap, path::Path};

use crate::{
    FragmentBody, OffNominal, ScenarioError, SimulatorScenario, parse_toml,
    scenario::{AsGiven, DispersionFile, scenario_text},
    simulator::SimulatorDraws,
};

/// Bodies with their laws: a table for each, as a scenario has them for `[payload]`, `[stage]` or one of its `[[bodies]]`. They are drawn as
/// the bodies of a simulator with the model `principal` and whole-sphere axes, in the order of their names.
///
/// What a table does not say is filled in: the mass is not drawn if it is not known, and the mass centre is told from the nominal one. A
/// whole law (`law`) needs nothing beside it.
#[derive(Clone, Debug)]
pub struct LawFile {
    scenario: SimulatorScenario,
    names: Vec<String>,
    /// Columns of masses that nobody said.
    hidden: Vec<String>,
}

/// A body as it stands in the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LawBody {
    mass_kg: Option<f64>,
    mass_centre_m: Option<[f64; 3]>,
    inertia_kg_m2: Option<[[f64; 3]; 3]>,
    dispersion: Option<DispersionFile>,
    law: Option<AsGiven<MassPropertiesLaw>>,
}

/// Keys of tables of which one says that a table is a body with a law.
const OF_A_BODY: [&str; 3] = ["inertia_kg_m2", "dispersion", "law"];
/// The table that only statements have.
const NOMINAL: &str = "nominal";
/// Draws of a whole law whose mean principal moments stand for the nominal ones. Nothing that is drawn depends on it.
const DRAWS_OF_MEAN: usize = 256;

impl LawFile {
    /// Reads a file, if it is one of laws alone: TOML with a table for each body, or JSON as `gyradius model` and `gyradius fit` write it, or with one
    /// [`MassPropertiesLaw`], which is then of a payload. None if it is something else.
    ///
    /// # Errors
    /// The file cannot be read; it is one of statements, of which no law has been made; it has an unknown key, or a value that is not allowed.
    pub fn read(path: &Path) -> Result<Option<Self>, ScenarioError> {
        if !path.is_file() {
            return Ok(None);
        }
        let text = scenario_text(path)?;
        // TOML may begin with a byte order mark, and JSON, as it is read, may not.
        let text = text.trim_start_matches('\u{feff}');
        let file = || path.display();
        let read = if text.trim_start().starts_with('{') {
            of_json(text).map(Some)
        } else {
            let table = toml::from_str::<toml::Table>(text).ok();
            if table
                .as_ref()
                .is_some_and(|table| table.get(NOMINAL).is_some_and(toml::Value::is_table))
            {
                let problem = format!(
                    "the file states what is known of a body, and no law has been made of it: `gyradius model {} -o law.toml` makes \
                     one, and `gyradius draw law.toml` draws it",
                    file()
                );
                return Err(ScenarioError::field(NOMINAL, problem).in_file(path));
            }
            Ok(table.filter(is_of_laws).map(|_| text.to_owned()))
        };
        let read = read.and_then(|text| text.map(|text| Self::from_toml(&text)).transpose());
        read.map_err(|error| error.in_file(path))
    }

    /// Reads the text of a file that has a table for each body.
    ///
    /// # Errors
    /// It is not TOML, has an unknown key, or a value that is not allowed.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        let parse = |error: crate::TomlError| ScenarioError::Parse {
            path: None,
            message: error.to_string(),
        };
        let bodies: BTreeMap<String, LawBody> = parse_toml(text).map_err(parse)?;
        let given: BTreeMap<String, toml::Table> = parse_toml(text).map_err(parse)?;
        let (mut names, mut hidden, mut tables) = (Vec::new(), Vec::new(), Vec::new());
        for ((name, body), (_, mut table)) in bodies.into_iter().zip(given) {
            if body.fill(&name, &mut table)? {
                hidden.push(mass_column(&name));
            }
            table.insert("name".to_owned(), name.clone().into());
            names.push(name);
            tables.push(toml::Value::from(table));
        }
        let mut scenario = toml::Table::new();
        scenario.insert("name".to_owned(), "laws".into());
        let simulation = toml::Table::from_iter([("function".to_owned(), "none".into())]);
        scenario.insert("simulation".to_owned(), simulation.into());
        scenario.insert("bodies".to_owned(), tables.into());
        let scenario = SimulatorScenario::from_toml(&scenario.to_string(), Path::new("."));
        match scenario {
            Ok(scenario) => Ok(Self { scenario, names, hidden }),
            Err(ScenarioError::Field { field, problem }) => {
                let field = with_names(&field, &names);
                Err(ScenarioError::Field { field, problem: with_names(&problem, &names) })
            }
            Err(other) => Err(other),
        }
    }

    /// The same from another seed.
    ///
    /// # Errors
    /// The seed does not fit into a TOML integer.
    pub fn with_seed(self, seed: u64) -> Result<Self, ScenarioError> {
        Ok(Self { scenario: self.scenario.with_seed(seed)?, ..self })
    }

    /// The scenario of a simulator that has these bodies alone.
    #[must_use]
    pub fn scenario(&self) -> &SimulatorScenario {
        &self.scenario
    }

    /// What there is to doubt in the laws: all that there is in that scenario, but for distances of mass centres from the nominal ones, in sizes of a body
    /// whose mass nobody said.
    #[must_use]
    pub fn off_nominal(&self) -> Vec<OffNominal> {
        let is_known = |law: &OffNominal| {
            law.size_of().is_none_or(|body| !self.hidden.contains(&mass_column(body)))
        };
        self.scenario.off_nominal().into_iter().filter(is_known).collect()
    }

    /// A message about the bodies of that scenario, with the names of their tables in the place of `bodies[1]` and so on.
    #[must_use]
    pub fn in_its_words(&self, message: &str) -> String {
        with_names(message, &self.names)
    }

    /// What is drawn.
    pub(crate) fn draws(&self, place: usize) -> Result<SimulatorDraws<'_>, ScenarioError> {
        Ok(SimulatorDraws::new(&self.scenario, place)?.hiding(&self.hidden))
    }
}

fn mass_column(body: &str) -> String {
    format!("{body}_mass_kg")
}

fn with_names(text: &str, names: &[String]) -> String {
    let named = |text: String, (place, name): (usize, &String)| {
        text.replace(&format!("bodies[{}]", place + 1), name)
    };
    names.iter().enumerate().fold(text.to_owned(), named)
}

/// Whether a file has nothing but tables, each of which is a body with a law.
fn is_of_laws(table: &toml::Table) -> bool {
    let is_body = |value: &toml::Value| {
        value.as_table().is_some_and(|table| OF_A_BODY.iter().any(|key| table.contains_key(*key)))
    };
    !table.is_empty() && table.values().all(is_body)
}

impl LawBody {
    /// Fills in what the table of a body of this name does not say, and tells whether the mass is among it.
    fn fill(&self, name: &str, table: &mut toml::Table) -> Result<bool, ScenarioError> {
        let list = |row: &[f64; 3]| toml::Value::from(row.to_vec());
        let rows = |rows: [[f64; 3]; 3]| toml::Value::from(rows.each_ref().map(list).to_vec());
        let mut put = |key: &str, value: toml::Value| {
            table.entry(key.to_owned()).or_insert(value);
        };
        if let Some(law) = &self.law {
            let law = law.said();
            put("mass_kg", law.mass().mean().into());
            put("mass_centre_m", list(&law.centre().each_ref().map(ScalarLaw::mean)));
            if self.inertia_kg_m2.is_none() {
                put("inertia_kg_m2", rows(mean_inertia(law)));
            }
            return Ok(false);
        }
        let missing = |key: &str, by: &str| {
            Err(ScenarioError::field(format!("{name}.{key}"), format!("missing: {by} needs it")))
        };
        if self.inertia_kg_m2.is_none() {
            return missing("inertia_kg_m2", "a law of the inertia");
        }
        if let Some(dispersion) = &self.dispersion {
            if dispersion.mass_centre_m.is_some() && self.mass_centre_m.is_none() {
                put("mass_centre_m", list(&[0.0; 3]));
            }
            if let (Some(key), None) = (dispersion.needs_mass(), self.mass_kg) {
                return missing("mass_kg", &format!("{name}.dispersion.{key}"));
            }
        }
        // Without what needs it, nothing that is drawn depends on the mass.
        put("mass_kg", 1.0.into());
        Ok(self.mass_kg.is_none())
    }
}

/// About the mass centre, by rows, of draws with a fixed seed: the means of their principal moments from the least to the largest, since in
/// the means of entries axes that scatter mix the moments.
fn mean_inertia(law: &MassPropertiesLaw) -> [[f64; 3]; 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut mean = [0.0; 3];
    for _ in 0..DRAWS_OF_MEAN {
        let body: MassProperties = law.sample(&mut rng);
        let mut moments = body.inertia().principal_axes().moments();
        moments.sort_by(f64::total_cmp);
        mean = std::array::from_fn(|i| mean[i] + moments[i] / DRAWS_OF_MEAN as f64);
    }
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { mean[i] } else { 0.0 }))
}

/// The text of a file with a table for each body, of JSON.
fn of_json(text: &str) -> Result<String, ScenarioError> {
    let refused = |problem: String| ScenarioError::Parse { path: None, message: problem };
    let document: serde_json::Value =
        serde_json::from_str(text).map_err(|error| refused(error.to_string()))?;
    let said = |way: &[&str]| {
        let found = way.iter().try_fold(&document, |value, key| value.get(key));
        found.filter(|value| !value.is_null())
    };
    let body = said(&["fragment", "body"]).and_then(serde_json::Value::as_str);
    let body = body.map_or_else(|| FragmentBody::Payload.to_string(), str::to_owned);
    let itself = said(&["mass_kg"]).map(|_| &document);
    let law = itself
        .or_else(|| said(&["law", "mass_properties_law"]))
        .or_else(|| said(&["joint", "law"]));
    if let Some(law) = law {
        let law = toml::Value::try_from(without_nulls(law.clone()));
        let law = law.map_err(|error| refused(error.to_string()))?;
        let table = toml::Table::from_iter([("law".to_owned(), law)]);
        return Ok(toml::Table::from_iter([(body, table.into())]).to_string());
    }
    let fragment = said(&["fragment", "toml"]).and_then(serde_json::Value::as_str);
    fragment.map(str::to_owned).ok_or_else(|| {
        refused(
            "it holds no law: neither mass_kg, mass_centre_m and inertia of one, nor law.mass_properties_law, joint.law or fragment.toml, \
             as `gyradius model` and `gyradius fit` write them"
                .to_owned(),
        )
    })
}

/// TOML has no word for what is not there.
fn without_nulls(value: serde_json::Value) -> serde_json::Value {
    use serde_json::Value;
    match value {
        Value::Object(map) => {
            let there = map.into_iter().filter(|(_, value)| !value.is_null());
            Value::Object(there.map(|(key, value)| (key, without_nulls(value))).collect())
        }
        Value::Array(list) => Value::Array(list.into_iter().map(without_nulls).collect()),
        same @ (Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_)) => same,
    }
}
