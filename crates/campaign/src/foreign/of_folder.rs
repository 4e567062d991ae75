//! The files of a folder that are a table together, and what stands beside them.

use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{self, Read},
    path::{Path, PathBuf},
};

use super::ForeignError;

/// What a Parquet file begins with.
pub(super) const PARQUET: &[u8] = b"PAR1";
pub(super) const NOT_REGULAR: &str = "it is not a regular file";
/// The folder in which Delta Lake keeps which files of a table are in force.
const DELTA_LOG: &str = "_delta_log";
/// Extensions of Parquet files that some programs write, and of tables in other forms. Texts (.txt) and JSON are more often none.
const OTHER_PARQUET: [&str; 2] = ["parq", "pqt"];
const TABLES: [&str; 25] = [
    "csv", "tsv", "tab", "dat", "jsonl", "ndjson", "npy", "npz", "feather", "arrow", "arrows",
    "ipc", "orc", "avro", "h5", "hdf5", "mat", "xlsx", "xls", "xlsm", "ods", "pkl", "pickle",
    "sqlite", "duckdb",
];
/// Extensions of compressed files, after that of what is compressed.
const COMPRESSED: [&str; 9] = ["gz", "bz2", "xz", "zst", "lz4", "br", "z", "zip", "7z"];

/// A folder with Parquet files.
#[derive(Debug)]
pub(super) struct Folder {
    /// Its Parquet files, in the order of their names.
    pub(super) files: Vec<PathBuf>,
    /// Files that may be tables, too.
    pub(super) beside: Vec<PathBuf>,
}

impl Folder {
    /// Looks at what is in a folder.
    ///
    /// # Errors
    /// Something in it cannot be looked at, or holds rows that belong to the table and would not be read.
    pub(super) fn read(path: &Path) -> Result<Self, ForeignError> {
        let failed = |problem: String| ForeignError::new(path, problem);
        let unread = |error: io::Error| failed(error.to_string());
        let (mut files, mut folders, mut beside) = (Vec::new(), Vec::new(), Vec::new());
        for entry in fs::read_dir(path).map_err(unread)? {
            let there = entry.map_err(unread)?.path();
            if is_hidden(&there) {
                continue;
            }
            // What cannot be looked at, such as a link to a disk that is away, may be a table, or a folder of tables.
            let found = fs::metadata(&there);
            let found = found.map_err(|error| ForeignError::new(&there, error.to_string()))?;
            if found.is_dir() {
                folders.push(there);
            } else if has_parquet_name(&there) {
                if !found.is_file() {
                    return Err(ForeignError::new(&there, NOT_REGULAR));
                }
                files.push(there);
            } else if let Some(problem) = other_parquet(&there, found.is_file()) {
                return Err(ForeignError::new(&there, problem));
            } else if has_ending(uncompressed(&there), &TABLES) {
                beside.push(there);
            }
        }
        files.sort();
        folders.sort();
        beside.sort();
        apart(&files)?;
        if folders.iter().any(|folder| folder.ends_with(DELTA_LOG)) {
            let problem = "it is a Delta table: which of its files hold rows that count stands in _delta_log, which is not read: write \
                           its rows to a file";
            return Err(failed(problem.to_owned()));
        }
        for folder in folders.iter().filter(|_| !files.is_empty()) {
            if holds_parquet(folder)? {
                let below = folder.file_name().unwrap_or_default().display();
                return Err(failed(format!(
                    "beside its files it has the folder {below} with Parquet files, which would not be read: judge one folder at a time, or put all files into one"
                )));
            }
        }
        Ok(Self { files, beside })
    }
}

/// Whether a file has one of these extensions, in any letters.
fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|own| endings.iter().any(|end| own.eq_ignore_ascii_case(end)))
}

/// The name of a file without the extension that says that it is compressed.
fn uncompressed(path: &Path) -> &Path {
    let stem = path.file_stem().map(Path::new);
    stem.filter(|_| has_ending(path, &COMPRESSED)).unwrap_or(path)
}

/// Why a file that is not called as Parquet files are holds rows all the same, by its name or by how it begins.
fn other_parquet(path: &Path, is_file: bool) -> Option<&'static str> {
    let plain = uncompressed(path);
    if plain != path && (has_parquet_name(plain) || has_ending(plain, &OTHER_PARQUET)) {
        return Some(
            "it is a compressed Parquet file, which would not be judged with the other files: expand it, or move it elsewhere",
        );
    }
    // Programs keep notes on the files of a folder in Parquet files without rows, _metadata say.
    let is_note = path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"_"));
    let begins = || {
        let mut start = [0; PARQUET.len()];
        let read = File::open(path).and_then(|mut file| file.read_exact(&mut start));
        read.is_ok() && start == PARQUET
    };
    (has_ending(path, &OTHER_PARQUET) || (is_file && !is_note && begins())).then_some(
        "it is a Parquet file that is called neither .parquet nor .pq, and would not be judged with the other files: \
         give it such a name, or move it elsewhere",
    )
}

/// Whether a file is called as Parquet files are.
pub(super) fn has_parquet_name(path: &Path) -> bool {
    let is = |end: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(end));
    is("parquet") || is("pq")
}

/// What is hidden is of programs, such as copies of a file that is being written.
fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}

/// Whether a folder has Parquet files, by any name that says so, at any depth.
fn holds_parquet(folder: &Path) -> Result<bool, ForeignError> {
    let is_parquet = |path: &Path| {
        let plain = uncompressed(path);
        has_parquet_name(plain) || has_ending(plain, &OTHER_PARQUET)
    };
    for entry in walkdir::WalkDir::new(folder).follow_links(true) {
        let entry = match entry {
            // A link to a folder that it is in, which is looked at already.
            Err(error) if error.loop_ancestor().is_some() => continue,
            Err(error) => {
                let path = error.path().unwrap_or(folder).to_owned();
                return Err(ForeignError::new(&path, io::Error::from(error).to_string()));
            }
            Ok(entry) => entry,
        };
        if !entry.file_type().is_dir() && is_parquet(entry.path()) && !is_hidden(entry.path()) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// That no file is there twice, by links.
fn apart(files: &[PathBuf]) -> Result<(), ForeignError> {
    let mut seen: BTreeMap<PathBuf, &Path> = BTreeMap::new();
    for file in files {
        let whole =
            fs::canonicalize(file).map_err(|error| ForeignError::new(file, error.to_string()))?;
        if let Some(other) = seen.insert(whole, file) {
            let problem = format!("it is the file {} again, and rows count once", other.display());
            return Err(ForeignError::new(file, problem));
        }
    }
    Ok(())
}
