//! Columns that say that the inertia of a row is another one: whoever reads the table refuses them, or reads the same numbers.

use gyradius_formats::{
    FileBodyError, Gap, GapKind, InertiaFile, PartsTable, Products, TenCentre, TenTable,
};
use proptest::{prelude::*, sample::select};
use std::path::Path;

const REFERENCES: [&str; 11] = [
    "inertia about",
    "Inertia_about",
    "MOI ref. point",
    "moments about the point",
    "\"inertia about\"",
    "about",
    "about point",
    "Inertia Ref",
    "MOI reference",
    "MOI at",
    "inertia_frame",
];
const UNITS: [&str; 6] =
    ["unit", "Units", "uom", "inertia_units", "unit of inertia", "units of the moments"];

/// Cells that say nothing, and cells that do.
const OF_REFERENCES: [(&str, bool); 13] = [
    ("", true),
    ("NA", true),
    ("cg", true),
    ("CoM", true),
    ("own mass centre", true),
    ("Centre of gravity", true),
    ("origin", false),
    ("point A", false),
    ("launch frame", false),
    ("not cg", false),
    ("-", false),
    ("0", false),
    ("\"hinge, left\"", false),
];
const OF_UNITS: [(&str, bool); 12] = [
    ("", true),
    ("NA", true),
    ("kg m2", true),
    ("kg·m²", true),
    ("SI", true),
    ("1", true),
    ("g mm2", false),
    ("lb in2", false),
    ("lbf in s2", false),
    ("slug ft2", false),
    ("kg mm2", false),
    ("g", false),
];

proptest! {
    #[test]
    fn what_would_change_a_row_is_refused_by_all(
        columns in prop::collection::vec(any::<bool>(), 1..3).prop_flat_map(|kinds| {
            let column = |is_unit: bool| {
                let headings = if is_unit { &UNITS[..] } else { &REFERENCES[..] };
                let cells = if is_unit { &OF_UNITS[..] } else { &OF_REFERENCES[..] };
                (select(headings), prop::collection::vec(select(cells), 3))
            };
            kinds.into_iter().map(column).collect::<Vec<_>>()
        }),
        at in 0..2_usize,
        separator in select(&[",", ";", "\t"][..]),
    ) {
        let numbers = ["name,mass,cx,cy,cz,ixx,iyy,izz", "a,5,1,2,3,4,5,6", "b,5,1,2,3,4,5,6", "c,5,1,2,3,4,5,6"];
        let lines: Vec<String> = numbers
            .iter()
            .enumerate()
            .map(|(row, numbers)| {
                let more = columns.iter().map(|(heading, cells)| if row == 0 { *heading } else { cells[row - 1].0 });
                let more: Vec<&str> = more.collect();
                let parts = if at == 0 { [more.join("\u{1}"), numbers.replace(',', "\u{1}")] }
                    else { [numbers.replace(',', "\u{1}"), more.join("\u{1}")] };
                parts.join("\u{1}").replace('\u{1}', separator)
            })
            .collect();
        let text = lines.join("\n") + "\n";
        let file = InertiaFile::parse(Path::new("t.csv"), text.clone().into_bytes(), Products::default()).unwrap();
        let ten = TenTable::of(&file).unwrap();
        prop_assert_eq!((file.bodies().len(), ten.rows().len()), (3, 3), "{}", text);
        let list = PartsTable::read(text.as_bytes(), None);
        let mut is_first = true;
        for row in 0..3 {
            let said = columns.iter().find(|(_, cells)| !cells[row].1);
            let (body, ten) = (&file.bodies()[row], &ten.rows()[row]);
            let Some((heading, cells)) = said else {
                prop_assert_eq!(body.inertia().unwrap()[(1, 1)], 5.0);
                prop_assert_eq!(ten.values().unwrap()[5], 5.0);
                continue;
            };
            let plain = |cell: &str| cell.trim_matches('"').to_owned();
            let error = body.inertia().unwrap_err();
            prop_assert_eq!(ten.values().unwrap_err(), &error);
            let FileBodyError::Unread { heading: named, value, .. } = error.clone() else { panic!("{text}: {error}") };
            prop_assert_eq!((named, value), (plain(heading), plain(cells[row].0)), "{}", text);
            // A list of parts is refused at its first row of these.
            if std::mem::take(&mut is_first) {
                let refused = list.as_ref().unwrap_err().to_string();
                prop_assert!(refused.contains(&error.to_string()), "{refused} {error}");
            }
        }
        prop_assert!(!is_first || list.is_ok(), "{text}: {list:?}");
    }
}

/// What the ten of a row are, by the headings of its second to fourth columns, and the point that the inertia is about then.
const FORMS: [([&str; 3], &str); 5] = [
    (["cx", "cy", "cz"], "cg"),
    (["com_x_mm", "com_y_mm", "com_z_mm"], "cg"),
    (["mcx", "mcy", "mcz"], "origin"),
    (["first_moment_1_kg_m", "first_moment_2_kg_m", "first_moment_3_kg_m"], "origin"),
    (["hx [g mm]", "hy [g mm]", "hz [g mm]"], "origin"),
];

proptest! {
    /// The inertia beside first moments is about the origin, beside a mass centre about that, and a row may say so and nothing else: one that
    /// told the truth was refused, and one that did not was taken.
    #[test]
    fn the_point_of_a_row_is_that_of_its_form(
        (centre, point) in select(&FORMS[..]),
        heading in select(&REFERENCES[..]),
        (cell, is_of) in select(&[
            ("cg", "cg"), ("CoM", "cg"), ("own mass centre", "cg"), ("Centre of gravity", "cg"), ("own", "cg"),
            ("origin", "origin"), ("the Origin", "origin"), ("frame origin", "origin"), ("coordinate_origin", "origin"),
            ("", "both"), ("NA", "both"), ("point A", "none"), ("not origin", "none"), ("0", "none"), ("-", "none"),
        ][..]),
        order in Just((0..11).collect::<Vec<usize>>()).prop_shuffle(),
    ) {
        let [x, y, z] = centre;
        let of_inertia = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"].map(|name| format!("{name} [kg m2]"));
        let [ixx, iyy, izz, ixy, ixz, iyz] = of_inertia.each_ref().map(String::as_str);
        let headings = ["mass [kg]", x, y, z, ixx, iyy, izz, ixy, ixz, iyz, heading];
        let cells = ["5", "1", "2", "3", "4", "5", "6", "0", "0", "0", cell];
        let line = |of: [&str; 11]| order.iter().map(|i| of[*i]).collect::<Vec<_>>().join(",");
        let text = format!("{}\n{}\n", line(headings), line(cells));
        let file = InertiaFile::parse(Path::new("t.csv"), text.clone().into_bytes(), Products::default()).unwrap();
        let ten = TenTable::of(&file).unwrap();
        let expected = if point == "origin" { TenCentre::FirstMoments } else { TenCentre::MassCentre };
        prop_assert_eq!(ten.centre(), Some(expected));
        let is_true = is_of == "both" || is_of == point;
        prop_assert_eq!(file.bodies()[0].inertia().is_ok(), is_true, "{}", text);
        prop_assert_eq!(ten.rows()[0].values().is_ok(), is_true, "{}", text);
        if let Err(error) = file.bodies()[0].inertia() {
            let said = error.to_string();
            // Numbers are inertias about another point, which no word makes those of the row.
            let names_point = cell == "0" || said.contains(&format!("{point:?}"));
            prop_assert!(names_point && said.contains(&format!("{cell:?}")), "{}", said);
        }
    }
}

/// Samples are numbered, and measured at angles: what a list of parts must not have is another column of a table of bodies.
#[test]
fn other_columns_of_bodies_may_be_anything() {
    for heading in ["number", "qty", "n_parts", "roll_deg", "theta_z", "MGA %", "margin", "unit id"]
    {
        let text = format!("name,ixx,iyy,izz,{heading}\na,4,5,6,7\n");
        let file =
            InertiaFile::parse(Path::new("t.csv"), text.into_bytes(), Products::default()).unwrap();
        assert_eq!(file.bodies()[0].inertia().unwrap()[(1, 1)], 5.0, "{heading}");
    }
}

/// A column on the sign of products, and columns of limits beside a number, are refused in a list of parts, and none is passed over; signs in
/// tables of bodies, too.
#[test]
fn signs_and_limits_are_refused() {
    for heading in ["sign", "POI sign", "Sign of products"] {
        for cell in ["+", "-", "negative", "tensor"] {
            let text =
                format!("name,mass,cx,cy,cz,ixx,iyy,izz,{heading}\na,5,1,2,3,4,5,6,{cell}\n");
            let refused = PartsTable::read(text.as_bytes(), None).unwrap_err().to_string();
            assert!(refused.contains("a column products"), "{refused}");
            let file =
                InertiaFile::parse(Path::new("t.csv"), text.into_bytes(), Products::default())
                    .unwrap();
            assert!(file.bodies()[0].inertia().is_err(), "{heading} {cell}");
        }
    }
    for word in
        ["min", "max", "lower", "Upper", "95", "tol", "Toleranz", "Unsicherheit", "incertitude"]
    {
        for number in ["mass", "Ixx", "xcg", "Izz", "Cy"] {
            for heading in [
                format!("{number}_{word}"),
                format!("{word} {number}"),
                format!("{number} {word} [kg]"),
            ] {
                let text = format!("name,mass,cx,cy,cz,ixx,iyy,izz,{heading}\na,5,1,2,3,4,5,6,1\n");
                let refused = PartsTable::read(text.as_bytes(), None).unwrap_err().to_string();
                assert!(refused.contains("no standard deviation"), "{heading}: {refused}");
            }
        }
    }
}

proptest! {
    /// Whoever checks a table says which columns it has passed over, and whether a mass is among those that it reads.
    #[test]
    fn columns_that_are_not_read_are_named(
        known in prop::sample::subsequence(vec!["name", "mass [kg]", "ixx [kg m2]", "iyy", "izz", "products", "unit"], 0..=7),
        others in prop::sample::subsequence(vec!["Weight (lb)", "Gewicht", "cx", "note", "status", "ixx_source"], 0..=6),
        order in Just((0..13_usize).collect::<Vec<_>>()).prop_shuffle(),
    ) {
        let mut known = known;
        for moment in ["ixx [kg m2]", "iyy", "izz"] {
            if !known.contains(&moment) {
                known.push(moment);
            }
        }
        let mut all: Vec<(usize, &str)> = order.into_iter().zip(known.iter().chain(&others).copied()).collect();
        all.sort_unstable();
        let headings: Vec<&str> = all.iter().map(|(_, heading)| *heading).collect();
        let cells: Vec<&str> = headings.iter().map(|heading| if ["products", "unit"].contains(heading) { "" } else { "1" }).collect();
        let text = format!("{}\n{}\n", headings.join(","), cells.join(","));
        let file = InertiaFile::parse(Path::new("t.csv"), text.clone().into_bytes(), Products::default()).unwrap();
        let unread: Vec<&str> = headings.iter().copied().filter(|heading| others.contains(heading)).collect();
        let gaps: Vec<String> = file.gaps().iter().map(ToString::to_string).collect();
        if unread.is_empty() {
            prop_assert!(gaps.is_empty(), "{text}{gaps:?}");
            return Ok(());
        }
        prop_assert_eq!(file.gaps().len(), 1);
        prop_assert_eq!(file.gaps()[0].keys(), &unread[..]);
        let has_masses = known.contains(&"mass [kg]");
        prop_assert_eq!(gaps[0].contains("no column of masses is read"), !has_masses, "{}{}", text, gaps[0]);
    }
}

proptest! {
    /// A column without a heading, as below a header of two rows, is named by its number if it has cells.
    #[test]
    fn columns_without_headings_are_named_if_they_have_cells(
        places in prop::sample::subsequence((0..6_usize).collect::<Vec<_>>(), 1..=3),
        filled in 0..8_u8,
        title in select(vec!["", ",Mass (kg),Moments of inertia,,,\n"]),
    ) {
        let mut columns = [("", ""); 6];
        let mut known = [("ixx", "1"), ("iyy", "1"), ("izz", "1")].into_iter();
        let mut expected = Vec::new();
        for (at, column) in columns.iter_mut().enumerate() {
            *column = match places.iter().position(|place| *place == at) {
                None => known.next().unwrap_or(("note", "x")),
                Some(which) if filled >> which & 1 == 1 => {
                    expected.push(format!("column {} (no heading)", at + 1));
                    ("", "2")
                }
                Some(_) => ("", ""),
            };
            if column.0 == "note" && !expected.contains(&"note".to_owned()) {
                expected.push("note".to_owned());
            }
        }
        let row = |of: fn(&(&'static str, &'static str)) -> &'static str| columns.iter().map(of).collect::<Vec<_>>().join(",");
        let text = format!("{title}{}\n{}\n", row(|column| column.0), row(|column| column.1));
        let file = InertiaFile::parse(Path::new("t.csv"), text.clone().into_bytes(), Products::default()).unwrap();
        let found: Vec<&str> = file.gaps().iter().flat_map(Gap::keys).map(String::as_str).collect();
        prop_assert_eq!(found, expected, "{}", text);
        prop_assert!(file.gaps().iter().all(|gap| gap.to_string().contains("no column of masses")));
    }
}

/// Whatever a column of units, of factors or of points is called, a cell that changes the row is refused, and one that says the same is read.
#[test]
fn cells_count_under_any_heading_of_units_and_points() {
    for (headings, same, other) in [
        (
            &["Einheit", "Unité", "Unidad", "CAD units", "Model unit"][..],
            &["", "kg m2", "kg"][..],
            &["g", "mmgs", "g mm2"][..],
        ),
        (
            &["Inertia factor", "unit factor", "Scale factor", "Ixx factor"],
            &["", "1", "1.0"],
            &["1e-6", "2", "0.001"],
        ),
        (
            &[
                "Inertia given at",
                "Inertia point",
                "MOI @",
                "Inertia around",
                "MOI referred to",
                "Inertia CSYS",
            ],
            &["", "cg", "mass centre", "own CG"],
            &["origin", "vehicle CG", "point A"],
        ),
        (&["Safety factor", "Mount point", "Model", "Coordinates"], &["", "g", "origin", "2"], &[]),
    ] {
        for heading in headings {
            for (cell, is_same) in
                same.iter().map(|c| (c, true)).chain(other.iter().map(|c| (c, false)))
            {
                let text =
                    format!("name,mass,Cx,Cy,Cz,ixx,iyy,izz,{heading}\na,2,0,0,0,1,1,1,{cell}\n");
                let file = InertiaFile::parse(
                    Path::new("t.csv"),
                    text.clone().into_bytes(),
                    Products::default(),
                )
                .unwrap();
                assert_eq!(file.bodies()[0].inertia().is_ok(), is_same, "{text}");
                let list = PartsTable::read(text.as_bytes(), None);
                assert_eq!(list.is_ok(), is_same, "{text}{list:?}");
            }
        }
    }
}

/// A table of a series has the units that were made in its rows.
#[test]
fn units_of_a_series_are_no_units_of_inertia() {
    const HEAD: &str = "ixx,iyy,izz,ixy,ixz,iyz,mass";
    for heading in ["unit", "Unit", "units", "UNIT"] {
        for (cell, is_thing) in [
            ("FM-1", true),
            ("EM", true),
            ("SN 007", true),
            ("007", true),
            ("vehicle B", true),
            ("G", true),
            ("T", true),
            ("T 1", true),
            ("FM in orbit", true),
            ("no. 1 (t)", true),
            ("TM-2", true),
            ("lbf·in·s²", false),
            ("lbf*in*s^2", false),
            ("lbf-in-s2", false),
            ("N·m·s²", false),
            ("oz in2", false),
            ("slinch in2", false),
            ("tonne mm2", false),
            ("MG mm2", false),
            ("lbmm2", false),
            ("gmcm2", false),
            ("inches", false),
            ("pounds", false),
            ("IPS", false),
            ("US", false),
            ("A17", true),
            ("lb in2", false),
            ("lbm", false),
            ("lb, in", false),
            ("kg mm²", false),
            ("g", false),
            ("mm", false),
            ("slug-ft^2", false),
        ] {
            let text = format!("{HEAD},{heading}\n3,4,5,0,0,0,10,\"{cell}\"\n");
            let file =
                InertiaFile::parse(Path::new("t.csv"), text.into_bytes(), Products::default())
                    .unwrap();
            let is_read = file.bodies().iter().all(|body| body.inertia().is_ok());
            assert_eq!(is_read, is_thing, "{heading} {cell}");
            // The column is not passed over without a word.
            let told: Vec<_> =
                file.gaps().iter().map(|gap| (gap.kind(), gap.line(), gap.keys())).collect();
            let keys = [heading.to_owned()];
            let expected =
                if is_thing { vec![(GapKind::Things, 1, &keys[..])] } else { Vec::new() };
            assert_eq!(told, expected, "{heading} {cell}");
        }
    }
}
