//! A file as its bodies, and as what of it was not read.

use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

use crate::{
    Bearing, FileBody, FileError, FileProblem, Format, Gap, MAX_BYTES, MAX_TOML_BYTES, Products,
    csv, data,
    error::Refusal,
    gap::Gaps,
    kind::{all_extensions, is_generic, known_extension, not_read, sniffed},
    robots,
    text::{Offsets, Text},
    xml::Tree,
};

/// A file and the bodies in it.
#[derive(Clone, Debug)]
pub struct InertiaFile {
    path: PathBuf,
    format: Format,
    pub(crate) bytes: Vec<u8>,
    pub(crate) offsets: Offsets,
    products: Products,
    bodies: Vec<FileBody>,
    gaps: Vec<Gap>,
}

impl InertiaFile {
    /// Reads a file. `products` says what the products of inertia are in a file that does not
    /// say so itself.
    ///
    /// # Errors
    /// The file as a whole cannot be read. A body that cannot be is an error of that body alone.
    pub fn read(path: &Path, products: Products) -> Result<Self, FileError> {
        let fail = |problem: FileProblem| FileError::new(path, problem.into(), Bearing::Holds);
        if let Some(problem) = not_read(path) {
            return Err(FileError::new(path, problem.into(), Bearing::MayHold));
        }
        // Asked before opening, which would wait for the other end of a pipe.
        let metadata = std::fs::metadata(path).map_err(|e| fail(e.into()))?;
        if !metadata.is_file() {
            return Err(fail(FileProblem::NotAFile));
        }
        let file = File::open(path).map_err(|e| fail(e.into()))?;
        Self::read_from(path, file, products)
    }

    /// Reads what a source hands out, up to [`MAX_BYTES`]: standard input, say. `name` is what the
    /// file is called in messages; without an extension, the format is told by how it begins.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_from(
        name: &Path,
        source: impl Read,
        products: Products,
    ) -> Result<Self, FileError> {
        let mut bytes = Vec::new();
        source
            .take(MAX_BYTES as u64 + 1)
            .read_to_end(&mut bytes)
            .map_err(|e| FileError::new(name, FileProblem::from(e).into(), Bearing::Holds))?;
        Self::parse(name, bytes, products)
    }

    /// Reads what a file of this name holds.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(path: &Path, bytes: Vec<u8>, products: Products) -> Result<Self, FileError> {
        let extension = known_extension(path);
        let has_none = path.extension().is_none();
        match parse(extension, has_none, &bytes, products) {
            Ok(Parsed { format, offsets, bodies, gaps }) => {
                let (path, gaps) = (path.to_owned(), gaps.into_vec());
                Ok(Self { path, format, bytes, offsets, products, bodies, gaps })
            }
            Err(refusal) => {
                let bearing = bearing(extension, &refusal.problem, &bytes);
                Err(FileError::new(path, refusal, bearing))
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

    /// What its products of inertia are taken for where it does not say so.
    pub(crate) fn products(&self) -> Products {
        self.products
    }

    /// The bodies, in the order of the file.
    #[must_use]
    pub fn bodies(&self) -> &[FileBody] {
        &self.bodies
    }

    /// What of the file was not read though the rest was, in the order of the file.
    #[must_use]
    pub fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    /// The same file with other bytes.
    pub(crate) fn reread(&self, bytes: Vec<u8>) -> Result<Self, FileError> {
        Self::parse(&self.path, bytes, self.products)
    }
}

/// What a file that is refused has to do with inertias.
fn bearing(extension: Option<&str>, problem: &FileProblem, bytes: &[u8]) -> Bearing {
    if !is_generic(extension) || matches!(problem, FileProblem::Unclear { .. }) {
        return Bearing::Holds;
    }
    match problem {
        FileProblem::Unknown { .. } if mentions(bytes) => Bearing::MayHold,
        FileProblem::TooLarge { .. } if !mentions(bytes) => Bearing::MayHold,
        _ if mentions(bytes) => Bearing::Holds,
        _ => Bearing::Nothing,
    }
}

/// Whether a file that cannot be read speaks of inertias at all: a word that begins so, or one of the
/// entries by itself. Sixteen bits a character make no difference.
fn mentions(bytes: &[u8]) -> bool {
    let plain: Vec<u8> = bytes.iter().filter(|b| **b != 0).map(u8::to_ascii_lowercase).collect();
    let bounded = |b: &u8| !b.is_ascii_alphanumeric();
    let begins = |i: usize| {
        WORDS.iter().any(|(word, whole)| {
            plain[i..].starts_with(word)
                && (!whole || plain.get(i + word.len()).is_none_or(bounded))
        })
    };
    // The first character alone decides nearly everywhere.
    let mut first = [false; 256];
    for (word, _) in WORDS {
        first[usize::from(word[0])] = true;
    }
    let mut before = &b' ';
    for (i, b) in plain.iter().enumerate() {
        if first[usize::from(*b)] && bounded(before) && begins(i) {
            return true;
        }
        before = b;
    }
    false
}

/// What says that a file speaks of inertias, and whether it must be a whole word.
const WORDS: [(&[u8], bool); 8] = [
    (b"inerti", false),
    (b"ixx", true),
    (b"i11", true),
    (b"i_xx", true),
    (b"ixxkgm2", true),
    (b"fullinertia", true),
    (b"diaginertia", true),
    (b"diagonalinertia", true),
];

/// What a file holds.
struct Parsed {
    format: Format,
    offsets: Offsets,
    bodies: Vec<FileBody>,
    gaps: Gaps,
}

fn parse(
    extension: Option<&'static str>,
    has_none: bool,
    bytes: &[u8],
    products: Products,
) -> Result<Parsed, Refusal> {
    let limit = if extension == Some("toml") { MAX_TOML_BYTES } else { MAX_BYTES };
    if bytes.len() > limit {
        return Err(FileProblem::TooLarge { limit }.into());
    }
    let text = Text::new(bytes, extension == Some("csv"))?;
    let is_xml = || text.as_str().trim_start().starts_with('<');
    let like = match extension {
        Some(extension) => extension,
        None if has_none => sniffed(text.as_str()),
        None if is_xml() => "xml",
        None => {
            let message = format!("its extension is none of {}", all_extensions());
            return Err(FileProblem::Unknown { message }.into());
        }
    };
    if like == "toml" && bytes.len() > MAX_TOML_BYTES {
        return Err(FileProblem::TooLarge { limit: MAX_TOML_BYTES }.into());
    }
    let (format, (bodies, gaps)) = match like {
        "csv" => (Format::Csv, csv::read(&text, products)?),
        "toml" => (Format::Toml, data::toml(&text, products)?),
        "json" => (Format::Json, data::json(&text, products)?),
        _ => {
            let tree = Tree::parse(&text)?;
            let format = robots::format_of(&tree, extension)?;
            (format, robots::read(&tree, format, extension, products)?)
        }
    };
    Ok(Parsed { format, offsets: text.offsets().clone(), bodies, gaps })
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
        assert_eq!(format("a.world", "<part/>"), Format::Sdf);
        assert_eq!(format("robot", "<robot/>"), Format::Urdf);
        assert_eq!(format("a.Csv", "ixx,iyy,izz"), Format::Csv);
        assert_eq!(format("a.TSV", "ixx\tiyy\tizz"), Format::Csv);
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
            assert_eq!(parse(name, text).unwrap_err().bearing(), Bearing::Nothing, "{name}");
        }
        for (name, text) in [
            ("broken.urdf", "<a"),
            ("empty.sdf", ""),
            ("broken.xml", "<robot><inertial>"),
            ("broken.json", "{\"inertia_kg_m2\": "),
        ] {
            assert_eq!(parse(name, text).unwrap_err().bearing(), Bearing::Holds, "{name}");
        }
        for (name, text) in [
            ("other.json", "{\"links\": [{\"inertia\": [1, 1, 3]}]}"),
            ("other.csv", "part,Ixx about base,Iyy,Izz\na,1,1,3"),
            ("other.toml", "[arm]\ninertia = 3"),
            ("other.xml", "<OpenSimDocument><!-- inertia --></OpenSimDocument>"),
        ] {
            assert_eq!(parse(name, text).unwrap_err().bearing(), Bearing::MayHold, "{name}");
        }
        // Words that only look like it: a hash, a library.
        for text in ["{\"hash\": \"Ki11xqixxP==\"}", "{\"a\": \"i110 9ixx\"}"] {
            let error = parse("package-lock.json", text).unwrap_err();
            assert_eq!(error.bearing(), Bearing::Nothing, "{text}");
        }
        for name in ["a.usd", "a.USDA", "a.usdc", "a.mjb", "rover.sdf.jinja"] {
            let error = InertiaFile::read(Path::new(name), Products::default()).unwrap_err();
            assert_eq!(error.bearing(), Bearing::MayHold, "{name}");
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
