//! How a rare event is looked for.

use gyradius_statistics::ScoreSearch;
use std::sync::{Arc, atomic::AtomicBool};

/// Levels of a subset simulation that there may be: one for each digit of the least probability.
const DIGITS: u64 = 9;

/// How a rare event is looked for.
#[derive(Clone, Debug)]
pub struct RareOptions {
    /// The model; the first of the scenario if not given.
    pub model: Option<String>,
    /// By which method.
    pub method: RareMethod,
    /// Runs of a level.
    pub per_level: usize,
    /// It is given up below this probability.
    pub least: f64,
    /// How many threads; as many as the machine has if not given.
    pub threads: Option<usize>,
    /// Set from elsewhere to stop.
    pub stop: Option<Arc<AtomicBool>>,
}

/// By which method a rare event is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RareMethod {
    /// Subset simulation, which draws groups of inputs anew from their own laws.
    Subset {
        /// Independent repetitions, by which it is known how well the probability is known.
        replicas: usize,
    },
    /// Importance sampling, which draws normal scores from another law and weighs the runs.
    Importance {
        /// Runs of the sample from which the probability is found.
        sample: u64,
    },
}

impl RareOptions {
    /// How many runs it may take, most events fewer. Importance sampling takes more only where there are many ways to the event.
    #[must_use]
    pub fn most_runs(&self) -> u64 {
        let per_level = self.per_level as u64;
        match self.method {
            RareMethod::Subset { replicas } => {
                DIGITS.saturating_mul(per_level).saturating_mul((replicas as u64).saturating_add(1))
            }
            RareMethod::Importance { sample } => (ScoreSearch::LEVELS_OF_ONE_WAY as u64)
                .saturating_mul(per_level)
                .saturating_add(sample),
        }
    }
}

impl RareMethod {
    /// Repetitions of a subset simulation, unless told otherwise.
    pub const REPLICAS: usize = 10;
    /// Runs of the sample of importance sampling, unless told otherwise.
    pub const SAMPLE: u64 = 10_000;
}

impl Default for RareMethod {
    fn default() -> Self {
        Self::Subset { replicas: Self::REPLICAS }
    }
}

impl Default for RareOptions {
    fn default() -> Self {
        let method = RareMethod::default();
        Self { model: None, method, per_level: 1000, least: 1e-9, threads: None, stop: None }
    }
}
