//! A robot: the mass, mass centre and inertia of its links in the links' own frames, and copies with other numbers.

use gyradius_inertia::{InertiaMatrix, MassProperties, RELATIVE_TOLERANCE};
use nalgebra::{Isometry3, Matrix3, Vector3};
use std::{
    collections::{HashMap, HashSet},
    path::Path,
};

use crate::{
    CompilerDoubt, FileBodyError, FileProblem, Format, Gap, InertiaFile, LinkProblem, Products,
    RobotError, WithoutInertia, compiler,
    copy::edits,
    edit::{Edit, edited},
    frame::{self, Frame},
    geometry::{self, GeometryProblem, Solid},
    holder::{holder, inertials, is_body, is_in_gazebo, is_made_into_bodies, possible_inertials},
    kind::{known_extension, not_read},
    mjcf_geoms::Geoms,
    references, robots,
    text::Text,
    xml::{Node, Tree},
};

/// A URDF, MJCF or SDF file as links with mass properties, which can be written with others.
///
/// ```
/// use gyradius_formats::RobotFile;
/// use gyradius_inertia::{Inertia, InertiaMatrix, MassProperties};
/// use std::path::Path;
///
/// let urdf = r#"<robot name="cart"><link name="wheel"><inertial>
///   <origin xyz="0 0 0.1"/> <!-- from CAD --> <mass value="1"/>
///   <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.15"/>
/// </inertial></link></robot>"#;
/// let robot = RobotFile::parse(Path::new("cart.urdf"), urdf.into())?;
/// let wheel = robot.links()[0].numbers().unwrap();
/// assert_eq!((wheel.mass_kg(), wheel.mass_centre_m().z), (1.0, 0.1));
///
/// let inertia = Inertia::new(wheel.inertia().matrix() * 1.5)?;
/// let heavier = MassProperties::new(1.5, wheel.mass_centre_m(), inertia)?;
/// let copy = String::from_utf8(robot.copy(&[(0, heavier)])?)?;
/// assert!(copy.contains("<mass value=\"1.5\"/>") && copy.contains("<!-- from CAD -->"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RobotFile {
    file: InertiaFile,
    links: Vec<RobotLink>,
    without: Vec<String>,
    /// Those of them of which the simulator computes the inertia.
    computed: HashSet<String>,
    references: Vec<String>,
    /// Why MuJoCo does not use what is written.
    overridden: Option<String>,
    doubts: Vec<CompilerDoubt>,
}

/// A link with an inertia, or why that cannot be told.
#[derive(Clone, Debug)]
pub struct RobotLink {
    name: String,
    line: usize,
    read: Result<(LinkNumbers, Frame), LinkProblem>,
    geometry: Result<Vec<Solid>, GeometryProblem>,
    defaults: Vec<&'static str>,
}

/// The ten numbers of a link as its file has them, which need not be those of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkNumbers {
    mass: f64,
    centre: Vector3<f64>,
    inertia: InertiaMatrix,
}

impl LinkNumbers {
    /// Mass, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.mass
    }

    /// Mass centre in the frame of the link, m.
    #[must_use]
    pub fn mass_centre_m(&self) -> Vector3<f64> {
        self.centre
    }

    /// Inertia about the mass centre in axes parallel to the link's, kg·m², products as tensor entries.
    #[must_use]
    pub fn inertia(&self) -> &InertiaMatrix {
        &self.inertia
    }
}

impl RobotLink {
    /// Name of the link, `unnamed` if it has none. The second of a name in a file is called `name#2`, or `name##2` if another
    /// one is called so in the file, and so on. A second inertia in one link has the name of the first, one in a block for Gazebo that
    /// of the link for which it stands there, and neither has numbers.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Line of its inertia, from 1.
    #[must_use]
    pub fn line(&self) -> usize {
        self.line
    }

    /// Its numbers.
    ///
    /// # Errors
    /// They cannot be told.
    pub fn numbers(&self) -> Result<&LinkNumbers, &LinkProblem> {
        self.read.as_ref().map(|(numbers, _)| numbers)
    }

    /// What the file leaves to the defaults of SDF: `mass` (1 kg), and `inertia` as a whole or `ixx`, `iyy`, `izz` (1 kg·m²).
    /// Products, which are zero then, are not named.
    #[must_use]
    pub fn defaults(&self) -> &[&'static str] {
        &self.defaults
    }
}

/// Names that are told apart.
#[derive(Debug)]
struct Names {
    taken: HashSet<String>,
    counts: HashMap<String, usize>,
}

impl Names {
    /// Of which these stand in the file.
    fn of<'n>(names: impl Iterator<Item = &'n str>) -> Self {
        Self { taken: names.map(str::to_owned).collect(), counts: HashMap::new() }
    }

    /// A name that no other has: of those that are written in the file, the first keeps its own.
    fn next(&mut self, name: &str) -> String {
        let count = self.counts.entry(name.to_owned()).or_default();
        *count += 1;
        if *count == 1 {
            return name.to_owned();
        }
        let mut marks = "#".to_owned();
        loop {
            let told = format!("{name}{marks}{count}");
            if self.taken.insert(told.clone()) {
                return told;
            }
            marks.push('#');
        }
    }
}

/// A name, or what is called without one.
fn named(name: &str) -> &str {
    if name.is_empty() { "unnamed" } else { name }
}

/// The name of a link without an inertia in the file, or of what becomes several.
fn name_of<'t>(link: Node<'t, '_>) -> &'t str {
    named(link.attribute("name").or(link.attribute("prefix")).unwrap_or_default())
}

/// The links and bodies for which a file states no inertia.
fn without_inertia<'t, 'a>(tree: &'t Tree<'a>, format: Format) -> Vec<Node<'t, 'a>> {
    let is_computed = |one: &Node<'_, '_>| format == Format::Sdf && robots::is_computed(*one);
    let is_without = |node: &Node<'t, 'a>| {
        is_made_into_bodies(*node, format)
            || (is_body(*node, format)
                // What stands there is for Gazebo, beside the links.
                && !(format == Format::Urdf && is_in_gazebo(*node))
                && possible_inertials(*node, format).iter().all(is_computed))
    };
    tree.nodes().filter(is_without).collect()
}

impl TryFrom<InertiaFile> for RobotFile {
    type Error = RobotError;

    /// The robot of a file that was read.
    ///
    /// # Errors
    /// [`RobotError::Format`]: it is no robot's.
    fn try_from(file: InertiaFile) -> Result<Self, RobotError> {
        Self::new(file)
    }
}

impl RobotFile {
    /// Whether a file is for a robot by its name, or, if its name tells nothing, by how it begins.
    #[must_use]
    pub fn is_one(path: &Path, begins: &[u8]) -> bool {
        match known_extension(path) {
            Some("csv" | "toml" | "json") => false,
            Some(_) => true,
            // What is said of a robot in a format that is not read is why it is not.
            None if matches!(
                not_read(path),
                Some(FileProblem::NotRead { .. } | FileProblem::Compressed)
            ) =>
            {
                true
            }
            None => begins
                .strip_prefix(b"\xef\xbb\xbf")
                .unwrap_or(begins)
                .trim_ascii_start()
                .starts_with(b"<"),
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// The file as a whole cannot be read, or is no robot's.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        Self::new(InertiaFile::read(path, Products::default())?)
    }

    /// Reads what a file of this name holds.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(path: &Path, bytes: Vec<u8>) -> Result<Self, RobotError> {
        Self::new(InertiaFile::parse(path, bytes, Products::default())?)
    }

    fn new(file: InertiaFile) -> Result<Self, RobotError> {
        let format = file.format();
        if !matches!(format, Format::Urdf | Format::Mjcf | Format::Sdf) {
            return Err(RobotError::Format { format });
        }
        // What was read once is read again without an error.
        let text = Text::new(&file.bytes, false).map_err(|_| RobotError::Format { format })?;
        let tree = Tree::parse(&text).map_err(|_| RobotError::Format { format })?;
        let (angles, products) = (frame::angles(&tree), file.products());
        let geoms = Geoms::new(&tree, &angles);
        let without = without_inertia(&tree, format);
        let written = file.bodies().iter().map(|body| named(body.name()));
        let mut names = Names::of(written.chain(without.iter().map(|link| name_of(*link))));
        // Of links with several inertias, what the first is called, by its place.
        let mut firsts: HashMap<usize, String> = HashMap::new();
        let mut links = Vec::new();
        let extension = known_extension(file.path());
        let _ = robots::each(&tree, format, extension, products, |node, body| {
            let of_body = holder(node, format).map(|body| inertials(body, format));
            let of_body = of_body.unwrap_or_default();
            let first = of_body.first().filter(|first| **first != node);
            let repeated = first.is_some();
            let for_gazebo = format == Format::Urdf && is_in_gazebo(node);
            let own = named(body.name());
            // What stands beside the inertia of a link takes no name from another link.
            let name = match first {
                _ if for_gazebo => own.to_owned(),
                Some(first) => firsts.get(&first.place().start).map_or(own, |n| n).to_owned(),
                None => names.next(own),
            };
            if of_body.len() > 1 && !repeated {
                firsts.insert(node.place().start, name.clone());
            }
            let read = match body.reading() {
                _ if of_body.len() > 1 && format == Format::Mjcf => Err(LinkProblem::Several),
                _ if repeated => Err(LinkProblem::Second),
                _ if for_gazebo => Err(LinkProblem::Gazebo),
                None => Err(body.inertia().err().map_or(LinkProblem::Gazebo, Into::into)),
                Some(reading) => frame::of(node, format, &angles).and_then(|frame| {
                    let matrix = InertiaMatrix::new(reading.matrix)
                        .and_then(|matrix| matrix.rotated(&frame.rotation));
                    let inertia = matrix.map_err(|_| LinkProblem::OutOfRange)?;
                    // As it is written, where nothing is turned.
                    let numbers = LinkNumbers {
                        mass: reading.mass_kg.ok_or(FileBodyError::Missing { field: "mass" })?,
                        centre: frame.centre,
                        inertia,
                    };
                    Ok((numbers, frame))
                }),
            };
            let geometry = if format == Format::Mjcf {
                geoms.of(node)
            } else {
                geometry::of(node, format, &angles)
            };
            let of_sdf = format == Format::Sdf && !repeated;
            let defaults = if of_sdf { frame::defaults(node) } else { Vec::new() };
            links.push(RobotLink { name, line: body.line(), read, geometry, defaults });
        });
        let overridden = (format == Format::Mjcf).then(|| compiler::overridden(&tree)).flatten();
        let doubts = compiler::doubts(&tree, format);
        // A link of SDF that is without though it has an `<inertial>` has one that is computed.
        let is_computed = |link: Node<'_, '_>| {
            format == Format::Sdf && !possible_inertials(link, format).is_empty()
        };
        let without =
            without.into_iter().map(|link| (names.next(name_of(link)), is_computed(link)));
        let without: Vec<(String, bool)> = without.collect();
        let computed = without.iter().filter(|(_, computed)| *computed);
        let computed = computed.map(|(name, _)| name.clone()).collect();
        let without = without.into_iter().map(|(name, _)| name).collect();
        let references = references::relative(&tree);
        Ok(Self { links, without, computed, references, overridden, doubts, file })
    }

    /// The path that was read.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.file.path()
    }

    /// The format that was found.
    #[must_use]
    pub fn format(&self) -> Format {
        self.file.format()
    }

    /// The links with an inertia, in the order of the file.
    #[must_use]
    pub fn links(&self) -> &[RobotLink] {
        &self.links
    }

    /// Names of the links for which the file states no inertia, told apart from those of all others after these. In MJCF, an element of
    /// which MuJoCo makes bodies (`<flexcomp>`, `<composite>`) is among them by its name.
    #[must_use]
    pub fn links_without_inertia(&self) -> &[String] {
        &self.without
    }

    /// Why a link is one of [those without inertia](Self::links_without_inertia), by its name there.
    #[must_use]
    pub fn why_without(&self, name: &str) -> WithoutInertia {
        if self.computed.contains(name) {
            WithoutInertia::Computed
        } else {
            WithoutInertia::NotStated
        }
    }

    /// Points in the frame of a link of which its geometry is the convex hull: that of its collisions, or of its visuals
    /// if it has none. Meshes (STL, OBJ) are read; of a sphere or a cylinder the points lie on it.
    ///
    /// # Errors
    /// There is none, or it cannot be read.
    pub fn points_m(&self, link: usize) -> Result<Vec<[f64; 3]>, GeometryProblem> {
        let link = self.links.get(link).ok_or(GeometryProblem::Nothing)?;
        let solids = link.geometry.as_ref().map_err(Clone::clone)?;
        geometry::points(solids, self.path())
    }

    /// What of the file was not read though the rest was.
    #[must_use]
    pub fn gaps(&self) -> &[Gap] {
        self.file.gaps()
    }

    /// Paths of other files, meshes say, that hold from the folder of this file only, as they are written; in MJCF
    /// below the folder that the compiler is told.
    #[must_use]
    pub fn relative_paths(&self) -> &[String] {
        &self.references
    }

    /// What of an MJCF file tells MuJoCo not to use the numbers of the links as they are written, such as
    /// `inertiafromgeom="true"` or `settotalmass="5"`. Files that it includes are not looked at.
    #[must_use]
    pub fn overridden_by(&self) -> Option<&str> {
        self.overridden.as_deref()
    }

    /// Why a simulator may use other numbers than those of the links, though nothing is known to override all of them.
    #[must_use]
    pub fn compiler_doubts(&self) -> &[CompilerDoubt] {
        &self.doubts
    }

    /// The bytes of a copy in which the links of these indices have other mass properties, in the links' frames, and
    /// everything else is as it was. Only numbers change, each written with as many digits as read back bit for bit,
    /// and of those only the ones that differ. What the file leaves to its defaults is written out where it must be,
    /// and MJCF's `diaginertia` becomes `fullinertia` where the axes are turned and nothing in the file says theirs.
    ///
    /// In a frame that is not turned, the copy reads back to the bit; in one that is, and with `diaginertia`, to
    /// rounding of the largest entry. In a `<frame>` of MJCF, the mass centre reads back to rounding, too.
    ///
    /// # Errors
    /// A link's numbers cannot be told or do not stand in the file as plain numbers, or the copy does not read back.
    pub fn copy(&self, changed: &[(usize, MassProperties)]) -> Result<Vec<u8>, RobotError> {
        let mut all: Vec<Edit> = Vec::new();
        let mut expected: HashMap<usize, &MassProperties> = HashMap::new();
        for (index, properties) in changed {
            let Some((link, body)) = self.links.get(*index).zip(self.file.bodies().get(*index))
            else {
                return Err(RobotError::Index { index: *index, links: self.links.len() });
            };
            let fail =
                |problem| RobotError::Link { name: link.name.clone(), line: link.line, problem };
            let (numbers, frame) = link.read.as_ref().map_err(|problem| fail(problem.clone()))?;
            let reading = body.reading().ok_or_else(|| fail(LinkProblem::OutOfRange))?;
            all.extend(edits(reading, frame, numbers.inertia.matrix(), properties).map_err(fail)?);
            expected.insert(*index, properties);
        }
        let copy =
            edited(&self.file.bytes, &self.file.offsets, all).ok_or(RobotError::ReadsBackWrong)?;
        let again = self.file.reread(copy.clone()).map_err(RobotError::File).and_then(Self::new);
        let again = again.map_err(|_| RobotError::ReadsBackWrong)?;
        let same = again.links.len() == self.links.len()
            && self.links.iter().zip(&again.links).enumerate().all(|(index, (before, after))| {
                before.name == after.name
                    && match (expected.get(&index), &before.read, &after.read) {
                        (None, Ok((before, _)), Ok((after, _))) => before == after,
                        (None, Err(before), Err(after)) => before == after,
                        (Some(properties), Ok(_), Ok(after)) => is_that(after, properties),
                        _ => false,
                    }
            });
        if same { Ok(copy) } else { Err(RobotError::ReadsBackWrong) }
    }
}

/// Whether numbers are those of a body, the inertia to rounding; in frames of MJCF the mass centre as well.
fn is_that((numbers, frame): &(LinkNumbers, Frame), body: &MassProperties) -> bool {
    let off = (numbers.centre - body.mass_centre_m()).amax();
    let size = |around: Isometry3<f64>| numbers.centre.amax() + around.translation.vector.amax();
    let rounding = frame.around.map_or(0.0, |around| RELATIVE_TOLERANCE * size(around));
    let (read, meant): (&Matrix3<f64>, _) = (numbers.inertia.matrix(), body.inertia().matrix());
    numbers.mass == body.mass_kg()
        && off <= rounding
        && (read - meant).amax() <= RELATIVE_TOLERANCE * meant.amax()
}
