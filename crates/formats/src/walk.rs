//! Files and folders to be checked.

use std::{
    collections::{HashMap, hash_map::Entry},
    fs,
    path::{Path, PathBuf},
};

use crate::{
    Bearing, FileError, FileProblem,
    kind::{known_extension, not_read},
    repair::is_copy,
};

/// A file to be checked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Its path: as given, or below the folder that was given.
    pub path: PathBuf,
    /// Whether it was asked for by name, and not come across in a folder.
    pub named: bool,
}

/// The files that these paths mean: files as they are, folders with all that is below them and
/// has an extension that is read, in the order of their names. Each file once.
///
/// In folders, hidden names, repaired copies, links to folders and folders that call themselves
/// caches (`CACHEDIR.TAG`, like Cargo's `target`) are passed over. Files of formats that may hold
/// inertias and are not read are found as well, so that they can be named. A folder without any
/// file is an error.
#[must_use]
pub fn find(paths: &[PathBuf]) -> (Vec<Found>, Vec<FileError>) {
    let mut found = Vec::new();
    let mut errors = Vec::new();
    let mut seen = Seen::new();
    for path in paths {
        match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => walk(path, &mut found, &mut errors, &mut seen),
            Ok(_) => add(path.clone(), true, &mut found, &mut seen),
            Err(error) => {
                errors.push(FileError::new(path, FileProblem::from(error).into(), Bearing::Holds))
            }
        }
    }
    (found, errors)
}

/// Canonical paths, and where they are in the list.
type Seen = HashMap<PathBuf, usize>;

fn add(path: PathBuf, named: bool, found: &mut Vec<Found>, seen: &mut Seen) {
    let canonical = fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
    match seen.entry(canonical) {
        Entry::Vacant(entry) => {
            entry.insert(found.len());
            found.push(Found { path, named });
        }
        Entry::Occupied(entry) => found[*entry.get()].named |= named,
    }
}

/// Whether the name of a file in a folder says that it may hold inertias.
fn is_wanted(path: &Path) -> bool {
    (known_extension(path).is_some() || not_read(path).is_some()) && !is_copy(path)
}

fn walk(folder: &Path, found: &mut Vec<Found>, errors: &mut Vec<FileError>, seen: &mut Seen) {
    let mut is_empty = true;
    // A stack of our own: folders may be nested deeper than calls may.
    let mut open = vec![folder.to_owned()];
    while let Some(path) = open.pop() {
        let is_link = fs::symlink_metadata(&path).is_ok_and(|m| m.file_type().is_symlink());
        let is_folder = fs::metadata(&path).is_ok_and(|m| m.is_dir());
        let given = path == folder;
        if is_folder && !given && (is_link || path.join("CACHEDIR.TAG").exists()) {
            continue;
        }
        if !is_folder {
            is_empty = false;
            add(path, false, found, seen);
            continue;
        }
        let listed = fs::read_dir(&path)
            .and_then(|entries| entries.map(|entry| entry.map(|entry| entry.path())).collect());
        let mut entries: Vec<PathBuf> = match listed {
            Ok(entries) => entries,
            Err(error) => {
                is_empty = false;
                errors.push(FileError::new(&path, FileProblem::from(error).into(), Bearing::Holds));
                continue;
            }
        };
        entries.retain(|entry| {
            let hidden =
                entry.file_name().is_none_or(|name| name.to_string_lossy().starts_with('.'));
            let wanted = is_wanted(entry);
            !hidden && (wanted || fs::metadata(entry).is_ok_and(|m| m.is_dir()))
        });
        // The stack hands out the last first.
        entries.sort_by(|a, b| b.cmp(a));
        open.extend(entries);
    }
    if is_empty {
        errors.push(FileError::new(folder, FileProblem::EmptyFolder.into(), Bearing::Holds));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(found: &[Found], root: &Path) -> Vec<String> {
        let below = |f: &Found| f.path.strip_prefix(root).unwrap_or(&f.path).display().to_string();
        found.iter().map(below).collect()
    }

    #[test]
    fn folders_are_walked_in_order_and_what_is_not_ours_is_passed_over() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        for name in [
            "b/z.urdf",
            "b/a.SDF",
            "a.csv",
            ".git/x.urdf",
            "target/x.urdf",
            "target/CACHEDIR.TAG",
            "a.repaired.csv",
            "notes.txt",
            "c.d/e.xml",
        ] {
            fs::create_dir_all(root.join(name).parent().unwrap()).unwrap();
            fs::write(root.join(name), "").unwrap();
        }
        let (found, errors) = find(&[root.to_owned()]);
        assert!(errors.is_empty());
        assert_eq!(names(&found, root), ["a.csv", "b/a.SDF", "b/z.urdf", "c.d/e.xml"]);
        assert!(found.iter().all(|f| !f.named));
        let twice = find(&[root.join("b"), root.join("b/z.urdf"), root.to_owned()]).0;
        assert_eq!(twice.len(), 4);
        assert!(twice.iter().any(|f| f.named && f.path.ends_with("z.urdf")));
        assert_eq!(find(&[root.join("nowhere")]).1.len(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn links_make_no_loops_and_no_duplicates() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        fs::create_dir(root.join("a")).unwrap();
        fs::write(root.join("a/robot.urdf"), "<robot/>").unwrap();
        symlink(root, root.join("a/loop")).unwrap();
        symlink(root.join("a/robot.urdf"), root.join("same.urdf")).unwrap();
        symlink(root.join("gone"), root.join("dangling.urdf")).unwrap();
        symlink("self.urdf", root.join("self.urdf")).unwrap();
        let (found, errors) = find(&[root.to_owned()]);
        assert!(errors.is_empty());
        assert_eq!(names(&found, root), ["a/robot.urdf", "dangling.urdf", "self.urdf"]);
    }
}
