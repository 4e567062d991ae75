//! Counts per bin.

use crate::{BinEdges, SortedSample, StatisticsError};

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
#[derive(Debug, Clone, PartialEq, getset::CopyGetters, getset::Getters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub struct Histogram {
    /// The edges of the bins.
    #[getset(get = "pub")]
    edges: BinEdges,
    counts: Vec<u64>,
    /// Number of values below the first edge.
    #[getset(get_copy = "pub")]
    underflow: u64,
    /// Number of values above the last edge.
    #[getset(get_copy = "pub")]
    overflow: u64,
}

crate::checked::checked!(Histogram, |read| {
    let outside = read.underflow.checked_add(read.overflow);
    let total = read.counts.iter().fold(outside, |sum, count| sum?.checked_add(*count));
    let counted = total.is_some_and(|total| total > 0);
    crate::error::belong(counted && read.counts.len() == read.edges.bins(), "histogram")
});

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

    /// Number of values in each bin.
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// Number of values in all, in bins and outside.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum::<u64>() + self.underflow + self.overflow
    }

    /// Density in each bin, `count/(total·width)`: its integral over the bins is the share of the
    /// sample that they hold.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Density`] if a bin is so narrow that its density is beyond `f64::MAX`.
    pub fn density(&self) -> Result<Vec<f64>, StatisticsError> {
        let total = self.total() as f64;
        let bins = self.edges.values().windows(2).zip(&self.counts);
        bins.enumerate()
            .map(|(bin, (pair, &count))| {
                let (share, width) = (count as f64 / total, pair[1] - pair[0]);
                let density = if width.is_finite() {
                    share / width
                } else {
                    0.5 * share / (0.5 * pair[1] - 0.5 * pair[0])
                };
                if density.is_infinite() {
                    return Err(StatisticsError::Density { bin, width });
                }
                Ok(density)
            })
            .collect()
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
        assert_eq!(histogram.density().unwrap(), [2.0 / 7.0, 3.0 / 7.0]);
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

        /// Of widths from the smallest number to the whole range: what each bin holds is its share,
        /// and no density is infinite.
        #[test]
        fn densities_hold_over_the_range_of_floats(
            exponents in prop::collection::vec(-1075..1024i32, 2..6),
            signs in prop::collection::vec(any::<bool>(), 6),
            per_bin in 1..40usize,
        ) {
            let magnitude = |exponent: i32| 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
            let signed = |(&e, &plus): (&i32, &bool)| if plus { magnitude(e) } else { -magnitude(e) };
            let mut edges: Vec<f64> = exponents.iter().zip(&signs).map(signed).collect();
            edges.sort_by(f64::total_cmp);
            edges.dedup();
            let Ok(bins) = BinEdges::new(edges.clone()) else { return Ok(()) };
            let sample: Vec<f64> = edges[..edges.len() - 1].repeat(per_bin);
            let histogram = Histogram::new(&SortedSample::new(&sample).unwrap(), &bins);
            let share = 1.0 / bins.bins() as f64;
            // Halves of numbers scaled to be normal are exact.
            let half = |pair: &[f64]| {
                let scale = if pair[0].abs().max(pair[1].abs()) < 1.0 { 2f64.powi(600) } else { 1.0 };
                (0.5 * scale * pair[1] - 0.5 * scale * pair[0], scale)
            };
            match histogram.density() {
                Ok(density) => for (d, pair) in density.iter().zip(edges.windows(2)) {
                    let (half, scale) = half(pair);
                    // A density below 2⁻¹⁰²² has fewer digits.
                    prop_assert!(
                        (2.0 * d * half / scale / share - 1.0).abs() < 1e-14,
                        "{} {:?}", d, pair,
                    );
                },
                Err(StatisticsError::Density { bin, width }) => {
                    prop_assert_eq!(width, edges[bin + 1] - edges[bin]);
                    prop_assert!(share / f64::MAX >= width, "{}", width);
                }
                Err(error) => return Err(TestCaseError::fail(error.to_string())),
            }
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
            let integral: f64 = histogram.density().unwrap().iter().map(|d| d * width).sum();
            let outside = histogram.underflow() + histogram.overflow();
            let share = 1.0 - outside as f64 / sample.len() as f64;
            prop_assert!((integral - share).abs() < 1e-12);
        }
    }
}
