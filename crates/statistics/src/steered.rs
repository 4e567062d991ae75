//! The probability of a rare event from normal scores that are drawn where the event is less rare.

mod fit;
mod score_law;
mod search;

pub use score_law::ScoreLaw;
pub use search::ScoreSearch;

use score_law::OWN;

use crate::{
    Confidence, ImportanceEstimate, ImportanceSampling, Interval, Proportion, StatisticsError,
    WeightWarning, importance::RARE,
};

/// So many standard errors between what two searches make of the event are no chance.
const APART: f64 = 4.0;
/// Differences below this factor are of no concern.
const ALIKE: f64 = 1.15;

/// Importance sampling in normal scores: from a law that searches have found, with exact weights.
///
/// Each input that is the image of a standard normal score can be drawn from another law of this score, whatever law the input has:
/// the weight of a run is the density of its scores under the standard normal law over that under the law which they were drawn
/// from. What else a run draws keeps its law, and has no part in the weight.
///
/// Independent [searches](ScoreSearch) find where the event is; the sample is drawn from the mixture of what all of them found and
/// a tenth of the own law, so that no weight is above 10. What one of them found alone can therefore not be lost, and shows: if they
/// tell different probabilities, there are several ways to the event, and perhaps more than both have found.
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
///     let choice = uniform(number, 3);
///     law.draw(choice, &mut scores);
///     (choice, scores)
/// };
/// let mut searches = [ScoreSearch::new(3, 500)?, ScoreSearch::new(3, 500)?];
/// for search in &mut searches {
///     while !search.is_done() {
///         let runs = (0..search.asks()).map(|_| run(search.law()).1);
///         let runs: Vec<(Vec<f64>, f64)> = runs.map(|scores| (scores.clone(), excess(&scores))).collect();
///         search.tell(&runs)?;
///     }
/// }
/// let mut sample = SteeredSampling::new(&searches)?;
/// for _ in 0..2000 {
///     let (choice, scores) = run(sample.law());
///     sample.push(choice, &scores, excess(&scores))?;
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
    /// The law of those draws that are of what a search found, or of the own law.
    of_search: Vec<ScoreLaw>,
    /// For each part of the law the search that found it; none for the own law.
    searches: Vec<Option<usize>>,
    not_reached: usize,
    evaluations: u64,
    without_excess: u64,
    hits: ImportanceSampling,
    hits_of_search: Vec<ImportanceSampling>,
}

impl SteeredSampling {
    /// Of searches that are done.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::TooFew`] without a search or if one is not done, [`StatisticsError::Columns`] if they are of different numbers
    /// of scores.
    pub fn new(searches: &[ScoreSearch]) -> Result<Self, StatisticsError> {
        let first = searches.first().ok_or(StatisticsError::TooFew { n: 0, required: 1 })?;
        if let Some(search) = searches.iter().find(|search| !search.is_done()) {
            let n = usize::try_from(search.evaluations()).unwrap_or(usize::MAX);
            return Err(StatisticsError::TooFew { n, required: n.saturating_add(search.asks()) });
        }
        let scores = first.law().scores();
        for search in searches {
            crate::rank_correlation::same_length(scores, search.law().scores())?;
        }
        let laws: Vec<ScoreLaw> = searches.iter().map(|search| search.law().clone()).collect();
        let (law, of_part) = ScoreLaw::together(&laws, OWN);
        let hits = ImportanceSampling::new();
        Ok(Self {
            not_reached: searches.iter().filter(|search| !search.reached()).count(),
            evaluations: searches.iter().map(ScoreSearch::evaluations).sum(),
            without_excess: searches.iter().map(ScoreSearch::without_excess).sum(),
            hits,
            hits_of_search: vec![hits; searches.len()],
            of_search: (0..searches.len())
                .map(|i| law.of_parts(|part| of_part[part].is_none_or(|of| of == i)))
                .collect(),
            law,
            searches: of_part,
        })
    }

    /// Adds a run: the number between 0 and 1 by which the part of the law was chosen, its scores, and how far it is beyond the limit. The
    /// event is an excess of 0 or more; NaN is a run that has none, as one that failed, and is not the event.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Columns`] if there are not as many scores as the law has, [`StatisticsError::LogWeight`] if one is not finite.
    pub fn push(
        &mut self,
        choice: f64,
        scores: &[f64],
        excess: f64,
    ) -> Result<(), StatisticsError> {
        crate::rank_correlation::same_length(self.law.scores(), scores.len())?;
        let (log_weight, hit) = (self.law.log_weight(scores), excess >= 0.0);
        self.hits.push(log_weight, hit)?;
        // A run from the own law serves every search.
        let of_part = self.searches.get(self.law.part(choice)).copied().flatten();
        for (i, (law, hits)) in self.of_search.iter().zip(&mut self.hits_of_search).enumerate() {
            if of_part.is_none_or(|search| search == i) {
                hits.push(law.log_weight(scores), hit)?;
            }
        }
        self.evaluations += 1;
        self.without_excess += u64::from(excess.is_nan());
        Ok(())
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
        let apart = self.apart(confidence);
        warnings.extend(apart.map(|[one, other]| SteeredWarning::SearchesDiffer { one, other }));
        warnings.extend(weighted.warnings().iter().copied().map(SteeredWarning::Weights));
        let (lower, upper) = if weighted.hits() > 0 {
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

    /// What two searches tell of the event, the most different ones, if that is no chance.
    fn apart(&self, confidence: Confidence) -> Option<[f64; 2]> {
        let told = self.hits_of_search.iter().filter_map(|hits| hits.finish(confidence).ok());
        // Where each search found as much elsewhere, all together tell more than any of them.
        let told: Vec<(f64, f64)> = told
            .chain(self.hits.finish(confidence).ok())
            .map(|found| (found.probability(), found.coefficient_of_variation().unwrap_or(1.0)))
            .collect();
        let mut worst = None;
        for (i, one) in told.iter().enumerate() {
            for other in &told[..i] {
                let difference = (one.0 - other.0).abs();
                let error = (one.0 * one.1).hypot(other.0 * other.1);
                let (low, high) = (one.0.min(other.0), one.0.max(other.0));
                let z = difference / error;
                if high > ALIKE * low && z > APART && worst.is_none_or(|(before, _)| z > before) {
                    worst = Some((z, [low, high]));
                }
            }
        }
        worst.map(|(_, told)| told)
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
    /// Runs where one search led tell another probability than runs where another led, or than all runs together, by more than four
    /// standard errors: the searches have found different ways to the event.
    SearchesDiffer {
        /// The smaller probability.
        one: f64,
        /// The larger.
        other: f64,
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
