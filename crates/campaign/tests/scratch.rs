//! A folder of its own for the files of a test, and tables in files.

use gyradius_campaign::{Extent, Table, TableFormat};
use std::{
    fs::File,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

/// In memory where there is a folder of the system for that: these tests write thousands of small files, of which campaigns make sure
/// that the disk has them, and would wait for the disk most of the time.
pub(crate) fn scratch() -> TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap()
}

/// A table in a file of a folder, in the format that its name says.
pub(crate) fn written(table: &Table, folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    let format = TableFormat::of_path(&path).unwrap();
    let mut writer =
        format.writer(table, &Extent::default(), File::create(&path).unwrap()).unwrap();
    writer.write(table).unwrap();
    writer.finish().unwrap();
    path
}
