//! What links are called: those with an inertia, what stands beside it, and those without.

use gyradius_formats::{LinkProblem, RobotFile, RobotLink, WithoutInertia};
use proptest::{prelude::*, sample::select};
use std::path::Path;

/// What a robot file may hold under a name.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// A link with an inertia.
    One,
    /// With two of them.
    Two,
    /// With one that a macro may leave out.
    Perhaps,
    /// A link without one.
    Without,
    /// One whose inertia the simulator computes.
    Computed,
    /// An inertia for Gazebo in a block that refers to the link, or in a link there.
    Gazebo,
    GazeboLink,
    /// A link there without an inertia.
    GazeboEmpty,
    /// An element of which MuJoCo makes bodies.
    Made,
    /// One that adds to a body that is there.
    Rigid,
}
use Kind::{Computed, Gazebo, GazeboEmpty, GazeboLink, Made, One, Perhaps, Rigid, Two, Without};

type Item = (&'static str, Kind);

const URDF: [Kind; 7] = [One, Two, Perhaps, Without, Gazebo, GazeboLink, GazeboEmpty];
const MJCF: [Kind; 4] = [One, Without, Made, Rigid];
const SDF: [Kind; 4] = [One, Two, Without, Computed];

fn xml(format: &str, items: &[Item]) -> String {
    let sdf = "<inertial><mass>2</mass></inertial>";
    let inertial = match format {
        "xacro" => {
            "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>"
        }
        "xml" => "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>",
        _ => sdf,
    };
    let element = if format == "xml" { "body" } else { "link" };
    let one = |(name, kind): &Item| {
        // Without a name is not quite an empty one.
        let named = |key: &str| {
            if *name == "-" { String::new() } else { format!(" {key}='{name}'") }
        };
        let link = |inside: &str| format!("<{element}{}>{inside}</{element}>", named("name"));
        match kind {
            One => link(inertial),
            Two => link(&inertial.repeat(2)),
            Perhaps => link(&format!("<xacro:if value='${{x}}'>{inertial}</xacro:if>")),
            Without => link(""),
            Computed => link("<inertial auto='true'/>"),
            Gazebo => format!("<gazebo{}>{sdf}</gazebo>", named("reference")),
            GazeboLink => format!("<gazebo>{}</gazebo>", link(sdf)),
            GazeboEmpty => format!("<gazebo>{}</gazebo>", link("")),
            Made => format!("<flexcomp{}/>", named("name")),
            Rigid => format!("<flexcomp rigid='true'{}/>", named("name")),
        }
    };
    let inside: String = items.iter().map(one).collect();
    match format {
        "xacro" => format!("<robot xmlns:xacro='http://ros.org/wiki/xacro'>{inside}</robot>"),
        "xml" => format!("<mujoco><worldbody>{inside}</worldbody></mujoco>"),
        _ => format!("<sdf version='1.11'><model name='m'>{inside}</model></sdf>"),
    }
}

fn robot(format: &str, items: &[Item]) -> RobotFile {
    let name = format!("r.{format}");
    RobotFile::parse(Path::new(&name), xml(format, items).into_bytes()).unwrap()
}

/// What a name is called, and what it was told apart by.
fn written(name: &str) -> &str {
    name.split_once('#').map_or(name, |(written, _)| written)
}

fn called(name: &str) -> &str {
    if ["", "-"].contains(&name) { "unnamed" } else { name }
}

fn items() -> impl Strategy<Value = (&'static str, Vec<Item>)> {
    let of = |format: &'static str, kinds: &'static [Kind]| {
        let item = (select(vec!["a", "b", "", "-", "unnamed"]), select(kinds));
        prop::collection::vec(item, 0..12).prop_map(move |items| (format, items))
    };
    prop_oneof![of("xacro", &URDF), of("xml", &MJCF), of("sdf", &SDF)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Links keep their names, on which their draws depend, whatever stands beside them and wherever; and every link is
    /// listed once.
    #[test]
    fn links_are_called_what_they_are_without_all_else((format, items) in items()) {
        let file = robot(format, &items);
        let own: Vec<Item> = items
            .iter()
            .filter(|(_, kind)| [One, Two, Perhaps].contains(kind))
            .map(|(name, _)| (*name, One))
            .collect();
        let alone = robot(format, &own);
        let names: Vec<&str> = alone.links().iter().map(RobotLink::name).collect();
        let found: Vec<&str> =
            file.links().iter().filter(|link| link.numbers().is_ok()).map(RobotLink::name).collect();
        prop_assert_eq!(&names, &found, "{}", xml(format, &items));
        for ((name, _), found) in own.iter().zip(&names) {
            prop_assert_eq!(called(name), written(found));
        }
        // What has no numbers is called as the link for which it stands.
        let mut last = "";
        let mut expected = own.iter().zip(&names);
        let mut links = file.links().iter();
        for (name, kind) in &items {
            if [One, Two, Perhaps].contains(kind) {
                last = expected.next().unwrap().1;
                prop_assert_eq!(links.next().unwrap().name(), last);
            }
            let beside = match kind {
                Two => Some((last, LinkProblem::Second)),
                Gazebo | GazeboLink => Some((called(name), LinkProblem::Gazebo)),
                One | Perhaps | Without | Computed | GazeboEmpty | Made | Rigid => None,
            };
            if let Some((name, problem)) = beside {
                let link = links.next().unwrap();
                prop_assert_eq!((link.name(), link.numbers().unwrap_err()), (name, &problem));
                prop_assert!(problem.is_beside());
            }
        }
        prop_assert!(links.next().is_none());
        // Every link without an inertia is listed, by a name that no other has.
        let without: Vec<&str> = items
            .iter()
            .filter(|(_, kind)| [Without, Computed, Made].contains(kind))
            .map(|(name, _)| called(name))
            .collect();
        let listed = file.links_without_inertia();
        prop_assert_eq!(&without, &listed.iter().map(|name| written(name)).collect::<Vec<_>>());
        let kinds = items.iter().map(|(_, kind)| kind).filter(|kind| [Without, Computed, Made].contains(kind));
        for (kind, name) in kinds.zip(listed) {
            let is_computed = file.why_without(name) == WithoutInertia::Computed;
            prop_assert_eq!(is_computed, *kind == Computed, "{}", name);
        }
        for (i, name) in listed.iter().enumerate() {
            prop_assert!(!names.contains(&name.as_str()) && !listed[..i].contains(name), "{}", name);
        }
    }

    /// Names may be written as others are told apart.
    #[test]
    fn no_name_is_that_of_two_links(
        items in prop::collection::vec(("(a|b)?#{0,3}2?", any::<bool>()), 1..9),
    ) {
        let link = |(name, has_one): &(String, bool)| {
            format!("<link name='{name}'>{}</link>", if *has_one { "<inertial/>" } else { "" })
        };
        let text = format!("<sdf>{}</sdf>", items.iter().map(link).collect::<String>());
        let file = RobotFile::parse(Path::new("a.sdf"), text.into_bytes()).unwrap();
        let with = file.links().iter().map(|link| link.name().to_owned());
        let mut all: Vec<String> = with.chain(file.links_without_inertia().iter().cloned()).collect();
        prop_assert_eq!(all.len(), items.len());
        all.sort_unstable();
        all.dedup();
        prop_assert_eq!(all.len(), items.len(), "{:?}", items);
    }
}
