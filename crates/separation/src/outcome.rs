use nalgebra::{Unit, Vector3};

use crate::{EnergySplit, MovingBody, Separation, SpinMetrics, metrics::angle_of, track::Fates};

/// The two bodies at the release of the last spring, from where they move freely.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    pub(crate) springs: Fates,
    pub(crate) payload: MovingBody,
    pub(crate) stage: MovingBody,
    pub(crate) steps: u32,
}

impl Outcome {
    /// When each spring let go, s, in the order of the springs: when it came to its free length, whether
    /// it had started by then or not; zero for one that never pushes.
    pub fn release_times(&self) -> impl ExactSizeIterator<Item = f64> {
        // All have, or there would be no outcome.
        self.springs.iter().map(|fate| fate.released.unwrap_or(f64::NAN))
    }

    /// When the last spring let go, s.
    #[must_use]
    pub fn release_time(&self) -> f64 {
        self.release_times().fold(0.0, f64::max)
    }

    /// The springs that were pressed below their free length again after they had let go, and while
    /// others still pushed: number from 1, and when that began, s. They stay lost.
    pub fn recompressed(&self) -> impl Iterator<Item = (usize, f64)> {
        self.springs.iter().enumerate().filter_map(|(i, fate)| Some((i + 1, fate.recompressed?)))
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
    /// rad; none if the mass centres do not part.
    #[must_use]
    pub fn direction_error(&self, intended: &Unit<Vector3<f64>>) -> Option<f64> {
        angle_of(&self.relative_velocity(), intended)
    }

    /// Tip-off rates: angular velocities of payload and stage after the last release less those at the
    /// start of the separation, each in its body's axes, rad/s.
    #[must_use]
    pub fn tip_off(&self, separation: &Separation) -> [Vector3<f64>; 2] {
        let of = |after: &MovingBody, before: &MovingBody| {
            after.state().angular_velocity - before.state().angular_velocity
        };
        [of(&self.payload, separation.payload()), of(&self.stage, separation.stage())]
    }

    /// The springs in the order in which they let go, from 1; those that let go at one time together.
    /// One that never pushes has no place in it.
    #[must_use]
    pub fn release_order(&self) -> Vec<Vec<usize>> {
        // Zero is the time of one that never pushes.
        let times = self.release_times().zip(1..).filter(|(time, _)| *time > 0.0);
        let mut times: Vec<(f64, usize)> = times.collect();
        times.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let groups = times.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq());
        groups.map(|group| group.iter().map(|(_, spring)| *spring).collect()).collect()
    }

    /// Where the energy of the springs of `separation`, of which this is the outcome, has gone.
    #[must_use]
    pub fn energy_split(&self, separation: &Separation) -> EnergySplit {
        EnergySplit::new(separation, self)
    }

    /// Wobble, nutation, coning and the rest, of the payload about the given body axis.
    #[must_use]
    pub fn spin_metrics(&self, spin_axis: &Unit<Vector3<f64>>) -> SpinMetrics {
        self.payload.spin_metrics(spin_axis)
    }

    /// Integration steps taken, each an expansion of the motion, to order 14 at most.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.steps
    }
}
