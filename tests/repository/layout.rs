//! The layout of source files: each says what it is, and none is long without a reason.

use super::files::{crates, files, read, root};

/// Lines that a file may have.
const LONG: usize = 500;

/// Longer files, and why.
const REASONS: [(&str, &str); 11] = [
    ("crates/attitude/src/chart.rs", "one sampler: its bounds and the loops that use them"),
    ("crates/attitude/src/fisher_bingham.rs", "one law, with tests"),
    ("crates/attitude/src/fit/mod.rs", "the fit as its users see it: families, results, errors"),
    ("crates/attitude/src/fit/tests.rs", "tests of one subject, which share laws and samples"),
    ("crates/cli/src/program/args.rs", "every verb and flag with its help: the one list"),
    ("crates/cli/tests/check.rs", "tests of one verb, which share files"),
    (
        "crates/dispersion/src/scalar/laws.rs",
        "every scalar law, with its pinned draws: the one list",
    ),
    ("crates/formats/tests/robots.rs", "tests of one subject, which share random robots"),
    ("crates/inertia/src/mass_properties.rs", "one type, with tests"),
    ("crates/inertia/src/mesh.rs", "240 lines of code, more of tests"),
    ("crates/inertia/src/report.rs", "one report, every fault of a matrix, with tests"),
];

/// Every source file of the repository.
fn sources() -> Vec<(String, String)> {
    let folders = ["crates", "tests", "xtask"];
    let files = folders.into_iter().flat_map(|folder| files(folder, "rs"));
    files.map(|file| (file.clone(), read(&file))).collect()
}

/// Whether a source begins with its documentation.
fn says_what_it_is(source: &str) -> bool {
    ["//! ", "#![doc = include_str!("].iter().any(|opening| source.starts_with(opening))
}

#[test]
fn every_file_opens_with_what_it_is() {
    let sources = sources();
    assert!(sources.len() > 100);
    for (file, source) in sources {
        assert!(says_what_it_is(&source), "{file} does not open with a line that begins with //!");
    }
    assert!(!says_what_it_is("// One.\n//! Two."));
}

#[test]
fn long_files_have_a_reason() {
    let long: Vec<String> =
        sources().into_iter().filter(|f| f.1.lines().count() > LONG).map(|f| f.0).collect();
    for file in &long {
        assert!(REASONS.iter().any(|r| r.0 == file), "{file} has more than {LONG} lines");
    }
    for (file, _) in REASONS {
        assert!(long.iter().any(|l| l == file), "{file} needs its reason no more");
    }
}

/// Modules that a folder of tests holds: files, and folders with a `mod.rs`.
fn modules(folder: &str) -> Vec<String> {
    let inside = files(folder, "rs").into_iter().map(|file| {
        let inside = file.strip_prefix(&format!("{folder}/")).unwrap().strip_suffix(".rs").unwrap();
        inside.strip_suffix("/mod").unwrap_or(inside).to_owned()
    });
    inside.filter(|name| !name.contains('/') && !["all", "lib"].contains(&name.as_str())).collect()
}

/// Each program of tests takes seconds to link, and a file that no program names is never run.
#[test]
fn the_tests_of_a_crate_are_one_program_which_names_every_file() {
    let folders = crates().into_iter().map(|name| format!("crates/{name}/tests"));
    let folders = folders.chain(["tests".to_owned()]).filter(|folder| root().join(folder).is_dir());
    let mut named = 0;
    for folder in folders {
        let modules = modules(&folder);
        let all = format!("{folder}/all.rs");
        if root().join(&all).exists() {
            let all = read(&all);
            for module in modules {
                assert!(
                    all.contains(&format!("\nmod {module};\n")),
                    "{folder}/all.rs has no mod {module}"
                );
                named += 1;
            }
        } else {
            assert!(modules.len() <= 1, "{folder} has no all.rs, of which its files are modules");
        }
    }
    assert!(named > 20);
}
