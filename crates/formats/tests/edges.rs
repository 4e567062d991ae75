//! Tables of what belongs to what: nothing in them is ignored without a word.

use gyradius_formats::{PartsFile, PartsTable};
use proptest::{prelude::*, sample::select};

/// A list of parts, which belong to nothing yet.
fn list(parts: usize) -> String {
    let rows = (0..parts).map(|part| format!("p{part},1,0,0,0,1,1,1,x\n"));
    format!("name,mass,cx,cy,cz,ixx,iyy,izz,note\n{}", rows.collect::<String>())
}

fn read(parts: usize, edges: &str) -> Result<PartsTable, String> {
    let read = PartsTable::with_edges(list(parts).as_bytes(), edges.as_bytes(), None);
    read.map_err(|error| {
        assert_eq!(error.file(), PartsFile::Edges);
        error.to_string()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A child that stood four times, or had a 4 beside it, was there once.
    #[test]
    fn a_child_is_there_once(
        parents in prop::collection::vec(0..3_usize, 1..8),
        twice in any::<prop::sample::Index>(),
        place in any::<prop::sample::Index>(),
        (heading, one) in select(vec![("qty", "1"), ("Quantity", "one"), ("count", ""), ("No. off", "1.0")]),
        many in select(vec!["4", "2.0", "four", "pair", "NA", "?", "0"]),
        swapped in any::<bool>(),
    ) {
        let edges: Vec<String> = parents.iter().enumerate().map(|(child, parent)| {
            if swapped { format!("a{parent},p{child}") } else { format!("p{child},a{parent}") }
        }).collect();
        let head = if swapped { "Parent,CHILD" } else { "child,parent" };
        let table = |rows: &[String], heading: &str, cell: &dyn Fn(usize) -> String| {
            let rows = rows.iter().enumerate().map(|(at, row)| format!("{row},{}\n", cell(at)));
            format!("{head},{heading}\n{}", rows.collect::<String>())
        };
        let found = read(edges.len(), &table(&edges, heading, &|_| one.to_owned())).unwrap();
        for (row, parent) in found.rows().iter().zip(&parents) {
            prop_assert_eq!(row.parent().map(str::to_owned), Some(format!("a{parent}")));
        }
        prop_assert_eq!(found.passed_over(), ["note", heading]);
        // A column of the same heading in the list is named once.
        let found = read(edges.len(), &table(&edges, "note", &|at| at.to_string())).unwrap();
        prop_assert_eq!(found.passed_over(), ["note"]);
        // A number of parts.
        let at = twice.index(edges.len());
        let of_many = table(&edges, heading, &|row| if row == at { many } else { one }.to_owned());
        let error = read(edges.len(), &of_many).unwrap_err();
        let expected = format!("line {}: p{at}: column {heading:?} says {many:?}", at + 2);
        prop_assert!(error.starts_with(&expected), "{error}");
        // A row twice, at once or further below.
        let mut rows = edges.clone();
        let to = at + 1 + place.index(edges.len() - at);
        rows.insert(to, edges[at].clone());
        let error = read(edges.len(), &table(&rows, "note", &|_| String::new())).unwrap_err();
        let expected = format!(
            "line {}: \"p{at}\" belongs to \"a{}\" in line {} already", to + 2, parents[at], at + 2
        );
        prop_assert!(error.starts_with(&expected), "{error}");
    }
}

/// Of two columns, the second one was ignored.
#[test]
fn two_columns_of_one_heading_are_refused() {
    for (head, said) in [
        ("child,parent,Child", "line 1: columns \"child\" and \"Child\" say the same"),
        ("parent,child,parent", "line 1: columns \"parent\" and \"parent\" say the same"),
    ] {
        let error = read(1, &format!("{head}\np0,a,b\n")).unwrap_err();
        assert!(error.starts_with(said), "{error}");
    }
}
