use std::{
    fmt,
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

use crate::{
    Body, FileError, FileProblem, MAX_BYTES, MAX_TOML_BYTES, Products, csv, data, robots,
    text::{Refusal, Text},
    xml::Tree,
};

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
const GENERIC: [&str; 4] = ["xml", "csv", "toml", "json"];

/// The extension of a file in lower case, if it is one of those that are read.
pub(crate) fn known_extension(path: &Path) -> Option<&'static str> {
    let extension = path.extension()?.to_str()?;
    ROBOTS.iter().chain(&GENERIC).find(|known| known.eq_ignore_ascii_case(extension)).copied()
}

/// A file and the bodies in it.
#[derive(Clone, Debug)]
pub struct InertiaFile {
    path: PathBuf,
    format: Format,
    pub(crate) bytes: Vec<u8>,
    pub(crate) base: usize,
    default: Products,
    bodies: Vec<Body>,
}

impl InertiaFile {
    /// Reads a file. `products` says what the products of inertia are in a file that does not
    /// say so itself.
    ///
    /// # Errors
    /// The file as a whole cannot be read. A body that cannot be is an error of that body alone.
    pub fn read(path: &Path, products: Products) -> Result<Self, FileError> {
        let fail = |problem: FileProblem| FileError::new(path, problem.into(), false);
        // Asked before opening, which would wait for the other end of a pipe.
        let metadata = std::fs::metadata(path).map_err(|e| fail(e.into()))?;
        if !metadata.is_file() {
            return Err(fail(FileProblem::NotAFile));
        }
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|file| file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes))
            .map_err(|e| fail(e.into()))?;
        Self::parse(path, bytes, products)
    }

    /// Reads what a file of this name holds.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(path: &Path, bytes: Vec<u8>, products: Products) -> Result<Self, FileError> {
        let extension = known_extension(path);
        match parse(extension, &bytes, products) {
            Ok((format, base, bodies)) => {
                let path = path.to_owned();
                Ok(Self { path, format, bytes, base, default: products, bodies })
            }
            Err(refusal) => {
                let foreign = extension.is_none_or(|e| GENERIC.contains(&e)) && !mentions(&bytes);
                Err(FileError::new(path, refusal, foreign))
            }
        }
    }

    /// The path that was read.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The format that was found.
    #[must_use]
    pub fn format(&self) -> Format {
        self.format
    }

    /// The bodies, in the order of the file.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The same file with other bytes.
    pub(crate) fn reread(&self, bytes: Vec<u8>) -> Result<Self, FileError> {
        Self::parse(&self.path, bytes, self.default)
    }
}

/// Whether a file that cannot be read speaks of inertias at all.
fn mentions(bytes: &[u8]) -> bool {
    ["inerti", "ixx", "i11"]
        .iter()
        .any(|word| bytes.windows(word.len()).any(|w| w.eq_ignore_ascii_case(word.as_bytes())))
}

fn parse(
    extension: Option<&str>,
    bytes: &[u8],
    products: Products,
) -> Result<(Format, usize, Vec<Body>), Refusal> {
    let limit = if extension == Some("toml") { MAX_TOML_BYTES } else { MAX_BYTES };
    if bytes.len() > limit {
        return Err(FileProblem::TooLarge { limit }.into());
    }
    let text = Text::new(bytes, extension == Some("csv"))?;
    let (format, bodies) = match extension {
        Some("csv") => (Format::Csv, csv::read(&text, products)?),
        Some("toml") => (Format::Toml, data::toml(&text, products)?),
        Some("json") => (Format::Json, data::json(&text, products)?),
        None if !text.as_str().trim_start().starts_with('<') => {
            let message = format!("its extension is none of {}", all_extensions());
            return Err(FileProblem::Unknown { message }.into());
        }
        _ => {
            let tree = Tree::parse(&text)?;
            let format = match robots::format_of(tree.root()) {
                Some(format) => format,
                // Parts of a robot that another file includes.
                None if extension == Some("xacro") => Format::Urdf,
                None => {
                    let root = crate::body::shortened(tree.root());
                    let message = format!(
                        "its root element is <{root}>, and those of URDF, MJCF and SDF are \
                         <robot>, <mujoco> and <sdf>"
                    );
                    return Err(FileProblem::Unknown { message }.into());
                }
            };
            (format, robots::read(&tree, format, products)?)
        }
    };
    Ok((format, text.base(), bodies))
}

fn all_extensions() -> String {
    ROBOTS.iter().chain(&GENERIC).map(|e| format!(".{e}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(name: &str, text: &str) -> Result<InertiaFile, FileError> {
        InertiaFile::parse(Path::new(name), text.as_bytes().to_vec(), Products::default())
    }

    #[test]
    fn the_root_element_decides_and_the_extension_where_there_is_none() {
        let format = |name, text| parse(name, text).map(|file| file.format()).unwrap();
        assert_eq!(format("a.xml", "<robot/>"), Format::Urdf);
        assert_eq!(format("a.xml", "<mujoco/>"), Format::Mjcf);
        assert_eq!(format("a.URDF", "<sdf/>"), Format::Sdf);
        assert_eq!(format("a.xacro", "<part/>"), Format::Urdf);
        assert_eq!(format("robot", "<robot/>"), Format::Urdf);
        assert_eq!(format("a.Csv", "ixx,iyy,izz"), Format::Csv);
    }

    #[test]
    fn files_of_something_else_are_foreign() {
        for (name, text) in [
            ("package.xml", "<package/>"),
            ("package.json", "{\"name\": 1}"),
            ("tsconfig.json", "{ // a comment\n}"),
            ("Cargo.toml", "[package]\nname = 'x'"),
            ("runs.csv", "time,x\n1,2"),
            ("notes.txt", "words"),
            ("broken.xml", "<a"),
            ("empty.json", ""),
        ] {
            assert!(parse(name, text).unwrap_err().is_foreign(), "{name}");
        }
        for (name, text) in [
            ("broken.urdf", "<a"),
            ("empty.sdf", ""),
            ("broken.xml", "<robot><inertial>"),
            ("broken.json", "{\"inertia_kg_m2\": "),
        ] {
            assert!(!parse(name, text).unwrap_err().is_foreign(), "{name}");
        }
    }

    #[test]
    fn errors_name_file_and_line() {
        let error = parse("here/broken.urdf", "<robot>\n<link></robot>").unwrap_err();
        assert!(error.to_string().starts_with("here/broken.urdf:2: malformed: "), "{error}");
        let missing = InertiaFile::read(Path::new("nowhere.urdf"), Products::default());
        assert!(missing.unwrap_err().to_string().contains("cannot be read"));
        let folder = InertiaFile::read(Path::new("."), Products::default());
        assert!(folder.unwrap_err().to_string().contains("not a regular file"));
    }
}
