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
    /// How many there are of each model; if they were interrupted, how many first runs are there of every model.
    pub runs: u64,
    /// How often they were looked at, from the first look that counts.
    looks: u64,
    /// Whether that was enough, and not the greatest number of runs.
    pub enough: bool,
    /// Whether the runs were interrupted: nobody knows yet what ends them.
    #[serde(default, rename = "interrupted", skip_serializing_if = "std::ops::Not::not")]
    is_interrupted: bool,
}

impl Ended {
    /// Whether the runs were interrupted: nobody knows yet what ends them.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        self.is_interrupted
    }

    /// Interrupted before anything ended them.
    pub(crate) fn not_yet(until: &Until) -> Self {
        Self { is_interrupted: true, ..Self::new(until, 0, false) }
    }

    /// The same, if they were interrupted: when the first runs of every model up to so many were there.
    pub(crate) fn with_first_runs(self, runs: u64) -> Self {
        match self.is_interrupted {
            true => Self { is_interrupted: true, ..Self::new(&self.until, runs, false) },
            false => self,
        }
    }

    /// After so many runs, which were enough or not.
    pub(crate) fn new(until: &Until, runs: u64, enough: bool) -> Self {
        let looks = until.looks().take_while(|look| *look <= runs).count() as u64;
        Self { until: until.clone(), runs, looks, enough, is_interrupted: false }
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
        let Self { until, runs, looks, enough, is_interrupted } = self;
        if let Some(first) = until.first_look() {
            write!(
                f,
                "The first look that counts is at {first} runs of each model, as the scenario says: gyradius writes that into it where runs up to \
                 that number were done before the rule began. "
            )?;
        }
        let (rule, most) = (until.rule(), until.most_runs());
        // Those before the first one that counts were at fewer runs, or before failed runs were done again.
        let looks = match (looks, until.first_look()) {
            (1, None) => "1 look".to_owned(),
            (1, Some(_)) => "1 look that counts".to_owned(),
            (looks, None) => format!("{looks} looks"),
            (looks, Some(_)) => format!("{looks} looks that count"),
        };
        if *is_interrupted {
            write!(
                f,
                "The runs were interrupted: so far there are {runs} of every model, counted up to the first that is missing, and with the rule \
                 “{rule}” there may be up to {most}."
            )
        } else if *enough {
            write!(
                f,
                "The rule “{rule}” ended the runs after {runs} of each model, at {looks}; there might have been {most}."
            )
        } else {
            write!(
                f,
                "The rule “{rule}” did not end the runs: there were {runs} of each model, which is the greatest number, at \
                 {looks}."
            )
        }
    }
}
