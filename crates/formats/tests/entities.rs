//! References to entities of a file's own, in attributes and in texts: what they stand for is not known, and every one is told.

use gyradius_formats::{Gap, GapKind, InertiaFile, Products};
use proptest::{prelude::*, sample::select};
use std::path::Path;

const FILES: [(&str, &str); 3] = [
    (
        "r.urdf",
        "<robot name=\"r\"><link name=\"a\"><inertial><origin xyz='0 0 1' rpy=\"0 0 0\"/><mass value='2'/>\
         <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>",
    ),
    (
        "r.xml",
        "<mujoco><compiler angle=\"radian\"/><worldbody><body name='a'><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>\
         </body></worldbody></mujoco>",
    ),
    (
        "r.sdf",
        "<sdf version='1.9'><model name='m'><link name='a'><inertial><pose degrees=\"false\">0 0 1 0 0 0</pose><mass>2</mass>\
         </inertial></link></model></sdf>",
    ),
];

/// Places in the values of attributes and in texts, where something more can stand.
fn places(text: &str) -> Vec<usize> {
    let (mut found, mut in_tag, mut quote) = (Vec::new(), false, None);
    for (at, c) in text.char_indices() {
        match (quote, in_tag, c) {
            (None, true, '\'' | '"') => quote = Some(c),
            (Some(open), ..) => {
                found.push(at);
                if c == open {
                    quote = None;
                }
            }
            (None, false, '<') => in_tag = true,
            (None, true, '>') => in_tag = false,
            (None, true, _) => {}
            // A text is one after a character of it.
            (None, false, _) => found.push(at),
        }
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn every_reference_to_an_entity_of_a_file_is_an_error(
        (name, text) in select(&FILES[..]),
        puts in prop::collection::vec(
            (any::<prop::sample::Index>(), select(vec![
                ("&arm;", true), ("&m_1.b-c;", true), ("&_;", true), ("&\u{e9};", true), ("&lt;", false), ("&#49;", false),
                ("&#x31;", false), ("&apos;", false), ("1", false),
            ])),
            1..5,
        ),
    ) {
        let all = places(text);
        let mut puts: Vec<_> = puts.iter().map(|(at, put)| (*at.get(&all), *put)).collect();
        puts.sort_by_key(|(at, _)| std::cmp::Reverse(*at));
        let mut text = text.to_owned();
        for (at, (put, _)) in &puts {
            text.insert_str(*at, put);
        }
        let expected = puts.iter().filter(|(_, (_, is_entity))| *is_entity).count();
        let declared = format!("<!DOCTYPE r [<!ENTITY arm \"2\">]>{text}");
        let file = InertiaFile::parse(Path::new(name), declared.into_bytes(), Products::default()).unwrap();
        let gap = file.gaps().iter().find(|gap| gap.kind() == GapKind::Entities);
        prop_assert_eq!(gap.map_or(0, Gap::count), expected, "{}", text);
        prop_assert!(gap.is_none_or(Gap::is_error));
    }

    /// An `&` alone is none, as in addresses that are written without care.
    #[test]
    fn an_ampersand_in_an_attribute_is_no_reference(
        value in select(vec!["a&b", "a=1&b=2;", "& ;", "&;", "a;&b", "&1;", "&a b;"]),
    ) {
        let text = format!("<robot name='{value}'><link name='a'/></robot>");
        let file = InertiaFile::parse(Path::new("r.urdf"), text.into_bytes(), Products::default()).unwrap();
        prop_assert_eq!(file.gaps(), []);
    }
}

#[test]
fn the_line_is_that_of_the_reference() {
    let text = "<mujoco>\n<compiler\n angle='radian'\n inertiafromgeom='&u;'/></mujoco>";
    let file =
        InertiaFile::parse(Path::new("r.xml"), text.as_bytes().to_vec(), Products::default())
            .unwrap();
    let found: Vec<_> =
        file.gaps().iter().map(|gap| (gap.kind(), gap.line(), gap.count())).collect();
    assert_eq!(found, [(GapKind::Entities, 4, 1)]);
}
