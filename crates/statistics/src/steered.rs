//! The probability of a rare event from normal scores that are drawn where the event is less rare.

mod fit;
mod score_law;
mod search;
mod way;

pub use score_law::ScoreLaw;
pub use search::ScoreSearch;

use score_law::{LogParts, OWN};

use crate::{
    Confidence, ImportanceEstimate, ImportanceSampling, Interval, Proportion, StatisticsError,
    WeightWarning, importance::RARE,
};

/// Importance sampling in normal scores: from a law that searches have found, with exact weights.
///
/// Each input that is the image of a standard normal score can be drawn from another law of this score, whatever law the input has:
/// the weight of a run is the density of its scores under the standard normal law over that under the law which they were drawn
/// from. What else a run draws keeps its law, and has no part in the weight.
///
/// A [search](ScoreSearch) finds where the event is, way by way, until nothing is left of it that matters; the sample is drawn from the
/// mixture of what it found and a tenth of the own law, so that no weight is above 10.
///
/// ```
/// use gyradius_statistics::{Confidence, ScoreSearch, SteeredSampling, tail};
///
/// // Standard normal scores: here the midpoints of even cells, shuffled by a multiplication.
/// let uniform = |i: u64, place: u64| {
///     let mut x = (i << 8 | place).wrapping_mul(0x9e37_79b9_7f4a_7c15);
///     x = (x ^ x >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93);
///     x = (x ^ x >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93);
///     (((x ^ x >> 32) >> 12) as f64 + 0.5) * 2_f64.powi(-52)
/// };
/// let normal = |i: u64, place: u64| {
///     let angle = std::f64::consts::TAU * uniform(i, place);
///     (-2.0 * uniform(i, place + 100).ln()).sqrt() * angle.cos()
/// };
/// // How often is the sum of three scores above 9?
/// let excess = |scores: &[f64]| scores.iter().sum::<f64>() - 9.0;
/// let mut number = 0;
/// let mut run = |law: &gyradius_statistics::ScoreLaw| {
///     number += 1;
///     let mut scores = [0, 1, 2].map(|place| normal(number, place)).to_vec();
///     law.draw(uniform(number, 3), &mut scores);
///     scores
/// };
/// let mut search = ScoreSearch::new(3, 500)?;
/// while !search.is_done() {
///     let runs = (0..search.asks()).map(|_| run(search.law()));
///     let runs: Vec<(Vec<f64>, f64)> = runs.map(|scores| (scores.clone(), excess(&scores))).collect();
///     search.tell(&runs)?;
/// }
/// let mut sample = SteeredSampling::new(&search)?;
/// for _ in 0..2000 {
///     let scores = run(sample.law());
///     sample.push(&scores, excess(&scores))?;
/// }
/// let estimate = sample.finish(Confidence::default())?;
/// assert!(estimate.interval().contains(tail::normal(9.0 / 3_f64.sqrt())), "{estimate:?}");
/// assert!(estimate.warnings().is_empty());
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Clone, Debug, getset::Getters)]
pub struct SteeredSampling {
    /// The law that scores are to be drawn from.
    #[getset(get = "pub")]
    law: ScoreLaw,
    log_parts: LogParts,
    not_reached: usize,
    unsettled: Option<usize>,
    evaluations: u64,
    without_excess: u64,
    hits: ImportanceSampling,
}

impl SteeredSampling {
    /// Of a search that is done.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] if it is not.
    pub fn new(search: &ScoreSearch) -> Result<Self, StatisticsError> {
        if !search.is_done() {
            let n = usize::try_from(search.evaluations()).unwrap_or(usize::MAX);
            return Err(StatisticsError::TooFew { n, required: n.saturating_add(search.asks()) });
        }
        Ok(Self {
            law: search.law().clone(),
            log_parts: search.law().log_parts(),
            not_reached: search.not_reached(),
            unsettled: search.unsettled(),
            evaluations: search.evaluations(),
            without_excess: search.without_excess(),
            hits: ImportanceSampling::new(),
        })
    }

    /// Adds a run: its scores, and how far it is beyond the limit. Returns the natural logarithm of its weight. The event is an excess of 0 or more; NaN is a run that has none, as
    /// one that failed, and is not the event.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Columns`] if there are not as many scores as the law has, [`StatisticsError::LogWeight`] if one is not finite.
    pub fn push(&mut self, scores: &[f64], excess: f64) -> Result<f64, StatisticsError> {
        crate::rank_correlation::same_length(self.law.scores(), scores.len())?;
        // The own law weighs them without a look at them.
        if let Some(&value) = scores.iter().find(|x| !x.is_finite()) {
            return Err(StatisticsError::LogWeight { value, most: -OWN.ln() });
        }
        let log_weight = self.log_parts.log_weight(scores);
        self.hits.push(log_weight, excess >= 0.0)?;
        self.evaluations += 1;
        self.without_excess += u64::from(excess.is_nan());
        Ok(log_weight)
    }

    /// What the runs show.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] below two runs.
    pub fn finish(&self, confidence: Confidence) -> Result<SteeredEstimate, StatisticsError> {
        let weighted = self.hits.finish(confidence)?;
        let (probability, coefficient_of_variation) = self.probability(&weighted, confidence)?;
        let mut warnings = Vec::new();
        if self.not_reached > 0 {
            warnings.push(SteeredWarning::NotReached { searches: self.not_reached });
        }
        warnings.extend(self.unsettled.map(|searches| SteeredWarning::MoreWays { searches }));
        warnings.extend(weighted.warnings().iter().copied().map(SteeredWarning::Weights));
        let (lower, upper) = if self.law.is_own() {
            // Plain runs, of which the interval is exact.
            let plain = Proportion::new(weighted.hits(), weighted.runs())?.interval(confidence);
            (plain.lower(), plain.upper())
        } else if weighted.hits() > 0 {
            (weighted.interval().lower(), weighted.interval().upper())
        } else {
            // No hit in so many runs, and no weight is larger than this.
            let none = Proportion::new(0, weighted.runs())?.interval(confidence);
            (0.0, none.upper() / self.law.share_of_own())
        };
        let (lower, upper) = (lower.min(probability), upper.clamp(probability, 1.0));
        let interval = Interval::ordered(lower, upper, confidence);
        Ok(SteeredEstimate {
            interval,
            evaluations: self.evaluations,
            without_excess: self.without_excess,
            probability,
            coefficient_of_variation,
            warnings,
            weighted,
        })
    }

    /// The estimate and its standard error over it. Above a half they are those of the runs that miss the event: these scatter less, and
    /// what they leave of 1 is no more than 1.
    fn probability(
        &self,
        weighted: &ImportanceEstimate,
        confidence: Confidence,
    ) -> Result<(f64, Option<f64>), StatisticsError> {
        let told = weighted.probability();
        if told <= RARE {
            return Ok((told, weighted.coefficient_of_variation()));
        }
        let misses = self.hits.of_complement().finish(confidence)?;
        let (missed, rest) = (misses.probability(), 1.0 - misses.probability());
        if rest <= 0.0 {
            return Ok((told.min(1.0), weighted.coefficient_of_variation()));
        }
        let error = missed * misses.coefficient_of_variation().unwrap_or(0.0);
        Ok((rest, Some(error / rest)))
    }
}

/// A probability by importance sampling in scores, and how far to trust it.
#[derive(Clone, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub struct SteeredEstimate {
    /// The estimate of the probability: the mean weight of the runs that are the event, and above a half what those that are not leave of 1.
    #[getset(get_copy = "pub")]
    probability: f64,
    /// The interval. Without a hit, from 0 to a bound that holds whatever the event is, for no weight is above 10; it is not small.
    #[getset(get_copy = "pub")]
    interval: Interval,
    /// Its standard error over the estimate; none without a hit.
    #[getset(get_copy = "pub")]
    coefficient_of_variation: Option<f64>,
    /// Number of runs that were done, those of the searches and those without an excess too.
    #[getset(get_copy = "pub")]
    evaluations: u64,
    /// How many of them had no excess.
    #[getset(get_copy = "pub")]
    without_excess: u64,
    warnings: Vec<SteeredWarning>,
    /// The weighted runs of the sample.
    #[getset(get = "pub")]
    weighted: ImportanceEstimate,
}

crate::checked::checked!(SteeredEstimate, |read| {
    crate::error::belong(
        read.interval.contains(read.probability)
            && (0.0..=1.0).contains(&read.probability)
            && read.coefficient_of_variation.is_none_or(|x| x >= 0.0)
            && read.without_excess <= read.evaluations,
        "estimate",
    )
});

/// Why importance sampling in scores should not be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum SteeredWarning {
    /// So many searches did not come to the event: it cannot be, is rarer than the least probability, or needs what no score leads to.
    NotReached {
        /// How many.
        searches: usize,
    },
    /// So many searches left open whether there are more ways to the event than they found.
    MoreWays {
        /// How many.
        searches: usize,
    },
    /// What the weights show.
    #[cfg_attr(feature = "serde", serde(untagged))]
    Weights(WeightWarning),
}

impl SteeredEstimate {
    /// Why not to trust the estimate, as far as the runs can show it.
    pub fn warnings(&self) -> &[SteeredWarning] {
        &self.warnings
    }
}

#[cfg(test)]
mod tests;
