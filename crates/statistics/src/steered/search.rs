//! A search for the law of scores under which an event is least rare: the cross-entropy method.

use super::{
    fit::{self, Elite},
    score_law::{OWN, ScoreLaw, Single, Tail},
};
use crate::{StatisticsError, error::share};

/// One run in so many leads on.
const PART: usize = 10;
/// So many levels in a row that are no higher end a search.
const MOST_STALLED: usize = 3;
/// The probability below which a search gives up, unless told otherwise.
const LEAST: f64 = 1e-9;
/// Most scores, runs of a level, and scores of all runs of a level.
const MOST: usize = 100_000_000;
/// So many events does a run have at the start, if it may have some, and none of them more often than this.
const STARTING: f64 = 0.5;
const OFTEN_AT_FIRST: f64 = 0.1;
/// So many runs that are the event are enough to fit a law to.
const ENOUGH: usize = 30;
/// So few lead on if the level would fall otherwise.
const FEWEST_ELITES: usize = 10;
/// Fewest runs of a level.
const FEWEST: usize = 100;

/// A search for the law of scores under which an event is least rare, by the cross-entropy method (Rubinstein & Kroese 2004,
/// doi:10.1007/978-1-4757-4321-0), in steps: it asks for runs, which may be done in any order, and is told their outcomes.
///
/// The first level has plain runs. The tenth of them that comes nearest to the event leads on: the next law is fitted to
/// their scores, weighted as the own law has them, and a tenth of the own law is kept. Fewer lead on, 30, where a tenth comes no nearer: where most
/// runs draw what no score leads to. Level by level the runs come nearer, until 30 or more are the event. Two last levels then fit
/// the law to all runs that are the event.
///
/// What is fitted is one normal law or a mixture of up to twelve, with independent scores: several, where the likelihood says that there
/// are several ways, as to both limits of an absolute value. Standard deviations are kept between 0.3 and 3, and stay 1 unless they are surely
/// another; means are shrunk by what they owe to chance (James & Stein 1961).
#[derive(Clone, Debug, getset::CopyGetters, getset::Getters)]
pub struct ScoreSearch {
    per_level: usize,
    least: f64,
    /// The law of each score from which the search starts.
    start: Vec<Single>,
    /// The law that their scores are to be drawn from; in the end, the law that was found.
    #[getset(get = "pub")]
    law: ScoreLaw,
    stage: Stage,
    /// The largest excess that a tenth of the runs of some level had, 0 at most; minus infinity before the first.
    #[getset(get_copy = "pub")]
    level: f64,
    /// Number of levels that were done.
    #[getset(get_copy = "pub")]
    levels: usize,
    stalled: usize,
    /// Number of runs that were done.
    #[getset(get_copy = "pub")]
    evaluations: u64,
    /// How many of them had no excess.
    #[getset(get_copy = "pub")]
    without_excess: u64,
}

/// Where a search stands.
#[derive(Clone, Debug, PartialEq)]
enum Stage {
    /// On the way.
    Rising,
    /// The event is not rare any more; the law is fitted to it.
    Fitting,
    Done {
        reached: bool,
    },
}

impl ScoreSearch {
    /// It gives up after so many levels.
    pub const MOST_LEVELS: usize = 25;

    /// With so many scores, and runs of a level.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::SearchPlan`] unless there are 1 score and 100 runs or more, and 10⁸ scores of a level at most.
    pub fn new(scores: usize, per_level: usize) -> Result<Self, StatisticsError> {
        if !(scores >= 1 && per_level >= FEWEST && scores.saturating_mul(per_level) <= MOST) {
            return Err(StatisticsError::SearchPlan { scores, per_level });
        }
        Ok(Self {
            per_level,
            least: LEAST,
            start: vec![Single::OWN; scores],
            law: ScoreLaw::own(scores),
            stage: Stage::Rising,
            level: f64::NEG_INFINITY,
            levels: 0,
            stalled: 0,
            evaluations: 0,
            without_excess: 0,
        })
    }

    /// Gives up below this probability; below 1e-9 else.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Share`] unless it lies between 1e-9 and 1 − 1e-9.
    pub fn with_least(self, least: f64) -> Result<Self, StatisticsError> {
        Ok(Self { least: share(least)?, ..self })
    }

    /// Of scores in these places is known that they decide events: that of a probability happens where the score is in its upper tail of this
    /// probability. Then the event itself is made more frequent, and from the first level on.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Probability`] unless it lies strictly between 0 and 1, [`StatisticsError::Columns`] if there is no such place.
    pub fn with_events(mut self, events: &[(usize, f64)]) -> Result<Self, StatisticsError> {
        for &(place, value) in events {
            if !(value > 0.0 && value < 1.0) {
                return Err(StatisticsError::Probability { value });
            }
            let scores = self.start.len();
            let columns =
                StatisticsError::Columns { first: scores, second: place.saturating_add(1) };
            let start = self.start.get_mut(place).ok_or(columns)?;
            let tail = Tail::new(value);
            let often = (STARTING / events.len() as f64).min(OFTEN_AT_FIRST);
            *start = Single::Tail(Tail { chance: value.max(often), ..tail });
        }
        if !events.is_empty() {
            let others = vec![(1.0, self.start.clone())];
            self.law = ScoreLaw::mixed(self.start.len(), OWN, others);
        }
        Ok(self)
    }

    /// How many runs are wanted next; none if it is done.
    pub fn asks(&self) -> usize {
        if self.is_done() { 0 } else { self.per_level }
    }

    /// Takes the runs that were asked for: the scores of each, and how far it is beyond the limit. The event is an excess of 0 or
    /// more; NaN is a run that has no excess, as one that failed.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Columns`] if they are not as many as were asked for, or have not as many scores as the law,
    /// [`StatisticsError::LogWeight`] if a score is not finite.
    pub fn tell(&mut self, runs: &[(Vec<f64>, f64)]) -> Result<(), StatisticsError> {
        crate::rank_correlation::same_length(self.asks(), runs.len())?;
        let mut weights = Vec::with_capacity(runs.len());
        for (scores, _) in runs {
            crate::rank_correlation::same_length(self.law.scores(), scores.len())?;
            let value = self.law.log_weight(scores);
            if !value.is_finite() {
                return Err(StatisticsError::LogWeight { value, most: -OWN.ln() });
            }
            weights.push(libm::exp(value));
        }
        if self.is_done() {
            return Ok(());
        }
        self.levels += 1;
        self.evaluations += runs.len() as u64;
        self.without_excess += runs.iter().filter(|run| run.1.is_nan()).count() as u64;
        let Some(level) = self.next_level(runs) else {
            self.stalled += 1;
            if self.stalled >= MOST_STALLED {
                self.stage = Stage::Done { reached: false };
            }
            return Ok(());
        };
        let elites: Vec<Elite<'_>> = runs
            .iter()
            .zip(&weights)
            .filter(|((_, excess), _)| *excess >= level)
            .map(|((scores, _), weight)| Elite { scores, weight: *weight })
            .collect();
        let probability =
            elites.iter().map(|elite| elite.weight).sum::<f64>() / self.per_level as f64;
        let higher = level > self.level;
        self.stalled = if higher { 0 } else { self.stalled + 1 };
        self.stage = match self.stage {
            Stage::Fitting => Stage::Done { reached: true },
            Stage::Rising if level >= 0.0 => Stage::Fitting,
            Stage::Rising
                if self.stalled >= MOST_STALLED
                    || self.levels >= Self::MOST_LEVELS
                    || probability < self.least =>
            {
                Stage::Done { reached: false }
            }
            Stage::Rising => Stage::Rising,
            Stage::Done { reached } => Stage::Done { reached },
        };
        self.level = self.level.max(level);
        if let Some(others) =
            fit::fit(&elites, &self.start, &self.law.others(), self.stage == Stage::Rising)
        {
            self.law = ScoreLaw::mixed(self.law.scores(), OWN, others);
        }
        Ok(())
    }

    /// Whether nothing more is asked for.
    pub fn is_done(&self) -> bool {
        matches!(self.stage, Stage::Done { .. })
    }

    /// Whether it came to the event.
    pub fn reached(&self) -> bool {
        matches!(self.stage, Stage::Done { reached: true })
    }

    /// The excess that a tenth of the runs have, or the least that not all have; 0 at most, and none if all runs are alike. No less
    /// than before, and the event itself, as soon as enough runs have it.
    fn next_level(&self, runs: &[(Vec<f64>, f64)]) -> Option<f64> {
        let mut excesses: Vec<f64> = runs.iter().map(|run| run.1.max(f64::NEG_INFINITY)).collect();
        excesses.sort_unstable_by(|a, b| b.total_cmp(a));
        let enough = *excesses.get(ENOUGH - 1)?;
        if enough >= 0.0 {
            return Some(0.0);
        }
        let (level, least) = (excesses[excesses.len() / PART - 1], *excesses.last()?);
        if level > self.level && level > least {
            return Some(level);
        }
        // Where few runs can come nearer, because others draw what no score leads to, these few lead on.
        if enough > least {
            return Some(enough.max(self.level.min(excesses[FEWEST_ELITES - 1])));
        }
        excesses.into_iter().rev().find(|excess| *excess > least).map(|excess| excess.min(0.0))
    }
}
