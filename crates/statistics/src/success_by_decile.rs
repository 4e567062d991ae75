//! Where along an input runs fail: the share of failures in each tenth of its values.

use crate::rank_correlation::same_length;
use crate::share_test::{Cell, ShareTest};
use crate::{Confidence, Interval, Proportion, QuantileCells, StatisticsError};

/// The failed runs in each tenth of the runs by an input, and whether they depend on the tenth at all.
///
/// Tenths are of the order of the input's values; [equal values stay together](QuantileCells). A tenth without a value, which
/// a discrete input leaves, is left out.
///
/// ```
/// use gyradius_statistics::{Confidence, SuccessByDecile};
///
/// let stiffness: Vec<f64> = (0..200).map(|i| f64::from(i * 37 % 200)).collect();
/// let failed: Vec<bool> = stiffness.iter().map(|x| *x >= 195.0).collect();
/// let shares = SuccessByDecile::new(&stiffness, &failed, Confidence::default())?;
/// let last = shares.tenths().last().unwrap();
/// assert_eq!((last.least(), last.greatest(), last.runs(), last.failures()), (180.0, 199.0, 20, 5));
/// // Five of five in one tenth: far too many for chance.
/// assert!(shares.test().exact() && shares.test().p_value() < 1e-4);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Clone, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub struct SuccessByDecile {
    tenths: Vec<Tenth>,
    /// Whether the share of failures differs between tenths at all. With many inputs, adjust the p-values by
    /// [`holm`](crate::holm).
    #[getset(get_copy = "pub")]
    test: ShareTest,
}

crate::checked::checked!(SuccessByDecile, |read| {
    let rising = read.tenths.is_sorted_by(|one, next| one.greatest < next.least);
    crate::error::belong((1..=10).contains(&read.tenths.len()) && rising, "table of tenths")
});

impl SuccessByDecile {
    /// Of the values of an input and whether the run failed, with an interval of this confidence for each tenth.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Columns`] for columns of unlike length, [`StatisticsError::TooFew`] without a run,
    /// [`StatisticsError::NotFinite`] for a NaN or an infinity, [`StatisticsError::Proportion`] for more than 10⁹ runs in a
    /// tenth.
    pub fn new(
        input: &[f64],
        failed: &[bool],
        confidence: Confidence,
    ) -> Result<Self, StatisticsError> {
        same_length(input.len(), failed.len())?;
        let parts = QuantileCells::new(input, 10)?;
        let mut cells = [Cell::default(); 10];
        let mut ranges = [(f64::INFINITY, f64::NEG_INFINITY); 10];
        for ((cell, failed), x) in parts.of_values().iter().zip(failed).zip(input) {
            let cell = usize::from(*cell);
            cells[cell].add(*failed);
            ranges[cell] = (ranges[cell].0.min(*x), ranges[cell].1.max(*x));
        }
        let filled = cells.into_iter().zip(ranges).filter(|(cell, _)| cell.runs > 0);
        let tenth = |(cell, (least, greatest)): (Cell, (f64, f64))| {
            let interval = Proportion::new(cell.failures, cell.runs)?.interval(confidence);
            Ok(Tenth { least, greatest, runs: cell.runs, failures: cell.failures, interval })
        };
        let tenths = filled.map(tenth).collect::<Result<_, StatisticsError>>()?;
        Ok(Self { tenths, test: ShareTest::new(&[cells.to_vec()]) })
    }

    /// The tenths that have runs, by increasing values.
    pub fn tenths(&self) -> &[Tenth] {
        &self.tenths
    }
}

/// Runs whose input stands in one tenth of its values.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct Tenth {
    /// The least value of the input.
    least: f64,
    /// The greatest value of the input.
    greatest: f64,
    /// Number of runs.
    runs: u64,
    /// Number of runs that failed.
    failures: u64,
    /// The share of failures, with the [interval of Clopper and Pearson](Proportion::interval).
    interval: Interval,
}

crate::checked::checked!(Tenth, |read| crate::error::belong(
    read.least <= read.greatest
        && read.runs > 0
        && read.failures <= read.runs
        && read.interval.contains(read.failures as f64 / read.runs as f64),
    "tenth"
));

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn every_run_is_counted_once_and_equal_values_together(
            runs in prop::collection::vec((-8..8_i32, any::<bool>()), 1..100),
        ) {
            let (input, failed): (Vec<f64>, Vec<bool>) = runs.into_iter().map(|(x, f)| (f64::from(x), f)).unzip();
            let shares = SuccessByDecile::new(&input, &failed, Confidence::default()).unwrap();
            let mut counted = 0;
            for tenth in shares.tenths() {
                let inside = |x: f64| x >= tenth.least() && x <= tenth.greatest();
                let own: Vec<bool> = input.iter().zip(&failed).filter(|(x, _)| inside(**x)).map(|(_, f)| *f).collect();
                prop_assert_eq!(own.len() as u64, tenth.runs());
                prop_assert_eq!(own.iter().filter(|f| **f).count() as u64, tenth.failures());
                prop_assert!(tenth.interval().contains(tenth.failures() as f64 / tenth.runs() as f64));
                counted += own.len();
            }
            prop_assert_eq!(counted, input.len());
            prop_assert!(shares.tenths().is_sorted_by(|a, b| a.greatest() < b.least()));
        }
    }

    #[test]
    fn columns_of_unlike_length_are_refused() {
        let refused = StatisticsError::Columns { first: 1, second: 2 };
        assert_eq!(SuccessByDecile::new(&[1.0], &[true; 2], Confidence::default()), Err(refused));
        assert!(SuccessByDecile::new(&[], &[], Confidence::default()).is_err());
    }
}
