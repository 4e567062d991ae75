//! Whether an output rises or falls with an input: ranks and their correlation.

use crate::error::validate;
use crate::quantile_cells::average_ranks;
use crate::{Confidence, Estimate, Interval, StatisticsError, law};

/// The rank correlation of Spearman (1904, doi:10.2307/1412159): from −1, where y falls whenever x rises, to 1.
///
/// The correlation of the ranks, of which equal values share the mean. It depends on the order of the values alone and not on
/// their units or the form of the relation, but sees only what rises or falls throughout: for y = x² about zero it is 0.
///
/// ```
/// use gyradius_statistics::{Confidence, RankCorrelation};
///
/// let x: Vec<f64> = (0..50).map(f64::from).collect();
/// let y: Vec<f64> = x.iter().map(|x| (x / 5.0).exp()).collect();
/// assert_eq!(RankCorrelation::new(&x, &y)?.value(), 1.0);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct RankCorrelation {
    /// Number of pairs.
    n: usize,
    /// The correlation.
    value: f64,
}

crate::checked::checked!(RankCorrelation, |read| crate::error::belong(
    read.n >= 4 && read.value.abs() <= 1.0,
    "correlation"
));

impl RankCorrelation {
    /// Of the pairs of two columns.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Columns`] for columns of unlike length, [`StatisticsError::TooFew`] below four pairs,
    /// [`StatisticsError::NotFinite`] for a NaN or an infinity, [`StatisticsError::Constant`] if all values of a column are the
    /// same.
    pub fn new(x: &[f64], y: &[f64]) -> Result<Self, StatisticsError> {
        same_length(x.len(), y.len())?;
        validate(x, 4)?;
        validate(y, 4)?;
        Self::of_ranks(&Ranks(average_ranks(x)), &Ranks(average_ranks(y)))
    }

    /// Of two columns of which the ranks are known, as of an output that is held against many inputs.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Columns`] for columns of unlike length, [`StatisticsError::TooFew`] below four pairs,
    /// [`StatisticsError::Constant`] if all values of a column are the same.
    pub fn of_ranks(x: &Ranks, y: &Ranks) -> Result<Self, StatisticsError> {
        let n = x.0.len();
        same_length(n, y.0.len())?;
        if n < 4 {
            return Err(StatisticsError::TooFew { n, required: 4 });
        }
        let squares = x.product(x) * y.product(y);
        if squares == 0.0 {
            return Err(StatisticsError::Constant);
        }
        let value = x.product(y) / squares.sqrt();
        Ok(Self { n, value: value.clamp(-1.0, 1.0) })
    }

    /// With the interval of Bonett & Wright (2000, doi:10.1007/BF02294183),
    /// `tanh(artanh(r) ± z √((1 + r²/2)/(n − 3)))`.
    ///
    /// Coverage is close to the level for bivariate normal laws, and for others that any rising functions make
    /// of such, up to |r| of 0.9; beyond it falls short. For −1 and 1 it has no width. For independent columns it is close
    /// whatever their laws.
    pub fn estimate(&self, confidence: Confidence) -> Estimate {
        let spread = ((1.0 + self.value * self.value / 2.0) / (self.n as f64 - 3.0)).sqrt();
        let (centre, half) = (libm::atanh(self.value), law::normal(confidence.tail()) * spread);
        let bound = |half: f64| libm::tanh(centre + half);
        let (lower, upper) = (bound(-half).min(self.value), bound(half).max(self.value));
        Estimate::new(self.value, Interval::ordered(lower, upper, confidence))
    }
}

/// The ranks of a sample of finite values, of which equal ones share the mean of theirs.
///
/// ```
/// use gyradius_statistics::{RankCorrelation, Ranks};
///
/// let output = Ranks::new(&[0.1, 0.4, 0.9, 1.6])?;
/// let inputs = [[1.0, 2.0, 3.0, 4.0], [7.0, 5.0, 3.0, 2.0]];
/// let rises = inputs.map(|input| RankCorrelation::of_ranks(&Ranks::new(&input)?, &output));
/// assert_eq!(rises.map(|r| r.map(|r| r.value())), [Ok(1.0), Ok(-1.0)]);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Ranks(Vec<f64>);

impl Ranks {
    /// The ranks of a sample.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] for an empty sample, [`StatisticsError::NotFinite`] for a NaN or an infinity.
    pub fn new(sample: &[f64]) -> Result<Self, StatisticsError> {
        validate(sample, 1)?;
        Ok(Self(average_ranks(sample)))
    }

    /// The sum of the products of the ranks, each about the mean rank; ranks and mean are whole multiples of one half.
    fn product(&self, other: &Self) -> f64 {
        let middle = (self.0.len() as f64 + 1.0) / 2.0;
        self.0.iter().zip(&other.0).map(|(a, b)| (a - middle) * (b - middle)).sum()
    }
}

/// Refuses columns of unlike length.
pub(crate) fn same_length(first: usize, second: usize) -> Result<(), StatisticsError> {
    if first == second { Ok(()) } else { Err(StatisticsError::Columns { first, second }) }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn by_hand() {
        // Without ties 1 − 6 Σd²/(n(n² − 1)): Σd² = 1 + 1 + 4 + 1 + 1.
        let r =
            RankCorrelation::new(&[1.0, 2.0, 3.0, 4.0, 5.0], &[2.0, 1.0, 5.0, 3.0, 4.0]).unwrap();
        assert!((r.value() - (1.0 - 6.0 * 8.0 / 120.0)).abs() < 1e-15);
        // Ranks 1.5, 1.5, 3, 4 and 1, 2, 3.5, 3.5: 4 of √(4.5²).
        let r = RankCorrelation::new(&[7.0, 7.0, 8.0, 9.0], &[0.0, 1.0, 5.0, 5.0]).unwrap();
        assert!((r.value() - 4.0 / 4.5).abs() < 1e-15, "{r:?}");
        // n = 103, r = 0.6: artanh 0.6 = ln 2, and 1.959964 √(1.18/100).
        let interval =
            RankCorrelation { n: 103, value: 0.6 }.estimate(Confidence::default()).interval();
        let half = 1.959963984540054 * 0.0118_f64.sqrt();
        let bound = |z: f64| ((2.0 * z).exp() - 1.0) / ((2.0 * z).exp() + 1.0);
        assert!((interval.lower() - bound(2_f64.ln() - half)).abs() < 1e-14);
        assert!((interval.upper() - bound(2_f64.ln() + half)).abs() < 1e-14);
    }

    #[test]
    fn columns_without_a_correlation_are_refused() {
        let x = [1.0, 2.0, 3.0, 4.0];
        let refused = StatisticsError::Columns { first: 4, second: 3 };
        assert_eq!(RankCorrelation::new(&x, &x[..3]), Err(refused));
        assert_eq!(RankCorrelation::new(&x, &[5.0; 4]), Err(StatisticsError::Constant));
        let refused = Err(StatisticsError::TooFew { n: 3, required: 4 });
        assert_eq!(RankCorrelation::new(&x[..3], &x[..3]), refused);
        let [three, four] = [3, 4].map(|n| Ranks::new(&x[..n]).unwrap());
        assert_eq!(RankCorrelation::of_ranks(&three, &three), refused);
        let refused = Err(StatisticsError::Columns { first: 4, second: 3 });
        assert_eq!(RankCorrelation::of_ranks(&four, &three), refused);
        assert!(Ranks::new(&[]).is_err());
        let bad = [1.0, 2.0, f64::INFINITY, 4.0];
        assert_eq!(Ranks::new(&bad).err(), RankCorrelation::new(&bad, &x).err());
        assert!(matches!(
            RankCorrelation::new(&x, &bad),
            Err(StatisticsError::NotFinite { index: 2, .. })
        ));
    }

    proptest! {
        #[test]
        fn it_depends_on_the_order_alone(
            pairs in prop::collection::vec((-9..9_i32, -1e3..1e3_f64), 4..40),
        ) {
            let (x, y): (Vec<f64>, Vec<f64>) = pairs.into_iter().map(|(x, y)| (f64::from(x), y)).unzip();
            let Ok(r) = RankCorrelation::new(&x, &y) else { return Ok(()) };
            let cubes: Vec<f64> = x.iter().map(|x| x * x * x).collect();
            let turned: Vec<f64> = y.iter().map(|y| -(y / 500.0).exp()).collect();
            let of = |x: &[f64], y: &[f64]| RankCorrelation::new(x, y).unwrap().value();
            prop_assert_eq!(of(&cubes, &y), r.value());
            prop_assert_eq!(of(&y, &x), r.value());
            prop_assert_eq!(of(&x, &turned), -r.value());
            prop_assert!(r.estimate(Confidence::default()).interval().contains(r.value()));
        }
    }
}
