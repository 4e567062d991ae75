//! Where a file has an inertia, and where elements of the same names are none: the settings of a plugin, say.

use gyradius_formats::{GapKind, InertiaFile, LinkProblem, Products, RobotFile};
use gyradius_inertia::{Inertia, MassProperties};
use nalgebra::{Isometry3, Matrix3, Quaternion, SMatrix, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::path::Path;

fn robot(name: &str, text: &str) -> RobotFile {
    RobotFile::parse(Path::new(name), text.as_bytes().to_vec()).unwrap()
}

/// That all entries are the same to a rounding.
#[track_caller]
fn near<const C: usize>(found: &SMatrix<f64, 3, C>, expected: &SMatrix<f64, 3, C>, rounding: f64) {
    let off = (found - expected).amax();
    assert!(off <= rounding, "{found} is not {expected}");
}

/// Names, masses and gaps of a file, and the links that have none.
fn found(name: &str, text: &str) -> (Vec<(String, f64)>, usize, Vec<String>) {
    let file =
        InertiaFile::parse(Path::new(name), text.as_bytes().to_vec(), Products::default()).unwrap();
    let of_file = file.bodies().iter().map(|body| body.mass_kg().unwrap());
    let robot = robot(name, text);
    let links: Vec<(String, f64)> = robot
        .links()
        .iter()
        .map(|link| (link.name().to_owned(), link.numbers().unwrap().mass_kg()))
        .collect();
    assert_eq!(of_file.collect::<Vec<_>>(), links.iter().map(|(_, m)| *m).collect::<Vec<_>>());
    let misplaced = file.gaps().iter().filter(|gap| gap.kind() == GapKind::Misplaced);
    (links, misplaced.map(gyradius_formats::Gap::count).sum(), robot.links_without_inertia().into())
}

/// Checked with MuJoCo 4.0.0, Pinocchio 4.1.0 and by the specifications of URDF and SDF: none of them takes a misplaced
/// one for that of a link.
#[test]
fn an_inertia_is_one_of_a_link_alone() {
    let urdf = "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
    let sdf = "<inertial><mass>1</mass></inertial>";
    let mjcf = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
    let link = |inner: &str| format!("<link name='a'>{inner}</link>");
    for (name, text, bodies, misplaced) in [
        ("r.urdf", format!("<robot>{}</robot>", link(urdf)), 1, 0),
        ("r.urdf", format!("<robot>{}</robot>", link(&format!("<visual>{urdf}</visual>"))), 0, 1),
        (
            "r.urdf",
            format!("<robot>{}</robot>", link(&format!("<more><x>{urdf}</x></more>"))),
            0,
            1,
        ),
        ("r.urdf", format!("<robot><transmission>{}</transmission></robot>", link(urdf)), 0, 1),
        ("r.urdf", format!("<robot><sensor name='a'>{urdf}</sensor></robot>"), 0, 1),
        ("r.urdf", format!("<robot>{urdf}</robot>"), 0, 1),
        (
            "r.xacro",
            format!("<robot xmlns:x='http://ros.org/xacro'><x:if>{}</x:if></robot>", link(urdf)),
            1,
            0,
        ),
        (
            "r.xacro",
            format!("<robot xmlns:x='http://ros.org/xacro'><x:any>{urdf}</x:any></robot>"),
            1,
            0,
        ),
        ("r.xacro", format!("<robot><macro name='m'>{}</macro></robot>", link(urdf)), 1, 0),
        ("r.sdf", format!("<sdf><world><model>{}</model></world></sdf>", link(sdf)), 1, 0),
        ("r.sdf", format!("<sdf><model><model>{}</model></model></sdf>", link(sdf)), 1, 0),
        ("r.sdf", format!("<sdf><model><plugin>{sdf}</plugin></model></sdf>"), 0, 1),
        ("r.sdf", format!("<sdf><model><plugin>{}</plugin></model></sdf>", link(sdf)), 0, 1),
        (
            "r.sdf",
            format!("<sdf><model>{}</model></sdf>", link(&format!("<sensor>{sdf}</sensor>"))),
            0,
            1,
        ),
        (
            "r.sdf",
            format!("<sdf><model>{}</model></sdf>", link(&format!("<collision>{sdf}</collision>"))),
            0,
            1,
        ),
        (
            "r.sdf",
            format!("<sdf><world><include><p>{}</p></include></world></sdf>", link(sdf)),
            0,
            1,
        ),
        (
            "r.xml",
            format!("<mujoco><worldbody><body name='a'>{mjcf}</body></worldbody></mujoco>"),
            1,
            0,
        ),
        (
            "r.xml",
            format!(
                "<mujoco><worldbody><body name='a'><frame>{mjcf}</frame></body></worldbody></mujoco>"
            ),
            1,
            0,
        ),
        ("r.xml", format!("<mujoco><worldbody>{mjcf}</worldbody></mujoco>"), 0, 1),
        ("r.xml", format!("<mujoco><worldbody><frame>{mjcf}</frame></worldbody></mujoco>"), 0, 1),
        (
            "r.xml",
            format!(
                "<mujoco><worldbody><body name='a'><replicate count='2'>{mjcf}</replicate></body></worldbody></mujoco>"
            ),
            0,
            1,
        ),
        ("r.xml", format!("<mujocoinclude><body name='a'>{mjcf}</body></mujocoinclude>"), 1, 0),
        ("r.xml", format!("<mujocoinclude>{mjcf}</mujocoinclude>"), 1, 0),
        ("r.xml", format!("<parts><body name='a'>{mjcf}</body></parts>"), 1, 0),
    ] {
        let (links, gaps, without) = found(name, &text);
        assert_eq!((links.len(), gaps), (bodies, misplaced), "{text}");
        for link in links {
            assert!(link.0 == "a" || link.0 == "unnamed", "{text}: {link:?}");
            assert_eq!(without, [""; 0], "{text}");
        }
    }
}

/// A misplaced inertia makes no link, nor does a link of a plugin become one without an inertia.
#[test]
fn what_is_passed_over_is_no_link() {
    let text = "<sdf version='1.9'><model name='m'><link name='a'><inertial><mass>2</mass></inertial></link>\
                <plugin name='p'><link name='p'/><inertial><mass>9</mass></inertial></plugin><link name='b'/></model></sdf>";
    let (links, misplaced, without) = found("m.sdf", text);
    assert_eq!(links, [("a".to_owned(), 2.0)]);
    assert_eq!((misplaced, without), (1, vec!["b".to_owned()]));
    let robot = robot("m.sdf", text);
    let body =
        MassProperties::new(3.0, Vector3::zeros(), Inertia::new(Matrix3::identity()).unwrap());
    let copy = String::from_utf8(robot.copy(&[(0, body.unwrap())]).unwrap()).unwrap();
    assert_eq!(copy, text.replace("<mass>2<", "<mass>3.0<"));
}

/// The numbers that MuJoCo 4.0.0 has of these files.
#[test]
fn frames_of_mjcf_move_and_turn_what_stands_in_them() {
    let of = |inner: &str| {
        let text = format!("<mujoco><worldbody><body name='a'>{inner}</body></worldbody></mujoco>");
        *robot("a.xml", &text).links()[0].numbers().unwrap()
    };
    let outside = of(
        "<frame pos='1 0 0' euler='0 0 90'><inertial mass='2' pos='.1 0 0' diaginertia='.1 .2 .25'/></frame>",
    );
    near(&outside.mass_centre_m(), &Vector3::new(1.0, 0.1, 0.0), 1e-15);
    let turned = Matrix3::from_diagonal(&Vector3::new(0.2, 0.1, 0.25));
    near(outside.inertia().matrix(), &turned, 1e-15);
    let nested = of("<frame pos='1 0 0' euler='0 0 90'><frame pos='0 1 0' euler='90 0 0'>\
         <inertial mass='2' pos='.1 .2 .3' fullinertia='.1 .2 .25 .01 .02 .03'/></frame></frame>");
    near(&nested.mass_centre_m(), &Vector3::new(0.3, 0.1, 0.2), 1e-15);
    let axes = UnitQuaternion::new_normalize(Quaternion::new(
        -0.6761937367314481,
        0.7009687198669524,
        0.19915052581008658,
        0.10836951712920526,
    ))
    .to_rotation_matrix();
    let moments = Vector3::new(0.26704260509253935, 0.185952304227758, 0.09700509070967949);
    let expected = axes.matrix() * Matrix3::from_diagonal(&moments) * axes.matrix().transpose();
    near(nested.inertia().matrix(), &expected, 1e-8);
}

/// MuJoCo takes the last of several that stand in frames, and refuses those that do not.
#[test]
fn several_inertias_of_a_body_are_not_told() {
    let one = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
    let text = format!(
        "<mujoco><worldbody><body name='a'><frame>{one}</frame>{one}</body></worldbody></mujoco>"
    );
    let robot = robot("a.xml", &text);
    let problems: Vec<_> = robot.links().iter().map(|link| link.numbers().unwrap_err()).collect();
    assert_eq!(problems, [&LinkProblem::Several; 2]);
}

/// A pose as an MJCF file writes it.
fn poses() -> impl Strategy<Value = ([f64; 3], [f64; 4])> {
    let turn = prop::array::uniform4(-1.0..1.0)
        .prop_filter("a quaternion", |q: &[f64; 4]| q.iter().map(|x| x * x).sum::<f64>() > 0.01);
    (prop::array::uniform3(-10.0..10.0), turn)
}

fn written(([x, y, z], [a, b, c, d]): &([f64; 3], [f64; 4])) -> String {
    format!("pos='{x} {y} {z}' quat='{a} {b} {c} {d}'")
}

fn isometry(([x, y, z], [w, i, j, k]): &([f64; 3], [f64; 4])) -> Isometry3<f64> {
    let turn = UnitQuaternion::new_normalize(Quaternion::new(*w, *i, *j, *k));
    Isometry3::from_parts(Translation3::new(*x, *y, *z), turn)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// In any frames, the numbers are those of the same inertia with its pose in the body written out, and a copy has what
    /// was asked for.
    #[test]
    fn frames_are_the_pose_that_they_make(
        around in prop::collection::vec(poses(), 1..4),
        own in poses(),
        is_full in any::<bool>(),
        to in poses(),
    ) {
        // MuJoCo allows no axes beside `fullinertia`.
        let own = if is_full { (own.0, [1.0, 0.0, 0.0, 0.0]) } else { own };
        let (axes, six) = if is_full {
            (format!("pos='{} {} {}'", own.0[0], own.0[1], own.0[2]), "fullinertia='2 3 4 .1 .2 .3'")
        } else {
            (written(&own), "diaginertia='2 3 4'")
        };
        let open: String = around.iter().map(|pose| format!("<frame {}>", written(pose))).collect();
        let file = |open: &str, close: &str, at: &str, numbers: &str| format!(
            "<mujoco><worldbody><body name='a'>{open}<inertial mass='5' {at} {numbers}/>{close}</body></worldbody></mujoco>"
        );
        let framed = robot("a.xml", &file(&open, &"</frame>".repeat(around.len()), &axes, six));
        let found = framed.links()[0].numbers().unwrap();

        let pose = around.iter().map(isometry).fold(Isometry3::identity(), |all, one| all * one) * isometry(&own);
        let local = if is_full {
            Matrix3::new(2.0, 0.1, 0.2, 0.1, 3.0, 0.3, 0.2, 0.3, 4.0)
        } else {
            Matrix3::from_diagonal(&Vector3::new(2.0, 3.0, 4.0))
        };
        let turn = pose.rotation.to_rotation_matrix();
        let inertia = turn.matrix() * local * turn.matrix().transpose();
        near(&found.mass_centre_m(), &pose.translation.vector, 1e-12);
        near(found.inertia().matrix(), &inertia, 1e-12);

        let turn = isometry(&to).rotation.to_rotation_matrix();
        let other = Matrix3::from_diagonal(&Vector3::new(1.0, 1.5, 2.0));
        let other = Inertia::new(turn.matrix() * other * turn.matrix().transpose()).unwrap();
        let body = MassProperties::new(7.0, Vector3::from(to.0), other).unwrap();
        let copy = String::from_utf8(framed.copy(&[(0, body)]).unwrap()).unwrap();
        let again = robot("a.xml", &copy);
        let again = again.links()[0].numbers().unwrap();
        assert_eq!(again.mass_kg(), 7.0);
        near(&again.mass_centre_m(), &body.mass_centre_m(), 1e-12);
        near(again.inertia().matrix(), body.inertia().matrix(), 1e-12);
        // What is around the inertia is as it was.
        prop_assert!(copy.contains(&open), "{}", copy);
    }
}
