//! Intervals for a ratio of two standard deviations.

use crate::{Confidence, Deviation, Interval, Moments, StatisticsError, law};

impl Moments {
    /// Normal-theory interval for the ratio `σ/σ_other` of two independent samples,
    /// `(s/s_other)/√F` with the two quantiles of F at `n − 1` and `n_other − 1` degrees of freedom.
    ///
    /// Exact for two normal laws and only there, see
    /// [`normal_deviation_interval`](Self::normal_deviation_interval).
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Constant`] if the standard deviation of `other` is 0.
    pub fn normal_ratio_interval(
        &self,
        other: &Self,
        confidence: Confidence,
    ) -> Result<Interval, StatisticsError> {
        if other.standard_deviation() == 0.0 {
            return Err(StatisticsError::Constant);
        }
        let (a, b) = (self.n() as f64 - 1.0, other.n() as f64 - 1.0);
        let ratio = self.standard_deviation() / other.standard_deviation();
        Ok(Interval::ordered(
            ratio / law::fisher(confidence.tail(), a, b).sqrt(),
            ratio * law::fisher(confidence.tail(), b, a).sqrt(),
            confidence,
        ))
    }
}

impl Deviation {
    /// The ratio of standard deviations, `self/other`.
    pub fn ratio(&self, other: &Self) -> f64 {
        self.standard_deviation() / other.standard_deviation()
    }

    /// Robust interval for the ratio `σ/σ_other` of two independent samples whose laws may differ
    /// in shape: `exp(½(ln(c·s²/s_other²) ± z·√(c₁²v₁ + c₂²v₂)))`, `c = c₁/c₂`, where each
    /// `v = (κ̂ − (n−3)/n)/(n−1)` uses the kurtosis of its own sample and `cᵢ = nᵢ/(nᵢ − z)`.
    ///
    /// This is the delta method for the difference of two [`interval`](Self::interval)s. Bonett's
    /// own interval for a ratio, [`pooled_ratio_interval`](Self::pooled_ratio_interval), covers
    /// better when both laws have the same shape and samples are small, and fails at any size when
    /// they do not and sizes differ: 0.68 instead of 0.95 for 1000 uniform draws against 100 of a
    /// Laplace law, where this one covers 0.92. Its own shortfall is small and vanishes with `n`:
    /// 0.92 for two exponential samples of 10 or 50, 0.95 of 1000.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] as for [`interval`](Self::interval), for either sample.
    pub fn ratio_interval(
        &self,
        other: &Self,
        confidence: Confidence,
    ) -> Result<Interval, StatisticsError> {
        let z = law::normal(confidence.tail());
        let (c1, c2) = (self.correction(z)?, other.correction(z)?);
        let error = (c1 * self.log_variance(self.kurtosis()).sqrt())
            .hypot(c2 * other.log_variance(other.kurtosis()).sqrt());
        let centre = self.ratio(other) * (c1 / c2).sqrt();
        Ok(Interval::around_log(centre, 0.5 * z * error, confidence))
    }

    /// Bonett's interval for the ratio `σ/σ_other` of two independent samples whose laws **differ
    /// in location and scale only** (Bonett 2006, doi:10.1177/0146621605279551).
    ///
    /// As [`ratio_interval`](Self::ratio_interval) with one kurtosis for both samples,
    /// `κ̂ = (n₁+n₂)·ΣᵢΣⱼ(xᵢⱼ − mᵢ)⁴/(ΣᵢΣⱼ(xᵢⱼ − x̄ᵢ)²)²`, and no `cᵢ` in the standard error. The
    /// pooling supposes equal variances, so that each bound is solved for with the second sample
    /// rescaled by the ratio that the bound itself claims, as in Bonett's R package `statpsych`
    /// (`ci.ratio.sd2`): the interval then holds for any ratio. Coverage is 0.94 to 0.97 from ten
    /// values a sample even for exponential laws.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] as for [`interval`](Self::interval), for either sample.
    pub fn pooled_ratio_interval(
        &self,
        other: &Self,
        confidence: Confidence,
    ) -> Result<Interval, StatisticsError> {
        let z = law::normal(confidence.tail());
        let correction = self.correction(z)? / other.correction(z)?;
        // All in terms of q = ρ/(s/s_other), which depends on neither unit nor spread.
        let error = |q: f64| {
            let kurtosis = self.pooled_kurtosis(other, q);
            (self.log_variance(kurtosis) + other.log_variance(kurtosis)).sqrt()
        };
        let excess = |q: f64| correction.ln() - 2.0 * q.ln();
        let centre = correction.sqrt();
        let lower = law::bisect(0.0, centre, |q| excess(q) > z * error(q));
        let upper = law::bisect(centre, f64::MAX, |q| -excess(q) < z * error(q));
        let ratio = self.ratio(other);
        Ok(Interval::ordered(ratio * lower, ratio * upper, confidence))
    }

    /// Kurtosis of both samples about their own means, with the second rescaled to a standard
    /// deviation `q` times that of the first.
    fn pooled_kurtosis(&self, other: &Self, q: f64) -> f64 {
        let (n1, n2) = (self.n() as f64, other.n() as f64);
        // The share of the first sample in the sum of squares.
        let share = (n1 - 1.0) / ((n1 - 1.0) + q * q * (n2 - 1.0));
        (n1 + n2)
            * (self.kurtosis() * share.powi(2) / n1 + other.kurtosis() * (1.0 - share).powi(2) / n2)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const X: [f64; 8] = [15.8, 16.0, 16.2, 15.6, 16.4, 15.9, 16.1, 17.3];
    const Y: [f64; 5] = [15.1, 14.9, 15.6, 15.3, 15.2];
    const Y1: [f64; 10] = [32.0, 39.0, 26.0, 35.0, 43.0, 27.0, 40.0, 37.0, 34.0, 29.0];
    const Y2: [f64; 10] = [36.0, 44.0, 47.0, 42.0, 49.0, 39.0, 46.0, 31.0, 33.0, 48.0];

    fn assert_bounds(interval: Interval, lower: f64, upper: f64) {
        assert!((interval.lower() / lower - 1.0).abs() < 1e-11, "{interval}");
        assert!((interval.upper() / upper - 1.0).abs() < 1e-11, "{interval}");
    }

    fn deviations(a: &[f64], b: &[f64]) -> (Deviation, Deviation) {
        (Deviation::new(a).unwrap(), Deviation::new(b).unwrap())
    }

    #[test]
    fn normal_interval_agrees_with_scipy() {
        // scipy 1.17.1, `r/sqrt(f.isf(0.025, n1-1, n2-1))` and `r*sqrt(f.isf(0.025, n2-1, n1-1))`.
        let interval = |a: &[f64], b: &[f64]| {
            let (a, b) = (Moments::new(a).unwrap(), Moments::new(b).unwrap());
            a.normal_ratio_interval(&b, Confidence::default()).unwrap()
        };
        assert_bounds(interval(&Y1, &Y2), 0.4412813208233368, 1.7765960197941506);
        assert_bounds(interval(&X, &Y), 0.6679511611819764, 4.72845264546155);
        let (x, constant) = (Moments::new(&X).unwrap(), Moments::new(&[1.0; 3]).unwrap());
        assert_eq!(
            x.normal_ratio_interval(&constant, Confidence::default()),
            Err(StatisticsError::Constant)
        );
    }

    #[test]
    fn robust_interval_agrees_with_the_formula() {
        // The formula in NumPy 2.4.6.
        let (a, b) = deviations(&Y1, &Y2);
        let interval = a.ratio_interval(&b, Confidence::default()).unwrap();
        assert_bounds(interval, 0.4639835080848386, 1.6896691897956349);
        let (a, b) = deviations(&X, &Y);
        let interval = a.ratio_interval(&b, Confidence::default()).unwrap();
        assert_bounds(interval, 0.3763689845916973, 8.662441205845814);
    }

    #[test]
    fn pooled_interval_agrees_with_statpsych() {
        let (a, b) = deviations(&Y1, &Y2);
        let interval = a.pooled_ratio_interval(&b, Confidence::default()).unwrap();
        // The documented example of `ci.ratio.sd2`, which stops after ten iterations.
        assert!((interval.lower() - 0.486279).abs() < 1e-6, "{interval}");
        assert!((interval.upper() - 1.728396).abs() < 3e-6, "{interval}");
        // The same formula in NumPy 2.4.6 after 2000.
        assert_bounds(interval, 0.48627889423484005, 1.7283977517794613);
        let (a, b) = deviations(&X, &Y);
        let interval = a.pooled_ratio_interval(&b, Confidence::default()).unwrap();
        assert_bounds(interval, 0.3074753468977271, 6.305385037472602);
    }

    proptest! {
        #[test]
        fn exchanging_the_samples_inverts_the_interval(
            a in prop::collection::vec(-1.0..1.0f64, 5..20),
            b in prop::collection::vec(-1e3..1e3f64, 5..20),
        ) {
            let (a, b) = deviations(&a, &b);
            let confidence = Confidence::default();
            for (ab, ba) in [
                (a.ratio_interval(&b, confidence), b.ratio_interval(&a, confidence)),
                (a.pooled_ratio_interval(&b, confidence), b.pooled_ratio_interval(&a, confidence)),
            ] {
                let (ab, ba) = (ab.unwrap(), ba.unwrap());
                prop_assert!((ab.lower() * ba.upper() - 1.0).abs() < 1e-9, "{ab} {ba}");
                prop_assert!((ab.upper() * ba.lower() - 1.0).abs() < 1e-9, "{ab} {ba}");
            }
        }

        #[test]
        fn any_samples_give_bounds_in_order(
            a in prop::collection::vec(any::<f64>(), 5..8),
            b in prop::collection::vec(any::<f64>(), 5..8),
        ) {
            let (Ok(a), Ok(b)) = (Deviation::new(&a), Deviation::new(&b)) else { return Ok(()) };
            let confidence = Confidence::new(1.0 - 1e-6).unwrap();
            for interval in [
                a.ratio_interval(&b, confidence).unwrap(),
                a.pooled_ratio_interval(&b, confidence).unwrap(),
            ] {
                prop_assert!(interval.lower() <= interval.upper(), "{interval}");
            }
        }
    }
}
