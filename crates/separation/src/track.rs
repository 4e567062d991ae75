//! A run under way, and what becomes of its loads.

use smallvec::SmallVec;

use crate::{
    RunError, Separation, Settings, layout::INLINE_LOADS, load::Seated, loads::Loads, state::State,
};

/// What has become of one load; times in s.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", deny_unknown_fields))]
pub(crate) enum Fate {
    /// It never acts.
    Failed,
    /// It has yet to start.
    Waiting,
    Acting,
    /// It came to its end before it started, and never acted.
    Missed {
        #[cfg_attr(feature = "serde", serde(rename = "time_s"))]
        time: f64,
    },
    /// It acted to its end, and was pressed back from there from a time on.
    Ended {
        #[cfg_attr(feature = "serde", serde(rename = "time_s"))]
        time: f64,
        #[cfg_attr(feature = "serde", serde(rename = "pressed_again_s"))]
        pressed_again: Option<f64>,
    },
}

impl Fate {
    pub(crate) fn of(load: &dyn Seated) -> Self {
        match load.start_s() {
            None => Self::Failed,
            Some(0.0) => Self::Acting,
            Some(_) => Self::Waiting,
        }
    }

    /// Comes to its end.
    pub(crate) fn end(&mut self, time: f64) {
        match self {
            Self::Waiting => *self = Self::Missed { time },
            Self::Acting => *self = Self::Ended { time, pressed_again: None },
            Self::Failed | Self::Missed { .. } | Self::Ended { .. } => {}
        }
    }

    /// Whether it acts or will.
    pub(crate) fn is_open(&self) -> bool {
        matches!(self, Self::Waiting | Self::Acting)
    }

    /// When it came to its end, whether it acted or not.
    pub(crate) fn ended(&self) -> Option<f64> {
        match self {
            Self::Missed { time } | Self::Ended { time, .. } => Some(*time),
            Self::Failed | Self::Waiting | Self::Acting => None,
        }
    }

    /// When it was pressed again after it had let go, if it was.
    pub(crate) fn pressed_again(&self) -> Option<f64> {
        match self {
            Self::Ended { pressed_again, .. } => *pressed_again,
            Self::Failed | Self::Waiting | Self::Acting | Self::Missed { .. } => None,
        }
    }

    /// When it let go; none of one that never acted.
    pub(crate) fn let_go(&self) -> Option<f64> {
        self.ended().filter(|_| matches!(self, Self::Ended { .. }))
    }
}

/// What becomes of the loads, in their order.
pub(crate) type Fates = SmallVec<[Fate; INLINE_LOADS]>;

/// A run under way in one lane.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub(crate) time: f64,
    pub(crate) steps: u32,
    pub(crate) loads: Fates,
    /// The time that the loads act, about.
    pub(crate) time_scale: f64,
}

impl Track {
    /// The loads that act or will.
    pub(crate) fn open(&self) -> impl Iterator<Item = usize> {
        let loads = self.loads.iter().enumerate();
        loads.filter(|(_, fate)| fate.is_open()).map(|(i, _)| i)
    }

    /// When the next load starts.
    pub(crate) fn next_start(&self, loads: &Loads) -> f64 {
        let waiting = self.loads.iter().enumerate().filter(|(_, fate)| **fate == Fate::Waiting);
        let starts = waiting.filter_map(|(i, _)| loads.get(i).start_s());
        starts.fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn all_released(&self) -> bool {
        self.open().next().is_none()
    }

    /// That the loads have come to their ends by the horizon.
    pub(crate) fn check(
        &self,
        run: &Separation,
        state: &State,
        settings: &Settings,
    ) -> Result<(), RunError> {
        match self.open().next() {
            Some(load) if self.time >= settings.horizon_s() => {
                let loads = run.seated();
                let first = loads.get(load);
                let gap = first.gap(state);
                Err(RunError::NotReleased {
                    loads: self.open().map(|load| loads.id(load)).collect(),
                    horizon: settings.horizon_s(),
                    compression: -gap.value,
                    rate: gap.rate,
                    start: first.start_s().filter(|start| *start >= settings.horizon_s()),
                })
            }
            _ => Ok(()),
        }
    }
}
