//! Units in the headings of tables: every pair of mass and area in every spelling, and what is no unit.

use gyradius_formats::{FileError, InertiaFile, PartsTable, Products, TenTable};
use std::{error::Error, path::Path};

/// In kg, and in m.
const MASSES: [(&str, f64); 8] = [
    ("kg", 1.0),
    ("g", 0.001),
    ("mg", 0.000_001),
    ("Mg", 1000.0),
    ("t", 1000.0),
    ("lb", 0.453_592_37),
    ("lbm", 0.453_592_37),
    ("slug", 14.593_902_937_206_364),
];
const LENGTHS: [(&str, f64); 5] =
    [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254), ("ft", 0.3048)];
const BETWEEN: [&str; 10] = ["", " ", "*", "·", "_", "-", "⋅", "×", ".", " * "];
const SQUARES: [&str; 5] = ["2", "^2", "²", "^{2}", "**2"];
/// What stands around a unit after a name.
const AROUND: [(&str, &str); 7] =
    [(" [", "]"), ("(", ")"), (" {", "}"), ("_", ""), (" ", ""), (" / ", ""), (" in ", "")];

fn checked(table: &[u8]) -> Result<InertiaFile, FileError> {
    InertiaFile::parse(Path::new("t.csv"), table.to_vec(), Products::TensorEntries)
}

fn ten(table: &[u8]) -> Result<TenTable, Box<dyn Error>> {
    Ok(TenTable::of(&checked(table)?)?)
}

fn is_near(found: f64, expected: f64) -> bool {
    (found / expected - 1.0).abs() < 1e-12
}

/// Calls with every spelling of every unit of inertia: the unit, what stands before and after it, its size in
/// SI, and the two readings of one that may be two.
fn each_inertia_unit(mut call: impl FnMut(&str, (&str, &str), f64, Option<[&str; 2]>)) {
    let mut count = 0;
    for (mass, kg) in MASSES {
        for (length, m) in LENGTHS {
            for (between, square) in BETWEEN.iter().flat_map(|b| SQUARES.map(|s| (b, s))) {
                for around in AROUND {
                    let unit = format!("{mass}{between}{length}{square}");
                    let two =
                        matches!((mass, *between, length), ("lb", "", "mm") | ("lbm", "", "m"));
                    call(&unit, around, kg * m * m, two.then_some(["lb·mm²", "lbm·m²"]));
                    count += 1;
                }
            }
        }
    }
    assert_eq!(count, 8 * 5 * 10 * 5 * 7);
}

fn upper(text: &str) -> String {
    // MG, which may be Mg or mg, is refused.
    if text.to_lowercase().contains("mg") { text.to_owned() } else { text.to_uppercase() }
}

/// `lbm m^2` was read as lb·mm², a millionth of it.
#[test]
fn every_unit_of_inertia_is_read_as_it_is_written_in_tables_that_are_checked() {
    each_inertia_unit(|unit, (before, after), si, two| {
        let below = format!("ixx,iyy,izz\n{unit},{unit},\n1,1,1\n");
        let beside = |unit: &str| format!("Ixx{before}{unit}{after},iyy,izz\n1,1,1\n");
        for table in [beside(unit), beside(&upper(unit)), below] {
            match (checked(table.as_bytes()), two) {
                (Ok(file), None) => {
                    let body = file.bodies().last().unwrap();
                    let found = body.inertia().unwrap()[(0, 0)];
                    assert!(file.bodies().len() == 1 && is_near(found, si), "{table}{found}");
                }
                (Err(error), Some(readings)) => {
                    let message = error.to_string();
                    assert!(message.starts_with("t.csv:1: malformed: column \""), "{message}");
                    assert!(readings.iter().all(|r| message.contains(r)), "{message}");
                }
                (found, _) => panic!("{table}{found:?}"),
            }
        }
        let large = beside(&unit.to_uppercase());
        if large.contains("MG") {
            let error = checked(large.as_bytes()).unwrap_err().to_string();
            assert!(error.contains("ixx is in") && error.contains("MG"), "{large}{error}");
        }
    });
}

#[test]
fn every_unit_of_inertia_is_read_as_it_is_written_in_lists_of_parts() {
    each_inertia_unit(|unit, (before, after), si, two| {
        let of = |name: &str| format!("{name}{before}{unit}{after}");
        let inertia = ["Ixx", "iyy", "izz", "sigma_ixx", "Iyy sigma", "sigma_products"].map(of);
        let table = format!(
            "name,mass,cx,cy,cz,{}\n\
             a,1,0,0,0,1,1,1,1,1,1\n",
            inertia.join(",")
        );
        match (PartsTable::read(table.as_bytes(), None), two) {
            (Ok(read), None) => {
                let part = read.rows()[0].numbers().unwrap();
                assert!(is_near(part.inertia().entries()[0], si), "{table}{part:?}");
                let [.., i11, i22, i33, i12, i13, i23] = part.deviations();
                let sigma = [i11, i22, i12, i13, i23];
                assert!(sigma.iter().all(|s| is_near(*s, si)) && i33 == 0.0, "{table}{part:?}");
                assert!(read.passed_over().is_empty(), "{table}");
            }
            (Err(error), Some(readings)) => {
                let message = error.to_string();
                assert!(message.starts_with("line 1: column \"Ixx"), "{message}");
                assert!(readings.iter().all(|r| message.contains(r)), "{message}");
            }
            (found, _) => panic!("{table}{found:?}"),
        }
        let table = format!("mass,cx,cy,cz,Ixx{before}{unit}{after},iyy,izz\n1,0,0,0,1,1,1\n");
        let ten = ten(table.as_bytes());
        let found = ten.map(|ten| ten.rows()[0].values().unwrap()[4]);
        assert!(found.is_ok_and(|found| is_near(found, si)) == two.is_none(), "{table}");
    });
}

#[test]
fn units_of_mass_and_length_are_read_after_every_mark() {
    for (before, after) in AROUND {
        for (mass, kg) in MASSES {
            let table = format!("mass{before}{mass}{after},ixx,iyy,izz\n1,1,1,1\n");
            let file = checked(table.as_bytes()).unwrap();
            assert!(is_near(file.bodies()[0].mass_kg().unwrap(), kg), "{table}");
            for (length, m) in LENGTHS {
                let table = format!(
                    "name,mass{before}{mass}{after},Cx{before}{length}{after},\
                     cy{before}{length}{after},cz{before}{length}{after},shape,\
                     sigma_mass{before}{mass}{after},centre_sigma{before}{length}{after}\n\
                     a,1,1,0,0,point,1,1\n"
                );
                let read = PartsTable::read(table.as_bytes(), None).unwrap();
                let part = read.rows()[0].numbers().unwrap();
                let [sigma_mass, _, _, sigma_z, ..] = part.deviations();
                assert!(is_near(part.mass_kg(), kg) && is_near(sigma_mass, kg), "{table}");
                assert!(is_near(part.mass_centre_m()[0], m) && is_near(sigma_z, m), "{table}");
            }
        }
    }
}

/// In an encoding that is not UTF-8, a dot and a square are bytes of which only the place tells what they are.
#[test]
fn dots_and_squares_in_other_encodings_are_read() {
    for (mass, kg) in MASSES {
        for (length, m) in LENGTHS {
            let heading = format!("ixx [{mass}·{length}²],iyy,izz\n1,1,1");
            let bytes: Vec<u8> =
                heading.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
            let found = checked(&bytes).unwrap().bodies()[0].inertia().unwrap()[(0, 0)];
            assert!(is_near(found, kg * m * m), "{heading}");
        }
    }
}

const TEN: [&str; 10] = ["mass", "cx", "cy", "cz", "ixx", "iyy", "izz", "ixy", "ixz", "iyz"];
const FIELDS: [&str; 10] =
    ["mass", "centre_x", "centre_y", "centre_z", "ixx", "iyy", "izz", "ixy", "ixz", "iyz"];

/// A column of a product in a unit that is not known was passed over, and the product was zero.
#[test]
fn a_number_in_a_unit_that_is_not_known_is_refused_and_never_passed_over() {
    for bad in ["N m s2", "oz in2", "kg m3", "kg m2/s", "stone", "kg·m²·s", "%/s"] {
        for (before, after) in AROUND {
            for at in 0..10 {
                let heading = format!("{}{before}{bad}{after}", TEN[at]);
                let is_percent = bad.contains('%');
                let known = match at {
                    0 => "it must be in kg, g, mg, t, lb, lbm or slug",
                    1..=3 => "it must be in m, cm, mm, in or ft",
                    _ => {
                        "it must be in kg, g, mg, t, lb, lbm or slug, times m², cm², mm², in² or ft²"
                    }
                };
                let said = |message: &str| {
                    message.contains(known) && message.contains(FIELDS[at]) && message.contains(bad)
                };
                let columns =
                    TEN.map(|name| if name == TEN[at] { heading.clone() } else { name.to_owned() });
                let list = format!("name,{}\na,1,0,0,0,1,1,1,0,0,0\n", columns.join(","));
                let message = PartsTable::read(list.as_bytes(), None).unwrap_err().to_string();
                assert!(message.starts_with("line 1: column "), "{message}");
                assert!(said(&message) || is_percent, "{heading}: {message}");
                if is_percent || (1..4).contains(&at) {
                    continue;
                }
                let deviation = PartsTable::read(
                    format!("name,mass,cx,cy,cz,shape,sigma_{heading}\na,1,0,0,0,point,1\n")
                        .as_bytes(),
                    None,
                );
                let message = deviation.unwrap_err().to_string();
                assert!(message.contains(&format!("sigma_{} is in", FIELDS[at])), "{message}");
                let message = checked(list.as_bytes()).unwrap_err().to_string();
                assert!(said(&message), "{heading}: {message}");
                assert!(ten(list.as_bytes()).is_err());
            }
        }
    }
}

/// Beside a column of a number, one of its name with more words is another column, if no mark says that they are a unit.
#[test]
fn other_words_make_another_column_beside_the_number() {
    let numbers = "mass,cx,cy,cz,ixx,iyy,izz,ixy,ixz,iyz";
    for name in TEN {
        for words in ["_source", " about the base", "_max", ""] {
            let extra =
                if words.is_empty() { format!("{name}ive") } else { format!("{name}{words}") };
            let table = format!("name,{numbers},{extra}\na,1,0,0,0,1,1,1,0,0,0,7\n");
            let read = PartsTable::read(table.as_bytes(), None).unwrap();
            assert_eq!(read.passed_over(), [extra.as_str()]);
            assert_eq!(
                checked(table.as_bytes()).unwrap().bodies()[0].inertia().unwrap()[(0, 1)],
                0.0
            );
        }
        for marked in [" [N m s2]", "/oz"] {
            let table = format!("name,{numbers},{name}{marked}\na,1,0,0,0,1,1,1,0,0,0,7\n");
            assert!(PartsTable::read(table.as_bytes(), None).is_err(), "{table}");
        }
    }
    // Deviations are other columns for who checks, and refused by their unit in a list.
    let table = "name,mass,ixx,iyy,izz,ixx_sigma,iyy (1σ),izz std [kg m2]\na,1,1,1,1,9,9,9\n";
    assert!(checked(table.as_bytes()).unwrap().bodies()[0].inertia().is_ok());
}

/// Products under a name that does not tell their sign were passed over without a word, and were zero.
#[test]
fn a_column_that_looks_like_a_product_is_refused_where_no_other_holds_it() {
    for word in ["P", "p_", "POI ", "J", "L", "Product ", "products_", "I_y", "Product of inertia "]
    {
        for pair in ["xy", "XZ", "yz", "zy", "12", "3-2"] {
            for unit in ["", " [kg m2]", "_kg_m2", " (lbm in2)"] {
                let name = if word == "I_y" { "Iyx".to_owned() } else { format!("{word}{pair}") };
                let heading = format!("{name}{unit}");
                let said = format!("column {heading:?} looks like a product of inertia");
                let table =
                    format!("name,mass,cx,cy,cz,ixx,iyy,izz,{heading}\na,1,0,0,0,1,1,1,.1\n");
                let list = PartsTable::read(table.as_bytes(), None).unwrap_err().to_string();
                assert!(list.starts_with(&format!("line 1: {said}")), "{list}");
                let message = checked(table.as_bytes()).unwrap_err().to_string();
                assert!(message.starts_with(&format!("t.csv:1: {said}")), "{message}");
                assert!(ten(table.as_bytes()).is_err());
                // Where the products themselves are there, it is another column.
                let table = format!(
                    "name,mass,cx,cy,cz,ixx,iyy,izz,ixy,ixz,iyz,{heading}\na,1,0,0,0,1,1,1,0,0,0,.1\n"
                );
                let read = PartsTable::read(table.as_bytes(), None).unwrap();
                assert_eq!(read.passed_over(), [heading.as_str()]);
                if word == "I_y" {
                    // The other half of the matrix is there as a whole or not at all.
                    let message = checked(table.as_bytes()).unwrap_err().to_string();
                    assert!(message.contains("iyx, izx, izy"), "{message}");
                    continue;
                }
                assert!(checked(table.as_bytes()).unwrap().bodies()[0].inertia().is_ok());
                assert!(ten(table.as_bytes()).is_ok());
            }
        }
    }
    for other in ["xy", "part 12", "proxy", "galaxy", "Pxyz", "height_12", "pair", "i1"] {
        let table = format!("name,mass,cx,cy,cz,ixx,iyy,izz,{other}\na,1,0,0,0,1,1,1,.1\n");
        assert!(PartsTable::read(table.as_bytes(), None).is_ok(), "{other}");
        assert!(checked(table.as_bytes()).is_ok(), "{other}");
    }
}
