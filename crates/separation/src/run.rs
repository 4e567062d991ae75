//! A run alone: a batch with one lane filled.

use crate::{
    Outcome, RunError, Separation, Settings,
    integrator::{Integrate, Integrator},
};

impl Separation {
    /// Integrates to the release of the last spring. Does not allocate for up to eight springs.
    ///
    /// # Errors
    /// A spring is not released within the horizon, or the integration cannot go on.
    pub fn run(&self, settings: &Settings) -> Result<Outcome, RunError> {
        let mut integrator = Integrator::<4>::new(*settings);
        let mut track = integrator.load(0, self);
        while !track.all_released() {
            integrator.expand();
            integrator.step(0, self, &mut track)?;
        }
        Ok(Outcome::new(self, track, &integrator.state(0), settings))
    }
}
