//! Lines of a table that are no rows: titles above its header, and comments above and below it.

use gyradius_formats::{InertiaFile, PartsTable, Products, TenTable};
use std::path::Path;

/// What a line says, and whether it refuses a table of mass centres, and one of first moments.
const LINES: [(&str, bool, bool); 8] = [
    ("Table 3", false, false),
    ("products = integrals", false, false),
    ("products: integrals, negated", true, true),
    ("weight in lb", true, true),
    ("Inertia in 10^-3 kg·m²", true, true),
    ("Inertia about the origin", true, false),
    ("Inertia about CG in kg m2", false, true),
    ("Ixy, Ixz and Iyz from surface integrals of the mesh", false, false),
];

/// Whatever the reader, a title counts above the header, a comment above and below, and a line within a quoted cell nowhere.
#[test]
fn titles_and_comments_count_and_quoted_cells_do_not() {
    for (said, of_centres, of_moments) in LINES {
        for place in 0..4 {
            for (c, is_refused) in [("C", of_centres), ("mc", of_moments)] {
                let header = format!("name,mass,{c}x,{c}y,{c}z,ixx,iyy,izz,ixy,ixz,iyz,Notes\n");
                let row = |note: &str| format!("a,1,0,0,0,5,6,7,0.5,0.1,0.2,{note}\n");
                let table = match place {
                    0 => format!("{said}\n{header}{}", row("")),
                    1 => format!("# {said}\n{header}{}", row("")),
                    2 => format!("{header}{}# {said}\n", row("\"two\nlines\"")),
                    _ => format!("{header}{}", row(&format!("\"see:\n# {said}\n\""))),
                };
                let (is_refused, sign) = match place {
                    3 => (false, 1.0),
                    _ if said == "products = integrals" => (is_refused, -1.0),
                    _ => (is_refused, 1.0),
                };
                let bytes = table.clone().into_bytes();
                let file = InertiaFile::parse(Path::new("t.csv"), bytes, Products::TensorEntries);
                let body = file.as_ref().ok().and_then(|file| file.bodies()[0].inertia().ok());
                let found = body.map(|body| body[(0, 1)]);
                assert_eq!(found, (!is_refused).then_some(0.5 * sign), "{table}{file:?}");
                let fitted = file.ok().and_then(|file| TenTable::of(&file).ok());
                let fitted = fitted.map(|table| table.rows()[0].values().unwrap()[7]);
                assert_eq!(fitted, (!is_refused).then_some(0.5 * sign), "{table}");
                if c == "C" {
                    let list = PartsTable::read(table.as_bytes(), Some(Products::TensorEntries));
                    let part = list.as_ref().ok().and_then(|list| list.rows()[0].numbers());
                    let found = part.map(|part| part.inertia().entries()[3]);
                    assert_eq!(found, (!is_refused).then_some(0.5 * sign), "{table}{list:?}");
                }
            }
        }
    }
}
