//! What SDFormat makes of truth values, and in which version attributes stand in the place of elements.

use crate::xml::Node;

/// A truth value, in letters of any size; nothing of a word that SDFormat refuses.
pub(crate) fn truth(word: &str) -> Option<bool> {
    match word.trim().to_ascii_lowercase().as_str() {
        "true" | "1" => Some(true),
        "false" | "0" => Some(false),
        _ => None,
    }
}

/// Whether masses, entries and poses may be attributes of the elements that hold them in later versions, as `<origin
/// pose="">`: in SDFormat 1.0, and where no version is stated.
pub(crate) fn has_attributes(node: Node<'_, '_>) -> bool {
    let version = node.ancestors().find_map(|node| match node.name() {
        "sdf" | "gazebo" => node.attribute("version"),
        _ => None,
    });
    version.is_none_or(|version| version.trim() == "1.0")
}
