//! What runs amount to, on a page: of many numbers, of any rows, and read back.

use super::*;
use gyradius_campaign::{Cell, Column, Failure};
use proptest::prelude::*;

fn number() -> impl Strategy<Value = Option<f64>> {
    prop_oneof![
        3 => (-5.0..5.0).prop_map(Some),
        1 => Just(None),
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, 1e300, -1e300, 0.0]).prop_map(Some),
    ]
}

/// However many numbers there are, each has its panel, or the page says that it has none; figures are as high as a sheet
/// of paper at most, and have names that are known before the runs.
#[test]
fn every_number_has_a_panel_or_is_named() {
    for numbers in [1, 15, 16, 24, 40, 300, 301, 340] {
        let column = |i: i32| Column::number(format!("x{i}x"), "m", "A number.");
        let columns = (0..numbers).map(column).collect();
        let mut table = Table::new("own", 0, columns).unwrap();
        for run in 0..3 {
            table.push(None, (0..numbers).map(|i| Cell::from(Some(f64::from(run * i))))).unwrap();
        }
        let overview = Overview::new("", &[table]).unwrap();
        let names: Vec<String> = Overview::figure_names(numbers as usize).collect();
        let svgs: Vec<String> = overview.figures.iter().map(Figure::svg).collect();
        assert!(overview.figures.iter().all(|figure| names.contains(&figure.name)));
        for svg in &svgs {
            let side = |name: &str| -> f64 {
                svg.split_once(&format!(" {name}=\""))
                    .unwrap()
                    .1
                    .split('"')
                    .next()
                    .unwrap()
                    .parse()
                    .unwrap()
            };
            assert!(side("height") / side("width") < 1.3, "{} {}", side("height"), side("width"));
        }
        let page = overview.document().markdown();
        let without: Vec<i32> = (1..numbers)
            .filter(|i| !svgs.iter().any(|svg| svg.contains(&format!("x{i}x"))))
            .collect();
        assert_eq!(without.len(), (numbers as usize).saturating_sub(301));
        let said = match without[..] {
            [] => !page.contains("in no figure"),
            [only] => page.contains(&format!("x{only}x is in no figure")),
            [first, .., last] => page
                .contains(&format!("The {} quantities from x{first}x to x{last}x", without.len())),
        };
        assert!(said, "{numbers}: {page}");
        // The first is always zero.
        let same =
            "which have the same value in all runs of each model that have a finite one: x0x.";
        assert!(page.contains(same), "{numbers}: {page}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Runs without a value, with one of few, and with an infinite one, which is what a run that fails can come to: what is said of a
    /// quantity without a figure is so of every row, from tables and from surveys.
    #[test]
    fn what_is_said_of_quantities_without_a_figure_is_so(
        rows in prop::collection::vec(
            prop_oneof![
                4 => prop::sample::select(vec![1.0, 2.0]).prop_map(|x| (Some(x), false)),
                2 => any::<bool>().prop_map(|failed| (None, failed)),
                2 => prop::sample::select(vec![f64::INFINITY, f64::NEG_INFINITY]).prop_map(|x| (Some(x), true)),
            ],
            0..12,
        ),
        least in 1.0..2.5_f64,
    ) {
        // Often all of one value, or none.
        let rows = rows.into_iter().filter(|(x, _)| x.is_none_or(|x| !x.is_finite() || x >= least));
        let rows: Vec<(Option<f64>, bool)> = rows.collect();
        let mut table = Table::new("own", 0, vec![Column::number("y", "1", "A number.")]).unwrap();
        for (y, failed) in &rows {
            table.push(failed.then(|| Failure::new("kind", "message")), [Cell::from(*y)]).unwrap();
        }
        let runs = gyradius_campaign::Runs::from(table.clone());
        let surveys = [Surveys::new(&runs, Confidence::default()).unwrap()];
        let finite: Vec<f64> = rows.iter().filter_map(|(y, _)| y.filter(|y| y.is_finite())).collect();
        let is_same = finite.iter().all(|y| *y == finite[0]);
        for overview in [
            Overview::new("", &[table.clone()]).unwrap(),
            Overview::of_surveys("", table.columns(), &surveys).unwrap(),
        ] {
            let page = overview.document().markdown();
            let said = page.lines().find(|line| line.starts_with("There is no figure of"));
            let is_so = match said.map(|said| said.split(" which ").nth(1).unwrap()) {
                None => !is_same,
                Some("have no finite value in any run: y.") => finite.is_empty(),
                Some("have the same value in all runs of each model that have a finite one: y.") => {
                    is_same && !finite.is_empty()
                }
                Some("have a value that is not finite: y.") => {
                    rows.iter().any(|(y, _)| y.is_some_and(f64::is_infinite))
                }
                Some(_) => false,
            };
            prop_assert!(is_so, "{:?} {:?}", said, rows);
        }
    }

    /// Any tables, names that are markup, failures: the page from what was written is the same.
    #[test]
    fn what_reads_back_gives_the_same_page(
        runs in prop::collection::vec((number(), number(), any::<bool>()), 0..40),
        models in 1_usize..4,
    ) {
        let columns = || vec![
            Column::number("x_<m>", "m", "A \"number\"."),
            Column::number("y", "1", "Another."),
            Column::new("text", Kind::Text, "No number."),
        ];
        let tables: Vec<Table> = (0..models)
            .map(|model| {
                let mut table = Table::new(&format!("<model & {model}>"), 0, columns()).unwrap();
                for (x, y, failed) in &runs {
                    let failure = failed.then(|| Failure::new("<kind>", "<message>"));
                    table.push(failure, [(*x).into(), (*y).into(), Cell::Null]).unwrap();
                }
                table
            })
            .collect();
        let overview = Overview::new("a <title>", &tables).unwrap();
        let text = serde_json::to_string(&overview).unwrap();
        let read: Overview = serde_json::from_str(&text).unwrap();
        // Infinite means are null in JSON; whoever writes a page makes it from what is read.
        let again: Overview = serde_json::from_str(&serde_json::to_string(&read).unwrap()).unwrap();
        prop_assert_eq!(again.document(), read.document());
        let page = read.document().html();
        prop_assert!(!page.contains("<model &") && page.contains("&lt;model &amp; 0&gt;"));
        let failed = runs.iter().filter(|run| run.2).count();
        prop_assert_eq!(page.contains("of the runs failed"), failed > 0);
        // Of how many runs the statistics are is said where not all have a value.
        let succeeded = runs.iter().filter(|run| !run.2).count();
        // What was drawn is there in runs that failed, too.
        let counts = [
            runs.iter().filter(|run| run.0.is_some()).count(),
            runs.iter().filter(|run| run.1.is_some()).count(),
        ];
        for n in 1..=succeeded {
            let said = page.matches(&format!(">of {n} of {succeeded} runs<")).count();
            let some = counts.iter().filter(|count| **count == n && n < succeeded).count();
            prop_assert_eq!(said, models * some, "{}", page);
        }
        // Each number varies, or is named as one that there is no figure of.
        for name in ["x_<m>", "y"] {
            let quantity = read.quantities.iter().find(|quantity| quantity.column == name).unwrap();
            let escaped = name.replace('<', "&lt;").replace('>', "&gt;");
            let named = page.split("There is no figure of").skip(1);
            let mut named = named.filter_map(|text| text.split("</p>").next()?.split(": ").last());
            let is_named = named.any(|names| {
                names.trim_end_matches('.').split(", ").any(|other| other == escaped)
            });
            prop_assert_eq!(is_named, !quantity.varies(), "{}", name);
        }
    }
}
