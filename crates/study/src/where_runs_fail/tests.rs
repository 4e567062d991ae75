//! Where runs fail, held against straightforward counting and against made-up cases of which the answer is known.

use super::*;
use crate::{Options, Scenario, Study, write_report};
use gyradius_campaign::{Bound, Cell, Column, FailedRuns, Failure, Table};
use gyradius_report::Document;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::fs;

/// What a run drew, its outcome, and whether it failed.
type Drawn = (Vec<Option<f64>>, Option<f64>, bool);

fn names(inputs: usize) -> Vec<String> {
    (0..inputs).map(|i| format!("x{i}")).collect()
}

fn table(rows: &[Drawn]) -> Table {
    let inputs = names(rows[0].0.len());
    let columns = inputs.into_iter().chain(["y".to_owned()]);
    let columns = columns.map(|name| Column::number(name, "1", "A number."));
    let mut table = Table::new("model", 0, columns.collect()).unwrap();
    for (x, y, failed) in rows {
        let failure = failed.then(|| Failure::new("kind", "message"));
        let y = y.filter(|_| !failed);
        table.push(failure, x.iter().copied().chain([y]).map(Cell::from)).unwrap();
    }
    table
}

fn at_most(limit: f64) -> Requirement {
    let quantity = Measured::column("y");
    Requirement::new("small", quantity, Bound::AtMost(limit), 0.9, 0.9).unwrap()
}

fn asked<'a>(requirements: &'a [Requirement], inputs: &'a [String], group: u64) -> Asked<'a> {
    Asked { requirements, inputs, main: &[], group, rounding: Rounding::OF_SEPARATIONS }
}

/// The share of values below each, with half of those that are equal.
fn middle_ranks(x: &[f64]) -> Vec<f64> {
    let rank = |value: &f64| {
        let below = x.iter().filter(|other| *other < value).count() as f64;
        let equal = x.iter().filter(|other| *other == value).count() as f64;
        (below + equal / 2.0) / x.len() as f64
    };
    x.iter().map(rank).collect()
}

fn correlation(x: &[f64], y: &[f64]) -> Option<f64> {
    let (x, y) = (middle_ranks(x), middle_ranks(y));
    let product =
        |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - 0.5) * (b - 0.5)).sum() };
    let squares = product(&x, &x) * product(&y, &y);
    (x.len() > 3 && squares > 1e-9).then(|| product(&x, &y) / squares.sqrt())
}

fn by_holm(p: &[f64]) -> Vec<f64> {
    let step = |own: f64| (own * p.iter().filter(|other| **other >= own).count() as f64).min(1.0);
    let most = |own: &f64| p.iter().filter(|q| *q <= own).map(|q| step(*q)).fold(0.0, f64::max);
    p.iter().map(most).collect()
}

fn row() -> impl Strategy<Value = Drawn> {
    // Some values are equal, the last input is the same everywhere.
    let x = prop::option::weighted(0.95, (-6..7_i32).prop_map(f64::from));
    let x = prop::collection::vec(x, 4).prop_map(|mut x| {
        x.push(Some(1.5));
        x
    });
    (x, prop::option::weighted(0.95, -1.0..1.0_f64), prop::bool::weighted(0.1))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any inputs with gaps and ties, runs that failed, groups of runs, requirements that leave failed runs out or do not.
    #[test]
    fn tables_are_those_of_counting(
        rows in prop::collection::vec(row(), 15..120), group in 1..4_u64, limit in -1.0..1.0_f64, left_out: bool,
    ) {
        let handled = if left_out { FailedRuns::LeftOut } else { FailedRuns::Against };
        let requirements = [at_most(limit).with_failed_runs(handled)];
        let inputs = names(5);
        let found = found(&Runs::from(table(&rows)), asked(&requirements, &inputs, group)).unwrap();

        let first: Vec<&Drawn> = rows.iter().step_by(group as usize).collect();
        let fails = |(_, y, failed): &Drawn| match y.filter(|_| !failed) {
            Some(y) => Some(y > limit),
            None => (!left_out).then_some(true),
        };
        let counted: Vec<(&[Option<f64>], bool)> =
            first.iter().filter_map(|row| Some((row.0.as_slice(), fails(row)?))).collect();
        let failures = counted.iter().filter(|(_, failed)| *failed).count();
        let enough = failures >= 10 && counted.len() - failures >= 10;
        let requirement = found.as_ref().and_then(|found| found.requirements.first());
        prop_assert_eq!(requirement.is_some(), enough);
        if let Some(of) = requirement {
            prop_assert_eq!([of.runs, of.failures], [counted.len() as u64, failures as u64]);
            let told: Vec<&str> = of.inputs.iter().map(|input| input.input.as_str()).collect();
            prop_assert_eq!(told, ["x0", "x1", "x2", "x3"]);
            for (place, input) in of.inputs.iter().enumerate() {
                let own: Vec<(f64, bool)> =
                    counted.iter().filter_map(|(x, failed)| Some((x[place]?, *failed))).collect();
                let ranks = middle_ranks(&own.iter().map(|(x, _)| *x).collect::<Vec<_>>());
                let mut tenths = vec![[0; 2]; 10];
                for ((_, failed), rank) in own.iter().zip(ranks) {
                    let tenth = &mut tenths[(rank * 10.0 + 1e-9) as usize];
                    *tenth = [tenth[0] + 1, tenth[1] + u64::from(*failed)];
                }
                tenths.retain(|[runs, _]| *runs > 0);
                let told: Vec<[u64; 2]> = input.shares.tenths().iter().map(|t| [t.runs(), t.failures()]).collect();
                prop_assert_eq!(told, tenths);
            }
            let p: Vec<f64> = of.inputs.iter().map(Tenths::p_value).collect();
            let adjusted: Vec<f64> = of.inputs.iter().map(|input| input.adjusted_p_value).collect();
            prop_assert_eq!(adjusted, by_holm(&p));

            prop_assert_eq!((of.pairs_tested, of.pairs.len()), (6, 6));
            let p: Vec<f64> = of.pairs.iter().map(Pair::p_value).collect();
            prop_assert!(p.is_sorted());
            let adjusted: Vec<f64> = of.pairs.iter().map(|pair| pair.adjusted_p_value).collect();
            prop_assert_eq!(adjusted, by_holm(&p));
            for pair in &of.pairs {
                let places = [0, 1].map(|i: usize| pair.inputs[i][1..].parse::<usize>().unwrap());
                prop_assert!(places[0] < places[1]);
                // An input that some runs lack is counted with the runs that have both.
                let own: Vec<([f64; 2], bool)> = counted
                    .iter()
                    .filter_map(|(x, failed)| Some(([x[places[0]]?, x[places[1]]?], *failed)))
                    .collect();
                let ranks = [0, 1].map(|i: usize| middle_ranks(&own.iter().map(|(x, _)| x[i]).collect::<Vec<_>>()));
                let mut corners = [[[0_u64; 2]; 5]; 5];
                for (i, (_, failed)) in own.iter().enumerate() {
                    let [x, y] = [0, 1].map(|of: usize| (ranks[of][i] * 5.0 + 1e-9) as usize);
                    corners[x][y] = [corners[x][y][0] + 1, corners[x][y][1] + u64::from(*failed)];
                }
                let [x, y] = pair.clearest_excess.fifths.map(usize::from);
                prop_assert_eq!(corners[x][y], [pair.clearest_excess.runs, pair.clearest_excess.failures]);
                // The likelihood of the counts with the share of the cell itself over that with the share of all runs.
                let share = own.iter().filter(|(_, failed)| *failed).count() as f64 / own.len() as f64;
                let log = |count: u64, p: f64| if count == 0 { 0.0 } else { count as f64 * p.ln() };
                let excess = |[runs, failures]: [u64; 2]| {
                    let of = |p: f64| log(failures, p) + log(runs - failures, 1.0 - p);
                    let p = failures as f64 / runs as f64;
                    (p - share).signum() * (of(p) - of(share))
                };
                let filled = corners.iter().flatten().filter(|[runs, _]| *runs > 0);
                let own = excess(corners[x][y]);
                prop_assert!(filled.map(|cell| excess(*cell)).all(|other| !(other > own + 1e-9)), "{corners:?}");
            }
        }

        for place in 0..5 {
            let both = first.iter().filter_map(|(x, y, failed)| Some((x[place]?, y.filter(|_| !failed)?)));
            let (x, y): (Vec<f64>, Vec<f64>) = both.unzip();
            let told = found.as_ref().and_then(|found| {
                let all = &found.rank_correlations.first()?.inputs;
                all.iter().find(|own| own.input == inputs[place])
            });
            match (told, correlation(&x, &y)) {
                (Some(told), Some(expected)) => {
                    prop_assert_eq!(told.rank.n(), x.len());
                    prop_assert!((told.rank.value() - expected).abs() < 1e-9);
                }
                (told, expected) => prop_assert!(told.is_none() && expected.is_none()),
            }
        }

        let text = serde_json::to_string(&found).unwrap();
        let read: Option<WhereRunsFail> = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(serde_json::to_string(&read).unwrap(), text);
    }

    /// The first runs of groups, and no more than are asked for.
    #[test]
    fn the_first_independent_runs_are_read(
        numbers in prop::collection::vec(prop::option::of(-1.0..1.0_f64), 1..60), group in 1..5_u64, most in 1..30_u64,
    ) {
        let rows: Vec<Drawn> = numbers.iter().enumerate().map(|(i, x)| (vec![*x], Some(1.0), i % 3 == 0)).collect();
        let runs = Runs::from(table(&rows));
        let first = FirstRuns::new(&runs, group, most);
        let expected: Vec<Option<f64>> =
            numbers.iter().step_by(group as usize).take(most as usize).copied().collect();
        let read = first.drawn(&names(1)).unwrap();
        let read: Vec<Option<f64>> = read[0].iter().map(|x| Some(*x).filter(|x| x.is_finite())).collect();
        prop_assert_eq!(&read, &expected);
        let (there, fails) = first.failing(&[at_most(0.0)]).unwrap();
        prop_assert_eq!((there as usize, fails[0].len()), (expected.len(), expected.len()));
    }
}

/// Runs of inputs between −1 and 1, which fail the requirement `y ≤ 0.5` if this says so.
fn made(seed: u64, runs: usize, inputs: usize, fails: impl Fn(&[f64]) -> bool) -> Vec<Drawn> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut run = || {
        let x: Vec<f64> = (0..inputs).map(|_| rng.random_range(-1.0..1.0)).collect();
        let y = if fails(&x) { 1.0 } else { -1.0 };
        (x.into_iter().map(Some).collect(), Some(y + rng.random_range(0.0..0.1)), false)
    };
    (0..runs).map(|_| run()).collect()
}

fn looked_at(rows: &[Drawn]) -> WhereRunsFail {
    let inputs = names(rows[0].0.len());
    found(&Runs::from(table(rows)), asked(&[at_most(0.5)], &inputs, 1)).unwrap().unwrap()
}

fn shown_inputs(found: &WhereRunsFail) -> Vec<&str> {
    found.requirements[0].shown_inputs().map(|input| input.input.as_str()).collect()
}

fn shown_pairs(found: &WhereRunsFail) -> Vec<[&str; 2]> {
    let pairs = found.requirements[0].shown_pairs();
    pairs.map(|pair| pair.inputs.each_ref().map(String::as_str)).collect()
}

fn page(found: &[WhereRunsFail]) -> String {
    Document::new("t", "h", "l")
        .sections(sections(found, false, |_| true, "each outcome"))
        .markdown()
}

#[test]
fn an_input_that_decides_is_found_among_many() {
    // More than are held at once: the second of two passes has it, and the first.
    for (seed, at) in [(1, 44), (2, 0), (3, 20)] {
        let found = looked_at(&made(seed, 1000, 45, |x| x[at] > 0.85));
        assert_eq!(shown_inputs(&found), [format!("x{at}")]);
        assert!(shown_pairs(&found).is_empty());
        let of = &found.requirements[0];
        assert_eq!((of.inputs.len(), of.pairs_tested, of.pairs.len()), (45, 40 * 39 / 2, PAIRS));
        let tenths = of.inputs[at].shares.tenths();
        assert_eq!((tenths[0].failures(), tenths[9].failures()), (0, of.failures.min(100)));
        let page = page(&[found]);
        assert!(page.contains("## Where runs fail"), "{page}");
        assert!(page.contains(&format!("`x{at}`")), "{page}");
    }
}

#[test]
fn nothing_is_shown_where_nothing_decides() {
    for seed in 0..20 {
        let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
        let mut rows = made(seed, 500, 6, |_| false);
        rows.iter_mut().filter(|_| rng.random_bool(0.1)).for_each(|row| row.1 = Some(1.0));
        let found = looked_at(&rows);
        assert!(shown_inputs(&found).is_empty() && shown_pairs(&found).is_empty(), "{seed}");
        let page = page(&[found]);
        assert!(page.contains("neither an input nor a pair"), "{page}");
    }
}

/// Where the sign of a product decides, neither of its factors does.
#[test]
fn a_pair_that_decides_together_is_found() {
    for seed in 0..5 {
        let found = looked_at(&made(seed, 2000, 6, |x| x[1] * x[4] > 0.0));
        assert_eq!((shown_inputs(&found).len(), shown_pairs(&found)), (0, vec![["x1", "x4"]]));
        assert!(page(&[found]).contains("`x1` and `x4`"));
        // In two corners, with few failures.
        let found = looked_at(&made(seed, 2000, 6, |x| x[1] * x[4] > 0.6));
        assert_eq!(shown_pairs(&found)[0], ["x1", "x4"], "{seed}");
        let corner = found.requirements[0].pairs[0].clearest_excess;
        assert!(corner.fifths == [0, 0] || corner.fifths == [4, 4], "{corner:?}");
    }
}

/// A flag that is set in few runs: failures are most where it is not, for so are the runs, and in excess where it is.
#[test]
fn the_corner_of_a_rare_flag_is_named() {
    for seed in 0..5 {
        let mut rows = made(seed, 3000, 3, |_| false);
        for (i, row) in rows.iter_mut().enumerate() {
            let flag = i % 20 == 0;
            row.0[0] = Some(f64::from(u8::from(flag)));
            let high = row.0[1].is_some_and(|x| x > 0.0);
            row.1 = Some(f64::from(u8::from(if flag { high } else { i % 17 == 0 })));
        }
        let found = looked_at(&rows);
        assert_eq!(shown_pairs(&found)[0], ["x0", "x1"], "{seed}");
        let corner = found.requirements[0].pairs[0].clearest_excess;
        assert!(corner.failures == corner.runs && corner.fifths[1] >= 3, "{corner:?}");
    }
}

/// One failure among few runs is no excess beside many, however small the share of failures is.
#[test]
fn a_single_failure_is_not_the_clearest_excess() {
    let rows = 10_000;
    let mut cells = [vec![0.0; rows], vec![0.0; rows]];
    let mut failed = vec![false; rows];
    for run in 0..rows {
        // Four runs have both, and a hundred each have one of them alone.
        cells[0][run] = f64::from(u8::from(run < 104));
        cells[1][run] = f64::from(u8::from(run < 4 || (104..204).contains(&run)));
        failed[run] = run == 0 || (4..14).contains(&run) || (run > 204 && run % 500 == 0);
    }
    let cells = cells.map(|values| QuantileCells::new(&values, FIFTHS).unwrap());
    let corner = Corner::with_clearest_excess([&cells[0], &cells[1]], &failed);
    assert_eq!((corner.runs, corner.failures), (100, 10));
    // Of two values one is the lowest and one the highest, however many runs have them.
    assert_eq!(corner.fifths, [4, 0]);
}

#[test]
fn nothing_is_told_without_requirements_or_failures() {
    let runs = Runs::from(table(&made(1, 200, 3, |x| x[0] > 0.8)));
    let inputs = names(3);
    assert_eq!(found(&runs, asked(&[], &inputs, 1)).unwrap(), None);
    assert_eq!(found(&runs, asked(&[at_most(0.5)], &[], 1)).unwrap(), None);
    let main = ["y".to_owned()];
    let told = found(&runs, Asked { main: &main, ..asked(&[], &inputs, 1) }).unwrap().unwrap();
    assert_eq!(told.requirements, []);
    assert_eq!(told.rank_correlations[0].outcome, "y");
    let page_of = page(&[told]);
    assert!(!page_of.contains("Where runs fail"), "{page_of}");
    assert!(page_of.contains("Rank correlations"), "{page_of}");
    for limit in [-9.0, 9.0] {
        let told = found(&runs, asked(&[at_most(limit)], &inputs, 1)).unwrap().unwrap();
        assert_eq!(told.requirements, []);
    }
    assert_eq!(page(&[]), Document::new("t", "h", "l").markdown());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Of any number of outcomes each is correlated or named, and the page says of which outcomes it speaks: of each model that has
    /// requirements or none.
    #[test]
    fn every_outcome_is_told_of_or_named(outcomes in 1..60_usize, seed in any::<u64>(), required in any::<[bool; 2]>()) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let names: Vec<String> = (0..outcomes).map(|i| format!("y{i}")).collect();
        let columns = names.iter().cloned().chain(["x".to_owned()]);
        let columns = columns.map(|name| Column::number(name, "1", "A number."));
        let mut table = Table::new("model", 0, columns.collect()).unwrap();
        for _ in 0..60 {
            let x: f64 = rng.random_range(-1.0..1.0);
            table.push(None, (0..=outcomes).map(|_| Cell::from(x))).unwrap();
        }
        let runs = Runs::from(table);
        let inputs = ["x".to_owned()];
        let of_y0 = [Requirement::new("first", Measured::column("y0"), Bound::AtMost(0.0), 0.9, 0.9).unwrap()];
        let told: Vec<WhereRunsFail> = (0..2).zip(required).map(|(model, required)| {
            let requirements = if required { &of_y0[..] } else { &[] };
            let found = found(&runs, Asked { main: &names, ..asked(requirements, &inputs, 1) }).unwrap().unwrap();
            WhereRunsFail { model: format!("model {model}"), ..found }
        }).collect();
        for (own, required) in told.iter().zip(required) {
            let all: Vec<&String> =
                own.rank_correlations.iter().map(|of| &of.outcome).chain(&own.outcomes_left_out).collect();
            let expected = if required { &names[..1] } else { &names[..] };
            prop_assert_eq!(all, expected.iter().collect::<Vec<_>>());
            prop_assert!(own.rank_correlations.len() <= 40);
        }
        let has = |model: &str| required[usize::from(model == "model 1")];
        let page = Document::new("t", "h", "l").sections(sections(&told, false, has, "each outcome")).markdown();
        let speaks = [page.contains("each quantity that the requirements"), page.contains("each outcome")];
        prop_assert_eq!(speaks, [required.contains(&true), required.contains(&false)], "{}", page);
        let is_named = outcomes > 40 && required.contains(&false);
        prop_assert_eq!(page.contains("Left out are the outcomes after the first 40: y40"), is_named);
        for name in names.iter().take(40).filter(|_| required.contains(&false)) {
            prop_assert!(page.contains(&format!("{name}, model")), "{} {}", name, page);
        }
    }
}

/// An outcome that is constant but for rounding goes with no input, however well the rounding does.
#[test]
fn rounding_of_an_outcome_goes_with_nothing() {
    let mut rows = made(1, 200, 3, |x| x[0] > 0.8);
    for (x, y, _) in &mut rows {
        *y = x[0].map(|x| 7.5 + 1e-14 * x);
    }
    let inputs = names(3);
    let main = ["y".to_owned()];
    let runs = Runs::from(table(&rows));
    assert_eq!(found(&runs, Asked { main: &main, ..asked(&[], &inputs, 1) }).unwrap(), None);
}

/// Of a body with fixed axes and no products these are rounding in every run, and no inputs.
#[test]
fn products_that_do_not_scatter_are_no_inputs() {
    let text = r#"
        name = "fixed"
        runs = 300
        [payload]
        mass_kg = 800.0
        inertia_kg_m2 = [[240.0, 2.4, 0.0], [2.4, 400.0, 0.0], [0.0, 0.0, 410.0]]
        position_m = [0.0, 0.0, 1.0]
        [payload.dispersion]
        root_second_moment_variance_kg_m2 = [0.03, 0.03, 0.01]
        axes = "fixed"
        [stage]
        mass_kg = 90.0
        inertia_kg_m2 = [[40.0, 0.3, 0.0], [0.3, 45.0, 0.0], [0.0, 0.0, 46.0]]
        position_m = [0.0, 0.0, -1.0]
        [stage.dispersion]
        root_second_moment_variance_kg_m2 = [0.002, 0.002, 0.001]
        axes = "fixed"
        [[springs]]
        stiffness_n_per_m = 9000.0
        stroke_m = 0.1
        payload_point_m = [0.5, 0.4, -0.9]
        stage_point_m = [0.5, 0.4, 0.9]
        [[models]]
        name = "own"
        law = "principal"
        axes = "whole-sphere"
    "#;
    let scenario = Scenario::from_toml(text).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let options = Options::to(folder.path().join("out"));
    let study = Study::run(&scenario, &options, &|_| {}).unwrap();
    let told = serde_json::to_string(&study.summary().head.where_runs_fail).unwrap();
    assert!(told.contains("payload_i11") && !told.contains("payload_i13"), "{told}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Of an input that is the same in many runs, and decides which fail: the table says how many runs the part has in which most of them fail, and
    /// the lowest and the highest part.
    #[test]
    fn the_runs_of_a_part_are_told((seed, tied) in (any::<u64>(), 0.0..0.95_f64), failing in 0.02..0.3_f64) {
        let mut rows = made(seed, 600, 1, |x| x[0] > 1.0 - failing);
        for row in &mut rows {
            // The lowest values become one.
            row.0[0] = row.0[0].map(|x| x.max(tied.min(1.0 - failing)));
        }
        let found = looked_at(&rows);
        let page = page(std::slice::from_ref(&found));
        for tenths in found.requirements.iter().flat_map(Failures::shown_inputs) {
            let parts = tenths.shares.tenths();
            prop_assert_eq!(parts.iter().map(gyradius_statistics::Tenth::runs).sum::<u64>(), 600);
            for part in [&parts[0], &parts[parts.len() - 1]] {
                prop_assert!(page.contains(&format!("{} of {}", part.failures(), part.runs())), "{}", page);
            }
            let share = |part: &&gyradius_statistics::Tenth| part.failures() as f64 / part.runs() as f64;
            let most = parts.iter().reduce(|a, b| if share(&b) > share(&a) { b } else { a }).unwrap();
            prop_assert!(page.contains(&format!("), {} of {}", most.failures(), most.runs())), "{}", page);
        }
        prop_assert!(page.contains("Runs with the same value stay in one part") || found.requirements.is_empty());
    }
}

/// A study writes it, and the report made again from its folder is the same.
#[test]
fn a_study_tells_where_its_runs_fail() {
    let requirement = "[[requirements]]\nname = \"steady\"\nquantity = \"nutation_deg\"\nat_most = 7.0\n\
                       probability = 0.9\nconfidence = 0.9\n\n[[comparisons]]";
    let text = Scenario::peck_2003().unwrap().to_toml();
    let text = text.replacen("[[comparisons]]", requirement, 1);
    let scenario = Scenario::from_toml(&text).unwrap().with_runs(600).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let options = Options::to(out.clone());
    let study = Study::run(&scenario, &options, &|_| {}).unwrap();
    let told = &study.summary().head.where_runs_fail;
    assert_eq!(told.len(), study.runs().len());
    let mut inputs = Vec::new();
    for (own, runs) in told.iter().zip(study.runs()) {
        assert_eq!((own.model.as_str(), own.runs), (runs.model(), 600));
        assert!(!own.rank_correlations.is_empty());
        inputs.extend(own.requirements.iter().flat_map(|of| &of.inputs).map(|i| i.input.as_str()));
    }
    let drawn = ["payload_i", "payload_q", "stage_i", "stage_q"];
    let is_drawn = |input: &&str| drawn.iter().any(|known| input.starts_with(known));
    assert!(inputs.iter().all(is_drawn) && inputs.contains(&"payload_q1"), "{inputs:?}");
    let pages = ["report.html", "report.md"].map(|name| (name, fs::read(out.join(name)).unwrap()));
    let markdown = String::from_utf8_lossy(&pages[1].1);
    println!("{markdown}");
    assert!(markdown.contains("## Where runs fail"));
    write_report(&out, None, true).unwrap();
    for (name, page) in &pages {
        assert!(fs::read(out.join(name)).unwrap() == *page, "{name}");
    }
}
