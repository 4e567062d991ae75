//! The bodies of a TOML or JSON document, and what of it was not read.

use std::collections::HashSet;

use crate::{
    FileBody, FileBodyError, FileProblem, MAX_BODIES, Products,
    body::{Number, Reading, entry_of, shortened},
    data_item::{Item, Value},
    data_keys::{self, INERTIA},
    error::Refusal,
    gap::{GapKind, Gaps},
    text::Text,
};

/// The bodies of a document: itself if it has an inertia, all of `bodies` or `body`, which are a list or tables by name,
/// itself if it is a list, and every table in it that has an inertia.
pub(crate) fn bodies(
    text: &Text,
    root: &Item<'_>,
    all: &[usize],
    default: Products,
) -> Result<(Vec<FileBody>, Gaps), Refusal> {
    if let Some(item) = mistaken_products(root) {
        return Err(text.malformed(item.1.start, data_keys::error(&item.0)));
    }
    let products = match root.get("products") {
        // As a table it says what is known of them: the file is one of statements.
        None | Some(Item { value: Value::Table(_), .. }) => default,
        Some(item) => products_of(item).map_err(|error| text.malformed(item.start, error))?,
    };
    let found = found(root);
    if !found.iter().any(|(_, item)| item.get(INERTIA).is_some()) {
        let message = format!("no table in it has a key {INERTIA}");
        return Err(FileProblem::Unknown { message }.into());
    }
    if found.len() > MAX_BODIES {
        return Err(FileProblem::TooManyBodies.into());
    }
    let read = found.iter().filter_map(|(_, item)| Some(item.get(INERTIA)?.start));
    let mut gaps = elsewhere(text, all, &read.collect());
    unread_keys(text, root, &found, &mut gaps);
    Ok((found.into_iter().map(|(key, item)| body(text, key, item, products)).collect(), gaps))
}

/// The keys that mean nothing here: of each body, and of the document around them, which may say by them what it means by its numbers.
fn unread_keys(text: &Text, root: &Item<'_>, found: &[(&str, &Item<'_>)], gaps: &mut Gaps) {
    let bodies: HashSet<*const Item<'_>> =
        found.iter().map(|(_, item)| std::ptr::from_ref(*item)).collect();
    let is_body = |item: &Item<'_>| bodies.contains(&std::ptr::from_ref(item));
    let holds_body = |item: &Item<'_>| {
        let inside = item.entries().iter().map(|(_, item)| item);
        is_body(item) || item.items().iter().chain(inside).any(is_body)
    };
    let of_bodies = found.iter().flat_map(|(_, item)| {
        let is_known = |key: &str, value| {
            let is_held = std::ptr::eq(*item, root) && holds_body(value);
            is_held || data_keys::is_read(key) || mistaken(item, key, value).is_some()
        };
        item.entries().iter().filter(move |(key, value)| !is_known(key, value))
    });
    // A document that is a body itself is among them.
    let around = if is_body(root) { &[] } else { root.entries() };
    let is_known = |key: &str, value: &Item<'_>| {
        let is_table = matches!(value.value, Value::Table(_));
        data_keys::is_read_of_all(key) && !is_table || holds_body(value)
    };
    let around = around.iter().filter(|(key, value)| !is_known(key, value));
    let mut unread: Vec<_> = around.chain(of_bodies).collect();
    unread.sort_by_key(|(_, value)| value.start);
    let Some(line) = unread.first().map(|(_, value)| text.line(value.start)) else { return };
    let mut seen = HashSet::new();
    unread.retain(|(key, _)| seen.insert(key));
    gaps.add_keys(GapKind::Keys, line, unread.into_iter().map(|(key, _)| key.clone()).collect());
}

/// What of a document is a body or should be one, with the names of those that have them, in the order of the file.
fn found<'a, 'b>(root: &'b Item<'a>) -> Vec<(&'b str, &'b Item<'a>)> {
    let mut found: Vec<(&str, &Item<'_>)> = Vec::new();
    if root.get(INERTIA).is_some() {
        found.push(("", root));
    }
    found.extend(root.items().iter().map(|item| ("", item)));
    for (name, item) in root.entries() {
        let is_list = ["bodies", "body"].contains(&name.as_str());
        if is_body_like(item) {
            found.push((name, item));
        } else if is_list {
            found.extend(item.items().iter().map(|item| ("", item)));
            // Other programs may have a `body` that is no list of ours.
            if name == "bodies" || item.entries().iter().any(|(_, item)| is_body_like(item)) {
                found.extend(item.entries().iter().map(|(name, item)| (name.as_str(), item)));
            }
        }
    }
    found.sort_by_key(|(_, item)| item.start);
    found
}

/// Whether a table has an inertia, or one under a key that is nearly that of ours.
fn is_body_like(item: &Item<'_>) -> bool {
    item.entries().iter().any(|(key, _)| data_keys::meant(key) == Some(INERTIA) || key == INERTIA)
}

/// The key of ours that another one of a table must be meant as: a slip where the table does not have the key itself.
fn mistaken(item: &Item<'_>, key: &str, value: &Item<'_>) -> Option<&'static str> {
    let meant = data_keys::meant(key).filter(|known| item.get(known).is_none())?;
    // A product may be what is sold.
    (meant != data_keys::PRODUCTS
        || products_of(value).is_ok()
        || !key.eq_ignore_ascii_case("product"))
    .then_some(meant)
}

/// A key of the document by which it can mean nothing but the sign of products, and does not say it.
fn mistaken_products<'a, 'b>(root: &'b Item<'a>) -> Option<&'b (String, Item<'a>)> {
    let slip = |(key, value): &&(String, Item<'_>)| {
        mistaken(root, key, value) == Some(data_keys::PRODUCTS)
    };
    root.entries().iter().find(slip)
}

/// The inertias that stand where the schema has none: those at `all` places that were not `read`.
fn elsewhere(text: &Text, all: &[usize], read: &HashSet<usize>) -> Gaps {
    let mut gaps = Gaps::default();
    for start in all.iter().filter(|start| !read.contains(start)) {
        gaps.add(GapKind::Misplaced, text.line(*start));
    }
    gaps
}

fn body(text: &Text, key: &str, item: &Item<'_>, products: Products) -> FileBody {
    let name = match item.get("name").map(|item| &item.value) {
        Some(Value::Text(name)) => name.clone(),
        _ => key.to_owned(),
    };
    let inertia = item.get(INERTIA);
    let line = text.line(inertia.unwrap_or(item).start);
    let slip = item.entries().iter().find(|(key, value)| mistaken(item, key, value).is_some());
    let reading = match (slip, inertia) {
        // What it was meant to say would be another body.
        (Some((key, _)), _) => Err(data_keys::error(key)),
        (None, Some(inertia)) => reading(item, inertia, products),
        (None, None) => Err(FileBodyError::Missing { field: INERTIA }),
    };
    FileBody::new(name, line, reading)
}

/// What a document, or a body in it, says of the products.
fn products_of(item: &Item<'_>) -> Result<Products, FileBodyError> {
    let word = match &item.value {
        Value::Text(word) => Products::parse(word),
        _ => None,
    };
    let allowed = "\"tensor\" or \"integrals\"";
    word.ok_or(FileBodyError::Shape { field: "products", allowed })
}

fn reading(
    item: &Item<'_>,
    inertia: &Item<'_>,
    products: Products,
) -> Result<Reading, FileBodyError> {
    const SHAPE: FileBodyError = FileBodyError::Shape {
        field: INERTIA,
        allowed: "three rows of three numbers, or ixx, iyy, izz, ixy, ixz and iyz",
    };
    // What the document says of all, a body may say of itself.
    let products = item.get("products").map_or(Ok(products), products_of)?;
    let mass = item.get("mass_kg").map(|mass| mass.number("mass_kg")).transpose()?;
    if let Value::Table(entries) = &inertia.value {
        let mut six = [None; 6];
        for (key, entry) in entries {
            let index = entry_of(&key.to_lowercase()).ok_or_else(|| FileBodyError::Key {
                key: shortened(key),
                allowed: "ixx, iyy, izz, ixy, ixz and iyz",
            })?;
            if six[index].replace(entry.number(INERTIA)?).is_some() {
                return Err(SHAPE);
            }
        }
        let mut all = [Number::default(); 6];
        for (number, entry) in all.iter_mut().zip(six) {
            *number = entry.ok_or(SHAPE)?;
        }
        return Ok(Reading::of_six(mass, &all, products));
    }
    let rows = inertia.items();
    if rows.len() != 3 || rows.iter().any(|row| row.items().len() != 3) {
        return Err(SHAPE);
    }
    let mut nine = [[Number::default(); 3]; 3];
    for (numbers, row) in nine.iter_mut().zip(rows) {
        for (number, entry) in numbers.iter_mut().zip(row.items()) {
            *number = entry.number(INERTIA)?;
        }
    }
    Ok(Reading::of_nine(mass, &nine, products))
}
