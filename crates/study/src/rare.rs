//! How often a rare event happens: by subset simulation or by importance sampling.

mod importance;
mod options;
mod runs;
mod subset;

pub use options::{RareMethod, RareOptions};

use gyradius_campaign::{Event, Progress};
use gyradius_statistics::{
    Interval, SteeredEstimate, SteeredWarning, SubsetEstimate, SubsetWarning, WeightWarning,
};
use serde::Serialize;
use std::fmt;

use crate::{StudyError, subject::Subject};
use runs::EventRuns;

/// How often a rare event happens.
#[derive(Clone, Debug, Serialize)]
pub struct Rare {
    scenario: String,
    model: String,
    event: Event,
    /// How many runs failed.
    failed: u64,
    /// Groups of inputs that are drawn independently of each other.
    groups: Vec<String>,
    #[serde(flatten)]
    estimate: RareEstimate,
}

/// The estimate of a method.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "method", rename_all = "snake_case")]
pub enum RareEstimate {
    /// Subset simulation.
    Subset(SubsetEstimate),
    /// Importance sampling.
    Importance {
        /// Groups of inputs whose scores were steered: drawn from another law and weighted.
        steered: Vec<String>,
        /// Groups that were drawn from their own laws.
        own_laws: Vec<String>,
        /// The estimate.
        #[serde(flatten)]
        estimate: SteeredEstimate,
    },
}

impl RareEstimate {
    /// The estimate of the probability.
    #[must_use]
    pub fn probability(&self) -> f64 {
        match self {
            Self::Subset(estimate) => estimate.probability(),
            Self::Importance { estimate, .. } => estimate.probability(),
        }
    }

    /// Its standard error over the estimate; none if no event was found.
    #[must_use]
    pub fn coefficient_of_variation(&self) -> Option<f64> {
        match self {
            Self::Subset(estimate) => estimate.coefficient_of_variation(),
            Self::Importance { estimate, .. } => estimate.coefficient_of_variation(),
        }
    }

    /// The interval; from 0 to a bound if no event was found.
    #[must_use]
    pub fn interval(&self) -> Interval {
        match self {
            Self::Subset(estimate) => estimate.interval(),
            Self::Importance { estimate, .. } => estimate.interval(),
        }
    }

    /// Number of runs that were done, those that failed too.
    #[must_use]
    pub fn evaluations(&self) -> u64 {
        match self {
            Self::Subset(estimate) => estimate.evaluations(),
            Self::Importance { estimate, .. } => estimate.evaluations(),
        }
    }

    /// How many of them have no number of the event's quantity, and so are not the event.
    #[must_use]
    pub fn without_excess(&self) -> u64 {
        match self {
            Self::Subset(estimate) => estimate.without_excess(),
            Self::Importance { estimate, .. } => estimate.without_excess(),
        }
    }

    /// Why not to trust it, in words.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        match self {
            Self::Subset(estimate) => estimate.warnings().iter().map(of_subset).collect(),
            Self::Importance { estimate, .. } => {
                estimate.warnings().iter().map(of_scores).collect()
            }
        }
    }

    /// How the runs were done, in words.
    fn runs(&self) -> String {
        let all = self.evaluations();
        match self {
            Self::Subset(estimate) => format!("{all} in {} repetitions", estimate.replicas().len()),
            Self::Importance { estimate, .. } => {
                let sample = estimate.weighted();
                format!(
                    "{all}, of which {} in the sample; {} of these are the event, worth {:.0} of equal weight",
                    sample.runs(),
                    sample.hits(),
                    sample.effective_hits()
                )
            }
        }
    }
}

impl Rare {
    /// The estimate.
    #[must_use]
    pub fn estimate(&self) -> &RareEstimate {
        &self.estimate
    }

    /// How many runs failed.
    #[must_use]
    pub fn failed(&self) -> u64 {
        self.failed
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
        let Self { scenario, model, event, failed, groups, estimate } = self;
        writeln!(f, "{scenario}, {model}: {event}\n")?;
        let (p, interval) = (estimate.probability(), estimate.interval());
        let percent = 100.0 * interval.confidence().level();
        if p > 0.0 {
            writeln!(
                f,
                "  probability  {} ({percent} % interval: {} to {})",
                in_digits(p, 4),
                in_digits(interval.lower(), 3),
                in_digits(interval.upper(), 3)
            )?;
        } else {
            writeln!(
                f,
                "  probability  no event was found; below {}, with {percent} % confidence",
                in_digits(interval.upper(), 3)
            )?;
        }
        write!(f, "  runs         {}", estimate.runs())?;
        if let Some(plain) = self.plain_runs() {
            write!(f, "; as many plain runs as would tell the same: {plain:.1e}")?;
        }
        writeln!(f)?;
        if *failed > 0 {
            writeln!(f, "  failed       {failed} runs")?;
        }
        let without = estimate.without_excess();
        if without > 0 {
            let quantity = event.quantity();
            let (runs, are) = match without {
                1 => ("1 run has".to_owned(), "is"),
                runs => (format!("{runs} runs have"), "are"),
            };
            writeln!(f, "  no number    {runs} no {quantity}, and {are} not the event")?;
        }
        match estimate {
            RareEstimate::Subset(_) => writeln!(f, "  groups       {}", groups.join(", "))?,
            RareEstimate::Importance { steered, own_laws, .. } => {
                writeln!(f, "  steered      {}", steered.join(", "))?;
                let own = if own_laws.is_empty() { "none".to_owned() } else { own_laws.join(", ") };
                writeln!(f, "  own laws     {own}")?;
            }
        }
        for warning in estimate.warnings() {
            writeln!(f, "  warning      {warning}")?;
        }
        Ok(())
    }
}

/// A probability in so many digits, not counting nines with which it begins: what tells it from 0 and from 1.
fn in_digits(p: f64, digits: usize) -> String {
    if p < 0.1 {
        return format!("{p:.*e}", digits - 1);
    }
    let nines = (1..15).find(|nines| 1.0 - p >= 10_f64.powi(-nines)).unwrap_or(1);
    format!("{p:.*}", nines as usize + digits - 1)
}

fn of_subset(warning: &SubsetWarning) -> String {
    match warning {
        SubsetWarning::NotReached { replicas } => format!(
            "{} found no event: it cannot be, or is rarer than --least, or one group alone must be as \
             rare as the event; take more runs of a level",
            if *replicas == 1 {
                "1 repetition".to_owned()
            } else {
                format!("{replicas} repetitions")
            }
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

fn of_scores(warning: &SteeredWarning) -> String {
    match warning {
        SteeredWarning::NotReached { searches } => format!(
            "{searches} searches did not come to the event: it cannot be, or is rarer than --least, or what is drawn from its own law \
             decides; neither estimate nor interval should be trusted; take --method subset, or more runs of a level"
        ),
        SteeredWarning::MoreWays { searches } => format!(
            "{searches} searches left open whether there are more ways to the event than they found: take more runs of a level, or \
             --method subset"
        ),
        SteeredWarning::Weights(warning) => of_weights(warning),
    }
}

fn of_weights(warning: &WeightWarning) -> String {
    match warning {
        WeightWarning::NoHit => {
            "no run of the sample is the event: its probability is not known".to_owned()
        }
        WeightWarning::FewEffectiveHits { effective } => format!(
            "the runs that are the event are worth only {effective:.1} of equal weight: neither estimate nor interval should be \
             trusted; take a larger sample and more runs of a level, or --method subset"
        ),
        WeightWarning::OneHitDominates { share } => format!(
            "one run makes up {:.0} % of the estimate: another such run may change it by as much",
            100.0 * share
        ),
        WeightWarning::MeanWeightAboveOne { mean } => {
            format!("the mean of all weights is {mean:.2}, and should be 1: the weights are wrong")
        }
    }
}

/// Finds how often an event happens.
pub(crate) fn find<C: Subject>(
    scenario: &C,
    event: &Event,
    options: &RareOptions,
    progress: Progress<'_>,
) -> Result<Rare, StudyError> {
    let runs = EventRuns::new(scenario, event, options, progress)?;
    let (per_level, least) = (options.per_level, options.least);
    let estimate = match options.method {
        RareMethod::Subset { replicas } => {
            RareEstimate::Subset(subset::find(&runs, (per_level, replicas, least))?)
        }
        RareMethod::Importance { sample } => {
            let estimate = importance::find(&runs, scenario.seed(), (per_level, sample, least))?;
            let [steered, own_laws] = runs.groups().by_scores();
            RareEstimate::Importance { steered, own_laws, estimate }
        }
    };
    Ok(Rare {
        scenario: scenario.name().to_owned(),
        model: runs.model().to_owned(),
        event: event.clone(),
        failed: runs.failed(),
        groups: runs.groups().names().to_vec(),
        estimate,
    })
}

#[cfg(test)]
mod tests;
