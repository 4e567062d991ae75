//! Lists of parts as spreadsheets have them: titles, rows of units, totals, columns of other things.

use super::{PartRow, tests::read};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Headings may have line breaks in quotation marks, in every place and with every separator: the list is the same.
    #[test]
    #[test]
    fn headings_may_have_line_breaks(
        broken in prop::array::uniform8(any::<bool>()),
        (separator, end, quoted) in (prop::sample::select(vec![",", ";", "\t"]), prop::sample::select(vec!["\n", "\r\n"]), any::<bool>()),
        has_title: bool,
    ) {
        const HEADINGS: [&str; 8] = ["Part name", "Mass (kg)", "Cx (m)", "Cy (m)", "Cz (m)", "Ixx (kg m2)", "Iyy (kg m2)", "Izz (kg m2)"];
        let heading = |(text, is_broken): (&&str, &bool)| match (is_broken, quoted) {
            (true, _) => format!("\"{}\"", text.replacen(' ', end, 1)),
            (false, true) => format!("\"{text}\""),
            (false, false) => (*text).to_owned(),
        };
        let header: Vec<String> = HEADINGS.iter().zip(&broken).map(heading).collect();
        let rows = ["tank", "2", "0", "1", "0", "1", "1", "1"].join(separator);
        let title = if has_title { "Parts of a 12\" tube".to_owned() + end } else { String::new() };
        let text = format!("{title}{}{end}{rows}{end}", header.join(separator));
        let table = read(&text);
        let table = table.map_err(|error| TestCaseError::fail(format!("{text}{error}")))?;
        let numbers = table.rows()[0].numbers().unwrap();
        prop_assert_eq!((table.rows()[0].name(), numbers.mass_kg()), ("tank", 2.0));
    }


    /// As spreadsheets have them: titles above, the units in a row of their own, some columns without.
    #[test]
    fn titles_and_rows_of_units_are_read(
        titles in proptest::collection::vec("[A-Za-z\" ;]{0,20}", 0..4),
        separator in proptest::sample::select(vec![",", ";", "\t"]),
        (mass, kg) in proptest::sample::select(vec![("kg", 1.0), ("lb", 0.45359237), ("[g]", 1e-3)]),
        (length, m) in proptest::sample::select(vec![("m", 1.0), ("in", 0.0254), ("(mm)", 1e-3)]),
        (inertia, kg_m2) in proptest::sample::select(vec![("kg m2", 1.0), ("lb in2", 0.45359237 * 0.0254 * 0.0254)]),
        above in any::<[bool; 3]>(),
        percent in any::<bool>(),
    ) {
        let names = ["name", "mass", "Cx", "Cy", "Cz", "Ixx", "Iyy", "Izz", "sigma_mass"];
        let dimension = |i: usize| match i { 1 | 8 => 0, 2..=4 => 1, _ => 2 };
        let of = [mass, length, inertia];
        let deviation = if percent { "%" } else { mass };
        let unit = |i: usize| if i == 8 { deviation } else { of[dimension(i)] };
        // The unit stands in the heading, in the row below, or in both.
        let heads = (0..9).map(|i| {
            let bare = unit(i).trim_matches(['[', ']', '(', ')']);
            if i > 0 && above[dimension(i)] { format!("{} [{bare}]", names[i]) } else { names[i].to_owned() }
        });
        let heads: Vec<String> = heads.collect();
        let units: Vec<&str> = (0..9).map(|i| if i == 0 { "" } else { unit(i) }).collect();
        let row = ["arm", "2", "3", "4", "5", "60", "70", "80", "0.5"];
        let title: String = titles.iter().map(|title| format!("{title}\n")).collect();
        let lines = [heads.join(separator), units.join(separator), row.join(separator)].join("\n");
        let text = format!("{title}{lines}\n");
        let read = read(&text).unwrap_or_else(|error| panic!("{text}{error}"));
        let numbers = read.rows()[0].numbers().unwrap();
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        prop_assert!(near(numbers.mass_kg(), 2.0 * kg), "{}{:?}", text, numbers);
        prop_assert!(near(numbers.mass_centre_m()[2], 5.0 * m), "{}{:?}", text, numbers);
        prop_assert!(near(numbers.inertia().entries()[1], 70.0 * kg_m2), "{}{:?}", text, numbers);
        let sigma = if percent { 0.01 * 2.0 * kg * 0.5 } else { 0.5 * kg };
        prop_assert!(near(numbers.deviations()[0], sigma), "{}{:?}", text, numbers);
    }

    /// The total of any parts is one, and another body of the same mass is none.
    #[test]
    fn a_total_under_another_name_is_seen(
        parts in proptest::collection::vec((0.1..100.0, proptest::array::uniform3(-3.0..3.0)), 2..8),
        place in any::<prop::sample::Index>(),
    ) {
        let raw = &parts.clone();
        let mass: f64 = parts.iter().map(|(mass, _)| mass).sum();
        let centre = |axis: usize| parts.iter().map(|(m, c): &(f64, [f64; 3])| m * c[axis]).sum::<f64>() / mass;
        let row = |name: &str, mass: f64, c: [f64; 3]| {
            format!("{name},{mass:.5},{:.5},{:.5},{:.5},1,1,1", c[0], c[1], c[2])
        };
        let mut rows: Vec<String> = parts.iter().map(|(m, c)| row("part", *m, *c)).collect();
        let plain = rows.join("\n");
        let head = "name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz\n";
        let totals = |rows: &[String]| -> Vec<String> {
            let table = read(&format!("{head}{}", rows.join("\n"))).unwrap();
            table.like_totals().iter().map(|row| row.name().to_owned()).collect()
        };
        prop_assert!(totals(&rows).is_empty());
        let total = |name: &str| row(name, mass, [0, 1, 2].map(centre));
        // Above all or below all; and, below it, one that says nothing new, and one with a margin.
        let first = place.index(2) == 0;
        rows.insert(if first { 0 } else { rows.len() }, total("craft"));
        prop_assert_eq!(totals(&rows), ["craft"]);
        if !first {
            rows.push(row("with margin", 1.1 * mass, [0, 1, 2].map(centre)));
            prop_assert_eq!(totals(&rows), ["craft"]);
        }
        // A name that speaks of a sum is believed if the numbers say so, of the rows since the last sum too.
        let mut named = rows.clone();
        named.retain(|row| row.starts_with("part"));
        let parts = named.clone();
        named.push(total("Bus subtotal"));
        let refused = read(&format!("{head}{}", named.join("\n"))).unwrap_err().to_string();
        prop_assert!(refused.contains("Bus subtotal: the name is that of a row which sums up others"), "{}", refused);
        // Of one row too, if the name can be nothing else; a part may be as heavy as another at the same place.
        let at = place.index(parts.len());
        let (of, c) = &raw[at];
        let twice = |name: &str| {
            let mut rows = parts.clone();
            rows.insert(at + 1, row(name, *of, *c));
            read(&format!("{head}{}", rows.join("\n"))).map(|_| ()).map_err(|error| error.to_string())
        };
        for name in ["part subtotal", "Sum of part", "part total"] {
            let refused = twice(name).unwrap_err();
            prop_assert!(refused.contains(&format!("{name}: the name is that of a row which sums")), "{}", refused);
        }
        for name in ["total pressure sensor", "sump"] {
            prop_assert_eq!(twice(name), Ok(()));
        }
        named = [row("total pressure sensor", 0.01, [9.0; 3])].into_iter().chain(parts).collect();
        prop_assert!(totals(&named).is_empty());
        named.push(total("Payload total"));
        let text = format!("{head}{}", named.join("\n"));
        prop_assert!(read(&text).is_err(), "{}", text);
        let other = row("craft", mass, [centre(0) + 0.5, centre(1), centre(2)]);
        let table = read(&format!("{head}{plain}\n{other}")).unwrap();
        prop_assert!(table.like_totals().is_empty());
    }
}

/// What would change the sum is not passed over, and what says nothing is.
#[test]
fn columns_that_would_change_a_row_are_refused() {
    let with = |heading: &str, cell: &str, name: &str| {
        let table =
            format!("name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,{heading}\n{name},1,0,0,0,1,1,1,{cell}\n");
        read(&table).map(|_| ()).map_err(|error| error.to_string())
    };
    for (heading, neutral, changing, why) in [
        ("qty", "1", "100", "a row is one part"),
        ("Quantity", "1.0", "2 off", "a row is one part"),
        ("roll_deg", "0", "90", "angles are not read"),
        ("rpy", "0 0 0", "0 1.57 0", "angles are not read"),
        ("growth", "0 %", "1.1", "no growth allowance"),
        ("MGA %", "0", "15%", "no growth allowance"),
        ("mass margin [%]", "-", "10", "no growth allowance"),
        // The allowance of a standard.
        ("mass margin [%]", "none", "AIAA", "no growth allowance"),
        ("growth", "n/a", "four", "no growth allowance"),
        ("yaw", "none", "ninety", "angles are not read"),
        ("Total Qty", "One", "3 off", "a row is one part"),
        ("qty", "1x", "four", "a row is one part"),
        ("count", "× 1", "each", "a row is one part"),
        ("No. off", "1", "a pair", "a row is one part"),
        ("pcs", "1", "½", "a row is one part"),
        ("Menge", "1", "-", "a row is one part"),
        ("q1", "0", "0.7", "angles are not read"),
        ("unit", "kg", "g", "must stand in its heading"),
        ("length unit", "m", "mm", "must stand in its heading"),
        ("inertia_units", "kg m^2", "kg mm2", "must stand in its heading"),
        ("mass units", "kg", "lb", "must stand in its heading"),
        ("Number of parts", "1", "4", "a row is one part"),
        ("n_parts", "1", "4", "a row is one part"),
        ("number", "1", "4", "a row is one part"),
        ("num", "one", "four", "a row is one part"),
        ("multiplier", "1.0", "0.5", "a row is one part"),
        ("mult", "x1", "x4", "a row is one part"),
        ("amount", "1", "4", "a row is one part"),
        ("unit qty", "1", "4", "a row is one part"),
        ("R11", "0", "0.5", "angles are not read"),
        ("rotation matrix", "identity", "0 1 0; -1 0 0; 0 0 1", "angles are not read"),
        ("inertia about", "CG", "origin", "about its own mass centre"),
        ("MOI about", "own mass centre", "base", "about its own mass centre"),
    ] {
        assert_eq!(with(heading, neutral, "bus"), Ok(()), "{heading}");
        assert_eq!(with(heading, "", "bus"), Ok(()), "{heading}");
        let message = with(heading, changing, "bus").unwrap_err();
        assert!(message.contains(why) && message.contains(heading), "{message}");
    }
    for heading in [
        "pitch diameter [mm]",
        "Roll number",
        "thermal margin",
        "Quantity price",
        "item number",
        "part no.",
    ] {
        assert_eq!(with(heading, "7", "bus"), Ok(()), "{heading}");
    }
    // In a row of units below the header, what a column cannot have.
    for (column, unit, cell) in [
        ("mass_percent", "% (3σ)", "5"),
        ("mass_percent", "‰", "5"),
        ("moments_percent", "fraction", "0.05"),
        ("Ixx_percent", "kg m2", "5"),
        ("attitude_x", "deg", "0"),
        ("sigma_mass", "kg (3σ)", "1"),
    ] {
        let table = format!(
            "name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,{column}\n,kg,m,m,m,kg m2,kg m2,kg m2,{unit}\nit,1,0,0,0,1,1,1,{cell}\n"
        );
        let message = read(&table).unwrap_err().to_string();
        assert!(message.contains(column), "{message}");
    }
    // An index beside names, and names that begin like comments.
    let table = "#,id,name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,mass_percent\n1,7,bus,1,0,0,0,1,1,1,5%\n#2,8,tank,1,0,0,0,1,1,1,\n";
    assert_eq!(read(table).unwrap().rows()[0].numbers().unwrap().deviations()[0], 0.05);
    let table = "name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz\n# old,1\n#2 thruster,1,0,0,0,1,1,1\n#a,1,2\n#3,1,0,0,0,1,1,1\n";
    let names =
        read(table).unwrap().rows().iter().map(|row| row.name().to_owned()).collect::<Vec<_>>();
    assert_eq!(names, ["#2 thruster", "#3", "whole"]);
    assert!(with("uncertainty", "5%", "bus").unwrap_err().contains("no standard deviation"));
    // An assembly may be called a total; a part may not.
    assert!(with("note", "", "Total").unwrap_err().contains("sums up others"));
    let assembly =
        "name,parent,mass,Cx,Cy,Cz,Ixx,Iyy,Izz\nTotal,,,,,,,,\nbus,Total,1,0,0,0,1,1,1\n";
    assert_eq!(read(assembly).unwrap().rows().len(), 2);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Radii of gyration say what moments do, in any unit, and their inertia follows the mass.
    #[test]
    fn radii_of_gyration_are_moments(
        mass in 0.1..1e3_f64,
        radii in proptest::array::uniform3(0.01..10.0_f64),
        names in proptest::sample::select(vec![
            ["kx", "ky", "kz"], ["k1", "k2", "k3"], ["Kxx", "Kyy", "Kzz"],
            ["radius of gyration x", "radius of gyration y", "radius of gyration z"],
        ]),
        (unit, si) in proptest::sample::select(vec![("m", 1.0), ("mm", 1e-3), ("in", 0.0254)]),
    ) {
        let [kx, ky, kz] = names;
        let [a, b, c] = radii;
        let text = format!("name,mass_kg,Cx [{unit}],Cy [{unit}],Cz [{unit}],{kx} [{unit}],{ky} [{unit}],{kz} [{unit}]\nit,{mass},0,0,0,{a},{b},{c}\n");
        let table = read(&text).unwrap_or_else(|error| panic!("{text}{error}"));
        let numbers = table.rows()[0].numbers().unwrap();
        for (found, radius) in numbers.inertia().entries().into_iter().zip(radii) {
            prop_assert!((found / (mass * radius * radius * si * si) - 1.0).abs() < 1e-12, "{}", text);
        }
        prop_assert!(numbers.inertia_follows_mass());
        // Not beside moments, and all three.
        let head = "name,mass,Cx,Cy,Cz,kx,ky,kz,ixx,iyy,izz\n";
        let message = read(&format!("{head}it,1,0,0,0,1,1,1,1,1,1\n")).unwrap_err().to_string();
        prop_assert!(message.contains("given twice"), "{}", message);
        let message = read(&format!("{head}it,1,0,0,0,1,,1,,,\n")).unwrap_err().to_string();
        prop_assert!(message.contains("ky is missing"), "{}", message);
        // Products of zero say nothing.
        let zero = "name,mass,Cx,Cy,Cz,kx,ky,kz,ixy,ixz,iyz\nit,1,0,0,0,1,1,1,0,0,0\n";
        prop_assert!(read(zero).is_ok());
    }
}

/// Where two columns may hold the names, their order changes nothing.
#[test]
fn the_order_of_columns_changes_no_name() {
    let columns =
        ["Part Name", "item_name", "Component Name", "Body name", "Item", "ELEMENT", "Description"];
    for (rank, first) in columns.iter().enumerate() {
        for second in &columns[rank + 1..] {
            for [left, right] in [[first, second], [second, first]] {
                let of = |heading: &&str, row: usize| format!("{} {row}", heading.to_lowercase());
                let mut text = format!("{left},{right},mass,Cx,Cy,Cz,Ixx,Iyy,Izz\n");
                for row in 0..2 {
                    text += &format!("{},{},1,{row},0,0,1,1,1\n", of(left, row), of(right, row));
                }
                let table = read(&text).unwrap();
                let names: Vec<&str> = table.rows().iter().take(2).map(PartRow::name).collect();
                assert_eq!(names, [of(first, 0), of(first, 1)], "{text}");
            }
        }
    }
}
