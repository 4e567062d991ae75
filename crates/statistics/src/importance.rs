//! The probability of a rare event from runs that were drawn where it is less rare.

use crate::{Confidence, Interval, StatisticsError, law, proportion::exact};

/// The largest logarithm of a weight.
const LARGEST: f64 = 700.0;
/// Effective hits below which an estimate is not to be trusted.
const FEW: f64 = 20.0;
/// A probability above which an event is not rare.
pub(crate) const RARE: f64 = 0.5;
/// The share of one hit in the estimate from which it is not to be trusted.
const DOMINANT: f64 = 0.2;

/// What is gathered of runs whose inputs were drawn from another law than their own (importance sampling).
///
/// Each run counts with the weight `w = f(x)/g(x)`, the density of its inputs under their own law over that under the law
/// which they were drawn from, both normalised. The estimate `p = mean(w [hit])` is unbiased if g is positive wherever an
/// event can be (Kahn & Marshall 1953, doi:10.1287/opre.1.5.263). Its variance follows from that of `w [hit]`, and the interval
/// is log-normal: `p exp(± t σ)` with `σ² = ln(1 + c²)`, where c is the coefficient of variation of p and t is of as
/// many degrees of freedom as there are effective hits, less one; it is cut off at 1. Above a half it is that of Clopper & Pearson
/// of `1 - p`, for as many runs of equal weight as those that miss the event are worth.
///
/// **No number of this can show what the runs have not seen.** If g hardly reaches some part of the event, the estimate is
/// too small, and the runs look good. What can be seen is told by the [warnings](ImportanceEstimate::warnings), and by
/// [`mean_weight`](ImportanceEstimate::mean_weight): the mean of all weights is 1 in the long run, and what these runs found of it is,
/// roughly, the part of the law f that they have seen. It is small if g was moved far into the tail, which does no harm as long as
/// the event has no other part. A mixture with a tenth of f itself (Hesterberg 1995, doi:10.1080/00401706.1995.10484303)
/// bounds all weights by 10 and is the safe choice.
///
/// Weights are summed relative to the largest, so that none overflows or vanishes.
///
/// ```
/// use gyradius_statistics::{Confidence, ImportanceSampling};
///
/// // How often does a standard exponential number exceed 16? Drawn with a mean of 16, from even quantiles.
/// let mut runs = ImportanceSampling::new();
/// for i in 0..1000 {
///     let x = -16.0 * ((f64::from(i) + 0.5) / 1000.0).ln();
///     runs.push(-x + x / 16.0 + 16_f64.ln(), x > 16.0)?;
/// }
/// let estimate = runs.finish(Confidence::default())?;
/// assert!((estimate.probability() / (-16_f64).exp() - 1.0).abs() < 0.01);
/// assert!(estimate.interval().contains((-16_f64).exp()) && estimate.warnings().is_empty());
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ImportanceSampling {
    runs: u64,
    hits: u64,
    all: WeightSums,
    of_hits: WeightSums,
    of_misses: WeightSums,
}

impl ImportanceSampling {
    /// Of no run yet.
    pub fn new() -> Self {
        let [all, of_hits, of_misses] = [WeightSums::new(); 3];
        Self { runs: 0, hits: 0, all, of_hits, of_misses }
    }

    /// Adds a run: the natural logarithm of its weight, and whether it is the event.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::LogWeight`] for NaN and above 700. Minus infinity is a weight of 0.
    pub fn push(&mut self, log_weight: f64, hit: bool) -> Result<(), StatisticsError> {
        if !(log_weight <= LARGEST) {
            return Err(StatisticsError::LogWeight { value: log_weight, most: LARGEST });
        }
        self.runs += 1;
        self.all.add(log_weight);
        if hit {
            self.hits += 1;
            self.of_hits.add(log_weight);
        } else {
            self.of_misses.add(log_weight);
        }
        Ok(())
    }

    /// The same runs, of which those that miss the event count as hits.
    pub(crate) fn of_complement(&self) -> Self {
        let (of_hits, of_misses) = (self.of_misses, self.of_hits);
        Self { hits: self.runs - self.hits, of_hits, of_misses, ..*self }
    }

    /// The estimate with an interval of this confidence.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] below two runs.
    pub fn finish(&self, confidence: Confidence) -> Result<ImportanceEstimate, StatisticsError> {
        if self.runs < 2 {
            return Err(StatisticsError::TooFew { n: self.runs as usize, required: 2 });
        }
        let n = self.runs as f64;
        let probability = self.of_hits.mean(n);
        // Of hits of weight 1 alone it is above 1 by rounding.
        let probability = if probability < 1.0 + 1e-9 { probability.min(1.0) } else { probability };
        let effective_hits = self.of_hits.effective();
        // Σ(z − p)²/(n − 1)/n over p², of Σz² = (Σz)²/effective.
        let coefficient = (effective_hits > 0.0)
            .then(|| ((n / effective_hits - 1.0).max(0.0) / (n - 1.0)).sqrt());
        let interval = match coefficient {
            Some(_) if probability > RARE => self.of_the_rest(probability, confidence),
            Some(c) => {
                let t = law::students_t(confidence.tail(), (effective_hits - 1.0).max(1.0));
                let wide =
                    Interval::around_log(probability, t * libm::log1p(c * c).sqrt(), confidence);
                Interval::ordered(
                    wide.lower(),
                    wide.upper().min(1.0_f64.max(probability)),
                    confidence,
                )
            }
            None => Interval::ordered(0.0, 1.0, confidence),
        };
        let mut estimate = ImportanceEstimate {
            runs: self.runs,
            hits: self.hits,
            probability,
            coefficient_of_variation: coefficient,
            interval,
            effective_hits,
            effective_runs: self.all.effective(),
            largest_share: self.of_hits.largest_share(),
            mean_weight: self.all.mean(n),
            warnings: Vec::new(),
        };
        estimate.warnings = estimate.seen();
        Ok(estimate)
    }

    /// The interval of an event that is not rare, from the runs that are not the event: what they scatter decides, and there may be
    /// none. It is the exact one of as many runs of equal weight as these are worth, which it is for weights of 1.
    fn of_the_rest(&self, probability: f64, confidence: Confidence) -> Interval {
        let misses = self.of_misses.effective();
        let runs = if misses > 0.0 {
            (misses / self.of_misses.mean(self.runs as f64)).min(f64::MAX)
        } else {
            self.all.effective().min(self.runs as f64)
        };
        let [least, most] =
            if misses < runs { exact(misses, runs, confidence) } else { [1.0, 1.0] };
        // The mean weight is not quite 1, so that the estimate can lie beside the rest of 1.
        let (lower, upper) = ((1.0 - most).min(probability), (1.0 - least).max(probability));
        Interval::ordered(lower, upper, confidence)
    }
}

impl Default for ImportanceSampling {
    fn default() -> Self {
        Self::new()
    }
}

/// Sums of weights and of their squares, relative to the largest.
#[derive(Clone, Copy, Debug)]
struct WeightSums {
    /// The logarithm of the largest weight; minus infinity without one.
    largest: f64,
    sum: f64,
    squares: f64,
}

impl WeightSums {
    fn new() -> Self {
        Self { largest: f64::NEG_INFINITY, sum: 0.0, squares: 0.0 }
    }

    fn add(&mut self, log_weight: f64) {
        if log_weight == f64::NEG_INFINITY {
            return;
        }
        if log_weight > self.largest {
            let factor = libm::exp(self.largest - log_weight);
            self.largest = log_weight;
            self.sum *= factor;
            self.squares *= factor * factor;
        }
        let weight = libm::exp(log_weight - self.largest);
        self.sum += weight;
        self.squares += weight * weight;
    }

    /// Of n runs. It is never infinite, as the total may be.
    fn mean(&self, n: f64) -> f64 {
        if self.sum > 0.0 { libm::exp(self.largest + libm::log(self.sum / n)) } else { 0.0 }
    }

    /// How many equal weights would scatter as much (Kish 1965; Kong 1992).
    fn effective(&self) -> f64 {
        if self.squares > 0.0 { self.sum * self.sum / self.squares } else { 0.0 }
    }

    fn largest_share(&self) -> f64 {
        if self.sum > 0.0 { 1.0 / self.sum } else { 0.0 }
    }
}

/// A probability by importance sampling, and how far to trust it.
#[derive(Clone, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct ImportanceEstimate {
    /// Number of runs.
    runs: u64,
    /// Number of runs that are the event.
    hits: u64,
    /// The estimate of the probability. Not clipped: with bad weights it may exceed 1.
    probability: f64,
    /// Its standard error over the estimate; none without a hit.
    coefficient_of_variation: Option<f64>,
    /// The interval, which ends at 1 unless the estimate is above it; from 0 to 1 without a hit.
    interval: Interval,
    /// How many hits of equal weight would be worth as much, `(Σ w)²/Σ w²` over hits.
    effective_hits: f64,
    /// The same over all runs: it says how well other things than this event are known from these runs.
    effective_runs: f64,
    /// The part of the estimate that its largest weight makes up.
    largest_share: f64,
    /// The mean of all weights, 1 in the long run.
    mean_weight: f64,
    #[getset(skip)]
    warnings: Vec<WeightWarning>,
}

crate::checked::checked!(ImportanceEstimate, |read| {
    crate::error::belong(
        read.hits <= read.runs
            && read.coefficient_of_variation.is_none_or(|x| x >= 0.0)
            && (0.0..=1.0).contains(&read.largest_share)
            && read.probability >= 0.0
            && read.effective_hits >= 0.0
            && read.effective_runs >= 0.0
            && read.mean_weight >= 0.0,
        "estimate",
    )
});

/// Why weighted runs should not be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum WeightWarning {
    /// No run is the event: nothing is known of its probability.
    NoHit,
    /// The hits are worth so few of equal weight, below 20.
    FewEffectiveHits {
        /// How many.
        effective: f64,
    },
    /// One hit makes up so much of the estimate, a fifth or more: another such run may change it by as much.
    OneHitDominates {
        /// Its share of the estimate.
        share: f64,
    },
    /// The mean of all weights is above 1 by more than four standard errors: they are not the ratio of two normalised densities.
    MeanWeightAboveOne {
        /// The mean.
        mean: f64,
    },
}

impl ImportanceEstimate {
    /// Why not to trust the estimate, as far as the runs can show it.
    pub fn warnings(&self) -> &[WeightWarning] {
        &self.warnings
    }

    fn seen(&self) -> Vec<WeightWarning> {
        let mut warnings = Vec::new();
        if self.effective_hits == 0.0 {
            warnings.push(WeightWarning::NoHit);
        } else if self.effective_hits < FEW {
            warnings.push(WeightWarning::FewEffectiveHits { effective: self.effective_hits });
        }
        if self.largest_share >= DOMINANT {
            warnings.push(WeightWarning::OneHitDominates { share: self.largest_share });
        }
        let n = self.runs as f64;
        let spread =
            ((n / self.effective_runs.max(f64::MIN_POSITIVE) - 1.0).max(0.0) / (n - 1.0)).sqrt();
        // Rounding of weights that are all 1 is no warning.
        if self.mean_weight * (1.0 - 4.0 * spread) > 1.0 + 1e-9 {
            warnings.push(WeightWarning::MeanWeightAboveOne { mean: self.mean_weight });
        }
        warnings
    }
}

#[cfg(test)]
mod tests;
