//! What the runs have shown so far of that which ends a campaign.

use gyradius_statistics::{Confidence, ConfidenceSequence, FixedWidth, StatisticsError, Verdict};
use std::ops::Range;

use super::StoppingRule;
use crate::{
    requirement::{Measured, Requirement, Tally},
    table::Table,
};

/// What the runs of all models have shown so far of that which ends a campaign. Blocks are looked at in the order of their
/// runs: then it is the same to the bit whatever their size.
#[derive(Debug)]
pub struct Evidence {
    rule: StoppingRule,
    /// Runs of a group, which have something in common: the first of each is independent of all others, and counts.
    group: u64,
    models: Vec<OfModel>,
}

/// Of the runs of a model.
#[derive(Debug)]
struct OfModel {
    requirements: Vec<(Requirement, Tally)>,
    mean: Option<RunningMean>,
}

/// Of a number whose mean is to be known, by Welford's recurrence (1962, doi:10.1080/00401706.1962.10490022).
#[derive(Clone, Debug)]
struct RunningMean {
    quantity: Measured,
    n: u64,
    mean: f64,
    /// Of the distances to the mean.
    squares: f64,
    /// The smallest and the largest.
    ends: [f64; 2],
}

impl Evidence {
    /// For a rule, of the requirements of each model; runs come in groups of so many, 1 if they are independent of each other.
    #[must_use]
    pub fn new(rule: StoppingRule, requirements: Vec<Vec<Requirement>>, group: u64) -> Self {
        let mean = rule.quantity().cloned();
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        let mean =
            mean.map(|quantity| RunningMean { quantity, n: 0, mean: 0.0, squares: 0.0, ends });
        let of_model = |own: Vec<Requirement>| {
            let requirements = own.into_iter().map(|own| (own, Tally::default())).collect();
            OfModel { requirements, mean: mean.clone() }
        };
        let models = requirements.into_iter().map(of_model).collect();
        Self { rule, group: group.max(1), models }
    }

    /// Looks at some runs of a block of the model in a place: at each once, and in their order.
    pub fn look(&mut self, place: usize, block: &Table, some: Range<u64>) {
        let Some(model) = self.models.get_mut(place) else { return };
        let group = self.group;
        let judged = |quantity: &Measured| {
            let numbers = (block.first()..).zip(quantity.numbers(block));
            let some = some.clone();
            numbers.filter(move |(run, _)| some.contains(run) && run.is_multiple_of(group))
        };
        for (requirement, tally) in &mut model.requirements {
            for (run, number) in judged(requirement.quantity()) {
                tally.add(run, number, requirement.bound());
            }
        }
        if let Some(mean) = &mut model.mean {
            let numbers = judged(&mean.quantity)
                .filter_map(|(_, x)| x.filter(|x| x.is_finite()))
                .collect::<Vec<_>>();
            numbers.into_iter().for_each(|x| mean.add(x));
        }
    }

    /// Whether that is enough.
    ///
    /// # Errors
    /// There are more runs than can be judged.
    pub fn is_enough(&self) -> Result<bool, StatisticsError> {
        for model in &self.models {
            if !self.is_enough_of(model)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn is_enough_of(&self, model: &OfModel) -> Result<bool, StatisticsError> {
        match &self.rule {
            StoppingRule::Decided => model.all(|requirement, [failures, counted]| {
                let verdict = requirement.sequential()?.verdict(failures, counted)?;
                Ok(match verdict {
                    Verdict::Met | Verdict::NotMet => true,
                    Verdict::Undecided { .. } => false,
                })
            }),
            StoppingRule::Share(within) => model.all(|requirement, [failures, counted]| {
                let sequence = ConfidenceSequence::new(requirement.confidence());
                let interval = sequence.interval(failures, counted)?;
                Ok(interval.width() <= 2.0 * within)
            }),
            StoppingRule::Mean(_, within) => {
                let rule = FixedWidth::new(*within, Confidence::default())?;
                Ok(model.mean.as_ref().is_some_and(|mean| mean.is_known(rule)))
            }
        }
    }
}

impl OfModel {
    /// Whether it is enough for all requirements, by the failures of each among the runs that count.
    fn all(
        &self,
        enough: impl Fn(&Requirement, [u64; 2]) -> Result<bool, StatisticsError>,
    ) -> Result<bool, StatisticsError> {
        for (requirement, tally) in &self.requirements {
            if !enough(requirement, tally.failures_of_counted(requirement.failed_runs()))? {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

impl RunningMean {
    fn add(&mut self, x: f64) {
        self.n += 1;
        let before = x - self.mean;
        self.mean += before / self.n as f64;
        self.squares += before * (x - self.mean);
        self.ends = [self.ends[0].min(x), self.ends[1].max(x)];
    }

    fn is_known(&self, rule: FixedWidth) -> bool {
        let range = self.ends[1] - self.ends[0];
        self.n > 1 && rule.is_reached(self.n, self.squares / (self.n - 1) as f64, range)
    }
}
