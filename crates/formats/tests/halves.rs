//! Products in either half of the tensor, which is symmetric.

use gyradius_formats::{
    InertiaFile, PartsTable, Products, Remedy, TenMomentsFile, TenTable, is_same_but_numbers,
};
use proptest::{prelude::*, sample::select};
use std::path::Path;

/// The names of each product above and below the diagonal.
const NAMES: [[[&str; 2]; 3]; 2] = [
    [["Ixy", "Iyx"], ["Ixz", "Izx"], ["Iyz", "Izy"]],
    [["i12", "I_21"], ["I13", "i31"], ["I_23", "I32"]],
];
const PRODUCTS: [f64; 3] = [0.1, -0.2, 0.3];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// `Ixy, Iyz, Izx` were refused. Whatever columns there are, in any order: all three products are read, in one half or in both, or the table is refused.
    #[test]
    fn a_product_may_stand_in_either_half(
        which in prop::array::uniform3(0..4_usize),
        order in Just([0, 1, 2, 3, 4, 5]).prop_shuffle(),
        names in select(&NAMES[..]),
        unit in select(&["", " [kg m2]"][..]),
        comment in select(&[("", 1.0), ("# products = integrals\n", -1.0)][..]),
    ) {
        // Neither half, the one above, the one below, or both.
        let is_there = |i: usize| which[i / 2] & (1 << (i % 2)) != 0;
        let there: Vec<usize> = order.into_iter().filter(|i| is_there(*i)).collect();
        let cells = |cell: &dyn Fn(usize) -> String| there.iter().map(|i| format!(",{}", cell(*i))).collect::<String>();
        let heads = cells(&|i| format!("{}{unit}", names[i / 2][i % 2]));
        let values = cells(&|i| PRODUCTS[i / 2].to_string());
        let text = |moment: f64| format!(
            "{}name,mass,cx,cy,cz,ixx{unit},iyy,izz{heads}\na,1,0,0,0,{moment},4,5{values}\n", comment.0
        );
        let of_file = |text: String| InertiaFile::parse(Path::new("t.csv"), text.into_bytes(), Products::default());
        let sign = if comment.0.is_empty() { 1.0 } else { comment.1 };
        let expected = [0, 1, 2].map(|k| if which[k] == 0 { 0.0 } else { sign * PRODUCTS[k] });

        let covered = which.iter().filter(|half| **half != 0).count();
        let is_read = (covered == 3 && [3, 6].contains(&there.len())) || there.is_empty();
        let file = of_file(text(3.0));
        prop_assert_eq!(file.is_ok(), is_read, "{}{:?}", text(3.0), file);
        if let Ok(file) = file {
            let ten = TenTable::of(&file).unwrap();
            prop_assert_eq!(&ten.rows()[0].values().unwrap()[7..], &expected[..]);
            let inertia = file.bodies()[0].inertia().unwrap();
            prop_assert_eq!(inertia, &inertia.transpose());
            // A repaired copy has the new numbers in the same columns.
            let before = text(30.0);
            let wrong = of_file(before.clone()).unwrap();
            let copy = wrong.repaired(&[(0, Remedy::Nearest)]).unwrap();
            prop_assert!(is_same_but_numbers(before.as_bytes(), &copy) && before.as_bytes() != copy);
            let mended = of_file(String::from_utf8(copy).unwrap()).unwrap();
            let mended = mended.bodies()[0].inertia().unwrap();
            prop_assert!((mended - mended.transpose()).amax() < 1e-12);
        }

        // A list may have some products alone above the diagonal, where the others are zero, and both halves in part.
        let has_lower = there.iter().any(|i| i % 2 == 1);
        let list = PartsTable::read(text(3.0).as_bytes(), Some(Products::TensorEntries));
        prop_assert_eq!(list.is_ok(), covered == 3 || !has_lower, "{}{:?}", text(3.0), list);
        if let Ok(list) = list {
            let found = list.rows()[0].numbers().unwrap().inertia().entries();
            prop_assert_eq!(&found[3..], &expected[..]);
            prop_assert!(list.passed_over().is_empty());
        }
    }

    /// The same of an estimate, whose ten columns hold each number once.
    #[test]
    fn an_estimate_may_name_either_half(
        which in prop::array::uniform3(0..2_usize),
        names in select(&NAMES[..]),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("estimate.csv");
        let heads = [0, 1, 2].map(|k| names[k][which[k]]).join(",");
        let row = "1,0,0,0,3,4,5,0.1,-0.2,0.3\n";
        std::fs::write(&path, format!("mass,cx,cy,cz,ixx,iyy,izz,{heads}\n{}", row.repeat(11))).unwrap();
        let estimate = TenMomentsFile::read(&path).unwrap();
        prop_assert_eq!(&estimate.mean()[7..], &PRODUCTS[..]);
    }
}
