//! Which pairs of inputs separate failed runs from the rest better than each input does alone.

use crate::rank_correlation::same_length;
use crate::share_test::{Cell, ShareTest};
use crate::{QuantileCells, StatisticsError};

/// How much better two inputs together separate failed runs from the others than the better of both alone.
///
/// Runs are counted in the cells of both inputs, say in fifths of each. The deviance of a table of cells is
/// `G = 2 Σ (k ln(k/e) + (n − k) ln((n − k)/(n − e)))` with k failures of n runs and e expected; the
/// [gain](Self::gain) is that of the table of pairs less the larger one of the inputs.
///
/// With few failures some gain is always found. The [p-value](Self::p_value) takes that into account: within each cell of
/// x, are the failures dealt to the cells of y at random, and within each cell of y to those of x? Each is a
/// [test](ShareTest) in strata, exact where failures are few, and the larger p-value counts, for a pair must add to x alone
/// and to y alone. Under that hypothesis a p-value below α has a probability of α at most. Rank pairs by it, and
/// adjust by [`holm`](crate::holm).
///
/// Two inputs that drive failures each for itself are a pair too: neither says what both say. Inputs should be independent of
/// each other. Of two that are correlated, one may add to the other only because cells
/// are wide.
///
/// ```
/// use gyradius_statistics::{PairSeparation, QuantileCells};
///
/// let x: Vec<f64> = (0..500).map(|i| f64::from(i * 7 % 500)).collect();
/// let y: Vec<f64> = (0..500).map(|i| f64::from(i * 61 % 499)).collect();
/// // Runs fail if both are high.
/// let failed: Vec<bool> = x.iter().zip(&y).map(|(x, y)| *x > 400.0 && *y > 400.0).collect();
/// let [of_x, of_y] = [QuantileCells::new(&x, 5)?, QuantileCells::new(&y, 5)?];
/// assert!(PairSeparation::new(&of_x, &of_y, &failed)?.p_value() < 1e-6);
/// // An input adds nothing to itself.
/// assert_eq!(PairSeparation::new(&of_x, &of_x, &failed)?.p_value(), 1.0);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct PairSeparation {
    /// The deviance of the pair less the larger deviance of the two: 0 or more.
    gain: f64,
    /// The probability of so much by chance, if one of the inputs added nothing to the other.
    p_value: f64,
}

crate::checked::checked!(PairSeparation, |read| crate::error::belong(
    read.gain >= 0.0 && (0.0..=1.0).contains(&read.p_value),
    "test"
));

impl PairSeparation {
    /// Of the cells of two inputs and whether each run failed: as many runs of each.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Columns`] for columns of unlike length.
    pub fn new(
        x: &QuantileCells,
        y: &QuantileCells,
        failed: &[bool],
    ) -> Result<Self, StatisticsError> {
        same_length(x.of_values().len(), y.of_values().len())?;
        same_length(x.of_values().len(), failed.len())?;
        let mut by_x = vec![vec![Cell::default(); y.cells()]; x.cells()];
        for ((x, y), failed) in x.of_values().iter().zip(y.of_values()).zip(failed) {
            by_x[usize::from(*x)][usize::from(*y)].add(*failed);
        }
        let by_y: Vec<Vec<Cell>> =
            (0..y.cells()).map(|y| by_x.iter().map(|row| row[y]).collect()).collect();
        let alone = |rows: &[Vec<Cell>]| deviance(rows.iter().map(Cell::sum));
        let better = alone(&by_x).max(alone(&by_y));
        let gain = (deviance(by_x.iter().flatten().copied()) - better).max(0.0);
        let p_value = ShareTest::new(&by_x).p_value().max(ShareTest::new(&by_y).p_value());
        Ok(Self { gain, p_value })
    }
}

/// The deviance of cells from one share.
fn deviance(cells: impl Iterator<Item = Cell> + Clone) -> f64 {
    let all = Cell::sum(cells.clone());
    let share = all.failures as f64 / all.runs as f64;
    2.0 * cells.map(|cell| log_likelihood_ratio(cell.runs, cell.failures, share)).sum::<f64>()
}

/// The logarithm of the likelihood of so many failures among runs by their own share over that by another: half the deviance of a
/// cell, 0 or more, and 0 where the shares are the same. No more failures than runs.
///
/// ```
/// let by_chance = gyradius_statistics::log_likelihood_ratio(100, 10, 0.01);
/// assert!(by_chance > gyradius_statistics::log_likelihood_ratio(4, 1, 0.01));
/// ```
pub fn log_likelihood_ratio(runs: u64, failures: u64, share: f64) -> f64 {
    let part = |found: u64, expected: f64| {
        if found == 0 { 0.0 } else { found as f64 * libm::log(found as f64 / expected) }
    };
    let expected = runs as f64 * share;
    part(failures, expected) + part(runs.saturating_sub(failures), runs as f64 - expected)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    const INPUTS: usize = 6;

    /// The p-values and gains of all pairs of six inputs.
    fn pairs(
        seed: u64,
        runs: usize,
        fails: fn(&[f64]) -> bool,
    ) -> Vec<((usize, usize), PairSeparation)> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let draws: Vec<Vec<f64>> =
            (0..runs).map(|_| (0..INPUTS).map(|_| rng.random()).collect()).collect();
        let failed: Vec<bool> = draws.iter().map(|x| fails(x)).collect();
        let cells = |i: usize| {
            QuantileCells::new(&draws.iter().map(|x| x[i]).collect::<Vec<_>>(), 5).unwrap()
        };
        let cells: Vec<_> = (0..INPUTS).map(cells).collect();
        let pairs = (0..INPUTS).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs
            .map(|(i, j)| ((i, j), PairSeparation::new(&cells[i], &cells[j], &failed).unwrap()))
            .collect()
    }

    /// The share of false findings is at most the level, for inputs that act alone or not at all, with few failures and
    /// with many.
    #[test]
    fn inputs_that_act_alone_are_no_pair() {
        for fails in [
            |x: &[f64]| x[0] > 0.97,
            |x: &[f64]| x[0] > 0.7,
            |x: &[f64]| x[0] > 0.8 && (x[0] * 1000.0).fract() > 0.5,
            |x: &[f64]| (x[3] * 1e6).fract() < 0.02,
        ] {
            let (mut false_ones, mut all) = (0, 0);
            for seed in 0..30 {
                for (_, pair) in pairs(seed, 400, fails) {
                    false_ones += u32::from(pair.p_value() <= 0.05);
                    all += 1;
                    assert!(pair.gain() >= 0.0);
                }
            }
            let share = f64::from(false_ones) / f64::from(all);
            println!("{share}");
            assert!(share < 0.07, "{share}");
        }
    }

    #[test]
    fn a_pair_that_acts_together_comes_first() {
        // Corners; a difference; one that no input shows alone. 25 to 300 failures.
        for fails in [
            |x: &[f64]| x[1] > 0.8 && x[4] > 0.8,
            |x: &[f64]| x[1] - x[4] > 0.7,
            |x: &[f64]| (x[1] - 0.5) * (x[4] - 0.5) > 0.15,
        ] {
            for seed in 0..10 {
                let mut pairs = pairs(seed, 1000, fails);
                let most = pairs.iter().max_by(|a, b| a.1.gain().total_cmp(&b.1.gain())).unwrap().0;
                pairs.sort_by(|a, b| a.1.p_value().total_cmp(&b.1.p_value()));
                assert_eq!((pairs[0].0, most), ((4, 1), (4, 1)), "{pairs:?}");
                assert!(pairs[0].1.p_value() < 1e-3, "{pairs:?}");
            }
        }
    }

    /// Three inputs that drive failures, two of them together and one for itself, make the three best pairs.
    #[test]
    fn inputs_that_drive_failures_each_for_itself_are_a_pair_too() {
        for seed in 0..10 {
            let mut pairs = pairs(seed, 1000, |x| x[1] > 0.85 && x[4] < 0.2 || x[0] > 0.97);
            pairs.sort_by(|a, b| a.1.p_value().total_cmp(&b.1.p_value()));
            let mut best: Vec<_> = pairs[..3].iter().map(|pair| pair.0).collect();
            best.sort_unstable();
            assert_eq!(best, [(1, 0), (4, 0), (4, 1)], "{pairs:?}");
        }
    }

    #[test]
    fn the_deviance_by_hand() {
        // Two inputs of two values, 4 runs in each cell, failures 4, 0, 0, 4: G is 16 · 2 ln 2, alone 0.
        let x: Vec<f64> = (0..16).map(|i| f64::from(i / 8)).collect();
        let y: Vec<f64> = (0..16).map(|i| f64::from(i / 4 % 2)).collect();
        let failed: Vec<bool> = x.iter().zip(&y).map(|(x, y)| x == y).collect();
        let [of_x, of_y] = [&x, &y].map(|column| QuantileCells::new(column, 2).unwrap());
        let pair = PairSeparation::new(&of_x, &of_y, &failed).unwrap();
        assert!((pair.gain() - 32.0 * 2_f64.ln()).abs() < 1e-12, "{pair:?}");
        // Each stratum: 2 of 8 choose 4, both the most extreme.
        assert!((pair.p_value() - (2.0_f64 / 70.0).powi(2)).abs() < 1e-12, "{pair:?}");
        let none = PairSeparation::new(&of_x, &of_y, &[false; 16]).unwrap();
        assert_eq!((none.gain(), none.p_value()), (0.0, 1.0));
        assert!(PairSeparation::new(&of_x, &of_y, &[false; 15]).is_err());
    }
}
