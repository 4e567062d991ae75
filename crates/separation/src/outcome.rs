//! What a separation leaves: the bodies after the last release, and what is told of them.

use nalgebra::{Unit, Vector3};
use std::fmt;

use crate::{
    BodyState, EnergySplit, MovingBody, Separation, Settings, SpinMetrics, bodies,
    metrics::angle_of,
    rounding::Rounding,
    state::State,
    track::{Fate, Fates, Track},
};

/// The two bodies at the release of the last spring, from where they move freely, and as they were at
/// the start.
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
/// let outcome = separation.run(&Settings::default())?;
/// println!("{outcome}");
/// assert_eq!(outcome.release_order(), [[0]]);
/// // The spring acts beside the mass centres, and tips the bodies about axis 2, either way.
/// let [payload, stage] = outcome.tip_off();
/// assert!(payload.y < 0.0 && stage.y > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Outcome {
    springs: Fates,
    payload: MovingBody,
    stage: MovingBody,
    /// Payload and stage when the clamp opened.
    start: [BodyState; 2],
    /// Energy of the springs then, J.
    #[cfg_attr(feature = "serde", serde(rename = "stored_energy_j"))]
    stored: f64,
    steps: u32,
    rounding: Rounding,
}

impl Outcome {
    /// Of a run that is over, in the state that it came to.
    pub(crate) fn new(
        separation: &Separation,
        track: Track,
        state: &State,
        settings: &Settings,
    ) -> Self {
        let (payload, stage) = bodies::bodies(separation, state, track.time);
        let rounding = Rounding::new(separation, &track.loads, settings, track.steps);
        let start = [*separation.payload().state(), *separation.stage().state()];
        let stored = separation.stored_energy();
        let (springs, steps) = (track.loads, track.steps);
        Self { springs, payload, stage, start, stored, steps, rounding }
    }

    /// When each spring let go, s, in the order of the springs. None for a spring that never pushed:
    /// it failed, could not overcome its friction, or was late and came to its release length before its
    /// start.
    pub fn release_times(&self) -> impl ExactSizeIterator<Item = Option<f64>> {
        self.springs.iter().map(Fate::let_go)
    }

    /// From when on no spring can push, s: when the last one let go, or, where a late one never pushed,
    /// came to its release length. The bodies are told as they are then.
    #[must_use]
    pub fn release_time(&self) -> f64 {
        self.springs.iter().filter_map(Fate::ended).fold(0.0, f64::max)
    }

    /// The springs that were pressed below their release length again after they had let go, and while
    /// others still pushed or had yet to start: number from 0, and when that began, s. They stay lost.
    pub fn recompressed(&self) -> impl Iterator<Item = (usize, f64)> {
        let springs = self.springs.iter().enumerate();
        springs.filter_map(|(spring, fate)| Some((spring, fate.pressed_again()?)))
    }

    /// The payload after the last release.
    #[must_use]
    pub fn payload(&self) -> &MovingBody {
        &self.payload
    }

    /// The stage after the last release.
    #[must_use]
    pub fn stage(&self) -> &MovingBody {
        &self.stage
    }

    /// Payload and stage when the clamp opened.
    #[must_use]
    pub fn start(&self) -> [MovingBody; 2] {
        let [payload, stage] = self.start;
        [self.payload.body().moving(payload), self.stage.body().moving(stage)]
    }

    /// Velocity of the payload's mass centre relative to the stage's, inertial axes, m/s.
    #[must_use]
    pub fn relative_velocity(&self) -> Vector3<f64> {
        self.payload.state().velocity - self.stage.state().velocity
    }

    /// Speed at which the mass centres part, m/s.
    #[must_use]
    pub fn relative_speed(&self) -> f64 {
        self.relative_velocity().norm()
    }

    /// Angle between the relative velocity and the intended direction of separation (inertial axes),
    /// rad; none if the mass centres do not part, or by no more than
    /// [the rounding of the run](Self::velocity_rounding).
    #[must_use]
    pub fn direction_error(&self, intended: &Unit<Vector3<f64>>) -> Option<f64> {
        let velocity = self.relative_velocity();
        angle_of(&velocity, intended).filter(|_| velocity.norm() > self.rounding.velocity)
    }

    /// Angle between the payload's angular momentum about its mass centre and a direction in inertial
    /// axes, rad; none if the payload does not turn, or by no more than
    /// [the rounding of the run](Self::momentum_rounding).
    #[must_use]
    pub fn momentum_error(&self, intended: &Unit<Vector3<f64>>) -> Option<f64> {
        let momentum = self.payload.spin_angular_momentum().norm();
        self.payload.momentum_error(intended).filter(|_| momentum > self.rounding.momentum)
    }

    /// An angular momentum of the payload up to this, kg·m²/s, is nothing but rounding of the run, and
    /// has no direction: what its springs exchanged, times the tolerance and the rounding of doubles
    /// (`docs/models/separation.md`).
    #[must_use]
    pub fn momentum_rounding(&self) -> f64 {
        self.rounding.momentum
    }

    /// A velocity of the mass centres from each other up to this, m/s, is nothing but rounding of the run, and has no direction.
    #[must_use]
    pub fn velocity_rounding(&self) -> f64 {
        self.rounding.velocity
    }

    /// Tip-off rates: angular velocities of payload and stage after the last release less those at the
    /// start of the separation, each in its body's axes, rad/s.
    #[must_use]
    pub fn tip_off(&self) -> [Vector3<f64>; 2] {
        let of = |after: &MovingBody, before: &BodyState| {
            after.state().angular_velocity - before.angular_velocity
        };
        [of(&self.payload, &self.start[0]), of(&self.stage, &self.start[1])]
    }

    /// The springs in the order in which they let go, numbered from 0; those that let go at one time together.
    /// One that never pushed has no place in it.
    #[must_use]
    pub fn release_order(&self) -> Vec<Vec<usize>> {
        let times =
            self.release_times().enumerate().filter_map(|(spring, time)| Some((time?, spring)));
        let mut times: Vec<(f64, usize)> = times.collect();
        times.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let groups = times.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq());
        groups.map(|group| group.iter().map(|(_, spring)| *spring).collect()).collect()
    }

    /// Where the energy of the springs has gone.
    #[must_use]
    pub fn energy_split(&self) -> EnergySplit {
        EnergySplit::new(self.stored, &self.start(), &[self.payload, self.stage])
    }

    /// Wobble, nutation, coning and the rest, of the payload about the given body axis. A payload whose
    /// angular momentum is [rounding](Self::momentum_rounding) does not turn.
    #[must_use]
    pub fn spin_metrics(&self, spin_axis: &Unit<Vector3<f64>>) -> SpinMetrics {
        let (body, state) = (self.payload.body(), self.payload.state());
        let rounding = self.rounding.momentum;
        SpinMetrics::above(body.inertia(), &state.angular_velocity, spin_axis, rounding)
    }

    /// Integration steps taken, each an expansion of the motion, to order 14 at most.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.steps
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [payload, stage] = self.tip_off().map(|rate| rate.norm());
        write!(
            f,
            "free from {} s, parting at {} m/s, tip-off rates {payload} rad/s (payload) and {stage} rad/s \
             (stage)",
            self.release_time(),
            self.relative_speed()
        )
    }
}
