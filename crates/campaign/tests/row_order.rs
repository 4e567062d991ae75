//! The order of the rows of a table that says which run each is, of which nothing depends, and that of runs of the same value.

use gyradius_campaign::{Bound, ForeignTable, Judgement, Measured, Requirement};
use proptest::prelude::*;

proptest! {
    /// Whatever the order of its rows, of a table that says which run each is the same is told: also which of equal runs are the worst,
    /// and the share among the first so many. Of any numbers of runs, also of a few of many.
    #[test]
    fn the_order_of_rows_does_not_matter(
        rows in prop::collection::btree_map(0..3000_u64, prop::option::weighted(0.9, -2..3_i32), 1..300),
        (infinite, first) in (0.0..0.3_f64, prop::sample::select(vec![0, 0, 5000])),
        bound in prop_oneof![
            Just(Bound::AtMost(0.0)),
            Just(Bound::AtLeast(0.0)),
            Just(Bound::Between(-1.0, 1.0)),
        ],
        all in any::<bool>(),
        order in prop::collection::vec(any::<u32>(), 300),
    ) {
        let number = |(run, x): (u64, Option<i32>)| match x {
            Some(2) if (run as f64 * 0.618).fract() < infinite => format!("{run},inf\n"),
            Some(x) => format!("{run},{x}\n"),
            None => format!("{run},\n"),
        };
        let rows = rows.into_iter().enumerate();
        // All runs from the first on, or some.
        let rows: Vec<(u64, Option<i32>)> =
            rows.map(|(row, (run, x))| (if all { row as u64 } else { first + run }, x)).collect();
        let requirement = [Requirement::new("it", Measured::column("x"), bound, 0.6, 0.8).unwrap()];
        let judged = |rows: &[(u64, Option<i32>)]| {
            let text = format!("run,x\n{}", rows.iter().copied().map(number).collect::<String>());
            let table = ForeignTable::read_csv("it".as_ref(), text.as_bytes()).unwrap();
            Judgement::of_table(&requirement, &table).unwrap().remove(0)
        };
        let in_order = judged(&rows);
        let mut shuffled: Vec<(u32, (u64, Option<i32>))> = order.into_iter().zip(rows.clone()).collect();
        shuffled.sort_by_key(|(place, _)| *place);
        let shuffled: Vec<(u64, Option<i32>)> = shuffled.into_iter().map(|(_, row)| row).collect();
        let other = judged(&shuffled);
        // The shares that are told are those of the first so many.
        let convergence = |of: &Judgement| of.convergence().iter().map(|e| (e.runs, e.failures)).collect::<Vec<_>>();
        let (of_other, of_rows) = (convergence(&other), convergence(&in_order));
        prop_assert_eq!(&of_other, &of_rows);
        for (runs, failures) in of_other {
            let first = judged(&rows[..runs as usize]);
            prop_assert_eq!((first.counted(), first.failures()), (runs, failures));
        }
        prop_assert_eq!(other, in_order);
    }
}

/// −0 and 0 are equal: of runs of both, the worst are the first, whatever is required, and whichever run has which.
#[test]
fn zeros_of_both_signs_are_equal() {
    for bound in [
        "x <= 0",
        "x >= 0",
        "0 <= x <= 0",
        "x <= -1",
        "x >= 1",
        "-2 <= x <= -1",
        "x <= 3",
        "x >= -0",
    ] {
        let requirement: Requirement = format!("{bound} in 90 % at 90 %").parse().unwrap();
        for signs in 0..1 << 6 {
            let zero = |run: usize| if signs >> run & 1 == 0 { "0" } else { "-0" };
            let text: Vec<&str> = (0..6).map(zero).collect();
            let csv = format!("x\n{}\n", text.join("\n"));
            let table = ForeignTable::read_csv("it".as_ref(), csv.as_bytes()).unwrap();
            let judged = Judgement::of_table(std::slice::from_ref(&requirement), &table).unwrap();
            let worst: Vec<u64> = judged[0].worst().iter().map(|run| run.run).collect();
            assert_eq!(worst, (0..6).collect::<Vec<_>>(), "{bound}: {text:?}");
        }
    }
}
