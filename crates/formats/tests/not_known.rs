//! Words for what is not known, in lists of parts: none of them is a number.

use gyradius_formats::{PartsTable, Products};
use proptest::{prelude::*, sample::select};

const HEAD: &str = "name,mass,cx,cy,cz,ixx,iyy,izz,ixy,ixz,iyz,sigma_mass,sigma_centre,sigma_ixx,sigma_products,mass_percent,qx,qy,qz,qw,qty";
const WORDS: [&str; 9] = ["NA", "n/a", "N/A", "nan", "NaN", "null", "none", "-", "?"];

fn read(text: &str) -> Result<PartsTable, String> {
    PartsTable::read(text.as_bytes(), Some(Products::TensorEntries))
        .map_err(|error| error.to_string())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// `sigma_mass = NA` was a deviation of zero.
    #[test]
    fn no_word_is_a_number(
        word in select(WORDS.to_vec()),
        at in prop::collection::btree_set(1..21_usize, 1..4),
    ) {
        let heads: Vec<&str> = HEAD.split(',').collect();
        let mut cells = vec!["a", "1", "0", "0", "0", "1", "1", "1", "", "", "", "", "", "", "", "", "", "", "", "", ""];
        let known = read(&format!("{HEAD}\n{}\n", cells.join(",")));
        prop_assert!(known.is_ok(), "{known:?}");
        for at in &at {
            cells[*at] = word;
        }
        let error = read(&format!("{HEAD}\n{}\n", cells.join(","))).unwrap_err();
        prop_assert!(error.starts_with("line 2: a: "), "{error}");
        // The value that is missing is named by its field, any other one by its column or field.
        if word == "NA" && at.iter().all(|at| *at > 7) {
            let heading = heads[*at.first().unwrap()];
            prop_assert!(error.starts_with(&format!("line 2: a: column {heading:?} says \"NA\"")), "{error}");
        }
    }
}

/// An assembly of R has no number at all, and a point or a shape none of the inertia.
#[test]
fn rows_of_r_without_numbers_are_read() {
    let text = format!("{HEAD}\nall{}\na,1,0,0,0,1,1,1{}\n", ",NA".repeat(20), ",".repeat(13));
    assert!(read(&text).unwrap().rows()[0].numbers().is_none());
    let head = "name,mass,cx,cy,cz,shape,radius_m,ixx,iyy,izz,ixy,sigma_mass,sigma_ixx";
    for row in [
        "a,1,0,0,0,point,NA,NA,NA,NA,NA,0.1,NA",
        "a,1,0,0,0,sphere,1,NA,NA,NA,NA,0.1,0.1",
        "a,1,0,0,0,NA,NA,1,1,1,0,0.1,0",
    ] {
        let table = read(&format!("{head}\n{row}\n")).unwrap();
        assert_eq!(table.rows()[0].numbers().unwrap().deviations()[0], 0.1, "{row}");
    }
    let error = read(&format!("{head}\na,1,0,0,0,sphere,1,NA,NA,NA,NA,0.1,NA\n")).unwrap_err();
    assert!(error.contains("\"sigma_ixx\" says"), "{error}");
}
