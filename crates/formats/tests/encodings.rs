//! Robots and tables in encodings of one byte a character: they are read and copied as in UTF-8, with the names that they have there.

use gyradius_formats::{InertiaFile, PartsTable, Products, Remedy, RobotFile, TenTable};
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

/// Something of Latin-1, as it stands in units and in other texts.
const MARKS: [&str; 12] = ["", "µ", "½", "²", "³", "·", "×", "é", "?", "\u{a0}", "±", "k"];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// `µg` was read as g in Latin-1, whose µ was a mark like any other.
    #[test]
    fn tables_are_read_and_copied_as_in_utf_8(
        marks in prop::array::uniform5(select(&MARKS[..])),
        of_unit in prop::array::uniform5(any::<bool>()),
        name in prop::collection::vec(0xA0_u8..=0xFF, 0..6),
        moment in select(&["3", "9"][..]),
    ) {
        let [mass, inertia, between, square, title] = std::array::from_fn(|i| match (of_unit[i], i) {
            (true, 2) => "·",
            (true, 3) => "²",
            (true, _) => "",
            (false, _) => marks[i],
        });
        let name: String = name.into_iter().map(char::from).collect();
        let text = format!(
            "# é {title}\nname,mass [{mass}kg],cx,cy,cz,ixx [{inertia}kg{between}m{square}],iyy,izz,note\n\
             {name},1,0,0,0,2,4,{moment},{title}\n"
        );
        let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
        prop_assert!(std::str::from_utf8(&latin).is_err());
        let [plain, narrow] = [text.clone().into_bytes(), latin.clone()].map(|bytes| {
            let list = PartsTable::read(&bytes, None).map_err(|error| error.to_string());
            let file = InertiaFile::parse(Path::new("a.csv"), bytes, Products::default());
            (list, file.map_err(|error| error.to_string()))
        });
        prop_assert_eq!(&plain.0, &narrow.0, "{}", text);
        let (Ok(plain), Ok(narrow)) = (&plain.1, &narrow.1) else {
            prop_assert_eq!(plain.1.err(), narrow.1.err(), "{}", text);
            return Ok(());
        };
        prop_assert_eq!(plain.bodies().len(), narrow.bodies().len());
        for (one, other) in plain.bodies().iter().zip(narrow.bodies()) {
            prop_assert_eq!((one.name(), one.mass_kg(), one.inertia()), (other.name(), other.mass_kg(), other.inertia()), "{}", text);
        }
        let [one, other] = [plain, narrow].map(|file| TenTable::of(file).map(|ten| format!("{:?}", ten.rows().first().map(|row| row.values()))));
        prop_assert_eq!(one.map_err(|e| e.to_string()), other.map_err(|e| e.to_string()));
        // What is repaired is the same in both, and the rest of the bytes stay.
        let [plain, narrow] = [plain, narrow].map(|file| file.repaired(&[(0, Remedy::Nearest)]).map_err(|e| e.to_string()));
        let plain = plain.map(|copy| String::from_utf8(copy).unwrap().chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect::<Vec<u8>>());
        prop_assert_eq!(plain, narrow);
    }
}

/// Nothing beside a dot, a blank and a square may stand in a unit of Latin-1.
#[test]
fn units_of_latin_1_hold_what_they_say() {
    for byte in 0x80..=0xFF_u8 {
        let read = |before: &[u8], unit: [&[u8]; 3]| {
            let table =
                [b"ixx [", before, unit[0], unit[1], unit[2], b"],iyy,izz\n2,2,2\n"].concat();
            InertiaFile::parse(Path::new("a.csv"), table, Products::default()).is_ok()
        };
        let one = [byte];
        // The blank, the dot and the cross.
        let is_between = [0xA0, 0xB7, 0xD7].contains(&byte);
        assert_eq!(read(b"", [b"kg", &one, b"m2"]), is_between, "{byte:x}");
        assert_eq!(read(&one, [b"kg", b" ", b"m2"]), is_between, "{byte:x}");
        assert_eq!(read(b"", [b"kg", b" m", &one]), byte == 0xB2, "{byte:x}");
    }
}
