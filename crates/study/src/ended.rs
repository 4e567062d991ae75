//! What ended the runs of a study, if they were not done to a number that was stated before.

use gyradius_campaign::Until;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What ended the runs of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ended {
    /// The rule, and how many runs there might have been.
    #[serde(flatten)]
    pub until: Until,
    /// How many there are of each model.
    pub runs: u64,
    /// How often they were looked at, if nothing was there before.
    looks: u64,
    /// Whether that was enough, and not the greatest number of runs.
    pub enough: bool,
}

impl Ended {
    /// Whether the runs were interrupted before the rule ended them or there were as many as there may be.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        !self.enough && self.runs < self.until.most_runs()
    }

    /// After so many runs, which were enough or not.
    pub(crate) fn new(until: &Until, runs: u64, enough: bool) -> Self {
        let looks = until.looks().take_while(|look| *look <= runs).count() as u64;
        Self { until: until.clone(), runs, looks, enough }
    }

    /// After how many runs of each model they were looked at.
    #[must_use]
    pub fn looks(&self) -> Vec<u64> {
        self.until.looks().take_while(|look| *look <= self.runs).collect()
    }
}

/// In a sentence.
impl fmt::Display for Ended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { until, runs, looks, enough } = self;
        if let Some(there) = until.first_look() {
            write!(
                f,
                "{there} runs a model were there before the rule was asked, more than it would have asked for. "
            )?;
        }
        let (rule, most, s) = (until.rule(), until.most_runs(), if *looks == 1 { "" } else { "s" });
        if self.is_interrupted() {
            write!(
                f,
                "The runs were interrupted: so far there are {runs} of each model, and with the rule “{rule}” there may be up to {most}."
            )
        } else if *enough {
            write!(
                f,
                "The rule “{rule}” ended the runs after {runs} of each model, at {looks} look{s}; there might have been {most}."
            )
        } else {
            write!(
                f,
                "The rule “{rule}” did not end the runs: there were {runs} of each model, which is the greatest number, at {looks} \
                 look{s}."
            )
        }
    }
}
