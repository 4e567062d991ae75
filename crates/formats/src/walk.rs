//! Files and folders to be checked.

use std::{
    collections::{HashMap, hash_map::Entry},
    fs, io,
    path::{Path, PathBuf},
};
use walkdir::{DirEntry, WalkDir};

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
/// inertias and are not read, compressed files and archives, and links that lead nowhere are found as well, so that they
/// can be named. A folder without any file is an error.
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

/// Whether an entry of a folder is a folder to be walked, or a file that may hold inertias.
fn is_taken(entry: &DirEntry) -> bool {
    let path = entry.path();
    if entry.file_name().to_string_lossy().starts_with('.') {
        false
    } else if entry.file_type().is_dir() {
        !path.join("CACHEDIR.TAG").exists()
    } else {
        // A link to a folder, whatever its name, is none of these.
        (is_wanted(path) || is_lost(entry)) && !path.is_dir()
    }
}

/// Whether an entry is a link that leads nowhere, and would lead to a file that may hold inertias.
fn is_lost(entry: &DirEntry) -> bool {
    let path = entry.path();
    entry.path_is_symlink() && !path.exists() && fs::read_link(path).is_ok_and(|to| is_wanted(&to))
}

fn walk(folder: &Path, found: &mut Vec<Found>, errors: &mut Vec<FileError>, seen: &mut Seen) {
    let mut is_empty = true;
    let entries = WalkDir::new(folder).min_depth(1).sort_by_file_name().into_iter();
    for entry in entries.filter_entry(is_taken) {
        match entry {
            Ok(entry) if entry.file_type().is_dir() => continue,
            Ok(entry) => add(entry.into_path(), false, found, seen),
            Err(error) => {
                let path = error.path().unwrap_or(folder).to_owned();
                // Links to folders are not followed, without which there are no loops.
                let problem = error.into_io_error().unwrap_or_else(|| io::Error::other("a loop"));
                errors.push(FileError::new(
                    &path,
                    FileProblem::from(problem).into(),
                    Bearing::Holds,
                ));
            }
        }
        is_empty = false;
    }
    if is_empty {
        errors.push(FileError::new(folder, FileProblem::EmptyFolder.into(), Bearing::Holds));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{prelude::*, sample::select};

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

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Of any tree: what is below no hidden folder and no cache, and whose name says that it may hold inertias.
        #[test]
        fn trees_are_walked_whole(
            tree in prop::collection::btree_set(
                (
                    prop::collection::vec(select(&["a", "B.urdf", "a b", ".git", "c.d", "a.csv.gz"][..]), 0..4),
                    select(&["x.urdf", "X.SDF", "z.csv", "CACHEDIR.TAG", "z.repaired.csv", "t.txt", ".x.urdf", "hand.USDA", "x.urdf.gz", "p.csv.XZ", "t.txt.gz", "a.usd.bz2", "all.Zip", "r.tar.gz"][..]),
                ),
                1..20,
            ),
        ) {
            let root = tempfile::tempdir().unwrap();
            let root = root.path();
            for (folders, name) in &tree {
                let folder = root.join(folders.join("/"));
                fs::create_dir_all(&folder).unwrap();
                fs::write(folder.join(name), "").unwrap();
            }
            let is_cache = |folders: &[&'static str]| {
                !folders.is_empty() && tree.contains(&(folders.to_vec(), "CACHEDIR.TAG"))
            };
            let expected = tree.iter().filter(|(folders, name)| {
                let passed_over = folders.contains(&".git") || (1..=folders.len()).any(|n| is_cache(&folders[..n]));
                !passed_over && ["x.urdf", "X.SDF", "z.csv", "hand.USDA", "x.urdf.gz", "p.csv.XZ", "a.usd.bz2", "all.Zip", "r.tar.gz"].contains(name)
            });
            let mut expected: Vec<PathBuf> =
                expected.map(|(folders, name)| root.join(folders.join("/")).join(name)).collect();
            expected.sort();
            let (found, errors) = find(&[root.to_owned()]);
            let paths: Vec<PathBuf> = found.into_iter().map(|found| found.path).collect();
            prop_assert_eq!(&paths, &expected);
            prop_assert_eq!(errors.len(), usize::from(expected.is_empty()));
        }
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
        symlink("gone.urdf", root.join("latest")).unwrap();
        symlink("gone.txt", root.join("notes")).unwrap();
        symlink("a/robot.urdf", root.join("current")).unwrap();
        let (found, errors) = find(&[root.to_owned()]);
        assert!(errors.is_empty());
        assert_eq!(names(&found, root), ["a/robot.urdf", "dangling.urdf", "latest", "self.urdf"]);
    }
}
