//! Counts per bin.

use crate::{BinEdges, SortedSample};

/// How many values of a sample fall into each bin, and how many outside all of them.
///
/// ```
/// use gyradius_statistics::{BinEdges, Histogram, SortedSample};
///
/// let before = SortedSample::new(&[1.0, 2.0, 2.5, 3.0, 5.0])?;
/// let after = SortedSample::new(&[1.5, 2.0, 2.0, 2.5, 3.0])?;
/// let edges = BinEdges::freedman_diaconis(&[&before, &after])?;
/// for sample in [before, after] {
///     let histogram = Histogram::new(&sample, &edges);
///     assert_eq!(histogram.counts().iter().sum::<u64>(), 5);
/// }
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Histogram {
    edges: BinEdges,
    counts: Vec<u64>,
    underflow: u64,
    overflow: u64,
}

impl Histogram {
    /// The counts of the sample between the edges.
    pub fn new(sample: &SortedSample, edges: &BinEdges) -> Self {
        let values = edges.values();
        let mut below: Vec<usize> = values.iter().map(|&edge| sample.count_below(edge)).collect();
        let last = values.len() - 1;
        below[last] = sample.count_to(values[last]);
        Self {
            edges: edges.clone(),
            counts: below.windows(2).map(|pair| (pair[1] - pair[0]) as u64).collect(),
            underflow: below[0] as u64,
            overflow: (sample.n() - below[last]) as u64,
        }
    }

    /// The edges of the bins.
    pub fn edges(&self) -> &BinEdges {
        &self.edges
    }

    /// Number of values in each bin.
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// Number of values below the first edge.
    pub fn underflow(&self) -> u64 {
        self.underflow
    }

    /// Number of values above the last edge.
    pub fn overflow(&self) -> u64 {
        self.overflow
    }

    /// Number of values in all, in bins and outside.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum::<u64>() + self.underflow + self.overflow
    }

    /// Density in each bin, `count/(total·width)`: its integral over the bins is the share of the
    /// sample that they hold.
    pub fn density(&self) -> Vec<f64> {
        let total = self.total() as f64;
        let widths = self.edges.values().windows(2).map(|pair| pair[1] - pair[0]);
        self.counts.iter().zip(widths).map(|(&count, width)| count as f64 / total / width).collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn edges_belong_to_the_bin_on_their_right_and_the_last_to_the_last() {
        let sample = SortedSample::new(&[-1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5]).unwrap();
        let edges = BinEdges::new(vec![0.0, 1.0, 2.0]).unwrap();
        let histogram = Histogram::new(&sample, &edges);
        assert_eq!(histogram.counts(), [2, 3]);
        assert_eq!((histogram.underflow(), histogram.overflow(), histogram.total()), (1, 1, 7));
        assert_eq!(histogram.density(), [2.0 / 7.0, 3.0 / 7.0]);
    }

    proptest! {
        #[test]
        fn every_value_is_in_exactly_one_bin(
            sample in prop::collection::vec(any::<f64>(), 1..100),
        ) {
            let Ok(sorted) = SortedSample::new(&sample) else { return Ok(()) };
            let edges = BinEdges::freedman_diaconis(&[&sorted]).unwrap();
            let histogram = Histogram::new(&sorted, &edges);
            let values = edges.values();
            let last = values.len() - 2;
            for (bin, pair) in values.windows(2).enumerate() {
                let inside = |x: f64| {
                    pair[0] <= x && (x < pair[1] || (bin == last && x == pair[1]))
                };
                let count = sample.iter().filter(|&&x| inside(x)).count();
                prop_assert_eq!(histogram.counts()[bin], count as u64);
            }
            prop_assert_eq!(histogram.total(), sample.len() as u64);
            prop_assert_eq!((histogram.underflow(), histogram.overflow()), (0, 0));
        }

        #[test]
        fn the_density_integrates_to_the_share_inside(
            sample in prop::collection::vec(-10.0..10.0f64, 1..100),
            bins in 1..30usize,
        ) {
            let sorted = SortedSample::new(&sample).unwrap();
            let edges = BinEdges::uniform(-3.0, 5.0, bins).unwrap();
            let histogram = Histogram::new(&sorted, &edges);
            let width = 8.0 / bins as f64;
            let integral: f64 = histogram.density().iter().map(|d| d * width).sum();
            let outside = histogram.underflow() + histogram.overflow();
            let share = 1.0 - outside as f64 / sample.len() as f64;
            prop_assert!((integral - share).abs() < 1e-12);
        }
    }
}
