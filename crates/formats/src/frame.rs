//! The frame of an inertia in that of its link, and where its numbers stand or can be written.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use crate::{
    FileBodyError, Format, LinkProblem,
    body::{NAMES, Number, Place, shortened},
    holder::frames,
    orientation::{ATTRIBUTES, Angles, of_mjcf, of_quaternion, of_roll_pitch_yaw},
    sdf_words::{has_attributes, truth},
    xml::{Node, Tree},
};

/// The frame of an inertia: its origin is the mass centre.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    /// m, in the frame of the link.
    pub(crate) centre: Vector3<f64>,
    /// Takes components in this frame to those in the link's.
    pub(crate) rotation: UnitQuaternion<f64>,
    /// The frames of MJCF in which the numbers stand, in that of the body, if there are any.
    pub(crate) around: Option<Isometry3<f64>>,
    pub(crate) centre_spot: Spot,
    pub(crate) mass_spot: Spot,
    /// Where entries go that the file leaves to their defaults.
    pub(crate) entry_spots: Vec<Spot>,
    /// Where an inertia goes of which the file leaves all to the defaults.
    pub(crate) inertia_spot: Option<InertiaSpot>,
    /// Where elements end by `/>` in which something may have to be written, and their end tags.
    pub(crate) closed: Vec<(usize, String)>,
    /// Of MJCF with `diaginertia`.
    pub(crate) diagonal: Option<Diagonal>,
}

impl Frame {
    /// A mass centre in the frame of the link, as the file writes it.
    pub(crate) fn written_centre(&self, centre: Vector3<f64>) -> Vector3<f64> {
        self.around.map_or(centre, |around| around.inverse_transform_point(&centre.into()).coords)
    }

    /// Axes in those of the link, as the file writes them.
    pub(crate) fn written_axes(&self, axes: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        self.around.map_or(axes, |around| around.rotation.inverse() * axes)
    }
}

/// Where a principal inertia of MJCF says its axes, and where more than that can be written.
#[derive(Clone, Debug)]
pub(crate) struct Diagonal {
    /// The attribute `diaginertia`.
    pub(crate) moments: Place,
    /// The attribute that says the orientation, if one does.
    pub(crate) orientation: Option<Place>,
    /// The four numbers of `quat`.
    pub(crate) quaternion: Option<Vec<Place>>,
}

/// Where the element `<inertia>` goes, and how it is written.
#[derive(Clone, Debug)]
pub(crate) struct InertiaSpot {
    pub(crate) at: usize,
    /// With the colon, if there is one.
    pub(crate) prefix: String,
    /// Entries are attributes, as in SDFormat 1.0.
    pub(crate) in_attributes: bool,
}

/// Where numbers stand, or go if the file leaves them to their defaults.
#[derive(Clone, Debug)]
pub(crate) enum Spot {
    /// Numbers of the file.
    Numbers(Vec<Place>),
    /// Nothing of them is there: this goes before and after them.
    Missing { at: usize, before: String, after: String },
    /// There is no plain way: they are written with entities, say.
    Nowhere,
}

impl Spot {
    fn of(numbers: &[Number]) -> Self {
        let places: Option<Vec<Place>> = numbers.iter().map(|number| number.place).collect();
        places.map_or(Self::Nowhere, Self::Numbers)
    }

    fn missing(at: usize, before: String, after: &str) -> Self {
        Self::Missing { at, before, after: after.to_owned() }
    }

    /// A child more of an element.
    fn child(node: Node<'_, '_>, open: &str, name: &str, close: &str) -> Self {
        let prefix = prefix(node);
        let after = close.replace(name, &format!("{prefix}{name}"));
        let before = format!("<{prefix}{open}");
        node.inside().map_or(Self::Nowhere, |at| Self::missing(at, before, &after))
    }
}

/// The prefix of an element with its colon, if it has one.
fn prefix(node: Node<'_, '_>) -> String {
    let prefix = node.prefix();
    if prefix.is_empty() { String::new() } else { format!("{prefix}:") }
}

/// How the angles of an MJCF file are meant.
pub(crate) fn angles(tree: &Tree<'_>) -> Angles {
    let unit = compiled(tree, "angle").and_then(|said| match said {
        Some("radian") => Ok(1.0),
        Some("degree") | None => Ok(1_f64.to_radians()),
        Some(word) => Err(LinkProblem::AngleUnit { word: shortened(word) }),
    });
    let sequence = compiled(tree, "eulerseq").map(|said| said.unwrap_or("xyz").to_owned());
    Angles { unit, sequence }
}

/// What the compiler is told by an attribute, if anything. Of several it believes the last, and a file that is included may have one
/// that counts from there on; what is included itself has its compiler elsewhere.
fn compiled<'t>(tree: &'t Tree<'_>, name: &str) -> Result<Option<&'t str>, LinkProblem> {
    let root = tree.root();
    let mut said = if root.name() == "mujoco" { Ok(None) } else { Err(LinkProblem::Angles) };
    for node in root.children() {
        if node.name() == "include" {
            said = Err(LinkProblem::Angles);
        } else if node.name() == "compiler"
            && let Some(told) = node.attribute(name)
        {
            said = Ok(Some(told));
        }
    }
    said
}

/// The frame of an inertia in a file of this format.
pub(crate) fn of(
    node: Node<'_, '_>,
    format: Format,
    angles: &Angles,
) -> Result<Frame, LinkProblem> {
    match format {
        Format::Mjcf => mjcf(node, angles),
        Format::Sdf => sdf(node),
        Format::Urdf | Format::Csv | Format::Toml | Format::Json => urdf(node),
    }
}

/// Three numbers that are there, by value.
fn three(numbers: &[Number]) -> Vector3<f64> {
    Vector3::from_fn(|i, _| numbers.get(i).map_or(0.0, |number| number.value))
}

/// That a URDF file is of version 1.1 or later, which its root says and is 1.0 otherwise: before, readers pass over quaternions.
pub(crate) fn with_quaternions(node: Node<'_, '_>) -> Result<(), LinkProblem> {
    let root = node.ancestors().last();
    let said = root.and_then(|root| root.attribute("version")).unwrap_or("1.0");
    let version = said.split_once('.').and_then(|(major, minor)| {
        Some((major.trim().parse::<u32>().ok()?, minor.trim().parse::<u32>().ok()?))
    });
    if version.is_some_and(|version| version >= (1, 1)) {
        Ok(())
    } else {
        Err(LinkProblem::QuaternionVersion { version: shortened(said) })
    }
}

/// That no macro may give what says a frame: the element that does, if there is one, or another child in its place.
fn without_macros(node: Node<'_, '_>, said: Option<Node<'_, '_>>) -> Result<(), LinkProblem> {
    let is_open = said.unwrap_or(node).descendants().any(Node::is_macro);
    if is_open { Err(LinkProblem::Macro) } else { Ok(()) }
}

fn urdf(node: Node<'_, '_>) -> Result<Frame, LinkProblem> {
    let origin = node.only_child("origin")?;
    without_macros(node, origin)?;
    let numbers = |name| origin.and_then(|origin| origin.numbers(name, 3)).transpose();
    let (xyz, rpy) = (numbers("xyz")?, numbers("rpy")?);
    let quaternion = origin.and_then(|origin| origin.numbers("quat_xyzw", 4)).transpose()?;
    if quaternion.is_some() {
        with_quaternions(node)?;
    }
    let rotation = match (rpy, quaternion) {
        (Some(_), Some(_)) => {
            return Err(FileBodyError::Both { first: "rpy", second: "quat_xyzw" }.into());
        }
        (rpy, None) => of_roll_pitch_yaw(three(&rpy.unwrap_or_default()).into()),
        (None, Some(numbers)) => {
            let [x, y, z, w] = std::array::from_fn(|i| numbers.get(i).map_or(0.0, |n| n.value));
            let field = "quat_xyzw";
            of_quaternion([w, x, y, z]).ok_or(LinkProblem::Orientation { field })?
        }
    };
    let centre_spot = match (&xyz, origin) {
        (Some(xyz), _) => Spot::of(xyz),
        (None, Some(origin)) => Spot::missing(origin.after_name(), " xyz=\"".to_owned(), "\""),
        (None, None) => Spot::child(node, "origin xyz=\"", "origin", "\"/>"),
    };
    Ok(Frame {
        centre: xyz.map_or_else(Vector3::zeros, |xyz| three(&xyz)),
        rotation,
        around: None,
        centre_spot,
        mass_spot: Spot::Nowhere,
        entry_spots: Vec::new(),
        inertia_spot: None,
        closed: Vec::new(),
        diagonal: None,
    })
}

/// Where the element is in the frames around it, and these in the body.
fn around(node: Node<'_, '_>, angles: &Angles) -> Result<Option<Isometry3<f64>>, LinkProblem> {
    let pose = |frame: Node<'_, '_>| {
        let position = three(&frame.numbers("pos", 3).transpose()?.unwrap_or_default());
        Ok(Isometry3::from_parts(Translation3::from(position), of_mjcf(frame, angles)?))
    };
    // From the inside.
    let poses: Vec<_> = frames(node).map(pose).collect::<Result<_, LinkProblem>>()?;
    Ok(poses.into_iter().reduce(|inner, outer| outer * inner))
}

fn mjcf(node: Node<'_, '_>, angles: &Angles) -> Result<Frame, LinkProblem> {
    // It is said by attributes, which a macro in it may give.
    without_macros(node, None)?;
    let around = around(node, angles)?;
    let position = node.numbers("pos", 3).transpose()?;
    let centre_spot = match &position {
        Some(numbers) => Spot::of(numbers),
        None => Spot::missing(node.after_name(), " pos=\"".to_owned(), "\""),
    };
    let rotation = of_mjcf(node, angles)?;
    let orientation = ATTRIBUTES.into_iter().find(|name| node.attribute(name).is_some());
    if let Some(second) = orientation.filter(|_| node.attribute("fullinertia").is_some()) {
        return Err(FileBodyError::Both { first: "fullinertia", second }.into());
    }
    let quaternion = node.numbers("quat", 4).transpose()?.map(|numbers| Spot::of(&numbers));
    let diagonal = node.whole("diaginertia").map(|moments| Diagonal {
        moments,
        orientation: orientation.and_then(|name| node.whole(name)),
        quaternion: match quaternion {
            Some(Spot::Numbers(places)) => Some(places),
            Some(Spot::Missing { .. } | Spot::Nowhere) | None => None,
        },
    });
    let centre = position.map_or_else(Vector3::zeros, |numbers| three(&numbers));
    Ok(Frame {
        centre: around.map_or(centre, |around| (around * Point3::from(centre)).coords),
        rotation: around.map_or(rotation, |around| around.rotation * rotation),
        around,
        centre_spot,
        mass_spot: Spot::Nowhere,
        entry_spots: Vec::new(),
        inertia_spot: None,
        closed: Vec::new(),
        diagonal,
    })
}

fn sdf(node: Node<'_, '_>) -> Result<Frame, LinkProblem> {
    let pose = node.only_child("pose")?;
    if let Some(pose) = pose {
        // The link's own frame may be named, too.
        let own = node.parent().and_then(|link| link.attribute("name")).unwrap_or_default();
        let is_other = |frame: &&str| !frame.trim().is_empty() && frame.trim() != own.trim();
        for name in ["relative_to", "frame"] {
            if let Some(frame) = pose.attribute(name).filter(is_other) {
                return Err(LinkProblem::RelativeTo { frame: frame.to_owned() });
            }
        }
    }
    let origin = node.only_child("origin")?;
    without_macros(node, pose.or(origin))?;
    let origin = origin.and_then(|origin| origin.numbers("pose", 6)).transpose()?;
    if origin.is_some() && !has_attributes(node) {
        return Err(FileBodyError::Attribute { field: "pose of origin" }.into());
    }
    let is_quaternion = match pose.and_then(|pose| pose.attribute("rotation_format")) {
        None | Some("euler_rpy") => false,
        Some("quat_xyzw") => true,
        Some(word) => {
            let (field, allowed) = ("rotation_format", "euler_rpy or quat_xyzw");
            return Err(LinkProblem::Word { field, value: shortened(word), allowed });
        }
    };
    let numbers = match pose {
        // An empty one is that of the link.
        Some(pose) if !pose.has_text() => None,
        Some(pose) => Some(pose.numbers_inside("pose", if is_quaternion { 7 } else { 6 })?),
        None => origin,
    };
    let values: Vec<f64> = numbers.iter().flatten().map(|number| number.value).collect();
    let in_degrees = match pose.and_then(|pose| pose.attribute("degrees")) {
        None => false,
        Some(word) => truth(word).ok_or_else(|| {
            let (field, allowed) = ("degrees", "true or false");
            LinkProblem::Word { field, value: shortened(word), allowed }
        })?,
    };
    if in_degrees && is_quaternion {
        let (first, second) = ("degrees=\"true\"", "rotation_format=\"quat_xyzw\"");
        return Err(FileBodyError::Both { first, second }.into());
    }
    let rotation = match values[..] {
        [_, _, _, roll, pitch, yaw] => {
            let unit = if in_degrees { 1_f64.to_radians() } else { 1.0 };
            of_roll_pitch_yaw([roll, pitch, yaw].map(|angle| angle * unit))
        }
        [_, _, _, x, y, z, w] => {
            of_quaternion([w, x, y, z]).ok_or(LinkProblem::Orientation { field: "pose" })?
        }
        _ => UnitQuaternion::identity(),
    };
    let centre_spot = match (&numbers, pose) {
        (Some(numbers), _) => Spot::of(&numbers[..3]),
        (None, Some(pose)) => {
            let rest = if is_quaternion { " 0 0 0 1" } else { " 0 0 0" };
            pose.inside().map_or(Spot::Nowhere, |at| Spot::missing(at, String::new(), rest))
        }
        (None, None) => Spot::child(node, "pose>", "pose", " 0 0 0</pose>"),
    };
    let inertia = node.child("inertia");
    let inertia_spot = match inertia {
        Some(_) => None,
        None => node.inside().map(|at| {
            let in_attributes = node.attribute("mass").is_some();
            InertiaSpot { at, prefix: prefix(node), in_attributes }
        }),
    };
    let entry = |name: &str| {
        inertia.map_or(Spot::Nowhere, |inertia| match inertia.attribute_names().next() {
            Some(_) => Spot::missing(inertia.after_name(), format!(" {name}=\""), "\""),
            None => Spot::child(inertia, &format!("{name}>"), name, &format!("</{name}>")),
        })
    };
    Ok(Frame {
        centre: numbers.map_or_else(Vector3::zeros, |numbers| three(&numbers)),
        rotation,
        around: None,
        centre_spot,
        mass_spot: Spot::child(node, "mass>", "mass", "</mass>"),
        entry_spots: NAMES.iter().map(|name| entry(name)).collect(),
        inertia_spot,
        closed: [Some(node), pose, inertia]
            .into_iter()
            .flatten()
            .filter_map(Node::closed)
            .collect(),
        diagonal: None,
    })
}

/// What an inertia of SDF leaves to the defaults of the format, but for products.
pub(crate) fn defaults(node: Node<'_, '_>) -> Vec<&'static str> {
    let says = |node: Node<'_, '_>, name: &str| {
        node.child(name).is_some() || node.attribute(name).is_some()
    };
    let mut left = Vec::new();
    if !says(node, "mass") {
        left.push("mass");
    }
    match node.child("inertia") {
        None => left.push("inertia"),
        Some(inertia) => left.extend(NAMES[..3].iter().filter(|name| !says(inertia, name))),
    }
    left
}
