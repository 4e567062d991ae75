//! What tells simulators to change the inertias of a file, or to make several bodies of one: MuJoCo's compiler above all.

use std::fmt;

use crate::{
    Format,
    body::shortened,
    frame::with_quaternions,
    holder::{INERTIAL, is_body},
    xml::{Node, Tree},
};

/// What tells MuJoCo's compiler to compute all inertias from geoms, or to scale all masses to a total. Of several that
/// state an attribute, it believes the last.
pub(crate) fn overridden(tree: &Tree<'_>) -> Option<String> {
    let from_geometry = said(tree, "inertiafromgeom").filter(|(_, told)| *told == "true");
    // Without a total, and with one that is not positive, the masses stay.
    from_geometry.or_else(|| positive(tree, "settotalmass")).map(written)
}

/// Why MuJoCo, or Gazebo, may use other numbers than those that a file states for a link, or have several bodies of it.
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
    /// A body of an MJCF file is attached again by `<attach body="arm"/>`, or with the frame around it by `<attach frame="side"/>`,
    /// which names no other file.
    Attached {
        /// The first of them, as it is called in the file.
        body: String,
    },
    /// A URDF file turns an inertia by `quat_xyzw`, over which MuJoCo passes.
    QuaternionOfUrdf,
    /// Bodies of an MJCF file have an `<inertial>` without `pos`, with which MuJoCo loads nothing.
    Unplaced {
        /// The first of them, as it is called in the file.
        body: String,
    },
    /// It gives bodies of an MJCF file other frames, or merges them with their parents.
    Framed {
        /// The attribute.
        told: String,
    },
    /// It computes stiffness or damping from the masses when it loads an MJCF file, for the joints and motors that have an attribute.
    Damped {
        /// The attribute.
        told: String,
    },
    /// The same for the motors of which the attribute gives the bias, where it takes a number of that for a damping ratio.
    Biased {
        /// The attribute.
        told: String,
    },
    /// An MJCF file has `coordinate="global"`. MuJoCo no longer loads such a file, and took places and axes for those of the
    /// world before.
    Global,
    /// The file includes others by `<include>`, whose compiler counts for this one too.
    Included,
    /// Links of an SDF file stand in `<population>`, of whose model Gazebo makes several.
    Populated {
        /// The first of them, as it is called in the file.
        link: String,
    },
    /// The `<inertial>` of links of an SDF file has `<fluid_added_mass>`.
    FluidAdded {
        /// The first of them, as it is called in the file.
        link: String,
    },
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
            Self::Attached { body } => write!(
                f,
                "\"{body}\" is attached once more by <attach>: MuJoCo makes another body of it and of those in it, with the same \
                 numbers"
            ),
            Self::QuaternionOfUrdf => f.write_str(
                "an inertia of the file is turned by quat_xyzw: MuJoCo passes over that and turns nothing, unlike urdfdom and \
                 Pinocchio. With rpy, all of them read the same body",
            ),
            Self::Unplaced { body } => write!(
                f,
                "the <inertial> of \"{body}\" has no pos, which MuJoCo demands: it does not load the file as it is"
            ),
            Self::Framed { told } => write!(
                f,
                "the file has {told}: MuJoCo gives bodies other frames or merges them with their parents. Copies of the file are right, but \
                 numbers in the frames of the file must not be set on its bodies as they are"
            ),
            Self::Damped { told } => write!(
                f,
                "the file has {told}: for each joint or motor that has this, by itself or by a default, MuJoCo computes the damping, or the \
                 stiffness, from the masses {KEPT}"
            ),
            Self::Biased { told } => write!(
                f,
                "the file has {told}: for each motor that has this, by itself or by a default, and of which the second number is the gain with \
                 the opposite sign, MuJoCo takes the third for a damping ratio and computes the damping from the masses {KEPT}"
            ),
            Self::Global => f.write_str(
                "the file has coordinate=\"global\", which MuJoCo no longer loads: its places and axes are read here as those of \
                 the bodies, and were those of the world",
            ),
            Self::Included => f.write_str(
                "the files that this file includes are not read: MuJoCo does not use the masses and inertias as they are \
                 written if a <compiler> in one of them has inertiafromgeom=\"true\" or a positive settotalmass",
            ),
            Self::Populated { link } => write!(
                f,
                "\"{link}\" stands in <population>: Gazebo makes several links of it, which all have the same numbers"
            ),
            Self::FluidAdded { link } => write!(
                f,
                "the <inertial> of \"{link}\" has <fluid_added_mass>, which is not read: Gazebo adds it to the mass and inertia of the \
                 link, and in copies of the file it stays as it is"
            ),
        }
    }
}

/// What becomes of a damping that MuJoCo computes.
const KEPT: &str = "when it loads a file. Each copy has that of its drawn masses, and a model that is drawn after it was loaded keeps that of \
    the file";

/// The doubts about a file of this format.
pub(crate) fn doubts(tree: &Tree<'_>, format: Format) -> Vec<CompilerDoubt> {
    let bounds = ["boundmass", "boundinertia"].into_iter().filter_map(|name| positive(tree, name));
    let raised = bounds.map(|found| CompilerDoubt::Raised { told: written(found) });
    match format {
        Format::Mjcf => {
            // The compiler of a `<model file="">` counts for that model alone.
            let includes = tree.all("include").next().is_some();
            let replicated = first_in(tree.all("replicate"), "body");
            let replicated = replicated.map(|body| CompilerDoubt::Replicated { body });
            let attached = tree.all("attach").filter(|node| node.attribute("model").is_none());
            let attached = attached.filter_map(|node| attached_by(node, tree)).take(1);
            let attached = attached.map(|body| CompilerDoubt::Attached { body });
            let unplaced = tree.all(INERTIAL).filter(|node| {
                node.parent().is_some_and(|body| is_body(body, format))
                    && node.attribute("pos").is_none_or(|pos| pos.trim().is_empty())
            });
            let unplaced = unplaced.take(1).filter_map(Node::parent);
            let unplaced = unplaced.map(|body| CompilerDoubt::Unplaced { body: called(body) });
            let global = said(tree, "coordinate").filter(|(_, told)| *told == "global");
            let framed = framed(tree).map(|told| CompilerDoubt::Framed { told });
            let all = raised.chain(replicated).chain(attached).chain(unplaced).chain(framed);
            let all = all.chain(damped(tree));
            let all = all.chain(global.map(|_| CompilerDoubt::Global));
            all.chain(includes.then_some(CompilerDoubt::Included)).collect()
        }
        Format::Urdf => {
            let of_urdf = overridden(tree).map(|told| CompilerDoubt::OfUrdf { told });
            let mut origins = tree.all(INERTIAL).filter_map(|inertial| inertial.child("origin"));
            let turned = origins.any(is_turned).then_some(CompilerDoubt::QuaternionOfUrdf);
            of_urdf.into_iter().chain(raised).chain(turned).collect()
        }
        Format::Sdf => {
            let populated = first_in(tree.all("population"), "link");
            let populated = populated.map(|link| CompilerDoubt::Populated { link });
            let added = tree.all("fluid_added_mass").filter_map(Node::parent);
            let links = added.filter(|node| node.name() == INERTIAL).filter_map(Node::parent);
            let mut links = links.filter(|link| is_body(*link, format));
            let added = links.next().map(|link| CompilerDoubt::FluidAdded { link: called(link) });
            populated.into_iter().chain(added).collect()
        }
        Format::Csv | Format::Toml | Format::Json => Vec::new(),
    }
}

/// What a link or a body is called in a message.
fn called(body: Node<'_, '_>) -> String {
    shortened(body.attribute("name").unwrap_or("unnamed"))
}

/// What the first element of a name is called that stands in one of some.
fn first_in<'t, 'a: 't>(around: impl Iterator<Item = Node<'t, 'a>>, name: &str) -> Option<String> {
    around.flat_map(Node::descendants).find(|node| node.name() == name).map(called)
}

/// The body that an element attaches again, or the first one in the frame that it attaches: without one, MuJoCo makes none.
fn attached_by(attach: Node<'_, '_>, tree: &Tree<'_>) -> Option<String> {
    let frame = attach.attribute("frame");
    let is_it = |node: &Node<'_, '_>| frame.is_some() && node.attribute("name") == frame;
    let in_frame = || first_in(tree.all("frame").filter(is_it), "body");
    attach.attribute("body").map(shortened).or_else(in_frame)
}

/// Whether a `quat_xyzw` of URDF counts and says more than no rotation.
fn is_turned(origin: Node<'_, '_>) -> bool {
    let numbers = origin.numbers("quat_xyzw", 4).and_then(Result::ok);
    let turns = numbers.is_some_and(|numbers| numbers.iter().take(3).any(|n| n.value != 0.0));
    turns && with_quaternions(origin).is_ok()
}

/// What gives bodies other frames: free joints that are aligned, each by itself or all of them, and static bodies that are
/// merged with their parents.
fn framed(tree: &Tree<'_>) -> Option<String> {
    let joints = tree
        .all("joint")
        .filter(|node| node.attribute("type").is_some_and(|kind| kind.trim() == "free"));
    let free = tree.all("freejoint").chain(joints);
    let aligns: Vec<_> = free.map(|node| node.attribute("align").map(str::trim)).collect();
    if aligns.contains(&Some("true")) {
        return Some(written(("align", "true")));
    }
    let is_true = |told: &Said<'_>| told.1 == "true";
    let aligned = said(tree, "alignfree").filter(is_true);
    let aligned = aligned.filter(|_| aligns.iter().any(|align| *align != Some("false")));
    aligned.or_else(|| said(tree, "fusestatic").filter(is_true)).map(written)
}

/// Of each attribute that makes stiffness or damping depend on masses the first that does, of a motor, of a joint or of their defaults.
///
/// What a motor takes from its defaults is not followed: another element may give the gain.
fn damped(tree: &Tree<'_>) -> impl Iterator<Item = CompilerDoubt> {
    let numbers = |told: &str| -> Vec<f64> {
        // What is no number is refused by MuJoCo.
        told.split_whitespace().map(|number| number.parse().unwrap_or_default()).collect()
    };
    let any_positive = move |told: &str| numbers(told).into_iter().any(|number| number > 0.0);
    let is_ratio = move |node: Node<'_, '_>, told: &str| {
        let [_, second, third, ..] = numbers(told)[..] else { return false };
        let gain = node.attribute("gainprm").and_then(|told| numbers(told).first().copied());
        // In a default, a motor may have another gain and another second number.
        let in_default = node.ancestors().any(|around| around.name() == "default");
        let may_be_gain = second != 0.0 && gain.is_none_or(|gain| gain + second == 0.0);
        third > 0.0 && (in_default || may_be_gain)
    };
    let first = |name: &'static str, counts: &dyn Fn(Node<'_, '_>, &str) -> bool| {
        let mut all = tree.nodes().filter_map(|node| Some((node, node.attribute(name)?)));
        let (_, told) = all.find(|(node, told)| counts(*node, told))?;
        Some(written((name, told.trim())))
    };
    let damped = ["dampratio", "springdamper"].map(|name| {
        Some(CompilerDoubt::Damped { told: first(name, &|_, told| any_positive(told))? })
    });
    // A `<cylinder>` has its bias in an attribute of its own.
    let biased = ["biasprm", "bias"]
        .map(|name| Some(CompilerDoubt::Biased { told: first(name, &is_ratio)? }));
    damped.into_iter().chain(biased).flatten()
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
