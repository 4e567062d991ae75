//! Inertias of which a macro of xacro may give a part: what is missing then is known to nobody before the file is expanded.

use gyradius_formats::{GapKind, InertiaFile, LinkProblem, Products, RobotFile};
use proptest::{prelude::*, sample::select};
use std::path::Path;

/// What a part of an inertia is: there, made by a macro in its place, there but for what a macro in it gives, or left out.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    There,
    InPlace,
    Inside,
    LeftOut,
}
use Part::{InPlace, Inside, LeftOut, There};

/// A macro: the form that is called, one that gives a block, and one that gives an attribute.
const MACROS: [&str; 4] = [
    "<xacro:any/>",
    "<xacro:insert_block name='origin'/>",
    "<xacro:if value='${x}'><other/></xacro:if>",
    "<insert_block name='origin'/>",
];

/// Pose, mass and inertia, whole and but for what a macro gives.
fn parts(format: &str) -> [[&'static str; 3]; 3] {
    match format {
        "xacro" => [
            ["<origin xyz='1 2 3'/>", "<origin rpy='0 0 0'>", "</origin>"],
            ["<mass value='2'/>", "<mass>", "</mass>"],
            [
                "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>",
                "<inertia ixx='1'>",
                "</inertia>",
            ],
        ],
        _ => [
            ["<pose>1 2 3 0 0 0</pose>", "<pose>", "</pose>"],
            ["<mass>2</mass>", "<mass>", "</mass>"],
            [
                "<inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>",
                "<inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz>",
                "</inertia>",
            ],
        ],
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// No number is taken for one that a macro may give; what is there is read, and the pose does not matter to a check.
    #[test]
    fn no_number_stands_for_one_that_a_macro_may_give(
        format in select(vec!["xacro", "sdf"]),
        states in prop::array::uniform3(select(vec![There, InPlace, Inside, LeftOut])),
        one in select(&MACROS[..]),
        in_collision in any::<bool>(),
    ) {
        let mut inside = String::new();
        for ([whole, open, close], state) in parts(format).into_iter().zip(states) {
            inside += &match state {
                There => whole.to_owned(),
                InPlace => one.to_owned(),
                Inside => format!("{open}{one}{close}"),
                LeftOut => String::new(),
            };
        }
        let link = format!("<link name='a'><inertial>{inside}</inertial></link>");
        let text = match format {
            "xacro" => format!("<robot xmlns:xacro='http://ros.org/wiki/xacro'>{link}</robot>"),
            _ => format!("<sdf version='1.9' xmlns:xacro='http://ros.org/wiki/xacro'><model name='m'>{link}</model></sdf>"),
        };
        let name = format!("r.{format}");
        let file = InertiaFile::parse(Path::new(&name), text.clone().into_bytes(), Products::default()).unwrap();
        let robot = RobotFile::parse(Path::new(&name), text.clone().into_bytes()).unwrap();
        let is_given = |state: &Part| matches!(state, InPlace | Inside);
        let has_macros = states.iter().any(is_given);
        let said = file.gaps().iter().any(|gap| gap.kind() == GapKind::Macros);
        prop_assert_eq!(said, has_macros, "{}", text);
        let [pose, mass, inertia] = states;
        let is_open = |state: Part| match state {
            There => false,
            InPlace | Inside => true,
            // Another part may come of the same macro.
            LeftOut => has_macros,
        };
        if is_open(mass) || is_open(inertia) {
            // What stands there but for a macro is no number to anybody, and what is missing is none that is guessed.
            prop_assert!(file.bodies().iter().all(|body| body.inertia().is_err()), "{}", text);
            prop_assert!(robot.links().iter().all(|link| link.numbers().is_err()), "{}", text);
            return Ok(());
        }
        let is_told = mass == There && inertia == There || format == "sdf";
        prop_assert_eq!(file.bodies().iter().all(|body| body.inertia().is_ok()), is_told, "{}", text);
        let found = robot.links()[0].numbers();
        match (is_told, is_open(pose)) {
            (false, _) => prop_assert!(matches!(found, Err(LinkProblem::Body(_))), "{}", text),
            (true, true) => prop_assert_eq!(found.unwrap_err(), &LinkProblem::Macro, "{}", text),
            (true, false) => {
                let centre = found.unwrap().mass_centre_m();
                prop_assert_eq!(centre.x, if pose == There { 1.0 } else { 0.0 }, "{}", text);
            }
        }
        // A shape, too, is where a macro may put it.
        if in_collision && format == "xacro" {
            let whole = "<mass value='2'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>";
            let origin = match pose {
                There => "<origin xyz='1 2 3'/>".to_owned(),
                InPlace => one.to_owned(),
                Inside => format!("<origin rpy='0 0 0'>{one}</origin>"),
                LeftOut => String::new(),
            };
            let text = format!(
                "<robot xmlns:xacro='http://ros.org/wiki/xacro'><link name='a'><inertial>{whole}</inertial><collision>{origin}\
                 <geometry><box size='1 1 1'/></geometry></collision></link></robot>"
            );
            let robot = RobotFile::parse(Path::new(&name), text.clone().into_bytes()).unwrap();
            prop_assert_eq!(robot.points_m(0).is_err(), is_given(&pose), "{}", text);
        }
    }

    /// In MJCF, attributes say all of it.
    #[test]
    fn attributes_that_a_macro_may_give_are_not_taken_for_zero(there in any::<[bool; 4]>(), has_macro in any::<bool>()) {
        let [pos, mass, moments, quat] = there;
        let said = |is_there, text: &'static str| if is_there { text } else { "" };
        let one = said(has_macro, "<xacro:attribute name='quat' value='1 1 0 0'/>");
        let text = format!(
            "<mujoco xmlns:xacro='http://ros.org/wiki/xacro'><worldbody><body name='a'><inertial{}{}{}{}>{one}</inertial></body>\
             </worldbody></mujoco>",
            said(pos, " pos='1 0 0'"),
            said(mass, " mass='1'"),
            said(moments, " diaginertia='1 2 2.5'"),
            said(quat, " quat='1 0 0 0'"),
        );
        let robot = RobotFile::parse(Path::new("a.xml"), text.clone().into_bytes()).unwrap();
        let found: Vec<_> = robot.links().iter().map(gyradius_formats::RobotLink::numbers).collect();
        match (has_macro, mass && moments) {
            (true, false) => prop_assert!(found.is_empty(), "{}", text),
            (true, true) => prop_assert_eq!(found, [Err(&LinkProblem::Macro)], "{}", text),
            (false, _) => prop_assert_eq!(found[0].is_ok(), mass, "{}", text),
        }
    }
}
