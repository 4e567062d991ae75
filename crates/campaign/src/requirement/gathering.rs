//! What is gathered of a requirement in passes over runs: counts, the worst runs, and the order statistics that bound it.

use gyradius_statistics::{Pass, StatisticsError, Survey, Tolerance, ToleranceSide};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

use super::{
    Bound, FailedRuns, Requirement,
    convergence::{CountedAmong, Prefixes},
    deciding::{Deciding, Looks},
    distribution::Ranks,
};

/// Runs that are told of one by one.
const WORST: usize = 10;

/// A run, and how far it is beyond the bound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunBeyond {
    /// The run, from 0.
    pub run: u64,
    /// Its number.
    pub value: f64,
    /// How far that is beyond the bound; negative if it is within.
    pub excess: f64,
}

/// What is gathered of a requirement.
#[derive(Clone, Debug)]
pub(super) struct Gathering {
    pub(super) requirement: Requirement,
    pub(super) tally: Tally,
    /// Of the numbers.
    pub(super) numbers: Survey,
    /// Of how far numbers are beyond the bound, if that is no order of the numbers themselves.
    pub(super) excess: Option<Survey>,
    counted: bool,
    looks: Looks,
    /// After so many runs they are.
    looks_after: Vec<u64>,
}

/// Counts, and the worst runs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    /// All runs, those that have no number too.
    pub(super) runs: u64,
    /// Runs that have no number, most often because they failed.
    pub(super) without: u64,
    /// Runs whose number is infinite, which count and keep no bound.
    pub(super) infinite: u64,
    /// The first of them.
    pub(super) first_infinite: Vec<u64>,
    /// Runs whose number is beyond the bound.
    pub(super) beyond: u64,
    /// The worst first.
    pub(super) worst: Vec<RunBeyond>,
    /// The runs that count, by their numbers.
    pub(super) prefixes: Prefixes,
    /// Those of them that were there at each look.
    at_looks: CountedAmong,
}

/// What one pass gathers.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// That of the requirement, which says what is worse.
    bound: Bound,
    tally: Option<Tally>,
    numbers: Option<Pass>,
    excess: Option<Pass>,
}

impl Gathering {
    /// Of at most so many runs, which come in groups of so many: of each the first is gathered.
    pub(super) fn new(requirement: Requirement, runs: u64, group: u64) -> Self {
        let runs = runs.div_ceil(group.max(1));
        let excess = match requirement.bound() {
            Bound::AtMost(_) | Bound::AtLeast(_) => None,
            Bound::Between(..) => Some(Survey::new(runs)),
        };
        let (tally, numbers) = (Tally::default(), Survey::new(runs));
        let (looks, looks_after) = (Looks::Once, Vec::new());
        Self { requirement, tally, numbers, excess, counted: false, looks, looks_after }
    }

    /// The same, with runs that are looked at so often before a verdict.
    pub(super) fn looked_at(self, looks: Looks) -> Self {
        Self { looks, ..self }
    }

    /// The same, with runs that are looked at after so many: the numbers rise.
    pub(super) fn looked_after(self, looks_after: Vec<u64>) -> Self {
        Self { looks_after, ..self }
    }

    /// How many runs count at each look.
    pub(super) fn counted_at_looks(&self) -> Vec<u64> {
        self.tally.at_looks.told(&self.looks_after)
    }

    /// How often they are.
    pub(super) fn looks(&self) -> Looks {
        self.looks
    }

    /// When so many runs decide the requirement.
    pub(super) fn deciding(&self) -> Result<Deciding, StatisticsError> {
        Deciding::new(&self.requirement, self.looks)
    }

    /// What is to be gathered next, if anything is.
    pub(super) fn part(&self) -> Option<Part> {
        let tally = (!self.counted).then(Tally::default);
        let (numbers, excess) = (self.numbers.pass(), self.excess.as_ref().and_then(Survey::pass));
        let waits = tally.is_some() || numbers.is_some() || excess.is_some();
        let bound = self.requirement.bound();
        waits.then_some(Part { bound, tally, numbers, excess })
    }

    /// Adds runs to what is gathered, each with its place among those that are gathered and what it has of the quantity.
    pub(super) fn gather(
        &self,
        part: &mut Part,
        runs: impl Iterator<Item = (u64, u64, Option<f64>)>,
    ) {
        let bound = self.requirement.bound();
        let mut numbers = Vec::new();
        for (run, place, number) in runs {
            if let Some(tally) = &mut part.tally {
                tally.add(run, number, bound);
                if let Some(fails) = self.requirement.fails(number) {
                    tally.prefixes.add(place, fails);
                    tally.at_looks.add(run, &self.looks_after);
                }
            }
            numbers.extend(number.filter(|x| x.is_finite()).map(|x| (run, x)));
        }
        if let Some(pass) = &mut part.excess {
            pass.extend(numbers.iter().map(|(run, x)| (*run, bound.excess(*x))));
        }
        if let Some(pass) = &mut part.numbers {
            pass.extend(numbers);
        }
    }

    /// Takes up what was gathered of all runs. After the first time, it asks for the order statistic that the allowed
    /// failures leave.
    pub(super) fn advance(&mut self, part: Part) -> Result<(), StatisticsError> {
        if let Some(tally) = part.tally {
            (self.tally, self.counted) = (tally, true);
        }
        let rank = self.rank()?;
        if let Some(pass) = part.numbers {
            let rank = rank.filter(|_| self.excess.is_none());
            self.numbers.advance_selecting(pass, self.ranks().selected().chain(rank));
        }
        if let (Some(survey), Some(pass)) = (&mut self.excess, part.excess) {
            survey.advance_selecting(pass, rank);
        }
        Ok(())
    }

    /// The order of the runs that count. Those without a finite number stand beyond the limit.
    pub(super) fn ranks(&self) -> Ranks {
        let [_, runs] = self.tally.failures_of_counted(self.requirement.failed_runs());
        let values = self.tally.finite();
        let below = match self.requirement.bound() {
            Bound::AtLeast(_) => runs - values,
            Bound::AtMost(_) | Bound::Between(..) => 0,
        };
        Ranks { runs, below, values }
    }

    /// The rank, from 0, of the number that is the bound of the share, or of its excess where that is surveyed; none if there is no
    /// such number, for runs without one are worse than all.
    fn rank(&self) -> Result<Option<u64>, StatisticsError> {
        let side = match self.requirement.bound() {
            // The largest excess is the worst.
            Bound::AtMost(_) | Bound::Between(..) => ToleranceSide::AtMost,
            Bound::AtLeast(_) => ToleranceSide::AtLeast,
        };
        let values = self.tally.finite();
        let [failures, _] = self.tally.failures_of_counted(self.requirement.failed_runs());
        let failed = failures - self.tally.beyond;
        let tolerance = self.deciding()?.tolerance(side, values, failed);
        Ok(match tolerance {
            Tolerance::Ranks { lower, upper, .. } => lower.or(upper).map(|rank| rank - 1),
            Tolerance::TooFewRuns { .. } => None,
        })
    }

    /// The bound of the share, and how far it is beyond the limit.
    pub(super) fn bound_of_share(&self) -> Result<Option<(Bound, f64)>, StatisticsError> {
        let Some(rank) = self.rank()? else { return Ok(None) };
        let bound = self.requirement.bound();
        Ok(match &self.excess {
            Some(excess) => excess.order_statistic(rank).map(|by| (bound.wider(by), by)),
            // The number itself: a limit that is far from all of them would take its digits.
            None => self.numbers.order_statistic(rank).map(|x| (bound.at(x), bound.excess(x))),
        })
    }
}

impl Part {
    /// Takes in what was gathered of other runs.
    pub(super) fn merge(&mut self, other: Self) {
        if let (Some(tally), Some(more)) = (&mut self.tally, other.tally) {
            tally.merge(more, self.bound);
        }
        for (own, more) in [(&mut self.numbers, other.numbers), (&mut self.excess, other.excess)] {
            if let (Some(own), Some(more)) = (own, more) {
                own.merge(more);
            }
        }
    }
}

impl Tally {
    /// Runs that do not keep the requirement, and those that the verdict is about.
    pub(crate) fn failures_of_counted(&self, failed_runs: FailedRuns) -> [u64; 2] {
        let failures = self.beyond + self.infinite;
        match failed_runs {
            FailedRuns::Against => [failures + self.without, self.runs],
            FailedRuns::LeftOut => [failures, self.runs - self.without],
        }
    }

    fn keep_first_infinite(&mut self) {
        self.first_infinite.sort_unstable();
        self.first_infinite.truncate(WORST);
    }

    /// Runs that have a finite number.
    fn finite(&self) -> u64 {
        self.runs - self.without - self.infinite
    }

    pub(crate) fn add(&mut self, run: u64, number: Option<f64>, bound: Bound) {
        self.runs += 1;
        let Some(value) = number else {
            self.without += 1;
            return;
        };
        if !value.is_finite() {
            self.infinite += 1;
            self.first_infinite.push(run);
            self.keep_first_infinite();
            return;
        }
        let excess = bound.excess(value);
        self.beyond += u64::from(excess > 0.0);
        let new = RunBeyond { run, value, excess };
        let worse = |a: &RunBeyond, b: &RunBeyond| worse(bound, a, b);
        let is_worse = |last: &RunBeyond| worse(&new, last) == Ordering::Less;
        if self.worst.len() < WORST || self.worst.last().is_some_and(is_worse) {
            let place = self.worst.partition_point(|other| worse(other, &new) == Ordering::Less);
            self.worst.insert(place, new);
            self.worst.truncate(WORST);
        }
    }

    fn merge(&mut self, other: Self, bound: Bound) {
        self.runs += other.runs;
        self.without += other.without;
        self.infinite += other.infinite;
        self.first_infinite.extend(other.first_infinite);
        self.keep_first_infinite();
        self.beyond += other.beyond;
        self.prefixes.merge(&other.prefixes);
        self.at_looks.merge(&other.at_looks);
        self.worst.extend(other.worst);
        self.worst.sort_by(|a, b| worse(bound, a, b));
        self.worst.truncate(WORST);
    }
}

/// The worse run first, of equal ones the one of the smaller number, and of runs of several models that share one the one of the smaller value. Beside
/// a limit that is very large, the excess rounds to the same in runs of different values.
fn worse(bound: Bound, a: &RunBeyond, b: &RunBeyond) -> Ordering {
    // −0 is as large as 0, and not before it.
    let order = |a: f64, b: f64| (a + 0.0).total_cmp(&(b + 0.0));
    let rounded_away = match bound {
        Bound::AtMost(_) => order(b.value, a.value),
        Bound::AtLeast(_) => order(a.value, b.value),
        // The same excess is that of a number at either limit.
        Bound::Between(..) => Ordering::Equal,
    };
    order(b.excess, a.excess)
        .then(rounded_away)
        .then(a.run.cmp(&b.run))
        .then(a.value.total_cmp(&b.value))
}
