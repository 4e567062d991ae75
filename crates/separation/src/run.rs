use crate::{Outcome, Separation, Settings, integrator::Integrator};

/// Why a separation could not be followed to its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// Springs are still in contact at the horizon.
    #[error(
        "springs {springs:?} had not let go after {horizon} s: spring {} is {compression:e} m short \
         of its free length and grows by {rate:e} m/s", .springs[0]
    )]
    NotReleased {
        /// The springs, from 1.
        springs: Vec<usize>,
        /// The horizon, s.
        horizon: f64,
        /// How far the first of them is from its free length, m.
        compression: f64,
        /// How fast it grows, m/s.
        rate: f64,
    },
    /// Steps have become too small: the motion comes to a singularity.
    #[error(
        "step of {step:e} s at {time} s is too small to go on{}",
        .spring.map_or(String::new(), |i| format!(
            ": spring {i} is nearly of zero length and its force has no direction"
        ))
    )]
    StepUnderflow {
        /// When, s.
        time: f64,
        /// The step, s.
        step: f64,
        /// The shortest of the springs that push, from 1.
        spring: Option<usize>,
    },
    /// So many steps that the motion must be far faster than the springs are.
    #[error(
        "{steps} steps have led to {time} s only, at a relative tolerance of {relative_tolerance:e}: \
         the bodies turn too fast for their springs"
    )]
    TooManySteps {
        /// Steps.
        steps: u32,
        /// When, s.
        time: f64,
        /// The tolerance asked for.
        relative_tolerance: f64,
    },
    /// A number has overflowed.
    #[error("the motion at {time} s is beyond the range of numbers")]
    NotFinite {
        /// When, s.
        time: f64,
    },
}

pub(crate) fn run(separation: &Separation, settings: &Settings) -> Result<Outcome, RunError> {
    let mut integrator = Integrator::<1>::new(*settings);
    let mut track = integrator.load(0, separation);
    while !track.all_released() {
        integrator.expand();
        integrator.step(0, &mut track)?;
    }
    let state = integrator.state(0);
    Ok(track.outcome(&state))
}
