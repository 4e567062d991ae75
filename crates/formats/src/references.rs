//! Paths in a robot file that lead from its folder to other files.

use crate::xml::{Node, Tree};

/// The relative paths of a file, each once, in the order of the file.
pub(crate) fn relative(tree: &Tree<'_>) -> Vec<String> {
    let compiler = |name| tree.said("compiler", name);
    let mut paths: Vec<String> = Vec::new();
    for node in tree.nodes() {
        let named = ["filename", "file", "href"].into_iter().find_map(|name| node.attribute(name));
        let Some(path) = named.or_else(|| (node.name() == "uri").then(|| node.text())) else {
            continue;
        };
        let path = path.trim();
        let folder = match node.name() {
            "mesh" | "hfield" | "skin" => compiler("meshdir").or(compiler("assetdir")),
            "texture" => compiler("texturedir").or(compiler("assetdir")),
            _ => None,
        };
        if !is_relative(path)
            || is_plugin(node)
            || folder.is_some_and(|folder| !is_relative(folder))
        {
            continue;
        }
        let path = in_folder(folder, path);
        if !paths.contains(&path) {
            paths.push(path);
        }
    }
    paths
}

/// A path below a folder, if there is one.
pub(crate) fn in_folder(folder: Option<&str>, path: &str) -> String {
    match folder.map(|folder| folder.trim_end_matches('/')) {
        Some(folder) if !folder.is_empty() => format!("{folder}/{path}"),
        Some(_) | None => path.to_owned(),
    }
}

/// Libraries of Gazebo and MuJoCo are found elsewhere.
fn is_plugin(node: Node<'_, '_>) -> bool {
    node.ancestors().any(|above| above.name() == "plugin")
}

fn is_relative(path: &str) -> bool {
    let drive = path.get(1..2) == Some(":");
    !path.is_empty() && !path.contains("://") && !path.starts_with(['/', '\\', '$']) && !drive
}
