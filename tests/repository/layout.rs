//! The layout of source files: each says what it is, and none is long without a reason.

use crate::files::{files, read};

/// Lines that a file may have.
const LONG: usize = 500;

/// Longer files, and why.
const REASONS: [(&str, &str); 11] = [
    ("crates/attitude/src/chart.rs", "one sampler: its bounds and the loops that use them"),
    ("crates/attitude/src/fisher_bingham.rs", "one law, with tests"),
    ("crates/attitude/src/fit/mod.rs", "the fit as its users see it: families, results, errors"),
    ("crates/attitude/src/fit/tests.rs", "tests of one subject, which share laws and samples"),
    ("crates/cli/tests/check.rs", "tests of one verb, which share files"),
    (
        "crates/dispersion/src/scalar/laws.rs",
        "every scalar law, with its pinned draws: the one list",
    ),
    ("crates/formats/src/csv.rs", "one format, with tests"),
    ("crates/inertia/src/mass_properties.rs", "one type, with tests"),
    ("crates/inertia/src/mesh.rs", "240 lines of code, more of tests"),
    ("crates/inertia/src/report.rs", "one report, every fault of a matrix, with tests"),
    ("crates/study/src/scenario/tests.rs", "tests of one subject, one for each thing refused"),
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
