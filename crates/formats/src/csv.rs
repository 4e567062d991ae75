//! Tables: one body a row, under a header that names the six entries.

use gyradius_statistics::SummaryNames;
use std::collections::BTreeSet;

use crate::{
    FileBody, FileBodyError, FileProblem, MAX_BODIES, Products,
    body::{ENTRIES, Number, Reading},
    error::Refusal,
    gap::{GapKind, Gaps},
    products_comment::stated_products,
    rows::is_blank,
    table_header::{FIELDS, MASS, NAME, PRODUCTS, find_header},
    text::Text,
};

/// The bodies of a table, and the columns of which nothing is read.
pub(crate) fn read(text: &Text, default: Products) -> Result<(Vec<FileBody>, Gaps), Refusal> {
    let (header, mut rows) = find_header(text)?;
    let start = header.row.first().map_or(0, |field| field.start);
    let products = stated_products(text, start)?.unwrap_or(default);

    let mut bodies = Vec::new();
    let mut things = BTreeSet::new();
    let mut have_cells = BTreeSet::new();
    let mut summaries = [SummaryNames::default(), SummaryNames::default()];
    while let Some(row) = rows.next() {
        let row = row.map_err(|error| error.of(text))?;
        let line = text.line(row.first().map_or(0, |field| field.start));
        if bodies.len() == MAX_BODIES {
            return Err(Refusal { line: Some(line), problem: FileProblem::TooManyBodies });
        }
        let cell = |column: usize| {
            let field = row.get(header.columns[column]?)?;
            Some((field.of(text.as_str()), field.start))
        };
        let name =
            cell(NAME).map_or_else(String::new, |(name, _)| name.trim().replace("\"\"", "\""));
        let reading = if row.len() == header.row.len() {
            header.unread(text, &row).map_or_else(|| reading(cell, products), Err)
        } else {
            let (found, allowed) = (row.len(), header.row.len());
            Err(FileBodyError::Count { field: "the row", found, allowed })
        };
        let reading =
            reading.map(|reading| reading.in_units(header.mass.si(), header.inertia.si()));
        things.extend(header.things(text, &row));
        let cells = row.iter().enumerate();
        let cells = cells.filter(|(_, field)| !is_blank(field.of(text.as_str()).trim()));
        have_cells.extend(cells.map(|(at, _)| at));
        // In the column of names, or the first one, as of an index.
        let first = row.first().map(|field| field.of(text.as_str()));
        let labels = [cell(NAME).map(|(name, _)| name), first];
        let labels = summaries.iter_mut().zip(labels);
        let summary = labels.fold(None, |found, (names, cell)| {
            let cell = cell.map(str::trim).filter(|cell| names.sums_up(cell));
            found.or(cell)
        });
        bodies.push(FileBody::new(name, line, reading).summing_up(summary));
    }
    let mut gaps = Gaps::default();
    let line = text.line(start);
    let things = things.iter().filter_map(|at| header.heading(text, *at)).map(str::to_owned);
    let has_masses = header.columns[MASS].is_some();
    for (kind, unread) in [
        (GapKind::Things, things.collect()),
        (GapKind::Columns { has_masses }, header.unread_columns(text, &have_cells)),
    ] {
        if !unread.is_empty() {
            gaps.add_keys(kind, line, unread);
        }
    }
    Ok((bodies, gaps))
}

fn reading<'a>(
    cell: impl Fn(usize) -> Option<(&'a str, usize)>,
    default: Products,
) -> Result<Reading, FileBodyError> {
    let stated = cell(PRODUCTS).map_or(Ok(None), |(word, _)| Products::of_cell(word))?;
    let products = stated.unwrap_or(default);
    let number = |column: usize| {
        let (raw, start) = cell(column)?;
        Some(Number::parse(FIELDS[column], raw, Some(start)))
    };
    // A table may know the mass of some bodies only.
    let mass = match cell(MASS) {
        Some((raw, _)) if raw.trim().is_empty() => None,
        _ => number(MASS).transpose()?,
    };
    let mut nine = [[Number::default(); 3]; 3];
    for (column, (i, j)) in ENTRIES.into_iter().enumerate() {
        // The other half, in a table that has both, may say something else.
        let above = number(column).transpose()?;
        let below = if i == j { None } else { number(column + 3).transpose()? };
        nine[i][j] = above.or(below).unwrap_or_default();
        nine[j][i] = below.or(above).unwrap_or_default();
    }
    Ok(Reading::of_nine(mass, &nine, products))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{prelude::*, sample::select};

    fn try_read(csv: &str) -> Result<Vec<FileBody>, Refusal> {
        let read = read(&Text::new(csv.as_bytes(), true).unwrap(), Products::TensorEntries);
        read.map(|(bodies, _)| bodies)
    }

    fn six(body: &FileBody) -> [f64; 6] {
        ENTRIES.map(|entry| body.inertia().unwrap()[entry])
    }

    #[test]
    fn columns_may_stand_in_any_order_case_and_spelling() {
        let expected = [10.0, 11.0, 12.0, 0.1, 0.2, 0.3];
        for csv in [
            "name,mass,ixx,iyy,izz,ixy,ixz,iyz\narm,2,10,11,12,.1,.2,.3\n",
            "IZZ;Iyz;I_xx;Body;Mass [kg];Iyy;Ixy;Ixz\r\n12;.3;10;arm;2;11;.1;.2\r\n",
            "# a comment\n\ni11\ti22\ti33\ti12\ti13\ti23\tpart\tm\n10\t11\t12\t.1\t.2\t.3\tarm\t2",
            "\"name\",mass_kg,ixx_kg_m2,iyy_kg_m2,izz_kg_m2,ixy_kg_m2,ixz_kg_m2,iyz_kg_m2\n\
             \"arm\", \"2\",10,11,12,\".1\",.2,.3",
            "Part,Mass (kg),Ixx [kg m^2],Iyy [kg*m2],Izz [kg·m²],Ixy [kg m2],Ixz,Iyz,note\n\
             arm,2,10,11,12,.1,.2,.3,\"a, b\nc\"",
        ] {
            let bodies = try_read(csv).unwrap();
            assert_eq!(bodies.len(), 1, "{csv}");
            assert_eq!(six(&bodies[0]), expected, "{csv}");
            assert_eq!((bodies[0].name(), bodies[0].mass_kg()), ("arm", Some(2.0)), "{csv}");
        }
    }

    #[test]
    fn moments_alone_are_a_diagonal_and_a_comment_may_state_the_sign() {
        let bodies = try_read("ixx,iyy,izz\n1,2,3\n\n4,5,6").unwrap();
        assert_eq!(six(&bodies[1]), [4.0, 5.0, 6.0, 0.0, 0.0, 0.0]);
        assert_eq!((bodies[1].line(), bodies[1].name(), bodies[1].mass_kg()), (4, "", None));
        let csv =
            "# products = integrals, not tensor entries\nixx,iyy,izz,ixy,ixz,iyz\n1,2,3,.1,.2,.3";
        assert_eq!(six(&try_read(csv).unwrap()[0])[3..], [-0.1, -0.2, -0.3]);
    }

    /// Nine entries are read, as those of a full matrix are.
    #[test]
    fn the_other_half_is_read() {
        let heading = "ixx,ixy,ixz,iyx,iyy,iyz,izx,I32,izz";
        let bodies = try_read(&format!("{heading}\n10,.1,.2,-.1,11,.3,.2,.3,12")).unwrap();
        let matrix = bodies[0].inertia().unwrap();
        assert_eq!([matrix[(0, 1)], matrix[(1, 0)], matrix[(2, 1)]], [0.1, -0.1, 0.3]);
        let places = bodies[0].reading().unwrap().places;
        assert!(places.iter().flatten().all(Option::is_some) && places[0][1] != places[1][0]);
        let message = |csv| try_read(csv).unwrap_err().problem.to_string();
        let part = message("ixx,iyy,izz,ixy,ixz,iyz,iyx\n1,2,3,0,0,0,0");
        assert!(part.contains("columns iyx, izx, izy: there must be all three or none"), "{part}");
    }

    /// They were called kg·m² whatever the header said.
    #[test]
    fn other_units_become_kilograms_and_metres() {
        for (heading, mass, inertia) in [
            ("mass [g],Ixx [g*mm^2],iyy,izz", 1e-3, 1e-9),
            ("mass (lb),Ixx (lb in²),Iyy (lb·in2),Izz (lb in^2)", 0.45359237, 2.926396534292e-4),
            ("mass [kg],Ixx (slug ft2),iyy,izz", 1.0, 1.3558179483314),
            ("m [t],ixx [t cm2],iyy,izz", 1e3, 0.1),
        ] {
            let bodies = try_read(&format!("{heading}\n2,3,4,5")).unwrap();
            let found = six(&bodies[0])[0] / (3.0 * inertia) - 1.0;
            assert!(found.abs() < 1e-12, "{heading}: {found:e}");
            assert_eq!(bodies[0].mass_kg(), Some(2.0 * mass), "{heading}");
        }
        let latin = Text::new(b"ixx [kg m\xb2],iyy,izz\n1,2,3", true).unwrap();
        assert!(read(&latin, Products::TensorEntries).is_ok());
    }

    /// Every separator, with the units in the header, in a row below it, or in both, and a header that is a
    /// comment: the same bodies, in the same places of the file.
    #[test]
    fn units_stand_below_and_headers_are_comments() {
        let units = [("", "", 1.0, 1.0), ("kg", "kg m^2", 1.0, 1.0), ("g", "g·mm²", 1e-3, 1e-9)];
        let mut count = 0;
        for (mass, inertia, kg, kg_m2) in units {
            for (separator, comment, bracket, place, title) in
                [",", ";", "\t"].iter().flat_map(|s| {
                    ["", "#", "# "].iter().flat_map(move |c| {
                        [("", ""), ("[", "]"), ("(", ")")].iter().flat_map(move |b| {
                            (0..3).flat_map(move |p| {
                                ["", "Table 3\n", "# made by hand\n"].map(|t| (s, c, b, p, t))
                            })
                        })
                    })
                })
            {
                let unit = |unit: &str, there: bool| {
                    let there = there && !unit.is_empty();
                    if there { format!("{}{unit}{}", bracket.0, bracket.1) } else { String::new() }
                };
                let row = |cells: [String; 6]| cells.join(separator) + "\n";
                let names = ["part", "mass", "ixx", "note", "iyy", "izz"];
                let of = |name: &str| match name {
                    "mass" => mass,
                    "part" | "note" => "",
                    _ => inertia,
                };
                let above = row(
                    names.map(|n| format!("{n} {}", unit(of(n), place != 1)).trim().to_owned())
                );
                let below = row(names.map(|n| unit(of(n), place != 0)));
                let below = if place == 0 || mass.is_empty() { String::new() } else { below };
                let data = ["arm", "2", "3", "x", "4", "5"].map(str::to_owned);
                let text = format!("{title}{comment}{above}{below}{}", row(data));
                let bodies = try_read(&text).unwrap_or_else(|e| panic!("{text}{e:?}"));
                assert_eq!(bodies.len(), 1, "{text}");
                assert_eq!(bodies[0].line(), text.lines().count(), "{text}");
                let found = six(&bodies[0]);
                assert!((found[0] / (3.0 * kg_m2) - 1.0).abs() < 1e-12, "{text}{found:?}");
                assert_eq!(
                    (bodies[0].name(), bodies[0].mass_kg()),
                    ("arm", Some(2.0 * kg)),
                    "{text}"
                );
                count += 1;
            }
        }
        assert_eq!(count, 3 * 243);
        // A row that is no units is a row; one that contradicts the header is refused.
        let bodies = try_read("ixx,iyy,izz\nn/a,furlongs,-\n1,2,3").unwrap();
        assert!(bodies.len() == 2 && bodies[0].inertia().is_err());
        let message = |csv| try_read(csv).unwrap_err().problem.to_string();
        let both = message("ixx [kg m2],iyy,izz\ng mm2,,\n1,2,3");
        assert!(both.contains("the header says kg m2, and the row below it g mm2"), "{both}");
        assert!(message("# ixx,iyy,izz,Ixx\n1,2,3,4").contains("two columns for ixx"));
        assert!(message("# ixx and iyy\n1,2,3").contains("columns ixx, iyy and izz"));
    }

    proptest! {
        /// A row without numbers that speaks of units is one of units, whatever its length and wherever they stand: it counts, or the table is refused.
        #[test]
        fn rows_of_units_are_no_bodies(
            (mass, kg) in select(&[("", None), ("kg", Some(1.0)), ("g", Some(1e-3)), ("kilograms", None), ("stone", None)][..]),
            (inertia, kg_m2) in select(&[
                ("", None), ("kg m2", Some(1.0)), ("g mm2", Some(1e-9)), ("kg·mm²", Some(1e-6)), ("oz in2", None), ("kilogram m2", None), ("gram mm^2", None),
            ][..]),
            name in select(&["", "Units", "a"][..]),
            has_all in any::<bool>(),
            more in select(&["", ",", ",,"][..]),
        ) {
            let second = if has_all { inertia } else { "" };
            let text = format!("name,mass,ixx,iyy,izz,note\n{name},{mass},{inertia},{second},{inertia}{more}\na,2,3,4,5,x\n");
            // A word that nobody knows may be a note.
            prop_assume!(mass != "stone" || !inertia.is_empty());
            let of = |unit: &str, si: Option<f64>| if unit.is_empty() { Some(1.0) } else { si };
            let is_lacking = |unit: &str, other: Option<f64>| unit.is_empty() && other.is_some_and(|si| si != 1.0);
            let expected = of(mass, kg).zip(of(inertia, kg_m2)).filter(|_| !is_lacking(mass, kg_m2) && !is_lacking(inertia, kg));
            let found = try_read(&text).ok().map(|bodies| {
                let body = bodies.last().unwrap();
                (body.mass_kg().unwrap() / 2.0, six(body)[0] / 3.0)
            });
            let is_same = match (found, expected) {
                (Some(found), Some(expected)) => (found.0 / expected.0 - 1.0).abs() < 1e-12 && (found.1 / expected.1 - 1.0).abs() < 1e-12,
                (found, expected) => found.is_none() && expected.is_none(),
            };
            prop_assert!(is_same, "{}{:?} {:?}", text, found, expected);
        }
    }

    #[test]
    fn bad_tables_are_refused_and_bad_rows_named() {
        let message = |csv| try_read(csv).unwrap_err().problem.to_string();
        assert!(message("time,x\n1,2").contains("columns ixx"));
        assert!(message("ixx,iyy,izz,ixy\n1,2,3,4").contains("all three or none"));
        assert!(message("ixx,iyy,izz,Ixx\n1,2,3,4").contains("two columns for ixx"));
        let mixed = message("ixx [kg m2],iyy [g mm2],izz\n1,2,3");
        assert!(mixed.contains("ixx is in kg m2 but iyy in g mm2"), "{mixed}");
        let odd = message("ixx [kg m2/s],iyy,izz\n1,2,3");
        assert!(
            odd.contains("column \"ixx [kg m2/s]\": ixx is in \"kg m2/s\": it must be in kg, g"),
            "{odd}"
        );
        assert!(
            message("mass [N],ixx,iyy,izz\n1,1,2,3").contains("mass is in \"N\": it must be in")
        );
        assert!(message("ixx,iyy,izz\n1,2,\"3").contains("not closed"));
        let bodies = try_read("name,ixx,iyy,izz\na,1,2\nb,1,x,3\nc,1,1,1").unwrap();
        let error = |i: usize| bodies[i].inertia().unwrap_err().to_string();
        assert_eq!(error(0), "the row has 3 values: there must be 4");
        assert_eq!(error(1), "iyy = \"x\" is not a number");
        assert!(bodies[2].inertia().is_ok());
    }
}
