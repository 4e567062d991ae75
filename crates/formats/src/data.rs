//! TOML and JSON: bodies in a list or as named tables.
//!
//! Both become the same few kinds of values, as deep as the schema goes and no deeper.

use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use std::{collections::HashSet, fmt, ops::Range};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use crate::{
    FileBody, FileProblem, MAX_BODIES, MAX_DEPTH, Products,
    body::shortened,
    data_bodies::bodies,
    data_item::{Item, Value},
    data_keys::INERTIA,
    error::Refusal,
    gap::Gaps,
    text::Text,
};

/// A document is a table of a list of tables of a list of lists of numbers.
const DEPTH: usize = 6;

/// Reads a TOML file.
pub(crate) fn toml(text: &Text, products: Products) -> Result<(Vec<FileBody>, Gaps), Refusal> {
    let source = text.as_str();
    let table = DeTable::parse(source).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        text.malformed(at, error.message())
    })?;
    let span = table.span();
    let table = table.into_inner();
    let all = all_in_toml(&table);
    let value = DeValue::Table(table);
    bodies(text, &from_toml(source, &value, &span, DEPTH), &all, products)
}

fn from_toml<'a>(source: &str, value: &DeValue<'a>, span: &Range<usize>, depth: usize) -> Item<'a> {
    let value = match value {
        DeValue::Float(float) => Value::Number(float.as_str().to_owned().into(), span.end),
        DeValue::Integer(integer) => {
            // Hexadecimal integers are numbers too, if hardly inertias.
            let digits = integer.as_str();
            let decimal = match integer.radix() {
                10 => digits.to_owned(),
                radix => i128::from_str_radix(digits, radix).map_or_else(
                    // Too long: as it is written, which is refused as a number.
                    |_| source.get(span.clone()).unwrap_or(digits).to_owned(),
                    |value| value.to_string(),
                ),
            };
            Value::Number(decimal.into(), span.end)
        }
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Array(items) if depth > 0 => Value::List(
            items.iter().map(|i| from_toml(source, i.get_ref(), &i.span(), depth - 1)).collect(),
        ),
        DeValue::Table(entries) if depth > 0 => {
            let mut entries: Vec<_> = entries
                .iter()
                .map(|(key, item)| {
                    let mut entry = from_toml(source, item.get_ref(), &item.span(), depth - 1);
                    entry.start = start_of(item.get_ref(), &key.span(), &item.span());
                    (key.get_ref().to_string(), entry)
                })
                .collect();
            // In the order of the file, not of the alphabet.
            entries.sort_by_key(|(_, item)| item.start);
            Value::Table(entries)
        }
        _ => Value::Other,
    };
    Item { start: span.start, value }
}

/// Reads a JSON file.
pub(crate) fn json(text: &Text, products: Products) -> Result<(Vec<FileBody>, Gaps), Refusal> {
    let source = text.as_str();
    if let Some(at) = too_deep(source.as_bytes()) {
        return Err(text.refuse(at, FileProblem::TooDeep));
    }
    let root: &RawValue = serde_json::from_str(source).map_err(|error| {
        let problem = FileProblem::Malformed { message: without_place(&error) };
        Refusal { line: Some(error.line().max(1)), problem }
    })?;
    let item = from_json(text, root, DEPTH)?;
    bodies(text, &item, &all_in_json(source), products)
}

/// The message without its line and column, which may be those of a part.
fn without_place(error: &serde_json::Error) -> String {
    let message = error.to_string();
    message.rsplit_once(" at line ").map_or(message.clone(), |(m, _)| m.to_owned())
}

/// Where lists and tables are nested too deeply.
fn too_deep(bytes: &[u8]) -> Option<usize> {
    let (mut depth, mut quoted, mut escaped) = (0_usize, false, false);
    for (i, byte) in bytes.iter().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if quoted => escaped = true,
            b'"' => quoted = !quoted,
            b'[' | b'{' if !quoted => {
                depth += 1;
                if depth > MAX_DEPTH {
                    return Some(i);
                }
            }
            b']' | b'}' if !quoted => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    None
}

/// The entries of an object in their order.
struct Entries<'a>(Vec<(String, &'a RawValue)>);

impl<'de> serde::Deserialize<'de> for Entries<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Collect;
        impl<'de> Visitor<'de> for Collect {
            type Value = Entries<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(Collect)
    }
}

fn from_json<'a>(text: &'a Text, raw: &'a RawValue, depth: usize) -> Result<Item<'a>, Refusal> {
    let source = raw.get();
    let start = text.offset_of(source).unwrap_or_default();
    let refuse = |error: serde_json::Error| text.malformed(start, without_place(&error));
    let value = match source.as_bytes().first() {
        Some(b'{') if depth > 0 => {
            let Entries(raw) = serde_json::from_str(source).map_err(refuse)?;
            let mut seen = HashSet::new();
            let mut entries = Vec::with_capacity(raw.len());
            for (key, item) in raw {
                if !seen.insert(key.clone()) {
                    let at = text.offset_of(item.get()).unwrap_or(start);
                    let message = format!("the key \"{}\" is there twice", shortened(&key));
                    return Err(text.malformed(at, message));
                }
                entries.push((key, from_json(text, item, depth - 1)?));
            }
            Value::Table(entries)
        }
        Some(b'[') if depth > 0 => {
            let raw: Vec<&RawValue> = serde_json::from_str(source).map_err(refuse)?;
            // Before it takes up memory: no list of ours is longer.
            if raw.len() > MAX_BODIES {
                return Err(text.refuse(start, FileProblem::TooManyBodies));
            }
            let items: Result<_, _> =
                raw.into_iter().map(|item| from_json(text, item, depth - 1)).collect();
            Value::List(items?)
        }
        Some(b'"') => Value::Text(serde_json::from_str(source).map_err(refuse)?),
        Some(b'-' | b'0'..=b'9') => Value::Number(source.into(), start + source.len()),
        _ => Value::Other,
    };
    Ok(Item { start, value })
}

/// Where the values of the key of an inertia start, however deep they stand.
fn all_in_toml(root: &DeTable<'_>) -> Vec<usize> {
    let mut found = Vec::new();
    // A stack of our own: tables may be nested deeper than calls may.
    let mut open: Vec<&DeValue<'_>> = Vec::new();
    let look = |table: &DeTable<'_>, found: &mut Vec<usize>| {
        for (key, item) in table {
            if key.get_ref() == INERTIA {
                found.push(start_of(item.get_ref(), &key.span(), &item.span()));
            }
        }
    };
    look(root, &mut found);
    open.extend(root.values().map(Spanned::get_ref));
    while let Some(value) = open.pop() {
        match value {
            DeValue::Table(table) => {
                look(table, &mut found);
                open.extend(table.values().map(Spanned::get_ref));
            }
            DeValue::Array(items) => open.extend(items.iter().map(Spanned::get_ref)),
            DeValue::String(_)
            | DeValue::Integer(_)
            | DeValue::Float(_)
            | DeValue::Boolean(_)
            | DeValue::Datetime(_) => {}
        }
    }
    found.sort_unstable();
    found
}

/// Where a value starts: tables with their heading, of which the value has no place.
fn start_of(value: &DeValue<'_>, key: &Range<usize>, item: &Range<usize>) -> usize {
    if matches!(value, DeValue::Table(_)) { item.start.min(key.start) } else { item.start }
}

/// As [`all_in_toml`].
fn all_in_json(source: &str) -> Vec<usize> {
    let key = format!("\"{INERTIA}\"");
    let keys = source.match_indices(&key).filter(|(at, _)| !source[..*at].ends_with('\\'));
    keys.filter_map(|(at, key)| {
        let value = source[at + key.len()..].trim_start().strip_prefix(':')?.trim_start();
        Some(source.len() - value.len())
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::ENTRIES;

    fn read(text: &str) -> Result<Vec<FileBody>, Refusal> {
        let text = Text::new(text.as_bytes(), false).unwrap();
        if ["{", "[{", "[[["].iter().any(|start| text.as_str().starts_with(start)) {
            json(&text, Products::TensorEntries)
        } else {
            toml(&text, Products::TensorEntries)
        }
        .map(|(bodies, _)| bodies)
    }

    fn six(body: &FileBody) -> [f64; 6] {
        ENTRIES.map(|entry| body.inertia().unwrap()[entry])
    }

    const SIX: [f64; 6] = [10.0, 11.0, 12.0, 0.1, 0.2, 0.3];

    #[test]
    fn lists_and_named_tables_are_read() {
        let rows = "[[10, 0.1, 0.2], [0.1, 11, 0.3], [0.2, 0.3, 12]]";
        for text in [
            format!("[[bodies]]\nname = \"arm\"\nmass_kg = 2\ninertia_kg_m2 = {rows}"),
            format!("[[body]]\nname = 'arm'\nmass_kg = 2.0\ninertia_kg_m2 = {rows}"),
            format!("title = 1\n[arm]\nmass_kg = 2.0\ninertia_kg_m2 = {rows}\n[other]\nx = 1"),
            "[arm]\nmass_kg = 2\n[arm.inertia_kg_m2]\nIxx = 10\niyy = 1_1.0\ni33 = 12\nixy = 0.1\n\
             ixz = 0.2\niyz = 0.3"
                .to_owned(),
            format!(
                "{{\"bodies\": [{{\"name\": \"arm\", \"mass_kg\": 2, \"inertia_kg_m2\": {rows}}}]}}"
            ),
            format!("[{{\"name\": \"arm\", \"mass_kg\": 2, \"inertia_kg_m2\": {rows}}}]"),
            format!("{{\"name\": \"arm\", \"mass_kg\": 2, \"inertia_kg_m2\": {rows}}}"),
            format!("name = 'arm'\nmass_kg = 2\ninertia_kg_m2 = {rows}"),
            format!("{{\"x\": null, \"arm\": {{\"mass_kg\": 2, \"inertia_kg_m2\": {rows}}}}}"),
        ] {
            let bodies = read(&text).unwrap();
            assert_eq!(bodies.len(), 1, "{text}");
            assert_eq!(six(&bodies[0]), SIX, "{text}");
            assert_eq!((bodies[0].name(), bodies[0].mass_kg()), ("arm", Some(2.0)), "{text}");
        }
    }

    #[test]
    fn the_file_may_state_the_sign() {
        let rows = "[[10, 0.1, 0.2], [0.1, 11, 0.3], [0.2, 0.3, 12]]";
        for text in [
            format!("products = \"integrals\"\n[arm]\ninertia_kg_m2 = {rows}"),
            format!("{{\"products\": \"integrals\", \"arm\": {{\"inertia_kg_m2\": {rows}}}}}"),
        ] {
            assert_eq!(six(&read(&text).unwrap()[0])[3..], [-0.1, -0.2, -0.3]);
        }
        for (word, sign) in [("integrals", -1.0), ("tensor", 1.0)] {
            for text in [
                format!("[[bodies]]\nproducts = \"{word}\"\ninertia_kg_m2 = {rows}"),
                format!(
                    "products = \"integrals\"\n[arm]\nproducts = \"{word}\"\ninertia_kg_m2 = {rows}"
                ),
                format!("[{{\"products\": \"{word}\", \"inertia_kg_m2\": {rows}}}]"),
            ] {
                assert_eq!(
                    read(&text).unwrap()[0].inertia().unwrap()[(0, 1)],
                    0.1 * sign,
                    "{text}"
                );
            }
        }
        let bad = format!("products = \"positive\"\n[arm]\ninertia_kg_m2 = {rows}");
        assert!(read(&bad).unwrap_err().problem.to_string().contains("\"tensor\" or"));
    }

    #[test]
    fn bodies_stand_in_the_order_of_the_file_with_their_lines() {
        let row = "inertia_kg_m2 = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]";
        let bodies = read(&format!("[zebra]\n{row}\n\n[ant]\n{row}\n")).unwrap();
        let found: Vec<_> = bodies.iter().map(|body| (body.name(), body.line())).collect();
        assert_eq!(found, [("zebra", 2), ("ant", 5)]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let error = |inertia: &str| {
            let text = format!("{{\"bodies\": [{{\"inertia_kg_m2\": {inertia}}}]}}");
            read(&text).unwrap()[0].inertia().unwrap_err().to_string()
        };
        assert!(error("[[1, 0], [0, 1]]").contains("three rows"));
        assert!(error("{\"ixx\": 1}").contains("ixx, iyy"));
        assert!(error("[[1, 0, 0], [0, \"1\", 0], [0, 0, 1]]").contains("\"1\" is not a number"));
        assert!(error("[[1, 0, 0], [0, 1e999, 0], [0, 0, 1]]").contains("must be finite"));
        assert!(error("[[1, 0, 0], [0, null, 0], [0, 0, 1]]").contains("a number"));
        assert!(error("null").contains("three rows"));
        let refusal = |text: &str| {
            let refusal = read(text).unwrap_err();
            (refusal.line, refusal.problem.to_string())
        };
        assert!(refusal("{\"a\": 1}").1.contains("inertia_kg_m2"));
        assert_eq!(refusal("{\"a\": 1,\n}").0, Some(2));
        assert_eq!(refusal("a = 1\nb = = 2").0, Some(2));
        assert!(refusal("{\"a\": 1, \"a\": 2}").1.contains("twice"));
        assert!(refusal(&format!("{}{}", "[".repeat(300), "]".repeat(300))).1.contains("deeper"));
        assert!(refusal(&format!("a = {}", "[".repeat(100_000))).1.contains("malformed"));
    }
}
