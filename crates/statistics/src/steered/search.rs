//! A search for the laws of scores under which an event is least rare: one way after the other.

use super::{
    score_law::ScoreLaw,
    way::{Ended, WaySearch},
};
use crate::StatisticsError;

/// Nothing is searched for if one of so many plain runs is the event.
const FREQUENT: usize = 10;
/// So many searches know nothing of each other.
const INDEPENDENT: usize = 2;
/// Most searches.
const MOST_SEARCHES: usize = 20;
/// So many searches have to say that nothing more is left where several ways were found.
const AGREEING: usize = 2;
/// After so many searches in a row that come to no answer it gives up.
const MOST_LOST: usize = 3;

/// A search for the law of scores under which an event is least rare, by the cross-entropy method (Rubinstein & Kroese 2004,
/// doi:10.1007/978-1-4757-4321-0), in steps: it asks for runs, which may be done in any order, and is told their outcomes.
///
/// The first level has plain runs. If a tenth of them are the event, it is not rare: the search ends, and nothing is steered. Else the tenth of them that comes nearest to the event leads on, where nothing is known of
/// events that scores decide: the next law is fitted to their scores, weighted as the own law has them, and a tenth of the own law is kept. Fewer lead on, 30, where a tenth comes no nearer: where most
/// runs draw what no score leads to. Level by level the runs come nearer, until 30 or more are the event. Two last levels then fit
/// the law to all runs that are the event.
///
/// What is fitted is one normal law or a mixture of up to twelve, with independent scores: several, where the likelihood says that there
/// are several ways, as to both limits of an absolute value. Standard deviations are kept between 0.3 and 3, and stay 1 unless they are surely
/// another; means are shrunk by what they owe to chance (James & Stein 1961).
///
/// **Two such searches know nothing of each other. Then it starts again for what neither has found.** A run counts there with the probability
/// that it would be from the own law if it were drawn from the mixture of a tenth of the own law and of all that was found: runs near a known
/// way hardly count, those of another way do. It ends
/// when so little of the probability is left that it does not matter, 2 % of what was found; where several ways were found, two searches
/// have to say so. A search that comes to no answer is done again, at most twice.
#[derive(Clone, Debug, getset::CopyGetters, getset::Getters)]
pub struct ScoreSearch {
    /// As each search begins.
    plan: WaySearch,
    done: Vec<WaySearch>,
    /// The one that is on the way.
    now: Option<WaySearch>,
    /// The law that scores are to be drawn from; in the end, the mixture of a tenth of the own law and of all that was found.
    #[getset(get = "pub")]
    law: ScoreLaw,
    /// Number of runs that were done.
    #[getset(get_copy = "pub")]
    evaluations: u64,
    /// How many of them had no excess.
    #[getset(get_copy = "pub")]
    without_excess: u64,
}

impl ScoreSearch {
    /// It takes no more levels where there is one way to the event.
    pub const LEVELS_OF_ONE_WAY: usize = 1 + (INDEPENDENT + 1) * WaySearch::MOST_LEVELS;

    /// With so many scores, and runs of a level.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::SearchPlan`] unless there are 1 score and 100 runs or more, and 10⁸ scores of a level at most.
    pub fn new(scores: usize, per_level: usize) -> Result<Self, StatisticsError> {
        Ok(Self::of(WaySearch::new(scores, per_level)?))
    }

    fn of(plan: WaySearch) -> Self {
        let plain = plan.plain();
        Self {
            law: plain.law.clone(),
            now: Some(plain),
            plan,
            done: Vec::new(),
            evaluations: 0,
            without_excess: 0,
        }
    }

    /// Gives up below this probability; below 1e-9 else.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Share`] unless it lies between 1e-9 and 1 − 1e-9.
    pub fn with_least(self, least: f64) -> Result<Self, StatisticsError> {
        Ok(Self::of(self.plan.with_least(least)?))
    }

    /// Of scores in these places is known that they decide events: that of a probability happens where the score is in its upper tail of this
    /// probability. Then the event itself is made more frequent, and from the second level on.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Probability`] unless it lies strictly between 0 and 1, [`StatisticsError::Columns`] if there is no such place.
    pub fn with_events(self, events: &[(usize, f64)]) -> Result<Self, StatisticsError> {
        Ok(Self::of(self.plan.with_events(events)?))
    }

    /// How many runs are wanted next; none if it is done.
    pub fn asks(&self) -> usize {
        self.now.as_ref().map_or(0, |now| now.per_level)
    }

    /// Takes the runs that were asked for: the scores of each, and how far it is beyond the limit. The event is an excess of 0 or
    /// more; NaN is a run that has no excess, as one that failed.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Columns`] if they are not as many as were asked for, or have not as many scores as the law,
    /// [`StatisticsError::LogWeight`] if a score is not finite.
    pub fn tell(&mut self, runs: &[(Vec<f64>, f64)]) -> Result<(), StatisticsError> {
        let Some(now) = &mut self.now else {
            return crate::rank_correlation::same_length(0, runs.len());
        };
        now.tell(runs)?;
        let is_first = self.evaluations == 0;
        self.evaluations += runs.len() as u64;
        self.without_excess += runs.iter().filter(|run| run.1.is_nan()).count() as u64;
        let events = runs.iter().filter(|run| run.1 >= 0.0).count();
        if is_first && FREQUENT * events >= runs.len() {
            self.now = None;
            return Ok(());
        }
        if is_first && !self.plan.law.is_own() {
            // What was plain has told that the event is rare, and not what the events do.
            *now = self.plan.clone();
        }
        if now.ended().is_some() {
            self.done.extend(self.now.take());
            let next = self.plan.clone();
            if self.done.len() < INDEPENDENT {
                self.now = Some(next);
            } else if self.goes_on() {
                self.now = Some(next.beyond(&self.done));
            }
        }
        self.law = self.now.as_ref().map_or_else(|| self.found(), |now| now.law.clone());
        Ok(())
    }

    /// Whether nothing more is asked for.
    pub fn is_done(&self) -> bool {
        self.now.is_none()
    }

    /// Whether it came to the event.
    pub fn reached(&self) -> bool {
        self.done.iter().any(WaySearch::reached)
    }

    /// How many searches did not come to an event of which nothing was known.
    pub(super) fn not_reached(&self) -> usize {
        let lost = |way: &&WaySearch| way.ended() == Some(Ended::NotReached) && !way.is_further();
        self.done.iter().filter(lost).count()
    }

    /// How many searches there were, if they left open whether there is another way to the event.
    pub(super) fn unsettled(&self) -> Option<usize> {
        (self.reached() && !self.is_settled()).then_some(self.done.len())
    }

    /// Whether nothing that matters is left of the event: the last searches say so that came to an answer.
    fn is_settled(&self) -> bool {
        let several = self.done.iter().any(|way| way.reached() && way.is_further());
        let after = self.done.iter().rev().take_while(|way| !way.reached());
        let nothing = after.filter(|way| way.ended() == Some(Ended::NothingMore)).count();
        nothing >= if several { AGREEING } else { 1 }
    }

    /// Whether another search is worth its runs.
    fn goes_on(&self) -> bool {
        let lost = |way: &&WaySearch| way.ended() == Some(Ended::NotReached);
        let lost = self.done.iter().rev().take_while(|way| !way.reached()).filter(lost).count();
        let most = if self.reached() { MOST_LOST } else { INDEPENDENT };
        self.done.len() < MOST_SEARCHES && lost < most && !self.is_settled()
    }

    /// What is drawn from in the end: what was found, or what led nearest if nothing was.
    fn found(&self) -> ScoreLaw {
        let mut ways: Vec<&WaySearch> = self.done.iter().filter(|way| way.reached()).collect();
        if ways.is_empty() {
            ways.extend(&self.done);
        }
        WaySearch::together(&ways)
    }
}
