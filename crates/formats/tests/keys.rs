//! Keys of bodies in TOML and JSON: each is read, a slip that is an error, or named as one that is not read.

use gyradius_formats::{FileBodyError, Format, GapKind, InertiaFile, Products};
use proptest::{prelude::*, sample::select};
use std::path::Path;

const INERTIA: &str = "[[10, 0.1, 0.2], [0.1, 11, 0.3], [0.2, 0.3, 12]]";

/// A key of a body, with a value, and what becomes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fate {
    Read,
    Slip,
    Unread,
}

use Fate::{Read, Slip, Unread};

/// Whether a body has an inertia, and what else stands in its table.
type Made = (bool, Vec<(&'static str, &'static str, Fate)>);

const KEYS: [(&str, &str, Fate); 20] = [
    ("mass_kg", "2", Read),
    ("products", "\"integrals\"", Read),
    ("name", "\"arm\"", Read),
    ("mass", "2", Slip),
    ("Mass_kg", "2", Slip),
    ("mass_lb", "2", Slip),
    ("mas_kg", "2", Slip),
    ("Products", "\"integrals\"", Slip),
    ("PRODUCTS", "3", Slip),
    ("product", "\"integrals\"", Slip),
    ("product", "\"wheel\"", Unread),
    ("inertia_kgm2", INERTIA, Slip),
    ("Inertia_kg_m2", INERTIA, Slip),
    ("inertia", INERTIA, Slip),
    ("position_m", "[0, 0, 1]", Unread),
    ("mass_centre_m", "[0, 0, 1]", Unread),
    ("dispersion", "{}", Unread),
    ("Name", "\"arm\"", Unread),
    ("title", "\"arm\"", Unread),
    ("x", "null", Unread),
];

/// Which key of ours a slip is one for.
fn meant(slip: &str) -> &'static str {
    match slip.to_lowercase().as_bytes() {
        [b'm', ..] => "mass_kg",
        [b'p', ..] => "products",
        _ => "inertia_kg_m2",
    }
}

/// Keys of a document around its bodies, with a value, and whether it is read.
const AROUND: [(&str, &str, bool); 10] = [
    ("units", "\"g mm2\"", false),
    ("convention", "\"integrals\"", false),
    ("about", "\"origin\"", false),
    ("version", "3", false),
    ("gravity", "[0, 0, -9.8]", false),
    ("springs", "[{\"x\": 1}]", false),
    ("moments", "{\"percent\": 10}", false),
    ("mass_kg", "2", false),
    ("name", "\"rover\"", true),
    ("products", "\"integrals\"", true),
];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Container {
    Bodies,
    ListOfBodies,
    List,
    Top,
    /// The document is the first body itself.
    Itself,
}

fn json(
    bodies: &[Vec<(String, String)>],
    container: Container,
    around: &[(&str, &str, bool)],
) -> String {
    let table = |body: &Vec<(String, String)>| {
        let entries: Vec<String> = body.iter().map(|(k, v)| format!("\"{k}\": {v}")).collect();
        format!("{{{}}}", entries.join(", "))
    };
    let tables: Vec<String> = bodies.iter().map(table).collect();
    let named: Vec<String> =
        tables.iter().enumerate().map(|(i, table)| format!("\"body {i}\": {table}")).collect();
    let around: String =
        around.iter().map(|(key, value, _)| format!("\"{key}\": {value}, ")).collect();
    match container {
        Container::Bodies => format!("{{{around}\"bodies\": {{{}}}}}", named.join(", ")),
        Container::ListOfBodies => format!("{{{around}\"bodies\": [{}]}}", tables.join(", ")),
        Container::List => format!("[{}]", tables.join(", ")),
        Container::Top => format!("{{{around}{}}}", named.join(", ")),
        Container::Itself => tables[0].clone(),
    }
}

proptest! {
    #[test]
    fn each_key_is_read_or_refused_or_named(
        bodies in prop::collection::vec(
            (any::<bool>(), prop::sample::subsequence(KEYS.to_vec(), 0..5)),
            1..5,
        ),
        container in select(
            &[Container::Bodies, Container::ListOfBodies, Container::List, Container::Top, Container::Itself][..],
        ),
        around in prop::sample::subsequence(AROUND.to_vec(), 0..5),
    ) {
        let mut bodies: Vec<Made> = bodies;
        // A document that is no table, or a body itself, has none of its own.
        let around = if matches!(container, Container::List | Container::Itself) { Vec::new() } else { around };
        let is_around = |name: &str| around.iter().any(|(key, ..)| *key == name);
        if container == Container::Itself {
            bodies.truncate(1);
        }
        for (_, keys) in &mut bodies {
            keys.dedup_by_key(|(key, ..)| *key);
        }
        let written: Vec<Vec<(String, String)>> = bodies
            .iter()
            .map(|(has_inertia, keys)| {
                let keys = keys.iter().map(|(key, value, _)| ((*key).to_owned(), (*value).to_owned()));
                let inertia = has_inertia.then(|| ("inertia_kg_m2".to_owned(), INERTIA.to_owned()));
                keys.chain(inertia).collect()
            })
            .collect();
        let text = json(&written, container, &around);
        let read = InertiaFile::parse(Path::new("a.json"), text.clone().into_bytes(), Products::default());
        if !bodies.iter().any(|(has_inertia, _)| *has_inertia) {
            prop_assert!(read.is_err(), "{text}");
            return Ok(());
        }
        // A document that is a body itself is refused for a slip in the sign of its products, as that of all bodies.
        let slips = |key: &&(&str, &str, Fate)| key.2 == Slip && meant(key.0) == "products";
        let has = |name: &str| bodies[0].1.iter().any(|(key, ..)| *key == name);
        if container == Container::Itself && !has("products") && bodies[0].1.iter().any(|key| slips(&key)) {
            prop_assert!(read.is_err(), "{text}");
            return Ok(());
        }
        let file = read.unwrap();
        let is_slip = |(has_inertia, keys): &Made, key: &str, fate| {
            let known = meant(key);
            let is_there = if known == "inertia_kg_m2" { *has_inertia } else {
                keys.iter().any(|(key, ..)| *key == known)
            };
            fate == Slip && !is_there
        };
        // At the top level a table may be anything.
        let is_body = |body: &&Made| {
            !matches!(container, Container::Top)
                || body.0
                || body.1.iter().any(|(key, _, fate)| *fate == Slip && meant(key) == "inertia_kg_m2")
        };
        let expected: Vec<_> = bodies.iter().filter(is_body).collect();
        prop_assert_eq!(file.bodies().len(), expected.len(), "{}", text);
        let mut unread: Vec<String> =
            around.iter().filter(|(.., is_read)| !is_read).map(|(key, ..)| (*key).to_owned()).collect();
        let mut in_order = file.bodies().iter();
        for (i, made) in bodies.iter().enumerate() {
            if !is_body(&made) {
                unread.push(format!("body {i}"));
                continue;
            }
            let body = in_order.next().unwrap();
            let slip = made.1.iter().find(|(key, _, fate)| is_slip(made, key, *fate));
            match (body.inertia(), slip) {
                (Err(FileBodyError::Key { key, .. }), Some((slip, ..))) => prop_assert_eq!(&key, slip),
                (Err(FileBodyError::Missing { field }), None) => {
                    prop_assert!(!made.0 && field == "inertia_kg_m2", "{}", text);
                }
                (Ok(matrix), None) => {
                    let has_products = made.1.iter().any(|(key, ..)| *key == "products");
                    let sign = if has_products || is_around("products") { -0.1 } else { 0.1 };
                    prop_assert_eq!(matrix[(0, 1)], sign);
                    let has_mass = made.1.iter().any(|(key, ..)| *key == "mass_kg");
                    prop_assert_eq!(body.mass_kg(), has_mass.then_some(2.0));
                }
                other => prop_assert!(false, "{:?} of {}", other, text),
            }
            for (key, _, fate) in &made.1 {
                if *fate != Read && !is_slip(made, key, *fate) && !unread.iter().any(|one| one == key) {
                    unread.push((*key).to_owned());
                }
            }
        }
        let gap = file.gaps().iter().find(|gap| gap.kind() == GapKind::Keys);
        let named = gap.map(|gap| gap.keys().to_vec()).unwrap_or_default();
        prop_assert_eq!(named, unread, "{}", text);
    }
}

#[test]
fn the_sign_of_all_products_is_read_or_refused() {
    for (key, word, is_refused) in [
        ("Products", "integrals", true),
        ("PRODUCTS", "anything", true),
        ("prodcts", "integrals", true),
        ("product", "integrals", true),
        ("product", "rover", false),
        ("production", "integrals", false),
    ] {
        let json =
            format!("{{\"{key}\": \"{word}\", \"bodies\": [{{\"inertia_kg_m2\": {INERTIA}}}]}}");
        let toml = format!("{key} = \"{word}\"\n[[bodies]]\ninertia_kg_m2 = {INERTIA}");
        for (name, text) in [("a.json", json), ("a.toml", toml)] {
            let read = InertiaFile::parse(Path::new(name), text.into_bytes(), Products::default());
            let Err(error) = read else {
                assert!(!is_refused, "{key} in {name}");
                continue;
            };
            let said = error.to_string();
            assert!(is_refused && said.contains(&format!("the key \"{key}\"")), "{said}");
        }
    }
}

#[test]
fn tables_by_name_are_bodies_each_and_letters_of_entries_are_named() {
    let text = format!(
        "[bodies.a]\ninertia_kg_m2 = {INERTIA}\n[bodies.b]\ninertia_kgm2 = {INERTIA}\n[bodies.c]\nx = 1\n\
         [bodies.d.inertia_kg_m2]\nixx = 1\nipp = 2\n[body]\ncolour = 'red'\n[other]\nx = 1\n"
    );
    let file =
        InertiaFile::parse(Path::new("a.toml"), text.into_bytes(), Products::default()).unwrap();
    assert_eq!(file.format(), Format::Toml);
    let said: Vec<String> = file
        .bodies()
        .iter()
        .map(|body| {
            let error = body.inertia().err().map(|error| error.to_string()).unwrap_or_default();
            format!("{}:{} {error}", body.name(), body.line())
        })
        .collect();
    assert_eq!(
        said,
        [
            "a:2 ",
            "b:3 the key \"inertia_kgm2\" is not read here: the keys are name, mass_kg, inertia_kg_m2 and products",
            "c:5 inertia_kg_m2 is missing",
            "d:7 the key \"ipp\" is not read here: the keys are ixx, iyy, izz, ixy, ixz and iyz",
        ]
    );
}

/// A file of statements says by a table what is known of the products, and its nominal body is read as any other.
#[test]
fn what_is_known_of_products_is_no_sign_of_them() {
    let text = format!(
        "[nominal]\nmass_kg = 2\ninertia_kg_m2 = {INERTIA}\n[moments]\npercent = 10\n[products]\nkg_m2 = 0.3\n[mass]\npercent = 5\n"
    );
    for default in [Products::TensorEntries, Products::Integrals] {
        let file =
            InertiaFile::parse(Path::new("a.toml"), text.clone().into_bytes(), default).unwrap();
        let [nominal] = file.bodies() else { panic!("{:?}", file.bodies()) };
        let sign = if default == Products::TensorEntries { 1.0 } else { -1.0 };
        let matrix = nominal.inertia().unwrap();
        let products = [(0, 1), (0, 2), (1, 2)].map(|place| matrix[place]);
        assert_eq!(products, [0.1, 0.2, 0.3].map(|x| sign * x));
    }
}
