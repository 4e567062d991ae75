//! Order statistics: quantiles, their intervals and the empirical distribution function.

use crate::error::{probability, validate};
use crate::selection::{key, number};
use crate::{Confidence, Interval, StatisticsError, law};

/// A sample of finite values in increasing order; at least one.
///
/// ```
/// use gyradius_statistics::SortedSample;
///
/// let sample = SortedSample::new(&[3.0, 1.0, 2.0, 10.0])?;
/// assert_eq!(sample.median(), 2.5);
/// assert_eq!(sample.quantile(0.75)?, 4.75);
/// assert_eq!(sample.distribution(2.0), 0.5);
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Vec<f64>", into = "Vec<f64>"))]
pub struct SortedSample(Vec<f64>);

impl SortedSample {
    /// A sorted copy of the sample.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] for an empty sample, [`StatisticsError::NotFinite`] for a NaN
    /// or an infinity.
    pub fn new(sample: &[f64]) -> Result<Self, StatisticsError> {
        validate(sample, 1)?;
        // As whole numbers of the same order, which are sorted in half the time.
        let mut keys: Vec<i64> = sample.iter().map(|x| key(*x)).collect();
        keys.sort_unstable();
        Ok(Self(keys.into_iter().map(number).collect()))
    }

    /// The values in increasing order.
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// Number of values.
    pub fn n(&self) -> usize {
        self.0.len()
    }

    /// Smallest value.
    pub fn minimum(&self) -> f64 {
        self.0[0]
    }

    /// Largest value.
    pub fn maximum(&self) -> f64 {
        self.0[self.n() - 1]
    }

    /// Sample quantile of type 7 of Hyndman & Fan (1996, doi:10.1080/00031305.1996.10473566), the
    /// default of R and NumPy: linear between the order statistics around `1 + (n−1)p`.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Probability`] unless `0 ≤ p ≤ 1`.
    pub fn quantile(&self, p: f64) -> Result<f64, StatisticsError> {
        probability(p)?;
        Ok(self.type_7(p))
    }

    /// The median, `quantile(0.5)`.
    pub fn median(&self) -> f64 {
        self.type_7(0.5)
    }

    pub(crate) fn type_7(&self, p: f64) -> f64 {
        let (below, share) = type_7_place(self.n() as u64, p);
        match self.0.get(below as usize + 1) {
            Some(&above) => between(self.0[below as usize], above, share),
            None => self.maximum(),
        }
    }

    /// Distribution-free interval for the `p` quantile of the law the sample was drawn from, from
    /// a pair of order statistics (David & Nagaraja 2003, *Order Statistics*, ch. 7,
    /// doi:10.1002/0471722162).
    ///
    /// The number of draws below the quantile is binomial. The lower bound is the largest `x_(l)`
    /// with `P(B < l) ≤ α/2`, the upper the smallest `x_(u)` with `P(B ≥ u) ≤ α/2`. The coverage
    /// is at least the level for independent draws of **any** law, and exceeds it by little once
    /// `n·min(p, 1−p)` is some tens. A bound is infinite where even the extreme value of the
    /// sample is no bound at that level: a 95 % upper bound for `p` needs `pⁿ ≤ 0.025`. A tail that is larger than α/2 by a
    /// part in 10¹² or less counts as equal, as in [`Acceptance`](crate::Acceptance).
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Probability`] unless `0 ≤ p ≤ 1`.
    pub fn quantile_interval(
        &self,
        p: f64,
        confidence: Confidence,
    ) -> Result<Interval, StatisticsError> {
        probability(p)?;
        let (lower, upper) = interval_ranks(self.n() as u64, p, confidence);
        let at = |rank: Option<u64>, none: f64| rank.map_or(none, |rank| self.0[rank as usize]);
        Ok(Interval::ordered(at(lower, f64::NEG_INFINITY), at(upper, f64::INFINITY), confidence))
    }

    /// Empirical distribution function: the share of values that are at most `x`; NaN at NaN.
    pub fn distribution(&self, x: f64) -> f64 {
        if x.is_nan() { x } else { self.count_to(x) as f64 / self.n() as f64 }
    }

    /// Number of values below `x`.
    pub(crate) fn count_below(&self, x: f64) -> usize {
        self.0.partition_point(|&value| value < x)
    }

    /// Number of values that are at most `x`.
    pub(crate) fn count_to(&self, x: f64) -> usize {
        self.0.partition_point(|&value| value <= x)
    }
}

/// Where a quantile of type 7 of `n` values is: the rank below it, from 0, and its place from there to the next.
pub(crate) fn type_7_place(n: u64, p: f64) -> (u64, f64) {
    let position = n.saturating_sub(1) as f64 * p;
    let below = position as u64;
    (below, position - below as f64)
}

/// The ranks, from 0, of the values that bound a quantile of the law that `n` values were drawn from; none where
/// no value is a bound.
pub(crate) fn interval_ranks(n: u64, p: f64, confidence: Confidence) -> (Option<u64>, Option<u64>) {
    let (tail, rest) = (confidence.tail(), 1.0 - p);
    // Seen from above, what bounds it from below is what bounds it from above.
    let lower = upper_rank(n, rest, p, tail).map(|rank| n - rank);
    (lower, upper_rank(n, p, rest, tail).map(|rank| rank - 1))
}

/// Of `n` values the rank, from 1, of the least that bounds the quantile `p = 1 − q` from above but for a
/// probability of `tail`; none if not even the largest does.
fn upper_rank(n: u64, p: f64, q: f64, tail: f64) -> Option<u64> {
    let most = tail * (1.0 + law::ROUNDING);
    let rank = law::first(1, n, |k| law::at_least(k, n, p, q) <= most);
    (rank <= n).then_some(rank)
}

/// From `a` at 0 to `b` at 1, never outside, for any finite `a ≤ b`.
pub(crate) fn between(a: f64, b: f64, t: f64) -> f64 {
    let span = b - a;
    let value =
        if span.is_finite() { a + t * span } else { 2.0 * (a / 2.0 + t * (b / 2.0 - a / 2.0)) };
    value.clamp(a, b)
}

impl TryFrom<Vec<f64>> for SortedSample {
    type Error = StatisticsError;

    fn try_from(values: Vec<f64>) -> Result<Self, StatisticsError> {
        Self::new(&values)
    }
}

impl From<SortedSample> for Vec<f64> {
    fn from(sample: SortedSample) -> Self {
        sample.0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ranks(n: u32) -> SortedSample {
        SortedSample::new(&(1..=n).map(f64::from).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn type_7_agrees_with_numpy() {
        let sample = SortedSample::new(&[3.0, 1.0, 2.0, 10.0]).unwrap();
        // NumPy 2.4.6 `quantile([3, 1, 2, 10], p)`.
        for (p, reference) in
            [(0.0, 1.0), (0.1, 1.3), (0.25, 1.75), (0.33, 1.99), (0.9, 7.9), (1.0, 10.0)]
        {
            assert!((sample.quantile(p).unwrap() - reference).abs() < 1e-14);
        }
        assert_eq!(SortedSample::new(&[7.0]).unwrap().quantile(0.3), Ok(7.0));
    }

    #[test]
    fn intervals_agree_with_scipy() {
        // scipy 1.17.1 `quantile_test(arange(1, n+1), p=p).confidence_interval(0.95)`.
        let (below, above) = (f64::NEG_INFINITY, f64::INFINITY);
        for (n, p, lower, upper) in [
            (10, 0.5, 2.0, 9.0),
            (100, 0.9, 84.0, 96.0),
            (1000, 0.5, 469.0, 532.0),
            (100, 0.001, below, 2.0),
            (50, 0.99, 48.0, above),
            (3, 0.5, below, above),
            (50, 0.0, below, 1.0),
            (50, 1.0, 50.0, above),
        ] {
            let interval = ranks(n).quantile_interval(p, Confidence::default()).unwrap();
            assert_eq!((interval.lower(), interval.upper()), (lower, upper), "n {n}, p {p}");
        }
    }

    #[test]
    fn unusable_requests_are_refused() {
        assert_eq!(SortedSample::new(&[]), Err(StatisticsError::TooFew { n: 0, required: 1 }));
        assert!(matches!(
            SortedSample::new(&[0.0, f64::NAN]),
            Err(StatisticsError::NotFinite { index: 1, .. })
        ));
        for p in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
            assert!(matches!(ranks(9).quantile(p), Err(StatisticsError::Probability { .. })));
            assert!(ranks(9).quantile_interval(p, Confidence::default()).is_err());
        }
    }

    #[test]
    fn the_distribution_counts_ties_and_passes_nan_on() {
        let sample = SortedSample::new(&[1.0, 2.0, 2.0, 3.0]).unwrap();
        assert_eq!(
            [0.0, 1.0, 2.0, 2.5, 9.0].map(|x| sample.distribution(x)),
            [0.0, 0.25, 0.75, 0.75, 1.0]
        );
        assert!(sample.distribution(f64::NAN).is_nan());
    }

    /// Finite numbers of any size, some of them more often than once.
    fn finite() -> impl Strategy<Value = f64> {
        use prop::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
        const TIES: &[f64] = &[f64::MIN, -1.0, -5e-324, -0.0, 0.0, 5e-324, 1.0, f64::MAX];

        prop_oneof![POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO, prop::sample::select(TIES)]
    }

    /// A tail that is α/2 exactly is a bound, of either side: halves and their sums have no rounding of their own.
    #[test]
    fn a_tail_of_just_so_much_is_a_bound() {
        for n in 1..=50_u32 {
            let (mut choose, mut outside) = (1_u64, 0_u64);
            for beyond in 0..n / 2 {
                outside += choose;
                choose = choose * u64::from(n - beyond) / u64::from(beyond + 1);
                // P(B ≤ beyond) = P(B ≥ n − beyond) of a fair coin.
                let tail = outside as f64 / 2f64.powi(n as i32);
                if tail >= 0.5 {
                    break;
                }
                let level = Confidence::new(1.0 - 2.0 * tail).unwrap();
                let interval = ranks(n).quantile_interval(0.5, level).unwrap();
                let expected = (f64::from(beyond + 1), f64::from(n - beyond));
                assert_eq!((interval.lower(), interval.upper()), expected, "{n} {tail}");
                let more = Confidence::new(1.0 - 2.0 * tail * (1.0 - 1e-9));
                if let Ok(more) = more
                    && more.level() > level.level() * (1.0 + 1e-11)
                {
                    let wider = ranks(n).quantile_interval(0.5, more).unwrap();
                    assert!(wider.lower() < expected.0 && wider.upper() > expected.1, "{n} {tail}");
                }
            }
        }
    }

    proptest! {
        /// In the total order of floating-point numbers, to the bit: −0 stands before 0.
        #[test]
        fn samples_are_in_total_order(sample in prop::collection::vec(finite(), 1..200)) {
            let sorted = SortedSample::new(&sample).unwrap();
            let mut expected = sample;
            expected.sort_by(f64::total_cmp);
            let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(sorted.values()), bits(&expected));
        }

        #[test]
        fn quantiles_are_monotone_and_within_range(
            sample in prop::collection::vec(any::<f64>(), 1..20),
            p in 0.0..=1.0f64,
            q in 0.0..=1.0f64,
        ) {
            let Ok(sample) = SortedSample::new(&sample) else { return Ok(()) };
            let (low, high) =
                (sample.quantile(p.min(q)).unwrap(), sample.quantile(p.max(q)).unwrap());
            prop_assert!(sample.minimum() <= low && low <= high && high <= sample.maximum());
            prop_assert_eq!(sample.quantile(0.0).unwrap(), sample.minimum());
            prop_assert_eq!(sample.quantile(1.0).unwrap(), sample.maximum());
        }

        #[test]
        fn intervals_cover_at_least_as_often_as_they_say(
            n in 1..60u32,
            p in 0.01..0.99f64,
            level in 0.5..0.999f64,
        ) {
            // Ranks l and u hold the quantile when l ≤ B < u: the sum of binomial masses.
            let interval = ranks(n).quantile_interval(p, Confidence::new(level).unwrap()).unwrap();
            let (mut mass, mut covered) = ((1.0 - p).powi(n as i32), 0.0);
            for b in 0..=n {
                if interval.lower() <= f64::from(b) && f64::from(b) < interval.upper() {
                    covered += mass;
                }
                mass *= f64::from(n - b) / f64::from(b + 1) * p / (1.0 - p);
            }
            prop_assert!(covered >= level - 1e-9, "{covered} at {interval}");
        }
    }
}
