//! A model as it stands in a scenario file.

use gyradius_dispersion::{ModelKind, ModelParameters, UnknownModel};
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{DeserializeSeed, Error, MapAccess, Visitor},
    ser::SerializeMap,
};
use std::fmt;

use crate::body::Body;

/// A model: its law, and for each body what the law needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ModelFile {
    pub(crate) name: String,
    pub(crate) law: ModelLaw,
    pub(crate) axes: Option<AxesFile>,
    /// Their keys begin with `payload_`.
    pub(crate) payload: ModelParameters,
    /// Their keys begin with `stage_`.
    pub(crate) stage: ModelParameters,
    pub(crate) matched_to: Option<String>,
    pub(crate) outside: Option<OutsideFile>,
}

impl ModelFile {
    /// With the defaults of its law filled in.
    pub(crate) fn fill(&mut self) {
        if let (ModelLaw::Kind(kind), None) = (self.law, &self.matched_to) {
            for parameters in [&mut self.payload, &mut self.stage] {
                *parameters = parameters.or(&kind.defaults());
            }
        }
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
        name.parse().map(Self::Kind).map_err(|error: UnknownModel| format!("{error}, {OUTSIDE}"))
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

/// A key of a model.
enum Key {
    Name,
    Law,
    Axes,
    Parameter(Body, &'static str),
    MatchedTo,
    Outside,
}

const NAME: &str = "name";
const LAW: &str = "law";

impl Key {
    /// What a file calls it.
    fn text(&self) -> String {
        match self {
            Self::Name => NAME.to_owned(),
            Self::Law => LAW.to_owned(),
            Self::Axes => "axes".to_owned(),
            Self::Parameter(body, key) => format!("{}{key}", prefix(*body)),
            Self::MatchedTo => "matched_to".to_owned(),
            Self::Outside => OUTSIDE.to_owned(),
        }
    }

    /// All of them, in the order of files.
    fn all() -> impl Iterator<Item = Self> {
        let of = |body| ModelParameters::KEYS.iter().map(move |key| Self::Parameter(body, key));
        let parameters = of(Body::Payload).chain(of(Body::Stage));
        let first = [Self::Name, Self::Law, Self::Axes].into_iter();
        first.chain(parameters).chain([Self::MatchedTo, Self::Outside])
    }
}

/// What the keys of a body's parameters begin with.
fn prefix(body: Body) -> String {
    format!("{}_", body.name())
}

impl Serialize for ModelFile {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Self { name, law, axes, payload, stage, matched_to, outside } = self;
        let mut map = to.serialize_map(None)?;
        map.serialize_entry(NAME, name)?;
        map.serialize_entry(LAW, law)?;
        if let Some(axes) = axes {
            map.serialize_entry(&Key::Axes.text(), axes)?;
        }
        payload.write(&prefix(Body::Payload), &mut map)?;
        stage.write(&prefix(Body::Stage), &mut map)?;
        if let Some(matched_to) = matched_to {
            map.serialize_entry(&Key::MatchedTo.text(), matched_to)?;
        }
        if let Some(outside) = outside {
            map.serialize_entry(&Key::Outside.text(), outside)?;
        }
        map.end()
    }
}

/// By hand, for the keys of the parameters are those that the models declare.
impl<'de> Deserialize<'de> for ModelFile {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_map(Table)
    }
}

struct Table;

impl<'de> Visitor<'de> for Table {
    type Value = ModelFile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<ModelFile, M::Error> {
        let mut file = ModelFile::default();
        let (mut name, mut law) = (None, None);
        while let Some(key) = map.next_key_seed(AnyKey)? {
            match key {
                Key::Name => name = Some(map.next_value()?),
                Key::Law => law = Some(map.next_value()?),
                Key::Axes => file.axes = Some(map.next_value()?),
                Key::Parameter(Body::Payload, key) => file.payload.read(key, &mut map)?,
                Key::Parameter(Body::Stage, key) => file.stage.read(key, &mut map)?,
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
struct AnyKey;

impl<'de> DeserializeSeed<'de> for AnyKey {
    type Value = Key;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Key, D::Error> {
        from.deserialize_identifier(self)
    }
}

impl Visitor<'_> for AnyKey {
    type Value = Key;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Key, E> {
        Key::all().find(|key| key.text() == text).ok_or_else(|| {
            let known: Vec<String> = Key::all().map(|key| format!("`{}`", key.text())).collect();
            E::custom(format!("unknown field `{text}`, expected one of {}", known.join(", ")))
        })
    }
}
