//! Intervals for a standard deviation.

use crate::centred::{Centred, Powers, UnitSum};
use crate::{Confidence, ExactSum, Interval, Moments, SortedSample, StatisticsError, law};

impl Moments {
    /// Normal-theory interval for the standard deviation, `s·√((n−1)/χ²)` with the two quantiles
    /// of χ² at `n − 1` degrees of freedom.
    ///
    /// Exact for independent draws of a normal law and **only** there: the variance of `s²` grows
    /// with the kurtosis κ, so that the coverage tends to `2Φ(z·√(2/(κ−1))) − 1` as `n` grows, not
    /// to the nominal level. At 95 % that is 0.78 for a Laplace law (κ = 6), 0.67 for an
    /// exponential (κ = 9) and above 0.99 for a uniform (κ = 1.8). See
    /// [`Deviation::interval`] for data of unknown law.
    pub fn normal_deviation_interval(&self, confidence: Confidence) -> Interval {
        let (freedom, s) = (self.n() as f64 - 1.0, self.standard_deviation());
        let bound = |chi_squared: f64| s * (freedom / chi_squared).sqrt();
        Interval::ordered(
            bound(law::chi_squared_upper(confidence.tail(), freedom)),
            bound(law::chi_squared_lower(confidence.tail(), freedom)),
            confidence,
        )
    }
}

/// A standard deviation with what its distribution-robust intervals need.
///
/// The intervals of Bonett rest on the delta method: `Var(ln s²) ≈ (κ − (n−3)/n)/(n−1)` for any
/// law of kurtosis κ, with κ estimated about a trimmed mean,
/// `κ̂ = n·Σ(x − m)⁴/(Σ(x − x̄)²)²`, `m` the mean without `⌊n/(2√(n−4))⌋` values at either end.
/// That estimate is less biased for skewed laws than the plain `m₄/m₂²`.
///
/// # Limits
///
/// The draws are independent, and **the sample shows the kurtosis of its law**. A finite kurtosis
/// is not enough: where rare values make most of it, samples without them look lighter-tailed than
/// the law is, and intervals are too short until thousands of draws hold enough of them. Coverage at
/// a nominal 95 % by simulation (`tests/coverage.rs` repeats the starred ones):
///
/// | law | κ | n = 10 | n = 50 | n = 1000* | n = 10,000 |
/// | --- | --- | --- | --- | --- | --- |
/// | uniform | 1.8 | 0.97 | 0.95 | 0.95 | 0.95 |
/// | normal | 3 | 0.96 | 0.94 | 0.95 | 0.95 |
/// | Laplace | 6 | 0.92 | 0.92 | 0.95 | 0.95 |
/// | exponential | 9 | 0.89 | 0.90 | 0.94 | 0.96 |
/// | Student's t, 5 degrees | 9 | 0.94 | 0.91 | 0.93 | 0.95 |
/// | lognormal, σ of the logarithm 0.5 | 8.9 | 0.91 | 0.89 | 0.94 | 0.94 |
/// | lognormal, σ of the logarithm 1 | 114 | 0.73 | 0.74 | 0.85 | 0.92 |
/// | Student's t, 3 degrees | none | 0.86 | 0.77 | 0.79 | |
///
/// Where the kurtosis is infinite, as in the last row, `s²` converges slower than `1/√n` and `κ̂`
/// grows with `n` without a limit: intervals keep being computed and no sample size makes them
/// honest. The bootstrap-t interval of `ln s` does no better where this one fails: 0.78, 0.80
/// and 0.87 for the lognormal law with σ = 1, and 0.81 instead of 0.89 for ten exponential draws.
/// A [kurtosis](Self::kurtosis) above 10 is the sign. Summarise such data by
/// [quantiles](SortedSample::quantile_interval), whose intervals hold for any law, or take the
/// deviation of the logarithms.
///
/// ```
/// use gyradius_statistics::{Confidence, Deviation};
///
/// let deviation = Deviation::new(&[15.8, 16.0, 16.2, 15.6, 16.4, 15.9, 16.1, 17.3])?;
/// let interval = deviation.interval(Confidence::default())?;
/// assert!(interval.contains(deviation.standard_deviation()));
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct Deviation {
    /// Number of values.
    n: usize,
    /// Standard deviation with divisor `n − 1`.
    standard_deviation: f64,
    /// The estimate κ̂ of the kurtosis about the trimmed mean; 3 for a normal law.
    kurtosis: f64,
}

crate::checked::checked!(Deviation, |read| {
    crate::error::belong(
        read.n >= FEWEST
            && read.standard_deviation > 0.0
            && (1.0 - 1e-9..=f64::MAX).contains(&read.kurtosis)
            && read.log_variance(read.kurtosis) > 0.0,
        "sample",
    )
});

impl Deviation {
    /// The deviation of a sample of five values or more that are not all equal.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] below five values, [`StatisticsError::Constant`] if the
    /// standard deviation is 0, and those of [`Moments::new`].
    pub fn new(sample: &[f64]) -> Result<Self, StatisticsError> {
        if sample.len() < FEWEST {
            return Err(StatisticsError::TooFew { n: sample.len(), required: FEWEST });
        }
        Self::of_sorted(&SortedSample::new(sample)?)
    }

    /// As [`new`](Self::new), of a sample that is sorted already.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new).
    pub fn of_sorted(sample: &SortedSample) -> Result<Self, StatisticsError> {
        let (values, n) = (sample.values(), sample.n());
        if n < FEWEST {
            return Err(StatisticsError::TooFew { n, required: FEWEST });
        }
        if sample.minimum() == sample.maximum() {
            return Err(StatisticsError::Constant);
        }
        let sum: ExactSum = values.iter().copied().collect();
        let n = n as u64;
        let centred = Centred::new(&sum, n, sample.minimum(), sample.maximum());
        let (mut powers, mut kept) = (Powers::default(), UnitSum::default());
        values.iter().for_each(|x| powers.add(centred.map(*x)));
        let cut = trimmed(n);
        let middle = &values[cut as usize..(n - cut) as usize];
        middle.iter().for_each(|x| kept.add(centred.map(*x)));
        let range = (sample.minimum(), sample.maximum());
        let moments = Moments::of_powers((n, sum.mean(n)), range, &centred, &powers)?;
        Self::of_powers(&moments, &powers, kept.value())
    }

    /// Of moments and powers of deviations from the mean, and the sum of the deviations without those that
    /// are [`trimmed`].
    pub(crate) fn of_powers(
        moments: &Moments,
        powers: &Powers,
        kept: f64,
    ) -> Result<Self, StatisticsError> {
        let standard_deviation = moments.standard_deviation();
        if standard_deviation == 0.0 {
            return Err(StatisticsError::Constant);
        }
        let n = moments.n();
        let [s2, s3, s4] = powers.values();
        let m = kept / (n - 2 * trimmed(n as u64) as usize) as f64;
        // Σ(u − m)⁴ with Σu = 0.
        let fourth = s4 - 4.0 * m * s3 + 6.0 * m * m * s2 + n as f64 * m.powi(4);
        Ok(Self { n, standard_deviation, kurtosis: n as f64 * fourth / (s2 * s2) })
    }

    /// Of samples that nobody drew.
    #[cfg(test)]
    pub(crate) fn of(n: usize, standard_deviation: f64, kurtosis: f64) -> Self {
        Self { n, standard_deviation, kurtosis }
    }

    /// Bonett's interval for the standard deviation of a law of unknown shape,
    /// `exp(½(ln(c·s²) ± z·c·√((κ̂ − (n−3)/n)/(n−1))))` with `c = n/(n − z)` (Bonett 2006,
    /// doi:10.1016/j.csda.2004.10.003). It covers less often than it says where rare values make
    /// the kurtosis; see [the limits](Self#limits).
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] unless `n` exceeds the normal quantile `z`: at five values,
    /// beyond a confidence of 1 − 6·10⁻⁷.
    pub fn interval(&self, confidence: Confidence) -> Result<Interval, StatisticsError> {
        let z = law::normal(confidence.tail());
        let correction = self.correction(z)?;
        let centre = self.standard_deviation * correction.sqrt();
        let half = 0.5 * z * correction * self.log_variance(self.kurtosis).sqrt();
        Ok(Interval::around_log(centre, half, confidence))
    }

    /// `c = n/(n − z)`, which evens the tails out in small samples.
    pub(crate) fn correction(&self, z: f64) -> Result<f64, StatisticsError> {
        let count = self.n as f64;
        if count > z {
            Ok(count / (count - z))
        } else {
            Err(StatisticsError::TooFew { n: self.n, required: z as usize + 1 })
        }
    }

    /// `Var(ln s²)` at the given kurtosis: positive, for no sample kurtosis is below 1.
    pub(crate) fn log_variance(&self, kurtosis: f64) -> f64 {
        let count = self.n as f64;
        (kurtosis - (count - 3.0) / count) / (count - 1.0)
    }
}

/// The fewest values that have a kurtosis about a trimmed mean.
pub(crate) const FEWEST: usize = 5;

/// How many values a trimmed mean leaves out at either end, a share `1/(2√(n−4))`: the mean of five is their
/// median.
pub(crate) fn trimmed(n: u64) -> u64 {
    let count = n as f64;
    (count / (2.0 * (count - 4.0).sqrt())) as u64
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const X: [f64; 8] = [15.8, 16.0, 16.2, 15.6, 16.4, 15.9, 16.1, 17.3];

    fn assert_bounds(interval: Interval, lower: f64, upper: f64) {
        assert!((interval.lower() / lower - 1.0).abs() < 1e-12, "{interval}");
        assert!((interval.upper() / upper - 1.0).abs() < 1e-12, "{interval}");
    }

    #[test]
    fn normal_interval_agrees_with_scipy() {
        // scipy 1.17.1 `s*sqrt(7/chi2.isf(0.025, 7))` and `s*sqrt(7/chi2.ppf(0.025, 7))`.
        let interval = Moments::new(&X).unwrap().normal_deviation_interval(Confidence::default());
        assert_bounds(interval, 0.3443505161041908, 1.060003625537068);
        let constant = Moments::new(&[2.0; 3]).unwrap();
        let interval = constant.normal_deviation_interval(Confidence::default());
        assert_eq!((interval.lower(), interval.upper()), (0.0, 0.0));
    }

    #[test]
    fn robust_interval_agrees_with_the_formula() {
        // The formula in NumPy 2.4.6, as in `.varCI.bonett` of the R package DescTools.
        let deviation = Deviation::new(&X).unwrap();
        assert!((deviation.kurtosis() - 5.552677712763627).abs() < 1e-10);
        let interval = deviation.interval(Confidence::default()).unwrap();
        assert_bounds(interval, 0.20172023721619445, 1.7810279517641803);
        let interval = deviation.interval(Confidence::new(0.99).unwrap()).unwrap();
        assert_bounds(interval, 0.12850300705893153, 3.113243536555837);
    }

    proptest! {
        /// Against the formula as it is documented, of values of any unit.
        #[test]
        fn the_kurtosis_is_about_the_trimmed_mean(
            values in prop::collection::vec(prop_oneof![-1.0..1.0f64, -30.0..30.0f64], 5..200),
            unit in -200..200i32,
        ) {
            let sample: Vec<f64> = values.iter().map(|x| x * 2f64.powi(unit)).collect();
            let deviation = Deviation::new(&sample).unwrap();
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let cut = (n / (2.0 * (n - 4.0).sqrt())) as usize;
            let kept = &sorted[cut..values.len() - cut];
            let trimmed = kept.iter().sum::<f64>() / kept.len() as f64;
            let sum = |about: f64, power| values.iter().map(|x| (x - about).powi(power)).sum::<f64>();
            let kurtosis = n * sum(trimmed, 4) / sum(mean, 2).powi(2);
            prop_assert!((deviation.kurtosis() / kurtosis - 1.0).abs() < 1e-12, "{kurtosis}");
        }
    }

    #[test]
    fn trimming_leaves_the_median_of_five() {
        assert_eq!((trimmed(5), trimmed(6), trimmed(1000)), (2, 2, 15));
    }

    #[test]
    fn unusable_requests_are_refused() {
        let too_few = StatisticsError::TooFew { n: 4, required: 5 };
        assert_eq!(Deviation::new(&[1.0, 2.0, 3.0, 4.0]), Err(too_few));
        assert_eq!(Deviation::new(&[1.0; 9]), Err(StatisticsError::Constant));
        let five = Deviation::new(&[1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
        assert_eq!(
            five.interval(Confidence::new(1.0 - 1e-9).unwrap()),
            Err(StatisticsError::TooFew { n: 5, required: 7 })
        );
    }

    #[test]
    fn the_ends_of_the_range_of_floats_are_no_exception() {
        for unit in [1e300, 1e-300, 5e-324] {
            let sample: Vec<f64> = (0..50).map(|i| f64::from(i * i) * unit).collect();
            let one: Vec<f64> = (0..50).map(|i| f64::from(i * i)).collect();
            let (extreme, one) = (Deviation::new(&sample).unwrap(), Deviation::new(&one).unwrap());
            assert!((extreme.kurtosis() - one.kurtosis()).abs() < 1e-12);
        }
    }

    proptest! {
        #[test]
        fn intervals_are_in_order_and_nested(
            sample in prop::collection::vec(any::<f64>(), 5..12),
            level in 0.5..0.99f64,
        ) {
            let Ok(deviation) = Deviation::new(&sample) else { return Ok(()) };
            // Bonett's lower bound exceeds s in tiny samples at low levels, so s need not be in.
            let interval = deviation.interval(Confidence::new(level).unwrap()).unwrap();
            prop_assert!(interval.lower() <= interval.upper() && interval.lower() >= 0.0);
            let moments = Moments::new(&sample).unwrap();
            let inner = moments.normal_deviation_interval(Confidence::new(level).unwrap());
            let outer = moments.normal_deviation_interval(Confidence::new(0.99).unwrap());
            prop_assert!(outer.lower() <= inner.lower() && inner.upper() <= outer.upper());
        }
    }
}
