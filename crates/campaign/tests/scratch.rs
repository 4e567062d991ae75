//! A folder of its own for the files of a test.

use tempfile::TempDir;

/// In memory where there is a folder of the system for that: these tests write thousands of small files, of which campaigns make sure
/// that the disk has them, and would wait for the disk most of the time.
pub(crate) fn scratch() -> TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap()
}
