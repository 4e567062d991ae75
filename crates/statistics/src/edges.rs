//! Edges of histogram bins.

use crate::quantile::between;
use crate::{SortedSample, StatisticsError, error::MAX_BINS};

/// Increasing edges of contiguous bins `[e₀, e₁), [e₁, e₂), … [e_{k−1}, e_k]`: the last bin holds
/// its right edge too.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Vec<f64>", into = "Vec<f64>"))]
pub struct BinEdges(Vec<f64>);

impl BinEdges {
    /// The most bins that [`uniform`](Self::uniform) and
    /// [`freedman_diaconis`](Self::freedman_diaconis) make. One far outlier would otherwise ask
    /// for millions.
    pub const MAX_BINS: usize = MAX_BINS;

    /// The edges given.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Edge`] unless there are two edges or more, all finite and each above the
    /// one before.
    pub fn new(edges: Vec<f64>) -> Result<Self, StatisticsError> {
        let mut before = f64::NEG_INFINITY;
        for (index, &value) in edges.iter().enumerate() {
            if !value.is_finite() || value <= before {
                return Err(StatisticsError::Edge { index, value });
            }
            before = value;
        }
        if edges.len() < 2 {
            return Err(StatisticsError::Edge { index: edges.len(), value: f64::NAN });
        }
        Ok(Self(edges))
    }

    /// `bins` bins of equal width from `lower` to `upper`; fewer where the range has not that many
    /// floats in it.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Bins`] unless there are 1 to [`MAX_BINS`](Self::MAX_BINS) bins,
    /// [`StatisticsError::Bounds`] unless `lower < upper` and both are finite.
    pub fn uniform(lower: f64, upper: f64, bins: usize) -> Result<Self, StatisticsError> {
        if bins == 0 || bins > Self::MAX_BINS {
            return Err(StatisticsError::Bins { bins });
        }
        if lower.is_finite() && upper.is_finite() && lower < upper {
            Ok(Self::divide(lower, upper, bins))
        } else {
            Err(StatisticsError::Bounds { lower, upper })
        }
    }

    /// Bins of equal width from the smallest to the largest value of all samples, shared so that
    /// the samples can be drawn on the same axes.
    ///
    /// Each sample asks for the width of Freedman & Diaconis (1981, doi:10.1007/BF01025868),
    /// `2·IQR/n^(1/3)`, or, where half of it and more is one value, for that of Sturges (1926,
    /// doi:10.1080/01621459.1926.10502161), its range over `⌈log₂ n⌉ + 1`; a constant sample asks
    /// for none. The smallest width asked for is taken, narrowed to fit a whole number of bins,
    /// of which there are at most [`MAX_BINS`](Self::MAX_BINS). Several constant samples get
    /// Sturges' number for all values together. If all values are one `v`, the one bin is
    /// `v ± ½`, or as little wider as `f64` needs.
    ///
    /// Heavy tails run into the cap with most values in few bins: prefer
    /// [`uniform`](Self::uniform) between two [quantiles](SortedSample::quantile) then;
    /// [`Histogram`](crate::Histogram) counts what is outside.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] without a sample.
    pub fn freedman_diaconis(samples: &[&SortedSample]) -> Result<Self, StatisticsError> {
        if samples.is_empty() {
            return Err(StatisticsError::TooFew { n: 0, required: 1 });
        }
        let lower = samples.iter().map(|s| s.minimum()).fold(f64::INFINITY, f64::min);
        let upper = samples.iter().map(|s| s.maximum()).fold(f64::NEG_INFINITY, f64::max);
        if lower == upper {
            let margin = f64::max(0.5, 2.0 * f64::EPSILON * lower.abs());
            return Ok(Self(vec![(lower - margin).max(f64::MIN), (upper + margin).min(f64::MAX)]));
        }
        let width = samples.iter().filter_map(|s| half_width(s)).fold(f64::INFINITY, f64::min);
        let bins = if width.is_finite() {
            ((upper / 2.0 - lower / 2.0) / width).ceil()
        } else {
            sturges(samples.iter().map(|s| s.n()).sum())
        };
        // The cast saturates and sends NaN to 0.
        Ok(Self::divide(lower, upper, (bins as usize).clamp(1, Self::MAX_BINS)))
    }

    fn divide(lower: f64, upper: f64, bins: usize) -> Self {
        let mut edges: Vec<f64> =
            (0..bins).map(|i| between(lower, upper, i as f64 / bins as f64)).collect();
        edges.push(upper);
        edges.dedup();
        Self(edges)
    }

    /// The edges in increasing order, one more than there are bins.
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// Number of bins, at least one.
    pub fn bins(&self) -> usize {
        self.0.len() - 1
    }
}

/// Half the bin width the sample asks for, as a whole one may be beyond `f64`; none if constant.
fn half_width(sample: &SortedSample) -> Option<f64> {
    let half_range = sample.maximum() / 2.0 - sample.minimum() / 2.0;
    let half_iqr = sample.type_7(0.75) / 2.0 - sample.type_7(0.25) / 2.0;
    let width = if half_iqr > 0.0 {
        2.0 * half_iqr / (sample.n() as f64).cbrt()
    } else {
        half_range / sturges(sample.n())
    };
    (width > 0.0).then_some(width)
}

fn sturges(n: usize) -> f64 {
    (n as f64).log2().ceil() + 1.0
}

impl TryFrom<Vec<f64>> for BinEdges {
    type Error = StatisticsError;

    fn try_from(edges: Vec<f64>) -> Result<Self, StatisticsError> {
        Self::new(edges)
    }
}

impl From<BinEdges> for Vec<f64> {
    fn from(edges: BinEdges) -> Self {
        edges.0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn sorted(sample: &[f64]) -> SortedSample {
        SortedSample::new(sample).unwrap()
    }

    fn ranks(n: u32) -> SortedSample {
        sorted(&(1..=n).map(f64::from).collect::<Vec<_>>())
    }

    #[test]
    fn the_rule_of_freedman_and_diaconis() {
        // n = 1000: IQR 499.5, width 2·499.5/10 = 99.9, range 999: 10 bins.
        let edges = BinEdges::freedman_diaconis(&[&ranks(1000)]).unwrap();
        assert_eq!(edges.bins(), 10);
        assert_eq!((edges.values()[0], edges.values()[10]), (1.0, 1000.0));
    }

    #[test]
    fn shared_edges_take_the_pooled_range_and_the_smallest_width() {
        let wide = ranks(1000);
        // An eighth of the width: 1 to 1000 is then 80 bins.
        let narrow: Vec<f64> = (1..=1000).map(|i| 500.0 + f64::from(i) / 8.0).collect();
        let edges = BinEdges::freedman_diaconis(&[&wide, &sorted(&narrow)]).unwrap();
        assert_eq!((edges.values()[0], edges.bins()), (1.0, 80));
    }

    #[test]
    fn fall_backs() {
        // IQR 0: Sturges, ⌈log₂ 9⌉ + 1.
        let mut spike = vec![1.0; 8];
        spike.push(2.0);
        assert_eq!(BinEdges::freedman_diaconis(&[&sorted(&spike)]).unwrap().bins(), 5);
        // Two different constants: Sturges on both together.
        let (one, two) = (sorted(&[1.0; 4]), sorted(&[2.0; 4]));
        assert_eq!(BinEdges::freedman_diaconis(&[&one, &two]).unwrap().bins(), 4);
        // One constant: one bin around it.
        assert_eq!(BinEdges::freedman_diaconis(&[&one]).unwrap().values(), [0.5, 1.5]);
        // An outlier: the cap.
        let mut outlier = ranks(1000).values().to_vec();
        outlier.push(1e12);
        assert_eq!(BinEdges::freedman_diaconis(&[&sorted(&outlier)]).unwrap().bins(), 1000);
        assert!(BinEdges::freedman_diaconis(&[]).is_err());
    }

    #[test]
    fn unusable_edges_are_refused() {
        for edges in [
            vec![],
            vec![1.0],
            vec![1.0, 1.0],
            vec![2.0, 1.0],
            vec![f64::NAN, 1.0],
            vec![0.0, f64::INFINITY],
        ] {
            assert!(matches!(BinEdges::new(edges), Err(StatisticsError::Edge { .. })));
        }
        assert_eq!(BinEdges::uniform(0.0, 1.0, 0), Err(StatisticsError::Bins { bins: 0 }));
        assert!(BinEdges::uniform(0.0, 1.0, usize::MAX).is_err());
        for (lower, upper) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert!(matches!(
                BinEdges::uniform(lower, upper, 3),
                Err(StatisticsError::Bounds { .. })
            ));
        }
    }

    #[test]
    fn a_range_of_few_floats_has_few_bins() {
        let edges = BinEdges::uniform(1.0, 1.0f64.next_up().next_up(), 10).unwrap();
        assert_eq!(edges.bins(), 2);
    }

    proptest! {
        #[test]
        fn any_samples_get_valid_edges_over_their_range(
            a in prop::collection::vec(any::<f64>(), 1..20),
            b in prop::collection::vec(any::<f64>(), 1..20),
        ) {
            let (Ok(a), Ok(b)) = (SortedSample::new(&a), SortedSample::new(&b)) else {
                return Ok(());
            };
            let edges = BinEdges::freedman_diaconis(&[&a, &b]).unwrap();
            prop_assert_eq!(BinEdges::new(edges.values().to_vec()), Ok(edges.clone()));
            prop_assert!(edges.bins() <= BinEdges::MAX_BINS);
            prop_assert!(edges.values()[0] <= a.minimum().min(b.minimum()));
            prop_assert!(edges.values()[edges.bins()] >= a.maximum().max(b.maximum()));
        }

        #[test]
        fn uniform_edges_are_valid(a: f64, b: f64, bins in 1..=1000usize) {
            if let Ok(edges) = BinEdges::uniform(a, b, bins) {
                prop_assert_eq!(BinEdges::new(edges.values().to_vec()), Ok(edges.clone()));
                prop_assert_eq!((edges.values()[0], edges.values()[edges.bins()]), (a, b));
            }
        }
    }
}
