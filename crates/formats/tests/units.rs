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
/// Other words for some of them.
const SAME_MASSES: [(&str, &str); 2] = [("lbs", "lb"), ("slugs", "slug")];
const SAME_LENGTHS: [(&str, &str); 2] = [("inch", "in"), ("inches", "in")];
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

/// A spelling of a unit of inertia.
struct Spelling {
    unit: String,
    /// What stands before and after it.
    around: (&'static str, &'static str),
    kg_m2: f64,
}

impl Spelling {
    fn after(&self, name: &str) -> String {
        let ((before, after), unit) = (self.around, &self.unit);
        format!("{name}{before}{unit}{after}")
    }

    fn upper(&self) -> Self {
        Self { unit: upper(&self.unit), ..*self }
    }
}

/// All spellings that have one reading, and those that have two.
fn spellings() -> [Vec<Spelling>; 2] {
    let [mut clear, mut ambiguous] = [Vec::new(), Vec::new()];
    for (mass, kg) in MASSES {
        for (length, m) in LENGTHS {
            for (between, square) in BETWEEN.iter().flat_map(|b| SQUARES.map(|s| (b, s))) {
                for around in AROUND {
                    let unit = format!("{mass}{between}{length}{square}");
                    let is_ambiguous =
                        matches!((mass, *between, length), ("lb", "", "mm") | ("lbm", "", "m"));
                    let of = if is_ambiguous { &mut ambiguous } else { &mut clear };
                    of.push(Spelling { unit, around, kg_m2: kg * m * m });
                }
            }
        }
    }
    assert_eq!(clear.len() + ambiguous.len(), 8 * 5 * 10 * 5 * 7);
    [clear, ambiguous]
}

/// Spellings side by side in one table. Seven stand around each unit, so that all of them come into every column of `N`,
/// which is not seven.
fn side_by_side<const N: usize>(spellings: &[Spelling]) -> impl Iterator<Item = [&Spelling; N]> {
    let beyond = move |i: usize| &spellings[i.min(spellings.len() - 1)];
    (0..spellings.len()).step_by(N).map(move |first| std::array::from_fn(|i| beyond(first + i)))
}

/// All spellings of each unit: a table that is checked has one unit for all moments.
fn of_one_unit(spellings: &[Spelling]) -> impl Iterator<Item = &[Spelling]> {
    spellings.chunk_by(|a, b| a.kg_m2 == b.kg_m2)
}

fn names_both_readings(message: &str) -> bool {
    ["lb·mm²", "lbm·m²"].iter().all(|reading| message.contains(reading))
}

fn upper(text: &str) -> String {
    // MG, which may be Mg or mg, is refused.
    if text.to_lowercase().contains("mg") { text.to_owned() } else { text.to_uppercase() }
}

/// `lbm m^2` was read as lb·mm², a millionth of it.
#[test]
fn every_unit_of_inertia_is_read_as_it_is_written_in_tables_that_are_checked() {
    const NAMES: [&str; 3] = ["Ixx", "iyy", "izz"];
    let beside = |spellings: [&Spelling; 3]| {
        let names: [String; 3] = std::array::from_fn(|i| spellings[i].after(NAMES[i]));
        format!("{}\n1,1,1\n", names.join(","))
    };
    let below = |[a, b, c]: [&Spelling; 3]| {
        format!("ixx,iyy,izz\n{},{},{}\n1,1,1\n", a.unit, b.unit, c.unit)
    };
    let [clear, ambiguous] = spellings();
    for spellings in of_one_unit(&clear).flat_map(side_by_side::<3>) {
        let [a, b, c] = spellings.map(Spelling::upper);
        for table in [beside(spellings), beside([&a, &b, &c]), below(spellings)] {
            let file = checked(table.as_bytes()).unwrap();
            let found = file.bodies().last().unwrap().inertia().unwrap();
            assert_eq!(file.bodies().len(), 1, "{table}");
            for (i, spelling) in spellings.iter().enumerate() {
                assert!(is_near(found[(i, i)], spelling.kg_m2), "{table}{found}");
            }
        }
        for spelling in spellings {
            let large = Spelling { unit: spelling.unit.to_uppercase(), ..*spelling };
            if large.unit.contains("MG") {
                let table = format!("{},iyy,izz\n1,1,1\n", large.after("Ixx"));
                let error = checked(table.as_bytes()).unwrap_err().to_string();
                assert!(error.contains("ixx is in") && error.contains("MG"), "{table}{error}");
            }
        }
    }
    for spelling in &ambiguous {
        for table in [beside([spelling; 3]), beside([&spelling.upper(); 3]), below([spelling; 3])] {
            let message = checked(table.as_bytes()).unwrap_err().to_string();
            assert!(message.starts_with("t.csv:1: malformed: column \""), "{message}");
            assert!(names_both_readings(&message), "{message}");
        }
    }
}

#[test]
fn every_unit_of_inertia_is_read_as_it_is_written_in_lists_of_parts() {
    const NAMES: [&str; 6] = ["Ixx", "iyy", "izz", "sigma_ixx", "Iyy sigma", "sigma_products"];
    let parts = |spellings: [&Spelling; 6]| {
        let names: [String; 6] = std::array::from_fn(|i| spellings[i].after(NAMES[i]));
        format!("name,mass_kg,cx_m,cy_m,cz_m,{}\na,1,0,0,0,1,1,1,1,1,1\n", names.join(","))
    };
    let ten_columns = |spellings: [&Spelling; 3]| {
        let names: [String; 3] = std::array::from_fn(|i| spellings[i].after(NAMES[i]));
        format!("mass_kg,cx_m,cy_m,cz_m,{}\n1,0,0,0,1,1,1\n", names.join(","))
    };
    let [clear, ambiguous] = spellings();
    for spellings in side_by_side::<6>(&clear) {
        let table = parts(spellings);
        let read = PartsTable::read(table.as_bytes(), None).unwrap();
        let part = read.rows()[0].numbers().unwrap();
        let [.., i11, i22, i33, i12, i13, i23] = part.deviations();
        let [xx, yy, zz, ..] = part.inertia().entries();
        assert!(i33 == 0.0 && i12 == i13 && i13 == i23, "{table}{part:?}");
        for (found, spelling) in [xx, yy, zz, i11, i22, i12].into_iter().zip(spellings) {
            assert!(is_near(found, spelling.kg_m2), "{table}{part:?}");
        }
        assert!(read.passed_over().is_empty(), "{table}");
    }
    for spellings in of_one_unit(&clear).flat_map(side_by_side::<3>) {
        let table = ten_columns(spellings);
        let found = ten(table.as_bytes()).unwrap();
        let found = &found.rows()[0].values().unwrap()[4..7];
        assert!(found.iter().zip(spellings).all(|(x, s)| is_near(*x, s.kg_m2)), "{table}");
    }
    for spelling in &ambiguous {
        let message = PartsTable::read(parts([spelling; 6]).as_bytes(), None).unwrap_err();
        let message = message.to_string();
        assert!(message.starts_with("line 1: column \"Ixx"), "{message}");
        assert!(names_both_readings(&message), "{message}");
        assert!(ten(ten_columns([spelling; 3]).as_bytes()).is_err());
    }
}

#[test]
fn units_of_mass_and_length_are_read_after_every_mark() {
    for (before, after) in AROUND {
        for (mass, kg) in MASSES {
            let table = format!("mass{before}{mass}{after},ixx [kg m2],iyy,izz\n1,1,1,1\n");
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

#[test]
fn units_in_other_words_are_the_same() {
    let find = |all: &[(&str, f64)], name: &str| {
        all.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, si)| *si)
    };
    let masses: Vec<(&str, f64)> = MASSES
        .into_iter()
        .chain(SAME_MASSES.map(|(name, same)| (name, find(&MASSES, same))))
        .collect();
    let lengths: Vec<(&str, f64)> = LENGTHS
        .into_iter()
        .chain(SAME_LENGTHS.map(|(name, same)| (name, find(&LENGTHS, same))))
        .collect();
    for (mass, kg) in &masses {
        for (length, m) in &lengths {
            for (between, square) in [(" ", "2"), ("·", "²"), ("*", "^2"), ("_", "**2")] {
                let table = format!(
                    "mass [{mass}],cx_{length},cy,cz,ixx ({mass}{between}{length}{square}),iyy,izz\n1,1,0,0,1,1,1\n"
                );
                let found = ten(table.as_bytes()).unwrap();
                let values = found.rows()[0].values().unwrap();
                for (found, expected) in
                    [(values[0], *kg), (values[1], *m), (values[4], kg * m * m)]
                {
                    assert!(is_near(found, expected), "{table}{values:?}");
                }
            }
        }
    }
}

/// Mass, mass centre and inertia, each in a unit of SI, in another or in none that is stated, beside titles that speak of units or not: where one
/// says that it is not in SI, none is read without a unit.
#[test]
fn a_kind_of_number_without_a_unit_is_never_guessed_beside_another() {
    const UNITS: [[&str; 3]; 3] =
        [["", "_kg", " (lb)"], ["", "_m", " (in)"], ["", " [kg m2]", " [lb in2]"]];
    let headings = |pick: [usize; 3], all: bool| {
        let unit = |kind: usize, is_first: bool| {
            // One unit holds for the columns of a kind that state none.
            UNITS[kind][if is_first || all { pick[kind] } else { 0 }]
        };
        let (m, [cx, c], [ixx, i]) =
            (unit(0, true), [unit(1, true), unit(1, false)], [unit(2, true), unit(2, false)]);
        format!("name,mass{m},Cx{cx},Cy{c},Cz{c},Ixx{ixx},Iyy{i},Izz{i}\na,1,2,3,4,5,6,7\n")
    };
    let picks = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]);
    // A title, and whether it speaks of other units. Comments may stand below the header, too.
    const TITLES: [(&str, bool); 12] = [
        ("", false),
        ("Table 3\n", false),
        ("# Unit FT-2 of the series\n", false),
        ("# Units: SI\n", false),
        ("All units: lb, in, lb-in2\n", true),
        ("# units = mm\n", true),
        ("# Mass in lb, lengths in inches\n", true),
        ("Mass Properties (lbm, in)\n", true),
        (",Mass [kg],Centre of gravity [mm],,,Moments of inertia [kg·mm²],,\n", true),
        (",kg,mm,mm,mm,kg mm2,kg mm2,kg mm2\n", true),
        ("# units,kg,mm,mm,mm,kg mm2,kg mm2,kg mm2\n", true),
        ("# kg,mm,mm,mm,kg mm2,kg mm2,kg mm2\n", true),
    ];
    for (pick, (title, is_other), below) in picks.flat_map(|pick| {
        let places = move |(title, is_other): (&'static str, bool)| {
            let below =
                [false, true].into_iter().filter(move |below| !below || title.starts_with('#'));
            below.map(move |below| (pick, (title, is_other), below))
        };
        TITLES.into_iter().flat_map(places)
    }) {
        let lacks = |of: &[usize]| {
            let mixed = of.iter().any(|i| pick[*i] == 0) && of.iter().any(|i| pick[*i] == 2);
            mixed || is_other && of.iter().any(|i| pick[*i] == 0)
        };
        let with_title = |table: String| {
            if below {
                table.replacen('\n', &format!("\n{title}"), 1)
            } else {
                format!("{title}{table}")
            }
        };
        // The header may be a comment.
        for (all, mark) in [true, false].into_iter().flat_map(|all| [(all, ""), (all, "# ")]) {
            let table = with_title(format!("{mark}{}", headings(pick, all)));
            // `check` reads no mass centre.
            let found = checked(table.as_bytes()).map_err(|error| error.to_string());
            assert_eq!(found.is_err(), lacks(&[0, 2]), "{table}{found:?}");
            let fitted = ten(table.as_bytes()).map_err(|error| error.to_string());
            assert_eq!(fitted.is_err(), lacks(&[0, 1, 2]), "{table}{fitted:?}");
            for message in [found.err(), fitted.err()].into_iter().flatten() {
                let said = ["states no unit, and column", "speaks of units that are not"];
                assert!(said.iter().any(|said| message.contains(said)), "{message}");
            }
        }
        let table = with_title(headings(pick, true));
        let list = PartsTable::read(table.as_bytes(), None).map_err(|error| error.to_string());
        assert_eq!(list.is_err(), lacks(&[0, 1, 2]), "{table}{list:?}");
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
                    0 => "it must be in kg, g, mg, t, lb, lbs, lbm, slug or slugs",
                    1..=3 => "it must be in m, cm, mm, in, inch, inches or ft",
                    _ => {
                        "it must be in kg, g, mg, t, lb, lbs, lbm, slug or slugs, times m², cm², mm², in², inch², inches² or ft²"
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
        for words in ["_source", " about the base", "_target", ""] {
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
                let read = PartsTable::read(table.as_bytes(), None);
                if word == "I_y" {
                    let refused = read.unwrap_err().to_string();
                    let is_lacking = unit == " (lbm in2)";
                    let why = if is_lacking { "states no unit" } else { "contradict each other" };
                    assert!(refused.contains(why), "{refused}");
                    // The other half of the matrix is there as a whole or not at all.
                    let message = checked(table.as_bytes()).unwrap_err().to_string();
                    assert!(message.contains("iyx, izx, izy"), "{message}");
                    continue;
                }
                assert_eq!(read.unwrap().passed_over(), [heading.as_str()]);
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
