//! Headings of tables that were dropped without a word, or read without what they say: products under other names, signs,
//! standard deviations.

use gyradius_formats::{InertiaFile, PartsTable, Products, TenMomentsFile, TenTable};
use proptest::prelude::*;
use std::path::Path;

const NUMBERS: &str = "name,products,mass,cx,cy,cz,ixx,iyy,izz";
const TEN: [(&str, &str); 10] = [
    ("mass", "kg"),
    ("cx", "m"),
    ("centre_y", "m"),
    ("mass_centre_3", "m"),
    ("Ixx", "kg m2"),
    ("I22", "kg m2"),
    ("i_zz", "kg m2"),
    ("Ixy", "kg m2"),
    ("I_xz", "kg m2"),
    ("i23", "kg m2"),
];

/// A table of one body with more columns than the moments, of which each cell is 0.1.
fn with(headings: &[&str]) -> String {
    let more: String = headings.iter().map(|heading| format!(",{heading}")).collect();
    format!("{NUMBERS}{more}\na,tensor,1,0,0,0,1,1,1{}\n", ",0.1".repeat(headings.len()))
}

/// A table of the ten, with other headings for some.
fn ten_with(heading: impl Fn(usize) -> String) -> String {
    let headings: Vec<String> = (0..10).map(heading).collect();
    format!("name,products,{}\na,tensor,1,0,0,0,1,1,1,0,0,0\n", headings.join(","))
}

/// Why a table is refused by who checks it, as a list of parts, and as samples.
fn refusals(table: &str) -> [Option<String>; 3] {
    let parse = || {
        let bytes = table.as_bytes().to_vec();
        InertiaFile::parse(Path::new("t.csv"), bytes, Products::TensorEntries)
    };
    let list = PartsTable::read(table.as_bytes(), None).err().map(|error| error.to_string());
    let checked = parse().err().map(|error| error.to_string());
    let ten = match parse() {
        Ok(file) => TenTable::of(&file).err().map(|error| error.to_string()),
        Err(error) => Some(error.to_string()),
    };
    [checked, list, ten]
}

fn assert_refused(table: &str, why: &str) {
    for refusal in refusals(table) {
        assert!(refusal.as_ref().is_some_and(|r| r.contains(why)), "{table}{refusal:?}");
    }
}

fn assert_read(table: &str) {
    assert_eq!(refusals(table), [const { None }; 3], "{table}");
}

#[test]
fn products_with_words_and_marks_around_their_name_are_refused() {
    const BOTH: [&str; 15] = [
        "POI I@",
        "P.O.I. I@",
        "Product of inertia I@",
        "prod_I@",
        "cg I@",
        "about_cg_I@",
        "payload_I@",
        "payload.I@",
        "minus I@",
        "neg_I@",
        "|i@|",
        "inertia_@",
        "Inertia @",
        "@_product",
        "K@",
    ];
    const LETTERS: [&str; 13] = [
        "$I_{@}$",
        "∫@",
        "∫@ dm",
        "mass product of inertia @",
        "I_cg_@",
        "Icg @",
        "I@G",
        "payloadI@",
        "d @",
        "D@",
        "tensor about cg @",
        "@ product of inertia",
        "1/I@",
    ];
    let letters = ["xy", "XZ", "yz"].map(|pair| (pair, &LETTERS[..]));
    let both = ["xy", "XZ", "yz", "12", "13", "23"].map(|pair| (pair, &BOTH[..]));
    for (pair, forms) in letters.into_iter().chain(both) {
        for form in forms {
            for unit in ["", " [kg m2]", "_kg_m2", " (lbm in2)"] {
                let heading = form.replace('@', pair) + unit;
                assert_refused(&with(&[&heading]), "looks like a product of inertia");
                // Where the three products themselves are there, it is another column; beside two, a list lacks the third.
                let all = with(&["ixy", "ixz", "iyz", &heading]);
                assert_read(&all);
                let read = PartsTable::read(all.as_bytes(), None).unwrap();
                assert_eq!(read.passed_over(), [heading.as_str()]);
                let two = with(&["ixy", "iyz", &heading]);
                assert!(refusals(&two).iter().all(Option::is_some), "{two}");
            }
        }
    }
    for apart in ["I₁₂", "inertia_x_y", "\"I(x, y)\"", "inertia x-z", "Iner.tensor I_xy", "Jyx"]
    {
        assert_refused(&with(&[apart]), "looks like a product of inertia");
    }
}

#[test]
fn columns_that_only_end_like_a_product_are_read_beside_the_moments() {
    for other in [
        "xy",
        "xy_plane_area",
        "oxy",
        "epoxy",
        "galaxy",
        "proxy",
        "onyx",
        "crazy",
        "part_12",
        "part 12",
        "bolt 12",
        "height_12",
        "Pxyz",
        "zxy",
        "IO12",
        "production_12",
        "inertia source",
        "product",
        "products id",
        "plane xy",
        "12",
        "i1",
        "x",
        "y",
        "ixy_sigma",
        "sigma_ixy [kg m2]",
        "Ixy (%)",
    ] {
        let table = with(&[other]);
        let [checked, list, ten] = refusals(&table);
        assert!(checked.is_none() && ten.is_none(), "{table}{checked:?}{ten:?}");
        let is_percent = other.contains('%');
        assert!(list.is_none() || is_percent, "{table}{list:?}");
    }
    for other in ["Ixy std", "I_xy sd", "dIxy", "u(Ixy)", "ΔI12", "Ixy ±"] {
        let [checked, list, ten] = refusals(&with(&[other]));
        assert!(checked.is_none() && ten.is_none(), "{other}: {checked:?}");
        assert!(list.unwrap().contains("is no standard deviation"), "{other}");
    }
}

proptest! {
    /// With whatever words around the name, no product is dropped without a word.
    #[test]
    fn no_product_is_dropped(
        before in prop::collection::vec("[a-df-hj-oq-z]{4,7}", 0..3),
        after in prop::collection::vec("[a-df-hj-oq-z]{4,7}", 0..3),
        name in prop::sample::select(vec!["Ixy", "ixz", "IYZ", "I_xy", "Iyx", "I12", "i23"]),
        between in prop::sample::select(vec![" ", "_", ".", ":", "|", " / ", "$", " - ", "-"]),
    ) {
        let words = [before.as_slice(), &[name.to_owned()], &after].concat();
        let table = with(&[&words.join(between)]);
        let [checked, list, ten] = refusals(&table);
        prop_assert!(checked.is_some() && ten.is_some(), "{table}");
        // A list of parts may have one product alone.
        let is_read = words.len() == 1 && name != "Iyx";
        prop_assert_eq!(list.is_none(), is_read, "{}{:?}", table, list);
    }

    /// A word that ends in two axes is a word, if nothing else speaks of products.
    #[test]
    fn no_other_word_is_taken_for_a_product(
        start in "[a-hj-w]{2,6}",
        pair in prop::sample::select(vec!["xy", "xz", "yz", "zx", "_12", " 13", "-23"]),
        end in prop::sample::select(vec!["", "_kg", " [m]", "_area", " of the plane"]),
    ) {
        prop_assume!(!["prod", "moment"].contains(&start.as_str()));
        let table = with(&[&format!("{start}{pair}{end}")]);
        prop_assert_eq!(refusals(&table), [const { None }; 3], "{}", table);
    }
}

#[test]
fn a_sign_in_a_heading_is_refused() {
    const FORMS: [&str; 10] =
        ["@N", "@ N", "(@N)", "_@N", "@N [U]", "@ N (U)", "N [@U]", "N (@ U)", "N @U", "N (@)"];
    for sign in ["-", "−", "+", "–", "－"] {
        for form in FORMS {
            for (at, (name, unit)) in TEN.into_iter().enumerate() {
                let heading = form.replace('@', sign).replace('N', name).replace('U', unit);
                let table =
                    ten_with(|i| if i == at { heading.clone() } else { TEN[i].0.to_owned() });
                let why = "a heading must not have a sign; a line \"# products = integrals\"";
                let [checked, list, ten] = refusals(&table);
                let is_centre = (1..4).contains(&at);
                for refusal in [checked.filter(|_| !is_centre), list, ten] {
                    let is_so = refusal.as_ref().map_or(is_centre, |r| r.contains(why));
                    assert!(is_so, "{table}{refusal:?}");
                }
                let deviation = heading.replace(name, &format!("sigma_{name}"));
                let list = PartsTable::read(
                    ten_with(|i| TEN[i].0.to_owned())
                        .replacen('\n', &format!(",{deviation}\n"), 1)
                        .as_bytes(),
                    None,
                );
                assert!(list.unwrap_err().to_string().contains(why), "{deviation}");
            }
        }
    }
    let below = "ixx,iyy,izz,ixy,ixz,iyz\nkg m2,,,-kg m2,,\n1,1,1,0,0,0\n";
    assert!(refusals(below)[0].as_ref().unwrap().contains("it must not have a sign"));
}

/// A power of ten was refused for a sign, with advice on products.
#[test]
fn the_sign_of_an_exponent_is_none_of_a_number() {
    for sign in ["-", "−", "+", ""] {
        for factor in ["10^@3", "10**@3", "10^{@3}", "1e@3", "×10^@6", "x 10^@3"] {
            for form in ["[F U]", "(F·U)", "[U × F]", "[F]"] {
                for (at, (name, unit)) in TEN.into_iter().enumerate() {
                    let unit = form.replace('F', &factor.replace('@', sign)).replace('U', unit);
                    is_refused_for_its_unit(at, name, &unit);
                }
            }
        }
    }
    for factor in ["10⁻³", "10⁺³", "10³"] {
        for (at, (name, unit)) in TEN.into_iter().enumerate() {
            is_refused_for_its_unit(at, name, &format!("[{factor} {unit}]"));
        }
    }
    // A unit to a negative power is another one, and a sign before a power is a sign.
    for unit in ["kg m^-2", "kg·m⁻²", "kg*m**-2", "-10^3 kg m2", "-10^-3 kg m2"] {
        let table = ten_with(|i| TEN[i].0.to_owned()).replacen("Ixx", &format!("Ixx [{unit}]"), 1);
        let refusals = refusals(&table);
        assert!(refusals.iter().all(Option::is_some), "{table}{refusals:?}");
    }
}

fn is_refused_for_its_unit(at: usize, name: &str, unit: &str) {
    let table = ten_with(|i| if i == at { format!("{name} {unit}") } else { TEN[i].0.to_owned() });
    let [checked, list, ten] = refusals(&table);
    let is_centre = (1..4).contains(&at);
    for refusal in [checked.filter(|_| !is_centre), list, ten] {
        let is_so = |said: &String| said.contains("it must be in") && !said.contains("sign");
        assert!(refusal.as_ref().map_or(is_centre, is_so), "{table}{refusal:?}");
    }
}

#[test]
fn a_dash_between_words_is_no_sign() {
    for dash in ["-", " - ", "_-_", "- "] {
        for (at, (name, unit)) in TEN.into_iter().enumerate() {
            for heading in [
                format!("{name}{dash}{unit}"),
                format!("{name}{dash}[{unit}]"),
                format!("{} [{}]", name.replace('_', "-"), unit.replace(' ', "-")),
            ] {
                let table =
                    ten_with(|i| if i == at { heading.clone() } else { TEN[i].0.to_owned() });
                assert_read(&table);
            }
        }
    }
    // Nor is a number below one a unit with a sign, nor a dash in a row of units a sign.
    let table = "name,ixx,iyy,izz,ixy,ixz,iyz\na,1,1,1,-0.1,-1e-3,-2\n";
    let bytes = table.as_bytes().to_vec();
    let file = InertiaFile::parse(Path::new("t.csv"), bytes, Products::TensorEntries).unwrap();
    assert_eq!(file.bodies()[0].inertia().unwrap()[(0, 1)], -0.1);
    let below = "name,ixx,iyy,izz,ixy,ixz,iyz\n-,kg m2,kg m2,kg m2,-,-,-\na,1,1,1,0,0,0\n";
    assert!(refusals(below)[0].is_none());
}

#[test]
fn a_sign_in_the_header_of_an_estimate_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("estimate.csv");
    let row = "1,0,0,0,1,1,1,0,0,0\n";
    for sign in ["", "-", "−", "+"] {
        for at in 0..10 {
            let names: Vec<String> = (0..10)
                .map(|i| format!("{}{}", if i == at { sign } else { "" }, TEN[i].0))
                .collect();
            std::fs::write(&path, format!("{}\n{}", names.join(","), row.repeat(11))).unwrap();
            match TenMomentsFile::read(&path) {
                Ok(_) => assert!(sign.is_empty()),
                Err(error) => {
                    let said = error.to_string();
                    assert!(!sign.is_empty() && said.contains("must not have a sign"), "{said}");
                }
            }
        }
    }
}

/// What spreadsheets and editors make of the line, in tables that are checked and in lists of parts.
#[test]
fn the_line_on_products_is_read_however_it_is_dressed() {
    let rows = "name,mass,cx,cy,cz,ixx,iyy,izz,ixy,ixz,iyz\na,1,0,0,0,1,1,1,.1,.1,.1\n";
    for (before, after) in
        [("# ", ""), (" # ", ""), ("\t#", ""), ("\"# ", "\",,,,,"), ("\"#", "\""), ("## ", ",,,,")]
    {
        for (said, sign) in [
            ("products = integrals", -1.0),
            ("Products: integrals", -1.0),
            ("products: +", -1.0),
            ("products = -", 1.0),
            ("Product convention: tensor", 1.0),
        ] {
            for end in ["\n", "\r\n"] {
                let line = format!("{before}{said}{after}{end}");
                for table in [format!("{line}{rows}"), format!("{rows}{line}")] {
                    let bytes = table.as_bytes().to_vec();
                    let file =
                        InertiaFile::parse(Path::new("t.csv"), bytes, Products::TensorEntries);
                    let file = file.unwrap();
                    assert_eq!(file.bodies().len(), 1, "{table}");
                    let found = file.bodies()[0].inertia().unwrap()[(0, 2)];
                    assert_eq!(found, sign * 0.1, "{table}");
                    let list = PartsTable::read(table.as_bytes(), None).unwrap();
                    let found = list.rows()[0].numbers().unwrap().inertia().entries()[4];
                    assert_eq!(found, sign * 0.1, "{table}");
                }
            }
        }
    }
}

#[test]
fn deviations_in_other_words_are_never_zero_without_a_word() {
    const FORMS: [&str; 18] = [
        "N_sd",
        "N SD",
        "sd N",
        "N stdev",
        "N_var",
        "N variance",
        "var(N)",
        "N_stderr",
        "N cv",
        "dN",
        "d_N",
        "ΔN",
        "Δ N",
        "∆N",
        "δN",
        "u(N)",
        "u_N",
        "delta_N",
    ];
    for (name, unit) in TEN {
        for form in FORMS {
            for unit in [String::new(), format!(" [{unit}]")] {
                let heading = format!("{}{unit}", form.replace('N', name));
                let table = ten_with(|i| TEN[i].0.to_owned());
                let table = table.replacen('\n', &format!(",{heading}\n"), 1);
                let table = format!("{},7\n", table.trim_end());
                let [checked, list, ten] = refusals(&table);
                assert!(checked.is_none() && ten.is_none(), "{table}{checked:?}{ten:?}");
                let list = list.unwrap_or_default();
                assert!(list.contains("is no standard deviation that is known"), "{table}{list}");
            }
        }
    }
    for other in
        ["density", "diameter", "dx", "d", "uid", "u", "variant", "sdk", "delta", "unit", "dm"]
    {
        assert_read(&with(&[other]).replace(",0.1", ",1"));
    }
}

/// Marks that part columns in other tables are a part of a name in quotes, and, where rows tell, of one without.
#[test]
fn marks_in_a_heading_part_nothing() {
    for separator in [",", ";", "\t"] {
        for name in ["a,b,c,d,e,f,g,h,i,j,k,l,m,n", "rate, deg/s", "a;b"] {
            for quoted in [true, name.contains(separator)] {
                let heading = if quoted { format!("\"{name}\"") } else { name.to_owned() };
                for first in [true, false] {
                    let table = with(&[]).replace(',', separator);
                    let lines = table.trim_end().lines().enumerate().map(|(i, line)| {
                        let cell = if i == 0 { heading.as_str() } else { "7" };
                        let [a, b] = if first { [cell, line] } else { [line, cell] };
                        format!("{a}{separator}{b}\n")
                    });
                    assert_read(&lines.collect::<String>());
                }
            }
        }
    }
}
