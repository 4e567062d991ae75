//! Steps of several runs: how far the series are good, which load ends, and when.

use std::fmt::Debug;

use crate::{
    RunError, Separation, Settings, bodies,
    expansion::{Expansion, Rotor},
    lanes::{Lanes, M3},
    layout::{ORDER, STATE, STOPS, TERMS},
    state::{self, State},
    track::{Fate, Fates, Track},
    vector,
};

/// Steps after which a separation is given up: ten thousand times what one takes.
const MAX_STEPS: u32 = 100_000;
/// Steps below this share of the time that the springs act are not taken.
const UNDERFLOW: f64 = 1e-13;
/// The square of a time that is this share of a step does not tell in the state.
const TINY: f64 = 1e-9;

/// What a batch asks of an integrator, with any number of lanes. As an object, it is compiled in this crate, once,
/// and not in every crate that runs a batch.
pub(crate) trait Integrate: Debug + Send + Sync {
    /// How many lanes it has.
    fn width(&self) -> usize;

    /// Puts a run at its start into a lane.
    fn load(&mut self, lane: usize, run: &Separation) -> Track;

    /// Leaves a lane without a run.
    fn rest(&mut self, lane: usize);

    /// Expands the motion in all lanes.
    fn expand(&mut self);

    /// Takes the run in a lane on, to the last release or the horizon at most.
    fn step(&mut self, lane: usize, run: &Separation, track: &mut Track) -> Result<(), RunError>;

    /// The state that a lane is in.
    fn state(&self, lane: usize) -> State;
}

/// Several runs, one in each lane.
#[derive(Debug)]
pub(crate) struct Integrator<const W: usize> {
    pub(crate) expansion: Expansion<W>,
    settings: Settings,
    machine: vector::Machine,
}

/// The expansion of all lanes, compiled for the vector units there are.
struct Expand<'a, const W: usize>(&'a mut Expansion<W>);

impl<const W: usize> vector::WithSimd for Expand<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: vector::Simd>(self, simd: S) {
        self.0.expand(simd);
    }
}

impl<const W: usize> Integrator<W> {
    pub(crate) fn new(settings: Settings) -> Self {
        Self::on(vector::Machine::new(), settings)
    }

    /// With the instructions of a machine.
    pub(crate) fn on(machine: vector::Machine, settings: Settings) -> Self {
        // The first term left out, extrapolated geometrically from the last two, is the tolerance
        // (Jorba & Zou 2005, §3.2). Few terms tell less: half of that.
        let stretch = STOPS.map(|order| {
            let root = libm::pow(settings.relative_tolerance(), 1.0 / (order + 1) as f64);
            if order < ORDER { 0.5 * root } else { root }
        });
        Self { expansion: Expansion::new(stretch), settings, machine }
    }

    /// The series about the state that a lane is in.
    pub(crate) fn series(&self, lane: usize) -> [State; TERMS] {
        let mut series = self.expansion.terms.map(|term| term.state.map(|x| x.0[lane]));
        series[self.expansion.order[lane] + 1..].fill([0.0; STATE]);
        series
    }

    fn set_state(&mut self, lane: usize, state: &State) {
        for (to, from) in self.expansion.terms[0].state.iter_mut().zip(state) {
            to.0[lane] = *from;
        }
    }

    /// Takes the run in a lane as far as its expansion is good, to the next end or start of a
    /// load, or to a time, whichever comes first. Returns the length of the step.
    pub(crate) fn advance(
        &mut self,
        lane: usize,
        run: &Separation,
        track: &mut Track,
        until: f64,
    ) -> Result<f64, RunError> {
        let reach = self.expansion.reach.0[lane];
        // NaN goes to the error as well.
        if !(reach > UNDERFLOW * track.time_scale) {
            return Err(self.failure(lane, track, reach));
        }
        track.steps += 1;
        if track.steps > MAX_STEPS {
            return Err(RunError::TooManySteps {
                steps: MAX_STEPS,
                time: track.time,
                relative_tolerance: self.settings.relative_tolerance(),
            });
        }
        let loads = run.seated();
        let start = track.next_start(loads);
        let h = reach.min(until.min(start) - track.time);
        let order = self.expansion.order[lane];
        let mut first: Option<(f64, usize)> = None;
        for i in track.open() {
            let events = self.expansion.loads.get(loads.slot(i));
            // Most come nowhere near.
            if events.may_end(lane)
                && let Some(x) = events.end(lane, order, h)
                && first.is_none_or(|(earliest, _)| x * h < earliest)
            {
                first = Some((x * h, i));
            }
        }
        let mut taken = h;
        let mut next = match first {
            Some((time, load)) => {
                taken = time;
                let (mut next, slope) = self.with_slope(lane, time);
                // The series of the gap ends an order before that of the state.
                let gap = loads.get(load).gap(&next);
                let correction = -gap.value / gap.rate;
                if time > 0.0 && correction.abs() <= 1e-3 * h {
                    taken = (time + correction).clamp(0.0, h);
                    if (taken - time).abs() <= TINY * h {
                        next = std::array::from_fn(|i| next[i] + (taken - time) * slope[i]);
                    } else {
                        next = self.at(lane, taken);
                    }
                }
                next
            }
            None if h == reach => self.expansion.end.map(|x| x.0[lane]),
            None => self.at(lane, h),
        };
        // Points that fly straight at each other: the equations of motion do not notice. The first to meet counts.
        let mut meeting: Option<(f64, usize)> = None;
        for i in track.open().filter(|i| track.loads[*i] == Fate::Acting) {
            let events = self.expansion.loads.get(loads.slot(i));
            if let Some(x) = events.loses_direction(lane, order, taken)
                && meeting.is_none_or(|(earliest, _)| x < earliest)
            {
                meeting = Some((x, i));
            }
        }
        if let Some((x, load)) = meeting {
            let (after, start) = (x * taken, track.time);
            self.press_again(lane, run, track, after);
            return Err(Self::lost_direction(run, load, start + after, &self.at(lane, after)));
        }
        state::normalize(&mut next);
        // No way out of the loop: it goes in vector lanes.
        if !next.iter().fold(true, |finite, x| finite & x.is_finite()) {
            return Err(self.failure(lane, track, reach));
        }
        self.press_again(lane, run, track, taken);
        let starts = first.is_none() && start <= until && h >= start - track.time;
        track.time = if starts { start } else { track.time + taken };
        if let Some((_, ends)) = first {
            for (i, fate) in track.loads.iter_mut().enumerate() {
                // Those that are at their ends to rounding end together.
                let ended = || {
                    let load = loads.get(i);
                    // Most come nowhere near.
                    self.expansion.loads.get(loads.slot(i)).may_all_but_end(lane)
                        && load.gap(&next).value >= -load.rounding(&next)
                };
                if fate.is_open() && (i == ends || ended()) {
                    fate.end(track.time);
                    self.expansion.loads.act(loads.slot(i), lane, false);
                }
            }
        }
        for i in 0..track.loads.len() {
            let load = loads.get(i);
            if track.loads[i] == Fate::Waiting && load.start_s().is_some_and(|s| s <= track.time) {
                if !load.can_start(&next) {
                    return Err(Self::lost_direction(run, i, track.time, &next));
                }
                track.loads[i] = Fate::Acting;
                self.expansion.loads.act(loads.slot(i), lane, true);
            }
        }
        self.set_state(lane, &next);
        Ok(taken)
    }

    /// The state after a time.
    pub(crate) fn at(&self, lane: usize, time: f64) -> State {
        let mut sum = [0.0; STATE];
        for term in self.expansion.terms[..=self.expansion.order[lane]].iter().rev() {
            for (s, x) in sum.iter_mut().zip(&term.state) {
                *s = *s * time + x.0[lane];
            }
        }
        sum
    }

    /// The state after a time, and how fast it changes.
    fn with_slope(&self, lane: usize, time: f64) -> (State, State) {
        let (mut sum, mut slope) = ([0.0; STATE], [0.0; STATE]);
        for term in self.expansion.terms[..=self.expansion.order[lane]].iter().rev() {
            for ((sum, slope), x) in sum.iter_mut().zip(&mut slope).zip(&term.state) {
                *slope = *slope * time + *sum;
                *sum = *sum * time + x.0[lane];
            }
        }
        (sum, slope)
    }

    /// Notes the loads that have ended and are pressed again within a time from the start of a step.
    #[inline]
    fn press_again(&self, lane: usize, run: &Separation, track: &mut Track, taken: f64) {
        if !(taken > 0.0) {
            return;
        }
        let order = self.expansion.order[lane];
        for (i, fate) in track.loads.iter_mut().enumerate() {
            if let Fate::Ended { pressed_again: again @ None, .. } = fate {
                let events = self.expansion.loads.get(run.seated().slot(i));
                let back = events.comes_back(lane, order, taken);
                *again = back.map(|x| track.time + x * taken);
            }
        }
    }

    /// That the force of a load has lost its direction, when, and in which state.
    fn lost_direction(run: &Separation, load: usize, time: f64, state: &State) -> RunError {
        let loads = run.seated();
        RunError::PadsMeet { load: loads.id(load), time, speed: loads.get(load).speed(state) }
    }

    fn failure(&self, lane: usize, track: &Track, step: f64) -> RunError {
        let time = track.time;
        let finite = self.series(lane).iter().flatten().all(|x| x.is_finite());
        if finite && step.is_finite() {
            RunError::StepUnderflow { time, step }
        } else {
            RunError::NotFinite { time }
        }
    }
}

impl<const W: usize> Integrate for Integrator<W> {
    fn width(&self) -> usize {
        W
    }

    fn load(&mut self, lane: usize, run: &Separation) -> Track {
        let expansion = &mut self.expansion;
        expansion.busy[lane] = true;
        let set = |to: &mut [Lanes<W>], from: &[f64]| {
            for (to, from) in to.iter_mut().zip(from) {
                to.0[lane] = *from;
            }
        };
        let matrix = |to: &mut M3<W>, from: &nalgebra::Matrix3<f64>| {
            for (row, from) in to.iter_mut().zip(from.row_iter()) {
                for (to, from) in row.iter_mut().zip(from.iter()) {
                    to.0[lane] = *from;
                }
            }
        };
        let rotor = |to: &mut Rotor<W>, body: &crate::Body| {
            matrix(&mut to.inertia, body.inertia().matrix());
            matrix(&mut to.inverse, body.inverse_inertia());
        };
        rotor(&mut expansion.payload, run.payload().body());
        rotor(&mut expansion.stage, run.stage().body());
        expansion.radius.0[lane] = 0.0;
        expansion.inverse_mass.0[lane] = run.inverse_reduced_mass();
        let scales = bodies::scales(run);
        set(&mut expansion.inverse_scale, &scales.map(|s| 1.0 / s));
        let loads: Fates = run.seated().iter().map(Fate::of).collect();
        expansion.loads.set(lane, run.seated());
        for (i, fate) in loads.iter().enumerate() {
            expansion.loads.act(run.seated().slot(i), lane, *fate == Fate::Acting);
        }
        self.set_state(lane, &bodies::initial(run));
        Track { time: 0.0, steps: 0, loads, time_scale: bodies::time_scale(&scales) }
    }

    fn rest(&mut self, lane: usize) {
        self.expansion.busy[lane] = false;
    }

    fn expand(&mut self) {
        self.machine.run::<W>(Expand(&mut self.expansion));
    }

    fn step(&mut self, lane: usize, run: &Separation, track: &mut Track) -> Result<(), RunError> {
        self.advance(lane, run, track, self.settings.horizon_s())?;
        track.check(run, &self.state(lane), &self.settings)
    }

    fn state(&self, lane: usize) -> State {
        std::array::from_fn(|i| self.expansion.terms[0].state[i].0[lane])
    }
}

#[cfg(test)]
mod order;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, Spring};
    use gyradius_inertia::InertiaMatrix;
    use nalgebra::Vector3;

    /// The paper's separation: two releases are soon after others, one soon after a step. A change is
    /// one of the speed.
    #[test]
    fn degrees_are_pinned() {
        let inertia = |moments, products| InertiaMatrix::from_entries(moments, products).unwrap();
        let spring = |k: f64, x: f64, y: f64| {
            Spring::new(k, 0.1, Vector3::new(x, y, -0.9), Vector3::new(x, y, 0.9)).unwrap()
        };
        let separation = Separation::new(
            Body::new(1e4, inertia([5e3, 4e3, 3e3], [20.0, 2.0, -50.0])).unwrap().at(Vector3::z()),
            Body::new(4e3, inertia([6.7e3, 6.7e3, 2e3], [0.0, 20.0, -20.0]))
                .unwrap()
                .at(-Vector3::z()),
            &[
                spring(1e5, 1.0, 1.0),
                spring(1e5, -1.0, 1.0),
                spring(3e4, 1.0, -1.0),
                spring(3e4, -1.0, -1.0),
            ],
        )
        .unwrap();
        let mut integrator = Integrator::<4>::new(Settings::default());
        let mut track = integrator.load(0, &separation);
        let mut degrees = vec![];
        while !track.all_released() {
            integrator.expand();
            degrees.push(integrator.expansion.order[0]);
            integrator.step(0, &separation, &mut track).unwrap();
        }
        assert_eq!(degrees, [14, 14, 14, 14, 9, 5, 14, 14, 5]);
    }
}
