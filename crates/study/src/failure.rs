//! Why a run failed.

use gyradius_clearance::OutlineError;
use gyradius_separation::{AnyLoad, BodyError, RunError, SeparationError};
use std::borrow::Cow;

/// Why a run failed, with the numbers of the run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunFailure {
    /// What was drawn makes no separation.
    #[error(transparent)]
    Refused(#[from] SeparationError),
    /// The separation does not come to an end.
    #[error(transparent)]
    Broken(#[from] RunError),
    /// The outline of a body cannot be placed about its mass centre.
    #[error("{body}: outline: {problem}")]
    Outline {
        /// Whose.
        body: &'static str,
        /// Why.
        problem: OutlineError,
    },
}

impl From<&RunFailure> for gyradius_campaign::Failure {
    fn from(failure: &RunFailure) -> Self {
        Self::new(failure.kind(), failure.to_string())
    }
}

impl RunFailure {
    /// What kind it is, without numbers, so that failures of a kind can be counted.
    #[must_use]
    pub fn kind(&self) -> Cow<'static, str> {
        let plain: &'static str = match self {
            Self::Refused(SeparationError::Body { body, problem }) => {
                let what = match problem {
                    BodyError::Mass { .. } => "mass not positive",
                    BodyError::NotPositiveDefinite { .. } => "inertia not positive definite",
                    _ => "state refused",
                };
                return format!("{body}: {what}").into();
            }
            Self::Refused(SeparationError::Load { load, .. }) => {
                return format!("{load}: impossible").into();
            }
            Self::Refused(SeparationError::NonePushes) => {
                let kinds: Vec<_> = AnyLoad::KINDS.iter().map(|kind| kind.name()).collect();
                return format!("no {} pushes", kinds.join(" or ")).into();
            }
            Self::Refused(SeparationError::TouchingPads { load, .. }) => {
                return format!("points of a {} touch", load.kind).into();
            }
            Self::Refused(SeparationError::ShortStroke { .. }) => "stroke too short",
            Self::Refused(_) => "separation refused",
            Self::Broken(RunError::NotReleased { loads, .. }) => {
                let mut kinds: Vec<_> = loads.iter().map(|load| load.kind.plural()).collect();
                kinds.dedup();
                return format!("{} not released within the horizon", kinds.join(" and ")).into();
            }
            Self::Broken(RunError::PadsMeet { load, .. }) => {
                return format!("points of a {} meet", load.kind).into();
            }
            Self::Broken(RunError::StepUnderflow { .. }) => "step underflow",
            Self::Broken(RunError::TooManySteps { .. }) => "too many steps",
            Self::Broken(RunError::NotFinite { .. }) => "numbers out of range",
            Self::Broken(_) => "integration failed",
            Self::Outline { body, .. } => return format!("{body}: outline beyond bounds").into(),
        };
        plain.into()
    }
}
