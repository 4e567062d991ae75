//! Cells of a sample between quantiles of its own.

use crate::StatisticsError;
use crate::error::{MAX_BINS, validate};
use crate::selection::key;

/// In which k-th part of a sample each value stands: the first tenth of the values, the second…
///
/// By ranks, so that any law gives cells of the same size to one value. Equal values stay together, in the cell of the
/// middle of their ranks: a discrete input has fewer cells, some of them larger.
///
/// ```
/// use gyradius_statistics::QuantileCells;
///
/// let cells = QuantileCells::new(&[5.0, 1.0, 2.0, 2.0, 2.0, 9.0], 3)?;
/// assert_eq!(cells.of_values(), [2, 0, 1, 1, 1, 2]);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub struct QuantileCells {
    /// Number of cells, those without a value too.
    #[getset(get_copy = "pub")]
    cells: usize,
    of_values: Vec<u16>,
}

crate::checked::checked!(QuantileCells, |read| {
    crate::error::belong(
        (1..=MAX_BINS).contains(&read.cells)
            && !read.of_values.is_empty()
            && read.of_values.iter().all(|cell| usize::from(*cell) < read.cells),
        "sample",
    )
});

impl QuantileCells {
    /// So many cells of a sample.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Bins`] unless there are 1 to 1000 cells, [`StatisticsError::TooFew`] for an empty sample,
    /// [`StatisticsError::NotFinite`] for a NaN or an infinity.
    pub fn new(sample: &[f64], cells: usize) -> Result<Self, StatisticsError> {
        if !(1..=MAX_BINS).contains(&cells) {
            return Err(StatisticsError::Bins { bins: cells });
        }
        validate(sample, 1)?;
        let (count, n) = (cells as u128, sample.len() as u128);
        let mut of_values = vec![0; sample.len()];
        for_ties(sample, |tie, before| {
            // The middle of the ranks, from 0.5 on, over n.
            let middle = (2 * before + tie.len()) as u128;
            let cell = (count * middle / (2 * n)) as u16;
            tie.iter().for_each(|&(_, i)| of_values[i] = cell);
        });
        Ok(Self { cells, of_values })
    }

    /// The cell of each value, from 0.
    pub fn of_values(&self) -> &[u16] {
        &self.of_values
    }
}

/// The ranks of a finite sample, from 1; equal values have the mean of theirs.
pub(crate) fn average_ranks(sample: &[f64]) -> Vec<f64> {
    let mut ranks = vec![0.0; sample.len()];
    for_ties(sample, |tie, before| {
        let rank = before as f64 + (tie.len() as f64 + 1.0) / 2.0;
        tie.iter().for_each(|&(_, i)| ranks[i] = rank);
    });
    ranks
}

/// The sets of equal values, in increasing order, each as its values and their positions, with the number of values below.
///
/// Sorted are the values themselves, as whole numbers in their order, with their positions beside them: to sort positions by the
/// values that they point to takes several times as long, for each comparison then reads two places of the memory.
fn for_ties(sample: &[f64], mut tell: impl FnMut(&[(i64, usize)], usize)) {
    // Minus zero becomes zero, which it equals.
    let mut sorted: Vec<(i64, usize)> = sample.iter().map(|x| key(x + 0.0)).zip(0..).collect();
    sorted.sort_unstable_by_key(|(value, _)| *value);
    let mut before = 0;
    for tie in sorted.chunk_by(|(a, _), (b, _)| a == b) {
        tell(tie, before);
        before += tie.len();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_makes_no_cells_is_refused() {
        for bins in [0, 1001, usize::MAX] {
            assert_eq!(QuantileCells::new(&[1.0], bins), Err(StatisticsError::Bins { bins }));
        }
        assert!(QuantileCells::new(&[], 2).is_err() && QuantileCells::new(&[f64::NAN], 2).is_err());
    }

    proptest! {
        /// Against counts: equal values together, larger ones in no lower cell, each cell as large as it can be.
        #[test]
        fn cells_keep_order_and_size(
            sample in prop::collection::vec((-6..6_i32).prop_map(f64::from), 1..60), cells in 1..12_usize,
        ) {
            let parts = QuantileCells::new(&sample, cells).unwrap();
            let n = sample.len() as f64;
            for (x, cell) in sample.iter().zip(parts.of_values()) {
                let below = sample.iter().filter(|y| *y < x).count() as f64;
                let equal = sample.iter().filter(|y| *y == x).count() as f64;
                let rank = average_ranks(&sample)[sample.iter().position(|y| y == x).unwrap()];
                prop_assert_eq!(rank, below + (equal + 1.0) / 2.0);
                let share = (below + equal / 2.0) / n * cells as f64;
                prop_assert!(f64::from(*cell) <= share + 1e-9 && share < f64::from(*cell) + 1.0 + 1e-9);
            }
        }

        /// Finite values of any size, both zeros among them, some of them again.
        #[test]
        fn ranks_are_those_of_counting(
            sample in prop::collection::vec(
                prop_oneof![any::<f64>().prop_filter("finite", |x| x.is_finite()), prop::sample::select(vec![
                    0.0, -0.0, f64::MIN, f64::MAX, 5e-324, -5e-324, 1.0, -1.0,
                ])],
                1..40,
            ),
        ) {
            for (x, rank) in sample.iter().zip(average_ranks(&sample)) {
                let below = sample.iter().filter(|y| *y < x).count() as f64;
                let equal = sample.iter().filter(|y| *y == x).count() as f64;
                prop_assert_eq!(rank, below + (equal + 1.0) / 2.0);
            }
        }

        #[test]
        fn without_ties_cells_differ_by_one_value(n in 1..500_usize, cells in 1..20_usize) {
            // 7 has no common factor with 1009.
            let sample: Vec<f64> = (0..n).map(|i| (i * 7 % 1009) as f64).collect();
            let mut sizes = vec![0; cells];
            QuantileCells::new(&sample, cells).unwrap().of_values().iter().for_each(|&c| sizes[usize::from(c)] += 1);
            prop_assert!(sizes.iter().max().unwrap() - sizes.iter().min().unwrap() <= 1, "{:?}", sizes);
        }
    }
}
