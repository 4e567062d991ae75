//! A model as it stands in a scenario file.

use gyradius_dispersion::{ModelKind, ModelParameters, UnknownModel};
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{DeserializeSeed, Error, MapAccess, Visitor},
    ser::SerializeMap,
};
use std::{fmt, marker::PhantomData, mem};

use super::parse::unknown;
use crate::body::Body;

/// A model: its law, and for each body what the law needs. Bodies are payload and stage, or have names of their own.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ModelFile<O = Body> {
    pub(crate) name: String,
    pub(crate) law: ModelLaw,
    pub(crate) axes: Option<AxesFile>,
    /// Their keys begin with the name of the body and an underscore.
    pub(crate) parameters: Vec<(O, ModelParameters)>,
    pub(crate) matched_to: Option<String>,
    pub(crate) outside: Option<OutsideFile>,
}

/// Whose parameters a model has in a file.
pub(crate) trait Owner: Clone + PartialEq + fmt::Debug {
    /// What it is called.
    fn name(&self) -> &str;
    /// Whose parameter a key is, and which one; none if it is no such key.
    fn of(key: &str) -> Option<(Self, &'static str)>;
    /// The keys of all parameters, for messages.
    fn keys() -> impl Iterator<Item = String>;
}

impl Owner for Body {
    fn name(&self) -> &str {
        Self::name(*self)
    }

    fn of(key: &str) -> Option<(Self, &'static str)> {
        parameters().find(|(body, parameter)| parameter_key(body, parameter) == key)
    }

    fn keys() -> impl Iterator<Item = String> {
        parameters().map(|(body, parameter)| parameter_key(&body, parameter))
    }
}

/// All parameters of payload and stage, in the order of files.
fn parameters() -> impl Iterator<Item = (Body, &'static str)> {
    let of = |body| ModelParameters::KEYS.iter().map(move |key| (body, *key));
    Body::BOTH.into_iter().flat_map(of)
}

/// What a file calls a parameter of a body.
pub(crate) fn parameter_key(body: &impl Owner, parameter: &str) -> String {
    prefix(body) + parameter
}

/// What the keys of a body's parameters begin with.
fn prefix(body: &impl Owner) -> String {
    format!("{}_", body.name())
}

impl<O: Owner> ModelFile<O> {
    /// With the parameters of these bodies in their order, and the defaults of its law filled in. Parameters of other bodies
    /// stay, to be refused.
    pub(crate) fn fill(&mut self, bodies: &[O]) {
        let defaults = match (self.law, &self.matched_to) {
            (ModelLaw::Kind(kind), None) => kind.defaults(),
            (ModelLaw::Kind(_), Some(_)) | (ModelLaw::Outside, _) => ModelParameters::default(),
        };
        let mut given = mem::take(&mut self.parameters);
        for body in bodies {
            let place = given.iter().position(|(other, _)| other == body);
            let own = place.map_or_else(ModelParameters::default, |place| given.remove(place).1);
            self.parameters.push((body.clone(), own.or(&defaults)));
        }
        self.parameters.append(&mut given);
    }
}

impl<O> Default for ModelFile<O> {
    fn default() -> Self {
        let (name, law, parameters) = (String::new(), ModelLaw::default(), Vec::new());
        Self { name, law, axes: None, parameters, matched_to: None, outside: None }
    }
}

/// The law of a model by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub(crate) enum ModelLaw {
    /// One that a program gives, and that no file holds.
    #[default]
    Outside,
    Kind(ModelKind),
}

const OUTSIDE: &str = "outside";

impl TryFrom<String> for ModelLaw {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        if name == OUTSIDE {
            return Ok(Self::Outside);
        }
        // What only a program can give is no choice for a file that somebody writes.
        name.parse().map(Self::Kind).map_err(|error: UnknownModel| error.to_string())
    }
}

impl From<ModelLaw> for String {
    fn from(law: ModelLaw) -> Self {
        match law {
            ModelLaw::Outside => OUTSIDE.to_owned(),
            ModelLaw::Kind(kind) => kind.name().to_owned(),
        }
    }
}

/// What a file can say of the laws of payload and stage that a program gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OutsideFile {
    /// What the laws call themselves.
    pub(crate) payload: String,
    pub(crate) stage: String,
    pub(crate) realizable_by_construction: bool,
    /// SHA-256 of draws of both, by which other laws are told apart.
    pub(crate) draws_sha256: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum AxesFile {
    WholeSphere,
    MeanHalf,
    JacobianTwice,
}

impl AxesFile {
    /// How many there are.
    pub(crate) const COUNT: usize = Self::JacobianTwice as usize + 1;
}

/// A key of a model.
enum Key<O> {
    Name,
    Law,
    Axes,
    Parameter(O, &'static str),
    MatchedTo,
    Outside,
}

const NAME: &str = "name";
const LAW: &str = "law";
const AXES: &str = "axes";
const MATCHED_TO: &str = "matched_to";

impl<O: Owner> Serialize for ModelFile<O> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Self { name, law, axes, parameters, matched_to, outside } = self;
        let mut map = to.serialize_map(None)?;
        map.serialize_entry(NAME, name)?;
        map.serialize_entry(LAW, law)?;
        if let Some(axes) = axes {
            map.serialize_entry(AXES, axes)?;
        }
        for (body, parameters) in parameters {
            parameters.write(&prefix(body), &mut map)?;
        }
        if let Some(matched_to) = matched_to {
            map.serialize_entry(MATCHED_TO, matched_to)?;
        }
        if let Some(outside) = outside {
            map.serialize_entry(OUTSIDE, outside)?;
        }
        map.end()
    }
}

/// By hand, for the keys of the parameters are those that the models declare.
impl<'de, O: Owner> Deserialize<'de> for ModelFile<O> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_map(Table(PhantomData))
    }
}

struct Table<O>(PhantomData<O>);

impl<'de, O: Owner> Visitor<'de> for Table<O> {
    type Value = ModelFile<O>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<ModelFile<O>, M::Error> {
        let mut file = ModelFile::default();
        let (mut name, mut law) = (None, None);
        while let Some(key) = map.next_key_seed(AnyKey(PhantomData))? {
            match key {
                Key::Name => name = Some(map.next_value()?),
                Key::Law => law = Some(map.next_value()?),
                Key::Axes => file.axes = Some(map.next_value()?),
                Key::Parameter(body, key) => {
                    let mut all = file.parameters.iter();
                    let place = all.position(|(other, _): &(O, _)| *other == body);
                    let place = place.unwrap_or_else(|| {
                        file.parameters.push((body, ModelParameters::default()));
                        file.parameters.len() - 1
                    });
                    file.parameters[place].1.read(key, &mut map)?;
                }
                Key::MatchedTo => file.matched_to = Some(map.next_value()?),
                Key::Outside => file.outside = Some(map.next_value()?),
            }
        }
        file.name = name.ok_or_else(|| M::Error::missing_field(NAME))?;
        file.law = law.ok_or_else(|| M::Error::missing_field(LAW))?;
        Ok(file)
    }
}

/// Refuses a key that is not known where it stands.
struct AnyKey<O>(PhantomData<O>);

impl<'de, O: Owner> DeserializeSeed<'de> for AnyKey<O> {
    type Value = Key<O>;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Key<O>, D::Error> {
        from.deserialize_identifier(self)
    }
}

impl<O: Owner> Visitor<'_> for AnyKey<O> {
    type Value = Key<O>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Key<O>, E> {
        match text {
            NAME => Ok(Key::Name),
            LAW => Ok(Key::Law),
            AXES => Ok(Key::Axes),
            MATCHED_TO => Ok(Key::MatchedTo),
            OUTSIDE => Ok(Key::Outside),
            other => O::of(other).map(|(body, key)| Key::Parameter(body, key)).ok_or_else(|| {
                let [first, last] = [&[NAME, LAW, AXES][..], &[MATCHED_TO, OUTSIDE]]
                    .map(|keys| keys.iter().map(|key| (*key).to_owned()));
                E::custom(unknown(text, first.chain(O::keys()).chain(last)))
            }),
        }
    }
}
