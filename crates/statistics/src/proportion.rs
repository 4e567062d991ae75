//! A proportion and its exact interval.

use crate::{Confidence, Interval, StatisticsError, error::MAX_TRIALS, law};

/// A number of successes in a number of independent trials.
///
/// ```
/// use gyradius_statistics::{Confidence, Proportion};
///
/// // No collision in 1000 runs: the rule of three, made exact.
/// let interval = Proportion::new(0, 1000)?.interval(Confidence::default());
/// assert_eq!(interval.lower(), 0.0);
/// assert!((interval.upper() - 0.00368).abs() < 1e-5);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct Proportion {
    /// Number of successes.
    successes: u64,
    /// Number of trials.
    trials: u64,
}

crate::checked::checked!(Proportion, |read| Proportion::new(read.successes, read.trials).map(drop));

impl Proportion {
    /// The most trials, up to which the quantiles of the beta law are tested.
    pub const MAX_TRIALS: u64 = MAX_TRIALS;

    /// `successes` out of `trials`.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Proportion`] without trials, with more than
    /// [`MAX_TRIALS`](Self::MAX_TRIALS) or with more successes than trials.
    pub fn new(successes: u64, trials: u64) -> Result<Self, StatisticsError> {
        if trials == 0 || trials > Self::MAX_TRIALS || successes > trials {
            return Err(StatisticsError::Proportion { successes, trials });
        }
        Ok(Self { successes, trials })
    }

    /// The observed proportion.
    pub fn value(&self) -> f64 {
        self.successes as f64 / self.trials as f64
    }

    /// The interval of Clopper & Pearson (1934, doi:10.1093/biomet/26.4.404): the proportions that
    /// neither one-sided binomial test at `α/2` rejects, as quantiles of the beta law.
    ///
    /// Coverage is at least the level at every proportion and number of trials, at the price of
    /// some width in small samples. The lower bound is exactly 0 without a success, the upper
    /// exactly 1 without a failure.
    pub fn interval(&self, confidence: Confidence) -> Interval {
        let [lower, upper] = exact(self.successes as f64, self.trials as f64, confidence);
        Interval::ordered(lower, upper, confidence)
    }
}

/// The bounds of the share of successes of k in n, which need not be whole (Clopper & Pearson 1934,
/// doi:10.1093/biomet/26.4.404).
pub(crate) fn exact(k: f64, n: f64, confidence: Confidence) -> [f64; 2] {
    let tail = confidence.tail();
    let lower = if k == 0.0 { 0.0 } else { law::beta_lower(tail, k, n - k + 1.0) };
    let upper = if k == n { 1.0 } else { law::beta_upper(tail, k + 1.0, n - k) };
    [lower, upper]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn agree_with_scipy() {
        // scipy 1.17.1 `beta.ppf(0.025, k, n-k+1)` and `beta.isf(0.025, k+1, n-k)`.
        for (successes, trials, lower, upper) in [
            (3, 10, 0.06673951117773447, 0.6524528500599973),
            (1, 1000, 2.531748749129404e-05, 0.005558924279826673),
            (999, 1000, 0.9944410757201734, 0.9999746825125088),
            (500_000, 1_000_000, 0.49901951919531184, 0.5009804808046882),
        ] {
            let interval =
                Proportion::new(successes, trials).unwrap().interval(Confidence::default());
            assert!((interval.lower() - lower).abs() < 1e-12 * lower, "{interval}");
            assert!((interval.upper() - upper).abs() < 1e-12 * upper, "{interval}");
        }
    }

    #[test]
    fn none_and_all_have_their_closed_form() {
        for trials in [1, 10, 1000, Proportion::MAX_TRIALS] {
            // 1 − (α/2)^(1/n)
            let bound = -((0.025f64.ln() / trials as f64).exp_m1());
            let none = Proportion::new(0, trials).unwrap().interval(Confidence::default());
            assert_eq!(none.lower(), 0.0);
            assert!((none.upper() - bound).abs() < 1e-12 * bound, "{none}");
            let all = Proportion::new(trials, trials).unwrap().interval(Confidence::default());
            assert_eq!(all.upper(), 1.0);
            assert!((all.lower() - (1.0 - bound)).abs() < 1e-12);
        }
    }

    #[test]
    fn impossible_counts_are_refused() {
        for (successes, trials) in [(0, 0), (2, 1), (0, u64::MAX)] {
            let refused = StatisticsError::Proportion { successes, trials };
            assert_eq!(Proportion::new(successes, trials), Err(refused));
        }
    }

    proptest! {
        #[test]
        fn intervals_hold_the_estimate(
            trials in 1..100_000u64,
            share in 0.0..=1.0f64,
            level in 0.01..0.999999f64,
        ) {
            let successes = (share * trials as f64) as u64;
            let proportion = Proportion::new(successes, trials).unwrap();
            let interval = proportion.interval(Confidence::new(level).unwrap());
            prop_assert!(interval.contains(proportion.value()), "{interval}");
            prop_assert!(interval.lower() >= 0.0 && interval.upper() <= 1.0);
        }

        #[test]
        fn coverage_is_at_least_the_level(trials in 1..60u64, p in 0.01..0.99f64) {
            let (mut mass, mut covered) = ((1.0 - p).powi(trials as i32), 0.0);
            for k in 0..=trials {
                let proportion = Proportion::new(k, trials).unwrap();
                if proportion.interval(Confidence::default()).contains(p) {
                    covered += mass;
                }
                mass *= (trials - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
            }
            prop_assert!(covered >= 0.95 - 1e-9, "{covered}");
        }
    }
}
