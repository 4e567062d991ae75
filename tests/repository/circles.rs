//! No two files of a crate need each other, directly or through others.
//!
//! A file needs another if it names, by a path or through what it imports, something that is declared
//! there. Methods are not seen, for they are called without a path. A module is made of its children, so what
//! it names of them is no need; what they name of it, or of each other, is.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    files::{crates, files, read},
    tokens::{Token, tokens},
};

/// A module that is a file, by its path from the root of the crate.
type Module = Vec<String>;

/// What a file declares and imports.
#[derive(Debug, Default)]
struct File {
    items: BTreeSet<String>,
    /// Where a name comes from, as written.
    imports: BTreeMap<String, Module>,
    /// Imports of everything that is in a module.
    globs: Vec<Module>,
    /// Every path that is named outside of re-exports.
    paths: Vec<Module>,
}

/// Paths of a tree that begins at a token, each with the name it is imported by.
fn tree(tokens: &[Token], at: &mut usize, prefix: &[String], found: &mut Vec<(String, Module)>) {
    let mut path = prefix.to_vec();
    while let Some(token) = tokens.get(*at) {
        match token {
            Token::Word(word) if word == "as" => {
                *at += 1;
                if let Some(name) = tokens[*at].word() {
                    found.push((name.to_owned(), path));
                }
                *at += 1;
                return;
            }
            Token::Word(word) => path.push(word.clone()),
            Token::Sign('*') => path.push("*".to_owned()),
            Token::Sign('{') => {
                while !tokens[*at].is('}') {
                    *at += 1;
                    if !tokens[*at].is('}') {
                        tree(tokens, at, &path, found);
                    }
                }
                *at += 1;
                return;
            }
            Token::Path => {}
            Token::Sign(_) => break,
        }
        *at += 1;
    }
    if path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    if let Some(name) = path.last() {
        found.push((name.clone(), path.clone()));
    }
}

impl File {
    fn new(source: &str) -> Self {
        const KINDS: [&str; 8] =
            ["fn", "struct", "enum", "trait", "type", "const", "static", "macro_rules"];
        let tokens = tokens(source);
        let mut file = Self::default();
        let mut words = BTreeSet::new();
        let mut shown = Vec::new();
        let (mut at, mut depth) = (0, 0);
        while let Some(token) = tokens.get(at) {
            match token {
                Token::Word(word) if word == "use" => {
                    let public =
                        at > 0 && (tokens[at - 1].is(')') || tokens[at - 1].word() == Some("pub"));
                    at += 1;
                    let mut found = Vec::new();
                    tree(&tokens, &mut at, &[], &mut found);
                    for (name, path) in found {
                        if name == "*" {
                            file.globs.push(path[..path.len() - 1].to_vec());
                        } else if public {
                            shown.push((name.clone(), path.clone()));
                        } else {
                            file.paths.push(path.clone());
                        }
                        if depth == 0 {
                            file.imports.insert(name, path);
                        }
                    }
                    continue;
                }
                Token::Word(word) => {
                    let declared = tokens.get(at + 1).and_then(Token::word);
                    let declared =
                        declared.filter(|_| depth == 0 && KINDS.contains(&word.as_str()));
                    let declared = declared.map(str::to_owned);
                    file.items.extend(declared.filter(|name| !KINDS.contains(&name.as_str())));
                    let mut path = vec![word.clone()];
                    while let (Some(Token::Path), Some(Token::Word(next))) =
                        (tokens.get(at + 1), tokens.get(at + 2))
                    {
                        path.push(next.clone());
                        at += 2;
                    }
                    words.insert(path[0].clone());
                    if path.len() > 1 {
                        file.paths.push(path);
                    }
                }
                Token::Sign('{') => depth += 1,
                Token::Sign('}') => depth -= 1,
                Token::Path | Token::Sign(_) => {}
            }
            at += 1;
        }
        // What is shown to others is needed here only if it is also used here.
        file.paths.extend(shown.into_iter().filter(|(name, _)| words.contains(name)).map(|x| x.1));
        file
    }
}

/// The files of a crate.
struct Crate(BTreeMap<Module, File>);

impl Crate {
    fn new(sources: impl IntoIterator<Item = (Module, String)>) -> Self {
        Self(sources.into_iter().map(|(module, source)| (module, File::new(&source))).collect())
    }

    /// The sources of a crate, tests apart.
    fn read(name: &str) -> Self {
        let folder = format!("crates/{name}/src");
        Self::new(files(&folder, "rs").into_iter().filter_map(|file| {
            let inside =
                file.strip_prefix(&format!("{folder}/")).unwrap().strip_suffix(".rs").unwrap();
            let mut module: Module = inside.split('/').map(str::to_owned).collect();
            match module.last().unwrap().as_str() {
                "tests" | "main" => return None,
                "mod" | "lib" => {
                    module.pop();
                }
                _ => {}
            }
            Some((module, read(&file)))
        }))
    }

    /// The file in which what a path names is declared, seen from a file.
    fn declared(&self, from: &Module, path: &[String], depth: usize) -> Option<Module> {
        let mut at = from.clone();
        let mut path = path;
        let mut is_relative = false;
        while let Some((first, rest)) = path.split_first() {
            match first.as_str() {
                "crate" => at.clear(),
                "super" => {
                    at.pop()?;
                }
                "self" => {}
                _ => break,
            }
            (path, is_relative) = (rest, true);
        }
        self.look(&at, path, is_relative, depth)
    }

    /// The same within a module; not of an extern crate, whose name a path may begin with.
    fn look(&self, at: &Module, path: &[String], found: bool, depth: usize) -> Option<Module> {
        // An import of itself by another name would go round for ever.
        let depth = depth.checked_sub(1)?;
        let file = self.0.get(at)?;
        let Some((first, rest)) = path.split_first() else { return found.then(|| at.clone()) };
        let mut below = at.clone();
        below.push(first.clone());
        if file.items.contains(first) {
            return Some(at.clone());
        }
        if self.0.contains_key(&below) {
            return self.look(&below, rest, true, depth);
        }
        if let Some(import) = file.imports.get(first) {
            if import.first() == Some(first) && import.len() == 1 {
                return None;
            }
            let path: Module = import.iter().chain(rest).cloned().collect();
            return self.declared(at, &path, depth);
        }
        let mut globs = file.globs.iter();
        globs.find_map(|glob| {
            let path: Module = glob.iter().chain(path).cloned().collect();
            self.declared(at, &path, depth)
        })
    }

    /// The files that each file needs.
    fn needs(&self) -> BTreeMap<Module, BTreeSet<Module>> {
        const DEEPEST: usize = 32;
        let of = |module: &Module, file: &File| -> BTreeSet<Module> {
            let found = file.paths.iter().filter_map(|path| self.declared(module, path, DEEPEST));
            found.filter(|other| !other.starts_with(module)).collect()
        };
        self.0.iter().map(|(module, file)| (module.clone(), of(module, file))).collect()
    }

    /// What the files of a circle need of each other, a line each.
    fn describe(&self, circle: &BTreeSet<String>) -> String {
        let needs = self.needs();
        let within = |other: &&String| circle.contains(*other);
        let line = |(module, others): (&Module, &BTreeSet<Module>)| {
            let module = circle.get(&module.join("/"))?;
            let others: Vec<String> = others.iter().map(|other| other.join("/")).collect();
            let others: Vec<&str> = others.iter().filter(within).map(String::as_str).collect();
            Some(format!("\n  {module} needs {}", others.join(", ")))
        };
        needs.iter().filter_map(line).collect()
    }

    /// Sets of files that all need each other.
    fn circles(&self) -> BTreeSet<BTreeSet<String>> {
        let needs = self.needs();
        let reached: BTreeMap<&Module, BTreeSet<&Module>> = needs
            .keys()
            .map(|start| {
                let mut seen = BTreeSet::new();
                let mut next: Vec<&Module> = needs[start].iter().collect();
                while let Some(module) = next.pop() {
                    if seen.insert(module) {
                        next.extend(needs.get(module).into_iter().flatten());
                    }
                }
                (start, seen)
            })
            .collect();
        let round = |a: &Module| -> BTreeSet<String> {
            let round = reached[a].iter().filter(|b| reached[*b].contains(a));
            round.map(|b| b.join("/")).collect()
        };
        needs.keys().map(round).filter(|circle| !circle.is_empty()).collect()
    }
}

#[test]
fn no_files_need_each_other() {
    for name in crates() {
        let krate = Crate::read(&name);
        let circle = krate.circles().into_iter().next();
        assert!(
            circle.is_none(),
            "a circle in {name}:{}",
            krate.describe(&circle.unwrap_or_default())
        );
    }
}

fn circles(sources: &[(&str, &str)]) -> Vec<String> {
    let module =
        |path: &str| path.split('/').filter(|s| !s.is_empty()).map(str::to_owned).collect();
    let sources = sources.iter().map(|(path, source)| (module(path), (*source).to_owned()));
    let circles = Crate::new(sources).circles();
    circles.into_iter().map(|c| c.into_iter().collect::<Vec<_>>().join(" ")).collect()
}

#[test]
fn circles_are_seen_through_imports_paths_and_exports() {
    let root = ("", "mod a; mod b; pub use a::A; pub use b::B;");
    let straight = [root, ("a", "pub struct A;"), ("b", "use crate::A; pub struct B(A);")];
    assert!(circles(&straight).is_empty());
    for back in [
        "use crate::B;",
        "use crate::{b, x::{Y, Z}};",
        "use super::b::B as C;",
        "fn f() { crate::b::B }",
        "fn f() { let _ = super::B::new(); }",
        "use super::*; fn f() { self::super::B; }",
    ] {
        let source = format!("{back} pub struct A;");
        let sources = [root, ("a", source.as_str()), straight[2]];
        assert_eq!(circles(&sources), ["a b"], "{back}");
    }
    // Neither in tests, nor in comments.
    for no in ["#[cfg(test)] mod tests { use crate::B; }", "// use crate::B;", "\"crate::B\";"] {
        let source = format!("pub struct A; {no}");
        assert!(circles(&[root, ("a", source.as_str()), straight[2]]).is_empty(), "{no}");
    }
}

#[test]
fn a_module_may_use_its_children_and_they_may_use_it() {
    let module = "mod b; mod c; const LIMIT: u8 = 1; fn f() { c::go() }";
    let sources =
        [("", "mod a;"), ("a", module), ("a/b", "pub struct B; fn f() { super::c::go() }")];
    let with = |child| circles(&[sources[0], sources[1], sources[2], ("a/c", child)]);
    assert!(with("use super::LIMIT; pub fn go() { LIMIT; }").is_empty());
    assert_eq!(with("use super::b::B; pub fn go() { B; }"), ["a/b a/c"]);
}
