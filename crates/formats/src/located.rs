//! Where the names lead by which a robot file names others.

use std::path::{Path, PathBuf};

/// The file of a model in its folder, which stands for it.
const MODEL: &str = "model.sdf";

/// Where the file is that a robot file includes by this name, if it is there: by its path from the folder of the robot, or, as in
/// `model://arm`, in a folder `arm` above or beside it. A folder stands for the `model.sdf` in it.
#[must_use]
pub fn included_file(name: &str, robot: &Path) -> Option<PathBuf> {
    if name.is_empty() {
        return None;
    }
    let folder = || located(name, robot, |path| path.join(MODEL).is_file());
    located(name, robot, Path::is_file).or_else(|| Some(folder()?.join(MODEL)))
}

/// Where something is, of which `is_it` tells whether it is there: from the folder of the robot, or in the package of that name around it.
pub(crate) fn located(uri: &str, robot: &Path, is_it: impl Fn(&Path) -> bool) -> Option<PathBuf> {
    let folder = robot.parent().unwrap_or(Path::new(""));
    if let Some(path) = uri.strip_prefix("file://") {
        return Some(folder.join(path)).filter(|path| is_it(path));
    }
    let Some((_, inside)) = uri.split_once("://") else {
        return Some(folder.join(uri)).filter(|path| is_it(path));
    };
    let (package, rest) = inside.split_once('/').unwrap_or((inside, ""));
    let whole =
        std::fs::canonicalize(if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    let candidates: Vec<PathBuf> = whole
        .ok()?
        .ancestors()
        .flat_map(|above| {
            let own =
                above.file_name().is_some_and(|name| name == package).then(|| above.join(rest));
            own.into_iter().chain([above.join(inside)])
        })
        .collect();
    candidates.into_iter().find(|path| is_it(path))
}
