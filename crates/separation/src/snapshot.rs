//! Bodies and loads at a moment.

use nalgebra::Vector3;
use smallvec::SmallVec;

use crate::{
    LoadState, MovingBody, Separation, bodies, energy::translations, layout::INLINE_LOADS,
    state::State,
};

/// Bodies and loads at a moment.
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
/// let trajectory = separation.trajectory(&Settings::default(), 1.0)?;
/// for time in [0.0, 0.05, 0.5] {
///     let now = trajectory.at(time).ok_or("within the coast")?;
///     assert!((now.energy_j() - 500.0).abs() < 1e-9);
///     assert!(now.momentum().norm() < 1e-9);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    time: f64,
    payload: MovingBody,
    stage: MovingBody,
    loads: SmallVec<[LoadState; INLINE_LOADS]>,
}

impl Snapshot {
    pub(crate) fn new(separation: &Separation, state: &State, time: f64, pushing: &[bool]) -> Self {
        let (payload, stage) = bodies::bodies(separation, state, time);
        let loads = separation.seated().iter().zip(pushing);
        let seen = loads.map(|(load, acts)| load.seen(state, &payload.state().attitude, *acts));
        Self { time, payload, stage, loads: seen.collect() }
    }

    /// Since the clamp opened, s.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.time
    }

    /// The payload.
    #[must_use]
    pub fn payload(&self) -> &MovingBody {
        &self.payload
    }

    /// The stage.
    #[must_use]
    pub fn stage(&self) -> &MovingBody {
        &self.stage
    }

    /// The loads, in their order.
    #[must_use]
    pub fn loads(&self) -> &[LoadState] {
        &self.loads
    }

    /// Energy of both bodies and of the loads that push, J: conserved but for what a late spring
    /// brings in when it starts.
    #[must_use]
    pub fn energy_j(&self) -> f64 {
        let stored: f64 = self.loads.iter().map(LoadState::energy_j).sum();
        self.payload.kinetic_energy() + self.stage.kinetic_energy() + stored
    }

    /// Energies of translation of payload and stage relative to their common mass centre, J.
    #[must_use]
    pub fn translational_energies_j(&self) -> [f64; 2] {
        translations([&self.payload, &self.stage])
    }

    /// Linear momentum of both bodies, inertial axes, kg·m/s: conserved.
    #[must_use]
    pub fn momentum(&self) -> Vector3<f64> {
        self.payload.momentum() + self.stage.momentum()
    }

    /// Angular momentum of both bodies about the inertial origin, inertial axes, kg·m²/s: conserved.
    #[must_use]
    pub fn angular_momentum(&self) -> Vector3<f64> {
        self.payload.angular_momentum() + self.stage.angular_momentum()
    }
}
