//! What drives outputs, as it was found.

use gyradius_statistics::{Estimate, SobolIndex, SobolIndices};
use serde::{Deserialize, Serialize};

/// What drives the outcome of the runs of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drivers {
    pub(crate) model: String,
    pub(crate) base_runs: u64,
    /// Runs in all, and those of them that failed.
    pub(crate) runs: u64,
    pub(crate) failed: u64,
    /// The groups of inputs.
    pub(crate) groups: Vec<String>,
    pub(crate) outputs: Vec<Driven>,
    /// SHA-256 of what the runs depend on, and of the requirements.
    pub(crate) identity: String,
}

/// What drives an output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Driven {
    pub(crate) output: String,
    /// Of a column; none of whether a requirement is kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) unit: Option<String>,
    /// Of the groups, in their order.
    pub(crate) indices: SobolIndices,
}

impl Drivers {
    /// The model.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// Base runs, each of which is done once for each group of inputs and twice more.
    #[must_use]
    pub fn base_runs(&self) -> u64 {
        self.base_runs
    }

    /// Runs in all.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// Runs that failed.
    #[must_use]
    pub fn failed(&self) -> u64 {
        self.failed
    }

    /// The groups of inputs.
    #[must_use]
    pub fn groups(&self) -> &[String] {
        &self.groups
    }

    /// The outputs that vary.
    #[must_use]
    pub fn outputs(&self) -> &[Driven] {
        &self.outputs
    }
}

impl Driven {
    /// The name of the column, or of the requirement, of which it is whether a run does not keep it.
    #[must_use]
    pub fn output(&self) -> &str {
        &self.output
    }

    /// The unit of the column; none of a requirement.
    #[must_use]
    pub fn unit(&self) -> Option<&str> {
        self.unit.as_deref()
    }

    /// What each group drives, in their order.
    #[must_use]
    pub fn indices(&self) -> &[SobolIndex] {
        self.indices.groups()
    }

    /// The groups that drive most of it, by their total indices, the first of them first; those without an index last.
    #[must_use]
    pub fn ranked<'a>(&'a self, groups: &'a [String]) -> Vec<(&'a str, &'a SobolIndex)> {
        let all = groups.iter().map(String::as_str).zip(self.indices.groups());
        let mut ranked: Vec<(&str, &SobolIndex)> = all.collect();
        let total = |index: &SobolIndex| index.total().map_or(-1.0, Estimate::value);
        ranked.sort_by(|a, b| total(b.1).total_cmp(&total(a.1)));
        ranked
    }

    /// The estimates from all runs.
    #[must_use]
    pub fn whole(&self) -> &SobolIndices {
        &self.indices
    }
}
