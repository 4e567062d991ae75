//! Elements with a prefix of their own beside those of the format: no reader takes them for those.

use gyradius_formats::{GapKind, InertiaFile, Products, RobotFile};
use gyradius_inertia::{Inertia, MassProperties};
use nalgebra::{Matrix3, Vector3};
use proptest::{prelude::*, sample::select};
use std::path::Path;

/// An element by its name, what stands in its tag, and what in it.
fn element(prefix: &str, name: &str, attributes: &str, inside: &str) -> String {
    format!("<{prefix}{name}{attributes}>{inside}</{prefix}{name}>")
}

/// The parts of an inertia of a mass, a mass centre and a first moment.
fn parts(format: &str, prefix: &str, [mass, centre, moment]: [f64; 3]) -> Vec<String> {
    match format {
        "urdf" => vec![
            element(prefix, "origin", &format!(" xyz='{centre} 0 0'"), ""),
            element(prefix, "mass", &format!(" value='{mass}'"), ""),
            element(
                prefix,
                "inertia",
                &format!(" ixx='{moment}' ixy='0' ixz='0' iyy='2' iyz='0' izz='2'"),
                "",
            ),
        ],
        _ => {
            let entries = [("ixx", moment), ("iyy", 2.0), ("izz", 2.0)];
            let entries = entries.map(|(name, x)| element(prefix, name, "", &x.to_string()));
            vec![
                element(prefix, "pose", "", &format!("{centre} 0 0 0 0 0")),
                element(prefix, "mass", "", &mass.to_string()),
                element(prefix, "inertia", "", &entries.concat()),
            ]
        }
    }
}

fn inertial(format: &str, prefix: &str, numbers: [f64; 3], more: &[String; 2]) -> String {
    let [before, after] = more;
    let inside = match format {
        "xml" => {
            let [mass, centre, moment] = numbers;
            let at = format!(" pos='{centre} 0 0' mass='{mass}' diaginertia='{moment} 2 2'");
            return element(prefix, "inertial", &at, &[before.as_str(), after].concat());
        }
        _ => parts(format, prefix, numbers).concat(),
    };
    element(prefix, "inertial", "", &format!("{before}{inside}{after}"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    /// Checked with urdfdom 6.0.0 and the SDFormat of Drake 1.51.1, which pass over such elements, and MuJoCo 4.0.0, which
    /// refuses them.
    #[test]
    fn somebodys_own_elements_are_no_parts_of_an_inertia(
        format in select(vec!["urdf", "xml", "sdf"]),
        // That of the root: elements with it, and without any, are those of the format.
        own in select(vec!["", "r:"]),
        is_prefixed in any::<bool>(),
        foreign in select(vec!["my:", "x.y:"]),
        // Where the foreign elements stand: parts before and after those of the inertia, and whole ones around it.
        inside in prop::array::uniform2(prop::sample::subsequence(vec![0_usize, 1, 2], 0..=3)),
        around in any::<[bool; 2]>(),
        has_one in any::<bool>(),
    ) {
        let p = if is_prefixed { own } else { "" };
        let others = parts(format, foreign, [7.0, 0.7, 3.0]);
        let more = inside.map(|some| some.into_iter().map(|i| others[i].clone()).collect::<String>());
        let whole = inertial(format, foreign, [7.0, 0.7, 3.0], &Default::default());
        let [before, after] = around.map(|is_there| if is_there { whole.as_str() } else { "" });
        let real = if has_one { inertial(format, p, [2.0, 0.25, 1.5], &more) } else { String::new() };
        let (root, link) = match format {
            "urdf" => ("robot", "link"),
            "xml" => ("mujoco", "body"),
            _ => ("sdf", "link"),
        };
        let link = element(p, link, " name='a'", &format!("{before}{real}{after}"));
        let version = if format == "sdf" { " version='1.9'" } else { "" };
        let text = element(own, root, version, &link);
        let name = format!("r.{format}");
        let robot = RobotFile::parse(Path::new(&name), text.clone().into_bytes()).unwrap();
        let file = InertiaFile::parse(Path::new(&name), text.clone().into_bytes(), Products::default());
        let masses: Vec<_> =
            file.unwrap().bodies().iter().map(gyradius_formats::FileBody::mass_kg).collect();
        let misplaced = robot.gaps().iter().find(|gap| gap.kind() == GapKind::Misplaced);
        let expected = around.into_iter().filter(|is_there| *is_there).count();
        prop_assert_eq!(misplaced.map_or(0, gyradius_formats::Gap::count), expected, "{}", text);
        if !has_one {
            prop_assert!(robot.links().is_empty() && masses.is_empty(), "{}", text);
            prop_assert_eq!(robot.links_without_inertia(), ["a"], "{}", text);
            return Ok(());
        }
        prop_assert_eq!(masses, [Some(2.0)], "{}", text);
        prop_assert_eq!(robot.links().len(), 1, "{}", text);
        let numbers = robot.links()[0].numbers().unwrap();
        prop_assert_eq!(numbers.mass_kg(), 2.0, "{}", text);
        prop_assert_eq!(numbers.mass_centre_m(), Vector3::new(0.25, 0.0, 0.0), "{}", text);
        prop_assert_eq!(numbers.inertia().entries(), [1.5, 2.0, 2.0, 0.0, 0.0, 0.0], "{}", text);
        let inertia = Inertia::new(Matrix3::from_diagonal_element(1.0)).unwrap();
        let meant = MassProperties::new(4.0, Vector3::new(0.5, 0.0, 0.0), inertia).unwrap();
        let copy = String::from_utf8(robot.copy(&[(0, meant)]).unwrap()).unwrap();
        for other in others.iter().chain([&whole]) {
            prop_assert_eq!(text.matches(other.as_str()).count(), copy.matches(other.as_str()).count(), "{}", copy);
        }
    }
}
