//! The first four moments of a sample.

use crate::centred::{Centred, Powers};
use crate::error::validate;
use crate::{ExactSum, StatisticsError};

/// Mean, standard deviation, skewness, kurtosis and range of a finite sample.
///
/// With `m_k = Σ(x − x̄)ᵏ/n`: the variance is `n/(n−1)·m₂`, the skewness `m₃/m₂^1.5`, the kurtosis
/// `m₄/m₂²` (3 for a normal law, not the excess). Skewness and kurtosis are the plain moment
/// ratios `g₁` and `b₂ = g₂ + 3` of Joanes & Gill (1998, doi:10.1111/1467-9884.00122): biased
/// towards 0 and 3 in small samples of heavy-tailed laws, and `b₂ ≤ n` whatever the law.
///
/// The mean is the [exact sum](crate::ExactSum) over `n`, rounded once. Powers of the deviations from it,
/// divided by the largest of them, are summed exactly too (a two-pass scheme in the sense of Chan, Golub &
/// LeVeque 1983, doi:10.1080/00031305.1983.10483115). Data of huge mean and small spread lose no digit that
/// they hold, no sum overflows or underflows whatever their unit, and the moments are the same bits in
/// whatever order the data come.
///
/// ```
/// use gyradius_statistics::Moments;
///
/// let moments = Moments::new(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0])?;
/// assert_eq!(moments.mean(), 5.0);
/// assert!((moments.variance() - 32.0 / 7.0).abs() < 1e-14);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct Moments {
    /// Number of values.
    n: usize,
    /// Arithmetic mean.
    mean: f64,
    /// Standard deviation with divisor `n − 1`: exactly 0 if, and short of underflow only if, all
    /// values are equal.
    standard_deviation: f64,
    /// Skewness `m₃/m₂^1.5`; none if all values are equal.
    skewness: Option<f64>,
    /// Kurtosis `m₄/m₂²`, 3 for a normal law; none if all values are equal.
    kurtosis: Option<f64>,
    /// Smallest value.
    minimum: f64,
    /// Largest value.
    maximum: f64,
}

crate::checked::checked!(Moments, |read| {
    crate::error::belong(read.n > 1 && read.is_in_range() && read.is_spread(), "sample")
});

impl Moments {
    /// The moments of a sample of two values or more.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] below two values, [`StatisticsError::NotFinite`] for a NaN or
    /// an infinity, [`StatisticsError::TooSpread`] for a standard deviation beyond `f64::MAX`.
    pub fn new(sample: &[f64]) -> Result<Self, StatisticsError> {
        validate(sample, 2)?;
        let (minimum, maximum) = sample
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
        let n = sample.len();
        if minimum == maximum {
            return Ok(Self::constant(n as u64, minimum));
        }
        let sum: ExactSum = sample.iter().copied().collect();
        let centred = Centred::new(&sum, n as u64, minimum, maximum);
        let mut powers = Powers::default();
        sample.iter().for_each(|x| powers.add(centred.map(*x)));
        Self::of_powers((n as u64, sum.mean(n as u64)), (minimum, maximum), &centred, &powers)
    }

    /// Of number and mean, range, and powers of deviations of values that are not all the same.
    pub(crate) fn of_powers(
        (n, mean): (u64, f64),
        (minimum, maximum): (f64, f64),
        centred: &Centred,
        powers: &Powers,
    ) -> Result<Self, StatisticsError> {
        let [s2, s3, s4] = powers.values();
        let standard_deviation = centred.standard_deviation(s2, n);
        if standard_deviation.is_infinite() {
            return Err(StatisticsError::TooSpread { minimum, maximum });
        }
        let count = n as f64;
        let m2 = s2 / count;
        Ok(Self {
            n: n as usize,
            mean,
            standard_deviation,
            skewness: Some(s3 / count / (m2 * m2.sqrt())),
            kurtosis: Some(s4 / count / (m2 * m2)),
            minimum,
            maximum,
        })
    }

    /// Of so many equal values.
    pub(crate) fn constant(n: u64, value: f64) -> Self {
        Self {
            n: n as usize,
            mean: value,
            // Rounding in the mean must not leave a spread behind.
            standard_deviation: 0.0,
            skewness: None,
            kurtosis: None,
            minimum: value,
            maximum: value,
        }
    }

    /// Whether mean and standard deviation can be those of finite values in the range.
    #[cfg(feature = "serde")]
    fn is_in_range(&self) -> bool {
        let range = self.maximum - self.minimum;
        self.minimum >= f64::MIN
            && self.maximum <= f64::MAX
            && (self.minimum..=self.maximum).contains(&self.mean)
            && (0.0..=range.min(f64::MAX)).contains(&self.standard_deviation)
    }

    /// Whether skewness and kurtosis are there if values differ, and can be those of so many: g² + 1 ≤ b ≤ n.
    #[cfg(feature = "serde")]
    fn is_spread(&self) -> bool {
        match (self.skewness, self.kurtosis) {
            (None, None) => self.minimum == self.maximum,
            (Some(g), Some(b)) => {
                self.minimum < self.maximum
                    && g * g + 1.0 <= b * (1.0 + 1e-9)
                    && b <= self.n as f64 * (1.0 + 1e-9)
            }
            (Some(_), None) | (None, Some(_)) => false,
        }
    }

    /// Variance with divisor `n − 1`: infinite or 0 where the square is beyond the range of `f64`.
    pub fn variance(&self) -> f64 {
        self.standard_deviation * self.standard_deviation
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn assert_close(value: f64, reference: f64, tolerance: f64) {
        assert!(
            (value - reference).abs() <= tolerance * reference.abs(),
            "{value:e} is not {reference:e}"
        );
    }

    #[test]
    fn agree_with_scipy() {
        let moments = Moments::new(&[15.8, 16.0, 16.2, 15.6, 16.4, 15.9, 16.1, 17.3]).unwrap();
        // NumPy 2.4.6 `mean`, `std(ddof=1)`; scipy 1.17.1 `skew`, `kurtosis(fisher=False)`.
        assert_close(moments.mean(), 16.1625, 1e-15);
        assert_close(moments.standard_deviation(), 0.5208166663999916, 1e-14);
        assert_close(moments.skewness().unwrap(), 1.3372850335239066, 1e-12);
        assert_close(moments.kurtosis().unwrap(), 3.994657532999813, 1e-12);
        assert_eq!((moments.minimum(), moments.maximum(), moments.n()), (15.6, 17.3, 8));
    }

    #[test]
    fn a_huge_mean_costs_no_digit() {
        // The spread of 0, 1, 2, …, 9, on a mean whose own square has no digit left for it.
        for mean in [0.0, 1e9, -1e15, 2f64.powi(49)] {
            let sample: Vec<f64> = (0..10).map(|i| mean + f64::from(i)).collect();
            let moments = Moments::new(&sample).unwrap();
            assert_close(moments.variance(), 55.0 / 6.0, 1e-14);
            assert!(moments.skewness().unwrap().abs() < 1e-14);
            assert_close(moments.kurtosis().unwrap(), 1.7757575757575759, 1e-14);
        }
    }

    #[test]
    fn neither_end_of_the_range_overflows_or_underflows() {
        for unit in [1e300, 1e-300, 5e-324, 1e307, 1.0] {
            let sample: Vec<f64> = (0..10).map(|i| f64::from(i) * unit).collect();
            let moments = Moments::new(&sample).unwrap();
            // Subnormal results are rounded to whole multiples of 5e-324.
            let tolerance = if unit < 1e-310 { 0.02 } else { 1e-14 };
            assert_close(moments.standard_deviation() / unit, (55.0f64 / 6.0).sqrt(), tolerance);
            assert_close(moments.kurtosis().unwrap(), 1.7757575757575759, 1e-14);
        }
        assert!(matches!(
            Moments::new(&[f64::MIN, f64::MAX]),
            Err(StatisticsError::TooSpread { .. })
        ));
    }

    #[test]
    fn unusable_samples_are_refused() {
        assert_eq!(Moments::new(&[]), Err(StatisticsError::TooFew { n: 0, required: 2 }));
        assert_eq!(Moments::new(&[1.0]), Err(StatisticsError::TooFew { n: 1, required: 2 }));
        assert!(matches!(
            Moments::new(&[1.0, 2.0, f64::NAN]),
            Err(StatisticsError::NotFinite { index: 2, value }) if value.is_nan()
        ));
        assert_eq!(
            Moments::new(&[f64::NEG_INFINITY, 2.0]),
            Err(StatisticsError::NotFinite { index: 0, value: f64::NEG_INFINITY })
        );
    }

    proptest! {
        #[test]
        fn constant_data_have_no_deviation(value in -1e300..1e300f64, n in 2..200usize) {
            let moments = Moments::new(&vec![value; n]).unwrap();
            prop_assert_eq!(moments.standard_deviation(), 0.0);
            prop_assert_eq!(moments.mean(), value);
            prop_assert_eq!(moments.kurtosis(), None);
        }

        #[test]
        fn any_sample_gives_sane_moments_or_an_error(
            sample in prop::collection::vec(any::<f64>(), 0..20),
        ) {
            if let Ok(moments) = Moments::new(&sample) {
                let n = sample.len() as f64;
                prop_assert!(moments.standard_deviation().is_finite());
                prop_assert!(moments.standard_deviation() >= 0.0);
                prop_assert!((moments.minimum()..=moments.maximum()).contains(&moments.mean()));
                if let (Some(g), Some(b)) = (moments.skewness(), moments.kurtosis()) {
                    // Pearson: g² + 1 ≤ b ≤ n.
                    prop_assert!(b >= 1.0 - 1e-12 && b <= n + 1e-9 && g * g + 1.0 <= b + 1e-9);
                }
            }
        }

        #[test]
        fn shift_and_scale_act_as_they_should(
            sample in prop::collection::vec(-10.0..10.0f64, 3..50),
            power in -200..200i32,
        ) {
            let before = Moments::new(&sample).unwrap();
            let factor = 2f64.powi(power);
            let scaled: Vec<f64> = sample.iter().map(|x| -x * factor).collect();
            let after = Moments::new(&scaled).unwrap();
            prop_assert_eq!(after.mean(), -before.mean() * factor);
            prop_assert_eq!(after.standard_deviation(), before.standard_deviation() * factor);
            prop_assert_eq!(after.skewness(), before.skewness().map(|g| -g));
            prop_assert_eq!(after.kurtosis(), before.kurtosis());
        }
    }
}
