//! When a motion is looked at: times that are even, or scattered, each step of time short enough to follow the bodies as they turn.

use gyradius_report::round_below;
use gyradius_separation::{BodyState, Step};
use std::f64::consts::PI;

/// How far the body that turns faster turns from one moment to the next, rad: enough to see rates, attitudes and nutation
/// between the two.
pub(super) const TURN: f64 = 20.0 / 180.0 * PI;
/// Moments to the last release, at least about.
const PUSHING: f64 = 100.0;
/// The fractional part of the golden ratio, the multiples of which fill the time between two moments evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// The rate of the faster of two bodies, rad/s.
fn rate(states: &[BodyState; 2]) -> f64 {
    let [payload, stage] = states.map(|state| state.angular_velocity.norm());
    payload.max(stage)
}

/// The rate of the faster body in a step, at its start or its end, rad/s.
pub(super) fn fastest(step: &Step) -> f64 {
    rate(&step.states_at(step.start_s())).max(rate(&step.states_at(step.end_s())))
}

/// A part of a motion in time, and how long its steps of time are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    start: f64,
    interval: f64,
    /// Whether a body turns further than it should from one moment to the next, since there may be no more moments.
    pub(super) is_coarse: bool,
}

impl Part {
    /// Of the steps that start between two times, s, so many moments at most, about. The last release is at `last`.
    pub(super) fn new((start, end): (f64, f64), steps: &[Step], last: f64, most: f64) -> Self {
        let within = steps.iter().filter(|step| (start..end).contains(&step.start_s()));
        let turn = TURN / within.map(fastest).fold(f64::MIN_POSITIVE, f64::max);
        let least = (end - start) / most;
        let interval = round_below(f64::min(last / PUSHING, turn).max(least));
        Self { start, interval, is_coarse: interval > turn }
    }
}

/// Times in a part of a motion: multiples of its step of time, not sums; each later by another share of it if they are scattered.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    interval: f64,
    is_scattered: bool,
    next: u64,
}

impl Grid {
    pub(super) fn new(part: Part, is_scattered: bool) -> Self {
        let mut grid = Self { interval: part.interval, is_scattered, next: 0 };
        if part.start > 0.0 {
            // The start itself belongs to the part before.
            grid.next = (part.start / part.interval) as u64;
            while grid.time() <= part.start {
                grid.next += 1;
            }
        }
        grid
    }

    fn time(&self) -> f64 {
        let next = self.next as f64;
        let later = if self.is_scattered { (next * GOLDEN).fract() } else { 0.0 };
        (next + later) * self.interval
    }

    /// The times before one that have not been given yet.
    pub(super) fn before(&mut self, end_s: f64) -> impl Iterator<Item = f64> + '_ {
        std::iter::from_fn(move || {
            let time = self.time();
            (time < end_s).then(|| {
                self.next += 1;
                time
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// However late a part begins, and however short its steps: its first times follow its start, by about a step each.
        #[test]
        fn times_follow_the_start_of_a_part(
            start in prop_oneof![0.0..10.0f64, 1e3..1e9f64],
            interval in -9.0..2.0f64,
            is_scattered: bool,
        ) {
            let interval = 10.0_f64.powf(interval);
            let mut grid = Grid::new(Part { start, interval, is_coarse: false }, is_scattered);
            let times: Vec<f64> = grid.before(start + 10.0 * interval).collect();
            let rounding = 4.0 * f64::EPSILON * start;
            prop_assert!((7..=11).contains(&times.len()) || rounding > 0.1 * interval, "{times:?}");
            prop_assert!(times.iter().all(|t| *t > start || start == 0.0), "{times:?}");
            prop_assert!(times.windows(2).all(|two| two[1] - two[0] < 2.0 * interval + rounding));
            prop_assert!(times.first().is_none_or(|first| first - start < 2.0 * interval + rounding));
        }
    }
}
