//! Random robots in every dress: links are read in their own frames, and a copy differs in numbers alone and reads back
//! as what was meant.

use gyradius_formats::{LinkProblem, RobotError, RobotFile, RobotLink, WithoutInertia};
use gyradius_inertia::{Inertia, MassProperties, SecondMoments};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use proptest::{prelude::*, sample::select};
use std::path::Path;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Style {
    Urdf,
    Full,
    Diagonal,
    Sdf,
    SdfAttributes,
}

/// How a link says which way the axes of its inertia are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turn {
    None,
    Zero,
    Angles,
    Quaternion,
}

#[derive(Clone, Debug)]
struct Link {
    mass: f64,
    centre: Option<[f64; 3]>,
    /// Second moments about the axes below, of which some are zero: plates, rods and points.
    second: [f64; 3],
    axes: [f64; 4],
    turn: Turn,
    angles: [f64; 3],
    digits: usize,
}

#[derive(Clone, Debug)]
struct Robot {
    style: Style,
    links: Vec<Link>,
    crlf: bool,
    comments: bool,
    mark: bool,
    tight: bool,
}

fn link() -> impl Strategy<Value = Link> {
    let size = -8.0..5.0_f64;
    (
        (0.001..1e3_f64, prop::option::of(prop::array::uniform3(-2.0..2.0_f64))),
        (prop::array::uniform3(select(vec![0.0, 0.3, 1.0, 1.0, 2.5])), size),
        prop::array::uniform4(-1.0..1.0_f64),
        select(vec![Turn::None, Turn::Zero, Turn::Angles, Turn::Quaternion]),
        (prop::array::uniform3(-3.2..3.2_f64), 3..17_usize),
    )
        .prop_map(|((mass, centre), (second, size), axes, turn, (angles, digits))| Link {
            mass,
            centre,
            second: second.map(|k| k * 10_f64.powf(size)),
            axes,
            turn,
            angles,
            digits,
        })
}

fn robot() -> impl Strategy<Value = Robot> {
    use Style::{Diagonal, Full, Sdf, SdfAttributes, Urdf};
    (
        select(vec![Urdf, Full, Diagonal, Sdf, SdfAttributes]),
        prop::collection::vec(link(), 1..5),
        any::<[bool; 4]>(),
    )
        .prop_map(|(style, links, [crlf, comments, mark, tight])| Robot {
            style,
            links,
            crlf,
            comments,
            mark,
            tight,
        })
}

fn quaternion(wxyz: [f64; 4]) -> UnitQuaternion<f64> {
    let [w, x, y, z] = wxyz;
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z + 1e-3))
}

fn body(second: [f64; 3], axes: [f64; 4]) -> Inertia {
    Inertia::from_second_moments(SecondMoments::new(second).unwrap(), &quaternion(axes)).unwrap()
}

/// A number as files write it: with few digits or all, with an exponent or a point.
fn number(x: f64, digits: usize) -> String {
    match digits % 3 {
        0 => format!("{x:.digits$e}"),
        1 => format!("{x:e}").replace('e', "E"),
        _ => format!("{x}"),
    }
}

impl Link {
    fn written(&self, x: f64) -> String {
        number(x, self.digits)
    }

    fn list(&self, numbers: &[f64]) -> String {
        numbers.iter().map(|x| self.written(*x)).collect::<Vec<_>>().join("  ")
    }

    /// The turn of its inertia's axes in those of the link, by entries of the rotation matrix.
    fn rotation(&self, style: Style) -> Matrix3<f64> {
        let read = |x: f64| self.written(x).parse::<f64>().unwrap();
        match (self.turn, style) {
            (Turn::None | Turn::Zero, _) | (_, Style::Full) => Matrix3::identity(),
            (Turn::Quaternion, Style::Diagonal | Style::Urdf) => {
                let [w, x, y, z] = self.axes.map(read);
                let n = w * w + x * x + y * y + z * z;
                Matrix3::new(
                    w * w + x * x - y * y - z * z,
                    2.0 * (x * y - w * z),
                    2.0 * (x * z + w * y),
                    2.0 * (x * y + w * z),
                    w * w - x * x + y * y - z * z,
                    2.0 * (y * z - w * x),
                    2.0 * (x * z - w * y),
                    2.0 * (y * z + w * x),
                    w * w - x * x - y * y + z * z,
                ) / n
            }
            (Turn::Angles | Turn::Quaternion, _) => {
                let [a, b, c] = self.angles.map(read);
                let (x, y, z) = (
                    Matrix3::new(1.0, 0.0, 0.0, 0.0, a.cos(), -a.sin(), 0.0, a.sin(), a.cos()),
                    Matrix3::new(b.cos(), 0.0, b.sin(), 0.0, 1.0, 0.0, -b.sin(), 0.0, b.cos()),
                    Matrix3::new(c.cos(), -c.sin(), 0.0, c.sin(), c.cos(), 0.0, 0.0, 0.0, 1.0),
                );
                // About fixed axes; MuJoCo's are those of the body.
                if style == Style::Diagonal { x * y * z } else { z * y * x }
            }
        }
    }

    /// Entries as they are written, in the order 11, 22, 33, 12, 13, 23.
    fn entries(&self, style: Style) -> [f64; 6] {
        if style == Style::Diagonal {
            let [a, b, c] = self.second;
            [b + c, a + c, a + b, 0.0, 0.0, 0.0]
        } else {
            body(self.second, self.axes).entries()
        }
    }

    fn xml(&self, style: Style) -> String {
        let six = self.entries(style).map(|x| self.written(x));
        let [xx, yy, zz, xy, xz, yz] = &six;
        let mass = self.written(self.mass);
        let angles = self.list(&self.angles);
        let centre = self.centre.map(|centre| self.list(&centre));
        let turned = match self.turn {
            Turn::None => String::new(),
            Turn::Zero => "0 0 0".to_owned(),
            Turn::Angles | Turn::Quaternion => angles.clone(),
        };
        match style {
            Style::Urdf => {
                let xyz = centre.map_or_else(String::new, |c| format!(" xyz=' {c}'"));
                let [w, x, y, z] = self.axes;
                let rpy = match self.turn {
                    Turn::None => String::new(),
                    Turn::Quaternion => format!(" quat_xyzw='{}'", self.list(&[x, y, z, w])),
                    Turn::Zero | Turn::Angles => format!(" rpy=\"{turned}\""),
                };
                let origin = if xyz.is_empty() && rpy.is_empty() {
                    String::new()
                } else {
                    format!("<origin{rpy}{xyz} />\n")
                };
                format!(
                    "<inertial>\n{origin}<mass value='{mass}'/> <inertia ixx='{xx}' ixy=\"{xy}\" \
                     ixz='{xz}'\niyy='{yy} ' iyz='{yz}' izz=' {zz}'/></inertial>"
                )
            }
            Style::Full | Style::Diagonal => {
                let pos = centre.map_or_else(String::new, |c| format!(" pos='{c}'"));
                let quat = match (self.turn, style) {
                    (Turn::None | Turn::Zero, Style::Diagonal) if self.digits.is_multiple_of(2) => {
                        " quat='1 0 0 0'".to_owned()
                    }
                    (Turn::Quaternion, Style::Diagonal) => {
                        format!(" quat='{}'", self.list(&self.axes))
                    }
                    (Turn::Angles, Style::Diagonal) => format!(" euler='{angles}'"),
                    _ => String::new(),
                };
                let moments = if style == Style::Full {
                    format!("fullinertia=\"{xx} {yy}\n{zz} {xy} {xz} {yz}\"")
                } else {
                    format!("diaginertia=' {xx} {yy} {zz}'")
                };
                format!("<inertial{pos} mass='{mass}'{quat}\n {moments}/>")
            }
            Style::Sdf => {
                let pose = match (&centre, turned.is_empty()) {
                    (None, _) if self.turn == Turn::None => String::new(),
                    (None, _) if self.turn == Turn::Zero => "<pose></pose>".to_owned(),
                    (centre, _) => {
                        let three = centre.clone().unwrap_or_else(|| "0 0 0".to_owned());
                        let turned = if turned.is_empty() { "0 0 0" } else { &turned };
                        format!("<pose>\n{three} {turned}</pose>")
                    }
                };
                let entries: String = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]
                    .iter()
                    .zip(&six)
                    .enumerate()
                    // Products that are zero are often left out.
                    .filter(|(e, (_, text))| {
                        *e < 3 || self.digits.is_multiple_of(2) || text.parse() != Ok(0.0)
                    })
                    .map(|(_, (name, text))| format!("<{name}> {text}</{name}>\n"))
                    .collect();
                format!(
                    "<inertial>{pose}<mass>{mass}</mass><inertia>{entries}</inertia></inertial>"
                )
            }
            Style::SdfAttributes => {
                let three = centre.unwrap_or_else(|| "0 0 0".to_owned());
                let turned = if turned.is_empty() { "0 0 0" } else { &turned };
                format!(
                    "<inertial mass='{mass}'><origin pose='{three} {turned}'/><inertia ixx='{xx}' \
                     iyy='{yy}' izz='{zz}' ixy='{xy}' ixz='{xz}' iyz='{yz}'/></inertial>"
                )
            }
        }
    }
}

impl Robot {
    fn name(&self) -> &'static str {
        match self.style {
            Style::Urdf => "r.urdf",
            Style::Full | Style::Diagonal => "r.xml",
            Style::Sdf | Style::SdfAttributes => "r.sdf",
        }
    }

    fn xml(&self) -> Vec<u8> {
        let (root, link) = match self.style {
            Style::Urdf => ("robot name='r' version='1.1'", "link"),
            Style::Full | Style::Diagonal => ("mujoco", "body"),
            Style::Sdf => ("sdf version='1.9'", "link"),
            Style::SdfAttributes => ("sdf", "link"),
        };
        let mut text = format!("<?xml version='1.0'?>\n<{root}>\n");
        if self.style == Style::Diagonal {
            text += "<compiler angle='radian'/>\n";
        }
        for (i, one) in self.links.iter().enumerate() {
            let xml = one.xml(self.style);
            if self.comments {
                text += &format!("<!-- 1.5 {xml} 2e-3 -->\n");
            }
            text += &format!("<{link} name='l{i}'>{xml}</{link}>\n<{link} name='f{i}'/>\n");
        }
        text += &format!("</{}>\n", root.split(' ').next().unwrap());
        if self.tight {
            text = text.replace(">\n", ">");
        }
        if self.crlf {
            text = text.replace('\n', "\r\n");
        }
        let mark = if self.mark { "\u{feff}" } else { "" };
        format!("{mark}{text}").into_bytes()
    }

    /// Whether a copy needs something that the file leaves to its defaults.
    fn must_add(&self) -> bool {
        self.links.iter().any(|link| {
            let missing = self.style == Style::Sdf
                && link.digits % 2 == 1
                && link.entries(self.style)[3..]
                    .iter()
                    .any(|x| link.written(*x).parse() == Ok(0.0));
            let names = self.style == Style::Diagonal;
            link.centre.is_none() || missing || names
        })
    }
}

/// The text with a mark in the place of every number.
fn skeleton(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_start = first.is_ascii_digit() || "+-.".contains(first);
        let is_word = out.chars().last().is_some_and(|c| c.is_ascii_alphanumeric());
        let long = rest.len()
            - rest.trim_start_matches(|c: char| c.is_ascii_digit() || "+-.eE".contains(c)).len();
        if is_start && !is_word && rest[..long].parse::<f64>().is_ok() {
            out.push('#');
            rest = &rest[long..];
        } else {
            out.push(first);
            rest = &rest[first.len_utf8()..];
        }
    }
    out
}

fn parse(robot: &Robot) -> RobotFile {
    RobotFile::parse(Path::new(robot.name()), robot.xml()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn links_are_read_in_their_own_frames(robot in robot()) {
        let file = parse(&robot);
        prop_assert_eq!(file.links().len(), robot.links.len());
        prop_assert_eq!(file.links_without_inertia().len(), robot.links.len());
        for (link, found) in robot.links.iter().zip(file.links()) {
            let read = |x: f64| link.written(x).parse::<f64>().unwrap();
            let numbers = found.numbers().unwrap();
            prop_assert_eq!(numbers.mass_kg(), read(link.mass));
            let centre: Vector3<f64> = link.centre.unwrap_or_default().map(read).into();
            prop_assert_eq!(numbers.mass_centre_m(), centre);
            let [xx, yy, zz, xy, xz, yz] = link.entries(robot.style).map(read);
            let r = link.rotation(robot.style);
            let expected = r * Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) * r.transpose();
            let off = (numbers.inertia().matrix() - expected).amax();
            prop_assert!(off <= 1e-13 * expected.amax(), "{off:e}: {link:?}");
        }
    }

    /// Every link gets other properties, or some of the ten do.
    #[test]
    fn copies_differ_in_numbers_alone_and_read_back(
        robot in robot(),
        others in prop::collection::vec((link(), 0..16_u8), 4),
    ) {
        let file = parse(&robot);
        let mut changed = Vec::new();
        for (i, (other, keeps)) in others.iter().enumerate().take(robot.links.len()) {
            let Ok(numbers) = file.links()[i].numbers() else { continue };
            let nominal = Inertia::try_from(*numbers.inertia()).ok();
            let mass = if keeps & 1 == 1 { numbers.mass_kg() } else { other.mass };
            let centre = other.centre.map_or(numbers.mass_centre_m(), Vector3::from);
            let inertia = match nominal {
                Some(nominal) if keeps & 2 == 2 => nominal,
                // The same axes.
                Some(nominal) if keeps & 4 == 4 => Inertia::new(nominal.matrix() * 1.1).unwrap(),
                _ => body(other.second, other.axes),
            };
            if keeps & 8 == 0 {
                changed.push((i, MassProperties::new(mass, centre, inertia).unwrap()));
            }
        }
        let copy = file.copy(&changed).unwrap();
        let again = RobotFile::parse(Path::new(robot.name()), copy.clone()).unwrap();
        for (i, link) in robot.links.iter().enumerate() {
            let found = again.links()[i].numbers().unwrap();
            let Some((_, meant)) = changed.iter().find(|(index, _)| *index == i) else {
                prop_assert_eq!(Ok(found), file.links()[i].numbers());
                continue;
            };
            prop_assert_eq!(found.mass_kg(), meant.mass_kg());
            prop_assert_eq!(found.mass_centre_m(), meant.mass_centre_m());
            let exact = link.rotation(robot.style) == Matrix3::identity()
                && robot.style != Style::Diagonal;
            let matrix = meant.inertia().matrix();
            let allowed = if exact { 0.0 } else { 1e-14 * matrix.amax() };
            let off = (found.inertia().matrix() - matrix).amax();
            prop_assert!(off <= allowed, "{off:e} of {:e}: {link:?}", matrix.amax());
        }
        let (before, after) = (robot.xml(), copy);
        let (before, after) =
            (String::from_utf8(before).unwrap(), String::from_utf8(after).unwrap());
        if changed.is_empty() {
            prop_assert_eq!(&before, &after);
        }
        if !robot.must_add() {
            prop_assert_eq!(skeleton(&before), skeleton(&after));
        }
        prop_assert_eq!(before.matches('\n').count(), after.matches('\n').count());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// Whatever is broken in a file: it is refused, or its links are, or copies read back. Nothing panics.
    #[test]
    fn broken_files_are_refused_or_copied(
        robot in robot(),
        other in link(),
        breaks in prop::collection::vec((0.0..1.0_f64, select(vec!["", "<", ">", "'", "\"", "/", " ", "e", "-", "9", "&amp;", "<a/>", "\n"]), 0..9_usize), 1..4),
    ) {
        let mut text = String::from_utf8(robot.xml()).unwrap();
        for (place, put, cut) in breaks {
            let start = (place * text.len() as f64) as usize;
            let end = (start + cut).min(text.len());
            if text.is_char_boundary(start) && text.is_char_boundary(end) {
                text.replace_range(start..end, put);
            }
        }
        let Ok(file) = RobotFile::parse(Path::new(robot.name()), text.into_bytes()) else {
            return Ok(());
        };
        let body = body(other.second, other.axes);
        let meant = MassProperties::new(other.mass, Vector3::from(other.angles), body).unwrap();
        for index in 0..=file.links().len() {
            let copied = file.copy(&[(index, meant)]);
            if let Ok(copy) = copied {
                let again = RobotFile::parse(Path::new(robot.name()), copy).unwrap();
                prop_assert_eq!(again.links()[index].numbers().unwrap().mass_kg(), meant.mass_kg());
            }
            let _ = file.points_m(index);
        }
    }
}

/// What is left to defaults is written out where it must be, and nothing else.
#[test]
fn what_a_file_leaves_out_is_written_only_where_it_must_be() {
    let half = "<mass value='2'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>";
    let sdf = "<mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>";
    let old = "<inertia ixx='1' iyy='1' izz='1'/>";
    for (name, before, after) in [
        (
            "a.urdf",
            format!("<robot><link><inertial>{half}</inertial></link></robot>"),
            "<inertial><origin xyz=\"0.5 0.0 0.0\"/><mass value='4.0'/>",
        ),
        (
            "a.urdf",
            format!("<x:robot><link><x:inertial><origin rpy='0 0 0'/>{half}</x:inertial></link></x:robot>"),
            "<x:inertial><origin xyz=\"0.5 0.0 0.0\" rpy='0 0 0'/><mass",
        ),
        (
            "a.urdf",
            format!("<x:robot><link><x:inertial>{half}</x:inertial></link></x:robot>"),
            "<x:inertial><x:origin xyz=\"0.5 0.0 0.0\"/><mass",
        ),
        (
            "a.sdf",
            format!("<sdf version='1.9'><link><inertial>{sdf}</inertial></link></sdf>"),
            "<inertial><pose>0.5 0.0 0.0 0 0 0</pose><mass>4.0</mass><inertia>\
             <ixy>0.25</ixy><ixx>1</ixx>",
        ),
        (
            "a.sdf",
            format!("<x:sdf version='1.9'><link><x:inertial>{sdf}</x:inertial></link></x:sdf>"),
            "<x:inertial><x:pose>0.5 0.0 0.0 0 0 0</x:pose><mass>4.0</mass>",
        ),
        (
            "a.sdf",
            format!("<sdf version='1.0'><link><inertial mass='2'>{old}</inertial></link></sdf>"),
            "<inertial mass='4.0'><pose>0.5 0.0 0.0 0 0 0</pose><inertia ixy=\"0.25\" ixx='1'",
        ),
        (
            "a.xml",
            "<mujoco><body><inertial mass='2' diaginertia='1 1 1'/></body></mujoco>".to_owned(),
            "<inertial pos=\"0.5 0.0 0.0\" mass='4.0' fullinertia=\"1.0 1.0 1.0 0.25 0.0 0.0\"/>",
        ),
        (
            "a.xml",
            "<mujoco><body><inertial mass='2' pos='0 0 0' euler='0 0 0' diaginertia='1 1 1'/></body></mujoco>"
                .to_owned(),
            "<inertial mass='4.0' pos='0.5 0.0 0.0' quat=\"",
        ),
    ] {
        let file = RobotFile::parse(Path::new(name), before.clone().into_bytes()).unwrap();
        let matrix = Matrix3::new(1.0, 0.25, 0.0, 0.25, 1.0, 0.0, 0.0, 0.0, 1.0);
        let inertia = Inertia::new(matrix).unwrap();
        let other = MassProperties::new(4.0, Vector3::new(0.5, 0.0, 0.0), inertia).unwrap();
        let copy = String::from_utf8(file.copy(&[(0, other)]).unwrap()).unwrap();
        assert!(copy.contains(after), "{before}\n{copy}\n{after}");
    }
}

/// What cannot be told is said of that link alone.
#[test]
fn links_that_cannot_be_told_say_why() {
    let problem = |name: &str, text: &str| {
        let file = RobotFile::parse(Path::new(name), text.as_bytes().to_vec()).unwrap();
        let last = file.links().last().unwrap();
        let error = file.copy(&[(file.links().len() - 1, point())]).unwrap_err();
        assert!(matches!(error, RobotError::Link { .. }), "{error}");
        last.numbers().unwrap_err().clone()
    };
    fn point() -> MassProperties {
        MassProperties::point(1.0, Vector3::zeros()).unwrap()
    }
    let mjcf = |inside: &str, attributes: &str| {
        format!(
            "<mujoco>{inside}<body><inertial pos='0 0 0' mass='1' {attributes}/></body></mujoco>"
        )
    };
    assert_eq!(
        problem("a.xml", &mjcf("<include file='b.xml'/>", "euler='1 0 0' diaginertia='1 1 1'")),
        LinkProblem::Angles
    );
    // What is included after a compiler may have another one.
    let degrees = "<compiler angle='degree' eulerseq='zyx'/>";
    let include = "<include file='b.xml'/>";
    let radians = "<compiler angle='radian'/>";
    for before in [
        format!("{degrees}{include}"),
        format!("{include}{radians}"),
        format!("{radians}{include}<compiler eulerseq='xyz'/>"),
    ] {
        assert_eq!(
            problem("a.xml", &mjcf(&before, "euler='1 0 0' diaginertia='1 1 1'")),
            LinkProblem::Angles
        );
    }
    assert_eq!(
        problem(
            "a.xml",
            &mjcf(&format!("{degrees}{include}"), "axisangle='1 0 0 1' diaginertia='1 1 1'")
        ),
        LinkProblem::Angles
    );
    for (before, attributes) in [
        (format!("{include}{degrees}"), "euler='0 0 90'"),
        (format!("{include}{degrees}{radians}"), "euler='0 0 1.57'"),
        (format!("{degrees}{include}{radians}"), "axisangle='1 0 0 1.57'"),
        (format!("{degrees}{include}"), "quat='1 1 0 0'"),
        (format!("{degrees}{include}"), "zaxis='0 1 0'"),
    ] {
        let text = mjcf(&before, &format!("{attributes} diaginertia='1 2 2.5'"));
        let file = RobotFile::parse(Path::new("a.xml"), text.into_bytes()).unwrap();
        let turned = file.links()[0].numbers().unwrap().inertia().entries();
        assert!((turned[1] - 2.5).abs() < 1e-3 && (turned[2] - 2.0).abs() < 1e-3, "{turned:?}");
    }
    assert_eq!(
        problem("a.xml", &mjcf("", "quat='0 0 0 0' diaginertia='1 1 1'")),
        LinkProblem::Orientation { field: "quat" }
    );
    for attributes in [
        "quat='1 0 0 0' fullinertia='1 1 1 0 0 0'",
        "quat='1 0 0 0' zaxis='0 0 1' diaginertia='1 1 1'",
    ] {
        assert!(matches!(problem("a.xml", &mjcf("", attributes)), LinkProblem::Body(_)));
    }
    let sdf =
        "<sdf><link><inertial><pose relative_to='a'>0 0 0 0 0 0</pose></inertial></link></sdf>";
    assert_eq!(problem("a.sdf", sdf), LinkProblem::RelativeTo { frame: "a".to_owned() });
    let urdf = |turned: &str| {
        let six = "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>";
        let inside = format!("<origin {turned}/><mass value='1'/>{six}");
        problem(
            "a.urdf",
            &format!("<robot version='1.2'><link><inertial>{inside}</inertial></link></robot>"),
        )
    };
    let field = "quat_xyzw";
    assert_eq!(urdf("quat_xyzw='0 0 0 0'"), LinkProblem::Orientation { field });
    for turned in ["rpy='0 0 0' quat_xyzw='0 0 0 1'", "quat_xyzw='0 0 1'", "quat_xyzw='0 0 x 1'"] {
        assert!(matches!(urdf(turned), LinkProblem::Body(_)), "{turned}");
    }
    // Readers apply a quaternion from version 1.1 on, and pass over it before.
    let six = "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>";
    for (said, version) in [
        ("", Some("1.0")),
        ("version='1.0'", Some("1.0")),
        ("version='0.9'", Some("0.9")),
        ("version='1'", Some("1")),
        ("version='1.1'", None),
        ("version='1.10'", None),
        ("version='2.0'", None),
    ] {
        for (turned, refused) in [
            ("quat_xyzw='0 0 1 0'", version),
            ("rpy='0 0 1' quat_xyzw='0 0 1 0'", version),
            ("rpy='0 0 1'", None),
        ] {
            let inside = format!("<origin {turned}/><mass value='1'/>{six}");
            let text = format!("<robot {said}><link><inertial>{inside}</inertial></link></robot>");
            let robot = RobotFile::parse(Path::new("a.urdf"), text.into_bytes()).unwrap();
            let found = robot.links()[0].numbers().err();
            let expected = refused
                .map(|version| LinkProblem::QuaternionVersion { version: version.to_owned() });
            if turned.contains("rpy") && turned.contains("quat") && expected.is_none() {
                assert!(matches!(found, Some(LinkProblem::Body(_))), "{said} {turned}: {found:?}");
            } else {
                assert_eq!(found, expected.as_ref(), "{said} {turned}");
            }
        }
    }
    let gazebo =
        "<robot><gazebo reference='a'><inertial><mass>1</mass></inertial></gazebo></robot>";
    assert_eq!(problem("a.urdf", gazebo), LinkProblem::Gazebo);
    let table = RobotFile::parse(Path::new("a.csv"), b"ixx,iyy,izz\n1,1,1\n".to_vec());
    assert!(matches!(table, Err(RobotError::Format { .. })));
}

/// Points of every shape, in the frame of the link: those of an independent sum lie where they should.
#[test]
fn geometry_is_read_as_points() {
    let urdf = |geometry: &str, kind: &str| {
        format!(
            "<robot><link name='a'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' \
             izz='1'/></inertial><{kind}><origin xyz='1 2 3' rpy='0 0 1.5707963267948966'/><geometry>{geometry}</geometry>\
             </{kind}></link></robot>"
        )
    };
    let extent = |name: &str, text: String| {
        let file = RobotFile::parse(Path::new(name), text.into_bytes()).unwrap();
        let points = file.points_m(0).unwrap();
        let all = |pick: fn(f64, f64) -> f64, from: f64| {
            points.iter().fold([from; 3], |a, b| std::array::from_fn(|i| pick(a[i], b[i])))
        };
        let (low, high) = (all(f64::min, f64::INFINITY), all(f64::max, f64::NEG_INFINITY));
        std::array::from_fn(|i| ((low[i] * 1e6).round() / 1e6, (high[i] * 1e6).round() / 1e6))
    };
    let sdf = |geometry: &str| {
        format!(
            "<sdf version='1.9'><link name='a'><inertial/><collision><pose>1 2 3 0 0 1.5707963267948966</pose><geometry>\
             {geometry}</geometry></collision></link></sdf>"
        )
    };
    let expected: [[(f64, f64); 3]; 4] = [
        [(0.8, 1.2), (1.9, 2.1), (2.7, 3.3)],
        [(0.5, 1.5), (1.5, 2.5), (2.5, 3.5)],
        [(0.5, 1.5), (1.5, 2.5), (2.0, 4.0)],
        [(0.5, 1.5), (1.5, 2.5), (1.5, 4.5)],
    ];
    let in_urdf = [
        "<box size='0.2 0.4 0.6'/>",
        "<sphere radius='0.5'/>",
        "<cylinder radius='0.5' length='2'/>",
        "<capsule radius='0.5' length='2'/>",
    ];
    let in_sdf = [
        "<box><size>0.2 0.4 0.6</size></box>",
        "<ellipsoid><radii>0.5 0.5 0.5</radii></ellipsoid>",
        "<cylinder><radius>0.5</radius><length>2</length></cylinder>",
        "<capsule><radius>0.5</radius><length>2</length></capsule>",
    ];
    for i in 0..4 {
        for kind in ["collision", "visual"] {
            assert_eq!(extent("a.urdf", urdf(in_urdf[i], kind)), expected[i], "{}", in_urdf[i]);
        }
        assert_eq!(extent("a.sdf", sdf(in_sdf[i])), expected[i], "{}", in_sdf[i]);
    }
    for geometry in
        ["<box size='0 1 1'/>", "<plane/>", "<sphere/>", "<mesh filename='gone.stl'/>", ""]
    {
        let text = urdf(geometry, "collision");
        let file = RobotFile::parse(Path::new("a.urdf"), text.into_bytes()).unwrap();
        assert!(file.points_m(0).is_err(), "{geometry}");
    }
}

#[test]
fn names_are_told_apart_and_paths_found() {
    let text = "<sdf><link><inertial/></link><link name='a'><inertial/></link><link name='a'>\
                <inertial/><visual><mesh><uri>meshes/a.stl</uri></mesh></visual>\
                <mesh><uri>model://b.stl</uri></mesh></link><link><inertial/></link></sdf>";
    let file = RobotFile::parse(Path::new("a.sdf"), text.as_bytes().to_vec()).unwrap();
    let names: Vec<&str> = file.links().iter().map(RobotLink::name).collect();
    assert_eq!(names, ["unnamed", "a", "a#2", "unnamed#2"]);
    assert_eq!(file.relative_paths(), ["meshes/a.stl"]);
    let text = "<mujoco><compiler meshdir='assets/'/><mesh file='a.stl'/><include file='b.xml'/>\
                <texture file='/c.png'/></mujoco>";
    let file = RobotFile::parse(Path::new("a.xml"), text.as_bytes().to_vec()).unwrap();
    assert_eq!(file.relative_paths(), ["assets/a.stl", "b.xml"]);
}

/// What `<inertial>` of SDF says and leaves out, in both ways of writing.
#[derive(Clone, Debug)]
struct Partial {
    mass: Option<f64>,
    pose: Option<bool>,
    /// Which entries there are, in an element of their own.
    entries: Option<[bool; 6]>,
    in_attributes: bool,
    short: bool,
    prefix: bool,
}

const ENTRIES: [(&str, f64); 6] =
    [("ixx", 2.0), ("iyy", 2.5), ("izz", 3.0), ("ixy", 0.1), ("ixz", -0.2), ("iyz", 0.3)];

impl Partial {
    fn xml(&self) -> String {
        let p = if self.prefix { "x:" } else { "" };
        let element = |name: &str, attributes: &str, inside: &str| {
            if inside.is_empty() && self.short {
                format!("<{p}{name}{attributes}/>")
            } else {
                format!("<{p}{name}{attributes}>{inside}</{p}{name}>")
            }
        };
        let (mut attributes, mut inside) = (String::new(), String::new());
        if let Some(mass) = self.mass {
            if self.in_attributes {
                attributes = format!(" mass='{mass}'");
            } else {
                inside += &format!("<{p}mass>{mass}</{p}mass>");
            }
        }
        if let Some(is_empty) = self.pose {
            inside += &element("pose", "", if is_empty { "" } else { "0.1 0 0 0 0 0" });
        }
        if let Some(there) = self.entries {
            let given = ENTRIES.into_iter().zip(there).filter(|(_, there)| *there);
            let (mut of_inertia, mut children) = (String::new(), String::new());
            for ((name, x), _) in given {
                if self.in_attributes {
                    of_inertia += &format!(" {name}='{x}'");
                } else {
                    children += &format!("<{p}{name}>{x}</{p}{name}>");
                }
            }
            inside += &element("inertia", &of_inertia, &children);
        }
        let inertial = element("inertial", &attributes, &inside);
        let version = if self.in_attributes { "1.0" } else { "1.9" };
        format!("<{p}sdf version='{version}'><link name='a'>{inertial}<collision/></link></{p}sdf>")
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Whatever is left out, the defaults are those of SDF, they are named, and a copy states what differs from them.
    #[test]
    fn what_sdf_leaves_to_its_defaults_can_be_drawn(
        mass in prop::option::of(0.5..4.0_f64),
        pose in prop::option::of(any::<bool>()),
        entries in prop::option::of(prop::array::uniform6(any::<bool>())),
        in_attributes in any::<bool>(),
        short in any::<bool>(),
        prefix in any::<bool>(),
        factor in select(vec![1.0, 1.5]),
    ) {
        let partial = Partial { mass, pose, entries, in_attributes, short, prefix };
        let text = partial.xml();
        let file = RobotFile::parse(Path::new("a.sdf"), text.clone().into_bytes()).unwrap();
        let link = &file.links()[0];
        let numbers = link.numbers().unwrap();
        prop_assert_eq!(numbers.mass_kg(), mass.unwrap_or(1.0));
        let centre = Vector3::new(if pose == Some(false) { 0.1 } else { 0.0 }, 0.0, 0.0);
        prop_assert_eq!(numbers.mass_centre_m(), centre);
        let there = entries.unwrap_or_default();
        let six: [f64; 6] = std::array::from_fn(|e| match (there[e], e < 3) {
            (true, _) => ENTRIES[e].1,
            (false, true) => 1.0,
            (false, false) => 0.0,
        });
        prop_assert_eq!(numbers.inertia().entries(), six, "{}", text);
        let mut left = Vec::new();
        left.extend(mass.is_none().then_some("mass"));
        match entries {
            None => left.push("inertia"),
            Some(there) => left.extend((0..3).filter(|e| !there[*e]).map(|e| ENTRIES[e].0)),
        }
        prop_assert_eq!(link.defaults(), left);
        // Of another mass, and of six other entries or the same.
        let matrix = numbers.inertia().matrix() * factor
            + Matrix3::from_diagonal_element(if factor == 1.0 { 0.0 } else { 3.0 });
        let Ok(inertia) = Inertia::new(matrix) else { return Ok(()) };
        let other = MassProperties::new(factor * numbers.mass_kg(), centre * factor, inertia).unwrap();
        let copy = file.copy(&[(0, other)]);
        prop_assert!(copy.is_ok(), "{text}: {}", copy.unwrap_err());
        let copy = String::from_utf8(copy.unwrap()).unwrap();
        prop_assert!(factor != 1.0 || copy == text, "{}", copy);
        let again = RobotFile::parse(Path::new("a.sdf"), copy.into_bytes()).unwrap();
        prop_assert!(factor == 1.0 || again.links()[0].defaults().is_empty());
    }

    /// Names in a file may look like those by which links are told apart.
    #[test]
    fn no_two_links_have_one_name(names in prop::collection::vec("(a|b)?#{0,3}2?", 1..9), more in "a#{0,2}2?") {
        let read = |names: &[String]| {
            let links: String =
                names.iter().map(|name| format!("<link name='{name}'><inertial/></link>")).collect();
            let text = format!("<sdf>{links}</sdf>");
            let file = RobotFile::parse(Path::new("a.sdf"), text.into_bytes()).unwrap();
            file.links().iter().map(|link| link.name().to_owned()).collect::<Vec<_>>()
        };
        let found = read(&names);
        for (i, name) in found.iter().enumerate() {
            prop_assert!(!found[..i].contains(name), "{:?}: {:?}", names, found);
            if !names[i].is_empty() && !names[..i].contains(&names[i]) {
                prop_assert_eq!(name, &names[i]);
            }
        }
        // One more at the end changes none, unless it is called as one of them.
        let longer: Vec<String> = names.iter().chain([&more]).cloned().collect();
        if !found.contains(&more) {
            prop_assert_eq!(&read(&longer)[..names.len()], &found[..]);
        }
    }
}

/// Parsers of URDF and SDF read the first of two, and MuJoCo none.
#[test]
fn a_second_inertia_of_a_link_is_not_another_link() {
    let urdf = "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
    let mjcf = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
    for (name, root, link, inertial, problem) in [
        ("a.urdf", "robot", "link", urdf, LinkProblem::Second),
        ("a.sdf", "sdf", "link", "<inertial/>", LinkProblem::Second),
        ("a.xml", "mujoco", "body", mjcf, LinkProblem::Several),
    ] {
        let one = |name: &str, times: usize| {
            format!("<{link} name='{name}'>{}</{link}>", inertial.repeat(times))
        };
        let text = format!("<{root}>{}{}{}</{root}>", one("a", 2), one("b", 1), one("a", 1));
        let file = RobotFile::parse(Path::new(name), text.into_bytes()).unwrap();
        let names: Vec<&str> = file.links().iter().map(RobotLink::name).collect();
        assert_eq!(names, ["a", "a", "b", "a#2"], "{name}");
        let found: Vec<_> = file.links().iter().map(|link| link.numbers().err()).collect();
        // MuJoCo takes none of two, or the last.
        let first = (problem == LinkProblem::Several).then_some(&problem);
        assert_eq!(found, [first, Some(&problem), None, None], "{name}");
    }
}

/// A link whose inertia the simulator computes has none in the file, as one without the element.
#[test]
fn what_is_computed_from_shapes_is_no_inertia_of_the_file() {
    let inertia = "<mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>";
    let link = |name: &str, auto: &str| {
        format!("<link name='{name}'><inertial{auto}>{inertia}</inertial></link>")
    };
    let links = [link("a", " auto='true'"), link("b", " auto='false'"), link("c", "")].concat();
    let text = format!("<sdf version='1.11'><model name='m'>{links}<link name='d'/></model></sdf>");
    let file = RobotFile::parse(Path::new("a.sdf"), text.into()).unwrap();
    let names: Vec<&str> = file.links().iter().map(RobotLink::name).collect();
    assert_eq!(
        (names, file.links_without_inertia()),
        (vec!["b", "c"], &["a", "d"].map(String::from)[..])
    );
    let why = ["a", "d"].map(|name| file.why_without(name));
    assert_eq!(why, [WithoutInertia::Computed, WithoutInertia::NotStated]);
}

#[test]
fn what_overrides_the_inertias_is_what_mujoco_believes() {
    const FROM_GEOMETRY: Option<&str> = Some("inertiafromgeom=\"true\"");
    // The last of several compilers that state an attribute counts, as the masses show that MuJoCo 4.0.0 compiles from such
    // files. What the last file states raises or balances single numbers, and does not override all of them.
    for (before, after, told) in [
        ("", "", None),
        ("inertiafromgeom='true'", "", FROM_GEOMETRY),
        ("inertiafromgeom='true'", "angle='radian'", FROM_GEOMETRY),
        ("inertiafromgeom='false'", "inertiafromgeom='true'", FROM_GEOMETRY),
        ("inertiafromgeom='true'", "inertiafromgeom='false'", None),
        ("inertiafromgeom='auto'", "", None),
        ("settotalmass='5'", "", Some("settotalmass=\"5\"")),
        ("settotalmass='0'", "", None),
        ("settotalmass='5'", "settotalmass='-1'", None),
        ("boundmass='2' boundinertia='2' balanceinertia='true'", "", None),
    ] {
        let text = format!(
            "<mujoco><compiler {before}/><worldbody><body name='b'><inertial pos='0 0 0' mass='1' \
             diaginertia='1 1 1'/><geom size='.1'/></body></worldbody><compiler {after}/></mujoco>"
        );
        let robot = RobotFile::parse(Path::new("robot.xml"), text.into_bytes()).unwrap();
        assert_eq!(robot.overridden_by(), told, "{before} {after}");
    }
}

#[test]
fn what_mujoco_may_change_is_told() {
    // Checked with MuJoCo 4.0.0: a mass of 1 kg comes out as 2 kg with boundmass="2" of an MJCF and of a URDF file, as 5 kg
    // with settotalmass="5" of a URDF file and of an included one, and as 1 kg where the attribute is 0. It loads no file with
    // coordinate="global", or without pos, or with an empty one.
    let inertial = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/><geom size='.1'/>";
    let mjcf = |more: &str| {
        format!("<mujoco>{more}<worldbody><body name='b'>{inertial}</body></worldbody></mujoco>")
    };
    let free =
        |compiler: &str, joint: &str| mjcf(compiler).replace("<geom", &format!("{joint}<geom"));
    let urdf = |compiler: &str| {
        format!(
            "<robot name='r'><mujoco><compiler {compiler}/></mujoco><link name='b'><inertial><mass value='1'/><inertia \
             ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link></robot>"
        )
    };
    for (name, text, told) in [
        ("r.xml", mjcf(""), &[][..]),
        ("r.xml", mjcf("<compiler boundmass='0' boundinertia='-1' balanceinertia='true'/>"), &[]),
        ("r.xml", mjcf("<compiler boundmass=' 2 '/>"), &["boundmass=\"2\""]),
        (
            "r.xml",
            mjcf("<compiler boundmass='2' boundinertia='1e-3'/><include file='c.xml'/>"),
            &["boundmass=\"2\"", "boundinertia=\"1e-3\"", "includes are not read"],
        ),
        (
            "r.xml",
            format!(
                "<mujoco><worldbody><replicate count='3'><frame><body name='b'>{inertial}</body></frame></replicate></worldbody></mujoco>"
            ),
            &["\"b\" stands in <replicate>"],
        ),
        (
            "r.xml",
            format!(
                "<mujoco><worldbody><body name='b'>{inertial}<replicate count='3'><geom size='.1'/></replicate></body></worldbody></mujoco>"
            ),
            &[],
        ),
        (
            "r.xml",
            format!(
                "<mujoco><worldbody><body name='b'>{inertial}</body><frame><attach body='b' prefix='c_'/></frame></worldbody></mujoco>"
            ),
            &["\"b\" is attached once more"],
        ),
        (
            "r.urdf",
            urdf("fusestatic='false'")
                .replace("name='r'>", "name='r' version='1.1'>")
                .replace("<inertial>", "<inertial><origin quat_xyzw='0 0 1 1'/>"),
            &["turned by quat_xyzw: MuJoCo passes over that"],
        ),
        (
            "r.urdf",
            urdf("fusestatic='false'")
                .replace("name='r'>", "name='r' version='1.1'>")
                .replace("<inertial>", "<inertial><origin quat_xyzw='0 0 0 2'/>"),
            &[],
        ),
        // No reader takes it in a file that states no version.
        (
            "r.urdf",
            urdf("fusestatic='false'")
                .replace("<inertial>", "<inertial><origin quat_xyzw='0 0 1 1'/>"),
            &[],
        ),
        ("r.xml", mjcf("").replace(" pos='0 0 0'", ""), &["\"b\" has no pos"]),
        ("r.xml", mjcf("").replace("pos='0 0 0'", "pos=' '"), &["\"b\" has no pos"]),
        (
            "r.xml",
            mjcf("<compiler coordinate='local'/><default><inertial mass='1'/></default>"),
            &[],
        ),
        ("r.xml", mjcf("<compiler coordinate='global'/>"), &["coordinate=\"global\""]),
        ("r.xml", mjcf("<compiler fusestatic='true'/>"), &["fusestatic=\"true\""]),
        ("r.xml", mjcf("<compiler fusestatic='false' alignfree='true'/>"), &[]),
        ("r.xml", free("<compiler alignfree='true'/>", "<freejoint/>"), &["alignfree=\"true\""]),
        ("r.xml", free("<compiler alignfree='true'/>", "<joint type='free'/>"), &["alignfree"]),
        ("r.xml", free("<compiler alignfree='true'/>", "<joint/>"), &[]),
        ("r.xml", free("<compiler alignfree='true'/>", "<freejoint align='false'/>"), &[]),
        ("r.xml", free("", "<freejoint align='true'/>"), &["align=\"true\""]),
        ("r.xml", free("", "<joint type='free' align='auto'/>"), &[]),
        ("r.urdf", urdf("fusestatic='true'"), &[]),
        ("r.urdf", urdf("settotalmass='5' boundmass='2'"), &["settotalmass=\"5\"", "boundmass"]),
        ("r.urdf", urdf("inertiafromgeom='true'"), &["inertiafromgeom=\"true\""]),
    ] {
        let robot = RobotFile::parse(Path::new(name), text.clone().into_bytes()).unwrap();
        let found: Vec<String> = robot.compiler_doubts().iter().map(ToString::to_string).collect();
        assert_eq!(robot.overridden_by(), None, "{text}");
        assert_eq!(found.len(), told.len(), "{text}: {found:?}");
        for (found, told) in found.iter().zip(told) {
            assert!(found.contains(told), "{text}: {found}");
        }
    }
}
