//! How a number is distributed over the runs that have one.

use gyradius_statistics::{Confidence, Interval, Moments, Survey};
use serde::{Deserialize, Serialize};

/// How a number is distributed over the runs that have one. What a sample cannot tell is none, and null in
/// JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampleSummary {
    /// Runs that have one.
    pub n: u64,
    /// Mean; of one run it is its number.
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
        let mut survey = surveyed(values.len() as u64, confidence);
        while let Some(mut pass) = survey.pass() {
            pass.extend((0..).zip(values.iter().copied()));
            survey.advance(pass);
        }
        Self::of(&survey, confidence)
    }

    /// Of a survey of the numbers, with intervals of this confidence: of groups, as the survey has them.
    #[must_use]
    pub fn of(survey: &Survey, confidence: Confidence) -> Self {
        let moments = survey.moments();
        Self {
            n: survey.n(),
            mean: survey.mean(),
            mean_interval: survey.mean_interval(confidence),
            deviation: moments.map(Moments::standard_deviation),
            deviation_interval: survey.deviation_interval(confidence),
            minimum: survey.minimum().map(|(x, _)| x),
            p05: survey.quantile(0.05),
            median: survey.quantile(0.5),
            p95: survey.quantile(0.95),
            p95_interval: bounded(survey.quantile_interval(0.95, confidence)),
            maximum: survey.maximum().map(|(x, _)| x),
            skewness: moments.and_then(Moments::skewness),
            kurtosis: moments.and_then(Moments::kurtosis),
        }
    }
}

/// Probabilities of the quantiles that are found of every column of numbers, and of those with an interval.
const QUANTILES: [f64; 6] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95];
const INTERVALS: [f64; 2] = [0.01, 0.95];

/// A survey of a column of so many runs.
pub(crate) fn surveyed(runs: u64, confidence: Confidence) -> Survey {
    let survey = Survey::new(runs).quantiles(QUANTILES);
    INTERVALS.into_iter().fold(survey, |survey, p| survey.quantile_interval_at(p, confidence))
}

/// An interval if it has both bounds.
#[must_use]
pub fn bounded(interval: Option<Interval>) -> Option<Interval> {
    interval.filter(|i| i.lower().is_finite() && i.upper().is_finite())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// One run has a mean and quantiles and no deviation; of more, all are between the smallest and the largest.
        #[test]
        fn a_sample_of_any_size_is_summarized(values in prop::collection::vec(-1e300..1e300_f64, 0..6)) {
            let found = SampleSummary::new(&values, Confidence::default());
            prop_assert_eq!(found.n, values.len() as u64);
            let told = [found.mean, found.median, found.p05, found.p95, found.minimum, found.maximum];
            prop_assert!(told.iter().all(|x| x.is_some() != values.is_empty()), "{:?}", found);
            prop_assert_eq!(found.mean_interval.is_some(), values.len() > 1);
            let range = found.minimum.zip(found.maximum);
            prop_assert!(told.iter().flatten().all(|x| range.is_some_and(|(low, high)| (low..=high).contains(x))));
            let n = values.len() as f64;
            let mean = values.iter().map(|x| x / n).sum::<f64>();
            prop_assert!(found.mean.is_none_or(|x| (x - mean).abs() <= 1e-15 * n * 1e300));
            if let [value] = values[..] {
                prop_assert_eq!((found.mean, found.deviation), (Some(value), None));
            }
        }
    }
}
