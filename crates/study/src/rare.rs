//! How often a rare event happens: by subset simulation or by importance sampling.

mod failed;
mod importance;
mod json;
mod options;
mod runs;
mod subset;
mod warnings;

pub use failed::RareFailures;
pub use options::{RareMethod, RareOptions};
pub use warnings::RareWarning;

use gyradius_campaign::{Event, Progress};
use gyradius_statistics::{Interval, SteeredEstimate, SubsetEstimate};
use serde::Serialize;
use std::fmt;

use crate::{Notice, StudyError, subject::Subject};
use failed::Failures;
use runs::EventRuns;

/// How often a rare event happens.
#[derive(Clone, Debug)]
pub struct Rare {
    scenario: String,
    model: String,
    event: Event,
    /// How many runs failed.
    failed: u64,
    /// Groups of inputs that are drawn independently of each other.
    groups: Vec<String>,
    estimate: RareEstimate,
    warnings: Vec<RareWarning>,
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

    /// Why not to trust it, as far as it shows that itself.
    fn warnings(&self) -> Vec<RareWarning> {
        match self {
            Self::Subset(estimate) => {
                estimate.warnings().iter().copied().map(RareWarning::Subset).collect()
            }
            Self::Importance { estimate, .. } => {
                estimate.warnings().iter().copied().map(RareWarning::Importance).collect()
            }
        }
    }

    /// What counts of its runs are not, in words, where they need not be plain.
    fn as_drawn(&self) -> &'static str {
        let is_plain = match self {
            Self::Subset(_) => false,
            Self::Importance { steered, .. } => steered.is_empty(),
        };
        if is_plain {
            ""
        } else {
            "; runs near the event are done more often than they happen, so that this is no share of all runs"
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

    /// The event.
    #[must_use]
    pub fn event(&self) -> &Event {
        &self.event
    }

    /// Why not to trust the answer, as far as the runs can show it.
    #[must_use]
    pub fn warnings(&self) -> &[RareWarning] {
        &self.warnings
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
        let Self { scenario, model, event, failed, groups, estimate, warnings: _ } = self;
        writeln!(f, "{scenario}, {model}: {event}\n")?;
        let (p, interval) = (estimate.probability(), estimate.interval());
        let percent = 100.0 * interval.confidence().level();
        let only_if =
            if self.failed_runs().is_some() { ", if failed runs are not the event" } else { "" };
        if p > 0.0 {
            writeln!(
                f,
                "  probability  {} ({percent} % interval: {} to {}){only_if}",
                in_digits(p, 4),
                in_digits(interval.lower(), 3),
                in_digits(interval.upper(), 3)
            )?;
        } else {
            writeln!(
                f,
                "  probability  no event was found; below {}, with {percent} % confidence{only_if}",
                in_digits(interval.upper(), 3)
            )?;
        }
        write!(f, "  runs         {}", estimate.runs())?;
        if let Some(plain) = self.plain_runs() {
            write!(f, "; as many plain runs as would tell the same: {plain:.1e}")?;
        }
        writeln!(f)?;
        if *failed > 0 {
            let run = if *failed == 1 { "run" } else { "runs" };
            writeln!(f, "  failed       {failed} {run}{}", self.estimate.as_drawn())?;
        }
        let without = estimate.without_excess();
        if without > 0 {
            let quantity = event.quantity();
            let (runs, are) = match without {
                1 => ("1 run has".to_owned(), "is"),
                runs => (format!("{runs} runs have"), "are"),
            };
            let as_drawn = self.estimate.as_drawn();
            writeln!(f, "  no number    {runs} no {quantity}, and {are} not the event{as_drawn}")?;
        }
        // A group of several inputs has commas in its name.
        match estimate {
            RareEstimate::Subset(_) => writeln!(f, "  groups       {}", groups.join("; "))?,
            RareEstimate::Importance { steered, own_laws, .. } => {
                let named = |groups: &[String]| match groups {
                    [] => "none".to_owned(),
                    some => some.join("; "),
                };
                writeln!(f, "  steered      {}", named(steered))?;
                writeln!(f, "  own laws     {}", named(own_laws))?;
            }
        }
        for warning in self.warnings_in_words() {
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

/// Finds how often an event happens, and says what a simulator wrote that nobody had asked for.
pub(crate) fn find<C: Subject>(
    scenario: &C,
    event: &Event,
    options: &RareOptions,
    progress: Progress<'_>,
    say: &dyn Fn(Notice),
) -> Result<Rare, StudyError> {
    let runs = EventRuns::new(scenario, event, options, progress)?;
    let (per_level, least) = (options.per_level, options.least);
    let mut failures = Failures::default();
    let estimate = match options.method {
        RareMethod::Subset { replicas } => {
            let plan = (per_level, replicas, least);
            RareEstimate::Subset(subset::find(&runs, plan, &mut failures)?)
        }
        RareMethod::Importance { sample } => {
            let plan = (per_level, sample, least);
            let (estimate, is_steered) =
                importance::find(&runs, scenario.seed(), plan, &mut failures)?;
            let [steered, own_laws] = match is_steered {
                true => runs.groups().by_scores(),
                false => [Vec::new(), runs.groups().names().to_vec()],
            };
            RareEstimate::Importance { steered, own_laws, estimate }
        }
    };
    runs.unasked().into_iter().for_each(|unasked| say(Notice::Unasked(unasked)));
    let failed = failures.beside(estimate.probability(), estimate.interval())?;
    let failed = failed.map(RareWarning::FailedRuns);
    Ok(Rare {
        scenario: scenario.name().to_owned(),
        model: runs.model().to_owned(),
        event: event.clone(),
        failed: runs.failed(),
        groups: runs.groups().names().to_vec(),
        warnings: failed.into_iter().chain(estimate.warnings()).collect(),
        estimate,
    })
}

#[cfg(test)]
mod tests;
