//! All that lies between the start and the last release, as power series, step by step.

use smallvec::SmallVec;

use crate::{
    BodyState, Outcome, RunError, Separation, Settings, Snapshot, bodies,
    integrator::{Integrate, Integrator},
    layout::{INLINE_LOADS, ORDER, TERMS},
    state::{self, State},
    track::Fate,
};

/// A step of the integration: the motion between two times as a power series, which is the
/// integration itself and as accurate as it anywhere in between.
///
/// A step ends where its series ceases to be good or where a spring starts or lets go.
///
/// ```
/// # use gyradius_inertia::InertiaMatrix;
/// # use gyradius_separation::{Body, Separation, Spring};
/// # use nalgebra::Vector3;
/// # let inertia = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [0.0; 3])?;
/// # let point = |z| Vector3::new(0.5, 0.0, z);
/// # let spring = Spring::new(1e5, 0.1, point(-0.9), point(0.9))?;
/// # let (payload, stage) = (Body::new(1e4, inertia)?, Body::new(4e3, inertia)?);
/// # let separation =
/// #     Separation::new(payload.at(Vector3::z()), stage.at(-Vector3::z()), &[spring])?;
/// use gyradius_separation::Settings;
///
/// let mut times = vec![];
/// separation.follow(&Settings::default(), 0.0, |step| {
///     times.push(step.start_s());
///     assert!(step.at(step.end_s()).payload().state().velocity.z > 0.0);
/// })?;
/// assert_eq!(times[0], 0.0);
/// assert!(times.is_sorted());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    separation: Separation,
    start: f64,
    duration: f64,
    series: [State; TERMS],
    pushing: SmallVec<[bool; INLINE_LOADS]>,
    released: SmallVec<[usize; INLINE_LOADS]>,
    pressed_again: SmallVec<[(usize, f64); INLINE_LOADS]>,
}

impl Step {
    /// When it starts, s.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.start
    }

    /// When it ends, s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.start + self.duration
    }

    /// The springs that let go at its end, numbered from 0; none that never pushed.
    #[must_use]
    pub fn released(&self) -> &[usize] {
        &self.released
    }

    /// The springs that are pressed again within it, after they have let go and while others push or have yet to start:
    /// number from 0, and when that begins, s. They stay lost.
    #[must_use]
    pub fn pressed_again(&self) -> &[(usize, f64)] {
        &self.pressed_again
    }

    pub(crate) fn series(&self) -> &[State; TERMS] {
        &self.series
    }

    /// Bodies and springs at a time within the step, s; times outside count as its ends. At the end,
    /// springs that let go there still push, with a force of zero to rounding.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Snapshot {
        let (time, state) = self.state_at(time_s);
        Snapshot::new(&self.separation, &state, time, &self.pushing)
    }

    /// Payload and stage at a time within the step, s, as [`at`](Self::at) tells them, and no more.
    #[must_use]
    pub fn states_at(&self, time_s: f64) -> [BodyState; 2] {
        let (time, state) = self.state_at(time_s);
        bodies::states(&self.separation, &state, time)
    }

    /// The time of the step that is nearest to one, s, and the state then.
    fn state_at(&self, time_s: f64) -> (f64, State) {
        let time = if time_s > self.start { (time_s - self.start).min(self.duration) } else { 0.0 };
        let mut state = self.series[ORDER];
        for row in self.series[..ORDER].iter().rev() {
            for (s, x) in state.iter_mut().zip(row) {
                *s = *s * time + x;
            }
        }
        state::normalize(&mut state);
        (self.start + time, state)
    }
}

/// A whole separation: every step to the last release and on, if wished, through a coast.
///
/// ```
/// # use gyradius_inertia::InertiaMatrix;
/// # use gyradius_separation::{Body, Separation, Spring};
/// # use nalgebra::Vector3;
/// # let inertia = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [0.0; 3])?;
/// # let point = |z| Vector3::new(0.5, 0.0, z);
/// # let spring = Spring::new(1e5, 0.1, point(-0.9), point(0.9))?;
/// # let (payload, stage) = (Body::new(1e4, inertia)?, Body::new(4e3, inertia)?);
/// # let separation =
/// #     Separation::new(payload.at(Vector3::z()), stage.at(-Vector3::z()), &[spring])?;
/// use gyradius_separation::Settings;
///
/// let trajectory = separation.trajectory(&Settings::default(), 2.0)?;
/// assert_eq!(trajectory.end_s(), trajectory.outcome().release_time() + 2.0);
/// assert_eq!(trajectory.outcome(), &separation.run(&Settings::default())?);
/// assert_eq!(trajectory, separation.clone().trajectory(&Settings::default(), 2.0)?);
/// assert_ne!(trajectory, separation.trajectory(&Settings::default(), 1.0)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    steps: Vec<Step>,
    outcome: Outcome,
}

impl Trajectory {
    /// The steps, in the order of time, each from the end of the one before.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The bodies at the last release: what [`Separation::run`] gives, to the bit.
    #[must_use]
    pub fn outcome(&self) -> &Outcome {
        &self.outcome
    }

    /// Where the coast ends, s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.steps.last().map_or(0.0, Step::end_s)
    }

    /// Bodies and springs at a time from the opening of the clamp, s; none before it and after the
    /// end. At a release, the moment after it.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Option<Snapshot> {
        let step = self.steps.partition_point(|step| step.start <= time_s).checked_sub(1)?;
        let step = &self.steps[step];
        (time_s <= step.end_s()).then(|| step.at(time_s))
    }
}

impl Separation {
    /// Integrates to the release of the last spring and on for `coast_s`, and shows every step as it
    /// is taken. The steps of a failed run lead up to the failure, also where the points of a spring meet within a step; where
    /// no step can be taken on, they lead to the end of the last one, and there are none if that is the first. The outcome is that of [`Separation::run`].
    ///
    /// # Errors
    /// A spring is not released within the horizon, the integration cannot go on, or the coast is
    /// negative or not finite.
    pub fn follow(
        &self,
        settings: &Settings,
        coast_s: f64,
        mut observer: impl FnMut(&Step),
    ) -> Result<Outcome, RunError> {
        self.show(settings, coast_s, &mut observer)
    }

    /// The same with an observer of any type, so that the integrator is compiled in this crate alone.
    fn show(
        &self,
        settings: &Settings,
        coast_s: f64,
        observer: &mut dyn FnMut(&Step),
    ) -> Result<Outcome, RunError> {
        if !(coast_s >= 0.0 && coast_s.is_finite()) {
            return Err(RunError::Coast { value: coast_s });
        }
        let mut integrator = Integrator::<4>::new(*settings);
        let mut track = integrator.load(0, self);
        let mut outcome: Option<Outcome> = None;
        let mut end = settings.horizon_s();
        while outcome.is_none() || track.time < end {
            integrator.expand();
            let (start, series) = (track.time, integrator.series(0));
            let pushing: SmallVec<_> = track.loads.iter().map(|f| *f == Fate::Acting).collect();
            let before = track.loads.clone();
            let advanced = integrator.advance(0, self, &mut track, end);
            let duration = match &advanced {
                Ok(duration) => *duration,
                // The series is the motion up to where the points of a load meet.
                Err(RunError::PadsMeet { time, .. }) => time - start,
                Err(error) => return Err(error.clone()),
            };
            let loads = || track.loads.iter().zip(&before).enumerate();
            let released = loads().filter(|(_, (fate, was))| fate.let_go() != was.let_go());
            let pressed = loads().filter(|(_, (_, was))| was.pressed_again().is_none());
            // In the coast nothing pushes any more, and all springs are lost.
            let pressed = pressed.filter(|_| outcome.is_none());
            observer(&Step {
                separation: self.clone(),
                start,
                duration,
                series,
                pushing,
                released: released.map(|(i, _)| i).collect(),
                pressed_again: pressed
                    .filter_map(|(i, (fate, _))| Some((i, fate.pressed_again()?)))
                    .collect(),
            });
            advanced?;
            let state = integrator.state(0);
            track.check(self, &state, settings)?;
            if outcome.is_none() && track.all_released() {
                outcome = Some(Outcome::new(self, track.clone(), &state, settings));
                end = track.time + coast_s;
            }
        }
        outcome.ok_or(RunError::NotFinite { time: track.time })
    }

    /// The whole separation, with a coast of `coast_s` after the last release. Three kilobytes a
    /// step.
    ///
    /// # Errors
    /// Those of [`Separation::follow`].
    pub fn trajectory(&self, settings: &Settings, coast_s: f64) -> Result<Trajectory, RunError> {
        let mut steps = Vec::new();
        let outcome = self.follow(settings, coast_s, |step| steps.push(step.clone()))?;
        Ok(Trajectory { steps, outcome })
    }
}
