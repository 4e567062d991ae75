//! Geoms of MJCF as points: wherever a class says what they are, they are the same, and lie where they should.

use gyradius_formats::RobotFile;
use proptest::{prelude::*, sample::select};
use std::{fs, path::Path};

const INERTIAL: &str = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";

fn file(before: &str, body: &str, geoms: &str) -> String {
    format!(
        "<mujoco>{before}<worldbody><body name='l' {body}>{INERTIAL}{geoms}</body></worldbody></mujoco>"
    )
}

fn points(path: &Path, text: &str) -> Result<Vec<[f64; 3]>, String> {
    let robot = RobotFile::parse(path, text.as_bytes().to_vec()).unwrap();
    robot.points_m(0).map_err(|problem| problem.to_string())
}

fn read(text: &str) -> Result<Vec<[f64; 3]>, String> {
    points(Path::new("a.xml"), text)
}

/// Least and largest coordinates, to a millionth.
fn extent(text: &str) -> [(f64, f64); 3] {
    let points = read(text).unwrap();
    std::array::from_fn(|i| {
        let all = || points.iter().map(|p| p[i]);
        let (low, high) =
            (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        ((low * 1e6).round() / 1e6, (high * 1e6).round() / 1e6)
    })
}

/// Sizes are halves, and ends of what is long are points of its axis.
#[test]
fn geoms_lie_where_mujoco_has_them() {
    let turned = "pos='1 2 3' axisangle='0 0 1 90'";
    for (geom, expected) in [
        (format!("type='box' size='0.1 0.2 0.3' {turned}"), [(0.8, 1.2), (1.9, 2.1), (2.7, 3.3)]),
        (format!("size='0.5' {turned}"), [(0.5, 1.5), (1.5, 2.5), (2.5, 3.5)]),
        (format!("type='cylinder' size='0.5 1' {turned}"), [(0.5, 1.5), (1.5, 2.5), (2.0, 4.0)]),
        (format!("type='capsule' size='0.5 1' {turned}"), [(0.5, 1.5), (1.5, 2.5), (1.5, 4.5)]),
        (
            format!("type='ellipsoid' size='0.1 0.2 0.3' {turned}"),
            [(0.8, 1.2), (1.9, 2.1), (2.7, 3.3)],
        ),
        (
            "type='capsule' size='0.5' fromto='1 2 2 1 2 4'".to_owned(),
            [(0.5, 1.5), (1.5, 2.5), (1.5, 4.5)],
        ),
        (
            "type='box' size='0.5 9 9' fromto='1 0 3 1 4 3' pos='9 9 9'".to_owned(),
            [(0.5, 1.5), (0.0, 4.0), (2.5, 3.5)],
        ),
        (
            "type='cylinder' size='0.5' fromto='3 2 1 -1 2 1'".to_owned(),
            [(-1.0, 3.0), (1.5, 2.5), (0.5, 1.5)],
        ),
        // How a box is rolled tells which end is the first: geom_pos, geom_quat and geom_size of MuJoCo 4.0.0.
        (
            "type='box' size='0.06' fromto='0 0 0.3 0.1 0.05 -0.1'".to_owned(),
            [(-0.059114, 0.159114), (-0.060443, 0.110443), (-0.121669, 0.321669)],
        ),
        (
            "type='box' size='0.06' fromto='0.1 0.05 -0.1 0 0 0.3'".to_owned(),
            [(-0.081342, 0.181342), (-0.083557, 0.133557), (-0.121669, 0.321669)],
        ),
    ] {
        let text = file("", "", &format!("<geom {geom}/>"));
        assert_eq!(extent(&text), expected, "{geom}");
        // What cannot collide counts only where nothing can.
        let seen = "<geom size='30' contype='0' conaffinity='0'/>";
        assert_eq!(extent(&file("", "", &format!("{seen}<geom {geom}/>"))), expected, "{geom}");
    }
    let seen = "<geom size='3' contype='0' conaffinity='0'/>";
    assert_eq!(extent(&file("", "", seen)), [(-3.0, 3.0); 3]);
}

#[test]
fn meshes_are_found_as_mujoco_finds_them() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("assets")).unwrap();
    let corners = "v 1 0 0\nv 0 2 0\nv 0 0 3\nv 0 0 0\n";
    fs::write(folder.path().join("assets/part.obj"), corners).unwrap();
    let path = folder.path().join("a.xml");
    let sorted = |text: &str| {
        let mut points = points(&path, text)?;
        points.sort_by(|a, b| a.partial_cmp(b).unwrap());
        Ok::<_, String>(points)
    };
    let expected = vec![[0.0, 0.0, 0.0], [0.0, 0.0, 6.0], [0.0, 2.0, 0.0], [0.5, 0.0, 0.0]];
    let geom = "<geom type='mesh' mesh='part'/>";
    let scale = "scale='0.5 1 2'";
    for before in [
        format!("<compiler meshdir='assets'/><asset><mesh file='part.obj' {scale}/></asset>"),
        format!(
            "<compiler assetdir='assets/' strippath='true'/><asset><mesh file='b\\part.obj' {scale}/></asset>"
        ),
        format!("<asset><mesh name='part' file='assets/part.obj' {scale}/></asset>"),
        format!(
            "<default><mesh {scale}/></default><asset><mesh name='part' file='assets/part.obj'/></asset>"
        ),
        format!("<asset><mesh name='part' vertex='1 0 0 0 2 0 0 0 3 0 0 0' {scale}/></asset>"),
    ] {
        assert_eq!(sorted(&file(&before, "", geom)).unwrap(), expected, "{before}");
    }
    for (before, geom, why) in [
        ("", geom, "there is no mesh \"part\""),
        ("<asset><mesh file='part.obj'/></asset>", geom, "part.obj: there is no such file"),
        (
            "<asset><mesh file='part.obj' refpos='1 0 0'/></asset>",
            geom,
            "has refpos, which is not read",
        ),
        ("", "<geom type='capsule' mesh='part'/>", "is fitted to a mesh"),
        ("", "<geom type='plane' size='1 1 1'/>", "<plane> is not read"),
        ("", "<geom/>", "size = 0: it must be positive"),
        ("", "<geom size='1 2 3 4'/>", "size has 4 values"),
        ("", "<geom size='1' class='wheel'/>", "no default class \"wheel\""),
        ("", "<geom size='1' pos='1 2'/>", "pos has 2 values: there must be 3"),
        ("", "<frame pos='1 0 0'><geom size='1'/></frame>", "in a <frame> are not read"),
        ("<include file='b.xml'/>", "<geom size='1'/>", "other files, which are not followed"),
        ("", "<body/>", "it has no geom"),
    ] {
        let error = sorted(&file(before, "", geom)).unwrap_err();
        assert!(error.contains(why), "{geom}: {error}");
    }
}

/// Who says an attribute: the geom, its class, the class around that, the main one.
const LEVELS: usize = 4;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn classes_say_what_a_geom_does_not(
        kind in select(vec!["box", "ellipsoid", "capsule", "cylinder", "sphere"]),
        size in prop::array::uniform3(0.1..2.0_f64),
        pos in prop::array::uniform3(-1.0..1.0_f64),
        euler in prop::array::uniform3(-90.0..90.0_f64),
        // The first level that says each, and which of the levels below say something else.
        levels in prop::array::uniform4(0..LEVELS),
        decoys in prop::array::uniform4(any::<[bool; LEVELS]>()),
        by_body in any::<bool>(),
        split in any::<bool>(),
    ) {
        let three = |x: [f64; 3]| format!("{} {} {}", x[0], x[1], x[2]);
        let said = [("type", kind.to_owned()), ("size", three(size)), ("pos", three(pos)), ("euler", three(euler))];
        let all: String = said.iter().map(|(name, value)| format!(" {name}='{value}'")).collect();
        let plain = file("", "", &format!("<geom{all}/>"));
        let mut at: [String; LEVELS] = Default::default();
        for (i, (name, value)) in said.iter().enumerate() {
            at[levels[i]] += &format!(" {name}='{value}'");
            for level in levels[i] + 1..LEVELS {
                if decoys[i][level] {
                    let other = if *name == "type" { "plane" } else { "7 8 9" };
                    at[level] += &format!(" {name}='{other}'");
                }
            }
        }
        let [own, inner, outer, main] = at;
        let nested = format!(
            "<default class='a'><geom{outer}/><default class='b'><geom{inner}/></default></default>"
        );
        let defaults = if split {
            format!("<default><geom{main}/></default><default class='main'>{nested}</default>")
        } else {
            format!("<default>{nested}<geom{main}/></default>")
        };
        let (body, class) = if by_body { ("childclass='b'", "") } else { ("childclass='a'", " class='b'") };
        let spread = file(&defaults, body, &format!("<geom{own}{class}/>"));
        prop_assert_eq!(read(&spread), read(&plain), "{}", spread);
        prop_assert!(read(&plain).is_ok());
    }

    /// A size that is said in part leaves the rest to the class.
    #[test]
    fn sizes_are_said_in_part(size in prop::array::uniform3(0.1..2.0_f64), own in 0..4_usize) {
        let words = size.map(|x| x.to_string());
        let given: Vec<&str> = (0..3).map(|i| if i < own { "9" } else { &*words[i] }).collect();
        let class = format!("<default><geom type='box' size='{}'/></default>", given.join(" "));
        let said = match own {
            0 => String::new(),
            own => format!("size='{}'", words[..own].join(" ")),
        };
        let found = read(&file(&class, "", &format!("<geom {said}/>")));
        let plain = read(&file("", "", &format!("<geom type='box' size='{}'/>", words.join(" "))));
        prop_assert_eq!(found, plain);
    }

    /// Garbage in attributes is refused or taken, and never more.
    #[test]
    fn no_attribute_panics(
        name in select(vec!["type", "size", "pos", "fromto", "quat", "euler", "class", "mesh", "contype"]),
        value in "[-0-9.e a-z]{0,12}",
    ) {
        let before = "<default><default class='a'><geom size='1'/></default></default>\
                      <asset><mesh name='m' vertex='1 2 3'/></asset>";
        let _ = read(&file(before, "", &format!("<geom {name}='{value}'/>")));
        if name != "type" {
            let _ = read(&file(before, "", &format!("<geom type='mesh' {name}='{value}'/>")));
        }
    }
}
