//! Types have one name: no two crates have public ones that are called the same.

use std::collections::{BTreeMap, BTreeSet};

use super::{files, tokens::tokens};

/// The public types and traits that a source declares.
fn declared(source: &str) -> Vec<String> {
    let tokens = tokens(source);
    let words: Vec<&str> = tokens.iter().map(|token| token.word().unwrap_or_default()).collect();
    let types = words.windows(3).filter(|words| {
        words[0] == "pub" && ["struct", "enum", "trait", "type"].contains(&words[1])
    });
    types.map(|words| words[2].to_owned()).collect()
}

/// Names that more than one crate gives, of the crates with these sources.
fn shared(sources: &[(String, String)]) -> Vec<String> {
    let mut crates: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
    for (of, source) in sources {
        for name in declared(source) {
            crates.entry(name).or_default().insert(of);
        }
    }
    let shared = crates.into_iter().filter(|(_, crates)| crates.len() > 1);
    shared.map(|(name, crates)| format!("{name} of {crates:?}")).collect()
}

#[test]
fn no_two_crates_have_types_of_one_name() {
    let libraries = files::crates().into_iter().filter(|name| name != "python");
    let sources: Vec<(String, String)> = libraries
        .flat_map(|name| {
            let files = files::files(&format!("crates/{name}/src"), "rs");
            files.into_iter().map(move |file| (name.clone(), files::read(&file)))
        })
        .collect();
    assert!(sources.iter().map(|(_, source)| declared(source).len()).sum::<usize>() > 400);
    assert!(shared(&sources).is_empty(), "{:?}", shared(&sources));
}

#[test]
fn names_that_are_shared_are_seen() {
    let of = |name: &str, source: &str| (name.to_owned(), source.to_owned());
    let a = of("a", "pub struct One { x: u8 } pub(crate) enum Three {} fn f() {}");
    let b = of("b", "pub enum One {} pub trait Two {} pub enum Three {}");
    assert_eq!(shared(&[a.clone(), b]), [r#"One of {"a", "b"}"#]);
    let c = of("c", "struct One; #[cfg(test)] mod tests { pub struct One; }");
    assert!(shared(&[a, c]).is_empty());
}
