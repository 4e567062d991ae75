//! An error says in its own message all that there is to say, or is another one as it stands: what prints
//! an error and its sources, one after the other, says nothing twice.

use super::files::{files, read};

/// The first line of each variant of `text` that has a message of its own and a source beside it.
fn said_twice(text: &str) -> Vec<&str> {
    let variants = text.split("#[error(").skip(1).filter_map(|rest| {
        let (message, rest) = rest.split_once(")]\n")?;
        let end = ["#[error(", "\n}"].iter().filter_map(|end| rest.find(end)).min();
        Some((message, &rest[..end.unwrap_or(rest.len())]))
    });
    let sources = ["#[from]", "#[source]", " source:"];
    variants
        .filter(|(message, _)| *message != "transparent")
        .filter(|(_, fields)| sources.iter().any(|source| fields.contains(source)))
        .map(|(message, _)| message)
        .collect()
}

#[test]
fn no_error_prints_its_source_and_returns_it_too() {
    let own = "#[error(\"a: {0}\")]\n    A(#[from] E),\n    #[error(transparent)]\n    B(#[from] F),\n    #[error(\n\"c\")]\n    C {\n        source: G,\n    },\n}\n";
    assert_eq!(said_twice(own), ["\"a: {0}\"", "\n\"c\""]);
    for path in files("crates", "rs") {
        assert_eq!(said_twice(&read(&path)), [""; 0], "{path}");
    }
}
