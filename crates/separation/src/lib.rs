//! Two rigid bodies pushed apart by springs.
//!
//! A payload sits on a stage; compressed springs act between fixed points of the two bodies, each
//! along the line between its points, until it reaches its release length and is lost for good. This
//! crate integrates the motion to the last release at full precision ([`Separation::run`], many at a
//! time in a [`Batch`], with all that lies between as a [`Trajectory`]) and says what became of it
//! ([`Outcome`]: relative velocity, tip-off rates, releases, energy split) and of the payload's spin
//! ([`SpinMetrics`]: wobble, nutation and its bounds, coning, inertia ratio; Peck 2003, Eq. 28-37). How near
//! the bodies come to each other afterwards is what `gyradius-clearance` tells. It knows no probability.
//!
//! # Conventions
//! * SI units; angles in rad. Inertia about the mass centre in body axes, products as tensor
//!   entries.
//! * A body's attitude takes body components to inertial components (`nalgebra`'s `q * v`);
//!   angular velocity is in body axes.
//! * Springs push: with s the vector from stage point to payload point, the force on the payload
//!   is +k(L₀ − |s|) s/|s| and on the stage its opposite, torques r × F likewise. The release length
//!   L₀ is the initial distance of the two points plus the stroke; a friction f makes it f/k shorter. Springs may start
//!   late or fail ([`Spring::with_friction`], [`Spring::starting_at`], [`Spring::never_pushing`]).
//!
//! ```
//! use gyradius_inertia::InertiaMatrix;
//! use gyradius_separation::{Body, Separation, Settings, Spring};
//! use nalgebra::Vector3;
//!
//! let payload = Body::new(10_000.0, InertiaMatrix::from_entries([5e3, 4e3, 3e3], [0.0; 3])?)?;
//! let stage = Body::new(4_000.0, InertiaMatrix::from_entries([6.7e3, 6.7e3, 2e3], [0.0; 3])?)?;
//! let springs = [Spring::new(1e5, 0.1, Vector3::new(0.0, 0.0, -0.9), Vector3::new(0.0, 0.0, 0.9))?];
//! let separation = Separation::new(
//!     payload.at(Vector3::new(0.0, 0.0, 1.0)),
//!     stage.at(Vector3::new(0.0, 0.0, -1.0)),
//!     &springs,
//! )?;
//!
//! let outcome = separation.run(&Settings::default())?;
//! // All of ½kδ² goes into the relative motion of the mass centres: v = δ√(k/μ).
//! let reduced = 10_000.0 * 4_000.0 / 14_000.0;
//! assert!((outcome.relative_speed() - 0.1 * f64::sqrt(1e5 / reduced)).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod batch;
mod bodies;
mod body;
mod energy;
mod expansion;
mod integrator;
mod lanes;
mod layout;
mod load;
mod load_state;
mod loads;
mod metrics;
mod nutation;
mod outcome;
mod parameter;
mod polynomial;
mod products;
mod role;
mod root;
mod rounding;
mod run;
mod run_error;
mod separation;
mod settings;
mod snapshot;
mod spin_axes;
mod spring;
mod stack;
mod state;
mod step_limits;
mod track;
mod trajectory;
mod vector;

pub use batch::Batch;
pub use body::{Body, BodyError, BodyState, MovingBody};
pub use energy::EnergySplit;
pub use load::{Load, LoadId, LoadKind};
pub use load_state::LoadState;
pub use loads::{AnyLoad, LoadError, LoadParameter};
pub use metrics::SpinMetrics;
pub use outcome::Outcome;
pub use parameter::{BodyParameter, Given, Parameter, StackParameter};
pub use role::Role;
pub use run_error::RunError;
pub use separation::{Separation, SeparationError};
pub use settings::{Settings, SettingsError};
pub use snapshot::Snapshot;
pub use spring::{Spring, SpringError, SpringParameter};
pub use stack::Stack;
pub use step_limits::StepLimits;
pub use trajectory::{Step, Trajectory};

// Part of the interface, in the version that it takes and gives.
pub use nalgebra;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
