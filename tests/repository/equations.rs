//! The page of the paper's equations: every item exists, is public, and cites the number.

use super::files::{crates, files, read};

const EQUATIONS: usize = 37;

/// The numbers and the item paths of the rows of the page.
fn rows(page: &str) -> Vec<(usize, Vec<String>)> {
    let cells = |line: &str| line.split('|').map(|c| c.trim().to_owned()).collect::<Vec<_>>();
    let row = |line: &str| {
        let cells = cells(line);
        let number = cells.get(1)?.parse().ok()?;
        let items = cells[3].split(", ").map(|item| item.trim_matches('`').to_owned());
        Some((number, items.collect()))
    };
    page.lines().filter_map(row).collect()
}

/// The numbers that a text cites: “Eq. 5”, “Eq. 7-9”, “Eq. 27, 30 and 31”.
fn cited(text: &str) -> Vec<usize> {
    let mut numbers = Vec::new();
    for (at, eq) in text.match_indices("Eq. ") {
        let mut rest = &text[at + eq.len()..];
        let mut from = None;
        loop {
            let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let Ok(number) = rest[..digits].parse::<usize>() else { break };
            numbers.extend(from.take().map_or(number, |from: usize| from + 1)..=number);
            rest = &rest[digits..];
            if let Some(after) = rest.strip_prefix('-') {
                (from, rest) = (Some(number), after);
            } else if let Some(after) = [" and ", ", "].iter().find_map(|s| rest.strip_prefix(s)) {
                rest = after;
            } else {
                break;
            }
        }
    }
    numbers
}

/// The documentation above a line: what stands there without a gap and is no code.
fn documentation(lines: &[&str], declared: usize) -> String {
    let above = lines[..declared].iter().rev().map(|line| line.trim_start());
    let above = above
        .take_while(|l| l.starts_with("///") || !(l.is_empty() || l.ends_with(['{', '}', ';'])));
    let mut text: Vec<&str> = above.filter_map(|l| l.strip_prefix("///")).map(str::trim).collect();
    text.reverse();
    text.join(" ")
}

/// Whether code declares something public of a name.
fn declares(line: &str, kinds: &[&str], name: &str) -> bool {
    let rest = kinds.iter().find_map(|kind| line.strip_prefix("pub ")?.strip_prefix(kind));
    rest.and_then(|rest| rest.trim_start().strip_prefix(name))
        .is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
}

/// The type of an `impl` block that is not of a trait.
fn implemented(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("impl")?;
    let rest = if rest.starts_with('<') { rest.split_once("> ")?.1 } else { rest.trim_start() };
    (!line.contains(" for ")).then(|| rest.split(['<', ' ']).next())?
}

/// The documentation of an item of a crate: a type, or a method of one.
fn documented(krate: &str, path: &[&str]) -> Option<String> {
    const TYPES: [&str; 3] = ["struct", "enum", "trait"];
    for file in files(&format!("crates/{krate}/src"), "rs") {
        let text = read(&file);
        let lines: Vec<&str> = text.lines().collect();
        let mut of = None;
        for (i, line) in lines.iter().enumerate() {
            if line.starts_with("impl") {
                of = implemented(line);
            } else if *line == "}" {
                of = None;
            }
            let found = match path {
                [name] => declares(line, &TYPES, name),
                [name, method] => {
                    of == Some(*name)
                        && line.strip_prefix("    ").is_some_and(|l| declares(l, &["fn"], method))
                }
                _ => false,
            };
            if found {
                return Some(documentation(&lines, i));
            }
        }
    }
    None
}

/// Whether a crate shows a type at its root.
fn is_exported(krate: &str, name: &str) -> bool {
    let root = read(&format!("crates/{krate}/src/lib.rs"));
    let exports = root.split("pub use ").skip(1).filter_map(|rest| rest.split(';').next());
    exports.flat_map(|e| e.split(|c: char| !(c.is_alphanumeric() || c == '_'))).any(|x| x == name)
}

#[test]
fn every_equation_is_where_the_page_says_and_cited_there() {
    let rows = rows(&read("docs/equations.md"));
    let numbers: Vec<usize> = rows.iter().map(|row| row.0).collect();
    assert_eq!(numbers, (1..=EQUATIONS).collect::<Vec<_>>());
    for (number, items) in rows {
        for item in items {
            let path: Vec<&str> = item.split("::").collect();
            let krate = path[0].strip_prefix("gyradius_").unwrap();
            assert!(is_exported(krate, path[1]), "Eq. {number}: {item} is not public");
            let text = documented(krate, &path[1..]);
            let text = text.unwrap_or_else(|| panic!("Eq. {number}: {item} does not exist"));
            assert!(cited(&text).contains(&number), "Eq. {number}: {item} says only: {text}");
        }
    }
}

#[test]
fn no_source_cites_an_equation_that_the_paper_does_not_have() {
    for krate in crates() {
        for file in files(&format!("crates/{krate}"), "rs") {
            for number in cited(&read(&file)) {
                // “Eq. 7, 2003” would be a year.
                assert!((1..=EQUATIONS).contains(&number), "{file}: Eq. {number}");
            }
        }
    }
}

#[test]
fn citations_are_read_as_they_are_written() {
    assert_eq!(
        cited("(Peck 2003, Eq. 7-9) and Eq. 27, 30 and 31; Eq. 25, r = 1"),
        [7, 8, 9, 27, 30, 31, 25]
    );
    assert!(cited("no Eq. of any number 5").is_empty());
}
