//! How a number is distributed over the runs that have one.

use gyradius_statistics::{Confidence, Deviation, Interval, Moments, SortedSample};
use serde::{Deserialize, Serialize};

/// How a number is distributed over the runs that have one. What a sample cannot tell is none, and null in
/// JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampleSummary {
    /// Runs that have one.
    pub n: u64,
    /// Mean.
    pub mean: Option<f64>,
    /// Where the true mean lies.
    pub mean_interval: Option<Interval>,
    /// Standard deviation.
    pub deviation: Option<f64>,
    /// Where the true standard deviation lies.
    pub deviation_interval: Option<Interval>,
    /// Smallest number.
    pub minimum: Option<f64>,
    /// 5th percentile.
    pub p05: Option<f64>,
    /// 50th percentile.
    pub median: Option<f64>,
    /// 95th percentile.
    pub p95: Option<f64>,
    /// Where the true 95th percentile lies; none where the sample is too small to give both bounds.
    pub p95_interval: Option<Interval>,
    /// Largest number.
    pub maximum: Option<f64>,
    /// Third standardized moment.
    pub skewness: Option<f64>,
    /// Fourth standardized moment.
    pub kurtosis: Option<f64>,
}

impl SampleSummary {
    /// Of these numbers.
    #[must_use]
    pub fn new(values: &[f64], confidence: Confidence) -> Self {
        let moments = Moments::new(values).ok();
        let sorted = SortedSample::new(values).ok();
        let robust = Deviation::new(values).ok();
        let quantile = |p| sorted.as_ref().and_then(|s| s.quantile(p).ok());
        Self {
            n: values.len() as u64,
            mean: moments.map(|m| m.mean()),
            mean_interval: moments.map(|m| m.mean_interval(confidence)),
            deviation: moments.map(|m| m.standard_deviation()),
            deviation_interval: robust.and_then(|d| d.interval(confidence).ok()),
            minimum: sorted.as_ref().map(SortedSample::minimum),
            p05: quantile(0.05),
            median: quantile(0.5),
            p95: quantile(0.95),
            p95_interval: sorted
                .as_ref()
                .and_then(|s| s.quantile_interval(0.95, confidence).ok())
                .filter(|i| i.lower().is_finite() && i.upper().is_finite()),
            maximum: sorted.as_ref().map(SortedSample::maximum),
            skewness: moments.and_then(|m| m.skewness()),
            kurtosis: moments.and_then(|m| m.kurtosis()),
        }
    }
}
