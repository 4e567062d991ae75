//! Tests of goodness of fit.

use std::f64::consts::PI;

use crate::{SortedSample, StatisticsError, tail};

/// The outcome of a test that a sample was drawn from a given law: the statistic, and the
/// probability of one at least as large if it was.
#[derive(Debug, Clone, Copy, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct GoodnessOfFit {
    /// The statistic: `D` of Kolmogorov–Smirnov or `X²` of Pearson.
    statistic: f64,
    /// The probability, under the law, of a statistic at least as large.
    p_value: f64,
}

crate::checked::checked!(GoodnessOfFit, |read| {
    crate::error::belong(read.statistic >= 0.0 && (0.0..=1.0).contains(&read.p_value), "test")
});

impl GoodnessOfFit {
    /// Kolmogorov–Smirnov test against a distribution function: `D = sup|F_n − F|`, and the
    /// p-value of the limiting law at `D·(√n + 0.12 + 0.11/√n)` (Stephens 1970,
    /// doi:10.1111/j.2517-6161.1970.tb00821.x). From `n = 10` it is within 0.001 of the exact one
    /// where that is below 0.1, and within 0.025 anywhere.
    ///
    /// Supposes independent draws and a continuous law **fixed beforehand**: parameters fitted to
    /// the same sample, or ties, make the p-value too large.
    ///
    /// ```
    /// use gyradius_statistics::{GoodnessOfFit, SortedSample};
    ///
    /// let sample = SortedSample::new(&[0.1, 0.3, 0.45, 0.7, 0.9])?;
    /// let uniform = GoodnessOfFit::kolmogorov_smirnov(&sample, |x| x.clamp(0.0, 1.0))?;
    /// assert!(uniform.p_value() > 0.05);
    /// # Ok::<(), gyradius_statistics::StatisticsError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`StatisticsError::DistributionFunction`] if `distribution` returns anything outside 0 to 1.
    pub fn kolmogorov_smirnov(
        sample: &SortedSample,
        distribution: impl Fn(f64) -> f64,
    ) -> Result<Self, StatisticsError> {
        let count = sample.n() as f64;
        let mut statistic = 0.0f64;
        for (i, &at) in sample.values().iter().enumerate() {
            let value = distribution(at);
            if !(0.0..=1.0).contains(&value) {
                return Err(StatisticsError::DistributionFunction { at, value });
            }
            let above = (i + 1) as f64 / count - value;
            statistic = statistic.max(above).max(value - i as f64 / count);
        }
        let root = count.sqrt();
        Ok(Self { statistic, p_value: kolmogorov_tail(statistic * (root + 0.12 + 0.11 / root)) })
    }

    /// Pearson's test of observed against expected counts (Pearson 1900,
    /// doi:10.1080/14786440009463897): `X² = Σ(O − E)²/E`, χ² with `classes − 1 − fitted` degrees
    /// of freedom, where `fitted` parameters of the law were estimated from these counts.
    ///
    /// The χ² law is the limit of large expected counts; Cochran (1954, doi:10.2307/3001616) asks
    /// for 5 in most classes and 1 in every one.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Classes`] if the counts do not pair up, [`StatisticsError::Expected`]
    /// for an expected count that is not positive, [`StatisticsError::Totals`] if the sums differ,
    /// [`StatisticsError::DegreesOfFreedom`] if none is left.
    pub fn chi_squared(
        observed: &[u64],
        expected: &[f64],
        fitted: usize,
    ) -> Result<Self, StatisticsError> {
        let classes = observed.len();
        if classes != expected.len() {
            return Err(StatisticsError::Classes { observed: classes, expected: expected.len() });
        }
        if let Some(index) = expected.iter().position(|e| !(*e > 0.0 && e.is_finite())) {
            return Err(StatisticsError::Expected { index, value: expected[index] });
        }
        let freedom = classes.saturating_sub(1).saturating_sub(fitted);
        if freedom == 0 {
            return Err(StatisticsError::DegreesOfFreedom { classes, fitted });
        }
        let totals =
            (observed.iter().map(|&o| o as f64).sum::<f64>(), expected.iter().sum::<f64>());
        if (totals.0 / totals.1 - 1.0).abs() > 1e-8 {
            return Err(StatisticsError::Totals { observed: totals.0, expected: totals.1 });
        }
        let statistic = observed.iter().zip(expected).map(|(&o, &e)| (o as f64 - e).powi(2) / e);
        let statistic: f64 = statistic.sum();
        Ok(Self { statistic, p_value: tail::chi_squared(statistic, freedom as f64) })
    }
}

/// `P(K > x)` for Kolmogorov's limiting law, from whichever of its two series converges fast.
fn kolmogorov_tail(x: f64) -> f64 {
    if x < 1.18 {
        let term = |k: i32| (-(f64::from(2 * k - 1) * PI / x).powi(2) / 8.0).exp();
        1.0 - (2.0 * PI).sqrt() / x.max(f64::MIN_POSITIVE) * (1..=4).map(term).sum::<f64>()
    } else {
        let term = |k: i32| (-2.0 * (f64::from(k) * x).powi(2)).exp();
        2.0 * (term(1) - term(2) + term(3) - term(4))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn assert_close(value: f64, reference: f64, tolerance: f64) {
        assert!((value - reference).abs() <= tolerance, "{value} is not {reference}");
    }

    #[test]
    fn kolmogorov_law_agrees_with_scipy() {
        // scipy 1.17.1 `stats.kstwobign.sf(x)`.
        for (x, reference) in [
            (0.5, 0.9639452436648751),
            (1.0, 0.26999967167735456),
            (1.18, 0.1234538094297657),
            (1.5, 0.022217962616525127),
            (2.0, 0.0006709252557796953),
        ] {
            assert_close(kolmogorov_tail(x), reference, 1e-14);
        }
        assert_close(kolmogorov_tail(1.18), kolmogorov_tail(1.18f64.next_down()), 1e-14);
        assert_eq!((kolmogorov_tail(0.0), kolmogorov_tail(40.0)), (1.0, 0.0));
    }

    #[test]
    fn kolmogorov_smirnov_agrees_with_scipy() {
        // d = (i/n − 0.1/n)²; scipy 1.17.1 `kstest(d, "uniform")`, exact p-values.
        for (n, statistic, p_value, tolerance) in
            [(5, 0.2636, 0.8001391320260608, 0.02), (20, 0.254975, 0.12381609606040422, 0.002)]
        {
            let sample: Vec<f64> =
                (1..=n).map(|i| ((f64::from(i) - 0.1) / f64::from(n)).powi(2)).collect();
            let sample = SortedSample::new(&sample).unwrap();
            let test = GoodnessOfFit::kolmogorov_smirnov(&sample, |x| x).unwrap();
            assert_close(test.statistic(), statistic, 1e-12);
            assert_close(test.p_value(), p_value, tolerance);
        }
    }

    #[test]
    fn chi_squared_agrees_with_scipy() {
        let (observed, expected) = ([16, 18, 16, 14, 12, 12], [16.0, 16.0, 16.0, 16.0, 16.0, 8.0]);
        // scipy 1.17.1 `stats.chisquare(observed, expected, ddof)`.
        for (fitted, p_value) in [(0, 0.6233876277495822), (2, 0.3207621208056397)] {
            let test = GoodnessOfFit::chi_squared(&observed, &expected, fitted).unwrap();
            assert_eq!(test.statistic(), 3.5);
            assert_close(test.p_value(), p_value, 1e-12);
        }
        // A perfect fit, and one beyond any doubt.
        let perfect = GoodnessOfFit::chi_squared(&[5, 5], &[5.0, 5.0], 0).unwrap();
        assert_eq!((perfect.statistic(), perfect.p_value()), (0.0, 1.0));
        let absurd = GoodnessOfFit::chi_squared(&[5, 5], &[10.0, 1e-320], 0).unwrap();
        assert_eq!(absurd.p_value(), 0.0);
    }

    #[test]
    fn unusable_requests_are_refused() {
        let sample = SortedSample::new(&[0.5]).unwrap();
        for value in [-0.1, 1.1, f64::NAN] {
            assert!(matches!(
                GoodnessOfFit::kolmogorov_smirnov(&sample, |_| value),
                Err(StatisticsError::DistributionFunction { at: 0.5, .. })
            ));
        }
        let test = GoodnessOfFit::chi_squared;
        assert!(matches!(test(&[1], &[0.5, 0.5], 0), Err(StatisticsError::Classes { .. })));
        assert!(matches!(test(&[], &[], 0), Err(StatisticsError::DegreesOfFreedom { .. })));
        assert!(matches!(
            test(&[1, 1], &[1.0, 1.0], 1),
            Err(StatisticsError::DegreesOfFreedom { classes: 2, fitted: 1 })
        ));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                test(&[1, 1], &[1.0, bad], 0),
                Err(StatisticsError::Expected { index: 1, .. })
            ));
        }
        // The second sum overflows.
        for count in [2.0, f64::MAX] {
            assert!(matches!(test(&[1, 1], &[count; 2], 0), Err(StatisticsError::Totals { .. })));
        }
    }

    proptest! {
        #[test]
        fn p_values_are_probabilities(
            sample in prop::collection::vec(0.0..1.0f64, 1..50),
            counts in prop::collection::vec(0..100u64, 2..20),
        ) {
            let sample = SortedSample::new(&sample).unwrap();
            let ks = GoodnessOfFit::kolmogorov_smirnov(&sample, |x| x).unwrap();
            prop_assert!((0.0..=1.0).contains(&ks.p_value()), "{ks:?}");
            let mean = (counts.iter().sum::<u64>() as f64 / counts.len() as f64).max(1e-9);
            let expected = vec![mean; counts.len()];
            if let Ok(test) = GoodnessOfFit::chi_squared(&counts, &expected, 0) {
                prop_assert!((0.0..=1.0).contains(&test.p_value()), "{test:?}");
            }
        }
    }
}
