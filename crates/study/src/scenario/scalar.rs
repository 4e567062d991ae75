//! A law of one number and for what it is drawn, as they stand in a scenario file.

use gyradius_dispersion::ScalarLawForm;
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{
        DeserializeSeed, Error, IntoDeserializer, MapAccess, Visitor, value::MapAccessDeserializer,
    },
};
use std::fmt;

use super::{
    each::{DRAWN, Each},
    parse::{unknown, whole_numbers},
};

/// A law of one number, and for what it is drawn: a key of the law's table, beside those of the law.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScalarLawFile {
    pub(crate) form: ScalarLawForm,
    pub(crate) drawn: Each,
}

/// As in a scenario: an inline table of TOML.
impl fmt::Display for ScalarLawFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let form = self.form.to_string();
        match form.strip_suffix(" }").filter(|_| !self.drawn.is_flight()) {
            Some(open) => {
                let drawn = toml::Value::try_from(self.drawn).map_err(|_| fmt::Error)?;
                write!(f, "{open}, {DRAWN} = {drawn} }}")
            }
            None => f.write_str(&form),
        }
    }
}

impl Serialize for ScalarLawFile {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Both<'a> {
            #[serde(flatten)]
            form: &'a ScalarLawForm,
            drawn: Each,
        }
        let Self { form, drawn } = self;
        // A number alone is drawn for each flight.
        if drawn.is_flight() {
            form.serialize(to)
        } else {
            Both { form, drawn: *drawn }.serialize(to)
        }
    }
}

impl<'de> Deserialize<'de> for ScalarLawFile {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(LawVisitor)
    }
}

struct LawVisitor;

impl<'de> Visitor<'de> for LawVisitor {
    type Value = ScalarLawFile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "a standard deviation, or a table with law, sigma, sigmas, mean, low, high, drawn",
        )
    }

    fn visit_f64<E: Error>(self, sigma: f64) -> Result<ScalarLawFile, E> {
        let form = ScalarLawForm::deserialize(sigma.into_deserializer())?;
        Ok(ScalarLawFile { form, drawn: Each::default() })
    }

    whole_numbers!();

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ScalarLawFile, A::Error> {
        let mut drawn = Each::default();
        let rest = OfLaw { map, drawn: &mut drawn };
        let form = ScalarLawForm::deserialize(MapAccessDeserializer::new(rest))?;
        Ok(ScalarLawFile { form, drawn })
    }
}

/// What of a table is of the law; for what it is drawn is put aside.
struct OfLaw<'a, A> {
    map: A,
    drawn: &'a mut Each,
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for OfLaw<'_, A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, A::Error> {
        while let Some(key) = self.map.next_key::<String>()? {
            if key == DRAWN {
                *self.drawn = self.map.next_value()?;
            } else if ScalarLawForm::keys().any(|known| known == key) {
                return seed.deserialize(key.into_deserializer()).map(Some);
            } else {
                let problem = unknown(&key, ScalarLawForm::keys().chain([DRAWN]));
                return Err(A::Error::custom(problem));
            }
        }
        Ok(None)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, A::Error> {
        self.map.next_value_seed(seed)
    }
}
