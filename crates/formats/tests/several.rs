//! Elements of a link that stand more than once: no reader says which counts, and none is taken without a word.

use gyradius_formats::{
    FileBodyError, GeometryProblem, InertiaFile, LinkProblem, Products, RobotFile,
};
use proptest::prelude::*;
use std::path::Path;

/// Elements of an inertia and of a collision, and whether those of an inertia matter to all that read it, or to frames alone.
const URDF: [(&str, &str, bool); 3] = [
    ("origin", "<origin xyz='0.1 0 0'/>", false),
    ("mass", "<mass value='2'/>", true),
    ("inertia", "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>", true),
];
const SDF: [(&str, &str, bool); 3] = [
    ("pose", "<pose>0.1 0 0 0 0 0</pose>", false),
    ("mass", "<mass>2</mass>", true),
    ("inertia", "<inertia><ixx>1</ixx></inertia>", true),
];
const SHAPES: [(&str, &str); 3] = [
    ("box", "<box size='1 1 1'><size>1 1 1</size></box>"),
    ("sphere", "<sphere radius='1'><radius>1</radius></sphere>"),
    ("x:capsule", "<x:capsule radius='1' length='1'/>"),
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn what_stands_more_than_once_is_refused(
        is_sdf in any::<bool>(),
        counts in [1_usize..3, 1..3, 1..3],
        shapes in prop::collection::vec(0..SHAPES.len(), 0..3),
        geometries in 1_usize..3,
    ) {
        let elements = if is_sdf { SDF } else { URDF };
        let inertial: String =
            elements.iter().zip(counts).map(|((_, text, _), count)| text.repeat(count)).collect();
        let inside: String = shapes.iter().map(|i| SHAPES[*i].1).collect();
        let geometry = format!("<geometry>{inside}</geometry>").repeat(geometries);
        let link = format!(
            "<link name='a'><inertial>{inertial}</inertial><collision>{geometry}</collision></link>"
        );
        let (name, text) = if is_sdf {
            ("a.sdf", format!("<sdf version='1.9'><model name='m'>{link}</model></sdf>"))
        } else {
            ("a.urdf", format!("<robot>{link}</robot>"))
        };
        let file = InertiaFile::parse(Path::new(name), text.clone().into_bytes(), Products::default());
        let robot = RobotFile::parse(Path::new(name), text.clone().into_bytes()).unwrap();
        let twice = |to_all: bool| {
            let twice = elements.iter().zip(counts).filter(|((.., all), count)| *count > 1 && (*all || !to_all));
            twice.map(|((name, ..), _)| *name).collect::<Vec<_>>()
        };
        match file.unwrap().bodies()[0].inertia() {
            Ok(_) => prop_assert!(twice(true).is_empty(), "{text}"),
            Err(FileBodyError::Several { element }) => prop_assert!(twice(true).contains(&element), "{text}"),
            Err(other) => prop_assert!(false, "{other} of {text}"),
        }
        match robot.links()[0].numbers() {
            Ok(_) => prop_assert!(twice(false).is_empty(), "{text}"),
            Err(problem @ LinkProblem::Body(FileBodyError::Several { element })) => {
                prop_assert!(twice(false).contains(element) && problem.is_a_slip(), "{text}");
            }
            Err(other) => prop_assert!(false, "{other} of {text}"),
        }
        match robot.points_m(0) {
            Ok(_) => prop_assert!(geometries == 1 && shapes.len() == 1, "{text}"),
            Err(GeometryProblem::Several { first, second }) => {
                let plain = |i: usize| SHAPES[shapes[i]].0.trim_start_matches("x:");
                prop_assert!(shapes.len() == 2 && first == plain(0) && second == plain(1), "{text}");
            }
            Err(GeometryProblem::Empty { .. }) => prop_assert!(shapes.is_empty(), "{text}"),
            Err(GeometryProblem::Link(LinkProblem::Body(FileBodyError::Several { element }))) => {
                prop_assert!(element == "geometry" && geometries > 1, "{text}");
            }
            Err(other) => prop_assert!(false, "{other} of {text}"),
        }
    }
}

#[test]
fn an_entry_of_sdf_stands_once() {
    let text = "<sdf version='1.9'><link name='a'><inertial><inertia><ixx>1</ixx><ixx>2</ixx></inertia></inertial></link></sdf>";
    let file = InertiaFile::parse(Path::new("a.sdf"), text.into(), Products::default()).unwrap();
    assert_eq!(file.bodies()[0].inertia().unwrap_err(), FileBodyError::Several { element: "ixx" });
}
