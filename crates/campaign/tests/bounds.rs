//! Bounds that judgements give, for limits of any size.

use gyradius_campaign::{Bound, ForeignTable, Judgement};

/// A limit far from all numbers takes none of the digits of the bound, which is the number of a run.
#[test]
fn the_bound_of_a_share_is_the_number_of_a_run() {
    for (cells, requirement, expected) in [
        (["5e-17", "4e-17", "3e-17"], "x <= 1 in 50% at 80%", Bound::AtMost(5e-17)),
        (["1.2345678e-7", "2.2222e-7", "1e-9"], "x <= 1e9 in 50% at 80%", Bound::AtMost(2.2222e-7)),
        (["1e-200", "2e-200", "3e-200"], "x >= -1e300 in 50% at 80%", Bound::AtLeast(1e-200)),
        (["0.5", "-3", "1"], "-2 <= x <= 2 in 50% at 80%", Bound::Between(-3.0, 3.0)),
    ] {
        let text = format!("x\n{}\n", cells.join("\n"));
        let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
        let judged = Judgement::of_table(&[requirement.parse().unwrap()], &table).unwrap();
        assert_eq!(judged[0].tolerance(), Some(expected), "{requirement}");
    }
}
