//! Robots in encodings of one byte a character: they are read and copied as in UTF-8, with the names that they have there.

use gyradius_formats::{InertiaFile, Products, Remedy, RobotFile};
use gyradius_inertia::{Inertia, MassProperties, SecondMoments};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::{prelude::*, sample::select};
use std::path::Path;

/// Encodings in which letters follow each other as they do in Unicode: name, letters, and the byte of the first.
const LETTERS: [(&str, [char; 2], u8); 5] = [
    ("ISO-8859-1", ['À', 'Ö'], 0xC0),
    ("windows-1252", ['à', 'ö'], 0xE0),
    ("Windows-1251", ['А', 'я'], 0xC0),
    ("iso-8859-5", ['А', 'я'], 0xB0),
    ("ISO-8859-7", ['α', 'ω'], 0xE1),
];

/// The bytes of a text, computed and not looked up.
fn encoded(text: &str, (_, [first, last], byte): (&str, [char; 2], u8)) -> Vec<u8> {
    let of = |c: char| {
        if c.is_ascii() {
            return u8::try_from(c).unwrap();
        }
        assert!((first..=last).contains(&c));
        byte + u8::try_from(u32::from(c) - u32::from(first)).unwrap()
    };
    text.chars().map(of).collect()
}

/// A URDF or MJCF file of links of these names, with such letters in comments and in what is around them.
fn robot(encoding: &str, names: &[String], is_mjcf: bool, mark: &str) -> String {
    let head = format!("<?xml version='1.0' encoding='{encoding}'?>");
    let links = names.iter().enumerate().map(|(i, name)| {
        let moment = 1.0 + i as f64;
        if is_mjcf {
            format!(
                "<body name=\"{name}\">{mark}<inertial mass=\"2\" pos=\"0 0 0\" {mark}=\"{mark}\" \
                 fullinertia=\"{moment} 1 1 0 0 0\"/></body>"
            )
        } else {
            format!(
                "<link name=\"{name}\"><!-- {mark} --><inertial {mark}=\"{mark}\"><mass value=\"2\"/>{mark}<inertia \
                 ixx=\"{moment}\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>\n"
            )
        }
    });
    let links: String = links.collect();
    if is_mjcf {
        format!("{head}\n<mujoco model=\"{mark}\"><worldbody>{links}</worldbody></mujoco>\n")
    } else {
        format!("{head}\n<robot name=\"{mark}\">{links}<!-- {mark} --></robot>\n")
    }
}

fn body(size: f64) -> MassProperties {
    let second = SecondMoments::new([size, 1.1 * size, 1.3 * size]).unwrap();
    let axes = UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3);
    let inertia = Inertia::from_second_moments(second, &axes).unwrap();
    MassProperties::new(size, Vector3::new(0.1 * size, 0.2, 0.3), inertia).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn robots_are_read_and_copied_as_in_utf_8(
        encoding in select(LETTERS.to_vec()),
        names in prop::collection::vec(prop::collection::vec((any::<prop::sample::Index>(), any::<bool>()), 1..6), 1..5),
        is_mjcf: bool,
        sizes in prop::collection::vec(0.01..1e3_f64, 5),
    ) {
        let (first, last) = (u32::from(encoding.1[0]), u32::from(encoding.1[1]));
        let letter = |index: &prop::sample::Index| {
            char::from_u32(first + u32::try_from(index.index((last - first + 1) as usize)).unwrap()).unwrap()
        };
        let name = |letters: &Vec<(prop::sample::Index, bool)>| -> String {
            letters.iter().map(|(index, plain)| if *plain { 'a' } else { letter(index) }).collect()
        };
        let names: Vec<String> = names.iter().map(name).collect();
        let mark: String = encoding.1.iter().chain(&['x']).collect();
        let text = robot(encoding.0, &names, is_mjcf, &mark);
        let bytes = encoded(&text, encoding);
        prop_assert!(std::str::from_utf8(&bytes).is_err());
        let path = Path::new(if is_mjcf { "a.xml" } else { "a.urdf" });
        let [plain, narrow] = [text.clone().into_bytes(), bytes].map(|bytes| RobotFile::parse(path, bytes).unwrap());
        prop_assert_eq!(plain.links().len(), names.len());
        let distinct: std::collections::HashSet<_> = names.iter().collect();
        for (i, (one, other)) in plain.links().iter().zip(narrow.links()).enumerate() {
            prop_assert_eq!(one.name(), other.name());
            prop_assert_eq!(one.numbers(), other.numbers());
            prop_assert!(distinct.len() < names.len() || other.name() == names[i]);
        }
        let changed: Vec<_> = (0..names.len()).map(|i| (i, body(sizes[i]))).collect();
        let copy = String::from_utf8(plain.copy(&changed).unwrap()).unwrap();
        prop_assert!(copy != text);
        prop_assert_eq!(narrow.copy(&changed).unwrap(), encoded(&copy, encoding));
        // And a repair, of the first link, whose moment of 1 becomes one of 9.
        let wrong = text.replace("\"1 1 1 ", "\"9 1 1 ").replace("ixx=\"1\"", "ixx=\"9\"");
        let [plain, narrow] = [wrong.clone().into_bytes(), encoded(&wrong, encoding)].map(|bytes| {
            InertiaFile::parse(path, bytes, Products::default()).unwrap().repaired(&[(0, Remedy::Nearest)]).unwrap()
        });
        prop_assert!(plain != wrong.as_bytes());
        prop_assert_eq!(narrow, encoded(std::str::from_utf8(&plain).unwrap(), encoding));
    }
}
