//! How often a rare event happens: subset simulation that draws one group of inputs anew at a time.

use gyradius_campaign::{
    CampaignError, Event, Progress, Simulation, Table, is_stopped, run, threads,
};
use gyradius_statistics::{
    Confidence, StatisticsError, SubsetEstimate, SubsetReplica, SubsetSimulation, SubsetWarning,
};
use serde::Serialize;
use std::{
    fmt,
    sync::{Arc, atomic::AtomicBool},
};

use crate::{
    ScenarioError, StudyError, decisions::known, groups::Drawing, scenario::place, subject::Subject,
};

/// How a rare event is looked for.
#[derive(Clone, Debug)]
pub struct RareOptions {
    /// The model; the first of the scenario if not given.
    pub model: Option<String>,
    /// Runs of a level.
    pub per_level: usize,
    /// Independent repetitions, by which it is known how well the probability is known.
    pub replicas: usize,
    /// It is given up below this probability.
    pub least: f64,
    /// How many threads; as many as the machine has if not given.
    pub threads: Option<usize>,
    /// Set from elsewhere to stop.
    pub stop: Option<Arc<AtomicBool>>,
}

impl Default for RareOptions {
    fn default() -> Self {
        let (per_level, replicas, least) = (1000, 10, 1e-9);
        Self { model: None, per_level, replicas, least, threads: None, stop: None }
    }
}

/// How often a rare event happens.
#[derive(Clone, Debug, Serialize)]
pub struct Rare {
    scenario: String,
    model: String,
    event: Event,
    /// Groups of inputs that are drawn independently of each other.
    groups: Vec<String>,
    #[serde(flatten)]
    estimate: SubsetEstimate,
}

impl Rare {
    /// The estimate.
    #[must_use]
    pub fn estimate(&self) -> &SubsetEstimate {
        &self.estimate
    }

    /// How many plain runs would tell the probability as well: `(1 − p)/(p c²)` for a coefficient of variation c.
    #[must_use]
    pub fn plain_runs(&self) -> Option<f64> {
        let (p, c) = (self.estimate.probability(), self.estimate.coefficient_of_variation()?);
        let runs = (1.0 - p) / (p * c * c);
        runs.is_finite().then_some(runs)
    }
}

/// In lines, the answer first.
impl fmt::Display for Rare {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scenario, model, event, groups, estimate } = self;
        writeln!(f, "{scenario}, {model}: {event}\n")?;
        let (p, interval) = (estimate.probability(), estimate.interval());
        let percent = 100.0 * interval.confidence().level();
        if p > 0.0 {
            writeln!(
                f,
                "  probability  {p:.3e} ({percent} % interval: {:.2e} to {:.2e})",
                interval.lower(),
                interval.upper()
            )?;
        } else {
            writeln!(
                f,
                "  probability  no event was found; below {:.2e}, with {percent} % confidence",
                interval.upper()
            )?;
        }
        write!(
            f,
            "  runs         {} in {} repetitions",
            estimate.evaluations(),
            estimate.replicas().len()
        )?;
        if let Some(plain) = self.plain_runs() {
            write!(f, "; as many plain runs as would tell the same: {plain:.1e}")?;
        }
        writeln!(f)?;
        if estimate.failed() > 0 {
            writeln!(f, "  failed       {} runs, which are not the event", estimate.failed())?;
        }
        writeln!(f, "  groups       {}", groups.join(", "))?;
        for warning in estimate.warnings() {
            writeln!(f, "  warning      {}", said(warning))?;
        }
        Ok(())
    }
}

fn said(warning: &SubsetWarning) -> String {
    match warning {
        SubsetWarning::NotReached { replicas } => format!(
            "{replicas} repetitions found no event: it cannot be, or is rarer than --least, or one group alone must be as \
             rare as the event; take more runs of a level"
        ),
        SubsetWarning::ChainsHardlyMove { acceptance } => format!(
            "only {:.1} % of the redrawn runs stayed beyond the last level: one group decides nearly alone, and the interval may \
             be too narrow; take more runs of a level",
            100.0 * acceptance
        ),
        SubsetWarning::ReplicasDiffer { coefficient } => format!(
            "the repetitions differ by {coefficient:.1} times the estimate: take more runs of a level"
        ),
    }
}

/// Finds how often an event happens.
pub(crate) fn find<C: Subject>(
    scenario: &C,
    event: &Event,
    options: &RareOptions,
    progress: Progress<'_>,
) -> Result<Rare, StudyError> {
    let threads = threads(options.threads)?;
    let names: Vec<&str> = scenario.model_names().collect();
    let at = match &options.model {
        None => 0,
        Some(name) => names.iter().position(|known| known == name).ok_or_else(|| {
            let problem = format!("{name:?}: the scenario has {}", names.join(", "));
            ScenarioError::field("model", problem)
        })?,
    };
    let model =
        *names.get(at).ok_or_else(|| ScenarioError::field(place(at), "there is no model"))?;
    let models = scenario.prepare(options.stop.as_ref())?;
    let simulations = scenario.simulations(&models)?;
    let columns = simulations.get(at).map_or_else(Vec::new, |(_, simulation)| simulation.columns());
    let columns = Table::new(model, 0, columns).map_err(CampaignError::from)?;
    known(event.quantity(), columns.columns())
        .map_err(|problem| ScenarioError::field("event", problem))?;
    let groups = scenario.groups(&models, at)?;
    let plan = SubsetSimulation::new(groups.names().len(), options.per_level, options.replicas);
    let refused = |field: &str, error: StatisticsError| ScenarioError::field(field, error);
    let plan = plan.map_err(|error| refused("per-level, replicas", error))?;
    let plan = plan.with_least(options.least).map_err(|error| refused("least", error))?;
    scenario.begin(&models)?;
    let mut done = 0;
    let mut simulate = |replica: &mut SubsetReplica| {
        while !replica.is_done() {
            if is_stopped(options.stop.as_deref()) {
                return Err(StudyError::from(CampaignError::Stopped));
            }
            let draws: Arc<[Vec<u64>]> = replica.asks().into();
            let runs = draws.len() as u64;
            let simulation = scenario.drawing(&models, at, Drawing::Given(draws))?;
            let table = run(&simulation, model, runs, &threads, &|_| {})?;
            let excesses = event.excesses(&table);
            if excesses.iter().all(|excess| excess.is_nan()) {
                let failure = table.failures().next();
                let why = failure.map_or_else(
                    || format!("none of {runs} runs has a number of {}", event.quantity()),
                    |(_, failure)| format!("all of {runs} runs failed, the first by “{failure}”"),
                );
                return Err(ScenarioError::field("event", why).into());
            }
            replica.tell(&excesses)?;
            done += runs;
            progress(done);
        }
        Ok(())
    };
    let mut pilot = plan.pilot();
    simulate(&mut pilot)?;
    let mut replicas = plan.replicas(&pilot)?;
    replicas.iter_mut().try_for_each(simulate)?;
    Ok(Rare {
        scenario: scenario.name().to_owned(),
        model: model.to_owned(),
        event: event.clone(),
        groups: groups.names().to_vec(),
        estimate: plan.finish(&pilot, &replicas, Confidence::default())?,
    })
}
