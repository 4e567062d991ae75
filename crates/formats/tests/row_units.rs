//! Cells that name a unit: they must be those of the columns, wherever these state theirs.

use gyradius_formats::{FileBodyError, InertiaFile, PartsTable, Products, TenTable};
use proptest::{prelude::*, sample::select};
use std::path::Path;

const MASSES: [(&str, f64); 6] = [
    ("kg", 1.0),
    ("g", 1e-3),
    ("Mg", 1e3),
    ("t", 1e3),
    ("lbm", 0.45359237),
    ("slug", 14.593902937206364),
];
const LENGTHS: [(&str, f64); 5] =
    [("m", 1.0), ("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254), ("ft", 0.3048)];

/// Mass, length and inertia, each with what it is in SI.
type Units = [(String, f64); 3];

fn unit_of_each() -> impl Strategy<Value = Units> {
    let inertia = (select(&MASSES[..]), select(&LENGTHS[..]), select(&[" ", "·", "-", "*"][..]));
    let inertia = (inertia, select(&["2", "²", "^2"][..])).prop_map(
        |(((mass, kg), (length, m), between), square)| {
            (format!("{mass}{between}{length}{square}"), kg * m * m)
        },
    );
    let of = |(unit, si): (&str, f64)| (unit.to_owned(), si);
    (select(&MASSES[..]), select(&LENGTHS[..]), inertia)
        .prop_map(move |(mass, length, inertia)| [of(mass), of(length), inertia])
}

/// Headings of a column of units, and which of the three they are of, if they say.
const HEADINGS: [(&str, Option<usize>); 17] = [
    ("Ixx units", Some(2)),
    ("ixx_unit", Some(2)),
    ("I unit", Some(2)),
    ("Unit I_xy", Some(2)),
    ("cx unit", Some(1)),
    ("u.o.m.", None),
    ("U/M", None),
    ("Unit of measure", None),
    ("unit", None),
    ("UOM", None),
    ("units of mass and inertia", None),
    ("mass unit", Some(0)),
    ("length_units", Some(1)),
    ("unit of the centre", Some(1)),
    ("inertia_unit", Some(2)),
    ("units of the moments", Some(2)),
    ("unit (MOI, POI)", Some(2)),
];

fn is_same(one: f64, other: f64) -> bool {
    (one / other - 1.0).abs() < 1e-12
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// A heading in g mm² above a row in kg m² was taken, with a factor of 10⁹, and one above a row in g mm² refused.
    #[test]
    fn a_row_has_the_units_of_its_columns(
        columns in unit_of_each(),
        // Nothing is stated, in the heading, in the row below, or in both.
        place in 0..4_usize,
        others in unit_of_each(),
        said in prop::collection::vec((0..3_usize, any::<bool>()), 1..4),
        (heading, of) in select(&HEADINGS[..]),
        between in select(&[", ", "; ", " / ", " and ", ","][..]),
        is_in_units in any::<bool>(),
    ) {
        let columns = if place == 0 { [("", 1.0); 3].map(|(unit, si)| (unit.to_owned(), si)) } else { columns };
        let said: Vec<(usize, &(String, f64))> = said
            .iter()
            .map(|(which, is_same)| (*which, if *is_same && place > 0 { &columns[*which] } else { &others[*which] }))
            .collect();
        let cell = said.iter().map(|(_, (unit, _))| unit.as_str()).collect::<Vec<_>>().join(between);
        let is_true = said
            .iter()
            .all(|(which, (_, si))| is_same(*si, columns[*which].1) && of.is_none_or(|of| of == *which));

        let names = ["mass", "cx", "cy", "cz", "ixx", "iyy", "izz"];
        let kind = |i: usize| [0, 1, 1, 1, 2, 2, 2][i];
        let (in_heading, in_row) = (place % 2 == 1, place >= 2);
        let is_in_units = is_in_units && in_row;
        let head = |i: usize| if in_heading { format!("{} [{}]", names[i], columns[kind(i)].0) } else { names[i].to_owned() };
        let head: Vec<String> = (0..7).map(head).collect();
        let below: Vec<&str> = (0..7).map(|i| columns[kind(i)].0.as_str()).collect();
        let mut text = format!("name,{},\"{heading}\"\n", head.join(","));
        if in_row {
            text += &format!(",{},\"{}\"\n", below.join(","), if is_in_units { &cell } else { "" });
        }
        text += &format!("a,5,1,2,3,4,5,6,\"{}\"\n", if is_in_units { "" } else { &cell });

        let list = PartsTable::read(text.as_bytes(), None);
        prop_assert_eq!(list.is_ok(), is_true, "{}{:?}", text, list);
        let file = InertiaFile::parse(Path::new("t.csv"), text.clone().into_bytes(), Products::default());
        if is_in_units && !is_true {
            let error = file.unwrap_err().to_string();
            prop_assert!(error.contains(&format!("column {heading:?} says")), "{} {}", text, error);
            return Ok(());
        }
        let file = file.unwrap();
        let ten = TenTable::of(&file).unwrap();
        let inertia = file.bodies()[0].inertia();
        prop_assert_eq!(inertia.is_ok(), is_true, "{}{:?}", text, inertia);
        prop_assert_eq!(ten.rows()[0].values().is_ok(), is_true, "{}", text);
        match inertia {
            Ok(inertia) => prop_assert!(is_same(inertia[(1, 1)], 5.0 * columns[2].1)),
            Err(error) => prop_assert!(matches!(error, FileBodyError::Unread { .. }), "{}", error),
        }
    }
}

/// Numbers other than one, and marks of feet and of percent, with which a unit of a column is another.
const FACTORS: [&str; 13] =
    ["10^-3", "1e-6", "0.001", "1000", "10³", "10⁻³", "½", "-1", "2", "0", "1,000", "%", "'"];

proptest! {
    /// `10^-3 kg·m²` was taken for kg·m².
    #[test]
    fn a_unit_with_a_factor_is_another(
        columns in unit_of_each(),
        (heading, of) in select(&HEADINGS[..]),
        which in 0..3_usize,
        factor in select(&FACTORS[..]),
        form in select(&["F U", "F·U", "F × U", "U/F", "U / F", "U × F", "U*F", "U · F", "U, F", "U (F)", "F", "[F]"][..]),
        is_in_units: bool,
    ) {
        let which = of.unwrap_or(which);
        let unit = &columns[which].0;
        let table = |factor: &str| {
            let cell = form.replace('U', unit).replace('F', factor);
            let [mass, length, inertia] = columns.each_ref().map(|(unit, _)| unit);
            let (above, below) = if is_in_units { (cell.as_str(), "") } else { ("", cell.as_str()) };
            format!(
                "name,mass,cx,cy,cz,ixx,iyy,izz,\"{heading}\"\n,{mass},{length},{length},{length},{inertia},{inertia},{inertia},\"{above}\"\n\
                 a,5,1,2,3,4,5,6,\"{below}\"\n"
            )
        };
        let checked = |text: &str| {
            let file = InertiaFile::parse(Path::new("t.csv"), text.as_bytes().to_vec(), Products::default());
            file.is_ok_and(|file| file.bodies()[0].inertia().is_ok())
        };
        let text = table(factor);
        prop_assert!(PartsTable::read(text.as_bytes(), None).is_err(), "{}", text);
        // What is in a column of units alone may be a thing there, which is told.
        prop_assert!(heading == "unit" || !checked(&text), "{}", text);
        // A factor of one changes nothing.
        let text = table("1");
        let is_apart = ["U/F", "U / F", "U, F"].contains(&form) || form == "F U" && !unit.contains(' ');
        prop_assert!(!is_apart || PartsTable::read(text.as_bytes(), None).is_ok() && checked(&text), "{}", text);
    }
}

/// First moments are in their own unit; where there are none, the two words are a mass and a length.
#[test]
fn a_unit_of_first_moments_is_theirs() {
    for (centre, cell, is_true) in [
        ("mcx [kg mm],mcy,mcz", "kg mm", true),
        ("mcx [kg mm],mcy,mcz", "kg m", false),
        ("mcx,mcy,mcz", "kg m", true),
        ("mcx,mcy,mcz", "g mm", false),
        ("cx [mm],cy,cz", "kg mm", true),
        ("cx [mm],cy,cz", "kg m", false),
    ] {
        let text = format!("mass,{centre},ixx,iyy,izz,uom\n5,1,2,3,4,5,6,{cell}\n");
        let file =
            InertiaFile::parse(Path::new("t.csv"), text.into_bytes(), Products::default()).unwrap();
        assert_eq!(file.bodies()[0].inertia().is_ok(), is_true, "{centre} {cell}");
    }
}

/// A list may have columns of one kind in several units: then no cell says which of them it means. Without a column of a kind, it must be
/// that of SI.
#[test]
fn columns_in_several_units_have_no_unit_of_a_row() {
    for (more, heading, cell, is_true) in [
        ("kx [m],ky [m],kz [m]", "length unit", "mm", false),
        ("kx [mm],ky [mm],kz [mm]", "length unit", "mm", true),
        ("note,,", "length unit", "mm", true),
        ("note,,", "unit", "SI", false),
        ("note,,", "unit", "kg", true),
        ("note,,", "inertia unit", "g mm2", false),
        ("note,,", "inertia unit", "kg m2", true),
        ("note,,", "length unit", "\"\"\"\"", false),
        ("note,,", "length unit", "-", true),
        ("note,,", "Units", "2", false),
        ("note,,", "Units", "1 ea", true),
    ] {
        let text = format!(
            "name,mass [kg],cx [mm],cy [mm],cz [mm],{more},shape,{heading}\na,5,1,2,3,,,,point,{cell}\n"
        );
        let list = PartsTable::read(text.as_bytes(), None);
        assert_eq!(list.is_ok(), is_true, "{more} {heading} {cell} {list:?}");
    }
}
