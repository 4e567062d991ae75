//! How the runs of a campaign are counted in its verdicts.

use serde::{Deserialize, Serialize};

use super::Looks;

/// How the runs of a campaign are counted in its verdicts: how often they were looked at, and which of them are independent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counting {
    #[serde(default, skip_serializing_if = "Looks::is_once")]
    looks: Looks,
    /// Runs of a group, if they have something in common.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    dependent_runs: Option<u64>,
}

impl Counting {
    /// Of runs that are looked at so often. If so many runs that follow each other have something in common, as the flights of a vehicle,
    /// the first of each `group` is counted; of independent runs it is 1.
    #[must_use]
    pub fn new(looks: Looks, group: u64) -> Self {
        Self { looks, dependent_runs: (group > 1).then_some(group) }
    }

    /// The same of runs that are looked at so often.
    #[must_use]
    pub fn looked_at(self, looks: Looks) -> Self {
        Self { looks, ..self }
    }

    /// How often the runs were looked at.
    #[must_use]
    pub fn looks(self) -> Looks {
        self.looks
    }

    /// Runs that follow each other and have something in common, of which the first is counted; 1 if all runs are independent.
    #[must_use]
    pub fn group(self) -> u64 {
        self.dependent_runs.unwrap_or(1).max(1)
    }
}
