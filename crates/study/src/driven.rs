//! What drives outputs, as it was found.

use gyradius_statistics::{Estimate, SobolIndex, SobolIndices};
use serde::{Deserialize, Serialize};

/// What drives the outcome of the runs of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drivers {
    /// The model.
    pub model: String,
    /// Base runs, each of which is done once for each group of inputs and twice more.
    pub base_runs: u64,
    /// Runs in all.
    pub runs: u64,
    /// Runs that failed.
    pub failed: u64,
    /// The groups of inputs.
    pub groups: Vec<String>,
    /// The outputs that vary.
    pub outputs: Vec<Driven>,
    /// The others, which are the same in all of these runs but for rounding, or missing: names of columns and of requirements.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<String>,
    /// SHA-256 of what the runs depend on, and of the requirements.
    pub(crate) identity: String,
}

impl Drivers {
    /// Whether they are to be found again, where runs that failed are done again.
    pub(crate) fn is_stale(&self, again: bool) -> bool {
        again && self.failed > 0
    }
}

/// What drives an output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Driven {
    /// The name of the column, or of the requirement, of which it is whether a run does not keep it.
    pub output: String,
    /// The unit of the column; none of a requirement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// What each group drives, in their order.
    pub indices: SobolIndices,
}

impl Driven {
    /// The groups that drive most of it, by their total indices, the first of them first; those without an index last.
    #[must_use]
    pub fn ranked<'a>(&'a self, groups: &'a [String]) -> Vec<(&'a str, &'a SobolIndex)> {
        let all = groups.iter().map(String::as_str).zip(self.indices.groups());
        let mut ranked: Vec<(&str, &SobolIndex)> = all.collect();
        let total = |index: &SobolIndex| index.total().map_or(-1.0, Estimate::value);
        ranked.sort_by(|a, b| total(b.1).total_cmp(&total(a.1)));
        ranked
    }
}
