//! Arrows between the rooms: what each crate uses stands below it, and in its row of the table.

use std::collections::{BTreeMap, BTreeSet};

use super::files::{crates, read};

/// The folder of a package of the workspace.
fn room(package: &str) -> Option<String> {
    match package {
        "gyradius" => Some("cli".to_owned()),
        _ => package.strip_prefix("gyradius-").map(str::to_owned),
    }
}

/// The rooms that each room uses, without those that only its tests use.
fn used() -> BTreeMap<String, BTreeSet<String>> {
    let rooms = crates().into_iter().map(|name| (format!("crates/{name}"), name));
    let rooms = rooms.chain([("xtask".to_owned(), "xtask".to_owned())]);
    let used = |folder: &str| {
        let manifest: toml::Table = read(&format!("{folder}/Cargo.toml")).parse().unwrap();
        manifest["dependencies"].as_table().unwrap().keys().filter_map(|name| room(name)).collect()
    };
    rooms.map(|(folder, name)| (name, used(&folder))).collect()
}

/// The rooms that each room may use by the table of a page, row by row.
fn allowed(page: &str) -> BTreeMap<String, BTreeSet<String>> {
    let mut allowed = BTreeMap::<String, BTreeSet<String>>::new();
    for line in page.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let name = cells[0].trim_matches('`').trim_start_matches("crates/").to_owned();
        let may = match cells[2] {
            "all" | "all above" => allowed.keys().cloned().collect(),
            names => names.split(", ").map(str::to_owned).collect(),
        };
        allowed.insert(name, may);
    }
    allowed
}

/// How far from the top each room stands in the drawing of a page.
fn floors(page: &str) -> BTreeMap<String, usize> {
    let drawing = page.split("```").nth(1).unwrap();
    let rooms: Vec<String> = used().into_keys().collect();
    let floor = |(floor, line): (usize, &str)| {
        let names: Vec<_> = line.split("  ").map(|name| name.trim().to_owned()).collect();
        names
            .into_iter()
            .filter(|name| rooms.contains(name))
            .map(move |name| (name, floor))
            .collect()
    };
    drawing.lines().enumerate().flat_map::<Vec<_>, _>(floor).collect()
}

/// Every arrow that a page does not allow.
fn forbidden(page: &str, used: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    let (allowed, floors) = (allowed(page), floors(page));
    let mut found = Vec::new();
    for (name, rooms) in used {
        for other in rooms {
            if !allowed.get(name).is_some_and(|may| may.contains(other)) {
                found.push(format!("{name} uses {other}, which its row does not say"));
            }
            match (floors.get(name), floors.get(other)) {
                (Some(floor), Some(below)) if floor < below => {}
                _ => found.push(format!("{name} does not stand above {other}")),
            }
        }
    }
    found
}

#[test]
fn arrows_between_rooms_point_down_as_the_page_says() {
    let page = read("docs/architecture.md");
    let used = used();
    assert_eq!(floors(&page).keys().collect::<Vec<_>>(), used.keys().collect::<Vec<_>>());
    assert_eq!(forbidden(&page, &used), [""; 0]);
}

#[test]
fn an_arrow_that_is_not_allowed_is_seen() {
    let page = read("docs/architecture.md");
    let used = used();
    let names: Vec<&String> = used.keys().collect();
    let mut seen = 0;
    for from in &names {
        for to in names.iter().filter(|to| !used[*from].contains(**to)) {
            let mut more = used.clone();
            more.get_mut(*from).unwrap().insert((*to).clone());
            let down = floors(&page)[*from] < floors(&page)[*to];
            let may = allowed(&page)[*from].contains(*to);
            assert_eq!(forbidden(&page, &more).is_empty(), down && may, "{from} to {to}");
            seen += usize::from(!(down && may));
        }
    }
    assert!(seen > names.len());
}
