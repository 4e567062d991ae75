//! What a summary says first: of which scenario it is, by which version, of how many runs from which seed.

use gyradius_campaign::{ColumnSummary, Judgement};
use serde::{Deserialize, Serialize};
use std::{borrow::Cow, fmt, ops::Range};

use crate::{
    Fleet, about::About, alerts::Alert, driven::Drivers, ended::Ended, unusual::Unusual,
    where_runs_fail::WhereRunsFail,
};

/// What a summary says first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    pub(crate) gyradius_version: Cow<'static, str>,
    /// The name of the scenario.
    pub scenario: String,
    /// What the scenario says of itself.
    #[serde(default, skip_serializing_if = "About::is_empty")]
    pub(crate) about: About,
    /// SHA-256 of the resolved scenario.
    pub(crate) fingerprint: String,
    /// The seed of all random numbers.
    pub seed: u64,
    /// Runs of each model, those that are missing too.
    pub runs_per_model: u64,
    /// The vehicles whose flights the runs are, if there are vehicles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fleet: Option<Fleet>,
    /// Runs that are independent of each other, the first flights of the vehicles, if flights of a vehicle have something
    /// in common.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) independent_runs_per_model: Option<u64>,
    /// Runs that are not done, where not all are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missing: Vec<Missing>,
    /// How many runs were done again because they had failed.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(crate) done_again: u64,
    /// What ended the runs, if they were not done to a number that was stated before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ended: Option<Ended>,
    /// What a reader should know before the results.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) alerts: Vec<Alert>,
    /// What the runs say of the requirements, model by model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub requirements: Vec<Judged>,
    /// What drives the outcome, model by model, if that was asked.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drivers: Vec<Drivers>,
    /// Where runs fail, model by model, if there is anything to tell.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) where_runs_fail: Vec<WhereRunsFail>,
    /// Of every interval.
    pub(crate) confidence: f64,
    /// Of the run tables.
    pub(crate) columns: Vec<ColumnSummary>,
}

impl Head {
    /// Whether all runs are done: to their number, or until a rule ended them.
    pub(crate) fn is_complete(&self) -> bool {
        self.missing.is_empty() && !self.is_interrupted()
    }

    /// Whether a rule is to end the runs and has not.
    pub(crate) fn is_interrupted(&self) -> bool {
        self.ended.as_ref().is_some_and(Ended::is_interrupted)
    }

    /// How many runs of each model are independent of each other.
    pub(crate) fn independent_runs(&self) -> u64 {
        self.independent_runs_per_model.unwrap_or(self.runs_per_model)
    }
}

/// What the runs of a model say of a requirement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    pub(crate) model: String,
    #[serde(flatten)]
    pub(crate) judgement: Judgement,
    /// What is unusual among what its worst runs have drawn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) unusual: Vec<Unusual>,
}

impl Judged {
    /// The model.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// What its runs say.
    #[must_use]
    pub fn judgement(&self) -> &Judgement {
        &self.judgement
    }
}

/// Runs of a model that are not done.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Missing {
    /// The model.
    pub model: String,
    first_run: u64,
    runs: u64,
}

impl Missing {
    pub(crate) fn new(model: &str, runs: Range<u64>) -> Self {
        let (first_run, runs) = (runs.start, runs.end - runs.start);
        Self { model: model.to_owned(), first_run, runs }
    }

    /// The runs.
    #[must_use]
    pub fn range(&self) -> Range<u64> {
        self.first_run..self.first_run + self.runs
    }
}

/// How many there are, and which, from the first to the last.
impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let last = self.first_run + self.runs - 1;
        write!(f, "{} of {} ({} to {last})", self.runs, self.model, self.first_run)
    }
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}
