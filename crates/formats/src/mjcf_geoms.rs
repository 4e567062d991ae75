//! The geoms of the bodies of an MJCF file, with what they take from default classes.

use nalgebra::{UnitQuaternion, Vector3};
use std::collections::HashMap;

use crate::{
    FileBodyError, Format, LinkProblem,
    body::{Number, shortened},
    geometry::{GeometryProblem, Shape, Solid},
    holder::holder,
    orientation::{ATTRIBUTES, Angles, from_third_axis, of_mjcf},
    references::in_folder,
    xml::{Node, Tree},
};

/// The class of what names none.
const MAIN: &str = "main";

/// What the geoms of a file take from elsewhere in it.
pub(crate) struct Geoms<'t, 'a> {
    angles: &'t Angles,
    /// The elements `default` of each class, the class itself first and those around it after it.
    classes: HashMap<&'t str, Vec<Node<'t, 'a>>>,
    /// The meshes among the assets, by name.
    meshes: HashMap<&'t str, Node<'t, 'a>>,
    /// Where their files are, and whether only the last part of their paths counts.
    folder: Option<&'t str>,
    strips: bool,
    /// Whether nothing of it is in another file.
    is_whole: bool,
}

impl<'t, 'a> Geoms<'t, 'a> {
    pub(crate) fn new(tree: &'t Tree<'a>, angles: &'t Angles) -> Self {
        let mut classes: HashMap<&str, Vec<Node<'_, '_>>> = HashMap::new();
        for node in tree.all("default") {
            let around: Vec<_> = node.ancestors().take_while(|n| n.name() == "default").collect();
            // Sections of the file may stand more than once, and count as one.
            let outermost = around.len() == 1;
            let class = if outermost { MAIN } else { node.attribute("class").unwrap_or_default() };
            let known = classes.entry(class).or_default();
            known.extend(around.into_iter().take(if outermost { 1 } else { usize::MAX }));
            if outermost && let Some(named) = node.attribute("class") {
                classes.entry(named).or_default().push(node);
            }
        }
        let is_whole = tree.root().name() == "mujoco" && tree.all("include").next().is_none();
        let mut meshes = HashMap::new();
        let assets = tree.all("mesh").filter(|n| n.parent().is_some_and(|p| p.name() == "asset"));
        for mesh in assets {
            let stem = || mesh.attribute("file").map(|file| stem(file.trim()));
            if let Some(name) = mesh.attribute("name").or_else(stem) {
                meshes.entry(name).or_insert(mesh);
            }
        }
        let said = |name| tree.said("compiler", name);
        let strips = said("strippath").is_some_and(|word| word.trim() == "true");
        let folder = said("meshdir").or(said("assetdir"));
        Self { angles, classes, meshes, folder, strips, is_whole }
    }

    /// The solids of the body around an inertia: of the geoms that can collide, or of all if none can.
    pub(crate) fn of(&self, inertial: Node<'t, 'a>) -> Result<Vec<Solid>, GeometryProblem> {
        let Some(body) = holder(inertial, Format::Mjcf) else {
            return Err(GeometryProblem::Nothing);
        };
        if !self.is_whole {
            return Err(GeometryProblem::Included);
        }
        let holds_geoms = |node: Node<'_, '_>| {
            matches!(node.name(), "frame" | "replicate")
                && node.children().any(|child| child.name() != "body")
        };
        if let Some(around) = body.children().find(|child| holds_geoms(*child)) {
            return Err(GeometryProblem::Around { element: shortened(around.name()) });
        }
        let geoms: Vec<_> = body.children().filter(|child| child.name() == "geom").collect();
        let mut colliding = Vec::new();
        for geom in &geoms {
            if self.can_collide(*geom)? {
                colliding.push(*geom);
            }
        }
        let taken = if colliding.is_empty() { geoms } else { colliding };
        if taken.is_empty() {
            return Err(GeometryProblem::NoGeoms);
        }
        taken.into_iter().map(|geom| self.solid(geom)).collect()
    }

    /// An element and what it takes its defaults from, in the order in which they hold.
    fn chain(&self, node: Node<'t, 'a>) -> Result<Vec<Node<'t, 'a>>, GeometryProblem> {
        let of_bodies = || node.ancestors().skip(1).find_map(|above| above.attribute("childclass"));
        let class = node.attribute("class").or_else(of_bodies);
        let defaults = match (class, self.classes.get(class.unwrap_or(MAIN))) {
            (_, Some(defaults)) => defaults.as_slice(),
            (None, None) => &[],
            (Some(class), None) => {
                return Err(GeometryProblem::Class { class: shortened(class) });
            }
        };
        // The outermost class may have several elements.
        let main = self.classes.get(MAIN).map_or(&[][..], Vec::as_slice);
        let main = main.iter().filter(|one| !defaults.contains(one));
        let all = defaults.iter().chain(main);
        let of_name =
            |default: &Node<'t, 'a>| default.children().find(|child| child.name() == node.name());
        Ok([node].into_iter().chain(all.filter_map(of_name)).collect())
    }

    fn can_collide(&self, geom: Node<'t, 'a>) -> Result<bool, GeometryProblem> {
        let chain = self.chain(geom)?;
        let is_zero = |name: &str| {
            chain.iter().find_map(|node| node.attribute(name)).is_some_and(|x| x.trim() == "0")
        };
        Ok(!(is_zero("contype") && is_zero("conaffinity")))
    }

    fn solid(&self, geom: Node<'t, 'a>) -> Result<Solid, GeometryProblem> {
        let chain = self.chain(geom)?;
        let attribute = |name: &str| chain.iter().find_map(|node| node.attribute(name));
        let size = sizes(&chain)?;
        let with = |name| chain.iter().find(|node| node.attribute(name).is_some());
        let three = |name: &'static str| -> Result<Option<Vector3<f64>>, GeometryProblem> {
            let Some(node) = with(name) else { return Ok(None) };
            let numbers = numbers(*node, name, 3..=3)?;
            Ok(Some(Vector3::from_column_slice(&numbers)))
        };
        let kind = attribute("type").unwrap_or("sphere").trim();
        let mesh = attribute("mesh");
        if kind != "mesh" && mesh.is_some() {
            return Err(GeometryProblem::Fitted { kind: shortened(kind) });
        }
        let mut centre = three("pos")?.unwrap_or_default();
        let turned = chain.iter().find(|n| ATTRIBUTES.iter().any(|a| n.attribute(a).is_some()));
        let mut rotation = match turned {
            Some(node) => of_mjcf(*node, self.angles)?,
            None => UnitQuaternion::identity(),
        };
        let ends = match with("fromto") {
            Some(node) => Some(numbers(*node, "fromto", 6..=6)?),
            None => None,
        };
        let mut half = match kind {
            "capsule" | "cylinder" => [size[0], size[0], size[1]],
            "sphere" => [size[0]; 3],
            _ => size,
        };
        if let Some(ends) = ends.filter(|_| LONG.contains(&kind)) {
            let [from, to] = [&ends[..3], &ends[3..]].map(Vector3::from_column_slice);
            // The third axis points from the second end to the first, as MuJoCo has it: of a box, that tells how it is rolled.
            let along = from - to;
            centre = (from + to) * 0.5;
            rotation =
                from_third_axis(along).ok_or(LinkProblem::Orientation { field: "fromto" })?;
            half = [size[0], size[0], 0.5 * along.norm()];
        }
        let shape = match kind {
            "sphere" | "ellipsoid" => Shape::Ellipsoid(positive(half)?),
            "box" => Shape::Box(positive(half)?.map(|x| 2.0 * x)),
            "capsule" | "cylinder" => {
                let [radius, _, z] = positive(half)?;
                Shape::Cylinder { radius, length: 2.0 * z, is_round: kind == "capsule" }
            }
            "mesh" => self.mesh(mesh.unwrap_or_default())?,
            other => return Err(GeometryProblem::Shape { shape: shortened(other) }),
        };
        Ok(Solid::new(centre, rotation, shape))
    }

    /// The mesh of a name: that of the element, or of its file without the extension.
    fn mesh(&self, name: &str) -> Result<Shape, GeometryProblem> {
        let found = self.meshes.get(name);
        let mesh = *found.ok_or_else(|| GeometryProblem::NoMesh { mesh: shortened(name) })?;
        let chain = self.chain(mesh)?;
        let attribute = |name: &str| chain.iter().find_map(|node| node.attribute(name));
        for field in ["refpos", "refquat", "builtin"] {
            if attribute(field).is_some() {
                return Err(GeometryProblem::MeshField { mesh: shortened(name), field });
            }
        }
        let scale = match chain.iter().find(|node| node.attribute("scale").is_some()) {
            Some(node) => numbers(*node, "scale", 3..=3)?,
            None => vec![1.0; 3],
        };
        let scale = [scale[0], scale[1], scale[2]];
        let Some(file) = attribute("file").map(str::trim) else {
            let all = numbers(mesh, "vertex", 3..=usize::MAX)?;
            return Ok(Shape::Points {
                points: all.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect(),
                scale,
            });
        };
        let file = if self.strips { last_part(file) } else { file };
        let folder = self.folder.filter(|_| !file.starts_with('/'));
        Ok(Shape::Mesh { path: in_folder(folder, file), scale })
    }
}

/// What may say its length by its two ends.
const LONG: [&str; 4] = ["capsule", "cylinder", "box", "ellipsoid"];

/// The three sizes, of which an element may say the first alone.
fn sizes(chain: &[Node<'_, '_>]) -> Result<[f64; 3], GeometryProblem> {
    let mut size = [0.0; 3];
    for node in chain.iter().rev().filter(|node| node.attribute("size").is_some()) {
        let said = numbers(*node, "size", 1..=3)?;
        size.iter_mut().zip(said).for_each(|(size, said)| *size = said);
    }
    Ok(size)
}

fn positive(half: [f64; 3]) -> Result<[f64; 3], GeometryProblem> {
    match half.into_iter().find(|x| !(*x > 0.0)) {
        Some(value) => Err(GeometryProblem::Size { field: "size", value }),
        None => Ok(half),
    }
}

/// The numbers in an attribute, as many as may be.
fn numbers(
    node: Node<'_, '_>,
    name: &'static str,
    allowed: std::ops::RangeInclusive<usize>,
) -> Result<Vec<f64>, GeometryProblem> {
    let text = node.attribute(name).unwrap_or_default();
    let all: Result<Vec<f64>, FileBodyError> = text
        .split_ascii_whitespace()
        .map(|word| Ok(Number::parse(name, word, None)?.value))
        .collect();
    let all = all.map_err(LinkProblem::from)?;
    if allowed.contains(&all.len()) {
        return Ok(all);
    }
    let (found, allowed) = (all.len(), *allowed.start());
    Err(LinkProblem::from(FileBodyError::Count { field: name, found, allowed }).into())
}

fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

fn stem(path: &str) -> &str {
    let last = last_part(path);
    last.rsplit_once('.').map_or(last, |(stem, _)| stem)
}
