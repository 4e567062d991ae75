//! The probability of an event, as it stands in a scenario file.

use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{MapAccess, Visitor, value::MapAccessDeserializer},
};
use std::fmt;

use super::{each::Each, parse::whole_numbers};

/// A probability, and for what it is drawn whether the event is there: a number, or a table with both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChanceFile {
    pub(crate) probability: f64,
    pub(crate) drawn: Each,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    probability: f64,
    #[serde(default)]
    drawn: Each,
}

impl ChanceFile {
    /// The key of the probability itself; below that of the chance if this is a table.
    pub(crate) fn key(&self, chance: &str) -> String {
        if self.drawn.is_flight() { chance.to_owned() } else { format!("{chance}.probability") }
    }
}

impl Serialize for ChanceFile {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Self { probability, drawn } = *self;
        if drawn.is_flight() {
            to.serialize_f64(probability)
        } else {
            Table { probability, drawn }.serialize(to)
        }
    }
}

impl<'de> Deserialize<'de> for ChanceFile {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(ChanceVisitor)
    }
}

struct ChanceVisitor;

impl<'de> Visitor<'de> for ChanceVisitor {
    type Value = ChanceFile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a probability, or a table with probability and drawn")
    }

    fn visit_f64<E>(self, probability: f64) -> Result<ChanceFile, E> {
        Ok(ChanceFile { probability, drawn: Each::default() })
    }

    whole_numbers!();

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ChanceFile, A::Error> {
        let Table { probability, drawn } = Table::deserialize(MapAccessDeserializer::new(map))?;
        Ok(ChanceFile { probability, drawn })
    }
}
