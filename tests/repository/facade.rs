//! The package `gyradius` shows every library, with an example of each.

use super::files::{crates, read};

/// What of the rooms a source does not show, or has no example of.
fn missing(source: &str) -> Vec<String> {
    // The package for Python is no library of Rust.
    let rooms = crates().into_iter().filter(|name| name != "cli" && name != "python");
    let examples: Vec<&str> = source.split("```").skip(1).step_by(2).collect();
    rooms
        .filter(|name| {
            let shown = source.contains(&format!("\npub use gyradius_{name} as {name};\n"));
            let used = [format!("gyradius::{name}::"), format!("gyradius::{{{name}::")];
            !(shown && examples.iter().any(|e| used.iter().any(|used| e.contains(used))))
        })
        .collect()
}

#[test]
fn the_library_shows_every_room_with_an_example() {
    let source = read("crates/cli/src/lib.rs");
    assert_eq!(missing(&source), [""; 0]);
    assert_eq!(missing(&source.replace("pub use gyradius_report as", "")), ["report"]);
    assert_eq!(missing(&source.replace("gyradius::formats::", "")), ["formats"]);
}
