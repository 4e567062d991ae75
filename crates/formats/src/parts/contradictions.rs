//! Rows that say two things that cannot both be.

use super::{tests::read, *};

const HEAD: &str = "name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,Ixy,kx,ky,kz,shape,radius,Ipoint,products";

/// What a row has of its inertia: six entries with a product and without, radii, a shape, a point, or a flag alone.
const INERTIAS: [&str; 6] = [
    "4,5,6,0.1,,,,,",
    "4,5,6,,,,,,",
    ",,,,1,2,3,,",
    ",,,,,,,sphere,1",
    ",,,,,,,point,",
    ",,,,,,,,",
];

/// A shape and the flag of a point, in every spelling: what says the same is read, and nothing else is.
#[test]
fn shapes_and_points_do_not_contradict_each_other() {
    for (shape, is_point) in [("sphere", false), ("Ball", false), ("point", true), ("POINT", true)]
    {
        for (flag, said) in [
            ("", None),
            ("NA", None),
            ("TRUE", Some(true)),
            ("yes", Some(true)),
            ("1", Some(true)),
            ("FALSE", Some(false)),
            ("no", Some(false)),
            ("0", Some(false)),
        ] {
            let radius = if is_point { "" } else { "1" };
            let text = format!("{HEAD}\na,5,0,0,0,,,,,,,,{shape},{radius},{flag},\n");
            match (read(&text), said.is_none_or(|said| said == is_point)) {
                (Ok(table), true) => {
                    let moment = table.rows()[0].numbers().unwrap().inertia().entries()[0];
                    assert_eq!(moment, if is_point { 0.0 } else { 2.0 }, "{text}");
                }
                (Err(error), false) => {
                    let said = format!(
                        "line 2: a: shape = {shape:?} and point = {flag:?} contradict each other"
                    );
                    assert!(error.to_string().starts_with(&said), "{error}");
                }
                (found, _) => panic!("{text}: {found:?}"),
            }
        }
    }
}

/// The line above the header, the column, and the flag, of every kind of row: the flag gives way, and the others must agree.
#[test]
fn signs_of_products_do_not_contradict_each_other() {
    let (tensor, integrals) = (Products::TensorEntries, Products::Integrals);
    let cells = [
        ("", Ok(None)),
        ("NA", Ok(None)),
        ("tensor", Ok(Some(tensor))),
        ("-", Ok(Some(tensor))),
        ("Integrals", Ok(Some(integrals))),
        ("+", Ok(Some(integrals))),
        ("foo", Err(())),
    ];
    for (at, inertia) in INERTIAS.iter().enumerate() {
        for line in [None, Some(tensor), Some(integrals)] {
            for default in [None, Some(tensor), Some(integrals)] {
                for (word, own) in cells {
                    let above = line
                        .map_or(String::new(), |line| format!("# products = {}\n", line.name()));
                    let flag = if at == 5 { "yes" } else { "" };
                    let text = format!("{above}{HEAD}\na,5,0,0,0,{inertia},{flag},{word}\n");
                    let found = PartsTable::read(text.as_bytes(), default)
                        .map_err(|error| error.to_string());
                    let expected = match own {
                        Err(()) => Err("products = \"foo\": it must be tensor"),
                        Ok(Some(own)) if line.is_some_and(|line| line != own) => {
                            Err("contradict each other")
                        }
                        Ok(own) => match own.or(line).or(default) {
                            None if at == 0 => Err("nothing says which sign"),
                            sign => Ok(if at == 0 {
                                0.1 * sign.map_or(1.0, Products::sign)
                            } else {
                                0.0
                            }),
                        },
                    };
                    match (found, expected) {
                        (Ok(table), Ok(expected)) => {
                            let product = table.rows()[0].numbers().unwrap().inertia().entries()[3];
                            assert_eq!(product.abs(), f64::abs(expected), "{text}");
                            assert!(product * expected >= 0.0, "{text}");
                        }
                        (Err(error), Err(said)) => assert!(error.contains(said), "{text}: {error}"),
                        (found, expected) => panic!("{text}: {found:?} {expected:?}"),
                    }
                }
            }
        }
    }
}
