//! Columns that state a unit beside columns that state none.

use super::{tests::read, *};
use proptest::prelude::*;

proptest! {
    /// Each column in SI, in another unit or in none that is stated: beside numbers in another unit, of any kind, none is read without.
    #[test]
    fn a_number_without_a_unit_is_never_guessed(
        stated in prop::array::uniform20(0_usize..6),
        allowed in prop::array::uniform3(prop::sample::subsequence(vec![0, 1, 2], 1..=3)),
    ) {
        let kinds = [("kg", "g", 1e-3), ("m", "mm", 1e-3), ("kg m2", "g mm2", 1e-9)];
        let kind = |i: usize| match i % 10 {
            0 => 0,
            1..=3 => 1,
            _ => 2,
        };
        let stated = std::array::from_fn::<usize, 20, _>(|i| {
            let allowed = &allowed[kind(i)];
            allowed[stated[i] % allowed.len()]
        });
        let columns: Vec<String> = stated
            .iter()
            .enumerate()
            .map(|(i, unit)| {
                let (si, other, _) = kinds[kind(i)];
                let unit = [String::new(), format!(" [{si}]"), format!(" [{other}]")][*unit].clone();
                format!("{}{}{unit}", if i < 10 { "" } else { "sigma_" }, heading::VALUES[i % 10])
            })
            .collect();
        let numbers: Vec<String> = (1..=20).map(|i| i.to_string()).collect();
        let text = format!("name,products,{}\na,tensor,{}\n", columns.join(","), numbers.join(","));
        let other = (0..20).find(|i| stated[*i] == 2);
        let unclear = (0..20).find(|i| stated[*i] == 0 && other.is_some());
        match (read(&text), unclear) {
            (Ok(table), None) => {
                let found = table.rows()[0].numbers().unwrap();
                let [x, y, z] = found.mass_centre_m();
                let values = [&[found.mass_kg(), x, y, z][..], &found.inertia().entries()].concat();
                let all = [values, found.deviations().to_vec()].concat();
                for (i, found) in all.into_iter().enumerate() {
                    let unit = if stated[i] == 2 { kinds[kind(i)].2 } else { 1.0 };
                    let expected = (i + 1) as f64 * unit;
                    prop_assert!((found / expected - 1.0).abs() < 1e-14, "{}: {found}", columns[i]);
                }
            }
            (Err(error), Some(i)) => {
                let said = format!(
                    "line 1: column {:?} states no unit, and column {:?} states one",
                    columns[i],
                    columns[other.unwrap()]
                );
                prop_assert!(error.to_string().starts_with(&said), "{error}");
            }
            (found, unclear) => prop_assert!(false, "{text}: {unclear:?}, {found:?}"),
        }
    }

    /// The same of all lengths: mass centres, radii of gyration, sizes, and the deviations that are lengths.
    #[test]
    fn a_length_without_a_unit_is_never_guessed(
        stated in prop::array::uniform11(0_usize..3),
        allowed in prop::sample::subsequence(vec![0, 1, 2], 1..=3),
    ) {
        let names = ["Cx", "Cy", "Cz", "kx", "ky", "kz", "radius", "sigma_Cx", "sigma_Cy", "sigma_Cz", "height"];
        let stated = stated.map(|unit| allowed[unit % allowed.len()]);
        let columns: Vec<String> =
            names.iter().zip(stated).map(|(name, unit)| format!("{name}{}", ["", "_m", "_mm"][unit])).collect();
        // The mass of the first is one, and of the second, a cylinder, 12.
        let text = format!(
            "name,mass_kg,shape,{}\na,1,,1,2,3,4,5,6,,7,8,9,\nb,12,cylinder,1,2,3,,,,1,7,8,9,2\n",
            columns.join(",")
        );
        let other = stated.iter().position(|unit| *unit == 2);
        match (read(&text), stated.iter().position(|unit| *unit == 0).zip(other)) {
            (Ok(table), None) => {
                let unit = |i: usize| if stated[i] == 2 { 1e-3 } else { 1.0 };
                for row in table.rows().iter().filter_map(PartRow::numbers) {
                    for i in 0..3 {
                        let lengths = [row.mass_centre_m()[i], row.deviations()[1 + i]];
                        let expected = [(i + 1) as f64 * unit(i), (i + 7) as f64 * unit(7 + i)];
                        prop_assert_eq!(lengths, expected);
                    }
                    let [i11, i22, i33, ..] = row.inertia().entries();
                    let (r, h) = (unit(6), 2.0 * unit(10));
                    let expected = if row.mass_kg() == 1.0 {
                        [3, 4, 5].map(|k| ((k + 1) as f64 * unit(k)).powi(2))
                    } else {
                        [3.0 * r * r + h * h, 3.0 * r * r + h * h, 6.0 * r * r]
                    };
                    for (found, expected) in [i11, i22, i33].into_iter().zip(expected) {
                        prop_assert!((found / expected - 1.0).abs() < 1e-12, "{}", text);
                    }
                }
            }
            (Err(error), Some((i, other))) => {
                let said = format!(
                    "line 1: column {:?} states no unit, and column {:?} states one",
                    columns[i], columns[other]
                );
                prop_assert!(error.to_string().starts_with(&said), "{}", error);
            }
            (found, unclear) => prop_assert!(false, "{}: {:?}, {:?}", text, unclear, found),
        }
    }
}
