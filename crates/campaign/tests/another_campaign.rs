//! Files of other programs that are called as that of a campaign.

use gyradius_campaign::{Cell, Column, ForeignTable, Judgement, Requirement, Table};
use std::fs::{self, File};

use crate::scratch::scratch;

/// A file that another program calls as that of a campaign says nothing of the table beside it; one that is damaged may.
#[test]
fn a_campaign_of_another_program_says_nothing() {
    let scratch = scratch();
    let folder = scratch.path().join("runs/mc");
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join("a.parquet");
    let mut table = Table::new("m", 0, vec![Column::number("x", "1", "a number")]).unwrap();
    (0..3).for_each(|_| table.push(None, [Cell::Number(1.0)]).unwrap());
    table.write_parquet(File::create(&file).unwrap()).unwrap();
    let requirement: [Requirement; 1] = ["x <= 3 in 60 % at 80 %".parse().unwrap()];
    for (told, is_of_another) in [
        ("{\"name\": \"mine\"}", true),
        ("{\"version\": 3, \"blocks\": []}", true),
        ("[]", true),
        ("7", true),
        ("{}", false),
        ("", false),
        ("{\"name\": ", false),
        ("{\"gyradius_version\": \"0.1.0\"}", false),
    ] {
        fs::write(scratch.path().join("campaign.json"), told).unwrap();
        for path in [&folder, &file] {
            let table = ForeignTable::open(path);
            let found = table.map(|table| Judgement::of_table(&requirement, &table).unwrap());
            let refused = "which says how its runs are judged";
            match found {
                Ok(judged) => assert!(is_of_another && judged[0].runs() == 3, "{told}"),
                Err(error) => assert!(
                    !is_of_another && error.to_string().contains(refused),
                    "{told}: {error}"
                ),
            }
        }
    }
}
