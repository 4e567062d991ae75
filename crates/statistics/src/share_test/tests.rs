//! Tests of shares against enumeration, closed forms and simulation.

use proptest::prelude::*;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

fn cells(of: &[(u64, u64)]) -> Vec<Cell> {
    of.iter().map(|&(runs, failures)| Cell { runs, failures }).collect()
}

/// The p-value by dealing the failures to the runs in every way, one bit for each run, of the rounded statistic.
fn by_enumeration(cells: &[Cell]) -> f64 {
    let runs: u64 = cells.iter().map(|cell| cell.runs).sum();
    let failures: u64 = cells.iter().map(|cell| cell.failures).sum();
    // Each term in eighths, rounded, in whole numbers.
    let statistic = |counts: &[u64]| -> u64 {
        let of = |(cell, k): (&Cell, &u64)| {
            let above = 8 * (k * runs).abs_diff(cell.runs * failures).pow(2);
            let below = cell.runs * failures * (runs - failures);
            (2 * above + below) / (2 * below)
        };
        cells.iter().filter(|cell| cell.runs > 0).zip(counts).map(of).sum()
    };
    let bits: Vec<u32> = cells.iter().filter(|c| c.runs > 0).map(|c| (1 << c.runs) - 1).collect();
    let found: Vec<u64> = cells.iter().filter(|c| c.runs > 0).map(|c| c.failures).collect();
    let (mut as_large, mut all) = (0, 0);
    for dealt in (0_u32..1 << runs).filter(|dealt| u64::from(dealt.count_ones()) == failures) {
        let mut rest = dealt;
        let counts: Vec<u64> = bits
            .iter()
            .map(|bits| {
                let own = u64::from((rest & bits).count_ones());
                rest >>= bits.count_ones();
                own
            })
            .collect();
        all += 1;
        as_large += u32::from(statistic(&counts) >= statistic(&found));
    }
    f64::from(as_large) / f64::from(all)
}

#[test]
fn closed_forms() {
    let p = |of: &[(u64, u64)]| ShareTest::new(&[cells(of)]);
    // All of three failures among 60 runs in one of three cells of 20: 3 · 20·19·18/(60·59·58).
    let expected = 3.0 * 6840.0 / 205_320.0;
    assert!((p(&[(20, 3), (20, 0), (20, 0)]).p_value() - expected).abs() < 1e-14);
    // The same of successes.
    assert!((p(&[(20, 20), (20, 17), (20, 20)]).p_value() - expected).abs() < 1e-14);
    // Five failures among a hundred thousand runs, all in one tenth: nearly 10⁻⁴, and far below what χ² says.
    let mut tenths = vec![(10_000, 0); 10];
    tenths[9].1 = 5;
    let found = p(&tenths).p_value();
    assert!((found / 1e-4 - 1.0).abs() < 1e-3, "{found}");
    for none in
        [vec![], vec![(9, 3)], vec![(9, 0), (9, 0)], vec![(9, 9), (3, 3)], vec![(0, 0), (9, 3)]]
    {
        assert_eq!(p(&none), ShareTest { p_value: 1.0, exact: true }, "{none:?}");
    }
    // Pearson's test by hand: (10 + 10)²/… of 100 and 140 failures in a thousand runs each.
    let large = p(&[(40_000, 4000), (40_000, 4200), (40_000, 4100), (40_000, 4100)]);
    let statistic = 2.0 * 10_000.0 / (4100.0 * (1.0 - 0.1025));
    let chi_squared = tail::chi_squared(statistic, 3.0);
    assert!(
        (large.p_value() / chi_squared - 1.0).abs() < 0.05 && !large.exact(),
        "{large:?} {chi_squared}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn the_exact_test_agrees_with_enumeration(
        of in prop::collection::vec((0..5_u64, 0.0..=1.0_f64), 1..5),
    ) {
        let of: Vec<_> = of.iter().map(|(runs, share)| Cell {
            runs: *runs, failures: (*runs as f64 * share).round() as u64,
        }).collect();
        let [runs, failures] = [|c: &Cell| c.runs, |c: &Cell| c.failures].map(|f| of.iter().map(f).sum::<u64>());
        prop_assume!(failures > 0 && failures < runs && of.iter().filter(|c| c.runs > 0).count() > 1);
        let (found, expected) = (ShareTest::new(std::slice::from_ref(&of)).p_value(), by_enumeration(&of));
        prop_assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    /// Holm's p-values against his steps as he wrote them: reject from the smallest on while p ≤ α/(m − i).
    #[test]
    fn holm_rejects_what_his_steps_reject(p in prop::collection::vec(0.0..=1.0_f64, 0..12), risk in 0.001..0.999_f64) {
        let p: Vec<f64> = p.iter().map(|p| p.powi(4)).collect();
        let mut sorted = p.clone();
        sorted.sort_by(f64::total_cmp);
        let steps = sorted.iter().enumerate();
        let rejected = steps.take_while(|(i, x)| **x * (p.len() - i) as f64 <= risk).count();
        let adjusted = holm(&p).unwrap();
        prop_assert_eq!(adjusted.iter().filter(|x| **x <= risk).count(), rejected);
        prop_assert!(adjusted.iter().zip(&p).all(|(adjusted, p)| adjusted >= p && *adjusted <= 1.0));
    }
}

#[test]
fn holm_refuses_what_is_no_probability() {
    for value in [-0.1, 1.1, f64::INFINITY] {
        assert_eq!(holm(&[0.5, value]), Err(StatisticsError::Probability { value }));
    }
    assert!(holm(&[f64::NAN]).is_err());
}

/// The two-sided probability of the hypergeometric law, by its probabilities from logarithms of factorials: of so many
/// runs in the cell, of all, and failures of all; of tables with a statistic as large as of so many failures in the cell.
fn hypergeometric(cell: u64, runs: u64, failures: u64, found: u64) -> f64 {
    let ln_choose = |n: u64, k: u64| {
        let ln = |n: u64| libm::lgamma(n as f64 + 1.0);
        ln(n) - ln(k) - ln(n - k)
    };
    let expected = cell as f64 * failures as f64 / runs as f64;
    let off = (found as f64 - expected).abs();
    let least = failures.saturating_sub(runs - cell);
    (least..=cell.min(failures))
        .filter(|k| (*k as f64 - expected).abs() >= off - 1e-9 * off)
        .map(|k| {
            let ways = ln_choose(cell, k) + ln_choose(runs - cell, failures - k);
            (ways - ln_choose(runs, failures)).exp()
        })
        .sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// One value against another one, rare or not, with any number of failures: as the hypergeometric law has it, up to the
    /// rounding of the statistic, which joins tables within an eighth of what was found.
    #[test]
    fn two_cells_are_as_the_hypergeometric_law_has_them(
        runs in 2..20_000_u64, of_cell in 0.0..0.5_f64, share in 0.002..0.5_f64, found in 0.0..=1.0_f64,
    ) {
        let failures = ((runs as f64 * share) as u64).max(1);
        let cell = ((runs as f64 * of_cell.powi(2)) as u64).max(1);
        let found = ((cell.min(failures) as f64 * found.powi(2)).round() as u64).max(failures.saturating_sub(runs - cell));
        let rare = Cell { runs: cell, failures: found };
        let rest = Cell { runs: runs - cell, failures: failures - found };
        for cells in [vec![rare, rest], vec![rest, rare]] {
            let test = ShareTest::new(&[cells]);
            prop_assert!(test.exact());
            let expected = hypergeometric(cell, runs, failures, found);
            let all = Stratum::new(&[rare, rest]).unwrap().all;
            let steps = |k: u64| all.term(Cell { runs: cell, failures: k });
            // Of tables that the rounding may or may not count, both ways.
            let near = |k: &u64| (steps(*k) - steps(found)).abs() <= 3.0 / STEPS.min(ALL_STEPS / steps(found).max(1e-9));
            let doubt: f64 = (0..=cell.min(failures)).filter(near).map(|k| {
                hypergeometric(cell, runs, failures, k) - hypergeometric(cell, runs, failures, k + 1).min(1.0)
            }.abs()).sum();
            prop_assert!(
                (test.p_value() - expected).abs() <= 1e-9 * expected + doubt + 2.0 * NEGLIGIBLE,
                "{} {expected} {doubt}", test.p_value()
            );
        }
    }
}

/// Cells of any sizes with any number of failures against simulation: the probability that failures dealt at random differ
/// so much by Pearson's statistic. Numbers of failures in two large cells are whole and χ² is not, hence the tolerance.
#[test]
fn mixed_cells_agree_with_simulation() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for sizes in [
        vec![800, 7],
        vec![400, 400, 11],
        vec![5, 300, 300, 4, 300, 9],
        vec![60; 10],
        vec![2, 2, 2, 2, 2, 500],
        vec![1, 200, 30, 500],
    ] {
        let runs: u64 = sizes.iter().sum();
        let mut owner: Vec<usize> =
            sizes.iter().enumerate().flat_map(|(i, n)| (0..*n).map(move |_| i)).collect();
        for failures in [70, 110, (runs / 3) as usize] {
            let mut deal = || -> Vec<Cell> {
                let (failed, _) = owner.partial_shuffle(&mut rng, failures);
                let mut cells: Vec<Cell> =
                    sizes.iter().map(|runs| Cell { runs: *runs, failures: 0 }).collect();
                failed.iter().for_each(|i| cells[*i].failures += 1);
                cells
            };
            let p_of = |cells: &Vec<Cell>| ShareTest::new(std::slice::from_ref(cells)).p_value();
            let simulated: Vec<f64> = (0..2000).map(|_| p_of(&deal())).collect();
            for level in [0.1, 0.03, 0.01] {
                let share = simulated.iter().filter(|p| **p <= level).count() as f64 / 2000.0;
                let noise = 4.0 * (level / 2000.0_f64).sqrt();
                assert!(share <= 1.2 * level + noise, "{sizes:?} {failures}: {share} at {level}");
                // It is not dull either: with many ways to deal, p-values reach what they may.
                let fine = sizes.len() > 3 && level > 0.02;
                assert!(
                    !fine || share >= 0.6 * level - noise,
                    "{sizes:?} {failures}: {share} at {level}"
                );
            }
        }
    }
}

/// A spring that fails in eleven of 2,000 runs, all of which miss the requirement, among many that miss it.
#[test]
fn a_rare_cause_is_found_among_many_failures() {
    for others in [0, 40, 49, 50, 100, 400, 900] {
        let test = ShareTest::new(&[cells(&[(1989, others), (11, 11)])]);
        let expected = hypergeometric(11, 2000, others + 11, 11).max(NEGLIGIBLE);
        assert!(
            test.p_value() < 5.0 * expected && test.p_value() > 0.9 * expected,
            "{others}: {test:?} {expected}"
        );
        // In strata too, of which others are large.
        let strata = [cells(&[(1989, others), (11, 11)]), cells(&[(500, 70), (500, 75)])];
        assert!(ShareTest::new(&strata).p_value() < 1e-3, "{others}");
    }
    // All of a rare cell failed, which chance all but excludes.
    let test = ShareTest::new(&[cells(&[(100_000, 100), (400, 400)])]);
    assert_eq!(test, ShareTest { p_value: NEGLIGIBLE, exact: true });
}

/// With one share everywhere, p-values below a level are at most as frequent as the level; both ways of the test, and strata
/// of unlike shares.
#[test]
fn the_test_has_its_size() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for (sizes, failures) in [
        (vec![vec![50; 10]], vec![4]),
        (vec![vec![50; 10]], vec![59]),
        (vec![vec![90, 7, 3, 60, 200]], vec![20]),
        (vec![vec![50; 10]], vec![80]),
        (vec![vec![20; 5], vec![30, 10, 5, 60], vec![15; 4]], vec![3, 20, 25]),
    ] {
        let (mut at_five, mut at_one, repetitions) = (0.0, 0.0, 1000);
        for _ in 0..repetitions {
            let deal = |(sizes, failures): (&Vec<u64>, &usize)| -> Vec<Cell> {
                let runs = sizes.iter().sum::<u64>() as usize;
                let mut failed: Vec<bool> = (0..runs).map(|i| i < *failures).collect();
                failed.shuffle(&mut rng);
                let mut rest = failed.into_iter();
                let of = |size: &u64| {
                    let mut cell = Cell::default();
                    rest.by_ref().take(*size as usize).for_each(|failed| cell.add(failed));
                    cell
                };
                sizes.iter().map(of).collect()
            };
            let strata: Vec<_> = sizes.iter().zip(&failures).map(deal).collect();
            let p = ShareTest::new(&strata).p_value();
            at_five += f64::from(u8::from(p <= 0.05)) / f64::from(repetitions);
            at_one += f64::from(u8::from(p <= 0.01)) / f64::from(repetitions);
        }
        println!("{sizes:?} {failures:?}: {at_five:.4} {at_one:.4}");
        assert!(
            at_five < 0.05 + 4.0 * 0.0069 && at_one < 0.01 + 4.0 * 0.0032,
            "{at_five} {at_one}"
        );
    }
    // It finds what is there: 12 % in one tenth, 1 % elsewhere.
    let mut found = 0;
    for _ in 0..200 {
        let mut tenth = |share: f64| {
            let mut cell = Cell::default();
            (0..200).for_each(|_| cell.add(rng.random::<f64>() < share));
            cell
        };
        let tenths: Vec<_> = (0..10).map(|i| tenth(if i == 3 { 0.12 } else { 0.01 })).collect();
        found += u32::from(ShareTest::new(&[tenths]).p_value() < 0.001);
    }
    assert!(found > 190, "{found}");
}
