//! Values of TOML, read by serde so that an error knows the path of the value that is wrong.

use serde::{
    Deserializer,
    de::{
        DeserializeSeed, EnumAccess, Error, Expected, IntoDeserializer, MapAccess, SeqAccess,
        Unexpected, VariantAccess, Visitor, value::StringDeserializer,
    },
    forward_to_deserialize_any,
};
use std::fmt;
use toml::{Table, Value, map};

/// A value, whose errors say where below it they are.
#[derive(Clone, Debug)]
pub(super) struct Placed(pub(super) Value);

/// A step from a value to one that it holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// The value of a key.
    Key(String),
    /// An entry of a list, counted from 0.
    Entry(usize),
}

/// The way to a value as all messages write it: entries of lists are counted from 1.
pub(super) fn said<'a>(steps: impl Iterator<Item = &'a Step>) -> String {
    let mut out = String::new();
    for step in steps {
        match step {
            Step::Entry(index) => out.push_str(&format!("[{}]", index + 1)),
            Step::Key(key) if out.is_empty() => out.push_str(key),
            Step::Key(key) => out.push_str(&format!(".{key}")),
        }
    }
    out
}

/// What is wrong with a value, and the way to it.
#[derive(Clone, Debug)]
pub(super) struct Misplaced {
    pub(super) reason: String,
    /// From the value that is wrong outwards.
    outwards: Vec<Step>,
}

impl Misplaced {
    fn below(mut self, step: Step) -> Self {
        self.outwards.push(step);
        self
    }

    /// The steps to the value that is wrong.
    pub(super) fn path(&self) -> impl Iterator<Item = &Step> {
        self.outwards.iter().rev()
    }

    /// The path as all messages write it.
    pub(super) fn said(&self) -> String {
        said(self.path())
    }
}

impl fmt::Display for Misplaced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}

impl std::error::Error for Misplaced {}

impl Error for Misplaced {
    fn custom<T: fmt::Display>(reason: T) -> Self {
        Self { reason: reason.to_string(), outwards: Vec::new() }
    }
}

impl<'de> Deserializer<'de> for Placed {
    type Error = Misplaced;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misplaced> {
        match self.0 {
            Value::String(text) => visitor.visit_string(text),
            Value::Integer(number) => visitor.visit_i64(number),
            Value::Float(number) => visitor.visit_f64(number),
            Value::Boolean(yes) => visitor.visit_bool(yes),
            Value::Datetime(date) => Err(Error::custom(format!(
                "{date} is a date or a time, which no key takes: as text it must be in quotation marks"
            ))),
            Value::Array(list) => {
                let count = list.len();
                let mut entries = Entries { rest: list.into_iter(), next: 0 };
                let read = visitor.visit_seq(&mut entries)?;
                // What reads three numbers passes over a fourth.
                match entries.rest.len() {
                    0 => Ok(read),
                    _ => Err(Error::invalid_length(count, &"fewer entries in this list")),
                }
            }
            Value::Table(table) => visitor.visit_map(Keys::of(table)),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Misplaced> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Misplaced> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misplaced> {
        match self.0 {
            Value::String(variant) => visitor.visit_enum(variant.into_deserializer()),
            Value::Table(table) if table.len() == 1 => visitor.visit_enum(Keys::of(table)),
            // A word out of several, for which serde would take a table as well.
            other @ (Value::Integer(_)
            | Value::Float(_)
            | Value::Boolean(_)
            | Value::Datetime(_)
            | Value::Array(_)
            | Value::Table(_)) => Err(Error::invalid_type(unexpected(&other), &OneOf(variants))),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map struct identifier ignored_any
    }
}

/// What stands where something else should.
fn unexpected(value: &Value) -> Unexpected<'_> {
    match value {
        Value::String(text) => Unexpected::Str(text),
        Value::Integer(number) => Unexpected::Signed(*number),
        Value::Float(number) => Unexpected::Float(*number),
        Value::Boolean(yes) => Unexpected::Bool(*yes),
        Value::Datetime(_) => Unexpected::Other("date or time"),
        Value::Array(_) => Unexpected::Seq,
        Value::Table(_) => Unexpected::Map,
    }
}

/// One of some words.
struct OneOf(&'static [&'static str]);

impl Expected for OneOf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words: Vec<_> = self.0.iter().map(|word| format!("\"{word}\"")).collect();
        write!(f, "one of {}", words.join(", "))
    }
}

/// The entries of a list.
struct Entries {
    rest: std::vec::IntoIter<Value>,
    next: usize,
}

impl<'de> SeqAccess<'de> for &mut Entries {
    type Error = Misplaced;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Misplaced> {
        let Some(entry) = self.rest.next() else {
            return Ok(None);
        };
        let step = Step::Entry(self.next);
        self.next += 1;
        seed.deserialize(Placed(entry)).map(Some).map_err(|error| error.below(step))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

/// The keys of a table, with the value of the key that was read last.
struct Keys {
    rest: map::IntoIter<String, Value>,
    last: Option<(String, Value)>,
}

impl Keys {
    fn of(table: Table) -> Self {
        Self { rest: table.into_iter(), last: None }
    }

    /// Reads the next key, which is kept with its value.
    fn key<'de, K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Misplaced> {
        self.last = self.rest.next();
        let Some((key, _)) = &self.last else {
            return Ok(None);
        };
        let given: StringDeserializer<Misplaced> = key.clone().into_deserializer();
        seed.deserialize(given).map(Some).map_err(|error| error.below(Step::Key(key.clone())))
    }

    /// Reads the value of the key that was read last.
    fn value<T>(
        &mut self,
        read: impl FnOnce(Value) -> Result<T, Misplaced>,
    ) -> Result<T, Misplaced> {
        let (key, value) =
            self.last.take().ok_or_else(|| Misplaced::custom("a value without a key"))?;
        read(value).map_err(|error| error.below(Step::Key(key)))
    }
}

impl<'de> MapAccess<'de> for Keys {
    type Error = Misplaced;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Misplaced> {
        self.key(seed)
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Misplaced> {
        self.value(|value| seed.deserialize(Placed(value)))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

/// A table of one key is a variant with what it holds.
impl<'de> EnumAccess<'de> for Keys {
    type Error = Misplaced;
    type Variant = Self;

    fn variant_seed<T: DeserializeSeed<'de>>(
        mut self,
        seed: T,
    ) -> Result<(T::Value, Self), Misplaced> {
        // That a variant is unknown is wrong with the table.
        let variant = self.key(seed).map_err(|error| Misplaced::custom(error.reason))?;
        Ok((variant.ok_or_else(|| Misplaced::custom("a variant is missing"))?, self))
    }
}

impl<'de> VariantAccess<'de> for Keys {
    type Error = Misplaced;

    fn unit_variant(mut self) -> Result<(), Misplaced> {
        self.value(|value| match value {
            Value::Table(table) if table.is_empty() => Ok(()),
            other => {
                Err(Error::invalid_type(Unexpected::Other(other.type_str()), &"the word alone"))
            }
        })
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(
        mut self,
        seed: T,
    ) -> Result<T::Value, Misplaced> {
        self.value(|value| seed.deserialize(Placed(value)))
    }

    fn tuple_variant<V: Visitor<'de>>(
        mut self,
        _: usize,
        visitor: V,
    ) -> Result<V::Value, Misplaced> {
        self.value(|value| Placed(value).deserialize_any(visitor))
    }

    fn struct_variant<V: Visitor<'de>>(
        mut self,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misplaced> {
        self.value(|value| Placed(value).deserialize_any(visitor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::parse_toml;
    use proptest::prelude::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code, reason = "what is read is not looked at")]
    struct Whole {
        x: f64,
        part: Option<Part>,
        #[serde(default)]
        list: Vec<Part>,
        vector: Option<[f64; 3]>,
        kind: Option<Kind>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code, reason = "what is read is not looked at")]
    struct Part {
        y: f64,
    }

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "snake_case", deny_unknown_fields)]
    #[allow(dead_code, reason = "what is read is not looked at")]
    enum Kind {
        Word,
        Of(Part),
        With { m: f64 },
    }

    #[test]
    fn what_is_wrong_has_its_path_and_its_line() {
        for (text, expected) in [
            ("", "missing field `x` (line 1, column 1)"),
            ("x = 'a'", "x: invalid type: string \"a\", expected a number (line 1, column 5)"),
            ("x = 1\nz = 2", "z: unknown field `z`, expected one of"),
            ("x = 1\nz = 2", "(line 2, column 1)"),
            ("x = 1\n[part]\nq = 1", "part.q: unknown field `q`, expected `y` (line 3, column 1)"),
            ("x = 1\nlist = [{ y = 1 }, {}]", "list[2].y: missing field `y` (line 2, column 20)"),
            ("x = 1\n[[list]]\ny = 1\n[[list]]\ny = true", "list[2].y: invalid type: boolean"),
            ("x = 1\n[[list]]\ny = 1\n[[list]]\ny = true", "(line 5, column 5)"),
            (
                "x = 1\nlist = 3",
                "list: invalid type: integer `3`, expected a sequence (line 2, column 8)",
            ),
            ("x = 1\nvector = [1, 2]", "vector: invalid length 2"),
            (
                "x = 1\nvector = [1, 2, 3, 4]",
                "vector: invalid length 4, expected fewer entries in this list",
            ),
            (
                "x = 1\nvector = [1, 'b', 3]",
                "vector[2]: invalid type: string \"b\", expected a number (line 2, column 14)",
            ),
            ("x = 1\nkind = 'other'", "kind: unknown variant `other`, expected one of"),
            (
                "x = 1\nkind = 3",
                "kind: invalid type: integer `3`, expected one of \"word\", \"of\", \"with\" (line 2, column 8)",
            ),
            (
                "x = 1\nkind = 12:30:00",
                "kind: invalid type: date or time, expected one of \"word\", \"of\", \"with\" (line 2, column 8)",
            ),
            (
                "x = 1\nkind = { of = { y = 'c' } }",
                "kind.of.y: invalid type: string \"c\", expected a number (line 2, column 21)",
            ),
            (
                "x = 1\nkind = { with = { m = 1, n = 2 } }",
                "kind.with.n: unknown field `n`, expected `m` (line 2, column 26)",
            ),
            ("x = 1\nkind = { none = 1 }", "kind: unknown variant `none`"),
            ("x = 1\nkind = { word = 1 }", "kind.word: invalid type: integer"),
            (
                "x = 18446744073709551615",
                "a whole number must be from -9223372036854775808 to 9223372036854775807 (line 1, column 5)",
            ),
            (
                "x = 1979-05-27",
                "x: 1979-05-27 is a date or a time, which no key takes: as text it must be in quotation marks (line 1, column 5)",
            ),
            (
                "x = 1\nvector = [1, 12:30:00.5, 2]",
                "vector[2]: 12:30:00.5 is a date or a time, which no key takes: as text it must be in quotation marks (line 2, column 14)",
            ),
        ] {
            let message = parse_toml::<Whole>(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text}\n{message}\n{expected}");
        }
        for text in
            ["x = 1\nkind = 'word'", "x = 1.5\nkind = { with = { m = 1 } }\nvector = [1, 2, 3]"]
        {
            parse_toml::<Whole>(text).unwrap();
        }
    }

    #[test]
    fn bare_words_and_faulty_values_have_their_key() {
        let no_value = |word: &str| {
            format!(
                "`{word}` is neither a number, `true` nor `false`, and text must be in quotation marks"
            )
        };
        for (text, key, reason, place) in [
            ("x = ten", "x", no_value("ten"), "line 1, column 5"),
            ("x = many words", "x", no_value("many words"), "line 1, column 5"),
            ("x = 10kg # as weighed", "x", no_value("10kg"), "line 1, column 5"),
            ("x = True", "x", no_value("True"), "line 1, column 5"),
            ("x = infinite", "x", no_value("infinite"), "line 1, column 5"),
            ("x = 1\n[part]\ny = trés", "part.y", no_value("trés"), "line 3, column 5"),
            ("x = 1\npart.y = -a", "part.y", no_value("-a"), "line 2, column 10"),
            ("[[list]]\ny = 1\n[[list]]\ny = no", "list[2].y", no_value("no"), "line 4, column 5"),
            ("vector = [1,\n  two, 3]", "vector[2]", no_value("two"), "line 2, column 3"),
            ("kind = { with = { m = n } }", "kind.with.m", no_value("n"), "line 1, column 23"),
            (
                "x =\npart = 1",
                "x",
                "there is no value after the sign `=`".to_owned(),
                "line 1, column 4",
            ),
            ("x = 1,5", "x", "unexpected key or value".to_owned(), "line 1, column 6"),
            ("kind = 'word", "kind", "invalid literal string".to_owned(), "line 1, column 13"),
        ] {
            let message = parse_toml::<Whole>(text).unwrap_err().to_string();
            assert!(message.starts_with(&format!("{key}: {reason}")), "{text}\n{message}");
            assert!(message.ends_with(&format!("({place})")), "{text}\n{message}");
        }
        // Nothing that is no value is taken for one.
        for text in ["x", "= 1", "ten", "[part\ny = 1", "x = 1\nx = 2", "]", ""] {
            let message = parse_toml::<Whole>(text).unwrap_err().to_string();
            assert!(!message.contains("quotation"), "{text}\n{message}");
        }
        let long =
            parse_toml::<Whole>(&format!("x = {}", "é".repeat(5000))).unwrap_err().to_string();
        assert!(long.contains("é… ") || long.contains("é…`"), "{long}");
        assert!(long.len() < 300, "{long}");
    }

    fn values() -> impl Strategy<Value = Value> {
        let one = prop_oneof![
            ".*".prop_map(Value::String),
            any::<i64>().prop_map(Value::Integer),
            any::<f64>().prop_filter("NaN is not itself", |x| !x.is_nan()).prop_map(Value::Float),
            any::<bool>().prop_map(Value::Boolean),
        ];
        one.prop_recursive(4, 30, 5, |below| {
            prop_oneof![
                prop::collection::vec(below.clone(), 0..5).prop_map(Value::Array),
                prop::collection::btree_map(".*", below, 0..5)
                    .prop_map(|map| Value::Table(map.into_iter().collect())),
            ]
        })
    }

    proptest! {
        /// Whatever is written, no message takes long or is long, and nothing panics.
        #[test]
        fn anything_is_read_or_refused(text in "[a-c=\\[\\]{}.,\"'#\n 1\u{e9}-]{0,40}") {
            let message = parse_toml::<Table>(&text).err().map_or_else(String::new, |error| error.to_string());
            prop_assert!(message.chars().count() < 1000);
        }

        #[test]
        fn every_value_is_read_as_it_is(value in values()) {
            prop_assert_eq!(Value::deserialize(Placed(value.clone())).unwrap(), value);
        }
    }
}
