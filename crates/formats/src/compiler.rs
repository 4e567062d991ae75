//! What MuJoCo's compiler is told that changes the inertias of a file, or makes several bodies of one.

use std::fmt;

use crate::{
    Format, Gap, GapKind,
    body::shortened,
    xml::{Node, Tree},
};

/// What tells MuJoCo's compiler to compute all inertias from geoms, or to scale all masses to a total. Of several that
/// state an attribute, it believes the last.
pub(crate) fn overridden(tree: &Tree<'_>) -> Option<String> {
    let from_geometry = said(tree, "inertiafromgeom").filter(|(_, told)| *told == "true");
    // Without a total, and with one that is not positive, the masses stay.
    from_geometry.or_else(|| positive(tree, "settotalmass")).map(written)
}

/// Why MuJoCo may use other numbers than those that a file states for a link.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CompilerDoubt {
    /// It raises what is below a bound, such as `boundmass="0.1"`.
    Raised {
        /// The attribute.
        told: String,
    },
    /// A URDF file has an element `<mujoco>` for MuJoCo alone, in which an attribute makes it compute all inertias from
    /// geometry or scale all masses.
    OfUrdf {
        /// The attribute.
        told: String,
    },
    /// Bodies of an MJCF file stand in `<replicate>`, of which it makes several.
    Replicated {
        /// The first of them, as it is called in the file.
        body: String,
    },
    /// The file includes others, whose compiler counts for this one too.
    Included,
}

impl fmt::Display for CompilerDoubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Raised { told } => {
                write!(f, "the file has {told}: MuJoCo raises smaller numbers to that")
            }
            Self::OfUrdf { told } => write!(
                f,
                "the element <mujoco> of the file has {told}: MuJoCo, and no other program, does not use the masses and \
                 inertias as they are written"
            ),
            Self::Replicated { body } => write!(
                f,
                "\"{body}\" stands in <replicate>: MuJoCo makes several bodies of it, which all have the same numbers"
            ),
            Self::Included => f.write_str(
                "the files that this file includes are not read: MuJoCo does not use the masses and inertias as they are \
                 written if a <compiler> in one of them has inertiafromgeom=\"true\" or a positive settotalmass",
            ),
        }
    }
}

/// The doubts about a file of this format, of which these parts were not read.
pub(crate) fn doubts(tree: &Tree<'_>, format: Format, gaps: &[Gap]) -> Vec<CompilerDoubt> {
    let bounds = ["boundmass", "boundinertia"].into_iter().filter_map(|name| positive(tree, name));
    let raised = bounds.map(|found| CompilerDoubt::Raised { told: written(found) });
    match format {
        Format::Mjcf => {
            let includes = gaps.iter().any(|gap| gap.kind() == GapKind::Included);
            let mut replicated = tree.all("replicate").flat_map(Node::descendants);
            let body = replicated.find(|node| node.name() == "body");
            let body = body.map(|body| body.attribute("name").unwrap_or("unnamed"));
            let replicated = body.map(|body| CompilerDoubt::Replicated { body: shortened(body) });
            let all = raised.chain(replicated);
            all.chain(includes.then_some(CompilerDoubt::Included)).collect()
        }
        Format::Urdf => {
            let of_urdf = overridden(tree).map(|told| CompilerDoubt::OfUrdf { told });
            of_urdf.into_iter().chain(raised).collect()
        }
        Format::Sdf | Format::Csv | Format::Toml | Format::Json => Vec::new(),
    }
}

/// An attribute of the compiler and its value.
type Said<'a> = (&'static str, &'a str);

fn said<'a>(tree: &'a Tree<'_>, name: &'static str) -> Option<Said<'a>> {
    Some((name, tree.said("compiler", name)?.trim()))
}

fn positive<'a>(tree: &'a Tree<'_>, name: &'static str) -> Option<Said<'a>> {
    said(tree, name).filter(|(_, told)| told.parse().is_ok_and(|number: f64| number > 0.0))
}

fn written((name, told): Said<'_>) -> String {
    format!("{name}=\"{told}\"")
}
