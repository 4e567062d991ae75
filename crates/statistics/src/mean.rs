//! Intervals for a mean and for a difference of means.

use crate::{Confidence, Interval, Moments, law};

impl Moments {
    /// Student's t interval for the mean, `x̄ ± t_{n−1}·s/√n` (Student 1908,
    /// doi:10.1093/biomet/6.1.1).
    ///
    /// Exact for independent draws of a normal law; by the central limit theorem close to it for
    /// any law of finite variance once `n` is some tens, later the more skewed the law. A constant
    /// sample gives an interval of no width.
    ///
    /// ```
    /// use gyradius_statistics::{Confidence, Moments};
    ///
    /// let interval = Moments::new(&[4.0, 5.0, 6.0])?.mean_interval(Confidence::default());
    /// assert_eq!(format!("{interval:.3}"), "[2.516, 7.484]");
    /// # Ok::<(), gyradius_statistics::StatisticsError>(())
    /// ```
    pub fn mean_interval(&self, confidence: Confidence) -> Interval {
        let t = law::students_t(confidence.tail(), self.n() as f64 - 1.0);
        Interval::around(self.mean(), t * self.standard_error(), confidence)
    }

    /// Welch's interval for the difference `self − other` of the means of two independent samples
    /// (Welch 1947, doi:10.1093/biomet/34.1-2.28), with Satterthwaite's degrees of freedom.
    ///
    /// The variances need not be equal. Not exact even for normal laws, though close from about
    /// five values a sample; otherwise as [`mean_interval`](Self::mean_interval).
    pub fn mean_difference_interval(&self, other: &Self, confidence: Confidence) -> Interval {
        let difference = self.mean() - other.mean();
        let (a, b) = (self.standard_error(), other.standard_error());
        let error = a.hypot(b);
        if error == 0.0 {
            return Interval::around(difference, 0.0, confidence);
        }
        let (share, rest) = ((a / error).powi(2), (b / error).powi(2));
        let freedom = (share + rest).powi(2)
            / (share * share / (self.n() as f64 - 1.0) + rest * rest / (other.n() as f64 - 1.0));
        let t = law::students_t(confidence.tail(), freedom);
        Interval::around(difference, t * error, confidence)
    }

    /// Standard error of the mean, `s/√n`.
    pub fn standard_error(&self) -> f64 {
        self.standard_deviation() / (self.n() as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const X: [f64; 8] = [15.8, 16.0, 16.2, 15.6, 16.4, 15.9, 16.1, 17.3];
    const Y: [f64; 5] = [15.1, 14.9, 15.6, 15.3, 15.2];

    fn assert_bounds(interval: Interval, lower: f64, upper: f64) {
        assert!((interval.lower() - lower).abs() < 1e-12, "{interval}");
        assert!((interval.upper() - upper).abs() < 1e-12, "{interval}");
    }

    #[test]
    fn agree_with_scipy() {
        let (x, y) = (Moments::new(&X).unwrap(), Moments::new(&Y).unwrap());
        // scipy 1.17.1 `stats.t.interval(0.95, 7, mean, sem)`.
        let interval = x.mean_interval(Confidence::default());
        assert_bounds(interval, 15.727086370556167, 16.597913629443838);
        // scipy 1.17.1 `ttest_ind(x, y, equal_var=False).confidence_interval(0.95)`.
        let interval = x.mean_difference_interval(&y, Confidence::default());
        assert_bounds(interval, 0.4621501131633932, 1.4228498868366048);
    }

    #[test]
    fn constant_samples_give_points() {
        let (one, three) = (Moments::new(&[1.0; 4]).unwrap(), Moments::new(&[3.0; 4]).unwrap());
        assert_bounds(one.mean_interval(Confidence::default()), 1.0, 1.0);
        assert_bounds(one.mean_difference_interval(&three, Confidence::default()), -2.0, -2.0);
        // One constant sample leaves the other's degrees of freedom.
        let x = Moments::new(&X).unwrap();
        let own = x.mean_interval(Confidence::default());
        let difference = x.mean_difference_interval(&one, Confidence::default());
        assert_bounds(difference, own.lower() - 1.0, own.upper() - 1.0);
    }

    proptest! {
        #[test]
        fn intervals_are_in_order_for_any_sample(
            a in prop::collection::vec(any::<f64>(), 2..6),
            b in prop::collection::vec(any::<f64>(), 2..6),
            level in 1e-9..1.0f64,
        ) {
            let (Ok(a), Ok(b)) = (Moments::new(&a), Moments::new(&b)) else { return Ok(()) };
            let confidence = Confidence::new(level).unwrap();
            prop_assert!(a.mean_interval(confidence).contains(a.mean()));
            let interval = a.mean_difference_interval(&b, confidence);
            prop_assert!(interval.lower() <= interval.upper());
        }
    }
}
