//! A run under way, and what becomes of its springs.

use smallvec::SmallVec;
use std::borrow::Borrow;

use crate::{
    RunError, Separation, Settings, Spring,
    layout::INLINE_SPRINGS,
    state::{self, State},
};

/// What has become of one spring; times in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fate {
    /// It never pushes.
    Failed,
    /// It has yet to start.
    Waiting,
    Pushing,
    /// It came to its free length before it started, and never pushed.
    Missed {
        time: f64,
    },
    /// It let go, and was shorter than its free length again from a time on.
    Released {
        time: f64,
        recompressed: Option<f64>,
    },
}

impl Fate {
    pub(crate) fn of(spring: &Spring) -> Self {
        match spring.start_s() {
            Some(start) if spring.can_push() => {
                if start == 0.0 {
                    Self::Pushing
                } else {
                    Self::Waiting
                }
            }
            _ => Self::Failed,
        }
    }

    /// Comes to its free length.
    pub(crate) fn end(&mut self, time: f64) {
        match self {
            Self::Waiting => *self = Self::Missed { time },
            Self::Pushing => *self = Self::Released { time, recompressed: None },
            Self::Failed | Self::Missed { .. } | Self::Released { .. } => {}
        }
    }

    /// Whether it pushes or will.
    pub(crate) fn is_open(&self) -> bool {
        matches!(self, Self::Waiting | Self::Pushing)
    }

    /// When it came to its free length, whether it pushed or not.
    pub(crate) fn ended(&self) -> Option<f64> {
        match self {
            Self::Missed { time } | Self::Released { time, .. } => Some(*time),
            Self::Failed | Self::Waiting | Self::Pushing => None,
        }
    }

    /// When it let go; none of one that never pushed.
    pub(crate) fn let_go(&self) -> Option<f64> {
        self.ended().filter(|_| matches!(self, Self::Released { .. }))
    }
}

/// What becomes of the springs, in their order.
pub(crate) type Fates = SmallVec<[Fate; INLINE_SPRINGS]>;

/// A run under way in one lane.
#[derive(Clone, Debug)]
pub(crate) struct Track<S> {
    pub(crate) separation: S,
    pub(crate) time: f64,
    pub(crate) steps: u32,
    pub(crate) springs: Fates,
    /// The time that the springs act, about.
    pub(crate) time_scale: f64,
}

impl<S: Borrow<Separation>> Track<S> {
    /// The springs that push or will.
    pub(crate) fn pushing(&self) -> impl Iterator<Item = usize> {
        let springs = self.springs.iter().enumerate();
        springs.filter(|(_, fate)| fate.is_open()).map(|(i, _)| i)
    }

    /// When the next spring starts.
    pub(crate) fn next_start(&self) -> f64 {
        let springs = self.separation.borrow().springs().iter().zip(&self.springs);
        let starts =
            springs.filter(|(_, fate)| **fate == Fate::Waiting).filter_map(|(s, _)| s.start_s());
        starts.fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn all_released(&self) -> bool {
        self.pushing().next().is_none()
    }

    /// That the springs have let go by the horizon.
    pub(crate) fn check(&self, state: &State, settings: &Settings) -> Result<(), RunError> {
        match self.pushing().next() {
            Some(spring) if self.time >= settings.horizon_s() => {
                let gap = state::gap(self.separation.borrow(), state, spring);
                Err(RunError::NotReleased {
                    springs: self.pushing().map(|i| i + 1).collect(),
                    horizon: settings.horizon_s(),
                    compression: -gap.value,
                    rate: gap.rate,
                })
            }
            _ => Ok(()),
        }
    }
}
