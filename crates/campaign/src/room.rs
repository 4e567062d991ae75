//! What a machine has left: bytes on a disk.

use std::path::Path;

/// Bytes that are free for this user on the disk of a place, which need not be there yet; none if the system does not tell.
#[must_use]
pub fn disk_left(place: &Path) -> Option<u64> {
    let place = std::path::absolute(place).ok()?;
    place.ancestors().find_map(free)
}

#[cfg(unix)]
fn free(place: &Path) -> Option<u64> {
    let disk = rustix::fs::statvfs(place).ok()?;
    Some(disk.f_bavail.saturating_mul(disk.f_frsize))
}

#[cfg(not(unix))]
fn free(_: &Path) -> Option<u64> {
    None
}

#[cfg(target_os = "linux")]
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_are_not_there_are_on_the_disk_of_those_above() {
        let folder = tempfile::tempdir().unwrap();
        let there = disk_left(folder.path()).unwrap();
        let below = disk_left(&folder.path().join("a/b/c")).unwrap();
        // Others write at the same time.
        assert!(there > 0 && below > there / 2 && below < 2 * there.max(1));
        assert_eq!(disk_left(Path::new("/proc/self")), Some(0));
    }
}
