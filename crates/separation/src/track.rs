//! A run under way, and what becomes of its springs.

use smallvec::SmallVec;
use std::borrow::Borrow;

use crate::{
    RunError, Separation, Settings, Spring,
    layout::INLINE_SPRINGS,
    state::{self, State},
};

/// What becomes of one spring: when it comes to its free length, whether it pushed until then, and when
/// it is first shorter than its free length after that; and whether it is yet to start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Fate {
    pub(crate) released: Option<f64>,
    pub(crate) pushed: bool,
    pub(crate) recompressed: Option<f64>,
    pub(crate) waiting: bool,
}

impl Fate {
    pub(crate) fn of(spring: &Spring) -> Self {
        Self {
            released: (!spring.can_push()).then_some(0.0),
            pushed: false,
            recompressed: None,
            waiting: spring.can_push() && spring.start_s() != Some(0.0),
        }
    }

    pub(crate) fn pushes(&self) -> bool {
        self.released.is_none() && !self.waiting
    }

    /// When it let go, s; none of one that never pushed.
    pub(crate) fn let_go(&self) -> Option<f64> {
        self.released.filter(|_| self.pushed)
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
        springs.filter(|(_, fate)| fate.released.is_none()).map(|(i, _)| i)
    }

    /// When the next spring starts.
    pub(crate) fn next_start(&self) -> f64 {
        let springs = self.separation.borrow().springs().iter().zip(&self.springs);
        let starts = springs.filter(|(_, fate)| fate.waiting).filter_map(|(s, _)| s.start_s());
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
