//! Which files are looked into, by their names and by how they begin.

use std::{fmt, path::Path};

use crate::{FileProblem, MAX_TOML_BYTES};

/// The formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The Unified Robot Description Format, and xacro files as far as they hold numbers.
    Urdf,
    /// MuJoCo's XML.
    Mjcf,
    /// SDFormat, of Gazebo and Drake.
    Sdf,
    /// A table with a header.
    Csv,
    /// The schema of this crate in TOML.
    Toml,
    /// The schema of this crate in JSON.
    Json,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Urdf => "URDF",
            Self::Mjcf => "MJCF",
            Self::Sdf => "SDF",
            Self::Csv => "CSV",
            Self::Toml => "TOML",
            Self::Json => "JSON",
        })
    }
}

/// Extensions of files that hold inertias and little else.
const ROBOTS: [&str; 5] = ["urdf", "xacro", "mjcf", "sdf", "world"];
/// Extensions of files that may hold anything.
const GENERIC: [&str; 5] = ["xml", "csv", "tsv", "toml", "json"];

/// Extensions of files that may hold inertias and are not read, and the name of their format.
const NOT_READ: [(&str, &str); 7] = [
    ("usd", "USD"),
    ("usda", "USD"),
    ("usdc", "USD"),
    ("usdz", "USD"),
    ("mjb", "MuJoCo's binary"),
    ("mjz", "MuJoCo's compressed"),
    ("osim", "OpenSim"),
];
/// Extensions of templates, after one of those that are read: `rover.sdf.jinja`.
const TEMPLATES: [&str; 6] = ["jinja", "jinja2", "j2", "erb", "em", "in"];

/// Extensions of compressed files, after one that may hold inertias or is an archive: `robot.urdf.gz`, `robots.tar.gz`.
const COMPRESSED: [&str; 6] = ["gz", "bz2", "xz", "zst", "lz4", "z"];
/// Extensions of archives, which may hold anything.
const ARCHIVES: [&str; 7] = ["zip", "7z", "rar", "tar", "tgz", "tbz2", "txz"];

fn extension(path: &Path) -> Option<&str> {
    path.extension()?.to_str()
}

/// The extension of a file in lower case, if it is one of those that are read; that of tables is one, whatever stands between
/// their columns.
pub(crate) fn known_extension(path: &Path) -> Option<&'static str> {
    let extension = extension(path)?;
    let known = ROBOTS.iter().chain(&GENERIC);
    let known = known.copied().find(|known| known.eq_ignore_ascii_case(extension));
    known.map(|known| if known == "tsv" { "csv" } else { known })
}

/// Whether a file of this extension, or of none, may hold anything.
pub(crate) fn is_generic(extension: Option<&str>) -> bool {
    extension.is_none_or(|e| GENERIC.contains(&e))
}

/// Why a file of this name is not read whatever is in it.
pub(crate) fn not_read(path: &Path) -> Option<FileProblem> {
    let extension = extension(path)?;
    if TEMPLATES.iter().any(|known| known.eq_ignore_ascii_case(extension))
        && path.file_stem().is_some_and(|stem| known_extension(Path::new(stem)).is_some())
    {
        return Some(FileProblem::Template);
    }
    let is_in =
        |all: &[&str], extension: &str| all.iter().any(|e| e.eq_ignore_ascii_case(extension));
    let is_compressed = is_in(&COMPRESSED, extension)
        && path.file_stem().map(Path::new).is_some_and(|stem| {
            known_extension(stem).is_some()
                || not_read(stem).is_some_and(|problem| !matches!(problem, FileProblem::Template))
        });
    if is_compressed || is_in(&ARCHIVES, extension) {
        return Some(FileProblem::Compressed);
    }
    let known = NOT_READ.iter().find(|(known, _)| known.eq_ignore_ascii_case(extension))?;
    Some(FileProblem::NotRead { format: known.1 })
}

/// The extension that a file without one would have, from how it begins.
pub(crate) fn sniffed(text: &str) -> &'static str {
    let trimmed = text.trim_start();
    let json = || serde_json::from_str::<serde::de::IgnoredAny>(trimmed).is_ok();
    let toml = || text.len() <= MAX_TOML_BYTES && toml::de::DeTable::parse(text).is_ok();
    match trimmed.as_bytes().first() {
        Some(b'<') => "xml",
        Some(b'{') => "json",
        // A list in JSON, or a table in TOML.
        Some(b'[') if json() => "json",
        Some(b'[') if trimmed[1..].trim_start().starts_with(['{', '[', '"']) && !toml() => "json",
        Some(b'[') => "toml",
        _ if toml() => "toml",
        _ => "csv",
    }
}

/// All extensions that are read, for a message.
pub(crate) fn all_extensions() -> String {
    ROBOTS.iter().chain(&GENERIC).map(|e| format!(".{e}")).collect::<Vec<_>>().join(", ")
}
