//! Lists of parts in every form, and what is refused.

use super::*;
use proptest::prelude::*;

pub(super) fn read(text: &str) -> Result<PartsTable, PartsError> {
    PartsTable::read(text.as_bytes(), None)
}

const HEAD: &str = "name,parent,mass_kg,centre_x_m,centre_y_m,centre_z_m";

/// The two tables that the R package massProps has of SAWE paper 3360 (Zimmerman & Nakai 2005), one row of each.
#[test]
fn tables_of_mass_props_are_read() {
    let table = "id\tmass\tCx\tCy\tCz\tIxx\tIyy\tIzz\tIxy\tIxz\tIyz\tsigma_mass\tsigma_Cx\tsigma_Cy\tsigma_Cz\tsigma_Ixx\
                 \tsigma_Iyy\tsigma_Izz\tsigma_Ixy\tsigma_Ixz\tsigma_Iyz\tIpoint\tPOIconv\n\
                 Widget\t57.83\t121.20\t0.04\t-0.16\t7258.90\t8607.02\t10453.40\t834.44\t-1198.38\t-1066.58\t1.2416\
                 \t0.2764\t0.2085\t0.0669\t386.9233\t171.4792\t414.5547\t1440.5402\t344.6237\t124.6860\tFALSE\t+\n\
                 Combined\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tNA\tFALSE\t+\n";
    let edges = "child\tparent\nWidget\tCombined\nCombined\tall\n";
    let read = PartsTable::with_edges(table.as_bytes(), edges.as_bytes(), None).unwrap();
    let [widget, combined, all] = read.rows() else { panic!("{read:?}") };
    assert_eq!(
        (widget.name(), widget.parent(), widget.place()),
        ("Widget", Some("Combined"), (PartsFile::Parts, 2))
    );
    let numbers = widget.numbers().unwrap();
    assert_eq!(
        numbers.inertia().entries(),
        [7258.90, 8607.02, 10453.40, -834.44, 1198.38, 1066.58]
    );
    assert_eq!(numbers.mass_centre_m(), [121.20, 0.04, -0.16]);
    let sigma = numbers.deviations();
    assert_eq!((sigma[0], sigma[3], sigma[7], sigma[9]), (1.2416, 0.0669, 1440.5402, 124.6860));
    assert!(!numbers.inertia_follows_mass());
    assert_eq!((combined.parent(), combined.numbers()), (Some("all"), None));
    assert_eq!((all.name(), all.parent(), all.place()), ("all", None, (PartsFile::Edges, 3)));
    let twice = "child,parent\nWidget,a\nWidget,b\n";
    let error = PartsTable::with_edges(table.as_bytes(), twice.as_bytes(), None).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 3: \"Widget\" belongs to \"a\" and to \"b\": it must belong to one of them"
    );
}

#[test]
fn shapes_points_percents_and_attitudes() {
    let text = format!(
        "{HEAD},shape,radius_m,height_m,sides_m,mass_percent,moments_percent,sigma_centre_mm,qx,qy,qz,qw,note\n\
         craft,,,,,,,,,,,,,,,,,x\n\
         tank,craft,2,0,1,2,cylinder,1,6,,10,20,5,1,0,0,0,y\n\
         strut,craft,12,0,0,0,rod,,,,,,,,,,,\n\
         box,craft,12,0,0,0,solid_box,,,1 2 3,,,,,,,,\n\
         bolt,craft,1,0,0,0,point,,,,50,,,,,,,\n"
    );
    let error = read(&text).unwrap_err().to_string();
    assert_eq!(
        error,
        "line 4: strut: shape: missing field `length_m`; nothing is read from the column \"note\""
    );
    let text = text
        .replace("strut,craft,12,0,0,0,rod", "strut,craft,12,0,0,0,disc")
        .replace("0,disc,,,", "0,disc,2,,");
    let table = read(&text).unwrap();
    assert_eq!(table.passed_over(), ["note"]);
    let numbers = |i: usize| table.rows()[i].numbers().unwrap();
    assert!(table.rows()[0].numbers().is_none());
    let tank = numbers(1);
    // ½ m r² about the axis; ¼ m r² + m h²/12 across.
    assert_eq!(tank.inertia().entries(), [6.5, 6.5, 1.0, 0.0, 0.0, 0.0]);
    assert_eq!(tank.deviations(), [0.2, 0.005, 0.005, 0.005, 1.3, 1.3, 0.2, 0.0, 0.0, 0.0]);
    assert_eq!(tank.attitude().i, 1.0);
    assert!(tank.inertia_follows_mass());
    assert_eq!(numbers(3).inertia().entries()[..3], [13.0, 10.0, 5.0]);
    let bolt = numbers(4);
    assert_eq!(bolt.inertia().entries(), [0.0; 6]);
    assert!(!bolt.inertia_follows_mass() && bolt.deviations()[0] == 0.5);
}

#[test]
fn lists_without_parents_are_one_whole() {
    let table = read("part;mass [lb];cg x (in);cg y (in);cg z (in);shape\na;1;1;0;0;point\nwhole;2;0;0;0;point\n").unwrap();
    let names: Vec<_> = table.rows().iter().map(|r| (r.name(), r.parent())).collect();
    assert_eq!(names, [("a", Some("(whole)")), ("whole", Some("(whole)")), ("(whole)", None)]);
    let a = table.rows()[0].numbers().unwrap();
    assert!(
        (a.mass_kg() - 0.45359237).abs() < 1e-15 && (a.mass_centre_m()[0] - 0.0254).abs() < 1e-15
    );
}

#[test]
fn the_sign_of_products_is_never_guessed() {
    let row =
        |products: &str| format!("{HEAD},ixx,iyy,izz,ixy,ixz,iyz\na,,1,0,0,0,4,5,6,{products}\n");
    let found = |text: &str, default| {
        PartsTable::read(text.as_bytes(), default)
            .map(|t| t.rows()[0].numbers().unwrap().inertia().entries()[3])
    };
    assert_eq!(found(&row("0,0,0"), None).unwrap(), 0.0);
    assert!(
        found(&row("0,.1,0"), None)
            .unwrap_err()
            .to_string()
            .starts_with("line 2: a: ixz is not zero, and nothing says")
    );
    assert_eq!(found(&row(".1,0,0"), Some(Products::TensorEntries)).unwrap(), 0.1);
    assert_eq!(found(&row(".1,0,0"), Some(Products::Integrals)).unwrap(), -0.1);
    let stated = format!("# products = integrals\n{}", row(".1,0,0"));
    assert_eq!(found(&stated, Some(Products::TensorEntries)).unwrap(), -0.1);
    let column =
        |word: &str| format!("{HEAD},ixx,iyy,izz,ixy,POIconv\na,,1,0,0,0,4,5,6,.1,{word}\n");
    for (word, expected) in [("+", -0.1), ("-", 0.1), ("integrals", -0.1), ("Tensor", 0.1)] {
        assert_eq!(found(&column(word), None).unwrap(), expected, "{word}");
    }
    assert!(
        found(&column("positive"), None)
            .unwrap_err()
            .to_string()
            .contains("products = \"positive\": it must be tensor")
    );
}

#[test]
fn what_a_row_lacks_is_named() {
    for (text, expected) in [
        ("", "it is empty"),
        (
            "mass,x\n",
            "line 1: no column is called name, id, part, body, link, component, item, element or",
        ),
        ("name,parent\n", "line 1: no column is called mass"),
        ("name,mass,Mass [kg]\na,1,2\n", "line 1: columns \"mass\" and \"Mass [kg]\" say"),
        ("name,mass,mass\na,1,2\n", "line 1: columns \"mass\" and \"mass\" say the same"),
        ("name,mass,sigma_mess\na,1,2\n", "line 1: column \"sigma_mess\" is no standard deviation"),
        (
            "name,mass,shape\na,1,point\n",
            "line 2: a: no column is called centre_x, Cx, CG X or Xcg",
        ),
        (
            "name,mass,shape,x_m,y_m\na,1,point,0,0\n",
            "line 2: a: no column is called centre_x, Cx, CG X or Xcg, and there must be one; nothing is read from the columns \"x_m\", \"y_m\"",
        ),
        (
            "name,mass,cx,cy,cz,shape,Radius [furlong]\na,1,0,0,0,disc,1\n",
            "line 1: column \"Radius [furlong]\": radius_m is in \"furlong\"",
        ),
        (
            "name,mass,cx,cy,cz,shape,radius,height_mm\na,1,0,0,0,cylinder,1,2\n",
            "line 1: column \"mass\" states no unit, and column \"height_mm\" states one",
        ),
        (
            "name,mass_kg,cx [m],cy [m],cz [m],shape,radius_m,Radius [mm]\na,1,0,0,0,disc,1,2\n",
            "line 1: columns \"radius_m\" and \"Radius [mm]\" say the same",
        ),
        ("name,mass,cx,cy,cz\na,1,0,0,0\n", "line 2: a: there is no inertia"),
        ("name,mass,cx,cy,cz\na,1,0,0\n", "line 2: the row has 4 values: there must be 5"),
        (
            "Mass list\n\nItem No,Mass,Cx,Cy,Cz\na,1,0,0,0\n",
            "line 3: no column is called name, id, part, body, link, component, item, element or",
        ),
        (
            "name,mass,cx,cy,cz\na,\"1,250\",0,0,0\n",
            "line 2: a: mass = \"1,250\" is not a number: decimal commas are not read",
        ),
        ("name,mass,cx,cy,cz\n", "line 1: no row stands below the header"),
        (
            "name,mass,\"cx (\"\")\",cy,cz\na,1,0,0,0\n",
            r#"line 1: column "cx (\")": centre_x is in "\"": it must be in m"#,
        ),
        (
            "name,mass (kg),cx,cy,cz\n,kg,\"\"\"\",m,m\na,1,0,0,0\n",
            r#"line 1: column "cx [\"]": centre_x is in "\"": it must be in m"#,
        ),
        ("name,MASS [MG],cx,cy,cz\na,1,0,0,0\n", r#"line 1: column "MASS [MG]": mass is in "MG""#),
        ("name,mass,cx,cy,cz\n\na,one,0,0,0\n", "line 3: a: mass = \"one\" is not a number"),
        ("name,mass,cx,cy,cz\na,inf,0,0,0\n", "line 2: a: mass = \"inf\": it must be finite"),
        ("name,mass,cx,cy,cz,ixx,iyy\na,1,0,0,0,1,1\n", "line 2: a: izz is missing"),
        (
            "name,mass,cx,cy,cz,shape,ixx\na,1,0,0,0,point,1\n",
            "line 2: a: both an inertia and the shape \"point\"",
        ),
        (
            "name,mass,cx,cy,cz,shape\na,1,0,0,0,potato\n",
            "line 2: a: shape: unknown variant `potato`, expected one of `point`, `box`",
        ),
        (
            "name,mass,cx,cy,cz,shape,radius_m\na,1,0,0,0,sphere,-1\n",
            "line 2: a: shape: radius_m = -1.0 m",
        ),
        (
            "name,mass,cx,cy,cz,shape,radius_m\na,1,0,0,0,sphere,1;5e\n",
            "line 2: a: radius_m = \"5e\"",
        ),
        (
            "name,mass,cx,cy,cz,shape,sides_m\na,1,0,0,0,box,1 2\n",
            "line 2: a: shape: invalid length 2, expected an array of length 3; given are sides_m = \"1 2\", and a size of several \
             numbers has them all in one cell, as `1 1 2`",
        ),
        (
            "name,mass,cx,cy,cz,shape,radius_m\na,1,0,0,0,sphere,1 2\n",
            "line 2: a: shape: invalid type: sequence, expected f64; given are radius_m = \"1 2\"",
        ),
        (
            "name,mass,cx,cy,cz,kx_m,ky_m,kz_m\na,1,0,0,0,1,1e200,1\n",
            "line 2: a: ky = 1e200: it must be zero or more, and small enough",
        ),
        (
            "name,mass,cx,cy,cz,shape,sigma_mass\na,1,0,0,0,point,-1\n",
            "line 2: a: sigma_mass = -1.0: it must be zero or more",
        ),
        (
            "name,mass,cx,cy,cz,shape,sigma_mass,mass_percent\na,1,0,0,0,point,1,1\n",
            "line 2: a: sigma_mass is given twice",
        ),
        (
            "name,mass,cx,cy,cz,shape,centre_percent\na,1,0,0,0,point,1\n",
            "line 2: a: centre_percent = 1.0: it must be a length",
        ),
        ("name,mass,cx,cy,cz,shape,qx\na,1,0,0,0,point,1\n", "line 2: a: attitude_y is missing"),
        (
            "name,mass,cx,cy,cz,shape,qx,qy,qz,qw\na,1,0,0,0,point,1,1,0,0\n",
            "line 2: a: norm of the attitude = 1.41",
        ),
        (
            "name,mass,cx,cy,cz,point\na,1,0,0,0,maybe\n",
            "line 2: a: point = \"maybe\": it must be yes or no",
        ),
        ("name,mass,cx,cy,cz,shape\n,1,0,0,0,point\n", "line 2: name is missing"),
        ("name,mass,cx,cy,cz\na,1,0,0,0,7\n", "line 2: the row has 6 values: there must be 5"),
        ("name,mass,cx\n\"a,1,0\n", "line 2: malformed: a quotation mark is not closed"),
    ] {
        let found = read(text).unwrap_err().to_string();
        assert!(found.starts_with(expected), "{text:?}: {found}");
    }
}

/// Rows of which a spreadsheet leaves only the separators, anywhere and of any width, change nothing but the numbers of lines.
#[test]
fn blank_rows_are_passed_over() {
    let rows = [
        "name,parent,mass,cx,cy,cz,shape",
        "all,,,,,,",
        "a,all,1,2,3,4,point",
        "b,all,1,0,0,0,point",
    ];
    let edges = ["child,parent", "a,all", "b,all"];
    let with = |rows: &[&str], blank: &str, at: usize, separator: &str| {
        let mut rows = rows.to_vec();
        rows.insert(at, blank);
        (rows.join("\n") + "\n").replace(',', separator)
    };
    let names = |table: &PartsTable| -> Vec<(String, Option<String>, (PartsFile, usize))> {
        let rows = table.rows().iter();
        rows.map(|r| (r.name().to_owned(), r.parent().map(str::to_owned), r.place())).collect()
    };
    for blank in ["", ",,,,,,", ",,", ",,,,,,,,,,", " , ,\t, ", "\"\",\"\"", ",,,,,,\r", "  "] {
        for separator in [",", ";", "\t"] {
            for at in 1..=4 {
                let table = read(&with(&rows, blank, at, separator)).unwrap();
                let found = names(&table);
                assert_eq!(found.len(), 3, "{blank:?}");
                for (i, (name, parent, place)) in found.iter().enumerate() {
                    let line = i + 2 + usize::from(i + 1 >= at);
                    assert_eq!(*place, (PartsFile::Parts, line), "{blank:?} {at}");
                    assert_eq!(name, ["all", "a", "b"][i]);
                    assert_eq!(parent.as_deref(), [None, Some("all"), Some("all")][i]);
                }
                let csv =
                    with(&["name,ixx,iyy,izz", "a,1,1,1", "b,2,2,2"], blank, at.min(3), separator);
                let path = std::path::Path::new("t.csv");
                let file =
                    crate::InertiaFile::parse(path, csv.into_bytes(), Products::TensorEntries);
                let names: Vec<_> =
                    file.unwrap().bodies().iter().map(|b| b.name().to_owned()).collect();
                assert_eq!(names, ["a", "b"], "{blank:?} {at}");
            }
            for at in 1..=3 {
                let list = rows.map(|row| row.replace("all,1", ",1")).join("\n");
                let edges = with(&edges, blank, at, separator);
                let table =
                    PartsTable::with_edges(list.as_bytes(), edges.as_bytes(), None).unwrap();
                let line = |i: usize| i + 1 + usize::from(i >= at);
                let places: Vec<_> = table.rows()[1..].iter().map(PartRow::parent_place).collect();
                assert_eq!(places, [1, 2].map(|i| (PartsFile::Edges, line(i))), "{blank:?} {at}");
            }
        }
    }
}

/// Whatever is wrong with the table of edges is an error of that table.
#[test]
fn errors_of_edges_are_told_apart() {
    let list = format!("{HEAD},shape\na,,1,0,0,0,point\n");
    for (edges, expected) in [
        ("", "it is empty"),
        ("a\0", "it is binary"),
        ("a,b\nc,d\n", "line 1: no column is called child"),
        ("child\na\n", "line 1: no column is called parent"),
        ("child,parent\na\n", "line 2: the row has 1 values: there must be 2"),
        ("child,parent\n\na,b,c\n", "line 3: the row has 3 values: there must be 2"),
        ("child,parent\na,\n", "line 2: parent is missing"),
        ("child,parent\n,a\n", "line 2: child is missing"),
        ("child,parent\na,b\na,c\n", "line 3: \"a\" belongs to \"b\" and to \"c\""),
        ("child,parent\n\"a,b\n", "line 2: malformed: a quotation mark"),
    ] {
        let error = PartsTable::with_edges(list.as_bytes(), edges.as_bytes(), None).unwrap_err();
        assert!(error.to_string().starts_with(expected), "{edges:?}: {error}");
        assert_eq!(error.file(), PartsFile::Edges, "{edges:?}");
        let error = PartsTable::with_edges(b"x", edges.as_bytes(), None).unwrap_err();
        assert_eq!(error.file(), PartsFile::Parts);
    }
}

/// Whatever is wrong with a standard deviation, its own name is said, not that of the value.
#[test]
fn every_wrong_deviation_is_named() {
    for (heading, field) in [
        ("sigma_mass_g", "sigma_mass"),
        ("mass (%)", "mass_percent"),
        ("sigma_Cy", "sigma_centre_y"),
        ("centre_sigma_mm", "sigma_centre"),
        ("sigma_I12", "sigma_ixy"),
        ("izz_percent", "izz_percent"),
        ("moments_percent", "moments_percent"),
        ("sigma_products", "sigma_products"),
    ] {
        for (cell, why) in [("-1", "= -1.0: it must be"), ("few", "= \"few\" is not a number")] {
            let text =
                format!("name,mass_kg,cx_m,cy_m,cz_m,shape,{heading}\na,1,0,0,0,point,{cell}\n");
            let found = read(&text).unwrap_err().to_string();
            assert!(found.starts_with(&format!("line 2: a: {field} {why}")), "{heading}: {found}");
        }
    }
}

/// A percentage of products that are all zero, of any of them, is refused unless it is zero too.
#[test]
fn no_percentage_is_taken_of_zero_products() {
    let names = ["ixy", "ixz", "iyz"];
    for (which, column) in (0..8).flat_map(|w| (0..4).map(move |c| (w, c))) {
        let of = |i: usize| if which >> i & 1 == 1 { "0.1" } else { "" };
        let heading =
            names.get(column).map_or("products_percent".to_owned(), |n| format!("{n}_percent"));
        for percent in ["", "0", "5"] {
            let text = format!(
                "name,mass,cx,cy,cz,ixx,iyy,izz,ixy,ixz,iyz,products,{heading}\n\
                 a,1,0,0,0,4,5,6,{},{},{},tensor,{percent}\n",
                of(0),
                of(1),
                of(2)
            );
            let is_zero = if column < 3 { which >> column & 1 == 0 } else { which == 0 };
            match read(&text) {
                Ok(table) => {
                    assert!(percent != "5" || !is_zero, "{text}");
                    let sigma = table.rows()[0].numbers().unwrap().deviations();
                    for i in 0..3 {
                        let is_asked = percent == "5" && (column == 3 || column == i);
                        let expected = if is_asked && which >> i & 1 == 1 { 0.005 } else { 0.0 };
                        assert!((sigma[7 + i] - expected).abs() < 1e-15, "{text}");
                    }
                }
                Err(error) => {
                    assert!(percent == "5" && is_zero, "{text}: {error}");
                    let said =
                        format!("line 2: a: {heading} = 5.0: it must be empty or zero where");
                    assert!(error.to_string().starts_with(&said), "{error}");
                }
            }
        }
    }
}

proptest! {
    /// Garbage, and good tables with garbage in them.
    #[test]
    fn no_bytes_panic(
        noise in prop::collection::vec(any::<u8>(), 0..200),
        at in any::<prop::sample::Index>(),
        cut in any::<prop::sample::Index>(),
        words in prop::collection::vec("[-a-zA-Z0-9_.,;\t\n\" %²µ+]{0,12}", 0..6),
    ) {
        let _ = PartsTable::read(&noise, None);
        let good = "name,parent,mass_kg,cx,cy,cz,ixx,iyy,izz,ixy,shape,sides_m,mass_percent,sigma_ixx,qx,qy,qz,qw,products\n\
                    all,,,,,,,,,,,,,,,,,,\na,all,1,2,3,4,5,6,7,.1,,,5,.1,0,0,0,1,tensor\nb,all,1,0,0,0,,,,,solid_box,1 2 3,,,,,,,\n";
        let mut bytes = good.as_bytes().to_vec();
        let place = at.index(bytes.len());
        bytes.splice(place..place, noise.iter().copied());
        let _ = PartsTable::read(&bytes, Some(Products::Integrals));
        let mut text = good.as_bytes().to_vec();
        for word in &words {
            let place = at.index(text.len());
            text.splice(place..place, word.bytes());
        }
        text.truncate(cut.index(text.len()));
        let _ = PartsTable::read(&text, None);
        let _ = PartsTable::with_edges(good.as_bytes(), &text, None);
        let _ = PartsTable::with_edges(&text, b"child,parent\na,all\n", None);
    }
}

/// Every size of every shape, in every unit and spelling.
#[test]
fn sizes_are_read_in_their_units() {
    let shapes = [
        ("solid_box", "sides", "1 2 3"),
        ("plate", "sides", "1 2"),
        ("rod", "length", "2"),
        ("disc", "radius", "1"),
        ("sphere", "radius", "0.7"),
        ("ellipsoid", "semi_axes", "1/2/2.5"),
        ("cylinder", "radius|height", "1|2"),
        ("tube", "inner_radius|outer_radius|height", "1|2|3"),
        ("frustum", "base_radius|top_radius|height", "1|2|3"),
        ("torus", "centre_line_radius|section_radius", "2|0.25"),
    ];
    let names: std::collections::BTreeSet<String> = shapes
        .iter()
        .flat_map(|(_, names, _)| names.split('|'))
        .map(|n| format!("{n}_m"))
        .collect();
    let all: std::collections::BTreeSet<String> =
        gyradius_inertia::Shape::SIZES.iter().map(|&name| name.to_owned()).collect();
    assert_eq!(names, all);
    for (shape, names, sizes) in shapes {
        let of = |heading: &dyn Fn(&str) -> String| {
            let headings: Vec<String> = names.split('|').map(heading).collect();
            let (head, cells) = (headings.join(","), sizes.replace('|', ","));
            let text = format!("{HEAD},shape,{head}\na,,3,0,0,0,{shape},{cells}\n");
            let table = read(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
            table.rows()[0].numbers().unwrap().inertia().entries()
        };
        let in_metres = of(&|name| format!("{name}_m"));
        assert_eq!(of(&|name| name.replace('_', " ")), in_metres);
        for (unit, si) in [("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254), ("ft", 0.3048)] {
            let spelled: [&dyn Fn(&str) -> String; 3] = [
                &|name| format!("{name}_{unit}"),
                &|name| format!("{} ({unit})", name.replace('_', " ").to_uppercase()),
                &|name| format!("{name} [{unit}]"),
            ];
            for heading in spelled {
                for (found, metres) in of(heading).into_iter().zip(in_metres) {
                    assert!((found - metres * si * si).abs() <= 1e-14 * (metres * si * si).abs());
                }
            }
        }
    }
}

/// A table without shapes has no sizes: a length in it is no number of a part.
#[test]
fn sizes_without_shapes_are_not_read() {
    let text = "name,parent,mass,cx,cy,cz,ixx,iyy,izz,length,height (max),arm_m\n\
                craft,,,,,,,,,4,5,6\na,craft,1,0,0,0,1,1,1,1,2,3\n";
    let table = read(text).unwrap();
    assert_eq!(table.rows()[0].numbers(), None);
    assert_eq!(table.passed_over(), ["length", "height (max)", "arm_m"]);
}

/// A size in a row that has no use for it says something that nobody reads, whatever else the row is; a zero says nothing.
#[test]
fn sizes_stand_in_the_rows_of_their_shapes_alone() {
    let rows = [
        (",,,,,,point,", "the row is a point"),
        (",,,,,,Point,TRUE", "the row is a point"),
        (",,,,,,,yes", "the row is a point"),
        ("1,1,1,,,,,", "the row has no shape"),
        ("1,1,1,,,,,no", "the row has no shape"),
        (",,,1,1,1,,", "the row has no shape"),
    ];
    for size in gyradius_inertia::Shape::SIZES {
        for (row, what) in rows {
            for cell in
                ["", "NA", "0", "0.0", "-0", "0 0 0", "0;0", "0.3", "1e-9", "abc", "-", "/", "0 1"]
            {
                let text = format!(
                    "{HEAD},ixx,iyy,izz,kx,ky,kz,shape,point,{size}\nm,,5,1,0,0,{row},{cell}\n"
                );
                let is_nothing = matches!(cell, "" | "NA" | "0" | "0.0" | "-0" | "0 0 0" | "0;0");
                match read(&text) {
                    Ok(_) => assert!(is_nothing, "{text}"),
                    Err(error) => {
                        let said = format!("line 2: m: column {size:?} says {cell:?}, which is");
                        let error = error.to_string();
                        assert!(!is_nothing, "{text}: {error}");
                        assert!(error.starts_with(&said) && error.contains(what), "{error}");
                    }
                }
            }
        }
    }
}
