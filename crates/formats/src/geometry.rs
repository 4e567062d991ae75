//! The geometry of a link, of its collisions or else of its visuals, as points of which it is the convex hull.

use nalgebra::{UnitQuaternion, Vector3};
use std::path::Path;

use crate::{
    FileBodyError, Format, LinkProblem,
    body::shortened,
    frame::{self, Frame},
    mesh_file::{self, MeshFileError},
    orientation::Angles,
    xml::Node,
};

/// Points around a sphere or a cylinder.
const AROUND: usize = 24;
/// Rings of points between the poles of a sphere.
const RINGS: usize = 11;

/// A solid in the frame of a link.
#[derive(Clone, Debug)]
pub(crate) struct Solid {
    centre: Vector3<f64>,
    rotation: UnitQuaternion<f64>,
    shape: Shape,
}

impl Solid {
    /// A shape about its middle, turned in the frame of the link.
    pub(crate) fn new(centre: Vector3<f64>, rotation: UnitQuaternion<f64>, shape: Shape) -> Self {
        Self { centre, rotation, shape }
    }
}

/// A shape in its own frame.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// By its sides, m.
    Box([f64; 3]),
    /// By its semi-axes, m.
    Ellipsoid([f64; 3]),
    /// Radius and length along the third axis, m, and whether the ends are half spheres.
    Cylinder {
        radius: f64,
        length: f64,
        is_round: bool,
    },
    Mesh {
        path: String,
        scale: [f64; 3],
    },
    Points {
        points: Vec<[f64; 3]>,
        scale: [f64; 3],
    },
}

/// The solids of the link around an inertia in URDF and SDF; those of MJCF are `mjcf_geoms`.
pub(crate) fn of(
    inertial: Node<'_, '_>,
    format: Format,
    angles: &Angles,
) -> Result<Vec<Solid>, GeometryProblem> {
    let Some(link) = inertial.parent() else { return Err(GeometryProblem::Nothing) };
    let solids = |name: &'static str| -> Result<Vec<Solid>, GeometryProblem> {
        link.children()
            .filter(|child| child.name() == name)
            .map(|child| solid(child, format, angles))
            .collect()
    };
    for name in ["collision", "visual"] {
        let found = solids(name)?;
        if !found.is_empty() {
            return Ok(found);
        }
    }
    Err(GeometryProblem::Nothing)
}

fn solid(around: Node<'_, '_>, format: Format, angles: &Angles) -> Result<Solid, GeometryProblem> {
    let Frame { centre, rotation, .. } = frame::of(around, format, angles)?;
    let geometry = around.only_child("geometry").map_err(LinkProblem::from)?;
    let mut shapes = geometry.into_iter().flat_map(Node::children);
    let empty = || GeometryProblem::Empty { element: around.name().to_owned() };
    let shape = shapes.next().ok_or_else(empty)?;
    if let Some(second) = shapes.next() {
        let [first, second] = [shape, second].map(|shape| shortened(kind(shape)));
        return Err(GeometryProblem::Several { first, second });
    }
    // Attributes in URDF, elements in SDF.
    let list = |name: &'static str, allowed: usize| -> Result<Vec<f64>, GeometryProblem> {
        let element = shape.only_child(name).map_err(LinkProblem::from)?;
        let numbers = match (shape.numbers(name, allowed), element) {
            (Some(numbers), _) => numbers,
            (None, Some(element)) => element.numbers_inside(name, allowed),
            (None, None) => Err(FileBodyError::Missing { field: name }),
        };
        let numbers: Vec<f64> =
            numbers.map_err(LinkProblem::from)?.iter().map(|number| number.value).collect();
        match numbers.iter().find(|x| !(**x > 0.0)) {
            Some(value) if name != "scale" => {
                Err(GeometryProblem::Size { field: name, value: *value })
            }
            Some(_) | None => Ok(numbers),
        }
    };
    let one = |name| Ok::<f64, GeometryProblem>(list(name, 1)?[0]);
    let three = |name| list(name, 3).map(|x| [x[0], x[1], x[2]]);
    let shape = match kind(shape) {
        "box" => Shape::Box(three("size")?),
        "sphere" => Shape::Ellipsoid([one("radius")?; 3]),
        "ellipsoid" => Shape::Ellipsoid(three("radii")?),
        name @ ("cylinder" | "capsule") => Shape::Cylinder {
            radius: one("radius")?,
            length: one("length")?,
            is_round: name == "capsule",
        },
        "mesh" => {
            let uri = shape.child("uri").map(Node::text);
            let path = shape.attribute("filename").or(uri).unwrap_or_default().trim().to_owned();
            if shape.child("submesh").is_some() {
                return Err(GeometryProblem::MeshField { mesh: path, field: "a <submesh>" });
            }
            let is_scaled = shape.attribute("scale").is_some() || shape.child("scale").is_some();
            Shape::Mesh { path, scale: if is_scaled { three("scale")? } else { [1.0; 3] } }
        }
        other => return Err(GeometryProblem::Shape { shape: shortened(other) }),
    };
    Ok(Solid::new(centre, rotation, shape))
}

/// The name of a shape. Those that are Drake's own have a prefix.
fn kind<'a>(shape: Node<'_, 'a>) -> &'a str {
    if shape.is_macro() { shape.name() } else { shape.local_name() }
}

/// Points of solids, in the frame of the link. Of a sphere or a cylinder they lie on it, so that their hull is in it.
pub(crate) fn points(solids: &[Solid], robot: &Path) -> Result<Vec<[f64; 3]>, GeometryProblem> {
    let mut all = Vec::new();
    for solid in solids {
        let own: Vec<Vector3<f64>> = match &solid.shape {
            Shape::Box(sides) => (0..8)
                .map(|corner| {
                    Vector3::from_fn(|i, _| {
                        sides[i] * if corner >> i & 1 == 1 { 0.5 } else { -0.5 }
                    })
                })
                .collect(),
            Shape::Ellipsoid(radii) => {
                ball().map(|x| x.component_mul(&Vector3::from(*radii))).collect()
            }
            Shape::Cylinder { radius, length, is_round: false } => around()
                .flat_map(|(x, y)| {
                    [-0.5, 0.5].map(|z| Vector3::new(radius * x, radius * y, z * length))
                })
                .collect(),
            Shape::Cylinder { radius, length, is_round: true } => ball()
                .map(|x| {
                    x * *radius + Vector3::z() * (0.5 * length * if x.z < 0.0 { -1.0 } else { 1.0 })
                })
                .collect(),
            Shape::Mesh { path, scale } => scaled(&mesh_file::vertices(path, robot)?, scale),
            Shape::Points { points, scale } => scaled(points, scale),
        };
        all.extend(own.iter().map(|x| <[f64; 3]>::from(solid.rotation * x + solid.centre)));
    }
    Ok(all)
}

fn scaled(points: &[[f64; 3]], scale: &[f64; 3]) -> Vec<Vector3<f64>> {
    points.iter().map(|x| Vector3::from(*x).component_mul(&Vector3::from(*scale))).collect()
}

fn around() -> impl Iterator<Item = (f64, f64)> {
    (0..AROUND).map(|i| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * i as f64 / AROUND as f64);
        (cos, sin)
    })
}

/// Points of the unit sphere.
fn ball() -> impl Iterator<Item = Vector3<f64>> {
    let rings = (1..=RINGS).flat_map(|ring| {
        let (sin, cos) = libm::sincos(std::f64::consts::PI * ring as f64 / (RINGS + 1) as f64);
        around().map(move |(x, y)| Vector3::new(sin * x, sin * y, cos))
    });
    [Vector3::z(), -Vector3::z()].into_iter().chain(rings)
}

/// Why the geometry of a link cannot be told.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryProblem {
    /// There is none.
    #[error("it has neither collision nor visual geometry")]
    Nothing,
    /// A collision or a visual without a shape.
    #[error("its <{element}> holds no shape")]
    Empty {
        /// The element.
        element: String,
    },
    /// More than one shape where the format has one.
    #[error("its <geometry> holds a <{first}> and a <{second}>: there must be one shape in it")]
    Several {
        /// The first shape.
        first: String,
        /// The second.
        second: String,
    },
    /// A body of MJCF without geoms of its own.
    #[error("it has no geom")]
    NoGeoms,
    /// A part of the file is elsewhere.
    #[error("its geoms may take what they do not say from other files, which are not followed")]
    Included,
    /// A class that is none.
    #[error("its geometry: there is no default class \"{class}\" in the file")]
    Class {
        /// The class.
        class: String,
    },
    /// Geoms in frames of their own.
    #[error("its geoms in a <{element}> are not read")]
    Around {
        /// The element.
        element: String,
    },
    /// A shape that MuJoCo fits to a mesh.
    #[error("its geom of type {kind} is fitted to a mesh, which is not done here")]
    Fitted {
        /// The type.
        kind: String,
    },
    /// A mesh that is not among the assets.
    #[error("its geometry: there is no mesh \"{mesh}\" among the assets of the file")]
    NoMesh {
        /// Its name.
        mesh: String,
    },
    /// A mesh that is not where its file has it.
    #[error("its mesh \"{mesh}\" has {field}, which is not read")]
    MeshField {
        /// The mesh.
        mesh: String,
        /// The attribute.
        field: &'static str,
    },
    /// Its frame or a number cannot be read.
    #[error("its geometry: {0}")]
    Link(LinkProblem),
    /// A size that is none.
    #[error("its geometry: {field} = {value}: it must be positive")]
    Size {
        /// The field.
        field: &'static str,
        /// The value, m.
        value: f64,
    },
    /// A shape that is not read.
    #[error(
        "its geometry <{shape}> is not read: box, sphere, cylinder, capsule, ellipsoid and mesh are"
    )]
    Shape {
        /// The element.
        shape: String,
    },
    /// A mesh that is not read.
    #[error(transparent)]
    Mesh(#[from] MeshFileError),
}

impl From<LinkProblem> for GeometryProblem {
    fn from(error: LinkProblem) -> Self {
        Self::Link(error)
    }
}
