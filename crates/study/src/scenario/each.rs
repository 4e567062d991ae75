//! For what something is drawn: for each vehicle, or for each flight.

use serde::{Deserialize, Serialize};

/// For what something is drawn anew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Each {
    /// For every vehicle: all of its flights have the same.
    Vehicle,
    /// For every flight, which is every run.
    #[default]
    Flight,
}

impl Each {
    pub(crate) fn is_flight(&self) -> bool {
        *self == Self::Flight
    }
}

/// The key that says for what a law is drawn.
pub(crate) const DRAWN: &str = "drawn";
