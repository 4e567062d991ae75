//! A search for one way, or several, to an event: the cross-entropy method, led by what is not known of the event yet.

use super::{
    fit::{self, Elite},
    score_law::{LogParts, OWN, ScoreLaw, Single, Tail},
};
use crate::{StatisticsError, error::share};

/// One run in so many leads on.
const PART: f64 = 10.0;
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
const ENOUGH: f64 = 30.0;
/// So few lead on if the level would fall otherwise.
const FEWEST_ELITES: f64 = 10.0;
/// Fewest runs of a level.
const FEWEST: usize = 100;
/// Of what a search found at least such a part is drawn.
const FEWEST_DRAWN: f64 = 0.05;
/// So many standard errors are added to what is left.
const ERRORS: f64 = 2.0;
/// Runs that tell less of a level than this share of what those before told have lost a way.
const LOST: f64 = 0.3;
/// A share of the probability that is not worth a search.
const NEGLIGIBLE: f64 = 0.02;

/// A search for the law of scores under which what is not known of an event is least rare.
///
/// A run that the laws of earlier searches explain counts little: with the probability that it would be from the own law if it were drawn from
/// their mixture, in which the own law has a tenth. That is a tenth of its weight, so that what a search looks for is what would make the
/// estimate scatter. Without an earlier search each run counts 1.
#[derive(Clone, Debug)]
pub(super) struct WaySearch {
    /// How many runs a level has.
    pub(super) per_level: usize,
    least: f64,
    known: Option<Known>,
    /// The law of each score from which the search starts.
    start: Vec<Single>,
    /// The law that their scores are to be drawn from; in the end, the law that was found.
    pub(super) law: ScoreLaw,
    stage: Stage,
    /// The largest excess that a tenth of the runs of some level had, 0 at most; minus infinity before the first.
    level: f64,
    /// Number of levels that were done.
    levels: usize,
    stalled: usize,
    /// What the last level told of the probability of what is not known yet.
    probability: f64,
}

/// What earlier searches have found.
#[derive(Clone, Debug)]
struct Known {
    /// A tenth of the own law, and their laws.
    law: ScoreLaw,
    /// What they told of the probability.
    probability: f64,
}

/// Where a search stands.
#[derive(Clone, Debug, PartialEq)]
enum Stage {
    /// On the way.
    Rising,
    /// The event is not rare any more; the law is fitted to it.
    Fitting,
    Done(Ended),
}

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ended {
    /// It came to the event.
    Reached,
    /// It did not, or it lost its way.
    NotReached,
    /// What is not known of the event is too little to matter.
    NothingMore,
}

/// A run of a level.
struct Told<'a> {
    scores: &'a [f64],
    excess: f64,
    /// How far it counts, from 0 to 1.
    counts: f64,
    /// The weight with which it is of what is not known.
    weight: f64,
}

impl<'a> Told<'a> {
    /// A run of a law, and the law of what is known.
    fn new(
        scores: &'a [f64],
        excess: f64,
        own: &LogParts,
        known: Option<&LogParts>,
    ) -> Result<Self, StatisticsError> {
        let weight_of = |law: &LogParts| {
            let log = law.log_weight(scores);
            let unfit = scores.iter().copied().chain([log]).find(|x| !x.is_finite());
            match unfit {
                Some(value) => Err(StatisticsError::LogWeight { value, most: -OWN.ln() }),
                None => Ok(libm::exp(log)),
            }
        };
        let counts = match known {
            Some(known) => OWN * weight_of(known)?,
            None => 1.0,
        };
        let excess = excess.max(f64::NEG_INFINITY);
        Ok(Self { scores, excess, counts, weight: counts * weight_of(own)? })
    }
}

impl WaySearch {
    /// It gives up after so many levels.
    pub(super) const MOST_LEVELS: usize = 25;

    /// As [`ScoreSearch::new`](super::ScoreSearch::new).
    pub(super) fn new(scores: usize, per_level: usize) -> Result<Self, StatisticsError> {
        if !(scores >= 1 && per_level >= FEWEST && scores.saturating_mul(per_level) <= MOST) {
            return Err(StatisticsError::SearchPlan { scores, per_level });
        }
        Ok(Self {
            per_level,
            least: LEAST,
            known: None,
            start: vec![Single::OWN; scores],
            law: ScoreLaw::own(scores),
            stage: Stage::Rising,
            level: f64::NEG_INFINITY,
            levels: 0,
            stalled: 0,
            probability: 0.0,
        })
    }

    /// The same where nothing is known of events that scores decide: it begins with plain runs.
    pub(super) fn plain(&self) -> Self {
        let scores = self.start.len();
        Self { start: vec![Single::OWN; scores], law: ScoreLaw::own(scores), ..self.clone() }
    }

    /// As [`ScoreSearch::with_least`](super::ScoreSearch::with_least).
    pub(super) fn with_least(self, least: f64) -> Result<Self, StatisticsError> {
        Ok(Self { least: share(least)?, ..self })
    }

    /// As [`ScoreSearch::with_events`](super::ScoreSearch::with_events).
    pub(super) fn with_events(mut self, events: &[(usize, f64)]) -> Result<Self, StatisticsError> {
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

    /// For what these searches have not found.
    pub(super) fn beyond(mut self, searches: &[Self]) -> Self {
        let reached: Vec<&Self> = searches.iter().filter(|search| search.reached()).collect();
        let further = reached.iter().filter(|search| search.is_further());
        let further: f64 = further.map(|search| search.probability).sum();
        // Those that knew nothing are of the whole event; the least makes the others look longest.
        let whole = reached.iter().filter(|search| !search.is_further());
        let whole = whole.map(|search| search.probability).min_by(f64::total_cmp);
        self.known = (!reached.is_empty()).then(|| Known {
            law: Self::together(&reached),
            probability: whole.unwrap_or(0.0) + further,
        });
        self
    }

    /// A tenth of the own law, and what searches found, as they told of its probability, but none too rarely.
    pub(super) fn together(searches: &[&Self]) -> ScoreLaw {
        let all: f64 = searches.iter().map(|search| search.probability).sum();
        let laws = searches.iter().map(|search| {
            let share = if all > 0.0 { search.probability / all } else { 1.0 };
            (share.max(FEWEST_DRAWN), &search.law)
        });
        ScoreLaw::together(laws, OWN)
    }

    /// Takes the runs of a level, if it is not done: the scores of each, and how far it is beyond the limit.
    pub(super) fn tell(&mut self, runs: &[(Vec<f64>, f64)]) -> Result<(), StatisticsError> {
        crate::rank_correlation::same_length(self.per_level, runs.len())?;
        let known = self.known.as_ref().map(|known| known.law.log_parts());
        let own = self.law.log_parts();
        let told = runs.iter().map(|(scores, excess)| {
            crate::rank_correlation::same_length(self.law.scores(), scores.len())?;
            Told::new(scores, *excess, &own, known.as_ref())
        });
        let told = told.collect::<Result<Vec<_>, _>>()?;
        self.levels += 1;
        let n = self.per_level as f64;
        let Some(level) = self.next_level(&told) else {
            self.stalled += 1;
            if self.stalled >= MOST_STALLED {
                self.stage = Stage::Done(Ended::NotReached);
            }
            return Ok(());
        };
        let elites: Vec<Elite<'_>> = told
            .iter()
            .filter(|run| run.excess >= level)
            .map(|run| Elite { scores: run.scores, weight: run.weight })
            .collect();
        // What these runs tell of the level before: much less than those of that level told if the law has lost a way on the way.
        let before = told.iter().filter(|run| run.excess >= self.level).map(|run| run.weight);
        let is_lost = self.levels > 1 && before.sum::<f64>() / n < LOST * self.probability;
        let (mut sum, mut squares, mut largest) = (0.0, 0.0, 0.0_f64);
        for Elite { weight, .. } in &elites {
            sum += weight;
            squares += weight * weight;
            largest = largest.max(*weight);
        }
        // One weight that is far too large must not hide what is left.
        self.probability = (sum - largest) / n;
        let at_most = (sum + ERRORS * squares.sqrt()) / n;
        let higher = level > self.level;
        self.stalled = if higher { 0 } else { self.stalled + 1 };
        // What is not known of the event is not more than what is not known at this level.
        let (is_nothing, is_too_rare) = match &self.known {
            Some(known) => (at_most < NEGLIGIBLE * known.probability, false),
            None => (false, self.probability < self.least),
        };
        self.stage = match self.stage {
            Stage::Fitting => Stage::Done(Ended::Reached),
            Stage::Rising if is_nothing && is_lost => Stage::Done(Ended::NotReached),
            Stage::Rising if is_nothing => Stage::Done(Ended::NothingMore),
            Stage::Rising if level >= 0.0 => Stage::Fitting,
            Stage::Rising
                if self.stalled >= MOST_STALLED
                    || self.levels >= Self::MOST_LEVELS
                    || is_too_rare =>
            {
                Stage::Done(Ended::NotReached)
            }
            Stage::Rising => Stage::Rising,
            Stage::Done(ended) => Stage::Done(ended),
        };
        self.level = self.level.max(level);
        if let Some(others) =
            fit::fit(&elites, &self.start, &self.law.others(), self.stage == Stage::Rising)
        {
            self.law = ScoreLaw::mixed(self.law.scores(), OWN, others);
        }
        Ok(())
    }

    /// How it ended.
    pub(super) fn ended(&self) -> Option<Ended> {
        match self.stage {
            Stage::Done(ended) => Some(ended),
            Stage::Rising | Stage::Fitting => None,
        }
    }

    /// Whether it came to the event.
    pub(super) fn reached(&self) -> bool {
        self.ended() == Some(Ended::Reached)
    }

    /// Whether it looked for what other searches had not found.
    pub(super) fn is_further(&self) -> bool {
        self.known.is_some()
    }

    /// The excess that a tenth of the runs have, or the least that not all have; 0 at most, and none if all runs are alike. No less
    /// than before, and the event itself, as soon as enough runs have it. All runs as far as they count.
    fn next_level(&self, runs: &[Told<'_>]) -> Option<f64> {
        let mut highest: Vec<&Told<'_>> = runs.iter().collect();
        highest.sort_by(|a, b| b.excess.total_cmp(&a.excess));
        let least = highest.last()?.excess;
        let all: f64 = runs.iter().map(|run| run.counts).sum();
        let that_have = |count: f64| {
            let mut sum = 0.0;
            let found = highest.iter().find(|run| {
                sum += run.counts;
                sum >= count
            });
            found.map_or(least, |run| run.excess)
        };
        let enough = that_have(ENOUGH);
        if enough >= 0.0 {
            return Some(0.0);
        }
        let tenth = that_have((all / PART).floor().max(1.0));
        let level = if self.known.is_some() { tenth.max(self.further(&highest)) } else { tenth };
        if level > self.level && level > least {
            return Some(level.min(0.0));
        }
        // Where few runs can come nearer, because others draw what no score leads to, these few lead on.
        if enough > least {
            return Some(enough.max(self.level.min(that_have(FEWEST_ELITES))));
        }
        let lowest = highest.iter().rev().map(|run| run.excess);
        lowest.into_iter().find(|excess| *excess > least).map(|excess| excess.min(0.0))
    }

    /// The excess beyond which is a tenth of the probability that is not known at the level before, from enough runs of equal weight: runs at
    /// the foot of a known way are many, and none of them leads to what is not known of the event.
    fn further(&self, highest: &[&Told<'_>]) -> f64 {
        let beyond = highest.iter().take_while(|run| run.excess >= self.level);
        let all: f64 = beyond.map(|run| run.weight).sum();
        let (mut sum, mut squares) = (0.0, 0.0);
        let found = highest.iter().find(|run| {
            sum += run.weight;
            squares += run.weight * run.weight;
            PART * sum >= all && sum * sum >= FEWEST_ELITES * squares
        });
        let found = found.map_or(f64::NEG_INFINITY, |run| run.excess);
        // Excesses may be few, as counts of failures are.
        let next = highest.iter().rev().find(|run| run.excess > self.level);
        found.max(next.map_or(f64::NEG_INFINITY, |run| run.excess))
    }
}
