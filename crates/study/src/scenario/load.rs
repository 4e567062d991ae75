//! A load between the bodies as it stands in a scenario file, of any kind: its keys follow from what the kind declares of
//! its parameters.

use gyradius_separation::{AnyLoad, Given, Load, LoadError, LoadId, LoadParameter, Parameter};
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{DeserializeSeed, Error, MapAccess, Visitor},
    ser::SerializeMap,
};
use std::{fmt, marker::PhantomData};

use super::{
    chance::ChanceFile,
    law::{GivenLaw, VectorLawFile},
    parse::unknown,
    scalar::ScalarLawFile,
};

/// A load of a kind as it stands in a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LoadFile<L: Load> {
    /// What is given of each parameter, in their order.
    values: Vec<Option<Value>>,
    dispersion: Option<LoadDispersionFile<L>>,
}

/// A parameter as it is given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
enum Value {
    Number(f64),
    Vector([f64; 3]),
}

/// How uncertain a load is.
#[derive(Clone, Debug, PartialEq)]
struct LoadDispersionFile<L: Load> {
    /// The law of each parameter, in their order.
    laws: Vec<LawFile>,
    late_probability: Option<ChanceFile>,
    failure_probability: Option<ChanceFile>,
    kind: PhantomData<L>,
}

/// Laws that are given of a parameter.
#[derive(Clone, Debug, Default, PartialEq)]
struct LawFile {
    number: Option<ScalarLawFile>,
    percent: Option<ScalarLawFile>,
    vector: Option<VectorLawFile>,
}

/// A load of a file, of whichever kind.
pub(crate) trait GivenLoad {
    /// The load, or the key of what is wrong and why.
    fn load(&self) -> Result<AnyLoad, (String, LoadError)>;
    /// Every key with a number, the numbers, and the greatest magnitude that they may have.
    fn sizes(&self) -> Vec<(String, Vec<f64>, f64)>;
    /// What its dispersion says of each parameter; none if it has no dispersion.
    fn dispersion(&self) -> Option<GivenDispersion<'_>>;
}

/// What the dispersion of a load says.
pub(crate) struct GivenDispersion<'a> {
    pub(crate) parameters: Vec<(LoadParameter, Uncertain<'a>)>,
    /// Which parameter says when it starts.
    pub(crate) start: Option<LoadParameter>,
    pub(crate) late_probability: Option<ChanceFile>,
    pub(crate) failure_probability: Option<ChanceFile>,
}

/// A parameter that may be uncertain.
pub(crate) struct Uncertain<'a> {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) nominal: Vec<f64>,
    pub(crate) law: GivenLaw<'a>,
}

/// Loads of a kind, and which they are.
pub(super) fn given<L>(files: &[LoadFile<L>]) -> impl Iterator<Item = (LoadId, &dyn GivenLoad)>
where
    L: Load<Parameter: Into<LoadParameter>, Error: Into<LoadError>> + Into<AnyLoad>,
{
    let id = |number| LoadId { kind: L::KIND, number };
    files.iter().enumerate().map(move |(i, file)| (id(i), file as &dyn GivenLoad))
}

/// The key of a load.
pub(super) fn key(load: LoadId) -> String {
    format!("{}[{}]", load.kind.plural(), load.number + 1)
}

impl<L: Load> LoadFile<L> {
    /// A component of a parameter, zero if it is not given.
    fn value(&self, parameter: L::Parameter, component: usize) -> f64 {
        let mut all = L::Parameter::ALL.iter().zip(&self.values);
        match all.find(|(other, _)| **other == parameter) {
            Some((_, Some(Value::Number(value)))) => *value,
            Some((_, Some(Value::Vector(values)))) => values[component],
            Some((_, None)) | None => 0.0,
        }
    }
}

impl<L> GivenLoad for LoadFile<L>
where
    L: Load<Parameter: Into<LoadParameter>, Error: Into<LoadError>> + Into<AnyLoad>,
{
    fn load(&self) -> Result<AnyLoad, (String, LoadError)> {
        let load = L::from_values(|parameter, component| self.value(parameter, component));
        load.map(Into::into).map_err(|error| (L::refused(&error).key(), error.into()))
    }

    fn sizes(&self) -> Vec<(String, Vec<f64>, f64)> {
        let given = L::Parameter::ALL.iter().zip(&self.values);
        let sizes = given.filter_map(|(parameter, value)| {
            let values = match value.as_ref()? {
                Value::Number(value) => vec![*value],
                Value::Vector(values) => values.to_vec(),
            };
            Some((parameter.key(), values, parameter.given().most()?))
        });
        sizes.collect()
    }

    fn dispersion(&self) -> Option<GivenDispersion<'_>> {
        let dispersion = self.dispersion.as_ref()?;
        let mut parameters = Vec::new();
        for (&parameter, law) in L::Parameter::ALL.iter().zip(&dispersion.laws) {
            let components = 0..parameter.components();
            let law = if components.len() == 1 {
                GivenLaw::Number(law.number.as_ref(), law.percent.as_ref())
            } else {
                GivenLaw::Vector(law.vector.as_ref())
            };
            let nominal = components.map(|component| self.value(parameter, component)).collect();
            let (name, unit) = (parameter.name(), parameter.unit());
            parameters.push((parameter.into(), Uncertain { name, unit, nominal, law }));
        }
        Some(GivenDispersion {
            parameters,
            start: L::START.map(Into::into),
            late_probability: dispersion.late_probability,
            failure_probability: dispersion.failure_probability,
        })
    }
}

/// What may stand in the table of a load.
#[derive(Clone, Copy)]
enum Entry {
    /// A parameter, by its place.
    Value(usize),
    Dispersion,
}

/// What may stand in its dispersion.
#[derive(Clone, Copy)]
enum DispersionEntry {
    Law(usize),
    Percent(usize),
    LateProbability,
    FailureProbability,
}

const DISPERSION: &str = "dispersion";
const LATE: &str = "late_probability";
const FAILURE: &str = "failure_probability";

/// The keys of a load: what must be given first.
fn entries<P: Parameter>() -> Vec<(String, Entry)> {
    let of = |must: bool| {
        let all = P::ALL.iter().enumerate().filter(move |(_, parameter)| match parameter.given() {
            Given::Always(_) => must,
            Given::OrZero(_) => !must,
            Given::Never => false,
        });
        all.map(|(i, parameter)| (parameter.key(), Entry::Value(i)))
    };
    let dispersion = (DISPERSION.to_owned(), Entry::Dispersion);
    of(true).chain(of(false)).chain([dispersion]).collect()
}

/// The keys of its dispersion.
fn dispersion_entries<L: Load>() -> Vec<(String, DispersionEntry)> {
    let mut entries = Vec::new();
    for (i, parameter) in L::Parameter::ALL.iter().enumerate() {
        entries.push((parameter.key(), DispersionEntry::Law(i)));
        // A share of what may be zero says nothing.
        if parameter.components() == 1 && matches!(parameter.given(), Given::Always(_)) {
            entries.push((percent(parameter.name()), DispersionEntry::Percent(i)));
        }
    }
    if L::START.is_some() {
        entries.push((LATE.to_owned(), DispersionEntry::LateProbability));
    }
    entries.push((FAILURE.to_owned(), DispersionEntry::FailureProbability));
    entries
}

/// The key of a law in percent.
pub(super) fn percent(name: &str) -> String {
    format!("{name}_percent")
}

impl<L: Load> Serialize for LoadFile<L> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (key, entry) in entries::<L::Parameter>() {
            match entry {
                Entry::Value(i) => entry_of(&mut map, &key, self.values[i].as_ref())?,
                Entry::Dispersion => entry_of(&mut map, &key, self.dispersion.as_ref())?,
            }
        }
        map.end()
    }
}

impl<L: Load> Serialize for LoadDispersionFile<L> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (key, entry) in dispersion_entries::<L>() {
            match entry {
                DispersionEntry::Law(i) => {
                    entry_of(&mut map, &key, self.laws[i].number.as_ref())?;
                    entry_of(&mut map, &key, self.laws[i].vector.as_ref())?;
                }
                DispersionEntry::Percent(i) => {
                    entry_of(&mut map, &key, self.laws[i].percent.as_ref())?;
                }
                DispersionEntry::LateProbability => {
                    entry_of(&mut map, &key, self.late_probability.as_ref())?;
                }
                DispersionEntry::FailureProbability => {
                    entry_of(&mut map, &key, self.failure_probability.as_ref())?;
                }
            }
        }
        map.end()
    }
}

fn entry_of<M: SerializeMap>(
    map: &mut M,
    key: &str,
    value: Option<&impl Serialize>,
) -> Result<(), M::Error> {
    value.map_or(Ok(()), |value| map.serialize_entry(key, value))
}

impl<'de, L: Load> Deserialize<'de> for LoadFile<L> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Table::<Self>(PhantomData))
    }
}

impl<'de, L: Load> Deserialize<'de> for LoadDispersionFile<L> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Table::<Self>(PhantomData))
    }
}

/// A table that is read.
struct Table<T>(PhantomData<T>);

impl<'de, L: Load> Visitor<'de> for Table<LoadFile<L>> {
    type Value = LoadFile<L>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("struct LoadFile")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<LoadFile<L>, A::Error> {
        let parameters = L::Parameter::ALL;
        let mut file = LoadFile { values: vec![None; parameters.len()], dispersion: None };
        let entries = entries::<L::Parameter>();
        while let Some(entry) = map.next_key_seed(OneOf(&entries))? {
            match entry {
                Entry::Value(i) if parameters[i].components() == 1 => {
                    file.values[i] = Some(Value::Number(map.next_value()?));
                }
                Entry::Value(i) => file.values[i] = Some(Value::Vector(map.next_value()?)),
                Entry::Dispersion => file.dispersion = Some(map.next_value()?),
            }
        }
        for (parameter, value) in parameters.iter().zip(&file.values) {
            if value.is_none() && matches!(parameter.given(), Given::Always(_)) {
                return Err(A::Error::custom(format!("missing field `{}`", parameter.key())));
            }
        }
        Ok(file)
    }
}

impl<'de, L: Load> Visitor<'de> for Table<LoadDispersionFile<L>> {
    type Value = LoadDispersionFile<L>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("struct LoadDispersionFile")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<LoadDispersionFile<L>, A::Error> {
        let parameters = L::Parameter::ALL;
        let mut file = LoadDispersionFile {
            laws: vec![LawFile::default(); parameters.len()],
            late_probability: None,
            failure_probability: None,
            kind: PhantomData,
        };
        let entries = dispersion_entries::<L>();
        while let Some(entry) = map.next_key_seed(OneOf(&entries))? {
            match entry {
                DispersionEntry::Law(i) if parameters[i].components() == 1 => {
                    file.laws[i].number = Some(map.next_value()?);
                }
                DispersionEntry::Law(i) => file.laws[i].vector = Some(map.next_value()?),
                DispersionEntry::Percent(i) => file.laws[i].percent = Some(map.next_value()?),
                DispersionEntry::LateProbability => file.late_probability = Some(map.next_value()?),
                DispersionEntry::FailureProbability => {
                    file.failure_probability = Some(map.next_value()?);
                }
            }
        }
        Ok(file)
    }
}

/// Which of the keys of a table comes next; what is none of them is refused.
struct OneOf<'a, E>(&'a [(String, E)]);

impl<'de, E: Copy> DeserializeSeed<'de> for OneOf<'_, E> {
    type Value = E;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<E, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl<E: Copy> Visitor<'_> for OneOf<'_, E> {
    type Value = E;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("field identifier")
    }

    fn visit_str<X: Error>(self, key: &str) -> Result<E, X> {
        let known = self.0.iter().find(|(known, _)| known == key);
        let keys = || self.0.iter().map(|(key, _)| key);
        known.map(|(_, entry)| *entry).ok_or_else(|| X::custom(unknown(key, keys())))
    }
}

#[cfg(test)]
mod tests {
    use crate::{Quantity, Scenario};
    use gyradius_separation::AnyLoad;
    use rand_chacha::{
        ChaCha8Rng,
        rand_core::{Rng, SeedableRng},
    };
    use toml::{Table, Value};

    fn point(x: f64, z: f64) -> Value {
        [x, 0.2, z].map(Value::from).to_vec().into()
    }

    /// The paper's bodies between loads of one kind.
    fn with(kind: &str, loads: Vec<Table>) -> Result<Scenario, String> {
        let mut file: Table = Scenario::peck_2003().unwrap().to_toml().parse().unwrap();
        file.remove("springs");
        file.insert(kind.to_owned(), loads.into_iter().map(Value::from).collect::<Vec<_>>().into());
        Scenario::from_toml(&toml::to_string(&file).unwrap()).map_err(|error| error.to_string())
    }

    /// Of every kind there is: a load of what the messages say that it must be given is one of the separation's, has its
    /// column, and is written as it is read.
    #[test]
    fn every_kind_is_read() {
        for kind in AnyLoad::KINDS {
            let mut load = Table::new();
            let scenario = loop {
                match with(kind.plural(), vec![load.clone(), load.clone()]) {
                    Ok(scenario) => break scenario,
                    Err(message) => {
                        let missing = message.split("missing field `").nth(1);
                        let missing = missing.and_then(|rest| rest.split('`').next());
                        let key = missing.unwrap_or_else(|| panic!("{kind}: {message}"));
                        let value = match key {
                            "payload_point_m" => point(0.1, -0.9),
                            "stage_point_m" => point(0.1, 0.9),
                            _ => 0.1.into(),
                        };
                        assert!(load.insert(key.to_owned(), value).is_none(), "{message}");
                    }
                }
            };
            let ids: Vec<_> = scenario.separation().loads().map(|(id, _)| id.to_string()).collect();
            assert_eq!(ids, [1, 2].map(|number| format!("{kind} {number}")));
            let columns: Vec<_> =
                Quantity::of(scenario.separation()).map(Quantity::column).collect();
            assert!(columns.contains(&format!("{kind}_2_release_s").into()), "{columns:?}");
            let again = Scenario::from_toml(&scenario.to_toml()).unwrap();
            assert_eq!(again.fingerprint(), scenario.fingerprint());
        }
    }

    /// Any of the keys of a spring that may be left out: those that are given, and no others, are drawn, in the order of the
    /// run table, and are written as they are read.
    #[test]
    fn any_keys_of_a_dispersion_are_drawn() {
        let law = |mean: f64| -> Value {
            let law = [("law", "lognormal".into()), ("mean", mean.into()), ("sigma", 0.01.into())];
            Value::Table(
                law.map(|(key, value): (&str, Value)| (key.to_owned(), value))
                    .into_iter()
                    .collect(),
            )
        };
        let all: [(&str, Value, &[&str]); 9] = [
            ("stiffness_n_per_m", 10.0.into(), &["stiffness_n_per_m"]),
            ("stroke_percent", 1.0.into(), &["stroke_m"]),
            ("friction_n", law(1.0), &["friction_n"]),
            ("line_of_action_deg", 0.1.into(), &["line_of_action_1_deg", "line_of_action_2_deg"]),
            (
                "payload_point_m",
                0.01.into(),
                &["payload_point_1_m", "payload_point_2_m", "payload_point_3_m"],
            ),
            (
                "stage_point_m",
                0.01.into(),
                &["stage_point_1_m", "stage_point_2_m", "stage_point_3_m"],
            ),
            ("start_s", law(0.02), &["start_s"]),
            ("late_probability", 0.5.into(), &["late"]),
            ("failure_probability", 0.1.into(), &["failure"]),
        ];
        let mut generator = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..300 {
            let chosen = generator.next_u64();
            let given = || all.iter().enumerate().filter(|(i, _)| chosen >> i & 1 == 1);
            let dispersion = given().map(|(_, (key, law, _))| ((*key).to_owned(), law.clone()));
            let mut spring = Table::new();
            spring.insert("stiffness_n_per_m".into(), 1e4.into());
            spring.insert("stroke_m".into(), 0.1.into());
            spring.insert("payload_point_m".into(), point(0.0, -0.9));
            spring.insert("stage_point_m".into(), point(0.0, 0.9));
            for (bit, key, value) in [(10, "friction_n", 2.0), (11, "start_s", 0.01)] {
                if chosen >> bit & 1 == 1 {
                    spring.insert(key.into(), value.into());
                }
            }
            let plain = spring.clone();
            spring.insert("dispersion".into(), Value::Table(dispersion.collect()));
            let read = with("springs", vec![plain, spring]);
            let has = |key: &str| given().any(|(_, (given, ..))| *given == key);
            if has("late_probability") && !has("start_s") {
                let message = read.unwrap_err();
                assert!(
                    message.starts_with("springs[2].dispersion.late_probability: "),
                    "{message}"
                );
                continue;
            }
            let scenario = read.unwrap();
            let names = given().flat_map(|(_, (.., names))| *names);
            let names: Vec<_> = names.map(|name| format!("spring_2_{name}")).collect();
            assert_eq!(scenario.dispersions().columns(), names);
            let again = Scenario::from_toml(&scenario.to_toml()).unwrap();
            assert_eq!(again.fingerprint(), scenario.fingerprint());
        }
    }
}
