//! Runs of a model that are done to look for an event.

use gyradius_campaign::{
    CampaignError, Event, Progress, Simulation, Table, Unasked, go_on, run, threads,
};
use rayon::ThreadPool;
use std::{
    cell::Cell,
    sync::{Arc, atomic::AtomicBool},
};

use super::options::RareOptions;
use crate::{
    ScenarioError, StudyError,
    decisions::known,
    groups::{Drawing, Groups},
    subject::{Grouped, Subject},
};

/// Runs of a model that are done to look for an event.
pub(super) struct EventRuns<'a, C: Subject> {
    scenario: &'a C,
    prepared: C::Prepared,
    at: usize,
    model: &'a str,
    event: &'a Event,
    groups: Groups,
    threads: ThreadPool,
    stop: Option<Arc<AtomicBool>>,
    progress: Progress<'a>,
    done: Cell<u64>,
    failed: Cell<u64>,
}

/// What runs came to.
pub(super) struct Outcomes {
    /// By how much each is beyond the limit; NaN of a run without a number.
    pub(super) excesses: Vec<f64>,
    /// Whether it failed and has no number.
    pub(super) failed: Vec<bool>,
}

impl<'a, C: Subject> EventRuns<'a, C> {
    /// Checks the model and the event. Nothing is run yet.
    pub(super) fn new(
        scenario: &'a C,
        event: &'a Event,
        options: &RareOptions,
        progress: Progress<'a>,
    ) -> Result<Self, StudyError> {
        let at = scenario.place_of(options.model.as_deref())?;
        let model = scenario.model_names().nth(at).unwrap_or_default();
        let prepared = scenario.prepare(options.stop.as_ref())?;
        let plain = scenario.drawing(&prepared, at, Drawing::Plain)?;
        let columns = Table::new(model, 0, plain.columns()).map_err(CampaignError::from)?;
        known(scenario, event.quantity(), columns.columns())
            .map_err(|problem| ScenarioError::field("event", problem))?;
        let groups = plain.groups().clone();
        drop(plain);
        let (threads, stop) = (threads(options.threads)?, options.stop.clone());
        let [done, failed] = [(); 2].map(|()| Cell::new(0));
        Ok(Self {
            scenario,
            prepared,
            at,
            model,
            event,
            groups,
            threads,
            stop,
            progress,
            done,
            failed,
        })
    }

    /// Makes certain that runs can be done.
    pub(super) fn begin(&self) -> Result<(), StudyError> {
        Ok(self.scenario.begin(&self.prepared)?)
    }

    /// The name of the model.
    pub(super) fn model(&self) -> &'a str {
        self.model
    }

    /// The groups of inputs.
    pub(super) fn groups(&self) -> &Groups {
        &self.groups
    }

    /// How many of the runs that were done failed.
    pub(super) fn failed(&self) -> u64 {
        self.failed.get()
    }

    /// What a simulator wrote that nobody had asked for.
    pub(super) fn unasked(&self) -> Option<Unasked> {
        self.scenario.unasked(&self.prepared)
    }

    /// What so many runs came to. Refused if none of the first has a number, for then nothing leads to the event. Later ones may be
    /// few, as a step of few chains is, and have none by chance.
    pub(super) fn outcomes(&self, drawing: Drawing, runs: u64) -> Result<Outcomes, StudyError> {
        go_on(self.stop.as_deref())?;
        let simulation = self.scenario.drawing(&self.prepared, self.at, drawing)?;
        let simulation = simulation.wanted(self.event.quantity().columns());
        let table = run(&simulation, self.model, runs, &self.threads, &|_| {})?;
        // Runs that were stopped look like failed ones.
        go_on(self.stop.as_deref())?;
        let failed = table.failures().len() as u64;
        let excesses = self.event.excesses(&table);
        if self.done.get() == 0 && excesses.iter().all(|excess| excess.is_nan()) {
            let why = match table.failures().next() {
                Some((_, failure)) if failed == runs => {
                    format!("all of {runs} runs failed, the first by “{failure}”")
                }
                Some(_) | None => format!(
                    "none of {runs} runs has a number of {}, so that nothing leads to the event: take a quantity that most runs have",
                    self.event.quantity()
                ),
            };
            return Err(ScenarioError::field("event", why).into());
        }
        let mut without = vec![false; excesses.len()];
        for (run, _) in table.failures() {
            let place = usize::try_from(run).ok();
            let lost = place.and_then(|place| without.get_mut(place).zip(excesses.get(place)));
            // A run that failed for an infinite number has it.
            if let Some((lost, excess)) = lost {
                *lost = excess.is_nan();
            }
        }
        self.failed.set(self.failed.get() + failed);
        self.done.set(self.done.get() + runs);
        (self.progress)(self.done.get());
        Ok(Outcomes { excesses, failed: without })
    }

    /// The scores of so many runs that are steered.
    pub(super) fn scores(&self, drawing: Drawing, runs: u64) -> Result<Vec<Vec<f64>>, StudyError> {
        let simulation = self.scenario.drawing(&self.prepared, self.at, drawing)?;
        Ok(simulation.steered(runs))
    }
}
