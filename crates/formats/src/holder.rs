//! Which element an inertia belongs to, and whether its format has one there.

use crate::{Format, xml::Node};

/// The element around the inertia of a body, in every format.
pub(crate) const INERTIAL: &str = "inertial";

/// The body or link of an inertia. In MJCF it may stand in frames of its body.
pub(crate) fn holder<'t, 'a>(inertial: Node<'t, 'a>, format: Format) -> Option<Node<'t, 'a>> {
    let is_between = |node: &Node<'_, '_>| format == Format::Mjcf && is_frame(*node);
    inertial.ancestors().skip(1).find(|node| !is_between(node))
}

/// The inertias of a body or link, in the order of the file.
pub(crate) fn inertials<'t, 'a>(body: Node<'t, 'a>, format: Format) -> Vec<Node<'t, 'a>> {
    within(body, &|node| format == Format::Mjcf && is_frame(node))
}

/// As [`inertials`], and those that macros of xacro may leave out.
pub(crate) fn possible_inertials<'t, 'a>(body: Node<'t, 'a>, format: Format) -> Vec<Node<'t, 'a>> {
    within(body, &|node| node.is_macro() || (format == Format::Mjcf && is_frame(node)))
}

/// The inertias in an element, and in those below it that may stand between.
fn within<'t, 'a>(
    around: Node<'t, 'a>,
    is_between: &dyn Fn(Node<'t, 'a>) -> bool,
) -> Vec<Node<'t, 'a>> {
    let of = |child: Node<'t, 'a>| match child.name() {
        INERTIAL => vec![child],
        _ if is_between(child) => within(child, is_between),
        _ => Vec::new(),
    };
    around.children().flat_map(of).collect()
}

/// The frames of MJCF in which an inertia of a body stands, from the inside.
pub(crate) fn frames<'t, 'a>(inertial: Node<'t, 'a>) -> impl Iterator<Item = Node<'t, 'a>> {
    inertial.ancestors().skip(1).take_while(|node| is_frame(*node))
}

fn is_frame(node: Node<'_, '_>) -> bool {
    node.name() == "frame"
}

/// Whether an inertia stands where a file of this format has one. The settings of plugins and of sensors, say, may hold elements
/// of any name, which are no bodies.
pub(crate) fn is_in_place(inertial: Node<'_, '_>, format: Format) -> bool {
    if !is_known(inertial.ancestors().last()) {
        return true;
    }
    match holder(inertial, format) {
        // A file that others include may begin with it.
        None => true,
        Some(body) if body.parent().is_none() => !is_whole(body),
        Some(body) => {
            let is_block = format == Format::Urdf && body.name() == GAZEBO;
            is_block || is_body(body, format)
        }
    }
}

/// The block of a URDF file whose content is for Gazebo alone, as SDF.
const GAZEBO: &str = "gazebo";

/// Whether an inertia, or what is around it, stands in such a block.
pub(crate) fn is_in_gazebo(node: Node<'_, '_>) -> bool {
    node.ancestors().any(|above| above.name() == GAZEBO)
}

/// Whether an element has the name of those that hold an inertia.
fn is_element(node: Node<'_, '_>, format: Format) -> bool {
    match format {
        Format::Mjcf => node.name() == "body",
        Format::Urdf | Format::Sdf | Format::Csv | Format::Toml | Format::Json => {
            node.name() == "link"
        }
    }
}

/// Whether an element is that of a body of the file: it has the name, and so has everything around it that may hold bodies.
pub(crate) fn is_body(node: Node<'_, '_>, format: Format) -> bool {
    is_element(node, format) && is_among_bodies(node, format)
}

/// Whether MuJoCo makes bodies of an element of an MJCF file, of which it computes the inertia. A rigid one adds to a body that is there.
pub(crate) fn is_made_into_bodies(node: Node<'_, '_>, format: Format) -> bool {
    format == Format::Mjcf
        && matches!(node.name(), "composite" | "flexcomp")
        && node.attribute("rigid").is_none_or(|word| word.trim() != "true")
        && is_among_bodies(node, format)
}

/// Whether all that is around an element may hold bodies.
fn is_among_bodies(node: Node<'_, '_>, format: Format) -> bool {
    let around: &[&str] = match format {
        Format::Mjcf => &["body", "frame", "replicate", "worldbody"],
        Format::Sdf => &["model", "world", "population", "actor"],
        // Macros have no prefix in files of old versions of xacro.
        Format::Urdf | Format::Csv | Format::Toml | Format::Json => {
            &[GAZEBO, "model", "macro", "if", "unless"]
        }
    };
    node.ancestors().skip(1).all(|above| match above.parent() {
        Some(_) => above.is_macro() || around.contains(&above.name()),
        None => true,
    })
}

/// Whether an element is the root of a whole file: of one that is included, a part of a body may be the root.
fn is_whole(root: Node<'_, '_>) -> bool {
    matches!(root.name(), "robot" | "sdf" | "gazebo")
}

/// Whether a root is one of which it is known what may stand below it.
fn is_known(root: Option<Node<'_, '_>>) -> bool {
    let is_part =
        |root: Node<'_, '_>| matches!(root.name(), "mujoco" | "mujocoinclude" | "model" | "world");
    root.is_some_and(|root| is_whole(root) || is_part(root))
}
