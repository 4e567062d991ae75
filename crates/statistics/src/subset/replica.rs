//! One subset simulation: which runs it asks for next, and what it makes of their outcomes.

/// A run of the level at hand.
#[derive(Clone, Debug)]
struct Member {
    /// The number of the draw of each group.
    draws: Vec<u64>,
    /// Minus infinity for a run that has none.
    excess: f64,
    /// The first draw from which it descends.
    family: usize,
}

/// Where a replica stands.
#[derive(Clone, Debug)]
enum Stage {
    /// Plain runs, of which none is known.
    First,
    /// Chains from the runs that stand above a level; those before this number of steps are done.
    Chains { level: Level, heads: Vec<Member>, step: usize },
    /// The event was reached, or no more can be done.
    Done { reached: bool },
}

/// A level: which runs belong to it, and how chains move in it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Level {
    /// Those with this excess or more.
    threshold: f64,
    /// So many groups are drawn anew at once.
    width: usize,
}

/// One simulation of a [`SubsetSimulation`](crate::SubsetSimulation), in steps: it asks for runs, which may be done in any
/// order and on any number of threads, and is told their outcomes.
///
/// ```
/// use gyradius_statistics::{Confidence, SubsetReplica, SubsetSimulation};
///
/// // The number of a draw stands for what a stream of random numbers gives for it.
/// let number = |draw: u64, step: f64| ((draw + 1) as f64 * step).fract();
/// let run = |draws: &Vec<u64>| number(draws[0], 0.618034) * number(draws[1], 0.754878) - 0.9;
/// let simulate = |replica: &mut SubsetReplica| {
///     while !replica.is_done() {
///         let excesses: Vec<f64> = replica.asks().iter().map(run).collect();
///         replica.tell(&excesses)?;
///     }
///     Ok::<(), gyradius_statistics::StatisticsError>(())
/// };
/// let plan = SubsetSimulation::new(2, 500, 5)?;
/// let mut pilot = plan.pilot();
/// simulate(&mut pilot)?;
/// let mut replicas = plan.replicas(&pilot)?;
/// replicas.iter_mut().try_for_each(simulate)?;
/// let estimate = plan.finish(&pilot, &replicas, Confidence::default())?;
/// // 1 − 0.9 (1 − ln 0.9) = 0.0052.
/// assert!(estimate.interval().contains(0.0052));
/// # Ok::<(), gyradius_statistics::StatisticsError>(())
/// ```
#[derive(Clone, Debug, getset::CopyGetters)]
pub struct SubsetReplica {
    groups: usize,
    per_level: usize,
    rule: Rule,
    stage: Stage,
    /// Runs of the level that is being made.
    members: Vec<Member>,
    asks: Vec<Vec<u64>>,
    /// The number that the next draw gets.
    next_draw: u64,
    /// Those passed, without the event.
    levels: Vec<Level>,
    /// Number of runs that were done.
    #[getset(get_copy = "pub")]
    evaluations: u64,
    /// How many of them had no excess.
    #[getset(get_copy = "pub")]
    without_excess: u64,
    /// The probability of the last level that was passed: of the event, if it was reached.
    #[getset(get_copy = "pub")]
    probability: f64,
    /// Proposals and those accepted in the level at hand.
    moves: (u64, u64),
}

/// How a replica finds its levels.
#[derive(Clone, Debug)]
enum Rule {
    /// From its own runs, down to this probability.
    Pilot { least: f64 },
    /// Those of the pilot.
    Given(Vec<Level>),
}

/// One run in so many goes on to the next level.
const PART: usize = 10;
/// Where more of the redrawn runs are accepted, more groups are drawn anew at once, and where fewer are, fewer.
const OFTEN: f64 = 0.5;
const SELDOM: f64 = 0.2;
/// The last level.
const EVENT: Level = Level { threshold: 0.0, width: 1 };
/// Draws of one replica: their numbers are told apart by what stands above.
const DRAWS: u32 = 40;

impl SubsetReplica {
    /// The pilot has the number 0.
    pub(super) fn pilot(groups: usize, per_level: usize, least: f64) -> Self {
        Self::new(0, groups, per_level, Rule::Pilot { least })
    }

    /// A replica with the levels of this one.
    pub(super) fn alike(&self, number: u64) -> Self {
        Self::new(number, self.groups, self.per_level, Rule::Given(self.levels.clone()))
    }

    fn new(number: u64, groups: usize, per_level: usize, rule: Rule) -> Self {
        let first = number << DRAWS;
        Self {
            groups,
            per_level,
            rule,
            stage: Stage::First,
            members: Vec::new(),
            asks: (first..first + per_level as u64).map(|draw| vec![draw; groups]).collect(),
            next_draw: first + per_level as u64,
            levels: Vec::new(),
            evaluations: 0,
            without_excess: 0,
            probability: 1.0,
            moves: (0, 0),
        }
    }

    /// The runs whose outcomes are wanted next: for each the number of the draw of every group. None if the simulation is
    /// done.
    pub fn asks(&self) -> &[Vec<u64>] {
        &self.asks
    }

    /// Takes the outcomes of the runs that were asked for, in their order: the excess of each, which is the event from 0 on, and
    /// NaN for a run that has none, as one that failed.
    ///
    /// # Errors
    ///
    /// [`StatisticsError::Columns`](crate::StatisticsError::Columns) if they are not as many as were asked for.
    pub fn tell(&mut self, excesses: &[f64]) -> Result<(), crate::StatisticsError> {
        crate::rank_correlation::same_length(self.asks.len(), excesses.len())?;
        self.evaluations += excesses.len() as u64;
        self.without_excess += excesses.iter().filter(|excess| excess.is_nan()).count() as u64;
        let asks = std::mem::take(&mut self.asks);
        let outcomes =
            asks.into_iter().zip(excesses.iter().map(|excess| excess.max(f64::NEG_INFINITY)));
        match &mut self.stage {
            Stage::First => {
                let member = |(family, (draws, excess))| Member { draws, excess, family };
                self.members = outcomes.enumerate().map(member).collect();
                self.rise();
            }
            Stage::Chains { level, heads, step } => {
                for (head, (draws, excess)) in longer(heads, self.per_level, *step).zip(outcomes) {
                    self.moves.0 += 1;
                    if excess >= level.threshold {
                        self.moves.1 += 1;
                        (head.draws, head.excess) = (draws, excess);
                    }
                    self.members.push(head.clone());
                }
                *step += 1;
                self.propose();
            }
            Stage::Done { .. } => {}
        }
        Ok(())
    }

    /// Asks for the next step of all chains that are not long enough, or goes on to the next level.
    fn propose(&mut self) {
        let Stage::Chains { level, heads, step } = &mut self.stage else { return };
        let (step, width, groups) = (*step, level.width, self.groups);
        for (chain, head) in longer(heads, self.per_level, step).enumerate() {
            let mut draws = head.draws.clone();
            // Every group in turn, and in neighbouring chains others.
            let first = chain + self.levels.len() + step * width;
            (first..first + width).for_each(|group| draws[group % groups] = self.next_draw);
            self.next_draw += 1;
            self.asks.push(draws);
        }
        if self.asks.is_empty() {
            self.rise();
        }
    }

    /// From a whole level to the next.
    fn rise(&mut self) {
        let level = match &self.rule {
            Rule::Pilot { .. } => self.find_level(),
            Rule::Given(levels) => Some(levels.get(self.levels.len()).copied().unwrap_or(EVENT)),
        };
        let Some(level) = level else { return self.end(false) };
        let inside = |member: &Member| member.excess >= level.threshold;
        let count = self.members.iter().filter(|member| inside(member)).count();
        if count == 0 {
            return self.end(false);
        }
        let probability = self.probability * (count as f64 / self.members.len() as f64);
        match self.rule {
            Rule::Pilot { least } if probability < least => return self.end(false),
            Rule::Pilot { .. } | Rule::Given(_) => self.probability = probability,
        }
        if level == EVENT {
            return self.end(true);
        }
        self.levels.push(level);
        self.members.retain(inside);
        self.moves = (0, 0);
        self.stage = Stage::Chains { level, heads: self.members.clone(), step: 1 };
        self.propose();
    }

    /// The level that one run in ten has; none if no value is above that of all.
    fn find_level(&self) -> Option<Level> {
        let n = self.members.len();
        let mut excesses: Vec<f64> = self.members.iter().map(|member| member.excess).collect();
        excesses.sort_unstable_by(|a, b| b.total_cmp(a));
        let mut threshold = excesses[n / PART - 1];
        if excesses[n - 1] >= threshold.min(0.0) && threshold < 0.0 {
            // All runs are there: the least value that not all have.
            threshold = excesses.into_iter().rev().find(|excess| *excess > threshold)?;
        }
        if threshold >= 0.0 {
            return Some(EVENT);
        }
        let width = match (self.levels.last(), self.acceptance()) {
            (Some(before), Some(share)) if share > OFTEN => before.width * 2,
            (Some(before), Some(share)) if share < SELDOM => before.width / 2,
            (Some(before), _) => before.width,
            (None, _) => self.groups / 2,
        };
        Some(Level { threshold, width: width.clamp(1, self.groups) })
    }

    fn end(&mut self, reached: bool) {
        self.stage = Stage::Done { reached };
    }

    /// Whether nothing more is asked for.
    pub fn is_done(&self) -> bool {
        matches!(self.stage, Stage::Done { .. })
    }

    /// Whether it ended in the event.
    pub fn reached(&self) -> bool {
        matches!(self.stage, Stage::Done { reached: true })
    }

    /// Number of levels that were passed on the way to the event.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// How many runs of the level at hand are the event.
    pub(super) fn hits(&self) -> u64 {
        self.members.iter().filter(|member| member.excess >= 0.0).count() as u64
    }

    /// How many runs the level at hand has.
    pub(super) fn runs_of_level(&self) -> u64 {
        self.members.len() as u64
    }

    /// The share of redrawn runs of the last level that stayed above it; none if there was no such level.
    pub fn acceptance(&self) -> Option<f64> {
        (self.moves.0 > 0).then(|| self.moves.1 as f64 / self.moves.0 as f64)
    }

    /// From how many of the first runs those at hand descend: of the event, if it was reached.
    pub fn families(&self) -> usize {
        let limit = if self.reached() { 0.0 } else { f64::NEG_INFINITY };
        let inside = self.members.iter().filter(|member| member.excess >= limit);
        let mut families: Vec<usize> = inside.map(|member| member.family).collect();
        families.sort_unstable();
        families.dedup();
        families.len()
    }

    /// Runs that are the event, the largest excess first: the number of the draw of each group.
    pub fn events(&self) -> Vec<Vec<u64>> {
        let mut events: Vec<&Member> = self.members.iter().filter(|m| m.excess >= 0.0).collect();
        events.sort_by(|a, b| b.excess.total_cmp(&a.excess).then_with(|| a.draws.cmp(&b.draws)));
        events.dedup_by(|a, b| a.draws == b.draws);
        events.into_iter().map(|member| member.draws.clone()).collect()
    }
}

/// The heads of the chains that have more than `step` runs, if `all` runs are dealt to the chains as evenly as can be.
fn longer(heads: &mut [Member], all: usize, step: usize) -> impl Iterator<Item = &mut Member> {
    let chains = heads.len();
    let length = move |chain: usize| (chain + 1) * all / chains - chain * all / chains;
    heads
        .iter_mut()
        .enumerate()
        .filter(move |(chain, _)| length(*chain) > step)
        .map(|(_, head)| head)
}
