//! Random bodies, written in every format and dressed in every way that files come in: each is read with
//! its numbers, or its file says that something in it was not read.

use gyradius_formats::{Bearing, InertiaFile, Products};
use proptest::{prelude::*, sample::select};
use std::{fmt::Write, path::Path};

/// Mass, and ixx, iyy, izz, ixy, ixz, iyz.
type Numbers = (f64, [f64; 6]);

const NAMES: [&str; 6] = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Style {
    Urdf,
    Mjcf,
    Sdf,
    /// Attributes, as in SDFormat 1.0.
    SdfAttributes,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Entity {
    None,
    /// The first body is the entity.
    Body,
    /// The mass of the first body is.
    Number,
    /// A digit is written by its number, which is no entity of the file.
    Digit,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Utf8,
    Mark,
    Latin,
    Utf16Little,
    Utf16Big,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Gazebo {
    None,
    /// The first body stands in a link in a block for Gazebo.
    Link,
    /// It stands in a block that refers to its link.
    Reference,
    /// It stands among the settings of a plugin.
    Plugin,
}

#[derive(Clone, Debug)]
struct Dress {
    style: Style,
    root: &'static str,
    prefix: &'static str,
    extension: &'static str,
    version: &'static str,
    entity: Entity,
    encoding: Encoding,
    gazebo: Gazebo,
    crlf: bool,
    comments: bool,
}

fn dress() -> impl Strategy<Value = Dress> {
    use Style::{Mjcf, Sdf, SdfAttributes, Urdf};
    let names = (
        select(vec![Urdf, Mjcf, Sdf, SdfAttributes]),
        select(vec!["", "", "model", "world", "part", "mujocoinclude", "r-b.1"]),
        select(vec!["", "", "", "r:", "my.ns:"]),
        select(vec![".xml", ".own", "", ".XML"]),
        select(vec!["", " version='1.0'", " version='1.7'"]),
    );
    let dress = (
        select(vec![Entity::None, Entity::None, Entity::Body, Entity::Number, Entity::Digit]),
        select(vec![
            Encoding::Utf8,
            Encoding::Mark,
            Encoding::Latin,
            Encoding::Utf16Little,
            Encoding::Utf16Big,
        ]),
        select(vec![Gazebo::None, Gazebo::Link, Gazebo::Reference, Gazebo::Plugin]),
        any::<bool>(),
        any::<bool>(),
    );
    (names, dress).prop_map(
        |(
            (style, root, prefix, extension, version),
            (entity, encoding, gazebo, crlf, comments),
        )| {
            let own = match style {
                Urdf => ("robot", ".urdf"),
                Mjcf => ("mujoco", ".mjcf"),
                Sdf | SdfAttributes => ("sdf", ".sdf"),
            };
            // The first takes a root that has a meaning of its own.
            let root = match (root, style) {
                ("", _) => own.0,
                ("mujocoinclude", Urdf | Sdf | SdfAttributes) => "include-d",
                (root, _) => root,
            };
            let extension = if extension == ".own" { own.1 } else { extension };
            let gazebo = if style == Urdf && root == "robot" { gazebo } else { Gazebo::None };
            let entity = if gazebo == Gazebo::None { entity } else { Entity::None };
            Dress {
                style,
                root,
                prefix,
                extension,
                version,
                entity,
                encoding,
                gazebo,
                crlf,
                comments,
            }
        },
    )
}

fn numbers() -> impl Strategy<Value = Vec<Numbers>> {
    let size = -6.0..6.0_f64;
    let body = (0.001..1e3_f64, prop::array::uniform6(-9.0..9.0_f64), size)
        .prop_map(|(mass, six, size)| (mass, six.map(|x| x * 10_f64.powf(size))));
    prop::collection::vec(body, 1..4)
}

/// The element of one inertia.
fn inertial(style: Style, prefix: &str, (mass, six): &Numbers) -> String {
    let [xx, yy, zz, xy, xz, yz] = six;
    let p = prefix;
    match style {
        Style::Urdf => format!(
            "<{p}inertial>\n<{p}mass value='{mass}'/><{p}inertia ixx='{xx:e}' ixy=\"{xy:e}\" ixz='{xz}' \
             iyy='{yy}' iyz='{yz}' izz='{zz:e}'/></{p}inertial>"
        ),
        Style::Mjcf => format!(
            "<{p}inertial pos='0 0 0' mass='{mass}' fullinertia='{xx} {yy:e} {zz} {xy} {xz} {yz:e}'/>"
        ),
        Style::Sdf => {
            let entry = |i: usize| format!("<{p}{0}> {1:e}\n</{p}{0}>", NAMES[i], six[i]);
            format!(
                "<{p}inertial><{p}mass>{mass}</{p}mass>\n<{p}inertia>{}</{p}inertia></{p}inertial>",
                (0..6).rev().map(entry).collect::<String>()
            )
        }
        Style::SdfAttributes => {
            let entry = |i: usize| format!(" {}='{:e}'", NAMES[i], six[i]);
            format!(
                "<{p}inertial mass='{mass}'><{p}inertia{}/></{p}inertial>",
                (0..6).map(entry).collect::<String>()
            )
        }
    }
}

fn xml(dress: &Dress, bodies: &[Numbers]) -> Vec<u8> {
    let Dress { style, root, prefix: p, .. } = *dress;
    let link = if style == Style::Mjcf { "body" } else { "link" };
    let mut declared = String::new();
    let mut inside = String::new();
    for (i, body) in bodies.iter().enumerate() {
        let mut text = inertial(style, p, body);
        let special = i == 0;
        if special && dress.entity == Entity::Number {
            let mass = format!("{}", body.0);
            let at = text.find(&mass).unwrap();
            text.replace_range(at..at + mass.len(), "&mass;");
            write!(declared, "<!ENTITY mass \"{mass}\">").unwrap();
        }
        if special && dress.entity == Entity::Digit && style != Style::Sdf {
            let at = text.find(|c: char| c.is_ascii_digit() && c != '0').unwrap();
            let code = u32::from(text.as_bytes()[at]);
            text.replace_range(at..=at, &format!("&#{code};"));
        }
        let mut whole = format!("<{p}{link} name='b{i}'>{text}</{p}{link}>\n");
        let sdf = || inertial(Style::Sdf, p, body);
        match dress.gazebo {
            Gazebo::None => {}
            _ if !special => {}
            Gazebo::Link => {
                whole =
                    format!("<{p}gazebo><{p}link name='b{i}'>{}</{p}link></{p}gazebo>\n", sdf());
            }
            Gazebo::Reference => {
                whole = format!("<{p}gazebo reference='b{i}'>{}</{p}gazebo>\n", sdf());
            }
            Gazebo::Plugin => {
                whole = format!(
                    "<{p}gazebo><{p}plugin name='b{i}'>{}</{p}plugin></{p}gazebo>\n",
                    sdf()
                );
            }
        }
        if special && dress.entity == Entity::Body {
            write!(declared, "<!ENTITY body \"{}\">", whole.replace('"', "'")).unwrap();
            whole = "&body;\n".to_owned();
        }
        if dress.comments {
            let other = inertial(style, p, &(1.0, [7.0; 6]));
            write!(inside, "<!-- not <{p}{link}>{other} -->").unwrap();
        }
        inside += &whole;
    }
    let encoding = if dress.encoding == Encoding::Latin { "ISO-8859-1" } else { "utf-8" };
    let doctype = if declared.is_empty() {
        String::new()
    } else {
        format!("<!DOCTYPE {root} [{declared}]>\n")
    };
    let namespace = match p {
        "" => String::new(),
        _ => format!(" xmlns:{}='urn:example:robots'", p.trim_end_matches(':')),
    };
    let version = if matches!(style, Style::Sdf | Style::SdfAttributes) && root == "sdf" {
        dress.version
    } else {
        ""
    };
    let text = format!(
        "<?xml version='1.0' encoding='{encoding}'?>\n{doctype}<{p}{root}{namespace}{version} \
         name='r\u{e9}'>\n{inside}</{p}{root}>\n"
    );
    encoded(&if dress.crlf { text.replace('\n', "\r\n") } else { text }, dress.encoding)
}

fn encoded(text: &str, encoding: Encoding) -> Vec<u8> {
    let sixteen = |bytes: fn(u16) -> [u8; 2]| {
        "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(bytes).collect()
    };
    match encoding {
        Encoding::Utf8 => text.as_bytes().to_vec(),
        Encoding::Mark => format!("\u{feff}{text}").into_bytes(),
        Encoding::Latin => text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect(),
        Encoding::Utf16Little => sixteen(u16::to_le_bytes),
        Encoding::Utf16Big => sixteen(u16::to_be_bytes),
    }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

/// Every body is read with its numbers, or the file says what of it was not read. Returns whether
/// all were read.
fn all_or_said(name: &str, bytes: Vec<u8>, bodies: &[Numbers]) -> Result<bool, TestCaseError> {
    let shown = String::from_utf8_lossy(&bytes).into_owned();
    let file = match InertiaFile::parse(Path::new(name), bytes, Products::TensorEntries) {
        Err(error) => {
            prop_assert_ne!(error.bearing(), Bearing::Nothing, "{}: {}\n{}", name, error, shown);
            return Ok(false);
        }
        Ok(file) => file,
    };
    let mut read = 0;
    for found in file.bodies().iter().filter(|body| body.inertia().is_ok()) {
        let index: usize = found.name()[1..].parse().unwrap();
        let (mass, six) = &bodies[index];
        prop_assert!(close(found.mass_kg().unwrap(), *mass), "{}: {:?}\n{}", name, found, shown);
        let matrix = found.inertia().unwrap();
        for (entry, (i, j)) in six.iter().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
            prop_assert!(close(matrix[(i, j)], *entry), "{}: {:?}\n{}", name, found, shown);
            prop_assert!(close(matrix[(j, i)], *entry), "{}: {:?}\n{}", name, found, shown);
        }
        read += 1;
    }
    prop_assert!(read <= bodies.len(), "{}", shown);
    let unread = file.bodies().len() - read;
    let said = unread > 0 || !file.gaps().is_empty();
    prop_assert!(read == bodies.len() || said, "{}: {} of {}\n{}", name, read, bodies.len(), shown);
    Ok(read == bodies.len())
}

/// A table, and whether its headings and what stands above them are among those that are read.
fn table() -> impl Strategy<Value = (String, String, char, &'static str, bool)> {
    let masses = vec!["mass", "mass (kg)", "Mass_kg", "m [kg]", "MASS / kg", "mass kg"];
    let inertias = vec![
        "{}",
        "{} [kg m^2]",
        "{} (kg·m²)",
        "{}_kgm2",
        "{}_kg_m2",
        "{} (kg-m^2)",
        "{} [kg*m**2]",
        "{} / kg m²",
        "{} kg·m2",
        "{} in kg m^2",
        "\"{} (kg m2)\"",
        "{} {kg⋅m²}",
        "{}, kg m2",
        "{}: kg.m2",
        "{} about base",
        "{} [furlong]",
        "moment {}",
    ];
    let titles = vec![
        "",
        "Mass properties of rover\n",
        "Rover;;;;\n\n",
        "\"a\tb\n",
        "ixx, iyy, izz of all\n",
        "Rover,,,,,,,\nrevision 3,,,,,,,\n# a comment\n",
    ];
    (select(masses), select(inertias), select(vec![',', ';', '\t']), select(titles), any::<bool>())
        .prop_map(|(mass, inertia, separator, title, upper)| {
            let inertia = if upper { inertia.replace("{}", "{U}") } else { inertia.to_owned() };
            // A comma in a heading needs quotes where it is the separator.
            let inertia =
                if inertia.contains(separator) { format!("\"{inertia}\"") } else { inertia };
            let read = !["about", "furlong", "moment"].iter().any(|word| inertia.contains(word));
            (mass.to_owned(), inertia, separator, title, read)
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn bodies_in_xml_are_read_or_said_not_to_be(dress in dress(), bodies in numbers()) {
        let name = format!("a{}", dress.extension);
        let all = all_or_said(&name, xml(&dress, &bodies), &bodies)?;
        let utf16 = matches!(dress.encoding, Encoding::Utf16Little | Encoding::Utf16Big);
        let ignored = dress.style == Style::SdfAttributes && dress.root == "sdf"
            && dress.version.contains("1.7");
        // A digit within the text of an element is not put together again.
        let entity = matches!(dress.entity, Entity::Body | Entity::Number);
        let expected = !utf16 && !ignored && !entity && dress.gazebo != Gazebo::Plugin;
        prop_assert_eq!(all, expected, "{:?}", dress);
    }

    #[test]
    fn bodies_in_tables_are_read_or_said_not_to_be(
        (mass, inertia, separator, title, read) in table(),
        bodies in numbers(),
        encoding in select(vec![Encoding::Utf8, Encoding::Mark, Encoding::Utf16Little]),
        crlf in any::<bool>(),
    ) {
        let columns = |name: &str| inertia.replace("{U}", &name.to_uppercase()).replace("{}", name);
        let joined = |fields: Vec<String>| fields.join(&separator.to_string()) + "\n";
        let mut text = title.to_owned();
        let entries = NAMES.iter().map(|name| columns(name));
        let header = ["name".to_owned(), mass.clone()].into_iter().chain(entries);
        text += &joined(header.collect());
        for (i, (mass, six)) in bodies.iter().enumerate() {
            let numbers = six.iter().map(|x| format!("{x:e}"));
            text += &joined([format!("b{i}"), mass.to_string()].into_iter().chain(numbers).collect());
        }
        let text = if crlf { text.replace('\n', "\r\n") } else { text };
        let all = all_or_said("a.csv", encoded(&text, encoding), &bodies)?;
        prop_assert_eq!(all, read && encoding != Encoding::Utf16Little, "{}", text);
    }

    #[test]
    fn bodies_in_documents_are_read_or_said_not_to_be(
        bodies in numbers(),
        depth in 0_usize..4,
        json in any::<bool>(),
        named in any::<bool>(),
        extension in any::<bool>(),
    ) {
        let rows = |six: &[f64; 6]| {
            let [xx, yy, zz, xy, xz, yz] = six;
            format!("[[{xx:e}, {xy:e}, {xz:e}], [{xy:e}, {yy:e}, {yz:e}], [{xz:e}, {yz:e}, {zz:e}]]")
        };
        let mut text = String::new();
        // A body of its own that is read, so that the file is: the others may stand too deep.
        let all: Vec<_> = bodies.iter().enumerate().collect();
        if json {
            let body = |(i, (mass, six)): &(usize, &Numbers)| {
                format!("{{\"name\": \"b{i}\", \"mass_kg\": {mass:e}, \"inertia_kg_m2\" : {}}}", rows(six))
            };
            let mut rest: Vec<String> = all[1..].iter().map(body).collect();
            rest.reverse();
            let mut deep = format!("[{}]", rest.join(", "));
            for level in 0..depth {
                deep = format!("{{\"level{level}\": {deep}}}");
            }
            let key = if depth == 0 { "bodies" } else { "robot" };
            write!(text, "{{\"first\": {}, \"{key}\": {deep}}}", body(&all[0])).unwrap();
        } else {
            for (i, (mass, six)) in all {
                let under = if i == 0 { String::new() } else { "deep.".repeat(depth) };
                let heading = if named || i == 0 { format!("[{under}b{i}]") } else { format!("[[{under}bodies]]\nname = 'b{i}'") };
                writeln!(text, "# inertia_kg_m2 = 3\n{heading}\nmass_kg = {mass:e}\ninertia_kg_m2 = {}", rows(six)).unwrap();
            }
        }
        let name = match (extension, json) {
            (false, _) => "-",
            (true, true) => "a.json",
            (true, false) => "a.toml",
        };
        let all = all_or_said(name, text.clone().into_bytes(), &bodies)?;
        prop_assert_eq!(all, depth == 0 || bodies.len() == 1, "{}", text);
    }
}
