//! A load between the bodies as it stands in a scenario file, of any kind: its keys follow from what the kind declares of
//! its parameters.

use gyradius_dispersion::ScalarLawForm;
use gyradius_separation::{AnyLoad, Given, Load, LoadError, LoadId, LoadParameter, Parameter};
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{DeserializeSeed, Error, MapAccess, Visitor},
    ser::SerializeMap,
};
use std::{fmt, marker::PhantomData};

use super::law::{GivenLaw, VectorLawFile};

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
    late_probability: Option<f64>,
    failure_probability: Option<f64>,
    kind: PhantomData<L>,
}

/// Laws that are given of a parameter.
#[derive(Clone, Debug, Default, PartialEq)]
struct LawFile {
    number: Option<ScalarLawForm>,
    percent: Option<ScalarLawForm>,
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
    pub(crate) late_probability: Option<f64>,
    pub(crate) failure_probability: Option<f64>,
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
        known.map(|(_, entry)| *entry).ok_or_else(|| {
            let keys: Vec<_> = self.0.iter().map(|(key, _)| format!("`{key}`")).collect();
            X::custom(format!("unknown field `{key}`, expected one of {}", keys.join(", ")))
        })
    }
}
