//! A claim of a paper, and whether it stands.

use gyradius_statistics::Interval;
use serde::{Deserialize, Serialize};

/// Whether a claim stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Verdict {
    /// It does.
    Holds,
    /// For some of what it says, or under one reading.
    HoldsInPart,
    /// It does not.
    DoesNotHold,
    /// More runs are needed.
    NotTested,
}

impl Verdict {
    /// In words.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::HoldsInPart => "holds in part",
            Self::DoesNotHold => "does not hold",
            Self::NotTested => "undecided",
        }
    }

    /// All hold: holds. Some do: in part. None does: it does not hold. Otherwise nothing can be told.
    pub(crate) fn of_all(parts: &[Self]) -> Self {
        let any = |verdict| parts.contains(&verdict);
        if any(Self::Holds) || any(Self::HoldsInPart) {
            if parts.iter().all(|p| *p == Self::Holds) { Self::Holds } else { Self::HoldsInPart }
        } else if any(Self::DoesNotHold) && !any(Self::NotTested) {
            Self::DoesNotHold
        } else {
            Self::NotTested
        }
    }

    /// Whether a number known to an interval is above a line.
    pub(crate) fn above(interval: Interval, line: f64) -> Self {
        if interval.lower() > line {
            Self::Holds
        } else if interval.upper() < line {
            Self::DoesNotHold
        } else {
            Self::NotTested
        }
    }
}

/// A claim, what the runs show, and whether it stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Claim {
    pub(crate) claim: String,
    /// One finding for each reading.
    pub(crate) findings: Vec<String>,
    pub(crate) verdict: Verdict,
}
