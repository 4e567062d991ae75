//! Cells in quotation marks: nothing in them or behind them is dropped.

use gyradius_formats::{InertiaFile, PartsTable, Products, TenMomentsFile};
use proptest::{prelude::*, sample::select};
use std::path::Path;

const BEHIND: &str = "something stands behind the quotation mark that closes cell";

fn bodies(text: &str) -> Result<InertiaFile, String> {
    let bytes = text.as_bytes().to_vec();
    let file = InertiaFile::parse(Path::new("t.csv"), bytes, Products::TensorEntries);
    file.map_err(|error| error.to_string())
}

/// Why the list of parts and the table of inertias refuse a text.
fn refusals(text: &str) -> [Option<String>; 2] {
    let list = PartsTable::read(text.as_bytes(), None).err().map(|error| error.to_string());
    [list, bodies(text).err()]
}

/// A cell as it is written.
fn quoted(cell: &str) -> String {
    format!("\"{}\"", cell.replace('"', "\"\""))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// `"12" lb` was 12, and `"1"000` was 1.
    #[test]
    fn nothing_stands_behind_a_closing_mark(
        separator in select(vec![",", ";", "\t"]),
        line_end in select(vec!["\n", "\r\n"]),
        at in 0..8_usize,
        row in 1..4_usize,
        behind in " {0,2}[0-9a-z.'µ%-][0-9a-z.'µ%\" -]{0,4}",
        blanks in "[ \u{a0}]{0,3}",
    ) {
        // A mark behind the cell would open and close more of it.
        let behind = behind.replace('"', "");
        let table = |after: &str| {
            let mut lines = vec!["name,mass,cx,cy,cz,ixx,iyy,izz".replace(',', separator)];
            for line in 1..4 {
                let mut cells: Vec<String> = ["p", "12", "0", "0", "0", "10", "10", "10"].map(str::to_owned).to_vec();
                cells[0] += &line.to_string();
                if line == row {
                    cells[at] = format!("\"{}\"{after}", cells[at]);
                }
                lines.push(cells.join(separator));
            }
            lines.join(line_end) + line_end
        };
        for (place, refusal) in ["line ", "t.csv:"].into_iter().zip(refusals(&table(&behind))) {
            let said = refusal.unwrap_or_default();
            let expected = format!("{place}{}: malformed: {BEHIND} {}: ", row + 1, at + 1);
            prop_assert!(said.starts_with(&expected), "{said}");
        }
        let text = table(&blanks);
        let list = PartsTable::read(text.as_bytes(), None).unwrap();
        prop_assert!(list.rows()[..3].iter().all(|row| row.numbers().unwrap().mass_kg() == 12.0));
        prop_assert_eq!(bodies(&text).unwrap().bodies().len(), 3);
    }

    /// Marks that are doubled, separators and line ends belong to the cell.
    #[test]
    fn what_is_quoted_is_whole(
        name in "[a-z][a-z\",;\t\n ]{0,8}[a-z]",
        separator in select(vec![",", ";", "\t"]),
    ) {
        let head = "name,mass,cx,cy,cz,ixx,iyy,izz".replace(',', separator);
        let rest = ",1,0,0,0,1,1,1".replace(',', separator);
        let text = format!("{head}\n{}{rest}\nlast{rest}\n", quoted(&name));
        let list = PartsTable::read(text.as_bytes(), None).unwrap();
        prop_assert_eq!(list.rows()[0].name(), &name);
        let file = bodies(&text).unwrap();
        prop_assert_eq!(file.bodies()[0].name(), &name);
        prop_assert_eq!(file.bodies().len(), 2);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A header whose marks hold no cells was a title, and the rows below it were dropped where another header follows.
    #[test]
    fn a_header_is_no_title(
        separator in select(vec![",", ";", "\t"]),
        at in 0..8_usize,
        behind in select(vec![" kg", "kg", " (1)", " x", ""]),
        is_open in any::<bool>(),
        titles in 0..3_usize,
        again in any::<bool>(),
    ) {
        let head = "name,mass,cx,cy,cz,ixx,iyy,izz".replace(',', separator);
        let rest = ",1,0,0,0,1,1,1".replace(',', separator);
        let mut cells: Vec<String> = head.split(separator).map(str::to_owned).collect();
        let is_broken = is_open || !behind.is_empty();
        let (close, behind) = if is_open { ("", "") } else { ("\"", behind) };
        cells[at] = format!("\"{}{close}{behind}", cells[at]);
        let mut text = "The \"List\" of parts\n".repeat(titles);
        text += &format!("{}\na{rest}\n", cells.join(separator));
        if again {
            text += &format!("{head}\nb{rest}\n");
        }
        for (place, refusal) in ["line ", "t.csv:"].into_iter().zip(refusals(&text)) {
            let said = refusal.unwrap_or_default();
            if is_broken {
                let mark = if is_open { "a quotation mark is not closed" } else { BEHIND };
                prop_assert!(said.starts_with(&format!("{place}{}: malformed: {mark}", titles + 1)), "{said} of {text}");
            } else {
                prop_assert!(again || said.is_empty(), "{said} of {text}");
            }
        }
    }
}

/// The table of edges and an estimate are read by the same rules.
#[test]
fn edges_and_estimates_drop_nothing() {
    let list = "name,mass,cx,cy,cz,ixx,iyy,izz\na,1,0,0,0,1,1,1\n";
    let edges = "child,parent\n\"a\" 2,b\n";
    let error = PartsTable::with_edges(list.as_bytes(), edges.as_bytes(), None).unwrap_err();
    assert!(error.to_string().starts_with(&format!("line 2: malformed: {BEHIND} 1: ")), "{error}");
    let rows = |cell: &str| {
        let mut rows = vec![vec!["1".to_owned(); 10]; 11];
        rows[3][4] = cell.to_owned();
        rows.iter().map(|row| row.join(",") + "\n").collect::<String>()
    };
    let folder = std::env::temp_dir().join(format!("gyradius-quotes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("estimate.csv");
    let read = |cell: &str| {
        std::fs::write(&path, rows(cell)).unwrap();
        TenMomentsFile::read(&path).map_err(|error| error.to_string())
    };
    let found = (read("\"1\""), read("\"1\"0"));
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(found.0.is_ok(), "{:?}", found.0);
    let error = found.1.unwrap_err();
    assert!(error.contains(&format!("line 4: {BEHIND} 5: ")), "{error}");
}
